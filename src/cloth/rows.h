/* SPDX-License-Identifier: BSD-3-Clause */
/* rows.h -- the equations of motion in bands of rows, for src/sim to divide among
 * threads. */
#ifndef WEFT_CLOTH_ROWS_H
#define WEFT_CLOTH_ROWS_H

#include "weft/cloth.h"

/* weft_cloth_rhs of the rows [first, end) alone; other rows are not written to. Rows
 * divided in whatever way have the same bits. */
int weft__rhs_rows(const weft_cloth *cloth, double t, const double *y, double *dydt,
                   size_t first, size_t end);

/* cloth_hash.c: of all that moves a cloth but its state: springs, masses, pins, forces.
 */
uint64_t weft__cloth_hash(const weft_cloth *cloth);

#endif
