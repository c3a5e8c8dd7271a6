/* SPDX-License-Identifier: BSD-3-Clause */
/* gradients.c -- what derivatives by numbers cost: the time of a step of a square cloth
 * hung by two corners with sensitivities by some numbers, in steps without; and that of
 * a gradient backwards, in runs. */
#define _POSIX_C_SOURCE 200809L
#include <time.h>
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_verlet(void);

enum { SIDE = 100, STEPS = 20, NUMBERS = 5, ROUNDS = 15 };
#define STEP 1e-4

static const char *const names[NUMBERS]
    = { "stretch stiffness", "shear stiffness", "gravity", "bend damping", "density" };

/* With number j times `factor`. */
static weft_cloth *make_cloth(size_t j, double factor)
{
    static const weft_pin pins[] = { { .cols = { 0, 0 } }, { .cols = { -1, -1 } } };
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    weft_error err;
    def.rows = def.cols = SIDE;
    def.spacing[0] = def.spacing[1] = 1.0 / (SIDE - 1);
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.02 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ true, 50.0, 0.01 };
    def.springs[WEFT_BEND] = (weft_spring_def){ true, 5.0, 0.001 };
    def.pins = pins;
    def.pin_count = 2;
    double *const of[NUMBERS]
        = { &def.springs[WEFT_STRETCH].stiffness, &def.springs[WEFT_SHEAR].stiffness,
            &def.gravity[1], &def.springs[WEFT_BEND].damping, &def.density };
    *of[j] *= factor;
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

typedef struct job {
    weft_sim *sim;
} job;

static void run(void *ctx)
{
    const job *self = ctx;
    weft_error err;
    const double end = weft_sim_time(self->sim) + STEPS * STEP;
    bench_must(weft_sim_advance(self->sim, end, &err), &err);
}

static job make_job(const weft_cloth *cloth, const weft_parameter *numbers,
                    size_t count)
{
    job out;
    weft_error err;
    const weft_sensitivity_def of = { count, numbers, true };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    def.config.fixed_step = STEP;
    def.sensitivity = count > 0 ? &of : NULL;
    bench_must(weft_sim_create(&def, &out.sim, &err), &err);
    return out;
}

enum { RUN = 300, GRADIENTS = 9 };

/* The height of one particle. */
static int height(void *ctx, size_t frame, double t, const double *y, double *value,
                  double *slope)
{
    const size_t at = (size_t)SIDE * SIDE + SIDE * SIDE / 2;
    (void)ctx, (void)frame, (void)t;
    *value += y[at];
    slope[at] += 1.0;
    return 0;
}

/* A whole run of RUN steps, or the gradient of its end by some numbers. */
typedef struct gradient_job {
    weft_sim_def sim;
    const weft_parameter *numbers;
    size_t count;
    bool forwards;
} gradient_job;

static void find_gradient(void *ctx)
{
    const gradient_job *self = ctx;
    const double end = RUN * STEP;
    weft_error err;
    double value, by[NUMBERS];
    if (self->forwards) {
        weft_sim *sim;
        bench_must(weft_sim_create(&self->sim, &sim, &err), &err);
        bench_must(weft_sim_advance(sim, end, &err), &err);
        weft_sim_destroy(sim);
        return;
    }
    weft_gradient_def def = weft_gradient_def_default();
    def.sim = &self->sim, def.parameters = self->numbers, def.count = self->count;
    def.times = &end, def.frames = 1, def.objective = height;
    bench_must(weft_gradient(&def, &value, by, NULL, &err), &err);
}

/* Numbers: none, the four of springs and weight, density alone. */
static void print_gradients(const weft_cloth *cloth, const weft_parameter *numbers)
{
    static const char *const what[]
        = { "first state", "4 numbers of springs and weight", "those and density" };
    static const size_t counts[] = { 0, NUMBERS - 1, NUMBERS };
    gradient_job jobs[4];
    bench_case cases[4];
    for (size_t i = 0; i < 4; ++i) {
        jobs[i] = (gradient_job){ weft_sim_def_default(), numbers,
                                  i < 3 ? counts[i] : 0, i == 3 };
        jobs[i].sim.cloth = cloth;
        jobs[i].sim.method
            = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
        jobs[i].sim.config.fixed_step = STEP;
        cases[i] = (bench_case){ "", find_gradient, &jobs[i], 0.0 };
    }
    bench_interleaved(cases, 4, GRADIENTS);
    printf("a run of %d steps takes %.3g s\n", RUN, cases[3].median);
    puts("gradient by the state at 0 and   runs (aim: 5)");
    for (size_t i = 0; i < 3; ++i) {
        printf("%-32s %13.2f\n", what[i], cases[i].median / cases[3].median);
    }
}

int main(void)
{
    const double d = 0x1p-22;
    weft_cloth *cloth = make_cloth(0, 1.0);
    weft_parameter numbers[NUMBERS];
    job jobs[NUMBERS + 2];
    bench_case cases[NUMBERS + 2];
    for (size_t j = 0; j < NUMBERS; ++j) {
        numbers[j] = (weft_parameter){ names[j], make_cloth(j, 1.0 - d),
                                       make_cloth(j, 1.0 + d), 2.0 * d };
    }
    for (size_t j = 0; j < NUMBERS + 2; ++j) {
        jobs[j] = j < NUMBERS    ? make_job(cloth, &numbers[j], 1)
                  : j == NUMBERS ? make_job(cloth, numbers, NUMBERS)
                                 : make_job(cloth, NULL, 0);
        cases[j] = (bench_case){ "", run, &jobs[j], 0.0 };
    }
    bench_interleaved(cases, NUMBERS + 2, ROUNDS);
    const double step = cases[NUMBERS + 1].median;
    printf("%d x %d, velocity_verlet: a step without takes %.3g ms\n", SIDE, SIDE,
           1e3 * step / STEPS);
    puts("sensitivity by       steps without   of them per number   1 + 1.5 p");
    for (size_t j = 0; j < NUMBERS + 1; ++j) {
        const double p = j < NUMBERS ? 1.0 : (double)NUMBERS;
        const double ratio = cases[j].median / step;
        printf("%-20s %13.2f %20.2f %11.1f\n", j < NUMBERS ? names[j] : "all five",
               ratio, (ratio - 1.0) / p, 1.0 + 1.5 * p);
    }
    print_gradients(cloth, numbers);
    for (size_t j = 0; j < NUMBERS + 2; ++j) {
        weft_sim_destroy(jobs[j].sim);
    }
    for (size_t j = 0; j < NUMBERS; ++j) {
        weft_cloth_destroy((weft_cloth *)numbers[j].less);
        weft_cloth_destroy((weft_cloth *)numbers[j].more);
    }
    weft_cloth_destroy(cloth);
    return 0;
}
