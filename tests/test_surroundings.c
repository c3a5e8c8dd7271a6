/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* test_surroundings.c -- scenes in every form of YAML, closed standard streams, FIFOs
 * in the place of files, and directories that hold files of the user's own. */
#include "shell.h"

#define OUT BUILD_DIR "/surroundings"

/* Ends a command that blocks, with exit code 124. */
#define PATIENT "timeout 240 ../weft "

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
}

/* ---- scenes -----------------------------------------------------------------------
 */

START_TEST(every_verb_reads_a_scene_without_a_name_in_every_form)
{
    static const char *const forms[] = {
        "{\"weft\":1,\"cloth\":{\"grid\":{\"rows\":3,\"cols\":4,\"spacing\":0.1},"
        "\"mass\":0.01,\"springs\":{\"stretch\":{\"stiffness\":10}}},\"stepper\":"
        "{\"plugin\":\"verlet\",\"method\":\"velocity_verlet\",\"fixed_step\":0.001}"
        ",\"run\":{\"duration\":0.2}}\n",
        "sed -e /^name/d -e 's/^/  /' small.yaml",
        "printf '\\357\\273\\277'; sed /^name/d small.yaml",
        "sed -e /^name/d -e 's/^weft/\"weft\"/' small.yaml",
        "sed -e /^name/d -e 's/^weft/? weft\\n/' small.yaml"
    };
    if (_i == 0) {
        write_file(OUT "/form.yaml", forms[0]);
    } else {
        expect(shell("cd " OUT " && { %s; } > form.yaml", forms[_i]), 0);
    }
    expect(shell("cd " OUT " && ../weft check form.yaml 2>&1"), 0);
    says("form.yaml: ok: form\n");
    expect(shell("cd " OUT " && ../weft batch form.yaml --out b --quiet 2>&1 && "
                 "../weft run form.yaml --out r --quiet 2>&1 && "
                 "cmp b/form/series.csv r/series.csv && cmp b/form/scene.yaml "
                 "r/scene.yaml && ../weft check r/scene.yaml"),
           0);
    says("r/scene.yaml: ok: form\n");
#if defined HAVE_GSL && defined HAVE_ARKODE
    if (_i == 0) { /* it reads as the others do */
        expect(shell("cd " OUT " && ../weft compare form.yaml --out c --until 0.05 "
                     "--methods verlet 2>&1"),
               0);
    }
#endif
}
END_TEST

/* ---- standard streams ---------------------------------------------------------------
 */

/* Bit i of the test's number: stream i is closed; two of the three if there is time. */
START_TEST(messages_never_go_into_results_when_standard_streams_are_closed)
{
    char closed[32] = "";
    if (test_rounds(1, 0) && (_i == 3 || _i == 5 || _i == 6)) {
        return;
    }
    for (int i = 0; i < 3; ++i) {
        (void)snprintf(closed + strlen(closed), sizeof closed - strlen(closed), "%s",
                       (_i >> i & 1) == 0 ? ""
                       : i == 0           ? " 0<&-"
                       : i == 1           ? " 1>&-"
                                          : " 2>&-");
    }
    static const char same[] = "for f in series.csv run.vtkhdf final.csv scene.yaml "
                               "manifest.yaml; do cmp whole/$f r/$f || exit 9; done";
    static const char longer[]
        = "--set run.duration=$seconds --set run.fps=200 --set run.checkpoint=50";
    expect(shell("cd " OUT " && ../weft run small.yaml --out whole --set "
                 "run.checkpoint=5 --quiet"),
           0);
    for (int yaml = 0; yaml < 2; ++yaml) {
        expect(shell("cd " OUT " && rm -rf r && ../weft run small.yaml --out r --set "
                     "run.checkpoint=5 %s >/dev/null 2>&1 %s; echo $?; %s",
                     yaml ? "--progress yaml" : "", closed, same),
               0);
        ck_assert_str_eq(output, "0\n");
    }
    /* killed behind a checkpoint, so that resume has something to do; where it is over
     * before, it takes longer */
    expect(
        shell("cd " OUT " && seconds=1; until [ -e r/checkpoint.weft ]; do rm -rf r; "
              "seconds=$((2 * seconds)); ../weft run small.yaml --out r %s --quiet & "
              "run=$!; while kill -0 $run && [ ! -e r/checkpoint.weft ]; do sleep "
              "0.01; done; kill -9 $run; wait $run; done 2>/dev/null; ../weft run "
              "small.yaml --out whole --force %s --quiet; ../weft resume r "
              ">/dev/null 2>&1 %s; echo $?; %s",
              longer, longer, closed, same),
        0);
    ck_assert_str_eq(output, "0\n");
}
END_TEST

START_TEST(a_wrong_weft_isa_is_an_error_before_anything_is_written)
{
    expect(shell("cd " OUT " && WEFT_ISA=avx2 ../weft run small.yaml --out r 2>&1"), 2);
    says("weft: error: WEFT_ISA is 'avx2'; this machine has plain");
    ck_assert(!exists(OUT "/r"));
    expect(shell("cd " OUT " && WEFT_ISA=plain ../weft run small.yaml --out r --quiet"),
           0);
}
END_TEST

/* ---- files -------------------------------------------------------------------------
 */

START_TEST(force_replaces_only_files_with_names_that_weft_gives)
{
    static const char own[]
        = "frame-of-reference.md frame-1.png frame-000001.obj series.csv.bak "
          "frames/frame-shop.pdf frames/final.csv frames/frame-000001.objx "
          "frames/frame-0123456.obj frames/frame-00001.obj";
    static const char ours[] = "final.obj frames/frame-000099.obj "
                               "frames/frame-000099.vtp.tmp frames/frame-1234567.csv "
                               "run.mdd scene.yaml.tmp";
    expect(
        shell("cd " OUT " && mkdir -p d/frames && cd d && for f in %s %s; do echo "
              "mine > $f; done && ../../weft run ../small.yaml --out . --force "
              "--frames obj --quiet 2>&1 && for f in %s; do grep -qx mine $f || echo "
              "$f lost; done; for f in %s; do test ! -e $f || echo $f kept; done",
              own, ours, own, ours),
        0);
    ck_assert_str_eq(output, "");
    ck_assert(exists(OUT "/d/frames/frame-000010.obj"));
    expect(shell("cd " OUT " && mkdir e && echo mine > e/frames && ../weft run "
                 "small.yaml --out e --force --frames obj --quiet 2>&1"),
           4);
    says("e/frames: ");
    ck_assert_str_eq(read_file(OUT "/e/frames"), "mine\n");
}
END_TEST

static const struct {
    const char *file, *command;
    int code;
    const char *said;
} fifos[] = {
    { "scene.yaml", "export r --format obj --frame 1", 0, "" },
    { "scene.yaml", "resume r", 4, "r/scene.yaml: not a regular file" },
    { "series.csv", "view r", 0,
      "weft: warning: r/series.csv: not a regular file; the page lacks plots" },
    { "series.csv", "diff r whole", 4, "r/series.csv: not a regular file" },
    { "run.vtkhdf", "view r", 4, "r/run.vtkhdf: not a regular file" },
    { "run.vtkhdf", "diff --tol 0 r whole", 4, "r/run.vtkhdf: not a regular file" },
    { "run.vtkhdf", "export r --format pvd", 4, "r/run.vtkhdf: not a regular file" },
    { "result.yaml", "view r", 0, "" },
    { "result.yaml", "diff r whole", 0, "equal at 11 times" },
    { "final.csv", "export r --format obj", 4, "r/final.csv: not a regular file" },
    { "manifest.yaml", "view r", 0, "" },
    { "checkpoint.weft", "resume r", 4, "r/checkpoint.weft: not a regular file" },
    { "log.txt", "batch r.yaml --out .", 4, "1 io_error" },
    { "", "check r", 4, "r: not a regular file" },
    { "", "run r --out s", 4, "r: not a regular file" },
    { "", "batch r --out s", 4, "r: not a regular file" },
    { "", "run small.yaml --out r", 4, "r: " },
    { "", "run small.yaml --out r --force", 4, "r: " },
    { "", "plugin-test weft-fifo.so", 1, "weft-fifo.so: not a regular file" },
};

/* A FIFO without a writer blocks who opens it to read. */
START_TEST(a_fifo_in_the_place_of_a_file_blocks_nobody)
{
    const char *file = fifos[_i].file, *command = fifos[_i].command;
    const bool goes_on = strncmp(command, "resume", 6) == 0 || file[0] == 'l';
    expect(shell("cd " OUT " && ../weft run small.yaml --out whole --quiet && "
                 "cp small.yaml r.yaml && mkfifo weft-fifo.so && if [ -z '%s' ]; then "
                 "mkfifo r; else cp -r whole r && rm -f r/%s && mkfifo r/%s; fi && "
                 "%s; { " PATIENT "%s 2>&1; }",
                 file, file, file, goes_on ? "rm r/result.yaml" : "true", command),
           fifos[_i].code);
    says(fifos[_i].said);
}
END_TEST

START_TEST(view_reports_a_series_that_is_missing_or_damaged)
{
    expect(shell("cd " OUT " && ../weft run small.yaml --out r --quiet && "
                 "../weft view r 2>&1 >/dev/null"),
           0);
    ck_assert_str_eq(output, "");
    expect(shell("cd " OUT " && cp r/scene.yaml r/series.csv && ../weft view r 2>&1"),
           0);
    says("weft: warning: r/series.csv: no columns frame, time and hash; the page ");
    expect(shell("cd " OUT " && rm r/series.csv && ../weft view r 2>&1"), 0);
    says("weft: warning: r/series.csv: No such file or directory; the page ");
}
END_TEST

/* ---- memory ------------------------------------------------------------------------
 */

#ifndef __SANITIZE_ADDRESS__ /* which takes more than any limit */
START_TEST(a_cloth_beyond_the_memory_is_refused_before_any_is_taken)
{
    static const char large[] = "--set cloth.grid.rows=46340 --set "
                                "cloth.grid.cols=46340";
    static const char said[]
        = "46340 x 46340 particles need at least 352.2 GB of memory; "
          "this process can have 1.024 GB\n";
    expect(shell("cd " OUT " && ulimit -v 1000000 && ../weft check small.yaml %s 2>&1",
                 large),
           1);
    says("small.yaml:1:1: ");
    says(said);
    expect(shell("cd " OUT " && ulimit -v 1000000 && ../weft run small.yaml --out r %s "
                 "2>&1",
                 large),
           1);
    says(said);
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/r/result.yaml"), "need at least"));
}
END_TEST
#endif

/* ---- plugins ------------------------------------------------------------------------
 */

static const struct {
    const char *id, *why;
} traps[] = {
    { "departs", "it ended the process with exit code 0" },
    { "aborts", "it crashed: Aborted" },
    { "blocks", "it takes longer than 10 s" },
    { "closes", "it closes standard streams" },
};

/* All at once, as each may have to wait for the plugin: exit code, file, command. */
START_TEST(a_plugin_that_ends_or_blocks_its_loader_is_refused_and_others_are_used)
{
    const char *id = traps[_i].id;
    expect(
        shell(
            "cd " OUT " && mkdir p && cp ../tests/promises/weft-%s.so p && "
            "sed 's/plugin: verlet/plugin: %s/' small.yaml > trap.yaml && "
            "export WEFT_PLUGIN_PATH=p && try() { wanted=$1; file=$2; shift 2; " PATIENT
            "$* > $file 2>&1; code=$?; "
            "if [ $code != $wanted ] || ! grep -q '%s' $file; then "
            "echo \"$*: exit code $code\"; cat $file; fi; }; "
            "try 1 1.out plugin-test p/weft-%s.so & try 0 2.out --version & "
            "try 3 3.out run trap.yaml --out r & try 3 4.out check trap.yaml & "
            "try 3 5.out batch trap.yaml --out b & try 0 6.out steppers & "
            "try 0 7.out check small.yaml small.yaml & wait; "
            "grep -c warning 7.out; grep -c 'ok: small' 7.out",
            id, id, traps[_i].why, id),
        0);
    ck_assert_str_eq(output, "1\n2\n");
}
END_TEST

/* The plugin "comma" sets it in create. LOCPATH makes libp11-kit, which libmicrohttpd
 * loads, leak 34 bytes. */
START_TEST(a_plugin_that_sets_a_locale_changes_no_file)
{
    if (!test_comma_locale()) {
        return;
    }
    expect(shell("mkdir -p " OUT "/p && cp " BUILD_DIR
                 "/tests/promises/weft-comma.so " BUILD_DIR
                 "/tests/promises/weft-working.so " OUT "/p"),
           0);
    for (int i = 0; i < 2; ++i) {
        static const char *const ids[] = { "comma", "working" };
        expect(shell("ASAN_OPTIONS=detect_leaks=0 " WEFT " run " OUT
                     "/small.yaml --plugin-path " OUT "/p --quiet --out " OUT
                     "/%s --set 'stepper={plugin: %s, method: midpoint, "
                     "fixed_step: 1.0e-3}' 2>&1",
                     ids[i], ids[i]),
               0);
    }
    expect(shell("cmp " OUT "/comma/final.csv " OUT "/working/final.csv && cmp " OUT
                 "/comma/series.csv " OUT "/working/series.csv"),
           0);
}
END_TEST

TEST_SUITE(surroundings)
{
    Suite *suite = suite_create("surroundings");
    TCase *tcase = tcase_create("surroundings");
    tcase_set_timeout(tcase, 300.0);
    tcase_add_checked_fixture(tcase, begin, NULL);
    tcase_add_test(tcase, a_plugin_that_sets_a_locale_changes_no_file);
    tcase_add_loop_test(tcase, every_verb_reads_a_scene_without_a_name_in_every_form, 0,
                        5);
    tcase_add_loop_test(
        tcase, messages_never_go_into_results_when_standard_streams_are_closed, 1, 8);
    tcase_add_test(tcase, a_wrong_weft_isa_is_an_error_before_anything_is_written);
    tcase_add_test(tcase, force_replaces_only_files_with_names_that_weft_gives);
    tcase_add_loop_test(tcase, a_fifo_in_the_place_of_a_file_blocks_nobody, 0,
                        (int)(sizeof fifos / sizeof fifos[0]));
    tcase_add_test(tcase, view_reports_a_series_that_is_missing_or_damaged);
#ifndef __SANITIZE_ADDRESS__
    tcase_add_test(tcase, a_cloth_beyond_the_memory_is_refused_before_any_is_taken);
#endif
    tcase_add_loop_test(
        tcase, a_plugin_that_ends_or_blocks_its_loader_is_refused_and_others_are_used,
        0, (int)(sizeof traps / sizeof traps[0]));
    suite_add_tcase(suite, tcase);
    return suite;
}
