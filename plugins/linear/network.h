/* SPDX-License-Identifier: BSD-3-Clause */
/* network.h -- a symmetric positive definite matrix as a network of n particles: a 3 x
 * 3 block for each particle, and one for each spring, which adds [A -A; -A A]. Blocks
 * of springs are never negative; a pair of bending has a multiple of I, also a negative
 * one, and only all pairs together are never negative. Likewise block and scalar
 * couplings of triangles (weft/stepper.h), whose blocks need not be symmetric.
 * Products, the diagonal, and sums of products in a fixed order.
 *
 * Vectors have three planes of n numbers; symmetric blocks have six planes, xx xy xz yy
 * yz zz. Held particles are no part of the matrix: their rows and columns are 0. */
#pragma once

#include "pile.h"

typedef struct weft__network {
    size_t n, run_count, pair_count;
    const weft_spring_run *runs;
    size_t block_coupling_count, scalar_coupling_count;
    const weft_block_coupling *block_couplings;
    const weft_scalar_coupling *scalar_couplings;
    double *point, *spring_entries; /* 6 n, 6 pair_count */
    double *block_entries; /* 9 block_coupling_count: the block of each, row by row */
    double scalar_k,
        scalar_c;    /* a scalar coupling's block is (scalar_k k + scalar_c c) I */
    double *inverse; /* 6 n: of the blocks of the diagonal; 0 where that is 0 */
    uint32_t *held;  /* NULL: none */
    size_t held_count;
} weft__network;

/* Takes the arrays, for the runs that are there. */
void weft__network_take(weft__network *self, weft__pile *pile);

/* Finds the diagonal of the matrix without the negative blocks of bending, and inverts
 * it: the matrix is at most twice it, with them or without. Returns the largest trace
 * of a block of the diagonal by `mass`, or 0 with mass NULL. */
double weft__network_invert(weft__network *self, const double *mass);

/* y = S x; x is 0 at held particles. */
void weft__network_times(const weft__network *self, const double *x, double *y);

/* z = inverse r */
void weft__network_precondition(const weft__network *self, const double *r, double *z);

/* y_p += A (x_p - x_q), y_q -= the same, with the planes of weft_structure::linearise:
 * A = scale ((k - q) u u^T + q I), or scale c u u^T. */
void weft__network_add_stiffness(const weft__network *self, const double *planes,
                                 double scale, const double *x, double *y);
void weft__network_add_damping(const weft__network *self, const double *planes,
                               double scale, const double *x, double *y);

/* y_p += scale A (x_p - x_q), y_q += scale A^T (x_q - x_p) for each block coupling,
 * whose blocks are `stride` apart; with A = (k coupling.k + c coupling.c) I for each
 * coupling. */
void weft__network_add_block_couplings(const weft__network *self, const double *blocks,
                                       size_t stride, double scale, const double *x,
                                       double *y);
void weft__network_add_scalar_couplings(const weft__network *self, double k, double c,
                                        const double *x, double *y);

/* Springs, then block couplings, then scalar couplings, by number: writes their ends to
 * ends unless it is NULL; returns how many there are. */
size_t weft__network_edges(const weft__network *self, uint32_t (*ends)[2]);

/* The 3 x 3 blocks, row by row: of a particle, of its inverse diagonal, and of edge
 * half / 2, transposed for an odd half. */
void weft__network_point(const weft__network *self, size_t i, double block[9]);
void weft__network_inverse(const weft__network *self, size_t i, double block[9]);
void weft__network_block(const weft__network *self, size_t half, double block[9]);

/* The sum of a_i b_i; y = a x; y = a x + b y. */
double weft__vector_dot(size_t n, const double *a, const double *b);
void weft__vector_scale(size_t n, double a, const double *x, double *y);
void weft__vector_mix(size_t n, double a, const double *x, double b, double *y);
