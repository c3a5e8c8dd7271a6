/* SPDX-License-Identifier: BSD-3-Clause */
/* stop.c -- the quantities that end a run, as functions of the state. */
#include <math.h>

#include "mesh/blocks.h"
#include "sim/event.h"

const char *weft_stop_name(weft_stop_quantity quantity)
{
    static const char *const names[WEFT_STOPS]
        = { "", "max_strain", "min_gap", "kinetic", "at_rest" };
    return (unsigned)quantity < WEFT_STOPS ? names[quantity] : "";
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
        [WEFT_STOP_GAP] = weft__block_gaps,
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

bool weft__stop_sums(const weft_sim *sim)
{
    const weft_stop_def *at = sim->def.event_ctx;
    if (sim->def.event != weft_stop_event || measure_of(at) == NULL) {
        return false;
    }
    /* without bands weft_stop_event takes the gaps to bodies too, and the energies
     * without those of contact */
    return sim->def.comm != NULL
           || (at->quantity != WEFT_STOP_GAP && !weft__sim_checks(sim));
}

double weft__stop_value(const weft_sim *sim, double t, const double *y)
{
    const weft_stop_def *at = sim->def.event_ctx;
    const weft__state of = { .t = t, .y = y };
    const weft_measures all = weft__forces_measure(&sim->forces, &of, measure_of(at));
    return stop_value(at, &all);
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
