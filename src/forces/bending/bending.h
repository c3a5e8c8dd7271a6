/* SPDX-License-Identifier: BSD-3-Clause */
/* bending.h -- the bending rigidity of a plate, F = -K (x + damping v), with second
 * differences of neighbours D_r, D_c (docs/theory/bending.md, "Grids"):
 *
 *     K = D_r k_r D_r + D_c k_c D_c + k_t D_r D_c
 *
 * k_r is `along`, k_c `across`, k_t `twist`. */
#pragma once

#include "forces/force.h"
#include "mesh/grid_def.h"

/* All 0 without. */
typedef struct weft__bending {
    const weft__mesh *mesh;
    double along, across; /* [N/m] of three particles along a column, along a row */
    double twist;         /* [N/m] of a cell */
    double damping;       /* [s] */
    bool present;
    weft__add_fn *fast;
} weft__bending;

WEFT__NUMBERS(weft__bending_numbers, rigidity, twist, damping);

/* [N m] The twist of a definition, with its default. */
double weft__twist_of(const weft_bending_def *of);

/* The row or column before `at` and the one after it; beyond the rim `at` itself. */
static inline size_t weft__before(size_t at)
{
    return at > 0 ? at - 1 : at;
}

static inline size_t weft__after(size_t at, size_t count)
{
    return at + 1 < count ? at + 1 : at;
}

extern const weft__force weft__bending_force;

/* As weft__force.scalar_couplings of particles from `first` on, of a grid among
 * triangles. */
size_t weft__bending_scalar_couplings(const weft__bending *own, size_t first,
                                      weft_scalar_coupling *to);
WEFT_FORMS(weft__add_fn, bending);
