/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* test_bodies.c -- contact of a cloth with shapes of triangles: forces in a state, what
 * starts where, and landings. */
#include "support.h"

#include "bodies.h"
#include "cloth/model.h"
#include "forces/contact/self/crossing.h"
#include "forces/contact/self/self_list.h"
#include "products.h"
#include "random.h"
#include "sim/forces.h"

enum { SIDE = 9, N = SIDE * SIDE };

static weft_cloth_def def;
static weft_shape shapes[3];
static body_mesh *bodies[3];
static weft_cloth *cloth;
static weft_sim *sim;
static weft_sim_def run;
static weft_error err;

/* A level sheet of SIDE x SIDE loose particles, 2 cm apart, about the y axis. */
static void setup(void)
{
    def = weft_cloth_def_default();
    def.rows = def.cols = SIDE;
    def.spacing[0] = def.spacing[1] = 0.02;
    def.origin[0] = def.origin[2] = -0.08;
    def.down[1] = 0.0, def.down[2] = 1.0;
    def.contact.thickness = 5e-3;
    def.contact.shapes = shapes;
    run = weft_sim_def_default();
    run.method = test_method_named("arkode/dormand_prince");
    memset(bodies, 0, sizeof bodies);
}

static void teardown(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    for (size_t k = 0; k < 3; ++k) {
        free(bodies[k]);
        bodies[k] = NULL;
    }
    sim = NULL, cloth = NULL;
}

static weft_shape *put(body_mesh *body)
{
    const size_t k = def.contact.shape_count++;
    bodies[k] = body;
    shapes[k] = body_shape(body);
    return &shapes[k];
}

static void springs(double stiffness, double damping)
{
    const weft_spring_def spring
        = { .present = true, .stiffness = stiffness, .damping = damping };
    def.springs[WEFT_STRETCH] = def.springs[WEFT_SHEAR] = spring;
}

static void begin(double tolerance)
{
    cloth = test_cloth(&def);
    run.cloth = cloth;
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = tolerance;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
}

static void go(double t)
{
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

static double height(size_t particle)
{
    return weft_sim_state(sim)[N + particle];
}

/* Of a plane of the state. */
static double mean(size_t plane)
{
    double sum = 0.0;
    for (size_t i = 0; i < N; ++i) {
        sum += weft_sim_state(sim)[plane * N + i];
    }
    return sum / N;
}

/* ---- in a state ------------------------------------------------------------------ */

/* An uneven sheet within the thickness of a plate of 4 x 4 cells and of another that
 * stands in its way aslant. */
static void lay(double *y, uint64_t seed)
{
    shapes[0].at[1] = -3e-3;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < 6 * N; ++i) {
        y[i] += (i < 3 * N ? 1.2e-3 : 0.5) * (2.0 * random_uniform(&seed) - 1.0);
    }
}

START_TEST(loads_are_the_forces_that_the_cloth_feels)
{
    double y[6 * N], f[3 * N], sum[6] = { 0.0 };
    put(plate(4, 0.07, 0.07))->velocity[0] = 0.2;
    put(icosphere(1, 0.05))->at[1] = -0.053;
    shapes[1].friction = 0.9;
    def.gravity[1] = 0.0;
    lay(y, 5);
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t i = 0; i < 3 * N; ++i) {
        sum[i / N] += f[i];
    }
    for (size_t k = 0; k < 2; ++k) {
        double force[3], torque[3];
        weft_cloth_shape_load(cloth, 0.0, y, k, force, torque);
        ck_assert_double_lt(force[1], 0.0);
        for (size_t j = 0; j < 3; ++j) {
            sum[j] += force[j];
        }
    }
    for (size_t j = 0; j < 3; ++j) {
        ck_assert_double_eq_tol(sum[j], 0.0, 1e-12 * fabs(f[1]) + 1e-12);
    }
}
END_TEST

/* Of bodies that rest and move, rough. */
START_TEST(products_are_those_of_pairs_with_bodies)
{
    double y[6 * N];
    put(plate(4, 0.07, 0.07))->velocity[0] = 0.2;
    put(icosphere(1, 0.05))->at[1] = -0.053;
    shapes[1].friction = 0.9;
    def.contact.damping = 0.3, def.contact.slip = 0.3;
    lay(y, (uint64_t)_i + 5);
    ck_assert_uint_gt(weft_cloth_touching(cloth, 0.0, y), 0);
    expect_products(cloth, 0.0, y, 1e-7, (uint64_t)_i + 1);
}
END_TEST

START_TEST(a_pinned_cloth_feels_no_body)
{
    const weft_pin all = { .rows = { 0, -1 }, .cols = { 0, -1 } };
    double y[6 * N];
    put(plate(1, 0.2, 0.2));
    def.pins = &all, def.pin_count = 1;
    lay(y, 1);
    ck_assert(weft_cloth_energy(cloth, 0.0, y).contact == 0.0);
}
END_TEST

/* Its primitives are out of contact with it: no step is taken back. */
START_TEST(a_pinned_cloth_moves_through_a_body)
{
    const weft_pin all
        = { .rows = { 0, -1 }, .cols = { 0, -1 }, .velocity = { 0.0, -0.5, 0.0 } };
    put(plate(1, 0.2, 0.2));
    shapes[0].at[1] = -0.05;
    def.pins = &all, def.pin_count = 1;
    begin(1e-4);
    go(0.2);
    ck_assert_double_eq_tol(height(0), -0.1, 1e-15);
    ck_assert_uint_eq(weft_sim_vetoed(sim), 0);
    ck_assert_uint_eq(weft_cloth_each_crossing(cloth, weft_sim_state(sim), NULL, NULL),
                      0);
}
END_TEST

/* ---- where it starts ------------------------------------------------------------- */

static const char *refusal(void)
{
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    return err.message;
}

START_TEST(cloth_that_passes_through_a_body_is_named)
{
    put(icosphere(2, 0.05));
    const char *text = refusal();
    ck_assert_msg(strstr(text, " passes through ") != NULL
                      && strstr(text, "shapes[0]") != NULL
                      && strstr(text, " such pairs") != NULL,
                  "%s", text);
}
END_TEST

START_TEST(cloth_in_a_closed_body_is_named_and_in_an_open_one_is_not)
{
    put(icosphere(1, 0.5));
    const char *text = refusal();
    ck_assert_msg(strstr(text, "particle (0, 0) is inside shapes[0], a closed mesh")
                      != NULL,
                  "%s", text);
    --bodies[0]->body.triangles;
    cloth = test_cloth(&def);
}
END_TEST

START_TEST(pinned_corners_of_a_start_in_a_body_are_named)
{
    const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    put(icosphere(1, 0.015))->at[0] = -0.08;
    shapes[0].at[1] = 1e-3, shapes[0].at[2] = -0.08;
    const char *text = refusal();
    ck_assert_msg(strstr(text, " such pairs") != NULL && !strstr(text, "pins"), "%s",
                  text);
    def.pins = &corner, def.pin_count = 1;
    text = refusal();
    ck_assert_msg(strstr(text, "edge (0, 0)-(0, 1) passes through shapes[0]; ") == text
                      && strstr(text, "; pins hold (0, 0), and corners of ") != NULL,
                  "%s", text);
}
END_TEST

/* The body reaches primitives only whose corners are all pinned. */
START_TEST(a_pinned_patch_may_start_in_a_body)
{
    const weft_pin patch = { .rows = { 0, 1 }, .cols = { 0, 1 } };
    put(icosphere(1, 0.015))->at[0] = -0.08;
    shapes[0].at[2] = -0.08;
    def.pins = &patch, def.pin_count = 1;
    springs(50.0, 0.02);
    begin(1e-4);
    go(0.1);
    ck_assert_uint_eq(weft_sim_vetoed(sim), 0);
}
END_TEST

START_TEST(wrong_bodies_are_refused)
{
    static const char *const texts[]
        = { "a mesh needs a body", "a vertex that is not there: triangle 1",
            "no area: triangle 0", "not finite",
            "fps is not finite",   "fps is not finite",
            "a mesh cannot spin" };
    body_mesh *body = plate(1, 0.2, 0.2);
    weft_shape *shape = put(body);
    shape->at[1] = -0.1;
    switch (_i) {
    case 0:
        shape->body = NULL;
        break;
    case 1:
        body->corners[5] = 4;
        break;
    case 2:
        memcpy(body->places, body->places + 3, 3 * sizeof(double));
        break;
    case 3:
        body->places[4] = NAN;
        break;
    case 4:
        body->body.keys = 2;
        break;
    case 5:
        body->body.keys = 2;
        body->body.fps = INFINITY;
        break;
    default:
        shape->spin[1] = 1.0;
        break;
    }
    const char *text = refusal();
    ck_assert_msg(strstr(text, texts[_i]) != NULL, "%s", text);
}
END_TEST

/* ---- landings -------------------------------------------------------------------- */

/* Lets the sheet fall on what is below it and rest there. */
static void land(double t)
{
    def.damping = 1e-3;
    springs(20.0, 0.02);
    def.contact.friction = 0.5;
    begin(1e-5);
    go(t);
}

/* Some 0.4 mm lower or higher: one law has the mass of a particle, the other the
 * density times reduced areas (docs/theory/contact.md). */
START_TEST(an_icosphere_bears_a_cloth_as_a_sphere_does)
{
    double force[3], torque[3], top[2];
    def.origin[1] = 0.152;
    put(icosphere(4, 0.15));
    land(1.0);
    top[0] = height(N / 2);
    weft_sim_shape_load(sim, 0, force, torque);
    const double speed
        = sqrt(2.0 * weft_sim_measure(sim).energy.kinetic / weft_cloth_mass(cloth));
    ck_assert_double_lt(speed, 1e-3);
    ck_assert_double_eq_tol(force[1], -9.81 * weft_cloth_mass(cloth),
                            0.005 * 9.81 * weft_cloth_mass(cloth));
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    sim = NULL, cloth = NULL;
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.15;
    land(1.0);
    top[1] = height(N / 2);
    ck_assert_double_eq_tol(top[0], top[1], 0.1 * def.contact.thickness);
}
END_TEST

/* The lowest mean height, in thicknesses, of a sheet that meets a plate of so many
 * cells at 1 m/s. */
static double lowest(size_t cells)
{
    double least = 1.0;
    setup();
    def.origin[1] = 6e-3, def.velocity[1] = -1.0;
    def.gravity[1] = 0.0;
    def.contact.friction = 0.0;
    put(plate(cells, 0.5, 0.5));
    shapes[0].at[0] = 0.19, shapes[0].at[2] = 0.21;
    shapes[0].orientation[1] = sin(0.15), shapes[0].orientation[3] = cos(0.15);
    springs(20.0, 0.02);
    begin(1e-7);
    while (weft_sim_time(sim) < 0.01) {
        ck_assert_msg(weft_sim_step(sim, 0.01, &err) == WEFT_OK, "%s", err.message);
        least = fmin(least, mean(1));
    }
    teardown();
    return least / 5e-3;
}

START_TEST(plates_of_any_cells_stop_a_sheet_at_one_depth)
{
    static const size_t cells[] = { 1, 3, 10, 30, 100 };
    const double depth = lowest(1);
    for (size_t i = 1; i < 4 + (size_t)test_rounds(0, 1); ++i) {
        const double other = lowest(cells[i]);
        ck_assert_double_eq_tol(other, depth, 0.01);
    }
}
END_TEST

/* At 30 m/s, through a plate of two triangles: flat, tilted, edge-on, its edge ahead,
 * one that moves to meet it, and onto the edge of an upright one. */
START_TEST(nothing_tunnels_through_two_triangles)
{
    static const double turned[5]
        = { 0.0, 0.6, 1.5707963267948966, 0.0, 1.5707963267948966 };
    weft_shape *shape = put(plate(1, 0.15, 0.15));
    def.contact.thickness = 2e-3;
    def.velocity[1] = -30.0, def.origin[1] = 0.3;
    def.gravity[1] = 0.0;
    shape->velocity[1] = _i == 3 ? 30.0 : 0.0;
    shape->orientation[0] = sin(0.5 * turned[_i]);
    shape->orientation[3] = cos(0.5 * turned[_i]);
    if (_i == 2) {
        def.down[1] = -1.0, def.down[2] = 0.0;
        shape->orientation[0] = 0.0, shape->orientation[3] = 1.0;
        shape->at[0] = 0.013, shape->at[2] = -0.021, shape->at[1] = 0.13;
    }
    springs(20.0, 0.02);
    begin(1e-3);
    for (size_t i = 1; i <= 40; ++i) {
        go(0.001 * (double)i);
        ck_assert_msg(weft__bodies_error(&weft_sim_cloth(sim)->bodies,
                                         weft_sim_time(sim), weft_sim_state(sim),
                                         &(weft__search){ 0 }, &err)
                          == WEFT_OK,
                      "%s", err.message);
    }
    ck_assert_uint_lt(10 * weft_sim_vetoed(sim), weft_sim_stats(sim).steps);
}
END_TEST

START_TEST(friction_holds_on_a_tilted_facet)
{
    const double angle = atan(_i == 0 ? 0.25 : 0.35);
    weft_shape *shape = put(plate(2, 0.3, 0.3));
    shape->orientation[0] = sin(0.5 * angle);
    shape->orientation[3] = cos(0.5 * angle);
    shape->friction = 0.3;
    def.down[1] = -sin(angle), def.down[2] = cos(angle);
    def.origin[1] = 0.0795 * sin(angle) + 4.6e-3;
    def.origin[2] = -0.08 * cos(angle);
    springs(50.0, 0.05);
    begin(1e-6);
    double speed[2];
    for (size_t k = 0; k < 2; ++k) {
        go(0.25 * (double)(k + 1));
        speed[k] = mean(5) / cos(angle);
    }
    const double g = 9.81 * (sin(angle) - 0.3 * cos(angle));
    if (_i == 0) { /* it creeps: docs/theory/contact.md */
        ck_assert_double_lt(fabs(speed[1]), 5e-3);
    } else {
        ck_assert_double_eq_tol(4.0 * (speed[1] - speed[0]), g, 0.01 * 9.81);
    }
}
END_TEST

/* Down, and each particle at random by much less. */
static void shift(double *y, double down, uint64_t *seed)
{
    for (size_t i = 0; i < 6 * N; ++i) {
        y[i] += (i < 3 * N ? 1e-4 : 0.1) * (random_uniform(seed) - 0.5);
        y[i] -= i / N == 1 ? down : 0.0;
    }
}

typedef struct meetings {
    weft__stride stride;
    size_t count;
} meetings;

static bool count_meeting(void *ctx, const weft__pair *pair)
{
    meetings *of = ctx;
    double gap;
    of->count += !weft__stride_clear(&of->stride, pair, &gap);
    return true;
}

/* Of random steps from near where the list was made, 2 mm above a ball. */
START_TEST(a_step_that_bounds_of_the_whole_cloth_prove_clear_is_clear)
{
    size_t far = 0, met = 0;
    uint64_t seed = 9;
    const double h = 1e-3;
    def.origin[1] = 0.102;
    put(icosphere(3, 0.1));
    begin(1e-4);
    weft__forces forces = weft__forces_create(cloth, 1, NULL);
    weft__bodies_space *space = forces.spaces[WEFT__FORCE_bodies];
    const double *start = weft_sim_state(sim);
    double y[2][6 * N];
    for (int i = 0; i < 3; ++i) {
        ck_assert_int_eq(weft__forces_rhs(&forces, 0.0, start, y[0]), 0);
        ck_assert_int_eq(weft__self_list_grow(space->list, &err), WEFT_OK);
    }
    for (int i = 0; i < 60; ++i) {
        memcpy(y[0], start, sizeof y[0]);
        shift(y[0], 0.0, &seed);
        memcpy(y[1], y[0], sizeof y[1]);
        shift(y[1], 4e-3 * random_uniform(&seed), &seed);
        const bool clear = weft__self_list_far(space->list, y[0], y[1], h);
        double *all[2]
            = { weft__bodies_spread(&cloth->bodies, &(weft__state){ .y = y[0] }),
                weft__bodies_spread(&cloth->bodies, &(weft__state){ .y = y[1] }) };
        meetings of = { { &cloth->bodies.pairs, all[0], all[1], h }, 0 };
        const weft__quadtree tree = weft__tree_of(&cloth->bodies.pairs, all[0]);
        ck_assert(weft__each_pair(&tree, 0.02, count_meeting, &of));
        ck_assert(!clear || of.count == 0);
        far += clear, met += of.count > 0;
        free(all[0]), free(all[1]);
    }
    ck_assert_uint_gt(far, 5);
    ck_assert_uint_gt(met, 5);
    weft__forces_destroy(&forces);
}
END_TEST

/* Positions after a landing on a ball of facets, without friction and damping. */
static void land_at_once(double h, double *to)
{
    setup();
    def.rows = def.cols = 5;
    def.origin[0] = def.origin[2] = -0.041, def.origin[1] = 0.156;
    def.velocity[1] = -2.0, def.velocity[0] = 0.7;
    def.contact.friction = def.contact.damping = 0.0;
    put(icosphere(3, 0.15));
    springs(20.0, 0.0);
    run.config.fixed_step = h;
    begin(1e-6);
    go(0.02);
    memcpy(to, weft_sim_state(sim), 75 * sizeof *to);
    teardown();
}

static double distance(const double *a, const double *b)
{
    double square = 0.0;
    for (size_t i = 0; i < 75; ++i) {
        square += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(square);
}

START_TEST(a_landing_keeps_the_order)
{
    double exact[75], coarse[75], fine[75];
    land_at_once(3.125e-6, exact);
    land_at_once(5e-5, coarse);
    land_at_once(2.5e-5, fine);
    const double order = log2(distance(coarse, exact) / distance(fine, exact));
    ck_assert_double_ge(order, 4.3);
}
END_TEST

TEST_SUITE(bodies)
{
    Suite *suite = suite_create("bodies");
    TCase *state = tcase_create("state"), *time = tcase_create("time"),
          *slow = test_long(suite, 300.0);
    tcase_add_checked_fixture(state, setup, teardown);
    tcase_add_checked_fixture(time, setup, teardown);
    tcase_add_checked_fixture(slow, setup, teardown);
    tcase_set_timeout(time, 300.0);
    tcase_add_test(state, loads_are_the_forces_that_the_cloth_feels);
    tcase_add_loop_test(state, products_are_those_of_pairs_with_bodies, 0, 3);
    tcase_add_test(state, a_pinned_cloth_feels_no_body);
    tcase_add_test(state, cloth_that_passes_through_a_body_is_named);
    tcase_add_test(state, cloth_in_a_closed_body_is_named_and_in_an_open_one_is_not);
    tcase_add_test(state, a_pinned_cloth_moves_through_a_body);
    tcase_add_test(state, pinned_corners_of_a_start_in_a_body_are_named);
    tcase_add_test(state, a_pinned_patch_may_start_in_a_body);
    tcase_add_loop_test(state, wrong_bodies_are_refused, 0, 7);
    tcase_add_test(state, a_step_that_bounds_of_the_whole_cloth_prove_clear_is_clear);
    tcase_add_test(slow, an_icosphere_bears_a_cloth_as_a_sphere_does);
    tcase_add_test(slow, plates_of_any_cells_stop_a_sheet_at_one_depth);
    tcase_add_loop_test(time, nothing_tunnels_through_two_triangles, 0, 5);
    tcase_add_loop_test(slow, friction_holds_on_a_tilted_facet, 0, 2);
    tcase_add_test(slow, a_landing_keeps_the_order);
    suite_add_tcase(suite, state);
    suite_add_tcase(suite, time);
    return suite;
}
