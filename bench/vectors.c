/* SPDX-License-Identifier: BSD-3-Clause */
/* vectors.c -- what a step of Dormand and Prince's costs beyond its forces: the plugin
 * arkode with its own vector operations, and ERKStep with the NVECTOR_SERIAL of the
 * distribution, on a right-hand side that is constant and takes no time. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

#ifdef HAVE_ARKODE
#include "../plugins/arkode/arkode_plugin.h"
#include "base/thread_pool.h"

const weft_plugin *weft_plugin_arkode(void);

#define RATE     1e-3 /* y' of all components */
#define MAX_STEP 1e-3 /* [s] */

/* Written where it does not stand yet: once for each of the solver's vectors. */
static int constant(double t, const double *y, double *dydt, void *ctx)
{
    const size_t dim = *(const size_t *)ctx;
    (void)t;
    (void)y;
    for (size_t i = 0; dydt[dim - 1] != RATE && i < dim; ++i) {
        dydt[i] = RATE;
    }
    return 0;
}

static void must(bool done, const char *what)
{
    if (!done) {
        fprintf(stderr, "vectors: %s failed\n", what);
        exit(1);
    }
}

/* ---- the plugin ------------------------------------------------------------------ */

typedef struct ours {
    const weft_stepper_type *type;
    size_t dim;
    weft__pool *pool;
    weft_team lent;
    void *stepper;
    double t, *y;
    int steps; /* of one run */
} ours;

static const weft_stepper_type *method(const char *name)
{
    const weft_stepper_type *const *types = weft_plugin_arkode()->types;
    while (strcmp((*types)->name, name) != 0) {
        ++types;
    }
    return *types;
}

static void ours_start(ours *self, size_t dim, size_t threads, int steps)
{
    *self = (ours){ .type = method("dormand_prince"), .dim = dim, .steps = steps };
    self->pool = weft__pool_create(threads, NULL);
    self->lent = (weft_team){ self->pool, weft__pool_run };
    const weft_stepper_config config = {
        .struct_size = sizeof config,
        .rtol = 1e-6,
        .atol_position = 1e-6,
        .atol_velocity = 1e-6,
        .first_step = MAX_STEP,
        .min_step = 1e-12,
        .max_step = MAX_STEP,
        .team = self->pool == NULL ? NULL : &self->lent,
    };
    const weft_ode ode = { .dim = dim, .rhs = constant, .ctx = &self->dim };
    weft_error err;
    self->y = calloc(dim, sizeof *self->y);
    must(self->y != NULL
             && self->type->create(self->type, &ode, &config, &self->stepper, &err)
                    == WEFT_OK,
         "create");
}

static void ours_run(void *ctx)
{
    ours *self = ctx;
    for (int i = 0; i < self->steps; ++i) {
        weft_error err;
        must(self->type->step(self->stepper, 1e9, &self->t, self->y, &err) == WEFT_OK,
             "step");
    }
}

static void ours_end(ours *self)
{
    self->type->destroy(self->stepper);
    weft__pool_destroy(self->pool);
    free(self->y);
}

/* ---- the distribution's ---------------------------------------------------------- */

typedef struct theirs {
    size_t dim;
    SUNContext context;
    N_Vector y;
    void *solver;
    int steps;
} theirs;

static int theirs_rhs(sunrealtype t, N_Vector y, N_Vector ydot, void *ctx)
{
    return constant(t, NV_DATA_S(y), NV_DATA_S(ydot), ctx);
}

static void theirs_start(theirs *self, size_t dim, int steps)
{
    *self = (theirs){ .dim = dim, .steps = steps };
    must(SUNContext_Create(NO_COMM, &self->context) == 0, "SUNContext_Create");
    self->y = N_VNew_Serial((sunindextype)dim, self->context);
    must(self->y != NULL, "N_VNew_Serial");
    N_VConst(0.0, self->y);
    self->solver = ERKStepCreate(theirs_rhs, 0.0, self->y, self->context);
    must(self->solver != NULL
             && ERKStepSetTableNum(self->solver, ARKODE_DORMAND_PRINCE_7_4_5) == 0
             && ERK(SStolerances)(self->solver, 1e-6, 1e-6) == 0
             && ERK(SetUserData)(self->solver, &self->dim) == 0
             && ERK(SetInitStep)(self->solver, MAX_STEP) == 0
             && ERK(SetMaxStep)(self->solver, MAX_STEP) == 0,
         "ERKStep");
}

static void theirs_run(void *ctx)
{
    theirs *self = ctx;
    for (int i = 0; i < self->steps; ++i) {
        sunrealtype t;
        must(ERK(Evolve)(self->solver, 1e9, self->y, &t, ARK_ONE_STEP) == ARK_SUCCESS,
             "Evolve");
    }
}

static void theirs_end(theirs *self)
{
    ERK(Free)(&self->solver);
    N_VDestroy(self->y);
    (void)SUNContext_Free(&self->context);
}

/* ---- both ------------------------------------------------------------------------ */

static void measure(FILE *csv, size_t side, int steps, size_t rounds)
{
    const size_t dim = 6 * side * side;
    ours one, two;
    theirs serial;
    ours_start(&one, dim, 1, steps);
    ours_start(&two, dim, 2, steps);
    theirs_start(&serial, dim, steps);
    bench_case cases[] = { { "threads=1", ours_run, &one, 0.0 },
                           { "threads=2", ours_run, &two, 0.0 },
                           { "nvector_serial", theirs_run, &serial, 0.0 } };
    bench_interleaved(cases, 3, rounds);
    const double theirs_ms = 1e3 * cases[2].median / steps;
    for (size_t i = 0; i < 2; ++i) {
        const double ms = 1e3 * cases[i].median / steps;
        printf("vectors %zux%zu %s: %.4g ms/step, nvector_serial %.4g, ratio %.2f\n",
               side, side, cases[i].name, ms, theirs_ms, theirs_ms / ms);
        fprintf(csv, "%zu,%zu,%.5g,%.5g\n", side, i + 1, ms, theirs_ms);
    }
    ours_end(&one);
    ours_end(&two);
    theirs_end(&serial);
}

int main(void)
{
    FILE *csv = bench_csv("vectors", "side,threads,ms_per_step,nvector_serial_ms");
    measure(csv, 30, 400, 21);
    measure(csv, 100, 40, 21);
    measure(csv, 300, 5, 21);
    return bench_csv_close(csv);
}

#else

int main(void)
{
    puts("vectors: skipped, there is no plugin arkode");
    return 0;
}

#endif
