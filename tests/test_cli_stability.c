/* SPDX-License-Identifier: BSD-3-Clause */
/* Stable steps as users of the program meet them. */
#include "shell.h"

#include <glob.h>
#include <math.h>
#include <unistd.h>

#define OUT BUILD_DIR "/cli-stability"

/* Equal masses, two families: w^2 <= 4 (100 + 50) / 0.01 = 6e4 1/s^2, h <= 2 / w. */
static const char sheet[] = "weft: 1\n"
                            "name: sheet\n"
                            "cloth:\n"
                            "  grid: {rows: 9, cols: 9, spacing: 0.1}\n"
                            "  mass: 0.01\n"
                            "  springs:\n"
                            "    stretch: {stiffness: 100}\n"
                            "    shear: {stiffness: 50}\n"
                            "  pins: [top-left]\n"
                            "stepper: {plugin: verlet, method: velocity_verlet, "
                            "fixed_step: 1.0e-3}\n"
                            "run: {duration: 0.5}\n";

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/sheet.yaml", sheet);
}

START_TEST(check_shows_the_bound_of_a_flat_sheet)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml 2>&1"), 0);
    says("omega <= 244.9 1/s, damping <= 0 1/s at the start");
    says("verlet   velocity_verlet      0.008163 s        122.5\n");
    says("fixed_step is 12 % of the stable step: that step needs 8.2 x fewer");
    expect(shell(WEFT " check " OUT "/sheet.yaml --refine 2>&1"), 0);
    says("by the power method");
    const char *at = strstr(output, "omega >= ");
    ck_assert_ptr_nonnull(at);
    const double omega = strtod(at + strlen("omega >= "), NULL);
    ck_assert(omega < 244.9 && omega > 230.0);
}
END_TEST

START_TEST(all_methods_are_listed_on_request_and_for_machines)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml --all 2>&1"), 0);
    for (size_t i = 0; i < test_method_count(); ++i) {
        if ((test_method(i)->flags & WEFT_STEPPER_BUTCHER) == 0) {
            says(test_method(i)->name);
        }
    }
    expect(shell(WEFT " check --yaml " OUT "/sheet.yaml " OUT "/sheet.yaml"), 0);
    says("scenes:\n- file: ");
    const char *at = strstr(output, "stable_step: ");
    ck_assert_ptr_nonnull(at);
    const double h = strtod(at + strlen("stable_step: "), NULL);
    ck_assert_double_eq_tol(h, 2.0 / sqrt(6e4), 1e-3 * h);
    says("of_the_scene: true");
    says("advice: \"fixed_step is 12 %");
    const char *first = strstr(output, "- file: ");
    ck_assert_ptr_nonnull(strstr(first + 1, "- file: "));
}
END_TEST

START_TEST(a_step_beyond_the_bound_is_warned_of_and_run)
{
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/a --quiet 2>&1"), 0);
    ck_assert_str_eq(output, "");
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/b --quiet --set "
                      "stepper.fixed_step=0.0082 --set run.fps=10 2>&1"),
           0);
    says(
        "weft: warning: fixed_step 0.0082 s is beyond the largest stable step 0.008163 "
        "s of verlet velocity_verlet");
    says("try stepper.fixed_step=0.0073");
    says("omega <= 244.9 1/s");
    ck_assert(exists(OUT "/b/result.yaml"));
    expect(shell(WEFT " check " OUT "/sheet.yaml --set stepper.fixed_step=0.0082"), 0);
    says("advice     fixed_step 0.0082 s is beyond the stable 0.00816 s");
}
END_TEST

/* Also those whose trial and table are the longest; the case's timeout ends them. */
START_TEST(check_of_a_sweep_tells_how_many_runs_are_beyond_their_bound)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml --set 'sweep={stepper.fixed_step: "
                      "[1.0e-3, 0.02, 0.03]}'"),
           0);
    says("fixed_step is beyond the stable step in 2 of the 3 runs\n");
    expect(shell(WEFT " check " OUT "/sheet.yaml --set 'sweep={stepper.fixed_step: "
                      "[1.0e-3, 2.0e-3]}'"),
           0);
    ck_assert_ptr_null(strstr(output, "is beyond"));
}
END_TEST

START_TEST(shipped_scenes_are_surveyed_each)
{
    glob_t found;
    ck_assert_int_eq(glob("scenes/*.yaml", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; ++i) {
        expect(shell(WEFT " check %s 2>&1", found.gl_pathv[i]), 0);
        says("evaluations per simulated second\n");
    }
    globfree(&found);
}
END_TEST

#ifdef HAVE_GSL
/* Loose tolerances leave it to stability to hold the step, tight ones do not. */
START_TEST(advice_tells_what_limits_an_adaptive_method)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml --set 'stepper={plugin: gsl, method: "
                      "rkf45, rtol: 1e-2, atol: 1e-2}' 2>&1"),
           0);
    says("% stability-limited (a trial of ");
    says("verlet velocity_verlet at its stable step needs ");
    expect(shell(WEFT " check " OUT "/sheet.yaml --set 'stepper={plugin: gsl, method: "
                      "rkf45, rtol: 1e-11, atol: 1e-11}' 2>&1"),
           0);
    says("the tolerances limit the step");
    says(" x fewer evaluations under them"); /* whichever is the best */
    expect(shell(WEFT " check " OUT "/sheet.yaml --set 'stepper={plugin: gsl, method: "
                      "msadams}' 2>&1"),
           0);
    says("gsl msadams has no stable step to compare with");
}
END_TEST
#endif

static Suite *suite(void)
{
    Suite *suite = suite_create("cli stability");
    TCase *tcase = tcase_create("stability");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, begin, NULL);
    tcase_add_test(tcase, check_shows_the_bound_of_a_flat_sheet);
    tcase_add_test(tcase, all_methods_are_listed_on_request_and_for_machines);
    tcase_add_test(tcase, check_of_a_sweep_tells_how_many_runs_are_beyond_their_bound);
    tcase_add_test(tcase, shipped_scenes_are_surveyed_each);
    tcase_add_test(tcase, a_step_beyond_the_bound_is_warned_of_and_run);
#ifdef HAVE_GSL
    tcase_add_test(tcase, advice_tells_what_limits_an_adaptive_method);
#endif
    suite_add_tcase(suite, tcase);
    return suite;
}

int main(void)
{
    return test_run(suite());
}
