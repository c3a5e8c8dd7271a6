/* SPDX-License-Identifier: BSD-3-Clause */
/* team.h -- worker threads beside the thread that steps, for jobs of microseconds. */
#ifndef WEFT_BASE_TEAM_H
#define WEFT_BASE_TEAM_H

#include "weft/stepper.h"

typedef struct weft__team weft__team;

/* Part i of a job. */
typedef void weft__task(void *ctx, size_t i);

/* `threads` including the caller's, or as many as the system grants. NULL: only the
 * caller's. given NULL: malloc's. */
weft__team *weft__team_create(size_t threads, const weft_allocator *given);
void weft__team_destroy(weft__team *team); /* NULL is allowed */
size_t weft__team_threads(const weft__team *team);

/* Runs all parts [0, count) once each, on any thread, with the floating-point mode of
 * the caller; count <= WEFT_PARTS. Returns when they are done. Allocates nothing; locks
 * only to wake sleeping threads. `self` is a weft__team. */
enum { WEFT_PARTS = 0xffff };
void weft__team_run(void *self, weft__task *task, void *ctx, size_t count);

#endif
