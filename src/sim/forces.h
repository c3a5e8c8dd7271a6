/* SPDX-License-Identifier: BSD-3-Clause */
/* forces.h -- the equations of motion on the threads of a simulation, each a band of
 * rows: the same bits as on one. */
#ifndef WEFT_SIM_FORCES_H
#define WEFT_SIM_FORCES_H

#include "cloth/rows.h"
#include "sim/self_list.h"

typedef struct weft__forces {
    const weft_cloth *cloth;
    weft__team *team; /* NULL: one thread */
    size_t bands;
    weft__self_list *self;   /* NULL: none */
    weft_measures *measures; /* of each row; NULL: no memory */
    weft_allocator memory;
} weft__forces;

/* Uses at most `threads`, fewer for a small cloth. given NULL: malloc's. */
weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given);
void weft__forces_destroy(weft__forces *forces);

/* Calls task(ctx, first, end) for bands of rows [first, end) that make up the cloth, on
 * any thread and in any order. */
typedef void weft__band_fn(void *ctx, size_t first, size_t end);
void weft__forces_bands(const weft__forces *forces, weft__band_fn *task, void *ctx);

/* As weft_cloth_rhs. */
int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt);

/* Measures each row of a state by `row` and adds them in their order. */
weft_measures weft__forces_measure(const weft__forces *forces, const weft__subject *of,
                                   weft__row_fn *row);

#endif
