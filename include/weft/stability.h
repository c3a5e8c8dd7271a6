/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/stability.h -- the largest stable step of a method on a cloth. */
#ifndef WEFT_STABILITY_H
#define WEFT_STABILITY_H

#include "weft/cloth.h"
#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The highest degree of a polynomial in weft_stability. */
enum { WEFT_STABILITY_DEGREE = 47 };

/* The effect of a method on modes x'' + c x' + w2 x = 0 in fixed steps, found by
 * running it. This works for every method of any plugin that is explicit and one-step.
 * Fixed for ever. */
typedef struct weft_stability {
    const weft_stepper_type *type;
    const weft_butcher *butcher;
    double calls; /* rhs_calls per step; 0: weft_stability_calls */
    int degree;   /* of r; -1: not a Runge-Kutta method, and r is not set */
    double r[WEFT_STABILITY_DEGREE + 1]; /* R(z) = sum r[k] z^k: y1 = R(h A) y0 */
} weft_stability;

/** Finds how a method acts on linear modes, by running it. This works for every
 * explicit one-step method of any plugin.
 * @param type the method; must outlive *out
 * @param butcher as in weft_stepper_config: NULL for a method that takes none; must
 *   outlive *out
 * @param[out] out filled; it needs no destruction
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_UNSUPPORTED (the method is implicit or multistep),
 *   WEFT_BAD_PLUGIN, WEFT_NO_MEMORY, and what creating the integrator returns
 * @par Example
 * @snippet adaptive.c stable step */
WEFT_API weft_status weft_stability_create(const weft_stepper_type *type,
                                           const weft_butcher *butcher,
                                           weft_stability *out, weft_error *err);

/** Computes the stability limit: the largest h up to which no mode in a polygon grows.
 *
 * With growth 0 the criterion is strict: |R(h mu)| <= 1 for the roots of mu^2 + c mu +
 * w2 = 0. Methods of Runge-Kutta type with |R(i y)| > 1 for small y then have no stable
 * step on undamped modes. A growth > 0 allows only these to grow: an oscillating mode
 * of damping rate c / 2 < growth by at most exp((growth - c / 2) h) per step, and to at
 * most twice its size. With growth = log(2) / T none more than doubles in T seconds.
 * Modes that do not oscillate, on the real axis, and modes damped at a rate of growth
 * or more must satisfy |R| <= 1. Other methods ignore growth. A method with
 * WEFT_STEPPER_STRUCTURE is asked for its largest fixed step.
 * @param stability of weft_stability_create
 * @param modes the polygon, as weft_cloth_stiffness returns it
 * @param growth [1/s] >= 0
 * @param[out] h [s]; INFINITY if no mode ever grows, 0 if the modes are not finite
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_NO_MEMORY, WEFT_UNSUPPORTED (the method refuses such a cloth)
 * @par Example
 * @snippet adaptive.c stable step */
WEFT_API weft_status weft_stability_step(const weft_stability *stability,
                                         const weft_stiffness *modes, double growth,
                                         double *h, weft_error *err);

/** Decides whether weft_stability_step finds at least h. For methods that are not of
 * Runge-Kutta type this takes a fraction of its time.
 * @param stability of weft_stability_create
 * @param modes the polygon, as weft_cloth_stiffness returns it
 * @param growth [1/s] >= 0, as of weft_stability_step
 * @param h [s] > 0
 * @param[out] reaches the answer
 * @param[out] err may be NULL
 * @return as weft_stability_step: WEFT_OK; WEFT_NO_MEMORY, WEFT_UNSUPPORTED */
WEFT_API weft_status weft_stability_reaches(const weft_stability *stability,
                                            const weft_stiffness *modes, double growth,
                                            double h, bool *reaches, weft_error *err);

/** Computes how often a step of h evaluates the right-hand side: weft_stability.calls,
 * but for a method with WEFT_STEPPER_STRUCTURE, which takes as many as h and the modes
 * need.
 * @param stability of weft_stability_create
 * @param modes the polygon, as weft_cloth_stiffness returns it
 * @param h [s] > 0
 * @param[out] calls per step
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_NO_MEMORY, WEFT_UNSUPPORTED */
WEFT_API weft_status weft_stability_calls(const weft_stability *stability,
                                          const weft_stiffness *modes, double h,
                                          double *calls, weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
