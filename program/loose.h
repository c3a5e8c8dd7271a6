/* SPDX-License-Identifier: BSD-3-Clause */
/* loose.h -- a surface with the vertices of its file that no face has: they are no part
 * of the cloth, but programs that play a cache count them. */
#pragma once

#include "program/record/export/export.h"
#include "weft/scene.h"

typedef struct loose_surface {
    size_t count;       /* of loose vertices; 0: there is nothing to add */
    record_faces faces; /* of all vertices */
    size_t *from;       /* the particle of each; particles + k of loose vertex k */
    double *places;     /* [m] of the loose ones */
    double *position;   /* [m] of all, of one frame */
} loose_surface;

/* scene NULL: not known, and nothing is added. Free it, also after an error. */
weft_status loose_create(const weft_scene *scene, const record_faces *cloth,
                         loose_surface *out, weft_error *err);
void loose_free(loose_surface *of);

/* The surface of a frame with the loose vertices where they start; without velocities.
 */
record_surface loose_add(loose_surface *of, const record_surface *cloth);
