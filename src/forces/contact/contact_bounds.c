/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/contact.h"

/* The derivatives of a contact, by mass. */
typedef struct slopes {
    double push;      /* [m/s^2] N */
    double stiffness; /* [1/s^2] S = kn f |g|^2 along n */
    double damping;   /* [1/s] D = damping N |g| / sqrt(1 + u^2) along n */
    double drag;      /* [1/s] T of friction, across the slip: the larger one */
    double speed;     /* [m/s] |w| + |n.(v - V)| */
    double curvature; /* [1/m] no normal turns faster */
    double spin;      /* [rad/s] */
    double friction;
} slopes;

static void add_slopes(const slopes *of, weft__grip *grip)
{
    const double mu = of->friction;
    const double damping = of->damping * (1.0 + mu) + of->drag;
    grip->stiff += 0.5 * mu * of->stiffness
                   + damping * (of->curvature * of->speed + of->spin)
                   + of->curvature * mu * of->push;
    grip->drag += 0.5 * mu * of->damping;
    grip->turn += of->curvature * of->push;
}

/* The normal turns by 1 / (r + d) about a ball and round a capsule, by at most 3 / (r +
 * d) over |gradient| >= 0.75 at a join, and not at all along a plane. */
static double curvature(const weft__pose *pose, double gap, bool joined)
{
    const bool flat = pose->kind == WEFT_PLANE || (pose->kind == WEFT_BOX && !joined);
    return flat ? 0.0 : (joined ? 4.0 : 1.0) / (pose->radius + gap);
}

static slopes slopes_of(const weft_contact_def *law, const weft__pose *pose,
                        const weft__touch *touch)
{
    const double g = touch->steepness, u = law->damping * touch->speed;
    const double push = touch->push * touch->factor;
    return (slopes){
        .push = push,
        .stiffness = touch->stiffness * touch->factor * (g * g),
        .damping = law->damping * push * g / sqrt(1.0 + u * u),
        .drag = touch->drag,
        .speed = weft__length(touch->slip) + fabs(touch->speed),
        .curvature = curvature(pose, touch->gap, touch->joined),
        .spin = weft__length(pose->spin),
        .friction = pose->friction,
    };
}

/* n n^T */
static void outer(const double n[3], double nn[6])
{
    nn[0] = n[0] * n[0], nn[1] = n[1] * n[1], nn[2] = n[2] * n[2];
    nn[3] = n[0] * n[1], nn[4] = n[0] * n[2], nn[5] = n[1] * n[2];
}

static void add_touches(const weft__contact *own, const weft__state *at, size_t i,
                        weft__grip *grip)
{
    for (weft__touches all = weft__touches_of(own, at->t, at->y, i, i + 1);
         weft__each_touch(&all);) {
        const slopes of = slopes_of(&own->law, &all.pose, &all.touch);
        double nn[6];
        outer(all.touch.normal, nn);
        for (size_t k = 0; k < 6; ++k) {
            grip->press[k] += of.stiffness * nn[k];
            grip->damp[k] += of.damping * nn[k];
            grip->slide[k] += of.drag * ((k < 3 ? 1.0 : 0.0) - nn[k]);
        }
        add_slopes(&of, grip);
    }
}

/* ---- in any state ---------------------------------------------------------------- */

/* phi(s), from 0 to beyond 1. */
static double phi(double s, int exponent)
{
    double power = 1.0;
    for (int k = 0; k < exponent; ++k) {
        power *= s;
    }
    return power / (1.0 - s);
}

/* A hair more than the s where phi(s) = value. */
static double deepest(int exponent, double value)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        if (phi(middle, exponent) < value) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

/* The slopes at s in [low, high], no number of them less than any: forces grow with s
 * and with the speed against the shape, which is largest at `low`. */
static slopes most_between(const weft_contact_def *law, const weft__pose *pose,
                           double share, double low, double high)
{
    const double speed
        = law->stopping_speed * sqrt(fmax(0.0, 1.0 - phi(low, law->exponent)));
    const double a = law->damping * speed, mu = pose->friction;
    weft__touch touch = { .gap = (1.0 - high) * law->thickness,
                          .share = share,
                          .speed = -speed,
                          .steepness = 1.0 };
    weft__touch_forces(law, mu, &touch);
    const bool joins = pose->kind == WEFT_CAPSULE || pose->kind == WEFT_BOX;
    return (slopes){
        .push = touch.push * touch.factor,
        .stiffness = touch.stiffness * touch.factor,
        .damping = law->damping * touch.push * (1.0 + a / sqrt(1.0 + a * a)),
        .drag = touch.drag,
        .speed = 2.0 * speed,
        .curvature = curvature(pose, 0.0, joins),
        .spin = weft__length(pose->spin),
        .friction = mu,
    };
}

void weft__grip_most(const weft_contact_def *law, const weft__pose *pose, double share,
                     double phi, weft__grip *most)
{
    enum { PARTS = 64 };
    const double end = deepest(law->exponent, phi);
    for (size_t k = 0; k < PARTS; ++k) {
        const double low = end * (double)k / PARTS;
        const slopes of = most_between(law, pose, share, low, low + end / PARTS);
        weft__grip grip = { .stiff = 0.0 };
        add_slopes(&of, &grip);
        for (size_t j = 0; j < 3; ++j) {
            const double damping = fmax(of.damping, of.drag) + grip.drag;
            most->press[j] = fmax(most->press[j], of.stiffness + grip.stiff);
            most->slide[j] = fmax(most->slide[j], damping);
        }
    }
}

static weft__grip grip_any(const weft__contact *own)
{
    weft__grip most = { .stiff = 0.0 };
    for (size_t k = 0; k < own->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&own->shapes[k], 0.0);
        weft__grip_most(&own->law, &pose, 1.0, 1.0, &most);
    }
    return most;
}

void weft__contact_grip(const void *own, const weft__state *at, size_t first,
                        size_t count, weft__grip *grips)
{
    const weft__contact *of = own;
    const weft__grip any = at->y == NULL ? grip_any(of) : (weft__grip){ 0 };
    for (size_t i = 0; i < count; ++i) {
        grips[i] = any;
        if (at->y != NULL) {
            add_touches(of, at, first + i, &grips[i]);
        }
    }
}

/* ---- the power method ------------------------------------------------------------ */

/* [1/s] The slope of friction along the slip. */
static double drag_along(const weft_contact_def *law, const weft__touch *touch,
                         double friction)
{
    const double slip = weft__length(touch->slip);
    const double most = friction * touch->push * touch->factor * touch->steepness;
    if (law->law == WEFT_FRICTION_SMOOTH && most > 0.0) {
        const double part = slip * touch->drag / most;
        return touch->drag * (1.0 - part * part);
    }
    return fmax(0.0, 2.0 * most * (1.0 - slip / law->slip) / law->slip);
}

void weft__contact_multiply(const void *own, const weft__state *at, double a, double b,
                            const double *x, double *out)
{
    const weft__contact *contact = own;
    const size_t n = contact->mesh->particles;
    for (weft__touches all = weft__touches_of(contact, at->t, at->y, 0, n);
         weft__each_touch(&all);) {
        const weft__touch *touch = &all.touch;
        const slopes of = slopes_of(&contact->law, &all.pose, touch);
        const double along = drag_along(&contact->law, touch, all.pose.friction);
        const double slip = weft__length(touch->slip), m = contact->mesh->mass[all.i];
        const double here[3] = { x[all.i], x[n + all.i], x[2 * n + all.i] };
        const double in = weft__dot(here, touch->normal);
        const double by = slip > 0.0 ? weft__dot(here, touch->slip) / slip : 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const double way = slip > 0.0 ? touch->slip[k] / slip : 0.0;
            const double across = here[k] - in * touch->normal[k] - by * way;
            out[k * n + all.i]
                += m
                   * ((a * of.stiffness + b * of.damping) * in * touch->normal[k]
                      + b * (of.drag * across + along * by * way));
        }
    }
}
