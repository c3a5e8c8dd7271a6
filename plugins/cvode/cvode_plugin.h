/* SPDX-License-Identifier: BSD-3-Clause */
/* cvode_plugin.h -- shared by the files of this plugin. Reading order: plugin.c (the
 * methods), create.c (one instance), step.c (one accepted step); then ../sundials (the
 * vectors and the linear systems).
 *
 * SUNDIALS' CVODE is driven whole: it predicts, solves its equations, estimates the
 * error, accepts, rejects, and chooses order and h. */
#pragma once

#include "../sundials/sundials_equations.h"

#if defined(__GNUC__) /* headers of others do not meet our warnings */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#endif
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

/* A method: the public record first, so that a pointer to the one is a pointer to the
 * other. */
typedef struct cvode_method {
    weft_stepper_type type;
    int formulas;    /* CV_ADAMS or CV_BDF */
    int usual_order; /* the highest, unless weft_linear.max_order is set */
} cvode_method;

/* One instance. */
typedef struct cvode_stepper {
    const cvode_method *method;
    weft_ode ode;
    weft_allocator memory;
    double rtol, atol[2];      /* of positions [m], of velocities [m/s] */
    double min_step, max_step; /* [s] */
    int max_order;
    double h;     /* [s] what to try next */
    bool restart; /* CVODE's history is not that of the next step's y */
    weft_stepper_stats stats;
    long failed, unsolved; /* rejections that CVODE has counted so far; those whose
                              equations were not solved */

    SUNContext context;
    N_Vector y; /* ours; CVODE writes to it also when it fails */
    void *solver;
    SUNNonlinearSolver iteration; /* NULL: CVODE's own, Newton's */
    sun_equations equations;      /* of bdf */

    /* the step under way */
    bool starting; /* the next RHS call is f(t, y) at its start */
    bool stopped;  /* the RHS asked to end the run */
    bool bad;      /* the last RHS call was of no use */
} cvode_stepper;

/* create.c */
weft_status weft__cvode_create(const weft_stepper_type *type, const weft_ode *ode,
                               const weft_stepper_config *config, void **out,
                               weft_error *err);
void weft__cvode_destroy(void *instance);
void weft__cvode_options(const void *instance, weft_option_fn *tell, void *ctx);

/* step.c */
int weft__cvode_rhs(sunrealtype t, N_Vector y, N_Vector ydot, void *instance);
int weft__cvode_weights(N_Vector y, N_Vector weights, void *instance);
int weft__cvode_system(sunrealtype t, N_Vector y, N_Vector fy, SUNMatrix matrix,
                       int keep, int *fresh, sunrealtype gamma, void *instance,
                       N_Vector work1, N_Vector work2, N_Vector work3);
weft_status weft__cvode_step(void *instance, double t_end, double *t, double *y,
                             weft_error *err);
void weft__cvode_state_changed(void *instance);
void weft__cvode_stats(const void *instance, weft_stepper_stats *out);
