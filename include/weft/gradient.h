/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/gradient.h -- the gradient of an objective, a sum over the frames of a run, by
 * many parameters of its definition and by its first state. */
#ifndef WEFT_GRADIENT_H
#define WEFT_GRADIENT_H

#include "weft/sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Adds what frame number `frame` at t [s] has of an objective, a function of y[6 N], to
 * *value, and its derivative with respect to y to slope[6 N], which is 0 before: planes
 * as the state, per m and per m/s. Returns 0, or anything else to stop. */
typedef int weft_objective_fn(void *ctx, size_t frame, double t, const double *y,
                              double *value, double *slope);

/* What weft_gradient computes. */
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

/** Computes the gradient of an objective, a sum over the frames of a run, with respect
 * to parameters and to the state at t = 0. Runs a simulation to its last frame and goes
 * back through its steps. It is the derivative of the discrete map, with the steps of
 * an adaptive method held, as sensitivities are. Source: A. Griewank, A. Walther,
 * Evaluating Derivatives, SIAM 2008, chapters 3 and 12.
 *
 * It costs some four runs, whatever the number of parameters of springs and weight, and
 * for each other parameter up to two more; memory for some 3 sqrt(steps x stages)
 * states. The simulation has the threads of its configuration; transposed products, and
 * the objective, are computed in the calling thread.
 * @param def the simulation, parameters, times and objective
 * @param[out] value the sum of the objective over all frames
 * @param[out] by_parameter its derivative with respect to each parameter, per unit of
 *   the parameter's span: count doubles
 * @param[out] by_start its derivative with respect to the state at t = 0 [per m], [per
 *   m/s]: 6 N doubles, planes as a state; may be NULL
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (a definition has NULL, times do not ascend, the cloths
 *   of a parameter differ in more), WEFT_UNSUPPORTED (what sensitivities refuse; a
 *   method that is no sum of the rates of its stages), WEFT_STOPPED (by the objective),
 *   WEFT_NOT_FINITE, WEFT_NO_MEMORY, and what weft_sim_create and weft_sim_step return
 * @par Example
 * @snippet derivative.c gradient */
WEFT_API weft_status weft_gradient(const weft_gradient_def *def, double *value,
                                   double *by_parameter, double *by_start,
                                   weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
