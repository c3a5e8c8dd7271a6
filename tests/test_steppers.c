/* SPDX-License-Identifier: BSD-3-Clause */
/* test_steppers.c -- the stepper contract (weft/stepper.h), held against every method
 * of every plugin: what create refuses, where steps end, what failures leave behind. */
#include "stepper_run.h"

#include <unistd.h>

/* ---- making one ------------------------------------------------------------------ */

static long bytes_printed(FILE *from, int to)
{
    fflush(from);
    return lseek(to, 0, SEEK_END);
}

START_TEST(create_calls_no_rhs_and_prints_nothing)
{
    for (int mode = 0; mode < 2; ++mode) {
        const weft_stepper_config config = usual(test_method((size_t)_i), mode);
        FILE *file = tmpfile();
        const int out = dup(1), err = dup(2);
        fflush(NULL);
        dup2(fileno(file), 1);
        dup2(fileno(file), 2);
        run r;
        start(&r, test_method((size_t)_i), &config);
        end(&r);
        const long printed = bytes_printed(stdout, fileno(file));
        dup2(out, 1);
        dup2(err, 2);
        close(out);
        close(err);
        fclose(file);
        ck_assert_int_eq(printed, 0);
        ck_assert_uint_eq(r.model.calls, 0);
    }
}
END_TEST

static void refused(const weft_stepper_type *type, weft_ode ode,
                    weft_stepper_config config, const char *what)
{
    void *self = &ode;
    weft_error err = { 0 };
    const weft_status status = type->create(type, &ode, &config, &self, &err);
    ck_assert_msg(status == WEFT_INVALID || status == WEFT_UNSUPPORTED, "%s: %d", what,
                  (int)status);
    ck_assert_ptr_null(self);
    ck_assert_int_eq(err.status, status);
    ck_assert_uint_gt(strlen(err.message), 0);
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), status);
}

#define REFUSED(field, ...)                                                            \
    do {                                                                               \
        const double values[] = { __VA_ARGS__ };                                       \
        for (size_t i = 0; i < sizeof values / sizeof values[0]; ++i) {                \
            weft_stepper_config bad = good;                                            \
            bad.field = values[i];                                                     \
            refused(type, ode, bad, #field);                                           \
        }                                                                              \
    } while (0)

START_TEST(bad_numbers_are_refused)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    model m = { .k = 1.0 };
    weft_ode ode = { .dim = DIM, .rhs = rhs, .ctx = &m };
    weft_stepper_config good = test_config(type, usual(type, 0));
    REFUSED(fixed_step, -1e-3, (double)NAN, (double)INFINITY);
    if (can_adapt(type)) {
        REFUSED(rtol, -1e-9, (double)NAN, (double)INFINITY);
        REFUSED(atol_position, 0.0, -1e-6, (double)NAN, (double)INFINITY);
        REFUSED(atol_velocity, 0.0, -1e-6, (double)NAN, (double)INFINITY);
        REFUSED(first_step, 0.0, -1e-3, (double)NAN, (double)INFINITY);
        REFUSED(min_step, 0.0, -1e-9, (double)NAN, (double)INFINITY);
        REFUSED(max_step, 0.0, -1.0, 0.9e-10, (double)NAN);
        weft_stepper_config bad = good;
        bad.norm = (weft_norm)7;
        refused(type, ode, bad, "norm");
    } else {
        refused(type, ode, adaptive(1e-6), "adaptive");
    }
    weft_stepper_config old = good;
    old.struct_size = 8;
    refused(type, ode, old, "struct_size");
    ode.dim = 0;
    refused(type, ode, good, "dim 0");
    ode.dim = 5;
    refused(type, ode, good, "odd dim");
    if ((type->flags & WEFT_STEPPER_BUTCHER) == 0) {
        const weft_butcher table = { .stages = 1 };
        ode.dim = DIM;
        good.butcher = &table;
        refused(type, ode, good, "Butcher table");
    }
    ck_assert_uint_eq(m.calls, 0);
}
END_TEST

START_TEST(fixed_steps_look_at_no_tolerance)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    weft_stepper_config config = fixed(0x1p-9);
    run plain, odd;
    start(&plain, type, &config);
    config.norm = WEFT_NORM_RMS;
    config.rtol = config.atol_position = config.atol_velocity = NAN;
    config.first_step = config.min_step = config.max_step = -1.0;
    start(&odd, type, &config);
    go(&plain, 0.5);
    go(&odd, 0.5);
    SAME(plain.y, odd.y);
    ck_assert_uint_eq(stats(&odd).steps, 256);
    end(&plain);
    end(&odd);
}
END_TEST

/* ---- steps ----------------------------------------------------------------------- */

START_TEST(every_frame_end_is_met_bit_for_bit)
{
    for (int mode = 0; mode < 2; ++mode) {
        const weft_stepper_config config = usual(test_method((size_t)_i), mode);
        run r;
        start(&r, test_method((size_t)_i), &config);
        for (int frame = 1; frame <= 43; ++frame) {
            const double t_end = frame / 29.97;
            while (r.t < t_end) {
                const double before = r.t;
                const uint64_t steps = stats(&r).steps;
                ck_assert_msg(step(&r, t_end) == WEFT_OK, "%s", r.err.message);
                ck_assert(before < r.t && r.t <= t_end);
                const weft_stepper_stats s = stats(&r);
                ck_assert_uint_eq(s.steps, steps + 1);
                ck_assert_double_eq_tol(s.last_step, r.t - before, 1e-15);
                ck_assert(s.next_step >= 0.0 && isfinite(s.next_step));
                ck_assert_uint_eq(s.rhs_calls, r.model.calls);
            }
            ck_assert_mem_eq(&r.t, &t_end, sizeof t_end);
        }
        ck_assert(isfinite(distance(r.y, y_start)));
        end(&r);
    }
}
END_TEST

/* t + (t_end - t) is not t_end where t < t_end / 2. */
START_TEST(a_single_step_lands_as_exactly)
{
    const weft_stepper_config config = fixed(1.0);
    run r;
    start(&r, test_method((size_t)_i), &config);
    for (double t_end = 1.3e-7; t_end < 0.02; t_end *= 2.7) {
        ck_assert_msg(step(&r, t_end) == WEFT_OK, "%s", r.err.message);
        ck_assert_mem_eq(&r.t, &t_end, sizeof t_end);
    }
    end(&r);
}
END_TEST

START_TEST(fixed_steps_that_fit_leave_no_sliver)
{
    const weft_stepper_config config = fixed(1.0 / 2997.0);
    const weft_stepper_config long_one = fixed(3.0 / 2997.0);
    run r, rough;
    start(&r, test_method((size_t)_i), &config);
    start(&rough, test_method((size_t)_i), &long_one);
    for (int frame = 1; frame <= 60; ++frame) {
        go(&r, frame / 299.7);
        ck_assert_uint_eq(stats(&r).steps, 10 * (uint64_t)frame);
        go(&rough, frame / 299.7);
        ck_assert_uint_eq(stats(&rough).steps, 4 * (uint64_t)frame);
        ck_assert_double_eq_tol(stats(&rough).last_step, 1.0 / 2997.0, 1e-12);
    }
    end(&r);
    end(&rough);
}
END_TEST

START_TEST(stages_are_the_rhs_calls_of_a_step)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (type->stages == 0) {
        return;
    }
    const weft_stepper_config config = fixed(1e-3);
    run r;
    start(&r, type, &config);
    ck_assert_int_eq(step(&r, 1.0), WEFT_OK);
    const uint64_t first = r.model.calls;
    ck_assert_int_eq(step(&r, 1.0), WEFT_OK);
    ck_assert_uint_eq(r.model.calls - first, (uint64_t)type->stages);
    ck_assert((type->flags & WEFT_STEPPER_FSAL) != 0 || first == r.model.calls - first);
    end(&r);
}
END_TEST

START_TEST(step_sizes_asked_for_are_kept)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!can_adapt(type)) {
        return;
    }
    weft_stepper_config config = adaptive(1e-3);
    config.first_step = 1.7e-5;
    config.max_step = 0.0113;
    run r;
    start(&r, type, &config);
    ck_assert_int_eq(step(&r, 1.0), WEFT_OK);
    ck_assert_double_eq_tol(r.t, 1.7e-5, 1e-18);
    double longest = 0.0;
    while (r.t < 1.0) {
        ck_assert_int_eq(step(&r, 1.0), WEFT_OK);
        longest = fmax(longest, stats(&r).last_step);
    }
    ck_assert_double_le(longest, 0.0113 * (1.0 + 1e-11));
    ck_assert_double_ge(longest, 0.0056);
    end(&r);
}
END_TEST

START_TEST(no_step_goes_backwards_or_nowhere)
{
    const weft_stepper_config config = usual(test_method((size_t)_i), 0);
    const double t_ends[] = { 0.25, 0.125, -1.0, (double)NAN };
    run r;
    start(&r, test_method((size_t)_i), &config);
    go(&r, 0.25);
    const run before = r;
    for (int i = 0; i < 4; ++i) {
        ck_assert_int_eq(step(&r, t_ends[i]), WEFT_INVALID);
        ck_assert(r.t == 0.25);
        SAME(r.y, before.y);
    }
    ck_assert_uint_eq(r.model.calls, before.model.calls);
    go(&r, 0.5);
    end(&r);
}
END_TEST

/* ---- failures -------------------------------------------------------------------- */

static weft_status status_of(fault kind)
{
    return kind == STOP ? WEFT_STOPPED : WEFT_NOT_FINITE;
}

/* After three good steps every RHS call from the k-th on fails. True if that was
 * noticed within one step. Healed, the run goes on and arrives at the right place. */
static bool fails_and_heals(const weft_stepper_type *type, int mode, fault kind,
                            uint64_t k)
{
    const weft_stepper_config config = usual(type, mode);
    run r;
    start(&r, type, &config);
    for (int i = 0; i < 3; ++i) {
        ck_assert_int_eq(step(&r, 1.0), WEFT_OK);
    }
    const run before = r;
    r.model.fault = kind;
    r.model.at = r.model.calls + k;
    const weft_status status = step(&r, 1.0);
    if (status != WEFT_OK) {
        ck_assert_msg(status == status_of(kind), "%d: %s", status, r.err.message);
        ck_assert_int_eq(r.err.status, status);
        ck_assert_mem_eq(&r.t, &before.t, sizeof r.t);
        SAME(r.y, before.y);
        ck_assert(kind != STOP || r.model.calls == r.model.at);
        ck_assert_uint_eq(stats(&r).steps, 3);
        ck_assert_uint_eq(stats(&r).rhs_calls, r.model.calls);
        r.model.fault = NO_FAULT;
        go(&r, 0.25);
        ck_assert_double_le(error_at_end(&r), allowed(type));
    }
    end(&r);
    return status != WEFT_OK;
}

START_TEST(failed_step_leaves_state_untouched)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2; ++mode) {
        for (fault kind = REFUSE; kind < FAULTS; ++kind) {
            uint64_t k = 1;
            while (fails_and_heals(type, mode, kind, k)) {
                k += 1 + k / 8;
            }
            ck_assert_uint_gt(k, type->stages > 0 ? (uint64_t)type->stages : 1);
        }
    }
}
END_TEST

START_TEST(one_refusal_costs_a_smaller_step)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const weft_stepper_config config = usual(type, 0);
    for (fault kind = REFUSE; kind < FAULTS && can_adapt(type); ++kind) {
        if (kind == STOP) {
            continue;
        }
        run r;
        start(&r, type, &config);
        go(&r, 0.125);
        const uint64_t rejected = stats(&r).rejected;
        r.model.fault = kind;
        r.model.once = true;
        r.model.at = r.model.calls + 2;
        go(&r, 1.0);
        ck_assert_uint_gt(stats(&r).rejected, rejected);
        ck_assert_double_le(error_at_end(&r), allowed(type));
        end(&r);
    }
}
END_TEST

START_TEST(first_step_far_too_large_is_rescued)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!can_adapt(type)) {
        return;
    }
    weft_stepper_config config = adaptive(1e-6);
    config.first_step = 47.3;
    run r;
    start(&r, type, &config);
    r.model.edge = 1.2;
    ck_assert_msg(step(&r, 100.0) == WEFT_OK, "%s", r.err.message);
    ck_assert_uint_gt(stats(&r).rejected, 0);
    ck_assert_double_lt(r.t, 4.0);
    go(&r, 4.0);
    ck_assert_double_le(error_at_end(&r), 4.0 * allowed(type));
    end(&r);
}
END_TEST

START_TEST(needing_less_than_min_step_is_a_failure)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (!can_adapt(type)) {
        return;
    }
    weft_stepper_config config = adaptive(1e-6);
    config.min_step = 0.9e-6;
    run r;
    start(&r, type, &config);
    go(&r, 0.125);
    const run before = r;
    r.model.k = 1e14; /* 1e-6 s is a period and a half */
    ck_assert_int_eq(step(&r, 1.0), WEFT_STEP_TOO_SMALL);
    ck_assert_mem_eq(&r.t, &before.t, sizeof r.t);
    SAME(r.y, before.y);
    r.model.k = 1.0;
    go(&r, 1.0);
    ck_assert_double_le(error_at_end(&r), allowed(type));
    end(&r);
}
END_TEST

/* ---- state and statistics -------------------------------------------------------- */

START_TEST(needless_state_changed_changes_no_result)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2; ++mode) {
        const weft_stepper_config config = usual(type, mode);
        run quiet, told;
        start(&quiet, type, &config);
        start(&told, type, &config);
        go(&quiet, 1.0);
        while (told.t < 1.0) {
            ck_assert_int_eq(step(&told, 1.0), WEFT_OK);
            type->state_changed(told.self);
        }
        if ((type->flags & WEFT_STEPPER_MULTISTEP) == 0) {
            SAME(quiet.y, told.y);
            ck_assert_uint_eq(stats(&quiet).steps, stats(&told).steps);
        }
        ck_assert_double_le(error_at_end(&told), 5e-3);
        end(&quiet);
        end(&told);
    }
}
END_TEST

START_TEST(an_edited_state_is_used)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2; ++mode) {
        const weft_stepper_config config = usual(type, mode);
        run r;
        start(&r, type, &config);
        go(&r, 0.5);
        r.y[0] -= 0.237;
        r.y[3] += 0.419;
        type->state_changed(r.self);
        double want[DIM];
        memcpy(want, r.y, sizeof want);
        solve(0.5, 1.0, want);
        go(&r, 1.0);
        ck_assert_double_le(distance(r.y, want), allowed(type));
        ck_assert_double_ge(error_at_end(&r), 0.1);
        end(&r);
    }
}
END_TEST

START_TEST(stats_write_no_further_than_the_caller_has)
{
    const weft_stepper_config config = usual(test_method((size_t)_i), 0);
    const size_t sizes[]
        = { offsetof(weft_stepper_stats, rhs_calls),
            offsetof(weft_stepper_stats, last_step), sizeof(weft_stepper_stats),
            sizeof(weft_stepper_stats) + 24 };
    run r;
    start(&r, test_method((size_t)_i), &config);
    go(&r, 0.125);
    const weft_stepper_stats whole = stats(&r);
    for (int i = 0; i < 4; ++i) {
        union {
            weft_stepper_stats stats;
            unsigned char bytes[sizeof(weft_stepper_stats) + 24];
        } out;
        memset(out.bytes, 0xA7, sizeof out.bytes);
        out.stats.struct_size = (uint32_t)sizes[i];
        r.type->stats(r.self, &out.stats);
        ck_assert_uint_eq(out.stats.struct_size, sizes[i]);
        ck_assert_uint_eq(out.stats.steps, whole.steps);
        const size_t written = sizes[i] < sizeof whole ? sizes[i] : sizeof whole;
        for (size_t b = written; b < sizeof out.bytes; ++b) {
            ck_assert_uint_eq(out.bytes[b], 0xA7);
        }
    }
    end(&r);
}
END_TEST

START_TEST(two_instances_are_independent)
{
    const weft_stepper_config config = usual(test_method((size_t)_i), 0);
    run alone[2], mixed[2];
    for (int i = 0; i < 2; ++i) {
        start(&alone[i], test_method((size_t)_i), &config);
        start(&mixed[i], test_method((size_t)_i), &config);
        alone[i].model.k = mixed[i].model.k = 1.0 + 3.7 * i;
        go(&alone[i], 1.0);
    }
    while (mixed[0].t < 1.0 || mixed[1].t < 1.0) {
        for (int i = 0; i < 2; ++i) {
            ck_assert(!(mixed[i].t < 1.0) || step(&mixed[i], 1.0) == WEFT_OK);
        }
    }
    for (int i = 0; i < 2; ++i) {
        SAME(alone[i].y, mixed[i].y);
        end(&alone[i]);
        end(&mixed[i]);
    }
    ck_assert(distance(alone[0].y, alone[1].y) > 0.1);
}
END_TEST

START_TEST(nothing_is_there_to_destroy)
{
    test_method((size_t)_i)->destroy(NULL);
}
END_TEST

/* Without quadratures and with. */
#define ADD(name, test)                                                                \
    do {                                                                               \
        add_for_every_method(suite, name, test);                                       \
        add_with_quadratures(suite, name ", quadratures", test);                       \
    } while (0)

int main(void)
{
    Suite *suite = suite_create("steppers");
    ADD("create", create_calls_no_rhs_and_prints_nothing);
    ADD("refusal", bad_numbers_are_refused);
    ADD("fixed", fixed_steps_look_at_no_tolerance);
    ADD("frames", every_frame_end_is_met_bit_for_bit);
    ADD("landing", a_single_step_lands_as_exactly);
    ADD("slivers", fixed_steps_that_fit_leave_no_sliver);
    ADD("stages", stages_are_the_rhs_calls_of_a_step);
    ADD("step sizes", step_sizes_asked_for_are_kept);
    ADD("direction", no_step_goes_backwards_or_nowhere);
    ADD("failure", failed_step_leaves_state_untouched);
    ADD("refusal once", one_refusal_costs_a_smaller_step);
    ADD("rescue", first_step_far_too_large_is_rescued);
    ADD("min step", needing_less_than_min_step_is_a_failure);
    ADD("needless", needless_state_changed_changes_no_result);
    ADD("edited", an_edited_state_is_used);
    ADD("stats", stats_write_no_further_than_the_caller_has);
    ADD("instances", two_instances_are_independent);
    ADD("destroy", nothing_is_there_to_destroy);
    return test_run(suite);
}
