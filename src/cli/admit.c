/* SPDX-License-Identifier: BSD-3-Clause */
/* admit.c -- plugins loaded on trial in a child process, as a plugin may end or block
 * its process while it is loaded. */
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include "cli/cli.h"
#include "record/child_process.h"

enum { LOAD_SECONDS = 10 }; /* ours take some milliseconds */

/* Shared with the child: an exit code could be the plugin's. */
typedef enum trial_end { NEVER_RETURNED, STREAMS_CLOSED, RETURNED } trial_end;

typedef struct trial_load {
    const char *file;
    trial_end *end;
} trial_load;

/* A plugin that is refused returns too, and the parent finds out why. */
static int load(void *ctx, size_t job)
{
    const trial_load *self = ctx;
    const weft_registry_def def = { 0 };
    weft_registry *registry = NULL;
    (void)job;
    if (weft_registry_create(&def, &registry, NULL) == WEFT_OK) {
        (void)weft_registry_load(registry, self->file, NULL);
    }
    weft_registry_destroy(registry);
    const bool open = fcntl(STDIN_FILENO, F_GETFD) >= 0
                      && fcntl(STDOUT_FILENO, F_GETFD) >= 0
                      && fcntl(STDERR_FILENO, F_GETFD) >= 0;
    *self->end = open ? RETURNED : STREAMS_CLOSED;
    return 0;
}

/* Where there are no more processes to be had, plugins are trusted. */
weft_status admit_plugin(void *ctx, const char *file, weft_error *err)
{
    char why[128];
    process child;
    trial_load self = { file, process_memory(1, sizeof *self.end) };
    const process_def def = { .work = load,
                              .ctx = &self,
                              .end_signal = SIGKILL,
                              .seconds = LOAD_SECONDS,
                              .untrusted = true };
    (void)ctx;
    if (self.end == NULL || !process_run(&def, 0, &child) || *self.end == RETURNED) {
        return WEFT_OK;
    }
    process_describe(child.status, why, sizeof why);
    if (*self.end == STREAMS_CLOSED) {
        (void)snprintf(why, sizeof why, "it closes standard streams");
    } else if (child.late) {
        (void)snprintf(why, sizeof why, "it takes longer than %d s", LOAD_SECONDS);
    }
    return weft_error_set(err, WEFT_BAD_PLUGIN, "loading it: %s", why);
}
