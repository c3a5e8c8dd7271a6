/* SPDX-License-Identifier: BSD-3-Clause */
/* self_check.c -- whether parts of a cloth can have met in a step, by the list if it
 * proves the others clear. */
#include "forces/contact/self/self_list.h"

enum { HALVINGS = 60 };

typedef struct stride_search {
    const weft__stride *stride;
    weft__pair pair;
    double displacement; /* [m] of a group or two tiles: none go further against each
                            other */
    double gap;
    unsigned char *marks; /* NULL: ends at the first pair that is not clear */
    bool found;
} stride_search;

/* Whether a pair cannot have met; else the gap [m] at the end. */
static bool is_clear(const weft__stride *stride, const weft__pair *pair, double *gap)
{
    return weft__stride_clear(stride, pair, gap)
           || weft__pair_mass(stride->own, pair) == 0.0; /* all of it is held */
}

static bool self_check_look_at(void *ctx, const weft__pair *pair)
{
    stride_search *of = ctx;
    double gap;
    if (is_clear(of->stride, pair, &gap)) {
        return true;
    }
    if (!of->found) {
        of->found = true, of->pair = *pair, of->gap = gap;
    }
    for (size_t k = 0; of->marks != NULL && k < 4; ++k) {
        of->marks[pair->particle[k]] = 1;
    }
    return of->marks != NULL;
}

/* Looks at pairs `which` of a kind, but for those that the bound of what they move
 * against each other proves clear: at the end of the step they are further apart, or
 * both gaps together are larger. False ends the search. */
static bool look_at_all(stride_search *of, weft__pair_kind kind, const weft__near *near,
                        const uint32_t *which, size_t count)
{
    const weft__stride *stride = of->stride;
    const weft__self *own = stride->own;
    uint32_t left[WEFT__STRIP];
    double ends[WEFT__STRIP], starts[WEFT__STRIP];
    size_t some = 0;
    bool continues = true;
    own->gaps(own, kind, near, which, count, stride->y1, ends);
    for (size_t i = 0; i < count; ++i) {
        left[some] = which[i], ends[some] = ends[i];
        some += !(ends[i] > of->displacement);
    }
    own->gaps(own, kind, near, left, some, stride->y0, starts);
    for (size_t i = 0; i < some && continues; ++i) {
        if (!(ends[i] > 0.0 && of->displacement < starts[i] + ends[i])) {
            const weft__pair pair = weft__near_pair(kind, near, left[i]);
            continues = self_check_look_at(of, &pair);
        }
    }
    return continues;
}

/* From the list to the end, in the step, and of the velocities at both ends. */
enum { EXTENTS = 4 };

/* [m] As far as particles go against each other in the step. */
static double displacement_of(const weft__stride *of, const double extent[EXTENTS])
{
    return fmax(extent[1], of->h * fmax(extent[2], extent[3]));
}

/* [m] As far as two primitives may have been apart that can have met: half of what they
 * move against each other in the step, and from the list to both its ends, of which the
 * start is no further than the end and the step. */
static double self_check_reach(const weft__stride *of, const double extent[EXTENTS])
{
    return 0.5 * (2.0 * extent[0] + extent[1] + displacement_of(of, extent))
           * (1.0 + WEFT__SELF_ROUNDOFF);
}

bool weft__self_list_far(const weft__self_list *list, const double *y0,
                         const double *y1, double h)
{
    const size_t n = list->own->mesh->particles, points = list->own->points;
    const double *from[EXTENTS] = { list->place, y0 };
    const double *to[EXTENTS] = { y1, y1, y0 + 3 * n, y1 + 3 * n };
    const weft__stride stride = { .h = h };
    const weft__drift rest = { .low = { 0.0 } };
    double extent[EXTENTS];
    for (size_t k = 0; k < EXTENTS; ++k) {
        const weft__range range
            = { from[k], to[k], k == 0 ? points : n, n, { 0, n }, NULL, 0 };
        weft__drift all;
        list->own->range(&range, &all);
        weft__drift_add(&all, &rest);
        extent[k] = weft__drift_extent(&all, &all);
    }
    return list->valid && list->rest == n
           && self_check_reach(&stride, extent) + WEFT__SELF_ALLOWED * list->skin
                  < list->least;
}

/* Whether the list has all pairs that can have met; then the reach of its groups is
 * set. */
static bool proves(weft__self_list *list, const weft__stride *of)
{
    const size_t velocities = 3 * list->own->points;
    const size_t count = of->h > 0.0 ? EXTENTS : 2; /* else without velocities */
    const double *from[EXTENTS] = { list->place, of->y0 };
    const double *to[EXTENTS]
        = { of->y1, of->y1, of->y0 + velocities, of->y1 + velocities };
    double extent[EXTENTS] = { 0.0 };
    for (size_t k = 0; list->valid && k < count; ++k) {
        extent[k] = weft__self_drift(list, from[k], to[k], k);
    }
    bool has = list->valid && self_check_reach(of, extent) < weft__self_lasting(list);
    for (size_t i = 0; i < list->chunk_count && has; ++i) {
        weft__self_chunk *at = &list->chunks[i];
        for (size_t g = 0; g < at->now.count && has; ++g) {
            weft__self_group *group = &at->now.at[g];
            for (size_t k = 0; k < count; ++k) {
                extent[k]
                    = weft__self_extent_between(list, k, list->between[group->tiles]);
            }
            group->reach = self_check_reach(of, extent),
            group->displacement = displacement_of(of, extent);
            has = group->reach < list->clear[group->tiles];
        }
    }
    return has;
}

/* The pairs of a kind within the reach of their group; false ends the search. */
static bool look_along(const weft__self_chunk *in, weft__pair_kind kind,
                       stride_search *of)
{
    const weft__self_pairs *at = &in->bins[kind].now;
    bool continues = true;
    for (size_t g = 0; g < in->now.count && continues; ++g) {
        const weft__self_group *to = &in->now.at[g];
        const double reach = to->reach + to->loss;
        of->displacement = to->displacement;
        const size_t end = in->now.subsets[g].end[kind];
        size_t i = weft__self_first(&in->now, g, kind);
        while (i < end && continues && !(to->nearest > reach)) {
            const size_t stop = end - i < WEFT__STRIP ? end : i + WEFT__STRIP;
            uint32_t which[WEFT__STRIP + WEFT__BLOCK];
            const size_t count
                = of->stride->own->within(at->distances, i, stop, reach, which);
            i = stop;
            continues = look_at_all(of, kind, &at->near, which, count);
        }
    }
    return continues;
}

/* ---- by tiles -------------------------------------------------------------------- */

/* [m] As far as ranges go in single precision. */
#define LONGEST 1e30

/* Pairs that a search has found, until they are looked at: those of vertices and
 * triangles, and those of edges. */
typedef struct tile_search {
    stride_search of[2];
    uint32_t which[WEFT__STRIP];
    size_t count[2];
    int32_t particle[2][WEFT__NEAR_PLANES][WEFT__STRIP];
} tile_search;

/* As look_at_all, until one of the kind is not clear. */
static void look_at_found(tile_search *in, size_t k)
{
    weft__near near = { .mass = NULL };
    for (size_t j = 0; j < WEFT__NEAR_PLANES; ++j) {
        near.particle[j] = in->particle[k][j];
    }
    if (!in->of[k].found) {
        (void)look_at_all(&in->of[k], k == 0 ? WEFT__VERTEX_TRIANGLE : WEFT__EDGES,
                          &near, in->which, in->count[k]);
    }
    in->count[k] = 0;
}

/* A weft__pair_fn; a pair of a vertex and a triangle comes before all of edges. */
static bool keep_found(void *ctx, const weft__pair *pair)
{
    tile_search *to = ctx;
    if (pair->kind >= WEFT__VERTEX_TRIANGLE) {
        const size_t k = pair->kind == WEFT__EDGES, i = to->count[k]++;
        for (size_t j = 0; j < WEFT__NEAR_PLANES; ++j) {
            to->particle[k][j][i]
                = (int32_t)(j < 4 ? pair->particle[j] : pair->item[j - 4]);
        }
        if (to->count[k] == WEFT__STRIP) {
            look_at_found(to, k);
        }
    }
    return !to->of[0].found;
}

/* [m] As far as pairs of two tiles may have been apart that can have met, and sets
 * their displacement; negative: the tiles are further apart. `most` [m]: that of any
 * tiles. */
static double reach_between(const weft__self_list *list, const uint32_t tiles[2],
                            double most, stride_search *of)
{
    const double apart
        = weft__box_distance(&list->tiles[0][tiles[0]], &list->tiles[0][tiles[1]])
          * (1.0 - WEFT__SELF_ROUNDOFF);
    double extent[EXTENTS] = { 0.0 };
    if (apart > most) {
        return -1.0;
    }
    for (size_t k = 1; k < (of->stride->h > 0.0 ? EXTENTS : 2); ++k) {
        extent[k] = weft__self_extent_between(list, k, tiles);
    }
    const double range = self_check_reach(of->stride, extent);
    of->displacement = displacement_of(of->stride, extent);
    return apart > range ? -1.0 : range;
}

/* In each kind's order, as look_at does. */
static void look_between(const weft__self_list *list, double most, stride_search *of)
{
    tile_search in = { .of = { *of, *of } };
    for (uint32_t i = 0; i < WEFT__STRIP; ++i) {
        in.which[i] = i;
    }
    for (size_t i = 0; i < list->between_count && !in.of[0].found; ++i) {
        const double range = reach_between(list, list->between[i], most, of);
        if (range >= 0.0) {
            in.of[0].displacement = in.of[1].displacement = of->displacement;
            (void)weft__self_search(list, list->between[i], range, keep_found, &in);
            look_at_found(&in, 0), look_at_found(&in, 1);
        }
    }
    *of = in.of[0].found ? in.of[0] : in.of[1];
}

/* By what two tiles move against each other, which is less than what all do. false: it
 * is not known, or the first pair is not enough. */
static bool look_by_tiles(weft__self_list *list, stride_search *of)
{
    const weft__stride *stride = of->stride;
    const size_t velocities = 3 * list->own->points;
    const double *from[EXTENTS] = { NULL, stride->y0 };
    const double *to[EXTENTS]
        = { stride->y0, stride->y1, stride->y0 + velocities, stride->y1 + velocities };
    const bool whole = list->part[0] == 0 && list->part[1] == list->own->points;
    double extent[EXTENTS] = { 0.0 };
    if (!whole || of->marks != NULL) {
        return false;
    }
    weft__self_search_place(list, stride->y0);
    for (size_t k = 0; k < (stride->h > 0.0 ? EXTENTS : 2); ++k) {
        extent[k] = weft__self_drift_all(list, from[k], to[k], k)
                        * (1.0 + WEFT__SELF_ROUNDOFF)
                    + WEFT__SELF_ALLOWED * list->skin;
    }
    extent[0] = 0.0; /* the boxes are of the start */
    const double most = self_check_reach(stride, extent);
    if (!(most < LONGEST)) {
        return false;
    }
    for (size_t i = 0; i < list->between_count; ++i) {
        if (reach_between(list, list->between[i], most, of) >= 0.0) {
            weft__self_search_mark(list, list->between[i]);
        }
    }
    weft__self_search_begin(list);
    look_between(list, most, of);
    return true;
}

/* No pair that is further apart at first can have met. */
static void self_check_look(weft__self_list *list, stride_search *of)
{
    const weft__stride *stride = of->stride;
    if (proves(list, stride)) {
        bool continues = true;
        for (size_t i = 0; i < 2 * list->chunk_count && continues; ++i) {
            continues = look_along(
                &list->chunks[i % list->chunk_count],
                i < list->chunk_count ? WEFT__VERTEX_TRIANGLE : WEFT__EDGES, of);
        }
        return;
    }
    if (look_by_tiles(list, of)) {
        return;
    }
    const size_t velocities = 3 * list->own->points;
    double extent[EXTENTS] = { 0.0, weft__extent(list->own, stride->y0, stride->y1) };
    for (size_t k = 2; k < EXTENTS && stride->h > 0.0; ++k) {
        extent[k] = weft__extent(list->own, NULL,
                                 (k == 2 ? stride->y0 : stride->y1) + velocities);
    }
    weft__quadtree tree = weft__tree_of(list->own, stride->y0);
    weft__tree_fill(&tree, list->knots);
    (void)weft__each_pair(&tree, self_check_reach(stride, extent), self_check_look_at,
                          of);
}

bool weft__self_list_clear(weft__self_list *list, const weft__stride *stride,
                           weft_primitive pair[2], double *gap)
{
    stride_search of = { .stride = stride };
    self_check_look(list, &of);
    if (of.found) {
        weft__pair_primitives(&of.pair, pair);
        *gap = of.gap;
    }
    return !of.found;
}

void weft__self_list_hold(weft__self_list *list, const double *y0, double *y1)
{
    const size_t n = list->own->points;
    const weft__stride stride = { list->own, y0, y1, 0.0 };
    for (int tries = 0; tries <= HALVINGS; ++tries) {
        stride_search of = { .stride = &stride, .marks = list->marks };
        memset(list->marks, 0, n);
        self_check_look(list, &of);
        if (!of.found) {
            return;
        }
        for (size_t i = 0; i < 6 * n; ++i) {
            y1[i] = tries == HALVINGS         ? y0[i]
                    : list->marks[i % n] != 0 ? y0[i] + 0.5 * (y1[i] - y0[i])
                                              : y1[i];
        }
    }
}
