/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/registry.h -- plugins with integrators: found, loaded and known by their names.
 */
#ifndef WEFT_REGISTRY_H
#define WEFT_REGISTRY_H

#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The plugins of a program, linked in or loaded. The registry owns their handles:
 * destroy it after the last integrator of these plugins. One thread at a time. */
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

/** Returns a definition that searches WEFT_PLUGIN_PATH and then the installed plugins,
 * and loads every file.
 * @return the defaults, with struct_size set */
WEFT_DEFAULT(weft_registry_def)

/** Creates a registry, with the plugins that the library was built with, if any; it
 * searches and loads none yet. One thread at a time may use it.
 * @param def copied, with its texts
 * @param[out] out the registry, for weft_registry_destroy; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (the definition is of a later version), WEFT_NO_MEMORY
 * @par Example
 * @snippet adaptive.c registry */
WEFT_API weft_status weft_registry_create(const weft_registry_def *def,
                                          weft_registry **out, weft_error *err);

/** Destroys a registry and unloads its plugins. Destroy the simulations that use their
 * methods before.
 * @param registry may be NULL */
WEFT_API void weft_registry_destroy(weft_registry *registry);

/** Adds a plugin that is linked in.
 * @param registry used by no other thread meanwhile
 * @param plugin must outlive the registry
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_PLUGIN with the reason (another abi, an incomplete method,
 *   a plugin of that id is there already), WEFT_NO_MEMORY */
WEFT_API weft_status weft_registry_add(weft_registry *registry,
                                       const weft_plugin *plugin, weft_error *err);

/** Loads one file and adds its plugin. Loading runs the file's code.
 * @param registry used by no other thread meanwhile
 * @param file a path that ends with weft-<id>.so
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_PLUGIN with the file and the reason, WEFT_NO_MEMORY, or
 *   what weft_registry_def.admit returned */
WEFT_API weft_status weft_registry_load(weft_registry *registry, const char *file,
                                        weft_error *err);

/** Finds the plugin of an id, and loads it from the search path if it is not loaded
 * yet.
 * @param registry used by no other thread meanwhile
 * @param id such as "gsl"
 * @param[out] out the plugin, which lives as long as the registry; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_PLUGIN (it was not found: the message lists the directories
 *   searched; or it was refused), WEFT_NO_MEMORY
 * @par Example
 * @snippet scene.c find */
WEFT_API weft_status weft_registry_find(weft_registry *registry, const char *id,
                                        const weft_plugin **out, weft_error *err);

/** Finds the file weft-<id>.so on the search path, a plugin or not, without loading it.
 * @param registry used by no other thread meanwhile
 * @param id such as "gsl"
 * @param[out] file receives the path, ending with a null character
 * @param size [bytes] of file
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_PLUGIN: the message lists the directories searched */
WEFT_API weft_status weft_registry_locate(const weft_registry *registry, const char *id,
                                          char *file, size_t size, weft_error *err);

/** Loads every weft-*.so of the search path but weft-mpi.so, which is no plugin.
 * @param registry used by no other thread meanwhile
 * @param refused called for each file that is refused, which is then skipped; may be
 *   NULL
 * @param ctx passed to refused
 * @param[out] err may be NULL
 * @return WEFT_OK, also if files were refused; WEFT_BAD_PLUGIN if the registry has no
 *   plugin then: the message lists the directories searched */
WEFT_API weft_status weft_registry_load_all(weft_registry *registry,
                                            void (*refused)(void *ctx,
                                                            const weft_error *why),
                                            void *ctx, weft_error *err);

/** Counts the plugins that were added or loaded so far.
 * @param registry used by no other thread meanwhile
 * @return their number */
WEFT_API size_t weft_registry_count(const weft_registry *registry);

/** Returns a plugin by its number.
 * @param registry used by no other thread meanwhile
 * @param i < weft_registry_count()
 * @return the plugin, which lives as long as the registry */
WEFT_API const weft_plugin *weft_registry_at(const weft_registry *registry, size_t i);

/** Returns the file of a plugin.
 * @param registry used by no other thread meanwhile
 * @param i < weft_registry_count()
 * @return its path; "" if the plugin is linked in */
WEFT_API const char *weft_registry_file(const weft_registry *registry, size_t i);

/** Finds a method of a plugin.
 * @param plugin may be NULL
 * @param name the method's name or full name
 * @return the method, which lives as long as the plugin; NULL if there is none, or
 *   plugin is NULL
 * @par Example
 * @snippet minimal.c create */
WEFT_API const weft_stepper_type *weft_plugin_method(const weft_plugin *plugin,
                                                     const char *name);

/** Finds a plugin and one of its methods, and loads the plugin if necessary.
 * @param registry used by no other thread meanwhile
 * @param plugin such as "arkode"
 * @param method its name or full name, such as "dormand_prince"
 * @param[out] out the method, which lives as long as the registry; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_PLUGIN and WEFT_NO_MEMORY as weft_registry_find,
 *   WEFT_INVALID (no such method: the message lists those of the plugin)
 * @par Example
 * @snippet adaptive.c stable step */
WEFT_API weft_status weft_registry_method(weft_registry *registry, const char *plugin,
                                          const char *method,
                                          const weft_stepper_type **out,
                                          weft_error *err);

/** Computes the size of a method's dense matrices.
 * @param type the method
 * @param particles N of the cloth
 * @param[out] text receives words such as "matrices of 1734 x 1734, 48.11 MB in all,
 *   about 1734 evaluations for each Jacobian"; "" without WEFT_STEPPER_DENSE
 * @param size [bytes] of text
 * @return [bytes]; 0 without WEFT_STEPPER_DENSE */
WEFT_API double weft_stepper_matrices(const weft_stepper_type *type, size_t particles,
                                      char *text, size_t size);

/** Returns a configuration with adaptive steps: rtol = atol = 1e-6, the max norm, a
 * first step of 1 ms and a smallest one of 1 ps.
 * @return the defaults, with struct_size set */
WEFT_DEFAULT(weft_stepper_config)

#ifdef __cplusplus
}
#endif

#endif
