/* SPDX-License-Identifier: BSD-3-Clause */
/* aggregate.h -- groups the particles of a network into aggregates of up to four, and
 * finds the network of these. It follows from the graph alone, not from the state. */
#pragma once

#include "pile.h"

#define WEFT__WITHIN UINT32_MAX /* of a spring that joins an aggregate to itself */

/* Edges (a, b), a < b, and how many springs each stands for. */
typedef struct weft__graph {
    uint32_t n, m;
    uint32_t *a, *b, *weight;
} weft__graph;

/* Takes the arrays for the m edges that are there. */
void weft__graph_take(weft__graph *self, weft__pile *pile);

/* Two rounds of pairwise matching: writes the aggregate of each vertex to to[n], the
 * edge of the coarse graph or WEFT__WITHIN of each edge to target[m], and the coarse
 * graph, whose edges are in order of b - a, then of a. False: no memory. */
bool weft__aggregate(const weft__graph *fine, uint32_t *to, uint32_t *target,
                     weft__graph *coarse, weft__pile *scratch);
