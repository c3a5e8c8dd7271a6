/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_control.c -- how h is adapted: ARKODE calls the laws of its own controllers,
 * written out here, and gets every other knob from us. ARKODE's laws take libm's pow,
 * whose bits differ between machines. The other settings are the defaults of ERKStep
 * until 7.2, which 7.3 changed. */
#include "arkode_plugin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Gains as in ARKODE's manual (6.4, "Time step adaptivity"). */
static const struct {
    weft_controller_type type;
    double gains[3];
} laws[] = {
    { WEFT_CONTROLLER_PID, { 0.58, 0.21, 0.1 } },
    { WEFT_CONTROLLER_PI, { 0.8, 0.31, 0.0 } },
    { WEFT_CONTROLLER_I, { 1.0, 0.0, 0.0 } },
    { WEFT_CONTROLLER_EXPLICIT_GUSTAFSSON, { 0.367, 0.268, 0.0 } },
    { WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON, { 0.98, 0.95, 0.0 } },
    { WEFT_CONTROLLER_IMEX_GUSTAFSSON, { 0.367, 0.268, 0.95 } },
};

#define LAWS (sizeof laws / sizeof laws[0])

static const weft_controller defaults = {
    .type = WEFT_CONTROLLER_PI,
    .safety = 0.96,
    .bias = 1.2,
    .max_growth = 25.0,
    .first_growth = 1e4,
    .min_reduction = 0.1,
    .failed_growth = 0.3,
};

/* h is kept where it would change by a factor between these. */
static const double keep_above = 1.0, keep_below = 1.5;

static const char *const names[] = { "default",
#define NAME(label, name, gains) #name,
                                     WEFT_CONTROLLERS(NAME)
#undef NAME
};

static const int gain_counts[] = { 0,
#define COUNT(label, name, gains) gains,
                                   WEFT_CONTROLLERS(COUNT)
#undef COUNT
};

static size_t law_of(weft_controller_type type)
{
    size_t i = 0;
    while (i < LAWS && laws[i].type != type) {
        ++i;
    }
    return i;
}

/* 0 stands for the default, NaN for nothing. */
static bool within(double value, double above, double below)
{
    return value == 0.0 || (value > above && value < below);
}

const char *weft__ark_control_mistake(const weft_controller *c)
{
    if (c->type != WEFT_CONTROLLER_DEFAULT && law_of(c->type) == LAWS) {
        return "unknown type of controller";
    }
    const weft_controller_type type
        = c->type == WEFT_CONTROLLER_DEFAULT ? defaults.type : c->type;
    if (c->gain_count != 0 && c->gain_count != gain_counts[type]) {
        return "the controller takes another number of gains";
    }
    for (int i = 0; i < c->gain_count; ++i) {
        if (!isfinite(c->gains[i])) {
            return "gains of the controller must be finite";
        }
    }
    return !within(c->safety, 0.0, nextafter(1.0, 2.0)) ? "safety must be > 0 and <= 1"
           : !within(c->bias, nextafter(1.0, 0.0), INFINITY) ? "bias must be >= 1"
           : !within(c->max_growth, 1.0, INFINITY)           ? "max_growth must be > 1"
           : !within(c->first_growth, 1.0, INFINITY) ? "first_growth must be > 1"
           : !within(c->min_reduction, 0.0, 1.0) ? "min_reduction must be > 0 and < 1"
           : !within(c->failed_growth, 0.0, 1.0) ? "failed_growth must be > 0 and < 1"
                                                 : NULL;
}

static double chosen(double value, double fallback)
{
    return value == 0.0 ? fallback : value;
}

weft_controller weft__ark_control(const ark_method *method,
                                  const weft_controller *asked)
{
    weft_controller c = { 0 };
    if (asked != NULL) {
        c = *asked;
    }
    c.type = c.type == WEFT_CONTROLLER_DEFAULT ? defaults.type : c.type;
    if (c.gain_count == 0) {
        c.gain_count = gain_counts[c.type];
        memcpy(c.gains, laws[law_of(c.type)].gains, sizeof c.gains);
    }
    c.safety = chosen(c.safety, defaults.safety);
    c.bias = chosen(c.bias, method->stabilised ? WEFT__ESTIMATE_BIAS : defaults.bias);
    c.max_growth = chosen(c.max_growth, defaults.max_growth);
    c.first_growth = chosen(c.first_growth, defaults.first_growth);
    c.min_reduction = chosen(c.min_reduction, defaults.min_reduction);
    c.failed_growth = chosen(c.failed_growth, defaults.failed_growth);
    return c;
}

static double gustafsson(double e1, double e2, double k1, double k2)
{
    return weft_pow(e1, -k1) * weft_pow(e1 / e2, -k2);
}

/* The next h after a step of h by ARKODE's laws (manual of 6.4, "Time step
 * adaptivity"): p is the embedded order, e1 the biased error of the step, e2 and e3 are
 * those of the accepted steps before it. Without a step before, 6.4 and 7.1 take other
 * Gustafsson laws: these are 7.1's. */
static double next_h(const weft_controller *c, int p, double h, double e,
                     const ark_past *past)
{
    const double least = 1e-10; /* ARKODE's */
    const double e1 = fmax(e, least), e2 = fmax(past->e[0], least);
    const double k1 = c->gains[0] / p, k2 = c->gains[1] / p, k3 = c->gains[2] / p;
    const bool first = past->h[0] == 0.0;
    const double ratio = first ? 1.0 : h / past->h[0];
    switch (c->type) {
    case WEFT_CONTROLLER_PID:
        return h * weft_pow(e1, -k1) * weft_pow(e2, k2)
               * weft_pow(fmax(past->e[1], least), -k3);
    case WEFT_CONTROLLER_I:
        return h * weft_pow(e1, -k1);
    case WEFT_CONTROLLER_EXPLICIT_GUSTAFSSON:
        return h * gustafsson(e1, e2, k1, k2);
    case WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON:
        return h * ratio * gustafsson(e1, e2, k1, k2);
    case WEFT_CONTROLLER_IMEX_GUSTAFSSON:
        return first ? h * weft_pow(e1, -1.0 / p)
                     : h
                           * fmin(ratio * gustafsson(e1, e2, k3, k3),
                                  gustafsson(e1, e2, k1, k2));
    default:
        return h * weft_pow(e1, -k1) * weft_pow(e2, k2);
    }
}

/* How ARKODE gets that law: a function until 6.6, an object from 6.7 on. */
#if SUNV >= 607
static SUNAdaptController_Type law_type(SUNAdaptController controller)
{
    (void)controller;
    return SUN_ADAPTCONTROLLER_H;
}

static int law_estimate(SUNAdaptController controller, sunrealtype h, int p,
                        sunrealtype error, sunrealtype *next)
{
    const arkode_stepper *self = controller->content;
    const weft_controller *c = &self->control;
    *next = next_h(c, p + 1, h, c->bias * error, &self->past);
    return 0;
}

static int law_reset(SUNAdaptController controller)
{
    arkode_stepper *self = controller->content;
    self->past = (ark_past){ .e = { 1.0, 1.0 } };
    return 0;
}

static int law_accepted(SUNAdaptController controller, sunrealtype h, sunrealtype error)
{
    arkode_stepper *self = controller->content;
    const ark_past before = self->past;
    self->past
        = (ark_past){ { self->control.bias * error, before.e[0] }, { h, before.h[0] } };
    return 0;
}

/* SUNDIALS' own would free the content, which is the stepper. */
static int law_destroy(SUNAdaptController controller)
{
    SUNAdaptController_DestroyEmpty(controller);
    return 0;
}

static int set_law(arkode_stepper *self)
{
    SUNAdaptController made = SUNAdaptController_NewEmpty(self->context);
    if (made == NULL) {
        return 1;
    }
    self->controller = made;
    made->content = self;
    made->ops->gettype = law_type;
    made->ops->estimatestep = law_estimate;
    made->ops->reset = law_reset;
    made->ops->updateh = law_accepted;
    made->ops->destroy = law_destroy;
    return law_reset(made) | ARK(SetAdaptController)(self->solver, made)
           | ARK(SetAdaptivityAdjustment)(self->solver, -1); /* h ~ error^(-1/p) */
}
#else
static int law(N_Vector y, sunrealtype t, sunrealtype h, sunrealtype h1, sunrealtype h2,
               sunrealtype e, sunrealtype e1, sunrealtype e2, int q, int p,
               sunrealtype *next, void *instance)
{
    const arkode_stepper *self = instance;
    const ark_past past = { { e1, e2 }, { h1, h2 } };
    (void)y, (void)t, (void)q;
    *next = next_h(&self->control, p, h, e, &past);
    return 0;
}

static int set_law(arkode_stepper *self)
{
    return ARK(SetAdaptivityFn)(self->solver, law, self)
           | ARK(SetErrorBias)(self->solver, self->control.bias);
}
#endif

int weft__ark_set_control(arkode_stepper *self)
{
    const weft_controller *c = &self->control;
    void *s = self->solver;
    int bad = set_law(self);
    /* ARKODE 6.4 refuses 1 */
    bad |= ARK(SetSafetyFactor)(s, fmin(c->safety, nextafter(1.0, 0.0)));
    bad |= ARK(SetMaxGrowth)(s, c->max_growth);
    bad |= ARK(SetMaxFirstGrowth)(s, c->first_growth);
    bad |= ARK(SetMaxEFailGrowth)(s, c->failed_growth);
    bad |= ARK(SetMinReduction)(s, c->min_reduction);
    bad |= ARK(SetFixedStepBounds)(s, keep_above, keep_below);
    bad |= ARK(SetSmallNumEFails)(s, 2);
    bad |= ARK(SetMaxErrTestFails)(s, 1000); /* it continues until min_step */
    bad |= ARK(SetMaxStep)(s, isinf(self->longest) ? 0.0 : self->longest);
    return bad;
}

/* ---- the options in force -------------------------------------------------------- */

void weft__ark_options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const arkode_stepper *self = instance;
    const weft_controller *c = &self->control;
    const char *table = self->method->type.full_name;
    if (table != NULL) {
        tell(ctx, self->method->stabilised ? "method" : "table", table);
    }
    if (self->implicit) {
        weft__ark_tell_newton(self, tell, ctx);
    }
    if (self->fixed_step > 0.0) {
        return;
    }
    tell(ctx, "controller", names[c->type]);
    for (int i = 0; i < c->gain_count; ++i) {
        const char name[] = { 'k', (char)('1' + i), '\0' };
        weft__tell_number(tell, ctx, name, c->gains[i]);
    }
    weft__tell_number(tell, ctx, "safety", c->safety);
    weft__tell_number(tell, ctx, "bias", c->bias);
    weft__tell_number(tell, ctx, "max_growth", c->max_growth);
    weft__tell_number(tell, ctx, "first_growth", c->first_growth);
    weft__tell_number(tell, ctx, "min_reduction", c->min_reduction);
    weft__tell_number(tell, ctx, "failed_growth", c->failed_growth);
    weft__tell_number(tell, ctx, "keep_above", keep_above);
    weft__tell_number(tell, ctx, "keep_below", keep_below);
}
