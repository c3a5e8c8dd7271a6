/* SPDX-License-Identifier: BSD-3-Clause */
/* mpi.c -- one cloth in bands over MPI: P(n) on one and two ranks against weft's own
 * threads (strong scaling), and one rank against two with a band of that size each
 * (weak scaling). Prints per step of Dormand and Prince: time, allreduces and
 * exchanges, and the share of the time that rank 0 spends in MPI. Then the same of
 * sheets of triangles, against two ranks that have nothing to do with each other, and
 * what part of its own vertices a band has as ghosts. Numbers as arguments are the
 * sides n; `mesh` alone: triangles alone. mpirun must have a processor for each rank.
 */
#include "bench.h"

#include "program/mpi/comm_mpi.h"
#include "weft/weft.h"

#include <dlfcn.h>
#include <string.h>

#ifdef HAVE_ARKODE

#include "problem.h"
#include "sheet.h"

const weft_plugin *weft_plugin_arkode(void);

#define WORK 1e7 /* particles times steps of a measurement */

/* A comm that measures another. */
typedef struct measured {
    const weft_comm *inner;
    double seconds; /* in its functions */
    unsigned long maxes, exchanges;
} measured;

static double max(void *ctx, double mine)
{
    measured *self = ctx;
    const double start = bench_now(), most = self->inner->max(self->inner->self, mine);
    self->seconds += bench_now() - start;
    ++self->maxes;
    return most;
}

static void begin(void *ctx, const weft_rows *rows)
{
    measured *self = ctx;
    const double start = bench_now();
    self->inner->begin(self->inner->self, rows);
    self->seconds += bench_now() - start;
    ++self->exchanges;
}

static void post(void *ctx, const weft_parcel *parcels, size_t count)
{
    measured *self = ctx;
    const double start = bench_now();
    self->inner->post(self->inner->self, parcels, count);
    self->seconds += bench_now() - start;
    ++self->exchanges;
}

static void poke(void *ctx)
{
    measured *self = ctx;
    const double start = bench_now();
    self->inner->poke(self->inner->self);
    self->seconds += bench_now() - start;
}

static void end(void *ctx)
{
    measured *self = ctx;
    const double start = bench_now();
    self->inner->end(self->inner->self);
    self->seconds += bench_now() - start;
}

static void share(void *ctx, void *data, size_t bytes)
{
    const measured *self = ctx;
    self->inner->share(self->inner->self, data, bytes);
}

static void gather(void *ctx, const void *mine, size_t bytes, void *all)
{
    const measured *self = ctx;
    self->inner->gather(self->inner->self, mine, bytes, all);
}

static void stop(void *ctx, int code)
{
    const measured *self = ctx;
    self->inner->stop(self->inner->self, code);
}

static weft_comm measure(measured *self)
{
    weft_comm comm = *self->inner;
    comm.self = self;
    comm.max = max, comm.begin = begin, comm.poke = poke, comm.end = end;
    comm.share = share, comm.gather = gather, comm.stop = stop, comm.post = post;
    return comm;
}

/* ---- one measurement ------------------------------------------------------------- */

typedef struct figures {
    double step;             /* [s] */
    double share;            /* of the time in MPI */
    double maxes, exchanges; /* per step */
} figures;

static weft_cloth *grid(size_t rows, size_t cols, const weft_comm *comm)
{
    weft_error err = { 0 };
    weft_cloth_def def = problem(cols);
    weft_cloth *cloth = NULL;
    def.rows = rows;
    if (comm != NULL) {
        (void)weft_comm_band(rows, (size_t)comm->rank, (size_t)comm->size,
                             &def.band_first, &def.band_rows);
    }
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

#define BEND 1e-5 /* [N m] */

static weft_cloth *triangles(size_t side, size_t rank, size_t size)
{
    sheet of = sheet_create(side, true);
    weft_cloth *cloth = sheet_band(&of, BEND, rank, size);
    sheet_destroy(&of);
    return cloth;
}

/* cols 0: a sheet of triangles of `rows` x `rows` vertices, in steps of one length. */
static figures run(size_t rows, size_t cols, size_t threads, const weft_comm *comm,
                   measured *by)
{
    weft_error err = { 0 };
    weft_sim_def run = weft_sim_def_default();
    weft_cloth *cloth = cols > 0
                            ? grid(rows, cols, comm)
                            : triangles(rows, (size_t)comm->rank, (size_t)comm->size);
    weft_sim *sim = NULL;
    const double work = WORK / ((double)rows * (double)(cols > 0 ? cols : rows));
    const size_t warm = 3, steps = work < 5.0 ? 5 : work > 2000.0 ? 2000 : (size_t)work;
    run.config.fixed_step = cols > 0 ? 0.0 : 1e-7;
    run.cloth = cloth;
    run.comm = comm;
    run.method = weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
    run.config.threads = threads;
    run.config.first_step = 1e-6;
    bench_must(weft_sim_create(&run, &sim, &err), &err);
    double began = 0.0;
    for (size_t i = 0; i < warm + steps; ++i) {
        if (i == warm) {
            *by = (measured){ .inner = by->inner };
            began = bench_now();
        }
        bench_must(weft_sim_step(sim, 1e3, &err), &err);
    }
    const double spent = bench_now() - began, n = (double)steps;
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return (figures){ spent / n, by->seconds / spent, (double)by->maxes / n,
                      (double)by->exchanges / n };
}

/* As a rank of mpirun: rank 0 prints the figures. */
static int be_rank(size_t rows, size_t cols)
{
    void *object = dlopen(BUILD_DIR "/plugins/weft-mpi.so", RTLD_NOW | RTLD_LOCAL);
    void *symbol = object == NULL ? NULL : dlsym(object, COMM_MPI_ENTRY);
    comm_mpi_fn *start;
    if (symbol == NULL) {
        return EXIT_FAILURE;
    }
    memcpy(&start, &symbol, sizeof start);
    comm_mpi *mpi = start();
    measured by = { .inner = &mpi->comm };
    const weft_comm comm = measure(&by);
    const figures got = run(rows, cols, 1, &comm, &by);
    if (comm.rank == 0) {
        printf("%.9g %.9g %.9g %.9g\n", got.step, got.share, got.maxes, got.exchanges);
    }
    (void)fflush(stdout);
    mpi->close(mpi);
    return EXIT_SUCCESS;
}

static FILE *begin_ranks(const char *self, int ranks, size_t rows, size_t cols)
{
    char command[512];
    (void)snprintf(
        command, sizeof command,
        "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun %s-n "
        "%d '%s' rank %zu %zu",
        cols > 0 ? "" : "--bind-to none ", ranks, self, rows, cols);
    return popen(command, "r");
}

static figures end_ranks(FILE *pipe)
{
    figures got = { .step = 0.0 };
    if (pipe == NULL
        || fscanf(pipe, "%lf %lf %lf %lf", &got.step, &got.share, &got.maxes,
                  &got.exchanges)
               != 4
        || pclose(pipe) != 0) {
        fprintf(stderr, "bench mpi: mpirun failed\n");
        exit(EXIT_FAILURE);
    }
    return got;
}

static figures on_ranks(const char *self, int ranks, size_t rows, size_t cols)
{
    return end_ranks(begin_ranks(self, ranks, rows, cols));
}

/* ---- tables ---------------------------------------------------------------------- */

static void strong(const char *self, size_t n)
{
    measured none = { .inner = NULL };
    const figures one = run(n, n, 1, NULL, &none), two = run(n, n, 2, NULL, &none);
    const figures alone = on_ranks(self, 1, n, n), pair = on_ranks(self, 2, n, n);
    printf("%4zu^2  %9.3f %9.3f  %9.3f %9.3f  %5.2f x  %5.1f %% %9.1f %9.1f\n", n,
           1e3 * one.step, 1e3 * two.step, 1e3 * alone.step, 1e3 * pair.step,
           alone.step / pair.step, 100.0 * pair.share, pair.maxes, pair.exchanges);
}

static void weak(const char *self, size_t rows, size_t cols)
{
    const figures alone = on_ranks(self, 1, rows, cols);
    const figures pair = on_ranks(self, 2, 2 * rows, cols);
    printf("%4zu x %-6zu  %9.3f %9.3f  %5.1f %%  %5.1f %%\n", rows, cols,
           1e3 * alone.step, 1e3 * pair.step, 100.0 * alone.step / pair.step,
           100.0 * pair.share);
}

/* Medians of the ratios of so many pairs, one after the other: two ranks wait for the
 * slower one, so that of two runs apart the slower counts, too. */
static void weak_mesh(const char *self, size_t side)
{
    enum { PAIRS = 7 };
    const size_t twice = (size_t)(sqrt(2.0) * (double)side + 0.5);
    double ratio[PAIRS], slower[PAIRS], apart = 0.0, pair = 0.0, share = 0.0;
    for (size_t i = 0; i < PAIRS; ++i) {
        FILE *one = begin_ranks(self, 1, side, 0),
             *other = begin_ranks(self, 1, side, 0);
        const figures a = end_ranks(one), b = end_ranks(other);
        const figures both = on_ranks(self, 2, twice, 0);
        const double alone = 0.5 * (a.step + b.step);
        ratio[i] = alone / both.step;
        slower[i] = fmax(a.step, b.step) / both.step;
        apart += alone / PAIRS, pair += both.step / PAIRS, share += both.share / PAIRS;
    }
    printf("%4zu^2         %9.3f %9.3f  %5.1f %%  %5.1f %%  %5.1f %%\n", side,
           1e3 * apart, 1e3 * pair, 100.0 * bench_median(ratio, PAIRS),
           100.0 * bench_median(slower, PAIRS), 100.0 * share);
}

static void ghosts(size_t side, size_t own)
{
    const size_t size = side * side / own;
    weft_cloth *cloth = triangles(side, size / 2, size);
    const size_t mine = weft_cloth_band(cloth).own * WEFT_BLOCK_VERTICES;
    printf("%8zu  %5.1f %%\n", mine,
           100.0 * (double)(weft_cloth_particles(cloth) - mine) / (double)mine);
    weft_cloth_destroy(cloth);
}

static void meshes(const char *self)
{
    static const size_t owns[] = { 100000, 15625, 3906 };
    puts("triangles, weak, ms per step; a rank has\n"
         "                two apart      pair  mean of two / pair  slower / pair  in "
         "MPI");
    weak_mesh(self, 316);
    puts("own vertices  ghosts");
    for (size_t i = 0; i < sizeof owns / sizeof owns[0]; ++i) {
        ghosts(i == 0 ? 632 : 400, owns[i]);
    }
}

int main(int argc, char **argv)
{
    static const size_t usual[] = { 100, 300, 1000, 2000 };
    static const size_t bands[][2]
        = { { 32, 32 }, { 100, 100 }, { 300, 310 }, { 1000, 1010 }, { 16, 10000 } };
    if (argc == 4 && strcmp(argv[1], "rank") == 0) {
        return be_rank(strtoul(argv[2], NULL, 10), strtoul(argv[3], NULL, 10));
    }
    if (access(BUILD_DIR "/plugins/weft-mpi.so", R_OK) != 0
        || system("command -v mpirun >/dev/null") != 0) {
        puts("mpi: skipped: no weft-mpi.so was built, or there is no mpirun");
        return EXIT_SUCCESS;
    }
    if (argc == 2 && strcmp(argv[1], "mesh") == 0) {
        meshes(argv[0]);
        return EXIT_SUCCESS;
    }
    puts("strong, ms per step\n"
         "          1 thread 2 threads     1 rank   2 ranks   gain   in MPI allreduces "
         "exchanges");
    const size_t most = argc > 1 ? (size_t)argc - 1 : sizeof usual / sizeof usual[0];
    size_t largest = 0;
    for (size_t i = 0; i < most; ++i) {
        const size_t n = argc > 1 ? strtoul(argv[i + 1], NULL, 10) : usual[i];
        strong(argv[0], n);
        largest = n > largest ? n : largest;
    }
    puts("weak, ms per step; a rank has\n"
         "                  one rank      pair   one/pair  in MPI");
    for (size_t i = 0; i < sizeof bands / sizeof bands[0]; ++i) {
        if (bands[i][0] <= largest) {
            weak(argv[0], bands[i][0], bands[i][1]);
        }
    }
    meshes(argv[0]);
    return EXIT_SUCCESS;
}

#else

int main(void)
{
    puts("mpi: needs the plugin arkode");
    return EXIT_SUCCESS;
}

#endif
