/* SPDX-License-Identifier: BSD-3-Clause */
/* open.c -- plugins, scenes and simulations for the verbs, with their errors printed.
 */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "cli/human.h"

int report_error(const weft_error *err)
{
    fputs("weft: error: ", stderr);
    if (err->file[0] != '\0') {
        print_plain(stderr, err->file, "");
        fprintf(stderr, ":%d:%d: ", err->line, err->column);
    }
    print_plain(stderr, err->message, "");
    fputc('\n', stderr);
    return err->status == WEFT_IO          ? EXIT_FILE
           : err->status == WEFT_BAD_SCENE ? EXIT_SCENE
                                           : EXIT_SIMULATION;
}

/* Where the program lies, without a trailing slash; "" if that cannot be told. */
static void program_directory(char *directory, size_t size)
{
    const ssize_t length = readlink("/proc/self/exe", directory, size - 1);
    directory[length < 0 ? 0 : length] = '\0';
    char *slash = strrchr(directory, '/');
    if (slash != NULL) {
        *slash = '\0';
    }
}

weft_registry *open_registry(const char *plugin_path)
{
    char directory[2048], fallback[4096];
    program_directory(directory, sizeof directory);
    (void)snprintf(fallback, sizeof fallback, "%s/plugins", directory);
    weft_error err;
    weft_registry *registry = NULL;
    weft_registry_def def = weft_registry_def_default();
    def.path = plugin_path;
    def.fallback = fallback;
    if (weft_registry_create(&def, &registry, &err) != WEFT_OK) {
        (void)report_error(&err);
    }
    return registry;
}

static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find(ctx, id, &plugin, err);
    return plugin;
}

static void print_found(const weft_diagnostics *found)
{
    for (size_t i = 0; i < found->count; ++i) {
        char text[2048];
        (void)weft_diagnostic_format(&found->items[i], text, sizeof text);
        print_plain(stderr, text, "\t\n");
        fputc('\n', stderr);
    }
    if (found->errors + found->warnings > found->count) {
        fprintf(stderr, "... and %zu more\n",
                found->errors + found->warnings - found->count);
    }
}

static weft_scene_def scene_def(const char *file, const options *given,
                                weft_registry *registry)
{
    weft_scene_def def = weft_scene_def_default();
    def.file = file;
    def.sets = given->sets;
    def.set_count = given->set_count;
    def.find_plugin = find_plugin;
    def.find_ctx = registry;
    return def;
}

/* One of the two is wanted; the other is NULL. */
static int open_either(const weft_scene_def *def, weft_scene **scene,
                       weft_sweep **sweep)
{
    weft_error err = { 0 };
    weft_diagnostics *found = calloc(1, sizeof *found);
    if (found == NULL) {
        weft_error_set(&err, WEFT_NO_MEMORY, "out of memory");
        return report_error(&err);
    }
    const weft_status status = sweep == NULL ? weft_scene_load(def, scene, found, &err)
                                             : weft_sweep_load(def, sweep, found, &err);
    print_found(found);
    const bool told = found->errors > 0;
    free(found);
    if (status == WEFT_OK) {
        return EXIT_DONE;
    }
    return told ? EXIT_SCENE : report_error(&err);
}

int open_scene(const char *file, const options *given, weft_registry *registry,
               weft_scene **scene)
{
    const weft_scene_def def = scene_def(file, given, registry);
    return open_either(&def, scene, NULL);
}

int open_sweep(const char *file, const options *given, weft_registry *registry,
               weft_sweep **sweep)
{
    const weft_scene_def def = scene_def(file, given, registry);
    return open_either(&def, NULL, sweep);
}

char *default_directory(const char *file, const char *suffix)
{
    const char *slash = strrchr(file, '/');
    const char *name = slash == NULL ? file : slash + 1;
    const char *dot = strstr(name, ".yaml");
    const size_t length
        = dot == NULL || dot == name ? strlen(name) : (size_t)(dot - name);
    char *out = malloc(length + strlen(suffix) + 1);
    if (out != NULL) {
        memcpy(out, name, length);
        memcpy(out + length, suffix, strlen(suffix) + 1);
    }
    return out;
}

weft_status simulation_create(const weft_scene *scene, weft_cloth **cloth,
                              weft_sim **sim, weft_error *err)
{
    *sim = NULL;
    weft_status status = weft_cloth_create(weft_scene_cloth(scene), cloth, err);
    if (status != WEFT_OK) {
        return status;
    }
    weft_sim_def def = weft_sim_def_default();
    def.cloth = *cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    def.ledger = weft_scene_record(scene)->ledger;
    def.limit = *weft_scene_limit(scene);
    status = weft_sim_create(&def, sim, err);
    if (status != WEFT_OK) {
        weft_cloth_destroy(*cloth);
        *cloth = NULL;
    }
    return status;
}
