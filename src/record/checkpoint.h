/* SPDX-License-Identifier: BSD-3-Clause */
/* checkpoint.h -- checkpoint.weft: where a run may be taken up again. docs/output.md
 * has its layout. */
#ifndef WEFT_RECORD_CHECKPOINT_H
#define WEFT_RECORD_CHECKPOINT_H

#include "record/record.h"

#define RECORD_CHECKPOINT "checkpoint.weft"

enum { RECORD_PROGRAM = 256 }; /* [bytes] */

typedef struct record_checkpoint {
    uint64_t scene;               /* record_hash of scene.yaml */
    char program[RECORD_PROGRAM]; /* in words, what has computed the run */
    uint64_t frame;               /* the last one; all below is up to it */
    record_extent series;         /* [bytes] of series.csv */
    record_vtkhdf_mark vtkhdf;    /* of run.vtkhdf */
    double wall_time;             /* [s] */
    record_extremes extremes;
    unsigned char *state; /* weft_sim_save */
    size_t state_size;
} record_checkpoint;

uint64_t record_hash(const char *text);

/* Fills in the scene and the program that would run it now. */
weft_status record_checkpoint_identify(record_checkpoint *out, const weft_scene *scene,
                                       weft_registry *registry, weft_error *err);

/* All that it counts on must have been synced. */
weft_status record_checkpoint_write(const char *directory,
                                    const record_checkpoint *checkpoint,
                                    weft_error *err);

/* out->state is allocated. Errors: WEFT_IO names the file and what is wrong with it:
 * missing, damaged, cut off, of another format. */
weft_status record_checkpoint_read(const char *directory, record_checkpoint *out,
                                   weft_error *err);
void record_checkpoint_free(record_checkpoint *checkpoint);

#endif
