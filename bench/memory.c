/* SPDX-License-Identifier: BSD-3-Clause */
/* memory.c -- peak memory of a run in bytes a particle, and in state vectors of 6 N
 * doubles: of a simulation in a process of its own, and of `weft run`, which records
 * frames. What the process has without a cloth is taken off. Beside it what weft says
 * of the simulation and its cloth, which `weft check` prints with a state for frames.
 */
#include "bench.h"

#include "weft/weft.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>

#if defined(HAVE_GSL) && defined(HAVE_ARKODE)

const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);
const weft_plugin *weft_plugin_verlet(void);

enum { STEPS = 4 };

typedef struct job {
    const weft_plugin *plugin; /* NULL: nothing is done */
    const char *method;
    size_t side;
} job;

static void simulate(const job *what)
{
    static const weft_pin corner = { .rows = { 0, 0 } };
    weft_cloth_def of = weft_cloth_def_default();
    weft_sim_def def = weft_sim_def_default();
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    const double cell = 1.0 / (double)(what->side - 1);
    of.rows = of.cols = what->side;
    of.spacing[0] = of.spacing[1] = cell;
    of.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.05 };
    of.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.025 };
    of.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 10.0, .damping = 0.005 };
    of.pins = &corner;
    of.pin_count = 1;
    if (weft_cloth_create(&of, &cloth, NULL) != WEFT_OK) {
        exit(1);
    }
    def.cloth = cloth;
    def.method = weft_plugin_method(what->plugin, what->method);
    def.config.first_step = 1e-3 * cell;
    def.config.fixed_step = what->plugin == weft_plugin_verlet() ? 1e-3 * cell : 0.0;
    if (weft_sim_create(&def, &sim, NULL) != WEFT_OK) {
        exit(1);
    }
    for (int i = 0; i < STEPS; ++i) {
        if (weft_sim_step(sim, 1.0, NULL) != WEFT_OK) {
            exit(1);
        }
    }
    if (what->side > 4) {
        const double said
            = (double)weft_sim_stats(sim).bytes + (double)weft_cloth_bytes(cloth);
        printf("memory said %zux%zu %s/%s: %.0f bytes/particle\n", what->side,
               what->side, what->plugin->id, what->method,
               said / (double)weft_cloth_particles(cloth));
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

static void run_simulation(const job *what)
{
    if (what->plugin != NULL) {
        simulate(what);
    }
    exit(0);
}

/* Two frames of scene two-corners at another size. */
static void run_program(const job *what)
{
    char rows[64], cols[64], plugin[64], method[64], spacing[64];
    (void)snprintf(rows, sizeof rows, "cloth.grid.rows=%zu", what->side);
    (void)snprintf(cols, sizeof cols, "cloth.grid.cols=%zu", what->side);
    (void)snprintf(spacing, sizeof spacing, "cloth.grid.spacing=%.17g",
                   1.0 / (double)(what->side - 1));
    (void)snprintf(plugin, sizeof plugin, "stepper.plugin=%s", what->plugin->id);
    (void)snprintf(method, sizeof method, "stepper.method=%s", what->method);
    (void)execl(BUILD_DIR "/weft", "weft", "run", "scenes/two-corners.yaml", "--quiet",
                "--force", "--out", BUILD_DIR "/bench/memory.run", "--set", rows,
                "--set", cols, "--set", spacing, "--set", plugin, "--set", method,
                "--set", "run.duration=1e-5", "--set", "run.fps=100000", (char *)NULL);
    _exit(1);
}

typedef void run_fn(const job *what);

/* In a process whose only child is the run: rusage knows the largest of all children.
 */
static void watch(run_fn *run, const job *what, int to)
{
    struct rusage usage;
    int status = 0;
    const pid_t child = fork();
    if (child == 0) {
        run(what);
    }
    const bool done = child > 0 && waitpid(child, &status, 0) == child && status == 0
                      && getrusage(RUSAGE_CHILDREN, &usage) == 0;
    const double bytes = done ? 1024.0 * (double)usage.ru_maxrss : 0.0;
    _exit(write(to, &bytes, sizeof bytes) == sizeof bytes ? 0 : 1);
}

static double peak(run_fn *run, const job *what) /* [bytes] */
{
    int ends[2];
    double bytes = 0.0;
    fflush(NULL);
    const pid_t watcher = pipe(ends) == 0 ? fork() : -1;
    if (watcher == 0) {
        watch(run, what, ends[1]);
    }
    if (watcher < 0 || read(ends[0], &bytes, sizeof bytes) != sizeof bytes
        || waitpid(watcher, NULL, 0) != watcher || bytes == 0.0) {
        fputs("memory: a run failed\n", stderr);
        exit(1);
    }
    (void)close(ends[0]);
    (void)close(ends[1]);
    return bytes;
}

static void measure(FILE *csv, const char *name, run_fn *run, const job *what,
                    double without)
{
    const double n = (double)(what->side * what->side);
    const double bytes = peak(run, what) - without;
    printf("memory %s %zux%zu %s/%s: %.0f bytes/particle, %.1f state vectors\n", name,
           what->side, what->side, what->plugin->id, what->method, bytes / n,
           bytes / (6.0 * sizeof(double) * n));
    fprintf(csv, "%s,%zu,%s,%s,%.0f,%.4g,%.4g\n", name, what->side, what->plugin->id,
            what->method, bytes, bytes / n, bytes / (6.0 * sizeof(double) * n));
    fflush(stdout);
}

int main(void)
{
    static const size_t sides[] = { 100, 316, 1000 };
    FILE *csv = bench_csv("memory", "run,side,plugin,method,bytes,bytes_per_particle,"
                                    "state_vectors");
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; ++i) {
        const job jobs[] = { { weft_plugin_arkode(), "dormand_prince", sides[i] },
                             { weft_plugin_gsl(), "rkf45", sides[i] },
                             { weft_plugin_verlet(), "velocity_verlet", sides[i] } };
        const job small = { weft_plugin_arkode(), "dormand_prince", 4 };
        for (size_t k = 0; k < sizeof jobs / sizeof jobs[0]; ++k) {
            measure(csv, "library", run_simulation, &jobs[k],
                    peak(run_simulation, &small));
        }
        measure(csv, "program", run_program, &jobs[0], peak(run_program, &small));
    }
    return bench_csv_close(csv);
}

#else

int main(void)
{
    puts("memory: skipped, it takes the plugins gsl and arkode");
    return 0;
}

#endif
