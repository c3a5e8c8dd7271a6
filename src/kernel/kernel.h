/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel.h -- the fast path of the equations of motion, and of the heat that dampers
 * and drag make: kernel.c and kernel_wind.c, compiled for each level of instructions,
 * and levels.c, which chooses one. They do what weft_cloth_force says in plain loops,
 * to the roundoff, with the same bits on every level. */
#ifndef WEFT_KERNEL_KERNEL_H
#define WEFT_KERNEL_KERNEL_H

#include "cloth/model.h"
#include "cloth/rows.h"

/* Of the rows [first_row, end_row): x' and v' into dydt as if nothing were pinned and
 * no wind blew; 0, or 1 if something is not finite. Where heat is not NULL, also what
 * weft__heat_fn tells, at heat + WEFT_SUMS r. However the rows are divided into calls,
 * the result is the same. */
typedef int weft__springs_fn(const weft_cloth *cloth, const double *y, double *dydt,
                             double *heat, size_t first_row, size_t end_row);

/* Adds what the wind does to v'; otherwise as above. */
typedef int weft__wind_fn(const weft_cloth *cloth, const double *y, double *dydt,
                          size_t first_row, size_t end_row);

/* [W], the heat that dampers of springs which begin in row r make, and a drag [kg/s] on
 * its free particles: what add up to it are sums of every WEFT_SUMS-th column. */
typedef void weft__heat_fn(const weft_cloth *cloth, const double *y, double drag,
                           size_t r, double sums[WEFT_SUMS]);

struct weft__level {
    const char *name;
    weft__springs_fn *springs;
    weft__wind_fn *wind;
    weft__heat_fn *heat;
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
    weft__heat_fn weft__heat_##level;
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
