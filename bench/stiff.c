/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff.c -- explicit, stabilised and implicit methods on stiff cloth: P(n), stiffness
 * times 1, 100 and 1000, with the same damping ratio, the same damping time or less
 * damping. Time, largest error [m] at the end, steps, linear systems; then the method
 * that weft check advises for an accuracy by the fastest one, and how the time grows
 * with n.
 *
 * stiff: n = 32, 64, 100 and 256, some half an hour; stiff 100: one size; stiff 100
 * 1000: times 1000 alone; stiff growth: the growth alone. Runs that would take more
 * than a minute are timed over a shorter window and marked *; they have no error. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <math.h>
#include <string.h>

#include "advice.h"
#include "problem.h"
#include "weft/weft.h"

#define LONGEST           60.0 /* [s] of a run */
#define LONGEST_REFERENCE 150.0
#define SHORT             3.0 /* [s] of its window; the steps of implicit ones grow at first */
#define OF_STABLE         0.9 /* of the stable step, for methods in fixed steps */

typedef struct task {
    weft_registry *registry;
    weft_cloth *cloth;
    size_t n;
    double stiffness, tau; /* times those of P(n) */
    double duration;       /* [s] */
    double *reference;     /* y at the end; NULL: not known */
    struct outcome *outcomes;
    size_t count;
    FILE *csv, *summary;
} task;

/* A line of the table. */
typedef struct entry {
    const char *plugin, *method;
    double tolerance;  /* [m]; 0: fixed steps */
    double velocities; /* [1/s] tolerance of velocities by that of positions */
    double fixed_step; /* [s]; 0: of the stable one */
} entry;

typedef struct outcome {
    entry it;
    double seconds, error; /* [m] NAN: not known */
} outcome;

static const entry entries[] = {
    { "arkode", "dormand_prince", 1e-3, 1.0, 0.0 },
    { "verlet", "velocity_verlet", 0.0, 1.0, 0.0 },
    { "stiff", "rkc2", 1e-2, 100.0, 0.0 },
    { "stiff", "rkc2", 1e-3, 100.0, 0.0 },
    { "stiff", "rkc2", 1e-4, 100.0, 0.0 },
    { "cvode", "bdf", 1e-2, 100.0, 0.0 },
    { "cvode", "bdf", 1e-3, 100.0, 0.0 },
    { "cvode", "bdf", 1e-4, 100.0, 0.0 },
    { "cvode", "bdf", 1e-5, 100.0, 0.0 },
    { "stiff", "ros2", 1e-3, 1000.0, 0.0 },
    { "stiff", "ros2", 1e-4, 1000.0, 0.0 },
    { "arkode", "trbdf2", 1e-3, 1000.0, 0.0 },
    { "stiff", "backward_euler", 0.0, 1.0, 1e-3 },
};

enum { ENTRIES = sizeof entries / sizeof entries[0], ADVISED = 3 };

static weft_cloth_def sheet(const task *of)
{
    weft_cloth_def def = problem(of->n);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f].stiffness *= of->stiffness;
        def.springs[f].damping *= of->stiffness * of->tau;
    }
    return def;
}

static weft_cloth *make_sheet(const task *of)
{
    const weft_cloth_def def = sheet(of);
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
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

/* [s] The time of a whole run; of a window of it if that would exceed `longest`, which
 * *shorter reports. < 0: it failed. */
static double time_run(weft_sim *sim, double duration, double longest, double window,
                       bool *shorter, weft_error *err)
{
    const double began = bench_now();
    double spent = 0.0;
    *shorter = false;
    while (weft_sim_time(sim) < duration) {
        if (weft_sim_step(sim, duration, err) != WEFT_OK) {
            return -1.0;
        }
        spent = bench_now() - began;
        if (spent > window && spent / weft_sim_time(sim) * duration > longest) {
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

/* y at the end with one method; NULL: it would take too long. */
static double *try_reference(const task *of, const entry *tight)
{
    const size_t bytes = weft_cloth_dim(of->cloth) * sizeof(double);
    weft_error err = { 0 };
    bool shorter = false;
    double *y = NULL;
    weft_sim *sim = make_sim(of, tight, &err);
    if (sim != NULL
        && time_run(sim, of->duration, LONGEST_REFERENCE, SHORT, &shorter, &err) > 0.0
        && !shorter) {
        y = malloc(bytes);
        if (y == NULL) {
            abort();
        }
        memcpy(y, weft_sim_state(sim), bytes);
    }
    weft_sim_destroy(sim);
    return y;
}

/* Where explicit steps are too short, rkc2, good to some 1e-5 m. */
static void make_reference(task *of)
{
    static const entry tight[] = { { "arkode", "dormand_prince", 1e-8, 1.0, 0.0 },
                                   { "stiff", "rkc2", 1e-6, 100.0, 0.0 } };
    free(of->reference);
    of->reference = NULL;
    for (size_t i = 0; i < 2 && of->reference == NULL; ++i) {
        of->reference = try_reference(of, &tight[i]);
    }
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

static bool is_implicit(const task *of, const entry *it)
{
    const weft_stepper_type *type = NULL;
    return weft_registry_method(of->registry, it->plugin, it->method, &type, NULL)
               == WEFT_OK
           && (type->flags & WEFT_STEPPER_IMPLICIT) != 0;
}

static void run(task *of, const entry *it)
{
    weft_error err = { 0 };
    bool shorter = false;
    weft_sim *sim = make_sim(of, it, &err);
    const double seconds
        = sim == NULL ? -1.0
                      : time_run(sim, of->duration, LONGEST,
                                 is_implicit(of, it) ? LONGEST : SHORT, &shorter, &err);
    if (seconds < 0.0) {
        printf("  %-6s %-16s %7.0e %.90s\n", it->plugin, it->method, it->tolerance,
               err.message);
    } else {
        const bool known = of->reference != NULL && !shorter;
        report(of, it, sim, seconds, shorter);
        of->outcomes[of->count++]
            = (outcome){ *it, seconds, known ? error_of(of, sim) : NAN };
    }
    weft_sim_destroy(sim);
}

/* ---- the advice of weft check ------------------------------------------------- */

static void write_scene(const task *of, const char *path)
{
    static const char *const families[WEFT_FAMILIES] = { "stretch", "shear", "bend" };
    const weft_cloth_def def = sheet(of);
    FILE *to = fopen(path, "w");
    if (to == NULL) {
        perror(path);
        exit(1);
    }
    fprintf(to,
            "weft: 1\ncloth:\n  grid: {rows: %zu, cols: %zu, spacing: %.17g, "
            "down: [0, 0, 1]}\n  mass: %.17g\n  pins: [top-left, top-right]\n"
            "  springs:\n",
            of->n, of->n, def.spacing[0], def.mass);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        fprintf(to, "    %s: {stiffness: %.17g, damping: %.17g}\n", families[f],
                def.springs[f].stiffness, def.springs[f].damping);
    }
    fprintf(to,
            "stepper: {plugin: arkode, method: dormand_prince, rtol: 0.0, atol: 1e-3}\n"
            "run: {duration: %g}\n",
            of->duration);
    if (fclose(to) != 0) {
        perror(path);
        exit(1);
    }
}

static bool same_method(const entry *a, const char *plugin, const char *method)
{
    return strcmp(a->plugin, plugin) == 0 && strcmp(a->method, method) == 0;
}

/* In fixed steps, the stable one and below, what the table has not. */
static void run_advised(task *of, const advice *by)
{
    const weft_stepper_type *type = NULL;
    const entry *ran = NULL;
    for (size_t i = 0; i < ENTRIES; ++i) {
        ran = same_method(&entries[i], by->plugin, by->method) ? &entries[i] : ran;
    }
    if ((ran != NULL && ran->tolerance > 0.0)
        || weft_registry_method(of->registry, by->plugin, by->method, &type, NULL)
               != WEFT_OK) {
        return;
    }
    const double h = OF_STABLE * stable_step(of, type);
    for (int k = ran != NULL; k < ADVISED; ++k) {
        run(of, &(entry){ by->plugin, by->method, 0.0, 1.0, ldexp(h, -k) });
    }
}

/* [s] Between two settings, the coarser of them too coarse. */
static double interpolate(const outcome *coarse, const outcome *fine, double accuracy)
{
    const double part
        = log(accuracy / coarse->error) / log(fine->error / coarse->error);
    return coarse->seconds * pow(fine->seconds / coarse->seconds, part);
}

/* [s] of a method until its error is within the accuracy. Without a known error a run
 * is an explicit one in stable steps, whose errors are small. */
static double time_for(const task *of, const char *plugin, const char *method,
                       double accuracy)
{
    const outcome *last = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < of->count; ++i) {
        const outcome *one = &of->outcomes[i];
        if (!same_method(&one->it, plugin, method)) {
            continue;
        }
        const bool good = !(one->error > accuracy);
        const bool between = good && last != NULL && last->error > accuracy;
        const double seconds
            = between ? interpolate(last, one, accuracy) : one->seconds;
        least = good ? fmin(least, seconds) : least;
        last = one;
    }
    return least;
}

static void judge_at(const task *of, const advice *by, double zeta, size_t i)
{
    const double accuracy = advice_accuracies[i];
    const entry *fastest = NULL;
    const char *plugin, *method;
    double least = INFINITY;
    for (size_t k = 0; k < of->count; ++k) {
        const entry *it = &of->outcomes[k].it;
        const double seconds = time_for(of, it->plugin, it->method, accuracy);
        fastest = seconds < least ? it : fastest;
        least = fmin(least, seconds);
    }
    advice_for(by, i, &plugin, &method);
    if (fastest != NULL) {
        const double seconds = time_for(of, plugin, method, accuracy);
        fprintf(of->summary, "  P(%zu) x %-5g %6.2g %8.0e  %-22s %-22s %8.3g %8.2f\n",
                of->n, of->stiffness, zeta, accuracy, method, fastest->method, least,
                seconds / least);
    }
}

/* Measured gains over dormand_prince beside those that were estimated. */
static void judge_gains(const task *of, const advice *by)
{
    const double explicit = time_for(of, "arkode", "dormand_prince", 1e-2);
    printf("  weft check: gain of rkc2 %.3g", by->rkc2);
    printf(", measured %.3g", explicit / time_for(of, "stiff", "rkc2", 1e-3));
    for (size_t i = 0; i < ADVICE_ACCURACIES; ++i) {
        printf("; of bdf at %.0e m %.3g, measured %.3g", advice_accuracies[i],
               by->bdf[i],
               explicit / time_for(of, "cvode", "bdf", advice_accuracies[i]));
    }
    printf("\n");
}

static void compare(task *of)
{
    static const char scene[] = BUILD_DIR "/bench/stiff.yaml";
    outcome outcomes[ENTRIES + ADVISED];
    of->outcomes = outcomes;
    of->count = 0;
    of->cloth = make_sheet(of);
    const weft_stiffness modes = modes_of(of);
    const double zeta = 0.5 * modes.damping / sqrt(modes.omega2);
    printf("P(%zu) x %g, tau %.3g s, %g s: omega %.3g 1/s, zeta %.2g\n", of->n,
           of->stiffness, 5e-4 * of->tau, of->duration, sqrt(modes.omega2), zeta);
    make_reference(of);
    for (size_t i = 0; i < ENTRIES; ++i) {
        run(of, &entries[i]);
    }
    write_scene(of, scene);
    const advice by = advice_of(scene);
    run_advised(of, &by);
    for (size_t i = 0; of->reference != NULL && i < ADVICE_ACCURACIES; ++i) {
        judge_at(of, &by, zeta, i);
    }
    judge_gains(of, &by);
    weft_cloth_destroy(of->cloth);
}

/* Times 1, 100 and 1000 at the same damping ratio, 1000 at the same tau, and with
 * little and no damping. */
static void compare_size(task *of, size_t n, double only)
{
    static const double kinds[][2]
        = { { 1.0, 1.0 },    { 100.0, 0.1 }, { 1000.0, 0.0316227766 },
            { 1000.0, 1.0 }, { 1.0, 0.2 },   { 100.0, 0.0 } };
    for (size_t i = 0; i < (n < 200 ? 6 : 4); ++i) {
        of->n = n;
        of->stiffness = kinds[i][0];
        of->tau = kinds[i][1];
        of->duration = n < 64 && i < 3 ? 0.5 : n < 200 ? 0.25 : 0.1;
        if (only == 0.0 || only == of->stiffness) {
            compare(of);
        }
    }
}

/* ---- growth with n -------------------------------------------------------------- */

/* [s] The least of three: short runs are noisy. */
static double time_of(task *of, const entry *it)
{
    double least = INFINITY;
    for (int round = 0; round < 3; ++round) {
        weft_error err = { 0 };
        bool shorter = false;
        weft_sim *sim = make_sim(of, it, &err);
        if (sim == NULL) {
            return INFINITY;
        }
        least = fmin(least,
                     time_run(sim, of->duration, INFINITY, LONGEST, &shorter, &err));
        weft_sim_destroy(sim);
    }
    return least;
}

static void measure_growth(task *of)
{
    static const size_t sizes[] = { 64, 128, 256 };
    static const entry grown[] = { { "cvode", "bdf", 1e-3, 100.0, 0.0 },
                                   { "stiff", "ros2", 1e-3, 1000.0, 0.0 },
                                   { "stiff", "rkc2", 1e-3, 100.0, 0.0 } };
    for (size_t m = 0; m < sizeof grown / sizeof grown[0]; ++m) {
        double seconds[3];
        for (size_t i = 0; i < 3; ++i) {
            *of = (task){ .registry = of->registry,
                          .n = sizes[i],
                          .stiffness = 1.0,
                          .tau = 1.0,
                          .duration = 0.1,
                          .csv = of->csv,
                          .summary = of->summary };
            of->cloth = make_sheet(of);
            seconds[i] = time_of(of, &grown[m]);
            weft_cloth_destroy(of->cloth);
        }
        fprintf(of->summary,
                "growth of %s, 0.1 s of P(64), P(128), P(256) at %.0e m: %.3g, %.3g, "
                "%.3g s, "
                "like n^%.2f\n",
                grown[m].method, grown[m].tolerance, seconds[0], seconds[1], seconds[2],
                log(seconds[2] / seconds[0]) / log(4.0));
    }
}

int main(int argc, char **argv)
{
    static const size_t sizes[] = { 32, 64, 100, 256 };
    const char *only = argc > 1 ? argv[1] : "";
    const size_t size = (size_t)atoi(only);
    weft_registry_def def = weft_registry_def_default();
    weft_error err = { 0 };
    char *text = NULL;
    size_t length = 0;
    task of = { .csv = bench_csv("stiff", "n,stiffness,tau,plugin,method,tolerance,"
                                          "seconds,shorter_window,error_m,steps,"
                                          "rhs_calls,jacobians,iterations"),
                .summary = open_memstream(&text, &length) };
    if (of.summary == NULL) {
        abort();
    }
    def.path = BUILD_DIR "/plugins";
    bench_must(weft_registry_create(&def, &of.registry, &err), &err);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        if (size == sizes[i] || only[0] == '\0') {
            compare_size(&of, sizes[i], argc > 2 ? atof(argv[2]) : 0.0);
        }
    }
    free(of.reference);
    of.reference = NULL;
    if (size == 0) {
        measure_growth(&of);
    }
    if (fclose(of.summary) == 0) {
        printf("%-14s %6s %8s  %-22s %-22s %8s %8s\n%s", "cloth", "zeta", "error",
               "advised by weft check", "fastest", "s", "advised/fastest", text);
    }
    free(text);
    weft_registry_destroy(of.registry);
    return bench_csv_close(of.csv);
}
