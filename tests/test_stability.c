/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow together asan-long */
/* The largest stable step of a method: against published and closed forms, and against
 * runs of every method. */
#include "stepper_run.h"

static weft_stability stability_of(const weft_stepper_type *type)
{
    const weft_stepper_config config = test_config(type, fixed(1.0));
    weft_stability out;
    weft_error err = { 0 };
    const weft_status status = weft_stability_create(type, config.butcher, &out, &err);
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
    return out;
}

/* Of one mode alone. */
static double limit(const weft_stability *of, double w2, double c, double growth)
{
    const weft_stiffness mode
        = { .omega2 = w2, .damping = c, .count = 1, .corners = { { w2, c } } };
    double h = -1.0;
    ck_assert_int_eq(weft_stability_step(of, &mode, growth, &h, NULL), WEFT_OK);
    return h;
}

static bool has_stable_step(const weft_stepper_type *type)
{
    return (type->flags
            & (WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_MULTISTEP | WEFT_STEPPER_STRUCTURE))
           == 0;
}

/* R(z) = e^z up to the order, by definition of the order. */
START_TEST(polynomial_agrees_with_exp_up_to_the_order)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!has_stable_step(type)) {
        const bool asked = test_needs_damping(type);
        weft_stability out;
        ck_assert_int_eq(weft_stability_create(type, NULL, &out, NULL),
                         asked ? WEFT_OK : WEFT_UNSUPPORTED);
        return;
    }
    const weft_stability of = stability_of(type);
    const int order = type->order > 0 ? type->order : 4; /* of Merson's table */
    double factorial = 1.0;
    for (int k = 0; of.degree >= 0 && k <= order; ++k) {
        factorial *= k > 0 ? k : 1;
        ck_assert_double_eq_tol(of.r[k] * factorial, 1.0, 1e-9);
    }
    const bool partitioned
        = strstr(test_method_label((size_t)_i), "symplectic") != NULL
          || strstr(test_method_label((size_t)_i), "verlet/velocity") != NULL;
    ck_assert_int_eq(of.degree < 0, partitioned);
    ck_assert(type->stages == 0 || of.calls == type->stages);
}
END_TEST

START_TEST(a_step_is_reached_up_to_the_largest_and_not_above)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!has_stable_step(type)) {
        return;
    }
    const weft_stability of = stability_of(type);
    const weft_stiffness modes
        = { .omega2 = 9.0, .damping = 0.5, .count = 1, .corners = { { 9.0, 0.5 } } };
    const double h = limit(&of, 9.0, 0.5, 0.0);
    const double steps[] = { 0.01 * h, 0.5 * h, h, nextafter(h, INFINITY), 2.0 * h };
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; ++i) {
        bool reaches = false;
        ck_assert_int_eq(
            weft_stability_reaches(&of, &modes, 0.0, steps[i], &reaches, NULL),
            WEFT_OK);
        ck_assert(reaches == (steps[i] <= h));
    }
}
END_TEST

/* Modes from 0 to omega with damping tau times their stiffness lie on the circle
 * |mu + 1 / tau| = 1 / tau, or on the real axis. */
static weft_stiffness proportional(double omega, double tau)
{
    const double w = omega * omega;
    return (weft_stiffness){ .omega2 = w,
                             .damping = tau * w,
                             .count = 2,
                             .corners = { { 0.0, 0.0 }, { w, tau * w } } };
}

START_TEST(a_stabilised_method_says_what_is_stable)
{
    const double tau = 5e-4;
    weft_stability of;
    double h = 0.0, stages[2] = { 0.0, 0.0 };
    ck_assert_int_eq(
        weft_stability_create(test_method_named("stiff/rkc2"), NULL, &of, NULL),
        WEFT_OK);
    for (int i = 0; i < 2; ++i) { /* damping ratios 2.5 and 25 */
        const weft_stiffness modes = proportional(i == 0 ? 1e4 : 1e5, tau);
        ck_assert_int_eq(weft_stability_step(&of, &modes, 0.0, &h, NULL), WEFT_OK);
        ck_assert_double_eq_tol(h, 1.9 * tau, 1e-9 * tau);
        ck_assert_int_eq(weft_stability_calls(&of, &modes, h, &stages[i], NULL),
                         WEFT_OK);
    }
    /* like the root of the largest eigenvalue, which is 100 times larger */
    ck_assert_double_eq_tol(stages[1] / stages[0], 10.0, 1.5);
    const weft_stiffness light = proportional(1e3, 0.9 / 1e3);
    ck_assert_int_eq(weft_stability_step(&of, &light, 0.0, &h, NULL), WEFT_UNSUPPORTED);
}
END_TEST

/* A lightly damped mode: bounded just below the limit, gone just above. */
START_TEST(runs_blow_up_just_above_the_limit_and_not_below)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!has_stable_step(type) || test_is_spared(type)) {
        return;
    }
    static const double w2 = 9.0, damping[] = { 1.2, 6.0, 24.0 };
    const weft_stability of = stability_of(type);
    for (size_t k = 0; k < sizeof damping / sizeof damping[0]; ++k) {
        const double h = limit(&of, w2, damping[k], 0.0);
        weft_cloth_def def = weft_cloth_def_default(); /* a mass on a spring */
        def.rows = 1;
        def.mass = 1.0;
        def.density = 0.0;
        memset(def.gravity, 0, sizeof def.gravity);
        def.springs[WEFT_STRETCH] = (weft_spring_def){ .present = true,
                                                       .stiffness = w2,
                                                       .damping = damping[k] };
        const weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, 0 } };
        def.pins = &pin;
        def.pin_count = 1;
        weft_cloth *cloth = test_cloth(&def);
        for (int above = 0; above < 2; ++above) {
            const weft_stepper_config config = fixed(h * (above ? 1.03 : 0.99));
            weft_sim *sim = test_sim(cloth, type, &config);
            double x[6] = { 0, 0, 0, 1.0 + 1e-9, 0, 0 }, most = 0.0;
            ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, NULL), WEFT_OK);
            for (int i = 0; i < 6000 && most < 1e-5; ++i) {
                ck_assert_int_eq(weft_sim_step(sim, 1e9, NULL), WEFT_OK);
                most = fmax(most, fabs(weft_sim_state(sim)[1] - 1.0));
            }
            ck_assert_msg((most >= 1e-5) == (above == 1), "h = %g s, c = %g: %g", h,
                          damping[k], most);
            weft_sim_destroy(sim);
        }
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* Largest h w on x'' + 2 z w x' + w^2 x = 0, to three digits, by a program of its own
 * from the tables of SUNDIALS, GSL and SciPy. */
typedef struct row {
    const char *label;
    double real, imaginary;            /* 0: |R(i y)| > 1 for small y */
    double z01, z05, z1, z5, z10, z20; /* z = 0.01, 0.05, 0.1, 0.5, 1, 2 */
} row;

static const row rows[] = {
    { "verlet/euler", 2, 0, .020, .100, .200, 1.00, 2.00, .536 },
    { "verlet/midpoint", 2, 0, .444, .800, 1.05, 2.00, 2.00, .536 },
#ifdef HAVE_GSL
    { "gsl/rk2", 2.5127, 1.7321, 1.80, 1.99, 2.15, 2.52, 2.51, .673 },
    { "gsl/rk4", 5.5706, 5.6569, 5.70, 5.82, 5.90, 5.25, 5.57, 1.49 },
    { "gsl/rkck", 3.7344, 0, 1.97, 2.63, 2.88, 3.64, 3.73, 1.00 },
    { "gsl/rkf45", 3.6777, 0, 3.59, 3.47, 3.29, 3.33, 3.68, .985 },
    { "gsl/rk8pd", 5.1666, 0, 4.47, 4.99, 5.17, 5.32, 5.17, 1.38 },
#endif
#ifdef HAVE_ARKODE
    { "arkode/rk4", 2.7853, 2.8284, 2.85, 2.91, 2.95, 2.62, 2.79, .746 },
    { "arkode/bogacki_shampine", 2.5127, 1.7321, 1.80, 1.99, 2.15, 2.52, 2.51, .673 },
    { "arkode/dormand_prince", 3.3066, .9972, 1.87, 2.40, 2.68, 3.40, 3.31, .886 },
    { "arkode/verner65", 4.0648, 1.3068, 2.49, 3.06, 3.37, 3.98, 4.06, 1.09 },
    { "arkode/fehlberg87", 5.0076, 2.359, 3.44, 3.93, 4.09, 4.45, 5.01, 1.34 },
#endif
};

enum { ROWS = sizeof rows / sizeof rows[0] };

START_TEST(limits_are_those_of_the_tables)
{
    const row *of = &rows[_i];
    const weft_stability stability = stability_of(test_method_named(of->label));
    const double z[6] = { 0.01, 0.05, 0.1, 0.5, 1.0, 2.0 };
    const double wanted[6] = { of->z01, of->z05, of->z1, of->z5, of->z10, of->z20 };
    for (size_t k = 0; k < 6; ++k) {
        const double h = limit(&stability, 1.0, 2.0 * z[k], 0.0);
        ck_assert_msg(fabs(h - wanted[k]) <= 0.006 * wanted[k], "%s, z = %g: %g",
                      of->label, z[k], h);
    }
    const double real = limit(&stability, 0.0, 1.0, 0.0);
    const double imaginary = limit(&stability, 1.0, 0.0, 0.0);
    ck_assert_double_eq_tol(real, of->real, 1e-4);
    if (of->imaginary > 0.0) {
        ck_assert_double_eq_tol(imaginary, of->imaginary, 0.004 * of->imaginary);
    } else {
        ck_assert_double_lt(imaginary, 0.4); /* where roundoff still hides it */
    }
    ck_assert_double_eq_tol(limit(&stability, 400.0, 4.0, 0.0) * 20.0, of->z1,
                            0.006 * of->z1); /* only h w counts */
}
END_TEST

/* From the characteristic polynomials: w h^2 + 2 c h <= 4, and w h^2 + 4 c h <= 4 as
 * weft's Verlet takes the damping at a velocity that is predicted. */
START_TEST(limits_of_symplectic_methods_are_exact_and_never_above)
{
    static const char *const labels[2]
        = { "verlet/symplectic_euler", "verlet/velocity_verlet" };
    for (int k = 0; k < 2; ++k) {
        const weft_stability of = stability_of(test_method_named(labels[k]));
        for (int i = 0; i < 6; ++i) {
            const double c = (double[]){ 0.0, 0.02, 0.2, 1.0, 2.0, 8.0 }[i];
            const double p = (k == 0 ? 1.0 : 2.0) * c, wanted = sqrt(p * p + 4.0) - p;
            const double h = limit(&of, 1.0, c, 0.0);
            ck_assert_double_le(h, wanted);
            ck_assert_double_ge(h, 0.999 * wanted);
        }
    }
}
END_TEST

/* |R(-z)| = 1 and |R(i z)| = 1: roots of the polynomials. A run of 8 s changes nothing
 * on the real axis, nor where an oscillation halves sooner than that. */
START_TEST(damped_modes_have_the_limits_of_the_polynomial_whatever_the_run)
{
    static const struct {
        const char *label;
        double real, imaginary; /* 0: none */
    } exact[] = {
        { "verlet/euler", 2.0, 0.0 },
        { "verlet/midpoint", 2.0, 0.0 },
#ifdef HAVE_GSL
        { "gsl/rk2", 2.5127453266183286, 1.7320508075688772 },
#endif
#ifdef HAVE_ARKODE
        { "arkode/heun", 2.0, 0.0 },
        { "arkode/rk4", 2.7852935634052816, 2.8284271247461903 },
#endif
    };
    const double growth = log(2.0) / 8.0;
    for (size_t i = 0; i < sizeof exact / sizeof exact[0]; ++i) {
        const weft_stability of = stability_of(test_method_named(exact[i].label));
        for (int k = 0; k < 2; ++k) { /* without, with allowance */
            ck_assert_double_eq_tol(limit(&of, 0.0, 1.0, k * growth), exact[i].real,
                                    1e-9);
            ck_assert_double_eq_tol(limit(&of, 1.0, 2.0, k * growth), exact[i].real,
                                    1e-6);
        }
        for (int k = 1; k < 20; ++k) { /* from c / 2 = growth to beyond critical */
            const double c = 2.0 * k * growth * (1.0 + 1e-12);
            ck_assert_double_eq_tol(limit(&of, 1.0, c, growth), limit(&of, 1.0, c, 0.0),
                                    1e-9);
        }
        if (exact[i].imaginary > 0.0) {
            ck_assert_double_eq_tol(limit(&of, 1.0, 0.0, 0.0), exact[i].imaginary,
                                    1e-9);
        }
        ck_assert_double_gt(limit(&of, 1.0, 0.0, growth), exact[i].imaginary + 0.01);
    }
}
END_TEST

/* A little damping never shortens the step. */
START_TEST(allowance_ends_without_a_jump)
{
    const double growth = log(2.0) / 300.0;
    const weft_stability of = stability_of(test_method_named("verlet/euler"));
    double before = limit(&of, 1.0, 0.0, growth);
    for (int k = 1; k <= 40; ++k) {
        const double h = limit(&of, 1.0, 0.1 * k * growth, growth);
        ck_assert_double_ge(h, before * (1.0 - 1e-3));
        ck_assert_double_le(h, before * 1.1);
        before = h;
    }
}
END_TEST

/* With growth = log(2) / T nothing more than doubles in T, and twice the step would. */
START_TEST(growth_allows_a_doubling_in_the_run_and_no_more)
{
    static const double duration = 300.0; /* [s], of w = 1 */
    const weft_stability of = stability_of(test_method_named("verlet/midpoint"));
    const double h = limit(&of, 1.0, 0.0, log(2.0) / duration);
    for (int k = 1; k <= 2; ++k) {
        const double step = k * h, r = 1.0 - step * step / 2.0; /* R(i h) = r + i h */
        const double factor = pow(hypot(r, step), duration / step);
        ck_assert(k == 1 ? fabs(factor - 2.0) < 1e-6 : factor > 100.0);
    }
    /* |R|^2 = 1 + h^4/4: h^3 = 8 growth, nearly */
    ck_assert_double_eq_tol(h, cbrt(8.0 * log(2.0) / duration), 0.01 * h);
}
END_TEST

/* A mode slower than the run: |R(i z)|^2 = 1 + z^4/4 is 4, not exp(2 growth h). */
START_TEST(one_step_doubles_a_slow_mode_at_most)
{
    const weft_stability of = stability_of(test_method_named("verlet/midpoint"));
    const double h = limit(&of, 1e-20, 0.0, log(2.0));
    ck_assert_double_eq_tol(1e-10 * h, pow(12.0, 0.25), 1e-9);
}
END_TEST

/* The stable set of a polygon is that of all that it holds. */
START_TEST(polygon_is_no_more_stable_than_any_mode_in_it)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!has_stable_step(type)) {
        return;
    }
    const weft_stability of = stability_of(type);
    const weft_stiffness box
        = { .omega2 = 4.0,
            .damping = 3.0,
            .count = 4,
            .corners = { { 1, 0.2 }, { 4, 0.2 }, { 4, 3 }, { 0, 3 } } };
    double h, least = INFINITY;
    ck_assert_int_eq(weft_stability_step(&of, &box, 0.0, &h, NULL), WEFT_OK);
    for (int i = 0; i <= 5; ++i) {
        for (int k = 0; k <= 5; ++k) {
            const double c = 0.2 + 0.56 * k, edge = fmax(0.0, 1.0 - (c - 0.2) / 2.8);
            least = fmin(least, limit(&of, edge + (4.0 - edge) * i / 5.0, c, 0.0));
        }
    }
    ck_assert_double_le(h, least * (1.0 + 2e-4));
    ck_assert_double_ge(h, least * 0.97);
}
END_TEST

START_TEST(nothing_limits_a_cloth_without_springs)
{
    for (size_t i = 0; i < test_method_count(); ++i) {
        if (has_stable_step(test_method(i))) {
            const weft_stability of = stability_of(test_method(i));
            ck_assert(isinf(limit(&of, 0.0, 0.0, 0.0)));
        }
    }
}
END_TEST

START_TEST(custom_table_has_its_own_polynomial)
{
#ifdef HAVE_ARKODE
    const weft_stability merson = stability_of(test_method_named("arkode/custom"));
    const double r[6] = { 1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 144 };
    ck_assert_int_eq(merson.degree, 5);
    for (int k = 0; k < 6; ++k) {
        ck_assert_double_eq_tol(merson.r[k], r[k], 1e-15);
    }
    weft_stability out;
    ck_assert_int_ne(weft_stability_create(merson.type, NULL, &out, NULL), WEFT_OK);
#endif
}
END_TEST

TEST_SUITE(stability)
{
    Suite *suite = suite_create("stability");
    TCase *limits = tcase_create("limits");
    tcase_set_timeout(limits, 120.0);
    tcase_add_test(limits, a_stabilised_method_says_what_is_stable);
    tcase_add_loop_test(limits, limits_are_those_of_the_tables, 0, ROWS);
    tcase_add_loop_test(limits, a_step_is_reached_up_to_the_largest_and_not_above, 0,
                        (int)test_method_count());
    tcase_add_test(limits, limits_of_symplectic_methods_are_exact_and_never_above);
    tcase_add_test(limits,
                   damped_modes_have_the_limits_of_the_polynomial_whatever_the_run);
    tcase_add_test(limits, allowance_ends_without_a_jump);
    tcase_add_test(limits, growth_allows_a_doubling_in_the_run_and_no_more);
    tcase_add_test(limits, one_step_doubles_a_slow_mode_at_most);
    tcase_add_test(limits, nothing_limits_a_cloth_without_springs);
    tcase_add_test(limits, custom_table_has_its_own_polynomial);
    suite_add_tcase(suite, limits);
    add_for_every_method(suite, "polynomials",
                         polynomial_agrees_with_exp_up_to_the_order);
    add_for_every_method(suite, "runs",
                         runs_blow_up_just_above_the_limit_and_not_below);
    add_for_every_method(suite, "polygons",
                         polygon_is_no_more_stable_than_any_mode_in_it);
    return suite;
}
