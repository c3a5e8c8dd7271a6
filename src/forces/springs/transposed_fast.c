/* SPDX-License-Identifier: BSD-3-Clause */
/* transposed_fast.c -- springs_fast.c, and in the same sweep J^T w: what springs have
 * for the state is there, and the derivatives by x and by v are two streams more. */
#define PRODUCT 2
#include "forces/springs/springs_fast.c" /* NOLINT(bugprone-suspicious-include) */

enum { BY_X = 1, BY_V, WASTE = 2 };

typedef struct turning {
    weft__ways ways; /* of so many streams */
    const double *l, *w;
    double *out, *net;
    size_t last; /* columns */
    weft__totals *totals;
} turning;

typedef struct given_back {
    vec3 by_x, by_v;
} given_back;

INLINE void add(weft__totals to, int total, size_t column, vec numbers,
                const mask *where)
{
    double *at = to[total] + column % WEFT__EVERY;
    store(at, load(at) + (where != NULL ? only(numbers, *where) : numbers));
}

/* What a spring gives p, and by its numbers. */
INLINE given_back turn(const spring *springs, unsigned has, int group, const double *p,
                       const double *q, size_t n, const law *laws, const mask *where,
                       size_t column, weft__totals to)
{
    const spring *at = &springs[group];
    const law *by = &laws[group];
    if ((has & BIT(group)) == 0) {
        return (given_back){ 0 };
    }
    const vec3 dl = minus(load3(q, n), load3(p, n));
    const vec part = dot(dl, at->d) * at->inverse, damped = by->damping * part;
    const vec3 by_x = plus(plus(scaled(at->part * part, at->d), scaled(damped, at->w)),
                           scaled(at->pull_by_length, dl));
    const vec3 by_v = scaled(damped, at->d);
    const vec longer = part * at->length;
    add(to, group, column, by->share * (longer * (at->length - by->rest_length)),
        where);
    add(to, WEFT_GROUPS + group, column, by->share * (part * at->wd), where);
    add(to, 2 * WEFT_GROUPS + group, column, by->stiffness * longer, where);
    return where != NULL ? (given_back){ only3(by_x, *where), only3(by_v, *where) }
                         : (given_back){ by_x, by_v };
}

/* Writes what the particles from i on have, and adds what they have by gravity and by
 * drag. */
INLINE void transposed_write(sweep *self, const turning *of, size_t i, given_back sums,
                             vec3 l, vec3 v, vec3 net, const edge *rim, size_t count,
                             size_t column, weft__totals to)
{
    const mask *inside = rim != NULL ? &rim->inside : NULL;
    const size_t n = self->n;
    const mask is_free = load(self->inverse_mass + i) != splat(0.0);
    const vec3 moved = only3(load3_some(of->w + i, n, count), is_free);
    const vec3 pushed = only3(load3_some(of->w + 3 * n + i, n, count), is_free);
    add(to, 3 * WEFT_GROUPS, column, pushed.x, inside);
    add(to, 3 * WEFT_GROUPS + 1, column, pushed.y, inside);
    add(to, 3 * WEFT_GROUPS + 2, column, pushed.z, inside);
    add(to, 3 * WEFT_GROUPS + 3, column, dot(v, l), inside);
    store_rates(self, sums.by_x, plus(moved, minus(sums.by_v, scaled(self->drag, l))),
                rim, count, of->out + i, n);
    if (of->net != NULL) {
        store3_some(of->net + i, n, net, count);
    }
}

INLINE void along(sweep *self, const spring *s, const place *of, size_t r, size_t c,
                  size_t at, unsigned has, bool emits, carry *left, const law *laws,
                  const edge *rim, size_t count, vec3 net)
{
    const turning *all = (const turning *)self->ways;
    double copy[6][3][EDGE];
    const place there = rim != NULL
                            ? place_at(self, all->l, r, c, copy)
                            : (place){ all->l + (of->p - self->y), of->n, of->down };
    const size_t n = there.n;
    const double *p = there.p, *below = p + there.down;
    const mask *in_1 = rim != NULL ? &rim->right : NULL;
    const mask *in_2 = rim != NULL ? &rim->right2 : NULL;
    const mask *inside = rim != NULL ? &rim->inside : NULL;
    double(*to)[WEFT__EVERY] = all->totals[!emits ? WASTE : c >= all->last];
    const given_back right = turn(s, has, RIGHT, p, p + 1, n, laws, in_1, c, to);
    const given_back fall = turn(s, has, DOWN, p, below, n, laws, inside, c, to);
    const given_back anti = turn(s, has, ANTI, p + 1, below, n, laws, in_1, c, to);
    const given_back cross = turn(s, has, CROSS, p, below + 1, n, laws, in_1, c, to);
    const given_back right2 = turn(s, has, RIGHT2, p, p + 2, n, laws, in_2, c, to);
    const given_back fall2
        = turn(s, has, DOWN2, p, below + there.down, n, laws, inside, c, to);
    const given_back sums = { land(self, BY_X, at, right.by_x, fall.by_x, anti.by_x,
                                   cross.by_x, right2.by_x, fall2.by_x, left),
                              land(self, BY_V, at, right.by_v, fall.by_v, anti.by_v,
                                   cross.by_v, right2.by_v, fall2.by_v, left) };
    if (emits) {
        transposed_write(self, all, r * self->cols + c, sums, load3(p, n),
                         load3(of->p + 3 * of->n, of->n), net, rim, count, c, to);
    }
}

int NAME(transposed, LEVEL)(const weft__springs *own, const weft__body *body,
                            const weft__state *at, const double *w, double *out,
                            double *net, weft__by_numbers *by)
{
    const weft__mesh *mesh = own->mesh;
    weft__totals totals[3] = { { { 0.0 } } };
    const turning of = { .ways = { .count = BY_V },
                         .l = at->along,
                         .w = w,
                         .out = out,
                         .net = net,
                         .last = weft__last_columns(mesh->cols),
                         .totals = totals };
    sweep self;
    const unsigned all = start(&self, own, body, at->y, mesh->particles, mesh->cols);
    self.dydt = NULL;
    self.wanted = net != NULL;
    self.ways = &of.ways;
    const int failed
        = sweep_tiles(&self, all | BIT(DAMPED), 0, mesh->rows, NULL, false);
    weft__totals_add((const weft__totals *)totals, by);
    return failed;
}
