/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow together asan-long */
/* test_steppers.c -- the stepper contract (weft/stepper.h), held against every method
 * of every plugin by the checks of weft/conformance.h, and GSL's error handler watched.
 */
#include <string.h>

#include "stepper_run.h"
#include "study/conformance/conformance.h"

START_TEST(every_promise_is_kept)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (size_t i = 0; i < weft_conformance_count() && !test_is_spared(type); ++i) {
        if (strcmp(weft_conformance_name(i), "threads") == 0) {
            continue; /* below */
        }
        const weft_conformance found = weft_conformance_check(type, i);
        ck_assert_msg(found.verdict != WEFT_PROMISE_BROKEN, "%s, %s: %s",
                      test_method_label((size_t)_i), weft_conformance_name(i),
                      found.seen);
        ck_assert_int_eq(found.verdict == WEFT_PROMISE_KEPT, found.seen[0] == '\0');
    }
}
END_TEST

/* So that not everything is left unasked. */
START_TEST(every_promise_is_asked_of_some_method)
{
    bool asked = false, no_heap = false; /* glibc 2.32 and musl do not report it */
    for (size_t m = 0; m < test_method_count() && !asked; ++m) {
        const weft_conformance found
            = weft_conformance_check(test_method(m), (size_t)_i);
        asked = found.verdict == WEFT_PROMISE_KEPT;
        no_heap = strstr(found.seen, "C library does not report") != NULL;
    }
    ck_assert_msg(asked || no_heap, "%s", weft_conformance_name((size_t)_i));
}
END_TEST

/* So late that the steps which the oscillator needs vanish beside t. */
START_TEST(a_step_that_succeeds_moves_the_time)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_is_spared(type)) {
        return;
    }
    weft_stepper_config config = weft__usual(type, 0);
    config.first_step = 1.0;
    trial_run late;
    start(&late, type, &config);
    late.model.k = 1e6;
    late.t = 0x1p50; /* [s] the next number is 0.25 s later */
    for (int i = 0; i < 10; ++i) {
        const double before = late.t;
        if (step(&late, 0x1p50 + 4.0) != WEFT_OK) {
            ck_assert(late.t == before && late.err.message[0] != '\0');
            break;
        }
        ck_assert_msg(late.t > before, "%s stands still",
                      test_method_label((size_t)_i));
        if (late.t == 0x1p50 + 4.0) {
            break;
        }
    }
    end(&late);
}
END_TEST

/* By itself, for ThreadSanitizer (make tsan). */
START_TEST(instances_in_two_threads_do_not_meet)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_is_spared(type)) {
        return;
    }
    size_t i = 0;
    while (strcmp(weft_conformance_name(i), "threads") != 0) {
        ++i;
    }
    const weft_conformance found = weft_conformance_check(type, i);
    ck_assert_msg(found.verdict == WEFT_PROMISE_KEPT, "%s: %s",
                  test_method_label((size_t)_i), found.seen);
}
END_TEST

static void *take_a_turn(void *arg)
{
    double dydt[DIM + APART];
    (void)weft__model_rhs(0.0, weft__model_start, dydt, arg);
    return NULL;
}

/* The waiting thread gives up its turn and its lock in one: seen from here, it waits.
 */
START_TEST(a_dropped_baton_is_not_waited_for)
{
    baton turns
        = { .lock = PTHREAD_MUTEX_INITIALIZER, .passed = PTHREAD_COND_INITIALIZER };
    model waiting = { .k = 1.0, .baton = &turns };
    pthread_t thread;
    ck_assert(pthread_create(&thread, NULL, take_a_turn, &waiting) == 0);
    for (bool waits = false; !waits;) {
        (void)pthread_mutex_lock(&turns.lock);
        waits = turns.turn == 1;
        (void)pthread_mutex_unlock(&turns.lock);
    }
    weft__baton_drop(&turns);
    (void)pthread_join(thread, NULL);
    ck_assert(!turns.late && turns.dropped);
}
END_TEST

TEST_SUITE(steppers)
{
    Suite *suite = suite_create("steppers");
    TCase *promises = tcase_create("promises");
    tcase_set_timeout(promises, 120.0);
    tcase_add_checked_fixture(promises, watch_gsl, gsl_was_silent);
    tcase_add_loop_test(promises, every_promise_is_kept, 0, (int)test_method_count());
    tcase_add_loop_test(promises, a_step_that_succeeds_moves_the_time, 0,
                        (int)test_method_count());
#ifdef HAVE_GSL
    tcase_add_loop_test(promises, every_promise_is_asked_of_some_method, 0,
                        (int)weft_conformance_count());
#endif
    suite_add_tcase(suite, promises);
    TCase *threads = tcase_create("threads");
    tcase_set_timeout(threads, 120.0);
    tcase_add_test(threads, a_dropped_baton_is_not_waited_for);
    tcase_add_loop_test(threads, instances_in_two_threads_do_not_meet, 0,
                        (int)test_method_count());
    suite_add_tcase(suite, threads);
    return suite;
}
