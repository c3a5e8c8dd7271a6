/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_stabilised.c -- LSRKStep, which SUNDIALS has from 7.2 on: it takes as many
 * stages as the dominant eigenvalue asks for, but does not know that h must stay within
 * the circle of eigenvalues that damping makes (../stabilised/spectrum.h).
 *
 * It is told an eigenvalue on the negative real axis, where it wants one: a purely
 * imaginary one ends a run. It asks in every step; what it is told is computed before.
 */
#include "arkode_plugin.h"

#include <math.h>

#if SUNV >= 702

/* LSRKStep's number of Chebyshev stages, sqrt(REACH h radius), is unstable where that
 * is small: its authors have 1 + REACH h radius. */
static int dominant_eigenvalue(sunrealtype t, N_Vector y, N_Vector f, sunrealtype *real,
                               sunrealtype *imaginary, void *instance, N_Vector work1,
                               N_Vector work2, N_Vector work3)
{
    const arkode_stepper *self = instance;
    (void)t, (void)y, (void)f, (void)work1, (void)work2, (void)work3;
    *real = -(self->spectrum.radius + 1.0 / (WEFT__REACH * self->trial));
    *imaginary = 0.0;
    return 0;
}

/* Legendre's polynomials need 1.14 times as many stages for the same reach. */
bool weft__ark_make_stabilised(arkode_stepper *self)
{
    void *made = LSRKStepCreateSTS(weft__ark_rhs, 0.0, self->y, self->context);
    self->solver = made;
    return made != NULL
           && (LSRKStepSetSTSMethod(made, (ARKODE_LSRKMethodType)self->method->lsrk)
               | LSRKStepSetDomEigFn(made, dominant_eigenvalue)
               | LSRKStepSetDomEigFrequency(made, 1)
               | LSRKStepSetDomEigSafetyFactor(made, 1.0)
               | LSRKStepSetMaxNumStages(made, 2 * WEFT__STAGES_MOST))
                  == 0;
}

int weft__ark_restart_stabilised(arkode_stepper *self, double t)
{
    return LSRKStepReInitSTS(self->solver, weft__ark_rhs, t, self->y);
}

#else

bool weft__ark_make_stabilised(arkode_stepper *self)
{
    (void)self;
    return false;
}

int weft__ark_restart_stabilised(arkode_stepper *self, double t)
{
    (void)self, (void)t;
    return ARK_ILL_INPUT;
}

#endif

weft_status weft__ark_limit_step(arkode_stepper *self, double t, const double *y,
                                 weft_error *err)
{
    const char *name = self->method->type.name;
    if (!self->method->stabilised) {
        return WEFT_OK;
    }
    const weft_status status = weft__spectrum_prepare(
        &self->spectrum, name, self->structure, self->fixed_step, t, y, err);
    const double longest = fmin(self->max_step, self->spectrum.cap);
    if (status != WEFT_OK || self->fixed_step > 0.0 || longest == self->longest) {
        return status;
    }
    self->longest = longest;
    if (self->h > longest) {
        self->h = longest;
        self->own_h = true;
    }
    /* it refuses a min_step above, which each step sets again */
    return (ARK(SetMinStep)(self->solver, 0.0)
            | ARK(SetMaxStep)(self->solver, isinf(longest) ? 0.0 : longest))
                   == ARK_SUCCESS
               ? WEFT_OK
               : weft_error_set(err, WEFT_SOLVER, "%s: ARKODE refuses a step", name);
}
