/* SPDX-License-Identifier: BSD-3-Clause */
/* filter.h -- makes the Jacobian of weft_structure::linearise symmetric and its K never
 * negative, in place. The terms z are not in it from the start. */
#pragma once

#include "weft/stepper.h"

/* q becomes one of [0, k], k stays. That leaves the pairs of bending, whose k - q is 0,
 * as they are. */
void weft__filter_springs(double *planes, size_t count);

/* K becomes the nearest symmetric matrix that is never negative, in the first six
 * planes as xx xy xz yy yz zz. C stays where it is. */
void weft__filter_blocks(double *blocks, size_t n);
