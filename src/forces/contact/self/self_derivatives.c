/* SPDX-License-Identifier: BSD-3-Clause */
/* self_derivatives.c -- the derivatives of what pairs exert: of the law of self_law.h
 * itself, for numbers with a derivative (forces/law.h). The product with a direction
 * takes one pass through it. The transposed one, the derivative of l.F by the state for
 * any l of points, has two parts:
 *
 *     F_i = -dU/dx_i + b_i G(r, v, W),   v = sum b_i v_i
 *
 * That of U is symmetric: the product along l. G, of damping and friction, has seven
 * arguments at the feet. */
#include <string.h>

#define LAW_OF_DUALS
#include "forces/contact/self/self_law.h"
#include "forces/contact/self/self_list.h"

/* Of a direction, so that squares of derivatives count nothing; a power of 2. */
#define PART 0x1p-300

static double dual_part(num a)
{
    return cimag(a) * (1.0 / PART);
}

/* Three planes of the points of a pair, along those of particles, or NULL. */
static inline void self_dual_place(const weft__self *own, const weft__pair *pair,
                                   const double *y, const double *along, num x[4][3])
{
    const size_t n = own->mesh->particles;
    for (size_t i = 0; i < weft__pair_particles(pair); ++i) {
        const size_t at = pair->particle[i];
        for (size_t k = 0; k < 3; ++k) {
            const bool moves = along != NULL && at < n; /* a body does not */
            x[i][k] = dual_of(y[k * own->points + at],
                              moves ? PART * along[k * n + at] : 0.0);
        }
    }
}

/* The feet of a pair that pushes, weighed. */
static inline law_feet feet_of(const weft__self_law *law, weft__pair_kind kind,
                               const weft__pair *pair, const double *y,
                               const double *along)
{
    double windows[3];
    num x[4][3];
    self_dual_place(law->own, pair, y, along, x);
    const law_gram of = law_gram_of(kind, x);
    law_feet at = law_feet_of(kind, &of);
    weft__pair_windows(law, pair, windows);
    const num window[3] = { windows[0], windows[1], windows[2] };
    law_weigh(kind, law, weft__pair_rest(law, pair), window, &at);
    return at;
}

/* ---- along a direction ----------------------------------------------------------- */

static inline void self_dual_push_kind(weft__pair_kind kind, const weft__self_law *law,
                                       const weft__pair *pair, const double *y,
                                       double mass, law_push *out)
{
    const weft__self *own = law->own;
    const law_feet at = feet_of(law, kind, pair, y, law->along);
    num v[4][3];
    self_dual_place(own, pair, y + 3 * own->points,
                    law->along + 3 * own->mesh->particles, v);
    law_push_of(kind, &own->law, weft__pair_share(law, mass),
                weft__pair_friction(own, pair), own->max_friction, &at, fabs(mass), v,
                out);
}

bool weft__pair_derivative(const weft__self_law *law, const weft__pair *pair,
                           const double *y, weft__pushes *out, size_t lane, double *bad)
{
    const double mass = weft__pair_pushes(law->own, pair, y);
    law_push push;
    if (mass == 0.0) {
        return false;
    }
    BY_KIND(pair->kind, self_dual_push_kind, law, pair, y, mass, &push);
    for (size_t i = 0; i < weft__pair_particles(pair); ++i) {
        out->particle[i][lane] = (int32_t)pair->particle[i];
        for (size_t k = 0; k < 3; ++k) {
            out->force[i][k][lane] = dual_part(push.force[i][k]);
            *bad += out->force[i][k][lane] * 0.0;
        }
    }
    return true;
}

/* ---- transposed ------------------------------------------------------------------ */

typedef struct transposing {
    weft__self_law law, elastic; /* the second without damping and friction */
    weft__self without;
    const double *y, *l;
    double *out;
    const weft__pair *pair;
    double mass;
} transposing;

/* db_i by u and by v. */
static const double arms[WEFT__EDGES + 1][2][4]
    = { [WEFT__VERTEX_EDGE] = { { 0.0, 1.0, -1.0 } },
        [WEFT__VERTEX_TRIANGLE] = { { 0.0, 1.0, -1.0 }, { 0.0, 1.0, 0.0, -1.0 } },
        [WEFT__EDGES] = { { -1.0, 1.0 }, { 0.0, 0.0, 1.0, -1.0 } } };

/* The sum of by_i of[i], of component k. */
static num sum_by(weft__pair_kind kind, const double by[4], num of[4][3], size_t k)
{
    num sum = 0.0;
    for (size_t i = 0; i < weft__kind_particles(kind); ++i) {
        sum += by[i] * of[i][k];
    }
    return sum;
}

/* What pushes the feet by a law: two points, r apart, of which one moves; in: r, v, W.
 */
static void push_feet(const weft__self_law *law, const transposing *of, double friction,
                      const num in[7], law_push *out)
{
    const law_feet at = { .r = { in[0], in[1], in[2] },
                          .d = dual_root(law_dot(in, in)),
                          .arm = { 1.0, 0.0 },
                          .weight = in[6] };
    num v[4][3] = { { in[3], in[4], in[5] } };
    law_push_of(WEFT__VERTICES, &law->own->law, weft__pair_share(law, of->mass),
                friction, law->own->max_friction, &at, fabs(of->mass), v, out);
}

/* G, and the derivatives of covector.G by its arguments. */
static void self_dual_differentiate(const transposing *of, num in[7],
                                    const num covector[3], double g[3], double by[7])
{
    const double friction = weft__pair_friction(of->law.own, of->pair);
    law_push all, elastic;
    for (size_t j = 0; j < 7; ++j) {
        const num here = in[j];
        in[j] = dual_of(creal(here), PART);
        push_feet(&of->law, of, friction, in, &all);
        push_feet(&of->elastic, of, 0.0, in, &elastic);
        in[j] = here, by[j] = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const num more = all.force[0][k] - elastic.force[0][k];
            g[k] = creal(more);
            by[j] += creal(covector[k]) * dual_part(more);
        }
    }
}

/* Adds to the derivatives by x and v of the points those of the part of G. */
static inline void add_loss(const transposing *of, weft__pair_kind kind,
                            const law_feet *at, num v[4][3], num l[4][3],
                            num by_x[4][3], num by_v[4][3])
{
    const double sign = kind == WEFT__EDGES ? -1.0 : 1.0;
    law_feet turned = *at;
    double arm[4] = { 0.0 }, g[3], by[7];
    num in[7], covector[3], by_u = 0.0, by_w = 0.0;
    for (size_t i = 0; i < weft__kind_particles(kind); ++i) {
        arm[i] = creal(at->arm[i]);
    }
    for (size_t k = 0; k < 3; ++k) {
        in[k] = creal(at->r[k]), in[3 + k] = creal(sum_by(kind, arm, v, k));
        covector[k] = sum_by(kind, arm, l, k);
    }
    in[6] = creal(at->weight);
    self_dual_differentiate(of, in, covector, g, by);
    for (size_t k = 0; k < 3; ++k) {
        by_u += by[3 + k] * sum_by(kind, arms[kind][0], v, k)
                + g[k] * sum_by(kind, arms[kind][0], l, k) - sign * by[k] * at->of.e[k];
        by_w += by[3 + k] * sum_by(kind, arms[kind][1], v, k)
                + g[k] * sum_by(kind, arms[kind][1], l, k) - by[k] * at->of.f[k];
    }
    if (kind != WEFT__VERTICES) {
        law_lean(kind, by_u, by_w, NUM(0.0), &turned);
    }
    for (size_t k = 0; k < 3; ++k) {
        const num n = at->r[k] * (1.0 / creal(at->d));
        const num foot = by[k] - by[6] * at->pull * n;
        for (size_t i = 0; i < weft__kind_particles(kind); ++i) {
            by_x[i][k] += at->arm[i] * foot;
            by_v[i][k] += at->arm[i] * by[3 + k];
        }
        if (kind != WEFT__VERTICES) {
            law_spread(kind, at->arm, -(by[6] * at->lean[k] + turned.lean[k]),
                       -(by[6] * at->turn[0][k] + turned.turn[0][k]),
                       -(by[6] * at->turn[1][k] + turned.turn[1][k]), k, by_x);
        }
    }
}

static inline void transpose_kind(weft__pair_kind kind, transposing *of)
{
    const weft__self *own = of->law.own;
    const size_t n = own->mesh->particles;
    const law_feet at = feet_of(&of->law, kind, of->pair, of->y, of->l);
    num v[4][3], l[4][3], by_x[4][3], by_v[4][3] = { { 0.0 } };
    law_push push;
    self_dual_place(own, of->pair, of->y + 3 * own->points, NULL, v);
    law_push_of(kind, &of->without.law, weft__pair_share(&of->law, of->mass), 0.0, 0.0,
                &at, fabs(of->mass), v, &push);
    for (size_t j = 0; j < 3 * weft__kind_particles(kind); ++j) {
        const size_t i = of->pair->particle[j / 3];
        l[j / 3][j % 3] = i < n ? of->l[j % 3 * n + i] : 0.0;
        by_x[j / 3][j % 3] = dual_part(push.force[j / 3][j % 3]);
    }
    if (own->law.damping != 0.0 || own->max_friction != 0.0) {
        add_loss(of, kind, &at, v, l, by_x, by_v);
    }
    for (size_t j = 0; j < 3 * weft__kind_particles(kind); ++j) {
        const size_t i = of->pair->particle[j / 3], k = j % 3;
        if (i < n) {
            of->out[k * n + i] += creal(by_x[j / 3][k]);
            of->out[(3 + k) * n + i] += creal(by_v[j / 3][k]);
        }
    }
}

static bool transpose_pair(void *ctx, const weft__pair *pair)
{
    transposing *of = ctx;
    of->pair = pair;
    of->mass = weft__pair_pushes(of->law.own, pair, of->y);
    if (of->mass != 0.0) {
        BY_KIND(pair->kind, transpose_kind, of);
    }
    return true;
}

int weft__self_transposed(const weft__self *own, weft__self_list *list, const double *y,
                          const double *along, double *out)
{
    transposing of = {
        .law = weft__self_law_of(own), .without = *own, .y = y, .l = along, .out = out
    };
    of.without.law.damping = of.without.law.friction = of.without.max_friction = 0.0;
    of.elastic = of.law;
    of.elastic.own = &of.without;
    const bool finite = list != NULL
                            ? weft__self_list_seek(list, y, transpose_pair, &of)
                            : weft__self_seek(own, NULL, y, transpose_pair, &of);
    return finite ? 0 : 1;
}
