/* SPDX-License-Identifier: BSD-3-Clause */
/* folded_mesh.h -- random meshes for contact with themselves, their shapes and the
 * cloth of them. */
#pragma once

#include <math.h>

#include "meshes.h"

/* [m] The smallest height at rest. */
static inline double mesh_least_height(const test_mesh *of)
{
    double least = INFINITY;
    for (size_t t = 0; t < of->def.triangles; ++t) {
        const double *x[3];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = &of->rest[2 * (size_t)of->places[3 * t + k]];
        }
        const double area = fabs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1])
                                 - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]));
        for (size_t k = 0; k < 3; ++k) {
            const double *a = x[k], *b = x[(k + 1) % 3];
            least = fmin(least, area / hypot(b[0] - a[0], b[1] - a[1]));
        }
    }
    return least;
}

/* A shape of rest places (u, v) in a square of 1 m. */
typedef void mesh_shape(double u, double v, double x[3], double speed[3]);

/* A fold of 6 cm about the middle, whose legs meet; `askew` each to each. */
static inline void mesh_u(double u, double v, double askew, double x[3],
                          double speed[3])
{
    const double pi = 3.14159265358979323846, rho = 0.06, s0 = 0.5 - 0.5 * pi * rho;
    const double angle = fmin(fmax((u - s0) / rho, 0.0), pi);
    x[0] = u < s0 + pi * rho ? fmin(u, s0) + rho * sin(angle) : 2.0 * s0 + pi * rho - u;
    x[1] = rho - rho * cos(angle);
    x[2] = v + askew * x[1];
    speed[0] = speed[2] = 0.0;
    speed[1] = (u < 0.5 ? 12.0 : -12.0) * (u - 0.5) * (u - 0.5);
}

/* Places and velocities of vertices in a shape, scaled by the size [m] of the sheet. */
static inline void mesh_set(const test_mesh *of, double size, mesh_shape *shape,
                            double *xyz, double *speeds)
{
    for (size_t c = 0; c < 3 * of->def.triangles; ++c) {
        const double *at = &of->rest[2 * (size_t)of->places[c]];
        const size_t i = 3 * (size_t)of->corners[c];
        shape(at[0] / size, at[1] / size, &xyz[i], &speeds[i]);
        for (size_t k = 0; k < 3; ++k) {
            xyz[i + k] *= size, speeds[i + k] *= size;
        }
    }
}
