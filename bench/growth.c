/* SPDX-License-Identifier: BSD-3-Clause */
/* growth.c -- how a step of Dormand and Prince's grows with the cloth, in simulations
 * that have been running for a while: the grid P(n) and a jittered sheet of n x n
 * vertices, on one thread and on two, and of verlet's methods on the grid; of a grid
 * also stage by stage, where the simulation has a pass (docs/project/speed.md), to the
 * same state. Beside it what memory alone would take: the bytes that a step moves where
 * nothing stays in the caches, by the bandwidth of a triad a = b + s c measured before
 * each size. Arguments: sides instead of all. */
#include "bench.h"

#include <math.h>
#include <string.h>

#include "base/thread_pool.h"
#include "problem.h"
#include "sheet.h"
#include "weft/weft.h"

#ifdef HAVE_ARKODE

const weft_plugin *weft_plugin_arkode(void);
const weft_plugin *weft_plugin_verlet(void);

enum {
    THREADS = 2,
    ROUNDS = 9,
    ROUNDS_SMALL = 31,
    SMALL = 1 << 19,
    WARM_UP = 8,
    TRIAD = 1 << 23
};

/* [bytes] a vector of 6 numbers a particle, read, and read before it is written; what
 * an evaluation of a mesh reads and writes of its own, docs/project/speed.md */
enum { VECTOR = 48, OF_MESH = 683 };

/* Vectors read and written in a step beyond the forces, and in its evaluations. */
static double bytes_a_step(const char *kind) /* [bytes] a particle */
{
    const bool verlet = strcmp(kind, "velocity_verlet") == 0;
    const bool euler = strcmp(kind, "symplectic_euler") == 0;
    const double vectors = verlet ? 7 + 2 * 2 : euler ? 5 : 38 + 2 * 9;
    const double each = strcmp(kind, "mesh") == 0 ? OF_MESH : 3 * VECTOR;
    return vectors * VECTOR + (verlet || euler ? 1 : 6) * each;
}

/* ---- the triad ------------------------------------------------------------------- */

typedef struct triad {
    double *a, *b, *c;
    weft__pool *pool;
    size_t parts;
} triad;

static void do_part(void *ctx, size_t i)
{
    const triad *of = ctx;
    const size_t first = TRIAD * i / of->parts, end = TRIAD * (i + 1) / of->parts;
    for (size_t j = first; j < end; ++j) {
        of->a[j] = of->b[j] + 3.0 * of->c[j];
    }
}

static void run_triad(void *ctx)
{
    triad *of = ctx;
    weft__pool_run(of->pool, do_part, of, of->parts);
}

/* [GB/s], of which a written number counts twice: it is read first. */
static double bandwidth(size_t threads)
{
    triad of = { .a = array(TRIAD, sizeof(double)),
                 .b = array(TRIAD, sizeof(double)),
                 .c = array(TRIAD, sizeof(double)),
                 .pool = weft__pool_create(threads, NULL),
                 .parts = threads };
    for (size_t j = 0; j < TRIAD; ++j) {
        of.b[j] = of.c[j] = 1.0;
    }
    bench_case it = { "triad", run_triad, &of, 0.0 };
    bench_interleaved(&it, 1, ROUNDS);
    weft__pool_destroy(of.pool);
    free(of.a), free(of.b), free(of.c);
    return 1e-9 * 4 * sizeof(double) * TRIAD / it.median;
}

/* ---- steps ----------------------------------------------------------------------- */

typedef struct steady {
    weft_sim *sim;
    size_t threads;
    int steps; /* of one measurement */
} steady;

static void take_steps(void *ctx)
{
    const steady *self = ctx;
    weft_error err;
    for (int i = 0; i < self->steps; ++i) {
        bench_must(weft_sim_step(self->sim, 1e9, &err), &err);
    }
}

static steady start(const char *kind, const weft_cloth *cloth, size_t threads,
                    bool by_stages)
{
    static const weft_pass none;
    weft_error err;
    steady out = { .threads = threads, .steps = WARM_UP };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
    def.config.rtol = 0.0;
    def.config.atol_position = def.config.atol_velocity = 1e-6;
    def.config.first_step = 1e-5;
    if (strchr(kind, '_') != NULL) {
        def.method = weft_plugin_method(weft_plugin_verlet(), kind);
        def.config.fixed_step = 1e-8;
    }
    def.config.threads = threads;
    def.config.pass = by_stages ? &none : NULL;
    bench_must(weft_sim_create(&def, &out.sim, &err), &err);
    take_steps(&out);
    out.steps = 1 + (int)(200000 / weft_cloth_particles(cloth));
    return out;
}

static void compare(const weft_sim *a, const weft_sim *b)
{
    const size_t bytes = weft_cloth_dim(weft_sim_cloth(a)) * sizeof(double);
    if (memcmp(weft_sim_state(a), weft_sim_state(b), bytes) != 0) {
        fputs("growth: by stages the state is another\n", stderr);
        exit(1);
    }
}

static void report(FILE *csv, const char *kind, size_t n, size_t threads, double ns,
                   double speedup, double by_stages)
{
    const double bytes = bytes_a_step(kind);
    const double rate = bandwidth(threads), least = bytes / rate;
    printf("growth %s %zux%zu threads=%zu: %.1f ns/particle and step, of one thread "
           "%.2f; ",
           kind, n, n, threads, ns, speedup);
    if (!isnan(by_stages)) {
        printf("stage by stage %.1f, %.2f times; ", by_stages, by_stages / ns);
    }
    printf("memory alone %.1f (%.0f bytes at %.1f GB/s)\n", least, bytes, rate);
    fprintf(csv, "%s,%zu,%zu,%.5g,%.5g,%.5g,%.5g\n", kind, n, threads, ns, bytes, rate,
            by_stages);
}

/* Each number of threads as usual, then stage by stage: of grids, as meshes have no
 * pass. */
static void grow(FILE *csv, const char *kind, size_t n, const weft_cloth *cloth)
{
    enum { CASES = 2 * THREADS };
    steady runs[CASES];
    bench_case cases[CASES];
    double ns[CASES];
    const size_t forms = strcmp(kind, "mesh") == 0 ? 1 : 2, count = forms * THREADS;
    for (size_t i = 0; i < count; ++i) {
        runs[i] = start(kind, cloth, 1 + i / forms, i % forms == 1);
        cases[i] = (bench_case){ kind, take_steps, &runs[i], 0.0 };
    }
    bench_interleaved(cases, count, n * n < SMALL ? ROUNDS_SMALL : ROUNDS);
    for (size_t i = 0; i < count; ++i) {
        ns[i] = 1e9 * cases[i].median / runs[i].steps / (double)(n * n);
        compare(runs[0].sim, runs[i].sim);
    }
    for (size_t i = 0; i < THREADS; ++i) {
        report(csv, kind, n, i + 1, ns[forms * i], ns[0] / ns[forms * i],
               forms == 2 ? ns[2 * i + 1] : (double)NAN);
    }
    for (size_t i = 0; i < count; ++i) {
        weft_sim_destroy(runs[i].sim);
    }
    fflush(stdout);
}

static void grow_grid(FILE *csv, size_t n)
{
    const weft_cloth_def def = problem(n);
    weft_cloth *cloth;
    weft_error err;
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    grow(csv, "grid", n, cloth);
    grow(csv, "velocity_verlet", n, cloth);
    grow(csv, "symplectic_euler", n, cloth);
    weft_cloth_destroy(cloth);
}

static void grow_mesh(FILE *csv, size_t n)
{
    sheet of = sheet_create(n, false);
    weft_cloth *cloth = sheet_cloth(&of, 1e-5);
    sheet_destroy(&of);
    grow(csv, "mesh", n, cloth);
    weft_cloth_destroy(cloth);
}

int main(int argc, char **argv)
{
    static const size_t all[] = { 32, 64, 128, 256, 512, 1000, 2000 };
    const size_t count = argc > 1 ? (size_t)argc - 1 : sizeof all / sizeof all[0];
    FILE *csv = bench_csv("growth", "cloth,side,threads,ns_per_particle,bytes_per_"
                                    "particle,triad_GB_per_s,by_stages_ns");
    for (size_t i = 0; i < count; ++i) {
        const size_t n = argc > 1 ? (size_t)atoi(argv[i + 1]) : all[i];
        grow_grid(csv, n);
        grow_mesh(csv, n);
    }
    return bench_csv_close(csv);
}

#else

int main(void)
{
    puts("growth: skipped, it takes the plugin arkode");
    return 0;
}

#endif
