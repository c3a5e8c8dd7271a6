/* SPDX-License-Identifier: BSD-3-Clause */
/* forces.h -- the equations of motion on the threads of a simulation, each a range of
 * blocks: the same bits as on one. */
#pragma once

#include "cloth/model.h"
#include "sim/exchange.h"

typedef struct weft__forces {
    const weft_cloth *cloth;
    weft__pool *pool; /* NULL: one thread */
    size_t spans;
    void *spaces[WEFT__FORCES]; /* workspaces of whole-cloth forces; NULL: none */
    weft__range_stiffness
        *range_stiffness;    /* of each particle, where pairs of primitives push */
    weft_measures *measures; /* of each own block; NULL: no memory */
    const weft_comm *comm;   /* NULL: the cloth is whole */
    weft_measures *all;      /* band 0: of all blocks of the whole cloth */
    weft__exchange exchange;
    weft_allocator memory;
    double piece; /* [s] of tables and keys: that of the step under way (mesh/track.h);
                     NAN: none is, and that of the time counts */
} weft__forces;

/* A state at t, in the piece of the step under way. */
static inline weft__state weft__forces_state(const weft__forces *forces, double t,
                                             const double *y)
{
    return (weft__state){ .t = t,
                          .y = y,
                          .piece = isnan(forces->piece) ? NULL : &forces->piece };
}

/* Uses at most `threads`, fewer for a small cloth. given NULL: malloc's. */
weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given);
void weft__forces_destroy(weft__forces *forces);

/* Calls task(ctx, first, end) for ranges of blocks [first, end) that make up the
 * own ones, on any thread and in any order. */
typedef void weft__span_fn(void *ctx, size_t first, size_t end);
void weft__forces_spans(const weft__forces *forces, weft__span_fn *task, void *ctx);

/* With the other bands, with a comm, to the end of the file. As weft_cloth_rhs. */
int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt);

/* Measures each block of the whole cloth by `of` and adds them in their order; springs
 * and particles have their numbers in the whole. */
weft_measures weft__forces_measure(const weft__forces *forces, const weft__state *at,
                                   weft__measure_fn *of);
