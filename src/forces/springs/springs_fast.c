/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_fast.c -- springs, gravity and drag in one sweep over the rows. */
#include "forces/force.h"

enum { TILE = WEFT__CARRY_TILE, STREAMS = 1 };
#include "forces/springs/springs_sweep.h"

_Static_assert(sizeof(landing) <= 6 * (TILE + 3 * WEFT__CARRY_LANES) * 8,
               "weft__carry has room for it");

/* find_springs and land_springs in one: each pull is added as soon as it is known, so
 * that registers hold less. */
INLINE vec3 find_and_land(sweep *self, const columns *of, carry *left)
{
    spring s[WEFT_GROUPS];
    landing *to = &self->of[0];
    const unsigned has = of->has;
    const law *laws = of->laws;
    const size_t n = of->from.n, down = of->from.down, at = of->at;
    const double *p = of->from.p, *below = p + down;
    const mask *in_1 = of->rim != NULL ? &of->rim->right : NULL;
    const mask *in_2 = of->rim != NULL ? &of->rim->right2 : NULL;
    vec3 ended = load3(to->ended + at, SPAN), next = load3(to->ended2 + at, SPAN);
    begin(s, has, RIGHT, p, p + 1, n);
    begin(s, has, DOWN, p, below, n);
    find_tension(s, has, RIGHT, laws);
    begin(s, has, ANTI, p + 1, below, n);
    find_tension(s, has, DOWN, laws);
    const vec3 right = pull(s, has, RIGHT, in_1);
    begin(s, has, CROSS, p, below + 1, n);
    find_tension(s, has, ANTI, laws);
    const vec3 fall = pull(s, has, DOWN, NULL);
    begin(s, has, RIGHT2, p, p + 2, n);
    find_tension(s, has, CROSS, laws);
    const vec3 anti = pull(s, has, ANTI, in_1), beside = minus(right, anti);
    next = plus(next, plus(fall, anti));
    ended = plus(ended, shift_1(left->beside, beside));
    begin(s, has, DOWN2, p, below + down, n);
    find_tension(s, has, RIGHT2, laws);
    const vec3 cross = pull(s, has, CROSS, in_1);
    next = plus(next, shift_1(left->below, cross));
    store3(to->ended + at, SPAN, next);
    find_tension(s, has, DOWN2, laws);
    const vec3 right2 = pull(s, has, RIGHT2, in_2);
    ended = plus(ended, shift_2(left->beside2, right2));
    const vec3 fall2 = pull(s, has, DOWN2, NULL);
    store3(to->ended2 + at, SPAN, fall2);
    *left = (carry){ beside, right2, cross };
    return minus(plus(plus(plus(plus(right, fall), cross), right2), fall2), ended);
}

INLINE void visit_springs(sweep *self, const columns *of, carry *left)
{
    const vec3 force = find_and_land(self, of, left);
    if (of->emits) {
        emit(self, of, dragged(self, of, force));
    }
}

static void springs_row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                        bool emits)
{
    any_row(self, r, first, end, has, emits, visit_springs);
}

/* A load waits for a store before it whose address has the same low twelve bits. Where
 * planes are a multiple of 4096 bytes apart, but for a few columns, stores meet the
 * loads of the next blocks in every row if dydt is that little ahead of y. */
static bool stores_delay_loads(const sweep *self)
{
    if ((8 * self->n + 256) % 4096 >= 512) {
        return false;
    }
    const size_t ahead = ((uintptr_t)self->dydt - (uintptr_t)self->y) % 4096;
    return ahead < 256 && (ahead > 0 || (uintptr_t)self->y % 64 != 0);
}

/* Weight and air alone, of particles [first, end) of a cloth without springs. */
static vec bare(const sweep *self, size_t first, size_t end)
{
    const size_t n = self->n;
    const double *state = self->y + 3 * n;
    vec bad = splat(0.0);
    for (size_t i = first; i < end; i += LANES) {
        const size_t count = end - i < LANES ? end - i : LANES;
        const vec w = load(self->inverse_mass + i);
        const vec3 v = load3_some(state + i, n, count), g = self->gravity;
        const vec3 a
            = { g.x + w * (0.0 - self->drag * v.x), g.y + w * (0.0 - self->drag * v.y),
                g.z + w * (0.0 - self->drag * v.z) };
        store3_some(self->dydt + i, n, v, count);
        store3_some(self->dydt + 3 * n + i, n, a, count);
        bad += trouble(a, v);
    }
    return bad;
}

int NAME(rows, LEVEL)(const void *own, const weft__body *body, const weft__state *at,
                      weft__carry *carried, weft__unit unit, double *dydt, size_t first,
                      size_t end)
{
    const weft__springs *of = own;
    sweep self;
    double aside[6 * SPAN];
    (void)unit;
    const unsigned all
        = start(&self, of, body, at->y, of->mesh->stride, of->mesh->cols, 1);
    self.dydt = dydt;
    if (of->group_count == 0) {
        return sum(bare(&self, weft__block(of->mesh, first),
                        weft__block(of->mesh, end)))
                       == 0.0
                   ? 0
                   : 1;
    }
    self.aside = stores_delay_loads(&self) ? aside : NULL;
    return sweep_tiles(&self, all, first, end, carried, springs_row);
}
