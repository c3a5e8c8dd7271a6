/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* Cloth that is free of bending where it starts: its equilibrium, momenta, energy and
 * damping, derivatives, bounds, threads and saved states. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth/model.h"
#include "random.h"
#include "surfaces.h"

static const weft_rest kept = { .shape = WEFT_REST_START, .angle = WEFT_ANGLE_START };
static const weft_rest flat
    = { .shape = WEFT_REST_START, .angle = WEFT_ANGLE_FLAT, .warp = { 0.2, 1.0, 0.3 } };
static const weft_rest warped = { .shape = WEFT_REST_START, .warp = { 0.2, 1.0, 0.3 } };

/* A band or a sphere, with bending that matters and damping of it. */
static struct {
    surface of;
    weft_cloth *cloth;
    size_t n;
    double *y, *f;
} m;

static void make(size_t kind, const weft_rest *rest, double tau)
{
    if (kind % 2 == 0) {
        make_moebius(&m.of, 20, 4, 0.4);
    } else {
        make_sphere(&m.of, 2, 0.2);
    }
    m.of.fabric.bend[0] = 2.0, m.of.fabric.bend[1] = 5.0, m.of.fabric.twist = 3.0;
    m.of.fabric.damping[1] = tau;
    surface_point(&m.of, rest);
    m.n = m.of.vertices;
    m.cloth = surface_cloth(&m.of.def);
    m.y = surface_state(m.cloth, m.of.start, NULL);
    m.f = calloc(6 * m.n, sizeof *m.f);
}

static void drop(void)
{
    surface_free(&m.of);
    free(m.y);
    free(m.f);
    weft_cloth_destroy(m.cloth);
    memset(&m, 0, sizeof m);
}

static void noise(double *x, size_t count, double size, uint64_t seed)
{
    for (size_t j = 0; j < count; ++j) {
        x[j] += size * (2.0 * random_uniform(&seed) - 1.0);
    }
}

static double bend_energy(const double *y)
{
    return weft_cloth_energy(m.cloth, 0.0, y).elastic[WEFT_BEND];
}

/* What flat angles would have there. */
static double flat_energy(size_t kind)
{
    drop();
    make(kind, &flat, 0.0);
    const double found = bend_energy(m.y);
    drop();
    return found;
}

/* ---- the start ------------------------------------------------------------------- */

START_TEST(the_start_has_no_force)
{
    const size_t kind = (size_t)_i;
    make(kind, kind < 2 ? &kept : &warped, 0.1);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    const double force = surface_largest(m.f, 3 * m.n), energy = bend_energy(m.y);
    const double whole = flat_energy(kind);
    ck_assert_double_gt(whole, 1.0);
    ck_assert_double_le(force, 1e-11 * whole);
    ck_assert_double_le(fabs(energy), 1e-12 * whole);
}
END_TEST

/* As it is, or turned and moved. */
START_TEST(energy_turns_with_the_cloth)
{
    const double c = cos(0.7), s = sin(0.7);
    make((size_t)_i, &warped, 0.0);
    noise(m.y, 3 * m.n, 0.01, 5);
    const double before = bend_energy(m.y);
    for (size_t i = 0; i < m.n; ++i) {
        double *x = m.y + i;
        const double a = x[0], b = x[m.n], d = x[2 * m.n];
        x[0] = c * a - s * d + 0.3;
        x[2 * m.n] = c * (s * a + c * d) - s * b;
        x[m.n] = s * (s * a + c * d) + c * b - 0.1;
    }
    ck_assert_double_gt(before, 1e-3);
    ck_assert_double_eq_tol(bend_energy(m.y) / before, 1.0, 1e-10);
    drop();
}
END_TEST

/* Elastic forces; those of damping keep the linear one. */
START_TEST(forces_keep_both_momenta)
{
    double sum[6] = { 0.0 }, size = 0.0;
    make((size_t)_i, &warped, _i < 2 ? 0.0 : 0.05);
    noise(m.y, 3 * m.n, 0.02, 5);
    noise(m.y + 3 * m.n, 3 * m.n, 1.0, 6);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t i = 0; i < m.n; ++i) {
        const double *x = m.y + i, *f = m.f + i;
        for (size_t k = 0; k < 3; ++k) {
            const size_t a = (k + 1) % 3 * m.n, b = (k + 2) % 3 * m.n;
            sum[k] += f[k * m.n];
            sum[3 + k] += x[a] * f[b] - x[b] * f[a];
            size += fabs(f[k * m.n]);
        }
    }
    ck_assert_double_gt(size, 0.0);
    ck_assert_double_le(surface_largest(sum, _i < 2 ? 6 : 3), 1e-13 * size);
    drop();
}
END_TEST

/* With flat angles the same turn is braked. */
START_TEST(a_rigid_turn_is_not_braked)
{
    double power[2];
    for (size_t k = 0; k < 2; ++k) {
        double powers[WEFT_POWERS];
        make((size_t)_i, k == 0 ? &warped : &flat, 0.1);
        for (size_t i = 0; i < m.n; ++i) { /* about z */
            m.y[3 * m.n + i] = -m.y[m.n + i];
            m.y[4 * m.n + i] = m.y[i];
        }
        weft_cloth_power(m.cloth, 0.0, m.y, powers);
        power[k] = powers[WEFT_POWER_SPRINGS];
        drop();
    }
    ck_assert_double_gt(power[1], 0.1);
    ck_assert_double_le(fabs(power[0]), 1e-12 * power[1]);
}
END_TEST

/* ---- derivatives ----------------------------------------------------------------- */

START_TEST(the_force_is_less_the_slope_of_the_energy)
{
    make((size_t)_i, &warped, 0.0);
    noise(m.y, 3 * m.n, 0.02, 7);
    double *d = calloc(6 * m.n, sizeof *d), work = 0.0, at[2];
    noise(d, 3 * m.n, 1.0, 8);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        work -= m.f[j] * d[j];
    }
    for (size_t k = 0; k < 2; ++k) {
        double *z = malloc(6 * m.n * sizeof *z);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            z[j] = m.y[j] + (k == 0 ? -1e-6 : 1e-6) * d[j];
        }
        const weft_energy of = weft_cloth_energy(m.cloth, 0.0, z);
        at[k] = weft_energy_total(of);
        free(z);
    }
    ck_assert_double_eq_tol((at[1] - at[0]) / 2e-6 / work, 1.0, 1e-7);
    free(d);
    drop();
}
END_TEST

/* J d against differences, and w.(J d) against d.(J^T w). */
START_TEST(products_are_differences_and_have_a_transpose)
{
    make((size_t)_i, &warped, 0.02);
    const size_t n = m.n;
    double *room = calloc(30 * n, sizeof *room), *d = room, *w = room + 6 * n;
    double *product = room + 12 * n, *ahead = room + 18 * n, *z = room + 24 * n;
    noise(m.y, 3 * n, 0.02, 7);
    noise(m.y + 3 * n, 3 * n, 0.5, 9);
    noise(d, 6 * n, 1.0, 8);
    noise(w, 6 * n, 1.0, 18);
    ck_assert_int_eq(weft_cloth_jacobian_product(m.cloth, 0.0, m.y, d, product), 0);
    for (size_t k = 0; k < 2; ++k) {
        for (size_t j = 0; j < 6 * n; ++j) {
            z[j] = m.y[j] + (k == 0 ? 1e-6 : -1e-6) * d[j];
        }
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, z, k == 0 ? ahead : m.f), 0);
    }
    const double most = surface_largest(product, 6 * n);
    double forth = 0.0, back = 0.0;
    for (size_t j = 0; j < 6 * n; ++j) {
        const double slope = (ahead[j] - m.f[j]) / 2e-6;
        ck_assert_double_eq_tol(product[j] / most, slope / most, 1e-7);
        forth += w[j] * product[j];
    }
    ck_assert_int_eq(
        weft_cloth_jacobian_product_transposed(m.cloth, 0.0, m.y, w, ahead), 0);
    for (size_t j = 0; j < 6 * n; ++j) {
        back += d[j] * ahead[j];
    }
    ck_assert_double_eq_tol(back / forth, 1.0, 1e-9);
    free(room);
    drop();
}
END_TEST

/* By the modulus of bending: half and twice as much, and what the central difference
 * of the two is by their span, which is exact as the force is linear in it. */
START_TEST(a_derivative_by_bending_is_the_force_per_modulus)
{
    make((size_t)_i, &kept, 0.0);
    noise(m.y, 3 * m.n, 0.02, 7);
    m.of.fabric.stretch[0] = m.of.fabric.stretch[1] = 1e-9;
    m.of.fabric.shear = m.of.fabric.coupling = 0.0;
    weft_cloth *of[3];
    for (size_t k = 0; k < 3; ++k) {
        const double part = k == 0 ? 0.5 : k == 1 ? 1.5 : 1.0;
        m.of.fabric.bend[0] = m.of.fabric.bend[1] = m.of.fabric.twist = part;
        of[k] = surface_cloth(&m.of.def);
    }
    double *slope = calloc(6 * m.n, sizeof *slope);
    ck_assert_int_eq(weft_cloth_parameter_product(of[0], of[1], 1.0, 0.0, m.y, slope),
                     0);
    ck_assert_int_eq(weft_cloth_rhs(of[2], 0.0, m.y, m.f), 0);
    const double most = surface_largest(m.f + 3 * m.n, 3 * m.n);
    ck_assert_double_gt(most, 1.0);
    for (size_t j = 3 * m.n; j < 6 * m.n; ++j) {
        ck_assert_double_eq_tol(slope[j] / most, m.f[j] / most, 1e-7);
    }
    for (size_t k = 0; k < 3; ++k) {
        weft_cloth_destroy(of[k]);
    }
    free(slope);
    drop();
}
END_TEST

/* ---- bounds ---------------------------------------------------------------------- */

START_TEST(bounds_hold_and_are_near)
{
    weft_stiffness found;
    for (size_t k = 0; k < 3; ++k) {
        make((size_t)_i, &warped, 1e-3);
        noise(m.y, 3 * m.n, k == 0 ? 0.0 : 0.02 * (double)k, 11);
        const double bound = weft_cloth_stiffness(m.cloth, 0.0, m.y).omega2;
        ck_assert_int_eq(
            weft_cloth_stiffness_refined(m.cloth, 0.0, m.y, 300, &found, NULL),
            WEFT_OK);
        const double part = bound / found.omega2;
        ck_assert_msg(part >= 1.0 && part <= 5.0, "state %zu: %g", k, part);
        if (k == 0) {
            ck_assert_double_ge(weft_cloth_stiffness(m.cloth, 0.0, NULL).omega2,
                                found.omega2);
        }
        drop();
    }
}
END_TEST

TEST_SUITE(angles)
{
    Suite *suite = suite_create("angles");
    TCase *tc = tcase_create("angles");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, the_start_has_no_force, 0, 4);
    tcase_add_loop_test(tc, energy_turns_with_the_cloth, 0, 2);
    tcase_add_loop_test(tc, forces_keep_both_momenta, 0, 4);
    tcase_add_loop_test(tc, a_rigid_turn_is_not_braked, 0, 2);
    tcase_add_loop_test(tc, the_force_is_less_the_slope_of_the_energy, 0, 2);
    tcase_add_loop_test(tc, products_are_differences_and_have_a_transpose, 0, 2);
    tcase_add_loop_test(tc, a_derivative_by_bending_is_the_force_per_modulus, 0, 2);
    tcase_add_loop_test(tc, bounds_hold_and_are_near, 0, 2);
    suite_add_tcase(suite, tc);
    return suite;
}
