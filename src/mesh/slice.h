/* SPDX-License-Identifier: BSD-3-Clause */
/* slice.h -- a band of a mesh of triangles, cut out of the tables of the whole: blocks
 * of its own, and as ghosts the particles that these read. The order of the particles
 * is that of the whole, so that all sums have its order too: first the ghosts of the
 * blocks before, in blocks of their own (the first ghost stands for those that are
 * missing in the first of them), then the own blocks, then the other ghosts. */
#pragma once

#include "base/memory.h"
#include "mesh/triangles.h"

typedef struct weft__slice {
    size_t first, own, above; /* blocks: of the whole, of these the first; here */
    size_t particles;
    uint32_t *whole;    /* of a particle here: its number in the whole */
    uint32_t *here;     /* of a particle of the whole: its number here, WEFT__NONE */
    uint32_t *triangle; /* the same of triangles */
    const weft_allocator *memory;
} weft__slice;

/* Makes particles [0, n) of a list those that are here, and frees the others' room.
 * `to` points to the pointer. False: no memory, and nothing is changed. */
bool weft__slice_list(const weft__slice *slice, void *to, size_t size);

/* Moves `count` items of a list to its front, and frees the room of the others. */
void weft__slice_range(const weft__slice *slice, void *to, size_t first, size_t count,
                       size_t size);

/* Masses, pins and triangles: those that have a corner in an own block. Fills
 * slice->triangle. False: no memory. */
bool weft__mesh_slice(weft__mesh *mesh, const weft__slice *slice);
