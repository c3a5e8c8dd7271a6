/* SPDX-License-Identifier: BSD-3-Clause */
#include "levels.h"

#include "forces/lanes.h"

#define BENCH_NAME_(stem, level) stem##_##level
#define BENCH_NAME(stem, level)  BENCH_NAME_(stem, level)

void BENCH_NAME(naive, LEVEL)(const naive_cloth *cloth, const double *y, double *dydt)
{
    naive_rhs(cloth, y, dydt);
}

void BENCH_NAME(naive_mesh, LEVEL)(const naive_mesh *of, const naive_vec *y,
                                   naive_vec *dydt)
{
    naive_mesh_rhs(of, y, dydt);
}

void BENCH_NAME(bound, LEVEL)(const double *a, double *b, size_t count)
{
    for (size_t i = 0; i < count; i += LANES) {
        const vec length = root(load(a + i));
        store(b + i, length / load(a + i));
    }
}
