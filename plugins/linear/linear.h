/* SPDX-License-Identifier: BSD-3-Clause */
/* linear.h -- the linear systems of implicit methods, for the plugins that have some.
 * Reading order: linear.c (conjugate gradients), network.c (the matrix), filter.c (what
 * is left out of it), vectors.h; multigrid.c over aggregate.c for springs, smoothed.c
 * over rows.c and dense.h for triangles; linear_settings.c.
 *
 * Solves (I - gamma J) (dx, dv) = (rx, rv), where J is the Jacobian of a cloth without
 * what may make it indefinite (the terms z, negative q and negative curvature of
 * contact: weft/stepper.h, weft_structure). Bending is in it as it is. As x' = v, the
 * system reduces to
 *
 *     (M + gamma C + gamma^2 K) dv = M rv - gamma K rx,    dx = rx + gamma dv,
 *
 * with dv = rv, dx = rx of prescribed particles, which pull at the others by -gamma C
 * rv alone (D. Baraff, A. Witkin, SIGGRAPH 1998). It is symmetric and positive
 * definite: conjugate gradients, preconditioned by the 3 x 3 blocks of the diagonal, or
 * by multigrid (multigrid.h; smoothed.h of triangles) where these would need many
 * iterations.
 *
 * Order of sums and operations do not depend on the machine: the same bits everywhere.
 */
#pragma once

#include "weft/stepper.h"

typedef struct weft__linear weft__linear;

typedef struct weft__linear_counts {
    uint64_t iterations, refreshes, failures;
} weft__linear_counts;

/* Takes all memory that it ever needs. The structure must outlive it. */
weft_status weft__linear_create(const weft_structure *structure,
                                weft_preconditioner preconditioner,
                                const weft_allocator *memory, weft__linear **out,
                                weft_error *err);
void weft__linear_destroy(weft__linear *self); /* NULL is allowed */

/* Computes J in (t, y); returns as structure->linearise. weft__linear_prepare follows.
 */
int weft__linear_at(weft__linear *self, double t, const double *y);

/* Makes the matrix and the preconditioner for gamma [s] from the last J. */
void weft__linear_prepare(weft__linear *self, double gamma);

/* Replaces r = (rx, rv), 6 N numbers, by (dx, dv), with the norm of the residual, in
 * the sense of the preconditioner, reduced to `tolerance` of its first value. False if
 * it could not be: then r has no meaning. */
bool weft__linear_solve(weft__linear *self, double tolerance, double *r);

weft__linear_counts weft__linear_count(const weft__linear *self);

/* linear_settings.c: the fault of config->linear, or NULL; max_order is left to the
 * method. */
const char *weft__linear_mistake(const weft_stepper_config *config);

/* The default of `krylov` where no test of the method sees what a linear solution
 * leaves: a stage that is accepted after one iteration keeps that part of its
 * predictor's error, which enters the solution and the error estimate. 1e-3, 1e-4 where
 * the smallest tolerance is below 1e-5: docs/reference/integrators.md. */
double weft__linear_residual(const weft_stepper_config *config);

/* config->linear with defaults for what is not set, of which `krylov` is one; max_order
 * stays as it is. */
weft_linear weft__linear_settings(const weft_stepper_config *config, double krylov);

/* Reports all of them but max_order. */
void weft__linear_tell(const weft_linear *settings, weft_option_fn *tell, void *ctx);

/* An option, with the fewest digits that are read back as the same number. */
void weft__tell_number(weft_option_fn *tell, void *ctx, const char *name, double value);
