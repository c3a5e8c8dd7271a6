/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_plugin.h -- shared by the files of this plugin. Reading order: plugin.c (the
 * methods), tables.c and order.c (coefficients and what they must meet), create.c (one
 * instance), control.c (how h is adapted), implicit.c (equations of stages),
 * stabilised.c (how many stages), step.c (one accepted step); then ../sundials (the
 * vectors and the linear systems) and ../stabilised (the spectrum).
 *
 * The Runge-Kutta modules of SUNDIALS' ARKODE, ERKStep for explicit tables, ARKStep for
 * implicit ones and LSRKStep for stabilised methods, are driven whole: they combine the
 * stages, estimate the error, accept, reject and choose h. SUNDIALS 6.4 to 7.x; what
 * differs between them is in this file and in `version_settings`. */
#pragma once

#include "../stabilised/spectrum.h"
#include "../sundials/sundials_equations.h"

#if defined(__GNUC__) /* headers of others do not meet our warnings */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#endif
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>
#include <arkode/arkode_erkstep.h>
#if SUNV >= 607
#include <sundials/sundials_adaptcontroller.h>
#endif
#if SUNV >= 702
#include <arkode/arkode_lsrkstep.h>
#endif
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#if SUNV >= 701 /* functions that were of each module became ARKODE's own */
#define ERK(name) ARKode##name
#define ARK(name) ARKode##name
#else
#define ERK(name) ERKStep##name
#define ARK(name) (self->implicit ? ARKStep##name : ERKStep##name)
#endif

/* A method: the public record first, so that a pointer to the one is a pointer to the
 * other, and where its table comes from: ARKODE, or us, or the user. A stabilised
 * method has none. */
typedef struct ark_method {
    weft_stepper_type type;
    ARKODE_ERKTableID id;      /* ARKODE_ERK_NONE: not one of ARKODE's */
    ARKODE_DIRKTableID dirk;   /* of an implicit method, instead */
    const weft_butcher *table; /* NULL: not one of ours */
    bool stabilised;
    int lsrk; /* then ARKODE_LSRKMethodType */
} ark_method;

/* The last two accepted steps: their biased errors, 1 where there was none, and their
 * lengths [s], 0 where there was none. */
typedef struct ark_past {
    double e[2], h[2];
} ark_past;

/* What the calls of the RHS in a step have come to that no smaller h helps. */
typedef enum ark_fault { NO_FAULT, USELESS, STOPPED } ark_fault;

/* One instance. */
typedef struct arkode_stepper {
    const ark_method *method;
    weft_ode ode;
    size_t half;          /* of the positions; the velocities; then quadratures */
    double rtol, atol[2]; /* of positions [m], of velocities [m/s] */
    double fixed_step, min_step, max_step; /* [s] */
    double longest;          /* [s] what ARKODE may try: max_step or less */
    weft_controller control; /* complete */
    const weft_agree *agree; /* with the steppers of other parts of y, or NULL */
    int stages;              /* of the table; 0: there is none */
    bool implicit;
    bool fsal;    /* the last stage of the table is the first of the next step */
    bool passes;  /* attempts are made in one pass */
    bool hidden;  /* a stage that is not finite need not show in the step */
    double h;     /* [s] what to try next */
    bool own_h;   /* h is ours: ARKODE would try another */
    bool restart; /* ARKODE's y or f is not what the next step starts from */
    weft_stepper_stats stats;
    long failed_tests; /* rejections that ARKODE has counted so far, */
    long unsolved;     /* and steps whose equations were not solved */

    SUNContext context;
    N_Vector y; /* ours; ARKODE writes to it also when it fails */
    void *solver;
    sun_equations equations;         /* of an implicit method */
    const weft_structure *structure; /* of a stabilised method, as the next two */
    weft__spectrum spectrum;
    bool anew; /* ARKODE keeps an eigenvalue after a failure: it must start anew */
#if SUNV >= 607
    SUNAdaptController controller;
    ark_past past; /* as that controller knows it */
#endif

    /* the step under way */
    double trial;    /* [s] what it began with */
    double start;    /* [s] where it starts until f was called, then NaN */
    bool skip;       /* the next RHS call is for nothing (step.c) */
    ark_fault fault; /* of this part of y until it is agreed on */
    bool over;       /* all agreed on a fault */
    uint64_t idle;   /* RHS calls only for others, since the last agreement */
    int since_bad;   /* RHS calls since one whose result was of no use */
} arkode_stepper;

/* create.c */
weft_status weft__ark_create(const weft_stepper_type *type, const weft_ode *ode,
                             const weft_stepper_config *config, void **out,
                             weft_error *err);
void weft__ark_destroy(void *instance);

/* control.c: the fault of a controller, or NULL; a controller with its defaults;
 * passed to ARKODE, 0 on success; the options in force. */
const char *weft__ark_control_mistake(const weft_controller *c);
weft_controller weft__ark_control(const ark_method *method,
                                  const weft_controller *asked);
int weft__ark_set_control(arkode_stepper *self);
void weft__ark_options(const void *instance, weft_option_fn *tell, void *ctx);

/* implicit.c: for implicit methods, before the solver is made and after; the steps that
 * ARKODE could not solve. */
weft_status weft__ark_equations(arkode_stepper *self, const weft_stepper_config *config,
                                weft_error *err);
bool weft__ark_set_newton(arkode_stepper *self);
long weft__ark_unsolved(const arkode_stepper *self);
void weft__ark_tell_newton(const arkode_stepper *self, weft_option_fn *tell, void *ctx);

/* stabilised.c: makes self->solver; starts it anew from self->y, 0 on success; before
 * each step of any method, limits h to what is stable. */
bool weft__ark_make_stabilised(arkode_stepper *self);
int weft__ark_restart_stabilised(arkode_stepper *self, double t);
weft_status weft__ark_limit_step(arkode_stepper *self, double t, const double *y,
                                 weft_error *err);

/* step.c */
int weft__ark_rhs(sunrealtype t, N_Vector y, N_Vector ydot, void *instance);
double weft__ark_agree(void *instance, double mine); /* a weft_agree's max */
/* As weft__sun_stages has them. */
void weft__ark_stage(void *instance, double t, const double *z, bool usable, bool again,
                     double *k);
void weft__ark_passed(void *instance, int calls, bool stopped);
int weft__ark_weights(N_Vector y, N_Vector weights, void *instance);
int weft__ark_step_done(sunrealtype t, N_Vector y, void *instance);
weft_status weft__ark_step(void *instance, double t_end, double *t, double *y,
                           weft_error *err);
void weft__ark_state_changed(void *instance);
void weft__ark_ode_changed(void *instance);
void weft__ark_stats(const void *instance, weft_stepper_stats *out);

/* tables.c: the table of a method for ARKODE, which the caller frees; NULL for a
 * stabilised one. */
weft_status weft__ark_table(const ark_method *method, const weft_butcher *custom,
                            ARKodeButcherTable *out, weft_error *err);
bool weft__ark_table_is_fsal(ARKodeButcherTable table);
/* Whether there is a stage that nothing in a step is combined from. */
bool weft__ark_table_hides(ARKodeButcherTable table, bool adaptive);
extern const weft_butcher weft__ark_euler, weft__ark_midpoint, weft__ark_heun,
    weft__ark_rk4, weft__ark_rk38;

/* order.c: whether the weights have the order; if not, *what is the first condition
 * that fails. Orders above WEFT__ARK_ORDER_CHECKED are checked up to that. */
#define WEFT__ARK_MAX_STAGES    (WEFT__SUN_MOST_TERMS - 1)
#define WEFT__ARK_ORDER_CHECKED 5
bool weft__ark_has_order(const weft_butcher *table, const double *weights, int order,
                         const char **what, double *is, double *wanted);
