/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together asan-long */
/* test_pins.c -- pins put, moved and released while a simulation runs. */
#include "one_sim.h"

#include <math.h>
#include <string.h>

#define ROWS 4
#define COLS 3
#define N    (ROWS * COLS)

static weft_pin corner;
static weft_cloth_def model;
static weft_sim_def run;

static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = ROWS;
    model.cols = COLS;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 8.0, .damping = 0.05 };
    }
    corner = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    model.pins = &corner;
    model.pin_count = 1;
    model.velocity[2] = 0.5;
    run = weft_sim_def_default();
    run.method = test_method_named("verlet/velocity_verlet");
    run.config.fixed_step = 1e-3;
}

static weft_sim *another(void)
{
    weft_error err = { 0 };
    weft_sim *made = NULL;
    run.cloth = cloth;
    run.config = test_config(run.method, run.config);
    ck_assert_msg(weft_sim_create(&run, &made, &err) == WEFT_OK, "%s", err.message);
    return made;
}

static void start(void)
{
    teardown();
    cloth = test_cloth(&model);
    sim = another();
}

static void go(weft_sim *with, double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(with, t, &err) == WEFT_OK, "%s: %s",
                  run.method->name, err.message);
}

static void at(const weft_sim *of, size_t i, double x[3], double v[3])
{
    double all[3 * N];
    weft_sim_positions(of, all);
    memcpy(x, all + 3 * i, 3 * sizeof *x);
    weft_sim_velocities(of, all);
    memcpy(v, all + 3 * i, 3 * sizeof *v);
}

static void fine(weft_status status)
{
    ck_assert_int_eq(status, WEFT_OK);
}

static void no_springs(void)
{
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].present = false;
    }
    memset(model.velocity, 0, sizeof model.velocity);
}

/* ---- a particle ---------------------------------------------------------------- */

START_TEST(released_pin_falls_freely)
{
    double x[3], v[3];
    no_springs();
    run.method = test_method((size_t)_i);
    run.config = weft_stepper_config_default();
    if ((run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        run.config.fixed_step = 1e-3;
    }
    start();
    go(sim, 0.25);
    fine(weft_sim_unpin(sim, 0, NULL));
    ck_assert_uint_eq(weft_cloth_pins(weft_sim_cloth(sim)), 0);
    go(sim, 0.75);
    at(sim, 0, x, v);
    /* first order in h = 1 ms of the Euler methods: g h t / 2 */
    ck_assert_double_eq_tol(v[1], -9.81 * 0.5, 1e-4);
    ck_assert_double_eq_tol(x[1], -0.5 * 9.81 * 0.25, 3e-3);
    ck_assert(x[0] == 0.0 && v[2] == 0.0);
}
END_TEST

START_TEST(pinned_particle_holds_bit_for_bit)
{
    double x[3], v[3], x_later[3];
    run.limit.method = _i == 0   ? WEFT_LIMIT_NONE
                       : _i == 1 ? WEFT_LIMIT_PROVOT
                                 : WEFT_LIMIT_BRIDSON;
    run.limit.strain = 0.02;
    start();
    go(sim, 0.3);
    at(sim, 7, x, v);
    ck_assert(v[1] != 0.0);
    fine(weft_sim_pin(sim, 7, NULL, NULL));
    go(sim, 0.8);
    at(sim, 7, x_later, v);
    ck_assert_mem_eq(x, x_later, sizeof x);
    ck_assert(v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0);
    if (run.limit.method != WEFT_LIMIT_NONE) {
        ck_assert_uint_gt(weft_sim_limit_stats(sim).corrected, 0);
    }
}
END_TEST

START_TEST(pin_arrives_where_its_velocity_leads)
{
    const double goal[3] = { 0.3, -0.2, 0.1 };
    double x[3], v[3];
    start();
    go(sim, 0.2);
    for (int frame = 1; frame <= 3; ++frame) { /* the recipe of weft/sim.h */
        const double t = 0.2 + frame / 10.0;
        at(sim, 5, x, v);
        for (size_t k = 0; k < 3; ++k) {
            v[k] = (frame * goal[k] - x[k]) / (t - weft_sim_time(sim));
        }
        fine(weft_sim_pin(sim, 5, v, NULL));
        go(sim, t);
        at(sim, 5, x, v);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(x[k], frame * goal[k], 1e-13);
        }
    }
}
END_TEST

START_TEST(pin_jumps_exactly_and_only_if_it_is_one)
{
    const double place[3] = { 0.1, 0.2, -0.3 };
    double x[3], v[3], y[6 * N];
    start();
    memcpy(y, weft_sim_state(sim), sizeof y);
    ck_assert_int_eq(weft_sim_move_pin(sim, 1, place, NULL), WEFT_INVALID);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    fine(weft_sim_move_pin(sim, 0, place, NULL));
    go(sim, 0.2);
    at(sim, 0, x, v);
    ck_assert_mem_eq(x, place, sizeof x);
}
END_TEST

START_TEST(mistakes_change_nothing)
{
    const double wrong[3] = { 0.0, NAN, 0.0 };
    double y[6 * N];
    weft_error err = { 0 };
    start();
    go(sim, 0.1);
    memcpy(y, weft_sim_state(sim), sizeof y);
    ck_assert_int_eq(weft_sim_pin(sim, N, NULL, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "no particle 12"));
    ck_assert_int_eq(weft_sim_pin(sim, 3, wrong, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_move_pin(sim, 0, wrong, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_unpin(sim, N, &err), WEFT_INVALID);
    fine(weft_sim_unpin(sim, 3, &err)); /* is free */
    ck_assert_uint_eq(weft_cloth_pins(weft_sim_cloth(sim)), 1);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
}
END_TEST

/* ---- against other ways to the same end ------------------------------------------ */

START_TEST(pin_put_at_the_start_is_one_of_the_definition)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_pin two[2]
        = { corner,
            { .rows = { 2, 2 }, .cols = { 1, 1 }, .velocity = { 0.1, 0, -0.2 } } };
    double y[6 * N];
    run.method = test_method((size_t)_i);
    run.config = weft_stepper_config_default();
    if ((run.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        run.config.fixed_step = 2e-3;
    }
    model.pins = two;
    model.pin_count = 2;
    start();
    go(sim, 0.1);
    memcpy(y, weft_sim_state(sim), sizeof y);
    model.pin_count = 1;
    start();
    fine(weft_sim_pin(sim, 2 * COLS + 1, two[1].velocity, NULL));
    go(sim, 0.1);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
}
END_TEST

/* Of two entries for one particle the last holds. */
START_TEST(many_pins_are_pins_one_after_another)
{
    const size_t which[4] = { 5, 7, 11, 5 };
    const double v[4][3]
        = { { 9, 9, 9 }, { 0.1, 0, 0 }, { 0, -0.2, 0 }, { 0, 0, 0.3 } };
    double y[6 * N];
    for (int still = 0; still < 2; ++still) {
        start();
        go(sim, 0.1);
        for (size_t j = 0; j < 4; ++j) {
            fine(weft_sim_pin(sim, which[j], still ? NULL : v[j], NULL));
        }
        go(sim, 0.2);
        memcpy(y, weft_sim_state(sim), sizeof y);
        start();
        go(sim, 0.1);
        fine(weft_sim_pin_many(sim, which, still ? NULL : v[0], 4, NULL));
        go(sim, 0.2);
        ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    }
}
END_TEST

START_TEST(of_many_pins_one_mistake_changes_none)
{
    double v[2][3] = { { 0.1, 0, 0 }, { 0, NAN, 0 } }, y[6 * N];
    weft_error err = { 0 };
    start();
    memcpy(y, weft_sim_state(sim), sizeof y);
    const size_t good[2] = { 5, 7 }, bad[2] = { 5, N };
    ck_assert_int_eq(weft_sim_pin_many(sim, bad, NULL, 2, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "no particle 12"));
    ck_assert_int_eq(weft_sim_pin_many(sim, good, v[0], 2, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "particle 7"));
    fine(weft_sim_pin_many(sim, NULL, NULL, 0, &err));
    ck_assert_uint_eq(weft_cloth_pins(weft_sim_cloth(sim)), 1);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
}
END_TEST

/* The right-hand side of the simulation's cloth is that of one made with these pins. */
static void expect_pins(const bool pinned[N], double velocity[N][3])
{
    weft_pin pins[N];
    double is[6 * N], wanted[6 * N];
    const weft_cloth *own = weft_sim_cloth(sim);
    size_t count = 0;
    for (size_t i = 0; i < N; ++i) {
        const ptrdiff_t r = (ptrdiff_t)(i / COLS), c = (ptrdiff_t)(i % COLS);
        ck_assert(weft_cloth_pinned(own, i) == pinned[i]);
        if (pinned[i]) {
            pins[count] = (weft_pin){ .rows = { r, r }, .cols = { c, c } };
            memcpy(pins[count++].velocity, velocity[i], sizeof velocity[i]);
        }
    }
    ck_assert_uint_eq(weft_cloth_pins(own), count);
    model.pins = pins;
    model.pin_count = count;
    weft_cloth *fresh = test_cloth(&model);
    ck_assert_int_eq(weft_cloth_rhs(own, 0.5, weft_sim_state(sim), is), 0);
    ck_assert_int_eq(weft_cloth_rhs(fresh, 0.5, weft_sim_state(sim), wanted), 0);
    ck_assert_mem_eq(is, wanted, sizeof is);
    weft_cloth_destroy(fresh);
}

START_TEST(any_sequence_of_changes_leaves_the_pins_it_should)
{
    bool pinned[N] = { true };
    double velocity[N][3] = { { 0 } };
    uint32_t random = 12345;
    start();
    for (int step = 0; step < 300; ++step) {
        random = random * 1664525u + 1013904223u;
        const size_t i = (random >> 16) % N;
        if ((random >> 8) % 3 == 0) {
            fine(weft_sim_unpin(sim, i, NULL));
            pinned[i] = false;
        } else {
            const double v[3] = { step, -0.5 * step, 1.0 };
            fine(weft_sim_pin(sim, i, v, NULL));
            memcpy(velocity[i], v, sizeof v);
            pinned[i] = true;
        }
        expect_pins(pinned, velocity);
    }
}
END_TEST

START_TEST(others_on_the_same_cloth_keep_their_pins)
{
    double y[6 * N];
    start();
    go(sim, 0.2);
    memcpy(y, weft_sim_state(sim), sizeof y);
    start();
    weft_sim *other = another();
    fine(weft_sim_unpin(other, 0, NULL));
    fine(weft_sim_pin(other, 4, NULL, NULL));
    go(other, 0.2);
    go(sim, 0.2);
    ck_assert(weft_cloth_pinned(cloth, 0) && !weft_cloth_pinned(cloth, 4));
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    ck_assert_mem_ne(y, weft_sim_state(other), sizeof y);
    weft_sim_destroy(other);
}
END_TEST

START_TEST(a_simulation_may_start_with_the_pins_of_another)
{
    const double up[3] = { 0.0, 0.5, 0.0 };
    double from[3], x[3], v[3];
    start();
    fine(weft_sim_pin(sim, 7, up, NULL));
    fine(weft_sim_unpin(sim, 0, NULL));
    const weft_cloth *shared = cloth;
    cloth = (weft_cloth *)weft_sim_cloth(sim);
    weft_sim *other = another();
    cloth = (weft_cloth *)shared;
    ck_assert(!weft_cloth_pinned(weft_sim_cloth(other), 0));
    at(other, 7, from, v);
    ck_assert_mem_eq(v, up, sizeof v);
    go(other, 0.1);
    at(other, 7, x, v);
    ck_assert_mem_eq(v, up, sizeof v);
    ck_assert_double_eq_tol(x[1], from[1] + 0.05, 1e-12);
    weft_sim_destroy(other);
}
END_TEST

START_TEST(a_simulation_made_from_the_cloth_of_another_does_not_follow_its_pins)
{
    start();
    const weft_cloth *shared = cloth;
    cloth = (weft_cloth *)weft_sim_cloth(sim);
    weft_sim *other = another();
    cloth = (weft_cloth *)shared;
    const size_t size = weft_sim_save_size(other);
    unsigned char *saved = malloc(size);
    fine(weft_sim_save(other, saved, size, NULL));
    fine(weft_sim_unpin(sim, 0, NULL));
    fine(weft_sim_restore(other, saved, size, NULL));
    ck_assert(weft_cloth_pinned(weft_sim_cloth(other), 0));
    free(saved);
    weft_sim_destroy(other);
}
END_TEST

/* ---- energy ---------------------------------------------------------------------- */

static double total(const weft_energy *energy)
{
    return energy->kinetic + energy->gravitational + energy->elastic[0]
           + energy->elastic[1] + energy->elastic[2];
}

/* What a change of pins adds to the energy is outside work, to the last bit or two; the
 * rest is an undamped swing, which conserves it. */
START_TEST(changes_of_pins_are_accounted_for)
{
    double jump = 0.0, place[3], v[3];
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].damping = 0.0;
    }
    run.ledger = true;
    run.config.fixed_step = 1e-4;
    start();
    for (int i = 0; i < 4; ++i) {
        go(sim, 0.1 * (i + 1));
        weft_ledger ledger = weft_sim_ledger(sim);
        const double before = total(&ledger.energy);
        switch (i) {
        case 0:
            fine(weft_sim_pin(sim, 7, NULL, NULL));
            break;
        case 1:
            at(sim, 7, place, v);
            place[0] += 0.02;
            fine(weft_sim_move_pin(sim, 7, place, NULL));
            break;
        case 2:
            fine(weft_sim_unpin(sim, 0, NULL));
            break;
        default:
            fine(weft_sim_pin(sim, 7, (const double[]){ 0.5, 0.0, 0.0 }, NULL));
            break;
        }
        ledger = weft_sim_ledger(sim);
        jump += total(&ledger.energy) - before;
        ck_assert_double_eq_tol(ledger.work_outside, jump, 1e-12);
    }
    go(sim, 0.6);
    const weft_ledger ledger = weft_sim_ledger(sim);
    ck_assert_double_gt(fabs(ledger.work_pins), 1e-3);
    ck_assert_double_eq_tol(ledger.residual, 0.0, 1e-5);
}
END_TEST

TEST_SUITE(pins)
{
    Suite *suite = suite_create("pins");
    TCase *tcase = tcase_create("pins");
    const int methods = (int)test_method_count();
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, released_pin_falls_freely, 0, methods);
    tcase_add_loop_test(tcase, pinned_particle_holds_bit_for_bit, 0, 3);
    tcase_add_test(tcase, pin_arrives_where_its_velocity_leads);
    tcase_add_test(tcase, pin_jumps_exactly_and_only_if_it_is_one);
    tcase_add_test(tcase, mistakes_change_nothing);
    tcase_add_loop_test(tcase, pin_put_at_the_start_is_one_of_the_definition, 0,
                        methods);
    tcase_add_test(tcase, many_pins_are_pins_one_after_another);
    tcase_add_test(tcase, of_many_pins_one_mistake_changes_none);
    tcase_add_test(tcase, any_sequence_of_changes_leaves_the_pins_it_should);
    tcase_add_test(tcase, others_on_the_same_cloth_keep_their_pins);
    tcase_add_test(tcase, a_simulation_may_start_with_the_pins_of_another);
    tcase_add_test(
        tcase, a_simulation_made_from_the_cloth_of_another_does_not_follow_its_pins);
    tcase_add_test(tcase, changes_of_pins_are_accounted_for);
    suite_add_tcase(suite, tcase);
    return suite;
}
