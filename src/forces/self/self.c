/* SPDX-License-Identifier: BSD-3-Clause */
/* self.c -- the forces of self-contact. A pair with the foot-point difference
 * r = sum b_i x_i, d = |r| < dh = thickness, whose feet are inside both primitives, has
 *
 *     U = M e W phi(1 - d / dh) / 4,   M = smallest mass of its free particles
 *     F_i = b_i (N n - friction) - M e phi / 4 dW/dx_i,   n = r / d
 *
 * by the law of contact.h for m = M, e W / 4 for e and v = sum b_i v_i. The weight W is
 * a product of S(x) = y^4 (35 - 84 y + 70 y^2 - 20 y^3), y = x / x0 <= 1, of the feet's
 * coordinates and, for edges, of z = |e1 x e2|^2 by its value at rest for perpendicular
 * ones. The feet satisfy e_k.r = 0 for the edges e_k; hence along dx, with
 * delta = sum b_i dx_i, dW = lean.delta + turn_1.de_1 + turn_2.de_2. */
#include "forces/self/self_list.h"

#include <stdio.h>
#include <string.h>

typedef double num;
typedef int truth;
#define NUM(a)          (a)
#define ROOT(a)         sqrt(a)
#define CHOOSE(t, a, b) ((t) ? (a) : (b))
#define LAW             static inline
#include "forces/self/self_law.h"
#include "mesh/grid_def.h"

weft__self_law weft__self_law_of(const weft__self *own)
{
    const double a2 = own->mesh->spacing[0] * own->mesh->spacing[0];
    const double b2 = own->mesh->spacing[1] * own->mesh->spacing[1];
    const double smaller = weft__shortest_edge(own->mesh);
    return (weft__self_law){ .own = own,
                             .soft = fmin(own->law.thickness / smaller, 0.3),
                             .square = { a2, b2, a2 + b2 } };
}

/* ---- forces ---------------------------------------------------------------------- */

/* [m^2] of an edge at rest */
static double rest_square(const weft__self_law *law, uint32_t a, uint32_t b)
{
    const uint32_t by = a < b ? b - a : a - b;
    return by == 1 && law->own->mesh->cols > 1 ? law->square[1]
           : by == law->own->mesh->cols        ? law->square[0]
                                               : law->square[2];
}

double weft__pair_rest(const weft__self_law *law, const weft__pair *pair)
{
    const uint32_t *i = pair->particle;
    return pair->kind != WEFT__EDGES
               ? 0.0
               : 1.0 / (rest_square(law, i[0], i[1]) * rest_square(law, i[2], i[3]));
}

double weft__pair_mass(const weft__self *own, const weft__pair *pair)
{
    double least = 0.0;
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        const double mass = own->mesh->pin[i] == 0 ? own->mesh->mass[i] : 0.0;
        least = mass > 0.0 && (least == 0.0 || mass < least) ? mass : least;
    }
    return least;
}

static inline void place(const double *planes, size_t n, const weft__pair *pair,
                         double x[4][3])
{
    for (size_t i = 0; i < weft__pair_particles(pair); ++i) {
        for (size_t k = 0; k < 3; ++k) {
            x[i][k] = planes[k * n + pair->particle[i]];
        }
    }
}

/* One function for each kind, as it is a constant. */
static inline bool push_kind(const weft__self_law *law, weft__pair_kind kind,
                             const weft__pair *pair, const double *y, weft__push *out)
{
    const weft__self *own = law->own;
    const size_t n = own->mesh->particles;
    double x[4][3], v[4][3];
    law_push push;
    place(y, n, pair, x);
    const law_gram of = law_gram_of(kind, x);
    const double mass = weft__pair_mass(own, pair);
    if (mass == 0.0 || !law_pushes(kind, &of, own->law.thickness)) {
        return false;
    }
    law_feet at = law_feet_of(kind, &of);
    place(y + 3 * n, n, pair, v);
    law_weigh(kind, law, weft__pair_rest(law, pair), &at);
    law_push_of(kind, &own->law, &at, mass, v, &push);
    memcpy(out->particle, pair->particle, sizeof out->particle);
    memcpy(out->force, push.force, sizeof out->force);
    out->count = (uint32_t)weft__pair_particles(pair), out->kind = kind;
    out->gap = at.d;
    out->energy = push.energy, out->heat = push.heat, out->friction = push.friction;
    return true;
}

bool weft__pair_push(const weft__self_law *law, const weft__pair *pair, const double *y,
                     weft__push *out)
{
    switch ((weft__pair_kind)pair->kind) {
#define CASE(kind)                                                                     \
    case kind:                                                                         \
        return push_kind(law, kind, pair, y, out);
        EACH_KIND(CASE)
#undef CASE
    default:
        return false;
    }
}

bool weft__pair_meets(const weft__self_law *law, const weft__pair *pair,
                      const double *y, double arm[4], weft__touch *touch)
{
    const size_t n = law->own->mesh->particles, count = weft__pair_particles(pair);
    const weft_contact_def *contact = &law->own->law;
    const weft__pair_kind kind = (weft__pair_kind)pair->kind;
    const double mass = weft__pair_mass(law->own, pair);
    double x[4][3], v[3] = { 0.0 };
    place(y, n, pair, x);
    const law_gram of = law_gram_of(kind, x);
    if (mass == 0.0 || !law_pushes(kind, &of, contact->thickness)) {
        return false;
    }
    law_feet at = law_feet_of(kind, &of);
    law_weigh(kind, law, weft__pair_rest(law, pair), &at);
    *touch = (weft__touch){ .gap = at.d,
                            .steepness = 1.0,
                            .share = WEFT__SELF_SHARE * at.weight };
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < count; ++i) {
            v[k] += at.arm[i] * y[(3 + k) * n + pair->particle[i]];
        }
        touch->normal[k] = at.r[k] / at.d;
    }
    touch->speed = weft__dot(v, touch->normal);
    for (size_t k = 0; k < 3; ++k) {
        touch->slip[k] = v[k] - touch->speed * touch->normal[k];
    }
    weft__touch_forces(contact, contact->friction, touch);
    touch->push *= mass, touch->stiffness *= mass, touch->drag *= mass;
    memcpy(arm, at.arm, sizeof at.arm);
    return true;
}

void weft__push_at(weft__pair_kind kind, const weft__pushes *pushes, size_t i,
                   weft__push *out)
{
    const weft__pushes *from = &pushes[i / WEFT__BLOCK];
    const size_t lane = i % WEFT__BLOCK;
    out->count = (uint32_t)weft__kind_particles(kind), out->kind = kind;
    for (size_t k = 0; k < out->count; ++k) {
        out->particle[k] = (uint32_t)from->particle[k][lane];
        for (size_t j = 0; j < 3; ++j) {
            out->force[k][j] = from->force[k][j][lane];
        }
    }
    out->gap = from->gap[lane], out->energy = from->energy[lane];
    out->heat = from->heat[lane], out->friction = from->friction[lane];
}

static void write_push(const weft__push *from, size_t lane, weft__pushes *to)
{
    for (size_t k = 0; k < from->count; ++k) {
        to->particle[k][lane] = (int32_t)from->particle[k];
        for (size_t j = 0; j < 3; ++j) {
            to->force[k][j][lane] = from->force[k][j];
        }
    }
    to->gap[lane] = from->gap, to->energy[lane] = from->energy;
    to->heat[lane] = from->heat, to->friction[lane] = from->friction;
}

size_t weft__pushes_loops(const weft__self_law *law, weft__pair_kind kind,
                          const weft__near *near, const weft__span *spans,
                          size_t span_count, const double *y, weft__pushes *out,
                          double *bad)
{
    size_t count = 0, i = 0;
    for (size_t at = 0; at < span_count; ++at) {
        for (; i < spans[at].end[kind]; ++i) {
            const weft__pair pair = weft__near_pair(kind, near, i);
            weft__push push;
            if (near->waits[i] > spans[at].moved
                || !weft__pair_push(law, &pair, y, &push)) {
                continue;
            }
            for (size_t k = 0; k < 3 * push.count; ++k) {
                *bad += push.force[k / 3][k % 3] * 0.0;
            }
            write_push(&push, count % WEFT__BLOCK, &out[count / WEFT__BLOCK]);
            ++count;
        }
    }
    return count;
}

double weft__pair_distance(const weft__pair *pair, const double *y, size_t n)
{
    double x[4][3] = { { 0.0 } };
    place(y, n, pair, x);
    return law_distance((weft__pair_kind)pair->kind, x);
}

void weft__waits_loops(const weft__self *own, weft__pair_kind kind,
                       const weft__near *near, size_t first, size_t end,
                       const double *y, double most, double *distances)
{
    for (size_t i = first; i < end; ++i) {
        const weft__pair pair = weft__near_pair(kind, near, i);
        double x[4][3] = { { 0.0 } };
        place(y, own->mesh->particles, &pair, x);
        distances[i] = law_distance(kind, x);
        near->waits[i] = law_wait(kind, x, distances[i], own->law.thickness, most);
    }
}

/* Adds its forces to planes to[3 N]. */
static double add_push(const weft__self *own, const weft__push *push, weft__unit unit,
                       double *to)
{
    double bad = 0.0;
    for (size_t k = 0; k < push->count; ++k) {
        const size_t i = push->particle[k];
        const double scale = unit == WEFT__FORCE ? 1.0 : own->mesh->inverse_mass[i];
        for (size_t j = 0; j < 3; ++j) {
            bad += push->force[k][j] * 0.0;
            if (scale > 0.0) {
                to[j * own->mesh->particles + i] += scale * push->force[k][j];
            }
        }
    }
    return bad;
}

void weft__push_measure(const weft__self *own, const weft__push *push, const double *y,
                        weft_measures *sum)
{
    const size_t n = own->mesh->particles;
    sum->energy.contact += push->energy;
    sum->power[WEFT_POWER_CONTACT] += push->heat;
    sum->power[WEFT_POWER_FRICTION] += push->friction;
    for (size_t k = 0; k < push->count; ++k) {
        const size_t i = push->particle[k];
        const double v[3] = { y[3 * n + i], y[4 * n + i], y[5 * n + i] };
        if (own->mesh->pin[i] != 0) {
            sum->power[WEFT_POWER_PINS] -= weft__dot(push->force[k], v);
        }
    }
    if (push->gap < sum->self_gap) {
        weft__pair pair = { .kind = push->kind };
        memcpy(pair.particle, push->particle, sizeof pair.particle);
        weft__pair_primitives(&pair, sum->self_pair);
        sum->self_gap = push->gap;
    }
    ++sum->self_touching;
}

/* ---- without a list -------------------------------------------------------------- */

typedef struct pass {
    weft__self_law law;
    const weft__state *at;
    weft__unit unit;
    double *to; /* NULL: to `sum` */
    weft_measures *sum;
    double bad; /* 0 or NaN */
} pass;

static bool take_pair(void *ctx, const weft__pair *pair)
{
    pass *all = ctx;
    weft__push push;
    if (weft__pair_push(&all->law, pair, all->at->y, &push)) {
        if (all->to != NULL) {
            all->bad += add_push(all->law.own, &push, all->unit, all->to);
        } else {
            weft__push_measure(all->law.own, &push, all->at->y, all->sum);
        }
    }
    return true;
}

static bool seek(const weft__self *own, pass *all)
{
    const weft__quadtree tree = weft__tree_of(own->mesh, all->at->y);
    all->law = weft__self_law_of(own);
    if (isfinite(weft__extent(own, NULL, all->at->y))) {
        return weft__each_pair(&tree, own->law.thickness, take_pair, all);
    }
    return false;
}

int weft__self_add(const weft__self *own, const weft__state *at, weft__unit unit,
                   double *to)
{
    pass all = { .at = at, .unit = unit, .to = to };
    return !own->law.self || (seek(own, &all) && all.bad == 0.0) ? 0 : 1;
}

void weft__self_measure(const weft__self *own, const weft__state *at,
                        weft_measures *sum)
{
    pass all = { .at = at, .sum = sum };
    if (own->law.self) {
        (void)seek(own, &all);
    }
}

/* ---- its part of a cloth --------------------------------------------------------- */

void weft__self_check(const weft_cloth_def *def, const weft__faults *to)
{
    const weft_contact_def *law = &def->contact;
    weft__mesh mesh = { .rows = 0 };
    if (def->mesh != NULL) {
        if (law->self) {
            weft__fault(to, offsetof(weft_contact_def, self),
                        offsetof(weft_contact_def, self),
                        "contact of the cloth with itself needs a grid");
        }
        return;
    }
    weft__grid_init(&mesh, def);
    const double most = 0.5 * weft__shortest_edge(&mesh);
    if (law->self && law->thickness > most) {
        weft__fault(to, offsetof(weft_contact_def, thickness),
                    offsetof(weft_contact_def, self),
                    "contact: thickness %g m is more than half the smaller spacing, %g "
                    "m, which contact of the cloth with itself needs",
                    law->thickness, most);
    }
}

static bool init(void *own, const weft_cloth_def *def, const weft_allocator *memory)
{
    (void)memory;
    ((weft__self *)own)->law = def->contact;
    return true;
}

static void choose(void *own, weft__isa isa)
{
    weft__self *of = own;
    of->pushes = WEFT_FORM(isa, pushes);
    of->waits = WEFT_FORM(isa, waits);
    of->extent = WEFT_FORM(isa, extent);
    of->drift = WEFT_FORM(isa, drift);
}

static int add_all(const void *own, void *space, const weft__state *at, weft__unit unit,
                   double *to)
{
    return space != NULL && unit == WEFT__ACCELERATION
               ? weft__self_list_add(space, at, to)
               : weft__self_add(own, at, unit, to);
}

static void measure_all(const void *own, void *space, const weft__state *at,
                        weft_measures *sum)
{
    if (space != NULL) {
        weft__self_list_measure(space, at, sum);
    } else {
        weft__self_measure(own, at, sum);
    }
}

const weft__force weft__self_force = { .name = "self",
                                       .check = weft__self_check,
                                       .init = init,
                                       .choose = choose,
                                       .grip = weft__self_grip,
                                       .multiply = weft__self_multiply,
                                       .blocks = weft__self_blocks,
                                       .add_all = add_all,
                                       .measure_all = measure_all };
