/* SPDX-License-Identifier: BSD-3-Clause */
/* levels.h -- what evaluates the forces of a cloth: the kernels of src/kernel, compiled
 * for each level of instructions, or, in a weft without them, the plain loops. */
#ifndef WEFT_CLOTH_LEVELS_H
#define WEFT_CLOTH_LEVELS_H

#include "cloth/model.h"

/* Of the rows [first_row, end_row): x' and v' into dydt as if nothing were pinned; 0,
 * or 1 if something is not finite. However the rows are divided into calls, the result
 * is the same. */
typedef int weft__rows_fn(const weft_cloth *cloth, const double *y, double *dydt,
                          size_t first_row, size_t end_row);

/* Power [W] that the dampers of the springs which begin in row r take. */
typedef double weft__damping_fn(const weft_cloth *cloth, const double *y, size_t r);

/* Adds contact with the shapes to v' of the free particles of rows; 0, or 1 if a gap is
 * not > 0 or something is not finite. */
typedef int weft__contact_fn(const weft_cloth *cloth, double t, const double *y,
                             double *dydt, size_t first_row, size_t end_row);

struct weft__level {
    const char *name;
    weft__rows_fn *rows;
    weft__damping_fn *damping;
    weft__contact_fn *contact;
};

/* The plain loops: rhs.c, power.c, contact.c. */
weft__rows_fn weft__reference_rows;
weft__damping_fn weft__reference_damping;
weft__contact_fn weft__reference_contact;

/* The kernels, by the ends of their names for each level; without instructions of its
 * own, `plain` is what the compiler takes for granted. */
#if defined __x86_64__ && defined __GNUC__
#define WEFT_LEVELS(X) X(plain) X(v3) X(v4)
#else
#define WEFT_LEVELS(X) X(plain)
#endif

#define WEFT_LEVEL_KERNELS(level)                                                      \
    weft__rows_fn weft__rows_##level, weft__wind_##level;                              \
    weft__damping_fn weft__damping_##level;                                            \
    weft__contact_fn weft__contact_##level;
WEFT_LEVELS(WEFT_LEVEL_KERNELS)
#undef WEFT_LEVEL_KERNELS

/* The levels of this machine, the fastest last. */
size_t weft__level_count(void);
const weft__level *weft__level_at(size_t i);

/* The one of that name, which this machine must have; NULL or "": the fastest. */
weft_status weft__level_find(const char *name, const weft__level **out,
                             weft_error *err);

/* For tests and measurements. */
void weft__cloth_set_level(weft_cloth *cloth, const weft__level *level);

#endif
