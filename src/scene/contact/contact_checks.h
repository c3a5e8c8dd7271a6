/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_checks.h -- the rules between the keys of contact; others that the rest of
 * src/scene needs are in scene/checks.h. */
#pragma once

#include "scene/checks.h"

/* scene_contact.c; the second: warnings. */
weft__check_fn weft__check_contact, weft__check_late_contact;

/* scene_body.c: the body of a shape that is a mesh, whose other keys have no mistake.
 */
void weft__read_body(weft__reader *reader, const struct weft__match *match,
                     weft__shape_item *item);

/* The triangles of a sphere, capsule or box without faults, which becomes a mesh. */
void weft__make_facets(weft__reader *reader, const struct weft__match *match,
                       weft__shape_item *item);
