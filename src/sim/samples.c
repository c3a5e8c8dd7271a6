/* SPDX-License-Identifier: BSD-3-Clause */
/* samples.c -- the event function g of a state, and within the last step on the
 * polynomial of between.c: at points of equal distance and, where it may have the other
 * sign between two of them, at more. Only where it is convex between two points does it
 * stay above the lines through its neighbours; these find every dip of a parabola. */
#include <math.h>

#include "sim/event.h"

/* Of a step: 8 points within it for orders up to 5, 11 up to 8. Three divides them. */
enum { LEAST_PARTS = 9, MOST_PARTS = 15 };

/* Four parts of a part: some 1e-10 of the distance of two points. */
enum { PARTS = 4, LEVELS = 16 };

double weft__event_value(weft_sim *sim, double t, const double *y)
{
    if (weft__stop_sums(sim)) {
        return weft__stop_value(sim, t, y);
    }
    ++sim->callbacks;
    const double g = sim->def.event(sim->def.event_ctx, sim->cloth, t, y);
    --sim->callbacks;
    double most = -g;
    if (sim->def.comm != NULL) {
        weft__bands_most(&sim->forces, &most, 1);
    }
    return -most;
}

/* ---- a bracket --------------------------------------------------------------------
 */

/* Where a line meets 0, of values that the Illinois rule has halved (M. Dowell,
 * P. Jarratt, BIT 11, 1971), and not at its ends; now and then a half: a line is slow
 * where g bends or jumps. */
double weft__bracket_guess(weft__bracket *of)
{
    const double a = of->a.t, b = of->b.t;
    const double t = a + (b - a) * (of->a.g / (of->a.g - of->b.g));
    const double margin = 0.25 * WEFT__EVENT_TOLERANCE;
    return of->tries++ % 4 == 3 || !isfinite(t) ? 0.5 * (a + b)
                                                : fmin(fmax(t, a + margin), b - margin);
}

void weft__bracket_narrow(weft__bracket *of, weft__sample at)
{
    if (at.g <= 0.0) {
        of->b = at;
        of->a.g *= of->side < 0 ? 0.5 : 1.0;
        of->side = -1;
    } else {
        of->a = at;
        of->b.g *= of->side > 0 ? 0.5 : 1.0;
        of->side = 1;
    }
}

/* ---- points within a step ----------------------------------------------------------
 */

double weft__event_within(weft_sim *sim, double t)
{
    return weft__event_value(sim, t, weft__between_motion(sim, t));
}

/* The slope of f > 0 at the point k that a convex f does not exceed on its other side,
 * by the neighbour towards `side`: that is the slope from there or, at an end, a
 * parabola's, made steeper by as much again. */
static double samples_slope(const double *f, size_t count, size_t k, int side)
{
    const bool end = side < 0 ? k == 0 : k + 1 == count;
    const double *at = f + k;
    const int back = -side;
    if (!end) {
        return at[0] - at[side];
    }
    return at[back] - at[0] - fmax(at[2 * back] - 2.0 * at[back] + at[0], 0.0);
}

/* What f[count] > 0, at equal distances, does not fall below between the points k and
 * k + 1. */
static double samples_least(const double *f, size_t count, size_t k)
{
    const double left = samples_slope(f, count, k, -1),
                 right = samples_slope(f, count, k + 1, 1);
    if (!(left < 0.0) || !(right < 0.0)) {
        return fmin(f[k], f[k + 1]);
    }
    const double meet = (f[k + 1] + right - f[k]) / (left + right);
    const double u = fmin(fmax(meet, 0.0), 1.0);
    return fmax(f[k] + left * u, f[k + 1] + right * (1.0 - u));
}

/* Between a and b, where sign * g >= 0, a time at which it has the other sign. */
static bool dig(weft_sim *sim, double sign, weft__sample a, weft__sample b,
                weft__sample *found)
{
    for (int level = 0; level < LEVELS; ++level) {
        weft__sample at[PARTS + 1] = { [0] = a, [PARTS] = b };
        double f[PARTS + 1], lowest = INFINITY;
        size_t part = 0;
        for (size_t k = 1; k < PARTS; ++k) {
            const double t = a.t + (b.t - a.t) * ((double)k / PARTS);
            *found = at[k] = (weft__sample){ t, weft__event_within(sim, t) };
            if (sign > 0.0 ? at[k].g <= 0.0 : at[k].g > 0.0) {
                return true;
            }
        }
        for (size_t k = 0; k <= PARTS; ++k) {
            f[k] = sign * at[k].g;
        }
        for (size_t k = 0; k < PARTS; ++k) {
            const double here = samples_least(f, PARTS + 1, k);
            part = here < lowest ? k : part;
            lowest = fmin(here, lowest);
        }
        if (!(lowest < 0.0)) {
            return false;
        }
        a = at[part];
        b = at[part + 1];
    }
    return false;
}

/* Whether g[parts + 1] at every third point, of which the others are not known yet, is
 * farther from 0 than twice the way that it goes from one to another. That is enough
 * for quantities of the motion, and not for a function of an embedder, which may jump.
 */
static bool far(const weft_sim *sim, const weft__sample *at, size_t parts)
{
    double least = INFINITY, most = -INFINITY;
    for (size_t k = 0; k <= parts; k += 3) {
        least = fmin(least, at[k].g);
        most = fmax(most, at[k].g);
    }
    return sim->def.event == weft_stop_event
           && fmax(least, -most) > 2.0 * (most - least);
}

size_t weft__event_samples(weft_sim *sim, weft__sample start, weft__sample end,
                           weft__sample at[WEFT__SAMPLES])
{
    const int order = sim->def.method->order == 0 ? 8 : sim->def.method->order;
    const size_t parts = order <= 5 ? LEAST_PARTS : order <= 8 ? 12 : MOST_PARTS;
    weft__sample even[MOST_PARTS + 1] = { [0] = start };
    double f[MOST_PARTS + 1];
    size_t count = 0;
    even[parts] = end;
    for (size_t pass = 0; pass < 2; ++pass) {
        for (size_t k = 1; k < parts; ++k) {
            if ((k % 3 == 0) == (pass == 0)) {
                const double t
                    = start.t + (end.t - start.t) * ((double)k / (double)parts);
                even[k] = (weft__sample){ t, weft__event_within(sim, t) };
            }
        }
        if (pass == 0 && far(sim, even, parts)) {
            at[0] = start;
            at[1] = end;
            return 2;
        }
    }
    for (size_t k = 0; k <= parts; ++k) {
        at[count++] = even[k];
        if (k == parts || (even[k].g > 0.0) != (even[k + 1].g > 0.0)) {
            continue;
        }
        const double sign = even[k].g > 0.0 ? 1.0 : -1.0;
        for (size_t i = 0; i <= parts; ++i) {
            f[i] = sign * even[i].g;
        }
        count += samples_least(f, parts + 1, k) < 0.0
                 && dig(sim, sign, even[k], even[k + 1], &at[count]);
    }
    return count;
}

weft__bracket weft__event_root(weft_sim *sim, weft__sample a, weft__sample b)
{
    weft__bracket in = { .a = a, .b = b };
    while (weft__bracket_open(&in)) {
        const double t = weft__bracket_guess(&in);
        weft__bracket_narrow(&in, (weft__sample){ t, weft__event_within(sim, t) });
    }
    return in;
}
