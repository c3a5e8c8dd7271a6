/* SPDX-License-Identifier: BSD-3-Clause */
/* conformance.c -- the table of the checks, and how one is run. */
#include "study/conformance/trial.h"

static const char *no_fixed_steps(const weft_stepper_type *type)
{
    return weft__takes_fixed(type) ? NULL : "the method takes no fixed steps";
}

static const char *no_stages(const weft_stepper_type *type)
{
    return type->stages == 0 ? "the number of stages varies" : no_fixed_steps(type);
}

static const char *no_error_control(const weft_stepper_type *type)
{
    return weft__adapts(type) ? NULL : "the method has no error control";
}

static const struct check {
    const char *name, *promise;
    check_fn *check;
    pointless_fn *pointless; /* NULL: never */
    bool once;               /* without quadratures only */
    bool modes;              /* in both modes of weft__usual */
} checks[] = {
    { "table", "the method's description makes sense; destroy accepts NULL",
      .check = weft__table_is_sane, .once = true },
    { "create", "create makes an instance and calls no rhs",
      .check = weft__create_calls_no_rhs, .modes = true },
    { "refusal", "create refuses every meaningless number, with a reason",
      .check = weft__mistakes_are_refused, .once = true },
    { "versions", "a config of an older or newer program is read up to its size",
      .check = weft__other_versions_are_served, .once = true },
    { "fixed", "fixed steps have the requested length and ignore tolerances",
      .check = weft__fixed_steps_ignore_tolerances, .pointless = no_fixed_steps },
    { "exact end", "a step never goes past t_end, meets it bit for bit, and counts",
      .check = weft__every_end_is_met, .modes = true },
    { "landing", "a single step lands on t_end bit for bit, wherever it began",
      .check = weft__a_single_step_lands_exactly, .pointless = no_fixed_steps },
    { "slivers", "fixed steps that fit leave no sliver of a step before t_end",
      .check = weft__steps_that_fit_leave_no_sliver, .pointless = no_fixed_steps },
    { "stages", "a step calls the rhs as often as the table says",
      .check = weft__stages_are_the_rhs_calls, .pointless = no_stages },
    { "step sizes", "first_step and max_step are respected",
      .check = weft__step_sizes_are_kept, .pointless = no_error_control },
    { "direction", "a step to a t_end that is not later is invalid and changes nothing",
      .check = weft__no_step_goes_backwards },
    { "failure",
      "a failed step leaves t and y alone, only finite states are accepted, and later "
      "steps succeed",
      .check = weft__a_failed_step_changes_nothing, .modes = true },
    { "refusal once",
      "a state that the rhs refuses, or that is not finite, costs a smaller step",
      .check = weft__one_refusal_costs_a_smaller_step, .pointless = no_error_control },
    { "rescue", "a first step that is far too large is made smaller",
      .check = weft__a_first_step_too_large_is_rescued, .pointless = no_error_control },
    { "min step", "a step that needs less than min_step fails; t and y stay",
      .check = weft__needing_less_than_min_step_fails, .pointless = no_error_control },
    { "needless",
      "state_changed without a change changes no result of a one-step method",
      .check = weft__needless_changes_change_nothing, .modes = true },
    { "edited", "the step after state_changed starts from the edited y",
      .check = weft__an_edited_state_is_used, .modes = true },
    { "set back",
      "the step after state_changed starts from the t and y that are set back",
      .check = weft__a_step_is_taken_back, .modes = true },
    { "stats", "stats fills the caller's struct and not a byte more",
      .check = weft__stats_write_no_further },
    { "counts", "counts never fall, whatever fails or is edited",
      .check = weft__stats_never_fall },
    { "instances", "instances that step in turn have the same results as alone",
      .check = weft__two_instances_are_independent },
    { "threads", "instances in two threads have the same results as alone",
      .check = weft__two_threads_are_independent },
    { "order", "in fixed steps the order is the one the table claims",
      .check = weft__the_order_is_the_one_claimed,
      .pointless = weft__order_not_measured, .once = true },
    { "tolerance", "the error follows the tolerance, in both norms",
      .check = weft__the_error_follows_the_tolerance, .pointless = no_error_control,
      .once = true },
    { "last step", "a step that ends at t_end is checked as any other",
      .check = weft__a_step_to_the_end_is_checked, .pointless = no_error_control },
    { "cut step", "a step that t_end has cut short does not shorten those after it",
      .check = weft__a_cut_step_shortens_no_other, .pointless = no_error_control },
    { "tolerances", "rtol, atol_position and atol_velocity each have their influence",
      .check = weft__each_tolerance_counts, .pointless = no_error_control,
      .once = true },
    { "numbers", "the error of each position and velocity counts, by its own tolerance",
      .check = weft__each_number_counts, .pointless = weft__no_rms_steps,
      .once = true },
    { "rms", "the rms norm is the root of a mean over positions and velocities",
      .check = weft__the_rms_norm_is_a_mean, .pointless = weft__no_rms_steps,
      .once = true },
    { "quadratures",
      "quadratures are integrals, and change no step and no bit of the state",
      .check = weft__quadratures_change_no_step,
      .pointless = weft__takes_no_quadratures, .once = true, .modes = true },
    { "memory", "steps leave no more memory allocated than there was",
      .check = weft__the_heap_does_not_grow, .pointless = weft__heap_not_known,
      .modes = true },
    { "destroy", "destroy gives back all that create and steps have allocated",
      .check = weft__destroy_leaves_nothing, .pointless = weft__heap_not_known,
      .modes = true },
    { "refused", "a create that refuses leaves no memory allocated",
      .check = weft__refusals_leave_nothing, .pointless = weft__heap_not_known,
      .once = true },
    { "allocator", "memory is taken from config->allocator and given back to it",
      .check = weft__the_allocator_is_used, .once = true },
    { "process",
      "the process stays as it is: locale, signal handlers, floating-point "
      "environment, descriptors, directory, umask, environment variables, timers, "
      "children; a success leaves *err alone",
      .check = weft__the_process_is_left_alone, .modes = true },
    { "structure", "config->structure changes the way to a solution, not the solution",
      .check = weft__a_structure_leaves_the_solution, .once = true, .modes = true },
    { "agree",
      "integrators of two parts of a state agree to do what one of the whole does",
      .check = weft__parts_agree, .pointless = weft__agrees_with_nobody, .once = true,
      .modes = true },
};

size_t weft_conformance_count(void)
{
    return sizeof checks / sizeof checks[0];
}

const char *weft_conformance_name(size_t i)
{
    return checks[i].name;
}

const char *weft_conformance_promise(size_t i)
{
    return checks[i].promise;
}

static void try_check(trial *self, check_fn *check)
{
    if (setjmp(self->broken) == 0) {
        check(self);
    }
    for (int slot = 0; slot < SLOTS; ++slot) {
        weft__end(self, slot);
    }
}

weft_conformance weft_conformance_check(const weft_stepper_type *type, size_t i)
{
    const struct check *c = &checks[i];
    weft_conformance out = { .verdict = WEFT_PROMISE_KEPT };
    const char *pointless = c->pointless == NULL ? NULL : c->pointless(type);
    if (pointless != NULL) {
        out.verdict = WEFT_PROMISE_NOT_ASKED;
        (void)snprintf(out.seen, sizeof out.seen, "%s", pointless);
        return out;
    }
    const bool apart = !c->once && (type->flags & WEFT_STEPPER_QUADRATURES) != 0;
    const int modes = c->modes && weft__adapts(type) && weft__takes_fixed(type) ? 2 : 1;
    for (int k = 0; k < modes * (1 + apart) && out.verdict == WEFT_PROMISE_KEPT; ++k) {
        trial self = {
            .type = type, .mode = k % modes, .apart = k < modes ? 0 : APART, .out = &out
        };
        try_check(&self, c->check);
    }
    return out;
}
