/* SPDX-License-Identifier: BSD-3-Clause */
/* Fabrics from the files of ARCSim's materials. */
#include "scene_load.h"
#include "shell.h"

#include <math.h>

#define FOLDER BUILD_DIR "/tests/arcsim"

/* The numbers are invented; the comment is one that ARCSim's reader takes. */
#define STRETCHING                                                                     \
    "  \"stretching\": [\n    [50, 10, 100, 20],\n    [60, 10, 100, 20],\n"            \
    "    [50, 10, 100, 20], [50, 10, 100, 20], [50, 10, 100, 20],\n"                   \
    "    [50, 10, 80, 20]\n  ],\n"
#define BENDING                                                                        \
    "  \"bending\": [\n    [40e-6, 40e-6, 40e-6, 40e-6, 20e-6],\n"                     \
    "    [60e-6, 60e-6, 60e-6, 60e-6, 60e-6],\n"                                       \
    "    [80e-6, 80e-6, 120e-6, 80e-6, 80e-6]\n  ]\n"
#define MATERIAL "// invented\n{\n  \"density\": 0.25,\n" STRETCHING BENDING "}\n"

static void put(const char *name, const char *text)
{
    char path[256];
    expect(shell("mkdir -p " FOLDER), 0);
    (void)snprintf(path, sizeof path, "%s/%s", FOLDER, name);
    FILE *stream = fopen(path, "w");
    ck_assert_ptr_nonnull(stream);
    (void)fputs(text, stream);
    ck_assert_int_eq(fclose(stream), 0);
}

#define SHEET "mesh: {file: sheet.obj}"
#define GRID  "grid: {rows: 5, cols: 5, spacing: .02}"

/* The scene with a cloth; what was found is in `found`. */
static weft_scene *load(const char *cloth)
{
    static char text[2048];
    put("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl hem\nf 3 2 4\n"
                     "v 1 1 0\n");
    (void)snprintf(text, sizeof text,
                   "weft: 1\ncloth: {%s}\n"
                   "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.1}\n",
                   cloth);
    weft_scene_def def = scene_of_text(text);
    weft_scene *scene = NULL;
    def.file = FOLDER "/test.yaml";
    (void)weft_scene_load(&def, &scene, &found, NULL);
    return scene;
}

static weft_scene *accepted(const char *cloth, size_t warnings)
{
    weft_scene *scene = load(cloth);
    ck_assert_msg(scene != NULL && found.warnings == warnings, "%s", all_found());
    return scene;
}

static void fabric_is(const weft_fabric *of, const double wanted[8])
{
    const double is[]
        = { of->density,  of->stretch[0],    of->stretch[1],    of->shear,
            of->coupling, 1e6 * of->bend[0], 1e6 * of->bend[1], 1e6 * of->twist };
    for (size_t i = 0; i < sizeof is / sizeof *is; ++i) {
        ck_assert_double_eq_tol(is[i], wanted[i], 1e-9);
    }
}

/* ---- what a material means ------------------------------------------------------- */

START_TEST(the_constants_are_those_at_small_strain)
{
    put("a.json", MATERIAL);
    weft_scene *scene = accepted(SHEET ", fabric: {arcsim: a.json}", 0);
    fabric_is(&weft_scene_cloth(scene)->mesh->fabrics[0],
              (const double[]){ 0.25, 100, 200, 20, 20, 20, 10, 15 });
    const char *about = NULL, *line = NULL;
    for (size_t i = 0; (line = weft_scene_note(scene, i, &about)) != NULL
                       && strcmp(about, "arcsim") != 0;
         ++i) {
    }
    ck_assert_ptr_nonnull(line);
    ck_assert_str_eq(
        line, FOLDER
        "/a.json: C 100 and 200, G 20, C12 20 N/m; rigidity 2e-05 and 1e-05, twist "
        "1.5e-05 N m: exact at small strain; the samples at a strain of 1/6 are 0.8 to "
        "1.2 times as stiff, those of all curvatures 0.5 to 1.5 times");
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_material_holds_on_grids_and_in_fabrics_and_takes_damping_and_twist)
{
    put("a.json", "\xEF\xBB\xBF" MATERIAL);
    weft_scene *scene = accepted(GRID ", fabric: {arcsim: a.json, damping: 1.0e-4}", 0);
    ck_assert_double_eq(weft_scene_fabric(scene)->damping[0], 1e-4);
    ck_assert_double_eq(weft_scene_fabric(scene)->stretch[1], 200.0);
    weft_scene_destroy(scene);
    scene = accepted(SHEET ", fabric: {density: .1, stretch: 10}, fabrics: {hem: "
                           "{arcsim: a.json, twist: 7.0e-6}}",
                     0);
    fabric_is(&weft_scene_cloth(scene)->mesh->fabrics[1],
              (const double[]){ 0.25, 100, 200, 20, 20, 20, 10, 7 });
    weft_scene_destroy(scene);
}
END_TEST

/* As in ARCSim, where a sample has no energy or no resistance. */
START_TEST(samples_without_an_energy_count_as_arcsim_takes_them)
{
    put("a.json", "{\"density\": 0.2, \"stretching\": [[10, -20, 5, -3], [1,2,3,4], "
                  "[1,2,3,4], [1,2,3,4], [1,2,3,4], [1,2,3,4]],\n\"bending\": "
                  "[[-1e-6,1,1,1,1], [1e-6,1,1,1,1], [8e-6,1,1,1,1]]}");
    weft_scene *scene = accepted(SHEET ", fabric: {arcsim: a.json}", 1);
    fabric_is(&weft_scene_cloth(scene)->mesh->fabrics[0],
              (const double[]){ 0.2, 20, 10, 0, 0, 2, 0, 0 });
    weft_scene_destroy(scene);
    ck_assert_ptr_nonnull(strstr(all_found(),
                                 "a.json:1:38: warning: C12 of -40 N/m has no elastic "
                                 "energy beside C of 20 and 10 N/m: it counts as 0, as "
                                 "negative values do in ARCSim"));
    /* a negative one that has an energy stays */
    put("a.json", "{\"density\": 0.2, \"stretching\": [[10, -5, 5, 3], [1,2,3,4], "
                  "[1,2,3,4], [1,2,3,4], [1,2,3,4], [1,2,3,4]],\n\"bending\": "
                  "[[4e-6,1,1,1,1], [4e-6,1,1,1,1], [4e-6,1,1,1,1]], \"name\": 3}");
    scene = accepted(SHEET ", fabric: {arcsim: a.json}", 1);
    ck_assert_double_eq(weft_scene_cloth(scene)->mesh->fabrics[0].coupling, -10.0);
    weft_scene_destroy(scene);
    ck_assert_ptr_nonnull(
        strstr(all_found(), "a.json:2:62: warning: 'name' is no key"));
}
END_TEST

/* ---- mistakes -------------------------------------------------------------------- */

static const struct {
    const char *text, *told;
} bad[] = {
    { "", "a.json:1:1: error: JSON needs a value here" },
    { "[1, 2", "a.json:1:6: error: JSON needs ',' or ']' here, not the end of the" },
    { "{\"density\": 0.2,,}", "a.json:1:17: error: JSON needs a key in quotes here" },
    { "{\"density\" 0.2}", "a.json:1:12: error: JSON needs ':' here" },
    { "{\n\"density: 0.2}", "a.json:2:1: error: JSON needs a text with its closing" },
    { "{} {}", "a.json:1:4: error: JSON needs the end of the file here" },
    { "[[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]", "JSON needs fewer levels of lists" },
    { "{\"data\": \"b.json\", " STRETCHING BENDING "}",
      "a.json:1:1: error: the material lacks 'density' [kg/m^2]: give the file that "
      "its "
      "'data' names" },
    { "{\"density\": -1, " STRETCHING BENDING "}",
      "a.json:1:13: error: density must be a number > 0 [kg/m^2], not '-1'" },
    { "{\"density\": \"0.2\", " STRETCHING BENDING "}", "a.json:1:13: error: density" },
    { "{\"density\": 1, " STRETCHING "\"a\": 1}",
      "a.json:1:1: error: the material lacks 'bending', 3 rows of 5 numbers: an ARCSim "
      "material has density, stretching and bending" },
    { "{\"density\": 1,\n\"stretching\": [[1, 2, 3, 4]], " BENDING "}",
      "a.json:2:15: error: stretching has 1 rows, not 6 of 4 numbers" },
    { "{\"density\": 1,\n" STRETCHING "\"bending\": [[1,1,1,1,1], [1,1,1,1], "
      "[1,1,1,1,nan]]}",
      "a.json:8:26: error: bending[1] must be a row of 5 numbers [N m]" },
    { "{\"density\": 1,\n" STRETCHING "\"bending\": [[1,1,1,1,1], [1,1,1,1], "
      "[1,1,1,1,nan]]}",
      "a.json:8:46: error: bending[2][4]" },
    { "{\"density\": 1, \"stretching\": [[0, 2, 3, 4], [1,2,3,4], [1,2,3,4], "
      "[1,2,3,4], "
      "[1,2,3,4], [1,2,3,4]], " BENDING "}",
      "a.json:1:32: error: the modulus of the warp at no strain must be > 0, not 0" },
};

START_TEST(every_mistake_of_a_material_is_told_at_its_line_and_column)
{
    put("a.json", bad[_i].text);
    ck_assert_ptr_null(load(SHEET ", fabric: {arcsim: a.json}"));
    ck_assert_msg(strstr(all_found(), bad[_i].told) != NULL, "%s", all_found());
}
END_TEST

START_TEST(keys_that_a_material_gives_do_not_stand_beside_it)
{
    static const char *const keys[]
        = { "density: 1", "stretch: 1", "shear: 1", "coupling: 1", "bend: 1.0e-6" };
    put("a.json", MATERIAL);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; ++i) {
        char cloth[200], told[100];
        (void)snprintf(cloth, sizeof cloth, SHEET ", fabric: {arcsim: a.json, %s}",
                       keys[i]);
        (void)snprintf(told, sizeof told, "%.*s excludes arcsim",
                       (int)strcspn(keys[i], ":"), keys[i]);
        ck_assert_ptr_null(load(cloth));
        ck_assert_uint_eq(found.errors, 1);
        ck_assert_msg(strstr(found.items[0].message, told) != NULL, "%s", all_found());
    }
    ck_assert_ptr_null(load(SHEET ", fabric: {arcsim: a.json, preset: royal-target}"));
    ck_assert_ptr_null(load(SHEET ", fabric: {arcsim: none.json}"));
    ck_assert_ptr_nonnull(strstr(all_found(), "none.json: No such file"));
    ck_assert_uint_eq(found.errors, 1);
    ck_assert_ptr_null(load(SHEET ", fabric: {arcsim: [1, 2]}"));
    ck_assert_ptr_nonnull(strstr(all_found(), "arcsim must be the JSON file of an"));
}
END_TEST

/* ---- results --------------------------------------------------------------------- */

START_TEST(a_run_goes_on_without_the_file_of_its_material)
{
    put("a.json", MATERIAL);
    put("hung.yaml",
        "weft: 1\ncloth:\n  grid: {rows: 4, cols: 4, spacing: 0.05}\n"
        "  fabric: {arcsim: a.json}\n  pins: [top-left]\n"
        "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-4}\n"
        "run: {duration: 0.02, fps: 100, checkpoint: 1, keep_checkpoint: true}\n");
    expect(shell("cd " FOLDER
                 " && rm -rf a b && ../../weft run hung.yaml --quiet --out "
                 "a 2>&1 && ../../weft run hung.yaml --quiet --out b --set "
                 "run.duration=0.04 2>&1 && rm a.json && ../../weft resume a --until "
                 "0.04 --quiet 2>&1 && cmp a/final.csv b/final.csv && ../../weft run "
                 "a/scene.yaml --quiet --out c --force 2>&1 && cmp a/final.csv "
                 "c/final.csv"),
           0);
}
END_TEST

TEST_SUITE(arcsim)
{
    Suite *suite = suite_create("arcsim");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 60.0);
    tcase_add_test(all, the_constants_are_those_at_small_strain);
    tcase_add_test(
        all, a_material_holds_on_grids_and_in_fabrics_and_takes_damping_and_twist);
    tcase_add_test(all, samples_without_an_energy_count_as_arcsim_takes_them);
    tcase_add_loop_test(all, every_mistake_of_a_material_is_told_at_its_line_and_column,
                        0, sizeof bad / sizeof *bad);
    tcase_add_test(all, keys_that_a_material_gives_do_not_stand_beside_it);
    tcase_add_test(all, a_run_goes_on_without_the_file_of_its_material);
    suite_add_tcase(suite, all);
    return suite;
}
