/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_stiff.c -- plugin stiff, and the stabilised methods of arkode, on cloth: orders,
 * cost, refusals, and the features of a simulation. What holds for every method is in
 * test_steppers.c. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../bench/problem.h"

enum { SIDE = 6, N = SIDE * SIDE };

static weft_cloth_def model;
static weft_cloth *cloth;
static weft_sim *sim;
static weft_sim_def run;
static weft_error err;
static weft_linear linear;

/* P(6) with its modes damped more than critically. */
static void setup(void)
{
    model = problem(SIDE);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].damping = 0.02 * model.springs[f].stiffness;
    }
    run = weft_sim_def_default();
    linear = (weft_linear){ .struct_size = sizeof linear };
}

static void teardown(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    sim = NULL, cloth = NULL;
}

static bool is_there(const char *method)
{
    for (size_t i = 0; i < test_method_count(); ++i) {
        if (strcmp(test_method_label(i), method) == 0) {
            return true;
        }
    }
    printf("%s skipped: it needs SUNDIALS 7.2\n", method);
    return false;
}

static weft_status create(const char *method)
{
    teardown();
    cloth = test_cloth(&model);
    run.cloth = cloth;
    run.method = test_method_named(method);
    return weft_sim_create(&run, &sim, &err);
}

static void start(const char *method)
{
    ck_assert_msg(create(method) == WEFT_OK, "%s", err.message);
}

static void go(double t)
{
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

static void final_state(const char *method, double h, double *y)
{
    run.config.fixed_step = h;
    start(method);
    go(0.25);
    memcpy(y, weft_sim_state(sim), 6 * (size_t)N * sizeof *y);
}

/* Of positions [m]. */
static double distance(const double *a, const double *b)
{
    double most = 0.0;
    for (size_t i = 0; i < 3 * (size_t)N; ++i) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

/* ---- orders and cost ------------------------------------------------------------- */

/* A stabilised method has as many stages with h as with h / 2. */
static const struct {
    const char *method;
    double h, order;
} orders[] = { { "stiff/rkc2", 1.0 / 512, 2.0 },
               { "stiff/ros2", 1.0 / 4096, 2.0 },
               { "stiff/backward_euler", 1.0 / 1024, 1.0 },
               { "arkode/rkc", 1.0 / 512, 2.0 },
               { "arkode/rkl", 1.0 / 2048, 2.0 } };
enum { ORDERS = sizeof orders / sizeof *orders };

/* With the filtered matrix, which is not that of the cloth. */
START_TEST(order_on_cloth)
{
    static double y[2][6 * N], reference[6 * N];
    if (!is_there(orders[_i].method)) {
        return;
    }
    linear.krylov = 1e-10;
    run.config.linear = _i == 1 || _i == 2 ? &linear : NULL;
    final_state(orders[_i].method, orders[_i].h / 32.0, reference);
    for (int k = 0; k < 2; ++k) {
        final_state(orders[_i].method, orders[_i].h / (1 << k), y[k]);
    }
    const double order = log2(distance(y[0], reference) / distance(y[1], reference));
    ck_assert_double_eq_tol(order, orders[_i].order, 0.1);
}
END_TEST

/* Right-hand sides to 0.05 s of springs 1000 times as stiff, and the state there. */
static uint64_t calls(const char *method, double *y)
{
    run.config.rtol = 0.0;
    run.config.atol_position = 1e-3;
    run.config.atol_velocity = 1e-1;
    run.config.first_step = 1e-5;
    start(method);
    go(0.05);
    memcpy(y, weft_sim_state(sim), 6 * (size_t)N * sizeof *y);
    return weft_sim_stats(sim).rhs_calls;
}

static void make_overdamped(void)
{
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].stiffness *= 1e3;
        model.springs[f].damping = 5e-3 * model.springs[f].stiffness;
    }
}

/* The reference: ros2 with tolerances a thousand times as small. */
START_TEST(damping_that_binds_explicit_steps_costs_little)
{
    static double y[6 * N], reference[6 * N];
    make_overdamped();
    run.config.fixed_step = 1e-5;
    start("stiff/ros2");
    go(0.05);
    memcpy(reference, weft_sim_state(sim), sizeof reference);
    run.config.fixed_step = 0.0;
    const double w2 = weft_cloth_stiffness(cloth, 0.0, reference).damping;
    const double explicit_steps = 0.05 * w2 / 3.3; /* of 6 calls each */
    ck_assert_double_gt(6.0 * explicit_steps, 30.0 * (double)calls("stiff/rkc2", y));
    ck_assert_double_le(distance(y, reference), 5e-3);
    ck_assert_double_gt(6.0 * explicit_steps, 30.0 * (double)calls("stiff/ros2", y));
    ck_assert_double_le(distance(y, reference), 5e-3);
    ck_assert_uint_gt(weft_sim_stats(sim).linear_iterations, 0);
    ck_assert_uint_eq(weft_sim_stats(sim).factorisations, weft_sim_stats(sim).steps);
    ck_assert_uint_eq(weft_sim_stats(sim).newton_failures, 0);
}
END_TEST

static const char *const stabilised[] = { "arkode/rkc", "arkode/rkl" };

/* With equal steps rkc is rkc2 but for roundoff: the same polynomials, as many stages.
 */
START_TEST(stabilised_methods_agree_with_rkc2)
{
    static double own[6 * N], theirs[6 * N];
    if (!is_there(stabilised[_i])) {
        return;
    }
    make_overdamped();
    final_state("stiff/rkc2", 1.0 / 512, own);
    const uint64_t own_calls = weft_sim_stats(sim).rhs_calls;
    final_state(stabilised[_i], 1.0 / 512, theirs);
    ck_assert_double_le(distance(own, theirs), _i == 0 ? 1e-10 : 1e-4);
    ck_assert_uint_le(weft_sim_stats(sim).rhs_calls, own_calls * 5 / 4);
    run.config.fixed_step = 0.0;
    const uint64_t own_adaptive = calls("stiff/rkc2", own);
    ck_assert_uint_le(calls(stabilised[_i], theirs), own_adaptive * 3 / 2);
    ck_assert_double_le(distance(own, theirs), 5e-3);
}
END_TEST

/* ---- refusals -------------------------------------------------------------------- */

static void refused(const char *method, const char *why)
{
    ck_assert_int_ne(create(method), WEFT_OK);
    ck_assert_msg(strstr(err.message, why) != NULL, "%s", err.message);
}

START_TEST(stabilised_methods_refuse_lightly_damped_cloth)
{
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].damping = 1e-4 * model.springs[f].stiffness;
    }
    refused("stiff/rkc2", "velocity_verlet");
    for (size_t i = 0; i < 2 && is_there(stabilised[i]); ++i) {
        refused(stabilised[i], "velocity_verlet");
    }
    start("stiff/ros2");
    go(0.1);
}
END_TEST

START_TEST(fixed_steps_that_are_not_stable_are_refused)
{
    static const char *const all[] = { "stiff/rkc2", "arkode/rkc", "arkode/rkl" };
    if (!is_there(all[_i])) {
        return;
    }
    run.config.fixed_step = 0.06; /* 3 times the damping time */
    start(all[_i]);
    ck_assert_int_eq(weft_sim_step(sim, 1.0, &err), WEFT_UNSUPPORTED);
    ck_assert_msg(strstr(err.message, "not stable") != NULL, "%s", err.message);
    ck_assert(weft_sim_time(sim) == 0.0);
}
END_TEST

START_TEST(wrong_settings_of_linear_systems_are_refused)
{
    run.config.linear = &linear;
    refused("stiff/rkc2", "no linear systems");
    linear.krylov = 1.0;
    refused("stiff/ros2", "krylov");
    linear.krylov = NAN;
    refused("stiff/ros2", "krylov");
    linear.krylov = 0.0;
    linear.preconditioner = (weft_preconditioner)7;
    refused("stiff/ros2", "preconditioner");
    linear.preconditioner = WEFT_PRECONDITIONER_JACOBI;
    linear.jacobian = WEFT_JACOBIAN_NEWTON;
    refused("stiff/ros2", "one Jacobian");
    linear.jacobian = WEFT_JACOBIAN_STEP;
    linear.max_order = 2;
    refused("stiff/ros2", "one order");
    linear.max_order = 0;
    start("stiff/ros2");
}
END_TEST

static void keep_krylov(void *ctx, const char *name, const char *value)
{
    if (strcmp(name, "krylov") == 0) {
        (void)snprintf(ctx, 32, "%s", value);
    }
}

START_TEST(numbers_are_reported_as_written)
{
    char krylov[32] = "";
    linear.krylov = 0.1;
    run.config.linear = &linear;
    start("stiff/ros2");
    weft_sim_options(sim, keep_krylov, krylov);
    ck_assert_str_eq(krylov, "0.1");
}
END_TEST

/* ---- with the features of a simulation ------------------------------------------- */

static const char *const methods[]
    = { "stiff/rkc2", "stiff/ros2", "stiff/backward_euler", "arkode/rkc",
        "arkode/rkl" };
enum { METHODS = sizeof methods / sizeof *methods };

static void usual(int method)
{
    run.config.fixed_step = method == 2 ? 1e-3 : 0.0;
}

static double at(size_t i, size_t k)
{
    return weft_sim_state(sim)[k * N + i];
}

static void position(size_t i, double x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = at(i, k);
    }
}

START_TEST(moved_pins_keep_to_their_way)
{
    static const weft_pin pins[]
        = { { { 0, 0 }, { 0, 0 }, .velocity = { 0.2, 0, 0.1 } },
            { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    const double up[3] = { 0.0, 0.5, 0.0 };
    double before[3];
    if (!is_there(methods[_i])) {
        return;
    }
    model.pins = pins;
    usual(_i);
    start(methods[_i]);
    position(0, before);
    go(0.1);
    ck_assert_double_eq_tol(at(0, 0), before[0] + 0.02, 1e-12);
    ck_assert_double_eq_tol(at(0, 2), before[2] + 0.01, 1e-12);
    ck_assert_int_eq(weft_sim_pin(sim, 20, up, &err), WEFT_OK);
    position(20, before);
    go(0.2);
    ck_assert_double_eq_tol(at(20, 1), before[1] + 0.05, 1e-12);
    ck_assert_int_eq(weft_sim_unpin(sim, 20, &err), WEFT_OK);
    go(0.3);
    ck_assert_double_lt(at(20, 1), before[1] + 0.09); /* it falls */
}
END_TEST

/* The limit changes velocities by strain / h: where their tolerance is as small as that
 * of positions, that is an error which grows as h shrinks. */
START_TEST(strain_limit_holds)
{
    if (!is_there(methods[_i])) {
        return;
    }
    run.limit.method = WEFT_LIMIT_PROVOT;
    run.limit.strain = 0.02;
    run.config.atol_position = 1e-4;
    run.config.atol_velocity = 1e-2;
    usual(_i);
    start(methods[_i]);
    go(0.3);
    ck_assert_uint_gt(weft_sim_limit_stats(sim).sweeps, 0);
    const weft_spring worst = weft_cloth_worst_spring(cloth, weft_sim_state(sim));
    ck_assert_double_lt(worst.strain, 0.1);
}
END_TEST

/* Against Verlet's method with small steps. */
START_TEST(cloth_falls_on_a_plane)
{
    static double y[6 * N];
    if (!is_there(methods[_i])) {
        return;
    }
    weft_shape floor = weft_shape_default(WEFT_PLANE);
    floor.at[1] = -0.05;
    model.pin_count = 0;
    model.contact.shapes = &floor;
    model.contact.shape_count = 1;
    final_state("verlet/velocity_verlet", 1e-5, y);
    run.config.fixed_step = _i == 2 ? 5e-4 : 0.0;
    run.config.atol_position = 1e-5;
    run.config.atol_velocity = 1e-3;
    start(methods[_i]);
    go(0.25);
    for (size_t i = 0; i < N; ++i) {
        ck_assert_double_gt(at(i, 1), -0.05);
        ck_assert_double_eq_tol(at(i, 1), y[N + i], _i == 2 ? 1e-2 : 1e-4);
    }
}
END_TEST

/* Saved and restored in the middle. */
START_TEST(resumed_run_has_the_same_bits)
{
    static double y[6 * N];
    if (!is_there(methods[_i])) {
        return;
    }
    usual(_i);
    start(methods[_i]);
    go(0.1);
    const size_t size = weft_sim_save_size(sim);
    void *bytes = malloc(size);
    ck_assert_int_eq(weft_sim_save(sim, bytes, size, &err), WEFT_OK);
    go(0.3);
    memcpy(y, weft_sim_state(sim), sizeof y);
    start(methods[_i]);
    ck_assert_int_eq(weft_sim_restore(sim, bytes, size, &err), WEFT_OK);
    go(0.3);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    free(bytes);
}
END_TEST

/* One particle alone moves too slowly for the damping that all of them need. */
START_TEST(a_save_is_restored_whatever_pins_have_changed_since)
{
    static const double still[3];
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].damping = 2.2e-3 * model.springs[f].stiffness;
    }
    start("stiff/rkc2");
    const size_t size = weft_sim_save_size(sim);
    void *bytes = malloc(size);
    ck_assert_int_eq(weft_sim_save(sim, bytes, size, &err), WEFT_OK);
    for (size_t i = 0; i < N; ++i) {
        if (i != N / 2 + SIDE / 2) {
            (void)weft_sim_pin(sim, i, still, &err);
        }
    }
    ck_assert_int_ne(weft_sim_restart(sim, &err), WEFT_OK);
    ck_assert_msg(weft_sim_restore(sim, bytes, size, &err) == WEFT_OK, "%s",
                  err.message);
    go(0.1);
    free(bytes);
}
END_TEST

TEST_SUITE(stiff)
{
    Suite *suite = suite_create("stiff");
    TCase *tcase = tcase_create("stiff");
    tcase_set_timeout(tcase, 60.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    TCase *slow = test_long(suite, 60.0);
    tcase_add_checked_fixture(slow, setup, teardown);
    tcase_add_loop_test(slow, order_on_cloth, 0, ORDERS);
    tcase_add_loop_test(tcase, stabilised_methods_agree_with_rkc2, 0, 2);
    tcase_add_test(tcase, damping_that_binds_explicit_steps_costs_little);
    tcase_add_test(tcase, stabilised_methods_refuse_lightly_damped_cloth);
    tcase_add_loop_test(tcase, fixed_steps_that_are_not_stable_are_refused, 0, 3);
    tcase_add_test(tcase, wrong_settings_of_linear_systems_are_refused);
    tcase_add_test(tcase, numbers_are_reported_as_written);
    tcase_add_loop_test(tcase, moved_pins_keep_to_their_way, 0, METHODS);
    tcase_add_loop_test(tcase, strain_limit_holds, 0, METHODS);
    tcase_add_loop_test(tcase, cloth_falls_on_a_plane, 0, METHODS);
    tcase_add_test(tcase, a_save_is_restored_whatever_pins_have_changed_since);
    tcase_add_loop_test(tcase, resumed_run_has_the_same_bits, 0, METHODS);
    suite_add_tcase(suite, tcase);
    return suite;
}
