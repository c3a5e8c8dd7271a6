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
 * that number alone, by some 2e-7 of it. Fixed for ever. */
typedef struct weft_parameter {
    const char *name; /* in messages */
    const weft_cloth *less, *more;
    double span; /* > 0: of the number between the two, in the unit u of
                    s = u dy/dp; u = p, the derivative by log p: 2 d for p (1 +- d) */
} weft_parameter;

enum { WEFT_SENSITIVITIES = 16 }; /* the most */

/* The sensitivities s = u dy/dp of the state by numbers p. Each follows
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
    bool ledger; /* keep the energy ledger; the method needs WEFT_STEPPER_QUADRATURES */
    weft_limit_def limit; /* a correction after every accepted step; default: none */
    weft_force_fn *force; /* NULL: none; called after all forces of the cloth */
    void *force_ctx;
    weft_log log;
    const weft_allocator *allocator; /* also for the stepper; NULL: malloc's */
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
                          not with a limit, `correct`, `force`, `event`, a ledger,
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
 * ledger, totals, stiffness and shape_load. So is weft_sim_failure after them. The
 * state, positions, velocities and weft_sim_cloth have the rows of the band, which
 * weft_cloth_band describes. Callbacks of weft_play must return the same on all bands;
 * a `stop` of one stops all.
 *
 * WEFT_UNSUPPORTED: methods without WEFT_STEPPER_DISTRIBUTED, a strain limit,
 * `correct`, `force`; functions that change the state, pins or shapes. */

/* All energy gained and lost since t = 0, in [J]. Without a ledger in the definition
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

/* Counts of the strain limit since t = 0. */
typedef struct weft_limit_stats {
    uint64_t corrected;   /* steps with a spring to shorten */
    uint64_t sweeps;      /* passes in all these steps */
    uint64_t unconverged; /* steps that left a limited spring beyond its bound, with its
                             tolerance: for want of sweeps, for contact, which held the
                             correction back, or by the forces of a step with bridson,
                             which corrects velocities */
} weft_limit_stats;

/* The limit of weft_sim_def_default has no method, and the default values of a scene:
 * strain 0.1, stretch and shear, 100 sweeps, tolerance 1e-3, velocities updated, fast.
 */
WEFT_DEFAULT(weft_sim_def)

/* Starts at t = 0 with weft_cloth_start. Errors: WEFT_INVALID, WEFT_NO_MEMORY,
 * WEFT_UNSUPPORTED (the method does not support the config), WEFT_BAD_PLUGIN (it lacks
 * a function or is of another abi), and those of weft_cloth_untangle. */
WEFT_API weft_status weft_sim_create(const weft_sim_def *def, weft_sim **out,
                                     weft_error *err);
WEFT_API void weft_sim_destroy(weft_sim *sim); /* NULL is allowed */

/* Takes one accepted step towards t_end [s] > time, never past it. After a failure the
 * state and the time are those of the last good step, and weft_sim_failure describes
 * it.
 *
 * With shapes, a step that a free particle may have ended in one or passed through one
 * is taken back and repeated with half its length. WEFT_STEP_TOO_SMALL if that would be
 * below min_step, or below fixed_step / 1024. A strain limit is kept out of shapes by
 * shortening what it does to a particle; if `correct` leaves a particle in a shape,
 * or with contact.self a cloth that passes through itself, the step fails with
 * WEFT_INVALID. */
WEFT_API weft_status weft_sim_step(weft_sim *sim, double t_end, weft_error *err);

/* Steps until the time is exactly t_end [s], or an event; no step if it is t_end
 * already. */
WEFT_API weft_status weft_sim_advance(weft_sim *sim, double t_end, weft_error *err);

/* Whether an event ended the last step. The step was then taken again to end where the
 * event function falls to 0, to 1e-10 s, and is 0 or below in the state; a multistep
 * method starts again there. */
WEFT_API bool weft_sim_event(const weft_sim *sim);

/* Writes the state at t [s], within the last step or at its end, to y[6 N], with an
 * order of at least that of the method less one, up to 7: see docs/theory/model.md.
 * Costs evaluations of the right-hand side once a step: 2, and up to 10 for methods of
 * high order; weft_sim_stats counts them. Errors: WEFT_INVALID (without `interpolate`;
 * t is elsewhere; the state was changed since), WEFT_STOPPED, WEFT_NOT_FINITE. */
WEFT_API weft_status weft_sim_between(weft_sim *sim, double t, double *y,
                                      weft_error *err);

/* Within the frame callback of weft_sim_play: whether the frame is from within a step.
 * All queries then return that state, and nothing may change the simulation. */
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

/* "max_strain", "min_gap" or "kinetic", as in series.csv, or "at_rest"; "" for
 * WEFT_STOP_NEVER. */
WEFT_API const char *weft_stop_name(weft_stop_quantity quantity);

/* The event function of it: how far a state is from the bound, > 0 until then; stop is
 * the weft_stop_def, which it does not change. */
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

WEFT_API size_t weft_run_last_frame(const weft_run_def *run);
WEFT_API double weft_run_frame_time(const weft_run_def *run, size_t i); /* [s] */

/* [s] The fixed step, of at most h [s], that divides a frame evenly, so that no short
 * one is left at its end: frame / ceil(frame / h - 1e-9) with frame = 1 / fps, or the
 * duration if that is less. h itself with run->interpolate: no frame cuts a step. */
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

/* Steps from frame to frame and calls `frame` at each, as `weft run` does; with
 * `interpolate`, steps that no frame cuts, up to the next checkpoint. An event is the
 * last frame, at its own time. A checkpoint restarts the stepper, which changes
 * results: by this function a run has the same bits whether checkpoints are kept or
 * not. Errors: WEFT_INVALID (no run or frame callback, fps or duration not finite or
 * not > 0), those of weft_sim_step and callbacks. */
WEFT_API weft_status weft_sim_play_sized(weft_sim *sim, const weft_play *play,
                                         size_t size, weft_error *err);
static inline weft_status weft_sim_play(weft_sim *sim, const weft_play *play,
                                        weft_error *err)
{
    return weft_sim_play_sized(sim, play, sizeof *play, err);
}

/* Looks for cloth that passes through a shape (weft_cloth_passages), and logs the first
 * that it finds in a run as a warning. weft_sim_play does so at each frame, and
 * weft_sim_advance at its end; weft_sim_step before a step and within it, as often as
 * the speed of the cloth demands. With weft_cloth_def.strict a passage is an error of
 * all of these, WEFT_INVALID, and the state is that before or after the step. */
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
    char reason[512];   /* the stepper's own message, without the time */
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

/* Whether the last step failed; the message of weft_sim_step has the same in words. */
WEFT_API bool weft_sim_failure_sized(const weft_sim *sim, weft_failure *out,
                                     size_t size);
static inline bool weft_sim_failure(const weft_sim *sim, weft_failure *out)
{
    return weft_sim_failure_sized(sim, out, sizeof *out);
}

WEFT_API double weft_sim_time(const weft_sim *sim); /* [s] */
WEFT_API const double *
weft_sim_state(const weft_sim *sim); /* y[6 N], valid until the next step */
/* s = u dy/dp [m], [m/s] per unit of the span, of number 0, 1, ... of the definition's
 * sensitivity: planes as the state, valid until the next step. NULL: there is none. */
WEFT_API const double *weft_sim_sensitivity(const weft_sim *sim, size_t number);
/* The definition's cloth with the present pins, shapes and wind of the simulation.
 * Valid until the simulation is destroyed. */
WEFT_API const weft_cloth *weft_sim_cloth(const weft_sim *sim);
WEFT_RESULT(weft_stepper_stats, weft_sim_stats, (const weft_sim *sim), (sim))
/* Calls `tell` for each choice of the stepper beyond its config. */
WEFT_API void weft_sim_options(const weft_sim *sim, weft_option_fn *tell, void *ctx);
/* [J] turned into heat so far by springs, viscous drag, contact and friction: the sum
 * of dissipated_... in the ledger; NaN without a ledger. */
WEFT_API double weft_sim_dissipated(const weft_sim *sim);

/* The method integrates the powers of weft_cloth_power with the state: the residual has
 * its order. The state and the steps are the same without a ledger. */
WEFT_RESULT(weft_ledger, weft_sim_ledger, (const weft_sim *sim), (sim))

/* Measures the present state, on the threads of the simulation. Without a ledger the
 * powers are 0: weft_cloth_power computes them. */
WEFT_RESULT(weft_measures, weft_sim_measure, (const weft_sim *sim), (sim))

typedef struct weft_totals {
    size_t particles, pins, springs[WEFT_FAMILIES];
    double mass; /* [kg] */
} weft_totals;

/* What weft_cloth_pins, weft_cloth_springs and weft_cloth_mass are of the whole cloth.
 */
WEFT_RESULT(weft_totals, weft_sim_totals, (const weft_sim *sim), (sim))

/* weft_cloth_stiffness of the whole cloth, with the present pins and shapes; y: a state
 * as weft_sim_state, or NULL. */
WEFT_API weft_stiffness weft_sim_stiffness(const weft_sim *sim, double t,
                                           const double *y);

/* How often a step was taken back, and repeated with half its length, because a free
 * particle had got into a shape or may have passed through it, or the cloth through
 * itself, or because in fixed steps a stage was in a shape. In weft_sim_stats, steps
 * taken back count as rejected, but not those that such a stage ended. */
WEFT_API uint64_t weft_sim_vetoed(const weft_sim *sim);

/* Whether cloth that passes through a shape was found (weft_sim_check_frame). */
WEFT_API bool weft_sim_passed(const weft_sim *sim);

/* All 0 without a limit. */
WEFT_RESULT(weft_limit_stats, weft_sim_limit_stats, (const weft_sim *sim), (sim))
/* The limited spring with the largest strain at present, as weft_cloth_worst_spring. */
WEFT_API weft_spring weft_sim_limit_worst(const weft_sim *sim);
/* Limited springs that are too long at present and have both ends pinned: they cannot
 * be corrected, and do not count as unconverged. */
WEFT_API size_t weft_sim_limit_held(const weft_sim *sim);

/* Copies of the state as x y z of particle 0, x y z of particle 1, ...: 3 N doubles. */
WEFT_API void weft_sim_positions(const weft_sim *sim, double *xyz);  /* [m] */
WEFT_API void weft_sim_velocities(const weft_sim *sim, double *xyz); /* [m/s] */

/* For a vertex buffer: the position [m] of each particle as three floats, and its unit
 * normal, along the sum of the normals of its triangles (weft_cloth_triangles) by their
 * areas; 0 0 0 if that is 0. Both begin at the address given (NULL: not wanted), and
 * the next particle's are `stride` bytes behind, 0: 12. Allocates nothing. */
WEFT_API void weft_sim_vertices(const weft_sim *sim, float *positions, float *normals,
                                size_t stride);

/* Replaces the positions [m] and velocities [m/s] of the free particles (NULL: keeps
 * them); pinned particles keep theirs. Errors: WEFT_INVALID if a value is not finite, a
 * free particle would be in a shape or, with contact.self, the cloth would pass through
 * itself or touch (weft_cloth_crossings); then nothing changes. */
WEFT_API weft_status weft_sim_set_state(weft_sim *sim, const double *positions,
                                        const double *velocities, weft_error *err);

/* These functions change pins between two steps, each in O(N); with contact.self those
 * that move or release one search the cloth as weft_cloth_crossings does. Every
 * simulation has its own pins: the definition's cloth, and other simulations that share
 * it, do not change. Particle i of a grid is (i / cols, i % cols), of triangles vertex
 * i. Errors: WEFT_INVALID (no such particle, a number that is not finite); then nothing
 * changes. */

/* Holds a particle at its present position, and moves it from now on at `velocity`
 * [m/s] (NULL: it keeps its position bit for bit). A particle that is already pinned
 * gets this motion instead of its own. To reach x at the time t of the next frame, use
 * velocity = (x - position) / (t - time). */
WEFT_API weft_status weft_sim_pin(weft_sim *sim, size_t i, const double velocity[3],
                                  weft_error *err);

/* The same of `count` particles, particles[j] at velocities[3 j] [m/s] (NULL: all keep
 * their positions), of several entries for one particle the last: it costs little more
 * than one of them. */
WEFT_API weft_status weft_sim_pin_many(weft_sim *sim, const size_t *particles,
                                       const double *velocities, size_t count,
                                       weft_error *err);

/* Moves a pinned particle to `position` [m] at once; its velocity stays. A jump
 * stretches springs suddenly. Errors: WEFT_INVALID also if it is not pinned or, with
 * contact.self, if the cloth would pass through itself. */
WEFT_API weft_status weft_sim_move_pin(weft_sim *sim, size_t i,
                                       const double position[3], weft_error *err);

/* Releases a particle with its present position and velocity. A particle that is not
 * pinned does not change. Errors: WEFT_INVALID also if it is in a shape or, with
 * contact.self, in another part of the cloth. */
WEFT_API weft_status weft_sim_unpin(weft_sim *sim, size_t i, weft_error *err);

/* From now on the wind has this velocity [m/s] and this drag [kg/(m^2 s)] >= 0, instead
 * of the definition's wind or an earlier change; velocity NULL: the definition's again,
 * and drag is not used. Of this simulation alone. Errors: WEFT_INVALID; then nothing
 * changes. */
WEFT_API weft_status weft_sim_set_wind(weft_sim *sim, const double velocity[3],
                                       double drag, weft_error *err);

/* These functions change shapes between two steps, each in O(N). Every simulation has
 * its own shapes, which obey the contact of its cloth: the definition's cloth, and
 * other simulations that share it, do not change. The change of the energy is
 * work_outside in the ledger. Errors: WEFT_INVALID (no such shape, a mistake in its
 * definition, a free particle would be in a shape; the message names both),
 * WEFT_NO_MEMORY; then nothing changes. weft_cloth_shape_pose of weft_sim_cloth returns
 * the present places. */

/* Adds a shape, as the last; *k (unless NULL) is its number. It is not a mesh
 * (WEFT_UNSUPPORTED): these belong to the definition, and are not removed either. From
 * the present time on it moves as defined, except that its velocity and the rate of its
 * turn count from now: at + velocity (t - now) + amplitude sin(2 pi frequency t). */
WEFT_API weft_status weft_sim_add_shape_sized(weft_sim *sim, const weft_shape *shape,
                                              size_t size, size_t *k, weft_error *err);
static inline weft_status weft_sim_add_shape(weft_sim *sim, const weft_shape *shape,
                                             size_t *k, weft_error *err)
{
    return weft_sim_add_shape_sized(sim, shape, sizeof *shape, k, err);
}

/* Puts shape k to `at` [m] at once (NULL: it stays) and moves it from now on at
 * `velocity` [m/s] instead of its own motion and turn (NULL: these continue). A jump
 * passes whatever is in between, and presses suddenly on particles that it comes near
 * to: a shape that is dragged had better reach its place x at the time t of the next
 * frame by velocity = (x - place) / (t - time). */
WEFT_API weft_status weft_sim_move_shape(weft_sim *sim, size_t k, const double at[3],
                                         const double velocity[3], weft_error *err);

/* From now on shape k moves as `as` does, from where it is and as it stands: by its
 * velocity, amplitude, frequency and turn, whose angle rate (t - now) + amplitude
 * sin(2 pi frequency t) counts from the present one and whose axis is now at
 * turn.about. Other members of `as` are not used; NULL: it stays. */
WEFT_API weft_status weft_sim_drive_shape_sized(weft_sim *sim, size_t k,
                                                const weft_shape *as, size_t size,
                                                weft_error *err);
static inline weft_status weft_sim_drive_shape(weft_sim *sim, size_t k,
                                               const weft_shape *as, weft_error *err)
{
    return weft_sim_drive_shape_sized(sim, k, as, sizeof *as, err);
}

/* The shapes behind it get the next lower numbers. */
WEFT_API weft_status weft_sim_remove_shape(weft_sim *sim, size_t k, weft_error *err);

/* weft_cloth_shape_load at present; k < weft_cloth_shapes. */
WEFT_API void weft_sim_shape_load(const weft_sim *sim, size_t k, double force[3],
                                  double torque[3]);

/* Starts the stepper again from the present state, with the h that it would try next;
 * all counts continue. Nothing else of its past remains, whatever the method. On
 * failure (WEFT_NO_MEMORY) nothing changes. */
WEFT_API weft_status weft_sim_restart(weft_sim *sim, weft_error *err);

/* Saves all data that the future of a simulation depends on to the caller's `size`
 * bytes: state, time, next h, counts, ledger, strain limit, pins, shapes and a changed
 * wind. Restored
 * into a simulation of the same definition, by any program on any machine, both
 * continue identically to the last bit, because saving also restarts the stepper here.
 * Threads, allocators and log may differ; all other settings that matter are compared
 * by hashes. The caller must save the data of `correct` and `force`. The bytes contain
 * their version and a checksum; their number, weft_sim_save_size, changes only with the
 * number of shapes. Errors: WEFT_INVALID (size is less), WEFT_NOT_FINITE (the ledger,
 * or the state that `correct` left, is not finite; then nothing changes), those of
 * weft_sim_restart.
 *
 * In bands the bytes are those of the whole cloth, as without bands, and only band 0
 * gets them; `bytes` of the others is ignored. They can be restored on any other number
 * of bands. */
WEFT_API size_t weft_sim_save_size(const weft_sim *sim);
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
WEFT_API weft_status weft_sim_save_parts(weft_sim *sim, weft_save_put *put, void *ctx,
                                         weft_error *err);

/* Errors: WEFT_INVALID with the reason (not a saved simulation, damaged or cut off, of
 * another version, grid or method, with or without a ledger unlike this one, of another
 * cloth or other settings, not finite), WEFT_NO_MEMORY. Then nothing changes. In bands
 * all need the bytes, of which they read the checksum and their own rows. */
WEFT_API weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                                      weft_error *err);

/* The same from `size` bytes of which get copies those from a place [bytes] on: always
 * all that it is asked for, which lie within size, or an error. In bands get is asked
 * for the band's own rows and ghosts and what is common to all; the bands' calls do not
 * match. Errors: those of weft_sim_restore and of get. */
typedef weft_status weft_save_get(void *ctx, uint64_t at, void *bytes, size_t size,
                                  weft_error *err);
WEFT_API weft_status weft_sim_restore_parts(weft_sim *sim, weft_save_get *get,
                                            void *ctx, size_t size, weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
