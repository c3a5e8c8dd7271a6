/* SPDX-License-Identifier: BSD-3-Clause */
/* words.h -- numbers as bytes, the same on every machine: words of 64 bits,
 * little-endian. */
#ifndef WEFT_SIM_WORDS_H
#define WEFT_SIM_WORDS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

/* A checksum. A change within one word always shows: for any hash, and for any word,
 * this is a bijection. */
static inline uint64_t weft__words_sum(const unsigned char *bytes, size_t words)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < words; ++i) {
        const uint64_t word = weft__word_at(bytes + i * WEFT__WORD);
        hash = (hash ^ word ^ (word >> 32)) * UINT64_C(0x100000001b3);
        hash ^= hash >> 29;
    }
    return hash;
}

#endif
