/* SPDX-License-Identifier: BSD-3-Clause */
/* control.c -- error control: which steps are checked, by which tolerances, in which
 * norm, and which step comes after one that t_end has cut short. */
#include "conformance/trial.h"

/* What the work of one tolerance is compared with. */
#define LOOSE 1e-4
#define TIGHT 1e-8

void weft__a_step_to_the_end_is_checked(trial *self)
{
    const char what[] = "first_step 1000 s, towards 1 s";
    weft_stepper_config config = weft__adaptive(1e-6);
    config.first_step = 1000.0;
    trial_run *r = weft__begin(self, 0, config);
    weft__go(self, r, 1.0);
    weft__near_solution(self, r, what);
}

/* A method of several steps may grow again from the short one. */
void weft__a_cut_step_shortens_no_other(trial *self)
{
    const bool memory = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    trial_run *r = weft__begin(self, 0, weft__adaptive(1e-6));
    for (int k = 0; k < 3; ++k) {
        double usual = 0.0, longest = 0.0;
        for (int i = 0; i < 20; ++i) {
            weft__good_step(self, r, 1e6);
            usual = i < 10 ? 0.0 : fmax(usual, weft__stats(r).last_step);
        }
        weft__good_step(self, r, r->t + 1e-6 * usual);
        for (int i = 0; i < (memory ? 20 : 2); ++i) {
            weft__good_step(self, r, 1e6);
            longest = fmax(longest, weft__stats(r).last_step);
        }
        EXPECT(longest >= 0.1 * usual,
               "after one that t_end cut to %.3g s: steps of %.3g s, before: %.3g s",
               1e-6 * usual, longest, usual);
    }
}

static uint64_t work(trial *self, double rtol, double position, double velocity)
{
    weft_stepper_config config = weft__adaptive(1.0);
    config.rtol = rtol;
    config.atol_position = position;
    config.atol_velocity = velocity;
    trial_run *r = weft__begin(self, 0, config);
    weft__go(self, r, 4.0);
    return weft__stats(r).rhs_calls;
}

void weft__each_tolerance_counts(trial *self)
{
    const double few = 1e-3 * TIGHT;
    const bool erratic = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    const struct {
        const char *name;
        double loose[3], tight[3];
    } cases[] = {
        { "atol_position", { 0.0, LOOSE, LOOSE }, { 0.0, TIGHT, LOOSE } },
        { "atol_velocity", { 0.0, LOOSE, LOOSE }, { 0.0, LOOSE, TIGHT } },
        { "rtol", { LOOSE, few, few }, { TIGHT, few, few } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const double *a = cases[i].loose, *b = cases[i].tight;
        const uint64_t loose = work(self, a[0], a[1], a[2]);
        const uint64_t tight = work(self, b[0], b[1], b[2]);
        const bool more
            = erratic ? tight != loose : (double)tight > 1.1 * (double)loose;
        EXPECT(more,
               "%s of %g instead of %g: %" PRIu64
               " calls of the rhs instead of %" PRIu64,
               cases[i].name, TIGHT, LOOSE, tight, loose);
    }
}

enum { STEPS = 1000 };

/* Only x1 moves, and only its error counts: the mean of six squares is a sixth of it.
 */
static double time_of_steps(trial *self, weft_norm norm, double tolerance)
{
    weft_stepper_config config = weft__adaptive(tolerance);
    config.norm = norm;
    config.atol_velocity = 1e4 * tolerance;
    trial_run *r = weft__begin(self, 0, config);
    r->model.single = true;
    memset(r->y + 1, 0, (DIM - 1) * sizeof *r->y);
    for (int i = 0; i < STEPS; ++i) {
        weft__good_step(self, r, 1e6);
    }
    return r->t;
}

void weft__the_rms_norm_is_a_mean(trial *self)
{
    const double tolerance = 1e-6;
    const double rms = time_of_steps(self, WEFT_NORM_RMS, tolerance);
    const double max = time_of_steps(self, WEFT_NORM_MAX, sqrt(6.0) * tolerance);
    EXPECT(fabs(rms - max) <= 0.05 * max,
           "where one of six numbers has an error, %d steps take %.4g s at a tolerance "
           "of %g in the rms norm, and %.4g s at %.3g in the max norm",
           STEPS, rms, tolerance, max, sqrt(6.0) * tolerance);
}

void weft__quadratures_change_no_step(trial *self)
{
    trial_run *without = weft__begin_usual(self, 0);
    self->apart = APART;
    trial_run *with = weft__begin_usual(self, 1);
    self->apart = 0;
    weft__go(self, without, 1.0);
    weft__go(self, with, 1.0);
    EXPECT(weft__same(self, without, with)
               && weft__stats(without).steps == weft__stats(with).steps,
           "quadratures change the state by %.3g, in %" PRIu64
           " steps instead of %" PRIu64,
           weft__model_distance(without->y, with->y), weft__stats(with).steps,
           weft__stats(without).steps);
}

/* A method of several steps chooses its order too. */
const char *weft__no_rms_steps(const weft_stepper_type *type)
{
    return !weft__adapts(type) ? "the method has no error control"
           : (type->flags & WEFT_STEPPER_MULTISTEP) != 0
               ? "the norm decides the order too"
               : NULL;
}

const char *weft__takes_no_quadratures(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_QUADRATURES) != 0 ? NULL
                                                         : "the method takes none";
}
