/* SPDX-License-Identifier: BSD-3-Clause */
/* export_csv.c -- writes one state as CSV and reads it back. */
#include "record/export/export.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record/result.h"

#define CSV_HEADER "row,col,x,y,z,vx,vy,vz\n"

static void write_vector(FILE *stream, const double *v, bool doubles)
{
    for (size_t k = 0; k < 3; ++k) {
        fprintf(stream, ",%.*g", doubles ? 17 : 9, v[k]);
    }
}

void record_csv(FILE *stream, const record_surface *surface)
{
    fputs(surface->velocity == NULL ? "row,col,x,y,z\n" : CSV_HEADER, stream);
    for (size_t i = 0; i < record_particles(surface); ++i) {
        fprintf(stream, "%zu,%zu", i / surface->cols, i % surface->cols);
        write_vector(stream, &surface->position[3 * i], surface->doubles);
        if (surface->velocity != NULL) {
            write_vector(stream, &surface->velocity[3 * i], surface->doubles);
        }
        fputc('\n', stream);
    }
}

static bool read_row(FILE *stream, size_t cols, size_t i, double *x, double *v)
{
    size_t row, col;
    return fscanf(stream, "%zu,%zu,%lf,%lf,%lf,%lf,%lf,%lf", &row, &col, &x[0], &x[1],
                  &x[2], &v[0], &v[1], &v[2])
               == 8
           && row == i / cols && col == i % cols;
}

static weft_status read_state(const char *directory, size_t rows, size_t cols,
                              double *position, double *velocity, weft_error *err)
{
    char path[RECORD_PATH];
    char header[sizeof CSV_HEADER];
    weft_status status = WEFT_OK;
    FILE *stream = record_open(directory, "final.csv", path, err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    if (fgets(header, sizeof header, stream) == NULL
        || strcmp(header, CSV_HEADER) != 0) {
        status = weft_error_set(err, WEFT_IO, "%s: not a state: line 1", path);
    }
    for (size_t i = 0; status == WEFT_OK && i < rows * cols; ++i) {
        if (!read_row(stream, cols, i, &position[3 * i], &velocity[3 * i])) {
            status
                = weft_error_set(err, WEFT_IO, "%s: damaged at line %zu", path, i + 2);
        }
    }
    (void)fclose(stream);
    return status;
}

static weft_status check_hash(const char *directory, size_t rows, size_t cols,
                              const double *position, const double *velocity,
                              weft_error *err)
{
    const size_t n = rows * cols;
    uint64_t recorded = 0;
    double *y = malloc(6 * n * sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    for (size_t i = 0; i < 3 * n; ++i) { /* planes */
        y[i % 3 * n + i / 3] = position[i];
        y[(3 + i % 3) * n + i / 3] = velocity[i];
    }
    const uint64_t hash = weft_state_hash(y, rows, cols);
    free(y);
    return record_result_hash(directory, &recorded) && hash == recorded
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO,
                                "%s/final.csv: damaged: its state has hash %016" PRIx64
                                ", that of result.yaml %016" PRIx64
                                ": other versions? see manifest.yaml",
                                directory, hash, recorded);
}

weft_status record_final_read(const char *directory, size_t rows, size_t cols,
                              double *position, double *velocity, weft_error *err)
{
    const weft_status status
        = read_state(directory, rows, cols, position, velocity, err);
    return status == WEFT_OK
               ? check_hash(directory, rows, cols, position, velocity, err)
               : status;
}
