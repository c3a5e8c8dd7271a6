/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* weft converge: orders of results that are known, places on refined grids, and command
 * lines that it refuses. */
#include "shell.h"

#include <math.h>

#define OUT BUILD_DIR "/converge"

/* A taut sheet held along its rim, that gravity loads across. It comes to rest in air
 * that damps it: a Poisson problem, whose five-point formula has order 2. */
static const char membrane[]
    = "weft: 1\n"
      "name: membrane\n"
      "cloth:\n"
      "  grid: {rows: 9, cols: 9, spacing: 0.125, scale: 1.2, down: [0, 0, 1]}\n"
      "  density: 0.2\n"
      "  springs: {stretch: {stiffness: 60}}\n"
      "  pins: [top, bottom, left, right]\n"
      "forces: {wind: {velocity: [0, 0, 0], drag: 10}}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 1, fps: 1}\n";

/* Stretched by a tenth, every particle pinned. Of 2 n (n - 1) springs each has the
 * energy 60 (0.1 / (n - 1))^2 / 2 [J]. */
static const char stretched[]
    = "weft: 1\n"
      "name: stretched\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 5, spacing: 0.25, scale: 1.1}\n"
      "  density: 0.2\n"
      "  springs: {stretch: {stiffness: 60}}\n"
      "  pins: [{rows: [0, -1], cols: all}]\n"
      "forces: {gravity: [0, 0, 0]}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 1.0e-2, fps: 100}\n";

/* A strip without forces, along z, clamped between its first two rows. */
static const char strip[]
    = "weft: 1\n"
      "name: strip\n"
      "cloth:\n"
      "  grid: {rows: 9, cols: 3, spacing: [0.125, 0.5], origin: [1, 2, 3], down: [0, "
      "0, 5]}\n"
      "  density: 0.2\n"
      "  springs: {stretch: {stiffness: 60}}\n"
      "  loads: [{at: [-1, 0], mass: 0.1}]\n"
      "  pins: [top, {row: 1, cols: all}]\n"
      "forces: {gravity: [0, 0, 0]}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 1.0e-2, fps: 100}\n";

/* Overhangs by 0.1 m, twice its Peirce length, and comes to rest in still air. */
static const char cantilever[]
    = "weft: 1\n"
      "name: strip\n"
      "cloth:\n"
      "  grid: {rows: 14, cols: 1, spacing: 8.0e-3, origin: [-4.0e-3, 0, 0], down: [1, "
      "0, 0], right: [0, 0, 1]}\n"
      "  fabric: {density: 0.2, stretch: 1.0e+5, bend: 2.4525e-4}\n"
      "  pins: [{rows: [0, 1], cols: all}]\n"
      "forces:\n"
      "  wind: {velocity: [0, 0, 0], drag: 5}\n"
      "stepper: {plugin: stiff, method: backward_euler, fixed_step: 0.05}\n"
      "run: {duration: 20, fps: 1}\n";

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/membrane.yaml", membrane);
    write_file(OUT "/stretched.yaml", stretched);
    write_file(OUT "/strip.yaml", strip);
    write_file(OUT "/cantilever.yaml", cantilever);
}

static void converge(const char *arguments, int code)
{
    expect(shell("cd " OUT " && ../weft converge %s 2>&1", arguments), code);
}

typedef struct csv_row {
    unsigned size, rows, cols;
    double spacing, value, difference, order, limit; /* NAN: empty */
} csv_row;

static double read_cell(const char **line)
{
    char *end;
    const double value = strtod(*line, &end);
    const bool empty = end == *line;
    *line = end + (*end == ',');
    return empty ? (double)NAN : value;
}

/* The row of a quantity and a size in the CSV printed. */
static csv_row row_of(const char *quantity, unsigned size)
{
    char start[80];
    (void)snprintf(start, sizeof start, "\n\"%s\",%u,", quantity, size);
    const char *line = strstr(output, start);
    ck_assert_msg(line != NULL, "no row '%s' in:\n%s", start + 1, output);
    line += strlen(start);
    csv_row row = { .size = size };
    row.rows = (unsigned)read_cell(&line);
    row.cols = (unsigned)read_cell(&line);
    row.spacing = read_cell(&line);
    row.value = read_cell(&line);
    row.difference = read_cell(&line);
    row.order = read_cell(&line);
    row.limit = read_cell(&line);
    return row;
}

static void expect_near(double value, double wanted, double tolerance)
{
    ck_assert_msg(fabs(value - wanted) <= tolerance, "%.17g is not %.17g\n%s", value,
                  wanted, output);
}

START_TEST(the_sag_of_a_membrane_converges_with_order_2)
{
    converge("membrane.yaml --sizes 9,17,33 --at middle.y --csv --quiet -j 2", 0);
    const csv_row coarse = row_of("middle.y", 17), fine = row_of("middle.y", 33);
    expect_near(fine.order, 2.0, 0.05);
    ck_assert(isnan(coarse.order) && isnan(coarse.limit));
    expect_near(fine.difference, fine.value - coarse.value, 1e-15);
    ck_assert_double_lt(fine.limit, fine.value);
}
END_TEST

/* 0.6 (1 + 1 / (n - 1)), also with ratios that are not 2. */
START_TEST(the_energy_of_a_rim_converges_with_order_1)
{
    converge("stretched.yaml --sizes 3,5,8,33 --at elastic --csv --quiet", 0);
    ck_assert(isnan(row_of("elastic", 3).difference));
    expect_near(row_of("elastic", 8).value, 0.6 * 8.0 / 7.0, 1e-12);
    expect_near(row_of("elastic", 8).order, 1.0, 1e-6);
    expect_near(row_of("elastic", 33).order, 1.0, 1e-6);
    expect_near(row_of("elastic", 33).limit, 0.6, 1e-6);
    expect_near(row_of("elastic", 33).spacing, 1.0 / 32.0, 1e-15);
}
END_TEST

START_TEST(a_value_of_every_grid_has_no_order)
{
    converge("stretched.yaml --sizes 3,5,9 --quiet", 0);
    says("tip.x\n    particles    spacing            value  difference  order     "
         "extrapolated\n");
    says("        9 x 9      0.125             0.55   0.000e+00      -                "
         "-\n");
    says("tip.y\n");
    says("tip.z\n");
}
END_TEST

/* Extents, ratio, pins, loads and particles stay in place; so does the clamp. */
START_TEST(a_clamp_stays_midway_between_two_lines)
{
    converge("strip.yaml --sizes 9,17,33 --clamp-midway --at 1,0.z --at -1,1.z --at "
             "tip.x --at -1,0.y --csv --quiet",
             0);
    const csv_row line = row_of("1,0.z", 33), tip = row_of("-1,1.z", 33);
    ck_assert_uint_eq(tip.rows, 33);
    ck_assert_uint_eq(tip.cols, 9);
    expect_near(tip.value, 4.0, 1e-12);
    expect_near(tip.spacing, 7.5 * 0.125 / 31.5, 1e-15);
    expect_near(row_of("tip.x", 9).value, 1.5, 1e-12);
    expect_near(line.value - 0.5 * line.spacing, 3.0625, 1e-12);
    expect_near(line.order, 1.0, 1e-6);
    expect_near(row_of("-1,0.y", 33).value, 2.0, 1e-12);
    converge("strip.yaml --sizes 9,17 --at tip.z", 0);
}
END_TEST

/* To the heavy elastica. */
START_TEST(the_tip_of_a_cantilever_converges_with_order_2)
{
    converge("cantilever.yaml --sizes 9,17,33,65 --clamp-midway --csv --quiet", 0);
    expect_near(row_of("tip.x", 65).order, 2.0, 0.05);
    expect_near(row_of("tip.y", 65).order, 2.0, 0.05);
    expect_near(row_of("tip.x", 65).limit, 0.07244247341, 1e-8);
    expect_near(row_of("tip.y", 65).limit, -0.06406307174, 1e-8);
}
END_TEST

/* Each size is the run of the scene that weft run makes, bit for bit. */
START_TEST(a_run_is_that_of_weft_run)
{
    converge("stretched.yaml --sizes 5,9 --at elastic --at hash --at kinetic --csv "
             "--quiet --set 'cloth.pins=[top]'",
             0);
    const csv_row energy = row_of("elastic", 9), motion = row_of("kinetic", 9);
    expect(shell("cd " OUT " && ../weft run stretched.yaml --out r --quiet --set "
                 "cloth.grid.rows=9 --set cloth.grid.cols=9 --set "
                 "cloth.grid.spacing=0.125 --set 'cloth.pins=[top]' && tail -n 1 "
                 "r/series.csv | cut -d, -f3,4"),
           0);
    const char *cell = output;
    ck_assert_double_eq(read_cell(&cell), motion.value);
    ck_assert_double_eq(read_cell(&cell), energy.value);
}
END_TEST

static const struct {
    const char *arguments, *message;
} refused[] = {
    { "strip.yaml", "--sizes needs 2 to 16 increasing numbers from 2 to 1000000, as "
                    "--sizes 9,17,33" },
    { "strip.yaml --sizes 9", "--sizes needs 2 to 16 increasing numbers" },
    { "strip.yaml --sizes 9,9", "--sizes needs 2 to 16 increasing numbers" },
    { "strip.yaml --sizes 9,x", "--sizes needs 2 to 16 increasing numbers" },
    { "strip.yaml --sizes 9,1000001", "--sizes needs 2 to 16 increasing numbers" },
    { "strip.yaml --sizes 9,11 --at tip.z",
      "--sizes: 11 does not keep the ratio of rows to columns; these do: 9, 17, 25, "
      "33" },
    { "stretched.yaml --sizes 3,5 --at 1,0",
      "--sizes: 3 does not keep the particle 1,0; these do: 5, 9, 13, 17" },
    { "stretched.yaml --sizes 3,33,65 --at 1,0",
      "--sizes: 3 does not keep the particle 1,0; these do: 5, 9, 13, 17, 33, 65" },
    { "stretched.yaml --sizes 3,5 --at 0,0 --set 'cloth.pins=[top, [1, 2]]'",
      "--sizes: 3 does not keep the place of cloth.pins.1; these do: 5, 9, 13, 17" },
    { "stretched.yaml --sizes 3,5 --set 'cloth.loads=[{at: [0, -2], mass: 1}]'",
      "--sizes: 3 does not keep the place of cloth.loads.0; these do: 5, 9, 13, 17" },
    { "membrane.yaml --sizes 9,17 --at max_strian",
      "--at max_strian is no column of series.csv and no particle of 9 x 9 (did you "
      "mean 'max_strain'?)" },
    { "membrane.yaml --sizes 9,17 --at 9,0", "no particle of 9 x 9" },
    { "membrane.yaml --sizes 9,17 --at -10,0", "no particle of 9 x 9" },
    { "membrane.yaml --sizes 9,17 --clamp-midway",
      "--clamp-midway: no pins hold exactly the first two rows or columns" },
};

START_TEST(wrong_command_lines_are_refused)
{
    converge(refused[_i].arguments, 2);
    says(refused[_i].message);
}
END_TEST

/* The other sizes have their values. */
START_TEST(a_run_that_fails_names_its_size)
{
    converge("membrane.yaml --sizes 9,17,65 --at middle.y --set run.duration=0.3", 1);
    says("weft: warning: size 65: stepper.fixed_step is beyond the largest stable "
         "step\n");
    says("weft: error: size 65: not finite");
    says("      65 x 65   0.015625                -           -      -                "
         "-\n");
    says("      17 x 17     0.0625");
}
END_TEST

START_TEST(values_per_particle_are_a_warning)
{
    converge("stretched.yaml --sizes 5,9 --set cloth.mass=1 --set cloth.density=null "
             "--set forces.damping=1 --set 'cloth.loads=[{at: {row: 0, cols: [0, 4]}, "
             "mass: 1}]'",
             0);
    says("weft: warning: the mass of cloth.loads is the same for each particle");
    says("weft: warning: cloth.mass is the same for each particle, so its effect "
         "depends on the size\n");
    says("weft: warning: forces.damping is the same for each particle");
    converge("stretched.yaml --sizes 5,9 --set cloth.springs.law=strain", 0);
    says(
        "weft: warning: cloth.springs of a sheet with law: strain is the same for each "
        "spring");
    converge("stretched.yaml --sizes 5,9 --set cloth.grid.rows=1 --at 0,0 --set "
             "cloth.springs.law=hooke --set 'cloth.pins=[[0, 0]]'",
             0);
    says("weft: warning: cloth.springs.stretch of a chain with law: hooke is the same "
         "for each spring");
    converge("membrane.yaml --sizes 9,17 --quiet", 0);
    ck_assert_ptr_null(strstr(output, "warning"));
}
END_TEST

START_TEST(warnings_of_the_scene_appear_once)
{
    converge("stretched.yaml --sizes 5,9", 0);
    const char *warning = strstr(output, "all 25 particles are pinned");
    ck_assert_ptr_nonnull(warning);
    ck_assert_ptr_null(strstr(warning + 1, "all 25 particles"));
}
END_TEST

/* Before the first run. */
START_TEST(a_size_beyond_the_memory_is_refused)
{
    converge("stretched.yaml --sizes 5,999999", 1);
    says("weft: error: size 999999: 999999 x 999999 particles need at least ");
    ck_assert_ptr_null(strstr(output, "tip.x"));
}
END_TEST

START_TEST(wrong_scenes_have_their_exit_codes)
{
    converge("membrane.yaml --sizes 9,17 --set 'sweep={cloth.density: [1, 2]}'", 3);
    says("sweep makes 2 runs of this scene: 'weft batch' runs them");
    converge("membrane.yaml --sizes 9,17 --set cloth.density=-1", 3);
    converge("none.yaml --sizes 9,17", 4);
}
END_TEST

TEST_SUITE(converge)
{
    Suite *suite = suite_create("converge");
    TCase *program = tcase_create("program");
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_add_test(program, the_sag_of_a_membrane_converges_with_order_2);
    tcase_add_test(program, the_energy_of_a_rim_converges_with_order_1);
    tcase_add_test(program, a_value_of_every_grid_has_no_order);
    tcase_add_test(program, a_clamp_stays_midway_between_two_lines);
    tcase_add_test(program, the_tip_of_a_cantilever_converges_with_order_2);
    tcase_add_test(program, a_run_is_that_of_weft_run);
    tcase_add_loop_test(program, wrong_command_lines_are_refused, 0,
                        sizeof refused / sizeof refused[0]);
    tcase_add_test(program, a_run_that_fails_names_its_size);
    tcase_add_test(program, values_per_particle_are_a_warning);
    tcase_add_test(program, warnings_of_the_scene_appear_once);
    tcase_add_test(program, a_size_beyond_the_memory_is_refused);
    tcase_add_test(program, wrong_scenes_have_their_exit_codes);
    suite_add_tcase(suite, program);
    return suite;
}
