/* SPDX-License-Identifier: BSD-3-Clause */
/* wind.c -- the wind on a particle, after Provot 1995:
 *
 *     F = drag area (n . (wind - v)) n
 *
 * with n the unit normal, the cross product of the column tangent
 * x(r, c+1) - x(r, c-1) and the row tangent x(r+1, c) - x(r-1, c), one-sided on the
 * rim; no force where they are parallel or a direction has a single particle. */
#include "cloth/model.h"

#include <math.h>

/* x(hi) - x(lo), of the planes x. */
static void tangent(const double *x, size_t n, size_t lo, size_t hi, double t[3])
{
    for (size_t k = 0; k < 3; ++k) {
        t[k] = x[k * n + hi] - x[k * n + lo];
    }
}

/* False where there is no normal. NaN passes. */
static bool unit_normal(const weft_cloth *cloth, size_t r, size_t c, const double *x,
                        double normal[3])
{
    const size_t n = cloth->particles, cols = cloth->cols, i = r * cols + c;
    double a[3], b[3];
    tangent(x, n, c > 0 ? i - 1 : i, c + 1 < cols ? i + 1 : i, a);
    tangent(x, n, r > 0 ? i - cols : i, r + 1 < cloth->rows ? i + cols : i, b);
    normal[0] = a[1] * b[2] - a[2] * b[1];
    normal[1] = a[2] * b[0] - a[0] * b[2];
    normal[2] = a[0] * b[1] - a[1] * b[0];
    const double length
        = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (length == 0.0) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        normal[k] /= length;
    }
    return true;
}

bool weft__wind_force(const weft_cloth *cloth, size_t r, size_t c, const double *y,
                      double force[3])
{
    const size_t n = cloth->particles, i = r * cloth->cols + c;
    const double *v = y + 3 * n;
    double normal[3];
    if (!unit_normal(cloth, r, c, y, normal)) {
        return false;
    }
    double speed = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        speed += normal[k] * (cloth->wind_velocity[k] - v[k * n + i]);
    }
    const double push = cloth->wind_drag * weft__area(cloth, r, c) * speed;
    for (size_t k = 0; k < 3; ++k) {
        force[k] = push * normal[k];
    }
    return true;
}

static void add_wind(const weft_cloth *cloth, size_t r, size_t c, const double *y,
                     double *f)
{
    const size_t n = cloth->particles, i = r * cloth->cols + c;
    double force[3];
    if (weft__wind_force(cloth, r, c, y, force)) {
        for (size_t k = 0; k < 3; ++k) {
            f[k * n + i] += force[k];
        }
    }
}

void weft__wind_add_force(const weft_cloth *cloth, const double *y, double *f)
{
    if (cloth->wind_drag == 0.0) {
        return;
    }
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            add_wind(cloth, r, c, y, f);
        }
    }
}
