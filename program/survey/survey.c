/* SPDX-License-Identifier: BSD-3-Clause */
/* survey.c -- the cost of every method on a scene: the largest stable step of each,
 * and a short trial of the scene's own under its tolerances. */
#include "program/survey/survey.h"

#include <math.h>
#include <stdlib.h>

/* RHS calls times particles of a trial, and its least number of steps. */
#define TRIAL_WORK 1.5e6
enum { TRIAL_SKIPPED = 3, TRIAL_LEAST = 10 };

/* The allowance for undamped modes may lengthen a stable step a little. A step counts
 * as doubling if the one without the allowance is less than this part of it. */
#define DOUBLING 0.9

/* A step of at least this part of the stable one was limited by stability. */
#define HELD 0.8

#define LN_2 0.69314718055994531

/* Steppers take the rest of a frame in one step if it exceeds h by at most this part.
 */
#define REST 1e-6

double frame_steps(const weft_run_def *run, double h)
{
    return fmax(1.0, ceil(weft_run_frame_time(run, 1) / h - REST));
}

double step_taken(const weft_scene *scene)
{
    const weft_run_def *run = weft_scene_run(scene);
    const double h = weft_scene_config(scene)->fixed_step;
    return h > 0.0 && !(frame_steps(run, h) > 1.0) ? weft_run_frame_time(run, 1) : h;
}

static weft_status survey_stability(const weft_scene *scene,
                                    const weft_stepper_type *type, weft_stability *out,
                                    weft_error *err)
{
    const bool custom = (type->flags & WEFT_STEPPER_BUTCHER) != 0;
    return weft_stability_create(
        type, custom ? weft_scene_config(scene)->butcher : NULL, out, err);
}

static double allowed_growth(const weft_scene *scene)
{
    return LN_2 / weft_scene_run(scene)->duration;
}

weft_status stable_step(const weft_scene *scene, const weft_stepper_type *type,
                        const weft_stiffness *modes, survey_method *out,
                        weft_error *err)
{
    weft_stability stability;
    double strict = 0.0;
    out->type = type;
    out->step = 0.0;
    weft_status status = survey_stability(scene, type, &stability, err);
    if (status == WEFT_OK) {
        status = weft_stability_step(&stability, modes, allowed_growth(scene),
                                     &out->step, err);
    }
    if (status == WEFT_OK) {
        status = weft_stability_calls(&stability, modes, out->step, &out->calls, err);
    }
    if (status == WEFT_OK && stability.degree >= 0) {
        status = weft_stability_step(&stability, modes, 0.0, &strict, err);
        out->doubling = strict < DOUBLING * out->step;
    }
    return status;
}

double own_stable_step(const weft_scene *scene, const weft_stiffness *modes)
{
    survey_method own = { 0 };
    const weft_status status
        = stable_step(scene, weft_scene_method_type(scene), modes, &own, NULL);
    return status == WEFT_OK ? own.step : 0.0;
}

double advised_step(double start, double any)
{
    return 0.9 * (any > 0.0 ? fmin(start, any) : start);
}

const char *advised_for(double any)
{
    return any > 0.0 ? "which is stable in any state" : "which is stable at the start";
}

/* Damping that more than halves the step of the same modes without damping does. */
#define HALF_STEP 0.5

const char *limiting_bound(const weft_scene *scene, const weft_stiffness *modes)
{
    const weft_stiffness undamped
        = { .omega2 = modes->omega2,
            .count = 2,
            .corners = { { 0.0, 0.0 }, { modes->omega2, 0.0 } } };
    const double stable = own_stable_step(scene, modes);
    return stable < HALF_STEP * own_stable_step(scene, &undamped)
               ? "the damping of the cloth limits it, not the stiffness"
               : "the stiffness of the cloth limits it, not the damping";
}

double calls_per_second(const weft_scene *scene, const survey_method *method, double h)
{
    const weft_run_def *run = weft_scene_run(scene);
    return method->calls * frame_steps(run, h) / weft_run_frame_time(run, 1);
}

/* The cheapest first, of equal ones that of higher order, then of the longer step, then
 * that with the same bits everywhere. */
static int compare(const void *first, const void *second)
{
    const survey_method *a = first, *b = second;
    const int costs = (a->per_second > b->per_second) - (a->per_second < b->per_second);
    const int order = b->type->order - a->type->order;
    const int steps = (b->step > a->step) - (b->step < a->step);
    const bool libm[] = { (a->type->flags & WEFT_STEPPER_LIBM) != 0,
                          (b->type->flags & WEFT_STEPPER_LIBM) != 0 };
    return costs != 0   ? costs
           : order != 0 ? order
           : steps != 0 ? steps
                        : libm[0] - libm[1];
}

/* The key for which the scene would be refused with a method, as weft reads scenes
 * (weft__check_record, weft__check_smooth); NULL: it would not be. */
static const char *refused_key(const weft_scene *scene, const weft_stepper_type *type)
{
    const bool meshed = weft_scene_cloth(scene)->mesh != NULL;
    const bool history = (type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    const bool linear = (type->flags & WEFT_STEPPER_LINEAR) != 0;
    if (weft_scene_record(scene)->ledger
        && (type->flags & WEFT_STEPPER_QUADRATURES) == 0) {
        return "record.ledger";
    }
    return weft_scene_sensitivities(scene)->count > 0 && (history || (linear && meshed))
               ? "sensitivity"
               : NULL;
}

weft_status survey_methods(const weft_scene *scene, const weft_registry *registry,
                           survey *out, weft_error *err)
{
    const weft_stepper_type *own = weft_scene_method_type(scene);
    stepper_method m;
    const size_t room = method_count(registry);
    out->methods = calloc(room + 1, sizeof *out->methods);
    if (out->methods == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu methods", room);
    }
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        /* a scene's own table is no method of other scenes */
        if ((m.type->flags & WEFT_STEPPER_BUTCHER) != 0 && m.type != own) {
            continue;
        }
        survey_method *method = &out->methods[out->count++];
        if (stable_step(scene, m.type, &out->modes, method, err) == WEFT_NO_MEMORY) {
            return WEFT_NO_MEMORY;
        }
        method->plugin = m.plugin;
        method->refuses = refused_key(scene, m.type);
        method->per_second = method->step > 0.0
                                 ? calls_per_second(scene, method, method->step)
                                 : INFINITY;
    }
    qsort(out->methods, out->count, sizeof *out->methods, compare);
    for (size_t i = 0; i < out->count; ++i) {
        out->own = out->methods[i].type == own ? &out->methods[i] : out->own;
    }
    return WEFT_OK;
}

/* The scene's method from t = 0 on, past its first steps. A failure only ends it. */
static void trial(const weft_scene *scene, weft_sim *sim, survey *out)
{
    const double end = weft_scene_run(scene)->duration;
    const double budget
        = TRIAL_WORK / (double)weft_cloth_particles(weft_sim_cloth(sim));
    const double held = HELD * (out->own == NULL ? 0.0 : out->own->step);
    double from = 0.0, calls = 0.0, steps = 0.0, stable = 0.0;
    for (int i = 0; weft_sim_time(sim) < end; ++i) {
        const weft_stepper_stats stats = weft_sim_stats(sim);
        if (i == TRIAL_SKIPPED) {
            from = weft_sim_time(sim);
            calls = (double)stats.rhs_calls;
        }
        if ((double)stats.rhs_calls > budget
            || weft_sim_step(sim, end, NULL) != WEFT_OK) {
            break;
        }
        if (i >= TRIAL_SKIPPED) {
            steps += 1.0;
            stable += weft_sim_stats(sim).last_step >= held ? 1.0 : 0.0;
        }
    }
    if (steps >= TRIAL_LEAST) {
        const double time = weft_sim_time(sim) - from;
        out->trial_steps = (size_t)steps;
        out->trial_held = stable / steps;
        out->trial_mean = time / steps;
        out->trial_calls = ((double)weft_sim_stats(sim).rhs_calls - calls) / time;
    }
}

/* The RHS calls of the adaptive method of the highest order above that of the scene, up
 * to the end of the trial. */
static weft_status try_rival(const weft_scene *scene, const weft_sim *tried,
                             const double *start, survey *out, weft_error *err)
{
    const survey_method *rival = out->own;
    for (size_t i = 0; i < out->count; ++i) {
        const survey_method *other = &out->methods[i];
        if (method_adapts(other->type) && other->step > 0.0 && other->refuses == NULL
            && other->type->order > rival->type->order) {
            rival = other;
        }
    }
    if (rival == out->own) {
        return WEFT_OK;
    }
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = weft_sim_cloth(tried);
    def.method = rival->type;
    def.config = *weft_scene_config(scene);
    def.config.butcher = NULL;
    def.start = start;
    const weft_status status = weft_sim_create(&def, &sim, err);
    const double calls = (double)weft_sim_stats(tried).rhs_calls;
    const double end = weft_sim_time(tried);
    if (status == WEFT_UNSUPPORTED || status == WEFT_INVALID) {
        return WEFT_OK; /* not with these settings */
    }
    while (status == WEFT_OK && weft_sim_time(sim) < end
           && (double)weft_sim_stats(sim).rhs_calls < calls / WORTH
           && weft_sim_step(sim, end, NULL) == WEFT_OK) {
    }
    if (status == WEFT_OK && weft_sim_time(sim) == end) {
        out->rival = rival;
        out->rival_saves = calls / (double)weft_sim_stats(sim).rhs_calls;
    }
    weft_sim_destroy(sim);
    return status;
}

/* The scene's own adaptive explicit method, or the one that scenes begin with. */
static const survey_method *explicit_method(const survey *of)
{
    const bool own = of->own != NULL && method_adapts(of->own->type)
                     && (of->own->type->flags & WEFT_STEPPER_STRUCTURE) == 0
                     && (of->own->type->flags & WEFT_STEPPER_BUTCHER) == 0;
    return own ? of->own : survey_find(of, "arkode", "dormand_prince");
}

/* Meshes only: gains on grids are foretold (stiff_methods.c). */
static weft_status try_methods(const weft_scene *scene, const weft_cloth *cloth,
                               const double *start, survey *out, weft_error *err)
{
    const survey_method *ros2 = survey_find(out, "stiff", "ros2"),
                        *other = explicit_method(out);
    const bool limited = weft_scene_limit(scene)->method != WEFT_LIMIT_NONE;
    if (ros2 == NULL || limited || weft_scene_cloth(scene)->mesh == NULL) {
        return WEFT_OK;
    }
    TRY(try_method(scene, cloth, ros2, start, NULL, &out->implicit, err));
    if (!(out->implicit.work > 0.0) || other == NULL) {
        return WEFT_OK;
    }
    return try_method(scene, cloth, other, start, &out->implicit, &out->explicit, err);
}

weft_status survey_create(const weft_scene *scene, const weft_cloth *cloth,
                          weft_sim *sim, const double *start, const arguments *given,
                          survey *out, weft_error *err)
{
    *out = (survey){ 0 };
    (void)load_plugins(given->registry, NULL);
    out->now = out->modes = out->any = weft_cloth_stiffness(cloth, 0.0, NULL);
    if (sim != NULL) { /* else its plugin is missing: the bounds of every state */
        const double *y = weft_sim_state(sim), t = weft_sim_time(sim);
        out->now = out->modes = weft_cloth_stiffness(cloth, t, y);
        out->refined = given->refine;
        if (out->refined) {
            TRY(weft_cloth_stiffness_refined(cloth, t, y, 0, &out->modes, err));
        }
    }
    TRY(survey_methods(scene, given->registry, out, err));
    if (out->own != NULL && out->own->step > 0.0
        && (out->own->type->flags & WEFT_STEPPER_STRUCTURE) == 0) {
        TRY(stable_step(scene, out->own->type, &out->any, &out->any_state, err));
    }
    if (sim != NULL) {
        TRY(try_methods(scene, cloth, start, out, err));
    }
    const bool small
        = out->own != NULL && (out->own->type->flags & WEFT_STEPPER_DENSE) != 0;
    if (sim == NULL || weft_scene_config(scene)->fixed_step > 0.0 || small) {
        return WEFT_OK;
    }
    trial(scene, sim, out);
    const bool limited = weft_scene_limit(scene)->method != WEFT_LIMIT_NONE;
    return out->trial_steps > 0 && survey_held(out) < 0.5 && !limited
               ? try_rival(scene, sim, start, out, err)
               : WEFT_OK;
}

double survey_held(const survey *of)
{
    return of->own != NULL && of->own->step > 0.0 ? of->trial_held : 0.0;
}

void survey_destroy(survey *self)
{
    free(self->methods);
}

/* From the stable steps at the start, of those modes, and in any state [s]. */
static void warn_of_step(const weft_scene *scene, const weft_stiffness *modes,
                         double start, double any)
{
    fprintf(stderr,
            "weft: warning: a fixed step of %.4g s is beyond the largest stable step "
            "%.4g s of %s %s on this cloth\n"
            "  omega <= %.4g 1/s, damping <= %.4g 1/s at the start: %s\n"
            "  try stepper.fixed_step=%.2g, %s, or see weft check for other methods\n",
            step_taken(scene), start, weft_scene_plugin(scene),
            weft_scene_method(scene), sqrt(modes->omega2), modes->damping,
            limiting_bound(scene, modes), advised_step(start, any), advised_for(any));
}

bool stability_warn(const weft_scene *scene, const weft_sim *sim, bool quiet)
{
    const weft_stiffness modes
        = weft_sim_stiffness(sim, weft_sim_time(sim), weft_sim_state(sim));
    const double h = step_taken(scene);
    weft_stability own;
    bool reaches = false; /* which is found sooner than the stable step */
    const bool known
        = h > 0.0
          && survey_stability(scene, weft_scene_method_type(scene), &own, NULL)
                 == WEFT_OK
          && weft_stability_reaches(&own, &modes, allowed_growth(scene), h, &reaches,
                                    NULL)
                 == WEFT_OK;
    const double stable
        = h > 0.0 && !(known && reaches) ? own_stable_step(scene, &modes) : 0.0;
    const bool beyond = stable > 0.0 && h > stable;
    if (beyond) {
        const weft_stiffness in_any = weft_sim_stiffness(sim, 0.0, NULL);
        const double any = own_stable_step(scene, &in_any);
        if (!quiet) {
            warn_of_step(scene, &modes, stable, any);
        }
    }
    return beyond;
}
