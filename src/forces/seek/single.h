/* SPDX-License-Identifier: BSD-3-Clause */
/* single.h -- places in single precision. */
#pragma once

#include "forces/lanes.h"

/* [m] A place further away is taken to be there: that brings boxes nearer each other,
 * but never apart. */
#define FAR_AWAY 1e30
/* What a place rounds by, twice: as a number and as the margin is taken off; and where
 * that is too small to be a number. */
#define MARGIN       2e-7F
#define LEAST_MARGIN 1e-30F

INLINE float single(double x)
{
    return (float)(x < -FAR_AWAY ? -FAR_AWAY : x > FAR_AWAY ? FAR_AWAY : x);
}

INLINE float margin(float x)
{
    return (x < 0.0F ? -x : x) * MARGIN + LEAST_MARGIN;
}
