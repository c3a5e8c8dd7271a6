/* SPDX-License-Identifier: BSD-3-Clause */
/* self_pairs.c -- pairs of primitives that are near each other, and whether they can
 * have met in a step. */
#include "forces/self/self.h"

void weft__pair_primitives(const weft__pair *pair, weft_primitive out[2])
{
    const size_t all = weft__pair_particles(pair);
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    out[0].count = first, out[1].count = all - first;
    for (size_t k = 0; k < all; ++k) {
        out[k >= first].particle[k >= first ? k - first : k] = pair->particle[k];
    }
}

/* ---- the search ------------------------------------------------------------------ */

/* A primitive in its box. */
typedef struct boxed {
    uint32_t particle[3];
    double box[2][3]; /* [m] low, high */
} boxed;

/* What a node owns. */
typedef struct owned {
    size_t node;
    boxed vertex, edges[3], triangles[2];
    size_t edge_count, triangle_count;
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

/* As weft__edges_of and weft__triangles_of. */
static void find_owned(const weft__quadtree *tree, size_t node, owned *out)
{
    const size_t cols = tree->mesh->cols, n = tree->mesh->particles;
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
    out->node = node;
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
    return of->visit(of->ctx, &pair);
}

/* A vertex with all that another node owns but its particle. */
static bool try_vertex(const pair_search *of, const boxed *vertex, const owned *with)
{
    bool goes_on = true;
    for (size_t k = 0; seeks(of, WEFT__VERTEX_TRIANGLE) && k < with->triangle_count;
         ++k) {
        goes_on
            = goes_on
              && try_pair(of, WEFT__VERTEX_TRIANGLE, vertex, 1, &with->triangles[k], 3);
    }
    for (size_t k = 0; seeks(of, WEFT__VERTEX_EDGE) && k < with->edge_count; ++k) {
        goes_on
            = goes_on && try_pair(of, WEFT__VERTEX_EDGE, vertex, 1, &with->edges[k], 2);
    }
    return goes_on;
}

static bool try_edges(const pair_search *of, const owned *a, const owned *b)
{
    const size_t count = a->edge_count * b->edge_count;
    bool goes_on = true;
    for (size_t k = 0; seeks(of, WEFT__EDGES) && k < count && goes_on; ++k) {
        goes_on = try_pair(of, WEFT__EDGES, &a->edges[k / b->edge_count], 2,
                           &b->edges[k % b->edge_count], 2);
    }
    return goes_on;
}

/* A search comes to four nodes in turns. */
static const owned *owned_by(const pair_search *of, size_t node, owned *last)
{
    if (last->node != node) {
        find_owned(of->tree, node, last);
    }
    return last;
}

/* The edges of one node have common particles. */
static bool visit_nodes(void *ctx, size_t i, size_t j)
{
    pair_search *of = ctx;
    const size_t r = j / of->tree->mesh->cols, c = j - r * of->tree->mesh->cols;
    const owned *a = owned_by(of, i, &of->first);
    const owned *b = owned_by(of, j, &of->others[r % 2][c % 2]);
    if (i == j) {
        return try_vertex(of, &a->vertex, a);
    }
    return try_vertex(of, &a->vertex, b) && try_vertex(of, &b->vertex, a)
           && (!seeks(of, WEFT__VERTICES)
               || try_pair(of, WEFT__VERTICES, &a->vertex, 1, &b->vertex, 1))
           && try_edges(of, a, b);
}

static bool seek(const weft__quadtree *tree, const uint32_t *tiles, double range,
                 unsigned kinds, weft__pair_fn *visit, void *ctx)
{
    const owned none = { .node = SIZE_MAX };
    pair_search of
        = { tree, range, visit, ctx, kinds, none, { { none, none }, { none, none } } };
    return tiles == NULL ? weft__tree_pairs(tree, range, visit_nodes, &of)
                         : weft__tree_between(tree, tiles, range, visit_nodes, &of);
}

bool weft__each_pair(const weft__quadtree *tree, double range, weft__pair_fn *visit,
                     void *ctx)
{
    bool goes_on = true;
    for (unsigned kind = WEFT__VERTICES; kind <= WEFT__EDGES && goes_on; ++kind) {
        goes_on = seek(tree, NULL, range, 1U << kind, visit, ctx);
    }
    return goes_on;
}

bool weft__each_pair_between(const weft__quadtree *tree, const uint32_t tiles[2],
                             double range, weft__pair_fn *visit, void *ctx)
{
    return seek(tree, tiles, range, 0xf, visit, ctx);
}

/* ---- steps ----------------------------------------------------------------------- */

/* [m^2] The square of the longest way of two particles against each other. */
static double difference(const weft__stride *of, size_t a, size_t b)
{
    const size_t n = of->own->mesh->particles;
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
            const double square = difference(of, pair->particle[i], pair->particle[j]);
            most = square > most ? square : most;
        }
    }
    const double path = sqrt(most);
    *gap = weft__pair_distance(pair, of->y1, of->own->mesh->particles);
    return path == 0.0
           || (*gap > 0.0
               && path < weft__pair_distance(pair, of->y0, of->own->mesh->particles)
                             + *gap);
}

void weft__drift_loops(const weft__self *own, const double *from, const double *to,
                       size_t level, size_t first, size_t end, weft__drift *of)
{
    const size_t n = own->mesh->particles;
    for (size_t i = first; i < end; ++i) {
        size_t in[4];
        weft__patch_range(own->mesh, level, i, in);
        for (size_t k = 0; k < 3; ++k) {
            double low = INFINITY, high = -INFINITY, bad = 0.0;
            for (size_t r = in[0]; r < in[1]; ++r) {
                for (size_t c = in[2]; c < in[3]; ++c) {
                    const size_t j = k * n + r * own->mesh->cols + c;
                    const double d = from != NULL ? to[j] - from[j] : to[j];
                    low = d < low ? d : low;
                    high = d > high ? d : high;
                    bad += d * 0.0;
                }
            }
            of[i].low[k] = low;
            of[i].high[k] = bad == 0.0 ? high : (double)INFINITY;
        }
    }
}

double weft__extent(const weft__self *own, const double *from, const double *to)
{
    weft__drift all; /* the one patch of the last level */
    own->drift(own, from, to, WEFT__LEVELS - 1, 0, 1, &all);
    const double extent = weft__drift_extent(&all, &all);
    return isfinite(extent) ? extent : (double)INFINITY;
}
