/* SPDX-License-Identifier: BSD-3-Clause */
/* cvode_step.c -- one accepted step: one call of CVode with the end of the frame as
 * stop time, on a vector of ours that is copied to the caller's on success only.
 *
 * CVODE keeps a history. It goes on from there over the ends of frames; where the state
 * was edited, and after a failure, it starts anew at order 1 with the h at hand
 * (without that, an h of its own is so small that steps become a thousand times as
 * many).
 *
 * An RHS of no use must be a NaN to CVODE: its equations then have no solution and h
 * shrinks down to min_step, while the code for "try a smaller step" ends the run if it
 * comes twice. */
#include "cvode_plugin.h"

#include <math.h>

int weft__cvode_rhs(sunrealtype t, N_Vector y, N_Vector ydot, void *instance)
{
    cvode_stepper *self = instance;
    const bool starting = self->starting;
    int failed = 1;
    self->starting = false;
    weft__sun_iterate(&self->equations, t, y);
    if (self->stopped) { /* the fixed point iteration goes on */
        return -1;
    }
    if (weft__sun_finite(y)) {
        ++self->stats.rhs_calls;
        failed = self->ode.rhs(t, NV_DATA_S(y), weft__sun_fill(ydot), self->ode.ctx);
    }
    if (failed < 0) {
        self->stopped = true;
        return -1;
    }
    self->bad = failed > 0 || !weft__sun_finite(ydot);
    if (!self->bad) {
        return 0;
    }
    weft__sun_fill(ydot)[0] = NAN;
    return starting ? -1 : 0; /* a smaller h helps no start */
}

int weft__cvode_weights(N_Vector y, N_Vector weights, void *instance)
{
    const cvode_stepper *self = instance;
    weft__sun_weigh(y, weights, self->rtol, self->atol);
    return 0;
}

int weft__cvode_system(sunrealtype t, N_Vector y, N_Vector fy, SUNMatrix matrix,
                       int keep, int *fresh, sunrealtype gamma, void *instance,
                       N_Vector work1, N_Vector work2, N_Vector work3)
{
    cvode_stepper *self = instance;
    (void)fy, (void)matrix, (void)work1, (void)work2, (void)work3;
    return weft__sun_linearise(&self->equations, t, y, keep, fresh, gamma);
}

/* Makes CVODE start from (t, y), if it does not go on. */
static int prepare(cvode_stepper *self, double t, const double *y, double stop)
{
    void *solver = self->solver;
    int flag = CV_SUCCESS;
    if (self->restart) {
        weft__sun_write(self->y, y);
        self->failed = self->unsolved = 0;
        self->starting = true;
        flag = CVodeReInit(solver, t, self->y);
        flag = flag == CV_SUCCESS ? CVodeSetInitStep(solver, self->h) : flag;
    }
    if (flag == CV_SUCCESS) { /* a step shortened below min_step is no failure yet */
        flag = CVodeSetMinStep(solver, fmin(self->min_step, stop - t));
    }
    return flag == CV_SUCCESS ? CVodeSetStopTime(solver, stop) : flag;
}

/* One call of CVode, which tries smaller and smaller steps. *reached is its t. */
static int advance(cvode_stepper *self, double t, const double *y, double stop,
                   double *reached)
{
    long unsolved = 0, inaccurate = 0;
    self->stopped = self->bad = false;
    int flag = prepare(self, t, y, stop);
    if (flag == CV_SUCCESS) {
        self->restart = false;
        flag = CVode(self->solver, stop, self->y, reached, CV_ONE_STEP);
    }
    (void)CVodeGetNumStepSolveFails(self->solver, &unsolved);
    (void)CVodeGetNumErrTestFails(self->solver, &inaccurate);
    const long failed = unsolved + inaccurate;
    self->stats.rejected += (uint64_t)(failed - self->failed);
    self->stats.rejected += flag < 0 && failed == self->failed;
    self->stats.newton_failures += (uint64_t)(unsolved - self->unsolved);
    self->failed = failed;
    self->unsolved = unsolved;
    return flag;
}

static weft_status fail(cvode_stepper *self, int flag, weft_error *err)
{
    const char *name = self->method->type.name;
    self->restart = true;
    self->starting = false;
    if (self->stopped) {
        return weft_error_set(err, WEFT_STOPPED, "%s: stopped by the model", name);
    }
    if (self->bad || flag >= 0) {
        return weft_error_set(err, WEFT_NOT_FINITE, "%s: not finite after a step",
                              name);
    }
    switch (flag) {
    case CV_ERR_FAILURE:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: even a step of %.3g s is not accurate enough", name,
                              self->min_step);
    case CV_CONV_FAILURE:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: its equations have no solution that CVODE could "
                              "find even with a step of %.3g s",
                              name, self->min_step);
    case CV_TOO_MUCH_ACC:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: the tolerances are below roundoff", name);
    case CV_MEM_FAIL:
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory for CVODE", name);
    default:
        return weft_error_set(err, WEFT_SOLVER, "%s: CVODE's error %d", name, flag);
    }
}

/* How far to go of `rest`: half of it if h would leave a sliver. */
static double stop_time(const cvode_stepper *self, double t, double rest, double t_end)
{
    const bool sliver = self->h > 0.9 * rest && self->h < rest * (1.0 - 1e-6);
    return sliver && t + 0.5 * rest > t ? t + 0.5 * rest : t_end;
}

/* At a stop time CVODE's proposal cannot be read: the h that was wanted before stands.
 */
static void accept(cvode_stepper *self, bool stopped, double reached, double *t,
                   double *y)
{
    const double taken = reached - *t;
    double next = 0.0;
    weft__sun_read(self->y, y);
    *t = reached;
    ++self->stats.steps;
    self->stats.last_step = taken;
    if (stopped) {
        next = fmax(self->h, taken);
    } else {
        (void)CVodeGetCurrentStep(self->solver, &next);
    }
    self->h = fmin(fmax(next, self->min_step), self->max_step);
}

weft_status weft__cvode_step(void *instance, double t_end, double *t, double *y,
                             weft_error *err)
{
    cvode_stepper *self = instance;
    const double rest = t_end - *t;
    if (weft_stepper_check_end(&self->method->type, *t, t_end, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const double stop = stop_time(self, *t, rest, t_end);
    double reached = *t;
    const int flag = advance(self, *t, y, stop, &reached);
    if (flag < 0 || !weft__sun_finite(self->y)) {
        return fail(self, flag, err);
    }
    if (!(reached > *t)) {
        self->restart = true;
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: a step does not move t = %.*g s",
                              self->method->type.name, weft_text_digits(*t), *t);
    }
    accept(self, flag == CV_TSTOP_RETURN, reached, t, y);
    return WEFT_OK;
}

void weft__cvode_state_changed(void *instance)
{
    cvode_stepper *self = instance;
    self->restart = true;
}

void weft__cvode_stats(const void *instance, weft_stepper_stats *out)
{
    const cvode_stepper *self = instance;
    weft_stepper_stats stats = self->stats;
    weft__sun_count_equations(&self->equations, &stats);
    weft__sun_stats(&stats, self->h, out);
}
