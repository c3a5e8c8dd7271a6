/* SPDX-License-Identifier: BSD-3-Clause */
/* self_bounds.c -- what self-contact adds to the stiffness and damping of particles: a
 * pair's K = S n n^T and C = D n n^T + T (I - n n^T) between its feet, at most 2 |b_i|
 * of them at each particle (docs/theory/contact.md, "Pairs"). */
#include "forces/contact/self/self_list.h"

/* Two layers push a particle as one pair would that had this part of the law; a shape
 * has 1. Layers that meet at stopping_speed come to this phi; docs/theory/contact.md.
 */
#define LAYERS_SHARE  2.6
#define LAYERS_PHI    0.39
#define REDUCED_SHARE 2.0
#define REDUCED_PHI   0.5

/* Of a pair: S, D, T, n and b_i. */
typedef struct matrices {
    double stiffness, damping, friction_rate; /* [N/m], [kg/s] twice */
    double turn; /* [N/m] of its force about the other foot */
    double normal[3], arm[4];
} matrices;

typedef struct pair_sums {
    const weft__self *own;
    weft__self_list *list; /* NULL: pairs are sought */
    void (*add)(struct pair_sums *self, const weft__pair *pair, const matrices *of);
    weft__self_law law;
    const double *y;
    size_t first, end;
    weft__range_stiffness *range_stiffness;
    double a, b;
    const double *x;
    double *out;
    double *blocks;
    double bad;
} pair_sums;

/* Whether one of its points is among those whose sums are taken. */
static bool self_bounds_is_wanted(const pair_sums *self, const weft__pair *pair)
{
    bool any = false;
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        any = any
              || (pair->particle[k] >= self->first && pair->particle[k] < self->end);
    }
    return any;
}

static bool visit(void *ctx, const weft__pair *pair)
{
    pair_sums *self = ctx;
    if (!self_bounds_is_wanted(self, pair)) {
        return true;
    }
    const weft_contact_def *law = &self->own->law;
    weft__touch touch;
    matrices of;
    if (weft__pair_meets(&self->law, pair, self->y, of.arm, &touch)) {
        const double u = law->damping * touch.speed;
        of.stiffness = touch.stiffness * touch.factor;
        of.damping = law->damping * touch.push * touch.factor / sqrt(1.0 + u * u);
        of.friction_rate = touch.friction_rate;
        of.turn = touch.push * touch.factor / touch.gap;
        memcpy(of.normal, touch.normal, sizeof of.normal);
        self->add(self, pair, &of);
    }
    return true;
}

/* Adds all pairs. */
static bool self_bounds_seek(pair_sums *self)
{
    self->law = weft__self_law_of(self->own);
    return self->own->law.self && self->y != NULL
           && (self->list != NULL
                   ? weft__self_list_seek(self->list, self->y, visit, self)
                   : weft__self_seek(self->own, NULL, self->y, visit, self));
}

static void self_range_stiffness_pair(pair_sums *self, const weft__pair *pair,
                                      const matrices *of)
{
    const double mu = self->own->max_friction;
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        if (i < self->first || i >= self->end) {
            continue;
        }
        weft__range_stiffness *to = &self->range_stiffness[i - self->first];
        const double by = 2.0 * fabs(of->arm[k]) * self->own->mesh->inverse_mass[i];
        weft__range_stiffness_add(to, of->normal, by * of->stiffness, by * of->damping,
                                  by * of->friction_rate);
        to->any_stiffness += by * 0.5 * mu * of->stiffness;
        to->any_damping += by * 0.5 * mu * of->damping;
        to->negative_stiffness += by * of->turn;
    }
}

static void self_range_stiffness_any(const weft__self *own, size_t count,
                                     weft__range_stiffness *range_stiffness)
{
    const weft__pose pose = { .kind = WEFT_PLANE, .friction = own->max_friction };
    weft__range_stiffness most = { .any_stiffness = 0.0 };
    weft__range_stiffness_most(&own->law, &pose,
                               own->surface != NULL ? REDUCED_SHARE : LAYERS_SHARE,
                               own->surface != NULL ? REDUCED_PHI : LAYERS_PHI, &most);
    if (own->surface != NULL && own->surface->grids) {
        weft__range_stiffness_most(&own->law, &pose, LAYERS_SHARE, LAYERS_PHI, &most);
    }
    for (size_t i = 0; i < count; ++i) {
        for (size_t j = 0; j < 6; ++j) {
            range_stiffness[i].normal_stiffness[j] += most.normal_stiffness[j];
            range_stiffness[i].friction_damping[j] += most.friction_damping[j];
        }
    }
}

void weft__self_range_stiffness(const void *own, void *list, const weft__state *at,
                                size_t first, size_t count,
                                weft__range_stiffness *range_stiffness)
{
    const weft__self *of = own;
    pair_sums self = { .own = own,
                       .list = list,
                       .add = self_range_stiffness_pair,
                       .y = at->y,
                       .first = first,
                       .end = first + count,
                       .range_stiffness = range_stiffness };
    if (of->law.self && at->y == NULL) {
        self_range_stiffness_any(of, count, range_stiffness);
    } else {
        (void)self_bounds_seek(&self);
    }
}

static void multiply_pair(pair_sums *self, const weft__pair *pair, const matrices *of)
{
    const size_t n = self->own->mesh->particles, count = weft__pair_particles(pair);
    double feet[3] = { 0.0 };
    for (size_t k = 0; k < 3 * count; ++k) {
        if (pair->particle[k / 3] < n) {
            feet[k % 3] += of->arm[k / 3] * self->x[k % 3 * n + pair->particle[k / 3]];
        }
    }
    const double in = weft__dot(feet, of->normal);
    const double along
        = self->a * of->stiffness + self->b * (of->damping - of->friction_rate);
    for (size_t k = 0; k < 3 * count; ++k) {
        const size_t j = k % 3;
        if (pair->particle[k / 3] < n) {
            self->out[j * n + pair->particle[k / 3]]
                += of->arm[k / 3]
                   * (along * in * of->normal[j]
                      + self->b * of->friction_rate * feet[j]);
        }
    }
}

void weft__self_multiply(const void *own, const weft__state *at, double a, double b,
                         const double *x, double *out)
{
    pair_sums self = {
        .own = own, .add = multiply_pair, .y = at->y, .a = a, .b = b, .x = x, .out = out
    };
    self.end = SIZE_MAX;
    (void)self_bounds_seek(&self);
}

/* The numbers of a symmetric matrix, row by row from the diagonal on. */
enum { SYMMETRIC = 6, BLOCK = 9 + SYMMETRIC };

/* n n^T, all of it and then its symmetric numbers, and those of 1. */
static void products_of(const double n[3], double nn[BLOCK], double one[SYMMETRIC])
{
    size_t k = 0;
    for (size_t j = 0; j < 9; ++j) {
        nn[j] = n[j / 3] * n[j % 3];
        if (j / 3 <= j % 3) {
            nn[9 + k] = nn[j], one[k++] = j / 3 == j % 3 ? 1.0 : 0.0;
        }
    }
}

static void block_pair(pair_sums *self, const weft__pair *pair, const matrices *of)
{
    const size_t n = self->own->mesh->particles;
    double nn[BLOCK], one[SYMMETRIC], bad[3] = { 0.0 }; /* sums that do not wait */
    products_of(of->normal, nn, one);
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        if (i >= n) {
            continue;
        }
        const double by = weft__self_held(self->own, i) ? 0.0 : 2.0 * fabs(of->arm[k]);
        double *to = self->blocks + i;
        for (size_t j = 0; j < 9; ++j) {
            to[j * n] += by * of->stiffness * nn[j];
        }
        for (size_t j = 9; j < BLOCK; ++j) {
            to[j * n] += by
                         * ((of->damping - of->friction_rate) * nn[j]
                            + of->friction_rate * one[j - 9]);
        }
        for (size_t j = 0; j < BLOCK; ++j) {
            bad[j % 3] += to[j * n] * 0.0;
        }
    }
    self->bad += bad[0] + bad[1] + bad[2];
}

int weft__self_blocks(const void *own, void *space, const weft__state *at,
                      double *blocks)
{
    const weft__self *of = own;
    pair_sums self = { .own = own, .add = block_pair, .y = at->y, .blocks = blocks };
    self.list = space, self.end = SIZE_MAX;
    return !of->law.self || (self_bounds_seek(&self) && self.bad == 0.0) ? 0 : 1;
}
