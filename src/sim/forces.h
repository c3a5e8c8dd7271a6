/* SPDX-License-Identifier: BSD-3-Clause */
/* forces.h -- the equations of motion on the threads of a simulation, each a range of
 * blocks: the same bits as on one. */
#pragma once

#include "cloth/model.h"
#include "sim/exchange.h"

typedef struct weft__forces {
    const weft_cloth *cloth;
    weft__pool *pool; /* NULL: one thread */
    size_t spans;
    void *spaces[WEFT__FORCES]; /* workspaces of whole-cloth forces; NULL: none */
    weft__range_stiffness
        *range_stiffness;    /* of each particle, where pairs of primitives push */
    weft_measures *measures; /* of each own block; NULL: no memory */
    const weft_comm *comm;   /* NULL: the cloth is whole */
    weft_measures *all;      /* band 0: of all blocks of the whole cloth */
    weft__exchange exchange;
    weft_allocator memory;
    double piece; /* [s] of tables and keys: that of the step under way (mesh/track.h);
                     NAN: none is, and that of the time counts */
} weft__forces;

/* A state at t, in the piece of the step under way. */
static inline weft__state weft__forces_state(const weft__forces *forces, double t,
                                             const double *y)
{
    return (weft__state){ .t = t,
                          .y = y,
                          .piece = isnan(forces->piece) ? NULL : &forces->piece };
}

/* Uses at most `threads`, fewer for a small cloth. given NULL: malloc's. */
weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given);
void weft__forces_destroy(weft__forces *forces);

/* Calls task(ctx, first, end) for ranges of blocks [first, end) that make up the
 * own ones, on any thread and in any order. */
typedef void weft__span_fn(void *ctx, size_t first, size_t end);
void weft__forces_spans(const weft__forces *forces, weft__span_fn *task, void *ctx);

/* With the other bands, with a comm, to the end of the file. As weft_cloth_rhs. */
int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt);

/* Measures each block of the whole cloth by `of` and adds them in their order; springs
 * and particles have their numbers in the whole. */
weft_measures weft__forces_measure(const weft__forces *forces, const weft__state *at,
                                   weft__measure_fn *of);

/* Whether a force has a workspace. */
bool weft__forces_spaced(const weft__forces *forces);

/* step_check.c: no free particle gets into a shape or through it, and no part of the
 * cloth through another: what the forces check (forces/force_checks.h), on the threads
 * of a simulation. The functions below look at the own rows of a band. */
/* On the threads; allocates nothing. */
bool weft__path_clear(const weft__forces *forces, const weft__path *path);

/* The first by particles, then shapes, for which a path is not clear, else the first
 * pair of primitives. */
weft__penetration weft__path_penetration(const weft__forces *forces,
                                         const weft__path *path);

/* The particle deepest in a shape: gap <= 0. A state that is not finite has none. */
weft__penetration weft__state_penetration(const weft_cloth *cloth, double t,
                                          const double *y);

/* That, else two primitives at the same place. */
weft__penetration weft__rhs_penetration(const weft__forces *forces, double t,
                                        const double *y);

/* Of one particle, free or not. */
weft__penetration weft__particle_penetration(const weft_cloth *cloth, double t,
                                             const double *y, size_t i);

/* Halves each particle's displacement from `from` to y until its straight path cannot
 * enter or cross a shape, nor the cloth itself. */
void weft__hold_back(const weft__forces *forces, double t, const double *from,
                     double *y);

/* "particle (3, 4) and shapes[1]", or both primitives, of the whole; returns text. */
enum { WEFT__PENETRATION_TEXT = 160 };
const char *weft__penetration_text(const weft__mesh *mesh,
                                   const weft__penetration *penetration,
                                   char text[WEFT__PENETRATION_TEXT]);

/* "particle (3, 4) is 2 mm inside shapes[1]", of the present or `would be`. */
weft_status weft__penetration_error(const weft_cloth *cloth,
                                    const weft__penetration *penetration,
                                    const char *what, weft_error *err);
