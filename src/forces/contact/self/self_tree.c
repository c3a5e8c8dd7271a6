/* SPDX-License-Identifier: BSD-3-Clause */
/* self_tree.c -- the search of self_tree.h. A patch whose edges differ from two
 * orthonormal directions by E < 1, in the Frobenius norm, has points (1 - E) times as
 * far apart as at rest or more (docs/theory/contact.md), where primitives without a
 * common particle are a b / sqrt(a^2 + b^2) or more apart. */
#include "forces/contact/self/self.h"

#include <string.h>

/* Relative, of the bounds. */
#define ROUNDOFF 1e-9
/* A direction across another is so much of what it was taken from, squared: below that
 * it may be roundoff, and not across. */
#define ACROSS 1e-8

typedef struct tree_patch {
    size_t r, c;
} tree_patch;

weft__nodes weft__nodes_of(const weft__self *own)
{
    return own->surface != NULL ? (weft__nodes){ 1, own->points, 2 }
                                : (weft__nodes){ own->mesh->rows, own->mesh->cols, 1 };
}

weft__quadtree weft__tree_of(const weft__self *own, const double *y)
{
    weft__quadtree tree = { .own = own, .nodes = weft__nodes_of(own), .y = y };
    do {
        ++tree.levels;
    } while (weft__patch_count(&tree.nodes, tree.levels - 1) > 1);
    return tree;
}

size_t weft__tree_size(const weft__quadtree *tree)
{
    size_t size = 0;
    for (size_t k = 0; k < tree->levels; ++k) {
        size += weft__patch_count(&tree->nodes, k);
    }
    return size;
}

size_t weft__tile_count(const weft__self *own)
{
    const weft__nodes nodes = weft__nodes_of(own);
    return weft__patch_count(&nodes, weft__tile_level(nodes));
}

/* ---- bounds ---------------------------------------------------------------------- */

#define NOTHING                                                                        \
    {                                                                                  \
        { INFINITY, INFINITY, INFINITY },                                              \
        {                                                                              \
            -INFINITY, -INFINITY, -INFINITY                                            \
        }                                                                              \
    }
static const weft__knot nothing = { NOTHING, { NOTHING, NOTHING } };

static inline void self_tree_join(const double from[2][3], double to[2][3])
{
    for (size_t k = 0; k < 3; ++k) {
        to[0][k] = from[0][k] < to[0][k] ? from[0][k] : to[0][k];
        to[1][k] = from[1][k] > to[1][k] ? from[1][k] : to[1][k];
    }
}

/* Of the differences by * (b - a), (d - c). */
static inline void bound_slopes(const double a[3], const double b[3], const double c[3],
                                const double d[3], double by, double to[2][3])
{
    for (size_t k = 0; k < 3; ++k) {
        const double one = by * (b[k] - a[k]), other = by * (d[k] - c[k]);
        to[0][k] = one < other ? one : other;
        to[1][k] = one < other ? other : one;
    }
}

/* Of a surface: what it owns has one point, or ends of its edges. */
static void bound_point(const weft__quadtree *tree, size_t node, weft__knot *to)
{
    const weft__contact_surface *surface = tree->own->surface;
    const size_t i = weft__contact_surface_point(surface, node);
    const uint32_t *ends = surface->edge[surface->edge_first[i]];
    const size_t count = 2 * (surface->edge_first[i + 1] - surface->edge_first[i]);
    *to = nothing;
    for (size_t k = 0; k < 3; ++k) {
        const double *y = tree->y + k * surface->points;
        double low = y[i], high = low;
        for (size_t j = 1; j < count; j += 2) {
            const double x = y[ends[j]];
            low = x < low ? x : low, high = x > high ? x : high;
        }
        to->place[0][k] = low, to->place[1][k] = high;
    }
}

/* Sets *to for node (r, c), which is its own neighbour where the grid ends. */
static void bound_node(const weft__quadtree *tree, size_t r, size_t c, weft__knot *to)
{
    const weft__mesh *mesh = tree->own->mesh;
    const bool down = r + 1 < mesh->rows, right = c + 1 < mesh->cols;
    const double *y = tree->y + r * mesh->cols + c;
    const size_t i[4]
        = { 0, right, down ? mesh->cols : 0, right + (down ? mesh->cols : 0) };
    double x[4][3];
    *to = nothing;
    for (size_t k = 0; k < 3; ++k, y += mesh->particles) {
        const double a = x[0][k] = y[i[0]], b = x[1][k] = y[i[1]];
        const double p = x[2][k] = y[i[2]], q = x[3][k] = y[i[3]];
        const double low[2] = { a < b ? a : b, p < q ? p : q };
        const double high[2] = { a < b ? b : a, p < q ? q : p };
        to->place[0][k] = low[0] < low[1] ? low[0] : low[1];
        to->place[1][k] = high[0] > high[1] ? high[0] : high[1];
    }
    if (down) {
        bound_slopes(x[0], x[2], x[1], x[3], 1.0 / mesh->spacing[0], to->slope[0]);
    }
    if (right) {
        bound_slopes(x[0], x[1], x[2], x[3], 1.0 / mesh->spacing[1], to->slope[1]);
    }
}

static void self_tree_add_slopes(const weft__knot *from, weft__knot *to)
{
    self_tree_join(from->slope[0], to->slope[0]);
    self_tree_join(from->slope[1], to->slope[1]);
}

static inline void add_knot(const weft__quadtree *tree, const weft__knot *from,
                            weft__knot *to)
{
    self_tree_join(from->place, to->place);
    if (tree->nodes.fold == 1) {
        self_tree_add_slopes(from, to);
    }
}

static inline void self_tree_bound(const weft__quadtree *tree, size_t r, size_t c,
                                   weft__knot *to)
{
    if (tree->nodes.fold == 1) {
        bound_node(tree, r, c, to);
    } else {
        bound_point(tree, c, to);
    }
}

static size_t end_of(size_t at, size_t level, size_t count)
{
    const size_t end = (at + 1) << level;
    return end < count ? end : count;
}

static void add_patch(const weft__quadtree *tree, size_t level, tree_patch at,
                      weft__knot *to)
{
    const weft__nodes *of = &tree->nodes;
    const size_t shift = of->fold * level;
    for (size_t r = at.r << level; r < end_of(at.r, level, of->rows); ++r) {
        for (size_t c = at.c << shift; c < end_of(at.c, shift, of->cols); ++c) {
            weft__knot node;
            self_tree_bound(tree, r, c, &node);
            add_knot(tree, &node, to);
        }
    }
}

void weft__tree_begin(weft__quadtree *tree, weft__knot *knots)
{
    tree->knots = knots;
    for (size_t level = 1; level < tree->levels; ++level) {
        tree->first[level]
            = tree->first[level - 1] + weft__patch_count(&tree->nodes, level - 1);
    }
}

/* Quarter j of a patch. */
static inline tree_patch part(const weft__nodes *of, tree_patch at, size_t j)
{
    return of->fold == 1 ? (tree_patch){ 2 * at.r + j / 2, 2 * at.c + j % 2 }
                         : (tree_patch){ at.r, 4 * at.c + j };
}

/* From the level below. */
static void fill_knot(weft__quadtree *tree, size_t level, tree_patch at)
{
    const weft__nodes *of = &tree->nodes;
    weft__knot *to = &tree->knots[tree->first[level]
                                  + at.r * weft__patches_across(of, level) + at.c];
    if (level == 0) {
        self_tree_bound(tree, at.r, at.c, to);
        return;
    }
    *to = nothing;
    const size_t rows = weft__patches(of->rows, level - 1);
    const size_t cols = weft__patches_across(of, level - 1);
    for (size_t j = 0; j < 4; ++j) {
        const tree_patch in = part(of, at, j);
        if (in.r < rows && in.c < cols) {
            add_knot(tree, &tree->knots[tree->first[level - 1] + in.r * cols + in.c],
                     to);
        }
    }
}

/* All that is in a patch, level by level. */
static void fill_patch(weft__quadtree *tree, size_t top, tree_patch at)
{
    const weft__nodes *of = &tree->nodes;
    for (size_t level = 0; level <= top; ++level) {
        const size_t rows = weft__patches(of->rows, level),
                     cols = weft__patches_across(of, level);
        const size_t by = top - level, shift = of->fold * by;
        for (size_t r = at.r << by; r < end_of(at.r, by, rows); ++r) {
            for (size_t c = at.c << shift; c < end_of(at.c, shift, cols); ++c) {
                fill_knot(tree, level, (tree_patch){ r, c });
            }
        }
    }
}

void weft__tree_fill(weft__quadtree *tree, weft__knot *knots)
{
    weft__tree_begin(tree, knots);
    fill_patch(tree, tree->levels - 1, (tree_patch){ 0, 0 });
}

static tree_patch patch_of(const weft__quadtree *tree, size_t level, size_t i)
{
    const size_t cols = weft__patches_across(&tree->nodes, level);
    return (tree_patch){ i / cols, i % cols };
}

/* A small cloth has fewer levels than its tiles. */
static size_t tile_level(const weft__quadtree *tree)
{
    const size_t level = weft__tile_level(tree->nodes);
    return level < tree->levels ? level : tree->levels - 1;
}

void weft__tree_fill_tile(weft__quadtree *tree, size_t tile)
{
    const size_t level = tile_level(tree);
    fill_patch(tree, level, patch_of(tree, level, tile));
}

/* ---- the search ------------------------------------------------------------------ */

typedef struct tree_search {
    const weft__quadtree *tree;
    double range;
    double flat;  /* a patch with a smaller E is not near itself */
    size_t floor; /* the level whose patches are visited */
    bool all;     /* without bounds */
    weft__visit_fn *visit;
    void *ctx;
} tree_search;

/* The square of how far a bound reaches from e. */
static double self_tree_beyond(const double bounds[2][3], const double e[3])
{
    double square = 0.0;
    for (size_t k = 0; k < 3 && bounds[0][k] <= bounds[1][k]; ++k) {
        const double low = fabs(bounds[0][k] - e[k]), high = fabs(bounds[1][k] - e[k]);
        const double most = low > high ? low : high;
        square += most * most;
    }
    return square;
}

/* The square of half the width of bounds: no vector is nearer to all of them. */
static inline double self_tree_spread(const double bounds[2][3])
{
    double square = 0.0;
    for (size_t k = 0; k < 3 && bounds[0][k] <= bounds[1][k]; ++k) {
        const double half = 0.5 * (bounds[1][k] - bounds[0][k]);
        square += half * half;
    }
    return square;
}

/* A unit vector near the middle of the bounds and across e, if e is not NULL; false:
 * there is none, or roundoff hides it. */
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
    const double length = weft__length(to), inverse = 1.0 / length;
    for (size_t k = 0; k < 3; ++k) {
        to[k] *= inverse;
    }
    return length > 0.0 && length * length > ACROSS * weft__dot(middle, middle);
}

static inline bool may_be_flat(const tree_search *of, const weft__knot *knot)
{
    return of->flat > 0.0
           && self_tree_spread(knot->slope[0]) + self_tree_spread(knot->slope[1])
                  < of->flat * of->flat;
}

/* A grid of a single row or column has slopes one way only. */
static bool flat(const tree_search *of, const weft__knot *knot)
{
    const bool has[2] = { knot->slope[0][0][0] <= knot->slope[0][1][0],
                          knot->slope[1][0][0] <= knot->slope[1][1][0] };
    double e[2][3], square = 0.0;
    if (!may_be_flat(of, knot)) {
        return false;
    }
    for (size_t k = 0; k < 2; ++k) {
        if (has[k]) {
            const double *across = k == 1 && has[0] ? e[0] : NULL;
            square += direction(knot->slope[k], across, e[k])
                          ? self_tree_beyond(knot->slope[k], e[k])
                          : (double)INFINITY;
        }
    }
    return square < of->flat * of->flat;
}

/* A patch's bounds, made in *room if they are not kept. */
static const weft__knot *knot_of(const weft__quadtree *tree, size_t level,
                                 tree_patch at, weft__knot *room)
{
    if (tree->knots != NULL) {
        const size_t cols = weft__patches_across(&tree->nodes, level);
        return &tree->knots[tree->first[level] + at.r * cols + at.c];
    }
    *room = nothing;
    add_patch(tree, level, at, room);
    return room;
}

/* Whether the rectangle of patches about both, at most 3 x 3 of them, is flat. */
static bool self_tree_flat_about(const tree_search *of, size_t level, tree_patch a,
                                 tree_patch b)
{
    enum { MOST = 3 };
    const tree_patch low = { a.r < b.r ? a.r : b.r, a.c < b.c ? a.c : b.c };
    const tree_patch high = { a.r < b.r ? b.r : a.r, a.c < b.c ? b.c : a.c };
    if (!(of->flat > 0.0) || high.r - low.r >= MOST || high.c - low.c >= MOST
        || (of->tree->knots == NULL && level > 0)) {
        return false;
    }
    weft__knot room, hull = *knot_of(of->tree, level, a, &room);
    self_tree_add_slopes(knot_of(of->tree, level, b, &room), &hull);
    if (!may_be_flat(of, &hull)) {
        return false;
    }
    for (size_t r = low.r; r <= high.r; ++r) {
        for (size_t c = low.c; c <= high.c; ++c) {
            self_tree_add_slopes(knot_of(of->tree, level, (tree_patch){ r, c }, &room),
                                 &hull);
        }
    }
    return flat(of, &hull);
}

static inline bool self_tree_apart(const tree_search *of, const weft__knot *a,
                                   const weft__knot *b)
{
    return weft__boxes_apart(a->place, b->place, of->range);
}

/* The quarters of a patch that the cloth has, and their bounds. */
typedef struct quarters {
    size_t count;
    tree_patch at[4];
    const weft__knot *knots[4];
    weft__knot room[4];
} quarters;

static void find_quarters(const tree_search *of, size_t level, tree_patch at,
                          quarters *out)
{
    const weft__nodes *nodes = &of->tree->nodes;
    const size_t rows = weft__patches(nodes->rows, level),
                 cols = weft__patches_across(nodes, level);
    out->count = 0;
    for (size_t j = 0; j < 4; ++j) {
        const tree_patch in = part(nodes, at, j);
        if (in.r < rows && in.c < cols) {
            const size_t i = out->count++;
            out->at[i] = in;
            out->knots[i]
                = of->all ? NULL : knot_of(of->tree, level, in, &out->room[i]);
        }
    }
}

static bool leaf(const tree_search *of, tree_patch a, tree_patch b)
{
    const size_t cols = weft__patches_across(&of->tree->nodes, of->floor);
    const weft__contact_surface *surface = of->tree->own->surface;
    if (of->floor == 0 && surface != NULL) {
        return of->visit(of->ctx, weft__contact_surface_point(surface, a.c),
                         weft__contact_surface_point(surface, b.c));
    }
    return of->visit(of->ctx, a.r * cols + a.c, b.r * cols + b.c);
}

/* Whether all nodes of a patch are points of bodies. */
static inline bool of_bodies(const tree_search *of, size_t level, tree_patch at)
{
    const weft__nodes *nodes = &of->tree->nodes;
    return nodes->fold > 1 && at.c << 2 * level >= of->tree->own->mesh->particles;
}

static inline bool of_cloth(const tree_search *of, size_t level, tree_patch at)
{
    return of->tree->own->between
           && (at.c + 1) << 2 * level <= of->tree->own->mesh->particles;
}

/* Of patches that are not apart. */
static bool pairs_between(const tree_search *of, size_t level, tree_patch a,
                          tree_patch b)
{
    if ((!of->all && self_tree_flat_about(of, level, a, b))
        || (of_bodies(of, level, a) && of_bodies(of, level, b))
        || (of_cloth(of, level, a) && of_cloth(of, level, b))) {
        return true;
    }
    if (level == of->floor) {
        return leaf(of, a, b);
    }
    quarters in[2];
    bool continues = true;
    find_quarters(of, level - 1, a, &in[0]);
    find_quarters(of, level - 1, b, &in[1]);
    for (size_t i = 0; i < in[0].count; ++i) {
        for (size_t j = 0; j < in[1].count && continues; ++j) {
            continues
                = (!of->all && self_tree_apart(of, in[0].knots[i], in[1].knots[j]))
                  || pairs_between(of, level - 1, in[0].at[i], in[1].at[j]);
        }
    }
    return continues;
}

static bool pairs_within(const tree_search *of, size_t level, tree_patch at)
{
    weft__knot room;
    if ((!of->all && flat(of, knot_of(of->tree, level, at, &room)))
        || of_bodies(of, level, at) || of_cloth(of, level, at)) {
        return true;
    }
    if (level == of->floor) {
        return leaf(of, at, at);
    }
    quarters in;
    bool continues = true;
    find_quarters(of, level - 1, at, &in);
    for (size_t i = 0; i < in.count && continues; ++i) {
        continues = pairs_within(of, level - 1, in.at[i]);
    }
    for (size_t i = 0; i < in.count; ++i) {
        for (size_t j = i + 1; j < in.count && continues; ++j) {
            continues = (!of->all && self_tree_apart(of, in.knots[i], in.knots[j]))
                        || pairs_between(of, level - 1, in.at[i], in.at[j]);
        }
    }
    return continues;
}

static tree_search search_of(const weft__quadtree *tree, double range,
                             weft__visit_fn *visit, void *ctx)
{
    const weft__mesh *mesh = tree->own->mesh;
    const double a = mesh->spacing[0], b = mesh->spacing[1];
    const double rest = mesh->rows == 1   ? b
                        : mesh->cols == 1 ? a
                                          : a / sqrt(1.0 + a * a / (b * b));
    return (tree_search){ .tree = tree,
                          .range = range * (1.0 + ROUNDOFF),
                          .flat
                          = tree->nodes.fold > 1 ? 0.0 : 1.0 - range / rest - ROUNDOFF,
                          .visit = visit,
                          .ctx = ctx };
}

bool weft__tree_pairs(const weft__quadtree *tree, double range, weft__visit_fn *visit,
                      void *ctx)
{
    const tree_search of = search_of(tree, range, visit, ctx);
    return pairs_within(&of, tree->levels - 1, (tree_patch){ 0, 0 });
}

bool weft__tile_pairs(const weft__self *own, weft__visit_fn *visit, void *ctx)
{
    const weft__quadtree tree = weft__tree_of(own, NULL);
    tree_search of = search_of(&tree, 0.0, visit, ctx);
    of.all = true;
    of.floor = tile_level(&tree);
    return pairs_within(&of, tree.levels - 1, (tree_patch){ 0, 0 });
}

bool weft__tree_between(const weft__quadtree *tree, const uint32_t tiles[2],
                        double range, weft__visit_fn *visit, void *ctx)
{
    const tree_search of = search_of(tree, range, visit, ctx);
    const size_t level = tile_level(tree);
    const tree_patch a = patch_of(tree, level, tiles[0]);
    const tree_patch b = patch_of(tree, level, tiles[1]);
    weft__knot room[2];
    return tiles[0] == tiles[1]
               ? pairs_within(&of, level, a)
               : self_tree_apart(&of, knot_of(tree, level, a, &room[0]),
                                 knot_of(tree, level, b, &room[1]))
                     || pairs_between(&of, level, a, b);
}
