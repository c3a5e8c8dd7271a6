/* SPDX-License-Identifier: BSD-3-Clause */
/* watch.c -- the options of --watch, and the process that serves a run's page. */
#define _XOPEN_SOURCE 700 /* nice */
#include "program/watch/watch.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/run/interrupt.h"

enum { PORT_LEAST = 1024 };
#define FAREWELL 30.0 /* [s] for slow browsers to get the end of a run */

int watch_check(const arguments *given, uint16_t *port)
{
    size_t number = 0;
    *port = 0;
    if (given->port != NULL
        && !(option_count(given->port, '\0', &number) && number >= PORT_LEAST
             && number <= UINT16_MAX)) {
        return usage_error(given, "--port %s: not a number from %d to %d", given->port,
                           PORT_LEAST, UINT16_MAX);
    }
    if (given->port != NULL && !given->watch) {
        return usage_error(given, "--port needs --watch");
    }
    if (given->watch && given->bands != NULL) {
        return usage_error(given, "--watch and --bands exclude each other: 'weft view "
                                  "--watch DIR' serves a run that is under way");
    }
    *port = (uint16_t)number;
#ifndef WEFT_HTTP
    if (given->watch) {
        return usage_error(given, "--watch: this weft was built without libmicrohttpd "
                                  "(package libmicrohttpd-dev)");
    }
#endif
    return EXIT_DONE;
}

#ifndef WEFT_HTTP
weft_status watch_serve(const watch_def *def, weft_error *err)
{
    return weft_error_set(err, WEFT_UNSUPPORTED, "%s: this weft has no server",
                          def->directory);
}
#endif

static int serve(void *ctx, size_t job)
{
    const watch_process *self = ctx;
    weft_error err = { 0 };
    (void)job;
    /* Ctrl-C ends the run, and the run ends this. */
    (void)signal(SIGINT, SIG_IGN);
    (void)close(self->lock);
    (void)!nice(10);
    return watch_serve(&self->def, &err) == WEFT_OK ? EXIT_DONE : report_error(&err);
}

void watch_begin(watch_process *self, const watch_def *def, int lock)
{
    int ready[2];
    char byte;
    *self = (watch_process){ .def = *def, .lock = lock };
    self->process = (process_def){ .work = serve, .ctx = self, .end_signal = SIGTERM };
    if (pipe(ready) != 0) {
        print_line(stderr, "weft: warning: no --watch: %s", strerror(errno));
        return;
    }
    self->def.parent = getpid();
    self->def.ready = ready[1];
    const bool started = process_start(&self->process, 0, &self->child);
    const int why = errno;
    (void)close(ready[1]);
    if (!started) {
        print_line(stderr, "weft: warning: no --watch: %s", strerror(why));
    } else {
        (void)!read(ready[0], &byte, 1); /* until it is closed */
    }
    (void)close(ready[0]);
}

/* The run is done: a signal that comes now ends the wait. */
static void heed_signal(void *ctx)
{
    const watch_process *self = ctx;
    if (interrupt_next() != 0) {
        (void)kill(self->child.pid, SIGKILL);
    }
}

void watch_end(watch_process *self)
{
    if (self->child.pid > 0) {
        (void)interrupt_next(); /* of the run */
        self->process.tick = heed_signal;
        self->child.deadline = weft__wall_clock() + FAREWELL;
        process_wait(&self->process, &self->child);
    }
}
