/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (m g - drag v + springs + bending + wind
 *                                             + contact + self-contact) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit. The plain loops here
 * have the same bits as src/kernel. */
#include <string.h>

#include "cloth/levels.h"
#include "cloth/self.h"
#include "cloth/springs.h"

#define POINTER(name, level) &weft__##name,
const weft__added *const weft__added_forces[WEFT__ADDED] = { WEFT_ADDED(POINTER, ) };

/* Adds the added forces on particle i to to[3], n apart. */
static void add(const weft__subject *of, size_t i, weft__unit unit, double *to)
{
    for (size_t a = 0; a < WEFT__ADDED; ++a) {
        weft__added_forces[a]->add(of, i, unit, to);
    }
}

void weft_cloth_force(const weft_cloth *cloth, double t, const double *y, double *f)
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y };
    const size_t n = cloth->particles;
    for (size_t i = 0; i < n; ++i) {
        double springs[3];
        weft__springs_force(cloth, i, y, NULL, springs);
        for (size_t k = 0; k < 3; ++k) {
            f[k * n + i] = cloth->mass[i] * cloth->gravity[k]
                           + (springs[k] - cloth->drag * y[(k + 3) * n + i]);
        }
        add(&of, i, WEFT__FORCE, f + i);
    }
    (void)weft__self_add(&of, WEFT__FORCE, f);
}

/* 0 where a particle's six numbers from z on are finite, else NaN. */
static double trouble(const double *z, size_t n)
{
    return ((z[3 * n] + z[4 * n] + z[5 * n]) + (z[0] + z[n] + z[2 * n])) * 0.0;
}

int weft__reference_rows(const weft__subject *of, double *dydt, size_t first_row,
                         size_t end_row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles, end = end_row * cloth->cols;
    double bad = 0.0;
    for (size_t i = first_row * cloth->cols; i < end; ++i) {
        double springs[3];
        weft__springs_force(cloth, i, of->y, NULL, springs);
        for (size_t k = 0; k < 3; ++k) {
            const double v = dydt[k * n + i] = of->y[(k + 3) * n + i];
            const double force = springs[k] - cloth->drag * v;
            dydt[(k + 3) * n + i] = cloth->gravity[k] + cloth->inverse_mass[i] * force;
        }
        add(of, i, WEFT__ACCELERATION, dydt + 3 * n + i);
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

enum { KEPT = 8 }; /* motions whose rates a pass keeps */

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

int weft__rhs_rows(const weft__subject *of, double *dydt, size_t first, size_t end)
{
    const weft_cloth *cloth = of->cloth;
    int failed = cloth->level->rows(of, dydt, first, end);
    for (size_t a = 0; a < WEFT__ADDED && cloth->level->added[a] != NULL; ++a) {
        failed |= cloth->level->added[a](of, dydt, first, end);
    }
    move_pins(cloth, of->t, dydt, first * cloth->cols, end * cloth->cols);
    return failed;
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y };
    return weft__rhs_rows(&of, dydt, 0, cloth->rows)
           | weft__self_add(&of, WEFT__ACCELERATION, dydt + 3 * cloth->particles);
}
