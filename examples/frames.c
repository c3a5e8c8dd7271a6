/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.c -- a run in frames, as `weft run` makes them, of a cloth that is made of a
 * measured fabric; then changes between steps, and what a failed step reports. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { ROWS = 12, COLS = 16, ALL = ROWS * COLS };

static weft_status make_cloth(weft_cloth **cloth, weft_error *err)
{
    static const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS;
    def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.04; /* [m] */
    def.velocity[2] = 0.3;                  /* [m/s] */
    def.pins = &top;
    def.pin_count = 1;
    //! [fabric]
    weft_fabric denim = *weft_fabric_find("11oz-black-denim");
    denim.damping[0] = denim.damping[1] = 2e-4; /* [s] */
    if (weft_fabric_apply(&denim, &def, err) != WEFT_OK) {
        return err->status;
    }
    printf("bends in %.1f cm of its weight, stretches by %.0f N/m\n",
           1e2 * weft_fabric_length(&denim, 0, 9.81), weft_fabric_of(&def).stretch[0]);
    //! [fabric]
    return weft_cloth_create(&def, cloth, err);
}

//! [play]
static weft_status frame(void *ctx, size_t i, weft_error *err)
{
    const weft_sim *sim = (const weft_sim *)ctx;
    const weft_measures now = weft_sim_measure(sim);
    (void)err;
    printf("frame %zu at %.3f s: kinetic %.6f J%s\n", i, weft_sim_time(sim),
           now.energy.kinetic, weft_sim_is_between(sim) ? ", within a step" : "");
    return WEFT_OK; /* anything else ends the run */
}

static weft_status play(weft_sim *sim, const weft_run_def *run, weft_error *err)
{
    const weft_play whole = { .run = run,
                              .first = 0,
                              .last = weft_run_last_frame(run),
                              .frame = frame,
                              .ctx = sim };
    return weft_sim_play(sim, &whole, err);
}
//! [play]

static void print_end(weft_sim *sim)
{
    //! [event]
    if (weft_sim_event(sim)) {
        printf("1 mJ of kinetic energy is left after %.3f s\n", weft_sim_time(sim));
    }
    //! [event]
    //! [stats]
    const weft_stepper_stats counts = weft_sim_stats(sim);
    printf("%" PRIu64 " steps, %" PRIu64 " force evaluations\n", counts.steps,
           counts.rhs_calls);
    //! [stats]
}

/* A gust; the lower hem is caught and lifted; all other particles stand still. */
static weft_status change(weft_sim *sim, weft_error *err)
{
    static double v[ALL][3]; /* [m/s] */
    //! [wind]
    const double gust[3] = { 0.0, 0.0, 3.0 };                    /* [m/s] */
    weft_status status = weft_sim_set_wind(sim, gust, 0.2, err); /* [kg/(m^2 s)] */
    //! [wind]
    //! [pin many]
    size_t hem[COLS];
    double lift[COLS][3] = { { 0.0 } }; /* [m/s] */
    for (size_t c = 0; c < COLS; ++c) {
        hem[c] = ALL - COLS + c;
        lift[c][1] = 0.5;
    }
    if (status == WEFT_OK) {
        status = weft_sim_pin_many(sim, hem, lift[0], COLS, err);
    }
    //! [pin many]
    //! [set]
    weft_sim_velocities(sim, v[0]);
    for (size_t i = 0; i < ALL; ++i) {
        v[i][2] = 0.0; /* no longer towards the viewer */
    }
    if (status == WEFT_OK) {
        status = weft_sim_set_state(sim, NULL, v[0], err);
    }
    //! [set]
    return status;
}

/* Single steps, up to a tenth of a second. */
static weft_status step_on(weft_sim *sim, weft_error *err)
{
    static double y[6 * ALL];
    weft_status status = WEFT_OK;
    //! [step]
    const double end = weft_sim_time(sim) + 0.1; /* [s] */
    while (status == WEFT_OK && weft_sim_time(sim) < end) {
        status = weft_sim_step(sim, end, err);
    }
    //! [step]
    if (status == WEFT_OK) {
        //! [between]
        const double t = end - 0.5 * weft_sim_stats(sim).last_step; /* [s] */
        status = weft_sim_between(sim, t, y, err);
        printf("half a step before %.3f s: hem at %+.6f m\n", end, y[2 * ALL - 1]);
        //! [between]
    }
    return status;
}

/* A step beyond the stability limit ends in infinite numbers. */
static weft_status fail(weft_sim_def run, weft_error *err)
{
    weft_sim *sim = NULL;
    run.config.fixed_step = 0.02; /* [s] */
    run.event = NULL;
    run.interpolate = false;
    weft_status status = weft_sim_create(&run, &sim, err);
    if (status != WEFT_OK) {
        return status;
    }
    //! [failure]
    weft_failure why;
    if (weft_sim_advance(sim, 20.0, err) != WEFT_OK && weft_sim_failure(sim, &why)) {
        char text[64];
        printf("%s: %s, the fastest at %.1g m/s\n", weft_status_text(why.status),
               weft_particle_text(weft_sim_cloth(sim), why.particle, text, sizeof text),
               why.speed);
        status = WEFT_OK; /* as it should */
    }
    //! [failure]
    weft_sim_destroy(sim);
    return status;
}

int main(void)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    //! [stop]
    weft_run_def frames = { .duration = 4.0, .fps = 5.0, .threads = 1 };
    frames.stop = (weft_stop_def){ WEFT_STOP_KINETIC, 1e-3, 0.0 }; /* [J] */
    weft_sim_def run = weft_sim_def_default();
    run.event = weft_stop_event;
    run.event_ctx = &frames.stop;
    //! [stop]
    run.interpolate = true; /* frames from within steps */
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = weft_run_step(&frames, 1e-4); /* [s] */
    weft_status status = make_cloth(&cloth, &err);
    run.cloth = cloth;
    status = status == WEFT_OK ? weft_sim_create(&run, &sim, &err) : status;
    status = status == WEFT_OK ? play(sim, &frames, &err) : status;
    if (status == WEFT_OK) {
        print_end(sim);
        status = change(sim, &err);
    }
    status = status == WEFT_OK ? step_on(sim, &err) : status;
    status = status == WEFT_OK ? fail(run, &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
