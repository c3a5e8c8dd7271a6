/* SPDX-License-Identifier: BSD-3-Clause */
/* platform.c -- one thread, in place of src/base/thread_pool.c: WebAssembly, Windows.
 */
#include "base/thread_pool.h"

#ifdef __wasm__
#define PLATFORM "WebAssembly"
#else
#define PLATFORM "Windows"
#endif

const char *weft__pool_refusal(size_t threads)
{
    return threads > 1 ? "this build of weft, for " PLATFORM ", has one thread" : NULL;
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
