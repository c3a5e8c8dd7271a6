/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.h -- the frames of a run, in run.vtkhdf. */
#pragma once

#include "program/record/series.h"

/* vtkhdf.c: run.vtkhdf, VTKHDF 2.0, temporal. It appears with its first frame; after a
 * kill at any moment it holds every frame that was added. docs/reference/output.md
 * describes its layout. */
typedef struct record_vtkhdf record_vtkhdf;

typedef struct record_vtkhdf_def {
    const char *directory;
    const weft_cloth *cloth; /* of the simulation; outlives it */
    const weft_cloth *whole; /* in bands, on rank 0: of a grid until the first frame, of
                                triangles it outlives it; else NULL */
    const weft_comm *comm;   /* in bands: all functions are collective. NULL: alone */
    const weft_record_def *record;
    size_t last; /* frame of the run: room is made for all, if there is any */
    const record_series *series; /* open; outlives it. Its rows become field data */
} record_vtkhdf_def;

/* The number of frames of a run that ends with frame `last`; the most that a file has
 * room for; and about [bytes] of each. */
size_t record_vtkhdf_planned(const weft_record_def *record, size_t last);
size_t record_vtkhdf_most(size_t particles);
size_t record_vtkhdf_frame(const weft_record_def *record, size_t particles);

weft_status record_vtkhdf_create(const record_vtkhdf_def *def, record_vtkhdf **out,
                                 weft_error *err);
/* The state of the file on the disk, for a checkpoint: its first page, which changes
 * with each frame, the bytes from there to the first frame, and the frames. */
#define RECORD_PAGE 4096
typedef struct record_vtkhdf_mark {
    unsigned char page[RECORD_PAGE];
    record_extent head, frames; /* head: up to that byte of the file */
} record_vtkhdf_mark;

/* Opens an existing file for reading and checks it against `mark`; *equal is whether
 * its frames have the checksum. record_vtkhdf_cut must follow. WEFT_IO if the file is
 * damaged or does not fit this definition and `mark`. */
weft_status record_vtkhdf_reopen(const record_vtkhdf_def *def,
                                 const record_vtkhdf_mark *mark, record_vtkhdf **out,
                                 bool *equal, weft_error *err);
/* WEFT_IO names the first frame whose field data differ from its row in series.csv, and
 * `damaged` as the file at fault. */
weft_status record_vtkhdf_compare(record_vtkhdf *self, const char *damaged,
                                  weft_error *err);
/* Keeps the frames of the mark and opens the file for writing. */
weft_status record_vtkhdf_cut(record_vtkhdf *self, weft_error *err);
/* Instead of that: a copy of the frames of a checked file in a new one with room up to
 * frame `last`, which takes its place when published; then closes the old one. */
weft_status record_vtkhdf_grow(record_vtkhdf *self, size_t last, record_vtkhdf **out,
                               weft_error *err);
weft_status record_vtkhdf_publish(record_vtkhdf *self, weft_error *err);
/* Writes all frames to the disk. */
weft_status record_vtkhdf_sync(record_vtkhdf *self, record_vtkhdf_mark *mark,
                               weft_error *err);
/* Adds a frame that is in the series already; one that record.every leaves out is
 * skipped. A failure keeps the frames before. */
weft_status record_vtkhdf_add(record_vtkhdf *self, const record_frame *frame,
                              weft_error *err);
/* Frees it even if the file cannot be closed properly. NULL is allowed. */
weft_status record_vtkhdf_close(record_vtkhdf *self, weft_error *err);
