/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long computes */
/* test_self_time.c -- contact of a cloth with itself while time passes: nothing passes
 * through anything, layers bounce as they should, results keep their bits. */
#include <stdlib.h>
#include <string.h>

#include "cloth/model.h"
#include "folded.h"
#include "forces/contact/self/self_list.h"
#include "one_sim.h"
#include "random.h"
#include "sim/simulation.h"

enum { MOST = 100 * 100 };

static weft_cloth_def model;
static weft_sim_def run;
static weft_shape shapes[2];
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
}

static void start(folded_shape *shape)
{
    teardown();
    model.origin[1] = model.pin_count > 0 ? 0.0 : 0.05; /* not in a shape */
    cloth = test_cloth(&model);
    run.cloth = cloth;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    folded_start(&model, shape, xyz, speeds);
    ck_assert_msg(weft_sim_set_state(sim, xyz, speeds, &err) == WEFT_OK, "%s",
                  err.message);
}

/* By exact arithmetic, and at least what a count of its own finds. */
static size_t crossings(void)
{
    const size_t exact
        = weft_cloth_crossings(weft_sim_cloth(sim), weft_sim_state(sim), NULL);
    weft_sim_positions(sim, xyz);
    ck_assert_uint_ge(exact, folded_crossings(xyz, model.rows, model.cols));
    return exact;
}

static uint64_t hash(void)
{
    return weft_sim_measure(sim).hash;
}

static void go(double t)
{
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

/* ---- courses --------------------------------------------------------------------- */

typedef struct course {
    folded_shape *shape;
    void (*around)(double seconds); /* adds shapes or pins; NULL: none */
    size_t rows, cols;
    double seconds;
    double wide;      /* of columns, by rows; 0: 1 */
    double thickness; /* [m]; 0: of the model */
    weft_limit_method limit;
} course;

typedef struct setting {
    const char *method;
    double accuracy; /* tolerance, or the fixed step [s] of a method that needs one */
} setting;

typedef struct scene {
    course of;
    setting by;
} scene;

static void on_floor(double seconds)
{
    (void)seconds;
    model.contact.shape_count = 1;
}

static void on_ball(double seconds)
{
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].at[0] = 0.5, shapes[0].at[1] = -0.2, shapes[0].radius = 0.2;
    on_floor(seconds);
}

/* They leave 6 mm at the end. */
static void between_plates(double seconds)
{
    shapes[1].normal[1] = -1.0;
    shapes[1].at[1] = 0.132, shapes[1].velocity[1] = -0.126 / seconds;
    model.contact.shape_count = 2;
}

/* By its first and last row, which turn() moves. */
static void by_ends(double seconds)
{
    static const weft_pin ends[] = { { .rows = { 0, 0 }, .cols = { 0, -1 } },
                                     { .rows = { -1, -1 }, .cols = { 0, -1 } } };
    (void)seconds;
    model.pins = ends, model.pin_count = 2;
}

/* Moves pins to their places at t: each end turns by 216 degrees, against the other,
 * and they approach each other by 12 cm. */
static void turn(double t, double seconds)
{
    const double angle = 1.2 * folded_pi * t / seconds, near = 0.06 * t / seconds;
    const double middle = 0.5 * (double)(model.cols - 1) * model.spacing[1];
    const size_t n = model.rows * model.cols;
    weft_sim_positions(sim, xyz);
    for (size_t i = 0; i < n; i = i + 1 == model.cols ? n - model.cols : i + 1) {
        const double sign = i < model.cols ? 1.0 : -1.0;
        const double u = (double)(i % model.cols) * model.spacing[1] - middle;
        const double w = (double)(i / model.cols) * model.spacing[0];
        const double to[3]
            = { middle + u * cos(angle), sign * u * sin(angle), w + sign * near };
        double velocity[3];
        for (size_t k = 0; k < 3; ++k) {
            velocity[k] = (to[k] - xyz[3 * i + k]) / (t - weft_sim_time(sim));
        }
        ck_assert_int_eq(weft_sim_pin(sim, i, velocity, &err), WEFT_OK);
    }
}

/* Of a chain. */
static size_t passes_until(double t)
{
    static double before[3 * 200];
    size_t count = 0;
    ck_assert_uint_le(model.cols, 200);
    while (weft_sim_time(sim) < t) {
        weft_sim_positions(sim, before);
        ck_assert_msg(weft_sim_step(sim, t, &err) == WEFT_OK, "%s", err.message);
        weft_sim_positions(sim, xyz);
        count += folded_passes(before, xyz, model.cols);
    }
    return count;
}

/* Crossings of all frames of 1/60 s; of a chain, edges that pass each other. */
static size_t crossings_of(const course *of)
{
    size_t count = 0;
    for (int i = 1; i <= (int)(60.0 * of->seconds + 0.5); ++i) {
        const double t = (double)i / 60.0;
        if (of->around == by_ends) {
            turn(t, of->seconds);
        }
        count += model.rows == 1 ? passes_until(t) : 0;
        go(t);
        count += crossings();
    }
    return count;
}

static void start_course(const course *of, const setting *by, bool self)
{
    model = folded_model(of->rows, of->cols);
    model.spacing[1] *= of->wide > 0.0 ? of->wide : 1.0;
    if (of->thickness > 0.0) {
        model.contact.thickness = of->thickness;
    }
    model.contact.self = self;
    model.contact.shapes = shapes;
    shapes[0] = shapes[1] = weft_shape_default(WEFT_PLANE);
    if (of->around != NULL) {
        of->around(of->seconds);
    }
    run.method = test_method_named(by->method);
    run.limit.method = of->limit;
    run.limit.strain = 0.02;
    tolerance(by->accuracy);
    run.config.fixed_step
        = (run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? by->accuracy : 0.0;
    start(of->shape);
}

static void start_scene(const scene *of, bool self)
{
    start_course(&of->of, &of->by, self);
}

/* ---- nothing passes through anything --------------------------------------------- */

#define PLAIN          0.0, 0.0, WEFT_LIMIT_NONE
#define LIMIT(method)  0.0, 0.0, WEFT_LIMIT_##method
#define WIDE           1.6, 0.0, WEFT_LIMIT_NONE
#define THIN           0.0, 5e-4, WEFT_LIMIT_NONE
#define DORMAND_PRINCE "arkode/dormand_prince"
#define VERLET         "verlet/velocity_verlet"

static const scene scenes[] = {
    { { folded_fold, NULL, 17, 17, 0.2, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_fold, NULL, 17, 17, 0.2, PLAIN }, { "gsl/rkf45", 1e-3 } },
    { { folded_fold, NULL, 17, 17, 0.1, PLAIN }, { "gsl/rk8pd", 1e-6 } },
    { { folded_fold, NULL, 13, 13, 0.1, PLAIN }, { "arkode/kvaerno534", 1e-3 } },
    { { folded_fold, NULL, 13, 13, 0.1, PLAIN }, { "cvode/bdf", 1e-3 } },
    { { folded_fold, NULL, 13, 13, 0.1, PLAIN }, { "stiff/ros2", 1e-3 } },
    { { folded_fold, NULL, 13, 13, 0.2, PLAIN }, { VERLET, 1e-4 } },
    { { folded_fold, NULL, 13, 13, 0.1, PLAIN }, { "stiff/backward_euler", 2e-4 } },
    { { folded_roll, NULL, 9, 33, 0.1, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_pile, on_floor, 17, 17, 0.45, LIMIT(PROVOT) }, { "gsl/rkf45", 1e-4 } },
    { { folded_pile, on_floor, 17, 17, 0.45, LIMIT(BRIDSON) }, { "gsl/rkf45", 1e-4 } },
    { { folded_pile, on_floor, 17, 11, 0.5, WIDE }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_pile, on_ball, 17, 17, 0.55, PLAIN }, { "gsl/rkf45", 1e-3 } },
    { { folded_press, between_plates, 9, 9, 0.1, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_flat, by_ends, 17, 5, 0.4, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_coil, on_floor, 1, 81, 0.3, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_pile, on_floor, 17, 17, 0.5, PLAIN }, { DORMAND_PRINCE, 1e-4 } },
    { { folded_slam, NULL, 17, 17, 0.1, THIN }, { DORMAND_PRINCE, 1e-3 } },
};

enum { SCENES = sizeof scenes / sizeof scenes[0], PILE = SCENES - 2, SLAM, FOLD = 0 };

/* Of a shape once, unless there is time. */
START_TEST(cloth_passes_through_itself_without)
{
    if (_i > 0 && scenes[_i].of.shape == scenes[_i - 1].of.shape && test_rounds(1, 0)) {
        return;
    }
    start_scene(&scenes[_i], false);
    ck_assert_uint_eq(crossings(), 0);
    ck_assert_uint_gt(crossings_of(&scenes[_i].of), 0);
}
END_TEST

/* The slowest methods of a shape if there is time. */
START_TEST(cloth_never_passes_through_itself)
{
    if ((_i == 4 || _i == 5 || _i == 7 || _i == 9) && test_rounds(1, 0)) {
        return;
    }
    start_scene(&scenes[_i], true);
    ck_assert_uint_eq(crossings_of(&scenes[_i].of), 0);
}
END_TEST

/* `make check-self`: each by each setting. */
static const course long_courses[] = {
    { folded_slam, NULL, 33, 33, 0.1, THIN },
    { folded_fold, NULL, 33, 33, 0.3, PLAIN },
    { folded_pile, on_floor, 33, 33, 0.8, PLAIN },
    { folded_pile, on_floor, 33, 33, 0.8, LIMIT(PROVOT) },
    { folded_pile, on_floor, 33, 33, 0.8, LIMIT(BRIDSON) },
    { folded_pile, on_floor, 33, 21, 0.8, WIDE },
    { folded_pile, on_ball, 33, 33, 0.8, PLAIN },
    { folded_roll, on_floor, 33, 33, 0.5, PLAIN },
    { folded_press, between_plates, 33, 33, 0.42, PLAIN },
    { folded_flat, by_ends, 33, 9, 3.0, PLAIN },
    { folded_coil, on_floor, 1, 161, 0.8, PLAIN },
};

static const setting settings[] = {
    { DORMAND_PRINCE, 1e-3 }, { DORMAND_PRINCE, 1e-4 }, { DORMAND_PRINCE, 1e-6 },
    { "gsl/rkf45", 1e-3 },    { "gsl/rkf45", 1e-4 },    { "gsl/rkf45", 1e-6 },
    { "gsl/rk8pd", 1e-3 },    { "gsl/rk8pd", 1e-4 },    { "gsl/rk8pd", 1e-6 },
    { VERLET, 5e-5 },
};

enum {
    SETTINGS = sizeof settings / sizeof settings[0],
    LONG_SCENES = SETTINGS * sizeof long_courses / sizeof long_courses[0]
};

START_TEST(large_cloth_never_passes_through_itself)
{
    const course *of = &long_courses[_i / SETTINGS];
    start_course(of, &settings[_i % SETTINGS], true);
    ck_assert_uint_eq(crossings_of(of), 0);
}
END_TEST

START_TEST(ten_thousand_particles_never_pass_through_each_other)
{
    const course pile = { folded_pile, on_floor, 100, 100, 0.5, PLAIN };
    start_course(&pile, &(setting){ DORMAND_PRINCE, 1e-4 }, true);
    ck_assert_uint_eq(crossings_of(&pile), 0);
}
END_TEST

/* A fold of 0.5 mm at 12 m/s and a loose tolerance: methods do not see the layer. */
START_TEST(steps_that_may_pass_through_are_taken_back)
{
    start_scene(&scenes[SLAM], true);
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
        weft_primitive_text(cloth, &failure.self_pair[k], text[k], 64);
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

/* ---- the same bits --------------------------------------------------------------- */

static void start_pile(void)
{
    start_scene(&scenes[PILE], true);
}

static uint64_t pile_hash(double skin)
{
    start_pile();
    weft__self_list *list = sim->forces.spaces[WEFT__FORCE_self];
    list->skin = skin;
    list->valid = false;
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
        ck_assert((sim->forces.pool != NULL) == (threads > 1));
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
    for (size_t i = 0; i < (size_t)weft__isa_last(); ++i) {
        weft__cloth_choose(sim->cloth, (weft__isa)(i + 1));
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

static void expect_rates_without_a_list(void)
{
    double dydt[2][6 * 17 * 17];
    const double *y = weft_sim_state(sim), t = weft_sim_time(sim);
    ck_assert_int_eq(weft__forces_rhs(&sim->forces, t, y, dydt[0]), 0);
    ck_assert_int_eq(weft_cloth_rhs(sim->cloth, t, y, dydt[1]), 0);
    ck_assert_mem_eq(dydt[0], dydt[1], sizeof dydt[0]);
}

/* At every fourth step; then evaluations go on from another place. */
START_TEST(a_list_has_the_pairs_of_a_search)
{
    size_t touching = 0;
    start_pile();
    for (size_t i = 0; weft_sim_time(sim) < 0.5; ++i) {
        ck_assert_int_eq(weft_sim_step(sim, 0.5, &err), WEFT_OK);
        if (i % 4 == 0) {
            expect_rates_without_a_list();
            touching += weft_sim_measure(sim).self_touching;
        }
    }
    ck_assert_uint_gt(touching, 1000);
}
END_TEST

/* Preconditioners take them along the list. */
START_TEST(blocks_have_the_same_bits_with_a_list)
{
    static double blocks[2][15 * 17 * 17];
    size_t filled = 0;
    start_pile();
    go(0.43);
    const weft__self *own = &sim->cloth->self;
    const weft__state at = { .t = weft_sim_time(sim), .y = weft_sim_state(sim) };
    weft__self_list *list = sim->forces.spaces[WEFT__FORCE_self];
    ck_assert(list->valid);
    ck_assert_int_eq(weft__self_blocks(own, list, &at, blocks[0]), 0);
    ck_assert_int_eq(weft__self_blocks(own, NULL, &at, blocks[1]), 0);
    ck_assert_mem_eq(blocks[0], blocks[1], sizeof blocks[0]);
    for (size_t i = 0; i < 9 * 17 * 17; ++i) {
        filled += blocks[0][i] != 0.0;
    }
    ck_assert_uint_gt(filled, 100);
}
END_TEST

/* By a list, by one search for all particles, and by one for every 512 of them. */
static void expect_bounds_without_a_list(void)
{
    const double *y = weft_sim_state(sim), t = weft_sim_time(sim);
    double most[WEFT__SIDES];
    weft__stiffness_sides(sim->cloth, NULL, NULL, t, y, most);
    const weft_stiffness some = weft__stiffness_within(sim->cloth, y, most);
    const weft_stiffness all = weft_cloth_stiffness(sim->cloth, t, y);
    const weft_stiffness listed = weft_sim_stiffness(sim, t, y);
    ck_assert_mem_eq(&all, &some, sizeof some);
    ck_assert_mem_eq(&listed, &some, sizeof some);
}

/* Contact makes them larger, in the last state. */
START_TEST(bounds_of_stiffness_have_the_same_bits_with_a_list)
{
    start_pile();
    for (double end = 0.1; end < 0.45; end += 0.11) {
        go(end);
        expect_bounds_without_a_list();
    }
    const weft_stiffness with
        = weft_sim_stiffness(sim, weft_sim_time(sim), weft_sim_state(sim));
    ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
    sim->cloth->self.law.self = false;
    const weft_stiffness without
        = weft_sim_stiffness(sim, weft_sim_time(sim), weft_sim_state(sim));
    sim->cloth->self.law.self = true;
    ck_assert_double_gt(with.omega2, without.omega2);
}
END_TEST

/* The list keeps the masses of pairs, which depend on pins. */
START_TEST(a_list_follows_pins)
{
    start_pile();
    go(0.43);
    ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
    for (size_t i = 0; i < 17 * 17; ++i) {
        ck_assert_int_eq(weft_sim_pin(sim, i, NULL, &err), WEFT_OK);
    }
    expect_rates_without_a_list();
    ck_assert_uint_eq(weft_sim_measure(sim).self_touching, 0);
    for (size_t i = 0; i < 17 * 17; i += 2) {
        ck_assert_int_eq(weft_sim_unpin(sim, i, &err), WEFT_OK);
    }
    expect_rates_without_a_list();
    ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
}
END_TEST

/* ---- strips that land on an edge ------------------------------------------------- */

typedef struct drop {
    size_t rows;
    double tilt, side; /* of the direction down */
    double speed;      /* [m/s], of a stopping speed of 1 m/s */
    double tolerance;
} drop;

/* The 15 of 274 that took back more than 300 steps, or came to no end, while windows
 * were as wide at any gap. */
static const drop drops[] = {
    { 16, 0.066, 0.082, 5.62, 1e-3 }, { 20, 0.039, 0.067, 4.22, 1e-3 },
    { 20, 0.037, 0.064, 5.82, 1e-6 }, { 20, 0.077, 0.090, 6.93, 1e-4 },
    { 20, 0.117, 0.011, 4.18, 1e-6 }, { 16, 0.077, 0.050, 5.85, 1e-6 },
    { 20, 0.041, 0.005, 4.25, 1e-6 }, { 20, 0.084, 0.080, 6.61, 1e-3 },
    { 20, 0.067, 0.058, 6.62, 1e-6 }, { 20, 0.093, 0.084, 5.47, 1e-6 },
    { 16, 0.037, 0.099, 6.49, 1e-6 }, { 20, 0.068, 0.071, 6.56, 1e-3 },
    { 20, 0.083, 0.026, 5.59, 1e-6 }, { 20, 0.095, 0.088, 6.81, 1e-6 },
    { 16, 0.091, 0.058, 6.73, 1e-4 },
};

static drop random_drop(uint64_t seed)
{
    static const double tolerances[] = { 1e-3, 1e-4, 1e-6 };
    uint64_t state = 11 + seed;
    for (int i = 0; i < 8; ++i) {
        (void)random_uniform(&state);
    }
    drop of = { .rows = random_whole(&state, 0, 2) == 0 ? 16 : 20 };
    of.tilt = 0.01 + 0.13 * random_uniform(&state);
    of.side = 0.1 * random_uniform(&state);
    of.speed = 3.8 + 3.2 * random_uniform(&state);
    of.tolerance = tolerances[random_whole(&state, 0, 2)];
    return of;
}

/* The first 4; `make nightly`: all, and 259 at random. */
START_TEST(a_strip_that_lands_on_its_edge_comes_to_rest)
{
    static const double stiffness[WEFT_FAMILIES] = { 100.0, 50.0, 5.0 };
    static const double damping[WEFT_FAMILIES] = { 0.02, 0.01, 0.001 };
    const drop of = _i < (int)(sizeof drops / sizeof drops[0])
                        ? drops[_i]
                        : random_drop((uint64_t)_i);
    model = weft_cloth_def_default();
    model.rows = of.rows, model.cols = 2;
    model.spacing[0] = model.spacing[1] = 0.02;
    model.origin[1] = 0.4;
    model.right[1] = of.side, model.down[0] = of.side, model.down[1] = -1.0;
    model.down[2] = of.tilt;
    model.density = 0.2;
    model.velocity[1] = -of.speed;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        model.springs[k] = (weft_spring_def){ true, stiffness[k], damping[k] };
    }
    shapes[0] = weft_shape_default(WEFT_PLANE);
    model.contact.thickness = 5e-3, model.contact.stopping_speed = 1.0;
    model.contact.self = true;
    model.contact.shapes = shapes, model.contact.shape_count = 1;
    tolerance(of.tolerance);
    teardown();
    cloth = test_cloth(&model);
    run.cloth = cloth;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    while (weft_sim_time(sim) < 0.5) {
        ck_assert_msg(weft_sim_step(sim, 0.5, &err) == WEFT_OK, "%s", err.message);
        ck_assert_uint_le(weft_sim_vetoed(sim), 300);
    }
    ck_assert_uint_eq(crossings(), 0);
}
END_TEST

TEST_SUITE(self_time)
{
    Suite *suite = suite_create("self_time");
    TCase *apart = tcase_create("apart"), *physics = tcase_create("physics");
    TCase *bits = tcase_create("bits"), *large = tcase_create("self");
    TCase *threads = tcase_create("threads"); /* of make tsan, too */
    tcase_add_checked_fixture(apart, setup, teardown);
    tcase_add_checked_fixture(physics, setup, teardown);
    tcase_add_checked_fixture(bits, setup, teardown);
    tcase_add_checked_fixture(large, setup, teardown);
    tcase_add_checked_fixture(threads, setup, teardown);
    tcase_set_timeout(large, 7200);
    tcase_set_timeout(apart, 300), tcase_set_timeout(physics, 300);
    tcase_set_timeout(bits, 300), tcase_set_timeout(threads, 300);
    const bool all = getenv("SELF_SECONDS") != NULL;
    tcase_add_loop_test(apart, cloth_passes_through_itself_without, 0, SCENES);
    tcase_add_loop_test(apart, cloth_never_passes_through_itself, 0, SCENES);
    tcase_add_loop_test(large, large_cloth_never_passes_through_itself, 0,
                        all ? LONG_SCENES : 0);
    tcase_add_loop_test(large, ten_thousand_particles_never_pass_through_each_other, 0,
                        all ? 1 : 0);
    tcase_add_loop_test(apart, a_strip_that_lands_on_its_edge_comes_to_rest, 0,
                        test_rounds(4, 274));
    tcase_add_test(apart, steps_that_may_pass_through_are_taken_back);
    tcase_add_test(apart, a_fixed_step_that_would_pass_through_is_an_error);
    tcase_add_test(physics, flat_layers_bounce_with_their_restitution);
    tcase_add_test(physics, without_damping_energy_and_momenta_are_kept);
    tcase_add_test(bits, the_skin_does_not_change_results);
    tcase_add_test(threads, threads_do_not_change_results);
    tcase_add_test(bits, a_list_changes_no_bit);
    tcase_add_test(bits, a_list_has_the_pairs_of_a_search);
    tcase_add_test(bits, blocks_have_the_same_bits_with_a_list);
    tcase_add_test(bits, bounds_of_stiffness_have_the_same_bits_with_a_list);
    tcase_add_test(bits, a_list_follows_pins);
    suite_add_tcase(suite, apart);
    suite_add_tcase(suite, physics);
    suite_add_tcase(suite, bits);
    suite_add_tcase(suite, threads);
    suite_add_tcase(suite, large);
    return suite;
}
