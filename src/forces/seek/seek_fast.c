/* SPDX-License-Identifier: BSD-3-Clause */
/* seek_fast.c -- the search of seek.h: the quarters of two patches are sixteen pairs of
 * boxes, whose comparisons are the bits of a number, in the order in which the pairs
 * are visited; a primitive of one node is compared with eight of another. */
#include "forces/seek/seek.h"
#include "forces/seek/single.h"

typedef float four __attribute__((vector_size(16)));
typedef float four_anywhere __attribute__((vector_size(16), aligned(4), may_alias));
typedef float eight __attribute__((vector_size(32)));
typedef float eight_anywhere __attribute__((vector_size(32), aligned(4), may_alias));
typedef int32_t eight_mask __attribute__((vector_size(32)));
typedef int32_t eight_mask_anywhere
    __attribute__((vector_size(32), aligned(4), may_alias));

/* Two numbers in a row. */
typedef double two_anywhere __attribute__((aligned(4), may_alias));
typedef double two_twos __attribute__((vector_size(16)));

#if defined __clang__ || __GNUC__ >= 12
#define EIGHT_OF(a, ...) __builtin_shufflevector(a, a, __VA_ARGS__)
#else
#define EIGHT_OF(a, i, j, k, l, m, n, o, p)                                            \
    ((eight){ a[i], a[j], a[k], a[l], a[m], a[n], a[o], a[p] })
#endif

/* Relative to 1: what E and the spacings of a flat grid round by, and a range. */
#define FLATNESS_MARGIN 1e-4F
#define RANGE_MARGIN    1e-6

/* The point of a node, then edges, then triangles. */
typedef struct node_slice {
    size_t node, number, eights;
    unsigned edges, triangles; /* bits: which ones are */
    bool more;                 /* in the next slice */
    float (*box)[6][8];        /* by eights: low, high */
} node_slice;

/* The last ones that a search came to, each in the place of its node. */
enum { KEPT = 64 };
typedef struct kept {
    node_slice at[KEPT];
    float box[KEPT][6][8];
} kept;

typedef struct seeking {
    const weft__boxes *in;
    const double *y;
    float range; /* [m] */
    weft__pair_fn *visit;
    void *ctx;
    size_t places; /* in sides; a power of 2 */
    kept *sides[2];
} seeking;

/* A node, or a patch of a level; in one register. */
typedef struct seek_patch {
    uint32_t r, c;
} seek_patch;

INLINE bool of_surface(const seeking *of)
{
    return of->in->of.nodes.fold > 1;
}

/* ---- nodes ----------------------------------------------------------------------- */

INLINE four seek_fast_place_of(const seeking *of, size_t i)
{
    const double *x = of->y + i;
    const size_t n = of->in->of.points;
    return (four){ single(x[0]), single(x[n]), single(x[2 * n]), 0.0F };
}

/* Whether a primitive's box is high or low decides `sign`. */
INLINE four extreme_of(four a, four b, float sign)
{
    const four x = sign * a, y = sign * b;
#if defined __SSE2__
    return sign * (four)_mm_max_ps((__m128)x, (__m128)y);
#else
    four out = x;
    for (size_t k = 0; k < 4; ++k) {
        out[k] = x[k] > y[k] ? x[k] : y[k];
    }
    return sign * out;
#endif
}

/* The box of primitive l, about three points, which may be the same. */
INLINE void seek_fast_put_box(node_slice *to, size_t l, four a, four b, four c)
{
    const four low = extreme_of(extreme_of(a, b, -1.0F), c, -1.0F);
    const four high = extreme_of(extreme_of(a, b, 1.0F), c, 1.0F);
    for (size_t k = 0; k < 3; ++k) {
        to->box[l / 8][k][l % 8] = low[k] - margin(low[k]);
        to->box[l / 8][3 + k][l % 8] = high[k] + margin(high[k]);
    }
}

/* Of a grid: the corners of each primitive of a node, which are this node and those to
 * the right, below, and both. */
static const size_t corners[6][3]
    = { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 2, 0 }, { 1, 2, 0 }, { 0, 2, 1 }, { 3, 1, 2 } };

static void fill_node(const seeking *of, seek_patch at, node_slice *to)
{
    const weft__nodes *nodes = &of->in->of.nodes;
    const size_t right = at.c + 1 < nodes->cols, down = at.r + 1 < nodes->rows;
    const bool both = right != 0 && down != 0;
    four x[4];
    for (size_t j = 0; j < 4; ++j) {
        x[j] = seek_fast_place_of(of, to->node + j % 2 * right
                                          + j / 2 * down * nodes->cols);
    }
    seek_fast_put_box(to, 0, x[0], x[0], x[0]);
    seek_fast_put_box(to, 1, x[0], x[1], x[1]);
    seek_fast_put_box(to, 2, x[0], x[2], x[2]);
    seek_fast_put_box(to, 3, x[1], x[2], x[2]);
    seek_fast_put_box(to, 4, x[0], x[2], x[1]);
    seek_fast_put_box(to, 5, x[3], x[1], x[2]);
    to->edges = (right ? 2U : 0U) | (down ? 4U : 0U) | (both ? 8U : 0U);
    to->triangles = both ? 0x30U : 0U;
    to->eights = 1, to->more = false;
}

typedef struct slice_range {
    size_t point, edge, edge_end, triangle, triangle_end;
    bool more;
} slice_range;

INLINE slice_range seek_fast_range_of(const seeking *of, const node_slice *at)
{
    const weft__primitives *in = &of->in->of;
    const size_t i = in->order != NULL ? in->order[at->node] : at->node;
    slice_range out = { i,
                        in->edge_first[i],
                        in->edge_first[i + 1],
                        in->triangle_first[i],
                        in->triangle_first[i + 1],
                        false };
    out.more = weft__owned_slice(at->number, &out.edge, &out.edge_end);
    out.more
        = weft__owned_slice(at->number, &out.triangle, &out.triangle_end) || out.more;
    return out;
}

static void fill_slice(const seeking *of, node_slice *to)
{
    const weft__primitives *in = &of->in->of;
    const slice_range range = seek_fast_range_of(of, to);
    const four x = seek_fast_place_of(of, range.point);
    size_t l = 0;
    seek_fast_put_box(to, l++, x, x, x);
    for (size_t e = range.edge; e < range.edge_end; ++e) {
        const four end = seek_fast_place_of(of, in->edge[e][1]);
        seek_fast_put_box(to, l++, x, end, end);
    }
    to->edges = (1U << l) - 2U;
    for (size_t t = range.triangle; t < range.triangle_end; ++t) {
        seek_fast_put_box(to, l++, x, seek_fast_place_of(of, in->triangle[t][1]),
                          seek_fast_place_of(of, in->triangle[t][2]));
    }
    to->triangles = (1U << l) - 2U - to->edges;
    to->eights = (l + 7) / 8, to->more = range.more;
}

INLINE const node_slice *slice_of(const seeking *of, size_t side, seek_patch at,
                                  size_t number)
{
    const bool surface = of_surface(of);
    const size_t node = surface ? at.c : at.r * of->in->of.nodes.cols + at.c;
    const size_t place = surface ? at.c : at.r % 8 * 8 + at.c % 8;
    node_slice *to = &of->sides[side]->at[place & (of->places - 1)];
    if (to->node != node || to->number != number) {
        to->node = node, to->number = number;
        if (surface) {
            fill_slice(of, to);
        } else {
            fill_node(of, at, to);
        }
    }
    return to;
}

/* ---- comparisons ----------------------------------------------------------------- */

INLINE unsigned bits_of(const eight_mask *a)
{
#if defined __AVX512VL__
    return _mm256_movepi32_mask((__m256i)*a);
#elif defined __AVX__
    return (unsigned)_mm256_movemask_ps((__m256)*a);
#elif defined __SSE2__
    const __m128 *half = (const __m128 *)(const void *)a;
    return (unsigned)(_mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4);
#else
    unsigned found = 0;
    for (int i = 0; i < 8; ++i) {
        found |= (unsigned)((*a)[i] & 1) << i;
    }
    return found;
#endif
}

/* Which of some boxes, by their bits, are not further apart than the range. Empty ones
 * are. */
INLINE unsigned near_boxes(const eight a[6], const eight b[6], float range,
                           unsigned among)
{
#if defined __AVX512VL__
    const __m256 most = (__m256)(range - (eight){ 0 });
    __mmask8 near = (__mmask8)among;
    for (size_t k = 0; k < 3; ++k) {
        const __m256 up = (__m256)(a[k] - b[3 + k]), down = (__m256)(b[k] - a[3 + k]);
        near = _mm256_mask_cmp_ps_mask(near, up, most, _CMP_LE_OQ);
        near = _mm256_mask_cmp_ps_mask(near, down, most, _CMP_LE_OQ);
    }
    return near;
#else
    const eight_mask x = (a[0] - b[3] <= range) & (b[0] - a[3] <= range);
    const eight_mask y = (a[1] - b[4] <= range) & (b[1] - a[4] <= range);
    const eight_mask z = (a[2] - b[5] <= range) & (b[2] - a[5] <= range);
    const eight_mask all = x & y & z;
    return bits_of(&all) & among;
#endif
}

/* Which of eight primitives of b are near primitive p of a. */
INLINE unsigned near_eight(const node_slice *a, size_t p, const node_slice *b, size_t i,
                           float range, unsigned among)
{
    eight one[6], others[6];
    for (size_t k = 0; k < 6; ++k) {
        one[k] = a->box[p / 8][k][p % 8] - (eight){ 0 };
        others[k] = *(const eight_anywhere *)b->box[i][k];
    }
    return near_boxes(one, others, range, among);
}

/* Two nodes of a grid side by side: bit 4 r + c of a primitive is its point that many
 * rows and columns after the first of both. */
typedef struct joint {
    unsigned first;    /* bit of a */
    eight_mask points; /* of b's primitives */
} joint;

static const int32_t points_of[8]
    = { 1, 1 | 2, 1 | 16, 2 | 16, 1 | 2 | 16, 2 | 16 | 32, 0, 0 };

INLINE void seek_fast_join(joint *to, seek_patch a, seek_patch b)
{
    const uint32_t r = a.r < b.r ? a.r : b.r, c = a.c < b.c ? a.c : b.c;
    const bool beside = a.r + b.r - 2 * r < 2 && a.c + b.c - 2 * c < 2;
    to->first = beside ? 4 * (a.r - r) + a.c - c : 0;
    to->points = *(const eight_mask_anywhere *)points_of
                     << (beside ? (int32_t)(4 * (b.r - r) + b.c - c) : 0)
                 & -(int32_t)beside;
}

/* Which primitives of b have no point in common with primitive p of a. */
INLINE unsigned seek_fast_apart(const joint *at, size_t p)
{
    const int32_t own = points_of[p] << at->first;
#if defined __AVX512VL__
    return _mm256_testn_epi32_mask((__m256i)at->points, _mm256_set1_epi32(own));
#else
    const eight_mask none = (at->points & own) == 0;
    return bits_of(&none);
#endif
}

/* Which primitives of b are near primitive p of a; at: but for those that have a point
 * in common with it. */
INLINE unsigned near_one(const node_slice *a, size_t p, const node_slice *b,
                         float range, const joint *at)
{
    unsigned found = 0;
    if (at != NULL) {
        return near_eight(a, p, b, 0, range, seek_fast_apart(at, p));
    }
    for (size_t i = 0; i < b->eights; ++i) {
        found |= near_eight(a, p, b, i, range, 0xffU) << 8 * i;
    }
    return found;
}

/* A plane of the boxes of the quarters of a patch. */
INLINE four quarters_of(const seeking *of, const weft__seek_level *at, size_t plane,
                        seek_patch in)
{
    const float *from = at->box + plane * at->plane;
    if (of_surface(of)) {
        return *(const four_anywhere *)(from + 4 * in.c);
    }
    from += 2 * in.r * at->stride + 2 * in.c;
    return (four)(two_twos){ *(const two_anywhere *)(const void *)from,
                             *(const two_anywhere *)(const void *)(from + at->stride) };
}

/* Bit 4 i + j: quarters i and j of two patches are near each other. */
INLINE unsigned near_quarters(const seeking *of, size_t level, seek_patch a,
                              seek_patch b)
{
    const weft__seek_level *below = &of->in->level[level - 1];
    eight first[6], last[6], others[6];
    for (size_t k = 0; k < 6; ++k) {
        const four x = quarters_of(of, below, k, a), y = quarters_of(of, below, k, b);
        first[k] = EIGHT_OF(x, 0, 0, 0, 0, 1, 1, 1, 1);
        last[k] = EIGHT_OF(x, 2, 2, 2, 2, 3, 3, 3, 3);
        others[k] = EIGHT_OF(y, 0, 1, 2, 3, 0, 1, 2, 3);
    }
    return near_boxes(first, others, of->range, 0xffU)
           | near_boxes(last, others, of->range, 0xffU) << 8;
}

/* ---- pairs ----------------------------------------------------------------------- */

/* Writes the points of primitive l, and returns its number. */
INLINE uint32_t write_points(const seeking *of, const node_slice *at, size_t l,
                             size_t count, uint32_t *to)
{
    const weft__primitives *in = &of->in->of;
    if (!of_surface(of)) {
        for (size_t j = 0; j < count; ++j) {
            const size_t corner = corners[l][j];
            to[j] = (uint32_t)(at->node + corner % 2 + corner / 2 * in->nodes.cols);
        }
        return 0;
    }
    const slice_range range = seek_fast_range_of(of, at);
    const size_t edges = range.edge_end - range.edge;
    const size_t item = count == 1   ? range.point
                        : count == 2 ? range.edge + l - 1
                                     : range.triangle + l - 1 - edges;
    for (size_t j = 0; j < count; ++j) {
        to[j] = count == 1   ? (uint32_t)range.point
                : count == 2 ? in->edge[item][j]
                             : in->triangle[item][j];
    }
    return (uint32_t)item;
}

/* Of a surface: whether two primitives have a point in common. */
INLINE bool share_points(const weft__pair *pair, size_t first, size_t all)
{
    bool common = false;
    for (size_t i = 0; i < first; ++i) {
        for (size_t j = first; j < all; ++j) {
            common = common || pair->particle[i] == pair->particle[j];
        }
    }
    return common;
}

/* Visits the pairs of primitive p of a and those of b whose bits are set. */
INLINE bool visit_pairs(const seeking *of, weft__pair_kind kind, const node_slice *a,
                        size_t p, const node_slice *b, unsigned which)
{
    const size_t all = weft__kind_particles(kind), first = kind == WEFT__EDGES ? 2 : 1;
    bool continues = true;
    for (; which != 0 && continues; which &= which - 1) {
        weft__pair pair = { .kind = kind };
        pair.item[0] = write_points(of, a, p, first, pair.particle);
        pair.item[1] = write_points(of, b, (size_t)__builtin_ctz(which), all - first,
                                    pair.particle + first);
        continues = (of_surface(of) && share_points(&pair, first, all))
                    || of->visit(of->ctx, &pair);
    }
    return continues;
}

/* The point of a with all that b owns but its point. */
INLINE bool visit_vertex(const seeking *of, const node_slice *a, const node_slice *b,
                         unsigned near)
{
    return visit_pairs(of, WEFT__VERTEX_TRIANGLE, a, 0, b, near & b->triangles)
           && visit_pairs(of, WEFT__VERTEX_EDGE, a, 0, b, near & b->edges);
}

/* The order of self_pairs.c, kind by kind. ab, ba: of a grid, how they join. */
INLINE bool visit_slices(const seeking *of, const node_slice *a, const node_slice *b,
                         const joint *ab, const joint *ba)
{
    const bool first = a->number == 0, last = b->number == 0;
    const unsigned by_a = first ? near_one(a, 0, b, of->range, ab) : 0U;
    const unsigned by_b = last ? near_one(b, 0, a, of->range, ba) : 0U;
    bool continues = visit_vertex(of, a, b, by_a) && visit_vertex(of, b, a, by_b)
                     && visit_pairs(of, WEFT__VERTICES, a, 0, b, last ? by_a & 1U : 0U);
    for (unsigned edges = a->edges; edges != 0 && continues; edges &= edges - 1) {
        const size_t p = (size_t)__builtin_ctz(edges);
        continues = visit_pairs(of, WEFT__EDGES, a, p, b,
                                near_one(a, p, b, of->range, ab) & b->edges);
    }
    return continues;
}

static bool visit_owned(const seeking *of, seek_patch i, seek_patch j)
{
    const node_slice *a = slice_of(of, 0, i, 0), *b = NULL;
    bool continues = true;
    for (size_t k = 0; continues && (k == 0 || a->more); ++k) {
        a = slice_of(of, 0, i, k);
        for (size_t l = 0; continues && (l == 0 || b->more); ++l) {
            b = slice_of(of, 1, j, l);
            continues = visit_slices(of, a, b, NULL, NULL);
        }
    }
    return continues;
}

/* All edges of one node of a grid have it in common but the diagonal. */
static bool seek_fast_visit_nodes(const seeking *of, seek_patch i, seek_patch j)
{
    const bool same = i.r == j.r && i.c == j.c;
    joint ab, ba;
    if (of_surface(of)) {
        return same || visit_owned(of, i, j);
    }
    const node_slice *a = slice_of(of, 0, i, 0);
    seek_fast_join(&ab, i, j), seek_fast_join(&ba, j, i);
    return same ? visit_vertex(of, a, a, near_one(a, 0, a, of->range, &ab))
                : visit_slices(of, a, slice_of(of, 1, j, 0), &ab, &ba);
}

/* ---- patches --------------------------------------------------------------------- */

/* Whether a square of at most 3 x 3 patches that has both is flat, so that nothing in
 * it is near what is not beside it. */
INLINE bool seek_fast_flat_about(const seeking *of, size_t level, seek_patch a,
                                 seek_patch b)
{
    const weft__seek_level *at = &of->in->level[level];
    const size_t r = a.r < b.r ? a.r : b.r, c = a.c < b.c ? a.c : b.c;
    const size_t high = a.r + b.r - 2 * r, wide = a.c + b.c - 2 * c;
    const size_t by = high > wide ? high : wide;
    if (of_surface(of) || by > 2) {
        return false;
    }
    const float most = 1.0F - FLATNESS_MARGIN - of->range * at->inverse[by < 2 ? 0 : 1];
    return most > 0.0F && at->bent[by][r * at->stride + c] < most * most;
}

/* Whether all nodes are of bodies, or of a cloth that only meets these. */
INLINE bool never_meet(const seeking *of, size_t level, seek_patch a, seek_patch b)
{
    const weft__primitives *in = &of->in->of;
    const size_t low = a.c < b.c ? a.c : b.c, high = a.c < b.c ? b.c : a.c;
    return of_surface(of)
           && (low << 2 * level >= in->particles
               || (in->between && (high + 1) << 2 * level <= in->particles));
}

INLINE seek_patch quarter_of(const seeking *of, seek_patch a, uint32_t j)
{
    return of_surface(of) ? (seek_patch){ 0, 4 * a.c + j }
                          : (seek_patch){ 2 * a.r + j / 2, 2 * a.c + j % 2 };
}

static bool seek_between(const seeking *of, size_t level, seek_patch a, seek_patch b);

/* Between quarters of two patches, as near_quarters has them. */
INLINE bool seek_quarters(const seeking *of, size_t level, seek_patch a, seek_patch b,
                          unsigned near)
{
    bool continues = true;
    for (; near != 0 && continues; near &= near - 1) {
        const uint32_t bit = (uint32_t)__builtin_ctz(near);
        continues = seek_between(of, level - 1, quarter_of(of, a, bit / 4),
                                 quarter_of(of, b, bit % 4));
    }
    return continues;
}

/* Of patches that are near each other. */
static bool seek_between(const seeking *of, size_t level, seek_patch a, seek_patch b)
{
    if (seek_fast_flat_about(of, level, a, b) || never_meet(of, level, a, b)) {
        return true;
    }
    if (level == 0) {
        return seek_fast_visit_nodes(of, a, b);
    }
    return seek_quarters(of, level, a, b, near_quarters(of, level, a, b));
}

/* First within each quarter, then between each and those after it. */
static bool seek_within(const seeking *of, size_t level, seek_patch a)
{
    enum { AFTER = 1 << 1 | 1 << 2 | 1 << 3 | 1 << 6 | 1 << 7 | 1 << 11 };
    bool continues = true;
    if (seek_fast_flat_about(of, level, a, a) || never_meet(of, level, a, a)) {
        return true;
    }
    if (level == 0) {
        return seek_fast_visit_nodes(of, a, a);
    }
    const weft__seek_level *below = &of->in->level[level - 1];
    for (uint32_t j = 0; j < 4 && continues; ++j) {
        const seek_patch in = quarter_of(of, a, j);
        continues = in.r >= below->rows || in.c >= below->cols
                    || seek_within(of, level - 1, in);
    }
    return continues
           && seek_quarters(of, level, a, a, near_quarters(of, level, a, a) & AFTER);
}

INLINE bool tiles_apart(const seeking *of, seek_patch a, seek_patch b)
{
    const weft__seek_level *top = &of->in->level[of->in->top];
    bool apart = false;
    for (size_t k = 0; k < 3; ++k) {
        const float *low = top->box + k * top->plane, *high = low + 3 * top->plane;
        const size_t i = a.r * top->stride + a.c, j = b.r * top->stride + b.c;
        apart = apart || low[i] - high[j] > of->range || low[j] - high[i] > of->range;
    }
    return apart;
}

bool NAME(seek, LEVEL)(const weft__boxes *in, const double *y, const uint32_t tiles[2],
                       double range, weft__pair_fn *visit, void *ctx)
{
    kept sides[2];
    const seeking of = { .in = in,
                         .y = y,
                         .range = (float)(range * (1.0 + RANGE_MARGIN)),
                         .visit = visit,
                         .ctx = ctx,
                         .places = in->eights == 1   ? KEPT
                                   : in->eights == 2 ? KEPT / 2
                                                     : KEPT / 4,
                         .sides = { &sides[0], &sides[1] } };
    const uint32_t cols = (uint32_t)in->level[in->top].cols;
    const seek_patch a = { tiles[0] / cols, tiles[0] % cols };
    const seek_patch b = { tiles[1] / cols, tiles[1] % cols };
    if (tiles_apart(&of, a, b)) {
        return true;
    }
    for (size_t i = 0; i < of.places; ++i) {
        sides[0].at[i].node = sides[1].at[i].node = SIZE_MAX;
        sides[0].at[i].box = sides[0].box + i * (KEPT / of.places);
        sides[1].at[i].box = sides[1].box + i * (KEPT / of.places);
    }
    return tiles[0] == tiles[1] ? seek_within(&of, in->top, a)
                                : seek_between(&of, in->top, a, b);
}
