/* SPDX-License-Identifier: BSD-3-Clause */
/* failures.c -- steps that fail, and the steps after them. */
#include "study/conformance/trial.h"

/* After three good steps every rhs call from the k-th on fails. False if that was not
 * noticed within one step. */
static bool fails_and_heals(trial *self, fault kind, uint64_t k)
{
    trial_run *r = weft__begin_usual(self, 0);
    for (int i = 0; i < 3; ++i) {
        weft__good_step(self, r, 1.0);
    }
    char what[80];
    (void)snprintf(what, sizeof what, "rhs %s from call %" PRIu64 " of a step on",
                   weft__fault_names[kind], k);
    const trial_run before = *r;
    r->model.fault = kind;
    r->model.at = r->model.calls + k;
    const weft_status status = weft__step(r, 1.0);
    if (status == WEFT_OK) {
        EXPECT(isfinite(weft__model_distance(r->y, r->y)),
               "%s: a state that is not finite was accepted", what);
        return false;
    }
    const weft_status wanted = kind == STOP ? WEFT_STOPPED : WEFT_NOT_FINITE;
    EXPECT(status == wanted && r->err.status == status,
           "%s: the step returned '%s', not '%s'", what, weft_status_text(status),
           weft_status_text(wanted));
    weft__unchanged(self, r, &before, what);
    EXPECT(weft__stats(r).steps == 3, "%s: the failure counts as a step", what);
    weft__calls_counted(self, r, what);
    EXPECT(kind != STOP || r->model.calls == r->model.at,
           "%s: it was called %" PRIu64 " times more", what,
           r->model.calls - r->model.at);
    r->model.fault = NO_FAULT;
    weft__go(self, r, 0.25);
    strcat(what, ", and healed");
    weft__near_solution(self, r, what);
    return true;
}

void weft__a_failed_step_changes_nothing(trial *self)
{
    const uint64_t least = self->type->stages > 0 ? (uint64_t)self->type->stages : 1;
    for (fault kind = REFUSE; kind < FAULTS; ++kind) {
        uint64_t k = 1;
        while (fails_and_heals(self, kind, k)) {
            k += 1 + k / 8;
        }
        EXPECT(k > least, "rhs %s from call %" PRIu64 " of a step on: not noticed",
               weft__fault_names[kind], k);
    }
}

void weft__one_refusal_costs_a_smaller_step(trial *self)
{
    const fault kinds[] = { REFUSE, GIVE_NAN, GIVE_INF };
    char what[64];
    for (int i = 0; i < 3; ++i) {
        trial_run *r = weft__begin_usual(self, 0);
        weft__go(self, r, 0.125);
        const uint64_t rejected = weft__stats(r).rejected;
        r->model.fault = kinds[i];
        r->model.once = true;
        r->model.at = r->model.calls + 2;
        weft__go(self, r, 1.0);
        (void)snprintf(what, sizeof what, "rhs %s once", weft__fault_names[kinds[i]]);
        EXPECT(weft__stats(r).rejected > rejected, "%s: no step was rejected", what);
        weft__near_solution(self, r, what);
    }
}

void weft__a_first_step_too_large_is_rescued(trial *self)
{
    const char what[] = "first_step 47.3 s, beyond what the rhs accepts";
    weft_stepper_config config = weft__adaptive(1e-6);
    config.first_step = 47.3;
    trial_run *r = weft__begin(self, 0, config);
    r->model.edge = 1.2;
    r->model.last = 8.0; /* at the start's y too, which implicit stages begin with */
    weft__good_step(self, r, 100.0);
    EXPECT(weft__stats(r).rejected > 0 && r->t < 4.0, "%s: %.*g s were taken", what,
           weft_text_digits(r->t), r->t);
    weft__go(self, r, 4.0);
    weft__near(self, r, weft__error_at_end(r), 4.0 * weft__allowed(self->type), what);
}

void weft__needing_less_than_min_step_fails(trial *self)
{
    const char what[] = "a step that needs less than min_step";
    weft_stepper_config config = weft__adaptive(1e-6);
    config.min_step = 0.9e-6;
    trial_run *r = weft__begin(self, 0, config);
    weft__go(self, r, 0.125);
    const trial_run before = *r;
    r->model.k = 1e14; /* 1e-6 s is a period and a half */
    const weft_status status = weft__step(r, 1.0);
    EXPECT(status == WEFT_STEP_TOO_SMALL, "%s returned '%s'", what,
           weft_status_text(status));
    weft__unchanged(self, r, &before, what);
    r->model.k = 1.0;
    weft__go(self, r, 1.0);
    weft__near_solution(self, r, "after the failure");
}
