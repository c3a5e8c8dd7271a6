/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_arithmetic.h -- loops over arrays of n components. Long arrays are divided
 * among a pool (NULL: none), with the same results. The output may be one of the
 * inputs. */
#pragma once

#include "sundials_shared.h"

/* z = sum of c[k] x[k], k < count, from left to right, count > 0; returns whether all
 * of it is finite. */
bool weft__sun_combine(const weft_team *pool, size_t n, int count,
                       const double *const *x, const double *c, double *z);
void weft__sun_set(const weft_team *pool, size_t n, double c, double *z);
bool weft__sun_all_finite(const weft_team *pool, size_t n, const double *x);

/* w_i = 1 / (rtol |y_i| + atol[0]), i < n / 2; with atol[1] in the second half. */
void weft__sun_weights_of(const weft_team *pool, size_t n, const double *y, double rtol,
                          const double atol[2], double *w);
/* Of e_i w_i; NaN if one is NaN. */
double weft__sun_norm(const weft_team *pool, size_t n, weft_norm norm, const double *e,
                      const double *w);

/* The same with the largest size and the weights of y, which are not stored. */
double weft__sun_scaled_norm(const weft_team *pool, size_t n, const double *e,
                             const double *y, double rtol, const double atol[2]);
