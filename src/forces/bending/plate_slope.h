/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_slope.h -- the slope of triangles across an edge, rebuilt from the positions of
 * particles nearby: g = sum of share x_i, along the normal n = (t_v, -t_u) in the plane
 * (u, v), t from the first end of the edge to the second. The fit is exact for
 * quadratics wherever the mesh allows it (docs/physics.md, "Bending of triangles"). */
#ifndef WEFT_FORCES_BENDING_PLATE_SLOPE_H
#define WEFT_FORCES_BENDING_PLATE_SLOPE_H

#include "mesh/triangles.h"

typedef struct weft__slopes {
    size_t *first;      /* of each edge, and their number */
    uint32_t *particle; /* may come twice in an edge */
    double *share;      /* [1/m] */
    size_t count, room; /* of particles and shares */
} weft__slopes;

/* Whether the cloth bends across a seam. Other edges of one triangle are rims. */
static inline bool weft__bends(const weft__triangles *mesh, const weft__edge *edge)
{
    return edge->sewn != WEFT__NONE && mesh->seams == WEFT_SEAM_BEND;
}

/* Whether each triangle is held: its corners are all pinned. NULL: no memory. */
bool *weft__held_triangles(const weft__triangles *of, const uint32_t *pin,
                           const weft_allocator *memory);

/* Of all edges that live triangles need, those not held. An edge of a held triangle has
 * the slope of that one; a rim has none. Each side of a seam has its own. `curved`:
 * instead h of all edges, L^2 / sqrt(12) times the second derivative along them, L
 * their length, with shares in [1]; those of held triangles, and those without a good
 * fit of few points, have none. False: no memory. Free them in either case. */
enum { WEFT__CURVE_PARTS = 40 };
bool weft__slopes_create(weft__slopes *out, const weft__triangles *of, const bool *held,
                         bool curved, const weft_allocator *memory);
void weft__slopes_free(weft__slopes *of, const weft_allocator *memory);

#endif
