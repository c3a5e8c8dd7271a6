/* SPDX-License-Identifier: BSD-3-Clause */
/* ledger.c -- what the energy ledger costs: the run time of a square cloth hung by two
 * corners with and without it. */
#include <stdio.h>
#include <string.h>

#include "bench.h"
#include "weft/weft.h"

const weft_plugin *weft_plugin_verlet(void);
const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);

typedef struct job {
    weft_sim_def def;
    double duration; /* [s] */
} job;

static void run(void *ctx)
{
    const job *self = ctx;
    weft_error err;
    weft_sim *sim = NULL;
    if (weft_sim_create(&self->def, &sim, &err) != WEFT_OK
        || weft_sim_advance(sim, self->duration, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        exit(1);
    }
    weft_sim_destroy(sim);
}

/* 0: springs alone, 1: with damping, 2: with drag and wind too. */
static weft_cloth *make_cloth(size_t side, int forces)
{
    static const weft_pin pins[] = { { .cols = { 0, 0 } }, { .cols = { -1, -1 } } };
    const double c = forces > 0 ? 1.0 : 0.0;
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    def.rows = def.cols = side;
    def.spacing[0] = def.spacing[1] = 1.0 / (double)(side - 1);
    def.springs[WEFT_STRETCH] = (weft_spring_def){ .present = true,
                                                   .stiffness = 100.0,
                                                   .damping = 0.020 * c };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.010 * c };
    def.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.005 * c };
    def.pins = pins;
    def.pin_count = 2;
    def.damping = forces > 1 ? 1e-5 : 0.0;
    def.wind_drag = forces > 1 ? 0.3 : 0.0;
    def.wind_velocity[2] = 2.0;
    if (weft_cloth_create(&def, &cloth, NULL) != WEFT_OK) {
        exit(1);
    }
    return cloth;
}

static void measure(const weft_plugin *plugin, const char *method, double fixed_step,
                    size_t side, double duration, int forces)
{
    static const char *const names[]
        = { "springs", "and damping", "and drag and wind" };
    weft_cloth *cloth = make_cloth(side, forces);
    job jobs[2];
    for (int on = 0; on < 2; ++on) {
        jobs[on].def = weft_sim_def_default();
        jobs[on].def.cloth = cloth;
        jobs[on].def.method = weft_plugin_method(plugin, method);
        jobs[on].def.config.fixed_step = fixed_step;
        jobs[on].def.ledger = on == 1;
        jobs[on].duration = duration;
    }
    bench_case cases[]
        = { { "without", run, &jobs[0], 0.0 }, { "with", run, &jobs[1], 0.0 } };
    bench_interleaved(cases, 2, 9);
    printf("%3zu x %-3zu %-18s %-16s %9.2f ms %+6.1f %%\n", side, side, names[forces],
           method, 1e3 * cases[0].median,
           100.0 * (cases[1].median / cases[0].median - 1.0));
    weft_cloth_destroy(cloth);
}

int main(void)
{
    static const struct {
        size_t side;
        double duration, fixed_step; /* [s] */
    } sizes[] = { { 17, 0.2, 5e-4 }, { 100, 0.01, 1e-4 } };
    puts("cloth     forces             method           without ledger   with it");
    for (int size = 0; size < 2; ++size) {
        for (int forces = 0; forces < 3; ++forces) {
            const size_t side = sizes[size].side;
            const double t = sizes[size].duration, h = sizes[size].fixed_step;
            measure(weft_plugin_verlet(), "velocity_verlet", h, side, t, forces);
#ifdef HAVE_GSL
            measure(weft_plugin_gsl(), "rkf45", 0.0, side, t, forces);
#endif
#ifdef HAVE_ARKODE
            measure(weft_plugin_arkode(), "dormand_prince", 0.0, side, t, forces);
#endif
        }
    }
    return 0;
}
