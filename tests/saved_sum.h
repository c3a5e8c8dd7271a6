/* SPDX-License-Identifier: BSD-3-Clause */
/* saved_sum.h -- the checksums of forged bytes, as include/weft/cloth.h describes
 * them. */
#pragma once

#include <stdbool.h>

#include "base/bytes.h"

/* Words of a saved simulation. */
enum { SAVED_ROWS = 2, SAVED_COLS = 3, SAVED_ENERGIES = 35, SAVED_PLANES = 7 };

static inline uint64_t saved_word(const unsigned char *bytes, size_t at)
{
    return weft__word_at(bytes + WEFT__WORD * at);
}

/* Words before the planes, 0 if there is no room for these; the last is the checksum.
 */
static inline size_t saved_front(const unsigned char *bytes, size_t size)
{
    const size_t words = size / WEFT__WORD;
    const uint64_t rows = words > SAVED_ENERGIES ? saved_word(bytes, SAVED_ROWS) : 0;
    const uint64_t cols = words > SAVED_ENERGIES ? saved_word(bytes, SAVED_COLS) : 0;
    const bool fits = rows > 0 && cols > 0 && rows <= words && cols <= words
                      && rows * cols <= (words - SAVED_ENERGIES - 1) / SAVED_PLANES;
    return fits ? words - SAVED_PLANES * (size_t)(rows * cols) : 0;
}

/* Makes it right, if there is one. */
static inline void saved_mend(unsigned char *bytes, size_t size)
{
    const size_t front = saved_front(bytes, size);
    if (front == 0) {
        return;
    }
    const size_t rows = (size_t)saved_word(bytes, SAVED_ROWS);
    const size_t cols = (size_t)saved_word(bytes, SAVED_COLS);
    uint64_t sum = weft__words_sum(bytes, front - 1);
    for (size_t r = 0; r < rows; ++r) {
        uint64_t row = WEFT__HASH_START;
        for (size_t j = 0; j < SAVED_PLANES * cols; ++j) {
            const size_t at = front + (j / cols * rows + r) * cols + j % cols;
            row = weft__hash_word(row, saved_word(bytes, at));
        }
        sum = weft__hash_word(sum, row);
    }
    weft__word_put(bytes + WEFT__WORD * (front - 1), sum);
}
