/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* What the program prints: how wide its lines are, how many there are, and the help on
 * single keys. */
#include "shell.h"

#define OUT BUILD_DIR "/output"

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
}

/* Of UTF-8 text; lines with a path may be as wide as that asks for. */
static void expect_narrow(size_t most)
{
    for (const char *line = output; *line != '\0'; line += line[0] == '\n') {
        const size_t length = strcspn(line, "\n");
        size_t width = 0;
        for (size_t i = 0; i < length; ++i) {
            width += ((unsigned char)line[i] & 0xC0) != 0x80;
        }
        const char *path = strstr(line, BUILD_DIR "/");
        ck_assert_msg(width <= most || (path != NULL && path < line + length),
                      "%zu characters: %.*s", width, (int)length, line);
        line += length;
    }
}

START_TEST(help_leaves_room_for_the_margin_of_a_manual_page)
{
    static const char *const verbs[]
        = { "",         "run",         "resume", "batch", "check",  "steppers",
            "fabrics",  "scene-help",  "view",   "diff",  "export", "compare",
            "converge", "plugin-test", "new",    "lab" };
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; ++i) {
        expect(shell(WEFT " %s --help", verbs[i]), 0);
        says("usage: weft ");
        expect_narrow(75);
    }
}
END_TEST

START_TEST(lists_are_at_most_80_characters_wide)
{
    static const char *const verbs[]
        = { "scene-help",
            "scene-help cloth.springs.stretch.stiffness",
            "steppers",
            "fabrics",
            "plugin-test --all " BUILD_DIR "/plugins/weft-verlet.so",
            "plugin-test --all " BUILD_DIR "/tests/promises/weft-spoils.so || :" };
    expect(shell(WEFT " %s", verbs[_i]), 0);
    expect_narrow(80);
}
END_TEST

START_TEST(fabrics_are_listed_and_described)
{
    expect(shell(WEFT " fabrics --yaml"), 0);
    says("- name: \"11oz-black-denim\"\n  density: 0.324\n  stretch_warp: 411\n");
    says("  sample: \"jeans, 99 % cotton, 1 % spandex\"\n");
    ck_assert_ptr_null(strstr(output, "sample: \"\"")); /* each preset has one */
    expect(shell(WEFT " fabrics --markdown"), 0);
    says("| `11oz-black-denim` | 0.324 | 411, 2028 | 53.4 | 24.3, 16.0 | 16.4 |");
    expect(shell(WEFT " check scenes/cantilever.yaml"), 0);
    says("  fabric     11oz-black-denim: stretch springs ");
    says("C11 411, C22 2028, C12 = G 53.4 N/m");
    says("Peirce length 19.7 mm along columns, 17.1 mm along rows\n  advice  ");
    expect_narrow(80);
    expect(shell(WEFT " check --yaml scenes/cantilever.yaml"), 0);
    says("\n  fabric:\n    c11: ");
    says("\n    coarse: true\n");
    expect(shell(WEFT " check scenes/cantilever.yaml --set cloth.grid.cols=1"), 0);
    ck_assert_ptr_null(strstr(output, "rim")); /* a chain has none */
    expect(shell(WEFT " check " OUT "/small.yaml"), 0);
    ck_assert_ptr_null(strstr(output, "fabric"));
}
END_TEST

/* The strip of a KES sheet extends by the sheet's EMT; Peirce's test of a FAST sheet
 * has its bending length C, to the 2 % of his formula. */
START_TEST(laboratory_tests_of_a_scene_return_its_sheet)
{
    write_file(OUT "/kes.yaml",
               "weft: 1\ncloth:\n  grid: {rows: 3, cols: 3, spacing: 0.01}\n"
               "  fabric: {kes: {EMT: [4, 5], G: 0.7, B: 0.1, W: 18}}\n"
               "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 1}\n");
    write_file(OUT "/fast.yaml",
               "weft: 1\ncloth:\n  grid: {rows: 3, cols: 3, spacing: 0.01}\n"
               "  fabric: {fast: {E100: 2, EB5: 3, C: [18, 16], W: 180}}\n"
               "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 1}\n");
    const char *in_out = "cd " OUT " && $OLDPWD/" WEFT " lab ";
    expect(shell("%sstrip kes.yaml 2>&1", in_out), 0);
    says("EMT 4 % at 490 N/m");
    expect(shell("%scantilever fast.yaml 2>&1", in_out), 0);
    says("bending length is 18.");
    expect(
        shell("%sdrape fast.yaml --set cloth.cut.spacing=0.03 --set run.duration=0.3 "
              "2>&1",
              in_out),
        0);
    says("drape-fast.svg: the shadow");
    expect(shell("grep -c '<path' " OUT "/drape-fast.lab/drape-fast.svg"), 0);
    expect(shell("%sstrip kes.yaml --out named --yaml 2>&1", in_out), 0);
    says("test: strip\nfabric: \"kes\"\nscene: \"named/strip-kes.yaml\"\n"
         "extension: ");
    ck_assert_double_eq_tol(strtod(strstr(output, "extension: ") + 11, NULL), 4.0,
                            0.02);
    expect(shell("%sdrape small.yaml 2>&1", in_out), 3);
    says("small.yaml: its cloth has no fabric");
}
END_TEST

START_TEST(what_a_mesh_is_made_of_is_said)
{
    expect(shell(WEFT " check scenes/skirt.yaml"), 0);
    says("  pieces     2, sewn along 44 edges, 0.9 m\n");
    says("  angles     27.3 degrees or more at rest, in the triangle of vertices 14, ");
    says("  heights    9.18 mm or more at rest, in the triangle of vertices 14, 116, ");
    says("edges of 20.2 mm, 0.5698 m^2\n");
    says("  advice     edges of 20.2 mm are above a quarter of the Peirce length: "
         "too\n");
    ck_assert_ptr_null(strstr(output, "warning"));
    ck_assert_ptr_null(strstr(output, "cvode bdf is "));
    expect_narrow(80);
    says(", at rtol 0.001, atol 0.001 m and 1 m/s, arkode dormand_prince takes ");
    says("stiff ros2 takes the work of ");
    says("implicit methods do not pay");
}
END_TEST

START_TEST(what_is_said_of_a_scene_is_at_most_80_characters_wide)
{
    const char *scene = OUT "/small.yaml";
#ifdef HAVE_GSL
    scene = _i == 0 ? scene : "scenes/flag.yaml";
#endif
    expect(shell(WEFT " check --all --refine %s", scene), 0);
    says("  stability  omega <= ");
    expect_narrow(80);
    expect(shell(WEFT
                 " run %s --out " OUT "/run --set run.duration=0.2 --set "
                 "'name=a name of many words that goes on and on until it is wider "
                 "than a line' --set 'limit={method: provot}' 2>/dev/null",
                 scene),
           0);
    says("  strain     at most ");
    expect_narrow(80);
}
END_TEST

START_TEST(many_exported_frames_are_one_line)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet"), 0);
    expect(shell(WEFT " export " OUT "/r --format obj --frame all"), 0);
    ck_assert_str_eq(output, OUT "/r/frames/frame-000000.obj to frame-000010.obj, 11 "
                                 "files\n");
    expect(shell("ls " OUT "/r/frames | wc -l"), 0);
    ck_assert_int_eq(atoi(output), 11);
    expect(shell(WEFT " export " OUT "/r --format pvd"), 0);
    ck_assert_str_eq(output, OUT "/r/frames/frame-000000.vtp to frame-000010.vtp, 11 "
                                 "files\n" OUT "/r/run.pvd\n");
    expect(shell(WEFT " export " OUT "/r --format csv --frame 3"), 0);
    ck_assert_str_eq(output, OUT "/r/frames/frame-000003.csv\n");
    expect(shell("rm " OUT "/r/run.vtkhdf && " WEFT " export " OUT
                 "/r --format ply --frame all 2>/dev/null"),
           0);
    ck_assert_str_eq(output, OUT "/r/frames/frame-000000.ply to frame-000010.ply, 11 "
                                 "files\n");
}
END_TEST

START_TEST(help_on_a_key_prints_that_key_and_those_below_it)
{
    expect(shell(WEFT " scene-help stepper.rtol"), 0);
    ck_assert_str_eq(output, "stepper.rtol        number >= 0; default 1.0e-6\n"
                             "                    relative tolerance\n");
    expect(shell(WEFT " scene-help forces.wind"), 0);
    ck_assert_str_eq(
        output,
        "forces.wind         mapping; default no wind\n"
        "                    moving air\n"
        "  velocity          vector [x, y, z] [m/s]; required: velocity or table\n"
        "                    velocity of the air\n"
        "  table             list of rows [t, x, y, z], or their CSV file [s, m/s];\n"
        "                    required: velocity or table\n"
        "                    velocity at times: smooth, through all rows and between "
        "them\n"
        "                    within their range, constant before the first and after "
        "the\n"
        "                    last; or {rows: ..., spline: natural}\n"
        "    rows            list of rows [t, x, y, z], or their CSV file [s, m/s];\n"
        "                    required\n"
        "                    the table\n"
        "    spline          monotone or natural; default monotone\n"
        "                    natural: a natural cubic spline, for dense samples of a\n"
        "                    motion; it overshoots rows that are far apart\n"
        "  drag              number >= 0 [kg/(m^2 s)]; required\n"
        "                    F = drag * area * (n . (velocity - v)) n\n");
    expect(shell(WEFT " scene-help cloth.pins.0.at.rows 'cloth.loads[].mass'"), 0);
    ck_assert_str_eq(output,
                     "cloth.pins.0.at.rows\n"
                     "                    index, [first, last] or all; required: rows "
                     "or row\n"
                     "                    row 0 is the top; negative counts from the "
                     "end\n"
                     "cloth.loads[].mass  number > 0 [kg]; required\n"
                     "                    added to each of these particles\n");
}
END_TEST

START_TEST(help_on_a_key_that_is_not_there_names_those_that_are)
{
    static const char *const wrong[][2] = {
        { "stepper.rtoll", "unknown key 'rtoll' in stepper (did you mean 'rtol'?)\n" },
        { "run.speed", "unknown key 'speed' in run; run has duration, fps, threads, "
                       "frames, checkpoint, keep_checkpoint\n" },
        { "drag",
          "unknown key 'drag' in the scene (it is a key of forces.wind); the " },
        { "run.fps.x", "unknown key 'x' in fps; it has no keys\n" },
        { "''", "unknown key '' in the scene; the scene has " },
        { "run --markdown", "--markdown prints all keys\n" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        expect(shell(WEFT " scene-help %s 2>&1", wrong[i][0]), 2);
        says(wrong[i][1]);
    }
}
END_TEST

START_TEST(runs_of_a_sweep_over_methods_have_readable_names)
{
    expect(shell("echo 'sweep: {stepper.method: [verlet/euler, midpoint], "
                 "stepper.fixed_step: [1.0e-3, 5.0e-4]}' >> " OUT "/small.yaml && " WEFT
                 " batch " OUT "/small.yaml --set run.duration=0.05 --quiet --out " OUT
                 "/b"),
           0);
    expect(shell("ls " OUT "/b"), 0);
    ck_assert_str_eq(output, "small_method=midpoint_fixed_step=1.0e-3\n"
                             "small_method=midpoint_fixed_step=5.0e-4\n"
                             "small_method=verlet-euler_fixed_step=1.0e-3\n"
                             "small_method=verlet-euler_fixed_step=5.0e-4\n"
                             "summary.csv\n");
    expect(shell("cut -d, -f1-4 " OUT "/b/summary.csv"), 0);
    ck_assert_str_eq(output, "stepper.method,stepper.fixed_step,scene,status\n"
                             "verlet/euler,1.0e-3,small,done\n"
                             "verlet/euler,5.0e-4,small,done\n"
                             "midpoint,1.0e-3,small,done\n"
                             "midpoint,5.0e-4,small,done\n");
    expect(shell(WEFT " resume " OUT
                      "/b/small_method=verlet-euler_fixed_step=5.0e-4 2>&1"),
           0);
}
END_TEST

#define SOLVER_COLUMNS ",linear_iterations,factorisations,newton_failures\n"
#define ROS2           "'stepper={plugin: stiff, method: ros2, solver: {krylov: 0.05}}'"

START_TEST(counts_of_linear_systems_are_in_all_files_of_methods_that_have_some)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/explicit 2>&1"), 0);
    ck_assert_ptr_null(strstr(output, "Jacobians"));
    ck_assert_ptr_null(
        strstr(read_file(OUT "/explicit/series.csv"), "newton_failures"));
    ck_assert_ptr_null(strstr(read_file(OUT "/explicit/result.yaml"), "solver:\n"));
    expect(shell(WEFT " run " OUT "/small.yaml --set " ROS2 " --out " OUT
                      "/implicit 2>&1"),
           0);
    says("  solver     ");
    says(" Jacobians, ");
    ck_assert_ptr_nonnull(
        strstr(read_file(OUT "/implicit/series.csv"), SOLVER_COLUMNS));
    ck_assert_ptr_nonnull(
        strstr(read_file(OUT "/implicit/manifest.yaml"), "    krylov: 0.05"));
    unsigned long long iterations = 0, jacobians = 0;
    const char *at = strstr(read_file(OUT "/implicit/result.yaml"), "solver:\n");
    ck_assert_ptr_nonnull(at);
    ck_assert_int_eq(sscanf(at,
                            "solver:\n linear_iterations: %llu\n factorisations: %llu",
                            &iterations, &jacobians),
                     2);
    char last[80];
    (void)snprintf(last, sizeof last, ",%llu,%llu,0\n", iterations, jacobians);
    ck_assert(iterations > jacobians && jacobians > 0);
    const char *series = read_file(OUT "/implicit/series.csv");
    ck_assert_str_eq(series + strlen(series) - strlen(last), last);
}
END_TEST

/* Frames at multiples of 50 ms, and the end. */
START_TEST(a_run_may_end_at_a_moment_of_its_own)
{
    expect(shell(WEFT " run " OUT "/small.yaml --set 'stop={when: max_strain > 0.05}' "
                      "--set run.duration=5 --set record.every=7 --set run.frames=%s "
                      "--out " OUT "/stop 2>&1",
                 _i == 0 ? "step" : "interpolate"),
           0);
    says("done by stop: max_strain > 0.05: small");
    const char *result = read_file(OUT "/stop/result.yaml");
    ck_assert_ptr_nonnull(
        strstr(result, "status: done\nreason: \"stop: max_strain > 0.05\""));
    double t = 0.0, strain = 0.0, before = 0.0;
    size_t rows = 0, frames = 0;
    for (const char *row = strchr(read_file(OUT "/stop/series.csv"), '\n') + 1;
         *row != '\0'; row = strchr(row, '\n') + 1, ++rows) {
        before = t;
        ck_assert_int_eq(sscanf(row, "%zu,%lf,%*f,%*f,%*f,%*[^0-9]%*f,%*f,%*f,%lf",
                                &frames, &t, &strain),
                         3);
    }
    ck_assert_uint_eq(frames + 1, rows);
    ck_assert(t > before && t <= before + 0.05 && t < 5.0);
    ck_assert_double_eq_tol(strain, 0.05, 1e-8);
    expect(shell(WEFT " export " OUT "/stop --format csv 2>&1"), 0);
    expect(shell(WEFT " resume " OUT "/stop 2>&1"), 0);
    says("already done");
}
END_TEST

/* Its energies in the rows of the last 0.5 s, and in one before. */
START_TEST(a_run_may_end_when_the_cloth_is_at_rest)
{
    expect(shell(WEFT " run " OUT "/small.yaml --set 'stop={at_rest: 1e-4}' --set "
                      "'cloth.pins=[top]' --set run.duration=60 --set "
                      "forces.damping=0.02 --set cloth.grid.down='[0, 0, 1]' --out " OUT
                      "/rest 2>&1"),
           0);
    says("done by stop: at_rest < 0.0001 for 0.5 s: small");
    expect(shell("awk -F, 'NR == 2 { start = $5 } NR > 1 { t[NR] = $2; part[NR] = $3 / "
                 "(start - $5 + 1e-99) } END { for (i = 3; i <= NR; ++i) if (t[i] >= "
                 "t[NR] - 0.5) { ++n; bad += part[i] > 1e-4 } else moved = moved || "
                 "part[i] > 1e-4; print n, bad, moved, t[NR] < 60 }' " OUT
                 "/rest/series.csv"),
           0);
    ck_assert_str_eq(strchr(output, ' '), " 0 1 1\n");
    expect(shell(WEFT " run " OUT "/small.yaml --set 'stop={at_rest: true}' --set "
                      "forces.gravity='[0, 0, 0]' --out " OUT "/rest 2>&1"),
           3);
    says("stop.at_rest compares with the work of gravity, and forces.gravity is 0");
}
END_TEST

TEST_SUITE(cli_output)
{
    Suite *suite = suite_create("cli output");
    TCase *program = tcase_create("output");
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_set_timeout(program, 120.0);
    tcase_add_test(program, help_leaves_room_for_the_margin_of_a_manual_page);
    tcase_add_loop_test(program, lists_are_at_most_80_characters_wide, 0, 6);
    tcase_add_test(program, fabrics_are_listed_and_described);
    tcase_add_test(program, laboratory_tests_of_a_scene_return_its_sheet);
    tcase_add_test(program, what_a_mesh_is_made_of_is_said);
    tcase_add_loop_test(program, what_is_said_of_a_scene_is_at_most_80_characters_wide,
                        0, 2);
    tcase_add_test(program, many_exported_frames_are_one_line);
    tcase_add_test(program, help_on_a_key_prints_that_key_and_those_below_it);
    tcase_add_test(program, help_on_a_key_that_is_not_there_names_those_that_are);
    tcase_add_test(program, runs_of_a_sweep_over_methods_have_readable_names);
    tcase_add_test(program,
                   counts_of_linear_systems_are_in_all_files_of_methods_that_have_some);
    suite_add_tcase(suite, program);
    tcase_add_loop_test(program, a_run_may_end_at_a_moment_of_its_own, 0, 2);
    tcase_add_test(program, a_run_may_end_when_the_cloth_is_at_rest);
    return suite;
}
