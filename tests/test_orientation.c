/* SPDX-License-Identifier: BSD-3-Clause */
/* Orientations and meetings of segments and triangles, against exact integers. */
#include "random.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth/orientation.h"

__extension__ typedef __int128 wide;

/* ---- orientations ---------------------------------------------------------------- */

static int sign_of(wide x)
{
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/* Of whole numbers below 2^40. */
static int whole_orientation(int64_t x[4][3])
{
    wide m[3][3];
    for (size_t i = 0; i < 9; ++i) {
        m[i / 3][i % 3] = x[i / 3][i % 3] - x[3][i % 3];
    }
    return sign_of(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                   - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                   + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

static int orientation_of(int64_t x[4][3], double unit)
{
    double at[4][3];
    for (size_t i = 0; i < 12; ++i) {
        at[i / 3][i % 3] = unit * (double)x[i / 3][i % 3];
    }
    return weft__orientation(at[0], at[1], at[2], at[3]);
}

/* Four points of a plane through whole points, one of which is moved by a unit or not:
 * a double cannot see on which side it is. */
static void near_a_plane(uint64_t *state, int64_t x[4][3])
{
    for (size_t k = 0; k < 3; ++k) {
        const int64_t base = random_whole(state, -(1 << 20), 1 << 20) << 17;
        const int64_t u = random_whole(state, -(1 << 18), 1 << 18);
        const int64_t v = random_whole(state, -(1 << 18), 1 << 18);
        for (size_t i = 0; i < 4; ++i) {
            x[i][k] = base;
        }
        x[1][k] += u << 18;
        x[2][k] += v << 18;
        x[3][k] += (u << 17) + (v << 16);
    }
    x[random_whole(state, 0, 3)][random_whole(state, 0, 2)]
        += random_whole(state, -1, 1);
}

START_TEST(orientations_are_those_of_exact_integers)
{
    uint64_t state = 1;
    int seen[3] = { 0 };
    for (int i = 0; i < 100000; ++i) {
        int64_t x[4][3];
        for (size_t k = 0; k < 12; ++k) {
            x[k / 3][k % 3] = random_whole(&state, -3, 3);
        }
        if (i % 2 == 0) {
            near_a_plane(&state, x);
        }
        const int wanted = whole_orientation(x);
        ck_assert_int_eq(orientation_of(x, ldexp(1.0, i % 500 - 250)), wanted);
        ++seen[wanted + 1];
    }
    ck_assert(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 1000);
}
END_TEST

START_TEST(exchanged_points_exchange_the_sign)
{
    uint64_t state = 2;
    for (int i = 0; i < 10000; ++i) {
        int64_t whole[4][3];
        double x[4][3];
        near_a_plane(&state, whole);
        for (size_t k = 0; k < 12; ++k) { /* no integers */
            x[k / 3][k % 3] = (double)whole[k / 3][k % 3] / 3e9;
        }
        const int sign = weft__orientation(x[0], x[1], x[2], x[3]);
        ck_assert_int_eq(weft__orientation(x[1], x[0], x[2], x[3]), -sign);
        ck_assert_int_eq(weft__orientation(x[0], x[3], x[2], x[1]), -sign);
        ck_assert_int_eq(weft__orientation(x[1], x[2], x[0], x[3]), sign);
    }
}
END_TEST

/* ---- meetings -------------------------------------------------------------------- */

/* c[0] t + c[1] u + c[2] v + c[3] >= 0, or > 0 */
typedef struct inequality {
    int64_t c[4];
    bool strict;
} inequality;

enum { MOST = 4000 };

static void reduce(inequality *of)
{
    int64_t divisor = 0;
    for (size_t k = 0; k < 4; ++k) {
        for (int64_t a = llabs(of->c[k]); a != 0;) {
            const int64_t rest = divisor % a;
            divisor = a, a = rest;
        }
    }
    for (size_t k = 0; k < 4 && divisor > 0; ++k) {
        of->c[k] /= divisor;
    }
}

/* Fourier and Motzkin: without unknown k, a solution remains one. */
static size_t eliminate(const inequality *from, size_t count, size_t k, inequality *to)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; ++i) {
        for (size_t j = 0; j < count; ++j) {
            const int64_t a = from[i].c[k], b = -from[j].c[k];
            inequality sum = from[i];
            if (a > 0 && b > 0) {
                for (size_t n = 0; n < 4; ++n) {
                    sum.c[n] = b * from[i].c[n] + a * from[j].c[n];
                }
                sum.strict = from[i].strict || from[j].strict;
                reduce(&sum);
            } else if (a != 0 || i != j) {
                continue;
            }
            ck_assert_uint_lt(kept, MOST);
            to[kept++] = sum;
        }
    }
    return kept;
}

/* Whether p + t (q - p) = a + u (b - a) + v (c - a) has a solution 0 <= t <= 1, u, v
 * and 1 - u - v >= 0, or with `strict` > 0. With `flat`: v = 0. */
static bool feasible(int64_t x[5][3], bool strict, bool flat)
{
    static inequality lists[2][MOST];
    size_t count = 0;
    for (size_t k = 0; k < 6; ++k) {
        const int64_t *p = x[0], *q = x[1], *a = x[2], *b = x[3], *c = x[4];
        const size_t i = k / 2;
        const int64_t s = k % 2 == 0 ? 1 : -1;
        lists[0][count++] = (inequality){ { s * (q[i] - p[i]), -s * (b[i] - a[i]),
                                            -s * (c[i] - a[i]), s * (p[i] - a[i]) },
                                          false };
    }
    lists[0][count++] = (inequality){ { 1, 0, 0, 0 }, strict };
    lists[0][count++] = (inequality){ { -1, 0, 0, 1 }, strict };
    lists[0][count++] = (inequality){ { 0, 1, 0, 0 }, strict };
    lists[0][count++] = (inequality){ { 0, 0, 1, 0 }, strict && !flat };
    lists[0][count++] = (inequality){ { 0, -1, -1, 1 }, strict };
    if (flat) {
        lists[0][count++] = (inequality){ { 0, 0, -1, 0 }, false };
    }
    for (size_t k = 0; k < 3; ++k) {
        count = eliminate(lists[k % 2], count, k, lists[(k + 1) % 2]);
    }
    for (size_t i = 0; i < count; ++i) {
        const int64_t rest = lists[1][i].c[3];
        if (rest < 0 || (lists[1][i].strict && rest == 0)) {
            return false;
        }
    }
    return true;
}

static weft__meeting wanted_meeting(int64_t x[5][3])
{
    int64_t sides[2][4][3];
    for (size_t e = 0; e < 2; ++e) {
        memcpy(sides[e], x[2], 3 * sizeof x[2]);
        memcpy(sides[e][3], x[e], sizeof x[e]);
    }
    const bool across = whole_orientation(sides[0]) * whole_orientation(sides[1]) < 0;
    return !feasible(x, false, false)           ? WEFT__APART
           : across && feasible(x, true, false) ? WEFT__PIERCE
                                                : WEFT__TOUCH;
}

static void on_lattice(uint64_t *state, int size, int64_t x[5][3], double at[5][3])
{
    for (size_t k = 0; k < 15; ++k) {
        x[k / 3][k % 3] = random_whole(state, 0, size);
        at[k / 3][k % 3] = 0x1p-3 * (double)x[k / 3][k % 3];
    }
}

START_TEST(segments_meet_triangles_as_inequalities_say)
{
    uint64_t state = 3;
    int seen[3] = { 0 };
    for (int i = 0; i < test_rounds(3000, 100000); ++i) {
        int64_t x[5][3];
        double at[5][3];
        on_lattice(&state, 1 + i % 4, x, at);
        const weft__meeting wanted = wanted_meeting(x);
        ck_assert_int_eq(weft__segment_triangle(at[0], at[1], at[2], at[3], at[4]),
                         wanted);
        ck_assert_int_eq(weft__segment_triangle(at[1], at[0], at[4], at[2], at[3]),
                         wanted);
        ++seen[wanted];
    }
    ck_assert(seen[0] > 500 && seen[1] > 500 && seen[2] > 30);
}
END_TEST

START_TEST(segments_meet_segments_as_inequalities_say)
{
    uint64_t state = 4;
    int seen[2] = { 0 };
    for (int i = 0; i < test_rounds(3000, 100000); ++i) {
        int64_t x[5][3];
        double at[5][3];
        on_lattice(&state, 1 + i % 4, x, at);
        const bool wanted = feasible(x, false, true);
        ck_assert_int_eq(weft__segment_segment(at[0], at[1], at[2], at[3]),
                         wanted ? WEFT__TOUCH : WEFT__APART);
        ++seen[wanted];
    }
    ck_assert(seen[0] > 500 && seen[1] > 100);
}
END_TEST

TEST_SUITE(orientation)
{
    Suite *suite = suite_create("orientation");
    TCase *tcase = tcase_create("orientation");
    tcase_add_test(tcase, orientations_are_those_of_exact_integers);
    tcase_add_test(tcase, exchanged_points_exchange_the_sign);
    tcase_add_test(tcase, segments_meet_triangles_as_inequalities_say);
    tcase_add_test(tcase, segments_meet_segments_as_inequalities_say);
    suite_add_tcase(suite, tcase);
    return suite;
}
