/* SPDX-License-Identifier: BSD-3-Clause */
/* state.c -- one state as CSV or as Wavefront OBJ. */
#include "record/record.h"

#include <errno.h>
#include <string.h>

#define CSV_HEADER "row,col,x,y,z,vx,vy,vz\n"

weft_status record_csv(const char *directory, const char *name, const weft_cloth *cloth,
                       const double *y, weft_error *err)
{
    const size_t n = weft_cloth_particles(cloth), cols = weft_cloth_cols(cloth);
    record_file file;
    const weft_status status = record_file_open(&file, directory, name, err);
    if (status != WEFT_OK) {
        return status;
    }
    fputs(CSV_HEADER, file.stream);
    for (size_t i = 0; i < n; ++i) {
        fprintf(file.stream, "%zu,%zu", i / cols, i % cols);
        for (size_t k = 0; k < 6; ++k) {
            fprintf(file.stream, ",%.17g", y[k * n + i]);
        }
        fputc('\n', file.stream);
    }
    return record_file_commit(&file, err);
}

static bool read_row(FILE *stream, size_t n, size_t cols, size_t i, double *y)
{
    size_t row, col;
    if (fscanf(stream, "%zu,%zu", &row, &col) != 2 || row != i / cols
        || col != i % cols) {
        return false;
    }
    for (size_t k = 0; k < 6; ++k) {
        if (fscanf(stream, ",%lf", &y[k * n + i]) != 1) {
            return false;
        }
    }
    return true;
}

weft_status record_csv_read(const char *directory, const char *name,
                            const weft_cloth *cloth, double *y, weft_error *err)
{
    const size_t n = weft_cloth_particles(cloth);
    char path[RECORD_PATH], header[sizeof CSV_HEADER];
    weft_status status = record_path(directory, name, path, err);
    if (status != WEFT_OK) {
        return status;
    }
    FILE *stream = fopen(path, "r");
    if (stream == NULL) {
        return weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(errno));
    }
    if (fgets(header, sizeof header, stream) == NULL
        || strcmp(header, CSV_HEADER) != 0) {
        status = weft_error_set(err, WEFT_IO, "%s: not a state: line 1", path);
    }
    for (size_t i = 0; status == WEFT_OK && i < n; ++i) {
        if (!read_row(stream, n, weft_cloth_cols(cloth), i, y)) {
            status
                = weft_error_set(err, WEFT_IO, "%s: damaged at line %zu", path, i + 2);
        }
    }
    (void)fclose(stream);
    return status;
}

static double fraction(size_t index, size_t count)
{
    return count > 1 ? (double)index / (double)(count - 1) : 0.0;
}

static void obj_faces(FILE *stream, size_t rows, size_t cols)
{
    if (rows == 1 || cols == 1) {
        fputs("l", stream);
        for (size_t i = 1; i <= rows * cols; ++i) {
            fprintf(stream, " %zu", i);
        }
        fputc('\n', stream);
    }
    for (size_t r = 0; r + 1 < rows; ++r) {
        for (size_t c = 0; c + 1 < cols; ++c) {
            const size_t a = r * cols + c + 1, b = a + cols;
            fprintf(stream, "f %zu/%zu %zu/%zu %zu/%zu %zu/%zu\n", a, a, b, b, b + 1,
                    b + 1, a + 1, a + 1);
        }
    }
}

weft_status record_obj(const char *directory, const char *name, const weft_cloth *cloth,
                       const double *y, weft_error *err)
{
    const size_t rows = weft_cloth_rows(cloth), cols = weft_cloth_cols(cloth);
    const size_t n = rows * cols;
    record_file file;
    const weft_status status = record_file_open(&file, directory, name, err);
    if (status != WEFT_OK) {
        return status;
    }
    fprintf(file.stream, "# weft %s: %zu x %zu particles, metres\n", weft_version(),
            rows, cols);
    for (size_t i = 0; i < n; ++i) {
        fprintf(file.stream, "v %.9g %.9g %.9g\n", y[i], y[n + i], y[2 * n + i]);
    }
    for (size_t i = 0; i < n; ++i) {
        fprintf(file.stream, "vt %.6g %.6g\n", fraction(i % cols, cols),
                1.0 - fraction(i / cols, rows));
    }
    obj_faces(file.stream, rows, cols);
    return record_file_commit(&file, err);
}
