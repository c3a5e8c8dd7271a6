/* SPDX-License-Identifier: BSD-3-Clause */
/* test_self_time.c -- contact of a cloth with itself while time passes: nothing passes
 * through anything, methods keep their order, results their bits. */
#include <stdlib.h>
#include <string.h>

#include "cloth/levels.h"
#include "folded.h"
#include "one_sim.h"
#include "sim/simulation.h"

enum { MOST = 100 * 100 };

static weft_cloth_def model;
static weft_sim_def run;
static weft_shape ground;
static weft_error err;
static double xyz[3 * MOST], speeds[3 * MOST];

static void tolerance(double tol)
{
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = tol;
}

static void setup(void)
{
    model = folded_model(17, 17);
    run = weft_sim_def_default();
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-4);
    ground = weft_shape_default(WEFT_PLANE);
}

static void start(folded_shape *shape)
{
    teardown();
    model.origin[1] = 1.0;
    cloth = test_cloth(&model);
    run.cloth = cloth;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    folded_start(&model, shape, xyz, speeds);
    ck_assert_msg(weft_sim_set_state(sim, xyz, speeds, &err) == WEFT_OK, "%s",
                  err.message);
}

static size_t crossings(void)
{
    weft_sim_positions(sim, xyz);
    return folded_crossings(xyz, model.rows, model.cols);
}

static uint64_t hash(void)
{
    return weft_sim_measure(sim).hash;
}

static void go(double t)
{
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

/* Crossings of all frames of 1/60 s. */
static size_t crossings_until(double t)
{
    size_t count = 0;
    for (int i = 1; i <= (int)(60.0 * t + 0.5); ++i) {
        go((double)i / 60.0);
        count += crossings();
    }
    return count;
}

/* ---- nothing passes through anything --------------------------------------------- */

typedef struct scene {
    folded_shape *shape;
    size_t rows, cols;
    double tolerance, seconds; /* or the fixed step [s] of a method that needs one */
    double thickness;          /* [m]; 0: of the model */
    double wide;               /* of columns, by rows; 0: 1 */
    const char *method;
    weft_limit_method limit;
} scene;

static const scene scenes[] = {
    { folded_fold, 17, 17, 1e-4, 0.2, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_fold, 17, 17, 1e-3, 0.2, 0.0, 0.0, "gsl/rkf45", 0 },
    { folded_fold, 17, 17, 1e-6, 0.1, 0.0, 0.0, "gsl/rk8pd", 0 },
    { folded_pile, 17, 17, 1e-4, 0.5, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_pile, 17, 17, 1e-4, 0.45, 0.0, 0.0, "gsl/rkf45", WEFT_LIMIT_PROVOT },
    { folded_pile, 17, 17, 1e-4, 0.45, 0.0, 0.0, "gsl/rkf45", WEFT_LIMIT_BRIDSON },
    { folded_pile, 17, 11, 1e-4, 0.5, 0.0, 1.6, "arkode/dormand_prince", 0 },
    { folded_roll, 9, 33, 1e-4, 0.1, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_fold, 13, 13, 1e-3, 0.2, 0.0, 0.0, "arkode/kvaerno534", 0 },
    { folded_fold, 13, 13, 1e-3, 0.2, 0.0, 0.0, "cvode/bdf", 0 },
    { folded_fold, 13, 13, 1e-3, 0.2, 0.0, 0.0, "stiff/ros2", 0 },
    { folded_fold, 13, 13, 1e-4, 0.2, 0.0, 0.0, "verlet/velocity_verlet", 0 },
    { folded_fold, 13, 13, 2e-4, 0.2, 0.0, 0.0, "stiff/backward_euler", 0 },
    { folded_slam, 17, 17, 1e-3, 0.1, 5e-4, 0.0, "arkode/dormand_prince", 0 },
};

enum { SCENES = sizeof scenes / sizeof scenes[0] };

static void start_scene(const scene *of, bool self)
{
    model = folded_model(of->rows, of->cols);
    model.spacing[1] *= of->wide > 0.0 ? of->wide : 1.0;
    model.contact.thickness
        = of->thickness > 0.0 ? of->thickness : model.contact.thickness;
    model.contact.self = self;
    model.contact.shapes = &ground;
    model.contact.shape_count = of->shape == folded_pile;
    run.method = test_method_named(of->method);
    run.limit.method = of->limit;
    run.limit.strain = 0.02;
    tolerance(of->tolerance);
    run.config.fixed_step
        = (run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? of->tolerance : 0.0;
    start(of->shape);
}

START_TEST(cloth_passes_through_itself_without)
{
    start_scene(&scenes[_i], false);
    ck_assert_uint_eq(crossings(), 0);
    ck_assert_uint_gt(crossings_until(scenes[_i].seconds), 0);
}
END_TEST

START_TEST(cloth_never_passes_through_itself)
{
    start_scene(&scenes[_i], true);
    ck_assert_uint_eq(crossings_until(scenes[_i].seconds), 0);
}
END_TEST

/* In `make nightly`. */
static const scene long_scenes[] = {
    { folded_pile, 33, 33, 1e-3, 0.8, 0.0, 0.0, "gsl/rkf45", 0 },
    { folded_pile, 33, 33, 1e-4, 0.8, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_pile, 33, 33, 1e-6, 0.8, 0.0, 0.0, "gsl/rk8pd", 0 },
    { folded_pile, 33, 33, 5e-5, 0.8, 0.0, 0.0, "verlet/velocity_verlet", 0 },
    { folded_roll, 33, 33, 1e-4, 0.5, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_fold, 33, 33, 1e-6, 0.3, 0.0, 0.0, "arkode/dormand_prince", 0 },
    { folded_slam, 33, 33, 1e-4, 0.1, 5e-4, 0.0, "gsl/rkf45", 0 },
    { folded_pile, 100, 100, 1e-4, 0.5, 0.0, 0.0, "arkode/dormand_prince", 0 },
};

enum { LONG_SCENES = sizeof long_scenes / sizeof long_scenes[0] };

START_TEST(large_cloth_never_passes_through_itself)
{
    start_scene(&long_scenes[_i], true);
    ck_assert_uint_eq(crossings_until(long_scenes[_i].seconds), 0);
}
END_TEST

/* A fold of 0.5 mm at 12 m/s and a loose tolerance: methods do not see the layer. */
START_TEST(steps_that_may_pass_through_are_taken_back)
{
    start_scene(&scenes[SCENES - 1], true);
    go(0.1);
    ck_assert_uint_gt(weft_sim_vetoed(sim), 0);
}
END_TEST

START_TEST(a_fixed_step_that_would_pass_through_is_an_error)
{
    run.config.fixed_step = 0.02;
    run.method = test_method_named("gsl/rk4");
    model.contact.thickness = 1e-5;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        model.springs[k].present = false;
    }
    start(folded_slam);
    weft_failure failure;
    ck_assert_int_eq(weft_sim_advance(sim, 1.0, &err), WEFT_STEP_TOO_SMALL);
    ck_assert(weft_sim_failure(sim, &failure));
    ck_assert(!failure.contact);
    char text[2][64], expected[192];
    for (size_t k = 0; k < 2; ++k) {
        ck_assert_uint_gt(failure.self_pair[k].count, 0);
        weft_primitive_text(&failure.self_pair[k], model.cols, text[k], 64);
    }
    (void)snprintf(expected, sizeof expected,
                   "%s and %s cannot be kept apart: ", text[0], text[1]);
    ck_assert_msg(strstr(err.message, expected) == err.message, "%s", err.message);
    ck_assert_ptr_nonnull(strstr(err.message, " at t = "));
    ck_assert_uint_eq(crossings(), 0);
}
END_TEST

/* ---- physics --------------------------------------------------------------------- */

/* Two layers that lie askew above each other, ends apart; 0.5 m/s each. */
static void layers(double u, double w, double x[3], double v[3])
{
    const double a = 0.5 / 16.0, k = u / a, middle = 16.5;
    const bool lower = k < middle;
    const double lift = lower ? fmax(0.0, k - 14.0) : fmax(0.0, 19.0 - k);
    x[0] = lower ? u : 33.0 * a - u + 0.3 * a;
    x[1] = lower ? -0.1 * lift : 0.006 + 0.1 * lift;
    x[2] = w + (lower ? 0.0 : 0.4 * a);
    v[0] = v[2] = 0.0;
    v[1] = lower ? 0.5 : -0.5;
}

/* The speed at which the middles of the layers part. */
static double parting_speed(void)
{
    const double *v = weft_sim_state(sim) + 4 * model.rows * model.cols;
    double sum = 0.0;
    size_t count = 0;
    for (size_t i = 0; i < model.rows * model.cols; ++i) {
        const size_t r = i / 34, k = i % 34;
        if (r >= 4 && r <= 12 && k > 4 && k < 29 && (k < 12 || k > 21)) {
            sum += k < 17 ? -v[i] : v[i];
            ++count;
        }
    }
    return 2.0 * sum / (double)count;
}

static void start_layers(double damping)
{
    model = folded_model(17, 34);
    model.spacing[0] = model.spacing[1] = 0.5 / 16.0;
    model.density = 0.0, model.mass = 0.2 * model.spacing[0] * model.spacing[0];
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        model.springs[k].present = false;
    }
    model.gravity[1] = 0.0;
    model.contact.damping = damping, model.contact.friction = 0.0;
    tolerance(1e-8);
    start(layers);
}

/* damping v = 1: the restitution of contact with a shape is 0.608. */
START_TEST(flat_layers_bounce_with_their_restitution)
{
    start_layers(1.0);
    go(0.03);
    ck_assert_double_eq_tol(parting_speed(), 0.607, 0.002);
}
END_TEST

START_TEST(without_damping_energy_and_momenta_are_kept)
{
    start_layers(0.0);
    const weft_measures before = weft_sim_measure(sim);
    go(0.03);
    const weft_measures after = weft_sim_measure(sim);
    const double energy = weft_energy_total(before.energy);
    ck_assert_double_le(fabs(weft_energy_total(after.energy) - energy), 1e-7 * energy);
    for (size_t k = 0; k < 3; ++k) {
        ck_assert_double_eq_tol(after.momentum[k], before.momentum[k], 1e-15);
        ck_assert_double_eq_tol(after.angular_momentum[k], before.angular_momentum[k],
                                1e-14);
    }
}
END_TEST

START_TEST(the_ledger_balances)
{
    start_scene(&scenes[0], true);
    run.ledger = true;
    tolerance(1e-8);
    start(folded_fold);
    go(0.1);
    const weft_ledger ledger = weft_sim_ledger(sim);
    ck_assert_double_gt(ledger.dissipated_contact, 0.0);
    ck_assert_double_gt(ledger.dissipated_friction, 0.0);
    ck_assert_double_le(fabs(ledger.residual),
                        1e-6 * (ledger.dissipated_contact + ledger.dissipated_springs));
}
END_TEST

/* A smooth impact of a fold's legs, thicker and without damping. */
static void smooth_fold(double u, double w, double x[3], double v[3])
{
    folded_u(u, w, 0.0, x, v);
    x[2] += 0.18 * x[1] + 0.01 * sin(5.0 * u);
    x[1] += 0.004 * sin(6.0 * w + 3.0 * u);
    v[1] = (u < 0.5 ? 12.0 : -12.0) * (u - 0.5) * (u - 0.5);
}

static void run_smooth(double h, double *x)
{
    run.config.fixed_step = h;
    start(smooth_fold);
    go(0.03);
    ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
    go(0.09);
    memcpy(x, weft_sim_state(sim), 3 * model.rows * model.cols * sizeof *x);
}

START_TEST(dormand_prince_keeps_its_order)
{
    static double exact[3 * 169], x[3 * 169];
    model = folded_model(13, 13);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        model.springs[k].damping = 0.0;
    }
    model.gravity[1] = 0.0;
    model.contact.thickness = 0.02, model.contact.stopping_speed = 10.0;
    model.contact.damping = model.contact.friction = 0.0;
    run_smooth(2.5e-5, exact);
    double errors[3];
    for (size_t i = 0; i < 3; ++i) {
        double square = 0.0;
        run_smooth(4e-4 / (double)(1 << i), x);
        for (size_t j = 0; j < 3 * 169; ++j) {
            square += (x[j] - exact[j]) * (x[j] - exact[j]);
        }
        errors[i] = sqrt(square / 169.0);
    }
    ck_assert_double_gt(errors[2], 1e-11); /* not roundoff */
    ck_assert_double_ge(log2(errors[0] / errors[1]), 4.0);
    ck_assert_double_ge(log2(errors[1] / errors[2]), 4.0);
}
END_TEST

/* Two strands of a chain cross each other, the upper one falling on the lower. */
static void crossed(double u, double w, double x[3], double v[3])
{
    const double a = 1.0 / 40.0, k = u / a;
    const bool lower = k<15.5, upper = k> 24.5;
    const double turn = (k - 15.0) / 10.0 * folded_pi;
    (void)w;
    x[0] = lower ? u : upper ? 0.19 : 15.0 * a + 0.06 * sin(turn);
    x[2] = lower ? 0.0 : upper ? (33.0 - k) * a : 0.1 - 0.1 * cos(turn);
    x[1] = lower ? 0.0 : upper ? 0.01 : 0.01 * (k - 15.0) / 10.0;
    v[0] = v[2] = 0.0;
    v[1] = upper ? -3.0 : 0.0;
}

/* Height of the upper strand over the lower where their shadows cross; < 0: below. */
static double height_over(void)
{
    weft_sim_positions(sim, xyz);
    double least = INFINITY;
    for (size_t i = 0; i < 14; ++i) {
        for (size_t j = 26; j < 40; ++j) {
            const double *a = xyz + 3 * i, *b = a + 3, *c = xyz + 3 * j, *d = c + 3;
            const double ex = b[0] - a[0], ez = b[2] - a[2];
            const double fx = d[0] - c[0], fz = d[2] - c[2];
            const double det = ex * fz - ez * fx;
            const double s = ((c[0] - a[0]) * fz - (c[2] - a[2]) * fx) / det;
            const double t = ((c[0] - a[0]) * ez - (c[2] - a[2]) * ex) / det;
            if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
                least
                    = fmin(least, c[1] + t * (d[1] - c[1]) - a[1] - s * (b[1] - a[1]));
            }
        }
    }
    return least;
}

static double lowest_height(bool self)
{
    model = folded_model(1, 41);
    model.spacing[1] = 1.0 / 40.0;
    model.contact.self = self;
    model.gravity[1] = 0.0;
    start(crossed);
    double least = height_over();
    for (int i = 1; i <= 20; ++i) {
        go(5e-4 * (double)i);
        least = fmin(least, height_over());
    }
    return least;
}

START_TEST(strands_of_a_chain_stop_each_other)
{
    const double without = lowest_height(false), with = lowest_height(true);
    ck_assert_double_lt(without, 0.0);
    ck_assert_double_gt(with, 0.0);
    ck_assert_double_lt(with, model.contact.thickness);
}
END_TEST

/* ---- the same bits --------------------------------------------------------------- */

static void start_pile(void)
{
    start_scene(&scenes[3], true);
}

static uint64_t pile_hash(double skin)
{
    start_pile();
    weft__self_list_set_skin(sim->forces.self, skin);
    go(0.43);
    ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
    return hash();
}

START_TEST(the_skin_does_not_change_results)
{
    const uint64_t first = pile_hash(1.5e-3);
    ck_assert_uint_eq(pile_hash(5e-3), first);
    ck_assert_uint_eq(pile_hash(15e-3), first);
}
END_TEST

START_TEST(threads_do_not_change_results)
{
    uint64_t first = 0;
    for (size_t threads = 1; threads <= 4; threads *= 2) {
        run.config.threads = threads;
        start_pile();
        ck_assert((sim->forces.team != NULL) == (threads > 1));
        go(0.43);
        first = threads == 1 ? hash() : first;
        ck_assert_uint_eq(hash(), first);
    }
}
END_TEST

/* weft_cloth_rhs has no list. */
START_TEST(a_list_changes_no_bit)
{
    double dydt[2][6 * 17 * 17];
    start_pile();
    go(0.3);
    const weft_measures with = weft_sim_measure(sim);
    const double *y = weft_sim_state(sim);
    ck_assert_int_eq(weft__forces_rhs(&sim->forces, 0.3, y, dydt[0]), 0);
    for (size_t i = 0; i < weft__level_count(); ++i) {
        weft__cloth_set_level(sim->cloth, weft__level_at(i));
        ck_assert_int_eq(weft_cloth_rhs(sim->cloth, 0.3, y, dydt[1]), 0);
        ck_assert_mem_eq(dydt[0], dydt[1], sizeof dydt[0]);
        ck_assert_int_eq(weft__forces_rhs(&sim->forces, 0.3, y, dydt[1]), 0);
        ck_assert_mem_eq(dydt[0], dydt[1], sizeof dydt[0]);
    }
    const double energy = weft_cloth_energy(sim->cloth, 0.3, y).contact;
    ck_assert_double_gt(energy, 0.0);
    ck_assert_mem_eq(&energy, &with.energy.contact, sizeof energy);
    ck_assert_uint_eq(with.self_touching, weft_cloth_self_touching(sim->cloth, y));
    ck_assert_double_eq(with.self_gap, weft_cloth_self_gap(sim->cloth, y, NULL));
}
END_TEST

START_TEST(a_resumed_run_equals_one_that_went_on)
{
    start_pile();
    go(0.25);
    const size_t size = weft_sim_save_size(sim);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    ck_assert_int_eq(weft_sim_save(sim, saved, size, &err), WEFT_OK);
    go(0.43);
    const uint64_t first = hash(), vetoed = weft_sim_vetoed(sim);
    start_pile();
    ck_assert_msg(weft_sim_restore(sim, saved, size, &err) == WEFT_OK, "%s",
                  err.message);
    go(0.43);
    ck_assert_uint_eq(hash(), first);
    ck_assert_uint_eq(weft_sim_vetoed(sim), vetoed);
    free(saved);
}
END_TEST

TEST_SUITE(self_time)
{
    Suite *suite = suite_create("self_time");
    TCase *apart = tcase_create("apart"), *physics = tcase_create("physics");
    TCase *bits = tcase_create("bits"), *large = tcase_create("large");
    tcase_add_checked_fixture(apart, setup, teardown);
    tcase_add_checked_fixture(physics, setup, teardown);
    tcase_add_checked_fixture(bits, setup, teardown);
    tcase_add_checked_fixture(large, setup, teardown);
    tcase_set_timeout(large, 7200);
    tcase_set_timeout(apart, 300), tcase_set_timeout(physics, 300);
    tcase_set_timeout(bits, 300);
    tcase_add_loop_test(apart, cloth_passes_through_itself_without, 0, SCENES);
    tcase_add_loop_test(apart, cloth_never_passes_through_itself, 0, SCENES);
    tcase_add_loop_test(large, large_cloth_never_passes_through_itself, 0,
                        test_rounds(0, LONG_SCENES));
    tcase_add_test(apart, steps_that_may_pass_through_are_taken_back);
    tcase_add_test(apart, a_fixed_step_that_would_pass_through_is_an_error);
    tcase_add_test(physics, flat_layers_bounce_with_their_restitution);
    tcase_add_test(physics, without_damping_energy_and_momenta_are_kept);
    tcase_add_test(physics, the_ledger_balances);
    tcase_add_test(physics, dormand_prince_keeps_its_order);
    tcase_add_test(physics, strands_of_a_chain_stop_each_other);
    tcase_add_test(bits, the_skin_does_not_change_results);
    tcase_add_test(bits, threads_do_not_change_results);
    tcase_add_test(bits, a_list_changes_no_bit);
    tcase_add_test(bits, a_resumed_run_equals_one_that_went_on);
    suite_add_tcase(suite, apart);
    suite_add_tcase(suite, physics);
    suite_add_tcase(suite, bits);
    suite_add_tcase(suite, large);
    return suite;
}
