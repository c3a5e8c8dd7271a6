/* SPDX-License-Identifier: BSD-3-Clause */
/* built_in.c -- plugins that are linked in, in place of src/plugin/loading.c: for
 * WebAssembly, Windows and programs without dlopen. */
#include "plugin/loading.h"

#ifndef WEFT_BUILT_IN
#define WEFT_BUILT_IN X(arkode) X(stiff) X(verlet)
#endif

#define X(id) weft_plugin_fn weft_plugin_##id;
WEFT_BUILT_IN
#undef X

const weft_plugin *weft__plugin_built_in(size_t i)
{
#define X(id) weft_plugin_##id,
    static weft_plugin_fn *const all[] = { WEFT_BUILT_IN };
#undef X
    return i < sizeof all / sizeof all[0] ? all[i]() : NULL;
}

#define X(id) #id ", "
#define ONLY  "this build of weft has the plugins " WEFT_BUILT_IN "and no others"
const char weft__no_search_path[] = "any folder: " ONLY;

const char weft__installed_by[] = "";

void weft__installed_plugins(char *directory, size_t size)
{
    (void)size;
    directory[0] = '\0';
}

weft_status weft__plugin_open(const char *file, const char *id, void **handle,
                              const weft_plugin **plugin, weft_error *err)
{
    (void)file, (void)id, (void)handle, (void)plugin;
    return weft_error_set(err, WEFT_BAD_PLUGIN, ONLY);
}

void weft__plugin_close(void *handle)
{
    (void)handle;
}
