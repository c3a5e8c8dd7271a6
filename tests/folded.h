/* SPDX-License-Identifier: BSD-3-Clause */
/* folded.h -- cloths that meet themselves, for tests and benchmarks, and a count of the
 * places where one passes through itself. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "weft/weft.h"

/* A sheet 1 m wide, of 0.2 kg/m^2 and thickness 5 mm or half the spacing, flat in the
 * plane of x and z. */
static inline weft_cloth_def folded_model(size_t rows, size_t cols)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows, def.cols = cols;
    def.spacing[0] = def.spacing[1] = 1.0 / (double)((rows > cols ? rows : cols) - 1);
    def.down[1] = 0.0, def.down[2] = 1.0;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.02 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ true, 50.0, 0.01 };
    def.springs[WEFT_BEND] = (weft_spring_def){ true, 5.0, 0.001 };
    def.contact.thickness = fmin(5e-3, 0.5 * def.spacing[0]);
    def.contact.self = true;
    return def;
}

/* Where the point at (u, w) [m] of the sheet is and how it moves. */
typedef void folded_shape(double u, double w, double x[3], double v[3]);

static const double folded_pi = 3.14159265358979323846;

/* A U lying on its side whose legs close at 2 speed |u - 1/2| against each other. */
static inline void folded_u(double u, double w, double speed, double x[3], double v[3])
{
    const double radius = 0.06, bend = folded_pi * radius;
    const double end = 0.5 - 0.5 * bend, angle = (u - end) / radius;
    const bool lower = u < end, upper = u >= end + bend;
    x[0] = lower ? u : upper ? end - (u - end - bend) : end + radius * sin(angle);
    x[1] = lower ? 0.0 : upper ? 2.0 * radius : radius * (1.0 - cos(angle));
    x[2] = w + 0.02 * x[1];
    v[0] = v[2] = 0.0;
    v[1] = lower || upper ? 2.0 * (lower ? speed : -speed) * fabs(u - 0.5) : 0.0;
}

static inline void folded_fold(double u, double w, double x[3], double v[3])
{
    folded_u(u, w, 1.0, x, v);
}

static inline void folded_slam(double u, double w, double x[3], double v[3])
{
    folded_u(u, w, 12.0, x, v);
}

/* Standing on its edge 1 cm above the plane y = 0. */
static inline void folded_pile(double u, double w, double x[3], double v[3])
{
    x[0] = u;
    x[1] = 1.01 - w;
    x[2] = 0.01 * sin(7.0 * u) + 0.01 * sin(5.0 * w) + 0.1 * w;
    v[0] = v[1] = v[2] = 0.0;
}

/* A U at rest 6 mm above the plane y = 0. */
static inline void folded_press(double u, double w, double x[3], double v[3])
{
    folded_u(u, w, 0.0, x, v);
    x[1] += 6e-3;
}

static inline void folded_flat(double u, double w, double x[3], double v[3])
{
    x[0] = u, x[1] = 0.0, x[2] = w;
    v[0] = v[1] = v[2] = 0.0;
}

/* A spiral whose layers are 6 mm apart, above the plane y = 0. */
static inline void folded_roll(double u, double w, double x[3], double v[3])
{
    const double pitch = 6e-3 / (2.0 * folded_pi), first = 0.05 / pitch;
    const double angle = sqrt(2.0 * u / pitch + first * first);
    x[0] = pitch * angle * cos(angle);
    x[1] = pitch * angle * sin(angle) + 0.09;
    x[2] = w;
    v[0] = v[1] = v[2] = 0.0;
}

/* A chain, coiled above the plane y = 0, that throws itself into loops. */
static inline void folded_coil(double u, double w, double x[3], double v[3])
{
    (void)w;
    x[0] = 0.08 * cos(12.0 * u);
    x[1] = 0.02 + 0.1 * u;
    x[2] = 0.08 * sin(12.0 * u);
    v[0] = 2.0 * sin(40.0 * u);
    v[1] = -1.0;
    v[2] = 2.0 * cos(33.0 * u);
}

/* The arrays xyz and v[3 N] of a definition. */
static inline void folded_start(const weft_cloth_def *def, folded_shape *shape,
                                double *xyz, double *v)
{
    for (size_t i = 0; i < def->rows * def->cols; ++i) {
        shape((double)(i % def->cols) * def->spacing[1],
              (double)(i / def->cols) * def->spacing[0], xyz + 3 * i, v + 3 * i);
    }
}

/* ---- crossings ------------------------------------------------------------------- */

/* Six times the volume of a, b, c, d. */
static inline double folded_volume(const double *a, const double *b, const double *c,
                                   const double *d)
{
    double u[3], v[3], w[3];
    for (size_t k = 0; k < 3; ++k) {
        u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
           + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static inline bool folded_pierces(const double *p, const double *q, const double *a,
                                  const double *b, const double *c)
{
    for (size_t k = 0; k < 3; ++k) {
        if (fmin(p[k], q[k]) > fmax(a[k], fmax(b[k], c[k]))
            || fmax(p[k], q[k]) < fmin(a[k], fmin(b[k], c[k]))) {
            return false;
        }
    }
    const double s = folded_volume(p, q, a, b), t = folded_volume(p, q, b, c);
    const double u = folded_volume(p, q, c, a);
    return ((s > 0.0 && t > 0.0 && u > 0.0) || (s < 0.0 && t < 0.0 && u < 0.0))
           && folded_volume(a, b, c, p) * folded_volume(a, b, c, q) < 0.0;
}

/* Edges, diagonals (r, c + 1)-(r + 1, c) included, that pierce triangles without a
 * common particle, of positions xyz[3 rows cols]. */
static inline size_t folded_crossings(const double *xyz, size_t rows, size_t cols)
{
    size_t count = 0;
    for (size_t j = 0; j < 2 * rows * cols; ++j) {
        const size_t at = j / 2;
        if (at / cols + 1 == rows || at % cols + 1 == cols) {
            continue;
        }
        const size_t t[3] = { j % 2 == 0 ? at : at + cols + 1, at + 1, at + cols };
        for (size_t e = 0; e < 3 * rows * cols; ++e) {
            const size_t i = e / 3, way = e % 3;
            const bool right = i % cols + 1 < cols, down = i / cols + 1 < rows;
            const size_t p = way == 2 ? i + 1 : i, q = way == 0 ? i + 1 : i + cols;
            const bool shares = p == t[0] || p == t[1] || p == t[2] || q == t[0]
                                || q == t[1] || q == t[2];
            if (!shares && (right || way == 1) && (down || way == 0)) {
                count += folded_pierces(xyz + 3 * p, xyz + 3 * q, xyz + 3 * t[0],
                                        xyz + 3 * t[1], xyz + 3 * t[2]);
            }
        }
    }
    return count;
}

/* Where two edges p and q lie across each other, seen along n = their cross product:
 * the height of q over p, times |n|; else 0. */
static inline double folded_height(const double *p, const double *q, double n[3])
{
    double e[3], f[3], g[3];
    for (size_t k = 0; k < 3; ++k) {
        e[k] = p[3 + k] - p[k], f[k] = q[3 + k] - q[k], g[k] = q[k] - p[k];
    }
    double square = 0.0, s = 0.0, t = 0.0, height = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = e[a] * f[b] - e[b] * f[a];
        square += n[k] * n[k];
        height += n[k] * g[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        s += n[k] * (g[a] * f[b] - g[b] * f[a]);
        t += n[k] * (g[a] * e[b] - g[b] * e[a]);
    }
    return s > 0.0 && s < square && t > 0.0 && t < square ? height : 0.0;
}

/* Edges of a chain of n particles that got to the other side of each other in a step.
 */
static inline size_t folded_passes(const double *before, const double *after, size_t n)
{
    size_t count = 0;
    for (size_t i = 0; i + 1 < n; ++i) {
        for (size_t j = i + 2; j + 1 < n; ++j) {
            double u[3], v[3];
            const double from = folded_height(before + 3 * i, before + 3 * j, u);
            const double to = folded_height(after + 3 * i, after + 3 * j, v);
            count += from * to < 0.0 && u[0] * v[0] + u[1] * v[1] + u[2] * v[2] > 0.0;
        }
    }
    return count;
}
