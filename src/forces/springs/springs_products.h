/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_products.h -- products of the springs' linearisation with directions of the
 * state, weft__products_fn, and its transpose, weft__turned_fn: J^T w of springs,
 * weight and air, all particles having x' = v, and the derivatives of w.f with respect
 * to their parameters. at->along is l = w by the masses, 3 N and as much behind it. To
 * net[3 N] goes the force of springs and air, unless it is NULL. Both return as
 * weft__start_fn.
 */
#pragma once

#include "forces/springs/springs.h"

/* The derivative with respect to a parameter, per unit of it, of springs, weight and
 * masses: of what those of all groups are, by the orientation of each. */
typedef struct weft__law_derivative {
    double stiffness, damping, rest_length;
} weft__law_derivative;
typedef struct weft__spring_derivative {
    weft__law_derivative laws[WEFT_GROUPS];
    unsigned orientations; /* of laws that are not 0: 1 << orientation */
    bool damped;           /* one of them has damping */
    double gravity[3], drag;
    const double *inverse_mass; /* [1/kg] N and WEFT_PAST more; NULL: 0 */
} weft__spring_derivative;

/* Directions of the state whose products are found in one sweep, which finds what all
 * share once. In y, base, along and out planes are `stride` apart, rows `down`. */
enum { WEFT__TANGENTS = 8 };
typedef struct weft__tangent {
    const double *along;
    double *out;                       /* x' and v' */
    const weft__spring_derivative *by; /* adds that derivative; NULL: none */
} weft__tangent;
typedef struct weft__tangents {
    const double *y;
    double *base; /* of the state itself, as weft__start_fn; NULL: not wanted */
    size_t stride, down, count;
    weft__tangent tangent[WEFT__TANGENTS];
} weft__tangents;

/* The derivatives of a sum with respect to the parameters of springs, for each
 * orientation, and of a body. */
typedef struct weft__parameter_gradient {
    double stiffness[WEFT_GROUPS], damping[WEFT_GROUPS], rest_length[WEFT_GROUPS];
    double gravity[3], drag;
} weft__parameter_gradient;

/* A transposed product sums for each parameter every eighth column of a tile, row by
 * row; the last columns, from weft__last_columns on, which are in the ends of rows for
 * some width, after all others. */
enum { WEFT__TILE = 128, WEFT__EVERY = 8, WEFT__TOTALS = 3 * WEFT_GROUPS + 4 };
typedef double weft__totals[WEFT__TOTALS][WEFT__EVERY];

static inline size_t weft__last_columns(size_t cols)
{
    return cols < 2 ? 0 : (cols - 2) / WEFT__EVERY * WEFT__EVERY;
}

/* The totals of both; those of springs pull the opposite way. */
void weft__totals_add(const weft__totals totals[2], weft__parameter_gradient *by);

/* [N] The derivative of T u along a direction of the state, given its differences dd,
 * dw and those of velocities, w:
 *
 *     q dd + (z.dd + c d.dw / L^2) d,   q = T / L,   r = w.d / L^2,
 *     z = ((k - q - c r) d + c w) / L^2
 *
 * and with respect to a parameter on which k, c and s depend, by dk, dc and ds (NULL:
 * none):
 *
 *     (dk L (L - s) / L^2 + dc r - ds k L / L^2) d
 */
static inline void weft__spring_change(const weft__spring *spring, const double w[3],
                                       const double dd[3], const double dw[3],
                                       const weft__law_derivative *by, double change[3])
{
    const double k = weft__spring_stiffness(spring), c = weft__spring_damping(spring);
    const double rate = weft__dot(w, spring->d), length = sqrt(spring->square);
    const double inverse = 1.0 / (spring->square + DBL_MIN);
    const double q = weft__spring_tension(spring, rate), turn = rate * inverse;
    const double part = k - (q + c * turn), *d = spring->d;
    const double z[3]
        = { (part * d[0] + c * w[0]) * inverse, (part * d[1] + c * w[1]) * inverse,
            (part * d[2] + c * w[2]) * inverse };
    double pull = weft__dot(z, dd) + c * inverse * weft__dot(d, dw);
    if (by != NULL) {
        const double share = spring->share;
        const double longer = length * (length - spring->group->rest_length) * inverse;
        pull += by->stiffness * (share * longer) + by->damping * (share * turn)
                - by->rest_length * (k * length * inverse);
    }
    for (size_t j = 0; j < 3; ++j) {
        change[j] = pull * d[j] + q * dd[j];
    }
}
