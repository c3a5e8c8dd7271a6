/* SPDX-License-Identifier: BSD-3-Clause */
/* self_law.h -- the feet, weights and forces of the pairs of self.c, for one pair or a
 * vector of them, as contact_law.h; `truth` is int or a vector of masks. */
#ifndef WEFT_CLOTH_SELF_LAW_H
#define WEFT_CLOTH_SELF_LAW_H

#include "cloth/contact_law.h"
#include "cloth/self.h"

/* The share of each pair: a particle between two layers has some four. */
#define WEFT__SELF_SHARE 0.25
/* x0 of z, and the smallest sine^2 of edges that are not parallel. */
#define SOFT_ANGLE 0.25
#define PARALLEL   1e-12

LAW num law_dot(const num a[3], const num b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LAW void law_from_to(const num a[3], const num b[3], num d[3])
{
    d[0] = b[0] - a[0], d[1] = b[1] - a[1], d[2] = b[2] - a[2];
}

/* ---- weights --------------------------------------------------------------------- */

/* S(x) and its derivative. */
LAW num law_step(num x, double soft, num *slope)
{
    const num part = x * (1.0 / soft), y = CHOOSE(part < 1.0, part, NUM(1.0));
    const num y3 = y * y * y, z = 1.0 - y;
    *slope = 140.0 * y3 * (z * z * z) * (1.0 / soft);
    return y3 * y * (35.0 - y * (84.0 - y * (70.0 - 20.0 * y)));
}

/* S(s) S(1 - s) and its derivative. */
LAW num law_both_ends(num s, double soft, num *slope)
{
    num from_0, from_1;
    const num a = law_step(s, soft, &from_0), b = law_step(1.0 - s, soft, &from_1);
    *slope = from_0 * b - a * from_1;
    return a * b;
}

/* The feet of a pair. */
typedef struct law_feet {
    num e[3], f[3], ee, ff, ef, inverse; /* edges, products, 1 / their determinant */
    num u, v;                            /* coordinates of the feet */
    num r[3], d;                         /* [m] */
    num arm[4];                          /* b_i */
    num weight;                          /* W */
    num lean[3], turn[2][3];             /* [1/m] */
} law_feet;

/* Fills all but what the weight makes. Whether the feet are inside and near. */
LAW truth law_find(weft__pair_kind kind, num x[4][3], double thickness, law_feet *at)
{
    num p[3];
    truth inside;
    const size_t from = kind == WEFT__EDGES ? 0 : 1;
    law_from_to(x[1], x[0], at->r);
    if (kind == WEFT__VERTICES) {
        at->d = ROOT(law_dot(at->r, at->r));
        return at->d < thickness;
    }
    law_from_to(x[from], x[from + 1], at->e);
    at->ee = law_dot(at->e, at->e);
    if (kind == WEFT__VERTEX_EDGE) {
        at->inverse = 1.0 / at->ee;
        at->u = law_dot(at->e, at->r) * at->inverse;
        for (size_t k = 0; k < 3; ++k) {
            at->r[k] = at->r[k] - at->u * at->e[k];
        }
        at->d = ROOT(law_dot(at->r, at->r));
        return (at->u > 0.0) & (at->u < 1.0) & (at->d < thickness);
    }
    law_from_to(x[kind == WEFT__EDGES ? 2 : 1], x[3], at->f);
    law_from_to(x[kind == WEFT__EDGES ? 2 : 1], x[0], p);
    at->ff = law_dot(at->f, at->f), at->ef = law_dot(at->e, at->f);
    const num ep = law_dot(at->e, p), fp = law_dot(at->f, p);
    const num area = at->ee * at->ff - at->ef * at->ef;
    at->inverse = 1.0 / area;
    if (kind == WEFT__EDGES) { /* p + u e - v f is across both */
        at->u = (at->ef * fp - at->ff * ep) * at->inverse;
        at->v = (at->ee * fp - at->ef * ep) * at->inverse;
        inside = (area > PARALLEL * at->ee * at->ff) & (at->u < 1.0) & (at->v < 1.0);
    } else { /* p - u e - v f is */
        at->u = (at->ff * ep - at->ef * fp) * at->inverse;
        at->v = (at->ee * fp - at->ef * ep) * at->inverse;
        inside = 1.0 - at->u - at->v > 0.0;
    }
    for (size_t k = 0; k < 3; ++k) {
        at->r[k]
            = (kind == WEFT__EDGES ? p[k] + at->u * at->e[k] : p[k] - at->u * at->e[k])
              - at->v * at->f[k];
    }
    at->d = ROOT(law_dot(at->r, at->r));
    return inside & (at->u > 0.0) & (at->v > 0.0) & (at->d < thickness);
}

/* W and its gradient from the derivatives of W by u and v, and by half the edges' area
 * squared. */
LAW void law_lean(weft__pair_kind kind, num by_u, num by_v, num by_area, law_feet *at)
{
    const double sign = kind == WEFT__EDGES ? -1.0 : 1.0;
    const bool one = kind == WEFT__VERTEX_EDGE;
    const num by_e = one ? by_u * at->inverse
                         : sign * (at->ff * by_u - sign * at->ef * by_v) * at->inverse;
    const num by_f
        = one ? NUM(0.0) : (at->ee * by_v - sign * at->ef * by_u) * at->inverse;
    for (size_t k = 0; k < 3; ++k) {
        const num f = one ? NUM(0.0) : at->f[k];
        at->lean[k] = by_e * at->e[k] + by_f * f;
        at->turn[0][k] = by_e * at->r[k];
        at->turn[1][k] = by_f * at->r[k];
        if (kind == WEFT__EDGES) {
            at->turn[0][k]
                = at->turn[0][k] + by_area * (at->ff * at->e[k] - at->ef * at->f[k]);
            at->turn[1][k]
                = at->turn[1][k] + by_area * (at->ee * at->f[k] - at->ef * at->e[k]);
        }
    }
}

/* inverse_rest: 1 / (product of the squares of both edges' rest lengths) */
LAW void law_weigh(weft__pair_kind kind, double soft, num inverse_rest, law_feet *at)
{
    num by_u, by_v, by_z;
    if (kind == WEFT__VERTICES) {
        at->arm[0] = NUM(1.0), at->arm[1] = NUM(-1.0);
        at->weight = NUM(1.0);
        return;
    }
    if (kind == WEFT__VERTEX_EDGE) {
        at->arm[0] = NUM(1.0), at->arm[1] = at->u - 1.0, at->arm[2] = -at->u;
        at->weight = law_both_ends(at->u, soft, &by_u);
        law_lean(kind, by_u, by_u, by_u, at);
        return;
    }
    if (kind == WEFT__VERTEX_TRIANGLE) {
        const num z = 1.0 - at->u - at->v;
        const num su = law_step(at->u, soft, &by_u), sv = law_step(at->v, soft, &by_v);
        const num sz = law_step(z, soft, &by_z);
        at->arm[0] = NUM(1.0), at->arm[1] = -z, at->arm[2] = -at->u;
        at->arm[3] = -at->v;
        at->weight = su * sv * sz;
        law_lean(kind, by_u * sv * sz - su * sv * by_z, su * by_v * sz - su * sv * by_z,
                 by_z, at);
        return;
    }
    const num su = law_both_ends(at->u, soft, &by_u);
    const num sv = law_both_ends(at->v, soft, &by_v);
    const num area = at->ee * at->ff - at->ef * at->ef;
    const num sz = law_step(area * inverse_rest, SOFT_ANGLE, &by_z);
    at->arm[0] = 1.0 - at->u, at->arm[1] = at->u;
    at->arm[2] = at->v - 1.0, at->arm[3] = -at->v;
    at->weight = sz * su * sv;
    law_lean(kind, sz * by_u * sv, sz * su * by_v, 2.0 * by_z * su * sv * inverse_rest,
             at);
}

/* ---- pairs ----------------------------------------------------------------------- */

typedef struct law_push {
    num force[4][3]; /* [N] */
    num energy, heat, friction;
} law_push;

/* Of a pair that law_find has found and law_weigh weighed, by mass M and the velocities
 * of its particles. */
LAW void law_push_of(weft__pair_kind kind, const weft_contact_def *law,
                     const law_feet *at, num mass, num v[4][3], law_push *out)
{
    const size_t count = kind == WEFT__VERTICES ? 2 : kind == WEFT__VERTEX_EDGE ? 3 : 4;
    num n[3], w[3], slip[3];
    for (size_t k = 0; k < 3; ++k) {
        w[k] = at->arm[0] * v[0][k];
        for (size_t i = 1; i < count; ++i) {
            w[k] = w[k] + at->arm[i] * v[i][k];
        }
        n[k] = at->r[k] / at->d;
    }
    const num speed = law_dot(w, n);
    for (size_t k = 0; k < 3; ++k) {
        slip[k] = w[k] - speed * n[k];
    }
    const num slip2 = law_dot(slip, slip), one = NUM(1.0);
    const law_touch touch = law_press(law, law->friction, at->d,
                                      WEFT__SELF_SHARE * at->weight, speed, slip2, one);
    const num energy = mass * (WEFT__SELF_SHARE * touch.energy);
    const num force = mass * touch.push * touch.factor, drag = mass * touch.drag;
    out->energy = at->weight * energy;
    out->heat = mass * (touch.push * (1.0 - touch.factor) * speed);
    out->friction = mass * (touch.drag * slip2);
    for (size_t k = 0; k < 3; ++k) {
        const num foot = force * n[k] - drag * slip[k];
        for (size_t i = 0; i < count; ++i) {
            out->force[i][k] = at->arm[i] * foot;
        }
        if (kind == WEFT__VERTICES) {
            continue;
        }
        const num first = energy * at->turn[0][k], second = energy * at->turn[1][k];
        const num lean = energy * at->lean[k];
        for (size_t i = 0; i < count; ++i) {
            out->force[i][k] = out->force[i][k] - at->arm[i] * lean;
        }
        if (kind == WEFT__EDGES) {
            out->force[0][k] = out->force[0][k] + first;
            out->force[1][k] = out->force[1][k] - first;
            out->force[2][k] = out->force[2][k] + second;
            out->force[3][k] = out->force[3][k] - second;
        } else {
            out->force[1][k] = out->force[1][k] + first;
            out->force[2][k] = out->force[2][k] - first;
        }
        if (kind == WEFT__VERTEX_TRIANGLE) {
            out->force[1][k] = out->force[1][k] + second;
            out->force[3][k] = out->force[3][k] - second;
        }
    }
}

#endif
