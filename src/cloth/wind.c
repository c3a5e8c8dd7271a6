/* SPDX-License-Identifier: BSD-3-Clause */
/* wind.c -- the wind on a particle, after Provot 1995:
 *
 *     F = drag area (n . (wind - v)) n
 *
 * with n the unit normal of N, the cross product of the column tangent
 * x(r, c+1) - x(r, c-1) and the row tangent x(r+1, c) - x(r-1, c), one-sided on the
 * rim; no force where they are parallel or a direction has a single particle. */
#include "cloth/added.h"
#include "cloth/springs.h"

/* x(hi) - x(lo), of the planes x. */
static void tangent(const double *x, size_t n, size_t lo, size_t hi, double t[3])
{
    for (size_t k = 0; k < 3; ++k) {
        t[k] = x[k * n + hi] - x[k * n + lo];
    }
}

static void wind_force(const weft__subject *of, size_t i, double share, double force[3])
{
    const weft_cloth *cloth = of->cloth;
    const double *y = of->y;
    const size_t n = cloth->particles, cols = cloth->cols, r = i / cols, c = i % cols;
    double a[3], b[3], flow[3];
    tangent(y, n, c > 0 ? i - 1 : i, c + 1 < cols ? i + 1 : i, a);
    tangent(y, n, r > 0 ? i - cols : i, r + 1 < cloth->rows ? i + cols : i, b);
    const double normal[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                               a[0] * b[1] - a[1] * b[0] };
    for (size_t k = 0; k < 3; ++k) {
        flow[k] = cloth->wind_velocity[k] - y[(k + 3) * n + i];
    }
    const double push = cloth->wind_drag * weft__area(cloth, r, c) * share
                        * weft__dot(normal, flow)
                        / (weft__dot(normal, normal) + DBL_MIN);
    for (size_t k = 0; k < 3; ++k) {
        force[k] = cloth->wind_drag != 0.0 ? push * normal[k] : 0.0;
    }
}

static void wind_power(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles, end = (r + 1) * cloth->cols;
    for (size_t i = r * cloth->cols; cloth->wind_drag != 0.0 && i < end; ++i) {
        const double *z = of->y + i;
        const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
        double force[3];
        if (cloth->pin[i] == 0) {
            wind_force(of, i, 1.0, force);
            row->power[WEFT_POWER_WIND] += weft__dot(force, v);
        }
    }
}

static void wind_add(const weft__subject *of, size_t i, weft__unit unit, double *to)
{
    const size_t n = of->cloth->particles;
    double force[3];
    wind_force(of, i, unit == WEFT__FORCE ? 1.0 : of->cloth->inverse_mass[i], force);
    for (size_t k = 0; of->cloth->wind_drag != 0.0 && k < 3; ++k) {
        to[k * n] += force[k];
    }
}

static double wind_damping(const weft_cloth *cloth, size_t i)
{
    return cloth->wind_drag * weft__area(cloth, i / cloth->cols, i % cloth->cols);
}

const weft__added weft__wind = { wind_add, wind_power, wind_damping };
