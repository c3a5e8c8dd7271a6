/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_derivatives.c -- the derivatives of contact, per unit mass, along (dx, dv):
 * docs/theory/sensitivities.md, "The derivatives of the forces". friction = most hold
 * w, most = mu |g| N, d hold = -fade (w.dw + d(q^2) / 2). */
#include "forces/contact/contact_law.h"

typedef struct law_partials {
    double normal_stiffness, normal_damping; /* [1/s^2] S, [1/s] D */
    double most;                             /* [m/s^2] */
    double hold, fade;                       /* [s/m], [s^3/m^3] */
    double gap, speed;                       /* the derivatives of q^2 / 2 by both */
} law_partials;

/* q^2 = mu^2 e f^2 s^p b^2 / (100 a z) and b = p z + s, a = p (p - 1) z^2 + 2 p s z + 2
 * s^2; along s = 1 - z. */
static void smooth_partials(const weft_contact_def *law, double friction,
                            const weft__touch *touch, law_partials *of)
{
    const double per = 1.0 / law->thickness, p = law->exponent;
    const double z = touch->gap * per, s = 1.0 - z, b = p * z + s;
    const double a = z * (p * (p - 1.0) * z + 2.0 * p * s) + 2.0 * s * s;
    const double steep = 2.0 * p * (p - 1.0) * z + 2.0 * p * (s - z) - 4.0 * s;
    const double u = law->damping * touch->speed, f = touch->factor;
    const double e = 0.5 * law->stopping_speed * law->stopping_speed;
    const double scale = 0.01 * friction * friction * e * f * f
                         * law_power(s, law->exponent) * s * b / (a * z);
    const double square
        = weft__dot(touch->slip, touch->slip) + law->slip * law->slip + scale * s * b;
    of->hold = 1.0 / sqrt(square);
    of->fade = of->hold / square;
    of->gap = 0.5 * per * scale
              * (2.0 * s * (p - 1.0) - p * b - s * b * (steep / a + 1.0 / z));
    of->speed = -scale * s * b * law->damping / sqrt(1.0 + u * u);
}

static void coulomb_partials(const weft_contact_def *law, const weft__touch *touch,
                             law_partials *of)
{
    const double length = weft__length(touch->slip), slip = law->slip;
    const double inverse = length > 0.0 ? 1.0 / length : 0.0;
    const bool slides = length >= slip;
    of->hold = slides ? inverse : (2.0 - length / slip) / slip;
    of->fade = slides ? inverse * inverse * inverse : inverse / (slip * slip);
}

static law_partials partials_of(const weft_contact_def *law, double friction,
                                const weft__touch *touch)
{
    const double u = law->damping * touch->speed, push = touch->push * touch->factor;
    law_partials of = { .normal_stiffness = touch->stiffness * touch->factor,
                        .normal_damping = law->damping * push / sqrt(1.0 + u * u),
                        .most = friction * push * touch->steepness };
    if (friction != 0.0 && law->law == WEFT_FRICTION_SMOOTH) {
        smooth_partials(law, friction, touch, &of);
    } else if (friction != 0.0) {
        coulomb_partials(law, touch, &of);
    }
    return of;
}

/* n, n.(v - V) and w, and |g|, along (dx, dv). */
typedef struct turned {
    double gradient[3], slip[3], speed, steepness;
} turned;

static turned turned_of(const weft__touches *at, const double dx[3], const double dv[3])
{
    const weft__touch *touch = &at->touch;
    const size_t m = at->own->mesh->particles;
    const double x[3] = { at->y[at->i], at->y[m + at->i], at->y[2 * m + at->i] };
    const double *spin = at->pose.spin, *n = touch->normal;
    double dn[3], moving[3];
    turned by;
    weft__shape_turn(&at->pose, x, touch->gradient, dx, by.gradient);
    by.steepness = weft__dot(n, by.gradient);
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        dn[k] = (by.gradient[k] - by.steepness * n[k]) / touch->steepness;
        moving[k] = dv[k] - (spin[a] * dx[b] - spin[b] * dx[a]);
    }
    by.speed = weft__dot(dn, touch->slip) + weft__dot(n, moving);
    for (size_t k = 0; k < 3; ++k) {
        by.slip[k] = moving[k] - by.speed * n[k] - touch->speed * dn[k];
    }
    return by;
}

/* [m/s^2] The change of a touch's F / m. */
static void contact_change_of(const weft__touches *at, const law_partials *of,
                              const double dx[3], const double dv[3], double change[3])
{
    const weft__touch *touch = &at->touch;
    const turned by = turned_of(at, dx, dv);
    const double gap = weft__dot(touch->gradient, dx);
    const double push = touch->push * touch->factor;
    const double pushed = -of->normal_stiffness * gap - of->normal_damping * by.speed;
    const double most
        = at->pose.friction * (by.steepness * push + touch->steepness * pushed);
    const double slower
        = weft__dot(touch->slip, by.slip) + of->gap * gap + of->speed * by.speed;
    const double friction_rate = most * of->hold - of->most * of->fade * slower;
    for (size_t k = 0; k < 3; ++k) {
        const double friction
            = friction_rate * touch->slip[k] + of->most * of->hold * by.slip[k];
        change[k] = pushed * touch->gradient[k] + push * by.gradient[k] - friction;
    }
}

int weft__contact_change(const void *own, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end)
{
    const weft__contact *of = own;
    const size_t n = of->mesh->particles;
    double bad = 0.0;
    (void)unit;
    for (weft__touches all
         = weft__touches_of(of, at->t, at->y, weft__block(of->mesh, first),
                            weft__block(of->mesh, end));
         weft__each_touch(&all);) {
        const law_partials by = partials_of(&of->law, all.pose.friction, &all.touch);
        const double *d = at->along + all.i;
        const double dx[3] = { d[0], d[n], d[2 * n] };
        const double dv[3] = { d[3 * n], d[4 * n], d[5 * n] };
        double change[3];
        contact_change_of(&all, &by, dx, dv, change);
        for (size_t k = 0; k < 3; ++k) {
            const double more = all.touch.gap > 0.0 ? change[k] : (double)NAN;
            to[k * n + all.i] += more;
            bad += more * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
}

/* -d(F / m) by x and by v of a touch: rows and columns. */
static void matrices(const weft__touches *at, double stiffness[3][3],
                     double damping[3][3])
{
    static const double none[3];
    const law_partials of = partials_of(&at->own->law, at->pose.friction, &at->touch);
    for (size_t c = 0; c < 3; ++c) {
        const double unit[3] = { c == 0, c == 1, c == 2 };
        double by_x[3], by_v[3];
        contact_change_of(at, &of, unit, none, by_x);
        contact_change_of(at, &of, none, unit, by_v);
        for (size_t r = 0; r < 3; ++r) {
            stiffness[r][c] = -by_x[r];
            damping[r][c] = -by_v[r];
        }
    }
}

void weft__contact_transposed(const void *own, const weft__state *at, double *out)
{
    const weft__contact *of = own;
    const size_t n = of->mesh->particles;
    for (weft__touches all = weft__touches_of(of, at->t, at->y, 0, n);
         weft__each_touch(&all);) {
        double stiffness[3][3], damping[3][3];
        matrices(&all, stiffness, damping);
        for (size_t r = 0; r < 3; ++r) {
            const double l = of->mesh->mass[all.i] * at->along[r * n + all.i];
            for (size_t c = 0; c < 3; ++c) {
                out[c * n + all.i] -= l * stiffness[r][c];
                out[(3 + c) * n + all.i] -= l * damping[r][c];
            }
        }
    }
}

/* Takes out what the speed along n does across it. */
static void uncouple(const double n[3], double damping[3][3])
{
    double by[3];
    for (size_t r = 0; r < 3; ++r) {
        by[r] = weft__dot(damping[r], n);
    }
    const double in = weft__dot(by, n);
    for (size_t r = 0; r < 3; ++r) {
        for (size_t c = 0; c < 3; ++c) {
            damping[r][c] -= (by[r] - in * n[r]) * n[c];
        }
    }
}

int weft__contact_blocks(const void *own, void *space, const weft__state *at,
                         double *blocks)
{
    (void)space;
    const weft__contact *of = own;
    const size_t n = of->mesh->particles;
    double bad = 0.0;
    for (weft__touches all = weft__touches_of(of, at->t, at->y, 0, n);
         weft__each_touch(&all);) {
        double stiffness[3][3], damping[3][3], *to = blocks + all.i;
        const double m = all.touch.gap > 0.0 ? of->mesh->mass[all.i] : (double)NAN;
        matrices(&all, stiffness, damping);
        uncouple(all.touch.normal, damping);
        for (size_t r = 0; r < 3; ++r) {
            for (size_t c = 0; c < 3; ++c, to += n) {
                *to += m * stiffness[r][c];
                bad += *to * 0.0;
            }
        }
        for (size_t r = 0; r < 3; ++r) {
            for (size_t c = r; c < 3; ++c, to += n) {
                *to += m * damping[r][c];
                bad += *to * 0.0;
            }
        }
    }
    return bad == 0.0 ? 0 : 1;
}

/* ---- bounds ---------------------------------------------------------------------- */

/* The derivatives of a contact, per unit mass. */
typedef struct contact_partials {
    double push;          /* [m/s^2] N */
    double stiffness;     /* [1/s^2] S = kn f |g|^2 along n */
    double damping;       /* [1/s] D = damping N |g| / sqrt(1 + u^2) along n */
    double friction_rate; /* [1/s] T of friction, across the slip: the larger one */
    double speed;         /* [m/s] |w| + |n.(v - V)| */
    double curvature;     /* [1/m] no normal turns faster */
    double spin;          /* [rad/s] */
    double friction;
} contact_partials;

static void contact_add_partials(const contact_partials *of,
                                 weft__range_stiffness *range_stiffness)
{
    const double mu = of->friction;
    const double damping = of->damping * (1.0 + mu) + of->friction_rate;
    range_stiffness->any_stiffness += 0.5 * mu * of->stiffness
                                      + damping * (of->curvature * of->speed + of->spin)
                                      + of->curvature * mu * of->push;
    range_stiffness->any_damping += 0.5 * mu * of->damping;
    range_stiffness->negative_stiffness += of->curvature * of->push;
}

/* The normal turns by 1 / (r + d) about a ball and round a capsule, by at most 3 / (r +
 * d) over |gradient| >= 0.75 at a join, and not at all along a plane. */
static double curvature(const weft__pose *pose, double gap, bool joined)
{
    const bool flat = pose->kind == WEFT_PLANE || (pose->kind == WEFT_BOX && !joined);
    return flat ? 0.0 : (joined ? 4.0 : 1.0) / (pose->radius + gap);
}

static contact_partials contact_partials_of(const weft_contact_def *law,
                                            const weft__pose *pose,
                                            const weft__touch *touch)
{
    const double g = touch->steepness, u = law->damping * touch->speed;
    const double push = touch->push * touch->factor;
    return (contact_partials){
        .push = push,
        .stiffness = touch->stiffness * touch->factor * (g * g),
        .damping = law->damping * push * g / sqrt(1.0 + u * u),
        .friction_rate = touch->friction_rate,
        .speed = weft__length(touch->slip) + fabs(touch->speed),
        .curvature = curvature(pose, touch->gap, touch->joined),
        .spin = weft__length(pose->spin),
        .friction = pose->friction,
    };
}

static void add_touches(const weft__contact *own, const weft__state *at, size_t i,
                        weft__range_stiffness *range_stiffness)
{
    for (weft__touches all = weft__touches_of(own, at->t, at->y, i, i + 1);
         weft__each_touch(&all);) {
        const contact_partials of
            = contact_partials_of(&own->law, &all.pose, &all.touch);
        weft__range_stiffness_add(range_stiffness, all.touch.normal, of.stiffness,
                                  of.damping, of.friction_rate);
        contact_add_partials(&of, range_stiffness);
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
static contact_partials most_between(const weft_contact_def *law,
                                     const weft__pose *pose, double share, double low,
                                     double high)
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
    return (contact_partials){
        .push = touch.push * touch.factor,
        .stiffness = touch.stiffness * touch.factor,
        .damping = law->damping * touch.push * (1.0 + a / sqrt(1.0 + a * a)),
        .friction_rate = touch.friction_rate,
        .speed = 2.0 * speed,
        .curvature = curvature(pose, 0.0, joins),
        .spin = weft__length(pose->spin),
        .friction = mu,
    };
}

void weft__range_stiffness_most(const weft_contact_def *law, const weft__pose *pose,
                                double share, double phi, weft__range_stiffness *most)
{
    enum { PARTS = 64 };
    const double end = deepest(law->exponent, phi);
    for (size_t k = 0; k < PARTS; ++k) {
        const double low = end * (double)k / (double)PARTS;
        const contact_partials of
            = most_between(law, pose, share, low, low + end / (double)PARTS);
        weft__range_stiffness range_stiffness = { .any_stiffness = 0.0 };
        contact_add_partials(&of, &range_stiffness);
        for (size_t j = 0; j < 3; ++j) {
            const double damping
                = fmax(of.damping, of.friction_rate) + range_stiffness.any_damping;
            most->normal_stiffness[j]
                = fmax(most->normal_stiffness[j],
                       of.stiffness + range_stiffness.any_stiffness);
            most->friction_damping[j] = fmax(most->friction_damping[j], damping);
        }
    }
}

static weft__range_stiffness range_stiffness_any(const weft__contact *own)
{
    weft__range_stiffness most = { .any_stiffness = 0.0 };
    for (size_t k = 0; k < own->shape_count; ++k) {
        const weft__shape *shape = &own->shapes[k];
        weft__pose pose = weft__pose_of(shape, 0.0);
        const double spin = weft__length(shape->spin);
        pose.spin[0] = spin + weft__rigid_fastest(&shape->motion); /* at any time */
        pose.spin[1] = pose.spin[2] = 0.0;
        weft__range_stiffness_most(&own->law, &pose, 1.0, 1.0, &most);
    }
    return most;
}

void weft__shapes_range_stiffness(const void *own, void *space, const weft__state *at,
                                  size_t first, size_t count,
                                  weft__range_stiffness *range_stiffness)
{
    (void)space;
    const weft__contact *of = own;
    const weft__range_stiffness any
        = at->y == NULL ? range_stiffness_any(of) : (weft__range_stiffness){ 0 };
    for (size_t i = 0; i < count; ++i) {
        range_stiffness[i] = any;
        if (at->y != NULL) {
            add_touches(of, at, first + i, &range_stiffness[i]);
        }
    }
}

/* ---- the power method ------------------------------------------------------------ */

/* [1/s] The slope of friction along the slip. */
static double friction_rate_along(const weft_contact_def *law, const weft__touch *touch,
                                  double friction)
{
    const double slip = weft__length(touch->slip);
    const double most = friction * touch->push * touch->factor * touch->steepness;
    if (law->law == WEFT_FRICTION_SMOOTH && most > 0.0) {
        const double part = slip * touch->friction_rate / most;
        return touch->friction_rate * (1.0 - part * part);
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
        const contact_partials of
            = contact_partials_of(&contact->law, &all.pose, touch);
        const double along
            = friction_rate_along(&contact->law, touch, all.pose.friction);
        const double slip = weft__length(touch->slip), m = contact->mesh->mass[all.i];
        const double here[3] = { x[all.i], x[n + all.i], x[2 * n + all.i] };
        const double in = weft__dot(here, touch->normal);
        const double by = slip > 0.0 ? weft__dot(here, touch->slip) / slip : 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const double slip_direction = slip > 0.0 ? touch->slip[k] / slip : 0.0;
            const double across = here[k] - in * touch->normal[k] - by * slip_direction;
            out[k * n + all.i]
                += m
                   * ((a * of.stiffness + b * of.damping) * in * touch->normal[k]
                      + b * (of.friction_rate * across + along * by * slip_direction));
        }
    }
}
