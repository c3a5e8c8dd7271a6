/* SPDX-License-Identifier: BSD-3-Clause */
/* player_page.h -- the part of a run, or of two side by side, that a page plays: frames
 * and particles that fit a number of bytes, and their description. docs/player.md
 * documents the data. */
#ifndef WEFT_RECORD_PLAYER_PAGE_H
#define WEFT_RECORD_PLAYER_PAGE_H

#include "record/frames.h"
#include "record/record.h"

/* player_page.c: writes `path`, the frames of the runs in directories[count], one or
 * two side by side, as one HTML page that a browser plays without a network. Two runs
 * are shown at the times that both have. Errors: WEFT_IO (a file), WEFT_INVALID (runs
 * of different grids or without a common time), WEFT_NO_MEMORY. */
weft_status record_player(const char *const *directories, size_t count,
                          const char *path, weft_error *err);

/* batch_page.c: writes `path`, a page of all runs of a batch: its summary.csv, the
 * numbers of each series and what a player shows of each run. *without: runs that have
 * no frames to show; `why`: the first reason. Errors as above. */
weft_status record_batch(const char *directory, const char *path, size_t *without,
                         weft_error *why, weft_error *err);
/* Whether `directory` is that of a batch: it has a summary and no frames. */
bool record_is_batch(const char *directory);

#define PLAYER_BUDGET 64e6 /* [B] of the frames of a page */
enum { PLAYER_RUNS = 2, PLAYER_FIELDS = 2 };

/* Fields that may colour a cloth; of those of width 3, the length. */
typedef struct player_field {
    const char *name;
    weft_record_field field;
    size_t width;
} player_field;

extern const player_field player_fields[PLAYER_FIELDS]; /* page_description.c */

typedef struct player_run {
    const char *directory;
    record_frames *frames;
    double *xyz;   /* 3 N, positions of one frame */
    size_t *index; /* frames to choose from, then those shown */
} player_run;

typedef struct player_page {
    double budget; /* [B] of all frames; more are thinned */
    bool brief;    /* of series.csv only the rows of the frames shown */
    bool live;     /* one run that may get more frames: there is room for all of them */
    player_run runs[PLAYER_RUNS];
    size_t run_count;
    const record_faces *faces; /* of run 0 */
    size_t chosen, shown;      /* frames: to choose from, left after thinning */
    size_t step;               /* between two that are left */
    size_t stride, shown_rows, shown_cols,
        count;         /* particles shown; of triangles all */
    size_t *particles; /* their indices */
    bool present[PLAYER_FIELDS];
    size_t planes;          /* x, y, z and the fields that are present */
    double *field, *values; /* 3 N as read, one plane as shown */
    unsigned char *block;
    FILE *stream; /* of the page */
} player_page;

/* Opens the runs in directories[count] and chooses frames and particles; `self` has its
 * budget and is otherwise zero. player_page_close must follow, also after an error. */
weft_status player_page_open(player_page *self, const char *const *directories,
                             size_t count, weft_error *err);
/* Writes description and frames to self->stream. */
weft_status player_page_write(player_page *self, weft_error *err);
/* One frame of a run, by its index in the file, into self->block. */
weft_status player_page_encode(player_page *self, size_t run, size_t frame,
                               weft_error *err);
void player_page_close(player_page *self);

/* page_description.c: the JSON of a page, in its <script>. */
void player_page_describe(const player_page *self);

#endif
