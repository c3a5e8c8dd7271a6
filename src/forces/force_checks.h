/* SPDX-License-Identifier: BSD-3-Clause */
/* force_checks.h -- the role of a force in checked steps and frames: what the cloth may
 * not do, such as pass through itself. src/sim/step_check.c asks all forces. */
#pragma once

#include "base/stop.h"
#include "forces/state.h"

/* From one state to another. */
typedef struct weft__path {
    double t0, t1; /* [s] */
    const double *y0, *y1;
} weft__path;

/* A free particle that is in a shape, or may have passed through it; or two primitives
 * that may have met. */
typedef struct weft__penetration {
    bool found;
    weft_primitive pair[2]; /* count 0: a particle and a shape */
    size_t particle, shape;
    double gap;    /* [m] */
    double t;      /* [s] of the gap */
    uint64_t call; /* number of the right-hand side that found it, or none, last */
} weft__penetration;

/* How crossings are looked for. */
typedef struct weft__search {
    const char *where; /* before the message; NULL: nothing */
    size_t loose;      /* 1 + a particle that counts as free; 0: none does */
    weft__stop *stop;  /* asked now and then; NULL: never */
} weft__search;

/* Edges that lie too deep in a shape between particles, and triangles that do without
 * one. Primitives that pins hold, by all corners or by one inside the shape, do not
 * count. */
typedef struct weft__passages {
    size_t count;
    weft_primitive first; /* of particles as states have them */
    size_t shape;
    double wait; /* [s] until the state had better be looked at again */
} weft__passages;

/* Two shapes, of which one moves against the other, and a particle between them. */
typedef struct weft__closing {
    bool found;
    size_t shape[2], particle;
    double apart;     /* [m] now, along the line through the particle */
    double near_time; /* [s] when they are two thicknesses apart */
    double meet_time; /* [s] when they meet */
} weft__closing;

/* Functions of blocks [first, end) look at their free particles, on any thread. The
 * others look at all that their workspace is of, which may be NULL. */
typedef struct weft__force_checks {
    bool (*wanted)(const void *own);  /* whether steps are checked for it */
    double (*reach)(const void *own); /* [m] the gap below which it acts */
    bool (*gathers)(const void *own); /* whether a band needs the whole cloth for it */
    bool (*pairs)(const void *own);   /* whether it acts between any two particles */
    bool (*asked)(const weft_cloth_def *def); /* whether a definition has it */
    const char *no_bands; /* its name, if no band can have it; NULL: each can */

    /* A path: whether it is clear; if not, the first particle, by shapes. Shortens the
     * displacements of particles from `from` to y until they are. */
    bool (*clear)(const void *own, const weft__path *path, size_t first, size_t end);
    void (*first)(const void *own, const weft__path *path, size_t first, size_t end,
                  weft__penetration *out);
    void (*hold)(const void *own, double t, const double *from, double *y, size_t first,
                 size_t end);

    /* The same of pairs of primitives; `forget`: the next path is looked at as if none
     * had been before. */
    bool (*clear_pairs)(const void *own, void *space, const weft__path *path,
                        weft__penetration *out);
    void (*forget)(void *space);
    void (*hold_pairs)(void *space, double t, const double *from, double *y);

    /* A state: the least gap [m] of a place x, and whose it is; the nearest pair of
     * primitives, found if they are at the same place; the least gap to a shape other
     * than one, by weft__keep_gap; two shapes that close on the cloth. */
    double (*gap)(const void *own, double t, const double x[3], size_t *shape);
    void (*meet)(const void *own, void *space, const weft__state *at,
                 weft__penetration *out);
    void (*other)(const void *own, void *space, const weft__state *at, size_t than,
                  weft_measures *least);
    weft__closing (*closing)(const void *own, void *space, const weft__state *at);

    /* WEFT_INVALID for a cloth that no start suits, or for a state that crosses. */
    weft_status (*start)(const void *own, weft_error *err);
    weft_status (*crossing)(const void *own, double t, const double *y,
                            const weft__search *of, weft_error *err);

    /* What passes through a shape, of primitives that particles of block b own. At
     * their present speeds, and the acceleration `rise` [m/s^2], no particle crosses
     * half a shape within the wait. */
    weft__passages (*passages)(const void *own, const weft__state *at, size_t b,
                               double rise);
} weft__force_checks;
