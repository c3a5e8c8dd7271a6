/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_fast.c -- the membrane of membrane.h, LANES triangles at a time. A block's
 * own particles and those of its halo lie as records x, y, z, 0 in the first cache;
 * the sums of the halo are thrown away. Edges are such records, too, and only squares
 * and the law are lanes; with 8 lanes, edges are lanes. */
#include "forces/lanes.h"
#include "forces/membrane/membrane.h"

#include <string.h>

#define LAW_OF_LANES
#include "forces/membrane/membrane_law.h"

/* doubles; those of a block; batches whose constants are sought ahead */
enum { RECORD = 4, SPAN = RECORD * (WEFT__NEAR + LANES), AHEAD = 8 };

typedef struct local {
    _Alignas(64) double x[SPAN]; /* [m] */
    double v[SPAN];              /* [m/s] */
    double force[SPAN];          /* [N] */
} local;

INLINE record *record_at(double *of, size_t i)
{
    return (record *)(void *)(of + RECORD * i);
}

#define RECORD_OF(of, i) (*(const record *)(const void *)((of) + RECORD * (size_t)(i)))

#if LANES == 8
/* Two records as lanes, and the first or the second of them. */
#if defined __clang__ || __GNUC__ >= 12
#define JOIN(a, b) SHUFFLE(a, b, 0, 1, 2, 3, 4, 5, 6, 7)
#define HALF(a, i) ((i) ? SHUFFLE(a, a, 4, 5, 6, 7) : SHUFFLE(a, a, 0, 1, 2, 3))
#else
typedef union halves {
    record half[2];
    vec both;
} halves;
#define JOIN(a, b) (((halves){ .half = { a, b } }).both)
#define HALF(a, i) (((halves){ .both = a }).half[i])
#endif
#endif

/* Numbers of particles that follow one another. */
static const uint16_t in_turn[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };

/* LANES records as lanes. */
INLINE vec3 together(const record of[LANES])
{
#if LANES == 8
    const vec a = JOIN(of[0], of[2]), b = JOIN(of[1], of[3]);
    const vec c = JOIN(of[4], of[6]), d = JOIN(of[5], of[7]);
    const vec xz = SHUFFLE(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec XZ = SHUFFLE(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec y = SHUFFLE(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec Y = SHUFFLE(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return (vec3){ SHUFFLE(xz, XZ, 0, 1, 4, 5, 8, 9, 12, 13),
                   SHUFFLE(y, Y, 0, 1, 4, 5, 8, 9, 12, 13),
                   SHUFFLE(xz, XZ, 2, 3, 6, 7, 10, 11, 14, 15) };
#elif LANES == 4
    const vec xz = SHUFFLE(of[0], of[1], 0, 4, 2, 6);
    const vec XZ = SHUFFLE(of[2], of[3], 0, 4, 2, 6);
    const vec y = SHUFFLE(of[0], of[1], 1, 5, 3, 7);
    const vec Y = SHUFFLE(of[2], of[3], 1, 5, 3, 7);
    return (vec3){ SHUFFLE(xz, XZ, 0, 1, 4, 5), SHUFFLE(y, Y, 0, 1, 4, 5),
                   SHUFFLE(xz, XZ, 2, 3, 6, 7) };
#else
    const record a = of[0], b = of[1];
    return (vec3){ { a[0], b[0] }, { a[1], b[1] }, { a[2], b[2] } };
#endif
}

/* The records at[0], at[1], ... */
INLINE vec3 collect(const double *of, const uint16_t at[LANES])
{
    record all[LANES];
    for (size_t l = 0; l < LANES; ++l) {
        all[l] = RECORD_OF(of, at[l]);
    }
    return together(all);
}

/* ---- a batch --------------------------------------------------------------------- */

#if LANES == 8
typedef vec3 edge_set; /* the same edge of LANES triangles */

INLINE void edges(const double *of, const uint16_t *at, edge_set d[3])
{
    const vec3 a = collect(of, at), b = collect(of, at + WEFT__WIDTH),
               c = collect(of, at + 2 * WEFT__WIDTH);
    d[0] = minus(c, b), d[1] = minus(a, c), d[2] = minus(b, a);
}

INLINE vec dots(const edge_set *a, const edge_set *b)
{
    return dot(*a, *b);
}

/* Adds the lanes of a to the records at[0], at[1], ..., of which none is twice. */
INLINE void membrane_fast_spread(double *to, const uint16_t at[LANES], vec3 a)
{
    const vec none = { 0 };
    const vec xy = SHUFFLE(a.x, a.y, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec XY = SHUFFLE(a.x, a.y, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec z = SHUFFLE(a.z, none, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec Z = SHUFFLE(a.z, none, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec low[2] = { SHUFFLE(xy, z, 0, 1, 8, 9, 2, 3, 10, 11),
                         SHUFFLE(XY, Z, 0, 1, 8, 9, 2, 3, 10, 11) };
    const vec high[2] = { SHUFFLE(xy, z, 4, 5, 12, 13, 6, 7, 14, 15),
                          SHUFFLE(XY, Z, 4, 5, 12, 13, 6, 7, 14, 15) };
    for (size_t l = 0; l < LANES; ++l) {
        const vec *half = l < 4 ? &low[l % 2] : &high[l % 2];
        *record_at(to, at[l]) += l / 2 % 2 == 0 ? HALF(*half, 0) : HALF(*half, 1);
    }
}

/* Edge i pulls at its ends with s[i] d[i]. */
INLINE void membrane_fast_pull(double *to, const uint16_t *at, const vec s[3],
                               const edge_set d[3])
{
    const vec3 f[3] = { scaled(s[0], d[0]), scaled(s[1], d[1]), scaled(s[2], d[2]) };
    membrane_fast_spread(to, at, minus(f[2], f[1]));
    membrane_fast_spread(to, at + WEFT__WIDTH, minus(f[0], f[2]));
    membrane_fast_spread(to, at + 2 * WEFT__WIDTH, minus(f[1], f[0]));
}
#else
typedef struct edge_set {
    record of[LANES];
} edge_set;

INLINE void edges(const double *of, const uint16_t *at, edge_set d[3])
{
    for (size_t l = 0; l < LANES; ++l) {
        const record a = RECORD_OF(of, at[l]), b = RECORD_OF(of, at[WEFT__WIDTH + l]),
                     c = RECORD_OF(of, at[2 * WEFT__WIDTH + l]);
        d[0].of[l] = c - b, d[1].of[l] = a - c, d[2].of[l] = b - a;
    }
}

INLINE vec dots(const edge_set *a, const edge_set *b)
{
    record product[LANES];
    for (size_t l = 0; l < LANES; ++l) {
        product[l] = a->of[l] * b->of[l];
    }
    const vec3 parts = together(product);
    return parts.x + parts.y + parts.z;
}

INLINE void membrane_fast_pull(double *to, const uint16_t *at, const vec s[3],
                               const edge_set d[3])
{
    for (size_t l = 0; l < LANES; ++l) {
        const record a = ALL(s[0][l]) * d[0].of[l], b = ALL(s[1][l]) * d[1].of[l],
                     c = ALL(s[2][l]) * d[2].of[l];
        *record_at(to, at[l]) += c - b;
        *record_at(to, at[WEFT__WIDTH + l]) += a - c;
        *record_at(to, at[2 * WEFT__WIDTH + l]) += b - a;
    }
}
#endif

/* of: the constants, at: the corners, from a lane on */
INLINE void batch(const double *of, const uint16_t *at, local *in, bool damped)
{
    edge_set d[3], w[3];
    vec square[3], q[3], s[3];
    edges(in->x, at, d);
    if (damped) {
        edges(in->v, at, w);
    }
    for (int i = 0; i < 3; ++i) {
        square[i] = dots(&d[i], &d[i]);
        q[i] = square[i] - CONSTANT(of, WEFT__SQUARE + i);
        if (damped) {
            q[i] = q[i] + CONSTANT(of, WEFT__LAG) * dots(&d[i], &w[i]);
        }
    }
    law_pull(of, square, q, s);
    membrane_fast_pull(in->force, at, s, d);
}

INLINE void batches(const weft__membrane *own, size_t b, local *in, bool damped)
{
    for (size_t g = own->blocks[b].batch; g < own->blocks[b + 1].batch; ++g) {
        const double *of = own->batches[g].of[0];
        const uint16_t *at = own->corners[g].near[0];
        for (size_t k = 0; k < WEFT__LAG; ++k) {
            __builtin_prefetch(of + AHEAD * WEFT__CONSTANTS * WEFT__WIDTH
                               + k * WEFT__WIDTH);
        }
        for (size_t lane = 0; lane < WEFT__WIDTH; lane += LANES) {
            batch(of + lane, at + lane, in, damped);
        }
    }
}

/* ---- a block --------------------------------------------------------------------- */

/* Three planes of the particles of a block and of its halo as records, and one of
 * zeros. */
INLINE void membrane_fast_copy(const weft__membrane *own, size_t b, const double *from,
                               double *to)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = mesh->particles, first = weft__block(mesh, b);
    const size_t count = weft__block(mesh, b + 1) - first;
    const uint32_t *halo = own->halo + own->blocks[b].halo;
    const size_t others = own->blocks[b + 1].halo - own->blocks[b].halo;
    for (size_t i = 0; i < count + others; ++i) {
        const double *x = from + (i < count ? first + i : halo[i - count]);
        *record_at(to, i) = (record){ x[0], x[n], x[2 * n], 0.0 };
    }
    *record_at(to, count + others) = (record){ 0.0, 0.0, 0.0, 0.0 };
}

/* Adds to v' of the block's particles; 0 or NaN. */
static vec add_own(const weft__mesh *mesh, size_t b, const double *force, double *to)
{
    const size_t n = mesh->particles, end = weft__block(mesh, b + 1);
    vec bad = splat(0.0);
    for (size_t i = weft__block(mesh, b); i < end;
         i += LANES, force += RECORD * LANES) {
        const size_t count = end - i < LANES ? end - i : LANES;
        const vec3 more = scaled(load(mesh->inverse_mass + i), collect(force, in_turn));
        const vec3 sums = plus(load3_some(to + i, n, count), more);
        store3_some(to + i, n, sums, count);
        for (size_t l = 0; l < count; ++l) {
            bad[l] += (sums.x[l] + sums.y[l] + sums.z[l]) * 0.0;
        }
    }
    return bad;
}

int NAME(membrane, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                          double *to, size_t first, size_t end)
{
    const weft__membrane *of = own;
    const weft__mesh *mesh = of->mesh;
    vec bad = splat(0.0);
    local in;
    int failed = 0;
    for (size_t b = first; b < end; ++b) {
        const size_t count = weft__block(mesh, b + 1) - weft__block(mesh, b)
                             + of->blocks[b + 1].halo - of->blocks[b].halo;
        if (count >= WEFT__NEAR) {
            failed |= weft__membrane_loops(own, at, unit, to, b, b + 1);
            continue;
        }
        membrane_fast_copy(of, b, at->y, in.x);
        memset(in.force, 0, (count + LANES) * RECORD * sizeof *in.force);
        if (of->damped) {
            membrane_fast_copy(of, b, at->y + 3 * mesh->particles, in.v);
            batches(of, b, &in, true);
        } else {
            batches(of, b, &in, false);
        }
        bad += add_own(mesh, b, in.force, to);
    }
    return sum(bad) == 0.0 ? failed : 1;
}
