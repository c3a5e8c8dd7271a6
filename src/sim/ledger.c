/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/simulation.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/finite.h"

/* Where the integral of each power goes: heat, or work done on the cloth. */
static const struct {
    size_t at; /* in weft_ledger */
    bool heat;
} accounts[WEFT_POWERS] = {
#define ACCOUNT(member, power, by)                                                     \
    [power] = { offsetof(weft_ledger, member), sizeof(by) == sizeof "" },
    WEFT_LEDGER_POWERS(ACCOUNT) WEFT_LEDGER_LATER_POWERS(ACCOUNT)
#undef ACCOUNT
};

bool weft__ledger_rates(const weft__forces *forces, double t, const double *y,
                        double force_power, double *rates)
{
    const weft__state of = weft__forces_state(forces, t, y);
    const weft_measures all = weft__forces_measure(forces, &of, weft__block_power);
    memcpy(rates, all.power, sizeof all.power);
    rates[WEFT_POWERS] = force_power;
    return weft__all_finite(rates, WEFT__QUADRATURES);
}

static weft_energy energy_of(const weft__forces *forces, double t, const double *y)
{
    const weft__state of = weft__forces_state(forces, t, y);
    return weft__forces_measure(forces, &of, weft__block_energy).energy;
}

void weft__ledger_start(weft__ledger *ledger, const weft__forces *forces, double *y)
{
    if (ledger->on) {
        for (size_t k = 0; k < WEFT__QUADRATURES; ++k) {
            y[weft_cloth_dim(forces->cloth) + k] = 0.0;
        }
        ledger->start = weft_energy_total(energy_of(forces, 0.0, y));
    }
}

void weft__ledger_mark(weft__ledger *ledger, const weft__forces *forces, double t,
                       const double *y)
{
    if (ledger->on) {
        ledger->marked = weft_energy_total(energy_of(forces, t, y));
    }
}

void weft__ledger_account(weft__ledger *ledger, const weft__forces *forces, double t,
                          const double *y, double *work)
{
    if (ledger->on) {
        const double energy = weft_energy_total(energy_of(forces, t, y));
        *work += energy - ledger->marked;
        ledger->marked = energy;
    }
}

weft_ledger weft__ledger_read(const weft__ledger *ledger, const weft__forces *forces,
                              double t, const double *y)
{
    weft_ledger out = { .kept = ledger->on, .energy = energy_of(forces, t, y) };
    if (ledger->on) {
        const double *done = y + weft_cloth_dim(forces->cloth); /* [J] */
        out.residual = weft_energy_total(out.energy) - ledger->start;
        for (size_t k = 0; k < WEFT_POWERS; ++k) {
            memcpy((char *)&out + accounts[k].at, &done[k], sizeof done[k]);
            out.residual += accounts[k].heat ? done[k] : -done[k];
        }
        out.work_force = done[WEFT_POWERS];
        out.work_limit = ledger->work_limit;
        out.work_outside = ledger->work_outside;
        out.residual
            = out.residual - out.work_limit - out.work_outside - out.work_force;
    }
    return out;
}

double weft__ledger_heat(const weft__ledger *ledger, const weft_cloth *cloth,
                         const double *y)
{
    const double *done = y + weft_cloth_dim(cloth); /* [J] */
    double heat = 0.0;
    for (size_t k = 0; ledger->on && k < WEFT_POWERS; ++k) {
        heat += accounts[k].heat ? done[k] : 0.0;
    }
    return ledger->on ? heat : (double)NAN;
}
