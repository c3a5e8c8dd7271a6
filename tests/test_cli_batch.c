/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* weft batch as its users meet it: directories, summary, interruptions. */
#define OUT BUILD_DIR "/batch"

#include "batch_sweeps.h"

START_TEST(each_run_has_a_directory_that_says_what_is_varied)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml " OUT "/small.yaml --out " OUT "/o -j 2 2>&1"), 0);
    says("7/7 done ");
    says("7 runs in " OUT "/o: 7 done\n");
    expect(shell("ls " OUT "/o"), 0);
    ck_assert_str_eq(output, "six_fixed_step=1.0e-3_stiffness=10\n"
                             "six_fixed_step=1.0e-3_stiffness=20\n"
                             "six_fixed_step=1.0e-3_stiffness=30\n"
                             "six_fixed_step=5.0e-4_stiffness=10\n"
                             "six_fixed_step=5.0e-4_stiffness=20\n"
                             "six_fixed_step=5.0e-4_stiffness=30\n"
                             "small\n"
                             "summary.csv\n");
    /* what a batch runs is what weft run runs */
    expect(shell(WEFT " run " OUT "/o/six_fixed_step=5.0e-4_stiffness=20/scene.yaml "
                      "--out " OUT "/again --quiet 2>&1 && cmp " OUT
                      "/again/series.csv " OUT
                      "/o/six_fixed_step=5.0e-4_stiffness=20/series.csv"),
           0);
}
END_TEST

START_TEST(the_summary_has_a_row_a_run_and_varied_keys_first)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml " OUT "/small.yaml --out " OUT "/o --quiet"), 0);
    ck_assert_str_eq(output, "");
    expect(shell("cut -d, -f 1-5,8,10 " OUT "/o/summary.csv"), 0);
    ck_assert_str_eq(output,
                     "stepper.fixed_step,cloth.springs.stretch.stiffness,scene,status,"
                     "reason,steps,rhs_calls\n"
                     "1.0e-3,10,six,done,,100,101\n"
                     "1.0e-3,20,six,done,,100,101\n"
                     "1.0e-3,30,six,done,,100,101\n"
                     "5.0e-4,10,six,done,,200,201\n"
                     "5.0e-4,20,six,done,,200,201\n"
                     "5.0e-4,30,six,done,,200,201\n"
                     ",,small,done,,500,501\n");
    expect(shell("head -1 " OUT "/o/summary.csv"), 0);
    says("max_strain,energy_start,energy_end,dissipated,hash,directory,warnings,"
         "wall_time\n");
}
END_TEST

/* Velocity Verlet at 0.05 s is beyond its stable step and blows up. */
START_TEST(a_run_with_warnings_is_told_in_the_last_line_and_in_its_row)
{
    write_sweep(
        "w.yaml", "run: {duration: 1, fps: 20}\n",
        "sweep: {stepper.fixed_step: [1.0e-3, 0.05], run.duration: [0.2, 1]}\n");
    expect(shell(BATCH "/w.yaml --out " OUT "/o -j 2 2>&1"), 0);
    says("4 runs in " OUT "/o: 4 done (2 of them with warnings: see " OUT
         "/o/w_fixed_step=0.05_duration=0.2/log.txt)\n");
    expect(shell("grep -c warning: " OUT "/o/w_fixed_step=0.05_duration=0.2/log.txt"),
           0);
    expect(shell("cut -d, -f 1,2,4,17 " OUT "/o/summary.csv"), 0);
    ck_assert_str_eq(output, "stepper.fixed_step,run.duration,status,warnings\n"
                             "1.0e-3,0.2,done,0\n1.0e-3,1,done,0\n"
                             "0.05,0.2,done,1\n0.05,1,done,1\n");
}
END_TEST

START_TEST(numbers_beyond_all_numbers_are_spelt_as_in_series_csv)
{
    write_sweep("w.yaml", "run: {duration: 50, fps: 20}\n",
                "sweep: {stepper.fixed_step: [0.05]}\n");
    expect(shell(BATCH "/w.yaml --out " OUT "/o --quiet 2>&1"), 1);
    expect(shell("grep -F .inf " OUT "/o/*/result.yaml"), 0);
    expect(shell("tail -1 " OUT "/o/summary.csv"), 0);
    says(",inf,");
    ck_assert_ptr_null(strstr(output, ".inf"));
}
END_TEST

START_TEST(cells_are_quoted_where_they_must)
{
    write_sweep("q.yaml", short_run,
                "sweep: {name: ['say \"a, b\"'], forces.gravity: [[0, 0, -1]]}\n");
    expect(shell(BATCH "/q.yaml --out " OUT "/o --quiet"), 0);
    expect(shell("tail -1 " OUT "/o/summary.csv"), 0);
    static const char wanted[] = "\"say \"\"a, b\"\"\",\"[0, 0, -1]\",q,done,,";
    ck_assert_msg(strncmp(output, wanted, strlen(wanted)) == 0, "%s", output);
}
END_TEST

START_TEST(called_again_it_skips_what_is_done)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml --out " OUT "/o --quiet && cp -a " OUT "/o " OUT
                       "/before && " BATCH "/six.yaml --out " OUT
                       "/o --quiet && diff -r " OUT "/o " OUT "/before"),
           0);
    /* only what is new is run */
    write_sweep("six.yaml", short_run,
                "sweep:\n  stepper.fixed_step: [5.0e-4, 1.0e-3]\n"
                "  cloth.springs.stretch.stiffness: [30, 40]\n");
    expect(shell(BATCH "/six.yaml --out " OUT "/o 2>&1"), 0);
    says("2/2 done ");
    says("4 runs in " OUT "/o: 4 done\n");
}
END_TEST

START_TEST(a_run_of_a_changed_scene_is_refused_unless_forced)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml --out " OUT "/o --quiet"), 0);
    write_sweep("six.yaml", "run: {duration: 0.2, fps: 20}\n", six);
    expect(shell("cp -a " OUT "/o " OUT "/before; " BATCH "/six.yaml --out " OUT
                 "/o 2>&1"),
           4);
    says("/o/six_fixed_step=1.0e-3_stiffness=10 holds a run of another scene");
    says("6 runs in " OUT "/o: 6 changed\n");
    expect(shell("rm " OUT "/o/summary.csv " OUT "/before/summary.csv; diff -r " OUT
                 "/o " OUT "/before"),
           0);
    expect(shell(BATCH "/six.yaml --out " OUT "/o --force --quiet"), 0);
    expect(shell("cut -d, -f7 " OUT "/o/summary.csv | sort -u"), 0);
    ck_assert_str_eq(output, "0.2\ntime\n");
}
END_TEST

/* Kill -9 a batch and all its runs once so many of them have ended. Returns whether
 * that was before its end. */
static bool kill_after(const char *command, int ended)
{
    (void)shell("setsid sh -c 'exec %s' > /dev/null 2>&1 & until [ $(ls " OUT
                "/o/*/result.yaml 2>/dev/null | wc -l) -ge %d ]; do sleep 0.01; done; "
                "kill -9 -$!; wait $! 2>/dev/null",
                command, ended);
    return !exists(OUT "/o/summary.csv");
}

/* Runs of such a duration [s], as two kills have left them in OUT/o. */
static bool kill_twice(int duration)
{
    char run[64];
    (void)snprintf(run, sizeof run, "run: {duration: %d, fps: 20, checkpoint: 3}\n",
                   duration);
    write_sweep("many.yaml", run,
                "sweep:\n  stepper.fixed_step: [2.0e-4, 3.0e-4]\n"
                "  cloth.springs.stretch.stiffness: [10, 20, 30, 40, 50, 60]\n"
                "  forces.damping: [0, 1.0e-3]\n");
    (void)shell("rm -rf " OUT "/o");
    return kill_after(BATCH "/many.yaml --out " OUT "/o -j 4", 3)
           && kill_after(BATCH "/many.yaml --out " OUT "/o -j 4", 12);
}

/* Where the batch is over before a kill, its runs take longer. */
START_TEST(twenty_four_runs_killed_twice_end_with_the_summary_of_an_undisturbed_batch)
{
    for (int duration = 1; !kill_twice(duration); duration *= 2) {
    }
    expect(shell(BATCH "/many.yaml --out " OUT "/calm --quiet -j 2 2>&1"), 0);
    expect(shell(BATCH "/many.yaml --out " OUT "/o -j 2 2>&1"), 0);
    says("24 runs in " OUT "/o: 24 done\n");
    expect_same_summaries(OUT "/calm", OUT "/o");
    expect(shell("cd " OUT "/calm && for d in */; do for f in scene.yaml manifest.yaml "
                 "series.csv final.csv; do cmp $d$f ../o/$d$f || exit 1; done; done"),
           0);
}
END_TEST

START_TEST(shards_leave_together_what_one_batch_leaves)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml --out " OUT "/whole --quiet"), 0);
    expect(shell("for i in 3 1 2 4; do " BATCH "/six.yaml --out " OUT
                 "/o --shard $i/4 2>&1 & done; wait"),
           0);
    says("2 runs in " OUT "/o: 2 done\n");
    says("1 runs in " OUT "/o: 1 done\n");
    ck_assert(!exists(OUT "/o/summary.csv"));
    expect(shell(BATCH "/six.yaml --out " OUT "/o --summary 2>&1"), 0);
    expect_same_summaries(OUT "/whole", OUT "/o");
}
END_TEST

START_TEST(two_batches_at_once_run_each_run_once)
{
    write_sweep("six.yaml", "run: {duration: 0.5, fps: 20, checkpoint: 3}\n", six);
    expect(shell(BATCH "/six.yaml --out " OUT "/whole --quiet"), 0);
    expect(shell(BATCH "/six.yaml --out " OUT "/o -j 3 --quiet 2>&1 & " BATCH
                       "/six.yaml --out " OUT "/o -j 3 --quiet 2>&1; a=$?; wait $! && "
                       "exit $a"),
           0);
    expect_same_summaries(OUT "/whole", OUT "/o");
}
END_TEST

START_TEST(the_script_for_clusters_runs_a_sweep_in_tasks)
{
    write_sweep("six.yaml", short_run, six);
    expect(shell(BATCH "/six.yaml --out " OUT "/whole --quiet"), 0);
    expect(shell("for i in 1 2 3; do PATH=" BUILD_DIR ":$PATH SLURM_ARRAY_TASK_ID=$i "
                 "SLURM_ARRAY_TASK_MAX=3 SLURM_CPUS_PER_TASK=1 sh "
                 "examples/slurm-array.sh " OUT "/six.yaml " OUT
                 "/o 2>&1 || exit 1; done"),
           0);
    expect(shell(BATCH "/six.yaml --out " OUT "/o --summary"), 0);
    expect_same_summaries(OUT "/whole", OUT "/o");
}
END_TEST

START_TEST(whatever_names_hold_nothing_is_written_outside)
{
    write_sweep(
        "n.yaml", short_run,
        "sweep:\n  name: ['../x', '/', '', '.', '..', ' ', \"a\\nb\", \"\\e[1m\", "
        "'-rf', 'a/../../b', 'über', 'a_b', 'a b', 'a,b']\n");
    write_sweep("...yaml", short_run, "");
    write_sweep("summary.csv.yaml", short_run, "");
    write_sweep("-n \\$(x)'.yaml", short_run, "");
    expect(
        shell("mkdir " OUT "/in && cd " OUT "/in && ../../weft batch ../n.yaml "
              "../...yaml ../summary.csv.yaml '../-n \\$(x)'\\''.yaml' --out ./o 2>&1"),
        0);
    says("17 runs in ./o: 17 done\n");
    expect(shell("ls -A " OUT "/in"), 0);
    ck_assert_str_eq(output, "o\n");
    expect(shell("ls -A " OUT
                 "/in/o | LC_ALL=C grep -v '^[A-Za-z0-9_][-A-Za-z0-9._+=~]*$'"),
           1);
    expect(shell("ls -A " OUT "/in/o | wc -l"), 0);
    ck_assert_int_eq(atoi(output), 18);
    expect(shell("ls -d " OUT "/in/o/n_name=a_b " OUT "/in/o/n_name=a_b~*"), 0);
}
END_TEST

START_TEST(long_names_are_cut_and_stay_apart)
{
    char sweep[3000], a[1001];
    memset(a, 'a', sizeof a - 1);
    a[sizeof a - 1] = '\0';
    (void)snprintf(sweep, sizeof sweep, "sweep: {name: [%s, %sb]}\n", a, a);
    write_sweep("long-name.yaml", short_run, sweep);
    expect(shell(BATCH "/long-name.yaml --out " OUT "/o --quiet"), 0);
    expect(shell("ls " OUT "/o | awk '{print length}' | sort -u"), 0);
    ck_assert_str_eq(output, "11\n120\n");
}
END_TEST

START_TEST(a_link_in_the_place_of_a_run_is_not_followed)
{
    expect(shell("mkdir " OUT "/o " OUT "/elsewhere && ln -s ../elsewhere " OUT
                 "/o/small && " BATCH "/small.yaml --out " OUT "/o 2>&1"),
           4);
    says("small is not a readable directory");
    expect(shell("ls -A " OUT "/elsewhere"), 0);
    ck_assert_str_eq(output, "");
}
END_TEST

START_TEST(two_runs_of_one_name_are_refused_before_anything_is_run)
{
    write_sweep("t.yaml", short_run, "sweep: {run.fps: [10, 20, 10]}\n");
    expect(shell(BATCH "/t.yaml --out " OUT "/o 2>&1"), 3);
    says("t.yaml: error: runs 1 and 3 of its sweep are the same (t_fps=10)");
    expect(shell(WEFT " check " OUT "/t.yaml 2>&1"), 3);
    says("t.yaml: error: runs 1 and 3 of its sweep are the same (t_fps=10)");
    expect(shell("mkdir " OUT "/d && cp " OUT "/small.yaml " OUT "/d && " BATCH
                 "/small.yaml " OUT "/d/small.yaml --out " OUT "/o 2>&1"),
           2);
    says("would both run into 'small'");
    ck_assert(!exists(OUT "/o"));
}
END_TEST

START_TEST(a_wrong_run_is_told_before_anything_is_run)
{
    write_sweep("w.yaml", short_run, "sweep: {run.fps: [10, x]}\n");
    expect(shell(BATCH "/small.yaml " OUT "/w.yaml --out " OUT "/o 2>&1"), 3);
    says("w.yaml:12:23: error: fps must be a number");
    ck_assert(!exists(OUT "/o"));
    expect(shell(WEFT " check " OUT "/w.yaml 2>&1"), 3);
    expect(shell(WEFT " run " OUT "/w.yaml --out " OUT "/o 2>&1"), 3);
    says("'weft batch' runs them");
    write_sweep("w.yaml", short_run, "sweep: {run.fps: [10, 20]}\n");
    expect(shell(WEFT " check " OUT "/w.yaml 2>&1"), 0);
    says("a sweep of 2 runs; the first:\n  sweep      run.fps=10\n");
}
END_TEST

START_TEST(wrong_options_exit_with_2)
{
    static const char *const wrong[] = {
        "",
        "--out o",
        "x.yaml",
        "x.yaml --out ''",
        "x.yaml --out o -j 0",
        "x.yaml --out o -j two",
        "x.yaml --out o -j -1",
        "x.yaml --out o --jobs 1.5",
        "x.yaml --out o --timeout 0",
        "x.yaml --out o --timeout nan",
        "x.yaml --out o --timeout inf",
        "x.yaml --out o --timeout 5s",
        "x.yaml --out o --shard 0/3",
        "x.yaml --out o --shard 4/3",
        "x.yaml --out o --shard 1",
        "x.yaml --out o --shard /",
        "x.yaml --out o --shard 1/",
        "x.yaml --out o --shard 1/2/3",
        "x.yaml --out o --shard ''",
        "x.yaml --out o --sample 0",
        "x.yaml --out o --sample -3",
        "x.yaml --out o --sample 2.5",
        "x.yaml --out o --sample 100001",
        "x.yaml --out o --sample 3 --seed x",
        "x.yaml --out o --sample 3 --seed 2147483648",
        "x.yaml --out o --seed 3",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        ck_assert_msg(shell(WEFT " batch %s 2>&1", wrong[i]) == 2, "weft batch %s: %s",
                      wrong[i], output);
    }
    expect(shell(WEFT " run " OUT "/small.yaml -j 2 2>&1"), 2);
}
END_TEST

/* --set gives it another range; the shards of a sample draw the same values. */
START_TEST(a_sample_runs_what_the_scene_with_sample_runs)
{
    write_sweep("s.yaml", short_run,
                "sweep: {cloth.springs.stretch.stiffness: [10, 90]}\n");
    write_sweep("keys.yaml", short_run,
                "sweep: {cloth.springs.stretch.stiffness: [10, 20], sample: 5, seed: "
                "2}\n");
    expect(shell(BATCH "/keys.yaml --out " OUT "/a --quiet && mv " OUT "/keys.yaml " OUT
                       "/k.yaml && mv " OUT "/s.yaml " OUT "/keys.yaml"),
           0);
    for (int i = 1; i <= 2; ++i) {
        expect(shell(BATCH "/keys.yaml --out " OUT "/b --quiet --shard %d/2 --sample 5 "
                           "--seed 2 --set "
                           "'sweep={cloth.springs.stretch.stiffness: [10, 20]}'",
                     i),
               0);
    }
    expect(shell(BATCH "/keys.yaml --out " OUT "/b --quiet --summary --sample 5 "
                       "--seed 2 --set "
                       "'sweep={cloth.springs.stretch.stiffness: [10, 20]}'"),
           0);
    expect_same_summaries(OUT "/a", OUT "/b");
    expect(shell("ls " OUT "/b | wc -l"), 0);
    ck_assert_str_eq(output, "6\n");
}
END_TEST

START_TEST(a_terminal_gets_a_table_that_moves)
{
    write_sweep("six.yaml", "run: {duration: 2, fps: 20}\n", six);
    if (shell("command -v script") != 0) {
        return;
    }
    expect(shell("script -qec '" BATCH "/six.yaml --out " OUT "/o -j 2' /dev/null"), 0);
    says(" of 6 done, 0 failed, 2 running ");
    says("ETA ");
    says("six_fixed_step=1.0e-3_stiffness=10");
    says("\033[3A\r\033[J");
    ck_assert_ptr_null(strstr(output, "1/6"));
}
END_TEST

TEST_SUITE(cli_batch)
{
    Suite *all = suite_create("batch");
    TCase *program = tcase_create("program");
    tcase_set_timeout(program, 300);
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_add_test(program, each_run_has_a_directory_that_says_what_is_varied);
    tcase_add_test(program, the_summary_has_a_row_a_run_and_varied_keys_first);
    tcase_add_test(program,
                   a_run_with_warnings_is_told_in_the_last_line_and_in_its_row);
    tcase_add_test(program, numbers_beyond_all_numbers_are_spelt_as_in_series_csv);
    tcase_add_test(program, cells_are_quoted_where_they_must);
    tcase_add_test(program, called_again_it_skips_what_is_done);
    tcase_add_test(program, a_run_of_a_changed_scene_is_refused_unless_forced);
    tcase_add_test(
        program,
        twenty_four_runs_killed_twice_end_with_the_summary_of_an_undisturbed_batch);
    tcase_add_test(program, shards_leave_together_what_one_batch_leaves);
    tcase_add_test(program, two_batches_at_once_run_each_run_once);
    tcase_add_test(program, the_script_for_clusters_runs_a_sweep_in_tasks);
    tcase_add_test(program, whatever_names_hold_nothing_is_written_outside);
    tcase_add_test(program, long_names_are_cut_and_stay_apart);
    tcase_add_test(program, a_link_in_the_place_of_a_run_is_not_followed);
    tcase_add_test(program, two_runs_of_one_name_are_refused_before_anything_is_run);
    tcase_add_test(program, a_wrong_run_is_told_before_anything_is_run);
    tcase_add_test(program, wrong_options_exit_with_2);
    tcase_add_test(program, a_sample_runs_what_the_scene_with_sample_runs);
    tcase_add_test(program, a_terminal_gets_a_table_that_moves);
    suite_add_tcase(all, program);
    return all;
}
