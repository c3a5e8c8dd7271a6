/* SPDX-License-Identifier: BSD-3-Clause */
/* platform.c -- WebAssembly in place of src/base/thread_pool.c and
 * src/plugin/loading.c: one thread, and the plugins that are linked in. */
#include "base/thread_pool.h"
#include "plugin/loading.h"

const char *weft__pool_refusal(size_t threads)
{
    return threads > 1 ? "this build of weft, for WebAssembly, has one thread" : NULL;
}

weft__pool *weft__pool_create(size_t threads, const weft_allocator *given)
{
    (void)threads, (void)given;
    return NULL;
}

void weft__pool_destroy(weft__pool *pool)
{
    (void)pool;
}

size_t weft__pool_threads(const weft__pool *pool)
{
    (void)pool;
    return 1;
}

bool weft__pool_in_caller(const weft__pool *pool)
{
    (void)pool;
    return true;
}

void weft__pool_run(void *self, weft__task *task, void *ctx, size_t count)
{
    (void)self;
    for (size_t i = 0; i < count; ++i) {
        task(ctx, i);
    }
}

weft_plugin_fn weft_plugin_arkode, weft_plugin_stiff, weft_plugin_verlet;

const weft_plugin *weft__plugin_built_in(size_t i)
{
    static weft_plugin_fn *const all[]
        = { weft_plugin_arkode, weft_plugin_stiff, weft_plugin_verlet };
    return i < sizeof all / sizeof all[0] ? all[i]() : NULL;
}

#define ONLY                                                                           \
    "this build of weft, for WebAssembly, has the plugins arkode, stiff and verlet"
const char weft__no_search_path[] = "any folder: " ONLY;

void weft__installed_plugins(char *directory, size_t size)
{
    (void)size;
    directory[0] = '\0';
}

weft_status weft__plugin_open(const char *file, const char *id, void **handle,
                              const weft_plugin **plugin, weft_error *err)
{
    (void)file, (void)id, (void)handle, (void)plugin;
    return weft_error_set(err, WEFT_BAD_PLUGIN, ONLY " and loads no others");
}

void weft__plugin_close(void *handle)
{
    (void)handle;
}
