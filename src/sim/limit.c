/* SPDX-License-Identifier: BSD-3-Clause */
/* limit.c -- shortens springs that have become too long in a step: sweeps of
 * projections that `fast` extrapolates, as derived in docs/theory/model.md, "Strain
 * limits".
 */
#include "sim/simulation.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/memory.h"
#include "base/sized.h"
#include "cloth/model.h"
#include "forces/springs/limit_springs.h"

/* Momentum that makes sweeps move GROWTH times as far as the least one is stopped, and
 * is then kept below CALMED of its value. */
#define GROWTH 10.0
#define CALMED 0.7

weft_status weft__limit_init(weft__limit *limit, const weft_limit_def *def,
                             const weft_cloth *cloth, const weft_allocator *memory,
                             weft_error *err)
{
    if (def->method == WEFT_LIMIT_NONE) {
        return WEFT_OK;
    }
    weft__refusal first = { WEFT_OK, err };
    weft__limit_check(def, &(weft__faults){ weft__keep_first, &first });
    if (first.status != WEFT_OK) {
        return first.status;
    }
    if (cloth->mesh.triangles != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "a strain limit needs a grid: it shortens springs");
    }
    const size_t count = 3 * weft_cloth_particles(cloth);
    const bool fast = def->solver == WEFT_LIMIT_FAST;
    double *x = weft__alloc(memory, (fast ? 3 : 1) * count, sizeof *x);
    if (x == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a strain limit");
    }
    *limit = (weft__limit){
        .def = *def,
        .cloth = cloth,
        .count = count,
        .x = x,
        .previous = fast ? x + count : NULL,
        .start = fast ? x + 2 * count : NULL,
    };
    return WEFT_OK;
}

/* The effect of the last sweep, in the product of the projections. */
typedef struct limit_progress {
    double back;   /* (z - x_(k+1), x_(k+1) - x_k) */
    double moved2; /* |z - x_(k+1)|^2 */
} limit_progress;

static limit_progress look_back(const weft__limit *self)
{
    const size_t n = self->count / 3;
    limit_progress sum = { 0 };
    for (size_t i = 0; i < n; ++i) {
        const double mass = weft_cloth_particle_mass(self->cloth, i);
        for (size_t j = i; j < self->count; j += n) {
            const double undone = self->start[j] - self->x[j];
            sum.back += mass * undone * (self->x[j] - self->previous[j]);
            sum.moved2 += mass * undone * undone;
        }
    }
    return sum;
}

/* From x_(k+1) to the z of the next sweep. */
static void extrapolate(weft__limit *self)
{
    const limit_progress last = look_back(self);
    const bool grown = last.moved2 > GROWTH * GROWTH * self->least2;
    const bool restart = grown || last.back > 0.0;
    if (grown && self->t > 1.0) {
        self->most = fmax(1.0, CALMED * fmin(self->t, self->most));
    }
    self->least2 = grown ? last.moved2 : fmin(self->least2, last.moved2);
    const double next = 0.5 * (1.0 + sqrt(1.0 + 4.0 * self->t * self->t));
    const double t = restart ? 1.0 : fmin(next, self->most);
    const double factor = restart ? 0.0 : (self->t - 1.0) / t;
    for (size_t j = 0; j < self->count; ++j) {
        const double x = self->x[j];
        self->x[j] = x + factor * (x - self->previous[j]);
        self->previous[j] = x;
    }
    self->t = t;
}

/* Sweeps until the limit is met, or the allowed number of times. */
static bool limit_solve(weft__limit *self)
{
    const bool fast = self->def.solver == WEFT_LIMIT_FAST;
    const size_t bytes = self->count * sizeof *self->x;
    bool met = false;
    self->t = 1.0;
    self->most = self->least2 = INFINITY;
    if (fast) {
        memcpy(self->previous, self->x, bytes);
    }
    for (size_t i = 0; i < self->def.sweeps && !met; ++i) {
        if (fast && i > 0) {
            extrapolate(self);
        }
        if (fast) {
            memcpy(self->start, self->x, bytes);
        }
        weft__limited_sweep(&self->cloth->springs, &self->def, self->x);
        ++self->stats.sweeps;
        met = weft__limited_excess(&self->cloth->springs, &self->def, false, 1, self->x)
              == 0;
    }
    return met;
}

/* The limited positions: the present ones, or those that the velocities lead to. */
static double candidate(const weft__limit *self, double h, const double *y, size_t j)
{
    return self->def.method == WEFT_LIMIT_PROVOT ? y[j] : y[j] + h * y[self->count + j];
}

/* Component j of the corrected state. */
static void corrected(const weft__limit *self, double h, const double *y, size_t j,
                      double *x, double *v)
{
    const bool provot = self->def.method == WEFT_LIMIT_PROVOT;
    const double dx = self->x[j] - candidate(self, h, y, j);
    *x = provot && dx != 0.0 ? self->x[j] : y[j]; /* -0 stays -0 */
    *v = self->def.keep_velocity || dx == 0.0 ? y[self->count + j]
                                              : y[self->count + j] + dx / h;
}

/* Changes nothing if a number would overflow. */
static bool limit_store(const weft__limit *self, double h, double *y)
{
    double x, v;
    bool changed = false;
    for (size_t j = 0; j < self->count; ++j) {
        corrected(self, h, y, j, &x, &v);
        if (!isfinite(x) || !isfinite(v)) {
            return false;
        }
    }
    for (size_t j = 0; j < self->count; ++j) {
        corrected(self, h, y, j, &x, &v);
        changed = changed || x != y[j] || v != y[self->count + j];
        y[j] = x;
        y[self->count + j] = v;
    }
    return changed;
}

/* A step that is cut short by a frame must not turn the excess left by earlier steps
 * into a large velocity: it counts as long as the one before. */
static bool limit_apply(weft__limit *limit, double step, double *y)
{
    const double h = fmax(step, limit->last_step);
    limit->last_step = step;
    limit->solved = true;
    for (size_t j = 0; j < limit->count; ++j) {
        limit->x[j] = candidate(limit, h, y, j);
    }
    if (weft__limited_excess(&limit->cloth->springs, &limit->def, false, 1, limit->x)
        == 0) {
        return false;
    }
    ++limit->stats.corrected;
    limit->solved = limit_solve(limit);
    return limit_store(limit, h, y);
}

/* Counts a state beyond its bounds. */
static bool is_met(weft__limit *limit, const double *y)
{
    const bool met
        = weft__limited_excess(&limit->cloth->springs, &limit->def, false, 1, y) == 0;
    limit->stats.unconverged += !met;
    return met;
}

void weft_sim_limit_stats_sized(weft_limit_stats *out, size_t size, const weft_sim *sim)
{
    weft__sized_write(out, size, &sim->limit.stats, sizeof sim->limit.stats);
}

weft_spring weft_sim_limit_worst(const weft_sim *sim)
{
    if (!weft__sim_limits(sim)) {
        return (weft_spring){ 0 };
    }
    return weft__limited_worst(&sim->cloth->springs, &sim->def.limit, sim->y);
}

size_t weft_sim_limit_held(const weft_sim *sim)
{
    return weft__limited_excess(&sim->cloth->springs, &sim->limit.def, true, SIZE_MAX,
                                sim->y);
}

static void warn_of_limit(const weft_sim *sim)
{
    const weft_spring worst = weft_sim_limit_worst(sim);
    const bool solved = sim->limit.solved;
    char text[96];
    weft__log(&sim->def.log, WEFT_LOG_WARNING,
              "limit: not met %s at t = %.9g s; %s is at %.3g %%; reported once",
              !solved ? "within its sweeps"
              : sim->def.limit.method == WEFT_LIMIT_BRIDSON
                  ? "by bridson, which corrects velocities, after the forces of the "
                    "step (use provot or a smaller step)"
                  : "beside contact, which holds its correction back,",
              sim->t, weft_spring_text(sim->cloth, &worst, text, sizeof text),
              100.0 * worst.strain);
}

bool weft__sim_limit(weft_sim *sim, double h)
{
    const uint64_t before = sim->limit.stats.unconverged;
    const bool checks = weft__sim_checks(sim);
    if (checks) {
        memcpy(sim->guard.start, sim->y, weft_cloth_dim(sim->cloth) * sizeof *sim->y);
    }
    const bool changed = limit_apply(&sim->limit, h, sim->y);
    if (changed && checks) {
        weft__hold_back(&sim->forces, sim->t, sim->guard.start, sim->y);
    }
    if (!is_met(&sim->limit, sim->y) && before == 0) {
        warn_of_limit(sim);
    }
    return changed;
}
