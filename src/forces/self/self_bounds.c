/* SPDX-License-Identifier: BSD-3-Clause */
/* self_bounds.c -- what self-contact adds to the stiffness and damping of particles. A
 * pair has K = S n n^T and C = D n n^T + T (I - n n^T) between its feet, hence b_i b_j
 * of them between its particles. As sum |b_i| = 2, the quadratic form of |sum b_i
 * x_i|^2 is at most that of sum 2 |b_i| |x_i|^2. */
#include "forces/self/self.h"

/* Two layers push a particle as one pair would that had this part of the law; a shape
 * has 1. Layers that meet at stopping_speed come to phi = 0.39; docs/physics.md. */
#define LAYERS_SHARE 2.6
#define LAYERS_PHI   0.39

typedef struct pair_sums {
    const weft__self *own;
    weft__self_law law;
    const double *y;
    size_t first, end;
    weft__grip *grips;
    double a, b;
    const double *x;
    double *out;
    double *blocks;
    double bad;
} pair_sums;

/* Of a pair: S, D, T and those in the planes xx, yy, zz, xy, xz, yz. */
typedef struct matrices {
    double stiffness, damping, drag; /* [N/m], [kg/s] twice */
    double nn[6];
} matrices;

static matrices matrices_of(const weft_contact_def *law, const weft__touch *touch)
{
    const double *n = touch->normal, u = law->damping * touch->speed;
    return (matrices){
        .stiffness = touch->stiffness * touch->factor,
        .damping = law->damping * touch->push * touch->factor / sqrt(1.0 + u * u),
        .drag = touch->drag,
        .nn = { n[0] * n[0], n[1] * n[1], n[2] * n[2], n[0] * n[1], n[0] * n[2],
                n[1] * n[2] },
    };
}

static bool seek(pair_sums *self, weft__pair_fn *visit)
{
    const weft__self *own = self->own;
    const weft__quadtree tree = weft__tree_of(own->mesh, self->y);
    self->law = weft__self_law_of(own);
    return own->law.self && self->y != NULL
           && isfinite(weft__extent(own, NULL, self->y))
           && weft__each_pair(&tree, own->law.thickness, visit, self);
}

static bool grip_pair(void *ctx, const weft__pair *pair)
{
    pair_sums *self = ctx;
    double arm[4];
    weft__touch touch;
    if (!weft__pair_meets(&self->law, pair, self->y, arm, &touch)) {
        return true;
    }
    const double mu = self->own->law.friction;
    const matrices of = matrices_of(&self->own->law, &touch);
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        if (i < self->first || i >= self->end) {
            continue;
        }
        weft__grip *to = &self->grips[i - self->first];
        const double by = 2.0 * fabs(arm[k]) * self->own->mesh->inverse_mass[i];
        for (size_t j = 0; j < 6; ++j) {
            to->press[j] += by * of.stiffness * of.nn[j];
            to->damp[j] += by * of.damping * of.nn[j];
            to->slide[j] += by * of.drag * ((j < 3 ? 1.0 : 0.0) - of.nn[j]);
        }
        to->stiff += by * 0.5 * mu * of.stiffness;
        to->drag += by * 0.5 * mu * of.damping;
        to->turn += by * touch.push * touch.factor / touch.gap;
    }
    return true;
}

static void grip_any_pairs(const weft__self *own, size_t count, weft__grip *grips)
{
    const weft__pose pose = { .kind = WEFT_PLANE, .friction = own->law.friction };
    weft__grip most = { .stiff = 0.0 };
    weft__grip_most(&own->law, &pose, LAYERS_SHARE, LAYERS_PHI, &most);
    for (size_t i = 0; i < count; ++i) {
        for (size_t j = 0; j < 6; ++j) {
            grips[i].press[j] += most.press[j];
            grips[i].slide[j] += most.slide[j];
        }
    }
}

void weft__self_grip(const void *own, const weft__state *at, size_t first, size_t count,
                     weft__grip *grips)
{
    const weft__self *of = own;
    pair_sums self = {
        .own = own, .y = at->y, .first = first, .end = first + count, .grips = grips
    };
    if (of->law.self && at->y == NULL) {
        grip_any_pairs(of, count, grips);
    } else {
        (void)seek(&self, grip_pair);
    }
}

static bool multiply_pair(void *ctx, const weft__pair *pair)
{
    pair_sums *self = ctx;
    const size_t n = self->own->mesh->particles;
    double arm[4], feet[3] = { 0.0 };
    weft__touch touch;
    if (!weft__pair_meets(&self->law, pair, self->y, arm, &touch)) {
        return true;
    }
    const matrices of = matrices_of(&self->own->law, &touch);
    const size_t count = weft__pair_particles(pair);
    for (size_t k = 0; k < 3 * count; ++k) {
        feet[k % 3] += arm[k / 3] * self->x[k % 3 * n + pair->particle[k / 3]];
    }
    const double in = weft__dot(feet, touch.normal);
    const double along = self->a * of.stiffness + self->b * (of.damping - of.drag);
    for (size_t k = 0; k < 3 * count; ++k) {
        const size_t j = k % 3;
        self->out[j * n + pair->particle[k / 3]]
            += arm[k / 3]
               * (along * in * touch.normal[j] + self->b * of.drag * feet[j]);
    }
    return true;
}

void weft__self_multiply(const void *own, const weft__state *at, double a, double b,
                         const double *x, double *out)
{
    pair_sums self = { .own = own, .y = at->y, .a = a, .b = b, .x = x, .out = out };
    (void)seek(&self, multiply_pair);
}

static bool block_pair(void *ctx, const weft__pair *pair)
{
    static const size_t planes[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };
    pair_sums *self = ctx;
    const size_t n = self->own->mesh->particles;
    double arm[4];
    weft__touch touch;
    if (!weft__pair_meets(&self->law, pair, self->y, arm, &touch)) {
        return true;
    }
    const matrices of = matrices_of(&self->own->law, &touch);
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        const double by = self->own->mesh->pin[i] == 0 ? 2.0 * fabs(arm[k]) : 0.0;
        double *to = self->blocks + i;
        for (size_t j = 0; j < 9; ++j, to += n) {
            *to += by * of.stiffness * of.nn[planes[j / 3][j % 3]];
            self->bad += *to * 0.0;
        }
        for (size_t j = 0; j < 9; ++j) {
            const double nn = of.nn[planes[j / 3][j % 3]];
            if (j / 3 <= j % 3) {
                *to += by
                       * ((of.damping - of.drag) * nn
                          + (j / 3 == j % 3 ? of.drag : 0.0));
                self->bad += *to * 0.0;
                to += n;
            }
        }
    }
    return true;
}

int weft__self_blocks(const void *own, const weft__state *at, double *blocks)
{
    const weft__self *of = own;
    pair_sums self = { .own = own, .y = at->y, .blocks = blocks };
    return !of->law.self || (seek(&self, block_pair) && self.bad == 0.0) ? 0 : 1;
}
