/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_slopes.c -- the derivatives of contact, by mass, along (dx, dv):
 * docs/physics.md, "The derivatives of the forces". friction = most hold w, most = mu
 * |g| N, d hold = -fade (w.dw + d(q^2) / 2). */
#include "forces/contact/contact_law.h"

typedef struct law_slopes {
    double press, damp; /* [1/s^2] S, [1/s] D */
    double most;        /* [m/s^2] */
    double hold, fade;  /* [s/m], [s^3/m^3] */
    double gap, speed;  /* the derivatives of q^2 / 2 by both */
} law_slopes;

/* q^2 = mu^2 e f^2 s^p b^2 / (100 a z) and b = p z + s, a = p (p - 1) z^2 + 2 p s z + 2
 * s^2; along s = 1 - z. */
static void smooth_slopes(const weft_contact_def *law, double friction,
                          const weft__touch *touch, law_slopes *of)
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

static void coulomb_slopes(const weft_contact_def *law, const weft__touch *touch,
                           law_slopes *of)
{
    const double length = weft__length(touch->slip), slip = law->slip;
    const double inverse = length > 0.0 ? 1.0 / length : 0.0;
    const bool slides = length >= slip;
    of->hold = slides ? inverse : (2.0 - length / slip) / slip;
    of->fade = slides ? inverse * inverse * inverse : inverse / (slip * slip);
}

static law_slopes slopes_of(const weft_contact_def *law, double friction,
                            const weft__touch *touch)
{
    const double u = law->damping * touch->speed, push = touch->push * touch->factor;
    law_slopes of = { .press = touch->stiffness * touch->factor,
                      .damp = law->damping * push / sqrt(1.0 + u * u),
                      .most = friction * push * touch->steepness };
    if (friction != 0.0 && law->law == WEFT_FRICTION_SMOOTH) {
        smooth_slopes(law, friction, touch, &of);
    } else if (friction != 0.0) {
        coulomb_slopes(law, touch, &of);
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
static void change_of(const weft__touches *at, const law_slopes *of, const double dx[3],
                      const double dv[3], double change[3])
{
    const weft__touch *touch = &at->touch;
    const turned by = turned_of(at, dx, dv);
    const double gap = weft__dot(touch->gradient, dx);
    const double push = touch->push * touch->factor;
    const double pushed = -of->press * gap - of->damp * by.speed;
    const double most
        = at->pose.friction * (by.steepness * push + touch->steepness * pushed);
    const double slower
        = weft__dot(touch->slip, by.slip) + of->gap * gap + of->speed * by.speed;
    const double drag = most * of->hold - of->most * of->fade * slower;
    for (size_t k = 0; k < 3; ++k) {
        const double friction
            = drag * touch->slip[k] + of->most * of->hold * by.slip[k];
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
        const law_slopes by = slopes_of(&of->law, all.pose.friction, &all.touch);
        const double *d = at->along + all.i;
        const double dx[3] = { d[0], d[n], d[2 * n] };
        const double dv[3] = { d[3 * n], d[4 * n], d[5 * n] };
        double change[3];
        change_of(&all, &by, dx, dv, change);
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
    const law_slopes of = slopes_of(&at->own->law, at->pose.friction, &at->touch);
    for (size_t c = 0; c < 3; ++c) {
        const double unit[3] = { c == 0, c == 1, c == 2 };
        double by_x[3], by_v[3];
        change_of(at, &of, unit, none, by_x);
        change_of(at, &of, none, unit, by_v);
        for (size_t r = 0; r < 3; ++r) {
            stiffness[r][c] = -by_x[r];
            damping[r][c] = -by_v[r];
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

int weft__contact_blocks(const void *own, const weft__state *at, double *blocks)
{
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
