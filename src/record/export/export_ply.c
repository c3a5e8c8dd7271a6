/* SPDX-License-Identifier: BSD-3-Clause */
/* export_ply.c -- Stanford PLY, binary, after G. Turk's description of the format. Of
 * triangles a vertex may have several texture coordinates: they are left out. */
#include "record/export/export.h"

static void write_header(FILE *stream, const record_faces *of)
{
    const size_t faces = record_face_count(of), n = of->particles;
    fprintf(stream, "ply\nformat binary_little_endian 1.0\ncomment weft %s, metres\n",
            weft_version());
    fprintf(stream, "element vertex %zu\n", n);
    fputs("property float x\nproperty float y\nproperty float z\n", stream);
    if (of->cols > 0) {
        fputs("property float s\nproperty float t\n", stream);
    }
    if (faces > 0) {
        fprintf(stream, "element face %zu\nproperty list uchar int vertex_indices\n",
                faces);
    } else {
        fprintf(stream,
                "element edge %zu\nproperty int vertex1\nproperty int vertex2\n",
                n - 1);
    }
    fputs("end_header\n", stream);
}

static void write_vertices(FILE *stream, const record_surface *surface)
{
    for (size_t i = 0; i < surface->faces.particles; ++i) {
        double uv[2];
        for (size_t k = 0; k < 3; ++k) {
            record_put_float(stream, surface->position[3 * i + k], false);
        }
        for (size_t k = 0; surface->faces.cols > 0 && k < 2; ++k) {
            record_texture(&surface->faces, i, uv);
            record_put_float(stream, uv[k], false);
        }
    }
}

static void write_faces(FILE *stream, const record_faces *of)
{
    const size_t faces = record_face_count(of), sides = record_face_sides(of);
    for (size_t f = 0; f < faces; ++f) {
        size_t at[4];
        record_face(of, f, at);
        record_put(stream, sides, 1, false);
        for (size_t k = 0; k < sides; ++k) {
            record_put(stream, at[k], 4, false);
        }
    }
    for (size_t i = 1; faces == 0 && i < of->particles; ++i) {
        record_put(stream, i - 1, 4, false);
        record_put(stream, i, 4, false);
    }
}

void record_ply(FILE *stream, const record_surface *surface)
{
    write_header(stream, &surface->faces);
    write_vertices(stream, surface);
    write_faces(stream, &surface->faces);
}
