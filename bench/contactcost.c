/* SPDX-License-Identifier: BSD-3-Clause */
/* contactcost.c -- what contact costs, as a product: the time with contact is that
 * without times the ratios of steps, of evaluations in a step and of the time of an
 * evaluation. A pile of one cloth, a towel that never touches itself, a sheet on a body
 * of triangles and two garments on one, each under several kinds of methods. The runs
 * without contact keep planes and spheres; they have neither contact.self nor bodies.
 *
 * Arguments: [SCENE|all [METHOD|all [ROUNDS [SECONDS [THREADS]]]]]. Times are medians
 * of the rounds, in which runs with and without contact alternate. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "../tests/bodies.h"
#include "../tests/folded.h"
#include "problem.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_arkode(void);
const weft_plugin *weft_plugin_cvode(void);
const weft_plugin *weft_plugin_stiff(void);
const weft_plugin *weft_plugin_verlet(void);

static weft_error err;

/* ---- scenes ---------------------------------------------------------------------- */

/* A definition and what it points to. */
typedef struct setup {
    weft_cloth_def def;
    folded_shape *start; /* NULL: the cloth starts where it is defined */
    weft_shape shape;
    body_mesh *body;
    weft_scene *scene;
} setup;

static void give_shape(setup *to, weft_shape shape)
{
    to->shape = shape;
    to->def.contact.shapes = &to->shape, to->def.contact.shape_count = 1;
}

static void set_up_pile(setup *to, size_t side)
{
    to->def = folded_model(side, side);
    give_shape(to, weft_shape_default(WEFT_PLANE));
    to->def.origin[1] = 1.0;
    to->start = folded_pile;
}

static void set_up_pile33(setup *to)
{
    set_up_pile(to, 33);
}

static void set_up_pile100(setup *to)
{
    set_up_pile(to, 100);
}

/* 0.6 m wide, 1 cm above a sphere of 0.15 m. */
static void set_up_towel(setup *to)
{
    const size_t side = 30;
    weft_shape ball = weft_shape_default(WEFT_SPHERE);
    ball.at[1] = -0.15, ball.radius = 0.15;
    to->def = folded_model(side, side);
    to->def.spacing[0] = to->def.spacing[1] = 0.6 / (double)(side - 1);
    to->def.origin[0] = to->def.origin[2] = -0.3, to->def.origin[1] = 0.01;
    give_shape(to, ball);
}

/* That of bodies.c from its start: a level sheet above a ball of 20 480 triangles. */
static void set_up_body(setup *to)
{
    to->body = icosphere(5, 0.3);
    to->def = problem(100);
    to->def.pin_count = 0;
    to->def.origin[0] = to->def.origin[2] = -0.5, to->def.origin[1] = 0.304;
    give_shape(to, body_shape(to->body));
}

static void set_up_dressed(setup *to)
{
    weft_scene_def from = weft_scene_def_default();
    weft_diagnostics *found = calloc(1, sizeof *found);
    if (found == NULL) {
        abort();
    }
    from.file = "scenes/dressed.yaml";
    bench_must(weft_scene_load(&from, &to->scene, found, &err), &err);
    to->def = *weft_scene_cloth(to->scene);
    free(found);
}

typedef struct scene {
    const char *name;
    void (*set_up)(setup *to);
    double seconds;    /* [s] simulated */
    double fixed_step; /* [s] of explicit methods in fixed steps */
} scene;
static const scene scenes[] = { { "pile33", set_up_pile33, 0.8, 1e-4 },
                                { "pile100", set_up_pile100, 0.3, 2.5e-5 },
                                { "towel", set_up_towel, 1.0, 1e-4 },
                                { "body", set_up_body, 0.2, 2.5e-5 },
                                { "dressed", set_up_dressed, 0.2, 2.5e-5 } };
enum { SCENES = sizeof scenes / sizeof scenes[0] };

static void set_up(const scene *of, bool contact, setup *to)
{
    *to = (setup){ .start = NULL };
    of->set_up(to);
    while (!contact && to->def.contact.shape_count > 0
           && to->def.contact.shapes[0].kind == WEFT_MESH) { /* bodies come first */
        ++to->def.contact.shapes, --to->def.contact.shape_count;
    }
    to->def.contact.self = to->def.contact.self && contact;
}

static void tear_down(setup *of)
{
    weft_scene_destroy(of->scene);
    free(of->body);
}

/* ---- runs ------------------------------------------------------------------------ */

typedef struct method {
    const char *name;
    const weft_plugin *(*plugin)(void);
    double tolerance;  /* [m]; 0: steps are fixed */
    double velocities; /* [1/s] tolerance of velocities by that of positions */
    double fixed_step; /* [s]; 0: that of the scene */
} method;
static const method methods[]
    = { { "dormand_prince", weft_plugin_arkode, 1e-4, 1.0, 0.0 },
        { "ros2", weft_plugin_stiff, 1e-3, 1000.0, 0.0 },
        { "trbdf2", weft_plugin_arkode, 1e-3, 1000.0, 0.0 },
        { "velocity_verlet", weft_plugin_verlet, 0.0, 1.0, 0.0 },
        { "rkc2", weft_plugin_stiff, 1e-3, 100.0, 0.0 },
        { "backward_euler", weft_plugin_stiff, 0.0, 1.0, 1e-3 },
        { "bdf", weft_plugin_cvode, 1e-3, 100.0, 0.0 } };
enum { METHODS = sizeof methods / sizeof methods[0] };

typedef struct outcome {
    double time; /* [s] of the processor */
    weft_stepper_stats stats;
    weft_measures end;
    uint64_t vetoed;
    size_t crossings;
} outcome;

static void set_start(weft_sim *sim, const setup *of)
{
    const size_t n = of->def.rows * of->def.cols;
    double *xyz = malloc(6 * n * sizeof *xyz);
    if (xyz == NULL) {
        abort();
    }
    folded_start(&of->def, of->start, xyz, xyz + 3 * n);
    bench_must(weft_sim_set_state(sim, xyz, xyz + 3 * n, &err), &err);
    free(xyz);
}

static weft_sim_def configure(const method *by, double scene_step, size_t threads)
{
    weft_sim_def def = weft_sim_def_default();
    def.method = weft_plugin_method(by->plugin(), by->name);
    def.config.threads = threads;
    if (by->tolerance > 0.0) {
        def.config.rtol = def.config.atol_position = by->tolerance;
        def.config.atol_velocity = by->tolerance * by->velocities;
    } else {
        def.config.fixed_step = by->fixed_step > 0.0 ? by->fixed_step : scene_step;
    }
    return def;
}

static outcome run(const scene *of, const method *by, bool contact, size_t threads)
{
    setup it;
    weft_cloth *cloth;
    weft_sim *sim;
    weft_sim_def def = configure(by, of->fixed_step, threads);
    set_up(of, contact, &it);
    bench_must(weft_cloth_create(&it.def, &cloth, &err), &err);
    def.cloth = cloth;
    bench_must(weft_sim_create(&def, &sim, &err), &err);
    if (it.start != NULL) {
        set_start(sim, &it);
    }
    const double began = bench_now();
    bench_must(weft_sim_advance(sim, of->seconds, &err), &err);
    const outcome out
        = { .time = bench_now() - began,
            .stats = weft_sim_stats(sim),
            .end = weft_sim_measure(sim),
            .vetoed = weft_sim_vetoed(sim),
            .crossings = weft_cloth_crossings(cloth, weft_sim_state(sim), NULL) };
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    tear_down(&it);
    return out;
}

/* ---- what is printed ------------------------------------------------------------- */

static double evaluations_of(const outcome *of) /* a step */
{
    return (double)of->stats.rhs_calls / (double)of->stats.steps;
}

static void print_run(const char *how, double seconds, const outcome *of)
{
    printf("  %-7s %8.3f s  %6" PRIu64 " steps  %6.2f evaluations a step  %8.1f us each"
           "  vetoed %4" PRIu64 "  touching %5zu  self %5zu  crossings %zu"
           "  hash %016" PRIx64 "\n",
           how, seconds, of->stats.steps, evaluations_of(of),
           1e6 * seconds / (double)of->stats.rhs_calls, of->vetoed, of->end.touching,
           of->end.self_touching, of->crossings, of->end.hash);
}

static void compare(const scene *of, const method *by, size_t rounds, size_t threads)
{
    double times[2][BENCH_ROUNDS_MAX], medians[2];
    outcome last[2];
    for (size_t r = 0; r < rounds; ++r) {
        for (size_t i = 0; i < 2; ++i) {
            last[i] = run(of, by, i == 1, threads);
            times[i][r] = last[i].time;
        }
    }
    for (size_t i = 0; i < 2; ++i) {
        medians[i] = bench_median(times[i], rounds);
    }
    const double ratio = medians[1] / medians[0];
    const double steps = (double)last[1].stats.steps / (double)last[0].stats.steps;
    const double evaluations = evaluations_of(&last[1]) / evaluations_of(&last[0]);
    printf("%-7s  %-15s  %.2f times the time = steps %.2f x evaluations a step %.2f x "
           "time of an evaluation %.2f\n",
           of->name, by->name, ratio, steps, evaluations,
           ratio / (steps * evaluations));
    print_run("without", medians[0], &last[0]);
    print_run("with", medians[1], &last[1]);
    (void)fflush(stdout);
}

static bool is_meant(const char *argument, const char *name)
{
    return strcmp(argument, "all") == 0 || strcmp(argument, name) == 0;
}

int main(int argc, char **argv)
{
    const char *scene_wanted = argc > 1 ? argv[1] : "all";
    const char *method_wanted = argc > 2 ? argv[2] : "all";
    const size_t asked = argc > 3 ? (size_t)strtoul(argv[3], NULL, 10) : 1;
    const size_t rounds = asked < 1                  ? 1
                          : asked < BENCH_ROUNDS_MAX ? asked
                                                     : BENCH_ROUNDS_MAX;
    const double seconds = argc > 4 ? strtod(argv[4], NULL) : 0.0;
    const size_t threads = argc > 5 ? (size_t)strtoul(argv[5], NULL, 10) : 1;
    bool any = false;
    for (size_t i = 0; i < SCENES * METHODS; ++i) {
        scene of = scenes[i / METHODS];
        const method *by = &methods[i % METHODS];
        if (is_meant(scene_wanted, of.name) && is_meant(method_wanted, by->name)) {
            of.seconds = seconds > 0.0 ? seconds : of.seconds;
            compare(&of, by, rounds, threads);
            any = true;
        }
    }
    if (!any) {
        fprintf(stderr, "usage: contactcost [SCENE|all [METHOD|all [ROUNDS [SECONDS "
                        "[THREADS]]]]]\n");
    }
    return any ? 0 : 2;
}
