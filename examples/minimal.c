/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdio.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { SIDE = 20, LAST = SIDE * SIDE - 1 };

int main(void)
{
    //! [define]
    const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default(); /* SI units throughout */
    def.rows = def.cols = SIDE;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    def.pins = &corner;
    def.pin_count = 1;
    //! [define]

    //! [create]
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    weft_sim_def run = weft_sim_def_default();
    /* this plugin is linked in; a weft_registry loads others */
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 5e-4; /* [s] */
    bool ok = weft_cloth_create(&def, &cloth, &err) == WEFT_OK;
    run.cloth = cloth;
    ok = ok && weft_sim_create(&run, &sim, &err) == WEFT_OK;
    //! [create]
    //! [advance]
    for (int frame = 1; ok && frame <= 30; ++frame) {
        ok = weft_sim_advance(sim, frame / 30.0, &err) == WEFT_OK;
        double xyz[SIDE * SIDE][3]; /* [m] */
        weft_sim_positions(sim, xyz[0]);
        printf("%.3f s: last corner at height %+.4f m\n", weft_sim_time(sim),
               xyz[LAST][1]);
    }
    //! [advance]
    if (!ok) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return ok ? 0 : 1;
}
