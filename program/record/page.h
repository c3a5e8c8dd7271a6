/* SPDX-License-Identifier: BSD-3-Clause */
/* page.h -- HTML pages: data inside them, JSON that cannot end its element and numbers
 * as base64; and the part of a run, or of two side by side, that a page plays: frames
 * and particles that fit a number of bytes. docs/guides/view-and-export.md documents
 * the data. */
#pragma once

#include "program/record/frames.h"

/* The player and the diagram of weft compare as built from viewer/: strings with
 * PAGE_MARK in the place of the data, in pages.c, which the Makefile writes. */
extern const char weft__player_page[], weft__compare_page[];
/* In pages.c too: scenes/hammock.yaml. */
extern const char weft__hammock_page[];
#define PAGE_MARK "<!--WEFT-DATA-->"

/* One of them up to the mark, and from there on. `live`: it may ask the server it came
 * from for more. */
void page_begin(FILE *stream, const char *page, bool live);
void page_end(FILE *stream, const char *page);
/* The player's page as a file at `path`; page_commit completes it unless
 * `written` is an error, which it returns. */
weft_status page_open(record_file *file, const char *path, weft_error *err);
weft_status page_commit(record_file *file, weft_status written, weft_error *err);

/* A JSON string in which <, > and & are escaped too. */
void page_text(FILE *stream, const char *text);
/* The same without the quotes around it. */
void page_characters(FILE *stream, const char *text);
/* The last part of a path as such a string: the page does not reveal where on its
 * author's disk the run is. */
void page_directory(FILE *stream, const char *path);
/* All of directory/name as such a string, or null if it cannot be opened. */
void page_file(FILE *stream, const char *directory, const char *name);
/* Bytes as base64, and that in a <script type="weft/frame">. */
void page_base64(FILE *stream, const unsigned char *bytes, size_t size);
void page_bytes(FILE *stream, const unsigned char *bytes, size_t size);

/* A block holds planes of `count` numbers each: first the smallest and largest number
 * of each plane as two floats, then, plane after plane, 16 bits per number that divide
 * the range between them evenly. Little-endian. */
size_t page_block_size(size_t planes, size_t count);
void page_plane(unsigned char *block, size_t planes, size_t plane, const double *values,
                size_t count);

/* ---- players ---- */

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

extern const player_field player_fields[PLAYER_FIELDS]; /* page.c */

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
    size_t stride, shown_rows, shown_cols;
    size_t count, *particles; /* shown, of triangles all; their indices */
    bool present[PLAYER_FIELDS];
    size_t sensitivities; /* sensitivities */
    size_t planes;        /* x, y, z, the fields that are present, the sensitivities */
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

/* page.c: the JSON of a page, in its <script>. */
void player_page_describe(const player_page *self);
