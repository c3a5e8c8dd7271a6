/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.c -- any bytes as run.vtkhdf: refused, or frames that are finite. libhdf5
 * crashes on some; that happens in a child that record_frames_open makes for it. */
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "fuzz/fuzz.h"
#include "record/frames.h"

static char directory[64], file[96];

static void clean(void)
{
    (void)unlink(file);
    (void)rmdir(directory);
}

static void make_directory(void)
{
    strcpy(directory, "/tmp/weft-fuzz-XXXXXX");
    HOLDS(mkdtemp(directory) != NULL);
    (void)snprintf(file, sizeof file, "%s/run.vtkhdf", directory);
    HOLDS(atexit(clean) == 0);
}

static void write_file(const uint8_t *data, size_t size)
{
    FILE *stream = fopen(file, "w");
    HOLDS(stream != NULL);
    HOLDS(fwrite(data, 1, size, stream) == size);
    HOLDS(fclose(stream) == 0);
}

static void read_all(record_frames *frames)
{
    const size_t n = record_frames_rows(frames) * record_frames_cols(frames);
    double *xyz = calloc(3 * n, sizeof *xyz);
    HOLDS(xyz != NULL);
    for (size_t i = 0; i < record_frames_count(frames) && i < 10; ++i) {
        HOLDS(isfinite(record_frames_time(frames, i)));
        if (record_frames_positions(frames, i, xyz, NULL) == WEFT_OK) {
            HOLDS(isfinite(xyz[0]) && isfinite(xyz[3 * n - 1]));
        }
        (void)record_frames_velocities(frames, i, xyz, NULL);
        (void)record_frames_strain(frames, i, xyz, NULL);
    }
    for (size_t k = 0; k < n; ++k) {
        (void)record_frames_pinned(frames, k);
        HOLDS(isfinite(record_frames_rest(frames)[3 * k]));
    }
    free(xyz);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    record_frames *frames = NULL;
    weft_error err = { 0 };
    if (directory[0] == '\0') {
        make_directory();
    }
    write_file(data, size);
    if (record_frames_open(directory, &frames, &err) == WEFT_OK) {
        read_all(frames);
    } else {
        HOLDS(frames == NULL && err.message[0] != '\0');
    }
    record_frames_close(frames);
    return 0;
}
