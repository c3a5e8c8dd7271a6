/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow together asan-long */
/* test_ledger_order.c -- the energy ledger closes as well as its method integrates, and
 * keeping it changes nothing else. */
#include "ledger_run.h"

/* The largest residual [J] of 16 frames up to 1 s. */
static double largest_residual(const weft_stepper_type *type,
                               weft_stepper_config config)
{
    double most = 0.0;
    weft_sim *run = make(type, config, true);
    for (int frame = 1; frame <= 16; ++frame) {
        go(run, frame / 16.0);
        most = fmax(most, fabs(weft_sim_ledger(run).residual));
    }
    weft_sim_destroy(run);
    return most;
}

/* Over the last three halvings of h before roundoff shows. */
START_TEST(residual_is_of_the_order_of_the_method)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    const int order = type->order == 0 ? 4 : type->order; /* custom: test_config's */
    double residual[8];
    int count = 0;
    if (!keeps(type) || test_is_spared(type)) {
        return;
    }
    all_at_once();
    /* high orders are soon at roundoff, which the large weights of some tables magnify:
     * Verner's 6(5) of nine stages, rounded as it is in SUNDIALS, leaves 5e-13 J */
    for (int steps = 16; steps <= 2048 && count < 8; steps *= 2) {
        residual[count] = largest_residual(type, fixed(1.0 / steps));
        if (residual[count] < (order < 6 ? 5e-15 : 1e-12)) {
            break;
        }
        ++count;
    }
    ck_assert_int_ge(count, order < 6 ? 3 : 2);
    const int first = count > 4 ? count - 4 : 0;
    const double slope
        = log2(residual[first] / residual[count - 1]) / (count - 1 - first);
    ck_assert_msg(slope >= order - 0.3, "%s: %.2f", type->name, slope);
}
END_TEST

/* Where a step's error of order q + 1 meets the tolerance, h ~ tol^(1 / (q + 1)), and
 * the residual ~ h^p. */
START_TEST(residual_shrinks_with_the_tolerance)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool custom = type->order == 0;
    const double p = custom ? 4 : type->order, q = custom ? 3 : type->error_order;
    const double low = p < 3 ? 1e-6 : 1e-10;
    if (!keeps(type) || (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0
        || test_is_spared(type)) {
        return;
    }
    all_at_once();
    const double rough = largest_residual(type, tolerance(1e-4));
    const double sharp = largest_residual(type, tolerance(low));
    const double slope = log10(rough / sharp) / log10(1e-4 / low);
    ck_assert_msg(slope >= p / (q + 1) - 0.25, "%s: %.2f", type->name, slope);
}
END_TEST

/* ---- nothing else changes ----------------------------------------------------------
 */

static uint64_t hash_of(const weft_sim *at)
{
    return weft_sim_measure(at).hash;
}

START_TEST(state_and_steps_are_the_same_without_it)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_needs_damping(type) || test_is_spared(type)) {
        return;
    }
    const int modes = (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 1 : 3;
    all_at_once();
    for (int mode = 0; mode < modes && keeps(type); ++mode) {
        weft_stepper_config config = mode == 0 ? fixed(1e-3) : tolerance(1e-5);
        config.norm = mode == 2 ? WEFT_NORM_RMS : WEFT_NORM_MAX;
        weft_sim *with = make(type, config, true), *plain = make(type, config, false);
        for (int frame = 1; frame <= 4; ++frame) {
            go(with, frame / 7.0);
            go(plain, frame / 7.0);
            ck_assert_uint_eq(hash_of(with), hash_of(plain));
        }
        const weft_stepper_stats a = weft_sim_stats(with), b = weft_sim_stats(plain);
        ck_assert_uint_eq(a.steps, b.steps);
        ck_assert_uint_eq(a.rejected, b.rejected);
        ck_assert_uint_eq(a.rhs_calls, b.rhs_calls);
        const weft_ledger none = weft_sim_ledger(plain), kept = weft_sim_ledger(with);
        ck_assert(!none.kept && kept.kept);
        ck_assert(none.residual == 0.0 && none.work_wind == 0.0);
        ck_assert_mem_eq(&none.energy, &kept.energy, sizeof none.energy);
        weft_sim_destroy(with);
        weft_sim_destroy(plain);
    }
}
END_TEST

START_TEST(other_methods_refuse_it)
{
    if (test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    all_at_once();
    def.cloth = cloth;
    def.method = type;
    def.config = test_config(type, fixed(1e-3));
    def.ledger = true;
    const weft_status status = weft_sim_create(&def, &sim, &err);
    ck_assert_int_eq(status, keeps(type) ? WEFT_OK : WEFT_UNSUPPORTED);
    ck_assert(keeps(type) || strstr(err.message, type->name) != NULL);
    ck_assert((sim != NULL) == keeps(type));
}
END_TEST

TEST_SUITE(ledger_order)
{
    Suite *suite = suite_create("order of the ledger");
    const int methods = (int)test_method_count();
    add(suite, "order", residual_is_of_the_order_of_the_method, methods);
    add(suite, "tolerance", residual_shrinks_with_the_tolerance, methods);
    add(suite, "bits", state_and_steps_are_the_same_without_it, methods);
    add(suite, "refusal", other_methods_refuse_it, methods);
    return suite;
}
