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

/* Of the column and the row of particle i. */
static void tangents(const weft_cloth *cloth, const double *x, size_t i, double a[3],
                     double b[3])
{
    const size_t n = cloth->particles, cols = cloth->cols, r = i / cols, c = i % cols;
    tangent(x, n, c > 0 ? i - 1 : i, c + 1 < cols ? i + 1 : i, a);
    tangent(x, n, r > 0 ? i - cols : i, r + 1 < cloth->rows ? i + cols : i, b);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void wind_force(const weft__subject *of, size_t i, double share, double force[3])
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles, r = i / cloth->cols, c = i % cloth->cols;
    double a[3], b[3], normal[3], flow[3];
    tangents(cloth, of->y, i, a, b);
    cross(a, b, normal);
    for (size_t k = 0; k < 3; ++k) {
        flow[k] = cloth->wind_velocity[k] - of->y[(k + 3) * n + i];
    }
    const double push = cloth->wind_drag * weft__area(cloth, r, c) * share
                        * weft__dot(normal, flow)
                        / (weft__dot(normal, normal) + DBL_MIN);
    for (size_t k = 0; k < 3; ++k) {
        force[k] = cloth->wind_drag != 0.0 ? push * normal[k] : 0.0;
    }
}

/* With the change dN = da x b + a x db of N, that of F = drag area (N.flow) N / (N.N)
 * is drag area ((dN.flow - N.dv - 2 (N.flow) (N.dN) / (N.N)) N + (N.flow) dN) / (N.N).
 */
static void wind_slope(const weft__subject *of, size_t i, double slope[3])
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles;
    double a[3], b[3], da[3], db[3], normal[3], turn[3], more[3], flow[3], dv[3];
    tangents(cloth, of->y, i, a, b);
    tangents(cloth, of->along, i, da, db);
    cross(a, b, normal);
    cross(da, b, turn);
    cross(a, db, more);
    for (size_t k = 0; k < 3; ++k) {
        turn[k] += more[k];
        dv[k] = of->along[(k + 3) * n + i];
        flow[k] = cloth->wind_velocity[k] - of->y[(k + 3) * n + i];
    }
    const double drag = cloth->wind_drag * cloth->inverse_mass[i]
                        * weft__area(cloth, i / cloth->cols, i % cloth->cols);
    const double inverse = 1.0 / (weft__dot(normal, normal) + DBL_MIN);
    const double push = weft__dot(normal, flow) * inverse;
    const double rate = (weft__dot(turn, flow) - weft__dot(normal, dv)) * inverse
                        - 2.0 * push * weft__dot(normal, turn) * inverse;
    for (size_t k = 0; k < 3; ++k) {
        slope[k] = drag * (rate * normal[k] + push * turn[k]);
    }
}

static int wind_change(const weft__subject *of, double *out, size_t first, size_t end)
{
    const size_t n = of->cloth->particles, cols = of->cloth->cols;
    double bad = 0.0, slope[3];
    for (size_t i = first * cols; of->cloth->wind_drag != 0.0 && i < end * cols; ++i) {
        wind_slope(of, i, slope);
        for (size_t k = 0; k < 3; ++k) {
            out[(k + 3) * n + i] += slope[k];
            bad += slope[k] * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
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

const weft__added weft__wind = { wind_add, wind_power, wind_change, wind_damping };
