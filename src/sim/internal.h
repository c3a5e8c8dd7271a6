/* SPDX-License-Identifier: BSD-3-Clause */
/* internal.h -- what sim.c and save.c share of a simulation. */
#ifndef WEFT_SIM_INTERNAL_H
#define WEFT_SIM_INTERNAL_H

#include "sim/forces.h"
#include "sim/ledger.h"
#include "sim/limit.h"

struct weft_sim {
    const weft_cloth *cloth;
    const weft_stepper_type *method;
    weft_stepper_config config;
    void *stepper;
    weft_stepper_stats before; /* of the steppers before this one */
    weft__forces forces;
    weft_team lent;     /* their threads */
    weft__limit *limit; /* NULL: none */
    weft_correct_fn *correct;
    void *correct_ctx;
    double t;                   /* [s] */
    double dissipated, heating; /* [J] so far, [W] then; without ledger */
    double unheated;            /* [s] before t that dissipated lacks */
    weft__ledger ledger;
    double *y; /* 6 N, then with ledger its quadratures */
};

/* A stepper for the simulation as it is defined; first_step [s] 0: by the config. */
weft_status weft__sim_stepper(const weft_sim *sim, double first_step, void **out,
                              weft_error *err);

/* Brings dissipated and heating up to t. */
void weft__sim_settle(weft_sim *sim);

/* The length of y. */
size_t weft__sim_dim(const weft_sim *sim);

#endif
