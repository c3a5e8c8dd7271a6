/* SPDX-License-Identifier: BSD-3-Clause */
/* shape.h -- angles of a net's triangles, and the moves and points that make them
 * larger. */
#ifndef WEFT_CUT_SHAPE_H
#define WEFT_CUT_SHAPE_H

#include "cut/net.h"

/* A part of a line, an edge of the net. */
typedef struct shape_part {
    uint32_t from, to;   /* points */
    uint32_t line, next; /* the part behind it; NET_NONE: the last */
} shape_part;

typedef struct cut_shape {
    cut_net net;
    shape_part *part;
    size_t parts, part_room;
    double spacing; /* [m] the largest size */
    size_t most;    /* points, with those that are added */
} cut_shape;

/* Tangent of the smallest angle of a triangle, and its corner. */
double shape_angle(const cut_net *net, const net_triangle *at, unsigned *corner);

/* Moves points inside to where triangles are even, a few rounds. */
void shape_smooth(cut_net *net);

/* Adds points where an angle is small, then moves some. */
void shape_refine(cut_shape *self);

/* Adds a part, whose points have its length as their size at most. false: no memory. */
bool shape_add_part(cut_shape *self, shape_part part);

#endif
