/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles.h -- the second kind of mesh: triangles between particles, with a rest
 * shape in pieces of the plane (u, v). Particles lie in the order of a Hilbert curve
 * over (u, v), ties by where they start, and triangles in the order of their lowest
 * particle, so that neither depends on the numbers of the definition; a block is
 * WEFT__MESH_BLOCK particles. A *place* is a particle in one fan of triangles of one
 * piece: a vertex on a seam has several. An *edge* is one of the rest shape: where two
 * pieces are sewn there are two of them. */
#pragma once

#include "base/part.h"
#include "mesh/mesh.h"

enum { WEFT__MESH_BLOCK = WEFT_BLOCK_VERTICES };
#define WEFT__NONE UINT32_MAX

typedef struct weft__edge {
    uint32_t place[2];    /* its ends, that of the lower particle first */
    uint32_t triangle[2]; /* beside it; [1]: WEFT__NONE of a rim or a seam */
    uint32_t sewn;        /* the edge of another piece, or of another side of this one,
                             that it is sewn to; WEFT__NONE */
} weft__edge;

/* weft_cloth_part, with its name. A cloth has particles [first, first + count) as it
 * has vertices: the curve runs through one cloth after the other. */
typedef struct weft__part {
    char name[WEFT_CLOTH_NAME_MAX + 1];
    size_t first, count;
    double velocity[3];   /* [m/s] */
    weft__mesh grid;      /* its shape alone; rows 0: it has triangles instead */
    double mass, density; /* of the grid, as in weft_cloth_def */
} weft__part;

/* What of a fabric is not in weft_fabric. */
typedef struct weft__fabric_more {
    double bend_coupling; /* [N m] D12 */
    double barrier;       /* [N/m] C_warp + C_weft of the fabric as it is defined */
} weft__fabric_more;

typedef struct weft__triangles {
    size_t count, places, edges, pieces;
    size_t all;            /* `count` of the whole */
    uint32_t (*corner)[3]; /* particles, counterclockwise in (u, v), the lowest first */
    uint32_t (*place)[3];  /* their places */
    uint32_t (*edge)[3];   /* its edges: [k] is opposite corner k */
    uint32_t *piece, *fabric;
    uint32_t *around_first, *around; /* triangles of particle i, ascending: around[j],
                                        around_first[i] <= j < around_first[i + 1] */
    double *area;                    /* [m^2] at rest, > 0 */
    double (*rest)[2];  /* [m] (u, v) of a place; (-u, v) in mirrored pieces; where the
                           rest shape lies in space, a view of it: see frame */
    bool *mirrored;     /* whether a place is of such a piece */
    uint32_t *particle; /* of a place */
    weft__edge *edge_list;
    double *start;                /* [m] x y z of each particle */
    double *lumped;               /* [m^2] a third of the triangles of each particle */
    uint32_t *vertex, *of_vertex; /* of particle i of the whole in the definition, and
                                     back */
    size_t *name;                 /* of vertices; NULL: their numbers */
    weft_fabric *fabrics;         /* twist >= 0; then those of space.c */
    size_t fabric_count, fabric_room; /* without those; with them */
    weft__fabric_more *more;          /* as many as fabrics */
    double *space;         /* [m] x y z of each particle at rest in space; NULL:
                              none is */
    bool *in_space;        /* of triangles; NULL: none is */
    bool *angled;          /* of triangles that are free of bending where they
                              start; NULL: none is */
    double (*frame)[3][2]; /* [m] corners of each of them in its own plane, where
                              the second axis is that of the warp; NULL: none */
    weft_seam seams;
    bool arc;
    weft__part *parts;
    size_t part_count; /* 0: one cloth without a name */
} weft__triangles;

/* Of a vertex, or of a particle. */
WEFT__PART_OF(weft__part_of, weft__triangles)

/* Whether the rest shape of triangle t lies in space. */
static inline bool weft__in_space(const weft__triangles *of, size_t t)
{
    return of->in_space != NULL && of->in_space[t];
}

/* [m] Where corner k of triangle t rests in a plane: (u, v), or its own. */
static inline const double *weft__rest_at(const weft__triangles *of, size_t t, size_t k)
{
    return weft__in_space(of, t) ? of->frame[t][k] : of->rest[of->place[t][k]];
}

/* The part that has a vertex, or a particle, if it is a grid, whose particles have the
 * numbers of their vertices; else NULL. */
static inline const weft__part *weft__grid_at(const weft__mesh *mesh, size_t i)
{
    const weft__triangles *of = mesh->triangles;
    const weft__part *part
        = of != NULL && of->part_count > 0 ? &of->parts[weft__part_of(of, i)] : NULL;
    return part != NULL && part->grid.rows > 0 ? part : NULL;
}

/* The number in the definition of particle i of the whole, and the particle of a
 * number. */
static inline size_t weft__vertex_of(const weft__mesh *mesh, size_t i)
{
    return mesh->triangles != NULL ? mesh->triangles->vertex[i] : i;
}

static inline size_t weft__particle_of(const weft__mesh *mesh, size_t vertex)
{
    return mesh->triangles != NULL ? mesh->triangles->of_vertex[vertex] : vertex;
}

/* What the functions of a cloth call particle i, and back: its vertex; in a band i. */
static inline size_t weft__shown(const weft__mesh *mesh, size_t i)
{
    return mesh->whole_of != NULL ? i : weft__vertex_of(mesh, i);
}

static inline size_t weft__meant(const weft__mesh *mesh, size_t number)
{
    return mesh->whole_of != NULL ? number : weft__particle_of(mesh, number);
}

/* Receives a fault of vertex, place or triangle `index` of a definition. */
typedef enum weft__mesh_part {
    WEFT__MESH_DEF, /* the whole; index 0 */
    WEFT__MESH_VERTEX,
    WEFT__MESH_PLACE,
    WEFT__MESH_TRIANGLE,
    WEFT__MESH_FABRIC
} weft__mesh_part;
typedef struct weft__mesh_faults {
    void (*found)(void *ctx, weft__mesh_part part, size_t index, const char *message);
    void *ctx;
} weft__mesh_faults;

/* Makes triangles of a definition, or only checks it with out NULL. Reports its faults.
 * False, and *out NULL: a fault, or no memory, which sets *no_memory. */
bool weft__triangles_create(weft__triangles **out, const weft_mesh_def *def,
                            const weft_allocator *memory, const weft__mesh_faults *to,
                            bool *no_memory);
/* Writes the masses [kg] of particles with their loads. */
void weft__triangles_masses(const weft__triangles *of, const weft_cloth_def *def,
                            double *mass);

size_t weft__triangles_bytes(const weft__triangles *of, size_t n);
void weft__triangles_destroy(weft__triangles *of, const weft_allocator *memory);

/* An item of a loop over `count` that comes so many behind item i: what it refers to is
 * fetched while i waits, which takes a third of the time if the items of a file have no
 * order. */
static inline size_t weft__soon(size_t i, size_t ahead, size_t count)
{
    return i + ahead < count ? i + ahead : i;
}

/* around.c: fills around_first and around from the corners. */
void weft__around_fill(weft__triangles *of, size_t particles);

/* Writes the triangles that have a corner among particles [first, end) to list, in the
 * order of the first of these corners. Returns their number; list NULL: that alone. */
size_t weft__triangles_among(const weft__triangles *of, size_t first, size_t end,
                             uint32_t *list);
