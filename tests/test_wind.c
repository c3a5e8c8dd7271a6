/* SPDX-License-Identifier: BSD-3-Clause */
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

START_TEST(product_is_the_derivative_of_the_wind)
{
    static double z[6 * N], ahead[6 * N], behind[6 * N];
    const double step = 1e-7;
    fill(m.y, 0.01, 3 * N, true);
    fill(m.y + 3 * N, 2.0, 3 * N, false);
    fill(m.d, 1.0, 6 * N, false);
    for (size_t j = 0; j < 6 * N; ++j) {
        z[j] = m.y[j] + step * m.d[j];
    }
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, z, ahead), 0);
    for (size_t j = 0; j < 6 * N; ++j) {
        z[j] = m.y[j] - step * m.d[j];
    }
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, z, behind), 0);
    ck_assert_int_eq(weft_cloth_jacobian_product(m.cloth, 0.0, m.y, m.d, m.f), 0);
    double most = 0.0;
    for (size_t j = 3 * N; j < 6 * N; ++j) {
        most = fmax(most, fabs(m.f[j]));
    }
    ck_assert_double_gt(most, 10.0);
    for (size_t j = 3 * N; j < 6 * N; ++j) {
        ck_assert_double_eq_tol(m.f[j] / most,
                                (ahead[j] - behind[j]) / (2.0 * step) / most, 1e-7);
    }
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
    ck_assert_int_eq(weft__wind_force.add(&m.cloth->wind, &at, WEFT__FORCE, m.f, 0,
                                          weft__blocks(&m.cloth->mesh)),
                     0);
    for (size_t j = 0; j < 3 * N; ++j) {
        ck_assert(m.f[j] == 0.0);
    }
}
END_TEST

TEST_SUITE(wind)
{
    Suite *suite = suite_create("wind");
    TCase *tcase = tcase_create("wind");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, flat_sheet_feels_the_wind_along_its_normal_alone);
    tcase_add_test(tcase, power_of_the_wind_is_its_force_times_velocity);
    tcase_add_test(tcase, product_is_the_derivative_of_the_wind);
    tcase_add_test(tcase, bound_of_damping_holds_and_is_reached);
    tcase_add_test(tcase, folded_triangle_of_no_area_feels_no_wind);
    suite_add_tcase(suite, tcase);
    return suite;
}
