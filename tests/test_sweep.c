/* SPDX-License-Identifier: BSD-3-Clause */
/* Sweeps: which runs a scene stands for, and what is said of wrong ones. */
#include <math.h>
#include <stdlib.h>

#include "scene_load.h"

#define HEAD                                                                           \
    "weft: 1\n"                                                                        \
    "cloth:\n"                                                                         \
    "  grid: {rows: 3, cols: 4, spacing: 0.1}\n"                                       \
    "  mass: 1.0e-2\n"                                                                 \
    "  springs: {stretch: {stiffness: 100}, shear: {stiffness: 7}}\n"                  \
    "  pins: [top-left, top-right]\n"                                                  \
    "stepper: {plugin: gsl, method: rkf45}\n"                                          \
    "run: {duration: 1, fps: 3}\n"

static weft_sweep *good_sweep(const weft_scene_def *def)
{
    weft_error err = { 0 };
    weft_sweep *sweep = NULL;
    const weft_status status = weft_sweep_load(def, &sweep, &found, &err);
    ck_assert_msg(status == WEFT_OK, "%s\n%s", err.message, all_found());
    return sweep;
}

static weft_sweep *sweep_of(const char *text)
{
    const weft_scene_def def = scene_of_text(text);
    return good_sweep(&def);
}

static const char *bad_sweep(const weft_scene_def *def)
{
    weft_error err = { 0 };
    weft_sweep *sweep = NULL;
    ck_assert_int_eq(weft_sweep_load(def, &sweep, &found, &err), WEFT_BAD_SCENE);
    ck_assert_ptr_null(sweep);
    ck_assert_uint_gt(found.errors, 0);
    return all_found();
}

static weft_scene *run_of(const weft_sweep *sweep, size_t run)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    const weft_status status = weft_sweep_scene(sweep, run, &scene, &err);
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
    return scene;
}

static double stretch_of(const weft_scene *scene)
{
    return weft_scene_cloth(scene)->springs[WEFT_STRETCH].stiffness;
}

START_TEST(every_combination_is_a_run_and_the_last_key_varies_fastest)
{
    static const char *const methods[] = { "rk4", "rk8pd" };
    static const double values[] = { 10.0, 200.0, 3000.0 };
    weft_sweep *sweep = sweep_of(HEAD "sweep:\n"
                                      "  stepper.method: [rk4, rk8pd]\n"
                                      "  cloth.springs.stretch.stiffness: [10, 2.0e2, "
                                      "3000]\n");
    ck_assert_uint_eq(weft_sweep_runs(sweep), 6);
    ck_assert_uint_eq(weft_sweep_keys(sweep), 2);
    ck_assert_str_eq(weft_sweep_key(sweep, 0), "stepper.method");
    ck_assert_str_eq(weft_sweep_key(sweep, 1), "cloth.springs.stretch.stiffness");
    ck_assert_str_eq(weft_sweep_value(sweep, 1, 5), "2.0e2");
    for (size_t i = 0; i < 6; ++i) {
        weft_scene *scene = run_of(sweep, i + 1);
        ck_assert_str_eq(weft_scene_method(scene), methods[i / 3]);
        ck_assert_str_eq(weft_sweep_value(sweep, 0, i + 1), methods[i / 3]);
        ck_assert(stretch_of(scene) == values[i % 3]);
        ck_assert(weft_scene_cloth(scene)->springs[WEFT_SHEAR].stiffness == 7.0);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(zipped_lists_are_taken_side_by_side)
{
    weft_sweep *sweep = sweep_of(HEAD "sweep:\n"
                                      "  run.fps: [10, 20, 30]\n"
                                      "  zip: true\n"
                                      "  'run.duration': [3, 2, 1]\n");
    ck_assert_uint_eq(weft_sweep_runs(sweep), 3);
    ck_assert_uint_eq(weft_sweep_keys(sweep), 2);
    for (size_t i = 1; i <= 3; ++i) {
        weft_scene *scene = run_of(sweep, i);
        ck_assert(weft_scene_run(scene)->fps == 10.0 * (double)i);
        ck_assert(weft_scene_run(scene)->duration == 4.0 - (double)i);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(values_may_be_lists_mappings_and_null_which_removes)
{
    weft_sweep *sweep
        = sweep_of(HEAD "sweep:\n"
                        "  zip: true\n"
                        "  cloth.springs.shear: [null, {stiffness: 3, damping: 1}]\n"
                        "  cloth.pins.1: [bottom-left, null]\n"
                        "  forces.gravity: [[0, -1.6, 0], [0, 0, 0]]\n");
    ck_assert_str_eq(weft_sweep_value(sweep, 0, 1), "null");
    ck_assert_str_eq(weft_sweep_value(sweep, 0, 2), "{stiffness: 3, damping: 1}");
    ck_assert_str_eq(weft_sweep_value(sweep, 2, 1), "[0, -1.6, 0]");
    weft_scene *first = run_of(sweep, 1), *second = run_of(sweep, 2);
    ck_assert(!weft_scene_cloth(first)->springs[WEFT_SHEAR].present);
    ck_assert_uint_eq(weft_scene_cloth(first)->pin_count, 2);
    ck_assert(weft_scene_cloth(first)->gravity[1] == -1.6);
    ck_assert(weft_scene_cloth(second)->springs[WEFT_SHEAR].damping == 1.0);
    ck_assert_uint_eq(weft_scene_cloth(second)->pin_count, 1);
    weft_scene_destroy(second);
    weft_scene_destroy(first);
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(methods_are_varied_with_their_plugins_and_crossed_with_other_keys)
{
    static const char *const plugins[] = { "verlet", "arkode", "gsl" };
    weft_sweep *sweep
        = sweep_of(HEAD "sweep:\n"
                        "  stepper.method: [verlet/velocity_verlet, arkode/cash_karp, "
                        "rk4]\n"
                        "  stepper.fixed_step: [0.1, 0.2]\n");
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_uint_eq(weft_sweep_runs(sweep), 6);
    ck_assert_str_eq(weft_sweep_value(sweep, 0, 1), "verlet/velocity_verlet");
    for (size_t i = 0; i < 6; ++i) {
        weft_scene *scene = run_of(sweep, i + 1);
        weft_scene *again = good_text(weft_scene_text(scene));
        ck_assert_str_eq(weft_scene_plugin(scene), plugins[i / 2]);
        ck_assert_str_eq(weft_scene_plugin(again), plugins[i / 2]);
        ck_assert_str_eq(weft_scene_method(again), weft_scene_method(scene));
        ck_assert(weft_scene_step(again) == (i % 2 == 0 ? 0.1 : 0.2));
        weft_scene_destroy(again);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(a_sweep_over_methods_drops_keys_of_the_scene_and_the_command_line)
{
    static const char *const sets[] = { "stepper.atol=1e-3" };
    weft_scene_def def
        = scene_of_text("weft: 1\ncloth: {mass: 1, grid: {rows: 2, cols: 2, spacing: "
                        "1}}\nstepper: {plugin: gsl, method: rk4, rtol: 1}\nrun: "
                        "{duration: 1}\nsweep:\n  zip: true\n"
                        "  stepper.method: [rk4, verlet/velocity_verlet]\n"
                        "  stepper.fixed_step: [null, 0.01]\n");
    def.sets = sets;
    def.set_count = 1;
    weft_sweep *sweep = good_sweep(&def);
    ck_assert_ptr_nonnull(
        strstr(all_found(),
               "scene.yaml:7:11: warning: rtol (line 3, column 37), atol (override "
               "stepper.atol) dropped: the method has no error control (in 1 of 2 "
               "runs, first stepper.method=verlet/velocity_verlet, "
               "stepper.fixed_step=0.01)\n"));
    ck_assert_uint_eq(found.warnings, 1);
    weft_scene *adaptive = run_of(sweep, 1);
    ck_assert(weft_scene_config(adaptive)->atol_position == 1e-3);
    weft_scene_destroy(adaptive);
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(the_text_of_a_run_is_a_plain_scene_of_the_same_run)
{
    weft_sweep *sweep = sweep_of(HEAD "sweep: {cloth.springs.stretch: [{stiffness: 1}, "
                                      "{stiffness: 2}], forces.wind.drag: [0.5, 0.25], "
                                      "forces.wind.velocity: [[0, 0, 3]]}\n");
    for (size_t i = 1; i <= 4; ++i) {
        weft_scene *scene = run_of(sweep, i);
        weft_scene *again = good_text(weft_scene_text(scene));
        ck_assert_ptr_null(strstr(weft_scene_text(scene), "sweep"));
        ck_assert_str_eq(weft_scene_text(again), weft_scene_text(scene));
        ck_assert(stretch_of(again) == stretch_of(scene));
        ck_assert(weft_scene_cloth(again)->wind_drag
                  == weft_scene_cloth(scene)->wind_drag);
        ck_assert_str_eq(weft_scene_name(scene), "scene");
        weft_scene_destroy(again);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(a_key_shared_by_an_alias_is_changed_where_it_is_named_only)
{
    weft_sweep *sweep
        = sweep_of("weft: 1\n"
                   "cloth:\n"
                   "  grid: {rows: 3, cols: 4, spacing: 0.1}\n"
                   "  mass: 1\n"
                   "  springs: {stretch: &soft {stiffness: 9}, shear: *soft}\n"
                   "  pins: [top]\n"
                   "stepper: {plugin: gsl, method: rk4}\n"
                   "run: {duration: 1}\n"
                   "sweep: {cloth.springs.shear.stiffness: [1, 2]}\n");
    weft_scene *scene = run_of(sweep, 2);
    ck_assert(stretch_of(scene) == 9.0);
    ck_assert(weft_scene_cloth(scene)->springs[WEFT_SHEAR].stiffness == 2.0);
    weft_scene_destroy(scene);
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(a_scene_without_a_sweep_is_one_run_of_its_own_text)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    weft_sweep *sweep = sweep_of(HEAD);
    ck_assert_uint_eq(weft_sweep_runs(sweep), 1);
    ck_assert_uint_eq(weft_sweep_keys(sweep), 0);
    for (int i = 0; i < 2; ++i) {
        scene = run_of(sweep, 1);
        ck_assert_str_eq(weft_scene_text(scene), HEAD);
        weft_scene_destroy(scene);
    }
    ck_assert_int_eq(weft_sweep_scene(sweep, 2, &scene, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sweep_scene(sweep, 0, &scene, &err), WEFT_INVALID);
    ck_assert_ptr_null(scene);
    weft_sweep_destroy(sweep);
}
END_TEST

#define FLOW                                                                           \
    "\"cloth\": {\"grid\": {\"rows\": 3, \"cols\": 4, \"spacing\": 0.1}, "             \
    "\"mass\": 0.01, \"springs\": {\"stretch\": {\"stiffness\": 100}}}, "              \
    "\"stepper\": {\"plugin\": \"gsl\", \"method\": \"rkf45\"}, "                      \
    "\"run\": {\"duration\": 1}"
#define REST                                                                           \
    "cloth: {grid: {rows: 3, cols: 4, spacing: 0.1}, mass: 0.01, springs: {stretch: "  \
    "&s {stiffness: 100}, shear: *s}}\n"                                               \
    "stepper: {plugin: gsl, method: rkf45}\n"                                          \
    "run: {duration: 1}\n"

/* Ways to write one scene, most of them without a line that another could precede. */
static const char *const forms[] = {
    "weft: 1\n" REST,
    "{\"weft\":1," FLOW "}",
    "{weft: 1,\n " FLOW "\n}\n",
    "# head\n%YAML 1.1\n---\n{\"weft\":1," FLOW "}\n...\n",
    "# head\n%YAML 1.1\n---\nweft: 1\n" REST,
    "--- # head\nweft: 1\n" REST "...\n# tail\n",
    "\xEF\xBB\xBFweft: 1\n" REST,
    "\xEF\xBB\xBF{\"weft\":1," FLOW "}",
    "  # head\n  weft: 1\n  run: {duration: 1}\n  stepper: {plugin: gsl, method: "
    "rkf45}\n  cloth: {grid: {rows: 3, cols: 4, spacing: 0.1}, mass: 1}\n",
    "\"weft\": 1\n" REST,
    "'weft': 1\n" REST,
    "? weft\n: 1\n" REST,
    "&key weft: &one 1\n" REST,
    "&root\nweft: 1\n" REST,
    "&root {\"weft\":1," FLOW "}",
    "!!map\nweft: 1\n" REST,
    "!!map {\"weft\":1," FLOW "}",
    "weft: 1\rrun: {duration: 1}\rstepper: {plugin: gsl, method: rkf45}\r"
    "cloth: {grid: {rows: 3, cols: 4, spacing: 0.1}, mass: 1}\r",
    "# \xE2\x80\xA8weft: 1\r\n" REST,
};

START_TEST(a_scene_without_a_name_is_read_again_and_again_however_it_is_written)
{
    weft_scene_def def = scene_of_text(forms[_i]);
    def.file = "folder/forms.yaml";
    weft_sweep *sweep = good_sweep(&def);
    weft_scene *first = run_of(sweep, 1), *again = run_of(sweep, 1);
    weft_scene *alone = good_scene(&def), *back = good_text(weft_scene_text(first));
    ck_assert_str_eq(weft_scene_name(first), "forms");
    ck_assert_str_eq(weft_scene_name(back), "forms");
    ck_assert_str_eq(weft_scene_text(again), weft_scene_text(first));
    ck_assert_str_eq(weft_scene_text(alone), weft_scene_text(first));
    ck_assert_uint_eq(weft_scene_cloth(back)->cols, 4);
    weft_scene_destroy(back);
    weft_scene_destroy(alone);
    weft_scene_destroy(again);
    weft_scene_destroy(first);
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(overrides_reach_the_sweep_and_are_part_of_every_run)
{
    static const char *const sets[]
        = { "run.fps=7", "sweep={run.duration: [2, 3, 4], stepper.method: [rk4]}",
            "sweep.zip=false" };
    weft_scene_def def = scene_of_text(HEAD "sweep: {run.duration: [1, 2]}\n");
    def.sets = sets;
    def.set_count = 3;
    weft_sweep *sweep = good_sweep(&def);
    ck_assert_uint_eq(weft_sweep_runs(sweep), 3);
    weft_scene *scene = run_of(sweep, 3);
    ck_assert(weft_scene_run(scene)->duration == 4.0);
    ck_assert(weft_scene_run(scene)->fps == 7.0);
    ck_assert_ptr_null(strstr(weft_scene_text(scene), "sweep"));
    weft_scene_destroy(scene);
    weft_sweep_destroy(sweep);

    static const char *const none[] = { "sweep=null" };
    def.sets = none;
    def.set_count = 1;
    scene = good_scene(&def);
    ck_assert(weft_scene_run(scene)->duration == 1.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_key_that_an_override_removes_from_a_value_is_shown_as_null)
{
    static const char *const sets[] = { "sweep.run.0.fps=null" };
    weft_scene_def def = scene_of_text(HEAD "sweep: {run: [{duration: 1, fps: 3}]}\n");
    def.sets = sets;
    def.set_count = 1;
    weft_sweep *sweep = good_sweep(&def);
    ck_assert_str_eq(weft_sweep_value(sweep, 0, 1), "{duration: 1, fps: null}");
    weft_scene *scene = run_of(sweep, 1);
    ck_assert(weft_scene_run(scene)->fps == 30.0);
    weft_scene_destroy(scene);
    weft_sweep_destroy(sweep);
}
END_TEST

START_TEST(one_scene_is_not_read_from_a_sweep_and_the_error_names_batch)
{
    const weft_scene_def def
        = scene_of_text(HEAD "sweep: {run.fps: [1, 2], run.duration: [1, 2, 3]}\n");
    ck_assert_str_eq(bad_scene(&def),
                     "scene.yaml:9:1: error: sweep makes 6 runs of this scene: 'weft "
                     "batch' runs them\n"
                     "sweep: {run.fps: [1, 2], run.duration: [1, 2, 3]}\n"
                     "^\n");
}
END_TEST

/* The values of each key are a permutation of one number in each of n equal parts of
 * its range; of stiffness, the parts have equal ratios. */
START_TEST(a_sample_hits_each_part_of_each_range_once)
{
    static const size_t sizes[] = { 1, 2, 5, 100, 1000 };
    const size_t n = sizes[_i];
    char text[1024];
    (void)snprintf(text, sizeof text,
                   HEAD "sweep: {sample: %zu, seed: 9, run.fps: [30, 10, 20], "
                        "cloth.springs.stretch.stiffness: [1, 1.0e+6], "
                        "forces.damping: [0, 1], "
                        "log: [cloth.springs.stretch.stiffness]}\n",
                   n);
    weft_sweep *sweep = sweep_of(text);
    char *hit = calloc(3 * n, 1);
    ck_assert_uint_eq(weft_sweep_runs(sweep), n);
    for (size_t i = 1; i <= n; ++i) {
        const double x[]
            = { (strtod(weft_sweep_value(sweep, 0, i), NULL) - 10.0) / 20.0,
                log10(strtod(weft_sweep_value(sweep, 1, i), NULL)) / 6.0,
                strtod(weft_sweep_value(sweep, 2, i), NULL) };
        for (size_t k = 0; k < 3; ++k) {
            ck_assert(x[k] >= 0.0 && x[k] < 1.0);
            const size_t part = (size_t)(x[k] * (double)n);
            ck_assert_int_eq(hit[k * n + part]++, 0);
        }
        weft_scene *scene = run_of(sweep, i);
        ck_assert(weft_scene_run(scene)->fps
                  == strtod(weft_sweep_value(sweep, 0, i), NULL));
        weft_scene_destroy(scene);
    }
    free(hit);
    weft_sweep_destroy(sweep);
}
END_TEST

/* They were computed from the definition in docs/guides/sweep-parameters.md by another
 * program. */
START_TEST(a_sample_has_the_same_values_everywhere)
{
    static const char *const values[2][5]
        = { { "37.53468469833024", "86.28017812478356", "79.38240027683787",
              "23.993304813979194", "51.68558233627118" },
            { "0.18375427422379279", "0.1273854017620838", "0.37877443026025664",
              "0.14844605515463574", "0.26912022904810917" } };
    weft_sweep *sweep
        = sweep_of(HEAD "sweep: {cloth.springs.stretch.stiffness: [100, 10], "
                        "cloth.mass: [0.1, 0.4], log: [cloth.mass], sample: 5, "
                        "seed: 3}\n");
    weft_sweep *other
        = sweep_of(HEAD "sweep: {cloth.springs.stretch.stiffness: [100, 10], "
                        "run.fps: [1, 2], sample: 5}\n");
    for (size_t i = 1; i <= 5; ++i) {
        ck_assert_str_eq(weft_sweep_value(sweep, 0, i), values[0][i - 1]);
        ck_assert_str_eq(weft_sweep_value(sweep, 1, i), values[1][i - 1]);
        ck_assert_str_ne(weft_sweep_value(other, 0, i), values[0][i - 1]);
    }
    weft_sweep_destroy(other);
    weft_sweep_destroy(sweep);
}
END_TEST

/* Told at the place in the sweep, once, whatever the number of runs. */
static const struct {
    const char *sweep, *told;
} wrong[] = {
    { "sweep: {stepper.methd: [rk4, rkf45]}\n",
      "scene.yaml:9:17: error: unknown key 'methd' in stepper (did you mean "
      "'method'?)\n" },
    { "sweep: {'steper.method': [rk4]}\n",
      "scene.yaml:9:10: error: unknown key 'steper' in the scene (did you mean "
      "'stepper'?)\n" },
    { "sweep: {run.fps: [1, abc, -3, 30]}\n",
      "scene.yaml:9:22: error: fps must be a number > 0 [1/s], not 'abc' (in 1 of 4 "
      "runs, first run.fps=abc)\n" },
    { "sweep: {run.fps: [1, abc, -3, 30]}\n",
      "scene.yaml:9:27: error: fps must be a number > 0 [1/s], not '-3' (in 1 of 4 "
      "runs, first run.fps=-3)\n" },
    { "sweep: {stepper.method: [rk4, rkf], run.fps: [1, 2]}\n", "method 'rkf'" },
    { "sweep: {stepper.method: [rk4, rkf], run.fps: [1, 2]}\n",
      "(in 2 of 4 runs, first stepper.method=rkf, run.fps=1)\n" },
    { "sweep: {run.fps: []}\n",
      "scene.yaml:9:18: error: run.fps has no value to run\n" },
    { "sweep: {run.fps: 30}\n",
      "scene.yaml:9:18: error: run.fps must be a list of values to run, not '30'\n" },
    { "sweep: {}\n", "scene.yaml:9:1: error: sweep varies no key\n" },
    { "sweep: {zip: true}\n", "scene.yaml:9:1: error: sweep varies no key\n" },
    { "sweep: [run.fps]\n",
      "scene.yaml:9:8: error: sweep must be a mapping as {stepper.method: [rk4, "
      "rkf45]}, not a list of 1\n" },
    { "sweep: {zip: yes, run.fps: [1]}\n",
      "scene.yaml:9:14: error: zip must be true or false, not 'yes'" },
    { "sweep: {zip: 'true', run.fps: [1]}\n",
      "9:14: error: zip must be true or false, not the text 'true' (remove the "
      "quotes)" },
    { "sweep: {zip: true, run.fps: [1, 2, 3], run.duration: [1, 2]}\n",
      "scene.yaml:9:54: error: 2 values, but run.fps has 3: zip takes lists of one "
      "length\n" },
    { "sweep: {run.fps: [1], run.fps: [2]}\n",
      "scene.yaml:9:23: error: run.fps is varied twice (first at line 9, column 9)\n" },
    { "sweep: {stepper.method: [rk4], stepper: [{plugin: gsl, method: rk4}]}\n",
      "scene.yaml:9:32: error: stepper is varied twice (first at line 9, column 9)\n" },
    { "sweep: {stepper.method: [verlet/velocity_verlet], stepper.fixed_step: [1], "
      "stepper.rtol: [1]}\n",
      "scene.yaml:9:84: error: rtol would not be used by method 'velocity_verlet'" },
    { "sweep: {sweep.zip: [true]}\n",
      "scene.yaml:9:9: error: a sweep cannot vary itself\n" },
    { "sweep: {run.fps: [1]}\nsweep: {run.fps: [2]}\n",
      "scene.yaml:10:1: error: duplicate key 'sweep' in the scene (the first is at "
      "line "
      "9, column 1)\n" },
    { "sweep: {[run.fps]: [1]}\n",
      "scene.yaml:9:9: error: the keys of a sweep are paths as stepper.method\n" },
    { "sweep: {run..fps: [1]}\n", "scene.yaml:9:13: error: a key is missing here" },
    { "sweep: {cloth.pins.9: [top]}\n", "scene.yaml:9:20: error: '9' is no element of "
                                        "this list of 2; the first is 0, the "
                                        "next free one 2\n" },
    { "sweep: {sample: 0, run.fps: [1, 2]}\n",
      "scene.yaml:9:17: error: sample must be an integer >= 1 and <= 100000, not '0'" },
    { "sweep: {sample: 2.5, run.fps: [1, 2]}\n",
      "scene.yaml:9:17: error: sample must be an integer >= 1 and <= 100000" },
    { "sweep: {sample: 100001, run.fps: [1, 2]}\n", "9:17: error: sample must be" },
    { "sweep: {seed: -1, run.fps: [1, 2]}\n", "9:15: error: seed must be" },
    { "sweep: {sample: 2}\n", "scene.yaml:9:1: error: sweep varies no key\n" },
    { "sweep: {sample: 2, stepper.method: [rk4, rkf45]}\n",
      "scene.yaml:9:37: error: a sample draws stepper.method from finite numbers, not "
      "'rk4'\n" },
    { "sweep: {sample: 2, run.fps: [1, .inf]}\n", "finite numbers, not '.inf'\n" },
    { "sweep: {sample: 2, forces.gravity: [[0, 0, 1], [0, 0, 2]]}\n",
      "scene.yaml:9:37: error: a sample draws forces.gravity from finite numbers, not "
      "a "
      "list of 3\n" },
    { "sweep: {sample: 2, run.fps: [3, 3.0]}\n",
      "scene.yaml:9:29: error: a sample needs a range of run.fps: two numbers that "
      "differ\n" },
    { "sweep: {sample: 2, run.fps: [-1.7e+308, 1.7e+308]}\n", "that differ less\n" },
    { "sweep: {sample: 2, log: [forces.damping], forces.damping: [0, 1]}\n",
      "scene.yaml:9:60: error: a sample draws forces.damping from finite numbers > 0, "
      "not '0'\n" },
    { "sweep: {log: run.fps, run.fps: [1, 2]}\n",
      "scene.yaml:9:14: error: log must be a list of keys of the sweep, not "
      "'run.fps'\n" },
    { "sweep: {log: [run.fp], run.fps: [1, 2]}\n",
      "scene.yaml:9:15: error: log must name keys of the sweep, not 'run.fp'\n" },
    { "sweep: {sample: 2, zip: true, run.fps: [1, 2]}\n",
      "scene.yaml:9:1: error: sample and zip exclude each other\n" },
    { "sweep: {sample: 2, cloth.grid.rows: [3, 9]}\n",
      "scene.yaml:9:37: error: rows must be an integer" },
    { "sweep: {run.fps.x: [1]}\n",
      "scene.yaml:9:17: error: 'fps' is a single value: nothing can be set inside\n" },
};

START_TEST(what_is_wrong_is_told_at_its_place_in_the_sweep)
{
    char text[1024];
    (void)snprintf(text, sizeof text, HEAD "%s", wrong[_i].sweep);
    const weft_scene_def def = scene_of_text(text);
    const char *told = bad_sweep(&def);
    ck_assert_msg(strstr(told, wrong[_i].told) != NULL, "no '%s' in:\n%s",
                  wrong[_i].told, told);
}
END_TEST

START_TEST(a_mistake_outside_the_sweep_is_told_once_and_without_runs)
{
    const weft_scene_def def
        = scene_of_text("weft: 1\ncloth: {mass: 1, grid: {rows: 2, cols: 2, spacing: "
                        "x}}\nstepper: {plugin: gsl, method: rk4}\nrun: {duration: 1}\n"
                        "sweep: {run.fps: [1, 2, 3]}\n");
    const char *told = bad_sweep(&def);
    ck_assert_uint_eq(found.errors, 1);
    ck_assert_ptr_nonnull(strstr(told, "scene.yaml:2:52: error: spacing must be"));
    ck_assert_ptr_null(strstr(told, "runs"));
}
END_TEST

START_TEST(a_message_that_is_too_long_ends_behind_a_word)
{
    char text[4096], *message = found.items[0].message;
    for (int width = 1; width < 40; ++width) {
        size_t used = (size_t)snprintf(text, sizeof text, "%s",
                                       HEAD "sweep:\n  run.fps: [1, -1]\n");
        for (int i = 0; i < 12; ++i) {
            used += (size_t)snprintf(text + used, sizeof text - used,
                                     "  cloth.loads.%d: [{at: left, mass: 7.%0*d}]\n",
                                     i, width, 0);
        }
        const weft_scene_def def = scene_of_text(text);
        (void)bad_sweep(&def);
        const char *end = message + strlen(message) - strlen(" ...");
        ck_assert_msg(strcmp(end, " ...") == 0, "%s", message);
        ck_assert_msg(end[-1] == ',' || end[-1] == ':', "%s", message);
    }
}
END_TEST

START_TEST(an_override_of_what_is_varied_would_be_lost_and_is_refused)
{
    static const char *const sets[] = { "run.fps=3", "stepper={plugin: gsl}" };
    weft_scene_def def
        = scene_of_text(HEAD "sweep: {run.fps: [1], stepper.method: [rk4]}\n");
    def.sets = sets;
    def.set_count = 2;
    const char *told = bad_sweep(&def);
    ck_assert_uint_eq(found.errors, 2);
    ck_assert_ptr_nonnull(strstr(told, "override run.fps:1: error: run.fps "
                                       "is varied by sweep (line 9, column 9)\n"));
    ck_assert_ptr_nonnull(strstr(told, "override stepper:1: error: "
                                       "stepper.method is varied by sweep"));
}
END_TEST

START_TEST(the_number_of_runs_is_bounded)
{
    enum { MANY = 100001 };
    static const char tens[] = HEAD "sweep:\n"
                                    "  run.fps: [1,2,3,4,5,6,7,8,9,10]\n"
                                    "  cloth.mass: [1,2,3,4,5,6,7,8,9,10]\n"
                                    "  run.duration: [1,2,3,4,5,6,7,8,9,10]\n";
    weft_sweep *sweep = sweep_of(tens);
    ck_assert_uint_eq(weft_sweep_runs(sweep), 1000);
    ck_assert_str_eq(weft_sweep_value(sweep, 0, 1000), "10");
    ck_assert_str_eq(weft_sweep_value(sweep, 1, 11), "2");
    ck_assert_str_eq(weft_sweep_value(sweep, 2, 11), "1");
    weft_sweep_destroy(sweep);

    char *text = malloc(sizeof HEAD + 2 * MANY + 64);
    ck_assert_ptr_nonnull(text);
    size_t used = (size_t)sprintf(text, HEAD "sweep:\n  run.fps: [");
    for (int i = 0; i < MANY; ++i) {
        used += (size_t)sprintf(text + used, "%s1", i == 0 ? "" : ",");
    }
    (void)sprintf(text + used, "]\n");
    const weft_scene_def def = scene_of_text(text);
    ck_assert_ptr_nonnull(
        strstr(bad_sweep(&def), "scene.yaml:9:1: error: more than 100000 comb"));
    free(text);
}
END_TEST

START_TEST(more_keys_than_there_is_room_for_are_refused)
{
    char text[4096];
    size_t used = (size_t)snprintf(text, sizeof text, "%ssweep:\n", HEAD);
    for (int i = 0; i < 17; ++i) {
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "  cloth.loads.%d: [{at: left, mass: 1}]\n", i);
    }
    const weft_scene_def def = scene_of_text(text);
    ck_assert_ptr_nonnull(
        strstr(bad_sweep(&def), "scene.yaml:26:3: error: more than 16 keys\n"));
}
END_TEST

TEST_SUITE(sweep)
{
    Suite *all = suite_create("sweep");
    TCase *runs = tcase_create("runs");
    tcase_set_timeout(runs, 120);
    tcase_add_test(runs, every_combination_is_a_run_and_the_last_key_varies_fastest);
    tcase_add_test(runs, zipped_lists_are_taken_side_by_side);
    tcase_add_test(runs, values_may_be_lists_mappings_and_null_which_removes);
    tcase_add_test(runs,
                   methods_are_varied_with_their_plugins_and_crossed_with_other_keys);
    tcase_add_test(runs,
                   a_sweep_over_methods_drops_keys_of_the_scene_and_the_command_line);
    tcase_add_test(runs, the_text_of_a_run_is_a_plain_scene_of_the_same_run);
    tcase_add_test(runs, a_key_shared_by_an_alias_is_changed_where_it_is_named_only);
    tcase_add_test(runs, a_scene_without_a_sweep_is_one_run_of_its_own_text);
    tcase_add_loop_test(
        runs, a_scene_without_a_name_is_read_again_and_again_however_it_is_written, 0,
        sizeof forms / sizeof forms[0]);
    tcase_add_test(runs, overrides_reach_the_sweep_and_are_part_of_every_run);
    tcase_add_test(runs, a_key_that_an_override_removes_from_a_value_is_shown_as_null);
    tcase_add_test(runs, one_scene_is_not_read_from_a_sweep_and_the_error_names_batch);
    tcase_add_loop_test(runs, a_sample_hits_each_part_of_each_range_once, 0, 5);
    tcase_add_test(runs, a_sample_has_the_same_values_everywhere);
    suite_add_tcase(all, runs);
    TCase *errors = tcase_create("errors");
    tcase_set_timeout(errors, 120);
    tcase_add_loop_test(errors, what_is_wrong_is_told_at_its_place_in_the_sweep, 0,
                        sizeof wrong / sizeof wrong[0]);
    tcase_add_test(errors, a_mistake_outside_the_sweep_is_told_once_and_without_runs);
    tcase_add_test(errors, a_message_that_is_too_long_ends_behind_a_word);
    tcase_add_test(errors, an_override_of_what_is_varied_would_be_lost_and_is_refused);
    tcase_add_test(errors, the_number_of_runs_is_bounded);
    tcase_add_test(errors, more_keys_than_there_is_room_for_are_refused);
    suite_add_tcase(all, errors);
    return all;
}
