/* SPDX-License-Identifier: BSD-3-Clause */
/* test_event.c -- events within steps: what falls to 0 and comes back, what holds, and
 * what a run goes on from. */
#include "one_sim.h"

#include <math.h>
#include <string.h>

enum { N = 2, DIM = 6 * N };

#define GRAVITY 9.81 /* [m/s^2] */

static weft_pin pin;
static weft_cloth_def model;
static weft_sim_def def;

/* Two particles thrown up, without springs. */
static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = 1;
    model.cols = 2;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].present = false;
    }
    model.gravity[0] = model.gravity[2] = 0.0;
    model.gravity[1] = -GRAVITY;
    model.velocity[1] = 5.0;
    def = weft_sim_def_default();
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = 1e-9;
}

/* Two particles and a spring, the upper one pinned: x = sin(10 t) v / 10, no gravity.
 */
static void hang(double v)
{
    model.rows = 2;
    model.cols = 1;
    model.density = 0.0;
    model.mass = 1.0;
    model.spacing[0] = model.spacing[1] = 1.0;
    model.right[0] = 0.0, model.right[2] = 1.0;
    model.down[1] = -1.0, model.down[2] = 0.0;
    model.gravity[1] = 0.0;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0 };
    pin = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    model.pins = &pin;
    model.pin_count = 1;
    model.velocity[1] = -v;
}

static void start(const weft_stepper_type *method, double fixed_step)
{
    weft_error err = { 0 };
    teardown();
    cloth = test_cloth(&model);
    def.cloth = cloth;
    def.method = method;
    def.config.fixed_step
        = (method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 1e-3 : fixed_step;
    const weft_stepper_config given = def.config;
    def.config = test_config(method, given);
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    def.config = given;
}

static void advance(double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

/* [s] To which the time of an event is that of the solution. */
static double tolerance_of(const weft_stepper_type *method)
{
    return method->order == 1                               ? 4e-3
           : (method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 2e-5
                                                            : 1e-6;
}

/* One-step methods of order 1 and 2 take up to a second each to keep 1e-9. */
static bool spared(const weft_stepper_type *method)
{
    const uint32_t quick = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_MULTISTEP;
    const bool slow
        = method->order > 0 && method->order <= 2 && !(method->flags & quick);
    return test_is_spared(method) || test_needs_damping(method)
           || (test_rounds(1, 0) && slow);
}

/* ---- what comes back within a step ------------------------------------------------
 */

/* [m] Of the last particle, below and above *ctx. */
static double below(void *ctx, const weft_cloth *of, double t, const double *y)
{
    (void)of, (void)t;
    return *(const double *)ctx - y[2 * N - 1];
}

static double above(void *ctx, const weft_cloth *of, double t, const double *y)
{
    return -below(ctx, of, t, y);
}

START_TEST(a_ball_is_seen_where_it_rises_above_a_height_and_where_it_falls_back)
{
    static double height = 1.2, floor = 0.0;
    const weft_stepper_type *method = test_method((size_t)_i);
    if (spared(method)) {
        return;
    }
    def.event = below;
    def.event_ctx = &height;
    start(method, 0.0);
    advance(2.0);
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq_tol(weft_sim_time(sim),
                            (5.0 - sqrt(25.0 - 2.0 * GRAVITY * 1.2)) / GRAVITY,
                            tolerance_of(method) * 3.0);
    ck_assert(weft_sim_state(sim)[2 * N - 1] >= height);
    def.event = above; /* it starts there, rises and comes back */
    def.event_ctx = &floor;
    start(method, 0.0);
    advance(2.0);
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq_tol(weft_sim_time(sim), 10.0 / GRAVITY, tolerance_of(method));
    ck_assert(weft_sim_state(sim)[2 * N - 1] <= 0.0);
}
END_TEST

/* For 16 ms of each half period the strain is above the bound, by 0.001 at most. */
START_TEST(a_stop_sees_a_short_excursion)
{
    static weft_stop_def stop = { .quantity = WEFT_STOP_STRAIN, .bound = 0.3 };
    const weft_stepper_type *method = test_method((size_t)_i);
    if (spared(method)) {
        return;
    }
    if (method->order == 1) {
        return; /* its steps of 1 ms add or take away a percent */
    }
    hang(3.01);
    def.event = weft_stop_event;
    def.event_ctx = &stop;
    start(method, 0.0);
    advance(0.5);
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq_tol(weft_sim_time(sim), asin(0.3 / 0.301) / 10.0,
                            tolerance_of(method));
}
END_TEST

START_TEST(a_long_step_of_a_high_order_sees_it_too)
{
    static weft_stop_def stop = { .quantity = WEFT_STOP_STRAIN, .bound = 0.3 };
    hang(3.01);
    def.event = weft_stop_event;
    def.event_ctx = &stop;
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = 1e-3;
    start(test_method_named("gsl/rk8pd"), 0.0);
    advance(10.0);
    ck_assert_double_eq_tol(weft_sim_time(sim), asin(0.3 / 0.301) / 10.0, 2e-4);
}
END_TEST

START_TEST(a_ball_bounces_until_its_flights_are_short_parts_of_a_step)
{
    static const char *const names[] = { "gsl/rk8pd", "arkode/dormand_prince",
                                         "cvode/adams", "verlet/velocity_verlet" };
    static double floor = 0.0;
    double v = sqrt(2.0 * GRAVITY), exact = sqrt(2.0 / GRAVITY), velocities[3 * N];
    weft_error err = { 0 };
    model.origin[1] = 1.0;
    model.velocity[1] = 0.0;
    def.event = above;
    def.event_ctx = &floor;
    start(test_method_named(names[_i]), 0.0);
    for (int i = 0; i < 40; ++i) {
        advance(100.0);
        ck_assert_msg(weft_sim_event(sim), "bounce %d", i);
        ck_assert_double_eq_tol(weft_sim_time(sim), exact, _i == 2 ? 1e-4 : 1e-6);
        ck_assert(weft_sim_state(sim)[2 * N - 1] <= 0.0);
        weft_sim_velocities(sim, velocities);
        for (size_t k = 0; k < N; ++k) {
            velocities[3 * k + 1] *= -0.8;
        }
        ck_assert_int_eq(weft_sim_set_state(sim, NULL, velocities, &err), WEFT_OK);
        v *= 0.8;
        exact += 2.0 * v / GRAVITY;
    }
}
END_TEST

/* ---- what a run goes on from ------------------------------------------------------
 */

START_TEST(events_end_where_the_function_is_not_above_0)
{
    const weft_stepper_type *method = test_method((size_t)_i);
    if (spared(method)) {
        return;
    }
    hang(3.01);
    def.event = above;
    for (int k = 0; k < 6; ++k) {
        double height = -1.0 + 0.05 * (k - 3), before = -1.0;
        const double tolerance = pow(10.0, -2.0 - 0.7 * k);
        def.event_ctx = &height;
        def.config.rtol = def.config.atol_position = def.config.atol_velocity
            = tolerance;
        start(method, 0.0);
        for (int events = 0; weft_sim_time(sim) < 2.0;) {
            advance(2.0);
            if (weft_sim_event(sim)) {
                ck_assert_double_le(weft_sim_state(sim)[2 * N - 1], height);
                ck_assert_double_gt(weft_sim_time(sim), before + 1e-3);
                before = weft_sim_time(sim);
                ++events;
            }
            ck_assert_int_le(events, 5);
        }
    }
}
END_TEST

/* As states within it, and not only where steps end. */
START_TEST(what_must_hold_holds_within_steps_too)
{
    static weft_stop_def stop = { .quantity = WEFT_STOP_STRAIN, .bound = 0.3 };
    const double up = asin(0.3 / 0.301) / 10.0, period = 4.0 * atan(1.0) / 5.0;
    hang(3.01);
    def.event = weft_stop_event;
    def.event_ctx = &stop;
    def.event_hold = 0.015;
    start(test_method_named("gsl/rk8pd"), 0.0);
    advance(0.1);
    advance(period + 0.1); /* without a frame's end in the excursion */
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq_tol(weft_sim_time(sim), up + 0.015, 1e-6);
    def.event_hold = 0.017; /* it takes 16.3 ms */
    start(test_method_named("gsl/rk8pd"), 0.0);
    advance(2.0 * period);
    ck_assert(!weft_sim_event(sim));
}
END_TEST

/* The kinetic energy of a sum of two oscillations stays low for a while at a time. */
START_TEST(rest_is_counted_from_where_the_energy_fell)
{
    static weft_stop_def stop
        = { .quantity = WEFT_STOP_KINETIC, .bound = 0.5 * 0.01 * 3.01 * 3.01 };
    const double fell = acos(0.1) / 10.0; /* |cos(10 t)| < 0.1 for 20 ms */
    hang(3.01);
    def.event = weft_stop_event;
    def.event_ctx = &stop;
    def.event_hold = 0.0199;
    start(test_method_named(_i == 0 ? "arkode/dormand_prince" : "cvode/adams"), 0.0);
    advance(1.0);
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq_tol(weft_sim_time(sim), fell + 0.0199, 1e-6);
    def.event_hold = 0.0204;
    start(test_method_named(_i == 0 ? "arkode/dormand_prince" : "cvode/adams"), 0.0);
    advance(1.0);
    ck_assert(!weft_sim_event(sim));
}
END_TEST

/* The search evaluates too, and may be stopped then. */
typedef struct deadline {
    unsigned calls, last;
} deadline;

static bool passed(void *ctx)
{
    deadline *of = ctx;
    return ++of->calls > of->last;
}

START_TEST(a_search_that_is_stopped_leaves_the_start_of_the_step)
{
    static double height = 0.5;
    static deadline stop;
    double y[DIM];
    weft_error err = { 0 };
    unsigned failures = 0;
    def.event = below;
    def.event_ctx = &height;
    def.stop = passed;
    def.stop_ctx = &stop;
    for (unsigned last = 0; last < 400; ++last) {
        weft_status status = WEFT_OK;
        stop = (deadline){ 0, UINT32_MAX };
        start(test_method_named("gsl/rk8pd"), 0.0);
        stop = (deadline){ 0, last };
        for (double t = 0.0; status == WEFT_OK && !weft_sim_event(sim);) {
            memcpy(y, weft_sim_state(sim), sizeof y);
            t = weft_sim_time(sim);
            status = weft_sim_step(sim, 2.0, &err);
            ck_assert(status == WEFT_OK || status == WEFT_STOPPED);
            ck_assert(status == WEFT_OK || weft_sim_time(sim) == t);
        }
        if (status == WEFT_OK) {
            break;
        }
        ++failures;
        ck_assert_mem_eq(weft_sim_state(sim), y, sizeof y);
        stop.last = UINT32_MAX;
        advance(2.0);
        ck_assert_double_eq_tol(weft_sim_time(sim),
                                (5.0 - sqrt(25.0 - GRAVITY)) / GRAVITY, 1e-6);
    }
    ck_assert_uint_gt(failures, 20);
    ck_assert_uint_lt(failures, 400);
}
END_TEST

START_TEST(a_run_that_is_continued_has_the_same_events)
{
    static weft_stop_def stop = { .quantity = WEFT_STOP_STRAIN, .bound = 0.3 };
    static unsigned char saved[4096];
    weft_error err = { 0 };
    hang(3.01);
    def.event = weft_stop_event;
    def.event_ctx = &stop;
    def.event_hold = _i == 1 ? 0.01 : 0.0;
    start(test_method_named("arkode/dormand_prince"), 0.0);
    for (size_t steps = 0; !weft_sim_event(sim); ++steps) {
        ck_assert_int_eq(weft_sim_save(sim, saved, sizeof saved, &err), WEFT_OK);
        const size_t size = weft_sim_save_size(sim);
        ck_assert_int_eq(weft_sim_step(sim, 2.0, &err), WEFT_OK);
        const uint64_t hash = weft_sim_measure(sim).hash;
        const bool event = weft_sim_event(sim);
        ck_assert_int_eq(weft_sim_restore(sim, saved, size, &err), WEFT_OK);
        ck_assert_int_eq(weft_sim_step(sim, 2.0, &err), WEFT_OK);
        ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
        ck_assert(weft_sim_event(sim) == event);
        ck_assert_uint_lt(steps, 1000);
    }
}
END_TEST

TEST_SUITE(event)
{
    Suite *suite = suite_create("event");
    TCase *tcase = tcase_create("event"), *every = tcase_create("every method");
    suite_add_tcase(suite, tcase);
    suite_add_tcase(suite, every);
    tcase_set_timeout(every, 120.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_checked_fixture(every, setup, teardown);
    const int methods = (int)test_method_count();
    tcase_add_loop_test(
        every, a_ball_is_seen_where_it_rises_above_a_height_and_where_it_falls_back, 0,
        methods);
    tcase_add_loop_test(every, a_stop_sees_a_short_excursion, 0, methods);
    tcase_add_loop_test(every, events_end_where_the_function_is_not_above_0, 0,
                        methods);
    tcase_add_test(tcase, a_long_step_of_a_high_order_sees_it_too);
    tcase_add_loop_test(
        tcase, a_ball_bounces_until_its_flights_are_short_parts_of_a_step, 0, 4);
    tcase_add_test(tcase, what_must_hold_holds_within_steps_too);
    tcase_add_loop_test(tcase, rest_is_counted_from_where_the_energy_fell, 0, 2);
    tcase_add_test(tcase, a_search_that_is_stopped_leaves_the_start_of_the_step);
    tcase_add_loop_test(tcase, a_run_that_is_continued_has_the_same_events, 0, 2);
    return suite;
}
