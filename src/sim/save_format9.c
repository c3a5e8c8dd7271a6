/* SPDX-License-Identifier: BSD-3-Clause */
/* save_format9.c -- the front of a simulation that 0.2 saved, as save.c writes it now.
 * Its fields end with flags, whose first bit tells that the wind was changed and the
 * second one of a passage, and the words of the wind; behind the quadratures there are
 * the words of contact. */
#include "base/memory.h"
#include "sim/save.h"

enum {
    FLAGS = offsetof(weft__save_head, fields.flags) / WEFT__WORD,
    AIR = 4, /* velocity and drag */
    HEAD_9 = FLAGS + 1 + AIR
};

size_t weft__save_front_9(const weft_sim *sim)
{
    return HEAD_9 + sim->config.quadratures + 1;
}

unsigned char *weft__save_from_9(const weft_sim *sim, const unsigned char *front,
                                 size_t words, size_t *now)
{
    const size_t quadratures = sim->config.quadratures;
    const size_t last = words - weft__save_front_9(sim);
    const size_t changes = 2 * WEFT__CHANGES_HEAD + 1 + AIR + last;
    const uint64_t flags = weft__word_at(front + FLAGS * WEFT__WORD);
    *now = weft__save_front(sim, changes);
    unsigned char *out = weft__alloc(&sim->memory, *now, WEFT__WORD);
    if (out == NULL) {
        return NULL;
    }
    unsigned char *to = out + SAVE_HEAD * WEFT__WORD;
    memcpy(out, front, FLAGS * WEFT__WORD);
    weft__word_put(out + FLAGS * WEFT__WORD, flags >> 1);
    weft__word_put(to - WEFT__WORD, changes);
    memcpy(to, front + HEAD_9 * WEFT__WORD, quadratures * WEFT__WORD);
    to = weft__changes_begin(to + quadratures * WEFT__WORD, "wind", 1 + AIR);
    weft__word_put(to, flags & 1);
    memcpy(to + WEFT__WORD, front + (FLAGS + 1) * WEFT__WORD, AIR * WEFT__WORD);
    to = weft__changes_begin(to + (1 + AIR) * WEFT__WORD, "contact", last);
    memcpy(to, front + (HEAD_9 + quadratures) * WEFT__WORD, (last + 1) * WEFT__WORD);
    return out;
}
