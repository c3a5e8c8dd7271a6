/* SPDX-License-Identifier: BSD-3-Clause */
/* states.c -- edited states, statistics, and instances beside one another. */
#include "conformance/trial.h"

#include <pthread.h>

static void needless_changes_change_nothing(trial *self)
{
    const bool multistep = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    for (int mode = 0; mode < 2; ++mode) {
        trial_run *quiet = weft__begin(self, 0, weft__usual(self->type, mode));
        trial_run *told = weft__begin(self, 1, weft__usual(self->type, mode));
        if (quiet == NULL || told == NULL || !weft__go(self, quiet, 1.0)) {
            return;
        }
        while (told->t < 1.0) {
            if (!weft__good_step(self, told, 1.0)) {
                return;
            }
            self->type->state_changed(told->self);
        }
        (void)weft__expect(
            self,
            multistep
                || (weft__same(self, quiet, told)
                    && weft__stats(self, quiet).steps == weft__stats(self, told).steps),
            "state_changed after every step, and no change: another "
            "result, of %.3g",
            weft__model_distance(quiet->y, told->y));
        (void)weft__near(self, told, weft__error_at_end(told), 5e-3,
                         "state_changed after every step, and no change");
    }
}

static void an_edited_state_is_used(trial *self)
{
    for (int mode = 0; mode < 2; ++mode) {
        trial_run *r = weft__begin(self, 0, weft__usual(self->type, mode));
        if (r == NULL || !weft__go(self, r, 0.5)) {
            return;
        }
        r->y[0] -= 0.237;
        r->y[3] += 0.419;
        self->type->state_changed(r->self);
        double want[DIM];
        memcpy(want, r->y, sizeof want);
        weft__model_solve(0.5, 1.0, want);
        if (!weft__go(self, r, 1.0)) {
            return;
        }
        (void)weft__near(self, r, weft__model_distance(r->y, want),
                         weft__allowed(self->type), "y edited at 0.5 s");
    }
}

/* A step of h from t to t + h with the y that is there, and the same by an instance
 * that has no past. With error control the two may want different steps. */
static bool as_a_fresh_one(trial *self, trial_run *r, double h, const char *what)
{
    weft_stepper_config config = r->config;
    config.first_step = config.fixed_step > 0.0 ? config.first_step : h;
    trial_run *fresh = weft__begin(self, 1, config);
    if (fresh == NULL) {
        return false;
    }
    fresh->t = r->t;
    memcpy(fresh->y, r->y, sizeof fresh->y);
    if (!weft__good_step(self, r, r->t + h)
        || !weft__good_step(self, fresh, fresh->t + h)) {
        return false;
    }
    return weft__expect(self, r->t != fresh->t || weft__same(self, r, fresh),
                        "%s: a step of %.3g s gives another result than that of a new "
                        "instance, of %.3g",
                        what, h, weft__model_distance(r->y, fresh->y));
}

/* Taken back in part, y is left as it was: an f that is kept for it is of another t. */
static void a_step_is_taken_back(trial *self)
{
    const bool multistep = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    for (int mode = 0; mode < 4; ++mode) {
        trial_run *r = weft__begin(self, 0, weft__usual(self->type, mode / 2));
        if (r == NULL || !weft__go(self, r, 0.5)) {
            return;
        }
        const trial_run before = *r;
        if (!weft__good_step(self, r, 1.0)) {
            return;
        }
        const double h = 0.5 * (r->t - before.t);
        const char *what = mode % 2 == 0 ? "t and y set back" : "t set back";
        r->t = before.t;
        if (mode % 2 == 0) {
            memcpy(r->y, before.y, sizeof r->y);
        }
        self->type->state_changed(r->self);
        if (!multistep && !as_a_fresh_one(self, r, h, what)) {
            return;
        }
        if (mode % 2 == 0 && weft__go(self, r, 1.0)) {
            (void)weft__near(self, r, weft__error_at_end(r), weft__allowed(self->type),
                             "t and y set back at 0.5 s");
        }
    }
}

enum { BEYOND = 24, FILL = 0xA7 };

/* Fields beyond what the caller has are not written, the others are. */
static bool stats_fit(trial *self, const trial_run *r, size_t size)
{
    const weft_stepper_stats whole = weft__stats(self, r);
    union {
        weft_stepper_stats stats;
        unsigned char bytes[sizeof(weft_stepper_stats) + BEYOND];
    } out;
    memset(out.bytes, FILL, sizeof out.bytes);
    out.stats.struct_size = (uint32_t)size;
    self->type->stats(r->self, &out.stats);
    if (!weft__expect(self, out.stats.struct_size == size,
                      "struct_size was overwritten")
        || !weft__expect(self, out.stats.steps == whole.steps,
                         "steps is not filled in")) {
        return false;
    }
    for (size_t b = size < sizeof whole ? size : sizeof whole; b < sizeof out.bytes;
         ++b) {
        if (!weft__expect(self, out.bytes[b] == FILL,
                          "the caller's struct has %zu bytes, byte %zu was written",
                          size, b)) {
            return false;
        }
    }
    return true;
}

static void stats_write_no_further(trial *self)
{
    const size_t sizes[]
        = { offsetof(weft_stepper_stats, rhs_calls),
            offsetof(weft_stepper_stats, last_step), sizeof(weft_stepper_stats),
            sizeof(weft_stepper_stats) + BEYOND };
    trial_run *r = weft__begin(self, 0, weft__usual(self->type, 0));
    if (r == NULL || !weft__go(self, r, 0.125)) {
        return;
    }
    for (int i = 0; i < 4 && stats_fit(self, r, sizes[i]); ++i) {
    }
}

static void stats_never_fall(trial *self)
{
    trial_run *r = weft__begin(self, 0, weft__usual(self->type, 0));
    weft_stepper_stats last = { 0 };
    for (int i = 0; r != NULL && r->t < 1.0; ++i) {
        r->model.fault = i % 7 == 6 ? REFUSE : NO_FAULT;
        r->model.at = 0;
        (void)weft__step(self, r, 1.0);
        r->model.fault = NO_FAULT;
        if (i % 5 == 4) {
            self->type->state_changed(r->self);
        }
        const weft_stepper_stats now = weft__stats(self, r);
        if (!weft__expect(self,
                          now.steps >= last.steps && now.rejected >= last.rejected
                              && now.rhs_calls >= last.rhs_calls,
                          "a count fell at %.17g s: steps %llu, rejected %llu, "
                          "rhs_calls %llu",
                          r->t, (unsigned long long)now.steps,
                          (unsigned long long)now.rejected,
                          (unsigned long long)now.rhs_calls)
            || !weft__expect(self, i < 100000, "100000 steps, and only at %.17g s",
                             r->t)) {
            return;
        }
        last = now;
    }
}

/* Two alone in slots 0 and 1, two in 2 and 3 that have not begun. */
static bool pairs(trial *self)
{
    for (int i = 0; i < SLOTS; ++i) {
        trial_run *r = weft__begin(self, i, weft__usual(self->type, 0));
        if (r == NULL) {
            return false;
        }
        r->model.k = 1.0 + 3.7 * (i % 2);
    }
    return weft__go(self, &self->runs[0], 1.0) && weft__go(self, &self->runs[1], 1.0);
}

static void both_as_alone(trial *self, const char *how)
{
    for (int i = 0; i < 2; ++i) {
        (void)weft__expect(self, weft__same(self, &self->runs[i], &self->runs[2 + i]),
                           "two instances %s: another result than alone, of %.3g", how,
                           weft__model_distance(self->runs[i].y, self->runs[2 + i].y));
    }
}

static void two_instances_are_independent(trial *self)
{
    trial_run *mixed = &self->runs[2];
    if (!pairs(self)) {
        return;
    }
    while (mixed[0].t < 1.0 || mixed[1].t < 1.0) {
        for (int i = 0; i < 2; ++i) {
            if (mixed[i].t < 1.0 && !weft__good_step(self, &mixed[i], 1.0)) {
                return;
            }
        }
    }
    both_as_alone(self, "step by turns");
}

typedef struct thread_run {
    const trial *self;
    trial_run *r;
    weft_status status;
} thread_run;

static void *go_in_thread(void *ctx)
{
    thread_run *mine = ctx;
    while (mine->r->t < 1.0 && mine->status == WEFT_OK) {
        mine->status = weft__step(mine->self, mine->r, 1.0);
    }
    weft__baton_drop(mine->r->model.baton);
    return NULL;
}

static void two_threads_are_independent(trial *self)
{
    if (!pairs(self)) {
        return;
    }
    thread_run here = { .self = self, .r = &self->runs[2] };
    thread_run there = { .self = self, .r = &self->runs[3] };
    baton turns
        = { .lock = PTHREAD_MUTEX_INITIALIZER, .passed = PTHREAD_COND_INITIALIZER };
    here.r->model.baton = there.r->model.baton = &turns;
    there.r->model.side = 1;
    pthread_t thread;
    if (!weft__expect(self, pthread_create(&thread, NULL, go_in_thread, &there) == 0,
                      "no thread could be started")) {
        return;
    }
    (void)go_in_thread(&here);
    (void)pthread_join(thread, NULL);
    (void)weft__expect(self, here.status == WEFT_OK && there.status == WEFT_OK,
                       "a step in a thread failed: %s",
                       here.status == WEFT_OK ? there.r->err.message
                                              : here.r->err.message);
    both_as_alone(self, "in two threads");
}

const check weft__state_checks[]
    = { { .name = "needless",
          .promise
          = "state_changed without a change changes no result of a one-step method",
          .run = needless_changes_change_nothing },
        { .name = "edited",
          .promise = "the step after state_changed starts from the edited y",
          .run = an_edited_state_is_used },
        { .name = "set back",
          .promise
          = "the step after state_changed starts from the t and y that are set back",
          .run = a_step_is_taken_back },
        { .name = "stats",
          .promise = "stats fills what the caller's struct has, and no byte more",
          .run = stats_write_no_further },
        { .name = "counts",
          .promise = "counts never fall, whatever fails or is edited",
          .run = stats_never_fall },
        { .name = "instances",
          .promise = "instances that step by turns have the results they have alone",
          .run = two_instances_are_independent },
        { .name = "threads",
          .promise = "instances in two threads have the results they have alone",
          .run = two_threads_are_independent },
        { 0 } };
