/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow together asan-long computes */
/* test_quadratures.c -- components behind positions and velocities that are integrated
 * along: right, and without a say in any step. test_steppers.c holds the rest of the
 * contract with them too. */
#include "stepper_run.h"

#include <stdlib.h>

static bool takes(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_QUADRATURES) != 0;
}

/* Mode 0: adaptive in the max norm, 1: in the rms norm, 2: fixed steps. */
static weft_stepper_config in_mode(const weft_stepper_type *type, int mode)
{
    weft_stepper_config config = usual(type, mode == 2 ? 1 : 0);
    config.norm = mode == 1 ? WEFT_NORM_RMS : WEFT_NORM_MAX;
    return config;
}

/* Over three frames, with an edit of the state after the first. */
static trial_run with_quadratures_go(const weft_stepper_type *type, int mode,
                                     size_t count)
{
    const weft_stepper_config config = in_mode(type, mode);
    trial_run r;
    quadratures = count;
    start(&r, type, &config);
    go(&r, 0.3);
    r.y[1] += 0.125;
    type->state_changed(r.self);
    go(&r, 0.6);
    go(&r, 1.0);
    return r;
}

START_TEST(steps_have_the_same_bits_with_and_without)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 3 && takes(type); ++mode) {
        trial_run plain = with_quadratures_go(type, mode, 0);
        const weft_stepper_stats a = stats(&plain);
        for (size_t count = 1; count <= APART; ++count) {
            trial_run with = with_quadratures_go(type, mode, count);
            const weft_stepper_stats b = stats(&with);
            ck_assert_mem_eq(plain.y, with.y, DIM * sizeof *plain.y);
            ck_assert_uint_eq(a.steps, b.steps);
            ck_assert_uint_eq(a.rejected, b.rejected);
            ck_assert_uint_eq(a.rhs_calls, b.rhs_calls);
            ck_assert(a.next_step == b.next_step);
            end(&with);
        }
        end(&plain);
    }
}
END_TEST

/* Many pendulums, each of its own length, their sine to the third order: libm's is
 * slow; what is integrated along is their number. */
static int pendulums(double t, const double *y, double *dydt, void *ctx)
{
    const size_t half = ((const size_t *)ctx)[0], behind = ((const size_t *)ctx)[1];
    (void)t;
    for (size_t i = 0; i < half; ++i) {
        dydt[i] = y[half + i];
        dydt[half + i]
            = -(1.0 + 0.37 * (double)(i % 101)) * (y[i] - y[i] * y[i] * y[i] / 6.0);
    }
    for (size_t i = 0; i < behind; ++i) {
        dydt[2 * half + i] = (double)half;
    }
    return 0;
}

/* What a few steps make of them, a hash; *next is the step size wanted then. */
static uint64_t swing(const weft_stepper_type *type, size_t half, size_t behind,
                      double *next)
{
    size_t sizes[] = { half, behind };
    const weft_ode ode = { 2 * half + behind, pendulums, sizes };
    weft_stepper_config config = test_config(type, in_mode(type, 1));
    weft_stepper_stats s = { .struct_size = sizeof s };
    double *y = calloc(ode.dim, sizeof *y), t = 0.0;
    weft_error err = { 0 };
    void *self = NULL;
    config.quadratures = behind;
    for (size_t i = 0; i < half; ++i) {
        y[i] = sin((double)i);
    }
    ck_assert_msg(type->create(type, &ode, &config, &self, &err) == WEFT_OK, "%s",
                  err.message);
    for (int i = 0; i < 3; ++i) {
        ck_assert_msg(type->step(self, 1.0, &t, y, &err) == WEFT_OK, "%s", err.message);
    }
    type->stats(self, &s);
    type->destroy(self);
    const uint64_t hash = test_hash(y, 2 * half);
    free(y);
    *next = s.next_step;
    return hash;
}

/* Sums of long vectors are made of parts: not of other parts with quadratures. */
START_TEST(long_states_have_the_same_bits_too)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (test_needs_structure(type) || test_is_spared(type)) {
        return;
    }
    for (size_t half = 65786; half <= 65792 && takes(type); half += 2) {
        double plain, with;
        ck_assert_uint_eq(swing(type, half, 0, &plain), swing(type, half, 4, &with));
        ck_assert(plain == with);
    }
}
END_TEST

/* y' = 1 is exact in every method; y' = v1 is x1 as far as the method knows it. */
START_TEST(quadratures_are_integrated_along)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 3 && takes(type); ++mode) {
        const weft_stepper_config config = in_mode(type, mode);
        trial_run r;
        quadratures = APART;
        start(&r, type, &config);
        go(&r, 1.0);
        ck_assert_double_eq_tol(r.y[DIM], 1.0, 1e-12);
        ck_assert_double_eq_tol(r.y[DIM + 1], r.y[0] - y_start[0], allowed(type));
        end(&r);
    }
}
END_TEST

/* They carry on from what they are given, and do nothing with it. */
START_TEST(quadratures_go_on_from_any_value)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const weft_stepper_config config = in_mode(type, 0);
    trial_run zero, large;
    if (!takes(type)) {
        return;
    }
    quadratures = APART;
    start(&zero, type, &config);
    start(&large, type, &config);
    large.y[DIM + 1] = 0x1p20;
    go(&zero, 0.5);
    go(&large, 0.5);
    large.y[DIM + 2] -= 17.0;
    type->state_changed(zero.self);
    type->state_changed(large.self);
    go(&zero, 1.0);
    go(&large, 1.0);
    ck_assert_mem_eq(zero.y, large.y, DIM * sizeof *zero.y);
    ck_assert_double_eq_tol(large.y[DIM + 1], 0x1p20 + zero.y[DIM + 1], 1e-7);
    ck_assert_double_eq_tol(large.y[DIM + 2], zero.y[DIM + 2] - 17.0, 1e-12);
    end(&zero);
    end(&large);
}
END_TEST

START_TEST(counts_that_do_not_fit_are_refused)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const size_t fitting[] = { 2, 1, DIM, DIM + 1, SIZE_MAX, SIZE_MAX - 1 };
    weft_stepper_config config = test_config(type, usual(type, 0));
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    for (size_t i = takes(type) ? 1 : 0; i < sizeof fitting / sizeof *fitting; ++i) {
        weft_error err = { 0 };
        void *self = &m;
        config.quadratures = fitting[i];
        ck_assert_int_eq(type->create(type, &ode, &config, &self, &err), WEFT_INVALID);
        ck_assert_ptr_null(self);
        ck_assert_ptr_nonnull(strstr(err.message, "quadratures"));
    }
}
END_TEST

/* Whoever was compiled before the field was there has none. */
START_TEST(a_config_without_the_field_has_no_quadratures)
{
    if (test_needs_structure(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    weft_stepper_config config = test_config(type, usual(type, 0));
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    weft_error err = { 0 };
    void *self = NULL;
    config.struct_size = offsetof(weft_stepper_config, quadratures);
    config.quadratures = 1;
    ck_assert_msg(type->create(type, &ode, &config, &self, &err) == WEFT_OK, "%s",
                  err.message);
    type->destroy(self);
}
END_TEST

TEST_SUITE(quadratures)
{
    Suite *suite = suite_create("quadratures");
    add_for_every_method(suite, "bits", steps_have_the_same_bits_with_and_without);
    add_for_every_method(suite, "long", long_states_have_the_same_bits_too);
    add_for_every_method(suite, "values", quadratures_are_integrated_along);
    add_for_every_method(suite, "any value", quadratures_go_on_from_any_value);
    add_for_every_method(suite, "counts", counts_that_do_not_fit_are_refused);
    add_for_every_method(suite, "old", a_config_without_the_field_has_no_quadratures);
    return suite;
}
