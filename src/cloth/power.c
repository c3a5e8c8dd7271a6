/* SPDX-License-Identifier: BSD-3-Clause */
/* power.c -- at what rate springs, drag, wind and moved pins change the energy E of a
 * cloth, that is, kinetic and gravitational of the free particles and elastic:
 *
 *     dE/dt = -springs - drag + wind + pins                        (docs/physics.md)
 *
 * Each row is summed by itself, then the rows in their order. */
#include "kernel/kernel.h"

#include <math.h>

/* Work of the wind and of drag on a free particle. */
static void add_air(const weft_cloth *cloth, size_t r, size_t c, const double *y,
                    double power[WEFT_POWERS])
{
    const size_t n = cloth->particles, i = r * cloth->cols + c;
    const double *v = y + 3 * n + i;
    double force[3];
    power[WEFT_POWER_DRAG]
        += cloth->drag * (v[0] * v[0] + v[n] * v[n] + v[2 * n] * v[2 * n]);
    if (cloth->wind_drag != 0.0 && weft__wind_force(cloth, r, c, y, force)) {
        power[WEFT_POWER_WIND]
            += force[0] * v[0] + force[1] * v[n] + force[2] * v[2 * n];
    }
}

/* Pull [N] of a spring between p and q on p. */
static void add_pull(const weft_cloth *cloth, const weft__group *group, size_t p,
                     size_t q, const double *y, double force[3])
{
    const weft__stance at = weft__spring_stance(cloth->particles, p, q, y);
    if (at.length == 0.0) {
        return;
    }
    const double rate
        = (at.w[0] * at.d[0] + at.w[1] * at.d[1] + at.w[2] * at.d[2]) / at.length;
    const double tension
        = group->stiffness * (at.length - group->rest_length) + group->damping * rate;
    for (size_t k = 0; k < 3; ++k) {
        force[k] += tension / at.length * at.d[k];
    }
}

/* Whether a spring of the group starts at (r, c). */
static bool starts_at(const weft__group *group, size_t r, size_t c)
{
    return r < group->end_row && c >= group->first_col && c < group->end_col;
}

/* What moves a pin works against the springs that hold on to it. */
static double pin_power(const weft_cloth *cloth, size_t i, double t, const double *y)
{
    const size_t cols = cloth->cols;
    double force[3] = { 0.0 }, rate[6], power = 0.0;
    weft__pin_rate(cloth, i, t, rate);
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        const size_t stride = (size_t)group->stride;
        if (starts_at(group, i / cols, i % cols)) {
            add_pull(cloth, group, i, i + stride, y, force);
        }
        if (i >= stride && starts_at(group, (i - stride) / cols, (i - stride) % cols)) {
            add_pull(cloth, group, i, i - stride, y, force);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        power -= force[k] * rate[k];
    }
    return power;
}

static void row_power(const weft_cloth *cloth, size_t r, double t, const double *y,
                      double power[WEFT_POWERS])
{
    const bool air = cloth->drag != 0.0 || cloth->wind_drag != 0.0;
    power[WEFT_POWER_SPRINGS] += cloth->level->damping(cloth, y, r);
    for (size_t c = 0; c < cloth->cols; ++c) {
        const size_t i = r * cloth->cols + c;
        if (cloth->pin[i] == 0) {
            if (air) {
                add_air(cloth, r, c, y, power);
            }
        } else if (cloth->motions[cloth->pin[i] - 1].moves) {
            power[WEFT_POWER_PINS] += pin_power(cloth, i, t, y);
        }
    }
}

void weft_cloth_power(const weft_cloth *cloth, double t, const double *y,
                      double power[WEFT_POWERS])
{
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        power[k] = 0.0;
    }
    for (size_t r = 0; r < cloth->rows; ++r) {
        double row[WEFT_POWERS] = { 0.0 };
        row_power(cloth, r, t, y, row);
        for (size_t k = 0; k < WEFT_POWERS; ++k) {
            power[k] += row[k];
        }
    }
}

double weft_cloth_dissipation(const weft_cloth *cloth, const double *y)
{
    double power[WEFT_POWERS];
    weft_cloth_power(cloth, 0.0, y, power); /* pins alone depend on t */
    return power[WEFT_POWER_SPRINGS] + power[WEFT_POWER_DRAG];
}
