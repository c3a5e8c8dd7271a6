/* SPDX-License-Identifier: BSD-3-Clause */
/* event.c -- steps that end where a function of the state falls to 0. The root is found
 * on solutions, not on an interpolant: each trial is the step taken again from its
 * start to another end. The quantities that end a run are such functions. */
#include <math.h>
#include <string.h>

#include "mesh/blocks.h"
#include "sim/bands.h"
#include "sim/simulation.h"

#define TOLERANCE 1e-10 /* [s] */

/* The step from t0: g(a) > 0 >= g(b). */
typedef struct bracket {
    double t0, a, b; /* [s] */
    double ga, gb;
} bracket;

/* ---- quantities that end a run ----------------------------------------------------
 */

const char *weft_stop_name(weft_stop_quantity quantity)
{
    static const char *const names[WEFT_STOPS]
        = { "", "max_strain", "min_gap", "kinetic", "at_rest" };
    return (unsigned)quantity < WEFT_STOPS ? names[quantity] : "";
}

static void block_gap(const weft_cloth *cloth, const weft__state *at, size_t b,
                      weft_measures *sum)
{
    weft__block_gap(&cloth->contact, at, b, sum);
}

/* The kinetic energy and the work of gravity since t = 0, as energies. */
static void block_rest(const weft_cloth *cloth, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    double start[3];
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        if (mesh->pin[i] == 0) {
            weft__start_position(mesh, i, start);
            for (size_t k = 0; k < 3; ++k) {
                const double v = at->y[(3 + k) * n + i];
                sum->energy.kinetic += 0.5 * mesh->mass[i] * v * v;
                sum->energy.gravitational += mesh->mass[i] * cloth->body.gravity[k]
                                             * (at->y[k * n + i] - start[k]);
            }
        }
    }
}

static weft__measure_fn *const stop_measures[WEFT_STOPS]
    = { [WEFT_STOP_STRAIN] = weft__block_worst,
        [WEFT_STOP_GAP] = block_gap,
        [WEFT_STOP_KINETIC] = weft__block_energy,
        [WEFT_STOP_REST] = block_rest };

/* NULL: nothing ends the run. */
static weft__measure_fn *measure_of(const weft_stop_def *at)
{
    return (unsigned)at->quantity < WEFT_STOPS ? stop_measures[at->quantity] : NULL;
}

static double stop_value(const weft_stop_def *at, const weft_measures *of)
{
    switch (at->quantity) {
    case WEFT_STOP_STRAIN:
        return at->bound - of->worst.strain;
    case WEFT_STOP_GAP:
        return of->gap - at->bound;
    case WEFT_STOP_KINETIC:
        return of->energy.kinetic - at->bound;
    default:
        return of->energy.kinetic - at->bound * fabs(of->energy.gravitational);
    }
}

double weft_stop_event(void *stop, const weft_cloth *cloth, double t, const double *y)
{
    const weft_stop_def *at = stop;
    const weft__state of = { .t = t, .y = y };
    weft_measures sum = weft__measures_start;
    if (measure_of(at) == NULL) {
        return (double)INFINITY;
    }
    if (at->quantity == WEFT_STOP_GAP) { /* bodies have theirs */
        sum.gap = weft_cloth_gap(cloth, t, y, NULL, NULL);
        return stop_value(at, &sum);
    }
    for (size_t b = 0; b < weft__blocks(&cloth->mesh); ++b) {
        weft_measures block = weft__block_start;
        measure_of(at)(cloth, &of, b, &block);
        weft__measures_add(&sum, &block);
    }
    return stop_value(at, &sum);
}

/* ---- the end of a step ----------------------------------------------------------- */

/* The smallest of all bands; weft_stop_event is one of the whole cloth. */
static double value(weft_sim *sim)
{
    const weft_comm *comm = sim->def.comm;
    const weft_stop_def *at = sim->def.event_ctx;
    if (comm != NULL && sim->def.event == weft_stop_event && measure_of(at) != NULL) {
        const weft__state of = { .t = sim->t, .y = sim->y };
        const weft_measures all
            = weft__forces_measure(&sim->forces, &of, measure_of(at));
        return stop_value(at, &all);
    }
    ++sim->callbacks;
    const double g = sim->def.event(sim->def.event_ctx, sim->cloth, sim->t, sim->y);
    --sim->callbacks;
    double most = -g;
    if (comm != NULL) {
        weft__bands_most(&sim->forces, &most, 1);
    }
    return -most;
}

/* Takes the step from t0 again, to `end`: the steps before it count as rejected. */
static weft_status step_again(weft_sim *sim, double t0, double end, uint64_t before,
                              weft_error *why)
{
    const uint64_t taken = weft_sim_stats(sim).steps - before;
    memcpy(sim->y, sim->between.start, weft__sim_dim(sim) * sizeof *sim->y);
    sim->t = t0;
    sim->between.levels = 0;
    sim->earlier.steps -= taken; /* modulo 2^64, as is the sum */
    sim->earlier.rejected += taken;
    sim->def.method->state_changed(sim->stepper);
    while (sim->t < end) {
        TRY(weft__sim_take_step(sim, end, why));
    }
    return WEFT_OK;
}

/* [s] Within the bracket: where a line meets 0, of values that the Illinois rule has
 * halved (M. Dowell, P. Jarratt, BIT 11, 1971), and not at its ends. */
static double guess(const bracket *in)
{
    const double t = in->a + (in->b - in->a) * (in->ga / (in->ga - in->gb));
    const double margin = 0.25 * TOLERANCE;
    return isfinite(t) ? fmin(fmax(t, in->a + margin), in->b - margin)
                       : 0.5 * (in->a + in->b);
}

static weft_status locate(weft_sim *sim, bracket *in, uint64_t before, weft_error *why)
{
    int side = 0;
    for (unsigned trial = 0;
         in->b - in->a > fmax(TOLERANCE, 4.0 * DBL_EPSILON * fabs(in->b)); ++trial) {
        /* now and then a half: a line is slow where g bends or jumps */
        const double t = trial % 4 == 3 ? 0.5 * (in->a + in->b) : guess(in);
        TRY(step_again(sim, in->t0, t, before, why));
        const double g = value(sim);
        if (g > 0.0) {
            in->a = t;
            in->ga = g;
            in->gb *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            in->b = t;
            in->gb = g;
            in->ga *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return sim->t != in->b ? step_again(sim, in->t0, in->b, before, why) : WEFT_OK;
}

double weft__sim_before_event(weft_sim *sim, double t_end)
{
    const double end = sim->event_since + sim->def.event_hold;
    if (isnan(sim->event)) {
        sim->event = value(sim);
    }
    return end > sim->t ? fmin(end, t_end) : t_end;
}

/* Of an event that must hold. */
static void hold(weft_sim *sim, bool holds)
{
    sim->event_since = !holds                    ? (double)NAN
                       : isnan(sim->event_since) ? sim->t
                                                 : sim->event_since;
    sim->event_passed = sim->t >= sim->event_since + sim->def.event_hold;
    sim->event_since = sim->event_passed ? (double)INFINITY : sim->event_since;
}

weft_status weft__sim_find_event(weft_sim *sim, double t0, weft_error *why)
{
    bracket in = { .t0 = t0, .a = t0, .b = sim->t, .ga = sim->event };
    in.gb = value(sim);
    sim->event = in.gb;
    if (sim->def.event_hold > 0.0) {
        hold(sim, in.gb <= 0.0);
        return WEFT_OK;
    }
    sim->event_passed = in.ga > 0.0 && in.gb <= 0.0;
    if (!sim->event_passed) {
        return WEFT_OK;
    }
    sim->event = -1.0;
    /* `before`: the step that found the event is the last one counted */
    return locate(sim, &in, weft_sim_stats(sim).steps - 1, why);
}

bool weft_sim_event(const weft_sim *sim)
{
    return sim->event_passed;
}
