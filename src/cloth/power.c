/* SPDX-License-Identifier: BSD-3-Clause */
/* power.c -- the powers of springs, drag, wind, moved pins and shapes, which change the
 * energy E of a cloth: kinetic and gravitational of the free particles, elastic,
 * contact:
 *
 *     dE/dt = -springs - drag - contact - friction + wind + pins + shapes
 *                                                                  (docs/physics.md)
 *
 * Each row is summed by itself, then the rows in their order. */
#include "cloth/levels.h"
#include "cloth/springs.h"

double weft__reference_damping(const weft_cloth *cloth, const double *y, size_t r)
{
    double power = 0.0;
    for (weft__walk walk = weft__row_springs(cloth, y, r); weft__each_spring(&walk);) {
        const weft__spring *at = &walk.spring;
        const double rate = weft__spring_rate(cloth, at, y + 3 * cloth->particles);
        power += weft__spring_damping(at) * rate * (rate / (at->square + DBL_MIN));
    }
    return power;
}

/* The motion of a pin does work against its springs. */
static double pin_power(const weft_cloth *cloth, size_t i, double t, const double *y)
{
    double force[3], rate[6];
    weft__springs_force(cloth, i, y, NULL, force);
    weft__pin_rate(cloth, i, t, rate);
    return -weft__dot(force, rate);
}

void weft__row_heat(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles, end = (r + 1) * cloth->cols;
    row->power[WEFT_POWER_SPRINGS] = cloth->level->damping(cloth, of->y, r);
    for (size_t i = r * cloth->cols; cloth->drag != 0.0 && i < end; ++i) {
        const double *z = of->y + i;
        const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
        if (cloth->pin[i] == 0) {
            row->power[WEFT_POWER_DRAG] += cloth->drag * weft__dot(v, v);
        }
    }
}

void weft__row_power(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    weft__row_heat(of, r, row);
    for (size_t a = 0; a < WEFT__ADDED; ++a) {
        weft__added_forces[a]->power(of, r, row);
    }
    for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
        if (cloth->pin[i] != 0 && cloth->motions[cloth->pin[i] - 1].moves) {
            row->power[WEFT_POWER_PINS] += pin_power(cloth, i, of->t, of->y);
        }
    }
}
