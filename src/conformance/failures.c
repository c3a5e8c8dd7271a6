/* SPDX-License-Identifier: BSD-3-Clause */
/* failures.c -- what a step that fails leaves behind, and what helps it. */
#include "conformance/trial.h"

static const char *const fault_names[FAULTS] = {
    "", "returns 1", "returns -1", "gives NaN", "gives infinity",
};

/* Of a step that failed, told by the fault and the call that began it. */
static bool left_untouched(trial *self, const trial_run *r, const trial_run *before,
                           const char *what)
{
    const weft_stepper_stats s = weft__stats(self, r);
    return weft__expect(self, memcmp(&r->t, &before->t, sizeof r->t) == 0,
                        "%s: t was %.17g and is %.17g after the failure", what,
                        before->t, r->t)
           && weft__expect(self, weft__same(self, r, before),
                           "%s: y is not as before the failure", what)
           && weft__expect(self, s.steps == 3, "%s: the failure counts as a step", what)
           && weft__expect(self, s.rhs_calls == r->model.calls,
                           "%s: rhs_calls is %llu after the failure, there were %llu",
                           what, (unsigned long long)s.rhs_calls,
                           (unsigned long long)r->model.calls);
}

/* Healed, the run goes on and arrives at the right place. */
static bool heals(trial *self, trial_run *r, const char *what)
{
    r->model.fault = NO_FAULT;
    if (!weft__go(self, r, 0.25)) {
        return false;
    }
    return weft__near(self, r, weft__error_at_end(r), weft__allowed(self->type),
                      "%s, and healed", what);
}

/* After three good steps every rhs call from the k-th on fails. True if that was
 * noticed within one step, and all is well. */
static bool fails_and_heals(trial *self, int mode, fault kind, uint64_t k)
{
    trial_run *r = weft__begin(self, 0, weft__usual(self->type, mode));
    for (int i = 0; i < 3; ++i) {
        if (r == NULL || !weft__good_step(self, r, 1.0)) {
            return false;
        }
    }
    char what[64];
    (void)snprintf(what, sizeof what, "rhs %s from call %llu of a step on",
                   fault_names[kind], (unsigned long long)k);
    const trial_run before = *r;
    r->model.fault = kind;
    r->model.at = r->model.calls + k;
    const weft_status status = weft__step(self, r, 1.0);
    if (status == WEFT_OK) {
        (void)weft__expect(self, isfinite(weft__model_distance(r->y, r->y)),
                           "%s: a state that is not finite was accepted", what);
        return false;
    }
    const weft_status wanted = kind == STOP ? WEFT_STOPPED : WEFT_NOT_FINITE;
    return weft__expect(self, status == wanted && r->err.status == status,
                        "%s: the step returned '%s', not '%s'", what,
                        weft_status_text(status), weft_status_text(wanted))
           && left_untouched(self, r, &before, what)
           && weft__expect(self, kind != STOP || r->model.calls == r->model.at,
                           "%s: it was called %llu times more", what,
                           (unsigned long long)(r->model.calls - r->model.at))
           && heals(self, r, what);
}

static void a_failed_step_leaves_all_untouched(trial *self)
{
    const uint64_t least = self->type->stages > 0 ? (uint64_t)self->type->stages : 1;
    for (int mode = 0; mode < 2; ++mode) {
        for (fault kind = REFUSE; kind < FAULTS; ++kind) {
            uint64_t k = 1;
            while (fails_and_heals(self, mode, kind, k)) {
                k += 1 + k / 8;
            }
            (void)weft__expect(self, k > least,
                               "rhs %s from call %llu of a step on: not noticed",
                               fault_names[kind], (unsigned long long)k);
        }
    }
}

static void one_refusal_costs_a_smaller_step(trial *self)
{
    for (fault kind = REFUSE; kind < FAULTS; ++kind) {
        trial_run *r
            = kind == STOP ? NULL : weft__begin(self, 0, weft__usual(self->type, 0));
        if (r == NULL || !weft__go(self, r, 0.125)) {
            continue;
        }
        const uint64_t rejected = weft__stats(self, r).rejected;
        r->model.fault = kind;
        r->model.once = true;
        r->model.at = r->model.calls + 2;
        if (!weft__go(self, r, 1.0)) {
            return;
        }
        (void)weft__expect(self, weft__stats(self, r).rejected > rejected,
                           "rhs %s once: no step was rejected", fault_names[kind]);
        (void)weft__near(self, r, weft__error_at_end(r), weft__allowed(self->type),
                         "rhs %s once", fault_names[kind]);
    }
}

static void a_first_step_too_large_is_rescued(trial *self)
{
    weft_stepper_config config = weft__adaptive(1e-6);
    config.first_step = 47.3;
    trial_run *r = weft__begin(self, 0, config);
    if (r == NULL) {
        return;
    }
    r->model.edge = 1.2;
    if (!weft__good_step(self, r, 100.0)) {
        return;
    }
    (void)weft__expect(self, weft__stats(self, r).rejected > 0 && r->t < 4.0,
                       "first_step 47.3 s, beyond what the rhs accepts: %.17g s were "
                       "taken",
                       r->t);
    if (r->t < 4.0 && weft__go(self, r, 4.0)) {
        (void)weft__near(
            self, r, weft__error_at_end(r), 4.0 * weft__allowed(self->type),
            "first_step %g s, beyond what the rhs accepts", config.first_step);
    }
}

static void needing_less_than_min_step_fails(trial *self)
{
    weft_stepper_config config = weft__adaptive(1e-6);
    config.min_step = 0.9e-6;
    trial_run *r = weft__begin(self, 0, config);
    if (r == NULL || !weft__go(self, r, 0.125)) {
        return;
    }
    const trial_run before = *r;
    r->model.k = 1e14; /* 1e-6 s is a period and a half */
    const weft_status status = weft__step(self, r, 1.0);
    (void)weft__expect(self, status == WEFT_STEP_TOO_SMALL,
                       "a step that needs less than min_step returned '%s'",
                       weft_status_text(status));
    (void)weft__expect(self,
                       memcmp(&r->t, &before.t, sizeof r->t) == 0
                           && weft__same(self, r, &before),
                       "the failure changed t or y");
    r->model.k = 1.0;
    if (status == WEFT_STEP_TOO_SMALL && weft__go(self, r, 1.0)) {
        (void)weft__near(self, r, weft__error_at_end(r), weft__allowed(self->type),
                         "after the failure");
    }
}

const check weft__failure_checks[] = {
    { .name = "failure",
      .promise
      = "a step that fails leaves t and y alone, nothing that is not finite is "
        "accepted, and later steps go on",
      .run = a_failed_step_leaves_all_untouched },
    { .name = "refusal once",
      .promise = "a state that the rhs refuses, or that is not finite, costs a smaller "
                 "step",
      .run = one_refusal_costs_a_smaller_step,
      .pointless = weft__no_error_control },
    { .name = "rescue",
      .promise = "a first step that is far too large is made smaller",
      .run = a_first_step_too_large_is_rescued,
      .pointless = weft__no_error_control },
    { .name = "min step",
      .promise = "to need less than min_step is a failure that leaves t and y alone",
      .run = needing_less_than_min_step_fails,
      .pointless = weft__no_error_control },
    { 0 }
};
