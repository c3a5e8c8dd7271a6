/* SPDX-License-Identifier: BSD-3-Clause */
/* self.c -- the forces of self-contact. A pair with the foot-point difference
 * r = sum b_i x_i, d = |r| < dh = thickness, whose feet are inside both primitives, has
 *
 *     U = M e W phi(1 - d / dh) / 4,   M = smallest mass of its free particles
 *     F_i = b_i (N n - friction) - M e phi / 4 dW/dx_i,   n = r / d
 *
 * by the law of contact.h for m = M, e W / 4 for e and v = sum b_i v_i. The weight W is
 * a product of S(x) = y^4 (35 - 84 y + 70 y^2 - 20 y^3), y = x / x0 <= 1, of the feet's
 * coordinates and, for edges, of z = |e1 x e2|^2 by its value at rest for perpendicular
 * ones. The feet satisfy e_k.r = 0 for the edges e_k; hence along dx, with
 * delta = sum b_i dx_i, dW = lean.delta + turn_1.de_1 + turn_2.de_2. */
#include "cloth/self.h"

#include <stdio.h>
#include <string.h>

#include "cloth/contact.h"

/* The share of each pair: a particle between two layers has some four. */
#define SHARE 0.25
/* x0 of z, and the smallest sine^2 of edges that are not parallel. */
#define SOFT_ANGLE 0.25
#define PARALLEL   1e-12

const char *weft_primitive_text(const weft_primitive *primitive, size_t cols,
                                char *text, size_t size)
{
    const size_t *i = primitive->particle;
    size_t r[3] = { 0 }, c[3] = { 0 };
    for (size_t k = 0; k < primitive->count; ++k) {
        r[k] = i[k] / cols, c[k] = i[k] % cols;
    }
    if (primitive->count == 1) {
        (void)snprintf(text, size, "particle (%zu, %zu)", r[0], c[0]);
    } else if (primitive->count == 2) {
        (void)snprintf(text, size, "edge (%zu, %zu)-(%zu, %zu)", r[0], c[0], r[1],
                       c[1]);
    } else {
        const size_t top = r[0] < r[1] ? r[0] : r[1], left = c[0] < c[1] ? c[0] : c[1];
        (void)snprintf(text, size, "cell (%zu, %zu)", top < r[2] ? top : r[2],
                       left < c[2] ? left : c[2]);
    }
    return text;
}

weft__self_law weft__self_law_of(const weft_cloth *cloth)
{
    const double a2 = cloth->spacing[0] * cloth->spacing[0];
    const double b2 = cloth->spacing[1] * cloth->spacing[1];
    const double smaller
        = weft__smaller_spacing(cloth->rows, cloth->cols, cloth->spacing);
    return (weft__self_law){ .cloth = cloth,
                             .soft = fmin(cloth->contact.thickness / smaller, 0.3),
                             .square = { a2, b2, a2 + b2 } };
}

/* ---- weights --------------------------------------------------------------------- */

/* S(x) and its derivative. */
static inline double step(double x, double soft, double *slope)
{
    if (x >= soft) {
        *slope = 0.0;
        return 1.0;
    }
    const double y = x / soft, y3 = y * y * y, z = 1.0 - y;
    *slope = 140.0 * y3 * (z * z * z) / soft;
    return y3 * y * (35.0 - y * (84.0 - y * (70.0 - 20.0 * y)));
}

/* S(s) S(1 - s) and its derivative. */
static inline double both_ends(double s, double soft, double *slope)
{
    double from_0, from_1;
    const double a = step(s, soft, &from_0), b = step(1.0 - s, soft, &from_1);
    *slope = from_0 * b - a * from_1;
    return a * b;
}

/* The feet of a pair that are inside both. */
typedef struct feet {
    double arm[4];     /* b_i */
    double r[3], d;    /* [m] */
    double weight;     /* W */
    bool leans;        /* or the next ones are 0 */
    double lean[3];    /* [1/m] */
    double turn[2][3]; /* [1/m] */
} feet;

static inline void from_to(const double a[3], const double b[3], double d[3])
{
    d[0] = b[0] - a[0], d[1] = b[1] - a[1], d[2] = b[2] - a[2];
}

static inline bool within(feet *at, double thickness)
{
    const double square = weft__dot(at->r, at->r);
    at->d = sqrt(square);
    return at->d < thickness;
}

static bool vertices_feet(double x[4][3], double thickness, feet *at)
{
    from_to(x[1], x[0], at->r);
    at->arm[0] = 1.0, at->arm[1] = -1.0;
    at->weight = 1.0;
    at->leans = false;
    return within(at, thickness);
}

static bool vertex_edge_feet(const weft__self_law *law, double x[4][3], feet *at)
{
    double e[3], p[3], slope;
    from_to(x[1], x[2], e);
    from_to(x[1], x[0], p);
    const double square = weft__dot(e, e), s = weft__dot(e, p) / square;
    if (!(s > 0.0 && s < 1.0)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        at->r[k] = p[k] - s * e[k];
    }
    if (!within(at, law->cloth->contact.thickness)) {
        return false;
    }
    at->arm[0] = 1.0, at->arm[1] = s - 1.0, at->arm[2] = -s;
    at->weight = both_ends(s, law->soft, &slope);
    at->leans = slope != 0.0;
    const double by = slope / square;
    for (size_t k = 0; k < 3; ++k) {
        at->lean[k] = by * e[k];
        at->turn[0][k] = by * at->r[k];
    }
    return true;
}

static bool vertex_triangle_feet(const weft__self_law *law, double x[4][3], feet *at)
{
    double e[3], f[3], p[3], by_u, by_v, by_z;
    from_to(x[1], x[2], e);
    from_to(x[1], x[3], f);
    from_to(x[1], x[0], p);
    const double ee = weft__dot(e, e), ff = weft__dot(f, f), ef = weft__dot(e, f);
    const double ep = weft__dot(e, p), fp = weft__dot(f, p);
    const double inverse = 1.0 / (ee * ff - ef * ef);
    const double u = (ff * ep - ef * fp) * inverse, v = (ee * fp - ef * ep) * inverse;
    const double z = 1.0 - u - v;
    if (!(u > 0.0 && v > 0.0 && z > 0.0)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        at->r[k] = p[k] - u * e[k] - v * f[k];
    }
    if (!within(at, law->cloth->contact.thickness)) {
        return false;
    }
    at->arm[0] = 1.0, at->arm[1] = -z, at->arm[2] = -u, at->arm[3] = -v;
    const double su = step(u, law->soft, &by_u), sv = step(v, law->soft, &by_v);
    const double sz = step(z, law->soft, &by_z);
    at->weight = su * sv * sz;
    const double gu = by_u * sv * sz - su * sv * by_z;
    const double gv = su * by_v * sz - su * sv * by_z;
    at->leans = gu != 0.0 || gv != 0.0;
    const double by_e = (ff * gu - ef * gv) * inverse;
    const double by_f = (ee * gv - ef * gu) * inverse;
    for (size_t k = 0; k < 3; ++k) {
        at->lean[k] = by_e * e[k] + by_f * f[k];
        at->turn[0][k] = by_e * at->r[k];
        at->turn[1][k] = by_f * at->r[k];
    }
    return true;
}

/* [m^2] of an edge at rest */
static double rest_square(const weft__self_law *law, uint32_t a, uint32_t b)
{
    const uint32_t by = a < b ? b - a : a - b;
    return by == 1 && law->cloth->cols > 1 ? law->square[1]
           : by == law->cloth->cols        ? law->square[0]
                                           : law->square[2];
}

static bool edges_feet(const weft__self_law *law, const weft__pair *pair,
                       double x[4][3], feet *at)
{
    double e[3], f[3], r[3], by_s, by_t, by_z;
    from_to(x[0], x[1], e);
    from_to(x[2], x[3], f);
    from_to(x[2], x[0], r);
    const double ee = weft__dot(e, e), ff = weft__dot(f, f), ef = weft__dot(e, f);
    const double er = weft__dot(e, r), fr = weft__dot(f, r), area = ee * ff - ef * ef;
    const double inverse = 1.0 / area;
    const double s = (ef * fr - ff * er) * inverse, t = (ee * fr - ef * er) * inverse;
    if (!(area > PARALLEL * ee * ff && s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        at->r[k] = r[k] + s * e[k] - t * f[k];
    }
    if (!within(at, law->cloth->contact.thickness)) {
        return false;
    }
    const uint32_t *i = pair->particle;
    const double rest
        = 1.0 / (rest_square(law, i[0], i[1]) * rest_square(law, i[2], i[3]));
    at->arm[0] = 1.0 - s, at->arm[1] = s, at->arm[2] = t - 1.0, at->arm[3] = -t;
    const double ss = both_ends(s, law->soft, &by_s),
                 st = both_ends(t, law->soft, &by_t);
    const double sz = step(area * rest, SOFT_ANGLE, &by_z);
    at->weight = sz * ss * st;
    const double gs = sz * by_s * st, gt = sz * ss * by_t;
    const double gz = 2.0 * by_z * ss * st * rest;
    at->leans = gs != 0.0 || gt != 0.0 || gz != 0.0;
    const double by_e = -(ff * gs + ef * gt) * inverse;
    const double by_f = (ef * gs + ee * gt) * inverse;
    for (size_t k = 0; k < 3; ++k) {
        at->lean[k] = by_e * e[k] + by_f * f[k];
        at->turn[0][k] = by_e * at->r[k] + gz * (ff * e[k] - ef * f[k]);
        at->turn[1][k] = by_f * at->r[k] + gz * (ee * f[k] - ef * e[k]);
    }
    return true;
}

static bool find_feet(const weft__self_law *law, const weft__pair *pair, double x[4][3],
                      feet *at)
{
    switch ((weft__pair_kind)pair->kind) {
    case WEFT__VERTICES:
        return vertices_feet(x, law->cloth->contact.thickness, at);
    case WEFT__VERTEX_EDGE:
        return vertex_edge_feet(law, x, at);
    case WEFT__VERTEX_TRIANGLE:
        return vertex_triangle_feet(law, x, at);
    default:
        return edges_feet(law, pair, x, at);
    }
}

/* ---- forces ---------------------------------------------------------------------- */

/* Of the free particles; 0: none. */
static double smallest_mass(const weft_cloth *cloth, const uint32_t *i, size_t count)
{
    double least = 0.0;
    for (size_t k = 0; k < count; ++k) {
        const double mass = cloth->pin[i[k]] == 0 ? cloth->mass[i[k]] : 0.0;
        least = mass > 0.0 && (least == 0.0 || mass < least) ? mass : least;
    }
    return least;
}

/* The signs with which particles are in e_1 and e_2. */
static const signed char in_edges[4][2][4] = {
    [WEFT__VERTICES] = { { 0 } },
    [WEFT__VERTEX_EDGE] = { { 0, -1, 1, 0 } },
    [WEFT__VERTEX_TRIANGLE] = { { 0, -1, 1, 0 }, { 0, -1, 0, 1 } },
    [WEFT__EDGES] = { { -1, 1, 0, 0 }, { 0, 0, -1, 1 } },
};

/* energy: [J] of the pair by W */
static void spread(const feet *at, const double foot[3], double energy, weft__push *out)
{
    for (size_t i = 0; i < out->count; ++i) {
        const signed char *const e = in_edges[out->kind][0],
                                 *f = in_edges[out->kind][1];
        for (size_t k = 0; k < 3; ++k) {
            out->force[i][k] = at->arm[i] * foot[k];
            if (at->leans) {
                out->force[i][k]
                    -= energy
                       * (at->arm[i] * at->lean[k]
                          + (e[i] * at->turn[0][k] + f[i] * at->turn[1][k]));
            }
        }
    }
}

static weft__touch touch_of(const weft__self_law *law, const weft__pair *pair,
                            const feet *at, const double *y, size_t count)
{
    const size_t n = law->cloth->particles;
    weft__touch touch = { .gap = at->d, .steepness = 1.0, .share = SHARE * at->weight };
    double v[3] = { 0.0 };
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < count; ++i) {
            v[k] += at->arm[i] * y[(3 + k) * n + pair->particle[i]];
        }
        touch.normal[k] = at->r[k] / at->d;
    }
    touch.speed = weft__dot(v, touch.normal);
    for (size_t k = 0; k < 3; ++k) {
        touch.slip[k] = v[k] - touch.speed * touch.normal[k];
    }
    weft__touch_forces(&law->cloth->contact, law->cloth->contact.friction, &touch);
    return touch;
}

bool weft__pair_push(const weft__self_law *law, const weft__pair *pair, const double *y,
                     weft__push *out)
{
    const size_t n = law->cloth->particles, count = weft__pair_particles(pair);
    double x[4][3];
    feet at;
    for (size_t i = 0; i < count; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            x[i][k] = y[k * n + pair->particle[i]];
        }
    }
    if (!find_feet(law, pair, x, &at) || !(at.weight > 0.0)) {
        return false;
    }
    const double mass = smallest_mass(law->cloth, pair->particle, count);
    if (mass == 0.0) {
        return false;
    }
    weft__touch touch = touch_of(law, pair, &at, y, count);
    const double force = mass * touch.push * touch.factor;
    double foot[3];
    for (size_t k = 0; k < 3; ++k) {
        out->particle[k] = pair->particle[k];
        foot[k] = force * touch.normal[k] - mass * touch.drag * touch.slip[k];
    }
    out->particle[3] = pair->particle[3];
    out->count = (uint32_t)count, out->kind = pair->kind;
    out->gap = at.d;
    out->heat = mass * (touch.push * (1.0 - touch.factor) * touch.speed);
    out->friction = mass * (touch.drag * weft__dot(touch.slip, touch.slip));
    touch.share = SHARE;
    const double energy = mass * weft__touch_energy(law->cloth, &touch);
    out->energy = at.weight * energy;
    spread(&at, foot, energy, out);
    return true;
}

void weft__push_add(const weft_cloth *cloth, const weft__push *push, weft__unit unit,
                    size_t first, size_t end, double *to)
{
    for (size_t k = 0; k < push->count; ++k) {
        const size_t i = push->particle[k];
        const double scale = unit == WEFT__FORCE ? 1.0 : cloth->inverse_mass[i];
        if (i >= first && i < end && scale > 0.0) {
            for (size_t j = 0; j < 3; ++j) {
                to[j * cloth->particles + i] += scale * push->force[k][j];
            }
        }
    }
}

void weft__push_measure(const weft_cloth *cloth, const weft__push *push,
                        const double *y, weft_measures *sum)
{
    const size_t n = cloth->particles;
    sum->energy.contact += push->energy;
    sum->power[WEFT_POWER_CONTACT] += push->heat;
    sum->power[WEFT_POWER_FRICTION] += push->friction;
    for (size_t k = 0; k < push->count; ++k) {
        const size_t i = push->particle[k];
        const double v[3] = { y[3 * n + i], y[4 * n + i], y[5 * n + i] };
        if (cloth->pin[i] != 0) {
            sum->power[WEFT_POWER_PINS] -= weft__dot(push->force[k], v);
        }
    }
    if (push->gap < sum->self_gap) {
        weft__pair pair = { .kind = push->kind };
        memcpy(pair.particle, push->particle, sizeof pair.particle);
        weft__pair_primitives(&pair, sum->self_pair);
        sum->self_gap = push->gap;
    }
    ++sum->self_touching;
}

/* ---- without a list -------------------------------------------------------------- */

typedef struct pass {
    weft__self_law law;
    const weft__subject *of;
    weft__unit unit;
    double *to; /* NULL: to `sum` */
    weft_measures *sum;
    double bad; /* 0 or NaN */
} pass;

static bool take_pair(void *ctx, const weft__pair *pair, double distance)
{
    pass *self = ctx;
    const weft_cloth *cloth = self->of->cloth;
    weft__push push;
    (void)distance;
    if (weft__pair_push(&self->law, pair, self->of->y, &push)) {
        if (self->to != NULL) {
            weft__push_add(cloth, &push, self->unit, 0, cloth->particles, self->to);
            self->bad += weft__push_trouble(&push);
        } else {
            weft__push_measure(cloth, &push, self->of->y, self->sum);
        }
    }
    return true;
}

static bool seek(pass *self)
{
    const weft_cloth *cloth = self->of->cloth;
    const weft__tree tree = weft__tree_of(cloth, self->of->y);
    self->law = weft__self_law_of(cloth);
    if (isfinite(weft__extent(NULL, self->of->y, cloth->particles))) {
        return weft__each_pair(&tree, cloth->contact.thickness, take_pair, self);
    }
    return false;
}

int weft__self_add(const weft__subject *of, weft__unit unit, double *to)
{
    pass self = { .of = of, .unit = unit, .to = to };
    return !of->cloth->contact.self || (seek(&self) && self.bad == 0.0) ? 0 : 1;
}

void weft__self_measure(const weft__subject *of, weft_measures *sum)
{
    pass self = { .of = of, .sum = sum };
    if (of->cloth->contact.self) {
        (void)seek(&self);
    }
}

static weft_measures measures(const weft_cloth *cloth, const double *y)
{
    const weft__subject of = { .cloth = cloth, .y = y };
    weft_measures sum = weft__measures_start;
    weft__self_measure(&of, &sum);
    return sum;
}

double weft_cloth_self_gap(const weft_cloth *cloth, const double *y,
                           weft_primitive pair[2])
{
    const weft_measures found = measures(cloth, y);
    if (pair != NULL) {
        memcpy(pair, found.self_pair, sizeof found.self_pair);
    }
    return found.self_gap;
}

size_t weft_cloth_self_touching(const weft_cloth *cloth, const double *y)
{
    return measures(cloth, y).self_touching;
}
