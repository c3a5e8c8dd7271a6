/* SPDX-License-Identifier: GPL-3.0-or-later */
/* control.c -- when a step is accurate enough, and how long the next one may be.
 *
 * With the error estimate e_i of a step and
 *
 *     D_i = atol_i + rtol |y_i|,   atol_i of positions or of velocities,
 *
 * GSL's scaled control looks at r = max_i |e_i| / D_i: it rejects a step of r > 1.1 and
 * lengthens the next one where r < 0.5. That is WEFT_NORM_MAX, as it is. For
 * WEFT_NORM_RMS a control of our own computes
 *
 *     r = sqrt(1/n sum_i (e_i / D_i)^2)
 *
 * and has a control of GSL's judge this one number, with D = 1; so both norms decide by
 * the same rule. The scaled kind judges here too: the standard kind may lengthen h by
 * exactly 5, where msbdf divides by zero (GSL bug 52336). */
#include "gsl_plugin.h"

#include <gsl/gsl_errno.h>
#include <math.h>

static double tolerance(const rms_control *rms, size_t i, double y)
{
    return rms->atol[i < rms->dim / 2 ? 0 : 1] + rms->rtol * fabs(y);
}

static int rms_hadjust(void *state, size_t dim, unsigned int order, const double y[],
                       const double yerr[], const double yp[], double *h)
{
    const rms_control *rms = state;
    double sum = 0.0;
    for (size_t i = 0; i < dim; ++i) {
        const double ratio = yerr[i] / tolerance(rms, i, y[i]);
        sum += ratio * ratio;
    }
    const double r = sqrt(sum / (double)dim), zero = 0.0;
    (void)yp; /* a_dydt is 0 */
    return rms->judge->type->hadjust(rms->judge->state, 1, order, &zero, &r, &zero, h);
}

/* Implicit and multistep methods solve their equations to this accuracy. */
static int rms_errlevel(void *state, const double y, const double dydt, const double h,
                        const size_t i, double *level)
{
    (void)dydt;
    (void)h;
    *level = tolerance(state, i, y);
    return GSL_SUCCESS;
}

static const gsl_odeiv2_control_type rms_type = {
    .name = "rms",
    .hadjust = rms_hadjust,
    .errlevel = rms_errlevel,
};

bool weft__gsl_control_init(stepper *self, weft_norm norm, double rtol,
                            double atol_position, double atol_velocity)
{
    const size_t dim = self->ode.dim;
    if (norm == WEFT_NORM_MAX) {
        double *scale = self->y;
        for (size_t i = 0; i < dim; ++i) {
            scale[i] = i < dim / 2 ? atol_position : atol_velocity;
        }
        self->scaled = gsl_odeiv2_control_scaled_new(1.0, rtol, 1.0, 0.0, scale, dim);
        self->control = self->scaled;
        return self->scaled != NULL;
    }
    const double one = 1.0;
    self->rms = (rms_control){
        .base = { .type = &rms_type, .state = &self->rms },
        .judge = gsl_odeiv2_control_scaled_new(1.0, 0.0, 1.0, 0.0, &one, 1),
        .dim = dim,
        .rtol = rtol,
        .atol = { atol_position, atol_velocity },
    };
    self->control = &self->rms.base;
    return self->rms.judge != NULL;
}

void weft__gsl_control_free(stepper *self)
{
    gsl_odeiv2_control_free(self->scaled); /* NULL is allowed */
    gsl_odeiv2_control_free(self->rms.judge);
}

/* GSL's rule has no knobs; these are its constants (cstd.c). */
void weft__gsl_options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const stepper *self = instance;
    if (self->fixed_step == 0.0) {
        tell(ctx, "controller", "gsl_scaled");
        tell(ctx, "safety", "0.9");
        tell(ctx, "reject_above", "1.1");
        tell(ctx, "grow_below", "0.5");
        tell(ctx, "max_growth", "4.9");
        tell(ctx, "min_reduction", "0.2");
    }
}
