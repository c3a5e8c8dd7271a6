/* SPDX-License-Identifier: BSD-3-Clause */
/* damping_fast.c -- the power of the dampers of springs, LANES at a time:
 * c (w.u)^2 = c (w.d)^2 / d.d, and 0 where d = 0. */
#include "forces/lanes.h"
#include "forces/springs/springs.h"

#include <float.h>

enum { SUMS = 8 }; /* of every eighth spring, whatever the width */

/* (w.u)^2 [m^2/s^2] of `count` springs from p to q, of planes n apart. */
INLINE vec square_rate(const double *p, const double *q, size_t n, size_t count)
{
    const vec3 d = minus(load3_some(q, n, count), load3_some(p, n, count));
    const vec3 w
        = minus(load3_some(q + 3 * n, n, count), load3_some(p + 3 * n, n, count));
    const vec wd = dot(w, d);
    return wd * (wd / (dot(d, d) + DBL_MIN));
}

/* As above, summed over the springs of a group that start at p. */
static double group_sum(const double *p, const double *q, size_t n, size_t count)
{
    double sums[SUMS] = { 0.0 }, total = 0.0;
    size_t c = 0;
    for (; c + LANES <= count; c += LANES) {
        double *to = sums + c % SUMS;
        store(to, load(to) + square_rate(p + c, q + c, n, LANES));
    }
    if (c < count) {
        double *to = sums + c % SUMS;
        store(to, load(to) + square_rate(p + c, q + c, n, count - c));
    }
    for (size_t k = 0; k < SUMS; ++k) {
        total += sums[k];
    }
    return total;
}

/* The same of row r, where springs along a rim may count half. */
static double row_sum(const weft__springs *own, const weft__group *group,
                      const double *y, size_t r)
{
    const size_t n = own->mesh->particles,
                 first = r * own->mesh->cols + group->first_col;
    const size_t count = group->end_col - group->first_col;
    const double *p = y + first, *q = p + group->stride;
    if (group->half_rim && group->end_row < own->mesh->rows) {
        const double rim
            = group_sum(p, q, n, 1) + group_sum(p + count - 1, q + count - 1, n, 1);
        return group_sum(p + 1, q + 1, n, count - 2) + 0.5 * rim;
    }
    return weft__spring_share(own->mesh, group, first) * group_sum(p, q, n, count);
}

double NAME(damping, LEVEL)(const weft__springs *own, const double *y, size_t r)
{
    double power = 0.0;
    for (size_t g = 0; g < own->group_count; ++g) {
        const weft__group *group = &own->groups[g];
        if (r < group->end_row && group->damping != 0.0) {
            power += group->damping * row_sum(own, group, y, r);
        }
    }
    return power;
}
