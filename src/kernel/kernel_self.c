/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_self.c -- contact of a cloth with itself, LANES pairs at a time: the law of
 * cloth/self_law.h. Pairs are taken kind by kind: first those whose feet are inside and
 * near are found, then their forces go to the places that they have in the order of the
 * list. */
#include "cloth/levels.h"
#include "kernel/lanes.h"

typedef vec num;
typedef mask truth;
#define NUM(a)          splat(a)
#define ROOT(a)         root(a)
#define CHOOSE(t, a, b) choose(t, a, b)
#define LAW             INLINE

INLINE vec choose(mask where, vec a, vec b)
{
    return (vec)(((mask)a & where) | ((mask)b & ~where));
}

#include "cloth/self_law.h"

enum { KINDS = WEFT__EDGES + 1 };

/* Pairs of a chunk, by kind: their places in it. */
typedef struct sorted {
    size_t count[KINDS];
    uint16_t at[KINDS][WEFT__PAIRS_MOST + LANES];
} sorted;

typedef struct chunk {
    const weft__self_law *law;
    const weft__pair *pairs;
    const double *y;
    weft__push *out;
} chunk;

INLINE size_t particles_of(weft__pair_kind kind)
{
    return kind == WEFT__VERTICES ? 2 : kind == WEFT__VERTEX_EDGE ? 3 : 4;
}

/* Three planes of the particles of LANES pairs. */
INLINE void place(const chunk *of, weft__pair_kind kind, const uint16_t *at,
                  const double *planes, vec x[4][3])
{
    const size_t n = of->law->cloth->particles;
    for (size_t i = 0; i < particles_of(kind); ++i) {
        for (size_t l = 0; l < LANES; ++l) {
            const double *from = planes + of->pairs[at[l]].particle[i];
            x[i][0][l] = from[0], x[i][1][l] = from[n], x[i][2][l] = from[2 * n];
        }
    }
}

/* The last pair again, so that all lanes have one. */
INLINE void fill(uint16_t *at, size_t count)
{
    for (size_t l = 0; l < LANES && count > 0; ++l) {
        at[count + l] = at[count - 1];
    }
}

/* Marks those that push among the near ones. */
INLINE void find_kind(const chunk *of, weft__pair_kind kind, sorted *near,
                      unsigned char *pushes)
{
    const weft_cloth *cloth = of->law->cloth;
    const double thickness = cloth->contact.thickness;
    uint16_t *at = near->at[kind];
    fill(at, near->count[kind]);
    for (size_t i = 0; i < near->count[kind]; i += LANES) {
        vec x[4][3];
        law_feet feet;
        place(of, kind, at + i, of->y, x);
        const mask found = law_find(kind, x, thickness, &feet);
        for (size_t l = 0; any(found) && l < LANES; ++l) {
            if (found[l] != 0) {
                pushes[at[i + l]] = weft__pair_mass(cloth, &of->pairs[at[i + l]]) > 0.0;
            }
        }
    }
}

INLINE void write_push(const weft__pair *pair, weft__pair_kind kind,
                       const law_feet *feet, const law_push *push, size_t l,
                       weft__push *to)
{
    for (size_t i = 0; i < particles_of(kind); ++i) {
        for (size_t k = 0; k < 3; ++k) {
            to->force[i][k] = push->force[i][k][l];
        }
    }
    for (size_t i = 0; i < 4; ++i) {
        to->particle[i] = pair->particle[i];
    }
    to->count = (uint32_t)particles_of(kind), to->kind = kind;
    to->gap = feet->d[l];
    to->energy = push->energy[l];
    to->heat = push->heat[l], to->friction = push->friction[l];
}

/* slots: where the pushes go */
INLINE void push_kind(const chunk *of, weft__pair_kind kind, sorted *found,
                      const uint16_t *slots)
{
    const weft_cloth *cloth = of->law->cloth;
    const weft_contact_def contact = cloth->contact;
    uint16_t *at = found->at[kind];
    fill(at, found->count[kind]);
    for (size_t i = 0; i < found->count[kind]; i += LANES) {
        vec x[4][3], v[4][3], rest = splat(0.0), mass = splat(0.0);
        law_feet feet;
        law_push push;
        place(of, kind, at + i, of->y, x);
        place(of, kind, at + i, of->y + 3 * cloth->particles, v);
        for (size_t l = 0; l < LANES; ++l) {
            rest[l] = weft__pair_rest(of->law, &of->pairs[at[i + l]]);
            mass[l] = weft__pair_mass(cloth, &of->pairs[at[i + l]]);
        }
        (void)law_find(kind, x, contact.thickness, &feet);
        law_weigh(kind, of->law->soft, rest, &feet);
        law_push_of(kind, &contact, &feet, mass, v, &push);
        for (size_t l = 0; l < LANES && i + l < found->count[kind]; ++l) {
            write_push(&of->pairs[at[i + l]], kind, &feet, &push, l,
                       &of->out[slots[at[i + l]]]);
        }
    }
}

/* One function for each kind, which is a constant in it. */
#define EACH_KIND(X)                                                                   \
    X(WEFT__VERTICES) X(WEFT__VERTEX_EDGE) X(WEFT__VERTEX_TRIANGLE) X(WEFT__EDGES)

#define FIND(kind)                                                                     \
    static void find_##kind(const chunk *of, sorted *near, unsigned char *pushes)      \
    {                                                                                  \
        find_kind(of, kind, near, pushes);                                             \
    }                                                                                  \
    static void push_##kind(const chunk *of, sorted *found, const uint16_t *slots)     \
    {                                                                                  \
        push_kind(of, kind, found, slots);                                             \
    }
EACH_KIND(FIND)

size_t NAME(pushes, LEVEL)(const weft__self_law *law, const weft__pair *pairs,
                           const double *distances, size_t count, double near,
                           const double *y, weft__push *out)
{
    const chunk of = { law, pairs, y, out };
    unsigned char pushes[WEFT__PAIRS_MOST];
    uint16_t slots[WEFT__PAIRS_MOST];
    sorted by = { .count = { 0 } };
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t kind = pairs[i].kind;
        pushes[i] = 0;
        by.at[kind][by.count[kind]] = (uint16_t)i;
        by.count[kind] += distances[i] <= near;
    }
#define CALL(kind) find_##kind(&of, &by, pushes);
    EACH_KIND(CALL)
#undef CALL
    for (size_t kind = 0; kind < KINDS; ++kind) {
        by.count[kind] = 0;
    }
    for (size_t i = 0; i < count; ++i) {
        const uint32_t kind = pairs[i].kind;
        slots[i] = (uint16_t)found;
        by.at[kind][by.count[kind]] = (uint16_t)i;
        by.count[kind] += pushes[i];
        found += pushes[i];
    }
#define CALL(kind) push_##kind(&of, &by, slots);
    EACH_KIND(CALL)
#undef CALL
    return found;
}

/* A product with 0 is NaN for a number that is not finite. */
double NAME(extent, LEVEL)(const double *from, const double *to, size_t n)
{
    double square = 0.0;
    if (n < LANES) {
        return weft__reference_extent(from, to, n);
    }
    for (size_t k = 0; k < 3; ++k) {
        vec low = splat((double)INFINITY), high = -low, zero = splat(0.0);
        for (size_t i = 0; i < n; i += LANES) {
            const size_t at = k * n + (i + LANES <= n ? i : n - LANES);
            const vec d
                = from != NULL ? load(to + at) - load(from + at) : load(to + at);
            low = least(low, d), high = most(high, d);
            zero += d * 0.0;
        }
        double a = low[0], b = high[0];
        for (size_t l = 1; l < LANES; ++l) {
            a = low[l] < a ? low[l] : a;
            b = high[l] > b ? high[l] : b;
        }
        square += sum(zero) == 0.0 ? (b - a) * (b - a) : (double)INFINITY;
    }
    return sqrt(square);
}
