/* SPDX-License-Identifier: BSD-3-Clause */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "program/record/child_process.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#ifdef __APPLE__ /* which has no such clock: limits are not put off */
#define clock_getcpuclockid(pid, clock) (*(clock) = CLOCK_REALTIME, ENOSYS)
#endif

#include "base/clock.h"

#define GRACE 3.0 /* [s] from SIGTERM to SIGKILL */

static void set_limit(int resource, rlim_t most)
{
    const struct rlimit limit = { most, most };
    (void)setrlimit(resource, &limit);
}

_Noreturn static void run_child(const process_def *def, size_t job, pid_t parent)
{
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, def->end_signal);
#endif
    if (getppid() != parent) {
        _exit(1); /* the parent has already ended */
    }
    if (def->cpu_seconds > 0) {
        set_limit(RLIMIT_CPU, def->cpu_seconds);
    }
    if (def->untrusted) {
        const int nowhere = open("/dev/null", O_WRONLY);
        set_limit(RLIMIT_CORE, 0);
        (void)dup2(nowhere, STDOUT_FILENO);
        (void)dup2(nowhere, STDERR_FILENO);
    }
    const int code = def->work(def->ctx, job);
    (void)fflush(NULL);
    _exit(code);
}

bool process_start(const process_def *def, size_t job, process *out)
{
    (void)signal(SIGCHLD, SIG_DFL); /* ignored, waitpid would return no status */
    (void)fflush(NULL);             /* else the child would flush the same again */
    const double now = weft__wall_clock();
    const pid_t self = getpid();
    *out = (process){ .pid = fork(),
                      .job = job,
                      .began = now,
                      .deadline = def->seconds > 0.0 ? now + def->seconds : HUGE_VAL };
    if (out->pid == 0) {
        run_child(def, job, self);
    }
    out->pid = out->pid < 0 ? 0 : out->pid;
    return out->pid > 0;
}

/* A child that computes has its time limit put off, however slowly it does so. */
static void put_off(const process_def *def, process *one, double now)
{
    struct timespec used = { 0 };
    clockid_t clock;
    if (!def->idle || one->late || clock_getcpuclockid(one->pid, &clock) != 0
        || clock_gettime(clock, &used) != 0) {
        return;
    }
    const double seconds = (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
    if (seconds >= one->used + 0.01 * def->seconds) {
        one->used = seconds;
        one->deadline = now + def->seconds;
    }
}

/* Does not wait for grandchildren. */
static bool has_ended(const process_def *def, process *one)
{
    const double now = weft__wall_clock();
    put_off(def, one, now);
    if (waitpid(one->pid, &one->status, WNOHANG) != 0) {
        one->pid = 0;
    } else if (now >= one->deadline) {
        (void)kill(one->pid, one->late ? SIGKILL : def->end_signal);
        one->late = true;
        one->deadline = now + GRACE;
    }
    return one->pid == 0;
}

/* Sleeps for a sixteenth of the time since `from`, 1 to 50 ms; a signal ends it early.
 * There is no portable way to wait for a child or a time limit. */
static void nap(double from)
{
    const double seconds = (weft__wall_clock() - from) / 16.0;
    const struct timespec pause
        = { .tv_nsec = (long)(1e9 * fmin(fmax(seconds, 0.001), 0.05)) };
    (void)nanosleep(&pause, NULL);
}

static void tick(const process_def *def)
{
    if (def->tick != NULL) {
        def->tick(def->ctx);
    }
}

void process_wait(const process_def *def, process *one)
{
    while (!has_ended(def, one)) {
        tick(def);
        nap(one->began);
    }
}

bool process_run(const process_def *def, size_t job, process *out)
{
    const bool started = process_start(def, job, out);
    if (started) {
        process_wait(def, out);
    }
    return started;
}

void process_describe(int status, char *text, size_t size)
{
    if (WIFSIGNALED(status)) {
        (void)snprintf(text, size, "it crashed: %s", strsignal(WTERMSIG(status)));
    } else {
        (void)snprintf(text, size, "it ended the process with exit code %d",
                       WEXITSTATUS(status));
    }
}

/* ---- many ------------------------------------------------------------------------ */

static bool may_start(const process_pool *pool)
{
    return !pool->stopped && pool->started < pool->jobs;
}

static void fill(process_pool *pool)
{
    bool able = true;
    for (size_t i = 0; i < pool->at_once && able && may_start(pool); ++i) {
        if (pool->all[i].pid == 0) {
            able = process_start(&pool->def, pool->started, &pool->all[i]);
            pool->started += able;
            pool->running += able;
        }
    }
}

/* A fork that fails is tried again as long as other jobs run. */
bool process_pool_run(process_pool *pool)
{
    double last = weft__wall_clock(); /* when the last child ended */
    pool->all = calloc(pool->at_once, sizeof *pool->all);
    if (pool->all == NULL) {
        return false;
    }
    for (fill(pool); pool->running > 0; fill(pool)) {
        tick(&pool->def);
        nap(last);
        const int number = pool->stop == NULL ? 0 : pool->stop(pool->def.ctx);
        for (size_t i = 0; i < pool->at_once; ++i) {
            process *one = &pool->all[i];
            if (one->pid > 0 && number != 0) {
                (void)kill(one->pid, pool->stopped ? SIGKILL : number);
            }
            if (one->pid > 0 && has_ended(&pool->def, one)) {
                last = weft__wall_clock();
                --pool->running;
                if (pool->ended != NULL) {
                    pool->ended(pool->def.ctx, one);
                }
            }
        }
        pool->stopped = pool->stopped || number != 0;
    }
    const int failed = errno;
    free(pool->all);
    errno = failed;
    return !may_start(pool);
}

void *process_memory(size_t count, size_t size)
{
    if (count > SIZE_MAX / size) {
        return NULL;
    }
    void *memory = mmap(NULL, count * size, PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}
