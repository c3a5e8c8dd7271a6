/* SPDX-License-Identifier: BSD-3-Clause */
/* summary.c -- the summary of a run, to stdout; of one that fails the reason, the
 * stable step then and at the start, and advice, to stderr. */
#include "program/run/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/record/yaml_out.h"
#include "program/reports.h"
#include "program/survey/survey.h"

void summary_step(run *self)
{
    const double h = weft_sim_stats(self->sim).last_step;
    record_extremes *all = &self->extremes;
    if (!(all->short_step > 0.0) || h < all->short_step) {
        all->short_step = h;
    }
    all->long_step = h > all->long_step ? h : all->long_step;
}

void summary_frame(run *self)
{
    const weft_spring *now = &self->series.worst;
    record_extremes *all = &self->extremes;
    if (all->strain.p == all->strain.q || now->strain > all->strain.strain) {
        all->strain = *now;
        all->strain_time = weft_sim_time(self->sim);
    }
}

/* ---- for people -------------------------------------------------------- */

static void print_what(const run *self)
{
    char text[RECORD_PATH], size[HUMAN_SIZE];
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const bool stopped = self->result.reason[0] != '\0'
                         && (strcmp(self->result.status, "interrupted") == 0
                             || strcmp(self->result.status, "done") == 0);
    (void)snprintf(text, sizeof text, "%s%s%s: %s (%s, %s %s)", self->result.status,
                   stopped ? " by " : "", stopped ? self->result.reason : "",
                   weft_scene_name(self->scene),
                   weft_cloth_text(cloth, size, sizeof size),
                   weft_scene_plugin(self->scene), weft_scene_method(self->scene));
    print_wrapped(0, 2, PAGE_WIDTH, text);
}

static void print_time(const run *self)
{
    sentence speed = { "" };
    const record_result *result = &self->result;
    const double t = weft_sim_time(self->sim); /* both are of all parts of the run */
    if (t > 0.0 && result->wall_time > 0.0) {
        say(&speed, ", %.3g times real time", t / result->wall_time);
    }
    print_item("time", "%zu of %zu frames, %.6g s simulated in %s%s", result->frames,
               result->planned, t, human_time(result->wall_time).text, speed.text);
}

static void print_steps(const run *self)
{
    const weft_stepper_stats stats = weft_sim_stats(self->sim);
    const uint64_t back = weft_sim_vetoed(self->sim);
    sentence vetoed = { "" };
    if (back > 0) {
        say(&vetoed, ", %s rolled back for contact", human_count(back).text);
    }
    print_item("steps", "%s (%s rejected%s), %s evaluations of the forces",
               human_count(stats.steps).text, human_count(stats.rejected).text,
               vetoed.text, human_count(stats.rhs_calls).text);
    if (stats.factorisations > 0) { /* the method solves linear systems */
        print_item("solver", "%s Jacobians, %s iterations, %s failures",
                   human_count(stats.factorisations).text,
                   human_count(stats.linear_iterations).text,
                   human_count(stats.newton_failures).text);
    }
}

static void print_step_sizes(const run *self)
{
    const uint64_t steps = weft_sim_stats(self->sim).steps;
    const record_extremes *all = &self->extremes;
    if (!(all->short_step > 0.0) || steps == 0) {
        print_item("step size", "no step was taken");
        return;
    }
    sentence asked = { "" };
    if (record_step_differs(self->scene)) {
        say(&asked, "; fixed_step %g s does not divide a frame, %.7g s does",
            weft_scene_step(self->scene), weft_scene_config(self->scene)->fixed_step);
    }
    print_item("step size", "%s on average, %s to %s%s",
               human_time(weft_sim_time(self->sim) / (double)steps).text,
               human_time(all->short_step).text, human_time(all->long_step).text,
               asked.text);
}

static void print_strain(const run *self)
{
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const weft_spring *last = &self->result.measures.worst;
    const bool ends = last->strain > self->extremes.strain.strain; /* after a frame */
    const weft_spring *most = ends ? last : &self->extremes.strain;
    char spring[SPRING];
    if (most->p == most->q) {
        print_item("strain", "none: there are no springs");
        return;
    }
    print_item("strain", "at most %.3g %% at t = %.4g s, %s; %.3g %% at the end",
               100.0 * most->strain,
               ends ? weft_sim_time(self->sim) : self->extremes.strain_time,
               weft_spring_text(cloth, most, spring, sizeof spring),
               100.0 * last->strain);
}

/* ", work of pins 0.1 J, of shapes 0 J"; of the later ones only if there is any. */
static void say_work(const weft_ledger *ledger, sentence *to)
{
    const char *before = ", work of";
#define SAY(member, power, by)                                                         \
    if ((by)[0] != '\0' && ((power) <= WEFT_POWER_PINS || ledger->member != 0.0)) {    \
        say(to, "%s %s %.4g J", before, (by), ledger->member);                         \
        before = ", of";                                                               \
    }
    WEFT_LEDGER_POWERS(SAY)
    WEFT_LEDGER_LATER_POWERS(SAY)
#undef SAY
}

static void print_energy(const run *self)
{
    const weft_ledger ledger = self->result.ledger;
    sentence balance = { "" };
    if (ledger.kept) {
        say(&balance, ", %.4g J dissipated", weft_sim_dissipated(self->sim));
        say_work(&ledger, &balance);
        say(&balance, "; energy balance closes to %.2g J", ledger.residual);
    }
    print_item("energy", "%.6g -> %.6g J%s", self->result.energy_start,
               weft_energy_total(ledger.energy), balance.text);
}

static void print_limit(const run *self)
{
    const weft_limit_stats stats = weft_sim_limit_stats(self->sim);
    const weft_limit_def *limit = weft_scene_limit(self->scene);
    if (limit->method == WEFT_LIMIT_NONE) {
        print_item("limit", "none");
        return;
    }
    print_item(
        "limit",
        "%.3g %%: %s steps corrected in %s sweeps, not met after %s steps; largest "
        "limited strain %.4g %%",
        100.0 * limit->strain, human_count(stats.corrected).text,
        human_count(stats.sweeps).text, human_count(stats.unconverged).text,
        100.0 * weft_sim_limit_worst(self->sim).strain);
}

static void print_files(const run *self)
{
    sentence names = { "" };
    for (size_t i = 0; record_names[i] != NULL; ++i) {
        if (record_exists(self->out, record_names[i])) {
            say(&names, "%s %s", names.text[0] == '\0' ? ":" : "", record_names[i]);
        }
    }
    char copy[64];
    size_t copies = 0;
    while (weft_scene_body_file(self->scene, copies, copy, sizeof copy) != NULL) {
        ++copies;
    }
    if (copies > 0) {
        (void)weft_scene_body_file(self->scene, 0, copy, sizeof copy);
        say(&names, " %s", copy);
    }
    if (copies > 1) {
        (void)weft_scene_body_file(self->scene, copies - 1, copy, sizeof copy);
        say(&names, " to %s", copy);
    }
    print_item("files", "in %s%s", self->out, names.text);
}

static void print_sensitivity(const run *self)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(self->scene);
    size_t worst = 0;
    sentence warning = { "" };
    if (of->count == 0) {
        return;
    }
    const double growth = record_sensitivity_growth(self->scene, self->sim, &worst);
    if (growth > 1.0) {
        say(&warning, "; warning: that is more than the cloth's size: the run is too "
                      "sensitive for "
                      "its derivatives to mean much");
    }
    if (weft_sim_vetoed(self->sim) > weft_sim_stats(self->sim).steps) {
        say(&warning, "; warning: contact rolled back more than half of the steps");
    }
    print_item(
        "gradients",
        "to %zu %s; 1 %% of %s moves a particle by %.3g of the cloth's diagonal%s",
        of->count, of->count == 1 ? "number" : "numbers", of->keys[worst], growth,
        warning.text);
}

void summary_print(const run *self)
{
    print_what(self);
    print_time(self);
    print_steps(self);
    print_step_sizes(self);
    start_print_stretch(weft_scene_cloth(self->scene));
    print_strain(self);
    print_energy(self);
    for (size_t i = 0; i < REPORT_SECTIONS; ++i) {
        if (report_sections[i]->summary != NULL) {
            report_sections[i]->summary(self->scene, self->sim, &self->result.measures);
        }
    }
    print_limit(self);
    print_sensitivity(self);
    print_files(self);
}

void summary_print_frames(const run *self)
{
    print_what(self);
    print_item("time", "%zu of %zu frames in %s", self->result.frames,
               self->result.planned, human_time(self->result.wall_time).text);
    print_files(self);
}

/* ---- for machines ----------------------------------------------------------- */

void summary_yaml_begin(const run *self)
{
    yaml_out out;
    yaml_out_begin_event(&out, "begin");
    yaml_out_write(&out,
                   "name: \"%s\", directory: \"%s\", plugin: \"%s\", method: \"%s\"",
                   weft_scene_name(self->scene), self->out,
                   weft_scene_plugin(self->scene), weft_scene_method(self->scene));
    yaml_out_size(&out, weft_sim_cloth(self->sim));
    yaml_out_write(&out, "frames_planned: %zu, duration: %g", self->result.planned,
                   weft_scene_run(self->scene)->duration);
    yaml_out_end_event(&out);
}

void summary_yaml_end(const run *self)
{
    yaml_out out;
    yaml_out_begin_event(&out, "end");
    record_result_items(&out, &self->result);
    yaml_out_end_event(&out);
}

/* ---- failures ---------------------------------------------------------------- */

/* From the stable steps at the start, now and in any state [s]; 0: none. */
static const char *advise_fixed(double h, double start, double now, double any,
                                sentence *out)
{
    const double step = advised_step(start, any);
    if (h > start) {
        say(out,
            "try stepper.fixed_step=%.2g, %s, or see weft check for a method with a "
            "larger one",
            step, advised_for(any));
    } else if (h > now) {
        say(out,
            "the cloth has grown stiffer than it was at the start: try "
            "stepper.fixed_step=%.2g, %s",
            step, advised_for(any));
    } else {
        say(out,
            "the step was a stable one: look at what drives the cloth (pins, wind, "
            "loads), or try a tenth of the step");
    }
    return out->text;
}

/* Looser tolerances help where nothing else holds the step. */
static const char *advise_adaptive(const weft_failure *failure, const weft_cloth *cloth,
                                   sentence *out)
{
    bool held = false;
    for (size_t i = 0; i < REPORT_SECTIONS && !held; ++i) {
        held = report_sections[i]->advise != NULL
               && report_sections[i]->advise(failure, cloth, out);
    }
    if (!held) {
        say(out,
            "try looser tolerances, a smaller stepper.min_step or another method, and "
            "look at what drives the cloth there");
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

/* A smaller strain is an error of rounding, which says nothing. */
#define ROUNDING 1e-9

static void add_state(const weft_failure *failure, const weft_cloth *cloth,
                      sentence *out)
{
    const weft_spring *worst = &failure->spring;
    const double *x = failure->position;
    char spring[SPRING], fastest[SPRING];
    if (failure->last_step > 0.0) {
        add_line(out, "%s at t = %.9g s, last h = %.3g s", failure->reason,
                 failure->time, failure->last_step);
    } else {
        add_line(out, "%s at t = %.9g s", failure->reason, failure->time);
    }
    if (failure->held[0] != '\0') {
        add_line(out, "%s", failure->held);
    }
    if (!(failure->speed == 0.0)) {
        add_line(out, "fastest %s at (%.3g, %.3g, %.3g) m, %.3g m/s",
                 weft_particle_text(cloth, failure->particle, fastest, sizeof fastest),
                 x[0], x[1], x[2], failure->speed);
    }
    if (worst->p == worst->q) {
        add_line(out, "no springs");
    } else if (!(fabs(worst->strain) < ROUNDING)) {
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
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_stiffness in_any = weft_sim_stiffness(sim, 0.0, NULL);
    const weft_stiffness present
        = weft_sim_stiffness(sim, weft_sim_time(sim), weft_sim_state(sim));
    const double now = own_stable_step(scene, &present),
                 any = own_stable_step(scene, &in_any);
    double start = 0.0, *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    if (weft_comm_agree(comm, y == NULL ? WEFT_NO_MEMORY : WEFT_OK, NULL) == WEFT_OK) {
        weft_cloth_start(cloth, y);
        const weft_stiffness first = weft_sim_stiffness(sim, 0.0, y);
        start = own_stable_step(scene, &first);
    }
    free(y);
    if (start > 0.0) {
        add_line(
            out,
            "stable step of %s %s %.3g s at the start, %.3g s in this state (omega "
            "<= %.3g 1/s, damping <= %.3g 1/s: %s)",
            weft_scene_plugin(scene), weft_scene_method(scene), start, now,
            sqrt(present.omega2), present.damping, limiting_bound(scene, &present));
    }
    add_line(out, "%s",
             h > 0.0 && start > 0.0 ? advise_fixed(h, start, now, any, &advice)
                                    : advise_adaptive(failure, cloth, &advice));
}
