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
#include "cloth/model.h"
#include "cloth/rows.h"
#include "kernel/kernel.h"

#include "weft/elementary.h"

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

void weft__pin_rate(const weft_cloth *cloth, size_t i, double t, double rate[6])
{
    const weft__motion *motion = &cloth->motions[cloth->pin[i] - 1];
    const double *velocity = motion->coasts ? cloth->coast + 3 * i : motion->velocity;
    const double w = motion->omega;
    double sine = 0.0, cosine = 1.0;
    if (w != 0.0) {
        weft_sincos_turns(motion->frequency, t, &sine, &cosine);
    }
    for (size_t k = 0; k < 3; ++k) {
        rate[k] = velocity[k] + w * motion->amplitude[k] * cosine;
        rate[k + 3] = -w * w * motion->amplitude[k] * sine;
    }
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
    int failed = cloth->level->springs(cloth, y, dydt, first, end);
    if (cloth->wind_drag != 0.0) {
        failed |= cloth->level->wind(cloth, y, dydt, first, end);
    }
    move_pins(cloth, t, dydt, first * cloth->cols, end * cloth->cols);
    return failed;
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    return weft__rhs_rows(cloth, t, y, dydt, 0, cloth->rows);
}
