/* SPDX-License-Identifier: BSD-3-Clause */
/* meshes.h -- triangle meshes for tests: a sheet of cells, whole or cut along a column
 * and sewn again, with any diagonals, moved vertices and numbers. */
#pragma once

#include <stdlib.h>
#include <string.h>

#include "random.h"
#include "support.h"

enum { MESH_FABRICS = 4 };

typedef struct test_mesh {
    size_t rows, cols; /* of vertices */
    weft_mesh_def def; /* points to the arrays below */
    double *start, *rest;
    uint32_t *corners, *places;
    weft_fabric fabrics[MESH_FABRICS];
} test_mesh;

typedef enum test_diagonals {
    MESH_RIGHT,
    MESH_ALTERNATING,
    MESH_RANDOM
} test_diagonals;

/* [kg/m^2], [N/m], [N m] */
static const weft_fabric mesh_fabric = { .density = 0.2,
                                         .stretch = { 1000.0, 700.0 },
                                         .shear = 150.0,
                                         .bend = { 2e-5, 1e-5 },
                                         .twist = 1.5e-5,
                                         .coupling = 100.0 };

static inline void mesh_free(test_mesh *of)
{
    free(of->start);
    free(of->rest);
    free(of->corners);
    free(of->places);
}

/* A new definition that points to what *of has. */
static inline void mesh_point(test_mesh *of, size_t vertices, size_t places,
                              size_t triangles)
{
    of->def = weft_mesh_def_default();
    of->def.vertices = vertices;
    of->def.start = of->start;
    of->def.uv_count = places;
    of->def.rest = of->rest;
    of->def.triangles = triangles;
    of->def.corners = of->corners;
    of->def.corner_uv = of->places;
    of->def.fabrics = of->fabrics;
    of->def.fabric_count = 1;
}

/* Where a test_mesh must not be copied after this: def points into it. rows x cols
 * vertices, `spacing` [m] apart along u (cols) and v (rows); inner vertices move by up
 * to `jitter` spacings. It starts flat in the plane z = 0, x = u, y = v. */
static inline void mesh_sheet(test_mesh *of, size_t rows, size_t cols, double spacing,
                              test_diagonals diagonals, double jitter, uint64_t seed)
{
    const size_t n = rows * cols, cells = (rows - 1) * (cols - 1);
    *of = (test_mesh){ .rows = rows, .cols = cols };
    of->start = malloc(3 * n * sizeof *of->start);
    of->rest = malloc(2 * n * sizeof *of->rest);
    of->corners = malloc(6 * cells * sizeof *of->corners);
    of->places = malloc(6 * cells * sizeof *of->places);
    of->fabrics[0] = mesh_fabric;
    for (size_t i = 0; i < n; ++i) {
        const size_t r = i / cols, c = i % cols;
        const bool inner = r > 0 && r + 1 < rows && c > 0 && c + 1 < cols;
        const double du = 2.0 * random_uniform(&seed) - 1.0,
                     dv = 2.0 * random_uniform(&seed) - 1.0;
        of->rest[2 * i] = spacing * ((double)c + (inner ? jitter * du : 0.0));
        of->rest[2 * i + 1] = spacing * ((double)r + (inner ? jitter * dv : 0.0));
        of->start[3 * i] = of->rest[2 * i];
        of->start[3 * i + 1] = of->rest[2 * i + 1];
        of->start[3 * i + 2] = 0.0;
    }
    for (size_t k = 0; k < cells; ++k) {
        const size_t r = k / (cols - 1), c = k % (cols - 1);
        const uint32_t a = (uint32_t)(r * cols + c), b = a + 1, d = a + (uint32_t)cols,
                       e = d + 1;
        const bool rising = diagonals == MESH_RIGHT ? true
                            : diagonals == MESH_ALTERNATING
                                ? (r + c) % 2 == 0
                                : random_uniform(&seed) < 0.5;
        const uint32_t up[6] = { a, b, e, a, e, d }, down[6] = { a, b, d, b, e, d };
        memcpy(&of->corners[6 * k], rising ? up : down, sizeof up);
    }
    memcpy(of->places, of->corners, 6 * cells * sizeof *of->places);
    mesh_point(of, n, n, 2 * cells);
}

/* Cuts a sheet along column `at` of its rest shape, for which vertices get a second
 * place, and moves what is right of it by du [m] and turns it by `angle`'s cosine c and
 * sine s: the same particles, sewn. */
static inline void mesh_sew(test_mesh *of, size_t at, double du, double c, double s)
{
    const size_t n = of->rows * of->cols, all = 2 * n;
    of->rest = realloc(of->rest, 2 * all * sizeof *of->rest);
    for (size_t i = 0; i < n; ++i) {
        const double u = of->rest[2 * i], v = of->rest[2 * i + 1];
        of->rest[2 * (n + i)] = c * u - s * v + du;
        of->rest[2 * (n + i) + 1] = s * u + c * v;
    }
    for (size_t k = 0; k < of->def.triangles; ++k) {
        bool right = false;
        for (size_t j = 0; j < 3; ++j) {
            right = right || of->corners[3 * k + j] % of->cols > at;
        }
        for (size_t j = 0; right && j < 3; ++j) {
            of->places[3 * k + j] += (uint32_t)n;
        }
    }
    const size_t triangles = of->def.triangles;
    mesh_point(of, n, all, triangles);
}

/* Renumbers vertices and triangles at random; to[i] is the new number of vertex i (to
 * NULL: not wanted). */
static inline void mesh_shuffle(test_mesh *of, uint64_t seed, uint32_t *to)
{
    const size_t n = of->def.vertices, t = of->def.triangles;
    uint32_t *number = malloc(n * sizeof *number);
    double *start = malloc(3 * n * sizeof *start);
    for (size_t i = 0; i < n; ++i) {
        const size_t j = (size_t)(random_uniform(&seed) * (double)(i + 1));
        number[i] = number[j];
        number[j] = (uint32_t)i;
    }
    for (size_t i = 0; i < n; ++i) {
        memcpy(&start[3 * (size_t)number[i]], &of->start[3 * i], 3 * sizeof *start);
    }
    memcpy(of->start, start, 3 * n * sizeof *start);
    for (size_t k = 0; k < 3 * t; ++k) {
        of->corners[k] = number[of->corners[k]];
    }
    for (size_t i = t; i-- > 1;) {
        const size_t j = (size_t)(random_uniform(&seed) * (double)(i + 1));
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t corner = of->corners[3 * i + k],
                           place = of->places[3 * i + k];
            of->corners[3 * i + k] = of->corners[3 * j + k];
            of->places[3 * i + k] = of->places[3 * j + k];
            of->corners[3 * j + k] = corner;
            of->places[3 * j + k] = place;
        }
    }
    if (to != NULL) {
        memcpy(to, number, n * sizeof *to);
    }
    free(number);
    free(start);
}

/* A definition of a cloth of it without gravity. */
static inline weft_cloth_def mesh_cloth(const test_mesh *of)
{
    weft_cloth_def def = weft_cloth_def_default();
    memset(def.gravity, 0, sizeof def.gravity);
    def.mesh = &of->def;
    return def;
}

/* Cloths that meet without loss, by Dormand and Prince for 0.03 s: none crosses
 * another, momentum and energy are kept. Returns the pairs in touch in ten states. */
static inline size_t touching_with_momentum_and_energy_kept(const weft_cloth *cloth)
{
    weft_error err = { 0 };
    weft_sim *sim;
    weft_sim_def run = weft_sim_def_default();
    run.cloth = cloth;
    run.method = test_method_named("arkode/dormand_prince");
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = 1e-8;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    const double energy
        = weft_energy_total(weft_cloth_energy(cloth, 0.0, weft_sim_state(sim)));
    double before[3], now[3];
    size_t touching = 0;
    weft_cloth_momentum(cloth, weft_sim_state(sim), before);
    for (int i = 1; i <= 10; ++i) {
        ck_assert_msg(weft_sim_advance(sim, 0.003 * i, &err) == WEFT_OK, "%s",
                      err.message);
        const double *y = weft_sim_state(sim);
        touching += weft_cloth_self_touching(cloth, y);
        ck_assert_uint_eq(weft_cloth_crossings(cloth, y, NULL), 0);
        weft_cloth_momentum(cloth, y, now);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(now[k], before[k], 1e-15);
        }
        const double total = weft_energy_total(weft_cloth_energy(cloth, 0.003 * i, y));
        ck_assert_double_eq_tol(total, energy, 3e-8 * energy);
    }
    weft_sim_destroy(sim);
    return touching;
}
