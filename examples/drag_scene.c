/* SPDX-License-Identifier: BSD-3-Clause */
/* drag_scene.c -- reads a scene of a grid, advances it, and drags its last corner. */
#include <stdio.h>
#include <weft/weft.h>

static const weft_plugin *find(void *registry, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find((weft_registry *)registry, id, &plugin, err);
    return plugin;
}

int main(int argc, char **argv)
{
    static weft_diagnostics mistakes; /* large */
    weft_registry *registry = NULL;
    weft_scene *scene = NULL;
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err = { WEFT_OK, 0, 0, "", "" };
    const weft_registry_def plugins = weft_registry_def_default();
    weft_scene_def def = weft_scene_def_default();
    def.file = argc > 1 ? argv[1] : "scenes/flag.yaml";
    bool ok = weft_registry_create(&plugins, &registry, &err) == WEFT_OK;
    def.find_plugin = find;
    def.find_ctx = registry;
    ok = ok && weft_scene_load(&def, &scene, &mistakes, &err) == WEFT_OK;
    for (size_t i = 0; i < mistakes.count; ++i) {
        char text[2048];
        (void)weft_diagnostic_format(&mistakes.items[i], text, sizeof text);
        fprintf(stderr, "%s\n", text);
    }
    ok = ok && weft_cloth_create(weft_scene_cloth(scene), &cloth, &err) == WEFT_OK;
    if (ok) {
        weft_sim_def run = weft_sim_def_default();
        run.cloth = cloth;
        run.method = weft_scene_method_type(scene);
        run.config = *weft_scene_config(scene);
        run.limit = *weft_scene_limit(scene);
        ok = weft_sim_create(&run, &sim, &err) == WEFT_OK;
    }
    const size_t n = ok ? weft_cloth_particles(cloth) : 0;
    const double up[3] = { 0.0, 0.5, 0.0 }; /* [m/s] drags the last corner */
    ok = ok && weft_sim_pin(sim, n - 1, up, &err) == WEFT_OK;
    for (int frame = 1; ok && frame <= 30; ++frame) {
        ok = weft_sim_advance(sim, frame / 30.0, &err) == WEFT_OK;
        printf("%.3f s: last corner at height %+.4f m\n", weft_sim_time(sim),
               weft_sim_state(sim)[2 * n - 1]); /* after all x and the other y */
    }
    if (!ok) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
    weft_registry_destroy(registry); /* last: it keeps the plugin loaded */
    return ok ? 0 : 1;
}
