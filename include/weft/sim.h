/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/sim.h -- time: a cloth under integration. */
#ifndef WEFT_SIM_H
#define WEFT_SIM_H

#include "weft/cloth.h"
#include "weft/comm.h"
#include "weft/registry.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A running simulation. One thread at a time; many may share a cloth.
 *
 * The same definition gives the same bits on every x86-64 machine and on any number of
 * threads, under these conditions: the method does not have WEFT_STEPPER_LIBM, its
 * solver library was built without contraction of a b + c, callbacks are functions of
 * their arguments alone, and the processor rounds to nearest and keeps denormal
 * numbers. 64-bit ARM has the same bits under the same conditions; Debian's GSL for it
 * is contracted. */
typedef struct weft_sim weft_sim;

/* Called after every accepted step of size h [s] that ended at t [s], after the strain
 * limit. May edit y[6 N], except the part of pinned particles. Returns whether it did.
 * It must leave every number finite. Triangles: y has the order of a state, as in
 * weft_force_fn. */
typedef bool weft_correct_fn(void *ctx, double t, double h, double *y);

/* The caller's own force: adds [N] to f[3 N], planes fx fy fz, at t [s] in the state
 * y[6 N]. A force on a pinned particle has no effect. Returns, as weft_rhs_fn does, 0;
 * > 0 if y is unusable and a smaller step may help; < 0 to end the run, which then
 * fails with WEFT_STOPPED. A force that is not finite fails the step, and
 * weft_sim_failure names the particle.
 *
 * If the cloth is a mesh, vertex v of its file has the place i =
 * weft_cloth_index(cloth, v) of each plane: y[i], y[N + i], y[2 N + i] is its position,
 * f[i], f[N + i], f[2 N + i] the force on it. Compute the places once, from the
 * definition's cloth, and hand them over in ctx: examples/pillow.c.
 *
 * Called in every evaluation of the right-hand side, many times per step, also for
 * rejected attempts, in the thread that steps. It must be a function of (t, y) alone,
 * so that a run gives the same bits again, and smooth where the order of a method
 * matters. Some methods call it up to 0.7 steps before the step or 0.3 steps after it:
 * docs/reference/integrators.md, "Stages outside of the step". */
typedef int weft_force_fn(void *ctx, double t, const double *y, double *f);

/* A function of a state y[6 N] at t [s] alone whose fall from > 0 to <= 0 is an event;
 * `cloth` is the one of weft_sim_cloth. Called after every accepted step and for states
 * at 8 points within it, or more (docs/theory/model.md), so that a fall and a rise
 * within one step count, in the thread that steps; NaN is no event. In bands it is
 * called on all of them alike, each with its own cloth and state, ghosts included, and
 * the smallest number that they return counts; NaN counts if it is all there is. So a
 * minimum over particles needs nothing more. A sum is one over own rows
 * (weft_cloth_band), then over all bands through their comm, which it may call. */
typedef double weft_event_fn(void *ctx, const weft_cloth *cloth, double t,
                             const double *y);

/* A number of the definition by which a simulation is differentiated: two cloths with
 * less and more of it, which must outlive the simulation and differ from its cloth in
 * that parameter alone, by some 2e-7 of it. Fixed for ever. */
typedef struct weft_parameter {
    const char *name; /* in messages */
    const weft_cloth *less, *more;
    double
        span; /* > 0: of the parameter between the two, in the unit u of
                 s = u dy/dp; u = p, that with respect to log p: 2 d for p (1 +- d) */
} weft_parameter;

enum { WEFT_SENSITIVITIES = 16 }; /* the most */

/* The sensitivities s = u dy/dp of the state with respect to parameters p. Each follows
 * s' = J s + u df/dp by the method of the simulation, with the state: the derivative of
 * the discrete map in fixed steps, of the map with its steps held in adaptive ones. */
typedef struct weft_sensitivity_def {
    size_t count; /* 1 to WEFT_SENSITIVITIES */
    const weft_parameter *parameters;
    bool control; /* s takes part in error control, at the tolerances of the state.
                     false: the steps and the state are those without; not with the rms
                     norm */
} weft_sensitivity_def;

/* No callback -- those below, `log`, `put`, `get` and `tell` -- may call a function
 * that changes or saves the simulation: that function then returns WEFT_INVALID. Those
 * of weft_play may, as it says. None may destroy it. All callbacks must return. After
 * an exit by an exception or by longjmp, these functions return WEFT_INVALID for ever;
 * weft_sim_destroy then frees it. */
typedef struct weft_sim_def {
    uint32_t struct_size;
    const weft_cloth *cloth;         /* must outlive the simulation */
    const weft_stepper_type *method; /* likewise */
    union {
        weft_stepper_config config;     /* and likewise what it points to */
        unsigned char config_room[256]; /* it may grow so far */
    };
    weft_correct_fn *correct; /* NULL: none; called after the limit */
    void *correct_ctx;
    bool
        ledger; /* keep the energy balance; the method needs WEFT_STEPPER_QUADRATURES */
    weft_limit_def limit; /* a correction after every accepted step; default: none */
    weft_force_fn *force; /* NULL: none; called after all forces of the cloth */
    void *force_ctx;
    weft_log log;
    const weft_allocator *allocator; /* also for the integrator; NULL: malloc's */
    weft_stop_fn *stop; /* NULL: none. Asked before every evaluation of the right-hand
                           side: the step then fails with WEFT_STOPPED, the state and
                           the time are those before the step, and a later step may
                           continue. The method determines how often a step evaluates:
                           methods with dense matrices may factorise for minutes in
                           between. Also asked while weft_sim_create relaxes a start */
    void *stop_ctx;
    const weft_comm *comm; /* joins the bands of a cloth, and must outlive the
                              simulation; the cloth is this band. NULL: it is whole */
    bool interpolate; /* keep what weft_sim_between needs: some 8 states. weft_sim_play
                   then takes frames from within steps. Not with a limit or `correct` */
    weft_event_fn *event; /* NULL: none. Not with a limit or `correct` */
    void *event_ctx;
    double event_hold; /* [s] > 0: the event is when the function has been 0 or below
                          for so long; that it was so at the start counts. Saved. 0:
                          when it falls to 0, as weft_event_fn says */
    const weft_sensitivity_def *sensitivity; /* NULL: none. One-step methods;
                          not with a limit, `correct`, `force`, `event`, `ledger`,
                          `interpolate`, a comm or an untangled start: WEFT_UNSUPPORTED.
                          Then no function may change state, pins, wind or shapes */
    const double *start; /* [m, m/s] y[6 N] at t = 0 instead of weft_cloth_start, which
                            is then not relaxed either; copied. Pins are at their
                            places. For a start that you relaxed yourself, or a
                            simulation that you restore. Not with a sensitivity */
} weft_sim_def;

/* One cloth in bands (weft/comm.h, docs/guides/embed.md): each band has a simulation,
 * with the same definition but for its cloth (weft_cloth_def.band_first, band_rows,
 * from weft_comm_band) and its comm. The bits are those of the whole cloth on any
 * number of bands.
 *
 * These functions are collective -- all bands call them in the same order with the same
 * arguments -- and return the same to all, about the whole cloth, with its indices:
 * weft_sim_create, step, advance, play, between, restart, save, restore, measure,
 * `ledger`, totals, stiffness and shape_load. So is weft_sim_failure after them. The
 * state, positions, velocities and weft_sim_cloth have the rows of the band, which
 * weft_cloth_band describes. Callbacks of weft_play must return the same on all bands;
 * a `stop` of one stops all.
 *
 * WEFT_UNSUPPORTED: methods without WEFT_STEPPER_DISTRIBUTED, a strain limit,
 * `correct`, `force`; functions that change the state, pins or shapes. */

/* All energy gained and lost since t = 0, in [J]. Without `ledger` in the definition
 * only `energy` is filled, and the rest is 0. */
typedef struct weft_ledger {
    bool kept;
    weft_energy energy; /* at present */
    double dissipated_springs, dissipated_drag;
    double work_wind, work_pins; /* done on the cloth: may be negative */
    double work_limit;           /* added by the strain limit */
    double work_outside; /* added by `correct`, weft_sim_set_state, changes of pins and
                            shapes */
    double residual;     /* energy - energy at t = 0 + dissipated - work: 0 but for the
                            errors of the integration */
    double work_force;   /* done on the free particles by `force` */
    double dissipated_contact, dissipated_friction;
    double shape_work; /* done by moving shapes */
} weft_ledger;

/* The members that integrate a power, as X(member, power, by): `by` says who does the
 * work, and is "" for heat. For example, to print them all:
 *
 *     #define PRINT(member, power, by) printf("%s: %g J\n", #member, ledger.member);
 *     WEFT_LEDGER_POWERS(PRINT) WEFT_LEDGER_LATER_POWERS(PRINT)
 *
 * series.csv has the columns of the second list after those of contact; a new member
 * goes to its end. */
#define WEFT_LEDGER_POWERS(X)                                                          \
    X(dissipated_springs, WEFT_POWER_SPRINGS, "")                                      \
    X(dissipated_drag, WEFT_POWER_DRAG, "")                                            \
    X(work_wind, WEFT_POWER_WIND, "wind")                                              \
    X(work_pins, WEFT_POWER_PINS, "pins")
#define WEFT_LEDGER_LATER_POWERS(X)                                                    \
    X(dissipated_contact, WEFT_POWER_CONTACT, "")                                      \
    X(dissipated_friction, WEFT_POWER_FRICTION, "")                                    \
    X(shape_work, WEFT_POWER_SHAPES, "shapes")

/* Counts of the strain limit since t = 0. */
typedef struct weft_limit_stats {
    uint64_t corrected;   /* steps with a spring to shorten */
    uint64_t sweeps;      /* passes in all these steps */
    uint64_t unconverged; /* steps that left a limited spring beyond its bound, with its
                             tolerance: for want of sweeps, for contact, which held the
                             correction back, or by the forces of a step with bridson,
                             which corrects velocities */
} weft_limit_stats;

/** Returns a definition without cloth and method, which must be set. Its configuration
 * is that of weft_stepper_config_default. Its strain limit has no method, and otherwise
 * the default values of a scene: strain 0.1, stretch and shear, 100 sweeps, tolerance
 * 1e-3, velocities updated, fast.
 * @return the defaults, with struct_size set
 * @par Example
 * @snippet minimal.c create */
WEFT_DEFAULT(weft_sim_def)

/** Creates a simulation at t = 0, in the state of weft_cloth_start or
 * weft_sim_def.start. With weft_cloth_def.untangle it first relaxes a start that
 * intersects itself.
 * @param def copied; its cloth, method and comm must outlive the simulation
 * @param[out] out the simulation, for weft_sim_destroy; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (a value is out of range: the message names it),
 *   WEFT_NO_MEMORY, WEFT_UNSUPPORTED (the method does not support the configuration),
 *   WEFT_BAD_PLUGIN (the method lacks a function, or has another abi), and what
 *   weft_cloth_untangle returns
 * @par Example
 * @snippet minimal.c create */
WEFT_API weft_status weft_sim_create(const weft_sim_def *def, weft_sim **out,
                                     weft_error *err);

/** Destroys a simulation. Not from one of its callbacks.
 * @param sim may be NULL */
WEFT_API void weft_sim_destroy(weft_sim *sim);

/** Takes one accepted step towards a time, and never past it. After a failure the state
 * and the time are those of the last good step, and weft_sim_failure describes it;
 * change something, or call again.
 *
 * If a free particle may have entered or passed a collider, or the cloth itself, the
 * step is rejected and repeated with half its length. A strain limit is kept out of
 * colliders: it then corrects a particle by less.
 * @param sim used by no other thread meanwhile; not from a callback
 * @param t_end [s] > weft_sim_time()
 * @param[out] err may be NULL; its message gives the time and the reason
 * @return WEFT_OK; WEFT_STEP_TOO_SMALL (error control or a collider needs less than
 *   min_step, or less than fixed_step / 1024), WEFT_NOT_FINITE, WEFT_STOPPED (`stop`,
 *   or `force` returned < 0), WEFT_SOLVER (the wrapped library failed), WEFT_NO_MEMORY,
 *   WEFT_INVALID (t_end is not later; called from a callback; `correct` left a particle
 *   in a collider or an intersection; with weft_cloth_def.strict, cloth passes through
 *   a collider)
 * @par Example
 * @snippet frames.c step */
WEFT_API weft_status weft_sim_step(weft_sim *sim, double t_end, weft_error *err);

/** Steps until the time is exactly t_end, or an event ends a step. Compute t_end as i /
 * fps: a sum of 1 / fps accumulates roundoff. Takes no step if t_end is the present
 * time.
 * @param sim used by no other thread meanwhile; not from a callback
 * @param t_end [s] >= weft_sim_time()
 * @param[out] err may be NULL
 * @return WEFT_OK; as weft_sim_step: WEFT_STEP_TOO_SMALL, WEFT_NOT_FINITE,
 *   WEFT_STOPPED, WEFT_SOLVER, WEFT_NO_MEMORY, WEFT_INVALID
 * @par Example
 * @snippet minimal.c advance */
WEFT_API weft_status weft_sim_advance(weft_sim *sim, double t_end, weft_error *err);

/** Returns whether an event ended the last step. The step was then repeated so that it
 * ends where the event function falls to 0, to 1e-10 s, and the function is 0 or below
 * in the state; a multistep method starts again there.
 * @param sim used by no other thread meanwhile
 * @return whether the present time is that of an event
 * @par Example
 * @snippet frames.c event */
WEFT_API bool weft_sim_event(const weft_sim *sim);

/** Computes the state at a time within the last step, or at its end, with an order of
 * at least that of the method less one, up to 7 (docs/theory/model.md). The first call
 * after a step costs force evaluations: 2, and up to 10 for methods of high order;
 * weft_sim_stats counts them.
 * @param sim with `interpolate` or an event; used by no other thread meanwhile
 * @param t [s] from the start of the last step to its end
 * @param[out] y a state, 6 N doubles
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (without `interpolate`; t is elsewhere; the state was
 *   changed since the step), WEFT_STOPPED, WEFT_NOT_FINITE
 * @par Example
 * @snippet frames.c between */
WEFT_API weft_status weft_sim_between(weft_sim *sim, double t, double *y,
                                      weft_error *err);

/** Returns whether the present frame is from within a step: only then, in the `frame`
 * callback of weft_sim_play, all queries return the interpolated state, and nothing may
 * change the simulation.
 * @param sim of the callback
 * @return whether it is */
WEFT_API bool weft_sim_is_between(const weft_sim *sim);

/* When a run ends before its duration: a quantity that comes to a bound. */
typedef enum weft_stop_quantity {
    WEFT_STOP_NEVER,
    WEFT_STOP_STRAIN,  /* the largest strain rises to the bound */
    WEFT_STOP_GAP,     /* the smallest gap to a shape falls to it [m] */
    WEFT_STOP_KINETIC, /* the kinetic energy falls to it [J] */
    WEFT_STOP_REST, /* the kinetic energy falls to this part of the work of gravity on
                       the free particles since the start, of either sign */
    WEFT_STOPS      /* their number */
} weft_stop_quantity;

/* Fixed for ever. */
typedef struct weft_stop_def {
    weft_stop_quantity quantity;
    double bound;
    double hold; /* [s] for weft_sim_def.event_hold */
} weft_stop_def;

/** Names a quantity as series.csv and scenes do.
 * @param quantity any value
 * @return static text: "max_strain", "min_gap", "kinetic" or "at_rest"; "" for
 *   WEFT_STOP_NEVER */
WEFT_API const char *weft_stop_name(weft_stop_quantity quantity);

/** Computes how far a state is from the bound at which a run ends. It is a
 * weft_event_fn, for weft_sim_def.event.
 * @param stop the weft_stop_def, which stays as it is
 * @param cloth the cloth of the simulation
 * @param t [s]
 * @param y a state, 6 N doubles
 * @return > 0 until the bound is reached, then <= 0, in the unit of the quantity
 * @par Example
 * @snippet frames.c stop */
WEFT_API double weft_stop_event(void *stop, const weft_cloth *cloth, double t,
                                const double *y);

/* A run in frames: frame i is at i / fps [s], the last one at `duration`. Of a caller's
 * own, no function ever reads beyond `interpolate`; a scene's may grow behind it. */
typedef struct weft_run_def {
    double duration;   /* [s] > 0 */
    double fps;        /* [1/s] > 0, finite */
    size_t threads;    /* >= 1, of a scene: weft_sim_play takes those of the config */
    size_t checkpoint; /* frames between checkpoints; 0: none */
    bool interpolate;  /* of a scene: frames from within steps, which they do not cut */
    weft_stop_def stop;   /* of a scene: weft_stop_event is its event */
    bool keep_checkpoint; /* of a scene: the last one, when the run is done */
} weft_run_def;

/** Computes the index of the last frame, which is at the end of the run.
 * @param run its duration and fps
 * @return >= 1
 * @par Example
 * @snippet frames.c play */
WEFT_API size_t weft_run_last_frame(const weft_run_def *run);

/** Computes the time of a frame: i / fps, and for the last one the duration.
 * @param run its duration and fps
 * @param i <= weft_run_last_frame()
 * @return [s] */
WEFT_API double weft_run_frame_time(const weft_run_def *run, size_t i);

/** Computes the fixed step, of at most h, that divides a frame evenly, so that no short
 * step is left at its end: frame / ceil(frame / h - 1e-9) with frame = 1 / fps, or the
 * duration if that is less. With run->interpolate it is h, because then no frame cuts a
 * step.
 * @param run its duration, fps and interpolate
 * @param h [s] > 0
 * @return [s] <= h */
WEFT_API double weft_run_step(const weft_run_def *run, double h);

/* Its callbacks are called between two steps: they may change pins, shapes and the
 * state, restart and save, but not step or restore. Nothing may change from `frame` if
 * weft_sim_is_between, and from `step` with `interpolate`, because frames within the
 * last step are still to come. What they may not do returns WEFT_INVALID. */
typedef struct weft_play {
    const weft_run_def *run;
    size_t first, last; /* frames; the time is at most that of `first` */
    /* At the time of frame i. Anything but WEFT_OK ends the call. */
    weft_status (*frame)(void *ctx, size_t i, weft_error *err);
    /* After each frame that run->checkpoint names but the last: must call weft_sim_save
     * or weft_sim_restart. NULL: weft_sim_restart is called. */
    weft_status (*checkpoint)(void *ctx, size_t i, weft_error *err);
    bool (*step)(void *ctx); /* after each step; false: WEFT_STOPPED. NULL: none */
    void *ctx;
} weft_play;

/** @copydoc weft_sim_play
 * @param size [bytes] sizeof(weft_play) of the caller, which weft_sim_play passes */
WEFT_API weft_status weft_sim_play_sized(weft_sim *sim, const weft_play *play,
                                         size_t size, weft_error *err);

/** Steps from frame to frame and calls a function at each, as `weft run` does. With
 * `interpolate` no frame cuts a step, up to the next checkpoint. An event is the last
 * frame, at its own time. A checkpoint restarts the integrator, which changes results:
 * by this function a run has the same bits whether its checkpoints are written or not.
 * @param sim at most at the time of frame play->first; used by no other thread
 *   meanwhile
 * @param play the run, the range of frames and the callbacks, which are called in this
 *   thread
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no run or frame callback; fps or duration is not
 *   finite or not > 0), WEFT_STOPPED (`step` returned false), and what weft_sim_step
 *   and the callbacks return
 * @par Example
 * @snippet frames.c play */
static inline weft_status weft_sim_play(weft_sim *sim, const weft_play *play,
                                        weft_error *err)
{
    return weft_sim_play_sized(sim, play, sizeof *play, err);
}

/** Looks for cloth that passes through a collider between its particles, and logs the
 * first that it finds in a run as a warning (weft_cloth_passages). weft_sim_play calls
 * it at each frame, weft_sim_advance at its end, and weft_sim_step before a step and
 * within it, as often as the speed of the cloth demands.
 * @param sim used by no other thread meanwhile
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID if weft_cloth_def.strict makes it an error: the state
 *   then is the one before or after the step */
WEFT_API weft_status weft_sim_check_frame(weft_sim *sim, weft_error *err);

/* Why a step failed, and the last good state, or the one that a correction spoiled. */
typedef struct weft_failure {
    weft_status status;
    double time;        /* [s] */
    double last_step;   /* [s] the one before; 0: none */
    weft_spring spring; /* the most strained; p == q: there are no springs */
    size_t particle;    /* the fastest */
    double position[3]; /* [m] of that particle */
    double speed;       /* [m/s] of that particle */
    double energy;      /* [J] the sum of all energies */
    char reason[512];   /* the integrator's own message, without the time */
    bool contact;       /* whether a shape is the reason, that is in the way of
                           gap_particle; else the fields below are 0 */
    size_t gap_particle, gap_shape;
    double gap;                  /* [m] after the last attempt, or correction */
    double gap_step;             /* [s] length of that attempt */
    weft_primitive self_pair[2]; /* two primitives of the cloth that are the reason,
                           with the gap above; count 0: they are not */
    bool held_by_contact; /* if no step was short enough: whether contact is stiffer
                           than all else, with gap_particle and gap_shape or self_pair
                           nearest; looser tolerances do not help then */
    size_t other_shape;   /* another shape that is nearer than the thickness; gap_shape:
                           there is none */
    double other_gap;     /* [m] of the nearest particle to it */
    char held[320];       /* what holds the step, in words; empty: not looked for */
    bool force; /* whether weft_sim_def.force is the reason: what it added to the free
                   particle force_particle is not finite; else the fields below are 0 */
    size_t force_particle;
    double added[3]; /* [N] to that particle */
} weft_failure;

/** @copydoc weft_sim_failure
 * @param size [bytes] sizeof(weft_failure) of the caller, which weft_sim_failure passes
 */
WEFT_API bool weft_sim_failure_sized(const weft_sim *sim, weft_failure *out,
                                     size_t size);

/** Describes why the last step failed; the message of weft_sim_step says the same in
 * words.
 * @param sim used by no other thread meanwhile
 * @param[out] out filled if the last step failed, else unchanged
 * @return whether the last step failed
 * @par Example
 * @snippet frames.c failure */
static inline bool weft_sim_failure(const weft_sim *sim, weft_failure *out)
{
    return weft_sim_failure_sized(sim, out, sizeof *out);
}

/** Returns the present time.
 * @param sim any thread may read it between two steps
 * @return [s] from 0 */
WEFT_API double weft_sim_time(const weft_sim *sim);

/** Returns the present state: planes x[N] y[N] z[N] [m], then vx[N] vy[N] vz[N] [m/s],
 * for N particles. On a mesh, vertex v is at place weft_cloth_index(cloth, v) of each
 * plane.
 * @param sim its address is the same in every call
 * @return 6 N doubles, valid until the next step; the caller may not write to them
 * @par Example
 * @snippet own_force.c balance */
WEFT_API const double *weft_sim_state(const weft_sim *sim);

/** Returns the sensitivity u dy/dp of the state with respect to a parameter [m], [m/s]
 * per unit of its span.
 * @param sim with weft_sim_def.sensitivity
 * @param number 0, 1, ...: the index of the parameter in the definition
 * @return 6 N doubles, planes as the state, valid until the next step; NULL: there is
 *   no such parameter */
WEFT_API const double *weft_sim_sensitivity(const weft_sim *sim, size_t number);

/** Returns the definition's cloth with the present pins, colliders and wind of the
 * simulation, for the functions of weft/cloth.h.
 * @param sim the simulation, which owns the cloth
 * @return valid until the simulation is destroyed
 * @par Example
 * @snippet dragged_sphere.c load */
WEFT_API const weft_cloth *weft_sim_cloth(const weft_sim *sim);

/** Returns the integrator's counts since t = 0.
 * @param sim used by no other thread meanwhile
 * @return steps, rejected steps, force evaluations, ...
 * @par Example
 * @snippet frames.c stats */
WEFT_RESULT(weft_stepper_stats, weft_sim_stats, (const weft_sim *sim), (sim))

/** Reports each choice of the integrator beyond its configuration.
 * @param sim used by no other thread meanwhile
 * @param tell called with each name and value, as text
 * @param ctx passed to tell */
WEFT_API void weft_sim_options(const weft_sim *sim, weft_option_fn *tell, void *ctx);

/** Returns the energy that springs, air drag, contact and friction have turned into
 * heat so far: the sum of dissipated_... of weft_ledger.
 * @param sim with `weft_sim_def.ledger`
 * @return [J]; NaN without it */
WEFT_API double weft_sim_dissipated(const weft_sim *sim);

/** Returns the energy balance. The method integrates the powers of weft_cloth_power
 * with the state, so that the residual has its order; state and steps are the same
 * without it.
 * @param sim used by no other thread meanwhile
 * @return all members [J]; without `weft_sim_def.ledger` only `energy`, and the rest 0
 * @par Example
 * @snippet own_force.c balance */
WEFT_RESULT(weft_ledger, weft_sim_ledger, (const weft_sim *sim), (sim))

/** Measures the present state, on the threads of the simulation.
 * @param sim used by no other thread meanwhile
 * @return energies, momenta, gaps, hash ...; without `weft_sim_def.ledger` the powers
 *   are 0: weft_cloth_power computes them
 * @par Example
 * @snippet adaptive.c play */
WEFT_RESULT(weft_measures, weft_sim_measure, (const weft_sim *sim), (sim))

/* What the whole cloth has, over all bands. */
typedef struct weft_totals {
    size_t particles, pins, springs[WEFT_FAMILIES];
    double mass; /* [kg] */
} weft_totals;

/** Counts what the whole cloth has: weft_cloth_pins, weft_cloth_springs and
 * weft_cloth_mass, over all bands.
 * @param sim used by no other thread meanwhile
 * @return the counts, and the mass [kg] */
WEFT_RESULT(weft_totals, weft_sim_totals, (const weft_sim *sim), (sim))

/** Computes weft_cloth_stiffness of the whole cloth, over all bands, with the present
 * pins and colliders.
 * @param sim used by no other thread meanwhile
 * @param t [s]
 * @param y a state, as weft_sim_state; NULL: bounds for any state
 * @return the bounds; not finite if y is not */
WEFT_API weft_stiffness weft_sim_stiffness(const weft_sim *sim, double t,
                                           const double *y);

/** Counts the rolled-back steps: a step was rejected and repeated with half its length
 * because a free particle was in a collider or may have passed it, because the cloth
 * may have passed through itself, or because in fixed steps a stage was in a collider.
 * weft_sim_stats counts them as rejected, except those that such a stage ended.
 * @param sim used by no other thread meanwhile
 * @return their number since t = 0 */
WEFT_API uint64_t weft_sim_vetoed(const weft_sim *sim);

/** Returns whether weft_sim_check_frame has found cloth that passes through a collider.
 * @param sim used by no other thread meanwhile
 * @return whether it has, since t = 0 */
WEFT_API bool weft_sim_passed(const weft_sim *sim);

/** Counts what the strain limit did since t = 0.
 * @param sim used by no other thread meanwhile
 * @return the counts; all 0 without a limit */
WEFT_RESULT(weft_limit_stats, weft_sim_limit_stats, (const weft_sim *sim), (sim))

/** Finds the limited spring with the largest strain at present, as
 * weft_cloth_worst_spring does.
 * @param sim used by no other thread meanwhile
 * @return the spring; strain 0 and p = q = 0 if there is none */
WEFT_API weft_spring weft_sim_limit_worst(const weft_sim *sim);

/** Counts the limited springs that are too long at present and have both ends pinned:
 * they cannot be corrected, and do not count as unconverged.
 * @param sim used by no other thread meanwhile
 * @return their number */
WEFT_API size_t weft_sim_limit_held(const weft_sim *sim);

/** Copies the positions. Particle (r, c) of a grid is r * cols + c, vertex v of a mesh
 * is v.
 * @param sim used by no other thread meanwhile
 * @param[out] xyz [m] x y z of particle 0, x y z of particle 1, ...: 3 N doubles
 * @par Example
 * @snippet minimal.c advance */
WEFT_API void weft_sim_positions(const weft_sim *sim, double *xyz);

/** Copies the velocities, in the order of weft_sim_positions.
 * @param sim used by no other thread meanwhile
 * @param[out] xyz [m/s] x y z of particle 0, ...: 3 N doubles
 * @par Example
 * @snippet frames.c set */
WEFT_API void weft_sim_velocities(const weft_sim *sim, double *xyz);

/** Fills a vertex buffer: for each particle its position, and its unit normal along the
 * sum of the normals of its triangles (weft_cloth_triangles) by their areas, or 0 0 0
 * if that is 0. Allocates nothing.
 * @param sim used by no other thread meanwhile
 * @param[out] positions [m] three floats for particle 0; NULL: not wanted
 * @param[out] normals three floats for particle 0; NULL: not wanted
 * @param stride [bytes] from one particle's three floats to the next one's; 0: 12
 * @par Example
 * @snippet window.c vertices */
WEFT_API void weft_sim_vertices(const weft_sim *sim, float *positions, float *normals,
                                size_t stride);

/** Replaces the positions and velocities of the free particles; pinned particles keep
 * theirs. The change of the energy is work_outside in the energy balance.
 * @param sim between two steps
 * @param positions [m] x y z of particle 0, ...: 3 N doubles; NULL: they stay
 * @param velocities [m/s] likewise; NULL: they stay
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (a value is not finite, a free particle would be in a
 *   collider, or with contact.self the cloth would intersect or touch itself),
 *   WEFT_UNSUPPORTED (in bands or with sensitivities); on failure nothing changes
 * @par Example
 * @snippet frames.c set */
WEFT_API weft_status weft_sim_set_state(weft_sim *sim, const double *positions,
                                        const double *velocities, weft_error *err);

/** Pins a particle where it is, and moves it at a constant velocity from now on. A
 * particle that is already pinned gets this motion instead of its own. To reach x at
 * the time t of the next frame, use velocity = (x - position) / (t - time). Only this
 * simulation changes, not its definition's cloth. Cost O(N).
 * @param sim between two steps
 * @param i r * cols + c on a grid, the vertex index on a mesh
 * @param velocity [m/s]; NULL keeps the particle in its place, bit for bit
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such particle, velocity is not finite),
 *   WEFT_UNSUPPORTED (in bands or with sensitivities); on failure nothing changes
 * @par Example
 * @snippet game_loop.c drag */
WEFT_API weft_status weft_sim_pin(weft_sim *sim, size_t i, const double velocity[3],
                                  weft_error *err);

/** Pins several particles as weft_sim_pin does; it costs little more than one. If a
 * particle has several entries, the last one counts.
 * @param sim between two steps
 * @param particles their indices
 * @param velocities [m/s] x y z of each entry, 3 count doubles; NULL: all keep their
 *   places
 * @param count the number of entries
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such particle, a velocity is not finite),
 *   WEFT_UNSUPPORTED (in bands or with sensitivities); on failure nothing changes
 * @par Example
 * @snippet frames.c pin many */
WEFT_API weft_status weft_sim_pin_many(weft_sim *sim, const size_t *particles,
                                       const double *velocities, size_t count,
                                       weft_error *err);

/** Moves a pinned particle to another place at once; its velocity stays. A jump
 * stretches springs suddenly: weft_sim_pin with a velocity does not. Cost O(N); with
 * contact.self it searches the cloth as weft_cloth_crossings does.
 * @param sim between two steps
 * @param i as weft_sim_pin
 * @param position [m]
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such particle, it is not pinned, position is NULL
 *   or not finite, or with contact.self the cloth would intersect itself),
 *   WEFT_UNSUPPORTED (in bands or with sensitivities); on failure nothing changes */
WEFT_API weft_status weft_sim_move_pin(weft_sim *sim, size_t i,
                                       const double position[3], weft_error *err);

/** Releases a pinned particle with its present position and velocity; a free particle
 * stays as it is. Cost O(N); with contact.self it searches the cloth as
 * weft_cloth_crossings does.
 * @param sim between two steps
 * @param i as weft_sim_pin
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such particle; it is in a collider or, with
 *   contact.self, in another part of the cloth), WEFT_UNSUPPORTED (in bands or with
 *   sensitivities); on failure nothing changes
 * @par Example
 * @snippet game_loop.c drag */
WEFT_API weft_status weft_sim_unpin(weft_sim *sim, size_t i, weft_error *err);

/** Changes the wind of this simulation from now on, instead of the definition's wind or
 * an earlier change.
 * @param sim between two steps
 * @param velocity [m/s]; NULL: the definition's wind again
 * @param drag [kg/(m^2 s)] >= 0; not used if velocity is NULL
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (a value is not finite, drag < 0), WEFT_UNSUPPORTED (in
 *   bands or with sensitivities); on failure nothing changes
 * @par Example
 * @snippet frames.c wind */
WEFT_API weft_status weft_sim_set_wind(weft_sim *sim, const double velocity[3],
                                       double drag, weft_error *err);

/** @copydoc weft_sim_add_shape
 * @param size [bytes] sizeof(weft_shape) of the caller, which weft_sim_add_shape passes
 */
WEFT_API weft_status weft_sim_add_shape_sized(weft_sim *sim, const weft_shape *shape,
                                              size_t size, size_t *k, weft_error *err);

/** Adds a collider, as the last one, to this simulation. It moves as defined, except
 * that its velocity and the rate of its rotation count from now: at + velocity (t -
 * now) + amplitude sin(2 pi frequency t). The change of the energy is work_outside in
 * the energy balance. Cost O(N).
 * @param sim between two steps
 * @param shape copied; not a mesh: mesh colliders belong to the definition
 * @param[out] k its index; may be NULL
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (an error of its definition, or a free particle would
 *   be in it: the message names both), WEFT_UNSUPPORTED (a mesh; in bands or with
 *   sensitivities), WEFT_NO_MEMORY; on failure nothing changes
 * @par Example
 * @snippet dragged_sphere.c add */
static inline weft_status weft_sim_add_shape(weft_sim *sim, const weft_shape *shape,
                                             size_t *k, weft_error *err)
{
    return weft_sim_add_shape_sized(sim, shape, sizeof *shape, k, err);
}

/** Puts a collider to another place at once, or moves it at a constant velocity from
 * now on. A jump passes whatever is in between, and presses suddenly on particles that
 * it comes near to. To drag a collider, let it reach its place x at the time t of the
 * next frame by velocity = (x - place) / (t - time). Cost O(N).
 * @param sim between two steps
 * @param k < weft_cloth_shapes()
 * @param at [m] its new place; NULL: it stays
 * @param velocity [m/s] instead of its own motion and rotation; NULL: these continue
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such collider, a value is not finite, or a free
 *   particle would be in it), WEFT_UNSUPPORTED (in bands or with sensitivities),
 *   WEFT_NO_MEMORY; on failure nothing changes
 * @par Example
 * @snippet dragged_sphere.c drag */
WEFT_API weft_status weft_sim_move_shape(weft_sim *sim, size_t k, const double at[3],
                                         const double velocity[3], weft_error *err);

/** @copydoc weft_sim_drive_shape
 * @param size [bytes] sizeof(weft_shape) of the caller, which weft_sim_drive_shape
 *   passes */
WEFT_API weft_status weft_sim_drive_shape_sized(weft_sim *sim, size_t k,
                                                const weft_shape *as, size_t size,
                                                weft_error *err);

/** Gives a collider another motion from now on, from where it is and as it stands: by
 * the velocity, amplitude, frequency and turn of another shape. The angle rate (t -
 * now) + amplitude sin(2 pi frequency t) of the turn counts from the present one, and
 * its axis is now at turn.about. Cost O(N).
 * @param sim between two steps
 * @param k < weft_cloth_shapes()
 * @param as its other members are not used; NULL: the collider stays where it is
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such collider, a value is not finite),
 *   WEFT_UNSUPPORTED (in bands or with sensitivities), WEFT_NO_MEMORY; on failure
 *   nothing changes */
static inline weft_status weft_sim_drive_shape(weft_sim *sim, size_t k,
                                               const weft_shape *as, weft_error *err)
{
    return weft_sim_drive_shape_sized(sim, k, as, sizeof *as, err);
}

/** Removes a collider; those behind it get the next lower indices. Cost O(N).
 * @param sim between two steps
 * @param k < weft_cloth_shapes()
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such collider), WEFT_UNSUPPORTED (a mesh; in bands
 *   or with sensitivities), WEFT_NO_MEMORY; on failure nothing changes
 * @par Example
 * @snippet dragged_sphere.c remove */
WEFT_API weft_status weft_sim_remove_shape(weft_sim *sim, size_t k, weft_error *err);

/** Computes the force and the torque of the cloth on a collider at present, as
 * weft_cloth_shape_load does, over all bands.
 * @param sim used by no other thread meanwhile
 * @param k < weft_cloth_shapes()
 * @param[out] force [N]
 * @param[out] torque [N m] about its `at`
 * @par Example
 * @snippet dragged_sphere.c load */
WEFT_API void weft_sim_shape_load(const weft_sim *sim, size_t k, double force[3],
                                  double torque[3]);

/** Starts the integrator again from the present state, with the step that it would try
 * next. All counts continue, and nothing else of its past remains, whatever the method.
 * Call it after you changed data that `force` uses.
 * @param sim between two steps
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (called from a callback), WEFT_NO_MEMORY; on failure
 *   nothing changes */
WEFT_API weft_status weft_sim_restart(weft_sim *sim, weft_error *err);

/** Computes how many bytes weft_sim_save writes. The number changes only with the
 * number of colliders.
 * @param sim used by no other thread meanwhile
 * @return [bytes]
 * @par Example
 * @snippet adaptive.c save */
WEFT_API size_t weft_sim_save_size(const weft_sim *sim);

/** Saves all data that the future of a simulation depends on: state, time, next step,
 * counts, energy balance, strain limit, pins, colliders and a changed wind; data of
 * `correct` and `force` are the caller's. It restarts the integrator, so that this
 * simulation and a restored one continue identically to the last bit. The bytes contain
 * their version and a checksum. In bands they are those of the whole cloth, and only
 * band 0 gets them; any other number of bands can restore them.
 * @param sim between two steps
 * @param[out] bytes receives weft_sim_save_size() bytes; in bands not used but on band
 *   0
 * @param size [bytes] of `bytes`
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (size is less, or called from a callback),
 *   WEFT_NOT_FINITE (the energy balance, or the state that `correct` left, is not
 *   finite), WEFT_NO_MEMORY; on failure nothing changes
 * @par Example
 * @snippet adaptive.c save */
WEFT_API weft_status weft_sim_save(weft_sim *sim, void *bytes, size_t size,
                                   weft_error *err);

/* The same bytes in parts: calls put with each of them and its place [bytes], in any
 * order, together weft_sim_save_size. In bands each band's put gets the band's own
 * rows, and band 0's the rest; all bands make the same number of calls, in the same
 * order, some with size 0, and also after one that failed. Needs memory for 16 bytes
 * per particle of the band. Errors: the first that put returns, on any band, with the
 * error that it set; those of weft_sim_save. */
typedef weft_status weft_save_put(void *ctx, uint64_t at, const void *bytes,
                                  size_t size, weft_error *err);

/** Saves as weft_sim_save does, in parts, which a caller can write to a file. Needs
 * memory for 16 bytes per particle of the band. In bands each band's `put` gets the
 * band's own rows, and band 0's the rest; all bands make the same number of calls, in
 * the same order, some with size 0, and also after one that failed.
 * @param sim between two steps
 * @param put called with each part and its place; together they are
 *   weft_sim_save_size() bytes, in any order
 * @param ctx passed to put
 * @param[out] err may be NULL
 * @return WEFT_OK; the first status that put returns, on any band, with the error that
 *   it set; WEFT_INVALID, WEFT_NOT_FINITE and WEFT_NO_MEMORY as weft_sim_save */
WEFT_API weft_status weft_sim_save_parts(weft_sim *sim, weft_save_put *put, void *ctx,
                                         weft_error *err);

/** Puts a simulation where a saved one of the same definition was. Both then continue
 * identically to the last bit, in any program, on any machine. Threads, allocators and
 * log may differ; all other settings that matter are compared by hashes. In bands all
 * of them need the bytes, of which they read the checksum and their own rows.
 * @param sim between two steps
 * @param bytes what weft_sim_save wrote
 * @param size [bytes] of `bytes`
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID with the reason (not a saved simulation; damaged or cut
 *   off; of another version, grid, cloth, method or settings; with or without an energy
 *   balance unlike this one; not finite), WEFT_NO_MEMORY; on failure nothing changes
 * @par Example
 * @snippet adaptive.c restore */
WEFT_API weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                                      weft_error *err);

/* The same from `size` bytes of which get copies those from a place [bytes] on: always
 * all that it is asked for, which lie within size, or an error. In bands get is asked
 * for the band's own rows and ghosts and what is common to all; the bands' calls do not
 * match. Errors: those of weft_sim_restore and of get. */
typedef weft_status weft_save_get(void *ctx, uint64_t at, void *bytes, size_t size,
                                  weft_error *err);

/** Restores as weft_sim_restore does, from bytes that a function reads. In bands `get`
 * is asked for the band's own rows and ghosts and for what is common to all; the calls
 * of different bands do not match.
 * @param sim between two steps
 * @param get copies bytes from a place on: always all that it is asked for, which lie
 *   within size, or it returns an error
 * @param ctx passed to get
 * @param size [bytes] of the saved simulation
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID and WEFT_NO_MEMORY as weft_sim_restore, and what get
 *   returns; on failure nothing changes */
WEFT_API weft_status weft_sim_restore_parts(weft_sim *sim, weft_save_get *get,
                                            void *ctx, size_t size, weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
