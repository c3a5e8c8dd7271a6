/* SPDX-License-Identifier: BSD-3-Clause */
/* hashes.c -- print the hash of the state at the frames of a scene, and of the bytes of
 * the simulation when it is saved after them: hashes PLUGINS SECONDS SCENE... For
 * tools/checks/check-determinism and packaging/wasm/check.mjs, which compare what
 * different builds print. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/hash.h"
#include "weft/weft.h"

static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find((weft_registry *)ctx, id, &plugin, err);
    return plugin;
}

static weft_status print_saved(weft_sim *sim, weft_error *err)
{
    const size_t size = weft_sim_save_size(sim);
    unsigned char *bytes = malloc(size);
    uint64_t sum = WEFT__HASH_START;
    const weft_status status = weft_sim_save(sim, bytes, size, err);
    for (size_t i = 0; status == WEFT_OK && i < size; ++i) {
        sum = weft__hash_byte(sum, bytes[i]);
    }
    free(bytes);
    if (status == WEFT_OK) {
        printf("%016" PRIx64 " saved in %zu bytes\n", sum, size);
    }
    return status;
}

static weft_status play(const weft_scene *scene, double seconds, weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    weft_status status = weft_cloth_create(weft_scene_cloth(scene), &cloth, err);
    def.cloth = cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    def.limit = *weft_scene_limit(scene);
    status = status == WEFT_OK ? weft_sim_create(&def, &sim, err) : status;
    const double fps = weft_scene_run(scene)->fps;
    for (int i = 1; status == WEFT_OK && i <= seconds * fps; ++i) {
        status = weft_sim_advance(sim, i / fps, err);
        printf("%016" PRIx64 "\n", weft_sim_measure(sim).hash);
    }
    status = status == WEFT_OK ? print_saved(sim, err) : status;
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

static weft_status load(int argc, char **argv, weft_registry *registry,
                        weft_scene **scene, weft_error *err)
{
    static weft_diagnostics found; /* large */
    weft_scene_def def = weft_scene_def_default();
    def.file = argv[3];
    def.sets = (const char *const *)argv + 4;
    def.set_count = (size_t)argc - 4;
    def.find_plugin = find_plugin;
    def.find_ctx = registry;
    return weft_scene_load(&def, scene, &found, err);
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        fprintf(stderr, "usage: hashes PLUGINS SECONDS SCENE [KEY=VALUE...]\n");
        return 2;
    }
    weft_registry *registry = NULL;
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    weft_registry_def plugins = weft_registry_def_default();
    plugins.path = argv[1];
    weft_status status = weft_registry_create(&plugins, &registry, &err);
    status = status == WEFT_OK ? load(argc, argv, registry, &scene, &err) : status;
    status = status == WEFT_OK ? play(scene, strtod(argv[2], NULL), &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_scene_destroy(scene);
    weft_registry_destroy(registry);
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
