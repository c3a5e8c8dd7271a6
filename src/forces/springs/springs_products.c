/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_products.c -- products of the linearisation of springs, weight and air with
 * directions of the state: the plain form. */
#include "forces/springs/springs_products.h"

/* Where particle p is in a plane whose rows are `down` apart. */
static size_t springs_spread(const weft__mesh *mesh, size_t down, size_t p)
{
    return down == mesh->cols ? p : p / mesh->cols * down + p % mesh->cols;
}

/* Difference of the ends in planes n apart. */
static void springs_difference(const double *a, size_t n, size_t p, size_t q,
                               double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = a[k * n + q] - a[k * n + p];
    }
}

/* [N] of one of them on p, or its derivative along `along` and with respect to a
 * parameter. */
static void spring_force(const weft__springs *own, weft__spring *at,
                         const weft__tangents *in, const weft__tangent *tangent,
                         double pull[3])
{
    const weft__spring_derivative *by = tangent != NULL ? tangent->by : NULL;
    const unsigned group = at->group->orientation;
    const size_t n = in->stride, p = springs_spread(own->mesh, in->down, at->p);
    const size_t q = springs_spread(own->mesh, in->down, at->q);
    double w[3], dd[3], dw[3];
    springs_difference(in->y, n, p, q, at->d);
    springs_difference(in->y + 3 * n, n, p, q, w);
    at->square = weft__dot(at->d, at->d);
    if (tangent == NULL) {
        const double tension = weft__spring_tension(at, weft__dot(w, at->d));
        for (size_t k = 0; k < 3; ++k) {
            pull[k] = tension * at->d[k];
        }
        return;
    }
    springs_difference(tangent->along, n, p, q, dd);
    springs_difference(tangent->along + 3 * n, n, p, q, dw);
    weft__spring_change(
        at, w, dd, dw,
        by != NULL && (by->orientations >> group & 1) != 0 ? &by->laws[group] : NULL,
        pull);
}

/* [N] of all springs on particle i, or the derivative in a direction (NULL: none). */
static void springs_change_of(const weft__springs *own, size_t i,
                              const weft__tangents *in, const weft__tangent *tangent,
                              double force[3])
{
    double from[3][WEFT_GROUPS] = { 0 }, to[3][WEFT_GROUPS] = { 0 }, pull[3]; /* on p */
    weft__spring springs[WEFT__SPRINGS_MAX];
    const size_t count = weft__particle_springs(own, i, NULL, springs);
    for (weft__spring *at = springs; at < springs + count; ++at) {
        spring_force(own, at, in, tangent, pull);
        for (size_t k = 0; k < 3; ++k) {
            (at->p == i ? from : to)[k][at->group->orientation] = pull[k];
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        force[k] = weft__springs_sum(from[k], to[k]);
    }
}

/* A state as it is. */
static weft__tangents springs_state_of(const weft__springs *own, const double *y)
{
    return (
        weft__tangents){ .y = y, .stride = own->mesh->stride, .down = own->mesh->cols };
}

/* The product of a particle, which is at `place`, in a direction; net[3]: [N] of the
 * state itself. */
static double springs_product_of(const weft__springs *own, const weft__body *body,
                                 const weft__tangents *in, const weft__tangent *tangent,
                                 size_t i, size_t place, const double net[3])
{
    const weft__spring_derivative *by = tangent->by;
    const size_t n = in->stride;
    double springs[3];
    springs_change_of(own, i, in, tangent, springs);
    for (size_t k = 0; k < 3; ++k) {
        const double v = tangent->along[(k + 3) * n + place];
        double force = springs[k] - body->drag * v;
        if (by != NULL) {
            force -= by->drag * in->y[(k + 3) * n + place];
        }
        double rate
            = (by != NULL ? by->gravity[k] : 0.0) + own->mesh->inverse_mass[i] * force;
        if (by != NULL && by->inverse_mass != NULL) {
            rate += by->inverse_mass[i] * net[k];
        }
        tangent->out[k * n + place] = v;
        tangent->out[(k + 3) * n + place] = rate;
    }
    return weft__trouble(tangent->out + place, n);
}

int weft__products_loops(const weft__springs *own, const weft__body *body,
                         const weft__tangents *tangents, size_t first, size_t end)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = tangents->stride, last = weft__block(mesh, end);
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        const size_t place = springs_spread(mesh, tangents->down, i);
        double net[3];
        springs_change_of(own, i, tangents, NULL, net);
        for (size_t k = 0; k < 3; ++k) {
            const double v = tangents->y[(k + 3) * n + place];
            net[k] -= body->drag * v;
            if (tangents->base != NULL) {
                tangents->base[k * n + place] = v;
                tangents->base[(k + 3) * n + place]
                    = body->gravity[k] + mesh->inverse_mass[i] * net[k];
            }
        }
        bad += tangents->base != NULL ? weft__trouble(tangents->base + place, n) : 0.0;
        for (size_t j = 0; j < tangents->count; ++j) {
            bad += springs_product_of(own, body, tangents, &tangents->tangent[j], i,
                                      place, net);
        }
    }
    return bad == 0.0 ? 0 : 1;
}

int weft__springs_along(const weft__springs *own, const weft__body *body,
                        const weft__state *at, double *to, size_t first, size_t end)
{
    weft__tangents one = springs_state_of(own, at->y);
    one.count = 1;
    one.tangent[0] = (weft__tangent){ at->along, to, NULL };
    return own->products(own, body, &one, first, end);
}
