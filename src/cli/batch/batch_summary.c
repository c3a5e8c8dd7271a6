/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_summary.c -- summary.csv, joined from the result.yaml of all runs. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/batch/batch.h"
#include "record/result.h"

/* Keys of result.yaml. The wall time is the last column, as it alone differs from one
 * batch to the next. */
static const char *const outcome[]
    = { "reason",     "frames",     "time",       "steps",
        "rejected",   "rhs_calls",  "max_strain", "energy_start",
        "energy_end", "dissipated", "hash" };

#define OUTCOMES (sizeof outcome / sizeof outcome[0])

/* The keys varied in any scene, each once. */
typedef struct varied {
    const char **keys;
    size_t count;
} varied;

static size_t find_key(const char *const *keys, size_t count, const char *key)
{
    size_t i = 0;
    while (i < count && strcmp(keys[i], key) != 0) {
        ++i;
    }
    return i;
}

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
            const char *key = weft_sweep_key(sweep, k);
            if (find_key(out->keys, out->count, key) == out->count) {
                out->keys[out->count++] = key;
            }
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

/* A value of result.yaml; empty if it has none. Numbers as in series.csv. */
static void value_cell(FILE *out, yaml_document_t *result, const char *key, char next)
{
    static const char *const spelled[][2]
        = { { ".inf", "inf" }, { "-.inf", "-inf" }, { ".nan", "nan" } };
    const char *text = result == NULL ? NULL : record_result_value(result, key);
    text = text == NULL ? "" : text;
    for (size_t i = 0; i < sizeof spelled / sizeof spelled[0]; ++i) {
        text = strcmp(text, spelled[i][0]) == 0 ? spelled[i][1] : text;
    }
    cell(out, text, next);
}

static void write_header(FILE *out, const varied *keys)
{
    for (size_t i = 0; i < keys->count; ++i) {
        cell(out, keys->keys[i], ',');
    }
    fputs("scene,status,", out);
    for (size_t i = 0; i < OUTCOMES; ++i) {
        cell(out, outcome[i], ',');
    }
    fputs("directory,warnings,wall_time\n", out);
}

static void write_varied(FILE *out, const varied *keys, const batch_run *run)
{
    const weft_sweep *sweep = run->scene->sweep;
    for (size_t i = 0; i < keys->count; ++i) {
        const char *text = "";
        for (size_t k = 0; k < weft_sweep_keys(sweep); ++k) {
            if (strcmp(weft_sweep_key(sweep, k), keys->keys[i]) == 0) {
                text = weft_sweep_value(sweep, k, run->number);
            }
        }
        cell(out, text, ',');
    }
    cell(out, run->scene->stem, ',');
}

static weft_status write_row(FILE *out, const batch *self, const varied *keys,
                             const batch_run *run, weft_error *err)
{
    char directory[RECORD_PATH];
    yaml_document_t result;
    TRY(batch_directory(self, run, directory, err));
    /* results of another scene's run, or of an unfinished one, do not count */
    yaml_document_t *known
        = batch_is_over(run->status) && record_result_open(directory, &result) ? &result
                                                                               : NULL;
    write_varied(out, keys, run);
    cell(out, batch_status_name(run->status), ',');
    for (size_t i = 0; i < OUTCOMES; ++i) {
        value_cell(out, known, outcome[i], ',');
    }
    cell(out, run->name, ',');
    value_cell(out, known, "warnings", ',');
    value_cell(out, known, "wall_time", '\n');
    if (known != NULL) {
        yaml_document_delete(&result);
    }
    return WEFT_OK;
}

static weft_status write_summary(const batch *self, const varied *keys, weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, self->out, "summary.csv", err));
    write_header(file.stream, keys);
    for (size_t i = 0; i < self->run_count; ++i) {
        const weft_status status
            = write_row(file.stream, self, keys, &self->runs[i], err);
        if (status != WEFT_OK) {
            record_file_discard(&file);
            return status;
        }
    }
    return record_file_commit(&file, err);
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
