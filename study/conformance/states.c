/* SPDX-License-Identifier: BSD-3-Clause */
/* states.c -- edited states, statistics, and instances beside one another. */
#include "study/conformance/trial.h"

#include <pthread.h>

void weft__needless_changes_change_nothing(trial *self)
{
    const char what[] = "state_changed after every step, and no change";
    trial_run *quiet = weft__begin_usual(self, 0);
    trial_run *notified = weft__begin_usual(self, 1);
    weft__go(self, quiet, 1.0);
    while (notified->t < 1.0) {
        weft__good_step(self, notified, 1.0);
        self->type->state_changed(notified->self);
    }
    const bool equal = weft__same(self, quiet, notified)
                       && weft__stats(quiet).steps == weft__stats(notified).steps;
    EXPECT(equal || (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0,
           "%s: the results differ by %.3g", what,
           weft__model_distance(quiet->y, notified->y));
    weft__near(self, notified, weft__error_at_end(notified), 5e-3, what);
}

void weft__an_edited_state_is_used(trial *self)
{
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.5);
    r->y[0] -= 0.237;
    r->y[4] += 0.419;
    self->type->state_changed(r->self);
    double want[DIM];
    memcpy(want, r->y, sizeof want);
    weft__model_solve(0.5, 1.0, want);
    weft__go(self, r, 1.0);
    weft__near(self, r, weft__model_distance(r->y, want), weft__allowed(self->type),
               "y edited at 0.5 s");
}

/* A step of h from the t and y that are there, and the same by an instance that has no
 * past. With error control the two may want different steps. */
static void as_a_fresh_one(trial *self, trial_run *r, double h, const char *what)
{
    weft_stepper_config config = r->config;
    config.first_step = config.fixed_step > 0.0 ? config.first_step : h;
    trial_run *fresh = weft__begin(self, 1, config);
    fresh->t = r->t;
    memcpy(fresh->y, r->y, sizeof fresh->y);
    weft__good_step(self, r, r->t + h);
    weft__good_step(self, fresh, fresh->t + h);
    EXPECT(r->t != fresh->t || weft__same(self, r, fresh),
           "%s: a step of %.3g s gives another result than that of a new "
           "instance, of %.3g",
           what, h, weft__model_distance(r->y, fresh->y));
}

/* `also_y`: else y is left as it was, and an f that is kept for it is of another t. */
static void set_back(trial *self, bool also_y)
{
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.5);
    const trial_run before = *r;
    weft__good_step(self, r, 1.0);
    const double h = 0.5 * (r->t - before.t);
    r->t = before.t;
    if (also_y) {
        memcpy(r->y, before.y, sizeof r->y);
    }
    self->type->state_changed(r->self);
    if ((self->type->flags & WEFT_STEPPER_MULTISTEP) == 0) {
        as_a_fresh_one(self, r, h, also_y ? "t and y set back" : "t set back");
    }
    if (also_y) {
        weft__go(self, r, 1.0);
        weft__near_solution(self, r, "t and y set back at 0.5 s");
    }
}

void weft__a_step_is_taken_back(trial *self)
{
    set_back(self, true);
    set_back(self, false);
}

enum { BEYOND = 24, FILL = 0xA7 };

/* Fields within the caller's struct are written, no others. */
static void stats_fit(trial *self, const trial_run *r, size_t size)
{
    const weft_stepper_stats whole = weft__stats(r);
    union {
        weft_stepper_stats stats;
        unsigned char bytes[sizeof(weft_stepper_stats) + BEYOND];
    } out;
    memset(out.bytes, FILL, sizeof out.bytes);
    out.stats.struct_size = (uint32_t)size;
    self->type->stats(r->self, &out.stats);
    EXPECT(out.stats.struct_size == size, "struct_size was overwritten");
    EXPECT(out.stats.steps == whole.steps, "steps is not filled in");
    for (size_t b = size < sizeof whole ? size : sizeof whole; b < sizeof out.bytes;
         ++b) {
        EXPECT(out.bytes[b] == FILL,
               "the caller's struct has %zu bytes, byte %zu was written", size, b);
    }
}

void weft__stats_write_no_further(trial *self)
{
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.125);
    stats_fit(self, r, offsetof(weft_stepper_stats, rhs_calls));
    stats_fit(self, r, offsetof(weft_stepper_stats, last_step));
    stats_fit(self, r, sizeof(weft_stepper_stats));
    stats_fit(self, r, sizeof(weft_stepper_stats) + BEYOND);
}

void weft__stats_never_fall(trial *self)
{
    trial_run *r = weft__begin_usual(self, 0);
    weft_stepper_stats last = { 0 };
    for (int i = 0; r->t < 1.0; ++i) {
        r->model.fault = i % 7 == 6 ? REFUSE : NO_FAULT;
        (void)weft__step(r, 1.0);
        if (i % 5 == 4) {
            self->type->state_changed(r->self);
        }
        const weft_stepper_stats now = weft__stats(r);
        EXPECT(now.steps >= last.steps && now.rejected >= last.rejected
                   && now.rhs_calls >= last.rhs_calls,
               "a count fell at %.*g s: steps %" PRIu64 ", rejected %" PRIu64
               ", rhs_calls %" PRIu64,
               weft_text_digits(r->t), r->t, now.steps, now.rejected, now.rhs_calls);
        EXPECT(i < 100000, "100000 steps, and only at %.*g s", weft_text_digits(r->t),
               r->t);
        last = now;
    }
}

/* Two runs to 1 s, alone, in slots 0 and 1; two that have not begun in 2 and 3. */
static void pairs(trial *self)
{
    for (int i = 0; i < 4; ++i) {
        weft__begin_usual(self, i)->model.k = 1.0 + 3.7 * (i % 2);
    }
    weft__go(self, &self->runs[0], 1.0);
    weft__go(self, &self->runs[1], 1.0);
}

static void both_as_alone(trial *self, const char *how)
{
    for (int i = 0; i < 2; ++i) {
        EXPECT(weft__same(self, &self->runs[i], &self->runs[2 + i]),
               "two instances %s: results differ from those alone by %.3g", how,
               weft__model_distance(self->runs[i].y, self->runs[2 + i].y));
    }
}

void weft__two_instances_are_independent(trial *self)
{
    trial_run *mixed = &self->runs[2];
    pairs(self);
    for (int i = 0; mixed[0].t < 1.0 || mixed[1].t < 1.0; i = 1 - i) {
        if (mixed[i].t < 1.0) {
            weft__good_step(self, &mixed[i], 1.0);
        }
    }
    both_as_alone(self, "that step in turn");
}

static void *go_in_thread(void *ctx)
{
    trial_run *r = ctx;
    while (r->t < 1.0 && weft__step(r, 1.0) == WEFT_OK) {
    }
    weft__baton_drop(r->model.baton);
    return NULL;
}

void weft__two_threads_are_independent(trial *self)
{
    pairs(self);
    trial_run *here = &self->runs[2], *there = &self->runs[3];
    baton turns
        = { .lock = PTHREAD_MUTEX_INITIALIZER, .passed = PTHREAD_COND_INITIALIZER };
    here->model.baton = there->model.baton = &turns;
    there->model.side = 1;
    pthread_t thread;
    EXPECT(pthread_create(&thread, NULL, go_in_thread, there) == 0,
           "no thread could be started");
    (void)go_in_thread(here);
    (void)pthread_join(thread, NULL);
    EXPECT(here->t >= 1.0 && there->t >= 1.0, "a step in a thread failed: %s",
           (here->t >= 1.0 ? there : here)->err.message);
    both_as_alone(self, "in two threads");
}
