/* SPDX-License-Identifier: BSD-3-Clause */
/* self_tree.c -- the search of self_tree.h.
 *
 * In a convex patch of the rest grid whose edges down / a and right / b differ from two
 * orthonormal directions by E, in the Frobenius norm, the gradient of the position is
 * [e0 e1] + E: two points of the patch are at least (1 - E) times as far apart as at
 * rest, where primitives without a common particle are a b / sqrt(a^2 + b^2) or more
 * apart. */
#include "cloth/self_tree.h"

#include <string.h>

/* Relative, of the bounds. */
#define ROUNDOFF 1e-9

static size_t count_at(size_t nodes, size_t level)
{
    return ((nodes - 1) >> level) + 1;
}

static size_t levels_of(const weft_cloth *cloth)
{
    size_t levels = 1;
    while (count_at(cloth->rows, levels - 1) > 1
           || count_at(cloth->cols, levels - 1) > 1) {
        ++levels;
    }
    return levels;
}

weft__quadtree weft__tree_of(const weft_cloth *cloth, const double *y)
{
    return (weft__quadtree){ .cloth = cloth, .y = y, .levels = levels_of(cloth) };
}

size_t weft__tree_size(const weft_cloth *cloth)
{
    size_t size = 0;
    for (size_t k = 0; k < levels_of(cloth); ++k) {
        size += count_at(cloth->rows, k) * count_at(cloth->cols, k);
    }
    return size;
}

/* ---- bounds ---------------------------------------------------------------------- */

static const weft__knot nothing
    = { { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } },
        { { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } },
          { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } } } };

static inline void include(double bounds[2][3], const double at[3])
{
    for (size_t k = 0; k < 3; ++k) {
        bounds[0][k] = at[k] < bounds[0][k] ? at[k] : bounds[0][k];
        bounds[1][k] = at[k] > bounds[1][k] ? at[k] : bounds[1][k];
    }
}

static inline void place(const weft__quadtree *tree, size_t r, size_t c, double x[3])
{
    const size_t n = tree->cloth->particles, i = r * tree->cloth->cols + c;
    x[0] = tree->y[i], x[1] = tree->y[n + i], x[2] = tree->y[2 * n + i];
}

static inline void include_slope(const double from[3], const double to[3],
                                 double spacing, double bounds[2][3])
{
    const double slope[3] = { (to[0] - from[0]) / spacing, (to[1] - from[1]) / spacing,
                              (to[2] - from[2]) / spacing };
    include(bounds, slope);
}

/* Adds node (r, c). */
static void add_node(const weft__quadtree *tree, size_t r, size_t c, weft__knot *to)
{
    const weft_cloth *cloth = tree->cloth;
    double x[2][2][3];
    const size_t down = r + 1 < cloth->rows, right = c + 1 < cloth->cols;
    for (size_t i = 0; i <= down; ++i) {
        for (size_t j = 0; j <= right; ++j) {
            place(tree, r + i, c + j, x[i][j]);
            include(to->place, x[i][j]);
        }
    }
    for (size_t j = 0; down == 1 && j <= right; ++j) {
        include_slope(x[0][j], x[1][j], cloth->spacing[0], to->slope[0]);
    }
    for (size_t i = 0; right == 1 && i <= down; ++i) {
        include_slope(x[i][0], x[i][1], cloth->spacing[1], to->slope[1]);
    }
}

static void add_slopes(const weft__knot *from, weft__knot *to)
{
    for (size_t k = 0; k < 2; ++k) {
        include(to->slope[0], from->slope[0][k]);
        include(to->slope[1], from->slope[1][k]);
    }
}

static void add_knot(const weft__knot *from, weft__knot *to)
{
    include(to->place, from->place[0]);
    include(to->place, from->place[1]);
    add_slopes(from, to);
}

static size_t end_of(size_t at, size_t level, size_t count)
{
    const size_t end = (at + 1) << level;
    return end < count ? end : count;
}

typedef struct tree_patch {
    size_t r, c;
} tree_patch;

static void add_patch(const weft__quadtree *tree, size_t level, tree_patch at,
                      weft__knot *to)
{
    const weft_cloth *cloth = tree->cloth;
    for (size_t r = at.r << level; r < end_of(at.r, level, cloth->rows); ++r) {
        for (size_t c = at.c << level; c < end_of(at.c, level, cloth->cols); ++c) {
            add_node(tree, r, c, to);
        }
    }
}

void weft__tree_fill(weft__quadtree *tree, const double *y, weft__knot *knots)
{
    const weft_cloth *cloth = tree->cloth;
    tree->y = y;
    tree->knots = knots;
    for (size_t i = 0; i < cloth->particles; ++i) {
        knots[i] = nothing;
        add_node(tree, i / cloth->cols, i % cloth->cols, &knots[i]);
    }
    for (size_t level = 1; level < tree->levels; ++level) {
        const size_t from = tree->first[level - 1];
        const size_t below[2]
            = { count_at(cloth->rows, level - 1), count_at(cloth->cols, level - 1) };
        const size_t rows = count_at(cloth->rows, level);
        const size_t cols = count_at(cloth->cols, level);
        tree->first[level] = from + below[0] * below[1];
        for (size_t i = 0; i < rows * cols; ++i) {
            weft__knot *to = &knots[tree->first[level] + i];
            *to = nothing;
            for (size_t j = 0; j < 4; ++j) {
                const size_t r = 2 * (i / cols) + j / 2, c = 2 * (i % cols) + j % 2;
                if (r < below[0] && c < below[1]) {
                    add_knot(&knots[from + r * below[1] + c], to);
                }
            }
        }
    }
}

/* ---- the search ------------------------------------------------------------------ */

typedef struct tree_search {
    const weft__quadtree *tree;
    double range;
    double flat; /* a patch with a smaller E is not near itself */
    weft__visit_fn *visit;
    void *ctx;
} tree_search;

/* The square of how far a bound reaches from e. */
static double beyond(const double bounds[2][3], const double e[3])
{
    double square = 0.0;
    for (size_t k = 0; k < 3 && bounds[0][k] <= bounds[1][k]; ++k) {
        const double low = fabs(bounds[0][k] - e[k]), high = fabs(bounds[1][k] - e[k]);
        const double most = low > high ? low : high;
        square += most * most;
    }
    return square;
}

/* A unit vector near the middle of the bounds and across e, if e is not NULL; false:
 * there is none. */
static bool direction(const double bounds[2][3], const double *e, double to[3])
{
    double middle[3];
    for (size_t k = 0; k < 3; ++k) {
        middle[k] = 0.5 * (bounds[0][k] + bounds[1][k]);
    }
    const double along = e != NULL ? weft__dot(middle, e) : 0.0;
    for (size_t k = 0; k < 3; ++k) {
        to[k] = middle[k] - (e != NULL ? along * e[k] : 0.0);
    }
    const double length = weft__length(to);
    for (size_t k = 0; k < 3; ++k) {
        to[k] /= length;
    }
    return length > 0.0;
}

/* A grid of a single row or column has slopes one way only. */
static bool flat(const tree_search *of, const weft__knot *knot)
{
    const bool has[2] = { knot->slope[0][0][0] <= knot->slope[0][1][0],
                          knot->slope[1][0][0] <= knot->slope[1][1][0] };
    double e[2][3], square = 0.0;
    for (size_t k = 0; k < 2; ++k) {
        if (has[k]) {
            const double *across = k == 1 && has[0] ? e[0] : NULL;
            square += direction(knot->slope[k], across, e[k])
                          ? beyond(knot->slope[k], e[k])
                          : (double)INFINITY;
        }
    }
    return of->flat > 0.0 && square < of->flat * of->flat;
}

/* A patch's bounds, made in *room if they are not kept. */
static const weft__knot *knot_of(const weft__quadtree *tree, size_t level,
                                 tree_patch at, weft__knot *room)
{
    if (tree->knots != NULL) {
        const size_t cols = count_at(tree->cloth->cols, level);
        return &tree->knots[tree->first[level] + at.r * cols + at.c];
    }
    *room = nothing;
    add_patch(tree, level, at, room);
    return room;
}

/* Whether the rectangle of patches about both, at most 3 x 3 of them, is flat. */
static bool flat_about(const tree_search *of, size_t level, tree_patch a, tree_patch b)
{
    enum { MOST = 3 };
    const tree_patch low = { a.r < b.r ? a.r : b.r, a.c < b.c ? a.c : b.c };
    const tree_patch high = { a.r < b.r ? b.r : a.r, a.c < b.c ? b.c : a.c };
    if (high.r - low.r >= MOST || high.c - low.c >= MOST
        || (of->tree->knots == NULL && level > 0)) {
        return false;
    }
    weft__knot room, hull = *knot_of(of->tree, level, low, &room);
    for (size_t r = low.r; r <= high.r; ++r) {
        for (size_t c = low.c; c <= high.c; ++c) {
            add_slopes(knot_of(of->tree, level, (tree_patch){ r, c }, &room), &hull);
        }
    }
    return flat(of, &hull);
}

static bool apart(const tree_search *of, size_t level, tree_patch a, tree_patch b)
{
    weft__knot room[2];
    const weft__knot *of_a = knot_of(of->tree, level, a, &room[0]);
    const weft__knot *of_b = knot_of(of->tree, level, b, &room[1]);
    bool far = false;
    for (size_t k = 0; k < 3; ++k) {
        far = far || of_a->place[0][k] - of_b->place[1][k] > of->range
              || of_b->place[0][k] - of_a->place[1][k] > of->range;
    }
    return far;
}

static bool inside(const tree_search *of, size_t level, tree_patch at)
{
    return at.r < count_at(of->tree->cloth->rows, level)
           && at.c < count_at(of->tree->cloth->cols, level);
}

static tree_patch part(tree_patch at, size_t j)
{
    return (tree_patch){ 2 * at.r + j / 2, 2 * at.c + j % 2 };
}

static bool leaf(const tree_search *of, tree_patch a, tree_patch b)
{
    const size_t cols = of->tree->cloth->cols;
    return of->visit(of->ctx, a.r * cols + a.c, b.r * cols + b.c);
}

static bool pairs_between(const tree_search *of, size_t level, tree_patch a,
                          tree_patch b)
{
    if (apart(of, level, a, b) || flat_about(of, level, a, b)) {
        return true;
    }
    if (level == 0) {
        return leaf(of, a, b);
    }
    bool goes_on = true;
    for (size_t j = 0; j < 16 && goes_on; ++j) {
        const tree_patch in_a = part(a, j / 4), in_b = part(b, j % 4);
        goes_on = !inside(of, level - 1, in_a) || !inside(of, level - 1, in_b)
                  || pairs_between(of, level - 1, in_a, in_b);
    }
    return goes_on;
}

static bool pairs_within(const tree_search *of, size_t level, tree_patch at)
{
    weft__knot room;
    if (flat(of, knot_of(of->tree, level, at, &room))) {
        return true;
    }
    if (level == 0) {
        return leaf(of, at, at);
    }
    bool goes_on = true;
    for (size_t j = 0; j < 4 && goes_on; ++j) {
        const tree_patch in = part(at, j);
        goes_on = !inside(of, level - 1, in) || pairs_within(of, level - 1, in);
    }
    for (size_t j = 0; j < 16 && goes_on; ++j) {
        const tree_patch a = part(at, j / 4), b = part(at, j % 4);
        goes_on = j / 4 >= j % 4 || !inside(of, level - 1, a)
                  || !inside(of, level - 1, b) || pairs_between(of, level - 1, a, b);
    }
    return goes_on;
}

bool weft__tree_pairs(const weft__quadtree *tree, double range, weft__visit_fn *visit,
                      void *ctx)
{
    const double a = tree->cloth->spacing[0], b = tree->cloth->spacing[1];
    const double rest = tree->cloth->rows == 1   ? b
                        : tree->cloth->cols == 1 ? a
                                                 : a / sqrt(1.0 + a * a / (b * b));
    const tree_search of = { .tree = tree,
                             .range = range * (1.0 + ROUNDOFF),
                             .flat = 1.0 - range / rest - ROUNDOFF,
                             .visit = visit,
                             .ctx = ctx };
    return pairs_within(&of, tree->levels - 1, (tree_patch){ 0, 0 });
}
