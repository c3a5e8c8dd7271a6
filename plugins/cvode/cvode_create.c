/* SPDX-License-Identifier: BSD-3-Clause */
/* cvode_create.c -- one instance: checks its arguments, then sets what must not be
 * CVODE's default. */
#include "cvode_plugin.h"

#include <math.h>

/* To which part the residual of a linear system is reduced: fewer iterations of
 * Newton's method, which a smaller one would bring, are not worth those of the system.
 */
#define RESIDUAL 0.1

/* What Newton's method may leave, as part of the error of a step: CVODE's default. At 1
 * steps become some 16 times as many. */
#define CONVERGENCE 0.1

enum {
    BDF_TOP_ORDER = 5,
    MOST_FAILURES = 1000, /* until min_step */
};

/* The fault of the config, or NULL. */
static const char *mistake(const cvode_method *method, const weft_ode *ode,
                           const weft_stepper_config *config)
{
    const char *wrong = weft__sun_mistake(&method->type, ode, config);
    const weft_linear *linear = wrong == NULL ? weft_stepper_linear(config) : NULL;
    return wrong != NULL                ? wrong
           : linear == NULL             ? NULL
           : method->formulas != CV_BDF ? "solves no linear systems"
           : linear->max_order < 0 || linear->max_order > BDF_TOP_ORDER
               ? "max_order must be 1 to 5"
               : weft__linear_mistake(config);
}

static int max_order(const cvode_method *method, const weft_stepper_config *config)
{
    const weft_linear *linear = weft_stepper_linear(config);
    return linear != NULL && linear->max_order > 0 ? linear->max_order
                                                   : method->usual_order;
}

static cvode_stepper *allocate(const cvode_method *method, const weft_ode *ode,
                               const weft_stepper_config *c)
{
    const weft_allocator memory = weft_stepper_memory(c);
    cvode_stepper *self = memory.resize(memory.ctx, NULL, sizeof *self);
    if (self != NULL) {
        *self
            = (cvode_stepper){ .method = method,
                               .ode = *ode,
                               .memory = memory,
                               .rtol = c->rtol,
                               .atol = { c->atol_position, c->atol_velocity },
                               .min_step = c->min_step,
                               .max_step = c->max_step,
                               .max_order = max_order(method, c),
                               .h = fmin(fmax(c->first_step, c->min_step), c->max_step),
                               .restart = true };
    }
    return self;
}

/* Newton's method with the cloth's Jacobian, fresh in each step: with CVODE's defaults
 * most steps fail to converge. */
static int set_newton(cvode_stepper *self)
{
    void *s = self->solver;
    sun_equations *of = &self->equations;
    int bad = CVodeSetLinearSolver(s, of->solver, of->matrix);
    bad |= CVodeSetLSetupFrequency(s, 1);
    bad |= CVodeSetNonlinConvCoef(s, CONVERGENCE);
    if (bad == 0 && of->linear != NULL) {
        bad |= CVodeSetLinSysFn(s, weft__cvode_system);
        bad |= CVodeSetJacEvalFrequency(s, 1);
        bad |= CVodeSetLinearSolutionScaling(s,
                                             0); /* the matrix has the present gamma */
    } else if (bad == 0) {
        bad |= CVodeSetLSNormFactor(s, 1.0); /* the 2-norm is not below the largest */
    }
    return bad;
}

static int settings(cvode_stepper *self)
{
    void *s = self->solver;
    int bad = CVodeSetUserData(s, self);
    bad |= CVodeWFtolerances(s, weft__cvode_weights);
    bad |= CVodeSetMaxNumSteps(s, -1);
    bad |= CVodeSetMaxHnilWarns(s, -1);
    bad |= CVodeSetMaxErrTestFails(s, MOST_FAILURES);
    bad |= CVodeSetMaxConvFails(s, MOST_FAILURES);
    bad |= isinf(self->max_step) ? 0 : CVodeSetMaxStep(s, self->max_step);
    if (self->iteration != NULL) {
        return bad | CVodeSetNonlinearSolver(s, self->iteration);
    }
    return bad | set_newton(self);
}

/* The vectors: CVODE's history, its others, those of its iteration, ours. */
static int vectors(const cvode_method *method, size_t dim,
                   const weft_stepper_config *config)
{
    const int more
        = method->formulas == CV_BDF ? weft__sun_equations_vectors(dim, config) : 0;
    return max_order(method, config) + 12 + more;
}

/* The vectors, and what solves the equations of a step. */
static bool make_parts(cvode_stepper *self, const weft_stepper_config *config)
{
    const weft_team *pool
        = WEFT_HAS(config, weft_stepper_config, team) ? config->team : NULL;
    self->context = weft__sun_context();
    self->y = self->context == NULL
                  ? NULL
                  : weft__sun_vector(self->ode.dim, pool, self->context);
    if (self->y == NULL) {
        return false;
    }
    weft__sun_judge_by(self->y, config->norm, self->ode.dim);
    if (self->method->formulas == CV_BDF) {
        return weft__sun_equations_create(&self->equations, self->y, RESIDUAL, config,
                                          NULL)
               == WEFT_OK;
    }
    self->iteration = SUNNonlinSol_FixedPoint(self->y, 0, self->context);
    return self->iteration != NULL;
}

static bool make_solver(cvode_stepper *self)
{
    self->solver = CVodeCreate(self->method->formulas, self->context);
    if (self->solver == NULL) {
        return false;
    }
    self->equations.current_gamma = CVodeGetCurrentGamma;
    self->equations.owner = self->solver;
#if SUNV < 700
    (void)CVodeSetErrHandlerFn(self->solver, weft__sun_silent, NULL);
#endif
    return CVodeSetMaxOrd(self->solver, self->max_order) == CV_SUCCESS /* before Init */
           && CVodeInit(self->solver, weft__cvode_rhs, 0.0, self->y) == CV_SUCCESS
           && settings(self) == 0;
}

weft_status weft__cvode_create(const weft_stepper_type *type, const weft_ode *ode,
                               const weft_stepper_config *config, void **out,
                               weft_error *err)
{
    const cvode_method *method = (const cvode_method *)type;
    *out = NULL;
    const char *wrong = mistake(method, ode, config);
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    const weft_status status = weft__sun_memory(type->name, ode->dim,
                                                vectors(method, ode->dim, config), err);
    if (status != WEFT_OK) {
        return status;
    }
    cvode_stepper *self = allocate(method, ode, config);
    if (self == NULL || !make_parts(self, config) || !make_solver(self)) {
        weft__cvode_destroy(self);
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory for CVODE",
                              type->name);
    }
    *out = self;
    return WEFT_OK;
}

void weft__cvode_destroy(void *instance)
{
    cvode_stepper *self = instance;
    if (self == NULL) {
        return;
    }
    if (self->solver != NULL) {
        CVodeFree(&self->solver);
    }
    if (self->iteration != NULL) {
        (void)SUNNonlinSolFree(self->iteration);
    }
    weft__sun_equations_destroy(&self->equations);
    if (self->y != NULL) {
        N_VDestroy(self->y);
    }
    if (self->context != NULL) {
        (void)SUNContext_Free(&self->context);
    }
    (void)self->memory.resize(self->memory.ctx, self, 0);
}

void weft__cvode_options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const cvode_stepper *self = instance;
    const bool bdf = self->method->formulas == CV_BDF;
    weft__tell_number(tell, ctx, "max_order", self->max_order);
    tell(ctx, "nonlinear_solver", bdf ? "newton" : "fixed_point");
    if (bdf) {
        weft__tell_number(tell, ctx, "convergence", CONVERGENCE);
        weft__sun_tell_equations(&self->equations, tell, ctx);
    }
}
