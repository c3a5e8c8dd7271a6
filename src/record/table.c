/* SPDX-License-Identifier: BSD-3-Clause */
/* table.c -- a CSV file that grows by whole lines and is readable after a kill. */
#include "record/series.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"

static weft_status failed(const record_table *table, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: %s", table->path, strerror(errno));
}

weft_status record_table_write(record_table *table, const char *line, weft_error *err)
{
    const size_t length = strlen(line);
    for (size_t i = 0; i < length; ++i) {
        table->extent.sum = weft__hash_byte(table->extent.sum, (unsigned char)line[i]);
    }
    table->extent.length += length;
    (void)fputs(line, table->stream);
    if (ferror(table->stream) || fflush(table->stream) != 0) {
        return failed(table, err);
    }
    return WEFT_OK;
}

weft_status record_table_open(record_table *table, const char *directory,
                              const char *name, bool again, weft_error *err)
{
    weft_status status = record_path(directory, name, table->path, err);
    status = status == WEFT_OK ? record_no_link(table->path, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    table->extent = (record_extent){ .sum = WEFT__HASH_START };
    table->stream = weft__file_open(table->path, again ? "r+" : "w", err);
    return table->stream == NULL ? WEFT_IO : WEFT_OK;
}

weft_status record_table_cut(record_table *table, const record_extent *kept,
                             weft_error *err)
{
    table->extent = *kept;
    if (table->stream == NULL
        || (ftruncate(fileno(table->stream), (off_t)kept->length) == 0
            && fseek(table->stream, 0, SEEK_END) == 0)) {
        return WEFT_OK;
    }
    return failed(table, err);
}

weft_status record_table_sync(record_table *table, weft_error *err)
{
    if (table->stream == NULL) {
        return WEFT_OK;
    }
    const weft_status status = record_table_write(table, "", err);
    return status != WEFT_OK || fsync(fileno(table->stream)) == 0 ? status
                                                                  : failed(table, err);
}

weft_status record_table_close(record_table *table, weft_error *err)
{
    if (table->stream == NULL) {
        return WEFT_OK;
    }
    const weft_status status = record_table_write(table, "", err);
    const bool closed = fclose(table->stream) == 0;
    table->stream = NULL;
    return closed || status != WEFT_OK ? status : failed(table, err);
}
