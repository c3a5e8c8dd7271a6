/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/shared_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file of the same name on another machine is another one. */
static weft_status check_shared(const weft_comm *comm, const char *path, int file,
                                weft_error *err)
{
    struct stat seen = { 0 };
    const bool open = file >= 0 && fstat(file, &seen) == 0;
    const int why = errno;
    uint64_t number = (uint64_t)seen.st_ino;
    if (comm != NULL) {
        comm->share(comm->self, &number, sizeof number);
    }
    if (open && number == (uint64_t)seen.st_ino) {
        return WEFT_OK;
    }
    return comm == NULL || comm->rank == 0
               ? weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(why))
               : weft_error_set(
                   err, WEFT_IO,
                   "%.300s: %s: bands need a directory that all ranks share", path,
                   open ? "not the file of rank 0" : strerror(why));
}

weft_status record_shared_open(const weft_comm *comm, const char *path, int flags,
                               int *file, weft_error *err)
{
    *file = open(path, flags | O_NOFOLLOW | O_CLOEXEC);
    return weft_comm_agree(comm, check_shared(comm, path, *file, err), err);
}

/* Writes bytes `from`, or if that is NULL reads them into `to`. */
static bool transfer(int file, const char *from, char *to, size_t size, uint64_t at)
{
    for (size_t moved = 0; moved < size;) {
        const off_t place = (off_t)(at + moved);
        const ssize_t done = from != NULL
                                 ? pwrite(file, from + moved, size - moved, place)
                                 : pread(file, to + moved, size - moved, place);
        if ((done == 0 && from == NULL) || (done < 0 && errno != EINTR)) {
            errno = done == 0 ? ENODATA : errno;
            return false;
        }
        moved += done < 0 ? 0 : (size_t)done;
    }
    return true;
}

bool record_write_at(int file, const void *bytes, size_t size, uint64_t at)
{
    return transfer(file, bytes, NULL, size, at);
}

bool record_read_at(int file, void *bytes, size_t size, uint64_t at)
{
    return transfer(file, NULL, bytes, size, at);
}
