/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh.c -- cloths of triangles, a jittered sheet of 1 m whose vertices and triangles
 * come in random order: one evaluation of the forces, on every level of instructions,
 * against a naive loop (naive_mesh.h) in that order and in the order of weft, in
 * nanoseconds a vertex; a step of velocity Verlet in evaluations; the time to assemble
 * the bending matrix, to make a cloth and to load an OBJ file. Arguments: sides of
 * sheets instead of all. */
#include "bench.h"

#include <string.h>

#include "cloth/model.h"
#include "levels/levels.h"
#include "sheet.h"
#include "sim/forces.h"
#include "weft/plugins.h"
#include "weft/weft.h"

enum { THREADS = 2, FIGURES = 2 + THREADS, ROUNDS = 21, ROUNDS_LARGE = 5 };

#define NAIVE(level) naive_mesh_##level,
static naive_mesh_fn *const naives[] = { WEFT_LEVELS(NAIVE) };

/* ---- the naive loops ------------------------------------------------------------- */

/* Particle i has number[i] there; in the order of weft number is NULL. */
static uint32_t name(const uint32_t *number, size_t i)
{
    return number != NULL ? number[i] : (uint32_t)i;
}

static naive_triangle naive_of(const weft__triangles *mesh, size_t t,
                               const uint32_t *number)
{
    double of[WEFT__CONSTANTS];
    naive_triangle to;
    weft__membrane_constants(mesh, t, of);
    for (size_t k = 0; k < 6; ++k) {
        to.stiff[k] = of[WEFT__STIFF + k];
    }
    for (size_t k = 0; k < 3; ++k) {
        to.corner[k] = name(number, mesh->corner[t][k]);
        to.square[k] = of[WEFT__SQUARE + k];
    }
    to.least = of[WEFT__LEAST];
    to.lag = of[WEFT__LAG];
    to.guard = of[WEFT__GUARD];
    return to;
}

typedef struct naive {
    naive_mesh of;
    naive_triangle *triangle;
    size_t *row;
    uint32_t *column;
    double *entry, *inverse_mass;
    naive_vec *y, *dydt;
} naive;

/* Adds an entry to a row of so many, by ascending columns. */
static void put(naive *to, size_t row, size_t *count, uint32_t column, double entry)
{
    size_t at = to->row[row] + (*count)++;
    for (; at > to->row[row] && to->column[at - 1] > column; --at) {
        to->column[at] = to->column[at - 1];
        to->entry[at] = to->entry[at - 1];
    }
    to->column[at] = column;
    to->entry[at] = entry;
}

/* The matrix row by row: counts its entries, then takes them. */
static void fill_rows(naive *to, const weft__plate_matrix *of, const uint32_t *number)
{
    const size_t n = of->particles;
    size_t *count = array(n, sizeof *count);
    double *diagonal = array(n, sizeof *diagonal);
    for (size_t pass = 0; pass < 2; ++pass) {
        for (size_t i = 0; i < n; ++i) {
            const weft__plate_row row = weft__plate_row_of(of, i);
            for (size_t j = row.first; j < row.end; ++j) {
                const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
                const uint32_t a = name(number, i), b = name(number, pair.particle);
                for (size_t k = 0; of->entry[j] != 0.0 && k < (pair.own ? 2 : 1); ++k) {
                    if (pass == 0) {
                        ++count[k == 0 ? a : b];
                    } else {
                        put(to, k == 0 ? a : b, &count[k == 0 ? a : b], k == 0 ? b : a,
                            of->entry[j]);
                        diagonal[k == 0 ? a : b] -= of->entry[j];
                    }
                }
            }
        }
        for (size_t i = 0; pass == 0 && i < n; ++i) {
            to->row[i + 1] = to->row[i] + count[i] + 1;
            count[i] = 0;
        }
    }
    for (size_t i = 0; i < n; ++i) {
        put(to, i, &count[i], (uint32_t)i, diagonal[i]);
    }
    free(count), free(diagonal);
}

/* The cloth in the order of its definition, or in that of weft. */
static naive naive_create_mesh(const weft_cloth *cloth, bool file, const double *y)
{
    const weft__triangles *mesh = cloth->mesh.triangles;
    const weft__plate_matrix *matrix = &cloth->plate.matrix;
    const size_t n = cloth->mesh.particles, m = mesh->count;
    const uint32_t *number = file ? mesh->vertex : NULL;
    const size_t most = n + 2 * matrix->first[(n + 3) / WEFT__PLATE_ROWS];
    naive to = { .triangle = array(m, sizeof *to.triangle),
                 .row = array(n + 1, sizeof *to.row),
                 .column = array(most, sizeof *to.column),
                 .entry = array(most, sizeof *to.entry),
                 .inverse_mass = array(n, sizeof(double)),
                 .y = array(2 * n, sizeof *to.y),
                 .dydt = array(2 * n, sizeof *to.dydt) };
    uint32_t *turn = array(m, sizeof *turn);
    number_all(turn, (uint32_t)m, true);
    for (size_t t = 0; t < m; ++t) {
        to.triangle[file ? turn[t] : t] = naive_of(mesh, t, number);
    }
    free(turn);
    for (size_t i = 0; i < n; ++i) {
        const size_t p = file ? mesh->of_vertex[i] : i;
        to.inverse_mass[i] = cloth->mesh.inverse_mass[p];
        to.y[i] = (naive_vec){ y[p], y[n + p], y[2 * n + p] };
        to.y[n + i] = (naive_vec){ y[3 * n + p], y[4 * n + p], y[5 * n + p] };
    }
    fill_rows(&to, matrix, number);
    to.of = (naive_mesh){ .particles = n,
                          .triangles = m,
                          .triangle = to.triangle,
                          .column = to.column,
                          .entry = to.entry,
                          .bend_damping = matrix->tau[0],
                          .inverse_mass = to.inverse_mass,
                          .drag = 1e-6 };
    memcpy(to.of.wind, cloth->wind.air.velocity, sizeof to.of.wind);
    memcpy(to.of.gravity, weft_cloth_def_default().gravity, sizeof to.of.gravity);
    return to;
}

static void naive_free(naive *of)
{
    free(of->triangle), free(of->row), free(of->column), free(of->entry);
    free(of->inverse_mass), free(of->y), free(of->dydt);
}

/* ---- forces ---------------------------------------------------------------------- */

typedef enum variant { MEMBRANE, ALL, DAMPED, WIND, VARIANTS } variant;
static const char *const variant_names[]
    = { "membrane", "membrane + bending", "with damping", "with damping and wind" };

typedef struct subject {
    weft_cloth *cloth;
    weft__forces forces[THREADS];
    naive file, ordered;
    size_t level;
    double *y, *dydt;
    /* switched off by variants */
    size_t *first;
    double tau, wind_drag;
} subject;

static void run_file(subject *at, size_t threads)
{
    (void)threads;
    naives[at->level](&at->file.of, at->file.y, at->file.dydt);
}

static void run_ordered(subject *at, size_t threads)
{
    (void)threads;
    naives[at->level](&at->ordered.of, at->ordered.y, at->ordered.dydt);
}

static void run_forces(subject *at, size_t threads)
{
    (void)weft__forces_rhs(&at->forces[threads - 1], 0.0, at->y, at->dydt);
}

typedef struct figure {
    void (*run)(subject *at, size_t threads);
    size_t threads;
    double median; /* [ns] a vertex */
} figure;

static double now(clockid_t id) /* [s] */
{
    struct timespec t;
    clock_gettime(id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void measure(subject *at, figure *figures)
{
    static double values[FIGURES][ROUNDS];
    const size_t n = at->cloth->mesh.particles, calls = 1 + 100000 / n;
    const size_t rounds = n > 200000 ? ROUNDS_LARGE : ROUNDS;
    for (size_t r = 0; r <= rounds; ++r) { /* the first warms up */
        for (size_t i = 0; i < FIGURES; ++i) {
            const figure *of = &figures[i];
            const clockid_t id
                = of->threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
            const double start = now(id);
            for (size_t c = 0; c < calls; ++c) {
                of->run(at, of->threads);
            }
            values[i][r > 0 ? r - 1 : 0]
                = 1e9 * (now(id) - start) / (double)(calls * n);
        }
    }
    for (size_t i = 0; i < FIGURES; ++i) {
        figures[i].median = bench_median(values[i], rounds);
    }
}

/* Of accelerations, by the largest. */
static double difference(const subject *at, const naive *of, bool file)
{
    const size_t n = at->cloth->mesh.particles;
    const uint32_t *number = file ? at->cloth->mesh.triangles->vertex : NULL;
    double largest = 0.0, error = 0.0;
    for (size_t i = 0; i < n; ++i) {
        const naive_vec a = of->dydt[n + name(number, i)];
        const double *own = at->dydt + 3 * n + i;
        const naive_vec off = { own[0] - a.x, own[n] - a.y, own[2 * n] - a.z };
        largest = fmax(largest, naive_dot(a, a));
        error = fmax(error, naive_dot(off, off));
    }
    return sqrt(error / largest);
}

static void select_variant(subject *at, variant of)
{
    const double tau = of >= DAMPED ? at->tau : 0.0;
    at->cloth->membrane.damped = of >= DAMPED;
    at->cloth->plate.matrix.tau[0] = at->cloth->plate.matrix.tau[1] = tau;
    at->cloth->plate.matrix.first = of > MEMBRANE ? at->first : NULL;
    at->cloth->wind.air.drag = of >= WIND ? at->wind_drag : 0.0;
    naive_mesh *const both[] = { &at->file.of, &at->ordered.of };
    for (size_t i = 0; i < 2; ++i) {
        both[i]->damped = of >= DAMPED;
        both[i]->row = of > MEMBRANE ? (i == 0 ? at->file.row : at->ordered.row) : NULL;
        both[i]->wind_drag = of >= WIND ? at->wind_drag : 0.0;
    }
}

static void report(FILE *csv, const subject *at, size_t side, variant of,
                   const figure *figures)
{
    const char *level = weft__isa_name((weft__isa)(at->level + 1));
    const double file = figures[0].median, ordered = figures[1].median;
    const double one = figures[2].median, two = figures[3].median;
    printf("mesh %zux%zu %s %s: %.2f ns/vertex, naive %.1f (%.1f times) in the file's "
           "order, %.1f (%.1f times) in weft's; two threads %.2f, %.2f times; "
           "differences %.1e %.1e\n",
           side, side, variant_names[of], level, one, file, file / one, ordered,
           ordered / one, two, one / two, difference(at, &at->file, true),
           difference(at, &at->ordered, false));
    fflush(stdout);
    fprintf(csv, "%s,%zu,%s,%.3f,%.3f,%.3f,%.3f\n", level, side, variant_names[of], one,
            two, file, ordered);
}

/* Strained a little, in waves and in motion. */
static double *state_of(const weft_cloth *cloth, size_t side)
{
    const size_t n = cloth->mesh.particles;
    double *y = array(6 * n, sizeof *y);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < n; ++i) {
        const double u = y[i], v = y[n + i];
        y[2 * n + i] = 0.1 * sin(5.0 * u) * cos(3.0 * v);
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + i] += 0.05 / (double)side * sin(1.7 * (double)(i % 1009 + k));
            y[(k + 3) * n + i] = 0.1 * cos(5.0 * v + (double)k);
        }
    }
    return y;
}

static void measure_forces(FILE *csv, const sheet *of)
{
    subject at = { .cloth = sheet_cloth(of, 1e-5) };
    at.y = state_of(at.cloth, of->side);
    at.dydt = array(6 * at.cloth->mesh.particles, sizeof *at.dydt);
    at.first = at.cloth->plate.matrix.first;
    at.tau = at.cloth->plate.matrix.tau[0];
    at.wind_drag = at.cloth->wind.air.drag;
    at.file = naive_create_mesh(at.cloth, true, at.y);
    at.ordered = naive_create_mesh(at.cloth, false, at.y);
    for (size_t i = 0; i < THREADS; ++i) {
        at.forces[i] = weft__forces_create(at.cloth, i + 1, NULL);
    }
    for (at.level = 0; at.level < (size_t)weft__isa_last(); ++at.level) {
        weft__cloth_choose(at.cloth, (weft__isa)(at.level + 1));
        for (variant v = MEMBRANE; v < VARIANTS; ++v) {
            figure figures[FIGURES] = { { run_file, 1, 0.0 },
                                        { run_ordered, 1, 0.0 },
                                        { run_forces, 1, 0.0 },
                                        { run_forces, 2, 0.0 } };
            select_variant(&at, v);
            measure(&at, figures);
            report(csv, &at, of->side, v, figures);
        }
    }
    select_variant(&at, WIND);
    for (size_t i = 0; i < THREADS; ++i) {
        weft__forces_destroy(&at.forces[i]);
    }
    naive_free(&at.file), naive_free(&at.ordered);
    free(at.y), free(at.dydt);
    weft_cloth_destroy(at.cloth);
}

/* ---- steps, assembly and files --------------------------------------------------- */

const weft_plugin *weft_plugin_verlet(void);

typedef struct stepping {
    subject at;
    weft_sim *sim;
    size_t calls;
} stepping;

static void run_steps(void *ctx)
{
    stepping *of = ctx;
    weft_error err;
    for (size_t i = 0; i < of->calls; ++i) {
        bench_must(weft_sim_step(of->sim, 1e9, &err), &err);
    }
}

static void run_evaluations(void *ctx)
{
    stepping *of = ctx;
    for (size_t i = 0; i < of->calls; ++i) {
        run_forces(&of->at, 1);
    }
}

static void measure_step(const sheet *of)
{
    stepping s = { .at.cloth = sheet_cloth(of, 1e-5) };
    weft_error err;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = s.at.cloth;
    def.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    def.config.fixed_step = 1e-9; /* the state stays as it is */
    bench_must(weft_sim_create(&def, &s.sim, &err), &err);
    s.calls = 1 + 100000 / s.at.cloth->mesh.particles;
    s.at.y = state_of(s.at.cloth, of->side);
    s.at.dydt = array(6 * s.at.cloth->mesh.particles, sizeof *s.at.dydt);
    s.at.forces[0] = weft__forces_create(s.at.cloth, 1, NULL);
    bench_case cases[]
        = { { "step", run_steps, &s, 0.0 }, { "force", run_evaluations, &s, 0.0 } };
    bench_interleaved(cases, 2, ROUNDS);
    printf("verlet %zux%zu: a step takes %.2f evaluations\n", of->side, of->side,
           cases[0].median / cases[1].median);
    weft_sim_destroy(s.sim);
    weft__forces_destroy(&s.at.forces[0]);
    free(s.at.y), free(s.at.dydt);
    weft_cloth_destroy(s.at.cloth);
}

static void measure_creation(const sheet *of)
{
    const double start = now(CLOCK_THREAD_CPUTIME_ID);
    weft_cloth *cloth = sheet_cloth(of, 1e-5);
    const double made = now(CLOCK_THREAD_CPUTIME_ID);
    const weft__mesh *mesh = &cloth->mesh;
    const weft_allocator memory = weft_allocator_or_malloc(NULL);
    weft__plate_matrix matrix = { 0 };
    (void)weft__plate_matrix_create(&matrix, mesh->triangles, mesh->particles,
                                    mesh->pin, NULL, &memory);
    printf("create %zux%zu: %.2f s, of which the bending matrix %.2f s\n", of->side,
           of->side, made - start, now(CLOCK_THREAD_CPUTIME_ID) - made);
    weft__plate_matrix_free(&matrix, &memory);
    weft_cloth_destroy(cloth);
}

static void write_files(const sheet *of, const char *obj, const char *scene)
{
    FILE *to = fopen(obj, "w"), *yaml = fopen(scene, "w");
    if (to == NULL || yaml == NULL) {
        perror(obj);
        exit(1);
    }
    for (size_t i = 0; i < of->side * of->side; ++i) {
        const double *x = &of->start[3 * i], *u = &of->rest[2 * i];
        fprintf(to, "v %.8f %.8f %.8f\nvt %.8f %.8f\n", x[0], x[1], x[2], u[0], u[1]);
    }
    for (size_t t = 0; t < 2 * (of->side - 1) * (of->side - 1); ++t) {
        const uint32_t *c = &of->corners[3 * t];
        fprintf(to, "f %u/%u %u/%u %u/%u\n", c[0] + 1, c[0] + 1, c[1] + 1, c[1] + 1,
                c[2] + 1, c[2] + 1);
    }
    fprintf(yaml,
            "weft: 1\ncloth:\n  mesh: {file: mesh.obj}\n"
            "  fabric: {preset: 11oz-black-denim}\n"
            "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-6}\n"
            "run: {duration: 1, fps: 30}\n");
    if (fclose(to) != 0 || fclose(yaml) != 0) {
        perror(obj);
        exit(1);
    }
}

static void measure_load(size_t side, bool shuffled)
{
    sheet of = sheet_create(side, shuffled);
    const char *scene = BUILD_DIR "/bench/mesh.yaml",
               *obj = BUILD_DIR "/bench/mesh.obj";
    double times[3];
    write_files(&of, obj, scene);
    sheet_destroy(&of);
    for (size_t i = 0; i < 3; ++i) {
        weft_error err = { 0 };
        weft_scene_def def = weft_scene_def_default();
        weft_diagnostics found = { 0 };
        weft_scene *loaded;
        def.file = scene;
        const double start = now(CLOCK_THREAD_CPUTIME_ID);
        bench_must(weft_scene_load(&def, &loaded, &found, &err), &err);
        times[i] = now(CLOCK_THREAD_CPUTIME_ID) - start;
        weft_scene_destroy(loaded);
    }
    printf("load %zux%zu: %.2f s, %s\n", side, side, bench_median(times, 3),
           shuffled ? "in random order" : "row by row");
    (void)remove(scene);
    (void)remove(obj);
}

int main(int argc, char **argv)
{
    static const size_t sides[] = { 32, 100, 316, 1000 };
    const size_t count = argc > 1 ? (size_t)argc - 1 : sizeof sides / sizeof *sides;
    FILE *csv = bench_csv("mesh", "level,side,forces,ns_per_vertex,two_threads_ns,"
                                  "naive_file_ns,naive_ordered_ns");
    for (size_t i = 0; i < count; ++i) {
        const size_t side = argc > 1 ? (size_t)atoi(argv[i + 1]) : sides[i];
        sheet of = sheet_create(side, true);
        measure_forces(csv, &of);
        measure_step(&of);
        measure_creation(&of);
        sheet_destroy(&of);
        measure_load(side, true);
        measure_load(side, false);
    }
    return bench_csv_close(csv);
}
