/* SPDX-License-Identifier: BSD-3-Clause */
/* control.c -- error control: which steps are checked, by which tolerances, in which
 * norm, and which step comes after one that t_end has cut short. */
#include "study/conformance/trial.h"

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

#define UNCHECKED 1e4

/* Where only this oscillator moves. */
static trial_run *begin_single(trial *self, weft_stepper_config config, int single,
                               double start)
{
    trial_run *r = weft__begin(self, 0, config);
    r->model.single = single;
    memset(r->y, 0, DIM * sizeof *r->y);
    r->y[single - 1] = start;
    return r;
}

/* Of stiffness 1e4, in some five periods. */
static double steps_of_single(trial *self, weft_stepper_config config, int single,
                              double start)
{
    trial_run *r = begin_single(self, config, single, start);
    r->model.k = 1e4;
    weft__go(self, r, 0.2);
    return (double)weft__stats(r).steps;
}

/* Where the error of one number counts, it is no matter which number that is, and which
 * sign it has. Returns the number of steps. */
static double steps_of_any(trial *self, weft_stepper_config config, const char *of)
{
    const double start = weft__model_start[0];
    const double usual = steps_of_single(self, config, 1, start);
    for (int i = 1; i < 6; ++i) {
        const double from = i % 2 == 0 ? start : -start;
        const double seen = steps_of_single(self, config, 1 + i / 2, from);
        EXPECT(fabs(seen - usual) <= 0.2 * usual + 2.0,
               "where only number %d moves, and the error of its %s counts: %g steps "
               "from %g, and %g where number 1 moves from %g",
               1 + i / 2, of, seen, from, usual, start);
    }
    return usual;
}

/* Errors of velocities are larger than those of positions, as the frequency is. */
void weft__each_number_counts(trial *self)
{
    const double tolerance = 1e-5;
    weft_stepper_config config = weft__adaptive(1e-3 * tolerance);
    config.rtol = tolerance;
    (void)steps_of_any(self, config, "place and velocity");
    config = weft__adaptive(tolerance);
    config.atol_velocity = UNCHECKED * tolerance;
    const double place = steps_of_any(self, config, "place");
    config = weft__adaptive(tolerance);
    config.atol_position = UNCHECKED * tolerance;
    const double velocity = steps_of_any(self, config, "velocity");
    EXPECT(velocity > 1.1 * place,
           "%g steps where only the error of a place counts, and %g where only that of "
           "a velocity does, which is larger",
           place, velocity);
}

/* Only x1 moves, and only its error counts: the mean of six squares is a sixth of it.
 */
static double time_in_norm(trial *self, weft_norm norm, double tolerance)
{
    weft_stepper_config config = weft__adaptive(tolerance);
    config.norm = norm;
    config.atol_velocity = UNCHECKED * tolerance;
    trial_run *r = begin_single(self, config, 1, weft__model_start[0]);
    for (int i = 0; i < STEPS; ++i) {
        weft__good_step(self, r, 1e6);
    }
    return r->t;
}

void weft__the_rms_norm_is_a_mean(trial *self)
{
    const double tolerance = 1e-6;
    const double rms = time_in_norm(self, WEFT_NORM_RMS, tolerance);
    const double max = time_in_norm(self, WEFT_NORM_MAX, sqrt(6.0) * tolerance);
    EXPECT(fabs(rms - max) <= 0.05 * max,
           "where one of six numbers has an error, %d steps take %.4g s at a tolerance "
           "of %g in the rms norm, and %.4g s at %.3g in the max norm",
           STEPS, rms, tolerance, max, sqrt(6.0) * tolerance);
}

/* The model's: the time, what x1 has gone, and the integral of v1 v2. */
static void quadratures_are_integrals(trial *self, const trial_run *r)
{
    const double h = 0x1p-13, allowed = weft__allowed(self->type);
    double y[DIM + APART] = { 0.0 };
    model m = { .k = 1.0, .apart = APART };
    const weft_ode ode = { .dim = DIM + APART, .rhs = weft__model_rhs, .ctx = &m };
    memcpy(y, weft__model_start, sizeof weft__model_start);
    for (int i = 0; i * h < r->t; ++i) {
        weft__runge_kutta(&ode, i * h, h, y);
    }
    for (size_t i = DIM; i < DIM + APART; ++i) {
        EXPECT(fabs(r->y[i] - y[i]) <= allowed,
               "quadrature %zu is %.9g at %.3g s, not %.9g", i - DIM, r->y[i], r->t,
               y[i]);
    }
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
    quadratures_are_integrals(self, with);
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
