/* SPDX-License-Identifier: BSD-3-Clause */
/* rows.h -- the equations of motion in bands of rows, for src/sim to divide among
 * threads. */
#ifndef WEFT_CLOTH_ROWS_H
#define WEFT_CLOTH_ROWS_H

#include "weft/cloth.h"

/* Sums of a row whose own sum is its heat. */
#define WEFT_SUMS 8

/* weft_cloth_rhs of the rows [first, end) alone; other rows are not written to. Where
 * heat is not NULL, also their weft__row_heat at heat + WEFT_SUMS r. Rows divided in
 * whatever way have the same bits. */
int weft__rhs_rows(const weft_cloth *cloth, double t, const double *y, double *dydt,
                   double *heat, size_t first, size_t end);

/* power.c: [W], what the dampers and the drag of row r turn into heat; the springs are
 * those that begin there. */
void weft__row_heat(const weft_cloth *cloth, size_t r, const double *y,
                    double heat[WEFT_SUMS]);

/* Of so many rows, in their order: weft_cloth_dissipation. */
double weft__heat_sum(const double *heat, size_t rows);

/* cloth_hash.c: of all that moves a cloth but its state: springs, masses, pins, forces.
 */
uint64_t weft__cloth_hash(const weft_cloth *cloth);

#endif
