/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/pass.h -- a step in one pass over the state, for plugins that say their table or
 * give their loops: weft_stepper_config.pass. Part of weft/stepper.h. */
#ifndef WEFT_PASS_H
#define WEFT_PASS_H

#include "weft/base.h"

/* An attempt of a step of an explicit Runge-Kutta method. With z_0 = y and k_0 its
 * rates
 *
 *     z_i = a_i0 k_0 + ... + a_i,i-1 k_i-1 + y,   k_i = f(t_i, z_i),   0 < i < stages,
 *     error = e_0 k_0 + e_1 k_1 + ...
 *
 * Sums are taken from left to right; terms whose factor is 0 are left out. A solution
 * that is not the argument of the last stage is a stage of its own, without rates. */
typedef struct weft_attempt {
    uint32_t struct_size;
    int stages;
    const double *a; /* [s] a_10, a_20, a_21, a_30, ...: those of the table times h */
    const double *e; /* [s] stages; NULL: the error is not wanted */
    const double *t; /* [s] stages */
    const double *y, *k;  /* the state and k_0 */
    double *y_end;        /* receives the last z; may not be y, nor k_end k */
    double *k_end;        /* receives the last k; NULL: it is not wanted */
    double rtol, atol[2]; /* as in the config */
    double norm;          /* out: the largest |error_j (1 / (rtol |y_j| + atol))| */
    double most[2];       /* out: the largest |y_end|, of positions and of velocities */
    int calls;            /* out: the evaluations that count as rhs_calls */
} weft_attempt;

/* Does something with the positions [first, end) of a state and with their velocities,
 * which lie half a state behind. */
typedef size_t weft_part(void *ctx, size_t first, size_t end);

/* An evaluation, and what a method does before and after it: `before` makes y, part by
 * part; when their rates are in f, `after` may use them and change y there. Parts are
 * taken on any thread and in any order. */
typedef struct weft_round {
    uint32_t struct_size;
    double t; /* [s] */
    const double *y;
    double *f; /* receives the rates; NULL: no evaluation, only `before` */
    void *ctx;
    weft_part *before; /* NULL: y is there */
    weft_part *after;
    size_t sum; /* out: of what the parts returned */
} weft_round;

/* Makes attempts in one pass over the state, with the bits of the sums and of calls of
 * rhs one after the other: a large state is then read once per step, not once per
 * stage.
 *
 * run returns 0; < 0 to end the run, as rhs does; or > 0: the pass is not to be had
 * now, or something in it is not finite. Then the plugin makes the attempt by rhs,
 * which finds out what it is. y and k stay as they are. It is called in the thread that
 * calls step, and allocates nothing. round does and returns the same for one evaluation
 * amid a method's own arithmetic, as in velocity Verlet; it counts as one of rhs_calls,
 * and not where it returns > 0. A method of one call a step has only round. */
typedef struct weft_pass {
    void *self;
    int stages; /* at most, of run */
    int (*run)(void *self, weft_attempt *attempt);
    int (*round)(void *self, weft_round *round);
} weft_pass;

#endif
