/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_fast.c -- the membrane of membrane.h, LANES triangles at a time. A block's
 * own particles and those of its halo lie as records x, y, z, 0 in the first cache;
 * forces are summed in such records, and those of the halo thrown away. */
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

/* Numbers of particles that follow one another. */
static const uint16_t in_turn[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };

#if LANES >= 4
typedef double record __attribute__((vector_size(32), may_alias));

INLINE record *record_at(double *of, size_t i)
{
    return (record *)(void *)(of + RECORD * i);
}

INLINE record record_of(const double *of, size_t i)
{
    return *(const record *)(const void *)(of + RECORD * i);
}
#endif

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

/* The records at[0], at[1], ... */
INLINE vec3 collect(const double *of, const uint16_t at[LANES])
{
#if LANES == 8
#define TWO(i, j) JOIN(record_of(of, at[i]), record_of(of, at[j]))
    const vec a = TWO(0, 2), b = TWO(1, 3), c = TWO(4, 6), d = TWO(5, 7);
    const vec xz = SHUFFLE(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec XZ = SHUFFLE(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec y = SHUFFLE(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec Y = SHUFFLE(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return (vec3){ SHUFFLE(xz, XZ, 0, 1, 4, 5, 8, 9, 12, 13),
                   SHUFFLE(y, Y, 0, 1, 4, 5, 8, 9, 12, 13),
                   SHUFFLE(xz, XZ, 2, 3, 6, 7, 10, 11, 14, 15) };
#elif LANES == 4
    const vec a = record_of(of, at[0]), b = record_of(of, at[1]);
    const vec c = record_of(of, at[2]), d = record_of(of, at[3]);
    const vec xz = SHUFFLE(a, b, 0, 4, 2, 6), XZ = SHUFFLE(c, d, 0, 4, 2, 6);
    const vec y = SHUFFLE(a, b, 1, 5, 3, 7), Y = SHUFFLE(c, d, 1, 5, 3, 7);
    return (vec3){ SHUFFLE(xz, XZ, 0, 1, 4, 5), SHUFFLE(y, Y, 0, 1, 4, 5),
                   SHUFFLE(xz, XZ, 2, 3, 6, 7) };
#else
    const double *a = of + (size_t)RECORD * at[0], *b = of + (size_t)RECORD * at[1];
    return (vec3){ { a[0], b[0] }, { a[1], b[1] }, { a[2], b[2] } };
#endif
}

#if LANES >= 4
/* The lanes of a as records. */
INLINE void part(vec3 a, record to[LANES])
{
    const vec none = { 0 };
#if LANES == 8
    const vec xy = SHUFFLE(a.x, a.y, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec XY = SHUFFLE(a.x, a.y, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec z = SHUFFLE(a.z, none, 0, 8, 2, 10, 4, 12, 6, 14);
    const vec Z = SHUFFLE(a.z, none, 1, 9, 3, 11, 5, 13, 7, 15);
    const vec low[2] = { SHUFFLE(xy, z, 0, 1, 8, 9, 2, 3, 10, 11),
                         SHUFFLE(XY, Z, 0, 1, 8, 9, 2, 3, 10, 11) };
    const vec high[2] = { SHUFFLE(xy, z, 4, 5, 12, 13, 6, 7, 14, 15),
                          SHUFFLE(XY, Z, 4, 5, 12, 13, 6, 7, 14, 15) };
    for (size_t odd = 0; odd < 2; ++odd) {
        to[odd] = HALF(low[odd], 0);
        to[odd + 2] = HALF(low[odd], 1);
        to[odd + 4] = HALF(high[odd], 0);
        to[odd + 6] = HALF(high[odd], 1);
    }
#else
    const vec xy = SHUFFLE(a.x, a.y, 0, 4, 2, 6), XY = SHUFFLE(a.x, a.y, 1, 5, 3, 7);
    const vec z = SHUFFLE(a.z, none, 0, 4, 2, 6), Z = SHUFFLE(a.z, none, 1, 5, 3, 7);
    to[0] = SHUFFLE(xy, z, 0, 1, 4, 5), to[1] = SHUFFLE(XY, Z, 0, 1, 4, 5);
    to[2] = SHUFFLE(xy, z, 2, 3, 6, 7), to[3] = SHUFFLE(XY, Z, 2, 3, 6, 7);
#endif
}
#endif

/* Adds the lanes of a to the records at[0], at[1], ..., of which none is twice. */
INLINE void spread(double *to, const uint16_t at[LANES], vec3 a)
{
#if LANES >= 4
    record parts[LANES];
    part(a, parts);
    for (size_t l = 0; l < LANES; ++l) {
        *record_at(to, at[l]) += parts[l];
    }
#else
    for (size_t l = 0; l < LANES; ++l) {
        double *sum = to + (size_t)RECORD * at[l];
        sum[0] += a.x[l], sum[1] += a.y[l], sum[2] += a.z[l];
    }
#endif
}

/* ---- a batch --------------------------------------------------------------------- */

INLINE void edges(const double *of, const uint16_t *at, vec3 d[3])
{
    const vec3 a = collect(of, at), b = collect(of, at + WEFT__WIDTH),
               c = collect(of, at + 2 * WEFT__WIDTH);
    d[0] = minus(c, b), d[1] = minus(a, c), d[2] = minus(b, a);
}

/* of: the constants, at: the corners, from a lane on */
INLINE void batch(const double *of, const uint16_t *at, local *in, bool damped)
{
    vec3 d[3], w[3], pull[3];
    vec square[3], q[3], s[3];
    edges(in->x, at, d);
    if (damped) {
        edges(in->v, at, w);
    }
    for (int i = 0; i < 3; ++i) {
        square[i] = dot(d[i], d[i]);
        q[i] = square[i] - CONSTANT(of, WEFT__SQUARE + i);
        if (damped) {
            q[i] = q[i] + CONSTANT(of, WEFT__LAG) * dot(d[i], w[i]);
        }
    }
    law_pull(of, square, q, s);
    for (int i = 0; i < 3; ++i) {
        pull[i] = scaled(s[i], d[i]);
    }
    spread(in->force, at, minus(pull[2], pull[1]));
    spread(in->force, at + WEFT__WIDTH, minus(pull[0], pull[2]));
    spread(in->force, at + 2 * WEFT__WIDTH, minus(pull[1], pull[0]));
}

INLINE void batches(const weft__membrane *own, size_t b, local *in, bool damped)
{
    for (size_t g = own->blocks[b].batch; g < own->blocks[b + 1].batch; ++g) {
        const double *of = own->batches[g].of;
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

INLINE void set_record(double *to, const double *x, size_t n)
{
    to[0] = x[0], to[1] = x[n], to[2] = x[2 * n], to[3] = 0.0;
}

/* Three planes of the particles of a block and of its halo as records, and one of
 * zeros. */
INLINE void copy(const weft__membrane *own, size_t b, const double *from, double *to)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = mesh->particles, first = weft__block(mesh, b);
    const size_t count = weft__block(mesh, b + 1) - first;
    const uint32_t *halo = own->halo + own->blocks[b].halo;
    const size_t others = own->blocks[b + 1].halo - own->blocks[b].halo;
    size_t i = 0;
#if LANES >= 4
    for (; i + LANES <= count; i += LANES) {
        record parts[LANES];
        part(load3(from + first + i, n), parts);
        for (size_t l = 0; l < LANES; ++l) {
            *record_at(to, i + l) = parts[l];
        }
    }
#endif
    for (; i < count; ++i) {
        set_record(to + RECORD * i, from + first + i, n);
    }
    for (size_t j = 0; j < others; ++j, ++i) {
        set_record(to + RECORD * i, from + halo[j], n);
    }
    memset(to + RECORD * i, 0, RECORD * sizeof *to);
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
        copy(of, b, at->y, in.x);
        memset(in.force, 0, (count + LANES) * RECORD * sizeof *in.force);
        if (of->damped) {
            copy(of, b, at->y + 3 * mesh->particles, in.v);
            batches(of, b, &in, true);
        } else {
            batches(of, b, &in, false);
        }
        bad += add_own(mesh, b, in.force, to);
    }
    return sum(bad) == 0.0 ? failed : 1;
}
