/* SPDX-License-Identifier: BSD-3-Clause */
/* realtime.c -- cloth in a loop of 60 frames a second: what a frame costs one core, by
 * size and stretch stiffness, and what each choice adds. A curtain of 1 m x 1.5 m and
 * 0.2 kg/m^2, held along its top in a wind of 4 m/s; fixed steps, 0.9 of the largest
 * stable one. The processor's time, as others may be at work. */
#include <time.h>
#define BENCH_CLOCK CLOCK_THREAD_CPUTIME_ID

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_verlet(void);

enum { FPS = 60, FRAMES = 60, ROUNDS = 3 };

#define DAMPING 0.05 /* unless it is said */

static const double height = 1.0, width = 1.5; /* [m] */
static const double density = 0.2;             /* [kg/m^2] */
static const double wind[3] = { 1.0, 0.0, 4.0 }, wind_drag = 0.3;

/* What the cloth meets in `force` and `correct`, and its grid. */
typedef struct world {
    size_t rows, cols, first, end; /* particles that are not pinned */
    double radius, centre[3];      /* [m] of a sphere that it leans on */
} world;

typedef struct choice {
    const char *name, *method;
    double stiffness; /* [N/m] of stretch; of shear half, of bend a twentieth */
    bool lumped;      /* masses by area, light along the rim, instead of equal */
    double damping;   /* of springs, part of what is critical for two particles */
    bool own_wind;    /* the same wind in `force` instead of the cloth's own */
    bool sphere;      /* in `correct` */
    bool taut;        /* held below too, and the sphere stands in the way */
    double limit;     /* strain of Provot's limit; 0: none */
    weft_cloth_def def;
    double h, mean, worst; /* [s] step; of a frame, out */
    double sweeps, unmet;  /* of the limit: a step; part of the steps, out */
    const char *isa;       /* instructions of the kernels, out */
} choice;

/* ---- callbacks, as one writes them first ----------------------------------------- */

static void edge(const double *y, size_t n, size_t p, size_t q, double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = y[k * n + q] - y[k * n + p];
    }
}

/* F = drag area (u . n) n on a triangle, u relative to it, a third to each corner. */
static void blow(const double *y, size_t n, const size_t at[3], double *f)
{
    double a[3], b[3], u[3];
    edge(y, n, at[0], at[1], a);
    edge(y, n, at[0], at[2], b);
    const double s[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                          a[0] * b[1] - a[1] * b[0] };
    const double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    double along = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double *v = y + (3 + k) * n;
        u[k] = wind[k] - (v[at[0]] + v[at[1]] + v[at[2]]) / 3.0;
        along += u[k] * s[k];
    }
    for (size_t k = 0; k < 3 && length > 0.0; ++k) {
        const double third = wind_drag * along * s[k] / length / 6.0;
        for (size_t i = 0; i < 3; ++i) {
            f[k * n + at[i]] += third;
        }
    }
}

static int own_wind(void *ctx, double t, const double *y, double *f)
{
    const world *of = ctx;
    const size_t n = of->rows * of->cols;
    (void)t;
    for (size_t r = 0; r + 1 < of->rows; ++r) {
        for (size_t c = 0; c + 1 < of->cols; ++c) {
            const size_t p = r * of->cols + c, q = p + of->cols;
            blow(y, n, (const size_t[3]){ p, q, p + 1 }, f);
            blow(y, n, (const size_t[3]){ p + 1, q, q + 1 }, f);
        }
    }
    return 0;
}

/* Out of the sphere along its radius; nothing of the velocity points inwards. */
static bool keep_out(void *ctx, double t, double h, double *y)
{
    const world *of = ctx;
    const size_t n = of->rows * of->cols;
    bool changed = false;
    (void)t;
    (void)h;
    for (size_t i = of->first; i < of->end; ++i) {
        double d[3], square = 0.0, inwards = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            d[k] = y[k * n + i] - of->centre[k];
            square += d[k] * d[k];
            inwards += d[k] * y[(3 + k) * n + i];
        }
        if (square >= of->radius * of->radius || !(square > 0.0)) {
            continue;
        }
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + i] = of->centre[k] + d[k] * of->radius / sqrt(square);
            y[(3 + k) * n + i] -= fmin(inwards, 0.0) / square * d[k];
        }
        changed = true;
    }
    return changed;
}

/* ---- a run ------------------------------------------------------------------------
 */

static void describe(choice *self, size_t rows, size_t cols)
{
    static const weft_pin edges[] = { { .rows = { 0, 0 }, .cols = { 0, -1 } },
                                      { .rows = { -1, -1 }, .cols = { 0, -1 } } };
    static const double parts[WEFT_FAMILIES] = { 1.0, 0.5, 0.05 };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows;
    def.cols = cols;
    def.spacing[0] = height / (double)(rows - 1);
    def.spacing[1] = width / (double)(cols - 1);
    const double mass = density * height * width / (double)(rows * cols);
    def.mass = self->lumped ? 0.0 : mass;
    def.density = self->lumped ? density : 0.0;
    def.pins = edges;
    def.pin_count = self->taut ? 2 : 1;
    def.damping = 0.2 * mass; /* 1/s of the mass */
    if (!self->own_wind) {
        memcpy(def.wind_velocity, wind, sizeof wind);
        def.wind_drag = wind_drag;
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const double k = self->stiffness * parts[i];
        /* 5 % of what is critical for two particles on this spring */
        const double c = self->damping * sqrt(2.0 * k * mass);
        def.springs[i]
            = (weft_spring_def){ .present = true, .stiffness = k, .damping = c };
    }
    self->def = def;
}

static double stable_step(const weft_cloth *cloth, const weft_stepper_type *type)
{
    weft_error err = { 0 };
    weft_stability stability;
    double h = 0.0;
    double *y = calloc(weft_cloth_dim(cloth), sizeof *y);
    if (y == NULL) {
        abort();
    }
    weft_cloth_start(cloth, y);
    const weft_stiffness modes = weft_cloth_stiffness(cloth, 0.0, y);
    free(y);
    bench_must(weft_stability_create(type, NULL, &stability, &err), &err);
    bench_must(weft_stability_step(&stability, &modes, 0.0, &h, &err), &err);
    return h;
}

static void run(choice *self, const weft_cloth *cloth, double frames[FRAMES])
{
    weft_error err = { 0 };
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    world around = { .rows = self->def.rows,
                     .cols = self->def.cols,
                     .first = self->def.cols,
                     .end = self->def.cols * (self->def.rows - self->taut),
                     .radius = 0.3,
                     .centre = { 0.75, -0.6, self->taut ? 0.15 : 0.35 } };
    def.cloth = cloth;
    def.method = weft_plugin_method(weft_plugin_verlet(), self->method);
    def.config.fixed_step = self->h = 0.9 * stable_step(cloth, def.method);
    def.force = self->own_wind ? own_wind : NULL;
    def.correct = self->sphere ? keep_out : NULL;
    def.force_ctx = def.correct_ctx = &around;
    def.limit.method = self->limit > 0.0 ? WEFT_LIMIT_PROVOT : WEFT_LIMIT_NONE;
    def.limit.strain = self->limit > 0.0 ? self->limit : def.limit.strain;
    bench_must(weft_sim_create(&def, &sim, &err), &err);
    for (int i = 0; i < FRAMES; ++i) {
        const double began = bench_now();
        bench_must(weft_sim_advance(sim, (i + 1.0) / FPS, &err), &err);
        frames[i] = bench_now() - began;
    }
    const weft_limit_stats limit = weft_sim_limit_stats(sim);
    const double steps = (double)weft_sim_stats(sim).steps;
    self->sweeps = (double)limit.sweeps / steps;
    self->unmet = (double)limit.unconverged / steps;
    weft_sim_destroy(sim);
}

/* The median over rounds of the mean frame, and of the worst one. */
static void measure(choice *self, size_t rows, size_t cols)
{
    double frames[FRAMES], mean[ROUNDS], worst[ROUNDS];
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    describe(self, rows, cols);
    bench_must(weft_cloth_create(&self->def, &cloth, &err), &err);
    for (int r = 0; r < ROUNDS; ++r) {
        run(self, cloth, frames);
        mean[r] = worst[r] = 0.0;
        for (int i = 0; i < FRAMES; ++i) {
            mean[r] += frames[i] / FRAMES;
            worst[r] = fmax(worst[r], frames[i]);
        }
    }
    self->isa = weft_cloth_isa(cloth);
    weft_cloth_destroy(cloth);
    self->mean = bench_median(mean, ROUNDS);
    self->worst = bench_median(worst, ROUNDS);
}

/* ---- tables ------------------------------------------------------------------------
 */

static void sizes_and_stiffness(FILE *csv)
{
    static const size_t sides[][2] = { { 20, 30 }, { 40, 60 }, { 80, 120 } };
    static const double stiffness[] = { 200.0, 1000.0, 5000.0, 20000.0 };
    puts("ms a frame of 16.7 ms   symplectic_euler       velocity_verlet\n"
         "cloth     stretch N/m   ms     step us          ms     step us");
    for (size_t s = 0; s < 3; ++s) {
        for (size_t k = 0; k < 4; ++k) {
            choice both[2]
                = { { .method = "symplectic_euler" }, { .method = "velocity_verlet" } };
            printf("%2zu x %-3zu %8.0f  ", sides[s][0], sides[s][1], stiffness[k]);
            for (size_t m = 0; m < 2; ++m) {
                both[m].stiffness = stiffness[k];
                both[m].damping = DAMPING;
                measure(&both[m], sides[s][0], sides[s][1]);
                printf("  %8.2f  %8.1f   ", 1e3 * both[m].mean, 1e6 * both[m].h);
                fprintf(csv, "%zux%zu,%s,%g,%.6g,%.6g,%.6g\n", sides[s][0], sides[s][1],
                        both[m].method, stiffness[k], both[m].h, both[m].mean,
                        both[m].worst);
            }
            putchar('\n');
            (void)fflush(stdout);
        }
    }
}

static void choices(FILE *csv)
{
    choice list[] = {
        { .name = "equal masses, damped, wind of the cloth" },
        { .name = "velocity_verlet", .method = "velocity_verlet" },
        { .name = "density instead of mass", .lumped = true },
        { .name = "damping of 50 %", .damping = 0.5 },
        { .name = "damping of 50 %, velocity_verlet",
          .damping = 0.5,
          .method = "velocity_verlet" },
        { .name = "wind of one's own in force", .own_wind = true },
        { .name = "a sphere in correct", .sphere = true },
        { .name = "limit of 5 %", .limit = 0.05 },
        { .name = "limit of 5 %, sphere", .limit = 0.05, .sphere = true },
        { .name = "limit of 1 %, sphere", .limit = 0.01, .sphere = true },
        { .name = "held below too, limit of 1 %, sphere",
          .limit = 0.01,
          .sphere = true,
          .taut = true },
        { .name = "held below too, sphere", .sphere = true, .taut = true },
        { .name = "200 N/m, limit of 0.5 %", .limit = 0.005, .stiffness = 200.0 },
    };
    printf("\n%-40s     ms  worst frame  step us  sweeps  not met\n",
           "40 x 60, 1000 N/m, symplectic_euler");
    for (size_t i = 0; i < sizeof list / sizeof *list; ++i) {
        list[i].stiffness = list[i].stiffness > 0.0 ? list[i].stiffness : 1000.0;
        list[i].damping = list[i].damping > 0.0 ? list[i].damping : DAMPING;
        list[i].method = list[i].method == NULL ? "symplectic_euler" : list[i].method;
        measure(&list[i], 40, 60);
        printf("%-40s %6.2f  %11.2f  %7.1f  %6.1f  %5.0f %%\n", list[i].name,
               1e3 * list[i].mean, 1e3 * list[i].worst, 1e6 * list[i].h, list[i].sweeps,
               100.0 * list[i].unmet);
        fprintf(csv, "%s,%s,%g,%.6g,%.6g,%.6g\n", list[i].name, list[i].method,
                list[i].stiffness, list[i].h, list[i].mean, list[i].worst);
        (void)fflush(stdout);
    }
    printf("instructions: %s\n", list[0].isa);
}

int main(int argc, char **argv)
{
    FILE *csv = bench_csv("realtime", "cloth,method,stiffness,step,mean,worst");
    if (argc < 2 || strcmp(argv[1], "sizes") == 0) {
        sizes_and_stiffness(csv);
    }
    if (argc < 2 || strcmp(argv[1], "choices") == 0) {
        choices(csv);
    }
    return bench_csv_close(csv);
}
