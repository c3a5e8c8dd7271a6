/* SPDX-License-Identifier: BSD-3-Clause */
/* self_chunk.c -- the pairs of a weft__self_list and their room. */
#include "forces/contact/self/self_list.h"

#include <string.h>

enum { STRETCH = 256, ROOM = 512 };

static void free_pairs(const weft_allocator *memory, weft__self_pairs *of)
{
    WEFT__FREE_ALL(memory, of->near.particle[0], of->near.slack);
    *of = (weft__self_pairs){ .count = 0 };
}

static bool make_pairs(const weft_allocator *memory, size_t room, weft__self_pairs *of)
{
    const size_t all = room + WEFT__BLOCK;
    weft__near *near = &of->near;
    free_pairs(memory, of);
    near->particle[0] = weft__zeroed(memory, WEFT__NEAR_PLANES * all, sizeof(int32_t));
    near->slack = weft__zeroed(memory, 4 * all, sizeof(double));
    if (near->particle[0] == NULL || near->slack == NULL) {
        return false;
    }
    for (size_t k = 0; k < WEFT__NEAR_PLANES; ++k) {
        near->particle[k] = near->particle[0] + k * all;
    }
    for (size_t k = 0; k < 4; ++k) {
        of->numbers[k] = near->slack + k * all;
    }
    near->mass = of->numbers[1], near->rest = of->numbers[2];
    of->distances = of->numbers[3];
    return true;
}

static bool self_chunk_make_groups(const weft_allocator *memory, size_t most,
                                   weft__self_groups *of)
{
    of->at = weft__alloc(memory, most, sizeof *of->at);
    of->subsets = weft__alloc(memory, most, sizeof *of->subsets);
    return of->at != NULL && of->subsets != NULL;
}

bool weft__self_chunk_grow(const weft_allocator *memory, weft__self_chunk *of)
{
    bool made = true;
    of->room = (of->wanted / STRETCH + 1) * STRETCH;
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        weft__self_bin *at = &of->bins[kind];
        weft__free(memory, at->pushes);
        at->pushes
            = weft__alloc(memory, of->room / WEFT__BLOCK + 1, sizeof *at->pushes);
        made = make_pairs(memory, of->room, &at->now)
               && make_pairs(memory, of->room, &at->before) && at->pushes != NULL
               && made;
    }
    of->room = made ? of->room : 0;
    of->full = false;
    return made;
}

bool weft__self_chunk_create(const weft_allocator *memory, size_t first, size_t end,
                             weft__self_chunk *out)
{
    *out = (weft__self_chunk){ .first = first, .end = end, .wanted = ROOM };
    return self_chunk_make_groups(memory, end - first + 1, &out->now)
           && self_chunk_make_groups(memory, end - first + 1, &out->before)
           && weft__self_chunk_grow(memory, out);
}

void weft__self_chunk_free(const weft_allocator *memory, weft__self_chunk *of)
{
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        weft__self_bin *at = &of->bins[kind];
        free_pairs(memory, &at->now);
        free_pairs(memory, &at->before);
        weft__free(memory, at->pushes);
    }
    WEFT__FREE_ALL(memory, of->now.at, of->now.subsets, of->before.at,
                   of->before.subsets);
}

/* Adds successive pairs of others, or of the same, which may have them there already.
 */
static void self_chunk_add_run(const weft__self_pairs *from, size_t first, size_t count,
                               weft__self_pairs *to)
{
    const size_t at = to->count;
    const bool stay = from == to && at == first;
    for (size_t k = 0; k < WEFT__NEAR_PLANES && !stay; ++k) {
        memmove(to->near.particle[k] + at, from->near.particle[k] + first,
                count * sizeof *to->near.particle[k]);
    }
    for (size_t k = 0; k < 4 && !stay; ++k) {
        memmove(to->numbers[k] + at, from->numbers[k] + first,
                count * sizeof *to->numbers[k]);
    }
    to->count += count;
}

static void add_some(const weft__self_pairs *from, const uint32_t *which, size_t count,
                     weft__self_pairs *to)
{
    for (size_t k = 0; k < WEFT__NEAR_PLANES; ++k) {
        for (size_t j = 0; j < count; ++j) {
            to->near.particle[k][to->count + j] = from->near.particle[k][which[j]];
        }
    }
    for (size_t k = 0; k < 4; ++k) {
        for (size_t j = 0; j < count; ++j) {
            to->numbers[k][to->count + j] = from->numbers[k][which[j]];
        }
    }
    to->count += count;
}

void weft__self_pairs_add(const weft__self_pairs *from, size_t first, size_t end,
                          const double *numbers, double most, weft__within_fn *within,
                          weft__self_pairs *to)
{
    uint32_t which[WEFT__STRIP + WEFT__BLOCK];
    while (first < end) {
        const size_t strip = end - first < WEFT__STRIP ? end - first : WEFT__STRIP;
        const size_t count = within(numbers, first, first + strip, most, which);
        if (count == strip) {
            self_chunk_add_run(from, first, count, to);
        } else {
            add_some(from, which, count, to);
        }
        first += strip;
    }
}

void weft__self_chunk_copy(weft__self_chunk *of, size_t i)
{
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        weft__self_bin *in = &of->bins[kind];
        const size_t first = weft__self_first(&of->before, i, kind);
        const size_t count = of->before.subsets[i].end[kind] - first;
        if (in->now.count + count > of->room) {
            of->full = true;
            return;
        }
        const weft__self_pairs *from = of->stays ? &in->now : &in->before;
        self_chunk_add_run(from, first, count, &in->now);
    }
}

bool weft__self_chunk_keep(void *ctx, const weft__pair *pair)
{
    weft__self_chunk *to = ctx;
    weft__self_pairs *of = &to->bins[pair->kind].now;
    if (of->count < to->room) {
        for (size_t k = 0; k < 4; ++k) {
            of->near.particle[k][of->count] = (int32_t)pair->particle[k];
        }
        of->near.particle[4][of->count] = (int32_t)pair->item[0];
        of->near.particle[5][of->count] = (int32_t)pair->item[1];
    }
    ++of->count;
    return true;
}

bool weft__self_chunk_full(weft__self_chunk *of)
{
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        const size_t count = of->bins[kind].now.count;
        of->full = of->full || count > of->room;
        if (2 * count > of->room && 3 * count > of->wanted) {
            of->wanted = 3 * count;
        }
    }
    return of->full;
}

void weft__self_chunk_begin(weft__self_chunk *of, bool stays)
{
    const weft__self_groups old = of->now;
    of->now = of->before, of->before = old;
    of->now.count = 0;
    of->stays = stays;
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        weft__self_bin *in = &of->bins[kind];
        const weft__self_pairs other = stays ? in->before : in->now;
        in->now = stays ? in->now : in->before, in->before = other;
        in->now.count = 0;
    }
}
