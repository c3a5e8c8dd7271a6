/* SPDX-License-Identifier: BSD-3-Clause */
/* ledger.h -- the energy gained and lost by a simulation.
 *
 * The powers of weft_cloth_power and that of the embedder's force are integrated with
 * the state, as quadratures after its 6 N numbers. Changes between the steps are
 * counted as work. */
#pragma once

#include "sim/forces.h"
#include "weft/sim.h"

enum { WEFT__QUADRATURES = WEFT_POWERS + 1 }; /* the last: the embedder's force */

typedef struct weft__ledger {
    bool on;                         /* off: these functions do nothing */
    double start;                    /* [J] energy at t = 0 */
    double marked;                   /* [J] energy at the last mark */
    double work_limit, work_outside; /* [J] */
} weft__ledger;

/* Writes the powers at t to rates[WEFT__QUADRATURES]; returns whether all are finite.
 */
bool weft__ledger_rates(const weft__forces *forces, double t, const double *y,
                        double force_power, double *rates);

/* y is the state at t = 0; zeroes the quadratures behind it. */
void weft__ledger_start(weft__ledger *ledger, const weft__forces *forces, double *y);

/* Around corrections: mark before the first; after each that changed y, account adds
 * the change of energy to *work, a field of the ledger. */
void weft__ledger_mark(weft__ledger *ledger, const weft__forces *forces, double t,
                       const double *y);
void weft__ledger_account(weft__ledger *ledger, const weft__forces *forces, double t,
                          const double *y, double *work);

weft_ledger weft__ledger_read(const weft__ledger *ledger, const weft__forces *forces,
                              double t, const double *y);

/* [J] all heat; NaN if it is off. */
double weft__ledger_heat(const weft__ledger *ledger, const weft_cloth *cloth,
                         const double *y);
