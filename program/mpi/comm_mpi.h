/* SPDX-License-Identifier: BSD-3-Clause */
/* comm_mpi.h -- what weft-mpi.so exports. The object is loaded at run time, so that
 * neither libweft nor the program links MPI. */
#pragma once

#include "weft/comm.h"

#define COMM_MPI_ENTRY "weft_comm_mpi_1"

typedef struct comm_mpi comm_mpi;
struct comm_mpi {
    weft_comm comm;                /* the processes of MPI_COMM_WORLD */
    const char *library;           /* which MPI this is, in one line */
    void (*close)(comm_mpi *self); /* collective: ends MPI and frees this */
};

/* Starts MPI; once per process. NULL: no memory. */
typedef comm_mpi *comm_mpi_fn(void);
WEFT_API comm_mpi_fn weft_comm_mpi_1;
