/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_rhs.c -- the right-hand side as GSL calls it. */
#include "gsl_plugin.h"

#include <gsl/gsl_errno.h>
#include <math.h>

bool weft__gsl_finite(const double *y, size_t count)
{
    while (count > 0 && isfinite(y[count - 1])) {
        --count;
    }
    return count == 0;
}

/* Where equations are iterated, NaN in a derivative shows as no convergence only, or
 * stays in the history: it is looked for at once. Elsewhere it reaches y or yerr, but
 * for that of a quadrature in a stage without weight. */
static bool iterates(const gsl_stepper *self)
{
    const uint32_t flags = self->method->type.flags;
    return (flags & (WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_MULTISTEP)) != 0;
}

/* GSL's RHS around the user's. It records the outcome, because GSL's methods replace
 * the code by their own. */
int weft__gsl_rhs(double t, const double y[], double dydt[], void *instance)
{
    gsl_stepper *self = instance;
    ++self->stats.rhs_calls;
    const int failed = self->ode.rhs(t, y, dydt, self->ode.ctx);
    if (failed < 0) {
        self->trouble = STOPPED;
        return GSL_EBADFUNC; /* "give up", where the others mean "try a smaller h" */
    }
    const size_t shown = iterates(self) ? 0 : 2 * self->half;
    if (failed > 0 || !weft__gsl_finite(dydt + shown, self->ode.dim - shown)) {
        self->trouble = NOT_FINITE;
        return GSL_ERANGE;
    }
    return GSL_SUCCESS;
}
