/* SPDX-License-Identifier: BSD-3-Clause */
/* scene.c -- a scene from a file, or else from memory, under the plugin that the scene
 * names. */
#include <stdio.h>
#include <stdlib.h>
#include <weft/weft.h>

static const char built_in[]
    = "weft: 1\n"
      "cloth:\n"
      "  grid: {rows: 10, cols: 12, spacing: 0.05}\n"
      "  density: 0.2\n"
      "  springs: {stretch: {stiffness: 100, damping: 0.02}}\n"
      "  pins: [top-left, {at: top-right, velocity: [-0.1, 0, 0]}]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 5.0e-4}\n"
      "run: {duration: 1.0, fps: 10}\n";

//! [find]
static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find((weft_registry *)ctx, id, &plugin, err);
    return plugin;
}
//! [find]

//! [load]
static weft_status load(const char *file, weft_registry *registry, weft_scene **scene,
                        weft_error *err)
{
    static weft_diagnostics found; /* all mistakes at once; large */
    weft_scene_def def = weft_scene_def_default();
    def.file = file;
    def.text = file == NULL ? built_in : NULL;
    def.length = sizeof built_in - 1;
    def.find_plugin = find_plugin;
    def.find_ctx = registry;
    const weft_status status = weft_scene_load(&def, scene, &found, err);
    for (size_t i = 0; i < found.count; ++i) {
        char text[2048];
        (void)weft_diagnostic_format(&found.items[i], text, sizeof text);
        fprintf(stderr, "%s\n", text);
    }
    return status;
}
//! [load]

static weft_status play(const weft_scene *scene, weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    //! [play]
    weft_sim_def run = weft_sim_def_default();
    weft_status status = weft_cloth_create(weft_scene_cloth(scene), &cloth, err);
    run.cloth = cloth;
    run.method = weft_scene_method_type(scene);
    run.config = *weft_scene_config(scene);
    run.limit = *weft_scene_limit(scene);
    status = status == WEFT_OK ? weft_sim_create(&run, &sim, err) : status;
    //! [play]
    //! [frames]
    const weft_run_def *frames = weft_scene_run(scene);
    for (int i = 1; status == WEFT_OK && i <= frames->duration * frames->fps; ++i) {
        status = weft_sim_advance(sim, i / frames->fps, err);
        const weft_energy energy
            = weft_cloth_energy(cloth, weft_sim_time(sim), weft_sim_state(sim));
        printf("%.3f s: kinetic %.6f J\n", weft_sim_time(sim), energy.kinetic);
    }
    //! [frames]
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

int main(int argc, char **argv)
{
    weft_registry *registry = NULL;
    weft_scene *scene = NULL;
    weft_error err;
    weft_registry_def plugins = weft_registry_def_default();
    plugins.path = argc > 2 ? argv[2] : NULL; /* else the installed ones */
    weft_status status = weft_registry_create(&plugins, &registry, &err);
    if (status == WEFT_OK) {
        status = load(argc > 1 && argv[1][0] != '\0' ? argv[1] : NULL, registry, &scene,
                      &err);
    }
    status = status == WEFT_OK ? play(scene, &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_scene_destroy(scene);
    weft_registry_destroy(registry); /* last: it keeps the plugin loaded */
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
