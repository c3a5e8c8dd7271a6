/* SPDX-License-Identifier: BSD-3-Clause */
/* between.c -- the state within the last step, as a polynomial in s = (t - t0) / h:
 * Hermite's for x, v, a at both ends and a at inner nodes, v(s) = x'(s) / h; derived in
 * docs/theory/model.md, "States within a step". */

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "sim/bands.h"
#include "sim/simulation.h"

/* Any first few of them determine both polynomials well: the sum of the weights'
 * magnitudes stays below 6. Symmetric ones would not. */
static const double nodes[WEFT__NODES] = { 0.8, 0.4, 0.6, 0.2 };

enum { MOST = 6 + WEFT__NODES, QUADRATURE_CONDITIONS = 4 };

/* A condition on a polynomial p: its derivative `order` at s. */
typedef struct condition {
    unsigned order;
    double s;
} condition;

/* Of x: value, rate, second rate at 0, then at 1; of a quadrature: value and rate. */
static unsigned conditions(unsigned highest, unsigned inner, condition of[MOST])
{
    unsigned count = 0;
    for (unsigned end = 0; end < 2; ++end) {
        for (unsigned order = 0; order <= highest; ++order) {
            of[count++] = (condition){ order, (double)end };
        }
    }
    for (unsigned i = 0; i < inner; ++i) {
        of[count++] = (condition){ highest, nodes[i] };
    }
    return count;
}

/* The condition of s^power. */
static double applied(condition of, unsigned power)
{
    double value = power >= of.order ? 1.0 : 0.0;
    for (unsigned k = 0; k < of.order && value != 0.0; ++k) {
        value *= (double)(power - k);
    }
    for (unsigned k = of.order; k < power; ++k) {
        value *= of.s;
    }
    return value;
}

/* Solves a w = b of `count` rows by Gauss's elimination; w comes in place of b. */
static void between_solve(double a[MOST][MOST], double b[MOST], unsigned count)
{
    for (unsigned k = 0; k < count; ++k) {
        unsigned pivot = k;
        for (unsigned r = k + 1; r < count; ++r) {
            pivot = fabs(a[r][k]) > fabs(a[pivot][k]) ? r : pivot;
        }
        for (unsigned c = 0; c < count; ++c) {
            const double kept = a[k][c];
            a[k][c] = a[pivot][c];
            a[pivot][c] = kept;
        }
        const double kept = b[k];
        b[k] = b[pivot];
        b[pivot] = kept;
        for (unsigned r = k + 1; r < count; ++r) {
            const double factor = a[r][k] / a[k][k];
            for (unsigned c = k; c < count; ++c) {
                a[r][c] -= factor * a[k][c];
            }
            b[r] -= factor * b[k];
        }
    }
    for (unsigned k = count; k-- > 0;) {
        for (unsigned c = k + 1; c < count; ++c) {
            b[k] -= a[k][c] * b[c];
        }
        b[k] /= a[k][k];
    }
}

/* The weights w with which the conditions' values make p, or its rate, at s: exact for
 * all powers that they determine. */
static void weights(unsigned highest, unsigned inner, condition at, double w[MOST])
{
    condition of[MOST];
    double a[MOST][MOST];
    const unsigned count = conditions(highest, inner, of);
    for (unsigned power = 0; power < count; ++power) {
        for (unsigned k = 0; k < count; ++k) {
            a[power][k] = applied(of[k], power);
        }
        w[power] = applied(at, power);
    }
    between_solve(a, w, count);
}

/* sum += factor * from, plane by plane. */
static void between_add(double *sum, double factor, const double *from, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        sum[i] += factor * from[i];
    }
}

/* A resting particle keeps its bits: differences and rates that are 0 add nothing. */
static void between_add_difference(double *sum, double factor, const double *from,
                                   const double *to, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        sum[i] += factor * (to[i] - from[i]);
    }
}

/* The weights of what determines the motion at s, for positions and for h times the
 * velocities. */
typedef struct motion_weights {
    double x[MOST], v[MOST];
} motion_weights;

static motion_weights motion_weights_at(unsigned highest, unsigned inner, double s)
{
    motion_weights of;
    weights(highest, inner, (condition){ 0, s }, of.x);
    weights(highest, inner, (condition){ 1, s }, of.v);
    return of;
}

/* Positions and h times the velocities to out[2 count], of both ends. */
static void add_ends(const weft_sim *sim, const motion_weights *w, double *out)
{
    const size_t count = weft_cloth_dim(sim->cloth) / 2;
    const double *x0 = sim->between.start, *v0 = x0 + count;
    const double *x1 = sim->y, *v1 = x1 + count;
    const double *a0 = sim->between.rates[0] + count;
    const double *a1 = sim->between.rates[1] + count;
    const double h = sim->t - sim->between.t0;
    const motion_weights of = *w;
    double *x = out, *v = out + count;
    for (size_t i = 0; i < count; ++i) {
        const double displacement = x1[i] - x0[i];
        x[i] = 0.0 + x0[i] + of.x[3] * displacement + h * of.x[1] * v0[i]
               + h * of.x[4] * v1[i] + h * h * of.x[2] * a0[i]
               + h * h * of.x[5] * a1[i];
        v[i] = 0.0 + of.v[3] * displacement + h * of.v[1] * v0[i] + h * of.v[4] * v1[i]
               + h * h * of.v[2] * a0[i] + h * h * of.v[5] * a1[i];
    }
}

/* The same without accelerations: the cubic through positions and velocities. */
static void add_cubic(const weft_sim *sim, const motion_weights *w, double *out)
{
    const size_t count = weft_cloth_dim(sim->cloth) / 2;
    const double *x0 = sim->between.start, *v0 = x0 + count;
    const double *x1 = sim->y, *v1 = x1 + count;
    const double h = sim->t - sim->between.t0;
    const motion_weights of = *w;
    double *x = out, *v = out + count;
    for (size_t i = 0; i < count; ++i) {
        const double displacement = x1[i] - x0[i];
        x[i] = x0[i] + of.x[2] * displacement + h * of.x[1] * v0[i]
               + h * of.x[3] * v1[i];
        v[i] = of.v[2] * displacement + h * of.v[1] * v0[i] + h * of.v[3] * v1[i];
    }
}

/* Positions and velocities at s, to out[6 N]. levels 0: without accelerations. */
static void motion_at(const weft_sim *sim, unsigned levels, double s, double *out)
{
    const weft__between *of = &sim->between;
    const size_t count = weft_cloth_dim(sim->cloth) / 2;
    const double h = sim->t - of->t0;
    const motion_weights w
        = motion_weights_at(levels > 0 ? 2 : 1, levels > 0 ? levels - 1 : 0, s);
    const unsigned end_velocity = levels > 0 ? 4 : 3;
    levels > 0 ? add_ends(sim, &w, out) : add_cubic(sim, &w, out);
    weft__piece_jump(sim, -h * w.x[end_velocity], out);
    weft__piece_jump(sim, -h * w.v[end_velocity], out + count);
    for (unsigned i = 0; i + 1 < levels; ++i) {
        between_add(out, h * h * w.x[6 + i], of->rates[2 + i] + count, count);
        between_add(out + count, h * h * w.v[6 + i], of->rates[2 + i] + count, count);
    }
    for (size_t i = count; i < 2 * count; ++i) {
        out[i] /= h;
    }
}

static void quadratures_at(const weft_sim *sim, unsigned inner, double s, double *out)
{
    const weft__between *of = &sim->between;
    const size_t dim = weft_cloth_dim(sim->cloth), count = weft__sim_dim(sim) - dim;
    const double h = sim->t - of->t0;
    double w[MOST];
    weights(1, inner, (condition){ 0, s }, w);
    memcpy(out, of->start + dim, count * sizeof *out);
    between_add_difference(out, w[2], of->start + dim, sim->y + dim, count);
    between_add(out, h * w[1], of->rates[0] + dim, count);
    between_add(out, h * w[3], of->rates[1] + dim, count);
    for (unsigned i = 0; i < inner; ++i) {
        between_add(out, h * w[QUADRATURE_CONDITIONS + i], of->rates[2 + i] + dim,
                    count);
    }
}

static void state_at(const weft_sim *sim, unsigned inner, double s, double *y)
{
    motion_at(sim, inner + 1, s, y);
    quadratures_at(sim, inner, s, y + weft_cloth_dim(sim->cloth));
}

/* The rates in a state of the step; as weft_rhs_fn, and the same on all bands. */
static int between_evaluate(weft_sim *sim, double t, const double *y, double *rates)
{
    ++sim->earlier.rhs_calls;
    const int failed = weft__sim_rhs(t, y, rates, sim);
    const double worst = weft__bands_max(sim->def.comm, failed < 0   ? 2.0
                                                        : failed > 0 ? 1.0
                                                                     : 0.0);
    return worst == 2.0 ? -1 : worst == 1.0;
}

/* The rates of both ends, then those of the nodes, node by node. A node that is not a
 * usable state, because a shape is there, leaves those before. */
static weft_status find_rates(weft_sim *sim, weft_error *err)
{
    weft__between *of = &sim->between;
    const double h = sim->t - of->t0, piece = sim->forces.piece;
    sim->forces.piece = sim->piece;
    memcpy(of->shown, sim->y, weft__sim_dim(sim) * sizeof *of->shown);
    weft__piece_jump(sim, -1.0, of->shown + weft_cloth_dim(sim->cloth) / 2);
    int failed = between_evaluate(sim, of->t0, of->start, of->rates[0]);
    failed
        = failed == 0 ? between_evaluate(sim, sim->t, of->shown, of->rates[1]) : failed;
    for (of->levels = failed == 0; failed == 0 && of->levels <= of->nodes;) {
        for (unsigned i = 0; failed == 0 && i < of->levels; ++i) {
            state_at(sim, of->levels - 1, nodes[i], of->shown);
            failed = between_evaluate(sim, of->t0 + nodes[i] * h, of->shown,
                                      of->rates[2 + i]);
        }
        of->levels += failed == 0;
    }
    sim->guard.penetration.found = false;
    sim->forces.piece = piece;
    return failed < 0 || of->levels == 0
               ? weft_error_set(err, failed < 0 ? WEFT_STOPPED : WEFT_NOT_FINITE,
                                "no rates between t = %.9g s and %.9g s", of->t0,
                                sim->t)
               : WEFT_OK;
}

weft_status weft__between_init(weft_sim *sim, weft_error *err)
{
    weft__between *of = &sim->between;
    const size_t dim = weft_cloth_dim(sim->cloth) + WEFT__QUADRATURES;
    const int order = sim->def.method->order;
    if (!sim->def.interpolate && sim->def.event == NULL) {
        return WEFT_OK;
    }
    if (!weft__not_negative(sim->def.event_hold)) {
        return weft_error_set(err, WEFT_INVALID, "event_hold %g s must be finite, >= 0",
                              sim->def.event_hold);
    }
    if (sim->def.correct != NULL || sim->def.limit.method != WEFT_LIMIT_NONE) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "states within a step, and events, are not known with a "
                              "strain limit or a correction after it");
    }
    /* positions of order 5 + nodes, velocities 4 + nodes, quadratures 3 + nodes; order
     * 0: a method of variable order */
    const int wanted = (order == 0 ? 8 : order) - 5 + sim->ledger.on;
    of->nodes = wanted < 0 ? 0 : wanted < WEFT__NODES ? (unsigned)wanted : WEFT__NODES;
    /* events see no accelerations in steps that are short beside the motion, those of
     * low order and of multistep methods, and none of stiff modes */
    const uint32_t flags = sim->def.method->flags;
    of->smooth = (flags & WEFT_STEPPER_MULTISTEP) != 0
                 || (order > 0 && (order < 4 || (flags & WEFT_STEPPER_IMPLICIT) != 0));
    of->start = weft__alloc(&sim->memory, dim * (5 + of->nodes), sizeof *of->start);
    if (of->start == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for states within steps");
    }
    of->shown = of->start + dim;
    for (unsigned i = 0; i < 2 + of->nodes; ++i) {
        of->rates[i] = of->start + (2 + i) * dim;
    }
    of->kept = of->start + (4 + of->nodes) * dim;
    return WEFT_OK;
}

void weft__between_begin(weft_sim *sim)
{
    weft__between *of = &sim->between;
    memcpy(of->start, sim->y, weft__sim_dim(sim) * sizeof *of->start);
    of->t0 = sim->t;
    of->levels = 0;
}

void weft__between_forget(weft_sim *sim)
{
    sim->between.t0 = INFINITY;
}

/* Puts the state at t to `shown`. */
static weft_status between_find(weft_sim *sim, double t, weft_error *err)
{
    weft__between *of = &sim->between;
    if (of->start == NULL || !(t >= of->t0 && t < sim->t)) {
        return weft_error_set(
            err, WEFT_INVALID, "t = %.*g s is not %s", weft_text_digits(t), t,
            of->start == NULL ? "known: `interpolate` was not asked for"
                              : "within the last step");
    }
    TRY(of->levels == 0 ? find_rates(sim, err) : WEFT_OK);
    state_at(sim, of->levels - 1, (t - of->t0) / (sim->t - of->t0), of->shown);
    return WEFT_OK;
}

weft_status weft__between_look(weft_sim *sim, weft_error *err)
{
    const weft__between *of = &sim->between;
    weft_error why = { 0 };
    return of->smooth || of->levels > 0 || find_rates(sim, &why) != WEFT_STOPPED
               ? WEFT_OK
               : weft_error_set(err, why.status, "%s", why.message);
}

double *weft__between_motion(weft_sim *sim, double t)
{
    weft__between *of = &sim->between;
    motion_at(sim, of->smooth ? 0 : of->levels, (t - of->t0) / (sim->t - of->t0),
              of->shown);
    return of->shown;
}

weft_status weft_sim_between(weft_sim *sim, double t, double *y, weft_error *err)
{
    const bool at_end = t == sim->t;
    TRY(weft__sim_outside(sim, "weft_sim_between", err));
    TRY(at_end ? WEFT_OK : between_find(sim, t, err));
    memcpy(y, at_end ? sim->y : sim->between.shown,
           weft_cloth_dim(sim->cloth) * sizeof *y);
    return WEFT_OK;
}

/* Exchanges the present state and the other one. */
static void between_swap(weft_sim *sim, double *t)
{
    double *const y = sim->y;
    const double now = sim->t;
    sim->y = sim->between.shown;
    sim->t = *t;
    sim->between.shown = y;
    *t = now;
}

weft_status weft__between_show(weft_sim *sim, double t, weft_error *err)
{
    weft__between *of = &sim->between;
    if (t == sim->t) {
        return WEFT_OK;
    }
    TRY(between_find(sim, t, err));
    of->behind = t;
    between_swap(sim, &of->behind);
    of->showing = true;
    ++sim->callbacks;
    return WEFT_OK;
}

void weft__between_hide(weft_sim *sim)
{
    weft__between *of = &sim->between;
    if (of->showing) {
        between_swap(sim, &of->behind);
        of->showing = false;
        --sim->callbacks;
    }
}

bool weft_sim_is_between(const weft_sim *sim)
{
    return sim->between.showing;
}
