/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_init.c -- a membrane from its mesh: the batches of its blocks. */
#include <stdlib.h>

#include "base/grow.h"
#include "base/plane.h"
#include "forces/membrane/membrane.h"
#include "mesh/triangles_work.h"

enum { WINDOW = 64, LINE = 64 }; /* triangles; [bytes] of a cache line */

/* What is needed to make them. */
typedef struct maker {
    weft__membrane *own;
    const weft__triangles *of;
    const weft_allocator *memory;
    uint32_t *near;  /* of a particle: its number in the present block, or WEFT__NONE */
    uint32_t *taken; /* of a particle: 1 + the batch that had it last */
    uint32_t *list, *next; /* triangles of the block that wait, and which follows */
    size_t batches, batch_room, halos, halo_room;
} maker;

/* Numbers the particles of the `count` triangles listed, own ones first. */
static bool number_particles(maker *by, size_t b, size_t count)
{
    const weft__mesh *mesh = by->own->mesh;
    const size_t first = weft__block(mesh, b), own = weft__block(mesh, b + 1) - first;
    const size_t begin = by->halos;
    for (size_t i = 0; i < own; ++i) {
        by->near[first + i] = (uint32_t)i;
    }
    for (size_t j = 0; j < 3 * count; ++j) {
        const uint32_t i = by->of->corner[by->list[j / 3]][j % 3];
        if (by->near[i] == WEFT__NONE) {
            if (!weft__reserve(by->memory, &by->own->halo, &by->halo_room,
                               by->halos + 1, sizeof *by->own->halo)) {
                return false;
            }
            by->near[i] = 0;
            by->own->halo[by->halos++] = i;
        }
    }
    if (by->halos > begin) {
        qsort(by->own->halo + begin, by->halos - begin, sizeof *by->own->halo,
              weft__ascending);
    }
    for (size_t j = begin; j < by->halos; ++j) {
        by->near[by->own->halo[j]] = (uint32_t)(own + (j - begin));
    }
    return true;
}

/* Takes for one batch the first that wait and have no particle in common; what waits
 * begins at *head. */
static void take_batch(maker *by, uint32_t *head, weft__batch_corners *to)
{
    const uint32_t *taken = by->taken, batch = (uint32_t)by->batches + 1;
    size_t lane = 0;
    uint32_t *link = head;
    for (size_t tries = 0; *link != WEFT__NONE && lane < WEFT__WIDTH && tries < WINDOW;
         ++tries) {
        const uint32_t at = *link, t = by->list[at], *corner = by->of->corner[t];
        if (taken[corner[0]] == batch || taken[corner[1]] == batch
            || taken[corner[2]] == batch) {
            link = &by->next[at];
            continue;
        }
        to->triangle[lane] = t;
        for (size_t k = 0; k < 3; ++k) {
            by->taken[corner[k]] = batch;
            to->near[k][lane] = (uint16_t)by->near[corner[k]];
        }
        ++lane;
        *link = by->next[at];
    }
}

static bool make_block(maker *by, size_t b)
{
    weft__membrane *own = by->own;
    const weft__mesh *mesh = own->mesh;
    const size_t first = weft__block(mesh, b), end = weft__block(mesh, b + 1);
    const size_t count = weft__triangles_among(by->of, first, end, by->list);
    own->blocks[b] = (weft__membrane_block){ by->batches, by->halos };
    if (!number_particles(by, b, count)) {
        return false;
    }
    const size_t missing = (end - first) + (by->halos - own->blocks[b].halo);
    for (size_t j = 0; j < count; ++j) {
        by->next[j] = j + 1 < count ? (uint32_t)j + 1 : WEFT__NONE;
    }
    /* a block of particles of grids has no triangles */
    for (uint32_t head = count > 0 ? 0 : WEFT__NONE; head != WEFT__NONE;
         ++by->batches) {
        if (!weft__reserve(by->memory, &own->corners, &by->batch_room, by->batches + 1,
                           sizeof *own->corners)) {
            return false;
        }
        weft__batch_corners *to = &own->corners[by->batches];
        for (size_t lane = 0; lane < WEFT__WIDTH; ++lane) {
            to->triangle[lane] = WEFT__NONE;
            for (size_t k = 0; k < 3; ++k) {
                to->near[k][lane] = (uint16_t)missing;
            }
        }
        take_batch(by, &head, to);
    }
    for (size_t i = first; i < end; ++i) {
        by->near[i] = WEFT__NONE;
    }
    for (size_t j = own->blocks[b].halo; j < by->halos; ++j) {
        by->near[own->halo[j]] = WEFT__NONE;
    }
    return true;
}

/* Batches in `room`, which has space for so many. */
static weft__batch *aligned(void *room)
{
    return (void *)((char *)room + (LINE - (uintptr_t)room % LINE) % LINE);
}

static bool make_constants(maker *by)
{
    weft__membrane *own = by->own;
    own->room = weft__zeroed(by->memory, by->batches + 1, sizeof *own->batches);
    if (own->room == NULL) {
        return false;
    }
    own->batches = aligned(own->room);
    for (size_t j = 0; j < by->batches * WEFT__WIDTH; ++j) {
        const size_t g = j / WEFT__WIDTH, lane = j % WEFT__WIDTH;
        const uint32_t t = own->corners[g].triangle[lane];
        if (t != WEFT__NONE) {
            double constants[WEFT__CONSTANTS];
            weft__membrane_constants(by->of, t, constants);
            for (size_t k = 0; k < 3; ++k) {
                constants[WEFT__SQUARE + k] += weft__arc_bow(own, t, k);
            }
            for (size_t k = 0; k < WEFT__CONSTANTS; ++k) {
                own->batches[g].of[k][lane] = constants[k];
            }
            own->damped = own->damped || constants[WEFT__LAG] != 0.0;
        }
    }
    return true;
}

static bool membrane_init_make(maker *by)
{
    const weft__mesh *mesh = by->own->mesh;
    const size_t blocks = weft__blocks(mesh);
    by->own->blocks = weft__zeroed(by->memory, blocks + 1, sizeof *by->own->blocks);
    if (by->near == NULL || by->taken == NULL || by->list == NULL || by->next == NULL
        || by->own->blocks == NULL) {
        return false;
    }
    memset(by->near, 0xff, mesh->particles * sizeof *by->near);
    for (size_t b = 0; b < blocks; ++b) {
        if (!make_block(by, b)) {
            return false;
        }
    }
    by->own->blocks[blocks] = (weft__membrane_block){ by->batches, by->halos };
    /* gives back what is beyond their ends */
    (void)weft__resized(by->memory, &by->own->corners, by->batches,
                        sizeof *by->own->corners);
    (void)weft__resized(by->memory, &by->own->halo, by->halos, sizeof *by->own->halo);
    return make_constants(by);
}

bool weft__membrane_init(void *own, const weft_cloth_def *def,
                         const weft_allocator *memory)
{
    weft__membrane *of = own;
    const weft__triangles *triangles = of->mesh->triangles;
    if (triangles == NULL || triangles->count == 0) {
        return true;
    }
    const size_t n = of->mesh->particles;
    maker by = { .own = of, .of = triangles, .memory = memory };
    by.near = weft__alloc(memory, n, sizeof *by.near);
    by.taken = weft__zeroed(memory, n, sizeof *by.taken);
    by.list = weft__alloc(memory, triangles->count, sizeof *by.list);
    by.next = weft__alloc(memory, triangles->count, sizeof *by.next);
    const bool made = weft__arc_measure(of, def->stop_ctx, memory)
                      && membrane_init_make(&by) && weft__membrane_weigh(of, memory)
                      && weft__arc_create(of, memory)
                      && weft__membrane_list_couplings(of, memory);
    WEFT__FREE_ALL(memory, by.near, by.taken, by.list, by.next);
    return made;
}

bool weft__membrane_slice(void *own, const weft__slice *slice)
{
    weft__membrane *of = own;
    const weft__membrane_block from = of->blocks[slice->first],
                               end = of->blocks[slice->first + slice->own];
    const size_t batches = end.batch - from.batch, halos = end.halo - from.halo;
    const size_t last = (slice->particles + WEFT__MESH_BLOCK - 1) / WEFT__MESH_BLOCK;
    void *room = weft__alloc(slice->memory, batches + 1, sizeof *of->batches);
    if (room == NULL || !weft__slice_list(slice, &of->weight, sizeof *of->weight)) {
        weft__free(slice->memory, room);
        return false;
    }
    memcpy(aligned(room), of->batches + from.batch, batches * sizeof *of->batches);
    weft__free(slice->memory, of->room);
    of->room = room;
    of->batches = aligned(room);
    weft__slice_range(slice, &of->corners, from.batch, batches, sizeof *of->corners);
    weft__slice_range(slice, &of->halo, from.halo, halos, sizeof *of->halo);
    for (size_t j = 0; j < halos; ++j) {
        of->halo[j] = slice->here[of->halo[j]];
    }
    for (size_t j = 0; j < batches * WEFT__WIDTH; ++j) {
        uint32_t *t = &of->corners[j / WEFT__WIDTH].triangle[j % WEFT__WIDTH];
        *t = *t != WEFT__NONE ? slice->triangle[*t] : WEFT__NONE;
    }
    memmove(of->blocks + slice->above, of->blocks + slice->first,
            (slice->own + 1) * sizeof *of->blocks);
    weft__slice_range(slice, &of->coupling, 0, 0,
                      sizeof *of->coupling); /* of implicit steps */
    memset(of->coupling_first, 0, (slice->particles + 1) * sizeof *of->coupling_first);
    weft__slice_range(slice, &of->coupling_first, 0, slice->particles + 1,
                      sizeof *of->coupling_first);
    for (size_t b = 0; b <= last; ++b) { /* ghosts have nothing */
        weft__membrane_block *at = &of->blocks[b];
        const bool before = b<slice->above, after = b> slice->above + slice->own;
        at->batch = before ? 0 : after ? batches : at->batch - from.batch;
        at->halo = before ? 0 : after ? halos : at->halo - from.halo;
    }
    return true;
}

/* K is at most some 100 C L / h^3 of a triangle's longest edge and height. */
void weft__membrane_check(const weft_cloth_def *def, const weft__faults *to)
{
    const size_t field = offsetof(weft_cloth_def, mesh);
    const weft_mesh_def *mesh = def->mesh;
    for (size_t t = 0; mesh != NULL && t < mesh->triangles; ++t) {
        const weft_fabric *of
            = &mesh->fabrics[mesh->fabric_of != NULL ? mesh->fabric_of[t] : 0];
        double longest;
        const double area = fabs(weft__twice_area(mesh, t, &longest));
        const double height = area / longest;
        const double most = 100.0 * (of->stretch[0] + of->stretch[1] + of->shear)
                            * (longest / height) / height / height;
        if (!(isfinite(most) && isfinite(most * of->damping[0])
              && area * area > 1e-290)) {
            weft__fault(to, field, field,
                        "the membrane of triangle %zu is too stiff or too small for a "
                        "double at its height of %.3g m",
                        t, height);
            return;
        }
    }
}

bool weft__membrane_copy(void *own, const weft_allocator *memory)
{
    (void)memory;
    ((weft__membrane *)own)->shared = true;
    return true;
}

void weft__membrane_free(void *own, const weft_allocator *memory)
{
    weft__membrane *of = own;
    if (!of->shared) {
        WEFT__FREE_ALL(memory, of->blocks, of->room, of->corners, of->halo,
                       of->coupling_first, of->coupling, of->weight);
        weft__arc_free(&of->arc, memory);
    }
}
