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
enum { ROWS = 5, MOST = 40 };
static const weft_table track = { rows, ROWS };
static double slopes[WEFT__CURVE_WIDTH * MOST];

/* A table of random rows at uneven times from -1 s on; some have the value of the row
 * before. */
static weft_table random_track(uint64_t *seed, double some[4 * MOST], size_t count)
{
    double t = -1.0;
    for (size_t i = 0; i < count; ++i, t += 1e-3 + pow(random_uniform(seed), 6.0)) {
        some[4 * i] = t;
        for (size_t k = 1; k < 4; ++k) {
            const bool rests = i > 0 && random_uniform(seed) < 0.3;
            some[4 * i + k] = rests ? some[4 * (i - 1) + k] : random_uniform(seed);
        }
    }
    return (weft_table){ some, count };
}

static void value_at(const weft__curve *of, double t, double value[3][3])
{
    weft__curve_at(of, t, t, value);
}

/* ---- the law --------------------------------------------------------------------- */

START_TEST(track_goes_through_its_rows_exactly)
{
    const weft__curve of = weft__curve_make(&track, _i == 1, slopes);
    double value[3][3];
    for (size_t i = 0; i < track.count; ++i) {
        value_at(&of, rows[4 * i], value);
        ck_assert_mem_eq(value[0], &rows[4 * i + 1], sizeof value[0]);
    }
}
END_TEST

START_TEST(track_rests_before_its_first_row_and_after_its_last)
{
    static const double none[6];
    const weft__curve of = weft__curve_make(&track, _i == 1, slopes);
    const double times[] = { -1e300, 0.0, 0.2499, 2.25, 3.0, 1e300 };
    for (size_t i = 0; i < 6; ++i) {
        double value[3][3];
        value_at(&of, times[i], value);
        ck_assert_mem_eq(value[0], &rows[i < 3 ? 1 : 17], sizeof value[0]);
        ck_assert_mem_eq(value[1], none, sizeof none);
    }
}
END_TEST

/* On both sides of a row, and at those that end a natural spline the value alone; and
 * each derivative is that of the one before. */
START_TEST(track_has_one_continuous_derivative_and_a_natural_spline_two)
{
    const weft__curve of = weft__curve_make(&track, _i == 1, slopes);
    double before[3][3], after[3][3], here[3][3];
    for (size_t i = 0; i < track.count; ++i) {
        const bool ends = i == 0 || i + 1 == track.count;
        const size_t smooth = _i == 0 ? 2 : ends ? 1 : 3;
        weft__curve_at(&of, rows[4 * i], rows[4 * i] - 1e-9, before);
        value_at(&of, rows[4 * i], after);
        for (size_t j = 0; j < 3 * smooth; ++j) {
            ck_assert_double_eq_tol(before[j / 3][j % 3], after[j / 3][j % 3], 1e-11);
        }
        for (size_t k = 0; ends && _i == 1 && k < 3; ++k) {
            ck_assert_double_eq_tol(i == 0 ? after[2][k] : before[2][k], 0.0, 1e-11);
        }
    }
    for (double t = 0.29; t < 2.25; t += 0.1) {
        const double h = 1e-5;
        weft__curve_at(&of, t - h, t, before);
        value_at(&of, t, here);
        weft__curve_at(&of, t + h, t, after);
        for (size_t j = 0; j < 6; ++j) {
            ck_assert_double_eq_tol(
                here[j / 3 + 1][j % 3],
                (after[j / 3][j % 3] - before[j / 3][j % 3]) / (2.0 * h), 1e-4);
        }
    }
}
END_TEST

/* Between two rows no component leaves their range or turns, however uneven the times,
 * but for the last bits; equal rows are a rest to the last one. */
START_TEST(track_stays_between_its_rows_and_rests_between_equal_ones)
{
    uint64_t seed = 11;
    for (size_t trial = 0; trial < 200; ++trial) {
        double some[4 * MOST];
        const weft_table from = random_track(&seed, some, MOST);
        const weft__curve of = weft__curve_make(&from, false, slopes);
        for (size_t i = 0; i + 1 < MOST; ++i) {
            const double *a = &some[4 * i], *b = a + 4;
            for (double s = 0.0; s <= 1.0; s += 0.0625) {
                double value[3][3];
                weft__curve_at(&of, a[0] + s * (b[0] - a[0]), a[0], value);
                for (size_t k = 0; k < 3; ++k) {
                    const double low = fmin(a[k + 1], b[k + 1]);
                    const double high = fmax(a[k + 1], b[k + 1]);
                    const double way = b[k + 1] - a[k + 1];
                    const double fast = fabs(way) / (b[0] - a[0]);
                    ck_assert(value[0][k] >= low - 4.0 * DBL_EPSILON);
                    ck_assert(value[0][k] <= high + 4.0 * DBL_EPSILON);
                    ck_assert(way == 0.0
                                  ? value[0][k] == low && value[1][k] == 0.0
                                  : value[1][k] * copysign(1.0, way) >= -1e-9 * fast);
                }
            }
        }
    }
}
END_TEST

/* Numbers of SciPy 1.17.1: CubicHermiteSpline with the inner slopes of
 * PchipInterpolator and 0 at both ends; CubicSpline(bc_type="natural"). */
START_TEST(track_has_the_values_of_scipy)
{
    static const double times[] = { 0.3, 0.6, 0.9, 1.3, 1.9, 2.2 };
    static const double wanted[2][6][3] = {
        { { 1.052, -2.0, 2.8959999999999999 },                             //
          { 1.3543157894736844, 0.11199999999999899, 2.1759999999999997 }, //
          { 0.81352757894736838, 3.9602559999999998, 2.3608959999999999 }, //
          { 0.37169852631578937, 3.5895679999999999, 1.0634880000000002 }, //
          { 0.0088791578947367555, 3.018176, -0.93638399999999855 },       //
          { 0.4480000000000004, 3.0, -0.1039999999999992 } },
        { { 1.1492827586206895, -2.3266482758620683, 2.7166620689655172 },  //
          { 1.3895862068965519, 0.01724137931034353, 2.1126896551724141 },  //
          { 0.60780689655172404, 6.8349793103448278, 2.5424551724137929 },  //
          { -0.11547586206896575, 8.1736275862068943, 1.1001931034482759 }, //
          { -0.13984827586206905, 3.435944827586205, -1.0987862068965502 }, //
          { 0.39093793103448315, 2.932386206896552, -0.24609655172413708 } },
    };
    const weft__curve of = weft__curve_make(&track, _i == 1, slopes);
    for (size_t i = 0; i < 6; ++i) {
        double value[3][3];
        value_at(&of, times[i], value);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(value[0][k], wanted[_i][i][k], 1e-14);
        }
    }
}
END_TEST

/* In halves and quarters every number is exact: 3 s^2 - 2 s^3; a natural spline of two
 * rows is a straight line. */
START_TEST(two_rows_are_a_smooth_ramp)
{
    const double ramp[] = { 1.0, 0.0, 8.0, 0.0, 3.0, 16.0, 8.0, -32.0 };
    const weft_table two = { ramp, 2 };
    const weft__curve of = weft__curve_make(&two, false, slopes);
    double value[3][3];
    value_at(&of, 2.0, value);
    ck_assert(value[0][0] == 8.0 && value[0][1] == 8.0 && value[0][2] == -16.0);
    ck_assert(value[1][0] == 12.0 && value[1][1] == 0.0 && value[2][0] == 0.0);
    value_at(&of, 1.5, value);
    ck_assert(value[0][0] == 2.5);
    const weft__curve line = weft__curve_make(&two, true, slopes);
    value_at(&line, 1.5, value);
    ck_assert(value[0][0] == 4.0 && value[1][0] == 8.0 && value[2][0] == 0.0);
}
END_TEST

START_TEST(one_row_is_a_constant)
{
    const weft_table one = { rows, 1 };
    const weft__curve of = weft__curve_make(&one, _i == 1, slopes);
    double value[3][3];
    for (double t = -1.0; t < 2.0; t += 0.5) {
        value_at(&of, t, value);
        ck_assert(value[0][0] == 1.0 && value[0][1] == -2.0 && value[1][0] == 0.0);
    }
}
END_TEST

/* The polynomial of a piece goes on outside of it: equidistant values of it have no
 * fourth difference. */
START_TEST(a_piece_is_one_polynomial_wherever_it_is_asked)
{
    const weft__curve of = weft__curve_make(&track, _i == 1, slopes);
    for (size_t i = 0; i + 1 < ROWS; ++i) {
        const double piece = 0.5 * (rows[4 * i] + rows[4 * i + 4]);
        double is[5][3][3];
        for (size_t j = 0; j < 5; ++j) {
            weft__curve_at(&of, rows[4 * i] + 0.3 * ((double)j - 2.0), piece, is[j]);
        }
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(is[0][0][k] - 4.0 * is[1][0][k] + 6.0 * is[2][0][k]
                                        - 4.0 * is[3][0][k] + is[4][0][k],
                                    0.0, 1e-10);
        }
    }
}
END_TEST

static void bounded(const weft__curve *of, double t, double first, double last)
{
    weft__piece_bounds is = { -DBL_MAX, DBL_MAX };
    weft__curve_bounds(of, t, &is);
    ck_assert(is.first == first && is.last == last);
    weft__curve_bounds(&(weft__curve){ .rows = NULL }, t, &is);
    ck_assert(is.first == first && is.last == last);
}

START_TEST(a_piece_is_between_the_rows_beside)
{
    const weft__curve of = weft__curve_make(&track, false, slopes);
    bounded(&of, 0.0, -DBL_MAX, 0.25);
    bounded(&of, 0.25, 0.25, 0.5);
    bounded(&of, 0.25 - DBL_EPSILON, 0.25, 0.5);
    bounded(&of, 0.6, 0.5, 0.75);
    bounded(&of, 2.25, 2.25, DBL_MAX);
    ck_assert(!weft__row_met(1e-15, 0.0) && !weft__row_met(DBL_MAX, 1e300));
    ck_assert(weft__row_met(-1.0, -1.0) && weft__row_met(-2.0, -1.0));
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
    def.damping = 1e-3;
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

/* Hold, move, hold, however short the move is: the pin stays between its rows, and
 * where it was to the last bit while it holds; at loose tolerances. */
START_TEST(a_pin_that_holds_moves_and_holds_does_that)
{
    static const double held[]
        = { 0.0, 0, 0, 0, 1.0, 0, 0, 0, 1.1, 0.2, 0, 0, 2.0, 0.2, 0, 0 };
    static const double jerk[]
        = { 0.0, 0, 0, 0, 1.005, 0, 0, 0, 1.015, 0.2, 0, 0, 1.025, 0, 0, 0 };
    double first[3 * N], is[3 * N];
    weft_stepper_config config = weft_stepper_config_default();
    config.rtol = config.atol_position = config.atol_velocity = 1e-3;
    model = sheet(true);
    pin.path = (weft_table){ _i == 0 ? held : jerk, 4 };
    cloth = test_cloth(&model);
    sim = test_sim(cloth, test_method_named("gsl/rkf45"), &config);
    weft_sim_positions(sim, first);
    for (int i = 1; i <= 200; ++i) {
        const double t = 0.01 * i;
        go(sim, t);
        weft_sim_positions(sim, is);
        ck_assert_double_ge(is[0] - first[0], -1e-12);
        ck_assert_double_le(is[0] - first[0], 0.2 + 1e-12);
        ck_assert(t > 1.0 || is[0] == first[0]);
        ck_assert(is[1] == first[1] && is[2] == first[2]);
    }
    ck_assert_double_eq_tol(is[0] - first[0], _i == 0 ? 0.2 : 0.0, 1e-12);
}
END_TEST

/* A gust of 20 ms after a second of calm: the sheet rests, and is then driven along it.
 */
START_TEST(a_gust_blows_between_its_rows_alone)
{
    static const double gust[]
        = { 0.0, 0, 0, 0, 1.005, 0, 0, 0, 1.015, 0, 0, 20, 1.025, 0, 0, 0 };
    double before[3 * N], after[3 * N];
    model = sheet(true);
    model.pin_count = 0;
    model.gravity[0] = model.gravity[1] = model.gravity[2] = 0.0;
    model.wind_table = (weft_table){ gust, 4 };
    model.wind_drag = 0.5;
    start("gsl/rkf45");
    weft_sim_positions(sim, before);
    go(sim, 1.0);
    weft_sim_positions(sim, after);
    for (size_t i = 0; i < N; ++i) {
        ck_assert(after[3 * i + 2] == before[3 * i + 2]);
    }
    go(sim, 1.5);
    weft_sim_positions(sim, after);
    for (size_t i = 0; i < N; ++i) {
        ck_assert_double_gt(after[3 * i + 2], before[3 * i + 2] + 1e-3);
    }
}
END_TEST

/* A natural spline begins and ends at a speed: at these rows the state has the velocity
 * after them, and what is shown within a step before them that of the step. */
START_TEST(pins_jump_at_the_ends_of_a_natural_spline)
{
    const weft__curve of = weft__curve_make(&track, true, slopes);
    double v[3 * N], is[3][3], y[6 * N];
    weft_error err;
    model = sheet(_i == 0);
    pin.path_natural = true;
    weft_stepper_config config = weft_stepper_config_default();
    weft_sim_def def = weft_sim_def_default();
    cloth = test_cloth(&model);
    def.cloth = cloth, def.config = config, def.interpolate = true;
    def.method = test_method_named("gsl/rkf45");
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_OK);
    const size_t i = model.mesh == NULL ? 0 : pin.vertices[0];
    for (size_t row = 0; row < track.count; ++row) {
        const double t = rows[4 * row];
        double before = 0.0;
        for (; weft_sim_time(sim) < t;) {
            before = weft_sim_time(sim);
            ck_assert_int_eq(weft_sim_step(sim, t, &err), WEFT_OK);
        }
        weft_sim_velocities(sim, v);
        value_at(&of, t, is);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(v[3 * i + k], is[1][k], 1e-10);
        }
        const double s = before + 0.9 * (t - before);
        ck_assert_int_eq(weft_sim_between(sim, s, y, &err), WEFT_OK);
        value_at(&of, s, is);
        for (size_t k = 0; k < 3; ++k) {
            const size_t p = weft_cloth_index(cloth, i);
            ck_assert_double_eq_tol(y[(3 + k) * N + p], is[1][k], 1e-9);
        }
    }
}
END_TEST

/* The table's acceleration jumps from 0 and to 0: methods of order 1 and of several
 * steps integrate it with an error, which the rest does not keep. */
START_TEST(a_pin_that_has_come_to_rest_has_no_velocity)
{
    static const char *const methods[] = { "verlet/euler",
                                           "verlet/symplectic_euler",
                                           "stiff/backward_euler",
                                           "gsl/gear1",
                                           "gsl/msbdf",
                                           "cvode/bdf",
                                           "cvode/adams",
                                           "gsl/rkf45",
                                           "verlet/velocity_verlet" };
    static const double moves[] = { 0.0,  0.0,  0.0, 0.0, 0.01, 0.0,  0.0, 0.0,
                                    0.03, 0.02, 0.0, 0.0, 0.04, 0.02, 0.0, 0.0 };
    double v[3 * N];
    for (size_t m = 0; m < sizeof methods / sizeof methods[0]; ++m) {
        model = sheet(true);
        pin.path = (weft_table){ moves, 4 };
        start(methods[m]);
        go(sim, 0.05);
        weft_sim_velocities(sim, v);
        for (size_t j = 0; j < 2; ++j) {
            for (size_t k = 0; k < 3; ++k) {
                ck_assert_msg(v[3 * j + k] == 0.0, "%s: %g m/s", methods[m],
                              v[3 * j + k]);
            }
        }
        weft_sim_destroy(sim);
        weft_cloth_destroy(cloth);
        sim = NULL;
        cloth = NULL;
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
    const weft__curve of = weft__curve_make(&track, false, slopes);
    value_at(&of, t, value);
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
    model.wind_table = track;
    model.wind_drag = 0.4;
    const weft__curve of = weft__curve_make(&track, false, slopes);
    cloth = test_cloth(&model);
    model.wind_table.count = 0;
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * N; ++j) {
        y[j] += 0.02 * random_uniform(&seed);
        dy[j] = random_uniform(&seed);
    }
    for (double t = 0.0; t < 2.6; t += 0.2) {
        double value[3][3], power[2][WEFT_POWERS];
        value_at(&of, t, value);
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
    model.wind_table = (weft_table){ gusts, 3 };
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
    model.wind_table = track;
    model.wind_drag = 0.4;
    start("verlet/velocity_verlet");
    weft_sim *free_of_it = sim, *kept;
    sim = NULL;
    weft_cloth *shared = cloth;
    model.wind_table.count = 0;
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
    pin.path.rows = model.wind_table.rows = own;
    model.wind_table.count = 5;
    other = test_cloth(&model);
    memset(own, 0xff, sizeof own);
    pin.path.rows = model.wind_table.rows = rows;
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
        pin.path = (weft_table){ wrong[i].rows, 2 };
        ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
        ck_assert_ptr_nonnull(strstr(err.message, "pin 0: path: row"));
        ck_assert_ptr_nonnull(strstr(err.message, wrong[i].text));
        pin.path.count = 0;
        model.wind_table = (weft_table){ wrong[i].rows, 2 };
        ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
        ck_assert_ptr_nonnull(strstr(err.message, "wind: row"));
        ck_assert_ptr_nonnull(strstr(err.message, wrong[i].text));
    }
    model.wind_table = (weft_table){ NULL, 2 };
    ck_assert_int_eq(weft_cloth_create(&model, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "is NULL"));
}
END_TEST

TEST_SUITE(track)
{
    Suite *suite = suite_create("track");
    TCase *law = tcase_create("law"), *run = tcase_create("run");
    tcase_add_loop_test(law, track_goes_through_its_rows_exactly, 0, 2);
    tcase_add_loop_test(law, track_rests_before_its_first_row_and_after_its_last, 0, 2);
    tcase_add_loop_test(
        law, track_has_one_continuous_derivative_and_a_natural_spline_two, 0, 2);
    tcase_add_test(law, track_stays_between_its_rows_and_rests_between_equal_ones);
    tcase_add_loop_test(law, track_has_the_values_of_scipy, 0, 2);
    tcase_add_test(law, two_rows_are_a_smooth_ramp);
    tcase_add_loop_test(law, one_row_is_a_constant, 0, 2);
    tcase_add_loop_test(law, a_piece_is_one_polynomial_wherever_it_is_asked, 0, 2);
    tcase_add_test(law, a_piece_is_between_the_rows_beside);
    tcase_add_checked_fixture(run, setup, end);
    tcase_add_loop_test(run, pins_move_along_a_path, 0, 2);
    tcase_add_loop_test(run, a_pin_that_holds_moves_and_holds_does_that, 0, 2);
    tcase_add_test(run, a_gust_blows_between_its_rows_alone);
    tcase_add_loop_test(run, pins_jump_at_the_ends_of_a_natural_spline, 0, 2);
    tcase_add_test(run, a_pin_that_has_come_to_rest_has_no_velocity);
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
