/* SPDX-License-Identifier: BSD-3-Clause */
/* state.h -- a state of a cloth, and what the functions of a force make of it. `own` is
 * the force's part of the cloth. Ranges are of blocks (mesh/blocks.h) and divide the
 * work among threads: bits do not depend on it. */
#pragma once

#include "mesh/blocks.h"
#include "weft/stepper.h"

/* Numbers that rows carry to the next ones: two pulls in each column, and in some
 * beside each tile. */
enum { WEFT__CARRY_TILE = 256, WEFT__CARRY_LANES = 8 };
static inline size_t weft__carry_length(size_t cols)
{
    return (cols / WEFT__CARRY_TILE + 1) * 6
           * (WEFT__CARRY_TILE + 3 * WEFT__CARRY_LANES);
}

/* A state of a cloth, at a time. */
typedef struct weft__state {
    double t;
    const double *y;
    const double *piece; /* [s] of tables and keys, at t (mesh/track.h); NULL: t's */
    const double *along; /* of products: a direction of the state; else NULL */
} weft__state;

/* Of calls that each go on where the last one ended: what the last rows do to the next,
 * which then compute no spring above again; for fast forms. */
typedef struct weft__carry {
    double *rows;   /* [N] weft__carry_length */
    bool continues; /* rows are those above */
} weft__carry;

static inline double weft__piece(const weft__state *at)
{
    return at->piece != NULL ? *at->piece : at->t;
}

typedef enum weft__unit {
    WEFT__FORCE,       /* [N] */
    WEFT__ACCELERATION /* [m/s^2] as free; 0 of pinned particles */
} weft__unit;

struct weft__body; /* weight and air: forces/body */

/* Writes three planes, or x' and v' with WEFT__ACCELERATION, of blocks [first, end):
 * weight, air and this force, in one sweep; with at->along their derivative. carry:
 * NULL if nothing is carried. Returns 0, or 1 if a number is not finite. */
typedef int weft__start_fn(const void *own, const struct weft__body *body,
                           const weft__state *at, weft__carry *carry, weft__unit unit,
                           double *to, size_t first, size_t end);

/* Adds to three planes. Returns as above. */
typedef int weft__add_fn(const void *own, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end);

/* Adds the derivative of the sum of l.F by the state to out[6 N], for l = at->along[3
 * N] in any unit, 0 of pinned particles. */
typedef void weft__transposed_fn(const void *own, const weft__state *at, double *out);

/* Adds a force [N] on particle i, in the unit, to three planes; returns 0 or NaN. */
static inline double weft__force_add(const weft__mesh *mesh, weft__unit unit, size_t i,
                                     const double force[3], double *to)
{
    const double share = unit == WEFT__FORCE ? 1.0 : mesh->inverse_mass[i];
    double bad = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        double *sum = to + k * mesh->stride + i;
        *sum += share * force[k];
        bad += *sum * 0.0;
    }
    return bad;
}
