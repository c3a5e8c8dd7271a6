/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/ledger.h"

#include <math.h>

#include "sim/forces.h"

int weft__ledger_rhs(double t, const double *y, double *dydt, void *ctx)
{
    const weft__forces *forces = ctx;
    const weft_cloth *cloth = forces->cloth;
    double *power = dydt + weft_cloth_dim(cloth);
    int failed = weft__forces_rhs(forces, t, y, dydt, NULL);
    weft_cloth_power(cloth, t, y, power);
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        failed |= !isfinite(power[k]);
    }
    return failed;
}

static double total(const weft_energy *energy)
{
    double sum = energy->kinetic + energy->gravitational;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        sum += energy->elastic[k];
    }
    return sum;
}

static double total_of(const weft_cloth *cloth, const double *y)
{
    const weft_energy energy = weft_cloth_energy(cloth, y);
    return total(&energy);
}

void weft__ledger_start(weft__ledger *ledger, const weft_cloth *cloth, double *y)
{
    if (ledger->on) {
        for (size_t k = 0; k < WEFT_POWERS; ++k) {
            y[weft_cloth_dim(cloth) + k] = 0.0;
        }
        ledger->start = total_of(cloth, y);
    }
}

void weft__ledger_mark(weft__ledger *ledger, const weft_cloth *cloth, const double *y)
{
    if (ledger->on) {
        ledger->marked = total_of(cloth, y);
    }
}

void weft__ledger_account(weft__ledger *ledger, const weft_cloth *cloth,
                          const double *y, double *work)
{
    if (ledger->on) {
        const double energy = total_of(cloth, y);
        *work += energy - ledger->marked;
        ledger->marked = energy;
    }
}

weft_ledger weft__ledger_read(const weft__ledger *ledger, const weft_cloth *cloth,
                              const double *y)
{
    weft_ledger out = { .kept = ledger->on, .energy = weft_cloth_energy(cloth, y) };
    if (ledger->on) {
        const double *done = y + weft_cloth_dim(cloth); /* [J] */
        out.dissipated_springs = done[WEFT_POWER_SPRINGS];
        out.dissipated_drag = done[WEFT_POWER_DRAG];
        out.wind_work = done[WEFT_POWER_WIND];
        out.pin_work = done[WEFT_POWER_PINS];
        out.limit_work = ledger->limit_work;
        out.outside_work = ledger->outside_work;
        out.residual = total(&out.energy) - ledger->start + out.dissipated_springs
                       + out.dissipated_drag - out.wind_work - out.pin_work
                       - out.limit_work - out.outside_work;
    }
    return out;
}
