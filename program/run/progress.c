/* SPDX-License-Identifier: BSD-3-Clause */
/* progress.c -- the progress of a run or of several: one line of a terminal, redrawn;
 * one line per tenth of the frames; or YAML documents. */
#include "program/run/progress.h"

#include <math.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/record/yaml_out.h"

#define TERMINAL_PERIOD 0.2 /* [s] */
#define YAML_PERIOD     0.1 /* [s] */
#define NEW_WEIGHT      0.3 /* of the newest in smoothed rates */

void progress_begin(progress *show, progress_mode mode, const weft_sim *sim,
                    const weft_run_def *run)
{
    const double now = weft__wall_clock();
    *show = (progress){ .mode = mode,
                        .shown = now,
                        .measured = now,
                        .time = weft_sim_time(sim),
                        .steps = weft_sim_stats(sim).steps,
                        .sim = sim,
                        .run = run };
}

static bool due(progress *show, size_t frame, size_t last, double now)
{
    const size_t tenth = 10 * frame / last;
    const double period = show->mode == PROGRESS_LINES  ? INFINITY
                          : show->mode == PROGRESS_YAML ? YAML_PERIOD
                                                        : TERMINAL_PERIOD;
    const bool is_due = tenth > show->tenth || now - show->shown >= period;
    show->tenth = tenth;
    show->shown = is_due ? now : show->shown;
    return is_due;
}

/* Rates since the last report, smoothed, as steps get longer and shorter. */
static void measure(progress *show, double now)
{
    const double spent = now - show->measured;
    if (spent < 1e-3) {
        return;
    }
    const double t = weft_sim_time(show->sim);
    const uint64_t steps = weft_sim_stats(show->sim).steps;
    const double weight = show->speed > 0.0 ? NEW_WEIGHT : 1.0;
    show->speed += weight * ((t - show->time) / spent - show->speed);
    show->rate += weight * ((double)(steps - show->steps) / spent - show->rate);
    show->measured = now;
    show->time = t;
    show->steps = steps;
}

/* ---- for people ------------------------------------------------------------- */

/* Add a part if it fits as a whole: the most important ones come first. */
static void add(char *line, size_t width, const char *name, const char *value)
{
    const size_t used = strlen(line), more = strlen(name) + 1 + strlen(value);
    const size_t gap = used == 0 ? 0 : 2;
    if (used + gap + more <= width) {
        (void)snprintf(line + used, gap + more + 1, "%s%s %s", gap == 0 ? "" : "  ",
                       name, value);
    }
}

static void put_line(progress *show, const char *line)
{
    show->drawn = show->mode == PROGRESS_TERMINAL;
    fprintf(stderr, show->drawn ? "\r%s\033[K" : "%s\n", line);
    (void)fflush(stderr);
}

static void write_line(progress *show, size_t frame)
{
    enum { LONGEST = 160 };
    char line[LONGEST + 1] = "", text[64];
    const bool redraw = show->mode == PROGRESS_TERMINAL;
    struct winsize size = { 0 };
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    size_t width = !redraw ? LONGEST : known ? size.ws_col - 1u : 79;
    width = width < LONGEST ? width : LONGEST;
    const double left = show->run->duration - weft_sim_time(show->sim);
    (void)snprintf(text, sizeof text, "%zu/%zu", frame, weft_run_last_frame(show->run));
    add(line, width, "frame", text);
    add(line, width, "ETA",
        show->speed > 0.0 ? human_time(ceil(left / show->speed)).text : "--");
    (void)snprintf(text, sizeof text, "%.4g s", weft_sim_time(show->sim));
    add(line, width, "t", text);
    add(line, width, "h", human_time(weft_sim_stats(show->sim).last_step).text);
    add(line, width, "steps/s",
        show->speed > 0.0 ? human_count((uint64_t)(show->rate + 0.5)).text : "--");
    put_line(show, line);
}

void progress_clear(progress *show)
{
    if (show->drawn) {
        fputs("\r\033[K", stderr);
        (void)fflush(stderr);
        show->drawn = false;
    }
}

/* ---- for machines ----------------------------------------------------------- */

static void write_yaml(const progress *show, size_t frame)
{
    yaml_out out;
    const weft_stepper_stats stats = weft_sim_stats(show->sim);
    const double left = show->run->duration - weft_sim_time(show->sim);
    char rate[32], eta[32];
    yaml_out_begin_event(&out, "progress");
    yaml_out_write(&out,
                   "frame: %zu, time: %g, steps: %" PRIu64 ", rejected: %" PRIu64
                   ", rhs_calls: %" PRIu64 ", step_size: %g",
                   frame, weft_sim_time(show->sim), stats.steps, stats.rejected,
                   stats.rhs_calls, stats.last_step);
    if (show->speed > 0.0) {
        (void)snprintf(rate, sizeof rate, "%.0f", show->rate);
        (void)snprintf(eta, sizeof eta, "%.1f", left / show->speed);
        yaml_out_write(&out, "steps_per_second: %s, eta: %s", rate, eta);
    }
    yaml_out_end_event(&out);
}

void progress_show(progress *show, size_t frame)
{
    const double now = weft__wall_clock();
    if (show->mode == PROGRESS_NONE
        || !due(show, frame, weft_run_last_frame(show->run), now)) {
        return;
    }
    measure(show, now);
    if (show->mode == PROGRESS_YAML) {
        write_yaml(show, frame);
    } else {
        write_line(show, frame);
    }
}

void progress_count(progress *show, const char *what, size_t done, size_t all)
{
    yaml_out out;
    char line[80];
    if (show->mode == PROGRESS_NONE || !due(show, done, all, weft__wall_clock())) {
        return;
    }
    if (show->mode == PROGRESS_YAML) {
        yaml_out_begin_event(&out, "progress");
        yaml_out_write(&out, "%s: %zu", what, done);
        yaml_out_end_event(&out);
    } else {
        (void)snprintf(line, sizeof line, "%zu of %zu %s", done, all, what);
        put_line(show, line);
    }
}
