/* SPDX-License-Identifier: BSD-3-Clause */
/* weft diff: equal runs are told so, others by their first frame, particle and size. */
#include "shell.h"

#define OUT BUILD_DIR "/diff"

/* Three particles on which nothing acts; all numbers are exact. */
static const char scene[]
    = "weft: 1\n"
      "name: still\n"
      "cloth:\n"
      "  grid: {rows: 1, cols: 3, spacing: 1}\n"
      "  mass: 1\n"
      "  springs: {stretch: {stiffness: 0}}\n"
      "  pins: [[0, 0]]\n"
      "forces: {gravity: [0, 0, 0]}\n"
      "stepper: {plugin: verlet, method: midpoint, fixed_step: 0.125}\n"
      "run: {duration: 2, fps: 4}\n"
      "record: {precision: double}\n";

/* Pin (0, 2) runs off along z at v. */
#define MOVED(v) "--set 'cloth.pins=[[0, 0], {at: [0, 2], velocity: [0, 0, " v "]}]'"
#define HELD     "--set 'cloth.pins=[[0, 0], [0, 2]]'"

static void run(const char *name, const char *sets)
{
    expect(
        shell(WEFT " run " OUT "/s.yaml --out " OUT "/%s --quiet %s 2>&1", name, sets),
        0);
}

static void diff(const char *arguments, int code)
{
    expect(shell("cd " OUT "; ../weft diff %s 2>&1", arguments), code);
}

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/s.yaml", scene);
    run("a", HELD);
}

START_TEST(a_run_equals_itself)
{
    run("b", HELD);
    diff("a b", 0);
    says("equal at 9 times that both have\n");
    diff("a b --tol 0", 0);
    says("equal within the tolerance at 9 times that both have\n");
}
END_TEST

/* At frame i particle (0, 2) is i / 4 * 0.5 m off: 1 m at the end. The velocity of the
 * pin is part of the state at t = 0 already. */
START_TEST(first_frame_particle_and_size_are_told)
{
    run("b", MOVED("0.5"));
    diff("a b", 1);
    says("different at 9 of 9 times that both have\n"
         "first other state: frame 0 (t = 0 s)\n"
         "first other positions: frame 1 (t = 0.25 s): particle (0, 2) by 0.125 m\n"
         "largest: frame 8 (t = 2 s): particle (0, 2) by 1 m\n");
}
END_TEST

START_TEST(a_tolerance_is_what_positions_may_differ_by)
{
    run("b", MOVED("0.5"));
    diff("a b --tol 1", 0);
    says("equal within the tolerance at 9 times that both have\n");
    says("largest: frame 8 (t = 2 s): particle (0, 2) by 1 m\n");
    diff("a b --tol 0.5", 1);
    says("first beyond the tolerance: frame 5 (t = 1.25 s): particle (0, 2) by 0.625 "
         "m\n");
}
END_TEST

/* Frames 0, 2, ... 16 of the one are 0, 1, ... 8 of the other. */
START_TEST(runs_of_other_frame_rates_are_compared_at_common_times)
{
    run("b", MOVED("0.5") " --set run.fps=8");
    diff("a b --tol 0.5", 1);
    says("different at 4 of 9 times that both have\n");
    says("first beyond the tolerance: frames 5 and 10 (t = 1.25 s): particle (0, 2) by "
         "0.625 m\n");
    run("c", HELD " --set run.fps=8");
    diff("a c", 0);
    says("equal at 9 times that both have\n");
}
END_TEST

START_TEST(frames_that_were_not_recorded_are_passed_over)
{
    run("b", MOVED("0.5") " --set record.every=3");
    diff("a b", 1);
    says("first other positions: frame 3 (t = 0.75 s): particle (0, 2) by 0.375 m\n");
    diff("a b --tol 10", 0);
    says("at 4 times that both have\n");
}
END_TEST

/* A third of a metre is no float: that is not a difference of the runs. */
START_TEST(single_precision_is_compared_as_such)
{
    run("b", MOVED("0.3333"));
    run("c", MOVED("0.3333") " --set record.precision=single");
    diff("b c", 0);
    diff("b c --tol 0", 0);
    run("d", HELD " --set 'cloth.velocity=[1.0e-9, 0, 0]' --set "
                  "record.precision=single");
    diff("a d", 1);
    says("first other state: frame 0 (t = 0 s)\n"
         "positions are equal in the 9 frames of run.vtkhdf that both have, in single "
         "precision\n");
}
END_TEST

START_TEST(a_run_that_ends_early_is_different)
{
    run("b", HELD " --set run.duration=1");
    diff("a b", 1);
    says("equal at 5 times that both have\na ends at t = 2 s, b at t = 1 s\n");
    diff("a b --tol 1", 1);
}
END_TEST

START_TEST(without_frames_only_states_are_compared)
{
    run("b", MOVED("0.5"));
    expect(shell("rm " OUT "/b/run.vtkhdf"), 0);
    diff("a b", 1);
    says("first other state: frame 0");
    says("no run.vtkhdf to show where and by how much\n");
    diff("a b --tol 1", 4);
    says("b/run.vtkhdf is missing: --tol compares the positions of frames");
    run("c", HELD);
    expect(shell("rm " OUT "/c/run.vtkhdf"), 0);
    diff("a c", 0);
    says("compared: states by their hashes in series.csv; not run.vtkhdf, which only "
         "one "
         "of them has, or none\n");
}
END_TEST

/* A bit of a number in b's run.vtkhdf: of its first occurrence after so many others. */
static void flip(double number, int others)
{
    static unsigned char bytes[1 << 20];
    size_t at = 0;
    run("b", "--force " MOVED("0.3141592653589793"));
    FILE *stream = fopen(OUT "/b/run.vtkhdf", "r+b");
    const size_t size = fread(bytes, 1, sizeof bytes, stream);
    while (at < size
           && (memcmp(bytes + at, &number, sizeof number) != 0 || others-- > 0)) {
        ++at;
    }
    ck_assert_uint_lt(at, size);
    ck_assert_int_eq(fseek(stream, (long)at, SEEK_SET), 0);
    ck_assert_int_eq(putc(bytes[at] ^ 4, stream), bytes[at] ^ 4);
    ck_assert_int_eq(fclose(stream), 0);
}

START_TEST(a_flipped_bit_of_a_frame_is_a_difference)
{
    const double v = 0.3141592653589793;
    run("c", MOVED("0.3141592653589793"));
    diff("c c", 0);
    says(
        "equal at 9 times that both have\n"
        "compared: states by their hashes in series.csv; positions, velocities, strain "
        "in 9 frames of run.vtkhdf\n");
    flip(0.25 * v, 0);
    diff("c b", 1);
    says("different in run.vtkhdf; equal states at 9 times that both have\n"
         "the states are equal by their hashes in series.csv: one run.vtkhdf is "
         "damaged\n"
         "first other positions: frame 1 (t = 0.25 s): particle (0, 2) by ");
    flip(v, 1); /* z at 1 s is the same number */
    diff("c b", 1);
    says("one run.vtkhdf is damaged\nfirst other velocities: frame 0 (t = 0 s)\n");
}
END_TEST

START_TEST(other_grids_are_an_error)
{
    run("b", HELD " --set cloth.grid.cols=4");
    diff("a b", 3);
    says("runs of different grids: a has 1 x 3 particles, b 1 x 4");
}
END_TEST

START_TEST(what_is_missing_or_damaged_is_named)
{
    diff("a none", 4);
    says("none/series.csv: No such file");
    run("b", HELD);
    expect(shell("echo broken > " OUT "/b/run.vtkhdf"), 0);
    diff("a b", 4);
    says("b/run.vtkhdf: damaged");
    expect(shell("head -n 1 " OUT "/a/series.csv > " OUT "/b/series.csv"), 0);
    diff("a b", 4);
    says("b/series.csv: no frames");
    write_file(OUT "/b/series.csv", "frame,time,hash\n0,0,1\n1,x,2\n");
    diff("a b", 4);
    says("b/series.csv: damaged: line 3 is not in order");
    write_file(OUT "/b/series.csv", "nothing\n");
    diff("a b", 4);
    says("b/series.csv: no columns frame, time and hash");
}
END_TEST

START_TEST(frames_that_lead_nowhere_are_not_taken_for_missing_ones)
{
    static const char *const targets[] = { "run.vtkhdf", "absent" };
    run("b", HELD);
    for (size_t i = 0; i < 2; ++i) {
        expect(shell("ln -sf %s " OUT "/b/run.vtkhdf", targets[i]), 0);
        diff("a b", 4);
        says("b/run.vtkhdf");
    }
}
END_TEST

START_TEST(a_row_that_a_kill_cut_off_does_not_count)
{
    run("b", HELD);
    expect(shell("cd " OUT "/b; truncate -s -1 series.csv"), 0);
    diff("a b", 1);
    says("equal at 8 times that both have\na ends at t = 2 s, b at t = 1.75 s\n");
}
END_TEST

START_TEST(a_wrong_command_line_is_told)
{
    diff("a", 2);
    says("needs the directories of two runs");
    diff("a a a", 2);
    diff("a a --tol", 2);
    diff("a a --tol -1", 2);
    says("--tol -1: must be a number >= 0 [m]");
    diff("a a --tol 1m", 2);
    diff("a a --tol nan", 2);
}
END_TEST

TEST_SUITE(cli_diff)
{
    Suite *all = suite_create("diff");
    TCase *program = tcase_create("program");
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_set_timeout(program, 120);
    tcase_add_test(program, a_run_equals_itself);
    tcase_add_test(program, first_frame_particle_and_size_are_told);
    tcase_add_test(program, a_tolerance_is_what_positions_may_differ_by);
    tcase_add_test(program, runs_of_other_frame_rates_are_compared_at_common_times);
    tcase_add_test(program, frames_that_were_not_recorded_are_passed_over);
    tcase_add_test(program, single_precision_is_compared_as_such);
    tcase_add_test(program, a_run_that_ends_early_is_different);
    tcase_add_test(program, without_frames_only_states_are_compared);
    tcase_add_test(program, a_flipped_bit_of_a_frame_is_a_difference);
    tcase_add_test(program, other_grids_are_an_error);
    tcase_add_test(program, what_is_missing_or_damaged_is_named);
    tcase_add_test(program, frames_that_lead_nowhere_are_not_taken_for_missing_ones);
    tcase_add_test(program, a_row_that_a_kill_cut_off_does_not_count);
    tcase_add_test(program, a_wrong_command_line_is_told);
    suite_add_tcase(all, program);
    return all;
}
