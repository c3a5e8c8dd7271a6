/* SPDX-License-Identifier: BSD-3-Clause */
/* pile.h -- memory that is taken piece by piece and given back at once. */
#pragma once

#include "weft/stepper.h"

/* Starts with a memory and nothing else. */
typedef struct weft__pile {
    weft_allocator memory;
    void *last;  /* piece, which begins with the address of the one before */
    bool failed; /* a piece could not be had */
} weft__pile;

/* Room for `count` items, not initialised. After a failure all are NULL. */
static inline void *weft__pile_take(weft__pile *self, size_t count, size_t size)
{
    enum { HEAD = 64 };
    char *piece = NULL;
    if (!self->failed && count <= (SIZE_MAX - HEAD) / size) {
        piece = self->memory.resize(self->memory.ctx, NULL, HEAD + count * size);
    }
    if (piece == NULL) {
        self->failed = true;
        return NULL;
    }
    memcpy(piece, &self->last, sizeof self->last);
    self->last = piece;
    return piece + HEAD;
}

static inline void weft__pile_free(weft__pile *self)
{
    while (self->last != NULL) {
        void *piece = self->last;
        memcpy(&self->last, piece, sizeof self->last);
        (void)self->memory.resize(self->memory.ctx, piece, 0);
    }
}
