/* SPDX-License-Identifier: BSD-3-Clause */
/* bytes.h -- numbers as bytes, the same on every machine: words of 64 bits,
 * little-endian. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/hash.h"

enum { WEFT__WORD = 8 }; /* [bytes] */

static inline void weft__word_put(unsigned char *to, uint64_t value)
{
    for (unsigned k = 0; k < WEFT__WORD; ++k) {
        to[k] = (unsigned char)(value >> (8 * k));
    }
}

static inline uint64_t weft__word_at(const unsigned char *from)
{
    uint64_t value = 0;
    for (unsigned k = 0; k < WEFT__WORD; ++k) {
        value |= (uint64_t)from[k] << (8 * k);
    }
    return value;
}

static inline void weft__real_put(unsigned char *to, double value)
{
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    weft__word_put(to, word);
}

static inline double weft__real_at(const unsigned char *from)
{
    const uint64_t word = weft__word_at(from);
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* In single precision, half a word. */
static inline void weft__single_put(unsigned char *to, float value)
{
    uint32_t half;
    memcpy(&half, &value, sizeof half);
    for (unsigned k = 0; k < WEFT__WORD / 2; ++k) {
        to[k] = (unsigned char)(half >> (8 * k));
    }
}

static inline float weft__single_at(const unsigned char *from)
{
    uint32_t half = 0;
    float value;
    for (unsigned k = 0; k < WEFT__WORD / 2; ++k) {
        half |= (uint32_t)from[k] << (8 * k);
    }
    memcpy(&value, &half, sizeof value);
    return value;
}

/* Numbers of 64 bits, doubles or integers. */
static inline void weft__words_put(unsigned char *to, const void *from, size_t words)
{
    for (size_t i = 0; i < words; ++i) {
        uint64_t word;
        memcpy(&word, (const unsigned char *)from + i * WEFT__WORD, sizeof word);
        weft__word_put(to + i * WEFT__WORD, word);
    }
}

static inline void weft__words_get(void *to, const unsigned char *from, size_t words)
{
    for (size_t i = 0; i < words; ++i) {
        const uint64_t word = weft__word_at(from + i * WEFT__WORD);
        memcpy((unsigned char *)to + i * WEFT__WORD, &word, sizeof word);
    }
}

static inline uint64_t weft__words_sum(const unsigned char *bytes, size_t words)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t i = 0; i < words; ++i) {
        hash = weft__hash_word(hash, weft__word_at(bytes + i * WEFT__WORD));
    }
    return hash;
}
