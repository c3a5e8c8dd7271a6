/* SPDX-License-Identifier: BSD-3-Clause */
/* multigrid.h -- a cycle of smoothed aggregation, as a preconditioner (P. Vanek,
 * J. Mandel, M. Brezina, Computing 56, 1996).
 *
 * A piece of cloth, however it is folded, moves and turns as a rigid body nearly for
 * nothing: its six motions about the present positions are what the coarse levels must
 * have. Each aggregate of particles has six unknowns there. Aggregates and all patterns
 * follow from the graph of the network; the numbers are made anew with each matrix, as
 * coarse levels of another state are worse than none. */
#ifndef WEFT_PLUGINS_LINEAR_MULTIGRID_H
#define WEFT_PLUGINS_LINEAR_MULTIGRID_H

#include "network.h"

typedef struct weft__multigrid weft__multigrid;

/* For a network whose blocks come later; it must outlive this. Particles are aggregated
 * along the first `strong` of its edges (weft__network_edges). Takes its memory from
 * the pile; NULL: no memory. */
weft__multigrid *weft__multigrid_create(weft__network *finest, size_t strong,
                                        weft__pile *pile);

/* Computes all levels from the finest, inverted, at positions x (3 planes); mass 0:
 * held. */
void weft__multigrid_prepare(weft__multigrid *self, const double *mass,
                             const double *x);

/* About S z = r, symmetric and positive definite; r is 0 at held particles, and z. */
void weft__multigrid_apply(weft__multigrid *self, const double *r, double *z);

#endif
