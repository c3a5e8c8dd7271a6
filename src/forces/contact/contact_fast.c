/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_fast.c -- the contact of contact.h and the check of contact.h, LANES
 * particles at a time, by the law of contact_law.h. Blocks of particles are compared
 * with the bounding box of a shape first, as most of them are far from most shapes. */
#include "forces/lanes.h"

#define LAW_OF_LANES
#include "forces/contact/contact_law.h"

/* BLOCK particles, a multiple of LANES, are compared with POSES shapes at a time. */
enum { BLOCK = 128, POSES = 8 };

/* Of the particles in each lane of a block. */
typedef struct extent {
    vec3 low, high; /* [m] */
    vec size;       /* [m] of the numbers in it; NaN if one is not finite */
} extent;

typedef struct target {
    double low[3], high[3]; /* [m] within thickness; a plane has none */
    double size;            /* [m] of the numbers in it */
} target;

/* Code for each kind of shape: a kind that is a constant costs no branches. */
#define EACH_KIND(X) X(WEFT_PLANE) X(WEFT_SPHERE) X(WEFT_CAPSULE) X(WEFT_BOX)

/* Particles, in planes n apart, and their v'. */
typedef struct slice {
    const double *y, *inverse_mass;
    double *to;
    size_t n;
} slice;

/* Those from i on, within reach of a shape, between the stages find, touch_forces and
 * add. Root and division are slow, so that each stage takes a whole block: processors
 * then work on several vectors at a time. */
typedef struct touch {
    size_t i;
    mask near;
    law_spot at;
    vec force, slip[3]; /* [m/s^2] N / m, [m/s] */
    vec most, under;    /* of law_touch */
} touch;

INLINE void load_planes(const double *from, size_t plane, vec to[3])
{
    for (size_t k = 0; k < 3; ++k) {
        to[k] = load(from + k * plane);
    }
}

INLINE void load_from(const weft__pose *pose, const double *y, size_t plane, vec r[3])
{
    for (size_t k = 0; k < 3; ++k) {
        r[k] = load(y + k * plane) - pose->at[k];
    }
}

/* The touch of particles from i on; false if none is near. */
INLINE bool contact_fast_find(touch *self, const slice *of, const weft__pose *pose,
                              weft_shape_kind kind, double thickness, size_t i)
{
    vec r[3];
    load_from(pose, of->y + i, of->n, r);
    self->i = i;
    law_spot_of(pose, kind, r, &self->at);
    self->near = (load(of->inverse_mass + i) > 0.0) & ~(self->at.gap >= thickness);
    return any(self->near);
}

INLINE void touch_forces(touch *self, const slice *of, const weft__pose *pose,
                         const weft_contact_def *law, bool joined)
{
    const vec *gradient = self->at.gradient, one = splat(1.0);
    const vec steepness
        = joined ? choose(self->at.joined, root(law_dot(gradient, gradient)), one)
                 : one;
    const vec inverse = 1.0 / steepness;
    vec r[3], moving[3], surface[3], normal[3];
    load_from(pose, of->y + self->i, of->n, r);
    load_planes(of->y + 3 * of->n + self->i, of->n, moving);
    law_surface(pose, r, surface);
    for (size_t k = 0; k < 3; ++k) {
        moving[k] -= surface[k];
        normal[k] = joined ? inverse * gradient[k] : gradient[k];
    }
    const vec speed = law_dot(moving, normal);
    for (size_t k = 0; k < 3; ++k) {
        self->slip[k] = moving[k] - speed * normal[k];
    }
    const law_touch of_law
        = law_normal_force(law, splat(pose->friction), self->at.gap, one, speed,
                           law_dot(self->slip, self->slip), steepness);
    self->force = of_law.push * of_law.factor;
    self->most = of_law.most, self->under = of_law.under;
}

/* Adds to v'; 0 or NaN. */
INLINE vec contact_fast_add(const touch *self, const slice *of,
                            const weft_contact_def *law, double friction)
{
    const vec friction_rate = law_friction_rate(law, friction, self->most, self->under);
    vec sums = splat(0.0);
    for (size_t k = 0; k < 3; ++k) {
        const vec push = self->force * self->at.gradient[k];
        const vec more = friction == 0.0 ? push : push - friction_rate * self->slip[k];
        double *to = of->to + k * of->n + self->i;
        const vec sum = load(to) + only(more, self->near);
        store(to, sum);
        sums += sum;
    }
    return sums * 0.0 + only(splat((double)NAN), self->near & ~(self->at.gap > 0.0));
}

/* Copies, which stores do not change, stay in registers. */
INLINE vec push_block(const slice *particles, size_t count, const weft__pose *shape,
                      weft_shape_kind kind, const weft_contact_def *contact,
                      int exponent)
{
    const slice of = *particles;
    const weft__pose pose = *shape;
    const bool joins = kind == WEFT_CAPSULE || kind == WEFT_BOX;
    weft_contact_def law = *contact;
    touch found[BLOCK / LANES], *next = found;
    vec bad = splat(0.0);
    law.exponent = exponent;
    for (size_t i = 0; i < count; i += LANES) {
        if (contact_fast_find(next, &of, &pose, kind, law.thickness, i)) {
            ++next;
        }
    }
    for (touch *at = found; at < next; ++at) {
        if (joins && any(at->near & at->at.joined)) {
            touch_forces(at, &of, &pose, &law, true);
        } else {
            touch_forces(at, &of, &pose, &law, false);
        }
    }
    for (const touch *at = found; at < next; ++at) {
        bad += contact_fast_add(at, &of, &law, pose.friction);
    }
    return bad;
}

/* Of a multiple of LANES. The usual exponent is compiled without a loop. */
static vec push_any(const slice *of, size_t count, const weft__pose *pose,
                    const weft_contact_def *law)
{
    const int p = law->exponent;
    switch (pose->kind) {
#define CASE(kind)                                                                     \
    case kind:                                                                         \
        return p == 4 ? push_block(of, count, pose, kind, law, 4)                      \
                      : push_block(of, count, pose, kind, law, p);
        EACH_KIND(CASE)
#undef CASE
    default:
        return splat(0.0);
    }
}

/* Shape k of particles [first, end), those beyond the last vector one by one. */
static vec push(const weft__contact *own, const weft__state *at, double *dvdt,
                const weft__pose *pose, size_t k, size_t first, size_t end)
{
    const size_t whole = (end - first) / LANES * LANES;
    const slice block = { at->y + first, own->mesh->inverse_mass + first, dvdt + first,
                          own->mesh->particles };
    const vec bad = push_any(&block, whole, pose, &own->law);
    return first + whole == end
                   || weft__contact_some(own, at, WEFT__ACCELERATION, dvdt,
                                         first + whole, end, k, k + 1)
                          == 0
               ? bad
               : splat((double)NAN);
}

/* ---- what is far ----------------------------------------------------------------- */

/* Of particles [first, end), and of some before them where the last lanes are beyond.
 * A product with 0 is NaN for a number that is not finite; processors multiply beside
 * comparisons, but add instead of them. */
INLINE extent contact_fast_bounds_of(const double *x, size_t n, size_t first,
                                     size_t end)
{
    const vec far = splat((double)INFINITY);
    vec3 low = { far, far, far }, high = { -far, -far, -far };
    vec zero = splat(end < LANES ? (double)NAN : 0.0);
    for (size_t i = first; i < end && LANES <= end; i += LANES) {
        const vec3 at = load3(x + (i + LANES <= end ? i : end - LANES), n);
        low = (vec3){ least(low.x, at.x), least(low.y, at.y), least(low.z, at.z) };
        high = (vec3){ most(high.x, at.x), most(high.y, at.y), most(high.z, at.z) };
        zero *= at.x * at.y * at.z;
    }
    return (extent){ low, high,
                     zero + most(-low.x, high.x) + most(-low.y, high.y)
                         + most(-low.z, high.z) };
}

/* The curve rho^4 + q^4 = 1 is nowhere further than 2^(1/4) from its centre, and the
 * surface x^4 + y^4 + z^4 = 1 than 3^(1/4). */
#define ROUND     1.25
#define ROUND_BOX 1.32

static target target_of(const weft__pose *pose, double thickness)
{
    target of = { .size = thickness };
    const bool capsule = pose->kind == WEFT_CAPSULE, box = pose->kind == WEFT_BOX;
    const double round = (pose->radius + thickness)
                         * (capsule        ? ROUND
                            : pose->turned ? ROUND_BOX
                                           : 1.0);
    for (size_t k = 0; k < 3; ++k) {
        const double to = capsule ? pose->length * pose->axis[k] : 0.0;
        double wide = round + (box && !pose->turned ? pose->inner[k] : 0.0);
        for (size_t j = 0; pose->turned && j < 3; ++j) {
            wide += fabs(pose->frame.row[k][j]) * pose->inner[j];
        }
        of.low[k] = pose->at[k] + (to < 0.0 ? to : 0.0) - wide;
        of.high[k] = pose->at[k] + (to > 0.0 ? to : 0.0) + wide;
        of.size += fabs(pose->at[k]) + fabs(to) + wide;
    }
    return of;
}

/* Roundoff of what is compared, by far, relative to the size of its coordinates. */
#define SLACK 1e-12

/* Along axis k, beyond the reach of a shape. */
INLINE mask contact_fast_apart(const target *of, size_t k, vec low, vec high, vec slack)
{
    return (low - of->high[k] > slack) | (of->low[k] - high > slack);
}

/* [m] that axis k adds to the height of the lowest corner above a plane. */
INLINE vec ahead(const weft__pose *plane, size_t k, vec low, vec high)
{
    const double n = plane->axis[k];
    return n * ((n > 0.0 ? low : high) - plane->at[k]);
}

/* Whether no particle in `box` can touch the shape; false where in doubt. */
INLINE bool contact_fast_is_far(const target *of, const weft__pose *pose,
                                double thickness, const extent *box)
{
    const vec3 low = box->low, high = box->high;
    const vec slack = SLACK * (box->size + of->size);
    const mask far = pose->kind == WEFT_PLANE
                         ? ahead(pose, 0, low.x, high.x) + ahead(pose, 1, low.y, high.y)
                                   + ahead(pose, 2, low.z, high.z) - thickness
                               > slack
                         : contact_fast_apart(of, 0, low.x, high.x, slack)
                               | contact_fast_apart(of, 1, low.y, high.y, slack)
                               | contact_fast_apart(of, 2, low.z, high.z, slack);
    return !any(~far);
}

int NAME(contact, LEVEL)(const void *contact, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end_block)
{
    const weft__contact *own = contact;
    const double thickness = own->law.thickness;
    const size_t end = weft__block(own->mesh, end_block);
    vec bad = splat(0.0);
    (void)unit;
    for (size_t shape = 0; shape < own->shape_count; shape += POSES) {
        const size_t left = own->shape_count - shape;
        const size_t count = left < POSES ? left : POSES;
        weft__pose poses[POSES];
        target targets[POSES];
        for (size_t k = 0; k < count; ++k) {
            poses[k] = weft__pose_of(&own->shapes[shape + k], at->t);
            targets[k] = target_of(&poses[k], thickness);
        }
        for (size_t i = weft__block(own->mesh, first); i < end; i += BLOCK) {
            const size_t stop = end - i < BLOCK ? end : i + BLOCK;
            const extent box
                = contact_fast_bounds_of(at->y, own->mesh->particles, i, stop);
            for (size_t k = 0; k < count; ++k) {
                if (!contact_fast_is_far(&targets[k], &poses[k], thickness, &box)) {
                    bad += push(own, at, to, &poses[k], shape + k, i, stop);
                }
            }
        }
    }
    return sum(bad) == 0.0 ? 0 : 1;
}

/* ---- the step check -------------------------------------------------------------- */

/* Of particles [first, end), and of some before them where the last lanes are beyond.
 */
INLINE bool kind_clear(const weft__contact *own, const weft__ccd *of,
                       weft_shape_kind kind, const weft__path *path, size_t first,
                       size_t end)
{
    const size_t n = own->mesh->particles;
    const double *ends[2] = { path->y0, path->y1 };
    for (size_t i = first; i < end; i += LANES) {
        const size_t at = i + LANES <= end ? i : end - LANES;
        vec x[2][3], v[2][3], gap[2];
        for (size_t e = 0; e < 2; ++e) {
            load_planes(ends[e] + at, n, x[e]);
            load_planes(ends[e] + 3 * n + at, n, v[e]);
        }
        if (any(~law_clear(of, kind, x, v, gap)
                & (load(own->mesh->inverse_mass + at) > 0.0))) {
            return false;
        }
    }
    return true;
}

static bool block_clear(const weft__contact *own, const weft__ccd *of,
                        const weft__path *path, size_t first, size_t end)
{
    switch (of->pose[0].kind) {
#define CASE(kind)                                                                     \
    case kind:                                                                         \
        return kind_clear(own, of, kind, path, first, end);
        EACH_KIND(CASE)
#undef CASE
    default:
        return true;
    }
}

/* Around both ends of the paths of a block, the highest speed at an end and the longest
 * displacement. */
INLINE extent path_bounds(const weft__path *path, size_t n, size_t first, size_t end,
                          vec *speed, vec *displacement)
{
    const extent a = contact_fast_bounds_of(path->y0, n, first, end);
    const extent b = contact_fast_bounds_of(path->y1, n, first, end);
    vec square = splat(0.0), displacement2 = splat(0.0);
    for (size_t i = first; i < end && LANES <= end; i += LANES) {
        const size_t at = i + LANES <= end ? i : end - LANES, to = 3 * n + at;
        const vec3 v0 = load3(path->y0 + to, n), v1 = load3(path->y1 + to, n);
        const vec3 moved = minus(load3(path->y1 + at, n), load3(path->y0 + at, n));
        displacement2 = most(dot(moved, moved), displacement2);
        square = most(most(dot(v0, v0), dot(v1, v1)), square);
    }
    *speed = root(square);
    *displacement = root(displacement2);
    return (extent){ { least(a.low.x, b.low.x), least(a.low.y, b.low.y),
                       least(a.low.z, b.low.z) },
                     { most(a.high.x, b.high.x), most(a.high.y, b.high.y),
                       most(a.high.z, b.high.z) },
                     a.size + b.size };
}

/* Whether both gaps of all particles exceed half of what they may move: the box is that
 * much wider. A spin or a turn makes a surface faster far away. */
INLINE bool passes_far(const weft__ccd *of, const target targets[2], double thickness,
                       const extent *box, vec speed, vec displacement)
{
    const vec half
        = 0.5 * most(of->h * (speed + of->fastest), displacement + of->shift);
    const vec3 wider = { half, half, half };
    const extent around
        = { minus(box->low, wider), plus(box->high, wider), box->size + 6.0 * half };
    return !of->spins && !of->turns
           && contact_fast_is_far(&targets[0], &of->pose[0], thickness, &around)
           && contact_fast_is_far(&targets[1], &of->pose[1], thickness, &around);
}

bool NAME(clear, LEVEL)(const weft__contact *own, const weft__path *path, size_t first,
                        size_t end_block)
{
    const size_t n = own->mesh->particles, end = weft__block(own->mesh, end_block);
    const double thickness = own->law.thickness;
    if (end < LANES) {
        return weft__clear_loops(own, path, first, end_block);
    }
    for (size_t shape = 0; shape < own->shape_count; shape += POSES) {
        const size_t left = own->shape_count - shape;
        const size_t count = left < POSES ? left : POSES;
        weft__ccd shapes[POSES];
        target targets[POSES][2];
        bool any = false; /* bodies have a check of their own */
        for (size_t k = 0; k < count; ++k) {
            any = any || own->shapes[shape + k].def.kind != WEFT_MESH;
            shapes[k] = weft__ccd_of(&own->shapes[shape + k], path);
            targets[k][0] = target_of(&shapes[k].pose[0], thickness);
            targets[k][1] = target_of(&shapes[k].pose[1], thickness);
        }
        for (size_t i = weft__block(own->mesh, first); any && i < end; i += BLOCK) {
            const size_t stop = end - i < BLOCK ? end : i + BLOCK;
            vec speed, displacement;
            const extent box = path_bounds(path, n, i, stop, &speed, &displacement);
            for (size_t k = 0; k < count; ++k) {
                if (!passes_far(&shapes[k], targets[k], thickness, &box, speed,
                                displacement)
                    && !block_clear(own, &shapes[k], path, i, stop)) {
                    return false;
                }
            }
        }
    }
    return true;
}
