/* SPDX-License-Identifier: BSD-3-Clause */
/* Methods chosen by file, command line and sweep, with their plugins, and the keys that
 * such a choice leaves without use. */
#include "scene_load.h"

#define HEAD                                                                           \
    "weft: 1\n"                                                                        \
    "cloth: {mass: 1, grid: {rows: 2, cols: 2, spacing: 1}}\n"                         \
    "run: {duration: 1}\n"

/* The scene has gsl rkf45 with rtol; what a later choice leaves without use goes,
 * with a warning, and what one source sets against itself is refused. */
static const struct {
    const char *sets[3], *told;
    bool loads;
} choices[] = {
    { { "stepper.method=verlet/velocity_verlet", "stepper.fixed_step=1e-3" },
      "override stepper.method:9: warning: rtol (line 4, column 39) dropped: the "
      "method has no error control\n",
      true },
    { { "stepper.plugin=verlet", "stepper.method=velocity_verlet",
        "stepper.fixed_step=1e-3" },
      "override stepper.method:9: warning: rtol (line 4, column 39) dropped: the "
      "method has no error control\n",
      true },
    { { "stepper.fixed_step=1e-3" },
      "override stepper.fixed_step:9: warning: rtol (line 4, column 39) dropped: "
      "fixed_step excludes error control\n",
      true },
    { { "stepper.method=arkode/cash_karp", "stepper.fixed_step=1e-3" },
      "override stepper.fixed_step:9: warning: rtol (line 4, column 39) dropped: "
      "fixed_step",
      true },
    { { "stepper.method=gsl/rk8pd", "stepper.rtol=1e-3" }, "", true },
    { { "stepper.method=verlet/velocity_verlet" },
      "override stepper.method:23: error: method 'velocity_verlet' has no error "
      "control: it needs stepper.fixed_step [s]\n",
      false },
    { { "stepper.method=verlet/velocity_verlet", "stepper.fixed_step=1e-3",
        "stepper.rtol=1e-3" },
      "override stepper.rtol:9: error: rtol would not be used by method "
      "'velocity_verlet' of plugin 'verlet', which has no error control\n",
      false },
    { { "stepper.fixed_step=1e-3", "stepper.rtol=1e-3" },
      "override stepper.rtol:9: error: rtol excludes fixed_step (override "
      "stepper.fixed_step)\n",
      false },
    { { "stepper.method=arkode/cash_karp", "stepper.plugin=gsl" },
      "override stepper.method:16: error: method 'arkode/cash_karp' is of another "
      "plugin than 'gsl' (override stepper.plugin)\n",
      false },
    { { "stepper.method=arkode/cash_crap" },
      "override stepper.method:23: error: plugin 'arkode' has no method 'cash_crap' "
      "(did you mean 'cash_karp'?)",
      false },
    { { "stepper.method=arkod/cash_karp" },
      "override stepper.method:16: error: plugin 'arkod' not found",
      false },
    { { "stepper.method=/rk4" },
      "override stepper.method:16: error: plugin 'gsl' has no method '/rk4'",
      false },
};

START_TEST(a_later_choice_of_method_drops_what_it_would_not_use)
{
    size_t count = 0;
    while (count < 3 && choices[_i].sets[count] != NULL) {
        ++count;
    }
    weft_scene_def def
        = scene_of_text(HEAD "stepper: {plugin: gsl, method: rkf45, rtol: 1e-7}\n");
    def.sets = choices[_i].sets;
    def.set_count = count;
    if (!choices[_i].loads) {
        const char *told = bad_scene(&def);
        ck_assert_msg(strstr(told, choices[_i].told) != NULL, "%s", told);
        ck_assert_uint_eq(found.errors, 1);
        return;
    }
    weft_scene *scene = good_scene(&def);
    ck_assert_msg(strstr(all_found(), choices[_i].told) != NULL, "%s", all_found());
    ck_assert_uint_eq(found.warnings, choices[_i].told[0] != '\0');
    weft_scene *again = good_text(weft_scene_text(scene));
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_str_eq(weft_scene_plugin(again), weft_scene_plugin(scene));
    ck_assert_str_eq(weft_scene_method(again), weft_scene_method(scene));
    ck_assert_mem_eq(weft_scene_config(scene), weft_scene_config(again),
                     sizeof(weft_stepper_config));
    weft_scene_destroy(again);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(an_override_of_a_tolerance_ends_fixed_steps)
{
    static const char *const sets[] = { "stepper.atol=1e-9" };
    weft_scene_def def
        = scene_of_text(HEAD "stepper: {plugin: gsl, method: rk4, fixed_step: 0.1}\n");
    def.sets = sets;
    def.set_count = 1;
    weft_scene *scene = good_scene(&def);
    ck_assert(weft_scene_config(scene)->fixed_step == 0.0);
    ck_assert(weft_scene_config(scene)->atol_position == 1e-9);
    ck_assert_ptr_nonnull(strstr(all_found(), "fixed_step (line 4, column 37) dropped: "
                                              "error control excludes it\n"));
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_method_may_bring_its_plugin_in_a_scene)
{
    static const char *const texts[]
        = { "{method: verlet/velocity_verlet, fixed_step: 0.01}",
            "{plugin: verlet, method: 'verlet/velocity_verlet', fixed_step: 0.01}" };
    char text[400];
    (void)snprintf(text, sizeof text, HEAD "name: n\nstepper: %s\n", texts[_i]);
    weft_scene *scene = good_text(text);
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_str_eq(weft_scene_plugin(scene), "verlet");
    ck_assert_str_eq(weft_scene_method(scene), "velocity_verlet");
    ck_assert_str_eq(weft_scene_text(scene), text);
    weft_scene_destroy(scene);
}
END_TEST

static const weft_plugin *find_without_gsl(void *ctx, const char *id, weft_error *err)
{
    return find_fake(ctx, strcmp(id, "gsl") == 0 ? "gsl of elsewhere" : id, err);
}

START_TEST(a_plugin_that_is_missing_is_told_with_the_method_of_another_one)
{
    weft_scene_def def
        = scene_of_text(HEAD "stepper: {plugin: gsl, method: rkck, rtol: 1e-7}\n");
    def.find_plugin = find_without_gsl;
    ck_assert_ptr_nonnull(
        strstr(bad_scene(&def), "scene.yaml:4:19: error: plugin 'gsl of elsewhere' not "
                                "found: no weft-gsl of elsewhere.so here; "
                                "arkode/cash_karp does the same\n"));
    static const char *const sets[] = { "stepper.method=rkf45" }; /* which it lacks */
    def.sets = sets;
    def.set_count = 1;
    ck_assert_ptr_null(strstr(bad_scene(&def), "does the same"));
}
END_TEST

TEST_SUITE(scene_method)
{
    Suite *suite = suite_create("scene method");
    TCase *methods = tcase_create("methods");
    tcase_add_loop_test(methods, a_later_choice_of_method_drops_what_it_would_not_use,
                        0, sizeof choices / sizeof choices[0]);
    tcase_add_test(methods,
                   a_plugin_that_is_missing_is_told_with_the_method_of_another_one);
    tcase_add_test(methods, an_override_of_a_tolerance_ends_fixed_steps);
    tcase_add_loop_test(methods, a_method_may_bring_its_plugin_in_a_scene, 0, 2);
    suite_add_tcase(suite, methods);
    return suite;
}
