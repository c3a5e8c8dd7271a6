/* SPDX-License-Identifier: BSD-3-Clause */
/* checked_step.c -- steps of the stepper, rejected and halved until one is clear of
 * all shapes and of the cloth itself. */
#include <math.h>

#include "base/log.h"
#include "base/memory.h"
#include "cloth/model.h"
#include "mesh/surface.h"
#include "sim/bands.h"
#include "sim/simulation.h"
#include "sim/spaces.h"

/* Attempts among which the rejected steps are counted. */
enum { ATTEMPTS = 1000 };

/* A fixed step is halved ten times. */
#define LEAST_PART (1.0 / 1024.0)

weft_status weft__sim_make_start(weft_sim *sim, weft_error *err)
{
    if (sim->guard.start == NULL) {
        sim->guard.start = weft__alloc(
            &sim->memory, 2 * (weft_cloth_dim(sim->cloth) + WEFT__QUADRATURES),
            sizeof *sim->guard.start);
        if (sim->guard.start == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for contact");
        }
    }
    return WEFT_OK;
}

double *weft__sim_room(const weft_sim *sim)
{
    return sim->guard.start + weft_cloth_dim(sim->cloth) + WEFT__QUADRATURES;
}

/* As if the step from t0 had not been, but for the counts. */
static void take_back(weft_sim *sim, double t0)
{
    memcpy(sim->y, sim->guard.start, weft__sim_dim(sim) * sizeof *sim->y);
    weft__sensitivity_back(sim);
    sim->t = t0;
    sim->def.method->state_changed(sim->stepper);
    --sim->earlier.steps; /* modulo 2^64, as is the sum */
    ++sim->earlier.rejected;
}

/* One attempt from t0: *again if it was rejected, or failed in a shape. */
static weft_status attempt(weft_sim *sim, double t0, double end, bool *again,
                           weft_error *why)
{
    const weft_status status = weft__sim_method_step(sim, end, why);
    *again = false;
    if (status != WEFT_OK) {
        weft__bands_deepest(sim->def.comm, &sim->guard.penetration);
        *again = sim->guard.penetration.found /* it failed for a stage in a shape */
            = sim->guard.penetration.found
              && (status == WEFT_NOT_FINITE || status == WEFT_STEP_TOO_SMALL
                  || status == WEFT_SOLVER);
        return status;
    }
    const weft__path path = { t0, sim->t, sim->guard.start, sim->y };
    const bool clear = weft__path_clear(&sim->forces, &path);
    if (weft__bands_max(sim->def.comm, clear ? 0.0 : 1.0) > 0.0) {
        sim->guard.penetration = weft__path_penetration(&sim->forces, &path);
        const bool in_shape
            = sim->guard.penetration.found && sim->guard.penetration.pair[0].count == 0;
        if (!weft__bands_first(sim->def.comm, in_shape, &sim->guard.penetration,
                               sizeof sim->guard.penetration)) {
            (void)weft__bands_first(sim->def.comm, sim->guard.penetration.found,
                                    &sim->guard.penetration,
                                    sizeof sim->guard.penetration);
        }
        take_back(sim, t0);
        *again = true;
    } else {
        sim->guard.penetration.found = false;
    }
    return status;
}

static weft_status give_up(const weft_sim *sim, weft_error *why)
{
    const weft__penetration *at = &sim->guard.penetration;
    const weft__mesh *mesh = &sim->cloth->mesh;
    char text[WEFT__PENETRATION_TEXT];
    if (at->pair[0].count > 0) {
        return weft_error_set(why, WEFT_STEP_TOO_SMALL,
                              "%s cannot be kept apart: distance %.3g m after %.3g s",
                              weft__penetration_text(mesh, at, text), at->gap,
                              at->t - sim->t);
    }
    return weft_error_set(
        why, WEFT_STEP_TOO_SMALL,
        "%s cannot be kept out of shapes[%zu]: gap %.3g m after %.3g s",
        weft__particle_name(mesh, weft__vertex_of(mesh, at->particle), text,
                            sizeof text),
        at->shape, at->gap, at->t - sim->t);
}

/* Warns of a run that rejects more steps than it takes; again only after this share
 * was less than a tenth. */
static void checked_step_watch_pace(weft_sim *sim, bool rejected, double t,
                                    double tried)
{
    char text[WEFT__PENETRATION_TEXT];
    const bool stalls = (sim->guard.stall.rejected += rejected) > ATTEMPTS / 2;
    if (++sim->guard.stall.attempts < ATTEMPTS || (stalls && !rejected)) {
        return; /* that of which it warns is a rejected one */
    }
    if (stalls && !sim->guard.stall.told) {
        weft__log(
            &sim->def.log, WEFT_LOG_WARNING,
            "contact rolled back %u of the last %u steps at t = %.9g s, the last of "
            "%.3g s: %s, distance %.3g m; the run may take very long",
            sim->guard.stall.rejected, sim->guard.stall.attempts, t, tried,
            weft__penetration_text(&sim->cloth->mesh, &sim->guard.penetration, text),
            sim->guard.penetration.gap);
    }
    sim->guard.stall.told
        = stalls
          || (sim->guard.stall.told && sim->guard.stall.rejected >= ATTEMPTS / 10);
    sim->guard.stall.attempts = sim->guard.stall.rejected = 0;
}

weft_status weft__sim_checked_step(weft_sim *sim, double t_end, weft_error *why)
{
    const double t0 = sim->t, fixed = sim->config.fixed_step;
    const double least = fixed > 0.0 ? fixed * LEAST_PART : sim->config.min_step;
    char text[WEFT__PENETRATION_TEXT];
    TRY(weft_comm_agree(sim->def.comm, weft__spaces_grow(&sim->forces, why), why));
    memcpy(sim->guard.start, sim->y, weft__sim_dim(sim) * sizeof *sim->y);
    for (double end = t_end;;) {
        bool again;
        const weft_status status = attempt(sim, t0, end, &again, why);
        if (!again) {
            checked_step_watch_pace(sim, false, t0, 0.0);
            return status;
        }
        const double tried
            = status == WEFT_OK ? sim->guard.penetration.t - t0 : end - t0;
        const double h = 0.5 * (fixed > 0.0 ? fmin(fixed, tried) : tried);
        const bool adapted = status != WEFT_OK && fixed == 0.0; /* as far as it could */
        if (adapted || !(h >= least) || !(t0 + h > t0)) {
            return give_up(sim, why);
        }
        ++sim->guard.vetoed;
        checked_step_watch_pace(sim, true, t0, tried);
        end = t0 + h;
        weft__log(
            &sim->def.log, WEFT_LOG_DEBUG,
            "t = %.9g s: a step of %.3g s rolled back: %s", t0, tried,
            weft__penetration_text(&sim->cloth->mesh, &sim->guard.penetration, text));
    }
}
