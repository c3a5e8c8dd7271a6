/* SPDX-License-Identifier: BSD-3-Clause */
/* seek.h -- which primitives of two tiles of a cloth may be near each other in a state.
 * It knows nodes, and the points, edges and triangles that they own, and tells a
 * callback of the pairs; what these do is not its business.
 *
 * A node is a point with the edges and triangles that it owns, so that each pair of
 * primitives belongs to one pair of nodes. Nodes lie in patches, and these in larger
 * ones up to tiles, each in a box. Boxes are in single precision, rounded outwards, so
 * that several are compared at once: further from the origin they are looser, and a
 * search finds more pairs, never fewer. */
#pragma once

#include "base/isa.h"
#include "base/memory.h"

/* ---- nodes, patches and tiles ---------------------------------------------------- */

enum { WEFT__LEVELS = 33, WEFT__TILE_LEVEL = 3, WEFT__TILES_MOST = 1024 };

/* Nodes in rows and columns, of which level k has patches of 2^k x 2^k, or those of a
 * surface, its points in its order, in one row, by 4^k. */
typedef struct weft__nodes {
    size_t rows, cols;
    unsigned fold; /* 1; of a surface 2 */
} weft__nodes;

static inline size_t weft__patches(size_t nodes, size_t level)
{
    return ((nodes - 1) >> level) + 1;
}

/* Columns of the patches of a level. */
static inline size_t weft__patches_across(const weft__nodes *of, size_t level)
{
    return weft__patches(of->cols, of->fold * level);
}

static inline size_t weft__patch_count(const weft__nodes *of, size_t level)
{
    return weft__patches(of->rows, level) * weft__patches_across(of, level);
}

/* Tiles are the patches of one level, row by row: 64 nodes, or so many that they are
 * not more than WEFT__TILES_MOST. */
size_t weft__tile_level(weft__nodes of);

/* ---- pairs ----------------------------------------------------------------------- */

/* Two primitives without a common point: their points, those of the second after those
 * of the first. */
typedef enum weft__pair_kind {
    WEFT__VERTICES,        /* 0 and 1 */
    WEFT__VERTEX_EDGE,     /* 0 and 1-2 */
    WEFT__VERTEX_TRIANGLE, /* 0 and 1-2-3 */
    WEFT__EDGES            /* 0-1 and 2-3 */
} weft__pair_kind;

typedef struct weft__pair {
    uint32_t particle[4];
    uint32_t item[2]; /* of a surface: their numbers as points, edges or triangles */
    uint32_t kind;
} weft__pair;

static inline size_t weft__kind_particles(weft__pair_kind of)
{
    return of == WEFT__VERTICES ? 2 : of == WEFT__VERTEX_EDGE ? 3 : 4;
}

typedef bool weft__pair_fn(void *ctx, const weft__pair *pair); /* false ends a search */

/* ---- the search ------------------------------------------------------------------ */

/* What nodes own. A node of a grid owns its particle, edges to the right, downwards and
 * from the first of these to the second, and the two triangles beside that diagonal; of
 * a surface a point owns itself, edges and triangles that begin with it. */
typedef struct weft__primitives {
    weft__nodes nodes;
    size_t points;     /* numbers in a plane of a state */
    double spacing[2]; /* [m] of a grid: down, right */
    size_t
        particles; /* of a surface: further points are of bodies, which do not meet */
    bool between;  /* only pairs of a body's point and a particle */
    uint32_t (*edge)[2], (*triangle)[3];
    uint32_t *edge_first, *triangle_first; /* of a point, and their number */
    uint32_t *order; /* the points that are nodes; NULL: in turn */
} weft__primitives;

/* Edges, and triangles, of a node that are taken together: further ones are a further
 * slice, with the point once more. */
enum { WEFT__OWNED = 12 };

/* Cuts a range down to a slice of it; true: there is another slice. */
static inline bool weft__owned_slice(size_t slice, size_t *first, size_t *end)
{
    const size_t all = *end, from = *first + WEFT__OWNED * slice;
    *first = from < all ? from : all;
    *end = *first + WEFT__OWNED < all ? *first + WEFT__OWNED : all;
    return *end < all;
}

/* Bounds of the patches of a level, in planes of rows: boxes have three low and three
 * high ones. Beyond the cloth they are empty. A grid also has the slopes of its edges
 * down and right, by the spacing, and of each patch the square of how far they are from
 * two orthonormal directions, E of self_tree.c; bent[1] and bent[2]: those of 2 x 2 and
 * of 3 x 3 patches from it on. */
typedef struct weft__seek_level {
    size_t rows, cols, stride, plane;
    float *box, *slope, *bent[3];
    float inverse[2]; /* [1/m] of how far apart at rest primitives are without a common
                         point, and those of patches with one between them */
} weft__seek_level;

typedef struct weft__boxes {
    weft__primitives of;
    size_t top;    /* the level of tiles */
    size_t eights; /* for the primitives of a slice */
    weft__seek_level level[WEFT__LEVELS];
    float *room;
} weft__boxes;

/* false: no memory. */
bool weft__boxes_create(const weft__primitives *of, const weft_allocator *memory,
                        weft__boxes *out);
void weft__boxes_free(const weft_allocator *memory, weft__boxes *of);

/* In parts, which may be rows of tiles of a grid, or tiles of a surface. */
static inline size_t weft__boxes_parts(const weft__boxes *of)
{
    const weft__seek_level *top = &of->level[of->top];
    return of->of.nodes.fold == 1 ? top->rows : top->cols;
}

/* Sets the boxes and slopes of a part. */
typedef void weft__fill_fn(weft__boxes *to, const double *y, size_t part);

/* Sets what is bent in a row of tiles of a grid, once the boxes of this row and of the
 * next two have been set. */
typedef void weft__bend_fn(weft__boxes *to, size_t part);

/* Visits each pair of primitives of two tiles that is nearer than range, and some
 * others: each kind by nodes in the order of weft__tree_pairs (self_tree.h). Where
 * patches are nearly flat their inside is passed over. Of a grid, the rows of both
 * tiles and the two after each must have been set, for the state y. range < 1e30 m.
 * Returns false if a visit did. */
typedef bool weft__seek_fn(const weft__boxes *in, const double *y,
                           const uint32_t tiles[2], double range, weft__pair_fn *visit,
                           void *ctx);

/* Those of a level of instructions. */
typedef struct weft__seeker {
    weft__fill_fn *fill;
    weft__bend_fn *bend;
    weft__seek_fn *seek;
} weft__seeker;

/* NULL: there is none. */
const weft__seeker *weft__seeker_of(weft__isa isa);

#define WEFT__SEEKER(level)                                                            \
    weft__fill_fn weft__fill_##level;                                                  \
    weft__bend_fn weft__bend_##level;                                                  \
    weft__seek_fn weft__seek_##level;
WEFT_LEVELS(WEFT__SEEKER)
