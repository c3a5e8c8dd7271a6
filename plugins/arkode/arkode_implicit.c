/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_implicit.c -- what ARKStep, for the diagonally implicit tables, is told beyond
 * what every method is: how it solves the equations of a stage. */
#include "arkode_plugin.h"

/* What Newton's method may leave, as part of the tolerance: ARKStep's default. */
#define CONVERGENCE 0.1

enum {
    ITERATIONS_FIXED = 50, /* of Newton's method, at most */
    MOST_FAILURES = 1000,  /* until min_step */
};

#if SUNV >= 701
#define IMPLICIT(name) ARKode##name
#else
#define IMPLICIT(name) ARKStep##name
#endif

static int linear_system(sunrealtype t, N_Vector y, N_Vector fy, SUNMatrix matrix,
                         SUNMatrix mass, int keep, int *fresh, sunrealtype gamma,
                         void *instance, N_Vector work1, N_Vector work2, N_Vector work3)
{
    arkode_stepper *self = instance;
    (void)fy, (void)matrix, (void)mass, (void)work1, (void)work2, (void)work3;
    return weft__sun_linearise(&self->equations, t, y, keep, fresh, gamma);
}

weft_status weft__ark_equations(arkode_stepper *self, const weft_stepper_config *config,
                                weft_error *err)
{
    return weft__sun_equations_create(&self->equations, self->y,
                                      weft__linear_residual(config), config, err);
}

/* The Jacobian is fresh in each step: an older one costs more steps that fail to
 * converge than it saves. */
bool weft__ark_set_newton(arkode_stepper *self)
{
    void *s = self->solver;
    sun_equations *of = &self->equations;
    of->current_gamma = IMPLICIT(GetCurrentGamma);
    of->owner = s;
    int bad = IMPLICIT(SetLinearSolver)(s, of->solver, of->matrix);
    bad |= IMPLICIT(SetLSetupFrequency)(s, 1);
    bad |= IMPLICIT(SetNonlinConvCoef)(s, CONVERGENCE);
    bad |= IMPLICIT(SetMaxConvFails)(s, MOST_FAILURES);
    bad |= IMPLICIT(SetDeduceImplicitRhs)(s, 1);
    if (self->fixed_step > 0.0) {
        bad |= IMPLICIT(SetMaxNonlinIters)(s, ITERATIONS_FIXED);
    }
    if (bad == 0 && of->linear != NULL) {
        bad |= IMPLICIT(SetLinSysFn)(s, linear_system);
        bad |= IMPLICIT(SetJacEvalFrequency)(s, 1);
        bad |= IMPLICIT(SetLinearSolutionScaling)(s, 0); /* gamma is the present one */
    } else if (bad == 0) {
        bad |= IMPLICIT(SetLSNormFactor)(s, 1.0); /* the 2-norm is above the largest */
    }
    return bad == 0;
}

long weft__ark_unsolved(const arkode_stepper *self)
{
    long count = 0;
    if (self->implicit) {
        (void)IMPLICIT(GetNumStepSolveFails)(self->solver, &count);
    }
    return count;
}

void weft__ark_tell_newton(const arkode_stepper *self, weft_option_fn *tell, void *ctx)
{
    weft__tell_number(tell, ctx, "convergence", CONVERGENCE);
    weft__sun_tell_equations(&self->equations, tell, ctx);
}
