/* SPDX-License-Identifier: BSD-3-Clause */
/* orient.c -- whether triangles of a surface can be turned so that all run alike: a
 * Moebius band has one side alone, so that turning some of them does not help. */
#include "mesh/triangles_work.h"

#include "base/memory.h"

/* Sets of triangles as trees; odd: of a triangle that must be turned against its
 * parent, one_sided: of a root in whose set no turning helps. */
typedef struct sets {
    uint32_t *parent;
    bool *odd, *one_sided;
} sets;

/* The root of a triangle, and whether it is turned against it; halves the path. */
static uint32_t root_of(const sets *of, uint32_t t, bool *odd)
{
    *odd = false;
    while (of->parent[t] != t) {
        const uint32_t up = of->parent[t];
        of->odd[t] = of->odd[t] != of->odd[up];
        *odd = *odd != of->odd[t];
        t = of->parent[t] = of->parent[up];
    }
    return t;
}

/* Joins two triangles, of which one must be turned against the other or not. */
static void orient_join(const sets *of, uint32_t a, uint32_t b, bool turned)
{
    bool odd[2];
    const uint32_t x = root_of(of, a, &odd[0]), y = root_of(of, b, &odd[1]);
    const bool differ = odd[0] != odd[1];
    if (x == y) {
        of->one_sided[x] = of->one_sided[x] || differ != turned;
        return;
    }
    of->parent[y] = x;
    of->odd[y] = differ != turned;
    of->one_sided[x] = of->one_sided[x] || of->one_sided[y];
}

/* Joins the triangles of each edge that has two. */
static void join_all(const weft__work *at, const sets *of)
{
    for (size_t i = 0; i < at->def->vertices; ++i) {
        for (size_t h = at->first[i]; h + 1 < at->first[i + 1]; ++h) {
            const weft__half_edge *a = &at->halves[h], *b = a + 1;
            const bool third = (h > at->first[i] && a[-1].high == a->high)
                               || (h + 2 < at->first[i + 1] && b[1].high == b->high);
            if (a->high == b->high && !third) {
                orient_join(of, a->triangle, b->triangle, a->down == b->down);
            }
        }
    }
}

bool weft__is_one_sided(weft__work *at, uint32_t triangle)
{
    const size_t count = at->def->triangles;
    if (at->one_sided == NULL) {
        const sets of = { weft__work_take(at, count, sizeof *of.parent),
                          weft__work_take(at, count, sizeof *of.odd),
                          weft__work_take(at, count, sizeof *of.one_sided) };
        for (size_t t = 0; !at->no_memory && t < count; ++t) {
            of.parent[t] = (uint32_t)t;
        }
        if (!at->no_memory) {
            join_all(at, &of);
        }
        for (size_t t = 0; !at->no_memory && t < count; ++t) {
            bool odd;
            of.one_sided[t] = of.one_sided[root_of(&of, (uint32_t)t, &odd)];
        }
        at->one_sided = of.one_sided;
        WEFT__FREE_ALL(at->memory, of.parent, of.odd);
    }
    return at->one_sided != NULL && at->one_sided[triangle];
}
