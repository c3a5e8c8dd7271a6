/* SPDX-License-Identifier: BSD-3-Clause */
/* test_contact_laws.c -- contact while time passes: the exact answers and the balances
 * of docs/physics.md. */
#include <stdlib.h>
#include <string.h>

#include "contact_run.h"

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

/* Particles at rest on a plane: phi'(s) = q dh / (rho e), for one particle m g dh / (m
 * e). Starts near there, with damping; then hardly anything moves. */
START_TEST(a_sheet_rests_at_its_gap)
{
    const double dh = model.contact.thickness, pull = 9.81 * dh / 12.5;
    const double s = resting(pull);
    model.rows = 4, model.cols = 5, model.down[1] = 0.0, model.down[2] = 1.0;
    model.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.1 };
    model.spacing[0] = model.spacing[1] = 0.1;
    model.drag = 5.0;
    model.origin[1] = dh * (1.0 - s) + 1e-5;
    start();
    go(2.0);
    for (size_t i = 0; i < 20; ++i) {
        ck_assert_double_eq_tol(at(i, 1), dh * (1.0 - s), 1e-9);
    }
}
END_TEST

/* The plane is inclined by gravity: tan a = 0.75, mu = 0.3, from v0 = 1 m/s. */
START_TEST(an_incline_is_slid_down)
{
    const double g = 10.0, mu = 0.3, t = 0.5;
    model.contact.law = WEFT_FRICTION_COULOMB, model.contact.friction = mu;
    model.gravity[0] = 0.6 * g, model.gravity[1] = -0.8 * g;
    model.velocity[0] = 1.0;
    shapes[0].normal[0] = 0.0;
    const double dh = model.contact.thickness, pull = 0.8 * g * dh / 12.5;
    const double s = resting(pull);
    model.origin[1] = dh * (1.0 - s);
    run.ledger = true;
    start();
    go(t);
    const double a = g * (0.6 - mu * 0.8);
    ck_assert_double_eq_tol(at(0, 3), 1.0 + a * t, 1e-8);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).dissipated_friction,
                            mu * 0.2 * 0.8 * g * (t + 0.5 * a * t * t), 1e-8);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).residual, 0.0, 1e-8);
}
END_TEST

/* r = tan a / mu = 0.8: coulomb eps (1 - sqrt(1 - r)); smooth with eps' of the load:
 * eps'^2 = eps^2 + (mu N / (10 m omega))^2, creep eps' r / sqrt(1 - r^2). */
START_TEST(a_shallow_incline_is_crept_down)
{
    const double g = 9.81, mu = 0.5, r = 0.8, eps = 1e-3;
    model.contact.friction = mu, model.contact.slip = eps;
    model.contact.law = _i == 0 ? WEFT_FRICTION_COULOMB : WEFT_FRICTION_SMOOTH;
    model.gravity[0] = r * mu * g, model.gravity[1] = -g;
    const double dh = model.contact.thickness, e = 12.5, pull = g * dh / e;
    const double s = resting(pull);
    const double kn
        = e / dh / dh * s * s * (12.0 - 16.0 * s + 6.0 * s * s) / pow(1.0 - s, 3.0);
    const double slip2 = eps * eps + mu * g * mu * g / (100.0 * kn);
    const double want
        = _i == 0 ? eps * (1.0 - sqrt(1.0 - r)) : sqrt(slip2) * r / sqrt(1.0 - r * r);
    model.origin[1] = dh * (1.0 - s);
    tolerance(1e-9);
    start();
    go(0.2);
    ck_assert_double_eq_tol(at(0, 3), want, 1e-8);
}
END_TEST

/* From rest: v = mu g t until t_c = (V - eps) / (mu g); heat and work at the end. */
START_TEST(a_belt_takes_a_particle_along)
{
    const double v = 0.5, mu = 0.3, g = 9.81, eps = 1e-3, dh = model.contact.thickness;
    const double pull = g * dh / 12.5, critical = (v - eps) / (mu * g);
    const double s = resting(pull);
    model.contact.law = WEFT_FRICTION_COULOMB, model.contact.friction = mu;
    shapes[0].velocity[0] = v, model.origin[1] = dh * (1.0 - s);
    run.ledger = true;
    start();
    go(0.5 * critical);
    ck_assert_double_eq_tol(at(0, 3), 0.5 * mu * g * critical, 1e-9);
    go(critical + 2e-4);
    const double u = v - at(0, 3);
    ck_assert_double_eq_tol(u / (2.0 * eps - u), exp(-2.0 * mu * g * 2e-4 / eps), 1e-6);
    go(critical + 0.02);
    const weft_ledger all = weft_sim_ledger(sim);
    ck_assert_double_eq_tol(at(0, 3), v, 1e-9);
    ck_assert_double_eq_tol(all.dissipated_friction, 0.2 * v * v / 2.0, 1e-7);
    ck_assert_double_eq_tol(all.shape_work, 0.2 * v * v, 1e-7);
}
END_TEST

/* W = sqrt(mu g / r) = 7.004 rad/s holds at r = 0.1 m and mu = 0.5. */
START_TEST(a_turntable_holds_up_to_its_speed)
{
    const double speeds[] = { 6.9, 7.1 }, w = speeds[_i];
    const double pull = 9.81 * model.contact.thickness / 12.5;
    const double s = resting(pull);
    model.contact.law = WEFT_FRICTION_COULOMB, model.contact.friction = 0.5;
    shapes[0].spin[1] = w;
    model.origin[0] = 0.1, model.spacing[1] = 0.01;
    model.origin[1] = model.contact.thickness * (1.0 - s);
    model.velocity[2] = -0.1 * w;
    tolerance(1e-6);
    start();
    go(0.5);
    const double r = hypot(at(0, 0), at(0, 2));
    ck_assert(_i == 0 ? r < 0.101 && r >= 0.1 : r > 0.13);
}
END_TEST

/* The angle at which it leaves tends to cos = 2/3 like sqrt(dh). */
START_TEST(a_ball_is_left_near_two_thirds)
{
    const double thick[] = { 8e-3, 2e-3, 0.5e-3 }, want[] = { 0.609, 0.640, 0.655 };
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.3;
    model.contact.thickness = thick[_i];
    const double r = 0.3 + thick[_i] * (1.0 - resting(9.81 * thick[_i] / 12.5));
    model.origin[0] = 3e-3, model.origin[1] = sqrt(r * r - 9e-6);
    model.spacing[1] = 5.0; /* the other one falls beside it */
    start();
    double cosine = 1.0;
    while (hypot(at(0, 0), at(0, 1)) < 0.3 + thick[_i] || cosine > 0.9) {
        step(3.0);
        cosine = at(0, 1) / hypot(at(0, 0), at(0, 1));
    }
    ck_assert_double_eq_tol(cosine, want[_i], 0.02);
}
END_TEST

TEST_SUITE(contact_laws)
{
    Suite *suite = suite_create("contact_laws");
    TCase *tcase = tcase_create("contact_laws");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, a_drop_turns_at_its_gap_and_comes_back, 0, 3);
    tcase_add_loop_test(tcase, restitution_is_by_law, 0, 8);
    tcase_add_test(tcase, a_rising_plane_throws_at_twice_its_speed);
    tcase_add_test(tcase, a_sheet_rests_at_its_gap);
    tcase_add_test(tcase, an_incline_is_slid_down);
    tcase_add_loop_test(tcase, a_shallow_incline_is_crept_down, 0, 2);
    tcase_add_test(tcase, a_belt_takes_a_particle_along);
    tcase_add_loop_test(tcase, a_turntable_holds_up_to_its_speed, 0, 2);
    tcase_add_loop_test(tcase, a_ball_is_left_near_two_thirds, 0, 3);
    suite_add_tcase(suite, tcase);
    return suite;
}
