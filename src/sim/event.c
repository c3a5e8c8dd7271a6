/* SPDX-License-Identifier: BSD-3-Clause */
/* event.c -- steps that end where a function g of the state falls to 0. Where that may
 * be is seen on the polynomial within the step; it is found on solutions: each trial is
 * the step taken again from its start to another end, and the last one with g <= 0 is
 * kept, so that a run goes on from a state of which that was seen. */
#include <math.h>
#include <string.h>

#include "sim/event.h"

#define WIDEN 16.0

/* The step that the method has taken, and the state to go on from, in between.kept. */
typedef struct fall_search {
    weft_sim *sim;
    weft__sample start, end;
    weft__sample kept;
    uint64_t before, steps; /* of the simulation at `start`; from there to `kept` */
    bool away;              /* a trial has left `kept` */
} fall_search;

/* ---- trials -----------------------------------------------------------------------
 */

static uint64_t steps_since(const fall_search *of)
{
    return weft_sim_stats(of->sim).steps - of->before;
}

/* Steps that are not part of the run count as rejected. */
static void reject(weft_sim *sim, uint64_t steps)
{
    sim->earlier.steps -= steps; /* modulo 2^64, as is the sum */
    sim->earlier.rejected += steps;
}

static void set_back(weft_sim *sim, double t, const double *y)
{
    memcpy(sim->y, y, weft__sim_dim(sim) * sizeof *sim->y);
    sim->t = t;
    sim->between.levels = 0;
    sim->def.method->state_changed(sim->stepper);
}

/* Takes the step again, to at->t. */
static weft_status try_end(fall_search *of, weft__sample *at, weft_error *why)
{
    weft_sim *sim = of->sim;
    reject(sim, steps_since(of));
    set_back(sim, of->start.t, sim->between.start);
    while (sim->t < at->t) {
        TRY(weft__sim_take_step(sim, at->t, why));
    }
    at->g = weft__event_value(sim, sim->t, sim->y);
    of->away = true;
    return WEFT_OK;
}

static void event_keep(fall_search *of, double g)
{
    of->kept = (weft__sample){ of->sim->t, g };
    of->steps = steps_since(of);
    of->away = false;
    memcpy(of->sim->between.kept, of->sim->y, weft__sim_dim(of->sim) * sizeof(double));
}

static void go_on_from_kept(fall_search *of)
{
    weft_sim *sim = of->sim;
    if (of->away) {
        reject(sim, steps_since(of) - of->steps);
        set_back(sim, of->kept.t, sim->between.kept);
    }
    sim->event.value = of->kept.g;
}

/* As try_end; keeps the state if g fell. */
static weft_status try_fall(fall_search *of, double t, weft__bracket *in,
                            weft_error *why)
{
    weft__sample at = { t, of->end.g };
    if (t == of->end.t) { /* kept, as no fall has been seen before */
        in->b = at;
        return WEFT_OK;
    }
    TRY(try_end(of, &at, why));
    if (at.g <= 0.0) {
        event_keep(of, at.g);
    }
    weft__bracket_narrow(in, at);
    return WEFT_OK;
}

/* A fall that solutions have too, near the one seen within the step and not after
 * `last`; else in->b.g stays > 0. */
static weft_status find_fall(fall_search *of, const weft__bracket *seen, double last,
                             weft__bracket *in, weft_error *why)
{
    const double first = in->a.t;
    const double least = fmax(WEFT__EVENT_TOLERANCE, seen->b.t - seen->a.t);
    double width = least;
    for (double t = seen->b.t; !(in->b.g <= 0.0) && in->a.t < last;
         t = fmin(t + width, last), width *= WIDEN) {
        TRY(try_fall(of, t, in, why));
    }
    for (width = least; in->b.g <= 0.0 && in->a.t == first && in->b.t - width > first;
         width *= WIDEN) {
        TRY(try_fall(of, in->b.t - width, in, why));
    }
    in->side = 0;
    while (in->b.g <= 0.0 && weft__bracket_open(in)) {
        TRY(try_fall(of, weft__bracket_guess(in), in, why));
    }
    return WEFT_OK;
}

/* From a to b, as seen within the step; *found if solutions have it. */
static weft_status settle(fall_search *of, weft__sample a, weft__sample b, bool *found,
                          weft_error *why)
{
    const weft__bracket seen = weft__event_root(of->sim, a, b);
    weft__bracket in = { .a = of->start, .b = { of->end.t, INFINITY } };
    event_keep(of, of->end.g);
    if (!(of->start.g > 0.0)) { /* it must have risen before */
        in.a = a;
        TRY(try_end(of, &in.a, why));
    }
    if (in.a.g > 0.0) {
        TRY(find_fall(of, &seen, b.t, &in, why));
    }
    *found = in.a.g > 0.0 && in.b.g <= 0.0;
    go_on_from_kept(of);
    return WEFT_OK;
}

/* ---- the end of a step ------------------------------------------------------------
 */

double weft__sim_before_event(weft_sim *sim, double t_end)
{
    const double end = sim->event.since + sim->def.event_hold;
    if (isnan(sim->event.value)) {
        sim->event.value = weft__event_value(sim, sim->t, sim->y);
    }
    return end > sim->t ? fmin(end, t_end) : t_end;
}

/* What was seen within the step but not on a solution was not there. */
static weft_status look_again(fall_search *of, bool found, weft_error *why)
{
    return found ? WEFT_OK : weft__between_look(of->sim, why);
}

static weft_status event_find_first(fall_search *of, weft__sample *at, size_t count,
                                    weft_error *why)
{
    bool found = false;
    for (size_t k = 1; k < count && !found; ++k) {
        if (at[k - 1].g > 0.0 && at[k].g <= 0.0) {
            TRY(settle(of, at[k - 1], at[k], &found, why));
            TRY(look_again(of, found, why));
            at[k].g = at[k - 1].g;
        } else if (isnan(at[k].g)) {
            at[k] = at[k - 1];
        }
    }
    of->sim->event.passed = found;
    return WEFT_OK;
}

/* Ends the step at t, when an event has held for so long; unless solutions differ. */
static weft_status end_hold(fall_search *of, double t, bool *found, weft_error *why)
{
    weft__sample at = { t, of->end.g };
    if (t < of->end.t) {
        event_keep(of, of->end.g);
        TRY(try_end(of, &at, why));
        if (at.g <= 0.0) {
            event_keep(of, at.g);
        }
        go_on_from_kept(of);
    }
    *found = at.g <= 0.0;
    return look_again(of, *found, why);
}

/* [s] Since when it holds at k, if it did since then at k - 1. */
static double held_since(weft_sim *sim, const weft__sample *at, size_t k, double since)
{
    const bool fell = k > 0 && at[k - 1].g > 0.0;
    return !(at[k].g <= 0.0) ? (double)NAN
           : !isnan(since)   ? since
           : fell            ? weft__event_root(sim, at[k - 1], at[k]).b.t
                             : at[k].t;
}

/* Of an event that must hold. */
static weft_status hold(fall_search *of, const weft__sample *at, size_t count,
                        weft_error *why)
{
    weft_sim *sim = of->sim;
    double since = sim->event.since;
    bool found = false;
    for (size_t k = 0; k < count && !found; ++k) {
        const double before = since + sim->def.event_hold;
        since = held_since(sim, at, k, since);
        /* it may rise after that */
        const bool rises = isnan(since) && before < at[k].t && k > 0
                           && before > at[k - 1].t
                           && weft__event_within(sim, before) <= 0.0;
        const double due = rises ? before : since + sim->def.event_hold;
        if (due <= at[k].t) {
            TRY(end_hold(of, due, &found, why));
            since = found ? (double)INFINITY : (double)NAN;
        }
    }
    sim->event.since = since;
    sim->event.passed = found;
    return WEFT_OK;
}

static weft_status look_within(fall_search *of, weft_error *why)
{
    weft_sim *sim = of->sim;
    weft__sample at[WEFT__SAMPLES];
    const double long_enough = sim->def.event_hold;
    if (long_enough > of->end.t - of->start.t && !(of->end.g <= 0.0)) {
        sim->event.since = (double)NAN; /* it has not held to the end */
        return WEFT_OK;
    }
    TRY(weft__between_look(sim, why));
    const size_t count = weft__event_samples(sim, of->start, of->end, at);
    return long_enough > 0.0 ? hold(of, at, count, why)
                             : event_find_first(of, at, count, why);
}

weft_status weft__sim_find_event(weft_sim *sim, weft_error *why)
{
    const double since = sim->event.since;
    fall_search of = { .sim = sim,
                       .start = { sim->between.t0, sim->event.value },
                       .end = { sim->t, weft__event_value(sim, sim->t, sim->y) },
                       .before = weft_sim_stats(sim).steps - 1 };
    sim->event.value = of.end.g;
    const weft_status status = look_within(&of, why);
    if (status != WEFT_OK) {
        reject(sim, steps_since(&of));
        set_back(sim, of.start.t, sim->between.start);
        sim->event.value = of.start.g;
        sim->event.since = since;
    }
    return status;
}

bool weft_sim_event(const weft_sim *sim)
{
    return sim->event.passed;
}
