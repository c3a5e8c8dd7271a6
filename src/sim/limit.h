/* SPDX-License-Identifier: BSD-3-Clause */
/* limit.h -- the strain limit as a correction after an accepted step. */
#pragma once

#include "weft/sim.h"

typedef struct weft__limit {
    weft_limit_def def; /* without a method it has no families */
    const weft_cloth *cloth;
    weft_limit_stats stats;
    double last_step; /* [s] */
    bool solved;      /* within its sweeps, after the last step */
    size_t count;     /* 3 N */
    double *x;        /* positions under correction */
    double *previous; /* fast: x_k */
    double *start;    /* fast: z, that the last sweep started from */
    double t, most;   /* fast: t_k and its bound */
    double least2;    /* fast: the smallest squared movement of a sweep */
} weft__limit;

/* All 0 where the definition has no method. */
weft_status weft__limit_init(weft__limit *limit, const weft_limit_def *def,
                             const weft_cloth *cloth, const weft_allocator *memory,
                             weft_error *err);

/* Corrects the state after a step of h [s], reports what is left beyond its bound once;
 * whether it changed anything. */
bool weft__sim_limit(weft_sim *sim, double h);
