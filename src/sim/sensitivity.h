/* SPDX-License-Identifier: BSD-3-Clause */
/* sensitivity.h -- what a simulation with sensitivities has beside its state. */
#pragma once

#include "cloth/parameter_derivative.h"
#include "weft/sim.h"

/* sensitivity.c: derivatives of the state with respect to parameters, which the stepper
 * integrates with it. It sees (1 + count) N particles: in each plane rows of the state,
 * each followed by that of each s. */
typedef struct weft__sensitivity {
    size_t count;  /* 0: none */
    double factor; /* of s for the stepper: 1, or too small for its error control */
    bool passes;   /* more steps follow up to t_end, between which nobody sees y */
    bool direct;   /* no other forces than springs, weight and air, of z as it is */
    size_t row;    /* particles of such a row: of the grid's if direct, else N */
    weft__parameter_derivative of[WEFT_SENSITIVITIES];
    double *z, *before;       /* the stepper's state: now, before the step */
    double *s;                /* planes of each s, one after another; once unpacked */
    double *states, *rates;   /* unless direct, so with the state's before */
    double *room[3];          /* 6 N each */
    weft_structure structure; /* augmented.c, for methods that take one */
    weft_spring_run *runs;
    double *masses, *own; /* of the structure; what it takes from that of the state */
} weft__sensitivity;

/* sensitivity.c: why a simulation has no derivative, or NULL. */
const char *weft__sensitivity_refusal(const weft_sim *sim);
/* After all else of a simulation but its stepper. */
weft_status weft__sensitivity_init(weft_sim *sim, weft_error *err);
void weft__sensitivity_free(weft_sim *sim);
/* As weft__sim_rhs, of a simulation that has them. */
int weft__sensitivity_rhs(double t, const double *z, double *dzdt, void *ctx);
/* y and s into the stepper's state. */
void weft__sensitivity_pack(weft_sim *sim);
/* The state alone, of the stepper's: 6 N. */
void weft__sensitivity_state(const weft_sim *sim, const double *z, double *y);
/* augmented.c: the structure for the stepper, in the config. */
weft_status weft__augmented_init(weft_sim *sim, weft_error *err);
/* Fills s. */
void weft__sensitivity_unpack(const weft_sim *sim);
/* After y was put back to where the last step began. */
void weft__sensitivity_back(weft_sim *sim);

/* Where a piece ends (piece.c): takes the state from y, and adds what the derivatives
 * of pins jump by. */
void weft__sensitivity_jump(weft_sim *sim);
uint64_t weft__sensitivity_hash(const weft_sim *sim, uint64_t hash);

/* A step of the method, of the state and its sensitivities. */
weft_status weft__sensitivity_step(weft_sim *sim, double t_end, weft_error *why);
