/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (m g - drag v + springs + wind + contact) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit. The plain loops here are
 * what src/kernel does fast, with the same bits. */
#include <string.h>

#include "cloth/contact.h"
#include "cloth/levels.h"
#include "cloth/rows.h"
#include "cloth/springs.h"

void weft_cloth_force(const weft_cloth *cloth, double t, const double *y, double *f)
{
    const size_t n = cloth->particles;
    for (size_t i = 0; i < n; ++i) {
        double springs[3], wind[3];
        weft__springs_force(cloth, i, y, springs);
        weft__wind_force(cloth, i, y, 1.0, wind);
        for (size_t k = 0; k < 3; ++k) {
            f[k * n + i] = cloth->mass[i] * cloth->gravity[k]
                           + (springs[k] - cloth->drag * y[(k + 3) * n + i]) + wind[k];
        }
    }
    for (weft__touches at = weft__touches_of(cloth, t, y, 0, n);
         weft__each_touch(&at);) {
        for (size_t k = 0; k < 3; ++k) {
            f[k * n + at.i]
                += cloth->mass[at.i] * weft__touch_acceleration(&at.touch, k);
        }
    }
}

/* 0 where a particle's six numbers from z on are finite, else NaN. */
static double trouble(const double *z, size_t n)
{
    return ((z[3 * n] + z[4 * n] + z[5 * n]) + (z[0] + z[n] + z[2 * n])) * 0.0;
}

int weft__reference_rows(const weft_cloth *cloth, const double *y, double *dydt,
                         size_t first_row, size_t end_row)
{
    const size_t n = cloth->particles, end = end_row * cloth->cols;
    double bad = 0.0;
    for (size_t i = first_row * cloth->cols; i < end; ++i) {
        double springs[3], wind[3];
        weft__springs_force(cloth, i, y, springs);
        weft__wind_force(cloth, i, y, cloth->inverse_mass[i], wind);
        for (size_t k = 0; k < 3; ++k) {
            const double v = dydt[k * n + i] = y[(k + 3) * n + i];
            const double force = springs[k] - cloth->drag * v;
            dydt[(k + 3) * n + i]
                = cloth->gravity[k] + cloth->inverse_mass[i] * force + wind[k];
        }
        bad += trouble(dydt + i, n);
    }
    return bad == 0.0 ? 0 : 1;
}

void weft__pin_rate(const weft_cloth *cloth, size_t i, double t, double rate[6])
{
    weft__motion motion = cloth->motions[cloth->pin[i] - 1];
    if (motion.coasts) {
        memcpy(motion.velocity, cloth->coast + 3 * i, sizeof motion.velocity);
    }
    weft__motion_rate(&motion, t, rate);
}

enum { KEPT = 8 }; /* motions whose rates a pass remembers */

static void move_pins(const weft_cloth *cloth, double t, double *dydt, size_t first,
                      size_t end)
{
    const size_t n = cloth->particles;
    uint32_t kept[KEPT] = { 0 };
    double rates[KEPT][6];
    for (size_t j = 0; j < cloth->pinned; ++j) {
        const size_t i = cloth->pins[j];
        if (i < first || i >= end) {
            continue;
        }
        const uint32_t pin = cloth->pin[i], at = pin % KEPT;
        if (kept[at] != pin || cloth->motions[pin - 1].coasts) {
            kept[at] = pin;
            weft__pin_rate(cloth, i, t, rates[at]);
        }
        for (size_t k = 0; k < 6; ++k) {
            dydt[k * n + i] = rates[at][k];
        }
    }
}

int weft__rhs_rows(const weft_cloth *cloth, double t, const double *y, double *dydt,
                   size_t first, size_t end)
{
    int failed = cloth->level->rows(cloth, y, dydt, first, end);
    if (cloth->shape_count > 0) {
        failed |= cloth->level->contact(cloth, t, y, dydt, first, end);
    }
    move_pins(cloth, t, dydt, first * cloth->cols, end * cloth->cols);
    return failed;
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    return weft__rhs_rows(cloth, t, y, dydt, 0, cloth->rows);
}
