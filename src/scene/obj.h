/* SPDX-License-Identifier: BSD-3-Clause */
/* obj.h -- triangles of cloth from an OBJ file: v where a vertex starts, vt where it
 * lies in the rest shape. Text -> faces (obj_parse.c) -> vertices that are one
 * (obj_weld.c) -> the rest shape of a flat file (obj_flat.c) -> a definition (obj.c).
 * Mistakes are reported at their line, all of them. Numbers are read in the "C" locale.
 */
#pragma once

#include "mesh/triangles.h"
#include "scene/diagnostics.h"

/* Vertices and places are numbers of v and vt in the file, from 0. */
typedef struct weft__obj_face {
    uint32_t vertex[4], place[4]; /* WEFT__NONE: vertex[3] of a triangle, no vt */
    uint32_t byte;                /* of the text, where it stands */
    uint32_t fabric, groups;      /* 1 + the statement usemtl, g before it; 0: none */
} weft__obj_face;

typedef struct weft__obj_point {
    uint32_t vertex, groups;
} weft__obj_point;

/* A name in the text. */
typedef struct weft__obj_name {
    const char *text;
    uint32_t length, statement; /* 1 + the number of its usemtl or g */
} weft__obj_name;

/* An array that grows, of room for `room`. */
typedef struct weft__obj_names {
    weft__obj_name *list;
    size_t count, room;
    uint32_t statements;
} weft__obj_names;

typedef struct weft__obj {
    weft__report *report;
    weft__mark at;         /* where the scene names the file */
    weft__named_file file; /* its text is read already, or loaded */
    bool body;     /* no cloth: v and f alone are read, and it has no rest shape */
    bool in_space; /* the rest shape is v, and vt is not read */
    const weft_body
        *like;  /* whose quadrilaterals are divided alike; NULL: by lengths */
    bool welds; /* vertices at most `weld` apart, in the file's unit, are one */
    double weld;
    /* while it is read */
    bool kept;                              /* the text is, as long as the definition */
    size_t vertices, places, faces, points; /* in the file */
    double (*vertex)[3], (*place)[2];
    uint32_t *vertex_byte, *place_byte; /* of the text, where they stand */
    weft__obj_face *face;
    weft__obj_point *point;
    size_t point_room, face_room;
    size_t flat;        /* faces of a body that were dropped, as they have no area */
    uint32_t flat_byte; /* the first of them */
    weft__obj_names fabrics, groups;
    uint32_t *lowest;             /* the vertex that each became; NULL: no `weld` */
    uint32_t *vertex_of;          /* of v in the definition; WEFT__NONE: unused */
    uint32_t *place_of, *face_of; /* vt of a place, face of a triangle */
    size_t coarse;                /* vertices before it was refined */
    uint32_t (*parent)[2];        /* vertices beside those that came then */
    /* as long as the definition that points to it */
    weft_mesh_def def;
    double *start, *rest, *space;
    uint32_t *corner, *corner_place, *fabric_of;
    size_t *name;   /* number in the file of each vertex; freed if there is no other */
    size_t welded;  /* vertices that became another one */
    bool flat_rest; /* there is no vt: v gives the rest shape */
    double warp[3]; /* then the unit direction of v in the rest shape */
    size_t loose;   /* vertices that no face has */
    size_t *loose_name;  /* their numbers in the file */
    double *loose_start; /* where they would start */
} weft__obj;

/* Larger files are refused unread. */
#define WEFT__OBJ_BYTES ((size_t)1 << 30)

/* Read the file, or what obj->file.text is already, into *obj, whose report, at and
 * path are set, and make its definition: rest and start positions in the file's unit,
 * no fabrics. false: mistakes were reported, or memory ran out, which the report knows.
 */
bool weft__obj_load(weft__obj *obj, const char *path);
bool weft__obj_read(weft__obj *obj);

/* Shows its arrays in the definition. */
void weft__obj_show(weft__obj *obj);

/* Multiplies all lengths, turns by `angle` [degrees] about the axis through the origin
 * (its length does not matter, but it has one), then moves. */
void weft__obj_move(weft__obj *obj, double unit, const double axis[3], double angle,
                    const double at[3]);

/* obj_split.c: divides each side of a triangle by so many, a power of 2. false: it is
 * none, or the mesh becomes too large, which is reported; or no memory. */
bool weft__obj_refine(weft__obj *obj, size_t by);

/* Receives a fault of weft__triangles_create (mesh/triangles.h); ctx: the weft__obj. */
void weft__obj_fault(void *ctx, weft__mesh_part part, size_t index,
                     const char *message);

/* The place of a statement, for mistakes and warnings. */
weft__mark weft__obj_mark(weft__obj *obj, uint32_t byte);

/* Twice the area of a triangle, along its normal. */
void weft__obj_normal(const double a[3], const double b[3], const double c[3],
                      double out[3]);

/* Marks vertices of the definition that are of faces or points of a group in
 * member[vertices]. false: the file has no such group. */
bool weft__obj_group(const weft__obj *obj, const char *name, bool *member);

/* Writes a value to of[statement] of each statement with a name. Whether there are
 * some.
 */
bool weft__obj_named(const weft__obj_names *names, const char *name, size_t length,
                     uint32_t *of, uint32_t value);

/* " (did you mean 'x'?)" of the names in a file, or "", into out[size]. */
const char *weft__obj_near(const weft__obj_names *names, const char *typed, char *out,
                           size_t size);

/* Free what only reading needs; all of it. */
void weft__obj_forget(weft__obj *obj);
void weft__obj_close(weft__obj *obj, const weft_allocator *memory);

/* obj_parse.c: the text to vertices, places, faces and points. */
bool weft__obj_parse(weft__obj *obj);

/* obj_weld.c: gives faces and points the lowest of the vertices that are one. false: a
 * face has two corners in one, which is reported, or no memory. */
bool weft__obj_weld(weft__obj *obj);

/* obj_flat.c: makes places of v for a cloth without vt. false: it is not flat, which is
 * reported, or no memory. */
bool weft__obj_lay_flat(weft__obj *obj);
