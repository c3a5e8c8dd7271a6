/* SPDX-License-Identifier: BSD-3-Clause */
/* progress.h -- how far a run has come. For people it goes to stderr, for machines to
 * stdout. */
#ifndef WEFT_CLI_RUN_PROGRESS_H
#define WEFT_CLI_RUN_PROGRESS_H

#include "cli/cli.h"

typedef enum progress_mode {
    PROGRESS_NONE,
    PROGRESS_LINES,    /* a line each tenth of the frames */
    PROGRESS_TERMINAL, /* one line, drawn over and over within the terminal's width */
    PROGRESS_YAML      /* a document a line */
} progress_mode;

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

/* none, lines, terminal, yaml; auto or NULL: terminal if stderr is one, else lines.
 * False: no such name. */
bool progress_find(const char *name, progress_mode *mode);

/* --progress of a verb that has --quiet too: EXIT_DONE, or the usage error printed. */
int progress_choose(const verb *self, const options *given, progress_mode *mode);

void progress_begin(progress *show, progress_mode mode, const weft_sim *sim,
                    const weft_run_def *run);
/* After frame `frame` or a step behind it: shown if it is time to. */
void progress_show(progress *show, size_t frame);
/* So many methods, say, have ended: due by the same rule. */
void progress_count(progress *show, const char *what, size_t done, size_t all);
/* Wipes the line off the terminal: before anything else is printed, and at the end. */
void progress_clear(progress *show);

#endif
