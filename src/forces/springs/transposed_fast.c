/* SPDX-License-Identifier: BSD-3-Clause */
/* transposed_fast.c -- the transposed product of springs, LANES at a time: what a tile
 * of springs gives goes to its buffers, then to the ends p, then to the ends q. */
#include "forces/lanes.h"
#include "forces/springs/springs.h"

#include <float.h>

/* Of a tile of springs: what p gets, as a state; the parts of both sums. */
typedef struct tile {
    double share[WEFT__TILE + LANES], ends[6][WEFT__TILE], sums[2][WEFT__TILE + LANES];
} tile;

INLINE vec3 apart(const double *p, const double *q, size_t n, size_t count)
{
    return minus(load3_some(q, n, count), load3_some(p, n, count));
}

/* Of `count` springs from p to q, and l there: springs c, c + 1, ... of a tile. */
INLINE void springs(const weft__group *of, const double *const at[4], size_t n,
                    size_t c, size_t count, tile *to)
{
    const vec3 d = apart(at[0] + c, at[1] + c, n, count);
    const vec3 dl = apart(at[2] + c, at[3] + c, n, count);
    const vec3 w = apart(at[0] + 3 * n + c, at[1] + 3 * n + c, n, count);
    const vec square = dot(d, d), inverse = 1.0 / (square + DBL_MIN);
    const vec share = load(to->share + c), length = root(square);
    const vec k = share * of->stiffness, damping = share * of->damping;
    const vec rate = dot(w, d), along = dot(dl, d);
    const vec grown = length - of->rest_length, turn = (damping * along) * inverse;
    const vec q = ((k * length) * grown + damping * rate) * inverse;
    const vec part = ((k - (q + (damping * rate) * inverse)) * along) * inverse;
    const vec3 x = plus(plus(scaled(turn, w), scaled(q, dl)), scaled(part, d));
    store3_some(to->ends[0] + c, WEFT__TILE, x, count);
    store3_some(to->ends[3] + c, WEFT__TILE, scaled(turn, d), count);
    store(to->sums[0] + c, share * ((along * inverse) * (length * grown)));
    store(to->sums[1] + c, share * ((along * inverse) * rate));
}

INLINE void add(double *to, const double *from, size_t count, double sign)
{
    size_t c = 0;
    for (; c + LANES <= count; c += LANES) {
        store(to + c, load(to + c) + sign * load(from + c));
    }
    for (; c < count; ++c) {
        to[c] += sign * from[c];
    }
}

static double sum_of(const double *from, size_t count)
{
    double sums[WEFT__SUMS] = { 0.0 }, total = 0.0;
    for (size_t c = 0; c < count; c += WEFT__SUMS) {
        add(sums, from + c, count - c < WEFT__SUMS ? count - c : WEFT__SUMS, 1.0);
    }
    for (size_t k = 0; k < WEFT__SUMS; ++k) {
        total += sums[k];
    }
    return total;
}

static void run(const weft__springs *own, size_t g, size_t first, size_t count,
                const weft__state *at, double *out, weft__by_numbers *by)
{
    const weft__group *of = &own->groups[g];
    const size_t n = own->mesh->stride;
    const double *p = at->y + first, *l = at->along + first;
    const double *const ends[4] = { p, p + of->stride, l, l + of->stride };
    tile all;
    for (size_t c = 0; c < count + LANES; ++c) {
        all.share[c] = c < count ? weft__spring_share(own->mesh, of, first + c) : 0.0;
    }
    for (size_t c = 0; c < count; c += LANES) {
        const size_t some = count - c < LANES ? count - c : LANES;
        springs(of, ends, n, c, some, &all);
    }
    for (size_t k = 0; k < (of->damping != 0.0 ? 6 : 3); ++k) {
        add(out + k * n + first, all.ends[k], count, 1.0);
        add(out + k * n + first + of->stride, all.ends[k], count, -1.0);
    }
    by->stiffness[g] -= sum_of(all.sums[0], count);
    by->damping[g] -= sum_of(all.sums[1], count);
}

void NAME(transposed, LEVEL)(const void *own, const weft__state *at, double *out,
                             weft__by_numbers *by)
{
    weft__transposed_tiles(own, run, at, out, by);
}
