/* SPDX-License-Identifier: BSD-3-Clause */
/* support.h -- shared by the tests. */
#pragma once

#include <check.h>

/* Check writes the place of every assertion that holds into a file, lest a crash comes
 * next: most of the time of a test that compares many numbers. */
#define _mark_point(file, line) ((void)0)

#include "weft/weft.h"

/* The i-th plugin linked into the tests; NULL past the last. */
const weft_plugin *test_plugin(size_t i);

/* All methods of all linked plugins, in order. */
size_t test_method_count(void);
const weft_stepper_type *test_method(size_t i);
const char *test_method_label(size_t i); /* "gsl/rkf45" */

/* A method by label; ends the test if it is not there. */
const weft_stepper_type *test_method_named(const char *name);

/* Whether a method refuses lightly damped cloth, such as that of most tests; and
 * equations without a structure. */
bool test_needs_damping(const weft_stepper_type *type);
bool test_needs_structure(const weft_stepper_type *type);
/* Whether a method refuses fixed_step, which test_config makes a max_step. */
bool test_adaptive_only(const weft_stepper_type *type);

/* For a method that takes a table and has none: Merson's, of order 4, which compares
 * its solution with one of order 3. */
weft_stepper_config test_config(const weft_stepper_type *type,
                                weft_stepper_config config);

/* Made from a definition; ends the test on failure. */
weft_cloth *test_cloth(const weft_cloth_def *def);
weft_sim *test_sim(const weft_cloth *cloth, const weft_stepper_type *method,
                   const weft_stepper_config *config);

/* Sets a locale whose numbers have commas: an installed one, or one that is made in the
 * build directory from the sources of Debian's package `locales`. False: there is none,
 * and the test may end. A test runs in its own process. */
bool test_comma_locale(void);

/* A hash of the bits of so many numbers. */
uint64_t test_hash(const double *values, size_t count);

/* TEST_SUITE(cloth) { ... return suite; } ends tests/test_cloth.c; tests/run.c runs it
 * as `run cloth`. NULL is a suite that cannot be made, which fails. */
#define TEST_SUITE(name)                                                               \
    Suite *name##_suite(void);                                                         \
    Suite *name##_suite(void)

/* Whether a method is left to `make nightly`: ARKODE's tables with an error estimate
 * are run by the same code, explicit ones and implicit ones, so that a few of each do:
 * of the lowest and the highest order, and one that reuses its last stage. So are some
 * whose code another method shares but for its table. The orders of all are tested
 * always. */
bool test_is_spared(const weft_stepper_type *type);

/* Whether a method is one of a few whose steps are made differently, or `make nightly`
 * asks for all: where what is tested is what surrounds a step. */
bool test_is_typical(const weft_stepper_type *type);

/* `few`, or `many` in `make nightly`, which sets TEST_LONG: of repetitions whose
 * moments or places differ. */
int test_rounds(int few, int many);

/* A case of the suite for tests that compute for long where shorter ones run the same
 * code; asan leaves it to `make nightly`. [s] */
TCase *test_long(Suite *suite, double timeout);

/* Runs the suite, prints Check's summary, returns the exit status. */
int test_run(Suite *suite);
