/* SPDX-License-Identifier: BSD-3-Clause */
/* file.h -- a file for the targets whose bytes are read from one. */
#pragma once

#include <stdio.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

static char fuzz_directory[256], fuzz_path[512];

static inline void fuzz_clean(void)
{
    (void)unlink(fuzz_path);
    (void)rmdir(fuzz_directory);
}

/* `name` in fuzz_directory, which is made. */
static inline const char *fuzz_file(const char *name)
{
    const char *under = getenv("TMPDIR");
    if (fuzz_path[0] == '\0') {
        (void)snprintf(fuzz_directory, sizeof fuzz_directory, "%s/weft-fuzz-XXXXXX",
                       under == NULL ? "/tmp" : under);
        HOLDS(mkdtemp(fuzz_directory) != NULL);
        (void)snprintf(fuzz_path, sizeof fuzz_path, "%s/%s", fuzz_directory, name);
        HOLDS(atexit(fuzz_clean) == 0);
    }
    return fuzz_path;
}

static inline void fuzz_write(const char *name, const uint8_t *data, size_t size)
{
    FILE *stream = fopen(fuzz_file(name), "w");
    HOLDS(stream != NULL && fwrite(data, 1, size, stream) == size);
    HOLDS(fclose(stream) == 0);
}
