/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdio.h>
#include <weft/weft.h>

int main(void)
{
    const weft_pin corners[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                 { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    weft_cloth_def def = weft_cloth_def_default(); /* SI units throughout */
    def.rows = def.cols = 20;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.02 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ true, 50.0, 0.01 };
    def.pins = corners;
    def.pin_count = 2;

    const weft_registry_def where = weft_registry_def_default(); /* WEFT_PLUGIN_PATH */
    weft_registry *registry = NULL;
    const weft_plugin *plugin = NULL;
    weft_sim_def run = weft_sim_def_default();
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err = { WEFT_OK };

    weft_status failed = weft_registry_create(&where, &registry, &err);
    failed = failed ? failed : weft_registry_find(registry, "verlet", &plugin, &err);
    failed = failed ? failed : weft_cloth_create(&def, &cloth, &err);
    if (!failed) {
        run.cloth = cloth;
        run.method = weft_plugin_method(plugin, "velocity_verlet");
        run.config.fixed_step = 5e-4; /* [s] */
        failed = weft_sim_create(&run, &sim, &err);
    }
    for (int frame = 1; !failed && frame <= 30; ++frame) {
        failed = weft_sim_advance(sim, frame / 30.0, &err);
        const size_t n = weft_cloth_particles(cloth);
        const double *y = weft_sim_state(sim); /* planes x[n] y[n] z[n] vx[n] ... */
        printf("%.3f s: lower right corner at height %+.4f m\n", weft_sim_time(sim),
               y[2 * n - 1]);
    }
    if (failed) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_registry_destroy(registry);
    return failed ? 1 : 0;
}
