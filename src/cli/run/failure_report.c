/* SPDX-License-Identifier: BSD-3-Clause */
/* failure_report.c -- reports the reason of a failure, the stable step then and at the
 * start, and advice. */
#include <math.h>
#include <stdlib.h>

#include "cli/run/run.h"
#include "cli/survey/survey.h"

typedef struct bounds {
    double start, now, any; /* [s] stable steps; 0: none */
    double omega, damping;  /* [1/s] now */
} bounds;

static bounds find_bounds(const weft_scene *scene, const weft_comm *comm,
                          const weft_sim *sim)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_stiffness any = weft_sim_stiffness(sim, 0.0, NULL);
    const weft_stiffness now
        = weft_sim_stiffness(sim, weft_sim_time(sim), weft_sim_state(sim));
    bounds found = { .now = own_stable_step(scene, &now),
                     .any = own_stable_step(scene, &any),
                     .omega = sqrt(now.omega2),
                     .damping = now.damping };
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    if (weft_comm_agree(comm, y == NULL ? WEFT_NO_MEMORY : WEFT_OK, NULL) == WEFT_OK) {
        weft_cloth_start(cloth, y);
        const weft_stiffness start = weft_sim_stiffness(sim, 0.0, y);
        found.start = own_stable_step(scene, &start);
    }
    free(y);
    return found;
}

static const char *advise_fixed(double h, const bounds *found, sentence *out)
{
    if (h > found->start) {
        say(out,
            "try stepper.fixed_step=%.2g, 0.9 of the stable step at the start, or see "
            "weft check for a method with a larger one",
            0.9 * found->start);
    } else if (h > found->now) {
        say(out,
            "the cloth has grown stiffer than it was at the start: try "
            "stepper.fixed_step=%.2g, which is stable in any state",
            found->any);
    } else {
        say(out,
            "the step was a stable one: look at what drives the cloth (pins, wind, "
            "loads), or try a tenth of the step");
    }
    return out->text;
}

/* To stderr, and to *out with "; " between the lines. */
WEFT_PRINTF(2, 3)
static void add_line(sentence *out, const char *format, ...)
{
    char line[768];
    const bool first = out->text[0] == '\0';
    va_list args;
    va_start(args, format);
    (void)vsnprintf(line, sizeof line, format, args);
    va_end(args);
    print_line(stderr, "%s%s", first ? "weft: error: " : "  ", line);
    say(out, "%s%s", first ? "" : "; ", line);
}

static void add_state(const weft_failure *failure, const weft_cloth *cloth,
                      sentence *out)
{
    const weft_spring *worst = &failure->spring;
    const double *x = failure->position;
    char spring[SPRING], fastest[SPRING];
    add_line(out, "%s at t = %.9g s, last h = %.3g s", failure->reason, failure->time,
             failure->last_step);
    add_line(out, "fastest %s at (%.3g, %.3g, %.3g) m, %.3g m/s",
             weft_particle_text(cloth, failure->particle, fastest, sizeof fastest),
             x[0], x[1], x[2], failure->speed);
    if (worst->p == worst->q) {
        add_line(out, "no springs");
    } else {
        add_line(out, "most strained %s at %.3g %%",
                 weft_spring_text(cloth, worst, spring, sizeof spring),
                 100.0 * worst->strain);
    }
    add_line(out, "energy %.4g J before that step", failure->energy);
}

void failure_report(const weft_scene *scene, const weft_comm *comm, const weft_sim *sim,
                    const weft_failure *failure, sentence *out)
{
    sentence advice = { "" };
    const double h = step_taken(scene);
    out->text[0] = '\0';
    add_state(failure, weft_sim_cloth(sim), out);
    if (failure->status == WEFT_NO_MEMORY) {
        return;
    }
    const bounds found = find_bounds(scene, comm, sim);
    if (found.start > 0.0) {
        add_line(
            out,
            "stable step of %s %s %.3g s at the start, %.3g s in this state (omega "
            "<= %.3g 1/s, damping <= %.3g 1/s)",
            weft_scene_plugin(scene), weft_scene_method(scene), found.start, found.now,
            found.omega, found.damping);
    }
    add_line(
        out, "%s",
        h > 0.0 && found.start > 0.0
            ? advise_fixed(h, &found, &advice)
            : "try looser tolerances, a smaller stepper.min_step or another method, "
              "and look at what drives the cloth there");
}
