/* SPDX-License-Identifier: BSD-3-Clause */
/* test_track.c -- vectors that follow a table of times: the law, the paths of pins and
 * the wind that use it, and steps that end at its rows. */
#include "meshes.h"

#include <float.h>
#include <math.h>

#include "mesh/track.h"
#include "one_sim.h"

static const double rows[] = {
    0.25, 1.0, -2.0, 3.0,  //
    0.5,  1.5, -2.0, 2.0,  //
    0.75, 1.0, 4.0,  2.5,  //
    2.0,  0.0, 3.0,  -1.0, //
    2.25, 0.5, 3.0,  0.0,  //
};
static const weft_track track = { rows, 5 };

/* ---- the law --------------------------------------------------------------------- */

START_TEST(track_goes_through_its_rows_exactly)
{
    double value[3][3];
    for (size_t i = 0; i < track.count; ++i) {
        weft__track_at(&track, rows[4 * i], value);
        ck_assert_mem_eq(value[0], &rows[4 * i + 1], sizeof value[0]);
    }
}
END_TEST

START_TEST(track_rests_before_its_first_row_and_after_its_last)
{
    static const double none[6];
    const double times[] = { -1e300, 0.0, 0.25, 2.25, 3.0, 1e300 };
    for (size_t i = 0; i < 6; ++i) {
        double value[3][3];
        weft__track_at(&track, times[i], value);
        ck_assert_mem_eq(value[0], &rows[i < 3 ? 1 : 17], sizeof value[0]);
        ck_assert_mem_eq(value[1], none, sizeof none);
    }
}
END_TEST

/* On both sides of a row; and each derivative is that of the one before. */
START_TEST(track_has_two_continuous_derivatives)
{
    double before[3][3], after[3][3], here[3][3];
    for (size_t i = 0; i < track.count; ++i) {
        weft__track_at(&track, rows[4 * i] - 1e-9, before);
        weft__track_at(&track, rows[4 * i] + 1e-9, after);
        for (size_t j = 0; j < 9; ++j) {
            ck_assert_double_eq_tol(before[j / 3][j % 3], after[j / 3][j % 3], 1e-4);
        }
    }
    for (double t = 0.29; t < 2.25; t += 0.1) {
        const double h = 1e-5;
        weft__track_at(&track, t - h, before);
        weft__track_at(&track, t, here);
        weft__track_at(&track, t + h, after);
        for (size_t j = 0; j < 6; ++j) {
            ck_assert_double_eq_tol(
                here[j / 3 + 1][j % 3],
                (after[j / 3][j % 3] - before[j / 3][j % 3]) / (2.0 * h), 1e-4);
        }
    }
}
END_TEST

/* In halves and quarters every number is exact: 10 s^3 - 15 s^4 + 6 s^5. */
START_TEST(two_rows_are_a_smooth_ramp)
{
    const double ramp[] = { 1.0, 0.0, 8.0, 0.0, 3.0, 16.0, 8.0, -32.0 };
    const weft_track of = { ramp, 2 };
    double value[3][3];
    weft__track_at(&of, 2.0, value);
    ck_assert(value[0][0] == 8.0 && value[0][1] == 8.0 && value[0][2] == -16.0);
    ck_assert(value[1][0] == 15.0 && value[1][1] == 0.0 && value[2][0] == 0.0);
    weft__track_at(&of, 1.5, value);
    ck_assert(value[0][0] == 1.65625);
}
END_TEST

/* Between inner rows, whatever their times: the slopes are those of the parabola. */
START_TEST(track_through_a_parabola_is_the_parabola)
{
    double some[4 * 8], value[3][3];
    const weft_track of = { some, 8 };
    uint64_t seed = 5;
    for (size_t i = 0; i < 8; ++i) {
        const double t = (double)i + 0.5 * random_uniform(&seed);
        const double row[4] = { t, 3.0 - 2.0 * t, t * t, 0.5 * t * (t - 7.0) };
        memcpy(&some[4 * i], row, sizeof row);
    }
    for (double t = some[4]; t < some[24]; t += 0.07) {
        const double wanted[9]
            = { 3.0 - 2.0 * t, t * t, 0.5 * t * (t - 7.0), -2.0, 2.0 * t, t - 3.5, 0.0,
                2.0,           1.0 };
        weft__track_at(&of, t, value);
        for (size_t j = 0; j < 9; ++j) {
            ck_assert_double_eq_tol(value[j / 3][j % 3], wanted[j], 1e-11);
        }
    }
}
END_TEST

START_TEST(next_time_is_that_of_the_next_row)
{
    ck_assert(weft__track_next(&track, 0.0, 9.0) == 0.25);
    ck_assert(weft__track_next(&track, 0.25, 9.0) == 0.5);
    ck_assert(weft__track_next(&track, 0.25, 0.4) == 0.4);
    ck_assert(weft__track_next(&track, 0.75 - DBL_EPSILON, 9.0) == 2.0);
    ck_assert(weft__track_next(&track, 0.6, 0.75 + DBL_EPSILON) == 0.75 + DBL_EPSILON);
    ck_assert(weft__track_next(&track, 2.25, 9.0) == 9.0);
    ck_assert(weft__track_next(&(weft_track){ NULL, 0 }, 0.0, 9.0) == 9.0);
}
END_TEST

/* ---- in a simulation ------------------------------------------------------------- */

enum { SIDE = 5, N = SIDE * SIDE };

static test_mesh mesh;
static weft_pin pin;
static weft_cloth_def model;

static weft_cloth_def sheet(bool grid)
{
    static const size_t held[] = { 0, 3 };
    weft_cloth_def def = mesh_cloth(&mesh);
    pin = (weft_pin){ .rows = { 0, 0 },
                      .cols = { 0, 1 },
                      .vertices = held,
                      .vertex_count = 2,
                      .path = track };
    if (grid) {
        def.mesh = NULL;
        def.rows = def.cols = SIDE;
        def.spacing[0] = def.spacing[1] = 0.1;
        def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 20.0, 0.02 };
    }
    def.pins = &pin, def.pin_count = 1;
    def.drag = 1e-3;
    return def;
}

static void setup(void)
{
    mesh_sheet(&mesh, SIDE, SIDE, 0.1, MESH_RANDOM, 0.2, 3);
    mesh_shuffle(&mesh, 2, NULL);
    mesh.fabrics[0].stretch[0] = mesh.fabrics[0].stretch[1] = 50.0;
    mesh.fabrics[0].shear = mesh.fabrics[0].coupling = 10.0;
}

static void end(void)
{
    teardown();
    mesh_free(&mesh);
}

static void start(const char *method)
{
    weft_stepper_config config = weft_stepper_config_default();
    const weft_stepper_type *type = test_method_named(method);
    config.fixed_step = (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 1e-3 : 0.0;
    cloth = test_cloth(&model);
    sim = test_sim(cloth, type, &config);
}

static void go(weft_sim *with, double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(with, t, &err) == WEFT_OK, "%s", err.message);
}

/* All of them, by what their table moves from its place at t = 0; a method of order 5
 * integrates the polynomial exactly. */
START_TEST(pins_move_along_a_path)
{
    double from[3 * N], to[3 * N];
    model = sheet(_i == 0);
    start("gsl/rkf45");
    weft_sim_positions(sim, from);
    for (size_t i = 0; i < track.count; ++i) {
        go(sim, rows[4 * i]);
        weft_sim_positions(sim, to);
        for (size_t j = 0; j < 2; ++j) {
            const size_t p = 3 * (model.mesh == NULL ? j : pin.vertices[j]);
            for (size_t k = 0; k < 3; ++k) {
                ck_assert_double_eq_tol(to[p + k] - from[p + k],
                                        rows[4 * i + 1 + k] - rows[1 + k], 1e-12);
            }
        }
    }
    go(sim, 2.5);
    weft_sim_positions(sim, from);
    ck_assert_mem_ne(from, to, sizeof to); /* the others go on */
    for (size_t k = 0; k < 3; ++k) {
        ck_assert_double_eq_tol(from[k], to[k], 1e-12);
    }
}
END_TEST

START_TEST(path_adds_to_velocity_and_oscillation)
{
    double both[6 * N], alone[6 * N], other[6 * N], value[3][3];
    const double t = 0.6;
    model = sheet(true);
    cloth = test_cloth(&model);
    pin.velocity[0] = 0.5, pin.amplitude[2] = 0.1, pin.frequency = 2.0;
    weft_cloth *sum = test_cloth(&model);
    pin.path.count = 0;
    weft_cloth *plain = test_cloth(&model);
    weft_cloth_start(cloth, other);
    ck_assert_int_eq(weft_cloth_rhs(sum, t, other, both), 0);
    ck_assert_int_eq(weft_cloth_rhs(plain, t, other, alone), 0);
    weft__track_at(&track, t, value);
    for (size_t j = 0; j < 6; ++j) {
        ck_assert_double_eq_tol(both[j * N] - alone[j * N], value[1 + j / 3][j % 3],
                                1e-13);
    }
    weft_cloth_destroy(sum);
    weft_cloth_destroy(plain);
}
END_TEST

/* At every time the wind is one that is constant and has this velocity, to the last
 * bit: forces, accelerations, their change, power. */
START_TEST(wind_has_the_velocity_of_its_table)
{
    static double y[6 * N], dy[6 * N], is[2][6 * N];
    uint64_t seed = 7;
    model = sheet(_i == 0);
    model.wind = track;
    model.wind_drag = 0.4;
    cloth = test_cloth(&model);
    model.wind.count = 0;
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * N; ++j) {
        y[j] += 0.02 * random_uniform(&seed);
        dy[j] = random_uniform(&seed);
    }
    for (double t = 0.0; t < 2.6; t += 0.2) {
        double value[3][3], power[2][WEFT_POWERS];
        weft__track_at(&track, t, value);
        memcpy(model.wind_velocity, value[0], sizeof value[0]);
        weft_cloth *steady = test_cloth(&model);
        const weft_cloth *const both[] = { cloth, steady };
        for (size_t k = 0; k < 2; ++k) {
            weft_cloth_power(both[k], t, y, power[k]);
            ck_assert_int_eq(weft_cloth_rhs(both[k], t, y, is[k]), 0);
        }
        ck_assert_mem_eq(is[0], is[1], sizeof is[0]);
        ck_assert_mem_eq(power[0], power[1], sizeof power[0]);
        for (size_t k = 0; k < 2; ++k) {
            ck_assert_int_eq(weft_cloth_jacobian_product(both[k], t, y, dy, is[k]), 0);
        }
        ck_assert_mem_eq(is[0], is[1], sizeof is[0]);
        for (size_t k = 0; k < 2; ++k) {
            weft_cloth_force(both[k], t, y, is[k]);
        }
        ck_assert_mem_eq(is[0], is[1], 3 * N * sizeof is[0][0]);
        weft_cloth_destroy(steady);
    }
}
END_TEST

START_TEST(steps_end_at_the_rows_of_all_tracks)
{
    static const double gusts[] = { 0.0, 0, 0, 0, 1.0, 0, 0, 3, 1.1, 0, 0, 0 };
    const double wanted[] = { 0.25, 0.5, 0.75, 1.0, 1.1, 2.0, 2.25, 3.0 };
    size_t met = 0;
    model = sheet(true);
    model.wind = (weft_track){ gusts, 3 };
    model.wind_drag = 0.1;
    start(_i == 0 ? "verlet/velocity_verlet" : "gsl/rkf45");
    while (weft_sim_time(sim) < 3.0) {
        weft_error err = { 0 };
        ck_assert_msg(weft_sim_step(sim, 3.0, &err) == WEFT_OK, "%s", err.message);
        ck_assert(weft_sim_time(sim) <= wanted[met]);
        met += weft_sim_time(sim) == wanted[met];
    }
    ck_assert_uint_eq(met, 8);
}
END_TEST

START_TEST(a_wind_that_was_set_replaces_the_table_until_it_is_taken_back)
{
    const double value[3] = { 1.0, 2.0, 3.0 };
    model = sheet(_i == 0);
    model.wind = track;
    model.wind_drag = 0.4;
    start("verlet/velocity_verlet");
    weft_sim *free_of_it = sim, *kept;
    sim = NULL;
    weft_cloth *shared = cloth;
    model.wind.count = 0;
    memcpy(model.wind_velocity, value, sizeof value);
    start("verlet/velocity_verlet");
    ck_assert_int_eq(weft_sim_set_wind(free_of_it, value, 0.4, NULL), WEFT_OK);
    go(free_of_it, 0.6); /* steps end at rows of the path, which are the wind's */
    go(sim, 0.6);
    ck_assert_mem_eq(weft_sim_state(sim), weft_sim_state(free_of_it),
                     6 * N * sizeof(double));
    ck_assert_int_eq(weft_sim_set_wind(free_of_it, NULL, 0.0, NULL), WEFT_OK);
    const double *y = weft_sim_state(free_of_it);
    double is[6 * N], wanted[6 * N];
    ck_assert_int_eq(weft_cloth_rhs(weft_sim_cloth(free_of_it), 0.6, y, is), 0);
    ck_assert_int_eq(weft_cloth_rhs(shared, 0.6, y, wanted), 0);
    ck_assert_mem_eq(is, wanted, sizeof is);
    kept = free_of_it;
    weft_sim_destroy(kept);
    weft_cloth_destroy(shared);
}
END_TEST

/* The rows are copied, and their faults are found. */
START_TEST(rows_of_the_caller_are_needed_at_creation_alone)
{
    double own[20], y[6 * N];
    weft_cloth *other;
    model = sheet(_i == 0);
    model.wind_drag = 0.4;
    memcpy(own, rows, sizeof own);
    pin.path.rows = model.wind.rows = own;
    model.wind.count = 5;
    other = test_cloth(&model);
    memset(own, 0xff, sizeof own);
    pin.path.rows = model.wind.rows = rows;
    start("verlet/velocity_verlet");
    go(sim, 0.6);
    memcpy(y, weft_sim_state(sim), sizeof y);
    teardown();
    cloth = other;
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 1e-3;
    sim = test_sim(cloth, test_method_named("verlet/velocity_verlet"), &config);
    go(sim, 0.6);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
}
END_TEST

START_TEST(rows_that_make_no_sense_are_refused)
{
    const struct {
        double rows[8];
        const char *text;
    } wrong[] = {
        { { 0, 0, 0, 0, 0, 1, 0, 0 }, "row 1 must have a later time" },
        { { 0, 0, (double)INFINITY, 0, 1 }, "row 0 has a number that is not finite" },
        { { 0, 0, 0, 0, (double)NAN }, "row 1 has a number that is not finite" },
        { { 0, 0, 0, 0, 1e-200, 1, 0, 0 }, "row 1 is too far from the row before" },
        { { -1e308, 0, 0, 0, 1e308 }, "row 1 is too far from the row before" },
    };
    weft_error err = { 0 };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        model = sheet(i % 2 == 0);
        pin.path = (weft_track){ wrong[i].rows, 2 };
        ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
        ck_assert_ptr_nonnull(strstr(err.message, "pin 0: path: row"));
        ck_assert_ptr_nonnull(strstr(err.message, wrong[i].text));
        pin.path.count = 0;
        model.wind = (weft_track){ wrong[i].rows, 2 };
        ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
        ck_assert_ptr_nonnull(strstr(err.message, "wind: row"));
        ck_assert_ptr_nonnull(strstr(err.message, wrong[i].text));
    }
    model.wind = (weft_track){ NULL, 2 };
    ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "is NULL"));
}
END_TEST

TEST_SUITE(track)
{
    Suite *suite = suite_create("track");
    TCase *law = tcase_create("law"), *run = tcase_create("run");
    tcase_add_test(law, track_goes_through_its_rows_exactly);
    tcase_add_test(law, track_rests_before_its_first_row_and_after_its_last);
    tcase_add_test(law, track_has_two_continuous_derivatives);
    tcase_add_test(law, two_rows_are_a_smooth_ramp);
    tcase_add_test(law, track_through_a_parabola_is_the_parabola);
    tcase_add_test(law, next_time_is_that_of_the_next_row);
    tcase_add_checked_fixture(run, setup, end);
    tcase_add_loop_test(run, pins_move_along_a_path, 0, 2);
    tcase_add_test(run, path_adds_to_velocity_and_oscillation);
    tcase_add_loop_test(run, wind_has_the_velocity_of_its_table, 0, 2);
    tcase_add_loop_test(run, steps_end_at_the_rows_of_all_tracks, 0, 2);
    tcase_add_loop_test(
        run, a_wind_that_was_set_replaces_the_table_until_it_is_taken_back, 0, 2);
    tcase_add_loop_test(run, rows_of_the_caller_are_needed_at_creation_alone, 0, 2);
    tcase_add_test(run, rows_that_make_no_sense_are_refused);
    suite_add_tcase(suite, law);
    suite_add_tcase(suite, run);
    return suite;
}
