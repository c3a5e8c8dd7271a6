/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* What a run tells: its progress on a terminal, in a pipe and to machines, and its end
 * in eight lines. */
#include <fcntl.h>
#include <pty.h>
#include <signal.h>
#include <unistd.h>
#include <yaml.h>

#include "shell.h"

#define OUT BUILD_DIR "/progress"

enum { WIDTH = 40, ROWS = 64 };

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
}

static size_t lines_of(const char *text)
{
    size_t lines = 0;
    for (; *text != '\0'; ++text) {
        lines += *text == '\n';
    }
    return lines;
}

/* ---- the end ---------------------------------------------------------------- */

static void has_eight_lines(const char *first)
{
    static const char *const labels[]
        = { "time", "steps", "step size", "strain", "energy", "limit", "files" };
    unwrap(13);
    ck_assert_uint_eq(lines_of(output), 8);
    ck_assert_msg(strncmp(output, first, strlen(first)) == 0, "no '%s' at: %s", first,
                  output);
    const char *line = output;
    for (size_t i = 0; i < sizeof labels / sizeof labels[0]; ++i) {
        line = strchr(line, '\n') + 1;
        ck_assert_msg(strncmp(line + 2, labels[i], strlen(labels[i])) == 0,
                      "no %s in: %s", labels[i], line);
    }
}

START_TEST(a_run_that_is_done_ends_with_eight_lines)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r 2>/dev/null"), 0);
    has_eight_lines("done: small (4 x 5 particles, verlet velocity_verlet)\n");
    says("11 of 11 frames, 0.5 s simulated in ");
    says("500 (0 rejected), 501 evaluations of the forces\n");
    says("step size  1 ms on average, 1 ms to 1 ms\n");
    says("limit      none\n");
    says("in " OUT "/r: scene.yaml manifest.yaml series.csv run.vtkhdf final.csv "
         "result.yaml\n");
}
END_TEST

START_TEST(the_largest_strain_is_that_of_all_frames_with_its_time)
{
    char wanted[64];
    expect(shell(WEFT
                 " run " OUT "/small.yaml --out " OUT "/r >" OUT
                 "/said 2>/dev/null && awk -F, 'NR > 1 && $10 > most { most = "
                 "$10; t = $2 } END { printf \"at most %%.3g %%%% at t = %%.4g s\", "
                 "100 * most, t }' " OUT "/r/series.csv"),
           0);
    (void)snprintf(wanted, sizeof wanted, "%.60s", output);
    expect(shell("cat " OUT "/said"), 0);
    unwrap(13);
    says(wanted);
    expect(shell("awk -F, 'END { exit !($10 < 0.9 * most) } NR > 1 && $10 > most { "
                 "most = $10 }' " OUT "/r/series.csv"),
           0); /* else the end would do */
}
END_TEST

START_TEST(a_limit_and_a_ledger_have_their_place_in_the_eight_lines)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --set limit.method=provot --set limit.strain=0.01 "
                      "2>/dev/null"),
           0);
    has_eight_lines("done: small");
    says("limit      1 %: ");
#ifdef HAVE_GSL
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/l --set "
                      "record.ledger=true --set 'stepper={plugin: gsl, method: rkf45}' "
                      "2>/dev/null"),
           0);
    has_eight_lines("done: small");
    says("; energy balance closes to ");
#endif
}
END_TEST

START_TEST(a_run_that_fails_or_is_stopped_ends_with_them_too)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/f --set stepper.fixed_step=0.05 --set run.duration=50 "
                      "2>/dev/null"),
           1);
    has_eight_lines("failed: small (");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/i --set run.duration=1e5 2>"
                      "/dev/null & pid=$!; while [ ! -s " OUT
                      "/i/series.csv ]; do sleep 0.05; done; kill -TERM $pid; "
                      "wait $pid"),
           143);
    has_eight_lines("interrupted by SIGTERM: small (");
}
END_TEST

START_TEST(a_step_that_does_not_divide_a_frame_is_told_of)
{
    expect(shell(WEFT " check " OUT "/small.yaml --set run.fps=30"), 0);
    says("fixed step 0.000980392157 s, of at");
    says("most 0.001 s, so that a frame has 34");
    expect(shell(WEFT " check " OUT "/small.yaml --set stepper.fixed_step=3e-3 --set "
                      "run.duration=0.01 --set run.fps=30"),
           0);
    says("so that a frame has 4"); /* the run is shorter than 1 / fps */
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --set run.fps=30 2>&1"),
           0);
    says("; fixed_step 0.001 s does");
    says("0.0009803922 s does");
    expect(shell("cat " OUT "/r/manifest.yaml"), 0);
    says("  fixed_step: 0.00098039215686274");
    says("  fixed_step_asked: 0.001\n");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --force 2>&1"), 0);
    ck_assert_ptr_null(strstr(output, "; fixed_step"));
    expect(shell("! grep asked " OUT "/r/manifest.yaml"), 0);
}
END_TEST

START_TEST(a_name_cannot_talk_to_the_terminal)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --set "
                      "'name=\"red \\e[31m \\u009b31m\\nand more\"' 2>&1 | "
                      "grep -v ^frame"),
           0);
    has_eight_lines("done: red \\x1b[31m \\x9b31m\\x0aand more (4 x 5");
    expect(shell(WEFT " check " OUT "/r/scene.yaml 2>&1"), 0);
    says("ok: red \\x1b[31m");
    ck_assert_ptr_null(strchr(output, '\033'));
}
END_TEST

/* ---- in a pipe -------------------------------------------------------------- */

START_TEST(in_a_pipe_there_is_a_line_each_tenth)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --set run.fps=200 2>&1 >/dev/null"),
           0);
    ck_assert_uint_eq(lines_of(output), 10);
    says("frame 10/100  ETA ");
    says("frame 100/100  ETA 0 s  t 0.5 s  h 1 ms  steps/s ");
    ck_assert_ptr_null(strchr(output, '\r'));
    ck_assert_ptr_null(strchr(output, '\033'));
}
END_TEST

START_TEST(quiet_is_quiet_and_none_leaves_the_summary)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet 2>&1"), 0);
    ck_assert_str_eq(output, "");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/s --progress none 2>&1"),
           0);
    has_eight_lines("done: small");
}
END_TEST

/* ---- for machines ----------------------------------------------------------- */

static yaml_document_t next_document(yaml_parser_t *parser)
{
    yaml_document_t document;
    ck_assert_msg(yaml_parser_load(parser, &document), "%s", parser->problem);
    return document;
}

/* The text of a key's value in the mapping of a document; NULL without one. */
static const char *value_of(yaml_document_t *document, const char *key)
{
    const yaml_node_t *root = yaml_document_get_root_node(document);
    ck_assert_int_eq(root->type, YAML_MAPPING_NODE);
    for (const yaml_node_pair_t *pair = root->data.mapping.pairs.start;
         pair < root->data.mapping.pairs.top; ++pair) {
        const char *name = (const char *)yaml_document_get_node(document, pair->key)
                               ->data.scalar.value;
        if (strcmp(name, key) == 0) {
            return (const char *)yaml_document_get_node(document, pair->value)
                ->data.scalar.value;
        }
    }
    return NULL;
}

static void has_value(yaml_document_t *document, const char *key, const char *value)
{
    const char *got = value_of(document, key);
    ck_assert_msg(got != NULL && strcmp(got, value) == 0, "%s is %s, not %s", key,
                  got == NULL ? "missing" : got, value);
}

START_TEST(for_machines_stdout_is_a_stream_of_yaml_documents_of_a_line_each)
{
    yaml_parser_t parser;
    size_t documents = 0, page = 0;
    double time = 0.0;
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --progress yaml --view --set 'name=\"a: \\\"b\\\"\\n--- c\"' "
                      "2>" OUT "/err"),
           0);
    ck_assert_str_eq(read_file(OUT "/err"), "");
    ck_assert_int_ne(yaml_parser_initialize(&parser), 0);
    yaml_parser_set_input_string(&parser, (unsigned char *)output, strlen(output));
    for (;; ++documents) {
        yaml_document_t document = next_document(&parser);
        if (yaml_document_get_root_node(&document) == NULL) {
            yaml_document_delete(&document);
            break;
        }
        const char *event = value_of(&document, "event");
        if (documents == 0) {
            has_value(&document, "event", "begin");
            has_value(&document, "name", "a: \"b\"\n--- c");
            has_value(&document, "frames_planned", "11");
        } else if (strcmp(event, "progress") == 0) {
            /* a step and the frame it ends may both be told, where the disk is slow */
            ck_assert(atof(value_of(&document, "time")) >= time);
            time = atof(value_of(&document, "time"));
        } else if (strcmp(event, "end") == 0) {
            has_value(&document, "status", "done");
            has_value(&document, "steps", "500");
        } else {
            ck_assert_str_eq(event, "page");
            ck_assert_ptr_nonnull(strstr(value_of(&document, "url"), "/r/run.html"));
            page = documents;
        }
        yaml_document_delete(&document);
    }
    yaml_parser_delete(&parser);
    ck_assert(time == 0.5);
    ck_assert_uint_ge(documents, 13); /* begin, ten tenths, end, page */
    ck_assert_uint_eq(page, documents - 1);
    ck_assert_uint_eq(lines_of(output), documents);
}
END_TEST

START_TEST(the_end_for_machines_says_what_result_yaml_says)
{
    expect(shell(WEFT
                 " run " OUT "/small.yaml --out " OUT "/r --progress yaml | tail "
                 "-1 | tr -d ',{}\"' | tr ' ' '\\n' | sed 1,3d | grep -v '^$' >" OUT
                 "/said; tr -d '\"' <" OUT
                 "/r/result.yaml | tr ' ' '\\n' | grep -v '^$' | diff - " OUT "/said"),
           0);
}
END_TEST

/* Readers of YAML 1.1 take 1e-06 for a text. */
START_TEST(a_number_with_an_exponent_has_a_point)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --progress yaml --set run.duration=2e-6"),
           0);
    says("duration: 2.0e-06}\n");
}
END_TEST

START_TEST(what_is_no_way_to_show_progress_is_refused)
{
    expect(shell(WEFT " run " OUT "/small.yaml --progress fast 2>&1"), 2);
    says("auto, lines, terminal, yaml or none");
    expect(shell(WEFT " run " OUT "/small.yaml --quiet --progress yaml 2>&1"), 2);
    says("exclude each other");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --progress yaml 2>&1 >/dev/full"),
           4);
    says("standard output");
}
END_TEST

/* ---- on a terminal ---------------------------------------------------------- */

/* What a terminal makes of the few things that are sent to it. */
typedef struct screen {
    char cells[ROWS][WIDTH + 1];
    size_t row, col, escape;
    size_t drawn; /* how often a line was begun anew */
} screen;

static void put(screen *to, char c)
{
    static const char clear[] = "\033[K";
    if (c == clear[to->escape]) {
        if (clear[++to->escape] == '\0') {
            memset(to->cells[to->row] + to->col, ' ', WIDTH - to->col);
            to->escape = 0;
        }
        return;
    }
    ck_assert_uint_eq(to->escape, 0); /* no other sequence */
    if (c == '\r') {
        to->col = 0;
        ++to->drawn;
    } else if (c == '\n') {
        ++to->row;
        ck_assert_uint_lt(to->row, ROWS);
    } else {
        to->cells[to->row][to->col++] = c;
        if (to->col == WIDTH) { /* it would wrap */
            to->col = 0;
            ++to->row;
        }
        ck_assert_uint_lt(to->row, ROWS);
    }
}

/* The program's stderr on a terminal of WIDTH columns, its stdout to a file. */
static int run_on_terminal(screen *out, const char *set)
{
    int terminal, status;
    struct winsize size = { .ws_row = ROWS, .ws_col = WIDTH };
    memset(out, 0, sizeof *out);
    memset(out->cells, ' ', sizeof out->cells);
    const pid_t child = forkpty(&terminal, NULL, NULL, &size);
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        (void)setenv("TERM", "xterm", 1);
        (void)dup2(open(OUT "/said", O_WRONLY | O_CREAT | O_TRUNC, 0666), 1);
        (void)execl(WEFT, "weft", "run", OUT "/small.yaml", "--out", OUT "/t",
                    "--force", "--set", "run.fps=200", "--set", set, (char *)NULL);
        _exit(127);
    }
    char bytes[4096];
    for (ssize_t got; (got = read(terminal, bytes, sizeof bytes)) > 0;) {
        for (ssize_t i = 0; i < got; ++i) {
            put(out, bytes[i]);
        }
    }
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    (void)close(terminal);
    ck_assert(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static bool is_blank(const char *row)
{
    return strspn(row, " ") >= WIDTH;
}

START_TEST(on_a_terminal_one_line_is_redrawn_within_its_width_and_wiped)
{
    screen seen;
    ck_assert_int_eq(run_on_terminal(&seen, "run.threads=1"), 0);
    ck_assert_uint_ge(seen.drawn, 11); /* ten tenths, and once more to wipe */
    ck_assert_uint_eq(seen.row, 0);    /* never wrapped */
    ck_assert_uint_eq(seen.col, 0);
    ck_assert(is_blank(seen.cells[0]));
    expect(shell("cat " OUT "/said"), 0);
    unwrap(13);
    ck_assert_uint_eq(lines_of(output), 8);
}
END_TEST

START_TEST(a_warning_and_an_error_stand_on_lines_of_their_own)
{
    screen seen;
    bool warned = false, failed = false;
    ck_assert_int_eq(
        run_on_terminal(&seen, "limit={method: provot, strain: 0, sweeps: 1}"), 0);
    for (size_t i = 0; i <= seen.row; ++i) {
        warned |= strncmp(seen.cells[i], "weft: warning: limit: not met ", 30) == 0;
        ck_assert_ptr_null(strstr(seen.cells[i], "ETA"));
    }
    ck_assert(warned);
    ck_assert_int_eq(run_on_terminal(&seen, "stepper.fixed_step=0.05"), 0);
    ck_assert_int_eq(run_on_terminal(&seen, "cloth.springs.stretch.stiffness=1e9"), 1);
    for (size_t i = 0; i <= seen.row; ++i) {
        failed |= strncmp(seen.cells[i], "weft: error: ", 13) == 0;
        ck_assert_ptr_null(strstr(seen.cells[i], "ETA"));
    }
    ck_assert(failed);
}
END_TEST

/* ---- directories ------------------------------------------------------------ */

START_TEST(two_runs_do_not_write_into_one_directory_at_once)
{
    expect(
        shell("exec 2>&1; " WEFT " run " OUT "/small.yaml --out " OUT "/d --quiet "
              "--set run.duration=1e5 & pid=$!; while [ ! -s " OUT
              "/d/series.csv ]; do sleep 0.05; done; for force in '' --force; do " WEFT
              " run " OUT "/small.yaml --out " OUT
              "/d --quiet $force; echo code $?; done; kill -KILL $pid; wait $pid; " WEFT
              " run " OUT "/small.yaml --out " OUT "/d --quiet --force"),
        0);
    const char *first = strstr(output, "another weft is running there\ncode 4");
    ck_assert_ptr_nonnull(first);
    ck_assert_ptr_nonnull(strstr(first + 1, "another weft is running there\ncode 4"));
}
END_TEST

START_TEST(a_run_repeated_from_what_it_left_keeps_its_name)
{
    static const char *const sets[] = { "", "--set run.fps=10" };
    expect(shell("grep -v '^name' " OUT "/small.yaml >" OUT "/unnamed.yaml"), 0);
    for (size_t i = 0; i < 2; ++i) {
        expect(shell(WEFT " run " OUT "/unnamed.yaml --out " OUT
                          "/u%zu --quiet %s && " WEFT " run " OUT
                          "/u%zu/scene.yaml --out " OUT "/v%zu --progress none",
                     i, sets[i], i, i),
               0);
        says("done: unnamed (4 x 5");
        expect(shell("cmp " OUT "/u%zu/manifest.yaml " OUT "/v%zu/manifest.yaml", i, i),
               0);
    }
}
END_TEST

TEST_SUITE(progress)
{
    Suite *all = suite_create("progress");
    TCase *runs = tcase_create("runs");
    tcase_add_checked_fixture(runs, begin, NULL);
    tcase_set_timeout(runs, 60);
    tcase_add_test(runs, a_run_that_is_done_ends_with_eight_lines);
    tcase_add_test(runs, the_largest_strain_is_that_of_all_frames_with_its_time);
    tcase_add_test(runs, a_limit_and_a_ledger_have_their_place_in_the_eight_lines);
    tcase_add_test(runs, a_run_that_fails_or_is_stopped_ends_with_them_too);
    tcase_add_test(runs, a_step_that_does_not_divide_a_frame_is_told_of);
    tcase_add_test(runs, a_name_cannot_talk_to_the_terminal);
    tcase_add_test(runs, in_a_pipe_there_is_a_line_each_tenth);
    tcase_add_test(runs, quiet_is_quiet_and_none_leaves_the_summary);
    tcase_add_test(runs,
                   for_machines_stdout_is_a_stream_of_yaml_documents_of_a_line_each);
    tcase_add_test(runs, the_end_for_machines_says_what_result_yaml_says);
    tcase_add_test(runs, a_number_with_an_exponent_has_a_point);
    tcase_add_test(runs, what_is_no_way_to_show_progress_is_refused);
    tcase_add_test(runs, on_a_terminal_one_line_is_redrawn_within_its_width_and_wiped);
    tcase_add_test(runs, a_warning_and_an_error_stand_on_lines_of_their_own);
    tcase_add_test(runs, two_runs_do_not_write_into_one_directory_at_once);
    tcase_add_test(runs, a_run_repeated_from_what_it_left_keeps_its_name);
    suite_add_tcase(all, runs);
    return all;
}
