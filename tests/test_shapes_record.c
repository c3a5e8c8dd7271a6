/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* What a run with shapes leaves: columns of series.csv, shapes.csv, exports, the data
 * of a page. Resumed runs are in test_cli_resume.c. */
#include <math.h>
#include <stdlib.h>

#include "program/record/export/export.h"
#include "shell.h"

#define OUT BUILD_DIR "/shapes"

enum { SHAPES = 4, LAST = 10, POINTS = RECORD_SHAPE_ROWS * RECORD_SHAPE_COLS };

static const char scene[]
    = "weft: 1\n"
      "name: shapes\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 6, spacing: 0.1, origin: [-0.2, 0.2, -0.2], right: [1, "
      "0, "
      "0], down: [0, 0, 1]}\n"
      "  density: 0.3\n"
      "  springs: {stretch: {stiffness: 50, damping: 0.02}, shear: {stiffness: 20}}\n"
      "contact:\n"
      "  thickness: 0.02\n"
      "  friction: 0\n"
      "  shapes:\n"
      "    - {shape: plane, at: [0, -0.1, 0], normal: [0.1, 2, 0.3], velocity: [0, "
      "0.1, "
      "0], turn: {axis: [1, 0, 1], rate: -0.1}}\n"
      "    - {shape: sphere, at: [0.05, 0.05, 0], radius: 0.1, spin: [0, 1, 0]}\n"
      "    - {shape: capsule, from: [-0.3, 0, 0], to: [-0.2, 0.02, 0.2], radius: 0.08, "
      "amplitude: [0, 0.02, 0], frequency: 1, turn: {axis: [0, 1, 2], rate: 0.3}}\n"
      "    - {shape: box, at: [0.3, 0, 0.2], half: [0.1, 0.1, 0.05], rounding: 0.03, "
      "turn: {axis: [1, 2, 0], about: [0.2, 0, 0.2], amplitude: 0.4, frequency: 2}}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 2.0e-4}\n"
      "record: {ledger: true}\n"
      "run: {duration: 0.5, fps: 20}\n";

static weft_scene *loaded;
static weft_cloth *cloth;
static weft_error err;

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/s.yaml", scene);
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/r 2>&1"), 0);
    loaded = record_scene(OUT "/r");
    ck_assert_ptr_nonnull(loaded);
    ck_assert_int_eq(weft_cloth_create(weft_scene_cloth(loaded), &cloth, &err),
                     WEFT_OK);
}

static void end(void)
{
    weft_cloth_destroy(cloth);
    weft_scene_destroy(loaded);
}

/* ---- tables -------------------------------------------------------------------- */

static weft_sim *simulate(void)
{
    return test_sim(cloth, test_method_named("verlet/velocity_verlet"),
                    weft_scene_config(loaded));
}

START_TEST(rows_have_the_loads_of_their_shapes)
{
    weft_sim *sim = simulate();
    const char *row = strchr(read_file(OUT "/r/shapes.csv"), '\n');
    double most = 0.0;
    for (size_t i = 0; i <= LAST; ++i) {
        ck_assert_int_eq(weft_sim_advance(sim, (double)i / 20.0, &err), WEFT_OK);
        for (size_t k = 0; k < SHAPES; ++k) {
            size_t frame, shape;
            double found[7], load[6];
            ck_assert_int_eq(sscanf(row, "\n%zu,%lf,%zu,%lf,%lf,%lf,%lf,%lf,%lf",
                                    &frame, &found[0], &shape, &found[1], &found[2],
                                    &found[3], &found[4], &found[5], &found[6]),
                             9);
            weft_cloth_shape_load(cloth, weft_sim_time(sim), weft_sim_state(sim), k,
                                  load, load + 3);
            ck_assert(frame == i && shape == k && found[0] == (double)i / 20.0);
            ck_assert_mem_eq(found + 1, load, sizeof load);
            most = fmax(most, fabs(load[1]));
            row = strchr(row + 1, '\n');
        }
    }
    ck_assert_str_eq(row, "\n");
    ck_assert(most > 0.01);
    weft_sim_destroy(sim);
}
END_TEST

START_TEST(series_has_the_measures_of_contact)
{
    weft_sim *sim = simulate();
    for (size_t i = 0; i <= LAST; ++i) { /* steps end at frames */
        ck_assert_int_eq(weft_sim_advance(sim, (double)i / 20.0, &err), WEFT_OK);
    }
    const weft_measures all = weft_sim_measure(sim);
    expect(shell("tail -1 " OUT "/r/series.csv | cut -d, -f27-29"), 0);
    char wanted[128];
    (void)snprintf(wanted, sizeof wanted, "%.17g,%.17g,%zu\n", all.energy.contact,
                   all.gap, all.touching);
    ck_assert_str_eq(output, wanted);
    ck_assert_uint_gt(all.touching, 0);
    expect(shell("head -1 " OUT "/r/series.csv | cut -d, -f27-"), 0);
    ck_assert_str_eq(output, "contact,min_gap,touching,vetoed,dissipated_contact,"
                             "dissipated_friction,shape_work\n");
    expect(shell("sed -n '/^contact:/,/^limit/p' " OUT "/r/result.yaml"), 0);
    (void)snprintf(wanted, sizeof wanted, "touching: %zu\n", all.touching);
    says(wanted);
    weft_sim_destroy(sim);
}
END_TEST

START_TEST(a_run_with_shapes_sums_them_up)
{
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/t --progress none 2>&1"), 0);
    says("contact    4 shapes, ");
    says(", of shapes ");
    says("series.csv shapes.csv");
    expect(shell("cmp " OUT "/r/shapes.csv " OUT "/t/shapes.csv 2>&1"), 0);
    expect(shell(WEFT " diff " OUT "/r " OUT "/t 2>&1"), 0);
}
END_TEST

/* The towel, in as few steps as its end needs. */
START_TEST(a_run_with_self_contact_has_its_gap)
{
    expect(shell(WEFT " run scenes/towel.yaml --out " OUT "/towel --set "
                      "contact.friction=0 --set 'stepper={plugin: verlet, method: "
                      "velocity_verlet, fixed_step: 2.0e-4}' 2>&1"),
           0);
    says(" pairs of the cloth's own parts touch and the smallest gap is ");
    expect(shell("head -1 " OUT "/towel/series.csv | cut -d, -f22-"), 0);
    ck_assert_str_eq(output, "self_gap,self_touching\n");
    expect(shell("sed -n 2p " OUT "/towel/series.csv | cut -d, -f22-"), 0);
    ck_assert_str_eq(output, "inf,0\n");
    expect(shell("tail -1 " OUT "/towel/series.csv | cut -d, -f22-"), 0);
    double gap, same;
    size_t touching, as_many;
    ck_assert_int_eq(sscanf(output, "%lf,%zu", &gap, &touching), 2);
    ck_assert(gap > 1e-3 && gap < 8e-3 && touching > 100);
    expect(shell("sed -n 's/^  self_[a-z]*: //p' " OUT "/towel/result.yaml"), 0);
    ck_assert_int_eq(sscanf(output, "%lf %zu", &same, &as_many), 2);
    ck_assert_double_eq(same, gap);
    ck_assert_uint_eq(as_many, touching);
    expect(shell("cat " OUT "/towel/manifest.yaml"), 0);
    says("self: true\n");
}
END_TEST

/* ---- surfaces ------------------------------------------------------------------ */

/* Of shape k alone, at a point. */
static double gap_at(const weft_shape *shape, double t, const double x[3])
{
    weft_cloth_def def = weft_cloth_def_default();
    double y[24] = { 0 };
    for (size_t k = 0; k < 3; ++k) {
        def.origin[k] = shape->kind == WEFT_PLANE ? 100.0 * shape->normal[k] : 100.0;
        for (size_t i = 0; i < 4; ++i) {
            y[4 * k + i] = x[k];
        }
    }
    def.contact.shapes = shape;
    def.contact.shape_count = 1;
    weft_cloth *made = test_cloth(&def);
    const double gap = weft_cloth_gap(made, t, y, NULL, NULL);
    weft_cloth_destroy(made);
    return gap;
}

START_TEST(surfaces_are_where_the_gap_is_0)
{
    static double x[3 * POINTS];
    const double t = 0.3;
    const weft_cloth_def *def = weft_scene_cloth(loaded);
    const record_surface found = record_shape_surface(def, (size_t)_i, t, x);
    ck_assert_uint_eq(found.faces.rows * found.faces.cols,
                      _i == WEFT_PLANE ? 4 : POINTS);
    for (size_t i = 0; i < found.faces.rows * found.faces.cols; ++i) {
        const double gap = gap_at(&def->contact.shapes[_i], t, x + 3 * i);
        ck_assert_double_eq_tol(gap, 0.0, 1e-14);
    }
}
END_TEST

/* ---- exports ------------------------------------------------------------------- */

/* Lines of a file that begin with `text` and a blank. */
static int count(const char *file, const char *text)
{
    (void)shell("grep -c '^%s ' " OUT "/r/%s 2>&1", text, file);
    return atoi(output);
}

START_TEST(every_format_but_csv_has_the_shapes)
{
    expect(shell(WEFT " export " OUT "/r --format obj 2>&1"), 0);
    says("r/final-shape-3.obj\n");
    ck_assert_int_eq(count("final-shape-0.obj", "v"), 4);
    ck_assert_int_eq(count("final-shape-0.obj", "f"), 1);
    ck_assert_int_eq(count("final-shape-3.obj", "v"), POINTS);
    ck_assert_int_eq(count("final-shape-3.obj", "f"),
                     (RECORD_SHAPE_ROWS - 1) * (RECORD_SHAPE_COLS - 1));
    expect(shell(WEFT " export " OUT "/r --format ply --frame all 2>&1"), 0);
    says("frame-000000-shape-1.ply to frame-000010-shape-1.ply, 11 files\n");
    expect(shell("ls " OUT "/r/frames | wc -l"), 0);
    ck_assert_int_eq(atoi(output), (LAST + 1) * (SHAPES + 1));
    expect(shell(WEFT " export " OUT "/r --format pvd 2>&1; grep -c DataSet " OUT
                      "/r/run.pvd; grep -c 'part=\"4\".*shape-3.vtp' " OUT
                      "/r/run.pvd"),
           0);
    says("run.pvd\n55\n11\n");
    expect(shell(WEFT " export " OUT "/r --format pc2 2>&1; wc -c < " OUT
                      "/r/run-shape-2.pc2"),
           0);
    says("r/rest-shape-2.obj\n");
    char size[32];
    (void)snprintf(size, sizeof size, "\n%d\n", 32 + 12 * POINTS * (LAST + 1));
    says(size);
    expect(shell(WEFT " export " OUT "/r --format csv --frame 3 2>&1; ls " OUT
                      "/r/frames/*.csv | wc -l"),
           0);
    says("\n1\n");
}
END_TEST

START_TEST(exported_shapes_move)
{
    double first, last;
    expect(shell(WEFT " export " OUT "/r --format obj --frame all 2>&1"), 0);
    expect(shell("sed -n 2p " OUT "/r/frames/frame-000000-shape-0.obj"), 0);
    ck_assert_int_eq(sscanf(output, "v %*f %lf", &first), 1);
    expect(shell("sed -n 2p " OUT "/r/frames/frame-000010-shape-0.obj"), 0);
    ck_assert_int_eq(sscanf(output, "v %*f %lf", &last), 1);
    ck_assert(last > first + 0.045); /* along its normal: 0.05 m n_y^2 */
}
END_TEST

START_TEST(force_removes_exported_shapes_and_nothing_else)
{
    for (const char *const *format = (const char *const[]){ "obj", "pvd", "mdd", NULL };
         *format != NULL; ++format) {
        expect(shell(WEFT " export " OUT "/r --format %s 2>&1", *format), 0);
    }
    write_file(OUT "/r/my-shape-1.obj", "mine");
    write_file(OUT "/r/frames/final-shape-x.obj", "mine");
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/r --force --quiet 2>&1"), 0);
    expect(shell("ls " OUT "/r " OUT "/r/frames | grep -c shape-"), 0);
    ck_assert_int_eq(atoi(output), 2);
}
END_TEST

START_TEST(without_its_scene_a_run_is_exported_without_shapes)
{
    expect(
        shell("rm " OUT "/r/scene.yaml; " WEFT " export " OUT "/r --format obj 2>&1"),
        0);
    says("scene.yaml cannot be read: shapes, if there are any, are left out");
    ck_assert(exists(OUT "/r/final.obj") && !exists(OUT "/r/final-shape-0.obj"));
}
END_TEST

START_TEST(a_page_has_the_shapes)
{
    expect(shell(WEFT " view " OUT "/r > /dev/null; grep -o "
                      "'\"thickness\":.*\"scene\"' " OUT "/r/run.html"),
           0);
    says("\"thickness\":0.02,\"self\":false,\"obstacles\":[{\"shape\":\"plane\",\"at\":"
         "[0,-0."
         "10000000000000001,0]");
    says("{\"shape\":\"capsule\",\"at\":[-0.29999999999999999,0,0],\"to\":[-0."
         "20000000000000001,");
    says("\"rounding\":0.029999999999999999,\"velocity\":[0,0,0],");
}
END_TEST

TEST_SUITE(shapes_record)
{
    Suite *all = suite_create("shapes record");
    TCase *run = tcase_create("run");
    tcase_add_checked_fixture(run, begin, end);
    tcase_set_timeout(run, 60);
    tcase_add_test(run, rows_have_the_loads_of_their_shapes);
    tcase_add_test(run, series_has_the_measures_of_contact);
    tcase_add_test(run, a_run_with_shapes_sums_them_up);
    TCase *slow = test_long(all, 60);
    tcase_add_checked_fixture(slow, begin, end);
    tcase_add_test(slow, a_run_with_self_contact_has_its_gap);
    tcase_add_loop_test(run, surfaces_are_where_the_gap_is_0, 0, SHAPES);
    tcase_add_test(run, every_format_but_csv_has_the_shapes);
    tcase_add_test(run, exported_shapes_move);
    tcase_add_test(run, force_removes_exported_shapes_and_nothing_else);
    tcase_add_test(run, without_its_scene_a_run_is_exported_without_shapes);
    tcase_add_test(run, a_page_has_the_shapes);
    suite_add_tcase(all, run);
    return all;
}
