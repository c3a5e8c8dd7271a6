/* SPDX-License-Identifier: BSD-3-Clause */
/* ranks.c -- finds weft-mpi.so on the search path of the plugins and runs a verb with
 * the processes that it joins. */
#define _GNU_SOURCE /* sched_getaffinity */

#include <dlfcn.h>
#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "program/cli.h"
#include "program/mpi/comm_mpi.h"
#include "program/run/interrupt.h"

#define WRONG_START                                                                    \
    "weft %s: --bands %s, but %d %s of one job; start it by mpirun -n %s or srun "     \
    "--mpi=pmix -n %s, of the MPI that weft-mpi.so is built with: %s\n"

int ranks_share(const weft_comm *comm, int number)
{
    if (comm != NULL) {
        comm->share(comm->self, &number, sizeof number);
    }
    return number;
}

char *ranks_share_text(const weft_comm *comm, const char *text)
{
    size_t size = comm->rank == 0 ? strlen(text) + 1 : 0;
    comm->share(comm->self, &size, sizeof size);
    char *copy = malloc(size);
    if (copy == NULL) {
        print_line(stderr, "weft: error: no memory for the text of the scene");
        comm->stop(comm->self, EXIT_SIMULATION);
        return NULL;
    }
    if (comm->rank == 0) {
        memcpy(copy, text, size);
    }
    comm->share(comm->self, copy, size);
    return copy;
}

void ranks_warn(const weft_comm *comm, size_t threads)
{
#ifdef CPU_COUNT
    cpu_set_t mask;
    const bool known = sched_getaffinity(0, sizeof mask, &mask) == 0;
    const int may_use = known ? CPU_COUNT(&mask) : 0;
    const double lacks = known && (size_t)may_use < threads ? 1.0 : 0.0;
    if (comm != NULL && comm->max(comm->self, lacks) > 0.0 && comm->rank == 0) {
        fprintf(
            stderr,
            "weft: warning: run.threads is %zu, and a rank may use fewer processors "
            "(this one %d): see mpirun --bind-to none, srun --cpus-per-task\n",
            threads, may_use);
    }
#else
    (void)comm, (void)threads;
#endif
}

/* ---- begin and end ------------------------------------------------------- */

/* NULL after printing why. */
static comm_mpi *open_mpi(const arguments *given)
{
    char file[RECORD_PATH];
    weft_error err = { 0 };
    if (weft_registry_locate(given->registry, "mpi", file, sizeof file, &err)
        != WEFT_OK) {
        (void)usage_error(
            given,
            "--bands needs weft-mpi.so, which `make` builds where it finds "
            "mpicc: %s",
            strstr(err.message, "no weft-mpi.so"));
        return NULL;
    }
    void *object = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    void *symbol = object == NULL ? NULL : dlsym(object, COMM_MPI_ENTRY);
    if (symbol == NULL) {
        (void)usage_error(given, "--bands: %s", dlerror());
        return NULL;
    }
    comm_mpi_fn *start; /* POSIX allows this conversion, ISO C does not */
    memcpy(&start, &symbol, sizeof start);
    return start();
}

/* Whether this rank was started with the command line and the scene of rank 0, whose
 * run it takes part in; a scene that only rank 0 can read is shared. */
static bool is_alike(const comm_mpi *mpi, const arguments *given)
{
    const weft_comm *comm = &mpi->comm;
    const char *scene = given->operands[0];
    struct stat file; /* 0: this rank cannot read it */
    const bool there = stat(scene, &file) == 0 && S_ISREG(file.st_mode);
    uint64_t mine[2] = { WEFT__HASH_START,
                         there ? record_bytes_sum(scene, 0, (size_t)file.st_size) : 0 };
    uint64_t first[2];
    for (char **word = given->argv; *word != NULL; ++word) {
        for (const char *c = *word; c == *word || c[-1] != '\0'; ++c) {
            mine[0] = weft__hash_byte(mine[0], (unsigned char)*c);
        }
    }
    memcpy(first, mine, sizeof first);
    comm->share(comm->self, first, sizeof first);
    const bool alike = mine[0] == first[0] && (mine[1] == first[1] || mine[1] == 0);
    if (!alike) {
        fprintf(stderr,
                "weft: error: rank %d has %s than rank 0: start all ranks alike\n",
                comm->rank, mine[0] != first[0] ? "other options" : "another scene");
    }
    return comm->max(comm->self, alike ? 0.0 : 1.0) == 0.0;
}

static int run_joined(arguments *given, const comm_mpi *mpi, size_t bands)
{
    const weft_comm *comm = &mpi->comm;
    if (!is_alike(mpi, given)) {
        return EXIT_SCENE;
    }
    if (comm->rank > 0) { /* what rank 0 does, and only that is to be seen */
        const int nowhere = open("/dev/null", O_WRONLY);
        given->quiet = true;
        given->view = false;
        given->mode = PROGRESS_NONE;
        (void)fflush(stdout);
        (void)dup2(nowhere, STDOUT_FILENO);
        (void)dup2(nowhere, STDERR_FILENO);
        (void)close(nowhere);
    }
    if ((size_t)comm->size != bands) {
        fprintf(stderr, WRONG_START, given->verb->name, given->bands, comm->size,
                comm->size == 1 ? "process is" : "processes are", given->bands,
                given->bands, mpi->library);
        return EXIT_USAGE;
    }
    interrupt_catch_user();
    given->comm = comm->size > 1 ? comm : NULL;
    return ranks_share(comm, given->verb->run(given));
}

/* By the variables that Open MPI's and MPICH's launchers set. */
void ranks_hint(void)
{
    static const char *const sizes[] = { "OMPI_COMM_WORLD_SIZE", "PMI_SIZE" };
    for (size_t i = 0; i < 2; ++i) {
        const char *text = getenv(sizes[i]);
        size_t count;
        if (text != NULL && option_count(text, '\0', &count) && count > 1) {
            fprintf(
                stderr,
                "weft: warning: this is one of %zu processes of an MPI job, and each "
                "runs the whole cloth: --bands %zu runs it once\n",
                count, count);
        }
    }
}

int ranks_run(arguments *given)
{
    size_t bands;
    if (!option_count(given->bands, '\0', &bands) || bands == 0) {
        return usage_error(given, "--bands %s: not a number from 1 on", given->bands);
    }
    comm_mpi *mpi = open_mpi(given);
    if (mpi == NULL) {
        return EXIT_USAGE;
    }
    const int code = run_joined(given, mpi, bands);
    (void)fflush(stdout);
    mpi->close(mpi);
    return code;
}
