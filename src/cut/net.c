/* SPDX-License-Identifier: BSD-3-Clause */
/* net.c -- triangles between points: flips, insertion, marked edges. Lawson's flips
 * lead from any triangulation to the Delaunay one (C. L. Lawson, Discrete Math. 3,
 * 1972); a missing edge is made by flips after S. W. Sloan, Computers & Structures 47,
 * 1993. */
#include "cut/net.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __int128 wide;

enum { BOX = 4, QUARTER = 1 << 28 }; /* the points lie in the middle half of the grid */

static const unsigned next_of[] = { 1, 2, 0 }, last_of[] = { 2, 0, 1 };

double net_random(uint64_t seed, uint64_t number, uint64_t which)
{
    uint64_t z = seed * 0x9E3779B97F4A7C15U + number * 0xD1B54A32D192ED03U + which + 1;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    z = (z ^ (z >> 31)) * 0xBF58476D1CE4E5B9U;
    return (double)((z ^ (z >> 29)) >> 11) * 0x1p-53;
}

/* ---- points -------------------------------------------------------------------- */

static void *grown(cut_net *self, void *array, size_t *room, size_t count, size_t size)
{
    if (count < *room || self->no_memory) {
        return array;
    }
    void *more = realloc(array, (count + count / 2 + 64) * size);
    self->no_memory = more == NULL;
    *room = more == NULL ? *room : count + count / 2 + 64;
    return more == NULL ? array : more;
}

/* A point outside of the box, such as the centre of a circle, is put on its rim. */
static void to_grid(const cut_net *self, uint32_t point, const double at[2],
                    int32_t out[2])
{
    for (unsigned k = 0; k < 2; ++k) {
        const double noise = net_random(self->seed, point, k) - 0.5;
        const double x = (at[k] - self->zero[k]) / self->unit + noise * self->noise;
        out[k] = (int32_t)rint(fmin(4.0 * QUARTER, fmax(0.0, x)));
    }
}

uint32_t net_add(cut_net *self, const double at[2])
{
    const size_t i = self->points;
    size_t room[] = { self->point_room, self->point_room, self->point_room };
    self->at = grown(self, self->at, &room[0], i, sizeof *self->at);
    self->grid = grown(self, self->grid, &room[1], i, sizeof *self->grid);
    self->size = grown(self, self->size, &room[2], i, sizeof *self->size);
    self->of = grown(self, self->of, &self->point_room, i, sizeof *self->of);
    if (self->no_memory) {
        return NET_NONE;
    }
    memcpy(self->at[i], at, sizeof *self->at);
    to_grid(self, (uint32_t)i, at, self->grid[i]);
    self->size[i] = INFINITY;
    self->of[i] = NET_NONE;
    return (uint32_t)self->points++;
}

void net_drop(cut_net *self)
{
    --self->points;
}

void net_begin(cut_net *self, const double low[2], const double high[2], double spacing,
               uint64_t seed)
{
    const double across = fmax(high[0] - low[0], high[1] - low[1]);
    *self = (cut_net){ .unit = across / (2.0 * QUARTER), .seed = seed };
    self->noise = 2e-5 * spacing / self->unit;
    for (unsigned k = 0; k < 2; ++k) {
        self->zero[k] = 0.5 * (low[k] + high[k]) - across;
    }
    for (unsigned i = 0; i < BOX; ++i) {
        const double corner[] = { self->zero[0] + across * (i % 2 == 0 ? 0.25 : 1.75),
                                  self->zero[1] + across * (i < 2 ? 0.25 : 1.75) };
        (void)net_add(self, corner);
    }
}

void net_end(cut_net *self)
{
    free(self->at);
    free(self->grid);
    free(self->size);
    free(self->of);
    free(self->triangle);
    free(self->stack);
    *self = (cut_net){ .points = 0 };
}

/* ---- predicates ---------------------------------------------------------------- */

/* > 0: a, b, c lie counterclockwise. Below 2^61. */
static int64_t turn(const cut_net *self, uint32_t a, uint32_t b, uint32_t c)
{
    const int32_t *p = self->grid[a], *q = self->grid[b], *r = self->grid[c];
    return (int64_t)(q[0] - p[0]) * (r[1] - p[1])
           - (int64_t)(q[1] - p[1]) * (r[0] - p[0]);
}

/* > 0: d lies in the circle through a, b, c, which lie counterclockwise. Below 2^126.
 */
static int in_circle(const cut_net *self, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d)
{
    const uint32_t corner[] = { a, b, c };
    const int32_t *o = self->grid[d];
    int64_t x[3], y[3], z[3];
    for (unsigned k = 0; k < 3; ++k) {
        x[k] = self->grid[corner[k]][0] - o[0];
        y[k] = self->grid[corner[k]][1] - o[1];
        z[k] = x[k] * x[k] + y[k] * y[k];
    }
    const wide sum = (wide)z[0] * (x[1] * y[2] - y[1] * x[2])
                     + (wide)z[1] * (x[2] * y[0] - y[2] * x[0])
                     + (wide)z[2] * (x[0] * y[1] - y[0] * x[1]);
    return (sum > 0) - (sum < 0);
}

/* ---- flips --------------------------------------------------------------------- */

static unsigned side_of(const net_triangle *at, uint32_t beside)
{
    return at->beside[0] == beside ? 0 : at->beside[1] == beside ? 1 : 2;
}

static void relink(cut_net *self, uint32_t t, uint32_t before, uint32_t after)
{
    if (t != NET_NONE) {
        net_triangle *at = &self->triangle[t];
        at->beside[side_of(at, before)] = after;
    }
}

static void push(cut_net *self, uint32_t edge)
{
    self->stack = grown(self, self->stack, &self->stack_room, self->stacked,
                        sizeof *self->stack);
    if (!self->no_memory) {
        self->stack[self->stacked++] = edge;
    }
}

/* Edge k of t, from a to b between p in t and q, becomes that from q to p: t keeps a.
 */
static void flip(cut_net *self, uint32_t t, unsigned k)
{
    net_triangle *one = &self->triangle[t];
    const uint32_t s = one->beside[k];
    net_triangle *two = &self->triangle[s];
    const unsigned j = side_of(two, t);
    const uint32_t p = one->corner[k], q = two->corner[j];
    const uint32_t a = one->corner[next_of[k]], b = one->corner[last_of[k]];
    const net_triangle was = *one, other = *two;
    *one = (net_triangle){ { p, a, q }, { 0 }, { 0 }, was.outside };
    *two = (net_triangle){ { p, q, b }, { 0 }, { 0 }, was.outside };
    /* opposite a of `other` lies b-q, opposite b a-q */
    const unsigned oa = next_of[j], ob = last_of[j]; /* corners b, a of other */
    one->beside[0] = other.beside[oa], one->mark[0] = other.mark[oa];
    one->beside[1] = s;
    one->beside[2] = was.beside[last_of[k]], one->mark[2] = was.mark[last_of[k]];
    two->beside[0] = other.beside[ob], two->mark[0] = other.mark[ob];
    two->beside[1] = was.beside[next_of[k]], two->mark[1] = was.mark[next_of[k]];
    two->beside[2] = t;
    relink(self, one->beside[0], s, t);
    relink(self, two->beside[1], t, s);
    self->of[p] = self->of[a] = self->of[q] = t;
    self->of[b] = s;
}

/* Whether edge k of t is to be flipped; of four points on a circle the lowest has it.
 */
static bool wants_flip(const cut_net *self, uint32_t t, unsigned k)
{
    const net_triangle *one = &self->triangle[t];
    if (one->beside[k] == NET_NONE || one->mark[k] != 0) {
        return false;
    }
    const net_triangle *two = &self->triangle[one->beside[k]];
    const uint32_t p = one->corner[k], a = one->corner[next_of[k]],
                   b = one->corner[last_of[k]], q = two->corner[side_of(two, t)];
    const int inside = in_circle(self, p, a, b, q);
    return inside > 0
           || (inside == 0 && (p < q ? p : q) < (a < b ? a : b)
               && turn(self, p, a, q) > 0 && turn(self, p, q, b) > 0);
}

static void settle(cut_net *self)
{
    while (self->stacked > 0 && !self->no_memory) {
        const uint32_t edge = self->stack[--self->stacked], t = edge / 3;
        if (wants_flip(self, t, edge % 3)) {
            const uint32_t s = self->triangle[t].beside[edge % 3];
            flip(self, t, edge % 3);
            for (unsigned k = 0; k < 3; ++k) {
                push(self, 3 * t + k);
                push(self, 3 * s + k);
            }
        }
    }
}

void net_restore(cut_net *self)
{
    for (size_t t = 0; t < self->triangles; ++t) {
        for (unsigned k = 0; k < 3 && !self->triangle[t].outside; ++k) {
            if (self->triangle[t].beside[k] < t && wants_flip(self, (uint32_t)t, k)) {
                push(self, (uint32_t)(3 * t + k));
                settle(self);
            }
        }
    }
}

bool net_move(cut_net *self, uint32_t point, const double to[2])
{
    int32_t before[2];
    bool good = true;
    memcpy(before, self->grid[point], sizeof before);
    to_grid(self, point, to, self->grid[point]);
    uint32_t t = self->of[point];
    do {
        const net_triangle *at = &self->triangle[t];
        const unsigned k = at->corner[0] == point ? 0 : at->corner[1] == point ? 1 : 2;
        good = turn(self, at->corner[0], at->corner[1], at->corner[2]) > 0;
        t = at->beside[next_of[k]];
    } while (good && t != self->of[point]);
    if (good) {
        memcpy(self->at[point], to, sizeof *self->at);
    } else {
        memcpy(self->grid[point], before, sizeof before);
    }
    return good;
}

/* ---- marked edges -------------------------------------------------------------- */

uint32_t net_edge(const cut_net *self, uint32_t a, uint32_t b)
{
    uint32_t t = self->of[a];
    do {
        const net_triangle *at = &self->triangle[t];
        const unsigned k = at->corner[0] == a ? 0 : at->corner[1] == a ? 1 : 2;
        if (at->corner[next_of[k]] == b) {
            return 3 * t + last_of[k];
        }
        t = at->beside[next_of[k]];
    } while (t != self->of[a] && t != NET_NONE);
    return NET_NONE;
}

/* The edge that the line from a to b leaves the first triangle through. */
static uint32_t first_crossed(const cut_net *self, uint32_t a, uint32_t b)
{
    uint32_t t = self->of[a];
    do {
        const net_triangle *at = &self->triangle[t];
        const unsigned k = at->corner[0] == a ? 0 : at->corner[1] == a ? 1 : 2;
        if (turn(self, a, b, at->corner[next_of[k]]) < 0
            && turn(self, a, b, at->corner[last_of[k]]) > 0) {
            return 3 * t + k;
        }
        t = at->beside[next_of[k]];
    } while (t != self->of[a] && t != NET_NONE);
    return NET_NONE;
}

/* Of the edges that the line from a to b crosses, one to flip: the first whose flip
 * leaves less to cross, or any. NET_NONE: a marked edge or a point is in the way. */
static uint32_t flip_on_way(const cut_net *self, uint32_t a, uint32_t b)
{
    uint32_t edge = first_crossed(self, a, b), any = NET_NONE;
    while (edge != NET_NONE) {
        const uint32_t t = edge / 3, k = edge % 3;
        const net_triangle *one = &self->triangle[t];
        const uint32_t s = one->beside[k], p = one->corner[k];
        const uint32_t r = one->corner[next_of[k]], l = one->corner[last_of[k]];
        if (one->mark[k] != 0 || s == NET_NONE) {
            return NET_NONE;
        }
        const unsigned j = side_of(&self->triangle[s], t);
        const uint32_t q = self->triangle[s].corner[j];
        const int64_t side = turn(self, a, b, q);
        if (turn(self, p, r, q) > 0 && turn(self, p, q, l) > 0) {
            if (p == a || q == b || (turn(self, a, b, p) > 0) == (side > 0)) {
                return edge;
            }
            any = edge;
        }
        if (q == b || side == 0) {
            return q == b ? any : NET_NONE;
        }
        edge = 3 * s + (side > 0 ? next_of[j] : last_of[j]);
    }
    return any;
}

static bool make_edge(cut_net *self, uint32_t a, uint32_t b)
{
    size_t tries = 1000 + self->triangles;
    while (net_edge(self, a, b) == NET_NONE) {
        const uint32_t edge = flip_on_way(self, a, b);
        if (edge == NET_NONE || tries-- == 0) {
            return false;
        }
        flip(self, edge / 3, edge % 3);
    }
    return true;
}

bool net_mark(cut_net *self, uint32_t a, uint32_t b, uint32_t mark)
{
    if (!make_edge(self, a, b)) {
        return false;
    }
    const uint32_t one = net_edge(self, a, b), two = net_edge(self, b, a);
    if (self->triangle[one / 3].mark[one % 3] == 0) {
        self->triangle[one / 3].mark[one % 3] = mark;
        self->triangle[two / 3].mark[two % 3] = mark;
    }
    return true;
}

/* ---- insertion ----------------------------------------------------------------- */

static uint32_t new_triangle(cut_net *self)
{
    self->triangle = grown(self, self->triangle, &self->triangle_room, self->triangles,
                           sizeof *self->triangle);
    return self->no_memory ? NET_NONE : (uint32_t)self->triangles++;
}

/* Where a walk from a triangle to the point ends: in a triangle, *edge NET_NONE, or at
 * a marked edge. NET_NONE: it does not. */
static uint32_t walk(const cut_net *self, uint32_t t, uint32_t point, uint32_t *edge)
{
    *edge = NET_NONE;
    for (size_t steps = 0; steps < self->triangles; ++steps) {
        const net_triangle *at = &self->triangle[t];
        unsigned out = 3;
        for (unsigned k = 0; k < 3; ++k) {
            out = turn(self, at->corner[next_of[k]], at->corner[last_of[k]], point) < 0
                      ? k
                      : out;
        }
        if (out == 3) {
            return t;
        }
        if (at->mark[out] != 0) {
            *edge = 3 * t + out;
            return NET_NONE;
        }
        t = at->beside[out];
    }
    return NET_NONE;
}

/* Whether a point sees a marked edge at more than a right angle. */
static bool encroaches(const cut_net *self, uint32_t t, unsigned k, uint32_t point)
{
    const net_triangle *at = &self->triangle[t];
    const double *x = self->at[point], *a = self->at[at->corner[next_of[k]]],
                 *b = self->at[at->corner[last_of[k]]];
    return at->mark[k] != 0
           && (a[0] - x[0]) * (b[0] - x[0]) + (a[1] - x[1]) * (b[1] - x[1]) < 0.0;
}

/* A marked edge of a triangle or one beside it that a point is too near to. */
static uint32_t hidden_edge(const cut_net *self, uint32_t t, uint32_t point)
{
    for (unsigned k = 0; k < 3; ++k) {
        const uint32_t s = self->triangle[t].beside[k];
        if (encroaches(self, t, k, point)) {
            return 3 * t + k;
        }
        for (unsigned j = 0; j < 3 && self->triangle[t].mark[k] == 0; ++j) {
            if (encroaches(self, s, j, point)) {
                return 3 * s + j;
            }
        }
    }
    return NET_NONE;
}

/* Three triangles of one, around a point within. */
static void divide(cut_net *self, uint32_t t, uint32_t point)
{
    const uint32_t u = new_triangle(self), v = new_triangle(self);
    if (self->no_memory) {
        return;
    }
    const net_triangle was = self->triangle[t];
    const uint32_t made[] = { t, u, v };
    for (unsigned k = 0; k < 3; ++k) {
        const uint32_t a = was.corner[next_of[k]], b = was.corner[last_of[k]];
        self->triangle[made[k]]
            = (net_triangle){ { point, a, b },
                              { was.beside[k], made[next_of[k]], made[last_of[k]] },
                              { was.mark[k], 0, 0 },
                              was.outside };
        relink(self, was.beside[k], t, made[k]);
        self->of[a] = made[k];
        push(self, 3 * made[k]);
    }
    self->of[point] = t;
}

uint32_t net_insert(cut_net *self, uint32_t from)
{
    const uint32_t point = (uint32_t)self->points - 1;
    uint32_t edge;
    const uint32_t t = walk(self, from, point, &edge);
    if (t == NET_NONE) {
        return edge;
    }
    const uint32_t *c = self->triangle[t].corner;
    edge = hidden_edge(self, t, point);
    if (edge == NET_NONE && turn(self, c[0], c[1], point) > 0
        && turn(self, c[1], c[2], point) > 0 && turn(self, c[2], c[0], point) > 0) {
        divide(self, t, point);
        settle(self);
    }
    return edge;
}

bool net_split(cut_net *self, uint32_t edge, uint32_t first, uint32_t mark,
               uint32_t behind)
{
    const uint32_t point = (uint32_t)self->points - 1, t = edge / 3;
    const net_triangle one = self->triangle[t];
    const unsigned k = edge % 3, j = side_of(&self->triangle[one.beside[k]], t);
    const uint32_t s = one.beside[k], p = one.corner[k], a = one.corner[next_of[k]],
                   b = one.corner[last_of[k]];
    const net_triangle two = self->triangle[s];
    const uint32_t q = two.corner[j];
    if (turn(self, p, a, point) <= 0 || turn(self, p, point, b) <= 0
        || turn(self, q, point, a) <= 0 || turn(self, q, b, point) <= 0) {
        return false;
    }
    const uint32_t t2 = new_triangle(self), s2 = new_triangle(self);
    if (self->no_memory) {
        return false;
    }
    const uint32_t near = first == a ? mark : behind, far = first == a ? behind : mark;
    self->triangle[t] = (net_triangle){ { p, a, point },
                                        { s, t2, one.beside[last_of[k]] },
                                        { near, 0, one.mark[last_of[k]] },
                                        one.outside };
    self->triangle[t2] = (net_triangle){ { p, point, b },
                                         { s2, one.beside[next_of[k]], t },
                                         { far, one.mark[next_of[k]], 0 },
                                         one.outside };
    self->triangle[s] = (net_triangle){ { q, point, a },
                                        { t, two.beside[next_of[j]], s2 },
                                        { near, two.mark[next_of[j]], 0 },
                                        two.outside };
    self->triangle[s2] = (net_triangle){ { q, b, point },
                                         { t2, s, two.beside[last_of[j]] },
                                         { far, 0, two.mark[last_of[j]] },
                                         two.outside };
    relink(self, one.beside[next_of[k]], t, t2);
    relink(self, two.beside[last_of[j]], s, s2);
    self->of[a] = self->of[p] = self->of[point] = t;
    self->of[q] = s;
    self->of[b] = t2;
    const uint32_t rim[] = { 3 * t + 2, 3 * t2 + 1, 3 * s + 1, 3 * s2 + 2 };
    for (unsigned i = 0; i < 4; ++i) {
        push(self, rim[i]);
    }
    settle(self);
    return true;
}

/* ---- the first triangulation --------------------------------------------------- */

typedef struct half_edge {
    uint32_t low, high, edge;
} half_edge;

static int by_ends(const void *a, const void *b)
{
    const half_edge *x = a, *y = b;
    return x->low != y->low ? (x->low > y->low) - (x->low < y->low)
                            : (x->high > y->high) - (x->high < y->high);
}

/* Joins triangles along the edges that two of them have; the box alone has others. */
static bool join(cut_net *self)
{
    const size_t count = 3 * self->triangles;
    half_edge *half = malloc((count + 1) * sizeof *half);
    size_t rims = 0;
    self->no_memory = half == NULL;
    for (size_t i = 0; half != NULL && i < count; ++i) {
        const uint32_t *corner = self->triangle[i / 3].corner;
        const uint32_t a = corner[next_of[i % 3]], b = corner[last_of[i % 3]];
        half[i] = (half_edge){ a < b ? a : b, a < b ? b : a, (uint32_t)i };
    }
    if (half != NULL) {
        qsort(half, count, sizeof *half, by_ends);
    }
    for (size_t i = 0; half != NULL && i < count; ++i) {
        const bool pair = i + 1 < count && by_ends(&half[i], &half[i + 1]) == 0;
        const uint32_t one = half[i].edge, two = half[i + pair].edge;
        self->triangle[one / 3].beside[one % 3] = pair ? two / 3 : NET_NONE;
        self->triangle[two / 3].beside[two % 3] = pair ? one / 3 : NET_NONE;
        rims += !pair;
        i += pair;
    }
    free(half);
    return rims == 4;
}

const char *net_start(cut_net *self)
{
    size_t count;
    const int32_t(*grid)[2] = (const int32_t(*)[2])self->grid;
    uint32_t *corner = self->no_memory ? NULL : net_qhull(self->points, grid, &count);
    if (corner == NULL) {
        return "Qhull has no triangulation of its points";
    }
    bool good = true;
    for (size_t i = 0; i < count && good; ++i) {
        const uint32_t *c = &corner[3 * i], t = new_triangle(self);
        if (t == NET_NONE) {
            break;
        }
        const bool left = turn(self, c[0], c[1], c[2]) > 0;
        self->triangle[t]
            = (net_triangle){ .corner = { c[0], c[left ? 1 : 2], c[left ? 2 : 1] } };
        good = turn(self, c[0], c[1], c[2]) != 0;
        self->of[c[0]] = self->of[c[1]] = self->of[c[2]] = t;
    }
    free(corner);
    for (size_t i = 0; i < self->points; ++i) {
        good = good && self->of[i] != NET_NONE;
    }
    good = good && count == 2 * self->points - 6 && join(self);
    if (!good || self->no_memory) {
        return "Qhull's triangulation of its points has gaps";
    }
    net_restore(self);
    return NULL;
}
