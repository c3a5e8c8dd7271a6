/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

FILE *weft__file_open(const char *path, const char *mode, weft_error *err)
{
    struct stat status = { 0 };
    FILE *stream = NULL;
    const char *why = NULL;
    const int access = mode[0] == 'w'   ? O_WRONLY | O_CREAT | O_TRUNC
                       : mode[1] == '+' ? O_RDWR
                                        : O_RDONLY;
    const int file = open(path, access | O_NONBLOCK | O_CLOEXEC, 0666);
    if (file >= 0 && fstat(file, &status) == 0 && !S_ISREG(status.st_mode)) {
        errno = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
        why = S_ISDIR(status.st_mode) ? NULL : "not a regular file";
    } else if (file >= 0) {
        stream = fdopen(file, mode);
    }
    if (stream == NULL) {
        const int kept = errno;
        (void)weft_error_set(err, kept == ENOMEM ? WEFT_NO_MEMORY : WEFT_IO,
                             "%.200s: %s", path, why == NULL ? strerror(kept) : why);
        if (file >= 0) {
            (void)close(file);
        }
        errno = kept;
    }
    return stream;
}
