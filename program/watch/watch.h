/* SPDX-License-Identifier: BSD-3-Clause */
/* watch.h -- a run in the browser while it is under way: a server on 127.0.0.1 that
 * ends with the run. It reads the run's files, in a process that the run never waits
 * for. */
#pragma once

#include "program/cli.h"
#include "program/record/child_process.h"

/* Returns EXIT_DONE, or prints why --watch and --port cannot be used as given; fills in
 * *port (0: the system chooses one). */
int watch_check(const arguments *given, uint16_t *port);

typedef struct watch_def {
    const char *directory;
    uint16_t port;
    bool yaml;    /* the URL as a document {event: watch, url: ...} */
    bool writes;  /* run.html, once there is a frame */
    pid_t parent; /* the process that runs; 0: not known, the directory is locked */
    int ready;    /* closed once the URL is printed; -1: none */
} watch_def;

/* watch_server.c: prints the URL and serves the page of a run until it is over, or a
 * signal comes. WEFT_IO: the port is not free. */
weft_status watch_serve(const watch_def *def, weft_error *err);

/* The same in a child process, from before the run's first thread on. `lock` is closed
 * there. Returns once the URL is printed, or the child has failed and said why. */
typedef struct watch_process {
    watch_def def;
    int lock;
    process_def process;
    process child;
} watch_process;

void watch_begin(watch_process *self, const watch_def *def, int lock);
/* After result.yaml: waits until the browsers have the end, at most half a minute. */
void watch_end(watch_process *self);
