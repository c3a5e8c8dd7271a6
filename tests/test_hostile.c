/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* test_hostile.c -- names that want to be paths, links laid out in the way, and a file
 * system without room. */
#include "shell.h"

#define OUT BUILD_DIR "/hostile"

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT "/in/side");
    write_file(OUT "/small.yaml", small_scene);
}

/* ---- names ----------------------------------------------------------------------- */

/* 100 letters. */
#define LONG                                                                           \
    "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz"                             \
    "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuv"

/* The last ones are paths as the first, and tried alone by `make nightly`. */
static const char *const names[] = {
    "../../up",
    "/tmp/weft-hostile-name",
    "$(touch in/shell)`touch in/shell`",
    "</script><script>alert(1)</script>",
    "%s%n%n",
    "-rf",
    "\\e]0;up\\a\\e[31m\\x7f\\x9b2J\\u009b2J",
    LONG LONG LONG,
    "a/b",
    "..",
    ".",
    "\\n../up\\r",
};

/* What a terminal might take for a command of its own. */
static void expect_plain(void)
{
    for (const unsigned char *c = (const unsigned char *)output; *c != '\0'; ++c) {
        ck_assert_msg(*c == '\n' || (*c >= ' ' && *c != 0x7F), "byte %02X in:\n%s", *c,
                      output);
        ck_assert_msg(*c != 0xC2 || c[1] > 0x9F, "U+%04X in:\n%s", c[1], output);
    }
}

START_TEST(a_name_is_no_path_and_no_command)
{
    expect(shell("find " OUT " | sort > " OUT "/../hostile.before"), 0);
    expect(shell("cd " OUT " && ../weft check small.yaml --set 'name=\"%s\"' 2>&1 && "
                 "../weft run small.yaml --out in/side --view --set 'name=\"%s\"' 2>&1",
                 names[_i], names[_i]),
           0);
    expect_plain();
    expect(shell("cd " OUT " && ../weft export in/side --format pvd >/dev/null 2>&1"),
           0);
    expect(shell("find " OUT " | sort | comm -13 " OUT "/../hostile.before - | "
                 "grep -v '^" OUT "/in/side/'"),
           1); /* nothing but what is in there */
    ck_assert(!exists("/tmp/weft-hostile-name"));
    expect(shell("grep -c 'alert(1)</script>' " OUT "/in/side/run.html"), 1);
}
END_TEST

START_TEST(a_scene_is_run_into_the_current_directory_whatever_its_path)
{
    static const char *const files[] = { "...yaml", ".yaml", "a.yaml.yaml", "-x.yaml" };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; ++i) {
        expect(shell("cd " OUT "/in/side && cp ../../small.yaml ../'%s' && "
                     "../../../weft run ../%s --quiet 2>&1",
                     files[i], files[i]),
               0);
    }
    expect(
        shell("cd " OUT "/in && find . -name result.yaml | grep -v '^./side/[^/]*/'"),
        1);
}
END_TEST

/* What is no character, or none that YAML takes, becomes '?' in the name that the file
 * gives the scene. */
START_TEST(a_scene_is_read_back_whatever_its_file_was_called)
{
    static const char *const files[]
        = { "\t\\\"'",          "\x1B[31m",        "\xC2\x9B", "\xE2\x80\xA8",
            "\xEF\xBF\xBE",     "\xED\xA0\x80",    "\xFF",     "\xC0\xAF",
            "\xF4\x90\x80\x80", "\xF0\x9F\xA7\xB5" };
    char path[128], text[1024];
    (void)snprintf(path, sizeof path, OUT "/in/%s.yaml", files[_i]);
    (void)snprintf(text, sizeof text, "weft: 1\n%s", strstr(small_scene, "cloth:"));
    write_file(path, text);
    expect(shell("cd " OUT "/in && "
                 "../../weft run ./*.yaml --out o 2>&1 && ../../weft run o/scene.yaml "
                 "--out p "
                 "2>&1"),
           0);
    expect_plain();
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/in/o/scene.yaml"), "name: \""));
}
END_TEST

START_TEST(a_directory_prints_no_control_characters_of_its_name)
{
    static const char in[] = "cd " OUT " && d=$(printf 'r\\033[31m') && ";
    expect(
        shell("%s../weft run small.yaml --out \"$d\" --quiet && ../weft resume \"$d\" "
              "2>&1 && ../weft export --format obj \"$d\" 2>&1",
              in),
        0);
    says("r\\x1b[31m: is already done\n");
    says("r\\x1b[31m/");
    expect_plain();
    expect(shell("%s../weft batch small.yaml --out \"b$d\" 2>&1", in), 0);
    says("1 runs in br\\x1b[31m: 1 done\n");
    expect_plain();
    expect(shell("%s../weft plugin-test \"$d\"", in), 1);
    says("FAIL plugin refused: r\\x1b[31m: ");
    expect_plain();
}
END_TEST

#if defined HAVE_GSL && defined HAVE_ARKODE
START_TEST(a_comparison_prints_no_control_characters_of_a_name)
{
    expect(shell("cd " OUT
                 " && ../weft compare small.yaml --out in/side/c --until 0.05 "
                 "--methods verlet --set 'name=\"\\e[31m\\a\"' 2>&1"),
           0);
    says("\\x1b[31m");
    expect_plain();
}
END_TEST
#endif

/* All names at once, as values of a sweep; files too are named by who wrote them. */
START_TEST(the_runs_of_a_batch_stay_in_its_directory)
{
    static const char *const files[]
        = { "..yaml", "-x.yaml", "a b;c.yaml", "x\n.yaml" };
    enum { COUNT = sizeof names / sizeof names[0], FILES = 4 };
    char text[8192], path[128];
    size_t used = (size_t)snprintf(text, sizeof text, "weft: 1\n%ssweep: {name: [x",
                                   strstr(small_scene, "cloth:"));
    for (size_t i = 0; i < COUNT; ++i) {
        used += (size_t)snprintf(text + used, sizeof text - used, ", \"%s\"", names[i]);
    }
    (void)snprintf(text + used, sizeof text - used, "]}\n");
    for (size_t i = 0; i < FILES; ++i) {
        (void)snprintf(path, sizeof path, OUT "/in/%s", files[i]);
        write_file(path, text);
    }
    expect(shell("find " OUT " | sort > " OUT "/../hostile.before"), 0);
    expect(shell("cd " OUT "/in && ../../weft batch ./*.yaml ./..yaml --out side/b "
                 "--set run.duration=0.05 2>&1"),
           0);
    expect_plain();
    expect(shell("find " OUT " | sort | comm -13 " OUT "/../hostile.before - | "
                 "grep -v '^" OUT "/in/side/b'"),
           1); /* nothing but what is in there */
    expect(
        shell("ls -A " OUT "/in/side/b | grep -v '^[A-Za-z0-9_+][A-Za-z0-9._+=~-]*$'"),
        1);
    expect(shell("ls " OUT "/in/side/b | wc -l"), 0);
    ck_assert_int_eq(atoi(output), FILES * (COUNT + 1) + 1); /* and the summary */
    ck_assert(!exists("/tmp/weft-hostile-name"));
}
END_TEST

START_TEST(force_does_not_follow_links)
{
    expect(
        shell("cd " OUT " && mkdir victim r && echo mine > victim/frame-000001.obj && "
              "cp victim/frame-000001.obj victim/final.csv && ln -s ../victim r/frames "
              "&& ln -s ../victim/final.csv r/series.csv && "
              "ln -s ../victim/final.csv r/scene.yaml.tmp && "
              "ln -s ../victim/final.csv r/run.vtkhdf && "
              "../weft run small.yaml --out r --force --frames obj --quiet 2>&1"),
        0);
    expect(shell("cd " OUT " && cat victim/frame-000001.obj victim/final.csv; "
                 "ls victim | wc -l; test ! -L r/frames"),
           0);
    ck_assert_str_eq(output, "mine\nmine\n2\n");
}
END_TEST

/* A run in OUT/killed, killed behind a checkpoint, and in OUT/long the same
 * undisturbed. Where it is over before the kill, it takes longer. */
static void make_killed(void)
{
    char set[96];
    for (int duration = 3; !exists(OUT "/killed/checkpoint.weft"); duration *= 2) {
        (void)snprintf(set, sizeof set,
                       "--set run.duration=%d --set run.fps=200 --set "
                       "run.checkpoint=10 --quiet",
                       duration);
        (void)shell("cd " OUT
                    " && rm -rf killed; ../weft run small.yaml --out killed %s "
                    "& run=$!; while kill -0 $run && [ ! -e killed/checkpoint.weft ]; "
                    "do sleep 0.01; done; kill -9 $run; wait $run",
                    set);
    }
    (void)shell("rm -f " OUT "/killed/*.tmp"); /* where it was caught at one */
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/long %s 2>&1", set), 0);
}

/* OUT/r is a copy of the directory `from`; where `name` would be in there is a link to
 * mine/name, which holds what r/name did. Runs a command and looks whether it is so
 * still. Returns the exit code. */
static int with_link(const char *from, const char *name, const char *command)
{
    const int code = shell(
        "cd " OUT " && rm -rf r mine && cp -r %s r && mkdir mine && "
        "if [ -e r/%s ]; then mv r/%s mine; else : > mine/%s; fi && "
        "cp -r mine before && ln -s ../mine/%s r/%s && { ../weft %s 2>&1; code=$?; "
        "diff -r before mine || echo CHANGED; rm -r before; exit $code; }",
        from, name, name, name, name, name, command);
    ck_assert_msg(strstr(output, "CHANGED") == NULL, "%s, %s is a link:\n%s", command,
                  name, output);
    return code;
}

START_TEST(nothing_is_written_through_a_link)
{
    expect(
        shell(WEFT " run " OUT "/small.yaml --out " OUT "/done --frames obj --quiet"),
        0);
    expect(with_link("done", "run.html.tmp", "view r >/dev/null"), 0);
    expect(with_link("done", "run.html", "view r >/dev/null"), 0);
    expect(with_link("done", "final.ply.tmp", "export r --format ply"), 0);
    expect(with_link("done", "run.mdd.tmp", "export r --format mdd"), 0);
    expect(with_link("done", "frames", "export r --format obj --frame all"), 4);
    make_killed();
    expect(with_link("killed", "series.csv", "resume r"), 4);
    says("r/series.csv: a symbolic link");
    expect(with_link("killed", "run.vtkhdf", "resume r"), 4);
    says("r/run.vtkhdf: a symbolic link");
    expect(with_link("killed", "checkpoint.weft.tmp", "resume r --quiet"), 0);
    expect(with_link("killed", "result.yaml.tmp", "resume r --quiet"), 0);
    expect(with_link("killed", "final.csv", "resume r --quiet"), 0);
}
END_TEST

START_TEST(a_batch_writes_nothing_through_a_link)
{
    static const char run[] = "batch small.yaml --out r --set run.duration=0.05";
    expect(
        shell("cd " OUT " && ../weft %s --quiet 2>&1 && mv r done && mkdir empty", run),
        0);
    expect(with_link("done", "summary.csv", run), 0);
    expect(with_link("done", "summary.csv.tmp", run), 0);
    expect(with_link("done", "small", run), 4);
    says("r/small is not a readable directory");
    expect(with_link("empty", "small", run), 4);
    expect(shell("cd " OUT " && rm done/small/run.vtkhdf.tmp done/small/result.yaml; "
                 "rm done/small/scene.yaml && : > mine/x && "
                 "ln -s ../../mine/x done/small/run.vtkhdf.tmp && "
                 "ln -s ../../mine/x done/small/scene.yaml.tmp && ../weft batch "
                 "small.yaml --out done --set run.duration=0.05 --quiet 2>&1; "
                 "ls done/small; [ ! -s mine/x ]"),
           0);
    says("result.yaml");
}
END_TEST

START_TEST(the_out_directory_itself_may_be_a_link)
{
    expect(
        shell("cd " OUT " && mkdir there && ln -s there here && "
              "../weft run small.yaml --out here --quiet && [ -e there/result.yaml ]"),
        0);
}
END_TEST

/* ---- no room --------------------------------------------------------------------- */

/* What writes, with a copy of the directory `from` in full/r, and what makes the
 * results whole once there is room again. */
typedef struct writer {
    const char *from, *command, *again;
} writer;

/* The first write as later ones do, with another text: `make nightly` tries them. */
enum { ALIKE = 3 };
static const writer writers[] = {
    { "r", "export " OUT "/full/r --format obj --frame all", NULL },
    { "r", "export " OUT "/full/r --format csv --frame all", NULL },
    { "r", "export " OUT "/full/r --format pc2", NULL },
    { "r", "run " OUT "/small.yaml --out " OUT "/full/new --frames obj --quiet", NULL },
    { "r", "view " OUT "/full/r", NULL },
    { "r", "export " OUT "/full/r --format ply --frame all", NULL },
    { "r", "export " OUT "/full/r --format mdd", NULL },
    { "r", "export " OUT "/full/r --format pvd", NULL },
    { "killed", "resume " OUT "/full/r --quiet",
      "resume " OUT "/full/r --quiet --force && cd " OUT " && cmp long/run.vtkhdf "
      "full/r/run.vtkhdf && cmp long/series.csv full/r/series.csv" },
    { "r", "batch " OUT "/small.yaml --out " OUT "/full/b -j 1",
      "batch " OUT "/small.yaml --out " OUT "/full/b --quiet --retry-failed && cd " OUT
      " && cmp r/run.vtkhdf full/b/small/run.vtkhdf" },
#if defined HAVE_GSL && defined HAVE_ARKODE
    { "r",
      "compare " OUT "/small.yaml --out " OUT "/full/c --until 0.05 --methods verlet "
      "--quiet",
      NULL },
#endif
};

enum { WRITERS = sizeof writers / sizeof writers[0] };

/* With so many free pages: 4 (of a batch also 1) and the reason, or 0. */
static int with_room(const writer *of, int pages)
{
    const int code = shell(
        "unshare -rm sh -c 'mount -t tmpfs -o size=4m t " OUT "/full && cp -r " OUT
        "/%s " OUT "/full/r && { cat /dev/zero > " OUT "/full/fill || true; } "
        "2>/dev/null; truncate -s -%dK " OUT "/full/fill && " WEFT " %s; code=$?; "
        "grep -rhs \"No space\" " OUT "/full; find " OUT "/full; rm " OUT
        "/full/fill; %s%s || echo BROKEN; exit $code' 2>&1",
        of->from, 4 * pages, of->command, of->again == NULL ? "" : WEFT " ",
        of->again == NULL ? "true" : of->again);
    ck_assert_msg(code == 0 || code == 4
                      || (code == 1 && strncmp(of->command, "batch", 5) == 0),
                  "%s, %d pages: exit code %d\n%s", of->command, pages, code, output);
    if (code != 0) {
        says("No space left on device");
    }
    ck_assert_msg(strstr(output, ".tmp") == NULL, "%s: half written\n%s", of->command,
                  output);
    ck_assert_msg(strstr(output, "BROKEN") == NULL, "%s, %d pages: not whole again\n%s",
                  of->command, pages, output);
    return code;
}

START_TEST(a_writer_without_room_says_so_and_leaves_nothing_half_written)
{
    const writer *of = &writers[_i];
    if (shell("mkdir -p " OUT "/full && unshare -rm mount -t tmpfs t " OUT "/full 2>&1")
        != 0) {
        printf("SKIPPED: no file system may be mounted here: %s", output);
        return;
    }
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet 2>&1"), 0);
    if (strcmp(of->from, "killed") == 0) {
        make_killed();
    }
    ck_assert_int_ne(with_room(of, 0), 0);
    int code = 4;
    for (int pages = 1; code != 0; pages += 1 + pages / test_rounds(1, 4)) {
        code = with_room(of, pages);
        ck_assert_int_lt(pages, 1024);
    }
}
END_TEST

/* ---- no memory ------------------------------------------------------------------- */

#ifndef __SANITIZE_ADDRESS__
/* 2500 runs that are looked for, within more and more memory, up to where it is enough.
 */
START_TEST(a_batch_without_memory_says_so)
{
    char text[8192];
    size_t used = (size_t)snprintf(text, sizeof text, "%ssweep:\n", small_scene);
    for (int key = 0; key < 2; ++key) {
        used += (size_t)snprintf(text + used, sizeof text - used, "  %s: [1",
                                 key == 0 ? "run.duration" : "cloth.density");
        for (int i = 2; i <= 50; ++i) {
            used += (size_t)snprintf(text + used, sizeof text - used, ", %d", i);
        }
        used += (size_t)snprintf(text + used, sizeof text - used, "]\n");
    }
    write_file(OUT "/many.yaml", text);
    bool told = false, enough = false;
    int code = 0;
    for (int kilobytes = 10000; !enough; kilobytes += told ? 500 : 100) {
        code = shell("ulimit -v %d; " WEFT " batch " OUT "/many.yaml --out " OUT
                     "/b --summary --quiet 2>&1",
                     kilobytes);
        if (code == 139
            && shell("ulimit -v %d; " WEFT " --version", kilobytes) == 139) {
            code = 127; /* ld.so crashes if no memory is left for a library's record */
        }
        ck_assert_int_lt(kilobytes, 1000000);
        const bool unmapped = strstr(output, "failed to map segment") != NULL;
        ck_assert_msg(code == 1 || code == 127 || (code == 3 && unmapped),
                      "%d kB: exit code %d\n%s", kilobytes, code, output);
        const bool asks = unmapped || strstr(output, "memory") != NULL;
        told = told || (code != 127 && asks);
        enough = code == 1 && output[0] == '\0';
        ck_assert_msg(enough || code == 127 || asks, "%d kB: %s", kilobytes, output);
    }
    ck_assert(told);
}
END_TEST
#endif

TEST_SUITE(hostile)
{
    Suite *suite = suite_create("hostile");
    TCase *tcase = tcase_create("hostile");
    tcase_set_timeout(tcase, 300.0);
    tcase_add_checked_fixture(tcase, begin, NULL);
    tcase_add_loop_test(tcase, a_name_is_no_path_and_no_command, 0,
                        test_rounds(8, sizeof names / sizeof names[0]));
    tcase_add_test(tcase, a_scene_is_run_into_the_current_directory_whatever_its_path);
    tcase_add_loop_test(tcase, a_scene_is_read_back_whatever_its_file_was_called, 0,
                        10);
    tcase_add_test(tcase, the_runs_of_a_batch_stay_in_its_directory);
    tcase_add_test(tcase, force_does_not_follow_links);
    tcase_add_test(tcase, nothing_is_written_through_a_link);
    tcase_add_test(tcase, a_batch_writes_nothing_through_a_link);
    tcase_add_test(tcase, the_out_directory_itself_may_be_a_link);
    tcase_add_test(tcase, a_directory_prints_no_control_characters_of_its_name);
#if defined HAVE_GSL && defined HAVE_ARKODE
    tcase_add_test(tcase, a_comparison_prints_no_control_characters_of_a_name);
#endif
    tcase_add_loop_test(tcase,
                        a_writer_without_room_says_so_and_leaves_nothing_half_written,
                        test_rounds(ALIKE, 0), WRITERS);
#ifndef __SANITIZE_ADDRESS__
    tcase_add_test(tcase, a_batch_without_memory_says_so);
#endif
    suite_add_tcase(suite, tcase);
    return suite;
}
