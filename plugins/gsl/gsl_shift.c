/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_shift.c -- for a stepper that measures changes against |y_i| at the start of a
 * step: it integrates z = y + o with o_i = 1 or -1, the sign of y_i, so that |z_i|
 * >= 1. The solution is the same; a component that stays keeps its bits. */
#include "gsl_plugin.h"

#include <math.h>

/* y, the start of an attempt, becomes z. */
void weft__gsl_shift(gsl_stepper *self, double *y)
{
    for (size_t i = 0; i < self->ode.dim; ++i) {
        self->offset[i] = copysign(1.0, y[i]);
        y[i] = y[i] + self->offset[i];
    }
}

/* z becomes y again. */
void weft__gsl_unshift(gsl_stepper *self, double *y)
{
    const double *start = self->start;
    for (size_t i = 0; i < self->ode.dim; ++i) {
        y[i] = start[i] + (y[i] - (start[i] + self->offset[i]));
    }
}

static const double *plain(gsl_stepper *self, const double z[])
{
    for (size_t i = 0; i < self->ode.dim; ++i) {
        self->plain[i] = z[i] - self->offset[i];
    }
    return self->plain;
}

int weft__gsl_shifted_rhs(double t, const double y[], double dydt[], void *instance)
{
    return weft__gsl_rhs(t, plain(instance, y), dydt, instance);
}

int weft__gsl_shifted_jacobian(double t, const double y[], double *dfdy, double dfdt[],
                               void *instance)
{
    return weft__gsl_jacobian(t, plain(instance, y), dfdy, dfdt, instance);
}
