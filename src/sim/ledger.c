/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/ledger.h"

#include <string.h>

#include "base/finite.h"

bool weft__ledger_rates(const weft__forces *forces, double t, const double *y,
                        double force_power, double *rates)
{
    const weft__subject of = { .cloth = forces->cloth, .t = t, .y = y };
    const weft_measures all = weft__forces_measure(forces, &of, weft__row_power);
    memcpy(rates, all.power, sizeof all.power);
    rates[WEFT_POWERS] = force_power;
    return weft__all_finite(rates, WEFT__QUADRATURES);
}

static weft_energy energy_of(const weft__forces *forces, const double *y)
{
    const weft__subject of = { .cloth = forces->cloth, .y = y };
    return weft__forces_measure(forces, &of, weft__row_energy).energy;
}

void weft__ledger_start(weft__ledger *ledger, const weft_cloth *cloth, double *y)
{
    if (ledger->on) {
        for (size_t k = 0; k < WEFT__QUADRATURES; ++k) {
            y[weft_cloth_dim(cloth) + k] = 0.0;
        }
        ledger->start = weft_energy_total(weft_cloth_energy(cloth, y));
    }
}

void weft__ledger_mark(weft__ledger *ledger, const weft__forces *forces,
                       const double *y)
{
    if (ledger->on) {
        ledger->marked = weft_energy_total(energy_of(forces, y));
    }
}

void weft__ledger_account(weft__ledger *ledger, const weft__forces *forces,
                          const double *y, double *work)
{
    if (ledger->on) {
        const double energy = weft_energy_total(energy_of(forces, y));
        *work += energy - ledger->marked;
        ledger->marked = energy;
    }
}

weft_ledger weft__ledger_read(const weft__ledger *ledger, const weft__forces *forces,
                              const double *y)
{
    weft_ledger out = { .kept = ledger->on, .energy = energy_of(forces, y) };
    if (ledger->on) {
        const double *done = y + weft_cloth_dim(forces->cloth); /* [J] */
        out.dissipated_springs = done[WEFT_POWER_SPRINGS];
        out.dissipated_drag = done[WEFT_POWER_DRAG];
        out.wind_work = done[WEFT_POWER_WIND];
        out.pin_work = done[WEFT_POWER_PINS];
        out.force_work = done[WEFT_POWERS];
        out.limit_work = ledger->limit_work;
        out.outside_work = ledger->outside_work;
        out.residual = weft_energy_total(out.energy) - ledger->start
                       + out.dissipated_springs + out.dissipated_drag - out.wind_work
                       - out.pin_work - out.limit_work - out.outside_work
                       - out.force_work;
    }
    return out;
}
