/* SPDX-License-Identifier: BSD-3-Clause */
/* Mistakes in scenes: each has its exact message at its exact place. Every scene of
 * tests/scenes-bad has a .txt with all that is said of it. */
#include <dirent.h>
#include <stdlib.h>

#include "scene_load.h"

#define FOLDER "tests/scenes-bad"

#define CLOTH   "cloth:\n  grid: {rows: 3, cols: 4, spacing: 0.1}\n  mass: 0.01\n"
#define STEPPER "stepper: {plugin: gsl, method: rkf45}\n"
#define RUN     "run: {duration: 1}\n"

static const char *read_text(const char *path)
{
    static char text[64 * 1024];
    FILE *stream = fopen(path, "rb");
    ck_assert_msg(stream != NULL, "no file %s", path);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    (void)fclose(stream);
    return text;
}

static int is_scene(const struct dirent *item)
{
    const char *dot = strrchr(item->d_name, '.');
    return dot != NULL && strcmp(dot, ".yaml") == 0;
}

START_TEST(bad_scenes_get_their_exact_messages)
{
    struct dirent **items = NULL;
    const int count = scandir(FOLDER, &items, is_scene, alphasort);
    ck_assert_int_ge(count, 50);
    for (int i = 0; i < count; ++i) {
        char path[512], wanted[512];
        (void)snprintf(path, sizeof path, FOLDER "/%s", items[i]->d_name);
        (void)snprintf(wanted, sizeof wanted, "%s", path);
        strcpy(strrchr(wanted, '.'), ".txt");
        weft_scene_def def = weft_scene_def_default();
        def.file = path;
        def.find_plugin = find_fake;
        const char *told = bad_scene(&def);
        ck_assert_msg(strcmp(told, read_text(wanted)) == 0, "%s: found\n%s", path,
                      told);
        free(items[i]);
    }
    free(items);
}
END_TEST

START_TEST(twenty_mistakes_are_shown_and_all_are_counted)
{
    weft_scene_def def = weft_scene_def_default();
    def.file = FOLDER "/many.yaml";
    def.find_plugin = find_fake;
    (void)bad_scene(&def);
    ck_assert_uint_eq(found.count, WEFT_DIAGNOSTICS_MAX);
    ck_assert_uint_eq(found.errors, 25);
    for (size_t i = 1; i < found.count; ++i) {
        ck_assert_int_eq(found.items[i].line, found.items[i - 1].line + 1);
    }
}
END_TEST

START_TEST(too_much_text_is_refused_before_it_is_parsed)
{
    const size_t size = ((size_t)16 << 20) + 1;
    char *text = malloc(size);
    ck_assert_ptr_nonnull(text);
    memset(text, '[', size);
    weft_scene_def def = scene_of_text("");
    def.text = text;
    def.length = size;
    ck_assert_ptr_nonnull(strstr(bad_scene(&def), "larger than 16 MiB"));
    def.length = size - 1;
    ck_assert_ptr_nonnull(strstr(bad_scene(&def), ":1:33: error: nested more than 32"));
    for (size_t i = 1; i < size; i += 2) {
        text[i] = ',';
    }
    ck_assert_ptr_nonnull(strstr(bad_scene(&def), "error: "));
    memset(text + 1, '1', size - 1);
    ck_assert_ptr_nonnull(strstr(bad_scene(&def), "error: "));
    free(text);
}
END_TEST

START_TEST(a_diagnostic_is_formatted_as_snprintf_would)
{
    weft_diagnostic item = { .line = 3,
                             .column = 7,
                             .place = "x.yaml",
                             .message = "no",
                             .source = "\tab c",
                             .caret = 3 };
    char text[100], shorter[12];
    static const char wanted[] = "x.yaml:3:7: error: no\n\tab c\n\t ^";
    const int length = (int)strlen(wanted);
    ck_assert_int_eq(weft_diagnostic_format(&item, text, sizeof text), length);
    ck_assert_str_eq(text, wanted);
    ck_assert_int_eq(weft_diagnostic_format(&item, shorter, sizeof shorter), length);
    ck_assert_str_eq(shorter, "x.yaml:3:7:");
    item.warning = true;
    item.caret = item.line = item.column = 0;
    (void)weft_diagnostic_format(&item, text, sizeof text);
    ck_assert_str_eq(text, "x.yaml: warning: no");
}
END_TEST

/* Scenes that are right, but look as if something was meant otherwise. */
static const struct {
    const char *text, *told;
} doubtful[] = {
    { "weft: 1\n" CLOTH "  pins: [left, {rows: all, cols: [1, -1]}]\n" STEPPER RUN,
      "scene.yaml:5:3: warning: all 12 particles are pinned: nothing will move freely\n"
      "  pins: [left, {rows: all, cols: [1, -1]}]\n"
      "  ^\n" },
    { "weft: 1\ncloth:\n  grid: {rows: 1, cols: 2, spacing: 1}\n  mass: 1\n  springs:\n"
      "    shear: {stiffness: 1}\n    bend: {stiffness: 1}\n" STEPPER RUN,
      "scene.yaml:6:5: warning: a grid of 1 x 2 has no shear springs\n"
      "    shear: {stiffness: 1}\n"
      "    ^\n"
      "scene.yaml:7:5: warning: a grid of 1 x 2 has no bend springs\n"
      "    bend: {stiffness: 1}\n"
      "    ^\n" },
    { "weft: 1\n" CLOTH "limit: {method: provot}\n" STEPPER RUN,
      "scene.yaml:5:8: warning: limit has no effect: cloth has no springs of the "
      "families it limits\n"
      "limit: {method: provot}\n"
      "       ^\n" },
    { "weft: 1\n"
      "cloth: {grid: {rows: 2, cols: 2, spacing: [0.2, 0.019]}, mass: 1}\n"
      "contact: {self: true}\n" STEPPER RUN,
      "scene.yaml:3:17: warning: the cells of 0.2 m x 0.019 m are more than 10 times "
      "as "
      "long as wide: contact of the cloth with itself may need very short steps\n"
      "contact: {self: true}\n"
      "                ^\n" },
    { "weft: 1\n" CLOTH STEPPER RUN "stop: {when: min_gap < 1e-3}\n",
      "scene.yaml:7:1: warning: stop has no effect: min_gap is the gap to shapes, and "
      "the scene has none\n"
      "stop: {when: min_gap < 1e-3}\n"
      "^\n" },
    { "weft: 1\n" CLOTH STEPPER RUN "stop: {at_rest: true}\n",
      "scene.yaml:7:1: warning: stop.at_rest may never be met: nothing slows a cloth "
      "that swings, as damping along springs does not; set forces.damping, for example "
      "1e-3 [kg/s], or forces.wind\n"
      "stop: {at_rest: true}\n"
      "^\n" },
    { "weft: 1\n" CLOTH "forces: {damping: 1e-3}\n" STEPPER RUN
      "stop: {at_rest: true}\n",
      "" },
    { "weft: 1\n" CLOTH
      "stepper: {plugin: gsl, method: rkf45, fixed_step: 1e-18}\n" RUN,
      "scene.yaml:5:51: warning: fixed_step 1e-18 s: a second takes 1e+18 steps\n"
      "stepper: {plugin: gsl, method: rkf45, fixed_step: 1e-18}\n"
      "                                                  ^\n" },
    { "weft: 1\n" CLOTH "stepper: {plugin: gsl, method: rkf45, atol: 1e300}\n" RUN,
      "scene.yaml:5:45: warning: atol 1e+300: errors of 1e+300 m or m/s in each step "
      "are "
      "accepted; the default is 1e-6\n"
      "stepper: {plugin: gsl, method: rkf45, atol: 1e300}\n"
      "                                            ^\n" },
    { "weft: 1\n" CLOTH "stepper: {plugin: gsl, method: rkf45, fixed_step: 0.05}\n" RUN,
      "scene.yaml:6:6: warning: fixed_step 0.05 s is longer than a frame (0.03333 s): "
      "every step will be 0.03333 s; run.fps=20 makes frames of 0.05 s\n"
      "run: {duration: 1}\n"
      "     ^\n" },
    { "weft: 1\n" CLOTH "stepper: {plugin: gsl, method: rkf45, fixed_step: 0.05}\n"
      "run: {duration: 0.2, fps: 50}\n",
      "scene.yaml:6:22: warning: fixed_step 0.05 s is longer than a frame (0.02 s): "
      "every step will be 0.02 s; run.fps=20 makes frames of 0.05 s\n"
      "run: {duration: 0.2, fps: 50}\n"
      "                     ^\n" },
    { "weft: 1\n" CLOTH "stepper: {plugin: gsl, method: rkf45, fixed_step: 0.0333333}\n"
      "run: {duration: 0.02}\n",
      "" },
    { "weft: 1\n" CLOTH "stepper: {plugin: gsl, method: rkf45, fixed_step: 0.5}\n"
      "run: {duration: 0.02}\n",
      "scene.yaml:6:7: warning: fixed_step 0.5 s is longer than the run (0.02 s): "
      "every "
      "step will be 0.02 s\n"
      "run: {duration: 0.02}\n"
      "      ^\n" },
    { "weft: 1\n" CLOTH RUN
      "stepper: {plugin: arkode, method: custom, fixed_step: 0.01,\n"
      "  butcher: {A: [[], [1]], b: [0.5, 0.4], c: [0, 0.5], order: 2}}\n",
      "scene.yaml:7:21: warning: row 1 of A adds up to 1 instead of 0.5\n"
      "  butcher: {A: [[], [1]], b: [0.5, 0.4], c: [0, 0.5], order: 2}}\n"
      "                    ^\n"
      "scene.yaml:7:30: warning: b adds up to 0.9 instead of 1\n"
      "  butcher: {A: [[], [1]], b: [0.5, 0.4], c: [0, 0.5], order: 2}}\n"
      "                             ^\n" },
};

START_TEST(doubtful_scenes_load_with_a_warning)
{
    weft_scene *scene = good_text(doubtful[_i].text);
    ck_assert_str_eq(all_found(), doubtful[_i].told);
    ck_assert_uint_eq(found.warnings, found.count);
    weft_scene_destroy(scene);
}
END_TEST

static void fails_with(const weft_scene_def *def, weft_status wanted, const char *told)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    ck_assert_int_eq(weft_scene_load(def, &scene, &found, &err), wanted);
    ck_assert_ptr_null(scene);
    ck_assert_int_eq(err.status, wanted);
    ck_assert_msg(strstr(err.message, told) != NULL, "%s", err.message);
}

START_TEST(files_that_cannot_be_read_are_named)
{
    weft_scene_def def = weft_scene_def_default();
    fails_with(&def, WEFT_INVALID, "needs a file or a text");
    def.file = "tests/no-such-scene.yaml";
    fails_with(&def, WEFT_IO, "tests/no-such-scene.yaml: No such file");
    def.file = "tests";
    fails_with(&def, WEFT_IO, "tests: Is a directory");
    weft_scene_destroy(NULL);
}
END_TEST

START_TEST(the_error_is_the_first_of_those_found)
{
    const weft_scene_def def
        = scene_of_text("weft: 1\n" CLOTH STEPPER "run: {fps: 0}\n");
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    ck_assert_int_eq(weft_scene_load(&def, &scene, &found, &err), WEFT_BAD_SCENE);
    ck_assert_str_eq(err.file, "scene.yaml");
    ck_assert_int_eq(err.line, 6);
    ck_assert_int_eq(err.column, 6);
    ck_assert_str_eq(err.message, found.items[0].message);
    ck_assert_int_eq(weft_scene_load(&def, &scene, &found, NULL), WEFT_BAD_SCENE);
}
END_TEST

TEST_SUITE(scene_errors)
{
    Suite *all = suite_create("scene errors");
    TCase *messages = tcase_create("messages");
    tcase_set_timeout(messages, 60);
    tcase_add_test(messages, bad_scenes_get_their_exact_messages);
    tcase_add_test(messages, twenty_mistakes_are_shown_and_all_are_counted);
    tcase_add_test(messages, too_much_text_is_refused_before_it_is_parsed);
    tcase_add_test(messages, a_diagnostic_is_formatted_as_snprintf_would);
    tcase_add_loop_test(messages, doubtful_scenes_load_with_a_warning, 0,
                        sizeof doubtful / sizeof doubtful[0]);
    tcase_add_test(messages, files_that_cannot_be_read_are_named);
    tcase_add_test(messages, the_error_is_the_first_of_those_found);
    suite_add_tcase(all, messages);
    return all;
}
