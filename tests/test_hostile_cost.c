/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_hostile_cost.c -- scenes and sweeps made to cost too much are refused at once.
 */
#include <sys/resource.h>
#include <unistd.h>

#include "scene_load.h"
#include "shell.h"

/* [bytes] Libraries count, too: there are many more where SUNDIALS is built with MPI.
 */
static rlim_t mapped(void)
{
    unsigned long pages = 0;
    FILE *stream = fopen("/proc/self/statm", "r");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_eq(fscanf(stream, "%lu", &pages), 1);
    (void)fclose(stream);
    return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

/* Beyond it the process is killed, or out of memory: either fails the test. A tool that
 * watches memory needs more of both. */
static void limit_to(rlim_t seconds, rlim_t megabytes)
{
#ifdef __SANITIZE_ADDRESS__
    const struct rlimit cpu = { 20 * seconds, 20 * seconds };
    (void)megabytes, (void)mapped;
#else
    const struct rlimit cpu = { seconds, seconds };
    const rlim_t all = mapped() + (megabytes << 20);
    const struct rlimit space = { all, all };
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &space), 0);
#endif
    ck_assert_int_eq(setrlimit(RLIMIT_CPU, &cpu), 0);
}

static char *scene_buffer;
static size_t scene_length;

static void add(const char *text)
{
    const size_t length = strlen(text);
    memcpy(scene_buffer + scene_length, text, length + 1);
    scene_length += length;
}

static void grow_to(size_t bytes)
{
    scene_buffer = malloc(bytes + 256);
    ck_assert_ptr_nonnull(scene_buffer);
    scene_length = 0;
    add("weft: 1\n");
}

/* Each names the one before ten times: 10^n nodes. */
static void doubling(size_t i, char *line, size_t size)
{
    (void)snprintf(line, size,
                   i == 0 ? "a%zu: &a%zu [x, x]\n"
                          : "a%zu: &a%zu [*a%zu, *a%zu, *a%zu, *a%zu]\n",
                   i, i, i - 1, i - 1, i - 1, i - 1);
}

static void nested(size_t i, char *line, size_t size)
{
    (void)snprintf(line, size, "%s&a%zu [", i == 0 ? "cloth: " : "", i);
}

static void deeper(size_t i, char *line, size_t size)
{
    (void)snprintf(line, size, "%s{&a%zu a: ", i == 0 ? "cloth: " : "", i);
}

static void rows_of_aliases(size_t i, char *line, size_t size)
{
    (void)snprintf(line, size, i == 0 ? "cloth: [&a [1, 2],\n" : "  *a, *a, *a, *a,\n");
}

START_TEST(a_megabyte_of_nested_anchors_costs_a_second_and_100_mb_at_most)
{
    static void (*const shapes[])(size_t i, char *line, size_t size)
        = { doubling, nested, deeper, rows_of_aliases };
    char line[256];
    grow_to(1 << 20);
    for (size_t i = 0; scene_length < 1 << 20; ++i) {
        shapes[_i](i, line, sizeof line);
        add(line);
    }
    limit_to(1, 100);
    weft_scene *scene = NULL;
    const weft_scene_def def = scene_of_text(scene_buffer);
    ck_assert_int_eq(weft_scene_load(&def, &scene, &found, NULL), WEFT_BAD_SCENE);
    ck_assert_uint_gt(found.errors, 0);
    free(scene_buffer);
}
END_TEST

START_TEST(a_scene_of_mistakes_alone_costs_little)
{
    char line[64];
    grow_to(8 << 20);
    for (size_t i = 0; i < 300000; ++i) {
        (void)snprintf(line, sizeof line, "masse%zu: 1\n", i);
        add(line);
    }
    limit_to(5, 400);
    weft_scene *scene = NULL;
    const weft_scene_def def = scene_of_text(scene_buffer);
    ck_assert_int_eq(weft_scene_load(&def, &scene, &found, NULL), WEFT_BAD_SCENE);
    ck_assert_uint_eq(found.errors, 300000 + 3); /* three required keys are missing */
    free(scene_buffer);
}
END_TEST

static void begin_sweep(void)
{
    grow_to(2 << 20);
    scene_length = 0;
    add(small_scene);
    add("sweep: {");
}

static void add_values(const char *key, size_t count)
{
    char line[64];
    (void)snprintf(line, sizeof line, "%s: [1", key);
    add(line);
    for (size_t i = 1; i < count; ++i) {
        (void)snprintf(line, sizeof line, ", %zu", i + 1);
        add(line);
    }
    add("], ");
}

static void a_billion_runs(void)
{
    begin_sweep();
    add_values("run.fps", 1000);
    add_values("cloth.density", 1000);
    add_values("run.duration", 1000);
}

static void many_runs_of_a_large_scene(void)
{
    begin_sweep();
    add_values("run.fps", 300);
    add_values("run.duration", 300);
    add("}\nx: {");
    add_values("y", 100000);
}

/* 200 values of 1000 nodes each, written once. */
static void many_runs_with_a_large_value(void)
{
    begin_sweep();
    add("cloth.loads: [&a [");
    for (size_t i = 0; i < 1000; ++i) {
        add("0, ");
    }
    add("]");
    for (size_t i = 1; i < 200; ++i) {
        add(", *a");
    }
    add("], ");
    add_values("run.fps", 200);
}

static void nested_values(void)
{
    begin_sweep();
    add("cloth.loads: [");
    for (size_t i = 0; scene_length < 1 << 20; ++i) {
        char line[64];
        nested(i + 1, line, sizeof line);
        add(line);
    }
}

static void a_value_that_doubles(void)
{
    begin_sweep();
    add("a0: [&a0 [1, 1]], ");
    for (size_t i = 1; i < 990; ++i) {
        char line[128];
        (void)snprintf(line, sizeof line, "a%zu: [&a%zu [*a%zu, *a%zu]], ", i, i, i - 1,
                       i - 1);
        add(line);
    }
}

static const struct {
    void (*write)(void);
    const char *text;
} sweeps[] = {
    { a_billion_runs, "more than 100000 combinations" },
    { many_runs_of_a_large_scene, "90000 runs of a scene of 1000" },
    { many_runs_with_a_large_value, "40000 runs of a scene of 10" },
    { nested_values, "nested more than 32 deep" },
    { a_value_that_doubles, "anchors expand to more than 1000000 nodes" },
};

START_TEST(a_sweep_that_is_too_much_costs_a_second_and_100_mb_at_most)
{
    sweeps[_i].write();
    add("}\n");
    limit_to(1, 100);
    weft_sweep *sweep = NULL;
    const weft_scene_def def = scene_of_text(scene_buffer);
    ck_assert_int_eq(weft_sweep_load(&def, &sweep, &found, NULL), WEFT_BAD_SCENE);
    ck_assert_msg(strstr(all_found(), sweeps[_i].text) != NULL, "%s", all_found());
    free(scene_buffer);
}
END_TEST

TEST_SUITE(hostile_cost)
{
    Suite *suite = suite_create("hostile cost");
    TCase *tcase = tcase_create("cost");
    tcase_set_timeout(tcase, 300.0);
    tcase_add_loop_test(
        tcase, a_megabyte_of_nested_anchors_costs_a_second_and_100_mb_at_most, 0, 4);
    tcase_add_loop_test(tcase,
                        a_sweep_that_is_too_much_costs_a_second_and_100_mb_at_most, 0,
                        (int)(sizeof sweeps / sizeof sweeps[0]));
    tcase_add_test(tcase, a_scene_of_mistakes_alone_costs_little);
    suite_add_tcase(suite, tcase);
    return suite;
}
