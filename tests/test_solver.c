/* SPDX-License-Identifier: BSD-3-Clause */
/* test_solver.c -- stepper.solver and the counts of linear systems, with a method that
 * only counts: what the scene sets reaches it, what it does not use is a mistake, what
 * it counted is in the statistics and in a saved simulation. */
#include <math.h>

#include "scene_load.h"

/* Euler's method; two iterations for every step, and a Jacobian. */
typedef struct counter {
    weft_ode ode;
    const weft_structure *structure;
    weft_linear linear;
    weft_stepper_stats stats;
    bool newton;
    double rate[6 * 16];
} counter;

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **self,
                          weft_error *err)
{
    counter *made = NULL;
    *self = NULL;
    if (weft_stepper_structure(config) == NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no structure");
    }
    if (config->linear != NULL && config->linear->max_order > 2) {
        return weft_error_set(err, WEFT_INVALID, "%s: max_order %d is above 2",
                              type->name, config->linear->max_order);
    }
    ck_assert_ptr_nonnull(made = calloc(1, sizeof *made));
    ck_assert_uint_le(ode->dim, sizeof made->rate / sizeof made->rate[0]);
    made->ode = *ode;
    made->structure = weft_stepper_structure(config);
    made->newton = type->order == 0;
    made->stats.next_step = config->first_step;
    made->linear
        = config->linear == NULL ? (weft_linear){ .krylov = 0.5 } : *config->linear;
    *self = made;
    return WEFT_OK;
}

static weft_status step(void *self, double t_end, double *t, double *y, weft_error *err)
{
    counter *of = self;
    const double h = fmin(1e-3, t_end - *t);
    if (of->ode.rhs(*t, y, of->rate, of->ode.ctx) != 0) {
        return weft_error_set(err, WEFT_NOT_FINITE, "not finite");
    }
    for (size_t i = 0; i < of->ode.dim; ++i) {
        y[i] += h * of->rate[i];
    }
    *t = h < 1e-3 ? t_end : *t + h;
    of->stats.steps += 1;
    of->stats.rhs_calls += 1;
    of->stats.last_step = of->stats.next_step = h;
    of->stats.linear_iterations += 2;
    of->stats.factorisations += 1;
    of->stats.newton_failures += of->stats.steps % 3 == 0;
    return WEFT_OK;
}

static double first_mass; /* [kg] as of the last change */

static void state_changed(void *self)
{
    first_mass = ((const counter *)self)->structure->mass[0];
}

static void stats(const void *self, weft_stepper_stats *out)
{
    const uint32_t size = out->struct_size;
    *out = ((const counter *)self)->stats;
    out->struct_size = size;
}

static void options(const void *self, weft_option_fn *tell, void *ctx)
{
    const counter *of = self;
    char text[32];
    (void)snprintf(text, sizeof text, "%g", of->linear.krylov);
    tell(ctx, "krylov", text);
    if (of->newton) {
        tell(ctx, "max_order", "2");
    }
}

#define METHOD(id, p)                                                                  \
    {                                                                                  \
        .abi = WEFT_STEPPER_ABI, .struct_size = sizeof(weft_stepper_type),             \
        .name = (id), .reference = "", .license = "BSD-3-Clause", .order = (p),        \
        .flags = WEFT_STEPPER_LINEAR | WEFT_STEPPER_STRUCTURE, .create = create,       \
        .step = step, .state_changed = state_changed, .stats = stats, .destroy = free, \
        .options = options                                                             \
    }

static const weft_stepper_type variable = METHOD("variable", 0),
                               fixed = METHOD("fixed", 1);

static const weft_plugin *find(void *ctx, const char *id, weft_error *err)
{
    static const weft_stepper_type *const types[] = { &variable, &fixed, NULL };
    static const weft_plugin counting = { .id = "count", .types = types };
    return strcmp(id, "count") == 0 ? &counting : find_fake(ctx, id, err);
}

/* ---- the scene ---------------------------------------------------------------------
 */

#define HEAD                                                                           \
    "cloth: {grid: {rows: 3, cols: 3, spacing: 0.1}, mass: 0.01}\n"                    \
    "run: {duration: 1}\n"                                                             \
    "stepper: {plugin: count, method: "

static weft_scene_def scene_of(const char *text)
{
    weft_scene_def def = scene_of_text(text);
    def.find_plugin = find;
    return def;
}

START_TEST(a_scene_sets_every_key)
{
    const weft_scene_def def
        = scene_of(HEAD "variable, solver: {krylov: 0.03, max_order: 1}}\n");
    weft_scene *scene = good_scene(&def);
    const weft_linear *linear = weft_scene_config(scene)->linear;
    ck_assert_ptr_nonnull(linear);
    ck_assert(linear->krylov == 0.03 && linear->max_order == 1);
    ck_assert_int_eq(linear->preconditioner, WEFT_PRECONDITIONER_AUTO);
    ck_assert_int_eq(linear->jacobian, WEFT_JACOBIAN_DEFAULT);
    ck_assert_uint_eq(linear->struct_size, sizeof *linear);
    weft_scene_destroy(scene);
    const weft_scene_def choices
        = scene_of_text("cloth: {grid: {rows: 3, cols: 3, spacing: 0.1}, mass: 0.01}\n"
                        "run: {duration: 1}\n"
                        "stepper: {plugin: stiff, method: ros2, solver: {jacobian: "
                        "newton, preconditioner: multigrid}}\n");
    scene = good_scene(&choices);
    linear = weft_scene_config(scene)->linear;
    ck_assert_int_eq(linear->preconditioner, WEFT_PRECONDITIONER_MULTIGRID);
    ck_assert_int_eq(linear->jacobian, WEFT_JACOBIAN_NEWTON);
    ck_assert(linear->krylov == 0.0 && linear->max_order == 0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_scene_without_the_key_leaves_the_defaults)
{
    const weft_scene_def def = scene_of(HEAD "variable}\n");
    weft_scene *scene = good_scene(&def);
    ck_assert_ptr_null(weft_scene_config(scene)->linear);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_key_that_the_method_does_not_report_is_a_mistake)
{
    const weft_scene_def def
        = scene_of(HEAD "fixed, solver: {krylov: 0.1,\n  max_order: 2}}\n");
    ck_assert_str_eq(bad_scene(&def),
                     "scene.yaml:4:3: error: max_order would not be used by method "
                     "'fixed' of plugin 'count'\n  max_order: 2}}\n  ^\n");
}
END_TEST

START_TEST(what_the_method_refuses_is_reported_at_the_solver)
{
    const weft_scene_def def = scene_of(HEAD "variable,\n  solver: {max_order: 3}}\n");
    ck_assert_str_eq(bad_scene(&def),
                     "scene.yaml:4:3: error: variable: max_order 3 is above 2\n"
                     "  solver: {max_order: 3}}\n  ^\n");
}
END_TEST

START_TEST(the_solver_gives_way_to_a_method_of_the_command_line)
{
    const char *const sets[] = { "stepper.method=gsl/rkf45" };
    weft_scene_def def = scene_of(HEAD "fixed, solver: {krylov: 0.1}}\n");
    def.sets = sets;
    def.set_count = 1;
    weft_scene *scene = good_scene(&def);
    ck_assert_ptr_null(weft_scene_config(scene)->linear);
    ck_assert_ptr_nonnull(strstr(all_found(), "solver (line 3, column 41) dropped: the "
                                              "method has no linear solver to set"));
    weft_scene_destroy(scene);
}
END_TEST

/* ---- simulations -------------------------------------------------------------------
 */

static weft_cloth *sheet(void)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = 4;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.density = 0.0;
    def.mass = 0.01;
    return test_cloth(&def);
}

static weft_sim *simulate(const weft_cloth *cloth, const weft_linear *linear)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.linear = linear;
    return test_sim(cloth, &variable, &config);
}

static void told(void *ctx, const char *name, const char *value)
{
    if (strcmp(name, "krylov") == 0) {
        strcpy(ctx, value);
    }
}

START_TEST(a_setting_reaches_the_method_and_is_reported)
{
    const weft_linear linear = { .struct_size = sizeof linear, .krylov = 0.25 };
    char krylov[32] = "";
    weft_cloth *cloth = sheet();
    weft_sim *sim = simulate(cloth, &linear);
    weft_sim_options(sim, told, krylov);
    ck_assert_str_eq(krylov, "0.25");
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

/* Saving and restoring take a new stepper each, whose own counts begin at 0. */
START_TEST(counts_add_up_over_steppers)
{
    unsigned char bytes[4096];
    weft_cloth *cloth = sheet();
    weft_sim *sim = simulate(cloth, NULL), *other = simulate(cloth, NULL);
    ck_assert_int_eq(weft_sim_advance(sim, 0.01, NULL), WEFT_OK);
    const weft_stepper_stats before = weft_sim_stats(sim);
    ck_assert_uint_ge(before.steps, 10);
    ck_assert_uint_eq(before.linear_iterations, 2 * before.steps);
    ck_assert_uint_eq(before.factorisations, before.steps);
    ck_assert_uint_eq(before.newton_failures, before.steps / 3);
    ck_assert_uint_le(weft_sim_save_size(sim), sizeof bytes);
    ck_assert_int_eq(weft_sim_save(sim, bytes, sizeof bytes, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_restore(other, bytes, weft_sim_save_size(sim), NULL),
                     WEFT_OK);
    for (int i = 0; i < 2; ++i) {
        weft_sim *each = i == 0 ? sim : other;
        const weft_stepper_stats after = weft_sim_stats(each);
        ck_assert_mem_eq(&before, &after, sizeof before);
        ck_assert_int_eq(weft_sim_step(each, 1.0, NULL), WEFT_OK);
        ck_assert_uint_eq(weft_sim_stats(each).linear_iterations,
                          before.linear_iterations + 2);
    }
    weft_sim_destroy(sim);
    weft_sim_destroy(other);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_method_without_ode_changed_hears_of_restored_pins)
{
    unsigned char bytes[4096];
    weft_cloth *cloth = sheet();
    weft_sim *sim = simulate(cloth, NULL), *other = simulate(cloth, NULL);
    ck_assert_int_eq(weft_sim_pin(sim, 0, NULL, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_save(sim, bytes, sizeof bytes, NULL), WEFT_OK);
    first_mass = 1.0;
    ck_assert_int_eq(weft_sim_restore(other, bytes, weft_sim_save_size(sim), NULL),
                     WEFT_OK);
    ck_assert_double_eq(first_mass, 0.0);
    weft_sim_destroy(sim);
    weft_sim_destroy(other);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(a_simulation_saved_under_other_settings_is_refused)
{
    const weft_linear as_saved = { .struct_size = sizeof as_saved, .krylov = 0.1 };
    weft_linear others[4] = { as_saved, as_saved, as_saved, as_saved };
    unsigned char bytes[4096];
    others[0].krylov = 0.2;
    others[1].preconditioner = WEFT_PRECONDITIONER_JACOBI;
    others[2].jacobian = WEFT_JACOBIAN_NEWTON;
    others[3].max_order = 1;
    weft_cloth *cloth = sheet();
    weft_sim *sim = simulate(cloth, &as_saved);
    ck_assert_int_eq(weft_sim_save(sim, bytes, sizeof bytes, NULL), WEFT_OK);
    for (size_t i = 0; i < 5; ++i) {
        weft_error err = { 0 };
        weft_sim *other = simulate(cloth, i < 4 ? &others[i] : &as_saved);
        const weft_status status
            = weft_sim_restore(other, bytes, weft_sim_save_size(sim), &err);
        ck_assert_int_eq(status, i < 4 ? WEFT_INVALID : WEFT_OK);
        ck_assert(i == 4 || strstr(err.message, "saved under other settings") != NULL);
        weft_sim_destroy(other);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(solver)
{
    Suite *suite = suite_create("solver");
    TCase *tcase = tcase_create("solver");
    tcase_add_test(tcase, a_scene_sets_every_key);
    tcase_add_test(tcase, a_scene_without_the_key_leaves_the_defaults);
    tcase_add_test(tcase, a_key_that_the_method_does_not_report_is_a_mistake);
    tcase_add_test(tcase, what_the_method_refuses_is_reported_at_the_solver);
    tcase_add_test(tcase, the_solver_gives_way_to_a_method_of_the_command_line);
    tcase_add_test(tcase, a_setting_reaches_the_method_and_is_reported);
    tcase_add_test(tcase, counts_add_up_over_steppers);
    tcase_add_test(tcase, a_method_without_ode_changed_hears_of_restored_pins);
    tcase_add_test(tcase, a_simulation_saved_under_other_settings_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
