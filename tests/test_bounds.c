/* SPDX-License-Identifier: BSD-3-Clause */
/* Bounds on the modes of a cloth: against a dense eigensolver, and the steps that
 * follow from them against runs that do or do not blow up. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CORNER(r, c)                                                                   \
    {                                                                                  \
        .rows = { r, r }, .cols = { c, c }                                             \
    }
#define ALL                                                                            \
    {                                                                                  \
        0, -1                                                                          \
    }

static const weft_pin corners[] = { CORNER(0, 0), CORNER(0, -1) };
static const weft_pin rim[] = { { .rows = { 0, 0 }, .cols = ALL },
                                { .rows = { -1, -1 }, .cols = ALL },
                                { .rows = ALL, .cols = { 0, 0 } },
                                { .rows = ALL, .cols = { -1, -1 } } };
static const weft_load loads[]
    = { { .rows = { 3, 3 }, .cols = { 2, 2 }, .mass = 0.05 },
        { .rows = { 0, 1 }, .cols = { 4, 4 }, .mass = 1e-3 } };

/* All of them at rest in equilibrium: without gravity. */
static const weft_cloth_def cloths[] = {
    /* stretch springs alone, equal masses */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { true, 100, 0 } } },
    /* two families, more columns than rows, pinned corners */
    { .rows = 6,
      .cols = 8,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .pins = corners,
      .pin_count = 2,
      .springs = { { true, 100, 0 }, { true, 50, 0 } } },
    /* all three families */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { true, 100, 0 }, { true, 100, 0 }, { true, 100, 0 } } },
    /* oblong cells, masses of a half and a quarter on the rim */
    { .rows = 7,
      .cols = 6,
      .spacing = { 0.05, 0.1 },
      .density = 0.2,
      .springs = { { true, 100, 0 }, { true, 50, 0 }, { true, 5, 0 } } },
    /* loads */
    { .rows = 7,
      .cols = 6,
      .spacing = { 0.1, 0.1 },
      .density = 0.2,
      .loads = loads,
      .load_count = 2,
      .springs = { { true, 100, 0 }, { true, 50, 0 } } },
    /* taut in a frame */
    { .rows = 8,
      .cols = 8,
      .spacing = { 0.1, 0.1 },
      .scale = 1.2,
      .mass = 1e-3,
      .pins = rim,
      .pin_count = 4,
      .springs = { { true, 100, 0.02 }, { true, 50, 0.01 } } },
    /* the strain law, damped alike along columns and rows but not diagonals */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .law = WEFT_LAW_STRAIN,
      .pins = corners,
      .pin_count = 2,
      .springs = { { true, 10, 0.05 }, { true, 5, 0.05 } } },
    /* damping in proportion to stiffness */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .density = 0.2,
      .pins = corners,
      .pin_count = 2,
      .springs = { { true, 100, 0.2 }, { true, 50, 0.1 }, { true, 5, 0.01 } } },
    /* damping of one family only */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { true, 100, 0.1 }, { true, 60, 0 } } },
    /* over-damped springs */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { true, 100, 1.5 }, { true, 50, 0.75 } } },
    /* a chain, and the drag of treacle */
    { .rows = 1,
      .cols = 30,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .drag = 1.0,
      .springs = { { true, 100, 0 } } },
    /* a chain with bend springs and drag */
    { .rows = 1,
      .cols = 30,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .drag = 0.1,
      .springs = { { true, 100, 0.05 }, { false, 0, 0 }, { true, 30, 0.01 } } },
};

enum { CLOTHS = sizeof cloths / sizeof cloths[0] };

static weft_cloth *make(size_t i)
{
    const weft_cloth_def usual = weft_cloth_def_default();
    weft_cloth_def def = cloths[i];
    memcpy(def.right, usual.right, sizeof def.right);
    memcpy(def.down, usual.down, sizeof def.down);
    def.scale = def.scale == 0.0 ? 1.0 : def.scale;
    return test_cloth(&def);
}

/* ---- runs ---------------------------------------------------------------------------
 */

/* In (-1, 1). */
static double noise(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* Whether a displacement of 1e-9 m grows ten thousand fold in 1500 steps. */
static bool blows_up(const weft_cloth *cloth, const weft_stepper_type *type, double h)
{
    const size_t n = weft_cloth_particles(cloth);
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = h;
    weft_sim *sim = test_sim(cloth, type, &config);
    double *rest = malloc(6 * n * sizeof *rest), *x = malloc(3 * n * sizeof *x);
    uint64_t seed = 1;
    weft_cloth_start(cloth, rest);
    weft_sim_positions(sim, x);
    for (size_t j = 0; j < 3 * n; ++j) {
        x[j] += 1e-9 * noise(&seed);
    }
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, NULL), WEFT_OK);
    double most = 0.0;
    for (int i = 0; i < 1500 && most < 1e-5; ++i) {
        if (weft_sim_step(sim, 1e9, NULL) != WEFT_OK) {
            most = INFINITY;
        }
        const double *y = weft_sim_state(sim);
        for (size_t j = 0; j < 3 * n; ++j) {
            most = fmax(most, fabs(y[j] - rest[j]));
        }
    }
    free(rest);
    free(x);
    weft_sim_destroy(sim);
    return !(most < 1e-5);
}

static double stable_step(const weft_stiffness *modes, const weft_stepper_type *type)
{
    weft_stability stability;
    double h;
    ck_assert_int_eq(weft_stability_create(type, NULL, &stability, NULL), WEFT_OK);
    ck_assert_int_eq(weft_stability_step(&stability, modes, 0.0, &h, NULL), WEFT_OK);
    return h;
}

/* The step between safe and 2 safe from which on runs blow up. */
static double true_limit(const weft_cloth *cloth, const weft_stepper_type *type,
                         double safe)
{
    double low = safe, high = 2.0 * safe;
    for (int i = 0; i < 8; ++i) {
        const double middle = 0.5 * (low + high);
        *(blows_up(cloth, type, middle) ? &high : &low) = middle;
    }
    return high;
}

static void bound_is_safe_and_close(size_t i, const char *label)
{
    const weft_stepper_type *type = test_method_named(label);
    weft_cloth *cloth = make(i);
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    weft_cloth_start(cloth, y);
    const weft_stiffness modes = weft_cloth_stiffness(cloth, y);
    const double h = stable_step(&modes, type);
    ck_assert_msg(!blows_up(cloth, type, h), "cloth %zu blows up at %g s", i, h);
    const double limit = true_limit(cloth, type, h);
    ck_assert_msg(h >= 0.75 * limit, "cloth %zu: bound %g s of %g s", i, h, limit);
    free(y);
    weft_cloth_destroy(cloth);
}

START_TEST(stable_step_of_symplectic_euler_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close((size_t)_i, "verlet/symplectic_euler");
}
END_TEST

START_TEST(stable_step_of_velocity_verlet_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close((size_t)_i, "verlet/velocity_verlet");
}
END_TEST

#ifdef HAVE_ARKODE
START_TEST(stable_step_of_rk4_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close((size_t)_i, "arkode/rk4");
}
END_TEST
#endif

#ifdef HAVE_GSL
START_TEST(stable_step_of_third_order_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close((size_t)_i, "gsl/rk2");
}
END_TEST
#endif

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
        weft_cloth_force(cloth, y, f);
        *at = kept - delta;
        weft_cloth_force(cloth, y, f + all);
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
    weft_cloth *cloth = make((size_t)_i);
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    weft_cloth_start(cloth, y);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, y);
    const weft_stiffness any = weft_cloth_stiffness(cloth, NULL);
    weft_stiffness fine;
    ck_assert_int_eq(weft_cloth_stiffness_refined(cloth, y, 2000, &fine, NULL),
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
    const weft_stiffness any = weft_cloth_stiffness(cloth, NULL);
    uint64_t seed = 7;
    for (int k = 0; k < 30; ++k) {
        const double size = pow(10.0, k / 3 - 5);
        for (size_t j = 0; j < 6 * n; ++j) {
            y[j] = size * noise(&seed);
        }
        const weft_stiffness now = weft_cloth_stiffness(cloth, y);
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
    const weft_stiffness bound = weft_cloth_stiffness(cloth, y);
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
                weft_cloth_force(cloth, y, f + (size_t)sign * all);
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
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.3 };
    return def;
}

static void expect_bound(const weft_cloth_def *def, double omega2, double damping)
{
    weft_cloth *cloth = test_cloth(def);
    double y[12];
    weft_cloth_start(cloth, y);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, y);
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
    def.drag = 0.1;
    expect_bound(&def, 100.0 * 5.0, 0.3 * 5.0 + 0.1 * 5.0);
    def.pins = (weft_pin[]){ { .rows = ALL, .cols = ALL } };
    expect_bound(&def, 0.0, 0.0);
}
END_TEST

START_TEST(bound_of_a_state_that_is_not_finite_is_not_finite)
{
    const weft_cloth_def def = chain_of_two();
    weft_cloth *cloth = test_cloth(&def);
    double y[12];
    weft_cloth_start(cloth, y);
    y[1] = (double)NAN;
    const weft_stiffness bound = weft_cloth_stiffness(cloth, y);
    ck_assert(!isfinite(bound.omega2));
    ck_assert(stable_step(&bound, test_method_named("verlet/euler")) == 0.0);
    weft_cloth_destroy(cloth);
}
END_TEST

static Suite *suite(void)
{
    Suite *suite = suite_create("bounds");
    TCase *steps = tcase_create("steps");
    tcase_set_timeout(steps, 120.0);
    tcase_add_loop_test(
        steps, stable_step_of_symplectic_euler_is_safe_and_within_a_quarter, 0, CLOTHS);
    tcase_add_loop_test(
        steps, stable_step_of_velocity_verlet_is_safe_and_within_a_quarter, 0, CLOTHS);
#ifdef HAVE_ARKODE
    tcase_add_loop_test(steps, stable_step_of_rk4_is_safe_and_within_a_quarter, 0,
                        CLOTHS);
#endif
#ifdef HAVE_GSL
    tcase_add_loop_test(steps, stable_step_of_third_order_is_safe_and_within_a_quarter,
                        0, CLOTHS);
#endif
    suite_add_tcase(suite, steps);
    TCase *values = tcase_create("values");
    tcase_set_timeout(values, 120.0);
    tcase_add_loop_test(values, bounds_and_power_method_enclose_the_eigenvalues, 0,
                        CLOTHS);
    tcase_add_loop_test(values, bound_for_any_state_holds_in_every_state, 0, CLOTHS);
    tcase_add_loop_test(values, polygon_holds_stiffness_and_damping_of_every_shape, 0,
                        CLOTHS);
    tcase_add_test(values, bound_of_a_single_spring_is_exact_for_any_masses);
    tcase_add_test(values, bound_of_a_state_that_is_not_finite_is_not_finite);
    suite_add_tcase(suite, values);
    return suite;
}

int main(void)
{
    return test_run(suite());
}
