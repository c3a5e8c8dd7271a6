/* SPDX-License-Identifier: BSD-3-Clause */
/* steps.c -- whole runs, against the lecture's way (lecture.h) at equal tolerance: the
 * sheets P(32) and P(100), four scenes under eight steppers, each with its largest
 * error [m] at the end against a solution of far smaller tolerance. growth.c measures
 * how a step grows with the sheet. */
#include "bench.h"

#include "weft/weft.h"

#include <stdio.h>
#include <string.h>

#if defined(HAVE_GSL) && defined(HAVE_ARKODE)

#include "lecture.h"
#include "problem.h"

const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);
const weft_plugin *weft_plugin_verlet(void);

#define TOLERANCE  1e-6
#define FIRST_STEP 1e-5 /* [s] */
#define OF_STABLE  0.9  /* fixed steps, of the largest stable one */

/* A cloth for a while, and where it is then. */
typedef struct task {
    char name[64];
    weft_cloth *cloth;
    double duration;   /* [s] */
    double *reference; /* y at the end */
} task;

/* One of the runs that are compared. */
typedef struct trial {
    const task *of;
    const weft_plugin *plugin; /* NULL: the lecture's way */
    const char *method;
    size_t threads;
    double tolerance;
    double fixed_step; /* [s]; 0: adaptive */
    weft_sim *sim;
    lecture lecture;
} trial;

static weft_cloth *make_sheet(size_t n)
{
    const weft_cloth_def def = problem(n);
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

static void run_lecture(trial *self)
{
    lecture_destroy(&self->lecture);
    lecture_create(&self->lecture, self->of->cloth);
    lecture_run(&self->lecture, self->tolerance, FIRST_STEP, self->of->duration);
}

static void start(trial *self)
{
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = self->of->cloth;
    def.method = weft_plugin_method(self->plugin, self->method);
    def.config.rtol = 0.0;
    def.config.atol_position = def.config.atol_velocity = self->tolerance;
    def.config.first_step = FIRST_STEP;
    def.config.fixed_step = self->fixed_step;
    def.config.threads = self->threads;
    weft_sim_destroy(self->sim);
    bench_must(weft_sim_create(&def, &self->sim, &err), &err);
}

static void run(void *ctx)
{
    trial *self = ctx;
    weft_error err = { 0 };
    if (self->plugin == NULL) {
        run_lecture(self);
        return;
    }
    start(self);
    bench_must(weft_sim_advance(self->sim, self->of->duration, &err), &err);
}

static void end(trial *self)
{
    weft_sim_destroy(self->sim);
    lecture_destroy(&self->lecture);
}

static double error(const trial *self) /* [m] */
{
    const size_t n = weft_cloth_particles(self->of->cloth);
    const double *ours = self->plugin == NULL ? NULL : weft_sim_state(self->sim);
    double most = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < n; ++i) {
            const double x
                = ours == NULL ? self->lecture.y[3 * i + k] : ours[k * n + i];
            most = fmax(most, fabs(x - self->of->reference[k * n + i]));
        }
    }
    return most;
}

static void make_reference(task *of)
{
    const size_t bytes = weft_cloth_dim(of->cloth) * sizeof(double);
    trial tight = { .of = of,
                    .plugin = weft_plugin_gsl(),
                    .method = "rk8pd",
                    .threads = 1,
                    .tolerance = 1e-11 };
    run(&tight);
    of->reference = malloc(bytes);
    if (of->reference == NULL) {
        abort();
    }
    memcpy(of->reference, weft_sim_state(tight.sim), bytes);
    end(&tight);
}

static double stable_step(const task *of, const char *method)
{
    const double *y = of->reference;
    const weft_stiffness modes = weft_cloth_stiffness(of->cloth, 0.0, y);
    weft_stability stability;
    double h = 0.0;
    weft_error err = { 0 };
    bench_must(weft_stability_create(weft_plugin_method(weft_plugin_verlet(), method),
                                     NULL, &stability, &err),
               &err);
    bench_must(weft_stability_step(&stability, &modes, 0.0, &h, &err), &err);
    return OF_STABLE * h;
}

/* ---- one problem under several steppers ------------------------------------------ */

static const struct {
    const weft_plugin *(*plugin)(void); /* NULL: the lecture's way */
    const char *method;
    size_t threads;
    bool sheets; /* also of P(n) */
} entries[] = {
    { NULL, "rkf45", 1, true },
    { weft_plugin_arkode, "dormand_prince", 1, true },
    { weft_plugin_arkode, "dormand_prince", 2, true },
    { weft_plugin_arkode, "cash_karp", 1, false },
    { weft_plugin_arkode, "bogacki_shampine", 1, false },
    { weft_plugin_gsl, "rkf45", 1, true },
    { weft_plugin_gsl, "rkck", 1, true },
    { weft_plugin_gsl, "rk8pd", 1, false },
    { weft_plugin_verlet, "velocity_verlet", 1, true },
    { weft_plugin_verlet, "symplectic_euler", 1, true },
};

enum { ENTRIES = sizeof entries / sizeof entries[0] };

static void report(FILE *csv, const trial *it, double seconds, double lecture_seconds)
{
    const bool ours = it->plugin != NULL;
    const weft_stepper_stats stats
        = ours ? weft_sim_stats(it->sim)
               : (weft_stepper_stats){ .steps = it->lecture.steps,
                                       .rejected = it->lecture.rejected,
                                       .rhs_calls = it->lecture.rhs_calls };
    const char *plugin = ours ? it->plugin->id : "lecture";
    const double far = error(it), ratio = lecture_seconds / seconds;
    printf("steps %s %s/%s threads=%zu: %.4g s, %.4g s/s, ratio %.2f, %llu steps, %llu "
           "rejected, %llu calls, error %.1e m\n",
           it->of->name, plugin, it->method, it->threads, seconds,
           seconds / it->of->duration, ratio, (unsigned long long)stats.steps,
           (unsigned long long)stats.rejected, (unsigned long long)stats.rhs_calls,
           far);
    fprintf(csv, "%s,%s,%s,%zu,%.6g,%.6g,%.4g,%llu,%llu,%llu,%.3g\n", it->of->name,
            plugin, it->method, it->threads, seconds, seconds / it->of->duration, ratio,
            (unsigned long long)stats.steps, (unsigned long long)stats.rejected,
            (unsigned long long)stats.rhs_calls, far);
    fflush(stdout);
}

static void compare(FILE *csv, task *of, bool sheet, size_t rounds)
{
    trial trials[ENTRIES];
    bench_case cases[ENTRIES];
    size_t count = 0;
    make_reference(of);
    for (size_t i = 0; i < ENTRIES; ++i) {
        if (sheet && !entries[i].sheets) {
            continue;
        }
        const weft_plugin *plugin
            = entries[i].plugin == NULL ? NULL : entries[i].plugin();
        const bool fixed = plugin == weft_plugin_verlet();
        trials[count] = (trial){
            .of = of,
            .plugin = plugin,
            .method = entries[i].method,
            .threads = entries[i].threads,
            .tolerance = TOLERANCE,
            .fixed_step = fixed ? stable_step(of, entries[i].method) : 0.0,
        };
        cases[count] = (bench_case){ entries[i].method, run, &trials[count], 0.0 };
        ++count;
    }
    bench_interleaved(cases, count, rounds);
    for (size_t i = 0; i < count; ++i) {
        report(csv, &trials[i], cases[i].median, cases[0].median);
        end(&trials[i]);
    }
    free(of->reference);
    weft_cloth_destroy(of->cloth);
}

static void compare_sheet(FILE *csv, size_t n, double duration, size_t rounds)
{
    task sheet = { .cloth = make_sheet(n), .duration = duration };
    (void)snprintf(sheet.name, sizeof sheet.name, "P(%zu)", n);
    compare(csv, &sheet, true, rounds);
}

static void compare_scene(FILE *csv, const char *name, double duration, size_t rounds)
{
    char file[128];
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    weft_scene_def def = weft_scene_def_default();
    weft_diagnostics *found = calloc(1, sizeof *found);
    task of = { .duration = duration };
    (void)snprintf(file, sizeof file, "scenes/%s.yaml", name);
    (void)snprintf(of.name, sizeof of.name, "%s", name);
    def.file = file;
    if (found == NULL) {
        abort();
    }
    bench_must(weft_scene_load(&def, &scene, found, &err), &err);
    bench_must(weft_cloth_create(weft_scene_cloth(scene), &of.cloth, &err), &err);
    compare(csv, &of, false, rounds);
    weft_scene_destroy(scene);
    free(found);
}

/* One run of P(n) in so many equal steps, the shorter time of two, for a program that
 * alternates it with a peer's. */
static void time_euler(size_t n, double duration, double steps)
{
    task of = { .cloth = make_sheet(n), .duration = duration };
    trial it = { .of = &of,
                 .plugin = weft_plugin_verlet(),
                 .method = "symplectic_euler",
                 .threads = 1,
                 .fixed_step = duration / steps };
    double least = INFINITY;
    for (int i = 0; i < 2; ++i) {
        const double began = bench_now();
        run(&it);
        least = fmin(least, bench_now() - began);
    }
    printf("%.6g\n", least);
    end(&it);
    weft_cloth_destroy(of.cloth);
}

int main(int argc, char **argv)
{
    const char *only = argc > 1 ? argv[1] : "";
    if (strcmp(only, "euler") == 0 && argc == 5) { /* n, duration [s], steps */
        time_euler((size_t)atoi(argv[2]), atof(argv[3]), atof(argv[4]));
        return 0;
    }
    FILE *csv = bench_csv("steps", "problem,plugin,method,threads,seconds,seconds_per_"
                                   "second,ratio,steps,rejected,rhs_calls,error_m");
    if (*only == '\0' || strcmp(only, "sheets") == 0) {
        compare_sheet(csv, 32, 0.5, 5);
        compare_sheet(csv, 100, 0.1, 5);
    }
    if (*only == '\0' || strcmp(only, "scenes") == 0) {
        compare_scene(csv, "two-corners", 0.25, 5);
        compare_scene(csv, "provot", 1.0, 5);
        compare_scene(csv, "trampoline", 0.5, 5);
        compare_scene(csv, "curtain", 0.25, 5);
    }
    return bench_csv_close(csv);
}

#else

int main(void)
{
    puts("steps: skipped, it takes the plugins gsl and arkode");
    return 0;
}

#endif
