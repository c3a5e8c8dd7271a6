/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_edge_slope.c -- weighted fits of quadratics about the middle of each edge. Only
 * + - * / and square roots: the same bits everywhere. */
#include "forces/bending/plate.h"

#include <stdlib.h>

#include "base/grow.h"
#include "base/plane.h"
#include "forces/bending/develop.h"

enum {
    TERMS = 6,                /* 1, a, b, a^2/2, b^2/2, a b */
    ENOUGH = 10,              /* points of a patch, if the piece has them */
    MOST = WEFT__CURVE_PARTS, /* points that a patch is widened to */
    WIDENINGS = 12,
    FEW = 12 /* points of the rings 2 and 3 */
};
#define SINGULAR 1e-10 /* eigenvalue of the fit's matrix, by the largest */
#define INEXACT  1e-6  /* of |d|, what a fit may miss */
#define NARROW   1e-6  /* determinant of the metric, by the square of its trace */
#define SAME     1e-9  /* of a distance, within which points are added together */
#define BAD      2.0   /* gain above which the slopes of both faces may be better */

/* The work of one edge after the other. Arrays have room for every place. */
typedef struct search {
    const weft__triangles *mesh;
    const bool *held;
    const weft_allocator *memory;
    weft__edge_slopes *out;
    uint32_t *lists; /* all of those below */
    size_t *first;   /* of each place, its neighbours along edges of live triangles */
    uint32_t *near;
    uint32_t *seen;          /* 1 + edge that took a place */
    uint32_t *points, *pool; /* the patch; what it may be widened by */
    double *far;             /* |yh|^2 of the pool */
    size_t count, waiting;
    bool gathered;      /* the pool */
    double *work;       /* root of the weight, and six columns of the fit */
    double *fit, *best; /* c */
    size_t fitted;      /* points of the best, 0: none */
    double gain;        /* |c| / |S^(-1/2) n| of the best */
    double middle[2], normal[2];
    double root[3];         /* S^(-1/2): uu, uv, vv */
    weft__develop unfolded; /* of edges that rest in space */
    bool in_space;          /* the edge is one of these */
} search;

static bool live(const search *s, uint32_t triangle)
{
    return triangle != WEFT__NONE && !s->held[triangle];
}

static bool edge_live(const search *s, const weft__edge *edge)
{
    return live(s, edge->triangle[0]) || live(s, edge->triangle[1]);
}

bool *weft__held_triangles(const weft__triangles *of, const uint32_t *pin,
                           const weft_allocator *memory)
{
    bool *held = weft__alloc(memory, of->count, sizeof *held);
    for (size_t t = 0; held != NULL && t < of->count; ++t) {
        const uint32_t *corner = of->corner[t];
        held[t] = pin[corner[0]] != 0 && pin[corner[1]] != 0 && pin[corner[2]] != 0;
    }
    return held;
}

/* ---- neighbours ------------------------------------------------------------------ */

static bool edge_slope_reserve(search *s)
{
    const size_t places = s->mesh->places;
    uint32_t *lists = s->lists
        = weft__zeroed(s->memory, 3 * places + 2 * s->mesh->edges, sizeof *lists);
    double *work = s->work
        = weft__alloc(s->memory, places, (4 + TERMS) * sizeof *s->work);
    s->first = weft__zeroed(s->memory, places + 2, sizeof *s->first);
    if (lists == NULL || work == NULL || s->first == NULL) {
        return false;
    }
    s->seen = lists;
    s->points = lists + places;
    s->pool = lists + 2 * places;
    s->near = lists + 3 * places;
    s->fit = work + (1 + TERMS) * places;
    s->best = s->fit + places;
    s->far = s->best + places;
    return true;
}

/* first[p + 1] moves from the start of the neighbours of p to their end. */
static void edge_slope_join(search *s)
{
    const weft__triangles *mesh = s->mesh;
    for (size_t e = 0; e < mesh->edges; ++e) {
        for (size_t k = 0; k < 2 && edge_live(s, &mesh->edge_list[e]); ++k) {
            ++s->first[mesh->edge_list[e].place[k] + 2];
        }
    }
    for (size_t p = 2; p < mesh->places + 2; ++p) {
        s->first[p] += s->first[p - 1];
    }
    for (size_t e = 0; e < mesh->edges; ++e) {
        const uint32_t *ends = mesh->edge_list[e].place;
        for (size_t k = 0; k < 2 && edge_live(s, &mesh->edge_list[e]); ++k) {
            s->near[s->first[ends[k] + 1]++] = ends[1 - k];
        }
    }
}

/* ---- the patch ------------------------------------------------------------------- */

static void edge_slope_take(search *s, uint32_t place, size_t e, uint32_t *to,
                            size_t *count)
{
    if (s->seen[place] != e + 1) {
        s->seen[place] = (uint32_t)(e + 1);
        to[(*count)++] = place;
    }
}

static void offset(const search *s, uint32_t place, double y[2])
{
    if (s->in_space) {
        (void)weft__developed(&s->unfolded, place, y);
        return;
    }
    y[0] = s->mesh->rest[place][0] - s->middle[0];
    y[1] = s->mesh->rest[place][1] - s->middle[1];
}

/* S^(-1/2), by S^(1/2) = (S + sqrt(det) I) / sqrt(tr + 2 sqrt(det)). */
static void edge_slope_measure(search *s)
{
    double sum[3] = { 0.0, 0.0, 0.0 }, y[2];
    for (size_t k = 0; k < s->count; ++k) {
        offset(s, s->points[k], y);
        sum[0] += y[0] * y[0];
        sum[1] += y[0] * y[1];
        sum[2] += y[1] * y[1];
    }
    const double count = (double)s->count;
    double uu = sum[0] / count, uv = sum[1] / count, vv = sum[2] / count;
    if (uu * vv - uv * uv < NARROW * (uu + vv) * (uu + vv)) {
        uu = vv = (uu + vv) / 2.0;
        uv = 0.0;
    }
    const double det = sqrt(uu * vv - uv * uv), scale = det * sqrt(uu + vv + 2.0 * det);
    s->root[0] = (vv + det) / scale;
    s->root[1] = -uv / scale;
    s->root[2] = (uu + det) / scale;
}

/* S^(-1/2) y */
static void whiten(const search *s, const double y[2], double out[2])
{
    out[0] = s->root[0] * y[0] + s->root[1] * y[1];
    out[1] = s->root[1] * y[0] + s->root[2] * y[1];
}

/* Drops points that the unfolding has not reached; returns how many are left. */
static size_t keep_developed(const search *s, uint32_t *points, size_t count)
{
    size_t kept = 0;
    double y[2];
    for (size_t k = 0; k < count; ++k) {
        if (weft__developed(&s->unfolded, points[k], y)) {
            points[kept++] = points[k];
        }
    }
    return kept;
}

/* Unfolds until all of the pool have places, or nothing is left to unfold. */
static void reach_pool(search *s)
{
    bool all = false, more = true;
    while (!all && more) {
        double y[2];
        all = true;
        for (size_t k = 0; all && k < s->waiting; ++k) {
            all = weft__developed(&s->unfolded, s->pool[k], y);
        }
        more = all || weft__develop_more(&s->unfolded);
    }
    s->waiting = keep_developed(s, s->pool, s->waiting);
}

static void patch(search *s, size_t e)
{
    const weft__edge *edge = &s->mesh->edge_list[e];
    s->count = s->waiting = 0;
    s->gathered = false;
    for (size_t k = 0; k < 2; ++k) {
        const uint32_t p = edge->place[k];
        edge_slope_take(s, p, e, s->points, &s->count);
        for (size_t j = s->first[p]; j < s->first[p + 1]; ++j) {
            edge_slope_take(s, s->near[j], e, s->points, &s->count);
        }
    }
    qsort(s->points, s->count, sizeof *s->points, weft__ascending);
    s->in_space = weft__in_space(s->mesh, edge->triangle[0]);
    if (s->in_space) {
        weft__develop_begin(&s->unfolded, e);
        s->count = keep_developed(s, s->points, s->count);
        s->normal[0] = 0.0, s->normal[1] = -1.0;
        edge_slope_measure(s);
        return;
    }
    const double *a = s->mesh->rest[edge->place[0]], *b = s->mesh->rest[edge->place[1]];
    const double t[2] = { b[0] - a[0], b[1] - a[1] };
    const double length = sqrt(t[0] * t[0] + t[1] * t[1]);
    s->middle[0] = (a[0] + b[0]) / 2.0;
    s->middle[1] = (a[1] + b[1]) / 2.0;
    s->normal[0] = t[1] / length;
    s->normal[1] = -t[0] / length;
    edge_slope_measure(s);
}

/* The rings 2 and 3, and 4 and 5 if these are few. */
static void edge_slope_gather(search *s, size_t e)
{
    size_t begin = 0;
    s->gathered = true;
    for (size_t ring = 2; ring <= 5 && (ring <= 3 || s->waiting < FEW); ++ring) {
        const uint32_t *from = ring == 2 ? s->points : s->pool + begin;
        const size_t end = s->waiting, count = ring == 2 ? s->count : end - begin;
        for (size_t k = 0; k < count; ++k) {
            for (size_t j = s->first[from[k]]; j < s->first[from[k] + 1]; ++j) {
                edge_slope_take(s, s->near[j], e, s->pool, &s->waiting);
            }
        }
        begin = end;
    }
    if (s->in_space) {
        reach_pool(s);
    }
    for (size_t k = 0; k < s->waiting; ++k) {
        double y[2], hat[2];
        offset(s, s->pool[k], y);
        whiten(s, y, hat);
        s->far[k] = hat[0] * hat[0] + hat[1] * hat[1];
    }
}

/* Adds the nearest of the pool, and those as near; false: it is empty. */
static bool edge_slope_widen(search *s, size_t e)
{
    const size_t before = s->count;
    if (!s->gathered) {
        edge_slope_gather(s, e);
    }
    double least = INFINITY;
    for (size_t k = 0; k < s->waiting; ++k) {
        least = fmin(least, s->far[k]);
    }
    for (size_t k = 0; k < s->waiting;) {
        if (s->far[k] <= least * (1.0 + 2.0 * SAME)) {
            s->points[s->count++] = s->pool[k];
            s->pool[k] = s->pool[--s->waiting];
            s->far[k] = s->far[s->waiting];
        } else {
            ++k;
        }
    }
    qsort(s->points + before, s->count - before, sizeof *s->points, weft__ascending);
    return s->count > before;
}

/* ---- the fit --------------------------------------------------------------------- */

static double edge_slope_product(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t k = 0; k < count; ++k) {
        sum += a[k] * b[k];
    }
    return sum;
}

/* W^(1/2), then the columns of W^(1/2) P. */
static void edge_slope_fill(search *s)
{
    const size_t n = s->count;
    for (size_t k = 0; k < n; ++k) {
        double y[2], hat[2];
        offset(s, s->points[k], y);
        whiten(s, y, hat);
        const double a = hat[0], b = hat[1];
        const double weight = sqrt(1.0 / (0.3 + 0.675 * (a * a + b * b)));
        double *to = s->work + k;
        to[0] = weight;
        to[n] = weight;
        to[2 * n] = weight * a;
        to[3 * n] = weight * b;
        to[4 * n] = weight * (a * a / 2.0);
        to[5 * n] = weight * (b * b / 2.0);
        to[6 * n] = weight * (a * b);
    }
}

/* W^(1/2) P = Q R by Gram and Schmidt, the longest column first. */
typedef struct factors {
    size_t rank, order[TERMS]; /* then those that are in the span of the first */
    double r[TERMS][TERMS];    /* R of a step and a column of P */
} factors;

static void factor(search *s, factors *to)
{
    const size_t n = s->count;
    double *q = s->work + n, top = 0.0;
    to->rank = 0;
    for (size_t j = 0; j < TERMS; ++j) {
        to->order[j] = j;
    }
    for (size_t i = 0; i < TERMS; ++i) {
        size_t at = i;
        double longest = -1.0;
        for (size_t j = i; j < TERMS; ++j) {
            const double *column = q + to->order[j] * n;
            const double square = edge_slope_product(column, column, n);
            at = square > longest ? j : at;
            longest = fmax(longest, square);
        }
        top = i == 0 ? longest : top;
        if (longest < SINGULAR * top) {
            return;
        }
        const size_t pivot = to->order[at];
        to->order[at] = to->order[i];
        to->order[i] = pivot;
        const double length = to->r[i][pivot] = sqrt(longest);
        double *unit = q + pivot * n;
        for (size_t k = 0; k < n; ++k) {
            unit[k] /= length;
        }
        for (size_t j = i + 1; j < TERMS; ++j) {
            double *column = q + to->order[j] * n;
            const double share = to->r[i][to->order[j]]
                = edge_slope_product(unit, column, n);
            for (size_t k = 0; k < n; ++k) {
                column[k] -= share * unit[k];
            }
        }
        ++to->rank;
    }
}

/* c = W^(1/2) Q y with R^T y = d, which is W P (P^T W P)^+ d if there is such a y;
 * returns |c| / |d|, or infinity without. */
static double fit(search *s, const double d[TERMS])
{
    const size_t n = s->count;
    const double size = sqrt(edge_slope_product(d, d, TERMS));
    double y[TERMS] = { 0.0 };
    factors f;
    edge_slope_fill(s);
    factor(s, &f);
    double missed = 0.0;
    for (size_t i = 0; i < TERMS; ++i) {
        double left = d[f.order[i]];
        for (size_t l = 0; l < i && l < f.rank; ++l) {
            left -= f.r[l][f.order[i]] * y[l];
        }
        if (i < f.rank) {
            y[i] = left / f.r[i][f.order[i]];
        } else {
            missed += left * left;
        }
    }
    if (!(sqrt(missed) < INEXACT * size)) {
        return INFINITY;
    }
    for (size_t k = 0; k < n; ++k) {
        double sum = 0.0;
        for (size_t i = 0; i < f.rank; ++i) {
            sum += y[i] * s->work[(1 + f.order[i]) * n + k];
        }
        s->fit[k] = s->work[k] * sum;
    }
    return sqrt(edge_slope_product(s->fit, s->fit, n)) / size;
}

static void edge_slope_keep_better(search *s)
{
    double d[TERMS] = { 0.0 };
    whiten(s, s->normal, d + 1);
    const double gain = fit(s, d);
    if (gain < 0.999 * s->gain) { /* so that roundoff does not choose */
        double *fresh = s->fit;
        s->fit = s->best;
        s->best = fresh;
        s->gain = gain;
        s->fitted = s->count;
    }
}

/* ---- a slope --------------------------------------------------------------------- */

/* The mean slope of some of the two triangles of an edge: places and their shares. */
typedef struct faces {
    size_t count;
    uint32_t place[4];
    double share[4]; /* [1/m] */
} faces;

/* A corner of a triangle of the edge, as it lies in the plane. */
static const double *laid_corner(const search *s, uint32_t triangle, size_t k)
{
    return s->in_space ? s->unfolded.corner[triangle][k]
                       : s->mesh->rest[s->mesh->place[triangle][k]];
}

/* -1 where its corners run clockwise there. */
static double laid_turn(const search *s, uint32_t triangle)
{
    return s->in_space
                   && weft__plane_turn(laid_corner(s, triangle, 0),
                                       laid_corner(s, triangle, 1),
                                       laid_corner(s, triangle, 2))
                          < 0.0
               ? -1.0
               : 1.0;
}

/* Of the held triangles alone, or of all. */
static faces faces_of(const search *s, const weft__edge *edge, bool held)
{
    faces mean = { .count = 0 };
    bool taken[2];
    for (size_t k = 0; k < 2; ++k) {
        const uint32_t triangle = edge->triangle[k];
        taken[k] = triangle != WEFT__NONE && (!held || s->held[triangle]);
    }
    for (size_t k = 0; k < 6; ++k) { /* corner k % 3 of triangle k / 3 */
        const uint32_t triangle = edge->triangle[k / 3];
        if (taken[k / 3]) {
            const uint32_t *place = s->mesh->place[triangle];
            const double *a = laid_corner(s, triangle, (k + 1) % 3);
            const double *b = laid_corner(s, triangle, (k + 2) % 3);
            const double part = taken[1 - k / 3] ? 0.5 : 1.0;
            const double along
                = laid_turn(s, triangle)
                  * (s->normal[0] * (a[1] - b[1]) + s->normal[1] * (b[0] - a[0]));
            size_t at = 0;
            while (at < mean.count && mean.place[at] != place[k % 3]) {
                ++at;
            }
            mean.count += at == mean.count;
            mean.place[at] = place[k % 3];
            mean.share[at] += part * (along / (2.0 * s->mesh->area[triangle]));
        }
    }
    return mean;
}

static bool edge_slope_store(search *s, const uint32_t *places, const double *shares,
                             size_t count)
{
    weft__edge_slopes *out = s->out;
    if (!weft__reserve(s->memory, &out->particle, &out->room, out->count + count,
                       sizeof *out->particle)
        || !weft__reserve(s->memory, &out->share, &out->share_room, out->count + count,
                          sizeof *out->share)) {
        return false;
    }
    for (size_t k = 0; k < count; ++k, ++out->count) {
        out->particle[out->count] = s->mesh->particle[places[k]];
        out->share[out->count] = shares[k];
    }
    return true;
}

/* The best fit of a patch, which is widened until the gain is 1. */
static void find_fit(search *s, size_t e)
{
    size_t tries = 0;
    bool wider = true;
    s->gain = INFINITY;
    s->fitted = 0;
    while (wider) {
        while (s->count < ENOUGH && edge_slope_widen(s, e)) {
        }
        edge_slope_keep_better(s);
        wider = s->gain > 1.0 && s->count < MOST
                && (s->fitted == 0 || ++tries <= WIDENINGS) && edge_slope_widen(s, e);
    }
}

static bool edge_slope_fit(search *s, size_t e)
{
    const weft__edge *edge = &s->mesh->edge_list[e];
    patch(s, e);
    faces mean = faces_of(s, edge, true);
    if (mean.count > 0) {
        return edge_slope_store(s, mean.place, mean.share, mean.count);
    }
    find_fit(s, e);
    if (s->gain > BAD) {
        double hat[2];
        mean = faces_of(s, edge, false);
        whiten(s, s->normal, hat);
        const double size = sqrt(hat[0] * hat[0] + hat[1] * hat[1]);
        if (sqrt(edge_slope_product(mean.share, mean.share, mean.count))
            < s->gain * size) {
            return edge_slope_store(s, mean.place, mean.share, mean.count);
        }
    }
    return edge_slope_store(s, s->points, s->best, s->fitted);
}

/* [m^2] of its length. */
static double edge_square(const search *s, size_t e)
{
    const uint32_t *ends = s->mesh->edge_list[e].place;
    const double *a = s->mesh->rest[ends[0]], *b = s->mesh->rest[ends[1]];
    const double t[2] = { b[0] - a[0], b[1] - a[1] };
    return s->in_space ? s->unfolded.length[e] * s->unfolded.length[e]
                       : t[0] * t[0] + t[1] * t[1];
}

/* L^2 / sqrt(12) times the second derivative along an edge, by the points of the best
 * fit of its slope; nothing of an edge of a held triangle, or without a good fit. */
static bool curve(search *s, size_t e)
{
    const weft__edge *edge = &s->mesh->edge_list[e];
    double hat[2];
    patch(s, e);
    if (!edge_live(s, edge) || faces_of(s, edge, true).count > 0) {
        return true;
    }
    find_fit(s, e);
    s->count = s->fitted;
    whiten(s, (const double[2]){ -s->normal[1], s->normal[0] }, hat);
    const double d[TERMS] = {
        [3] = hat[0] * hat[0], [4] = hat[1] * hat[1], [5] = 2.0 * (hat[0] * hat[1])
    };
    if (!(s->gain <= BAD) || s->count > WEFT__CURVE_PARTS || !isfinite(fit(s, d))) {
        return true;
    }
    const double square = edge_square(s, e);
    for (size_t k = 0; k < s->count; ++k) {
        s->fit[k] *= square / sqrt(12.0);
    }
    return edge_slope_store(s, s->points, s->fit, s->count);
}

/* Whether a live triangle needs the slope of edge e. */
static bool needed(const search *s, const weft__edge *edge)
{
    if (edge->triangle[1] != WEFT__NONE) {
        return edge_live(s, edge);
    }
    return weft__bends(s->mesh, edge)
           && (edge_live(s, edge) || edge_live(s, &s->mesh->edge_list[edge->sewn]));
}

bool weft__edge_slopes_create(weft__edge_slopes *out, const weft__triangles *of,
                              const bool *held, bool curved, weft__stop *stop,
                              const weft_allocator *memory)
{
    search s = { .mesh = of, .held = held, .memory = memory, .out = out };
    *out = (weft__edge_slopes){ .first = weft__zeroed(memory, of->edges + 1,
                                                      sizeof *out->first) };
    bool made = out->first != NULL && edge_slope_reserve(&s)
                && (of->in_space == NULL
                    || weft__develop_create(&s.unfolded, of, held, memory));
    if (made) {
        edge_slope_join(&s);
    }
    for (size_t e = 0; made && e < of->edges; ++e) {
        if (weft__stops(stop)) {
            made = false;
        } else if (curved) {
            made = curve(&s, e);
        } else if (needed(&s, &of->edge_list[e])) {
            made = edge_slope_fit(&s, e);
        }
        out->first[e + 1] = out->count;
    }
    weft__develop_free(&s.unfolded);
    WEFT__FREE_ALL(memory, s.first, s.lists, s.work);
    return made;
}

void weft__edge_slopes_free(weft__edge_slopes *of, const weft_allocator *memory)
{
    WEFT__FREE_ALL(memory, of->first, of->particle, of->share);
}
