/* SPDX-License-Identifier: BSD-3-Clause */
/* limit.c -- sweeps and time of a strain limit's solvers from a cold start: Provot's
 * sheet, hung by two corners, in its equilibrium without a limit; one correction to 10
 * %
 * (+ 0.1 %). On 100 x 100 plain sweeps stop after 20000, unless there is an argument.
 */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "weft/weft.h"

const weft_plugin *weft_plugin_verlet(void);

enum { SIDE_MAX = 100, ROUNDS = 5 };

/* Positions of a grid, interleaved. */
typedef struct sheet {
    size_t side;
    double x[3 * SIDE_MAX * SIDE_MAX];
} sheet;

static weft_cloth *make_cloth(size_t side, bool forces)
{
    static const weft_pin pins[] = { { .cols = { 0, 0 } }, { .cols = { -1, -1 } } };
    const double count = (double)(side * side), cells = (double)(side - 1);
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = side;
    def.spacing[0] = sqrt(2.0) / cells;
    def.spacing[1] = 1.0 / cells;
    def.down[2] = 1.0;
    def.mass = 0.1 * sqrt(2.0) / count;
    def.density = 0.0;
    def.pins = pins;
    def.pin_count = 2;
    def.damping = forces ? 0.05 * pow(17.0 / (double)side, 1.8) : 0.0;
    def.gravity[1] = forces ? -9.81 : 0.0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f] = (weft_spring_def){ .present = true,
                                            .stiffness = forces ? 1.0 : 0.0,
                                            .damping = 0.0 };
    }
    weft_error err;
    weft_cloth *cloth;
    if (weft_cloth_create(&def, &cloth, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        abort();
    }
    return cloth;
}

static weft_sim *make_sim(const weft_cloth *cloth, const char *method, double h,
                          const weft_limit_def *limit)
{
    weft_error err;
    weft_sim *sim;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_plugin_method(weft_plugin_verlet(), method);
    def.config.fixed_step = h;
    def.limit = *limit;
    if (weft_sim_create(&def, &sim, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        abort();
    }
    return sim;
}

/* A coarser sheet on this grid. */
static void interpolate(const sheet *from, sheet *to)
{
    const double step = (double)(from->side - 1) / (double)(to->side - 1);
    for (size_t i = 0; i < to->side * to->side; ++i) {
        const double r = step * (double)(i / to->side),
                     c = step * (double)(i % to->side);
        const size_t r0 = (size_t)fmin(r, (double)(from->side - 2));
        const size_t c0 = (size_t)fmin(c, (double)(from->side - 2));
        const double a = r - (double)r0, b = c - (double)c0;
        for (size_t k = 0; k < 3; ++k) {
            const double *corner = from->x + 3 * (r0 * from->side + c0) + k;
            to->x[3 * i + k] = (1.0 - a) * ((1.0 - b) * corner[0] + b * corner[3])
                               + a
                                     * ((1.0 - b) * corner[3 * from->side]
                                        + b * corner[3 * from->side + 3]);
        }
    }
}

/* The sheet after t [s] under its weight. */
static void settle(sheet *at, double t)
{
    const weft_limit_def none = { 0 };
    weft_cloth *cloth = make_cloth(at->side, true);
    const double h = 0.4 * sqrt(weft_cloth_particle_mass(cloth, 0) / 3.0);
    weft_sim *sim = make_sim(cloth, "symplectic_euler", h, &none);
    (void)weft_sim_set_state(sim, at->x, NULL, NULL);
    (void)weft_sim_advance(sim, t, NULL);
    weft_sim_positions(sim, at->x);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

/* Euler without forces leaves the sheet where it is: what a step does is the limit. */
static void measure(const sheet *at, weft_limit_solver solver, size_t most)
{
    weft_limit_def limit = weft_sim_def_default().limit;
    limit.method = WEFT_LIMIT_PROVOT;
    limit.solver = solver;
    limit.sweeps = most;
    limit.keep_velocity = true;
    double times[ROUNDS];
    const size_t rounds = solver == WEFT_LIMIT_FAST || at->side < 33 ? ROUNDS : 1;
    weft_cloth *cloth = make_cloth(at->side, false);
    weft_sim *sim = make_sim(cloth, "euler", 1.0, &limit);
    for (size_t i = 0; i < rounds; ++i) {
        (void)weft_sim_set_state(sim, at->x, NULL, NULL);
        const double start = bench_now();
        (void)weft_sim_step(sim, (double)(i + 1), NULL);
        times[i] = bench_now() - start;
    }
    const weft_limit_stats stats = weft_sim_limit_stats(sim);
    printf("  %-6s %7llu sweeps %10.2f ms   largest strain %.5f%s\n",
           solver == WEFT_LIMIT_FAST ? "fast" : "sweep",
           (unsigned long long)(stats.sweeps / rounds),
           1e3 * bench_median(times, rounds), weft_sim_limit_worst(sim).strain,
           stats.unconverged > 0 ? ", not met" : "");
    fflush(stdout);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

int main(int argc, char **argv)
{
    static sheet at, finer;
    static const size_t sides[] = { 9, 17, 33, 100 };
    (void)argv;
    at.side = 2;
    memcpy(at.x, (double[]){ 0, 0, 0, 1, 0, 0, 0, -1, 1, 1, -1, 1 }, 12 * sizeof *at.x);
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; ++i) {
        finer.side = sides[i];
        interpolate(&at, &finer);
        at = finer;
        settle(&at, sides[i] < 100 ? 20.0 : 2.0);
        printf("limit %zu x %zu\n", sides[i], sides[i]);
        measure(&at, WEFT_LIMIT_SWEEP, sides[i] < 100 || argc > 1 ? 1000000 : 20000);
        measure(&at, WEFT_LIMIT_FAST, 1000000);
    }
    return 0;
}
