/* SPDX-License-Identifier: BSD-3-Clause */
/* angles_law.c -- the law of angles.h, its derivative and the transpose of that. */
#include "forces/bending/angles.h"
#include "mesh/rigid.h"

/* How the normal of a triangle changes with its corners. */
typedef struct tilt {
    double e[3][3]; /* of its edges */
    double c[3];    /* of their product */
    double n[3];    /* of the normal */
} tilt;

static void edges_of(const weft__angles *own, const uint32_t corner[3], const double *x,
                     double e[3][3])
{
    const size_t n = own->mesh->particles;
    for (size_t i = 0; i < 3; ++i) {
        const double *from = x + corner[(i + 1) % 3], *to = x + corner[(i + 2) % 3];
        for (size_t k = 0; k < 3; ++k) {
            e[i][k] = to[k * n] - from[k * n];
        }
    }
}

/* W x of a triangle, from the differences to its first particle. */
static void turned_row(const weft__angles *own, size_t item, const double *x,
                       double w[3])
{
    const weft__plate_rest *of = &own->plate->matrix.rest;
    const size_t n = own->mesh->particles, first = of->first[item];
    const double *from = x + of->particle[first];
    const double origin[3] = { from[0], from[n], from[2 * n] };
    double sum[3] = { 0.0, 0.0, 0.0 };
    for (size_t j = first; j < of->first[item + 1]; ++j) {
        const double *at = x + of->particle[j], weight = of->weight[j];
        sum[0] += weight * (at[0] - origin[0]);
        sum[1] += weight * (at[n] - origin[1]);
        sum[2] += weight * (at[2 * n] - origin[2]);
    }
    memcpy(w, sum, sizeof sum);
}

static const uint32_t *corners_of(const weft__angles *own, size_t item)
{
    return own->mesh->triangles->corner[own->plate->matrix.rest.triangle[item]];
}

/* y less its part along n. */
static void flatten(const double n[3], double y[3])
{
    const double part = weft__dot(n, y);
    for (size_t k = 0; k < 3; ++k) {
        y[k] -= part * n[k];
    }
}

static void tilt_by(const weft__angles *own, size_t item, const weft__facet *of,
                    const double *x, tilt *out)
{
    double a[3], b[3];
    edges_of(own, corners_of(own, item), x, out->e);
    weft__cross(out->e[1], of->e[2], a);
    weft__cross(of->e[1], out->e[2], b);
    for (size_t k = 0; k < 3; ++k) {
        out->c[k] = a[k] + b[k];
        out->n[k] = out->c[k] * of->per;
    }
    flatten(of->n, out->n);
}

/* The second derivative of the normal along two directions. */
static void tilt_twice(const weft__facet *of, const tilt *a, const tilt *b,
                       double out[3])
{
    double p[3], q[3], c[3];
    weft__cross(a->e[1], b->e[2], p);
    weft__cross(b->e[1], a->e[2], q);
    for (size_t k = 0; k < 3; ++k) {
        c[k] = p[k] + q[k];
    }
    const double along = weft__dot(of->n, a->c), grown = weft__dot(of->n, b->c);
    const double turned = weft__dot(b->n, a->c) + weft__dot(of->n, c);
    for (size_t k = 0; k < 3; ++k) {
        out[k]
            = (c[k] - b->n[k] * along - of->n[k] * turned - a->n[k] * grown) / of->size;
    }
}

/* Adds the gradient of y.n by the corners. */
static void add_lean(const weft__facet *of, const double y[3], double corner[3][3])
{
    const double part = weft__dot(of->n, y);
    const double flat[3]
        = { (y[0] - part * of->n[0]) * of->per, (y[1] - part * of->n[1]) * of->per,
            (y[2] - part * of->n[2]) * of->per };
    for (size_t i = 0; i < 3; ++i) {
        const double *e = of->e[i];
        corner[i][0] += flat[1] * e[2] - flat[2] * e[1];
        corner[i][1] += flat[2] * e[0] - flat[0] * e[2];
        corner[i][2] += flat[0] * e[1] - flat[1] * e[0];
    }
}

/* Adds the change of that gradient along a direction. */
static void add_lean_change(const weft__facet *of, const double y[3], const tilt *by,
                            double scale, double corner[3][3])
{
    double flat[3] = { y[0], y[1], y[2] }, turned[3], p[3], q[3], r[3];
    const double along = weft__dot(of->n, y), other = weft__dot(by->n, y);
    const double grown = weft__dot(of->n, by->c) / of->size;
    flatten(of->n, flat);
    for (size_t k = 0; k < 3; ++k) {
        turned[k] = -by->n[k] * along - of->n[k] * other;
    }
    for (size_t i = 0; i < 3; ++i) {
        weft__cross(turned, of->e[i], p);
        weft__cross(flat, by->e[i], q);
        weft__cross(flat, of->e[i], r);
        for (size_t k = 0; k < 3; ++k) {
            corner[i][k] += scale * (p[k] + q[k] - r[k] * grown) / of->size;
        }
    }
}

/* [s] */
static double damping_of(const weft__angles *own, size_t item)
{
    const weft__triangles *of = own->mesh->triangles;
    return of->fabrics[of->fabric[own->plate->matrix.rest.triangle[item]]].damping[1];
}

void weft__facet_of(const weft__angles *own, size_t item, const double *y,
                    weft__facet *out)
{
    const double *speed = y + 3 * own->mesh->particles;
    double c[3];
    tilt now;
    edges_of(own, corners_of(own, item), y, out->e);
    weft__cross(out->e[1], out->e[2], c);
    out->size = weft__length(c);
    out->per = 1.0 / out->size;
    for (size_t k = 0; k < 3; ++k) {
        out->n[k] = c[k] * out->per;
    }
    turned_row(own, item, y, out->w);
    memset(out->v, 0, sizeof out->v);
    memset(out->rate, 0, sizeof out->rate);
    if (damping_of(own, item) > 0.0) {
        turned_row(own, item, speed, out->v);
        tilt_by(own, item, out, speed, &now);
        memcpy(out->rate, now.n, sizeof out->rate);
    }
}

/* With a direction: the change of n, and of w, by it. */
static void turn_change(const weft__angles *own, size_t item, const weft__facet *now,
                        const weft__state *at, weft__facet_force *out)
{
    const size_t speeds = 3 * own->mesh->particles;
    const double square = own->plate->matrix.rest.square[item];
    const double tau = damping_of(own, item);
    double z[3], dz[3], dv[3] = { 0.0, 0.0, 0.0 }, twice[3] = { 0.0, 0.0, 0.0 };
    tilt by, still, fast;
    tilt_by(own, item, now, at->along, &by);
    turned_row(own, item, at->along, dz);
    memset(&fast, 0, sizeof fast);
    if (tau > 0.0) {
        tilt_by(own, item, now, at->y + speeds, &still);
        tilt_by(own, item, now, at->along + speeds, &fast);
        tilt_twice(now, &still, &by, twice);
        turned_row(own, item, at->along + speeds, dv);
    }
    for (size_t k = 0; k < 3; ++k) {
        const double turn = twice[k] + fast.n[k];
        z[k] = now->w[k] + tau * (now->v[k] - square * now->rate[k]);
        dz[k] += tau * (dv[k] - square * turn);
        out->on[k] = by.n[k] + tau * turn;
    }
    add_lean_change(now, z, &by, 1.0, out->corner);
    add_lean(now, dz, out->corner);
}

void weft__facet_force_of(const weft__angles *own, size_t item, const weft__state *at,
                          weft__facet_force *out)
{
    const double square = own->plate->matrix.rest.square[item];
    const double tau = damping_of(own, item);
    weft__facet now;
    double z[3];
    memset(out, 0, sizeof *out);
    weft__facet_of(own, item, at->y, &now);
    if (at->along != NULL) {
        turn_change(own, item, &now, at, out);
        return;
    }
    for (size_t k = 0; k < 3; ++k) {
        out->on[k] = now.n[k] + tau * now.rate[k];
        z[k] = now.w[k] + tau * (now.v[k] - square * now.rate[k]);
    }
    add_lean(&now, z, out->corner);
}

/* ---- the transpose --------------------------------------------------------------- */

static void add_turn_force(const weft__angles *own, size_t item,
                           const weft__facet_force *of, double scale, double *to)
{
    const weft__plate_rest *rest = &own->plate->matrix.rest;
    const uint32_t *corner = corners_of(own, item);
    const size_t n = own->mesh->particles;
    for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
        for (size_t k = 0; k < 3; ++k) {
            to[k * n + rest->particle[j]] += scale * rest->weight[j] * of->on[k];
        }
    }
    for (size_t i = 0; i < 9; ++i) {
        to[i % 3 * n + corner[i / 3]] += scale * of->corner[i / 3][i % 3];
    }
}

/* The second derivative along x, and what damping by velocities x has, per tau. Returns
 * z = W x - s n', n' by x. */
static void curve_along(const weft__angles *own, size_t item, const weft__facet *now,
                        const double *x, weft__facet_force by[2], tilt *turn,
                        double z[3])
{
    const double square = own->plate->matrix.rest.square[item];
    double rowed[3];
    memset(by, 0, 2 * sizeof *by);
    tilt_by(own, item, now, x, turn);
    turned_row(own, item, x, rowed);
    memcpy(by[0].on, turn->n, sizeof by[0].on);
    memcpy(by[1].on, turn->n, sizeof by[1].on);
    add_lean_change(now, now->w, turn, 1.0, by[0].corner);
    add_lean(now, rowed, by[0].corner);
    for (size_t k = 0; k < 3; ++k) {
        z[k] = rowed[k] - square * turn->n[k];
    }
    add_lean(now, z, by[1].corner);
}

void weft__angles_multiply(const void *own, const weft__state *at, double a, double b,
                           const double *x, double *out)
{
    const weft__angles *of = own;
    for (size_t item = 0; item < of->plate->matrix.rest.count; ++item) {
        weft__facet_force by[2];
        weft__facet now;
        tilt turn;
        double z[3];
        weft__facet_of(of, item, at->y, &now);
        curve_along(of, item, &now, x, by, &turn, z);
        add_turn_force(of, item, &by[0], -a, out);
        add_turn_force(of, item, &by[1], -b * damping_of(of, item), out);
    }
}

/* The elastic part is a second derivative, and symmetric. That of damping is -tau M v
 * with M of the state: its transpose by v is M, that by x the gradient of -tau l.M v.
 */
static void add_angles_transposed(const weft__angles *own, size_t item,
                                  const weft__state *at, double *out)
{
    const size_t speeds = 3 * own->mesh->particles;
    const double square = own->plate->matrix.rest.square[item];
    const double tau = damping_of(own, item);
    weft__facet_force by[2];
    double left[3], z[3];
    weft__facet now;
    tilt turn, still;
    weft__facet_of(own, item, at->y, &now);
    curve_along(own, item, &now, at->along, by, &turn, z);
    if (tau > 0.0) {
        tilt_by(own, item, &now, at->y + speeds, &still);
        for (size_t k = 0; k < 3; ++k) {
            left[k] = now.v[k] - square * now.rate[k];
        }
        add_lean_change(&now, left, &turn, tau, by[0].corner);
        add_lean_change(&now, z, &still, tau, by[0].corner);
        add_turn_force(own, item, &by[1], tau, out + speeds);
    }
    add_turn_force(own, item, &by[0], 1.0, out);
}

void weft__angles_transposed(const void *own, const weft__state *at, double *out)
{
    const weft__angles *of = own;
    for (size_t item = 0; item < of->plate->matrix.rest.count; ++item) {
        add_angles_transposed(of, item, at, out);
    }
}
