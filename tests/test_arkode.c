/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together */
/* test_arkode.c -- what plugins/arkode alone has: tables of the user's own, tables
 * whose last stage is not the next step's first, and steps cut short by frames. */
#include "stepper_run.h"

#include <unistd.h>

#ifdef HAVE_ARKODE

/* ---- tables of the user's own ---------------------------------------------------- */

static const double rk4_a[16] = { [4] = 0.5, [9] = 0.5, [14] = 1.0 };
static const double rk4_b[4] = { 1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6 };
static const double rk4_c[4] = { 0.0, 0.5, 0.5, 1.0 };
static const weft_butcher rk4 = { 4, 4, 0, rk4_a, rk4_b, rk4_c, NULL };

static weft_status custom(const weft_butcher *table, weft_stepper_config config,
                          weft_error *err)
{
    const weft_stepper_type *type = test_method_named("arkode/custom");
    const weft_ode ode = { .dim = DIM, .rhs = rhs };
    void *self = NULL;
    *err = (weft_error){ 0 };
    config.butcher = table;
    const weft_status status = type->create(type, &ode, &config, &self, err);
    ck_assert((self == NULL) == (status != WEFT_OK));
    type->destroy(self);
    return status;
}

static void says(const weft_butcher *table, weft_stepper_config config,
                 const char *what)
{
    weft_error err;
    ck_assert_int_eq(custom(table, config, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, what) != NULL, "%s", err.message);
}

START_TEST(a_custom_table_is_the_method_it_says)
{
    const weft_stepper_type *named = test_method_named("arkode/rk4");
    const weft_stepper_type *type = test_method_named("arkode/custom");
    weft_stepper_config config = fixed(0x1p-8);
    trial_run a, b;
    start(&a, named, &config);
    config.butcher = &rk4;
    start(&b, type, &config);
    go(&a, 1.0);
    go(&b, 1.0);
    SAME(a.y, b.y);
    ck_assert_uint_eq(a.model.calls, 4 * 256);
    ck_assert_uint_eq(b.model.calls, 4 * 256);
    end(&a);
    end(&b);
}
END_TEST

START_TEST(a_claim_of_too_high_an_order_names_the_condition)
{
    weft_butcher t = rk4;
    t.order = 5;
    says(&t, fixed(1e-3), "b is not of order 5: sum b_i c_i^4 = 1/5 does not hold");
    const double b[4] = { 1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 7 };
    t.b = b;
    says(&t, fixed(1e-3), "sum b_i = 1 does not hold");
    const double line[4] = { 0.0, 1.0, 0.0, 0.0 };
    t.b = line;
    says(&t, fixed(1e-3), "sum b_i c_i^2 = 1/3 does not hold");
    t.order = 2;
    weft_error err;
    ck_assert_int_eq(custom(&t, fixed(1e-3), &err), WEFT_OK);
    t = rk4;
    t.b_embedded = line;
    t.embedded_order = 2;
    ck_assert_int_eq(custom(&t, adaptive(1e-6), &err), WEFT_OK);
    t.embedded_order = 3;
    says(&t, adaptive(1e-6), "b_embedded is not of order 3: sum b_i c_i^2");
}
END_TEST

/* Each condition of order 4 and 5 alone tells a table from one of that order. */
START_TEST(good_tables_meet_every_condition)
{
    const double a[36]
        = { [6] = 1.0 / 5,        [12] = 3.0 / 40,         [13] = 9.0 / 40,
            [18] = 3.0 / 10,      [19] = -9.0 / 10,        [20] = 6.0 / 5,
            [24] = -11.0 / 54,    [25] = 5.0 / 2,          [26] = -70.0 / 27,
            [27] = 35.0 / 27,     [30] = 1631.0 / 55296,   [31] = 175.0 / 512,
            [32] = 575.0 / 13824, [33] = 44275.0 / 110592, [34] = 253.0 / 4096 };
    const double b[6] = { 37.0 / 378, 0, 250.0 / 621, 125.0 / 594, 0, 512.0 / 1771 };
    const double b4[6]
        = { 2825.0 / 27648, 0, 18575.0 / 48384, 13525.0 / 55296, 277.0 / 14336, 0.25 };
    const double c[6] = { 0, 0.2, 0.3, 0.6, 1, 0.875 };
    weft_butcher t = { 6, 5, 4, a, b, c, b4 };
    weft_error err;
    ck_assert_msg(custom(&t, adaptive(1e-6), &err) == WEFT_OK, "%s", err.message);
    double other[36]; /* the same row sum, but of no order above 3 */
    memcpy(other, a, sizeof a);
    other[18] += 0.01;
    other[19] -= 0.01;
    t.a = other;
    says(&t, fixed(1e-3), "does not hold");

    const weft_stepper_type *type = test_method_named("arkode/custom");
    weft_stepper_config config = adaptive(1e-8);
    t.a = a;
    config.butcher = &t;
    trial_run mine, theirs;
    start(&mine, type, &config);
    config.butcher = NULL;
    start(&theirs, test_method_named("arkode/cash_karp"), &config);
    go(&mine, 1.0);
    go(&theirs, 1.0);
    ck_assert_uint_eq(stats(&mine).steps, stats(&theirs).steps);
    ck_assert_double_le(distance(mine.y, theirs.y), 1e-12);
    end(&mine);
    end(&theirs);
}
END_TEST

START_TEST(what_is_no_table_is_refused)
{
    weft_butcher t = rk4;
    says(NULL, fixed(1e-3), "needs a Butcher table");
    says(&t, adaptive(1e-6), "needs fixed_step");
    t.stages = 0;
    says(&t, fixed(1e-3), "stages");
    t.stages = 257;
    says(&t, fixed(1e-3), "stages");
    t = rk4;
    t.order = 0;
    says(&t, fixed(1e-3), "order");
    t = rk4;
    t.c = NULL;
    says(&t, fixed(1e-3), "must be given");
    t = rk4;
    t.embedded_order = 3;
    says(&t, fixed(1e-3), "come together");
    t.b_embedded = rk4_b;
    says(&t, adaptive(1e-6), "b_embedded is b");
    double a[16];
    memcpy(a, rk4_a, sizeof a);
    t = rk4;
    t.a = a;
    a[9] = 0.49;
    says(&t, fixed(1e-3), "row 2 of A adds up to 0.49, but c[2] is 0.5");
    a[9] = (double)NAN;
    says(&t, fixed(1e-3), "row 2 of A");
    a[9] = 0.5;
    a[6] = 1e-3;
    says(&t, fixed(1e-3), "A[1][2] must be 0");
}
END_TEST

/* ---- steps ----------------------------------------------------------------------- */

/* Frames far shorter than the steps the tolerance asks for: one step each, and the step
 * size is not forgotten. */
START_TEST(short_frames_are_one_step_each)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!can_adapt(type) || type->order < 5) {
        return;
    }
    weft_stepper_config config = adaptive(1e-4);
    trial_run r, free_run;
    start(&free_run, type, &config);
    go(&free_run, 4.0);
    ck_assert_uint_lt(stats(&free_run).steps, 400);
    start(&r, type, &config);
    for (int frame = 1; frame <= 1000; ++frame) {
        go(&r, frame / 250.0);
    }
    ck_assert_uint_le(stats(&r).steps, 1004);
    ck_assert_double_le(error_at_end(&r), 1e-3);
    ck_assert_double_gt(stats(&r).next_step, 1.0 / 250.0);
    end(&r);
    end(&free_run);
}
END_TEST

/* Six evaluations for each step, and one at the start. */
START_TEST(steps_of_max_step_need_no_restart)
{
    for (int i = 0; i < 40; ++i) {
        weft_stepper_config config = adaptive(1e-2);
        config.first_step = config.max_step = 1e-3 * (1.0 + 0.0123 * i);
        trial_run r;
        start(&r, test_method_named("arkode/dormand_prince"), &config);
        for (int k = 0; k < 50; ++k) {
            ck_assert_int_eq(step(&r, 1e3), WEFT_OK);
            ck_assert_double_le(stats(&r).next_step, config.max_step * (1.0 + 1e-15));
        }
        ck_assert_uint_eq(stats(&r).rhs_calls, 6 * 50 + 1);
        end(&r);
    }
}
END_TEST

/* A state that is edited after every step, over frames of all lengths. */
START_TEST(needless_news_changes_no_bits_whatever_the_frames)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool multistep = (type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    for (int mode = 0; mode < 2 && !multistep && !test_is_spared(type); ++mode) {
        const weft_stepper_config config = usual(type, mode);
        trial_run quiet, told;
        start(&quiet, type, &config);
        start(&told, type, &config);
        double t_end = 0.0;
        for (int frame = 0; frame < 60; ++frame) {
            t_end += 0.0007 * pow(1.9, frame % 9);
            go(&quiet, t_end);
            while (told.t < t_end) {
                type->state_changed(told.self);
                ck_assert_int_eq(step(&told, t_end), WEFT_OK);
            }
            SAME(quiet.y, told.y);
        }
        ck_assert_uint_eq(stats(&quiet).steps, stats(&told).steps);
        ck_assert_uint_le(stats(&told).rhs_calls,
                          stats(&quiet).rhs_calls + stats(&told).steps);
        end(&quiet);
        end(&told);
    }
}
END_TEST

START_TEST(nothing_is_printed_when_arkode_fails)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    FILE *file = tmpfile();
    const int out = dup(1), err = dup(2);
    fflush(NULL);
    dup2(fileno(file), 1);
    dup2(fileno(file), 2);
    for (int mode = 0; mode < 2; ++mode) {
        for (fault kind = REFUSE; kind < FAULTS; ++kind) {
            const weft_stepper_config config = usual(type, mode);
            trial_run r;
            start(&r, type, &config);
            (void)step(&r, 1.0);
            r.model.fault = kind;
            (void)step(&r, 1.0);
            (void)step(&r, 1e-30);
            end(&r);
        }
    }
    fflush(NULL);
    const long printed = lseek(fileno(file), 0, SEEK_END);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    fclose(file);
    ck_assert_int_eq(printed, 0);
}
END_TEST

START_TEST(tolerances_below_roundoff_are_an_error)
{
    const weft_stepper_config config = adaptive(1e-30);
    trial_run r;
    start(&r, test_method_named("arkode/dormand_prince"), &config);
    ck_assert_int_eq(step(&r, 1.0), WEFT_STEP_TOO_SMALL);
    ck_assert(r.t == 0.0);
    SAME(r.y, y_start);
    end(&r);
}
END_TEST

START_TEST(memory_that_is_not_there_is_an_error)
{
    const weft_stepper_type *type = test_method_named("arkode/fehlberg87");
    const weft_stepper_config config = adaptive(1e-6);
    const size_t dims[] = { (size_t)1 << 40, SIZE_MAX - 1 };
    for (int i = 0; i < 2; ++i) {
        const weft_ode ode = { .dim = dims[i], .rhs = rhs };
        void *self = &self;
        ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL),
                         WEFT_NO_MEMORY);
        ck_assert_ptr_null(self);
    }
}
END_TEST

#endif

TEST_SUITE(arkode)
{
    Suite *suite = suite_create("arkode");
#ifdef HAVE_ARKODE
    TCase *tcase = tcase_create("arkode");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_test(tcase, a_custom_table_is_the_method_it_says);
    tcase_add_test(tcase, a_claim_of_too_high_an_order_names_the_condition);
    tcase_add_test(tcase, good_tables_meet_every_condition);
    tcase_add_test(tcase, what_is_no_table_is_refused);
    tcase_add_test(tcase, steps_of_max_step_need_no_restart);
    tcase_add_test(tcase, tolerances_below_roundoff_are_an_error);
    tcase_add_test(tcase, memory_that_is_not_there_is_an_error);
    suite_add_tcase(suite, tcase);
    add_for_every_method(suite, "frames", short_frames_are_one_step_each);
    add_for_every_method(suite, "bits",
                         needless_news_changes_no_bits_whatever_the_frames);
    add_for_every_method(suite, "silence", nothing_is_printed_when_arkode_fails);
#endif
    return suite;
}
