/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_equations.c -- the linear systems of Newton's method. */
#include "sundials_equations.h"

#include <math.h>

enum { KRYLOV_MOST = 30 }; /* vectors of GMRES */

static int krylov_vectors(size_t dim)
{
    return dim < KRYLOV_MOST ? (int)dim : KRYLOV_MOST;
}

int weft__sun_equations_vectors(size_t dim, const weft_stepper_config *config)
{
    return weft_stepper_structure(config) != NULL ? 2 : krylov_vectors(dim) + 5;
}

/* ---- the matrix: there is nothing in it ------------------------------------------ */

static SUNMatrix make_matrix(SUNContext context);

static SUNMatrix_ID matrix_id(SUNMatrix matrix)
{
    (void)matrix;
    return SUNMATRIX_CUSTOM;
}

static SUNMatrix matrix_clone(SUNMatrix matrix)
{
    return make_matrix(matrix->sunctx);
}

static void matrix_destroy(SUNMatrix matrix)
{
    SUNMatFreeEmpty(matrix);
}

static int matrix_zero(SUNMatrix matrix)
{
    (void)matrix;
    return 0;
}

static SUNMatrix make_matrix(SUNContext context)
{
    SUNMatrix made = SUNMatNewEmpty(context);
    if (made != NULL) {
        made->ops->getid = matrix_id;
        made->ops->clone = matrix_clone;
        made->ops->destroy = matrix_destroy;
        made->ops->zero = matrix_zero;
    }
    return made;
}

/* ---- the solver ------------------------------------------------------------------ */

static SUNLinearSolver_Type solver_type(SUNLinearSolver solver)
{
    (void)solver;
    return SUNLINEARSOLVER_DIRECT;
}

static SUNLinearSolver_ID solver_id(SUNLinearSolver solver)
{
    (void)solver;
    return SUNLINEARSOLVER_CUSTOM;
}

/* All is done in weft__sun_linearise. */
static int solver_setup(SUNLinearSolver solver, SUNMatrix matrix)
{
    (void)solver;
    (void)matrix;
    return 0;
}

/* The scale of all is b's: a residual that is not finite has no solution. */
static int solver_solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x,
                        N_Vector b, sunrealtype tolerance)
{
    sun_equations *self = solver->content;
    sunrealtype gamma = self->gamma;
    (void)matrix;
    (void)tolerance;
    if (!weft__sun_finite(b) || self->current_gamma(self->owner, &gamma) != 0) {
        return SUNLS_CONV_FAIL;
    }
    int fresh = 0;
    const bool anew = self->settings.jacobian == WEFT_JACOBIAN_NEWTON;
    if ((gamma != self->gamma || anew)
        && weft__sun_linearise(self, self->t, self->y, !anew, &fresh, gamma) != 0) {
        return SUNLS_CONV_FAIL;
    }
    double *r = weft__sun_fill(x);
    weft__sun_read(b, r);
    return weft__linear_solve(self->linear, self->settings.krylov, r) ? 0
                                                                      : SUNLS_CONV_FAIL;
}

static int solver_free(SUNLinearSolver solver)
{
    SUNLinSolFreeEmpty(solver);
    return 0;
}

static SUNLinearSolver make_solver(sun_equations *self, SUNContext context)
{
    SUNLinearSolver made = SUNLinSolNewEmpty(context);
    if (made != NULL) {
        made->ops->gettype = solver_type;
        made->ops->getid = solver_id;
        made->ops->setup = solver_setup;
        made->ops->solve = solver_solve;
        made->ops->free = solver_free;
        made->content = self;
    }
    return made;
}

weft_status weft__sun_equations_create(sun_equations *self, N_Vector like,
                                       double tolerance,
                                       const weft_stepper_config *config,
                                       weft_error *err)
{
    const weft_structure *structure = weft_stepper_structure(config);
    const weft_allocator memory = weft_stepper_memory(config);
    weft_status status = WEFT_OK;
    self->settings = weft__linear_settings(config, tolerance);
    if (structure == NULL) {
        const int most = krylov_vectors((size_t)NV_LENGTH_S(like));
        self->solver = SUNLinSol_SPGMR(like, SUN_PREC_NONE, most, like->sunctx);
    } else {
        status = weft__linear_create(structure, self->settings.preconditioner, &memory,
                                     &self->linear, err);
        self->matrix = make_matrix(like->sunctx);
        self->solver = make_solver(self, like->sunctx);
    }
    return status != WEFT_OK ? status
           : self->solver == NULL || (structure != NULL && self->matrix == NULL)
               ? weft_error_set(err, WEFT_NO_MEMORY, "no memory for linear systems")
               : WEFT_OK;
}

void weft__sun_equations_destroy(sun_equations *self)
{
    if (self->solver != NULL) {
        (void)SUNLinSolFree(self->solver);
    }
    if (self->matrix != NULL) {
        SUNMatDestroy(self->matrix);
    }
    weft__linear_destroy(self->linear);
}

int weft__sun_linearise(sun_equations *self, double t, N_Vector y, int keep, int *fresh,
                        double gamma)
{
    const int failed = keep ? 0 : weft__linear_at(self->linear, t, NV_DATA_S(y));
    *fresh = !keep;
    if (failed == 0) {
        self->gamma = gamma;
        weft__linear_prepare(self->linear, gamma);
    }
    return failed;
}

void weft__sun_count_equations(const sun_equations *self, weft_stepper_stats *stats)
{
    if (self->linear != NULL) {
        const weft__linear_counts counts = weft__linear_count(self->linear);
        stats->linear_iterations = counts.iterations;
        stats->factorisations = counts.refreshes;
    }
}

void weft__sun_tell_equations(const sun_equations *self, weft_option_fn *tell,
                              void *ctx)
{
    if (self->linear == NULL) {
        tell(ctx, "linear_solver", "gmres");
        weft__tell_number(tell, ctx, "krylov_vectors", KRYLOV_MOST);
    } else {
        tell(ctx, "linear_solver", "conjugate_gradients");
        weft__linear_tell(&self->settings, tell, ctx);
    }
}
