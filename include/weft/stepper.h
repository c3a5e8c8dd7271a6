/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/stepper.h -- the contract between weft and an integrator.
 *
 * An integrator computes y' = f(t, y) with an existing solver. The solver
 * chooses h, judges the error and retries. weft requests one accepted step at a time,
 * so that it can correct the state in between and reach every frame time.
 *
 * The state is partitioned: y[0 .. dim/2) are positions [m], y[dim/2 .. dim) their
 * velocities [m/s]. With config->quadratures = q > 0, the last q components are
 * separate and the halves have length (dim - q) / 2. For a cloth of N particles dim = 6
 * N and each half is three planes: x[N] y[N] z[N], vx[N] vy[N] vz[N]. An integrator
 * knows nothing else about the cloth.
 *
 * Threads: instances are independent; only one thread at a time uses an instance. */
#ifndef WEFT_STEPPER_H
#define WEFT_STEPPER_H

#include <math.h>
#include <string.h>

#include "weft/agree.h"
#include "weft/base.h"
#include "weft/pass.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Raised when a field moves or changes meaning. New fields go at the end of a struct;
 * only its struct_size shows whether they are present: a struct without one is fixed.
 */
#define WEFT_STEPPER_ABI 1u

/* Fills all of dydt[dim]. Returns 0; > 0 if y is unusable and a smaller step may help;
 * < 0 to end the run. Must not print, allocate or write to y. */
typedef int weft_rhs_fn(double t, const double *y, double *dydt, void *ctx);

/* The problem y' = f(t, y). */
typedef struct weft_ode {
    size_t dim; /* length of y: > 0, even without config->quadratures */
    weft_rhs_fn *rhs;
    void *ctx; /* passed to rhs, not read by the integrator */
} weft_ode;

typedef enum weft_norm { WEFT_NORM_MAX, WEFT_NORM_RMS } weft_norm;

/* A user's explicit Runge-Kutta table; the caller owns the arrays. */
typedef struct weft_butcher {
    int stages, order;
    int embedded_order;       /* 0: no embedding, fixed step only */
    const double *a;          /* stages x stages, row by row, strictly lower */
    const double *b, *c;      /* stages each */
    const double *b_embedded; /* stages, or NULL */
} weft_butcher;

/* X(label, name, number of gains): the laws that compute h from the error estimates; PI
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

/* The step size control, for a solver that offers a choice. A field that is 0 means the
 * plugin's default, which `options` reports. */
typedef struct weft_controller {
    weft_controller_type type;
    double gains[3];      /* of the law, gain_count of them */
    int gain_count;       /* 0: the defaults of the type */
    double safety;        /* > 0, <= 1: part of the largest acceptable h */
    double bias;          /* >= 1: factor of the error estimate */
    double max_growth;    /* > 1: of h from step to step */
    double first_growth;  /* > 1: the same after the first step */
    double min_reduction; /* > 0, < 1: of h from step to step */
    double failed_growth; /* > 0, < 1: of h after repeated rejections */
} weft_controller;

/* The caller's threads, lent to the solver's arithmetic. run calls task(ctx, part) once
 * for each part of [0, parts), parts <= 65535, on any thread and in any order, and
 * returns when all calls are done. Use it only within create and step. */
typedef struct weft_team {
    void *self;
    void (*run)(void *self, void (*task)(void *ctx, size_t part), void *ctx,
                size_t parts);
} weft_team;

/* A run of spring couplings: pairs of particles (p + i, q + i), i < count, that springs
 * join. A grid has about six runs a row; any graph can be given, with runs of 1. */
typedef struct weft_spring_run {
    size_t p, q, count;
} weft_spring_run;

/* A 3 x 3 block of the Jacobian: particles p < q that the membrane of triangles
 * couples. */
typedef struct weft_block_coupling {
    uint32_t p, q;
} weft_block_coupling;

/* A multiple of the 3 x 3 identity: particles p < q that the bending of triangles
 * couples. */
typedef struct weft_scalar_coupling {
    uint32_t p, q;
    double k, c; /* [N/m], [kg/s] of either sign */
} weft_scalar_coupling;

/* Planes of weft_structure::linearise: per pair, per particle; the values of
 * linearise_blocks per coupling; and the corners that weft_structure::modes may have.
 */
enum {
    WEFT_PAIR_PLANES = 6,
    WEFT_BLOCK_PLANES = 15,
    WEFT_MODES_CORNERS = 40,
    WEFT_COUPLING_NUMBERS = 18
};

/* The structure of a cloth's right-hand side, for implicit and stabilised methods:
 *
 *     x' = v,   M v' = F(t, x, v),   K = -dF/dx,   C = -dF/dv
 *
 * A spring from p to q, of length L and tension T, with d = x_q - x_p, u = d / L,
 * w = v_q - v_p, P = I - u u^T, adds to J (dx, dv), in the rows of p, and with the
 * opposite sign in those of q,
 *
 *     dF = u [(k - q) u.dd + z.dd + c u.dw] + q dd,    q = T / L,   z = (c / L) P w
 *
 * where dd, dw are the differences of dx, dv. Source: D. Baraff, A. Witkin, Large steps
 * in cloth simulation, SIGGRAPH 1998; derived in docs/theory/sensitivities.md. A
 * symmetric matrix that is never negative follows without z and with q from [0, k]
 * (K.-J. Choi, H.-S. Ko, Stable but responsive cloth, SIGGRAPH 2002).
 *
 * Bending rigidity adds pairs without u (bend_runs below). J is not complete: it lacks
 * the wind and a force of the embedder's own. weft_cloth_jacobian_product has the wind.
 *
 * All functions are pure: they may be called within create and step, in the thread that
 * calls those, and allocate nothing. All addresses stay while the integrator exists.
 * Pins and shapes may change between two steps, also between create and the first one,
 * and with them the values of mass and block_planes: ode_changed announces it. */
typedef struct weft_structure {
    uint32_t struct_size;
    size_t particles;            /* N; y begins with its 6 N numbers */
    size_t run_count;            /* of runs */
    size_t pair_count;           /* the sum of all counts */
    const weft_spring_run *runs; /* in the order of the planes of linearise */
    const double *mass;  /* [kg] N; 0: prescribed, x and v follow their own law */
    const double *drag;  /* [kg/s] N: viscous, part of C, >= 0 */
    size_t block_planes; /* 0, or WEFT_BLOCK_PLANES: there are shapes to touch */

    /* Writes the springs' part of J in (t, y) to planes[6 pair_count]: u_x, u_y, u_z,
     * k - q [N/m], q [N/m], c [kg/s]; unfiltered, all 0 for a spring of length 0. z
     * follows from c, u and y. Under the strain law k is that law's by the rest length.
     *
     * If block_planes is not 0, writes the contact of each particle to
     * blocks[15 N]: K in nine planes, row by row [N/m], which friction, spin and
     * curvature make unsymmetric; then C in six, xx xy xz yy yz zz [kg/s], without what
     * the speed of approach does to friction: symmetric and never negative. 0 of pinned
     * particles and where nothing touches. blocks NULL: only the planes.
     *
     * Returns, as rhs does, 0, or > 0 if a number is not finite or a particle is in a
     * shape. */
    int (*linearise)(double t, const double *y, double *planes, double *blocks,
                     void *ctx);

    /* Writes the corners, in order, of a convex polygon that holds the pairs (omega^2
     * [1/s^2], damping rate [1/s]) of all modes in (t, y); y NULL: in any state
     * (on triangles: stretches up to 1.1, arcs of 0.25 rad), less sharp. Without the
     * wind's stiffness, negative omega^2 and the embedder's force. Infinite if y is not
     * finite. With config->agree it is collective, and of the modes of the whole state.
     * Returns their number, at most `room`: all fit in WEFT_MODES_CORNERS, and the
     * rectangle about them in 4; 0 with less room. */
    size_t (*modes)(double t, const double *y, double (*corners)[2], size_t room,
                    void *ctx);
    void *ctx;

    /* The last of the runs, with the last of the pairs, are bending rigidity: u, k - q
     * and c are 0, q is constant and may be negative. Together they are a matrix B that
     * never is; it belongs to K, and bend_damping B to C. 0 without. */
    size_t bend_runs, bend_pairs;
    double bend_damping; /* [s] */

    /* A cloth of triangles has no runs, but block and scalar couplings; others have
     * none of these. K x has
     * A (x_p - x_q) in the rows of p and A^T (x_q - x_p) in those of q for each of
     * them, with a 3 x 3 block A, and so has C. One A need not be symmetric and may be
     * negative; together they are symmetric and never negative.
     *
     * linearise_blocks writes, for each of `block_couplings`, A of K row by row [N/m],
     * without stresses that press, and A of C likewise [kg/s], without what it has to
     * do with x, to numbers[18 block_coupling_count]. Returns as linearise. A scalar
     * coupling has A = k I and c I, the same in all states.
     *
     * They are there for methods with WEFT_STEPPER_COUPLINGS. An implicit method
     * without that flag has no structure on triangles. */
    size_t block_coupling_count, scalar_coupling_count;
    const weft_block_coupling *block_couplings;
    const weft_scalar_coupling *scalar_couplings;
    int (*linearise_blocks)(double t, const double *y, double *numbers, void *ctx);
} weft_structure;

/* How an implicit method solves its linear systems. AUTO: the blocks of the diagonal
 * where few iterations do, else multigrid. */
typedef enum weft_preconditioner {
    WEFT_PRECONDITIONER_AUTO,
    WEFT_PRECONDITIONER_JACOBI, /* 3 x 3 blocks of the diagonal */
    WEFT_PRECONDITIONER_MULTIGRID
} weft_preconditioner;

/* When a method with Newton's iteration computes the Jacobian again: in every step, or
 * in every iteration. */
typedef enum weft_jacobian {
    WEFT_JACOBIAN_DEFAULT,
    WEFT_JACOBIAN_STEP,
    WEFT_JACOBIAN_NEWTON
} weft_jacobian;

/* Settings of implicit methods. A field that is 0 means the method's default, which
 * `options` reports. */
typedef struct weft_linear {
    uint32_t struct_size;
    double krylov; /* > 0, < 1: relative residual of a linear system */
    weft_preconditioner preconditioner;
    weft_jacobian jacobian;
    int max_order; /* of a method of variable order */
} weft_linear;

/* The user's settings for the solver, which then decides every step by itself. With
 * fixed_step > 0 there is no error control: the norm, the tolerances and the other step
 * sizes are ignored. */
typedef struct weft_stepper_config {
    uint32_t struct_size;
    weft_norm norm;              /* of the error, over all components */
    double rtol;                 /* >= 0 */
    double atol_position;        /* [m], > 0 */
    double atol_velocity;        /* [m/s], > 0 */
    double first_step;           /* [s], > 0: first trial */
    double min_step;             /* [s], > 0: a smaller one is a failure */
    double max_step;             /* [s], >= min_step, may be INFINITY */
    double fixed_step;           /* [s]; 0: adaptive */
    const weft_butcher *butcher; /* for a method that takes one; else NULL */

    /* appended: present if struct_size says so */
    const weft_controller *controller; /* for a method that takes one; NULL: default */
    size_t threads;        /* of a simulation, for the forces and as a team for the
                              solver; 0 and 1: only the caller's. Not for plugins */
    size_t quadratures;    /* number of components at the end of y that are neither
                              positions nor velocities: integrated too, but without
                              influence on any step. Needs WEFT_STEPPER_QUADRATURES */
    const weft_team *team; /* must outlive the integrator; NULL: none, or, in the
                              definition of a simulation, its own */
    const weft_allocator *allocator; /* for the plugin's own memory; solvers that only
                                        know malloc still use it. NULL: malloc's */
    const weft_structure
        *structure;            /* of the ode, must outlive the integrator; NULL: not
                                  known. A simulation gives that of its cloth */
    const weft_linear *linear; /* for an implicit method; NULL: its defaults */
    const weft_agree
        *agree;            /* NULL: the state is whole. Needs
                              WEFT_STEPPER_DISTRIBUTED, and         for the rms norm `rms` */
    const weft_pass *pass; /* see weft_stepper_pass. In the definition of a simulation
                               NULL: its own, where faster; one without run: none */
    const weft_rms *rms;   /* NULL: the solver's own sum. A simulation gives its own to
                              methods with WEFT_STEPPER_DISTRIBUTED */
} weft_stepper_config;

enum {
    WEFT_STEPPER_FIXED_ONLY = 1 << 0, /* no error estimate: needs fixed_step */
    WEFT_STEPPER_FSAL = 1 << 1,       /* last stage is the next step's first */
    WEFT_STEPPER_MULTISTEP = 1 << 2,  /* a changed state restarts its history */
    WEFT_STEPPER_IMPLICIT = 1 << 3,
    WEFT_STEPPER_LEGACY = 1 << 4,      /* kept for comparison, not recommended */
    WEFT_STEPPER_BUTCHER = 1 << 5,     /* takes its table from config->butcher */
    WEFT_STEPPER_DENSE = 1 << 6,       /* keeps dim x dim matrices, one column per RHS
                                          call: small states only */
    WEFT_STEPPER_CONTROLLER = 1 << 7,  /* adaptive steps use config->controller */
    WEFT_STEPPER_QUADRATURES = 1 << 8, /* config->quadratures may be > 0 */
    /* 1 << 9 is reserved: plugins for earlier versions of weft may set it */
    WEFT_STEPPER_LIBM = 1 << 10, /* the solver decides by powers, sines, ... of libm,
                                   whose rounding differs between machines: another
                                   machine may have other bits */
    WEFT_STEPPER_STRUCTURE = 1 << 11,     /* needs config->structure */
    WEFT_STEPPER_ADAPTIVE_ONLY = 1 << 12, /* every step is the solver's choice: create
                                             refuses fixed_step */
    WEFT_STEPPER_LINEAR = 1 << 13,      /* takes config->linear, and reports as options
                                           which of its members it uses */
    WEFT_STEPPER_DISTRIBUTED = 1 << 14, /* takes config->agree and config->rms */
    WEFT_STEPPER_COUPLINGS = 1 << 15,   /* uses the couplings of config->structure */
    WEFT_STEPPER_PASS = 1 << 16         /* may use config->pass */
};

/* The fields that every version of the struct has. */
#define WEFT_STEPPER_CONFIG_LEAST offsetof(weft_stepper_config, controller)

/** Computes the number of positions, and of velocities, in y.
 * @param ode its dim
 * @param config its quadratures
 * @return (dim - quadratures) / 2; 0 if the two are inconsistent
 * @par Example
 * @snippet own_stepper.c half */
static inline size_t weft_stepper_half(const weft_ode *ode,
                                       const weft_stepper_config *config)
{
    const size_t apart
        = WEFT_HAS(config, weft_stepper_config, quadratures) ? config->quadratures : 0;
    return apart < ode->dim && (ode->dim - apart) % 2 == 0 ? (ode->dim - apart) / 2 : 0;
}

/** Returns the structure of the right-hand side, for an implicit method.
 * @param config of any version
 * @return NULL: not known */
static inline const weft_structure *
weft_stepper_structure(const weft_stepper_config *config)
{
    return WEFT_HAS(config, weft_stepper_config, structure) ? config->structure : NULL;
}

/** Returns the settings for implicit methods.
 * @param config of any version
 * @return NULL: the method's defaults */
static inline const weft_linear *weft_stepper_linear(const weft_stepper_config *config)
{
    return WEFT_HAS(config, weft_stepper_config, linear) ? config->linear : NULL;
}

/** Returns the other integrators that must take the same decisions.
 * @param config of any version
 * @return NULL: the state is whole */
static inline const weft_agree *weft_stepper_agree(const weft_stepper_config *config)
{
    return WEFT_HAS(config, weft_stepper_config, agree) ? config->agree : NULL;
}

/** Returns the pass over the state that makes a whole attempt.
 * @param config of any version
 * @return NULL: there is none; call the right-hand side for each stage */
static inline const weft_pass *weft_stepper_pass(const weft_stepper_config *config)
{
    const weft_pass *pass
        = WEFT_HAS(config, weft_stepper_config, pass) ? config->pass : NULL;
    return pass != NULL && pass->run != NULL ? pass : NULL;
}

/** Returns the rms norm of the whole state.
 * @param config of any version
 * @return NULL: sum in the method itself */
static inline const weft_rms *weft_stepper_rms(const weft_stepper_config *config)
{
    return WEFT_HAS(config, weft_stepper_config, rms) ? config->rms : NULL;
}

/** Computes the largest value among all integrators that must agree. Collective, if
 * agree is not NULL.
 * @param agree of weft_stepper_agree
 * @param mine >= 0 or NaN
 * @return the largest, NaN if one is NaN; mine if agree is NULL */
static inline double weft_stepper_agreed(const weft_agree *agree, double mine)
{
    return agree ? agree->max(agree->self, mine) : mine;
}

/** Returns the allocator for a plugin's own memory.
 * @param config of any version
 * @return its allocator, or malloc's
 * @par Example
 * @snippet weft-bogacki.c memory */
static inline weft_allocator weft_stepper_memory(const weft_stepper_config *config)
{
    return weft_allocator_or_malloc(
        WEFT_HAS(config, weft_stepper_config, allocator) ? config->allocator : NULL);
}

/* Counts of an instance. */
typedef struct weft_stepper_stats {
    uint32_t struct_size;
    uint64_t steps;     /* accepted, since create; state_changed keeps all counts */
    uint64_t rejected;  /* rejected attempts */
    uint64_t rhs_calls; /* all calls: stages, Jacobians, restarts */
    double last_step;   /* [s] size of the last accepted step; 0 before the first */
    double next_step;   /* [s] size the solver would try next; 0: unknown */

    /* appended: of implicit methods, else 0 */
    uint64_t linear_iterations; /* of conjugate gradients */
    uint64_t factorisations;    /* Jacobians computed */
    uint64_t newton_failures;   /* systems that could not be solved */

    /* appended: memory of the instance in a run, as far as it grows with y; 0: not
     * known. Of a simulation: and its own, without the cloth of its definition. */
    uint64_t bytes;
} weft_stepper_stats;

/* An option in force, as text: "safety", "0.96". */
typedef void weft_option_fn(void *ctx, const char *name, const char *value);

/* One method; a constant struct. */
typedef struct weft_stepper_type {
    uint32_t abi;          /* WEFT_STEPPER_ABI */
    uint32_t struct_size;  /* sizeof(weft_stepper_type) as the plugin saw it */
    const char *name;      /* "rkf45"; unique in its plugin */
    const char *reference; /* the publication of the coefficients */
    const char *license;   /* SPDX id of all code linked with this method */
    int order;             /* of the solution that is continued; 0: variable */
    int error_order;       /* of the solution it is compared with; 0: none */
    int stages;     /* calls of rhs of one attempt when nothing is reused; 0: varies */
    uint32_t flags; /* WEFT_STEPPER_... */

    /* Creates an instance for *ode, which must outlive it. Checks every name and number
     * before the solver uses it. Calls no RHS, prints nothing and leaves the process as
     * it is (docs/guides/test-an-integrator.md, "process"). On failure *self is NULL,
     * nothing leaks and *err gives the reason; on success *err stays as it is, here and
     * in step. */
    weft_status (*create)(const struct weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **self,
                          weft_error *err);

    /* Advances y and *t < t_end by exactly ONE ACCEPTED step, never past t_end; a
     * step that reaches t_end ends on it bit for bit. t and y are as the last step left
     * them unless state_changed was called. An accepted y is finite, also with
     * fixed_step. On failure *t and y are unchanged and step may be called again.
     * WEFT_STOPPED if the rhs returned < 0; WEFT_NOT_FINITE if it returned > 0 or y is
     * not finite however small the step; WEFT_STEP_TOO_SMALL; WEFT_INVALID (t_end <=
     * t). *err does not name t: weft adds the time to the message. */
    weft_status (*step)(void *self, double t_end, double *t, double *y,
                        weft_error *err);

    /* y was edited from outside, or t was set back with it (weft rolls back a step that
     * may have passed through a shape): the next step starts from the t and y that it
     * is given. O(1). A needless call may cost one call of rhs and never changes the
     * results of a one-step method; a multistep method restarts its history. */
    void (*state_changed)(void *self);

    /* The caller sets out->struct_size; fields beyond it are not written. */
    void (*stats)(const void *self, weft_stepper_stats *out);

    void (*destroy)(void *self); /* NULL is allowed */

    /* appended: present if struct_size says so; each may be NULL */
    const char *full_name; /* the solver's own name, which also finds the method */

    /* Reports every choice that the plugin made or passed on to the solver beyond the
     * config: everything that a repetition of the run needs. */
    void (*options)(const void *self, weft_option_fn *tell, void *ctx);

    /* The right-hand side has changed, y perhaps not, or bends at t (a row of a table):
     * drop everything that was computed from it. NULL: state_changed is enough. */
    void (*ode_changed)(void *self);

    /* For a method with WEFT_STEPPER_DENSE: the number of matrices of dim x dim in an
     * instance. 0: at least one. */
    int matrices;
} weft_stepper_type;

/* The fields that every version of the struct has. */
#define WEFT_STEPPER_TYPE_LEAST offsetof(weft_stepper_type, full_name)

/** Announces to an instance that the right-hand side has changed: calls ode_changed, or
 * state_changed if there is no ode_changed.
 * @param type the method
 * @param self its instance */
static inline void weft_stepper_ode_changed(const weft_stepper_type *type, void *self)
{
    if (WEFT_HAS(type, weft_stepper_type, ode_changed) && type->ode_changed != NULL) {
        type->ode_changed(self);
    } else {
        type->state_changed(self);
    }
}

/** Returns the solver's own name of a method.
 * @param type of any version
 * @return NULL: there is none */
static inline const char *weft_stepper_full_name(const weft_stepper_type *type)
{
    return WEFT_HAS(type, weft_stepper_type, full_name) ? type->full_name : NULL;
}

/** Returns whether a method has a name.
 * @param type the method
 * @param name may be its full name
 * @return whether it has */
static inline bool weft_stepper_is(const weft_stepper_type *type, const char *name)
{
    const char *full = weft_stepper_full_name(type);
    return strcmp(type->name, name) == 0 || (full != NULL && strcmp(full, name) == 0);
}

/* ---- for the functions of a method ----------------------------------------------- */

/** Returns whether a number is positive and finite.
 * @param x any number; NaN is not
 * @return whether it is */
static inline bool weft_stepper_positive(double x)
{
    return x > 0.0 && x < (double)INFINITY;
}

/** Finds the fault of the numbers of error control.
 * @param c the configuration, of any version
 * @return static text; NULL: there is none */
static inline const char *weft_stepper_adaptive_mistake(const weft_stepper_config *c)
{
    return c->norm != WEFT_NORM_MAX && c->norm != WEFT_NORM_RMS ? "unknown norm"
           : !(c->rtol >= 0.0 && c->rtol < (double)INFINITY)    ? "rtol must be >= 0"
           : !weft_stepper_positive(c->atol_position) ? "atol_position must be > 0 m"
           : !weft_stepper_positive(c->atol_velocity) ? "atol_velocity must be > 0 m/s"
           : !weft_stepper_positive(c->first_step)    ? "first_step must be > 0 s"
           : !weft_stepper_positive(c->min_step)      ? "min_step must be > 0 s"
           : !(c->max_step >= c->min_step)            ? "max_step must be >= min_step"
                                                      : NULL;
}

/** Finds the fault of config->agree.
 * @param type the method
 * @param c the configuration, of any version
 * @return static text; NULL: there is none */
static inline const char *weft_stepper_agree_mistake(const weft_stepper_type *type,
                                                     const weft_stepper_config *c)
{
    const weft_agree *agree = weft_stepper_agree(c);
    return agree == NULL ? NULL
           : (type->flags & (uint32_t)WEFT_STEPPER_DISTRIBUTED) == 0
               ? "cannot integrate a part of a state (agree)"
           : agree->max == NULL ? "agree without max"
           : c->fixed_step == 0.0 && c->norm == WEFT_NORM_RMS
                   && weft_stepper_rms(c) == NULL
               ? "parts of a state need `rms` for the rms norm"
               : NULL;
}

/** Finds the fault of the arguments of `create` that is one for every method with such
 * flags. Call it first in `create`.
 * @param type the method
 * @param ode the problem
 * @param c the configuration, of any version
 * @return static text; NULL: there is none
 * @par Example
 * @snippet weft-bogacki.c check */
static inline const char *weft_stepper_mistake(const weft_stepper_type *type,
                                               const weft_ode *ode,
                                               const weft_stepper_config *c)
{
    const uint32_t flags = type->flags;
    if (c->struct_size < WEFT_STEPPER_CONFIG_LEAST) {
        return "config of an older version";
    }
    const size_t half = weft_stepper_half(ode, c);
    const bool adaptive = c->fixed_step == 0.0;
    const bool takes_table = (flags & WEFT_STEPPER_BUTCHER) != 0;
    const char *alone = weft_stepper_agree_mistake(type, c);
    return ode->rhs == NULL ? "no right-hand side"
           : half == 0      ? "dim less the quadratures must be even and > 0"
           : ode->dim > 2 * half && (flags & WEFT_STEPPER_QUADRATURES) == 0
               ? "takes no quadratures"
           : takes_table && c->butcher == NULL  ? "needs a Butcher table"
           : !takes_table && c->butcher != NULL ? "takes no Butcher table"
           : (flags & WEFT_STEPPER_FIXED_ONLY) != 0
                   && !weft_stepper_positive(c->fixed_step)
               ? "no error control: needs a fixed_step > 0 s"
           : !adaptive && !weft_stepper_positive(c->fixed_step)
               ? "fixed_step must be > 0 s, or 0 for adaptive steps"
           : !adaptive && (flags & WEFT_STEPPER_ADAPTIVE_ONLY) != 0
               ? "takes no fixed_step: it chooses every step by the tolerances"
           : alone != NULL ? alone
           : adaptive      ? weft_stepper_adaptive_mistake(c)
                           : NULL;
}

/** Checks the arguments of `step`.
 * @param type the method, whose name the message has
 * @param t [s] the present time
 * @param t_end [s] where the step may end at most
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID if t_end is not later than t, or not finite */
static inline weft_status weft_stepper_check_end(const weft_stepper_type *type,
                                                 double t, double t_end,
                                                 weft_error *err)
{
    return weft_stepper_positive(t_end - t)
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID, "%s: a step from %.*g s to %.*g s",
                                type->name, weft_text_digits(t), t,
                                weft_text_digits(t_end), t_end);
}

/** Copies counts into a struct that may be older, as `stats` must.
 * @param from the instance's own
 * @param[in,out] out its struct_size gives its length, and stays
 * @par Example
 * @snippet weft-bogacki.c stats */
static inline void weft_stepper_stats_copy(const weft_stepper_stats *from,
                                           weft_stepper_stats *out)
{
    const uint32_t size = out->struct_size;
    memcpy(out, from, size < sizeof *from ? size : sizeof *from);
    out->struct_size = size;
}

/* weft-<id>.so exports one function, weft_plugin_<id>(), which returns static data. A
 * program linked with the same object file registers it through that function. */
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
