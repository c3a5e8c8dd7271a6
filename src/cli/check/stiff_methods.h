/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff_methods.h -- whether a stabilised or an implicit method will pay on a cloth,
 * from the bounds of its modes and its width. Estimates, not bounds. */
#ifndef WEFT_CLI_CHECK_STIFF_METHODS_H
#define WEFT_CLI_CHECK_STIFF_METHODS_H

#include "cli/check/stable_steps.h"
#include "cli/human.h"

enum { STIFF_ACCURACIES = 2 };

/* A gain is the time of an explicit method by that of the other one; 0: no gain is to
 * be expected. */
typedef struct stiff_gains {
    double omega, zeta;        /* [1/s] of the stiffest mode, and its damping ratio */
    const survey_method *over; /* explicit, the scene's own if it is; NULL: none */
    const survey_method *rkc;  /* NULL: there is none, or it refuses the cloth */
    double stabilised;         /* of rkc */
    double bdf[STIFF_ACCURACIES]; /* at 1e-2 m, at 1e-3 m */
} stiff_gains;

/* From the methods of a survey and the modes behind their steps. */
stiff_gains stiff_gains_of(const survey *of, const weft_cloth_def *cloth);

/* "stiffest mode: omega 5657 1/s, damping ratio zeta 1.4: over-damped; ..." */
void stiff_say(const stiff_gains *gains, sentence *out);

#endif
