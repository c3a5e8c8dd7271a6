/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/sim.h -- time: a registry of stepper plugins, and a cloth under integration. */
#ifndef WEFT_SIM_H
#define WEFT_SIM_H

#include "weft/cloth.h"
#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The plugins that a program has, linked in or loaded. It owns their handles: destroy
 * it after the last stepper made with them. One thread at a time. */
typedef struct weft_registry weft_registry;

/* Where weft-<id>.so is looked for, in this order. Lists are separated by ':'. */
typedef struct weft_registry_def {
    const char *path;                /* searched first; NULL: none */
    bool environment;                /* then WEFT_PLUGIN_PATH, if it is set */
    const char *fallback;            /* then; NULL: none */
    weft_log log;                    /* info: a plugin loaded; warning: one refused */
    const weft_allocator *allocator; /* NULL: malloc's */
    bool installed; /* searched last: weft/plugins-1 beside libweft.so. A program that
                       libweft.a is linked into names that directory itself: `pkg-config
                       --variable=plugindir weft` */
    /* Asked before a file is loaded, as loading runs its code: anything but WEFT_OK
     * refuses it, for the reason in *err. NULL: nobody. */
    weft_status (*admit)(void *ctx, const char *file, weft_error *err);
    void *admit_ctx;
} weft_registry_def;

WEFT_API weft_registry_def weft_registry_def_default(void);
WEFT_API weft_status weft_registry_create(const weft_registry_def *def,
                                          weft_registry **out, weft_error *err);
WEFT_API void weft_registry_destroy(weft_registry *registry); /* NULL is allowed */

/* Add a plugin that is linked in. Errors: WEFT_BAD_PLUGIN with the reason. */
WEFT_API weft_status weft_registry_add(weft_registry *registry,
                                       const weft_plugin *plugin, weft_error *err);

/* Load one file named weft-<id>.so and add its plugin. Errors: WEFT_BAD_PLUGIN with
 * the file and the reason. */
WEFT_API weft_status weft_registry_load(weft_registry *registry, const char *file,
                                        weft_error *err);

/* The plugin of that id, loaded now if it is not there yet. Errors: WEFT_BAD_PLUGIN;
 * the message lists the directories searched. */
WEFT_API weft_status weft_registry_find(weft_registry *registry, const char *id,
                                        const weft_plugin **out, weft_error *err);

/* Load every weft-*.so of the search path; a refused one is told to `refused` (NULL:
 * to nobody) and skipped. */
WEFT_API weft_status weft_registry_load_all(weft_registry *registry,
                                            void (*refused)(void *ctx,
                                                            const weft_error *why),
                                            void *ctx, weft_error *err);

WEFT_API size_t weft_registry_count(const weft_registry *registry);
WEFT_API const weft_plugin *weft_registry_at(const weft_registry *registry, size_t i);
/* The file a plugin came from; "" if it is linked in. */
WEFT_API const char *weft_registry_file(const weft_registry *registry, size_t i);

/* The method of that name or full name; NULL: none, or there is no plugin. */
WEFT_API const weft_stepper_type *weft_plugin_method(const weft_plugin *plugin,
                                                     const char *name);

/* Both in one: plugin "arkode", method "dormand_prince". Errors: those of
 * weft_registry_find, WEFT_INVALID (no such method); the message tells what there is.
 */
WEFT_API weft_status weft_registry_method(weft_registry *registry, const char *plugin,
                                          const char *method,
                                          const weft_stepper_type **out,
                                          weft_error *err);

/* What the dense matrices of a method come to on so many particles: their bytes, and as
 * text "matrices of 1734 x 1734, 48.11 MB in all, about 1734 evaluations for each
 * Jacobian". 0 and "" without WEFT_STEPPER_DENSE. */
WEFT_API double weft_stepper_matrices(const weft_stepper_type *type, size_t particles,
                                      char *text, size_t size);

/* Adaptive, rtol = atol = 1e-6, max norm, first step 1 ms, min 1 ps. */
WEFT_API weft_stepper_config weft_stepper_config_default(void);

/* What a method makes of modes x'' + c x' + w2 x = 0 in fixed steps, found by running
 * it: any method of any plugin whose steps are explicit and stand alone. */
enum { WEFT_STABILITY_DEGREE = 47 };

typedef struct weft_stability {
    const weft_stepper_type *type;
    const weft_butcher *butcher;
    double calls; /* RHS calls a step */
    int degree;   /* of r; -1: not a Runge-Kutta method, and r is not set */
    double r[WEFT_STABILITY_DEGREE + 1]; /* R(z) = sum r[k] z^k: y1 = R(h A) y0 */
} weft_stability;

/* butcher as in the stepper's config: NULL for a method that takes none; it outlives
 * *out. Errors: WEFT_UNSUPPORTED (the method is implicit or multistep), WEFT_NO_MEMORY,
 * what creating the stepper gives. */
WEFT_API weft_status weft_stability_create(const weft_stepper_type *type,
                                           const weft_butcher *butcher,
                                           weft_stability *out, weft_error *err);

/* The largest h [s] up to which no mode in the polygon grows; INFINITY if none ever
 * does. With growth [1/s] 0 this is stability proper: |R(h mu)| <= 1 for the roots of
 * mu^2 + c mu + w2 = 0.
 *
 * Methods of Runge-Kutta type with |R(i y)| > 1 for small y have no stable step on
 * undamped modes then. A growth > 0 allows these, and no others, to grow: an
 * oscillating mode of damping rate c / 2 < growth by at most exp((growth - c / 2) h) a
 * step, and to twice itself. With growth = log(2) / T none more than doubles in T
 * seconds. Modes that do not oscillate, on the real axis, and those damped at a rate of
 * growth or more are held to |R| <= 1. Of other methods growth is not looked at.
 * Errors: WEFT_NO_MEMORY. */
WEFT_API weft_status weft_stability_step(const weft_stability *stability,
                                         const weft_stiffness *modes, double growth,
                                         double *h, weft_error *err);

/* One simulation under way. One thread at a time; many may share a cloth.
 *
 * The same definition gives the same bits on every x86-64 machine and on any number of
 * threads, if the method is without WEFT_STEPPER_LIBM, its solver library was built
 * without contraction of a b + c, callbacks are functions of their arguments alone, and
 * the processor rounds to nearest and keeps denormal numbers. 64-bit ARM has the same
 * bits under the same conditions; Debian's GSL for it is contracted. */
typedef struct weft_sim weft_sim;

/* Called after every accepted step of size h [s] that ended at t [s], after the strain
 * limit; may edit y[6 N], the pinned particles' part of it excepted. Returns whether it
 * did. It must leave every number finite. */
typedef bool weft_correct_fn(void *ctx, double t, double h, double *y);

/* A force of the embedder's own: adds [N] to f[3 N], planes fx fy fz, at t [s] in the
 * state y[6 N]. What is added to a pinned particle has no effect. Returns as
 * weft_rhs_fn: 0; > 0 if y is unusable and a smaller step may help; < 0 to end the run,
 * which then fails with WEFT_STOPPED.
 *
 * Called in every evaluation of the right-hand side, many a step, also for attempts
 * that are rejected, by the thread that steps: it must be a function of (t, y) alone,
 * and smooth where the order of a method matters. Then a run gives the same bits again.
 */
typedef int weft_force_fn(void *ctx, double t, const double *y, double *f);

/* Asked before every evaluation of the right-hand side, by the thread that steps;
 * true: the step is given up and fails with WEFT_STOPPED, the state and the time are as
 * before it, and a later step may go on. For a signal, a deadline or a button: return
 * what another thread or a handler has set. How often a step evaluates is the method's
 * matter: those with dense matrices may factorise for minutes in between. */
typedef bool weft_stop_fn(void *ctx);

/* No callback may call a function that changes the simulation, or saves it: they
 * return WEFT_INVALID then. All must return: after one that was left by an exception or
 * by longjmp these functions return WEFT_INVALID for ever. */
typedef struct weft_sim_def {
    const weft_cloth *cloth;         /* outlives the simulation */
    const weft_stepper_type *method; /* likewise */
    weft_stepper_config config;      /* what it points to outlives it too */
    weft_correct_fn *correct;        /* NULL: none; comes after the limit */
    void *correct_ctx;
    bool ledger; /* keep the energy ledger; the method needs WEFT_STEPPER_QUADRATURES */
    weft_limit_def limit; /* a correction after every accepted step; default: none */
    weft_force_fn *force; /* NULL: none; comes after all forces of the cloth */
    void *force_ctx;
    weft_log log;
    const weft_allocator *allocator; /* also for the stepper; NULL: malloc's */
    weft_stop_fn *stop;              /* NULL: never */
    void *stop_ctx;
} weft_sim_def;

/* Where the energy went since t = 0, in [J]. Without ledger in the definition only
 * `energy` is filled, and the rest is 0. */
typedef struct weft_ledger {
    bool kept;
    weft_energy energy; /* at present */
    double dissipated_springs, dissipated_drag;
    double wind_work, pin_work; /* done on the cloth: may be negative */
    double limit_work;          /* added by the strain limit */
    double
        outside_work;  /* added by `correct`, weft_sim_set_state and changes of pins */
    double residual;   /* energy - energy at t = 0 + dissipated - work: 0 but for the
                          errors of the integration */
    double force_work; /* done on the free particles by `force` */
} weft_ledger;

/* What the strain limit has done since t = 0. */
typedef struct weft_limit_stats {
    uint64_t corrected;   /* steps that had a spring to shorten */
    uint64_t sweeps;      /* passes of all of them */
    uint64_t unconverged; /* steps whose passes did not do */
} weft_limit_stats;

/* The limit of weft_sim_def_default has no method, and the values a scene would have:
 * strain 0.1, stretch and shear, 100 sweeps, tolerance 1e-3, velocities updated, fast.
 */
WEFT_API weft_sim_def weft_sim_def_default(void);

/* Starts at t = 0 with weft_cloth_start. Errors: WEFT_INVALID, WEFT_NO_MEMORY,
 * WEFT_UNSUPPORTED (the method cannot do what the config asks). */
WEFT_API weft_status weft_sim_create(const weft_sim_def *def, weft_sim **out,
                                     weft_error *err);
WEFT_API void weft_sim_destroy(weft_sim *sim); /* NULL is allowed */

/* One accepted step towards t_end [s] > time, never past it. On failure the state and
 * the time are those of the last good step, and weft_sim_failure describes it. */
WEFT_API weft_status weft_sim_step(weft_sim *sim, double t_end, weft_error *err);

/* Steps until the time is t_end [s] exactly: none if it is that already. */
WEFT_API weft_status weft_sim_advance(weft_sim *sim, double t_end, weft_error *err);

/* A run in frames: frame i is at i / fps [s], the last one at `duration`. */
typedef struct weft_run_def {
    double duration;   /* [s] > 0 */
    double fps;        /* [1/s] > 0 */
    size_t threads;    /* >= 1, of a scene: weft_sim_play takes those of the config */
    size_t checkpoint; /* frames from one to the next; 0: none */
} weft_run_def;

WEFT_API size_t weft_run_last_frame(const weft_run_def *run);
WEFT_API double weft_run_frame_time(const weft_run_def *run, size_t i); /* [s] */

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

/* Steps from frame to frame and calls `frame` at each, as `weft run` does. A checkpoint
 * restarts the stepper, which changes results: by this function a run has the same bits
 * whether checkpoints are kept or not. Errors: those of weft_sim_step and callbacks. */
WEFT_API weft_status weft_sim_play(weft_sim *sim, const weft_play *play,
                                   weft_error *err);

/* Why a step failed, and the last good state, or the one that a correction spoiled. */
typedef struct weft_failure {
    weft_status status;
    double time;        /* [s] */
    double last_step;   /* [s] the one before; 0: none */
    weft_spring spring; /* the most strained; p == q: there are no springs */
    size_t particle;    /* the fastest */
    double position[3]; /* [m] of that particle */
    double speed;       /* [m/s] of that particle */
    double energy;      /* [J] kinetic + elastic + gravitational */
    char reason[512];   /* the stepper's own message, without the time */
} weft_failure;

/* Whether the last step failed; the message of weft_sim_step has the same in words. */
WEFT_API bool weft_sim_failure(const weft_sim *sim, weft_failure *out);

WEFT_API double weft_sim_time(const weft_sim *sim); /* [s] */
WEFT_API const double *
weft_sim_state(const weft_sim *sim); /* y[6 N], until next step */
/* The cloth as it stands: the definition's, or, once a pin was changed, the
 * simulation's own, which has the pins of now. Until the simulation is destroyed. */
WEFT_API const weft_cloth *weft_sim_cloth(const weft_sim *sim);
WEFT_API weft_stepper_stats weft_sim_stats(const weft_sim *sim);
/* Every choice of the stepper beyond its config, one call of `tell` each. */
WEFT_API void weft_sim_options(const weft_sim *sim, weft_option_fn *tell, void *ctx);
/* [J] turned into heat so far by springs and viscous drag: the ledger's, if it is kept,
 * else the trapezoid rule over the accepted steps, of second order in h. */
WEFT_API double weft_sim_dissipated(const weft_sim *sim);

/* The powers of weft_cloth_power were integrated with the state, by the method itself:
 * the residual is of its order. The state and the steps are the same without it. */
WEFT_API weft_ledger weft_sim_ledger(const weft_sim *sim);

/* All 0 without a limit. */
WEFT_API weft_limit_stats weft_sim_limit_stats(const weft_sim *sim);
/* The limited spring with the largest strain at present, as weft_cloth_worst_spring. */
WEFT_API weft_spring weft_sim_limit_worst(const weft_sim *sim);
/* Limited springs that are too long at present and have both ends pinned: they cannot
 * be corrected, and do not count as unconverged. */
WEFT_API size_t weft_sim_limit_held(const weft_sim *sim);

/* Copies of the state as x y z of particle 0, x y z of particle 1, ...: 3 N doubles. */
WEFT_API void weft_sim_positions(const weft_sim *sim, double *xyz);  /* [m] */
WEFT_API void weft_sim_velocities(const weft_sim *sim, double *xyz); /* [m/s] */

/* Replaces the positions [m] and velocities [m/s] of the free particles (NULL: keeps
 * them); pinned ones keep theirs. Errors: WEFT_INVALID where a value is not finite,
 * and nothing is changed. */
WEFT_API weft_status weft_sim_set_state(weft_sim *sim, const double *positions,
                                        const double *velocities, weft_error *err);

/* Pins, changed while a simulation runs. The cloth that it was made from and all others
 * that share it keep theirs: the first change gives this one pins of its own. Particle
 * i is (i / cols, i % cols). Between two steps, each in O(N). Errors: WEFT_INVALID (no
 * such particle, a number that is not finite), WEFT_NO_MEMORY, and nothing is changed.
 */

/* Holds a particle, from where it is and from now on, and moves it at `velocity` [m/s]
 * (NULL: not at all, and it keeps its position bit for bit). One that is pinned already
 * gets this motion instead of its own. To have it at x by the time t of the next frame:
 * velocity = (x - position) / (t - time). */
WEFT_API weft_status weft_sim_pin(weft_sim *sim, size_t i, const double velocity[3],
                                  weft_error *err);

/* Puts a pinned particle to `position` [m] at once; its velocity stays. Springs do not
 * like jumps. Errors: WEFT_INVALID also if it is not pinned. */
WEFT_API weft_status weft_sim_move_pin(weft_sim *sim, size_t i,
                                       const double position[3], weft_error *err);

/* Lets a particle go, with the position and the velocity that it has. One that is not
 * pinned stays as it is. */
WEFT_API weft_status weft_sim_unpin(weft_sim *sim, size_t i, weft_error *err);

/* The stepper begins anew from the present state, with the h it would try next; all
 * counts go on. Nothing else is left of its past then, whatever the method. On failure,
 * WEFT_NO_MEMORY, nothing is changed. */
WEFT_API weft_status weft_sim_restart(weft_sim *sim, weft_error *err);

/* Save everything that the future of a simulation depends on: state, time, next h,
 * counts, ledger and strain limit, to `size` bytes of the caller's. Restored into a
 * simulation of the same definition, made by any program on any machine, both go on
 * alike to the last bit, as saving restarts the stepper here too. Threads, allocators
 * and log may differ, all else that counts is compared by hashes. What `correct`
 * and `force` keep for themselves is the caller's to save. The bytes know their version
 * and are checksummed; their size, that of weft_sim_save_size, grows with the pins that
 * were changed. Errors: WEFT_INVALID (size is less), those of weft_sim_restart. */
WEFT_API size_t weft_sim_save_size(const weft_sim *sim);
WEFT_API weft_status weft_sim_save(weft_sim *sim, void *bytes, size_t size,
                                   weft_error *err);

/* Errors: WEFT_INVALID with the reason (these are no saved simulation, damaged or cut
 * off, of another version, grid or method, with and without ledger, of another cloth or
 * under other settings, not finite), WEFT_NO_MEMORY. Nothing is changed then. */
WEFT_API weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                                      weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
