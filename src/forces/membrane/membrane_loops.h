/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_loops.h -- the triangles of a membrane, one by one: for membrane.c. */
#ifndef WEFT_FORCES_MEMBRANE_LOOPS_H
#define WEFT_FORCES_MEMBRANE_LOOPS_H

#include "forces/membrane/membrane.h"

/* A triangle in a state, or in a direction of it. */
typedef struct weft__sides3 {
    double d[3][3]; /* [m] edges: d[i] is opposite corner i */
    double w[3][3]; /* [m/s] their rates */
} weft__sides3;

/* One triangle of a batch. */
typedef struct weft__triangle {
    const double *of;       /* its constants, WEFT__WIDTH apart */
    const uint32_t *corner; /* its particles */
    size_t number;
} weft__triangle;

void weft__membrane_sides(const weft__mesh *mesh, const uint32_t corner[3],
                          const double *y, weft__sides3 *out);

/* [m^2] */
void weft__membrane_squares(const weft__sides3 *at, double square[3]);

/* Finds those of block b, one after the other; false: no more. *next is 0 before the
 * first. */
bool weft__membrane_each(const weft__membrane *of, size_t b, size_t *next,
                         weft__triangle *out);

/* The same, of those whose lowest particle is in the block: each triangle once. */
bool weft__membrane_each_own(const weft__membrane *of, size_t b, size_t *next,
                             weft__triangle *out);

/* [N] on the own particles of block b, or its change along at->along. */
void weft__membrane_forces(const weft__membrane *own, const weft__state *at, size_t b,
                           double force[WEFT__MESH_BLOCK][3]);

#endif
