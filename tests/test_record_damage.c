/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* weft resume of runs whose files were changed: refused by name, and nothing is
 * written.
 */
#define OUT BUILD_DIR "/damage"

#include "program/record/checkpoint.h"
#include "stopped_run.h"

static void read_checkpoint(record_checkpoint *checkpoint)
{
    weft_error err;
    ck_assert_msg(record_checkpoint_read(OUT "/k", checkpoint, &err) == WEFT_OK, "%s",
                  err.message);
}

static void write_checkpoint(record_checkpoint *checkpoint)
{
    unsigned char head[RECORD_CHECKPOINT_HEAD];
    record_checkpoint_pack(checkpoint, checkpoint->state_size, head);
    FILE *stream = fopen(checkpoint->path, "r+b");
    ck_assert_ptr_nonnull(stream);
    ck_assert_uint_eq(fwrite(head, 1, sizeof head, stream), sizeof head);
    ck_assert_int_eq(fclose(stream), 0);
    record_checkpoint_close(checkpoint);
}

/* An hour was spent on the part before the checkpoint. */
START_TEST(wall_time_adds_up)
{
    record_checkpoint checkpoint;
    double wall_time = 0.0;
    stop_midway(SIGKILL, "");
    read_checkpoint(&checkpoint);
    ck_assert(checkpoint.wall_time > 0.0);
    checkpoint.wall_time = 3600.0;
    write_checkpoint(&checkpoint);
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    const char *found = strstr(read_file(OUT "/k/result.yaml"), "wall_time: ");
    ck_assert_ptr_nonnull(found);
    ck_assert_int_eq(sscanf(found, "wall_time: %lf", &wall_time), 1);
    ck_assert(wall_time > 3600.0);
}
END_TEST

/* With that exit code and message, and nothing has changed. */
static void refused(int code, const char *text)
{
    (void)shell("cksum " OUT "/k/* > " OUT "/sums");
    expect(shell(WEFT " resume " OUT "/k 2>&1"), code);
    says(text);
    expect(shell("cksum " OUT "/k/* | cmp - " OUT "/sums 2>&1"), 0);
}

START_TEST(another_scene_is_refused)
{
    stop_midway(SIGKILL, "");
    expect(shell("sed -i 's/stiffness: 50/stiffness: 51/' " OUT "/k/scene.yaml"), 0);
    refused(3, "k/scene.yaml is not the scene that checkpoint.weft is of");
    expect(shell("echo 'weft: [' > " OUT "/k/scene.yaml"), 0);
    refused(3, "k/scene.yaml:2:1: error: ");
}
END_TEST

START_TEST(another_version_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGKILL, "");
    read_checkpoint(&checkpoint);
    char minor[32] = "weft " WEFT_VERSION; /* any patch of it may resume */
    *strrchr(minor, '.') = '\0';
    ck_assert_ptr_eq(strstr(checkpoint.program, minor), checkpoint.program);
    ck_assert_ptr_null(strstr(checkpoint.program, WEFT_VERSION));
    (void)snprintf(checkpoint.program, sizeof checkpoint.program, "weft 0.0.1");
    write_checkpoint(&checkpoint);
    char wanted[96] = "k/checkpoint.weft: of weft 0.0.1; this is ";
    refused(4, strcat(wanted, minor));
}
END_TEST

START_TEST(a_damaged_checkpoint_is_refused)
{
    stop_midway(SIGINT, "");
    expect(shell("printf x | dd of=" OUT "/k/checkpoint.weft bs=1 seek=700 "
                 "conv=notrunc 2>&1"),
           0);
    refused(4, "k/checkpoint.weft: damaged: its checksum is wrong");
    expect(shell("truncate -s -8 " OUT "/k/checkpoint.weft"), 0);
    refused(4, "k/checkpoint.weft: damaged: cut off");
    expect(shell("truncate -s 0 " OUT "/k/checkpoint.weft"), 0);
    refused(4, "k/checkpoint.weft: damaged: no checkpoint");
}
END_TEST

START_TEST(records_without_the_frames_of_the_checkpoint_are_refused)
{
    stop_midway(SIGINT, "");
    (void)shell("cp -r " OUT "/k " OUT "/good");
    expect(shell("head -n 5 " OUT "/good/series.csv > " OUT "/k/series.csv"), 0);
    refused(4, "k/series.csv: damaged: up to frame ");
    expect(shell("rm " OUT "/k/series.csv"), 0);
    refused(4, "k/series.csv: No such file");
    expect(shell("cp " OUT "/good/series.csv " OUT "/k; echo broken > " OUT
                 "/k/run.vtkhdf"),
           0);
    refused(4, "k/run.vtkhdf: damaged: it is not the file of checkpoint.weft");
    expect(shell("rm " OUT "/k/run.vtkhdf"), 0);
    refused(4, "k/run.vtkhdf: No such file");
}
END_TEST

START_TEST(a_checkpoint_of_a_shorter_record_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGINT, "");
    read_checkpoint(&checkpoint);
    ++checkpoint.vtkhdf.frames.length;
    write_checkpoint(&checkpoint);
    refused(4, "k/run.vtkhdf: damaged: ");
}
END_TEST

START_TEST(a_damaged_row_of_the_series_is_named)
{
    stop_midway(SIGKILL, "");
    expect(shell("sed -i '4s/,[^,]*/,0.5/2' " OUT "/k/series.csv"), 0);
    refused(4,
            "k/series.csv: damaged: kinetic of frame 2 is 0.5 on line 4 of series.csv "
            "and ");
}
END_TEST

static void flip(const char *name, long at, unsigned bit)
{
    char path[256];
    (void)snprintf(path, sizeof path, OUT "/k/%s", name);
    FILE *stream = fopen(path, "r+b");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_eq(fseek(stream, at, SEEK_SET), 0);
    const int byte = getc(stream);
    ck_assert_int_ne(byte, EOF);
    ck_assert_int_eq(fseek(stream, at, SEEK_SET), 0);
    ck_assert_int_ne(putc(byte ^ (int)(1u << bit), stream), EOF);
    ck_assert_int_eq(fclose(stream), 0);
}

/* In runs of either precision, also where the file lacks frames of the series. */
static const char *const recorded[]
    = { "", "--set record.precision=double", "--set record.every=7" };

enum { RECORDED = sizeof recorded / sizeof recorded[0] };

/* Each in one of the ranges, in turn: first byte, bytes. */
static void refuses_flips(const char *name, const uint64_t range[][2], int ranges)
{
    const int flips = test_rounds(6, 12);
    uint64_t seed = 42;
    char text[64];
    (void)snprintf(text, sizeof text, "k/%s: damaged: ", name);
    for (int i = 0; i < flips; ++i) {
        const uint64_t *in = range[i % ranges];
        const long at = (long)(in[0] + random_word(&seed) % in[1]);
        const unsigned bit = (unsigned)(random_word(&seed) % 8);
        flip(name, at, bit);
        refused(4, text);
        flip(name, at, bit);
    }
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
}

START_TEST(a_flipped_bit_of_the_series_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGKILL, recorded[_i]);
    read_checkpoint(&checkpoint);
    const uint64_t range[][2] = { { 0, checkpoint.series.length } };
    refuses_flips("series.csv", range, 1);
    record_checkpoint_close(&checkpoint);
}
END_TEST

/* In the first page, behind the counts that each frame changes; in what describes the
 * frames; in positions. */
START_TEST(a_flipped_bit_of_the_frames_is_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGKILL, recorded[_i]);
    read_checkpoint(&checkpoint);
    const uint64_t head = checkpoint.vtkhdf.head.length;
    const uint64_t frame = 20 * 3 * (_i == 1 ? 8 : 4); /* [bytes] */
    const uint64_t range[][2] = { { 3000, RECORD_PAGE - 3000 },
                                  { RECORD_PAGE, head - RECORD_PAGE },
                                  { head, checkpoint.vtkhdf.frames.length * frame } };
    refuses_flips("run.vtkhdf", range, 3);
    record_checkpoint_close(&checkpoint);
}
END_TEST

START_TEST(the_frames_of_another_run_are_refused)
{
    make_reference("--set cloth.springs.stretch.stiffness=51");
    stop_midway(SIGKILL, "");
    (void)shell("cp " OUT "/ref/run.vtkhdf " OUT "/k");
    refused(4, "k/run.vtkhdf: damaged: elastic of frame 0 is ");
    make_reference("--set cloth.grid.cols=6");
    (void)shell("cp " OUT "/ref/run.vtkhdf " OUT "/k");
    refused(4, "k/run.vtkhdf: damaged: it is not the file of checkpoint.weft");
}
END_TEST

/* A wall that all particles touch from the start; its distance. */
#define WALL(distance)                                                                 \
    "--set 'contact={friction: 0, shapes: [{shape: plane, at: [0, 0, -" distance       \
    "], normal: [0, 0, 1]}]}' --set stepper.fixed_step=5e-4"

START_TEST(damaged_loads_of_shapes_are_refused)
{
    record_checkpoint checkpoint;
    stop_midway(SIGKILL, WALL("0.003"));
    (void)shell("cp " OUT "/k/shapes.csv " OUT "/good.csv");
    expect(shell("head -n 5 " OUT "/good.csv > " OUT "/k/shapes.csv"), 0);
    refused(4, "k/shapes.csv: damaged: ");
    expect(shell(": > " OUT "/k/shapes.csv"), 0);
    refused(4, "k/shapes.csv: damaged: ");
    expect(shell("rm " OUT "/k/shapes.csv"), 0);
    refused(4, "k/shapes.csv: No such file");
    expect(shell("cp " OUT "/good.csv " OUT "/k/shapes.csv"), 0);
    read_checkpoint(&checkpoint);
    const uint64_t range[][2] = { { 0, checkpoint.shapes.length } };
    refuses_flips("shapes.csv", range, 1);
    record_checkpoint_close(&checkpoint);
}
END_TEST

START_TEST(loads_of_other_shapes_are_refused)
{
    make_reference(WALL("0.0031"));
    stop_midway(SIGKILL, WALL("0.003"));
    (void)shell("cp " OUT "/ref/shapes.csv " OUT "/k");
    refused(4, "k/shapes.csv: damaged: ");
}
END_TEST

START_TEST(the_manifest_is_written_anew)
{
    make_reference("");
    stop_midway(SIGKILL, "");
    (void)shell(": > " OUT "/k/manifest.yaml");
    expect(shell(WEFT " resume " OUT "/k --quiet 2>&1"), 0);
    ends_as_reference();
}
END_TEST

TEST_SUITE(record_damage)
{
    Suite *all = suite_create("damage");
    TCase *others = tcase_create("others");
    tcase_add_checked_fixture(others, begin, NULL);
    tcase_set_timeout(others, 120);
    tcase_add_test(others, wall_time_adds_up);
    tcase_add_test(others, another_scene_is_refused);
    tcase_add_test(others, another_version_is_refused);
    tcase_add_test(others, a_damaged_checkpoint_is_refused);
    tcase_add_test(others, records_without_the_frames_of_the_checkpoint_are_refused);
    tcase_add_test(others, a_checkpoint_of_a_shorter_record_is_refused);
    tcase_add_test(others, a_damaged_row_of_the_series_is_named);
    tcase_add_loop_test(others, a_flipped_bit_of_the_series_is_refused, 0, RECORDED);
    tcase_add_loop_test(others, a_flipped_bit_of_the_frames_is_refused, 0, RECORDED);
    tcase_add_test(others, the_frames_of_another_run_are_refused);
    tcase_add_test(others, damaged_loads_of_shapes_are_refused);
    tcase_add_test(others, loads_of_other_shapes_are_refused);
    tcase_add_test(others, the_manifest_is_written_anew);
    suite_add_tcase(all, others);
    return all;
}
