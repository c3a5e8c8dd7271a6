/* SPDX-License-Identifier: BSD-3-Clause */
/* grow.h -- blocks of memory.h that grow, are copied, or are shown as const. */
#pragma once

#include "base/memory.h"

/* A block of one's own that others are shown as const. */
static inline void *weft__unconst(const void *shown)
{
    void *block;
    memcpy(&block, &shown, sizeof block);
    return block;
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
