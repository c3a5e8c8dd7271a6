/* SPDX-License-Identifier: BSD-3-Clause */
/* hash.h -- hashes that are the same on every machine: FNV-1a (Fowler, Noll, Vo), and
 * the same with words in place of bytes. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define WEFT__HASH_START UINT64_C(0xcbf29ce484222325)
#define WEFT__HASH_PRIME UINT64_C(0x100000001b3)

static inline uint64_t weft__hash_byte(uint64_t hash, unsigned char byte)
{
    return (hash ^ byte) * WEFT__HASH_PRIME;
}

/* Of words instead of bytes, each folded onto itself first: the prime carries
 * differences upwards only. For any hash, and for any word, a bijection: a change
 * within one word always shows. */
static inline uint64_t weft__hash_word(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word ^ (word >> 32)) * WEFT__HASH_PRIME;
    return hash ^ (hash >> 29);
}

/* The bits of a number; -0 counts as 0. */
static inline uint64_t weft__hash_real(uint64_t hash, double value)
{
    const double number = value + 0.0;
    uint64_t word;
    memcpy(&word, &number, sizeof word);
    return weft__hash_word(hash, word);
}

/* values may be NULL, which differs from count 0. */
static inline uint64_t weft__hash_reals(uint64_t hash, const double *values,
                                        size_t count)
{
    hash = weft__hash_word(hash, values != NULL);
    for (size_t i = 0; values != NULL && i < count; ++i) {
        hash = weft__hash_real(hash, values[i]);
    }
    return hash;
}

/* Of numbers that are listed. */
#define WEFT__HASH_NUMBERS(hash, ...)                                                  \
    weft__hash_reals((hash), (const double[]){ __VA_ARGS__ },                          \
                     sizeof((const double[]){ __VA_ARGS__ }) / sizeof(double))
