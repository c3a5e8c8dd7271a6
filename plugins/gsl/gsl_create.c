/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_create.c -- one instance: checks its arguments, computes its memory, creates it.
 *
 * GSL calls the aborting error handler when its own malloc fails, and bsimp does not
 * even check the result of malloc. So the plugin first computes the amount that GSL
 * will allocate, refuses it above a limit, and allocates it once itself: if that
 * succeeds, the same amount in pieces will too. (gsl_linalg_LU_decomp allocates 4 bytes
 * a row in every call; that is beyond our reach.) */
#include "gsl_plugin.h"

#include <math.h>
#include <stdlib.h>

/* [bytes] Matrices grow with the square of the state: a large cloth needs
 * another method. Vectors are limited by the machine alone. */
#define MATRICES_LIMIT 0x1p31 /* 2 GiB */
#define VECTORS_LIMIT  0x1p38 /* 256 GiB */
#define SMALL_BLOCKS   0x1p15 /* whatever the state, all that is not a vector */
#define NO_MATRICES    "; methods without matrices: rk2, rk4, rkf45, rkck, rk8pd, msadams"

/* [bytes] In floating point, which does not overflow. */
static double memory_needed(const gsl_method *method, size_t dim)
{
    const double n = (double)dim;
    return SMALL_BLOCKS
           + sizeof(double) * n * (method->vectors + method->type.matrices * n);
}

/* A granted malloc must not be optimised away. */
static bool memory_is_there(size_t bytes)
{
    void *volatile probe = malloc(bytes);
    const bool there = probe != NULL;
    free(probe);
    return there;
}

/* The smallest tolerance of numbers that shift.c puts beside 1. */
#define LEAST_OFF 1e-14

static weft_status check_memory(const gsl_method *method, size_t dim, weft_error *err)
{
    const double bytes = memory_needed(method, dim), gib = 0x1p30;
    const double limit = method->type.matrices > 0 ? MATRICES_LIMIT : VECTORS_LIMIT;
    if (bytes > limit) {
        return weft_error_set(err, WEFT_NO_MEMORY,
                              "%s: %zu numbers need %.3g GiB, more than %g GiB%s",
                              method->type.name, dim, bytes / gib, limit / gib,
                              method->type.matrices > 0 ? NO_MATRICES : "");
    }
    if (!memory_is_there((size_t)bytes)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory: %.3g GiB needed",
                              method->type.name, bytes / gib);
    }
    return WEFT_OK;
}

/* Our own block: the instance, then start, yerr, the three vectors of the Jacobian and
 * the two of the shift. */
static gsl_stepper *allocate(const gsl_method *method, const weft_ode *ode)
{
    const size_t dim = ode->dim;
    const size_t vectors = method->shift ? 7 : method->type.matrices > 0 ? 5 : 2;
    gsl_stepper *self = calloc(1, sizeof *self + vectors * dim * sizeof(double));
    if (self == NULL) {
        return NULL;
    }
    self->method = method;
    self->ode = *ode;
    self->start = (double *)(self + 1);
    self->yerr = self->start + dim;
    if (method->type.matrices > 0) {
        self->f = self->yerr + dim;
        self->y_moved = self->f + dim;
        self->f_moved = self->y_moved + dim;
    }
    if (method->shift) {
        self->offset = self->f_moved + dim;
        self->plain = self->offset + dim;
    }
    return self;
}

/* GSL's side. False if its memory fails and the program's handler returned. */
static bool make_solver(gsl_stepper *self, const weft_stepper_config *config)
{
    const gsl_method *method = self->method;
    const size_t dim = self->ode.dim;
    if (config->fixed_step > 0.0) {
        weft__gsl_control_init(self, WEFT_NORM_MAX, method->solver_tol,
                               method->solver_tol, method->solver_tol);
    } else {
        weft__gsl_control_init(self, config->norm, config->rtol, config->atol_position,
                               config->atol_velocity);
    }
    if (method->v1 != NULL) {
        self->system1
            = (gsl_odeiv_system){ weft__gsl_rhs, weft__gsl_jacobian, dim, self };
        self->v1 = gsl_odeiv_step_alloc(*method->v1, dim);
        return self->v1 != NULL;
    }
    self->system2
        = method->shift
              ? (gsl_odeiv2_system){ weft__gsl_shifted_rhs, weft__gsl_shifted_jacobian,
                                     dim, self }
              : (gsl_odeiv2_system){ weft__gsl_rhs, weft__gsl_jacobian, dim, self };
    self->v2 = gsl_odeiv2_step_alloc(*method->v2, dim);
    if (self->v2 == NULL) {
        return false;
    }
    /* Steppers that solve equations ask driver.c how well; nothing else of it. */
    self->driver = (gsl_odeiv2_driver){
        .sys = &self->system2, .s = self->v2, .c = &self->control, .h = self->h
    };
    gsl_odeiv2_step_set_driver(self->v2, &self->driver);
    return true;
}

weft_status weft__gsl_create(const weft_stepper_type *type, const weft_ode *ode,
                             const weft_stepper_config *config, void **out,
                             weft_error *err)
{
    const gsl_method *method = (const gsl_method *)type;
    *out = NULL;
    const char *wrong = weft_stepper_mistake(type, ode, config);
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    if (method->shift && !(config->fixed_step > 0.0)
        && fmin(config->atol_position, config->atol_velocity) < LEAST_OFF) {
        return weft_error_set(
            err, WEFT_INVALID,
            "%s: adds 1 to every number, so that atol must be at least "
            "%g m and m/s: rounding loses what is smaller",
            type->name, LEAST_OFF);
    }
    const weft_status status = check_memory(method, ode->dim, err);
    if (status != WEFT_OK) {
        return status;
    }
    gsl_stepper *self = allocate(method, ode);
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    self->half = weft_stepper_half(ode, config);
    self->fixed_step = config->fixed_step;
    self->min_step = config->min_step;
    self->max_step = config->max_step;
    self->h = config->fixed_step > 0.0
                  ? config->fixed_step
                  : fmin(fmax(config->first_step, config->min_step), config->max_step);
    if ((type->flags & WEFT_STEPPER_IMPLICIT) == 0 && type->stages > 0) {
        const int touched = self->method->vectors - 2; /* measured: tests/test_wave.c */
        self->stats.bytes = (uint64_t)touched * ode->dim * sizeof(double);
    }
    if (!make_solver(self, config)) {
        weft__gsl_destroy(self);
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory for GSL", type->name);
    }
    *out = self;
    return WEFT_OK;
}

void weft__gsl_destroy(void *instance)
{
    gsl_stepper *self = instance;
    if (self == NULL) {
        return;
    }
    if (self->v1 != NULL) {
        gsl_odeiv_step_free(self->v1);
    }
    gsl_odeiv2_step_free(self->v2); /* NULL is allowed */
    free(self);
}
