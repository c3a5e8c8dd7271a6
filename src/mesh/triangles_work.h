/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles_work.h -- a mesh of triangles in the making: for triangles.c and
 * triangles_check.c. */
#pragma once

#include "mesh/triangles.h"

/* An edge of a triangle, listed by its lower end. */
typedef struct weft__half_edge {
    uint32_t high, triangle; /* the higher end; of whom */
    uint8_t corner;          /* opposite */
    bool down;               /* runs from the higher end */
} weft__half_edge;

typedef struct weft__work {
    const weft_mesh_def *def;
    const weft_allocator *memory;
    const weft__mesh_faults *to;
    weft__triangles *out;
    bool failed, no_memory;
    /* scratch */
    bool *clockwise; /* good triangles, in (u, v) */
    bool *one_sided; /* no turning of triangles makes theirs run alike; NULL: unknown */
    uint8_t *bad; /* triangles with faults of their own; NULL: there are no triangles */
    weft__half_edge *halves; /* 3 T, by their lower ends, the higher ones, triangles */
    uint32_t *first;         /* of each lower end, and their number */
    uint32_t *piece;         /* of a triangle: the root of its tree */
    uint64_t *key, *place_key; /* of vertices, or triangles; of places */
    uint32_t *order, *other;
    double *view; /* [m] of vertices that rest in space: where they are on two axes */
} weft__work;

/* Zeroed; NULL: no memory, which *at keeps. */
void *weft__work_take(weft__work *at, size_t count, size_t size);

WEFT_PRINTF(4, 5)
void weft__mesh_fault(weft__work *at, weft__mesh_part part, size_t index,
                      const char *format, ...);

/* orient.c: whether the surface that a triangle belongs to has one side alone. */
bool weft__is_one_sided(weft__work *at, uint32_t triangle);

/* Numbers, indices and shapes of triangles, one by one. */
void weft__triangles_check(weft__work *at);

/* Twice the area of a triangle at rest, signed in the plane, and its longest edge. */
double weft__twice_area(const weft_mesh_def *def, size_t t, double *longest);

/* space.c: triangles whose rest shape lies in space. The corners of a triangle at rest
 * in a plane, (u, v) or its own: then corner 0 is the origin and corner 1 lies on the
 * first axis. */
void weft__def_corners(const weft_mesh_def *def, size_t t, double corner[3][2]);
/* As weft__twice_area, in space. */
double weft__space_twice_area(const weft_mesh_def *def, size_t t, double *longest);
/* The part of a triangle's fabric that has directions, 0 to 1. */
double weft__woven_part(const weft_mesh_def *def, size_t t);
/* Faults of the members about it; of warps that are normal to all triangles. */
void weft__rests_check(weft__work *at);
void weft__warps_check(weft__work *at);
/* Writes at->key and at->view of vertices there. */
void weft__space_keys(weft__work *at);
/* Fabrics besides those of the definition; frames and fabrics of *at->out. */
size_t weft__space_fabrics(const weft_mesh_def *def);
void weft__space_fill(weft__work *at);

/* The key of x along the curve, on a square from `low` with this side. */
uint64_t weft__curve_key(const double x[2], const double low[2], double side);

/* What messages call a vertex. */
static inline size_t weft__name_of(const weft__work *at, size_t vertex)
{
    return at->def->file_index != NULL ? at->def->file_index[vertex] : vertex;
}

/* The cloth that has a vertex; 0 if there is only one. */
WEFT__PART_OF(weft__part_at, weft_mesh_def)

/* The grid that has a vertex; NULL: it has triangles. */
static inline const weft_cloth_def *weft__grid_with(const weft_mesh_def *def, size_t i)
{
    return def->grids != NULL ? def->grids[weft__part_at(def, i)] : NULL;
}

/* mesh.c: where a vertex starts. */
void weft__def_start(const weft_mesh_def *def, size_t vertex, double x[3]);

/* How the cloth of a vertex rests; NULL: in the plane. */
static inline const weft_rest *weft__rest_in_space(const weft_mesh_def *def, size_t i)
{
    const weft_rest *of
        = def->rests != NULL ? &def->rests[weft__part_at(def, i)] : NULL;
    return of != NULL && of->shape == WEFT_REST_START ? of : NULL;
}

/* Whether a cloth is free of bending where it starts. */
static inline bool weft__starts_bent(const weft_rest *of)
{
    return of->angle == WEFT_ANGLE_START
           || (of->angle == WEFT_ANGLE_DEFAULT && of->shape == WEFT_REST_START);
}

static inline bool weft__any_starts_bent(const weft_mesh_def *def)
{
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    bool any = false;
    for (size_t k = 0; def->rests != NULL && k < parts; ++k) {
        any = any || weft__starts_bent(&def->rests[k]);
    }
    return any;
}

static inline bool weft__any_in_space(const weft_mesh_def *def)
{
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    bool any = false;
    for (size_t k = 0; def->rests != NULL && k < parts; ++k) {
        any = any || def->rests[k].shape == WEFT_REST_START;
    }
    return any;
}

/* Whether a mesh has triangles in the plane. */
static inline bool weft__any_in_plane(const weft_mesh_def *def)
{
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    bool any = def->rests == NULL;
    for (size_t k = 0; def->rests != NULL && k < parts; ++k) {
        const bool grid = def->grids != NULL && def->grids[k] != NULL;
        any = any || (!grid && def->rests[k].shape == WEFT_REST_PLANE);
    }
    return any;
}

/* [m] Where a vertex rests in space. */
static inline const double *weft__space_of(const weft_mesh_def *def, size_t i)
{
    return (def->space != NULL ? def->space : def->start) + 3 * i;
}

/* The vertex and the place of corner k of triangle t. In space, a vertex is its place.
 */
static inline uint32_t weft__vertex_at(const weft_mesh_def *def, size_t t, size_t k)
{
    return def->corners[3 * t + k];
}

static inline uint32_t weft__place_at(const weft_mesh_def *def, size_t t, size_t k)
{
    const uint32_t vertex = weft__vertex_at(def, t, k);
    return def->corner_uv != NULL && weft__rest_in_space(def, vertex) == NULL
               ? def->corner_uv[3 * t + k]
               : vertex;
}
