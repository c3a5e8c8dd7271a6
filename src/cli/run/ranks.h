/* SPDX-License-Identifier: BSD-3-Clause */
/* ranks.h -- a verb in bands: one process per band, started by mpirun or srun and
 * joined by weft-mpi.so. With comm NULL all functions are those of a single process. */
#ifndef WEFT_CLI_RUN_RANKS_H
#define WEFT_CLI_RUN_RANKS_H

#include "cli/cli.h"

/* Starts MPI, runs the verb with given->comm, ends MPI. Only rank 0 prints. Returns the
 * exit code of rank 0 on all ranks. */
int ranks_run(arguments *given);

/* Without --bands: warns in a job of several processes. */
void ranks_hint(void);

/* Whether this process prints and writes the files that are not in bands. */
static inline bool ranks_first(const weft_comm *comm)
{
    return comm == NULL || comm->rank == 0;
}

/* Collective: a number of rank 0, to all. */
int ranks_share(const weft_comm *comm, int number);

/* Collective: a text of rank 0, to all: allocated on the others, NULL if there is no
 * memory. */
char *ranks_share_text(const weft_comm *comm, const char *text);

/* Collective: warns if a rank may use fewer processors than it has threads, as
 * launchers bind ranks to cores. */
void ranks_warn(const weft_comm *comm, size_t threads);

#endif
