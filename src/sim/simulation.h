/* SPDX-License-Identifier: BSD-3-Clause */
/* simulation.h -- what a simulation is made of, for the files of src/sim alone. */
#ifndef WEFT_SIM_SIMULATION_H
#define WEFT_SIM_SIMULATION_H

#include "base/finite.h"
#include "sim/forces.h"
#include "sim/ledger.h"
#include "sim/limit.h"
#include "sim/step_check.h"

struct weft_sim {
    weft_cloth *cloth;   /* the definition's with pins of its own */
    uint64_t cloth_hash; /* weft__cloth_hash of the definition's */
    const weft_stepper_type *method;
    weft_stepper_config config;
    void *stepper;
    weft_stepper_stats earlier; /* of the steppers before this one */
    weft__forces forces;
    weft_team worker_team; /* the forces' threads, for the stepper */
    weft__limit *limit;    /* NULL: none */
    weft_correct_fn *correct;
    void *correct_ctx;
    weft_force_fn *force;
    void *force_ctx;
    weft_stop_fn *stop;
    void *stop_ctx;
    double *added; /* [N] 3 N, by `force` */
    bool in_callback;
    weft_log log;
    weft_allocator memory;
    uint64_t settings; /* weft__settings_hash of the definition */
    uint64_t rejected; /* attempts that were told of */
    double t;          /* [s] */
    weft__ledger ledger;
    weft_failure failure; /* of the last step; status WEFT_OK: it did not fail */
    double *y;            /* 6 N, then with ledger its quadratures */
    double *start;   /* with shapes: as y, before a step; NULL until there are any */
    uint64_t vetoed; /* steps taken back for the shapes */
    weft__breach refused; /* by the last right-hand side */
};

/* motion.c: the right-hand side of a simulation, which is ctx. */
int weft__sim_rhs(double t, const double *y, double *dydt, void *ctx);

/* A stepper for the simulation as it is defined; first_step [s] 0: by the config. */
weft_status weft__sim_stepper(const weft_sim *sim, double first_step, void **out,
                              weft_error *err);

/* WEFT_INVALID for a function that is called from within a callback. */
weft_status weft__sim_outside(const weft_sim *sim, const char *function,
                              weft_error *err);

/* checked_step.c: one step of the stepper that is clear of all shapes, or its failure.
 */
weft_status weft__sim_checked_step(weft_sim *sim, double t_end, weft_error *why);

/* Room for it, for a simulation with shapes. */
weft_status weft__sim_make_start(weft_sim *sim, weft_error *err);

/* failure.c: keeps why a step has failed and the state that it failed in; *err gets
 * them as a message. Returns the status of *why. */
weft_status weft__sim_fail(weft_sim *sim, const weft_error *why, weft_error *err);

/* The length of y. */
size_t weft__sim_dim(const weft_sim *sim);

/* Around a change of y or of the cloth from outside, between two steps. */
void weft__sim_change_begins(weft_sim *sim);
void weft__sim_state_changed(weft_sim *sim);
void weft__sim_ode_changed(weft_sim *sim);

/* settings.c: hash of all in a definition that the results depend on besides cloth and
 * method; `config` is its config, completed, which the method has accepted. */
uint64_t weft__settings_hash(const weft_sim_def *def,
                             const weft_stepper_config *config);

#endif
