/* SPDX-License-Identifier: BSD-3-Clause */
/* oscillators.h -- the model that methods are tried on: three coupled oscillators,
 * damped, driven and nonlinear, with y = (x1, x2, x3, v1, v2, v3), followed by up to
 * three quadratures. To a method that needs the structure of the equations it is one
 * particle in a field of forces. It fails on request. The reference solution is
 * computed by the classical Runge-Kutta method with 2^-13 s, and is good to 1e-13. */
#pragma once

#include <math.h>
#include <pthread.h>

#include "weft/stepper.h"

enum { DIM = 6, APART = 3 /* quadratures at most */, WEFT__DIM_MOST = 30 };

typedef enum fault { NO_FAULT, REFUSE, STOP, GIVE_NAN, GIVE_INF, FAULTS } fault;

/* Two threads take turns at first: each call of one model's rhs waits for one of the
 * other's, so that data shared by mistake are certainly overwritten. */
typedef struct baton {
    pthread_mutex_t lock;
    pthread_cond_t passed;
    int turn, passes;
    bool dropped; /* no thread waits any more */
    bool late;    /* the last wait ended by its time limit */
} baton;

typedef struct model {
    double k;     /* [1/s^2] stiffness of the first oscillator */
    double edge;  /* [m] states beyond it are refused; 0: none */
    double last;  /* [s] later times are refused; 0: none */
    int single;   /* 1 to 3: only this oscillator, undamped, and the others rest */
    size_t apart; /* quadratures: t, x1 less its start, and the integral of v1 v2 */
    baton *baton; /* NULL: no turns are taken */
    int side;     /* 0 or 1 */
    uint64_t calls;
    fault fault; /* the kind of failure */
    uint64_t at; /* from this call on, */
    bool once;   /* or at it alone */
} model;

extern const double weft__model_start[DIM];
extern const char *const weft__fault_names[FAULTS]; /* what the rhs does */

/* ctx is the model. */
int weft__model_rhs(double t, const double *y, double *dydt, void *ctx);

/* The structure of its equations, which says that no mode is stiff: for methods that
 * need one, and bear any matrix. Newton's method wants the right one, or none. */
weft_structure weft__model_structure(model *of);

void weft__baton_drop(baton *self);

/* weft_structure.modes: none is known to be stiff. */
size_t weft__no_modes(double t, const double *y, double (*corners)[2], size_t room,
                      void *ctx);

/* A step of the classical Runge-Kutta method, of at most WEFT__DIM_MOST numbers. */
void weft__runge_kutta(const weft_ode *ode, double t, double h, double *y);

/* Advances y[DIM] from t to t_end, a multiple of 2^-13 s later; k = 1. */
void weft__model_solve(double t, double t_end, double *y);

/* The largest difference; INFINITY if an a is not finite. */
double weft__model_distance(const double *a, const double *b);

static inline weft_stepper_config weft__adaptive(double tolerance)
{
    return (weft_stepper_config){
        .struct_size = sizeof(weft_stepper_config),
        .atol_position = tolerance,
        .atol_velocity = tolerance,
        .first_step = 1.3e-3,
        .min_step = 1e-10,
        .max_step = (double)INFINITY,
    };
}

static inline weft_stepper_config weft__fixed(double h)
{
    return (weft_stepper_config){ .struct_size = sizeof(weft_stepper_config),
                                  .fixed_step = h };
}

static inline bool weft__adapts(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
}

static inline bool weft__needs_structure(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_STRUCTURE) != 0;
}

static inline bool weft__takes_fixed(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_ADAPTIVE_ONLY) == 0;
}

/* Mode 0: adaptive if the method can; mode 1: fixed steps if it takes them. */
static inline weft_stepper_config weft__usual(const weft_stepper_type *type, int mode)
{
    return (mode == 0 && weft__adapts(type)) || !weft__takes_fixed(type)
               ? weft__adaptive(1e-6)
               : weft__fixed(1e-3);
}

/* The error allowed at 1 s with weft__usual. */
static inline double weft__allowed(const weft_stepper_type *type)
{
    return type->order == 1 ? 5e-3 : 1e-4;
}

/* A Butcher table for methods that take one: R. H. Merson's of order 4,
 * with an embedded solution of order 3. */
static inline const weft_butcher *merson(void)
{
    static const double a[25]
        = { [5] = 1.0 / 3, [10] = 1.0 / 6, [11] = 1.0 / 6, [15] = 0.125,
            [17] = 0.375,  [20] = 0.5,     [22] = -1.5,    [23] = 2.0 };
    static const double b[5] = { 1.0 / 6, 0, 0, 2.0 / 3, 1.0 / 6 };
    static const double c[5] = { 0, 1.0 / 3, 1.0 / 3, 0.5, 1 };
    static const double b3[5] = { 0.1, 0, 0.3, 0.4, 0.2 };
    static const weft_butcher table = { 5, 4, 3, a, b, c, b3 };
    return &table;
}

/* Adds Merson's table for a method that needs a table and has none. */
static inline weft_stepper_config weft__with_table(const weft_stepper_type *type,
                                                   weft_stepper_config config)
{
    if ((type->flags & WEFT_STEPPER_BUTCHER) != 0 && config.butcher == NULL) {
        config.butcher = merson();
    }
    return config;
}

/* ---- measured_order.c: the order of a method ---------------------------------------
 */

enum { WEFT__ORDER_MOST = 9 };
#define WEFT__ORDER_BOUND 0.2

/* The order claimed by the method, or by the table it gets here; 0: variable, or
 * not to be measured in fixed steps. */
int weft__order_claimed(const weft_stepper_type *type);

/* log2 of the ratio of the errors with h and h/2, measured for the order `claimed`, at
 * most WEFT__ORDER_MOST; INFINITY if the errors are roundoff, as the order is higher
 * then. Errors: those of create and step. */
weft_status weft__order(const weft_stepper_type *type, int claimed, double *order,
                        weft_error *err);

/* ---- structured.c: a string of beads, the first held, with a structure -------------
 */

enum { WEFT__STRING = 30 /* numbers of its state; <= WEFT__DIM_MOST */ };

int weft__string_rhs(double t, const double *y, double *dydt, void *ctx);

/* Level, stretched a little, and moving. */
void weft__string_start(double y[WEFT__STRING]);

/* To a method that knows links some springs are given as such. */
void weft__string_init(weft_structure *at, bool knows_links);
