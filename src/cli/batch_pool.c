/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_pool.c -- a few processes at a time, until all runs had theirs. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cli/batch.h"
#include "cli/progress.h"

/* [s] from the polite signal at the end of a run's time to the other one. */
static const double grace = 3.0;

typedef struct pool {
    batch *batch;
    batch_slot *slots;
    size_t active;
    sigset_t waited, before; /* signals that are waited for; the mask of the children */
    int stop;                /* the signal that stopped it */
    batch_show show;
} pool;

/* They are waited for instead of being handled; a shell may have them ignored. */
static void take_signals(pool *self)
{
    static const int numbers[] = { SIGCHLD, SIGINT, SIGTERM };
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

static bool start(pool *self, batch_slot *slot, batch_run *run)
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

/* What the run itself could not write. */
static batch_status write_end(const pool *self, const batch_run *run,
                              batch_status status, const char *reason)
{
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    const record_result result
        = { .status = batch_status_name(status), .reason = reason };
    if (batch_directory(self->batch, run, directory, &err) != WEFT_OK
        || record_result_write(directory, &result, &err) != WEFT_OK) {
        (void)report_error(&err);
    }
    return status;
}

static batch_status status_of_exit(const pool *self, const batch_run *run, int code)
{
    char reason[64];
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
    if (status == BATCH_DONE || status == BATCH_FAILED || stopped) {
        return stopped ? BATCH_PARTIAL : status;
    }
    (void)snprintf(reason, sizeof reason, "exit code %d: see log.txt", code);
    return write_end(self, run, BATCH_FAILED, reason);
}

static batch_status status_of_end(const pool *self, const batch_slot *slot, int status)
{
    char reason[128];
    if (slot->late && !(WIFEXITED(status) && WEXITSTATUS(status) == EXIT_DONE)) {
        (void)snprintf(reason, sizeof reason, "not done after %g s",
                       self->batch->timeout);
        return write_end(self, slot->run, BATCH_TIMEOUT, reason);
    }
    if (WIFEXITED(status)) {
        return status_of_exit(self, slot->run, WEXITSTATUS(status));
    }
    if (self->stop != 0) {
        return BATCH_PARTIAL; /* it was we who killed it */
    }
    (void)snprintf(reason, sizeof reason, "killed by signal %d (%.60s)",
                   WTERMSIG(status), strsignal(WTERMSIG(status)));
    return write_end(self, slot->run, BATCH_CRASHED, reason);
}

static void reap(pool *self)
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

static void tell(const pool *self, int number)
{
    for (size_t i = 0; i < self->batch->jobs; ++i) {
        if (self->slots[i].pid > 0) {
            (void)kill(self->slots[i].pid, number);
        }
    }
}

static void end_late(pool *self)
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

/* Until a process ends, a signal comes, or it is time to look at the clock. */
static void wait_for_news(pool *self)
{
    const bool clock = self->batch->timeout > 0.0 || self->show.terminal;
    const struct timespec pause
        = { .tv_sec = clock ? 0 : 3600, .tv_nsec = clock ? 200000000 : 0 };
    const int number = sigtimedwait(&self->waited, NULL, &pause);
    if (number == SIGINT || number == SIGTERM) {
        tell(self, self->stop == 0 ? number : SIGKILL);
        self->stop = self->stop == 0 ? number : self->stop;
    }
    reap(self);
    end_late(self);
}

/* Fill the free slots, from run *next on. false if no process can be had. */
static bool fill(pool *self, const bool *wanted, size_t *next)
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
    pool all = { .batch = self, .slots = calloc(self->jobs, sizeof *all.slots) };
    size_t next = 0;
    bool starts = all.slots != NULL;
    all.show = (batch_show){ .batch = self, .slots = all.slots };
    for (size_t i = 0; i < self->run_count; ++i) {
        all.show.planned += wanted[i];
    }
    take_signals(&all);
    batch_show_begin(&all.show);
    do {
        starts = starts && fill(&all, wanted, &next);
        batch_show_table(&all.show);
        if (all.active > 0) {
            wait_for_news(&all);
        }
    } while (all.active > 0 || (starts && all.stop == 0 && next < self->run_count));
    batch_show_end(&all.show);
    free(all.slots);
    return all.stop;
}
