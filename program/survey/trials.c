/* SPDX-License-Identifier: BSD-3-Clause */
/* trials.c -- tries an implicit method on the scene, up to a tenth of a second after
 * the cloth first touches something: how many of its steps contact rejects or
 * rejects is not known otherwise. */
#include "program/survey/survey.h"

#include <math.h>

/* Of a trial: work, as below, times particles; [s] after the first touch. */
#define MOST_WORK   3e6
#define TOUCH_TIME  0.1
#define LEAST_STEPS 10

/* The tolerances of the trial. Velocities need loose ones: at those of positions a
 * stiff but invisible vibration of contact sets the steps. */
#define RTOL          1e-3
#define ATOL_POSITION 1e-3 /* [m] */
#define ATOL_VELOCITY 1.0  /* [m/s] */

/* Work in evaluations: what an iteration of a linear system and a Jacobian take on the
 * shipped scenes of triangles, whose evaluations take 0.04 to 0.7 ms. */
#define ITERATION 2.0
#define JACOBIAN  5.0

static double work_of(const weft_sim *sim)
{
    const weft_stepper_stats stats = weft_sim_stats(sim);
    return (double)stats.rhs_calls + ITERATION * (double)stats.linear_iterations
           + JACOBIAN * (double)stats.factorisations;
}

static bool touches(const weft_sim *sim)
{
    const weft_measures now = weft_sim_measure(sim);
    return now.touching > 0 || now.self_touching > 0;
}

/* The part of a trial that is measured. */
typedef struct trial_part {
    double time, work; /* at its start */
    size_t steps;
} trial_part;

static void measure_part(const weft_sim *sim, const trial_part *of, survey_trial *out)
{
    const double time = weft_sim_time(sim) - of->time;
    if (of->steps >= LEAST_STEPS && time > 0.0) {
        out->work = (work_of(sim) - of->work) / time;
        out->end = weft_sim_time(sim);
        out->from = of->time;
    }
}

static bool step_within(weft_sim *sim, double end, double work)
{
    return weft_sim_time(sim) < end && work_of(sim) < work
           && weft_sim_step(sim, end, NULL) == WEFT_OK;
}

static double work_allowed(const weft_sim *sim)
{
    return MOST_WORK / (double)weft_cloth_particles(weft_sim_cloth(sim));
}

/* From the first touch on, where there are enough steps, else from the start. */
static void try_to_touch(weft_sim *sim, double duration, survey_trial *out)
{
    trial_part all = { 0 }, touching = { 0 };
    double end = duration;
    bool touched = false;
    bool continues = true;
    while (continues) {
        if (!touched && touches(sim)) {
            touching = (trial_part){ weft_sim_time(sim), work_of(sim), 0 };
            end = fmin(duration, touching.time + TOUCH_TIME);
            touched = true;
        }
        continues = step_within(sim, end, work_allowed(sim));
        all.steps += continues, touching.steps += continues && touched;
    }
    measure_part(sim, &all, out);
    if (touched && touching.steps >= LEAST_STEPS) {
        measure_part(sim, &touching, out);
        out->touches = true;
    }
}

/* In the same part of the motion as another trial. */
static void try_again(weft_sim *sim, const survey_trial *other, survey_trial *out)
{
    trial_part same = { 0 };
    while (step_within(sim, other->from, work_allowed(sim))) {
    }
    same = (trial_part){ weft_sim_time(sim), work_of(sim), 0 };
    while (same.time >= other->from
           && step_within(sim, other->end, work_allowed(sim))) {
        ++same.steps;
    }
    measure_part(sim, &same, out);
}

weft_status try_method(const weft_scene *scene, const weft_cloth *cloth,
                       const survey_method *method, const double *start,
                       const survey_trial *other, survey_trial *out, weft_error *err)
{
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    *out = (survey_trial){ .method = method,
                           .rtol = RTOL,
                           .atol = { ATOL_POSITION, ATOL_VELOCITY } };
    def.cloth = cloth;
    def.method = method->type;
    def.config.threads = weft_scene_config(scene)->threads;
    def.config.rtol = RTOL;
    def.config.atol_position = ATOL_POSITION;
    def.config.atol_velocity = ATOL_VELOCITY;
    def.start = start;
    const weft_status status = weft_sim_create(&def, &sim, err);
    if (status == WEFT_OK && other != NULL) {
        try_again(sim, other, out);
    } else if (status == WEFT_OK) {
        try_to_touch(sim, weft_scene_run(scene)->duration, out);
    }
    weft_sim_destroy(sim);
    return status == WEFT_UNSUPPORTED || status == WEFT_INVALID ? WEFT_OK : status;
}
