/* SPDX-License-Identifier: BSD-3-Clause */
/* trial.h -- one check of one method while it runs. */
#pragma once

#include <inttypes.h>
#include <setjmp.h>

#include "study/conformance/conformance.h"
#include "study/conformance/oscillators.h"

/* One run of the method on the model. */
typedef struct trial_run {
    const weft_stepper_type *type;
    model model;
    weft_structure structure; /* of the model */
    weft_ode ode;
    weft_stepper_config config;
    void *self;
    double t, y[DIM + APART];
    weft_error err;
} trial_run;

enum { SLOTS = 5 }; /* the last is for weft__near's undisturbed run */

typedef struct trial {
    const weft_stepper_type *type;
    int mode;     /* of weft__usual */
    size_t apart; /* quadratures of every run */
    weft_conformance *out;
    jmp_buf broken; /* where a broken promise ends the check */
    trial_run runs[SLOTS];
} trial;

/* A promise is broken: the text is reported and the check ends here. */
WEFT_PRINTF(2, 3)
_Noreturn void weft__broken(trial *self, const char *format, ...);
/* Computes the values of the text only if it is needed. */
#define EXPECT(ok, ...) ((ok) ? (void)0 : weft__broken(self, __VA_ARGS__))

/* Starts a run at t = 0 in that slot and ends the former one. */
trial_run *weft__begin(trial *self, int slot, weft_stepper_config config);
trial_run *weft__begin_usual(trial *self, int slot);
void weft__end(trial *self, int slot);

weft_status weft__step(trial_run *r, double t_end);
/* Expects a step, or all steps up to t_end, to succeed. */
void weft__good_step(trial *self, trial_run *r, double t_end);
void weft__go(trial *self, trial_run *r, double t_end);

weft_stepper_stats weft__stats(const trial_run *r);
/* Whether two runs have the same y, bit for bit. */
bool weft__same(const trial *self, const trial_run *a, const trial_run *b);
/* Expects t and y to be those of `before`; `what` happened since. */
void weft__unchanged(trial *self, const trial_run *r, const trial_run *before,
                     const char *what);
void weft__calls_counted(trial *self, const trial_run *r, const char *when);
double weft__error_at_end(const trial_run *r);

/* Expects the error at the end of a run that `what` has disturbed to be allowed; if it
 * is not, also reports the error of an undisturbed run of the same config. */
void weft__near(trial *self, const trial_run *r, double error, double allowed,
                const char *what);
void weft__near_solution(trial *self, const trial_run *r, const char *what);

/* The checks, each of one promise, in the order of the table in conformance.c. */
typedef void check_fn(trial *self);
check_fn weft__table_is_sane, weft__create_calls_no_rhs, weft__mistakes_are_refused,
    weft__other_versions_are_served, weft__fixed_steps_ignore_tolerances,
    weft__every_end_is_met, weft__a_single_step_lands_exactly,
    weft__steps_that_fit_leave_no_sliver, weft__stages_are_the_rhs_calls,
    weft__step_sizes_are_kept, weft__no_step_goes_backwards,
    weft__a_failed_step_changes_nothing, weft__one_refusal_costs_a_smaller_step,
    weft__a_first_step_too_large_is_rescued, weft__needing_less_than_min_step_fails,
    weft__needless_changes_change_nothing, weft__an_edited_state_is_used,
    weft__a_step_is_taken_back, weft__stats_write_no_further, weft__stats_never_fall,
    weft__two_instances_are_independent, weft__two_threads_are_independent,
    weft__the_order_is_the_one_claimed, weft__the_error_follows_the_tolerance,
    weft__the_heap_does_not_grow, weft__destroy_leaves_nothing,
    weft__refusals_leave_nothing, weft__the_allocator_is_used,
    weft__the_process_is_left_alone, weft__a_structure_leaves_the_solution,
    weft__a_step_to_the_end_is_checked, weft__a_cut_step_shortens_no_other,
    weft__each_tolerance_counts, weft__each_number_counts, weft__the_rms_norm_is_a_mean,
    weft__quadratures_change_no_step, weft__parts_agree;

/* The reason why a check means nothing for a method, or NULL. */
typedef const char *pointless_fn(const weft_stepper_type *type);
pointless_fn weft__order_not_measured, weft__heap_not_known, weft__agrees_with_nobody,
    weft__no_rms_steps, weft__takes_no_quadratures;
