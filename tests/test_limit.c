/* SPDX-License-Identifier: BSD-3-Clause */
/* test_limit.c -- one limited spring: who moves how far, what the velocities become,
 * what is left alone, what is counted and refused. */
#include "limit_still.h"

/* ---- one spring --------------------------------------------------------------------
 */

static void stretch_pair(double to)
{
    start[3] = to;
    make();
    step(0.5);
}

START_TEST(two_loose_ends_share_by_inverse_mass)
{
    model.load_count = 1;
    loads[0] = (weft_load){ .mass = 1.0 };
    model.loads = loads;
    model.density = 0.0;
    model.mass = 0.5; /* and 1.5 with the load */
    wanted.limit.solver = _i == 0 ? WEFT_LIMIT_FAST : WEFT_LIMIT_SWEEP;
    stretch_pair(2.0); /* 0.9 m too long: a quarter of that, and three */
    ck_assert_double_eq_tol(x[0], 0.225, 1e-15);
    ck_assert_double_eq_tol(x[3], 1.325, 1e-15);
    ck_assert_double_eq_tol(apart(x, 0, 1), 1.1, 1e-15);
    ck_assert_double_eq_tol(1.5 * x[0] + 0.5 * x[3], 0.5 * 2.0, 1e-15);
    ck_assert_double_eq_tol(v[0], 0.225 / 0.5, 1e-15);
    ck_assert_double_eq_tol(v[3], -0.675 / 0.5, 1e-15);
    ck_assert_int_eq(edits, 1);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).sweeps, 1);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).corrected, 1);
}
END_TEST

START_TEST(a_pin_stays_and_the_loose_end_takes_all)
{
    model.pin_count = 1;
    stretch_pair(-3.0);
    ck_assert_mem_eq(x, start, 24);
    ck_assert(v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0);
    ck_assert_double_eq_tol(x[3], -1.1, 1e-15);
    ck_assert_double_eq_tol(v[3], 1.9 / 0.5, 1e-14);
}
END_TEST

START_TEST(a_spring_between_two_pins_is_told_and_blocks_nothing)
{
    model.cols = 4;
    model.scale = 1.5;
    pins[1].cols.first = pins[1].cols.last = 1;
    model.pin_count = 2;
    memcpy(start, (double[]){ 0, 0, 0, 1.5, 0, 0, 4, 0, 0, 4.5, 0, 0 }, 96);
    make();
    step(1.0);
    ck_assert_double_eq(apart(x, 0, 1), 1.5);
    ck_assert(apart(x, 1, 2) <= 1.1 * 1.001 && apart(x, 2, 3) <= 1.1 * 1.001);
    ck_assert_uint_eq(weft_sim_limit_held(sim), 1);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 0);
    const weft_spring worst = weft_sim_limit_worst(sim);
    ck_assert(worst.p == 0 && worst.q == 1 && worst.strain == 0.5);
    memcpy(start, x, 96); /* the others are short now: nothing to do */
    make();
    step(1.0);
    ck_assert_int_eq(edits, 0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).sweeps, 0);
}
END_TEST

START_TEST(kept_velocities_are_those_of_the_stepper)
{
    wanted.limit.keep_velocity = true;
    speed[3] = 0.25;
    stretch_pair(2.0);
    ck_assert_double_eq_tol(apart(x, 0, 1), 1.1, 1e-15);
    ck_assert(v[0] == 0.0 && v[3] == 0.25);
}
END_TEST

START_TEST(bridson_corrects_the_velocities_that_would_lead_too_far)
{
    wanted.limit.method = WEFT_LIMIT_BRIDSON;
    speed[0] = 1.0;
    speed[3] = 3.0; /* 1 m apart and in half a second 2 */
    stretch_pair(1.0);
    ck_assert(x[0] == 0.0 && x[3] == 1.0);
    ck_assert_double_eq_tol(v[0], 1.9, 1e-15); /* the impulses are equal */
    ck_assert_double_eq_tol(v[3], 2.1, 1e-15);
    ck_assert_double_eq_tol(x[3] + 0.5 * v[3] - x[0] - 0.5 * v[0], 1.1, 1e-15);
}
END_TEST

START_TEST(a_step_cut_short_makes_no_great_velocity)
{
    stretch_pair(2.0);
    const double usual = v[3];
    step(1e-9);
    ck_assert_double_eq(v[3], usual);
    step(1e-9);
    ck_assert_double_eq_tol(v[3], -0.45 / 1e-9, 1e3);
}
END_TEST

START_TEST(what_is_within_the_tolerance_is_left_alone)
{
    stretch_pair(1.1 * 1.0009);
    ck_assert(x[0] == 0.0 && x[3] == 1.1 * 1.0009);
    ck_assert_int_eq(edits, 0);
    stretch_pair(1.1 * 1.0011);
    ck_assert_double_eq_tol(apart(x, 0, 1), 1.1, 1e-15);
    ck_assert_int_eq(edits, 1);
}
END_TEST

static bool turn_up(void *ctx, double t, double h, double *y)
{
    (void)t, (void)h;
    ck_assert_double_eq_tol(y[1] - y[0], 1.1, 1e-15);
    y[3] = *(const double *)ctx;
    return true;
}

START_TEST(the_embedder_corrects_what_the_limit_has_left)
{
    double height = 7.0;
    wanted.correct = turn_up;
    wanted.correct_ctx = &height;
    stretch_pair(2.0);
    ck_assert_double_eq(x[4], 7.0);
    ck_assert_int_eq(edits, 1);
}
END_TEST

/* ---- what cannot be met ------------------------------------------------------------
 */

START_TEST(a_limit_that_is_not_met_is_counted)
{
    model.cols = 6; /* 5 m of springs between pins 8 m apart */
    model.scale = 1.6;
    model.pin_count = 2;
    for (size_t i = 0; i < 6; ++i) {
        start[3 * i] = 1.6 * (double)i;
    }
    wanted.limit.solver = _i == 0 ? WEFT_LIMIT_FAST : WEFT_LIMIT_SWEEP;
    wanted.limit.sweeps = 7;
    make();
    for (uint64_t n = 1; n <= 20; ++n) {
        step(0.1);
        ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, n);
        ck_assert_uint_eq(weft_sim_limit_stats(sim).sweeps, 7 * n);
        ck_assert(x[0] == 0.0 && x[15] == 8.0);
        ck_assert(weft_sim_limit_worst(sim).strain > 0.1);
        ck_assert(weft_sim_limit_worst(sim).strain < 8.0);
    }
}
END_TEST

/* ... after the step, whatever its velocities promise for the next. */
START_TEST(what_bridson_leaves_too_long_is_counted)
{
    wanted.limit.method = WEFT_LIMIT_BRIDSON;
    speed[0] = 1.0;
    speed[3] = 3.0;
    stretch_pair(1.0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).corrected, 1);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 0);
    speed[0] = speed[3] = 0.0;
    stretch_pair(2.0);
    ck_assert_double_eq(apart(x, 0, 1), 2.0);
    ck_assert_double_eq_tol(x[3] + 0.5 * v[3] - x[0] - 0.5 * v[0], 1.1, 1e-15);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 1);
    speed[0] = 1.0; /* the ends approach: there is nothing to correct, yet */
    speed[3] = -2.0;
    stretch_pair(2.0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).corrected, 0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 1);
}
END_TEST

START_TEST(what_contact_holds_back_is_counted)
{
    weft_shape wall = {
        .kind = WEFT_SPHERE, .at = { 1.5, 0.0, 0.0 }, .radius = 0.1, .friction = 0
    };
    model.pin_count = 1;
    model.contact.thickness = 0.01;
    model.contact.shapes = &wall;
    model.contact.shape_count = 1;
    stretch_pair(2.0);
    ck_assert(x[3] > 1.6 && x[3] < 2.0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 1);
    wall.at[1] = 1.0;
    stretch_pair(2.0);
    ck_assert_double_eq_tol(x[3], 1.1, 1e-15);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, 0);
}
END_TEST

START_TEST(wrong_definitions_are_refused)
{
    const weft_limit_def right = wanted.limit;
    weft_limit_def wrong[8];
    for (size_t i = 0; i < COUNT(wrong); ++i) {
        wrong[i] = right;
    }
    wrong[0].strain = -0.1;
    wrong[1].strain = (double)NAN;
    wrong[2].tolerance = 0.0;
    wrong[3].tolerance = (double)INFINITY;
    wrong[4].sweeps = 0;
    wrong[5].method = (weft_limit_method)7;
    wrong[6].solver = (weft_limit_solver)7;
    wrong[7].method = WEFT_LIMIT_BRIDSON;
    wrong[7].keep_velocity = true;
    cloth = test_cloth(&model);
    wanted.cloth = cloth;
    for (size_t i = 0; i < COUNT(wrong); ++i) {
        weft_error err = { 0 };
        wanted.limit = wrong[i];
        ck_assert_int_eq(weft_sim_create(&wanted, &sim, &err), WEFT_INVALID);
        ck_assert_int_eq(strncmp(err.message, "limit ", 6), 0);
        ck_assert_ptr_null(sim);
    }
}
END_TEST

TEST_SUITE(limit)
{
    Suite *all = suite_create("limit");
    TCase *tests = tcase_create("limit");
    tcase_set_timeout(tests, 120);
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_loop_test(tests, two_loose_ends_share_by_inverse_mass, 0, 2);
    tcase_add_test(tests, a_pin_stays_and_the_loose_end_takes_all);
    tcase_add_test(tests, a_spring_between_two_pins_is_told_and_blocks_nothing);
    tcase_add_test(tests, kept_velocities_are_those_of_the_stepper);
    tcase_add_test(tests, bridson_corrects_the_velocities_that_would_lead_too_far);
    tcase_add_test(tests, a_step_cut_short_makes_no_great_velocity);
    tcase_add_test(tests, what_is_within_the_tolerance_is_left_alone);
    tcase_add_test(tests, the_embedder_corrects_what_the_limit_has_left);
    tcase_add_loop_test(tests, a_limit_that_is_not_met_is_counted, 0, 2);
    tcase_add_test(tests, what_bridson_leaves_too_long_is_counted);
    tcase_add_test(tests, what_contact_holds_back_is_counted);
    tcase_add_test(tests, wrong_definitions_are_refused);
    suite_add_tcase(all, tests);
    return all;
}
