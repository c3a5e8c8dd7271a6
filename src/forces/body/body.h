/* SPDX-License-Identifier: BSD-3-Clause */
/* body.h -- weight and viscous air: m g - drag v on each particle. */
#pragma once

#include "forces/force.h"

typedef struct weft__body {
    const weft__mesh *mesh;
    double gravity[3]; /* [m/s^2] */
    double drag;       /* [kg/s] */
} weft__body;

WEFT__NUMBERS(weft__body_numbers, gravity, damping);
extern const weft__force weft__body_force;
