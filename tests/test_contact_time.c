/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow together asan-long */
/* test_contact_time.c -- shapes while time passes: no particle in one or through one,
 * whatever the method and its steps; shapes that change; saves. */
#include <stdlib.h>
#include <string.h>

#include "contact_run.h"
#include "saved_sum.h"

enum { MOST = 4096 };

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

/* From rest to rest over h = 0.1 s: classical Runge-Kutta moves by -180 h^2 / 6. */
static int swing_down(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)y;
    for (size_t i = 2; i < 4; ++i) {
        f[i] -= 0.1 * 180.0 * cos(10.0 * acos(-1.0) * t);
    }
    return 0;
}

/* The plate of the first test again, between both ends of the first step. */
START_TEST(nothing_is_swung_through_a_plate_within_a_step)
{
    run.method = test_method_named("gsl/rk4");
    shapes[0] = weft_shape_default(WEFT_BOX);
    for (size_t k = 0; k < 3; ++k) {
        shapes[0].half[k] = k == 1 ? 2e-3 : 0.5;
    }
    shapes[0].rounding = 1e-3;
    model.spacing[1] = 0.01, model.origin[1] = 0.15;
    memset(model.gravity, 0, sizeof model.gravity);
    run.force = swing_down;
    run.config.fixed_step = 0.1;
    start();
    while (weft_sim_time(sim) < 0.1) {
        step(0.1);
        ck_assert_double_gt(at(0, 1), 0.0);
    }
    ck_assert_uint_gt(weft_sim_vetoed(sim), 0);
}
END_TEST

typedef struct heard {
    size_t warnings;
    char last[256];
} heard;

static void hear(void *ctx, weft_log_level level, const char *text)
{
    heard *to = ctx;
    if (level == WEFT_LOG_WARNING) {
        ++to->warnings;
        (void)snprintf(to->last, sizeof to->last, "%s", text);
    }
}

/* Along a plane, 1 mm above it: the check does not know that nothing leads there, and
 * allows 2 mm of the 0.1 m of a step. */
START_TEST(a_run_that_crawls_says_so_once)
{
    heard all = { 0 };
    run.method = test_method_named("gsl/rk4");
    model.contact.thickness = 5e-4;
    model.origin[1] = 1e-3, model.velocity[0] = 10.0;
    memset(model.gravity, 0, sizeof model.gravity);
    run.config.fixed_step = 0.01;
    run.log = (weft_log){ hear, &all };
    start();
    while (weft_sim_vetoed(sim) < 3000) {
        ck_assert_uint_ge(weft_sim_vetoed(sim), 500 * all.warnings);
        step(100.0);
    }
    ck_assert_uint_eq(all.warnings, 1);
    ck_assert_ptr_nonnull(strstr(all.last, "contact rolled back "));
    ck_assert_ptr_nonnull(strstr(all.last, " of the last 1000 steps at t = "));
    ck_assert_ptr_nonnull(
        strstr(all.last, ": particle (0, 0) and shapes[0], distance 0.001 m"));
}
END_TEST

/* (h max |v - V|) < d0 + d1, gaps and velocities those at either end of the step; from
 * a start in touch with a plane that swings. */
START_TEST(steps_are_bounded_by_the_gaps_at_both_ends)
{
    double moving[3];
    shapes[0].amplitude[1] = -0.05, shapes[0].frequency = 3.0;
    model.origin[1] = 0.4 * model.contact.thickness;
    run.method = test_method_named("gsl/rkf45");
    tolerance(1e-2);
    start();
    while (weft_sim_time(sim) < 3.0) {
        double way[2] = { gap(), 0.0 }, fastest = 0.0;
        const double before = weft_sim_time(sim);
        for (int end = 0; end < 2; ++end) {
            const double t = weft_sim_time(sim);
            weft_cloth_shape_pose(cloth, 0, t, NULL, moving);
            fastest = fmax(fastest, fabs(at(0, 4) - moving[1]));
            way[end] = gap();
            if (end == 0) {
                step(3.0);
            }
        }
        ck_assert_double_gt(way[1], 0.0);
        ck_assert_double_lt((weft_sim_time(sim) - before) * fastest, way[0] + way[1]);
    }
    ck_assert_uint_gt(weft_sim_vetoed(sim), 0);
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
        shape.turn.axis[k] = noise(seed);
        shape.turn.about[k] = 0.1 * noise(seed);
    }
    shape.turn.rate = 20.0 * noise(seed), shape.turn.amplitude = noise(seed);
    shape.turn.frequency = 2.0 * (1.0 + noise(seed));
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
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 1.0, .damping = 0.01 };
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
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 1e-6, .damping = 0.0 };
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

START_TEST(mesh_collider_is_not_added_later)
{
    const weft_shape body = weft_shape_default(WEFT_MESH);
    model.contact.shape_count = 0;
    start();
    const uint64_t hash = weft_sim_measure(sim).hash;
    ck_assert_int_eq(weft_sim_add_shape(sim, &body, NULL, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(err.message, "kind mesh cannot be added"));
    ck_assert_uint_eq(weft_cloth_shapes(weft_sim_cloth(sim)), weft_cloth_shapes(cloth));
    ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
}
END_TEST

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
    ck_assert_double_eq_tol(ledger.work_outside, ledger.energy.contact, 1e-15);
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
    static unsigned char saved[MOST], again[MOST];
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

/* A simulation with a shape that was moved and one that was added; its bytes. */
static size_t save_with_shapes(unsigned char *saved)
{
    static const double slow[3] = { 0.1, 0.0, 0.2 };
    weft_shape rod = weft_shape_default(WEFT_CAPSULE);
    rod.radius = 0.01, rod.at[1] = rod.to[1] = -0.2;
    model.origin[1] = 0.1;
    start();
    go(0.05);
    ck_assert_int_eq(weft_sim_add_shape(sim, &rod, NULL, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, NULL, slow, &err), WEFT_OK);
    go(0.1);
    ck_assert_int_eq(weft_sim_save(sim, saved, MOST, &err), WEFT_OK);
    return weft_sim_save_size(sim);
}

static void refused(const unsigned char *bytes, size_t size, const char *why)
{
    const uint64_t hash = weft_sim_measure(sim).hash;
    ck_assert_int_eq(weft_sim_restore(sim, bytes, size, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, why) != NULL, "%s", err.message);
    ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
    ck_assert_uint_eq(weft_cloth_shapes(weft_sim_cloth(sim)), 2);
}

START_TEST(saved_shapes_that_are_damaged_are_refused)
{
    static unsigned char saved[MOST];
    const size_t size = save_with_shapes(saved);
    for (size_t bit = 0; bit < 8 * size; ++bit) {
        saved[bit / 8] ^= (unsigned char)(1u << bit % 8);
        refused(saved, size, "saved");
        saved[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    for (size_t length = 0; length < size; ++length) {
        refused(saved, length, "saved");
    }
    ck_assert_int_eq(weft_sim_restore(sim, saved, size, &err), WEFT_OK);
}
END_TEST

/* With a checksum that is right: words of the last shape (bench/NOTES.md). */
START_TEST(saved_shapes_that_make_no_sense_are_refused)
{
    enum { WORDS = 40, RADIUS = 10, COUNT = -WORDS - 2, LAW = -WORDS - 1 };
    static const struct {
        int word;
        double real;
        uint64_t bits;
        const char *why;
    } wrong[] = {
        { 0, 0.0, WEFT_SHAPES, "a saved shape makes no sense" },
        { 0, 0.0, UINT64_MAX, "a saved shape makes no sense" },
        { 1, NAN, 0, "a saved shape makes no sense" },
        { RADIUS, -1.0, 0, "a saved shape makes no sense" },
        { RADIUS, 1.0, 0, "was saved" },
        { WORDS - 1, INFINITY, 0, "a saved shape makes no sense" },
        { COUNT, 0.0, 3, "a saved shape makes no sense" },
        { COUNT, 0.0, UINT64_MAX / WORDS, "a saved shape makes no sense" },
        { COUNT - 1, 0.0, 1, "damaged or cut off" },
        { LAW, 0.0, 1, "saved of another cloth" },
    };
    static unsigned char saved[MOST], forged[MOST];
    const size_t size = save_with_shapes(saved), sum = 8 * saved_front(saved, size) - 8;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        memcpy(forged, saved, size);
        unsigned char *word = forged + sum + 8 * (wrong[i].word - WORDS);
        if (wrong[i].bits != 0) {
            weft__word_put(word, wrong[i].bits);
        } else {
            weft__real_put(word, wrong[i].real);
        }
        saved_mend(forged, size);
        refused(forged, size, wrong[i].why);
    }
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
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    model.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
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
    tcase_add_loop_test(tcase, no_particle_is_ever_inside, 0, (int)test_method_count());
    tcase_add_test(tcase, a_limit_is_cut_back_at_a_ball);
    tcase_add_loop_test(tcase, a_limit_stays_out_of_shapes, 0, 3);
    tcase_add_loop_test(tcase, what_cannot_be_kept_out_is_named, 0, 2);
    tcase_add_test(tcase, states_in_shapes_are_refused);
    tcase_add_test(tcase, mesh_collider_is_not_added_later);
    tcase_add_test(tcase, shapes_are_added_moved_and_removed);
    tcase_add_loop_test(tcase, a_resumed_run_has_the_same_bits, 0, 2);
    tcase_add_test(tcase, nothing_is_swung_through_a_plate_within_a_step);
    tcase_add_test(tcase, a_run_that_crawls_says_so_once);
    tcase_add_test(tcase, steps_are_bounded_by_the_gaps_at_both_ends);
    tcase_add_test(tcase, saved_shapes_that_are_damaged_are_refused);
    tcase_add_test(tcase, saved_shapes_that_make_no_sense_are_refused);
    tcase_add_test(tcase, a_sheet_on_a_ball_is_symmetric_on_any_threads);
    tcase_add_loop_test(tcase, nothing_falls_through_a_thin_plate, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
