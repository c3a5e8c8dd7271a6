/* SPDX-License-Identifier: BSD-3-Clause */
/* progress.h -- the progress of a run: for people to stderr, for machines to stdout. */
#pragma once

#include "program/cli.h"

typedef struct progress {
    progress_mode mode;
    bool drawn;         /* a line stands on the terminal */
    size_t tenth;       /* of the frames, the last one shown */
    double shown;       /* [s] of the wall clock */
    double measured;    /* [s] of the wall clock, when there were: */
    double time;        /* [s] of simulated time */
    uint64_t steps;     /* and these */
    double speed, rate; /* [s/s] simulated, [1/s] steps: smoothed; speed 0: unknown */
    const weft_sim *sim;
    const weft_run_def *run;
} progress;

void progress_begin(progress *show, progress_mode mode, const weft_sim *sim,
                    const weft_run_def *run);
/* After frame `frame` or a step behind it: prints if it is due. */
void progress_show(progress *show, size_t frame);
/* The same for `done` of `all` things, such as methods. */
void progress_count(progress *show, const char *what, size_t done, size_t all);
/* Wipes the line off the terminal: before anything else is printed, and at the end. */
void progress_clear(progress *show);
