/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_wind.c -- the wind of wind.c, LANES columns at a time. With N = a x b not yet
 * of length 1, F = drag area (N.(wind - v)) / (N.N) N, and 0 where N = 0. */
#include "cloth/levels.h"
#include "kernel/lanes.h"

#include <float.h>

/* A block of particles and those around it. */
typedef struct patch {
    vec3 left, right, up, down; /* [m] */
    vec3 v;                     /* [m/s] */
    vec inverse_mass, area;
} patch;

INLINE vec3 acceleration(const weft_cloth *cloth, const patch *at)
{
    const double *w = cloth->wind_velocity;
    const vec3 a = minus(at->right, at->left), b = minus(at->down, at->up);
    const vec3 normal
        = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    const vec3 flow = { w[0] - at->v.x, w[1] - at->v.y, w[2] - at->v.z };
    const vec push = (cloth->wind_drag * at->area) * at->inverse_mass
                     * dot(normal, flow) / (dot(normal, normal) + DBL_MIN);
    return scaled(push, normal);
}

/* Adds to v' of particle i and those that follow it; 0 or NaN. */
INLINE vec add(const weft_cloth *cloth, const patch *at, size_t i, size_t count,
               double *dydt)
{
    const size_t n = cloth->particles;
    const vec3 more = acceleration(cloth, at);
    double *to = dydt + 3 * n + i;
    vec3 sums = more;
    if (count == LANES) {
        sums = plus(load3(to, n), more);
    } else {
        for (size_t l = 0; l < count; ++l) {
            sums.x[l] += to[l], sums.y[l] += to[n + l], sums.z[l] += to[2 * n + l];
        }
    }
    store3_some(to, n, sums, count);
    return trouble(sums, sums);
}

/* Columns from c on, up to LANES, one by one: on the rim tangents are one-sided. The
 * lanes left over repeat the last column. */
static vec add_rim(const weft_cloth *cloth, const double *y, size_t r, size_t c,
                   size_t count, double *dydt)
{
    const size_t n = cloth->particles, cols = cloth->cols;
    const size_t up = r > 0 ? cols : 0, down = r + 1 < cloth->rows ? cols : 0;
    patch at;
    for (size_t l = 0; l < LANES; ++l) {
        const size_t column = l < count ? c + l : c + count - 1;
        const size_t i = r * cols + column;
        set_lane(&at.left, l, y + (column > 0 ? i - 1 : i), n);
        set_lane(&at.right, l, y + (column + 1 < cols ? i + 1 : i), n);
        set_lane(&at.up, l, y + i - up, n);
        set_lane(&at.down, l, y + i + down, n);
        set_lane(&at.v, l, y + 3 * n + i, n);
        at.inverse_mass[l] = cloth->inverse_mass[i];
        at.area[l] = weft__area(cloth, r, column);
    }
    return add(cloth, &at, r * cols + c, count, dydt);
}

static vec add_row(const weft_cloth *cloth, const double *y, size_t r, double *dydt)
{
    const size_t n = cloth->particles, cols = cloth->cols;
    const size_t up = r > 0 ? cols : 0, down = r + 1 < cloth->rows ? cols : 0;
    const vec area = splat(weft__area(cloth, r, cols > 2 ? 1 : 0));
    vec bad = add_rim(cloth, y, r, 0, 1, dydt);
    size_t c = 1;
    for (; c + LANES < cols; c += LANES) {
        const size_t i = r * cols + c;
        const double *x = y + i;
        const patch at = {
            .left = load3(x - 1, n),
            .right = load3(x + 1, n),
            .up = load3(x - up, n),
            .down = load3(x + down, n),
            .v = load3(x + 3 * n, n),
            .inverse_mass = load(cloth->inverse_mass + i),
            .area = area,
        };
        bad += add(cloth, &at, i, LANES, dydt);
    }
    if (c < cols) {
        bad += add_rim(cloth, y, r, c, cols - c, dydt);
    }
    return bad;
}

int NAME(wind, LEVEL)(const weft__subject *of, double *dydt, size_t first_row,
                      size_t end_row)
{
    vec bad = splat(0.0);
    for (size_t r = first_row; of->cloth->wind_drag != 0.0 && r < end_row; ++r) {
        bad += add_row(of->cloth, of->y, r, dydt);
    }
    return sum(bad) == 0.0 ? 0 : 1;
}
