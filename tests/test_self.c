/* SPDX-License-Identifier: BSD-3-Clause */
/* test_self.c -- contact of a cloth with itself in a given state: forces, energy,
 * powers, gaps. What needs a simulation is in test_self_time.c. */
#include "support.h"

#include "cloth/model.h"
#include "forces/contact/self/self.h"
#include "products.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 7, COLS = 5, N = ROWS * COLS };

static weft_cloth_def def;
static weft_cloth *cloth;
static double y[6 * N];

static double noise(uint64_t *seed) /* in (-1, 1) */
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* Loose particles, so that contact is the only force that depends on the state. */
static void setup(void)
{
    def = weft_cloth_def_default();
    def.rows = ROWS, def.cols = COLS;
    def.spacing[0] = 0.03, def.spacing[1] = 0.04;
    def.gravity[1] = 0.0;
    def.contact.thickness = 0.0145;
    def.contact.self = true;
}

static void teardown(void)
{
    weft_cloth_destroy(cloth);
    cloth = NULL;
}

/* Folded along its middle row into two layers 0.7 thicknesses apart, which lie askew
 * and wavy. */
static void fold(uint64_t seed)
{
    const size_t n = def.rows * def.cols;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < n; ++i) {
        const double r = (double)(i / def.cols), half = 0.5 * (double)(def.rows - 1);
        const bool upper = r > half;
        const double down = upper ? 2.0 * half - r : r;
        y[i]
            = 0.04 * (double)(i % def.cols) + (upper ? 0.4 * (down - 1.3) * 0.03 : 0.0);
        y[n + i] = 0.03 * down + (upper ? 0.005 : 0.0);
        y[2 * n + i] = (upper ? 0.7 * def.contact.thickness : 0.0);
        for (size_t k = 0; k < 6; ++k) {
            y[k * n + i] += (k < 3 ? 1e-3 : 1.0) * noise(&seed);
        }
    }
}

/* Of the energy of contact along direction d, by differences of order 6. */
static double energy_slope(const double *d, double by)
{
    static const double weights[3] = { 0.75, -0.15, 1.0 / 60.0 };
    double at[6 * N], slope = 0.0;
    for (size_t j = 0; j < 6; ++j) {
        const double step = (double)(j / 2 + 1) * by * (j % 2 == 0 ? 1.0 : -1.0);
        for (size_t i = 0; i < weft_cloth_dim(cloth); ++i) {
            at[i] = y[i] + (i < weft_cloth_dim(cloth) / 2 ? step * d[i] : 0.0);
        }
        slope += (j % 2 == 0 ? 1.0 : -1.0) * weights[j / 2] / by
                 * weft_cloth_energy(cloth, 0.0, at).contact;
    }
    return slope;
}

static double force_along(const double *d)
{
    double f[3 * N], sum = 0.0;
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t i = 0; i < weft_cloth_dim(cloth) / 2; ++i) {
        sum += f[i] * d[i];
    }
    return sum;
}

/* Without damping and friction. Kinds of pairs that push are counted. */
static void expect_slopes_of_energy(void)
{
    double d[3 * N];
    uint64_t seed = 7;
    for (int k = 0; k < 20; ++k) {
        for (size_t i = 0; i < weft_cloth_dim(cloth) / 2; ++i) {
            d[i] = noise(&seed);
        }
        const double force = force_along(d), slope = energy_slope(d, 2e-6);
        ck_assert_double_gt(fabs(force), 0.0);
        ck_assert_double_le(fabs(force + slope), 1e-8 * fabs(force));
    }
}

typedef struct kinds {
    weft__self_law law;
    size_t count[4];
} kinds;

static bool count_kind(void *ctx, const weft__pair *pair)
{
    kinds *of = ctx;
    weft__pushes push;
    double bad = 0.0;
    of->count[pair->kind] += weft__pair_push(&of->law, pair, y, &push, 0, &bad);
    return true;
}

static kinds kinds_now(void)
{
    kinds of = { .law = weft__self_law_of(&cloth->self) };
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    ck_assert(weft__each_pair(&tree, def.contact.thickness, count_kind, &of));
    return of;
}

START_TEST(forces_are_slopes_of_the_energy)
{
    def.contact.damping = def.contact.friction = 0.0;
    fold((uint64_t)_i + 1);
    const kinds of = kinds_now();
    for (size_t k = 0; k < 4; ++k) {
        ck_assert_uint_gt(of.count[k], 0);
    }
    expect_slopes_of_energy();
}
END_TEST

START_TEST(a_chain_has_particles_and_edges)
{
    def.contact.damping = def.contact.friction = 0.0;
    def.rows = 21, def.cols = 1;
    fold((uint64_t)_i + 1);
    const kinds of = kinds_now();
    ck_assert_uint_gt(of.count[WEFT__EDGES], 0);
    ck_assert_uint_eq(of.count[WEFT__VERTEX_TRIANGLE], 0);
    expect_slopes_of_energy();
}
END_TEST

/* Both laws of friction, and none; some particles are pinned. */
START_TEST(products_are_those_of_all_kinds_of_pairs)
{
    const weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, 2 } };
    def.contact.law = _i % 3 == 1 ? WEFT_FRICTION_COULOMB : WEFT_FRICTION_SMOOTH;
    def.contact.friction = _i % 3 == 2 ? 0.0 : 0.4;
    def.contact.damping = _i % 3 == 2 ? 0.0 : 0.3;
    def.contact.slip = 0.3;
    def.pins = &pin, def.pin_count = 1;
    fold((uint64_t)_i + 1);
    const kinds of = kinds_now();
    for (size_t k = 0; k < 4; ++k) {
        ck_assert_uint_gt(of.count[k], 0);
    }
    expect_products(cloth, 0.0, y, 2e-7, (uint64_t)_i + 3);
}
END_TEST

START_TEST(without_friction_momentum_and_angular_momentum_are_kept)
{
    def.contact.friction = 0.0;
    fold(3);
    double f[3 * N], force[3] = { 0.0 }, torque[3] = { 0.0 }, most = 0.0;
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            const size_t a = (k + 1) % 3 * N + i, b = (k + 2) % 3 * N + i;
            force[k] += f[k * N + i];
            torque[k] += y[a] * f[b] - y[b] * f[a];
            most = fmax(most, fabs(f[k * N + i]));
        }
    }
    ck_assert_double_gt(most, 0.0);
    for (size_t k = 0; k < 3; ++k) {
        ck_assert_double_le(fabs(force[k]), 1e-13 * most);
        ck_assert_double_le(fabs(torque[k]), 1e-13 * most);
    }
}
END_TEST

START_TEST(rhs_has_the_forces_by_mass)
{
    const weft_pin pin = { .rows = { 0, 0 }, .cols = { 1, 2 } };
    def.pins = &pin, def.pin_count = 1;
    fold(5);
    double f[3 * N], dydt[6 * N];
    weft_cloth_force(cloth, 0.0, y, f);
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
    for (size_t i = 0; i < 3 * N; ++i) {
        const double a = dydt[3 * N + i], m = weft_cloth_particle_mass(cloth, i % N);
        ck_assert_double_le(fabs(weft_cloth_pinned(cloth, i % N) ? a : m * a - f[i]),
                            1e-13 * fabs(f[i]));
    }
}
END_TEST

/* The power method stays below the bounds and is not far from them. */
START_TEST(bounds_hold_the_stiffness_of_pairs)
{
    weft_stiffness refined;
    weft_error err;
    def.contact.friction = _i % 2 == 0 ? 0.0 : 0.3;
    fold((uint64_t)_i + 1);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, 0.0, y);
    ck_assert_int_eq(weft_cloth_stiffness_refined(cloth, 0.0, y, 0, &refined, &err),
                     WEFT_OK);
    ck_assert_double_gt(refined.omega2, 0.1 * bound.omega2);
    ck_assert_double_gt(refined.damping, 0.1 * bound.damping);
    ck_assert_double_lt(refined.omega2, bound.omega2);
    ck_assert_double_lt(refined.damping, bound.damping);
    const double any = weft_cloth_stiffness(cloth, 0.0, NULL).omega2;
    def.contact.self = false;
    teardown();
    cloth = test_cloth(&def);
    ck_assert_double_eq(weft_cloth_stiffness(cloth, 0.0, y).omega2, 0.0);
    ck_assert_double_gt(any, 0.0);
}
END_TEST

START_TEST(flat_cloth_and_its_search_touch_nothing)
{
    def.contact.thickness = 0.5 * 0.03;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    weft_primitive pair[2];
    ck_assert_double_infinite(weft_cloth_self_gap(cloth, y, pair));
    ck_assert_uint_eq(pair[0].count + pair[1].count, 0);
    ck_assert_uint_eq(weft_cloth_self_touching(cloth, y), 0);
}
END_TEST

/* The end of a chain over its first edge. */
START_TEST(smallest_gap_has_its_primitives)
{
    def.rows = 1, def.cols = 4;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    y[3] = y[0] + 0.015, y[4 + 3] = y[4], y[8 + 3] = 0.007;
    y[2] = y[0] + 0.015, y[8 + 2] = 0.04;
    weft_primitive pair[2];
    char text[64];
    ck_assert_double_eq_tol(weft_cloth_self_gap(cloth, y, pair), 0.007, 1e-15);
    ck_assert_str_eq(weft_primitive_text(cloth, &pair[0], text, 64), "particle (0, 3)");
    ck_assert_str_eq(weft_primitive_text(cloth, &pair[1], text, 64),
                     "edge (0, 0)-(0, 1)");
    ck_assert_uint_eq(weft_cloth_self_touching(cloth, y), 1);
}
END_TEST

START_TEST(two_particles_at_one_place_are_unusable)
{
    fold(1);
    double dydt[6 * N];
    for (size_t k = 0; k < 3; ++k) {
        y[k * N] = y[k * N + N - 1];
    }
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 1);
    y[4] = NAN;
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 1);
}
END_TEST

START_TEST(a_cloth_of_pins_does_not_push)
{
    const weft_pin pin = { .rows = { 0, -1 }, .cols = { 0, -1 } };
    def.pins = &pin, def.pin_count = 1;
    fold(1);
    ck_assert_uint_eq(weft_cloth_self_touching(cloth, y), 0);
}
END_TEST

START_TEST(thickness_beyond_half_the_spacing_is_an_error)
{
    weft_error err;
    def.contact.thickness = 0.016;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_str_eq(
        err.message,
        "contact: thickness 0.016 m is too large for self-contact: at most "
        "0.015 m, half the smaller spacing");
}
END_TEST

/* ---- the search ------------------------------------------------------------------ */

typedef struct pairs {
    weft__pair at[1 << 16];
    size_t count;
    double range;
} pairs;

/* Those beyond the range may come, too. */
static bool keep(void *ctx, const weft__pair *pair)
{
    pairs *of = ctx;
    if (!(weft__pair_distance(pair, y, weft_cloth_particles(cloth)) < of->range)) {
        return true;
    }
    ck_assert_uint_lt(of->count, sizeof of->at / sizeof of->at[0]);
    of->at[of->count++] = *pair;
    return true;
}

static pairs *find(double range, weft__knot *knots)
{
    pairs *of = calloc(1, sizeof *of);
    weft__quadtree tree = weft__tree_of(&cloth->self, y);
    if (knots != NULL) {
        weft__tree_fill(&tree, knots);
    }
    ck_assert_ptr_nonnull(of);
    of->range = range;
    ck_assert(weft__each_pair(&tree, range, keep, of));
    return of;
}

static bool same(const weft__pair *a, const weft__pair *b)
{
    return a->kind == b->kind
           && memcmp(a->particle, b->particle,
                     weft__pair_particles(a) * sizeof *a->particle)
                  == 0;
}

START_TEST(pairs_of_a_smaller_range_are_in_the_same_order)
{
    fold((uint64_t)_i + 1);
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    weft__knot *knots = calloc(weft__tree_size(&tree), sizeof *knots);
    pairs *few = find(0.008, NULL), *many = find(0.02, knots),
          *again = find(0.008, knots);
    size_t at = 0;
    ck_assert_uint_gt(few->count, 0);
    ck_assert_uint_gt(many->count, few->count);
    ck_assert_uint_eq(again->count, few->count);
    for (size_t i = 0; i < few->count; ++i, ++at) {
        ck_assert(same(&few->at[i], &again->at[i]));
        while (at < many->count && !same(&few->at[i], &many->at[at])) {
            ck_assert_double_ge(weft__pair_distance(&many->at[at], y, N), 0.008);
            ++at;
        }
        ck_assert_uint_lt(at, many->count);
    }
    free(few), free(many), free(again), free(knots);
}
END_TEST

/* Of pairs without a common particle, by all primitives. */
static size_t near_by_force(double range)
{
    size_t count = 0;
    uint32_t e[3][2], f[3][2], t[2][3];
    for (uint32_t i = 0; i < N; ++i) {
        for (uint32_t j = 0; j < N; ++j) {
            const size_t edges = weft__edges_of(&cloth->mesh, i, e);
            const size_t others = weft__edges_of(&cloth->mesh, j, f);
            const size_t triangles = weft__triangles_of(&cloth->mesh, j, t);
            weft__pair pair = { .particle = { i, j }, .kind = WEFT__VERTICES };
            count += i < j && weft__pair_distance(&pair, y, N) < range;
            for (size_t k = 0; k < others; ++k) {
                pair = (weft__pair){ .particle = { i, f[k][0], f[k][1] },
                                     .kind = WEFT__VERTEX_EDGE };
                count += i != f[k][0] && i != f[k][1]
                         && weft__pair_distance(&pair, y, N) < range;
            }
            for (size_t k = 0; k < triangles; ++k) {
                pair = (weft__pair){ .particle = { i, t[k][0], t[k][1], t[k][2] },
                                     .kind = WEFT__VERTEX_TRIANGLE };
                count += i != t[k][0] && i != t[k][1] && i != t[k][2]
                         && weft__pair_distance(&pair, y, N) < range;
            }
            for (size_t k = 0; i < j && k < edges * others; ++k) {
                const uint32_t *a = e[k / others], *b = f[k % others];
                pair = (weft__pair){ .particle = { a[0], a[1], b[0], b[1] },
                                     .kind = WEFT__EDGES };
                count += a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1]
                         && weft__pair_distance(&pair, y, N) < range;
            }
        }
    }
    return count;
}

START_TEST(search_finds_all_pairs)
{
    static const double ranges[] = { 0.004, 0.012, 0.02, 0.03 };
    fold((uint64_t)_i + 1);
    for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; ++k) {
        pairs *of = find(ranges[k], NULL);
        ck_assert_uint_eq(of->count, near_by_force(ranges[k]));
        free(of);
    }
}
END_TEST

/* Bent along rows by an angle per row, and sheared in its plane: patches of every
 * flatness. */
START_TEST(search_finds_all_pairs_of_bent_cloth)
{
    const double angle = 0.05 * (double)_i;
    double at[2] = { 0.0, 0.0 };
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (size_t r = 0; r < ROWS; ++r) {
        for (size_t c = 0; c < COLS; ++c) {
            const size_t i = r * COLS + c;
            y[i] = 0.04 * (double)c + 0.2 * angle * at[0];
            y[N + i] = at[0];
            y[2 * N + i] = at[1];
        }
        at[0] += 0.03 * cos(angle * (double)r), at[1] += 0.03 * sin(angle * (double)r);
    }
    for (double range = 0.005; range < 0.03; range += 0.005) {
        pairs *of = find(range, NULL);
        ck_assert_uint_eq(of->count, near_by_force(range));
        free(of);
    }
}
END_TEST

/* Each particle is moved by less than half the wait: no pair pushes. */
START_TEST(pairs_do_not_push_before_their_wait)
{
    const double most = 0.012;
    uint64_t seed = (uint64_t)_i + 1;
    size_t by_feet = 0;
    fold(seed);
    pairs *of = find(0.02, NULL);
    const weft__self_law law = weft__self_law_of(&cloth->self);
    for (size_t i = 0; i < of->count; ++i) {
        double moved[6 * N], distance, wait, bad = 0.0;
        weft__pushes push;
        int32_t at[WEFT__NEAR_PLANES][1 + WEFT__BLOCK] = { { 0 } };
        const weft__near one
            = { { at[0], at[1], at[2], at[3], at[4], at[5] }, &wait, NULL, NULL };
        for (size_t k = 0; k < 4; ++k) {
            at[k][0] = (int32_t)of->at[i].particle[k];
        }
        cloth->self.slack(&cloth->self, (weft__pair_kind)of->at[i].kind, &one, 0, 1, y,
                          most, &distance);
        ck_assert_double_eq(distance, weft__pair_distance(&of->at[i], y, N));
        ck_assert_double_ge(wait, distance - def.contact.thickness);
        by_feet += wait > 0.0 && distance < def.contact.thickness;
        for (int tries = 0; tries < 20 && wait > 0.0; ++tries) {
            memcpy(moved, y, sizeof moved);
            for (size_t j = 0; j < N; ++j) {
                double d[3] = { noise(&seed), noise(&seed), noise(&seed) };
                const double by = 0.4999 * wait / weft__length(d);
                for (size_t k = 0; k < 3; ++k) {
                    moved[k * N + j] += by * d[k];
                }
            }
            ck_assert(!weft__pair_push(&law, &of->at[i], moved, &push, 0, &bad));
        }
    }
    ck_assert_uint_gt(by_feet, 10);
    free(of);
}
END_TEST

/* ---- steps ----------------------------------------------------------------------- */

/* The upper layer gets below the lower one, by a step of h at rest at both ends. */
static size_t pairs_that_may_have_met(double h)
{
    double after[6 * N];
    memset(y + 3 * N, 0, 3 * N * sizeof *y);
    memcpy(after, y, sizeof y);
    for (size_t i = 2 * N + (ROWS + 1) / 2 * COLS; i < 3 * N; ++i) {
        after[i] -= 1.4 * def.contact.thickness;
    }
    const weft__stride stride = { &cloth->self, y, after, h };
    pairs *of = find(0.02, NULL);
    size_t count = 0;
    for (size_t i = 0; i < of->count; ++i) {
        double gap;
        count += !weft__stride_clear(&stride, &of->at[i], &gap);
    }
    free(of);
    return count;
}

START_TEST(steps_are_judged_by_their_straight_way)
{
    fold((uint64_t)_i + 1);
    const size_t count = pairs_that_may_have_met(0.0);
    ck_assert_uint_gt(count, 0);
    ck_assert_uint_eq(pairs_that_may_have_met(1e-3), count);
}
END_TEST

TEST_SUITE(self)
{
    Suite *suite = suite_create("self");
    TCase *state = tcase_create("state"), *search = tcase_create("search");
    tcase_add_checked_fixture(state, setup, teardown);
    tcase_add_checked_fixture(search, setup, teardown);
    tcase_add_loop_test(state, forces_are_slopes_of_the_energy, 0, 10);
    tcase_add_loop_test(state, a_chain_has_particles_and_edges, 0, 5);
    tcase_add_loop_test(state, products_are_those_of_all_kinds_of_pairs, 0, 9);
    tcase_add_test(state, without_friction_momentum_and_angular_momentum_are_kept);
    tcase_add_test(state, rhs_has_the_forces_by_mass);
    tcase_add_loop_test(state, bounds_hold_the_stiffness_of_pairs, 0, 6);
    tcase_add_test(state, flat_cloth_and_its_search_touch_nothing);
    tcase_add_test(state, smallest_gap_has_its_primitives);
    tcase_add_test(state, two_particles_at_one_place_are_unusable);
    tcase_add_test(state, a_cloth_of_pins_does_not_push);
    tcase_add_test(state, thickness_beyond_half_the_spacing_is_an_error);
    tcase_add_loop_test(search, pairs_of_a_smaller_range_are_in_the_same_order, 0, 5);
    tcase_add_loop_test(search, pairs_do_not_push_before_their_wait, 0, 5);
    tcase_add_loop_test(search, search_finds_all_pairs, 0, 5);
    tcase_add_loop_test(search, search_finds_all_pairs_of_bent_cloth, 0, 40);
    tcase_add_loop_test(search, steps_are_judged_by_their_straight_way, 0, 5);
    suite_add_tcase(suite, state);
    suite_add_tcase(suite, search);
    return suite;
}
