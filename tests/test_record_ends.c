/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* run.vtkhdf of runs that are killed, interrupted, fail or find no room, and while they
 * go on. */
#include <float.h>
#include <hdf5.h>
#include <math.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "program/record/record.h"
#include "run_frames.h"

#define OUT BUILD_DIR "/record-ends"

enum {
    N = 20,           /* particles of the small scene */
    LONGEST_ROW = 256 /* [B] of its series.csv, or more */
};

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT "/r");
    write_file(OUT "/small.yaml", small_scene);
}

/* A run of 1000 frames with a step each: more of its time goes into frames than in any
 * real one. */
#define MANY_FRAMES "--set run.fps=1000 --set run.duration=1 --quiet"

static double reference[1001][3 * N];

static void make_reference(void)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/ref " MANY_FRAMES), 0);
    record_frames *frames = open_frames(OUT "/ref");
    ck_assert_uint_eq(frames->count, 1001);
    for (size_t i = 0; i < 1001; ++i) {
        ck_assert_int_eq(record_frames_positions(frames, i, reference[i], NULL),
                         WEFT_OK);
    }
    record_frames_close(frames);
}

static size_t whole_rows(const char *series)
{
    expect(shell("tail -n +2 %s | wc -l", series), 0);
    return (size_t)atoi(output);
}

/* VTK takes one frame for another where there are not exactly NSteps times. */
static void has_a_time_for_each_step(const char *directory)
{
    char path[256];
    int64_t steps = -1;
    (void)snprintf(path, sizeof path, "%s/run.vtkhdf", directory);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t count
        = H5Aopen_by_name(file, "/VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t values = H5Dopen2(file, "/VTKHDF/Steps/Values", H5P_DEFAULT);
    const hid_t space = H5Dget_space(values);
    ck_assert_int_ge(H5Aread(count, H5T_NATIVE_INT64, &steps), 0);
    ck_assert_int_eq(H5Sget_simple_extent_npoints(space), steps);
    (void)H5Sclose(space);
    (void)H5Dclose(values);
    (void)H5Aclose(count);
    (void)H5Fclose(file);
}

/* All that was committed is as in a run that nobody disturbed, and series.csv has the
 * same frames, or one more. Returns how many frames there are. */
static size_t is_part_of_reference(const char *directory)
{
    char series[256];
    double x[3 * N];
    record_frames *frames = open_frames(directory);
    const size_t count = frames->count;
    for (size_t i = 0; i < count; ++i) {
        ck_assert(frames->times[i] == (double)i / 1000.0);
        ck_assert_uint_eq((size_t)frames->numbers[i], i);
        ck_assert_int_eq(record_frames_positions(frames, i, x, NULL), WEFT_OK);
        ck_assert_int_eq(memcmp(x, reference[i], sizeof x), 0);
    }
    record_frames_close(frames);
    has_a_time_for_each_step(directory);
    (void)snprintf(series, sizeof series, "%s/series.csv", directory);
    const size_t rows = whole_rows(series);
    ck_assert_msg(rows == count || rows == count + 1, "%zu rows, %zu frames", rows,
                  count);
    return count;
}

static pid_t start_run(void)
{
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        (void)execl(WEFT, "weft", "run", OUT "/small.yaml", "--out", OUT "/k",
                    "--quiet", "--force", "--set", "run.fps=1000", "--set",
                    "run.duration=1", (char *)NULL);
        _exit(127);
    }
    return child;
}

static void sleep_for(long microseconds)
{
    const struct timespec t = { .tv_nsec = 1000 * microseconds };
    (void)nanosleep(&t, NULL);
}

static bool is_over(pid_t child)
{
    siginfo_t info = { 0 };
    ck_assert_int_eq(waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT), 0);
    return info.si_pid == child;
}

/* Until there is a file with at least so many rows of the series, or the run is over.
 */
static void wait_for_frames(pid_t child, size_t rows)
{
    struct stat series;
    const off_t least = (off_t)(rows * LONGEST_ROW);
    while (!exists(OUT "/k/run.vtkhdf") || stat(OUT "/k/series.csv", &series) != 0
           || series.st_size < least) {
        if (is_over(child)) {
            ck_assert(exists(OUT "/k/run.vtkhdf"));
            return;
        }
        sleep_for(200);
    }
}

/* Each after a number of frames that is chosen; every fourth kill may come before there
 * is a file. */
START_TEST(after_a_kill_at_any_moment_all_committed_frames_are_there)
{
    uint64_t seed = 2463534242u;
    size_t frames = 0, least = 0, missing = 0;
    const int kills = test_rounds(12, 100);
    make_reference();
    for (int i = 0; i < kills; ++i) {
        (void)unlink(OUT "/k/run.vtkhdf");
        const size_t rows = i % 4 == 0 ? 0 : random_word(&seed) % 400;
        const pid_t child = start_run();
        if (i % 4 != 0) {
            wait_for_frames(child, rows);
            least += rows;
        }
        sleep_for((long)(random_word(&seed) % (i % 4 == 0 ? 30000 : 1000)));
        (void)kill(child, SIGKILL);
        ck_assert_int_eq(waitpid(child, NULL, 0), child);
        if (exists(OUT "/k/run.vtkhdf")) {
            frames += is_part_of_reference(OUT "/k");
        } else {
            ++missing;
        }
    }
    /* of the rows one is the names, and one may be ahead of its frame */
    ck_assert_uint_ge(frames + 2 * (size_t)kills, least);
    ck_assert_uint_le(missing, (size_t)kills / 4);
}
END_TEST

START_TEST(a_file_can_be_read_while_it_grows)
{
    size_t count = 0;
    make_reference();
    const pid_t child = start_run();
    wait_for_frames(child, 0);
    while (waitpid(child, NULL, WNOHANG) == 0) {
        record_frames *frames = open_frames(OUT "/k");
        ck_assert_uint_ge(frames->count, count);
        count = frames->count;
        record_frames_close(frames);
    }
    ck_assert_uint_eq(is_part_of_reference(OUT "/k"), 1001);
}
END_TEST

START_TEST(an_interrupted_run_leaves_its_frames_closed)
{
    int status;
    make_reference();
    const pid_t child = start_run();
    wait_for_frames(child, 0);
    sleep_for(5000);
    (void)kill(child, SIGINT);
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status));
    ck_assert(WEXITSTATUS(status) == 130 || WEXITSTATUS(status) == 0);
    const size_t frames = is_part_of_reference(OUT "/k");
    expect(shell("grep '^frames: %zu$' " OUT "/k/result.yaml", frames), 0);
    ck_assert(!exists(OUT "/k/run.vtkhdf.tmp"));
}
END_TEST

START_TEST(a_run_that_fails_leaves_the_frames_before)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/f --quiet --set "
                      "stepper.fixed_step=0.05 --set run.duration=50 2>&1"),
           1);
    record_frames *frames = open_frames(OUT "/f");
    expect(shell("grep '^frames: %zu$' " OUT "/f/result.yaml", frames->count), 0);
    record_frames_close(frames);
}
END_TEST

/* Velocity Verlet beyond its stable step: positions of 1e150 m before it fails. */
#define BLOWS_UP                                                                       \
    " --set stepper.fixed_step=0.05 --set run.duration=50 --set run.fps=2 --quiet "

START_TEST(a_run_that_blows_up_can_be_read_in_all_its_frames)
{
    static const char *const precisions[] = { "single", "double" };
    static const char *const formats[] = { "obj", "ply", "csv", "mdd", "pc2", "pvd" };
    for (size_t k = 0; k < 2; ++k) {
        expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/%s" BLOWS_UP
                          "--set record.precision=%s 2>&1",
                     precisions[k], precisions[k]),
               1);
        expect(shell(WEFT " view " OUT "/%s 2>&1", precisions[k]), 0);
        for (size_t f = 0; f < sizeof formats / sizeof formats[0]; ++f) {
            expect(shell(WEFT " export " OUT "/%s --frame all --format %s 2>&1",
                         precisions[k], formats[f]),
                   0);
        }
    }
    expect(shell(WEFT " diff " OUT "/single " OUT "/double --tol 0 2>&1"), 0);
    says("equal");
}
END_TEST

START_TEST(what_is_beyond_single_precision_is_its_largest_number)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/f" BLOWS_UP "2>&1"), 1);
    record_frames *frames = open_frames(OUT "/f");
    const size_t last = frames->count - 1;
    double x[3 * N], most = 0.0;
    ck_assert_int_eq(record_frames_positions(frames, last, x, NULL), WEFT_OK);
    for (size_t i = 0; i < sizeof x / sizeof x[0]; ++i) {
        ck_assert(fabs(x[i]) <= (double)FLT_MAX);
        most = fmax(most, fabs(x[i]));
    }
    ck_assert(most == (double)FLT_MAX);
    record_frames_close(frames);
    ck_assert(record_single(1e300) == FLT_MAX && record_single(-1e300) == -FLT_MAX);
    ck_assert(record_single(-HUGE_VAL) == -FLT_MAX && record_single(0.5) == 0.5f);
}
END_TEST

/* How to get a file system of one's own; NULL: not possible here. */
static const char *can_mount(void)
{
    expect(shell("mkdir -p " OUT "/disk"), 0);
    const char *alone = shell("unshare -m true 2>&1") == 0     ? "unshare -m"
                        : shell("unshare -Urm true 2>&1") == 0 ? "unshare -Urm"
                                                               : NULL;
    if (alone == NULL
        || shell("%s mount -t tmpfs -o size=1m none " OUT "/disk 2>&1", alone) != 0) {
        puts("skipped: no file system can be mounted to be filled");
        return NULL;
    }
    return alone;
}

/* A file system that is too small; where none can be made, nothing is tested. */
START_TEST(a_full_disk_keeps_the_frames_before)
{
    const char *alone = can_mount();
    if (alone == NULL) {
        return;
    }
    const int code
        = shell("%s sh -c 'mount -t tmpfs -o size=1m none " OUT "/disk; " WEFT
                " run " OUT "/small.yaml --out " OUT
                "/disk/r --quiet --set cloth.grid.rows=40 --set cloth.grid.cols=40 "
                "--set run.fps=1000; code=$?; cp " OUT "/disk/r/run.vtkhdf " OUT
                "/r/; exit $code' 2>&1",
                alone);
    expect(code, 4);
    says(OUT "/disk/r/"); /* run.vtkhdf or series.csv, whichever needs the next page */
    says(": No space left on device");
    record_frames *frames = open_frames(OUT "/r");
    ck_assert_uint_gt(frames->count, 5);
    ck_assert_uint_lt(frames->count, 501);
    record_frames_close(frames);
}
END_TEST

/* At every size: with no frame, with some of them, with all but the final state. */
START_TEST(after_a_full_disk_a_run_goes_on_to_the_same_bytes)
{
    const char *alone = can_mount();
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/ref --quiet --set run.checkpoint=2"),
           0);
    for (int size = 16; alone != NULL && size <= 72; size += 8) {
        expect(
            shell("%s sh -c 'mount -t tmpfs -o size=%dk none " OUT "/disk; " WEFT
                  " run " OUT "/small.yaml --out " OUT
                  "/disk/r --quiet --set run.checkpoint=2; code=$?; test $code = 0 || "
                  "test $code = 4 || exit 99; mount -o remount,size=1m " OUT "/disk; "
                  "test $code = 0 || grep -q \"status: io_error\" " OUT
                  "/disk/r/result.yaml || test ! -e " OUT "/disk/r/result.yaml || exit "
                  "98; test ! -e " OUT "/disk/r/scene.yaml || " WEFT
                  " resume --quiet " OUT "/disk/r || exit 97; cd " OUT "; for f in "
                  "series.csv final.csv run.vtkhdf; do test ! -e disk/r/scene.yaml || "
                  "cmp ref/$f disk/r/$f || exit 96; done' 2>&1",
                  alone, size),
            0);
    }
}
END_TEST

START_TEST(a_file_that_cannot_be_made_is_named)
{
    expect(shell("mkdir -p " OUT "/u/run.vtkhdf.tmp/x; " WEFT " run " OUT
                 "/small.yaml --out " OUT "/u --force --quiet 2>&1"),
           4);
    says(OUT "/u/run.vtkhdf: Is a directory");
    expect(shell("grep -c 'status: io_error' " OUT "/u/result.yaml"), 0);
    expect(shell("ulimit -f 8; " WEFT " run " OUT "/small.yaml --out " OUT
                 "/v --quiet 2>&1"),
           4);
    says(OUT "/v/run.vtkhdf: File too large");
    expect(shell("mkdir -p " OUT "/w/final.csv.tmp/x; " WEFT " run " OUT
                 "/small.yaml --out " OUT "/w --force --quiet --view 2>&1"),
           4);
    says(OUT "/w/final.csv: Is a directory");
    expect(shell("grep -c 'status: io_error' " OUT "/w/result.yaml; test ! -e " OUT
                 "/w/run.html"),
           0);
    record_frames *frames = open_frames(OUT "/w");
    ck_assert_uint_eq(frames->count, 11);
    record_frames_close(frames);
}
END_TEST

START_TEST(a_run_that_could_not_write_is_unfinished_and_goes_on)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/ref --quiet"), 0);
    expect(shell("mkdir -p " OUT "/w/final.csv.tmp/x; " WEFT " run " OUT
                 "/small.yaml --out " OUT "/w --force --quiet 2>&1"),
           4);
    expect(shell("rm -r " OUT "/w/final.csv.tmp; " WEFT " run " OUT
                 "/small.yaml --out " OUT "/w 2>&1"),
           4);
    says("/w: holds an unfinished run: 'weft resume " OUT "/w' continues it");
    expect(shell(WEFT " export " OUT "/w --format obj 2>&1"), 0);
    says("/w: unfinished: 11 of 11 frames\n");
    expect(shell("rm -r " OUT "/w/frames; " WEFT " resume " OUT "/w --quiet && rm " OUT
                 "/?*/result.yaml && diff -r " OUT "/ref " OUT "/w 2>&1"),
           0);
}
END_TEST

/* Each run holds its own directory, wherever it is moved. */
START_TEST(a_run_whose_directory_was_replaced_leaves_the_other_one_alone)
{
    static const char *const checkpoints[] = { "0", "7" };
    for (size_t i = 0; i < 2; ++i) {
        expect(
            shell("rm -rf " OUT "/d " OUT "/moved; " WEFT " run " OUT
                  "/small.yaml --out " OUT "/d --quiet --set run.duration=1e5 --set "
                  "run.checkpoint=%s 2>" OUT "/err & pid=$!; until [ $(cat " OUT
                  "/d/series.csv 2>/dev/null | wc -l) -gt 5 ]; do sleep 0.01; done; "
                  "mv " OUT "/d " OUT "/moved; " WEFT " run " OUT
                  "/small.yaml --out " OUT "/d --quiet; cksum " OUT "/d/* > " OUT
                  "/sums; kill -TERM $pid 2>/dev/null; wait $pid; code=$?; cksum " OUT
                  "/d/* | cmp - " OUT "/sums && exit $code",
                  checkpoints[i]),
            4);
        expect(shell("cat " OUT "/err; ls " OUT "/moved"), 0);
        /* a checkpoint may come before the other directory is there */
        says(i == 0
                 ? "/d: another directory than that of this run, which was moved away"
                 : "/d: ");
        ck_assert_ptr_null(strstr(output, "result.yaml"));
    }
}
END_TEST

START_TEST(frames_beyond_the_room_of_the_file_are_refused_at_once)
{
    static const char *const verbs[] = { "check", "run --out " OUT "/big" };
    for (size_t i = 0; i < 2; ++i) {
        expect(shell(WEFT " %s " OUT "/small.yaml --set run.duration=1e5 --set "
                          "cloth.grid.rows=300 --set cloth.grid.cols=300 2>&1",
                     verbs[i]),
               3);
        says("run.vtkhdf has room for 1744902 frames of this cloth, and the scene "
             "plans 2000001: record.every must be larger");
    }
    ck_assert(!exists(OUT "/big"));
    expect(shell(WEFT " check " OUT "/small.yaml --set run.duration=1e5 --set "
                      "cloth.grid.rows=50 --set cloth.grid.cols=50 --set "
                      "record.every=10 2>&1"),
           0);
    says("frames, run.vtkhdf ");
    says("weft: warning: run.vtkhdf has 200001 frames and ");
}
END_TEST

/* Sanitizers need terabytes of it; in the lack of it libhdf5 1.10.6 crashes by itself.
 */
#if !defined __SANITIZE_ADDRESS__ && H5_VERSION_GE(1, 10, 7)
#define SHORT_MEMORY
/* Address space from too little for libhdf5 to enough for the run. */
START_TEST(short_memory_is_told_and_crashes_nothing)
{
    int told = 0, done = 0, code = 0;
    for (int kilobytes = 20000; kilobytes < 200000 && done < 3;
         kilobytes += code == 99 ? 1000
                      : told > 0 ? 250
                                 : 50) {
        code = shell("ulimit -v %d; (" WEFT " --version) >/dev/null 2>&1 || exit "
                     "99; " WEFT " run " OUT "/small.yaml --out " OUT
                     "/v --force --quiet 2>&1",
                     kilobytes);
        if (code == 99) { /* too little to load the program; the loader may crash */
            continue;
        }
        ck_assert_msg(code < 128, "exit code %d with %d kB", code, kilobytes);
        told += strstr(output, "/v/run.vtkhdf: Cannot allocate memory") != NULL;
        done += code == 0;
        ck_assert_ptr_null(strstr(output, "write failed"));
    }
    ck_assert_int_gt(told, 0);
    ck_assert_int_gt(done, 0);
}
END_TEST
#endif

START_TEST(the_same_scene_gives_the_same_file)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/a --quiet && " WEFT
                      " run " OUT "/small.yaml --out " OUT "/b --quiet && cmp " OUT
                      "/a/run.vtkhdf " OUT "/b/run.vtkhdf"),
           0);
}
END_TEST

/* The run of the small scene in which a write fails. */
static int run_failing(const char *which, int n)
{
    return shell("ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" BUILD_DIR
                 "/tests/failing_write.so %s=%d " WEFT " run " OUT
                 "/small.yaml --out " OUT "/f --force --quiet 2>&1",
                 which, n);
}

/* All of them if there is time; else those of the head, some of each frame, the last.
 */
START_TEST(each_write_of_the_frames_that_fails_is_told)
{
    int n = 1;
    while (run_failing("FAIL_PWRITE", n) == 4) {
        n += n < 20 ? 1 : test_rounds(17, 1);
    }
    ck_assert_int_gt(n, 20);
    for (int more = n; more < n + 5; ++more) {
        expect(run_failing("FAIL_PWRITE", more), 0);
    }
    for (int told = 0; told < 5; --n) { /* the file has n - 1 writes */
        const int code = run_failing("FAIL_PWRITE", n - 1);
        ck_assert(code == 4 || (code == 0 && told == 0));
        told += code == 4;
    }
}
END_TEST

START_TEST(a_run_ends_although_it_cannot_write_to_its_own_pipe)
{
    expect(run_failing("FAIL_PIPE", 1), 0);
}
END_TEST

TEST_SUITE(record_ends)
{
    Suite *all = suite_create("record ends");
    TCase *runs = tcase_create("runs");
    tcase_add_checked_fixture(runs, begin, NULL);
    tcase_set_timeout(runs, 120);
    tcase_add_test(runs, after_a_kill_at_any_moment_all_committed_frames_are_there);
    tcase_add_test(runs, a_file_can_be_read_while_it_grows);
    tcase_add_test(runs, an_interrupted_run_leaves_its_frames_closed);
    tcase_add_test(runs, a_run_that_fails_leaves_the_frames_before);
    tcase_add_test(runs, a_run_that_blows_up_can_be_read_in_all_its_frames);
    tcase_add_test(runs, what_is_beyond_single_precision_is_its_largest_number);
    tcase_add_test(runs, a_full_disk_keeps_the_frames_before);
    tcase_add_test(runs, after_a_full_disk_a_run_goes_on_to_the_same_bytes);
    tcase_add_test(runs, a_file_that_cannot_be_made_is_named);
    tcase_add_test(runs, each_write_of_the_frames_that_fails_is_told);
    tcase_add_test(runs, a_run_ends_although_it_cannot_write_to_its_own_pipe);
    tcase_add_test(runs, a_run_that_could_not_write_is_unfinished_and_goes_on);
    tcase_add_test(runs, a_run_whose_directory_was_replaced_leaves_the_other_one_alone);
    tcase_add_test(runs, frames_beyond_the_room_of_the_file_are_refused_at_once);
#ifdef SHORT_MEMORY
    tcase_add_test(runs, short_memory_is_told_and_crashes_nothing);
#endif
    tcase_add_test(runs, the_same_scene_gives_the_same_file);
    suite_add_tcase(all, runs);
    return all;
}
