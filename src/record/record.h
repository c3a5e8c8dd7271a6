/* SPDX-License-Identifier: BSD-3-Clause */
/* record.h -- the files that a run writes. Linked into the program, not into libweft.
 *
 * Files appear by rename, complete or not at all; series.csv grows by whole rows and is
 * readable after a kill up to the last one. Every write is checked: WEFT_IO names the
 * file. */
#ifndef WEFT_RECORD_H
#define WEFT_RECORD_H

#include <float.h>

#include "weft/weft.h"

#define RECORD_PATH 4096

/* In single precision: a value beyond its range becomes the largest float of its
 * sign. */
static inline float record_single(double value)
{
    return value > (double)FLT_MAX    ? FLT_MAX
           : value < -(double)FLT_MAX ? -FLT_MAX
                                      : (float)value;
}

/* record_file.c: a file that is written under a temporary name and then renamed. */
typedef struct record_file {
    FILE *stream;
    char path[RECORD_PATH], temporary[RECORD_PATH];
} record_file;

/* `directory`/`name` into path; WEFT_IO if that is too long. */
weft_status record_path(const char *directory, const char *name, char path[RECORD_PATH],
                        weft_error *err);
/* The name under which such a path is written before it is renamed. */
void record_temporary(const char *path, char temporary[RECORD_PATH]);
/* Opens that file for reading and fills in path. NULL: WEFT_IO. */
FILE *record_open(const char *directory, const char *name, char path[RECORD_PATH],
                  weft_error *err);
/* Whether there is anything of that name, also what cannot be opened. */
bool record_exists(const char *directory, const char *name);
/* WEFT_IO if a directory has no scene.yaml, with *err; else WEFT_OK, without. */
weft_status record_is_run(const char *directory, weft_error *err);
weft_status record_file_open(record_file *file, const char *directory, const char *name,
                             weft_error *err);
/* WEFT_IO if `path` is a link: a directory may come from anybody. */
weft_status record_no_link(const char *path, weft_error *err);
/* Flushes, syncs and renames; on failure removes the temporary file and leaves the old
 * one untouched. */
weft_status record_file_commit(record_file *file, weft_error *err);
/* Removes the temporary file instead. */
void record_file_discard(record_file *file);
/* Writes text in quotes, with those inside doubled (RFC 4180). */
void record_csv_quoted(FILE *stream, const char *text);
weft_status record_text(const char *directory, const char *name, const char *text,
                        weft_error *err);

/* The part of a file that a checkpoint refers to, in bytes or frames, and its
 * checksum. */
typedef struct record_extent {
    uint64_t length, sum;
} record_extent;

/* The checksum of the bytes from `begin` to `end`; 0 if the file lacks them. */
uint64_t record_bytes_sum(const char *path, size_t begin, size_t end);

/* outdir.c: makes `directory` and its parents unless they exist. */
weft_status record_directory(const char *directory, weft_error *err);

/* outdir.c: makes `directory`, or accepts an empty one. One that is not empty is
 * refused unless `force`, which removes the files of an earlier run of weft. */
weft_status record_outdir(const char *directory, bool force, weft_error *err);

/* Makes `directory` if need be and locks it for this process until *lock is closed or
 * the process ends. WEFT_IO if another process has the lock for `patience` [s]: one
 * that was killed keeps it until the system has cleaned up. */
#define RECORD_PATIENCE 0.2
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err);

/* Whether a process has that lock. */
bool record_outdir_locked(const char *directory);

/* result_read.c: whether a run was begun there that has not ended by itself. */
bool record_unfinished(const char *directory);

/* outdir.c: the names of all files that weft writes there, NULL at their end. */
extern const char *const record_names[];

/* One frame of a run. */
typedef struct record_frame {
    size_t index;
    const weft_sim *sim;
    uint64_t limit_sweeps; /* since the last frame */
    bool is_end;           /* the last one, before `last` of the record */
} record_frame;

/* Extremes over all steps and frames of a run so far. */
typedef struct record_extremes {
    double short_step, long_step; /* [s] of accepted steps; 0: there was none */
    double strain_time;           /* [s] */
    weft_spring strain;           /* at its largest strain; no spring: p == q */
} record_extremes;

/* The corners of quad q, around it, the same way round in every format. */
static inline void record_quad(size_t cols, size_t q, size_t corners[4])
{
    const size_t a = q / (cols - 1) * cols + q % (cols - 1);
    corners[0] = a;
    corners[1] = a + cols;
    corners[2] = a + cols + 1;
    corners[3] = a + 1;
}

/* table.c: a CSV file that grows by whole lines: after a kill it holds all of them. */
typedef struct record_table {
    FILE *stream; /* NULL: not open, which all functions but write allow */
    char path[RECORD_PATH];
    record_extent extent; /* bytes written */
} record_table;

/* A new file, or `again` an existing one for reading and writing; record_table_cut must
 * follow then and keeps its first part. */
weft_status record_table_open(record_table *table, const char *directory,
                              const char *name, bool again, weft_error *err);
weft_status record_table_cut(record_table *table, const record_extent *kept,
                             weft_error *err);
weft_status record_table_write(record_table *table, const char *line, weft_error *err);
/* Writes table->extent to the disk. */
weft_status record_table_sync(record_table *table, weft_error *err);
weft_status record_table_close(record_table *table, weft_error *err);

/* shapes_csv.c: shapes.csv, one row per frame and shape; a cloth without shapes has
 * none. */
weft_status record_shapes_open(record_table *table, const char *directory,
                               const weft_cloth *cloth, bool again, weft_error *err);
weft_status record_shapes_add(record_table *table, const record_frame *frame,
                              weft_error *err);

#define RECORD_COLUMNS_MAX 64
#define RECORD_COLUMN_NAME 32

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
    size_t columns;
    const char *names[RECORD_COLUMNS_MAX];
    double row[RECORD_COLUMNS_MAX]; /* the last row, its values as doubles */
    weft_spring worst;              /* the spring of max_strain in the last row */
} record_series;

/* Names the columns. Until a file is opened, record_series_add only fills `row`. */
void record_series_begin(record_series *series, unsigned optional);
weft_status record_series_open(record_series *series, const char *directory,
                               unsigned optional, weft_error *err);
weft_status record_series_reopen(record_series *series, const char *directory,
                                 unsigned optional, weft_error *err);
weft_status record_series_add(record_series *series, const record_frame *frame,
                              weft_error *err);

/* vtkhdf.c: run.vtkhdf, VTKHDF 2.0, temporal. It appears with its first frame; after a
 * kill at any moment it holds every frame that was added. docs/output.md describes its
 * layout. */
typedef struct record_vtkhdf record_vtkhdf;

typedef struct record_vtkhdf_def {
    const char *directory;
    const weft_cloth *cloth; /* of the simulation; outlives it */
    const weft_cloth *whole; /* in bands, on rank 0: the whole cloth, until the first
                                frame is there; else NULL */
    const weft_comm *comm;   /* in bands: all functions are collective. NULL: alone */
    const weft_record_def *record;
    size_t
        last; /* last frame of the run: room is made for all of them, if there is any */
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

/* Whether the fixed step is not the one of the scene, as that would not divide a frame.
 */
bool record_step_differs(const weft_scene *scene);

/* result_write.c: versions, plugin, method and every option in force. */
weft_status record_manifest(const char *directory, const weft_scene *scene,
                            const weft_sim *sim, const weft_cloth *whole,
                            const weft_plugin *plugin, const char *plugin_file,
                            weft_error *err);

/* The end of a run. */
typedef struct record_result {
    const char *status; /* done | failed | io_error | interrupted */
    const char *reason; /* "" if done, unless by `stop` */
    size_t frames, planned;
    double wall_time;       /* [s] */
    const weft_sim *sim;    /* NULL: the run never began */
    weft_measures measures; /* of the sim at the end, as is: */
    weft_ledger ledger;
    double energy_start; /* [J] the sum of all energies */
    size_t warnings;
} record_result;

/* Writes the last file of a run: its presence says that the run is over. */
weft_status record_result_write(const char *directory, const record_result *result,
                                weft_error *err);

/* Writes DIR/result.yaml as record_result_write does; if there is one, only its status
 * and reason change. */
weft_status record_result_amend(const char *directory, const record_result *result,
                                weft_error *err);

/* player_page.c: writes `path`, the frames of the runs in directories[count], one or
 * two side by side, as one HTML page that a browser plays without a network. Two runs
 * are shown at the times that both have. docs/player.md describes the page and its
 * data. Errors: WEFT_IO (a file), WEFT_INVALID (runs of different grids or without a
 * common time), WEFT_NO_MEMORY. */
weft_status record_player(const char *const *directories, size_t count,
                          const char *path, weft_error *err);

/* batch_page.c: writes `path`, a page of all runs of a batch: its summary.csv, the
 * numbers of each series and what a player shows of each run. *without: runs that have
 * no frames to show; `why`: the first reason. Errors as above. */
weft_status record_batch(const char *directory, const char *path, size_t *without,
                         weft_error *why, weft_error *err);
/* Whether `directory` is that of a batch: it has a summary and no frames. */
bool record_is_batch(const char *directory);

/* The content of result.yaml, as items of a mapping (yaml_out.h). */
struct yaml_out;
void record_result_items(struct yaml_out *out, const record_result *result);

#endif
