/* SPDX-License-Identifier: BSD-3-Clause */
/* team.h -- helpers of the thread that steps, for jobs of some microseconds. */
#ifndef WEFT_SIM_TEAM_H
#define WEFT_SIM_TEAM_H

#include "weft/stepper.h"

typedef struct weft__team weft__team;

/* Part i of a job. */
typedef void weft__task(void *ctx, size_t i);

/* So many threads, the caller's among them; as many as there are to be had. NULL:
 * the caller's alone. No memory given: malloc's. */
weft__team *weft__team_create(size_t threads, const weft_allocator *given);
void weft__team_destroy(weft__team *team); /* NULL is allowed */
size_t weft__team_threads(const weft__team *team);

/* All parts of [0, count), each once, by whoever comes first; count <= WEFT_PARTS.
 * All have the floating-point mode of the caller. Returns when they are done. Allocates
 * nothing; no lock but to wake who sleeps. */
enum { WEFT_PARTS = 0xffff };
void weft__team_run(weft__team *team, weft__task *task, void *ctx, size_t count);

/* As a stepper borrows it, for as long as the team is there. */
weft_team weft__team_lend(weft__team *team);

#endif
