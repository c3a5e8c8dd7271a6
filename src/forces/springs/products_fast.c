/* SPDX-License-Identifier: BSD-3-Clause */
/* products_fast.c -- the rates of springs_fast.c, and in the same sweep their
 * derivatives in several directions: what springs have for all of them is found once.
 */
#include "forces/springs/springs_products.h"

enum { TILE = WEFT__TILE, STREAMS = 1 + WEFT__TANGENTS };
#include "forces/springs/springs_sweep.h"

/* The derivative of a pull on p, whose place in the direction is `p`, that of q `q`. */
INLINE vec3 change(const spring *springs, unsigned has, int group, const double *p,
                   const double *q, size_t n, const weft__spring_derivative *by,
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
    if (by != NULL && (by->orientations & BIT(group)) != 0) {
        const weft__law_derivative *more = &by->laws[group];
        const law *of = &laws[group];
        const vec longer = at->length * (at->length - of->rest_length) * at->inverse;
        part += more->stiffness * (of->share * longer)
                + more->damping * (of->share * (at->wd * at->inverse))
                - more->rest_length * (of->stiffness * at->length * at->inverse);
    }
    const vec3 force = plus(scaled(part, at->d), scaled(at->pull_by_length, dd));
    return where != NULL ? only3(force, *where) : force;
}

/* The pulls of springs s on their block, in a direction whose place there is `at`. */
INLINE vec3 land_along(sweep *self, const spring *s, size_t stream, const columns *of,
                       const place *at, const weft__spring_derivative *by, carry *left)
{
    const unsigned has = of->has;
    const law *laws = of->laws;
    const size_t n = at->n;
    const double *p = at->p, *below = p + at->down;
    const mask *in_1 = of->rim != NULL ? &of->rim->right : NULL;
    const mask *in_2 = of->rim != NULL ? &of->rim->right2 : NULL;
    const vec3 right = change(s, has, RIGHT, p, p + 1, n, by, laws, in_1);
    const vec3 fall = change(s, has, DOWN, p, below, n, by, laws, NULL);
    const vec3 anti = change(s, has, ANTI, p + 1, below, n, by, laws, in_1);
    const vec3 cross = change(s, has, CROSS, p, below + 1, n, by, laws, in_1);
    const vec3 right2 = change(s, has, RIGHT2, p, p + 2, n, by, laws, in_2);
    const vec3 fall2 = change(s, has, DOWN2, p, below + at->down, n, by, laws, NULL);
    return land(self, stream, of->at, right, fall, anti, cross, right2, fall2, left);
}

/* As emit, in a direction under a force; v and net: of the state itself. */
INLINE void emit_along(sweep *self, const columns *of, const weft__tangent *tangent,
                       const place *at, vec3 force, vec3 v, vec3 net)
{
    static const double none[3];
    const weft__spring_derivative *by = tangent->by;
    const size_t i = of->i, to = of->r * self->down + of->c;
    const vec3 dv = load3(at->p + 3 * at->n, at->n);
    for (size_t k = 0; k < 6; ++k) { /* what the next row needs */
        __builtin_prefetch(tangent->out + to + k * self->n + self->down, 1);
        __builtin_prefetch(at->p + k * at->n + 3 * at->down);
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
    store_rates(self, dv, a, of->rim, of->count, tangent->out + to, self->n);
}

typedef struct products {
    const weft__tangents *tangents;
    bool wanted; /* the state's own forces */
} products;

INLINE void visit_products(sweep *self, const columns *of, carry *left)
{
    const products *form = self->form;
    spring s[WEFT_GROUPS];
    find_springs(s, of);
    vec3 net = form->wanted ? land_springs(self, s, of, left) : (vec3){ 0 };
    if (of->emits) {
        net = dragged(self, of, net);
        if (self->dydt != NULL) {
            emit(self, of, net);
        }
    }
    const vec3 v = load3(of->from.p + 3 * of->from.n, of->from.n);
    double copy[6][3][EDGE];
    for (size_t j = 0; j < form->tangents->count; ++j) {
        const weft__tangent *tangent = &form->tangents->tangent[j];
        const place at = place_in(self, of, tangent->along, copy);
        const vec3 force = land_along(self, s, 1 + j, of, &at, tangent->by, left);
        if (of->emits) {
            emit_along(self, of, tangent, &at, force, v, net);
        }
    }
}

static void products_row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                         bool emits)
{
    any_row(self, r, first, end, has, emits, visit_products);
}

int NAME(products, LEVEL)(const weft__springs *own, const weft__body *body,
                          const weft__tangents *tangents, size_t first, size_t end)
{
    products form = { tangents, tangents->base != NULL };
    sweep self;
    unsigned all = start(&self, own, body, tangents->y, tangents->stride,
                         tangents->down, 1 + tangents->count);
    for (size_t j = 0; j < tangents->count; ++j) {
        const weft__spring_derivative *derivative = tangents->tangent[j].by;
        all |= derivative != NULL && derivative->damped ? BIT(DAMPED) : 0u;
        form.wanted
            = form.wanted || (derivative != NULL && derivative->inverse_mass != NULL);
    }
    self.dydt = tangents->base;
    self.form = &form;
    return sweep_tiles(&self, all, first, end, NULL, products_row);
}
