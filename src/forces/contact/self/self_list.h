/* SPDX-License-Identifier: BSD-3-Clause */
/* self_list.h -- the pairs of primitives of a cloth that are near each other, kept
 * while the cloth moves little. The list saves time alone: results have the bits that
 * cloth/self.h has without one, on any number of threads. */
#pragma once

#include "base/memory.h"
#include "base/thread_pool.h"
#include "forces/contact/contact.h"
#include "forces/contact/self/self.h"

/* pool NULL: one thread. `part` not NULL: points [part[0], part[1]), and of pairs
 * without one of them only some are listed. NULL: no memory. */
weft__self_list *weft__self_list_create(const weft__self *own, weft__pool *pool,
                                        const size_t part[2],
                                        const weft_allocator *memory);
void weft__self_list_destroy(weft__self_list *list); /* NULL is allowed */

/* Makes room for the pairs that were too many since the last call: a list grows here
 * alone, between steps, and is done without until then. */
weft_status weft__self_list_grow(weft__self_list *list, weft_error *err);

/* The next search is one of all pairs, and the list is then made anew. */
static inline void weft__self_list_forget(weft__self_list *list);

/* As weft__self_seek, but for pairs that do not push. */
bool weft__self_list_seek(weft__self_list *list, const double *y, weft__pair_fn *visit,
                          void *ctx);

/* Whether all pairs are clear in a step or displacement, else the first that is not and
 * its gap [m] at the end. */
bool weft__self_list_clear(weft__self_list *list, const weft__stride *stride,
                           weft_primitive pair[2], double *gap);

/* Whether no two points can have met in a step of particles y0 .. y1 alone, six planes
 * each, while all others rest; false: it is not known. */
bool weft__self_list_far(const weft__self_list *list, const double *y0,
                         const double *y1, double h);

/* Shortens displacements from y0 until they are clear: those of particles in pairs that
 * are not are halved, all six numbers. */
void weft__self_list_hold(weft__self_list *list, const double *y0, double *y1);

/* ---- the inside, for self_list.c, self_chunk.c and self_check.c -------------------
 */

enum { WEFT__KINDS = WEFT__EDGES + 1 };

/* Allowed for roundoff, relative. */
#define WEFT__SELF_ROUNDOFF 1e-9
/* Of the skin. */
#define WEFT__SELF_ALLOWED 1e-6

/* Skins beyond the range: nearer tiles are watched. */
#define WEFT__SELF_WATCHED 3.0

/* Two tiles that are near each other; their pairs are a weft__pair_subset. */
typedef struct weft__self_group {
    size_t tiles;   /* in `between` */
    double nearest; /* [m] of its pairs that the step check looks at */
    double loss;    /* [m] moved between where its pairs were measured and `place` */
    double reach;   /* [m] as far as they matter in a step */
    double displacement; /* [m] of the tiles against each other in that step, at most */
    double until;        /* [m] moved so far, pairs that are not close do not push */
} weft__self_group;

typedef struct weft__self_groups {
    size_t count;
    weft__self_group *at;
    weft__pair_subset *subsets;
} weft__self_groups;

/* Pairs of a kind. */
typedef struct weft__self_pairs {
    size_t count;
    weft__near near;
    double *distances;  /* [m] */
    double *numbers[4]; /* the distances and those of near */
} weft__self_pairs;

/* Those of a kind, and their pushes. */
typedef struct weft__self_bin {
    weft__self_pairs now, before; /* before: while a list is made anew, the old one,
                                   * and then the close pairs, that may push soon */
    weft__pushes *pushes;
    size_t pushing;
} weft__self_bin;

/* The groups of successive pairs of tiles: one thread makes and evaluates them. */
typedef struct weft__self_chunk {
    size_t first, end; /* in `between` */
    weft__self_groups now, before;
    weft__self_bin bins[WEFT__KINDS];
    size_t room, wanted; /* pairs of a kind; wanted: before the next step */
    bool full;           /* without some pairs */
    bool stays;          /* is made anew from the pairs that it has, in their place */
} weft__self_chunk;

struct weft__self_list {
    const weft__self *own;
    weft__pool *pool;
    weft_allocator memory;
    weft__quadtree tree;
    weft__knot *knots;     /* of any state */
    weft__boxes boxes;     /* without a room: by the tree */
    const double *y;       /* while it is made, or searched */
    size_t rest;           /* points from here on do not move; 0: all may */
    double *place;         /* 3 N: where the list was made */
    unsigned char *marks;  /* N: of particles, or tiles, or their rows */
    weft__drift *tiles[4]; /* of the last displacements; in checks of steps all */
    weft__drift *runs;     /* of a surface, of many points each */
    uint32_t *grouped;     /* tiles that groups have; of a grid all */
    size_t grouped_count;
    uint32_t (*between)[2];
    double *clear; /* [m] of each pair of tiles */
    size_t between_count;
    double skin; /* [m] beyond the thickness pairs are listed */
    size_t group_count;
    double extent; /* [m] of the last displacement */
    double least;  /* [m] no pair that the step check looks at is nearer in `place` */
    bool valid;    /* whole, about `place` */
    size_t pin_changes;
    size_t part[2]; /* points whose pairs alone have to be listed */
    weft__self_chunk *chunks;
    size_t chunk_count;
};

static inline void weft__self_list_forget(weft__self_list *list)
{
    list->valid = false;
}

/* ---- self_chunk.c: pairs kept ---------------------------------------------------- */

/* For pairs of tiles [first, end), at first of little room. */
bool weft__self_chunk_create(const weft_allocator *memory, size_t first, size_t end,
                             weft__self_chunk *out);
void weft__self_chunk_free(const weft_allocator *memory, weft__self_chunk *of);

/* Makes the room that is wanted; false: no memory, and no pairs. */
bool weft__self_chunk_grow(const weft_allocator *memory, weft__self_chunk *of);

/* Begins anew: what was `now` is `before`, but pairs stay where none is sought. */
void weft__self_chunk_begin(weft__self_chunk *of, bool stays);

/* A weft__pair_fn that adds to a chunk; more than its room are counted. */
bool weft__self_chunk_keep(void *chunk, const weft__pair *pair);

/* Adds the pairs of group i of `before`. */
void weft__self_chunk_copy(weft__self_chunk *of, size_t i);

/* Adds those of pairs [first, end) of others, or of the same from their end on, whose
 * numbers are at most `most`. */
void weft__self_pairs_add(const weft__self_pairs *from, size_t first, size_t end,
                          const double *numbers, double most, weft__within_fn *within,
                          weft__self_pairs *to);

/* More room is wanted as soon as half of it is used. */
bool weft__self_chunk_full(weft__self_chunk *of);

/* Where the pairs of a group begin. */
static inline size_t weft__self_first(const weft__self_groups *of, size_t i,
                                      size_t which)
{
    return i > 0 ? of->subsets[i - 1].end[which] : 0;
}

/* ---- self_list.c ----------------------------------------------------------------- */

/* [m] The extent of a displacement, infinite if a number is not finite, and the bounds
 * k of tiles, which are not needed without groups; of those that no group has, the
 * bounds of all. */
double weft__self_drift(weft__self_list *list, const double *from, const double *to,
                        size_t k);

/* The same of all tiles; of the state that is searched the bounds of places. */
double weft__self_drift_all(weft__self_list *list, const double *from, const double *to,
                            size_t k);

/* [m] Between the boxes about two tiles. */
double weft__box_distance(const weft__drift *a, const weft__drift *b);

/* [m] Of the last displacements k, with an allowance for roundoff. */
static inline double weft__self_extent_between(const weft__self_list *list, size_t k,
                                               const uint32_t tiles[2])
{
    return weft__drift_extent(&list->tiles[k][tiles[0]], &list->tiles[k][tiles[1]])
               * (1.0 + WEFT__SELF_ROUNDOFF)
           + WEFT__SELF_ALLOWED * list->skin;
}

/* ---- self_search.c --------------------------------------------------------------- */

/* false: no memory. */
bool weft__self_search_create(weft__self_list *list);

/* Sets the finite state that is to be searched, without marks. */
void weft__self_search_place(weft__self_list *list, const double *y);

/* Marks what the search between two tiles needs. */
void weft__self_search_mark(weft__self_list *list, const uint32_t tiles[2]);

/* Begins to search between tiles that are marked. */
void weft__self_search_begin(weft__self_list *list);

/* As weft__each_pair_between in that state; range < 1e30 m. Different threads may
 * search different tiles. */
bool weft__self_search(const weft__self_list *list, const uint32_t tiles[2],
                       double range, weft__pair_fn *visit, void *ctx);

/* ---- distances ------------------------------------------------------------------- */

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
