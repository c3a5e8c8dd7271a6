/* SPDX-License-Identifier: BSD-3-Clause */
/* record.h -- files that appear by rename, complete or not at all, as all of
 * program/record writes them. Every write is checked: WEFT_IO names the file. Linked
 * into the program, not into libweft. */
#pragma once

#include <float.h>

#include "base/try.h"
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

/* A file that is written under a temporary name and then renamed. */
typedef struct record_file {
    FILE *stream;
    char path[RECORD_PATH], temporary[RECORD_PATH];
} record_file;

/* `directory`/`name`, or `name` without a directory, into path; WEFT_IO if that is too
 * long. */
weft_status record_path(const char *directory, const char *name, char path[RECORD_PATH],
                        weft_error *err);
/* The name under which such a path is written before it is renamed. */
void record_temporary(const char *path, char temporary[RECORD_PATH]);
/* Opens that file for reading and fills in path. NULL: WEFT_IO. */
FILE *record_open(const char *directory, const char *name, char path[RECORD_PATH],
                  weft_error *err);
/* Whether there is anything of that name, also what cannot be opened. */
bool record_exists(const char *directory, const char *name);
/* Sets and returns WEFT_IO with errno of a file or a directory. */
weft_status record_failed(const char *path, weft_error *err);
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
/* Commits what is good, else discards it and says why by errno. */
weft_status record_file_end(record_file *file, bool good, weft_error *err);
/* Writes text in quotes, with those inside doubled (RFC 4180). */
void record_csv_quoted(FILE *stream, const char *text);

/* What crosses or touches in a start, if anything does, as points, lines and faces with
 * the names of each pair. */
#define RECORD_CROSSINGS "start-crossings.obj"
weft_status record_crossings(const char *directory, const weft_cloth *cloth,
                             const double *y, weft_error *err);

/* ---- derivatives.c: derivatives of a run with respect to parameters of its scene, in
 * its `scale`: p dy/dp, or dy/dp ---- */

/* Positions, or velocities, of parameter j: 3 N in the order of the files. */
void record_sensitivity(const weft_scene *scene, const weft_sim *sim, size_t j,
                        bool velocities, double *xyz);
/* The largest |s| of a position. */
double record_sensitivity_most(const weft_scene *scene, const weft_sim *sim, size_t j);
/* By how many times the cloth's rest diagonal 1 % of a parameter moves a particle, and
 * of which one (NULL: not wanted); 0 without sensitivities. */
double record_sensitivity_growth(const weft_scene *scene, const weft_sim *sim,
                                 size_t *parameter);
/* sensitivity.csv: all of them at present. */
#define RECORD_SENSITIVITY "sensitivity.csv"
weft_status record_sensitivities(const char *directory, const weft_scene *scene,
                                 const weft_sim *sim, weft_error *err);

/* The copy of a scene's mesh in its results. */
#define RECORD_MESH "scene.obj"

/* The mesh of cloth k of a scene that has one, as an OBJ file: that it was read from,
 * or of a cut. */
weft_status record_mesh(const char *directory, const char *name,
                        const weft_scene *scene, size_t k, weft_error *err);

/* scene.yaml, and its mesh if it has one; of several cloths those of all. */
weft_status record_scene_text(const char *directory, const char *name,
                              const weft_scene *scene, weft_error *err);

/* The part of a file that a checkpoint refers to, in bytes or frames, and its
 * checksum. */
typedef struct record_extent {
    uint64_t length, sum;
} record_extent;

/* The checksum of the bytes from `begin` to `end`; 0 if the file lacks them. */
uint64_t record_bytes_sum(const char *path, size_t begin, size_t end);

/* ---- outdir.c: the directory of a run ---- */

/* Makes `directory` and its parents unless they exist. */
weft_status record_directory(const char *directory, weft_error *err);

/* Makes `directory`, or accepts an empty one; its RECORD_CROSSINGS is removed. One that
 * is not empty is refused unless `force`, which removes the files of an earlier run of
 * weft. */
weft_status record_outdir(const char *directory, bool force, weft_error *err);

/* Makes `directory` if need be and locks it for this process until *lock is closed or
 * the process ends. WEFT_IO if another process has the lock for `patience` [s]: one
 * that was killed keeps it until the system has cleaned up. */
#define RECORD_PATIENCE 0.2
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err);

/* Whether a process has that lock. */
bool record_outdir_locked(const char *directory);

/* result.c: whether a run was begun there that has not ended by itself. */
bool record_unfinished(const char *directory);

/* The names of all files that weft writes there, NULL at their end. */
extern const char *const record_names[];

/* The own particles of a cloth, or of its band: how many, behind *skip others. Blocks
 * of ghosts fill up what is before them, and are behind them if there are any. */
static inline size_t record_own(const weft_cloth *cloth, size_t *skip)
{
    const weft_band band = weft_cloth_band(cloth);
    const size_t cols = weft_cloth_cols(cloth);
    const size_t block = cols > 0 ? cols : WEFT_BLOCK_VERTICES;
    *skip = band.above * block;
    return band.below > 0 ? band.own * block : weft_cloth_particles(cloth) - *skip;
}

/* ---- files that rank 0 makes, in which each band has places of its own ---- */

/* Opens the file that rank 0 has made; *file < 0: not open. Collective. Errors:
 * WEFT_IO; also if another band sees another file, or none. */
weft_status record_shared_open(const weft_comm *comm, const char *path, int flags,
                               int *file, weft_error *err);

/* All bytes, at a place [bytes]; false: errno says why. */
bool record_write_at(int file, const void *bytes, size_t size, uint64_t at);
bool record_read_at(int file, void *bytes, size_t size, uint64_t at);
