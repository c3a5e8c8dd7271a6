/* SPDX-License-Identifier: BSD-3-Clause */
/* wind.h -- the wind on a particle, after Provot 1995:
 *
 *     F = drag area (n . (wind - v)) n
 *
 * with n the unit normal of N, the cross product of the column tangent
 * x(r, c+1) - x(r, c-1) and the row tangent x(r+1, c) - x(r-1, c), one-sided on the
 * rim; no force where they are parallel or a direction has a single particle. Of
 * triangles, each with its normal, its present area and the mean velocity of its
 * corners gives a third of that force to each corner. */
#pragma once

#include "forces/force.h"

typedef struct weft__air {
    double velocity[3]; /* [m/s] */
    double drag;        /* [kg/(m^2 s)] 0: none */
    weft__curve track;  /* [m/s] unless count is 0, instead of velocity */
} weft__air;

typedef struct weft__wind {
    const weft__mesh *mesh;
    weft__air air;
    weft__air defined; /* what a copy began with */
    bool changed;      /* by weft__wind_set */
    double *rows;      /* of the definition's track; NULL: none, or another's */
    weft__add_fn *fast;
} weft__wind;

/* From now on this velocity [m/s] and drag, or with NULL what it began with. False:
 * they make no sense, and nothing changes. */
bool weft__wind_set(weft__wind *own, const double velocity[3], double drag);

WEFT__NUMBERS(weft__wind_numbers, wind_velocity, wind_drag);
extern const weft__force weft__wind_force;
WEFT_FORMS(weft__add_fn, wind);
