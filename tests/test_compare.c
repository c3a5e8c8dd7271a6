/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow nightly asan-long */
/* weft compare as its users run it: errors, orders, horizon, what it refuses. */
#include "shell.h"

#include <math.h>
#include <unistd.h>

#if defined HAVE_GSL && defined HAVE_ARKODE

#define OUT BUILD_DIR "/compare"

/* A sheet held along its top that swings and is not chaotic. One frame, at the end: no
 * step is cut short by others. */
static const char smooth[]
    = "weft: 1\n"
      "name: smooth\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 4, spacing: 0.25}\n"
      "  density: 0.3\n"
      "  velocity: [0.1, 0, 0.3]\n"
      "  springs:\n"
      "    stretch: {stiffness: 20, damping: 0.02}\n"
      "    shear: {stiffness: 10}\n"
      "  pins: [top]\n"
      "forces: {damping: 0.002}\n"
      "stepper: {plugin: gsl, method: rkf45, rtol: 1.0e-6, atol: "
      "1.0e-6}\n"
      "run: {duration: 3, fps: 0.1}\n";

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/smooth.yaml", smooth);
}

/* ---- compare.csv -------------------------------------------------------------------
 */

enum { ROWS = 1024, COLUMNS = 16, WORD = 40 };

typedef struct run_row {
    char plugin[WORD], method[WORD], kind[WORD], outcome[WORD];
    int order;
    double setting, error, rms, calls, rejected, time;
    bool near;
} run_row;

static run_row rows[ROWS];
static size_t row_count;

static void read_row(const char *line, run_row *row)
{
    char cells[COLUMNS][WORD] = { { 0 } };
    for (size_t i = 0; i < COLUMNS; ++i) {
        const size_t length = strcspn(line, i + 1 < COLUMNS ? ",\n" : "\n");
        (void)snprintf(cells[i], WORD, "%.*s", (int)length, line);
        line += length + (line[length] == ',');
    }
    *row = (run_row){ .order = atoi(cells[2]),
                      .setting = atof(cells[4]),
                      .error = atof(cells[6]),
                      .rms = atof(cells[7]),
                      .near = cells[9][0] == '1',
                      .calls = atof(cells[10]),
                      .rejected = atof(cells[12]),
                      .time = atof(cells[14]) };
    strcpy(row->plugin, cells[0]);
    strcpy(row->method, cells[1]);
    strcpy(row->kind, cells[3]);
    strcpy(row->outcome, cells[5]);
}

static void read_rows(const char *name)
{
    const char *line = read_file(name);
    row_count = 0;
    while ((line = strchr(line, '\n')) != NULL && *++line != '\0') {
        ck_assert_uint_lt(row_count, ROWS);
        read_row(line, &rows[row_count++]);
    }
    ck_assert_uint_gt(row_count, 0);
}

/* The next row of a method after `from`; NULL past the last. */
static const run_row *next(const char *plugin, const char *method, const run_row *from)
{
    for (const run_row *row = from == NULL ? rows : from + 1; row < rows + row_count;
         ++row) {
        if (strcmp(row->plugin, plugin) == 0 && strcmp(row->method, method) == 0) {
            return row;
        }
    }
    return NULL;
}

/* ---- slopes ------------------------------------------------------------------------
 */

/* Every method here takes its order from its table; rk8pd is not of them, for its
 * leading error terms were made so small that the next ones prevail down to roundoff.
 */
static const char *const ordered[][2] = {
    { "verlet", "symplectic_euler" },
    { "verlet", "velocity_verlet" },
    { "verlet", "midpoint" },
    { "arkode", "midpoint" },
    { "arkode", "heun" },
    { "arkode", "knoth_wolke" },
    { "arkode", "rk4" },
    { "arkode", "rk38" },
    { "arkode", "bogacki_shampine" },
    { "arkode", "ark324l2sa" },
    { "arkode", "zonneveld" },
    { "arkode", "ark436l2sa" },
    { "arkode", "sayfy_aburub" },
    { "arkode", "cash_karp" },
    { "arkode", "fehlberg45" },
    { "arkode", "dormand_prince" },
    { "arkode", "verner65" },
    { "arkode", "fehlberg87" },
    { "gsl", "rk2" },
    { "gsl", "rk4" },
    { "gsl", "rkf45" },
    { "gsl", "rkck" },
};

#define ORDERED (sizeof ordered / sizeof ordered[0])

/* Steps far below the stable one, errors that the reference can tell. */
static bool asymptotic(const run_row *row)
{
    const bool fine = strcmp(row->kind, "fixed_step") == 0
                          ? row->setting < 8e-3
                          : row->setting < (row->order <= 3 ? 2e-4 : 2e-5);
    return fine && strcmp(row->outcome, "done") == 0 && !row->near;
}

/* Least squares of -log(error) over log(RHS calls). */
static double slope(const char *plugin, const char *method, int *order, size_t *points)
{
    double x = 0, y = 0, xx = 0, xy = 0, n = 0;
    for (const run_row *row = NULL; (row = next(plugin, method, row)) != NULL;) {
        if (asymptotic(row)) {
            const double a = log(row->calls), b = -log(row->error);
            x += a, y += b, xx += a * a, xy += a * b, n += 1;
            *order = row->order;
        }
    }
    *points = (size_t)n;
    return (n * xy - x * y) / (n * xx - x * x);
}

/* The option that leaves out all others, for haste. */
static const char *ordered_methods(void)
{
    static char option[512];
    size_t length = (size_t)snprintf(option, sizeof option, "--methods ");
    for (size_t i = 0; i < ORDERED; ++i) {
        length += (size_t)snprintf(option + length, sizeof option - length, "%s%s",
                                   i == 0 ? "" : ",", ordered[i][1]);
    }
    return option;
}

START_TEST(slopes_of_the_diagram_equal_the_orders)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml %s --quiet -j 2 --out " OUT
                      "/a 2>&1",
                 test_rounds(1, 0) ? ordered_methods() : ""),
           0);
    read_rows(OUT "/a/compare.csv");
    for (size_t i = 0; i < ORDERED; ++i) {
        int order = 0;
        size_t points = 0;
        const double found = slope(ordered[i][0], ordered[i][1], &order, &points);
        ck_assert_msg(points >= 3 && fabs(found - order) <= 0.3,
                      "%s %s: slope %g over %zu points, order %d", ordered[i][0],
                      ordered[i][1], found, points, order);
    }
}
END_TEST

/* ---- errors ------------------------------------------------------------------------
 */

/* Largest distance of a particle in two final.csv. */
static double apart(const char *first, const char *second)
{
    double top = 0.0;
    char *text = strdup(read_file(first));
    ck_assert_ptr_nonnull(text);
    const char *a = strchr(text, '\n'), *b = strchr(read_file(second), '\n');
    while (a != NULL && b != NULL && a[1] != '\0') {
        double p[3], q[3];
        ck_assert_int_eq(sscanf(a, "\n%*d,%*d,%lf,%lf,%lf", &p[0], &p[1], &p[2]), 3);
        ck_assert_int_eq(sscanf(b, "\n%*d,%*d,%lf,%lf,%lf", &q[0], &q[1], &q[2]), 3);
        const double d[3] = { p[0] - q[0], p[1] - q[1], p[2] - q[2] };
        top = fmax(top, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
        a = strchr(a + 1, '\n'), b = strchr(b + 1, '\n');
    }
    free(text);
    return top;
}

START_TEST(errors_and_calls_are_those_of_two_runs)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --quiet --methods rkf45 --out " OUT
                      "/b 2>&1"),
           0);
    expect(shell(WEFT " run " OUT "/smooth.yaml --quiet --set record.ledger=false "
                      "--out " OUT "/run 2>&1 && " WEFT " run " OUT
                      "/smooth.yaml --quiet --out " OUT "/right --set "
                      "'stepper={plugin: gsl, method: rk8pd, rtol: 1e-12, atol: "
                      "1e-12}' 2>&1"),
           0);
    read_rows(OUT "/b/compare.csv");
    const run_row *row = next("gsl", "rkf45", NULL);
    while (row != NULL && fabs(row->setting - 1e-6) > 1e-8) {
        row = next("gsl", "rkf45", row);
    }
    ck_assert_ptr_nonnull(row);
    const double error = apart(OUT "/run/final.csv", OUT "/right/final.csv");
    ck_assert_double_eq_tol(row->error, error, 1e-3 * error);
    ck_assert(row->rms > 0.0 && row->rms < row->error);
    char calls[64];
    (void)snprintf(calls, sizeof calls, "rhs_calls: %.0f\n", row->calls);
    ck_assert_msg(strstr(read_file(OUT "/run/result.yaml"), calls) != NULL,
                  "no %s in:\n%s", calls, read_file(OUT "/run/result.yaml"));
}
END_TEST

/* But for the times, which are in the last column but one. */
#define WITHOUT_TIMES(name) "cut -d, -f1-14 " OUT "/" name "/compare.csv"

/* ---- the table ---------------------------------------------------------------------
 */

/* The calls in a cell such as " *1.1k", or NAN for "-" and the end of the line. */
static double next_cell(const char **at)
{
    char *end;
    const char *from = *at + strspn(*at, " *");
    const double digits = strtod(from, &end);
    if (end == from || *from == '\n') {
        return NAN;
    }
    const double unit = *end == 'M' ? 1e6 : *end == 'k' ? 1e3 : 1.0;
    *at = end + strcspn(end, " \n");
    return digits * unit;
}

START_TEST(a_coarser_accuracy_never_costs_more)
{
    expect(shell(WEFT " compare " OUT
                      "/smooth.yaml --methods rk8pd,msadams,rkf45,bsimp "
                      "--out " OUT "/table 2>/dev/null"),
           0);
    size_t cells = 0;
    for (const char *line = strstr(output, "\ngsl ") + 1; strncmp(line, "gsl ", 4) == 0;
         line = strchr(line, '\n') + 1) {
        const char *at = line + strlen("gsl    rk8pd             <");
        (void)next_cell(&at); /* us/call */
        double before = 0.0;
        for (double calls; !isnan(calls = next_cell(&at)); before = calls) {
            ck_assert_msg(calls >= before, "%g calls, then %g in: %.90s", before, calls,
                          line);
            ++cells;
        }
        ck_assert_int_le(strchr(line, '\n') - line, 80);
    }
    ck_assert_uint_gt(cells, 20);
}
END_TEST

/* ---- progress ----------------------------------------------------------------------
 */

#define COMPARE_ONE                                                                    \
    WEFT " compare " OUT                                                               \
         "/smooth.yaml --methods velocity_verlet --until 0.1 --force --out " OUT       \
         "/progress "

START_TEST(progress_is_shown_as_by_run)
{
    /* frames of the references are counted as often as they last */
    expect(shell("{ " COMPARE_ONE "--progress lines 2>&1 >/dev/null && " COMPARE_ONE
                 "--progress none 2>&1 >/dev/null; } | grep -v ' of [0-9]* frames$'"),
           0);
    ck_assert_str_eq(output, "1 of 2 methods\n2 of 2 methods\n");
    expect(shell(COMPARE_ONE "--progress terminal 2>&1 >/dev/null"), 0);
    says("\r1 of 2 methods\033[K");
    ck_assert_str_eq(strrchr(output, '\r'), "\r\033[K"); /* wiped at the end */
    expect(shell(COMPARE_ONE "--progress fast 2>&1"), 2);
    says("--progress 'fast' is not auto, lines, terminal, yaml or none");
    expect(shell(COMPARE_ONE "--progress yaml --quiet 2>&1"), 2);
    says("exclude each other");
}
END_TEST

START_TEST(progress_for_machines_is_a_document_a_line)
{
    expect(shell(COMPARE_ONE "--progress yaml 2>&1 | grep -v frames:"), 0);
    ck_assert_str_eq(output, "--- {event: begin, name: \"smooth\", directory: \"" OUT
                             "/progress\", rows: 4, cols: 4, methods_planned: 2, "
                             "duration: 0.1}\n"
                             "--- {event: progress, methods: 1}\n"
                             "--- {event: progress, methods: 2}\n"
                             "--- {event: end, status: done, reason: \"\", methods: "
                             "2}\n");
    expect(shell(COMPARE_ONE "--progress yaml --set run.fps=5 --set "
                             "'limit={method: provot, strain: 0.001}' 2>/dev/null"),
           1);
    says("--- {event: end, status: failed, reason: \"not predictable: ");
}
END_TEST

/* ---- the horizon -------------------------------------------------------------------
 */

/* At each number of jobs it has the same horizon and budget. */
START_TEST(a_chaotic_scene_is_compared_to_its_horizon_only)
{
    expect(shell("for j in 1 3; do " WEFT
                 " compare scenes/two-corners.yaml --methods velocity_verlet,msadams "
                 "--set cloth.grid.rows=5 --set cloth.grid.cols=5 "
                 "--set cloth.springs.stretch.damping=0 "
                 "--set cloth.springs.shear.damping=0 "
                 "--set cloth.springs.bend.damping=0 --set forces.damping=0 "
                 "--set run.duration=20 -j $j --out " OUT
                 "/chaos$j 2>&1 || exit; done"),
           0);
    const char *at = strstr(output, "predictable to t = ");
    ck_assert_ptr_nonnull(at);
    const double horizon = strtod(at + strlen("predictable to t = "), NULL);
    ck_assert_msg(horizon > 0.1 && horizon < 10.0, "%s", output);
    says("; compared up to"); /* the line may break here */
    says("not to 20 s");
    expect(shell("for j in 1 3; do " WITHOUT_TIMES(
               "chaos$j") " > " OUT "/$j; done; "
                          "grep -q expensive " OUT "/1 && cmp " OUT "/1 " OUT "/3"),
           0);
}
END_TEST

START_TEST(a_calm_scene_is_compared_to_its_end_or_as_told)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods velocity_verlet "
                      "--out " OUT "/calm 2>&1"),
           0);
    says("1 of 2 methods\n2 of 2 methods\n"); /* no terminal: a line
                                                                 each tenth */
    says("predictable to t = 3 s at least");
    says("as the scene is (gsl rkf45): error ");
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods velocity_verlet --until "
                      "0.5 --out " OUT "/calm --force 2>&1"),
           0);
    says("predictable to t = 0.5 s at least");
}
END_TEST

/* Corrections after every step: what they do depends on the steps. */
START_TEST(without_a_reference_nothing_is_ranked)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --set run.fps=5 --set "
                      "'limit={method: provot, strain: 0.001}' --out " OUT
                      "/limit 2>&1"),
           1);
    says("not predictable: ");
    says("the effect of a strain limit depends on the steps");
    ck_assert(!exists(OUT "/limit/compare.csv"));
}
END_TEST

/* ---- what fails --------------------------------------------------------------------
 */

START_TEST(a_crash_costs_one_method)
{
    expect(shell("mkdir -p " OUT "/plugins && cp " BUILD_DIR
                 "/tests/broken/weft-crash.so " OUT "/plugins && " WEFT " compare " OUT
                 "/smooth.yaml --plugin-path " OUT "/plugins --methods crash/second "
                 "--until 0.1 --out " OUT "/crash 2>&1"),
           0);
    says("it crashed: Killed");
    read_rows(OUT "/crash/compare.csv");
    ck_assert_str_eq(next("crash", "second", NULL)->outcome, "failed");
    ck_assert_str_eq(next("gsl", "rkf45", NULL)->outcome, "done");
}
END_TEST

START_TEST(a_twin_that_fails_at_the_last_frame_is_told_as_at_any_other)
{
    write_file(OUT "/still.yaml",
               "weft: 1\n"
               "cloth: {grid: {rows: 2, cols: 2, spacing: 0.1}, mass: 0.001}\n"
               "forces: {gravity: [0, 0, 0]}\n"
               "stepper: {plugin: gsl, method: rkf45, rtol: 1.0e-6, atol: 1.0e-6}\n"
               "run: {duration: 1, fps: 4}\n");
    for (int duration = 1; duration <= 2; ++duration) {
        expect(shell("mkdir -p " OUT "/plugins && cp " BUILD_DIR
                     "/tests/broken/weft-twin.so " OUT "/plugins && " WEFT
                     " compare " OUT "/still.yaml --plugin-path " OUT
                     "/plugins --set run.duration=%d --out " OUT "/twin 2>&1",
                     duration),
               1);
        says("no reference: twin second: the twin fails");
    }
}
END_TEST

START_TEST(what_is_not_worth_its_while_is_told)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods bsimp,verlet/euler "
                      "--set cloth.grid.cols=10 --until 0.5 --out " OUT "/dear 2>&1"),
           0);
    unwrap(26);
    says("matrices of 240 x 240, 0.9216 MB in all, about 240 evaluations for each "
         "Jacobian: for small cloths only");
    read_rows(OUT "/dear/compare.csv");
    ck_assert_str_eq(next("gsl", "bsimp", NULL)->outcome, "left out");
    const run_row *last = NULL;
    for (const run_row *row = NULL; (row = next("verlet", "euler", row)) != NULL;) {
        last = row;
    }
    ck_assert_ptr_nonnull(last);
    ck_assert_str_eq(last->outcome, "too expensive");
}
END_TEST

/* The scene has too little damping for rkc2. */
START_TEST(a_method_that_refuses_the_cloth_is_left_out)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods rkc2 --until 0.5 "
                      "--out " OUT "/light 2>&1"),
           0);
    says("stiffest mode: omega ");
    unwrap(26);
    says("stiff  rkc2               rkc2: all modes are damped too lightly");
    read_rows(OUT "/light/compare.csv");
    ck_assert_str_eq(next("stiff", "rkc2", NULL)->outcome, "left out");
    ck_assert_ptr_null(next("stiff", "rkc2", next("stiff", "rkc2", NULL)));
}
END_TEST

/* The ladders of implicit methods have times of their own, and are ranked by them. */
START_TEST(methods_are_ranked_by_time)
{
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods ros2,velocity_verlet "
                      "--until 1 --out " OUT "/time 2>&1"),
           0);
    says("time [ms] until no particle is further off");
    says(" m: ");
    read_rows(OUT "/time/compare.csv");
    const run_row *last = NULL;
    size_t runs = 0;
    for (const run_row *row = NULL; (row = next("stiff", "ros2", row)) != NULL;
         last = row) {
        ck_assert_str_eq(row->kind, "tolerance");
        ck_assert(strcmp(row->outcome, "done") != 0 || row->time > 0.0);
        runs += strcmp(row->outcome, "done") == 0;
    }
    ck_assert_ptr_nonnull(last);
    ck_assert_uint_ge(runs, 2);
    unwrap(9);
    says("times as long");
}
END_TEST

START_TEST(wrong_command_lines_are_told)
{
    expect(shell(WEFT " compare 2>&1"), 2);
    says("no scene given");
    expect(shell(WEFT " compare " OUT "/smooth.yaml --methods rk4,rkf46 2>&1"), 2);
    says("no method 'rkf46'");
    expect(shell(WEFT " compare " OUT "/smooth.yaml --until 0 2>&1"), 2);
    expect(shell(WEFT " compare " OUT "/smooth.yaml --until soon 2>&1"), 2);
    says("--until soon: not a time [s] > 0");
    expect(shell(WEFT " compare " OUT "/smooth.yaml -j 0 2>&1"), 2);
    says("--jobs 0: not a number from 1 to 4096");
    expect(shell(WEFT " compare " OUT " 2>&1"), 4);
    expect(shell("mkdir -p " OUT "/full && touch " OUT "/full/letter && " WEFT
                 " compare " OUT "/smooth.yaml --out " OUT "/full 2>&1"),
           4);
    says("not empty");
}
END_TEST

START_TEST(the_page_holds_its_numbers_and_no_foreign_elements)
{
    expect(shell(WEFT " compare " OUT
                      "/smooth.yaml --quiet --methods velocity_verlet --until 0.1 "
                      "--set 'name=\"</script><b>\"' --out " OUT "/page 2>&1"),
           0);
    const char *page = read_file(OUT "/page/compare.html");
    ck_assert_ptr_null(strstr(page, "<!--WEFT-DATA-->"));
    ck_assert_ptr_nonnull(strstr(page, "\"scene\":\"\\u003c/script\\u003e\\u003cb"));
    ck_assert_ptr_nonnull(strstr(page, "\"name\":\"velocity_verlet\""));
    ck_assert_ptr_null(strstr(page, "\"name\":\"rk8pd\""));
}
END_TEST

#endif

TEST_SUITE(compare)
{
    Suite *suite = suite_create("compare");
#if defined HAVE_GSL && defined HAVE_ARKODE
    TCase *cases = tcase_create("compare");
    tcase_set_timeout(cases, 300);
    tcase_add_checked_fixture(cases, begin, NULL);
    tcase_add_test(cases, slopes_of_the_diagram_equal_the_orders);
    tcase_add_test(cases, errors_and_calls_are_those_of_two_runs);
    tcase_add_test(cases, a_coarser_accuracy_never_costs_more);
    tcase_add_test(cases, progress_is_shown_as_by_run);
    tcase_add_test(cases, progress_for_machines_is_a_document_a_line);
    tcase_add_test(cases, a_chaotic_scene_is_compared_to_its_horizon_only);
    tcase_add_test(cases, a_calm_scene_is_compared_to_its_end_or_as_told);
    tcase_add_test(cases, without_a_reference_nothing_is_ranked);
    tcase_add_test(cases, a_crash_costs_one_method);
    tcase_add_test(cases, a_twin_that_fails_at_the_last_frame_is_told_as_at_any_other);
    tcase_add_test(cases, what_is_not_worth_its_while_is_told);
    tcase_add_test(cases, a_method_that_refuses_the_cloth_is_left_out);
    tcase_add_test(cases, methods_are_ranked_by_time);
    tcase_add_test(cases, wrong_command_lines_are_told);
    tcase_add_test(cases, the_page_holds_its_numbers_and_no_foreign_elements);
    suite_add_tcase(suite, cases);
#endif
    return suite;
}
