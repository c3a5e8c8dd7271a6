/* SPDX-License-Identifier: BSD-3-Clause */
/* rows.h -- the equations of motion in bands of rows, and measures of rows, for src/sim
 * to divide among threads. */
#ifndef WEFT_CLOTH_ROWS_H
#define WEFT_CLOTH_ROWS_H

#include "weft/cloth.h"

/* A cloth in a state at a time. */
typedef struct weft__subject {
    const weft_cloth *cloth;
    double t;
    const double *y;
    const bool *families; /* in which the worst spring is sought; NULL: all */
    const double *along;  /* of products: a direction of the state */
} weft__subject;

/* A part or all of dy/dt for the rows [first, end); other rows are not written to.
 * Returns 0, or 1 if a number is not finite. The bits do not depend on how the rows are
 * divided among calls. */
typedef int weft__rows_fn(const weft__subject *of, double *dydt, size_t first,
                          size_t end);

weft__rows_fn weft__rhs_rows; /* all of it; rhs.c */

/* rhs.c: x' of the rows [first, end), whose v' is computed elsewhere. */
void weft__ghost_rows(const weft__subject *of, double *dydt, size_t first, size_t end);

/* Measures a part or all of row r into *row, which is weft__row_start before. Springs
 * belong to the row where they begin. measure.c, power.c, bending.c, contact.c */
typedef void weft__row_fn(const weft__subject *of, size_t r, weft_measures *row);
weft__row_fn weft__row_energy, weft__row_heat, weft__row_power, weft__row_worst,
    weft__row_state, /* all but powers */ weft__row_all;
weft__row_fn weft__row_bending_energy, weft__row_contact_energy, weft__row_gap;

extern const weft_measures weft__row_start;

/* Of all rows, taken in their order: *sum is weft__measures_start before the first. */
extern const weft_measures weft__measures_start;
void weft__measures_add(weft_measures *sum, const weft_measures *row);

/* The smaller gap; NaN is smaller than a number. */
void weft__keep_gap(weft_measures *kept, double gap, size_t particle, size_t shape);

/* contact.c: what the particles of row r exert on shape k: force [N], torque [N m]. */
enum { WEFT__LOAD = 6 };
void weft__row_load(const weft__subject *of, size_t r, size_t k,
                    double sum[WEFT__LOAD]);

/* cloth_hash.c: hash of springs, masses, pins, forces and shapes of the whole cloth,
 * but not of the state; `rows` has the hash of each of its rows (NULL: they are
 * computed, for a whole cloth). */
uint64_t weft__cloth_hash(const weft_cloth *cloth, const uint64_t *rows);
uint64_t weft__cloth_row_hash(const weft_cloth *cloth, size_t r);

/* Of the law of contact alone, which shapes that are added obey. */
uint64_t weft__contact_hash(const weft_cloth *cloth);

#endif
