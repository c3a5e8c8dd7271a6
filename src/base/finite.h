/* SPDX-License-Identifier: BSD-3-Clause */
/* finite.h -- whether numbers are finite and have the right sign. NaN has none. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static inline bool weft__not_negative(double x)
{
    return isfinite(x) && x >= 0.0;
}

static inline bool weft__positive(double x)
{
    return isfinite(x) && x > 0.0;
}

static inline bool weft__all_finite(const double *values, size_t count)
{
    /* 0 x is NaN for an x that is not finite, and NaN stays in a sum */
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += 0.0 * values[i];
    }
    return sum == 0.0;
}

/* For a text, in which NaN has no sign. */
static inline double weft__unsigned_nan(double x)
{
    return isnan(x) ? (double)NAN : x;
}
