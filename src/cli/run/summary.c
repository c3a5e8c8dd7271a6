/* SPDX-License-Identifier: BSD-3-Clause */
/* summary.c -- the summary of a run, to stdout. */
#include "cli/run/run.h"

#include <math.h>
#include <string.h>

#include "cli/human.h"
#include "record/yaml_out.h"

void summary_step(summary *self)
{
    const double h = weft_sim_stats(self->sim).last_step;
    record_extremes *all = &self->extremes;
    if (!(all->short_step > 0.0) || h < all->short_step) {
        all->short_step = h;
    }
    all->long_step = h > all->long_step ? h : all->long_step;
}

void summary_frame(summary *self, const weft_spring *now)
{
    record_extremes *all = &self->extremes;
    if (all->strain.p == all->strain.q || now->strain > all->strain.strain) {
        all->strain = *now;
        all->strain_time = weft_sim_time(self->sim);
    }
}

/* ---- for people -------------------------------------------------------- */

static void print_what(const summary *self)
{
    char text[RECORD_PATH], size[HUMAN_SIZE];
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const bool stopped = self->result->reason[0] != '\0'
                         && (strcmp(self->result->status, "interrupted") == 0
                             || strcmp(self->result->status, "done") == 0);
    (void)snprintf(text, sizeof text, "%s%s%s: %s (%s, %s %s)", self->result->status,
                   stopped ? " by " : "", stopped ? self->result->reason : "",
                   weft_scene_name(self->scene),
                   weft_cloth_text(cloth, size, sizeof size),
                   weft_scene_plugin(self->scene), weft_scene_method(self->scene));
    print_wrapped(stdout, 0, 2, PAGE_WIDTH, text);
}

static void print_time(const summary *self)
{
    char wall[HUMAN], speed[48] = "";
    const record_result *result = self->result;
    const double t = weft_sim_time(self->sim); /* both are of all parts of the run */
    if (t > 0.0 && result->wall_time > 0.0) {
        (void)snprintf(speed, sizeof speed, ", %.3g times real time",
                       t / result->wall_time);
    }
    print_item("time", "%zu of %zu frames, %.6g s simulated in %s%s", result->frames,
               result->planned, t, human_time(result->wall_time, wall), speed);
}

static void print_steps(const summary *self)
{
    char steps[HUMAN], rejected[HUMAN], calls[HUMAN], vetoed[HUMAN];
    const weft_stepper_stats stats = weft_sim_stats(self->sim);
    const uint64_t back = weft_sim_vetoed(self->sim);
    print_item("steps", "%s (%s rejected%s%s%s), %s evaluations of the forces",
               human_count(stats.steps, steps), human_count(stats.rejected, rejected),
               back > 0 ? ", " : "", back > 0 ? human_count(back, vetoed) : "",
               back > 0 ? " taken back for contact" : "",
               human_count(stats.rhs_calls, calls));
}

/* Nothing of a method that solves no linear systems. */
static void print_solver(const summary *self)
{
    char systems[HUMAN], iterations[HUMAN], failures[HUMAN];
    const weft_stepper_stats stats = weft_sim_stats(self->sim);
    if (stats.factorisations > 0) {
        print_item("solver", "%s Jacobians, %s iterations, %s failures",
                   human_count(stats.factorisations, systems),
                   human_count(stats.linear_iterations, iterations),
                   human_count(stats.newton_failures, failures));
    }
}

static void print_step_sizes(const summary *self)
{
    char mean[HUMAN], least[HUMAN], most[HUMAN];
    const uint64_t steps = weft_sim_stats(self->sim).steps;
    const record_extremes *all = &self->extremes;
    if (!(all->short_step > 0.0) || steps == 0) {
        print_item("step size", "no step was taken");
        return;
    }
    char asked[100] = "";
    if (record_step_differs(self->scene)) {
        (void)snprintf(asked, sizeof asked,
                       "; fixed_step %g s does not divide a frame, %.7g s does",
                       weft_scene_step(self->scene),
                       weft_scene_config(self->scene)->fixed_step);
    }
    print_item("step size", "%s on average, %s to %s%s",
               human_time(weft_sim_time(self->sim) / (double)steps, mean),
               human_time(all->short_step, least), human_time(all->long_step, most),
               asked);
}

static void print_strain(const summary *self)
{
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const weft_spring *most = &self->extremes.strain;
    char spring[SPRING];
    if (most->p == most->q) {
        print_item("strain", "none: there are no springs");
        return;
    }
    print_item("strain", "at most %.3g %% at t = %.4g s, %s; %.3g %% at the end",
               100.0 * most->strain, self->extremes.strain_time,
               weft_spring_text(cloth, most, spring, sizeof spring),
               100.0 * self->result->measures.worst.strain);
}

static void print_energy(const summary *self)
{
    const weft_ledger ledger = self->result->ledger;
    char balance[200] = "", shapes[48] = "";
    if (weft_cloth_shapes(weft_sim_cloth(self->sim)) > 0) {
        (void)snprintf(shapes, sizeof shapes, ", of shapes %.4g J", ledger.shape_work);
    }
    if (ledger.kept) {
        (void)snprintf(balance, sizeof balance,
                       ", %.4g J dissipated, work of wind %.4g J, of pins %.4g J%s; "
                       "ledger closes to %.2g J",
                       weft_sim_dissipated(self->sim), ledger.wind_work,
                       ledger.pin_work, shapes, ledger.residual);
    }
    print_item("energy", "%.6g -> %.6g J%s", self->result->energy_start,
               weft_energy_total(ledger.energy), balance);
}

/* "the smallest gap is 3.2 mm at the end" */
static void say_gap(sentence *text, double gap)
{
    if (isfinite(gap)) {
        say(text, " and the smallest gap is %.3g mm", 1e3 * gap);
    }
    say(text, " at the end; ");
}

/* Nothing without contact. */
static void print_contact(const summary *self)
{
    char count[HUMAN];
    sentence text = { "" };
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const size_t shapes = weft_cloth_shapes(cloth);
    const bool has_self = weft_cloth_contact(cloth).self;
    const weft_measures all = self->result->measures;
    if (shapes > 0) {
        say(&text, "%zu %s, %s particles touch", shapes,
            shapes == 1 ? "shape" : "shapes", human_count(all.touching, count));
        say_gap(&text, all.gap);
    }
    if (has_self) {
        say(&text, "%s pairs of the cloth's own parts touch",
            human_count(all.self_touching, count));
        say_gap(&text, all.self_gap);
    }
    if (shapes > 0 || has_self) {
        print_item("contact", "%s%s steps taken back", text.text,
                   human_count(weft_sim_vetoed(self->sim), count));
    }
}

static void print_limit(const summary *self)
{
    char steps[HUMAN], sweeps[HUMAN], unmet[HUMAN];
    const weft_limit_stats stats = weft_sim_limit_stats(self->sim);
    const weft_limit_def *limit = weft_scene_limit(self->scene);
    if (limit->method == WEFT_LIMIT_NONE) {
        print_item("limit", "none");
        return;
    }
    print_item("limit",
               "%.3g %%: %s steps corrected in %s sweeps, %s not met; largest limited "
               "strain %.4g %%",
               100.0 * limit->strain, human_count(stats.corrected, steps),
               human_count(stats.sweeps, sweeps), human_count(stats.unconverged, unmet),
               100.0 * weft_sim_limit_worst(self->sim).strain);
}

static void print_files(const summary *self)
{
    sentence names = { "" };
    for (size_t i = 0; record_names[i] != NULL; ++i) {
        if (record_exists(self->directory, record_names[i])) {
            say(&names, "%s %s", names.text[0] == '\0' ? ":" : "", record_names[i]);
        }
    }
    print_item("files", "in %s%s", self->directory, names.text);
}

void summary_print(const summary *self)
{
    print_what(self);
    print_time(self);
    print_steps(self);
    print_solver(self);
    print_step_sizes(self);
    print_strain(self);
    print_energy(self);
    print_contact(self);
    print_limit(self);
    print_files(self);
}

void summary_print_frames(const summary *self)
{
    char wall[HUMAN];
    print_what(self);
    print_item("time", "%zu of %zu frames in %s", self->result->frames,
               self->result->planned, human_time(self->result->wall_time, wall));
    print_files(self);
}

/* ---- for machines ----------------------------------------------------------- */

void summary_yaml_begin(const summary *self)
{
    yaml_out out;
    yaml_out_begin_event(&out, "begin");
    yaml_out_write(&out,
                   "name: \"%s\", directory: \"%s\", plugin: \"%s\", method: \"%s\"",
                   weft_scene_name(self->scene), self->directory,
                   weft_scene_plugin(self->scene), weft_scene_method(self->scene));
    yaml_out_size(&out, weft_sim_cloth(self->sim));
    yaml_out_write(&out, "frames_planned: %zu, duration: %g", self->result->planned,
                   weft_scene_run(self->scene)->duration);
    yaml_out_end_event(&out);
}

void summary_yaml_end(const summary *self)
{
    yaml_out out;
    yaml_out_begin_event(&out, "end");
    record_result_items(&out, self->result);
    yaml_out_end_event(&out);
}
