/* SPDX-License-Identifier: BSD-3-Clause */
/* self_pairs.c -- pairs of primitives that are near each other, and whether they can
 * have met in a step. */
#include "cloth/levels.h"
#include "cloth/self.h"

void weft__pair_primitives(const weft__pair *pair, weft_primitive out[2])
{
    const size_t all = weft__pair_particles(pair);
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    out[0].count = first, out[1].count = all - first;
    for (size_t k = 0; k < all; ++k) {
        out[k >= first].particle[k >= first ? k - first : k] = pair->particle[k];
    }
}

/* ---- distances ------------------------------------------------------------------- */

static inline void place(const double *y, size_t n, size_t i, double x[3])
{
    x[0] = y[i], x[1] = y[n + i], x[2] = y[2 * n + i];
}

static inline void from_to(const double a[3], const double b[3], double d[3])
{
    d[0] = b[0] - a[0], d[1] = b[1] - a[1], d[2] = b[2] - a[2];
}

static inline double clamped(double s)
{
    return s > 0.0 ? s < 1.0 ? s : 1.0 : 0.0;
}

static double square_of(const double a[3], const double b[3])
{
    double d[3];
    from_to(a, b, d);
    return weft__dot(d, d);
}

/* The square of the distance of p from a-b. */
static double edge_square(const double p[3], const double a[3], const double b[3])
{
    double e[3], ap[3];
    from_to(a, b, e);
    from_to(a, p, ap);
    const double length2 = weft__dot(e, e);
    const double s = length2 > 0.0 ? clamped(weft__dot(e, ap) / length2) : 0.0;
    for (size_t k = 0; k < 3; ++k) {
        ap[k] -= s * e[k];
    }
    return weft__dot(ap, ap);
}

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* Inside by the foot, else one of the edges is nearest. */
static double triangle_square(double x[4][3])
{
    double e[3], f[3], ap[3];
    from_to(x[1], x[2], e);
    from_to(x[1], x[3], f);
    from_to(x[1], x[0], ap);
    const double ee = weft__dot(e, e), ff = weft__dot(f, f), ef = weft__dot(e, f);
    const double ep = weft__dot(e, ap), fp = weft__dot(f, ap), det = ee * ff - ef * ef;
    const double u = (ff * ep - ef * fp) / det, v = (ee * fp - ef * ep) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
        for (size_t k = 0; k < 3; ++k) {
            ap[k] -= u * e[k] + v * f[k];
        }
        return weft__dot(ap, ap);
    }
    return smaller(
        edge_square(x[0], x[1], x[2]),
        smaller(edge_square(x[0], x[1], x[3]), edge_square(x[0], x[2], x[3])));
}

/* Inside by both feet, else an end of one is nearest. */
static double edges_square(double x[4][3])
{
    double e[3], f[3], r[3];
    from_to(x[0], x[1], e);
    from_to(x[2], x[3], f);
    from_to(x[2], x[0], r);
    const double ee = weft__dot(e, e), ff = weft__dot(f, f), ef = weft__dot(e, f);
    const double er = weft__dot(e, r), fr = weft__dot(f, r), det = ee * ff - ef * ef;
    const double s = (ef * fr - ff * er) / det, t = (ee * fr - ef * er) / det;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
        for (size_t k = 0; k < 3; ++k) {
            r[k] += s * e[k] - t * f[k];
        }
        return weft__dot(r, r);
    }
    return smaller(
        smaller(edge_square(x[0], x[2], x[3]), edge_square(x[1], x[2], x[3])),
        smaller(edge_square(x[2], x[0], x[1]), edge_square(x[3], x[0], x[1])));
}

static double distance(weft__pair_kind kind, double x[4][3])
{
    return sqrt(kind == WEFT__VERTICES          ? square_of(x[0], x[1])
                : kind == WEFT__VERTEX_EDGE     ? edge_square(x[0], x[1], x[2])
                : kind == WEFT__VERTEX_TRIANGLE ? triangle_square(x)
                                                : edges_square(x));
}

double weft__pair_distance(const weft__pair *pair, const double *y, size_t n)
{
    double x[4][3] = { { 0.0 } };
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        place(y, n, pair->particle[k], x[k]);
    }
    return distance(pair->kind, x);
}

/* ---- the search ------------------------------------------------------------------ */

typedef struct pair_search {
    const weft__quadtree *tree;
    double range;
    weft__pair_fn *visit;
    void *ctx;
} pair_search;

/* Whether the boxes about both sides of a pair are further apart than the range. */
static bool apart(double x[4][3], size_t first, size_t all, double range)
{
    for (size_t k = 0; k < 3; ++k) {
        double low[2] = { x[0][k], x[first][k] }, high[2] = { x[0][k], x[first][k] };
        for (size_t i = 1; i < all; ++i) {
            const size_t side = i >= first;
            low[side] = smaller(low[side], x[i][k]);
            high[side] = x[i][k] > high[side] ? x[i][k] : high[side];
        }
        if (low[0] - high[1] > range || low[1] - high[0] > range) {
            return true;
        }
    }
    return false;
}

static bool has(const uint32_t *particles, size_t count, uint32_t i)
{
    bool found = false;
    for (size_t k = 0; k < count; ++k) {
        found = found || particles[k] == i;
    }
    return found;
}

static bool try_pair(const pair_search *of, const weft__pair *pair)
{
    const size_t all = weft__pair_particles(pair);
    const size_t first = pair->kind == WEFT__EDGES ? 2 : 1;
    double x[4][3] = { { 0.0 } };
    for (size_t k = 0; k < all; ++k) {
        place(of->tree->y, of->tree->cloth->particles, pair->particle[k], x[k]);
    }
    if (apart(x, first, all, of->range)) {
        return true;
    }
    const double d = distance(pair->kind, x);
    return !(d < of->range) || of->visit(of->ctx, pair, d);
}

/* Particle i with all that node j owns but particle j. */
static bool try_particle(const pair_search *of, uint32_t i, size_t j)
{
    uint32_t edges[3][2], triangles[2][3];
    const size_t edge_count = weft__node_edges(of->tree->cloth, j, edges);
    const size_t triangle_count = weft__node_triangles(of->tree->cloth, j, triangles);
    bool goes_on = true;
    for (size_t k = 0; k < triangle_count && goes_on; ++k) {
        const uint32_t *to = triangles[k];
        goes_on = has(to, 3, i)
                  || try_pair(of, &(weft__pair){ .particle = { i, to[0], to[1], to[2] },
                                                 .kind = WEFT__VERTEX_TRIANGLE });
    }
    for (size_t k = 0; k < edge_count && goes_on; ++k) {
        const uint32_t *to = edges[k];
        goes_on = has(to, 2, i)
                  || try_pair(of, &(weft__pair){ .particle = { i, to[0], to[1], to[1] },
                                                 .kind = WEFT__VERTEX_EDGE });
    }
    return goes_on;
}

static bool try_edges(const pair_search *of, size_t i, size_t j)
{
    uint32_t a[3][2], b[3][2];
    const size_t in_i = weft__node_edges(of->tree->cloth, i, a);
    const size_t in_j = weft__node_edges(of->tree->cloth, j, b);
    bool goes_on = true;
    for (size_t k = 0; k < in_i * in_j && goes_on; ++k) {
        const uint32_t *one = a[k / in_j], *other = b[k % in_j];
        goes_on = has(other, 2, one[0]) || has(other, 2, one[1])
                  || try_pair(of, &(weft__pair){ .particle = { one[0], one[1], other[0],
                                                               other[1] },
                                                 .kind = WEFT__EDGES });
    }
    return goes_on;
}

/* The edges of one node have common particles. */
static bool visit_nodes(void *ctx, size_t i, size_t j)
{
    const pair_search *of = ctx;
    const uint32_t a = (uint32_t)i, b = (uint32_t)j;
    return try_particle(of, a, j)
           && (i == j
               || (try_particle(of, b, i)
                   && try_pair(of, &(weft__pair){ .particle = { a, b, b, b },
                                                  .kind = WEFT__VERTICES })
                   && try_edges(of, i, j)));
}

bool weft__each_pair(const weft__quadtree *tree, double range, weft__pair_fn *visit,
                     void *ctx)
{
    pair_search of = { tree, range, visit, ctx };
    return weft__tree_pairs(tree, range, visit_nodes, &of);
}

/* ---- steps ----------------------------------------------------------------------- */

/* [m^2] The square of the longest way of two particles against each other. */
static double difference(const weft__stride *of, size_t a, size_t b)
{
    const size_t n = of->cloth->particles;
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
    *gap = weft__pair_distance(pair, of->y1, of->cloth->particles);
    return path == 0.0
           || (*gap > 0.0
               && path
                      < weft__pair_distance(pair, of->y0, of->cloth->particles) + *gap);
}

double weft__reference_extent(const double *from, const double *to, size_t n)
{
    double square = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        double low = INFINITY, high = -INFINITY, bad = 0.0;
        for (size_t i = k * n; i < (k + 1) * n; ++i) {
            const double d = from != NULL ? to[i] - from[i] : to[i];
            low = d < low ? d : low;
            high = d > high ? d : high;
            bad += d * 0.0;
        }
        square += bad == 0.0 ? (high - low) * (high - low) : (double)INFINITY;
    }
    return sqrt(square);
}

double weft__reference_drift(const weft_cloth *cloth, const double *from,
                             const double *to, weft__drift *tiles)
{
    const size_t n = cloth->particles;
    for (size_t i = 0; i < weft__tile_count(cloth); ++i) {
        size_t in[4];
        weft__tile_range(cloth, i, in);
        for (size_t k = 0; k < 3; ++k) {
            double low = INFINITY, high = -INFINITY;
            for (size_t r = in[0]; r < in[1]; ++r) {
                for (size_t c = in[2]; c < in[3]; ++c) {
                    const size_t j = k * n + r * cloth->cols + c;
                    const double d = from != NULL ? to[j] - from[j] : to[j];
                    low = d < low ? d : low;
                    high = d > high ? d : high;
                }
            }
            tiles[i].low[k] = low, tiles[i].high[k] = high;
        }
    }
    return weft__reference_extent(from, to, n);
}

double weft__extent(const weft_cloth *cloth, const double *from, const double *to)
{
    return cloth->level->extent(from, to, cloth->particles);
}

double weft__stride_length(const weft__stride *of)
{
    const size_t n = of->cloth->particles;
    const double moved = weft__extent(of->cloth, of->y0, of->y1);
    return of->h == 0.0
               ? moved
               : fmax(moved, of->h
                                 * fmax(weft__extent(of->cloth, NULL, of->y0 + 3 * n),
                                        weft__extent(of->cloth, NULL, of->y1 + 3 * n)));
}
