/* SPDX-License-Identifier: BSD-3-Clause */
/* angles.h -- the bending of triangles that are free of it where they start, beside the
 * matrix of plate.h. With the rows r of a triangle there (forces/bending/plate.h), k
 * their values along its unit normal n in the start shape, w = sum of k_j r_j x and s =
 * |k|^2 the energy is
 *
 *     sum_j |r_j x - k_j n|^2 / 2 = x.K x / 2 - n.w + s / 2
 *
 * of which the plate has the first term. The damping is the rate of r_j x - k_j n, so
 * that a rigid turn of the start shape is free of it. */
#pragma once

#include "forces/bending/plate.h"

typedef struct weft__angles {
    const weft__mesh *mesh;
    const weft__plate *plate;
    size_t *first;   /* of each block in `list`, and their number: */
    uint32_t *list;  /* triangles of plate->matrix.rest whose rows have its particles */
    size_t *begin;   /* of each particle in `entry`, and their number: */
    uint32_t *entry; /* its entries in the rows of plate->matrix.rest, */
    uint32_t *item;  /* and whose they are */
    bool copied;
} weft__angles;

extern const weft__force weft__angles_force;

/* angles_law.c: one triangle in a state, or in a direction of it. */
typedef struct weft__facet {
    double n[3], size; /* its normal, and twice its area [m^2] */
    double per;        /* [1/m^2] 1 / size */
    double e[3][3];    /* [m] its edges, opposite corner i */
    double w[3], v[3]; /* [N], [N/s] of its row: by positions, by velocities */
    double rate[3];    /* [1/s] of n */
} weft__facet;

void weft__facet_of(const weft__angles *own, size_t item, const double *y,
                    weft__facet *out);

/* What a triangle does: `on` times the weight of each particle of its row, and more on
 * its corners. */
typedef struct weft__facet_force {
    double on[3], corner[3][3]; /* [1], [N] */
} weft__facet_force;

/* Its force, or the change of it along at->along. */
void weft__facet_force_of(const weft__angles *own, size_t item, const weft__state *at,
                          weft__facet_force *out);

weft__transposed_fn weft__angles_transposed;

/* Adds (a K + b C) x of particles at rest, without the plate's. */
void weft__angles_multiply(const void *own, const weft__state *at, double a, double b,
                           const double *x, double *out);
