/* SPDX-License-Identifier: BSD-3-Clause */
/* record.h -- what a run leaves behind. Linked into the program, not into libweft.
 *
 * Files appear by rename, complete or not at all; series.csv grows by whole rows and is
 * readable after a kill up to the last one. Every write is checked: WEFT_IO names the
 * file. */
#ifndef WEFT_RECORD_H
#define WEFT_RECORD_H

#include "weft/weft.h"

#define RECORD_PATH 4096

/* file.c: a file that is written beside its place and renamed into it. */
typedef struct record_file {
    FILE *stream;
    char path[RECORD_PATH], temporary[RECORD_PATH];
} record_file;

/* `directory`/`name` into path; WEFT_IO if that is too long. */
weft_status record_path(const char *directory, const char *name, char path[RECORD_PATH],
                        weft_error *err);
weft_status record_file_open(record_file *file, const char *directory, const char *name,
                             weft_error *err);
/* A directory may come from anywhere: WEFT_IO if a link lies at `path`. */
weft_status record_no_link(const char *path, weft_error *err);
/* Flush, sync, rename; on failure the temporary file is gone and the place untouched.
 */
weft_status record_file_commit(record_file *file, weft_error *err);
/* Give it up instead: the place stays untouched. */
void record_file_discard(record_file *file);
weft_status record_text(const char *directory, const char *name, const char *text,
                        weft_error *err);

/* outdir.c: make `directory` and what is above it, or accept what is there. */
weft_status record_directory(const char *directory, weft_error *err);

/* outdir.c: make `directory`, or accept an empty one. One that is not empty is refused
 * unless `force`, which removes what an earlier run of weft left there. */
weft_status record_outdir(const char *directory, bool force, weft_error *err);

/* Makes `directory` if need be and claims it for this process until *lock is closed, or
 * the process ends. WEFT_IO if another one has it for `patience` [s]: even one that was
 * killed may have it a moment longer, by the helper that tries run.vtkhdf (frames.c).
 */
#define RECORD_PATIENCE 1.0
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err);

/* outdir.c: the names of all that weft leaves there, NULL at their end. */
extern const char *const record_names[];

/* One frame of a run. */
typedef struct record_frame {
    size_t index;
    const weft_sim *sim;
    uint64_t limit_sweeps; /* since the last frame */
} record_frame;

#define RECORD_COLUMNS_MAX 64

/* series.c: a row a frame; `ledger` if the simulations keep it. */
typedef struct record_series {
    FILE *stream;
    char path[RECORD_PATH];
    size_t columns;
    const char *names[RECORD_COLUMNS_MAX];
    double row[RECORD_COLUMNS_MAX]; /* the last one written, as far as doubles go */
    weft_spring worst;              /* of the last row: its max_strain */
} record_series;

weft_status record_series_open(record_series *series, const char *directory,
                               bool ledger, weft_error *err);
weft_status record_series_add(record_series *series, const record_frame *frame,
                              weft_error *err);
weft_status record_series_close(record_series *series, weft_error *err);

/* One that is there, to go on once it is cut to its first `bytes`. */
weft_status record_series_reopen(record_series *series, const char *directory,
                                 bool ledger, weft_error *err);
weft_status record_series_cut(record_series *series, size_t bytes, weft_error *err);
/* Bring what was added to the disk; *bytes is the length of the file then. */
weft_status record_series_sync(record_series *series, size_t *bytes, weft_error *err);

/* vtkhdf.c: run.vtkhdf, VTKHDF 2.0, temporal. It appears with its first frame and holds
 * after a kill at any moment every frame that was added. docs/output.md has its layout.
 */
typedef struct record_vtkhdf record_vtkhdf;

typedef struct record_vtkhdf_def {
    const char *directory;
    const weft_cloth *cloth; /* outlives it */
    const weft_record_def *record;
    size_t last;                 /* frame of the run: room is made for all of them */
    const record_series *series; /* open; outlives it. Its rows become field data */
} record_vtkhdf_def;

weft_status record_vtkhdf_create(const record_vtkhdf_def *def, record_vtkhdf **out,
                                 weft_error *err);
/* The file that is there, cut to its first `count` frames, to go on. WEFT_IO, and the
 * file is as before, if it is not as this definition would have it. */
weft_status record_vtkhdf_reopen(const record_vtkhdf_def *def, size_t count,
                                 record_vtkhdf **out, weft_error *err);
/* Bring what was added to the disk; *count is the number of frames in the file. */
weft_status record_vtkhdf_sync(record_vtkhdf *self, size_t *count, weft_error *err);
/* A frame, once it is in the series; one that record.every leaves out is passed over.
 * After a failure the frames before are kept. */
weft_status record_vtkhdf_add(record_vtkhdf *self, const record_frame *frame,
                              weft_error *err);
/* Frees it also if the file cannot be closed well. NULL is allowed. */
weft_status record_vtkhdf_close(record_vtkhdf *self, weft_error *err);

/* series.c: the last frame that series.csv has. WEFT_IO if it has none. */
weft_status record_series_last(const char *directory, size_t *frame, weft_error *err);

/* series.c: the hash that row `frame` of series.csv holds. WEFT_IO if there is none. */
weft_status record_series_hash(const char *directory, size_t frame, uint64_t *hash,
                               weft_error *err);

/* series_read.c: the rows of DIR/series.csv that are whole, later and later; the caller
 * frees them. WEFT_IO if there are none. */
typedef struct record_series_row {
    size_t frame;
    double time; /* [s] */
    uint64_t hash;
    size_t end; /* bytes of the file up to its end */
} record_series_row;

weft_status record_series_rows(const char *directory, record_series_row **rows,
                               size_t *count, weft_error *err);

/* report.c: versions, plugin, method and every option in force. */
weft_status record_manifest(const char *directory, const weft_scene *scene,
                            const weft_sim *sim, const weft_plugin *plugin,
                            const char *plugin_file, weft_error *err);

/* How a run ended. */
typedef struct record_result {
    const char *status; /* done | failed | interrupted */
    const char *reason; /* "" if done */
    size_t frames, planned;
    double wall_time;    /* [s] */
    const weft_sim *sim; /* NULL: it never began */
    double energy_start; /* [J] kinetic + elastic + gravitational */
} record_result;

/* The last file of a run: its presence says that the run is over. */
weft_status record_result_write(const char *directory, const record_result *result,
                                weft_error *err);

/* What result.yaml says, as items of a mapping (yaml_out.h). */
struct yaml_out;
void record_result_items(struct yaml_out *out, const record_result *result);

/* Kinetic + elastic + gravitational [J]. */
double record_total_energy(const weft_cloth *cloth, const double *y);

#endif
