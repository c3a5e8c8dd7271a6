/* SPDX-License-Identifier: BSD-3-Clause */
/* progress.c -- how far a run has come, on stderr. */
#include <inttypes.h>
#include <time.h>
#include <unistd.h>

#include "cli/cli.h"

double wall_clock(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_begin(progress *show, bool quiet)
{
    *show = (progress){ .quiet = quiet,
                        .terminal = isatty(STDERR_FILENO) == 1,
                        .began = wall_clock() };
}

/* Twice a second on a terminal; else when another tenth of the frames is done. */
static bool due(progress *show, size_t frame, size_t last, double now)
{
    if (show->terminal) {
        const bool is_due = now - show->shown >= 0.5 || frame == last;
        show->shown = is_due ? now : show->shown;
        return is_due;
    }
    const size_t tenth = 10 * frame / last;
    const bool is_due = tenth > show->tenth;
    show->tenth = tenth;
    return is_due;
}

void progress_show(progress *show, size_t frame, size_t last, const weft_sim *sim,
                   double duration)
{
    const double now = wall_clock();
    if (show->quiet || !due(show, frame, last, now)) {
        return;
    }
    const double t = weft_sim_time(sim), spent = now - show->began;
    const weft_stepper_stats stats = weft_sim_stats(sim);
    fprintf(stderr,
            "%sframe %zu/%zu  t %.4g s  h %.2e s  %" PRIu64 " steps, %" PRIu64
            " rejected  ETA %.0f s%s",
            show->terminal ? "\r\033[K" : "", frame, last, t, stats.last_step,
            stats.steps, stats.rejected, t > 0.0 ? spent * (duration - t) / t : 0.0,
            show->terminal ? "" : "\n");
    (void)fflush(stderr);
}

void progress_end(progress *show)
{
    if (show->terminal && !show->quiet && show->shown > 0.0) {
        fputc('\n', stderr);
    }
}
