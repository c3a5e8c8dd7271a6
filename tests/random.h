/* SPDX-License-Identifier: BSD-3-Clause */
/* random.h -- the same random numbers in every run. */
#pragma once

#include <stdint.h>

/* [0, 1): Marsaglia's xorshift, J. Stat. Softw. 8 (2003), times a constant. *state must
 * not be 0. */
static inline double random_uniform(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state * 0x2545F4914F6CDD1Du >> 11) * 0x1p-53;
}

/* Whole, from least to most. */
static inline int64_t random_whole(uint64_t *state, int64_t least, int64_t most)
{
    return least + (int64_t)(random_uniform(state) * (double)(most - least + 1));
}
