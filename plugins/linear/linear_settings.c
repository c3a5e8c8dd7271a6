/* SPDX-License-Identifier: BSD-3-Clause */
/* linear_settings.c -- config->linear of an implicit method: checked, completed,
 * reported. */
#include "linear.h"

#include <math.h>
#include <stdlib.h>

/* 0 stands for the default, NaN for nothing. */
const char *weft__linear_mistake(const weft_stepper_config *config)
{
    const weft_linear *c = weft_stepper_linear(config);
    return c == NULL                                ? NULL
           : !(c->krylov >= 0.0 && c->krylov < 1.0) ? "krylov must be > 0 and < 1"
           : (int)c->preconditioner < WEFT_PRECONDITIONER_AUTO
                   || c->preconditioner > WEFT_PRECONDITIONER_MULTIGRID
               ? "unknown preconditioner"
           : (int)c->jacobian < WEFT_JACOBIAN_DEFAULT
                   || c->jacobian > WEFT_JACOBIAN_NEWTON
               ? "unknown jacobian"
               : NULL;
}

double weft__linear_residual(const weft_stepper_config *config)
{
    const double least = fmin(config->atol_position, config->atol_velocity);
    const double tolerance = config->rtol > 0.0 ? fmin(least, config->rtol) : least;
    return !(config->fixed_step > 0.0) && tolerance < 1e-5 ? 1e-4 : 1e-3;
}

weft_linear weft__linear_settings(const weft_stepper_config *config, double krylov)
{
    const weft_linear *asked = weft_stepper_linear(config);
    weft_linear out = { .struct_size = sizeof out };
    if (asked != NULL) {
        out = *asked;
    }
    out.krylov = out.krylov > 0.0 ? out.krylov : krylov;
    out.jacobian
        = out.jacobian == WEFT_JACOBIAN_DEFAULT ? WEFT_JACOBIAN_STEP : out.jacobian;
    return out;
}

void weft__linear_tell(const weft_linear *settings, weft_option_fn *tell, void *ctx)
{
    static const char *const preconditioners[] = { "auto", "jacobi", "multigrid" };
    weft__tell_number(tell, ctx, "krylov", settings->krylov);
    tell(ctx, "preconditioner", preconditioners[settings->preconditioner]);
    tell(ctx, "jacobian",
         settings->jacobian == WEFT_JACOBIAN_NEWTON ? "newton" : "step");
}

void weft__tell_number(weft_option_fn *tell, void *ctx, const char *name, double value)
{
    char text[32];
    int digits = 15;
    do {
        (void)weft_text_format(text, sizeof text, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    tell(ctx, name, text);
}
