/* SPDX-License-Identifier: BSD-3-Clause */
/* weft export: each format read byte by byte after its published layout, and compared
 * with the frames of the run. */
#include "program/record/frames.h"
#include "shell.h"

#define OUT BUILD_DIR "/export"

enum { ROWS = 4, COLS = 5, N = ROWS * COLS, QUADS = 12, LAST = 10 };

static double frames[LAST + 1][3 * N], velocities[LAST + 1][3 * N], times[LAST + 1];

/* Frames of a run of single or double precision, and of a chain in OUT/c. */
static void run_scene(const char *precision)
{
    weft_error err;
    record_frames *read;
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet --force --set "
                      "record.precision=%s 2>&1",
                 precision),
           0);
    ck_assert_int_eq(record_frames_open(OUT "/r", &read, &err), WEFT_OK);
    ck_assert_uint_eq(read->count, LAST + 1);
    for (size_t i = 0; i <= LAST; ++i) {
        times[i] = read->times[i];
        ck_assert_int_eq(record_frames_positions(read, i, frames[i], &err), WEFT_OK);
        ck_assert_int_eq(
            record_frames_field(read, WEFT_RECORD_VELOCITY, i, velocities[i], &err),
            WEFT_OK);
    }
    record_frames_close(read);
}

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
    run_scene("single");
}

static void run_chain(void)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/c --quiet --set cloth.grid.rows=1 2>/dev/null"),
           0);
}

static void export_as(const char *options)
{
    expect(shell(WEFT " export " OUT "/%s 2>&1", options), 0);
}

/* ---- bytes ------------------------------------------------------------------ */

static unsigned char bytes[1 << 20];
static size_t size, at;

static void load(const char *name)
{
    FILE *stream = fopen(name, "rb");
    ck_assert_msg(stream != NULL, "no file %s", name);
    size = fread(bytes, 1, sizeof bytes - 1, stream);
    bytes[size] = '\0';
    at = 0;
    (void)fclose(stream);
}

static uint64_t take(size_t count, bool big)
{
    uint64_t word = 0;
    ck_assert_uint_le(at + count, size);
    for (size_t i = 0; i < count; ++i) {
        word |= (uint64_t)bytes[at + i] << 8 * (big ? count - 1 - i : i);
    }
    at += count;
    return word;
}

static double take_float(bool big)
{
    const uint32_t word = (uint32_t)take(4, big);
    float value;
    memcpy(&value, &word, sizeof value);
    return (double)value;
}

static double take_double(void)
{
    const uint64_t word = take(8, false);
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static void points_follow(const double *x, bool big)
{
    for (size_t k = 0; k < 3 * N; ++k) {
        ck_assert(take_float(big) == x[k]);
    }
}

/* The text ends where the next byte to take is. */
static void skip_past(const char *text)
{
    const size_t length = strlen(text);
    for (; at + length <= size; ++at) {
        if (memcmp(bytes + at, text, length) == 0) {
            at += length;
            return;
        }
    }
    ck_abort_msg("no '%s'", text);
}

/* ---- point caches ----------------------------------------------------------- */

START_TEST(mdd_holds_times_and_positions_big_endian)
{
    export_as("r --format mdd");
    load(OUT "/r/run.mdd");
    ck_assert_uint_eq(size, 8 + 4 * (LAST + 1) + 12 * N * (LAST + 1));
    ck_assert_uint_eq(take(4, true), LAST + 1);
    ck_assert_uint_eq(take(4, true), N);
    for (size_t i = 0; i <= LAST; ++i) {
        ck_assert(take_float(true) == (double)(float)times[i]);
    }
    for (size_t i = 0; i <= LAST; ++i) {
        points_follow(frames[i], true);
    }
}
END_TEST

START_TEST(pc2_holds_positions_little_endian)
{
    export_as("r --format pc2");
    load(OUT "/r/run.pc2");
    ck_assert_uint_eq(size, 32 + 12 * N * (LAST + 1));
    ck_assert_int_eq(memcmp(bytes, "POINTCACHE2", 12), 0);
    at = 12;
    ck_assert_uint_eq(take(4, false), 1);
    ck_assert_uint_eq(take(4, false), N);
    ck_assert(take_float(false) == 0.0 && take_float(false) == 1.0);
    ck_assert_uint_eq(take(4, false), LAST + 1);
    for (size_t i = 0; i <= LAST; ++i) {
        points_follow(frames[i], false);
    }
}
END_TEST

/* ---- OBJ -------------------------------------------------------------------- */

/* Vertices in order, texture coordinates and quads as the header of the test says. */
static void obj_is(const char *name, const double *x)
{
    char line[256];
    size_t vertices = 0, coordinates = 0, faces = 0;
    FILE *stream = fopen(name, "r");
    ck_assert_msg(stream != NULL, "no file %s", name);
    while (fgets(line, sizeof line, stream) != NULL) {
        double p[3];
        size_t f[8];
        if (sscanf(line, "vt %lf %lf", &p[0], &p[1]) == 2) {
            const size_t row = coordinates / COLS, col = coordinates % COLS;
            ck_assert_double_eq_tol(p[0], (double)col / (COLS - 1), 1e-6);
            ck_assert_double_eq_tol(p[1], 1.0 - (double)row / (ROWS - 1), 1e-6);
            ++coordinates;
        } else if (sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) {
            for (size_t k = 0; k < 3; ++k) {
                ck_assert((float)p[k] == (float)x[3 * vertices + k]);
            }
            ++vertices;
        } else if (sscanf(line, "f %zu/%zu %zu/%zu %zu/%zu %zu/%zu", &f[0], &f[1],
                          &f[2], &f[3], &f[4], &f[5], &f[6], &f[7])
                   == 8) {
            const size_t a = faces / (COLS - 1) * COLS + faces % (COLS - 1) + 1;
            ck_assert(f[0] == a && f[2] == a + COLS && f[4] == a + COLS + 1
                      && f[6] == a + 1);
            ck_assert(f[1] == f[0] && f[3] == f[2] && f[5] == f[4] && f[7] == f[6]);
            ++faces;
        } else {
            ck_assert_msg(line[0] == '#', "%s", line);
        }
    }
    (void)fclose(stream);
    ck_assert_uint_eq(vertices, N);
    ck_assert_uint_eq(coordinates, N);
    ck_assert_uint_eq(faces, QUADS);
}

START_TEST(obj_has_quads_and_texture_coordinates)
{
    export_as("r --format obj --frame all");
    for (size_t i = 0; i <= LAST; ++i) {
        char name[80];
        (void)snprintf(name, sizeof name, OUT "/r/frames/frame-%06zu.obj", i);
        obj_is(name, frames[i]);
    }
}
END_TEST

START_TEST(the_obj_of_a_cache_is_the_rest_pose)
{
    double rest[3 * N];
    export_as("r --format mdd");
    for (size_t i = 0; i < N; ++i) {
        rest[3 * i] = 0.2 * (double)(i % COLS);
        rest[3 * i + 1] = -0.1 * (double)(i / COLS);
        rest[3 * i + 2] = 0.0;
    }
    obj_is(OUT "/r/rest.obj", rest);
}
END_TEST

/* ---- PLY -------------------------------------------------------------------- */

START_TEST(ply_is_binary_and_holds_quads)
{
    export_as("r --format ply --frame 7");
    load(OUT "/r/frames/frame-000007.ply");
    ck_assert_int_eq(memcmp(bytes, "ply\nformat binary_little_endian 1.0\n", 36), 0);
    skip_past("element vertex 20\nproperty float x\nproperty float y\nproperty float "
              "z\nproperty float s\nproperty float t\n");
    skip_past("element face 12\nproperty list uchar int vertex_indices\nend_header\n");
    ck_assert_uint_eq(size - at, 20 * N + 17 * QUADS);
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            ck_assert(take_float(false) == frames[7][3 * i + k]);
        }
        ck_assert(take_float(false) == (double)(float)((double)(i % COLS) / 4.0));
        (void)take_float(false);
    }
    for (size_t q = 0; q < QUADS; ++q) {
        const size_t a = q / (COLS - 1) * COLS + q % (COLS - 1);
        ck_assert_uint_eq(take(1, false), 4);
        ck_assert_uint_eq(take(4, false), a);
        ck_assert_uint_eq(take(4, false), a + COLS);
        ck_assert_uint_eq(take(4, false), a + COLS + 1);
        ck_assert_uint_eq(take(4, false), a + 1);
    }
}
END_TEST

/* ---- CSV -------------------------------------------------------------------- */

START_TEST(csv_gives_the_recorded_numbers_back)
{
    const bool doubles = _i == 1;
    size_t row, col;
    run_scene(doubles ? "double" : "single");
    export_as("r --format csv --frame 3");
    FILE *stream = fopen(OUT "/r/frames/frame-000003.csv", "r");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_eq(fscanf(stream, "row,col,x,y,z,vx,vy,vz\n"), 0);
    for (size_t i = 0; i < N; ++i) {
        double x[6];
        ck_assert_int_eq(fscanf(stream, "%zu,%zu,%lf,%lf,%lf,%lf,%lf,%lf\n", &row, &col,
                                &x[0], &x[1], &x[2], &x[3], &x[4], &x[5]),
                         8);
        ck_assert(row == i / COLS && col == i % COLS);
        for (size_t k = 0; k < 6; ++k) {
            const double wanted
                = k < 3 ? frames[3][3 * i + k] : velocities[3][3 * i + k - 3];
            ck_assert(doubles ? x[k] == wanted : (float)x[k] == (float)wanted);
        }
    }
    (void)fclose(stream);
}
END_TEST

START_TEST(csv_without_recorded_velocities_has_positions_only)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/p --quiet --set record.fields=[]"),
           0);
    export_as("p --format csv --frame 3");
    expect(shell("head -1 " OUT "/p/frames/frame-000003.csv"), 0);
    ck_assert_str_eq(output, "row,col,x,y,z\n");
    export_as("p --format csv"); /* the state at the end has them */
    expect(shell("head -1 " OUT "/p/final.csv"), 0);
    ck_assert_str_eq(output, "row,col,x,y,z,vx,vy,vz\n");
}
END_TEST

/* ---- VTP, PVD --------------------------------------------------------------- */

START_TEST(vtp_blocks_are_where_its_xml_says)
{
    const bool doubles = _i == 1;
    const size_t real = doubles ? 8 : 4;
    char offset[80];
    run_scene(doubles ? "double" : "single");
    export_as("r --format pvd");
    load(OUT "/r/frames/frame-000004.vtp");
    skip_past("NumberOfPoints=\"20\" NumberOfPolys=\"12\"");
    skip_past("Name=\"velocity\" NumberOfComponents=\"3\" format=\"appended\" ");
    (void)snprintf(offset, sizeof offset, "offset=\"%zu\"", 8 + 3 * N * real);
    ck_assert_int_eq(memcmp(bytes + at, offset, strlen(offset)), 0);
    skip_past("<AppendedData encoding=\"raw\">\n_");
    ck_assert_uint_eq(take(8, false), 3 * N * real);
    for (size_t k = 0; k < 3 * N; ++k) {
        ck_assert((doubles ? take_double() : take_float(false)) == frames[4][k]);
    }
    ck_assert_uint_eq(take(8, false), 3 * N * real);
    for (size_t k = 0; k < 3 * N; ++k) {
        ck_assert((doubles ? take_double() : take_float(false)) == velocities[4][k]);
    }
    ck_assert_uint_eq(take(8, false), N * real);
    at += N * real;
    ck_assert_uint_eq(take(8, false), 8 * 4 * QUADS);
    ck_assert_uint_eq(take(8, false), 0);
    ck_assert_uint_eq(take(8, false), COLS);
    at += 8 * (4 * QUADS - 2);
    ck_assert_uint_eq(take(8, false), 8 * QUADS);
    for (size_t q = 1; q <= QUADS; ++q) {
        ck_assert_uint_eq(take(8, false), 4 * q);
    }
}
END_TEST

START_TEST(pvd_lists_every_frame_at_its_time)
{
    char line[256];
    size_t i = 0;
    export_as("r --format pvd");
    FILE *stream = fopen(OUT "/r/run.pvd", "r");
    ck_assert_ptr_nonnull(stream);
    while (fgets(line, sizeof line, stream) != NULL) {
        double time;
        char file[80], path[120];
        if (sscanf(line, "<DataSet timestep=\"%lf\" part=\"0\" file=\"%79[^\"]\"/>",
                   &time, file)
            == 2) {
            (void)snprintf(path, sizeof path, OUT "/r/%s", file);
            ck_assert(exists(path));
            ck_assert(time == times[i++]);
        }
    }
    (void)fclose(stream);
    ck_assert_uint_eq(i, LAST + 1);
}
END_TEST

/* ---- chains, frames left out, frames computed again -------------------------- */

START_TEST(a_chain_is_a_line_in_every_format)
{
    run_chain();
    export_as("c --format obj");
    expect(shell("tail -1 " OUT "/c/final.obj"), 0);
    ck_assert_str_eq(output, "l 1 2 3 4 5\n");
    export_as("c --format ply");
    load(OUT "/c/final.ply");
    skip_past(
        "element edge 4\nproperty int vertex1\nproperty int vertex2\nend_header\n");
    ck_assert_uint_eq(size - at, 20 * COLS + 8 * 4);
    at += 20 * COLS;
    for (size_t i = 0; i < 4; ++i) {
        ck_assert_uint_eq(take(4, false), i);
        ck_assert_uint_eq(take(4, false), i + 1);
    }
    export_as("c --format pvd");
    load(OUT "/c/frames/frame-000000.vtp");
    skip_past("NumberOfLines=\"1\"");
}
END_TEST

START_TEST(frames_have_their_numbers_in_the_run)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/e --quiet --set record.every=4"),
           0);
    export_as("e --format obj --frame all");
    expect(shell("ls " OUT "/e/frames"), 0);
    ck_assert_str_eq(output, "frame-000000.obj\nframe-000004.obj\nframe-000008.obj\n"
                             "frame-000010.obj\n");
    obj_is(OUT "/e/frames/frame-000008.obj", frames[8]);
    expect(shell(WEFT " export " OUT "/e --format obj --frame 7 2>&1"), 2);
    says("recorded");
}
END_TEST

START_TEST(without_a_final_state_the_last_frame_is_taken)
{
    expect(shell("rm " OUT "/r/final.csv"), 0);
    export_as("r --format obj");
    says("frames/frame-000010.obj");
    obj_is(OUT "/r/frames/frame-000010.obj", frames[LAST]);
}
END_TEST

START_TEST(record_final_false_leaves_out_the_final_state_alone)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/f --quiet --set record.final=false && cd " OUT
                      " && test ! -e f/final.csv && cmp f/series.csv r/series.csv && "
                      "cmp f/run.vtkhdf r/run.vtkhdf"),
           0);
    expect(shell(WEFT " diff " OUT "/f " OUT "/r && " WEFT " view " OUT "/f && " WEFT
                      " resume " OUT "/f 2>&1"),
           0);
    says("f: is already done");
    export_as("f --format obj");
    says("f/frames/frame-000010.obj");
    obj_is(OUT "/f/frames/frame-000010.obj", frames[LAST]);
}
END_TEST

/* One digit changed; the state of a longer run. */
START_TEST(a_final_state_that_is_not_that_of_the_result_is_refused)
{
    static const char *const formats[] = { "obj", "ply", "csv" };
    expect(shell("cp " OUT "/r/final.csv " OUT "/good; " WEFT " run " OUT
                 "/small.yaml --out " OUT "/longer --quiet --set run.duration=0.6; sed "
                 "'9s/\\.[0-8]/.9/' " OUT "/good > " OUT "/changed; ! cmp -s " OUT
                 "/good " OUT "/changed"),
           0);
    for (size_t i = 0; i < 6; ++i) {
        expect(shell("cp " OUT "/%s " OUT "/r/final.csv; " WEFT " export " OUT
                     "/r --format %s 2>&1; code=$?; cp " OUT "/good " OUT
                     "/r/final.csv; exit $code",
                     i < 3 ? "changed" : "longer/final.csv", formats[i % 3]),
               4);
        says("/r/final.csv: damaged: its state has hash ");
        says(", that of result.yaml ");
    }
    ck_assert(!exists(OUT "/r/final.obj"));
}
END_TEST

START_TEST(without_run_vtkhdf_frames_are_computed_anew)
{
    static const char *const formats[] = { "mdd", "pc2" };
    for (size_t i = 0; i < 2; ++i) {
        expect(shell(WEFT " export " OUT "/r --format %s && mv " OUT "/r/run.%s " OUT
                          "/kept && mv " OUT "/r/run.vtkhdf " OUT "/away && " WEFT
                          " export " OUT "/r --format %s 2>&1 && mv " OUT "/away " OUT
                          "/r/run.vtkhdf && cmp " OUT "/kept " OUT "/r/run.%s",
                     formats[i], formats[i], formats[i], formats[i]),
               0);
        says("run.vtkhdf is missing: frames are computed again");
    }
}
END_TEST

START_TEST(a_movie_is_of_all_frames)
{
    expect(shell(WEFT " export " OUT "/r --format mdd --frame 3 2>&1"), 2);
    says("mdd holds all frames");
    ck_assert(!exists(OUT "/r/run.mdd"));
}
END_TEST

START_TEST(an_export_that_cannot_be_written_names_the_file_and_why)
{
    static const char *const formats[] = { "obj", "ply", "csv", "mdd", "pc2", "pvd" };
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/big --quiet --set "
                      "cloth.grid.rows=30 --set cloth.grid.cols=30 --set "
                      "run.duration=0.01"),
           0);
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i) {
        expect(shell("ulimit -f 2; " WEFT " export " OUT
                     "/big --format %s --frame all 2>&1",
                     formats[i]),
               4);
        says("weft: error: " OUT "/big/");
        says(": File too large\n");
        expect(shell("find " OUT "/big -name '*.tmp' -o -name '*.%s'", formats[i]), 0);
        ck_assert_ptr_null(strstr(output, ".tmp"));
        ck_assert(strcmp(formats[i], "csv") == 0 || output[0] == '\0');
    }
}
END_TEST

TEST_SUITE(export)
{
    Suite *all = suite_create("export");
    TCase *files = tcase_create("files");
    tcase_add_checked_fixture(files, begin, NULL);
    tcase_set_timeout(files, 60);
    tcase_add_test(files, mdd_holds_times_and_positions_big_endian);
    tcase_add_test(files, pc2_holds_positions_little_endian);
    tcase_add_test(files, obj_has_quads_and_texture_coordinates);
    tcase_add_test(files, the_obj_of_a_cache_is_the_rest_pose);
    tcase_add_test(files, ply_is_binary_and_holds_quads);
    tcase_add_loop_test(files, csv_gives_the_recorded_numbers_back, 0, 2);
    tcase_add_test(files, csv_without_recorded_velocities_has_positions_only);
    tcase_add_loop_test(files, vtp_blocks_are_where_its_xml_says, 0, 2);
    tcase_add_test(files, pvd_lists_every_frame_at_its_time);
    tcase_add_test(files, a_chain_is_a_line_in_every_format);
    tcase_add_test(files, frames_have_their_numbers_in_the_run);
    tcase_add_test(files, without_a_final_state_the_last_frame_is_taken);
    tcase_add_test(files, record_final_false_leaves_out_the_final_state_alone);
    tcase_add_test(files, a_final_state_that_is_not_that_of_the_result_is_refused);
    tcase_add_test(files, without_run_vtkhdf_frames_are_computed_anew);
    tcase_add_test(files, a_movie_is_of_all_frames);
    tcase_add_test(files, an_export_that_cannot_be_written_names_the_file_and_why);
    suite_add_tcase(all, files);
    return all;
}
