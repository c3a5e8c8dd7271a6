/* SPDX-License-Identifier: BSD-3-Clause */
/* pairs.c -- the same Runge-Kutta pair by GSL and by ARKODE on the same cloths: time a
 * simulated second, steps, evaluations of the forces, and how far from a solution of
 * far smaller tolerance each is at the end. */
#define BENCH_CLOCK CLOCK_PROCESS_CPUTIME_ID
#include "bench.h"

#include "weft/weft.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#if defined(HAVE_GSL) && defined(HAVE_ARKODE)

const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);

/* 1 m x 1 m that hangs by two corners, let go level. */
typedef struct sheet {
    const char *name;
    size_t side;
    double stiffness; /* [N/m] of stretch; shear a half, bend a hundredth */
    double damping;   /* [N s/m] of stretch; shear a half */
    double duration;  /* [s] */
    double fixed;     /* [s] step at which all are stable */
    size_t rounds;
    weft_cloth *cloth;
} sheet;

static sheet sheets[] = {
    { "17x17", 17, 100.0, 0.02, 0.2, 1e-3, 7, NULL },
    { "17x17 stiff", 17, 1e5, 2.0, 0.02, 2.5e-5, 7, NULL },
    { "100x100", 100, 100.0, 0.02, 0.01, 1e-4, 3, NULL },
    { "300x300", 300, 100.0, 0.02, 1e-3, 2.5e-5, 3, NULL },
};

static const double tolerances[] = { 1e-4, 1e-5, 1e-6, 1e-7, 1e-8 };

typedef struct pair {
    const char *gsl, *arkode;
} pair;

static const pair pairs[] = { { "rkf45", "fehlberg45" }, { "rkck", "cash_karp" } };

typedef struct trial {
    const sheet *sheet;
    const weft_stepper_type *method;
    weft_stepper_config config;
    weft_sim *sim; /* of the last run */
} trial;

static const weft_stepper_type *method(const weft_plugin *plugin, const char *name)
{
    const weft_stepper_type *const *types = plugin->types;
    while (strcmp((*types)->name, name) != 0) {
        ++types;
    }
    return *types;
}

static void make_cloth(sheet *of)
{
    const ptrdiff_t last = (ptrdiff_t)of->side - 1;
    const weft_pin corners[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                 { .rows = { 0, 0 }, .cols = { last, last } } };
    const double k = of->stiffness, c = of->damping;
    weft_cloth_def def = weft_cloth_def_default();
    weft_error err = { 0 };
    def.rows = def.cols = of->side;
    def.spacing[0] = def.spacing[1] = 1.0 / (double)last;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = k, .damping = c };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ .present = true,
                                                 .stiffness = 0.5 * k,
                                                 .damping = 0.5 * c };
    def.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 0.01 * k, .damping = 0.0 };
    def.down[1] = 0.0;
    def.down[2] = 1.0;
    def.pins = corners;
    def.pin_count = 2;
    bench_must(weft_cloth_create(&def, &of->cloth, &err), &err);
}

/* A simulation from the start to the end, in frames of 1/100 s. */
static void run(void *ctx)
{
    trial *self = ctx;
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = self->sheet->cloth;
    def.method = self->method;
    def.config = self->config;
    weft_sim_destroy(self->sim);
    bench_must(weft_sim_create(&def, &self->sim, &err), &err);
    const int frames = (int)ceil(100.0 * self->sheet->duration);
    for (int i = 1; i <= frames; ++i) {
        bench_must(
            weft_sim_advance(self->sim, self->sheet->duration * i / frames, &err),
            &err);
    }
}

/* [m] */
static double apart(const trial *a, const trial *b)
{
    const size_t n = weft_cloth_particles(a->sheet->cloth);
    const double *x = weft_sim_state(a->sim), *y = weft_sim_state(b->sim);
    double most = 0.0;
    for (size_t i = 0; i < 3 * n; ++i) {
        most = fmax(most, fabs(x[i] - y[i]));
    }
    return most;
}

static trial make_trial(const sheet *cloth, const weft_plugin *plugin, const char *name,
                        double tolerance, double fixed)
{
    trial it = { .sheet = cloth,
                 .method = method(plugin, name),
                 .config = weft_stepper_config_default() };
    it.config.rtol = it.config.atol_position = it.config.atol_velocity = tolerance;
    it.config.first_step = 1e-5;
    it.config.fixed_step = fixed;
    return it;
}

static void print_trial(const char *name, const trial *it, const trial *reference,
                        double seconds)
{
    const weft_stepper_stats stats = weft_sim_stats(it->sim);
    printf("  %-10s %9.4g s/s %6llu steps %5llu rejected %7llu calls, error %.1e m\n",
           name, seconds / it->sheet->duration, (unsigned long long)stats.steps,
           (unsigned long long)stats.rejected, (unsigned long long)stats.rhs_calls,
           apart(it, reference));
}

/* Returns how much longer ARKODE takes. */
static double compare(const sheet *cloth, const pair *two, const trial *reference,
                      double tolerance, double fixed)
{
    trial gsl = make_trial(cloth, weft_plugin_gsl(), two->gsl, tolerance, fixed);
    trial arkode
        = make_trial(cloth, weft_plugin_arkode(), two->arkode, tolerance, fixed);
    bench_case cases[]
        = { { two->gsl, run, &gsl, 0.0 }, { two->arkode, run, &arkode, 0.0 } };
    bench_interleaved(cases, 2, cloth->rounds);
    const double ratio = cases[1].median / cases[0].median;
    printf("pairs %s %s/%s ", cloth->name, two->gsl, two->arkode);
    printf(fixed > 0.0 ? "fixed %g s" : "tolerance %g",
           fixed > 0.0 ? fixed : tolerance);
    printf(": arkode/gsl %.2f\n", ratio);
    print_trial("gsl", &gsl, reference, cases[0].median);
    print_trial("arkode", &arkode, reference, cases[1].median);
    fflush(stdout);
    weft_sim_destroy(gsl.sim);
    weft_sim_destroy(arkode.sim);
    return ratio;
}

static double measure(sheet *cloth)
{
    make_cloth(cloth);
    trial reference = make_trial(cloth, weft_plugin_gsl(), "rk8pd", 1e-11, 0.0);
    run(&reference);
    double worst = 0.0;
    for (size_t p = 0; p < sizeof pairs / sizeof pairs[0]; ++p) {
        for (size_t i = 0; i < sizeof tolerances / sizeof tolerances[0]; ++i) {
            worst = fmax(worst,
                         compare(cloth, &pairs[p], &reference, tolerances[i], 0.0));
        }
        worst = fmax(worst, compare(cloth, &pairs[p], &reference, 1.0, cloth->fixed));
    }
    weft_sim_destroy(reference.sim);
    weft_cloth_destroy(cloth->cloth);
    return worst;
}

int main(void)
{
    double worst = 0.0;
    for (size_t i = 0; i < sizeof sheets / sizeof sheets[0]; ++i) {
        worst = fmax(worst, measure(&sheets[i]));
    }
    printf("pairs worst: arkode takes %.2f times as long as gsl\n", worst);
    return 0;
}

#else

int main(void)
{
    puts("pairs: skipped, it takes the plugins gsl and arkode");
    return 0;
}

#endif
