/* SPDX-License-Identifier: BSD-3-Clause */
/* self_pairs.c -- pairs of primitives that are near each other, and whether they can
 * have met in a step. */
#include "forces/contact/self/self.h"
#include "forces/contact/self/self_law.h"

void weft__pair_primitives(const weft__pair *pair, weft_primitive out[2])
{
    const size_t all = weft__pair_particles(pair);
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    out[0].count = first, out[1].count = all - first;
    for (size_t k = 0; k < all; ++k) {
        out[k >= first].particle[k >= first ? k - first : k] = pair->particle[k];
    }
}

double weft__pair_distance(const weft__pair *pair, const double *y, size_t n)
{
    double x[4][3] = { { 0.0 } };
    for (size_t j = 0; j < 3 * weft__pair_particles(pair); ++j) {
        x[j / 3][j % 3] = y[j % 3 * n + pair->particle[j / 3]];
    }
    return law_distance((weft__pair_kind)pair->kind, x);
}

/* ---- the search ------------------------------------------------------------------ */

/* A primitive in its box. */
typedef struct boxed {
    uint32_t particle[3], item;
    double box[2][3]; /* [m] low, high */
} boxed;

/* What a node owns, or of many edges and triangles some. */
typedef struct owned {
    size_t node, slice;
    boxed vertex, edges[WEFT__OWNED], triangles[WEFT__OWNED];
    size_t edge_count, triangle_count;
    bool more; /* in the next slice */
} owned;

/* The box of particles i and j, which are at a and b; and one more. */
static inline void make_box(uint32_t i, uint32_t j, const double a[3],
                            const double b[3], boxed *to)
{
    to->particle[0] = i, to->particle[1] = j;
    for (size_t k = 0; k < 3; ++k) {
        to->box[0][k] = a[k] < b[k] ? a[k] : b[k];
        to->box[1][k] = a[k] < b[k] ? b[k] : a[k];
    }
}

static inline void add_particle(uint32_t i, const double a[3], boxed *to)
{
    to->particle[2] = i;
    for (size_t k = 0; k < 3; ++k) {
        to->box[0][k] = to->box[0][k] < a[k] ? to->box[0][k] : a[k];
        to->box[1][k] = to->box[1][k] > a[k] ? to->box[1][k] : a[k];
    }
}

static void self_pairs_box_of(const weft__quadtree *tree, const uint32_t *points,
                              size_t count, size_t item, boxed *to)
{
    const size_t n = tree->own->points;
    double x[3][3] = { { 0.0 } };
    for (size_t j = 0; j < 3 * count; ++j) {
        x[j / 3][j % 3] = tree->y[j % 3 * n + points[j / 3]];
    }
    to->item = (uint32_t)item;
    make_box(points[0], points[count > 1], x[0], x[count > 1], to);
    if (count > 2) {
        add_particle(points[2], x[2], to);
    }
}

static void find_owned_of_surface(const weft__quadtree *tree, size_t node, size_t slice,
                                  owned *out)
{
    const weft__contact_surface *surface = tree->own->surface;
    const uint32_t point = (uint32_t)node;
    size_t e = surface->edge_first[node], t = surface->triangle_first[node];
    size_t edges = surface->edge_first[node + 1],
           triangles = surface->triangle_first[node + 1];
    out->more = weft__owned_slice(slice, &e, &edges);
    out->more = weft__owned_slice(slice, &t, &triangles) || out->more;
    out->edge_count = edges - e, out->triangle_count = triangles - t;
    self_pairs_box_of(tree, &point, 1, node, &out->vertex);
    for (size_t k = 0; k < out->edge_count; ++k) {
        self_pairs_box_of(tree, surface->edge[e + k], 2, e + k, &out->edges[k]);
    }
    for (size_t k = 0; k < out->triangle_count; ++k) {
        self_pairs_box_of(tree, surface->triangle[t + k], 3, t + k, &out->triangles[k]);
    }
}

/* As weft__edges_of and weft__triangles_of. */
static void find_owned(const weft__quadtree *tree, size_t node, owned *out)
{
    const size_t cols = tree->own->mesh->cols, n = tree->own->mesh->particles;
    const bool right = node % cols + 1 < cols, down = node + cols < n;
    const uint32_t i[4] = { (uint32_t)node, (uint32_t)(right ? node + 1 : node),
                            (uint32_t)(down ? node + cols : node),
                            (uint32_t)(right && down ? node + cols + 1 : node) };
    double x[4][3];
    for (size_t k = 0; k < 3; ++k) {
        for (size_t j = 0; j < 4; ++j) {
            x[j][k] = tree->y[k * n + i[j]];
        }
    }
    out->edge_count = out->triangle_count = 0;
    make_box(i[0], i[0], x[0], x[0], &out->vertex);
    if (right) {
        make_box(i[0], i[1], x[0], x[1], &out->edges[out->edge_count++]);
    }
    if (down) {
        make_box(i[0], i[2], x[0], x[2], &out->edges[out->edge_count++]);
    }
    if (right && down) {
        boxed *edge = &out->edges[out->edge_count++];
        make_box(i[1], i[2], x[1], x[2], edge);
        make_box(i[0], i[2], x[0], x[2], &out->triangles[0]);
        add_particle(i[1], x[1], &out->triangles[0]);
        make_box(i[3], i[1], x[3], x[1], &out->triangles[1]);
        add_particle(i[2], x[2], &out->triangles[1]);
        out->triangle_count = 2;
    }
}

typedef struct pair_search {
    const weft__quadtree *tree;
    double range;
    weft__pair_fn *visit;
    void *ctx;
    unsigned kinds;            /* bits */
    owned first, others[2][2]; /* of the last visits; by rows and columns even or odd */
} pair_search;

static bool seeks(const pair_search *of, weft__pair_kind kind)
{
    return (of->kinds >> kind & 1U) != 0;
}

/* Those of a grid among several cloths, if both are of it (contact_surface.h). */
static void take_windows(const weft__self *own, weft__pair *pair)
{
    const weft__part *grid = weft__pair_grid(own, pair);
    const uint32_t edges = (uint32_t)own->surface->edges;
    if (grid != NULL && pair->kind == WEFT__VERTEX_TRIANGLE) {
        pair->item[1] = (uint32_t)(3 * own->surface->triangles)
                        + (uint32_t)(grid - own->mesh->triangles->parts);
    } else if (grid != NULL) {
        pair->item[0] += pair->kind == WEFT__EDGES ? edges : 0;
        pair->item[1] += pair->kind != WEFT__VERTICES ? edges : 0;
    }
}

bool weft__pair_admit(const weft__self *own, weft__pair *pair)
{
    const weft__contact_surface *surface = own->surface;
    uint64_t key[2];
    if (surface != NULL && surface->grids) {
        take_windows(own, pair);
    }
    if (surface == NULL || surface->slit_pair_count == 0) {
        return true;
    }
    weft__pair_key(pair, key);
    return !weft__is_slit_pair(surface, key);
}

/* Visits a pair unless its boxes are further apart than the range or its primitives
 * have a common particle; `first` and `other`: of their particles. */
static inline bool try_pair(const pair_search *of, weft__pair_kind kind, const boxed *a,
                            size_t first, const boxed *b, size_t other)
{
    weft__pair pair = { .kind = kind };
    if (weft__boxes_apart(a->box, b->box, of->range)) {
        return true;
    }
    for (size_t i = 0; i < first; ++i) {
        for (size_t j = 0; j < other; ++j) {
            if (a->particle[i] == b->particle[j]) {
                return true;
            }
            pair.particle[i] = a->particle[i];
            pair.particle[first + j] = b->particle[j];
        }
    }
    pair.item[0] = a->item, pair.item[1] = b->item;
    return !weft__pair_admit(of->tree->own, &pair) || of->visit(of->ctx, &pair);
}

/* A vertex with all that another node owns but its particle. */
static bool try_vertex(const pair_search *of, const boxed *vertex, const owned *with)
{
    bool continues = true;
    for (size_t k = 0; seeks(of, WEFT__VERTEX_TRIANGLE) && k < with->triangle_count;
         ++k) {
        continues
            = continues
              && try_pair(of, WEFT__VERTEX_TRIANGLE, vertex, 1, &with->triangles[k], 3);
    }
    for (size_t k = 0; seeks(of, WEFT__VERTEX_EDGE) && k < with->edge_count; ++k) {
        continues = continues
                    && try_pair(of, WEFT__VERTEX_EDGE, vertex, 1, &with->edges[k], 2);
    }
    return continues;
}

static bool try_edges(const pair_search *of, const owned *a, const owned *b)
{
    const size_t count = a->edge_count * b->edge_count;
    bool continues = true;
    for (size_t k = 0; seeks(of, WEFT__EDGES) && k < count && continues; ++k) {
        continues = try_pair(of, WEFT__EDGES, &a->edges[k / b->edge_count], 2,
                             &b->edges[k % b->edge_count], 2);
    }
    return continues;
}

/* A search comes to four nodes in turns. */
static const owned *owned_by(const pair_search *of, size_t node, size_t slice,
                             owned *last)
{
    if (last->node != node || last->slice != slice) {
        last->node = node, last->slice = slice;
        if (of->tree->own->surface != NULL) {
            find_owned_of_surface(of->tree, node, slice, last);
        } else {
            find_owned(of->tree, node, last);
        }
    }
    return last;
}

/* Slice by slice; all edges of one node have it in common, and all that a point owns.
 */
static bool self_pairs_visit_nodes(void *ctx, size_t i, size_t j)
{
    pair_search *of = ctx;
    const bool points = of->tree->own->surface != NULL;
    const size_t row = points ? j / 2 : j / of->tree->own->mesh->cols;
    const size_t col = points ? j : j - row * of->tree->own->mesh->cols;
    const owned *a = owned_by(of, i, 0, &of->first), *b = NULL;
    bool continues = i != j || points || try_vertex(of, &a->vertex, a);
    for (size_t k = 0; i != j && continues && (k == 0 || a->more); ++k) {
        a = owned_by(of, i, k, &of->first);
        for (size_t l = 0; continues && (l == 0 || b->more); ++l) {
            b = owned_by(of, j, l, &of->others[row % 2][col % 2]);
            continues
                = (k > 0 || try_vertex(of, &a->vertex, b))
                  && (l > 0 || try_vertex(of, &b->vertex, a))
                  && (k + l > 0 || !seeks(of, WEFT__VERTICES)
                      || try_pair(of, WEFT__VERTICES, &a->vertex, 1, &b->vertex, 1))
                  && try_edges(of, a, b);
        }
    }
    return continues;
}

static bool self_pairs_seek(const weft__quadtree *tree, const uint32_t *tiles,
                            double range, unsigned kinds, weft__pair_fn *visit,
                            void *ctx)
{
    const owned none = { .node = SIZE_MAX };
    pair_search of
        = { tree, range, visit, ctx, kinds, none, { { none, none }, { none, none } } };
    return tiles == NULL
               ? weft__tree_pairs(tree, range, self_pairs_visit_nodes, &of)
               : weft__tree_between(tree, tiles, range, self_pairs_visit_nodes, &of);
}

bool weft__each_pair(const weft__quadtree *tree, double range, weft__pair_fn *visit,
                     void *ctx)
{
    bool continues = true;
    for (unsigned kind = WEFT__VERTICES; kind <= WEFT__EDGES && continues; ++kind) {
        continues = self_pairs_seek(tree, NULL, range, 1U << kind, visit, ctx);
    }
    return continues;
}

bool weft__each_pair_between(const weft__quadtree *tree, const uint32_t tiles[2],
                             double range, weft__pair_fn *visit, void *ctx)
{
    return self_pairs_seek(tree, tiles, range, 0xf, visit, ctx);
}

/* ---- steps ----------------------------------------------------------------------- */

/* [m^2] The square of the longest way of two particles against each other. */
static double self_pairs_difference(const weft__stride *of, size_t a, size_t b)
{
    const size_t n = of->own->points;
    double squares[3] = { 0.0, 0.0, 0.0 };
    for (size_t i = a, j = b; i < 3 * n; i += n, j += n) {
        const double d = (of->y1[i] - of->y0[i]) - (of->y1[j] - of->y0[j]);
        const double v0 = of->h * (of->y0[3 * n + i] - of->y0[3 * n + j]);
        const double v1 = of->h * (of->y1[3 * n + i] - of->y1[3 * n + j]);
        squares[0] += d * d, squares[1] += v0 * v0, squares[2] += v1 * v1;
    }
    const double most = squares[0] > squares[1] ? squares[0] : squares[1];
    return squares[2] > most ? squares[2] : most;
}

bool weft__stride_clear(const weft__stride *of, const weft__pair *pair, double *gap)
{
    if (pair->kind < WEFT__VERTEX_TRIANGLE) {
        return true;
    }
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    double most = 0.0;
    for (size_t i = 0; i < first; ++i) {
        for (size_t j = first; j < 4; ++j) {
            const double square
                = self_pairs_difference(of, pair->particle[i], pair->particle[j]);
            most = square > most ? square : most;
        }
    }
    const double path = sqrt(most);
    *gap = weft__pair_distance(pair, of->y1, of->own->points);
    return path == 0.0
           || (*gap > 0.0
               && path < weft__pair_distance(pair, of->y0, of->own->points) + *gap);
}

/* Of one plane; bad: 0 or NaN. */
typedef struct plane_bounds {
    double low, high, bad;
} plane_bounds;
static const plane_bounds unbounded = { INFINITY, -INFINITY, 0.0 };

static inline void add_drift(const double *from, const double *to, size_t j,
                             plane_bounds *of)
{
    const double d = from != NULL ? to[j] - from[j] : to[j];
    of->low = d < of->low ? d : of->low;
    of->high = d > of->high ? d : of->high;
    of->bad += d * 0.0;
}

static inline void set_drift(const plane_bounds *of, size_t k, weft__drift *to)
{
    to->low[k] = of->low;
    to->high[k] = of->bad == 0.0 ? of->high : (double)INFINITY;
}

void weft__range_loops(const weft__range *range, weft__drift *of)
{
    const double *from = range->from, *to = range->to;
    const size_t run = range->run[1] - range->run[0];
    for (size_t k = 0; k < 3; ++k, to += range->to_plane) {
        plane_bounds sum = unbounded;
        for (size_t i = 0; i < run + range->count; ++i) {
            add_drift(from, to,
                      i < run ? range->run[0] + i : (size_t)range->more[i - run], &sum);
        }
        set_drift(&sum, k, of);
        from = from != NULL ? from + range->from_plane : NULL;
    }
}

void weft__drift_loops(const weft__self *own, const double *from, const double *to,
                       size_t level, size_t first, size_t end, weft__drift *of)
{
    const size_t n = own->points;
    for (size_t i = first; i < end; ++i) {
        size_t in[4];
        weft__patch_range(own->mesh, level, i, in);
        for (size_t k = 0; k < 3; ++k) {
            plane_bounds sum = unbounded;
            for (size_t r = in[0]; r < in[1]; ++r) {
                for (size_t c = in[2]; c < in[3]; ++c) {
                    add_drift(from, to, k * n + r * own->mesh->cols + c, &sum);
                }
            }
            set_drift(&sum, k, &of[i]);
        }
    }
}

double weft__extent(const weft__self *own, const double *from, const double *to)
{
    const size_t n = own->points;
    const weft__range range = { from, to, n, n, { 0, n }, NULL, 0 };
    weft__drift all;
    if (own->surface != NULL) {
        own->range(&range, &all);
    } else { /* the one patch of the last level */
        own->drift(own, from, to, WEFT__LEVELS - 1, 0, 1, &all);
    }
    const double extent = weft__drift_extent(&all, &all);
    return isfinite(extent) ? extent : (double)INFINITY;
}
