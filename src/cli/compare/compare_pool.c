/* SPDX-License-Identifier: BSD-3-Clause */
/* compare_pool.c -- so many processes at once, one a job. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/compare/compare.h"

void *pool_memory(size_t count, size_t size)
{
    if (count > SIZE_MAX / size) {
        return NULL;
    }
    void *memory = mmap(NULL, count * size, PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void pool_free(void *memory, size_t count, size_t size)
{
    if (memory != NULL) {
        (void)munmap(memory, count * size);
    }
}

typedef struct children {
    pid_t *pids; /* of jobs; 0: not started, or over */
    size_t running;
} children;

static bool begin(const compare_pool *self, const compare *of, children *all,
                  size_t job)
{
    const pid_t pid = fork();
    if (pid == 0) {
        process_ends_with_parent(SIGKILL); /* they write to shared memory alone */
        self->work(of, job);
        _exit(EXIT_DONE);
    }
    all->pids[job] = pid < 0 ? 0 : pid;
    all->running += pid > 0;
    return pid > 0;
}

static void await(const compare_pool *self, compare *of, children *all)
{
    int status = 0;
    pid_t pid;
    do {
        pid = waitpid(-1, &status, 0);
    } while (pid < 0 && errno == EINTR);
    for (size_t job = 0; job < self->jobs; ++job) {
        if (pid > 0 && all->pids[job] == pid) {
            const bool killed = WIFSIGNALED(status);
            char how[64];
            (void)snprintf(how, sizeof how, "its process was ended by %s %d",
                           killed ? "signal" : "exit code",
                           killed ? WTERMSIG(status) : WEXITSTATUS(status));
            all->pids[job] = 0;
            --all->running;
            self->ended(of, job, status != 0 ? how : NULL);
        }
    }
    all->running = pid < 0 ? 0 : all->running;
}

weft_status pool_run(const compare_pool *self, compare *of, weft_error *err)
{
    children all = { calloc(self->jobs, sizeof *all.pids), 0 };
    bool able = all.pids != NULL;
    for (size_t job = 0; job < self->jobs && able; ++job) {
        if (all.running == self->at_once) {
            await(self, of, &all);
        }
        able = begin(self, of, &all, job);
    }
    while (all.running > 0) {
        await(self, of, &all);
    }
    free(all.pids);
    return able ? WEFT_OK
                : weft_error_set(err, WEFT_SOLVER, "no process for a run: %s",
                                 strerror(errno));
}
