/* SPDX-License-Identifier: BSD-3-Clause */
/* export.c -- functions that several formats share, and the simple ones: Wavefront OBJ,
 * Stanford PLY and point caches. */
#include "program/record/export/export.h"

#include <string.h>

weft_status record_surface_write(const char *directory, const char *name,
                                 record_write_fn *write, const record_surface *surface,
                                 weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, directory, name, err));
    write(file.stream, surface);
    return record_file_commit(&file, err);
}

/* Texture coordinates of particle i of a grid: u along a row, v up a column, from 0 to
 * 1. */
static void texture(const record_faces *faces, size_t i, double uv[2])
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

/* ---- OBJ: indices count from 1. Of triangles vt is the rest shape [m], as a scene
 * reads it ---- */

static void write_obj_vertices(FILE *stream, const record_surface *surface)
{
    const record_faces *faces = &surface->faces;
    for (size_t i = 0; i < faces->particles; ++i) {
        const double *x = &surface->position[3 * i];
        fprintf(stream, "v %.9g %.9g %.9g\n", x[0], x[1], x[2]);
    }
    for (size_t i = 0; faces->cols > 0 && i < faces->particles; ++i) {
        double uv[2];
        texture(faces, i, uv);
        fprintf(stream, "vt %.6g %.6g\n", uv[0], uv[1]);
    }
    for (size_t i = 0; i < faces->places; ++i) {
        fprintf(stream, "vt %.9g %.9g\n", faces->uv[2 * i], faces->uv[2 * i + 1]);
    }
}

static void write_obj_faces(FILE *stream, const record_faces *faces)
{
    const size_t count = record_face_count(faces), sides = record_face_sides(faces);
    if (count == 0) {
        fputs("l", stream);
        for (size_t i = 1; i <= faces->particles; ++i) {
            fprintf(stream, " %zu", i);
        }
        fputc('\n', stream);
    }
    for (size_t f = 0, shown = SIZE_MAX; f < count; ++f) {
        size_t at[4];
        record_face(faces, f, at);
        const size_t part = record_part_of(faces, at[0]);
        if (faces->part_count > 0 && part != shown) {
            fprintf(stream, "g %s\n", faces->parts[part].name);
            shown = part;
        }
        fputs("f", stream);
        for (size_t k = 0; k < sides; ++k) {
            const size_t place = faces->cols > 0 || faces->corner_uv == NULL
                                     ? at[k]
                                     : faces->corner_uv[3 * f + k];
            fprintf(stream, " %zu", at[k] + 1);
            if (faces->cols > 0 || faces->corner_uv != NULL) {
                fprintf(stream, "/%zu", place + 1);
            }
        }
        fputc('\n', stream);
    }
}

void record_obj(FILE *stream, const record_surface *surface)
{
    char size[RECORD_FACES_TEXT];
    fprintf(stream, "# weft %s: %s, metres\n", weft_version(),
            record_faces_text(&surface->faces, size));
    write_obj_vertices(stream, surface);
    write_obj_faces(stream, &surface->faces);
}

/* ---- PLY, binary, after G. Turk's description. Of triangles a vertex may have several
 * texture coordinates: they are left out ---- */

static void write_header(FILE *stream, const record_faces *of)
{
    const size_t faces = record_face_count(of), n = of->particles;
    fprintf(stream, "ply\nformat binary_little_endian 1.0\ncomment weft %s, metres\n",
            weft_version());
    for (size_t k = 0; k < of->part_count; ++k) {
        fprintf(stream, "comment cloth %zu is %s\n", k, of->parts[k].name);
    }
    fprintf(stream, "element vertex %zu\n", n);
    fputs("property float x\nproperty float y\nproperty float z\n", stream);
    if (of->cols > 0) {
        fputs("property float s\nproperty float t\n", stream);
    }
    if (of->part_count > 0) {
        fputs("property int cloth\n", stream);
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

static void write_ply_faces(FILE *stream, const record_faces *of)
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
    const record_faces *of = &surface->faces;
    write_header(stream, of);
    for (size_t i = 0; i < of->particles; ++i) {
        double uv[2];
        for (size_t k = 0; k < 3; ++k) {
            record_put_float(stream, surface->position[3 * i + k], false);
        }
        for (size_t k = 0; of->cols > 0 && k < 2; ++k) {
            texture(of, i, uv);
            record_put_float(stream, uv[k], false);
        }
        record_put(stream, record_part_of(of, i), of->part_count > 0 ? 4 : 0, false);
    }
    write_ply_faces(stream, of);
}

/* ---- point caches: the positions of all frames ---- */

static void write_points(FILE *stream, const record_surface *surface, bool big)
{
    for (size_t i = 0; i < 3 * surface->faces.particles; ++i) {
        record_put_float(stream, surface->position[i], big);
    }
}

/* ---- MDD: big-endian; frames, points, times [s], positions -------------------- */

static void begin_mdd(FILE *stream, const double *times, size_t frames,
                      size_t particles)
{
    record_put(stream, frames, 4, true);
    record_put(stream, particles, 4, true);
    for (size_t i = 0; i < frames; ++i) {
        record_put_float(stream, times[i], true);
    }
}

static void points_mdd(FILE *stream, const record_surface *surface)
{
    write_points(stream, surface, true);
}

const record_movie record_mdd = { .begin = begin_mdd, .points = points_mdd };

/* ---- PC2: little-endian; a sample a frame, from frame 0 ------------------------ */

static void begin_pc2(FILE *stream, const double *times, size_t frames,
                      size_t particles)
{
    (void)times;
    fwrite("POINTCACHE2", 1, 12, stream);
    record_put(stream, 1, 4, false); /* version */
    record_put(stream, particles, 4, false);
    record_put_float(stream, 0.0, false); /* first frame */
    record_put_float(stream, 1.0, false); /* frames per sample */
    record_put(stream, frames, 4, false);
}

static void points_pc2(FILE *stream, const record_surface *surface)
{
    write_points(stream, surface, false);
}

const record_movie record_pc2 = { .begin = begin_pc2, .points = points_pc2 };
