/* SPDX-License-Identifier: BSD-3-Clause */
/* adaptive.c -- a method with error control, found at run time; the longest stable step
 * of a method without, for comparison; a simulation that is saved and continued. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/weft.h>

enum { FRAMES = 20, HALF = FRAMES / 2 };

static weft_status print_stable_step(weft_registry *registry, const weft_cloth *cloth,
                                     weft_error *err)
{
    //! [stable step]
    const weft_stiffness modes
        = weft_cloth_stiffness(cloth, 0.0, NULL); /* in any state */
    const weft_stepper_type *verlet = NULL;
    weft_stability stability;
    double h = 0.0; /* [s] */
    weft_status status
        = weft_registry_method(registry, "verlet", "velocity_verlet", &verlet, err);
    if (status == WEFT_OK) {
        status = weft_stability_create(verlet, NULL, &stability, err);
    }
    if (status == WEFT_OK) {
        status = weft_stability_step(&stability, &modes, 0.0, &h, err);
    }
    //! [stable step]
    if (status == WEFT_OK) {
        printf("velocity_verlet is stable up to %.6f s\n", h);
    }
    return status;
}

//! [play]
/* Frames (from, to], one tenth of a second each. */
static weft_status play(weft_sim *sim, int from, int to, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (int frame = from + 1; status == WEFT_OK && frame <= to; ++frame) {
        status = weft_sim_advance(sim, frame / 10.0, err);
    }
    if (status == WEFT_OK) {
        printf("%.1f s: %" PRIu64 " steps, state %016" PRIx64 "\n", weft_sim_time(sim),
               weft_sim_stats(sim).steps, weft_sim_measure(sim).hash);
    }
    return status;
}
//! [play]

/* To the end, and again from half time in a second simulation. */
static weft_status play_twice(const weft_sim_def *run, weft_error *err)
{
    weft_sim *sim = NULL, *other = NULL;
    void *bytes = NULL;
    size_t size = 0;
    weft_status status = weft_sim_create(run, &sim, err);
    status = status == WEFT_OK ? play(sim, 0, HALF, err) : status;
    if (status == WEFT_OK) {
        //! [save]
        size = weft_sim_save_size(sim);
        bytes = malloc(size);
        status = bytes != NULL ? weft_sim_save(sim, bytes, size, err) : WEFT_NO_MEMORY;
        //! [save]
    }
    status = status == WEFT_OK ? play(sim, HALF, FRAMES, err) : status;
    //! [restore]
    status = status == WEFT_OK ? weft_sim_create(run, &other, err) : status;
    status = status == WEFT_OK ? weft_sim_restore(other, bytes, size, err) : status;
    //! [restore]
    status = status == WEFT_OK ? play(other, HALF, FRAMES, err) : status;
    weft_sim_destroy(sim);
    weft_sim_destroy(other);
    free(bytes);
    return status;
}

int main(int argc, char **argv)
{
    const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    const weft_spring_def springs
        = { .present = true, .stiffness = 100.0, .damping = 0.02 }; /* [N/m], [kg/s] */
    weft_registry_def plugins = weft_registry_def_default();
    weft_cloth_def def = weft_cloth_def_default();
    weft_sim_def run = weft_sim_def_default();
    weft_registry *registry = NULL;
    weft_cloth *cloth = NULL;
    weft_error err = { WEFT_NO_MEMORY, 0, 0, "", "no memory" };
    plugins.path = argc > 1 ? argv[1] : NULL; /* else the installed ones */
    def.rows = def.cols = 10;
    def.spacing[0] = def.spacing[1] = 0.1; /* [m] */
    def.springs[WEFT_STRETCH] = springs;
    def.pins = &corner;
    def.pin_count = 1;
    run.config.rtol = 1e-5;
    run.config.atol_position = 1e-5; /* [m] */
    run.config.atol_velocity = 1e-4; /* [m/s] */
    //! [registry]
    weft_status status = weft_registry_create(&plugins, &registry, &err);
    //! [registry]
    status = status == WEFT_OK ? weft_cloth_create(&def, &cloth, &err) : status;
    run.cloth = cloth;
    status = status == WEFT_OK ? print_stable_step(registry, cloth, &err) : status;
    if (status == WEFT_OK) {
        status = weft_registry_method(registry, "arkode", "dormand_prince", &run.method,
                                      &err);
    }
    status = status == WEFT_OK ? play_twice(&run, &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_cloth_destroy(cloth);
    weft_registry_destroy(registry); /* last: it keeps the plugins loaded */
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
