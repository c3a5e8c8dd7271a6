/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies.c -- what a body of 20 480 triangles adds to a step of a sheet of 10 000
 * particles of which a tenth touches it, by the time of an evaluation of the forces
 * without contact; and where an evaluation of the body's forces spends it. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include <math.h>

#include "../tests/bodies.h"
#include "forces/contact/self/self_list.h"
#include "problem.h"
#include "sim/simulation.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_verlet(void);
const weft_plugin *weft_plugin_arkode(void);

enum { SIDE = 100, N = SIDE * SIDE, ROUNDS = 3, STEPS = 50, WARM = 10 };

static weft_error err;

/* A level sheet on the top of a ball; without it the same. */
static weft_cloth *cloth_of(bool touches)
{
    weft_cloth_def def = problem(SIDE);
    weft_cloth *out;
    body_mesh *ball = icosphere(5, 0.3);
    weft_shape shape = body_shape(ball);
    def.pin_count = 0;
    def.origin[0] = def.origin[2] = -0.5, def.origin[1] = 0.304;
    def.contact.shapes = &shape, def.contact.shape_count = touches;
    bench_must(weft_cloth_create(&def, &out, &err), &err);
    free(ball);
    return out;
}

static weft_sim *start(const weft_cloth *cloth, const weft_stepper_type *method,
                       double fixed, const double *xyz)
{
    weft_sim *out;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth, def.method = method;
    def.config.fixed_step = fixed;
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = 1e-4;
    bench_must(weft_sim_create(&def, &out, &err), &err);
    if (xyz != NULL) {
        bench_must(weft_sim_set_state(out, xyz, xyz + 3 * N, &err), &err);
    }
    return out;
}

typedef struct trial {
    const weft_cloth *cloth;
    const weft_stepper_type *method;
    double fixed;
    const double *xyz;          /* and velocities */
    double step, calls, length; /* medians [s]; evaluations a step; mean step [s] */
    size_t vetoed;
} trial;

/* Steps from a state, interleaved with those of the other trial. */
static void compare(trial *trials, size_t count)
{
    double times[2][ROUNDS];
    for (size_t r = 0; r < ROUNDS; ++r) {
        for (size_t i = 0; i < count; ++i) {
            trial *of = &trials[i];
            weft_sim *sim = start(of->cloth, of->method, of->fixed, of->xyz);
            for (size_t k = 0; k < WARM; ++k) {
                bench_must(weft_sim_step(sim, 1.0, &err), &err);
            }
            const weft_stepper_stats before = weft_sim_stats(sim);
            const double began = bench_now(), t = weft_sim_time(sim);
            for (size_t k = 0; k < STEPS; ++k) {
                bench_must(weft_sim_step(sim, 1.0, &err), &err);
            }
            times[i][r] = (bench_now() - began) / STEPS;
            of->calls
                = (double)(weft_sim_stats(sim).rhs_calls - before.rhs_calls) / STEPS;
            of->length = (weft_sim_time(sim) - t) / STEPS;
            of->vetoed = weft_sim_vetoed(sim);
            weft_sim_destroy(sim);
        }
    }
    for (size_t i = 0; i < count; ++i) {
        trials[i].step = bench_median(times[i], ROUNDS);
    }
}

static void report(const char *name, const trial of[2], double evaluation)
{
    const double more = of[1].step - of[0].step;
    printf("%-15s %7.1f us a step without, %7.1f with the body, of %.1f and %.1f "
           "evaluations, %.3g s: the body adds %.2f evaluations a step, %.2f for each "
           "evaluation; %zu steps taken back\n",
           name, 1e6 * of[0].step, 1e6 * of[1].step, of[0].calls, of[1].calls,
           of[1].length, more / evaluation, more / evaluation / of[1].calls,
           of[1].vetoed);
}

static weft__bodies_space *space_of(const weft__forces *forces)
{
    return forces->spaces[WEFT__FORCE_bodies];
}

typedef struct part {
    const weft_cloth *cloth;
    weft__forces *forces;
    const double *y, *place; /* of all points */
    weft__path path;
    double out[6 * N];
} part;

static void evaluate(void *ctx)
{
    part *of = ctx;
    (void)weft__forces_rhs(of->forces, 0.0, of->y, of->out);
}

static void bodies(void *ctx)
{
    part *of = ctx;
    const weft__state at = { .t = 0.0, .y = of->y };
    (void)weft__bodies_force.whole.add(&of->cloth->bodies, space_of(of->forces), &at,
                                       WEFT__ACCELERATION, of->out);
}

static void drift(void *ctx)
{
    part *of = ctx;
    weft__self_list *list = space_of(of->forces)->list;
    (void)weft__self_drift(list, list->place, of->place, 0);
}

static void pushes(void *ctx)
{
    part *of = ctx;
    weft__self_list *list = space_of(of->forces)->list;
    const weft__self_law law = weft__self_law_of(list->own);
    double bad = 0.0;
    for (size_t i = 0; i < list->chunk_count; ++i) {
        weft__self_chunk *in = &list->chunks[i];
        for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
            (void)list->own->pushes(&law, (weft__pair_kind)kind,
                                    &in->bins[kind].before.near, in->before.subsets,
                                    in->now.count, of->place, in->bins[kind].pushes,
                                    &bad);
        }
    }
}

static void check(void *ctx)
{
    part *of = ctx;
    weft__penetration penetration;
    (void)weft__bodies_clear(&of->cloth->bodies, space_of(of->forces), &of->path,
                             &penetration);
}

static void make(void *ctx)
{
    part *of = ctx;
    space_of(of->forces)->list->valid = false;
    bodies(of);
}

static void count_pairs(const weft__self_list *list)
{
    size_t listed = 0, pushing = 0, groups = 0;
    for (size_t i = 0; i < list->chunk_count; ++i) {
        groups += list->chunks[i].now.count;
        for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
            listed += list->chunks[i].bins[kind].now.count;
            pushing += list->chunks[i].bins[kind].pushing;
        }
    }
    printf("%zu pairs listed in %zu groups, %zu push\n", listed, groups, pushing);
}

int main(void)
{
    weft_cloth *cloths[2] = { cloth_of(false), cloth_of(true) };
    weft_sim *sim
        = start(cloths[1], weft_plugin_method(weft_plugin_arkode(), "dormand_prince"),
                0.0, NULL);
    while (weft_sim_measure(sim).touching < N / 10) {
        bench_must(weft_sim_advance(sim, weft_sim_time(sim) + 1e-3, &err), &err);
    }
    static double y[6 * N], xyz[6 * N];
    memcpy(y, weft_sim_state(sim), sizeof y);
    for (size_t j = 0; j < 6 * N; ++j) {
        xyz[j / (3 * N) * 3 * N + 3 * (j % N) + j / N % 3] = y[j];
    }
    weft__forces forces[2] = { weft__forces_create(cloths[0], 1, NULL),
                               weft__forces_create(cloths[1], 1, NULL) };
    static part parts[2];
    for (size_t i = 0; i < 2; ++i) {
        parts[i].cloth = cloths[i], parts[i].forces = &forces[i], parts[i].y = y;
    }
    printf("%zu of %d particles touch after %.3g s\n", weft_sim_measure(sim).touching,
           N, weft_sim_time(sim));
    bench_must(weft_sim_step(sim, 1.0, &err), &err);
    parts[1].path = (weft__path){ 0.0, 1e-4, y, weft_sim_state(sim) };
    for (size_t i = 0; i < 3; ++i) {
        evaluate(&parts[1]);
        bench_must(weft__self_list_grow(space_of(&forces[1])->list, &err), &err);
    }
    parts[1].place = space_of(&forces[1])->now.y;
    bench_case cases[]
        = { { "an evaluation without contact", evaluate, &parts[0], 0.0 },
            { "the body's forces, the list kept", bodies, &parts[1], 0.0 },
            { "  of which displacements", drift, &parts[1], 0.0 },
            { "  of which pairs", pushes, &parts[1], 0.0 },
            { "the check of a step", check, &parts[1], 0.0 },
            { "the list made from nothing", make, &parts[1], 0.0 } };
    bench_interleaved(cases, sizeof cases / sizeof cases[0], 15);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        printf("%-34s %8.1f us, %6.2f evaluations\n", cases[i].name,
               1e6 * cases[i].median, cases[i].median / cases[0].median);
    }
    count_pairs(space_of(&forces[1])->list);
    trial trials[2]
        = { { .cloth = cloths[0], .xyz = xyz }, { .cloth = cloths[1], .xyz = xyz } };
    for (size_t m = 0; m < 2; ++m) {
        const weft_stepper_type *method
            = m == 0 ? weft_plugin_method(weft_plugin_verlet(), "velocity_verlet")
                     : weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
        for (size_t i = 0; i < 2; ++i) {
            trials[i].method = method, trials[i].fixed = m == 0 ? 2.5e-5 : 0.0;
        }
        compare(trials, 2);
        report(m == 0 ? "velocity_verlet" : "dormand_prince", trials, cases[0].median);
    }
    weft_sim_destroy(sim);
    for (size_t i = 0; i < 2; ++i) {
        weft__forces_destroy(&forces[i]);
        weft_cloth_destroy(cloths[i]);
    }
    return 0;
}
