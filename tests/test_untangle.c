/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_untangle.c -- starts that cross: what is named and written of them, and how
 * contact.untangle relaxes them. */
#include <math.h>

#include "bodies.h"
#include "cloth/model.h"
#include "forces/contact/self/crossing.h"
#include "shell.h"

enum { SIDE = 9, UPPER = 7, N = SIDE * SIDE + UPPER * UPPER, T = 2 * (64 + 36) };

static double start[3 * N], rest[2 * N];
static uint32_t corners[3 * T];
static weft_cloth_part parts[2];
static const weft_fabric fabric = { .density = 0.2,
                                    .stretch = { 100.0, 100.0 },
                                    .shear = 20.0,
                                    .bend = { 1e-5, 1e-5 },
                                    .twist = -1.0,
                                    .damping = { 1e-3, 1e-2 } };
static weft_mesh_def mesh;
static weft_cloth_def def;
static weft_cloth *cloth;
static weft_error err;
static double y[6 * N];

/* ---- two sheets, the upper one at a height over the other ------------------------ */

static void lay(size_t side, size_t first, double shift)
{
    for (size_t i = 0; i < side * side; ++i) {
        const double u = 0.02 * (double)(i % side), v = 0.02 * (double)(i / side);
        double *x = &start[3 * (first + i)];
        x[0] = u + 1.3 * shift, x[1] = 0.0, x[2] = v + shift;
        rest[2 * (first + i)] = u, rest[2 * (first + i) + 1] = -v;
    }
    for (size_t c = 0; c < (side - 1) * (side - 1); ++c) {
        const uint32_t a = (uint32_t)(first + c / (side - 1) * side + c % (side - 1));
        const uint32_t b = a + (uint32_t)side;
        const uint32_t two[6] = { a, b, a + 1, a + 1, b, b + 1 };
        memcpy(corners + 3 * mesh.triangles, two, sizeof two);
        mesh.triangles += 2;
    }
}

static void sheets(double (*height)(double u, double v))
{
    mesh = weft_mesh_def_default();
    lay(SIDE, 0, 0.0);
    lay(UPPER, SIDE * SIDE, 0.01);
    for (size_t i = SIDE * SIDE; i < N; ++i) {
        start[3 * i + 1] = height(rest[2 * i], -rest[2 * i + 1]);
    }
    parts[0] = (weft_cloth_part){ .name = "lower", .count = SIDE * SIDE };
    parts[1] = (weft_cloth_part){ "upper", SIDE * SIDE, UPPER * UPPER, { 0.1, 0, 0 } };
    mesh.vertices = mesh.uv_count = N;
    mesh.start = start, mesh.rest = rest, mesh.corners = corners;
    mesh.fabrics = &fabric, mesh.fabric_count = 1;
    mesh.parts = parts, mesh.part_count = 2;
    def = weft_cloth_def_default();
    def.mesh = &mesh;
    def.contact.thickness = 4e-3;
    def.contact.self = true;
}

/* Dips below the lower one with an edge, or with a bump, or stands in it. */
static double dips(double u, double v)
{
    return -0.003 + 0.08 * u + 0.01 * v;
}

static double bulges(double u, double v)
{
    const double a = (u - 0.06) / 0.02, b = (v - 0.06) / 0.02;
    return 0.004 - 0.008 / (1.0 + (a * a + b * b) * (a * a + b * b));
}

static double lies_above(double u, double v)
{
    return 0.002 + 0.0 * (u + v);
}

static void make(double untangle)
{
    def.untangle = untangle;
    ck_assert_msg(weft_cloth_create(&def, &cloth, &err) == WEFT_OK, "%s", err.message);
    weft_cloth_start(cloth, y);
}

static void teardown(void)
{
    weft_cloth_destroy(cloth);
    cloth = NULL;
}

static void expect_free(void)
{
    ck_assert_msg(weft_cloth_untangle(cloth, y, &err) == WEFT_OK, "%s", err.message);
    ck_assert_uint_eq(weft_cloth_each_crossing(cloth, y, NULL, NULL), 0);
    const size_t n = weft_cloth_particles(cloth);
    for (size_t i = 3 * n; i < 6 * n; ++i) {
        ck_assert(y[i] == 0.0);
    }
}

/* A crossing start, its refusal, and a run of what it becomes. */
static void comes_apart(double least)
{
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    make(1.0);
    char pairs[32];
    (void)snprintf(pairs, sizeof pairs, "; %zu such pairs",
                   weft_cloth_each_crossing(cloth, y, NULL, NULL));
    ck_assert_msg(strstr(err.message, pairs) != NULL, "no %s in %s", pairs,
                  err.message);
    expect_free();
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    run.cloth = cloth;
    run.method = test_method_named("arkode/dormand_prince");
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = 1e-4;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_OK);
    const size_t n = weft_cloth_particles(cloth);
    ck_assert_mem_eq(weft_sim_state(sim), y, 6 * n * sizeof *y);
    const weft_measures of = weft_sim_measure(sim);
    ck_assert_double_ge(fmin(of.gap, of.self_gap), least * def.contact.thickness);
    ck_assert_int_eq(weft_sim_advance(sim, 0.02, &err), WEFT_OK);
    ck_assert_uint_eq(weft_cloth_each_crossing(cloth, weft_sim_state(sim), NULL, NULL),
                      0);
    weft_sim_destroy(sim);
}

START_TEST(a_sheet_that_dips_through_another_with_its_edge_comes_apart)
{
    sheets(dips);
    comes_apart(0.9);
}
END_TEST

START_TEST(a_sheet_with_a_bump_through_another_comes_apart)
{
    sheets(bulges);
    comes_apart(0.9);
}
END_TEST

START_TEST(pinned_vertices_stay_where_they_are)
{
    const size_t held[2] = { SIDE * SIDE, SIDE * SIDE + UPPER - 1 };
    const weft_pin pin = { .vertices = held, .vertex_count = 2 };
    double before[6 * N];
    sheets(bulges);
    def.pins = &pin, def.pin_count = 1;
    make(1.0);
    memcpy(before, y, sizeof y);
    expect_free();
    for (size_t k = 0; k < 6 * 2; ++k) {
        const size_t at = weft_cloth_index(cloth, held[k % 2]) + k / 2 * N;
        ck_assert(y[at] == before[at]);
    }
}
END_TEST

/* ---- bodies and shapes ----------------------------------------------------------- */

/* A level sheet of springs or of triangles, 3 mm below the top of a ball of 20 cm. */
static void sink(weft_shape *ball)
{
    sheets(lies_above);
    def.mesh = NULL;
    def.rows = def.cols = SIDE;
    def.spacing[0] = def.spacing[1] = 0.02;
    def.origin[0] = def.origin[2] = -0.077, def.origin[1] = 0.197;
    def.down[1] = 0.0, def.down[2] = 1.0;
    def.springs[WEFT_STRETCH] = def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
    def.contact.self = false;
    def.contact.shapes = ball, def.contact.shape_count = 1;
}

START_TEST(a_cloth_comes_out_of_a_body)
{
    body_mesh *ball = icosphere(3, 0.2);
    weft_shape shape = body_shape(ball);
    sink(&shape);
    comes_apart(0.9);
    free(ball);
}
END_TEST

START_TEST(a_cloth_comes_out_of_a_sphere)
{
    weft_shape shape = weft_shape_default(WEFT_SPHERE);
    shape.radius = 0.2;
    sink(&shape);
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, "mm inside shapes[0]") != NULL, "%s",
                  err.message);
    make(1.0);
    ck_assert_uint_gt(weft_cloth_each_crossing(cloth, y, NULL, NULL), 4);
    expect_free();
    ck_assert_double_gt(weft_cloth_gap(cloth, 0.0, y, NULL, NULL), 0.0);
}
END_TEST

START_TEST(a_cloth_inside_a_closed_body_stays_and_is_named)
{
    body_mesh *ball = icosphere(2, 0.5);
    weft_shape shape = body_shape(ball);
    sink(&shape);
    make(0.01);
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_SOLVER);
    ck_assert_msg(strstr(err.message, "after 0.01 s of contact.untangle: particle")
                      != NULL,
                  "%s", err.message);
    free(ball);
}
END_TEST

START_TEST(a_pin_that_holds_a_cloth_in_a_body_is_named)
{
    body_mesh *ball = icosphere(3, 0.2);
    weft_shape shape = body_shape(ball);
    const weft_pin pin = { .rows = { 4, 4 }, .cols = { 4, 4 } };
    sink(&shape);
    def.pins = &pin, def.pin_count = 1;
    make(1.0);
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_SOLVER);
    ck_assert_msg(strstr(err.message, "contact.untangle cannot move the cloth out: "
                                      "particle (4, 4) is inside shapes[0], a closed "
                                      "mesh, and a pin holds it there")
                      != NULL,
                  "%s", err.message);
    free(ball);
}
END_TEST

/* ---- what is left, and what is not touched --------------------------------------- */

static void count(void *ctx, const weft_crossing *one)
{
    size_t *counts = ctx;
    ++counts[one->count[0]], ++counts[one->count[1]];
    for (size_t k = 0; k < 9 * one->count[1]; ++k) {
        ck_assert(isfinite(one->place[1][k / 9][k % 3]));
    }
}

START_TEST(what_cannot_be_freed_in_time_is_named_and_counted)
{
    size_t counts[4] = { 0 };
    sheets(dips);
    make(1e-5);
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_SOLVER);
    ck_assert_int_eq(err.status, WEFT_SOLVER);
    const size_t left = weft_cloth_each_crossing(cloth, y, count, counts);
    char text[64];
    ck_assert_uint_gt(left, 1);
    ck_assert_uint_eq(counts[2], left);
    ck_assert_uint_eq(counts[3], left);
    (void)snprintf(text, sizeof text, "%zu such pairs", left);
    ck_assert_msg(strstr(err.message, text) != NULL
                      && strstr(err.message, "after 1e-05 s of contact.untangle: edge ")
                             == err.message,
                  "%s", err.message);
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    run.cloth = cloth, run.method = test_method_named("arkode/dormand_prince");
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_SOLVER);
    ck_assert_ptr_null(sim);
}
END_TEST

/* Both sheets are held where they cross. */
static void hold_most(void)
{
    static size_t held[N - 1];
    static weft_pin pin;
    sheets(dips);
    for (size_t i = 0; i < N - 1; ++i) {
        held[i] = i + (i >= SIDE * SIDE + 22);
    }
    pin = (weft_pin){ .vertices = held, .vertex_count = N - 1 };
    def.pins = &pin, def.pin_count = 1;
}

static void keep_line(void *ctx, weft_log_level level, const char *text)
{
    ck_assert_int_eq(level, WEFT_LOG_INFO);
    (void)snprintf(ctx, 128, "%s", text);
}

START_TEST(a_start_that_does_not_get_better_ends_with_what_is_left)
{
    char said[128] = "";
    hold_most();
    def.log = (weft_log){ keep_line, said };
    make(1e6);
    const size_t before = weft_cloth_each_crossing(cloth, y, NULL, NULL);
    ck_assert_uint_gt(before, 0);
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_SOLVER);
    ck_assert_uint_le(weft_cloth_each_crossing(cloth, y, NULL, NULL), before);
    ck_assert_msg(strstr(err.message, " s of contact.untangle, as the number of "
                                      "crossings did not fall any more: edge ")
                      != NULL,
                  "%s", err.message);
    ck_assert_msg(said[0] == '\0' || strstr(said, " crossings after ") != NULL, "%s",
                  said);
}
END_TEST

/* Asked for the k-th time it says so. */
static bool stop_at(void *ctx)
{
    size_t *left = ctx;
    *left -= *left > 0;
    return *left == 0;
}

START_TEST(the_embedder_stops_a_start_that_relaxes)
{
    size_t left = 20;
    hold_most();
    def.stop = stop_at, def.stop_ctx = &left;
    left = SIZE_MAX;
    make(1e6);
    left = 20;
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_STOPPED);
    ck_assert_str_eq(err.message, "asked to stop");
    for (size_t i = 0; i < 6 * N; ++i) {
        ck_assert(isfinite(y[i]));
    }
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    run.cloth = cloth, run.method = test_method_named("arkode/dormand_prince");
    left = 20;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_STOPPED);
    ck_assert_ptr_null(sim);
    teardown();
    def.stop = NULL; /* or the simulation's own */
    make(1e6);
    run.cloth = cloth, run.stop = stop_at, run.stop_ctx = &left;
    left = 20;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_STOPPED);
    ck_assert_ptr_null(sim);
}
END_TEST

/* At each place where it asks. */
START_TEST(the_embedder_stops_the_making_of_a_cloth)
{
    size_t left, k = 0;
    sheets(lies_above);
    mesh.arc = true;
    def.stop = stop_at, def.stop_ctx = &left;
    weft_status status = WEFT_STOPPED;
    while (status == WEFT_STOPPED) {
        left = k += 1 + k / 8;
        status = weft_cloth_create(&def, &cloth, &err);
        ck_assert((status == WEFT_OK) == (cloth != NULL));
    }
    def.stop = NULL, def.stop_ctx = NULL;
    ck_assert_int_eq(status, WEFT_OK);
    ck_assert_uint_gt(k, 2 * N);
}
END_TEST

START_TEST(a_state_that_is_not_finite_is_not_judged)
{
    sheets(lies_above);
    make(1.0);
    const weft__search of = { .where = "here " };
    ck_assert_int_eq(weft__crossings_error(cloth, 0.0, y, &of, &err), WEFT_OK);
    for (size_t i = 0; i < 6 * N; ++i) {
        const double kept = y[i];
        y[i] = i % 2 == 0 ? NAN : INFINITY;
        ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_INVALID);
        ck_assert_str_eq(err.message, "a state must be finite");
        if (i < 3 * N) {
            ck_assert_int_eq(weft__crossings_error(cloth, 0.0, y, &of, &err),
                             WEFT_NOT_FINITE);
            ck_assert_str_eq(err.message, "here the state is not finite");
        }
        y[i] = kept;
    }
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    run.cloth = cloth, run.method = test_method_named("arkode/dormand_prince");
    run.start = y;
    y[7] = NAN;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_INVALID);
    ck_assert_ptr_null(sim);
}
END_TEST

START_TEST(a_given_start_is_taken_as_it_is)
{
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    sheets(bulges);
    make(1.0);
    run.cloth = cloth, run.method = test_method_named("arkode/dormand_prince");
    run.start = y;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_OK);
    ck_assert_mem_eq(weft_sim_state(sim), y, sizeof y);
    weft_sim_destroy(sim);
    const weft_parameter number
        = { .name = "n", .less = cloth, .more = cloth, .span = 1.0 };
    const weft_sensitivity_def by = { .count = 1, .parameters = &number };
    run.sensitivity = &by;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_UNSUPPORTED);
}
END_TEST

START_TEST(a_good_start_keeps_its_bits)
{
    double before[6 * N];
    sheets(lies_above); /* nearer than the thickness, and with a velocity */
    make(1.0);
    memcpy(before, y, sizeof y);
    ck_assert_int_eq(weft_cloth_untangle(cloth, y, &err), WEFT_OK);
    ck_assert_mem_eq(y, before, sizeof y);
    for (int k = 0; k < 2; ++k) {
        weft_sim_def run = weft_sim_def_default();
        weft_sim *sim;
        teardown();
        make(k == 0 ? 1.0 : 0.0);
        run.cloth = cloth, run.method = test_method_named("arkode/dormand_prince");
        ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_OK);
        ck_assert_int_eq(weft_sim_advance(sim, 0.003, &err), WEFT_OK);
        if (k == 0) {
            memcpy(before, weft_sim_state(sim), sizeof before);
        }
        ck_assert_mem_eq(weft_sim_state(sim), before, sizeof before);
        weft_sim_destroy(sim);
    }
}
END_TEST

START_TEST(all_instruction_sets_give_the_same_bits)
{
    double first[6 * N];
    sheets(bulges);
    for (weft__isa isa = WEFT__LOOPS; isa <= weft__isa_last(); ++isa) {
        make(1.0);
        weft__cloth_choose(cloth, isa);
        expect_free();
        if (isa == WEFT__LOOPS) {
            memcpy(first, y, sizeof y);
        }
        ck_assert_mem_eq(y, first, sizeof y);
        teardown();
    }
}
END_TEST

START_TEST(the_time_is_a_number_from_0_on)
{
    sheets(lies_above);
    def.untangle = -1.0;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "contact: untangle -1 s: must be >= 0");
    def.untangle = NAN;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
}
END_TEST

/* ---- the program ----------------------------------------------------------------- */

#define OUT BUILD_DIR "/untangle"

static void write_scene(double (*height)(double u, double v), const char *untangle)
{
    sheets(height);
    ck_assert_int_eq(shell("mkdir -p " OUT), 0);
    FILE *to = fopen(OUT "/sheets.obj", "w");
    ck_assert_ptr_nonnull(to);
    for (size_t i = 0; i < N; ++i) {
        fprintf(to, "v %.17g %.17g %.17g\nvt %.17g %.17g\n", start[3 * i],
                start[3 * i + 1], start[3 * i + 2], rest[2 * i], rest[2 * i + 1]);
    }
    for (size_t t = 0; t < mesh.triangles; ++t) {
        const uint32_t *c = &corners[3 * t];
        fprintf(to, "f %u/%u %u/%u %u/%u\n", c[0] + 1, c[0] + 1, c[1] + 1, c[1] + 1,
                c[2] + 1, c[2] + 1);
    }
    ck_assert_int_eq(fclose(to), 0);
    char text[1024];
    (void)snprintf(text, sizeof text,
                   "cloth: {mesh: {file: sheets.obj}, fabric: {density: 0.2, stretch: "
                   "100, shear: 20, bend: 1.0e-5, damping: [1.0e-3, 1.0e-2]}}\n"
                   "contact: {thickness: 4.0e-3, self: true%s}\n"
                   "stepper: {plugin: arkode, method: dormand_prince}\n"
                   "run: {duration: 0.01}\n",
                   untangle);
    write_file(OUT "/scene.yaml", text);
}

#define RUN           WEFT " run " OUT "/scene.yaml --quiet --out " OUT "/run "
#define HAS           "ls " OUT "/run"
#define FILE_OF_PAIRS OUT "/run/start-crossings.obj"

/* As many comments as the error has pairs, and elements of all of them. */
static void expect_pairs(const char *in)
{
    const char *text = strstr(in, "; ");
    ck_assert_ptr_nonnull(text);
    const size_t pairs = strtoul(text + 2, NULL, 10);
    ck_assert_uint_gt(pairs, 1);
    expect(shell("grep -c ' passes through ' " FILE_OF_PAIRS
                 "; grep -c '^l' " FILE_OF_PAIRS "; grep -c '^f' " FILE_OF_PAIRS
                 "; tail -1 " FILE_OF_PAIRS),
           0);
    char wanted[96];
    (void)snprintf(wanted, sizeof wanted, "%zu\n%zu\n%zu\n# %zu in all\n", pairs, pairs,
                   pairs, pairs);
    ck_assert_str_eq(output, wanted);
}

START_TEST(a_run_writes_the_pairs_of_a_start_that_crosses)
{
    char said[sizeof output];
    expect(shell("rm -rf " OUT), 0);
    write_scene(dips, "");
    expect(shell(WEFT " check " OUT "/scene.yaml 2>&1; ls " OUT), 0);
    ck_assert_ptr_nonnull(strstr(output, " passes through "));
    ck_assert_ptr_null(strstr(output, "run\n"));
    for (int k = 0; k < 2; ++k) { /* again, into a directory that has nothing else */
        expect(shell(RUN "2>&1"), 3);
        memcpy(said, output, sizeof said);
        expect(shell(HAS), 0);
        ck_assert_str_eq(output, "start-crossings.obj\n");
        expect_pairs(said);
    }
    write_scene(lies_above, "");
    expect(shell(RUN "2>&1"), 0);
    ck_assert(!exists(FILE_OF_PAIRS) && exists(OUT "/run/result.yaml"));
    write_scene(dips, "");
    expect(shell(HAS " >" OUT "/before; cksum " OUT "/run/* >" OUT "/sums"), 0);
    expect(shell(RUN "2>&1"), 3); /* the results of another run stay, alone */
    says("not empty");
    expect(shell(HAS " | cmp - " OUT "/before"), 0);
    expect(shell(RUN "--force 2>&1"), 3);
    expect_pairs(output);
    expect(shell("mv " FILE_OF_PAIRS " " OUT " && cksum " OUT "/run/* | cmp - " OUT
                 "/sums"),
           0);
    write_scene(lies_above, "");
    expect(shell(RUN "--force 2>&1"), 0);
    ck_assert(!exists(FILE_OF_PAIRS));
}
END_TEST

START_TEST(a_run_relaxes_its_start_or_writes_what_is_left)
{
    char said[sizeof output];
    expect(shell("rm -rf " OUT), 0);
    write_scene(dips, ", untangle: 1.0e-5");
    expect(shell(WEFT " check " OUT "/scene.yaml 2>&1"), 1);
    says("after 1e-05 s of contact.untangle: edge ");
    expect(shell(RUN "2>&1"), 1);
    says("after 1e-05 s of contact.untangle: edge ");
    memcpy(said, output, sizeof said);
    expect_pairs(said);
    expect(shell("grep -c '^status: .*failed' " OUT "/run/result.yaml"), 0);
    write_scene(dips, ", untangle: 1.0");
    expect(shell(RUN "--force 2>&1"), 0);
    ck_assert(!exists(FILE_OF_PAIRS));
}
END_TEST

TEST_SUITE(untangle)
{
    Suite *suite = suite_create("untangle");
    TCase *tcase = tcase_create("untangle"), *slow = test_long(suite, 120);
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, NULL, teardown);
    tcase_add_checked_fixture(slow, NULL, teardown);
    tcase_add_test(tcase, a_sheet_that_dips_through_another_with_its_edge_comes_apart);
    tcase_add_test(slow, a_sheet_with_a_bump_through_another_comes_apart);
    tcase_add_test(tcase, pinned_vertices_stay_where_they_are);
    tcase_add_test(tcase, a_cloth_comes_out_of_a_body);
    tcase_add_test(tcase, a_cloth_comes_out_of_a_sphere);
    tcase_add_test(tcase, a_cloth_inside_a_closed_body_stays_and_is_named);
    tcase_add_test(tcase, a_pin_that_holds_a_cloth_in_a_body_is_named);
    tcase_add_test(tcase, what_cannot_be_freed_in_time_is_named_and_counted);
    tcase_add_test(slow, a_start_that_does_not_get_better_ends_with_what_is_left);
    tcase_add_test(tcase, the_embedder_stops_a_start_that_relaxes);
    tcase_add_test(tcase, the_embedder_stops_the_making_of_a_cloth);
    tcase_add_test(tcase, a_state_that_is_not_finite_is_not_judged);
    tcase_add_test(tcase, a_given_start_is_taken_as_it_is);
    tcase_add_test(tcase, a_good_start_keeps_its_bits);
    tcase_add_test(slow, all_instruction_sets_give_the_same_bits);
    tcase_add_test(tcase, the_time_is_a_number_from_0_on);
    tcase_add_test(tcase, a_run_writes_the_pairs_of_a_start_that_crosses);
    tcase_add_test(tcase, a_run_relaxes_its_start_or_writes_what_is_left);
    suite_add_tcase(suite, tcase);
    return suite;
}
