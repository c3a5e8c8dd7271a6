/* SPDX-License-Identifier: BSD-3-Clause */
/* levels.h -- what is compiled for each level of instructions, as the kernels are. */
#pragma once

#include "../naive.h"
#include "../naive_mesh.h"
#include "base/isa.h"

typedef void naive_fn(const naive_cloth *cloth, const double *y, double *dydt);
typedef void naive_mesh_fn(const naive_mesh *of, const naive_vec *y, naive_vec *dydt);

/* One root and one division of each a[i] > 0, count a multiple of 8, into b. */
typedef void bound_fn(const double *a, double *b, size_t count);

#define LEVEL_FUNCTIONS(level)                                                         \
    naive_fn naive_##level;                                                            \
    naive_mesh_fn naive_mesh_##level;                                                  \
    bound_fn bound_##level;
WEFT_LEVELS(LEVEL_FUNCTIONS)
#undef LEVEL_FUNCTIONS
