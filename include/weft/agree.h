/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/agree.h -- what integrators of parts of one state have in common: decisions and
 * the rms norm. Part of weft/stepper.h. */
#ifndef WEFT_AGREE_H
#define WEFT_AGREE_H

#include "weft/base.h"

/* Other integrators that integrate parts of the same state at the same time (bands,
 * weft/comm.h) and must take the same decisions. max is collective: the largest of what
 * each gives, >= 0 or NaN, to all; NaN if one is NaN. Whatever decides -- the norm of
 * the error, whether y is finite, what the rhs returned, a failure -- is agreed on.
 * Every integrator calls rhs and max equally often and in the same order: rhs is called
 * also when y is not finite, and again after it returned a failure, as the rhs of the
 * others may wait for this one. All steps return the status and message, and stats the
 * counts, of one integrator of the whole: calls only for others are not counted. All
 * integrators of a state are created, stepped and told of changes alike. */
typedef struct weft_agree {
    void *self;
    double (*max)(void *self, double mine);
} weft_agree;

/* The rms norm of a whole state in one order of its sum, whatever parts and threads
 * there are: all have the bits of one integrator of the whole. `of` returns
 *
 *     sqrt(1/n sum_i (e_i w_i)^2)
 *
 * over all n positions and velocities; e and w are as the y of this integrator. NaN if
 * one of them is NaN. With agree it is collective, as rhs and max are, and does not
 * replace max: the norm is agreed on as any other. Called in the thread that calls
 * step. */
typedef struct weft_rms {
    void *self;
    double (*of)(void *self, const double *e, const double *w);
} weft_rms;

#endif
