/* SPDX-License-Identifier: BSD-3-Clause */
/* failure_report.c -- why a run has failed, the stable step then and at the start, and
 * what to try. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/check/stable_steps.h"
#include "cli/human.h"
#include "cli/run/run.h"

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
    const weft_stiffness any = weft_cloth_stiffness(cloth, 0.0, NULL);
    const weft_stiffness now
        = weft_cloth_stiffness(cloth, weft_sim_time(sim), weft_sim_state(sim));
    bounds found = { .now = step_of(scene, &now),
                     .any = step_of(scene, &any),
                     .omega = sqrt(now.omega2),
                     .damping = now.damping };
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    if (y != NULL) {
        weft_cloth_start(cloth, y);
        const weft_stiffness start = weft_cloth_stiffness(cloth, 0.0, y);
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

static void set_advice(const weft_scene *scene, const bounds *found, char *text,
                       size_t size)
{
    const double h = step_taken(scene);
    if (h > 0.0 && found->start > 0.0) {
        advise_fixed(h, found, text, size);
    } else {
        (void)snprintf(text, size,
                       "try looser tolerances, a smaller stepper.min_step or another "
                       "method, and look at what drives the cloth there");
    }
}

/* To stderr, and to text with "; " between the lines. */
WEFT_PRINTF(3, 4)
static void add_line(char *text, size_t size, const char *format, ...)
{
    char line[768];
    const size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(line, sizeof line, format, args);
    va_end(args);
    fputs(used == 0 ? "weft: error: " : "  ", stderr);
    print_plain(stderr, line, "");
    fputc('\n', stderr);
    (void)snprintf(text + used, size - used, "%s%s", used == 0 ? "" : "; ", line);
}

static void add_state(const weft_failure *failure, size_t cols, char *text, size_t size)
{
    const weft_spring *worst = &failure->spring;
    const double *x = failure->position;
    char spring[SPRING];
    add_line(text, size, "%s at t = %.9g s, last h = %.3g s", failure->reason,
             failure->time, failure->last_step);
    add_line(text, size,
             "fastest particle (%zu, %zu) at (%.3g, %.3g, %.3g) m, %.3g m/s",
             failure->particle / cols, failure->particle % cols, x[0], x[1], x[2],
             failure->speed);
    if (worst->p == worst->q) {
        add_line(text, size, "no springs");
    } else {
        add_line(text, size, "most strained %s at %.3g %%",
                 weft_spring_text(worst, cols, spring, sizeof spring),
                 100.0 * worst->strain);
    }
    add_line(text, size, "energy %.4g J before that step", failure->energy);
}

void failure_report(const weft_scene *scene, const weft_sim *sim,
                    const weft_failure *failure, char *text, size_t size)
{
    char advice[256];
    text[0] = '\0';
    add_state(failure, weft_cloth_cols(weft_sim_cloth(sim)), text, size);
    if (failure->status == WEFT_NO_MEMORY) {
        return;
    }
    const bounds found = find_bounds(scene, sim);
    set_advice(scene, &found, advice, sizeof advice);
    if (found.start > 0.0) {
        add_line(
            text, size,
            "stable step of %s %s %.3g s at the start, %.3g s in this state (omega "
            "<= %.3g 1/s, damping <= %.3g 1/s)",
            weft_scene_plugin(scene), weft_scene_method(scene), found.start, found.now,
            found.omega, found.damping);
    }
    add_line(text, size, "%s", advice);
}
