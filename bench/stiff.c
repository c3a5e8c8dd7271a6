/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff.c -- explicit, stabilised and implicit methods on stiff cloth: P(n), stiffness
 * times 1, 100 and 1000, with the same damping ratio or the same damping time. Time,
 * largest error [m] at the end, steps, linear systems.
 *
 * stiff: n = 32, and 100 up to stiffness times 100, some three minutes; stiff all: all
 * of 32, 100 and 256; stiff 100: all of one size.
 * Explicit runs that would take more than a minute are timed over a shorter window and
 * marked *; there is then no reference, and no error. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <math.h>
#include <string.h>

#include "problem.h"
#include "weft/weft.h"

#define LONGEST   60.0 /* [s] of an explicit run */
#define SHORT     3.0  /* [s] of a window */
#define OF_STABLE 0.9  /* velocity_verlet's step */

typedef struct task {
    weft_registry *registry;
    weft_cloth *cloth;
    size_t n;
    double stiffness, tau; /* times those of P(n) */
    double duration;       /* [s] */
    double *reference;     /* y at the end; NULL: not known */
    FILE *csv;
} task;

/* A line of the table. */
typedef struct entry {
    const char *plugin, *method;
    double tolerance;  /* [m]; 0: fixed steps */
    double velocities; /* [1/s] tolerance of velocities by that of positions */
    double fixed_step; /* [s]; 0: of the stable one */
} entry;

static const entry entries[] = {
    { "arkode", "dormand_prince", 1e-3, 1.0, 0.0 },
    { "verlet", "velocity_verlet", 0.0, 1.0, 0.0 },
    { "stiff", "rkc2", 1e-2, 100.0, 0.0 },
    { "stiff", "rkc2", 1e-3, 100.0, 0.0 },
    { "stiff", "rkc2", 1e-4, 100.0, 0.0 },
    { "cvode", "bdf", 1e-2, 100.0, 0.0 },
    { "cvode", "bdf", 1e-3, 100.0, 0.0 },
    { "cvode", "bdf", 1e-4, 100.0, 0.0 },
    { "stiff", "ros2", 1e-3, 1000.0, 0.0 },
    { "stiff", "ros2", 1e-4, 1000.0, 0.0 },
    { "arkode", "trbdf2", 1e-3, 1000.0, 0.0 },
    { "stiff", "backward_euler", 0.0, 1.0, 1e-3 },
};

enum { ENTRIES = sizeof entries / sizeof entries[0] };

static void must(weft_status status, const weft_error *err)
{
    if (status != WEFT_OK) {
        fprintf(stderr, "stiff: %s\n", err->message);
        exit(1);
    }
}

static weft_cloth *make_sheet(const task *of)
{
    weft_cloth_def def = problem(of->n);
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f].stiffness *= of->stiffness;
        def.springs[f].damping *= of->stiffness * of->tau;
    }
    must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

static weft_stiffness modes_of(const task *of)
{
    double *y = calloc(weft_cloth_dim(of->cloth), sizeof *y);
    if (y == NULL) {
        abort();
    }
    weft_cloth_start(of->cloth, y);
    const weft_stiffness modes = weft_cloth_stiffness(of->cloth, 0.0, y);
    free(y);
    return modes;
}

/* [s] 0: none. */
static double stable_step(const task *of, const weft_stepper_type *type)
{
    const weft_stiffness modes = modes_of(of);
    weft_stability stability;
    double h = 0.0;
    return weft_stability_create(type, NULL, &stability, NULL) == WEFT_OK
                   && weft_stability_step(&stability, &modes, 0.0, &h, NULL) == WEFT_OK
               ? h
               : 0.0;
}

/* NULL: the method is not there, or refuses. */
static weft_sim *make_sim(const task *of, const entry *it, weft_error *err)
{
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    if (weft_registry_method(of->registry, it->plugin, it->method, &def.method, err)
        != WEFT_OK) {
        return NULL;
    }
    def.cloth = of->cloth;
    def.config.rtol = 0.0;
    def.config.atol_position = it->tolerance;
    def.config.atol_velocity = it->velocities * it->tolerance;
    def.config.first_step = 1e-5;
    if (it->tolerance == 0.0) {
        def.config.fixed_step = it->fixed_step > 0.0
                                    ? it->fixed_step
                                    : OF_STABLE * stable_step(of, def.method);
    }
    return weft_sim_create(&def, &sim, err) == WEFT_OK ? sim : NULL;
}

/* [s] The time of a whole run; of a window of it if that would exceed LONGEST, which
 * *shorter reports. < 0: it failed. */
static double time_run(weft_sim *sim, double duration, bool *shorter, weft_error *err)
{
    const double began = bench_now();
    double spent = 0.0;
    *shorter = false;
    while (weft_sim_time(sim) < duration) {
        if (weft_sim_step(sim, duration, err) != WEFT_OK) {
            return -1.0;
        }
        spent = bench_now() - began;
        if (spent > SHORT && spent / weft_sim_time(sim) * duration > LONGEST) {
            *shorter = true;
            return spent / weft_sim_time(sim) * duration;
        }
    }
    return spent;
}

static double error_of(const task *of, const weft_sim *sim) /* [m] */
{
    const size_t half = weft_cloth_dim(of->cloth) / 2;
    const double *y = weft_sim_state(sim);
    double most = 0.0;
    for (size_t i = 0; i < half; ++i) {
        most = fmax(most, fabs(y[i] - of->reference[i]));
    }
    return most;
}

/* Dormand and Prince's method at 1e-8; none if it would take too long. */
static void make_reference(task *of)
{
    const entry tight = { "arkode", "dormand_prince", 1e-8, 1.0, 0.0 };
    const size_t bytes = weft_cloth_dim(of->cloth) * sizeof(double);
    weft_error err = { 0 };
    bool shorter = false;
    weft_sim *sim = make_sim(of, &tight, &err);
    free(of->reference);
    of->reference = NULL;
    if (sim != NULL && time_run(sim, of->duration, &shorter, &err) > 0.0 && !shorter) {
        of->reference = malloc(bytes);
        if (of->reference == NULL) {
            abort();
        }
        memcpy(of->reference, weft_sim_state(sim), bytes);
    }
    weft_sim_destroy(sim);
}

static void report(const task *of, const entry *it, const weft_sim *sim, double seconds,
                   bool shorter)
{
    const weft_stepper_stats stats = weft_sim_stats(sim);
    char error[16] = "-";
    if (of->reference != NULL && !shorter) {
        (void)snprintf(error, sizeof error, "%.1e", error_of(of, sim));
    }
    printf("  %-6s %-16s %7.0e %9.3g s%c %8s m %8llu steps %8llu calls %6llu Jacobians "
           "%7llu iterations\n",
           it->plugin, it->method, it->tolerance, seconds, shorter ? '*' : ' ', error,
           (unsigned long long)stats.steps, (unsigned long long)stats.rhs_calls,
           (unsigned long long)stats.factorisations,
           (unsigned long long)stats.linear_iterations);
    fprintf(of->csv, "%zu,%g,%g,%s,%s,%g,%.6g,%d,%s,%llu,%llu,%llu,%llu\n", of->n,
            of->stiffness, of->tau, it->plugin, it->method, it->tolerance, seconds,
            shorter, error[0] == '-' ? "" : error, (unsigned long long)stats.steps,
            (unsigned long long)stats.rhs_calls,
            (unsigned long long)stats.factorisations,
            (unsigned long long)stats.linear_iterations);
    fflush(stdout);
}

static void run(const task *of, const entry *it)
{
    weft_error err = { 0 };
    bool shorter = false;
    weft_sim *sim = make_sim(of, it, &err);
    const double seconds
        = sim == NULL ? -1.0 : time_run(sim, of->duration, &shorter, &err);
    if (seconds < 0.0) {
        printf("  %-6s %-16s %7.0e %.90s\n", it->plugin, it->method, it->tolerance,
               err.message);
    } else {
        report(of, it, sim, seconds, shorter);
    }
    weft_sim_destroy(sim);
}

static void compare(task *of)
{
    of->cloth = make_sheet(of);
    const weft_stiffness modes = modes_of(of);
    printf("P(%zu) x %g, tau %.3g s, %g s: omega %.3g 1/s, zeta %.2g\n", of->n,
           of->stiffness, 5e-4 * of->tau, of->duration, sqrt(modes.omega2),
           0.5 * modes.damping / sqrt(modes.omega2));
    make_reference(of);
    for (size_t i = 0; i < ENTRIES; ++i) {
        run(of, &entries[i]);
    }
    weft_cloth_destroy(of->cloth);
}

/* Times 1, 100 and 1000 at the same damping ratio, and 1000 at the same tau. */
static void compare_size(task *of, size_t n, bool all)
{
    static const double kinds[][2]
        = { { 1.0, 1.0 }, { 100.0, 0.1 }, { 1000.0, 0.0316227766 }, { 1000.0, 1.0 } };
    for (size_t i = 0; i < (all || n < 64 ? 4 : 2); ++i) {
        of->n = n;
        of->stiffness = kinds[i][0];
        of->tau = kinds[i][1];
        of->duration = n < 64 && i < 3 ? 0.5 : n < 200 ? 0.25 : 0.1;
        compare(of);
    }
}

int main(int argc, char **argv)
{
    static const size_t sizes[] = { 32, 100, 256 };
    const char *only = argc > 1 ? argv[1] : "";
    const size_t size = (size_t)atoi(only);
    const bool all = strcmp(only, "all") == 0;
    weft_registry_def def = weft_registry_def_default();
    weft_error err = { 0 };
    task of = { .csv = bench_csv("stiff", "n,stiffness,tau,plugin,method,tolerance,"
                                          "seconds,shorter_window,error_m,steps,"
                                          "rhs_calls,jacobians,iterations") };
    def.path = BUILD_DIR "/plugins";
    must(weft_registry_create(&def, &of.registry, &err), &err);
    for (size_t i = 0; i < 3; ++i) {
        if (size == sizes[i] || all || (size == 0 && sizes[i] < 256)) {
            compare_size(&of, sizes[i], all || size > 0);
        }
    }
    free(of.reference);
    weft_registry_destroy(of.registry);
    return bench_csv_close(of.csv);
}
