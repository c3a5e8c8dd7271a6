/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_step.c -- one accepted step: one call of Evolve, on a vector of ours that is
 * copied to the caller's on success only.
 *
 * No stop time is given to ARKODE. After a step that ended at one, its proposal for the
 * next cannot be read; after a Reset it does not shorten a step that leads past one
 * (6.4). Instead h is handed over where it must not be ARKODE's own, that is before the
 * end of a frame and after it, by SetInitStep and Reset: these forget the error of the
 * last step but no count.
 *
 * f(t, y) at the start of a step is the last stage of the step before if the table is
 * made for that (FSAL). SUNDIALS before 6.7 takes it so for every table whose last node
 * is 1, and loses orders, and evaluates f once too often for the others. So with tables
 * that are not FSAL every step begins with a Reset, after which f is evaluated, and the
 * call of f at the end of a step, which a hook announces, is not passed on. The results
 * are those of 6.7 and later.
 *
 * An RHS of no use must be a NaN to ARKODE: its error test fails and h shrinks, while
 * the code for "try a smaller step" ends the run. The result of the RHS is not
 * searched for NaN: it shows in every combination of it, a stage, the solution or the
 * error, where the test is free (vector.c). It is searched where NaN need not show,
 * and at the start of a step, where no smaller h helps. SUNDIALS from 6.7 on does not
 * call f there for a table whose first stage is implicit: only its time tells f at the
 * start from that stage, of which a smaller h may make something.
 *
 * If y is a part of a state, the steppers of the other parts take the same decisions:
 * they agree on every norm and on the end of a step, three times in a step without
 * rejections. Each calls the RHS whatever its own y is, as the others' may wait for it;
 * a fault is a NaN until the next agreement, which finds it. */
#include "arkode_plugin.h"

#include <math.h>
#include <string.h>

int weft__ark_rhs(sunrealtype t, N_Vector y, N_Vector ydot, void *instance)
{
    arkode_stepper *self = instance;
    const bool starting = t == self->start;
    if (self->skip) {
        self->skip = false;
        return 0;
    }
    self->start = NAN;
    if (self->over) {
        return -1;
    }
    if (weft__sun_put_off(t, y, ydot)) {
        return 0;
    }
    weft__sun_iterate(&self->equations, t, y);
    self->since_bad += self->since_bad < INT32_MAX;
    const bool usable = weft__sun_finite(y);
    int failed = 1;
    self->idle += !usable || self->fault != NO_FAULT;
    if (usable || self->agree != NULL) {
        ++self->stats.rhs_calls;
        failed = self->ode.rhs(t, NV_DATA_S(y), weft__sun_fill(ydot), self->ode.ctx);
    }
    const bool look = starting || self->hidden;
    if (usable && failed == 0 && (!look || weft__sun_finite(ydot))) {
        return 0;
    }
    self->since_bad = 0;
    weft__sun_fill(ydot)[0] = NAN;
    const ark_fault fault = failed < 0 ? STOPPED
                            : self->fixed_step > 0.0 || starting
                                ? USELESS /* a smaller h helps no start */
                                : NO_FAULT;
    self->fault = fault > self->fault ? fault : self->fault;
    return self->agree == NULL && fault != NO_FAULT ? -1 : 0;
}

/* As above, of a stage that was put off. After a fault, which has ended the step if it
 * was at the start or of a fixed step, nothing is called. */
void weft__ark_stage(void *instance, double t, const double *z, bool usable, bool again,
                     double *k)
{
    arkode_stepper *self = instance;
    int failed = 1;
    self->since_bad += !again && self->since_bad < INT32_MAX;
    if (usable && (again || self->fault == NO_FAULT)) {
        self->stats.rhs_calls += !again;
        failed = self->ode.rhs(t, z, k, self->ode.ctx);
    }
    for (size_t i = 0; failed == 0 && self->hidden && i < self->ode.dim; ++i) {
        failed = !isfinite(k[i]);
    }
    if (failed == 0) {
        return;
    }
    k[0] = NAN;
    if (!again || failed < 0) {
        self->since_bad = 0;
        self->over = self->over || failed < 0 || self->fixed_step > 0.0;
        self->fault = failed < 0                                          ? STOPPED
                      : self->fixed_step > 0.0 && self->fault == NO_FAULT ? USELESS
                                                                          : self->fault;
    }
}

void weft__ark_passed(void *instance, int calls, bool stopped)
{
    arkode_stepper *self = instance;
    self->stats.rhs_calls += (uint64_t)calls;
    self->since_bad += self->since_bad < INT32_MAX - calls ? calls : 0;
    if (stopped) {
        self->fault = STOPPED;
        self->over = true;
        self->since_bad = 0;
    }
}

/* Where there is a NaN all ask for its reason: the gravest fault, and how many RHS
 * calls would not have been made for the whole. */
double weft__ark_agree(void *instance, double mine)
{
    const double most = 0x1p30;
    arkode_stepper *self = instance;
    const double all = weft_stepper_agreed(self->agree, mine);
    if (isnan(all) && self->agree != NULL) {
        const double code
            = most * (double)self->fault + fmin((double)self->idle, most - 1.0);
        const double worst = weft_stepper_agreed(self->agree, code);
        self->fault = worst < 3.0 * most ? (ark_fault)(worst / most) : USELESS;
        self->stats.rhs_calls
            -= worst < 3.0 * most ? (uint64_t)(worst - most * (double)self->fault) : 0;
        self->idle = 0;
        self->over = self->fault != NO_FAULT;
    }
    return all;
}

/* A quadrature has the weight 0: no say, but NaN in it is NaN. */
int weft__ark_weights(N_Vector y, N_Vector weights, void *instance)
{
    const arkode_stepper *self = instance;
    if (self->fixed_step == 0.0 || self->implicit) {
        weft__sun_weigh(y, weights, self->rtol, self->atol);
    }
    return 0;
}

int weft__ark_step_done(sunrealtype t, N_Vector y, void *instance)
{
    arkode_stepper *self = instance;
    (void)t;
    (void)y;
    self->skip = true;
    return 0;
}

/* How far to go of `rest` when h is wanted: all of it if it is longer than h by
 * roundoff alone, half of it if h would leave a sliver, else h. */
static double fit(const arkode_stepper *self, double rest)
{
    const double h = self->h;
    if (h >= rest * (1.0 - 1e-6)) {
        return rest;
    }
    return self->fixed_step == 0.0 && h > 0.9 * rest ? 0.5 * rest : h;
}

/* Before the first step ARKODE has no stages yet, which ReInit makes it allocate. */
static int give_state(arkode_stepper *self, double t, const double *y)
{
    if (self->restart) { /* else it is what Evolve left there */
        weft__sun_write(self->y, y);
    }
    self->start = t;
    if (self->stats.steps > 0 && !self->anew) {
        return ARK(Reset)(self->solver, t, self->y);
    }
    self->failed_tests = self->unsolved = 0;
    self->anew = false;
    return self->method->stabilised ? weft__ark_restart_stabilised(self, t)
           : self->implicit
               ? ARKStepReInit(self->solver, NULL, weft__ark_rhs, t, self->y)
               : ERKStepReInit(self->solver, weft__ark_rhs, t, self->y);
}

/* Makes ARKODE start from (t, y), by h. */
static int prepare(arkode_stepper *self, double t, const double *y, double h)
{
    void *solver = self->solver;
    const bool forced = self->own_h || h != self->h;
    int flag = ARK_SUCCESS;
    if (self->fixed_step > 0.0) {
        flag = forced ? ARK(SetFixedStep)(solver, h) : ARK_SUCCESS;
        self->own_h = h != self->h;
    } else {
        /* a step shortened below min_step is no failure yet */
        flag = ARK(SetMinStep)(solver, fmin(self->min_step, h));
        if (forced && flag == ARK_SUCCESS) {
            flag = ARK(SetInitStep)(solver, h);
            self->restart = true;
        }
    }
    if (flag == ARK_SUCCESS && (self->restart || !self->fsal)) {
        flag = give_state(self, t, y);
    }
    return flag;
}

/* In any case the next step must not continue from ARKODE's own state. */
static void forget(arkode_stepper *self)
{
    self->own_h = self->restart = true;
    self->anew = self->method->stabilised;
    self->skip = false;
    self->start = NAN;
}

/* One call of Evolve, which tries smaller and smaller steps. *reached is its t. */
static int evolve(arkode_stepper *self, double t, const double *y, double h,
                  double t_end, double *reached)
{
    self->fault = NO_FAULT;
    self->over = false;
    self->idle = 0;
    self->since_bad = INT32_MAX;
    self->trial = h;
    int flag = prepare(self, t, y, h);
    if (flag == ARK_SUCCESS) {
        flag = ARK(Evolve)(self->solver, t_end, self->y, reached, ARK_ONE_STEP);
    }
    self->skip = false;
    const long before = self->failed_tests;
    long int failed = before;
    (void)ARK(GetNumErrTestFails)(self->solver, &failed);
    if (failed > before) {
        weft__spectrum_doubt(&self->spectrum);
    }
    self->stats.rejected += (uint64_t)(failed - before);
    self->failed_tests = failed;
    const long unsolved = weft__ark_unsolved(self);
    self->stats.rejected += (uint64_t)(unsolved - self->unsolved);
    self->stats.newton_failures += (uint64_t)(unsolved - self->unsolved);
    self->unsolved = unsolved;
    const bool counted = failed > before && self->over; /* by the error's NaN */
    self->stats.rejected
        += flag < 0 && flag != ARK_ERR_FAILURE && flag != ARK_CONV_FAILURE && !counted;
    return flag;
}

/* Whether the last attempt was finite; combinations of its stages may show that first.
 */
static bool was_finite(arkode_stepper *self, int flag)
{
    if (flag >= 0 || self->fault != NO_FAULT || self->since_bad <= self->stages) {
        return false;
    }
    return flag != ARK_ERR_FAILURE
           || ARK(GetEstLocalErrors)(self->solver, self->y) != ARK_SUCCESS
           || weft__sun_finite(self->y);
}

static weft_status fail(arkode_stepper *self, int flag, weft_error *err)
{
    const char *name = self->method->type.name;
    forget(self);
    const double why = weft_stepper_agreed(self->agree, self->fault == STOPPED   ? 2.0
                                                        : was_finite(self, flag) ? 0.0
                                                                                 : 1.0);
    if (why == 2.0) {
        return weft_error_set(err, WEFT_STOPPED, "%s: stopped by the model", name);
    }
    if (why != 0.0) {
        return weft_error_set(err, WEFT_NOT_FINITE, "%s: not finite after a step",
                              name);
    }
    switch (flag) {
    case ARK_ERR_FAILURE:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: even a step of %.3g s is not accurate enough", name,
                              self->min_step);
    case ARK_CONV_FAILURE:
        return weft_error_set(
            err, self->fixed_step > 0.0 ? WEFT_SOLVER : WEFT_STEP_TOO_SMALL,
            "%s: its equations have no solution that ARKODE could find with a step of "
            "%.3g s",
            name, self->fixed_step > 0.0 ? self->fixed_step : self->min_step);
    case ARK_TOO_MUCH_ACC:
        return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                              "%s: the tolerances are below roundoff", name);
    case ARK_MEM_FAIL:
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory for ARKODE", name);
    default:
        return weft_error_set(err, WEFT_SOLVER, "%s: ARKODE's error %d", name, flag);
    }
}

/* Whether the whole state is finite after a step. */
static bool is_good(arkode_stepper *self)
{
    const bool finite = weft__sun_finite(self->y); /* may evaluate what was put off */
    const bool good = self->fault == NO_FAULT && finite;
    return !isnan(weft__ark_agree(self, good ? 0.0 : (double)NAN));
}

/* The h to try next, after a step where h was tried for self->h. One cut short by the
 * frame's end says little of it, unless ARKODE had to go below that. Where max_step
 * binds ARKODE's h may be longer by roundoff: it is accepted, as a restart costs an
 * evaluation. */
static void propose(arkode_stepper *self, double tried, double taken)
{
    if (self->fixed_step > 0.0) {
        return;
    }
    double next = self->h;
    (void)ARK(GetCurrentStep)(self->solver, &next);
    const bool cut = tried < self->h && taken >= tried * (1.0 - 1e-9);
    self->own_h = !(next > 0.0 && next <= self->longest * (1.0 + 1e-15)
                    && next >= self->min_step);
    if (self->own_h) {
        next = fmin(fmax(next > 0.0 ? next : 0.0, self->min_step), self->longest);
    }
    if (cut && next < self->h && next >= tried) {
        next = self->h;
        self->own_h = true;
    }
    self->h = next;
}

/* `tried` equals `rest` if the step must end the frame. */
static void accept(arkode_stepper *self, double tried, double rest, double reached,
                   double t_end, double *t, double *y)
{
    const double before = *t;
    const bool at_end = reached - before >= rest * (1.0 - 1e-12) || reached >= t_end;
    weft__sun_read(self->y, y);
    *t = at_end ? t_end : reached;
    self->restart = *t != reached;
    ++self->stats.steps;
    ++self->spectrum.age;
    self->stats.last_step = at_end && tried == rest ? rest : *t - before;
    propose(self, tried, reached - before);
}

/* An OK from here would be one for ever. */
static weft_status stands_still(arkode_stepper *self, double h, double t,
                                weft_error *err)
{
    forget(self);
    return weft_error_set(err, WEFT_STEP_TOO_SMALL,
                          "%s: a step of %.3g s does not move t = %.*g s",
                          self->method->type.name, h, weft_text_digits(t), t);
}

weft_status weft__ark_step(void *instance, double t_end, double *t, double *y,
                           weft_error *err)
{
    arkode_stepper *self = instance;
    const double rest = t_end - *t;
    if (weft_stepper_check_end(&self->method->type, *t, t_end, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const weft_status status = weft__ark_limit_step(self, *t, y, err);
    if (status != WEFT_OK) {
        return status;
    }
    for (double h = fit(self, rest);;) {
        double reached = *t;
        if (h < rest && *t + h == *t) {
            return stands_still(self, h, *t, err);
        }
        const int flag = evolve(self, *t, y, h, t_end, &reached);
        if (flag < 0) {
            return fail(self, flag, err);
        }
        if (!(reached > *t)) { /* of an h that became less in there */
            (void)ARK(GetLastStep)(self->solver, &h);
            return stands_still(self, h, *t, err);
        }
        if (is_good(self)) {
            accept(self, h, rest, reached, t_end, t, y);
            return WEFT_OK;
        }
        ++self->stats.rejected;
        if (self->fixed_step > 0.0 || h <= self->min_step || self->fault != NO_FAULT) {
            return fail(self, flag, err);
        }
        forget(self);
        h = fmax(0.3 * h, self->min_step);
    }
}

void weft__ark_state_changed(void *instance)
{
    arkode_stepper *self = instance;
    self->restart = true;
}

void weft__ark_ode_changed(void *instance)
{
    arkode_stepper *self = instance;
    self->restart = true;
    self->spectrum.known = false;
}

/* How many an explicit table touches: others stay unused. */
static int vectors(const arkode_stepper *self)
{
    return self->implicit || self->stages == 0 ? 0
           : self->passes                      ? 5 - self->fsal
                          : self->stages + 2 + 2 * (self->fixed_step == 0.0);
}

void weft__ark_stats(const void *instance, weft_stepper_stats *out)
{
    const arkode_stepper *self = instance;
    weft_stepper_stats stats = self->stats;
    weft__sun_count_equations(&self->equations, &stats);
    stats.bytes = (uint64_t)vectors(self) * self->ode.dim * sizeof(double);
    weft__sun_stats(&stats, self->h, out);
}
