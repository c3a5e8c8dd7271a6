/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_pool.c -- a few processes at a time, until all runs had theirs. */
#define _XOPEN_SOURCE 700 /* setitimer */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/batch/batch.h"
#include "cli/run/progress.h"

/* [s] from the polite signal at the end of a run's time to the other one. */
static const double grace = 3.0;

typedef struct batch_pool {
    batch *batch;
    batch_slot *slots;
    size_t active;
    sigset_t waited, before; /* signals that are waited for; the mask of the children */
    int stop;                /* the signal that stopped it */
    batch_show show;
} batch_pool;

/* They are waited for instead of being handled; a shell may have them ignored. */
static void take_signals(batch_pool *self)
{
    static const int numbers[] = { SIGCHLD, SIGINT, SIGTERM, SIGALRM };
    (void)sigemptyset(&self->waited);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        (void)sigaddset(&self->waited, numbers[i]);
    }
    (void)sigprocmask(SIG_BLOCK, &self->waited, &self->before);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        (void)signal(numbers[i], SIG_DFL);
        (void)sigdelset(&self->before, numbers[i]);
    }
}

static bool start(batch_pool *self, batch_slot *slot, batch_run *run)
{
    (void)fflush(NULL);
    const pid_t pid = fork();
    if (pid < 0) {
        fprintf(stderr, "weft: error: no process for %s: %s\n", run->name,
                strerror(errno));
        return false;
    }
    if (pid == 0) {
        (void)sigprocmask(SIG_SETMASK, &self->before, NULL);
        batch_child(self->batch, run);
    }
    const double now = wall_clock(), timeout = self->batch->timeout;
    *slot = (batch_slot){ .pid = pid,
                          .run = run,
                          .began = now,
                          .deadline = timeout > 0.0 ? now + timeout : HUGE_VAL };
    ++self->active;
    return true;
}

/* ---- the end of a run ---------------------------------------------------------- */

/* What the files of a run tell that died without a result. */
static record_result find_result(const batch_slot *slot, const char *directory)
{
    const batch_run *run = slot->run;
    record_result result = { .wall_time = wall_clock() - slot->began };
    weft_scene *scene = NULL;
    size_t last;
    if (record_series_last(directory, &last, NULL) == WEFT_OK) {
        result.frames = last + 1;
    }
    if (weft_sweep_scene(run->scene->sweep, run->number, &scene, NULL) == WEFT_OK) {
        result.planned = frame_last(weft_scene_run(scene)) + 1;
        weft_scene_destroy(scene);
    }
    return result;
}

/* Keeps all but status and reason of the result that the run has left. */
static batch_status write_end(const batch_pool *self, const batch_slot *slot,
                              batch_status status, const char *reason)
{
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    weft_status written = batch_directory(self->batch, slot->run, directory, &err);
    if (written == WEFT_OK) {
        record_result result = find_result(slot, directory);
        result.status = batch_status_name(status);
        result.reason = reason;
        written = record_result_amend(directory, &result, &err);
    }
    if (written != WEFT_OK) {
        (void)report_error(&err);
        return BATCH_IO_ERROR;
    }
    return status;
}

static batch_status status_of_exit(const batch_pool *self, const batch_slot *slot,
                                   int code)
{
    char reason[64];
    const batch_run *run = slot->run;
    weft_scene *scene = NULL;
    batch_status status = BATCH_UNREADABLE;
    if (code == BATCH_EXIT_BUSY) {
        return BATCH_BUSY;
    }
    if (weft_sweep_scene(run->scene->sweep, run->number, &scene, NULL) == WEFT_OK) {
        status = batch_look(self->batch, run, scene);
        weft_scene_destroy(scene);
    }
    const bool stopped = code == EXIT_SIGINT || code == EXIT_SIGTERM;
    if (status == BATCH_DONE || status == BATCH_FAILED || status == BATCH_IO_ERROR
        || stopped) {
        return stopped ? BATCH_PARTIAL : status;
    }
    (void)snprintf(reason, sizeof reason, "exit code %d: see log.txt", code);
    return write_end(self, slot, BATCH_FAILED, reason);
}

static batch_status status_of_end(const batch_pool *self, const batch_slot *slot,
                                  int status)
{
    char reason[128];
    if (slot->late && !(WIFEXITED(status) && WEXITSTATUS(status) != EXIT_SIGTERM)) {
        (void)snprintf(reason, sizeof reason, "not done after %g s",
                       self->batch->timeout);
        return write_end(self, slot, BATCH_TIMEOUT, reason);
    }
    if (WIFEXITED(status)) {
        return status_of_exit(self, slot, WEXITSTATUS(status));
    }
    if (self->stop != 0) {
        return BATCH_PARTIAL; /* it was we who killed it */
    }
    (void)snprintf(reason, sizeof reason, "killed by signal %d (%.60s)",
                   WTERMSIG(status), strsignal(WTERMSIG(status)));
    return write_end(self, slot, BATCH_CRASHED, reason);
}

static void reap(batch_pool *self)
{
    int status;
    for (pid_t pid; (pid = waitpid(-1, &status, WNOHANG)) > 0;) {
        for (size_t i = 0; i < self->batch->jobs; ++i) {
            batch_slot *slot = &self->slots[i];
            if (slot->pid == pid) {
                slot->run->status = status_of_end(self, slot, status);
                batch_show_ended(&self->show, slot);
                slot->pid = 0;
                --self->active;
            }
        }
    }
}

/* ---- the loop ------------------------------------------------------------------ */

static void tell(const batch_pool *self, int number)
{
    for (size_t i = 0; i < self->batch->jobs; ++i) {
        if (self->slots[i].pid > 0) {
            (void)kill(self->slots[i].pid, number);
        }
    }
}

static void end_late(batch_pool *self)
{
    const double now = wall_clock();
    for (size_t i = 0; i < self->batch->jobs; ++i) {
        batch_slot *slot = &self->slots[i];
        if (slot->pid > 0 && now >= slot->deadline) {
            (void)kill(slot->pid, slot->late ? SIGKILL : SIGTERM);
            slot->late = true;
            slot->deadline = now + grace;
        }
    }
}

/* For a look at the clock five times a second; macOS has no sigtimedwait. */
static void take_alarms(const batch_pool *self, bool wanted)
{
    if (self->batch->timeout > 0.0 || self->show.terminal) {
        const struct timeval pause = { .tv_usec = wanted ? 200000 : 0 };
        const struct itimerval timer = { pause, pause };
        (void)setitimer(ITIMER_REAL, &timer, NULL);
    }
}

/* Until a process ends, a signal comes, or it is time to look at the clock. */
static void wait_for_news(batch_pool *self)
{
    int number = 0;
    (void)sigwait(&self->waited, &number);
    if (number == SIGINT || number == SIGTERM) {
        tell(self, self->stop == 0 ? number : SIGKILL);
        self->stop = self->stop == 0 ? number : self->stop;
    }
    reap(self);
    end_late(self);
}

/* Fill the free slots, from run *next on. false if no process can be had. */
static bool fill(batch_pool *self, const bool *wanted, size_t *next)
{
    batch *all = self->batch;
    for (size_t i = 0; i < all->jobs && self->stop == 0; ++i) {
        while (*next < all->run_count && !wanted[*next]) {
            ++*next;
        }
        if (*next == all->run_count) {
            break;
        }
        if (self->slots[i].pid == 0) {
            if (!start(self, &self->slots[i], &all->runs[*next])) {
                return false;
            }
            ++*next;
        }
    }
    return true;
}

int batch_pool_run(batch *self, const bool *wanted)
{
    batch_pool all = { .batch = self, .slots = calloc(self->jobs, sizeof *all.slots) };
    size_t next = 0;
    bool starts = all.slots != NULL;
    all.show = (batch_show){ .batch = self, .slots = all.slots };
    for (size_t i = 0; i < self->run_count; ++i) {
        all.show.planned += wanted[i];
    }
    take_signals(&all);
    batch_show_begin(&all.show);
    take_alarms(&all, true);
    do {
        starts = starts && fill(&all, wanted, &next);
        batch_show_table(&all.show);
        if (all.active > 0) {
            wait_for_news(&all);
        }
    } while (all.active > 0 || (starts && all.stop == 0 && next < self->run_count));
    take_alarms(&all, false);
    batch_show_end(&all.show);
    free(all.slots);
    return all.stop;
}
