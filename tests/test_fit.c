/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* weft fit: numbers that are found again from tracks and outlines made with them, what
 * data tell of them, and data that it refuses. */
#include "shell.h"

#include <math.h>

#ifdef WEFT_CMINPACK /* else there are none */

#define OUT BUILD_DIR "/fit"

/* A sheet and a mesh of two triangles' squares, both of which swing. */
static const char sheet[]
    = "weft: 1\n"
      "name: sheet\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 6, spacing: 0.1, right: [1, 0, 0], down: [0, -1, 0]}\n"
      "  density: 0.2\n"
      "  velocity: [0, 0, 0.6]\n"
      "  springs: {stretch: {stiffness: 80, damping: 0.05}, shear: {stiffness: 30}}\n"
      "  pins: [top-left, top-right]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.6, fps: 20}\n"
      "record: {final: true}\n";

static const char panel[]
    = "weft: 1\n"
      "name: panel\n"
      "cloth:\n"
      "  mesh: {file: panel.obj}\n"
      "  fabric: {density: 0.2, stretch: [100, 60], shear: 20, bend: [1.0e-5, 1.0e-5], "
      "damping: [1.0e-3, 1.0e-3]}\n"
      "  pins: [{vertices: [0]}]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

/* Two of them, one above the other. */
static const char pair[]
    = "weft: 1\n"
      "name: pair\n"
      "cloths:\n"
      "  - name: low\n"
      "    mesh: {file: panel.obj}\n"
      "    fabric: {density: 0.2, stretch: [100, 60], shear: 20, damping: 1.0e-3}\n"
      "    pins: [{vertices: [0]}]\n"
      "  - name: high\n"
      "    mesh: {file: panel.obj, at: [0, 0, 1]}\n"
      "    fabric: {density: 0.2, stretch: [80, 90], shear: 20, damping: 1.0e-3}\n"
      "    pins: [{vertices: [1]}]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

static const char panel_obj[]
    = "v 0 0 0\nv .5 0 0\nv 0 .5 0\nv .5 .5 0\nvt 0 0\nvt .5 0\nvt 0 .5\nvt .5 .5\n"
      "f 1/1 2/2 4/4\nf 1/1 4/4 3/3\n";

/* A square that drapes over a support, which is not in its middle. */
static const char drape[]
    = "weft: 1\n"
      "name: drape\n"
      "cloth:\n"
      "  grid: {rows: 9, cols: 9, spacing: 0.03, origin: [-0.12, 0, -0.12], right: "
      "[1, 0, 0], down: [0, 0, 1]}\n"
      "  density: 0.2\n"
      "  springs:\n"
      "    stretch: {stiffness: 80, damping: 1.0e-3}\n"
      "    shear: {stiffness: 30, damping: 1.0e-3}\n"
      "    bend: {stiffness: 4, damping: 1.0e-3}\n"
      "  pins: [{rows: [2, 6], cols: [2, 5]}]\n"
      "forces: {damping: 2.0e-3}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 5.0e-4}\n"
      "run: {duration: 1.2, fps: 5}\n"
      "record: {final: true}\n";

#define BEND    "cloth.springs.bend.stiffness"
#define STRETCH "cloth.springs.stretch.stiffness"
#define SHEAR   "cloth.springs.shear.stiffness"

/* Tracks of every frame but the first of the scene's own run, in DATA.csv. */
static void follow(const char *scene, const char *header, const char *cells)
{
    expect(shell("cd " OUT " && ../weft run %s.yaml --out %s --force --quiet 2>&1 && "
                 "../weft export %s --format csv --frame all && { echo '%s'; for k in "
                 "$(seq 1 10); do t=$(awk \"BEGIN { print $k / 20 }\"); sed 1d "
                 "%s/frames/frame-$(printf %%06d $k).csv | cut -d, -f%s | sed "
                 "\"s/^/$t,/\"; done; } >%s.csv",
                 scene, scene, scene, header, scene, cells, scene),
           0);
}

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/sheet.yaml", sheet);
    write_file(OUT "/panel.yaml", panel);
    write_file(OUT "/panel.obj", panel_obj);
    write_file(OUT "/drape.yaml", drape);
    follow("sheet", "time,row,col,x,y,z", "1-5");
    follow("panel", "time,vertex,x,y,z", "1-4");
    write_file(OUT "/pair.yaml", pair);
    follow("pair", "time,cloth,vertex,x,y,z", "1-5");
}

static void forget(void)
{
    (void)shell("rm -rf " OUT "/found");
}

static void fit(int code, const char *arguments)
{
    expect(shell("cd " OUT " && ../weft fit %s --quiet 2>&1", arguments), code);
}

/* Of "KEY:\n  value: 1\n  standard_error: 2", or of "KEY: 1". */
static double number_of(const char *key, const char *item)
{
    const char *at = strstr(read_file(OUT "/found/fit.yaml"), key);
    ck_assert_msg(at != NULL, "no %s", key);
    at = item != NULL ? strstr(at, item) : at;
    ck_assert_ptr_nonnull(at);
    return strtod(strchr(at, ':') + 1, NULL);
}

static void ck_found(const char *key, double value, double tolerance)
{
    const double found = number_of(key, "value");
    ck_assert_msg(fabs(found - value) <= tolerance * value, "%s: %.9g, not %.9g", key,
                  found, value);
}

START_TEST(numbers_are_found_from_exact_tracks)
{
    fit(0, "sheet.yaml sheet.csv --over " STRETCH "," SHEAR " --set " STRETCH
           "=200 --set " SHEAR "=12 --out found");
    ck_found(STRETCH, 80.0, 1e-6);
    ck_found(SHEAR, 30.0, 1e-6);
    ck_assert_double_le(number_of("chi2", NULL), 1e-6);
    ck_assert_double_eq(number_of("points", NULL), 300.0);
    ck_assert_double_eq(number_of(STRETCH, "start"), 200.0);
}
END_TEST

/* Three of them missing, one at a time of no frame, in another order. */
START_TEST(of_a_mesh_numbers_are_found_where_data_are_missing)
{
    expect(shell("cd " OUT " && { head -1 panel.csv; sed 1d panel.csv | sed "
                 "'s/^0.3,3,.*/0.3,3,,,/' | sort -t, -k2; } >some.csv"),
           0);
    fit(0, "panel.yaml some.csv --over cloth.fabric.stretch.1,forces.gravity.1 --set "
           "cloth.fabric.stretch=[100,150] --out found");
    ck_found("cloth.fabric.stretch.1", 60.0, 1e-6);
    ck_assert_double_eq_tol(number_of("forces.gravity.1", "value"), -9.81, 1e-6);
    ck_assert_double_eq(number_of("coordinates", NULL), 117.0);
}
END_TEST

START_TEST(of_several_cloths_each_has_its_numbers)
{
    fit(0, "pair.yaml pair.csv --over cloths.0.fabric.stretch.1,"
           "cloths.1.fabric.stretch.1 --set cloths.0.fabric.stretch=[100,150] --set "
           "cloths.1.fabric.stretch=[80,60] --out found");
    ck_found("cloths.0.fabric.stretch.1", 60.0, 1e-6);
    ck_found("cloths.1.fabric.stretch.1", 90.0, 1e-6);
    write_file(OUT "/data.csv", "time,cloth,vertex,x,y,z\n0.1,middle,0,0,0,0\n");
    fit(4, "pair.yaml data.csv --over cloths.0.fabric.shear --out none");
    says("data.csv:2: the scene has no such cloth");
    write_file(OUT "/data.csv", "time,cloth,vertex,x,y,z\n0.1,high,4,0,0,0\n");
    fit(4, "pair.yaml data.csv --over cloths.0.fabric.shear --out none");
    says("data.csv:2: the mesh has no such vertex");
}
END_TEST

/* The preset's bending is the start; only its warp is fitted. */
START_TEST(numbers_of_a_preset_are_fitted)
{
    write_file(OUT "/strip.yaml",
               "weft: 1\ncloth:\n  grid: {rows: 8, cols: 1, spacing: 0.03, right: [0, "
               "0, 1], down: [1, 0, 0]}\n  fabric: {preset: royal-target}\n  pins: "
               "[{rows: [0, 1], cols: all}]\nforces: {damping: 3.0e-3}\nstepper: "
               "{plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-4}\nrun: "
               "{duration: 0.5, fps: 20}\n");
    expect(shell("cd " OUT " && ../weft run strip.yaml --out strip --force --quiet "
                 "--set record.final=true --set cloth.fabric.bend=[6.0e-5,31.3e-6] && "
                 "awk -F, 'NR == 1 { print \"time,\" $1 \",\" $2 \",x,y,z\" } NR > 1 { "
                 "print \"0.5,\" $1 \",\" $2 \",\" $3 \",\" $4 \",\" $5 }' "
                 "strip/final.csv >strip.csv"),
           0);
    fit(0, "strip.yaml strip.csv --over cloth.fabric.bend.0 --out found");
    ck_found("cloth.fabric.bend.0", 6e-5, 1e-5);
}
END_TEST

START_TEST(the_fitted_scene_runs_as_the_one_that_made_the_tracks)
{
    fit(0, "sheet.yaml sheet.csv --over " STRETCH " --set " STRETCH "=60 --out found");
    expect(shell("cd " OUT " && ../weft run found/fitted.yaml --out again --force "
                 "--quiet && ../weft diff sheet again --tol 1e-7"),
           0);
    fit(0, "panel.yaml panel.csv --over cloth.fabric.shear --out found --force");
    expect(shell("cd " OUT " && ../weft run found/fitted.yaml --out again --force "
                 "--quiet && ../weft diff panel again --tol 1e-7"),
           0);
}
END_TEST

/* sigma / |s| of log p, s the sensitivity of all data, here those of one time. */
START_TEST(the_standard_error_is_that_of_the_sensitivities)
{
    expect(
        shell("cd " OUT " && { head -1 sheet.csv; grep '^0.5,' sheet.csv; } >end.csv "
              "&& ../weft run sheet.yaml --out with --force --quiet --set "
              "run.duration=0.5 --set 'sensitivity={of: [" STRETCH "]}' && awk -F, "
              "'NR > 1 { s += $4^2 + $5^2 + $6^2 } END { printf \"%%.17g\", 80 * 2e-3 "
              "/ sqrt(s) }' with/sensitivity.csv"),
        0);
    const double wanted = strtod(output, NULL);
    fit(0, "sheet.yaml end.csv --sigma 2e-3 --over " STRETCH " --out found");
    ck_assert_double_eq_tol(number_of(STRETCH, "standard_error"), wanted,
                            1e-5 * wanted);
}
END_TEST

START_TEST(what_the_data_cannot_tell_is_named)
{
    fit(0, "sheet.yaml sheet.csv --sigma 1 --over " STRETCH "," SHEAR " --out found");
    says("2 of 2 directions");
    ck_assert_double_lt(number_of("unresolved", "singular_value"), 10.0);
    fit(0, "sheet.yaml sheet.csv --sigma 1e-4 --over " STRETCH "," SHEAR
           " --out found --force");
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/found/fit.yaml"), "unresolved: []"));
}
END_TEST

/* The rim of the drape from above, x to the right and z down, in a CSV file of each
 * form: each radius wrong by normal noise of this standard deviation [m]. */
static void outline(double noise)
{
    expect(
        shell("cd " OUT
              " && ../weft run drape.yaml --out drape --force --quiet && for f in "
              "x,y angle,radius; do awk -F, -v f=$f -v noise=%g 'function u() { seed "
              "= seed * 16807 %% 2147483647; return seed / 2147483647 } BEGIN { seed "
              "= 7; OFMT = \"%%.17g\"; print f } NR > 1 && ($1 %% 8 == 0 || $2 %% 8 "
              "== 0) { r = sqrt($3^2 + $5^2); R = r + noise * sqrt(-2 * log(u())) * "
              "cos(6.283185307 * u()); if (f == \"x,y\") print $3 * R / r \",\" (-$5 "
              "* R / r); else print atan2(-$5, $3) * 57.29577951308232 \",\" R }' "
              "CONVFMT=%%.17g drape/final.csv >$f.csv; done",
              noise),
        0);
}

START_TEST(bending_is_found_from_an_exact_outline)
{
    outline(0.0);
    fit(0, "drape.yaml x,y.csv --over " BEND " --set " BEND "=10 --out found");
    ck_found(BEND, 4.0, 1e-6);
    ck_assert_double_le(number_of("chi2", NULL), 1e-6);
    ck_assert_double_eq(number_of("coordinates", NULL), 32.0);
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/found/fit.svg"), "<title>Outline"));
}
END_TEST

/* From a factor of 3 off; of both forms alike. */
START_TEST(bending_is_found_from_an_outline_with_noise)
{
    outline(1e-3);
    fit(0, "drape.yaml x,y.csv --over " BEND " --set " BEND "=12 --out found");
    const double value = number_of(BEND, "value");
    const double error = number_of(BEND, "standard_error");
    ck_assert_double_le(error, 0.3);
    ck_assert_double_le(fabs(value - 4.0), 3.0 * error);
    ck_assert_double_gt(fabs(value - 4.0), 1e-3);
    fit(0, "drape.yaml angle,radius.csv --over " BEND " --set " BEND
           "=1.33 --out found --force");
    ck_found(BEND, value, 1e-6);
}
END_TEST

START_TEST(a_shadow_elsewhere_is_told)
{
    outline(0.0);
    fit(1, "drape.yaml x,y.csv --over " BEND
           " --set cloth.grid.origin=[0.1,0,0.1] --out found");
    says("the shadow is not around the origin");
    fit(4,
        "drape.yaml x,y.csv --over " BEND " --set forces.gravity=[0,0,0] --out found");
    says("the cloth has no weight");
}
END_TEST

/* From where the first step leads out of the range of a stable step. */
START_TEST(numbers_without_a_run_are_left_again)
{
    expect(shell("cd " OUT " && ../weft fit sheet.yaml sheet.csv --over " STRETCH
                 " --set " STRETCH "=4 --set stepper.fixed_step=0.02 --out found 2>&1"),
           0);
    ck_assert(isfinite(number_of(STRETCH, "value")));
}
END_TEST

static const struct {
    const char *text, *message;
    int code;
} mistakes[] = {
    { "", "data.csv:1: the first line must be time,row,col,x,y,z", 4 },
    { "time,vertex,x,y,z\n", "data.csv:1: the first line must be", 4 },
    { "time,row,col,x,y,z\n", "0 coordinates for 1 numbers", 4 },
    { "time,row,col,x,y,z\n\n0.1,1,1,0,0\n", "data.csv:3: 6 cells", 4 },
    { "time,row,col,x,y,z\n0.1,1,1,0,0,0,0\n", "data.csv:2: 6 cells", 4 },
    { "time,row,col,x,y,z\n0.1,5,1,0,0,0\n", "data.csv:2: the grid has no such", 4 },
    { "time,row,col,x,y,z\n0.1,1,-1,0,0,0\n", "data.csv:2: the grid has no such", 4 },
    { "time,row,col,x,y,z\n-1,1,1,0,0,0\n", "data.csv:2: time must be", 4 },
    { "time,row,col,x,y,z\n0.1,1,1,0,nan,0\n", "data.csv:2: x, y and z must be", 4 },
    { "angle,y\n", "or of an outline angle,radius or x,y", 4 },
    { "angle,radius\n0,1\nx,y\n", "data.csv:3: angle must be -180 to 360", 4 },
    { "angle,radius\n0,1\n361,1\n", "data.csv:3: angle must be -180 to 360", 4 },
    { "angle,radius\n0,1\n90,nan\n", "data.csv:3: angle must be -180 to 360", 4 },
    { "angle,radius\n0,1\n90,0\n", "data.csv:3: angle must be -180 to 360", 4 },
    { "angle,radius\n0,1\n90\n", "data.csv:3: 2 cells must be here: angle,radius", 4 },
    { "x,y\n1,0\n1,inf\n", "data.csv:3: x and y must be", 4 },
    { "x,y\n0,0\n", "data.csv:2: x and y must be numbers [m], not both 0", 4 },
    { "x,y\n1,0\n", "data.csv:2: the outline is open", 4 },
    { "angle,radius\n0,1\n90,1\n180,1\n269,1\n", "data.csv:5: the outline is open", 4 },
    { "angle,radius\n0,1\n90,1\n180,1\n270,1\n360,1\n",
      "data.csv:6: a second point at 0 degrees; the first is on line 2", 4 },
    { "angle,radius\n", "0 coordinates for 1 numbers", 4 },
};

START_TEST(data_that_are_wrong_are_refused_at_their_line)
{
    write_file(OUT "/data.csv", mistakes[_i].text);
    fit(mistakes[_i].code, "sheet.yaml data.csv --over " STRETCH " --out none");
    says(mistakes[_i].message);
    ck_assert(!exists(OUT "/none/fit.yaml"));
}
END_TEST

START_TEST(a_wrong_command_line_or_scene_is_told)
{
    fit(2, "sheet.yaml sheet.csv");
    says("--over KEY,KEY");
    fit(2, "sheet.yaml sheet.csv --over " STRETCH " --sigma -1");
    says("--sigma -1");
    fit(3, "sheet.yaml sheet.csv --over cloth.grid.rows");
    says("has no derivative: give a number");
    fit(3, "sheet.yaml sheet.csv --over forces.gravity.0");
    says("has no logarithm");
    fit(4, "sheet.yaml nothing.csv --over " STRETCH);
    says("nothing.csv");
    fit(0, "sheet.yaml sheet.csv --over " STRETCH " --out kept");
    fit(4, "sheet.yaml sheet.csv --over " STRETCH " --out kept");
    says("--force");
}
END_TEST

#endif

Suite *fit_suite(void);
Suite *fit_suite(void)
{
    Suite *suite = suite_create("fit");
#ifdef WEFT_CMINPACK
    TCase *tcase = tcase_create("fit");
    tcase_add_unchecked_fixture(tcase, begin, NULL);
    tcase_add_checked_fixture(tcase, forget, NULL);
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, numbers_are_found_from_exact_tracks);
    tcase_add_test(tcase, of_a_mesh_numbers_are_found_where_data_are_missing);
    tcase_add_test(tcase, of_several_cloths_each_has_its_numbers);
    tcase_add_test(tcase, numbers_of_a_preset_are_fitted);
    tcase_add_test(tcase, the_fitted_scene_runs_as_the_one_that_made_the_tracks);
    tcase_add_test(tcase, the_standard_error_is_that_of_the_sensitivities);
    tcase_add_test(tcase, what_the_data_cannot_tell_is_named);
    tcase_add_test(tcase, bending_is_found_from_an_exact_outline);
    tcase_add_test(tcase, bending_is_found_from_an_outline_with_noise);
    tcase_add_test(tcase, a_shadow_elsewhere_is_told);
    tcase_add_test(tcase, numbers_without_a_run_are_left_again);
    tcase_add_loop_test(tcase, data_that_are_wrong_are_refused_at_their_line, 0,
                        sizeof mistakes / sizeof mistakes[0]);
    tcase_add_test(tcase, a_wrong_command_line_or_scene_is_told);
    suite_add_tcase(suite, tcase);
#endif
    return suite;
}
