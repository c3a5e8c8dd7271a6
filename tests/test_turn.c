/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_turn.c -- shapes that turn while time passes. Their forces in a given state are
 * in test_contact.c, the order of methods in test_contact_laws.c. */
#include <string.h>

#include "cloth/model.h"
#include "contact_run.h"

/* A turn about y, or about an axis of the shape, with this rate. */
static weft_turn turn_about(double x, double y, double z, double rate)
{
    weft_turn turn = weft_shape_default(WEFT_BOX).turn;
    turn.axis[0] = x, turn.axis[1] = y, turn.axis[2] = z;
    turn.rate = rate;
    return turn;
}

static weft_shape box(double x, double y, double z)
{
    weft_shape shape = weft_shape_default(WEFT_BOX);
    shape.half[0] = x, shape.half[1] = y, shape.half[2] = z;
    shape.rounding = 1e-3;
    return shape;
}

/* A table that turns carries what lies on it like a plane that spins. */
START_TEST(a_box_that_turns_is_a_turntable)
{
    double state[2][12];
    model.contact.friction = 0.5, model.contact.damping = 1.0;
    model.origin[0] = 0.1, model.origin[1] = 0.004, model.velocity[0] = 0.2;
    tolerance(1e-9);
    for (int i = 0; i < 2; ++i) {
        if (i == 0) {
            shapes[0].spin[1] = 5.0;
        } else {
            shapes[0] = box(3.0, 0.2, 3.0);
            shapes[0].at[0] = 0.7, shapes[0].at[1] = -0.2;
            shapes[0].turn = turn_about(0.0, 3.0, 0.0, 5.0);
            memset(shapes[0].turn.about, 0, sizeof shapes[0].turn.about);
        }
        start();
        go(0.4);
        memcpy(state[i], weft_sim_state(sim), sizeof state[i]);
    }
    for (size_t j = 0; j < 12; ++j) {
        ck_assert_double_eq_tol(state[0][j], state[1][j], 1e-7);
    }
    ck_assert_double_gt(hypot(state[1][6], state[1][8]), 0.3);
}
END_TEST

/* A blade 4 mm thick, at 40 rad/s, against particles at rest: it drives them before it,
 * above it in its own frame. */
START_TEST(nothing_passes_a_blade)
{
    static const char *const methods[]
        = { "gsl/rkf45", "gsl/rk8pd",   "arkode/dormand_prince",  "arkode/verner65",
            "gsl/rk4",   "gsl/msadams", "verlet/velocity_verlet", "arkode/trbdf2" };
    const double rate = 40.0, angle = 0.4;
    run.method = test_method_named(methods[_i]);
    shapes[0] = box(0.5, 2e-3, 0.5);
    shapes[0].turn = turn_about(0.0, 0.0, 1.0, rate);
    memset(model.gravity, 0, sizeof model.gravity);
    model.origin[0] = 0.3 * cos(angle), model.origin[1] = 0.3 * sin(angle);
    model.spacing[1] = 0.01;
    tolerance(1e-6);
    run.config.fixed_step
        = (run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 0.01 : 0.0;
    start();
    while (weft_sim_time(sim) < 0.02) {
        step(0.02);
        const double a = rate * weft_sim_time(sim);
        ck_assert_double_gt(gap(), 0.0);
        ck_assert_double_gt(at(0, 1) * cos(a) - at(0, 0) * sin(a), 0.0);
    }
    ck_assert_double_gt(hypot(at(0, 3), at(0, 4)), 10.0);
    ck_assert_uint_gt(weft_sim_vetoed(sim), 0);
}
END_TEST

/* A loose sheet that a box and a capsule drag and lift while they turn to and fro. */
static void sheet_on_turning_shapes(void)
{
    shapes[0] = box(0.1, 0.03, 0.1);
    shapes[0].rounding = 0.02, shapes[0].at[1] = -0.05;
    shapes[0].turn = turn_about(0.2, 1.0, 0.1, 4.0);
    shapes[0].turn.amplitude = 0.3, shapes[0].turn.frequency = 3.0;
    shapes[0].velocity[1] = 0.3;
    shapes[1] = weft_shape_default(WEFT_CAPSULE);
    shapes[1].at[0] = 0.12, shapes[1].at[1] = shapes[1].to[1] = -0.06;
    shapes[1].to[0] = 0.3, shapes[1].radius = 0.04;
    shapes[1].turn = turn_about(0.0, 0.1, 1.0, 2.0);
    memset(shapes[1].turn.about, 0, sizeof shapes[1].turn.about);
    level_sheet();
    model.contact.shape_count = 2, model.contact.friction = 0.5;
    model.contact.damping = 1.0;
}

static void pose(const weft_sim *of, double at_rotation[12])
{
    weft_cloth_shape_pose(weft_sim_cloth(of), 0, weft_sim_time(of), at_rotation, NULL);
    weft_cloth_shape_rotation(weft_sim_cloth(of), 0, weft_sim_time(of), at_rotation + 3,
                              NULL);
}

/* From where it is and as it stands; other moves stop the turn, or carry its axis. */
START_TEST(a_shape_that_is_driven_goes_on_from_its_pose)
{
    static const double still[3] = { 0 }, there[3] = { 0.2, -0.4, 0.1 };
    double before[12], after[12], omega[3];
    sheet_on_turning_shapes();
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-8);
    start();
    go(0.1);
    weft_shape as = weft_shape_default(WEFT_PLANE);
    as.turn = turn_about(1.0, 0.0, 0.0, -6.0);
    as.turn.amplitude = 0.2, as.turn.frequency = 7.0, as.amplitude[0] = 0.1;
    as.turn.about[0] = as.turn.about[1] = as.turn.about[2] = -0.05, as.frequency = 4.0;
    pose(sim, before);
    ck_assert_int_eq(weft_sim_drive_shape(sim, 0, &as, &err), WEFT_OK);
    pose(sim, after);
    for (size_t j = 0; j < 12; ++j) {
        ck_assert_double_eq_tol(after[j], before[j], 1e-15);
    }
    weft_cloth_shape_rotation(weft_sim_cloth(sim), 0, 0.1, NULL, omega);
    ck_assert_double_eq_tol(
        omega[0], -6.0 + 0.2 * 14.0 * acos(-1.0) * cos(1.4 * acos(-1.0)), 1e-13);
    as.turn.frequency = -1.0;
    ck_assert_int_eq(weft_sim_drive_shape(sim, 0, &as, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "shapes[0]: turn: frequency -1 Hz"));
    go(0.12);
    pose(sim, before);
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, there, NULL, &err), WEFT_OK);
    pose(sim, after);
    for (size_t j = 0; j < 12; ++j) { /* still turns: see omega */
        ck_assert_double_eq_tol(after[j], j < 3 ? there[j] : before[j], 1e-15);
    }
    weft_cloth_shape_rotation(weft_sim_cloth(sim), 0, 0.12, NULL, omega);
    ck_assert_double_gt(fabs(omega[0]), 1.0);
    ck_assert_int_eq(weft_sim_move_shape(sim, 0, NULL, still, &err), WEFT_OK);
    go(0.14);
    pose(sim, after);
    for (size_t j = 0; j < 12; ++j) {
        ck_assert_double_eq_tol(after[j], j < 3 ? there[j] : before[j], 1e-15);
    }
}
END_TEST

START_TEST(a_saved_shape_turns_on_with_the_same_bits)
{
    static unsigned char saved[8192];
    weft_sim *other = NULL;
    sheet_on_turning_shapes();
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-6);
    start();
    go(0.05);
    weft_shape as = weft_shape_default(WEFT_PLANE);
    as.turn = turn_about(1.0, 0.2, 0.0, -3.0);
    ck_assert_int_eq(weft_sim_drive_shape(sim, 0, &as, &err), WEFT_OK);
    go(0.1);
    const size_t size = weft_sim_save_size(sim);
    ck_assert_uint_le(size, sizeof saved);
    ck_assert_int_eq(weft_sim_save(sim, saved, size, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_create(&run, &other, &err), WEFT_OK);
    ck_assert_msg(weft_sim_restore(other, saved, size, &err) == WEFT_OK, "%s",
                  err.message);
    go(0.3);
    ck_assert_int_eq(weft_sim_advance(other, 0.3, &err), WEFT_OK);
    ck_assert_uint_gt(weft_sim_measure(sim).touching, 0);
    ck_assert_uint_eq(weft_sim_measure(other).hash, weft_sim_measure(sim).hash);
    weft_sim_destroy(other);
}
END_TEST

/* A turn is part of a cloth's hash; one without an axis is none. */
START_TEST(hashes_tell_turns_apart)
{
    uint64_t hash[4];
    for (size_t i = 0; i < 4; ++i) {
        shapes[0] = box(0.1, 0.1, 0.1), shapes[0].at[1] = -1.0;
        shapes[0].turn = turn_about(0.0, 0.0, i < 2 ? 0.0 : 1.0, i == 1 ? 2.0 : 3.0);
        shapes[0].turn.amplitude = i == 3 ? 0.1 : 0.0;
        start();
        hash[i] = weft__contact_force.tables.hash(&cloth->contact, 0);
    }
    ck_assert(hash[0] == hash[1] && hash[1] != hash[2] && hash[2] != hash[3]);
}
END_TEST

TEST_SUITE(turn)
{
    Suite *suite = suite_create("turn");
    TCase *tcase = tcase_create("turn");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, a_box_that_turns_is_a_turntable);
    tcase_add_loop_test(tcase, nothing_passes_a_blade, 0, 8);
    tcase_add_test(tcase, a_shape_that_is_driven_goes_on_from_its_pose);
    tcase_add_test(tcase, a_saved_shape_turns_on_with_the_same_bits);
    tcase_add_test(tcase, hashes_tell_turns_apart);
    suite_add_tcase(suite, tcase);
    return suite;
}
