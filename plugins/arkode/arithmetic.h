/* SPDX-License-Identifier: BSD-3-Clause */
/* arithmetic.h -- loops over arrays of n components, shared with a team (NULL: none)
 * where they are long, with the same results. What is written may be one of the arrays
 * that are read. */
#ifndef ARKODE_ARITHMETIC_H
#define ARKODE_ARITHMETIC_H

#include "arkode_plugin.h"

/* What errors are multiplied by: numbers that stand somewhere, or
 *
 *     1 / (rtol |y_i| + atol[0]),  i < half,    1 / (rtol |y_i| + atol[1]),  i < 2
 * half,
 *
 * and nothing beyond. */
typedef struct ark_weights {
    weft_norm norm;
    const double *plain; /* or NULL */
    const double *y;
    size_t half;
    double rtol, atol[2];
} ark_weights;

/* z = sum of c[k] x[k], from left to right; whether all of it is finite. */
bool weft__ark_combine(const weft_team *team, size_t n, int count,
                       const double *const *x, const double *c, double *z);
/* z = x; the largest magnitude, NaN where something is not finite. */
double weft__ark_copy(const weft_team *team, size_t n, const double *x, double *z);
void weft__ark_set(const weft_team *team, size_t n, double c, double *z);
bool weft__ark_all_finite(const weft_team *team, size_t n, const double *x);

/* The norm of e, which is first combined as above if count > 0, and *finite with it. */
double weft__ark_judge(const weft_team *team, size_t n, const ark_weights *weights,
                       double *e, int count, const double *const *x, const double *c,
                       bool *finite);

#endif
