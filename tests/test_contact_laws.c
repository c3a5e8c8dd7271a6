/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_contact_laws.c -- contact while time passes: the exact answers and the balances
 * of docs/theory/contact.md. */
#include <stdlib.h>
#include <string.h>

#include "contact_run.h"

/* phi(s) = 2 g (top - gap) / v_c^2 at the deepest point, and the apex is the start. */
START_TEST(a_drop_turns_at_its_gap_and_comes_back)
{
    const double heights[] = { 0.01, 0.5, 8.0 }, top = heights[_i];
    const double dh = model.contact.thickness, short_step = 2e-7 / sqrt(top);
    double low = 1.0;
    model.origin[1] = top;
    start();
    while (at(0, 4) <= 0.0 || gap() < dh) {
        step(gap() < dh ? weft_sim_time(sim) + short_step : 4.0);
        low = fmin(low, gap());
    }
    ck_assert_double_eq_tol(12.5 * phi(1.0 - low / dh), 9.81 * (top - low), 1e-5 * top);
    ck_assert(_i != 1 || fabs(low - 1.897e-3) < 5e-7);
    ck_assert_double_eq_tol(gap() + at(0, 4) * at(0, 4) / (2.0 * 9.81), top,
                            1e-9 * top);
}
END_TEST

/* Several bounces in 3 s, from some heights. */
START_TEST(bounces_keep_the_energy_to_the_tolerance)
{
    static const double tolerances[] = { 1e-6, 1e-8, 1e-10 };
    run.method = test_method_named(_i < 3 ? "arkode/dormand_prince" : "gsl/rk8pd");
    tolerance(tolerances[_i % 3]);
    for (int i = 0; i < 6; ++i) {
        model.origin[1] = 0.5 + 0.01 * i;
        const double whole = 0.2 * 9.81 * model.origin[1];
        start();
        go(3.0);
        const weft_energy energy = weft_sim_measure(sim).energy;
        ck_assert_double_eq_tol(weft_energy_total(energy), whole,
                                100.0 * tolerances[_i % 3] * whole);
    }
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
    ck_assert_double_eq_tol(pow(1.0 + b * b, 1.5) + b * b * b, want, 1e-8);
}
END_TEST

/* The impulse that the shapes have given to the cloth by the time t [N s]: Simpson's
 * rule over two steps of h at a time. */
static void sum_impulse(double t, double h, double impulse[3])
{
    const size_t steps = 2 * (size_t)lround(0.5 * t / h);
    memset(impulse, 0, 3 * sizeof *impulse);
    for (size_t i = 0; i <= steps; ++i) {
        const double weight = i == 0 || i == steps ? 1.0 : i % 2 == 0 ? 2.0 : 4.0;
        go((double)i * h);
        for (size_t k = 0; k < model.contact.shape_count; ++k) {
            double force[3], torque[3];
            weft_sim_shape_load(sim, k, force, torque);
            for (size_t c = 0; c < 3; ++c) {
                impulse[c] -= weight * h / 3.0 * force[c];
            }
        }
    }
}

/* Particles of the mass m at rest: each leaves at 2 V, has got the impulse 2 m V and
 * the work 2 m V^2. */
START_TEST(a_rising_plane_throws_at_twice_its_speed)
{
    const double v = 0.8, m = 0.1;
    double impulse[3];
    memset(model.gravity, 0, sizeof model.gravity);
    model.origin[1] = 0.01, shapes[0].velocity[1] = v;
    run.ledger = true;
    start();
    go(0.3);
    ck_assert_double_eq_tol(at(0, 4), 2.0 * v, 1e-9);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).shape_work, 2.0 * 2.0 * m * v * v,
                            1e-9);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).residual, 0.0, 1e-9);
    start();
    sum_impulse(0.03, 1e-5, impulse);
    ck_assert_double_gt(gap(), model.contact.thickness);
    ck_assert_double_eq_tol(impulse[1], 2.0 * 2.0 * m * v, 1e-10);
    ck_assert(impulse[0] == 0.0 && impulse[2] == 0.0);
}
END_TEST

/* Particles at rest on a plane: phi'(s) = q dh / (rho e), for one particle m g dh / (m
 * e). Starts near there, with damping; then hardly anything moves. */
START_TEST(a_sheet_rests_at_its_gap)
{
    const double dh = model.contact.thickness, pull = 9.81 * dh / 12.5;
    const double s = resting(pull);
    model.rows = 4, model.cols = 5, model.down[1] = 0.0, model.down[2] = 1.0;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.1 };
    model.spacing[0] = model.spacing[1] = 0.1;
    model.damping = 5.0;
    model.origin[1] = dh * (1.0 - s) + 1e-5;
    start();
    go(2.0);
    for (size_t i = 0; i < 20; ++i) {
        ck_assert_double_eq_tol(at(i, 1), dh * (1.0 - s), 1e-12);
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
    ck_assert_double_eq_tol(at(0, 3), want, 4e-10);
}
END_TEST

/* Between two plates, each of which bears half of the weight: with r = T / (mu N), far
 * below 1, smooth E r = sqrt((T / (10 m omega))^2 + (slip r)^2), coulomb slip r / 2. */
START_TEST(a_grip_creeps_at_a_speed_that_friction_does_not_change)
{
    const double dh = 5e-3, slip = 1e-3, s = 0.6, z = 0.4, g = 9.81;
    const double e = 0.5 * 2.0 * 2.0, a = 12.0 * z * z + 8.0 * z * s + 2.0 * s * s;
    const double omega = sqrt(e * s * s * a / (z * z * z)) / dh;
    const double push = e / dh * s * s * s * (4.0 * z + s) / (z * z); /* N / m */
    const double friction = 2.0 * (double)(1 + _i % 2 * 3),
                 r = 0.5 * g / push / friction;
    const double bound = 0.5 * g / (10.0 * omega);
    model.contact.thickness = dh, model.contact.stopping_speed = 2.0;
    model.contact.friction = friction, model.contact.slip = slip;
    model.contact.law = _i < 2 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    model.contact.shape_count = 2;
    for (size_t k = 0; k < 2; ++k) {
        memset(shapes[k].normal, 0, sizeof shapes[k].normal);
        shapes[k].normal[2] = k == 0 ? 1.0 : -1.0;
        shapes[k].at[2] = (k == 0 ? -1.0 : 1.0) * z * dh;
    }
    run.method = test_method_named("stiff/ros2");
    tolerance(1e-8);
    start();
    go(0.2);
    ck_assert_double_eq_tol(at(0, 2), 0.0, 1e-12);
    const double wanted = _i < 2 ? hypot(bound, slip * r) : 0.5 * slip * r;
    ck_assert_double_eq_tol(-at(0, 4), wanted, 0.01 * wanted);
    ck_assert(_i >= 2 || fabs(wanted - bound) < 0.01 * bound);
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
    ck_assert_double_eq_tol(at(0, 3), 0.5 * mu * g * critical, 2e-11);
    go(critical + 2e-4);
    const double u = v - at(0, 3);
    ck_assert_double_eq_tol(u / (2.0 * eps - u), exp(-2.0 * mu * g * 2e-4 / eps), 1e-6);
    go(critical + 0.02);
    const weft_ledger all = weft_sim_ledger(sim);
    ck_assert_double_eq_tol(at(0, 3), v, 1e-11);
    ck_assert_double_eq_tol(all.dissipated_friction, 0.2 * v * v / 2.0, 1e-7);
    ck_assert_double_eq_tol(all.shape_work, 0.2 * v * v, 1e-7);
}
END_TEST

/* W = sqrt(mu g / r) = 7.004 rad/s holds at r = 0.1 m and mu = 0.5. */
START_TEST(a_turntable_holds_up_to_its_speed)
{
    const double speeds[] = { 6.9, 7.0, 7.1 }, radii[] = { 0.1004, 0.1012, 0.136 };
    const double pull = 9.81 * model.contact.thickness / 12.5, w = speeds[_i];
    const double s = resting(pull);
    model.contact.law = WEFT_FRICTION_COULOMB, model.contact.friction = 0.5;
    shapes[0].spin[1] = w;
    model.origin[0] = 0.1, model.spacing[1] = 0.01;
    model.origin[1] = model.contact.thickness * (1.0 - s);
    model.velocity[2] = -0.1 * w;
    tolerance(1e-6);
    start();
    go(0.5);
    ck_assert_double_eq_tol(hypot(at(0, 0), at(0, 2)), radii[_i], _i < 2 ? 5e-5 : 5e-4);
}
END_TEST

/* The angle at which it leaves tends to cos = 2/3 like sqrt(dh): its distance from
 * there is sqrt(dh / R) times a number that stays within 5 %. */
START_TEST(a_ball_is_left_near_two_thirds)
{
    const double thick[] = { 8e-3, 4e-3, 2e-3, 1e-3, 0.5e-3 };
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.3;
    model.contact.thickness = thick[_i];
    const double r = 0.3 + thick[_i] * (1.0 - resting(9.81 * thick[_i] / 12.5));
    model.origin[0] = 3e-3, model.origin[1] = sqrt(r * r - 9e-6);
    model.spacing[1] = 5.0; /* the other one falls beside it */
    start();
    double cosine = 1.0;
    while (hypot(at(0, 0), at(0, 1)) < 0.3 + thick[_i]) {
        step(cosine > 0.75 ? 3.0 : weft_sim_time(sim) + 1e-5);
        cosine = at(0, 1) / hypot(at(0, 0), at(0, 1));
    }
    ck_assert_double_eq_tol((2.0 / 3.0 - cosine) / sqrt(thick[_i] / 0.3), 0.379, 0.019);
}
END_TEST

/* 17 x 17 on a ball, 0.6 s, with friction: left and right are mirror images. */
START_TEST(a_sheet_on_a_ball_is_symmetric)
{
    enum { SIDE = 17, COUNT = SIDE * SIDE };
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.3, shapes[0].at[1] = -0.35;
    model.rows = model.cols = SIDE, model.mass = 0.0, model.density = 0.2;
    model.spacing[0] = model.spacing[1] = 1.0 / (SIDE - 1);
    model.origin[0] = model.origin[2] = -0.5;
    model.down[1] = 0.0, model.down[2] = 1.0;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    model.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
    model.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.001 };
    model.contact.friction = 0.3, model.contact.damping = 1.0;
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-6);
    start();
    go(0.6);
    ck_assert_uint_gt(weft_sim_measure(sim).touching, 0);
    for (size_t i = 0; i < COUNT; ++i) {
        const size_t mirror = i - i % SIDE + (SIDE - 1 - i % SIDE);
        ck_assert_double_eq_tol(at(i, 0), -at(mirror, 0), 1e-10);
        ck_assert_double_eq_tol(at(i, 1), at(mirror, 1), 1e-10);
        ck_assert_double_eq_tol(at(i, 2), at(mirror, 2), 1e-10);
    }
}
END_TEST

/* ---- balances -------------------------------------------------------------------- */

/* A loose sheet over a ball that spins and a box that rises. */
static void sheet_on_ball_and_box(void)
{
    shapes[0] = weft_shape_default(WEFT_SPHERE), shapes[0].radius = 0.1;
    shapes[0].at[1] = -0.11, shapes[0].spin[0] = 5.0, shapes[0].spin[1] = 3.0;
    shapes[1] = weft_shape_default(WEFT_BOX), shapes[1].rounding = 0.02;
    shapes[1].at[0] = 0.15, shapes[1].at[1] = -0.15, shapes[1].velocity[1] = 0.5;
    for (size_t k = 0; k < 3; ++k) {
        shapes[1].half[k] = 0.1;
    }
    level_sheet();
    model.contact.shape_count = 2, model.contact.friction = 0.3;
    model.contact.damping = 1.0;
}

/* P(t) - P(0) - M g t is the impulse of the shapes. */
START_TEST(momentum_comes_from_gravity_and_shapes)
{
    const double t = 0.2;
    double impulse[3];
    sheet_on_ball_and_box();
    start();
    const double *g = model.gravity, mass = weft_cloth_mass(cloth);
    sum_impulse(t, 5e-5, impulse);
    const weft_measures now = weft_sim_measure(sim);
    for (size_t k = 0; k < 3; ++k) {
        ck_assert_double_gt(fabs(impulse[k]), 1e-3);
        ck_assert_double_eq_tol(now.momentum[k] - mass * g[k] * t, impulse[k], 1e-7);
    }
}
END_TEST

/* About the vertical axis through its centre. */
START_TEST(a_smooth_ball_keeps_the_angular_momentum)
{
    sheet_on_ball_and_box();
    model.contact.shape_count = 1, shapes[0].friction = 0.0;
    model.velocity[0] = 0.3, model.velocity[2] = 0.1;
    model.origin[0] += 0.02;
    start();
    const double before = weft_sim_measure(sim).angular_momentum[1];
    go(0.2);
    const weft_measures now = weft_sim_measure(sim);
    ck_assert_uint_gt(now.touching, 0);
    ck_assert_double_gt(fabs(before), 1e-4);
    ck_assert_double_eq_tol(now.angular_momentum[1], before, 1e-15);
}
END_TEST

/* A chain that pins at its ends draw over a roller, which turns against it: a particle
 * where the chain turns by D feels N = (T1 + T2) sin(D / 2) and mu N = (T2 - T1) cos(D
 * / 2), so that the pulls of the ends tend to the ratio exp(mu angle). */
START_TEST(a_roller_pulls_a_chain_by_the_law_of_capstans)
{
    enum { LINKS = 30, COUNT = LINKS + 1 };
    static const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                     { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    static const double angles[] = { 90.0, 180.0, 250.0 }, mus[] = { 0.3, 0.5, 0.3 };
    const double angle = angles[_i] * acos(-1.0) / 180.0, r = 0.104;
    const double length = r * angle + 0.1;
    double x[3 * COUNT] = { 0 }, pull[2];
    shapes[0] = weft_shape_default(WEFT_CAPSULE);
    shapes[0].radius = 0.1, shapes[0].at[2] = -1.0;
    shapes[0].to[0] = 0.0, shapes[0].to[2] = 1.0, shapes[0].spin[2] = 5.0;
    memset(model.gravity, 0, sizeof model.gravity);
    model.cols = COUNT, model.mass = 1e-3, model.damping = 0.02, model.origin[1] = 1.0;
    model.spacing[1] = 0.9 * length / LINKS;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 1000.0, .damping = 0.3 };
    model.pins = pins, model.pin_count = 2;
    model.contact.law = WEFT_FRICTION_COULOMB, model.contact.friction = mus[_i];
    model.contact.damping = 1.0;
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-7);
    start();
    for (size_t i = 0; i < COUNT; ++i) { /* straight, round, straight */
        const double s = length * ((double)i / LINKS - 0.5);
        const double turn = fmax(-0.5 * angle, fmin(0.5 * angle, s / r));
        x[3 * i] = r * sin(turn) + (s - r * turn) * cos(turn);
        x[3 * i + 1] = r * cos(turn) - (s - r * turn) * sin(turn);
    }
    ck_assert_int_eq(weft_sim_move_pin(sim, 0, x, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_move_pin(sim, LINKS, x + 3 * LINKS, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, &err), WEFT_OK);
    go(2.0);
    for (size_t e = 0; e < 2; ++e) {
        const size_t i = e * (LINKS - 1);
        const double now = hypot(at(i + 1, 0) - at(i, 0), at(i + 1, 1) - at(i, 1));
        pull[e] = now - model.spacing[1];
    }
    ck_assert_double_lt(weft_sim_measure(sim).energy.kinetic, 1e-12);
    ck_assert_double_eq_tol(pull[1] / pull[0] / exp(mus[_i] * angle), 1.0, 0.03);
}
END_TEST

/* ---- a start in touch -------------------------------------------------------------
 */

/* At 0.3 thickness the potential throws it off at v with phi(s) = (v / v_c)^2, from a
 * plane that moves at V from t = 0 on by -v relative to it. */
START_TEST(a_start_in_touch_is_thrown_off)
{
    const double dh = model.contact.thickness, s = 0.7, v = _i == 0 ? 0.0 : -0.5;
    const double kn
        = 12.5 / dh / dh * s * s * (12.0 - 16.0 * s + 6.0 * s * s) / pow(1.0 - s, 3.0);
    memset(model.gravity, 0, sizeof model.gravity);
    model.origin[1] = (1.0 - s) * dh, shapes[0].velocity[1] = v;
    start();
    const double omega2 = weft_cloth_stiffness(cloth, 0.0, weft_sim_state(sim)).omega2;
    ck_assert_double_eq_tol(omega2, kn, 1e-9 * kn);
    go(0.1);
    ck_assert_double_gt(gap(), dh);
    ck_assert_double_eq_tol(at(0, 4), v + sqrt(25.0 * phi(s) + v * v), 1e-8);
}
END_TEST

/* ---- orders ---------------------------------------------------------------------- */

/* Root mean square over the particles, relative to thickness and speed. */
static double mean_error(const double *exact, double speed)
{
    const size_t n = weft_cloth_particles(cloth);
    double sum = 0.0;
    for (size_t j = 0; j < 6 * n; ++j) {
        const double unit = j < 3 * n ? model.contact.thickness : speed;
        const double error = (weft_sim_state(sim)[j] - exact[j]) / unit;
        sum += error * error / (double)n;
    }
    return sqrt(sum);
}

/* By its errors at the time t with the step h and a quarter of it. */
static double order_of(const char *method, double h, double t, const double *exact,
                       double speed)
{
    double error[2];
    run.method = test_method_named(method);
    for (size_t i = 0; i < 2; ++i) {
        run.config.fixed_step = i == 0 ? h : 0.25 * h;
        start();
        go(t);
        error[i] = mean_error(exact, speed);
    }
    return log2(error[0] / error[1]) / 2.0;
}

static void solve(double t, double *exact)
{
    tolerance(1e-13);
    start();
    go(t);
    memcpy(exact, weft_sim_state(sim), weft_cloth_dim(cloth) * sizeof *exact);
}

static const struct {
    const char *name;
    double order, step;
} of_order[] = {
    { "verlet/velocity_verlet", 2.0, 1e-4 },
    { "arkode/bogacki_shampine", 3.0, 1e-4 },
    { "arkode/rk4", 4.0, 5e-5 },
    { "arkode/dormand_prince", 5.0, 5e-5 },
    { "gsl/rk8pd", 8.0, 1.6e-4 },
};

enum { METHODS = sizeof of_order / sizeof of_order[0] };

/* The force begins like the power p - 1 of the depth: a method of order q is of order
 * min(q, p), or somewhat better. Particles that arrive one after another. */
START_TEST(the_exponent_limits_the_order)
{
    enum { COUNT = 24 };
    const int exponents[] = { 3, 4, 5, 6, 8 }, p = exponents[_i];
    const double v = 3.0, t = 0.012;
    double exact[6 * COUNT];
    memset(model.gravity, 0, sizeof model.gravity);
    model.rows = COUNT, model.cols = 1, model.spacing[0] = 1.6e-4 * v / COUNT;
    model.origin[1] = 0.0105, model.velocity[1] = -v, model.contact.exponent = p;
    solve(t, exact);
    for (size_t i = 4 * COUNT; i < 5 * COUNT; ++i) {
        ck_assert_double_eq_tol(exact[i], v, 1e-10);
    }
    for (size_t m = 0; m < METHODS; ++m) {
        const double order = order_of(of_order[m].name, of_order[m].step, t, exact, v);
        const double least = fmin(of_order[m].order, p);
        ck_assert_msg(order > least - 0.5, "%s: order %g", of_order[m].name, order);
        ck_assert_msg(p > 4 || order < least + 1.0, "%s: order %g", of_order[m].name,
                      order);
    }
}
END_TEST

/* The same on a capsule and a box that turn, whose surface moves up and aside. */
START_TEST(landings_on_shapes_that_turn_keep_the_order)
{
    enum { COUNT = 24 };
    const double v = 3.0, t = 0.012;
    double exact[6 * COUNT];
    shapes[0] = weft_shape_default(_i == 0 ? WEFT_CAPSULE : WEFT_BOX);
    shapes[0].radius = 0.1, shapes[0].at[1] = shapes[0].to[1] = -0.1;
    shapes[0].at[0] = _i == 0 ? -0.2 : 0.0, shapes[0].to[0] = 0.2;
    shapes[0].half[0] = 0.2, shapes[0].half[1] = 0.1, shapes[0].half[2] = 0.1;
    shapes[0].turn
        = (weft_turn){ { 0.3, 0.2, 1.0 }, { 0.0, -0.1, 0.0 }, 10.0, 0.1, 9.0 };
    memset(model.gravity, 0, sizeof model.gravity);
    model.rows = COUNT, model.cols = 1, model.spacing[0] = 1.6e-4 * v / COUNT;
    model.origin[0] = 0.06, model.origin[1] = 0.0165, model.velocity[1] = -v;
    solve(t, exact);
    ck_assert_uint_eq(weft_sim_measure(sim).touching, 0);
    ck_assert_double_gt(exact[4 * COUNT], v);
    for (size_t m = 0; m < METHODS; ++m) {
        const double order = order_of(of_order[m].name, of_order[m].step, t, exact, v);
        ck_assert_msg(order > fmin(of_order[m].order, 4.0) - 0.5, "%s: order %g",
                      of_order[m].name, order);
    }
}
END_TEST

/* Along a capsule and over its join, in touch with it all the time. */
START_TEST(the_join_of_a_capsule_keeps_the_order)
{
    const double t = 0.05;
    double exact[12];
    shapes[0] = weft_shape_default(WEFT_CAPSULE);
    shapes[0].radius = 0.1, shapes[0].at[1] = shapes[0].to[1] = -0.1;
    shapes[0].at[0] = -1.0, shapes[0].to[0] = 0.0;
    model.origin[0] = -0.0235, model.origin[1] = 0.0045, model.spacing[1] = 1e-3;
    model.velocity[0] = 1.0;
    solve(t, exact);
    ck_assert_double_gt(at(0, 0), 0.02);
    ck_assert_uint_eq(weft_sim_measure(sim).touching, 2);
    for (size_t m = 0; of_order[m].order < 8.0; ++m) {
        const double order = order_of(of_order[m].name, 1e-3, t, exact, 1.0);
        ck_assert_msg(order > of_order[m].order - 0.2, "%s: order %g", of_order[m].name,
                      order);
    }
}
END_TEST

TEST_SUITE(contact_laws)
{
    Suite *suite = suite_create("contact_laws");
    TCase *tcase = tcase_create("contact_laws");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    TCase *slow = test_long(suite, 120.0);
    tcase_add_checked_fixture(slow, setup, teardown);
    tcase_add_loop_test(tcase, a_drop_turns_at_its_gap_and_comes_back, 0, 3);
    tcase_add_loop_test(tcase, bounces_keep_the_energy_to_the_tolerance, 0, 6);
    tcase_add_loop_test(tcase, restitution_is_by_law, 0, 8);
    tcase_add_test(tcase, a_rising_plane_throws_at_twice_its_speed);
    tcase_add_test(tcase, a_sheet_rests_at_its_gap);
    tcase_add_test(tcase, an_incline_is_slid_down);
    tcase_add_loop_test(tcase, a_shallow_incline_is_crept_down, 0, 2);
    tcase_add_loop_test(tcase, a_grip_creeps_at_a_speed_that_friction_does_not_change,
                        0, 4);
    tcase_add_test(tcase, a_belt_takes_a_particle_along);
    tcase_add_loop_test(tcase, a_turntable_holds_up_to_its_speed, 0, 3);
    tcase_add_loop_test(tcase, a_ball_is_left_near_two_thirds, 0, 5);
    tcase_add_test(slow, a_sheet_on_a_ball_is_symmetric);
    tcase_add_loop_test(tcase, a_start_in_touch_is_thrown_off, 0, 2);
    tcase_add_test(slow, momentum_comes_from_gravity_and_shapes);
    tcase_add_test(tcase, a_smooth_ball_keeps_the_angular_momentum);
    tcase_add_loop_test(tcase, a_roller_pulls_a_chain_by_the_law_of_capstans, 0, 3);
    tcase_add_loop_test(tcase, the_exponent_limits_the_order, 0, 5);
    tcase_add_loop_test(tcase, landings_on_shapes_that_turn_keep_the_order, 0, 2);
    tcase_add_test(tcase, the_join_of_a_capsule_keeps_the_order);
    suite_add_tcase(suite, tcase);
    return suite;
}
