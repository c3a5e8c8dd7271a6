/* SPDX-License-Identifier: BSD-3-Clause */
/* export_ply.c -- Stanford PLY, binary, after G. Turk's description of the format. */
#include "record/export/export.h"

static void write_header(FILE *stream, const record_surface *surface)
{
    const size_t quads = record_quads(surface), n = record_particles(surface);
    fprintf(stream, "ply\nformat binary_little_endian 1.0\ncomment weft %s, metres\n",
            weft_version());
    fprintf(stream, "element vertex %zu\n", n);
    fputs("property float x\nproperty float y\nproperty float z\n"
          "property float s\nproperty float t\n",
          stream);
    if (quads > 0) {
        fprintf(stream, "element face %zu\nproperty list uchar int vertex_indices\n",
                quads);
    } else {
        fprintf(stream,
                "element edge %zu\nproperty int vertex1\nproperty int vertex2\n",
                n - 1);
    }
    fputs("end_header\n", stream);
}

static void write_vertices(FILE *stream, const record_surface *surface)
{
    for (size_t i = 0; i < record_particles(surface); ++i) {
        double uv[2];
        record_texture(surface, i, uv);
        for (size_t k = 0; k < 3; ++k) {
            record_put_float(stream, surface->position[3 * i + k], false);
        }
        record_put_float(stream, uv[0], false);
        record_put_float(stream, uv[1], false);
    }
}

static void write_faces(FILE *stream, const record_surface *surface)
{
    for (size_t q = 0; q < record_quads(surface); ++q) {
        size_t at[4];
        record_quad(surface->cols, q, at);
        record_put(stream, 4, 1, false);
        for (size_t k = 0; k < 4; ++k) {
            record_put(stream, at[k], 4, false);
        }
    }
    for (size_t i = 1; record_quads(surface) == 0 && i < record_particles(surface);
         ++i) {
        record_put(stream, i - 1, 4, false);
        record_put(stream, i, 4, false);
    }
}

void record_ply(FILE *stream, const record_surface *surface)
{
    write_header(stream, surface);
    write_vertices(stream, surface);
    write_faces(stream, surface);
}
