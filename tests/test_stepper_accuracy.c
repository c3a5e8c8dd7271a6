/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: together asan-long */
/* test_stepper_accuracy.c -- whether each tolerance and norm means what weft/stepper.h
 * says, beyond weft/conformance.h; orders are measured in test_verification.c. */
#include "stepper_run.h"

typedef struct result {
    double error;
    uint64_t steps;
} result;

static result at_4_s(const weft_stepper_type *type, const weft_stepper_config *config)
{
    trial_run r;
    start(&r, type, config);
    go(&r, 4.0);
    const result res = { error_at_end(&r), stats(&r).steps };
    end(&r);
    return res;
}

START_TEST(each_tolerance_counts)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const double low = type->order == 1 ? 1e-5 : type->order == 2 ? 1e-6 : 1e-9;
    for (int norm = WEFT_NORM_MAX;
         norm <= WEFT_NORM_RMS && can_adapt(type) && !test_is_spared(type); ++norm) {
        weft_stepper_config config = adaptive(1e-3);
        config.norm = (weft_norm)norm;
        const uint64_t loose = at_4_s(type, &config).steps;
        config.atol_position = low;
        const uint64_t position = at_4_s(type, &config).steps;
        config.atol_velocity = low;
        const uint64_t both = at_4_s(type, &config).steps;
        config.atol_position = 1e-3;
        const uint64_t velocity = at_4_s(type, &config).steps;
        config.atol_position = low;
        config.rtol = 1e-2;
        const uint64_t relative = at_4_s(type, &config).steps;
        ck_assert_uint_gt(position, loose);
        ck_assert_uint_gt(velocity, loose);
        ck_assert_uint_gt(both, relative);
    }
}
END_TEST

/* Pendulums that do not know of each other. All rest but one. */
enum { PENDULUMS = 50, KICKED = 37 };

static int pendulums(double t, const double *y, double *dydt, void *ctx)
{
    (void)t;
    (void)ctx;
    for (int i = 0; i < PENDULUMS; ++i) {
        dydt[i] = y[PENDULUMS + i];
        dydt[PENDULUMS + i] = -7.3 * sin(y[i]);
    }
    return 0;
}

/* Of the kicked one, after 2 s. */
static result kick(const weft_stepper_type *type, weft_norm norm, double tolerance)
{
    const weft_ode ode = { .dim = (size_t)2 * PENDULUMS, .rhs = pendulums };
    weft_stepper_config config = test_config(type, adaptive(tolerance));
    config.norm = norm;
    double y[2 * PENDULUMS] = { 0 }, t = 0.0;
    y[PENDULUMS + KICKED] = 1.9;
    void *self = NULL;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    while (t < 2.0) {
        ck_assert_int_eq(type->step(self, 2.0, &t, y, NULL), WEFT_OK);
    }
    weft_stepper_stats s = { .struct_size = sizeof s };
    type->stats(self, &s);
    type->destroy(self);
    /* by the classical Runge-Kutta method with 2^-14 s, to 1e-12 */
    const double want[2] = { -0.6262190417261715, 0.9163182761308935 };
    const double dx = fabs(y[KICKED] - want[0]);
    return (result){ fmax(dx, fabs(y[PENDULUMS + KICKED] - want[1])), s.steps };
}

/* An error e in one of n components has the rms e / sqrt(n). A multistep method chooses
 * its order in a norm of its own and may need fewer steps all the same. bsimp errs by
 * 1e-10 here with steps as long as they may grow, whatever is asked of it. */
START_TEST(the_largest_norm_sees_one_particle_where_rms_does_not)
{
    if (test_needs_structure(test_method((size_t)_i))) {
        return;
    }
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool multistep = (type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    if (!can_adapt(type) || (type->order == 0 && !multistep) || test_is_spared(type)) {
        return;
    }
    const double tolerance = type->order == 1 || type->order == 2 ? 1e-3 : 1e-9;
    const result max = kick(type, WEFT_NORM_MAX, tolerance);
    const result rms = kick(type, WEFT_NORM_RMS, tolerance);
    ck_assert(max.steps > rms.steps || multistep);
    ck_assert_double_lt(max.error, rms.error);
}
END_TEST

TEST_SUITE(stepper_accuracy)
{
    Suite *suite = suite_create("stepper accuracy");
    add_for_every_method(suite, "tolerances", each_tolerance_counts);
    add_for_every_method(suite, "norms",
                         the_largest_norm_sees_one_particle_where_rms_does_not);
    return suite;
}
