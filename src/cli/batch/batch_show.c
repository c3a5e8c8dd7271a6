/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_show.c -- a redrawn table on a terminal, or one line per run in a pipe. */

#include "base/clock.h"
#include "cli/batch/batch.h"

enum { SHOWN_SLOTS = 16, WIDTH = 79 };

/* Back to the first line of the table. */
static void erase(batch_show *self)
{
    if (self->lines > 0) {
        fprintf(stderr, "\033[%zuA\r\033[J", self->lines);
        self->lines = 0;
    }
}

void batch_show_ended(batch_show *self, const batch_run *run, double began)
{
    const batch_status status = run->status;
    ++self->ended;
    self->failed += status != BATCH_DONE && status != BATCH_PARTIAL;
    if (self->quiet || (self->terminal && status == BATCH_DONE)) {
        return;
    }
    erase(self);
    fprintf(stderr, "%zu/%zu %s %s (%.2f s)\n", self->ended, self->planned,
            batch_status_name(status), run->name, weft__wall_clock() - began);
}

/* "3:07" */
static const char *clock_text(double seconds, char *out, size_t size)
{
    const long whole = (long)seconds;
    if (whole < 3600) {
        (void)snprintf(out, size, "%ld:%02ld", whole / 60, whole % 60);
    } else {
        (void)snprintf(out, size, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                       whole % 60);
    }
    return out;
}

static size_t print_slots(const batch_show *self, const process *all, double now)
{
    size_t shown = 0;
    for (size_t i = 0; i < self->batch->jobs && shown < SHOWN_SLOTS; ++i) {
        char time[32];
        if (all[i].pid > 0) {
            (void)clock_text(now - all[i].began, time, sizeof time);
            fprintf(stderr, "  %8s  %.*s\n", time, WIDTH - 12,
                    self->runs[all[i].job]->name);
            ++shown;
        }
    }
    return shown;
}

void batch_show_table(batch_show *self, const process *all)
{
    const double now = weft__wall_clock();
    if (!self->terminal || now - self->shown < 0.2) {
        return;
    }
    size_t running = 0;
    for (size_t i = 0; i < self->batch->jobs; ++i) {
        running += all[i].pid > 0;
    }
    const double spent = now - self->began;
    const double left = (double)(self->planned - self->ended);
    char took[32], eta[32] = "?";
    if (self->ended > 0) {
        (void)clock_text(spent * left / (double)self->ended, eta, sizeof eta);
    }
    erase(self);
    fprintf(stderr, "%zu of %zu done, %zu failed, %zu running   %s   ETA %s\n",
            self->ended - self->failed, self->planned, self->failed, running,
            clock_text(spent, took, sizeof took), eta);
    self->lines = 1 + print_slots(self, all, now);
    self->shown = now;
    (void)fflush(stderr);
}

void batch_show_end(batch_show *self)
{
    erase(self);
    (void)fflush(stderr);
}
