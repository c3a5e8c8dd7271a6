/* SPDX-License-Identifier: BSD-3-Clause */
/* export_vtp.c -- VTK's XML: one VTP file per frame, and the PVD file that lists them.
 *
 * The numbers follow the XML: for each array its length in bytes, then its values. The
 * offsets in the XML count from the byte after the underscore. */
#include "program/record/export/export.h"

#include <string.h>

#define HEAD(type)                                                                     \
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"" type                                   \
    "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"

/* An array: reals, or what `integer` says of each number. */
typedef struct vtp_array {
    const char *name;
    size_t components, count; /* numbers; 0: it is left out */
    const double *reals;
    size_t (*integer)(const record_surface *surface, size_t i);
} vtp_array;

/* Of points, of their data from the second to CELLS, and of cells. */
enum { CELLS = 4, ARRAYS = 6 };

/* ---- cells: faces, or one line ---------------------------------------------- */

static size_t cell_count(const record_surface *surface)
{
    const size_t faces = record_face_count(&surface->faces);
    return faces > 0 ? faces : 1;
}

static size_t cell_size(const record_surface *surface)
{
    return record_face_count(&surface->faces) > 0 ? record_face_sides(&surface->faces)
                                                  : surface->faces.particles;
}

static size_t corner_at(const record_surface *surface, size_t i)
{
    size_t corners[4];
    if (record_face_count(&surface->faces) == 0) {
        return i;
    }
    const size_t sides = record_face_sides(&surface->faces);
    record_face(&surface->faces, i / sides, corners);
    return corners[i % sides];
}

static size_t end_at(const record_surface *surface, size_t i)
{
    return (i + 1) * cell_size(surface);
}

static size_t cloth_at(const record_surface *surface, size_t i)
{
    return record_part_of(&surface->faces, i);
}

/* ---- VTP -------------------------------------------------------------------- */

static size_t number_size(const record_surface *surface, const vtp_array *of)
{
    return surface->doubles || of->integer != NULL ? 8 : 4;
}

/* The tag of an array at *offset, which grows by the array's size. */
static void tag(FILE *stream, const record_surface *surface, const vtp_array *of,
                size_t *offset)
{
    if (of->count > 0) {
        fprintf(stream,
                "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%zu\" "
                "format=\"appended\" offset=\"%zu\"/>\n",
                of->integer != NULL ? "Int64"
                : surface->doubles  ? "Float64"
                                    : "Float32",
                of->name, of->components, *offset);
        *offset += sizeof(uint64_t) + of->count * number_size(surface, of);
    }
}

static void put(FILE *stream, const record_surface *surface, const vtp_array *of)
{
    const size_t size = number_size(surface, of);
    record_put(stream, of->count * size, of->count > 0 ? 8 : 0, false);
    for (size_t i = 0; i < of->count; ++i) {
        uint64_t bits;
        if (of->integer != NULL) {
            record_put(stream, of->integer(surface, i), size, false);
        } else if (surface->doubles) {
            memcpy(&bits, &of->reals[i], sizeof bits);
            record_put(stream, bits, size, false);
        } else {
            record_put_float(stream, of->reals[i], false);
        }
    }
}

void record_vtp(FILE *stream, const record_surface *surface)
{
    const char *cells = record_face_count(&surface->faces) > 0 ? "Polys" : "Lines";
    const size_t n = surface->faces.particles, count = cell_count(surface);
    const vtp_array all[ARRAYS] = {
        { "Points", 3, 3 * n, surface->position, NULL },
        { "velocity", 3, surface->velocity != NULL ? 3 * n : 0, surface->velocity,
          NULL },
        { "strain", 1, surface->strain != NULL ? n : 0, surface->strain, NULL },
        { "cloth", 1, surface->faces.part_count > 0 ? n : 0, NULL, cloth_at },
        { "connectivity", 1, count * cell_size(surface), NULL, corner_at },
        { "offsets", 1, count, NULL, end_at },
    };
    size_t offset = 0;
    fprintf(stream,
            HEAD("PolyData") "<PolyData><Piece NumberOfPoints=\"%zu\" "
                             "NumberOf%s=\"%zu\">\n<Points>\n",
            n, cells, count);
    for (size_t k = 0; k < ARRAYS; ++k) {
        tag(stream, surface, &all[k], &offset);
        fputs(k == 0 ? "</Points>\n<PointData>\n" : "", stream);
        if (k + 1 == CELLS) {
            fprintf(stream, "</PointData>\n<%s>\n", cells);
        }
    }
    fprintf(stream, "</%s>\n</Piece></PolyData>\n<AppendedData encoding=\"raw\">\n_",
            cells);
    for (size_t k = 0; k < ARRAYS; ++k) {
        put(stream, surface, &all[k]);
    }
    fputs("\n</AppendedData></VTKFile>\n", stream);
}

/* ---- PVD -------------------------------------------------------------------- */

static void begin_pvd(FILE *stream, const double *times, size_t frames,
                      size_t particles)
{
    (void)times;
    (void)frames;
    (void)particles;
    fputs(HEAD("Collection") "<Collection>\n", stream);
}

static void list_pvd(FILE *stream, double time, size_t part, const char *file)
{
    fprintf(stream, "<DataSet timestep=\"%.17g\" part=\"%zu\" file=\"%s\"/>\n", time,
            part, file);
}

static void end_pvd(FILE *stream)
{
    fputs("</Collection></VTKFile>\n", stream);
}

const record_movie record_pvd
    = { .begin = begin_pvd, .list = list_pvd, .end = end_pvd };
