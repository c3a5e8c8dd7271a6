/* SPDX-License-Identifier: BSD-3-Clause */
/* surfaces.h -- meshes that rest in space for tests: spheres and Moebius bands, their
 * cloths, states and forces. */
#pragma once

#include <math.h>

#include "meshes.h"

static inline weft_cloth *surface_cloth(const weft_mesh_def *mesh)
{
    weft_cloth_def def = weft_cloth_def_default();
    memset(def.gravity, 0, sizeof def.gravity);
    def.mesh = mesh;
    return test_cloth(&def);
}

static inline double *surface_state(const weft_cloth *cloth, const double *xyz,
                                    const double *speed)
{
    const size_t n = weft_cloth_particles(cloth);
    double *y = calloc(6 * n, sizeof *y);
    for (size_t j = 0; j < 3 * n; ++j) {
        const size_t i = weft_cloth_index(cloth, j / 3);
        y[j % 3 * n + i] = xyz[j];
        y[(3 + j % 3) * n + i] = speed != NULL ? speed[j] : 0.0;
    }
    return y;
}

/* [N] by vertices; frees neither. */
static inline double *surface_forces(const weft_cloth *cloth, const double *y)
{
    const size_t n = weft_cloth_particles(cloth);
    double *planes = malloc(3 * n * sizeof *planes);
    double *to = malloc(3 * n * sizeof *to);
    weft_cloth_force(cloth, 0.0, y, planes);
    for (size_t j = 0; j < 3 * n; ++j) {
        to[j] = planes[j % 3 * n + weft_cloth_index(cloth, j / 3)];
    }
    free(planes);
    return to;
}

static inline double surface_largest(const double *x, size_t count)
{
    double most = 0.0;
    for (size_t j = 0; j < count; ++j) {
        most = fmax(most, fabs(x[j]));
    }
    return most;
}

/* Moves every vertex by up to `size` [m] in each direction. */
static inline double *surface_shaken(const double *start, size_t n, double size,
                                     uint64_t seed)
{
    double *to = malloc(3 * n * sizeof *to);
    for (size_t j = 0; j < 3 * n; ++j) {
        to[j] = start[j] + size * (2.0 * random_uniform(&seed) - 1.0);
    }
    return to;
}

/* ---- surfaces of any kind -------------------------------------------------------- */

typedef struct surface {
    size_t vertices, triangles;
    double *start;
    uint32_t *corners;
    weft_fabric fabric;
    weft_mesh_def def;
} surface;

static inline void surface_take(surface *of, size_t vertices, size_t triangles)
{
    *of = (surface){ .vertices = vertices, .triangles = triangles };
    of->start = calloc(3 * vertices, sizeof *of->start);
    of->corners = calloc(3 * triangles, sizeof *of->corners);
    of->fabric = mesh_fabric;
}

static inline void surface_point(surface *of, const weft_rest *rest)
{
    of->def = weft_mesh_def_default();
    of->def.vertices = of->vertices;
    of->def.start = of->start;
    of->def.triangles = of->triangles;
    of->def.corners = of->corners;
    of->def.fabrics = &of->fabric;
    of->def.fabric_count = 1;
    of->def.rests = rest;
}

static inline void surface_free(surface *of)
{
    free(of->start);
    free(of->corners);
}

/* A sphere of radius 1: an octahedron whose faces are divided `fine` times in four, the
 * vertices but its own moved by up to `jitter` of an edge. */
static inline void make_sphere(surface *of, size_t fine, double jitter)
{
    static const double corner[6][3] = { { 1, 0, 0 },  { -1, 0, 0 }, { 0, 1, 0 },
                                         { 0, -1, 0 }, { 0, 0, 1 },  { 0, 0, -1 } };
    static const uint32_t faces[8][3]
        = { { 0, 2, 4 }, { 2, 1, 4 }, { 1, 3, 4 }, { 3, 0, 4 },
            { 2, 0, 5 }, { 1, 2, 5 }, { 3, 1, 5 }, { 0, 3, 5 } };
    const size_t n = (size_t)1 << fine, side = 2 * n + 1;
    size_t *number = calloc(side * side * side, sizeof *number);
    surface_take(of, 4 * n * n + 2, 8 * n * n);
    size_t count = 0, t = 0;
    uint64_t seed = 4;
    for (size_t f = 0; f < 8; ++f) {
        uint32_t *at = calloc((n + 1) * (n + 1), sizeof *at);
        for (size_t a = 0; a <= n; ++a) {
            for (size_t b = 0; a + b <= n; ++b) {
                double x[3];
                size_t key = 0;
                for (size_t k = 0; k < 3; ++k) {
                    x[k] = (double)(n - a - b) * corner[faces[f][0]][k]
                           + (double)a * corner[faces[f][1]][k]
                           + (double)b * corner[faces[f][2]][k];
                    key = key * side + (size_t)(x[k] + (double)n);
                }
                if (number[key] == 0) {
                    double size = 0.0;
                    for (size_t k = 0; k < 3; ++k) {
                        const bool own = (a + b) % n == 0 && (a == 0 || b == 0);
                        x[k]
                            += own ? 0.0 : jitter * (2.0 * random_uniform(&seed) - 1.0);
                        size += x[k] * x[k];
                    }
                    for (size_t k = 0; k < 3; ++k) {
                        of->start[3 * count + k] = x[k] / sqrt(size);
                    }
                    number[key] = ++count;
                }
                at[a * (n + 1) + b] = (uint32_t)number[key] - 1;
            }
        }
        for (size_t a = 0; a < n; ++a) {
            for (size_t b = 0; a + b < n; ++b) {
                const uint32_t p = at[a * (n + 1) + b], q = at[(a + 1) * (n + 1) + b],
                               r = at[a * (n + 1) + b + 1];
                memcpy(&of->corners[3 * t++], (uint32_t[]){ p, q, r }, 3 * sizeof p);
                if (a + b + 1 < n) {
                    const uint32_t s = at[(a + 1) * (n + 1) + b + 1];
                    memcpy(&of->corners[3 * t++], (uint32_t[]){ q, s, r },
                           3 * sizeof p);
                }
            }
        }
        free(at);
    }
    ck_assert_uint_eq(count, of->vertices);
    ck_assert_uint_eq(t, of->triangles);
    free(number);
}

/* A band of radius 1 and width w that is turned over once. */
static inline void make_moebius(surface *of, size_t n, size_t m, double w)
{
    surface_take(of, n * (m + 1), 2 * n * m);
    for (size_t i = 0; i < n * (m + 1); ++i) {
        const double a
            = 2.0 * 3.14159265358979323846 * (double)(i / (m + 1)) / (double)n;
        const double s = w * ((double)(i % (m + 1)) / (double)m - 0.5);
        of->start[3 * i] = (1.0 + s * cos(a / 2.0)) * cos(a);
        of->start[3 * i + 1] = (1.0 + s * cos(a / 2.0)) * sin(a);
        of->start[3 * i + 2] = s * sin(a / 2.0);
    }
    for (size_t k = 0; k < n * m; ++k) {
        const size_t i = k / m, j = k % m, next = (i + 1) % n;
        const bool over = i + 1 == n;
        const uint32_t a = (uint32_t)(i * (m + 1) + j), b = a + 1,
                       c = (uint32_t)(next * (m + 1) + (over ? m - j : j)),
                       d = over ? c - 1 : c + 1;
        memcpy(&of->corners[6 * k], (uint32_t[]){ a, b, d, a, d, c }, 6 * sizeof a);
    }
}
