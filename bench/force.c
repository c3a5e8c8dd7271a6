/* SPDX-License-Identifier: BSD-3-Clause */
/* force.c -- one evaluation of the forces of P(n), on every level of instructions that
 * this machine has: nanoseconds a spring, against the spring list of a lecture compiled
 * for the same level, and against what root and division alone take there; and one
 * product with the Jacobian. One thread is measured by its own time, two by the clock
 * on the wall. Lines on stdout, and a table in BUILD_DIR/bench/force-MACHINE.csv. */
#include "bench.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "levels/levels.h"
#include "problem.h"
#include "sim/forces.h"

enum { BOUND = 512, ROUNDS = 21, THREADS = 2 };

static const size_t sizes[] = { 32, 100, 300, 1000, 2000 };

#define NAIVE(level) naive_##level,
#define ROOTS(level) bound_##level,
static naive_fn *const naives[] = { WEFT_LEVELS(NAIVE) };
static bound_fn *const bounds[] = { WEFT_LEVELS(ROOTS) };

/* What is measured, at one size on one level. */
typedef struct subject {
    size_t level, springs, calls; /* of a sample */
    naive_cloth list;
    weft__forces forces[THREADS];
    double *y, *dydt, *along, *list_y, *list_dydt;
    double numbers[BOUND], roots[BOUND];
} subject;

static double clock_of(clockid_t id) /* [s] */
{
    struct timespec t;
    clock_gettime(id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void run_product(subject *at, size_t threads)
{
    (void)threads;
    (void)weft_cloth_jacobian_product(at->forces[0].cloth, 0.0, at->y, at->along,
                                      at->dydt);
}

static void run_list(subject *at, size_t threads)
{
    (void)threads;
    naives[at->level](&at->list, at->list_y, at->list_dydt);
}

static void run_forces(subject *at, size_t threads)
{
    (void)weft__forces_rhs(&at->forces[threads - 1], 0.0, at->y, at->dydt);
}

/* Some 100 ns. */
static void run_bound(subject *at, size_t threads)
{
    (void)threads;
    bounds[at->level](at->numbers, at->roots, BOUND);
    __asm__ volatile("" ::: "memory");
}

typedef struct figure {
    void (*run)(subject *at, size_t threads);
    size_t threads, calls;
    double each;  /* springs, or numbers */
    double value; /* [ns], the median */
} figure;

static double sample(const figure *of, subject *at) /* [ns] */
{
    const clockid_t id = of->threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    const double start = clock_of(id);
    for (size_t i = 0; i < of->calls; ++i) {
        of->run(at, of->threads);
    }
    return 1e9 * (clock_of(id) - start) / ((double)of->calls * of->each);
}

static void measure(figure *figures, size_t count, subject *at)
{
    static double values[8][ROUNDS];
    const size_t rounds = at->springs > 1000000 ? 5 : ROUNDS;
    for (size_t r = 0; r <= rounds; ++r) { /* the first warms up */
        for (size_t i = 0; i < count; ++i) {
            values[i][r > 0 ? r - 1 : 0] = sample(&figures[i], at);
        }
    }
    for (size_t i = 0; i < count; ++i) {
        figures[i].value = bench_median(values[i], rounds);
    }
}

static void report(FILE *csv, size_t n, const subject *at, const figure *figures)
{
    const char *level = weft__isa_name((weft__isa)(at->level + 1));
    const double list = figures[0].value, bound = figures[1].value;
    const double product = figures[2 + THREADS].value;
    printf("jacobian %zux%zu: %.2f ns/spring, %.2f force evaluations (%s)\n", n, n,
           product, product / figures[2].value, level);
    for (size_t threads = 1; threads <= THREADS; ++threads) {
        const double ns = figures[1 + threads].value;
        printf("force %zux%zu threads=%zu: %.2f ns/spring, naive %.2f, ratio %.1f, "
               "bound %.2f (%s, %.3g springs/s)\n",
               n, n, threads, ns, list, list / ns, bound, level, 1e9 / ns);
        fflush(stdout);
        if (csv != NULL) {
            fprintf(csv, "%s,%zu,%zu,%zu,%.4f,%.4f,%.4f,%.4g,%.4f\n", level, n,
                    at->springs, threads, ns, list, bound, 1e9 / ns, product);
        }
    }
}

static void *numbers(size_t count)
{
    double *y = malloc(count * sizeof *y);
    if (y == NULL) {
        fprintf(stderr, "no memory\n");
        exit(1);
    }
    return y;
}

/* Strained a little, in motion, everywhere different. */
static void disturb(double *y, size_t n, double spacing)
{
    for (size_t j = 0; j < 6 * n; ++j) {
        y[j] += 0.1 * spacing * sin(1.7 * (double)(j % 1009) + (double)(j / n));
    }
}

static void level(FILE *csv, size_t n, subject *at)
{
    const size_t calls = 1 + 200000 / at->springs;
    const double springs = (double)at->springs;
    figure figures[3 + THREADS]
        = { { run_list, 1, calls, springs, 0.0 }, { run_bound, 1, 400, BOUND, 0.0 } };
    for (size_t threads = 1; threads <= THREADS; ++threads) {
        figures[1 + threads] = (figure){ run_forces, threads, calls, springs, 0.0 };
    }
    figures[2 + THREADS] = (figure){ run_product, 1, calls, springs, 0.0 };
    measure(figures, 3 + THREADS, at);
    report(csv, n, at, figures);
}

static void size(FILE *csv, size_t n)
{
    weft_error err;
    weft_cloth *cloth;
    const weft_cloth_def def = problem(n);
    static subject at;
    if (weft_cloth_create(&def, &cloth, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        exit(1);
    }
    const size_t dim = weft_cloth_dim(cloth);
    at.y = numbers(dim), at.dydt = numbers(dim), at.along = numbers(dim);
    at.list_y = numbers(dim), at.list_dydt = numbers(dim);
    weft_cloth_start(cloth, at.y);
    disturb(at.y, n * n, def.spacing[0]);
    memcpy(at.along, at.y, dim * sizeof *at.along);
    naive_state(n * n, at.y, at.list_y);
    at.list = naive_create(&def, cloth);
    at.springs = at.list.count;
    for (size_t i = 0; i < BOUND; ++i) {
        at.numbers[i] = 1.0 + (double)i / BOUND;
    }
    for (size_t i = 0; i < THREADS; ++i) {
        at.forces[i] = weft__forces_create(cloth, i + 1, NULL);
    }
    for (at.level = 0; at.level < (size_t)weft__isa_last(); ++at.level) {
        weft__cloth_choose(cloth, (weft__isa)(at.level + 1));
        level(csv, n, &at);
    }
    for (size_t i = 0; i < THREADS; ++i) {
        weft__forces_destroy(&at.forces[i]);
    }
    naive_destroy(&at.list);
    free(at.y), free(at.dydt), free(at.along), free(at.list_y), free(at.list_dydt);
    weft_cloth_destroy(cloth);
}

int main(void)
{
    char machine[64] = "machine", path[256];
    (void)gethostname(machine, sizeof machine - 1);
    (void)snprintf(path, sizeof path, BUILD_DIR "/bench/force-%s.csv", machine);
    FILE *csv = fopen(path, "w");
    if (csv != NULL) {
        fprintf(csv, "level,n,springs,threads,ns_per_spring,naive_ns,bound_ns,"
                     "springs_per_s,jacobian_ns\n");
    }
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        size(csv, sizes[i]);
    }
    return csv != NULL && fclose(csv) != 0;
}
