/* SPDX-License-Identifier: BSD-3-Clause */
/* summary.c -- what a run was and came to, to stdout. */
#include "cli/summary.h"

#include <string.h>
#include <unistd.h>

#include "cli/human.h"
#include "record/yaml_out.h"

void summary_begin(summary *self)
{
    self->began = weft_sim_time(self->sim);
    self->steps = weft_sim_stats(self->sim).steps;
}

void summary_step(summary *self)
{
    const double h = weft_sim_stats(self->sim).last_step;
    if (!(self->short_step > 0.0) || h < self->short_step) {
        self->short_step = h;
    }
    self->long_step = h > self->long_step ? h : self->long_step;
}

void summary_frame(summary *self, const weft_spring *now)
{
    const bool first = self->strained.p == self->strained.q;
    if (first || now->strain > self->strained.strain) {
        self->strained = *now;
        self->strained_at = weft_sim_time(self->sim);
    }
}

/* ---- for people: eight lines ------------------------------------------------ */

static void print_what(const summary *self)
{
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    fputs(self->result->status, stdout);
    if (strcmp(self->result->status, "interrupted") == 0) {
        printf(" by %s", self->result->reason);
    }
    fputs(": ", stdout);
    print_plain(stdout, weft_scene_name(self->scene), "");
    printf(" (%zu x %zu particles, %s %s)\n", weft_cloth_rows(cloth),
           weft_cloth_cols(cloth), weft_scene_plugin(self->scene),
           weft_scene_method(self->scene));
}

static void print_time(const summary *self)
{
    char wall[HUMAN];
    const record_result *result = self->result;
    const double t = weft_sim_time(self->sim); /* both are of all parts of the run */
    printf("  time       %zu of %zu frames, %.6g s simulated in %s", result->frames,
           result->planned, t, human_time(result->wall_time, wall));
    if (t > 0.0 && result->wall_time > 0.0) {
        printf(", %.3g times real time", t / result->wall_time);
    }
    putchar('\n');
}

static void print_steps(const summary *self)
{
    char text[HUMAN];
    const weft_stepper_stats stats = weft_sim_stats(self->sim);
    printf("  steps      %s", human_count(stats.steps, text));
    printf(" (%s rejected)", human_count(stats.rejected, text));
    printf(", %s evaluations of the forces\n", human_count(stats.rhs_calls, text));
}

/* Of the parts before, nothing is known of each step and spring. */
static void print_since(const summary *self)
{
    if (self->began > 0.0) {
        printf(" since it was resumed at %.4g s", self->began);
    }
}

static void print_step_sizes(const summary *self)
{
    char mean[HUMAN], least[HUMAN], most[HUMAN];
    const uint64_t steps = weft_sim_stats(self->sim).steps - self->steps;
    if (!(self->short_step > 0.0) || steps == 0) {
        puts("  step size  no step was taken");
        return;
    }
    const double h = (weft_sim_time(self->sim) - self->began) / (double)steps;
    printf("  step size  %s on average, %s to %s", human_time(h, mean),
           human_time(self->short_step, least), human_time(self->long_step, most));
    print_since(self);
    putchar('\n');
}

static void print_strain(const summary *self)
{
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const weft_spring *most = &self->strained;
    const size_t cols = weft_cloth_cols(cloth);
    if (most->p == most->q) {
        puts("  strain     none: there are no springs");
        return;
    }
    printf(
        "  strain     at most %.3g %% at t = %.4g s, %s spring (%zu, %zu)-(%zu, %zu)",
        100.0 * most->strain, self->strained_at, weft_family_name(most->family),
        most->p / cols, most->p % cols, most->q / cols, most->q % cols);
    print_since(self);
    printf("; %.3g %% at the end\n",
           100.0 * weft_cloth_worst_spring(cloth, weft_sim_state(self->sim)).strain);
}

static void print_energy(const summary *self)
{
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    const weft_ledger ledger = weft_sim_ledger(self->sim);
    printf("  energy     %.6g -> %.6g J, %.4g J dissipated", self->result->energy_start,
           record_total_energy(cloth, weft_sim_state(self->sim)),
           weft_sim_dissipated(self->sim));
    if (ledger.kept) {
        printf(", work of wind %.4g J, of pins %.4g J; ledger closes to %.2g J",
               ledger.wind_work, ledger.pin_work, ledger.residual);
    }
    putchar('\n');
}

static void print_limit(const summary *self)
{
    char steps[HUMAN], sweeps[HUMAN], unmet[HUMAN];
    const weft_limit_stats stats = weft_sim_limit_stats(self->sim);
    const weft_limit_def *limit = weft_scene_limit(self->scene);
    if (limit->method == WEFT_LIMIT_NONE) {
        puts("  limit      none");
        return;
    }
    printf("  limit      %.3g %%: %s steps corrected in %s sweeps, %s not met; largest "
           "limited strain %.4g %%\n",
           100.0 * limit->strain, human_count(stats.corrected, steps),
           human_count(stats.sweeps, sweeps), human_count(stats.unconverged, unmet),
           100.0 * weft_sim_limit_worst(self->sim).strain);
}

static void print_files(const summary *self)
{
    char path[RECORD_PATH];
    fputs("  files      in ", stdout);
    print_plain(stdout, self->directory, "");
    const char *lead = ":";
    for (size_t i = 0; record_names[i] != NULL; ++i) {
        if (record_path(self->directory, record_names[i], path, NULL) == WEFT_OK
            && access(path, F_OK) == 0) {
            printf("%s %s", lead, record_names[i]);
            lead = "";
        }
    }
    putchar('\n');
}

void summary_print(const summary *self)
{
    print_what(self);
    print_time(self);
    print_steps(self);
    print_step_sizes(self);
    print_strain(self);
    print_energy(self);
    print_limit(self);
    print_files(self);
}

/* ---- for machines ----------------------------------------------------------- */

void summary_yaml_begin(const summary *self)
{
    yaml_out out;
    const weft_cloth *cloth = weft_sim_cloth(self->sim);
    yaml_out_begin_line(&out, stdout);
    yaml_out_plain(&out, "event", "begin");
    yaml_out_text(&out, "name", weft_scene_name(self->scene));
    yaml_out_text(&out, "directory", self->directory);
    yaml_out_text(&out, "plugin", weft_scene_plugin(self->scene));
    yaml_out_text(&out, "method", weft_scene_method(self->scene));
    yaml_out_plain(&out, "rows", "%zu", weft_cloth_rows(cloth));
    yaml_out_plain(&out, "cols", "%zu", weft_cloth_cols(cloth));
    yaml_out_plain(&out, "frames_planned", "%zu", self->result->planned);
    yaml_out_real(&out, "duration", weft_scene_run(self->scene)->duration);
    (void)yaml_out_end(&out);
    (void)fflush(stdout);
}

void summary_yaml_end(const summary *self)
{
    yaml_out out;
    yaml_out_begin_line(&out, stdout);
    yaml_out_plain(&out, "event", "end");
    record_result_items(&out, self->result);
    (void)yaml_out_end(&out);
    (void)fflush(stdout);
}
