/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together */
/* test_sim.c -- a cloth under integration: frames, the state from outside, corrections,
 * failures, threads, pins on their way. */
#include "one_sim.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define ROWS         2
#define COLS         3
#define N            (ROWS * COLS)
#define VERLET       test_method_named("verlet/velocity_verlet")

/* The model of all tests, to be edited, and one simulation of it at a time. */
static weft_pin rest;
static weft_cloth_def model;
static double x[3 * N], v[3 * N];

static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = ROWS;
    model.cols = COLS;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 8.0, .damping = 0.05 };
    }
    rest = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    model.pins = &rest;
    model.pin_count = 1;
    model.damping = 0.02;
    model.velocity[2] = 0.5;
}

static weft_stepper_config fixed(double h)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = h;
    return config;
}

static void look(const weft_sim *at)
{
    weft_sim_positions(at, x);
    weft_sim_velocities(at, v);
}

static void start(const weft_stepper_type *method, weft_stepper_config config)
{
    teardown();
    cloth = test_cloth(&model);
    sim = test_sim(cloth, method, &config);
    look(sim);
}

static void go(double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
    ck_assert_double_eq(weft_sim_time(sim), t);
    look(sim);
}

static void same_bits(const weft_sim *a, const weft_sim *b)
{
    ck_assert_double_eq(weft_sim_time(a), weft_sim_time(b));
    ck_assert_mem_eq(weft_sim_state(a), weft_sim_state(b), 6 * N * sizeof(double));
}

/* ---- time ------------------------------------------------------------------------ */

START_TEST(simulation_starts_with_the_cloth_at_0)
{
    double y[6 * N];
    start(VERLET, fixed(0.1));
    weft_cloth_start(cloth, y);
    ck_assert_mem_eq(weft_sim_state(sim), y, sizeof y);
    ck_assert_double_eq(weft_sim_time(sim), 0.0);
    ck_assert(isnan(weft_sim_dissipated(sim))); /* no ledger */
    ck_assert_uint_eq(weft_sim_stats(sim).steps, 0);
    ck_assert_uint_eq(weft_cloth_pins(weft_sim_cloth(sim)), weft_cloth_pins(cloth));
}
END_TEST

START_TEST(frames_end_at_their_time_bit_for_bit)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_needs_damping(type) || test_is_spared(type)) {
        return;
    }
    const bool adapts = (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
    for (int mode = 0; mode < 1 + adapts; ++mode) {
        start(type, fixed(mode == 0 ? 0.007 : 0.0));
        for (int frame = 1; frame <= 40; ++frame) {
            go(frame / 30.0);
            const uint64_t steps = weft_sim_stats(sim).steps;
            go(frame / 30.0); /* is there: no step */
            ck_assert_uint_eq(weft_sim_stats(sim).steps, steps);
        }
        if (mode == 0
            && !test_adaptive_only(type)) { /* 4 of 7 ms and the rest of each 33.3 ms */
            ck_assert_uint_eq(weft_sim_stats(sim).steps, 40 * 5);
        }
    }
}
END_TEST

START_TEST(values_that_are_null_are_refused)
{
    weft_cloth_def nothing = model;
    weft_cloth *none = NULL;
    weft_error err = { 0 };
    size_t k = 7;
    start(VERLET, fixed(0.1));
    ck_assert_int_eq(weft_sim_add_shape(sim, NULL, &k, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "shapes[0] is NULL");
    ck_assert_uint_eq(k, 7);
    ck_assert_int_eq(weft_sim_move_pin(sim, 0, NULL, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "particle 0 has no position to go to: it is NULL");
    ck_assert_int_eq(weft_sim_save(sim, NULL, SIZE_MAX, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_restore(sim, NULL, SIZE_MAX, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "this is not a saved simulation");
    nothing.pins = NULL;
    nothing.pin_count = 1;
    ck_assert_int_eq(weft_cloth_create(&nothing, &none, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "pins is NULL, but their number is not 0");
    ck_assert_ptr_null(none);
}
END_TEST

START_TEST(times_in_messages_are_the_shortest_that_read_back)
{
    weft_error err = { 0 };
    start(VERLET, fixed(0.1));
    go(0.1);
    ck_assert_int_eq(weft_sim_step(sim, 0.05, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "step from 0.1 s to 0.05 s");
    ck_assert_int_eq(weft_sim_step(sim, 0.3 - 0.2, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "step from 0.1 s to 0.09999999999999998 s");
    const double values[] = { 0.1, 1.0 / 3.0, 5e-324, 1e300, 0.1 + 0.2, -2.5 };
    const char *texts[] = { "0.1",    "0.3333333333333333",  "5e-324",
                            "1e+300", "0.30000000000000004", "-2.5" };
    for (size_t i = 0; i < COUNT(values); ++i) {
        char text[32];
        (void)weft_text_format(text, sizeof text, "%.*g", weft_text_digits(values[i]),
                               values[i]);
        ck_assert_str_eq(text, texts[i]);
    }
}
END_TEST

START_TEST(time_does_not_run_back_nor_out_of_the_numbers)
{
    const double wrong[] = { 0.5, 0.25, -1.0, (double)NAN, (double)INFINITY };
    start(VERLET, fixed(0.125));
    go(0.5);
    for (size_t i = 0; i < COUNT(wrong); ++i) {
        weft_error err = { 0 };
        ck_assert_int_eq(weft_sim_step(sim, wrong[i], &err), WEFT_INVALID);
        ck_assert_int_eq(strncmp(err.message, "step from 0.5 s to ", 19), 0);
        const weft_status status = i == 0 ? WEFT_OK : WEFT_INVALID; /* is there */
        ck_assert_int_eq(weft_sim_advance(sim, wrong[i], NULL), status);
        ck_assert_double_eq(weft_sim_time(sim), 0.5);
    }
}
END_TEST

/* ---- the state from outside ------------------------------------------------------ */

START_TEST(states_are_copied_particle_by_particle)
{
    start(VERLET, fixed(0.1));
    const double *y = weft_sim_state(sim);
    double a[3 * N], b[3 * N];
    for (size_t j = 0; j < 3 * N; ++j) {
        a[j] = 100.0 + (double)j;
        b[j] = -(double)j;
    }
    memcpy(a, x, 3 * sizeof *a); /* particle 0 is pinned */
    memset(b, 0, 3 * sizeof *b);
    ck_assert_int_eq(weft_sim_set_state(sim, a, NULL, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_set_state(sim, NULL, b, NULL), WEFT_OK);
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq(y[k * N + i], a[3 * i + k]);
            ck_assert_double_eq(y[(3 + k) * N + i], b[3 * i + k]);
        }
    }
    look(sim);
    ck_assert_mem_eq(x, a, sizeof a);
    ck_assert_mem_eq(v, b, sizeof b);
    a[0] = b[0] = 77.0; /* a pinned particle keeps its own */
    ck_assert_int_eq(weft_sim_set_state(sim, a, b, NULL), WEFT_OK);
    ck_assert(y[0] == x[0] && y[3 * N] == 0.0);
    for (size_t bad = 0; bad < 6 * N; ++bad) {
        weft_error err = { 0 };
        char expected[96];
        const size_t j = bad % (3 * N);
        (void)snprintf(
            expected, sizeof expected,
            "a state must be finite: the %s of particle (%zu, %zu) has %c = %s",
            bad < 3 * N ? "position" : "velocity", j / 3 / COLS, j / 3 % COLS,
            "xyz"[j % 3], bad % 2 ? "nan" : "inf");
        memcpy(a, x, sizeof a);
        memcpy(b, v, sizeof b);
        a[3 * N - 1] = 5.0;
        *(bad < 3 * N ? &a[bad] : &b[bad - 3 * N])
            = bad % 2 ? (double)NAN : (double)INFINITY;
        ck_assert_int_eq(weft_sim_set_state(sim, a, b, &err), WEFT_INVALID);
        ck_assert_str_eq(err.message, expected);
        ck_assert_double_eq(y[3 * N - 1], x[3 * N - 1]);
    }
}
END_TEST

/* What came before it does not matter. */
START_TEST(run_goes_on_from_the_state_that_was_set)
{
    if (test_needs_damping(test_method((size_t)_i))
        || test_adaptive_only(test_method((size_t)_i))) { /* of another h */
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    const weft_stepper_config config = fixed(1e-3);
    start(type, config);
    go(0.02);
    weft_sim *other = test_sim(cloth, type, &config);
    v[3 * N - 1] += 1.0;
    ck_assert_int_eq(weft_sim_set_state(other, NULL, v, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_advance(other, 0.02, NULL), WEFT_OK);
    x[3 * N - 1] += 0.25;
    ck_assert_mem_ne(weft_sim_state(sim), weft_sim_state(other), 6 * N * sizeof *x);
    ck_assert_int_eq(weft_sim_set_state(other, x, v, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, NULL), WEFT_OK);
    same_bits(sim, other);
    go(0.04);
    ck_assert_int_eq(weft_sim_advance(other, 0.04, NULL), WEFT_OK);
    same_bits(sim, other);
    weft_sim_destroy(other);
}
END_TEST

/* ---- corrections ----------------------------------------------------------------- */

typedef struct visits {
    int count;
    double t;
} visits;

static bool halve_speed(void *ctx, double t, double h, double *y)
{
    visits *seen = ctx;
    ++seen->count;
    ck_assert_double_eq_tol(seen->t + h, t, 1e-15);
    seen->t = t;
    for (size_t j = 3 * N; j < 6 * N; ++j) {
        y[j] *= 0.5;
    }
    return true;
}

/* By the callback, and by hand after each step of another simulation. */
START_TEST(corrections_follow_each_step_and_are_seen_by_the_next)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    visits seen = { 0 };
    weft_sim *corrected = NULL;
    start(test_method((size_t)_i), fixed(1e-3));
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = test_method((size_t)_i);
    def.config = test_config(def.method, fixed(1e-3));
    def.correct = halve_speed;
    def.correct_ctx = &seen;
    ck_assert_int_eq(weft_sim_create(&def, &corrected, NULL), WEFT_OK);
    for (int step = 1; step <= 20; ++step) {
        ck_assert_int_eq(weft_sim_step(corrected, 1.0, NULL), WEFT_OK);
        ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
        weft_sim_velocities(sim, v);
        for (size_t j = 0; j < 3 * N; ++j) {
            v[j] *= 0.5;
        }
        ck_assert_int_eq(weft_sim_set_state(sim, NULL, v, NULL), WEFT_OK);
        ck_assert_int_eq(seen.count, step);
        ck_assert_double_eq(seen.t, weft_sim_time(corrected));
        same_bits(sim, corrected);
    }
    weft_sim_destroy(corrected);
}
END_TEST

/* ---- a stepper that does what it is told ------------------------------------------
 */

static struct {
    int changes; /* state_changed so far */
    bool fails, corrects;
    weft_stepper_type type;
} fake;

/* Lets a quarter of a second pass, and nothing else. */
static weft_status fake_step(void *self, double t_end, double *t, double *y,
                             weft_error *err)
{
    ck_assert(self != NULL && y != NULL);
    if (fake.fails) {
        return weft_error_set(err, WEFT_SOLVER, "no luck");
    }
    *t = fmin(t_end, *t + 0.25);
    return WEFT_OK;
}

static void fake_changed(void *self)
{
    ck_assert_ptr_nonnull(self);
    ++fake.changes;
}

static bool fake_correct(void *ctx, double t, double h, double *y)
{
    ck_assert(ctx == &fake && t > 0.0 && h == 0.25 && !fake.fails);
    y[4 * N - 1] *= fake.corrects ? 0.5 : 1.0;
    return fake.corrects;
}

/* Verlet with another step */
static void start_fake(void)
{
    teardown();
    cloth = test_cloth(&model);
    memset(&fake, 0, sizeof fake);
    fake.type = *VERLET;
    fake.type.step = fake_step;
    fake.type.state_changed = fake_changed;
    weft_sim_def def = { .struct_size = sizeof def,
                         .cloth = cloth,
                         .method = &fake.type,
                         .config = fixed(1.0) };
    def.correct = fake_correct, def.correct_ctx = &fake;
    ck_assert_int_eq(weft_sim_create(&def, &sim, NULL), WEFT_OK);
    look(sim);
}

START_TEST(stepper_hears_of_changes_and_of_nothing_else)
{
    start_fake();
    go(0.75);
    ck_assert_int_eq(fake.changes, 0);
    fake.corrects = true;
    go(1.25);
    ck_assert_int_eq(fake.changes, 2);
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, NULL), WEFT_OK);
    ck_assert_int_eq(fake.changes, 3);
}
END_TEST

START_TEST(failure_leaves_the_state_and_tells_where_it_hurts)
{
    weft_error err = { 0 };
    start_fake();
    x[3 * 2] += 0.5; /* (0, 2): the spring to (0, 1) is 1.5 times as long */
    memcpy(&v[3 * 5], (double[]){ 30.0, -40.0, 0.0 }, 3 * sizeof *v);
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, NULL), WEFT_OK);
    go(0.5);
    const uint64_t hash = weft_sim_measure(sim).hash;
    fake.fails = true;
    ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_SOLVER);
    ck_assert_int_eq(err.status, WEFT_SOLVER);
    ck_assert_str_eq(
        err.message,
        "no luck at t = 0.5 s; fastest particle (1, 2) at "
        "(2, -1, 0) m, 50 m/s; most strained stretch spring (0, 1)-(0, 2) at "
        "50 %; energy 63.24 J before that step");
    weft_failure failure;
    ck_assert(weft_sim_failure(sim, &failure));
    ck_assert_int_eq(failure.status, WEFT_SOLVER);
    ck_assert_str_eq(failure.reason, "no luck");
    ck_assert_double_eq(failure.time, 0.5);
    ck_assert_double_eq(failure.last_step, 0.0);
    ck_assert_int_eq(failure.spring.family, WEFT_STRETCH);
    ck_assert_uint_eq(failure.spring.p, 1);
    ck_assert_uint_eq(failure.spring.q, 2);
    ck_assert_double_eq_tol(failure.spring.strain, 0.5, 1e-12);
    ck_assert_uint_eq(failure.particle, 5);
    ck_assert_double_eq(failure.position[0], 2.0);
    ck_assert_double_eq(failure.position[1], -1.0);
    ck_assert_double_eq(failure.speed, 50.0);
    const weft_energy energy
        = weft_cloth_energy(cloth, weft_sim_time(sim), weft_sim_state(sim));
    ck_assert_double_eq_tol(failure.energy,
                            energy.kinetic + energy.gravitational + energy.elastic[0]
                                + energy.elastic[1] + energy.elastic[2],
                            1e-12);
    ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_SOLVER);
    ck_assert_double_eq(weft_sim_time(sim), 0.5);
    ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
    fake.fails = false; /* and it may go on */
    go(1.0);
    ck_assert(!weft_sim_failure(sim, &failure));
    memset(model.springs, 0, sizeof model.springs);
    start_fake();
    fake.fails = true;
    ck_assert_int_eq(weft_sim_step(sim, 1.0, &err), WEFT_SOLVER);
    ck_assert_ptr_nonnull(strstr(err.message, " m, 0.5 m/s; no springs; energy "));
}
END_TEST

/* With h w = 9 explicit Euler grows until numbers end. */
START_TEST(explosion_ends_in_the_last_finite_state)
{
    weft_error err = { 0 };
    start(test_method_named("verlet/euler"), fixed(0.5));
    ck_assert_int_eq(weft_sim_advance(sim, 1e4, &err), WEFT_NOT_FINITE);
    const double t = weft_sim_time(sim);
    ck_assert(t > 1.0 && t < 1e4);
    ck_assert_double_eq(t, 0.5 * (double)weft_sim_stats(sim).steps);
    for (size_t j = 0; j < 6 * N; ++j) {
        ck_assert(isfinite(weft_sim_state(sim)[j]));
    }
}
END_TEST

/* ---- threads --------------------------------------------------------------------- */

static void *run_alone(void *arg)
{
    weft_sim *mine = arg;
    double y[6 * N], dydt[6 * N], again[6 * N];
    (void)weft_sim_advance(mine, 0.5, NULL);
    memcpy(y, weft_sim_state(mine), sizeof y);
    (void)weft_cloth_rhs(cloth, 0.5, y, dydt);
    for (int i = 0; i < 2000; ++i) {
        if (weft_cloth_rhs(cloth, 0.5, y, again) != 0
            || memcmp(dydt, again, sizeof again) != 0) {
            return NULL;
        }
    }
    return memcmp(y, weft_sim_state(mine), sizeof y) == 0 ? mine : NULL;
}

START_TEST(threads_share_a_cloth_and_get_the_same_bits)
{
    weft_sim *sims[4];
    pthread_t threads[4];
    const weft_stepper_config config = fixed(1e-3);
    model.wind_drag = 0.3;
    start(VERLET, config);
    for (size_t i = 0; i < 4; ++i) {
        sims[i] = test_sim(cloth, VERLET, &config);
        ck_assert_int_eq(pthread_create(&threads[i], NULL, run_alone, sims[i]), 0);
    }
    go(0.5);
    for (size_t i = 0; i < 4; ++i) {
        void *pure = NULL;
        ck_assert_int_eq(pthread_join(threads[i], &pure), 0);
        ck_assert_ptr_eq(pure, sims[i]);
        same_bits(sims[i], sim);
        weft_sim_destroy(sims[i]);
    }
}
END_TEST

/* ---- pins -------------------------------------------------------------------- */

/* x' and x'' at the start of a step leave h^3 x''' / 6: h^2 (x''(t) - x''(0)) / 6 in
 * all, which no method of order 2 or more exceeds here. Those that solve equations do
 * so to an accuracy. */
START_TEST(pins_stay_on_their_way_or_do_not_move_at_all)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    const double h = 1e-3, w = 2.8 * acos(-1.0), order1 = h * w * 0.2;
    const double off = type->order < 2 ? order1 : order1 * h * w / 6.0;
    const double straight = (type->flags & WEFT_STEPPER_IMPLICIT) != 0 ? off : 1e-12;
    const weft_pin way = { .rows = { -1, -1 },
                           .cols = { 2, 2 },
                           .velocity = { 0.5, 0, -0.25 },
                           .amplitude = { 0, 0.2, 0 },
                           .frequency = 1.4 };
    const weft_pin pins[] = { rest, way };
    model.pins = pins;
    model.pin_count = 2;
    model.origin[0] = model.origin[1] = 0.1;
    start(type, fixed(h));
    const double from[] = { x[0], x[1], x[2] }, end[] = { x[15], x[16], x[17] };
    for (int frame = 1; frame <= 10; ++frame) {
        const double t = frame / 30.0;
        go(t);
        ck_assert_mem_eq(x, from, sizeof from);
        ck_assert(v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0);
        ck_assert_double_eq_tol(x[15], end[0] + 0.5 * t, straight);
        ck_assert_double_eq_tol(x[16], end[1] + 0.2 * sin(w * t), off);
        ck_assert_double_eq_tol(x[17], end[2] - 0.25 * t, straight);
    }
}
END_TEST

TEST_SUITE(sim)
{
    const int methods = (int)test_method_count();
    Suite *suite = suite_create("sim");
    TCase *tcase = tcase_create("sim");
    suite_add_tcase(suite, tcase);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, simulation_starts_with_the_cloth_at_0);
    tcase_add_loop_test(tcase, frames_end_at_their_time_bit_for_bit, 0, methods);
    tcase_add_test(tcase, times_in_messages_are_the_shortest_that_read_back);
    tcase_add_test(tcase, time_does_not_run_back_nor_out_of_the_numbers);
    tcase_add_test(tcase, values_that_are_null_are_refused);
    tcase_add_test(tcase, states_are_copied_particle_by_particle);
    tcase_add_loop_test(tcase, run_goes_on_from_the_state_that_was_set, 0, methods);
    tcase_add_loop_test(tcase, corrections_follow_each_step_and_are_seen_by_the_next, 0,
                        methods);
    tcase_add_test(tcase, stepper_hears_of_changes_and_of_nothing_else);
    tcase_add_test(tcase, failure_leaves_the_state_and_tells_where_it_hurts);
    tcase_add_test(tcase, explosion_ends_in_the_last_finite_state);
    tcase_add_test(tcase, threads_share_a_cloth_and_get_the_same_bits);
    tcase_add_loop_test(tcase, pins_stay_on_their_way_or_do_not_move_at_all, 0,
                        methods);
    return suite;
}
