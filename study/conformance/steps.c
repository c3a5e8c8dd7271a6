/* SPDX-License-Identifier: BSD-3-Clause */
/* steps.c -- the ends of steps, and the statistics of their cost. */
#include "study/conformance/trial.h"

static void at_exactly(trial *self, const trial_run *r, double t_end)
{
    EXPECT(memcmp(&r->t, &t_end, sizeof t_end) == 0, "t is %.*g where t_end was %.*g",
           weft_text_digits(r->t), r->t, weft_text_digits(t_end), t_end);
}

/* The statistics of the step just taken from t = before. */
static void counted(trial *self, const trial_run *r, double before, uint64_t steps)
{
    const weft_stepper_stats s = weft__stats(r);
    EXPECT(s.steps == steps + 1, "one step made steps %" PRIu64 " of %" PRIu64, s.steps,
           steps);
    EXPECT(fabs(s.last_step - (r->t - before)) <= 1e-15,
           "last_step is %.*g after a step of %.*g s", weft_text_digits(s.last_step),
           s.last_step, weft_text_digits(r->t - before), r->t - before);
    EXPECT(s.next_step >= 0.0 && isfinite(s.next_step), "next_step is %g", s.next_step);
    weft__calls_counted(self, r, "after a step");
}

void weft__every_end_is_met(trial *self)
{
    trial_run *r = weft__begin_usual(self, 0);
    for (int frame = 1; frame <= 43; ++frame) {
        const double t_end = frame / 29.97;
        while (r->t < t_end) {
            const double before = r->t;
            const uint64_t steps = weft__stats(r).steps;
            weft__good_step(self, r, t_end);
            counted(self, r, before, steps);
        }
        at_exactly(self, r, t_end);
    }
    EXPECT(isfinite(weft__model_distance(r->y, weft__model_start)),
           "y is not finite after good steps");
}

/* t + (t_end - t) is not t_end where t < t_end / 2. */
void weft__a_single_step_lands_exactly(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1.0));
    double t_end = 1.3e-7;
    while (t_end < 0.02) {
        weft__good_step(self, r, t_end);
        at_exactly(self, r, t_end);
        t_end *= 2.7;
    }
}

static void takes_steps(trial *self, trial_run *r, double t_end, uint64_t wanted)
{
    weft__go(self, r, t_end);
    const uint64_t steps = weft__stats(r).steps;
    EXPECT(steps == wanted, "%" PRIu64 " steps up to %.*g s instead of %" PRIu64, steps,
           weft_text_digits(t_end), t_end, wanted);
}

void weft__steps_that_fit_leave_no_sliver(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1.0 / 2997.0));
    trial_run *rough = weft__begin(self, 1, weft__fixed(3.0 / 2997.0));
    for (unsigned frame = 1; frame <= 60; ++frame) {
        takes_steps(self, r, frame / 299.7, 10 * frame);
        takes_steps(self, rough, frame / 299.7, 4 * frame);
        const double last = weft__stats(rough).last_step;
        EXPECT(fabs(last - 1.0 / 2997.0) <= 1e-12, "the last step to %.*g s has %.*g s",
               weft_text_digits(frame / 299.7), frame / 299.7, weft_text_digits(last),
               last);
    }
}

void weft__stages_are_the_rhs_calls(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__fixed(1e-3));
    weft__good_step(self, r, 1.0);
    const uint64_t first = r->model.calls;
    weft__good_step(self, r, 1.0);
    const uint64_t second = r->model.calls - first;
    EXPECT(second == (uint64_t)self->type->stages,
           "the table says %d stages, a step calls the rhs %" PRIu64 " times",
           self->type->stages, second);
    EXPECT((self->type->flags & WEFT_STEPPER_FSAL) != 0 || first == second,
           "%" PRIu64 " force evaluations in the first step and %" PRIu64
           " in the second, without WEFT_STEPPER_FSAL",
           first, second);
}

void weft__step_sizes_are_kept(trial *self)
{
    weft_stepper_config config = weft__adaptive(1e-3);
    config.first_step = 1.7e-5;
    config.max_step = 0.0113;
    trial_run *r = weft__begin(self, 0, config);
    weft__good_step(self, r, 1.0);
    EXPECT(fabs(r->t - 1.7e-5) <= 1e-18, "first_step 1.7e-5 s became %.*g s",
           weft_text_digits(r->t), r->t);
    double longest = 0.0;
    while (r->t < 1.0) {
        weft__good_step(self, r, 1.0);
        longest = fmax(longest, weft__stats(r).last_step);
    }
    EXPECT(longest <= 0.0113 * (1.0 + 1e-11), "a step of %.*g s, max_step is 0.0113 s",
           weft_text_digits(longest), longest);
    EXPECT(longest >= 0.0056, "the longest step is %g s where 0.0113 s would do",
           longest);
}

void weft__no_step_goes_backwards(trial *self)
{
    const double t_ends[] = { 0.25, 0.125, -1.0, (double)NAN };
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.25);
    const trial_run before = *r;
    for (int i = 0; i < 4; ++i) {
        char what[64];
        (void)snprintf(what, sizeof what, "a step from 0.25 to %g s", t_ends[i]);
        const weft_status status = weft__step(r, t_ends[i]);
        EXPECT(status == WEFT_INVALID, "%s returned '%s'", what,
               weft_status_text(status));
        weft__unchanged(self, r, &before, what);
    }
    EXPECT(r->model.calls == before.model.calls, "steps to nowhere called the rhs");
    weft__go(self, r, 0.5);
}
