/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* Runs of a batch that crash, hang, fail, take too long or are interrupted. */
#define OUT BUILD_DIR "/batch-ends"

#include "batch_sweeps.h"

/* What happens to the process of one run out of two, while the other is done. */
static const struct {
    const char *signal, *status;
} fates[] = {
    { "KILL", "crashed,killed by signal 9 (Killed)" },
    { "STOP", "timeout,not done after" }, /* it hangs */
};

/* A limit for runs on this machine [s]: twice that, as long as short ones exceed it. */
static bool too_short(int *limit)
{
    const bool exceeded
        = shell("grep -q '^0.1,[^,]*,timeout,' " OUT "/o/summary.csv") == 0;
    if (exceeded) {
        *limit *= 2;
        (void)shell("rm -rf " OUT "/o");
    }
    return exceeded;
}

START_TEST(a_run_that_crashes_or_hangs_costs_only_itself)
{
    write_sweep("c.yaml", "run: {fps: 20, checkpoint: 3}\n",
                "sweep: {run.duration: [1.0e+5, 0.1]}\n");
    char wanted[256], option[32] = "", seconds[32] = "";
    int limit = 2;
    do {
        if (_i == 1) {
            (void)snprintf(option, sizeof option, "--timeout %d", limit);
            (void)snprintf(seconds, sizeof seconds, " %d s", limit);
        }
        expect(shell(BATCH "/c.yaml --out " OUT "/o -j 1 %s 2>" OUT
                           "/err & pid=$!; until [ -e " OUT
                           "/o/c_duration=1.0e+5/checkpoint.weft ] || ! kill -0 $pid; "
                           "do sleep 0.01; done; kill -%s $(cat "
                           "/proc/$pid/task/$pid/children); wait $pid",
                     option, fates[_i].signal),
               1);
    } while (too_short(&limit));
    expect(shell("cut -d, -f 1-4 " OUT "/o/summary.csv"), 0);
    (void)snprintf(wanted, sizeof wanted, "1.0e+5,c,%s%s\n0.1,c,done,\n",
                   fates[_i].status, seconds);
    says(wanted);
    /* the frames that it has left are counted */
    expect(
        shell(
            "cd " OUT "/o/c_duration=1.0e+5; rows=$(tail -n +2 series.csv | wc -l); "
            "grep \"^frames: $rows$\" result.yaml && grep '^frames_planned: 2000001$' "
            "result.yaml && [ $rows -gt 3 ] && ! grep 'wall_time: 0$' result.yaml"),
        0);
}
END_TEST

/* But for status and reason, it is the result of a run that was interrupted. */
START_TEST(a_run_that_takes_too_long_keeps_its_own_result)
{
    write_sweep("t.yaml", long_run, "");
    int limit = 1;
    for (;; limit *= 2) { /* until it is enough for some frames */
        expect(shell("rm -rf " OUT "/o; " BATCH "/t.yaml --out " OUT
                     "/o --timeout %d --quiet 2>&1",
                     limit),
               1);
        if (shell("test $(cat " OUT "/o/t/series.csv | wc -l) -gt 2") == 0) {
            break;
        }
    }
    expect(shell("head -2 " OUT "/o/t/result.yaml"), 0);
    char wanted[80];
    (void)snprintf(wanted, sizeof wanted,
                   "status: timeout\nreason: \"not done after %d s\"\n", limit);
    ck_assert_str_eq(output, wanted);
    expect(shell("cd " OUT
                 "/o/t; rows=$(tail -n +2 series.csv | wc -l); grep \"^frames: "
                 "$rows$\" result.yaml; grep -E '^(frames_planned|wall_time|time|steps|"
                 "energy_end|hash):' result.yaml | wc -l; tail -1 ../summary.csv"),
           0);
    (void)snprintf(wanted, sizeof wanted, "\n6\nt,timeout,not done after %d s,", limit);
    says(wanted);
    const char *empty = strstr(output, ",,"); /* dissipated, without ledger */
    ck_assert(empty != NULL && strstr(empty + 1, ",,") == NULL);
}
END_TEST

/* It goes on by itself: what hindered it may be gone. */
START_TEST(a_run_that_could_not_write_goes_on_with_the_next_batch)
{
    write_sweep("two.yaml", "run: {duration: 0.5, fps: 20, checkpoint: 3}\n",
                "sweep: {cloth.springs.stretch.stiffness: [10, 20]}\n");
    expect(shell(BATCH "/two.yaml --out " OUT "/calm --quiet"), 0);
    expect(shell("mkdir -p " OUT "/o/two_stiffness=10/final.csv.tmp/x; " BATCH
                 "/two.yaml --out " OUT "/o 2>&1"),
           4);
    says("2 runs in " OUT "/o: 1 done, 1 io_error\n");
    expect(shell("grep io_error " OUT "/o/summary.csv"), 0);
    says("10,two,io_error,");
    says("two_stiffness=10/final.csv: Is a directory,11,0.5,");
    expect(shell("rm -r " OUT "/o/two_stiffness=10/final.csv.tmp; " BATCH
                 "/two.yaml --out " OUT "/o 2>&1"),
           0);
    says("1/1 done ");
    expect_same_summaries(OUT "/calm", OUT "/o");
    expect(shell("cat " OUT "/o/two_stiffness=10/log.txt"), 0);
    says("two_stiffness=10/final.csv: Is a directory"); /* a new start empties it */
}
END_TEST

START_TEST(a_run_that_could_not_even_begin_has_an_io_error)
{
    write_sweep("two.yaml", "run: {duration: 0.1}\n", "");
    expect(shell("mkdir -p " OUT "/o/two/log.txt; " BATCH "/two.yaml --out " OUT
                 "/o 2>&1"),
           4);
    says("1 runs in " OUT "/o: 1 io_error\n");
    expect(shell("head -1 " OUT "/o/two/result.yaml"), 0);
    ck_assert_str_eq(output, "status: io_error\n");
    expect(
        shell("rmdir " OUT "/o/two/log.txt; " BATCH "/two.yaml --out " OUT "/o 2>&1"),
        0);
}
END_TEST

START_TEST(a_signal_ends_a_batch_with_valid_results_and_it_goes_on_later)
{
    static const char *const names[] = { "INT", "TERM" };
    static const int codes[] = { 130, 143 };
    write_sweep("long.yaml", long_run,
                "sweep: {cloth.springs.stretch.stiffness: [10, 20, 30]}\n");
    expect(shell(BATCH "/long.yaml --out " OUT "/o -j 2 2>" OUT "/err & pid=$!; "
                       "until ls " OUT "/o/*=10*/checkpoint.weft " OUT
                       "/o/*=20*/checkpoint.weft; do sleep 0.01; done 2>/dev/null >&2; "
                       "kill -%s $pid; wait $pid",
                 names[_i]),
           codes[_i]);
    says("3 runs in " OUT "/o: 1 missing, 2 interrupted\n");
    expect(shell("grep -h status " OUT "/o/*/result.yaml"), 0);
    ck_assert_str_eq(output, "status: interrupted\nstatus: interrupted\n");
    expect(shell("cut -d, -f1-3,5 " OUT "/o/summary.csv"), 0);
    says("10,long,interrupted,\n20,long,interrupted,\n30,long,missing,\n");
    /* from where they were: not a byte of what was written differs */
    expect(shell("cp -a " OUT "/o " OUT "/before; " BATCH "/long.yaml --out " OUT
                 "/o --timeout 0.3 -j 2 --quiet 2>&1; cd " OUT
                 "/o; for d in *=10 *=20; do cmp $d/series.csv ../before/$d/series.csv "
                 "2>&1 | grep -v EOF; done"),
           1);
}
END_TEST

START_TEST(a_run_that_takes_too_long_is_left_until_it_is_asked_for)
{
    write_sweep("long.yaml", "run: {fps: 20, checkpoint: 3}\n",
                "sweep: {run.duration: [0.1, 1.0e+5]}\n");
    char wanted[128];
    int limit = 2;
    do {
        expect(shell(BATCH "/long.yaml --out " OUT "/o --timeout %d -j 2 >" OUT
                           "/said 2>&1",
                     limit),
               1);
    } while (too_short(&limit));
    expect(shell("cat " OUT "/said"), 0);
    says("2 runs in " OUT "/o: 1 done, 1 timeout\n");
    expect(shell("cut -d, -f 1-4 " OUT "/o/summary.csv"), 0);
    (void)snprintf(wanted, sizeof wanted,
                   "run.duration,scene,status,reason\n0.1,long,done,\n"
                   "1.0e+5,long,timeout,not done after %d s\n",
                   limit);
    ck_assert_str_eq(output, wanted);
    /* it is left alone, until it is asked for */
    expect(shell(BATCH "/long.yaml --out " OUT "/o 2>&1"), 1);
    ck_assert_ptr_null(strstr(output, "1/1"));
    expect(shell(BATCH "/long.yaml --out " OUT "/o --timeout 0.5 --retry-failed 2>&1"),
           1);
    says("1/1 timeout ");
}
END_TEST

START_TEST(a_run_that_fails_keeps_its_report_and_the_others_go_on)
{
    write_sweep("f.yaml", short_run, "sweep: {stepper.fixed_step: [0.1, 1.0e-3]}\n");
    expect(
        shell("sed -i 's/stiffness: 50/stiffness: 5.0e+9/; s/duration: 0.1/duration: "
              "100/' " OUT "/f.yaml"),
        0);
    write_sweep("g.yaml", short_run, "");
    expect(shell(BATCH "/f.yaml " OUT "/g.yaml --out " OUT "/o 2>&1"), 1);
    says("3 runs in " OUT "/o: 1 done, 2 failed\n");
    expect(shell("cat " OUT "/o/f_fixed_step=0.1/log.txt"), 0);
    ck_assert_str_ne(output, "");
    expect(shell("cut -d, -f1-3 " OUT "/o/summary.csv"), 0);
    says("0.1,f,failed\n1.0e-3,f,failed\n,g,done\n");
}
END_TEST

START_TEST(a_fork_that_fails_is_tried_again_while_others_run)
{
    write_sweep("h.yaml", short_run,
                "sweep: {stepper.fixed_step: [1.0e-3, 5.0e-4, 2.5e-4]}\n");
    expect(shell("ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" BUILD_DIR
                 "/tests/failing_fork.so " BATCH "/h.yaml --out " OUT "/o -j 3 2>&1"),
           0);
    says("3 runs in " OUT "/o: 3 done\n");
}
END_TEST

TEST_SUITE(batch_ends)
{
    Suite *all = suite_create("batch ends");
    TCase *program = tcase_create("program");
    tcase_set_timeout(program, 300);
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_add_loop_test(program, a_run_that_crashes_or_hangs_costs_only_itself, 0,
                        sizeof fates / sizeof fates[0]);
    tcase_add_test(program, a_run_that_takes_too_long_keeps_its_own_result);
    tcase_add_test(program, a_run_that_could_not_write_goes_on_with_the_next_batch);
    tcase_add_test(program, a_run_that_could_not_even_begin_has_an_io_error);
    tcase_add_loop_test(
        program, a_signal_ends_a_batch_with_valid_results_and_it_goes_on_later, 0, 2);
    tcase_add_test(program, a_run_that_takes_too_long_is_left_until_it_is_asked_for);
    tcase_add_test(program, a_run_that_fails_keeps_its_report_and_the_others_go_on);
    tcase_add_test(program, a_fork_that_fails_is_tried_again_while_others_run);
    suite_add_tcase(all, program);
    return all;
}
