/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff_step.c -- one accepted step: attempts, the error test, and the next h. */
#include "stiff_plugin.h"

#include <math.h>

#include "weft/elementary.h"

#define SAFETY   0.85
#define GROWTH   4.0  /* of h from step to step, at most */
#define SHRINK   0.2  /* the same, at least */
#define UNUSABLE 0.25 /* factor of h after an attempt without a result */

int weft__stiff_rhs(stiff_stepper *self, double t, const double *y, double *f)
{
    ++self->stats.rhs_calls;
    const int failed = self->ode.rhs(t, y, f, self->ode.ctx);
    const double worst = failed < 0 ? 2.0 : failed > 0 ? 1.0 : 0.0;
    const double all = weft_stepper_agreed(self->agree, worst);
    return all == worst ? failed : all == 2.0 ? -1 : 1;
}

/* What h becomes after an error: the law of an I controller. */
static double factor(const stiff_stepper *self, double error)
{
    if (isnan(error)) {
        return UNUSABLE;
    }
    const double least = 1e-12;
    const double inverse = 1.0 / (error > least ? error : least);
    const int power = self->method->type.error_order + 1;
    const double root = power == 2 ? sqrt(inverse) : weft_pow(inverse, 1.0 / power);
    return fmin(GROWTH, fmax(SHRINK, SAFETY * root));
}

/* The step to try: it ends at the end of the frame, leaves no sliver there, or is h. A
 * rest that is longer than a fixed step by roundoff alone is taken whole. */
static double fit(const stiff_stepper *self, double most, double rest)
{
    const bool fixed = self->fixed_step > 0.0;
    const double h = fixed ? self->fixed_step : fmin(self->h, most);
    if (h >= rest * (1.0 - (fixed ? 1e-6 : 1e-12))) {
        return rest;
    }
    return fixed || 2.0 * h < rest ? h : 0.5 * rest;
}

static weft_status fail(stiff_stepper *self, int failed, double error, double h,
                        weft_error *err)
{
    const char *name = self->method->type.name;
    self->carries = self->fresh = false;
    if (failed < 0) {
        return weft_error_set(err, WEFT_STOPPED, "%s: stopped by the model", name);
    }
    if (isnan(error)) {
        return weft_error_set(err, WEFT_NOT_FINITE,
                              "%s: not finite after a step of %.3g s", name, h);
    }
    return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                          "%s: even a step of %.3g s is not accurate enough", name, h);
}

/* A step that was cut short says little of the next: h stays if it was accurate. */
static void propose(stiff_stepper *self, double h, double error, bool rejected)
{
    const double scale = factor(self, error);
    double next = h * scale;
    if (rejected) {
        next = fmin(next, h);
    } else if (h < self->h && scale >= 1.0) {
        next = fmax(next, self->h);
    }
    self->h = fmin(fmax(next, self->min_step), self->max_step);
}

static void accept(stiff_stepper *self, double h, bool last, double t_end, double *t,
                   double *y)
{
    memcpy(y, self->end, self->ode.dim * sizeof *y);
    *t = last ? t_end : *t + h;
    ++self->stats.steps;
    self->stats.last_step = h;
    ++self->spectrum.age;
    self->fresh = false;
    self->carries = self->ends;
    if (self->ends) {
        double *f = self->f;
        self->f = self->f_end;
        self->f_end = f;
    }
}

/* The error of an attempt, at most 1 if it is good; NaN if it is not usable. */
static double judge(const stiff_stepper *self, int failed, const double *y)
{
    const double error = failed != 0 ? (double)NAN
                         : self->fixed_step > 0.0
                             ? 0.0
                             : weft__stiff_norm(self, self->error, y);
    const bool usable = failed == 0 && weft__stiff_finite(self->ode.dim, self->end);
    return weft_stepper_agreed(self->agree, usable ? error : (double)NAN);
}

weft_status weft__stiff_step(void *instance, double t_end, double *t, double *y,
                             weft_error *err)
{
    stiff_stepper *self = instance;
    const double rest = t_end - *t;
    if (weft_stepper_check_end(&self->method->type, *t, t_end, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    double most = (double)INFINITY, h = 0.0;
    for (bool rejected = false;; rejected = true) {
        if (self->method->prepare != NULL) {
            const weft_status status = self->method->prepare(self, *t, y, &most, err);
            if (status != WEFT_OK) {
                return status;
            }
        }
        h = rejected ? fmin(h, most) : fit(self, most, rest);
        if (h < rest && *t + h == *t) {
            self->carries = self->fresh = false;
            return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                                  "%s: t + h == t at h = %g s", self->method->type.name,
                                  h);
        }
        self->ends = false;
        const int failed = self->method->attempt(self, *t, h, y);
        const double error = failed < 0 ? (double)NAN : judge(self, failed, y);
        if (error <= 1.0) {
            accept(self, h, h == rest, t_end, t, y);
            if (self->fixed_step == 0.0) {
                propose(self, h, error, rejected);
            }
            return WEFT_OK;
        }
        self->stats.rejected += failed < 0 ? 0 : 1;
        if (failed < 0 || self->fixed_step > 0.0 || h <= self->min_step) {
            return fail(self, failed, error, h, err);
        }
        self->carries = self->carries && !isnan(error); /* f may be the reason */
        weft__spectrum_doubt(&self->spectrum);
        h = fmax(h * fmin(factor(self, error), 0.9), self->min_step);
    }
}
