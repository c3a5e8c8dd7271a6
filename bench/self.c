/* SPDX-License-Identifier: BSD-3-Clause */
/* self.c -- the cost of contact of a cloth with itself: a sheet dropped on its edge, a
 * spiral and a flat sheet under Dormand-Prince, without it, with it, and with it on two
 * threads. Arguments: SCENE SIDE SECONDS, one run instead of all. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <inttypes.h>

#include "../tests/folded.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_arkode(void);

static void flat(double u, double w, double x[3], double v[3])
{
    x[0] = u, x[1] = 0.01 * sin(3.0 * u) * sin(3.0 * w) + 0.02, x[2] = w;
    v[0] = v[1] = v[2] = 0.0;
}

static const struct {
    const char *name;
    folded_shape *shape;
    size_t side;
    double seconds;
} scenes[] = { { "pile", folded_pile, 33, 0.8 },
               { "pile", folded_pile, 100, 0.3 },
               { "roll", folded_roll, 33, 0.2 },
               { "flat", flat, 100, 0.1 } };

typedef struct result {
    double time, wall; /* [s] of all threads, and on the clock */
    weft_stepper_stats stats;
    uint64_t vetoed;
    weft_measures end;
    size_t crossings;
} result;

static void check(weft_status status, const weft_error *err)
{
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err->message);
        exit(1);
    }
}

static double wall_now(void)
{
    struct timespec at;
    (void)clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

static result run(folded_shape *shape, size_t side, double seconds, bool self,
                  size_t threads)
{
    weft_error err;
    weft_cloth *cloth;
    weft_sim *sim;
    weft_shape ground = weft_shape_default(WEFT_PLANE);
    weft_cloth_def def = folded_model(side, side);
    double *xyz = malloc(6 * side * side * sizeof *xyz);
    ground.at[1] = shape == folded_roll ? -0.03 : 0.0;
    def.contact.shapes = &ground, def.contact.shape_count = 1;
    def.contact.self = self;
    def.origin[1] = 1.0;
    weft_sim_def with = weft_sim_def_default();
    with.method = weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
    with.config.threads = threads;
    with.config.rtol = with.config.atol_position = with.config.atol_velocity = 1e-4;
    check(weft_cloth_create(&def, &cloth, &err), &err);
    with.cloth = cloth;
    check(weft_sim_create(&with, &sim, &err), &err);
    folded_start(&def, shape, xyz, xyz + 3 * side * side);
    check(weft_sim_set_state(sim, xyz, xyz + 3 * side * side, &err), &err);
    const double start = bench_now(), began = wall_now();
    check(weft_sim_advance(sim, seconds, &err), &err);
    result out = { .time = bench_now() - start,
                   .wall = wall_now() - began,
                   .stats = weft_sim_stats(sim),
                   .vetoed = weft_sim_vetoed(sim),
                   .end = weft_sim_measure(sim) };
    weft_sim_positions(sim, xyz);
    out.crossings = side > 50 ? 0 : folded_crossings(xyz, side, side);
    free(xyz);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return out;
}

static void line(const char *name, size_t side, const char *how, const result *of,
                 double without)
{
    printf("%-5s %4zu  %-14s %7.2f s  %5.2f times  %7.2f s on the clock  %7" PRIu64
           " evaluations  %6.1f us each  vetoed %" PRIu64
           "  gap %.2e m, %zu pairs  crossings %zu  hash %016" PRIx64 "\n",
           name, side, how, of->time, of->time / without, of->wall, of->stats.rhs_calls,
           1e6 * of->time / (double)of->stats.rhs_calls, of->vetoed, of->end.self_gap,
           of->end.self_touching, of->crossings, of->end.hash);
    (void)fflush(stdout);
}

static void compare(const char *name, folded_shape *shape, size_t side, double seconds)
{
    const result without = run(shape, side, seconds, false, 1);
    line(name, side, "without", &without, without.time);
    const result with = run(shape, side, seconds, true, 1);
    line(name, side, "self", &with, without.time);
    const result two = run(shape, side, seconds, true, 2);
    line(name, side, "self, 2 threads", &two, without.time);
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; ++i) {
        if (argc < 2) {
            compare(scenes[i].name, scenes[i].shape, scenes[i].side, scenes[i].seconds);
        } else if (argc == 4 && strcmp(argv[1], scenes[i].name) == 0) {
            compare(argv[1], scenes[i].shape, (size_t)atoi(argv[2]), atof(argv[3]));
            return 0;
        }
    }
    return 0;
}
