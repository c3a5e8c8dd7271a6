/* SPDX-License-Identifier: BSD-3-Clause */
/* aggregate.c -- pairwise matching, twice: a vertex joins the free neighbour that most
 * springs join it to; the nearest by number among equals. On a grid whose particles are
 * numbered along its rows these are pairs along a row, then 2 x 2 particles. */
#include "aggregate.h"

#define NONE UINT32_MAX

void weft__graph_take(weft__graph *self, weft__pile *pile)
{
    self->a = weft__pile_take(pile, self->m, sizeof *self->a);
    self->b = weft__pile_take(pile, self->m, sizeof *self->b);
    self->weight = weft__pile_take(pile, self->m, sizeof *self->weight);
}

/* start[k] for k <= n becomes the first place of key k, of counts in start[k + 1]. */
static void add_up(uint32_t *start, uint32_t n)
{
    for (uint32_t k = 0; k < n; ++k) {
        start[k + 1] += start[k];
    }
}

/* The edges of each vertex: those of vertex i are edge[start[i]] to edge[start[i + 1]].
 */
typedef struct ends {
    uint32_t *start, *edge;
} ends;

static ends ends_of(const weft__graph *g, weft__pile *scratch)
{
    ends out = { weft__pile_take(scratch, (size_t)g->n + 2, sizeof *out.start),
                 weft__pile_take(scratch, 2 * (size_t)g->m, sizeof *out.edge) };
    if (scratch->failed) {
        return out;
    }
    memset(out.start, 0, ((size_t)g->n + 2) * sizeof *out.start);
    uint32_t *next = out.start + 1; /* becomes start once all are filled in */
    for (uint32_t e = 0; e < g->m; ++e) {
        ++next[g->a[e] + 1];
        ++next[g->b[e] + 1];
    }
    add_up(next, g->n);
    for (uint32_t e = 0; e < g->m; ++e) {
        out.edge[next[g->a[e]]++] = e;
        out.edge[next[g->b[e]]++] = e;
    }
    return out;
}

static uint32_t distance(uint32_t i, uint32_t j)
{
    return i < j ? j - i : i - j;
}

/* The free neighbour to join, or NONE. */
static uint32_t partner(const weft__graph *g, const ends *of, const uint32_t *to,
                        uint32_t i)
{
    uint32_t best = NONE, most = 0;
    for (uint32_t k = of->start[i]; k < of->start[i + 1]; ++k) {
        const uint32_t e = of->edge[k], j = g->a[e] == i ? g->b[e] : g->a[e];
        const bool nearer = best == NONE || distance(i, j) < distance(i, best);
        if (to[j] == NONE && j != i
            && (g->weight[e] > most || (g->weight[e] == most && nearer))) {
            best = j;
            most = g->weight[e];
        }
    }
    return best;
}

/* Writes the pair of each vertex to to[n]; returns the number of pairs. */
static uint32_t match(const weft__graph *g, uint32_t *to, weft__pile *scratch)
{
    const ends of = ends_of(g, scratch);
    uint32_t count = 0;
    if (scratch->failed) {
        return 0;
    }
    memset(to, 0xFF, (size_t)g->n * sizeof *to);
    for (uint32_t i = 0; i < g->n; ++i) {
        if (to[i] == NONE) {
            to[i] = count;
            const uint32_t j = partner(g, &of, to, i);
            if (j != NONE) {
                to[j] = count;
            }
            ++count;
        }
    }
    return count;
}

/* Writes the order of the edges by key(e) < keys, equal ones as they are, to order[m].
 */
static void sort(const weft__graph *g, bool by_distance, uint32_t *start,
                 uint32_t *order)
{
    memset(start, 0, ((size_t)g->n + 1) * sizeof *start);
    for (int pass = 0; pass < 2; ++pass) {
        for (uint32_t e = 0; e < g->m; ++e) {
            const uint32_t key = by_distance ? g->b[e] - g->a[e] : g->a[e];
            if (pass == 0) {
                ++start[key + 1];
            } else {
                order[start[key]++] = e;
            }
        }
        if (pass == 0) {
            add_up(start, g->n);
        }
    }
}

/* Edges between the same two vertices become one; all follow in order of a. Writes the
 * new edge of each to target[m]. */
static void merge(const weft__graph *all, weft__graph *out, const uint32_t *order,
                  uint32_t *seen, uint32_t *target)
{
    out->m = 0;
    memset(seen, 0xFF, (size_t)all->n * sizeof *seen);
    for (uint32_t k = 0; k < all->m; ++k) {
        const uint32_t e = order[k], a = all->a[e], b = all->b[e];
        if (a == b) {
            target[e] = WEFT__WITHIN;
            continue;
        }
        if (seen[b] == NONE || out->a[seen[b]] != a) {
            seen[b] = out->m;
            out->a[out->m] = a;
            out->b[out->m] = b;
            out->weight[out->m++] = 0;
        }
        out->weight[seen[b]] += all->weight[e];
        target[e] = seen[b];
    }
}

/* The graph of n pairs or aggregates. */
static bool contract(const weft__graph *fine, const uint32_t *to, uint32_t n,
                     uint32_t *target, weft__graph *coarse, weft__pile *scratch)
{
    weft__graph all = { .n = n, .m = fine->m }, merged = all;
    *coarse = all;
    weft__graph_take(&all, scratch);
    weft__graph_take(&merged, scratch);
    weft__graph_take(coarse, scratch);
    uint32_t *start = weft__pile_take(scratch, (size_t)fine->n + 2, sizeof *start);
    uint32_t *order = weft__pile_take(scratch, fine->m, sizeof *order);
    if (scratch->failed) {
        return false;
    }
    for (uint32_t e = 0; e < fine->m; ++e) {
        const uint32_t a = to[fine->a[e]], b = to[fine->b[e]];
        all.a[e] = a < b ? a : b;
        all.b[e] = a < b ? b : a;
        all.weight[e] = fine->weight[e];
    }
    sort(&all, false, start, order);
    merge(&all, &merged, order, start, target);
    sort(&merged, true, start, order);
    coarse->m = merged.m;
    for (uint32_t k = 0; k < merged.m; ++k) {
        coarse->a[k] = merged.a[order[k]];
        coarse->b[k] = merged.b[order[k]];
        coarse->weight[k] = merged.weight[order[k]];
        merged.weight[order[k]] = k; /* its new place */
    }
    for (uint32_t e = 0; e < fine->m; ++e) {
        target[e] = target[e] == WEFT__WITHIN ? target[e] : merged.weight[target[e]];
    }
    return true;
}

bool weft__aggregate(const weft__graph *fine, uint32_t *to, uint32_t *target,
                     weft__graph *coarse, weft__pile *scratch)
{
    uint32_t *second = weft__pile_take(scratch, fine->n, sizeof *second);
    weft__graph pairs;
    if (scratch->failed
        || !contract(fine, to, match(fine, to, scratch), target, &pairs, scratch)) {
        return false;
    }
    const uint32_t n = match(&pairs, second, scratch);
    if (scratch->failed) {
        return false;
    }
    for (uint32_t i = 0; i < fine->n; ++i) {
        to[i] = second[to[i]];
    }
    return contract(fine, to, n, target, coarse, scratch);
}
