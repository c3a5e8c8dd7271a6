/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow nightly asan-long */
/* Stable steps as users of the program meet them. */
#include "shell.h"

#include <glob.h>
#include <math.h>
#include <unistd.h>

#define OUT BUILD_DIR "/cli-stability"

/* x' = -v, and Euler's factor 1 - h of each step. */
static const char decay[] = "weft: 1\n"
                            "name: decay\n"
                            "cloth:\n"
                            "  grid: {rows: 1, cols: 2, spacing: 1}\n"
                            "  mass: 1\n"
                            "  velocity: [1, 0, 0]\n"
                            "forces: {gravity: [0, 0, 0], damping: 1}\n"
                            "stepper: {plugin: verlet, method: euler, fixed_step: 1}\n"
                            "run: {duration: 20.1, fps: 0.04}\n";

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
    write_file(OUT "/light.yaml", "weft: 1\ncloth:\n"
                                  "  grid: {rows: 4, cols: 4, spacing: 0.1}\n"
                                  "  density: 0.2\n"
                                  "  springs: {stretch: {stiffness: 100}}\n"
                                  "stepper: {plugin: stiff, method: rkc2}\n"
                                  "run: {duration: 0.05}\n");
    write_file(OUT "/decay.yaml", decay);
}

/* The number behind a text of the output; 0: it is not there. */
static double number_after(const char *text)
{
    const char *at = strstr(output, text);
    return at == NULL ? 0.0 : strtod(at + strlen(text), NULL);
}

START_TEST(check_shows_the_bound_of_a_flat_sheet)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml 2>&1"), 0);
    says("omega <= 244.9 1/s, damping <= 0 1/s at the start");
    says("verlet   velocity_verlet      0.008163 s          150\n");
    says("the fixed step is 12 % of the stable step: that step needs 6.8 x fewer");
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
    says("advice: \"the fixed step is 12 %");
    const char *first = strstr(output, "- file: ");
    ck_assert_ptr_nonnull(strstr(first + 1, "- file: "));
}
END_TEST

START_TEST(a_step_beyond_the_bound_is_warned_of_and_run)
{
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/a --quiet 2>&1"), 0);
    ck_assert_str_eq(output, "");
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/b --quiet --set "
                      "stepper.fixed_step=0.0082 --set run.fps=10 --set "
                      "run.frames=interpolate 2>&1"),
           0);
    says("weft: warning: a fixed step of 0.0082 s is beyond the largest stable step "
         "0.008163 s of verlet velocity_verlet");
    says("try stepper.fixed_step=0.0052, which is stable in any state");
    says("omega <= 244.9 1/s, damping <= 0 1/s at the start: the stiffness of the "
         "cloth limits it, not the damping");
    ck_assert(exists(OUT "/b/result.yaml"));
    expect(
        shell(
            WEFT
            " check " OUT
            "/sheet.yaml --set stepper.fixed_step=0.0082 --set run.frames=interpolate"),
        0);
    says("advice     a fixed step of 0.0082 s is beyond the stable 0.00816 s");
}
END_TEST

/* The warning, the message and weft check agree; the summary's largest strain includes
 * the last state. */
START_TEST(a_blow_up_tells_what_limits_the_step_and_a_step_for_any_state)
{
    expect(shell(WEFT " check " OUT "/sheet.yaml --set stepper.fixed_step=0.03 2>&1"),
           0);
    const double any = number_after("velocity_verlet is stable up to ");
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/a --set "
                      "stepper.fixed_step=0.03 --set run.duration=100 2>&1"),
           1);
    says("not finite after a step of 0.0166667 s at t = ");
    says(": the stiffness of the cloth limits it, not the damping)\n");
    says(", which is stable in any state, or see weft check for a method with a larger "
         "one\n");
    const double step = number_after("  try stepper.fixed_step=");
    ck_assert(step > 0.8 * any && step <= any);
    const double most = number_after("strain     at most ");
    ck_assert_double_gt(most, 1e20);
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/b --set "
                      "stepper.fixed_step=0.03 --set run.duration=100 --set "
                      "cloth.springs.stretch.damping=1 2>&1"),
           1);
    says(" at the start: the damping of the cloth limits it, not the stiffness\n");
}
END_TEST

START_TEST(a_refused_first_step_is_told_without_a_state_that_says_nothing)
{
    expect(shell(WEFT " run " OUT "/sheet.yaml --out " OUT "/a --set "
                      "stepper.method=stiff/rkc2 --set stepper.fixed_step=1.0 --set "
                      "run.fps=1 --set run.duration=1 --set cloth.springs.stretch."
                      "damping=1 --set cloth.springs.shear.damping=0.5 2>&1"),
           1);
    says("rkc2: a fixed_step of 1 s is not stable: at most ");
    says(" at t = 0 s\n");
    ck_assert_ptr_null(strstr(output, "last h"));
    ck_assert_ptr_null(strstr(output, "fastest"));
    ck_assert_ptr_null(strstr(output, "most strained"));
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

START_TEST(a_fixed_step_longer_than_a_frame_is_warned_of_and_judged_as_the_frame)
{
    static const char *const verbs[] = { "check", "run --out " OUT "/a --quiet" };
    for (size_t i = 0; i < 2; ++i) {
        expect(shell(WEFT " %s " OUT "/decay.yaml --set stepper.fixed_step=2.2 --set "
                          "run.fps=10 2>&1",
                     verbs[i]),
               0);
        says(":5: warning: fixed_step 2.2 s is longer than a frame (0.1 s): every step "
             "will be 0.1 s; run.fps=0.4545455 makes frames of 2.2 s\n");
        ck_assert_ptr_null(strstr(output, "is beyond"));
        ck_assert_ptr_null(strstr(output, "x fewer"));
    }
    expect(shell("tail -n 1 " OUT "/a/series.csv | cut -d, -f11"), 0);
    ck_assert_str_eq(output, "201\n"); /* steps */
    expect(shell(WEFT " check " OUT "/decay.yaml --set stepper.fixed_step=2.2 --set "
                      "run.fps=0.4545455 2>&1"),
           0);
    ck_assert_ptr_null(strstr(output, "longer than a frame"));
    says("a fixed step of 2.2 s is beyond the stable 2 s");
    expect(shell(WEFT " check " OUT "/decay.yaml --set stepper.fixed_step=2.2 --set "
                      "run.fps=0.475 2>&1"), /* every step 2.105 s */
           0);
    says("longer than a frame");
    says("a fixed step of 2.11 s is beyond the stable 2 s");
}
END_TEST

/* A step of 0.06 s goes into a frame of 0.1 s once, and leaves another of 0.04 s. */
START_TEST(evaluations_are_those_of_steps_that_end_at_frames)
{
    static const struct {
        const char *step, *fps;
        double calls; /* of velocity_verlet at 0.008163 s, per simulated second */
    } frames[] = { { "1.0e-3", "30", 150.0 },
                   { "1.0e-3", "1", 123.0 },
                   { "1.0e-3", "1000", 1000.0 },
                   { "1.0e-3", "122.51", 122.51 } };
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; ++i) {
        expect(shell(WEFT " check --yaml " OUT "/sheet.yaml --set run.duration=2 --set "
                          "stepper.fixed_step=%s --set run.fps=%s 2>&1",
                     frames[i].step, frames[i].fps),
               0);
        const char *at = strstr(output, "velocity_verlet");
        at = at == NULL ? NULL : strstr(at, "rhs_calls_per_second: ");
        ck_assert_ptr_nonnull(at);
        ck_assert_double_eq_tol(strtod(strchr(at, ' '), NULL), frames[i].calls,
                                1e-9 * frames[i].calls);
    }
}
END_TEST

START_TEST(a_method_that_refuses_a_cloth_is_told_at_its_place)
{
    static const char *const verbs[] = { "check", "run" };
    for (int i = 0; i < 2; ++i) {
        expect(shell(WEFT " %s " OUT "/light.yaml %s 2>&1", verbs[i],
                     i == 0 ? "" : "--out " OUT "/light"),
               3);
        says("/light.yaml:6:34: error: rkc2: all modes are damped too lightly");
    }
    expect(shell("test ! -e " OUT "/light"), 0);
    expect(shell(WEFT " check " OUT "/light.yaml --set stepper.method=rkc2 2>&1"), 3);
    says("override stepper.method:16: error: rkc2: all modes are damped too lightly");
}
END_TEST

/* The lesson of docs/start/tutorial.md: h > 2/k. */
START_TEST(one_sweep_shows_where_a_decay_begins_to_grow)
{
    static const double steps[] = { 0.5, 0.99, 1.01, 1.5, 1.99, 2.01, 2.2 };
    static char hashes[7][20];
    expect(shell(WEFT " batch " OUT "/decay.yaml --out " OUT
                      "/steps --quiet --set run.frames=interpolate --set "
                      "'sweep={stepper.fixed_step: [0.5, 0.99, 1.01, 1.5, 1.99, 2.01, "
                      "2.2]}' 2>&1"),
           0);
    ck_assert_str_eq(output, "");
    FILE *table = fopen(OUT "/steps/summary.csv", "r");
    ck_assert_ptr_nonnull(table);
    (void)fgets(output, sizeof output, table);
    for (size_t i = 0; i < 7; ++i) {
        double h = 0.0, start = 0.0, end = 0.0;
        ck_assert_ptr_nonnull(fgets(output, sizeof output, table));
        ck_assert_int_eq(sscanf(output,
                                "%lf,decay,done,,2,%*[^,],%*[^,],%*[^,],%*[^,],%*[^,],"
                                "%lf,%lf,,%16s",
                                &h, &start, &end, hashes[i]),
                         4);
        ck_assert(h == steps[i]);
        ck_assert_msg((end > start) == (h > 2.0), "h = %g s: %g -> %g J", h, start,
                      end);
        for (size_t k = 0; k < i; ++k) {
            ck_assert_str_ne(hashes[i], hashes[k]);
        }
    }
    (void)fclose(table);
}
END_TEST

/* Damped modes have a step that is stable, undamped ones none under Euler. */
START_TEST(the_allowance_is_named_where_it_is_used)
{
    expect(shell(WEFT " check scenes/stiffness.yaml 2>&1"), 0);
    says("verlet   euler                       4 s ");
    says("in any state verlet euler is stable up to 4 s\n");
    ck_assert_ptr_null(strstr(output, " *"));
    expect(shell(WEFT " check scenes/stiffness.yaml --set forces.damping=2.05 2>&1"),
           0);
    says("a fixed step of 1 s is beyond the stable 0.976 s");
    expect(shell(WEFT " check " OUT "/sheet.yaml --set stepper.method=euler 2>&1"), 0);
    says(" * * no step is stable on undamped modes; at this one none more than "
         "doubles in the 0.5 s of the run\n");
}
END_TEST

START_TEST(shipped_scenes_are_surveyed_each)
{
    glob_t found;
    ck_assert_int_eq(glob("scenes/*.yaml", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i += (size_t)test_rounds(6, 1)) {
        expect(shell(WEFT " check %s 2>&1", found.gl_pathv[i]), 0);
        says("evaluations/simulated s\n");
    }
    globfree(&found);
}
END_TEST

#ifdef HAVE_ARKODE
/* P(n) of bench/problem.h, stiffness times k, damping time tau. */
static void write_sheet(int n, double k, double tau)
{
    char text[1024];
    (void)snprintf(text, sizeof text,
                   "weft: 1\n"
                   "cloth:\n"
                   "  grid: {rows: %d, cols: %d, spacing: %.17g, down: [0, 0, 1]}\n"
                   "  mass: %.17g\n"
                   "  springs:\n"
                   "    stretch: {stiffness: %g, damping: %g}\n"
                   "    shear: {stiffness: %g, damping: %g}\n"
                   "    bend: {stiffness: %g, damping: %g}\n"
                   "  pins: [top-left, top-right]\n"
                   "stepper: {plugin: arkode, method: dormand_prince, rtol: 0.001, "
                   "atol: 0.001}\n"
                   "run: {duration: 0.1}\n",
                   n, n, 1.0 / (n - 1), 0.2 / n / n, 100 * k, 100 * k * tau, 50 * k,
                   50 * k * tau, 10 * k, 10 * k * tau);
    write_file(OUT "/stiff.yaml", text);
}

static void within_2(const char *text, double measured)
{
    const double found = number_after(text);
    ck_assert_msg(measured == 0.0
                      || (found >= 0.5 * measured && found <= 2.0 * measured),
                  "%s%g, measured %g in:\n%s", text, found, measured, output);
}

/* Measured with bench/stiff.c, over dormand_prince; 0: not measured. */
START_TEST(gains_are_foretold_within_a_factor_of_2)
{
    static const struct {
        int n;
        double k, tau, rkc2, bdf_2, bdf_3;
    } measured[] = {
        { 32, 1000, 5e-4, 52, 128, 44 },   { 100, 1, 5e-4, 2.3, 3.2, 0 },
        { 100, 100, 5e-5, 4.6, 6.7, 2.7 }, { 100, 1000, 5e-4, 86, 980, 627 },
        { 256, 1, 5e-4, 6.2, 0, 5.6 },
    };
    for (size_t i = 0; i < sizeof measured / sizeof measured[0]; ++i) {
        write_sheet(measured[i].n, measured[i].k, measured[i].tau);
        expect(shell(WEFT " check --yaml " OUT "/stiff.yaml 2>&1"), 0);
        says("over-damped; estimated, over arkode dormand_prince: ");
        within_2("stiff rkc2 is ", measured[i].rkc2);
        within_2("cvode bdf is ", measured[i].bdf_2);
        within_2("faster at 1e-02 m, ", measured[i].bdf_3);
    }
}
END_TEST

#ifdef HAVE_CVODE
/* A method that the scene refuses is named with the key to drop, and the error of the
 * scene names a method that it takes. */
START_TEST(advice_names_only_methods_that_the_scene_takes)
{
    write_sheet(32, 1000, 5e-4);
    expect(shell(WEFT " check " OUT "/stiff.yaml --all --set record.ledger=true 2>&1"),
           0);
    says("cvode bdf, without record.ledger, is ");
    says("             cvode    bdf                         -              -  without "
         "record.ledger\n");
    says("stiff rkc2 is ");
    expect(shell(WEFT " check " OUT "/stiff.yaml --set "
                      "'sensitivity={of: [cloth.mass]}' 2>&1"),
           0);
    says("cvode bdf, without sensitivity, is ");
    expect(shell(WEFT " check " OUT "/stiff.yaml --set record.ledger=true --set "
                      "stepper.method=cvode/bdf 2>&1"),
           3);
    says("method 'bdf' of plugin 'cvode' cannot keep the energy balance; stiff/ros2 "
         "can; or set record.ledger to false");
}
END_TEST
#endif

#ifdef WEFT_QHULL
/* A disc of triangles, of damping tau [s], that falls onto a sphere or freely. */
static void write_disc(double tau, bool touches)
{
    char text[1024];
    (void)snprintf(text, sizeof text,
                   "weft: 1\n"
                   "cloth:\n"
                   "  cut:\n"
                   "    outline: {disc: 0.2}\n"
                   "    spacing: 0.04\n"
                   "    origin: [0, 0.02, 0]\n"
                   "    right: [1, 0, 0]\n"
                   "    down: [0, 0, 1]\n"
                   "  fabric: {preset: tango-red-jet-set, damping: [%g, 1.0e-3]}\n"
                   "%s"
                   "stepper: {plugin: arkode, method: dormand_prince}\n"
                   "run: {duration: 0.2}\n",
                   tau,
                   touches ? "contact:\n"
                             "  thickness: 5.0e-3\n"
                             "  friction: 0.4\n"
                             "  shapes: [{shape: sphere, at: [0, -0.15, 0], radius: "
                             "0.15}]\n"
                           : "");
    write_file(OUT "/disc.yaml", text);
}

/* What a run with the tolerances that weft check names takes, in evaluations; an
 * iteration of a linear system counts as two of them. */
static double work_of(const char *method)
{
    (void)shell("rm -rf " OUT "/work");
    expect(shell(WEFT " run --quiet --out " OUT "/work " OUT "/disc.yaml --set "
                      "'stepper={%s, rtol: 1.0e-3, atol: {position: 1.0e-3, velocity: "
                      "1.0}}' 2>&1 && cat " OUT "/work/result.yaml",
                 method),
           0);
    says("status: done");
    return number_after("rhs_calls: ") + 2.0 * number_after("linear_iterations: ");
}

/* With and without contact, damped and not: the advised kind takes less work. */
START_TEST(advice_on_triangles_is_that_of_trials)
{
    static const struct {
        double tau;
        bool touches, gains;
    } discs[] = { { 1e-3, false, true }, { 1e-2, true, true }, { 3e-5, true, false } };
    write_disc(discs[_i].tau, discs[_i].touches);
    expect(shell(WEFT " check --yaml " OUT "/disc.yaml 2>&1"), 0);
    says(discs[_i].gains ? "implicit methods gain about " : "implicit methods do not ");
    says(discs[_i].touches ? " s in contact, at rtol 0.001, atol 0.001 m and 1 m/s, "
                           : " s, at rtol 0.001, atol 0.001 m and 1 m/s, ");
    const double gain = number_after("implicit methods gain about ");
    const double stiff = work_of("plugin: stiff, method: ros2");
    const double other = work_of("plugin: arkode, method: dormand_prince");
    ck_assert_double_gt(discs[_i].gains ? other : stiff,
                        discs[_i].gains ? stiff : other);
    ck_assert(!discs[_i].gains || (gain > 2.0 && other / stiff > 2.0));
}
END_TEST
#endif

START_TEST(nothing_is_promised_without_damping_or_for_small_soft_cloth)
{
    static const struct {
        int n;
        double k, tau;
        const char *text;
    } sheets[] = {
        { 32, 1000, 5e-4 / 31.6,
          "lightly damped; explicit methods: too little damping" },
        { 100, 1000, 0.0, "damping ratio 0: lightly damped; explicit methods" },
        { 8, 1, 3e-3, "damped; explicit methods: the cloth is too small or too soft" },
    };
    for (size_t i = 0; i < sizeof sheets / sizeof sheets[0]; ++i) {
        write_sheet(sheets[i].n, sheets[i].k, sheets[i].tau);
        expect(shell(WEFT " check --yaml " OUT "/stiff.yaml 2>&1"), 0);
        says(sheets[i].text);
        ck_assert_ptr_null(strstr(output, "estimated"));
    }
}
END_TEST

/* As for explicit methods, with the stages of that step. */
START_TEST(rkc2_is_in_the_table_where_damping_allows_it)
{
    write_sheet(32, 1000, 5e-4);
    expect(shell(WEFT " check " OUT "/stiff.yaml 2>&1"), 0);
    says("             stiff    rkc2                  0.00095 s    5.508e+04\n");
    write_sheet(32, 1, 1e-4);
    expect(shell(WEFT " check --all " OUT "/stiff.yaml 2>&1"), 0);
    says("             stiff    rkc2                        -              -\n");
}
END_TEST
#endif

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

TEST_SUITE(cli_stability)
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
    tcase_add_test(tcase,
                   a_blow_up_tells_what_limits_the_step_and_a_step_for_any_state);
    tcase_add_test(tcase,
                   a_refused_first_step_is_told_without_a_state_that_says_nothing);
    tcase_add_test(
        tcase, a_fixed_step_longer_than_a_frame_is_warned_of_and_judged_as_the_frame);
    tcase_add_test(tcase, evaluations_are_those_of_steps_that_end_at_frames);
    tcase_add_test(tcase, a_method_that_refuses_a_cloth_is_told_at_its_place);
    tcase_add_test(tcase, one_sweep_shows_where_a_decay_begins_to_grow);
    tcase_add_test(tcase, the_allowance_is_named_where_it_is_used);
#ifdef HAVE_ARKODE
    tcase_add_test(tcase, gains_are_foretold_within_a_factor_of_2);
#ifdef HAVE_CVODE
    tcase_add_test(tcase, advice_names_only_methods_that_the_scene_takes);
#endif
#ifdef WEFT_QHULL
    tcase_add_loop_test(tcase, advice_on_triangles_is_that_of_trials, 0, 3);
#endif
    tcase_add_test(tcase, nothing_is_promised_without_damping_or_for_small_soft_cloth);
    tcase_add_test(tcase, rkc2_is_in_the_table_where_damping_allows_it);
#endif
#ifdef HAVE_GSL
    tcase_add_test(tcase, advice_tells_what_limits_an_adaptive_method);
#endif
    suite_add_tcase(suite, tcase);
    return suite;
}
