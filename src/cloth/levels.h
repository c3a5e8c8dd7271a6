/* SPDX-License-Identifier: BSD-3-Clause */
/* levels.h -- the functions that evaluate the forces of a cloth: the kernels of
 * src/kernel, compiled for each level of instructions, or the plain loops without them.
 */
#ifndef WEFT_CLOTH_LEVELS_H
#define WEFT_CLOTH_LEVELS_H

#include "cloth/added.h"
#include "cloth/model.h"
#include "cloth/passage.h"
#include "cloth/self.h"

/* Power [W] turned into heat by the dampers of the springs that begin in row r. */
typedef double weft__damping_fn(const weft_cloth *cloth, const double *y, size_t r);

/* Whether a path of the rows [first, end) is clear of all shapes. */
typedef bool weft__clear_fn(const weft_cloth *cloth, const weft__path *path,
                            size_t first_row, size_t end_row);

struct weft__level {
    const char *name;
    weft__rows_fn *rows; /* x' and v' by springs, gravity and drag, without pins */
    weft__damping_fn *damping;
    weft__rows_fn
        *products; /* the derivative of `rows` along a direction, without pins */
    weft__rows_fn *added[WEFT__ADDED]; /* add to v'; NULL: `rows` includes them */
    weft__clear_fn *clear;
    weft__pushes_fn *pushes;
    weft__waits_fn *waits;
    weft__extent_fn *extent;
    weft__drift_fn *drift;
};

/* The plain loops: rhs.c, power.c, passage.c. */
weft__rows_fn weft__reference_rows; /* with of->along: products */
weft__damping_fn weft__reference_damping;
weft__clear_fn weft__reference_clear;

/* The names of the kernels end with their level; `plain` uses the instructions that the
 * compiler uses by default. */
#if defined __x86_64__ && defined __GNUC__
#define WEFT_LEVELS(X) X(plain) X(v3) X(v4)
#else
#define WEFT_LEVELS(X) X(plain)
#endif

#define WEFT_ADDED_KERNEL(name, level) weft__rows_fn weft__##name##_##level;
#define WEFT_LEVEL_KERNELS(level)                                                      \
    weft__rows_fn weft__rows_##level;                                                  \
    weft__damping_fn weft__damping_##level;                                            \
    weft__clear_fn weft__clear_##level;                                                \
    weft__pushes_fn weft__pushes_##level;                                              \
    weft__waits_fn weft__waits_##level;                                                \
    weft__extent_fn weft__extent_##level;                                              \
    weft__drift_fn weft__drift_##level;                                                \
    weft__rows_fn weft__products_##level;                                              \
    WEFT_ADDED(WEFT_ADDED_KERNEL, level)
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
