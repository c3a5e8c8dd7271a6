/* SPDX-License-Identifier: BSD-3-Clause */
/* net.h -- a Delaunay triangulation of points in the plane whose marked edges stay.
 * Which triangles it has is decided in integers, exactly: it does not depend on the
 * program that made the first one. Part of the program, not of libweft. */
#ifndef WEFT_CUT_NET_H
#define WEFT_CUT_NET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define NET_NONE UINT32_MAX

/* Counterclockwise; edge [k] is opposite corner [k]. */
typedef struct net_triangle {
    uint32_t corner[3], beside[3]; /* the triangle behind edge k; NET_NONE */
    uint32_t mark[3];              /* 1 + the number of a marked edge; 0: none */
    bool outside;
} net_triangle;

typedef struct cut_net {
    size_t points, point_room, triangles, triangle_room;
    double (*at)[2];    /* (u, v) of a point; the first four are a box around all */
    int32_t (*grid)[2]; /* the same in integers, moved a little and at random */
    double *size; /* [m] of triangles at a point, of the caller; INFINITY at first */
    uint32_t *of; /* a triangle of each point */
    net_triangle *triangle;
    uint32_t *stack; /* edges to look at: 3 triangle + k */
    size_t stacked, stack_room;
    double zero[2], unit; /* at = zero + unit * grid */
    double noise;         /* [grid units] */
    uint64_t seed;
    bool no_memory;
} cut_net;

/* An empty net for points in a box, of a spacing; then net_add, and net_start once. */
void net_begin(cut_net *self, const double low[2], const double high[2], double spacing,
               uint64_t seed);
void net_end(cut_net *self);

/* Adds a point without triangles; its number. NET_NONE: no memory. */
uint32_t net_add(cut_net *self, const double at[2]);

/* The triangulation of all points. NULL, or why there is none. */
const char *net_start(cut_net *self);

/* Moves a point as far towards `to` as its triangles stay counterclockwise, but not
 * more: whether it moved. net_restore makes the net Delaunay again. */
bool net_move(cut_net *self, uint32_t point, const double to[2]);
void net_restore(cut_net *self);

/* The edge from a to b as 3 triangle + k; NET_NONE: there is none. */
uint32_t net_edge(const cut_net *self, uint32_t a, uint32_t b);

/* Makes the edge from a to b, and marks it unless it is. false: others are in the way.
 */
bool net_mark(cut_net *self, uint32_t a, uint32_t b, uint32_t mark);

/* Puts the last point added into the triangle it lies in, seen from triangle `from`.
 * Where a marked edge hides that, or within a right angle of one, nothing is done, and
 * the edge returned. NET_NONE: it was put there, or lies on an edge. */
uint32_t net_insert(cut_net *self, uint32_t from);

/* Puts the last point added on a marked edge; its halves have `mark` and `behind`, from
 * its first end on. false: it would turn a triangle. */
bool net_split(cut_net *self, uint32_t edge, uint32_t first, uint32_t mark,
               uint32_t behind);

/* Drops the last point added. */
void net_drop(cut_net *self);

/* net_qhull.c: the Delaunay triangulation of points by Qhull: corners of its triangles,
 * of malloc. NULL: it failed. */
uint32_t *net_qhull(size_t points, const int32_t (*grid)[2], size_t *triangles);

/* A random number of [0, 1) that depends on all three. */
double net_random(uint64_t seed, uint64_t number, uint64_t which);

#endif
