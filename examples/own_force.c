/* SPDX-License-Identifier: BSD-3-Clause */
/* own_force.c -- a user's own force and correction: a post attracts a sheet, which may
 * not sink below a floor; the energy ledger shows the work of both. */
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

typedef struct world {
    size_t particles;
    double post[2];   /* [m] x, z of an upright line */
    double stiffness; /* [N/m] of the pull towards the post */
    double floor;     /* [m] height */
} world;

//! [force]
/* F = -k (x - post), horizontal: adds to planes fx[N] fy[N] fz[N]. A function of (t, y)
 * alone, so that the same run gives the same bits. */
static int pull(void *ctx, double t, const double *y, double *f)
{
    const world *of = (const world *)ctx;
    const size_t n = of->particles;
    (void)t;
    for (size_t i = 0; i < n; ++i) {
        f[i] -= of->stiffness * (y[i] - of->post[0]);
        f[2 * n + i] -= of->stiffness * (y[2 * n + i] - of->post[1]);
    }
    return 0;
}
//! [force]

//! [correct]
/* Called after each accepted step: puts particles below the floor onto it, at rest. It
 * comes after the strain limit, if there is one, and works against it: a cloth that a
 * collider stretches beyond the limit takes all sweeps in every step. */
static bool land(void *ctx, double t, double h, double *y)
{
    const world *of = (const world *)ctx;
    const size_t n = of->particles;
    bool changed = false;
    (void)t;
    (void)h;
    for (size_t i = 0; i < n; ++i) {
        if (y[n + i] < of->floor) {
            y[n + i] = of->floor;
            y[3 * n + i] = y[4 * n + i] = y[5 * n + i] = 0.0;
            changed = true;
        }
    }
    return changed;
}
//! [correct]

static void tell(weft_log_level level, const char *text)
{
    static const char *const names[] = { "debug", "info", "warning" };
    printf("%s: %s\n", names[level], text);
}

static void log_line(void *ctx, weft_log_level level, const char *text)
{
    (void)ctx;
    tell(level, text);
}

static weft_status play(weft_sim *sim, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (int frame = 0; status == WEFT_OK && frame <= 10; ++frame) {
        status = weft_sim_advance(sim, frame / 10.0, err);
        //! [balance]
        const weft_ledger ledger = weft_sim_ledger(sim);
        const double *y = weft_sim_state(sim);
        printf("%.1f s height %+.4f m, force did %+.6f J, floor %+.6f J, residual "
               "%+.1e J\n",
               weft_sim_time(sim), y[weft_cloth_particles(weft_sim_cloth(sim))],
               ledger.work_force, ledger.work_outside, ledger.residual);
        //! [balance]
    }
    return status;
}

int main(void)
{
    weft_cloth_def def = weft_cloth_def_default(); /* no pins: it falls */
    def.rows = 8;
    def.cols = 12;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.down[1] = 0.0;
    def.down[2] = 1.0; /* level */
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 20.0, .damping = 0.01 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 10.0, .damping = 0.01 };

    world around = { .particles = def.rows * def.cols,
                     .post = { 0.55, 0.35 },
                     .stiffness = 0.02,
                     .floor = -1.0 };
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 5e-4;
    //! [define]
    run.force = pull;
    run.force_ctx = &around;
    run.correct = land;
    run.correct_ctx = &around;
    run.ledger = true;
    //! [define]
    run.log.write = log_line;

    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    weft_status status = weft_cloth_create(&def, &cloth, &err);
    run.cloth = cloth;
    status = status == WEFT_OK ? weft_sim_create(&run, &sim, &err) : status;
    status = status == WEFT_OK ? play(sim, &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
