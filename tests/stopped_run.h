/* SPDX-License-Identifier: BSD-3-Clause */
/* stopped_run.h -- runs in OUT that are stopped midway, and the undisturbed one. */
#pragma once

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "program/record/checkpoint.h"
#include "run_frames.h"

/* A checkpoint every ten of many frames. */
static const char scene[]
    = "weft: 1\n"
      "name: killed\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}\n"
      "  density: 0.3\n"
      "  springs:\n"
      "    stretch: {stiffness: 50, damping: 0.01}\n"
      "    shear: {stiffness: 20}\n"
      "  pins: [top-left, {at: top-right, velocity: [0.1, 0, 0]}]\n"
      "forces: {wind: {velocity: [0, 0, 2], drag: 0.2}}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 2.0e-3}\n"
      "run: {duration: 0.6, fps: 200, checkpoint: 10}\n";

static inline void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/s.yaml", scene);
}

/* ---- a run that is stopped ----------------------------------------------------- */

static inline pid_t start(const char *format, const char *sets)
{
    char command[1024];
    (void)snprintf(command, sizeof command, format, sets);
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        (void)execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    return child;
}

static inline void sleep_for(uint64_t microseconds)
{
    const struct timespec t = { .tv_nsec = (long)(1000 * microseconds) };
    (void)nanosleep(&t, NULL);
}

/* Until there is a checkpoint, or the run is over. */
static inline void wait_for_checkpoint(const char *directory)
{
    char checkpoint[256], result[256];
    (void)snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.weft", directory);
    (void)snprintf(result, sizeof result, "%s/result.yaml", directory);
    while (!exists(checkpoint) && !exists(result)) {
        sleep_for(200);
    }
}

static inline void stop(pid_t child, int number)
{
    int status;
    (void)kill(child, number);
    ck_assert_int_eq(waitpid(child, &status, 0), child);
}

#define RUN(name) "exec " WEFT " run " OUT "/s.yaml --out " OUT "/" name " --quiet %s"

/* OUT/k is a run that was stopped behind its first checkpoint and before its end. */
static inline void stop_midway(int number, const char *sets)
{
    bool ended;
    do {
        (void)shell("rm -rf " OUT "/k");
        const pid_t child = start(RUN("k"), sets);
        wait_for_checkpoint(OUT "/k");
        stop(child, number);
        ended = shell("grep -q 'status: done' " OUT "/k/result.yaml 2>&1") == 0;
    } while (ended);
}

static inline void same_file(const char *name)
{
    expect(shell("cmp " OUT "/ref/%s " OUT "/k/%s 2>&1", name, name), 0);
}

/* All of it, but for the wall time. */
static inline void ends_as_reference(void)
{
    expect(shell("diff -r -I wall_time: " OUT "/ref " OUT "/k 2>&1"), 0);
    ck_assert(!exists(OUT "/k/checkpoint.weft"));
}

static inline void make_reference(const char *sets)
{
    expect(shell("rm -rf " OUT "/ref; " WEFT " run " OUT "/s.yaml --out " OUT
                 "/ref --quiet %s 2>&1",
                 sets),
           0);
}
