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

/* Pairs of a chunk, by kind: their places in it and their particles. */
typedef struct sorted {
    size_t count[KINDS];
    uint16_t at[KINDS][WEFT__PAIRS_MOST + LANES];
    int32_t particle[KINDS][4][WEFT__PAIRS_MOST + LANES];
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

/* Sets the particles of the pairs of a kind, and those of the last one once more, so
 * that all lanes have one. */
INLINE void fill(const chunk *of, weft__pair_kind kind, sorted *to)
{
    const size_t count = to->count[kind];
    for (size_t l = 0; l < LANES && count > 0; ++l) {
        to->at[kind][count + l] = to->at[kind][count - 1];
    }
    for (size_t i = 0; count > 0 && i < count + LANES; ++i) {
        for (size_t j = 0; j < particles_of(kind); ++j) {
            to->particle[kind][j][i] = (int32_t)of->pairs[to->at[kind][i]].particle[j];
        }
    }
}

/* The smallest mass of the free particles; infinite without. */
INLINE vec least_mass(const chunk *of, weft__pair_kind kind, const sorted *by, size_t i)
{
    const weft_cloth *cloth = of->law->cloth;
    const vec none = splat((double)INFINITY);
    vec mass = none;
    for (size_t j = 0; j < particles_of(kind); ++j) {
        const int32_t *at = &by->particle[kind][j][i];
        const mask is_free = gather(cloth->inverse_mass, at) > 0.0;
        mass = least(mass, choose(is_free, gather(cloth->mass, at), none));
    }
    return mass;
}

/* Three planes of the particles of LANES pairs from i on. */
INLINE void place(const chunk *of, weft__pair_kind kind, const sorted *by, size_t i,
                  const double *planes, vec x[4][3])
{
    const size_t n = of->law->cloth->particles;
    for (size_t j = 0; j < particles_of(kind); ++j) {
        for (size_t k = 0; k < 3; ++k) {
            x[j][k] = gather(planes + k * n, &by->particle[kind][j][i]);
        }
    }
}

/* Marks those that push among the near ones. */
INLINE void find_kind(const chunk *of, weft__pair_kind kind, sorted *near,
                      unsigned char *pushes)
{
    const weft_cloth *cloth = of->law->cloth;
    const double thickness = cloth->contact.thickness;
    const uint16_t *at = near->at[kind];
    fill(of, kind, near);
    for (size_t i = 0; i < near->count[kind]; i += LANES) {
        vec x[4][3];
        law_feet feet;
        place(of, kind, near, i, of->y, x);
        mask found = law_find(kind, x, thickness, &feet);
        if (any(found)) {
            found &= least_mass(of, kind, near, i) < (double)INFINITY;
        }
        for (size_t l = 0; any(found) && l < LANES; ++l) {
            pushes[at[i + l]] = found[l] != 0;
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
    const uint16_t *at = found->at[kind];
    fill(of, kind, found);
    for (size_t i = 0; i < found->count[kind]; i += LANES) {
        vec x[4][3], v[4][3], rest = splat(0.0);
        law_feet feet;
        law_push push;
        place(of, kind, found, i, of->y, x);
        place(of, kind, found, i, of->y + 3 * cloth->particles, v);
        for (size_t l = 0; kind == WEFT__EDGES && l < LANES; ++l) {
            rest[l] = weft__pair_rest(of->law, &of->pairs[at[i + l]]);
        }
        (void)law_find(kind, x, contact.thickness, &feet);
        law_weigh(kind, of->law->soft, rest, &feet);
        law_push_of(kind, &contact, &feet, least_mass(of, kind, found, i), v, &push);
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
                           const double *distances, size_t count, const double *reach,
                           const double *y, weft__push *out)
{
    const chunk of = { law, pairs, y, out };
    unsigned char pushes[WEFT__PAIRS_MOST];
    uint16_t slots[WEFT__PAIRS_MOST];
    sorted by;
    size_t found = 0;
    by.count[0] = by.count[1] = by.count[2] = by.count[3] = 0;
    for (size_t i = 0; i < count; ++i) {
        pushes[i] = 0;
        const uint32_t kind = pairs[i].kind;
        by.at[kind][by.count[kind]] = (uint16_t)i;
        by.count[kind] += distances[i] <= reach[pairs[i].group];
    }
#define CALL(kind) find_##kind(&of, &by, pushes);
    EACH_KIND(CALL)
#undef CALL
    for (size_t kind = 0; kind < KINDS; ++kind) {
        by.count[kind] = 0;
    }
    for (size_t i = 0; i < count; ++i) {
        slots[i] = (uint16_t)found;
        const uint32_t kind = pairs[i].kind;
        by.at[kind][by.count[kind]] = (uint16_t)i;
        by.count[kind] += pushes[i];
        found += pushes[i];
    }
#define CALL(kind) push_##kind(&of, &by, slots);
    EACH_KIND(CALL)
#undef CALL
    return found;
}

/* Of a plane, as long as they hold no NaN. */
typedef struct run_bounds {
    vec low, high;
} run_bounds;

/* Adds `count` numbers; or some before them where the last lanes are beyond. */
INLINE void add_run(const double *from, const double *to, size_t first, size_t end,
                    run_bounds *sum, vec *trouble)
{
    for (size_t i = first; i < end; i += LANES) {
        const size_t at = i + LANES <= end ? i : end - LANES;
        const vec d = from != NULL ? load(to + at) - load(from + at) : load(to + at);
        sum->low = least(sum->low, d), sum->high = most(sum->high, d);
        *trouble += d * 0.0;
    }
}

INLINE run_bounds no_bounds(void)
{
    return (run_bounds){ splat((double)INFINITY), splat(-(double)INFINITY) };
}

INLINE void narrow(const run_bounds *of, double *low, double *high)
{
    *low = of->low[0], *high = of->high[0];
    for (size_t l = 1; l < LANES; ++l) {
        *low = of->low[l] < *low ? of->low[l] : *low;
        *high = of->high[l] > *high ? of->high[l] : *high;
    }
}

/* A product with 0 is NaN for a number that is not finite. */
double NAME(extent, LEVEL)(const double *from, const double *to, size_t n)
{
    weft__drift all;
    vec trouble = splat(0.0);
    if (n < LANES) {
        return weft__reference_extent(from, to, n);
    }
    for (size_t k = 0; k < 3; ++k) {
        run_bounds of = no_bounds();
        add_run(from, to, k * n, (k + 1) * n, &of, &trouble);
        narrow(&of, &all.low[k], &all.high[k]);
    }
    return sum(trouble) == 0.0 ? weft__drift_extent(&all, &all) : (double)INFINITY;
}

double NAME(drift, LEVEL)(const weft_cloth *cloth, const double *from, const double *to,
                          weft__drift *tiles)
{
    const size_t n = cloth->particles, cols = cloth->cols;
    const double inf = INFINITY;
    weft__drift all = { { inf, inf, inf }, { -inf, -inf, -inf } };
    vec trouble = splat(0.0);
    if (cols < LANES) {
        return weft__reference_drift(cloth, from, to, tiles);
    }
    for (size_t i = 0; i < weft__tile_count(cloth); ++i) {
        size_t in[4];
        weft__tile_range(cloth, i, in);
        for (size_t k = 0; k < 3; ++k) {
            run_bounds of = no_bounds();
            const size_t first = in[2] + LANES <= in[3] ? in[2]
                                 : in[3] > LANES        ? in[3] - LANES
                                                        : 0;
            for (size_t r = in[0]; r < in[1]; ++r) {
                const size_t at = k * n + r * cols;
                add_run(from, to, at + first, at + (in[3] < LANES ? LANES : in[3]), &of,
                        &trouble);
            }
            narrow(&of, &tiles[i].low[k], &tiles[i].high[k]);
        }
        weft__drift_add(&all, &tiles[i]);
    }
    return sum(trouble) == 0.0 ? weft__drift_extent(&all, &all) : inf;
}
