/* SPDX-License-Identifier: BSD-3-Clause */
/* export_obj.c -- Wavefront OBJ. Indices count from 1. */
#include "record/export/export.h"

static void write_vertices(FILE *stream, const record_surface *surface)
{
    for (size_t i = 0; i < record_particles(surface); ++i) {
        const double *x = &surface->position[3 * i];
        fprintf(stream, "v %.9g %.9g %.9g\n", x[0], x[1], x[2]);
    }
    for (size_t i = 0; i < record_particles(surface); ++i) {
        double uv[2];
        record_texture(surface, i, uv);
        fprintf(stream, "vt %.6g %.6g\n", uv[0], uv[1]);
    }
}

static void write_faces(FILE *stream, const record_surface *surface)
{
    if (record_quads(surface) == 0) {
        fputs("l", stream);
        for (size_t i = 1; i <= record_particles(surface); ++i) {
            fprintf(stream, " %zu", i);
        }
        fputc('\n', stream);
    }
    for (size_t q = 0; q < record_quads(surface); ++q) {
        size_t at[4];
        record_quad(surface->cols, q, at);
        fputs("f", stream);
        for (size_t k = 0; k < 4; ++k) {
            fprintf(stream, " %zu/%zu", at[k] + 1, at[k] + 1);
        }
        fputc('\n', stream);
    }
}

void record_obj(FILE *stream, const record_surface *surface)
{
    fprintf(stream, "# weft %s: %zu x %zu particles, metres\n", weft_version(),
            surface->rows, surface->cols);
    write_vertices(stream, surface);
    write_faces(stream, surface);
}
