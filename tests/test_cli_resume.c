/* SPDX-License-Identifier: BSD-3-Clause */
/* weft resume: a run that was killed at any moment ends with the bytes of one that
 * nobody disturbed, and what cannot be gone on with is left as it is. */
#include <inttypes.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "record/checkpoint.h"
#include "run_frames.h"

#define OUT BUILD_DIR "/resume"

/* A checkpoint every ten of many frames. */
static const char scene[]
    = "weft: 1\n"
      "name: killed\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}\n"
      "  density: 0.3\n"
      "  springs:\n"
      "    stretch: {stiffness: 50, damping: 0.01}\n"
      "    shear: {stiffness: 20}\n"
      "  pins: [top-left, {at: top-right, velocity: [0.1, 0, 0]}]\n"
      "forces: {wind: {velocity: [0, 0, 2], drag: 0.2}}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 2.0e-3}\n"
      "run: {duration: 0.6, fps: 200, checkpoint: 10}\n";

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/s.yaml", scene);
}

/* ---- a run that is stopped ----------------------------------------------------- */

static pid_t start(const char *format, const char *sets)
{
    char command[1024];
    (void)snprintf(command, sizeof command, format, sets);
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        (void)execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    return child;
}

static void sleep_for(uint64_t microseconds)
{
    const struct timespec t = { .tv_nsec = (long)(1000 * microseconds) };
    (void)nanosleep(&t, NULL);
}

/* Until there is a checkpoint, or the run is over. */
static void wait_for_checkpoint(const char *directory)
{
    char checkpoint[256], result[256];
    (void)snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.weft", directory);
    (void)snprintf(result, sizeof result, "%s/result.yaml", directory);
    while (!exists(checkpoint) && !exists(result)) {
        sleep_for(200);
    }
}

static void stop(pid_t child, int number)
{
    int status;
    (void)kill(child, number);
    ck_assert_int_eq(waitpid(child, &status, 0), child);
}

#define RUN(name) "exec " WEFT " run " OUT "/s.yaml --out " OUT "/" name " --quiet %s"

/* OUT/k is a run that was stopped behind its first checkpoint and before its end. */
static void stop_midway(int number, const char *sets)
{
    bool ended;
    do {
        (void)shell("rm -rf " OUT "/k");
        const pid_t child = start(RUN("k"), sets);
        wait_for_checkpoint(OUT "/k");
        stop(child, number);
        ended = shell("grep -q 'status: done' " OUT "/k/result.yaml 2>&1") == 0;
    } while (ended);
}

static void same_file(const char *name)
{
    expect(shell("cmp " OUT "/ref/%s " OUT "/k/%s 2>&1", name, name), 0);
}

/* All of it, but for the wall time. */
static void ends_as_reference(void)
{
    same_file("scene.yaml");
    same_file("manifest.yaml");
    same_file("series.csv");
    same_file("final.csv");
    same_file("run.vtkhdf");
    expect(shell("cd " OUT "; grep -v wall_time: ref/result.yaml > ref.yaml; grep -v "
                 "wall_time: k/result.yaml | cmp ref.yaml - 2>&1"),
           0);
    expect(shell("cd " OUT "; ls ref > ref.ls; ls k | cmp - ref.ls 2>&1"), 0);
    ck_assert(!exists(OUT "/k/checkpoint.weft"));
}

static void make_reference(const char *sets)
{
    expect(shell("rm -rf " OUT "/ref; " WEFT " run " OUT "/s.yaml --out " OUT
                 "/ref --quiet %s 2>&1",
                 sets),
           0);
}

static const char *const setups[] = {
    "",
    "--set 'limit={method: provot, strain: 0.02}'",
    "--set record.ledger=true --set 'limit={method: bridson, strain: 0.02}' --set "
    "record.every=7",
    "--set stepper.method=symplectic_euler --set record.precision=double",
    "--set stepper.fixed_step=6.1e-3", /* with a warning */
#ifdef HAVE_GSL
    "--set 'stepper={plugin: gsl, method: rkf45}' --set record.ledger=true",
    "--set 'stepper={plugin: gsl, method: rk8pd}'",
    "--set 'stepper={plugin: gsl, method: msadams}'",
    "--set 'stepper={plugin: gsl, method: bsimp}' --set cloth.grid.rows=2 --set "
    "cloth.grid.cols=3 --set run.duration=0.4",
#endif
#ifdef HAVE_ARKODE
    "--set 'stepper={plugin: arkode, method: dormand_prince}' --set "
    "'limit={method: provot, strain: 0.02}'",
    "--set 'stepper={plugin: arkode, method: heun_euler, rtol: 1.0e-4}' --set "
    "record.ledger=true",
#endif
};

enum { SETUPS = sizeof setups / sizeof setups[0], KILLS = 50 };

/* Once from the run, and every other time from going on with it too. Every fifth kill
 * may come before there is a checkpoint, or a scene, which is no run yet. Returns
 * whether there was a checkpoint. */
static bool kill_once(const char *sets, int i, uint64_t *seed)
{
    (void)shell("rm -rf " OUT "/k");
    pid_t child = start(RUN("k"), sets);
    if (i % 5 != 0) {
        wait_for_checkpoint(OUT "/k");
    }
    sleep_for(random_word(seed) % 25000);
    stop(child, SIGKILL);
    const bool had = exists(OUT "/k/checkpoint.weft");
    if (!exists(OUT "/k/scene.yaml")) {
        expect(shell(WEFT " resume " OUT "/k 2>&1"), 4);
        says("no scene.yaml");
        return false;
    }
    if (i % 2 == 0) {
        child = start("exec " WEFT " resume " OUT "/k --quiet%s", "");
        sleep_for(random_word(seed) % 25000);
        stop(child, SIGKILL);
    }
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    ends_as_reference();
    return had;
}

START_TEST(a_killed_run_goes_on_to_the_same_bytes)
{
    uint64_t seed = (uint64_t)time(NULL) * 2654435761u + (uint64_t)_i + 1;
    int had = 0, kills = 0;
    printf("setup %d, seed %" PRIu64 "\n", _i, seed);
    make_reference(setups[_i]);
    for (int i = _i; i < KILLS; i += SETUPS) {
        had += kill_once(setups[_i], kills, &seed);
        ++kills;
    }
    ck_assert_int_gt(had, 0);
}
END_TEST

/* ---- other ends ----------------------------------------------------------------- */

START_TEST(an_interrupted_run_goes_on)
{
    make_reference("");
    stop_midway(SIGINT, "");
    expect(shell("grep 'status: interrupted' " OUT "/k/result.yaml"), 0);
    expect(shell(WEFT " resume " OUT "/k 2>&1"), 0);
    says("goes on after frame ");
    says(" since it was resumed at ");
    says(" frames, 0.6 s simulated in ");
    says("121 of 121 frames");
    ends_as_reference();
}
END_TEST

START_TEST(an_unfinished_run_is_told_as_that_wherever_it_is_met)
{
    static const int signals[] = { SIGKILL, SIGINT };
    make_reference("");
    for (size_t i = 0; i < 2; ++i) {
        (void)shell("rm -rf " OUT "/k");
        stop_midway(signals[i], "");
        expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k 2>&1"), 4);
        says("/k: holds an unfinished run: 'weft resume " OUT "/k' goes on with it; or "
             "choose another --out, or --force to replace it\n");
        expect(shell(WEFT " export " OUT "/k --format obj 2>&1 >/dev/null"), 0);
        says(" of 121 frames\n");
        expect(shell("rm -rf " OUT "/k/final.obj " OUT "/k/frames; " WEFT " view " OUT
                     "/k 2>&1 >/dev/null"),
               0);
        says("/k: unfinished: ");
        ck_assert(exists(OUT "/k/run.html"));
        expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
        ends_as_reference();
        expect(shell(WEFT " view " OUT "/k 2>&1 >/dev/null"), 0);
        ck_assert_str_eq(output, "");
        expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k 2>&1"), 4);
        says("/k: not empty; choose another --out");
    }
}
END_TEST

START_TEST(a_run_that_is_done_is_left_alone)
{
    make_reference("");
    expect(shell("cksum " OUT "/ref/* > " OUT "/sums; " WEFT " resume " OUT
                 "/ref 2>&1; code=$?; cksum " OUT "/ref/* | cmp - " OUT
                 "/sums 2>&1 && exit $code"),
           0);
    says("is done already");
}
END_TEST

START_TEST(without_a_checkpoint_a_run_begins_anew)
{
    make_reference("--set run.checkpoint=0");
    (void)shell("rm -rf " OUT "/k; cp -r " OUT "/ref " OUT "/k; cd " OUT
                "/k; rm result.yaml final.csv; head -c 3000 series.csv > cut; mv cut "
                "series.csv; echo broken > run.vtkhdf");
    expect(shell(WEFT " resume " OUT "/k 2>&1"), 0);
    says("no checkpoint yet: runs from the beginning");
    same_file("series.csv");
    same_file("run.vtkhdf");
    same_file("final.csv");
    (void)shell("cd " OUT
                "/k; mkdir ../m; mv scene.yaml ../m; rm -r ../k; mv ../m ../k");
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    same_file("run.vtkhdf");
}
END_TEST

START_TEST(a_run_that_failed_is_refused_unless_forced)
{
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k --quiet --set "
                      "stepper.fixed_step=0.05 --set run.fps=10 --set run.duration=50 "
                      "--set run.checkpoint=1 2>/dev/null"),
           1);
    expect(shell("cp -r " OUT "/k " OUT "/ref; " WEFT " resume " OUT "/k 2>&1"), 1);
    says("this run failed, and would again");
    expect(shell("diff -r " OUT "/k " OUT "/ref"), 0);
    expect(shell(WEFT " resume " OUT "/k --force 2>&1"), 1);
    same_file("series.csv");
    same_file("final.csv");
    expect(shell("cd " OUT "; grep reason: ref/result.yaml > a; grep reason: "
                 "k/result.yaml | cmp - a"),
           0);
}
END_TEST

START_TEST(many_directories_are_gone_on_with_one_by_one)
{
    make_reference("");
    stop_midway(SIGKILL, "");
    (void)shell("cp -r " OUT "/k " OUT "/k2; mkdir " OUT "/none");
    expect(shell(WEFT " resume " OUT "/none " OUT "/ref " OUT "/k2 " OUT "/k 2>&1"), 4);
    says("none: no scene.yaml: this is no run");
    says("ref: is done already");
    ends_as_reference();
    expect(shell("cmp " OUT "/k/final.csv " OUT "/k2/final.csv 2>&1"), 0);
}
END_TEST

START_TEST(frames_as_obj_are_gone_on_with)
{
    make_reference("--frames obj");
    stop_midway(SIGKILL, "--frames obj");
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    expect(shell("diff -r " OUT "/ref/frames " OUT "/k/frames 2>&1"), 0);
}
END_TEST

START_TEST(a_run_that_is_under_way_is_not_touched)
{
    const pid_t child = start(RUN("k"), "--set run.duration=1000");
    wait_for_checkpoint(OUT "/k");
    expect(shell(WEFT " resume " OUT "/k 2>&1"), 4);
    says("k: another weft is running there");
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k --force 2>&1"), 4);
    says("k: another weft is running there");
    ck_assert(exists(OUT "/k/series.csv"));
    stop(child, SIGKILL);
}
END_TEST

/* ---- the checkpoint changed ----------------------------------------------------- */

static void read_checkpoint(record_checkpoint *checkpoint)
{
    weft_error err;
    ck_assert_msg(record_checkpoint_read(OUT "/k", checkpoint, &err) == WEFT_OK, "%s",
                  err.message);
}

static void write_checkpoint(record_checkpoint *checkpoint)
{
    ck_assert_int_eq(record_checkpoint_write(OUT "/k", checkpoint, NULL), WEFT_OK);
    record_checkpoint_free(checkpoint);
}

/* An hour was spent on the part before the checkpoint. */
START_TEST(wall_time_adds_up)
{
    record_checkpoint checkpoint;
    double wall_time = 0.0;
    stop_midway(SIGKILL, "");
    read_checkpoint(&checkpoint);
    ck_assert(checkpoint.wall_time > 0.0);
    checkpoint.wall_time = 3600.0;
    write_checkpoint(&checkpoint);
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    const char *found = strstr(read_file(OUT "/k/result.yaml"), "wall_time: ");
    ck_assert_ptr_nonnull(found);
    ck_assert_int_eq(sscanf(found, "wall_time: %lf", &wall_time), 1);
    ck_assert(wall_time > 3600.0);
}
END_TEST

/* With that exit code and message, and nothing has changed. */
static void refused(int code, const char *text)
{
    (void)shell("cksum " OUT "/k/* > " OUT "/sums");
    expect(shell(WEFT " resume " OUT "/k 2>&1"), code);
    says(text);
    expect(shell("cksum " OUT "/k/* | cmp - " OUT "/sums 2>&1"), 0);
}

START_TEST(another_scene_is_refused)
{
    stop_midway(SIGKILL, "");
    expect(shell("sed -i 's/stiffness: 50/stiffness: 51/' " OUT "/k/scene.yaml"), 0);
    refused(3, "k/scene.yaml is not the scene that checkpoint.weft is of");
    expect(shell("echo 'weft: [' > " OUT "/k/scene.yaml"), 0);
    refused(3, "k/scene.yaml:2:1: error: ");
}
END_TEST

START_TEST(another_version_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGKILL, "");
    read_checkpoint(&checkpoint);
    ck_assert_ptr_nonnull(strstr(checkpoint.program, "weft " WEFT_VERSION));
    (void)snprintf(checkpoint.program, sizeof checkpoint.program, "weft 0.0.1");
    write_checkpoint(&checkpoint);
    refused(4, "k/checkpoint.weft: of weft 0.0.1; this is weft " WEFT_VERSION);
}
END_TEST

START_TEST(a_damaged_checkpoint_is_refused)
{
    stop_midway(SIGINT, "");
    expect(shell("printf x | dd of=" OUT "/k/checkpoint.weft bs=1 seek=700 "
                 "conv=notrunc 2>&1"),
           0);
    refused(4, "k/checkpoint.weft: damaged: its checksum is wrong");
    expect(shell("truncate -s -8 " OUT "/k/checkpoint.weft"), 0);
    refused(4, "k/checkpoint.weft: damaged: cut off");
    expect(shell("truncate -s 0 " OUT "/k/checkpoint.weft"), 0);
    refused(4, "k/checkpoint.weft: damaged: no checkpoint");
}
END_TEST

START_TEST(records_without_the_frames_of_the_checkpoint_are_refused)
{
    stop_midway(SIGINT, "");
    (void)shell("cp -r " OUT "/k " OUT "/good");
    expect(shell("head -n 5 " OUT "/good/series.csv > " OUT "/k/series.csv"), 0);
    refused(4, "k/series.csv has no row of frame ");
    expect(shell("rm " OUT "/k/series.csv"), 0);
    refused(4, "k/series.csv: No such file");
    expect(shell("cp " OUT "/good/series.csv " OUT "/k; echo broken > " OUT
                 "/k/run.vtkhdf"),
           0);
    refused(4, "k/run.vtkhdf: damaged: no HDF5 file");
    expect(shell("rm " OUT "/k/run.vtkhdf"), 0);
    refused(4, "k/run.vtkhdf: No such file");
}
END_TEST

START_TEST(a_checkpoint_of_a_shorter_record_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGINT, "");
    read_checkpoint(&checkpoint);
    checkpoint.frames = 1000;
    write_checkpoint(&checkpoint);
    refused(4, "k/run.vtkhdf: damaged: it has not the frames it had");
}
END_TEST

START_TEST(a_wrong_command_line_is_told)
{
    expect(shell(WEFT " resume 2>&1"), 2);
    says("no directory given");
    expect(shell(WEFT " resume --out x y 2>&1"), 2);
    expect(shell(WEFT " resume --help"), 0);
    says("usage: weft resume");
}
END_TEST

static Suite *suite(void)
{
    Suite *all = suite_create("resume");
    TCase *kills = tcase_create("kills"), *others = tcase_create("others");
    tcase_add_checked_fixture(kills, begin, NULL);
    tcase_set_timeout(kills, 240);
    tcase_add_loop_test(kills, a_killed_run_goes_on_to_the_same_bytes, 0, SETUPS);
    tcase_add_checked_fixture(others, begin, NULL);
    tcase_set_timeout(others, 120);
    tcase_add_test(others, an_interrupted_run_goes_on);
    tcase_add_test(others, an_unfinished_run_is_told_as_that_wherever_it_is_met);
    tcase_add_test(others, a_run_that_is_done_is_left_alone);
    tcase_add_test(others, without_a_checkpoint_a_run_begins_anew);
    tcase_add_test(others, a_run_that_failed_is_refused_unless_forced);
    tcase_add_test(others, many_directories_are_gone_on_with_one_by_one);
    tcase_add_test(others, frames_as_obj_are_gone_on_with);
    tcase_add_test(others, a_run_that_is_under_way_is_not_touched);
    tcase_add_test(others, wall_time_adds_up);
    tcase_add_test(others, another_scene_is_refused);
    tcase_add_test(others, another_version_is_refused);
    tcase_add_test(others, a_damaged_checkpoint_is_refused);
    tcase_add_test(others, records_without_the_frames_of_the_checkpoint_are_refused);
    tcase_add_test(others, a_checkpoint_of_a_shorter_record_is_refused);
    tcase_add_test(others, a_wrong_command_line_is_told);
    suite_add_tcase(all, kills);
    suite_add_tcase(all, others);
    return all;
}

int main(void)
{
    return test_run(suite());
}
