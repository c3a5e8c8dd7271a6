/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_cvode.c -- plugin cvode and the implicit tables of plugin arkode on cloth and at
 * the edges of SUNDIALS, beyond the promises of every method (test_steppers.c). */
#include "stepper_run.h"

#ifdef HAVE_CVODE

static const weft_stepper_type *bdf(void)
{
    return test_method_named("cvode/bdf");
}

/* ---- creation -------------------------------------------------------------------- */

START_TEST(a_fixed_step_is_refused_with_the_reason)
{
    static const char *const methods[] = { "cvode/bdf", "cvode/adams" };
    const weft_stepper_type *type = test_method_named(methods[_i]);
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    const weft_stepper_config config = fixed(1e-3);
    void *self = NULL;
    weft_error err;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(
        err.message, "takes no fixed_step: it chooses every step by the tolerances"));
}
END_TEST

static void tell(void *ctx, const char *name, const char *value)
{
    char *all = ctx;
    (void)snprintf(all + strlen(all), 512 - strlen(all), "%s=%s ", name, value);
}

static void options_are(const char *method, const weft_linear *linear,
                        const char *wanted)
{
    char all[512] = "";
    trial_run r;
    weft_stepper_config config = adaptive(1e-6);
    config.linear = linear;
    start(&r, test_method_named(method), &config);
    r.type->options(r.self, tell, all);
    ck_assert_str_eq(all, wanted);
    end(&r);
}

START_TEST(every_choice_is_an_option)
{
    const weft_linear order = { .struct_size = sizeof order, .max_order = 5 };
    options_are("cvode/bdf", NULL,
                "max_order=2 nonlinear_solver=newton convergence=0.1 "
                "linear_solver=gmres krylov_vectors=30 ");
    options_are("cvode/bdf", &order,
                "max_order=5 nonlinear_solver=newton convergence=0.1 "
                "linear_solver=gmres krylov_vectors=30 ");
    options_are("cvode/adams", NULL, "max_order=12 nonlinear_solver=fixed_point ");
}
END_TEST

START_TEST(wrong_settings_of_linear_systems_are_refused)
{
    static const struct {
        weft_linear linear;
        const char *reason;
    } wrong[] = {
        { { .max_order = 6 }, "max_order must be 1 to 5" },
        { { .max_order = -1 }, "max_order must be 1 to 5" },
        { { .krylov = 1.0 }, "krylov must be > 0 and < 1" },
        { { .krylov = (double)NAN }, "krylov must be > 0 and < 1" },
        { { .preconditioner = (weft_preconditioner)7 }, "unknown preconditioner" },
        { { .jacobian = (weft_jacobian)7 }, "unknown jacobian" },
    };
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    weft_stepper_config config = adaptive(1e-6);
    void *self = NULL;
    weft_error err;
    config.linear = &wrong[_i].linear;
    ck_assert_int_eq(bdf()->create(bdf(), &ode, &config, &self, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, wrong[_i].reason));
}
END_TEST

START_TEST(adams_takes_no_settings_of_linear_systems)
{
    const weft_stepper_type *type = test_method_named("cvode/adams");
    const weft_linear linear = { .struct_size = sizeof linear, .max_order = 3 };
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    weft_stepper_config config = adaptive(1e-6);
    void *self = NULL;
    weft_error err;
    config.linear = &linear;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "adams: solves no linear systems");
}
END_TEST

/* ---- the edges of SUNDIALS ------------------------------------------------------- */

static const char *const implicit[]
    = { "cvode/bdf", "cvode/adams", "arkode/trbdf2", "arkode/esdirk325" };
enum { IMPLICITS = sizeof implicit / sizeof implicit[0] };

/* SUNDIALS ends a run where the RHS refuses two states in a row. */
START_TEST(refusals_in_a_row_cost_smaller_steps_only)
{
    const fault kinds[] = { REFUSE, GIVE_NAN };
    for (int kind = 0; kind < 2; ++kind) {
        for (uint64_t row = 2; row <= 20; row += 6) {
            trial_run r;
            const weft_stepper_config config = adaptive(1e-6);
            start(&r, test_method_named(implicit[_i]), &config);
            go(&r, 0.25);
            const uint64_t rejected = stats(&r).rejected;
            while (r.model.fault == NO_FAULT || r.model.calls < r.model.at + row) {
                const uint64_t calls = r.model.calls;
                r.model.fault = kinds[kind];
                r.model.at = r.model.at == 0 ? calls + 2 : r.model.at;
                if (step(&r, 1.0)
                    != WEFT_OK) { /* it fails as long as h is not min_step */
                    ck_assert_int_eq(r.err.status, WEFT_NOT_FINITE);
                    break;
                }
            }
            r.model.fault = NO_FAULT;
            go(&r, 1.0);
            ck_assert_uint_gt(stats(&r).rejected, rejected);
            ck_assert_double_lt(error_at_end(&r), allowed(r.type));
            end(&r);
        }
    }
}
END_TEST

START_TEST(every_frame_is_met_to_the_bit)
{
    trial_run r;
    const weft_stepper_config config = adaptive(1e-5);
    start(&r, test_method_named(implicit[_i]), &config);
    for (int frame = 1; frame <= 180; ++frame) {
        go(&r, frame / 60.0);
        ck_assert(r.t == frame / 60.0);
    }
    end(&r);
}
END_TEST

/* Without the h of before CVODE would begin with one so small that there are a thousand
 * times as many. */
START_TEST(a_changed_state_keeps_the_step)
{
    uint64_t steps[2];
    for (int changed = 0; changed < 2; ++changed) {
        trial_run r;
        const weft_stepper_config config = adaptive(1e-4);
        start(&r, test_method_named(implicit[_i]), &config);
        while (r.t < 4.0) {
            ck_assert_int_eq(step(&r, 4.0), WEFT_OK);
            if (changed != 0) {
                r.type->state_changed(r.self);
            }
        }
        steps[changed] = stats(&r).steps;
        end(&r);
    }
    ck_assert_uint_lt(steps[1], 30 * steps[0]);
}
END_TEST

/* The error of a method of order p falls as the number of steps to the power -p. */
START_TEST(the_order_shows_in_steps_and_errors)
{
    static const struct {
        int max_order;
        double least, most;
    } orders[] = { { 1, 0.8, 1.3 }, { 2, 1.7, 2.5 }, { 3, 2.4, 3.8 } };
    const weft_linear linear
        = { .struct_size = sizeof linear, .max_order = orders[_i].max_order };
    double errors[2], steps[2];
    for (int fine = 0; fine < 2; ++fine) {
        trial_run r;
        weft_stepper_config config = adaptive(fine ? 1e-8 : 1e-5);
        config.linear = &linear;
        start(&r, bdf(), &config);
        go(&r, 4.0);
        errors[fine] = error_at_end(&r);
        steps[fine] = (double)stats(&r).steps;
        end(&r);
    }
    const double order = log(errors[0] / errors[1]) / log(steps[1] / steps[0]);
    ck_assert_msg(order >= orders[_i].least && order <= orders[_i].most,
                  "order %d: %.2f seen", orders[_i].max_order, order);
}
END_TEST

/* ---- cloth ----------------------------------------------------------------------- */

enum { ROWS = 12, PARTICLES = ROWS * ROWS };

static double x[3 * PARTICLES], v[3 * PARTICLES], want[3 * PARTICLES];

/* A horizontal sheet of 1 m that hangs on two corners, stiff and damped. */
static weft_cloth_def sheet_def(double stiffness)
{
    static const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                     { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = ROWS;
    def.spacing[0] = def.spacing[1] = 1.0 / (ROWS - 1);
    def.down[1] = 0.0;
    def.down[2] = 1.0;
    def.pins = pins;
    def.pin_count = 2;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        const double k = stiffness * (f == WEFT_BEND ? 0.1 : 1.0);
        def.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = k, .damping = 1e-4 * k };
    }
    return def;
}

static weft_stepper_config with_tolerance(double tolerance)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.rtol = 0.0;
    config.atol_position = tolerance;
    config.atol_velocity = 100.0 * tolerance;
    return config;
}

static weft_stepper_stats run_to(const weft_cloth *cloth, const char *method,
                                 const weft_stepper_config *config, double t_end,
                                 double *at)
{
    weft_error err;
    weft_sim *sim = test_sim(cloth, test_method_named(method), config);
    while (weft_sim_time(sim) < t_end) {
        ck_assert_msg(weft_sim_step(sim, t_end, &err) == WEFT_OK, "%s", err.message);
    }
    weft_sim_positions(sim, at);
    const weft_stepper_stats stats = weft_sim_stats(sim);
    weft_sim_destroy(sim);
    return stats;
}

static double apart(const double *a, const double *b)
{
    double most = 0.0;
    for (size_t i = 0; i < 3 * PARTICLES; ++i) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

START_TEST(a_stiff_sheet_takes_few_steps)
{
    const weft_cloth_def def = sheet_def(1e5);
    weft_cloth *cloth = test_cloth(&def);
    weft_stepper_config config = with_tolerance(1e-3);
    const weft_stepper_config exact = with_tolerance(1e-6);
    const weft_stepper_stats few
        = run_to(cloth, _i == 0 ? "cvode/bdf" : "arkode/trbdf2", &config, 0.1, x);
    const weft_stepper_stats many
        = run_to(cloth, "arkode/dormand_prince", &exact, 0.1, want);
    ck_assert_uint_lt(20 * few.steps, many.steps);
    ck_assert_double_lt(apart(x, want), 0.02);
    ck_assert_uint_ge(few.linear_iterations, few.steps);
    ck_assert_uint_ge(few.factorisations, few.steps);
    weft_cloth_destroy(cloth);
}
END_TEST

/* In steps that resolve the stiffest mode: longer ones show the lower order of the
 * stages. */
START_TEST(fixed_steps_on_cloth_have_the_order_of_the_table)
{
    static const struct {
        const char *method;
        int order;
    } tables[] = { { "arkode/trbdf2", 2 },    { "arkode/sdirk212", 2 },
                   { "arkode/esdirk325", 3 }, { "arkode/kvaerno423", 3 },
                   { "arkode/esdirk437", 4 }, { "arkode/sdirk534", 4 } };
    const weft_cloth_def def = sheet_def(1.0);
    weft_cloth *cloth = test_cloth(&def);
    const weft_stepper_config exact = with_tolerance(1e-12);
    double errors[2];
    (void)run_to(cloth, "arkode/fehlberg87", &exact, 0.0625, want);
    for (int fine = 0; fine < 2; ++fine) {
        weft_stepper_config config = weft_stepper_config_default();
        config.fixed_step = fine ? 0.0625 / 16 : 0.0625 / 8;
        (void)run_to(cloth, tables[_i].method, &config, 0.0625, x);
        errors[fine] = apart(x, want);
    }
    const double order = log2(errors[0] / errors[1]);
    ck_assert_msg(order > tables[_i].order - 0.3, "%s: order %.2f, errors %g %g",
                  tables[_i].method, order, errors[0], errors[1]);
    weft_cloth_destroy(cloth);
}
END_TEST

static void starts_from(weft_sim *sim, double scale, size_t step)
{
    weft_error err;
    weft_sim_positions(sim, x);
    weft_sim_velocities(sim, v);
    for (size_t i = 0; i < PARTICLES; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            const size_t from = i % step == 0 || i < ROWS ? i : i - 1;
            want[3 * i + k] = (k == 0 || i < ROWS ? 1.0 : scale) * x[3 * from + k];
        }
    }
    ck_assert_int_eq(weft_sim_set_state(sim, want, v, &err), WEFT_OK);
}

/* A sheet squeezed to 60 %, which buckles, and one of whose particles every other lies
 * in the place of its neighbour: the equations are hard to solve, and failures to do so
 * are counted and are no end. */
START_TEST(a_sheet_that_collapses_is_followed)
{
    const weft_cloth_def def = sheet_def(1e3);
    weft_cloth *cloth = test_cloth(&def);
    weft_stepper_config config = with_tolerance(1e-3);
    for (int folded = 0; folded < 2; ++folded) {
        weft_sim *sim = test_sim(cloth, test_method_named(implicit[_i]), &config);
        weft_error err;
        starts_from(sim, folded ? 1.0 : 0.6, folded ? 2 : 1);
        while (weft_sim_time(sim) < 0.02) {
            ck_assert_msg(weft_sim_step(sim, 0.02, &err) == WEFT_OK, "%s", err.message);
        }
        const weft_stepper_stats s = weft_sim_stats(sim);
        ck_assert_uint_le(s.newton_failures, s.rejected);
        ck_assert_uint_lt(s.newton_failures, s.steps);
        weft_sim_destroy(sim);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_strain_limit_is_kept)
{
    weft_sim_def def = weft_sim_def_default();
    const weft_cloth_def hung = sheet_def(100.0);
    weft_cloth *cloth = test_cloth(&hung);
    weft_sim *sim = NULL;
    weft_error err;
    def.cloth = cloth;
    def.method = test_method_named(implicit[_i]);
    def.config = with_tolerance(1e-3);
    def.limit.method = WEFT_LIMIT_PROVOT;
    def.limit.strain = 0.05;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_OK);
    while (weft_sim_time(sim) < 0.3) {
        ck_assert_msg(weft_sim_step(sim, 0.3, &err) == WEFT_OK, "%s", err.message);
    }
    ck_assert_uint_gt(weft_sim_limit_stats(sim).corrected, 0);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_sheet_falls_on_a_ball)
{
    weft_cloth_def def = sheet_def(200.0);
    weft_shape ball = weft_shape_default(WEFT_SPHERE);
    ball.at[0] = 0.5, ball.at[1] = -0.25, ball.at[2] = 0.5;
    ball.radius = 0.2;
    def.pin_count = 0;
    def.contact.shapes = &ball;
    def.contact.shape_count = 1;
    weft_cloth *cloth = test_cloth(&def);
    const weft_stepper_config config = with_tolerance(1e-4);
    (void)run_to(cloth, "arkode/dormand_prince", &config, 0.2, want);
    (void)run_to(cloth, implicit[_i], &config, 0.2, x);
    ck_assert_double_lt(apart(x, want), 0.02);
    weft_cloth_destroy(cloth);
}
END_TEST

/* The same bits on any number of threads; enough particles that vectors are divided. */
START_TEST(threads_do_not_change_the_bits)
{
    enum { MANY = 60 };
    static double one[3 * MANY * MANY], more[3 * MANY * MANY];
    weft_cloth_def def = sheet_def(1e3);
    def.rows = def.cols = MANY;
    def.spacing[0] = def.spacing[1] = 1.0 / (MANY - 1);
    weft_cloth *cloth = test_cloth(&def);
    weft_stepper_config config = with_tolerance(1e-3);
    (void)run_to(cloth, implicit[_i], &config, 0.01, one);
    config.threads = 3;
    (void)run_to(cloth, implicit[_i], &config, 0.01, more);
    ck_assert_mem_eq(one, more, sizeof one);
    weft_cloth_destroy(cloth);
}
END_TEST
#endif

TEST_SUITE(cvode)
{
    Suite *suite = suite_create("cvode");
#ifdef HAVE_CVODE
    TCase *creation = tcase_create("creation");
    tcase_add_loop_test(creation, a_fixed_step_is_refused_with_the_reason, 0, 2);
    tcase_add_test(creation, every_choice_is_an_option);
    tcase_add_loop_test(creation, wrong_settings_of_linear_systems_are_refused, 0, 6);
    tcase_add_test(creation, adams_takes_no_settings_of_linear_systems);
    suite_add_tcase(suite, creation);
    TCase *edges = tcase_create("edges");
    tcase_add_loop_test(edges, refusals_in_a_row_cost_smaller_steps_only, 0, IMPLICITS);
    tcase_add_loop_test(edges, every_frame_is_met_to_the_bit, 0, IMPLICITS);
    tcase_add_loop_test(edges, a_changed_state_keeps_the_step, 0, IMPLICITS);
    tcase_add_loop_test(edges, the_order_shows_in_steps_and_errors, 0, 3);
    suite_add_tcase(suite, edges);
    TCase *sheets = tcase_create("sheets");
    tcase_set_timeout(sheets, 120.0);
    tcase_add_loop_test(sheets, a_stiff_sheet_takes_few_steps, 0, 2);
    tcase_add_loop_test(sheets, fixed_steps_on_cloth_have_the_order_of_the_table, 0, 6);
    tcase_add_loop_test(sheets, a_sheet_that_collapses_is_followed, 0, IMPLICITS);
    tcase_add_loop_test(sheets, a_strain_limit_is_kept, 0, IMPLICITS);
    tcase_add_loop_test(sheets, a_sheet_falls_on_a_ball, 0, IMPLICITS);
    tcase_add_loop_test(sheets, threads_do_not_change_the_bits, 0, IMPLICITS);
    suite_add_tcase(suite, sheets);
#else
    suite_add_tcase(suite, tcase_create("none"));
#endif
    return suite;
}
