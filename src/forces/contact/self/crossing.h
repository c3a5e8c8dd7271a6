/* SPDX-License-Identifier: BSD-3-Clause */
/* crossing.h -- where a cloth passes through itself or a body. */
#pragma once

#include "forces/contact/self/self.h"

/* An edge and a triangle; of a chain two edges. Or two neighbours at the same place. */
typedef struct weft__crossing {
    size_t key[2]; /* of an edge 3 i + its number at node i of a grid, of a surface its
                      number; of the other likewise */
    weft_primitive side[2];
    weft__meeting how;
} weft__crossing;

/* Visits all, in an order that depends on the cloth alone; false: it was stopped. The
 * own of the tree must have a surface unless it is of a grid. */
typedef void weft__crossing_fn(void *ctx, const weft__crossing *one);
bool weft__each_crossing(const weft__quadtree *tree, const weft__search *of,
                         weft__crossing_fn *visit, void *ctx);

typedef struct weft__crossings {
    size_t count;         /* of weft_cloth_crossings */
    weft__crossing first; /* by its keys */
} weft__crossings;
weft__crossings weft__crossings_of(const weft__quadtree *tree, const weft__search *of);

/* What an own has of a kind at node i: edges of 2 points, or triangles of 3; their keys
 * follow each other. */
typedef struct weft__incident {
    size_t count, size, key;
    const uint32_t *at;
    uint32_t room[9];
} weft__incident;
void weft__incident_of(const weft__self *own, size_t i, size_t size,
                       weft__incident *to);

/* If a cloth with contact.self passes through itself in a state: WEFT_INVALID, with
 * `where` before "edge (3, 4)-(3, 5) passes through cell (9, 2); 12 such pairs; pins
 * hold (3, 4), and corners of 2 pairs". Or WEFT_STOPPED. */
weft_status weft__crossing_error(const void *own, double t, const double *y,
                                 const weft__search *of, weft_error *err);

/* The same, with names of one's own for primitives. */
typedef void weft__name_fn(const void *ctx, const weft_primitive *of, char *text,
                           size_t size);
weft__name_fn weft__self_name; /* ctx: a weft__self */
enum { WEFT__CROSSING_TEXT = sizeof((weft_crossing *)0)->text };
void weft__crossing_names(const weft__crossing *one, weft__name_fn *by, const void *ctx,
                          char text[WEFT__CROSSING_TEXT]);
weft_status weft__named_crossing(const weft__self *own, const double *y,
                                 const weft__search *of, weft__name_fn *by,
                                 const void *ctx, weft_error *err);
