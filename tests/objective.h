/* SPDX-License-Identifier: BSD-3-Clause */
/* objective.h -- a function of the frames of a run, whose gradient tests compare. */
#pragma once

#include <math.h>
#include <stddef.h>

/* The sum of |y|^2 / 2 and of c.y, c of its own in each frame; *ctx is the length of y.
 */
static inline int objective(void *ctx, size_t frame, double t, const double *y,
                            double *value, double *slope)
{
    const size_t dim = *(const size_t *)ctx;
    for (size_t i = 0; i < dim; ++i) {
        const double c = sin((double)(i + 7 * frame)) + t;
        *value += (0.5 * y[i] + c) * y[i];
        slope[i] += y[i] + c;
    }
    return 0;
}
