/* SPDX-License-Identifier: BSD-3-Clause */
/* lanes.h -- LANES doubles at a time, by the vector extensions of GCC and Clang: the
 * same source for every width, in the instructions of the level that it is compiled
 * for. The compiler splits operations that the level does not have. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined __AVX__ /* a third of a second of the compiler's time */
#include <immintrin.h>
#elif defined __SSE2__
#include <emmintrin.h>
#endif

#ifndef LANES
#define LANES 2
#endif

/* The functions of a level have its name at their end. */
#ifndef LEVEL
#define LEVEL plain
#endif
#define NAME_(stem, level) weft__##stem##_##level
#define NAME(stem, level)  NAME_(stem, level)

#ifndef INLINE
#define INLINE static inline __attribute__((always_inline))
#endif

typedef double vec __attribute__((vector_size(8 * LANES)));
typedef int64_t mask __attribute__((vector_size(8 * LANES))); /* -1: yes, 0: no */
typedef double vec_anywhere
    __attribute__((vector_size(8 * LANES), aligned(8), may_alias));

/* x y z 0 of a particle, whatever LANES. */
typedef double record __attribute__((vector_size(32), may_alias));
#define ALL(a) ((record){ (a), (a), (a), (a) })

/* Vectors in space. */
typedef struct vec3 {
    vec x, y, z;
} vec3;

INLINE vec load(const double *from)
{
    return *(const vec_anywhere *)from;
}

INLINE void store(double *to, vec a)
{
    *(vec_anywhere *)to = a;
}

/* from[at[0]], from[at[1]], ...; at[i] >= 0. Four loads: on Zen 3 the instruction that
 * gathers four makes pushes take 1.4 times as long. */
INLINE vec gather(const double *from, const int32_t *at)
{
#if defined __AVX512F__ && LANES == 8
    return (vec)_mm512_i32gather_pd(
        _mm256_loadu_si256((const __m256i *)(const void *)at), from, 8);
#elif LANES == 4
    return (vec){ from[at[0]], from[at[1]], from[at[2]], from[at[3]] };
#else
    vec a = { 0 };
    for (int i = 0; i < LANES; ++i) {
        a[i] = from[at[i]];
    }
    return a;
#endif
}

/* to[i] = from[at[i]] */
INLINE void pick(const int32_t *from, const uint32_t at[LANES], int32_t to[LANES])
{
#if defined __AVX2__ && LANES == 8
    const __m256i i = _mm256_loadu_si256((const __m256i *)(const void *)at);
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_i32gather_epi32(from, i, 4));
#else
    for (int i = 0; i < LANES; ++i) {
        to[i] = from[at[i]];
    }
#endif
}

INLINE vec splat(double a)
{
    return a - (vec){ 0 };
}

INLINE vec only(vec a, mask where)
{
    return (vec)((mask)a & where);
}

/* a where it is set, else b. */
INLINE vec choose(mask where, vec a, vec b)
{
    return (vec)(((mask)a & where) | ((mask)b & ~where));
}

INLINE double sum(vec a)
{
    double total = 0.0;
    for (int i = 0; i < LANES; ++i) {
        total += a[i];
    }
    return total;
}

/* Correctly rounded, as a division is. */
INLINE vec root(vec a)
{
#if defined __AVX512F__ && LANES == 8
    return (vec)_mm512_sqrt_pd((__m512d)a);
#elif defined __AVX__ && LANES == 4
    return (vec)_mm256_sqrt_pd((__m256d)a);
#elif defined __SSE2__ && LANES == 2
    return (vec)_mm_sqrt_pd((__m128d)a);
#else
    for (int i = 0; i < LANES; ++i) {
        a[i] = sqrt(a[i]);
    }
    return a;
#endif
}

/* The smaller and the larger of two numbers, lane by lane; b if one is NaN. */
#if defined __AVX512F__ && LANES == 8
#define EXTREME(which, a, b) ((vec)_mm512_##which##_pd((__m512d)(a), (__m512d)(b)))
#elif defined __AVX__ && LANES == 4
#define EXTREME(which, a, b) ((vec)_mm256_##which##_pd((__m256d)(a), (__m256d)(b)))
#elif defined __SSE2__ && LANES == 2
#define EXTREME(which, a, b) ((vec)_mm_##which##_pd((__m128d)(a), (__m128d)(b)))
#else
#define min_first(a, b) ((a) < (b))
#define max_first(a, b) ((a) > (b))
#define EXTREME(which, a, b)                                                           \
    (only(a, which##_first(a, b)) + only(b, ~which##_first(a, b)))
#endif

INLINE vec least(vec a, vec b)
{
    return EXTREME(min, a, b);
}

INLINE vec most(vec a, vec b)
{
    return EXTREME(max, a, b);
}

/* Bit l: lane l is set. */
INLINE unsigned bits(mask a)
{
#if defined __AVX512DQ__ && LANES == 8
    return _mm512_movepi64_mask((__m512i)a);
#elif defined __AVX__ && LANES == 4
    return (unsigned)_mm256_movemask_pd((__m256d)a);
#elif defined __SSE2__ && LANES == 2
    return (unsigned)_mm_movemask_pd((__m128d)a);
#else
    unsigned found = 0;
    for (int i = 0; i < LANES; ++i) {
        found |= (unsigned)(a[i] & 1) << i;
    }
    return found;
#endif
}

INLINE bool any(mask a)
{
    return bits(a) != 0;
}

/* Lanes of a and then of b, by their numbers. */
#if defined __clang__ || __GNUC__ >= 12
#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SHUFFLE(a, b, ...) __builtin_shuffle(a, b, (mask){ __VA_ARGS__ })
#endif

/* SHIFT: the last lane, or the last two, of a, followed by the first lanes of b. NEXT:
 * a but for its first lane, or its first two, followed by the first lanes of b. */
#if LANES == 2
#define NEXT_1(a, b)  SHUFFLE(a, b, 1, 2)
#define NEXT_2(a, b)  SHUFFLE(a, b, 2, 3)
#define SHIFT_1(a, b) SHUFFLE(a, b, 1, 2)
#define SHIFT_2(a, b) SHUFFLE(a, b, 0, 1)
#elif LANES == 4
#define NEXT_1(a, b)  SHUFFLE(a, b, 1, 2, 3, 4)
#define NEXT_2(a, b)  SHUFFLE(a, b, 2, 3, 4, 5)
#define SHIFT_1(a, b) SHUFFLE(a, b, 3, 4, 5, 6)
#define SHIFT_2(a, b) SHUFFLE(a, b, 2, 3, 4, 5)
#elif LANES == 8
#define NEXT_1(a, b)  SHUFFLE(a, b, 1, 2, 3, 4, 5, 6, 7, 8)
#define NEXT_2(a, b)  SHUFFLE(a, b, 2, 3, 4, 5, 6, 7, 8, 9)
#define SHIFT_1(a, b) SHUFFLE(a, b, 7, 8, 9, 10, 11, 12, 13, 14)
#define SHIFT_2(a, b) SHUFFLE(a, b, 6, 7, 8, 9, 10, 11, 12, 13)
#endif

/* Of a row, the columns in whole blocks that two columns follow. */
INLINE size_t inner_columns(size_t cols)
{
    return cols < 2 ? 0 : (cols - 2) / LANES * LANES;
}

/* Which lanes of the block at column c are columns that `right` more follow. */
INLINE mask have_column(size_t c, size_t right, size_t cols)
{
    mask have = { 0 };
    for (size_t l = 0; l < LANES; ++l) {
        have[l] = c + l + right < cols ? -1 : 0;
    }
    return have;
}

INLINE vec3 load3(const double *from, size_t plane)
{
    return (vec3){ load(from), load(from + plane), load(from + 2 * plane) };
}

INLINE void set_lane(vec3 *a, size_t lane, const double *from, size_t plane)
{
    a->x[lane] = from[0];
    a->y[lane] = from[plane];
    a->z[lane] = from[2 * plane];
}

/* The first `count` lanes; 0 in the others. */
INLINE vec3 load3_some(const double *from, size_t plane, size_t count)
{
    if (count == LANES) { /* before zeros are written for the others */
        return load3(from, plane);
    }
    vec3 a = { 0 };
    for (size_t i = 0; i < count; ++i) {
        set_lane(&a, i, from + i, plane);
    }
    return a;
}

INLINE void store3(double *to, size_t plane, vec3 a)
{
    store(to, a.x);
    store(to + plane, a.y);
    store(to + 2 * plane, a.z);
}

/* The first `count` lanes. */
INLINE void store3_some(double *to, size_t plane, vec3 a, size_t count)
{
    if (count == LANES) {
        store3(to, plane, a);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        to[i] = a.x[i];
        to[plane + i] = a.y[i];
        to[2 * plane + i] = a.z[i];
    }
}

INLINE vec3 plus(vec3 a, vec3 b)
{
    return (vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

INLINE vec3 minus(vec3 a, vec3 b)
{
    return (vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

INLINE vec3 scaled(vec a, vec3 b)
{
    return (vec3){ a * b.x, a * b.y, a * b.z };
}

INLINE vec dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

INLINE vec3 only3(vec3 a, mask where)
{
    return (vec3){ only(a.x, where), only(a.y, where), only(a.z, where) };
}

INLINE vec3 shift_1(vec3 a, vec3 b)
{
    return (vec3){ SHIFT_1(a.x, b.x), SHIFT_1(a.y, b.y), SHIFT_1(a.z, b.z) };
}

INLINE vec3 shift_2(vec3 a, vec3 b)
{
    return (vec3){ SHIFT_2(a.x, b.x), SHIFT_2(a.y, b.y), SHIFT_2(a.z, b.z) };
}

/* 0 where both are finite, else NaN, or where a sum of all would overflow. */
INLINE vec trouble(vec3 a, vec3 b)
{
    return (((a.x + a.y) + a.z) + ((b.x + b.y) + b.z)) * 0.0;
}
