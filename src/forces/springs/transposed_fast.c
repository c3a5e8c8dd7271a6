/* SPDX-License-Identifier: BSD-3-Clause */
/* transposed_fast.c -- J^T w of springs in one sweep: what springs have for the state
 * is found first, and the derivatives by x and by v are two streams more. */
#include "forces/springs/springs_products.h"

enum { TILE = WEFT__TILE, BY_X = 1, BY_V, STREAMS };
#include "forces/springs/springs_sweep.h"

enum { WASTE = 2 };

typedef struct turning {
    const double *l, *w;
    double *out, *net; /* net NULL: not wanted */
    size_t last;       /* columns */
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

/* What a spring gives p, and the derivatives with respect to its parameters. */
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

/* Writes what a block has, of l at `at`, and adds what it has by gravity and by
 * drag. */
INLINE void transposed_write(sweep *self, const turning *form, const columns *of,
                             const place *at, given_back sums, vec3 net,
                             weft__totals to)
{
    const mask *inside = of->rim != NULL ? &of->rim->inside : NULL;
    const size_t n = self->n, i = of->i;
    const vec3 l = load3(at->p, at->n);
    const vec3 v = load3(of->from.p + 3 * of->from.n, of->from.n);
    const mask is_free = load(self->inverse_mass + i) != splat(0.0);
    const vec3 moved = only3(load3_some(form->w + i, n, of->count), is_free);
    const vec3 pushed = only3(load3_some(form->w + 3 * n + i, n, of->count), is_free);
    add(to, 3 * WEFT_GROUPS, of->c, pushed.x, inside);
    add(to, 3 * WEFT_GROUPS + 1, of->c, pushed.y, inside);
    add(to, 3 * WEFT_GROUPS + 2, of->c, pushed.z, inside);
    add(to, 3 * WEFT_GROUPS + 3, of->c, dot(v, l), inside);
    store_rates(self, sums.by_x, plus(moved, minus(sums.by_v, scaled(self->drag, l))),
                of->rim, of->count, form->out + i, n);
    if (form->net != NULL) {
        store3_some(form->net + i, n, net, of->count);
    }
}

/* What springs s give a block of l at `at`, and the derivatives with respect to their
 * parameters. */
INLINE given_back land_turned(sweep *self, const spring *s, const columns *of,
                              const place *at, weft__totals to, carry *left)
{
    const unsigned has = of->has;
    const law *laws = of->laws;
    const size_t n = at->n, c = of->c;
    const double *p = at->p, *below = p + at->down;
    const mask *in_1 = of->rim != NULL ? &of->rim->right : NULL;
    const mask *in_2 = of->rim != NULL ? &of->rim->right2 : NULL;
    const mask *inside = of->rim != NULL ? &of->rim->inside : NULL;
    const given_back right = turn(s, has, RIGHT, p, p + 1, n, laws, in_1, c, to);
    const given_back fall = turn(s, has, DOWN, p, below, n, laws, inside, c, to);
    const given_back anti = turn(s, has, ANTI, p + 1, below, n, laws, in_1, c, to);
    const given_back cross = turn(s, has, CROSS, p, below + 1, n, laws, in_1, c, to);
    const given_back right2 = turn(s, has, RIGHT2, p, p + 2, n, laws, in_2, c, to);
    const given_back fall2
        = turn(s, has, DOWN2, p, below + at->down, n, laws, inside, c, to);
    return (given_back){ land(self, BY_X, of->at, right.by_x, fall.by_x, anti.by_x,
                              cross.by_x, right2.by_x, fall2.by_x, left),
                         land(self, BY_V, of->at, right.by_v, fall.by_v, anti.by_v,
                              cross.by_v, right2.by_v, fall2.by_v, left) };
}

INLINE void visit_transposed(sweep *self, const columns *of, carry *left)
{
    const turning *form = self->form;
    spring s[WEFT_GROUPS];
    find_springs(s, of);
    const vec3 force
        = form->net != NULL ? land_springs(self, s, of, left) : (vec3){ 0 };
    double copy[6][3][EDGE];
    const place at = place_in(self, of, form->l, copy);
    double(*to)[WEFT__EVERY] = form->totals[!of->emits ? WASTE : of->c >= form->last];
    const given_back sums = land_turned(self, s, of, &at, to, left);
    if (of->emits) {
        transposed_write(self, form, of, &at, sums, dragged(self, of, force), to);
    }
}

static void transposed_row(sweep *self, size_t r, size_t first, size_t end,
                           unsigned has, bool emits)
{
    any_row(self, r, first, end, has, emits, visit_transposed);
}

int NAME(transposed, LEVEL)(const weft__springs *own, const weft__body *body,
                            const weft__state *at, const double *w, double *out,
                            double *net, weft__parameter_gradient *by)
{
    const weft__mesh *mesh = own->mesh;
    weft__totals totals[3] = { { { 0.0 } } };
    const turning form = { .l = at->along,
                           .w = w,
                           .out = out,
                           .net = net,
                           .last = weft__last_columns(mesh->cols),
                           .totals = totals };
    sweep self;
    const unsigned all
        = start(&self, own, body, at->y, mesh->particles, mesh->cols, STREAMS);
    self.dydt = NULL;
    self.form = &form;
    const int failed
        = sweep_tiles(&self, all | BIT(DAMPED), 0, mesh->rows, NULL, transposed_row);
    weft__totals_add((const weft__totals *)totals, by);
    return failed;
}
