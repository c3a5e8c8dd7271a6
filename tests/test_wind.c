/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_wind.c -- the wind on triangles. */
#include "meshes.h"

#include <math.h>

#include "cloth/model.h"

enum { SIDE = 24, N = SIDE * SIDE };

static struct {
    test_mesh mesh;
    weft_cloth *cloth;
    double y[6 * N], f[6 * N], d[6 * N];
} m;

static const double wind[3] = { 3.0, -1.0, 2.0 };

/* A sheet of two blocks that nothing but the wind acts on, flat in x = u, y = v. */
static void setup(void)
{
    mesh_sheet(&m.mesh, SIDE, SIDE, 0.02, MESH_RANDOM, 0.3, 1);
    weft_fabric *of = &m.mesh.fabrics[0];
    of->stretch[0] = of->stretch[1] = 1e-12;
    of->shear = of->coupling = of->bend[0] = of->bend[1] = of->twist = 0.0;
    weft_cloth_def def = mesh_cloth(&m.mesh);
    def.wind_drag = 0.5;
    memcpy(def.wind_velocity, wind, sizeof wind);
    m.cloth = test_cloth(&def);
    weft_cloth_start(m.cloth, m.y);
}

static void teardown(void)
{
    weft_cloth_destroy(m.cloth);
    mesh_free(&m.mesh);
    memset(&m, 0, sizeof m);
}

static void fill(double *to, double scale, size_t count, bool adds)
{
    uint64_t seed = 3;
    for (size_t j = 0; j < count; ++j) {
        to[j] = (adds ? to[j] : 0.0) + scale * (random_uniform(&seed) - 0.5);
    }
}

START_TEST(flat_sheet_feels_the_wind_along_its_normal_alone)
{
    const double area = 0.02 * 0.02 * (SIDE - 1) * (SIDE - 1);
    for (size_t i = 0; i < N; ++i) {
        m.y[3 * N + i] = 7.0, m.y[5 * N + i] = 0.5;
        m.y[i] *= 2.0; /* with its present area */
    }
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    double sum = 0.0;
    for (size_t i = 0; i < N; ++i) {
        ck_assert_double_le(fabs(m.f[i]) + fabs(m.f[N + i]), 1e-12);
        sum += m.f[2 * N + i];
    }
    ck_assert_double_eq_tol(sum, 0.5 * 2.0 * area * (2.0 - 0.5), 1e-13);
}
END_TEST

START_TEST(power_of_the_wind_is_its_force_times_velocity)
{
    double power[WEFT_POWERS], work = 0.0;
    fill(m.y, 0.01, 3 * N, true);
    fill(m.y + 3 * N, 2.0, 3 * N, false);
    weft_cloth_power(m.cloth, 0.0, m.y, power);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * N; ++j) {
        work += m.f[j] * m.y[3 * N + j];
    }
    ck_assert_double_eq_tol(power[WEFT_POWER_WIND] / work, 1.0, 1e-9);
}
END_TEST

/* By the quotient of the worst direction: along the normal of a flat sheet. */
START_TEST(bound_of_damping_holds_and_is_reached)
{
    for (size_t i = 0; i < N; ++i) {
        m.y[i] *= 1.1, m.y[N + i] *= 1.1;
        m.d[3 * N + i] = m.d[4 * N + i] = 0.0, m.d[5 * N + i] = 1.0;
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(m.cloth, 0.0, m.y, m.d, m.f), 0);
    double work = 0.0, mass = 0.0;
    for (size_t i = 0; i < N; ++i) {
        work -= m.cloth->mesh.mass[i] * m.f[5 * N + i];
        mass += m.cloth->mesh.mass[i];
    }
    const double bound = weft_cloth_stiffness(m.cloth, 0.0, m.y).damping;
    ck_assert_double_eq_tol(bound / (work / mass), 1.0, 1e-6);
    ck_assert_double_eq_tol(weft_cloth_stiffness(m.cloth, 0.0, NULL).damping / bound,
                            1.0, 1e-6);
}
END_TEST

START_TEST(folded_triangle_of_no_area_feels_no_wind)
{
    for (size_t j = 0; j < 3 * N; ++j) {
        m.y[j] = 1.0;
    }
    const weft__state at = { .y = m.y };
    memset(m.f, 0, sizeof m.f);
    ck_assert_int_eq(weft__wind_force.law.add(&m.cloth->wind, &at, WEFT__FORCE, m.f, 0,
                                              weft__blocks(&m.cloth->mesh)),
                     0);
    for (size_t j = 0; j < 3 * N; ++j) {
        ck_assert(m.f[j] == 0.0);
    }
}
END_TEST

/* ---- that changes ---------------------------------------------------------------- */

static weft_cloth_def sail_def(bool grid, const weft_pin *pin)
{
    weft_cloth_def def = mesh_cloth(&m.mesh);
    if (grid) {
        def.mesh = NULL;
        def.rows = def.cols = 8;
        def.spacing[0] = def.spacing[1] = 0.1;
        def.springs[WEFT_STRETCH]
            = (weft_spring_def){ .present = true, .stiffness = 20.0 };
        def.pins = pin, def.pin_count = 1;
    }
    def.damping = 1e-3;
    return def;
}

static weft_sim *sail_sim(const weft_cloth *of, const char *method, size_t threads)
{
    weft_stepper_config config = weft_stepper_config_default();
    const weft_stepper_type *type = test_method_named(method);
    config.fixed_step = (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 1e-3 : 0.0;
    config.threads = threads;
    return test_sim(of, type, &config);
}

static void fine(weft_status status)
{
    ck_assert_int_eq(status, WEFT_OK);
}

/* From the start on it is that of the definition, for every kind of stepper. */
START_TEST(a_wind_that_was_set_is_the_wind_of_a_definition)
{
    static const char *const methods[]
        = { "verlet/velocity_verlet", "verlet/midpoint", "stiff/ros2" };
    const weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    for (size_t k = 0; k < 6; ++k) {
        weft_cloth_def def = sail_def(k % 2 == 0, &pin);
        weft_cloth *still = test_cloth(&def);
        memcpy(def.wind_velocity, wind, sizeof wind);
        def.wind_drag = 0.5;
        weft_cloth *windy = test_cloth(&def);
        weft_sim *a = sail_sim(still, methods[k / 2], 1),
                 *b = sail_sim(windy, methods[k / 2], 1);
        const size_t size = weft_cloth_dim(windy) * sizeof(double);
        fine(weft_sim_set_wind(a, wind, 0.5, NULL));
        fine(weft_sim_advance(a, 0.05, NULL));
        fine(weft_sim_advance(b, 0.05, NULL));
        ck_assert_mem_eq(weft_sim_state(a), weft_sim_state(b), size);
        fine(weft_sim_set_wind(a, NULL, 0.0, NULL)); /* calm, as it was defined */
        fine(weft_sim_set_wind(b, (const double[3]){ 0.0 }, 0.0, NULL));
        fine(weft_sim_advance(a, 0.1, NULL));
        fine(weft_sim_advance(b, 0.1, NULL));
        ck_assert_mem_eq(weft_sim_state(a), weft_sim_state(b), size);
        weft_sim_destroy(a);
        weft_sim_destroy(b);
        weft_cloth_destroy(still);
        weft_cloth_destroy(windy);
    }
}
END_TEST

START_TEST(a_wind_that_makes_no_sense_changes_nothing)
{
    const double wrong[3] = { 1.0, (double)NAN, 0.0 };
    weft_error err = { 0 };
    weft_sim *a = sail_sim(m.cloth, "verlet/velocity_verlet", 1);
    weft_sim *b = sail_sim(m.cloth, "verlet/velocity_verlet", 1);
    ck_assert_int_eq(weft_sim_set_wind(a, wrong, 0.1, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "must be finite"));
    ck_assert_int_eq(weft_sim_set_wind(a, wind, -0.1, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_set_wind(a, wind, (double)INFINITY, &err), WEFT_INVALID);
    fine(weft_sim_advance(a, 0.05, NULL));
    fine(weft_sim_advance(b, 0.05, NULL));
    ck_assert_mem_eq(weft_sim_state(a), weft_sim_state(b), sizeof m.y);
    weft_sim_destroy(a);
    weft_sim_destroy(b);
}
END_TEST

/* One on the same cloth goes on in the old wind; one made of the other's cloth has the
 * new wind as its own, which later changes of the other leave alone. */
START_TEST(every_simulation_has_its_own_wind)
{
    weft_sim *changed = sail_sim(m.cloth, "verlet/velocity_verlet", 1);
    weft_sim *kept = sail_sim(m.cloth, "verlet/velocity_verlet", 1);
    weft_sim *alone = sail_sim(m.cloth, "verlet/velocity_verlet", 1);
    const double gust[3] = { 0.0, 0.0, 9.0 };
    fine(weft_sim_set_wind(changed, gust, 1.0, NULL));
    weft_sim *heir = sail_sim(weft_sim_cloth(changed), "verlet/velocity_verlet", 1);
    fine(weft_sim_set_wind(heir, wind, 0.5, NULL));
    fine(weft_sim_set_wind(changed, wind, 0.5, NULL));
    fine(weft_sim_set_wind(heir, NULL, 0.0, NULL));
    fine(weft_sim_set_wind(alone, gust, 1.0, NULL));
    weft_sim *const all[] = { changed, kept, alone, heir };
    for (size_t i = 0; i < 4; ++i) {
        fine(weft_sim_advance(all[i], 0.05, NULL));
    }
    ck_assert_mem_eq(weft_sim_state(changed), weft_sim_state(kept), sizeof m.y);
    ck_assert_mem_eq(weft_sim_state(heir), weft_sim_state(alone), sizeof m.y);
    ck_assert_mem_ne(weft_sim_state(heir), weft_sim_state(kept), sizeof m.y);
    weft_sim_destroy(heir);
    weft_sim_destroy(changed);
    weft_sim_destroy(kept);
    weft_sim_destroy(alone);
}
END_TEST

TEST_SUITE(wind)
{
    Suite *suite = suite_create("wind");
    TCase *tcase = tcase_create("wind");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, flat_sheet_feels_the_wind_along_its_normal_alone);
    tcase_add_test(tcase, power_of_the_wind_is_its_force_times_velocity);
    tcase_add_test(tcase, bound_of_damping_holds_and_is_reached);
    tcase_add_test(tcase, folded_triangle_of_no_area_feels_no_wind);
    tcase_add_test(tcase, a_wind_that_was_set_is_the_wind_of_a_definition);
    tcase_add_test(tcase, a_wind_that_makes_no_sense_changes_nothing);
    tcase_add_test(tcase, every_simulation_has_its_own_wind);
    suite_add_tcase(suite, tcase);
    return suite;
}
