/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel.h -- the fast path of the equations of motion: kernel*.c, compiled for each
 * level of instructions, and levels.c, which chooses one. They do what weft_cloth_force
 * says in plain loops, to the roundoff, with the same bits on every level. */
#ifndef WEFT_KERNEL_KERNEL_H
#define WEFT_KERNEL_KERNEL_H

#include "cloth/model.h"

/* Of the rows [first_row, end_row): x' and v' into dydt as if nothing were pinned and
 * no wind blew; 0, or 1 if something is not finite. However the rows are divided into
 * calls, the result is the same. */
typedef int weft__springs_fn(const weft_cloth *cloth, const double *y, double *dydt,
                             size_t first_row, size_t end_row);

/* Adds what the wind does to v'; otherwise as above. */
typedef int weft__wind_fn(const weft_cloth *cloth, const double *y, double *dydt,
                          size_t first_row, size_t end_row);

/* Power [W] that the dampers of the springs which begin in row r take. */
typedef double weft__damping_fn(const weft_cloth *cloth, const double *y, size_t r);

struct weft__level {
    const char *name;
    weft__springs_fn *springs;
    weft__wind_fn *wind;
    weft__damping_fn *damping;
};

/* Ends of names for each level; without instructions of its own, `plain` is what the
 * compiler takes for granted. */
#if defined __x86_64__ && defined __GNUC__
#define WEFT_LEVELS(X) X(plain) X(v3) X(v4)
#else
#define WEFT_LEVELS(X) X(plain)
#endif

#define WEFT_LEVEL_KERNELS(level)                                                      \
    weft__springs_fn weft__springs_##level;                                            \
    weft__wind_fn weft__wind_##level;                                                  \
    weft__damping_fn weft__damping_##level;
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
