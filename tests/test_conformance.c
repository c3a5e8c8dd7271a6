/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* test_conformance.c -- weft plugin-test: a broken promise is found and named, and
 * nothing else. The plugins are built from tests/promises and tests/broken. */
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include "base/clock.h"
#include "program/record/child_process.h"
#include "shell.h"
#include "study/conformance/conformance.h"
#include "support.h"

#define PROMISES BUILD_DIR "/tests/promises/weft-"
#define COUNT(a) (sizeof(a) / sizeof(a)[0])
/* By mallinfo2, which does not see the heap of AddressSanitizer. */
#if defined __GLIBC__ && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)                      \
    && !defined __SANITIZE_ADDRESS__
#define HEAP_IS_KNOWN
#endif

static const struct {
    const char *id, *check, *seen;
} broken[] = {
    { "alone", "agree",
      "rhs of part 1 returns 1 from call 1 of a step on: one calls rhs, t = " },
    { "anything", "refusal", "fixed_step -0.001: create returned 'ok'" },
    { "borrows", "allocator", "blocks of config->allocator not given back to it: 1" },
    { "claim", "order", "order 3 is claimed, 2 is measured; within " },
    { "clock", "set back",
      "t and y set back: a step of 0.0005 s gives another result than that of a new" },
    { "crashes", "versions", "it " },
    { "eager", "create", "create called the rhs" },
    { "exits", "versions", "it ended the process with exit code 3" },
    { "forgets", "counts", "a count fell at 0.005" },
    { "chatty", "process",
      "create and all steps succeeded, and *err is 'all is well'" },
    { "chdir", "process", "the current directory was '" },
    { "exports", "process", "the environment variables have changed" },
    { "forks", "process", "a child process is left" },
    { "handler", "process", "signal 8 has another handler" },
    { "masks", "process", "the umask was 022 and is 077" },
    { "opens", "process", " was closed and is open" },
    { "orphan", "process", "a child process is left" },
    { "shuts", "process", "descriptor 0 was open and is closed" },
    { "timer", "process", "a timer is set" },
#ifdef HEAP_IS_KNOWN
    { "hoards", "destroy",
      "bytes more are allocated each time after create, some steps and destroy" },
#endif
    { "late", "landing", "towards 1.3e-07 s ended at 1.3000000000000003e-07 s" },
#ifdef HEAP_IS_KNOWN
    { "leaks", "memory", "bytes more are allocated after 7938 steps" },
    { "loses", "destroy",
      "bytes more are allocated each time after create, some steps and destroy" },
#endif
    { "longer", "failure",
      "rhs returns 1 from call 1 of a step on, and healed: off by 0.0" },
    { "longer", "failure", " at 0.25 s, 0.0001 allowed; without that " },
    { "locale", "process", "the locale was 'C' and is 'C.UTF-8'" },
    { "nan", "failure", "rhs gives NaN from call 1 of a step on: a state that is not" },
    { "needless", "needless", "" },
    { "overrun", "stats", "the caller's struct has 24 bytes, byte 24 was written" },
    { "prints", "versions", "it printed: stepping by 0.001" },
    { "rounding", "process", "the floating-point environment has changed" },
    { "roundoff", "landing", "ended at 5.036466357000002e-05 s" },
    { "shared", "threads", "two instances in two threads: results differ" },
#ifdef HEAP_IS_KNOWN
    { "sulks", "refused",
      "bytes more are allocated each time after all that create must refuse" },
#endif
    { "shuns", "structure", "with a structure create failed: " },
    { "spoils", "failure", "y changed" },
};

START_TEST(a_broken_promise_is_named_with_what_was_seen)
{
    expect(shell("umask 022; " WEFT " plugin-test " PROMISES "%s.so", broken[_i].id),
           1);
    unwrap(21);
    char line[64];
    (void)snprintf(line, sizeof line, "  FAIL %-12s  ", broken[_i].check);
    says(line);
    const char *seen = strstr(strstr(output, line), "seen: ");
    ck_assert_msg(seen != NULL && strstr(seen, broken[_i].seen) != NULL, "%s", output);
}
END_TEST

/* Of tests/promises/mutants.c: each method, and the check that finds its fault. */
static const struct {
    const char *method, *check;
} mutants[] = {
    { "right", NULL },
    { "last_unchecked", "last step" },
    { "cut_shrinks", "cut step" },
    { "velocity_first", "tolerances" },
    { "position_first", "tolerances" },
    { "no_rtol", "tolerances" },
    { "rms_sum", "rms" },
    { "rms_half", "rms" },
    { "rms_max", "rms" },
    { "counts_apart", "quadratures" },
    { "stale_stage", "edited" },
    { "reused_stage", "order" },
    { "stage_times", "order" },
    { "nan_passes", "failure" },
    { "writes_rejected", "failure" },
    { "no_most", "step sizes" },
    { "no_first", "step sizes" },
    { "no_least", "failure" },
    { "adds_up", "landing" },
    { "counts_attempts", "failure" },
    { "starts_over", "needless" },
    { "swapped", "numbers" },
    { "misses_last", "numbers" },
    { "no_integrals", "quadratures" },
    { "no_estimate", "tolerance" },
};

START_TEST(a_fault_of_error_control_is_found)
{
    const weft_registry_def def = { .struct_size = sizeof def, .path = "" };
    weft_registry *registry = NULL;
    weft_error err = { 0 };
    ck_assert_int_eq(weft_registry_create(&def, &registry, &err), WEFT_OK);
    ck_assert_msg(weft_registry_load(registry, PROMISES "mutants.so", &err) == WEFT_OK,
                  "%s", err.message);
    const weft_stepper_type *type
        = weft_plugin_method(weft_registry_at(registry, 0), mutants[_i].method);
    ck_assert_ptr_nonnull(type);
    bool found = false;
    for (size_t i = 0; i < weft_conformance_count(); ++i) {
        const bool meant = mutants[_i].check == NULL
                           || strcmp(mutants[_i].check, weft_conformance_name(i)) == 0;
        if (meant && strcmp(weft_conformance_name(i), "process") != 0) {
            const weft_conformance seen = weft_conformance_check(type, i);
            found = found || seen.verdict == WEFT_PROMISE_BROKEN;
            ck_assert_msg(found == (mutants[_i].check != NULL), "%s: %s",
                          weft_conformance_name(i), seen.seen);
        }
    }
    weft_registry_destroy(registry);
}
END_TEST

START_TEST(a_plugin_that_keeps_all_promises_passes)
{
    static const char *const files[]
        = { PROMISES "working.so", BUILD_DIR "/plugins/weft-verlet.so" };
    expect(shell(WEFT " plugin-test %s --all", files[_i]), 0);
    says("pass exact end ");
    says("meets every requirement");
    ck_assert_ptr_null(strstr(output, "FAIL"));
}
END_TEST

START_TEST(an_equal_finding_is_told_once)
{
    static const char *const ids[] = { "crashes", "prints" };
    expect(shell(WEFT " plugin-test " PROMISES "%s.so", ids[_i]), 1);
    const char *first = strstr(output, "  FAIL ");
    ck_assert_ptr_null(strstr(first + 1, "  FAIL "));
    says("and the same in ");
    expect(shell(WEFT " plugin-test " PROMISES "%s.so --all", ids[_i]), 1);
    first = strstr(output, "  FAIL ");
    ck_assert_ptr_nonnull(strstr(first + 1, "  FAIL "));
}
END_TEST

START_TEST(a_plugin_that_takes_other_memory_is_noted_only)
{
    expect(shell(WEFT " plugin-test " PROMISES "working.so"), 0);
    says("note: with 1 of 1 method it takes no memory from config->allocator");
    says("meets every requirement with 1 method\n");
    expect(shell(WEFT " plugin-test " BUILD_DIR "/plugins/weft-verlet.so"), 0);
    ck_assert_ptr_null(strstr(output, "note"));
}
END_TEST

/* Two minutes: in `make nightly`. */
START_TEST(a_method_that_hangs_costs_two_checks)
{
    if (test_rounds(0, 1) == 0) {
        return;
    }
    expect(shell(WEFT " plugin-test " PROMISES "sleeps.so 2>&1"), 1);
    says("FAIL sleeps/midpoint: ");
    says(" 2 broken, ");
    says("has run for 5 s; it may take 60 s");
    says("the check did not come to an end");
    says("two checks did not come to an end: the rest is skipped");
}
END_TEST

static int sleep_or_compute(void *ctx, size_t computes)
{
    const double from = weft__wall_clock();
    (void)ctx;
    while (weft__wall_clock() < from + 1.5) {
        if (!computes) {
            (void)poll(NULL, 0, 100);
        }
    }
    return 7;
}

static void count_ticks(void *ctx)
{
    ++*(size_t *)ctx;
}

START_TEST(a_child_that_does_nothing_is_ended_and_one_that_computes_is_not)
{
    size_t ticks = 0;
    process child;
    const process_def def = { .work = sleep_or_compute,
                              .ctx = &ticks,
                              .tick = count_ticks,
                              .end_signal = SIGKILL,
                              .seconds = 0.5,
                              .idle = true };
    ck_assert(process_run(&def, 0, &child));
    ck_assert(child.late && WIFSIGNALED(child.status));
    ck_assert_uint_gt(ticks, 0);
    ck_assert(process_run(&def, 1, &child));
    ck_assert(!child.late && WIFEXITED(child.status) && WEXITSTATUS(child.status) == 7);
}
END_TEST

START_TEST(what_is_no_plugin_is_told)
{
    expect(shell(WEFT " plugin-test " BUILD_DIR "/tests/broken/weft-wrongabi.so"), 1);
    says("FAIL plugin refused: ");
    says("it is built for plugin interface 2, this weft has 1");
    expect(shell(WEFT " plugin-test nowhere/weft-x.so 2>&1"), 4);
    says("nowhere/weft-x.so: No such file");
    expect(shell(WEFT " plugin-test 2>&1"), 2);
}
END_TEST

TEST_SUITE(conformance)
{
    Suite *suite = suite_create("conformance");
    TCase *kit = tcase_create("plugin-test");
    tcase_set_timeout(kit, 120.0);
    tcase_add_loop_test(kit, a_broken_promise_is_named_with_what_was_seen, 0,
                        (int)COUNT(broken));
    tcase_add_loop_test(kit, a_fault_of_error_control_is_found, 0, (int)COUNT(mutants));
    tcase_add_loop_test(kit, a_plugin_that_keeps_all_promises_passes, 0, 2);
    tcase_add_loop_test(kit, an_equal_finding_is_told_once, 0, 2);
    tcase_add_test(kit, a_plugin_that_takes_other_memory_is_noted_only);
    tcase_add_test(kit,
                   a_child_that_does_nothing_is_ended_and_one_that_computes_is_not);
    tcase_add_test(kit, what_is_no_plugin_is_told);
    suite_add_tcase(suite, kit);
    kit = tcase_create("hangs");
    tcase_set_timeout(kit, 240.0);
    tcase_add_test(kit, a_method_that_hangs_costs_two_checks);
    suite_add_tcase(suite, kit);
    return suite;
}
