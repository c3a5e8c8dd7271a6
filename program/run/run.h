/* SPDX-License-Identifier: BSD-3-Clause */
/* run.h -- a scene run into a directory, by weft run and weft resume. */
#pragma once

#include <sys/stat.h>

#include "program/cli.h"
#include "program/record/checkpoint.h"
#include "program/record/result.h"
#include "program/run/interrupt.h"
#include "program/run/progress.h"

typedef struct run {
    const arguments *given;
    const char *out;
    struct stat place;       /* of the directory `out` */
    bool again;              /* the directory is that of an earlier attempt */
    record_checkpoint *from; /* NULL: from t = 0 */
    const weft_scene *scene;
    const weft_comm *comm; /* NULL: one process; else all functions are collective */
    weft_cloth *cloth;     /* of the sim: in bands, this one */
    weft_cloth *whole;     /* in bands, on rank 0; of a grid up to the first frame */
    weft_scene_perturbed *perturbed; /* of sensitivities; NULL: none */
    double *start; /* of contact.untangle: relaxed, or what is left; else NULL */
    weft_sim *sim;
    record_series series;
    record_table shapes;
    record_vtkhdf *frames;
    record_result result;
    record_checkpoint checkpoint; /* the next one */
    double began; /* [s] of the wall clock, less the time of earlier parts */
    interrupt_watch watch;
    progress progress;
    record_extremes extremes;
    uint64_t limit_sweeps; /* up to the last frame */
    bool beyond;           /* fixed_step the stable one, at t = 0 */
    bool warned_held;      /* of the strain limit */
    bool open;             /* the files may be those of this run */
    sentence reason;
} run;

/* records.c. Opens the files of a run from t = 0. */
weft_status run_begin(run *self, weft_error *err);
/* Opens them as they were at the checkpoint, and restores its state. Checks all of them
 * before it writes any. */
weft_status run_take_up(run *self, weft_error *err);
/* Writes checkpoint.weft after frame `index`. */
weft_status run_checkpoint(run *self, size_t index, weft_error *err);
/* Closes them after `status`, which is returned unless it was the better one. */
weft_status run_close(run *self, weft_status status, weft_error *err);
void run_remove(const run *self, const char *name);
/* WEFT_OK if all bands have it, else the first error. */
weft_status run_agree(const run *self, weft_status status, weft_error *err);
/* The state y[6 N] of the whole cloth, on rank 0: that of the sim or, in bands, in
 * *gathered, which the caller frees. */
weft_status run_state(const run *self, const double **y, double **gathered,
                      weft_error *err);
/* WEFT_IO if another directory has replaced that of the run. */
weft_status run_in_place(const run *self, weft_error *err);

/* run.c: `claimed`: the caller has claimed a directory that an earlier attempt has
 * left, up to the checkpoint `from` (NULL: runs from the beginning). Returns the exit
 * code. */
int run_scene(const arguments *given, const char *out, const weft_scene *scene,
              bool claimed, record_checkpoint *from);

/* crossings.c: writes start-crossings.obj of a scene with mistakes, if it has no other
 * than that its start crosses. */
void crossings_of_mistake(const arguments *given, const char *out);

/* summary.c: the results of a run, in eight lines or as YAML. */
void summary_step(run *self);  /* after each accepted step */
void summary_frame(run *self); /* after each frame */

void summary_print(const run *self);
/* The part that is known within a step. */
void summary_print_frames(const run *self);
/* The same as YAML documents of a line each, at the begin and at the end. */
void summary_yaml_begin(const run *self);
void summary_yaml_end(const run *self);
/* The failure, the stable step and what to try, as lines to stderr
 * and as one text. */
void failure_report(const weft_scene *scene, const weft_comm *comm, const weft_sim *sim,
                    const weft_failure *failure, sentence *out);

/* resume.c: continues the run of that scene in a directory that the caller has
 * claimed, and beyond its duration to the time `until`, unless that is NULL. Returns
 * the exit code. */
int resume_scene(const arguments *given, const char *until, const char *directory,
                 const weft_scene *scene);
