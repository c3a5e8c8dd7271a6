/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (m g - drag v + springs + wind) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit. */
#include "cloth/internal.h"

#include <math.h>
#include <string.h>

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

/* Forces in the velocity half of dydt become accelerations. */
static void move_free(const weft_cloth *cloth, const double *y, double *dydt)
{
    const size_t n = cloth->particles;
    memcpy(dydt, y + 3 * n, 3 * n * sizeof *dydt);
    for (size_t k = 3; k < 6; ++k) {
        for (size_t i = 0; i < n; ++i) {
            dydt[k * n + i] /= cloth->mass[i];
        }
    }
}

double weft__motion_velocity(const weft__motion *motion, size_t k, double t)
{
    const double w = motion->omega;
    return motion->velocity[k] + w * motion->amplitude[k] * cos(w * t);
}

static void move_pins(const weft_cloth *cloth, double t, double *dydt)
{
    const size_t n = cloth->particles;
    for (size_t i = 0; cloth->pinned > 0 && i < n; ++i) {
        if (cloth->pin[i] == 0) {
            continue;
        }
        const weft__motion *motion = &cloth->motions[cloth->pin[i] - 1];
        const double w = motion->omega;
        for (size_t k = 0; k < 3; ++k) {
            dydt[k * n + i] = weft__motion_velocity(motion, k, t);
            dydt[(k + 3) * n + i] = -w * w * motion->amplitude[k] * sin(w * t);
        }
    }
}

/* x 0 is 0 for a finite x and NaN for any other, and NaN stays in a sum. */
static bool all_finite(const double *values, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += values[i] * 0.0;
    }
    return sum == 0.0;
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    weft_cloth_force(cloth, y, dydt + 3 * cloth->particles);
    move_free(cloth, y, dydt);
    move_pins(cloth, t, dydt);
    return all_finite(dydt, weft_cloth_dim(cloth)) ? 0 : 1;
}
