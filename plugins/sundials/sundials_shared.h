/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_shared.h -- shared by the plugins that wrap SUNDIALS, arkode and cvode;
 * linked into each. vector.c and arithmetic.c are the operations on vectors, instance.c
 * checks a config, equations.c solves the linear systems of implicit methods.
 * SUNDIALS 6.4 to 7.x. */
#pragma once

#include "weft/elementary.h"
#include "weft/stepper.h"

#if defined(__GNUC__) /* headers of others do not meet our warnings */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#endif
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>

#define SUNV (SUNDIALS_VERSION_MAJOR * 100 + SUNDIALS_VERSION_MINOR)

#if SUNV >= 700
#include <sundials/sundials_core.h>
#endif
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sunlinsol/sunlinsol_spgmr.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#if SUNV < 604
#error "this plugin needs SUNDIALS 6.4 or later"
#endif
#ifndef SUNDIALS_DOUBLE_PRECISION
#error "this plugin needs SUNDIALS with realtype double"
#endif

#if SUNV >= 700
#define NO_COMM SUN_COMM_NULL
#else
#define NO_COMM NULL
#endif

/* ---- instance.c ------------------------------------------------------------------ */

/* The fault of the numbers that a method's flags make it read, or NULL. */
const char *weft__sun_mistake(const weft_stepper_type *type, const weft_ode *ode,
                              const weft_stepper_config *config);

/* Whether there is memory for that many vectors of dim numbers. */
weft_status weft__sun_memory(const char *name, size_t dim, int vectors,
                             weft_error *err);

/* A context that prints nothing; NULL: no memory. Until 6.x messages of solvers go to a
 * function of each instead: weft__sun_silent. */
SUNContext weft__sun_context(void);
#if SUNV < 700
void weft__sun_silent(int code, const char *module, const char *function, char *text,
                      void *data);
#endif

/* stats, as far as the caller's struct goes. */
void weft__sun_stats(const weft_stepper_stats *stats, double next_step,
                     weft_stepper_stats *out);

/* ---- vector.c -------------------------------------------------------------------- */

/* Vectors of one linear combination: the stages of a table and y. */
#define WEFT__SUN_MOST_TERMS 257

/* n zeros, whose clones inherit the pool and the norm. Operations on long ones are
 * shared with the pool, which may be NULL, with the same results. NULL: no memory. What
 * NV_DATA_S points to may be shared: it is for reading. */
N_Vector weft__sun_vector(size_t n, const weft_team *pool, SUNContext context);
/* Every norm is agreed on with others, who hold other parts of the state; the rms norm
 * is that one, unless it is NULL. */
void weft__sun_agree(N_Vector v, weft_agree agree, const weft_rms *rms);
/* SUNDIALS judges steps and tolerances by the first `judged` components. Before that it
 * finds nothing wrong. */
void weft__sun_judge_by(N_Vector v, weft_norm by, size_t judged);
/* Where its numbers may be written, all of them unless it was filled before. */
double *weft__sun_fill(N_Vector v);
void weft__sun_read(N_Vector v, double *to);
void weft__sun_write(N_Vector v, const double *from);
bool weft__sun_finite(N_Vector v);

/* How stages are made that were put off: `rates` as the RHS of a solver does, `again`:
 * only to have k once more; and what happens when they are made in one pass. */
typedef struct weft__sun_stages {
    void *ctx;
    void (*rates)(void *ctx, double t, const double *z, bool usable, bool again,
                  double *k);
    void (*made)(void *ctx, int calls, bool stopped);
} weft__sun_stages;

/* Attempts of steps are made by that pass. Only for a solver of explicit tables, that
 * reads no vector but through combinations and weighted max norms; without
 * quadratures and agree. */
void weft__sun_pass(N_Vector v, const weft_pass *pass, weft__sun_stages by);
/* For the RHS: true if y is a stage that is put off, and now ydot is too. */
bool weft__sun_put_off(double t, N_Vector y, N_Vector ydot);
/* The weights 1 / (rtol |y_i| + atol) of what is judged, in two halves. */
void weft__sun_weigh(N_Vector y, N_Vector weights, double rtol, const double atol[2]);
