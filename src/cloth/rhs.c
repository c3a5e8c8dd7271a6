/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (m g - drag v + springs + wind) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit.
 *
 * weft_cloth_force is the plain form of the model; the kernels (kernel.h) are held to
 * it by tests. */
#include "cloth/internal.h"
#include "cloth/kernel.h"
#include "cloth/rows.h"

#include <math.h>

void weft_cloth_force(const weft_cloth *cloth, const double *y, double *f)
{
    const size_t n = cloth->particles;
    const double *v = y + 3 * n;
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < n; ++i) {
            const size_t j = k * n + i;
            f[j] = cloth->mass[i] * cloth->gravity[k] - cloth->drag * v[j];
        }
    }
    for (size_t g = 0; g < cloth->group_count; ++g) {
        weft__group_add_force(cloth, &cloth->groups[g], y, f);
    }
    weft__wind_add_force(cloth, y, f);
}

double weft__motion_velocity(const weft__motion *motion, size_t k, double t)
{
    const double w = motion->omega;
    return motion->velocity[k] + w * motion->amplitude[k] * cos(w * t);
}

static void move_pin(const weft__motion *motion, double t, size_t n, double *dydt)
{
    const double w = motion->omega;
    for (size_t k = 0; k < 3; ++k) {
        dydt[k * n] = weft__motion_velocity(motion, k, t);
        dydt[(k + 3) * n] = -w * w * motion->amplitude[k] * sin(w * t);
    }
}

/* Neighbours often share a motion. */
static void move_pins(const weft_cloth *cloth, double t, double *dydt, size_t first,
                      size_t end)
{
    const size_t n = cloth->particles;
    size_t before = n;
    for (size_t j = 0; j < cloth->pinned; ++j) {
        const size_t i = cloth->pins[j];
        if (i < first || i >= end) {
            continue;
        }
        if (before < n && cloth->pin[before] == cloth->pin[i]) {
            for (size_t k = 0; k < 6; ++k) {
                dydt[k * n + i] = dydt[k * n + before];
            }
        } else {
            move_pin(&cloth->motions[cloth->pin[i] - 1], t, n, dydt + i);
        }
        before = i;
    }
}

int weft__rhs_rows(const weft_cloth *cloth, double t, const double *y, double *dydt,
                   double *heat, size_t first, size_t end)
{
    int failed = cloth->level->springs(cloth, y, dydt, heat, first, end);
    if (cloth->wind_drag != 0.0) {
        failed |= cloth->level->wind(cloth, y, dydt, first, end);
    }
    move_pins(cloth, t, dydt, first * cloth->cols, end * cloth->cols);
    return failed;
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    return weft__rhs_rows(cloth, t, y, dydt, NULL, 0, cloth->rows);
}
