/* SPDX-License-Identifier: BSD-3-Clause */
/* test_contact_time.c -- contact while time passes: exact answers (docs/physics.md),
 * and no particle in a shape or through one, whatever the method and its steps. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static weft_cloth_def model;
static weft_shape shapes[4];
static weft_sim_def run;
static weft_cloth *cloth;
static weft_sim *sim;
static weft_error err;

/* Two loose particles of 0.1 kg, side by side along x, above the plane y >= 0, which is
 * elastic and without friction; a tight tolerance. */
static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = 1, model.cols = 2;
    model.density = 0.0, model.mass = 0.1;
    model.contact.damping = 0.0, model.contact.friction = 0.0;
    model.contact.shapes = shapes, model.contact.shape_count = 1;
    for (size_t k = 0; k < 4; ++k) {
        shapes[k] = weft_shape_default(WEFT_PLANE);
    }
    run = weft_sim_def_default();
    run.method = test_method_named("gsl/rk8pd");
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = 1e-10;
}

static void teardown(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    sim = NULL;
    cloth = NULL;
}

static void start(void)
{
    teardown();
    cloth = test_cloth(&model);
    run.cloth = cloth;
    run.config = test_config(run.method, run.config);
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
}

static void tolerance(double tol)
{
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = tol;
}

static void step(double t)
{
    ck_assert_msg(weft_sim_step(sim, t, &err) == WEFT_OK, "%s: %s", run.method->name,
                  err.message);
}

static void go(double t)
{
    while (weft_sim_time(sim) < t) {
        step(t);
    }
}

/* Component k of the position, or k - 3 of the velocity, of particle i. */
static double at(size_t i, size_t k)
{
    return weft_sim_state(sim)[k * weft_cloth_particles(cloth) + i];
}

static double gap(void)
{
    return weft_cloth_gap(weft_sim_cloth(sim), weft_sim_time(sim), weft_sim_state(sim),
                          NULL, NULL);
}

static double phi(double s)
{
    return s * s * s * s / (1.0 - s);
}

/* ---- exact answers --------------------------------------------------------------- */

/* phi(s) = (v / v_c)^2 at the deepest point, and the apex is the start. */
START_TEST(a_drop_turns_at_its_gap_and_comes_back)
{
    const double heights[] = { 0.01, 0.5, 8.0 };
    const double top = heights[_i], dh = model.contact.thickness;
    model.origin[1] = top;
    start();
    double low = 1.0, high = 0.0;
    while (weft_sim_time(sim) < 2.2 * sqrt(2.0 * top / 9.81)) {
        step(4.0);
        low = fmin(low, gap());
        high = weft_sim_time(sim) > 1.5 * sqrt(2.0 * top / 9.81) ? fmax(high, gap())
                                                                 : 0.0;
    }
    /* g counts on the way from the top to the gap */
    const double e = 12.5, s = 1.0 - low / dh;
    ck_assert_double_le(e * phi(s), 9.81 * (top - low) * (1.0 + 1e-8));
    ck_assert_double_ge(e * phi(s), 9.81 * (top - low) * 0.9);
    ck_assert_double_le(high, top * (1.0 + 1e-8));
    ck_assert_double_ge(high, top * 0.9);
    const weft_energy energy = weft_sim_measure(sim).energy;
    ck_assert_double_eq_tol(weft_energy_total(energy), 0.2 * 9.81 * top,
                            0.2 * 9.81 * top * 2e-8);
}
END_TEST

/* b / a = restitution with (1 + b^2)^1.5 + b^3 = (1 + a^2)^1.5 - a^3, a = chi v. */
START_TEST(restitution_is_by_law)
{
    const double speeds[] = { 0.5, 1.0, 2.0, 4.0 }, a = speeds[_i % 4];
    const double want = pow(1.0 + a * a, 1.5) - a * a * a;
    memset(model.gravity, 0, sizeof model.gravity);
    model.contact.damping = 1.0, model.contact.exponent = _i < 4 ? 4 : 6;
    model.origin[1] = 0.01, model.velocity[1] = -a;
    start();
    go(0.1);
    const double b = at(0, 4);
    ck_assert_double_gt(gap(), model.contact.thickness);
    ck_assert_double_eq_tol(pow(1.0 + b * b, 1.5) + b * b * b, want, 1e-7);
}
END_TEST

START_TEST(a_rising_plane_throws_at_twice_its_speed)
{
    const double v = 0.8;
    memset(model.gravity, 0, sizeof model.gravity);
    model.origin[1] = 0.1, shapes[0].velocity[1] = v;
    run.ledger = true;
    start();
    go(0.3);
    ck_assert_double_eq_tol(at(0, 4), 2.0 * v, 1e-8);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).shape_work, 2.0 * 0.1 * 2.0 * v * v,
                            1e-8);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).residual, 0.0, 1e-8);
}
END_TEST

/* ---- the step check -------------------------------------------------------------- */

/* A plate 4 mm thick: free fall is exact for a method, so its steps know nothing of the
 * plate. */
START_TEST(nothing_falls_through_a_thin_plate)
{
    static const char *const methods[]
        = { "gsl/rkf45", "gsl/rk8pd",   "arkode/dormand_prince",  "arkode/verner65",
            "gsl/rk4",   "gsl/msadams", "verlet/velocity_verlet", "gsl/gear1" };
    run.method = test_method_named(methods[_i]);
    shapes[0] = weft_shape_default(WEFT_BOX);
    for (size_t k = 0; k < 3; ++k) {
        shapes[0].half[k] = k == 1 ? 2e-3 : 0.5;
    }
    shapes[0].rounding = 1e-3;
    model.spacing[1] = 0.01, model.origin[1] = 1.0;
    tolerance(1e-6);
    run.config.fixed_step
        = (run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 0.01 : 0.0;
    start();
    while (weft_sim_time(sim) < 1.0) {
        step(1.0);
        ck_assert_double_gt(gap(), 0.0);
        ck_assert_double_gt(at(0, 1), 0.0);
    }
    ck_assert(weft_sim_vetoed(sim) > 0 || _i == 7); /* gear1: small steps anyway */
}
END_TEST

TEST_SUITE(contact_time)
{
    Suite *suite = suite_create("contact_time");
    TCase *tcase = tcase_create("contact_time");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, a_drop_turns_at_its_gap_and_comes_back, 0, 3);
    tcase_add_loop_test(tcase, restitution_is_by_law, 0, 8);
    tcase_add_test(tcase, a_rising_plane_throws_at_twice_its_speed);
    tcase_add_loop_test(tcase, nothing_falls_through_a_thin_plate, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
