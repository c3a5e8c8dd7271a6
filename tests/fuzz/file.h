/* SPDX-License-Identifier: BSD-3-Clause */
/* file.h -- files for the targets whose bytes are read from some. */
#pragma once

#include <stdio.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

static char fuzz_directory[256], fuzz_path[8][512];

static inline void fuzz_clean(void)
{
    for (size_t i = 0; i < sizeof fuzz_path / sizeof *fuzz_path; ++i) {
        (void)unlink(fuzz_path[i]);
    }
    (void)rmdir(fuzz_directory);
}

/* `name` in fuzz_directory, which is made; of at most eight names. */
static inline const char *fuzz_file(const char *name)
{
    const char *under = getenv("TMPDIR");
    char path[512];
    if (fuzz_directory[0] == '\0') {
        (void)snprintf(fuzz_directory, sizeof fuzz_directory, "%s/weft-fuzz-XXXXXX",
                       under == NULL ? "/tmp" : under);
        HOLDS(mkdtemp(fuzz_directory) != NULL);
        HOLDS(atexit(fuzz_clean) == 0);
    }
    (void)snprintf(path, sizeof path, "%s/%s", fuzz_directory, name);
    size_t i = 0;
    while (fuzz_path[i][0] != '\0' && strcmp(fuzz_path[i], path) != 0) {
        ++i;
        HOLDS(i < sizeof fuzz_path / sizeof *fuzz_path);
    }
    strcpy(fuzz_path[i], path);
    return fuzz_path[i];
}

static inline void fuzz_write(const char *name, const uint8_t *data, size_t size)
{
    FILE *stream = fopen(fuzz_file(name), "w");
    HOLDS(stream != NULL && (size == 0 || fwrite(data, 1, size, stream) == size));
    HOLDS(fclose(stream) == 0);
}
