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

/* The s of phi'(s) = s^3 (4 - 3 s) / (1 - s)^2 = pull, for a small one. */
static double resting(double pull)
{
    double s = 0.1;
    for (int i = 0; i < 2000; ++i) {
        s -= 0.1 * (s * s * s * (4.0 - 3.0 * s) / ((1.0 - s) * (1.0 - s)) - pull);
    }
    return s;
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

static double noise(uint64_t *seed) /* in (-1, 1) */
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* A shape of some size at the origin, not a plane. */
static weft_shape any_shape(uint64_t *seed)
{
    weft_shape shape = weft_shape_default((weft_shape_kind)(1 + (*seed >> 40) % 3));
    shape.radius = 0.05 * (1.1 + noise(seed));
    shape.rounding = 1e-3;
    for (size_t k = 0; k < 3; ++k) {
        shape.to[k] = 0.3 * noise(seed);
        shape.half[k] = 2e-3 + 0.1 * (1.0 + noise(seed));
        shape.velocity[k] = 3.0 * noise(seed);
        shape.amplitude[k] = 0.02 * noise(seed);
        shape.spin[k] = shape.kind == WEFT_SPHERE ? 20.0 * noise(seed) : 0.0;
    }
    shape.frequency = 2.0 * (1.0 + noise(seed));
    return shape;
}

/* Random shapes, speeds up to 100 m/s, tolerances 1e-2 to 1e-10, all adaptive methods:
 * no state is ever in a shape. More of them: TEST_LONG. */
START_TEST(no_particle_is_ever_inside)
{
    const weft_stepper_type *method = test_method((size_t)_i);
    const int rounds = test_rounds(4, 200);
    uint64_t seed = 77 + (uint64_t)_i;
    if ((method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        return;
    }
    for (int round = 0; round < rounds; ++round) {
        const double speed = 100.0 * fabs(noise(&seed) * noise(&seed));
        shapes[0] = any_shape(&seed);
        model.contact.damping = round % 2, model.contact.friction = 0.3;
        model.origin[0] = -0.005, model.origin[1] = 1.0, model.spacing[1] = 0.01;
        model.velocity[1] = -speed;
        run.method = method;
        tolerance(pow(10.0, -2.0 - (round % 5) * 2.0));
        start();
        int tries = 0;
        while (weft_sim_time(sim) < fmin(1.0, 4.0 / (1.0 + speed)) && ++tries < 3000) {
            step(1.0);
            ck_assert_msg(gap() > 0.0, "%s, round %d: gap %g m at %g s", method->name,
                          round, gap(), weft_sim_time(sim));
        }
    }
}
END_TEST

/* A chain over a ball, whose ends hang down: soft springs that a limit shortens pull
 * its particles into the ball. */
START_TEST(a_limit_stays_out_of_shapes)
{
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.1, shapes[0].at[1] = -0.11;
    model.cols = 11, model.spacing[1] = 0.05, model.origin[0] = -0.25;
    model.springs[WEFT_STRETCH] = (weft_spring_def){ true, 1.0, 0.01 };
    model.contact.damping = 1.0, model.contact.friction = 0.3;
    run.limit.method = _i < 2 ? WEFT_LIMIT_PROVOT : WEFT_LIMIT_BRIDSON;
    run.limit.keep_velocity = _i == 1;
    run.limit.strain = 0.05;
    tolerance(1e-4);
    run.ledger = true;
    start();
    while (weft_sim_time(sim) < 0.3) {
        step(0.3);
        ck_assert_double_gt(gap(), 0.0);
        ck_assert(isfinite(weft_sim_ledger(sim).residual));
    }
    ck_assert_uint_gt(weft_sim_limit_stats(sim).corrected, 0);
}
END_TEST

/* Two particles on either side of a ball, by a spring that should be six times shorter:
 * the limit would have them in the ball. */
START_TEST(a_limit_is_cut_back_at_a_ball)
{
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.1;
    memset(model.gravity, 0, sizeof model.gravity);
    model.spacing[1] = 0.1, model.scale = 6.0, model.origin[0] = -0.3;
    model.springs[WEFT_STRETCH] = (weft_spring_def){ true, 1e-6, 0.0 };
    run.limit.method = WEFT_LIMIT_PROVOT, run.limit.keep_velocity = true;
    start();
    for (int i = 0; i < 5; ++i) {
        step(1.0);
        ck_assert_double_gt(gap(), 0.0);
        ck_assert_double_lt(at(0, 0), -0.1);
        ck_assert_double_gt(at(1, 0), 0.1);
    }
    ck_assert_double_gt(at(0, 0), -0.3);
}
END_TEST

/* A plane that rises at 1e5 m/s: no step that is allowed is short enough. */
START_TEST(what_cannot_be_kept_out_is_named)
{
    weft_failure why;
    run.method = test_method_named(_i == 0 ? "gsl/rkf45" : "verlet/velocity_verlet");
    run.config.fixed_step = _i == 0 ? 0.0 : 1e-2;
    run.config.min_step = 1e-4;
    model.origin[1] = 0.02, shapes[0].velocity[1] = 1e5;
    model.contact.stopping_speed = 1e-3;
    start();
    weft_status status = WEFT_OK;
    for (int i = 0; i < 10000 && status == WEFT_OK; ++i) {
        status = weft_sim_step(sim, 1.0, &err);
    }
    ck_assert_int_eq(status, WEFT_STEP_TOO_SMALL);
    ck_assert(weft_sim_failure(sim, &why) && why.contact);
    ck_assert_uint_eq(why.gap_particle, 0);
    ck_assert_uint_eq(why.gap_shape, 0);
    ck_assert_double_gt(why.gap_step, 0.0);
    ck_assert_ptr_nonnull(
        strstr(err.message, "particle (0, 0) cannot be kept out of shapes[0]: gap "));
    ck_assert_double_gt(gap(), 0.0);
}
END_TEST

static bool sink(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h;
    y[2] = -0.001;
    return true;
}

START_TEST(states_in_shapes_are_refused)
{
    double x[6];
    weft_failure why;
    model.origin[1] = 0.1;
    start();
    weft_sim_positions(sim, x);
    const uint64_t hash = weft_sim_measure(sim).hash;
    x[4] = -0.002;
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "particle (0, 1) would be 2 mm inside shapes[0]");
    ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
    ck_assert_int_eq(weft_sim_pin(sim, 1, NULL, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_move_pin(sim, 1, x + 3, &err), WEFT_OK);
    go(0.01);
    ck_assert_int_eq(weft_sim_unpin(sim, 1, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "particle (0, 1) is 2 mm inside shapes[0]");
    run.correct = sink;
    start();
    ck_assert_int_eq(weft_sim_step(sim, 1.0, &err), WEFT_INVALID);
    ck_assert(weft_sim_failure(sim, &why) && why.contact && why.gap_shape == 0);
}
END_TEST

/* ---- shapes that change, saves --------------------------------------------------- */

START_TEST(shapes_are_added_moved_and_removed)
{
    static const double there[3] = { 0.0, -3.0, 0.0 }, up[3] = { 0.0, 2.0, 0.0 };
    weft_shape ball = weft_shape_default(WEFT_SPHERE);
    double place[3], velocity[3], force[3], torque[3];
    size_t k = 99;
    model.contact.shape_count = 0;
    model.origin[1] = 1.002;
    run.ledger = true;
    start();
    const weft_cloth *now = weft_sim_cloth(sim);
    ball.at[1] = 0.5;
    ck_assert_int_eq(weft_sim_add_shape(sim, &ball, &k, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "particle (0, 0) would be 498 mm inside shapes[0]");
    ck_assert_uint_eq(k, 99);
    ball.at[1] = 0.0;
    ck_assert_int_eq(weft_sim_add_shape(sim, &ball, &k, &err), WEFT_OK);
    ck_assert_uint_eq(k, 0);
    ck_assert_uint_eq(weft_cloth_shapes(now), 1);
    ck_assert_uint_eq(weft_cloth_shapes(cloth), 0);
    const weft_ledger ledger = weft_sim_ledger(sim);
    ck_assert_double_gt(ledger.energy.contact, 0.0);
    ck_assert_double_eq_tol(ledger.outside_work, ledger.energy.contact, 1e-15);
    weft_sim_shape_load(sim, 0, force, torque);
    ck_assert_double_lt(force[1], 0.0);
    go(0.2);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).residual, 0.0, 1e-8);
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, there, up, &err), WEFT_OK);
    weft_cloth_shape_pose(now, 0, 0.2, place, velocity);
    ck_assert_mem_eq(place, there, sizeof place);
    ck_assert_mem_eq(velocity, up, sizeof up);
    go(0.3);
    weft_cloth_shape_pose(now, 0, 0.3, place, NULL);
    ck_assert_double_eq_tol(place[1], -2.8, 1e-14);
    ck_assert_int_eq(weft_sim_move_shape(sim, 1, there, up, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "no shapes[1]: there are 1");
    velocity[0] = NAN;
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, NULL, velocity, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "shapes[0]: velocity nan, 2, 0 m/s: must be finite");
    ck_assert_int_eq(weft_sim_remove_shape(sim, 0, &err), WEFT_OK);
    ck_assert_uint_eq(weft_cloth_shapes(now), 0);
    go(0.4);
    ck_assert_double_eq_tol(weft_sim_ledger(sim).residual, 0.0, 1e-8);
}
END_TEST

/* Also shapes that were moved and added, into a simulation that has only the defined.
 */
START_TEST(a_resumed_run_has_the_same_bits)
{
    static const double away[3] = { 0.1, -0.3, 0.0 }, slow[3] = { 0.1, 0.0, 0.2 };
    static unsigned char saved[4096], again[4096];
    weft_shape rod = weft_shape_default(WEFT_CAPSULE);
    weft_sim *other = NULL;
    shapes[0].spin[1] = 3.0, model.contact.friction = 0.3, model.contact.damping = 1.0;
    model.origin[1] = 0.1;
    run.method = test_method_named(_i == 0 ? "gsl/rkf45" : "gsl/msadams");
    tolerance(1e-6);
    start();
    rod.radius = 0.01, rod.at[1] = rod.to[1] = -0.2, rod.amplitude[0] = 0.05;
    rod.frequency = 2.0;
    go(0.05);
    ck_assert_int_eq(weft_sim_add_shape(sim, &rod, NULL, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, NULL, slow, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_move_shape(sim, 1, away, NULL, &err), WEFT_OK);
    go(0.1);
    const size_t size = weft_sim_save_size(sim);
    ck_assert_int_eq(weft_sim_save(sim, saved, size, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_create(&run, &other, &err), WEFT_OK);
    ck_assert_msg(weft_sim_restore(other, saved, size, &err) == WEFT_OK, "%s",
                  err.message);
    ck_assert_uint_eq(weft_sim_save_size(other), size);
    go(0.4);
    ck_assert_int_eq(weft_sim_advance(other, 0.4, &err), WEFT_OK);
    ck_assert_uint_eq(weft_sim_measure(other).hash, weft_sim_measure(sim).hash);
    ck_assert_uint_eq(weft_sim_vetoed(other), weft_sim_vetoed(sim));
    ck_assert_int_eq(weft_sim_save(sim, saved, size, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_save(other, again, size, &err), WEFT_OK);
    ck_assert_mem_eq(saved, again, size);
    weft_sim_destroy(other);
}
END_TEST

static void drape(size_t threads, double *y)
{
    run.config.threads = threads;
    start();
    go(0.05);
    memcpy(y, weft_sim_state(sim), weft_cloth_dim(cloth) * sizeof *y);
}

/* 65 x 65 on a ball: threads have the same bits, left and right are mirror images. */
START_TEST(a_sheet_on_a_ball_is_symmetric_on_any_threads)
{
    enum { SIDE = 65, COUNT = SIDE * SIDE };
    static double one[6 * COUNT], two[6 * COUNT];
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.3, shapes[0].at[1] = -0.31;
    model.rows = model.cols = SIDE;
    model.spacing[0] = model.spacing[1] = 1.0 / 64.0;
    model.mass = 0.0, model.density = 0.2;
    model.origin[0] = model.origin[2] = -0.5;
    model.down[1] = 0.0, model.down[2] = 1.0;
    model.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.02 };
    model.springs[WEFT_SHEAR] = (weft_spring_def){ true, 50.0, 0.01 };
    model.contact.friction = 0.3, model.contact.damping = 1.0;
    tolerance(1e-4);
    drape(1, one);
    ck_assert_uint_gt(weft_cloth_touching(cloth, 0.05, one), 0);
    drape(2, two);
    ck_assert_mem_eq(one, two, sizeof one);
    for (size_t i = 0; i < COUNT; ++i) {
        const size_t mirror = i - i % SIDE + (SIDE - 1 - i % SIDE);
        ck_assert_double_eq_tol(one[i], -one[mirror], 1e-9);
        ck_assert_double_eq_tol(one[COUNT + i], one[COUNT + mirror], 1e-9);
    }
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
    tcase_add_test(tcase, a_sheet_rests_at_its_gap);
    tcase_add_test(tcase, an_incline_is_slid_down);
    tcase_add_loop_test(tcase, a_shallow_incline_is_crept_down, 0, 2);
    tcase_add_test(tcase, a_belt_takes_a_particle_along);
    tcase_add_loop_test(tcase, a_turntable_holds_up_to_its_speed, 0, 2);
    tcase_add_loop_test(tcase, a_ball_is_left_near_two_thirds, 0, 3);
    tcase_add_loop_test(tcase, no_particle_is_ever_inside, 0, (int)test_method_count());
    tcase_add_test(tcase, a_limit_is_cut_back_at_a_ball);
    tcase_add_loop_test(tcase, a_limit_stays_out_of_shapes, 0, 3);
    tcase_add_loop_test(tcase, what_cannot_be_kept_out_is_named, 0, 2);
    tcase_add_test(tcase, states_in_shapes_are_refused);
    tcase_add_test(tcase, shapes_are_added_moved_and_removed);
    tcase_add_loop_test(tcase, a_resumed_run_has_the_same_bits, 0, 2);
    tcase_add_test(tcase, a_sheet_on_a_ball_is_symmetric_on_any_threads);
    tcase_add_loop_test(tcase, nothing_falls_through_a_thin_plate, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
