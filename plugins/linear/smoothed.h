/* SPDX-License-Identifier: BSD-3-Clause */
/* smoothed.h -- a cycle of smoothed aggregation, as a preconditioner (P. Vanek,
 * J. Mandel, M. Brezina, Computing 56, 1996).
 *
 * A piece of cloth, however it is folded, moves and turns as a rigid body nearly for
 * nothing: its six motions about the present positions are what the coarse levels must
 * have. Each aggregate of particles has six unknowns there. Aggregates and all patterns
 * follow from the graph of the network; the numbers are made anew with each matrix, as
 * coarse levels of another state are worse than none. */
#pragma once

#include "network.h"

typedef struct weft__smoothed weft__smoothed;

/* For a network whose blocks come later; it must outlive this. Particles are aggregated
 * along the first `strong` of its edges (weft__network_edges). Takes its memory from
 * the pile; NULL: no memory. */
weft__smoothed *weft__smoothed_create(weft__network *finest, size_t strong,
                                      weft__pile *pile);

/* Computes all levels from the finest, inverted, at positions x (3 planes); mass 0:
 * held. */
void weft__smoothed_prepare(weft__smoothed *self, const double *mass, const double *x);

/* About S z = r, symmetric and positive definite; r is 0 at held particles, and z. */
void weft__smoothed_apply(weft__smoothed *self, const double *r, double *z);
