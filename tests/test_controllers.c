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
    trial_run r;
    start(&r, dormand_prince(), &config);
    go(&r, 6.0);
    ck_assert_double_lt(error_at_end(&r), 1e-5);
    const weft_stepper_stats s = stats(&r);
    memcpy(y, r.y, DIM * sizeof *y);
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
        /* rejected; much too small; so long that the error is not even a number */
        const double first_steps[] = { 0.5, 1e-5, 20.0 };
        bool differs = false;
        for (int k = 0; k < 3; ++k) {
            trial_run plain, turned;
            weft_stepper_config config = controlled(NULL);
            config.first_step = first_steps[k];
            start(&plain, dormand_prince(), &config);
            config.controller = &knobs[i];
            start(&turned, dormand_prince(), &config);
            plain.model.edge = turned.model.edge = 10.0;
            go(&plain, 20.0);
            go(&turned, 20.0);
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

START_TEST(safety_may_be_1)
{
    const weft_controller least = { .safety = 1.0 };
    double y[DIM];
    ck_assert_uint_le(drive(&least, y).steps, drive(NULL, y).steps);
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

/* x' = k t: Heun's step of h and Euler's differ by k h^2 / 2. */
static int climb(double t, const double *y, double *dydt, void *ctx)
{
    (void)y;
    dydt[0] = *(const double *)ctx * t;
    dydt[1] = 0.0;
    return 0;
}

static double gustafsson(double k1, double k2, double e1, double e2)
{
    return pow(e1, -k1) * pow(e1 / e2, -k2);
}

/* The table of docs/reference/integrators.md for p = 1, with e of the last step first;
 * h[1] and the e before are those of no step at the start. */
static double next_by_law(weft_controller_type type, const double h[2],
                          const double e[3])
{
    const double ratio = h[1] > 0.0 ? h[0] / h[1] : 1.0;
    switch (type) {
    case WEFT_CONTROLLER_PID:
        return h[0] * pow(e[0], -0.58) * pow(e[1], 0.21) * pow(e[2], -0.1);
    case WEFT_CONTROLLER_PI:
        return h[0] * pow(e[0], -0.8) * pow(e[1], 0.31);
    case WEFT_CONTROLLER_I:
        return h[0] / e[0];
    case WEFT_CONTROLLER_EXPLICIT_GUSTAFSSON:
        return h[0] * gustafsson(0.367, 0.268, e[0], e[1]);
    case WEFT_CONTROLLER_IMPLICIT_GUSTAFSSON:
        return h[0] * ratio * gustafsson(0.98, 0.95, e[0], e[1]);
    default:
        return h[1] == 0.0 ? h[0] / e[0]
                           : h[0]
                                 * fmin(ratio * gustafsson(0.95, 0.95, e[0], e[1]),
                                        gustafsson(0.367, 0.268, e[0], e[1]));
    }
}

/* Every step is given the error that it shall have. */
START_TEST(every_type_follows_its_law)
{
    static const double errors[] = { 0.4, 1.1, 0.06, 1.2, 0.9, 0.3, 0.02 };
    const weft_controller controller = { .type = (weft_controller_type)_i,
                                         .safety = 0.9,
                                         .bias = 1.25,
                                         .first_growth = 25.0 };
    weft_stepper_config config = controlled(&controller);
    double k, t = 0.0, y[2] = { 0.0, 0.0 }, h[2] = { 0.0 }, e[3] = { 1.0, 1.0, 1.0 };
    config.rtol = 0.0;
    config.atol_position = 1e-3;
    config.first_step = 0.01;
    const weft_ode ode = { .dim = 2, .rhs = climb, .ctx = &k };
    const weft_stepper_type *heun = test_method_named("arkode/heun_euler");
    weft_stepper_stats s = { .struct_size = sizeof s, .next_step = config.first_step };
    void *self;
    int changes = 0;
    ck_assert_int_eq(heun->create(heun, &ode, &config, &self, NULL), WEFT_OK);
    for (int i = 0; i < 14; ++i) {
        e[2] = e[1], e[1] = e[0], e[0] = errors[i % 7];
        h[1] = h[0], h[0] = s.next_step;
        k = 2.0 * e[0] / 1.25 * 1e-3 / (h[0] * h[0]);
        ck_assert_int_eq(heun->step(self, 1e6, &t, y, NULL), WEFT_OK);
        heun->stats(self, &s);
        ck_assert_double_eq_tol(s.last_step, h[0], 1e-9 * h[0]);
        const double law = 0.9 * next_by_law(controller.type, h, e);
        const double wanted = fmax(fmin(law, 25.0 * h[0]), 0.1 * h[0]);
        const bool kept = wanted > h[0] && wanted < 1.5 * h[0];
        ck_assert_double_eq_tol(s.next_step, kept ? h[0] : wanted, 1e-9 * h[0]);
        changes += !kept && wanted == law;
    }
    heun->destroy(self);
    ck_assert_int_ge(changes, 5);
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
    trial_run r;
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
    trial_run r;
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

TEST_SUITE(controllers)
{
    Suite *suite = suite_create("controllers");
    TCase *tcase = tcase_create("controllers");
#ifdef HAVE_ARKODE
    tcase_add_test(tcase, every_type_keeps_the_tolerance_by_steps_of_its_own);
    tcase_add_loop_test(tcase, every_type_follows_its_law, 1, TYPES);
    tcase_add_test(tcase, pi_is_the_default);
    tcase_add_test(tcase, every_knob_changes_the_steps);
    tcase_add_test(tcase, careful_controllers_take_more_steps);
    tcase_add_test(tcase, safety_may_be_1);
    tcase_add_test(tcase, what_makes_no_sense_is_refused);
    tcase_add_test(tcase, what_is_in_force_is_told);
    tcase_add_test(tcase, a_config_of_an_older_version_has_no_controller);
    tcase_add_test(tcase, tables_are_found_by_their_full_names);
#endif
    tcase_add_test(tcase, a_scene_sets_every_knob);
    tcase_add_test(tcase, a_scene_without_the_key_has_no_controller);
    suite_add_tcase(suite, tcase);
    return suite;
}
