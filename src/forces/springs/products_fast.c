/* SPDX-License-Identifier: BSD-3-Clause */
/* products_fast.c -- springs_fast.c, and in the same sweep the derivatives in several
 * directions: what springs have for all of them is found once. */
#define PRODUCT 1
#include "forces/springs/springs_fast.c" /* NOLINT(bugprone-suspicious-include) */

/* The derivative of a pull on p, whose place in the direction is `p`, that of q `q`. */
INLINE vec3 change(const spring *springs, unsigned has, int group, const double *p,
                   const double *q, size_t n, const weft__spring_slope *by,
                   const law *laws, const mask *where)
{
    const spring *at = &springs[group];
    if ((has & BIT(group)) == 0) {
        return (vec3){ 0 };
    }
    const vec3 dd = minus(load3(q, n), load3(p, n));
    vec part = dot(at->z, dd);
    if ((has & BIT(DAMPED)) != 0) {
        const vec3 dw = minus(load3(q + 3 * n, n), load3(p + 3 * n, n));
        part += at->rate * dot(at->d, dw);
    }
    if (by != NULL && (by->ways & BIT(group)) != 0) {
        const weft__slope_law *more = &by->laws[group];
        const law *of = &laws[group];
        const vec longer = at->length * (at->length - of->rest_length) * at->inverse;
        part += more->stiffness * (of->share * longer)
                + more->damping * (of->share * (at->wd * at->inverse))
                - more->rest_length * (of->stiffness * at->length * at->inverse);
    }
    const vec3 force = plus(scaled(part, at->d), scaled(at->pull_by_length, dd));
    return where != NULL ? only3(force, *where) : force;
}

/* As block, in direction j, of springs s. */
INLINE vec3 block_along(sweep *self, const spring *s, size_t j, const place *of,
                        size_t at, unsigned has, carry *left, const law *laws,
                        const edge *rim)
{
    const weft__spring_slope *by = self->ways->way[j].by;
    const size_t n = of->n;
    const double *p = of->p, *below = p + of->down;
    const mask *in_1 = rim != NULL ? &rim->right : NULL;
    const mask *in_2 = rim != NULL ? &rim->right2 : NULL;
    const vec3 right = change(s, has, RIGHT, p, p + 1, n, by, laws, in_1);
    const vec3 fall = change(s, has, DOWN, p, below, n, by, laws, NULL);
    const vec3 anti = change(s, has, ANTI, p + 1, below, n, by, laws, in_1);
    const vec3 cross = change(s, has, CROSS, p, below + 1, n, by, laws, in_1);
    const vec3 right2 = change(s, has, RIGHT2, p, p + 2, n, by, laws, in_2);
    const vec3 fall2 = change(s, has, DOWN2, p, below + of->down, n, by, laws, NULL);
    return land(self, 1 + j, at, right, fall, anti, cross, right2, fall2, left);
}

/* As emit, to `to` of direction j; v and net: of the state itself. */
INLINE void emit_along(sweep *self, size_t j, const place *of, size_t i, size_t to,
                       vec3 force, vec3 v, vec3 net, const edge *rim, size_t count)
{
    static const double none[3];
    const weft__way *way = &self->ways->way[j];
    const weft__spring_slope *by = way->by;
    const vec3 dv = load3(of->p + 3 * of->n, of->n);
    for (size_t k = 0; k < 6; ++k) { /* what the next row needs */
        __builtin_prefetch(way->out + to + k * self->n + self->down, 1);
        __builtin_prefetch(of->p + k * of->n + 3 * of->down);
    }
    vec3 change = minus(force, scaled(self->drag, dv));
    if (by != NULL) {
        change = minus(change, scaled(splat(by->drag), v));
    }
    const double *g = by != NULL ? by->gravity : none;
    vec3 a = plus((vec3){ splat(g[0]), splat(g[1]), splat(g[2]) },
                  scaled(load(self->inverse_mass + i), change));
    if (by != NULL && by->inverse_mass != NULL) {
        a = plus(a, scaled(load(by->inverse_mass + i), net));
    }
    store_rates(self, dv, a, rim, count, way->out + to, self->n);
}

/* The directions of a block; the rest as of emit_along. */
INLINE void along(sweep *self, const spring *s, const place *of, size_t r, size_t c,
                  size_t at, unsigned has, bool emits, carry *left, const law *laws,
                  const edge *rim, size_t count, vec3 net)
{
    const size_t i = r * self->cols + c;
    const vec3 v = load3(of->p + 3 * of->n, of->n);
    double copy[6][3][EDGE];
    for (size_t j = 0; j < self->ways->count; ++j) {
        const double *y = self->ways->way[j].along;
        const place there = rim != NULL
                                ? place_at(self, y, r, c, copy)
                                : (place){ y + (of->p - self->y), of->n, of->down };
        const vec3 force = block_along(self, s, j, &there, at, has, left, laws, rim);
        if (emits) {
            emit_along(self, j, &there, i, r * self->down + c, force, v, net, rim,
                       count);
        }
    }
}

int NAME(products, LEVEL)(const weft__springs *own, const weft__body *body,
                          const weft__ways *ways, size_t first, size_t end)
{
    sweep self;
    unsigned all = start(&self, own, body, ways->y, ways->stride, ways->down);
    self.wanted = ways->base != NULL;
    for (size_t j = 0; j < ways->count; ++j) {
        const weft__spring_slope *slope = ways->way[j].by;
        all |= slope != NULL && slope->damped ? BIT(DAMPED) : 0u;
        self.wanted = self.wanted || (slope != NULL && slope->inverse_mass != NULL);
    }
    self.dydt = ways->base;
    self.ways = ways;
    return sweep_tiles(&self, all, first, end, NULL, false);
}
