/* SPDX-License-Identifier: BSD-3-Clause */
/* run.vtkhdf: what is written is read back, also after a kill, damage or a full disk.
 */
#define H5_USE_110_API /* addresses in H5O_info_t */
#include <hdf5.h>

#include "program/record/vtkhdf.h"
#include "run_frames.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#define OUT BUILD_DIR "/record"

enum { ROWS = 4, COLS = 5, N = ROWS * COLS, LAST = 10 };

static const weft_record_def all_single
    = { .fields = { true, true, true }, .every = 1 };
static const weft_record_def all_double
    = { .doubles = true, .fields = { true, true, true }, .every = 1 };

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT "/r");
    write_file(OUT "/small.yaml", small_scene);
}

/* ---- frames written and read in one process --------------------------------- */

/* What was handed over, frame by frame. */
static struct {
    double time[LAST + 1], x[LAST + 1][3 * N], v[LAST + 1][3 * N], strain[LAST + 1][N];
} given;

static weft_cloth *make_cloth(void)
{
    static const weft_pin pins[]
        = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
            { .rows = { -1, -1 }, .cols = { 1, 2 }, .velocity = { 0.0, 0.1, 0.0 } } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS;
    def.cols = COLS;
    def.spacing[0] = 0.1;
    def.spacing[1] = 0.2;
    def.scale = 1.25;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
    def.pins = pins;
    def.pin_count = 2;
    return test_cloth(&def);
}

static void add_frame(const weft_sim *sim, size_t i, record_series *series,
                      record_vtkhdf *frames)
{
    const record_frame frame = { .index = i, .sim = sim };
    weft_error err;
    given.time[i] = weft_sim_time(sim);
    weft_sim_positions(sim, given.x[i]);
    weft_sim_velocities(sim, given.v[i]);
    weft_cloth_strains(weft_sim_cloth(sim), weft_sim_state(sim), given.strain[i]);
    ck_assert_int_eq(record_series_add(series, &frame, &err), WEFT_OK);
    ck_assert_int_eq(record_vtkhdf_add(frames, &frame, &err), WEFT_OK);
}

/* Frames 0 to LAST of a cloth that starts stretched, a twentieth of a second apart. */
static void record(const weft_record_def *wanted)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 1e-3;
    weft_cloth *cloth = make_cloth();
    weft_sim *sim
        = test_sim(cloth, test_method_named("verlet/velocity_verlet"), &config);
    record_series series;
    record_vtkhdf *frames;
    weft_error err;
    const record_vtkhdf_def def = { .directory = OUT "/r",
                                    .cloth = cloth,
                                    .record = wanted,
                                    .last = LAST,
                                    .series = &series };
    ck_assert_int_eq(record_series_open(&series, OUT "/r", 0, NULL, false, &err),
                     WEFT_OK);
    ck_assert_int_eq(record_vtkhdf_create(&def, &frames, &err), WEFT_OK);
    for (size_t i = 0; i <= LAST; ++i) {
        ck_assert_int_eq(weft_sim_advance(sim, (double)i / 20.0, &err), WEFT_OK);
        add_frame(sim, i, &series, frames);
    }
    ck_assert_int_eq(record_vtkhdf_close(frames, &err), WEFT_OK);
    ck_assert_int_eq(record_table_close(&series.table, &err), WEFT_OK);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

/* Equal bit for bit, once they are floats if those were recorded. */
static void same_values(const double *read, const double *wanted, size_t count,
                        bool doubles)
{
    for (size_t k = 0; k < count; ++k) {
        const double value = doubles ? wanted[k] : (double)(float)wanted[k];
        ck_assert_msg(read[k] == value, "value %zu: %.17g instead of %.17g", k, read[k],
                      value);
    }
}

static void same_frame(record_frames *frames, size_t at, size_t i, bool doubles)
{
    double x[3 * N], v[3 * N], strain[N];
    ck_assert(frames->times[at] == given.time[i]);
    ck_assert_uint_eq((size_t)frames->numbers[at], i);
    ck_assert_int_eq(record_frames_positions(frames, at, x, NULL), WEFT_OK);
    ck_assert_int_eq(record_frames_field(frames, WEFT_RECORD_VELOCITY, at, v, NULL),
                     WEFT_OK);
    ck_assert_int_eq(record_frames_field(frames, WEFT_RECORD_STRAIN, at, strain, NULL),
                     WEFT_OK);
    same_values(x, given.x[i], 3 * N, doubles);
    same_values(v, given.v[i], 3 * N, doubles);
    same_values(strain, given.strain[i], N, doubles);
}

START_TEST(frames_read_are_those_written)
{
    const bool doubles = _i == 1;
    record(doubles ? &all_double : &all_single);
    record_frames *frames = open_frames(OUT "/r");
    ck_assert_uint_eq(frames->faces.rows, ROWS);
    ck_assert_uint_eq(frames->faces.cols, COLS);
    ck_assert_uint_eq(frames->count, LAST + 1);
    ck_assert(frames->doubles == doubles);
    for (size_t i = 0; i <= LAST; ++i) {
        same_frame(frames, i, i, doubles);
    }
    for (size_t i = 0; i < N; ++i) {
        const bool pinned = i == 0 || i == 3 * COLS + 1 || i == 3 * COLS + 2;
        ck_assert((frames->pinned != NULL && frames->pinned[i] != 0) == pinned);
    }
    record_frames_close(frames);
}
END_TEST

/* The cloth starts at 1.25 times its size; particle (r, c) rests at 0.2 c, -0.1 r. */
START_TEST(the_rest_pose_is_kept)
{
    record(&all_single);
    record_frames *frames = open_frames(OUT "/r");
    const double *rest = frames->rest;
    for (size_t i = 0; i < N; ++i) {
        ck_assert(rest[3 * i] == 0.2 * (double)(i % COLS));
        ck_assert(rest[3 * i + 1] == -0.1 * (double)(i / COLS));
        ck_assert(rest[3 * i + 2] == 0.0);
    }
    record_frames_close(frames);
}
END_TEST

START_TEST(every_third_frame_and_the_last_are_recorded)
{
    static const size_t numbers[] = { 0, 3, 6, 9, 10 };
    weft_record_def third = all_single;
    third.every = 3;
    record(&third);
    record_frames *frames = open_frames(OUT "/r");
    ck_assert_uint_eq(frames->count, 5);
    for (size_t i = 0; i < 5; ++i) {
        same_frame(frames, i, numbers[i], false);
    }
    record_frames_close(frames);
}
END_TEST

START_TEST(a_field_not_recorded_is_told_apart_from_damage)
{
    const weft_record_def none = { .every = 1 };
    double values[3 * N];
    weft_error err;
    record(&none);
    record_frames *frames = open_frames(OUT "/r");
    ck_assert_int_eq(record_frames_positions(frames, LAST, values, &err), WEFT_OK);
    same_values(values, given.x[LAST], 3 * N, false);
    ck_assert_int_eq(record_frames_field(frames, WEFT_RECORD_VELOCITY, 0, values, &err),
                     WEFT_UNSUPPORTED);
    ck_assert_int_eq(record_frames_field(frames, WEFT_RECORD_STRAIN, 0, values, &err),
                     WEFT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(err.message, "record.fields"));
    ck_assert(frames->pinned == NULL);
    record_frames_close(frames);
}
END_TEST

/* Three particles 1 m apart, the last moved by half a metre: springs 0-1 at rest, 1-2
 * longer by a half, 0-2 by a quarter. */
START_TEST(strain_at_a_particle_is_the_largest_of_its_springs)
{
    weft_cloth_def def = weft_cloth_def_default();
    double y[18] = { 0.0, 1.0, 2.5 }, strain[3];
    def.rows = 1;
    def.cols = 3;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 1.0, .damping = 0.0 };
    def.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 1.0, .damping = 0.0 };
    weft_cloth *cloth = test_cloth(&def);
    weft_cloth_strains(cloth, y, strain);
    ck_assert(strain[0] == 0.25 && strain[1] == 0.5 && strain[2] == 0.5);
    y[2] = 1.5; /* compressed */
    weft_cloth_strains(cloth, y, strain);
    ck_assert(strain[0] == 0.0 && strain[1] == 0.0 && strain[2] == -0.25);
    weft_cloth_destroy(cloth);
    def.springs[WEFT_STRETCH].present = def.springs[WEFT_BEND].present = false;
    cloth = test_cloth(&def);
    weft_cloth_strains(cloth, y, strain);
    ck_assert(strain[0] == 0.0 && strain[2] == 0.0);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- damage ----------------------------------------------------------------- */

static unsigned char bytes[1 << 20];

static size_t load_bytes(void)
{
    FILE *stream = fopen(OUT "/r/run.vtkhdf", "rb");
    ck_assert_ptr_nonnull(stream);
    const size_t size = fread(bytes, 1, sizeof bytes, stream);
    (void)fclose(stream);
    ck_assert_uint_lt(size, sizeof bytes);
    return size;
}

/* Opened and read to its end: all well, or an error that names the file. Returns
 * whether there was one. */
static bool is_refused(size_t size)
{
    record_frames *frames = NULL;
    weft_error err = { 0 };
    double values[3 * N];
    rewrite_file(OUT "/d/run.vtkhdf", bytes, size);
    weft_status status = record_frames_open(OUT "/d", &frames, &err);
    for (size_t i = 0; status == WEFT_OK && i < frames->count; ++i) {
        /* the header may tell of another grid by now */
        ck_assert_uint_eq(frames->faces.particles, N);
        status = record_frames_positions(frames, i, values, &err);
        status = status == WEFT_OK ? record_frames_field(frames, WEFT_RECORD_VELOCITY,
                                                         i, values, &err)
                                   : status;
        status = status == WEFT_OK
                     ? record_frames_field(frames, WEFT_RECORD_STRAIN, i, values, &err)
                     : status;
    }
    record_frames_close(frames);
    if (status != WEFT_OK) {
        ck_assert_msg(strstr(err.message, OUT "/d/run.vtkhdf") != NULL, "%s",
                      err.message);
    }
    return status != WEFT_OK;
}

START_TEST(a_file_cut_off_anywhere_is_refused_by_name)
{
    record(&all_single);
    const size_t size = load_bytes(), cuts = (size_t)test_rounds(60, 200);
    (void)shell("mkdir -p " OUT "/d");
    ck_assert(!is_refused(size));
    for (size_t i = 0; i < cuts; ++i) {
        ck_assert_msg(is_refused(i * size / cuts), "cut at %zu of %zu", i * size / cuts,
                      size);
    }
}
END_TEST

/* Flips within numbers are not seen, those of the structure are; none ends the program.
 */
START_TEST(flipped_bytes_never_end_the_program)
{
    uint64_t seed = 88172645463325252u;
    size_t refused = 0, flips = (size_t)test_rounds(100, 300);
#ifdef __SANITIZE_ADDRESS__
    __lsan_disable(); /* libhdf5 leaks what it has read of some damaged files */
#endif
    record(&all_single);
    const size_t size = load_bytes();
    (void)shell("mkdir -p " OUT "/d");
    for (size_t i = 0; i < flips; ++i) {
        const size_t at = random_word(&seed) % size;
        const unsigned char before = bytes[at];
        bytes[at] ^= (unsigned char)(1 + random_word(&seed) % 255);
        refused += is_refused(size);
        bytes[at] = before;
    }
    ck_assert_uint_gt(refused, 0);
    ck_assert_uint_lt(refused, flips);
}
END_TEST

static size_t place_of(const char *text, size_t length)
{
    for (size_t i = 0; i + length <= 4096; ++i) {
        if (memcmp(bytes + i, text, length) == 0) {
            return i;
        }
    }
    return SIZE_MAX;
}

/* What a kill cannot cut in two: a write within one page of the file. */
START_TEST(the_counts_of_steps_stand_in_the_first_page)
{
    H5O_info_t info;
    record(&all_single);
    (void)load_bytes();
    const hid_t file = H5Fopen(OUT "/r/run.vtkhdf", H5F_ACC_RDONLY, H5P_DEFAULT);
    ck_assert_int_ge(H5Oget_info_by_name2(file, "/VTKHDF/Steps/Values", &info,
                                          H5O_INFO_BASIC | H5O_INFO_HDR, H5P_DEFAULT),
                     0);
    (void)H5Fclose(file);
    const size_t count = place_of("NSteps", sizeof "NSteps");
    ck_assert_uint_lt(count, info.addr);
    ck_assert_uint_le(info.addr - count, 40); /* the rest of its message */
    ck_assert_uint_le(info.addr + info.hdr.space.total, 4096);
}
END_TEST

START_TEST(a_rest_pose_that_is_not_finite_is_refused)
{
    double rest[3 * N] = { 0.0 };
    record_frames *frames = NULL;
    weft_error err;
    rest[3 * N - 1] = (double)NAN;
    record(&all_single);
    const hid_t file = H5Fopen(OUT "/r/run.vtkhdf", H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t set = H5Dopen2(file, "/weft/Rest", H5P_DEFAULT);
    ck_assert_int_ge(
        H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rest), 0);
    (void)H5Dclose(set);
    (void)H5Fclose(file);
    ck_assert_int_eq(record_frames_open(OUT "/r", &frames, &err), WEFT_IO);
    ck_assert_ptr_nonnull(strstr(err.message, "damaged: /weft/Rest is not finite"));
}
END_TEST

START_TEST(export_of_a_damaged_file_names_it)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/x --quiet"), 0);
    expect(shell("echo broken > " OUT "/x/run.vtkhdf; " WEFT " export " OUT
                 "/x --format obj 2>&1"),
           4);
    says(OUT "/x/run.vtkhdf: damaged: no HDF5 file");
    says("weft: error: ");
}
END_TEST

START_TEST(a_file_that_is_never_read_is_given_up)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/x --quiet"), 0);
    expect(shell("ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" BUILD_DIR
                 "/tests/stalled_file.so " WEFT " export " OUT "/x --format obj 2>&1"),
           4);
    says(OUT "/x/run.vtkhdf: not read within 20 s\n");
}
END_TEST

TEST_SUITE(record)
{
    Suite *all = suite_create("record");
    TCase *frames = tcase_create("frames");
    tcase_add_checked_fixture(frames, begin, NULL);
    tcase_set_timeout(frames, 120);
    tcase_add_loop_test(frames, frames_read_are_those_written, 0, 2);
    tcase_add_test(frames, the_rest_pose_is_kept);
    tcase_add_test(frames, every_third_frame_and_the_last_are_recorded);
    tcase_add_test(frames, a_field_not_recorded_is_told_apart_from_damage);
    tcase_add_test(frames, strain_at_a_particle_is_the_largest_of_its_springs);
    tcase_add_test(frames, a_file_cut_off_anywhere_is_refused_by_name);
    tcase_add_test(frames, flipped_bytes_never_end_the_program);
    tcase_add_test(frames, a_rest_pose_that_is_not_finite_is_refused);
    tcase_add_test(frames, export_of_a_damaged_file_names_it);
    tcase_add_test(frames, a_file_that_is_never_read_is_given_up);
    tcase_add_test(frames, the_counts_of_steps_stand_in_the_first_page);
    suite_add_tcase(all, frames);
    return all;
}
