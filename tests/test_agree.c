/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_agree.c -- steppers of parts of a state: what they ask, how often, and which
 * methods refuse. That parts have the bits of the whole is a check of weft plugin-test,
 * which tests/test_steppers.c runs with every method. */
#include "stepper_run.h"

/* Answers for the others. */
typedef struct others {
    double factor; /* of what one stepper gives: theirs, if it is larger */
    bool failed;   /* theirs is NaN */
    uint64_t asked;
} others;

static double answer(void *self, double mine)
{
    others *o = self;
    ++o->asked;
    return o->failed ? (double)NAN : fmax(mine, o->factor * mine);
}

static bool agrees(const weft_stepper_type *type)
{
    return (type->flags & (uint32_t)WEFT_STEPPER_DISTRIBUTED) != 0;
}

static void start_with(trial_run *r, const weft_stepper_type *type,
                       weft_stepper_config config, const weft_agree *agree)
{
    config.agree = agree;
    start(r, type, &config);
}

/* Up to 1 s, alone and with others whose error is so many times as large. */
static void run_both(trial_run *alone, trial_run *together,
                     const weft_stepper_type *type, int mode, double factor)
{
    others o = { .factor = factor };
    const weft_agree agree = { &o, answer };
    start_with(alone, type, usual(type, mode), NULL);
    start_with(together, type, usual(type, mode), &agree);
    go(alone, 1.0);
    go(together, 1.0);
}

START_TEST(who_agrees_with_equals_does_what_one_alone_does)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2 && agrees(type); ++mode) {
        trial_run alone, together;
        run_both(&alone, &together, type, mode, 1.0);
        ck_assert_mem_eq(alone.y, together.y, sizeof alone.y);
        ck_assert_uint_eq(stats(&alone).rejected, stats(&together).rejected);
        ck_assert_uint_eq(alone.model.calls, together.model.calls);
        end(&alone);
        end(&together);
    }
}
END_TEST

static bool is_stabilised(const weft_stepper_type *type)
{
    return (type->flags & (uint32_t)WEFT_STEPPER_STRUCTURE) != 0;
}

/* A norm of y before a step, one of the error in every attempt, and the end; rkc2 asks
 * for the outcome of every RHS call, too. */
START_TEST(an_accepted_step_asks_three_times_with_error_control_and_once_without)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2 && agrees(type); ++mode) {
        others o = { .factor = 1.0 };
        const weft_agree agree = { &o, answer };
        trial_run r;
        start_with(&r, type, usual(type, mode), &agree);
        go(&r, 1.0);
        const weft_stepper_stats s = stats(&r);
        const bool adapts = mode == 0 && can_adapt(type);
        const uint64_t attempts = s.steps + s.rejected;
        ck_assert_uint_gt(s.steps, 3);
        ck_assert_uint_eq(o.asked, is_stabilised(type) ? s.rhs_calls + attempts
                                   : adapts            ? 2 * s.steps + attempts
                                                       : s.steps);
        end(&r);
    }
}
END_TEST

START_TEST(a_larger_error_of_others_makes_smaller_steps)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!agrees(type) || !can_adapt(type)) {
        return;
    }
    trial_run alone, together;
    run_both(&alone, &together, type, 0, 1000.0);
    ck_assert_uint_gt(stats(&together).steps, stats(&alone).steps);
    end(&alone);
    end(&together);
}
END_TEST

/* The others' failure is this one's, although its own numbers are all finite. */
START_TEST(a_failure_of_others_fails_the_step_and_leaves_the_state)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2 && agrees(type); ++mode) {
        others o = { .factor = 1.0 };
        const weft_agree agree = { &o, answer };
        trial_run r;
        start_with(&r, type, usual(type, mode), &agree);
        go(&r, 0.25);
        const trial_run before = r;
        o.failed = true;
        ck_assert_int_ne(step(&r, 1.0), WEFT_OK);
        ck_assert_mem_eq(r.y, before.y, sizeof r.y);
        ck_assert(r.t == before.t);
        ck_assert_uint_eq(stats(&r).rhs_calls, r.model.calls);
        o.failed = false;
        go(&r, 1.0);
        ck_assert_double_le(error_at_end(&r), allowed(type));
        end(&r);
    }
}
END_TEST

static void refused(const weft_stepper_type *type, weft_stepper_config config,
                    const char *reason)
{
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    const weft_structure structure = weft__model_structure(&m);
    weft_error err;
    void *self = &m;
    config = test_config(type, config);
    config.structure = weft__needs_structure(type) ? &structure : NULL;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
    ck_assert_ptr_null(self);
    ck_assert_msg(strstr(err.message, reason) != NULL, "%s", err.message);
}

START_TEST(create_refuses_what_cannot_be_agreed_on)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    others o = { .factor = 1.0 };
    const weft_agree whole = { &o, answer }, empty = { &o, NULL };
    weft_stepper_config config = usual(type, 0);
    config.agree = &whole;
    if (!agrees(type)) {
        refused(type, config, "cannot integrate a part of a state (agree)");
        return;
    }
    if (can_adapt(type)) {
        config.norm = WEFT_NORM_RMS;
        refused(type, config, "parts of a state need `rms` for the rms norm");
    }
    config.norm = WEFT_NORM_MAX;
    config.agree = &empty;
    refused(type, config, "agree without max");
}
END_TEST

START_TEST(explicit_methods_agree_but_not_those_of_gsl)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const char *label = test_method_label((size_t)_i);
    const bool one_of_them
        = strncmp(label, "verlet/", 7) == 0
          || (strncmp(label, "arkode/", 7) == 0
              && (type->flags & (WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_STRUCTURE)) == 0)
          || strcmp(label, "stiff/rkc2") == 0;
    ck_assert_int_eq(agrees(type), one_of_them);
}
END_TEST

TEST_SUITE(agree)
{
    Suite *suite = suite_create("agree");
    add_for_every_method(suite, "equals",
                         who_agrees_with_equals_does_what_one_alone_does);
    add_for_every_method(
        suite, "count",
        an_accepted_step_asks_three_times_with_error_control_and_once_without);
    add_for_every_method(suite, "norm", a_larger_error_of_others_makes_smaller_steps);
    add_for_every_method(suite, "failure",
                         a_failure_of_others_fails_the_step_and_leaves_the_state);
    add_for_every_method(suite, "refusals", create_refuses_what_cannot_be_agreed_on);
    add_for_every_method(suite, "methods", explicit_methods_agree_but_not_those_of_gsl);
    return suite;
}
