/* SPDX-License-Identifier: BSD-3-Clause */
/* comm_mpi.c -- weft_comm over MPI; the only file that includes mpi.h. MPI's default
 * error handler ends the job, so no call's result is looked at. */
#include "program/mpi/comm_mpi.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>

enum { DOWN, UP, SIZE, DATA, PARCEL }; /* tags */
#define MOST ((size_t)1 << 30)         /* [bytes] of a message: MPI counts in int */

typedef struct over_mpi {
    comm_mpi base;
    MPI_Comm all;
    MPI_Datatype edge; /* the edge rows of each plane, where they stand */
    size_t planes, stride, cols;
    MPI_Request *requests; /* room for four, and two for each other rank */
    MPI_Status *statuses;  /* MPICH's way to ignore them makes gcc warn */
    int count;
    char library[MPI_MAX_LIBRARY_VERSION_STRING];
} over_mpi;

/* The bits of doubles >= 0 have their order, and those of NaN are above all. MPI_MAX
 * of doubles loses NaN, or gives the ranks different results. */
static double max(void *ctx, double mine)
{
    const over_mpi *self = ctx;
    uint64_t bits, most;
    double got;
    memcpy(&bits, &mine, sizeof bits);
    bits &= UINT64_MAX >> 1; /* a NaN may have a sign */
    MPI_Allreduce(&bits, &most, 1, MPI_UINT64_T, MPI_MAX, self->all);
    memcpy(&got, &most, sizeof got);
    return got;
}

/* ---- edge rows: sent from where they stand and received where they belong ---- */

static void free_edge(over_mpi *self)
{
    if (self->edge != MPI_DATATYPE_NULL) {
        MPI_Type_free(&self->edge);
    }
}

static void make_edge(over_mpi *self, const weft_rows *rows)
{
    MPI_Datatype one;
    free_edge(self);
    MPI_Type_contiguous((int)(WEFT_GHOST_ROWS * rows->cols), MPI_DOUBLE, &one);
    MPI_Type_create_hvector((int)rows->planes, 1,
                            (MPI_Aint)(rows->stride * sizeof(double)), one,
                            &self->edge);
    MPI_Type_commit(&self->edge);
    MPI_Type_free(&one);
    self->planes = rows->planes;
    self->stride = rows->stride;
    self->cols = rows->cols;
}

/* Sends `own` to a neighbour and receives its rows into `ghost`. */
static void exchange(over_mpi *self, int rank, double *own, double *ghost, int out,
                     int in)
{
    MPI_Request *next = self->requests + self->count;
    MPI_Irecv(ghost, 1, self->edge, rank, in, self->all, &next[0]);
    MPI_Isend(own, 1, self->edge, rank, out, self->all, &next[1]);
    self->count += 2;
}

static void begin(void *ctx, const weft_rows *rows)
{
    over_mpi *self = ctx;
    const int rank = self->base.comm.rank;
    double *first = rows->first + rows->above * rows->cols;
    double *end = first + rows->own * rows->cols;
    const size_t edge = WEFT_GHOST_ROWS * rows->cols;
    if (rows->planes != self->planes || rows->stride != self->stride
        || rows->cols != self->cols) {
        make_edge(self, rows);
    }
    self->count = 0;
    if (rows->above > 0) {
        exchange(self, rank - 1, first, first - edge, UP, DOWN);
    }
    if (rows->below > 0) {
        exchange(self, rank + 1, end - edge, end, DOWN, UP);
    }
}

/* Fewer than 2^31 numbers: those of a surface between two bands, or six of each own
 * particle. */
static void post(void *ctx, const weft_parcel *parcels, size_t count)
{
    over_mpi *self = ctx;
    self->count = 0;
    for (size_t p = 0; p < count; ++p) {
        const weft_parcel *at = &parcels[p];
        MPI_Request *next = self->requests + self->count;
        MPI_Irecv(at->in, (int)at->ins, MPI_DOUBLE, at->rank, PARCEL, self->all,
                  &next[0]);
        MPI_Isend(at->out, (int)at->outs, MPI_DOUBLE, at->rank, PARCEL, self->all,
                  &next[1]);
        self->count += 2;
    }
}

static void poke(void *ctx)
{
    over_mpi *self = ctx;
    int done = 0;
    MPI_Testall(self->count, self->requests, &done, self->statuses);
    self->count = done ? 0 : self->count;
}

static void end(void *ctx)
{
    over_mpi *self = ctx;
    MPI_Waitall(self->count, self->requests, self->statuses);
    self->count = 0;
}

/* ---- bytes, in messages that MPI can count ------------------------------- */

static void share(void *ctx, void *data, size_t bytes)
{
    const over_mpi *self = ctx;
    char *at = data;
    for (size_t size; bytes > 0; at += size, bytes -= size) {
        size = bytes < MOST ? bytes : MOST;
        MPI_Bcast(at, (int)size, MPI_BYTE, 0, self->all);
    }
}

static void send_all(const over_mpi *self, const char *from, uint64_t bytes)
{
    MPI_Send(&bytes, 1, MPI_UINT64_T, 0, SIZE, self->all);
    for (size_t size; bytes > 0; from += size, bytes -= size) {
        size = bytes < MOST ? bytes : MOST;
        MPI_Send(from, (int)size, MPI_BYTE, 0, DATA, self->all);
    }
}

static char *receive_all(const over_mpi *self, int rank, char *to)
{
    uint64_t bytes;
    MPI_Recv(&bytes, 1, MPI_UINT64_T, rank, SIZE, self->all, MPI_STATUS_IGNORE);
    for (size_t size; bytes > 0; to += size, bytes -= size) {
        size = bytes < MOST ? bytes : MOST;
        MPI_Recv(to, (int)size, MPI_BYTE, rank, DATA, self->all, MPI_STATUS_IGNORE);
    }
    return to;
}

static void gather(void *ctx, const void *mine, size_t bytes, void *all)
{
    const over_mpi *self = ctx;
    if (self->base.comm.rank > 0) {
        send_all(self, mine, bytes);
        return;
    }
    if (bytes > 0) {
        memcpy(all, mine, bytes);
    }
    char *to = (char *)all + bytes;
    for (int rank = 1; rank < self->base.comm.size; ++rank) {
        to = receive_all(self, rank, to);
    }
}

/* ---- begin and end ------------------------------------------------------- */

static void stop(void *ctx, int code)
{
    (void)MPI_Abort(((over_mpi *)ctx)->all, code);
    abort();
}

static void close_mpi(comm_mpi *base)
{
    over_mpi *self = base->comm.self;
    free_edge(self);
    MPI_Comm_free(&self->all);
    MPI_Finalize();
    free(self->requests);
    free(self->statuses);
    free(self);
}

comm_mpi *weft_comm_mpi_1(void)
{
    int threads, length;
    over_mpi *self = calloc(1, sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &threads);
    MPI_Comm_dup(MPI_COMM_WORLD, &self->all);
    MPI_Get_library_version(self->library, &length);
    self->library[strcspn(self->library, "\n,")] = '\0';
    self->edge = MPI_DATATYPE_NULL;
    self->base = (comm_mpi){ .comm = { .struct_size = sizeof(weft_comm),
                                       .self = self,
                                       .max = max,
                                       .begin = begin,
                                       .poke = poke,
                                       .end = end,
                                       .share = share,
                                       .gather = gather,
                                       .stop = stop,
                                       .post = post },
                             .library = self->library,
                             .close = close_mpi };
    MPI_Comm_rank(self->all, &self->base.comm.rank);
    MPI_Comm_size(self->all, &self->base.comm.size);
    const size_t most = 4 + 2 * (size_t)self->base.comm.size;
    self->requests = malloc(most * sizeof(MPI_Request));
    self->statuses = malloc(most * sizeof(MPI_Status));
    if (self->requests == NULL || self->statuses == NULL) {
        close_mpi(&self->base);
        return NULL;
    }
    return &self->base;
}
