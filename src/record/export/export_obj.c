/* SPDX-License-Identifier: BSD-3-Clause */
/* export_obj.c -- Wavefront OBJ. Indices count from 1. Of triangles vt is the rest
 * shape [m], as a scene reads it. */
#include "record/export/export.h"

static void write_vertices(FILE *stream, const record_surface *surface)
{
    const record_faces *faces = &surface->faces;
    for (size_t i = 0; i < faces->particles; ++i) {
        const double *x = &surface->position[3 * i];
        fprintf(stream, "v %.9g %.9g %.9g\n", x[0], x[1], x[2]);
    }
    for (size_t i = 0; faces->cols > 0 && i < faces->particles; ++i) {
        double uv[2];
        record_texture(faces, i, uv);
        fprintf(stream, "vt %.6g %.6g\n", uv[0], uv[1]);
    }
    for (size_t i = 0; i < faces->places; ++i) {
        fprintf(stream, "vt %.9g %.9g\n", faces->uv[2 * i], faces->uv[2 * i + 1]);
    }
}

static void write_faces(FILE *stream, const record_faces *faces)
{
    const size_t count = record_face_count(faces), sides = record_face_sides(faces);
    if (count == 0) {
        fputs("l", stream);
        for (size_t i = 1; i <= faces->particles; ++i) {
            fprintf(stream, " %zu", i);
        }
        fputc('\n', stream);
    }
    for (size_t f = 0; f < count; ++f) {
        size_t at[4];
        record_face(faces, f, at);
        fputs("f", stream);
        for (size_t k = 0; k < sides; ++k) {
            fprintf(stream, " %zu/%zu", at[k] + 1,
                    (faces->cols > 0 ? at[k] : faces->corner_places[3 * f + k]) + 1);
        }
        fputc('\n', stream);
    }
}

void record_obj(FILE *stream, const record_surface *surface)
{
    char size[RECORD_FACES_TEXT];
    fprintf(stream, "# weft %s: %s, metres\n", weft_version(),
            record_faces_text(&surface->faces, size));
    write_vertices(stream, surface);
    write_faces(stream, &surface->faces);
}
