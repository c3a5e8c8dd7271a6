/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together */
/* test_gsl.c -- what can go wrong with GSL alone: its error handler, which aborts a
 * program that does not replace it, and the Jacobian that plugins/gsl makes for it. */
#include "stepper_run.h"

#include <stdlib.h>
#include <sys/resource.h>

#ifdef HAVE_GSL
#include "../plugins/gsl/gsl_plugin.h"
#endif

START_TEST(matrices_too_large_are_refused_at_once)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if ((type->flags & WEFT_STEPPER_DENSE) == 0) {
        return;
    }
    const weft_stepper_config config = usual(type, 0);
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = 6 * 300 * 300, .rhs = rhs, .ctx = &m };
    void *self = &m;
    weft_error err = { 0 };
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_NO_MEMORY);
    ck_assert_ptr_null(self);
    ck_assert_ptr_nonnull(strstr(err.message, "GiB"));
    ck_assert_ptr_nonnull(strstr(err.message, "without matrices"));
}
END_TEST

/* x' = v, v' = a x - c v */
typedef struct line {
    double a, c;
} line;

static int linear(double t, const double *y, double *dydt, void *ctx)
{
    const line *l = ctx;
    (void)t;
    dydt[0] = y[1];
    dydt[1] = l->a * y[0] - l->c * y[1];
    return 0;
}

/* With a = (m/h)^2 the matrix I - (h/m) J, which an implicit method of GSL solves for
 * some m, is singular to the last bit: the error handler would be called. */
START_TEST(singular_equations_call_no_handler)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_needs_structure(type) || test_adaptive_only(type)) {
        return;
    }
    const weft_stepper_config config = test_config(type, fixed(0.5));
    static const int parts[] = { 1, 2, 4, 6, 8, 10, 14, 22, 34, 50, 70 };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        line l = { .a = 4.0 * parts[i] * parts[i] };
        const weft_ode ode = { .dim = 2, .rhs = linear, .ctx = &l };
        void *self = NULL;
        double t = 0.0, y[2] = { 1.0, 1.0 };
        ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
        const weft_status status = type->step(self, 1.0, &t, y, NULL);
        ck_assert(status == WEFT_OK || status == WEFT_SOLVER);
        ck_assert(t == (status == WEFT_OK ? 0.5 : 0.0) && isfinite(y[0]));
        type->destroy(self);
    }
}
END_TEST

#ifdef HAVE_GSL

/* y += h f(y + h/2 (I - h/2 J)^-1 f(y)), rk2simp's rule, with J as it is. */
static void rk2simp(const line *l, double h, double *y)
{
    line m = *l;
    double f[2], z[2];
    const double g = 0.5 * h, det = 1.0 + g * l->c - g * g * l->a;
    (void)linear(0.0, y, f, &m);
    z[0] = y[0] + g * ((1.0 + g * l->c) * f[0] + g * f[1]) / det;
    z[1] = y[1] + g * (g * l->a * f[0] + f[1]) / det;
    (void)linear(0.0, z, f, &m);
    y[0] += h * f[0];
    y[1] += h * f[1];
}

/* A wrong J_ij shows in the result by about h^2 J_ij f: here that is of the size of y.
 */
START_TEST(the_jacobian_is_right_to_seven_digits)
{
    const weft_stepper_type *type = test_method_named("gsl/rk2simp");
    static const double sizes[] = { 1.7e-4, 0.31, 2.9, 4.3e3 };
    const double h = 0.0087;
    const weft_stepper_config config = fixed(h);
    for (int i = 0; i < 4; ++i) {
        line l = { .a = -1.3e4, .c = 59.0 };
        const weft_ode ode = { .dim = 2, .rhs = linear, .ctx = &l };
        void *self = NULL;
        const double size = sizes[i];
        double t = 0.0, y[2] = { 0.71 * size, -83.0 * size }, want[2] = { y[0], y[1] };
        ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
        ck_assert_int_eq(type->step(self, 1.0, &t, y, NULL), WEFT_OK);
        rk2simp(&l, 0.5 * h, want);
        rk2simp(&l, 0.5 * h, want);
        ck_assert_double_eq_tol(y[0], want[0], 1e-7 * size);
        ck_assert_double_eq_tol(y[1], want[1], 1e-5 * size);
        type->destroy(self);
    }
}
END_TEST

/* bsimp alone reads df/dt. Of x' = v, v' = cos t - 1000 (v - sin t) the solution is
 * v = sin t; a df/dt of the wrong sign errs by 1e-4. */
static int driven(double t, const double *y, double *dydt, void *ctx)
{
    (void)ctx;
    dydt[0] = y[1];
    dydt[1] = cos(t) - 1000.0 * (y[1] - sin(t));
    return 0;
}

START_TEST(the_time_derivative_is_right)
{
    const weft_stepper_type *type = test_method_named("gsl/bsimp");
    const weft_ode ode = { .dim = 2, .rhs = driven };
    const weft_stepper_config config = fixed(0.5);
    void *self = NULL;
    double t = 0.0, y[2] = { 1.0, 0.0 };
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    while (t < 1.0) {
        ck_assert_int_eq(type->step(self, 1.0, &t, y, NULL), WEFT_OK);
    }
    ck_assert_double_eq_tol(y[0], 2.0 - cos(1.0), 1e-6);
    ck_assert_double_eq_tol(y[1], sin(1.0), 1e-6);
    type->destroy(self);
}
END_TEST

/* When bsimp's extrapolation runs away it says so by an infinite error estimate, and
 * returns success with a y that is finite and wrong. */
START_TEST(a_runaway_is_no_step)
{
    const weft_stepper_type *type = test_method_named("gsl/bsimp");
    const weft_stepper_config config = fixed(0.5);
    line l = { .a = 640.0 };
    const weft_ode ode = { .dim = 2, .rhs = linear, .ctx = &l };
    void *self = NULL;
    double t = 0.0, y[2] = { 1.7, 0.9 };
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    ck_assert_int_eq(type->step(self, 1.0, &t, y, NULL), WEFT_SOLVER);
    ck_assert(t == 0.0 && y[0] == 1.7 && y[1] == 0.9);
    l.a = 0.4;
    ck_assert_int_eq(type->step(self, 1.0, &t, y, NULL), WEFT_OK);
    type->destroy(self);
}
END_TEST

/* x1'' = -x1, x2'' = x1 - x2 from x2 near 0: x1 = cos t, x2 = (t / 2) sin t. bsimp
 * takes a large relative change for a runaway. */
static int driven_from_zero(double t, const double *y, double *dydt, void *ctx)
{
    (void)t;
    (void)ctx;
    dydt[0] = y[2];
    dydt[1] = y[3];
    dydt[2] = -y[0];
    dydt[3] = y[0] - y[1];
    return 0;
}

START_TEST(a_component_near_zero_does_not_stop_bsimp)
{
    const weft_stepper_type *type = test_method_named("gsl/bsimp");
    const weft_ode ode = { .dim = 4, .rhs = driven_from_zero };
    const weft_stepper_config config = adaptive(1e-6);
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    void *self = NULL;
    double t = 0.0, y[4] = { 1.0, 1e-18, 0.0, -1e-18 };
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    while (t < 1.5 && stats.steps < 100) {
        ck_assert_int_eq(type->step(self, 1.5, &t, y, NULL), WEFT_OK);
        type->stats(self, &stats);
    }
    ck_assert_uint_lt(stats.steps, 100);
    ck_assert_double_eq_tol(y[0], cos(1.5), 1e-5);
    ck_assert_double_eq_tol(y[1], 0.75 * sin(1.5), 1e-5);
    type->destroy(self);
}
END_TEST

/* It puts numbers beside 1, where rounding loses them. */
START_TEST(bsimp_refuses_tolerances_below_its_rounding)
{
    const weft_stepper_type *type = test_method_named("gsl/bsimp");
    const weft_ode ode = { .dim = 4, .rhs = driven_from_zero };
    weft_stepper_config config = adaptive(1e-14);
    weft_error err = { 0 };
    void *self = NULL;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_OK);
    type->destroy(self);
    config.atol_velocity = 0.9e-14;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "atol must be at least 1e-14 m and m/s"));
    config.fixed_step = 1e-3;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_OK);
    type->destroy(self);
}
END_TEST

static weft_status create_of_size(const weft_stepper_type *type, size_t dim)
{
    const weft_stepper_config config = adaptive(1e-6);
    const weft_ode ode = { .dim = dim, .rhs = linear };
    void *self = NULL;
    weft_error err = { 0 };
    const weft_status status = type->create(type, &ode, &config, &self, &err);
    ck_assert((self == NULL) == (status != WEFT_OK));
    ck_assert_int_eq(err.status, status);
    type->destroy(self);
    return status;
}

/* 19 vectors of rk8pd within the plugin's own limit, but not within the process's. */
START_TEST(memory_that_is_not_there_is_an_error)
{
    const weft_stepper_type *type = test_method_named("gsl/rk8pd");
    ck_assert_int_eq(create_of_size(type, (size_t)1 << 40), WEFT_NO_MEMORY);
    ck_assert_int_eq(create_of_size(type, SIZE_MAX - 1), WEFT_NO_MEMORY);
    ck_assert_int_eq(create_of_size(type, 60000), WEFT_OK);
    const char *fork_mode = getenv("CK_FORK");
#ifdef __SANITIZE_ADDRESS__
    fork_mode = "no";
#endif
    if (fork_mode == NULL || strcmp(fork_mode, "no") != 0) {
        const struct rlimit limit = { (rlim_t)1 << 30, (rlim_t)1 << 30 };
        ck_assert_int_eq(setrlimit(RLIMIT_AS, &limit), 0);
        ck_assert_int_eq(create_of_size(type, 12000000), WEFT_NO_MEMORY);
    }
}
END_TEST

/* At 1e210 m/s J_ij is so large that a pivot of I - h/4 J was 0. */
START_TEST(speeds_beyond_reason_call_no_handler)
{
    const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 1, 1 } },
                              { .rows = { 3, 3 }, .cols = { 1, 1 } } };
    const weft_stepper_config config = adaptive(1e-4);
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 5, def.cols = 2;
    def.spacing[0] = def.spacing[1] = 0.13;
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 87.0, .damping = 0.05 };
    def.pins = pins, def.pin_count = 2;
    for (double v = 1e10; v < 1e300; v *= 10.0) {
        weft_error err = { 0 };
        def.velocity[0] = -0.97, def.velocity[1] = v, def.velocity[2] = 0.35;
        weft_cloth *cloth = test_cloth(&def);
        weft_sim *sim = test_sim(cloth, test_method_named("gsl/rk4imp"), &config);
        ck_assert(weft_sim_step(sim, 0.01, &err) == WEFT_OK || err.message[0] != '\0');
        weft_sim_destroy(sim);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* GSL's control looks at one error estimate, r, and D = 1. */
START_TEST(h_follows_the_rule_of_gsl)
{
    const double one = 1.0, zero = 0.0;
    gsl_odeiv2_control *control = gsl_odeiv2_control_scaled_new(1, 0, 1, 0, &one, 1);
    for (unsigned int order = 1; order <= 12; ++order) {
        for (double r = 1e-12; r < 1e12; r *= 1.03) {
            double wanted = 0.125, h = 0.125;
            const int verdict = control->type->hadjust(control->state, 1, order, &zero,
                                                       &r, &zero, &wanted);
            ck_assert_int_eq(weft__gsl_rejects(order, r, &h),
                             verdict == GSL_ODEIV_HADJ_DEC);
            ck_assert_double_eq_tol(h, wanted, 1e-15 * wanted);
        }
    }
    gsl_odeiv2_control_free(control);
}
END_TEST

#endif

TEST_SUITE(gsl)
{
    Suite *suite = suite_create("gsl");
    add_for_every_method(suite, "memory", matrices_too_large_are_refused_at_once);
    add_for_every_method(suite, "singular", singular_equations_call_no_handler);
#ifdef HAVE_GSL
    TCase *tcase = tcase_create("gsl");
    tcase_add_checked_fixture(tcase, watch_gsl, gsl_was_silent);
    tcase_add_test(tcase, the_jacobian_is_right_to_seven_digits);
    tcase_add_test(tcase, the_time_derivative_is_right);
    tcase_add_test(tcase, a_runaway_is_no_step);
    tcase_add_test(tcase, bsimp_refuses_tolerances_below_its_rounding);
    tcase_add_test(tcase, a_component_near_zero_does_not_stop_bsimp);
    tcase_add_test(tcase, memory_that_is_not_there_is_an_error);
    tcase_add_test(tcase, speeds_beyond_reason_call_no_handler);
    tcase_add_test(tcase, h_follows_the_rule_of_gsl);
    suite_add_tcase(suite, tcase);
#endif
    return suite;
}
