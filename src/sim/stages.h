/* SPDX-License-Identifier: BSD-3-Clause */
/* stages.h -- an explicit one-step method as the sums that it takes of its rates. */
#pragma once

#include "weft/sim.h"

enum { WEFT__STAGES = 32 }; /* calls of the right-hand side in a step, at most */

/* What a state has of a rate, by h: a free particle, whose x' is v, of its acceleration
 * a; a prescribed one of x' = p and v' = q. */
typedef struct weft__share {
    double xa, va; /* of h^2 a in x, h a in v */
    double xp, xq; /* of h p and h^2 q in x */
    double vq;     /* of h q in v */
} weft__share;

/* State k of a step, 1 to count, is that of its call k, and count + 1 its end:
 *
 *     x_k = x + c_k h v + h^2 sum xa_kj a_j,   v_k = v + h sum va_kj a_j,   j < k
 *
 * Rate 0 is the last one of the step before, if `carries`; of a first step, or after a
 * change of the state, that of its start. */
typedef struct weft__stages {
    size_t count;
    bool carries;
    bool needed[WEFT__STAGES + 2]; /* by the end, or by the next step */
    double c[WEFT__STAGES + 2];    /* also their times, by h */
    weft__share share[WEFT__STAGES + 2][WEFT__STAGES + 1];
} weft__stages;

/* Finds them by two steps of a model whose rates are unit vectors. Errors:
 * WEFT_UNSUPPORTED, a method that is no such sum; those of its `create`. */
weft_status weft__stages_find(const weft_stepper_type *method,
                              const weft_stepper_config *config, weft__stages *out,
                              weft_error *err);
