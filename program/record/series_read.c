/* SPDX-License-Identifier: BSD-3-Clause */
/* series_read.c -- reads the rows of a series.csv. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/record/series.h"

typedef struct reader {
    FILE *stream;
    char path[RECORD_PATH];
    char line[8192];
    size_t number; /* of the line, from 1 */
} reader;

/* A line without an end was cut off by a kill. */
static bool next_line(reader *self)
{
    const bool whole = fgets(self->line, sizeof self->line, self->stream) != NULL
                       && strchr(self->line, '\n') != NULL;
    self->number += whole;
    return whole;
}

static const char *next_cell(const char *cell)
{
    const char *comma = strchr(cell, ',');
    return comma == NULL ? NULL : comma + 1;
}

/* The index of the cell of the header with that name; -1: none. */
static int column_of(const char *header, const char *name)
{
    const size_t length = strlen(name);
    int column = 0;
    for (const char *at = header; at != NULL; at = next_cell(at), ++column) {
        if (strncmp(at, name, length) == 0 && strchr(",\n", at[length]) != NULL) {
            return column;
        }
    }
    return -1;
}

static const char *cell(const char *line, int column)
{
    for (; column > 0 && line != NULL; --column) {
        line = next_cell(line);
    }
    return line == NULL ? "" : line;
}

static weft_status wrong(const reader *self, const char *what, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: %s", self->path, what);
}

static weft_status open_reader(reader *self, const char *directory, weft_error *err)
{
    self->number = 0;
    self->stream = record_open(directory, "series.csv", self->path, err);
    return self->stream != NULL ? WEFT_OK : WEFT_IO;
}

static weft_status read_rows(reader *self, record_series_row **rows, size_t *count,
                             weft_error *err)
{
    size_t capacity = 0;
    if (!next_line(self)) {
        return wrong(self, "no header", err);
    }
    const int time = column_of(self->line, "time"),
              hash = column_of(self->line, "hash");
    if (time < 0 || hash < 0 || column_of(self->line, "frame") != 0) {
        return wrong(self, "no columns frame, time and hash", err);
    }
    for (; next_line(self); ++*count) {
        if (*count == capacity) {
            capacity = capacity == 0 ? 256 : 2 * capacity;
            record_series_row *grown = realloc(*rows, capacity * sizeof *grown);
            if (grown == NULL) {
                return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a series");
            }
            *rows = grown;
        }
        record_series_row *row = &(*rows)[*count];
        if (sscanf(self->line, "%zu,", &row->frame) != 1
            || sscanf(cell(self->line, time), "%lf,", &row->time) != 1
            || sscanf(cell(self->line, hash), "%" SCNx64, &row->hash) != 1
            || (*count > 0 && !(row->time > row[-1].time))) {
            return weft_error_set(err, WEFT_IO, "%s: damaged: line %zu is not in order",
                                  self->path, self->number);
        }
    }
    return *count > 0 ? WEFT_OK : wrong(self, "no frames", err);
}

weft_status record_series_rows(const char *directory, record_series_row **rows,
                               size_t *count, weft_error *err)
{
    reader self;
    *rows = NULL;
    *count = 0;
    TRY(open_reader(&self, directory, err));
    const weft_status status = read_rows(&self, rows, count, err);
    (void)fclose(self.stream);
    if (status != WEFT_OK) {
        free(*rows);
        *rows = NULL;
        *count = 0;
    }
    return status;
}

static void add_cell(record_column *column, const char *text)
{
    char *end;
    const double value = strtod(text, &end);
    const bool number = end != text && strchr(",\n", *end) != NULL;
    column->last = number ? value : (double)NAN;
    if (number && isfinite(value)) {
        const double mean = column->count == 0 ? 0.0 : column->mean;
        column->least = fmin(column->least, value);
        column->most = fmax(column->most, value);
        column->mean = mean + (value - mean) / (double)++column->count;
    }
}

weft_status record_series_columns(const char *directory,
                                  record_column columns[RECORD_COLUMNS_MAX],
                                  size_t *count, weft_error *err)
{
    reader self;
    *count = 0;
    TRY(open_reader(&self, directory, err));
    const char *name = next_line(&self) ? self.line : NULL;
    for (; name != NULL && *count < RECORD_COLUMNS_MAX; name = next_cell(name)) {
        record_column *column = &columns[(*count)++];
        *column
            = (record_column){ .last = NAN, .least = NAN, .most = NAN, .mean = NAN };
        (void)snprintf(column->name, RECORD_COLUMN_NAME, "%.*s",
                       (int)strcspn(name, ",\n"), name);
    }
    while (next_line(&self)) {
        for (size_t i = 0; i < *count; ++i) {
            add_cell(&columns[i], cell(self.line, (int)i));
        }
    }
    (void)fclose(self.stream);
    return WEFT_OK;
}

/* Frame i is on line i + 2. */
weft_status record_series_compare(const char *directory, const char *damaged,
                                  const char *const *names, size_t count,
                                  record_numbers_fn *numbers, void *ctx,
                                  weft_error *err)
{
    reader self;
    double values[RECORD_COLUMNS_MAX];
    weft_status status = WEFT_OK;
    TRY(open_reader(&self, directory, err));
    (void)next_line(&self);
    while (status == WEFT_OK && next_line(&self)) {
        const size_t frame = self.number - 2;
        const bool known = numbers(ctx, frame, values);
        for (size_t i = 0; status == WEFT_OK && known && i < count; ++i) {
            const char *text = cell(self.line, (int)i);
            const double here
                = strchr(",\n", *text) != NULL ? (double)NAN : strtod(text, NULL);
            const bool equal = here == values[i] || (isnan(here) && isnan(values[i]));
            if (!equal && strcmp(names[i], "hash") != 0) {
                status = weft_error_set(
                    err, WEFT_IO,
                    "%s: damaged: %s of frame %zu is %.*g on line %zu of "
                    "series.csv and %.*g in run.vtkhdf",
                    damaged, names[i], frame, weft_text_digits(here), here, self.number,
                    weft_text_digits(values[i]), values[i]);
            }
        }
    }
    (void)fclose(self.stream);
    return status;
}
