/* SPDX-License-Identifier: BSD-3-Clause */
/* bench.h -- what benchmarks share: time, and medians of interleaved runs. They print
 * what they measure and judge nothing: machines are shared and noisy. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "weft/base.h"

/* What runs on one thread may be measured by its own time, whoever else is at work. */
#ifndef BENCH_CLOCK
#define BENCH_CLOCK CLOCK_MONOTONIC
#endif

typedef void bench_fn(void *ctx);

typedef struct bench_case {
    const char *name;
    bench_fn *run;
    void *ctx;
    double median; /* [s] of one run, out */
} bench_case;

enum { BENCH_ROUNDS_MAX = 101 };

static inline double bench_now(void) /* [s] */
{
    struct timespec t;
    clock_gettime(BENCH_CLOCK, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline int bench_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline double bench_median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, bench_compare);
    return values[count / 2];
}

/* Case after case, round after round, so that all meet the same noise; the first round
 * warms up and is not counted. rounds <= BENCH_ROUNDS_MAX. */
static inline void bench_interleaved(bench_case *cases, size_t count, size_t rounds)
{
    double *times = malloc(count * rounds * sizeof *times);
    if (times == NULL) {
        abort();
    }
    for (size_t r = 0; r <= rounds; ++r) {
        for (size_t i = 0; i < count; ++i) {
            const double start = bench_now();
            cases[i].run(cases[i].ctx);
            if (r > 0) {
                times[i * rounds + r - 1] = bench_now() - start;
            }
        }
    }
    for (size_t i = 0; i < count; ++i) {
        cases[i].median = bench_median(times + i * rounds, rounds);
    }
    free(times);
}

/* Ends the benchmark with the message of a call that failed. */
static inline void bench_must(weft_status status, const weft_error *err)
{
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err->message);
        exit(1);
    }
}

/* BUILD_DIR/bench/<name>-<machine>.csv with its header line, for figures of a kind. */
static inline FILE *bench_csv(const char *name, const char *header)
{
    char machine[64] = "machine", path[256];
    (void)gethostname(machine, sizeof machine - 1);
    (void)snprintf(path, sizeof path, "%s/bench/%s-%s.csv", BUILD_DIR, name, machine);
    FILE *csv = fopen(path, "w");
    if (csv == NULL) {
        perror(path);
        exit(1);
    }
    fprintf(csv, "%s\n", header);
    return csv;
}

static inline int bench_csv_close(FILE *csv) /* the exit status */
{
    return fclose(csv) == 0 ? 0 : 1;
}
