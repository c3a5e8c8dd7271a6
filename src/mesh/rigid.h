/* SPDX-License-Identifier: BSD-3-Clause */
/* rigid.h -- a rigid motion, of shapes: a turn about an axis through c, which moves as
 * motion.c says. A point that begins at x0 is at time t, with an angle a,
 *
 *     x = c + R(a) (x0 - c0),   v = c' + omega x (x - c),   omega = a' axis
 *     a = rate (t - since) + amplitude sin(2 pi frequency t) */
#pragma once

#include "mesh/mesh.h"

typedef struct weft__rigid_motion {
    weft__motion motion; /* of c */
    weft_turn turn;      /* axis: unit; about: c0 */
    bool turns;
} weft__rigid_motion;

typedef struct weft__matrix {
    double row[3][3];
} weft__matrix;

/* At a time. */
typedef struct weft__rigid {
    bool turns;
    double quaternion[4]; /* x y z w, and its R */
    weft__matrix rotation;
    double about[3], velocity[3]; /* [m] c, [m/s] c' */
    double omega[3];              /* [rad/s] */
} weft__rigid;

/* Of numbers that are finite. at: [m] what it turns about if turn->about is NaN. */
weft__rigid_motion weft__rigid_motion_of(const weft__motion *motion,
                                         const weft_turn *turn, const double at[3]);

weft__rigid weft__rigid_at(const weft__rigid_motion *of, double t);

/* [rad/s], [rad/s^2] No |omega|, and no rate of it, is larger. */
double weft__rigid_fastest(const weft__rigid_motion *of);
double weft__rigid_swing(const weft__rigid_motion *of);

/* The rotation of a quaternion x y z w; 0 0 0 0: none. */
weft__matrix weft__matrix_of(const double q[4]);

/* The rotation b, and then a. */
void weft__quaternion_times(const double a[4], const double b[4], double out[4]);

/* Whether its numbers stay finite. */
bool weft__rigid_usable(const weft__rigid_motion *of);

/* After which a hash goes on. */
uint64_t weft__rigid_hash(const weft__rigid_motion *of, uint64_t hash);

static inline void weft__cross(const double a[3], const double b[3], double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = a[i] * b[j] - a[j] * b[i];
    }
}

/* a v, and its transpose. */
static inline void weft__rotate(const weft__matrix *a, const double v[3], double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = weft__dot(a->row[k], v);
    }
}

static inline void weft__rotate_back(const weft__matrix *a, const double v[3],
                                     double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = a->row[0][k] * v[0] + a->row[1][k] * v[1] + a->row[2][k] * v[2];
    }
}

/* x and v of the point that begins at x0; v may be NULL. */
static inline void weft__rigid_move(const weft__rigid_motion *of,
                                    const weft__rigid *now, const double x0[3],
                                    double x[3], double v[3])
{
    const double *c0 = of->turn.about;
    const double from[3] = { x0[0] - c0[0], x0[1] - c0[1], x0[2] - c0[2] };
    double arm[3], turned[3];
    weft__rotate(&now->rotation, from, arm);
    weft__cross(now->omega, arm, turned);
    for (size_t k = 0; k < 3; ++k) {
        x[k] = now->about[k] + arm[k];
        if (v != NULL) {
            v[k] = now->velocity[k] + turned[k];
        }
    }
}
