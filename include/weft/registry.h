/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/registry.h -- stepper plugins: found, loaded and known by their names. */
#ifndef WEFT_REGISTRY_H
#define WEFT_REGISTRY_H

#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The plugins of a program, linked in or loaded. The registry owns their handles:
 * destroy it after the last stepper of these plugins. One thread at a time. */
typedef struct weft_registry weft_registry;

/* The places where weft searches for weft-<id>.so, in this order. Lists are separated
 * by ':'. */
typedef struct weft_registry_def {
    uint32_t struct_size;
    const char *path;                /* searched first; NULL: none */
    bool environment;                /* then WEFT_PLUGIN_PATH, if it is set */
    const char *fallback;            /* searched next; NULL: none */
    weft_log log;                    /* info: loaded plugins; warning: refused ones */
    const weft_allocator *allocator; /* NULL: malloc's */
    bool installed; /* searched last: weft/plugins-1 beside libweft.so. A program linked
                       with libweft.a must name that directory itself: `pkg-config
                       --variable=plugindir weft` */
    /* Called before a file is loaded, because loading runs its code: any status but
     * WEFT_OK refuses the file, with the reason in *err. NULL: every file is loaded. */
    weft_status (*admit)(void *ctx, const char *file, weft_error *err);
    void *admit_ctx;
} weft_registry_def;

WEFT_DEFAULT(weft_registry_def)
WEFT_API weft_status weft_registry_create(const weft_registry_def *def,
                                          weft_registry **out, weft_error *err);
WEFT_API void weft_registry_destroy(weft_registry *registry); /* NULL is allowed */

/* Adds a plugin that is linked in. Errors: WEFT_BAD_PLUGIN with the reason. */
WEFT_API weft_status weft_registry_add(weft_registry *registry,
                                       const weft_plugin *plugin, weft_error *err);

/* Loads one file named weft-<id>.so and adds its plugin. Errors: WEFT_BAD_PLUGIN with
 * the file and the reason. */
WEFT_API weft_status weft_registry_load(weft_registry *registry, const char *file,
                                        weft_error *err);

/* The plugin with that id, loaded now if it is not loaded yet. Errors: WEFT_BAD_PLUGIN;
 * the message lists the directories searched. */
WEFT_API weft_status weft_registry_find(weft_registry *registry, const char *id,
                                        const weft_plugin **out, weft_error *err);

/* The file weft-<id>.so of the search path, a plugin or not, into file[size]. Errors:
 * WEFT_BAD_PLUGIN; the message lists the directories searched. */
WEFT_API weft_status weft_registry_locate(const weft_registry *registry, const char *id,
                                          char *file, size_t size, weft_error *err);

/* Loads every weft-*.so of the search path but weft-mpi.so, which is no plugin. A
 * refused plugin is reported to `refused` (unless NULL) and skipped. */
WEFT_API weft_status weft_registry_load_all(weft_registry *registry,
                                            void (*refused)(void *ctx,
                                                            const weft_error *why),
                                            void *ctx, weft_error *err);

WEFT_API size_t weft_registry_count(const weft_registry *registry);
WEFT_API const weft_plugin *weft_registry_at(const weft_registry *registry, size_t i);
/* The file of a plugin; "" if it is linked in. */
WEFT_API const char *weft_registry_file(const weft_registry *registry, size_t i);

/* The method with that name or full name; NULL if there is none, or if plugin is NULL.
 */
WEFT_API const weft_stepper_type *weft_plugin_method(const weft_plugin *plugin,
                                                     const char *name);

/* Finds plugin and method: "arkode", "dormand_prince". Errors: those of
 * weft_registry_find, WEFT_INVALID (no such method); the message lists the existing
 * methods. */
WEFT_API weft_status weft_registry_method(weft_registry *registry, const char *plugin,
                                          const char *method,
                                          const weft_stepper_type **out,
                                          weft_error *err);

/* The size of a method's dense matrices for so many particles: the number of bytes, and
 * as text "matrices of 1734 x 1734, 48.11 MB in all, about 1734 evaluations for each
 * Jacobian". 0 and "" without WEFT_STEPPER_DENSE. */
WEFT_API double weft_stepper_matrices(const weft_stepper_type *type, size_t particles,
                                      char *text, size_t size);

/* Adaptive, rtol = atol = 1e-6, max norm, first step 1 ms, min 1 ps. */
WEFT_DEFAULT(weft_stepper_config)

#ifdef __cplusplus
}
#endif

#endif
