/* SPDX-License-Identifier: BSD-3-Clause */
/* admit.c -- child processes: plugins loaded on trial in one, as a plugin may end or
 * block its process while it is loaded; and how children end. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "cli/cli.h"

enum { LOAD_SECONDS = 10 }; /* ours take some milliseconds */

void process_end(int status, char *text, size_t size)
{
    if (WIFSIGNALED(status)) {
        (void)snprintf(text, size, "it crashed: %s", strsignal(WTERMSIG(status)));
    } else {
        (void)snprintf(text, size, "it ended the process with exit code %d",
                       WEXITSTATUS(status));
    }
}

void process_ends_with_parent(int signal_number)
{
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, signal_number);
#else
    (void)signal_number;
#endif
}

/* In the child. A plugin that is refused comes back too: the parent finds out why. */
_Noreturn static void load_and_report(const char *file, int to)
{
    const struct rlimit core = { 0, 0 };
    const int nowhere = open("/dev/null", O_WRONLY);
    const weft_registry_def def = { 0 };
    weft_registry *registry = NULL;
    (void)setrlimit(RLIMIT_CORE, &core);
    (void)alarm(2 * LOAD_SECONDS); /* should the parent be gone by then */
    (void)dup2(nowhere, STDOUT_FILENO);
    (void)dup2(nowhere, STDERR_FILENO);
    if (weft_registry_create(&def, &registry, NULL) == WEFT_OK) {
        (void)weft_registry_load(registry, file, NULL);
    }
    _exit(write(to, "", 1) == 1 ? 0 : 1);
}

/* Whether the child reports in time; it is gone then. */
static bool await_report(pid_t child, int from, char *why, size_t size)
{
    struct pollfd report = { .fd = from, .events = POLLIN };
    char byte;
    int status = 0, ready;
    do {
        ready = poll(&report, 1, 1000 * LOAD_SECONDS);
    } while (ready < 0 && errno == EINTR);
    const bool loaded = ready > 0 && read(from, &byte, 1) == 1;
    if (ready == 0) {
        (void)kill(child, SIGKILL);
    }
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    process_end(status, why, size);
    if (ready == 0) {
        (void)snprintf(why, size, "it takes longer than %d s", LOAD_SECONDS);
    }
    return loaded;
}

/* Where there are no more processes to be had, plugins are trusted. */
weft_status admit_plugin(void *ctx, const char *file, weft_error *err)
{
    char why[128];
    int ends[2];
    (void)ctx;
    (void)fflush(NULL); /* the child may flush as well */
    if (pipe(ends) != 0) {
        return WEFT_OK;
    }
    const pid_t child = fork();
    if (child == 0) {
        (void)close(ends[0]);
        load_and_report(file, ends[1]);
    }
    (void)close(ends[1]);
    const bool loaded = child < 0 || await_report(child, ends[0], why, sizeof why);
    (void)close(ends[0]);
    return loaded ? WEFT_OK
                  : weft_error_set(err, WEFT_BAD_PLUGIN, "loading it: %s", why);
}
