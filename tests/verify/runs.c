/* SPDX-License-Identifier: BSD-3-Clause */
/* runs.c -- a scene run by a method, as `weft run` would, and its frames kept. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/cli.h"
#include "verify/verify.h"

enum { SETS_MOST = 8, TEXT_MOST = 512 };

/* Merson's table, of which weft__with_table has the same. */
#define MERSON_YAML                                                                    \
    "{A: [[], [1/3], [1/6, 1/6], [1/8, 0, 3/8], [1/2, 0, -3/2, 2]], "                  \
    "b: [1/6, 0, 0, 2/3, 1/6], c: [0, 1/3, 1/3, 1/2, 1], order: 4, "                   \
    "b_embedded: [1/10, 0, 3/10, 2/5, 1/5], embedded_order: 3}"

/* The stepper of the scene is replaced as a whole. */
static void stepper_text(const verify_stepper *stepper, char text[TEXT_MOST])
{
    const weft_stepper_type *type = stepper->method.type;
    char steps[128];
    (void)snprintf(steps, sizeof steps,
                   stepper->fixed_step > 0.0 ? "fixed_step: %.17g"
                                             : "rtol: %.17g, atol: %.17g",
                   stepper->fixed_step > 0.0 ? stepper->fixed_step : stepper->tolerance,
                   stepper->tolerance);
    (void)snprintf(text, TEXT_MOST, "stepper={plugin: %s, method: %s, %s%s}",
                   stepper->method.plugin->id, type->name, steps,
                   (type->flags & WEFT_STEPPER_BUTCHER) != 0 ? ", butcher: " MERSON_YAML
                                                             : "");
}

static weft_status load(weft_registry *registry, const verify_scene *scene,
                        const verify_stepper *stepper, weft_scene **out,
                        weft_error *err)
{
    char file[TEXT_MOST], text[TEXT_MOST];
    const char *sets[SETS_MOST];
    arguments given = { .sets.at = sets, .registry = registry };
    (void)snprintf(file, sizeof file, "scenes/%s.yaml", scene->name);
    stepper_text(stepper, text);
    sets[given.sets.count++] = text;
    for (size_t i = 0; i < VERIFY_SETS && scene->sets[i] != NULL; ++i) {
        sets[given.sets.count++] = scene->sets[i];
    }
    if (open_scene(file, &given, out, NULL) != EXIT_DONE) {
        return weft_error_set(err, WEFT_BAD_SCENE, "%s does not load", file);
    }
    const weft_status status = scene_supported(*out, err);
    if (status != WEFT_OK) {
        weft_scene_destroy(*out);
        *out = NULL;
    }
    return status;
}

verify_size verify_size_of(weft_registry *registry, const verify_scene *scene,
                           const verify_stepper *stepper)
{
    weft_scene *loaded = NULL;
    if (load(registry, scene, stepper, &loaded, NULL) != WEFT_OK) {
        return (verify_size){ 0 };
    }
    const verify_size size
        = { .particles = weft_cloth_def_particles(weft_scene_cloth(loaded)),
            .duration = weft_scene_run(loaded)->duration };
    weft_scene_destroy(loaded);
    return size;
}

typedef struct keeper {
    verify_frames *frames;
    const weft_sim *sim;
} keeper;

static weft_status keep(void *ctx, size_t i, weft_error *err)
{
    const keeper *self = ctx;
    verify_frames *frames = self->frames;
    (void)err;
    const weft_energy energy = weft_cloth_energy(
        weft_sim_cloth(self->sim), weft_sim_time(self->sim), weft_sim_state(self->sim));
    frames->energy[i] = energy.kinetic + energy.gravitational + energy.elastic[0]
                        + energy.elastic[1] + energy.elastic[2];
    frames->kinetic = fmax(frames->kinetic, energy.kinetic);
    memcpy(frames->y + i * frames->dim, weft_sim_state(self->sim),
           frames->dim * sizeof *frames->y);
    return WEFT_OK;
}

static weft_status play_scene(const weft_scene *scene, weft_sim *sim,
                              verify_frames *out, weft_error *err)
{
    keeper self = { out, sim };
    const weft_play frames = { .run = weft_scene_run(scene),
                               .last = weft_run_last_frame(weft_scene_run(scene)),
                               .frame = keep,
                               .ctx = &self };
    out->count = frames.last + 1;
    out->dim = weft_cloth_dim(weft_sim_cloth(sim));
    out->y = calloc(out->count * out->dim, sizeof *out->y);
    out->energy = calloc(out->count, sizeof *out->energy);
    out->limited = weft_scene_limit(scene)->method != WEFT_LIMIT_NONE;
    out->touches = weft_scene_cloth(scene)->contact.self;
    weft_status status = out->y == NULL || out->energy == NULL
                             ? weft_error_set(err, WEFT_NO_MEMORY, "no memory")
                             : weft_sim_play(sim, &frames, err);
    out->stats = weft_sim_stats(sim);
    return status;
}

weft_status verify_run(weft_registry *registry, const verify_scene *scene,
                       const verify_stepper *stepper, verify_frames *out,
                       weft_error *err)
{
    weft_scene *loaded = NULL;
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    *out = (verify_frames){ 0 };
    weft_status status = load(registry, scene, stepper, &loaded, err);
    if (status == WEFT_OK) {
        status = simulation_create(loaded, NULL, &cloth, &sim, err);
    }
    if (status == WEFT_OK) {
        status = play_scene(loaded, sim, out, err);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(loaded);
    return status;
}

void verify_frames_free(verify_frames *frames)
{
    free(frames->y);
    free(frames->energy);
    *frames = (verify_frames){ 0 };
}

double verify_distance(const verify_frames *a, const verify_frames *b)
{
    double top = 0.0;
    if (a->count != b->count || a->dim != b->dim) {
        return (double)INFINITY;
    }
    for (size_t i = 0; i < a->count * a->dim; ++i) {
        const double apart = fabs(a->y[i] - b->y[i]);
        top = apart <= top ? top : isfinite(apart) ? apart : (double)INFINITY;
    }
    return top;
}
