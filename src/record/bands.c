/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/bands.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Names the band, as a message of a full disk is of one machine. */
static weft_error first_error(const weft_comm *comm, const weft_error *all)
{
    int band = 0;
    while (all[band].status == WEFT_OK) {
        ++band;
    }
    weft_error first = all[band];
    if (band > 0) {
        (void)snprintf(first.message, sizeof first.message, "rank %d of %d: %.480s",
                       band, comm->size, all[band].message);
    }
    return first;
}

weft_status record_agree(const weft_comm *comm, weft_status status, weft_error *err)
{
    if (comm == NULL || comm->max(comm->self, status) == 0.0) {
        return status;
    }
    weft_error mine = { .status = WEFT_OK }, *all = NULL;
    if (status != WEFT_OK) {
        weft_error_set(&mine, status, "%s", weft_status_text(status));
        mine = err != NULL ? *err : mine;
        mine.status = status;
    }
    if (comm->rank == 0 && (all = calloc((size_t)comm->size, sizeof *all)) == NULL) {
        comm->stop(comm->self, EXIT_FAILURE);
        return WEFT_NO_MEMORY;
    }
    comm->gather(comm->self, &mine, sizeof mine, all);
    mine = comm->rank == 0 ? first_error(comm, all) : mine;
    comm->share(comm->self, &mine, sizeof mine);
    free(all);
    if (err != NULL) {
        *err = mine;
    }
    return mine.status;
}

weft_status record_gather(const weft_comm *comm, const weft_band *band,
                          const void *mine, size_t size, void **all, weft_error *err)
{
    weft_status status = WEFT_OK;
    const bool here = comm == NULL || comm->rank == 0;
    *all = here ? malloc(band->rows * size) : NULL;
    if (here && *all == NULL) {
        status = weft_error_set(err, WEFT_NO_MEMORY, "no memory for the whole cloth");
    }
    status = record_agree(comm, status, err);
    if (status != WEFT_OK) {
        free(*all);
        *all = NULL;
    } else if (comm == NULL) {
        memcpy(*all, mine, band->own * size);
    } else {
        comm->gather(comm->self, mine, band->own * size, *all);
    }
    return status;
}

bool record_write_at(int file, const void *bytes, size_t size, uint64_t at)
{
    const char *from = bytes;
    while (size > 0) {
        const ssize_t done = pwrite(file, from, size, (off_t)at);
        if (done < 0 && errno != EINTR) {
            return false;
        }
        const size_t moved = done < 0 ? 0 : (size_t)done;
        from += moved, size -= moved, at += moved;
    }
    return true;
}

bool record_read_at(int file, void *bytes, size_t size, uint64_t at)
{
    char *to = bytes;
    while (size > 0) {
        const ssize_t done = pread(file, to, size, (off_t)at);
        if (done == 0 || (done < 0 && errno != EINTR)) {
            return false;
        }
        const size_t moved = done < 0 ? 0 : (size_t)done;
        to += moved, size -= moved, at += moved;
    }
    return true;
}
