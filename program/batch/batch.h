/* SPDX-License-Identifier: BSD-3-Clause */
/* batch.h -- many runs, each in its own process and directory. These directories are
 * all that a batch knows of earlier ones. */
#pragma once

#include "program/cli.h"
#include "program/record/child_process.h"

typedef enum batch_status {
    BATCH_NEW,        /* nothing is there */
    BATCH_PARTIAL,    /* begun, and interrupted or killed */
    BATCH_DONE,       /* status done */
    BATCH_FAILED,     /* status failed */
    BATCH_IO_ERROR,   /* status io_error */
    BATCH_CRASHED,    /* the process died */
    BATCH_TIMEOUT,    /* it took longer than --timeout */
    BATCH_CHANGED,    /* another scene's run is there */
    BATCH_BUSY,       /* another process runs it */
    BATCH_UNREADABLE, /* no readable directory */
    BATCH_STATUSES    /* how many there are */
} batch_status;

/* Exit code of a child, beside those of a run: another process runs it. */
#define BATCH_EXIT_BUSY 75

typedef struct batch_scene {
    const char *file;
    char *stem; /* of the file's name */
    weft_sweep *sweep;
} batch_scene;

typedef struct batch_run {
    const batch_scene *scene;
    size_t number; /* of the sweep, from 1 */
    char *name;    /* of its directory */
    batch_status status;
} batch_run;

typedef struct batch {
    const arguments *given;
    const char *out;
    size_t jobs, shard, shards; /* shard from 1 */
    double timeout;             /* [s] of a run; 0: none */
    batch_scene *scenes;
    size_t scene_count;
    batch_run *runs; /* in the order of scenes and sweeps */
    size_t run_count;
} batch;

extern const char *const batch_status_names[BATCH_STATUSES];

/* batch_plan.c. The directory of a run: the file's stem, then key=value of each varied
 * key, in at most 120 safe characters. A hash is added if a character or the end was
 * lost. The caller frees it; NULL: no memory. */
char *batch_name(const char *stem, const weft_sweep *sweep, size_t number);

/* Reads all scenes and names their runs. Returns the exit code. */
int batch_plan(batch *self);
/* Checks one sweep: EXIT_SCENE if two of its runs are the same. */
int batch_check(const arguments *given, const char *file, weft_sweep *sweep);
void batch_free(batch *self);

/* batch_state.c: the state of a run's directory. */
batch_status batch_look(const batch *self, const batch_run *run);
/* Whether it is done, and its log.txt has warnings. */
bool batch_warned(const batch *self, const batch_run *run);

/* [s] to wait for a lock: a run whose batch was just killed may still be writing its
 * files. */
#define BATCH_PATIENCE 5.0

/* batch_pool.c: runs all of these. Returns the signal that stopped it, or 0. */
int batch_pool_run(batch *self, batch_run **runs, size_t count);

/* Writes summary.csv, one row per run. */
weft_status batch_summary(const batch *self, weft_error *err);
