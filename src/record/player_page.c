/* SPDX-License-Identifier: BSD-3-Clause */
/* player_page.c -- selects the frames and particles that the page shows, and writes
 * them. */
#include "record/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "record/frames.h"
#include "record/page.h"
#include "record/shape_mesh.h"

#define FRAME_BUDGET 64e6 /* [B] of all frames; more are thinned */
#define SIDE_MAX     256  /* particles shown along a side; more are thinned */
#define RUNS_MAX     2
#define TIME_MATCH   1e-9 /* relative: two frames of the same time */

/* Fields that may colour a cloth; of those of width 3, the length. */
static const struct field {
    const char *name;
    weft_record_field field;
    size_t width;
} fields[] = {
    { "strain", WEFT_RECORD_STRAIN, 1 },
    { "speed", WEFT_RECORD_VELOCITY, 3 },
};

#define FIELDS (sizeof fields / sizeof fields[0])

typedef struct player_run {
    const char *directory;
    record_frames *frames;
    double *xyz;   /* 3 N, positions of one frame */
    size_t *index; /* frames to choose from, then those shown */
} player_run;

typedef struct player_page {
    player_run runs[RUNS_MAX];
    size_t run_count, rows, cols;
    size_t chosen, shown; /* frames: to choose from, left after thinning */
    size_t stride, shown_rows, shown_cols, count; /* particles shown */
    size_t *particles;                            /* their indices */
    bool present[FIELDS];
    size_t planes;          /* x, y, z and the fields that are present */
    double *field, *values; /* 3 N as read, one plane as shown */
    unsigned char *block;
    FILE *stream;
} player_page;

/* A field is shown if every run has recorded it. */
static void find_fields(player_page *self)
{
    self->planes = 3;
    for (size_t f = 0; f < FIELDS; ++f) {
        self->present[f] = true;
        for (size_t r = 0; r < self->run_count; ++r) {
            self->present[f]
                = self->present[f] && self->runs[r].frames->fields[fields[f].field];
        }
        self->planes += self->present[f];
    }
}

static weft_status open_runs(player_page *self, weft_error *err)
{
    for (size_t r = 0; r < self->run_count; ++r) {
        player_run *run = &self->runs[r];
        const weft_status status
            = record_frames_open(run->directory, &run->frames, err);
        if (status != WEFT_OK) {
            return status;
        }
        const size_t rows = run->frames->rows, cols = run->frames->cols;
        self->rows = r == 0 ? rows : self->rows;
        self->cols = r == 0 ? cols : self->cols;
        if (rows != self->rows || cols != self->cols) {
            return weft_error_set(err, WEFT_INVALID,
                                  "runs of different grids: %s has %zu x %zu "
                                  "particles, %s %zu x %zu",
                                  self->runs[0].directory, self->rows, self->cols,
                                  run->directory, rows, cols);
        }
        run->index = calloc(run->frames->count, sizeof *run->index);
        run->xyz = calloc(3 * rows * cols, sizeof *run->xyz);
        if (run->index == NULL || run->xyz == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a page");
        }
    }
    find_fields(self);
    return WEFT_OK;
}

/* Lists the frames whose time is in every run; returns their number. */
static size_t match(player_run *runs, size_t run_count)
{
    size_t at[RUNS_MAX] = { 0 }, found = 0;
    const size_t other = run_count - 1;
    while (at[0] < runs[0].frames->count && at[other] < runs[other].frames->count) {
        const double t = runs[0].frames->times[at[0]];
        const double ahead = t - runs[other].frames->times[at[other]];
        const bool same = fabs(ahead) <= TIME_MATCH * (1.0 + fabs(t));
        if (same) {
            runs[0].index[found] = at[0];
            runs[other].index[found++] = at[other];
        }
        at[0] += same || ahead < 0.0;
        at[other] += other > 0 && (same || ahead > 0.0);
    }
    return found;
}

/* Keeps every n-th frame and the last, so that the page stays within its budget. */
static void thin(player_page *self)
{
    const size_t blocks = self->run_count;
    const double bytes
        = 4.0 / 3.0
          * ((double)(blocks * page_block_size(self->planes, self->count))
             + (blocks > 1 ? (double)page_block_size(1, self->count) : 0.0));
    const double step
        = ceil((double)self->chosen * bytes / (FRAME_BUDGET - 2.0 * bytes));
    for (size_t i = 0; i < self->chosen; ++i) {
        if (i % (size_t)step != 0 && i + 1 < self->chosen) {
            continue;
        }
        for (size_t r = 0; r < self->run_count; ++r) {
            self->runs[r].index[self->shown] = self->runs[r].index[i];
        }
        ++self->shown;
    }
}

static weft_status choose_frames(player_page *self, weft_error *err)
{
    self->chosen = match(self->runs, self->run_count);
    if (self->chosen == 0) {
        return weft_error_set(err, WEFT_INVALID, "%s and %s have no time in common",
                              self->runs[0].directory, self->runs[1].directory);
    }
    thin(self);
    return WEFT_OK;
}

static size_t thinned(size_t side, size_t stride)
{
    return (side - 1 + stride - 1) / stride + 1;
}

static size_t kept(size_t i, size_t stride, size_t side)
{
    return i * stride < side ? i * stride : side - 1;
}

static weft_status choose_particles(player_page *self, weft_error *err)
{
    const size_t side = self->rows > self->cols ? self->rows : self->cols;
    self->stride = (side + SIDE_MAX - 1) / SIDE_MAX;
    self->shown_rows = thinned(self->rows, self->stride);
    self->shown_cols = thinned(self->cols, self->stride);
    self->count = self->shown_rows * self->shown_cols;
    self->particles = calloc(self->count, sizeof *self->particles);
    self->values = calloc(self->count, sizeof *self->values);
    self->field = calloc(3 * self->rows * self->cols, sizeof *self->field);
    self->block = malloc(page_block_size(3 + FIELDS, self->count));
    if (!(self->particles && self->values && self->field && self->block)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a page");
    }
    for (size_t i = 0; i < self->count; ++i) {
        const size_t r = kept(i / self->shown_cols, self->stride, self->rows);
        const size_t c = kept(i % self->shown_cols, self->stride, self->cols);
        self->particles[i] = r * self->cols + c;
    }
    return WEFT_OK;
}

enum { LENGTH = 3 }; /* of the vector, instead of component 0, 1 or 2 */

/* One number of each particle shown, from `width` of every particle. */
static void put_plane(player_page *self, size_t planes, size_t plane,
                      const double *from, size_t width, size_t component)
{
    for (size_t i = 0; i < self->count; ++i) {
        const double *v = from + width * self->particles[i];
        self->values[i] = component == LENGTH
                              ? sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                              : v[component];
    }
    page_plane(self->block, planes, plane, self->values, self->count);
}

static weft_status write_frame(player_page *self, const player_run *run, size_t i,
                               weft_error *err)
{
    record_frames *frames = run->frames;
    const size_t index = run->index[i];
    size_t plane = 3;
    weft_status status = record_frames_positions(frames, index, run->xyz, err);
    for (size_t k = 0; status == WEFT_OK && k < 3; ++k) {
        put_plane(self, self->planes, k, run->xyz, 3, k);
    }
    for (size_t f = 0; status == WEFT_OK && f < FIELDS; ++f) {
        if (self->present[f]) {
            status
                = record_frames_field(frames, fields[f].field, index, self->field, err);
            put_plane(self, self->planes, plane++, self->field, fields[f].width,
                      fields[f].width == 3 ? LENGTH : 0);
        }
    }
    if (status == WEFT_OK) {
        page_bytes(self->stream, self->block,
                   page_block_size(self->planes, self->count));
    }
    return status;
}

/* The distance between the two runs at each particle, from their unrounded frames. */
static void write_difference(player_page *self)
{
    for (size_t i = 0; i < 3 * self->rows * self->cols; ++i) {
        self->field[i] = self->runs[1].xyz[i] - self->runs[0].xyz[i];
    }
    put_plane(self, 1, 0, self->field, 3, LENGTH);
    page_bytes(self->stream, self->block, page_block_size(1, self->count));
}

static weft_status write_frames(player_page *self, weft_error *err)
{
    for (size_t i = 0; i < self->shown; ++i) {
        for (size_t r = 0; r < self->run_count; ++r) {
            const weft_status status = write_frame(self, &self->runs[r], i, err);
            if (status != WEFT_OK) {
                return status;
            }
        }
        if (self->run_count > 1) {
            write_difference(self);
        }
    }
    return WEFT_OK;
}

static const char *comma(size_t i)
{
    return i > 0 ? "," : "";
}

/* A pinned particle that is not shown marks the nearest one that is. */
static void write_pinned(const player_page *self)
{
    bool *marks = calloc(self->count, sizeof *marks);
    const size_t half = self->stride / 2;
    const uint8_t *pinned = self->runs[0].frames->pinned;
    const size_t n = pinned == NULL ? 0 : self->rows * self->cols;
    size_t written = 0;
    for (size_t p = 0; marks != NULL && p < n; ++p) {
        const size_t r = (p / self->cols + half) / self->stride;
        const size_t c = (p % self->cols + half) / self->stride;
        marks[r * self->shown_cols + c] |= pinned[p] != 0;
    }
    for (size_t i = 0; marks != NULL && i < self->count; ++i) {
        if (marks[i]) {
            fprintf(self->stream, "%s%zu", comma(written++), i);
        }
    }
    free(marks);
}

/* The page does not reveal where on its author's disk the run is. */
static const char *directory_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL || slash[1] == '\0' ? path : slash + 1;
}

static void write_numbers(FILE *stream, const char *name, const double *x, size_t count)
{
    fprintf(stream, ",\"%s\":%s", name, count > 1 ? "[" : "");
    for (size_t k = 0; k < count; ++k) {
        fprintf(stream, "%s%.17g", comma(k), x[k]);
    }
    fputs(count > 1 ? "]" : "", stream);
}

static void write_shape(FILE *stream, const weft_shape *shape)
{
    fprintf(stream, "{\"shape\":\"%s\"", weft_shape_name(shape->kind));
    write_numbers(stream, "at", shape->at, 3);
    write_numbers(stream, "to", shape->to, 3);
    write_numbers(stream, "normal", shape->normal, 3);
    write_numbers(stream, "radius", &shape->radius, 1);
    write_numbers(stream, "half", shape->half, 3);
    write_numbers(stream, "rounding", &shape->rounding, 1);
    write_numbers(stream, "velocity", shape->velocity, 3);
    write_numbers(stream, "amplitude", shape->amplitude, 3);
    write_numbers(stream, "frequency", &shape->frequency, 1);
    write_numbers(stream, "spin", shape->spin, 3);
    fputc('}', stream);
}

static void write_obstacles(FILE *stream, const char *directory)
{
    weft_scene *scene = record_scene(directory);
    const weft_contact_def none = { .shape_count = 0 };
    const weft_contact_def *contact
        = scene == NULL ? &none : &weft_scene_cloth(scene)->contact;
    write_numbers(stream, "thickness", &contact->thickness, 1);
    fprintf(stream, ",\"self\":%s,\"obstacles\":[", contact->self ? "true" : "false");
    for (size_t k = 0; k < contact->shape_count; ++k) {
        fputs(comma(k), stream);
        write_shape(stream, &contact->shapes[k]);
    }
    fputc(']', stream);
    weft_scene_destroy(scene);
}

static void write_runs(const player_page *self)
{
    static const char *const files[]
        = { "scene.yaml", "manifest.yaml", "result.yaml", "series.csv" };
    for (size_t r = 0; r < self->run_count; ++r) {
        const player_run *run = &self->runs[r];
        fprintf(self->stream, "%s{\"directory\":", comma(r));
        page_text(self->stream, directory_name(run->directory));
        fprintf(self->stream, ",\"frames\":%zu,\"index\":[", run->frames->count);
        for (size_t i = 0; i < self->shown; ++i) {
            fprintf(self->stream, "%s%zu", comma(i), run->index[i]);
        }
        fputs("],\"numbers\":[", self->stream);
        for (size_t i = 0; i < self->shown; ++i) {
            fprintf(self->stream, "%s%.0f", comma(i),
                    run->frames->numbers[run->index[i]]);
        }
        fputc(']', self->stream);
        write_obstacles(self->stream, run->directory);
        for (size_t f = 0; f < sizeof files / sizeof files[0]; ++f) {
            fprintf(self->stream, ",\"%.*s\":", (int)strcspn(files[f], "."), files[f]);
            page_file(self->stream, run->directory, files[f]);
        }
        fputc('}', self->stream);
    }
}

static void write_description(const player_page *self)
{
    FILE *stream = self->stream;
    size_t written = 0;
    fputs("<script id=\"weft-data\" type=\"application/json\">{\"weft\":", stream);
    page_text(stream, weft_version());
    fprintf(stream, ",\"grid\":[%zu,%zu],\"shown\":[%zu,%zu],\"stride\":%zu",
            self->rows, self->cols, self->shown_rows, self->shown_cols, self->stride);
    fprintf(stream, ",\"chosen\":%zu,\"fields\":[", self->chosen);
    for (size_t f = 0; f < FIELDS; ++f) {
        if (self->present[f]) {
            fprintf(stream, "%s\"%s\"", comma(written++), fields[f].name);
        }
    }
    fputs("],\"times\":[", stream);
    for (size_t i = 0; i < self->shown; ++i) {
        fprintf(stream, "%s%.17g", comma(i),
                self->runs[0].frames->times[self->runs[0].index[i]]);
    }
    fputs("],\"pinned\":[", stream);
    write_pinned(self);
    fputs("],\"runs\":[", stream);
    write_runs(self);
    fputs("]}</script>\n", stream);
}

static weft_status write_page(player_page *self, const char *path, weft_error *err)
{
    const char *slash = strrchr(path, '/');
    const char *mark = strstr(weft__player_page, PAGE_MARK);
    char directory[RECORD_PATH];
    record_file file;
    (void)snprintf(directory, sizeof directory, "%.*s",
                   slash == NULL ? 1 : (int)(slash - path + (slash == path)),
                   slash == NULL ? "." : path);
    weft_status status
        = record_file_open(&file, directory, slash == NULL ? path : slash + 1, err);
    if (status != WEFT_OK) {
        return status;
    }
    self->stream = file.stream;
    (void)fwrite(weft__player_page, 1, (size_t)(mark - weft__player_page), file.stream);
    write_description(self);
    status = write_frames(self, err);
    (void)fputs(mark + strlen(PAGE_MARK), file.stream);
    if (status != WEFT_OK) {
        record_file_discard(&file);
        return status;
    }
    return record_file_commit(&file, err);
}

static void release(player_page *self)
{
    for (size_t r = 0; r < self->run_count; ++r) {
        record_frames_close(self->runs[r].frames);
        free(self->runs[r].index);
        free(self->runs[r].xyz);
    }
    free(self->particles);
    free(self->values);
    free(self->field);
    free(self->block);
}

weft_status record_player(const char *const *directories, size_t count,
                          const char *file, weft_error *err)
{
    player_page self = { .run_count = count };
    for (size_t r = 0; r < count; ++r) {
        self.runs[r].directory = directories[r];
    }
    weft_status status = open_runs(&self, err);
    status = status == WEFT_OK ? choose_particles(&self, err) : status;
    status = status == WEFT_OK ? choose_frames(&self, err) : status;
    status = status == WEFT_OK ? write_page(&self, file, err) : status;
    release(&self);
    return status;
}
