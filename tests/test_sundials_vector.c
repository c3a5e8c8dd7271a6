/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long computes */
/* test_sundials_vector.c -- the vector of plugins/sundials: each operation against a
 * plain loop at many lengths, and the same bits on any number of threads. */
#include "support.h"

#include <math.h>
#include <string.h>

#ifdef HAVE_ARKODE
#include "../plugins/arkode/arkode_plugin.h"
#include "base/thread_pool.h"

/* Around the sizes of blocks and slices, none, and long enough for threads; 21929 and
 * 22003 are prime. */
static const size_t lengths[]
    = { 0,   1,   2,   3,   5,    7,    8,    9,    31,   63,   64,    65,
        127, 511, 512, 513, 1000, 2047, 2048, 2049, 4099, 9999, 21929, 6 * 30011 };
static const size_t pools[] = { 1, 2, 3, 7 };

enum {
    LENGTHS = sizeof lengths / sizeof lengths[0],
    POOLS = sizeof pools / sizeof pools[0],
    MOST = 19, /* vectors of one combination */
};

/* Numbers in (-1, 1) without a pattern. */
static double some(uint64_t i, uint64_t of)
{
    uint64_t x = (i + 1) * UINT64_C(0x9e3779b97f4a7c15) ^ (of + 1) << 32;
    x = (x ^ x >> 31) * UINT64_C(0xbf58476d1ce4e5b9);
    return (double)(int64_t)(x ^ x >> 29) * 0x1p-63;
}

typedef struct setting {
    SUNContext context;
    weft__pool *pool;
    weft_team lent;
    N_Vector v[MOST + 1];
    size_t n;
} setting;

static void begin(setting *s, size_t n, size_t threads)
{
    *s = (setting){ .pool = weft__pool_create(threads, NULL), .n = n };
    s->lent = (weft_team){ s->pool, weft__pool_run };
    ck_assert((s->pool != NULL) == (threads > 1));
    ck_assert_int_eq(SUNContext_Create(NO_COMM, &s->context), 0);
    s->v[0] = weft__sun_vector(n, s->pool == NULL ? NULL : &s->lent, s->context);
    for (uint64_t k = 0; k <= MOST; ++k) {
        s->v[k] = k == 0 ? s->v[0] : N_VClone(s->v[0]);
        ck_assert_ptr_nonnull(s->v[k]);
        double *x = weft__sun_fill(s->v[k]);
        ck_assert_uint_eq((uintptr_t)x % 64, 0);
        ck_assert_uint_eq((size_t)NV_LENGTH_S(s->v[k]), n);
        size_t set = 0;
        for (size_t i = 0; i < n; ++i) {
            set += x[i] != 0.0;
            x[i] = some(i, k);
        }
        ck_assert_uint_eq(set, 0);
    }
}

static void end(setting *s)
{
    for (int k = MOST; k >= 0; --k) {
        N_VDestroy(s->v[k]);
    }
    weft__pool_destroy(s->pool);
    (void)SUNContext_Free(&s->context);
}

static double plain_sum(const setting *s, int count, const double *c, size_t i)
{
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
        if (c[k] != 0.0) {
            sum += c[k] * NV_DATA_S(s->v[k])[i];
        }
    }
    return sum;
}

/* For every length and pool. */
#define EVERYWHERE                                                                     \
    for (int l = 0; l < LENGTHS; ++l)                                                  \
        for (int p = 0; p < POOLS; ++p)

START_TEST(combinations_are_sums_from_left_to_right)
{
    EVERYWHERE
    {
        setting s;
        begin(&s, lengths[l], pools[p]);
        for (int count = 1; count < MOST; ++count) {
            sunrealtype c[MOST];
            for (int k = 0; k < count; ++k) {
                c[k] = k % 4 == 2 ? 0.0 : some((uint64_t)k, 99);
            }
            ck_assert_int_eq(N_VLinearCombination(count, c, s.v, s.v[MOST]), 0);
            size_t wrong = 0; /* Check's asserts are slow */
            for (size_t i = 0; i < s.n; ++i) {
                wrong += NV_DATA_S(s.v[MOST])[i] != plain_sum(&s, count, c, i);
            }
            ck_assert_uint_eq(wrong, 0);
            ck_assert(weft__sun_finite(s.v[MOST]));
        }
        end(&s);
    }
}
END_TEST

START_TEST(the_result_may_be_one_of_the_vectors)
{
    static const int counts[] = { 1, 2, 5, 8, 9, 15, 18 };
    EVERYWHERE
    {
        setting s;
        begin(&s, lengths[l], pools[p]);
        for (size_t m = 0; m < sizeof counts / sizeof counts[0]; ++m) {
            const int count = counts[m], target = count / 2;
            sunrealtype c[MOST];
            for (int k = 0; k < count; ++k) {
                c[k] = some((uint64_t)k, 99);
            }
            N_Vector other = s.v[MOST];
            ck_assert_int_eq(N_VLinearCombination(count, c, s.v, other), 0);
            ck_assert_int_eq(N_VLinearCombination(count, c, s.v, s.v[target]), 0);
            ck_assert_int_eq(
                memcmp(NV_DATA_S(s.v[target]), NV_DATA_S(other), s.n * sizeof(double)),
                0);
        }
        end(&s);
    }
}
END_TEST

START_TEST(what_has_no_weight_is_not_looked_at)
{
    setting s;
    begin(&s, 21929, 2);
    N_VConst((double)NAN, s.v[1]);
    ck_assert(!weft__sun_finite(s.v[1]));
    sunrealtype c[] = { 2.0, 0.0, 1.0 }, none[] = { 0.0, 0.0 };
    ck_assert_int_eq(N_VLinearCombination(3, c, s.v, s.v[3]), 0);
    ck_assert(weft__sun_finite(s.v[3]) && weft__sun_finite(s.v[3]));
    ck_assert_int_eq(N_VLinearCombination(2, none, s.v, s.v[3]), 0);
    ck_assert(NV_DATA_S(s.v[3])[0] == 0.0 && NV_DATA_S(s.v[3])[s.n - 1] == 0.0);
    end(&s);
}
END_TEST

START_TEST(the_simple_operations_are_plain_loops)
{
    EVERYWHERE
    {
        setting s;
        begin(&s, lengths[l], pools[p]);
        const double *x = NV_DATA_S(s.v[0]), *y = NV_DATA_S(s.v[1]);
        const double *a = NV_DATA_S(s.v[2]), *b = NV_DATA_S(s.v[3]);
        N_VScale(-0.7, s.v[0], s.v[2]);
        N_VLinearSum(0.3, s.v[0], -1.9, s.v[1], s.v[3]);
        weft__sun_write(s.v[6], x);
        weft__sun_read(s.v[1], weft__sun_fill(s.v[7]));
        N_VConst(1.5, s.v[5]);
        size_t wrong = 0;
        for (size_t i = 0; i < s.n; ++i) {
            wrong += a[i] != -0.7 * x[i];
            wrong += b[i] != 0.3 * x[i] + -1.9 * y[i];
            wrong += NV_DATA_S(s.v[5])[i] != 1.5;
            wrong += NV_DATA_S(s.v[6])[i] != x[i];
            wrong += NV_DATA_S(s.v[7])[i] != y[i];
        }
        ck_assert_uint_eq(wrong, 0);
        end(&s);
    }
}
END_TEST

START_TEST(norms_are_those_of_a_plain_loop)
{
    EVERYWHERE
    {
        setting s;
        begin(&s, lengths[l], pools[p]);
        double most = 0.0, sum = 0.0;
        for (size_t i = 0; i < s.n; ++i) {
            const double e = NV_DATA_S(s.v[0])[i] * NV_DATA_S(s.v[1])[i];
            most = fmax(most, fabs(e));
            sum += e * e;
        }
        ck_assert(N_VWrmsNorm(s.v[0], s.v[1]) == 0.0); /* nothing is judged */
        weft__sun_judge_by(s.v[0], WEFT_NORM_MAX, s.n);
        ck_assert(N_VWrmsNorm(s.v[0], s.v[1]) == most);
        weft__sun_judge_by(s.v[0], WEFT_NORM_RMS, s.n);
        const double rms = N_VWrmsNorm(s.v[0], s.v[1]);
        if (s.n > 0) {
            ck_assert_double_eq_tol(rms, sqrt(sum / (double)s.n), 1e-13 * rms);
        }
        end(&s);
    }
}
END_TEST

START_TEST(one_bad_number_anywhere_is_seen)
{
    static const double bad[] = { (double)NAN, (double)-NAN, (double)INFINITY };
    EVERYWHERE
    {
        setting s;
        begin(&s, lengths[l], pools[p]);
        for (int kind = 0; kind < 3 && lengths[l] > 0; ++kind) {
            sunrealtype c[MOST];
            const size_t places[] = { 0, s.n / 2, s.n / 2 + s.n / 5, s.n - 1 };
            for (int k = 0; k < MOST; ++k) {
                c[k] = 0.5;
            }
            for (int j = 0; j < 4; ++j) {
                const double kept = NV_DATA_S(s.v[0])[places[j]];
                weft__sun_fill(s.v[0])[places[j]] = bad[kind];
                ck_assert(!weft__sun_finite(s.v[0]));
                for (int count = 1; count < MOST; count += 4) {
                    N_VLinearCombination(count, c, s.v, s.v[MOST]);
                    ck_assert(!weft__sun_finite(s.v[MOST]));
                }
                for (int norm = 0; norm < 2; ++norm) {
                    weft__sun_judge_by(s.v[0], norm ? WEFT_NORM_RMS : WEFT_NORM_MAX,
                                       s.n);
                    const double got = N_VWrmsNorm(s.v[0], s.v[1]);
                    ck_assert(kind == 2 ? isinf(got) : isnan(got));
                }
                weft__sun_fill(s.v[0])[places[j]] = kept;
                ck_assert(weft__sun_finite(s.v[0]));
            }
        }
        end(&s);
    }
}
END_TEST

START_TEST(what_is_not_judged_has_no_say_in_the_norm)
{
    static const double atol[] = { 0.5, 0.25 };
    EVERYWHERE
    {
        const size_t half = lengths[l] > 4 ? (lengths[l] - 4) / 2 : lengths[l] / 2;
        for (int rms = 0; half > 0 && rms < 2; ++rms) {
            setting s;
            begin(&s, lengths[l], pools[p]);
            const double *y = NV_DATA_S(s.v[0]), *e = NV_DATA_S(s.v[1]);
            double most = 0.0, sum = 0.0;
            for (size_t i = 0; i < 2 * half; ++i) {
                const double size
                    = e[i] * (1.0 / (1e-3 * fabs(y[i]) + atol[i < half ? 0 : 1]));
                most = fmax(most, fabs(size));
                sum += size * size;
            }
            weft__sun_judge_by(s.v[1], rms ? WEFT_NORM_RMS : WEFT_NORM_MAX, 2 * half);
            weft__sun_weigh(s.v[0], s.v[2], 1e-3, atol);
            const double norm = N_VWrmsNorm(s.v[1], s.v[2]);
            const double wanted = rms ? sqrt(sum / (2.0 * (double)half)) : most;
            ck_assert(fabs(norm - wanted) <= (rms ? 1e-13 * wanted : 0.0));
            if (2 * half < s.n) {
                weft__sun_fill(s.v[1])[s.n - 1] = (double)NAN;
                ck_assert(isnan(N_VWrmsNorm(s.v[1], s.v[2])));
            }
            end(&s);
        }
    }
}
END_TEST

START_TEST(copies_are_shared_until_one_is_written_to)
{
    setting s;
    begin(&s, 1000, 1);
    const double first = NV_DATA_S(s.v[0])[0];
    N_VScale(1.0, s.v[0], s.v[1]);
    N_VScale(1.0, s.v[1], s.v[2]);
    ck_assert_ptr_eq(NV_DATA_S(s.v[2]), NV_DATA_S(s.v[0]));
    N_VConst(3.0, s.v[0]);
    N_VAddConst(s.v[1], 1.0, s.v[1]);
    ck_assert(NV_DATA_S(s.v[0])[0] == 3.0);
    ck_assert(NV_DATA_S(s.v[1])[0] == first + 1.0);
    ck_assert(NV_DATA_S(s.v[2])[0] == first);
    N_VLinearSum(1.0, s.v[2], 1.0, s.v[0], s.v[2]);
    ck_assert(NV_DATA_S(s.v[2])[0] == first + 3.0);
    end(&s);
}
END_TEST

START_TEST(a_combination_asked_for_again_is_never_stale)
{
    setting s;
    sunrealtype c[] = { 0.5, 2.0 };
    begin(&s, 1000, 1);
    N_Vector z = s.v[MOST];
    for (int round = 0; round < 4; ++round) {
        ck_assert_int_eq(N_VLinearCombination(2, c, s.v, z), 0);
        ck_assert_int_eq(N_VLinearCombination(2, c, s.v, z), 0);
        ck_assert(NV_DATA_S(z)[7]
                  == 0.5 * NV_DATA_S(s.v[0])[7] + c[1] * NV_DATA_S(s.v[1])[7]);
        switch (round) {
        case 0:
            weft__sun_fill(s.v[1])[7] = 5.0;
            break;
        case 1:
            weft__sun_fill(z)[7] = 5.0;
            break;
        case 2:
            c[1] = 3.0;
            break;
        default:
            break;
        }
    }
    end(&s);
}
END_TEST

START_TEST(a_combination_into_one_of_its_terms_is_computed_each_time)
{
    setting s;
    sunrealtype c[] = { 0.5, 2.0 };
    begin(&s, 1000, 1);
    double wanted = NV_DATA_S(s.v[1])[7];
    for (int round = 0; round < 3; ++round) {
        ck_assert_int_eq(N_VLinearCombination(2, c, s.v, s.v[1]), 0);
        wanted = 0.5 * NV_DATA_S(s.v[0])[7] + 2.0 * wanted;
        ck_assert(NV_DATA_S(s.v[1])[7] == wanted);
    }
    end(&s);
}
END_TEST

/* The second term is a new vector each time, likely at the address of the last. */
START_TEST(a_combination_of_a_vector_since_destroyed_is_forgotten)
{
    setting s;
    sunrealtype c[] = { 0.5, 2.0 };
    begin(&s, 1000, 1);
    for (int round = 0; round < 20; ++round) {
        N_Vector both[] = { s.v[0], N_VClone(s.v[0]) };
        if (round % 2 == 0) {
            N_VConst(3.0, both[1]);
        }
        ck_assert_int_eq(N_VLinearCombination(2, c, both, s.v[2]), 0);
        ck_assert(NV_DATA_S(s.v[2])[7]
                  == 0.5 * NV_DATA_S(s.v[0])[7] + (round % 2 == 0 ? 6.0 : 0.0));
        N_VDestroy(both[1]);
    }
    end(&s);
}
END_TEST

/* The greatest and the least numbers are finite. */
START_TEST(extreme_numbers_are_finite)
{
    static const double extremes[]
        = { 0x1.fffffffffffffp1023, -0x1.fffffffffffffp1023, 0x1p-1074, -0.0 };
    setting s;
    begin(&s, 1000, 1);
    for (int j = 0; j < 4; ++j) {
        N_VConst(extremes[j], s.v[0]);
        N_VScale(1.0, s.v[0], s.v[1]);
        ck_assert(weft__sun_finite(s.v[0]) && weft__sun_finite(s.v[1]));
        ck_assert(NV_DATA_S(s.v[1])[999] == extremes[j]);
    }
    end(&s);
}
END_TEST

/* ---- whole steps ----------------------------------------------------------------- */

/* Neighbours pull at each other: components differ, and stiffness makes rejections. */
static int ring(double t, const double *y, double *dydt, void *ctx)
{
    const size_t half = *(const size_t *)ctx / 2;
    for (size_t i = 0; i < half; ++i) {
        const double left = y[(i + half - 1) % half], right = y[(i + 1) % half];
        dydt[i] = y[half + i];
        dydt[half + i] = 400.0 * (left - 2.0 * y[i] + right) - y[i] * y[i] * y[i]
                         - 0.1 * y[half + i] + cos(t + (double)i);
    }
    return 0;
}

typedef struct way {
    const char *method;
    weft_norm norm;
    double fixed_step;
} way;

static const way ways[] = {
    { "arkode/dormand_prince", WEFT_NORM_MAX, 0.0 },
    { "arkode/dormand_prince", WEFT_NORM_RMS, 0.0 },
    { "arkode/fehlberg87", WEFT_NORM_RMS, 0.0 },
    { "arkode/cash_karp", WEFT_NORM_MAX, 0.0 },
    { "arkode/rk4", WEFT_NORM_MAX, 1e-2 },
};

static weft_stepper_stats many_steps(const way *how, size_t threads, size_t dim,
                                     double *y)
{
    const weft_stepper_type *type = test_method_named(how->method);
    weft__pool *pool = weft__pool_create(threads, NULL);
    const weft_team lent = (weft_team){ pool, weft__pool_run };
    const weft_ode ode = { .dim = dim, .rhs = ring, .ctx = &dim };
    const weft_stepper_config config = { .struct_size = sizeof config,
                                         .norm = how->norm,
                                         .rtol = 1e-6,
                                         .atol_position = 1e-6,
                                         .atol_velocity = 1e-5,
                                         .first_step = 0.1,
                                         .min_step = 1e-12,
                                         .max_step = INFINITY,
                                         .fixed_step = how->fixed_step,
                                         .team = pool == NULL ? NULL : &lent };
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    weft_error err = { 0 };
    void *self = NULL;
    double t = 0.0;
    for (size_t i = 0; i < dim; ++i) {
        y[i] = some(i, 7);
    }
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_OK);
    for (int frame = 1; frame <= 5; ++frame) {
        while (t < 0.1 * frame) {
            ck_assert_msg(type->step(self, 0.1 * frame, &t, y, &err) == WEFT_OK, "%s",
                          err.message);
        }
        y[frame] += 1e-3;
        type->state_changed(self);
    }
    type->stats(self, &stats);
    type->destroy(self);
    weft__pool_destroy(pool);
    return stats;
}

START_TEST(threads_do_not_show_in_the_results)
{
    enum { DIM = 6 * 4007 }; /* particles of a prime number */
    static double alone[DIM], shared[DIM];
    const way *how = &ways[_i];
    const weft_stepper_stats one = many_steps(how, 1, DIM, alone);
    ck_assert_uint_ge(one.steps, 15);
    static const size_t threads[] = { 0, 2, 3, 7 };
    for (size_t i = 0; i < sizeof threads / sizeof *threads; ++i) {
        const weft_stepper_stats many = many_steps(how, threads[i], DIM, shared);
        ck_assert_mem_eq(alone, shared, sizeof alone);
        ck_assert_uint_eq(one.steps, many.steps);
        ck_assert_uint_eq(one.rejected, many.rejected);
    }
}
END_TEST

START_TEST(more_threads_than_can_be_had_are_no_error)
{
    enum { DIM = 6 * 4007 };
    static double alone[DIM], shared[DIM];
    (void)many_steps(&ways[4], 1, DIM, alone);
    (void)many_steps(&ways[4], SIZE_MAX, DIM, shared);
    ck_assert_mem_eq(alone, shared, sizeof alone);
}
END_TEST

#endif

TEST_SUITE(sundials_vector)
{
    Suite *suite = suite_create("sundials vector");
#ifdef HAVE_ARKODE
    TCase *tcase = tcase_create("vector");
    tcase_set_timeout(tcase, 240.0);
    tcase_add_test(tcase, combinations_are_sums_from_left_to_right);
    tcase_add_test(tcase, the_result_may_be_one_of_the_vectors);
    tcase_add_test(tcase, what_has_no_weight_is_not_looked_at);
    tcase_add_test(tcase, the_simple_operations_are_plain_loops);
    tcase_add_test(tcase, norms_are_those_of_a_plain_loop);
    tcase_add_test(tcase, one_bad_number_anywhere_is_seen);
    tcase_add_test(tcase, what_is_not_judged_has_no_say_in_the_norm);
    tcase_add_test(tcase, copies_are_shared_until_one_is_written_to);
    tcase_add_test(tcase, a_combination_asked_for_again_is_never_stale);
    tcase_add_test(tcase, a_combination_into_one_of_its_terms_is_computed_each_time);
    tcase_add_test(tcase, a_combination_of_a_vector_since_destroyed_is_forgotten);
    tcase_add_test(tcase, extreme_numbers_are_finite);
    TCase *threads = tcase_create("threads");
    tcase_set_timeout(threads, 240.0);
    tcase_add_loop_test(threads, threads_do_not_show_in_the_results, 0,
                        (int)(sizeof ways / sizeof ways[0]));
    tcase_add_test(threads, more_threads_than_can_be_had_are_no_error);
    suite_add_tcase(suite, tcase);
    suite_add_tcase(suite, threads);
#endif
    return suite;
}
