/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_arc.h -- edges measured along the cloth's arc (docs/physics.md): the square
 * of each has |h|^2 more, where h = sum of share x is L^2 / sqrt(12) times the second
 * derivative along it (forces/bending/plate_slope.h). With z = |h|^2 + damping
 * d|h|^2/dt and sums over the triangles of an edge d,
 *
 *     F = -share (S h) on its parts,           S = sum of K (q + damping dq/dt + z)
 *     F = +(E d) and -(E d) at its ends,       E = sum of K z
 *
 * beside the forces of membrane.h. Parts are summed by turns in two sums. The barrier
 * knows chords alone. The fast form takes
 * groups of particles of a block, with copies of what is near them. */
#ifndef WEFT_FORCES_MEMBRANE_ARC_H
#define WEFT_FORCES_MEMBRANE_ARC_H

#include "forces/bending/plate_slope.h"
#include "forces/force.h"

enum { WEFT__ARC_EDGES = 2560, WEFT__ARC_NEAR = 1536 }; /* of a group, at most */

/* What a particle is to an edge: a part of its h, or an end of its d, share -1 or 1. */
typedef struct weft__arc_part {
    double share;
    uint32_t item;  /* 2 e: h of edge e; 2 e + 1: d */
    uint32_t local; /* the same by the list of the group */
} weft__arc_part;

typedef struct weft__arc_edge {
    uint32_t edge, row; /* where its parts begin; those of the next edge end them */
    uint16_t end[2];    /* in the list of particles near */
} weft__arc_edge;

typedef struct weft__arc_triangle {
    uint32_t triangle;               /* first, for weft__ascending */
    uint16_t edge[3];                /* in the list */
    double stiff[6], square[3], lag; /* as weft__batch has them */
} weft__arc_triangle;

/* Where a group begins in the lists; one more ends them. Without edges: too large. */
typedef struct weft__arc_group {
    size_t particle, near, edge, triangle;
} weft__arc_group;

/* All NULL of chords. */
typedef struct weft__arc {
    weft__slopes rows; /* h of each edge */
    size_t *begin;     /* of each particle, and their number: */
    weft__arc_part *part;
    double *reach; /* of an edge: the sum of |share| weight */
    size_t *block; /* the first group of each block, and their number: */
    weft__arc_group *group;
    uint32_t *near;
    weft__arc_edge *edge;
    weft__arc_triangle *triangle;
    uint16_t *row; /* near */
    double *share;
    size_t groups, nears, edges, triangles, rows_near; /* in these lists */
    weft__add_fn *fast;
} weft__arc;

struct weft__membrane;
WEFT_FORMS(weft__add_fn, arc);

/* membrane_arc_init.c. False: no memory; free it in either case. */
bool weft__arc_create(struct weft__membrane *own, const weft_allocator *memory);
void weft__arc_free(weft__arc *of, const weft_allocator *memory);
size_t weft__arc_bytes(const struct weft__membrane *own);

/* |h|^2 of an edge [m^2], and its rate [m^2/s]; 0 of chords. */
void weft__arc_square(const struct weft__membrane *own, const double *y, size_t edge,
                      double square[2]);

/* h of an edge in three planes [m]. */
void weft__arc_row(const struct weft__membrane *own, const double *x, size_t edge,
                   double h[3]);

/* [N] on particle i, or its change along at->along. */
void weft__arc_force(const struct weft__membrane *own, const weft__state *at, size_t i,
                     double force[3]);

/* Adds to three planes, of particles [first, end); returns 0 or NaN. */
double weft__arc_particles(const struct weft__membrane *own, const weft__state *at,
                           weft__unit unit, double *to, size_t first, size_t end);

/* Of a state or of its change: squares of edges less those at rest, and |h|^2, with
 * their rates / 2. */
typedef struct weft__bent {
    double chord, chord_rate, arc, arc_rate; /* [m^2], [m^2/s] */
} weft__bent;

#endif
