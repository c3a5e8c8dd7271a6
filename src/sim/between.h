/* SPDX-License-Identifier: BSD-3-Clause */
/* between.h -- the state within the last step, of any method: of weft_sim_between, of
 * events and of frames that a step passes. */
#pragma once

#include <stdbool.h>

#include "weft/sim.h"

enum { WEFT__NODES = 4 };

/* The step behind. */
typedef struct weft__between {
    double t0;      /* [s] where it began; INFINITY: it is not known */
    double *start;  /* the state then, with quadratures; NULL: steps are not kept */
    unsigned nodes; /* inner ones, of the order of the method */
    unsigned
        levels; /* 1 + nodes whose rates are known; 0: not even those of the ends */
    double *rates[2 + WEFT__NODES]; /* of both ends, then of the inner nodes */
    double *shown; /* the state that weft__between_show hides, else room */
    double *kept;  /* room for an event's search: a state to go on from */
    bool smooth;   /* events see the cubic through positions and velocities */
    double behind; /* [s] of the hidden state */
    bool showing;
} weft__between;

/* Room for a definition that asks for it. */
weft_status weft__between_init(weft_sim *sim, weft_error *err);

/* Before a step. */
void weft__between_begin(weft_sim *sim);
/* After a change from outside: no time is behind. */
void weft__between_forget(weft_sim *sim);

/* For events: after the first the second writes the motion at t within the last step,
 * without quadratures, to room of its own. Error: WEFT_STOPPED. */
weft_status weft__between_look(weft_sim *sim, weft_error *err);
double *weft__between_motion(weft_sim *sim, double t);

/* Between the two, the simulation is as it was at t within the last step, and no
 * function may change it. Errors: those of weft_sim_between. */
weft_status weft__between_show(weft_sim *sim, double t, weft_error *err);
void weft__between_hide(weft_sim *sim);
