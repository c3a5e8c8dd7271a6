/* SPDX-License-Identifier: BSD-3-Clause */
/* admit.c -- plugins loaded on trial in a child process, as a plugin may end or block
 * its process while it is loaded. */
#include <signal.h>
#include <sys/wait.h>

#include "cli/cli.h"
#include "record/child_process.h"

enum { LOAD_SECONDS = 10 }; /* ours take some milliseconds */

/* The exit code of a child that came back from loading: rarely that of a plugin. One
 * that is refused comes back too, and the parent finds out why. */
enum { CAME_BACK = 91 };

static int load(void *file, size_t job)
{
    const weft_registry_def def = { 0 };
    weft_registry *registry = NULL;
    (void)job;
    if (weft_registry_create(&def, &registry, NULL) == WEFT_OK) {
        (void)weft_registry_load(registry, file, NULL);
    }
    return CAME_BACK;
}

/* Where there are no more processes to be had, plugins are trusted. */
weft_status admit_plugin(void *ctx, const char *file, weft_error *err)
{
    char why[128];
    process child;
    const process_def def = { .work = load,
                              .ctx = (void *)file,
                              .end_signal = SIGKILL,
                              .seconds = LOAD_SECONDS,
                              .untrusted = true };
    (void)ctx;
    if (!process_run(&def, 0, &child)
        || (WIFEXITED(child.status) && WEXITSTATUS(child.status) == CAME_BACK)) {
        return WEFT_OK;
    }
    process_describe(child.status, why, sizeof why);
    if (child.late) {
        (void)snprintf(why, sizeof why, "it takes longer than %d s", LOAD_SECONDS);
    }
    return weft_error_set(err, WEFT_BAD_PLUGIN, "loading it: %s", why);
}
