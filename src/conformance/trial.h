/* SPDX-License-Identifier: BSD-3-Clause */
/* trial.h -- one check of one method under way. */
#ifndef WEFT_CONFORMANCE_TRIAL_H
#define WEFT_CONFORMANCE_TRIAL_H

#include "conformance/conformance.h"
#include "conformance/oscillators.h"

/* One run of the method on the model. */
typedef struct trial_run {
    model model;
    weft_ode ode;
    weft_stepper_config config;
    void *self;
    double t, y[DIM + APART];
    weft_error err;
} trial_run;

enum { SLOTS = 5 }; /* the last is that of weft__near's undisturbed run */

typedef struct trial {
    const weft_stepper_type *type;
    size_t apart; /* quadratures of every run */
    weft_conformance *out;
    trial_run runs[SLOTS];
} trial;

/* The first expectation that is not met breaks the promise, and its text is what was
 * seen. Returns ok. */
WEFT_PRINTF(3, 4)
bool weft__expect(trial *self, bool ok, const char *format, ...);

/* A run from t = 0 in that slot, instead of the one that was there; NULL if it cannot
 * be created, which breaks the promise. */
trial_run *weft__begin(trial *self, int slot, weft_stepper_config config);
void weft__end(trial *self, int slot);

weft_status weft__step(const trial *self, trial_run *r, double t_end);
/* A step, and steps up to t_end, that must succeed; false: they did not. */
bool weft__good_step(trial *self, trial_run *r, double t_end);
bool weft__go(trial *self, trial_run *r, double t_end);

weft_stepper_stats weft__stats(const trial *self, const trial_run *r);
/* Whether two runs have the same y, bit for bit. */
bool weft__same(const trial *self, const trial_run *a, const trial_run *b);
double weft__error_at_end(const trial_run *r);

/* Expects an error at the end of a run that something has disturbed to be allowed, or
 * tells what an undisturbed run of the same config comes to; `what` was done to it. */
WEFT_PRINTF(5, 6)
bool weft__near(trial *self, const trial_run *r, double error, double allowed,
                const char *what, ...);

/* One promise. */
typedef struct check {
    const char *name, *promise;
    void (*run)(trial *self);
    const char *(*pointless)(const weft_stepper_type *type); /* why; NULL: it is not */
    bool once; /* not again with quadratures */
} check;

/* The checks of each file, up to one without a name. */
extern const check weft__creation_checks[], weft__step_checks[], weft__failure_checks[],
    weft__state_checks[], weft__accuracy_checks[], weft__memory_checks[],
    weft__process_checks[];

/* Asks create for all that it must refuse. */
void weft__refuse_mistakes(trial *self);

/* For `pointless`. */
const char *weft__no_error_control(const weft_stepper_type *type);

#endif
