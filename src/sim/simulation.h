/* SPDX-License-Identifier: BSD-3-Clause */
/* simulation.h -- the data of a simulation, for the files of src/sim alone. */
#pragma once

#include "base/finite.h"
#include "base/try.h"
#include "sim/between.h"
#include "sim/forces.h"
#include "sim/ledger.h"
#include "sim/limit.h"
#include "sim/sensitivity.h"
#include "sim/step_check.h"
#include "sim/wave.h"
#include "weft/sim.h"

/* checked_step.c: steps that are rejected for a shape or for the cloth itself. */
typedef struct weft__guard {
    double *start;                 /* as y, before a step; NULL until there are any */
    uint64_t vetoed;               /* steps */
    uint64_t calls;                /* of the right-hand side, with shapes */
    weft__penetration penetration; /* that rejected the last one; of the whole cloth */
    struct {
        unsigned attempts, rejected; /* of the present ATTEMPTS */
        bool told;
    } stall;
} weft__guard;

/* event.c: the function at present, which ended the last step if `passed`. */
typedef struct weft__event {
    double value; /* NAN: not known */
    bool passed;
    double since; /* [s] 0 or below since then; NAN: it is not; INFINITY: that was an
                     event */
} weft__event;

/* pace.c: how far the last steps went. */
enum { WEFT__PACE = 1000 };
typedef struct weft__pace {
    double end, frame; /* [s] that steps lead to, and how long that is at most */
    double since;      /* [s] where the first of `steps` began */
    unsigned steps;
    bool told, closed; /* of a run that hardly advances; of shapes that close */
} weft__pace;

struct weft_sim {
    weft_sim_def def; /* its log writes to `log`, and counts as a callback */
    weft_log log;
    weft_cloth *cloth;          /* copy of the definition's, owns pins and shapes */
    uint64_t cloth_hash;        /* weft__cloth_hash of the definition's */
    weft_stepper_config config; /* the definition's, completed */
    void *stepper;
    weft_stepper_stats earlier; /* of the steppers before this one */
    weft__forces forces;
    weft_team worker_pool;    /* the forces' threads, for the stepper */
    weft__wave *wave;         /* NULL: none */
    weft_pass pass;           /* by it, for the stepper */
    weft_rms rms;             /* for the stepper */
    uint64_t bytes;           /* of it and of the simulation, 0: not known */
    weft_structure structure; /* of the cloth, for the stepper */
    void *lists;              /* of the structure */
    double *masses;           /* [kg] N, 0 of the pinned; then their drags [kg/s] */
    weft__limit limit;
    double *added;      /* [N] 3 N, filled by the definition's `force` */
    double *rates;      /* 6 N, each rate that was computed; NULL: nobody needs them */
    unsigned callbacks; /* calls of the embedder under way, but those of weft_play */
    unsigned playing;   /* calls of a weft_play under way */
    weft_allocator memory;
    uint64_t settings; /* weft__settings_hash of the definition */
    uint64_t rejected; /* attempts that were logged */
    double t;          /* [s] */
    double piece;      /* [s] in that of tables and keys of the last step */
    double next_piece; /* [s] in the one that begins at t, */
    bool piece_begins; /* if that ended there */
    weft__ledger ledger;
    weft_failure failure; /* of the last step; status WEFT_OK: it did not fail */
    double *y;            /* 6 N, then with ledger its quadratures */
    weft__guard guard;
    weft__pace pace;
    struct {
        double next; /* [s] when frame_check.c looks again; -INFINITY: it has not yet */
        bool told;
    } passage;
    weft_agree agree; /* with a comm: its maximum, for the stepper */
    weft__between between;
    weft__event event;
    weft__sensitivity sensitivity;
};

/* sim_rhs.c: the right-hand side of a simulation, which is ctx. */
int weft__sim_rhs(double t, const double *y, double *dydt, void *ctx);
bool weft__sim_must_stop(weft_sim *sim); /* what `stop` returns */

/* sim_pass.c: the rms norm, and a pass over the rows, for a method that asks for one,
 * where an evaluation is that of the cloth alone; [bytes] that grow with the cloth, 0
 * if more than is counted. */
weft_status weft__sim_make_pass(weft_sim *sim, weft_error *err);
uint64_t weft__sim_bytes(const weft_sim *sim);

/* Creates a stepper for the simulation; first_step [s] 0: that of the config. */
weft_status weft__sim_stepper(const weft_sim *sim, double first_step, void **out,
                              weft_error *err);

/* structure.c: fills sim->structure and puts it into the config; again, after pins or
 * shapes have changed. */
weft_status weft__structure_init(weft_sim *sim, weft_error *err);
void weft__structure_update(weft_sim *sim);

/* WEFT_INVALID for a function that is called from within a callback: every call of the
 * embedder raises sim->callbacks until it returns. */
weft_status weft__sim_outside(const weft_sim *sim, const char *function,
                              weft_error *err);

/* Also from one of weft_play, which sim->playing counts: for functions that step. */
weft_status weft__sim_outside_play(const weft_sim *sim, const char *function,
                                   weft_error *err);

/* weft__sim_outside, and WEFT_UNSUPPORTED in bands. */
weft_status weft__sim_changeable(const weft_sim *sim, const char *function,
                                 weft_error *err);

/* Whether there is a strain limit. */
static inline bool weft__sim_limits(const weft_sim *of)
{
    return of->def.limit.method != WEFT_LIMIT_NONE;
}

/* Whether steps are checked. */
static inline bool weft__sim_checks(const weft_sim *of)
{
    return weft__cloth_checks(of->cloth);
}

/* A step of the method. */
static inline weft_status weft__sim_method_step(weft_sim *of, double t_end,
                                                weft_error *why)
{
    return of->sensitivity.count > 0
               ? weft__sensitivity_step(of, t_end, why)
               : of->def.method->step(of->stepper, t_end, &of->t, of->y, why);
}

/* checked_step.c: one step of the stepper that is clear of all shapes and of the
 * cloth itself, or its failure. */
weft_status weft__sim_checked_step(weft_sim *sim, double t_end, weft_error *why);

/* A step of either kind. */
static inline weft_status weft__sim_take_step(weft_sim *of, double t_end,
                                              weft_error *why)
{
    return weft__sim_checks(of) ? weft__sim_checked_step(of, t_end, why)
                                : weft__sim_method_step(of, t_end, why);
}

/* piece.c: before a step that is to go to *t_end, which comes no later than the end
 * that is returned; and after it. */
double weft__piece_enter(weft_sim *sim, double *t_end);
void weft__piece_leave(weft_sim *sim, double end);

/* Adds `factor` times what the velocities of pins jump by at t, of which those of the
 * state are those after it. */
void weft__piece_jump(const weft_sim *sim, double factor, double *v);

/* frame_check.c: weft_sim_check_frame of the state that is shown; and within the step
 * from t0, with shapes, as often as passage.next comes. */
weft_status weft__sim_passages(weft_sim *sim, weft_error *err);
weft_status weft__sim_look_within(weft_sim *sim, double t0, weft_error *err);

/* event.c: before a step, which may go to the end that is returned; and after one that
 * is accepted: if the event function fell to 0 within it, takes it back and ends it
 * there. After a failure the state is that at its start. */
double weft__sim_before_event(weft_sim *sim, double t_end);
weft_status weft__sim_find_event(weft_sim *sim, weft_error *why);

/* Room for checked steps. */
weft_status weft__sim_make_start(weft_sim *sim, weft_error *err);
/* For a state, behind that. */
double *weft__sim_room(const weft_sim *sim);

/* pace.c: warns once of shapes that close on the cloth; after WEFT__PACE steps, once of
 * a run that hardly advances. The second is collective. */
void weft__sim_look_ahead(weft_sim *sim);
void weft__sim_look_back(weft_sim *sim);

/* failure.c: stores the reason and the state of a failed step and writes both to *err
 * as a message. Returns the status of *why. */
weft_status weft__sim_fail(weft_sim *sim, const weft_error *why, weft_error *err);

/* The same file: why a correction failed that left a number that is not finite. */
void weft__sim_not_finite(const weft_sim *sim, weft_error *why);

/* The length of y. */
static inline size_t weft__sim_dim(const weft_sim *of)
{
    return 6 * of->cloth->mesh.particles + of->config.quadratures;
}

/* Around a change of y, or of the cloth (`ode`), from outside, between two steps. */
void weft__sim_change_begins(weft_sim *sim);
void weft__sim_change_ends(weft_sim *sim, bool ode);

/* settings.c: hash of all of a definition that changes results, besides cloth and
 * method; `config` is its config, completed, which the method has accepted. */
uint64_t weft__settings_hash(const weft_sim_def *def,
                             const weft_stepper_config *config);
