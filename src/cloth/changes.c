/* SPDX-License-Identifier: BSD-3-Clause */
/* changes.c -- what a simulation may change of the forces of its cloth. Saved, it is a
 * row of words: for each force that has any, its name, their number and the words. */
#include "cloth/grids.h"

#include <string.h>

#include "base/bytes.h"

static const weft__force_changes *changes_of(size_t k)
{
    const weft__force_changes *of = &weft__table[k].force->changes;
    return of->words != NULL ? of : NULL;
}

unsigned char *weft__changes_begin(unsigned char *to, const char *name, size_t words)
{
    memset(to, 0, WEFT__WORD);
    memcpy(to, name, strnlen(name, WEFT__WORD));
    weft__word_put(to + WEFT__WORD, words);
    return to + WEFT__CHANGES_HEAD * WEFT__WORD;
}

size_t weft__changes_words(const weft_cloth *cloth)
{
    size_t words = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        words += of != NULL ? WEFT__CHANGES_HEAD + of->words(weft__own(cloth, k)) : 0;
    }
    return words;
}

void weft__changes_put(const weft_cloth *cloth, unsigned char *to)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        if (of != NULL) {
            const size_t words = of->words(weft__own(cloth, k));
            to = weft__changes_begin(to, weft__table[k].force->name, words);
            of->put(weft__own(cloth, k), to);
            to += words * WEFT__WORD;
        }
    }
}

/* The words of force k, and how many; 0: there are none. */
static const unsigned char *changes_part_of(size_t k, const unsigned char *from,
                                            size_t words, size_t *own)
{
    unsigned char head[WEFT__CHANGES_HEAD * WEFT__WORD];
    (void)weft__changes_begin(head, weft__table[k].force->name, 0);
    *own = 0;
    while (words >= WEFT__CHANGES_HEAD) {
        const uint64_t count = weft__word_at(from + WEFT__WORD);
        if (count > words - WEFT__CHANGES_HEAD) {
            return from;
        }
        const bool found = memcmp(from, head, WEFT__WORD) == 0;
        from += WEFT__CHANGES_HEAD * WEFT__WORD;
        if (found) {
            *own = (size_t)count;
            return from;
        }
        from += count * WEFT__WORD;
        words -= WEFT__CHANGES_HEAD + (size_t)count;
    }
    return from;
}

weft_status weft__changes_take(weft_cloth *taken, const unsigned char *from,
                               size_t words, const weft_allocator *memory,
                               weft_error *err)
{
    weft_status status = WEFT_OK;
    size_t used = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        if (of != NULL) {
            size_t own;
            const unsigned char *part = changes_part_of(k, from, words, &own);
            const weft_status one = of->take(weft__own_of(taken, k), part, own, memory,
                                             status == WEFT_OK ? err : NULL);
            status = status == WEFT_OK ? one : status;
            used += own > 0 ? WEFT__CHANGES_HEAD + own : 0;
        }
    }
    return used == words ? status
                         : weft_error_set(err, WEFT_INVALID,
                                          "the saved simulation is damaged or cut off");
}

void weft__changes_exchange(weft_cloth *cloth, weft_cloth *taken)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        if (of != NULL) {
            of->exchange(weft__own_of(cloth, k), weft__own_of(taken, k));
        }
    }
    weft__grids_attach(cloth);
}

void weft__changes_drop(weft_cloth *taken, const weft_allocator *memory)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        if (of != NULL && of->drop != NULL) {
            of->drop(weft__own_of(taken, k), memory);
        }
    }
}
