/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/slice.h"

#include "base/grow.h"

bool weft__slice_list(const weft__slice *slice, void *to, size_t size)
{
    char *from, *list = weft__alloc(slice->memory, slice->particles, size);
    memcpy(&from, to, sizeof from);
    if (list == NULL) {
        return false;
    }
    for (size_t i = 0; i < slice->particles; ++i) {
        memcpy(list + i * size, from + slice->whole[i] * size, size);
    }
    weft__free(slice->memory, from);
    memcpy(to, &list, sizeof list);
    return true;
}

void weft__slice_range(const weft__slice *slice, void *to, size_t first, size_t count,
                       size_t size)
{
    char *list;
    memcpy(&list, to, sizeof list);
    memmove(list, list + first * size, count * size);
    (void)weft__resized(slice->memory, to, count, size);
}

/* Whether a corner is in an own block. */
static bool is_own(const weft__slice *slice, const uint32_t corner[3])
{
    bool own = false;
    for (size_t k = 0; k < 3; ++k) {
        const size_t block = corner[k] / WEFT__MESH_BLOCK;
        own = own || (block >= slice->first && block < slice->first + slice->own);
    }
    return own;
}

/* Triangle t of the whole becomes the next one here. */
static void slice_keep(weft__triangles *of, const weft__slice *slice, size_t t,
                       size_t next)
{
    slice->triangle[t] = (uint32_t)next;
    for (size_t k = 0; k < 3; ++k) {
        of->corner[next][k] = slice->here[of->corner[t][k]];
        of->place[next][k] = of->place[t][k];
        of->edge[next][k] = of->edge[t][k];
    }
    of->piece[next] = of->piece[t];
    of->fabric[next] = of->fabric[t];
    of->area[next] = of->area[t];
    if (of->frame != NULL) {
        of->in_space[next] = of->in_space[t];
        memcpy(of->frame[next], of->frame[t], sizeof of->frame[t]);
    }
}

/* Gives back the room of what is not here. Places keep their numbers; of edges there is
 * nothing. */
static void shrink(weft__mesh *mesh, const weft__slice *slice)
{
    weft__triangles *of = mesh->triangles;
#define SHRINK(array, count)                                                           \
    weft__slice_range(slice, &(array), 0, count, sizeof *(array));
    SHRINK(of->corner, of->count)
    SHRINK(of->place, of->count)
    SHRINK(of->edge, of->count)
    SHRINK(of->piece, of->count)
    SHRINK(of->fabric, of->count)
    SHRINK(of->area, of->count)
    if (of->frame != NULL) {
        SHRINK(of->in_space, of->count)
        SHRINK(of->frame, of->count)
    }
    SHRINK(of->around, 3 * of->count)
    SHRINK(of->around_first, mesh->particles + 1)
    SHRINK(of->rest, of->places)
    SHRINK(of->mirrored, of->places)
    SHRINK(of->particle, of->places)
    of->edges = 0;
    SHRINK(of->edge_list, 0)
    SHRINK(mesh->inverse_mass, mesh->particles + WEFT_PAST)
}

bool weft__mesh_slice(weft__mesh *mesh, const weft__slice *slice)
{
    weft__triangles *of = mesh->triangles;
    size_t count = 0;
    if (!weft__slice_list(slice, &mesh->mass, sizeof *mesh->mass)
        || !weft__slice_list(slice, &mesh->pin, sizeof *mesh->pin)
        || !weft__slice_list(slice, &of->start, 3 * sizeof *of->start)
        || !weft__slice_list(slice, &of->lumped, sizeof *of->lumped)
        || (of->space != NULL
            && !weft__slice_list(slice, &of->space, 3 * sizeof *of->space))) {
        return false;
    }
    for (size_t t = 0; t < of->count; ++t) {
        slice->triangle[t] = WEFT__NONE;
        if (is_own(slice, of->corner[t])) {
            slice_keep(of, slice, t, count++);
        }
    }
    of->count = count;
    weft__around_fill(of, slice->particles);
    mesh->band.first = slice->first;
    mesh->band.own = slice->own;
    mesh->band.above = slice->above;
    mesh->particles = mesh->stride = slice->particles;
    mesh->band.below = (slice->particles + WEFT__MESH_BLOCK - 1) / WEFT__MESH_BLOCK
                       - slice->above - slice->own;
    shrink(mesh, slice);
    mesh->pinned = 0;
    for (size_t i = 0; i < mesh->particles; ++i) {
        mesh->pinned += mesh->pin[i] != 0;
    }
    return true;
}
