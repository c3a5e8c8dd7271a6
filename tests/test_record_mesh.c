/* SPDX-License-Identifier: BSD-3-Clause */
/* test_record_mesh.c -- a cloth of triangles in the numbers of its definition: what a
 * simulation takes and gives, and the files of a run. */
#include <hdf5.h>

#include "meshes.h"

#include <math.h>

#include "program/record/export/export.h"
#include "program/record/page.h"
#include "program/record/vtkhdf.h"
#include "run_frames.h"

#define OUT BUILD_DIR "/record_mesh"

enum { ROWS = 24, COLS = 25, N = ROWS * COLS, LAST = 4 };

static test_mesh mesh;
static size_t names[N];
static weft_cloth *cloth;
static weft_sim *sim;
static weft_error err;
static double x[3 * N], v[3 * N];

/* Two pieces, sewn together, of shuffled numbers and with names from 1000 down. */
static void begin(void)
{
    static size_t held[2];
    static weft_pin pin = { .vertices = held, .vertex_count = 2 };
    uint32_t to[N];
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    mesh_sheet(&mesh, ROWS, COLS, 0.02, MESH_RANDOM, 0.2, 5);
    mesh_sew(&mesh, 10, 0.1, 0.8, 0.6);
    mesh_shuffle(&mesh, 9, to);
    for (size_t i = 0; i < N; ++i) {
        names[i] = 1000 - i;
    }
    mesh.def.file_index = names;
    held[0] = to[0], held[1] = to[COLS - 1];
    weft_cloth_def def = mesh_cloth(&mesh);
    def.gravity[2] = -9.81;
    def.pins = &pin, def.pin_count = 1;
    cloth = test_cloth(&def);
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 1e-4;
    sim = test_sim(cloth, test_method_named("verlet/velocity_verlet"), &config);
}

static void end(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}

START_TEST(positions_are_those_of_vertices)
{
    weft_sim_positions(sim, x);
    ck_assert_mem_eq(x, mesh.start, sizeof x);
    weft_cloth_rest(cloth, x);
    ck_assert_mem_eq(x, mesh.start, sizeof x);
    for (size_t i = 0; i < 3 * N; ++i) {
        x[i] += 1e-3 * (double)(i % 17), v[i] = 0.1 * (double)(i % 13);
    }
    double now[3 * N];
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, &err), WEFT_OK);
    weft_sim_positions(sim, now);
    for (size_t i = 0; i < 3 * N; ++i) {
        ck_assert(now[i] == (weft_cloth_pinned(cloth, i / 3) ? mesh.start[i] : x[i]));
    }
    weft_sim_velocities(sim, now);
    for (size_t i = 0; i < 3 * N; ++i) {
        ck_assert(now[i] == (weft_cloth_pinned(cloth, i / 3) ? 0.0 : v[i]));
    }
}
END_TEST

START_TEST(pins_are_vertices)
{
    const double to[3] = { 7.0, 8.0, 9.0 };
    ck_assert(!weft_cloth_pinned(weft_sim_cloth(sim), 17));
    ck_assert_int_eq(weft_sim_pin(sim, 17, NULL, &err), WEFT_OK);
    ck_assert(weft_cloth_pinned(weft_sim_cloth(sim), 17));
    ck_assert_int_eq(weft_sim_move_pin(sim, 17, to, &err), WEFT_OK);
    weft_sim_positions(sim, x);
    ck_assert_mem_eq(&x[3 * 17], to, sizeof to);
    ck_assert_mem_eq(x, mesh.start, 3 * 17 * sizeof *x);
    ck_assert_int_eq(weft_sim_unpin(sim, 17, &err), WEFT_OK);
    ck_assert_uint_eq(weft_cloth_pins(weft_sim_cloth(sim)), 2);
}
END_TEST

/* One vertex away from the others. */
START_TEST(strains_are_those_of_vertices)
{
    const size_t moved = 17;
    double strain[N];
    bool near[N] = { false };
    weft_sim_positions(sim, x);
    x[3 * moved + 2] += 0.02;
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, &err), WEFT_OK);
    weft_cloth_strains(cloth, weft_sim_state(sim), strain);
    for (size_t t = 0; t < mesh.def.triangles; ++t) {
        const uint32_t *of = &mesh.corners[3 * t];
        const bool here = of[0] == moved || of[1] == moved || of[2] == moved;
        for (size_t k = 0; k < 3; ++k) {
            near[of[k]] = near[of[k]] || here;
        }
    }
    for (size_t i = 0; i < N; ++i) {
        ck_assert(near[i] ? strain[i] > 0.1 : fabs(strain[i]) < 1e-12);
    }
    const weft_spring worst = weft_sim_measure(sim).worst;
    ck_assert(worst.p == moved || worst.q == moved);
    ck_assert(worst.strain == strain[moved]);
    ck_assert(near[worst.p] && near[worst.q]);
}
END_TEST

/* ---- run.vtkhdf ------------------------------------------------------------------ */

static void record(void)
{
    const weft_record_def wanted
        = { .doubles = true, .fields = { true, true, true }, .every = 1 };
    record_series series;
    record_vtkhdf *frames;
    const record_vtkhdf_def def = { .directory = OUT,
                                    .cloth = cloth,
                                    .record = &wanted,
                                    .last = LAST,
                                    .series = &series };
    ck_assert_int_eq(record_series_open(&series, OUT, 0, NULL, false, &err), WEFT_OK);
    ck_assert_int_eq(record_vtkhdf_create(&def, &frames, &err), WEFT_OK);
    for (size_t i = 0; i <= LAST; ++i) {
        const record_frame frame = { .index = i, .sim = sim };
        ck_assert_int_eq(weft_sim_advance(sim, 0.01 * (double)i, &err), WEFT_OK);
        ck_assert_int_eq(record_series_add(&series, &frame, &err), WEFT_OK);
        ck_assert_int_eq(record_vtkhdf_add(frames, &frame, &err), WEFT_OK);
    }
    ck_assert_int_eq(record_vtkhdf_close(frames, &err), WEFT_OK);
    ck_assert_int_eq(record_table_close(&series.table, &err), WEFT_OK);
}

START_TEST(frames_of_a_mesh_have_its_triangles_and_names)
{
    record();
    record_faces made;
    record_frames *frames = open_frames(OUT);
    const record_faces *read = &frames->faces;
    ck_assert_int_eq(record_faces_of(cloth, &made, &err), WEFT_OK);
    ck_assert(record_faces_same(&made, read));
    ck_assert_uint_eq(read->cols, 0);
    ck_assert_uint_eq(read->triangles, 2 * (ROWS - 1) * (COLS - 1));
    ck_assert_uint_eq(read->places, N + ROWS); /* a seam of ROWS vertices */
    ck_assert_uint_eq(made.places, read->places);
    ck_assert_mem_eq(read->uv, made.uv, 2 * read->places * sizeof *read->uv);
    ck_assert_mem_eq(read->corner_uv, made.corner_uv,
                     3 * read->triangles * sizeof *made.corners);
    for (size_t i = 0; i < N; ++i) {
        ck_assert_uint_eq(record_name(read, i), names[i]);
        ck_assert(frames->pinned[i] == weft_cloth_pinned(cloth, i));
    }
    ck_assert_int_eq(record_frames_positions(frames, LAST, x, &err), WEFT_OK);
    weft_sim_positions(sim, v);
    ck_assert_mem_eq(x, v, sizeof x);
    record_faces_free(&made);
    record_frames_close(frames);
}
END_TEST

/* The first number of a set becomes one that is no vertex, or place. */
static void spoil(const char *set, hid_t type, const void *value)
{
    const hsize_t begin[2] = { 0, 0 }, one[2] = { 1, 1 };
    const hid_t file = H5Fopen(OUT "/run.vtkhdf", H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t id = H5Dopen2(file, set, H5P_DEFAULT), space = H5Dget_space(id);
    const hid_t memory = H5Screate_simple(1, one, NULL);
    ck_assert(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, NULL, one, NULL) >= 0);
    ck_assert(H5Dwrite(id, type, memory, space, H5P_DEFAULT, value) >= 0);
    (void)H5Sclose(memory);
    (void)H5Sclose(space);
    (void)H5Dclose(id);
    ck_assert(H5Fclose(file) >= 0);
}

START_TEST(triangles_of_a_damaged_file_are_refused)
{
    const int64_t beyond = N, below = -1;
    const uint32_t place = N + ROWS;
    const double nothing = NAN;
    const struct {
        const char *set;
        hid_t type;
        const void *value;
    } faults[] = {
        { "/VTKHDF/Polygons/Connectivity", H5T_NATIVE_INT64, &beyond },
        { "/VTKHDF/Polygons/Connectivity", H5T_NATIVE_INT64, &below },
        { "/weft/CornerPlaces", H5T_NATIVE_UINT32, &place },
        { "/weft/Places", H5T_NATIVE_DOUBLE, &nothing },
    };
    record_frames *frames;
    record();
    spoil(faults[_i].set, faults[_i].type, faults[_i].value);
    ck_assert_int_eq(record_frames_open(OUT, &frames, &err), WEFT_IO);
    ck_assert_ptr_null(frames);
    ck_assert_ptr_nonnull(strstr(err.message, "are missing or wrong"));
}
END_TEST

/* Its v, vt and f are the start, the rest shape and the triangles of a definition. */
START_TEST(an_obj_of_a_mesh_is_its_definition)
{
    record_surface surface = { .position = x, .doubles = true };
    weft_sim_positions(sim, x);
    ck_assert_int_eq(record_faces_of(cloth, &surface.faces, &err), WEFT_OK);
    ck_assert_int_eq(record_surface_write(OUT, "a.obj", record_obj, &surface, &err),
                     WEFT_OK);
    FILE *stream = fopen(OUT "/a.obj", "r");
    char line[128];
    double now[3 * N], uv[4 * N];
    size_t vertices = 0, places = 0, triangles = 0, corner[3], place[3];
    double area = 0.0;
    while (fgets(line, sizeof line, stream) != NULL) {
        double *at = now + 3 * vertices, *st = uv + 2 * places;
        vertices += sscanf(line, "v %lf %lf %lf", at, at + 1, at + 2) == 3;
        places += sscanf(line, "vt %lf %lf", st, st + 1) == 2;
        if (sscanf(line, "f %zu/%zu %zu/%zu %zu/%zu", &corner[0], &place[0], &corner[1],
                   &place[1], &corner[2], &place[2])
            == 6) {
            const double *a = uv + 2 * place[0] - 2, *b = uv + 2 * place[1] - 2,
                         *c = uv + 2 * place[2] - 2;
            area += 0.5
                    * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            ++triangles;
        }
    }
    (void)fclose(stream);
    ck_assert_uint_eq(vertices, N);
    ck_assert_uint_eq(places, N + ROWS);
    ck_assert_uint_eq(triangles, surface.faces.triangles);
    ck_assert_double_eq_tol(area, 0.02 * (ROWS - 1) * 0.02 * (COLS - 1), 1e-8);
    for (size_t i = 0; i < 3 * N; ++i) {
        ck_assert_double_eq_tol(now[i], mesh.start[i], 1e-9);
    }
    record_faces_free(&surface.faces);
}
END_TEST

START_TEST(final_csv_names_vertices_and_is_read_back)
{
    record_surface surface = { .position = x, .velocity = v, .doubles = true };
    double now[3 * N], speed[3 * N];
    char result[64];
    ck_assert_int_eq(weft_sim_advance(sim, 0.01, &err), WEFT_OK);
    weft_sim_positions(sim, x);
    weft_sim_velocities(sim, v);
    ck_assert_int_eq(record_faces_of(cloth, &surface.faces, &err), WEFT_OK);
    ck_assert_int_eq(record_surface_write(OUT, "final.csv", record_csv, &surface, &err),
                     WEFT_OK);
    const char *text = read_file(OUT "/final.csv");
    ck_assert(strncmp(text, "vertex,x,y,z,vx,vy,vz\n1000,", 27) == 0);
    (void)snprintf(result, sizeof result, "hash: \"%016llx\"\n",
                   (unsigned long long)weft_sim_measure(sim).hash);
    write_file(OUT "/result.yaml", result);
    ck_assert_msg(record_final_read(OUT, &surface.faces, cloth, now, speed, &err)
                      == WEFT_OK,
                  "%s", err.message);
    ck_assert_mem_eq(now, x, sizeof x);
    ck_assert_mem_eq(speed, v, sizeof v);
    (void)shell("sed -i 5s/0/1/ " OUT "/final.csv");
    ck_assert_int_eq(record_final_read(OUT, &surface.faces, cloth, now, speed, &err),
                     WEFT_IO);
    record_faces_free(&surface.faces);
}
END_TEST

START_TEST(a_page_has_the_triangles)
{
    record();
    const char *const directories[] = { OUT };
    ck_assert_int_eq(record_player(directories, 1, OUT "/run.html", &err), WEFT_OK);
    const char *page = strstr(read_file(OUT "/run.html"), "id=\"weft-data\"");
    ck_assert_ptr_nonnull(
        strstr(page, "\"mesh\":{\"vertices\":600,\"triangles\":1104,"));
    ck_assert_ptr_null(strstr(page, "\"grid\""));
}
END_TEST

TEST_SUITE(record_mesh)
{
    Suite *suite = suite_create("record_mesh");
    TCase *all = tcase_create("mesh");
    tcase_add_checked_fixture(all, begin, end);
    tcase_add_test(all, positions_are_those_of_vertices);
    tcase_add_test(all, pins_are_vertices);
    tcase_add_test(all, strains_are_those_of_vertices);
    tcase_add_test(all, frames_of_a_mesh_have_its_triangles_and_names);
    tcase_add_loop_test(all, triangles_of_a_damaged_file_are_refused, 0, 4);
    tcase_add_test(all, an_obj_of_a_mesh_is_its_definition);
    tcase_add_test(all, final_csv_names_vertices_and_is_read_back);
    tcase_add_test(all, a_page_has_the_triangles);
    suite_add_tcase(suite, all);
    return suite;
}
