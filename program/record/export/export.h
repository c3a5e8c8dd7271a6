/* SPDX-License-Identifier: BSD-3-Clause */
/* export.h -- frames as files that other programs read. Layouts are in
 * docs/reference/output.md.
 */
#pragma once

#include "program/record/frames.h"

/* The particles of one frame. Vectors are x y z of particle 0, x y z of particle 1, ...
 */
typedef struct record_surface {
    record_faces faces;     /* which it does not own */
    const double *position; /* [m] */
    const double *velocity; /* [m/s]; NULL: not known */
    const double *strain;   /* NULL: not known */
    bool doubles; /* else the values are floats and are written with fewer digits */
} record_surface;

/* The content of a file with one frame. */
typedef void record_write_fn(FILE *stream, const record_surface *surface);

/* Wavefront OBJ, faces and texture coordinates; a chain is a line. The same as binary
 * PLY; a chain is edges. export_csv.c: row,col,x,y,z,vx,vy,vz, of triangles
 * vertex,x,...; the velocities only if they are known. export_vtp.c: VTK PolyData in
 * XML, arrays appended raw. */
record_write_fn record_obj, record_ply, record_csv, record_vtp;

/* Writes such a file, which appears complete or not at all. */
weft_status record_surface_write(const char *directory, const char *name,
                                 record_write_fn *write, const record_surface *surface,
                                 weft_error *err);

/* One file for all frames: their points, or a list of their own files, with names
 * relative to this one. */
typedef struct record_movie {
    void (*begin)(FILE *stream, const double *times, size_t frames, size_t particles);
    record_write_fn *points; /* either this */
    void (*list)(FILE *stream, double time, size_t part, const char *file); /* or this
                                                                             */
    void (*end)(FILE *stream); /* NULL: not called */
} record_movie;

/* Point caches of other programs. export_vtp.c: an index of VTP files. */
extern const record_movie record_mdd, record_pc2, record_pvd;

/* export_csv.c: final.csv, into vectors of 3 N each. WEFT_IO if it is damaged or does
 * not have the hash in result.yaml; that of triangles needs their cloth. */
weft_status record_final_read(const char *directory, const record_faces *faces,
                              const weft_cloth *cloth, double *position,
                              double *velocity, weft_error *err);

/* Bytes of numbers, least significant first unless `big`. */
void record_put(FILE *stream, uint64_t bits, size_t bytes, bool big);
void record_put_float(FILE *stream, double value, bool big);

/* ---- shape_mesh.c: the shapes of a recorded run ---- */

/* DIR/scene.yaml, without the checks that need a plugin; NULL if it cannot be read: a
 * page or an export then has no shapes. */
weft_scene *record_scene(const char *directory);

enum { RECORD_SHAPE_ROWS = 25, RECORD_SHAPE_COLS = 49 };

/* The surface of shape k at time t [s], a grid that is closed at its poles and its
 * seam; of a plane a square near the cloth; of a mesh its triangles. Its points are in
 * position[3 record_shape_points]. */
size_t record_shape_count(const weft_cloth_def *cloth);
size_t record_shape_points(const weft_cloth_def *cloth);
record_surface record_shape_surface(const weft_cloth_def *cloth, size_t k, double t,
                                    double *position);
