/* SPDX-License-Identifier: BSD-3-Clause */
/* slit_edges.c -- pairs of primitives of one piece that are nearer than two thicknesses
 * in its flat rest shape. At a slit, where two slit edges lie on each other, they never
 * act; elsewhere they are a notch that is too narrow for the thickness. Where the rest
 * shape lies in space, pairs that are as near there never act if a path of at most two
 * edges joins them; others are layers, which act. */
#include <stdlib.h>

#include "base/grow.h"
#include "forces/contact/self/self.h"

/* Slit edges lie on each other that are nearer than this part of the thickness. */
#define TOGETHER 1e-2
#define ROUNDOFF 1e-9

typedef struct near_pair {
    weft__pair pair; /* of particles */
    double distance;
} near_pair;

typedef struct slit_search {
    const weft__triangles *of;
    const weft__contact_surface *surface; /* of particles */
    const weft__self *flat;               /* of places */
    const weft_allocator *memory;
    const double *y;
    double range;
    near_pair *at;
    size_t count, room;
    bool no_memory;
} slit_search;

/* The same pair of particles; false: they have one in common. */
static bool to_particles(const slit_search *of, const weft__pair *from, weft__pair *to)
{
    const size_t all = weft__pair_particles(from);
    const size_t first = from->kind == WEFT__EDGES ? 2 : 1;
    *to = *from;
    for (size_t k = 0; k < all; ++k) {
        to->particle[k] = of->of->particle[from->particle[k]];
    }
    for (size_t k = 0; k < first * (all - first); ++k) {
        if (to->particle[k % first] == to->particle[first + k / first]) {
            return false;
        }
    }
    const uint32_t *p = to->particle;
    to->item[0]
        = first == 1 ? p[0] : weft__contact_surface_edge(of->surface, p[0], p[1]);
    to->item[1] = from->kind == WEFT__VERTICES ? p[1]
                  : from->kind == WEFT__VERTEX_TRIANGLE
                      ? weft__contact_surface_triangle(of->surface, p + 1)
                      : weft__contact_surface_edge(of->surface, p[first], p[first + 1]);
    return true;
}

static bool slit_edges_keep(void *ctx, const weft__pair *pair)
{
    slit_search *of = ctx;
    near_pair found
        = { .distance = weft__pair_distance(pair, of->y, of->flat->points) };
    if (!(found.distance < of->range) || !to_particles(of, pair, &found.pair)) {
        return true;
    }
    of->no_memory
        = !weft__reserve(of->memory, &of->at, &of->room, of->count + 1, sizeof *of->at);
    if (!of->no_memory) {
        of->at[of->count++] = found;
    }
    return !of->no_memory;
}

static bool is_slit_pair(const weft__contact_surface *surface, weft__pair_kind kind,
                         size_t a, size_t b)
{
    uint64_t key[2];
    const weft__pair pair = { .kind = kind, .item = { (uint32_t)a, (uint32_t)b } };
    weft__pair_key(&pair, key);
    return weft__is_slit_pair(surface, key);
}

bool weft__at_slit(const weft__contact_surface *surface, size_t edge, size_t triangle)
{
    const uint32_t *ends = surface->edge[edge], *c = surface->triangle[triangle];
    bool any = false;
    for (size_t k = 0; k < 3 && surface->slit_pair_count > 0; ++k) {
        const uint32_t a = c[k], b = c[(k + 1) % 3];
        any = any
              || is_slit_pair(surface, WEFT__EDGES, edge,
                              weft__contact_surface_edge(surface, a, b))
              || (k < 2
                  && is_slit_pair(surface, WEFT__VERTEX_TRIANGLE, ends[k], triangle));
    }
    return any;
}

static int by_key(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return x[0] != y[0] ? (x[0] > y[0]) - (x[0] < y[0]) : (x[1] > y[1]) - (x[1] < y[1]);
}

/* Whether a point of one side, and one of the other, is at a slit. */
static bool both_at_slit(const weft__contact_surface *surface, const weft__pair *pair)
{
    weft_primitive sides[2];
    bool at[2] = { false, false };
    weft__pair_primitives(pair, sides);
    for (size_t k = 0; k < 2; ++k) {
        for (size_t j = 0; j < sides[k].count; ++j) {
            at[k] = at[k] || surface->at_slit[sides[k].particle[j]];
        }
    }
    return at[0] && at[1];
}

/* Whether an edge joins two particles. */
static bool has_edge(const weft__triangles *of, uint32_t p, uint32_t q)
{
    bool any = false;
    for (size_t j = of->around_first[p]; !any && j < of->around_first[p + 1]; ++j) {
        const uint32_t *c = of->corner[of->around[j]];
        any = c[0] == q || c[1] == q || c[2] == q;
    }
    return any;
}

/* Whether a path of at most two edges does. */
static bool has_path(const weft__triangles *of, uint32_t p, uint32_t q)
{
    bool any = has_edge(of, p, q);
    for (size_t j = of->around_first[p]; !any && j < of->around_first[p + 1]; ++j) {
        for (size_t k = 0; !any && k < 3; ++k) {
            any = has_edge(of, of->corner[of->around[j]][k], q);
        }
    }
    return any;
}

/* Whether one joins a particle of either side of a pair. */
static bool is_joined(const weft__triangles *of, const weft__pair *pair)
{
    const size_t all = weft__pair_particles(pair);
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    bool any = false;
    for (size_t k = 0; !any && k < first * (all - first); ++k) {
        any = has_path(of, pair->particle[k % first],
                       pair->particle[first + k / first]);
    }
    return any;
}

/* The pairs that rest in space, as slit edges if a path joins them; leaves the others.
 */
static void sort_out_space(slit_search *of, weft__contact_surface *surface)
{
    const weft__triangles *mesh = of->of;
    size_t left = 0;
    for (size_t i = 0; mesh->in_space != NULL && i < of->count; ++i) {
        const weft__pair *pair = &of->at[i].pair;
        const uint32_t at = mesh->around[mesh->around_first[pair->particle[0]]];
        if (!weft__in_space(mesh, at)) {
            of->at[left++] = of->at[i];
        } else if (is_joined(mesh, pair)) {
            weft__pair_key(pair, surface->slit_pairs[surface->slit_pair_count++]);
        }
    }
    of->count = mesh->in_space != NULL ? left : of->count;
}

/* What was found, as slit edges or as the notch. */
static void sort_out(slit_search *of, weft__contact_surface *surface)
{
    sort_out_space(of, surface);
    for (size_t i = 0; i < of->count; ++i) {
        const weft__pair *pair = &of->at[i].pair;
        for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
            bool *at = &surface->at_slit[pair->particle[k]];
            *at = *at || of->at[i].distance < 0.5 * TOGETHER * of->range;
        }
    }
    for (size_t i = 0; i < of->count; ++i) {
        const near_pair *at = &of->at[i];
        if (both_at_slit(surface, &at->pair)) {
            weft__pair_key(&at->pair, surface->slit_pairs[surface->slit_pair_count++]);
        } else if (at->distance < surface->notch_width) {
            surface->notch_width = at->distance;
            weft__pair_primitives(&at->pair, surface->notch);
        }
    }
    qsort(surface->slit_pairs, surface->slit_pair_count, sizeof *surface->slit_pairs,
          by_key);
}

/* Places that rest in space, below all planes. */
static void lay_out_space(const weft__triangles *of, double range, double *y)
{
    const size_t n = of->places;
    double high = 0.0;
    for (size_t i = 0; i < n; ++i) {
        high = fmax(high, of->space[3 * of->particle[i] + 2]);
    }
    for (size_t j = 0; j < 3 * of->count; ++j) {
        if (of->in_space[j / 3]) {
            const uint32_t place = of->place[j / 3][j % 3];
            const double *x = &of->space[3 * of->particle[place]];
            y[place] = x[0];
            y[n + place] = x[1];
            y[2 * n + place] = x[2] - high - 2.0 * range;
        }
    }
}

/* Places, each piece in a plane of its own. */
static void lay_out(const weft__triangles *of, double range, double *y)
{
    const size_t n = of->places;
    for (size_t j = 0; j < 3 * of->count; ++j) {
        const size_t t = j / 3;
        const uint32_t place = of->place[t][j % 3];
        y[place] = of->rest[place][0];
        y[n + place] = of->rest[place][1];
        y[2 * n + place] = 2.0 * range * (double)of->piece[t];
    }
    if (of->in_space != NULL) {
        lay_out_space(of, range, y);
    }
}

static bool search(slit_search *by, const weft__self *flat)
{
    const size_t n = flat->points;
    double *y = weft__zeroed(by->memory, 3 * n, sizeof *y);
    weft__quadtree tree = weft__tree_of(flat, y);
    weft__knot *knots = weft__alloc(by->memory, weft__tree_size(&tree), sizeof *knots);
    if (y != NULL && knots != NULL) {
        by->y = y;
        lay_out(by->of, by->range, y);
        weft__tree_fill(&tree, knots);
        (void)weft__each_pair(&tree, by->range, slit_edges_keep, by);
    }
    by->no_memory = by->no_memory || y == NULL || knots == NULL;
    WEFT__FREE_ALL(by->memory, y, knots);
    return !by->no_memory;
}

bool weft__find_slit_edges(weft__contact_surface *surface, const weft__mesh *mesh,
                           double thickness, const weft_allocator *memory)
{
    const weft__triangles *of = mesh->triangles;
    const weft__mesh flat_mesh = { .particles = of->places };
    weft__surface_draft draft;
    weft__self flat = { .mesh = &flat_mesh, .points = of->places };
    slit_search by = { .of = of,
                       .surface = surface,
                       .flat = &flat,
                       .memory = memory,
                       .range = 2.0 * thickness * (1.0 - ROUNDOFF) };
    if (of->count == 0) {
        return true;
    }
    /* the draft is of particles before it is of places, which grids do not have */
    const size_t room = of->places > mesh->particles ? of->places : mesh->particles;
    if (weft__surface_draft_create(&draft, room, of->count, memory)) {
        weft__surface_draft_mesh(&draft, of);
        draft.points = draft.particles = of->places;
        memcpy(draft.corner, of->place, of->count * sizeof *draft.corner);
        draft.thickness = thickness;
        flat.surface = weft__contact_surface_create(&draft, memory);
    }
    weft__surface_draft_destroy(&draft, memory);
    bool made = flat.surface != NULL && search(&by, &flat);
    if (made && by.count > 0) {
        surface->slit_pairs
            = weft__alloc(memory, by.count, sizeof *surface->slit_pairs);
        surface->at_slit
            = weft__zeroed(memory, surface->points, sizeof *surface->at_slit);
        made = surface->slit_pairs != NULL && surface->at_slit != NULL;
        if (made) {
            sort_out(&by, surface);
        }
    }
    weft__contact_surface_destroy(flat.surface, memory);
    weft__free(memory, by.at);
    return made;
}
