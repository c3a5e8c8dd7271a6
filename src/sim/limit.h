/* SPDX-License-Identifier: BSD-3-Clause */
/* limit.h -- the strain limit as a correction after an accepted step. */
#ifndef WEFT_SIM_LIMIT_H
#define WEFT_SIM_LIMIT_H

#include "cloth/limit_springs.h"
#include "weft/sim.h"

typedef struct weft__limit weft__limit;

/* *out is NULL where the definition has no method. */
weft_status weft__limit_create(const weft_limit_def *def, const weft_cloth *cloth,
                               const weft_allocator *memory, weft__limit **out,
                               weft_error *err);
void weft__limit_destroy(weft__limit *limit); /* NULL is allowed */

/* Corrects y[6 N] after a step of size h [s]; whether it changed anything. */
bool weft__limit_apply(weft__limit *limit, double h, double *y);

/* NULL is allowed: all 0. */
weft_limit_stats weft__limit_stats(const weft__limit *limit);

/* What it carries from step to step: the size of the last one [s], and the counts. */
double weft__limit_last_step(const weft__limit *limit); /* NULL is allowed: 0 */
void weft__limit_resume(weft__limit *limit, double last_step, weft_limit_stats stats);

const weft__limited *weft__limit_springs(const weft__limit *limit);

#endif
