/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/bands.h"

#include <errno.h>
#include <unistd.h>

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
