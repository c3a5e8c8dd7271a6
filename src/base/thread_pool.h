/* SPDX-License-Identifier: BSD-3-Clause */
/* thread_pool.h -- worker threads beside the thread that steps, for jobs of
 * microseconds. */
#pragma once

#include "weft/stepper.h"

typedef struct weft__pool weft__pool;

/* NULL, or why this platform can never run so many threads. */
const char *weft__pool_refusal(size_t threads);

/* Part i of a job. */
typedef void weft__task(void *ctx, size_t i);

/* `threads` including the caller's, or as many as the system grants. NULL: only the
 * caller's. given NULL: malloc's. */
weft__pool *weft__pool_create(size_t threads, const weft_allocator *given);
void weft__pool_destroy(weft__pool *pool); /* NULL is allowed */
size_t weft__pool_threads(const weft__pool *pool);

/* Runs all parts [0, count) once each, on any thread, with the floating-point mode of
 * the caller; count <= WEFT_PARTS. Returns when they are done. Allocates nothing; locks
 * only to wake sleeping threads. `self` is a weft__pool; NULL: the caller's thread
 * alone. */
enum { WEFT_PARTS = 0xffff };
void weft__pool_run(void *self, weft__task *task, void *ctx, size_t count);

/* In a part: whether it runs in the thread that called weft__pool_run. */
bool weft__pool_in_caller(const weft__pool *pool);
