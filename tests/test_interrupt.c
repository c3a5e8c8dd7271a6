/* SPDX-License-Identifier: BSD-3-Clause */
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
                    "grep -q '^1 of 3' " OUT "/said", names[_i]);
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
    return suite;
}
