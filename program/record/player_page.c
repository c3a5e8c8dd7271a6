/* SPDX-License-Identifier: BSD-3-Clause */
/* player_page.c -- selects the frames and particles that a page shows, and writes
 * them. */
#include "program/record/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TIME_MATCH 1e-9 /* relative: two frames of the same time */
enum {
    SIDE_MAX = 256,     /* particles shown along a side; more are thinned */
    FRAMES_WANTED = 24, /* fewer fit the budget: particles are thinned first, */
    COUNT_LEAST = 81    /* but no further */
};

static weft_status open_runs(player_page *self, weft_error *err)
{
    for (size_t r = 0; r < self->run_count; ++r) {
        player_run *run = &self->runs[r];
        TRY(record_frames_open(run->directory, &run->frames, err));
        self->faces = &self->runs[0].frames->faces;
        if (!record_faces_same(self->faces, &run->frames->faces)) {
            return record_faces_differ(self->runs[0].directory, self->faces,
                                       run->directory, &run->frames->faces,
                                       WEFT_INVALID, err);
        }
        run->index = calloc(run->frames->count, sizeof *run->index);
        run->xyz = calloc(3 * self->faces->particles, sizeof *run->xyz);
        if (run->index == NULL || run->xyz == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a page");
        }
    }
    return WEFT_OK;
}

/* Lists the frames whose time is in every run; returns their number. */
static size_t match(player_run *runs, size_t run_count)
{
    size_t at[PLAYER_RUNS] = { 0 }, found = 0;
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

/* How many frames of these particles fit. */
static double frames_that_fit(const player_page *self)
{
    const size_t bytes = self->run_count * page_block_size(self->planes, self->count)
                         + (self->run_count > 1 ? page_block_size(1, self->count) : 0);
    return self->budget / (4.0 / 3.0 * (double)bytes);
}

static double frames_expected(const player_page *self)
{
    return (double)(self->live ? self->runs[0].frames->planned : self->chosen);
}

/* Keeps every n-th frame and the last. */
static void thin(player_page *self)
{
    const double room = fmax(frames_that_fit(self) - 2.0, 1.0);
    self->step = (size_t)ceil(frames_expected(self) / room);
    for (size_t i = 0; i < self->chosen; ++i) {
        if (i % self->step != 0 && i + 1 < self->chosen) {
            continue;
        }
        for (size_t r = 0; r < self->run_count; ++r) {
            self->runs[r].index[self->shown] = self->runs[r].index[i];
        }
        ++self->shown;
    }
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
    const record_faces *of = self->faces;
    self->stride = 1;
    self->count = of->particles;
    if (of->cols > 0) {
        const size_t side = of->rows > of->cols ? of->rows : of->cols;
        const double wanted = fmin(frames_expected(self), FRAMES_WANTED);
        self->stride = (side - 1) / SIDE_MAX;
        do {
            ++self->stride;
            self->shown_rows = thinned(of->rows, self->stride);
            self->shown_cols = thinned(of->cols, self->stride);
            self->count = self->shown_rows * self->shown_cols;
        } while (self->count > COUNT_LEAST && frames_that_fit(self) < wanted);
    }
    self->particles = calloc(self->count, sizeof *self->particles);
    self->values = calloc(self->count, sizeof *self->values);
    self->field = calloc(3 * of->particles, sizeof *self->field);
    self->block = malloc(page_block_size(self->planes, self->count));
    if (!(self->particles && self->values && self->field && self->block)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a page");
    }
    for (size_t i = 0; i < self->count; ++i) {
        self->particles[i]
            = of->cols == 0
                  ? i
                  : kept(i / self->shown_cols, self->stride, of->rows) * of->cols
                        + kept(i % self->shown_cols, self->stride, of->cols);
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

weft_status player_page_encode(player_page *self, size_t run, size_t frame,
                               weft_error *err)
{
    record_frames *frames = self->runs[run].frames;
    double *xyz = self->runs[run].xyz;
    size_t plane = 3;
    TRY(record_frames_positions(frames, frame, xyz, err));
    for (size_t k = 0; k < 3; ++k) {
        put_plane(self, self->planes, k, xyz, 3, k);
    }
    for (size_t f = 0; f < PLAYER_FIELDS; ++f) {
        if (self->present[f]) {
            const player_field *field = &player_fields[f];
            TRY(record_frames_field(frames, field->field, frame, self->field, err));
            put_plane(self, self->planes, plane++, self->field, field->width,
                      field->width == 3 ? LENGTH : 0);
        }
    }
    for (size_t j = 0; j < self->sensitivities; ++j) {
        TRY(record_frames_sensitivity(frames, j, frame, self->field, err));
        put_plane(self, self->planes, plane++, self->field, 3, LENGTH);
    }
    return WEFT_OK;
}

weft_status player_page_open(player_page *self, const char *const *directories,
                             size_t count, weft_error *err)
{
    self->run_count = count;
    for (size_t r = 0; r < count; ++r) {
        self->runs[r].directory = directories[r];
    }
    TRY(open_runs(self, err));
    self->planes = 3;
    for (size_t f = 0; f < PLAYER_FIELDS; ++f) { /* shown if every run has it */
        self->present[f] = true;
        for (size_t r = 0; r < count; ++r) {
            self->present[f] = self->present[f]
                               && self->runs[r].frames->fields[player_fields[f].field];
        }
        self->planes += self->present[f];
    }
    self->sensitivities
        = self->runs[0].frames->sensitivities; /* those by which all runs have */
    for (size_t r = 1; r < count; ++r) {
        const record_frames *a = self->runs[0].frames, *b = self->runs[r].frames;
        self->sensitivities = a->sensitivities == b->sensitivities
                                      && memcmp(a->keys, b->keys, sizeof a->keys) == 0
                                  ? a->sensitivities
                                  : 0;
    }
    self->planes += self->sensitivities;
    self->chosen = match(self->runs, self->run_count);
    if (self->chosen == 0) {
        return weft_error_set(err, WEFT_INVALID, "%s and %s have no time in common",
                              self->runs[0].directory, self->runs[1].directory);
    }
    TRY(choose_particles(self, err));
    thin(self);
    return WEFT_OK;
}

/* Of two runs also the distance between them at each particle, from their unrounded
 * frames. */
weft_status player_page_write(player_page *self, weft_error *err)
{
    player_page_describe(self);
    for (size_t i = 0; i < self->shown; ++i) {
        for (size_t r = 0; r < self->run_count; ++r) {
            TRY(player_page_encode(self, r, self->runs[r].index[i], err));
            page_bytes(self->stream, self->block,
                       page_block_size(self->planes, self->count));
        }
        for (size_t k = 0; self->run_count > 1 && k < 3 * self->faces->particles; ++k) {
            self->field[k] = self->runs[1].xyz[k] - self->runs[0].xyz[k];
        }
        if (self->run_count > 1) {
            put_plane(self, 1, 0, self->field, 3, LENGTH);
            page_bytes(self->stream, self->block, page_block_size(1, self->count));
        }
    }
    return WEFT_OK;
}

void player_page_close(player_page *self)
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
                          const char *path, weft_error *err)
{
    player_page self = { .budget = PLAYER_BUDGET };
    record_file file;
    weft_status status = player_page_open(&self, directories, count, err);
    status = status == WEFT_OK ? page_open(&file, path, err) : status;
    if (status == WEFT_OK) {
        self.stream = file.stream;
        status = page_commit(&file, player_page_write(&self, err), err);
    }
    player_page_close(&self);
    return status;
}
