/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_matrix.h -- the matrix K [N/m] of the bending energy x.K x / 2 of triangles,
 * the same for each coordinate: constant, symmetric to the last bit, never negative.
 * Its rows lie in groups of four, which share their columns. */
#ifndef WEFT_FORCES_BENDING_PLATE_MATRIX_H
#define WEFT_FORCES_BENDING_PLATE_MATRIX_H

#include "mesh/triangles.h"

enum { WEFT__PLATE_ROWS = 4 };

typedef struct weft__plate_matrix {
    size_t particles;
    size_t *first;    /* column of each group of rows, and their number */
    uint32_t *column; /* where it is in its block's list: own particles, then halo */
    double *entry;    /* [N/m] four of each column: 0 where a row has none */
    double tau[2];    /* [s] the least and the largest damping of its triangles */
    double *damping;  /* [N s/m] as `entry`, where they differ; else tau of each */
    size_t *reach;    /* the first of each block's halo, and their number */
    uint32_t *halo;   /* particles beyond a block that its rows have as columns */
    size_t near;      /* particles of the largest block and its halo */
} weft__plate_matrix;

/* `pin` is not 0 of pinned particles. All NULL where no triangle resists bending.
 * False: no memory. */
bool weft__plate_matrix_create(weft__plate_matrix *out, const weft__triangles *of,
                               size_t particles, const uint32_t *pin,
                               const weft_allocator *memory);
void weft__plate_matrix_free(weft__plate_matrix *of, const weft_allocator *memory);

/* [s] by which K is damped, besides `damping`. */
static inline double weft__plate_tau(const weft__plate_matrix *of)
{
    return of->damping != NULL ? 0.0 : of->tau[0];
}

/* The particle of a column of a row. */
static inline size_t weft__plate_particle(const weft__plate_matrix *of, size_t row,
                                          uint32_t column)
{
    const size_t b = row / WEFT__MESH_BLOCK, first = b * WEFT__MESH_BLOCK;
    const size_t left = of->particles - first;
    const size_t own = left < WEFT__MESH_BLOCK ? left : WEFT__MESH_BLOCK;
    return column < own ? first + column : of->halo[of->reach[b] + (column - own)];
}

#endif
