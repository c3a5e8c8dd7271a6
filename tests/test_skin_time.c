/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow nightly asan-long */
/* test_skin_time.c -- contact of meshes with themselves while time passes: nothing
 * passes through anything, energy and momenta are kept, results keep their bits. */
#include "folded_mesh.h"

#include "cloth/model.h"
#include "forces/contact/self/self_list.h"
#include "one_sim.h"
#include "sim/simulation.h"

enum { MOST = 1200, EDGES = 4 * MOST };

static test_mesh mesh;
static weft_cloth_def model;
static weft_sim_def run;
static weft_shape floor_shape;
static weft_error err;
static double xyz[3 * MOST], speeds[3 * MOST];

static void tolerance(double tol)
{
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = tol;
}

static void setup(void)
{
    run = weft_sim_def_default();
    run.method = test_method_named("arkode/dormand_prince");
    tolerance(1e-4);
}

static void end(void)
{
    teardown();
    mesh_free(&mesh);
    mesh = (test_mesh){ .rows = 0 };
}

/* A square metre of rows^2 random vertices, with edges of 1 : 5. */
static void define(size_t rows, double jitter, uint64_t seed, bool self)
{
    mesh_free(&mesh);
    mesh_sheet(&mesh, rows, rows, 1.0 / (double)(rows - 1), MESH_RANDOM, jitter, seed);
    mesh_shuffle(&mesh, seed + 1, NULL);
    mesh.fabrics[0] = (weft_fabric){ .density = 0.2,
                                     .stretch = { 250.0, 250.0 },
                                     .shear = 50.0,
                                     .bend = { 1e-4, 1e-4 },
                                     .twist = 1e-4,
                                     .damping = { 2e-4, 2e-4 },
                                     .coupling = 50.0 };
    model = mesh_cloth(&mesh);
    model.contact.thickness = 0.5 * mesh_least_height(&mesh);
    model.contact.self = self;
}

static void start(mesh_shape *shape)
{
    teardown();
    mesh_set(&mesh, 1.0, shape, xyz, speeds);
    memcpy(mesh.start, xyz, 3 * mesh.def.vertices * sizeof *xyz);
    cloth = test_cloth(&model);
    run.cloth = cloth;
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    ck_assert_msg(weft_sim_set_state(sim, xyz, speeds, &err) == WEFT_OK, "%s",
                  err.message);
}

static void go(double t)
{
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s", err.message);
}

/* ---- nothing passes through anything --------------------------------------------- */

/* Of p-q and a-b-c in long double, which decides all but what is 1e-19 away. */
static long double side(const double *a, const double *b, const double *c,
                        const double *d)
{
    long double e[3][3];
    for (size_t k = 0; k < 3; ++k) {
        e[0][k] = (long double)b[k] - a[k];
        e[1][k] = (long double)c[k] - a[k];
        e[2][k] = (long double)d[k] - a[k];
    }
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1])
           - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0])
           + e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static bool pierces(const double *p, const double *q, const double *x[3])
{
    if ((side(x[0], x[1], x[2], p) > 0) == (side(x[0], x[1], x[2], q) > 0)) {
        return false;
    }
    const bool first = side(p, q, x[0], x[1]) > 0;
    return (side(p, q, x[1], x[2]) > 0) == first
           && (side(p, q, x[2], x[0]) > 0) == first;
}

/* By all pairs of edges and triangles, and as weft counts them. */
static size_t crossings(void)
{
    static uint32_t ends[EDGES][2];
    const size_t edges = weft_cloth_edges(weft_sim_cloth(sim), &ends[0][0]);
    size_t count = 0;
    weft_sim_positions(sim, xyz);
    for (size_t t = 0; t < mesh.def.triangles; ++t) {
        const uint32_t *c = &mesh.corners[3 * t];
        const double *x[3] = { &xyz[3 * c[0]], &xyz[3 * c[1]], &xyz[3 * c[2]] };
        double low[3], high[3];
        for (size_t k = 0; k < 3; ++k) {
            low[k] = fmin(x[0][k], fmin(x[1][k], x[2][k]));
            high[k] = fmax(x[0][k], fmax(x[1][k], x[2][k]));
        }
        for (size_t e = 0; e < edges; ++e) {
            const uint32_t p = ends[e][0], q = ends[e][1];
            bool apart = p == c[0] || p == c[1] || p == c[2] || q == c[0] || q == c[1]
                         || q == c[2];
            for (size_t k = 0; k < 3; ++k) {
                const double a = xyz[3 * p + k], b = xyz[3 * q + k];
                apart = apart || fmin(a, b) > high[k] || fmax(a, b) < low[k];
            }
            count += !apart && pierces(&xyz[3 * p], &xyz[3 * q], x);
        }
    }
    const size_t said
        = weft_cloth_crossings(weft_sim_cloth(sim), weft_sim_state(sim), NULL);
    ck_assert_uint_eq(said, count);
    return count;
}

static void pile(double u, double v, double x[3], double speed[3])
{
    x[0] = u, x[1] = v + 0.02,
    x[2] = 0.01 * sin(7.0 * u + 5.0 * v) + 0.005 * sin(23.0 * v);
    speed[0] = speed[1] = speed[2] = 0.0;
}

/* Lies, wavy, and turns about its middle. */
static void drop(double u, double v, double x[3], double speed[3])
{
    x[0] = u, x[1] = 0.35 + 0.04 * sin(9.0 * u + 2.0 * v), x[2] = v;
    speed[0] = -6.0 * (x[1] - 0.35), speed[1] = 4.0 * (u - 0.5), speed[2] = 0.0;
}

static void slam(double u, double v, double x[3], double speed[3])
{
    mesh_u(u, v, 0.2, x, speed);
}

static void flat(double u, double v, double x[3], double speed[3])
{
    x[0] = u, x[1] = 0.0, x[2] = v;
    speed[0] = speed[1] = speed[2] = 0.0;
}

/* Half of the sheet turns against the other half. */
static void twist(double u, double v, double x[3], double speed[3])
{
    flat(u, v, x, speed);
    const double by = 30.0 * tanh(8.0 * (u - 0.5));
    speed[1] = -by * (v - 0.5), speed[0] = u < 0.5 ? 3.0 : -3.0;
}

typedef struct course {
    mesh_shape *shape;
    double seconds;
    bool floor;
} course;

static const course courses[] = { { pile, 0.45, true },
                                  { slam, 0.1, false },
                                  { twist, 0.1, false },
                                  { drop, 0.5, true } };
enum { COURSES = sizeof courses / sizeof courses[0] };

/* Crossings of all frames of 1/60 s. */
static size_t crossings_of(const course *of)
{
    size_t count = 0;
    for (int i = 1; i <= (int)(60.0 * of->seconds + 0.5); ++i) {
        go((double)i / 60.0);
        count += crossings();
    }
    return count;
}

static void start_course(int i, size_t rows, bool self)
{
    const course *of = &courses[i % COURSES];
    define(rows, 0.3, (uint64_t)i + 1, self);
    if (of->floor) {
        floor_shape = weft_shape_default(WEFT_PLANE);
        model.contact.shapes = &floor_shape, model.contact.shape_count = 1;
        model.gravity[1] = -9.81;
    }
    start(of->shape);
}

START_TEST(a_mesh_passes_through_itself_without)
{
    start_course(_i, 15, false);
    ck_assert_uint_gt(crossings_of(&courses[_i]), 0);
}
END_TEST

/* 4; `make nightly`: 100. */
START_TEST(a_mesh_never_passes_through_itself)
{
    start_course(_i, _i < 6 ? 15 : 21, true);
    ck_assert_uint_eq(crossings_of(&courses[_i % COURSES]), 0);
    ck_assert_uint_gt(weft_sim_stats(sim).steps, 0);
}
END_TEST

/* ---- physics --------------------------------------------------------------------- */

static void smooth_fold(double u, double v, double x[3], double speed[3])
{
    mesh_u(u, v, 0.2, x, speed);
    x[2] += 0.01 * sin(5.0 * u);
    x[1] += 0.004 * sin(6.0 * v + 3.0 * u);
}

static void define_smooth(uint64_t seed)
{
    define(13, seed % 2 == 0 ? 0.2 : 0.15, seed, true);
    mesh.fabrics[0].damping[0] = mesh.fabrics[0].damping[1] = 0.0;
    mesh.fabrics[0].bend[0] = mesh.fabrics[0].bend[1] = mesh.fabrics[0].twist = 1e-3;
    model.contact.damping = model.contact.friction = 0.0;
    model.contact.thickness = fmin(model.contact.thickness, 0.02);
}

START_TEST(energy_closes_with_the_tolerance_and_momenta_are_kept)
{
    define_smooth(2);
    tolerance(1e-8);
    start(smooth_fold);
    const weft_measures before = weft_sim_measure(sim);
    go(0.27);
    const weft_measures after = weft_sim_measure(sim);
    const double energy = weft_energy_total(before.energy);
    ck_assert_double_le(fabs(weft_energy_total(after.energy) - energy), 3e-8 * energy);
    for (size_t k = 0; k < 3; ++k) {
        ck_assert_double_eq_tol(after.momentum[k], before.momentum[k], 1e-14);
        ck_assert_double_eq_tol(after.angular_momentum[k], before.angular_momentum[k],
                                1e-8);
    }
}
END_TEST

/* ---- the same bits --------------------------------------------------------------- */

static uint64_t hash(void)
{
    return weft_sim_measure(sim).hash;
}

static void start_pile(void)
{
    start_course(0, 25, true);
}

/* weft_cloth_rhs has no list. */
static void expect_rates_without_a_list(void)
{
    static double dydt[2][6 * MOST];
    const double *y = weft_sim_state(sim), t = weft_sim_time(sim);
    const size_t size = 6 * mesh.def.vertices * sizeof(double);
    ck_assert_int_eq(weft__forces_rhs(&sim->forces, t, y, dydt[0]), 0);
    ck_assert_int_eq(weft_cloth_rhs(sim->cloth, t, y, dydt[1]), 0);
    ck_assert_mem_eq(dydt[0], dydt[1], size);
}

START_TEST(a_list_has_the_pairs_of_a_search)
{
    size_t touching = 0;
    start_pile();
    for (size_t i = 0; weft_sim_time(sim) < 0.35; ++i) {
        ck_assert_int_eq(weft_sim_step(sim, 0.35, &err), WEFT_OK);
        if (i % 16 == 0) {
            expect_rates_without_a_list();
            touching += weft_sim_measure(sim).self_touching;
        }
    }
    ck_assert_uint_gt(touching, 1000);
}
END_TEST

START_TEST(neither_threads_nor_skins_nor_instructions_change_results)
{
    uint64_t first = 0;
    for (size_t i = 0; i < 3; ++i) {
        run.config.threads = (size_t)1 << i;
        start_pile();
        if (i > 0) {
            weft__self_list *list = sim->forces.spaces[WEFT__FORCE_self];
            list->skin *= i == 1 ? 0.3 : 3.0;
            weft__cloth_choose(sim->cloth, i == 1 ? (weft__isa)0 : weft__isa_last());
        }
        go(0.3);
        ck_assert_uint_gt(weft_sim_measure(sim).self_touching, 0);
        first = i == 0 ? hash() : first;
        ck_assert_uint_eq(hash(), first);
    }
}
END_TEST

TEST_SUITE(skin_time)
{
    Suite *suite = suite_create("skin_time");
    TCase *apart = tcase_create("apart"), *physics = tcase_create("physics");
    TCase *bits = tcase_create("bits"), *slow = test_long(suite, 300);
    tcase_add_checked_fixture(apart, setup, end);
    tcase_add_checked_fixture(physics, setup, end);
    tcase_add_checked_fixture(bits, setup, end);
    tcase_add_checked_fixture(slow, setup, end);
    tcase_set_timeout(apart, 600), tcase_set_timeout(physics, 300);
    tcase_set_timeout(bits, 300);
    tcase_add_loop_test(apart, a_mesh_passes_through_itself_without, 0, COURSES);
    tcase_add_loop_test(apart, a_mesh_never_passes_through_itself, 0,
                        test_rounds(4, 100));
    tcase_add_test(physics, energy_closes_with_the_tolerance_and_momenta_are_kept);
    tcase_add_test(bits, a_list_has_the_pairs_of_a_search);
    tcase_add_test(slow, neither_threads_nor_skins_nor_instructions_change_results);
    suite_add_tcase(suite, apart);
    suite_add_tcase(suite, physics);
    suite_add_tcase(suite, bits);
    return suite;
}
