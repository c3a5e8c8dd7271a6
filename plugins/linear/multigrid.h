/* SPDX-License-Identifier: BSD-3-Clause */
/* multigrid.h -- one V-cycle of multigrid by aggregation, as a preconditioner.
 *
 * The unknowns of an aggregate are equal on the next level, so that the Galerkin
 * product of a network is a network again: of all springs that join two aggregates one
 * remains, with the sum of their blocks. */
#pragma once

#include "network.h"

typedef struct weft__multigrid weft__multigrid;

/* For a network whose blocks come later; it must outlive this. Takes its memory from
 * the pile; NULL: no memory. */
weft__multigrid *weft__multigrid_create(weft__network *finest, weft__pile *pile);

/* Computes all levels from the finest, inverted; mass 0: held. */
void weft__multigrid_prepare(weft__multigrid *self, const double *mass);

/* About S z = r, symmetric and positive definite; r is 0 at held particles, and z. */
void weft__multigrid_apply(weft__multigrid *self, const double *r, double *z);
