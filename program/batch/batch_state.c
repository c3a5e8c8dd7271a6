/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_state.c -- the state of the directory of a run; summary.csv, joined from the
 * result.yaml of all runs. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "program/batch/batch.h"
#include "program/record/result.h"

const char *const batch_status_names[BATCH_STATUSES] = {
    [BATCH_NEW] = "missing",       [BATCH_PARTIAL] = "interrupted",
    [BATCH_DONE] = "done",         [BATCH_FAILED] = "failed",
    [BATCH_IO_ERROR] = "io_error", [BATCH_CRASHED] = "crashed",
    [BATCH_TIMEOUT] = "timeout",   [BATCH_CHANGED] = "changed",
    [BATCH_BUSY] = "busy",         [BATCH_UNREADABLE] = "unreadable",
};

/* Whether a file consists of a text; *missing: there is no such file. */
static bool holds(const char *path, const char *text, bool *missing)
{
    FILE *stream = weft__file_open(path, "r", NULL);
    *missing = stream == NULL && errno == ENOENT;
    if (stream == NULL) {
        return false;
    }
    int c = getc(stream);
    for (; c != EOF && *text != '\0' && c == (unsigned char)*text; ++text) {
        c = getc(stream);
    }
    const bool same = c == EOF && *text == '\0' && !ferror(stream);
    (void)fclose(stream);
    return same;
}

/* Whether result.yaml has that status. */
static bool is_over(batch_status status)
{
    return status >= BATCH_DONE && status <= BATCH_TIMEOUT;
}

static batch_status result_status(const char *directory)
{
    char said[RECORD_RESULT_TEXT];
    batch_status status = BATCH_DONE;
    (void)record_result_get(directory, "status", said);
    while (is_over(status) && strcmp(said, batch_status_names[status]) != 0) {
        ++status;
    }
    return is_over(status) ? status : BATCH_PARTIAL;
}

batch_status batch_look(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH], path[RECORD_PATH];
    struct stat there;
    weft_scene *scene = NULL;
    bool missing = false;
    if (record_path(self->out, run->name, directory, NULL) != WEFT_OK
        || record_path(directory, "scene.yaml", path, NULL) != WEFT_OK) {
        return BATCH_UNREADABLE;
    }
    if (lstat(directory, &there) != 0) {
        return errno == ENOENT ? BATCH_NEW : BATCH_UNREADABLE;
    }
    if (!S_ISDIR(there.st_mode)) { /* a link would lead out of the batch */
        return BATCH_UNREADABLE;
    }
    const bool same
        = weft_sweep_scene(run->scene->sweep, run->number, &scene, NULL) == WEFT_OK
          && holds(path, weft_scene_text(scene), &missing);
    weft_scene_destroy(scene);
    return same ? result_status(directory) : missing ? BATCH_NEW : BATCH_CHANGED;
}

bool batch_warned(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH], said[RECORD_RESULT_TEXT];
    return run->status == BATCH_DONE
           && record_path(self->out, run->name, directory, NULL) == WEFT_OK
           && atoi(record_result_get(directory, "warnings", said)) > 0;
}

/* ---- summary.csv ------------------------------------------------------------ */

/* The columns after those of the varied keys: of the run, or keys of its result.yaml.
 * The wall time is the last, as it alone differs from one batch to the next. */
static const char *const columns[]
    = { "scene",      "status",       "reason",     "frames",
        "time",       "steps",        "rejected",   "rhs_calls",
        "max_strain", "energy_start", "energy_end", "dissipated",
        "hash",       "directory",    "warnings",   "wall_time" };

enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* The keys varied in any scene, each once. */
typedef struct varied {
    const char **keys;
    size_t count;
} varied;

static bool collect_keys(const batch *self, varied *out)
{
    size_t most = 1;
    for (size_t i = 0; i < self->scene_count; ++i) {
        most += weft_sweep_keys(self->scenes[i].sweep);
    }
    *out = (varied){ .keys = calloc(most, sizeof *out->keys) };
    for (size_t i = 0; out->keys != NULL && i < self->scene_count; ++i) {
        const weft_sweep *sweep = self->scenes[i].sweep;
        for (size_t k = 0; k < weft_sweep_keys(sweep); ++k) {
            size_t same = 0;
            while (same < out->count
                   && strcmp(out->keys[same], weft_sweep_key(sweep, k)) != 0) {
                ++same;
            }
            out->keys[same] = weft_sweep_key(sweep, k);
            out->count += same == out->count;
        }
    }
    return out->keys != NULL;
}

/* As RFC 4180 quotes; followed by the end of the line or the next cell. */
static void cell(FILE *out, const char *text, char next)
{
    if (strpbrk(text, ",\"\r\n") == NULL) {
        fputs(text, out);
    } else {
        record_csv_quoted(out, text);
    }
    fputc(next, out);
}

/* Empty if result.yaml has none. Numbers as in series.csv. */
static const char *result_text(yaml_document_t *result, const char *key)
{
    static const char *const spelled[][2]
        = { { ".inf", "inf" }, { "-.inf", "-inf" }, { ".nan", "nan" } };
    const char *text = result == NULL ? NULL : record_result_value(result, key);
    text = text == NULL ? "" : text;
    for (size_t i = 0; i < sizeof spelled / sizeof spelled[0]; ++i) {
        text = strcmp(text, spelled[i][0]) == 0 ? spelled[i][1] : text;
    }
    return text;
}

static weft_status write_row(FILE *out, const batch *self, const varied *keys,
                             const batch_run *run, weft_error *err)
{
    char directory[RECORD_PATH];
    yaml_document_t result;
    TRY(record_path(self->out, run->name, directory, err));
    /* results of another scene's run, or of an unfinished one, do not count */
    const bool known = is_over(run->status) && record_result_open(directory, &result);
    for (size_t i = 0; i < keys->count; ++i) {
        const weft_sweep *sweep = run->scene->sweep;
        const char *text = "";
        for (size_t k = 0; k < weft_sweep_keys(sweep); ++k) {
            if (strcmp(weft_sweep_key(sweep, k), keys->keys[i]) == 0) {
                text = weft_sweep_value(sweep, k, run->number);
            }
        }
        cell(out, text, ',');
    }
    for (size_t i = 0; i < COLUMNS; ++i) {
        const char *name = columns[i];
        cell(out,
             strcmp(name, "scene") == 0    ? run->scene->stem
             : strcmp(name, "status") == 0 ? batch_status_names[run->status]
             : strcmp(name, "directory") == 0
                 ? run->name
                 : result_text(known ? &result : NULL, name),
             i + 1 < COLUMNS ? ',' : '\n');
    }
    if (known) {
        yaml_document_delete(&result);
    }
    return WEFT_OK;
}

static weft_status write_summary(const batch *self, const varied *keys, weft_error *err)
{
    record_file file;
    weft_status status = record_file_open(&file, self->out, "summary.csv", err);
    if (status != WEFT_OK) {
        return status;
    }
    for (size_t i = 0; i < keys->count; ++i) {
        cell(file.stream, keys->keys[i], ',');
    }
    for (size_t i = 0; i < COLUMNS; ++i) {
        cell(file.stream, columns[i], i + 1 < COLUMNS ? ',' : '\n');
    }
    for (size_t i = 0; status == WEFT_OK && i < self->run_count; ++i) {
        status = write_row(file.stream, self, keys, &self->runs[i], err);
    }
    if (status == WEFT_OK) {
        return record_file_commit(&file, err);
    }
    record_file_discard(&file);
    return status;
}

weft_status batch_summary(const batch *self, weft_error *err)
{
    varied keys;
    int lock;
    if (!collect_keys(self, &keys)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for summary.csv");
    }
    weft_status status = WEFT_OK;
    if (record_outdir_lock(self->out, BATCH_PATIENCE, &lock, NULL) == WEFT_OK) {
        status = write_summary(self, &keys, err);
        (void)close(lock);
    } else {
        status = weft_error_set(err, WEFT_IO, "%s: another weft writes its summary.csv",
                                self->out);
    }
    free(keys.keys);
    return status;
}
