/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long computes */
/* Orientations, meetings of segments and triangles, and crossings of cloth, against
 * exact integers. */
#include "random.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forces/contact/self/self.h"

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
        const int64_t base = random_whole(state, -(1 << 20), 1 << 20) * (1 << 17);
        const int64_t u = random_whole(state, -(1 << 18), 1 << 18);
        const int64_t v = random_whole(state, -(1 << 18), 1 << 18);
        for (size_t i = 0; i < 4; ++i) {
            x[i][k] = base;
        }
        x[1][k] += u * (1 << 18);
        x[2][k] += v * (1 << 18);
        x[3][k] += u * (1 << 17) + v * (1 << 16);
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

/* Parts of a segment and a triangle, by the numbers of feasible(), that may not be 0.
 */
enum { T = 1, LESS_T = 2, U = 4, V = 8, W = 16, U_OR_V = 32, FLAT = 64 };

/* Whether p + t (q - p) = a + u (b - a) + v (c - a) has a solution with t, 1 - t, u, v
 * and w = 1 - u - v >= 0, or > 0 if `positive` names it. FLAT: with v = 0. */
static bool feasible(int64_t x[5][3], int positive)
{
    static inequality lists[2][MOST];
    const struct {
        int64_t c[4];
        int name;
    } bounds[] = { { { 1, 0, 0, 0 }, T },   { { -1, 0, 0, 1 }, LESS_T },
                   { { 0, 1, 0, 0 }, U },   { { 0, 0, 1, 0 }, V },
                   { { 0, -1, -1, 1 }, W }, { { 0, 1, 1, 0 }, U_OR_V },
                   { { 0, 0, -1, 0 }, 0 } };
    size_t count = 0;
    for (size_t k = 0; k < 6; ++k) {
        const int64_t *p = x[0], *q = x[1], *a = x[2], *b = x[3], *c = x[4];
        const size_t i = k / 2;
        const int64_t s = k % 2 == 0 ? 1 : -1;
        lists[0][count++] = (inequality){ { s * (q[i] - p[i]), -s * (b[i] - a[i]),
                                            -s * (c[i] - a[i]), s * (p[i] - a[i]) },
                                          false };
    }
    for (size_t k = 0; k < ((positive & FLAT) != 0 ? 7 : 6); ++k) {
        inequality *to = &lists[0][count++];
        memcpy(to->c, bounds[k].c, sizeof to->c);
        to->strict = (positive & bounds[k].name) != 0;
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
    return !feasible(x, 0)                                 ? WEFT__APART
           : across && feasible(x, T | LESS_T | U | V | W) ? WEFT__PIERCE
                                                           : WEFT__TOUCH;
}

static void on_lattice(uint64_t *state, int size, int64_t x[5][3], double at[5][3])
{
    for (size_t k = 0; k < 15; ++k) {
        x[k / 3][k % 3] = random_whole(state, 0, size);
        at[k / 3][k % 3] = 0x1p-3 * (double)x[k / 3][k % 3];
    }
}

START_TEST(segments_meet_triangles_and_segments_as_inequalities_say)
{
    uint64_t state = 3;
    int seen[3] = { 0 }, segments[2] = { 0 };
    for (int i = 0; i < test_rounds(20000, 100000); ++i) {
        int64_t x[5][3];
        double at[5][3];
        on_lattice(&state, 1 + i % 4, x, at);
        const weft__meeting wanted = wanted_meeting(x);
        const bool touch = feasible(x, FLAT);
        ck_assert_int_eq(weft__segment_triangle(at[0], at[1], at[2], at[3], at[4]),
                         wanted);
        ck_assert_int_eq(weft__segment_triangle(at[1], at[0], at[4], at[2], at[3]),
                         wanted);
        ck_assert_int_eq(weft__segment_segment(at[0], at[1], at[2], at[3]),
                         touch ? WEFT__TOUCH : WEFT__APART);
        ++seen[wanted], ++segments[touch];
    }
    ck_assert(seen[0] > 3000 && seen[1] > 3000 && seen[2] > 200);
    ck_assert(segments[0] > 3000 && segments[1] > 1000);
}
END_TEST

/* ---- crossings of cloth ---------------------------------------------------------- */

/* Whole coordinates of particles in cells of 1/8. */
typedef struct lattice {
    weft_cloth *cloth;
    size_t rows, cols;
    int64_t x[64][3];
    double y[6 * 64];
} lattice;

static weft_cloth *grid(size_t rows, size_t cols)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows, def.cols = cols;
    def.spacing[0] = 0.125, def.spacing[1] = 0.25;
    return test_cloth(&def);
}

static void put(lattice *of, size_t i, const int64_t x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        of->x[i][k] = x[k];
        of->y[k * of->rows * of->cols + i] = 0.125 * (double)x[k];
    }
}

static lattice random_lattice(uint64_t *state, size_t rows, size_t cols, int size)
{
    lattice of = { .cloth = grid(rows, cols), .rows = rows, .cols = cols };
    for (size_t i = 0; i < rows * cols; ++i) {
        int64_t x[3];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = random_whole(state, 0, size);
        }
        put(&of, i, x);
    }
    return of;
}

typedef struct element {
    size_t count, at[3];
} element;

/* Edges or triangles, from all particles that are near on the grid. */
static size_t elements(const lattice *of, size_t count, element *out)
{
    static const size_t edges[3][4]
        = { { 0, 0, 0, 1 }, { 0, 0, 1, 0 }, { 0, 1, 1, 0 } };
    static const size_t triangles[2][6]
        = { { 0, 0, 0, 1, 1, 0 }, { 0, 1, 1, 0, 1, 1 } };
    size_t found = 0;
    for (size_t i = 0; i < of->rows * of->cols; ++i) {
        for (size_t e = 0; e < 5 - count; ++e) {
            element to = { .count = count };
            bool all = true;
            for (size_t k = 0; k < count; ++k) {
                const size_t *step
                    = count == 2 ? &edges[e][2 * k] : &triangles[e][2 * k];
                const size_t r = i / of->cols + step[0], c = i % of->cols + step[1];
                to.at[k] = r * of->cols + c;
                all = all && r < of->rows && c < of->cols;
            }
            if (all) {
                out[found++] = to;
            }
        }
    }
    return found;
}

static bool meets(const lattice *of, const element *edge, const element *other)
{
    size_t shared = 0, i = 0, j = 0;
    int64_t x[5][3];
    for (size_t k = 0; k < 2 * other->count; ++k) {
        if (edge->at[k % 2] == other->at[k / 2]) {
            ++shared, i = k % 2, j = k / 2;
        }
    }
    for (size_t k = 0; k < 2; ++k) {
        memcpy(x[k], of->x[edge->at[(i + k) % 2]], sizeof x[k]);
    }
    for (size_t k = 0; k < 3; ++k) {
        memcpy(x[2 + k], of->x[other->at[(j + k) % other->count]], sizeof x[k]);
    }
    const int flat = other->count == 2 ? FLAT : 0;
    return shared == 0   ? feasible(x, flat)
           : shared == 1 ? feasible(x, flat | T) || feasible(x, flat | U_OR_V)
                         : false;
}

static size_t counted(const lattice *of)
{
    static element edges[200], others[200];
    const bool chain = of->rows == 1 || of->cols == 1;
    const size_t edge_count = elements(of, 2, edges);
    const size_t other_count = elements(of, chain ? 2 : 3, others);
    size_t count = 0;
    for (size_t i = 0; i < edge_count; ++i) {
        count += memcmp(of->x[edges[i].at[0]], of->x[edges[i].at[1]], sizeof of->x[0])
                 == 0;
        for (size_t j = chain ? i + 1 : 0; j < other_count; ++j) {
            count += meets(of, &edges[i], &others[j]);
        }
    }
    return count;
}

START_TEST(crossings_are_those_of_all_pairs)
{
    static const size_t sizes[][2]
        = { { 2, 2 }, { 3, 4 }, { 1, 12 }, { 9, 1 }, { 2, 7 } };
    uint64_t state = 5;
    size_t without = 0;
    for (int i = 0; i < test_rounds(350, 3000); ++i) {
        const size_t *size = sizes[i % 5];
        lattice of = random_lattice(&state, size[0], size[1], 1 << i % 7);
        const size_t count = weft_cloth_crossings(of.cloth, of.y, NULL);
        ck_assert_uint_eq(count, counted(&of));
        without += count == 0;
        weft_cloth_destroy(of.cloth);
    }
    ck_assert(without > 0 && without < (size_t)test_rounds(300, 2500));
}
END_TEST

/* Both edges of the cell at particle 1 lie in one line, and its third has no length:
 * what is left across the first edge is roundoff, which must not pass for a flat cell.
 */
START_TEST(a_cell_whose_edges_lie_in_a_line_is_not_flat)
{
    static const int64_t x[12][3]
        = { { 0, 1, 2 }, { 0, 2, 0 }, { 0, 1, 1 }, { 2, 2, 1 },
            { 1, 2, 0 }, { 0, 1, 1 }, { 0, 0, 2 }, { 0, 2, 1 },
            { 0, 2, 2 }, { 1, 2, 1 }, { 1, 0, 1 }, { 0, 1, 1 } };
    lattice of = { .cloth = grid(3, 4), .rows = 3, .cols = 4 };
    for (size_t i = 0; i < 12; ++i) {
        put(&of, i, x[i]);
    }
    ck_assert_uint_eq(counted(&of), 92);
    ck_assert_uint_eq(weft_cloth_crossings(of.cloth, of.y, NULL), 92);
    weft_cloth_destroy(of.cloth);
}
END_TEST

/* A 5 x 5 sheet whose last row lies over the first at height `z`, which particle (4, 2)
 * may leave. */
static lattice folded(int64_t z, int64_t middle)
{
    static const int64_t along[5][2]
        = { { 0, 0 }, { 8, 0 }, { 16, 1 }, { 8, 2 }, { 0, 2 } };
    lattice of = { .cloth = grid(5, 5), .rows = 5, .cols = 5 };
    for (size_t i = 0; i < 25; ++i) {
        const int64_t x[3] = { along[i / 5][0] + (i == 22 ? 3 : 0),
                               8 * (int64_t)(i % 5) + (i == 22 ? 1 : 0),
                               i == 22 ? middle : z * along[i / 5][1] };
        put(&of, i, x);
    }
    return of;
}

START_TEST(only_a_fold_that_is_pressed_through_crosses)
{
    weft_primitive pair[2];
    for (int64_t middle = 1; middle >= -1; --middle) {
        lattice of = folded(1, middle);
        const size_t count = weft_cloth_crossings(of.cloth, of.y, pair);
        ck_assert_uint_eq(count, counted(&of));
        ck_assert_int_eq(count > 0, middle < 1);
        ck_assert_uint_eq(pair[0].count, middle < 1 ? 2 : 0);
        ck_assert_uint_eq(pair[1].count, middle < 1 ? 3 : 0);
        const element edge = { 2, { pair[0].particle[0], pair[0].particle[1] } };
        const size_t *at = pair[1].particle;
        const element triangle = { 3, { at[0], at[1], at[2] } };
        ck_assert(middle == 1 || meets(&of, &edge, &triangle));
        weft_cloth_destroy(of.cloth);
    }
}
END_TEST

START_TEST(pinned_parts_may_cross_each_other)
{
    lattice through = folded(1, -1);
    const size_t all = weft_cloth_crossings(through.cloth, through.y, NULL);
    weft_cloth_def def = weft_cloth_def_default();
    const weft_pin pins[] = { { .rows = { 0, 1 }, .cols = { 0, -1 } },
                              { .rows = { 4, 4 }, .cols = { 0, -1 } } };
    def.rows = def.cols = 5;
    def.pins = pins;
    def.pin_count = 2;
    weft_cloth *cloth = test_cloth(&def);
    ck_assert_uint_lt(weft_cloth_crossings(cloth, through.y, NULL), all);
    def.pin_count = 1;
    weft_cloth *loose = test_cloth(&def);
    ck_assert_uint_eq(weft_cloth_crossings(loose, through.y, NULL), all);
    weft_cloth_destroy(cloth);
    weft_cloth_destroy(loose);
    weft_cloth_destroy(through.cloth);
}
END_TEST

/* Turned, so that nothing is in a plane exactly, and rolled up to an angle at its end.
 */
static void roll(size_t rows, size_t cols, double angle, double *y)
{
    const size_t n = rows * cols;
    for (size_t i = 0; i < n; ++i) {
        const double s = (double)(i / cols), c = (double)(i % cols);
        const double per = angle / (double)rows, r = angle > 0.0 ? 1.0 / per : 0.0;
        const double z = angle > 0.0 ? r * (1.0 - cos(per * s)) : 0.0;
        const double x = angle > 0.0 ? r * sin(per * s) : s;
        y[i] = 0.3 * x - 0.7 * c, y[n + i] = 0.3 * c + 0.5 * z,
        y[2 * n + i] = 0.7 * x + 0.1 * z;
    }
}

START_TEST(a_flat_or_curved_sheet_does_not_cross_itself)
{
    static double y[6 * 900];
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = 30;
    weft_cloth *cloth = test_cloth(&def);
    for (int i = 0; i < 12; ++i) {
        roll(30, 30, 0.5 * i, y);
        ck_assert_uint_eq(weft_cloth_crossings(cloth, y, NULL), 0);
    }
    roll(30, 30, 6.5, y); /* more than a turn */
    ck_assert_uint_gt(weft_cloth_crossings(cloth, y, NULL), 0);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- simulations ----------------------------------------------------------------- */

/* Spoils the state in its first call. */
static bool press_through(void *ctx, double t, double h, double *y)
{
    const lattice *to = ctx;
    (void)t, (void)h;
    memcpy(y, to->y, 3 * to->rows * to->cols * sizeof *y);
    return true;
}

static weft_sim *simulation(const weft_cloth *cloth, weft_correct_fn *correct,
                            void *ctx)
{
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    weft_sim *sim = NULL;
    def.cloth = cloth;
    def.method = test_method_named("verlet/velocity_verlet");
    def.config.fixed_step = 1e-5;
    def.correct = correct, def.correct_ctx = ctx;
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    return sim;
}

static weft_cloth *touching_itself(void)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = 5;
    def.contact.self = true;
    return test_cloth(&def);
}

static weft_status set_positions(weft_sim *sim, const lattice *of, weft_error *err)
{
    double xyz[3 * 64];
    const size_t n = of->rows * of->cols;
    for (size_t i = 0; i < 3 * n; ++i) {
        xyz[i] = of->y[i % 3 * n + i / 3];
    }
    return weft_sim_set_state(sim, xyz, NULL, err);
}

START_TEST(no_state_that_crosses_itself_is_set)
{
    weft_error err = { 0 };
    lattice apart = folded(1, 1), through = folded(1, -1);
    weft_cloth *cloth = touching_itself();
    weft_sim *sim = simulation(cloth, NULL, NULL);
    ck_assert_int_eq(set_positions(sim, &apart, &err), WEFT_OK);
    const uint64_t before = test_hash(weft_sim_state(sim), 6 * 25);
    ck_assert_int_eq(set_positions(sim, &through, &err), WEFT_INVALID);
    ck_assert_msg(strncmp(err.message, "edge (0, ", 9) == 0
                      && strstr(err.message, " cell (") != NULL
                      && strstr(err.message, " such pairs") != NULL,
                  "%s", err.message);
    ck_assert_uint_eq(test_hash(weft_sim_state(sim), 6 * 25), before);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_cloth_destroy(apart.cloth);
    weft_cloth_destroy(through.cloth);
}
END_TEST

START_TEST(no_pin_is_moved_or_released_into_the_cloth)
{
    weft_error err = { 0 };
    lattice apart = folded(1, 1), through = folded(1, -1);
    weft_cloth *cloth = touching_itself();
    weft_sim *sim = simulation(cloth, NULL, NULL);
    const size_t n = 25, i = 22;
    const double *y = through.y;
    const double inside[3] = { y[i], y[n + i], y[2 * n + i] };
    ck_assert_int_eq(set_positions(sim, &apart, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_pin(sim, i, NULL, &err), WEFT_OK);
    const uint64_t before = test_hash(weft_sim_state(sim), 6 * n);
    ck_assert_int_eq(weft_sim_move_pin(sim, i, inside, &err), WEFT_INVALID);
    ck_assert(strstr(err.message, " such pairs") != NULL);
    ck_assert_uint_eq(test_hash(weft_sim_state(sim), 6 * n), before);
    for (size_t k = 1; k < n; ++k) {
        ck_assert_int_eq(weft_sim_pin(sim, k, NULL, &err), WEFT_OK);
    }
    ck_assert_int_eq(weft_sim_move_pin(sim, i, inside, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_unpin(sim, i, &err), WEFT_INVALID);
    ck_assert(strstr(err.message, " such pairs") != NULL);
    ck_assert(weft_cloth_pinned(weft_sim_cloth(sim), i));
    ck_assert_int_eq(weft_sim_unpin(sim, 4, &err), WEFT_OK); /* far from there */
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_cloth_destroy(apart.cloth);
    weft_cloth_destroy(through.cloth);
}
END_TEST

START_TEST(a_correction_through_the_cloth_fails)
{
    weft_error err = { 0 };
    lattice through = folded(1, -1);
    weft_cloth *cloth = touching_itself();
    weft_sim *sim = simulation(cloth, press_through, &through);
    ck_assert_int_eq(weft_sim_step(sim, 1e-5, &err), WEFT_INVALID);
    ck_assert_msg(strncmp(err.message, "after the correction edge (0, ", 30) == 0, "%s",
                  err.message);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_cloth_destroy(through.cloth);
}
END_TEST

START_TEST(cloth_that_starts_in_itself_is_refused)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    weft_cloth_def def = weft_cloth_def_default();
    def.origin[0] = def.origin[1] = 1e6;
    def.scale = 1e-12;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_OK);
    weft_cloth_destroy(cloth);
    def.contact.self = true;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strncmp(err.message, "particle (0, 0) touches particle (0, 1); ", 41)
                      == 0,
                  "%s", err.message);
}
END_TEST

TEST_SUITE(crossing)
{
    Suite *suite = suite_create("crossing");
    TCase *exact = tcase_create("exact"), *cloth = tcase_create("cloth");
    tcase_set_timeout(exact, 60);
    tcase_set_timeout(cloth, 60);
    tcase_add_test(exact, orientations_are_those_of_exact_integers);
    tcase_add_test(exact, exchanged_points_exchange_the_sign);
    tcase_add_test(exact, segments_meet_triangles_and_segments_as_inequalities_say);
    tcase_add_test(cloth, crossings_are_those_of_all_pairs);
    tcase_add_test(cloth, a_cell_whose_edges_lie_in_a_line_is_not_flat);
    tcase_add_test(cloth, only_a_fold_that_is_pressed_through_crosses);
    tcase_add_test(cloth, pinned_parts_may_cross_each_other);
    tcase_add_test(cloth, a_flat_or_curved_sheet_does_not_cross_itself);
    tcase_add_test(cloth, no_state_that_crosses_itself_is_set);
    tcase_add_test(cloth, no_pin_is_moved_or_released_into_the_cloth);
    tcase_add_test(cloth, a_correction_through_the_cloth_fails);
    tcase_add_test(cloth, cloth_that_starts_in_itself_is_refused);
    suite_add_tcase(suite, exact);
    suite_add_tcase(suite, cloth);
    return suite;
}
