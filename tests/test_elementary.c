/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: computes */
/* weft/elementary.h: values that are known exactly, and the bits of many others. */
#include "random.h"
#include "support.h"
#include "weft/elementary.h"

#include <stdlib.h>

enum { POINTS = 100000 };

/* 2^e m, e from -most to most, 1 <= m < 2 */
static double wide(uint64_t *state, int most)
{
    const int e = (int)(random_uniform(state) * (2.0 * most + 1.0)) - most;
    return ldexp(1.0 + random_uniform(state), e);
}

static void same(double is, double wanted)
{
    ck_assert_msg(memcmp(&is, &wanted, sizeof is) == 0, "%.17g is not %.17g", is,
                  wanted);
}

/* ---- powers -----------------------------------------------------------------------
 */

/* IEEE 754 has the nearest double to x y, x / y and the root of x. */
START_TEST(powers_are_the_nearest_doubles)
{
    uint64_t state = 1;
    for (int i = 0; i < POINTS; ++i) {
        const double x = wide(&state, 500);
        same(weft_pow(x, 1.0), x);
        same(weft_pow(x, -1.0), 1.0 / x);
        same(weft_pow(x, 2.0), x * x);
        same(weft_pow(x, 0.5), sqrt(x));
    }
}
END_TEST

START_TEST(whole_powers_of_whole_numbers_are_exact)
{
    for (int x = 2; x < 40; ++x) {
        double power = 1.0;
        for (int n = 0; power < 0x1p53; ++n, power *= x) {
            same(weft_pow(x, n), power);
        }
    }
}
END_TEST

START_TEST(powers_have_the_limits_of_pow)
{
    const double inf = (double)INFINITY;
    const struct {
        double x, y, power;
    } limits[] = {
        { 0.0, 0.3, 0.0 },
        { 0.0, -0.3, inf },
        { inf, 0.3, inf },
        { inf, -0.3, 0.0 },
        { 2.0, inf, inf },
        { 2.0, -inf, 0.0 },
        { 0.5, inf, 0.0 },
        { 0.5, -inf, inf },
        { 1.0, inf, 1.0 },
        { 1.0, (double)NAN, 1.0 },
        { (double)NAN, 0.0, 1.0 },
        { 2.0, 1023.0, 0x1p1023 },
        { 2.0, 1024.0, inf },
        { 2.0, -1074.0, 0x1p-1074 },
        { 2.0, -1076.0, 0.0 },
        { 2.0, 1e300, inf },
        { 2.0, -1e300, 0.0 },
        { 0x1p-1074, -0.5, 0x1p537 },
        { 1.7976931348623157e308, 1.0, 1.7976931348623157e308 },
    };
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
        same(weft_pow(limits[i].x, limits[i].y), limits[i].power);
    }
    ck_assert_double_nan(weft_pow((double)NAN, 0.3));
    ck_assert_double_nan(weft_pow(0.3, (double)NAN));
    ck_assert_double_nan(weft_pow(-2.0, 0.3));
}
END_TEST

/* ---- sine and cosine of turns -------------------------------------------------------
 */

static void turns(double f, double t, double sine, double cosine)
{
    double s, c;
    weft_sincos_turns(f, t, &s, &c);
    ck_assert_double_eq_tol(s, sine, 0x1p-51);
    ck_assert_double_eq_tol(c, cosine, 0x1p-51);
}

START_TEST(sines_of_regular_polygons_are_roots)
{
    const double third = sqrt(0.75), eighth = sqrt(0.5),
                 fifth = 0.25 * (sqrt(5.0) - 1.0);
    turns(0.25, 1.0 / 3.0, 0.5, third);
    turns(0.5, 1.0 / 3.0, third, 0.5);
    turns(1.0, 1.0 / 3.0, third, -0.5);
    turns(1.0, 2.0 / 3.0, -third, -0.5);
    turns(0.125, 1.0, eighth, eighth);
    turns(0.125, -3.0, -eighth, -eighth);
    turns(0.2, 1.0, sqrt(1.0 - fifth * fifth), fifth);
}
END_TEST

START_TEST(quarter_turns_are_exact)
{
    static const double sines[5] = { 0.0, 1.0, 0.0, -1.0, 0.0 };
    for (int i = -1000; i < 1000; ++i) {
        double s, c;
        weft_sincos_turns(0.25, i, &s, &c);
        ck_assert_double_eq(s, sines[i & 3]);
        ck_assert_double_eq(c, sines[(i & 3) + 1]);
    }
}
END_TEST

/* All phases have at most 53 bits. */
START_TEST(whole_turns_leave_every_bit_at_any_time)
{
    uint64_t state = 2;
    for (int i = 0; i < POINTS; ++i) {
        const double part = rint(0x1p20 * random_uniform(&state)) * 0x1p-20;
        double s, c, later_s, later_c;
        weft_sincos_turns(1.0, part, &s, &c);
        weft_sincos_turns(1024.0, (part + 0x1p32) / 1024.0, &later_s, &later_c);
        same(later_s, s);
        same(later_c, c);
    }
}
END_TEST

/* (1 + 2^-52) (2^50 + 1) = 2^50 + 1 + 1/4 + 2^-52; in a double only 2^50 + 1.25. */
START_TEST(the_phase_is_exact_beyond_53_bits)
{
    double s, c, wanted_s, wanted_c;
    weft_sincos_turns(1.0 + 0x1p-52, 0x1p50 + 1.0, &s, &c);
    weft_sincos_turns(0.25 + 0x1p-52, 1.0, &wanted_s, &wanted_c);
    same(s, wanted_s);
    same(c, wanted_c);
}
END_TEST

START_TEST(sine_and_cosine_meet_the_addition_theorems)
{
    uint64_t state = 3;
    for (int i = 0; i < POINTS; ++i) {
        const double f = wide(&state, 6), t = wide(&state, 10);
        double s, c, twice_s, twice_c;
        weft_sincos_turns(f, t, &s, &c);
        weft_sincos_turns(2.0 * f, t, &twice_s, &twice_c);
        ck_assert_double_eq_tol(s * s + c * c, 1.0, 0x1p-51);
        ck_assert_double_eq_tol(twice_s, 2.0 * s * c, 0x1p-51);
        ck_assert_double_eq_tol(twice_c, (c - s) * (c + s), 0x1p-51);
    }
}
END_TEST

/* A short arc is its sine. */
START_TEST(small_phases_keep_their_relative_accuracy)
{
    uint64_t state = 4;
    for (int i = 0; i < POINTS; ++i) {
        const double f = ldexp(1.0 + random_uniform(&state), -100 - i % 300);
        double s, c;
        weft_sincos_turns(f, 1.0, &s, &c);
        ck_assert_double_eq_tol(s / f, 6.2831853071795862, 0x1p-49);
        same(c, 1.0);
    }
}
END_TEST

START_TEST(no_number_has_no_sine)
{
    const double bad[] = { (double)INFINITY, -(double)INFINITY, (double)NAN };
    for (int i = 0; i < 3; ++i) {
        double s, c;
        weft_sincos_turns(1.0, bad[i], &s, &c);
        ck_assert_double_nan(s);
        ck_assert_double_nan(c);
    }
}
END_TEST

/* ---- bits -------------------------------------------------------------------------
 */

/* Recorded: what one compiler made is what all others make, on every machine. A
 * contraction of a b + c changes them. */
START_TEST(bits_are_those_of_every_other_machine)
{
    double *values = calloc(3 * POINTS, sizeof *values);
    double *sines = values + POINTS, *cosines = sines + POINTS;
    uint64_t state = 5;
    for (int i = 0; i < POINTS; ++i) {
        const double x = wide(&state, 40), y = 2.0 * random_uniform(&state) - 1.0;
        values[i] = weft_pow(x, y);
        weft_sincos_turns(x, y, &sines[i], &cosines[i]);
    }
    const uint64_t powers = test_hash(values, POINTS),
                   turned = test_hash(sines, (size_t)2 * POINTS);
    free(values);
    ck_assert_msg(powers == 0xffc5d929c340c6deu && turned == 0x9ceb80b7eb281b3bu,
                  "0x%016llx 0x%016llx", (unsigned long long)powers,
                  (unsigned long long)turned);
}
END_TEST

TEST_SUITE(elementary)
{
    Suite *suite = suite_create("elementary");
    TCase *tcase = tcase_create("elementary");
    tcase_add_test(tcase, powers_are_the_nearest_doubles);
    tcase_add_test(tcase, whole_powers_of_whole_numbers_are_exact);
    tcase_add_test(tcase, powers_have_the_limits_of_pow);
    tcase_add_test(tcase, sines_of_regular_polygons_are_roots);
    tcase_add_test(tcase, quarter_turns_are_exact);
    tcase_add_test(tcase, whole_turns_leave_every_bit_at_any_time);
    tcase_add_test(tcase, the_phase_is_exact_beyond_53_bits);
    tcase_add_test(tcase, sine_and_cosine_meet_the_addition_theorems);
    tcase_add_test(tcase, small_phases_keep_their_relative_accuracy);
    tcase_add_test(tcase, no_number_has_no_sine);
    tcase_add_test(tcase, bits_are_those_of_every_other_machine);
    suite_add_tcase(suite, tcase);
    return suite;
}
