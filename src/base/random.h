/* SPDX-License-Identifier: BSD-3-Clause */
/* random.h -- random numbers that are the same on every machine. */
#pragma once

#include <stdint.h>

/* The next 64 bits of SplitMix64 (G. L. Steele et al., OOPSLA 2014); any state starts
 * it. */
static inline uint64_t weft__random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}
