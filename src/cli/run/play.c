/* SPDX-License-Identifier: BSD-3-Clause */
/* play.c -- from frame to frame. Times are computed from the frame's number, never
 * accumulated. */
#include <math.h>

#include "cli/cli.h"

/* A last interval shorter than this part of a frame belongs to the frame before. */
#define SLIVER 1e-9

size_t frame_last(const weft_run_def *run)
{
    const double frames = ceil(run->duration * run->fps - SLIVER);
    return frames < 1.0 ? 1 : frames < 1e15 ? (size_t)frames : (size_t)1e15;
}

double frame_time(const weft_run_def *run, size_t i)
{
    return i >= frame_last(run) ? run->duration : (double)i / run->fps;
}

/* Steppers take what is left of a frame whole if it is longer than h by this part. */
#define REST 1e-6

double frame_steps(const weft_run_def *run, double h)
{
    return fmax(1.0, ceil(frame_time(run, 1) / h - REST));
}

static weft_status play_to(frame_loop *show, double t, weft_error *err)
{
    while (weft_sim_time(show->sim) < t) {
        interrupt_lend(show->watch);
        const weft_status status = weft_sim_step(show->sim, t, err);
        interrupt_take(show->watch);
        if (status != WEFT_OK) {
            return status;
        }
        if (show->step != NULL && !show->step(show->ctx)) {
            show->stopped = true;
            return WEFT_OK;
        }
    }
    return WEFT_OK;
}

/* Part of the run, whoever plays it: a checkpoint restarts the stepper. */
static weft_status pass_checkpoint(frame_loop *show, size_t i, weft_error *err)
{
    const size_t interval = show->run->checkpoint;
    if (interval == 0 || i == 0 || i % interval != 0 || i == show->last) {
        return WEFT_OK;
    }
    return show->checkpoint != NULL ? show->checkpoint(show->ctx, i, err)
                                    : weft_sim_restart(show->sim, err);
}

weft_status play(frame_loop *show, weft_error *err)
{
    for (size_t i = show->first; i <= show->last; ++i) {
        weft_status status = play_to(show, frame_time(show->run, i), err);
        if (status == WEFT_OK && !show->stopped) {
            status = show->frame(show->ctx, i, err);
        }
        if (status == WEFT_OK && !show->stopped) {
            status = pass_checkpoint(show, i, err);
        }
        if (status != WEFT_OK || show->stopped) {
            return status;
        }
    }
    return WEFT_OK;
}
