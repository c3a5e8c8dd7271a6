/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* test_wave.c -- an attempt, or an evaluation, in one pass over the rows has the bits
 * of its stages one after the other, whatever the table, the size, the forces, the
 * threads and the level of instructions. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cloth/model.h"
#include "moving_grid.h"
#include "random.h"
#include "sim/round.h"
#include "sim/simulation.h"

enum { MOST = WEFT__WAVE_STAGES };

/* Numbers in [-1, 1). */
static double some(uint64_t *seed)
{
    return 2.0 * random_uniform(seed) - 1.0;
}

/* An attempt with room for its results, made in one pass and then stage by stage. */
typedef struct attempt {
    weft_attempt of;
    size_t n;
    double a[MOST * MOST], e[MOST], t[MOST];
    double *y, *z, *k[MOST], *end, *rates;
} attempt;

static double *numbers(size_t n)
{
    double *to = malloc((n > 0 ? n : 1) * sizeof *to);
    ck_assert_ptr_nonnull(to);
    memset(to, 0xff, n * sizeof *to);
    return to;
}

static void begin(attempt *self, const weft__forces *forces, int stages, uint64_t *seed)
{
    const size_t n = self->n = weft_cloth_dim(forces->cloth);
    const double h = 1e-4;
    self->y = numbers(n), self->z = numbers(n);
    self->end = numbers(n), self->rates = numbers(n);
    for (int i = 0; i < stages; ++i) {
        self->k[i] = numbers(n);
        self->t[i] = 0.003 + h * some(seed);
        self->e[i] = i % 3 == 1 ? 0.0 : h * some(seed);
        for (int j = 0; j < i; ++j) {
            const bool none = j + 1 < i && some(seed) < -0.5;
            self->a[i * (i - 1) / 2 + j] = none ? 0.0 : h * some(seed);
        }
    }
    weft_cloth_start(forces->cloth, self->y);
    for (size_t i = 0; i < n; ++i) {
        self->y[i] += 1e-4 * some(seed);
    }
    ck_assert_int_eq(weft__forces_rhs(forces, self->t[0], self->y, self->k[0]), 0);
    self->of = (weft_attempt){ .struct_size = sizeof self->of,
                               .stages = stages,
                               .a = self->a,
                               .e = self->e,
                               .t = self->t,
                               .y = self->y,
                               .k = self->k[0],
                               .y_end = self->end,
                               .k_end = self->rates,
                               .atol = { 1e-6, 1e-5 } };
}

static void end(attempt *self)
{
    for (int i = 0; i < self->of.stages; ++i) {
        free(self->k[i]);
    }
    free(self->y);
    free(self->z);
    free(self->end);
    free(self->rates);
}

static double sum_of(const attempt *self, const double *factors, int count,
                     const double *y, size_t j)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum = factors[i] == 0.0 ? sum : sum + factors[i] * self->k[i][j];
    }
    return y != NULL ? sum + y[j] : sum;
}

/* Stage by stage, into z, k and *norm. Returns what the evaluations did. */
static int make_stages(attempt *self, const weft__forces *forces, double *norm)
{
    const int stages = self->of.stages;
    int failed = 0;
    *norm = 0.0;
    for (int i = 1; i < stages; ++i) {
        for (size_t j = 0; j < self->n; ++j) {
            self->z[j] = sum_of(self, self->a + i * (i - 1) / 2, i, self->y, j);
        }
        failed |= weft__forces_rhs(forces, self->t[i], self->z, self->k[i]);
    }
    for (size_t j = 0; self->of.e != NULL && j < self->n; ++j) {
        const double weight
            = 1.0
              / (self->of.rtol * fabs(self->y[j]) + self->of.atol[j >= self->n / 2]);
        *norm = fmax(*norm, fabs(sum_of(self, self->e, stages, NULL, j) * weight));
    }
    return failed;
}

static void compare(attempt *self, const weft__forces *forces, weft__wave *wave)
{
    double norm;
    ck_assert_int_eq(make_stages(self, forces, &norm), 0);
    ck_assert_int_eq(weft__wave_run(wave, forces, &self->of), 0);
    ck_assert_mem_eq(self->end, self->z, self->n * sizeof *self->z);
    ck_assert(self->of.norm == norm);
    double most[2] = { 0.0, 0.0 };
    for (size_t j = 0; j < self->n; ++j) {
        most[j >= self->n / 2] = fmax(most[j >= self->n / 2], fabs(self->z[j]));
    }
    ck_assert(most[0] == self->of.most[0] && most[1] == self->of.most[1]);
    if (self->of.k_end != NULL) {
        ck_assert_mem_eq(self->rates, self->k[self->of.stages - 1],
                         self->n * sizeof *self->z);
    }
}

/* Some attempts by tables of 2 to `most` stages, in one wave. */
static void try_attempts(const weft_cloth *cloth, size_t threads, int most,
                         uint64_t *seed)
{
    weft__forces forces = weft__forces_create(cloth, threads, NULL);
    weft__wave *wave = weft__wave_create(&forces, (size_t)most, NULL);
    ck_assert_ptr_nonnull(wave);
    for (int stages = 2 + (int)(*seed % 2); stages <= most;
         stages += stages < 8 ? 2 : 5) {
        attempt it = { .n = 0 };
        begin(&it, &forces, stages, seed);
        it.of.rtol = stages % 2 == 0 ? 0.0 : 1e-3;
        compare(&it, &forces, wave);
        it.of.k_end = stages % 3 == 0 ? NULL : it.of.k_end;
        it.of.e = stages % 3 == 1 ? NULL : it.of.e;
        it.e[stages - 1] = it.of.k_end == NULL ? 0.0 : it.e[stages - 1];
        compare(&it, &forces, wave);
        end(&it);
    }
    weft__wave_destroy(wave);
    weft__forces_destroy(&forces);
}

static const size_t shapes[][2]
    = { { 2, 5 },   { 3, 3 },   { 1, 200 }, { 200, 1 }, { 40, 7 },
        { 8, 300 }, { 17, 33 }, { 64, 64 }, { 95, 20 }, { 31, 299 } };

START_TEST(one_pass_has_the_bits_of_stage_after_stage)
{
    const size_t *of = shapes[_i];
    uint64_t seed = 7 + (uint64_t)_i;
    for (unsigned with = 0; with < 128; with += with % 3 == 0 ? 11 : 9) {
        weft_cloth *cloth = moving_grid(of[0], of[1], with % 4 == 3 ? with - 1 : with);
        weft__cloth_choose(cloth, (weft__isa)(with % (1u + weft__isa_last())));
        try_attempts(cloth, 1, with % 5 == 0 ? MOST : 7, &seed);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

START_TEST(bands_of_threads_have_the_bits_of_one)
{
    uint64_t seed = 99 + (uint64_t)_i;
    weft_cloth *cloth = moving_grid(400, 30 + 7 * (size_t)_i,
                                    _i % 2 == 0 ? GRID_FULL : GRID_FULL + GRID_RIGID);
    for (size_t threads = 1; threads <= 4; ++threads) {
        try_attempts(cloth, threads, 7, &seed);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(what_is_not_finite_is_left_to_the_stages)
{
    uint64_t seed = 5;
    weft_cloth *cloth = moving_grid(70, 50, 2);
    weft__forces forces = weft__forces_create(cloth, 1, NULL);
    weft__wave *wave = weft__wave_create(&forces, 5, NULL);
    for (size_t at = 0; at < 4; ++at) {
        attempt it = { .n = 0 };
        begin(&it, &forces, 5, &seed);
        compare(&it, &forces, wave);
        double *bad = at % 2 == 0 ? &it.y[at * 3000 + 77] : &it.k[0][at * 5000 + 3];
        const double was = *bad;
        *bad = at < 2 ? (double)NAN : 1e308 * 10.0;
        ck_assert_int_gt(weft__wave_run(wave, &forces, &it.of), 0);
        *bad = was;
        compare(&it, &forces, wave);
        end(&it);
    }
    weft__wave_destroy(wave);
    weft__forces_destroy(&forces);
    weft_cloth_destroy(cloth);
}
END_TEST

/* An evaluation amid arithmetic: y is made of `from`, and changes where rates are
 * known.
 */
typedef struct amid {
    size_t half;
    double *from, *y, *f;
} amid;

static size_t make_some(void *ctx, size_t first, size_t end)
{
    const amid *self = ctx;
    for (size_t i = first; i < end; ++i) {
        self->y[i] = self->from[i] + 1e-3 * self->from[self->half + i];
        self->y[self->half + i] = 0.5 * self->from[self->half + i];
    }
    return 0;
}

static size_t use_some(void *ctx, size_t first, size_t end)
{
    const amid *self = ctx;
    for (size_t i = first; i < end; ++i) {
        self->y[i] += 1e3 * self->f[i];
        self->y[self->half + i] -= 1e3 * self->f[self->half + i];
    }
    return end - first;
}

static weft_round round_of(amid *self)
{
    return (weft_round){ .struct_size = sizeof(weft_round),
                         .t = 0.003,
                         .y = self->y,
                         .f = self->f,
                         .ctx = self,
                         .before = make_some,
                         .after = use_some };
}

static void compare_rounds(const weft_cloth *cloth, size_t threads)
{
    weft__forces forces = weft__forces_create(cloth, threads, NULL);
    const size_t n = weft_cloth_dim(cloth);
    double *from = numbers(n);
    amid whole = { n / 2, from, numbers(n), numbers(n) };
    amid parts = { n / 2, from, numbers(n), numbers(n) };
    weft_round round = round_of(&parts);
    uint64_t seed = 3;
    weft_cloth_start(cloth, from);
    for (size_t i = 0; i < n; ++i) {
        from[i] += 1e-4 * some(&seed);
    }
    make_some(&whole, 0, n / 2);
    ck_assert_int_eq(weft__forces_rhs(&forces, 0.003, whole.y, whole.f), 0);
    use_some(&whole, 0, n / 2);
    ck_assert_int_eq(weft__round_run(&forces, &round), 0);
    ck_assert_uint_eq(round.sum, n / 2);
    ck_assert_mem_eq(parts.f, whole.f, n * sizeof *from);
    ck_assert_mem_eq(parts.y, whole.y, n * sizeof *from);
    round.f = NULL; /* no evaluation */
    make_some(&whole, 0, n / 2);
    ck_assert_int_eq(weft__round_run(&forces, &round), 0);
    ck_assert_mem_eq(parts.y, whole.y, n * sizeof *from);
    free(from);
    free(whole.y), free(whole.f);
    free(parts.y), free(parts.f);
    weft__forces_destroy(&forces);
}

START_TEST(a_round_has_the_bits_of_an_evaluation)
{
    const size_t *of = shapes[_i];
    for (unsigned with = 0; with < 128; with += with % 3 == 0 ? 11 : 9) {
        weft_cloth *cloth = moving_grid(of[0], of[1], with % 4 == 3 ? with - 1 : with);
        compare_rounds(cloth, 1 + with % 2);
        weft_cloth_destroy(cloth);
    }
    for (size_t threads = 1; threads <= 4; ++threads) {
        weft_cloth *cloth = moving_grid(130 + 97 * (size_t)_i, 41, GRID_FULL);
        compare_rounds(cloth, threads);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

START_TEST(rates_that_are_not_finite_fail_the_round)
{
    weft_cloth *cloth = moving_grid(300, 40, 2);
    weft__forces forces = weft__forces_create(cloth, 2, NULL);
    const size_t n = weft_cloth_dim(cloth);
    for (size_t at = 0; at < n; at += n / 7) {
        amid parts = { n / 2, numbers(n), numbers(n), numbers(n) };
        weft_round round = round_of(&parts);
        weft_cloth_start(cloth, parts.from);
        parts.from[at] = (double)NAN;
        ck_assert_int_gt(weft__round_run(&forces, &round), 0);
        free(parts.from), free(parts.y), free(parts.f);
    }
    weft__forces_destroy(&forces);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- in a simulation ------------------------------------------------------------- */

enum { SIDE = 142 }; /* from which a simulation offers a pass, verlet on two threads */

/* Two simulations of one cloth: by the pass and by stages. */
typedef struct twins {
    weft_sim *of[2];
    int asked[2], stop_at; /* calls of `stop`; 0: never */
} twins;

static int by_which; /* whose step is under way */

static bool ask(void *ctx)
{
    twins *both = ctx;
    return ++both->asked[by_which] == both->stop_at;
}

static weft_sim_def plain_def(const weft_cloth *cloth, const char *method)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = test_method_named(method);
    def.config = test_config(def.method, def.config);
    def.config.rtol = 0.0;
    def.config.atol_position = 1e-6, def.config.atol_velocity = 1e-4;
    if ((def.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        def.config.fixed_step = 1e-4;
        def.config.threads = 2;
    }
    return def;
}

static void create(twins *both, weft_sim_def def)
{
    static const weft_pass none;
    def.stop = ask;
    def.stop_ctx = both;
    for (int i = 0; i < 2; ++i) {
        weft_error err;
        def.config.pass = i == 0 ? NULL : &none;
        ck_assert_msg(weft_sim_create(&def, &both->of[i], &err) == WEFT_OK, "%s",
                      err.message);
        ck_assert((both->of[i]->config.pass != NULL) == (i == 0));
    }
}

static void destroy(twins *both)
{
    weft_sim_destroy(both->of[0]);
    weft_sim_destroy(both->of[1]);
}

static void same(const twins *both, const char *after)
{
    const weft_stepper_stats stats[]
        = { weft_sim_stats(both->of[0]), weft_sim_stats(both->of[1]) };
    ck_assert_msg(weft_sim_time(both->of[0]) == weft_sim_time(both->of[1]), "%s",
                  after);
    ck_assert_msg(
        stats[0].steps == stats[1].steps && stats[0].rejected == stats[1].rejected
            && stats[0].rhs_calls == stats[1].rhs_calls
            && stats[0].last_step == stats[1].last_step
            && stats[0].next_step == stats[1].next_step,
        "%s: %d and %d calls, %d and %d rejected, next %a and %a", after,
        (int)stats[0].rhs_calls, (int)stats[1].rhs_calls, (int)stats[0].rejected,
        (int)stats[1].rejected, stats[0].next_step, stats[1].next_step);
    ck_assert_msg(memcmp(weft_sim_state(both->of[0]), weft_sim_state(both->of[1]),
                         weft_cloth_dim(weft_sim_cloth(both->of[0])) * sizeof(double))
                      == 0,
                  "%s: other states", after);
    ck_assert_int_eq(both->asked[0], both->asked[1]);
}

/* A step of each; returns what both return. */
static weft_status step(twins *both, double t_end, const char *after)
{
    weft_status status[2];
    weft_error err[2] = { { .status = WEFT_OK } };
    for (by_which = 0; by_which < 2; ++by_which) {
        status[by_which] = weft_sim_step(both->of[by_which], t_end, &err[by_which]);
    }
    ck_assert_msg(status[0] == status[1], "%s: %s; %s", after, err[0].message,
                  err[1].message);
    ck_assert_str_eq(err[0].message, err[1].message);
    same(both, after);
    return status[0];
}

static const char *const methods[]
    = { "arkode/dormand_prince",  "arkode/bogacki_shampine", "arkode/cash_karp",
        "arkode/fehlberg87",      "arkode/heun_euler",       "arkode/rk4",
        "arkode/custom",          "arkode/verner65",         "verlet/velocity_verlet",
        "verlet/symplectic_euler" };

START_TEST(steps_in_one_pass_are_those_of_stages)
{
    weft_cloth *cloth = moving_grid(SIDE, SIDE, GRID_FULL);
    weft_sim_def def = plain_def(cloth, methods[_i]);
    const bool adapts = def.config.fixed_step == 0.0;
    for (int fixed = adapts ? 0 : 1; fixed < 2; ++fixed) {
        twins both = { .stop_at = 0 };
        def.config.fixed_step = fixed ? 1e-4 : 0.0;
        def.config.first_step = 5e-3; /* too long: rejections */
        def.config.threads = _i % 4 == 1 ? 2 : _i == 8 ? 3 : 1;
        create(&both, def);
        for (int i = 1; i <= 8; ++i) {
            ck_assert_int_eq(step(&both, i < 5 ? 4e-4 : 1.0, methods[_i]), WEFT_OK);
        }
        ck_assert(fixed || weft_sim_stats(both.of[0]).rejected > 0);
        destroy(&both);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

static const char *const takers[]
    = { "arkode/dormand_prince", "verlet/velocity_verlet", "verlet/symplectic_euler" };
enum { TAKERS = sizeof takers / sizeof takers[0] };

/* Pins, wind and the state change between steps. */
START_TEST(changes_between_steps_reach_the_pass)
{
    const double slow[3] = { 0.0, 0.0, 0.5 }, gust[3] = { 1.0, 0.0, -2.0 };
    weft_cloth *cloth = moving_grid(SIDE, SIDE + 1, GRID_FULL);
    twins both = { .stop_at = 0 };
    create(&both, plain_def(cloth, takers[_i]));
    for (size_t i = 0; i < 6; ++i) {
        ck_assert_int_eq(step(&both, 1.0, "a change"), WEFT_OK);
        for (int k = 0; k < 2; ++k) {
            ck_assert_int_eq(
                weft_sim_pin(both.of[k], SIDE * (20 * i + 9) + 5, slow, NULL), WEFT_OK);
            ck_assert_int_eq(weft_sim_unpin(both.of[k], (SIDE + 1) * 20 * i, NULL),
                             WEFT_OK);
            ck_assert(i != 3
                      || weft_sim_set_wind(both.of[k], gust, 0.8, NULL) == WEFT_OK);
        }
    }
    destroy(&both);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_stop_ends_the_step_in_the_same_call)
{
    weft_cloth *cloth = moving_grid(SIDE, SIDE, 1);
    for (int fixed = 0; fixed < 2; ++fixed) {
        for (int at = 1; at<(_i > 0 ? 5 : 20); at += _i> 0 ? 1 : 6) {
            twins both = { .stop_at = at };
            weft_sim_def def = plain_def(cloth, takers[_i]);
            def.config.fixed_step = fixed || _i > 0 ? 1e-4 : 0.0;
            create(&both, def);
            weft_status status = WEFT_OK;
            for (int i = 0; i < 5; ++i) {
                const weft_status now = step(&both, 1.0, "a stop");
                status = status == WEFT_OK ? now : status;
            }
            ck_assert_int_eq(status, WEFT_STOPPED);
            destroy(&both);
        }
    }
    weft_cloth_destroy(cloth);
}
END_TEST

/* Steps that are far too long: states that are not finite, or not accurate enough. */
START_TEST(failures_are_those_of_stages)
{
    static const struct {
        const char *method;
        double fixed, first, least;
    } of[] = { { "arkode/dormand_prince", 10.0, 0.1, 1e-9 },
               { "arkode/rk4", 0.5, 0.1, 1e-9 },
               { "arkode/dormand_prince", 0.0, 1e300, 1e-9 },
               { "arkode/cash_karp", 0.0, 1e150, 1e-9 },
               { "arkode/dormand_prince", 0.0, 0.5, 0.4 },
               { "arkode/cash_karp", 0.0, 1e160, 1e150 },
               { "verlet/velocity_verlet", 1.0, 0.1, 1e-9 },
               { "verlet/velocity_verlet", 1e160, 0.1, 1e-9 },
               { "verlet/symplectic_euler", 1.0, 0.1, 1e-9 },
               { "verlet/symplectic_euler", 1e160, 0.1, 1e-9 } };
    weft_cloth *cloth = moving_grid(SIDE, SIDE, 2);
    twins both = { .stop_at = 0 };
    weft_sim_def def = plain_def(cloth, of[_i].method);
    def.config.fixed_step = of[_i].fixed;
    def.config.first_step = of[_i].first;
    def.config.min_step = of[_i].least;
    create(&both, def);
    for (int i = 0; i < 12; ++i) {
        (void)step(&both, 1e305, of[_i].method);
    }
    destroy(&both);
    weft_cloth_destroy(cloth);
}
END_TEST

static int pull(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)t, (void)y;
    f[0] += 1.0;
    return 0;
}

/* What needs the whole state in an evaluation has no pass. */
START_TEST(no_pass_where_it_would_change_something)
{
    weft_cloth *cloth = moving_grid(SIDE, SIDE, 1),
               *small = moving_grid(SIDE - 2, SIDE, 1);
    for (int i = 0; i < 6; ++i) {
        weft_sim_def def = plain_def(i == 0 ? small : cloth, "arkode/dormand_prince");
        def.force = i == 1 ? pull : NULL;
        def.ledger = i == 2;
        def.config.norm = i == 3 ? WEFT_NORM_RMS : WEFT_NORM_MAX;
        def.method = i == 4 ? test_method_named("gsl/rkf45") : def.method;
        weft_sim *sim = NULL;
        ck_assert_int_eq(weft_sim_create(&def, &sim, NULL), WEFT_OK);
        ck_assert((sim->config.pass != NULL) == (i == 5));
        weft_sim_destroy(sim);
    }
    weft_cloth_destroy(small);
    weft_cloth_destroy(cloth);
}
END_TEST

#if defined __linux__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
static double resident(void) /* [bytes] */
{
    long pages = 0;
    FILE *from = fopen("/proc/self/statm", "r");
    ck_assert(from != NULL && fscanf(from, "%*d %ld", &pages) == 1);
    (void)fclose(from);
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

static const struct {
    const char *method;
    double fixed_step;
    bool by_stages;
} kept[] = { { "arkode/dormand_prince", 0.0, false },
             { "arkode/dormand_prince", 0.0, true },
             { "arkode/dormand_prince", 1e-5, true },
             { "arkode/cash_karp", 0.0, false },
             { "arkode/bogacki_shampine", 0.0, true },
             { "verlet/velocity_verlet", 1e-5, false },
             { "verlet/symplectic_euler", 1e-5, false },
             { "gsl/rkf45", 0.0, false },
             { "gsl/rk2", 1e-5, false },
             { "gsl/rk8pd", 0.0, false } };

START_TEST(a_run_takes_the_memory_that_stats_say)
{
    static const weft_pass none;
    weft_cloth *cloth = moving_grid(400, 400, 1);
    weft_sim_def def = plain_def(cloth, kept[_i].method);
    def.config.fixed_step = kept[_i].fixed_step;
    def.config.pass = kept[_i].by_stages ? &none : NULL;
    const double before = resident();
    weft_sim *sim = test_sim(cloth, def.method, &def.config);
    for (int i = 0; i < 4; ++i) {
        ck_assert_int_eq(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
    }
    const double took = resident() - before, said = (double)weft_sim_stats(sim).bytes;
    ck_assert_msg(fabs(took / said - 1.0) < 0.1, "%s: %.0f bytes instead of %.0f",
                  kept[_i].method, took, said);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST
#endif

TEST_SUITE(wave)
{
    Suite *suite = suite_create("wave");
    TCase *tests = tcase_create("wave"), *threads = tcase_create("threads"),
          *slow = test_long(suite, 120.0);
    const int count = (int)(sizeof shapes / sizeof shapes[0]);
    const int ways = (int)(sizeof methods / sizeof methods[0]);
    tcase_set_timeout(tests, 120.0);
    tcase_set_timeout(threads, 120.0);
    tcase_add_loop_test(tests, one_pass_has_the_bits_of_stage_after_stage, 0, 5);
    tcase_add_loop_test(slow, one_pass_has_the_bits_of_stage_after_stage, 5, count);
    tcase_add_loop_test(threads, bands_of_threads_have_the_bits_of_one, 0, 1);
    tcase_add_loop_test(slow, bands_of_threads_have_the_bits_of_one, 1, 3);
    tcase_add_test(tests, what_is_not_finite_is_left_to_the_stages);
    tcase_add_loop_test(threads, a_round_has_the_bits_of_an_evaluation, 0, 2);
    tcase_add_loop_test(slow, a_round_has_the_bits_of_an_evaluation, 2, count);
    tcase_add_test(threads, rates_that_are_not_finite_fail_the_round);
    tcase_add_loop_test(tests, steps_in_one_pass_are_those_of_stages, 0, 1);
    tcase_add_loop_test(slow, steps_in_one_pass_are_those_of_stages, 1, ways - 2);
    tcase_add_loop_test(tests, steps_in_one_pass_are_those_of_stages, ways - 2, ways);
    tcase_add_loop_test(tests, changes_between_steps_reach_the_pass, 0, TAKERS);
    tcase_add_loop_test(slow, a_stop_ends_the_step_in_the_same_call, 0, TAKERS);
    tcase_add_loop_test(slow, failures_are_those_of_stages, 0, 10);
    tcase_add_test(tests, no_pass_where_it_would_change_something);
#if defined __linux__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
    tcase_add_loop_test(tests, a_run_takes_the_memory_that_stats_say, 0,
                        (int)(sizeof kept / sizeof kept[0]));
#endif
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, threads);
    return suite;
}
