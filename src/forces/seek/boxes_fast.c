/* SPDX-License-Identifier: BSD-3-Clause */
/* boxes_fast.c -- the boxes and slopes of seek.h, and which patches are flat, 2 LANES
 * patches at a time. */
#include "forces/seek/seek.h"
#include "forces/seek/single.h"

INLINE size_t lesser(size_t a, size_t b)
{
    return a < b ? a : b;
}

INLINE float extreme(float a, float b, bool high)
{
    return high ? (a > b ? a : b) : (a < b ? a : b);
}

/* ---- boxes and slopes ------------------------------------------------------------ */

/* Of a[0] and b[0] and those to the right. */
INLINE void boxes_fast_put_box(const double *a, const double *b, size_t right,
                               float *low, float *high)
{
    const double p = a[0] < b[0] ? a[0] : b[0], u = a[0] < b[0] ? b[0] : a[0];
    const double q = a[right] < b[right] ? a[right] : b[right];
    const double v = a[right] < b[right] ? b[right] : a[right];
    const float least = single(p < q ? p : q), most = single(u < v ? v : u);
    *low = least - margin(least);
    *high = most + margin(most);
}

/* Of the edge from a number to another, and of the one beside it. */
INLINE void put_slopes(const double *from, const double *to, size_t beside, float by,
                       float *low, float *high)
{
    const float f = by * single(to[0] - from[0]);
    const float g = by * single(to[beside] - from[beside]);
    *low = f < g ? f : g;
    *high = f < g ? g : f;
}

/* Level 0 of a row of a grid: one coordinate. */
INLINE void boxes_fast_fill_row(const weft__boxes *to, const double *y, size_t r,
                                size_t k)
{
    const weft__primitives *of = &to->of;
    const weft__seek_level *at = &to->level[0];
    const size_t last = of->nodes.cols - 1, plane = at->plane;
    const size_t down = r + 1 < of->nodes.rows ? of->nodes.cols : 0;
    const float by[2]
        = { (float)(1.0 / of->spacing[0]), (float)(1.0 / of->spacing[1]) };
    const double *a = y + k * of->points + r * of->nodes.cols, *b = a + down;
    float *box = at->box + k * plane + r * at->stride;
    float *slope = at->slope + k * plane + r * at->stride, *across = slope + 6 * plane;
    for (size_t c = 0; c < last; ++c) {
        boxes_fast_put_box(a + c, b + c, 1, box + c, box + 3 * plane + c);
    }
    boxes_fast_put_box(a + last, b + last, 0, box + last, box + 3 * plane + last);
    for (size_t c = 0; c < last; ++c) {
        put_slopes(a + c, a + c + 1, down, by[1], across + c, across + 3 * plane + c);
    }
    for (size_t c = 0; c < last && down > 0; ++c) {
        put_slopes(a + c, b + c, 1, by[0], slope + c, slope + 3 * plane + c);
    }
    if (down > 0) {
        put_slopes(a + last, b + last, 0, by[0], slope + last,
                   slope + 3 * plane + last);
    }
}

/* Level 0 of a surface: what a point owns has it, or ends of its edges. */
INLINE void fill_point(const weft__boxes *to, const double *y, size_t node)
{
    const weft__primitives *of = &to->of;
    const weft__seek_level *at = &to->level[0];
    const size_t i = of->order != NULL ? of->order[node] : node;
    for (size_t k = 0; k < 3; ++k) {
        const double *from = y + k * of->points;
        double low = from[i], high = low;
        for (size_t e = of->edge_first[i]; e < of->edge_first[i + 1]; ++e) {
            const double x = from[of->edge[e][1]];
            low = x < low ? x : low, high = x > high ? x : high;
        }
        at->box[k * at->plane + node] = single(low) - margin(single(low));
        at->box[(3 + k) * at->plane + node] = single(high) + margin(single(high));
    }
}

/* Of `count` patches from four each, `by` and `others` apart. */
INLINE void boxes_fast_join(const float *from, size_t by, const size_t others[3],
                            size_t count, bool high, float *to)
{
    for (size_t c = 0; c < count; ++c) {
        const float *a = from + by * c;
        to[c] = extreme(extreme(a[0], a[others[0]], high),
                        extreme(a[others[1]], a[others[2]], high), high);
    }
}

/* Planes of row r of a level, or of patches [first, end) of the one of a surface, from
 * the level below. */
INLINE void join_planes(const weft__boxes *to, size_t level, size_t r, size_t first,
                        size_t end, size_t planes, const float *from, float *out)
{
    const weft__seek_level *at = &to->level[level], *below = at - 1;
    const size_t fold = to->of.nodes.fold, by = 2 * fold;
    const size_t others[3]
        = { 1, fold == 1 ? below->stride : 2, fold == 1 ? below->stride + 1 : 3 };
    for (size_t p = 0; p < planes; ++p) {
        const float *a = from + p * below->plane + 2 * r * below->stride + by * first;
        float *o = out + p * at->plane + r * at->stride + first;
        if (p % 6 < 3) {
            boxes_fast_join(a, by, others, end - first, false, o);
        } else {
            boxes_fast_join(a, by, others, end - first, true, o);
        }
    }
}

INLINE void fill_grid(const weft__boxes *to, const double *y, size_t k, size_t first,
                      size_t end)
{
    const weft__seek_level *at = &to->level[k];
    for (size_t r = first; r < end && k == 0; ++r) {
        for (size_t j = 0; j < 3; ++j) {
            boxes_fast_fill_row(to, y, r, j);
        }
    }
    for (size_t r = first; r < end && k > 0; ++r) {
        join_planes(to, k, r, 0, at->cols, 6, at[-1].box, at->box);
        join_planes(to, k, r, 0, at->cols, 12, at[-1].slope, at->slope);
    }
}

INLINE void fill_surface(const weft__boxes *to, const double *y, size_t k, size_t first,
                         size_t end)
{
    const weft__seek_level *at = &to->level[k];
    for (size_t c = first; c < end && k == 0; ++c) {
        fill_point(to, y, c);
    }
    if (k > 0) {
        join_planes(to, k, 0, first, end, 6, at[-1].box, at->box);
    }
}

void NAME(fill, LEVEL)(weft__boxes *to, const double *y, size_t part)
{
    for (size_t k = 0; k <= to->top; ++k) {
        const weft__seek_level *at = &to->level[k];
        const size_t by = to->of.nodes.fold * (to->top - k);
        const size_t first = part << by, end = (part + 1) << by;
        if (to->of.nodes.fold == 1) {
            fill_grid(to, y, k, first, lesser(end, at->rows));
        } else {
            fill_surface(to, y, k, first, lesser(end, at->cols));
        }
    }
}

/* ---- what is flat ---------------------------------------------------------------- */

enum { MANY = 2 * LANES };
typedef float many __attribute__((vector_size(8 * LANES)));
typedef float many_anywhere
    __attribute__((vector_size(8 * LANES), aligned(4), may_alias));
typedef int32_t many_mask __attribute__((vector_size(8 * LANES)));

/* A direction across another must be so much of what it was taken from, squared: single
 * precision does not find less. */
#define ACROSS 1e-4F

INLINE many choose_many(many_mask where, many a, many b)
{
    return (many)(((many_mask)a & where) | ((many_mask)b & ~where));
}

INLINE many root_many(many a)
{
#if defined __AVX512F__ && LANES == 8
    return (many)_mm512_sqrt_ps((__m512)a);
#elif defined __AVX__ && LANES == 4
    return (many)_mm256_sqrt_ps((__m256)a);
#elif defined __SSE2__ && LANES == 2
    return (many)_mm_sqrt_ps((__m128)a);
#else
    for (size_t i = 0; i < MANY; ++i) {
        a[i] = sqrtf(a[i]);
    }
    return a;
#endif
}

INLINE many dot_many(const many a[3], const many b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The square of how far bounds reach from u, which is made a unit vector. */
INLINE many boxes_fast_beyond(const many bounds[6], many u[3])
{
    const many inverse = 1.0F / root_many(dot_many(u, u));
    many square = { 0 };
    for (size_t k = 0; k < 3; ++k) {
        u[k] *= inverse;
        const many low = bounds[k] - u[k], high = bounds[3 + k] - u[k];
        square += choose_many(low * low > high * high, low * low, high * high);
    }
    return square;
}

/* The squares of E; infinite or NaN where a bound is empty. */
INLINE many bend_of(const many w[12])
{
    many e[3], f[3];
    for (size_t k = 0; k < 3; ++k) {
        e[k] = 0.5F * (w[k] + w[3 + k]);
        f[k] = 0.5F * (w[6 + k] + w[9 + k]);
    }
    const many down = boxes_fast_beyond(w, e), along = dot_many(e, f),
               whole = dot_many(f, f);
    for (size_t k = 0; k < 3; ++k) {
        f[k] -= along * e[k];
    }
    const many_mask across = dot_many(f, f) > ACROSS * whole;
    return choose_many(across, down + boxes_fast_beyond(w + 6, f),
                       (many){ 0 } + INFINITY);
}

INLINE void boxes_fast_widen(size_t plane, const float *from, many *to)
{
    const many x = *(const many_anywhere *)from;
    *to = choose_many(plane % 6 < 3 ? x < *to : x > *to, x, *to);
}

/* Of MANY patches from column c on, and of the 2 x 2 and 3 x 3 from there on: each
 * window has one more column and row. */
INLINE void bend_patches(const weft__seek_level *at, size_t r, size_t c)
{
    many w[12];
    for (size_t by = 0; by < 3; ++by) {
        for (size_t p = 0; p < 12; ++p) {
            const float *a = at->slope + p * at->plane + r * at->stride + c;
            if (by == 0) {
                w[p] = *(const many_anywhere *)a;
            }
            for (size_t j = 0; j <= by && by > 0; ++j) {
                boxes_fast_widen(p, a + j * at->stride + by, &w[p]);
                boxes_fast_widen(p, a + by * at->stride + j, &w[p]);
            }
        }
        *(many_anywhere *)(at->bent[by] + r * at->stride + c) = bend_of(w);
    }
}

void NAME(bend, LEVEL)(weft__boxes *to, size_t part)
{
    for (size_t k = 0; k <= to->top; ++k) {
        const weft__seek_level *at = &to->level[k];
        const size_t by = to->top - k, end = lesser((part + 1) << by, at->rows);
        for (size_t r = part << by; r < end; ++r) {
            for (size_t c = 0; c < at->cols; c += MANY) {
                bend_patches(at, r, c);
            }
        }
    }
}
