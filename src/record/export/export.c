/* SPDX-License-Identifier: BSD-3-Clause */
/* export.c -- functions that several formats share. */
#include "record/export/export.h"

#include <string.h>

weft_status record_surface_write(const char *directory, const char *name,
                                 record_write_fn *write, const record_surface *surface,
                                 weft_error *err)
{
    record_file file;
    const weft_status status = record_file_open(&file, directory, name, err);
    if (status != WEFT_OK) {
        return status;
    }
    write(file.stream, surface);
    return record_file_commit(&file, err);
}

void record_texture(const record_faces *faces, size_t i, double uv[2])
{
    const size_t row = i / faces->cols, col = i % faces->cols;
    uv[0] = col > 0 ? (double)col / (double)(faces->cols - 1) : 0.0;
    uv[1] = row > 0 ? 1.0 - (double)row / (double)(faces->rows - 1) : 1.0;
}

void record_put(FILE *stream, uint64_t bits, size_t bytes, bool big)
{
    for (size_t i = 0; i < bytes; ++i) {
        const size_t byte = big ? bytes - 1 - i : i;
        (void)putc((int)(bits >> (8 * byte) & 0xff), stream);
    }
}

void record_put_float(FILE *stream, double value, bool big)
{
    const float rounded = record_single(value);
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    record_put(stream, bits, sizeof bits, big);
}
