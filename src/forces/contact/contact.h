/* SPDX-License-Identifier: BSD-3-Clause */
/* contact.h -- the contact with shapes. A free particle of mass m at a gap
 * d < dh = thickness from a shape, with s = 1 - z, z = d / dh, p = exponent,
 * e = stopping_speed^2 / 2, g = grad d, n = g / |g|, V the velocity of the surface:
 *
 *     U  = m e phi(s),   phi = s^p / z
 *     N0 = -dU/dd = (m e / dh) phi',   phi'  = s^(p-1) (p z + s) / z^2
 *     kn = (m e / dh^2) phi'',         phi'' = s^(p-2) a / z^3,
 *                                      a = p (p - 1) z^2 + 2 p s z + 2 s^2
 *     N  = N0 (sqrt(1 + u^2) - u),     u = damping n.(v - V)
 *     F  = N g - friction,             w = (v - V) - (n.(v - V)) n
 *
 *     smooth     friction = mu |g| N w / sqrt(|w|^2 + slip^2 + q^2)
 *                q = mu N / (10 m sqrt(kn / m)):  q^2 = mu^2 e f^2 s^p (p z + s)^2
 *                    / (100 a z),  f = N / N0
 *     coulomb    friction = mu |g| N w / |w|, times 2 y - y^2 where y = |w| / slip < 1
 *
 * All forces are proportional to m, so m cancels in accelerations;
 * docs/theory/contact.md. */
#pragma once

#include "forces/bounds.h"
#include "mesh/rigid.h"
/* shapes.c: rigid shapes: where they are, and the distance to them.
 *
 * The gap d is > 0 outside and 1-Lipschitz: |grad d| <= 1. With r = x - at it is
 *
 *     plane      r.normal
 *     sphere     |r| - radius
 *     capsule    (rho^4 + q^4)^(1/4) - radius,  rho from the axis, q beyond an end
 *     box        (q_x^4 + q_y^4 + q_z^4)^(1/4) - rounding,  q beyond half - rounding
 *
 * with r in the frame of a box that has turned.
 * The 4-norm joins sides to ends and edges with three continuous derivatives, so that
 * methods keep their order there. */
/* A rigid shape: what is defined and what follows from it. */
typedef struct weft__shape {
    weft_shape def;
    weft__rigid_motion motion;
    double axis[3];  /* unit: a plane's normal, from end to end of a capsule */
    double spin[3];  /* [rad/s] of a plane and a capsule exactly along the axis */
    double length;   /* [m] of a capsule's axis */
    double radius;   /* [m] also of the edges of a box; a plane has 0 */
    double friction; /* >= 0 */
} weft__shape;

/* A shape at a time. */
typedef struct weft__pose {
    weft_shape_kind kind;
    double at[3], velocity[3]; /* [m], [m/s] */
    double spin[3];            /* [rad/s] and of its turn */
    double axis[3], length;    /* as in weft__shape, turned */
    weft__rigid rigid;
    weft__matrix frame; /* box, mesh: columns are its axes */
    bool turned;        /* box: these are not x, y, z */
    double inner[3];    /* [m] box: half - rounding */
    double radius;      /* [m] box: rounding */
    double friction;
} weft__pose;

/* The friction of a shape: its own, or else that of the contact. */
static inline double weft__friction_of(const weft_shape *def, double friction)
{
    return def->friction < 0.0 ? friction : def->friction;
}

/* A shape without faults. `friction`: that of the contact. */
weft__shape weft__shape_of(const weft_shape *def, double friction);

weft__pose weft__pose_of(const weft__shape *shape, double t);

/* Gives *to, whose motion begins at t, the place and orientation that the shape has
 * then, but with `at` at `place`. to->turn.about is meant as a place at t. */
void weft__shape_rebase(const weft__shape *shape, double t, const double place[3],
                        weft_shape *to);

/* [1/m] times dx: the change of the gradient, which is that at x, by a move dx. */
void weft__shape_turn(const weft__pose *pose, const double x[3],
                      const double gradient[3], const double dx[3], double turn[3]);

/* [m] */
double weft__gap_at(const weft__pose *pose, const double x[3]);

/* shapes.c: continuous collision detection: whether a step leads a free particle into a
 * shape or through it. A step of h from gap d0 to d1 is clear if, for every free
 * particle and shape (docs/theory/contact.md, "The collision check"),
 *
 *     d1 > 0  and  h (max(|v0 - V0|, |v1 - V1|) + w), |r1 - r0| < d0 + d1 */
/* A shape at both ends of a path. */
typedef struct weft__ccd {
    double h;       /* [s] */
    double between; /* [m/s] beyond what its velocity is at the ends */
    double fastest; /* [m/s] of its velocity, without spin */
    double shift;   /* [m] its displacement */
    bool spins, turns;
    weft__matrix rotation; /* from one end to the other */
    double twist;          /* [rad/s] as between, of its turn */
    double fast, swing;    /* [rad/s], [rad/s^2] */
    weft__pose pose[2];
} weft__ccd;

weft__ccd weft__ccd_of(const weft__shape *shape, const weft__path *path);

/* Of particle i of n; gap: [m] at the end. */
bool weft__ccd_clear(const weft__ccd *of, const weft__path *path, size_t n, size_t i,
                     double *gap);

/* Whether a path of blocks [first, end) is clear of all shapes. */
struct weft__contact;
typedef bool weft__clear_fn(const struct weft__contact *own, const weft__path *path,
                            size_t first, size_t end);
WEFT_FORMS(weft__clear_fn, clear);

typedef struct weft__contact {
    const weft__mesh *mesh;
    weft_contact_def law; /* as defined, without the shapes */
    weft__shape *shapes;  /* shape_count of them; a copy has its own */
    size_t shape_count;
    size_t changes; /* how often shapes were replaced */
    bool shared;    /* the bodies of its shapes are those of its model */
    weft__add_fn *fast;
    weft__clear_fn *clear;
} weft__contact;

/* A free particle within reach of a shape. */
typedef struct weft__touch {
    double gap;                    /* [m] */
    double share;                  /* of e: 1 of a shape */
    double gradient[3], steepness; /* g, |g| */
    bool joined;                   /* where |g| is not 1 */
    double normal[3];              /* n */
    double surface[3];             /* [m/s] V */
    double speed;                  /* [m/s] n.(v - V) */
    double slip[3];                /* [m/s] w */
    double push;                   /* [m/s^2] N0 / m */
    double factor;                 /* f */
    double stiffness;              /* [1/s^2] kn / m */
    double friction_rate;          /* [1/s] friction / (m w) */
} weft__touch;

/* The touches of particles first to end - 1, shape after shape:
 *
 *     for (weft__touches at = weft__touches_of(cloth, t, y, first, end);
 *          weft__each_touch(&at);)
 *
 * visits particle at.i of at.pose as at.touch. A gap that is <= 0 or not a
 * number is within reach too. */
typedef struct weft__touches {
    const weft__contact *own;
    double t;
    const double *y;
    size_t first, end, next;  /* particles */
    size_t shapes, end_shape; /* shapes begun; pose is of the last */
    weft__pose pose;
    size_t i;
    weft__touch touch;
} weft__touches;

weft__touches weft__touches_of(const weft__contact *own, double t, const double *y,
                               size_t first, size_t end);
bool weft__each_touch(weft__touches *at);

/* Component k of F / m [m/s^2]. */
static inline double weft__touch_acceleration(const weft__touch *touch, size_t k)
{
    return touch->push * touch->factor * touch->gradient[k]
           - touch->friction_rate * touch->slip[k];
}

/* push, factor, stiffness and friction_rate from what is before them. */
void weft__touch_forces(const weft_contact_def *law, double friction,
                        weft__touch *touch);

/* contact_derivatives.c: for weft__force. */
weft__add_fn weft__contact_change;
weft__transposed_fn weft__contact_transposed;
int weft__contact_blocks(const void *own, void *space, const weft__state *at,
                         double *blocks);

/* ---- contact_derivatives.c: what it adds to stiffness and damping;
 * docs/theory/contact.md
 * ------
 */

/* In a state; at->y NULL: of any free particle that touches one shape at a time, with a
 * kinetic energy relative to it and a contact energy that together are at most m
 * stopping_speed^2 / 2. */
void weft__shapes_range_stiffness(const void *own, void *space, const weft__state *at,
                                  size_t first, size_t count,
                                  weft__range_stiffness *range_stiffness);

/* Without mass and without what turning normals and the coupling of friction to
 * pressure add. */
void weft__contact_multiply(const void *own, const weft__state *at, double a, double b,
                            const double *x, double *out);

/* Adds to *most, number by number, the largest of layers, `share` of the law, with
 * phi(s) up to `phi`. */
void weft__range_stiffness_most(const weft_contact_def *law, const weft__pose *pose,
                                double share, double phi, weft__range_stiffness *most);

/* ---- measures -------------------------------------------------------------------- */

/* Whether particle i touches one of the first `count` shapes. */
bool weft__touches_any(const weft__contact *own, const weft__state *at, size_t i,
                       size_t count);

/* The gaps and touches of block b. */
weft__block_fn weft__contact_gaps;

/* What the particles of block b exert on shape k: force [N], torque [N m]. */
enum { WEFT__LOAD = 6 };
void weft__block_load(const weft__contact *own, const weft__state *at, size_t b,
                      size_t k, double sum[WEFT__LOAD]);

/* ---- numbers: contact_check.c ---------------------------------------------------- */

WEFT__NUMBERS(weft__contact_numbers, thickness, stopping_speed, exponent, damping,
              friction, slip, law);
WEFT__NUMBERS(weft__shape_numbers, kind, at, velocity, amplitude, frequency, spin);
WEFT__NUMBERS(weft__turn_numbers, axis, rate, amplitude, frequency);
extern const weft__number weft__untangle;       /* of a weft_cloth_def */
extern const weft__number weft__shape_radius;   /* of a sphere or capsule */
extern const weft__number weft__shape_rounding; /* of a box */

/* Of contact, but not of its shapes. */
void weft__contact_check(const weft_contact_def *law, const weft__faults *to);

/* Of one shape, number `index`: the fields are offsets in weft_shape. */
bool weft__shape_check(const weft_shape *shape, size_t index, const weft__faults *to);

/* Whether no free particle starts inside a shape without faults; else which one, and
 * how deep. */
bool weft__start_check(const weft_cloth_def *def, size_t shape, char *text,
                       size_t size);

/* One more shape for a cloth, or its number `index`, that moves from `since` on; its
 * mistakes are errors. */
weft_status weft__shape_make(const weft__contact *own, const weft_shape *def,
                             double since, size_t index, weft__shape *out,
                             weft_error *err);

/* Of all numbers of a definition with shapes. */
void weft__contact_def_check(const weft_cloth_def *def, const weft__faults *to);

/* Of the law alone, which shapes that are added obey; after it a hash goes on. */
uint64_t weft__law_hash(const weft_contact_def *law, uint64_t hash);
uint64_t weft__contact_hash(const weft__contact *own);
uint64_t weft__contact_own_hash(const void *own, uint64_t hash); /* of all */

/* contact_steps.c: for weft__force_checks. */
bool weft__contact_clear(const void *own, const weft__path *path, size_t first,
                         size_t end);
void weft__contact_first(const void *own, const weft__path *path, size_t first,
                         size_t end, weft__penetration *out);
void weft__contact_hold(const void *own, double t, const double *from, double *y,
                        size_t first, size_t end);
double weft__contact_gap(const void *own, double t, const double x[3], size_t *shape);
void weft__contact_other(const void *own, void *space, const weft__state *at,
                         size_t than, weft_measures *least);
weft__closing weft__contact_closing(const void *own, void *space,
                                    const weft__state *at);

/* contact_changes.c: for weft__force. */
size_t weft__contact_words(const void *own);
void weft__contact_put(const void *own, unsigned char *to);
weft_status weft__contact_take(void *own, const unsigned char *from, size_t words,
                               const weft_allocator *memory, weft_error *err);
void weft__contact_exchange(void *own, void *taken);
void weft__contact_drop(void *taken, const weft_allocator *memory);

extern const weft__force weft__contact_force;
WEFT_FORMS(weft__add_fn, contact);

/* The plain form for particles [first, end) and shapes [shape, end_shape). */
int weft__contact_some(const weft__contact *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end, size_t shape,
                       size_t end_shape);
