/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff_plugin.h -- shared by the files of this plugin: methods for stiff and damped
 * cloth, without a library. Reading order: stiff_plugin.c (the methods, one instance),
 * stiff_step.c (one accepted step), rkc2.c and implicit.c (one attempt), arithmetic.c
 * (loops over whole states), plugins/linear, which solves the linear systems, and
 * plugins/stabilised, which bounds the spectrum.
 *
 * All need weft_stepper_config.structure: how stiff and how damped the modes are, or
 * the Jacobian. */
#pragma once

#include "../linear/linear.h"
#include "../stabilised/spectrum.h"

#include "weft/stepper.h"

enum { ARRAYS = 6 }; /* of dim numbers each */

typedef struct stiff_stepper {
    const struct stiff_method *method;
    weft_ode ode;
    const weft_structure *structure;
    const weft_agree *agree; /* with the steppers of other parts of y, or NULL */
    const weft_rms *rms;     /* NULL: our own sum */
    weft_allocator memory;
    size_t half; /* of the positions; the velocities; then quadratures */
    weft_norm norm;
    double rtol, atol[2];                  /* of positions [m], of velocities [m/s] */
    double fixed_step, min_step, max_step; /* [s] */
    double h;                              /* [s] what to try next */
    weft_stepper_stats stats;
    weft__spectrum spectrum; /* of rkc2 */
    weft__linear *linear;    /* NULL: of rkc2 */
    weft_linear settings;    /* complete */

    bool carries; /* f is that of the t and y that the next attempt starts from */
    bool fresh;   /* the Jacobian, too */
    bool ends;    /* f_end is that of the result of the last attempt */
    double *f, *f_end;
    double *end;   /* result of an attempt: y keeps its value until it is accepted */
    double *error; /* of an attempt with error control */
    double *work[2];
} stiff_stepper;

/* The public record comes first: a pointer to it is a pointer to the method. */
typedef struct stiff_method {
    weft_stepper_type type;

    /* Before a step from (t, y); *most becomes the longest h [s] that it may try. NULL:
     * any. */
    weft_status (*prepare)(stiff_stepper *self, double t, const double *y, double *most,
                           weft_error *err);
    /* Writes y(t + h) to self->end and, unless the step is fixed, its error. Returns
     * what the RHS did, or > 0. */
    int (*attempt)(stiff_stepper *self, double t, double h, const double *y);
} stiff_method;

int weft__stiff_rhs(stiff_stepper *self, double t, const double *y, double *f);

/* stiff_step.c */
weft_status weft__stiff_step(void *instance, double t_end, double *t, double *y,
                             weft_error *err);

/* rkc2.c */
weft_status weft__rkc2_prepare(stiff_stepper *self, double t, const double *y,
                               double *most, weft_error *err);
int weft__rkc2_attempt(stiff_stepper *self, double t, double h, const double *y);

/* implicit.c */
int weft__ros2_attempt(stiff_stepper *self, double t, double h, const double *y);
int weft__backward_euler_attempt(stiff_stepper *self, double t, double h,
                                 const double *y);

/* arithmetic.c: to = sum of c[k] x[k], k < count <= 5. */
void weft__stiff_combine(size_t n, int count, const double *const *x, const double *c,
                         double *to);
/* Of e[i] / (rtol |y[i]| + atol) over two halves; NaN if e is not finite. May overwrite
 * work[0]. */
double weft__stiff_norm(const stiff_stepper *self, const double *e, const double *y);
bool weft__stiff_finite(size_t n, const double *y);
