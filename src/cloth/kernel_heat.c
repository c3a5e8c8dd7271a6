/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_heat.c -- rates of a row of springs, LANES at a time, in SUMS sums of every
 * SUMS-th spring at every width. */
#include "cloth/kernel.h"
#include "cloth/lanes.h"

#ifndef LEVEL
#define LEVEL plain
#endif
#define NAME_(stem, level) weft__##stem##_##level
#define NAME(stem, level)  NAME_(stem, level)

enum { SUMS = 8, PARTS = SUMS / LANES };

/* (w.d)^2 / (d.d), that is (w.u)^2; w.d is 0 where L = 0 */
INLINE vec rate(const double *from, const double *to, size_t n)
{
    const vec3 d = minus(load3(to, n), load3(from, n));
    const vec3 w = minus(load3(to + 3 * n, n), load3(from + 3 * n, n));
    const vec dd = dot(d, d), wd = dot(w, d);
    return wd * wd / (dd + only(splat(1.0), dd == 0.0));
}

static double rate_of_one(const double *from, const double *to, size_t n)
{
    double d[3], w[3];
    for (size_t k = 0; k < 3; ++k) {
        d[k] = to[k * n] - from[k * n];
        w[k] = to[(3 + k) * n] - from[(3 + k) * n];
    }
    const double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double wd = w[0] * d[0] + w[1] * d[1] + w[2] * d[2];
    return wd * wd / (dd == 0.0 ? 1.0 : dd);
}

/* The rest of a row by the same operations; lanes beyond it are read and not counted.
 */
INLINE void add_rest(vec *part, const double *from, size_t n, size_t stride,
                     size_t count)
{
    static const double lane[SUMS] = { 0, 1, 2, 3, 4, 5, 6, 7 };
    for (size_t k = 0; k < PARTS; ++k) {
        const double *at = from + k * LANES;
        const mask counts = load(lane + k * LANES) < splat((double)count);
        part[k] += only(rate(at, at + stride, n), counts);
    }
}

double NAME(rates, LEVEL)(const double *y, size_t n, size_t stride, size_t count,
                          size_t room)
{
    vec part[PARTS] = { { 0 } };
    double sum[SUMS], total = 0.0;
    size_t i = 0;
    for (; i + SUMS <= count; i += SUMS) {
        for (size_t k = 0; k < PARTS; ++k) {
            const double *from = y + i + k * LANES;
            part[k] += rate(from, from + stride, n);
        }
    }
    if (i < count && i + SUMS <= room) {
        add_rest(part, y + i, n, stride, count - i);
        i = count;
    }
    for (size_t k = 0; k < PARTS; ++k) {
        store(sum + k * LANES, part[k]);
    }
    for (size_t k = 0; i + k < count; ++k) {
        sum[k] += rate_of_one(y + i + k, y + i + k + stride, n);
    }
    for (size_t k = 0; k < SUMS; ++k) {
        total += sum[k];
    }
    return total;
}
