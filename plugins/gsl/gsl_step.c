/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_step.c -- one accepted step: GSL's step_apply and its rule for h, tried until
 * both agree.
 *
 * An attempt works on the caller's y, which is put back if it was no step, so that a
 * failure leaves t, y and the next h as they were: a later call continues as if the
 * failed one had not happened. Nothing is carried from step to step but h and, by a
 * multistep method, its history. Every attempt evaluates f at its own start, so an
 * edited y needs no notice by a one-step method. */
#include "gsl_plugin.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

static int apply(gsl_stepper *self, double t, double h, double *y)
{
    return self->v2 != NULL ? gsl_odeiv2_step_apply(self->v2, t, h, y, self->yerr, NULL,
                                                    NULL, &self->system2)
                            : gsl_odeiv_step_apply(self->v1, t, h, y, self->yerr, NULL,
                                                   NULL, &self->system1);
}

/* Not for rk2simp: its reset writes past the end of an array (GSL 2.7.1). */
static void forget(gsl_stepper *self)
{
    if (self->v2 != NULL) {
        gsl_odeiv2_step_reset(self->v2);
    } else {
        gsl_odeiv_step_reset(self->v1);
    }
    self->restart = false;
}

/* The outcome of an attempt from self->start to y. GSL passes NaN in the result as in
 * the error estimate. */
static trouble look(const gsl_stepper *self, const double *y, double *h)
{
    double r;
    if (!weft__gsl_ratio(self, y, &r)) {
        /* bsimp sets all to infinity when its extrapolation runs away */
        return weft__gsl_finite(y, self->ode.dim) && isinf(self->yerr[0]) ? UNSOLVED
                                                                          : NOT_FINITE;
    }
    const unsigned int order = self->v2 != NULL ? gsl_odeiv2_step_order(self->v2)
                                                : gsl_odeiv_step_order(self->v1);
    return self->fixed_step == 0.0 && weft__gsl_rejects(order, r, h) ? INACCURATE
                                                                     : NO_TROUBLE;
}

/* From (t, y) by *h, which comes out as GSL's proposal if the attempt is finite. */
static trouble attempt(gsl_stepper *self, double t, double *y, double *h)
{
    const size_t bytes = self->ode.dim * sizeof *y;
    if (self->restart || self->method->forget) {
        forget(self);
    }
    self->trouble = NO_TROUBLE;
    self->h_try = *h;
    memcpy(self->start, y, bytes);
    if (self->method->shift) {
        weft__gsl_shift(self, y);
    }
    const int failed = apply(self, t, *h, y);
    if (self->method->shift) {
        weft__gsl_unshift(self, y);
    }
    const trouble why = self->trouble != NO_TROUBLE ? self->trouble
                        : failed != GSL_SUCCESS     ? UNSOLVED
                                                    : look(self, y, h);
    if (why != NO_TROUBLE) {
        memcpy(y, self->start, bytes);
    }
    return why;
}

/* How far to go of `rest` when h is wanted: all of it if it is longer than h by
 * roundoff alone, half of it if h would leave a sliver, else h. */
static double fit(const gsl_stepper *self, double h, double rest)
{
    if (h >= rest * (1.0 - 1e-6)) {
        return rest;
    }
    return self->fixed_step == 0.0 && 2.0 * h >= rest ? 0.5 * rest : h;
}

/* The h to try next, after a step of `taken` where h was wanted. A step cut short by
 * the frame's end says little of h, unless GSL's proposal stays below it for another
 * reason than its own limit of growth, 4.9. */
static double next_step(const gsl_stepper *self, double h, double taken,
                        double proposed)
{
    const bool whole = taken >= h;
    const bool telling = proposed < h && proposed < 4.8 * taken;
    return fmin(fmax(whole || telling ? proposed : h, self->min_step), self->max_step);
}

/* The history of a multistep method may hold the failed attempt. */
static weft_status fail(gsl_stepper *self, trouble why, double h, weft_error *err)
{
    const char *name = self->method->type.name;
    const bool fixed = self->fixed_step > 0.0;
    weft__gsl_state_changed(self);
    switch (why) {
    case STOPPED:
        return weft_error_set(err, WEFT_STOPPED, "%s: stopped by the model", name);
    case NOT_FINITE:
        return weft_error_set(err, WEFT_NOT_FINITE,
                              "%s: not finite after a step of %.3g s", name, h);
    case UNSOLVED:
        return weft_error_set(err, fixed ? WEFT_SOLVER : WEFT_STEP_TOO_SMALL,
                              "%s: its equations have no solution that GSL could find "
                              "with a step of %.3g s",
                              name, h);
    case INACCURATE:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: even a step of %.3g s is not accurate enough", name,
                              h);
    default:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: a step of %.3g s does not advance the time", name,
                              h);
    }
}

weft_status weft__gsl_step(void *instance, double t_end, double *t, double *y,
                           weft_error *err)
{
    gsl_stepper *self = instance;
    const double rest = t_end - *t;
    if (weft_stepper_check_end(&self->method->type, *t, t_end, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    self->t_end = t_end;
    trouble why = NO_TROUBLE;
    for (double h = self->h;;) {
        const double taken = fit(self, h, rest);
        double proposed = taken;
        if (taken < rest && *t + taken == *t) {
            return fail(self, why, taken, err);
        }
        why = attempt(self, *t, y, &proposed);
        if (why == NO_TROUBLE) {
            ++self->stats.steps;
            self->stats.last_step = taken;
            *t = taken < rest ? *t + taken : t_end;
            self->h = self->fixed_step > 0.0 ? h : next_step(self, h, taken, proposed);
            return WEFT_OK;
        }
        ++self->stats.rejected;
        if (why == STOPPED || self->fixed_step > 0.0 || taken <= self->min_step) {
            return fail(self, why, taken, err);
        }
        h = fmax(why == INACCURATE ? proposed : 0.5 * taken, self->min_step);
    }
}

void weft__gsl_state_changed(void *instance)
{
    gsl_stepper *self = instance;
    self->restart = (self->method->type.flags & WEFT_STEPPER_MULTISTEP) != 0;
}

void weft__gsl_stats(const void *instance, weft_stepper_stats *out)
{
    const gsl_stepper *self = instance;
    weft_stepper_stats stats = self->stats;
    stats.next_step = self->h;
    weft_stepper_stats_copy(&stats, out);
}
