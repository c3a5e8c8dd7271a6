/* SPDX-License-Identifier: BSD-3-Clause */
/* thread_comm.h -- a weft_comm over threads of one program, each with a band of the
 * cloth. A copy of it is a start for a comm over anything else.
 *
 *     thread_bands *bands = thread_bands_create(3);
 *     weft_comm comm = thread_bands_comm(bands, rank);    in thread rank of 3
 *
 * Two waits of all threads make a call collective: no thread reads before all have
 * written, and none writes again before all have read. */
#ifndef THREAD_COMM_H
#define THREAD_COMM_H

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <weft/comm.h>

typedef struct thread_band {
    struct thread_bands *all;
    int rank;
    double number;              /* of max */
    weft_rows rows;             /* of begin and end */
    const weft_parcel *parcels; /* of post and end; else NULL */
    size_t count;
    const void *data; /* of share and gather */
    size_t bytes;
} thread_band;

typedef struct thread_bands {
    pthread_barrier_t barrier;
    int size;
    thread_band *band;
} thread_bands;

static inline void thread_bands_wait(thread_bands *all)
{
    (void)pthread_barrier_wait(&all->barrier);
}

static inline double thread_bands_max(void *self, double mine)
{
    thread_band *band = (thread_band *)self;
    thread_bands *all = band->all;
    double most = mine;
    band->number = mine;
    thread_bands_wait(all);
    for (int i = 0; i < all->size; ++i) {
        const double other = all->band[i].number;
        most = isnan(most) || other <= most ? most : other; /* NaN if one is */
    }
    thread_bands_wait(all);
    return most;
}

static inline void thread_bands_begin(void *self, const weft_rows *rows)
{
    thread_band *band = (thread_band *)self;
    band->rows = *rows;
    thread_bands_wait(band->all);
}

static inline void thread_bands_post(void *self, const weft_parcel *parcels,
                                     size_t count)
{
    thread_band *band = (thread_band *)self;
    band->parcels = parcels;
    band->count = count;
    thread_bands_wait(band->all);
}

/* What the others have for this band. */
static inline void thread_bands_take(const thread_band *band)
{
    for (size_t p = 0; p < band->count; ++p) {
        const weft_parcel *mine = &band->parcels[p];
        const thread_band *other = &band->all->band[mine->rank];
        for (size_t q = 0; q < other->count; ++q) {
            if (other->parcels[q].rank == band->rank && mine->ins > 0) {
                memcpy(mine->in, other->parcels[q].out, mine->ins * sizeof *mine->in);
            }
        }
    }
}

static inline void thread_bands_copy(const weft_rows *to, size_t row,
                                     const weft_rows *from, size_t from_row)
{
    const size_t bytes = WEFT_GHOST_ROWS * to->cols * sizeof *to->first;
    for (size_t k = 0; k < to->planes; ++k) {
        memcpy(to->first + k * to->stride + row * to->cols,
               from->first + k * from->stride + from_row * from->cols, bytes);
    }
}

static inline void thread_bands_end(void *self)
{
    thread_band *band = (thread_band *)self;
    const weft_rows *mine = &band->rows;
    if (band->parcels != NULL) {
        thread_bands_take(band);
        thread_bands_wait(band->all);
        band->parcels = NULL;
        return;
    }
    if (mine->above > 0) { /* the last own rows of the band before this one */
        const weft_rows *other = &(band - 1)->rows;
        thread_bands_copy(mine, 0, other, other->above + other->own - WEFT_GHOST_ROWS);
    }
    if (mine->below > 0) {
        const weft_rows *other = &(band + 1)->rows;
        thread_bands_copy(mine, mine->above + mine->own, other, other->above);
    }
    thread_bands_wait(band->all);
}

static inline void thread_bands_share(void *self, void *data, size_t bytes)
{
    thread_band *band = (thread_band *)self;
    band->data = data;
    thread_bands_wait(band->all);
    if (band->rank > 0) {
        memcpy(data, band->all->band[0].data, bytes);
    }
    thread_bands_wait(band->all);
}

static inline void thread_bands_gather(void *self, const void *mine, size_t bytes,
                                       void *to)
{
    thread_band *band = (thread_band *)self;
    thread_bands *all = band->all;
    char *at = (char *)to;
    band->data = mine;
    band->bytes = bytes;
    thread_bands_wait(all);
    for (int i = 0; band->rank == 0 && i < all->size; ++i) {
        if (all->band[i].bytes > 0) {
            memcpy(at, all->band[i].data, all->band[i].bytes);
            at += all->band[i].bytes;
        }
    }
    thread_bands_wait(all);
}

static inline void thread_bands_stop(void *self, int code)
{
    (void)self;
    _Exit(code);
}

/* NULL: no memory. */
static inline thread_bands *thread_bands_create(int size)
{
    thread_bands *all = (thread_bands *)calloc(1, sizeof *all);
    thread_band *band = (thread_band *)calloc((size_t)size, sizeof *band);
    if (all == NULL || band == NULL
        || pthread_barrier_init(&all->barrier, NULL, (unsigned)size) != 0) {
        free(band);
        free(all);
        return NULL;
    }
    all->size = size;
    all->band = band;
    for (int i = 0; i < size; ++i) {
        band[i].all = all;
        band[i].rank = i;
    }
    return all;
}

static inline void thread_bands_destroy(thread_bands *all)
{
    if (all != NULL) {
        (void)pthread_barrier_destroy(&all->barrier);
        free(all->band);
        free(all);
    }
}

/* The comm of thread `rank`; lasts as long as `all`. */
static inline weft_comm thread_bands_comm(thread_bands *all, int rank)
{
    return (weft_comm){ .struct_size = sizeof(weft_comm),
                        .self = &all->band[rank],
                        .rank = rank,
                        .size = all->size,
                        .max = thread_bands_max,
                        .begin = thread_bands_begin,
                        .end = thread_bands_end,
                        .share = thread_bands_share,
                        .gather = thread_bands_gather,
                        .stop = thread_bands_stop,
                        .post = thread_bands_post };
}

#endif
