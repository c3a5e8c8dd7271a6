/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies.h -- the contact of a cloth with shapes of triangles: pairs of primitives as
 * in contact of a cloth with itself (forces/self), of which one side is a body's. Their
 * points follow those of the cloth: a state with all points is made of a state of the
 * cloth at a time. */
#pragma once

#include "base/thread_pool.h"
#include "forces/contact/closing.h"
#include "forces/contact/mesh_shape.h"
#include "forces/contact/self/crossing.h"

typedef struct weft__bodies {
    weft__self pairs; /* of all points; law.self: whether there are bodies */
    const weft__contact *contact; /* has the shapes */
    weft_allocator memory;
    double *friction; /* of all points; NULL: that of the contact */
} weft__bodies;

/* All points at a time. */
typedef struct weft__spread {
    double *y; /* six planes */
    double t, piece;
    bool placed;    /* the bodies are where they are at t */
    size_t changes; /* of shapes then */
} weft__spread;

/* The workspace of a simulation. */
typedef struct weft__bodies_space {
    const weft__bodies *own;
    weft__self_list *list;
    size_t changes; /* of shapes, that it knows; one more */
    weft__spread now, before;
    unsigned char *marks; /* of particles */
    weft_allocator memory;
} weft__bodies_space;

/* As weft__self_list_clear, at the times of a path: a free particle or, of its
 * primitive, the first, and a shape that may have met. */
bool weft__bodies_clear(const void *own, void *space, const weft__path *path,
                        weft__penetration *out);

/* The shape that a point is of; a state of all points, to be freed with the bodies'
 * memory. NULL: no memory. */
size_t weft__bodies_shape(const weft__bodies *own, size_t point);
double *weft__bodies_spread(const weft__bodies *own, const weft__state *at);

/* What the cloth exerts on shape k: force [N], torque [N m] about `at`. */
void weft__bodies_load(const weft__bodies *own, weft__bodies_space *space,
                       const weft__state *at, size_t k, double load[WEFT__LOAD]);

/* Visits all that push, in a state of all points that *y has meanwhile; as
 * weft__self_each. */
int weft__bodies_each(const weft__bodies *own, weft__bodies_space *space,
                      const weft__state *at, weft__pushed_fn *visit, void *ctx,
                      const double **y);

/* Two shapes, of which one at least is a body, that push a particle from both sides and
 * will meet at their present motion (forces/contact/closing.h). */
weft__closing weft__bodies_closing(const void *own, void *space, const weft__state *at);

/* As weft__crossing_error, at a time; also of cloth that is inside a closed body. */
weft_status weft__bodies_error(const void *own, double t, const double *y,
                               const weft__search *of, weft_error *err);

/* WEFT_SOLVER if a pinned particle beside a free one is inside a closed body: no state
 * of the free ones is without a crossing then. */
weft_status weft__bodies_pins_error(const weft__bodies *own, double t, const double *y,
                                    const weft__search *of, weft_error *err);

weft__name_fn weft__bodies_name; /* ctx: a weft__bodies */

/* For weft__force. */
void weft__bodies_range_stiffness(const void *own, void *space, const weft__state *at,
                                  size_t first, size_t count,
                                  weft__range_stiffness *range_stiffness);
void weft__bodies_multiply(const void *own, const weft__state *at, double a, double b,
                           const double *x, double *out);
int weft__bodies_add(const void *own, void *space, const weft__state *at,
                     weft__unit unit, double *to);
int weft__bodies_transposed(const void *own, void *space, const weft__state *at,
                            double *out);
void weft__bodies_measure(const void *own, void *space, const weft__state *at,
                          weft_measures *sum);
void weft__bodies_other(const void *own, void *space, const weft__state *at,
                        size_t than, weft_measures *least);
void weft__bodies_hold(void *in, double t, const double *from, double *y);
int weft__bodies_blocks(const void *own, void *space, const weft__state *at,
                        double *to);

extern const weft__force weft__bodies_force;
