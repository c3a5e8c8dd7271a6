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

/* power.c: [W], what the dampers and the drag of row r turn into heat; the springs are
 * those that begin there. */
double weft__row_heat(const weft_cloth *cloth, size_t r, const double *y);

#endif
