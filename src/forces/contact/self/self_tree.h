/* SPDX-License-Identifier: BSD-3-Clause */
/* self_tree.h -- pairs of nodes of a cloth in a state that may be near each other, by a
 * quadtree over the grid, or over the points of a surface in their order. */
#pragma once

#include "forces/contact/self/contact_surface.h"
#include "forces/force.h"
#include "forces/seek/seek.h"

typedef struct weft__self weft__self;

/* Boxes: low, then high [m]. */
static inline double weft__most(double a, double b)
{
    return a > b ? a : b;
}

static inline double weft__axis_gap(const double a[2][3], const double b[2][3],
                                    size_t k)
{
    return weft__most(a[0][k] - b[1][k], b[0][k] - a[1][k]);
}

/* Along an axis; written out because loops here take most of the time of a search. */
static inline bool weft__boxes_apart(const double a[2][3], const double b[2][3],
                                     double range)
{
    return weft__most(weft__axis_gap(a, b, 0),
                      weft__most(weft__axis_gap(a, b, 1), weft__axis_gap(a, b, 2)))
           > range;
}

/* The bounds of a patch of the grid, with the particles to the right of it and below:
 * low, then high. */
typedef struct weft__knot {
    double place[2][3];    /* [m] of its particles */
    double slope[2][2][3]; /* of its edges down, then right, by the spacing */
} weft__knot;

/* Level 0 has the nodes, level k patches of them. */
typedef struct weft__quadtree {
    const weft__self *own;
    weft__nodes nodes;
    const double *y;
    weft__knot *knots;          /* of all levels; NULL: computed where needed */
    size_t first[WEFT__LEVELS]; /* of a level in knots */
    size_t levels;
} weft__quadtree;

weft__quadtree weft__tree_of(const weft__self *own, const double *y);

/* The knots that it needs. */
size_t weft__tree_size(const weft__quadtree *tree);

/* Fills knots[weft__tree_size], which the tree uses from then on. */
void weft__tree_fill(weft__quadtree *tree, weft__knot *knots);

/* Nodes i and j, or i == j; false ends the search. */
typedef bool weft__visit_fn(void *ctx, size_t i, size_t j);

/* Visits all pairs of nodes that own two primitives without a common particle within
 * `range` [m] of each other, and some others, each once and in an order that depends on
 * the cloth alone. Returns false if a visit did. The state must be finite. Where
 * patches are nearly flat their inside is passed over: nothing there is near itself. */
bool weft__tree_pairs(const weft__quadtree *tree, double range, weft__visit_fn *visit,
                      void *ctx);

/* ---- tiles ----------------------------------------------------------------------- */

weft__nodes weft__nodes_of(const weft__self *own);
size_t weft__tile_count(const weft__self *own);

/* Of a grid: the rows and columns of particles in patch i of a level, with those to the
 * right and below: first, end, first, end. */
static inline void weft__patch_range(const weft__mesh *of, size_t level, size_t i,
                                     size_t range[4])
{
    const size_t cols = weft__patches(of->cols, level), side = (size_t)1 << level;
    const size_t r = i / cols << level, c = i % cols << level;
    range[0] = r, range[1] = r + side + 1 < of->rows ? r + side + 1 : of->rows;
    range[2] = c, range[3] = c + side + 1 < of->cols ? c + side + 1 : of->cols;
}

/* Visits all pairs of tiles in the order in which weft__tree_pairs comes to them. */
bool weft__tile_pairs(const weft__self *own, weft__visit_fn *visit, void *ctx);

/* Begins to fill a tree tile by tile; weft__tree_between needs those of both tiles and
 * of the rectangle about them. Different threads may fill different tiles. */
void weft__tree_begin(weft__quadtree *tree, weft__knot *knots);
void weft__tree_fill_tile(weft__quadtree *tree, size_t tile);

/* As weft__tree_pairs, of nodes in two tiles of a pair of weft__tile_pairs. */
bool weft__tree_between(const weft__quadtree *tree, const uint32_t tiles[2],
                        double range, weft__visit_fn *visit, void *ctx);
