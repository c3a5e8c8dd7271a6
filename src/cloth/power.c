/* SPDX-License-Identifier: BSD-3-Clause */
/* power.c -- at what rate springs, drag, wind, moved pins and shapes change the energy
 * E of a cloth: kinetic and gravitational of the free particles, elastic, and contact.
 *
 *     dE/dt = -springs - drag - contact - friction + wind + pins + shapes
 *                                                                  (docs/physics.md)
 *
 * Each row is summed by itself, then the rows in their order. */
#include "cloth/levels.h"
#include "cloth/rows.h"
#include "cloth/springs.h"

#include <string.h>

double weft__reference_damping(const weft_cloth *cloth, const double *y, size_t r)
{
    double power = 0.0;
    for (weft__walk walk = weft__row_springs(cloth, y, r); weft__each_spring(&walk);) {
        const weft__spring *at = &walk.spring;
        const double rate = weft__spring_rate(cloth, at, y + 3 * cloth->particles);
        power += at->group->damping * rate * (rate / (at->square + DBL_MIN));
    }
    return power;
}

/* Work of the wind and of drag on a free particle. */
static void add_air(const weft_cloth *cloth, size_t i, const double *y,
                    double power[WEFT_POWERS])
{
    const size_t n = cloth->particles;
    const double v[3] = { y[3 * n + i], y[4 * n + i], y[5 * n + i] };
    power[WEFT_POWER_DRAG] += cloth->drag * weft__dot(v, v);
    if (cloth->wind_drag != 0.0) {
        double force[3];
        weft__wind_force(cloth, i, y, 1.0, force);
        power[WEFT_POWER_WIND] += weft__dot(force, v);
    }
}

/* What moves a pin works against the springs that hold on to it. */
static double pin_power(const weft_cloth *cloth, size_t i, double t, const double *y)
{
    double force[3], rate[6];
    weft__springs_force(cloth, i, y, force);
    weft__pin_rate(cloth, i, t, rate);
    return -weft__dot(force, rate);
}

void weft__row_power(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const bool air = cloth->drag != 0.0 || cloth->wind_drag != 0.0;
    row->power[WEFT_POWER_SPRINGS] = cloth->level->damping(cloth, of->y, r);
    for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
        if (cloth->pin[i] == 0) {
            if (air) {
                add_air(cloth, i, of->y, row->power);
            }
        } else if (cloth->motions[cloth->pin[i] - 1].moves) {
            row->power[WEFT_POWER_PINS] += pin_power(cloth, i, of->t, of->y);
        }
    }
    weft__row_contact_power(of, r, row);
}

double weft_cloth_dissipation(const weft_cloth *cloth, double t, const double *y)
{
    double power[WEFT_POWERS];
    weft_cloth_power(cloth, t, y, power);
    return power[WEFT_POWER_SPRINGS] + power[WEFT_POWER_DRAG]
           + power[WEFT_POWER_CONTACT] + power[WEFT_POWER_FRICTION];
}
