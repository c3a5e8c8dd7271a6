/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh_shape.h -- shapes of triangles: their numbers, and where their vertices are. How
 * they push is that of primitives (forces/self); the gap of shapes.h leaves them out.
 */
#pragma once

#include "forces/contact/contact.h"

/* What is wrong with a body, of *triangle if it is about one, else that stays; NULL:
 * nothing. */
const char *weft__body_fault(const weft_body *of, size_t *triangle);

/* What is wrong with a triangle between places; NULL: nothing. *flat: it has no area.
 */
const char *weft__body_flaw(const double *places, const uint32_t *corner, bool *flat);

/* Own copies of the bodies of shapes, to be freed. false: no memory. */
bool weft__shapes_copy(weft__shape *shapes, size_t count, const weft_allocator *memory);
void weft__shapes_free(weft__shape *shapes, size_t count, const weft_allocator *memory);

uint64_t weft__body_hash(const weft_body *of, uint64_t hash);

/* Of all shapes of a contact. */
size_t weft__shapes_vertices(const weft__contact *of);

/* Whether a body moves after time t. */
bool weft__body_moves(const weft__shape *shape, double t);

/* How many keys are met at a time: the same within a piece of a body (mesh/track.h). */
size_t weft__body_keys_until(const weft_body *of, double piece);

/* Writes component k of where vertex i of a shape is at time t to to[k plane + i next],
 * and of its velocity to to[(3 + k) plane + i next] if `planes` is 6, not 3; by the
 * polynomial of a piece. */
void weft__body_place(const weft__shape *shape, double t, double piece, size_t planes,
                      size_t plane, size_t next, double *to);

/* As weft__curve_bounds, of the keys of bodies. */
void weft__shapes_bounds(const weft__contact *of, double t, weft__piece_bounds *to);
