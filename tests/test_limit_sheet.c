/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together asan-long */
/* test_limit_sheet.c -- sheets under a strain limit: order of the sweeps, momentum,
 * feasibility of random states, a cloth that falls. */
#include "limit_still.h"

/* ---- many springs ------------------------------------------------------------------
 */

/* The spring (r, c)-(r + dr, c + dc), if it is on the grid. */
static void naive_spring(ptrdiff_t r, ptrdiff_t c, ptrdiff_t dr, ptrdiff_t dc,
                         double *at)
{
    const ptrdiff_t rows = (ptrdiff_t)model.rows, cols = (ptrdiff_t)model.cols;
    if (c < 0 || c >= cols || r + dr >= rows || c + dc < 0 || c + dc >= cols) {
        return;
    }
    const size_t p = (size_t)(r * cols + c), q = (size_t)((r + dr) * cols + c + dc);
    const double rest
        = hypot((double)dr * model.spacing[0], (double)dc * model.spacing[1]);
    const double length = apart(at, p, q), most = (1.0 + wanted.limit.strain) * rest;
    const double w_p
        = weft_cloth_pinned(cloth, p) ? 0.0 : 1.0 / weft_cloth_particle_mass(cloth, p);
    const double w_q
        = weft_cloth_pinned(cloth, q) ? 0.0 : 1.0 / weft_cloth_particle_mass(cloth, q);
    if (length <= most || w_p + w_q == 0.0) {
        return;
    }
    for (size_t k = 0; k < 3; ++k) {
        const double way = (at[3 * q + k] - at[3 * p + k]) * (1.0 - most / length);
        at[3 * p + k] += w_p / (w_p + w_q) * way;
        at[3 * q + k] -= w_q / (w_p + w_q) * way;
    }
}

/* One sweep, written from the scene contract: family by family, particle by particle,
 * each with its springs in the order in which the model lists them. */
static void naive_sweep(double *at)
{
    static const ptrdiff_t springs[WEFT_FAMILIES][2][3] = {
        { { 0, 0, 1 }, { 0, 1, 0 } },  /* (r,c)-(r,c+1), (r,c)-(r+1,c) */
        { { 0, 1, 1 }, { 1, 1, -1 } }, /* (r,c)-(r+1,c+1), (r,c+1)-(r+1,c) */
        { { 0, 0, 2 }, { 0, 2, 0 } },
    };
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        for (size_t i = 0; wanted.limit.families[f] && i < particles(); ++i) {
            const ptrdiff_t r = (ptrdiff_t)(i / model.cols);
            const ptrdiff_t c = (ptrdiff_t)(i % model.cols);
            for (size_t s = 0; s < 2; ++s) {
                const ptrdiff_t *way = springs[f][s];
                naive_spring(r, c + way[0], way[1], way[2], at);
            }
        }
    }
}

START_TEST(sweeps_take_the_springs_in_the_order_of_the_contract)
{
    double expected[3 * MOST];
    sheet(5, true, true);
    model.rows = 4;
    model.spacing[1] = 0.3;
    wanted.limit.solver = WEFT_LIMIT_SWEEP;
    wanted.limit.families[WEFT_BEND] = (_i & 1) != 0;
    wanted.limit.keep_velocity = true;
    wanted.limit.sweeps = 1 + (size_t)_i;
    wanted.limit.strain = 0.05;
    make();
    step(1.0);
    ck_assert_uint_eq(weft_sim_limit_stats(sim).sweeps, wanted.limit.sweeps);
    weft_cloth_start(cloth, speed); /* planes: for the pins */
    memcpy(expected, start, sizeof expected);
    for (size_t i = 0; i < particles(); ++i) {
        for (size_t k = 0; weft_cloth_pinned(cloth, i) && k < 3; ++k) {
            expected[3 * i + k] = speed[k * particles() + i];
        }
    }
    for (size_t s = 0; s < wanted.limit.sweeps; ++s) {
        naive_sweep(expected);
    }
    for (size_t j = 0; j < 3 * particles(); ++j) {
        ck_assert_double_eq_tol(x[j], expected[j], 1e-14);
    }
}
END_TEST

/* Bits 0 to 3 of _i: solver, method, pinned, loaded. */
static void random_case(int bits)
{
    sheet(9, (bits & 4) != 0, (bits & 8) != 0);
    wanted.limit.solver = (bits & 1) != 0 ? WEFT_LIMIT_FAST : WEFT_LIMIT_SWEEP;
    wanted.limit.method = (bits & 2) != 0 ? WEFT_LIMIT_PROVOT : WEFT_LIMIT_BRIDSON;
    wanted.limit.sweeps = 100000;
    make();
}

START_TEST(no_loose_spring_is_too_long_afterwards)
{
    random_case(_i);
    uint64_t beyond = 0;
    for (int trial = 0; trial < 5; ++trial) {
        double met[3 * MOST];
        const double h = 0.01;
        sheet(9, (_i & 4) != 0, (_i & 8) != 0);
        step(h);
        const bool moved = wanted.limit.method == WEFT_LIMIT_PROVOT;
        beyond += weft_sim_limit_worst(sim).strain > 1.1 * 1.001 - 1.0;
        ck_assert_uint_eq(weft_sim_limit_stats(sim).unconverged, beyond);
        ck_assert(!moved || beyond == 0);
        for (size_t j = 0; j < 3 * particles(); ++j) {
            met[j] = x[j] + (moved ? 0.0 : h * v[j]);
        }
        for (size_t i = 0; i < particles(); ++i) {
            const size_t r = i / 9, c = i % 9;
            const double most = 1.1 * 1.001 * 0.125 * (1.0 + 1e-12);
            ck_assert(c == 8 || apart(met, i, i + 1) <= most);
            ck_assert(r == 8 || apart(met, i, i + 9) <= most);
            ck_assert(r == 8 || c == 8 || apart(met, i, i + 10) <= sqrt(2.0) * most);
            ck_assert(r == 8 || c == 8 || apart(met, i + 1, i + 9) <= sqrt(2.0) * most);
        }
        ck_assert(!moved || weft_sim_limit_worst(sim).strain <= 0.1011 + 1e-12);
    }
}
END_TEST

START_TEST(momentum_and_centre_of_mass_of_a_free_cloth_are_kept)
{
    random_case(_i & ~4);
    step(0.01);
    double total = 0.0;
    for (size_t i = 0; i < particles(); ++i) {
        total += weft_cloth_particle_mass(cloth, i);
    }
    for (size_t k = 0; k < 3; ++k) {
        double moved = 0.0, kick = 0.0, most = 0.0;
        for (size_t i = 0; i < particles(); ++i) {
            const double mass = weft_cloth_particle_mass(cloth, i);
            moved += mass * (x[3 * i + k] - start[3 * i + k]);
            kick += mass * (v[3 * i + k] - speed[3 * i + k]);
            most = fmax(most, fabs(v[3 * i + k] - speed[3 * i + k]));
        }
        ck_assert(most > 0.1);
        ck_assert_double_eq_tol(moved, 0.0, 1e-14 * total);
        ck_assert_double_eq_tol(kick, 0.0, 1e-14 * total / 0.01);
    }
}
END_TEST

START_TEST(the_same_bits_again_whatever_came_before)
{
    double first[3 * MOST];
    random_case(_i);
    step(0.01);
    memcpy(first, x, sizeof first);
    for (int again = 0; again < 2; ++again) {
        if (again == 1) {
            make();
        }
        step(0.01);
        ck_assert_mem_eq(x, first, 3 * particles() * sizeof *x);
    }
}
END_TEST

START_TEST(momentum_saves_sweeps_by_the_order)
{
    uint64_t sweeps[2];
    wanted.limit.sweeps = 100000;
    for (int fast = 0; fast < 2; ++fast) {
        setup();
        sheet(25, true, false);
        wanted.limit.sweeps = 100000;
        wanted.limit.solver = fast == 1 ? WEFT_LIMIT_FAST : WEFT_LIMIT_SWEEP;
        make();
        step(1.0);
        sweeps[fast] = weft_sim_limit_stats(sim).sweeps;
    }
    ck_assert_msg(sweeps[1] < 25 * 5 && sweeps[0] > 50 * sweeps[1], "%d, %d",
                  (int)sweeps[0], (int)sweeps[1]);
}
END_TEST

START_TEST(coincident_and_enormous_states_stay_numbers)
{
    static const double far[] = { 0.0, 1e-200, 1e30, 1e155, 1e200, 1e308 };
    for (size_t i = 0; i < COUNT(far); ++i) {
        for (int bits = 0; bits < 4; ++bits) {
            setup();
            random_case(bits);
            wanted.limit.sweeps = 50;
            for (size_t j = 0; j < 3 * particles(); ++j) {
                start[j] = j % 5 == 0 ? far[i] : 0.0;
                speed[j] = j % 7 == 0 ? -far[i] : 0.0;
            }
            make();
            step(0.01);
            for (size_t j = 0; j < 3 * particles(); ++j) {
                ck_assert(isfinite(x[j]) && isfinite(v[j]));
            }
            ck_assert(far[i] < 1e100 || weft_sim_limit_stats(sim).unconverged == 1);
        }
    }
}
END_TEST

/* ---- a cloth that falls -----------------------------------------------------------
 */

/* Hung by two corners as scenes/limited-100.yaml, on a smaller grid. */
START_TEST(a_cloth_that_falls_is_never_above_its_limit)
{
    sheet(20, true, false);
    model.down[1] = 0.0;
    model.down[2] = 1.0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        static const double stiffness[] = { 20.0, 10.0, 1.0 };
        model.springs[f] = (weft_spring_def){ .present = true,
                                              .stiffness = stiffness[f],
                                              .damping = 1e-4 * stiffness[f] };
    }
    pins[1].amplitude[0] = _i == 1 ? 0.05 : 0.0;
    pins[1].frequency = 2.0 * pins[1].amplitude[0] * 10.0;
    wanted.method = test_method_named("verlet/velocity_verlet");
    wanted.config.fixed_step = 1e-3;
    make();
    weft_sim *limited = sim;
    wanted.limit.method = WEFT_LIMIT_NONE;
    sim = NULL;
    weft_cloth *const same = cloth;
    ck_assert_int_eq(weft_sim_create(&wanted, &sim, NULL), WEFT_OK);
    double most = 0.0, most_free = 0.0;
    for (int i = 1; i <= 1000; ++i) {
        ck_assert_int_eq(weft_sim_advance(limited, 1e-3 * i, NULL), WEFT_OK);
        ck_assert_int_eq(weft_sim_advance(sim, 1e-3 * i, NULL), WEFT_OK);
        most = fmax(most, weft_sim_limit_worst(limited).strain);
        most_free = fmax(most_free,
                         weft_cloth_worst_spring(same, weft_sim_state(sim)).strain);
        for (size_t j = 19; j < 6 * 400; j += 400) { /* the pin, moved or not */
            ck_assert_double_eq(weft_sim_state(limited)[j], weft_sim_state(sim)[j]);
        }
    }
    ck_assert(most_free > 0.5);
    ck_assert(most > 0.1 && most <= 0.1011 + 1e-12);
    ck_assert_uint_eq(weft_sim_limit_stats(limited).unconverged, 0);
    weft_sim_destroy(limited);
}
END_TEST

TEST_SUITE(limit_sheet)
{
    Suite *all = suite_create("limit_sheet");
    TCase *tests = tcase_create("limit_sheet");
    tcase_set_timeout(tests, 120);
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_loop_test(tests, sweeps_take_the_springs_in_the_order_of_the_contract, 0,
                        6);
    tcase_add_loop_test(tests, no_loose_spring_is_too_long_afterwards, 0, 16);
    tcase_add_loop_test(tests, momentum_and_centre_of_mass_of_a_free_cloth_are_kept, 0,
                        16);
    tcase_add_loop_test(tests, the_same_bits_again_whatever_came_before, 0, 16);
    tcase_add_test(tests, momentum_saves_sweeps_by_the_order);
    tcase_add_test(tests, coincident_and_enormous_states_stay_numbers);
    tcase_add_loop_test(tests, a_cloth_that_falls_is_never_above_its_limit, 0, 2);
    suite_add_tcase(all, tests);
    return all;
}
