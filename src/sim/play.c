/* SPDX-License-Identifier: BSD-3-Clause */
/* play.c -- steps from frame to frame. Times are computed from the frame's number,
 * never accumulated. */
#include <math.h>

#include "base/sized.h"
#include "sim/simulation.h"

/* A last interval shorter than this part of a frame belongs to the frame before. */
#define SLIVER 1e-9

size_t weft_run_last_frame(const weft_run_def *run)
{
    const double frames = ceil(run->duration * run->fps - SLIVER);
    return frames < 1.0 ? 1 : frames < 1e15 ? (size_t)frames : (size_t)1e15;
}

double weft_run_step(const weft_run_def *run, double h)
{
    const double frame = fmin(1.0 / run->fps, run->duration);
    const double steps = fmax(ceil(frame / h - SLIVER), 1.0);
    return run->interpolate || isinf(steps) ? h : frame / steps;
}

double weft_run_frame_time(const weft_run_def *run, size_t i)
{
    return i >= weft_run_last_frame(run) ? run->duration : (double)i / run->fps;
}

static bool is_checkpoint(const weft_play *play, size_t i)
{
    const size_t interval = play->run->checkpoint;
    return interval != 0 && i != 0 && i % interval == 0 && i != play->last;
}

/* [s] where steps towards frame i must end: there or, if frames are taken from within
 * steps, at the next checkpoint. */
static double target(const weft_sim *sim, const weft_play *play, size_t i)
{
    while (sim->def.interpolate && i < play->last && !is_checkpoint(play, i)) {
        ++i;
    }
    return weft_run_frame_time(play->run, i);
}

/* With `interpolate` the step's past is still needed, for the frames within it. */
static bool play_continues(weft_sim *sim, const weft_play *play)
{
    unsigned *const calls = sim->def.interpolate ? &sim->callbacks : &sim->playing;
    ++*calls;
    const bool on = play->step(play->ctx);
    --*calls;
    return on;
}

static weft_status play_to(weft_sim *sim, const weft_play *play, size_t i,
                           weft_error *err)
{
    const double t = weft_run_frame_time(play->run, i), end = target(sim, play, i);
    while (weft_sim_time(sim) < t && !sim->event.passed) {
        TRY(weft_sim_step(sim, end, err));
        if (play->step != NULL && !play_continues(sim, play)) {
            return weft_error_set(err, WEFT_STOPPED, "stopped at t = %.9g s",
                                  weft_sim_time(sim));
        }
    }
    return WEFT_OK;
}

/* Frame i, of the present state or from within the last step. */
static weft_status show_frame(weft_sim *sim, const weft_play *play, size_t i,
                              weft_error *err)
{
    const double t = weft_run_frame_time(play->run, i);
    TRY(t < sim->t ? weft__between_show(sim, t, err) : WEFT_OK);
    ++sim->playing;
    weft_status status = play->frame(play->ctx, i, err);
    --sim->playing;
    status = status == WEFT_OK ? weft__sim_passages(sim, err) : status;
    weft__between_hide(sim);
    return status;
}

/* Always restarts the stepper, because that changes the results. */
static weft_status pass_checkpoint(weft_sim *sim, const weft_play *play, size_t i,
                                   weft_error *err)
{
    if (!is_checkpoint(play, i)) {
        return WEFT_OK;
    }
    if (play->checkpoint == NULL) {
        return weft_sim_restart(sim, err);
    }
    ++sim->playing;
    const weft_status status = play->checkpoint(play->ctx, i, err);
    --sim->playing;
    return status;
}

static weft_status play_check(const weft_sim *sim, const weft_play *play,
                              weft_error *err)
{
    if (play->run == NULL || play->frame == NULL) {
        return weft_error_set(err, WEFT_INVALID,
                              "weft_sim_play needs a run and a frame callback");
    }
    if (!weft__positive(play->run->duration) || !weft__positive(play->run->fps)) {
        return weft_error_set(err, WEFT_INVALID,
                              "duration %g s and fps %g 1/s must be finite and > 0",
                              play->run->duration, play->run->fps);
    }
    return weft__sim_outside_play(sim, "weft_sim_play", err);
}

weft_status weft_sim_play_sized(weft_sim *sim, const weft_play *given, size_t size,
                                weft_error *err)
{
    weft_play own = { 0 }, *const play = &own;
    if (given != NULL && !weft__sized_read(play, sizeof own, given, size)) {
        return weft__sized_unknown("weft_play", err);
    }
    TRY(play_check(sim, play, err));
    bool event = sim->event.passed = false;
    for (size_t i = play->first; i <= play->last && !event; ++i) {
        TRY(play_to(sim, play, i, err));
        event = sim->event.passed && sim->t <= weft_run_frame_time(play->run, i);
        TRY(show_frame(sim, play, i, err));
        TRY(event ? WEFT_OK : pass_checkpoint(sim, play, i, err));
    }
    return WEFT_OK;
}
