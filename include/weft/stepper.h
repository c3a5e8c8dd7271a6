/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/stepper.h -- the contract between weft and a time stepper.
 *
 * A stepper carries y' = f(t, y) forward by a solver that somebody else wrote. The
 * solver chooses h, judges the error and retries; weft asks for one accepted step
 * at a time, so that it may correct the state in between and meet every frame.
 *
 * The state is partitioned: y[0 .. dim/2) are positions [m], y[dim/2 .. dim) their
 * velocities [m/s]; with config->quadratures = q > 0, the last q components are apart
 * and the halves are of length (dim - q) / 2. For a cloth of N particles dim = 6 N and
 * each half is three planes: x[N] y[N] z[N], vx[N] vy[N] vz[N]. A stepper knows no more
 * of cloth.
 *
 * Threads: instances are independent; one instance is used by one thread at a time. */
#ifndef WEFT_STEPPER_H
#define WEFT_STEPPER_H

#include <string.h>

#include "weft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Raised when a field moves or changes meaning. New fields go at the end of a struct
 * and are recognised by its struct_size alone. */
#define WEFT_STEPPER_ABI 1u

/* Whether *s, of any version, has the field, which was added to the end of its struct.
 */
#define WEFT_HAS(s, type, field)                                                       \
    ((s)->struct_size >= offsetof(type, field) + sizeof((s)->field))

/* Fill all of dydt[dim]. Return 0; > 0 if y is unusable and a smaller step may help;
 * < 0 to end the run. Must not print, allocate or write to y. */
typedef int weft_rhs_fn(double t, const double *y, double *dydt, void *ctx);

typedef struct weft_ode {
    size_t dim; /* length of y: > 0, even but for config->quadratures */
    weft_rhs_fn *rhs;
    void *ctx; /* passed to rhs, never looked into */
} weft_ode;

typedef enum weft_norm { WEFT_NORM_MAX, WEFT_NORM_RMS } weft_norm;

/* An explicit Runge-Kutta table of the user's own; arrays belong to the caller. */
typedef struct weft_butcher {
    int stages, order;
    int embedded_order;       /* 0: no embedding, fixed step only */
    const double *a;          /* stages x stages, row by row, strictly lower */
    const double *b, *c;      /* stages each */
    const double *b_embedded; /* stages, or NULL */
} weft_butcher;

/* X(label, name, how many gains): the laws by which h follows the error estimates; PI
 * and PID of control theory, and those of K. Gustafsson, ACM TOMS 17 (1991) and 20
 * (1994). */
#define WEFT_CONTROLLERS(X)                                                            \
    X(PID, pid, 3)                                                                     \
    X(PI, pi, 2)                                                                       \
    X(I, i, 1)                                                                         \
    X(EXPLICIT_GUSTAFSSON, explicit_gustafsson, 2)                                     \
    X(IMPLICIT_GUSTAFSSON, implicit_gustafsson, 2)                                     \
    X(IMEX_GUSTAFSSON, imex_gustafsson, 3)

typedef enum weft_controller_type {
    WEFT_CONTROLLER_DEFAULT,
#define WEFT_LABEL(label, name, gains) WEFT_CONTROLLER_##label,
    WEFT_CONTROLLERS(WEFT_LABEL)
#undef WEFT_LABEL
} weft_controller_type;

/* How a solver that offers a choice adapts h. A field that is 0: the plugin's own
 * default, which it tells by `options`. */
typedef struct weft_controller {
    weft_controller_type type;
    double gains[3];      /* of the law, gain_count of them */
    int gain_count;       /* 0: the defaults of the type */
    double safety;        /* > 0, <= 1: part of the h that would just do */
    double bias;          /* >= 1: the error estimate is multiplied by it */
    double max_growth;    /* > 1: of h from step to step */
    double first_growth;  /* > 1: the same after the first step */
    double min_reduction; /* > 0, < 1: of h from step to step */
    double failed_growth; /* > 0, < 1: of h after repeated rejections */
} weft_controller;

/* Threads of whoever steps, lent to the solver's own arithmetic: run calls
 * task(ctx, part) for each part of [0, parts), parts <= 65535, once, on any thread and
 * in any order, and returns when all are done. Only within create and step. */
typedef struct weft_team {
    void *self;
    void (*run)(void *self, void (*task)(void *ctx, size_t part), void *ctx,
                size_t parts);
} weft_team;

/* What the user asked of the solver, which then decides every step by itself. With
 * fixed_step > 0 there is no error control: the norm, the tolerances and the other
 * step sizes are not looked at. */
typedef struct weft_stepper_config {
    uint32_t struct_size;
    weft_norm norm;              /* of the error, over all components */
    double rtol;                 /* >= 0 */
    double atol_position;        /* [m], > 0 */
    double atol_velocity;        /* [m/s], > 0 */
    double first_step;           /* [s], > 0: first trial */
    double min_step;             /* [s], > 0: needing less is a failure */
    double max_step;             /* [s], >= min_step, may be INFINITY */
    double fixed_step;           /* [s]; 0: adaptive */
    const weft_butcher *butcher; /* for a method that takes one; else NULL */

    /* appended: there if struct_size says so */
    const weft_controller *controller; /* for a method that takes one; NULL: default */
    size_t threads;     /* of a simulation, for the forces and as a team for the
                           solver; 0 and 1: the caller's. Not for plugins */
    size_t quadratures; /* so many components at the end of y are neither positions nor
                           velocities: integrated along, without a say in any step.
                           Only for a method with WEFT_STEPPER_QUADRATURES */
    const weft_team *team; /* outlives the stepper; NULL: there is none, or in the
                              definition of a simulation: its own */
    const weft_allocator *allocator; /* for the plugin's own memory; solvers that know
                                        malloc only go on using it. NULL: malloc's */
} weft_stepper_config;

/* What every version of the struct has. */
#define WEFT_STEPPER_CONFIG_LEAST offsetof(weft_stepper_config, controller)

/* Length of the positions, and of the velocities, of y; 0: dim and quadratures do not
 * fit together. */
static inline size_t weft_stepper_half(const weft_ode *ode,
                                       const weft_stepper_config *config)
{
    const size_t apart
        = WEFT_HAS(config, weft_stepper_config, quadratures) ? config->quadratures : 0;
    return apart < ode->dim && (ode->dim - apart) % 2 == 0 ? (ode->dim - apart) / 2 : 0;
}

/* What a plugin takes its own memory from. */
static inline weft_allocator weft_stepper_memory(const weft_stepper_config *config)
{
    return weft_allocator_or_malloc(
        WEFT_HAS(config, weft_stepper_config, allocator) ? config->allocator : NULL);
}

typedef struct weft_stepper_stats {
    uint32_t struct_size;
    uint64_t steps;     /* accepted, since create; state_changed keeps all counts */
    uint64_t rejected;  /* attempts thrown away */
    uint64_t rhs_calls; /* all of them: stages, Jacobians, restarts */
    double last_step;   /* [s] size of the last accepted step; 0 before the first */
    double next_step;   /* [s] size the solver would try next; 0: not known */
} weft_stepper_stats;

enum {
    WEFT_STEPPER_FIXED_ONLY = 1 << 0, /* no error estimate: needs fixed_step */
    WEFT_STEPPER_FSAL = 1 << 1,       /* last stage is the next step's first */
    WEFT_STEPPER_MULTISTEP = 1 << 2,  /* a changed state restarts its history */
    WEFT_STEPPER_IMPLICIT = 1 << 3,
    WEFT_STEPPER_LEGACY = 1 << 4,      /* kept for comparison, not recommended */
    WEFT_STEPPER_BUTCHER = 1 << 5,     /* takes its table from config->butcher */
    WEFT_STEPPER_DENSE = 1 << 6,       /* keeps dim x dim matrices, a column a RHS call:
                                          small states only */
    WEFT_STEPPER_CONTROLLER = 1 << 7,  /* adaptive steps look at config->controller */
    WEFT_STEPPER_QUADRATURES = 1 << 8, /* config->quadratures may be > 0 */
    WEFT_STEPPER_FIRST_AT_Y = 1 << 9,  /* the first RHS call of every step is at the t
                                          and y that it was given: saves weft a pass */
    WEFT_STEPPER_LIBM = 1 << 10 /* the solver decides by powers, sines, ... of libm,
                                   which rounds them as it likes: no promise of the same
                                   bits on another machine */
};

/* An option in force, in words: "safety", "0.96". */
typedef void weft_option_fn(void *ctx, const char *name, const char *value);

/* One method: a constant, one for each. */
typedef struct weft_stepper_type {
    uint32_t abi;          /* WEFT_STEPPER_ABI */
    uint32_t struct_size;  /* sizeof(weft_stepper_type) as the plugin saw it */
    const char *name;      /* "rkf45"; unique in its plugin */
    const char *reference; /* the publication the coefficients come from */
    const char *license;   /* SPDX id of all that gets linked with this method */
    int order;             /* of the solution that is carried on; 0: variable */
    int error_order;       /* of the solution it is compared with; 0: none */
    int stages;     /* RHS calls of one attempt when nothing is reused; 0: varies */
    uint32_t flags; /* WEFT_STEPPER_... */

    /* Make an instance for *ode, which outlives it. Every name and number is checked
     * here, before the solver sees it. Calls no RHS and prints nothing. On failure
     * *self is NULL, nothing leaks and *err says why. */
    weft_status (*create)(const struct weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **self,
                          weft_error *err);

    /* Advance y and *t < t_end by exactly ONE ACCEPTED step, never past t_end, and
     * onto t_end bit for bit when it gets there. y is as the last step left it unless
     * state_changed was called. An accepted y is finite, also with fixed_step. On
     * failure *t and y are as before and step may be called again. WEFT_STOPPED where
     * the rhs returned < 0, WEFT_NOT_FINITE where it returned > 0 or y is not finite
     * however small the step, WEFT_STEP_TOO_SMALL, WEFT_INVALID (t_end <= t). *err
     * does not name t: weft adds the time to the message. */
    weft_status (*step)(void *self, double t_end, double *t, double *y,
                        weft_error *err);

    /* y was edited from outside: the next step starts from what it then finds there.
     * O(1). A needless call may cost one RHS call and never changes the results of a
     * one-step method; a multistep method restarts its history. */
    void (*state_changed)(void *self);

    /* out->struct_size is set by the caller; fields beyond it are not written. */
    void (*stats)(const void *self, weft_stepper_stats *out);

    void (*destroy)(void *self); /* NULL is allowed */

    /* appended: there if struct_size says so; each may be NULL */
    const char *full_name; /* another name that finds the method: the solver's own */

    /* Tells every choice that the plugin made or passed on to the solver beyond what
     * stands in the config: all that a repetition of the run needs. */
    void (*options)(const void *self, weft_option_fn *tell, void *ctx);

    /* The right-hand side itself has changed, y perhaps not: nothing that was computed
     * from it may be carried over. NULL: state_changed does as well. */
    void (*ode_changed)(void *self);

    /* Of a method with WEFT_STEPPER_DENSE: how many matrices of dim x dim an instance
     * keeps. 0: one at least. */
    int matrices;
} weft_stepper_type;

/* What every version of the struct has. */
#define WEFT_STEPPER_TYPE_LEAST offsetof(weft_stepper_type, full_name)

/* Calls ode_changed, or state_changed where it is to do. */
static inline void weft_stepper_ode_changed(const weft_stepper_type *type, void *self)
{
    if (WEFT_HAS(type, weft_stepper_type, ode_changed) && type->ode_changed != NULL) {
        type->ode_changed(self);
    } else {
        type->state_changed(self);
    }
}

static inline const char *weft_stepper_full_name(const weft_stepper_type *type)
{
    return WEFT_HAS(type, weft_stepper_type, full_name) ? type->full_name : NULL;
}

/* Whether a method has that name or full name. */
static inline bool weft_stepper_is(const weft_stepper_type *type, const char *name)
{
    const char *full = weft_stepper_full_name(type);
    return strcmp(type->name, name) == 0 || (full != NULL && strcmp(full, name) == 0);
}

/* weft-<id>.so exports one function, weft_plugin_<id>(), which returns static data.
 * Linked statically, the same object file is registered by that function. */
typedef struct weft_plugin {
    uint32_t abi; /* first field for ever; checked first */
    uint32_t struct_size;
    const char *id;                        /* "gsl", as in weft-gsl.so */
    const char *version;                   /* of the plugin */
    const char *solver;                    /* wrapped library and its version, or "" */
    const weft_stepper_type *const *types; /* ends with NULL */
} weft_plugin;

typedef const weft_plugin *weft_plugin_fn(void);

#ifdef __cplusplus
}
#endif

#endif
