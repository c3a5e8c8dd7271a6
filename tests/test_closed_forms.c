/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_closed_forms.c -- simulations whose result is known on paper
 * (docs/theory/model.md). Where a method has an error, its bound is derived in a
 * comment. Equilibria need no order: what drag brings to rest is where the forces
 * vanish, with any method. */
#include "support.h"

#include <complex.h>
#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define MOST         64 /* particles */
#define G            9.81
#define VERLET       test_method_named("verlet/velocity_verlet")

/* The most accurate method, its fixed step if it has one, and how far it may be off in
 * about 1 s. Verlet's phase is off by w^3 h^2 t / 24, below 2e-6 for w < 50 /s. */
#ifdef HAVE_GSL
#define BEST  test_method_named("gsl/rk8pd"), 0.0
#define CLOSE 1e-10
#else
#define BEST  VERLET, 2e-5
#define CLOSE 2e-6
#endif

static const weft_range all = { 0, -1 }, first = { 0, 0 }, last = { -1, -1 };
static const weft_pin ends[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                 { .rows = { 0, 0 }, .cols = { -1, -1 } } };

/* One simulation at a time. x and v are x y z of one particle after the other; once
 * edited, restart() makes them the state. */
static weft_cloth_def def;
static weft_cloth *cloth;
static weft_sim *sim;
static const double *y;
static size_t n;
static double x[3 * MOST], v[3 * MOST], pi;

/* Stretch springs only. The first `pins` of ends are pinned. */
static void plain(size_t rows, size_t cols, double mass, double stiffness,
                  double gravity, size_t pins)
{
    def = weft_cloth_def_default();
    def.rows = rows, def.cols = cols;
    def.density = 0.0, def.mass = mass;
    def.gravity[1] = -gravity;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = stiffness, .damping = 0.0 };
    def.pins = ends, def.pin_count = pins;
}

static void go(double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
    weft_sim_positions(sim, x);
    weft_sim_velocities(sim, v);
}

/* In steps of h, or adaptive with 1e-13. */
static void start(const weft_stepper_type *method, double h)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.rtol = 0.0;
    config.atol_position = config.atol_velocity = 1e-13;
    config.fixed_step = h;
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    cloth = test_cloth(&def);
    sim = test_sim(cloth, method, &config);
    n = weft_cloth_particles(cloth);
    y = weft_sim_state(sim);
    pi = acos(-1.0);
    go(0.0);
}

static void restart(void)
{
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, NULL), WEFT_OK);
}

static void near(double a, double b, double tolerance)
{
    ck_assert_msg(fabs(a - b) <= tolerance, "%.17g, not %.17g: %.3g off", a, b, a - b);
}

static void near3(const double *a, double b0, double b1, double b2, double tolerance)
{
    near(a[0], b0, tolerance);
    near(a[1], b1, tolerance);
    near(a[2], b2, tolerance);
}

static double energy(void)
{
    const weft_energy e = weft_cloth_energy(cloth, 0.0, y);
    return e.kinetic + e.gravitational + e.elastic[0] + e.elastic[1] + e.elastic[2];
}

/* x = x0 + v0 t + g t^2 / 2: exact from order 2 on; the Eulers are off by g h t / 2. */
START_TEST(free_fall_is_a_parabola)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    if (type->order == 0 || (type->flags & WEFT_STEPPER_IMPLICIT) != 0) {
        return; /* starts with order 1, or iterates to a tolerance */
    }
    const double h = strcmp(type->name, "symplectic_euler") == 0 ? 0.01 : -0.01;
    const double fallen = G / 2 + (type->order > 1 ? 0.0 : G * h / 2);
    /* verner65_9 weighs stages, and the roundoff in their springs, by up to 176 */
    const double tiny = strcmp(type->name, "verner65_9") == 0 ? 1e-11 : 1e-12;
    plain(3, 4, 0.1, 20.0, G, 0);
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.1 };
    def.velocity[1] = 2.0, def.velocity[2] = -3.0;
    start(type, fabs(h));
    go(1.0);
    for (size_t i = 0; i < n; ++i) {
        near3(x + 3 * i, (double)(i % 4), 2.0 - (double)(i / 4) - fallen, -3.0, tiny);
        near3(v + 3 * i, 0.0, 2.0 - G, -3.0, tiny);
    }
    near(weft_cloth_worst_spring(cloth, y).strain, 0.0, tiny);
}
END_TEST

/* u'' + 2 z w u' + w^2 u = 0 from (1, 0): oscillating, critical or creeping */
static double oscillator(double z, double w, double t)
{
    const double complex root = w * csqrt(z * z - 1.0);
    const double complex sine = z == 1.0 ? t : csinh(root * t) / root;
    return exp(-z * w * t) * creal(ccosh(root * t) + z * w * sine);
}

START_TEST(mass_on_a_spring_is_a_damped_oscillator)
{
    const double zetas[] = { 0, 0.1, 1, 3 }, m = 0.5, w = 4.0, sag = G / (w * w);
    for (size_t i = 0; i < 2 * COUNT(zetas); ++i) {
        double *c = i % 2 == 0 ? &def.damping : &def.springs[WEFT_STRETCH].damping;
        plain(2, 1, m, m * w * w, G, 1);
        *c = zetas[i / 2] * 2.0 * m * w;
        start(BEST);
        for (double t = 0.25; t < 2.0; t += 0.25) {
            go(t);
            near(x[4] + 1.0 + sag, sag * oscillator(zetas[i / 2], w, t), CLOSE);
        }
    }
}
END_TEST

/* Along its axis a spring is linear: u = u0 cos(n th), th = 2 asin(w h / 2), where the
 * other starts half a step later. Roundoff: 1000 eps / sin th. */
START_TEST(numerical_frequency_is_2_over_h_asin_of_half_w_h)
{
    const double wh[] = { 0.1, 0.7, 1.5, 1.9 }, w = 20.0;
    plain(1, 2, 0.05, 0.05 * w * w, 0.0, 1);
    for (size_t i = 0; i < 2 * COUNT(wh); ++i) {
        const bool verlet = i % 2 == 0;
        const double h = wh[i / 2] / w, later = verlet ? 0.0 : 0.5;
        const double th = 2.0 * asin(0.5 * w * h);
        start(verlet ? VERLET : test_method_named("verlet/symplectic_euler"), h);
        x[3] += 0.25;
        restart();
        for (int steps = 1; steps <= 1000; ++steps) {
            go(steps * h);
            const double u = cos((steps + later) * th) / cos(later * th);
            near(x[3], 1.0 + 0.25 * u, 4e-12);
        }
    }
}
END_TEST

/* v' = -k v, k = drag / m: oscillating from h k > 1, exploding from h k > 2. */
START_TEST(euler_multiplies_by_1_minus_h_k)
{
    const double hk[] = { 0.1, 1.0, 1.5, 2.5 };
    for (size_t i = 0; i < COUNT(hk); ++i) {
        plain(1, 2, 0.25, 0.0, 0.0, 0);
        def.damping = 1.0;
        def.velocity[2] = 3.0;
        start(test_method_named("verlet/euler"), hk[i] / 4.0);
        for (int steps = 1; steps <= 60; ++steps) {
            go(steps * hk[i] / 4.0);
            const double expected = 3.0 * pow(1.0 - hk[i], steps);
            near(v[5], expected, 1e-13 * fabs(expected));
        }
    }
}
END_TEST

/* 0.1 kg on a spring of 1 m */
static void pendulum(double k, const double at[3], const double speed[3])
{
    plain(1, 2, 0.1, k, G, 1);
    start(BEST);
    memcpy(x + 3, at, 3 * sizeof *x);
    memcpy(v + 3, speed, 3 * sizeof *v);
    restart();
}

/* At 30 degrees: l = s + m g / (k cos th), W^2 = g / (l cos th). */
START_TEST(conical_pendulum_returns)
{
    const double l = 1.022655224563, speed = 1.701781557773, period = 1.887883980155;
    const double s = 0.5 * l, c = sqrt(0.75) * l;
    pendulum(50.0, (double[]){ s, -c, 0.0 }, (double[]){ 0.0, 0.0, speed });
    go(0.5 * period);
    near3(x + 3, -s, -c, 0.0, CLOSE);
    go(period);
    near3(x + 3, s, -c, 0.0, CLOSE);
    near3(v + 3, 0.0, 0.0, speed, CLOSE);
}
END_TEST

START_TEST(spherical_pendulum_keeps_energy_and_vertical_moment)
{
    double l0[3], l[3];
    pendulum(50.0, (double[]){ 0.6, -0.5, 0.7 }, (double[]){ -1.0, 0.5, 2.0 });
    const double e = energy();
    weft_cloth_angular_momentum(cloth, y, l0);
    for (double t = 0.1; t < 2.0; t += 0.1) {
        go(t);
        weft_cloth_angular_momentum(cloth, y, l);
        near(energy(), e, CLOSE);
        near(l[1], l0[1], CLOSE);
    }
}
END_TEST

/* From 90 degrees the rigid pendulum is at the bottom after a quarter of its period,
 * 2.367841947576 s for 1 m. On a spring e = m g / k is small: tension 3 m g cos th
 * makes l = 1 + 3 e cos th, energy then th'^2 = 2 g cos th (1 - 7.5 e cos th), and it
 * is late at the bottom by x = 3.75 e times the integral of sqrt(cos th). */
START_TEST(plane_pendulum_tends_to_the_rigid_one)
{
    for (double k = 1e3; k < 2e4; k *= 4.0) {
        const double e = 0.1 * G / k;
        pendulum(k, (double[]){ 1.0, 0.0, 0.0 }, (double[3]){ 0 });
        go(2.367841947576 / 4.0);
        near(x[3], 3.75 * 1.198140234736 * e, 20.0 * e * e);
    }
}
END_TEST

/* Masses of 1/16 and 1/4 kg: mu = 1/20 kg. Turning, l = s / (1 - mu W^2 / k). */
START_TEST(two_masses_vibrate_and_turn_about_their_centre)
{
    const weft_load load = { .rows = { 0, 0 }, .cols = { 1, 1 }, .mass = 0.1875 };
    for (int turning = 0; turning < 2; ++turning) {
        plain(1, 2, 0.0625, 10.0, 0.0, 0);
        def.loads = &load, def.load_count = 1;
        def.velocity[0] = 1.0, def.velocity[1] = 2.0;
        start(BEST);
        const double w = turning ? 4.0 : sqrt(10.0 / 0.05);
        const double l = turning ? 1.086956521739 : 1.2, speed = turning ? l * w : 0.0;
        x[0] = -0.8 * l, x[3] = 0.2 * l;
        v[1] -= 0.8 * speed, v[4] += 0.2 * speed;
        restart();
        for (double t = 0.125; t < 1.0; t += 0.125) {
            go(t);
            const double d0 = turning ? l * cos(w * t) : 1.0 + 0.2 * cos(w * t);
            const double d1 = turning ? l * sin(w * t) : 0.0;
            for (size_t k = 0; k < 3; ++k) {
                near(0.2 * x[k] + 0.8 * x[3 + k], def.velocity[k] * t, 1e-11);
                near(0.2 * v[k] + 0.8 * v[3 + k], def.velocity[k], 1e-12);
            }
            near(x[3] - x[0], d0, CLOSE);
            near(x[4] - x[1], d1, CLOSE);
        }
    }
}
END_TEST

/* A damped cloth without pins, strained and spinning. */
static void spin(const weft_stepper_type *method, double h, double l[3])
{
    plain(4, 5, 0.1, 20.0, 0.0, 0);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 20.0, .damping = 0.05 };
    }
    start(method, h);
    for (size_t j = 0; j < 3 * n; ++j) {
        x[j] += 0.1 * sin((double)(3 * j * j));
        v[j] = sin((double)(j * j + j));
    }
    restart();
    weft_cloth_angular_momentum(cloth, y, l);
}

/* Verlet kicks at the x that the forces are of, and keeps both momenta. */
START_TEST(free_damped_cloth_keeps_momenta_and_loses_energy)
{
    double p0[3], p[3], l0[3], l[3];
    spin(VERLET, 1e-3, l0);
    weft_cloth_momentum(cloth, y, p0);
    for (double e = energy(); weft_sim_time(sim) < 1.0; e = energy()) {
        ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
        ck_assert_double_lt(energy(), e);
        weft_cloth_momentum(cloth, y, p);
        weft_cloth_angular_momentum(cloth, y, l);
        near3(p, p0[0], p0[1], p0[2], 1e-12);
        near3(l, l0[0], l0[1], l0[2], 1e-12);
    }
}
END_TEST

START_TEST(midpoint_keeps_angular_momentum_to_order_2)
{
    double l0[3], l[3], off[2];
    for (int i = 0; i < 2; ++i) {
        spin(test_method_named("verlet/midpoint"), i == 0 ? 1e-4 : 5e-5, l0);
        go(1.0);
        weft_cloth_angular_momentum(cloth, y, l);
        off[i] = fabs(l[0] - l0[0]) + fabs(l[1] - l0[1]) + fabs(l[2] - l0[2]);
    }
    near(log2(off[0] / off[1]), 2.0, 0.1);
}
END_TEST

/* 5 masses, _i ends fixed: w = 2 w0 sin(half), where half is half the phase from one to
 * the next. Along the chain the springs are linear at any amplitude. */
START_TEST(chains_have_their_longitudinal_frequencies)
{
    plain(1, (size_t)(5 + _i), 0.2, 20.0, 0.0, (size_t)_i); /* w0 = 10 /s */
    for (int j = 0; j < 5; ++j) {
        start(BEST);
        const int jj = _i == 0 ? 2 * j : 2 * j + 2 - (_i == 1);
        const double half = jj * pi / (20 + 2 * _i);
        double shape[7];
        for (size_t i = 0; i < n; ++i) {
            const double at = 2.0 * half * (double)i;
            shape[i] = 0.1 * (_i == 0 ? cos(at + half) : sin(at));
            x[3 * i] += shape[i];
        }
        restart();
        for (double t = 0.2; t < 1.1; t += 0.2) {
            go(t);
            for (size_t i = 0; i < n; ++i) {
                const double u = shape[i] * cos(20.0 * sin(half) * t);
                near3(x + 3 * i, (double)i + u, 0.0, 0.0, CLOSE);
            }
        }
    }
}
END_TEST

/* 3 x 4 particles in a frame that stretches all springs from s to l, out of its plane.
 * At an amplitude of 1e-6 l what is not linear is 1e-12 of the force. */
START_TEST(tight_grid_has_its_transverse_frequencies)
{
    const weft_pin rim[] = { { .rows = first, .cols = all },
                             { .rows = last, .cols = all },
                             { .rows = all, .cols = first },
                             { .rows = all, .cols = last } };
    const double s = 0.4, l = 0.5, m = 0.01, k1 = 30.0, k2 = 12.0;
    const double t1 = k1 * (l - s), t2 = k2 * sqrt(2.0) * (l - s);
    plain(5, 6, m, k1, 0.0, 0);
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = k2, .damping = 0.0 };
    def.spacing[0] = def.spacing[1] = s, def.scale = l / s;
    def.pins = rim, def.pin_count = COUNT(rim);
    for (int mode = 0; mode < 12; ++mode) {
        double dydt[6 * MOST];
        start(BEST);
        const double p = (mode / 4 + 1) * pi / 4, q = (mode % 4 + 1) * pi / 5;
        const double sines = pow(sin(0.5 * p), 2) + pow(sin(0.5 * q), 2);
        const double tension = t1 * sines + t2 / sqrt(2.0) * (1.0 - cos(p) * cos(q));
        const double w2 = 4.0 * tension / (m * l);
        for (size_t i = 0; i < n; ++i) {
            x[3 * i + 2] = 5e-7 * sin(p * (double)(i / 6)) * sin(q * (double)(i % 6));
        }
        restart();
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
        for (size_t i = 0; i < n; ++i) {
            near(dydt[5 * n + i], -w2 * y[2 * n + i], 1e-17 * w2 * l);
        }
    }
}
END_TEST

/* With drag, until nothing moves. */
static void relax(double h, double t)
{
    start(VERLET, h);
    go(t);
}

START_TEST(hanging_column_carries_what_is_below)
{
    const double m = 0.1, k = 50.0, s = 0.5;
    plain(6, 1, m, k, G, 1); /* lowest frequency: 6.4 /s */
    def.spacing[0] = s, def.damping = 2.0 * m * 6.4;
    relax(1e-3, 8.0);
    for (size_t i = 1; i < n; ++i) {
        const double carried = k * (x[3 * i - 2] - x[3 * i + 1] - s);
        near(carried, m * G * (double)(n - i), 1e-11);
    }
    near(x[16], -(5 * s + m * G * 5 * 6 / (2 * k)), 1e-12);
}
END_TEST

/* Two columns, each half a sheet of 0.3 m, end in half masses: 0.3 kg/m^2 and 100 N/m
 * extend by density g L^2 / (2 Y) for every number of rows. */
START_TEST(hanging_sheet_extends_alike_at_any_resolution)
{
    const weft_pin top = { .rows = first, .cols = all };
    for (size_t springs = 1; springs <= 10; ++springs) {
        const double a = 1.0 / (double)springs;
        plain(springs + 1, 2, 0.0, 100.0 * 0.15 / a, G, 1);
        def.spacing[0] = a, def.spacing[1] = 0.3, def.density = 0.3;
        def.damping = 28.7 * 0.3 * a * 0.15; /* lowest frequency: 28.7 /s */
        def.pins = &top;
        relax(1e-3, 3.0);
        near3(x + 3 * n - 6, 0.0, -1.014715, 0.0, 1e-13);
        near3(x + 3 * n - 3, 0.3, -1.014715, 0.0, 1e-13);
    }
}
END_TEST

/* `count` springs, 1.2 m, 0.1 kg, 120 N, hung up 1 m apart: the nodes for a horizontal
 * pull h, as docs/theory/model.md has them; returns the distance that they span. */
static double catenary(double count, double h, double *node)
{
    memset(node, 0, 3 * MOST * sizeof *node);
    for (int i = 1; i <= count; ++i, node += 3) {
        const double up = 0.1 / count * G * ((count + 1.0) / 2.0 - i);
        const double t = sqrt(h * h + up * up), l = 1.2 / count + t / (100.0 * count);
        node[3] = node[0] + l * h / t;
        node[4] = node[1] - l * up / t;
    }
    return node[0];
}

START_TEST(hanging_chain_is_the_discrete_catenary)
{
    const double table[][3] = { { 4, .371750512322, .306220686828 },
                                { 8, .376655946662, .298576771676 },
                                { 10, .377262274863, .297703661134 },
                                { 16, .377921108132, .296767640461 } };
    const double count = table[_i][0], pull = table[_i][1], sag = table[_i][2];
    double node[3 * MOST], f[3 * MOST], dydt[6 * MOST], low = 0.1, high = 1.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        *(catenary(count, middle, node) < 1.0 ? &low : &high) = middle;
    }
    near(low, pull, 1e-12);
    near(node[3 * (int)count / 2 + 1], -sag, 1e-12);
    plain(1, (size_t)count + 1, 0.1 / count, 100.0 * count, G, 2);
    def.spacing[1] = 1.2 / count, def.scale = 1.0 / 1.2;
    def.damping = 14.0 * def.mass;
    relax(1e-3, 6.0);
    weft_cloth_force(cloth, 0.0, y, f);
    near(f[0], pull, 1e-10);
    for (size_t i = 0; i < n; ++i) {
        near3(x + 3 * i, node[3 * i], node[3 * i + 1], 0.0, 1e-10);
    }
    memcpy(x, node, sizeof x);
    memset(v, 0, sizeof v);
    restart();
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
    for (size_t j = 3 * n; j < 6 * n; ++j) {
        near(dydt[j], 0.0, 1e-9);
    }
}
END_TEST

START_TEST(pins_at_rest_carry_the_weight)
{
    double f[3 * MOST];
    plain(4, 5, 0.01, 20.0, G, 2);
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 10.0, .damping = 0.01 };
    def.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 10.0, .damping = 0.01 };
    def.spacing[0] = 0.5, def.gravity[0] = 1.5;
    def.damping = 0.1;
    relax(2e-3, 20.0);
    weft_cloth_force(cloth, 0.0, y, f);
    near(f[0] + f[4], 20 * 0.01 * 1.5, 1e-10);
    near(f[n] + f[n + 4], -20 * 0.01 * G, 1e-10);
}
END_TEST

TEST_SUITE(closed_forms)
{
    Suite *suite = suite_create("closed forms");
    TCase *tcase = tcase_create("closed forms");
    suite_add_tcase(suite, tcase);
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, free_fall_is_a_parabola, 0, (int)test_method_count());
    tcase_add_test(tcase, mass_on_a_spring_is_a_damped_oscillator);
    tcase_add_test(tcase, numerical_frequency_is_2_over_h_asin_of_half_w_h);
    tcase_add_test(tcase, euler_multiplies_by_1_minus_h_k);
    tcase_add_test(tcase, conical_pendulum_returns);
    tcase_add_test(tcase, spherical_pendulum_keeps_energy_and_vertical_moment);
    tcase_add_test(tcase, plane_pendulum_tends_to_the_rigid_one);
    tcase_add_test(tcase, two_masses_vibrate_and_turn_about_their_centre);
    tcase_add_test(tcase, free_damped_cloth_keeps_momenta_and_loses_energy);
    tcase_add_test(tcase, midpoint_keeps_angular_momentum_to_order_2);
    tcase_add_loop_test(tcase, chains_have_their_longitudinal_frequencies, 0, 3);
    tcase_add_test(tcase, tight_grid_has_its_transverse_frequencies);
    tcase_add_test(tcase, hanging_column_carries_what_is_below);
    tcase_add_test(tcase, hanging_sheet_extends_alike_at_any_resolution);
    tcase_add_loop_test(tcase, hanging_chain_is_the_discrete_catenary, 0, 4);
    tcase_add_test(tcase, pins_at_rest_carry_the_weight);
    return suite;
}
