/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_equations.h -- the linear systems (I - gamma J) x = b of a method that
 * solves its equations by Newton's method, for SUNDIALS as an object of its own.
 *
 * Where the structure of the cloth is known, J is the cloth's, computed when SUNDIALS
 * asks for it, and the system is reduced and solved by conjugate gradients
 * (../linear/linear.h). SUNDIALS takes the object for a direct solver: of an iterative
 * one it would set the tolerance, in a norm that is not that of the steps. Otherwise
 * SUNDIALS' GMRES takes J x from differences of the right-hand side. */
#pragma once

#include "../linear/linear.h"
#include "sundials_shared.h"

typedef struct sun_equations {
    weft__linear *linear; /* NULL: the structure is not known */
    weft_linear settings; /* complete; a Jacobian of each step is the prediction's */
    double t;             /* of the last RHS call, and its state */
    N_Vector y;
    double gamma; /* [s] of the matrix */
    SUNLinearSolver solver;
    SUNMatrix matrix; /* stands for the one in `linear`; NULL: none */
    /* SUNDIALS' own gamma [s], which may be another by the time of a solve */
    int (*current_gamma)(void *owner, sunrealtype *gamma);
    void *owner;
} sun_equations;

/* The vectors that the equations of dim numbers take. */
int weft__sun_equations_vectors(size_t dim, const weft_stepper_config *config);

/* `tolerance`: to which part the residual is
 * reduced, unless config->linear says. Fills *self but for current_gamma and owner.
 * After a failure, as in the end, destroy.
 */
weft_status weft__sun_equations_create(sun_equations *self, N_Vector like,
                                       double tolerance,
                                       const weft_stepper_config *config,
                                       weft_error *err);
void weft__sun_equations_destroy(sun_equations *self);

/* For SUNDIALS' function of the linear system: as keep allows it, J stays as it is.
 * Returns 0, or > 0 if a smaller step may help. */
int weft__sun_linearise(sun_equations *self, double t, N_Vector y, int keep, int *fresh,
                        double gamma);

/* To be called at each RHS call. */
static inline void weft__sun_iterate(sun_equations *self, double t, N_Vector y)
{
    self->t = t;
    self->y = y;
}

/* Adds the counts of the linear systems. */
void weft__sun_count_equations(const sun_equations *self, weft_stepper_stats *stats);

void weft__sun_tell_equations(const sun_equations *self, weft_option_fn *tell,
                              void *ctx);
