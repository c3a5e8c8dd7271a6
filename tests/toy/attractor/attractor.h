/* SPDX-License-Identifier: BSD-3-Clause */
/* attractor.h -- a force that tools/checks/check-toy adds to a copy of weft, to show
 * what a further force touches: towards the origin, with drag,
 *
 *     F = -m strength x / (1 + |x|^2 / (1 m)^2) - m drag v
 *
 * with the energy m strength / 2 ln(1 + |x|^2 / (1 m)^2) (1 m)^2. */
#pragma once

#include "forces/force.h"

typedef struct weft__attractor {
    const weft__mesh *mesh;
    double strength; /* [1/s^2] */
    double drag;     /* [1/s] */
} weft__attractor;

WEFT__NUMBERS(weft__attractor_numbers, attractor_strength, attractor_drag);
extern const weft__force weft__attractor_force;
