/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/record/vtkhdf_file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"

/* Triangles are in the order of files: of bands, rank 0 has them all. */
static void take_triangles(vtkhdf_rows *self, const weft_cloth *cloth)
{
    const bool first = self->comm == NULL || self->comm->rank == 0;
    self->own = record_own(cloth, &self->skip);
    self->cols = weft_cloth_particles(self->whole != NULL ? self->whole : cloth);
    self->band = (weft_band){ .rows = 1, .own = first ? 1 : 0 };
}

bool vtkhdf_rows_begin(vtkhdf_rows *self, const record_vtkhdf_def *def)
{
    size_t n = weft_cloth_particles(def->cloth);
    *self = (vtkhdf_rows){ .comm = def->comm,
                           .band = weft_cloth_band(def->cloth),
                           .cols = weft_cloth_cols(def->cloth),
                           .doubles = def->record->doubles,
                           .file = -1 };
    if (self->cols == 0) {
        self->whole = def->whole;
        take_triangles(self, def->cloth);
        n = n < self->cols ? self->cols : n;
    }
    if (self->whole != NULL) {
        self->all = malloc(3 * n * sizeof *self->all);
    }
    self->buffer = malloc(3 * n * sizeof *self->buffer);
    self->sums = malloc((self->band.own + 1) * sizeof *self->sums);
    self->all_sums = malloc(self->band.rows * sizeof *self->all_sums);
    return self->buffer != NULL && self->sums != NULL && self->all_sums != NULL
           && (self->whole == NULL || self->all != NULL);
}

static void close_file(vtkhdf_rows *self)
{
    if (self->file >= 0) {
        (void)close(self->file);
    }
    self->file = -1;
}

void vtkhdf_rows_end(vtkhdf_rows *self)
{
    close_file(self);
    free(self->buffer);
    free(self->all);
    free(self->sums);
    free(self->all_sums);
}

weft_status vtkhdf_rows_open(vtkhdf_rows *self, const char *path, int flags,
                             weft_error *err)
{
    close_file(self);
    if (self->comm != NULL) {
        self->comm->share(self->comm->self, self->places, sizeof self->places);
    }
    return record_shared_open(self->comm, path, flags, &self->file, err);
}

/* ---- a set of a frame ---------------------------------------------------- */

static void sum_rows(vtkhdf_rows *self, const double *own, size_t width)
{
    const size_t count = self->cols * width;
    for (size_t r = 0; r < self->band.own; ++r) {
        uint64_t sum = WEFT__HASH_START;
        for (size_t i = 0; i < count; ++i) {
            uint64_t word;
            memcpy(&word, &own[r * count + i], sizeof word);
            sum = weft__hash_word(sum, word);
        }
        self->sums[r] = sum;
    }
}

/* Where the own rows of a set are: in the buffer, and `size` bytes in the file. */
static double *own_rows(const vtkhdf_rows *self, size_t set, size_t width, size_t frame,
                        size_t *size, uint64_t *at)
{
    const size_t row
        = self->cols * width * (self->doubles ? sizeof(double) : sizeof(float));
    *size = self->band.own * row;
    *at = self->places[set]
          + ((uint64_t)frame * self->band.rows + self->band.first) * row;
    return self->buffer + self->band.above * self->cols * width;
}

/* The own particles of all bands of triangles, to the buffer of rank 0. */
static void gather(vtkhdf_rows *self, size_t width)
{
    const size_t bytes = width * sizeof *self->buffer;
    self->comm->gather(self->comm->self, self->buffer + self->skip * width,
                       self->own * bytes, self->all);
    for (size_t i = 0; self->whole != NULL && i < self->cols; ++i) {
        memcpy(self->buffer + weft_cloth_vertex(self->whole, i) * width,
               self->all + i * width, bytes);
    }
}

bool vtkhdf_rows_write(vtkhdf_rows *self, size_t set, size_t width, size_t frame)
{
    size_t size;
    uint64_t at;
    if (self->comm != NULL && self->own > 0) {
        gather(self, width);
    }
    double *own = own_rows(self, set, width, frame, &size, &at);
    sum_rows(self, own, width);
    /* little-endian and in place: single precision is before what is still to be read
     */
    unsigned char *to = (unsigned char *)own;
    for (size_t i = 0; i < self->band.own * self->cols * width; ++i) {
        if (self->doubles) {
            weft__real_put(to + i * sizeof(double), own[i]);
        } else {
            weft__single_put(to + i * sizeof(float), (float)own[i]);
        }
    }
    return record_write_at(self->file, own, size, at);
}

bool vtkhdf_rows_read(vtkhdf_rows *self, size_t set, size_t width, size_t frame)
{
    size_t size;
    uint64_t at;
    double *own = own_rows(self, set, width, frame, &size, &at);
    const bool good = record_read_at(self->file, own, size, at);
    const unsigned char *from = (const unsigned char *)own;
    for (size_t i = self->band.own * self->cols * width; good && i-- > 0;) {
        own[i] = self->doubles ? weft__real_at(from + i * sizeof(double))
                               : (double)weft__single_at(from + i * sizeof(float));
    }
    if (good) {
        sum_rows(self, own, width);
    }
    return good;
}

uint64_t vtkhdf_rows_sum(vtkhdf_rows *self, uint64_t sum)
{
    const uint64_t *all = self->sums;
    if (self->comm != NULL) {
        self->comm->gather(self->comm->self, self->sums,
                           self->band.own * sizeof *self->sums, self->all_sums);
        all = self->comm->rank == 0 ? self->all_sums : NULL;
    }
    for (size_t r = 0; all != NULL && r < self->band.rows; ++r) {
        sum = weft__hash_word(sum, all[r]);
    }
    return sum;
}
