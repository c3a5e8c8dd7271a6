/* SPDX-License-Identifier: BSD-3-Clause */
/* changes.c -- what a simulation may change of the forces of its cloth, in words: of
 * each force that has any its name, how many there are, and they. */
#include "base/bytes.h"
#include "cloth/grids.h"

static const weft__force_changes *changes_of(size_t k)
{
    const weft__force_changes *of = &weft__table[k].force->changes;
    return of->words != NULL ? of : NULL;
}

/* Its name, of which at most 8 characters are a word. */
static uint64_t name_word(size_t k)
{
    unsigned char bytes[WEFT__WORD] = { 0 };
    const char *name = weft__table[k].force->name;
    for (size_t i = 0; i < WEFT__WORD && name[i] != '\0'; ++i) {
        bytes[i] = (unsigned char)name[i];
    }
    return weft__word_at(bytes);
}

enum { PART = 2 }; /* words before those of a force: its name, their number */

size_t weft__changes_words(const weft_cloth *cloth)
{
    size_t words = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        words += of != NULL ? PART + of->words(weft__own(cloth, k)) : 0;
    }
    return words;
}

void weft__changes_put(const weft_cloth *cloth, unsigned char *to)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_changes *of = changes_of(k);
        if (of != NULL) {
            const size_t words = of->words(weft__own(cloth, k));
            weft__word_put(to, name_word(k));
            weft__word_put(to + WEFT__WORD, words);
            of->put(weft__own(cloth, k), to + PART * WEFT__WORD);
            to += (PART + words) * WEFT__WORD;
        }
    }
}

/* The words of force k, and how many; 0: there are none. */
static const unsigned char *changes_part_of(size_t k, const unsigned char *from,
                                            size_t words, size_t *own)
{
    *own = 0;
    while (words >= PART) {
        const uint64_t count = weft__word_at(from + WEFT__WORD);
        if (count > words - PART) {
            return from;
        }
        if (weft__word_at(from) == name_word(k)) {
            *own = (size_t)count;
            return from + PART * WEFT__WORD;
        }
        from += (PART + count) * WEFT__WORD;
        words -= PART + (size_t)count;
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
            used += own > 0 ? PART + own : 0;
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
