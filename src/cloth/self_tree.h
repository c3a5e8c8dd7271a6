/* SPDX-License-Identifier: BSD-3-Clause */
/* self_tree.h -- pairs of nodes of a cloth in a state that may be near each other, by a
 * quadtree over the grid. */
#ifndef WEFT_CLOTH_SELF_TREE_H
#define WEFT_CLOTH_SELF_TREE_H

#include "cloth/model.h"

enum { WEFT__LEVELS = 33 };

/* The bounds of a patch of the grid, with the particles to the right of it and below:
 * low, then high. */
typedef struct weft__knot {
    double place[2][3];    /* [m] of its particles */
    double slope[2][2][3]; /* of its edges down, then right, by the spacing */
} weft__knot;

/* Level 0 has the nodes, level k patches of 2^k x 2^k of them. */
typedef struct weft__quadtree {
    const weft_cloth *cloth;
    const double *y;
    weft__knot *knots;          /* of all levels; NULL: computed where needed */
    size_t first[WEFT__LEVELS]; /* of a level in knots */
    size_t levels;
} weft__quadtree;

weft__quadtree weft__tree_of(const weft_cloth *cloth, const double *y);

/* The knots that a cloth needs. */
size_t weft__tree_size(const weft_cloth *cloth);

/* Fills knots[weft__tree_size], which the tree uses from then on, for state y. */
void weft__tree_fill(weft__quadtree *tree, const double *y, weft__knot *knots);

/* Nodes i and j, or i == j; false ends the search. */
typedef bool weft__visit_fn(void *ctx, size_t i, size_t j);

/* Visits all pairs of nodes that own two primitives without a common particle within
 * `range` [m] of each other, and some others, each once and in an order that depends on
 * the grid alone. Returns false if a visit did. The state must be finite. Where patches
 * are nearly flat their inside is passed over: nothing there is near itself. */
bool weft__tree_pairs(const weft__quadtree *tree, double range, weft__visit_fn *visit,
                      void *ctx);

#endif
