/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_plugin.h -- shared by the files of this plugin. Reading order: plugin.c (the
 * methods), create.c (one instance), step.c (one accepted step), rhs.c (as GSL calls
 * it), control.c (when a step is accurate enough), jacobian.c (for the implicit
 * methods), shift.c (for bsimp).
 *
 * GSL steps, estimates the error and chooses h. This plugin runs GSL's steppers and
 * controls in a loop of its own instead of gsl_odeiv2_evolve_apply, as that one accepts
 * NaN, knows no smallest step and keeps a stale derivative when y was edited.
 *
 * GSL reports a wrong argument or a failing malloc to a handler that is global to the
 * process and aborts. It is the program's and is never touched here; so every argument
 * is checked before GSL sees it. */
#pragma once

#include "weft/elementary.h"
#include "weft/stepper.h"

#include <gsl/gsl_odeiv.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>

/* Before 2.5 msadams and msbdf may abort the process (GSL bugs 52230 and 52336). */
#if GSL_MAJOR_VERSION < 2 || (GSL_MAJOR_VERSION == 2 && GSL_MINOR_VERSION < 5)
#error "this plugin needs GSL 2.5 or later"
#endif

/* A method: the public record first, so that a pointer to the one is a pointer to the
 * other, and GSL's stepper: of odeiv2, or of the older odeiv. */
typedef struct gsl_method {
    weft_stepper_type type;
    const gsl_odeiv2_step_type **v2;
    const gsl_odeiv_step_type **v1;
    int vectors;       /* of length dim that an instance keeps, at most */
    bool forget;       /* the history of this stepper is wrong: drop it */
    bool shift;        /* it measures against |y_i|: keep y_i away from 0 */
    double solver_tol; /* with a fixed step: to which it solves its equations */
} gsl_method;

/* Why an attempt is no step. */
typedef enum trouble {
    NO_TROUBLE,
    INACCURATE, /* the control rejects it */
    UNSOLVED,   /* the implicit equations did not converge */
    NOT_FINITE, /* state or derivative is not finite, or the RHS refused the state */
    STOPPED     /* the RHS asked to end the run */
} trouble;

/* One instance. Our arrays lie behind it in one block; a step allocates none. */
typedef struct gsl_stepper {
    const gsl_method *method;
    weft_ode ode;
    size_t half; /* of the positions; the velocities; then quadratures */
    double fixed_step, min_step, max_step; /* [s] */
    double h;                              /* [s] what to try next */
    bool restart;                          /* forget the past steps before the next */
    weft_stepper_stats stats;

    gsl_odeiv2_step *v2; /* either this */
    gsl_odeiv_step *v1;  /* or that */
    gsl_odeiv2_system system2;
    gsl_odeiv_system system1;
    weft_norm norm;
    double rtol, atol[2];       /* of positions [m], of velocities [m/s] */
    gsl_odeiv2_control control; /* that equations are solved by */
    gsl_odeiv2_driver driver;   /* through which a stepper reads `control` */

    /* the attempt under way */
    trouble trouble;               /* seen by our RHS */
    double t_end, h_try;           /* [s] */
    double *start, *yerr;          /* y before it */
    double *f, *y_moved, *f_moved; /* of the Jacobian; NULL without matrices */
    double *offset, *plain;        /* GSL's y is plain + offset; NULL without shift */
} gsl_stepper;

/* create.c */
weft_status weft__gsl_create(const weft_stepper_type *type, const weft_ode *ode,
                             const weft_stepper_config *config, void **out,
                             weft_error *err);
void weft__gsl_destroy(void *instance);

/* shift.c: GSL's side of a state that is kept away from 0. */
void weft__gsl_shift(gsl_stepper *self, double *y);
void weft__gsl_unshift(gsl_stepper *self, double *y);
int weft__gsl_shifted_rhs(double t, const double y[], double dydt[], void *instance);
int weft__gsl_shifted_jacobian(double t, const double y[], double *dfdy, double dfdt[],
                               void *instance);

/* rhs.c */
int weft__gsl_rhs(double t, const double y[], double dydt[], void *instance);
bool weft__gsl_finite(const double *y, size_t count);

/* step.c */
weft_status weft__gsl_step(void *instance, double t_end, double *t, double *y,
                           weft_error *err);
void weft__gsl_state_changed(void *instance);
void weft__gsl_stats(const void *instance, weft_stepper_stats *out);

/* control.c */
void weft__gsl_control_init(gsl_stepper *self, weft_norm norm, double rtol,
                            double atol_position, double atol_velocity);
/* r of an attempt that ended in y with self->yerr; false if one is not finite. */
bool weft__gsl_ratio(const gsl_stepper *self, const double *y, double *r);
double weft__gsl_tolerance(const gsl_stepper *self, size_t i, double y); /* D_i */
/* Whether an attempt of order `order` with the norm r is rejected. *h [s] goes in as
 * the attempt's and comes out as the proposal. */
bool weft__gsl_rejects(unsigned int order, double r, double *h);
void weft__gsl_options(const void *instance, weft_option_fn *tell, void *ctx);

/* jacobian.c */
int weft__gsl_jacobian(double t, const double y[], double *dfdy, double dfdt[],
                       void *instance);
