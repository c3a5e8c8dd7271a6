/* SPDX-License-Identifier: BSD-3-Clause */
/* plate.h -- the bending of triangles, F = -K (x + damping v) with the matrix of
 * plate_matrix.h. A row is summed over its columns by turns in two sums, from the first
 * particle of its block on, which moves with the cloth. On a grid it is nothing. */
#ifndef WEFT_FORCES_BENDING_PLATE_H
#define WEFT_FORCES_BENDING_PLATE_H

#include "forces/bending/plate_matrix.h"
#include "forces/force.h"

/* Particles of a block and its halo, for which the fast forms have room. */
enum { WEFT__PLATE_ROOM = 2048 };

typedef struct weft__plate {
    const weft__mesh *mesh;
    weft__plate_matrix matrix;
    double *most; /* [N/m] of each particle: K is at most diag of these; then [N s/m] of
                     matrix.damping */
    bool copied;  /* shares the matrix of its model */
    weft__add_fn *fast;
} weft__plate;

extern const weft__force weft__plate_force;
WEFT_FORMS(weft__add_fn, plate);

#endif
