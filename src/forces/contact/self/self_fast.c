/* SPDX-License-Identifier: BSD-3-Clause */
/* self_fast.c -- contact of a cloth with itself, LANES pairs of one kind at a time:
 * the law of cloth/self_law.h. Pairs that pushed in the last evaluation are taken to do
 * so again, and others are found; then their forces fill all lanes. */
#include <string.h>

#include "forces/lanes.h"

#define LAW_OF_LANES
#include "forces/contact/self/self_law.h"

/* Three planes of the particles of LANES pairs. */
INLINE void gather_points(const double *planes, size_t n, weft__pair_kind kind,
                          int32_t at[4][LANES], vec x[4][3])
{
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        x[j][0] = gather(planes, at[j]);
        x[j][1] = gather(planes + n, at[j]);
        x[j][2] = gather(planes + 2 * n, at[j]);
    }
}

/* The particles of pairs. */
INLINE void particles_of(const weft__near *near, weft__pair_kind kind,
                         const uint32_t pairs[LANES], int32_t at[4][LANES])
{
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        pick(near->particle[j], pairs, at[j]);
    }
}

/* ---- forces ---------------------------------------------------------------------- */

/* Pairs by their numbers. */
enum { STRETCH = 512 };
typedef struct queue {
    uint32_t at[STRETCH + 3 * LANES];
    size_t count;
} queue;

typedef struct work {
    const weft__self_law *law;
    const weft__near *near;
    const weft__pair_subset *subsets;
    size_t subset_count;
    const double *y;
    weft__pushes *out;
    size_t subset, next, done; /* next: pair, in `subset` */
    vec bad;
    queue close, found; /* those that may have begun to push, and those that push */
} work;

/* The last one fills the lanes. */
INLINE void self_fast_fill(queue *of)
{
    for (size_t l = 0; l < LANES && of->count > 0; ++l) {
        of->at[of->count + l] = of->at[of->count - 1];
    }
}

#if !(defined __AVX512VL__ && LANES == 8)
/* The bits that are set of four, and their number. */
static const uint32_t bits_of[16][5]
    = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 1 }, { 1, 0, 0, 0, 1 }, { 0, 1, 0, 0, 2 },
        { 2, 0, 0, 0, 1 }, { 0, 2, 0, 0, 2 }, { 1, 2, 0, 0, 2 }, { 0, 1, 2, 0, 3 },
        { 3, 0, 0, 0, 1 }, { 0, 3, 0, 0, 2 }, { 1, 3, 0, 0, 2 }, { 0, 1, 3, 0, 3 },
        { 2, 3, 0, 0, 2 }, { 0, 2, 3, 0, 3 }, { 1, 2, 3, 0, 3 }, { 0, 1, 2, 3, 4 } };
#endif

/* Writes those of first, first + 1, ... whose bits are set, and others after them, at
 * most WEFT__BLOCK in all; returns how many are set. */
INLINE size_t write_set(uint32_t *to, size_t first, unsigned set)
{
#if defined __AVX512VL__ && LANES == 8
    const __m256i at = _mm256_add_epi32(_mm256_set1_epi32((int)first),
                                        _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    _mm256_storeu_si256((__m256i *)(void *)to,
                        _mm256_maskz_compress_epi32((__mmask8)set, at));
    return (size_t)__builtin_popcount(set);
#else
    size_t count = 0;
    for (size_t l = 0; l < LANES; l += 4) {
        const uint32_t *four = bits_of[set >> l & 15U];
        for (size_t k = 0; k < 4; ++k) {
            to[count + k] = (uint32_t)(first + l) + four[k];
        }
        count += four[4];
    }
    return count;
#endif
}

/* Adds pairs first, first + 1, ... whose bits are set. */
INLINE void self_fast_add(queue *to, size_t first, unsigned set)
{
    to->count += write_set(to->at + to->count, first, set);
}

/* Drops the last ones from pair `end` on. */
INLINE void end_at(queue *of, size_t end)
{
    while (of->count > 0 && of->at[of->count - 1] >= end) {
        --of->count;
    }
}

/* Of pairs close.at[i], ...: those that push wait no more. */
INLINE void self_fast_find(work *of, weft__pair_kind kind, size_t i)
{
    const weft__self *own = of->law->own;
    const uint32_t *pairs = of->close.at + i;
    int32_t at[4][LANES];
    vec x[4][3];
    particles_of(of->near, kind, pairs, at);
    gather_points(of->y, own->points, kind, at, x);
    const law_gram gram = law_gram_of(kind, x);
    unsigned pushes = bits(law_pushes(kind, &gram, own->law.thickness));
    for (; pushes != 0; pushes &= pushes - 1) {
        of->near->slack[pairs[__builtin_ctz(pushes)]] = -1.0;
    }
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

/* 1 / x0 as law_weigh takes it. */
INLINE void find_windows(const work *of, weft__pair_kind kind,
                         const uint32_t pairs[LANES], vec window[3])
{
    const weft__contact_surface *surface = of->law->own->surface;
    int32_t item[LANES];
    for (size_t k = 0; k < 3; ++k) {
        window[k] = splat(of->law->window);
        if (surface == NULL || kind == WEFT__VERTICES
            || k >= (kind == WEFT__EDGES         ? 2
                     : kind == WEFT__VERTEX_EDGE ? 1
                                                 : 3)) {
            continue;
        }
        pick(of->near->particle[kind == WEFT__EDGES && k == 0 ? 4 : 5], pairs, item);
        window[k] = gather(kind == WEFT__VERTEX_TRIANGLE
                               ? surface->triangle_window + k * surface->triangles
                               : surface->edge_window,
                           item);
    }
}

/* LANES pairs of `found` are the next pushes, unless some no longer push: returns their
 * bits. */
INLINE unsigned push_pairs(work *of, weft__pair_kind kind, size_t i)
{
    const weft__self *own = of->law->own;
    const weft_contact_def *contact = &own->law;
    const uint32_t *pairs = of->found.at + i;
    const size_t n = own->points, first = of->done + i;
    weft__pushes *to = &of->out[first / WEFT__BLOCK];
    int32_t at[4][LANES];
    vec x[4][3], v[4][3], rest = splat(0.0), window[3];
    vec mu = splat(contact->friction);
    law_push out;
    particles_of(of->near, kind, pairs, at);
    gather_points(of->y, n, kind, at, x);
    const law_gram gram = law_gram_of(kind, x);
    const unsigned inactive = bits(~law_pushes(kind, &gram, own->law.thickness));
    if (inactive != 0) {
        return inactive;
    }
    for (size_t j = 0; j < weft__kind_particles(kind); ++j) {
        memcpy(&to->particle[j][first % WEFT__BLOCK], at[j], sizeof at[j]);
    }
    const vec mass = gather(of->near->mass, (const int32_t *)pairs);
    const vec share
        = choose(mass < 0.0, splat(WEFT__GRID_SHARE), splat(of->law->share));
    if (kind == WEFT__EDGES) {
        rest = gather(of->near->rest, (const int32_t *)pairs);
    }
    gather_points(of->y + 3 * n, n, kind, at, v);
    law_feet feet = law_feet_of(kind, &gram);
    find_windows(of, kind, pairs, window);
    law_weigh(kind, of->law, rest, window, &feet);
    if (own->friction != NULL) {
        int32_t side[LANES];
        const int32_t *last = at[weft__kind_particles(kind) - 1];
        for (size_t l = 0; l < LANES; ++l) {
            side[l] = at[0][l] > last[l] ? at[0][l] : last[l];
        }
        mu = gather(own->friction, side);
    }
    law_push_of(kind, contact, share, mu, own->max_friction, &feet, most(mass, -mass),
                v, &out);
    write_pushes(kind, &feet, &out, first % WEFT__BLOCK, to);
    for (size_t k = 0; k < 3 * weft__kind_particles(kind); ++k) {
        of->bad += out.force[k / 3][k % 3] * 0.0;
    }
    return 0;
}

/* Drops pairs i + l of a queue whose bits l are set: they wait again. */
static void drop(queue *of, size_t i, unsigned set, double *slack)
{
    size_t kept = i;
    for (size_t j = i; j < of->count; ++j) {
        const bool drops = j < i + LANES && (set >> (j - i) & 1U) != 0;
        const uint32_t pair = of->at[kept] = of->at[j];
        slack[pair] = drops ? 0.0 : slack[pair];
        kept += !drops;
    }
    of->count = kept;
    self_fast_fill(of);
}

/* Those that are found are the next pushes, as far as they fill lanes; at last all. */
INLINE void push_found(work *of, weft__pair_kind kind, bool last)
{
    queue *found = &of->found;
    size_t taken = 0;
    self_fast_fill(found);
    while (taken + (last ? 1 : LANES) <= found->count) {
        const unsigned inactive = push_pairs(of, kind, taken);
        if (inactive != 0) {
            drop(found, taken, inactive, of->near->slack);
        }
        taken += inactive == 0 ? LANES : 0;
    }
    taken = taken < found->count ? taken : found->count;
    of->done += taken, found->count -= taken;
    memmove(found->at, found->at + taken, found->count * sizeof found->at[0]);
}

/* Takes the pairs before `end` that have not waited long enough, but not those that
 * pushed when they were last looked at. */
INLINE void scan(work *of, size_t end, weft__pair_kind kind)
{
    of->close.count = 0;
    while (of->next < end) {
        const size_t stop = of->subsets[of->subset].end[kind];
        const size_t to = stop < end ? stop : end;
        const vec moved = splat(of->subsets[of->subset].moved);
        for (; of->next < to; of->next += LANES) {
            const vec slack = load(of->near->slack + of->next);
            self_fast_add(&of->close, of->next,
                          bits(~(slack > moved) & ~(slack < 0.0)));
        }
        end_at(&of->close, to);
        of->next = to, of->subset += to == stop;
    }
    self_fast_fill(&of->close);
}

INLINE void self_fast_push_kind(weft__pair_kind kind, work *of)
{
    const size_t all
        = of->subset_count > 0 ? of->subsets[of->subset_count - 1].end[kind] : 0;
    for (size_t first = 0; first < all; first = of->next) {
        scan(of, first + STRETCH < all ? first + STRETCH : all, kind);
        for (size_t i = 0; i < of->close.count; i += LANES) {
            self_fast_find(of, kind, i);
        }
        for (size_t i = first; i < of->next; i += LANES) {
            self_fast_add(&of->found, i, bits(load(of->near->slack + i) < 0.0));
        }
        end_at(&of->found, of->next);
        push_found(of, kind, of->next == all);
    }
}

size_t NAME(pushes, LEVEL)(const weft__self_law *law, weft__pair_kind kind,
                           const weft__near *near, const weft__pair_subset *subsets,
                           size_t subset_count, const double *y, weft__pushes *out,
                           double *bad)
{
    work of;
    of.law = law, of.near = near, of.subsets = subsets, of.subset_count = subset_count;
    of.y = y, of.out = out, of.bad = splat(0.0);
    of.subset = of.next = of.done = of.close.count = of.found.count = 0;
    BY_KIND(kind, self_fast_push_kind, &of);
    *bad += sum(of.bad);
    return of.done;
}

/* ---- distances ------------------------------------------------------------------- */

typedef struct waiting {
    const weft__self *own;
    const weft__near *near;
    size_t first, end;
    const double *y;
    double most;
    double *distances;
} waiting;

INLINE void wait_kind(weft__pair_kind kind, const waiting *of)
{
    for (size_t i = of->first; i < of->end; i += LANES) {
        uint32_t pairs[LANES];
        int32_t at[4][LANES];
        vec x[4][3];
        for (size_t l = 0; l < LANES; ++l) {
            pairs[l] = (uint32_t)(i + l < of->end ? i + l : of->end - 1);
        }
        particles_of(of->near, kind, pairs, at);
        gather_points(of->y, of->own->points, kind, at, x);
        const vec distance = law_distance(kind, x);
        const vec slack
            = law_slack(kind, x, distance, of->own->law.thickness, of->most);
        for (size_t l = 0; l < LANES && i + l < of->end; ++l) {
            of->distances[i + l] = distance[l], of->near->slack[i + l] = slack[l];
        }
    }
}

void NAME(slack, LEVEL)(const weft__self *own, weft__pair_kind kind,
                        const weft__near *near, size_t first, size_t end,
                        const double *y, double most, double *distances)
{
    const waiting of = { own, near, first, end, y, most, distances };
    BY_KIND(kind, wait_kind, &of);
}

/* Pairs `which` of a kind, in a state. */
typedef struct chosen {
    const weft__self *own;
    const weft__near *near;
    const uint32_t *which;
    size_t count;
    const double *y;
} chosen;

/* Where the points of pairs which[i], which[i + 1], ... are; the last pair fills the
 * lanes. */
INLINE void place_pairs(weft__pair_kind kind, const chosen *of, size_t i, vec x[4][3])
{
    uint32_t pairs[LANES];
    int32_t at[4][LANES];
    for (size_t l = 0; l < LANES; ++l) {
        pairs[l] = of->which[i + l < of->count ? i + l : of->count - 1];
    }
    particles_of(of->near, kind, pairs, at);
    gather_points(of->y, of->own->points, kind, at, x);
}

INLINE void gap_kind(weft__pair_kind kind, const chosen *of, double *gaps)
{
    for (size_t i = 0; i < of->count; i += LANES) {
        vec x[4][3];
        place_pairs(kind, of, i, x);
        const vec distance = law_distance(kind, x);
        for (size_t l = 0; l < LANES && i + l < of->count; ++l) {
            gaps[i + l] = distance[l];
        }
    }
}

void NAME(gaps, LEVEL)(const weft__self *own, weft__pair_kind kind,
                       const weft__near *near, const uint32_t *which, size_t count,
                       const double *y, double *gaps)
{
    const chosen of = { own, near, which, count, y };
    BY_KIND(kind, gap_kind, &of, gaps);
}

INLINE size_t meet_kind(weft__pair_kind kind, const chosen *of, uint32_t *out)
{
    size_t found = 0;
    for (size_t i = 0; i < of->count; i += LANES) {
        vec x[4][3];
        place_pairs(kind, of, i, x);
        const law_gram gram = law_gram_of(kind, x);
        const unsigned set = bits(law_pushes(kind, &gram, of->own->law.thickness));
        for (size_t l = 0; l < LANES && i + l < of->count; ++l) {
            out[found] = of->which[i + l];
            found += set >> l & 1U;
        }
    }
    return found;
}

size_t NAME(meets, LEVEL)(const weft__self *own, weft__pair_kind kind,
                          const weft__near *near, const uint32_t *which, size_t count,
                          const double *y, uint32_t *out)
{
    const chosen of = { own, near, which, count, y };
    return BY_KIND(kind, meet_kind, &of, out);
}

size_t NAME(within, LEVEL)(const double *numbers, size_t first, size_t end, double most,
                           uint32_t *which)
{
    size_t count = 0;
    for (; first < end; first += LANES) {
        const unsigned all = end - first < LANES ? (1U << (end - first)) - 1U : ~0U;
        count += write_set(which + count, first,
                           bits(~(load(numbers + first) > most)) & all);
    }
    return count;
}

/* ---- bounds ---------------------------------------------------------------------- */

/* Of a plane, as long as they hold no NaN. */
typedef struct run_bounds {
    vec low, high;
} run_bounds;

/* Adds numbers, or some before them where the last lanes are beyond. */
INLINE void self_fast_add_run(const double *from, const double *to, size_t first,
                              size_t end, run_bounds *sum, vec *trouble)
{
    for (size_t i = first; i < end; i += LANES) {
        const size_t at = i + LANES <= end ? i : end - LANES;
        const vec d = from != NULL ? load(to + at) - load(from + at) : load(to + at);
        sum->low = least(sum->low, d), sum->high = most(sum->high, d);
        *trouble += d * 0.0;
    }
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

void NAME(range, LEVEL)(const weft__range *range, weft__drift *patch)
{
    const run_bounds none = { splat((double)INFINITY), splat(-(double)INFINITY) };
    run_bounds of[3] = { none, none, none };
    vec trouble = splat(0.0);
    const double *from = range->from, *to = range->to;
    const size_t first = range->run[0], end = range->run[1];
    if (end - first > 0 && end - first < LANES) {
        weft__range_loops(range, patch);
        return;
    }
    for (size_t k = 0; k < 3; ++k, to += range->to_plane) {
        self_fast_add_run(from, to, first, end, &of[k], &trouble);
        for (size_t j = 0; j < range->count; j += LANES) {
            const vec there = gather(to, range->more + j);
            const vec d = from != NULL ? there - gather(from, range->more + j) : there;
            of[k].low = least(of[k].low, d), of[k].high = most(of[k].high, d);
            trouble += d * 0.0;
        }
        from = from != NULL ? from + range->from_plane : NULL;
    }
    narrow(of, patch);
    if (any(trouble != 0.0)) {
        patch->high[0] = (double)INFINITY;
    }
}

void NAME(drift, LEVEL)(const weft__self *own, const double *from, const double *to,
                        size_t level, size_t first, size_t end, weft__drift *patches)
{
    const size_t n = own->points, cols = own->mesh->cols;
    if (cols < LANES) {
        weft__drift_loops(own, from, to, level, first, end, patches);
        return;
    }
    for (size_t i = first; i < end; ++i) {
        vec trouble = splat(0.0);
        run_bounds of[3];
        size_t in[4];
        weft__patch_range(own->mesh, level, i, in);
        const bool whole = in[3] - in[2] == cols; /* then its rows are one run */
        const size_t rows = in[1] - in[0], runs = whole ? 1 : rows;
        /* vectors have all columns of the tile, from here on */
        const size_t start = in[2] + LANES <= in[3] ? in[2]
                             : in[3] > LANES        ? in[3] - LANES
                                                    : 0;
        const size_t stop = whole ? rows * cols : in[3] < LANES ? LANES : in[3];
        for (size_t k = 0; k < 3; ++k) {
            of[k] = (run_bounds){ splat((double)INFINITY), splat(-(double)INFINITY) };
            for (size_t r = 0; r < runs; ++r) {
                const size_t at = k * n + (in[0] + r) * cols;
                self_fast_add_run(from, to, at + start, at + stop, &of[k], &trouble);
            }
        }
        narrow(of, &patches[i]);
        if (any(trouble != 0.0)) {
            patches[i].high[0] = (double)INFINITY;
        }
    }
}
