/* SPDX-License-Identifier: BSD-3-Clause */
/* develop.h -- a patch of triangles that rest in space, unfolded into the plane about
 * one edge: each triangle keeps its lengths, so that the patch of a mesh that is folded
 * along its edges comes out as it was before (docs/theory/bending.md, "Meshes in
 * space"). The edge lies on the first axis with its middle at the origin, its first
 * triangle above it and its second below, whichever way round their corners go. */
#pragma once

#include "mesh/triangles.h"

typedef struct weft__develop {
    const weft__triangles *mesh;
    const weft_allocator *memory;
    const bool *held;
    double *length; /* [m] of each edge at rest */
    uint32_t edge, level;
    size_t begin; /* in list: triangles of the last level */
    size_t count;
    uint32_t *list;         /* triangles that are placed, level by level */
    double (*corner)[3][2]; /* [m] of each of them */
    uint32_t *turn;         /* 1 + the edge for which a triangle is placed, */
    uint32_t *reached;      /* its level, and how often it was reached there */
    uint32_t *times;
    double (*sum)[2]; /* [m] of a place: what it got at its level, so often */
    uint32_t *place_turn, *place_level, *place_times;
    bool spread; /* beyond the triangles about the ends of the edge */
} weft__develop;

/* held: triangles that are not crossed. False: no memory; free it in either case. */
bool weft__develop_create(weft__develop *of, const weft__triangles *mesh,
                          const bool *held, const weft_allocator *memory);
void weft__develop_free(weft__develop *of);

/* Unfolds the triangles about the ends of edge e. */
void weft__develop_begin(weft__develop *of, size_t e);

/* Unfolds those that share an edge with them, then their neighbours, call by call;
 * false: there are none. */
bool weft__develop_more(weft__develop *of);

/* [m] Where a place lies; false: it has not been reached. */
bool weft__developed(const weft__develop *of, uint32_t place, double y[2]);
