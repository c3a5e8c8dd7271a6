/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.h -- run.vtkhdf as it is read, for the targets that make one up.
 *
 * A child process reads it first, where libFuzzer sees no coverage. So the linker wraps
 * fork and waitpid: there is no child, and it has lived. What libhdf5 crashes on ends
 * the target then. With WEFT_FUZZ_CHILD set there is one, as in the program. */
#pragma once

#include <math.h>
#include <sys/types.h>

#include "fuzz/file.h"
#include "program/record/frames.h"

pid_t __real_fork(void);
pid_t __wrap_fork(void);
pid_t __real_waitpid(pid_t pid, int *status, int options);
pid_t __wrap_waitpid(pid_t pid, int *status, int options);

pid_t __wrap_fork(void)
{
    return getenv("WEFT_FUZZ_CHILD") != NULL ? __real_fork() : 1;
}

pid_t __wrap_waitpid(pid_t pid, int *status, int options)
{
    *status = 0;
    return getenv("WEFT_FUZZ_CHILD") != NULL ? __real_waitpid(pid, status, options)
                                             : pid;
}

static inline void frames_read(record_frames *frames)
{
    const size_t n = frames->faces.particles;
    double *xyz = calloc(3 * n, sizeof *xyz);
    HOLDS(xyz != NULL);
    for (size_t i = 0; i < frames->count && i < 10; ++i) {
        HOLDS(isfinite(frames->times[i]));
        if (record_frames_positions(frames, i, xyz, NULL) == WEFT_OK) {
            HOLDS(isfinite(xyz[0]) && isfinite(xyz[3 * n - 1]));
        }
        (void)record_frames_field(frames, WEFT_RECORD_VELOCITY, i, xyz, NULL);
        (void)record_frames_field(frames, WEFT_RECORD_STRAIN, i, xyz, NULL);
    }
    for (size_t k = 0; k < n; ++k) {
        (void)(frames->pinned != NULL && frames->pinned[k] != 0);
        HOLDS(isfinite(frames->rest[3 * k]));
    }
    free(xyz);
}

/* Refused with a reason, or read. */
static inline void frames_check(void)
{
    record_frames *frames = NULL;
    weft_error err = { 0 };
    if (record_frames_open(fuzz_directory, &frames, &err) == WEFT_OK) {
        frames_read(frames);
    } else {
        HOLDS(frames == NULL && err.message[0] != '\0');
    }
    record_frames_close(frames);
}
