/* SPDX-License-Identifier: BSD-3-Clause */
/* series.h -- the CSV files of a run: series.csv and shapes.csv grow by whole rows and
 * are readable after a kill up to the last one. */
#pragma once

#include "program/record/record.h"

/* One frame of a run. */
typedef struct record_frame {
    size_t index;
    const weft_sim *sim;
    uint64_t limit_sweeps; /* since the last frame */
    bool is_end;           /* the last one, before `last` of the record */
} record_frame;

/* A CSV file that grows by whole lines: after a kill it holds all of them. */
typedef struct record_table {
    FILE *stream; /* NULL: not open, which all functions but write allow */
    char path[RECORD_PATH];
    record_extent extent; /* bytes written */
} record_table;

/* Keeps the first part of a table that was opened again. */
weft_status record_table_cut(record_table *table, const record_extent *kept,
                             weft_error *err);
/* Writes table->extent to the disk. */
weft_status record_table_sync(record_table *table, weft_error *err);
weft_status record_table_close(record_table *table, weft_error *err);

/* shapes.csv, one row per frame and shape; a cloth without shapes has none. A new file,
 * or `again` an existing one for reading and writing; record_table_cut must follow. */
weft_status record_shapes_open(record_table *table, const char *directory,
                               const weft_cloth *cloth, bool again, weft_error *err);
weft_status record_shapes_add(record_table *table, const record_frame *frame,
                              weft_error *err);

#define RECORD_COLUMNS_MAX 64
#define RECORD_COLUMN_NAME 128

/* Columns of series.csv that not every run has. */
enum {
    RECORD_LEDGER = 1 << 0, /* the simulation keeps it */
    RECORD_SOLVER = 1 << 1, /* the method solves linear systems */
    RECORD_SELF = 1 << 2,   /* the cloth has contact with itself */
    RECORD_BETWEEN = 1 << 3 /* frames may be from within steps */
};

/* series.c: one row per frame; `optional`: RECORD_... */
typedef struct record_series {
    record_table table;
    unsigned optional;
    const weft_scene *scene; /* of sensitivities; NULL: without their columns */
    char own_names[WEFT_SENSITIVITIES][RECORD_COLUMN_NAME];
    size_t columns;
    const char *names[RECORD_COLUMNS_MAX];
    double row[RECORD_COLUMNS_MAX]; /* the last row, its values as doubles */
    weft_spring worst;              /* the spring of max_strain in the last row */
} record_series;

/* How many parameters it is differentiated with respect to. */
size_t record_series_sensitivities(const record_series *series);

/* Names the columns, those of the sensitivities of `scene` last (NULL: none). Until a
 * file is opened, record_series_add only fills `row`. */
void record_series_begin(record_series *series, unsigned optional,
                         const weft_scene *scene);
/* `again`: as above. */
weft_status record_series_open(record_series *series, const char *directory,
                               unsigned optional, const weft_scene *scene, bool again,
                               weft_error *err);
weft_status record_series_add(record_series *series, const record_frame *frame,
                              weft_error *err);

/* series_read.c: the complete rows of DIR/series.csv, in order of time; the caller
 * frees them. WEFT_IO if there are none. */
typedef struct record_series_row {
    size_t frame;
    double time; /* [s] */
    uint64_t hash;
} record_series_row;

weft_status record_series_rows(const char *directory, record_series_row **rows,
                               size_t *count, weft_error *err);

/* series_read.c: the numbers of each column of DIR/series.csv over its complete rows;
 * NAN where it has none. Extremes and mean are of the finite ones. */
typedef struct record_column {
    char name[RECORD_COLUMN_NAME];
    double last, least, most, mean;
    size_t count; /* of finite numbers */
} record_column;

weft_status record_series_columns(const char *directory,
                                  record_column columns[RECORD_COLUMNS_MAX],
                                  size_t *count, weft_error *err);

/* series_read.c: the numbers of a frame, one for each of names[]; false: not known. */
typedef bool record_numbers_fn(void *ctx, size_t frame, double *numbers);

/* Compares the cells of DIR/series.csv with the numbers of the same frames. WEFT_IO
 * names the first pair that differs, and `damaged` as the file at fault. */
weft_status record_series_compare(const char *directory, const char *damaged,
                                  const char *const *names, size_t count,
                                  record_numbers_fn *numbers, void *ctx,
                                  weft_error *err);
