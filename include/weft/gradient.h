/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/gradient.h -- the gradient of an objective, a sum over the frames of a run, by
 * many numbers of its definition and by its first state. */
#ifndef WEFT_GRADIENT_H
#define WEFT_GRADIENT_H

#include "weft/sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Adds what frame number `frame` at t [s] has of an objective, a function of y[6 N], to
 * *value, and its derivative by y to slope[6 N], which is 0 before: planes as the
 * state, per m and per m/s. Returns 0, or anything else to stop. */
typedef int weft_objective_fn(void *ctx, size_t frame, double t, const double *y,
                              double *value, double *slope);

typedef struct weft_gradient_def {
    uint32_t struct_size;
    const weft_sim_def *sim; /* without `sensitivity`, which is not looked at; explicit
                                one-step methods, in fixed or adaptive steps */
    size_t count;            /* of numbers; any */
    const weft_parameter *parameters;
    size_t frames;                /* of times, which ascend from 0 or above */
    const double *times;          /* [s] */
    weft_objective_fn *objective; /* of each frame, the last one first */
    void *ctx;
} weft_gradient_def;

/** Returns a definition without simulation, times and objective: set them.
 * @return the defaults, with struct_size set */
WEFT_DEFAULT(weft_gradient_def)

/* Runs a simulation to its last frame and goes back through its steps: *value is the
 * sum of the objective over all frames, by_parameter[count] its derivative by each
 * number [per unit of its span], by_start[6 N] (or NULL) that by the state at t = 0. It
 * is the derivative of the discrete map, with the steps of an adaptive method held, as
 * sensitivities are, at a cost that hardly depends on the number of springs' and
 * weight's numbers: some four runs, and for each other number up to two more. Memory:
 * some 3 sqrt(steps x stages) states. The simulation has the threads of its config;
 * what is transposed is computed on the calling one, which calls the objective. Source:
 * A. Griewank, A. Walther, Evaluating Derivatives, SIAM 2008, chapters 3 and 12.
 *
 * Errors: those of weft_sim_create and of a run; WEFT_INVALID, a definition with NULL,
 * times that do not ascend, numbers whose cloths differ in more; WEFT_UNSUPPORTED, what
 * sensitivities refuse, a method that is no sum of the rates of its stages;
 * WEFT_STOPPED, the objective; WEFT_NOT_FINITE. */
WEFT_API weft_status weft_gradient(const weft_gradient_def *def, double *value,
                                   double *by_parameter, double *by_start,
                                   weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
