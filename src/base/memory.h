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

/* Resizes the block that the pointer at `to` points to; false: no memory, and nothing
 * is changed. */
static inline bool weft__resized(const weft_allocator *memory, void *to, size_t count,
                                 size_t size)
{
    void *block;
    memcpy(&block, to, sizeof block);
    block = weft__resize(memory, block, count, size);
    if (block != NULL) {
        memcpy(to, &block, sizeof block);
    }
    return block != NULL;
}

/* Room for `count` elements in the block that the pointer at `to` points to, which has
 * *room; grows by more than that, as further ones will come. Else as weft__resized. */
static inline bool weft__reserve(const weft_allocator *memory, void *to, size_t *room,
                                 size_t count, size_t size)
{
    const size_t more = count + count / 2 + 16;
    if (count <= *room) {
        return true;
    }
    if (!weft__resized(memory, to, more, size)) {
        return false;
    }
    *room = more;
    return true;
}

static inline char *weft__copy_text(const weft_allocator *memory, const char *text)
{
    const size_t size = strlen(text) + 1;
    char *copy = weft__alloc(memory, size, 1);
    return copy == NULL ? NULL : memcpy(copy, text, size);
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
