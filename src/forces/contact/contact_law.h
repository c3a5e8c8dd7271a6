/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_law.h -- the gap of shapes.c, the law of contact.h and the condition of
 * contact.h for one particle or a vector of them (forces/law.h). */
#pragma once

#include "forces/contact/contact.h"
#include "forces/law.h"

LAW num law_dot(const num a[3], const num b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#ifndef LAW_OF_DUALS /* contact_derivatives.c has those of shapes */
/* ---- shapes ---------------------------------------------------------------------- */

/* Where a particle is to a shape. */
typedef struct law_spot {
    num gap, gradient[3];
    truth joined; /* at an end or an edge, where |gradient| is not 1 */
} law_spot;

/* How far x is above high or below low: > 0, < 0, or 0 between them; NaN stays. */
LAW num law_beyond(num x, double low, double high)
{
    const num over = x - high, under = x - low;
    return CHOOSE(over <= 0.0, NUM(0.0), over) + CHOOSE(under >= 0.0, NUM(0.0), under);
}

LAW num law_along(const num r[3], const double axis[3])
{
    return r[0] * axis[0] + r[1] * axis[1] + r[2] * axis[2];
}

/* Without joins 4-norms have one term: sqrt(a a) is a, from 1e-77 m to 1e77 m. */
LAW void law_capsule(const weft__pose *pose, const num r[3], law_spot *at)
{
    num side[3];
    const num along = law_along(r, pose->axis);
    const num q = law_beyond(along, 0.0, pose->length), q2 = q * q;
    for (size_t k = 0; k < 3; ++k) {
        side[k] = r[k] - along * pose->axis[k];
    }
    const num rho2 = law_dot(side, side);
    at->joined = q2 > 0.0;
    const num norm = ROOT(ANY(at->joined) ? ROOT(rho2 * rho2 + q2 * q2) : rho2);
    const num inverse = 1.0 / (norm * norm * norm);
    const num a = rho2 * inverse, b = q2 * q * inverse;
    for (size_t k = 0; k < 3; ++k) {
        at->gradient[k] = a * side[k] + b * pose->axis[k];
    }
    at->gap = norm - pose->radius;
}

/* a v, or its transpose. */
LAW void law_rotate(const weft__matrix *matrix, bool back, const num v[3], num out[3])
{
    const double(*a)[3] = matrix->row;
    for (size_t k = 0; k < 3; ++k) {
        out[k] = back ? a[0][k] * v[0] + a[1][k] * v[1] + a[2][k] * v[2]
                      : a[k][0] * v[0] + a[k][1] * v[1] + a[k][2] * v[2];
    }
}

LAW void law_box(const weft__pose *pose, const num from[3], law_spot *at)
{
    num q[3], q2[3], r[3] = { from[0], from[1], from[2] };
    if (pose->turned) {
        law_rotate(&pose->frame, true, from, r);
    }
    for (size_t k = 0; k < 3; ++k) {
        q[k] = law_beyond(r[k], -pose->inner[k], pose->inner[k]);
        q2[k] = q[k] * q[k];
    }
    at->joined = q2[0] * q2[1] + q2[1] * q2[2] + q2[2] * q2[0] > 0.0;
    const num norm
        = ROOT(ANY(at->joined) ? ROOT(law_dot(q2, q2)) : q2[0] + q2[1] + q2[2]);
    const num inverse = 1.0 / (norm * norm * norm);
    for (size_t k = 0; k < 3; ++k) {
        at->gradient[k] = q2[k] * q[k] * inverse;
    }
    if (pose->turned) {
        const num local[3] = { at->gradient[0], at->gradient[1], at->gradient[2] };
        law_rotate(&pose->frame, false, local, at->gradient);
    }
    at->gap = norm - pose->radius;
}

/* r: from the shape's place */
LAW void law_spot_of(const weft__pose *pose, weft_shape_kind kind, const num r[3],
                     law_spot *at)
{
    if (kind == WEFT_CAPSULE) {
        law_capsule(pose, r, at);
        return;
    }
    if (kind == WEFT_BOX) {
        law_box(pose, r, at);
        return;
    }
    at->joined = (truth){ 0 };
    if (kind == WEFT_MESH) { /* left to its primitives */
        at->gap = NUM((double)INFINITY);
        return;
    }
    if (kind == WEFT_PLANE) {
        at->gap = law_along(r, pose->axis);
        for (size_t k = 0; k < 3; ++k) {
            at->gradient[k] = NUM(pose->axis[k]);
        }
        return;
    }
    const num distance = ROOT(law_dot(r, r)), inverse = 1.0 / distance;
    at->gap = distance - pose->radius;
    for (size_t k = 0; k < 3; ++k) {
        at->gradient[k] = inverse * r[k];
    }
}

/* [m/s] of the surface that spins so, its place with it. */
LAW void law_moving(const weft__pose *pose, const double spin[3], const num r[3],
                    num velocity[3])
{
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        velocity[k] = pose->velocity[k] + (spin[a] * r[b] - spin[b] * r[a]);
    }
}

LAW void law_surface(const weft__pose *pose, const num r[3], num velocity[3])
{
    law_moving(pose, pose->spin, r, velocity);
}

/* [m/s] By how much a turn makes V differ from a linear interpolation between both
 * ends, for a particle with a constant acceleration: h^2 / 8 times the second
 * derivative of omega x (x - c). */
LAW num law_bend(const weft__ccd *of, num x[2][3], num v[2][3])
{
    num arm2 = NUM(0.0), speed2 = NUM(0.0);
    num change[3] = { NUM(0.0), NUM(0.0), NUM(0.0) };
    for (size_t e = 0; e < 2; ++e) {
        const weft__rigid *now = &of->pose[e].rigid;
        num arm[3], speed[3];
        for (size_t k = 0; k < 3; ++k) {
            arm[k] = x[e][k] - now->about[k];
            speed[k] = v[e][k] - now->velocity[k];
            change[k] = e == 0 ? speed[k] : speed[k] - change[k];
        }
        const num a2 = law_dot(arm, arm), s2 = law_dot(speed, speed);
        arm2 = MOST(a2, arm2);
        speed2 = MOST(s2, speed2);
    }
    return of->twist * ROOT(arm2) + (0.25 * of->h * of->h * of->swing) * ROOT(speed2)
           + (0.125 * of->h * of->fast) * ROOT(law_dot(change, change));
}

/* The displacement of x against X, the point of a shape that turns nearest to it at the
 * start, which moves with the shape. */
LAW void law_displacement(const weft__ccd *of, num r[2][3], const law_spot *start,
                          num displacement[3])
{
    num from[3], to[3];
    for (size_t k = 0; k < 3; ++k) {
        from[k] = r[0][k] - start->gap * start->gradient[k];
    }
    law_rotate(&of->rotation, false, from, to);
    for (size_t k = 0; k < 3; ++k) {
        displacement[k] = (r[1][k] - to[k]) - (r[0][k] - from[k]);
    }
}

/* The condition of contact.h, by places and velocities at both ends; gap: [m] at the
 * ends.
 */
LAW truth law_clear(const weft__ccd *of, weft_shape_kind kind, num x[2][3], num v[2][3],
                    num gap[2])
{
    num r[2][3], displacement[3], square = NUM(0.0);
    law_spot spot[2];
    for (size_t e = 0; e < 2; ++e) {
        const weft__pose *pose = &of->pose[e];
        num surface[3], moved[3], with[3], without[3];
        for (size_t k = 0; k < 3; ++k) {
            r[e][k] = x[e][k] - pose->at[k];
        }
        law_surface(pose, r[e], surface);
        law_moving(pose, pose->rigid.omega, r[e], moved);
        for (size_t k = 0; k < 3; ++k) {
            with[k] = v[e][k] - surface[k];
            without[k] = v[e][k] - moved[k];
        }
        const num w2 = law_dot(with, with), r2 = law_dot(without, without);
        const num both = MOST(w2, r2);
        square = MOST(both, square);
        law_spot_of(pose, kind, r[e], &spot[e]);
        gap[e] = spot[e].gap;
    }
    for (size_t k = 0; k < 3; ++k) {
        displacement[k] = r[1][k] - r[0][k];
    }
    num between = NUM(of->between);
    if (of->turns) {
        between += law_bend(of, x, v);
        law_displacement(of, r, &spot[0], displacement);
    }
    const num reach = gap[0] + gap[1];
    const truth outside = gap[1] > 0.0,
                straight = ROOT(law_dot(displacement, displacement)) < reach;
    const truth slow = of->h * (ROOT(square) + between) < reach;
    return outside & straight & slow;
}
#endif

/* ---- forces ---------------------------------------------------------------------- */

/* s^(p - 2) */
LAW num law_power(num s, int exponent)
{
    num power = s;
    for (int k = 3; k < exponent; ++k) {
        power = power * s;
    }
    return power;
}

typedef struct law_touch {
    num push, factor, stiffness; /* as of weft__touch */
    num energy;                  /* [J/kg] by share */
    num most, under; /* [m/s^2] mu |g| N / m; [m^2/s^2] |w|^2, smooth: + slip^2 + q^2 */
} law_touch;

/* slip2: the square of |w| */
LAW law_touch law_normal_force(const weft_contact_def *law, num friction, num gap,
                               num share, num speed, num slip2, num steepness)
{
    const double half = 0.5 * law->stopping_speed * law->stopping_speed;
    const double per = 1.0 / law->thickness, p = law->exponent;
    const num e = half * share, z = gap * per, s = 1.0 - z;
    const num power = law_power(s, law->exponent);
    const num a = z * (p * (p - 1.0) * z + 2.0 * p * s) + 2.0 * s * s;
    const num b = p * z + s, inverse = OVER(1.0, a * z), iz = a * inverse;
    const num u = law->damping * speed;
    law_touch out;
    out.push = e * per * (power * s) * b * (iz * iz);
    out.factor = ROOT(1.0 + u * u) - u;
    out.stiffness = e * per * per * power * a * (iz * iz * iz);
    out.energy = half * (power * s * s) * iz;
    out.most = friction * (out.push * out.factor) * steepness;
    out.under = slip2;
    if (law->law == WEFT_FRICTION_SMOOTH) {
        const num bend = out.factor * s * b;
        const num scale = 0.01 * e * power * (bend * bend) * inverse;
        out.under = slip2 + (law->slip * law->slip + friction * friction * scale);
    }
    return out;
}

/* [1/s] friction / (m w) */
LAW num law_friction_rate(const weft_contact_def *law, double friction, num most,
                          num under)
{
    const num length = ROOT(under), y = length * (1.0 / law->slip);
    if (friction == 0.0) {
        return NUM(0.0);
    }
    return law->law == WEFT_FRICTION_SMOOTH
               ? OVER(most, length)
               : most
                     * CHOOSE(LESS(y, 1.0), (2.0 - y) * (1.0 / law->slip),
                              OVER(1.0, length));
}
