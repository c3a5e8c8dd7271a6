/* SPDX-License-Identifier: BSD-3-Clause */
/* steps.c -- where steps end, and what they are said to have cost. */
#include "conformance/trial.h"

static bool at_exactly(trial *self, const trial_run *r, double t_end)
{
    return weft__expect(self, memcmp(&r->t, &t_end, sizeof t_end) == 0,
                        "t is %.17g where t_end was %.17g", r->t, t_end);
}

/* What the statistics say of the step just taken from t = before. */
static bool counted(trial *self, const trial_run *r, double before, uint64_t steps)
{
    const weft_stepper_stats s = weft__stats(self, r);
    return weft__expect(self, s.steps == steps + 1, "one step made steps %llu of %llu",
                        (unsigned long long)s.steps, (unsigned long long)steps)
           && weft__expect(self, fabs(s.last_step - (r->t - before)) <= 1e-15,
                           "last_step is %.17g after a step of %.17g s", s.last_step,
                           r->t - before)
           && weft__expect(self, s.next_step >= 0.0 && isfinite(s.next_step),
                           "next_step is %g", s.next_step)
           && weft__expect(self, s.rhs_calls == r->model.calls,
                           "rhs_calls is %llu, there were %llu",
                           (unsigned long long)s.rhs_calls,
                           (unsigned long long)r->model.calls);
}

static void every_end_is_met(trial *self)
{
    for (int mode = 0; mode < 2; ++mode) {
        trial_run *r = weft__begin(self, 0, weft__usual(self->type, mode));
        for (int frame = 1; r != NULL && frame <= 43; ++frame) {
            const double t_end = frame / 29.97;
            while (r->t < t_end) {
                const double before = r->t;
                const uint64_t steps = weft__stats(self, r).steps;
                if (!weft__good_step(self, r, t_end)
                    || !counted(self, r, before, steps)) {
                    return;
                }
            }
            if (!at_exactly(self, r, t_end)) {
                return;
            }
        }
        (void)weft__expect(
            self, r == NULL || isfinite(weft__model_distance(r->y, weft__model_start)),
            "y is not finite after good steps");
    }
}

/* t + (t_end - t) is not t_end where t < t_end / 2. */
static void a_single_step_lands_as_exactly(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1.0));
    for (double t_end = 1.3e-7; r != NULL && t_end < 0.02; t_end *= 2.7) {
        if (!weft__good_step(self, r, t_end) || !at_exactly(self, r, t_end)) {
            return;
        }
    }
}

static bool takes_steps(trial *self, trial_run *r, double t_end, uint64_t wanted)
{
    if (!weft__go(self, r, t_end)) {
        return false;
    }
    const uint64_t steps = weft__stats(self, r).steps;
    return weft__expect(self, steps == wanted,
                        "%llu steps up to %.17g s instead of %llu",
                        (unsigned long long)steps, t_end, (unsigned long long)wanted);
}

static void steps_that_fit_leave_no_sliver(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1.0 / 2997.0));
    trial_run *rough = weft__begin(self, 1, weft__fixed(3.0 / 2997.0));
    for (unsigned frame = 1; r != NULL && rough != NULL && frame <= 60; ++frame) {
        if (!takes_steps(self, r, frame / 299.7, 10 * frame)
            || !takes_steps(self, rough, frame / 299.7, 4 * frame)) {
            return;
        }
        const double last = weft__stats(self, rough).last_step;
        (void)weft__expect(self, fabs(last - 1.0 / 2997.0) <= 1e-12,
                           "the last step to %.17g s has %.17g s", frame / 299.7, last);
    }
}

static const char *no_stages(const weft_stepper_type *type)
{
    return type->stages > 0 ? NULL : "the number of stages varies";
}

static void stages_are_the_rhs_calls(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1e-3));
    if (r == NULL || !weft__good_step(self, r, 1.0)) {
        return;
    }
    const uint64_t first = r->model.calls;
    if (!weft__good_step(self, r, 1.0)) {
        return;
    }
    const uint64_t second = r->model.calls - first;
    (void)weft__expect(self, second == (uint64_t)self->type->stages,
                       "the table says %d stages, a step calls the rhs %llu times",
                       self->type->stages, (unsigned long long)second);
    (void)weft__expect(
        self, (self->type->flags & WEFT_STEPPER_FSAL) != 0 || first == second,
        "%llu rhs calls in the first step and %llu in the second, without "
        "WEFT_STEPPER_FSAL",
        (unsigned long long)first, (unsigned long long)second);
}

static void step_sizes_are_kept(trial *self)
{
    weft_stepper_config config = weft__adaptive(1e-3);
    config.first_step = 1.7e-5;
    config.max_step = 0.0113;
    trial_run *r = weft__begin(self, 0, config);
    if (r == NULL || !weft__good_step(self, r, 1.0)
        || !weft__expect(self, fabs(r->t - 1.7e-5) <= 1e-18,
                         "first_step 1.7e-5 s became %.17g s", r->t)) {
        return;
    }
    double longest = 0.0;
    while (r->t < 1.0) {
        if (!weft__good_step(self, r, 1.0)) {
            return;
        }
        longest = fmax(longest, weft__stats(self, r).last_step);
    }
    (void)weft__expect(self, longest <= 0.0113 * (1.0 + 1e-11),
                       "a step of %.17g s, max_step is 0.0113 s", longest);
    (void)weft__expect(self, longest >= 0.0056,
                       "the longest step is %g s where 0.0113 s would do", longest);
}

static void no_step_goes_backwards(trial *self)
{
    const double t_ends[] = { 0.25, 0.125, -1.0, (double)NAN };
    trial_run *r = weft__begin(self, 0, weft__usual(self->type, 0));
    if (r == NULL || !weft__go(self, r, 0.25)) {
        return;
    }
    const trial_run before = *r;
    for (int i = 0; i < 4; ++i) {
        const weft_status status = weft__step(self, r, t_ends[i]);
        (void)weft__expect(self, status == WEFT_INVALID,
                           "a step from 0.25 to %g s returned '%s'", t_ends[i],
                           weft_status_text(status));
        (void)weft__expect(self,
                           memcmp(&r->t, &before.t, sizeof r->t) == 0
                               && weft__same(self, r, &before),
                           "a step from 0.25 to %g s changed t or y", t_ends[i]);
    }
    (void)weft__expect(self, r->model.calls == before.model.calls,
                       "steps to nowhere called the rhs");
    (void)weft__go(self, r, 0.5);
}

const check weft__step_checks[] = {
    { .name = "exact end",
      .promise = "a step never goes past t_end and meets it bit for bit, and counts",
      .run = every_end_is_met },
    { .name = "landing",
      .promise = "a single step lands on t_end bit for bit, wherever it began",
      .run = a_single_step_lands_as_exactly },
    { .name = "slivers",
      .promise = "fixed steps that fit leave no sliver of a step before t_end",
      .run = steps_that_fit_leave_no_sliver },
    { .name = "stages",
      .promise = "a step calls the rhs as often as the table says",
      .run = stages_are_the_rhs_calls,
      .pointless = no_stages },
    { .name = "step sizes",
      .promise = "first_step and max_step are kept to",
      .run = step_sizes_are_kept,
      .pointless = weft__no_error_control },
    { .name = "direction",
      .promise = "a step to a t_end that is not later is invalid and changes nothing",
      .run = no_step_goes_backwards },
    { 0 }
};
