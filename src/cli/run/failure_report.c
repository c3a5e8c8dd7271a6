/* SPDX-License-Identifier: BSD-3-Clause */
/* failure_report.c -- why a run has failed and what to try: the library's message, the
 * stable step then and at the start, advice. */
#include "cli/check/stable_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct bounds {
    double start, now, any; /* [s] stable steps; 0: none */
    double omega, damping;  /* [1/s] now */
} bounds;

static double step_of(const weft_scene *scene, const weft_stiffness *modes)
{
    survey_method own = { 0 };
    (void)stable_step(scene, weft_scene_method_type(scene), modes, &own, NULL);
    return own.step;
}

static bounds find_bounds(const weft_scene *scene, const weft_sim *sim)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_stiffness any = weft_cloth_stiffness(cloth, NULL);
    const weft_stiffness now = weft_cloth_stiffness(cloth, weft_sim_state(sim));
    bounds found = { .now = step_of(scene, &now),
                     .any = step_of(scene, &any),
                     .omega = sqrt(now.omega2),
                     .damping = now.damping };
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    if (y != NULL) {
        weft_cloth_start(cloth, y);
        const weft_stiffness start = weft_cloth_stiffness(cloth, y);
        found.start = step_of(scene, &start);
    }
    free(y);
    return found;
}

static void advise_fixed(double h, const bounds *found, char *text, size_t size)
{
    if (h > found->start) {
        (void)snprintf(text, size,
                       "try stepper.fixed_step=%.2g, 0.9 of the stable step at the "
                       "start, or see weft check for a method with a larger one",
                       0.9 * found->start);
    } else if (h > found->now) {
        (void)snprintf(text, size,
                       "the cloth has grown stiffer than it was at the start: try "
                       "stepper.fixed_step=%.2g, which is stable in any state",
                       found->any);
    } else {
        (void)snprintf(text, size,
                       "the step was a stable one: look at what drives the cloth "
                       "(pins, wind, loads), or try a tenth of the step");
    }
}

void trouble_describe(const weft_scene *scene, const weft_sim *sim,
                      const weft_error *why, char *text, size_t size)
{
    const double h = step_taken(scene);
    (void)snprintf(text, size, "%s", why->message);
    if (why->status == WEFT_IO || why->status == WEFT_NO_MEMORY) {
        return;
    }
    const bounds found = find_bounds(scene, sim);
    char advice[256];
    if (h > 0.0 && found.start > 0.0) {
        advise_fixed(h, &found, advice, sizeof advice);
    } else {
        (void)snprintf(advice, sizeof advice,
                       "try looser tolerances, a smaller stepper.min_step or another "
                       "method, and look at what drives the cloth there");
    }
    const size_t used = strlen(text);
    if (found.start > 0.0) {
        (void)snprintf(text + used, size - used,
                       "; stable step of %s %s %.3g s at the start, %.3g s in this "
                       "state (omega <= %.3g 1/s, damping <= %.3g 1/s); %s",
                       weft_scene_plugin(scene), weft_scene_method(scene), found.start,
                       found.now, found.omega, found.damping, advice);
    } else {
        (void)snprintf(text + used, size - used, "; %s", advice);
    }
}

void trouble_print(const char *text)
{
    const char *lead = "weft: error: ";
    while (*text != '\0') {
        const char *end = strstr(text, "; ");
        const size_t length = end == NULL ? strlen(text) : (size_t)(end - text);
        fprintf(stderr, "%s%.*s\n", lead, (int)length, text);
        text += length + (end == NULL ? 0 : 2);
        lead = "  ";
    }
}
