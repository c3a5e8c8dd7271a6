/* SPDX-License-Identifier: BSD-3-Clause */
/* child_process.h -- runs functions in child processes, since they may crash, never
 * return, or be many and slow. A child returns its results in memory from
 * process_memory. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct process_def {
    /* Runs in the child; returns its exit code. */
    int (*work)(void *ctx, size_t job);
    void *ctx;
    void (*tick)(void *ctx); /* in the parent, while children run; NULL: not called */
    /* SIGKILL, or SIGTERM and 3 s later SIGKILL: sent at the time limit and, on Linux,
     * when the parent ends. */
    int end_signal;
    double seconds;       /* time limit; 0: none */
    bool idle;            /* limits only a time with less than 1 % of a processor */
    unsigned cpu_seconds; /* limit of processor time; 0: none */
    bool untrusted;       /* writes no core file, prints to /dev/null */
} process_def;

typedef struct process {
    pid_t pid; /* 0: not running */
    size_t job;
    double began, deadline; /* [s] on weft__wall_clock */
    double used;            /* [s] of a processor; the deadline counts from there */
    bool late;              /* reached its time limit */
    int status;             /* after its end, as waitpid reports it */
} process;

/* False: no process could be started (errno). */
bool process_start(const process_def *def, size_t job, process *out);
/* Waits for its end. */
void process_wait(const process_def *def, process *one);
/* Both. */
bool process_run(const process_def *def, size_t job, process *out);

/* "it crashed: Aborted" or "it ended the process with exit code 3". */
void process_describe(int status, char *text, size_t size);

typedef struct process_pool {
    process_def def;
    size_t jobs, at_once;
    void (*ended)(void *ctx, const process *one); /* after each job; NULL: not called */
    /* Returns a signal that came since the last call, or 0. After the first, no more
     * jobs start, and it is sent to the children; from the second on they get SIGKILL.
     * NULL: no signal is caught. */
    int (*stop)(void *ctx);

    process *all; /* at_once of them, while it runs */
    size_t started, running;
    bool stopped;
} process_pool;

/* False: job `started` got no process while no other job ran (errno). */
bool process_pool_run(process_pool *pool);

/* Zeroed memory that this process and its later children share until they end. NULL:
 * there is none. */
void *process_memory(size_t count, size_t size);
