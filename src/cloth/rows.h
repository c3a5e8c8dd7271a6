/* SPDX-License-Identifier: BSD-3-Clause */
/* rows.h -- the equations of motion in bands of rows, and measures of rows, for src/sim
 * to divide among threads. */
#ifndef WEFT_CLOTH_ROWS_H
#define WEFT_CLOTH_ROWS_H

#include "weft/cloth.h"

/* weft_cloth_rhs of the rows [first, end) alone; other rows are not written to. Rows
 * divided in whatever way have the same bits. */
int weft__rhs_rows(const weft_cloth *cloth, double t, const double *y, double *dydt,
                   size_t first, size_t end);

typedef struct weft__subject {
    const weft_cloth *cloth;
    double t;
    const double *y;
    const bool *families; /* in which the worst spring is sought; NULL: all */
} weft__subject;

/* Measures a part or all of row r into *row, which is weft__row_start before. Springs
 * belong to the row where they begin. measure.c, power.c, contact.c */
typedef void weft__row_fn(const weft__subject *of, size_t r, weft_measures *row);
weft__row_fn weft__row_energy, weft__row_power, weft__row_worst, weft__row_all;
weft__row_fn weft__row_contact_energy, weft__row_contact_power, weft__row_gap;

extern const weft_measures weft__row_start;

/* Of all rows, taken in their order: *sum is weft__measures_start before the first. */
extern const weft_measures weft__measures_start;
void weft__measures_add(weft_measures *sum, const weft_measures *row);

/* The smaller gap; NaN is smaller than a number. */
void weft__keep_gap(weft_measures *kept, double gap, size_t particle, size_t shape);

/* cloth_hash.c: of all that moves a cloth but its state: springs, masses, pins, forces,
 * shapes. */
uint64_t weft__cloth_hash(const weft_cloth *cloth);

/* Of the law of contact alone, which shapes that are added obey. */
uint64_t weft__contact_hash(const weft_cloth *cloth);

#endif
