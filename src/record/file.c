/* SPDX-License-Identifier: BSD-3-Clause */
/* file.c -- files that appear complete or not at all. */
#include "record/record.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

weft_status record_path(const char *directory, const char *name, char path[RECORD_PATH],
                        weft_error *err)
{
    const int length = snprintf(path, RECORD_PATH, "%s/%s", directory, name);
    /* room for the suffix of the temporary file */
    if (length < 0 || length + 8 >= RECORD_PATH) {
        return weft_error_set(err, WEFT_IO, "path too long: %.200s/%s", directory,
                              name);
    }
    return WEFT_OK;
}

weft_status record_file_open(record_file *file, const char *directory, const char *name,
                             weft_error *err)
{
    const weft_status status = record_path(directory, name, file->path, err);
    if (status != WEFT_OK) {
        return status;
    }
    memcpy(file->temporary, file->path, strlen(file->path) + 1);
    strcat(file->temporary, ".tmp");
    file->stream = fopen(file->temporary, "w");
    if (file->stream == NULL) {
        return weft_error_set(err, WEFT_IO, "%s: %s", file->temporary, strerror(errno));
    }
    return WEFT_OK;
}

weft_status record_file_commit(record_file *file, weft_error *err)
{
    errno = 0;
    bool written = !ferror(file->stream) && fflush(file->stream) == 0;
    if (ferror(file->stream) && errno == 0) { /* earlier: one byte more tells why */
        written = write(fileno(file->stream), "", 1) < 0 && written;
    }
    written = fsync(fileno(file->stream)) == 0 && written;
    int why = errno;
    if (fclose(file->stream) != 0) {
        written = false;
        why = errno;
    }
    if (written && rename(file->temporary, file->path) == 0) {
        return WEFT_OK;
    }
    why = written ? errno : why;
    (void)remove(file->temporary);
    return weft_error_set(err, WEFT_IO, "%s: %s", file->path,
                          why == 0 ? "write failed" : strerror(why));
}

void record_file_discard(record_file *file)
{
    (void)fclose(file->stream);
    (void)remove(file->temporary);
}

weft_status record_text(const char *directory, const char *name, const char *text,
                        weft_error *err)
{
    record_file file;
    const weft_status status = record_file_open(&file, directory, name, err);
    if (status != WEFT_OK) {
        return status;
    }
    (void)fputs(text, file.stream);
    return record_file_commit(&file, err);
}
