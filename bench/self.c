/* SPDX-License-Identifier: BSD-3-Clause */
/* self.c -- the cost of contact of a cloth with itself: a sheet of springs or triangles
 * dropped on its edge, a spiral and a flat sheet under Dormand-Prince, without it, with
 * it, and with it on two threads; what a step takes more of, and where the time goes.
 * Arguments: SCENE SIDE SECONDS, one run instead of all. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <inttypes.h>
#include <signal.h>
#include <sys/time.h>

#include "../tests/folded.h"
#include "../tests/folded_mesh.h"
#include "cloth/model.h"
#include "forces/contact/self/self_list.h"
#include "sim/simulation.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_arkode(void);

static void flat(double u, double w, double x[3], double v[3])
{
    x[0] = u, x[1] = 0.01 * sin(3.0 * u) * sin(3.0 * w) + 0.02, x[2] = w;
    v[0] = v[1] = v[2] = 0.0;
}

typedef struct scene {
    const char *name;
    folded_shape *shape;
    size_t side;
    double seconds;
    bool triangles;
} scene;
static const scene scenes[] = { { "pile", folded_pile, 33, 0.8, false },
                                { "pile", folded_pile, 100, 0.3, false },
                                { "mesh", folded_pile, 33, 0.4, true },
                                { "roll", folded_roll, 33, 0.2, false },
                                { "flat", flat, 100, 0.1, false } };

/* ---- where the time goes --------------------------------------------------------- */

/* A timer of the process's own time counts what is at work when it ticks. */
typedef enum phase { REST, PUSHES, SUMS, DRIFT, LIST, CHECK, PHASES } phase;
static const char *const phases[PHASES]
    = { "springs or triangles, shapes and the method",
        "pushes",
        "adding them",
        "drift test",
        "making the list",
        "check of accepted steps" };

static volatile sig_atomic_t current;
static uint64_t ticks[PHASES];
static uint64_t chunks_made, listed, pushing; /* of all evaluations or lists */
static weft__self forms;                      /* those of the cloth */

static void tick(int signal)
{
    (void)signal;
    ++ticks[current];
}

/* Returns what was at work; all that a check does is its own. */
static sig_atomic_t enter(phase now)
{
    const sig_atomic_t outer = current;
    current = outer == CHECK ? CHECK : (sig_atomic_t)now;
    return outer;
}

static size_t pushes(const weft__self_law *law, weft__pair_kind kind,
                     const weft__near *near, const weft__pair_subset *subsets,
                     size_t subset_count, const double *y, weft__pushes *out,
                     double *bad)
{
    const sig_atomic_t outer = enter(PUSHES);
    const size_t count
        = forms.pushes(law, kind, near, subsets, subset_count, y, out, bad);
    listed += subset_count > 0 ? subsets[subset_count - 1].end[kind] : 0;
    pushing += count;
    current = outer;
    return count;
}

static void drift(const weft__self *own, const double *from, const double *to,
                  size_t level, size_t first, size_t end, weft__drift *of)
{
    const sig_atomic_t outer = enter(DRIFT);
    forms.drift(own, from, to, level, first, end, of);
    current = outer;
}

/* The linker has these called by the library (Makefile). */
int __real_weft__self_list_each(weft__self_list *list, const double *y,
                                weft__self_pass *pass);
int __wrap_weft__self_list_each(weft__self_list *list, const double *y,
                                weft__self_pass *pass);
int __wrap_weft__self_list_each(weft__self_list *list, const double *y,
                                weft__self_pass *pass)
{
    const sig_atomic_t outer = enter(LIST);
    const int failed = __real_weft__self_list_each(list, y, pass);
    current = outer;
    return failed;
}

weft__pushed_fn __real_weft__self_sum, __wrap_weft__self_sum;
void __wrap_weft__self_sum(void *ctx, weft__pair_kind kind, const weft__pushes *of,
                           size_t count)
{
    const sig_atomic_t outer = enter(SUMS);
    __real_weft__self_sum(ctx, kind, of, count);
    current = outer;
}

void __real_weft__self_chunk_begin(weft__self_chunk *of, bool stays);
void __wrap_weft__self_chunk_begin(weft__self_chunk *of, bool stays);
void __wrap_weft__self_chunk_begin(weft__self_chunk *of, bool stays)
{
    ++chunks_made;
    __real_weft__self_chunk_begin(of, stays);
}

bool __real_weft__path_clear(const weft__forces *forces, const weft__path *path);
bool __wrap_weft__path_clear(const weft__forces *forces, const weft__path *path);
bool __wrap_weft__path_clear(const weft__forces *forces, const weft__path *path)
{
    const sig_atomic_t outer = enter(CHECK);
    const bool clear = __real_weft__path_clear(forces, path);
    current = outer;
    return clear;
}

static void run_timer(int microseconds) /* 0: stops it */
{
    const struct itimerval each = { { 0, microseconds }, { 0, microseconds } };
    (void)setitimer(ITIMER_PROF, &each, NULL);
}

static void watch(weft_sim *sim)
{
    const struct sigaction each = { .sa_handler = tick, .sa_flags = SA_RESTART };
    memset(ticks, 0, sizeof ticks);
    chunks_made = listed = pushing = 0;
    forms = sim->cloth->self;
    sim->cloth->self.pushes = pushes;
    sim->cloth->self.drift = drift;
    (void)sigaction(SIGPROF, &each, NULL);
    run_timer(1000);
}

/* ---- runs ------------------------------------------------------------------------ */

typedef struct result {
    double time, wall; /* [s] of all threads, and on the clock */
    weft_stepper_stats stats;
    uint64_t vetoed;
    weft_measures end;
    size_t crossings, chunks;
} result;

static double wall_now(void)
{
    struct timespec at;
    (void)clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

static weft_cloth_def mesh_model(size_t side, test_mesh *mesh)
{
    mesh_sheet(mesh, side, side, 1.0 / (double)(side - 1), MESH_RANDOM, 0.2, 7);
    mesh_shuffle(mesh, 8, NULL);
    mesh->fabrics[0] = (weft_fabric){ .density = 0.2,
                                      .stretch = { 250.0, 250.0 },
                                      .shear = 50.0,
                                      .bend = { 1e-4, 1e-4 },
                                      .twist = 1e-4,
                                      .damping = { 2e-4, 2e-4 },
                                      .coupling = 50.0 };
    weft_cloth_def def = mesh_cloth(mesh);
    def.gravity[1] = -9.81;
    def.contact.thickness = fmin(5e-3, 0.5 * mesh_least_height(mesh));
    return def;
}

static result run(const scene *of, bool self, size_t threads)
{
    weft_error err;
    weft_cloth *cloth;
    weft_sim *sim;
    test_mesh mesh = { .rows = 0 };
    const size_t side = of->side;
    weft_shape ground = weft_shape_default(WEFT_PLANE);
    weft_cloth_def def
        = of->triangles ? mesh_model(side, &mesh) : folded_model(side, side);
    double *xyz = malloc(6 * side * side * sizeof *xyz);
    ground.at[1] = of->shape == folded_roll ? -0.03 : 0.0;
    def.contact.shapes = &ground, def.contact.shape_count = 1;
    def.contact.self = self;
    if (of->triangles) {
        mesh_set(&mesh, 1.0, of->shape, xyz, xyz + 3 * side * side);
        memcpy(mesh.start, xyz, 3 * side * side * sizeof *xyz);
    } else {
        def.origin[1] = 1.0;
        folded_start(&def, of->shape, xyz, xyz + 3 * side * side);
    }
    weft_sim_def with = weft_sim_def_default();
    with.method = weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
    with.config.threads = threads;
    with.config.rtol = with.config.atol_position = with.config.atol_velocity = 1e-4;
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    with.cloth = cloth;
    bench_must(weft_sim_create(&with, &sim, &err), &err);
    bench_must(weft_sim_set_state(sim, xyz, xyz + 3 * side * side, &err), &err);
    if (self && threads == 1) {
        watch(sim);
    }
    const double start = bench_now(), began = wall_now();
    bench_must(weft_sim_advance(sim, of->seconds, &err), &err);
    const weft__self_list *list = sim->forces.spaces[WEFT__FORCE_self];
    result out = { .time = bench_now() - start,
                   .wall = wall_now() - began,
                   .stats = weft_sim_stats(sim),
                   .vetoed = weft_sim_vetoed(sim),
                   .end = weft_sim_measure(sim),
                   .crossings = weft_cloth_crossings(cloth, weft_sim_state(sim), NULL),
                   .chunks = self ? list->chunk_count : 1 };
    run_timer(0);
    free(xyz);
    mesh_free(&mesh);
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

/* Of a run that was watched, against that without. */
static void explain(const result *with, const result *without)
{
    const double calls = (double)with->stats.rhs_calls;
    const double more = calls / (double)without->stats.rhs_calls;
    uint64_t all = 0;
    printf("      %.2f times as long: %.2f times the evaluations, each %.2f times as "
           "long\n",
           with->time / without->time, more, with->time / without->time / more);
    printf("      steps %" PRIu64 " and %" PRIu64 " without, by error rejected %" PRIu64
           " and %" PRIu64 ", taken back %" PRIu64 "; %.2f evaluations each\n",
           with->stats.steps, without->stats.steps, with->stats.rejected - with->vetoed,
           without->stats.rejected, with->vetoed, calls / (double)with->stats.steps);
    printf("      an evaluation: pairs listed %.0f, pushing %.0f; a list made every "
           "%.0f\n",
           (double)listed / calls, (double)pushing / calls,
           calls * (double)with->chunks / (double)(chunks_made > 0 ? chunks_made : 1));
    for (size_t i = 0; i < PHASES; ++i) {
        all += ticks[i];
    }
    for (size_t i = 0; i < PHASES && all > 0; ++i) {
        const double share = (double)ticks[i] / (double)all;
        printf("      %5.1f %%  %7.1f us an evaluation  %s\n", 100.0 * share,
               1e6 * share * with->time / calls, phases[i]);
    }
}

static void compare(const scene *of)
{
    const result without = run(of, false, 1);
    line(of->name, of->side, "without", &without, without.time);
    const result with = run(of, true, 1);
    line(of->name, of->side, "self", &with, without.time);
    explain(&with, &without);
    const result two = run(of, true, 2);
    line(of->name, of->side, "self, 2 threads", &two, without.time);
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; ++i) {
        scene of = scenes[i];
        if (argc < 2) {
            compare(&of);
        } else if (argc == 4 && strcmp(argv[1], of.name) == 0) {
            of.side = (size_t)atoi(argv[2]), of.seconds = atof(argv[3]);
            compare(&of);
            return 0;
        }
    }
    return 0;
}
