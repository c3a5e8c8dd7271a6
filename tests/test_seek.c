/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: kernels asan-long */
/* test_seek.c -- the search for pairs by boxes in single precision finds those of the
 * tree in double precision, in the same order, on every level of instructions and 8
 * lanes wide. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bodies.h"
#include "cloth/model.h"
#include "folded.h"
#include "folded_mesh.h"
#include "forces/contact/self/self_list.h"

weft__fill_fn weft__fill_wide;
weft__bend_fn weft__bend_wide;
weft__seek_fn weft__seek_wide;

static weft_cloth *cloth;
static weft_shape shape;
static body_mesh *ball;
static test_mesh mesh;
static weft__self_list *list;
static double *y; /* of all points, and velocities */

static void setup(void)
{
    mesh = (test_mesh){ .rows = 0 };
}

static void teardown(void)
{
    weft__self_list_destroy(list);
    weft_cloth_destroy(cloth);
    free(ball), free(y);
    mesh_free(&mesh);
    cloth = NULL, list = NULL, ball = NULL, y = NULL;
}

static void begin(const weft_cloth_def *def)
{
    const weft_allocator memory = weft_allocator_or_malloc(NULL);
    cloth = test_cloth(def);
    const weft__self *own
        = def->contact.shape_count > 0 ? &cloth->bodies.pairs : &cloth->self;
    list = weft__self_list_create(own, NULL, NULL, &memory);
    ck_assert_ptr_nonnull(list);
    y = calloc(6 * own->points, sizeof *y);
}

/* The tree, the levels of this machine, and 8 lanes. */
static size_t form_count(void)
{
    return (size_t)weft__isa_last() + 2;
}

static void choose(size_t form)
{
    static const weft__seeker wide
        = { weft__fill_wide, weft__bend_wide, weft__seek_wide };
    weft__self *own = list->own == &cloth->self ? &cloth->self : &cloth->bodies.pairs;
    own->seeker = form + 1 == form_count() ? &wide : weft__seeker_of((weft__isa)form);
}

/* ---- states ---------------------------------------------------------------------- */

/* A crumple of waves of all directions. */
static void put_crumple(double u, double w, double x[3], double v[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = 0.45 * sin(7.0 * u + (double)k * 2.0 + 3.0 * w)
               + 0.3 * sin(11.0 * w - 5.0 * u * (double)k + 1.0)
               + 0.1 * sin(23.0 * u * w + 17.0 * w * (double)k);
        v[k] = 0.0;
    }
}

static void put_line(double u, double w, double x[3], double v[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = (u + w) * (0.3 + 0.1 * (double)k), v[k] = 0.0;
    }
}

static folded_shape *const states[]
    = { folded_fold, folded_pile, folded_roll, folded_flat, put_crumple };
enum { STATES = sizeof states / sizeof states[0] };

/* A state of a grid, `away` from the origin, with noise of 2 % of a spacing. */
static void lay(const weft_cloth_def *def, folded_shape *state, double away)
{
    const size_t n = def->rows * def->cols;
    uint64_t seed = 7;
    for (size_t i = 0; i < n; ++i) {
        double x[3], v[3];
        state((double)(i % def->cols) * def->spacing[1],
              (double)(i / def->cols) * def->spacing[0], x, v);
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + i]
                = x[k] + away + 0.02 * def->spacing[0] * (random_uniform(&seed) - 0.5);
        }
    }
}

/* ---- pairs ----------------------------------------------------------------------- */

enum { KINDS = WEFT__EDGES + 1, PAIRS = 1 << 18 };
typedef struct finding {
    weft__pair (*at)[PAIRS];
    size_t count[KINDS], all; /* all: also those beyond the range */
    double range;
} finding;

static bool keep_near(void *ctx, const weft__pair *pair)
{
    finding *of = ctx;
    ++of->all;
    if (weft__pair_distance(pair, y, list->own->points) <= of->range) {
        ck_assert_uint_lt(of->count[pair->kind], PAIRS);
        of->at[pair->kind][of->count[pair->kind]++] = *pair;
    }
    return true;
}

static void find(size_t form, finding *to)
{
    memset(to->count, 0, sizeof to->count), to->all = 0;
    choose(form);
    weft__self_search_place(list, y);
    for (size_t i = 0; i < list->between_count; ++i) {
        weft__self_search_mark(list, list->between[i]);
    }
    weft__self_search_begin(list);
    for (size_t i = 0; i < list->between_count; ++i) {
        ck_assert(weft__self_search(list, list->between[i], to->range, keep_near, to));
    }
}

/* Returns the number of pairs. */
static size_t expect_pairs_of_the_tree(double range)
{
    finding tree = { .at = calloc(KINDS, sizeof *tree.at), .range = range };
    finding boxes = { .at = calloc(KINDS, sizeof *boxes.at), .range = range };
    size_t found = 0;
    find(0, &tree);
    for (size_t form = 1; form < form_count(); ++form) {
        find(form, &boxes);
        for (size_t kind = 0; kind < KINDS; ++kind) {
            const size_t size = tree.count[kind] * sizeof(weft__pair);
            ck_assert_uint_eq(boxes.count[kind], tree.count[kind]);
            ck_assert_mem_eq(boxes.at[kind], tree.at[kind], size);
        }
        ck_assert_uint_le(boxes.all, 2 * tree.all + 1000);
    }
    for (size_t kind = 0; kind < KINDS; ++kind) {
        found += tree.count[kind];
    }
    free(tree.at), free(boxes.at);
    return found;
}

static const size_t grids[][2]
    = { { 1, 40 }, { 40, 1 }, { 2, 40 }, { 3, 50 }, { 33, 33 }, { 100, 100 } };
enum { GRIDS = sizeof grids / sizeof grids[0] };

START_TEST(boxes_find_the_pairs_of_grids)
{
    size_t found = 0;
    weft_cloth_def def = folded_model(grids[_i][0], grids[_i][1]);
    const double a = def.spacing[0];
    def.spacing[1] *= 0.8;
    def.contact.thickness *= 0.5;
    begin(&def);
    for (size_t i = 0; i < 2 * STATES; i += def.rows < 100 ? 1 : 3) {
        lay(&def, states[i / 2], i % 2 == 0 ? 0.0 : 1000.0);
        found += expect_pairs_of_the_tree(0.3 * a);
        found += def.rows < 100 ? expect_pairs_of_the_tree(0.9 * a) : 0;
    }
    ck_assert_uint_gt(found, 0);
}
END_TEST

/* Where single precision finds no direction across another. */
START_TEST(boxes_find_the_pairs_of_a_grid_in_a_line)
{
    weft_cloth_def def = folded_model(12, 12);
    begin(&def);
    lay(&def, put_line, _i == 0 ? 0.0 : 1000.0);
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.3 * def.spacing[0]), 1000);
}
END_TEST

/* By where particles start, along x and `axis`. */
static void lay_mesh(folded_shape *state, size_t axis, double away)
{
    const size_t n = list->own->points, particles = weft_cloth_particles(cloth);
    double *start = calloc(6 * particles, sizeof *start);
    weft_cloth_start(cloth, start);
    for (size_t i = 0; i < particles; ++i) {
        double x[3], v[3];
        state(start[i], start[axis * particles + i], x, v);
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + i] = x[k] + away;
        }
    }
    free(start);
}

static void define_mesh(weft_cloth_def *to)
{
    *to = mesh_cloth(&mesh);
    to->contact.thickness = 0.3 * mesh_least_height(&mesh);
    to->contact.self = true;
}

START_TEST(boxes_find_the_pairs_of_meshes)
{
    weft_cloth_def def;
    mesh_sheet(&mesh, 25, 25, 1.0 / 24, MESH_RANDOM, 0.3, (uint64_t)_i + 1);
    mesh_shuffle(&mesh, (uint64_t)_i + 9, NULL);
    define_mesh(&def);
    begin(&def);
    lay_mesh(put_crumple, 1, _i == 0 ? 0.0 : 1000.0);
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.015), 1000);
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.05), 10000);
}
END_TEST

/* Two fans over each other, whose hubs own more than a search takes at once. */
START_TEST(boxes_find_the_pairs_of_fans)
{
    enum { SPOKES = 40, RIM = SPOKES + 1, POINTS = 2 * RIM + 2 };
    weft_cloth_def def;
    mesh_sheet(&mesh, 3, SPOKES + 2, 1.0, MESH_RIGHT, 0.0, 1);
    for (uint32_t i = 0; i < POINTS; ++i) {
        const uint32_t fan = i < 2 ? i : (i - 2) / RIM;
        const double angle = 0.15 * (double)i, r = i < 2 ? 0.0 : 1.0;
        const double at[3] = { r * cos(angle), r * sin(angle), 0.1 * fan };
        memcpy(&mesh.start[3 * (size_t)i], at, sizeof at);
        mesh.rest[2 * (size_t)i] = at[0] + 3.0 * fan;
        mesh.rest[2 * (size_t)i + 1] = at[1];
    }
    for (uint32_t k = 0; k < 2 * SPOKES; ++k) {
        const uint32_t fan = k / SPOKES, at = 2 + fan * RIM + k % SPOKES;
        const uint32_t corner[3] = { fan, at, at + 1 };
        memcpy(&mesh.corners[3 * (size_t)k], corner, sizeof corner);
    }
    memcpy(mesh.places, mesh.corners, 6 * SPOKES * sizeof *mesh.places);
    mesh_point(&mesh, POINTS, POINTS, 2 * SPOKES);
    define_mesh(&def);
    begin(&def);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < POINTS; ++i) {
        y[2 * POINTS + i] += 0.03 * (double)(i % 3);
    }
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.05), 100);
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.5), 1000);
}
END_TEST

/* A sheet through a ball. */
START_TEST(boxes_find_the_pairs_with_bodies)
{
    weft_cloth_def def = folded_model(25, 25);
    const double away = _i == 0 ? 0.0 : 1000.0;
    ball = icosphere(3, 0.3);
    shape = body_shape(ball);
    def.contact.self = false;
    def.origin[1] = 1.0;
    def.contact.shapes = &shape, def.contact.shape_count = 1;
    begin(&def);
    lay_mesh(put_crumple, 2, away);
    const size_t n = list->own->points, first = weft_cloth_particles(cloth);
    for (size_t i = 0; i < 3 * (n - first); ++i) {
        y[i % 3 * n + first + i / 3] = ball->places[i] + away;
    }
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.01), 100);
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.05), 1000);
}
END_TEST

/* Places that single precision does not have are near each other at most. */
START_TEST(boxes_find_the_pairs_of_places_beyond_single_precision)
{
    weft_cloth_def def = folded_model(20, 20);
    begin(&def);
    lay(&def, put_crumple, 0.0);
    for (size_t i = 0; i < 3 * list->own->points; i += 7) {
        y[i] *= i % 2 == 0 ? 1e45 : 1e-45;
    }
    ck_assert_uint_gt(expect_pairs_of_the_tree(0.1), 1000);
}
END_TEST

/* ---- steps ----------------------------------------------------------------------- */

typedef struct verdict {
    bool clear;
    weft_primitive pair[2];
    double gap;
} verdict;

/* By tiles; or a list of a part searches the whole cloth, by what all tiles move. */
static verdict verdict_of(const weft__stride *of, bool by_tiles)
{
    verdict out;
    memset(&out, 0, sizeof out);
    list->part[0] = by_tiles ? 0 : 1;
    out.clear = weft__self_list_clear(list, of, out.pair, &out.gap);
    return out;
}

static void expect_same_verdict(const verdict *a, const verdict *b)
{
    ck_assert_int_eq(a->clear, b->clear);
    ck_assert_double_eq(a->gap, b->gap);
    for (size_t j = 0; j < 2; ++j) {
        ck_assert_uint_eq(a->pair[j].count, b->pair[j].count);
        for (size_t k = 0; k < a->pair[j].count; ++k) {
            ck_assert_uint_eq(a->pair[j].particle[k], b->pair[j].particle[k]);
        }
    }
}

/* Moves all points along waves, up to half a spacing or as much more as `far` is, and
 * sets velocities of as much in h. */
static void step(double *to, double far, double h, uint64_t *seed)
{
    const size_t n = list->own->points;
    double wave[9];
    for (size_t k = 0; k < 9; ++k) {
        wave[k] = 40.0 * (random_uniform(seed) - 0.5);
    }
    memcpy(to, y, 6 * n * sizeof *to);
    for (size_t i = 0; i < 3 * n; ++i) {
        const size_t k = i / n, j = i % n;
        const double way
            = far
              * sin(wave[3 * k] * y[j] + wave[3 * k + 1] * y[n + j] + wave[3 * k + 2]);
        to[i] += way;
        y[3 * n + i] = to[3 * n + i] = h > 0.0 ? 1.1 * way / h : 0.0;
    }
}

static void count_vetoes(double spacing, int wanted, size_t kinds[2])
{
    const size_t n = list->own->points;
    double *to = calloc(6 * n, sizeof *to);
    uint64_t seed = 3;
    size_t cleared = 0;
    for (int vetoes = 0, i = 0; vetoes < wanted; ++i) {
        const double h = i % 3 == 0 ? 0.0 : 1e-3;
        step(to, spacing * pow(2.0, -8.0 * random_uniform(&seed)), h, &seed);
        const weft__stride stride = { list->own, y, to, h };
        choose((size_t)i % form_count());
        const verdict one = verdict_of(&stride, true);
        const verdict other = verdict_of(&stride, false);
        expect_same_verdict(&one, &other);
        vetoes += !one.clear, cleared += one.clear;
        kinds[0] += !one.clear && one.pair[0].count == 1;
        kinds[1] += !one.clear && one.pair[0].count == 2;
    }
    ck_assert_uint_gt(cleared, 0);
    free(to);
}

START_TEST(steps_are_vetoed_for_the_first_pair_of_the_whole_search)
{
    size_t kinds[2] = { 0 };
    const double away = _i % 2 == 0 ? 0.0 : 1000.0;
    weft_cloth_def def = folded_model(17, 12);
    if (_i < 2) {
        begin(&def);
        lay(&def, folded_pile, away);
    } else {
        mesh_sheet(&mesh, 14, 14, 1.0 / 13, MESH_RANDOM, 0.3, 5);
        define_mesh(&def);
        begin(&def);
        lay_mesh(folded_pile, 1, away);
    }
    count_vetoes(0.05, test_rounds(30, 1000), kinds);
    ck_assert_uint_gt(kinds[0], 0);
    ck_assert_uint_gt(kinds[1], 0);
}
END_TEST

TEST_SUITE(seek)
{
    Suite *suite = suite_create("seek");
    TCase *tcase = tcase_create("seek");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_set_timeout(tcase, test_rounds(60, 600));
    tcase_add_loop_test(tcase, boxes_find_the_pairs_of_grids, 0, GRIDS);
    tcase_add_loop_test(tcase, boxes_find_the_pairs_of_a_grid_in_a_line, 0, 2);
    tcase_add_loop_test(tcase, boxes_find_the_pairs_of_meshes, 0, 2);
    tcase_add_test(tcase, boxes_find_the_pairs_of_fans);
    tcase_add_loop_test(tcase, boxes_find_the_pairs_with_bodies, 0, 2);
    tcase_add_test(tcase, boxes_find_the_pairs_of_places_beyond_single_precision);
    tcase_add_loop_test(tcase, steps_are_vetoed_for_the_first_pair_of_the_whole_search,
                        0, 4);
    suite_add_tcase(suite, tcase);
    return suite;
}
