/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_contact.c -- the contact of contact.h, LANES particles at a time: the
 * expressions of shapes.c and contact.c. Blocks of particles are compared with the
 * bounding box of a shape first, as most of them are far from most shapes. */
#include "cloth/levels.h"
#include "cloth/shapes.h"
#include "kernel/lanes.h"

/* BLOCK particles, a multiple of LANES, are compared with POSES shapes at a time. */
enum { BLOCK = 64, POSES = 8 };

typedef struct extent {
    double low[3], high[3]; /* [m] */
    double size;            /* [m] of the numbers in it; NaN if one is not finite */
} extent;

typedef struct target {
    weft__pose pose;
    extent reach; /* within thickness; a plane has none */
} target;

typedef struct job {
    const weft_cloth *cloth;
    const double *y;
    double *dydt;
    vec bad;
} job;

/* Where particles are to a shape. */
typedef struct spot {
    vec gap;
    vec3 gradient;
    mask joined; /* at an end or an edge, where |gradient| is not 1 */
} spot;

/* x above high or below low, 0 between them. */
INLINE vec beyond(vec x, double low, double high)
{
    const vec over = x - high, under = x - low;
    return only(over, ~(over <= 0.0)) + only(under, ~(under >= 0.0));
}

INLINE vec3 along_axis(const weft__pose *pose, vec a)
{
    return (vec3){ a * pose->axis[0], a * pose->axis[1], a * pose->axis[2] };
}

INLINE spot capsule_spot(const weft__pose *pose, vec3 r)
{
    const vec3 axis = along_axis(pose, splat(1.0));
    const vec along = dot(r, axis);
    const vec q = beyond(along, 0.0, pose->length), q2 = q * q;
    const vec3 side = minus(r, scaled(along, axis));
    const vec rho2 = dot(side, side);
    const vec norm = root(root(rho2 * rho2 + q2 * q2));
    const vec inverse = 1.0 / (norm * norm * norm);
    const vec3 gradient
        = plus(scaled(rho2 * inverse, side), scaled(q2 * q * inverse, axis));
    return (spot){ norm - pose->radius, gradient, q2 > 0.0 };
}

INLINE spot box_spot(const weft__pose *pose, vec3 r)
{
    const vec3 q = { beyond(r.x, -pose->inner[0], pose->inner[0]),
                     beyond(r.y, -pose->inner[1], pose->inner[1]),
                     beyond(r.z, -pose->inner[2], pose->inner[2]) };
    const vec3 q2 = { q.x * q.x, q.y * q.y, q.z * q.z };
    const vec norm = root(root(dot(q2, q2)));
    const vec inverse = 1.0 / (norm * norm * norm);
    const vec3 gradient
        = { q2.x * q.x * inverse, q2.y * q.y * inverse, q2.z * q.z * inverse };
    return (spot){ norm - pose->radius, gradient,
                   q2.x * q2.y + q2.y * q2.z + q2.z * q2.x > 0.0 };
}

INLINE spot spot_of(const weft__pose *pose, weft_shape_kind kind, vec3 r)
{
    if (kind == WEFT_PLANE) {
        const vec3 axis = along_axis(pose, splat(1.0));
        return (spot){ .gap = dot(r, axis), .gradient = axis };
    }
    if (kind == WEFT_SPHERE) {
        const vec distance = root(dot(r, r));
        return (spot){ .gap = distance - pose->radius,
                       .gradient = scaled(1.0 / distance, r) };
    }
    return kind == WEFT_CAPSULE ? capsule_spot(pose, r) : box_spot(pose, r);
}

INLINE vec3 surface_velocity(const weft__pose *pose, vec3 r)
{
    const double *v = pose->velocity, *spin = pose->spin;
    return (vec3){ v[0] + (spin[1] * r.z - spin[2] * r.y),
                   v[1] + (spin[2] * r.x - spin[0] * r.z),
                   v[2] + (spin[0] * r.y - spin[1] * r.x) };
}

/* s^(p - 2) */
INLINE vec power_of(vec s, int exponent)
{
    vec power = s;
    for (int k = 3; k < exponent; ++k) {
        power *= s;
    }
    return power;
}

/* [1/s] friction / (m w): `most` is mu |g| N / m, `scale` q^2 / mu^2. */
INLINE vec friction_drag(const weft_contact_def *law, double friction, vec square,
                         vec most, vec scale)
{
    if (law->law == WEFT_FRICTION_SMOOTH) {
        return most
               / root(square + (law->slip * law->slip + friction * friction * scale));
    }
    const double per = 1.0 / law->slip;
    const vec length = root(square), y = length * per;
    const mask fades = y < 1.0;
    return most * (only((2.0 - y) * per, fades) + only(1.0 / length, ~fades));
}

/* F / m [m/s^2] of particles that move at `moving` against the surface. */
INLINE vec3 acceleration(const weft_contact_def *law, const weft__pose *pose,
                         int exponent, const spot *of, bool joined, vec3 moving)
{
    const double e = 0.5 * law->stopping_speed * law->stopping_speed;
    const double per = 1.0 / law->thickness, p = exponent;
    const vec z = of->gap * per, s = 1.0 - z;
    const vec power = power_of(s, exponent);
    const vec a = z * (p * (p - 1.0) * z + 2.0 * p * s) + 2.0 * s * s;
    const vec b = p * z + s, inverse = 1.0 / (a * z), iz = a * inverse;
    const vec steepness = joined
                              ? only(root(dot(of->gradient, of->gradient)), of->joined)
                                    + only(splat(1.0), ~of->joined)
                              : splat(1.0);
    const vec3 normal = joined ? scaled(1.0 / steepness, of->gradient) : of->gradient;
    const vec speed = dot(moving, normal), u = law->damping * speed;
    const vec factor = root(1.0 + u * u) - u;
    const vec force = (e * per * (power * s) * b * (iz * iz)) * factor;
    const vec3 push = scaled(force, of->gradient);
    if (pose->friction == 0.0) {
        return push;
    }
    const vec3 slip = minus(moving, scaled(speed, normal));
    const vec bend = factor * s * b, most = pose->friction * force;
    const vec drag = friction_drag(law, pose->friction, dot(slip, slip),
                                   joined ? most * steepness : most,
                                   0.01 * e * power * (bend * bend) * inverse);
    return minus(push, scaled(drag, slip));
}

INLINE vec3 chosen(mask where, vec3 a, vec3 b)
{
    return (vec3){ only(a.x, where) + only(b.x, ~where),
                   only(a.y, where) + only(b.y, ~where),
                   only(a.z, where) + only(b.z, ~where) };
}

/* Particle i and those that follow it. */
INLINE void push_lanes(job *self, const weft__pose *pose, weft_shape_kind kind,
                       int exponent, size_t i, size_t count)
{
    const weft_cloth *cloth = self->cloth;
    const size_t n = cloth->particles;
    const double *at = pose->at;
    const vec3 x = load3_some(self->y + i, n, count);
    const vec3 r = { x.x - at[0], x.y - at[1], x.z - at[2] };
    const spot of = spot_of(pose, kind, r);
    const mask loose = load_some(cloth->inverse_mass + i, count) > 0.0;
    const mask near = loose & ~(of.gap >= cloth->contact.thickness);
    if (!any(near)) {
        return;
    }
    double *to = self->dydt + 3 * n + i;
    const vec3 moving
        = minus(load3_some(self->y + 3 * n + i, n, count), surface_velocity(pose, r));
    const vec3 old = load3_some(to, n, count);
    const bool joins = kind == WEFT_CAPSULE || kind == WEFT_BOX;
    const vec3 more
        = joins && any(near & of.joined)
              ? acceleration(&cloth->contact, pose, exponent, &of, true, moving)
              : acceleration(&cloth->contact, pose, exponent, &of, false, moving);
    const vec3 sums = plus(old, more);
    store3_some(to, n, chosen(near, sums, old), count);
    self->bad += only(((sums.x + sums.y) + sums.z) * 0.0, near)
                 + only(splat((double)NAN), near & ~(of.gap > 0.0));
}

INLINE void push_block(job *self, const weft__pose *pose, weft_shape_kind kind,
                       int exponent, size_t first, size_t end)
{
    size_t i = first;
    for (; i + LANES <= end; i += LANES) {
        push_lanes(self, pose, kind, exponent, i, LANES);
    }
    if (i < end) {
        push_lanes(self, pose, kind, exponent, i, end - i);
    }
}

/* The usual exponent is compiled without a loop. */
static void push_any(job *self, const weft__pose *pose, size_t first, size_t end)
{
    const int p = self->cloth->contact.exponent;
    switch (pose->kind) {
#define CASE(kind)                                                                     \
    case kind:                                                                         \
        if (p == 4) {                                                                  \
            push_block(self, pose, kind, 4, first, end);                               \
        } else {                                                                       \
            push_block(self, pose, kind, p, first, end);                               \
        }                                                                              \
        break;
        CASE(WEFT_PLANE)
        CASE(WEFT_SPHERE)
        CASE(WEFT_CAPSULE)
        CASE(WEFT_BOX)
#undef CASE
    default:
        break;
    }
}

/* ---- what is far ------------------------------------------------------------------
 */

INLINE void widen(extent *of, size_t k, vec low, vec high)
{
    of->low[k] = least_lane(low);
    of->high[k] = -least_lane(-high);
    of->size += fabs(of->low[k]) + fabs(of->high[k]);
}

/* Of particles [first, end), and of some before them where the last lanes are beyond.
 */
static extent bounds_of(const job *self, size_t first, size_t end)
{
    if (end < LANES) {
        return (extent){ .size = (double)NAN };
    }
    const size_t n = self->cloth->particles;
    const double *x = self->y;
    const vec far = splat((double)INFINITY);
    vec3 low = { far, far, far }, high = { -far, -far, -far };
    vec3 total = { splat(0.0), splat(0.0), splat(0.0) };
    for (size_t i = first; i < end; i += LANES) {
        const vec3 at = load3(x + (i + LANES <= end ? i : end - LANES), n);
        low = (vec3){ least(low.x, at.x), least(low.y, at.y), least(low.z, at.z) };
        high = (vec3){ most(high.x, at.x), most(high.y, at.y), most(high.z, at.z) };
        total = plus(total, at);
    }
    extent of = { .size = 0.0 };
    widen(&of, 0, low.x, high.x);
    widen(&of, 1, low.y, high.y);
    widen(&of, 2, low.z, high.z);
    of.size += sum((total.x + total.y + total.z) * 0.0);
    return of;
}

/* The curve rho^4 + q^4 = 1 is nowhere further than 2^(1/4) from its centre. */
#define ROUND 1.25

/* All that a shape, but for a plane, may touch. */
static extent reach_of(const weft__pose *pose, double thickness)
{
    const bool capsule = pose->kind == WEFT_CAPSULE, box = pose->kind == WEFT_BOX;
    const double round = (pose->radius + thickness) * (capsule ? ROUND : 1.0);
    extent of = { .size = thickness };
    for (size_t k = 0; k < 3; ++k) {
        const double to = capsule ? pose->length * pose->axis[k] : 0.0;
        const double wide = round + (box ? pose->inner[k] : 0.0);
        of.low[k] = pose->at[k] + (to < 0.0 ? to : 0.0) - wide;
        of.high[k] = pose->at[k] + (to > 0.0 ? to : 0.0) + wide;
        of.size += fabs(pose->at[k]) + fabs(to) + wide;
    }
    return of;
}

/* Roundoff of what is compared, by far, relative to the size of its coordinates. */
#define SLACK 1e-12

/* Whether no particle in `box` can touch the shape; false where in doubt. */
static bool is_far(const target *of, double thickness, const extent *box)
{
    const weft__pose *pose = &of->pose;
    const double slack = SLACK * (box->size + of->reach.size);
    double ahead = -thickness;
    bool apart = false;
    for (size_t k = 0; k < 3; ++k) {
        const double n = pose->axis[k], low = box->low[k], high = box->high[k];
        ahead += n * ((n > 0.0 ? low : high) - pose->at[k]);
        apart = apart || low - of->reach.high[k] > slack
                || of->reach.low[k] - high > slack;
    }
    return pose->kind == WEFT_PLANE ? ahead > slack : apart;
}

int NAME(contact, LEVEL)(const weft__subject *of, double *dydt, size_t first_row,
                         size_t end_row)
{
    const weft_cloth *cloth = of->cloth;
    const double thickness = cloth->contact.thickness;
    const size_t end = end_row * cloth->cols;
    job self = { cloth, of->y, dydt, splat(0.0) };
    for (size_t shape = 0; shape < cloth->shape_count; shape += POSES) {
        const size_t left = cloth->shape_count - shape;
        const size_t count = left < POSES ? left : POSES;
        target targets[POSES];
        for (size_t k = 0; k < count; ++k) {
            targets[k].pose = weft__pose_of(&cloth->shapes[shape + k], of->t);
            targets[k].reach = reach_of(&targets[k].pose, thickness);
        }
        for (size_t i = first_row * cloth->cols; i < end; i += BLOCK) {
            const size_t stop = end - i < BLOCK ? end : i + BLOCK;
            const extent box = bounds_of(&self, i, stop);
            for (size_t k = 0; k < count; ++k) {
                if (!is_far(&targets[k], thickness, &box)) {
                    push_any(&self, &targets[k].pose, i, stop);
                }
            }
        }
    }
    return sum(self.bad) == 0.0 ? 0 : 1;
}
