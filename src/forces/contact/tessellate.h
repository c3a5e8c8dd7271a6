/* SPDX-License-Identifier: BSD-3-Clause */
/* tessellate.h -- triangles of a sphere, capsule or box, whose vertices lie on its
 * surface. */
#pragma once

#include "forces/contact/contact.h"

enum { WEFT__MOST_FACETS = 200000 }; /* triangles that weft makes of a shape */

/* The surface of a block of steps[0] x steps[1] x steps[2] cells, laid onto a shape. */
typedef struct weft__lattice {
    weft_shape_kind kind;
    size_t round;            /* cells along each end of an axis, where it is rounded */
    size_t steps[3];         /* and all of them */
    double inner[3], radius; /* [m] half of the flat part */
    double centre[3], axes[3][3]; /* [m] from `at` */
    size_t vertices, triangles;
} weft__lattice;

/* [m] sqrt(2 R thickness), R the radius or rounding: such triangles lie at most a
 * quarter of the thickness below the surface. */
double weft__facet_edge(const weft_shape *shape, double thickness);

/* Of a shape without faults, with edges of at most `edge` [m] > 0, where its roundings
 * need no shorter ones. NULL, or what is wrong: the kind, a spin. More triangles than
 * WEFT__MOST_FACETS are left to the caller. */
const char *weft__lattice_of(const weft_shape *shape, double edge, weft__lattice *out);

/* Writes x y z [m] from `at` of each vertex, before a turn and an orientation, and
 * three corners of each triangle, counterclockwise from outside. */
void weft__lattice_fill(const weft__lattice *of, double *places, uint32_t *corners);
