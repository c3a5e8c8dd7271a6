/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_self.c -- contact of a cloth with itself, LANES pairs of one kind at a time:
 * the law of cloth/self_law.h. Pairs that push are found first, then their forces fill
 * all lanes. */
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

/* Three planes of the particles of LANES pairs. */
INLINE void place(const double *planes, size_t n, weft__pair_kind kind,
                  const int32_t *const at[4], vec x[4][3])
{
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        x[j][0] = gather(planes, at[j]);
        x[j][1] = gather(planes + n, at[j]);
        x[j][2] = gather(planes + 2 * n, at[j]);
    }
}

/* ---- forces ---------------------------------------------------------------------- */

typedef struct work {
    const weft__self_law *law;
    const weft__near *near;
    const double *y;
    weft__pushes *out;
    vec bad;
} work;

/* Writes which of LANES pairs from i on push; returns how many. */
INLINE size_t find(const work *of, weft__pair_kind kind, size_t i, uint32_t *found)
{
    const weft_cloth *cloth = of->law->cloth;
    const int32_t *at[4];
    vec x[4][3];
    size_t count = 0;
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        at[j] = of->near->particle[j] + i;
    }
    place(of->y, cloth->particles, kind, at, x);
    const law_gram gram = law_gram_of(kind, x);
    const mask pushes = law_pushes(kind, &gram, cloth->contact.thickness);
    for (size_t l = 0; any(pushes) && l < LANES; ++l) {
        found[count] = (uint32_t)(i + l);
        count += pushes[l] != 0 && i + l < of->near->count;
    }
    return count;
}

INLINE void write_pushes(weft__pair_kind kind, const law_feet *feet,
                         const law_push *push, size_t l, weft__pushes *to)
{
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        for (size_t k = 0; k < 3; ++k) {
            store(&to->force[j][k][l], push->force[j][k]);
        }
    }
    store(&to->gap[l], feet->d), store(&to->energy[l], push->energy);
    store(&to->heat[l], push->heat), store(&to->friction[l], push->friction);
}

/* The LANES pairs of `found` are pushes i, i + 1, ... */
INLINE void push(work *of, weft__pair_kind kind, const uint32_t *found, size_t i)
{
    const weft_cloth *cloth = of->law->cloth;
    const weft_contact_def contact = cloth->contact;
    weft__pushes *to = &of->out[i / WEFT__BLOCK];
    const size_t n = cloth->particles;
    const int32_t *at[4];
    int32_t particle[4][LANES];
    vec x[4][3], v[4][3], mass = splat(0.0), rest = splat(0.0);
    law_push out;
    for (size_t l = 0; l < LANES; ++l) {
        const size_t pair = to->at[i % WEFT__BLOCK + l] = found[l];
        for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
            particle[j][l] = of->near->particle[j][pair];
            at[j] = particle[j];
        }
        mass[l] = of->near->mass[pair];
        rest[l] = kind == WEFT__EDGES ? of->near->rest[pair] : 0.0;
    }
    place(of->y, n, kind, at, x);
    place(of->y + 3 * n, n, kind, at, v);
    const law_gram gram = law_gram_of(kind, x);
    law_feet feet = law_feet_of(kind, &gram);
    law_weigh(kind, of->law->soft, rest, &feet);
    law_push_of(kind, &contact, &feet, mass, v, &out);
    write_pushes(kind, &feet, &out, i % WEFT__BLOCK, to);
    for (size_t k = 0; k < 3 * weft__kind_particles(kind); ++k) {
        of->bad += out.force[k / 3][k % 3] * 0.0;
    }
}

INLINE size_t push_kind(work *of, weft__pair_kind kind)
{
    enum { STRETCH = 128 };
    uint32_t found[STRETCH + 2 * LANES];
    size_t held = 0, done = 0;
    for (size_t i = 0; i < of->near->count; i += LANES) {
        held += find(of, kind, i, found + held);
        size_t taken = 0;
        for (; held >= STRETCH && taken + LANES <= held; taken += LANES) {
            push(of, kind, found + taken, done + taken);
        }
        for (size_t l = taken; taken > 0 && l < held; ++l) {
            found[l - taken] = found[l];
        }
        done += taken, held -= taken;
    }
    for (size_t l = 0; l < LANES && held > 0; ++l) { /* the last one fills the lanes */
        found[held + l] = found[held - 1];
    }
    for (size_t taken = 0; taken < held; taken += LANES) {
        push(of, kind, found + taken, done + taken);
    }
    return done + held;
}

#define PUSH(kind)                                                                     \
    static size_t push_##kind(work *of)                                                \
    {                                                                                  \
        return push_kind(of, kind);                                                    \
    }
EACH_KIND(PUSH)
#undef PUSH

size_t NAME(pushes, LEVEL)(const weft__self_law *law, weft__pair_kind kind,
                           const weft__near *near, const double *y, weft__pushes *out,
                           double *bad)
{
    static size_t (*const each[])(work *)
        = { push_WEFT__VERTICES, push_WEFT__VERTEX_EDGE, push_WEFT__VERTEX_TRIANGLE,
            push_WEFT__EDGES };
    work of = { law, near, y, out, splat(0.0) };
    const size_t count = each[kind](&of);
    *bad += sum(of.bad);
    return count;
}

/* ---- distances ------------------------------------------------------------------- */

typedef struct waiting {
    const weft_cloth *cloth;
    const weft__quad *pairs;
    size_t count;
    const double *y;
    double most;
    double *distances, *waits;
} waiting;

INLINE void wait_kind(const waiting *of, weft__pair_kind kind)
{
    for (size_t i = 0; i < of->count; i += LANES) {
        int32_t particle[4][LANES];
        const int32_t *at[4];
        vec x[4][3];
        for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
            at[j] = particle[j];
            for (size_t l = 0; l < LANES; ++l) {
                const size_t last = of->count - 1, pair = i + l < last ? i + l : last;
                particle[j][l] = (int32_t)of->pairs[pair].of[j];
            }
        }
        place(of->y, of->cloth->particles, kind, at, x);
        const vec distance = law_distance(kind, x);
        const vec wait
            = law_wait(kind, x, distance, of->cloth->contact.thickness, of->most);
        for (size_t l = 0; l < LANES && i + l < of->count; ++l) {
            of->distances[i + l] = distance[l], of->waits[i + l] = wait[l];
        }
    }
}

#define WAIT(kind)                                                                     \
    static void wait_##kind(const waiting *of)                                         \
    {                                                                                  \
        wait_kind(of, kind);                                                           \
    }
EACH_KIND(WAIT)
#undef WAIT

void NAME(waits, LEVEL)(const weft_cloth *cloth, weft__pair_kind kind,
                        const weft__quad *pairs, size_t count, const double *y,
                        double most, double *distances, double *waits)
{
    static void (*const each[])(const waiting *)
        = { wait_WEFT__VERTICES, wait_WEFT__VERTEX_EDGE, wait_WEFT__VERTEX_TRIANGLE,
            wait_WEFT__EDGES };
    const waiting of = { cloth, pairs, count, y, most, distances, waits };
    each[kind](&of);
}

/* ---- bounds ---------------------------------------------------------------------- */

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

/* Lane by lane for all planes, which do not wait for each other. */
INLINE void narrow(const run_bounds of[3], weft__drift *to)
{
    for (size_t k = 0; k < 3; ++k) {
        to->low[k] = of[k].low[0], to->high[k] = of[k].high[0];
    }
    for (size_t l = 1; l < LANES; ++l) {
        for (size_t k = 0; k < 3; ++k) {
            to->low[k] = of[k].low[l] < to->low[k] ? of[k].low[l] : to->low[k];
            to->high[k] = of[k].high[l] > to->high[k] ? of[k].high[l] : to->high[k];
        }
    }
}

/* A product with 0 is NaN for a number that is not finite. */
double NAME(extent, LEVEL)(const double *from, const double *to, size_t n)
{
    weft__drift all;
    run_bounds of[3];
    vec trouble = splat(0.0);
    if (n < LANES) {
        return weft__reference_extent(from, to, n);
    }
    for (size_t k = 0; k < 3; ++k) {
        of[k] = no_bounds();
        add_run(from, to, k * n, (k + 1) * n, &of[k], &trouble);
    }
    narrow(of, &all);
    return sum(trouble) == 0.0 ? weft__drift_extent(&all, &all) : (double)INFINITY;
}

double NAME(drift, LEVEL)(const weft_cloth *cloth, const double *from, const double *to,
                          weft__drift *tiles)
{
    const size_t n = cloth->particles, cols = cloth->cols;
    const size_t level = weft__tile_level(cloth);
    const double inf = INFINITY;
    weft__drift all = { { inf, inf, inf }, { -inf, -inf, -inf } };
    vec trouble = splat(0.0);
    if (cols < LANES) {
        return weft__reference_drift(cloth, from, to, tiles);
    }
    for (size_t i = 0; i < weft__tile_count(cloth); ++i) {
        size_t in[4];
        weft__patch_range(cloth, level, i, in);
        run_bounds of[3];
        for (size_t k = 0; k < 3; ++k) {
            of[k] = no_bounds();
            const size_t first = in[2] + LANES <= in[3] ? in[2]
                                 : in[3] > LANES        ? in[3] - LANES
                                                        : 0;
            for (size_t r = in[0]; r < in[1]; ++r) {
                const size_t at = k * n + r * cols;
                add_run(from, to, at + first, at + (in[3] < LANES ? LANES : in[3]),
                        &of[k], &trouble);
            }
        }
        narrow(of, &tiles[i]);
        weft__drift_add(&all, &tiles[i]);
    }
    return sum(trouble) == 0.0 ? weft__drift_extent(&all, &all) : inf;
}
