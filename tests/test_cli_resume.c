/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* weft resume: a run that was killed at any moment ends with the bytes of one that
 * nobody disturbed, and what cannot be gone on with is left as it is. */
#include <inttypes.h>

#define OUT BUILD_DIR "/resume"

#include "stopped_run.h"

static const char *const setups[] = {
    "",
    "--set 'limit={method: provot, strain: 0.02}'",
    "--set record.ledger=true --set 'limit={method: bridson, strain: 0.02}' --set "
    "record.every=7",
    "--set stepper.method=symplectic_euler --set record.precision=double",
    "--set stepper.fixed_step=6.1e-3", /* with a warning */
    "--set 'contact={friction: 0, shapes: [{shape: sphere, at: [0.4, -0.3, 0.3], "
    "radius: 0.2}, {shape: plane, at: [0, -1.5, 0], normal: [0, 1, 0], velocity: [0, "
    "0.5, 0]}]}' --set stepper.fixed_step=5e-4",
    "--set 'cloth={grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}, pins: [top-left], "
    "fabric: {density: 0.3, stretch: [20, 60], shear: 9, bend: [2.0e-2, 1.0e-2], "
    "damping: 1.0e-3}}' --set record.ledger=true",
    "--set 'stepper={plugin: stiff, method: rkc2}' --set "
    "cloth.springs.stretch.damping=5 --set record.ledger=true",
    "--set 'stepper={plugin: stiff, method: ros2, rtol: 1.0e-4, atol: 1.0e-4, solver: "
    "{krylov: 0.05}}' --set 'limit={method: bridson, strain: 0.02}'",
    "--set 'stepper={plugin: stiff, method: backward_euler, fixed_step: 1e-3}'",
    "--set run.frames=interpolate --set 'stop={when: max_strain > 9}' --set "
    "run.fps=700",
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
    "--set 'stepper={plugin: arkode, method: trbdf2, rtol: 1.0e-4}'",
#endif
#ifdef HAVE_CVODE
    "--set 'stepper={plugin: cvode, method: bdf, rtol: 1.0e-4, solver: {max_order: "
    "3}}'",
    "--set 'stepper={plugin: cvode, method: adams}'",
#endif
};

enum { SETUPS = sizeof setups / sizeof setups[0] };

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
        says(exists(OUT "/k") ? "no scene.yaml" : "No such file or directory");
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

/* Where runs are over sooner than they are killed, more of them are. */
START_TEST(a_killed_run_goes_on_to_the_same_bytes)
{
    uint64_t seed = (uint64_t)time(NULL) * 2654435761u + (uint64_t)_i + 1;
    const int kills = test_rounds(1, 5);
    int had = 0;
    printf("setup %d, seed %" PRIu64 "\n", _i, seed);
    make_reference(setups[_i]);
    for (int i = 0; i < kills || had == 0; ++i) {
        had += kill_once(setups[_i], _i + i, &seed);
    }
}
END_TEST

/* ---- other ends ----------------------------------------------------------------- */

/* Its largest strain comes before its first checkpoint. */
START_TEST(the_summary_of_a_resumed_run_is_that_of_the_whole_run)
{
    static const char sets[]
        = "--set 'cloth.pins=[top-left, {at: top-right, velocity: [-1, 0, 0]}]' --set "
          "'cloth.velocity=[3, 0, 0]' --set run.checkpoint=40";
    make_reference(sets);
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/whole --progress none %s | "
                      "sed -n '3,7p' > " OUT "/whole.txt",
                 sets),
           0);
    expect(shell("grep 'at most .* at t = 0.115 s' " OUT "/whole.txt"), 0);
    stop_midway(SIGKILL, sets);
    expect(shell(WEFT " resume " OUT "/k --progress none 2>" OUT
                      "/err | sed -n '3,7p' | diff " OUT "/whole.txt - 2>&1"),
           0);
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
        expect(shell("grep 'status: interrupted' " OUT "/k/result.yaml"),
               i == 0 ? 2 : 0);
        expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k 2>&1"), 4);
        says("/k: holds an unfinished run: 'weft resume " OUT "/k' continues it; or "
             "choose another --out, or --force to replace it\n");
        expect(shell(WEFT " export " OUT "/k --format obj 2>&1 >/dev/null"), 0);
        says(" of 121 frames\n");
        expect(shell("rm -rf " OUT "/k/final.obj " OUT "/k/frames; " WEFT " view " OUT
                     "/k 2>&1 >/dev/null"),
               0);
        says("/k: unfinished: ");
        ck_assert(exists(OUT "/k/run.html"));
        expect(shell(WEFT " resume " OUT "/k 2>&1"), 0);
        says("continues after frame ");
        says(" frames, 0.6 s simulated in ");
        says("121 of 121 frames");
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
    says("is already done");
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

/* The kinetic energy of its last frame is infinite. */
START_TEST(a_run_that_blew_up_is_tried_again_to_the_same_bytes)
{
    static const char *const ledgers[] = { "true", "false" };
    write_file(OUT "/small.yaml", small_scene);
    for (size_t i = 0; i < 2; ++i) {
        expect(shell("rm -rf " OUT "/k " OUT "/ref; " WEFT " run " OUT
                     "/small.yaml --out " OUT
                     "/k --quiet --set stepper.fixed_step=0.05 "
                     "--set run.duration=50 --set run.checkpoint=1 --set "
                     "record.ledger=%s 2>/dev/null",
                     ledgers[i]),
               1);
        expect(shell("tail -1 " OUT "/k/series.csv | grep ,inf, && cp -r " OUT "/k " OUT
                     "/ref; " WEFT " resume " OUT "/k --force --quiet 2>&1"),
               1);
        says("weft: error: not finite");
        same_file("series.csv");
        same_file("run.vtkhdf");
        same_file("final.csv");
    }
}
END_TEST

START_TEST(many_directories_are_gone_on_with_one_by_one)
{
    make_reference("");
    stop_midway(SIGKILL, "");
    (void)shell("cp -r " OUT "/k " OUT "/k2; mkdir " OUT "/none");
    expect(shell(WEFT " resume " OUT "/none " OUT "/ref " OUT "/k2 " OUT "/k 2>&1"), 4);
    says("none: no scene.yaml: not a run");
    says("ref: is already done");
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

/* Done, with a last frame that the longer run has not; interpolated; every third frame,
 * with contact. */
START_TEST(a_run_goes_on_until_later_to_the_bytes_of_a_longer_one)
{
    static const char *const sets[] = {
        "--set record.ledger=true --set 'stepper={plugin: stiff, method: ros2}'",
        "--set run.frames=interpolate --set record.precision=double",
        ("--set record.every=3 --set 'contact={shapes: [{shape: plane, at: [0, -1.5, "
         "0], normal: [0, 1, 0]}]}' --set stepper.fixed_step=5e-4 --frames obj")
    };
    char longer[400], shorter[400];
    (void)snprintf(longer, sizeof longer, "%s --set run.keep_checkpoint=true --set %s",
                   sets[_i], "run.duration=0.402");
    (void)snprintf(shorter, sizeof shorter,
                   "%s --set run.keep_checkpoint=true --set %s", sets[_i],
                   "run.duration=0.233");
    make_reference(longer);
    for (int i = 0; i < 2;
         ++i) { /* also in three steps, the first without a frame more */
        expect(shell("cd " OUT "; rm -rf k; ../weft run s.yaml --out k --quiet %s 2>&1",
                     shorter),
               0);
        ck_assert(exists(OUT "/k/checkpoint.weft"));
        expect(shell("cd " OUT "; (test %d = 0 || (../weft resume k --until 0.234 "
                     "--quiet && grep 'duration: 0.234' k/scene.yaml && ../weft resume "
                     "k --until 0.3 --quiet)) && ../weft resume k --until 0.402 2>&1",
                     i),
               0);
        says(i == 0 ? "k: continues after frame 40 of 81" : "after frame 50 of 81");
        expect(shell("cd " OUT "; rm -f k/checkpoint.weft; mkdir kept; mv "
                     "ref/checkpoint.weft kept; if test -e ref/frames; then diff -r "
                     "ref/frames k/frames; fi 2>&1"),
               0);
        ends_as_reference();
        expect(shell("cd " OUT "; mv kept/* ref; rmdir kept"), 0);
    }
}
END_TEST

START_TEST(an_interrupted_run_goes_on_until_later)
{
    stop_midway(SIGTERM, "");
    expect(shell(WEFT " resume " OUT "/k --until 0.6 2>&1"), 2);
    says("--until 0.6: not a time beyond 0.6 s, where ");
    expect(shell(WEFT " resume " OUT "/k --until 0.7 --quiet 2>&1"), 0);
    make_reference("--set run.duration=0.7");
    ends_as_reference();
    expect(shell(WEFT " resume " OUT "/k --until 0.8 2>&1"), 0);
    says("k: no checkpoint (run.keep_checkpoint): runs from the beginning");
    make_reference("--set run.duration=0.8");
    ends_as_reference();
}
END_TEST

START_TEST(a_run_that_is_under_way_is_not_touched)
{
    const pid_t child = start(RUN("k"), "--set run.duration=4e4");
    wait_for_checkpoint(OUT "/k");
    expect(shell(WEFT " resume " OUT "/k 2>&1"), 4);
    says("k: another weft is running there");
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/k --force 2>&1"), 4);
    says("k: another weft is running there");
    ck_assert(exists(OUT "/k/series.csv"));
    stop(child, SIGKILL);
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

TEST_SUITE(cli_resume)
{
    Suite *all = suite_create("resume");
    TCase *kills = tcase_create("kills"), *others = tcase_create("others");
    tcase_add_checked_fixture(kills, begin, NULL);
    tcase_set_timeout(kills, 240);
    tcase_add_loop_test(kills, a_killed_run_goes_on_to_the_same_bytes, 0, SETUPS);
    tcase_add_checked_fixture(others, begin, NULL);
    tcase_set_timeout(others, 120);
    tcase_add_test(others, an_unfinished_run_is_told_as_that_wherever_it_is_met);
    tcase_add_test(others, a_run_that_is_done_is_left_alone);
    tcase_add_test(others, without_a_checkpoint_a_run_begins_anew);
    tcase_add_test(others, a_run_that_failed_is_refused_unless_forced);
    tcase_add_test(others, a_run_that_blew_up_is_tried_again_to_the_same_bytes);
    tcase_add_test(others, many_directories_are_gone_on_with_one_by_one);
    tcase_add_test(others, frames_as_obj_are_gone_on_with);
    tcase_add_loop_test(others, a_run_goes_on_until_later_to_the_bytes_of_a_longer_one,
                        0, 3);
    tcase_add_test(others, an_interrupted_run_goes_on_until_later);
    tcase_add_test(others, a_run_that_is_under_way_is_not_touched);
    tcase_add_test(others, the_summary_of_a_resumed_run_is_that_of_the_whole_run);
    tcase_add_test(others, a_wrong_command_line_is_told);
    suite_add_tcase(all, kills);
    suite_add_tcase(all, others);
    return all;
}
