/* SPDX-License-Identifier: BSD-3-Clause */
/* spectrum.h -- what stabilised Runge-Kutta methods know of the modes of a cloth: how
 * far the stages must reach, and which steps no number of stages makes stable
 * (spectrum.c). Linked into plugins stiff and arkode.
 *
 * With damping tau times the stiffness, the eigenvalues mu that are not real lie on the
 * circle |mu + 1 / tau| = 1 / tau. With 5 stages or more, whatever their number, the
 * methods of Chebyshev's polynomials are stable there for h <= 2.2 tau, those of
 * Legendre's for h <= 2.5 tau.
 * Modes with h |mu| < 0.5 are slow enough for the error test. What follows is a bound
 * of h for each corner of the polygon that holds all modes; below a damping ratio of
 * 0.5 that is no longer than the step of an explicit method, and the method is refused.
 */
#pragma once

#include "weft/stepper.h"

enum { WEFT__STAGES_MOST = 500 };

#define WEFT__REACH 1.54 /* s^2 > 1 + REACH h radius: Sommeijer, Shampine, Verwer */

/* Of the authors' estimate, 0.8 (y - y_end) + 0.4 h (f + f_end): it is that of the
 * solution itself, so that the errors of all steps add up. */
#define WEFT__ESTIMATE_BIAS 5.0

typedef struct weft__spectrum {
    bool known;
    int age;       /* accepted steps since */
    double radius; /* [1/s] no eigenvalue is larger */
    double cap;    /* [s] no longer step is stable, whatever the stages */
} weft__spectrum;

/* What config->structure lacks for any method that needs it, or NULL. */
const char *weft__structure_mistake(const weft_ode *ode,
                                    const weft_stepper_config *config);

/* The same for a stabilised method; also if no mode can have half of critical damping.
 */
const char *weft__spectrum_mistake(const weft_ode *ode,
                                   const weft_stepper_config *config);

/* Before a step from (t, y): computes what is not known, or old. fixed_step 0: adaptive
 * steps. */
weft_status weft__spectrum_prepare(weft__spectrum *self, const char *name,
                                   const weft_structure *structure, double fixed_step,
                                   double t, const double *y, weft_error *err);

/* After a rejected attempt: what is not recent may be the reason. */
void weft__spectrum_doubt(weft__spectrum *self);
