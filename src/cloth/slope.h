/* SPDX-License-Identifier: BSD-3-Clause */
/* slope.h -- the derivative of the right-hand side by a number of the definition, from
 * two cloths that have less and more of it: of the forces whose numbers differ, of the
 * masses and of the motions of pins.
 *
 * Weight, air and the springs of equal rest lengths are linear in their numbers: one
 * evaluation with the differences of these is the derivative. All others are a central
 * difference. */
#pragma once

#include "cloth/model.h"

typedef struct weft__slope {
    const weft_cloth *less, *more;
    double span;                /* of the number between the two, in its unit of s */
    bool differs[WEFT__FORCES]; /* the forces that change */
    bool all, pins, linear;     /* masses; motions; springs are */
    weft__springs springs;      /* if linear: with the differences by span */
    weft__body body;            /* likewise */
} weft__slope;

/* Errors: WEFT_INVALID if the two differ from `cloth` in more than numbers. */
weft_status weft__slope_init(weft__slope *of, const weft_cloth *cloth,
                             const weft_cloth *less, const weft_cloth *more,
                             double span, weft_error *err);

/* Whether forces of the whole cloth change. */
bool weft__slope_whole(const weft__slope *of);

/* Adds the derivative of dy/dt in blocks [first, end), but what add_all adds, times
 * `scale` to out[6 N], where that of the state is already; of pinned particles, whose
 * motion does not depend on it, writes it. room: 6 N, twice. Returns as
 * weft__rhs_blocks. */
int weft__slope_blocks(const weft__slope *of, const weft__state *at, double scale,
                       double *out, double *const room[2], size_t first, size_t end);

/* Of the forces of the whole cloth. */
int weft__slope_all(const weft__slope *of, const weft__state *at, double scale,
                    double *out, double *const room[2]);
