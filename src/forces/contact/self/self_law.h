/* SPDX-License-Identifier: BSD-3-Clause */
/* self_law.h -- the feet, weights and forces of the pairs of self.c, for one pair or a
 * vector of them, as contact_law.h; `truth` is int or a vector of masks. */
#pragma once

#include "forces/contact/contact_law.h"
#include "forces/contact/self/self.h"

/* x0 of z, and the smallest sine^2 of edges that are not parallel. */
#define SOFT_ANGLE 0.25
#define PARALLEL   1e-12

/* Calls a function that has the kind as a constant. */
#define BY_KIND(kind, call, ...)                                                       \
    ((kind) == WEFT__VERTICES          ? call(WEFT__VERTICES, __VA_ARGS__)             \
     : (kind) == WEFT__VERTEX_EDGE     ? call(WEFT__VERTEX_EDGE, __VA_ARGS__)          \
     : (kind) == WEFT__VERTEX_TRIANGLE ? call(WEFT__VERTEX_TRIANGLE, __VA_ARGS__)      \
                                       : call(WEFT__EDGES, __VA_ARGS__))

/* At a gap d windows are narrower by q = sqrt(1 + (thickness / (NARROWING d))^2), that
 * of the angle by q^2: W -> 1 as d -> 0, and no pass is left between two of them. */
#define NARROWING 8.0

LAW void law_from_to(const num a[3], const num b[3], num d[3])
{
    d[0] = b[0] - a[0], d[1] = b[1] - a[1], d[2] = b[2] - a[2];
}

/* ---- feet ------------------------------------------------------------------------ */

/* The edge, both edges, or those of a triangle at its first corner; p: from the start
 * of f, or of the only edge, to the particle or the start of e. VERTICES: p alone. */
typedef struct law_gram {
    num e[3], f[3], p[3], ee, ff, ef, ep, fp, pp;
} law_gram;

LAW law_gram law_gram_of(weft__pair_kind kind, num x[4][3])
{
    const size_t start = kind == WEFT__EDGES ? 2 : 1,
                 edge = kind == WEFT__EDGES ? 0 : 1;
    law_gram out = { .pp = NUM(0.0) };
    law_from_to(x[start], x[0], out.p);
    out.pp = law_dot(out.p, out.p);
    if (kind != WEFT__VERTICES) {
        law_from_to(x[edge], x[edge + 1], out.e);
        out.ee = law_dot(out.e, out.e), out.ep = law_dot(out.e, out.p);
    }
    if (kind >= WEFT__VERTEX_TRIANGLE) {
        law_from_to(x[start], x[3], out.f);
        out.ff = law_dot(out.f, out.f), out.ef = law_dot(out.e, out.f);
        out.fp = law_dot(out.f, out.p);
    }
    return out;
}

LAW num law_gram_area(const law_gram *of) /* |e x f|^2 */
{
    return of->ee * of->ff - of->ef * of->ef;
}

/* The feet's coordinates by `area`: p - u e - v f, or p + u e - v f of two edges, is
 * across e and f. */
LAW num law_u(weft__pair_kind kind, const law_gram *of)
{
    return kind == WEFT__VERTEX_EDGE ? of->ep
           : kind == WEFT__EDGES     ? of->ef * of->fp - of->ff * of->ep
                                     : of->ff * of->ep - of->ef * of->fp;
}

LAW num law_v(const law_gram *of)
{
    return of->ee * of->fp - of->ef * of->ep;
}

#ifndef LAW_OF_DUALS /* which those that push have alone */
/* Whether the feet are inside and nearer than the thickness. */
LAW truth law_pushes(weft__pair_kind kind, const law_gram *of, double thickness)
{
    const double near = thickness * thickness;
    if (kind == WEFT__VERTICES) {
        return of->pp < near;
    }
    const num u = law_u(kind, of);
    if (kind == WEFT__VERTEX_EDGE) {
        return (u > 0.0) & (u < of->ee)
               & (of->pp * of->ee - of->ep * of->ep < near * of->ee);
    }
    const num v = law_v(of), area = law_gram_area(of);
    const num volume = of->p[0] * (of->e[1] * of->f[2] - of->e[2] * of->f[1])
                       + of->p[1] * (of->e[2] * of->f[0] - of->e[0] * of->f[2])
                       + of->p[2] * (of->e[0] * of->f[1] - of->e[1] * of->f[0]);
    const truth inside = kind == WEFT__EDGES ? (area > PARALLEL * of->ee * of->ff)
                                                   & (u < area) & (v < area)
                                             : area - u - v > 0.0;
    return inside & (u > 0.0) & (v > 0.0) & (volume * volume < near * area);
}
#endif

/* ---- weights --------------------------------------------------------------------- */

/* S(x) and its derivative; inverse: 1 / x0. */
LAW num law_step(num x, num inverse, num *slope)
{
    const num part = x * inverse, y = CHOOSE(LESS(part, 1.0), part, NUM(1.0));
    const num y3 = y * y * y, z = 1.0 - y;
    *slope = 140.0 * y3 * (z * z * z) * inverse;
    return y3 * y * (35.0 - y * (84.0 - y * (70.0 - 20.0 * y)));
}

/* S(s) S(1 - s), its derivative, and that by log(inverse). */
LAW num law_both_ends(num s, num inverse, num *slope, num *growth)
{
    num from_0, from_1;
    const num z = 1.0 - s;
    const num a = law_step(s, inverse, &from_0), b = law_step(z, inverse, &from_1);
    *slope = from_0 * b - a * from_1;
    *growth = from_0 * s * b + a * from_1 * z;
    return a * b;
}

/* The feet of a pair. */
typedef struct law_feet {
    law_gram of;
    num inverse;             /* 1 / area, or of an edge alone 1 / ee */
    num u, v;                /* coordinates of the feet */
    num r[3], d;             /* [m] */
    num arm[4];              /* b_i */
    num weight;              /* W */
    num pull;                /* [1/m] -dW/dd */
    num lean[3], turn[2][3]; /* [1/m] */
} law_feet;

/* All but what the weight makes. */
LAW law_feet law_feet_of(weft__pair_kind kind, const law_gram *of)
{
    const double sign = kind == WEFT__EDGES ? -1.0 : 1.0;
    law_feet at = { .of = *of };
    if (kind != WEFT__VERTICES) {
        at.inverse = OVER(1.0, kind == WEFT__VERTEX_EDGE ? of->ee : law_gram_area(of));
        at.u = law_u(kind, of) * at.inverse;
    }
    if (kind >= WEFT__VERTEX_TRIANGLE) {
        at.v = law_v(of) * at.inverse;
    }
    for (size_t k = 0; k < 3; ++k) {
        at.r[k] = of->p[k];
        if (kind != WEFT__VERTICES) {
            at.r[k] = at.r[k] - sign * at.u * of->e[k];
        }
        if (kind >= WEFT__VERTEX_TRIANGLE) {
            at.r[k] = at.r[k] - at.v * of->f[k];
        }
    }
    at.d = ROOT(law_dot(at.r, at.r));
    return at;
}

/* W and its gradient from the derivatives of W by u and v, and by half the edges' area
 * squared. */
LAW void law_lean(weft__pair_kind kind, num by_u, num by_v, num by_area, law_feet *at)
{
    const double sign = kind == WEFT__EDGES ? -1.0 : 1.0;
    const bool one = kind == WEFT__VERTEX_EDGE;
    const num by_e
        = one ? by_u * at->inverse
              : sign * (at->of.ff * by_u - sign * at->of.ef * by_v) * at->inverse;
    const num by_f
        = one ? NUM(0.0) : (at->of.ee * by_v - sign * at->of.ef * by_u) * at->inverse;
    for (size_t k = 0; k < 3; ++k) {
        const num f = one ? NUM(0.0) : at->of.f[k];
        at->lean[k] = by_e * at->of.e[k] + by_f * f;
        at->turn[0][k] = by_e * at->r[k];
        at->turn[1][k] = by_f * at->r[k];
        if (kind == WEFT__EDGES) {
            at->turn[0][k]
                = at->turn[0][k]
                  + by_area * (at->of.ff * at->of.e[k] - at->of.ef * at->of.f[k]);
            at->turn[1][k]
                = at->turn[1][k]
                  + by_area * (at->of.ee * at->of.f[k] - at->of.ef * at->of.e[k]);
        }
    }
}

/* inverse_rest: 1 / (product of the squares of both edges' rest lengths); window: 1 /
 * x0 of the edge, of both, or of the triangle's corners */
LAW void law_weigh(weft__pair_kind kind, const weft__self_law *law, num inverse_rest,
                   const num window[3], law_feet *at)
{
    const num part = OVER(law->own->law.thickness, NARROWING * at->d);
    const num q2 = 1.0 + part * part, q = ROOT(q2);
    const num narrows = OVER(part * part, q2 * at->d); /* -d log(inverse) / dd */
    num by_u, by_v, by_z, grows_u, grows_v;
    if (kind == WEFT__VERTICES) {
        at->arm[0] = NUM(1.0), at->arm[1] = NUM(-1.0);
        at->weight = NUM(1.0), at->pull = NUM(0.0);
        return;
    }
    if (kind == WEFT__VERTEX_EDGE) {
        at->arm[0] = NUM(1.0), at->arm[1] = at->u - 1.0, at->arm[2] = -at->u;
        at->weight = law_both_ends(at->u, q * window[0], &by_u, &grows_u);
        at->pull = narrows * grows_u;
        law_lean(kind, by_u, by_u, by_u, at);
        return;
    }
    if (kind == WEFT__VERTEX_TRIANGLE) {
        const num z = 1.0 - at->u - at->v;
        const num su = law_step(at->u, q * window[1], &by_u);
        const num sv = law_step(at->v, q * window[2], &by_v);
        const num sz = law_step(z, q * window[0], &by_z);
        by_u = by_u * sv * sz, by_v = su * by_v * sz, by_z = su * sv * by_z;
        at->arm[0] = NUM(1.0), at->arm[1] = -z, at->arm[2] = -at->u;
        at->arm[3] = -at->v;
        at->weight = su * sv * sz;
        at->pull = narrows * (by_u * at->u + by_v * at->v + by_z * z);
        law_lean(kind, by_u - by_z, by_v - by_z, by_z, at);
        return;
    }
    const num su = law_both_ends(at->u, q * window[0], &by_u, &grows_u);
    const num sv = law_both_ends(at->v, q * window[1], &by_v, &grows_v);
    const num z = law_gram_area(&at->of) * inverse_rest;
    const num sz = law_step(z, q2 * (1.0 / SOFT_ANGLE), &by_z);
    at->arm[0] = 1.0 - at->u, at->arm[1] = at->u;
    at->arm[2] = at->v - 1.0, at->arm[3] = -at->v;
    at->weight = sz * su * sv;
    at->pull
        = narrows * (2.0 * by_z * z * su * sv + sz * (grows_u * sv + su * grows_v));
    law_lean(kind, sz * by_u * sv, sz * su * by_v, 2.0 * by_z * su * sv * inverse_rest,
             at);
}

#ifndef LAW_OF_DUALS
/* ---- distances ------------------------------------------------------------------- */

LAW num law_least(num a, num b) /* of a NaN and b: b */
{
    return CHOOSE(a < b, a, b);
}

LAW num law_most(num a, num b)
{
    return CHOOSE(a > b, a, b);
}

/* The square of the distance of p from a-b. */
LAW num law_edge_square(const num p[3], const num a[3], const num b[3])
{
    num e[3], r[3];
    law_from_to(a, b, e);
    law_from_to(a, p, r);
    const num at = law_dot(e, r) / law_dot(e, e);
    const num s = law_least(law_most(at, NUM(0.0)), NUM(1.0));
    for (size_t k = 0; k < 3; ++k) {
        r[k] = r[k] - s * e[k];
    }
    return law_dot(r, r);
}

/* The square of the distance between the lines or from the plane where both feet are
 * inside, if that is less than `least`. */
LAW num law_inside_square(weft__pair_kind kind, const law_gram *of, num least)
{
    const law_feet at = law_feet_of(kind, of);
    const num beyond = kind == WEFT__EDGES ? law_most(at.u, at.v) : at.u + at.v;
    const num square = law_dot(at.r, at.r);
    return CHOOSE((at.u >= 0.0) & (at.v >= 0.0) & (beyond <= 1.0) & (square < least),
                  square, least);
}

/* [m] Between the nearest points of both: inside, or at an edge or end of one. */
LAW num law_distance(weft__pair_kind kind, num x[4][3])
{
    const law_gram of = law_gram_of(kind, x);
    if (kind == WEFT__VERTICES) {
        return ROOT(of.pp);
    }
    if (kind == WEFT__VERTEX_EDGE) {
        return ROOT(law_edge_square(x[0], x[1], x[2]));
    }
    num least = law_edge_square(x[0], x[2], x[3]);
    if (kind == WEFT__EDGES) {
        least = law_least(least, law_edge_square(x[1], x[2], x[3]));
        least = law_least(least, law_edge_square(x[2], x[0], x[1]));
        least = law_least(least, law_edge_square(x[3], x[0], x[1]));
    } else {
        least = law_least(least, law_edge_square(x[0], x[1], x[2]));
        least = law_least(least, law_edge_square(x[0], x[1], x[3]));
    }
    return ROOT(law_inside_square(kind, &of, least));
}

/* ---- what has to happen before a pair pushes ------------------------------------- */

/* Of an edge x with an other o, by products as of law_gram and lengths: its foot is
 * inside from its start on where xo op - oo xp > 0. If differences of particles change
 * by less than the result, which counts up to `most`, that stays negative: a product
 * a.b changes by less than c times the change, c = |a| + |b| + most. */
LAW num law_foot_margin(num oo, num xo, num xp, num op, num x, num o, num p,
                        double most)
{
    const num by_oo = 2.0 * o + most, by_xo = x + o + most;
    const num by_xp = x + p + most, by_op = o + p + most;
    const num change = oo * by_xp + law_most(xp, -xp) * by_oo
                       + law_most(xo, -xo) * by_op + law_most(op, -op) * by_xo
                       + most * (by_oo * by_xp + by_xo * by_op);
    return (oo * xp - xo * op) / change;
}

LAW num law_length(num square)
{
    return ROOT(law_most(square, NUM(0.0)));
}

/* The feet of edges: e from both its ends, then f. */
LAW num law_foot_margin_edges(const law_gram *of, double most)
{
    const num e = ROOT(of->ee), f = ROOT(of->ff);
    const num ee = of->ee, ff = of->ff, ef = of->ef, ep = of->ep, fp = of->fp;
    const num p = ROOT(of->pp), q = law_length(of->pp + 2.0 * ep + ee);
    const num r = law_length(of->pp - 2.0 * fp + ff);
    return law_most(
        law_foot_margin(ff, ef, ep, fp, e, f, p, most),
        law_most(law_foot_margin(ff, -ef, -(ep + ee), fp + ef, e, f, q, most),
                 law_most(law_foot_margin(ee, ef, -fp, -ep, f, e, p, most),
                          law_foot_margin(ee, -ef, fp - ff, ef - ep, f, e, r, most))));
}

/* The foot in a triangle: e, then f, then the third edge, from f's end to e's. */
LAW num law_foot_margin_triangle(const law_gram *of, double most)
{
    const num ee = of->ee, ff = of->ff, ef = of->ef, ep = of->ep, fp = of->fp;
    const num e = ROOT(ee), f = ROOT(ff), gg = ff - 2.0 * ef + ee;
    const num g = law_length(gg), p = ROOT(of->pp);
    const num q = law_length(of->pp - 2.0 * ep + ee);
    return law_most(law_foot_margin(ff, ef, -ep, -fp, e, f, p, most),
                    law_most(law_foot_margin(ee, ef, -fp, -ep, f, e, p, most),
                             law_foot_margin(gg, ee - ef, ep - ee, ep + ef - fp - ee, e,
                                             g, q, most)));
}

/* [m] A pair at a distance does not push before differences between its particles have
 * changed by so much: by distance, or by its feet, which count up to `most`. */
LAW num law_slack(weft__pair_kind kind, num x[4][3], num distance, double thickness,
                  double most)
{
    const num far = distance - thickness;
    const law_gram of = law_gram_of(kind, x);
    num margin = NUM(-1.0);
    if (kind == WEFT__VERTICES) {
        return far;
    }
    if (kind == WEFT__VERTEX_EDGE) {
        const num end = law_length(of.pp - 2.0 * of.ep + of.ee);
        const num length = ROOT(of.ee) + most;
        margin = law_most(-of.ep / (length + ROOT(of.pp)), margin);
        margin = law_most((of.ep - of.ee) / (length + end), margin);
    } else {
        margin = law_most(kind == WEFT__EDGES ? law_foot_margin_edges(&of, most)
                                              : law_foot_margin_triangle(&of, most),
                          margin);
    }
    return law_most(far, law_least(margin, NUM(most)));
}
#endif

/* ---- pairs ----------------------------------------------------------------------- */

typedef struct law_push {
    num force[4][3]; /* [N] */
    num energy, heat, friction;
} law_push;

/* Of feet that law_weigh has weighed: n, w, and the speed along n, by the velocities
 * of the particles. */
LAW num law_slip(weft__pair_kind kind, const law_feet *at, num v[4][3], num n[3],
                 num slip[3])
{
    num w[3];
    for (size_t k = 0; k < 3; ++k) {
        w[k] = at->arm[0] * v[0][k];
        for (size_t i = 1; i < weft__kind_particles(kind); ++i) {
            w[k] = w[k] + at->arm[i] * v[i][k];
        }
        n[k] = OVER(at->r[k], at->d);
    }
    const num speed = law_dot(w, n);
    for (size_t k = 0; k < 3; ++k) {
        slip[k] = w[k] - speed * n[k];
    }
    return speed;
}

/* Adds component k of what pushes the feet, and of what turns the edges by both, to the
 * points of a pair. */
LAW void law_spread(weft__pair_kind kind, const num arm[4], num lean, num first,
                    num second, size_t k, num to[4][3])
{
    for (size_t i = 0; i < weft__kind_particles(kind); ++i) {
        to[i][k] = to[i][k] - arm[i] * lean;
    }
    if (kind == WEFT__EDGES) {
        to[0][k] = to[0][k] + first;
        to[1][k] = to[1][k] - first;
        to[2][k] = to[2][k] + second;
        to[3][k] = to[3][k] - second;
    } else {
        to[1][k] = to[1][k] + first;
        to[2][k] = to[2][k] - first;
    }
    if (kind == WEFT__VERTEX_TRIANGLE) {
        to[1][k] = to[1][k] + second;
        to[3][k] = to[3][k] - second;
    }
}

/* Of a pair that pushes, by mass M; mu: its friction, max_friction: that of any pair.
 */
LAW void law_push_of(weft__pair_kind kind, const weft_contact_def *law, num share,
                     num mu, double max_friction, const law_feet *at, num mass,
                     num v[4][3], law_push *out)
{
    const size_t count = weft__kind_particles(kind);
    num n[3], slip[3];
    const num speed = law_slip(kind, at, v, n, slip);
    const num slip2 = law_dot(slip, slip), one = NUM(1.0);
    const law_touch touch
        = law_normal_force(law, mu, at->d, share * at->weight, speed, slip2, one);
    const num energy = mass * (share * touch.energy);
    const num force = mass * touch.push * touch.factor,
              friction = law_friction_rate(law, max_friction, touch.most, touch.under);
    const num friction_rate = mass * friction;
    out->energy = at->weight * energy;
    out->heat = mass * (touch.push * (1.0 - touch.factor) * speed);
    out->friction = mass * (friction * slip2);
    for (size_t k = 0; k < 3; ++k) {
        const num foot = (force + energy * at->pull) * n[k] - friction_rate * slip[k];
        for (size_t i = 0; i < count; ++i) {
            out->force[i][k] = at->arm[i] * foot;
        }
        if (kind != WEFT__VERTICES) {
            law_spread(kind, at->arm, energy * at->lean[k], energy * at->turn[0][k],
                       energy * at->turn[1][k], k, out->force);
        }
    }
}
