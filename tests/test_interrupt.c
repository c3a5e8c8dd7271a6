/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow */
/* SIGINT and SIGTERM end a run whatever its solver is doing; what costs a great deal is
 * said before. A test that hangs is one that failed. */
#include <unistd.h>

#include "run_frames.h"

#define OUT     BUILD_DIR "/interrupt"
#define ENDLESS "--plugin-path " OUT "/p "

/* 50 steps a frame, and the 121st of the plugin `endless` never ends. */
static const char endless[] = "weft: 1\n"
                              "name: stuck\n"
                              "cloth:\n"
                              "  grid: {rows: 4, cols: 5, spacing: 0.1}\n"
                              "  mass: 0.01\n"
                              "  springs: {stretch: {stiffness: 50}}\n"
                              "  pins: [top]\n"
                              "stepper: {plugin: endless, method: midpoint, "
                              "fixed_step: 1.0e-3}\n"
                              "run: {duration: 0.5, fps: 20}\n";

static const struct {
    const char *name;
    int code;
} signals[] = { { "INT", 130 }, { "TERM", 143 } };

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    /* away from plugins that take their time to be refused */
    (void)shell("rm -rf " OUT " && mkdir -p " OUT "/p && cp " BUILD_DIR
                "/tests/promises/weft-endless.so " BUILD_DIR
                "/tests/promises/weft-working.so " OUT "/p");
    write_file(OUT "/stuck.yaml", endless);
}

/* Runs a command of weft until a shell's condition holds, then sends its process a
 * signal. Returns when all that hold its output have ended, with its exit code. */
static int interrupt(const char *command, const char *condition, const char *name)
{
    return shell(WEFT " %s & pid=$!; until %s; do sleep 0.01; done; kill -%s $pid; "
                      "wait $pid",
                 command, condition, name);
}

#define FRAMES(directory, n)                                                           \
    "[ \"$(cat " directory "/series.csv 2>/dev/null | wc -l)\" = " n " ]"

START_TEST(a_step_that_never_ends_is_given_up_and_the_frames_before_are_kept)
{
    const char *name = signals[_i].name;
    expect(interrupt("run " OUT "/stuck.yaml " ENDLESS "--out " OUT "/o 2>&1",
                     FRAMES(OUT "/o", "4"), name),
           signals[_i].code);
    char said[80];
    (void)snprintf(said, sizeof said, "interrupted by SIG%s within a step: stuck (",
                   name);
    says(said);
    says("3 of 11 frames");
    expect(shell("cat " OUT "/o/result.yaml"), 0);
    (void)snprintf(said, sizeof said, "reason: \"SIG%s within a step\"\nframes: 3\n",
                   name);
    says(said);
    says("status: interrupted\n");
    record_frames *frames = open_frames(OUT "/o");
    ck_assert_uint_eq(frames->count, 3);
    record_frames_close(frames);
    /* the same method by another name, undisturbed */
    expect(shell(WEFT " run " OUT "/stuck.yaml " ENDLESS "--set stepper.plugin=working "
                      "--out " OUT "/w --quiet 2>&1"),
           0);
    expect(shell(WEFT " diff " OUT "/o " OUT "/w --tol 0"), 1); /* one is longer */
    says("equal within the tolerance at 3 times that both have\n");
}
END_TEST

START_TEST(a_directory_that_took_the_place_of_the_run_stays_as_it_is)
{
    expect(interrupt("run " OUT "/stuck.yaml " ENDLESS "--out " OUT "/o --quiet 2>&1",
                     FRAMES(OUT "/o", "4") " && mv " OUT "/o " OUT
                                           "/moved && mkdir " OUT "/o",
                     "TERM"),
           4);
    says("another directory than that of this run");
    expect(shell("ls " OUT "/o | wc -l; ls " OUT "/moved/result.yaml 2>&1"), 2);
    ck_assert_int_eq(output[0], '0');
}
END_TEST

START_TEST(machines_are_told_of_a_step_that_never_ends)
{
    expect(interrupt("run " OUT "/stuck.yaml " ENDLESS "--out " OUT
                     "/o --progress yaml 2>&1",
                     FRAMES(OUT "/o", "4"), "TERM"),
           143);
    says("--- {event: end, status: interrupted, reason: \"SIGTERM within a step\", "
         "frames: 3, frames_planned: 11, ");
}
END_TEST

START_TEST(a_batch_ends_with_its_runs)
{
    expect(interrupt("batch " OUT "/stuck.yaml " ENDLESS "--out " OUT "/o -j 2 --set "
                     "'sweep={cloth.mass: [0.01, 0.02]}' 2>&1",
                     FRAMES(OUT "/o/stuck_mass=0.01",
                            "4") " && " FRAMES(OUT "/o/stuck_mass=0.02", "4"),
                     signals[_i].name),
           signals[_i].code);
    says("2 runs in " OUT "/o: 2 interrupted\n");
    expect(shell("grep -h status " OUT "/o/*/result.yaml"), 0);
    ck_assert_str_eq(output, "status: interrupted\nstatus: interrupted\n");
}
END_TEST

#ifdef HAVE_GSL
/* Of three ladders that of velocity_verlet ends, those of `endless` do not. */
START_TEST(the_processes_of_a_comparison_end_with_it)
{
    static const char *const names[] = { "TERM", "KILL" };
    (void)interrupt("compare " OUT "/stuck.yaml --plugin-path " OUT "/p:" BUILD_DIR
                    "/plugins --out " OUT
                    "/o -j 3 --methods verlet/velocity_verlet 2>" OUT "/said",
                    "grep -q '^1 of 2' " OUT "/said", names[_i]);
}
END_TEST

static const char dense[] = "weft: 1\n"
                            "name: dense\n"
                            "cloth:\n"
                            "  grid: {rows: %d, cols: %d, spacing: 0.02}\n"
                            "  density: 0.2\n"
                            "  springs: {stretch: {stiffness: 100}}\n"
                            "  pins: [top]\n"
                            "stepper: {plugin: gsl, method: %s}\n"
                            "run: {duration: 1}\n";

static void write_dense(int side, const char *method)
{
    char text[512];
    (void)snprintf(text, sizeof text, dense, side, side, method);
    write_file(OUT "/dense.yaml", text);
}

/* In its first Jacobian, of 3750 evaluations: the step is given up, and t is 0. */
START_TEST(a_jacobian_under_way_is_left_at_the_next_evaluation)
{
    write_dense(25, "msbdf");
    expect(interrupt("run " OUT "/dense.yaml --out " OUT "/o 2>&1",
                     FRAMES(OUT "/o", "2"), signals[_i].name),
           signals[_i].code);
    expect(shell("cat " OUT "/o/result.yaml"), 0);
    says("status: interrupted\n");
    says("time: 0\nsteps: 0\n");
    ck_assert(exists(OUT "/o/final.csv"));
}
END_TEST

START_TEST(dense_matrices_are_told_before_a_run)
{
    static const char told[]
        = "dense.yaml:8:32: warning: method 'msbdf' keeps matrices of 294 x 294, 1.383 "
          "MB "
          "in all, about 294 evaluations for each Jacobian: for small cloths only\n";
    write_dense(7, "msbdf");
    expect(shell(WEFT " check " OUT "/dense.yaml 2>&1"), 0);
    says(told);
    says("  matrices   of 294 x 294, 1.383 MB in all, about 294 evaluations for each ");
    expect(shell(WEFT " run " OUT "/dense.yaml --out " OUT "/o --quiet --set "
                      "run.duration=1e-9 2>&1"),
           0);
    says(told);
    write_dense(6, "rk4imp");
    expect(shell(WEFT " check " OUT "/dense.yaml 2>&1"), 0);
    says("  matrices   of 216 x 216, 1.866 MB in all");
    ck_assert_ptr_null(strstr(output, "warning"));
    write_dense(7, "rkf45");
    expect(shell(WEFT " check " OUT "/dense.yaml 2>&1"), 0);
    ck_assert_ptr_null(strstr(output, "matrices"));
}
END_TEST

/* 41 x 41 particles, and 2 or 5 matrices. */
START_TEST(more_than_a_gigabyte_needs_consent_and_nothing_is_written_without)
{
    static const char *const verbs[]
        = { "check %s", "run %s --out " OUT "/o", "batch %s --out " OUT "/o",
            "compare %s --out " OUT "/o" };
    char command[256];
    write_dense(41, "msbdf");
    for (size_t i = 0; i < 4; ++i) {
        (void)snprintf(command, sizeof command, verbs[i], OUT "/dense.yaml");
        expect(shell(WEFT " %s 2>&1", command), 3);
        says(
            "dense.yaml:8:32: error: method 'msbdf' keeps matrices of 10086 x 10086, "
            "1628 MB in all, about 10086 evaluations for each Jacobian: more than 1000 "
            "MB need stepper.large_matrices: true\n");
        ck_assert(!exists(OUT "/o"));
    }
    expect(shell("mkdir " OUT "/o && cp " OUT "/dense.yaml " OUT
                 "/o/scene.yaml && " WEFT " resume " OUT "/o 2>&1; code=$?; ls " OUT
                 "/o; exit $code"),
           3);
    says("\nscene.yaml\n");
    expect(
        shell(WEFT " check " OUT "/dense.yaml --set stepper.large_matrices=true 2>&1"),
        0);
    says("dense.yaml: ok");
    expect(shell(WEFT " check " OUT "/dense.yaml --set stepper.method=rkf45 --set "
                      "stepper.large_matrices=true 2>&1"),
           0);
}
END_TEST
#endif

/* ---- signals in every phase -------------------------------------------------------
 */

/* Two sheets through one another that do not come apart, for minutes. */
static const char tangled[]
    = "weft: 1\n"
      "name: tangled\n"
      "cloths:\n"
      "  - {name: a, fabric: {density: 0.2, stretch: 80, shear: 20}, cut: {outline: "
      "[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], spacing: 0.008, origin: "
      "[0, 0, 0], down: [0, 0, 1]}}\n"
      "  - {name: b, fabric: {density: 0.2, stretch: 80, shear: 20}, cut: {outline: "
      "[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], spacing: 0.008, origin: "
      "[0, 0.003, 0], down: [0, -1, 0.05]}}\n"
      "contact: {thickness: 1.5e-3, self: true, untangle: 1.0e+3}\n"
      "stepper: {%s}\n"
      "run: {duration: 0.1}\n";

/* Triangles by the ten thousand, whose mesh alone takes seconds. */
static const char large[]
    = "weft: 1\n"
      "name: large\n"
      "cloth: {fabric: {preset: royal-target}, cut: {outline: [[0, 0], [1, 0], [1, 1], "
      "[0, 1]], spacing: 4.0e-3}}\n"
      "stepper: {plugin: arkode, method: dormand_prince}\n"
      "run: {duration: 10}\n";

/* Steps by the million. */
static const char lasting[] = "weft: 1\n"
                              "name: lasting\n"
                              "cloth:\n"
                              "  grid: {rows: 21, cols: 21, spacing: 0.05}\n"
                              "  density: 0.2\n"
                              "  springs: {stretch: {stiffness: 500}}\n"
                              "  pins: [top]\n"
                              "stepper: {plugin: verlet, method: velocity_verlet, "
                              "fixed_step: 1.0e-4}\n"
                              "run: {duration: 3000, fps: 10, checkpoint: 1}\n";

#define RELAXES "grep -q 'crossings after' " OUT "/said"
#define SOON    "sleep 1"
#define STEPS   "[ \"$(cat " OUT "/o/series.csv 2>/dev/null | wc -l)\" -ge 3 ]"

/* What is long in each, and how it is recognised. */
static const struct {
    const char *command, *reached;
} phases[] = {
    { "run " OUT "/tangled.yaml --progress lines --out " OUT "/o", RELAXES },
    { "run " OUT "/tangled.yaml --progress yaml --out " OUT "/o", RELAXES },
    { "run " OUT "/implicit.yaml --progress lines --out " OUT "/o", RELAXES },
    { "check " OUT "/tangled.yaml", /* describes it before it relaxes */
      "grep -q 'tangled.yaml: ok' " OUT "/said && " RELAXES },
    { "compare " OUT "/tangled.yaml --progress lines --out " OUT "/o", RELAXES },
    { "batch " OUT "/tangled.yaml --out " OUT "/b", SOON },
    { "run " OUT "/large.yaml --out " OUT "/o", SOON },
    { "check " OUT "/large.yaml", SOON },
    { "run " OUT "/lasting.yaml --out " OUT "/o", STEPS },
    { "compare " OUT "/lasting.yaml -j 2 --out " OUT "/o", SOON },
    { "converge " OUT "/lasting.yaml --sizes 11,21 -j 2", SOON },
};

static void write_phases(void)
{
    char text[2048];
    begin();
    (void)snprintf(text, sizeof text, tangled,
                   "plugin: arkode, method: dormand_prince");
    write_file(OUT "/tangled.yaml", text);
    (void)snprintf(text, sizeof text, tangled,
                   "plugin: stiff, method: ros2, rtol: 1.0e-3");
    write_file(OUT "/implicit.yaml", text);
    write_file(OUT "/large.yaml", large);
    write_file(OUT "/lasting.yaml", lasting);
}

/* The exit code is that of the signal. A directory that is a run's says how it ended,
 * and no file has its temporary name. */
static void signal_phase(size_t phase, size_t which, const char *reached)
{
    char command[512];
    (void)snprintf(command, sizeof command, "%s >" OUT "/said 2>&1",
                   phases[phase].command);
    expect(shell("rm -rf " OUT "/o " OUT "/b " OUT "/said"), 0);
    const int code /* a shell ignores SIGINT in what it does not wait for */
        = shell("env --default-signal=INT " WEFT
                " %s & pid=$!; until %s; do sleep 0.01; "
                "done; kill -%s $pid; wait $pid",
                command, reached, signals[which].name);
    ck_assert_msg(code == signals[which].code, "%s: %d by SIG%s, after %s",
                  phases[phase].command, code, signals[which].name, reached);
    expect(shell("cd " OUT "; for of in o b/*; do if [ -e $of/scene.yaml ]; then "
                 "grep -q '^status: interrupted$' $of/result.yaml || exit 7; fi; done; "
                 "! find . -name '*.tmp' | grep ."),
           0);
}

START_TEST(a_signal_ends_whatever_is_under_way)
{
    write_phases();
    signal_phase((size_t)_i / 2, (size_t)_i % 2, phases[_i / 2].reached);
}
END_TEST

/* From before the first line to long after it; TEST_LONG=1: more often. */
START_TEST(a_signal_at_any_time_ends_the_program)
{
    const int turns = test_rounds(2, 20);
    uint32_t random = 66 + (uint32_t)_i;
    write_phases();
    for (int k = 0; k < turns; ++k) {
        char later[32];
        random = 1664525 * random + 1013904223;
        (void)snprintf(later, sizeof later, "sleep %.3f",
                       3.0 * (random >> 8) / (double)(1 << 24));
        signal_phase((size_t)_i, random >> 31, later);
    }
}
END_TEST

/* As weft.run of Python asks for it. */
START_TEST(a_program_ends_with_its_parent)
{
    write_phases();
    expect(shell("sh -c 'WEFT_PARENT=$$ " WEFT " run " OUT
                 "/lasting.yaml --quiet --out " OUT
                 "/o & until %s; do sleep 0.05; done; kill -9 $$' 2>&1",
                 STEPS),
           137);
    expect(shell("until [ -e " OUT "/o/result.yaml ]; do sleep 0.05; done; cat " OUT
                 "/o/result.yaml"),
           0);
    says("status: interrupted\nreason: \"SIGTERM\"\n");
}
END_TEST

TEST_SUITE(interrupt)
{
    Suite *suite = suite_create("interrupt");
    TCase *tcase = tcase_create("signals");
    tcase_set_timeout(tcase, 60.0);
    tcase_add_checked_fixture(tcase, begin, NULL);
    tcase_add_loop_test(
        tcase, a_step_that_never_ends_is_given_up_and_the_frames_before_are_kept, 0, 2);
    tcase_add_test(tcase, machines_are_told_of_a_step_that_never_ends);
    tcase_add_test(tcase, a_directory_that_took_the_place_of_the_run_stays_as_it_is);
    tcase_add_loop_test(tcase, a_batch_ends_with_its_runs, 0, 2);
#ifdef HAVE_GSL
#ifdef __linux__ /* where a process may ask to end with its parent */
    tcase_add_loop_test(tcase, the_processes_of_a_comparison_end_with_it, 0, 2);
#endif
    tcase_add_loop_test(tcase, a_jacobian_under_way_is_left_at_the_next_evaluation, 0,
                        2);
    tcase_add_test(tcase, dense_matrices_are_told_before_a_run);
    tcase_add_test(tcase,
                   more_than_a_gigabyte_needs_consent_and_nothing_is_written_without);
#endif
    suite_add_tcase(suite, tcase);
    const int count = (int)(sizeof phases / sizeof phases[0]);
    TCase *quick = tcase_create("phases"), *slow = test_long(suite, 1200);
    tcase_set_timeout(quick, 120.0);
    suite_add_tcase(suite, quick);
    tcase_add_loop_test(quick, a_signal_ends_whatever_is_under_way, 0, 2 * count);
    tcase_add_test(quick, a_program_ends_with_its_parent);
    tcase_add_loop_test(slow, a_signal_at_any_time_ends_the_program, 0, count);
    return suite;
}
