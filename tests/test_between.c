/* SPDX-License-Identifier: BSD-3-Clause */
/* test_between.c -- states within a step, frames that do not cut steps, events. */
#include "one_sim.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ROWS = 3, COLS = 3, N = ROWS * COLS, DIM = 6 * N };

#define DORMAND_PRINCE test_method_named("arkode/dormand_prince")
#define VERLET         test_method_named("verlet/velocity_verlet")
#define RK8PD          test_method_named("gsl/rk8pd")

static weft_pin pins[2];
static weft_cloth_def model;
static weft_sim_def def;

static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = ROWS;
    model.cols = COLS;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 4.0, .damping = 0.02 };
    }
    pins[0] = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    pins[1] = (weft_pin){ .rows = { 0, 0 },
                          .cols = { -1, -1 },
                          .amplitude = { 0.1, 0.0, 0.05 },
                          .frequency = 0.5 };
    model.pins = pins;
    model.pin_count = 2;
    model.wind_velocity[2] = 1.0;
    model.wind_drag = 0.1;
    model.velocity[2] = 0.4;
    def = weft_sim_def_default();
    def.interpolate = true;
}

static void start(const weft_stepper_type *method, double fixed_step)
{
    weft_error err = { 0 };
    teardown();
    cloth = test_cloth(&model);
    def.cloth = cloth;
    def.method = method;
    def.config.fixed_step = fixed_step;
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
}

static void step(double t_end)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_step(sim, t_end, &err) == WEFT_OK, "%s", err.message);
}

static void between(double t, double y[DIM])
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_between(sim, t, y, &err) == WEFT_OK, "%s", err.message);
}

/* ---- states within a step ------------------------------------------------------- */

/* The state at t by a method of order 8 in many steps. */
static void solution(double t, double y[DIM])
{
    weft_error err = { 0 };
    start(RK8PD, t / 64.0);
    ck_assert_int_eq(weft_sim_advance(sim, t, &err), WEFT_OK);
    memcpy(y, weft_sim_state(sim), DIM * sizeof *y);
}

static double distance(const double *a, const double *b, size_t count)
{
    double most = 0.0;
    for (size_t i = 0; i < count; ++i) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

/* Largest error of positions and velocities at 0.37 of one step of h from the start. */
static double error_within(const weft_stepper_type *method, double h)
{
    double y[DIM], exact[DIM];
    solution(0.37 * h, exact);
    start(method, h);
    step(h);
    ck_assert_double_eq(weft_sim_time(sim), h);
    between(0.37 * h, y);
    return distance(y, exact, DIM);
}

/* An interpolant of order p - 1 has an error of h^p in one step. */
START_TEST(states_within_a_step_have_the_order_of_the_method_less_one)
{
    static const char *const names[]
        = { "verlet/velocity_verlet", "arkode/bogacki_shampine", "gsl/rk4",
            "arkode/dormand_prince",  "arkode/verner65",         "gsl/rk8pd" };
    const weft_stepper_type *method = test_method_named(names[_i]);
    const double h = method->order > 5 ? 0.1 : 0.05;
    const double slope = log2(error_within(method, h) / error_within(method, h / 2.0));
    ck_assert_msg(slope > (double)method->order - 0.3, "%s: %g", names[_i], slope);
}
END_TEST

START_TEST(a_resting_pin_keeps_its_bits_within_a_step)
{
    double y[DIM];
    start(DORMAND_PRINCE, 0.0);
    const double *now = weft_sim_state(sim);
    const double x[3] = { now[0], now[N], now[2 * N] };
    for (double t = 0.0; t < 0.5; t = weft_sim_time(sim)) {
        step(0.5);
        between(0.5 * (t + weft_sim_time(sim)), y);
        ck_assert(y[0] == x[0] && y[N] == x[1] && y[2 * N] == x[2]);
        ck_assert(y[3 * N] == 0.0 && y[4 * N] == 0.0 && y[5 * N] == 0.0);
    }
}
END_TEST

START_TEST(states_within_a_step_join_those_at_its_ends)
{
    double y[DIM], before[DIM];
    start(RK8PD, 0.0);
    for (int i = 0; i < 5; ++i) {
        const double t0 = weft_sim_time(sim);
        memcpy(before, weft_sim_state(sim), sizeof before);
        step(0.5);
        between(t0, y);
        ck_assert_double_lt(distance(y, before, DIM), 1e-13);
        between(nextafter(weft_sim_time(sim), 0.0), y);
        ck_assert_double_lt(distance(y, weft_sim_state(sim), DIM), 1e-13);
        between(weft_sim_time(sim), y);
        ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    }
}
END_TEST

START_TEST(times_outside_the_last_step_are_refused)
{
    double y[DIM];
    weft_error err = { 0 };
    start(DORMAND_PRINCE, 0.01);
    ck_assert_int_eq(weft_sim_between(sim, 0.0, y, &err), WEFT_OK);
    step(1.0);
    step(1.0);
    ck_assert_int_eq(weft_sim_between(sim, 0.005, y, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_between(sim, 0.025, y, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_between(sim, (double)NAN, y, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_between(sim, 0.015, y, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_set_state(sim, NULL, NULL, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_between(sim, 0.015, y, &err), WEFT_INVALID);
    def.interpolate = false;
    start(DORMAND_PRINCE, 0.01);
    step(1.0);
    ck_assert_int_eq(weft_sim_between(sim, 0.005, y, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "interpolate"));
}
END_TEST

static bool leave(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h, (void)y;
    return false;
}

START_TEST(corrections_after_steps_exclude_states_within_them)
{
    weft_error err = { 0 };
    start(DORMAND_PRINCE, 0.0);
    weft_sim *none = NULL;
    def.correct = leave;
    ck_assert_int_eq(weft_sim_create(&def, &none, &err), WEFT_UNSUPPORTED);
    def.correct = NULL;
    def.limit.method = WEFT_LIMIT_PROVOT;
    ck_assert_int_eq(weft_sim_create(&def, &none, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_null(none);
}
END_TEST

START_TEST(their_evaluations_are_counted_once_a_step)
{
    double y[DIM];
    start(DORMAND_PRINCE, 0.01);
    step(1.0);
    const uint64_t before = weft_sim_stats(sim).rhs_calls;
    between(0.002, y);
    ck_assert_uint_eq(weft_sim_stats(sim).rhs_calls, before + 2);
    between(0.007, y);
    ck_assert_uint_eq(weft_sim_stats(sim).rhs_calls, before + 2);
}
END_TEST

/* ---- frames -----------------------------------------------------------------------
 */

typedef struct film {
    const weft_run_def *run;
    size_t frames, between;
    double energy, worst_residual; /* [J] */
} film;

static weft_status on_frame(void *ctx, size_t i, weft_error *err)
{
    film *to = ctx;
    const double t = weft_run_frame_time(to->run, i);
    weft_error why = { 0 };
    ck_assert_double_eq(weft_sim_time(sim), t);
    if (weft_sim_is_between(sim)) {
        ++to->between;
        ck_assert_int_eq(weft_sim_set_state(sim, NULL, NULL, &why), WEFT_INVALID);
        ck_assert_int_eq(weft_sim_step(sim, 9.0, &why), WEFT_INVALID);
    }
    to->worst_residual = fmax(to->worst_residual, fabs(weft_sim_ledger(sim).residual));
    to->energy = weft_energy_total(weft_sim_measure(sim).energy);
    ++to->frames;
    (void)err;
    return WEFT_OK;
}

static film play(double fps, size_t checkpoint)
{
    weft_error err = { 0 };
    const weft_run_def run
        = { .duration = 0.5, .fps = fps, .threads = 1, .checkpoint = checkpoint };
    film made = { .run = &run };
    const weft_play frames = {
        .run = &run, .last = weft_run_last_frame(&run), .frame = on_frame, .ctx = &made
    };
    ck_assert_msg(weft_sim_play(sim, &frames, &err) == WEFT_OK, "%s", err.message);
    return made;
}

START_TEST(frames_from_within_steps_do_not_change_the_run)
{
    double y[DIM];
    start(DORMAND_PRINCE, 0.0);
    (void)play(2.0, 0);
    const uint64_t steps = weft_sim_stats(sim).steps;
    memcpy(y, weft_sim_state(sim), sizeof y);
    start(DORMAND_PRINCE, 0.0);
    const film dense = play(1000.0, 0);
    ck_assert_mem_eq(weft_sim_state(sim), y, sizeof y);
    ck_assert_uint_eq(weft_sim_stats(sim).steps, steps);
    ck_assert_uint_eq(dense.frames, 501);
    ck_assert_uint_gt(dense.between, 501 - steps - 2);
    def.interpolate = false;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_uint_eq(play(1000.0, 0).between, 0);
    ck_assert_uint_ge(weft_sim_stats(sim).steps, 500);
}
END_TEST

START_TEST(checkpoints_fall_on_the_end_of_a_step)
{
    start(DORMAND_PRINCE, 0.0);
    const film dense = play(1000.0, 100);
    ck_assert_uint_eq(dense.frames, 501);
    ck_assert_uint_gt(dense.between, 300);
    const uint64_t steps = weft_sim_stats(sim).steps;
    def.interpolate = true;
    start(DORMAND_PRINCE, 0.0);
    (void)play(10.0, 1);
    ck_assert_uint_eq(weft_sim_stats(sim).steps, steps);
}
END_TEST

START_TEST(the_ledger_closes_within_steps)
{
    def.ledger = true;
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = 1e-9;
    start(DORMAND_PRINCE, 0.0);
    const film dense = play(1000.0, 0);
    ck_assert_uint_gt(dense.between, 300);
    ck_assert_double_lt(dense.worst_residual, 1e-8 * fabs(dense.energy));
}
END_TEST

/* ---- events -----------------------------------------------------------------------
 */

/* [m] Of the last particle above `ctx`. */
static double height(void *ctx, const weft_cloth *of, double t, const double *y)
{
    (void)of, (void)t;
    return y[2 * N - 1] - *(const double *)ctx;
}

static double clock_of(void *ctx, const weft_cloth *of, double t, const double *y)
{
    (void)of, (void)y;
    return t < *(const double *)ctx ? 1.0 : -1.0;
}

static void fall(void)
{
    model.pin_count = 0;
    model.wind_drag = 0.0;
    model.velocity[2] = 0.0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].present = false;
    }
    def.interpolate = false;
}

START_TEST(an_event_ends_the_step_where_the_function_is_0)
{
    static const char *const names[]
        = { "verlet/velocity_verlet",  "arkode/dormand_prince", "gsl/rkf45",
            "arkode/bogacki_shampine", "gsl/msadams",           "cvode/bdf" };
    static double below = -2.0 - 0.5; /* [m]: it starts at -2 m */
    weft_error err = { 0 };
    const weft_stepper_type *method = test_method_named(names[_i]);
    fall();
    def.event = height;
    def.event_ctx = &below;
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = 1e-11;
    start(method, strcmp(names[_i], "verlet/velocity_verlet") == 0 ? 0.05 : 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
    ck_assert(weft_sim_event(sim));
    const double tolerance = strcmp(names[_i], "cvode/bdf") == 0 ? 1e-6 : 2e-10;
    ck_assert_double_eq_tol(weft_sim_time(sim), sqrt(2.0 * 0.5 / 9.81), tolerance);
    ck_assert_double_eq_tol(weft_sim_state(sim)[2 * N - 1], below, tolerance * 10.0);
    ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
    ck_assert(!weft_sim_event(sim));
    ck_assert_double_eq(weft_sim_time(sim), 1.0);
}
END_TEST

START_TEST(an_event_function_may_jump)
{
    static double moment = 0.31415926535;
    weft_error err = { 0 };
    def.event = clock_of;
    def.event_ctx = &moment;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
    ck_assert(weft_sim_time(sim) >= moment && weft_sim_time(sim) <= moment + 1e-10);
}
END_TEST

START_TEST(a_rise_is_no_event_and_neither_is_nan)
{
    static double above = 1e9, never = (double)NAN;
    weft_error err = { 0 };
    def.event = height; /* negative from the start */
    def.event_ctx = &above;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 0.5, &err), WEFT_OK);
    ck_assert_double_eq(weft_sim_time(sim), 0.5);
    def.event_ctx = &never;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 0.5, &err), WEFT_OK);
    ck_assert_double_eq(weft_sim_time(sim), 0.5);
}
END_TEST

START_TEST(a_function_that_never_falls_changes_no_bit)
{
    static double below = -1e9;
    double y[DIM];
    weft_error err = { 0 };
    def.interpolate = false;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 0.5, &err), WEFT_OK);
    memcpy(y, weft_sim_state(sim), sizeof y);
    def.event = height;
    def.event_ctx = &below;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_advance(sim, 0.5, &err), WEFT_OK);
    ck_assert_mem_eq(weft_sim_state(sim), y, sizeof y);
}
END_TEST

static weft_status on_any_frame(void *ctx, size_t i, weft_error *err)
{
    double *last = ctx; /* number, time */
    (void)err;
    last[0] = (double)i;
    last[1] = weft_sim_time(sim);
    return WEFT_OK;
}

/* Not from 0.1 to 0.2 s, but from 0.3 s on; h = 1/16 s. */
static double twice(void *ctx, const weft_cloth *of, double t, const double *y)
{
    (void)ctx, (void)of, (void)y;
    return (t > 0.1 && t < 0.2) || t > 0.3 ? -1.0 : 1.0;
}

START_TEST(an_event_that_must_hold_comes_so_long_after_it_began_also_when_saved)
{
    static unsigned char saved[65536];
    uint64_t hashes[2];
    weft_error err = { 0 };
    def.interpolate = _i == 1;
    def.event = twice;
    def.event_hold = 0.25;
    start(DORMAND_PRINCE, 0.0625);
    ck_assert_int_eq(weft_sim_advance(sim, 0.375, &err), WEFT_OK);
    ck_assert(!weft_sim_event(sim));
    ck_assert_int_eq(weft_sim_save(sim, saved, sizeof saved, &err), WEFT_OK);
    for (size_t i = 0; i < 2; ++i) {
        ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
        ck_assert(weft_sim_event(sim));
        ck_assert_double_eq_tol(weft_sim_time(sim), 0.3 + 0.25, 1e-10);
        hashes[i] = weft_sim_measure(sim).hash;
        ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
        ck_assert(!weft_sim_event(sim) && weft_sim_time(sim) == 1.0);
        const size_t size = weft_sim_save_size(sim);
        ck_assert_int_eq(weft_sim_restore(sim, saved, size, &err), WEFT_OK);
    }
    ck_assert_uint_eq(hashes[0], hashes[1]);
    def.event_hold = -1.0;
    ck_assert_int_eq(weft_sim_create(&def, &(weft_sim *){ NULL }, &err), WEFT_INVALID);
}
END_TEST

START_TEST(an_event_is_the_last_frame)
{
    static double moment = 0.1234;
    double last[2] = { 0.0, 0.0 };
    weft_error err = { 0 };
    const weft_run_def run = { .duration = 0.5, .fps = 100.0, .threads = 1 };
    const weft_play frames
        = { .run = &run, .last = 50, .frame = on_any_frame, .ctx = last };
    def.event = clock_of;
    def.event_ctx = &moment;
    def.interpolate = _i == 1;
    start(DORMAND_PRINCE, 0.0);
    ck_assert_int_eq(weft_sim_play(sim, &frames, &err), WEFT_OK);
    ck_assert(weft_sim_event(sim));
    ck_assert_double_eq(last[0], 13.0);
    ck_assert(last[1] >= moment && last[1] <= moment + 1e-10);
    ck_assert_double_eq(weft_sim_time(sim), last[1]);
}
END_TEST

TEST_SUITE(between)
{
    Suite *suite = suite_create("between");
    TCase *tcase = tcase_create("between");
    suite_add_tcase(suite, tcase);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(
        tcase, states_within_a_step_have_the_order_of_the_method_less_one, 0, 6);
    tcase_add_test(tcase, a_resting_pin_keeps_its_bits_within_a_step);
    tcase_add_test(tcase, states_within_a_step_join_those_at_its_ends);
    tcase_add_test(tcase, times_outside_the_last_step_are_refused);
    tcase_add_test(tcase, corrections_after_steps_exclude_states_within_them);
    tcase_add_test(tcase, their_evaluations_are_counted_once_a_step);
    tcase_add_test(tcase, frames_from_within_steps_do_not_change_the_run);
    tcase_add_test(tcase, checkpoints_fall_on_the_end_of_a_step);
    tcase_add_test(tcase, the_ledger_closes_within_steps);
    tcase_add_loop_test(tcase, an_event_ends_the_step_where_the_function_is_0, 0, 6);
    tcase_add_test(tcase, an_event_function_may_jump);
    tcase_add_test(tcase, a_rise_is_no_event_and_neither_is_nan);
    tcase_add_test(tcase, a_function_that_never_falls_changes_no_bit);
    tcase_add_loop_test(
        tcase, an_event_that_must_hold_comes_so_long_after_it_began_also_when_saved, 0,
        2);
    tcase_add_loop_test(tcase, an_event_is_the_last_frame, 0, 2);
    return suite;
}
