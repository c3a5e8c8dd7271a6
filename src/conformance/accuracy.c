/* SPDX-License-Identifier: BSD-3-Clause */
/* accuracy.c -- checks of the order and of the tolerance. */
#include "conformance/oscillators.h"
#include "conformance/trial.h"

const char *weft__order_not_measured(const weft_stepper_type *type)
{
    const int claimed = weft__order_claimed(type);
    return !weft__takes_fixed(type)     ? "the method takes no fixed steps"
           : claimed < 1                ? "the order varies"
           : claimed > WEFT__ORDER_MOST ? "an order that high is not measured"
                                        : NULL;
}

void weft__the_order_is_the_one_claimed(trial *self)
{
    const int claimed = weft__order_claimed(self->type);
    weft_error err = { 0 };
    double measured = 0.0;
    const weft_status status = weft__order(self->type, claimed, &measured, &err);
    weft__expect(self, status == WEFT_OK, "a step failed: %s", err.message);
    weft__expect(self, fabs(measured - claimed) <= WEFT__ORDER_BOUND,
                 "order %d is claimed, %s%.3g is measured; within %g would do", claimed,
                 isinf(measured) ? "a higher one, " : "", measured, WEFT__ORDER_BOUND);
}

typedef struct result {
    double error;
    uint64_t steps;
} result;

static result at_4_s(trial *self, weft_norm norm, double tolerance)
{
    weft_stepper_config config = weft__adaptive(tolerance);
    config.norm = norm;
    trial_run *r = weft__begin(self, 0, config);
    weft__go(self, r, 4.0);
    return (result){ weft__error_at_end(r), weft__stats(r).steps };
}

/* The error at the end is not the error of a step: a factor remains between them. It is
 * about the number of steps, which is large for low orders, where the estimate is of
 * the solution that is continued: of multistep methods, and by one of a higher order.
 */
void weft__the_error_follows_the_tolerance(trial *self)
{
    const int order = self->type->order;
    const double low = order == 1 ? 1e-5 : order == 2 ? 1e-7 : 1e-9;
    const bool its_own = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0
                         || self->type->error_order > order;
    const double most = order == 1 || (order == 2 && its_own) ? 2000.0 : 150.0;
    for (int norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS; ++norm) {
        const double fine_most = (norm == WEFT_NORM_MAX ? 1.0 : 2.0) * most * low;
        const result rough = at_4_s(self, (weft_norm)norm, 1e-3);
        const result fine = at_4_s(self, (weft_norm)norm, low);
        weft__expect(self, rough.error <= most * 1e-3 && fine.error <= fine_most,
                     "off by %.3g at a tolerance of 1e-3 and by %.3g at %g, at most "
                     "%.3g and %.3g would do",
                     rough.error, fine.error, low, most * 1e-3, fine_most);
        weft__expect(self, fine.error <= 0.11 * rough.error && fine.steps > rough.steps,
                     "a tolerance of %g instead of 1e-3 makes the error %.3g of %.3g, "
                     "in %" PRIu64 " steps instead of %" PRIu64,
                     low, fine.error, rough.error, fine.steps, rough.steps);
    }
}
