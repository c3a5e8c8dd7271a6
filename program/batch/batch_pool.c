/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_pool.c -- runs in child processes, their ends, and progress on stderr: a
 * redrawn table on a terminal, or one line per run in a pipe. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/batch/batch.h"
#include "program/run/run.h"

enum { SHOWN_SLOTS = 16, WIDTH = 79 };

typedef struct batch_pool {
    const batch *batch;
    batch_run **runs; /* the jobs */
    int stop;         /* the signal that stopped it */
    process_pool pool;
    bool terminal;        /* shows a table */
    size_t ended, failed; /* of the jobs */
    size_t lines;         /* of the table on the terminal */
    double began, shown;  /* [s] of the wall clock */
} batch_pool;

/* ---- one run, in a child process ------------------------------------------------- */

/* The output of a run goes into its directory. */
static bool open_log(const char *directory, bool continues)
{
    char path[RECORD_PATH];
    const int start = O_NONBLOCK | (continues ? O_APPEND : O_TRUNC);
    const int log = record_path(directory, "log.txt", path, NULL) == WEFT_OK
                        ? open(path, O_WRONLY | O_CREAT | O_NOFOLLOW | start, 0666)
                        : -1;
    return log >= 0 && dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0;
}

/* Looks again, as another process may have run it before the claim. */
static int run_claimed(const batch *self, const batch_run *one, const char *directory)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    const batch_status status = batch_look(self, one);
    const bool continues = status == BATCH_PARTIAL || status == BATCH_IO_ERROR
                           || status == BATCH_TIMEOUT;
    if (status == BATCH_DONE) {
        return EXIT_DONE;
    }
    if (!open_log(directory, continues)) {
        return EXIT_FILE;
    }
    if (weft_sweep_scene(one->scene->sweep, one->number, &scene, &err) != WEFT_OK) {
        return report_error(&err);
    }
    arguments given = *self->given;
    given.quiet = true;
    given.mode = PROGRESS_NONE;
    if (continues) {
        return resume_scene(&given, NULL, directory, scene);
    }
    /* from the start, over the files of an earlier attempt */
    return record_outdir(directory, true, &err) == WEFT_OK
               ? run_scene(&given, directory, scene, true, NULL)
               : report_error(&err);
}

/* process_def.work */
static int run_job(void *ctx, size_t job)
{
    const batch_pool *pool = ctx;
    const batch *self = pool->batch;
    const batch_run *one = pool->runs[job];
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    interrupt_catch(false); /* until it runs, a signal ends it */
    if (record_path(self->out, one->name, directory, &err) != WEFT_OK
        || record_directory(directory, &err) != WEFT_OK) {
        return report_error(&err);
    }
    int lock; /* until the process ends */
    return record_outdir_lock(directory, BATCH_PATIENCE, &lock, NULL) == WEFT_OK
               ? run_claimed(self, one, directory)
               : BATCH_EXIT_BUSY;
}

/* ---- the end of a run ---------------------------------------------------------- */

/* The result of a run that died without one, from its other files. */
static record_result find_result(const batch_run *one, double began,
                                 const char *directory)
{
    record_result result = { .wall_time = weft__wall_clock() - began };
    weft_scene *scene = NULL;
    record_series_row *rows;
    (void)record_series_rows(directory, &rows, &result.frames, NULL);
    free(rows);
    if (weft_sweep_scene(one->scene->sweep, one->number, &scene, NULL) == WEFT_OK) {
        result.planned = weft_run_last_frame(weft_scene_run(scene)) + 1;
        weft_scene_destroy(scene);
    }
    return result;
}

/* Keeps all but status and reason of the result that the run has left. */
static batch_status write_end(const batch_pool *self, const process *ended,
                              batch_status status, const char *reason)
{
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    const batch_run *one = self->runs[ended->job];
    weft_status written = record_path(self->batch->out, one->name, directory, &err);
    if (written == WEFT_OK) {
        record_result result = find_result(one, ended->began, directory);
        result.status = batch_status_names[status];
        result.reason = reason;
        written = record_result_amend(directory, &result, &err);
    }
    if (written != WEFT_OK) {
        (void)report_error(&err);
        return BATCH_IO_ERROR;
    }
    return status;
}

static batch_status status_of_exit(const batch_pool *self, const process *ended,
                                   int code)
{
    char reason[64];
    const batch_run *one = self->runs[ended->job];
    if (code == BATCH_EXIT_BUSY) {
        return BATCH_BUSY;
    }
    const batch_status status = batch_look(self->batch, one);
    const bool stopped = code == EXIT_SIGINT || code == EXIT_SIGTERM;
    if (status == BATCH_DONE || status == BATCH_FAILED || status == BATCH_IO_ERROR
        || stopped) {
        return stopped ? BATCH_PARTIAL : status;
    }
    (void)snprintf(reason, sizeof reason, "exit code %d: see log.txt", code);
    return write_end(self, ended, code == EXIT_FILE ? BATCH_IO_ERROR : BATCH_FAILED,
                     reason);
}

static batch_status status_of_end(const batch_pool *self, const process *ended)
{
    char reason[128];
    const int status = ended->status;
    if (ended->late && !(WIFEXITED(status) && WEXITSTATUS(status) != EXIT_SIGTERM)) {
        (void)snprintf(reason, sizeof reason, "not done after %g s",
                       self->batch->timeout);
        return write_end(self, ended, BATCH_TIMEOUT, reason);
    }
    if (WIFEXITED(status)) {
        return status_of_exit(self, ended, WEXITSTATUS(status));
    }
    if (self->stop != 0) {
        return BATCH_PARTIAL; /* killed by this batch */
    }
    (void)snprintf(reason, sizeof reason, "killed by signal %d (%.60s)",
                   WTERMSIG(status), strsignal(WTERMSIG(status)));
    return write_end(self, ended, BATCH_CRASHED, reason);
}

/* ---- progress ------------------------------------------------------------------- */

/* Back to the first line of the table. */
static void erase(batch_pool *self)
{
    if (self->lines > 0) {
        fprintf(stderr, "\033[%zuA\r\033[J", self->lines);
        self->lines = 0;
    }
}

/* "3:07" */
static const char *clock_text(double seconds, char out[32])
{
    const long whole = (long)seconds;
    if (whole < 3600) {
        (void)snprintf(out, 32, "%ld:%02ld", whole / 60, whole % 60);
    } else {
        (void)snprintf(out, 32, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                       whole % 60);
    }
    return out;
}

/* process_def.tick */
static void show_table(void *ctx)
{
    batch_pool *self = ctx;
    const double now = weft__wall_clock(), spent = now - self->began;
    if (!self->terminal || now - self->shown < 0.2) {
        return;
    }
    const double left = (double)(self->pool.jobs - self->ended);
    char took[32], eta[32] = "?";
    if (self->ended > 0) {
        (void)clock_text(spent * left / (double)self->ended, eta);
    }
    erase(self);
    fprintf(stderr, "%zu of %zu done, %zu failed, %zu running   %s   ETA %s\n",
            self->ended - self->failed, self->pool.jobs, self->failed,
            self->pool.running, clock_text(spent, took), eta);
    self->lines = 1;
    for (size_t i = 0; i < self->pool.at_once && self->lines <= SHOWN_SLOTS; ++i) {
        const process *one = &self->pool.all[i];
        if (one->pid > 0) {
            fprintf(stderr, "  %8s  %.*s\n", clock_text(now - one->began, took),
                    WIDTH - 12, self->runs[one->job]->name);
            ++self->lines;
        }
    }
    self->shown = now;
    (void)fflush(stderr);
}

/* ---- the pool ------------------------------------------------------------------ */

static void on_end(void *ctx, const process *ended)
{
    batch_pool *self = ctx;
    batch_run *one = self->runs[ended->job];
    const batch_status status = one->status = status_of_end(self, ended);
    ++self->ended;
    self->failed += status != BATCH_DONE && status != BATCH_PARTIAL;
    if (!self->batch->given->quiet && !(self->terminal && status == BATCH_DONE)) {
        erase(self);
        fprintf(stderr, "%zu/%zu %s %s (%.2f s)\n", self->ended, self->pool.jobs,
                batch_status_names[status], one->name,
                weft__wall_clock() - ended->began);
    }
}

static int take_signal(void *ctx)
{
    batch_pool *self = ctx;
    const int number = interrupt_next();
    self->stop = self->stop == 0 ? number : self->stop;
    return number;
}

int batch_pool_run(batch *self, batch_run **runs, size_t count)
{
    batch_pool all
        = { .batch = self,
            .runs = runs,
            .pool = { .def = { .work = run_job,
                               .ctx = &all,
                               .tick = show_table,
                               .end_signal = SIGTERM, /* a run leaves a result then */
                               .seconds = self->timeout },
                      .jobs = count,
                      .at_once = self->jobs,
                      .ended = on_end,
                      .stop = take_signal },
            .terminal = !self->given->quiet && isatty(STDERR_FILENO) == 1,
            .began = weft__wall_clock() };
    interrupt_catch(true);
    const bool able = process_pool_run(&all.pool);
    const int why = errno;
    erase(&all);
    if (!able) {
        fprintf(stderr, "weft: error: no process for %s: %s\n",
                runs[all.pool.started]->name, strerror(why));
    }
    return all.stop;
}
