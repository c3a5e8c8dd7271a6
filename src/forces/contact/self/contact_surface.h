/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_surface.h -- the primitives that may touch, of a cloth of triangles, or of a
 * grid as triangles, and of bodies: points, which are the particles of the cloth and
 * then the vertices of bodies, edges and triangles. A point owns itself and the edges
 * and triangles of which it is the lowest point, so that each pair of primitives
 * belongs to one pair of points. */
#pragma once

#include "base/memory.h"
#include "mesh/triangles.h"

enum { WEFT__SURFACE_RUN = 8 }; /* further points of a tile come by so many */

typedef struct weft__contact_surface {
    size_t points, particles, edges, triangles;
    uint32_t (*edge)[2], (*triangle)[3];   /* the lowest point first; in its order */
    uint32_t *edge_first, *triangle_first; /* of a point, and their number */
    /* [m^2] at rest, each as large as that of a point on a regular mesh: a third of a
     * point's triangles, all of an edge's, twice a triangle's */
    double *area, *edge_area, *triangle_area;
    double *density; /* [kg/m^2] of a point */
    /* With `grids`, pairs of a grid among several cloths with itself have its windows:
     * of edge e as of edge edges + e, of all triangles of part k as of triangle
     * 3 triangles + k. */
    bool grids;
    double *square;          /* [m^2] of an edge at rest */
    double *edge_window;     /* 1 / x0 of its ends */
    double *triangle_window; /* of corner k of triangle t: [k triangles + t] */
    double spacing;          /* [m] between particles, on average */
    uint32_t *order; /* of points as nodes of the tree; NULL: that of their numbers */
    /* Points of the primitives of each tile (self_tree.h), without an order those that
     * are not in its run; one of its own fills the last run. */
    size_t *tile_first;
    int32_t *tile_point;
    /* Pairs of slit edges, which never act (slit_edges.c), in order; and the nearest
     * other pair of the flat rest shape, if it is nearer than two thicknesses. */
    uint64_t (*slit_pairs)[2];
    size_t slit_pair_count;
    bool *at_slit; /* of a point */
    weft_primitive notch[2];
    double notch_width; /* [m] INFINITY: none */
} weft__contact_surface;

/* What a surface is made of: triangles with the squares [m^2] of their sides at rest,
 * [k] opposite corner k, and what is known of each point. */
typedef struct weft__surface_draft {
    size_t points, particles, triangles;
    uint32_t (*corner)[3];
    double (*side)[3];
    double *density;
    double thickness;  /* [m] */
    double chain;      /* [m] between particles of a grid without triangles; 0 */
    size_t rows, cols; /* of a grid */
    bool grids;        /* as of a surface */
} weft__surface_draft;

/* Room for so many; false: no memory. */
bool weft__surface_draft_create(weft__surface_draft *out, size_t points,
                                size_t triangles, const weft_allocator *memory);
void weft__surface_draft_destroy(weft__surface_draft *of, const weft_allocator *memory);

/* Write the triangles of a cloth, first of all: those of a mesh, and of all its parts,
 * or of a grid of a definition. */
void weft__surface_draft_mesh(weft__surface_draft *to, const weft__triangles *of);
void weft__surface_draft_parts(weft__surface_draft *to, const weft__triangles *of);
void weft__surface_draft_grid(weft__surface_draft *to, const weft__mesh *mesh,
                              const weft_cloth_def *def);

/* NULL: no memory. */
weft__contact_surface *weft__contact_surface_create(const weft__surface_draft *of,
                                                    const weft_allocator *memory);
void weft__contact_surface_destroy(weft__contact_surface *of,
                                   const weft_allocator *memory);
size_t weft__contact_surface_bytes(const weft__contact_surface *of);

/* The point that is a node. */
static inline size_t weft__contact_surface_point(const weft__contact_surface *surface,
                                                 size_t node)
{
    return surface->order != NULL ? surface->order[node] : node;
}

/* Points run[0], run[0] + 1, ... before run[1] of patch i of a level, and where further
 * ones begin and end in tile_point; tile: the patch is one. */
static inline void weft__patch_points(const weft__contact_surface *surface,
                                      size_t level, bool tile, size_t i, size_t run[2],
                                      size_t more[2])
{
    const size_t wide = level < 32 ? (size_t)1 << 2 * level : SIZE_MAX;
    const bool whole = wide >= surface->points, some = tile && !whole;
    const bool lists = some && surface->order != NULL && i * wide < surface->particles;
    run[0] = whole ? 0 : lists ? surface->points : i * wide;
    run[1] = whole || run[0] + wide > surface->points ? surface->points : run[0] + wide;
    more[0] = some ? surface->tile_first[i] : 0;
    more[1] = some ? surface->tile_first[i + 1] : 0;
}

/* The edge between two points, and the triangle of three in this turn; they must exist.
 */
static inline uint32_t weft__contact_surface_edge(const weft__contact_surface *surface,
                                                  uint32_t a, uint32_t b)
{
    uint32_t e = surface->edge_first[a < b ? a : b];
    while (surface->edge[e][1] != (a < b ? b : a)) {
        ++e;
    }
    return e;
}

static inline uint32_t
weft__contact_surface_triangle(const weft__contact_surface *surface,
                               const uint32_t c[3])
{
    const size_t k = c[0] < c[1] && c[0] < c[2] ? 0 : c[1] < c[2] ? 1 : 2;
    uint32_t t = surface->triangle_first[c[k]];
    while (surface->triangle[t][1] != c[(k + 1) % 3]
           || surface->triangle[t][2] != c[(k + 2) % 3]) {
        ++t;
    }
    return t;
}

/* Whether a pair that has a key never acts. */
bool weft__is_slit_pair(const weft__contact_surface *surface, const uint64_t key[2]);
