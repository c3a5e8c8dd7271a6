/* SPDX-License-Identifier: BSD-3-Clause */
/* sheet.h -- a jittered sheet of triangles of 1 m, its vertices and triangles in rows
 * or in random order. */
#pragma once

#include <math.h>

#include "bench.h"
#include "weft/cloth.h"

static inline void *array(size_t count, size_t size)
{
    void *made = calloc(count, size);
    if (made == NULL) {
        fprintf(stderr, "no memory\n");
        exit(1);
    }
    return made;
}

static inline uint32_t below(uint32_t count) /* the same numbers in every run */
{
    static uint64_t state = 42;
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)((state >> 32) * count >> 32);
}

static inline void number_all(uint32_t *order, uint32_t count, bool shuffled)
{
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t j = shuffled ? below(i + 1) : i;
        order[i] = order[j];
        order[j] = i;
    }
}

typedef struct sheet {
    size_t side;
    double *start, *rest;
    uint32_t *corners;
} sheet;

/* Cuts each cell along its shorter diagonal. */
static inline void cut(sheet *of, const uint32_t *number, const uint32_t *turn)
{
    const size_t n = of->side;
    for (size_t cell = 0; cell < (n - 1) * (n - 1); ++cell) {
        const size_t at = cell / (n - 1) * n + cell % (n - 1);
        const uint32_t c[4]
            = { number[at], number[at + 1], number[at + n + 1], number[at + n] };
        const double *x[4];
        for (size_t k = 0; k < 4; ++k) {
            x[k] = &of->rest[2 * (size_t)c[k]];
        }
        const size_t from = hypot(x[0][0] - x[2][0], x[0][1] - x[2][1])
                                    < hypot(x[1][0] - x[3][0], x[1][1] - x[3][1])
                                ? 0
                                : 1;
        for (size_t t = 0; t < 2; ++t) {
            uint32_t *to = &of->corners[3 * (size_t)turn[2 * cell + t]];
            to[0] = c[from];
            to[1] = c[(from + 1 + t) % 4];
            to[2] = c[(from + 2 + t) % 4];
        }
    }
}

static inline sheet sheet_create(size_t n, bool shuffled)
{
    sheet of = { .side = n };
    const double h = 1.0 / (double)(n - 1);
    const uint32_t count = (uint32_t)(2 * (n - 1) * (n - 1));
    uint32_t *number = array(n * n, sizeof *number), *turn = array(count, sizeof *turn);
    of.start = array(3 * n * n, sizeof *of.start);
    of.rest = array(2 * n * n, sizeof *of.rest);
    of.corners = array(3 * (size_t)count, sizeof *of.corners);
    number_all(number, (uint32_t)(n * n), shuffled);
    number_all(turn, count, shuffled);
    for (size_t i = 0; i < n * n; ++i) {
        for (size_t k = 0; k < 2; ++k) {
            const size_t at = k == 0 ? i % n : i / n;
            const double jitter = at > 0 && at + 1 < n ? below(1001) / 2500.0 - 0.2 : 0;
            of.rest[2 * (size_t)number[i] + k] = of.start[3 * (size_t)number[i] + k]
                = ((double)at + jitter) * h;
        }
    }
    cut(&of, number, turn);
    free(number), free(turn);
    return of;
}

static inline void sheet_destroy(sheet *of)
{
    free(of->start), free(of->rest), free(of->corners);
}

/* Band `rank` of `size`; of 1: the whole. */
static inline weft_cloth *sheet_band(const sheet *of, double bend, size_t rank,
                                     size_t size)
{
    const weft_fabric fabric = { .density = 0.15,
                                 .stretch = { 500.0, 500.0 },
                                 .shear = 100.0,
                                 .bend = { bend, bend },
                                 .twist = bend,
                                 .damping = { 1e-5, 1e-5 },
                                 .coupling = 50.0 };
    weft_mesh_def mesh = weft_mesh_def_default();
    mesh.vertices = mesh.uv_count = of->side * of->side;
    mesh.triangles = 2 * (of->side - 1) * (of->side - 1);
    mesh.start = of->start, mesh.rest = of->rest, mesh.corners = of->corners;
    mesh.fabrics = &fabric, mesh.fabric_count = 1;
    weft_cloth_def def = weft_cloth_def_default();
    def.mesh = &mesh;
    def.damping = 1e-6;
    def.wind_velocity[0] = 3.0, def.wind_drag = 0.5;
    if (size > 1) {
        (void)weft_comm_band(weft_cloth_def_blocks(&def), rank, size, &def.band_first,
                             &def.band_rows);
    }
    weft_cloth *cloth;
    weft_error err;
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

static inline weft_cloth *sheet_cloth(const sheet *of, double bend)
{
    return sheet_band(of, bend, 0, 1);
}
