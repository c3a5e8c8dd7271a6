/* SPDX-License-Identifier: BSD-3-Clause */
/* run_frames.h -- shared by the tests of run.vtkhdf. */
#pragma once

#include "program/record/frames.h"
#include "shell.h"

static inline record_frames *open_frames(const char *directory)
{
    record_frames *frames = NULL;
    weft_error err;
    ck_assert_msg(record_frames_open(directory, &frames, &err) == WEFT_OK, "%s",
                  err.message);
    return frames;
}

static inline uint64_t random_word(uint64_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}
