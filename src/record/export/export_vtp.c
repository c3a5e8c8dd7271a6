/* SPDX-License-Identifier: BSD-3-Clause */
/* export_vtp.c -- VTK's XML: one VTP file per frame, and the PVD file that lists them.
 *
 * The numbers follow the XML: for each array its length in bytes, then its values. The
 * offsets in the XML count from the byte after the underscore. */
#include "record/export/export.h"

#include <string.h>

#define HEAD(type)                                                                     \
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"" type                                   \
    "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"

/* ---- arrays ----------------------------------------------------------------- */

static size_t real_size(const record_surface *surface)
{
    return surface->doubles ? 8 : 4;
}

/* The tag of an array at *offset, which grows by the array's size. */
static void tag(FILE *stream, const char *type, const char *name, size_t components,
                size_t bytes, size_t *offset)
{
    fprintf(stream,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%zu\" "
            "format=\"appended\" offset=\"%zu\"/>\n",
            type, name, components, *offset);
    *offset += sizeof(uint64_t) + bytes;
}

static void tag_reals(FILE *stream, const record_surface *surface, const char *name,
                      size_t components, size_t *offset)
{
    tag(stream, surface->doubles ? "Float64" : "Float32", name, components,
        surface->faces.particles * components * real_size(surface), offset);
}

static void put_reals(FILE *stream, const record_surface *surface, const double *values,
                      size_t components)
{
    const size_t count = surface->faces.particles * components;
    record_put(stream, count * real_size(surface), 8, false);
    for (size_t i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        if (surface->doubles) {
            record_put(stream, bits, sizeof bits, false);
        } else {
            record_put_float(stream, values[i], false);
        }
    }
}

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

static void put_cells(FILE *stream, const record_surface *surface)
{
    const size_t cells = cell_count(surface), size = cell_size(surface);
    const bool faces = record_face_count(&surface->faces) > 0;
    record_put(stream, 8 * cells * size, 8, false);
    for (size_t c = 0; c < cells; ++c) {
        size_t corners[4] = { 0 };
        if (faces) {
            record_face(&surface->faces, c, corners);
        }
        for (size_t k = 0; k < size; ++k) {
            record_put(stream, faces ? corners[k] : k, 8, false);
        }
    }
    record_put(stream, 8 * cells, 8, false);
    for (size_t c = 1; c <= cells; ++c) {
        record_put(stream, c * size, 8, false);
    }
}

/* ---- VTP -------------------------------------------------------------------- */

/* Of each particle; nothing of one cloth. */
static void put_cloths(FILE *stream, const record_faces *of)
{
    record_put(stream, 8 * of->particles, of->part_count > 0 ? 8 : 0, false);
    for (size_t i = 0; of->part_count > 0 && i < of->particles; ++i) {
        record_put(stream, record_part_of(of, i), 8, false);
    }
}

static void write_tags(FILE *stream, const record_surface *surface)
{
    const char *cells = record_face_count(&surface->faces) > 0 ? "Polys" : "Lines";
    size_t offset = 0;
    fprintf(stream,
            HEAD("PolyData") "<PolyData><Piece NumberOfPoints=\"%zu\" "
                             "NumberOf%s=\"%zu\">\n<Points>\n",
            surface->faces.particles, cells, cell_count(surface));
    tag_reals(stream, surface, "Points", 3, &offset);
    fputs("</Points>\n<PointData>\n", stream);
    if (surface->velocity != NULL) {
        tag_reals(stream, surface, "velocity", 3, &offset);
    }
    if (surface->strain != NULL) {
        tag_reals(stream, surface, "strain", 1, &offset);
    }
    if (surface->faces.part_count > 0) {
        tag(stream, "Int64", "cloth", 1, 8 * surface->faces.particles, &offset);
    }
    fprintf(stream, "</PointData>\n<%s>\n", cells);
    tag(stream, "Int64", "connectivity", 1,
        8 * cell_count(surface) * cell_size(surface), &offset);
    tag(stream, "Int64", "offsets", 1, 8 * cell_count(surface), &offset);
    fprintf(stream, "</%s>\n</Piece></PolyData>\n<AppendedData encoding=\"raw\">\n_",
            cells);
}

void record_vtp(FILE *stream, const record_surface *surface)
{
    write_tags(stream, surface);
    put_reals(stream, surface, surface->position, 3);
    if (surface->velocity != NULL) {
        put_reals(stream, surface, surface->velocity, 3);
    }
    if (surface->strain != NULL) {
        put_reals(stream, surface, surface->strain, 1);
    }
    put_cloths(stream, &surface->faces);
    put_cells(stream, surface);
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
