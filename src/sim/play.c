/* SPDX-License-Identifier: BSD-3-Clause */
/* play.c -- steps from frame to frame. Times are computed from the frame's number,
 * never accumulated. */
#include <math.h>

#include "weft/sim.h"

/* A last interval shorter than this part of a frame belongs to the frame before. */
#define SLIVER 1e-9

size_t weft_run_last_frame(const weft_run_def *run)
{
    const double frames = ceil(run->duration * run->fps - SLIVER);
    return frames < 1.0 ? 1 : frames < 1e15 ? (size_t)frames : (size_t)1e15;
}

double weft_run_frame_time(const weft_run_def *run, size_t i)
{
    return i >= weft_run_last_frame(run) ? run->duration : (double)i / run->fps;
}

static weft_status play_to(weft_sim *sim, const weft_play *play, double t,
                           weft_error *err)
{
    weft_status status = WEFT_OK;
    while (status == WEFT_OK && weft_sim_time(sim) < t) {
        status = weft_sim_step(sim, t, err);
        if (status == WEFT_OK && play->step != NULL && !play->step(play->ctx)) {
            status = weft_error_set(err, WEFT_STOPPED, "stopped at t = %.9g s",
                                    weft_sim_time(sim));
        }
    }
    return status;
}

/* Always restarts the stepper, because that changes the results. */
static weft_status pass_checkpoint(weft_sim *sim, const weft_play *play, size_t i,
                                   weft_error *err)
{
    const size_t interval = play->run->checkpoint;
    if (interval == 0 || i == 0 || i % interval != 0 || i == play->last) {
        return WEFT_OK;
    }
    return play->checkpoint != NULL ? play->checkpoint(play->ctx, i, err)
                                    : weft_sim_restart(sim, err);
}

weft_status weft_sim_play(weft_sim *sim, const weft_play *play, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (size_t i = play->first; status == WEFT_OK && i <= play->last; ++i) {
        status = play_to(sim, play, weft_run_frame_time(play->run, i), err);
        if (status == WEFT_OK) {
            status = play->frame(play->ctx, i, err);
        }
        if (status == WEFT_OK) {
            status = pass_checkpoint(sim, play, i, err);
        }
    }
    return status;
}
