/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_threads.c -- whole runs have the same bits on every level of instructions and on
 * any number of threads; helpers do every part of a job once. `make tsan` looks for
 * races in this one. */
#include "support.h"

#include <fenv.h>
#include <float.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "cloth/model.h"
#include "moving_grid.h"
#include "sim/forces.h"

enum { PARTS = 97, JOBS = 3000, SIDE = 130, STEPS = 4 };

static void count(void *ctx, size_t i)
{
    unsigned *parts = ctx;
    ++parts[i];
}

START_TEST(every_part_of_every_job_is_done_once)
{
    for (size_t threads = 2; threads <= 9; threads += 7) {
        weft__pool *pool = weft__pool_create(threads, NULL);
        ck_assert_uint_eq(weft__pool_threads(pool), threads);
        for (unsigned job = 1; job <= JOBS; ++job) {
            unsigned parts[PARTS] = { 0 };
            const size_t number = job % (PARTS + 1);
            weft__pool_run(pool, count, parts, number);
            for (size_t i = 0; i < PARTS; ++i) {
                ck_assert_uint_eq(parts[i], i < number ? 1 : 0);
            }
        }
        weft__pool_destroy(pool);
    }
    ck_assert_uint_eq(weft__pool_threads(NULL), 1);
}
END_TEST

/* What the mode makes of 1 + 1e-30, -1 - 1e-30 and half of the least normal number. */
typedef struct mode {
    double up, down, half;
} mode;

static mode try_mode(void)
{
    const volatile double one = 1.0, tiny = 1e-30, least = DBL_MIN;
    return (mode){ one + tiny, -one - tiny, least / 2.0 };
}

/* Two parts of a job that wait for one another, so that each has a thread of its own.
 */
typedef struct pair {
    atomic_int begun;
    mode seen[2];
} pair;

static void meet(void *ctx, size_t i)
{
    pair *both = ctx;
    atomic_fetch_add(&both->begun, 1);
    while (atomic_load(&both->begun) < 2) {
        (void)sched_yield();
    }
    both->seen[i] = try_mode();
}

START_TEST(helpers_take_the_floating_point_mode_of_the_caller_for_every_job)
{
    static const int roundings[] = { FE_UPWARD, FE_DOWNWARD, FE_TONEAREST };
    weft__pool *pool = weft__pool_create(2, NULL);
    for (int i = 0; i < 12; ++i) {
        pair both = { .begun = 0 };
        ck_assert_int_eq(fesetround(roundings[i % 3]), 0);
#ifdef __SSE2__
        const unsigned flush = i % 2 == 0 ? 0x8040 : 0; /* FTZ and DAZ */
        _mm_setcsr((_mm_getcsr() & ~0x8040u) | flush);
#endif
        const mode own = try_mode();
        weft__pool_run(pool, meet, &both, 2);
        (void)fesetenv(FE_DFL_ENV);
        ck_assert((own.up > 1.0) == (i % 3 == 0) && (own.down < -1.0) == (i % 3 == 1));
        for (int part = 0; part < 2; ++part) {
            ck_assert(both.seen[part].up == own.up);
            ck_assert(both.seen[part].down == own.down);
            ck_assert(both.seen[part].half == own.half);
        }
    }
    weft__pool_destroy(pool);
}
END_TEST

/* A small cloth has one thread, whatever is asked for. */
START_TEST(threads_are_no_more_than_pay)
{
    weft_cloth_def def = weft_cloth_def_default();
    const size_t side[] = { 32, 64, 64, SIDE }, asked[] = { 8, 1, 8, 3 };
    const size_t given[] = { 1, 1, 2, 3 };
    for (size_t i = 0; i < 4; ++i) {
        def.rows = def.cols = side[i];
        weft_cloth *cloth = test_cloth(&def);
        weft__forces forces = weft__forces_create(cloth, asked[i], NULL);
        ck_assert_uint_eq(weft__pool_threads(forces.pool), given[i]);
        weft__forces_destroy(&forces);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

static weft_cloth *flag(size_t rows, size_t cols)
{
    return moving_grid(rows, cols, GRID_FULL);
}

/* Set once a simulation is there. */
static int rounding = FE_TONEAREST;

/* The state after some steps. */
static uint64_t run(const weft_cloth *cloth, const weft_stepper_type *method,
                    size_t threads, bool ledger)
{
    weft_sim *sim;
    weft_error err;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = method;
    def.config = test_config(method, def.config);
    def.config.threads = threads;
    def.config.fixed_step = 1e-4;
    def.ledger = ledger;
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    (void)fesetround(rounding);
    for (int i = 0; i < STEPS; ++i) {
        ck_assert_msg(weft_sim_step(sim, 1.0, &err) == WEFT_OK, "%s", err.message);
    }
    (void)fesetround(FE_TONEAREST);
    const uint64_t hash = weft_sim_measure(sim).hash;
    weft_sim_destroy(sim);
    return hash;
}

START_TEST(runs_have_the_same_bits_on_any_threads_and_instructions)
{
    const char *const names[]
        = { "verlet/velocity_verlet", "gsl/rkf45", "arkode/dormand_prince" };
    const size_t threads[] = { 1, 2, 3, 8 };
    if (_i % 2 != _i / 2 % 2 && test_rounds(1, 0)) {
        return; /* each method with one of the cloths, unless there is time */
    }
    weft_cloth *cloth = moving_grid(SIDE, SIDE + 20,
                                    _i % 2 == 0 ? GRID_FULL : GRID_FULL + GRID_RIGID);
    const weft_stepper_type *method = test_method_named(names[_i / 2]);
    uint64_t first = 0;
    for (size_t i = 0; i < 4 * (size_t)weft__isa_last(); ++i) {
        weft__cloth_choose(cloth, (weft__isa)(i / 4 + 1));
        const uint64_t hash = run(cloth, method, threads[i % 4], false);
        first = i == 0 ? hash : first;
        ck_assert_msg(hash == first, "%s, %zu threads, %s", names[_i / 2],
                      threads[i % 4], weft_cloth_isa(cloth));
    }
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_rounding_mode_set_late_gives_the_same_bits_on_any_threads)
{
    const char *const names[]
        = { "verlet/velocity_verlet", "gsl/rkf45", "arkode/dormand_prince" };
    weft_cloth *cloth = flag(SIDE, SIDE);
    const weft_stepper_type *method = test_method_named(names[_i]);
    const uint64_t nearest = run(cloth, method, 1, false);
    rounding = FE_UPWARD;
    const uint64_t upward = run(cloth, method, 1, false);
    ck_assert(upward != nearest);
    for (size_t i = 0; i < 8; ++i) {
        ck_assert(run(cloth, method, 2 + i % 2, false) == upward);
    }
    rounding = FE_TONEAREST; /* also where no test has a process of its own */
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(ledger_has_the_same_state_on_threads)
{
    weft_cloth *cloth = flag(SIDE, SIDE);
    const weft_stepper_type *method = test_method_named("gsl/rkf45");
    ck_assert(run(cloth, method, 1, false) == run(cloth, method, 3, true));
    weft_cloth_destroy(cloth);
}
END_TEST

/* Those of a simulation on `threads` are those of the cloth on this one; powers only
 * with a ledger. */
static void compare_measures(const weft_cloth *cloth, size_t threads, bool ledger)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = test_method_named("gsl/rk4");
    def.config.threads = threads;
    def.config.fixed_step = 1e-4;
    def.ledger = ledger;
    weft_sim *sim = NULL;
    ck_assert_int_eq(weft_sim_create(&def, &sim, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
    const double *y = weft_sim_state(sim);
    const weft_measures all = weft_sim_measure(sim);
    const weft_energy energy = weft_cloth_energy(cloth, weft_sim_time(sim), y);
    const weft_spring worst = weft_cloth_worst_spring(cloth, y);
    double p[3], l[3], power[WEFT_POWERS] = { 0 };
    weft_cloth_momentum(cloth, y, p);
    weft_cloth_angular_momentum(cloth, y, l);
    if (ledger) {
        weft_cloth_power(cloth, weft_sim_time(sim), y, power);
    }
    ck_assert_mem_eq(&all.energy, &energy, sizeof energy);
    ck_assert_mem_eq(all.momentum, p, sizeof p);
    ck_assert_mem_eq(all.angular_momentum, l, sizeof l);
    ck_assert_mem_eq(all.power, power, sizeof power);
    ck_assert(all.worst.strain == worst.strain && all.worst.p == worst.p
              && all.worst.q == worst.q && all.worst.family == worst.family);
    ck_assert_uint_eq(all.hash, weft_state_hash(y, SIDE, SIDE));
    size_t particle, shape;
    ck_assert(all.gap
              == weft_cloth_gap(cloth, weft_sim_time(sim), y, &particle, &shape));
    ck_assert(all.gap_particle == particle && all.gap_shape == shape);
    ck_assert_uint_eq(all.touching, weft_cloth_touching(cloth, weft_sim_time(sim), y));
    ck_assert_uint_gt(all.touching, 100);
    weft_sim_destroy(sim);
}

START_TEST(measures_have_the_same_bits_on_any_threads)
{
    weft_cloth *cloth = flag(SIDE, SIDE);
    for (size_t threads = 1; threads <= 5; ++threads) {
        compare_measures(cloth, threads, threads % 2 == 1);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

static int pull(void *ctx, double t, const double *y, double *f)
{
    (void)ctx;
    for (size_t i = 0; i < SIDE * SIDE; ++i) {
        f[i] -= 0.1 * (1.0 + t) * y[i];
    }
    return 0;
}

/* The state after steps with a force of the embedder's, between which pins change. */
static uint64_t run_embedded(const weft_cloth *cloth, size_t threads)
{
    const double slow[3] = { 0.0, 0.0, 0.5 };
    weft_sim *sim;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = test_method_named("verlet/velocity_verlet");
    def.config.threads = threads;
    def.config.fixed_step = 1e-4;
    def.ledger = true;
    def.force = pull;
    ck_assert_int_eq(weft_sim_create(&def, &sim, NULL), WEFT_OK);
    for (size_t i = 0; i < STEPS; ++i) {
        ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
        ck_assert_int_eq(weft_sim_pin(sim, SIDE * (20 * i + 9) + 5, slow, NULL),
                         WEFT_OK);
        ck_assert_int_eq(weft_sim_unpin(sim, SIDE * 30 * i, NULL), WEFT_OK);
    }
    ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
    const uint64_t hash
        = test_hash(weft_sim_state(sim), weft_cloth_dim(cloth) + WEFT_POWERS);
    weft_sim_destroy(sim);
    return hash;
}

START_TEST(pins_that_change_and_outer_forces_have_the_same_bits_on_threads)
{
    weft_cloth *cloth = flag(SIDE, SIDE);
    ck_assert(run_embedded(cloth, 1) == run_embedded(cloth, 3));
    weft_cloth_destroy(cloth);
}
END_TEST

typedef struct job {
    const weft_cloth *cloth;
    const weft_stepper_type *method;
    uint64_t hash;
} job;

static void *work(void *ctx)
{
    job *of = ctx;
    of->hash = run(of->cloth, of->method, 2, false);
    return NULL;
}

START_TEST(simulations_in_several_threads_share_a_cloth)
{
    weft_cloth *cloth = flag(SIDE, SIDE);
    const weft_stepper_type *method = test_method_named("verlet/velocity_verlet");
    job jobs[3];
    pthread_t threads[3];
    for (int i = 0; i < 3; ++i) {
        jobs[i] = (job){ cloth, method, 0 };
        ck_assert_int_eq(pthread_create(&threads[i], NULL, work, &jobs[i]), 0);
    }
    for (int i = 0; i < 3; ++i) {
        ck_assert_int_eq(pthread_join(threads[i], NULL), 0);
    }
    const uint64_t alone = run(cloth, method, 1, false);
    for (int i = 0; i < 3; ++i) {
        ck_assert(jobs[i].hash == alone);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

/* One bad number in the last band. */
START_TEST(no_band_hides_what_is_not_finite)
{
    weft_cloth *cloth = flag(SIDE, SIDE);
    const size_t n = weft_cloth_particles(cloth);
    double *y = malloc(12 * n * sizeof *y);
    ck_assert_ptr_nonnull(y);
    weft_cloth_start(cloth, y);
    weft__forces forces = weft__forces_create(cloth, 3, NULL);
    ck_assert_int_eq(weft__forces_rhs(&forces, 0.0, y, y + 6 * n), 0);
    for (size_t row = 0; row < SIDE; row += SIDE / 2 - 1) {
        const size_t i = row * SIDE + 7;
        y[i] = (double)NAN;
        ck_assert_int_eq(weft__forces_rhs(&forces, 0.0, y, y + 6 * n), 1);
        y[i] = 0.0;
    }
    weft__forces_destroy(&forces);
    free(y);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(bands_on_one_thread_have_the_bits_of_the_whole)
{
    weft_cloth *cloth
        = moving_grid(1100, 240, _i == 0 ? GRID_FULL : GRID_FULL + GRID_RIGID);
    const size_t dim = weft_cloth_dim(cloth);
    double *y = malloc(3 * dim * sizeof *y), *whole = y + dim, *banded = whole + dim;
    ck_assert_ptr_nonnull(y);
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < dim; ++j) {
        y[j] += 1e-3 * sin((double)j);
    }
    weft__forces forces = weft__forces_create(cloth, 1, NULL);
    ck_assert_uint_gt(forces.spans, 1);
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, whole), 0);
    ck_assert_int_eq(weft__forces_rhs(&forces, 0.0, y, banded), 0);
    ck_assert_int_eq(memcmp(whole, banded, dim * sizeof *y), 0);
    y[7] = (double)NAN;
    ck_assert_int_eq(weft__forces_rhs(&forces, 0.0, y, banded), 1);
    weft__forces_destroy(&forces);
    free(y);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(threads)
{
    int steppers = 1;
#ifdef HAVE_GSL
    steppers = 2;
#ifdef HAVE_ARKODE
    steppers = 3;
#endif
#endif
    Suite *suite = suite_create("threads");
    TCase *tcase = tcase_create("threads"), *many = test_long(suite, 120);
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, every_part_of_every_job_is_done_once);
    tcase_add_test(tcase,
                   helpers_take_the_floating_point_mode_of_the_caller_for_every_job);
    tcase_add_test(tcase, threads_are_no_more_than_pay);
    tcase_add_loop_test(many, runs_have_the_same_bits_on_any_threads_and_instructions,
                        0, 2 * steppers);
    tcase_add_loop_test(
        many, a_rounding_mode_set_late_gives_the_same_bits_on_any_threads, 0, steppers);
    if (steppers > 1) {
        tcase_add_test(tcase, ledger_has_the_same_state_on_threads);
    }
    tcase_add_test(tcase,
                   pins_that_change_and_outer_forces_have_the_same_bits_on_threads);
    tcase_add_test(tcase, measures_have_the_same_bits_on_any_threads);
    tcase_add_test(tcase, simulations_in_several_threads_share_a_cloth);
    tcase_add_test(tcase, no_band_hides_what_is_not_finite);
    tcase_add_loop_test(tcase, bands_on_one_thread_have_the_bits_of_the_whole, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
