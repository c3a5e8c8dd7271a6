/* SPDX-License-Identifier: BSD-3-Clause */
/* game_loop.c -- a cloth in a loop of fixed frames; a hand grabs a corner particle,
 * drags it along and releases it. */
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { ROWS = 15, COLS = 20, GRABBED = ROWS * COLS - 1 };

/* The place of the hand at time t [s]; false: it holds nothing. */
static bool hand(double t, double place[3])
{
    place[0] = 0.95 - 0.4 * (t - 0.5);
    place[1] = -0.7 + 0.3 * (t - 0.5);
    place[2] = 0.5 * (t - 0.5);
    return t >= 0.5 && t <= 1.5;
}

//! [drag]
/* Called once per frame: the hand reaches its place when the frame ends. */
static weft_status drag(weft_sim *sim, double t_end, weft_error *err)
{
    double xyz[3 * ROWS * COLS], place[3], velocity[3];
    if (!hand(t_end, place)) {
        return weft_sim_unpin(sim, GRABBED, err); /* no effect on a free one */
    }
    weft_sim_positions(sim, xyz);
    for (int k = 0; k < 3; ++k) {
        velocity[k] = (place[k] - xyz[3 * GRABBED + k]) / (t_end - weft_sim_time(sim));
    }
    return weft_sim_pin(sim, GRABBED, velocity, err);
}
//! [drag]

static weft_status play(weft_sim *sim, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (int frame = 1; status == WEFT_OK && frame <= 120; ++frame) {
        const double t = frame / 60.0; /* computed, never summed */
        status = drag(sim, t, err);
        if (status == WEFT_OK) {
            status = weft_sim_advance(sim, t, err);
        }
        if (status == WEFT_OK && frame % 10 == 0) {
            double xyz[3 * ROWS * COLS]; /* for a vertex buffer */
            weft_sim_positions(sim, xyz);
            //! [pinned]
            const double *p = xyz + (size_t)3 * GRABBED;
            printf("%.3f s %s %+.6f %+.6f %+.6f\n", t,
                   weft_cloth_pinned(weft_sim_cloth(sim), GRABBED) ? "held" : "free",
                   p[0], p[1], p[2]);
            //! [pinned]
        }
    }
    return status;
}

int main(void)
{
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS;
    def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
    def.pins = &top;
    def.pin_count = 1;
    def.damping = 4e-4;

    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 1e-3; /* [s]; a frame still ends exactly at its time */
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
