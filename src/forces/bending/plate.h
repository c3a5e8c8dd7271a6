/* SPDX-License-Identifier: BSD-3-Clause */
/* plate.h -- the bending of triangles, F = -K (x + damping v) with the matrix of
 * plate_matrix.h. A row is summed over its columns by turns in two sums, from the first
 * particle of its block on, which moves with the cloth. On a grid it is nothing. */
#ifndef WEFT_FORCES_BENDING_PLATE_H
#define WEFT_FORCES_BENDING_PLATE_H

#include "forces/bending/plate_matrix.h"
#include "forces/force.h"

/* Particles of a block and its halo, for which the fast forms have room. */
enum { WEFT__PLATE_ROOM = 1536 };

typedef struct weft__plate {
    const weft__mesh *mesh;
    weft__plate_matrix matrix;
    double *most; /* [N/m] of each particle: K is at most diag of these; then [N s/m] of
                     matrix.damping */
    bool copied;  /* shares the matrix of its model */
    weft__add_fn *fast;
} weft__plate;

/* The force is -K (x + tau v), then, with a matrix of damping of its own, less that by
 * v: terms `matrix` (x + tau v), tau 0: of x alone. */
typedef struct weft__plate_term {
    const double *matrix; /* 4 of each column */
    const double *x;      /* three planes; those of v are 3 N further on */
    double tau;           /* [s] */
} weft__plate_term;

/* Writes the terms in a state; returns their number. */
static inline size_t weft__plate_terms(const weft__plate_matrix *of, const double *y,
                                       weft__plate_term to[2])
{
    to[0] = (weft__plate_term){ of->entry, y, weft__plate_tau(of) };
    to[1] = (weft__plate_term){ of->damping, y + 3 * of->particles, 0.0 };
    return of->damping != NULL ? 2 : 1;
}

extern const weft__force weft__plate_force;
WEFT_FORMS(weft__add_fn, plate);

#endif
