/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_sweeps.h -- sweeps of the small scene, written to OUT. */
#pragma once

#include <unistd.h>

#include "shell.h"

#define BATCH WEFT " batch " OUT

/* 1e9 steps: longer than any test, with checkpoints. */
static const char long_run[] = "run: {duration: 1.0e+5, fps: 20, checkpoint: 3}\n";

static inline void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
}

static inline void write_sweep(const char *name, const char *run, const char *sweep)
{
    char text[4096], path[256];
    const size_t head = (size_t)(strstr(small_scene, "run:") - small_scene);
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)head, small_scene, run, sweep);
    (void)snprintf(path, sizeof path, OUT "/%s", name);
    write_file(path, text);
}

static const char short_run[] = "run: {duration: 0.1, fps: 20}\n";
static const char six[] = "sweep:\n  stepper.fixed_step: [1.0e-3, 5.0e-4]\n"
                          "  cloth.springs.stretch.stiffness: [10, 20, 30]\n";

/* The summary without its last column, the wall time. */
static inline void expect_same_summaries(const char *a, const char *b)
{
    expect(shell("sed 's/,[^,]*$//' %s/summary.csv > " OUT "/a.csv; "
                 "sed 's/,[^,]*$//' %s/summary.csv > " OUT "/b.csv; "
                 "diff " OUT "/a.csv " OUT "/b.csv",
                 a, b),
           0);
}
