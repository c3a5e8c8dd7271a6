/* SPDX-License-Identifier: BSD-3-Clause */
/* test_controllers.c -- how h is adapted: what a method takes, that it is in force, and
 * that it is told. */
#include "scene_load.h"
#include "stepper_run.h"

#ifdef HAVE_ARKODE

static const weft_stepper_type *dormand_prince(void)
{
    return test_method_named("arkode/dormand_prince");
}

static weft_stepper_config controlled(const weft_controller *controller)
{
    weft_stepper_config config = adaptive(1e-7);
    config.controller = controller;
    return config;
}

/* To 6 s; returns the statistics. */
static weft_stepper_stats drive(const weft_controller *controller, double *y)
{
    const weft_stepper_config config = controlled(controller);
    run r;
    start(&r, dormand_prince(), &config);
    go(&r, 6.0);
    ck_assert_double_lt(error_at_end(&r), 1e-5);
    const weft_stepper_stats s = stats(&r);
    memcpy(y, r.y, sizeof r.y);
    end(&r);
    return s;
}

#define ONE(label, name, gains) +1
enum { TYPES = 1 WEFT_CONTROLLERS(ONE) };
#undef ONE

START_TEST(every_type_keeps_the_tolerance_by_steps_of_its_own)
{
    double y[TYPES][DIM];
    for (int i = 1; i < TYPES; ++i) {
        const weft_controller controller = { .type = (weft_controller_type)i };
        (void)drive(&controller, y[i]);
        for (int j = 1; j < i; ++j) {
            ck_assert_mem_ne(y[i], y[j], sizeof y[i]);
        }
    }
}
END_TEST

START_TEST(pi_is_the_default)
{
    const weft_controller pi = { .type = WEFT_CONTROLLER_PI }, none = { .bias = 0.0 };
    double y[3][DIM];
    (void)drive(NULL, y[0]);
    (void)drive(&pi, y[1]);
    (void)drive(&none, y[2]);
    SAME(y[0], y[1]);
    SAME(y[0], y[2]);
}
END_TEST

START_TEST(every_knob_changes_the_steps)
{
    const weft_controller knobs[] = {
        { .safety = 0.7 },
        { .bias = 2.0 },
        { .max_growth = 1.05 },
        { .first_growth = 2.0 },
        { .min_reduction = 0.97 },
        { .failed_growth = 0.9 },
        { .type = WEFT_CONTROLLER_PI, .gains = { 0.5, 0.1 }, .gain_count = 2 },
    };
    for (size_t i = 0; i < sizeof knobs / sizeof knobs[0]; ++i) {
        /* the one is rejected again and again, the other much too small */
        const double first_steps[] = { 0.5, 1e-5 };
        bool differs = false;
        for (int k = 0; k < 2; ++k) {
            run plain, turned;
            weft_stepper_config config = controlled(NULL);
            config.first_step = first_steps[k];
            start(&plain, dormand_prince(), &config);
            config.controller = &knobs[i];
            start(&turned, dormand_prince(), &config);
            go(&plain, 2.0);
            go(&turned, 2.0);
            differs = differs || memcmp(plain.y, turned.y, sizeof plain.y) != 0;
            end(&plain);
            end(&turned);
        }
        ck_assert_msg(differs, "knob %zu", i);
    }
}
END_TEST

START_TEST(careful_controllers_take_more_steps)
{
    const weft_controller careful = { .safety = 0.4 };
    double y[DIM];
    ck_assert_uint_gt(drive(&careful, y).steps, drive(NULL, y).steps);
}
END_TEST

START_TEST(what_makes_no_sense_is_refused)
{
    const struct {
        weft_controller set;
        const char *reason;
    } wrong[] = {
        { { .type = (weft_controller_type)TYPES }, "unknown type" },
        { { .type = (weft_controller_type)-1 }, "unknown type" },
        { { .type = WEFT_CONTROLLER_PI, .gain_count = 3 }, "number of gains" },
        { { .type = WEFT_CONTROLLER_I, .gains = { NAN }, .gain_count = 1 }, "finite" },
        { { .safety = 1.01 }, "safety" },
        { { .safety = -0.5 }, "safety" },
        { { .bias = 0.9 }, "bias" },
        { { .bias = NAN }, "bias" },
        { { .max_growth = 1.0 }, "max_growth" },
        { { .first_growth = (double)INFINITY }, "first_growth" },
        { { .min_reduction = 1.0 }, "min_reduction" },
        { { .failed_growth = 1.5 }, "failed_growth" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        const weft_stepper_type *type = dormand_prince();
        const weft_stepper_config config = controlled(&wrong[i].set);
        model m = { .k = 1.0 };
        const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
        weft_error err = { 0 };
        void *self = &m;
        ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
        ck_assert_ptr_null(self);
        ck_assert_msg(strstr(err.message, wrong[i].reason) != NULL, "%s", err.message);
    }
}
END_TEST

typedef struct told {
    char text[1024];
} told;

static void note(void *ctx, const char *name, const char *value)
{
    told *all = ctx;
    const size_t used = strlen(all->text);
    (void)snprintf(all->text + used, sizeof all->text - used, "%s=%s;", name, value);
}

START_TEST(what_is_in_force_is_told)
{
    const weft_controller controller
        = { .type = WEFT_CONTROLLER_PID, .safety = 0.9, .max_growth = 10.0 };
    const weft_stepper_config config = controlled(&controller);
    run r;
    told all = { "" };
    start(&r, dormand_prince(), &config);
    r.type->options(r.self, note, &all);
    end(&r);
    ck_assert_str_eq(
        all.text, "table=ARKODE_DORMAND_PRINCE_7_4_5;controller=pid;k1=0.58;k2=0.21;"
                  "k3=0.1;safety=0.9;bias=1.2;max_growth=10;first_growth=10000;"
                  "min_reduction=0.1;failed_growth=0.3;keep_above=1;keep_below=1.5;");
}
END_TEST

START_TEST(a_config_of_an_older_version_has_no_controller)
{
    const weft_controller wrong = { .safety = -1.0 };
    weft_stepper_config config = controlled(&wrong);
    config.struct_size = WEFT_STEPPER_CONFIG_LEAST;
    run r;
    start(&r, dormand_prince(), &config);
    go(&r, 0.5);
    end(&r);
}
END_TEST

START_TEST(tables_are_found_by_their_full_names)
{
    const weft_stepper_type *type = dormand_prince();
    for (size_t i = 0; test_plugin(i) != NULL; ++i) {
        const weft_plugin *plugin = test_plugin(i);
        ck_assert_ptr_eq(weft_plugin_method(plugin, "ARKODE_DORMAND_PRINCE_7_4_5"),
                         strcmp(plugin->id, "arkode") == 0 ? type : NULL);
    }
    ck_assert_str_eq(weft_stepper_full_name(type), "ARKODE_DORMAND_PRINCE_7_4_5");
}
END_TEST

#endif

/* ---- scenes ------------------------------------------------------------------------
 */

#define HEAD                                                                           \
    "cloth: {grid: {rows: 3, cols: 3, spacing: 0.1}, mass: 0.01}\n"                    \
    "run: {duration: 1}\n"

START_TEST(a_scene_sets_every_knob)
{
    weft_scene *scene = good_text(
        HEAD "stepper:\n"
             "  plugin: arkode\n"
             "  method: cash_karp\n"
             "  controller: {type: implicit_gustafsson, gains: [49/50, 0.9], safety: "
             "0.8,\n"
             "    bias: 1.5, max_growth: 5, first_growth: 100, min_reduction: 0.2, "
             "failed_growth: 0.5}\n");
    const weft_controller *c = weft_scene_config(scene)->controller;
    ck_assert_ptr_nonnull(c);
    ck_assert_int_eq(c->type, WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON);
    ck_assert_int_eq(c->gain_count, 2);
    ck_assert(c->gains[0] == 0.98 && c->gains[1] == 0.9);
    ck_assert(c->safety == 0.8 && c->bias == 1.5 && c->max_growth == 5.0);
    ck_assert(c->first_growth == 100.0 && c->min_reduction == 0.2);
    ck_assert(c->failed_growth == 0.5);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_scene_without_the_key_has_no_controller)
{
    weft_scene *scene
        = good_text(HEAD "stepper: {plugin: arkode, method: cash_karp}\n");
    ck_assert_ptr_null(weft_scene_config(scene)->controller);
    weft_scene_destroy(scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("controllers");
    TCase *tcase = tcase_create("controllers");
#ifdef HAVE_ARKODE
    tcase_add_test(tcase, every_type_keeps_the_tolerance_by_steps_of_its_own);
    tcase_add_test(tcase, pi_is_the_default);
    tcase_add_test(tcase, every_knob_changes_the_steps);
    tcase_add_test(tcase, careful_controllers_take_more_steps);
    tcase_add_test(tcase, what_makes_no_sense_is_refused);
    tcase_add_test(tcase, what_is_in_force_is_told);
    tcase_add_test(tcase, a_config_of_an_older_version_has_no_controller);
    tcase_add_test(tcase, tables_are_found_by_their_full_names);
#endif
    tcase_add_test(tcase, a_scene_sets_every_knob);
    tcase_add_test(tcase, a_scene_without_the_key_has_no_controller);
    suite_add_tcase(suite, tcase);
    return test_run(suite);
}
