/* SPDX-License-Identifier: BSD-3-Clause */
/* self_parts.h -- the inside of a weft__self_list, for self_list.c, self_shelf.c and
 * self_check.c. */
#ifndef WEFT_FORCES_SELF_SELF_PARTS_H
#define WEFT_FORCES_SELF_SELF_PARTS_H

#include "base/memory.h"
#include "forces/self/self_list.h"

enum { WEFT__KINDS = WEFT__EDGES + 1 };

/* Allowed for roundoff, relative. */
#define WEFT__SELF_ROUNDOFF 1e-9
/* Of the skin. */
#define WEFT__SELF_ALLOWED 1e-6

/* Skins beyond the range: nearer tiles are watched. */
#define WEFT__SELF_WATCHED 3.0

/* Two tiles that are near each other; their pairs are a weft__span. */
typedef struct weft__self_group {
    size_t tiles;   /* in `between` */
    double nearest; /* [m] of its pairs that the step check looks at */
    double loss;    /* [m] moved between where its pairs were measured and `place` */
    double reach;   /* [m] as far as they matter in a step */
} weft__self_group;

typedef struct weft__self_groups {
    size_t count;
    weft__self_group *at;
    weft__span *spans;
} weft__self_groups;

/* Pairs of a kind. */
typedef struct weft__self_pairs {
    size_t count;
    weft__near near;
    double *distances; /* [m] */
} weft__self_pairs;

/* Those of a kind, and their pushes. */
typedef struct weft__self_bin {
    weft__self_pairs now, before; /* before: while a list is made anew, the old one */
    weft__pushes *pushes;
    size_t pushing;
} weft__self_bin;

/* The groups of successive pairs of tiles: one thread makes and evaluates them. */
typedef struct weft__self_shelf {
    size_t first, end; /* in `between` */
    weft__self_groups now, before;
    weft__self_bin bins[WEFT__KINDS];
    size_t room, wanted; /* pairs of a kind; wanted: before the next step */
    bool full;           /* without some pairs */
} weft__self_shelf;

struct weft__self_list {
    const weft__self *own;
    weft__team *team;
    weft_allocator memory;
    weft__quadtree tree;
    weft__knot *knots;     /* of any state */
    double *place;         /* 3 N: where the list was made */
    unsigned char *marks;  /* N: of particles, or tiles */
    weft__drift *tiles[5]; /* of the last displacements; in checks of steps all */
    uint32_t (*between)[2];
    double *clear; /* [m] of each pair of tiles */
    size_t between_count;
    double skin; /* [m] beyond the thickness */
    size_t group_count;
    double extent; /* [m] of the last displacement */
    bool valid;    /* whole, about `place` */
    size_t pin_changes;
    weft__self_shelf *shelves;
    size_t shelf_count;
};

/* ---- self_shelf.c: pairs kept ---------------------------------------------------- */

/* For pairs of tiles [first, end), at first of little room. */
bool weft__self_shelf_create(const weft_allocator *memory, size_t first, size_t end,
                             weft__self_shelf *out);
void weft__self_shelf_free(const weft_allocator *memory, weft__self_shelf *of);

/* Makes the room that is wanted; false: no memory, and no pairs. */
bool weft__self_shelf_grow(const weft_allocator *memory, weft__self_shelf *of);

/* Begins anew: what was `now` is `before`. */
void weft__self_shelf_begin(weft__self_shelf *of);

/* A weft__pair_fn that adds to a shelf; more than its room are counted. */
bool weft__self_shelf_keep(void *shelf, const weft__pair *pair);

/* Adds the pairs of group i of `before`. */
void weft__self_shelf_copy(weft__self_shelf *of, size_t i);

/* More room is wanted as soon as half of it is used. */
bool weft__self_shelf_full(weft__self_shelf *of);

/* Where the pairs of a group begin. */
static inline size_t weft__self_first(const weft__self_groups *of, size_t i,
                                      size_t kind)
{
    return i > 0 ? of->spans[i - 1].end[kind] : 0;
}

/* Pair `from` becomes pair `to`. */
static inline void weft__self_pairs_move(weft__self_pairs *in, size_t from, size_t to)
{
    for (size_t k = 0; k < 4; ++k) {
        in->near.particle[k][to] = in->near.particle[k][from];
    }
    in->near.waits[to] = in->near.waits[from];
    in->near.mass[to] = in->near.mass[from];
    in->near.rest[to] = in->near.rest[from];
    in->distances[to] = in->distances[from];
}

/* ---- self_list.c ----------------------------------------------------------------- */

/* [m] The extent of a displacement, infinite if a number is not finite, and the bounds
 * k of tiles, which are not needed without groups. */
double weft__self_drift(weft__self_list *list, const double *from, const double *to,
                        size_t k);

/* [m] Of the last displacements k, with an allowance for roundoff. */
static inline double weft__self_extent_between(const weft__self_list *list, size_t k,
                                               const uint32_t tiles[2])
{
    return weft__drift_extent(&list->tiles[k][tiles[0]], &list->tiles[k][tiles[1]])
               * (1.0 + WEFT__SELF_ROUNDOFF)
           + WEFT__SELF_ALLOWED * list->skin;
}

/* [m] All pairs that are nearer are in the list when it has been sought. */
static inline double weft__self_range(const weft__self_list *list)
{
    return list->own->law.thickness + list->skin;
}

/* [m] Tiles whose pairs are nearer are watched. */
static inline double weft__self_watched(const weft__self_list *list)
{
    return weft__self_range(list) + WEFT__SELF_WATCHED * list->skin;
}

/* [m] Primitives that are not in a group have this distance in `place` at least. */
static inline double weft__self_lasting(const weft__self_list *list)
{
    return list->group_count > 0 ? weft__self_watched(list) : weft__self_range(list);
}

#endif
