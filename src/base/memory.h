/* SPDX-License-Identifier: BSD-3-Clause */
/* memory.h -- allocation by weft_allocator, for all of libweft. */
#pragma once

#include <string.h>

#include "weft/base.h"

/* Room for at least one byte; NULL also where the product is too large. */
static inline void *weft__resize(const weft_allocator *memory, void *block,
                                 size_t count, size_t size)
{
    if (count > SIZE_MAX / size) {
        return NULL;
    }
    return memory->resize(memory->ctx, block, count == 0 ? 1 : count * size);
}

static inline void *weft__alloc(const weft_allocator *memory, size_t count, size_t size)
{
    return weft__resize(memory, NULL, count, size);
}

static inline void *weft__zeroed(const weft_allocator *memory, size_t count,
                                 size_t size)
{
    void *block = weft__alloc(memory, count, size);
    return block == NULL ? NULL : memset(block, 0, count * size);
}

static inline void weft__free(const weft_allocator *memory, void *block)
{
    if (block != NULL) {
        (void)memory->resize(memory->ctx, block, 0);
    }
}

/* Frees all blocks that are given, of which any may be NULL. */
#define WEFT__FREE_ALL(memory, ...)                                                    \
    weft__free_list((memory), (void *const[]){ __VA_ARGS__ },                          \
                    sizeof((void *const[]){ __VA_ARGS__ }) / sizeof(void *))

static inline void weft__free_list(const weft_allocator *memory, void *const *blocks,
                                   size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        weft__free(memory, blocks[i]);
    }
}
