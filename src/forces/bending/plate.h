/* SPDX-License-Identifier: BSD-3-Clause */
/* plate.h -- the bending of triangles, F = -K (x + damping v) with the matrix of
 * plate_matrix.c. As its rows sum to 0, it is a sum over pairs of particles, K_ij
 * (x_i - x_j) on i and the opposite on j: a row adds its pairs by turns in two sums,
 * and each of them at once to its other end. On a grid it is nothing. */
#pragma once

#include "base/stop.h"
#include "forces/force.h"
#include "mesh/triangles.h"

/* plate_matrix.c: the matrix K [N/m] of the bending energy x.K x / 2 of triangles,
 * the same for each coordinate: constant, symmetric to the last bit, never negative.
 * A pair of particles of one block stands once, in the row of either; one of two blocks
 * in the rows of both. Rows lie in groups of four of equal length: pairs of a particle
 * with itself, of entry 0, fill them up. */
enum { WEFT__PLATE_ROWS = 4, WEFT__PLATE_RECORD = 4 };

/* Of triangles that are free of bending where they start: one row each, the sum of k_j
 * r_j over the rows r of its energy there and their values k_j along its normal
 * (forces/bending/angles.h). Then their rows r have no part in its plane. */
typedef struct weft__plate_rest {
    size_t count;
    uint32_t *triangle;
    size_t *first; /* entries of each, and their number: */
    uint32_t *particle;
    double *weight; /* [N/m] */
    double *square; /* [N m] sum of k_j^2 */
} weft__plate_rest;

/* plate_rest.c: those rows as they grow. The stencil of a triangle are its particles, r
 * of each in the three rows of its energy, and where its corners are among them. */
typedef struct weft__rest_rows {
    weft__plate_rest *to;
    size_t room[5];
} weft__rest_rows;

typedef struct weft__rest_stencil {
    uint32_t triangle;
    size_t count;
    const uint32_t *particle;
    double (*r)[3];       /* [sqrt(N/m)] */
    const size_t *corner; /* 3 */
} weft__rest_stencil;

/* Takes from the rows of a triangle what they have in its plane where it starts, and
 * keeps what they have along its normal. False: no memory. */
bool weft__rest_rows_take(weft__rest_rows *rows, const weft__triangles *mesh,
                          const weft__rest_stencil *of, const weft_allocator *memory);

typedef struct weft__plate_matrix {
    size_t particles;
    size_t *first;      /* pair of each group of rows, and their number */
    uint32_t *column;   /* the other end in its block's list, own particles, then halo:
                           where its record begins, of WEFT__PLATE_RECORD numbers */
    double *entry;      /* [N/m] */
    double tau[2];      /* [s] the least and the largest damping of its triangles */
    double *damping;    /* [N s/m] as `entry`, where they differ; else tau of each */
    size_t *halo_first; /* the first of each block's halo, and their number */
    uint32_t *halo;     /* particles beyond a block that its rows have as columns */
    weft__plate_rest rest;
} weft__plate_matrix;

/* `pin` is not 0 of pinned particles. All NULL where no triangle resists bending.
 * False: no memory, or it was stopped. */
bool weft__plate_matrix_create(weft__plate_matrix *out, const weft__triangles *of,
                               size_t particles, const uint32_t *pin, weft__stop *stop,
                               const weft_allocator *memory);
void weft__plate_matrix_free(weft__plate_matrix *of, const weft_allocator *memory);

/* [s] by which K is damped, besides `damping`. */
static inline double weft__plate_tau(const weft__plate_matrix *of)
{
    return of->damping != NULL ? 0.0 : of->tau[0];
}

/* Row i is made of pairs [first, end). */
typedef struct weft__plate_row {
    size_t first, end;
} weft__plate_row;

static inline weft__plate_row weft__plate_row_of(const weft__plate_matrix *of, size_t i)
{
    const size_t g = i / WEFT__PLATE_ROWS, left = of->particles - g * WEFT__PLATE_ROWS;
    const size_t rows = left < WEFT__PLATE_ROWS ? left : WEFT__PLATE_ROWS;
    const size_t all = of->first[g + 1] - of->first[g];
    const size_t length
        = rows == WEFT__PLATE_ROWS ? all / WEFT__PLATE_ROWS : all / rows;
    const size_t first = of->first[g] + i % WEFT__PLATE_ROWS * length;
    return (weft__plate_row){ first, first + length };
}

/* A pair in the row of particle i. */
typedef struct weft__plate_pair {
    size_t particle; /* the other end */
    bool own;        /* of the same block: its row does not have the pair */
} weft__plate_pair;

static inline weft__plate_pair weft__plate_pair_of(const weft__plate_matrix *of,
                                                   size_t i, size_t pair)
{
    const size_t b = i / WEFT__MESH_BLOCK, first = b * WEFT__MESH_BLOCK;
    const size_t left = of->particles - first;
    const size_t own = left < WEFT__MESH_BLOCK ? left : WEFT__MESH_BLOCK;
    const uint32_t column = of->column[pair] / WEFT__PLATE_RECORD;
    return (weft__plate_pair){ column < own
                                   ? first + column
                                   : of->halo[of->halo_first[b] + (column - own)],
                               column < own };
}

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
    const double *matrix; /* `entry` or `damping` */
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

/* plate_edge_slope.c: the slope of triangles across an edge, rebuilt from the positions
 * of particles nearby: g = sum of share x_i, along the normal n = (t_v, -t_u) in the
 * plane (u, v), t from the first end of the edge to the second. The fit is exact for
 * quadratics wherever the mesh allows it (docs/theory/bending.md,
 * "Triangles"). */
typedef struct weft__edge_slopes {
    size_t *first;                  /* of each edge, and their number */
    uint32_t *particle;             /* may come twice in an edge */
    double *share;                  /* [1/m] */
    size_t count, room, share_room; /* of particles and shares */
} weft__edge_slopes;

/* Whether the cloth bends across a seam. Other edges of one triangle are rims. */
static inline bool weft__bends(const weft__triangles *mesh, const weft__edge *edge)
{
    return edge->sewn != WEFT__NONE && mesh->seams == WEFT_SEAM_BEND;
}

/* Whether each triangle is held: its corners are all pinned. NULL: no memory. */
bool *weft__held_triangles(const weft__triangles *of, const uint32_t *pin,
                           const weft_allocator *memory);

/* Of all edges that live triangles need, those not held. An edge of a held triangle has
 * the slope of that one; a rim has none. Each side of a seam has its own. `curved`:
 * instead h of all edges, L^2 / sqrt(12) times the second derivative along them, L
 * their length, with shares in [1]; those of held triangles, and those without a good
 * fit of few points, have none. False: no memory, or it was stopped. Free them in
 * either case. */
enum { WEFT__CURVE_PARTS = 40 };
bool weft__edge_slopes_create(weft__edge_slopes *out, const weft__triangles *of,
                              const bool *held, bool curved, weft__stop *stop,
                              const weft_allocator *memory);
void weft__edge_slopes_free(weft__edge_slopes *of, const weft_allocator *memory);
