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
            errno = done == 0 ? ENODATA : errno;
            return false;
        }
        const size_t moved = done < 0 ? 0 : (size_t)done;
        to += moved, size -= moved, at += moved;
    }
    return true;
}
