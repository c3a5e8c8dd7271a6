/* SPDX-License-Identifier: BSD-3-Clause */
/* event.h -- the event function at any time of the last step, for the files of src/sim
 * that look for its falls. */
#pragma once

#include "sim/bands.h"
#include "sim/simulation.h"

/* [s] To which the time of a fall is known. */
#define WEFT__EVENT_TOLERANCE 1e-10

/* The event function g at a time [s]. */
typedef struct weft__sample {
    double t, g;
} weft__sample;

enum { WEFT__SAMPLES = 32 };

/* g > 0 at a, which it reached, and g <= 0 at b. */
typedef struct weft__bracket {
    weft__sample a, b;
    int side;       /* that moved last */
    unsigned tries; /* times within that were tried */
} weft__bracket;

static inline bool weft__bracket_open(const weft__bracket *of)
{
    return of->b.t - of->a.t
           > fmax(WEFT__EVENT_TOLERANCE, 4.0 * DBL_EPSILON * fabs(of->b.t));
}

/* [s] To be tried next; and what g was there. NaN counts as > 0. */
double weft__bracket_guess(weft__bracket *of);
void weft__bracket_narrow(weft__bracket *of, weft__sample at);

/* samples.c: the smallest of all bands; y has at least the motion. And g within the
 * last step, from weft__between_motion, after weft__between_look. */
double weft__event_value(weft_sim *sim, double t, const double *y);
double weft__event_within(weft_sim *sim, double t);

/* Writes g at both ends, which are known, at points within, and between two points
 * where it has the other sign for a shorter while; returns how many. */
size_t weft__event_samples(weft_sim *sim, weft__sample start, weft__sample end,
                           weft__sample at[WEFT__SAMPLES]);

/* From a, where g > 0, to b, where it is not, by what is within the step. */
weft__bracket weft__event_root(weft_sim *sim, weft__sample a, weft__sample b);

/* stop.c: whether the event is a quantity that the threads can sum; and its value. */
bool weft__stop_sums(const weft_sim *sim);
double weft__stop_value(const weft_sim *sim, double t, const double *y);
