/* SPDX-License-Identifier: BSD-3-Clause */
/* wind_fast.c -- the wind of wind.c, LANES columns at a time. With N = a x b not yet
 * of length 1, F = drag area (N.(wind - v)) / (N.N) N, and 0 where N = 0. */
#include "forces/lanes.h"
#include "forces/wind/wind.h"

#include <float.h>

/* A block of particles and those around it. */
typedef struct patch {
    vec3 left, right, up, down; /* [m] */
    vec3 v;                     /* [m/s] */
    vec inverse_mass, area;
} patch;

INLINE vec3 acceleration(const weft__wind *of, const patch *at)
{
    const double *w = of->air.velocity;
    const vec3 a = minus(at->right, at->left), b = minus(at->down, at->up);
    const vec3 normal
        = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    const vec3 flow = { w[0] - at->v.x, w[1] - at->v.y, w[2] - at->v.z };
    const vec push = (of->air.drag * at->area) * at->inverse_mass * dot(normal, flow)
                     / (dot(normal, normal) + DBL_MIN);
    return scaled(push, normal);
}

/* Adds to v' of particle i and those that follow it; 0 or NaN. */
INLINE vec wind_fast_add(const weft__wind *of, const patch *at, size_t i, size_t count,
                         double *dvdt)
{
    const size_t n = of->mesh->stride;
    const vec3 more = acceleration(of, at);
    double *to = dvdt + i;
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
static vec add_rim(const weft__wind *of, const double *y, size_t r, size_t c,
                   size_t count, double inner, double *dvdt)
{
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride, cols = mesh->cols;
    const size_t up = r > 0 ? cols : 0, down = r + 1 < mesh->rows ? cols : 0;
    const double rim = weft__area(mesh, r * cols);
    patch at;
    for (size_t l = 0; l < LANES; ++l) {
        const size_t column = l < count ? c + l : c + count - 1;
        const size_t i = r * cols + column;
        set_lane(&at.left, l, y + (column > 0 ? i - 1 : i), n);
        set_lane(&at.right, l, y + (column + 1 < cols ? i + 1 : i), n);
        set_lane(&at.up, l, y + i - up, n);
        set_lane(&at.down, l, y + i + down, n);
        set_lane(&at.v, l, y + 3 * n + i, n);
        at.inverse_mass[l] = mesh->inverse_mass[i];
        at.area[l] = column > 0 && column + 1 < cols ? inner : rim;
    }
    return wind_fast_add(of, &at, r * cols + c, count, dvdt);
}

static vec wind_fast_add_row(const weft__wind *of, const double *y, size_t r,
                             double *dvdt)
{
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride, cols = mesh->cols;
    const size_t up = r > 0 ? cols : 0, down = r + 1 < mesh->rows ? cols : 0;
    const double inner = weft__area(mesh, r * cols + (cols > 2 ? 1 : 0));
    const vec area = splat(inner);
    vec bad = add_rim(of, y, r, 0, 1, inner, dvdt);
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
            .inverse_mass = load(mesh->inverse_mass + i),
            .area = area,
        };
        bad += wind_fast_add(of, &at, i, LANES, dvdt);
    }
    if (c < cols) {
        bad += add_rim(of, y, r, c, cols - c, inner, dvdt);
    }
    return bad;
}

int NAME(wind, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                      double *to, size_t first, size_t end)
{
    const weft__wind *of = own;
    vec bad = splat(0.0);
    (void)unit;
    for (size_t r = first; r < end; ++r) {
        bad += wind_fast_add_row(of, at->y, r, to);
    }
    return sum(bad) == 0.0 ? 0 : 1;
}
