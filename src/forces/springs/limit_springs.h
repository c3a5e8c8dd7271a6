/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_springs.h -- the springs under a strain limit; x[3 N] are positions in planes.
 */
#pragma once

#include "forces/springs/springs.h"

/* One pass of Gauss-Seidel: each spring that is longer than allowed is shortened to the
 * allowed length, particle by particle within a family, both its springs in turn; the
 * ends share by inverse mass. Springs of length 0 or NaN are skipped. */
void weft__limited_sweep(const weft__springs *own, const weft_limit_def *limit,
                         double *x);

/* The number of springs that exceed the limit and its tolerance: those with both ends
 * pinned (`held`), or the others. NaN is too long. Stops after the row that completes
 * `most`. */
size_t weft__limited_excess(const weft__springs *own, const weft_limit_def *limit,
                            bool held, size_t most, const double *x);

/* The spring of the largest strain among those that a limit bounds. */
weft_spring weft__limited_worst(const weft__springs *own, const weft_limit_def *limit,
                                const double *x);
