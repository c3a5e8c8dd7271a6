/* SPDX-License-Identifier: BSD-3-Clause */
/* dragged_sphere.c -- a hanging cloth in a loop of fixed frames; a hand drags a sphere
 * through it. */
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

/* The place of the hand at time t [s]. */
static void hand(double t, double place[3])
{
    place[0] = 0.475;
    place[1] = -0.5;
    place[2] = -0.6 + 0.8 * t;
}

//! [drag]
/* Called once per frame: the sphere reaches its place when the frame ends. To jump
 * there would pass through the cloth. */
static weft_status drag(weft_sim *sim, size_t sphere, double t_end, weft_error *err)
{
    const double now = weft_sim_time(sim);
    double place[3], present[3], velocity[3];
    hand(t_end, place);
    weft_cloth_shape_pose(weft_sim_cloth(sim), sphere, now, present, NULL);
    for (int k = 0; k < 3; ++k) {
        velocity[k] = (place[k] - present[k]) / (t_end - now);
    }
    return weft_sim_move_shape(sim, sphere, NULL, velocity, err);
}
//! [drag]

static weft_status play(weft_sim *sim, weft_error *err)
{
    //! [add]
    weft_shape ball = weft_shape_default(WEFT_SPHERE);
    size_t sphere = 0;
    ball.radius = 0.15;
    hand(0.0, ball.at);
    weft_status status = weft_sim_add_shape(sim, &ball, &sphere, err);
    //! [add]
    for (int frame = 1; status == WEFT_OK && frame <= 90; ++frame) {
        const double t = frame / 60.0; /* computed, never summed */
        status = drag(sim, sphere, t, err);
        if (status == WEFT_OK) {
            status = weft_sim_advance(sim, t, err);
        }
        if (status == WEFT_OK && frame % 10 == 0) {
            const weft_cloth *cloth = weft_sim_cloth(sim);
            //! [load]
            double force[3], torque[3]; /* of the cloth on the sphere */
            weft_sim_shape_load(sim, sphere, force, torque);
            printf("%.3f s gap %.6f m force %+.4f N\n", t,
                   weft_cloth_gap(cloth, t, weft_sim_state(sim), NULL, NULL), force[2]);
            //! [load]
        }
    }
    //! [remove]
    return status == WEFT_OK ? weft_sim_remove_shape(sim, sphere, err) : status;
    //! [remove]
}

int main(void)
{
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 20;
    def.cols = 20;
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
    run.config.fixed_step = 2e-4; /* [s]; halved where a shape is in the way */
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
