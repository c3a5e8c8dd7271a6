/* SPDX-License-Identifier: BSD-3-Clause */
/* stable_steps.c -- prints a survey of stable steps, and advice. */
#include <math.h>

#include "program/check/check.h"

/* Methods in the short table, with the scene's own; the factor in cost that a higher
 * order is worth. */
enum { SHORT_TABLE = 5 };
#define ORDER 1.25

/* Among the methods that the scene takes, the cheapest of order 2 and more, or one of
 * higher order that costs little more; the first if there is none. Methods of order 1
 * miss a millimetre at their stable steps. */
static const survey_method *recommended(const survey *of)
{
    const survey_method *least = NULL, *best = &of->methods[0];
    for (size_t i = 0; i < of->count; ++i) {
        const survey_method *other = &of->methods[i];
        if (other->refuses != NULL) {
            continue;
        }
        best = best->refuses != NULL ? other : best;
        least = least == NULL && other->type->order >= 2 ? other : least;
        if (least != NULL && other->per_second <= ORDER * least->per_second
            && other->type->order > best->type->order) {
            best = other;
        }
    }
    return best;
}

/* "verlet velocity_verlet at its stable step needs 3.1 x fewer evaluations" */
static void say_cheapest(const weft_scene *scene, const survey *of, sentence *out)
{
    const survey_method *best = recommended(of);
    const double h = step_taken(scene);
    const double own_cost = h > 0.0 && of->own != NULL
                                ? calls_per_second(scene, of->own, h)
                                : of->trial_calls;
    const double factor = own_cost / best->per_second; /* 0: not known */
    if (!(factor >= WORTH) || !isfinite(factor)) {
        say(out, "no method needs notably fewer evaluations%s",
            h < weft_run_frame_time(weft_scene_run(scene), 1) ? ""
                                                              : " at this run.fps");
    } else if (best == of->own) {
        say(out, "that step needs %.2g x fewer evaluations", factor);
    } else {
        say(out, "%s %s at its stable step needs %.2g x fewer evaluations%s",
            best->plugin->id, best->type->name, factor,
            best->type->error_order == 0 ? ", without error control" : "");
    }
}

static void advise_adaptive(const weft_scene *scene, const survey *of, sentence *out)
{
    const survey_method *own = of->own;
    if (survey_held(of) >= 0.5) {
        say(out, "%.0f %% stability-limited (a trial of %zu steps): ",
            100.0 * of->trial_held, of->trial_steps);
        say_cheapest(scene, of, out);
    } else if (!(own->step > 0.0)) {
        say(out,
            "%s %s has no stable step to compare with, %.2g s on average in a trial: ",
            own->plugin->id, own->type->name, of->trial_mean);
        say_cheapest(scene, of, out);
    } else {
        say(out,
            "the tolerances limit the step (%.2g s on average in a trial, %.0f %% of "
            "the stable one): ",
            of->trial_mean, 100.0 * of->trial_mean / own->step);
        if (of->rival != NULL) {
            say(out, "%s %s needs %.2g x fewer evaluations under them",
                of->rival->plugin->id, of->rival->type->name, of->rival_saves);
        } else {
            say(out, "only looser ones save evaluations");
        }
    }
}

static sentence advise(const weft_scene *scene, const survey *of)
{
    sentence out = { "" };
    if (of->own == NULL || !(of->now.omega2 + of->now.damping > 0.0)) {
        return out;
    }
    const double h = step_taken(scene), most = of->own->step;
    if (h > 0.0 && most > 0.0 && h > most) {
        say(&out,
            "a fixed step of %.3g s is beyond the stable %.3g s: the run may blow up",
            h, most);
    } else if (h > 0.0 && most > 0.0) {
        say(&out, "the fixed step is %.2g %% of the stable step: ", 100.0 * h / most);
        say_cheapest(scene, of, &out);
    } else if (of->trial_steps > 0) {
        advise_adaptive(scene, of, &out);
    }
    return out;
}

/* Empty without springs. */
static sentence stiffness(const weft_scene *scene, const survey *of)
{
    const stiff_gains gains = stiff_gains_of(of, weft_scene_cloth(scene));
    sentence out = { "" };
    if (gains.omega > 0.0) {
        stiff_say(&gains, &out);
    }
    return out;
}

/* Whether a method with an allowance was shown. */
static bool print_table(const survey *of, bool all)
{
    printf("             %-8s %-18s %12s  %s\n", "plugin", "method", "stable step",
           "evaluations/simulated s");
    size_t shown = 0;
    bool doubling = false;
    for (size_t i = 0; i < of->count; ++i) {
        const survey_method *method = &of->methods[i];
        /* methods with the same stability polynomial count once */
        const bool is_new = i == 0 || method->step != method[-1].step
                            || method->calls != method[-1].calls
                            || method[-1].refuses != NULL;
        const bool brief = shown < SHORT_TABLE && method->step > 0.0 && is_new
                           && method->refuses == NULL;
        if (!all && method != of->own && !brief) {
            continue;
        }
        printf("             %-8s %-18s", method->plugin->id, method->type->name);
        if (method->step > 0.0) {
            printf(" %10.4g s %12.4g%s", method->step, method->per_second,
                   method->doubling ? " *" : "");
        } else {
            printf(" %10s   %12s", "-", "-");
        }
        printf(method->refuses != NULL ? "  without %s\n" : "\n", method->refuses);
        ++shown;
        doubling = doubling || method->doubling;
    }
    return doubling;
}

void stability_print(const weft_scene *scene, const survey *of, bool all)
{
    const sentence advice = advise(scene, of);
    print_item("stability",
               "omega <= %.4g 1/s, damping <= %.4g 1/s at the start; <= %.4g "
               "and %.4g 1/s in any state",
               sqrt(of->now.omega2), of->now.damping, sqrt(of->any.omega2),
               of->any.damping);
    if (of->refined) {
        print_item("",
                   "omega >= %.4g 1/s, damping >= %.4g 1/s by the power "
                   "method; the steps are from these",
                   sqrt(of->modes.omega2), of->modes.damping);
    }
    const bool doubling = print_table(of, all);
    if (of->any_state.step > 0.0) {
        print_item("", "in any state %s %s is stable up to %.4g s%s",
                   of->own->plugin->id, of->own->type->name, of->any_state.step,
                   of->any_state.doubling ? " *" : "");
    }
    if (doubling || of->any_state.doubling) {
        print_item("",
                   "* no step is stable on undamped modes; at this one none more than "
                   "doubles in the %g s of the run",
                   weft_scene_run(scene)->duration);
    }
    if (advice.text[0] != '\0') {
        print_item("advice", "%s", advice.text);
    }
    const sentence stiff = stiffness(scene, of);
    if (stiff.text[0] != '\0') {
        print_item("stiffness", "%s", stiff.text);
    }
}

static void modes_yaml(yaml_out *out, const char *key, const weft_stiffness *modes)
{
    yaml_out_write(out, "%s: { omega: %g, damping: %g }", key, sqrt(modes->omega2),
                   modes->damping);
}

static void trial_yaml(yaml_out *out, const char *key, const survey_trial *of)
{
    if (of->work > 0.0) {
        yaml_out_write(
            out,
            "%s: { plugin: \"%s\", method: \"%s\", rtol: %g, atol: [%g, %g], "
            "from: %g, end: %g, work_per_second: %g }",
            key, of->method->plugin->id, of->method->type->name, of->rtol, of->atol[0],
            of->atol[1], of->from, of->end, of->work);
    }
}

void stability_yaml(yaml_out *out, const weft_scene *scene, const survey *of)
{
    modes_yaml(out, "at_the_start", &of->now);
    modes_yaml(out, "in_any_state", &of->any);
    if (of->refined) {
        modes_yaml(out, "power_method", &of->modes);
    }
    yaml_out_write(out, "methods: [");
    for (size_t i = 0; i < of->count; ++i) {
        const survey_method *method = &of->methods[i];
        yaml_out_write(out, "{ plugin: \"%s\", method: \"%s\", of_the_scene: %s",
                       method->plugin->id, method->type->name,
                       yaml_bool(method == of->own));
        if (method->step > 0.0) {
            yaml_out_write(out,
                           "stable_step: %g, rhs_calls_per_second: %g, "
                           "undamped_modes_double: %s",
                           method->step, method->per_second,
                           yaml_bool(method->doubling));
        }
        yaml_out_write(out, "}");
    }
    yaml_out_write(out, "]");
    if (of->trial_steps > 0) {
        yaml_out_write(out,
                       "trial: { steps: %zu, held_by_stability: %g, mean_step: %g, "
                       "rhs_calls_per_second: %g }",
                       of->trial_steps, of->trial_held, of->trial_mean,
                       of->trial_calls);
    }
    trial_yaml(out, "implicit_trial", &of->implicit);
    trial_yaml(out, "explicit_trial", &of->explicit);
    yaml_out_write(out, "advice: \"%s\", stiffness: \"%s\"", advise(scene, of).text,
                   stiffness(scene, of).text);
}
