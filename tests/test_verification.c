/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow nightly together asan-long */
/* test_verification.c -- the facts that `make verify` prints, of every method of every
 * plugin that is found; scenes with few particles or cut short, for haste. */
#include <math.h>

#include "study/conformance/oscillators.h"
#include "support.h"
#include "verify/verify.h"

static weft_registry *registry;
static verify_reference references[VERIFY_SCENES];
static char shipped[VERIFY_SHIPPED_MOST][VERIFY_NAME];

static stepper_method method(int i)
{
    stepper_method m;
    ck_assert(method_at(registry, (size_t)i, &m));
    return m;
}

static void check(weft_status status, const weft_error *err)
{
    ck_assert_msg(status == WEFT_OK, "%s", err->message);
}

/* ---- order ----------------------------------------------------------------------- */

static double order(const weft_stepper_type *type, int claimed)
{
    weft_error err = { 0 };
    double measured = 0.0;
    check(weft__order(type, claimed, &measured, &err), &err);
    return measured;
}

START_TEST(every_method_has_the_order_it_claims)
{
    const weft_stepper_type *type = method(_i).type;
    const int claimed = weft__order_claimed(type);
    if (claimed > 0) {
        ck_assert_double_le(fabs(order(type, claimed) - claimed), WEFT__ORDER_BOUND);
    }
}
END_TEST

/* Trees of two weights more than the order also have errors of h^(p+1): with one order
 * too many the ratio is near 2^p only where the method's constants of h^p are not small
 * (those of arkode's tsitouras are: 4.66). It is never that of the claim. */
START_TEST(a_wrong_claim_is_seen)
{
    const weft_stepper_type *type = method(_i).type;
    const int right = weft__order_claimed(type);
    if ((type->flags & WEFT_STEPPER_DENSE) != 0 || test_is_spared(type)) {
        return; /* for haste */
    }
    if (right > 1) {
        ck_assert(isinf(order(type, right - 1)));
    }
    if (right > 0 && right < WEFT__ORDER_MOST) {
        ck_assert_double_gt(fabs(order(type, right + 1) - (right + 1)),
                            WEFT__ORDER_BOUND);
    }
}
END_TEST

/* ---- pairs ----------------------------------------------------------------------- */

START_TEST(the_same_table_in_two_plugins_steps_alike)
{
    const verify_pair *pair = verify_pair_at((size_t)_i);
    weft_error err = { 0 };
    double apart = 0.0;
    const weft_status status = verify_pair_apart(registry, pair, &apart, &err);
    if (status != WEFT_UNSUPPORTED) { /* a plugin is not built */
        check(status, &err);
        ck_assert_double_le(apart, VERIFY_PAIR_BOUND);
    }
}
END_TEST

/* ---- accuracy -------------------------------------------------------------------- */

static void make_references(void)
{
    weft_error err = { 0 };
    for (size_t i = 0; i < VERIFY_SCENES; ++i) {
        const verify_scene *scene = verify_scene_at(i, true);
        check(verify_reference_make(registry, scene, &references[i], &err), &err);
    }
}

static void free_references(void)
{
    for (size_t i = 0; i < VERIFY_SCENES; ++i) {
        verify_reference_free(&references[i]);
    }
}

START_TEST(two_methods_agree_on_the_reference)
{
    const double tolerance = verify_tolerance(references[_i].by[0].method.type);
    ck_assert_ptr_ne(references[_i].by[0].method.type,
                     references[_i].by[1].method.type);
    ck_assert_double_le(references[_i].apart, VERIFY_REFERENCE_BOUND * tolerance);
}
END_TEST

START_TEST(every_adaptive_method_reaches_the_reference)
{
    const stepper_method m = method(_i);
    const bool suits = method_adapts(m.type) && verify_any_damping(m.type)
                       && !test_is_spared(m.type);
    const size_t step = (size_t)test_rounds(2, 1);
    for (size_t i = (size_t)_i % step; i < VERIFY_SCENES && suits; i += step) {
        weft_error err = { 0 };
        verify_accuracy a;
        check(verify_accuracy_of(registry, verify_scene_at(i, true), &m, &references[i],
                                 &a, &err),
              &err);
        ck_assert_double_le(a.error, VERIFY_ERROR_BOUND);
    }
}
END_TEST

/* ---- shipped scenes -------------------------------------------------------------- */

/* Every fourth scene, and in it every eighth method, others in the next; all of them
 * if there is time. Then those of fixed steps too run scenes in which the cloth touches
 * itself, which cost minutes until the step is short enough. */
START_TEST(every_method_runs_every_shipped_scene)
{
    weft_error err = { 0 };
    verify_scene scene;
    verify_frames reference;
    stepper_method m;
    if (_i % test_rounds(4, 1) != 0) {
        return;
    }
    check(
        verify_shipped_reference(registry, shipped[_i], true, &scene, &reference, &err),
        &err);
    for (size_t k = 0; method_at(registry, k, &m); ++k) {
        verify_shipped_result r = { 0 };
        const bool turn = (k + (size_t)_i / 4 + 4) % (size_t)test_rounds(8, 1) == 0;
        const bool slow = reference.touches && !method_adapts(m.type);
        if (turn && (!slow || test_rounds(0, 1) == 1)
            && verify_shipped_suits(m.type, &reference)) {
            const weft_status status
                = verify_shipped_run(registry, &scene, &m, &reference, &r, &err);
            ck_assert_msg(status == WEFT_OK, "%s %s: %s", m.plugin->id, m.type->name,
                          err.message);
            ck_assert_msg(r.energy <= VERIFY_ENERGY_BOUND,
                          "%s %s: energy within %g of what is at play", m.plugin->id,
                          m.type->name, r.energy);
        }
    }
    verify_frames_free(&reference);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name, const TTest *test, size_t count)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 300.0);
    tcase_add_loop_test(tcase, test, 0, (int)count);
    suite_add_tcase(suite, tcase);
    return tcase;
}

TEST_SUITE(verification)
{
    Suite *suite = suite_create("verification");
    stepper_method m;
    size_t methods = 0, pairs = 0;
    registry = verify_registry();
    if (registry == NULL) {
        return NULL;
    }
    while (method_at(registry, methods, &m)) {
        ++methods;
    }
    while (verify_pair_at(pairs) != NULL) {
        ++pairs;
    }
    add_case(suite, "order", every_method_has_the_order_it_claims, methods);
    add_case(suite, "claims", a_wrong_claim_is_seen, methods);
    add_case(suite, "pairs", the_same_table_in_two_plugins_steps_alike, pairs);
    if (method_best(registry, NULL, &m)) { /* else there is nothing to compare */
        TCase *accuracy = add_case(
            suite, "accuracy", every_adaptive_method_reaches_the_reference, methods);
        tcase_add_unchecked_fixture(accuracy, make_references, free_references);
        tcase_add_loop_test(accuracy, two_methods_agree_on_the_reference, 0,
                            VERIFY_SCENES);
        add_case(suite, "shipped", every_method_runs_every_shipped_scene,
                 verify_shipped(shipped));
    }
    return suite;
}
