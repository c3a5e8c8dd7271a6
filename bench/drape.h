/* SPDX-License-Identifier: BSD-3-Clause */
/* drape.h -- evaluations and seconds of whole runs with contact: a level sheet that
 * falls 5 cm onto a ball, under the settings of the table in
 * bench/NOTES.md, beside the same sheet hung by two corners. bench.h is
 * included before. */
#pragma once

#include <math.h>

#include "weft/weft.h"

#if defined(HAVE_GSL) && defined(HAVE_ARKODE)

const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);

/* What differs from the defaults, where it is not 0. */
typedef struct drape {
    const char *name;
    bool hung, frictionless, rkf45;
    double tolerance, thickness, coulomb_slip;
} drape;

static inline weft_cloth *drape_cloth(const drape *of, size_t n)
{
    static const weft_pin corners[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                        { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    static const weft_spring_def springs[WEFT_FAMILIES]
        = { { .present = true, .stiffness = 100.0, .damping = 0.02 },
            { .present = true, .stiffness = 50.0, .damping = 0.01 },
            { .present = true, .stiffness = 5.0, .damping = 0.001 } };
    weft_shape ball = weft_shape_default(WEFT_SPHERE);
    weft_cloth_def def = weft_cloth_def_default(); /* 0.2 kg/m^2 */
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    ball.radius = 0.3, ball.at[1] = -0.35;
    def.rows = def.cols = n;
    def.spacing[0] = def.spacing[1] = 1.0 / (double)(n - 1);
    def.origin[0] = def.origin[2] = -0.5;
    def.down[1] = 0.0, def.down[2] = 1.0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f] = springs[f];
    }
    def.pins = corners, def.pin_count = of->hung ? 2 : 0;
    def.contact.shapes = &ball, def.contact.shape_count = of->hung ? 0 : 1;
    if (of->frictionless) {
        def.contact.friction = 0.0;
    }
    if (of->thickness > 0.0) {
        def.contact.thickness = of->thickness;
    }
    if (of->coulomb_slip > 0.0) {
        def.contact.law = WEFT_FRICTION_COULOMB, def.contact.slip = of->coulomb_slip;
    }
    bench_must(weft_cloth_create(&def, &cloth, &err), &err);
    return cloth;
}

static inline weft_sim *drape_sim(const drape *of, const weft_cloth *cloth)
{
    const double tolerance = of->tolerance > 0.0 ? of->tolerance : 1e-6;
    weft_sim_def def = weft_sim_def_default();
    weft_sim *sim = NULL;
    weft_error err = { 0 };
    def.cloth = cloth;
    def.method = of->rkf45 ? weft_plugin_method(weft_plugin_gsl(), "rkf45")
                           : weft_plugin_method(weft_plugin_arkode(), "dormand_prince");
    def.config.rtol = def.config.atol_position = def.config.atol_velocity = tolerance;
    bench_must(weft_sim_create(&def, &sim, &err), &err);
    return sim;
}

/* Returns the evaluations. */
static inline double drape_run(const drape *of, size_t n, double duration)
{
    weft_cloth *cloth = drape_cloth(of, n);
    weft_sim *sim = drape_sim(of, cloth);
    weft_error err = { 0 };
    double seconds = 0.0, gap = (double)INFINITY;
    size_t touching = 0;
    while (weft_sim_time(sim) < duration) {
        const double start = bench_now();
        bench_must(weft_sim_step(sim, duration, &err), &err);
        seconds += bench_now() - start;
        const double t = weft_sim_time(sim), *y = weft_sim_state(sim);
        const size_t now = weft_cloth_touching(cloth, t, y);
        gap = fmin(gap, weft_cloth_gap(cloth, t, y, NULL, NULL));
        touching = now > touching ? now : touching;
    }
    const double calls = (double)weft_sim_stats(sim).rhs_calls;
    printf(
        "%4zu x %-4zu %-30s %7.0f evaluations %7.2f s %5zu touch, gap %5.2f mm, %llu "
        "taken back\n",
        n, n, of->name, calls, seconds, touching, 1e3 * gap,
        (unsigned long long)weft_sim_vetoed(sim));
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return calls;
}

static inline void drape_all(size_t n, double duration)
{
    static const drape runs[] = {
        { .name = "hung by two corners, no ball", .hung = true },
        { .name = "ball, the defaults" },
        { .name = "friction 0", .frictionless = true },
        { .name = "rkf45", .rkf45 = true },
        { .name = "tolerance 1e-4", .tolerance = 1e-4 },
        { .name = "thickness 2 mm", .thickness = 2e-3 },
        { .name = "coulomb, slip 1e-2 m/s", .coulomb_slip = 1e-2 },
        { .name = "coulomb, slip 1e-3 m/s", .coulomb_slip = 1e-3 },
    };
    double calls[2] = { 0.0 };
    printf("a sheet on a ball, %g s:\n", duration);
    for (size_t i = 0; i < sizeof runs / sizeof runs[0]; ++i) {
        const bool slow = runs[i].coulomb_slip == 1e-3 && n > 33;
        const double count = slow ? 0.0 : drape_run(&runs[i], n, duration);
        if (i < 2) {
            calls[i] = count;
        }
    }
    printf("%4zu x %-4zu the defaults take %.2f times the evaluations without a ball\n",
           n, n, calls[1] / calls[0]);
}

#else

static inline void drape_all(size_t n, double duration)
{
    printf("%zu x %zu, %g s: plugins gsl and arkode are missing\n", n, n, duration);
}

#endif
