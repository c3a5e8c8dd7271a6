/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_step.c -- one step of the method, and what corrects it. */
#include <inttypes.h>

#include "base/log.h"
#include "sim/simulation.h"

static bool correct(weft_sim *sim, double h)
{
    ++sim->callbacks;
    const bool changed = sim->def.correct(sim->def.correct_ctx, sim->t, h, sim->y);
    --sim->callbacks;
    return changed;
}

/* `jumped`: by the embedder, so that no path leads to the state. */
static weft_status check_corrected(weft_sim *sim, bool jumped, weft_error *err)
{
    weft_error why = { 0 };
    if (!weft__all_finite(sim->y, weft_cloth_dim(sim->cloth))) {
        weft__sim_not_finite(sim, &why);
        return weft__sim_fail(sim, &why, err);
    }
    sim->guard.penetration = weft__state_penetration(sim->cloth, sim->t, sim->y);
    if (sim->guard.penetration.found) {
        weft__penetration_error(sim->cloth, &sim->guard.penetration, "was corrected to",
                                &why);
        return weft__sim_fail(sim, &why, err);
    }
    if (jumped) {
        const weft__search of = { .where = "after the correction " };
        (void)weft__crossings_error(sim->cloth, sim->t, sim->y, &of, &why);
    }
    return why.status == WEFT_OK ? WEFT_OK : weft__sim_fail(sim, &why, err);
}

/* After an accepted step of h: the strain limit, then the embedder's own. */
static weft_status apply_corrections(weft_sim *sim, double h, weft_error *err)
{
    weft__ledger *ledger = &sim->ledger;
    bool changed = false, jumped = false;
    weft__ledger_mark(ledger, &sim->forces, sim->t, sim->y);
    if (weft__sim_limits(sim) && weft__sim_limit(sim, h)) {
        weft__ledger_account(ledger, &sim->forces, sim->t, sim->y, &ledger->work_limit);
        changed = true;
    }
    if (sim->def.correct != NULL && correct(sim, h)) {
        weft__ledger_account(ledger, &sim->forces, sim->t, sim->y,
                             &ledger->work_outside);
        changed = jumped = true;
    }
    if (changed) {
        sim->def.method->state_changed(sim->stepper);
    }
    return changed ? check_corrected(sim, jumped, err) : WEFT_OK;
}

static void log_rejected(weft_sim *sim, double h)
{
    const uint64_t rejected = weft_sim_stats(sim).rejected;
    if (rejected > sim->rejected) {
        weft__log(&sim->def.log, WEFT_LOG_DEBUG,
                  "t = %.9g s: a step of %.3g s after %" PRIu64 " rejected", sim->t, h,
                  rejected - sim->rejected);
    }
    sim->rejected = rejected;
}

/* A step within a piece of tables and keys. */
static weft_status step_in_piece(weft_sim *sim, double t_end, weft_error *why)
{
    const double piece_end = weft__piece_enter(sim, &t_end);
    if (sim->def.event != NULL) {
        t_end = weft__sim_before_event(sim, t_end);
    }
    weft_status status = weft__sim_take_step(sim, t_end, why);
    if (status == WEFT_OK && sim->def.event != NULL) {
        status = weft__sim_find_event(sim, why);
    }
    weft__piece_leave(sim, piece_end);
    return status;
}

/* [s] No frame is taken to be longer: a caller may step towards the end of a run. */
#define LONGEST_FRAME 0.04

/* Before a step towards t_end, which is another with each frame. */
static void sim_step_watch_pace(weft_sim *sim, double t_end)
{
    weft__pace *of = &sim->pace;
    if (t_end != of->end) {
        of->frame = fmin(t_end - sim->t, LONGEST_FRAME);
        of->end = t_end;
        if (weft__sim_checks(sim)) {
            weft__sim_look_ahead(sim);
        }
    }
    if (of->steps == WEFT__PACE) {
        weft__sim_look_back(sim);
        of->steps = 0;
    }
    of->since = of->steps == 0 ? sim->t : of->since;
    ++of->steps;
}

weft_status weft_sim_step(weft_sim *sim, double t_end, weft_error *err)
{
    TRY(weft__sim_outside_play(sim, "weft_sim_step", err));
    if (!(t_end > sim->t) || !isfinite(t_end)) {
        return weft_error_set(err, WEFT_INVALID, "step from %.*g s to %.*g s",
                              weft_text_digits(sim->t), sim->t, weft_text_digits(t_end),
                              t_end);
    }
    if (sim->t >= sim->passage.next) {
        TRY(weft__sim_passages(sim, err));
    }
    weft_error why = { 0 };
    const double before = sim->t;
    sim->failure.status = WEFT_OK;
    sim->guard.penetration.found = false;
    sim->event.passed = false;
    sim_step_watch_pace(sim, t_end);
    if (sim->between.start != NULL) {
        weft__between_begin(sim);
    }
    const weft_status status = step_in_piece(sim, t_end, &why);
    if (status != WEFT_OK) {
        why.status = status;
        return weft__sim_fail(sim, &why, err);
    }
    if (sim->passage.next < sim->t) {
        TRY(weft__sim_look_within(sim, before, err));
    }
    const double h = sim->t - before;
    if (sim->def.log.write != NULL) {
        log_rejected(sim, h);
    }
    return weft__sim_limits(sim) || sim->def.correct != NULL
               ? apply_corrections(sim, h, err)
               : WEFT_OK;
}

weft_status weft_sim_advance(weft_sim *sim, double t_end, weft_error *err)
{
    weft_status status = WEFT_OK;
    sim->sensitivity.passes = sim->def.log.write == NULL && sim->def.stop == NULL;
    for (bool event = false; status == WEFT_OK && sim->t != t_end && !event;
         event = sim->event.passed) {
        status = weft_sim_step(sim, t_end, err);
    }
    sim->sensitivity.passes = false;
    return status == WEFT_OK ? weft__sim_passages(sim, err) : status;
}

weft_status weft_sim_check_frame(weft_sim *sim, weft_error *err)
{
    TRY(weft__sim_outside(sim, "weft_sim_check_frame", err));
    return weft__sim_passages(sim, err);
}
