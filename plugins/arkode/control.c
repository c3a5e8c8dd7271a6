/* SPDX-License-Identifier: BSD-3-Clause */
/* control.c -- how h is adapted: ARKODE's controllers, every knob set by us. What is
 * not asked for is what ERKStep's default was until 7.2, which 7.3 changed. */
#include "arkode_plugin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Gains as in ARKODE's manual (6.4, "Time step adaptivity"): with e1, e2, e3 the last
 * errors and p the embedded order,
 *   pid  h e1^(-k1/p) e2^(k2/p) e3^(-k3/p); pi and i: the same with fewer,
 *   explicit_gustafsson  h e1^(-k1/p) (e1/e2)^(-k2/p), ... */
static const struct {
    weft_controller_type type;
    int method; /* of ERKStepSetAdaptivityMethod, until 6.6 */
    double gains[3];
} laws[] = {
    { WEFT_CONTROLLER_PID, ARK_ADAPT_PID, { 0.58, 0.21, 0.1 } },
    { WEFT_CONTROLLER_PI, ARK_ADAPT_PI, { 0.8, 0.31, 0.0 } },
    { WEFT_CONTROLLER_I, ARK_ADAPT_I, { 1.0, 0.0, 0.0 } },
    { WEFT_CONTROLLER_EXPLICIT_GUSTAFSSON, ARK_ADAPT_EXP_GUS, { 0.367, 0.268, 0.0 } },
    { WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON, ARK_ADAPT_IMP_GUS, { 0.98, 0.95, 0.0 } },
    { WEFT_CONTROLLER_IMEX_GUSTAFSSON, ARK_ADAPT_IMEX_GUS, { 0.367, 0.268, 0.95 } },
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

weft_controller weft__ark_control(const weft_controller *asked)
{
    weft_controller c = asked == NULL ? defaults : *asked;
    c.type = c.type == WEFT_CONTROLLER_DEFAULT ? defaults.type : c.type;
    if (c.gain_count == 0) {
        c.gain_count = gain_counts[c.type];
        memcpy(c.gains, laws[law_of(c.type)].gains, sizeof c.gains);
    }
    c.safety = chosen(c.safety, defaults.safety);
    c.bias = chosen(c.bias, defaults.bias);
    c.max_growth = chosen(c.max_growth, defaults.max_growth);
    c.first_growth = chosen(c.first_growth, defaults.first_growth);
    c.min_reduction = chosen(c.min_reduction, defaults.min_reduction);
    c.failed_growth = chosen(c.failed_growth, defaults.failed_growth);
    return c;
}

#if SUNV >= 607
/* In 6.7 the gains of pid and pi became those of Soderlind's law, where all exponents
 * are negative. */
static int make_law(stepper *self, const double k[3])
{
    SUNContext context = self->context;
    SUNAdaptController *made = &self->controller;
    switch (self->control.type) {
    case WEFT_CONTROLLER_PID:
        *made = SUNAdaptController_PID(context);
        return *made == NULL
               || SUNAdaptController_SetParams_PID(*made, k[0], -k[1], k[2]);
    case WEFT_CONTROLLER_I:
        *made = SUNAdaptController_I(context);
        return *made == NULL || SUNAdaptController_SetParams_I(*made, k[0]);
    case WEFT_CONTROLLER_EXPLICIT_GUSTAFSSON:
        *made = SUNAdaptController_ExpGus(context);
        return *made == NULL || SUNAdaptController_SetParams_ExpGus(*made, k[0], k[1]);
    case WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON:
        *made = SUNAdaptController_ImpGus(context);
        return *made == NULL || SUNAdaptController_SetParams_ImpGus(*made, k[0], k[1]);
    case WEFT_CONTROLLER_IMEX_GUSTAFSSON:
        *made = SUNAdaptController_ImExGus(context);
        return *made == NULL
               || SUNAdaptController_SetParams_ImExGus(*made, k[0], k[1], k[2], k[2]);
    default:
        *made = SUNAdaptController_PI(context);
        return *made == NULL || SUNAdaptController_SetParams_PI(*made, k[0], -k[1]);
    }
}
#endif

static int set_law(stepper *self)
{
    const weft_controller *c = &self->control;
#if SUNV >= 607
    int bad = make_law(self, c->gains);
    if (bad == 0) {
        bad |= (int)SUNAdaptController_SetErrorBias(self->controller, c->bias);
        bad |= ARK(SetAdaptController)(self->solver, self->controller);
        bad |= ARK(SetAdaptivityAdjustment)(self->solver, -1); /* h ~ error^(-1/p) */
    }
    return bad;
#else
    sunrealtype k[3] = { c->gains[0], c->gains[1], c->gains[2] };
    return ERKStepSetAdaptivityMethod(self->solver, laws[law_of(c->type)].method, 0, 0,
                                      k) /* 0: by p */
           | ERKStepSetErrorBias(self->solver, c->bias);
#endif
}

int weft__ark_set_control(stepper *self)
{
    const weft_controller *c = &self->control;
    void *s = self->solver;
    int bad = set_law(self);
    bad |= ARK(SetSafetyFactor)(s, c->safety);
    bad |= ARK(SetMaxGrowth)(s, c->max_growth);
    bad |= ARK(SetMaxFirstGrowth)(s, c->first_growth);
    bad |= ARK(SetMaxEFailGrowth)(s, c->failed_growth);
    bad |= ARK(SetMinReduction)(s, c->min_reduction);
    bad |= ARK(SetFixedStepBounds)(s, keep_above, keep_below);
    bad |= ARK(SetSmallNumEFails)(s, 2);
    bad |= ARK(SetMaxErrTestFails)(s, 1000); /* it goes on until min_step */
    bad |= ARK(SetMaxStep)(s, isinf(self->max_step) ? 0.0 : self->max_step);
    return bad;
}

/* ---- what is in force ------------------------------------------------------------ */

static void tell_number(weft_option_fn *tell, void *ctx, const char *name, double value)
{
    char text[32];
    int digits = 15; /* the fewest that are read back as the same number */
    do {
        (void)snprintf(text, sizeof text, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    tell(ctx, name, text);
}

void weft__ark_options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const stepper *self = instance;
    const weft_controller *c = &self->control;
    const char *table = self->method->type.full_name;
    if (table != NULL) {
        tell(ctx, "table", table);
    }
    if (self->fixed_step > 0.0) {
        return;
    }
    tell(ctx, "controller", names[c->type]);
    for (int i = 0; i < c->gain_count; ++i) {
        const char name[] = { 'k', (char)('1' + i), '\0' };
        tell_number(tell, ctx, name, c->gains[i]);
    }
    tell_number(tell, ctx, "safety", c->safety);
    tell_number(tell, ctx, "bias", c->bias);
    tell_number(tell, ctx, "max_growth", c->max_growth);
    tell_number(tell, ctx, "first_growth", c->first_growth);
    tell_number(tell, ctx, "min_reduction", c->min_reduction);
    tell_number(tell, ctx, "failed_growth", c->failed_growth);
    tell_number(tell, ctx, "keep_above", keep_above);
    tell_number(tell, ctx, "keep_below", keep_below);
}
