/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow nightly asan-long */
/* Bounds on stiffness and damping of a cloth's modes: against a dense eigensolver, the
 * force itself, and what is exact. */
#include "bounds_cloths.h"

/* ---- eigenvalues
 * --------------------------------------------------------------------- */

/* -M^-1/2 dF/d(half of y) M^-1/2 of the free particles by central differences, from
 * positions (half 0) or velocities (half 1); exactly symmetric. Returns its size. */
static size_t dense(const weft_cloth *cloth, size_t half, double *a)
{
    const size_t n = weft_cloth_particles(cloth), all = 3 * n;
    double *y = malloc(6 * n * sizeof *y), *f = malloc(12 * n * sizeof *f);
    size_t *free_ = malloc(all * sizeof *free_), size = 0;
    for (size_t j = 0; j < all; ++j) {
        if (!weft_cloth_pinned(cloth, j % n)) {
            free_[size++] = j;
        }
    }
    weft_cloth_start(cloth, y);
    const double delta = 1e-6;
    for (size_t c = 0; c < size; ++c) {
        double *at = &y[half * all + free_[c]];
        const double kept = *at;
        *at = kept + delta;
        weft_cloth_force(cloth, 0.0, y, f);
        *at = kept - delta;
        weft_cloth_force(cloth, 0.0, y, f + all);
        *at = kept;
        for (size_t r = 0; r < size; ++r) {
            const double m = weft_cloth_particle_mass(cloth, free_[r] % n)
                             * weft_cloth_particle_mass(cloth, free_[c] % n);
            a[r * size + c]
                = (f[all + free_[r]] - f[free_[r]]) / (2.0 * delta) / sqrt(m);
        }
    }
    for (size_t r = 0; r < size; ++r) {
        for (size_t c = 0; c < r; ++c) {
            a[r * size + c] = a[c * size + r]
                = 0.5 * (a[r * size + c] + a[c * size + r]);
        }
    }
    free(y);
    free(f);
    free(free_);
    return size;
}

static void rotate(double *a, size_t n, size_t p, size_t q)
{
    const double theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
    const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
    const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    for (size_t k = 0; k < n; ++k) {
        const double x = a[k * n + p], z = a[k * n + q];
        a[k * n + p] = c * x - s * z;
        a[k * n + q] = s * x + c * z;
    }
    for (size_t k = 0; k < n; ++k) {
        const double x = a[p * n + k], z = a[q * n + k];
        a[p * n + k] = c * x - s * z;
        a[q * n + k] = s * x + c * z;
    }
}

/* The largest eigenvalue by cyclic Jacobi sweeps. */
static double jacobi(double *a, size_t n)
{
    for (int sweep = 0; sweep < 12; ++sweep) {
        for (size_t p = 0; p < n; ++p) {
            for (size_t q = p + 1; q < n; ++q) {
                if (a[p * n + q] != 0.0) {
                    rotate(a, n, p, q);
                }
            }
        }
    }
    double most = 0.0;
    for (size_t k = 0; k < n; ++k) {
        most = fmax(most, a[k * n + k]);
    }
    return most;
}

static double largest(const weft_cloth *cloth, size_t half)
{
    const size_t all = 3 * weft_cloth_particles(cloth);
    double *a = malloc(all * all * sizeof *a);
    const size_t size = dense(cloth, half, a);
    const double most = jacobi(a, size);
    free(a);
    return most;
}

START_TEST(bounds_and_power_method_enclose_the_eigenvalues)
{
    if (_i % test_rounds(2, 1) != 0) {
        return; /* the other half if there is time */
    }
    weft_cloth *cloth = make((size_t)_i);
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    weft_cloth_start(cloth, y);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, 0.0, y);
    const weft_stiffness any = weft_cloth_stiffness(cloth, 0.0, NULL);
    weft_stiffness fine;
    ck_assert_int_eq(weft_cloth_stiffness_refined(cloth, 0.0, y, 2000, &fine, NULL),
                     WEFT_OK);
    const double omega2 = largest(cloth, 0), damping = largest(cloth, 1);
    const double differences = 1e-6; /* of the dense matrix, relative */
    ck_assert(bound.omega2 >= (1.0 - differences) * omega2);
    ck_assert(bound.damping >= (1.0 - differences) * damping);
    ck_assert(any.omega2 >= (1.0 - 1e-11) * bound.omega2); /* rounded up */
    ck_assert(any.damping >= (1.0 - 1e-11) * bound.damping);
    ck_assert(fine.omega2 <= (1.0 + differences) * omega2);
    ck_assert(fine.damping <= (1.0 + differences) * damping);
    ck_assert(fine.omega2 >= 0.999 * omega2);
    ck_assert(fine.damping >= 0.999 * damping);
    free(y);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- states, pins, corners
 * ------------------------------------------------------------ */

/* Cloths in all kinds of distress: crumpled, blown up, shrunk to next to nothing. */
START_TEST(bound_for_any_state_holds_in_every_state)
{
    weft_cloth *cloth = make((size_t)_i);
    const size_t n = weft_cloth_particles(cloth);
    double *y = malloc(6 * n * sizeof *y);
    const weft_stiffness any = weft_cloth_stiffness(cloth, 0.0, NULL);
    uint64_t seed = 7;
    for (int k = 0; k < 30; ++k) {
        const double size = pow(10.0, k / 3 - 5);
        for (size_t j = 0; j < 6 * n; ++j) {
            y[j] = size * noise(&seed);
        }
        const weft_stiffness now = weft_cloth_stiffness(cloth, 0.0, y);
        ck_assert(now.omega2 <= (1.0 + 1e-11) * any.omega2);
        ck_assert(now.damping <= (1.0 + 1e-11) * any.damping);
    }
    free(y);
    weft_cloth_destroy(cloth);
}
END_TEST

/* (w2, c) = (x* K x, x* C x) / x* M x of shapes x, the whole cloth's and single
 * particles', by the force itself. */
static bool inside(const weft_stiffness *of, double w2, double c)
{
    for (size_t i = 0; i < of->count; ++i) {
        const double *p = of->corners[i], *q = of->corners[(i + 1) % of->count];
        const double side = (q[0] - p[0]) * (c - p[1]) - (q[1] - p[1]) * (w2 - p[0]);
        const double slack = 1e-5 * of->omega2 * fmax(of->damping, 1.0);
        if (side < -slack) {
            return false;
        }
    }
    return true;
}

START_TEST(polygon_holds_stiffness_and_damping_of_every_shape)
{
    weft_cloth *cloth = make((size_t)_i);
    const size_t n = weft_cloth_particles(cloth), all = 3 * n;
    double *y = malloc(6 * n * sizeof *y), *x = malloc(all * sizeof *x);
    double *f = malloc(3 * all * sizeof *f);
    weft_cloth_start(cloth, y);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, 0.0, y);
    uint64_t seed = 3;
    for (size_t k = 0; k < all + 50; ++k) {
        double mass = 0.0, w2 = 0.0, c = 0.0;
        for (size_t half = 0; half < 2; ++half) {
            for (int sign = 0; sign < 2; ++sign) { /* central differences */
                for (size_t j = 0; j < all; ++j) {
                    x[j] = k < all                  ? (j == k ? 1.0 : 0.0)
                           : half == 0 && sign == 0 ? noise(&seed)
                                                    : x[j];
                    x[j] = weft_cloth_pinned(cloth, j % n) ? 0.0 : x[j];
                    y[half * all + j] += (sign == 0 ? 1e-6 : -2e-6) * x[j];
                }
                weft_cloth_force(cloth, 0.0, y, f + (size_t)sign * all);
            }
            for (size_t j = 0; j < all; ++j) {
                y[half * all + j] += 1e-6 * x[j];
                *(half == 0 ? &w2 : &c) -= x[j] * (f[j] - f[all + j]) / 2e-6;
                mass += 0.5 * weft_cloth_particle_mass(cloth, j % n) * x[j] * x[j];
            }
        }
        if (mass > 0.0) {
            ck_assert_msg(inside(&bound, fmax(0.0, w2 / mass), c / mass),
                          "shape %zu: %g, %g outside", k, w2 / mass, c / mass);
        }
    }
    free(y);
    free(x);
    free(f);
    weft_cloth_destroy(cloth);
}
END_TEST

static weft_cloth_def chain_of_two(void)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 1;
    def.spacing[1] = 0.1;
    def.mass = 0.002;
    def.density = 0.0;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.3 };
    return def;
}

static void expect_bound(const weft_cloth_def *def, double omega2, double damping)
{
    weft_cloth *cloth = test_cloth(def);
    double y[12];
    weft_cloth_start(cloth, y);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, 0.0, y);
    ck_assert_double_le(fabs(bound.omega2 - omega2), 1e-9 * omega2);
    ck_assert_double_le(fabs(bound.damping - damping), 1e-9 * damping);
    weft_cloth_destroy(cloth);
}

/* w2 = k (1/m1 + 1/m2), c = d (1/m1 + 1/m2): a pin has 1/m = 0. */
START_TEST(bound_of_a_single_spring_is_exact_for_any_masses)
{
    const weft_load load = { .rows = { 0, 0 }, .cols = { 1, 1 }, .mass = 0.198 };
    const weft_pin pin = CORNER(0, 0);
    weft_cloth_def def = chain_of_two();
    expect_bound(&def, 100.0 / 0.001, 0.3 / 0.001);
    def.loads = &load;
    def.load_count = 1;
    expect_bound(&def, 100.0 * (500.0 + 5.0), 0.3 * (500.0 + 5.0));
    def.pins = &pin;
    def.pin_count = 1;
    expect_bound(&def, 100.0 * 5.0, 0.3 * 5.0);
    def.damping = 0.1;
    expect_bound(&def, 100.0 * 5.0, 0.3 * 5.0 + 0.1 * 5.0);
    def.pins = (weft_pin[]){ { .rows = ALL, .cols = ALL } };
    expect_bound(&def, 0.0, 0.0);
}
END_TEST

START_TEST(the_power_method_needs_a_state)
{
    const weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = test_cloth(&def);
    weft_stiffness fine;
    ck_assert_int_eq(weft_cloth_stiffness_refined(cloth, 0.0, NULL, 0, &fine, NULL),
                     WEFT_INVALID);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(bound_of_a_state_that_is_not_finite_is_not_finite)
{
    const weft_cloth_def def = chain_of_two();
    weft_cloth *cloth = test_cloth(&def);
    double y[12];
    weft_cloth_start(cloth, y);
    y[1] = (double)NAN;
    const weft_stiffness bound = weft_cloth_stiffness(cloth, 0.0, y);
    ck_assert(!isfinite(bound.omega2));
    weft_stability euler;
    double h = 1.0;
    ck_assert_int_eq(
        weft_stability_create(test_method_named("verlet/euler"), NULL, &euler, NULL),
        WEFT_OK);
    ck_assert_int_eq(weft_stability_step(&euler, &bound, 0.0, &h, NULL), WEFT_OK);
    ck_assert(h == 0.0);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(stiffness)
{
    Suite *suite = suite_create("stiffness");
    TCase *values = tcase_create("values");
    tcase_set_timeout(values, 120.0);
    tcase_add_loop_test(values, bounds_and_power_method_enclose_the_eigenvalues, 0,
                        2 * CLOTHS);
    tcase_add_loop_test(values, bounds_and_power_method_enclose_the_eigenvalues,
                        3 * CLOTHS, 3 * CLOTHS + test_rounds(4, CLOTHS));
    tcase_add_loop_test(values, bound_for_any_state_holds_in_every_state, 0, CLOTHS);
    tcase_add_loop_test(values, bound_for_any_state_holds_in_every_state, 3 * CLOTHS,
                        4 * CLOTHS);
    tcase_add_loop_test(values, polygon_holds_stiffness_and_damping_of_every_shape, 0,
                        4 * CLOTHS);
    tcase_add_test(values, bound_of_a_single_spring_is_exact_for_any_masses);
    tcase_add_test(values, the_power_method_needs_a_state);
    tcase_add_test(values, bound_of_a_state_that_is_not_finite_is_not_finite);
    suite_add_tcase(suite, values);
    return suite;
}
