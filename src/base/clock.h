/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <time.h>

/* [s] since an arbitrary moment; it is never set. */
static inline double weft__wall_clock(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
