/* SPDX-License-Identifier: BSD-3-Clause */
/* bending.h -- the bending rigidity of a plate, for the other files of src/cloth,
 * src/sim and src/kernel. With second differences of neighbours,
 *
 *     D_r x = (x(r+1, c) - x(r, c)) - (x(r, c) - x(r-1, c)),   D_c along the row,
 *
 * in which a particle beyond the rim is where the last one is (a symmetric matrix),
 *
 *     F = -K (x + damping v),   K = D_r k_r D_r + D_c k_c D_c + k_t D_r D_c
 *
 * k_r is `along`, half of it on the first and last column, and 0 on the first and last
 * row, where no three particles are centred; k_c is `across` likewise, k_t is `twist`.
 * K has no force on flat cloth, stretched or rotated (docs/physics.md). */
#ifndef WEFT_CLOTH_BENDING_H
#define WEFT_CLOTH_BENDING_H

#include "cloth/model.h"

/* [N m] The twist of a definition, with its default. */
double weft__twist_of(const weft_bending_def *of);

weft__rigidity weft__rigidity_of(const weft_cloth_def *def);

/* Whether all that is computed from it can be finite. */
bool weft__rigidity_usable(const weft__rigidity *of);

/* Whether three particles of a row or column of `count` are centred at `at`. */
static inline bool weft__inner(size_t at, size_t count)
{
    return at > 0 && at + 1 < count;
}

/* The row or column before `at` and the one after it; beyond the rim `at` itself. */
static inline size_t weft__before(size_t at)
{
    return at > 0 ? at - 1 : at;
}

static inline size_t weft__after(size_t at, size_t count)
{
    return at + 1 < count ? at + 1 : at;
}

/* The part of its stiffness that a strip of cloth has at the rim. */
static inline double weft__strip(size_t at, size_t count)
{
    return count == 1 || weft__inner(at, count) ? 1.0 : 0.5;
}

/* [N/m] The sum of all |K_ij| of particle i: K <= diag of these. */
double weft__bending_row_sum(const weft_cloth *cloth, size_t i);

/* out[3 N] += scale K x */
void weft__bending_multiply(const weft_cloth *cloth, double scale, const double *x,
                            double *out);

/* K as pairs: K x on p is the sum of -q (x_q - x_p), q = -K_pq of either sign. Those of
 * one of WEFT_GROUPS ways are a group without a law; false: there are none. */
bool weft__bending_pairs(const weft_cloth *cloth, size_t way, weft__group *pairs);

/* [N/m] q of the pair of that way that begins at (r, c). */
double weft__bending_pull(const weft_cloth *cloth, size_t way, size_t r, size_t c);

#endif
