/* SPDX-License-Identifier: BSD-3-Clause */
/* checkpoint.h -- checkpoint.weft, from which a run can be resumed.
 * bench/NOTES.md lists its words. */
#pragma once

#include "program/record/vtkhdf.h"

#define RECORD_CHECKPOINT "checkpoint.weft"

enum { RECORD_PROGRAM = 256 }; /* [bytes] */

/* Extremes over all steps and frames of a run so far. */
typedef struct record_extremes {
    double short_step, long_step; /* [s] of accepted steps; 0: there was none */
    double strain_time;           /* [s] */
    weft_spring strain;           /* at its largest strain; no spring: p == q */
} record_extremes;

typedef struct record_checkpoint {
    uint64_t scene;               /* hash of scene.yaml and its mesh */
    char program[RECORD_PROGRAM]; /* which computed the run */
    uint64_t frame;               /* the last one; everything below is up to it */
    record_extent series;         /* [bytes] of series.csv */
    record_extent shapes;         /* [bytes] of shapes.csv; 0, 0 without shapes */
    record_vtkhdf_mark vtkhdf;    /* of run.vtkhdf */
    double wall_time;             /* [s] */
    record_extremes extremes;
    /* of one that is read: */
    char path[RECORD_PATH];
    FILE *stream;      /* NULL: none */
    size_t state_size; /* [bytes] of the simulation in it */
    size_t last;       /* the caller's: the last frame for which run.vtkhdf has room */
} record_checkpoint;

enum { RECORD_CHECKPOINT_HEAD = 566 * 8 }; /* [bytes] before the simulation */

/* A head for a simulation of `state_size` bytes. */
void record_checkpoint_pack(const record_checkpoint *from, size_t state_size,
                            unsigned char to[RECORD_CHECKPOINT_HEAD]);

/* Fills in the scene and a description of this program. */
weft_status record_checkpoint_identify(record_checkpoint *out, const weft_scene *scene,
                                       weft_registry *registry, weft_error *err);

/* With the simulation, by weft_sim_save_parts: each band writes its rows. Collective.
 * Everything that it refers to must have been synced. */
weft_status record_checkpoint_write(const char *directory,
                                    const record_checkpoint *checkpoint, weft_sim *sim,
                                    const weft_comm *comm, weft_error *err);

/* Leaves the file open. Errors: WEFT_IO names the file and its fault: missing, damaged,
 * cut off, of another format. */
weft_status record_checkpoint_read(const char *directory, record_checkpoint *out,
                                   weft_error *err);

/* The simulation of the file, of which each band reads its rows. Collective. Errors:
 * WEFT_IO, also for what weft_sim_restore_parts finds. */
weft_status record_checkpoint_restore(record_checkpoint *from, weft_sim *sim,
                                      weft_error *err);
void record_checkpoint_close(record_checkpoint *checkpoint);
