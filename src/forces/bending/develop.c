/* SPDX-License-Identifier: BSD-3-Clause */
/* develop.c -- the unfolding of develop.h, level by level, so that it depends neither
 * on the numbers of triangles nor on the way round of their corners: what is reached
 * more than once at a level takes the mean. */
#include "forces/bending/develop.h"

#include "base/memory.h"
#include "base/plane.h"

/* ---- life ------------------------------------------------------------------------ */

static void measure_edges(weft__develop *of)
{
    const weft__triangles *mesh = of->mesh;
    for (size_t j = 0; j < 3 * mesh->count; ++j) {
        const size_t t = j / 3, k = j % 3;
        of->length[mesh->edge[t][k]] = sqrt(weft__squared(
            weft__rest_at(mesh, t, (k + 1) % 3), weft__rest_at(mesh, t, (k + 2) % 3)));
    }
}

bool weft__develop_create(weft__develop *of, const weft__triangles *mesh,
                          const bool *held, const weft_allocator *memory)
{
    *of = (weft__develop){ .mesh = mesh, .memory = memory, .held = held };
    of->length = weft__alloc(memory, mesh->edges, sizeof *of->length);
    of->list = weft__alloc(memory, mesh->count, sizeof *of->list);
    of->corner = weft__alloc(memory, mesh->count, sizeof *of->corner);
    of->turn = weft__zeroed(memory, mesh->count, sizeof *of->turn);
    of->reached = weft__zeroed(memory, mesh->count, sizeof *of->reached);
    of->times = weft__zeroed(memory, mesh->count, sizeof *of->times);
    of->sum = weft__alloc(memory, mesh->places, sizeof *of->sum);
    of->place_turn = weft__zeroed(memory, mesh->places, sizeof *of->place_turn);
    of->place_level = weft__zeroed(memory, mesh->places, sizeof *of->place_level);
    of->place_times = weft__zeroed(memory, mesh->places, sizeof *of->place_times);
    const bool made = of->length != NULL && of->list != NULL && of->corner != NULL
                      && of->turn != NULL && of->reached != NULL && of->times != NULL
                      && of->sum != NULL && of->place_turn != NULL
                      && of->place_level != NULL && of->place_times != NULL;
    if (made) {
        measure_edges(of);
    }
    return made;
}

void weft__develop_free(weft__develop *of)
{
    if (of->memory != NULL) {
        WEFT__FREE_ALL(of->memory, of->length, of->list, of->corner, of->turn,
                       of->reached, of->times, of->sum, of->place_turn, of->place_level,
                       of->place_times);
    }
}

/* ---- one triangle ---------------------------------------------------------------- */

/* The corner v beyond the side from a to b, away from `other`; the lengths of the side,
 * of a-v and of b-v are those at rest, also where a and b are means. */
static void third_corner(const double a[2], const double b[2], const double other[2],
                         const double length[3], double v[2])
{
    const double d[2] = { b[0] - a[0], b[1] - a[1] };
    const double apart = sqrt(d[0] * d[0] + d[1] * d[1]);
    const double u[2] = { d[0] / apart, d[1] / apart };
    const double middle[2] = { (a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0 };
    const double along
        = (length[1] * length[1] - length[2] * length[2]) / (2.0 * length[0]);
    const double foot = along + length[0] / 2.0;
    const double height = sqrt(fmax(0.0, length[1] * length[1] - foot * foot));
    const double side
        = (other[1] - middle[1]) * u[0] - (other[0] - middle[0]) * u[1] > 0.0 ? -1.0
                                                                              : 1.0;
    v[0] = middle[0] + along * u[0] - side * height * u[1];
    v[1] = middle[1] + along * u[1] + side * height * u[0];
}

static void put_place(weft__develop *of, uint32_t place, const double y[2])
{
    if (of->place_turn[place] != of->edge + 1) {
        of->place_turn[place] = of->edge + 1;
        of->place_level[place] = of->level;
        of->place_times[place] = 1;
        memcpy(of->sum[place], y, sizeof of->sum[place]);
    } else if (of->place_level[place] == of->level) {
        ++of->place_times[place];
        of->sum[place][0] += y[0];
        of->sum[place][1] += y[1];
    }
}

static size_t corner_opposite(const weft__triangles *mesh, uint32_t triangle,
                              uint32_t edge)
{
    const uint32_t *edges = mesh->edge[triangle];
    return edges[0] == edge ? 0 : edges[1] == edge ? 1 : 2;
}

static bool develop_placed(const weft__develop *of, uint32_t triangle)
{
    return of->turn[triangle] == of->edge + 1;
}

/* Triangle `to` lies beyond the edge opposite corner k of `from`, which is placed. */
static void unfold(weft__develop *of, uint32_t from, size_t k, uint32_t to)
{
    const weft__triangles *mesh = of->mesh;
    const uint32_t edge = mesh->edge[from][k];
    const size_t a = (k + 1) % 3, b = (k + 2) % 3, v = corner_opposite(mesh, to, edge);
    const size_t next = (v + 1) % 3, last = (v + 2) % 3;
    const size_t first = mesh->place[to][next] == mesh->place[from][a] ? next : last;
    const size_t second = first == next ? last : next;
    const double length[3] = { of->length[edge], of->length[mesh->edge[to][second]],
                               of->length[mesh->edge[to][first]] };
    double z[3][2];
    memcpy(z[first], of->corner[from][a], sizeof z[first]);
    memcpy(z[second], of->corner[from][b], sizeof z[second]);
    third_corner(z[first], z[second], of->corner[from][k], length, z[v]);
    put_place(of, mesh->place[to][v], z[v]);
    if (!develop_placed(of, to)) {
        of->turn[to] = of->edge + 1;
        of->reached[to] = of->level;
        of->times[to] = 0;
        memset(of->corner[to], 0, sizeof of->corner[to]);
        of->list[of->count++] = to;
    }
    ++of->times[to];
    for (size_t j = 0; j < 6; ++j) {
        of->corner[to][j / 2][j % 2] += z[j / 2][j % 2];
    }
}

/* ---- levels ---------------------------------------------------------------------- */

/* Whether edge f has an end of the edge in the middle, and is another one. */
static bool turns(const weft__develop *of, uint32_t f)
{
    const uint32_t *middle = of->mesh->edge_list[of->edge].place;
    const uint32_t *ends = of->mesh->edge_list[f].place;
    return f != of->edge
           && (ends[0] == middle[0] || ends[0] == middle[1] || ends[1] == middle[0]
               || ends[1] == middle[1]);
}

/* The next level; false: it is empty. */
static bool develop_level(weft__develop *of)
{
    const weft__triangles *mesh = of->mesh;
    const size_t begin = of->begin, end = of->count;
    ++of->level;
    for (size_t j = 3 * begin; j < 3 * end; ++j) {
        const uint32_t from = of->list[j / 3], edge = mesh->edge[from][j % 3];
        const uint32_t *both = mesh->edge_list[edge].triangle;
        const uint32_t to = both[0] == from ? both[1] : both[0];
        if (to != WEFT__NONE && !of->held[to] && (of->spread || turns(of, edge))
            && (!develop_placed(of, to) || of->reached[to] == of->level)) {
            unfold(of, from, j % 3, to);
        }
    }
    for (size_t j = end; j < of->count; ++j) {
        const uint32_t t = of->list[j];
        for (size_t k = 0; of->times[t] > 1 && k < 6; ++k) {
            of->corner[t][k / 2][k % 2] /= (double)of->times[t];
        }
    }
    of->begin = end;
    return of->count > end;
}

/* Triangle `side` of the edge in the middle: above it, or below. */
static void place_first(weft__develop *of, size_t side)
{
    const weft__triangles *mesh = of->mesh;
    const weft__edge *edge = &mesh->edge_list[of->edge];
    const uint32_t t = edge->triangle[side];
    const double half = of->length[of->edge] / 2.0;
    const double away[2] = { 0.0, side == 0 ? -1.0 : 1.0 };
    if (t == WEFT__NONE) {
        return;
    }
    const size_t v = corner_opposite(mesh, t, of->edge), next = (v + 1) % 3;
    const size_t last = (v + 2) % 3;
    const size_t p = mesh->place[t][next] == edge->place[0] ? next : last;
    const size_t q = p == next ? last : next;
    double(*corner)[2] = of->corner[t];
    const double length[3] = { of->length[of->edge], of->length[mesh->edge[t][q]],
                               of->length[mesh->edge[t][p]] };
    corner[p][0] = -half, corner[q][0] = half;
    corner[p][1] = corner[q][1] = 0.0;
    third_corner(corner[p], corner[q], away, length, corner[v]);
    of->turn[t] = of->edge + 1;
    of->reached[t] = 0;
    of->list[of->count++] = t;
    put_place(of, mesh->place[t][v], corner[v]);
}

void weft__develop_begin(weft__develop *of, size_t e)
{
    const uint32_t *ends = of->mesh->edge_list[e].place;
    of->edge = (uint32_t)e;
    of->level = 0;
    of->begin = of->count = 0;
    of->spread = false;
    const double half = of->length[e] / 2.0;
    put_place(of, ends[0], (const double[2]){ -half, 0.0 });
    put_place(of, ends[1], (const double[2]){ half, 0.0 });
    place_first(of, 0);
    place_first(of, 1);
    while (develop_level(of)) {
    }
}

bool weft__develop_more(weft__develop *of)
{
    of->begin = of->spread ? of->begin : 0;
    of->spread = true;
    return develop_level(of);
}

bool weft__developed(const weft__develop *of, uint32_t place, double y[2])
{
    const bool reached = of->place_turn[place] == of->edge + 1;
    for (size_t k = 0; reached && k < 2; ++k) {
        y[k] = of->sum[place][k] / (double)of->place_times[place];
    }
    return reached;
}
