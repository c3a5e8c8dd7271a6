/* SPDX-License-Identifier: BSD-3-Clause */
/* self_list.c -- a list about a state has pairs of primitives with their distances
 * there. Once no two particles of two tiles are displaced by more than e against each
 * other, a pair of theirs at distance D is no nearer than D - e.
 *
 * For each pair of tiles it is known how far apart their pairs are at least but for
 * those in the list: `clear`. When a list is made about a new state, `clear` loses what
 * the tiles have moved against each other; only where it no longer suffices are pairs
 * sought again. Pairs at `clear` or further apart are dropped.
 *
 * A pair that is listed has a wait: what has to change before it pushes. An evaluation
 * looks at those whose tiles have moved that much since the wait was found. A pair of
 * tiles without pairs is a group, too, where it is near enough to be watched; all
 * others are so far apart that the extent of the whole displacement proves them clear.
 */
#include <stdatomic.h>

#include "forces/contact/self/self_list.h"

enum { SHELVES = 64 };

/* Of the skin: what is left of it at least where pairs are not sought again, and how
 * far particles may have moved where slack is not found again; beside bodies half. */
#define LEAST 0.25
#define STALE 0.4
#define CLOSE 0.12 /* of the skin: pairs that may push within so much motion */

/* Of `clear`: pairs have to be sought. */
#define UNKNOWN (-1.0)

/* A quarter of the spacing is near the best of piles, and beside bodies; thick cloth
 * has less by itself, so that flat cells, whose primitives are 0.7 spacings apart, are
 * not listed. */
static double skin_of(const weft__self *own)
{
    const double a
        = own->surface != NULL ? own->surface->spacing : weft__shortest_edge(own->mesh);
    const double flat = fmax(0.1 * a, 0.65 * a - own->law.thickness);
    return own->between ? 0.25 * a : fmin(0.25 * a, flat);
}

/* Tiles that a thread takes, and runs of 4^RUN_LEVELS tiles' points. */
enum { TILES_PART = 32, RUNS_PART = 2, RUN_LEVELS = 2 };

static size_t run_count(const weft__self *own)
{
    return (weft__tile_count(own) - 1) / (1 << 2 * RUN_LEVELS) + 1;
}

/* ---- room ------------------------------------------------------------------------ */

weft_status weft__self_list_grow(weft__self_list *list, weft_error *err)
{
    for (size_t i = 0; i < list->chunk_count; ++i) {
        weft__self_chunk *of = &list->chunks[i];
        if (of->wanted <= of->room) {
            continue;
        }
        list->valid = false;
        if (!weft__self_chunk_grow(&list->memory, of)) {
            return weft_error_set(err, WEFT_NO_MEMORY,
                                  "no memory for %zu pairs of primitives that are near "
                                  "each other",
                                  of->wanted);
        }
    }
    return WEFT_OK;
}

/* Whether a primitive of a tile may have a point of the list's part. */
static bool has_of(const weft__self_list *list, size_t tile)
{
    const weft__self *own = list->own;
    const size_t *part = list->part;
    const size_t level = weft__tile_level(weft__nodes_of(own));
    size_t run[2], more[2], range[4];
    bool any = false;
    if (own->surface == NULL) {
        const size_t cols = own->mesh->cols;
        weft__patch_range(own->mesh, level, tile, range);
        for (size_t r = range[0]; r < range[1]; ++r) {
            any = any
                  || (r * cols + range[2] < part[1] && part[0] < r * cols + range[3]);
        }
        return any;
    }
    weft__patch_points(own->surface, level, true, tile, run, more);
    any = run[0] < part[1] && part[0] < run[1];
    for (size_t i = more[0]; i < more[1] && !any; ++i) {
        const size_t point = (size_t)own->surface->tile_point[i];
        any = point >= part[0] && point < part[1];
    }
    return any;
}

static bool keep_tiles(void *ctx, size_t a, size_t b)
{
    weft__self_list *list = ctx;
    uint32_t *to = list->between[list->between_count];
    to[0] = (uint32_t)a, to[1] = (uint32_t)b;
    list->between_count += list->marks[a] != 0 || list->marks[b] != 0;
    return true;
}

static bool list_tiles(weft__self_list *list)
{
    for (size_t i = 0; i < weft__tile_count(list->own); ++i) {
        list->marks[i] = has_of(list, i);
    }
    return weft__tile_pairs(list->own, keep_tiles, list);
}

/* Few chunks fill the vectors of the law; several threads need more to share. */
static bool make_chunks(weft__self_list *list)
{
    const size_t tiles = weft__pool_threads(list->pool) > 1 ? 4 : 16; /* of a chunk */
    const size_t each = weft__tile_count(list->own) / tiles + 1;
    const size_t count = each < SHELVES ? each : SHELVES;
    list->chunks = weft__zeroed(&list->memory, count, sizeof *list->chunks);
    for (size_t i = 0; i < count && list->chunks != NULL; ++i) {
        list->chunk_count = i + 1;
        if (!weft__self_chunk_create(&list->memory, i * list->between_count / count,
                                     (i + 1) * list->between_count / count,
                                     &list->chunks[i])) {
            return false;
        }
    }
    return list->chunks != NULL;
}

weft__self_list *weft__self_list_create(const weft__self *own, weft__pool *pool,
                                        const size_t part[2],
                                        const weft_allocator *memory)
{
    const size_t n = own->points, tiles = weft__tile_count(own);
    const size_t most = tiles * (tiles + 1) / 2;
    const weft__quadtree tree = weft__tree_of(own, NULL);
    weft__self_list *list = weft__zeroed(memory, 1, sizeof *list);
    if (list == NULL) {
        return NULL;
    }
    *list = (weft__self_list){
        .own = own,
        .pool = pool,
        .memory = *memory,
        .knots = weft__alloc(memory, weft__tree_size(&tree), sizeof *list->knots),
        .place = weft__alloc(memory, 3 * n, sizeof *list->place),
        .marks = weft__alloc(memory, n, 1),
        .tiles = { weft__alloc(memory, tiles, 4 * sizeof(weft__drift)) },
        .between = weft__alloc(memory, most, sizeof *list->between),
        .clear = weft__alloc(memory, most, sizeof *list->clear),
        .runs = weft__alloc(memory, run_count(own), sizeof *list->runs),
        .grouped = weft__alloc(memory, tiles + 1, sizeof *list->grouped),
        .skin = skin_of(own),
        .part = { part != NULL ? part[0] : 0, part != NULL ? part[1] : n },
    };
    for (size_t k = 1; k < 4 && list->tiles[0] != NULL; ++k) {
        list->tiles[k] = list->tiles[k - 1] + tiles;
    }
    if (list->knots == NULL || list->place == NULL || list->marks == NULL
        || list->runs == NULL || list->grouped == NULL || list->tiles[0] == NULL
        || list->between == NULL || list->clear == NULL
        || !weft__self_search_create(list) || !list_tiles(list) || !make_chunks(list)) {
        weft__self_list_destroy(list);
        return NULL;
    }
    return list;
}

void weft__self_list_destroy(weft__self_list *list)
{
    if (list == NULL) {
        return;
    }
    const weft_allocator memory = list->memory;
    for (size_t i = 0; i < list->chunk_count; ++i) {
        weft__self_chunk_free(&memory, &list->chunks[i]);
    }
    weft__boxes_free(&memory, &list->boxes);
    WEFT__FREE_ALL(&memory, list->chunks, list->knots, list->place, list->marks,
                   list->tiles[0], list->runs, list->grouped, list->between,
                   list->clear, list);
}

/* ---- displacements --------------------------------------------------------------- */

typedef struct drifting {
    const weft__self *own;
    const double *from, *to;
    const uint32_t *which; /* of tiles; NULL: all */
    size_t count, level, part;
    weft__drift *patches;
    size_t rest; /* points from here on are not displaced; 0: all may be */
} drifting;

static void drift_part(void *ctx, size_t part)
{
    const drifting *of = ctx;
    const weft__self *own = of->own;
    const size_t first = part * of->part;
    const size_t end = first + of->part < of->count ? first + of->part : of->count;
    for (size_t i = first; i < end; ++i) {
        const size_t patch = of->which != NULL ? of->which[i] : i;
        if (patch > (of->rest - 1) >> 2 * of->level) {
            of->patches[patch] = (weft__drift){ .low = { 0.0 } };
        } else if (own->surface == NULL) {
            own->drift(own, of->from, of->to, of->level, patch, patch + 1, of->patches);
        } else {
            weft__range range = { .from = of->from, .to = of->to };
            const bool tile = of->level == weft__tile_level(weft__nodes_of(own));
            size_t more[2];
            weft__patch_points(own->surface, of->level, tile, patch, range.run, more);
            range.from_plane = range.to_plane = own->points;
            range.more = own->surface->tile_point + more[0];
            range.count = more[1] - more[0];
            own->range(&range, &of->patches[patch]);
        }
    }
}

static void drift_patches(const weft__self_list *list, const drifting *of)
{
    drifting copy = *of;
    weft__pool_run(list->pool, drift_part, &copy, (of->count - 1) / of->part + 1);
}

/* [m] The extent of a displacement, and the bounds k of tiles `which`, else those of
 * all; infinite if a number is not finite. */
static double drift_tiles(weft__self_list *list, const double *from, const double *to,
                          const uint32_t *which, size_t count, size_t k)
{
    const weft__self *own = list->own;
    const size_t level = weft__tile_level(weft__nodes_of(own));
    const size_t tiles = weft__tile_count(own);
    weft__drift *at = list->tiles[k], all;
    const size_t rest = from == NULL && to == list->y ? 0 : list->rest;
    drifting of = { own, from, to, NULL, tiles, level, TILES_PART, at, rest };
    if (own->surface != NULL) {
        of.count = run_count(own), of.level += RUN_LEVELS;
        of.part = RUNS_PART, of.patches = list->runs;
    }
    drift_patches(list, &of);
    all = of.patches[0];
    for (size_t i = 1; i < of.count; ++i) {
        weft__drift_add(&all, &of.patches[i]);
    }
    if (own->surface != NULL) {
        for (size_t i = 0; which != NULL && i < tiles; ++i) {
            at[i] = all;
        }
        of.which = which, of.count = which != NULL ? count : tiles, of.level = level;
        of.part = TILES_PART, of.patches = at;
        drift_patches(list, &of);
    }
    return weft__drift_extent(&all, &all);
}

double weft__self_drift(weft__self_list *list, const double *from, const double *to,
                        size_t k)
{
    return list->group_count == 0
               ? weft__extent(list->own, from, to)
               : drift_tiles(list, from, to, list->grouped, list->grouped_count, k);
}

double weft__self_drift_all(weft__self_list *list, const double *from, const double *to,
                            size_t k)
{
    return drift_tiles(list, from, to, NULL, 0, k);
}

/* ---- making ---------------------------------------------------------------------- */

double weft__box_distance(const weft__drift *a, const weft__drift *b)
{
    double square = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double gap = fmax(a->low[k] - b->high[k], b->low[k] - a->high[k]);
        square += gap > 0.0 ? gap * gap : 0.0;
    }
    return sqrt(square);
}

/* What is left of `clear`: tiles[0] has displacements, tiles[1] places. */
static void age_part(void *ctx, size_t part)
{
    weft__self_list *list = ctx;
    const weft__self_chunk *at = &list->chunks[part];
    const double least = list->own->law.thickness + LEAST * list->skin;
    for (size_t i = at->first; i < at->end; ++i) {
        const uint32_t *tiles = list->between[i];
        double left = list->valid ? list->clear[i] - list->extent : UNKNOWN;
        if (!(left >= weft__self_watched(list))) {
            left = weft__box_distance(&list->tiles[1][tiles[0]],
                                      &list->tiles[1][tiles[1]])
                   * (1.0 - WEFT__SELF_ROUNDOFF);
        }
        if (!(left >= weft__self_watched(list)) && list->valid) {
            left = fmax(left,
                        list->clear[i] - weft__self_extent_between(list, 0, tiles));
        }
        list->clear[i] = left >= least ? left : UNKNOWN;
    }
}

/* Of a list of a part: whether a pair has one of its points. */
static bool self_list_is_wanted(const weft__self_list *list, const weft__pair *pair)
{
    bool any = false;
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        any = any
              || (pair->particle[k] >= list->part[0]
                  && pair->particle[k] < list->part[1]);
    }
    return any;
}

/* Measures the pairs of a bin from `first` on, which may be new, and drops those beyond
 * `clear`. Pinned pairs do not push, nor those that are not wanted. */
static void measure_pairs(const weft__self_list *list, weft__pair_kind kind,
                          weft__self_pairs *in, size_t first, double clear, bool new,
                          weft__self_group *to)
{
    const weft__self_law law = weft__self_law_of(list->own);
    const size_t all = in->count;
    list->own->slack(list->own, kind, &in->near, first, all, list->y, list->skin,
                     in->distances);
    in->count = first;
    weft__self_pairs_add(in, first, all, in->distances, clear, list->own->within, in);
    for (size_t i = first; i < in->count; ++i) {
        if (new) {
            const weft__pair pair = weft__near_pair(kind, &in->near, i);
            in->near.mass[i] = self_list_is_wanted(list, &pair)
                                   ? weft__pair_mass(list->own, &pair)
                                   : 0.0;
            in->near.rest[i] = weft__pair_rest(&law, &pair);
        }
        if (in->near.mass[i] == 0.0) {
            in->near.slack[i] = INFINITY;
        }
        if (kind >= WEFT__VERTEX_TRIANGLE && !(in->distances[i] > to->nearest)) {
            to->nearest = in->distances[i];
        }
    }
}

/* Of two tiles whose pairs are the last ones, after those of the group before; from:
 * another group that has had them, or NULL. */
static void self_list_add_group(const weft__self_list *list, weft__self_chunk *in,
                                size_t tiles, const weft__self_group *from)
{
    weft__self_groups *now = &in->now;
    weft__self_group *to = &now->at[now->count];
    weft__pair_subset *subset = &now->subsets[now->count];
    bool any = list->clear[tiles] < weft__self_watched(list);
    const double most = (list->own->between ? 0.5 * STALE : STALE) * list->skin;
    const bool stale = from == NULL || !(from->loss < most);
    *to = (weft__self_group){ .nearest = INFINITY };
    if (!stale) {
        *to = *from;
    }
    to->tiles = tiles, to->until = -INFINITY;
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        weft__self_pairs *at = &in->bins[kind].now;
        const size_t first = weft__self_first(now, now->count, kind);
        if (stale) {
            measure_pairs(list, (weft__pair_kind)kind, at, first, list->clear[tiles],
                          from == NULL, to);
        }
        any = any || at->count > first;
        subset->end[kind] = at->count;
    }
    now->count += any;
}

/* Lists the pairs of two tiles, which are in group `old` or, if it is NULL, in none. */
static void list_pairs(weft__self_list *list, weft__self_chunk *in, size_t tiles,
                       const weft__self_group *old)
{
    double *clear = &list->clear[tiles];
    weft__self_group kept = { .loss = 0.0 };
    const bool seek = *clear == UNKNOWN;
    if (seek) {
        *clear = weft__self_range(list);
        (void)weft__self_search(list, list->between[tiles], *clear,
                                weft__self_chunk_keep, in);
    } else if (old != NULL) {
        kept = *old;
        kept.loss += weft__self_extent_between(list, 0, list->between[tiles]);
        weft__self_chunk_copy(in, (size_t)(old - in->before.at));
    }
    if (!weft__self_chunk_full(in)) {
        self_list_add_group(list, in, tiles, seek || old == NULL ? NULL : &kept);
    }
}

static void make_part(void *ctx, size_t part)
{
    weft__self_list *list = ctx;
    weft__self_chunk *in = &list->chunks[part];
    bool stays = list->valid;
    for (size_t i = in->first; i < in->end; ++i) {
        stays = stays && list->clear[i] != UNKNOWN;
    }
    weft__self_chunk_begin(in, stays);
    const weft__self_group *old = in->before.at,
                           *end = old + (list->valid ? in->before.count : 0);
    for (size_t i = in->first; i < in->end && !in->full; ++i) {
        const bool listed = old < end && old->tiles == i;
        if (list->clear[i] < weft__self_watched(list)) {
            list_pairs(list, in, i, listed ? old : NULL);
        }
        old += listed;
    }
}

/* Whether a group has pairs, or its clear is less than the range. */
static bool is_needed(const weft__self_list *list, const weft__self_groups *of,
                      size_t i)
{
    bool any = list->clear[of->at[i].tiles] < weft__self_range(list);
    for (size_t kind = 0; kind < WEFT__KINDS; ++kind) {
        any = any || of->subsets[i].end[kind] > weft__self_first(of, i, kind);
    }
    return any;
}

static void find_grouped(weft__self_list *list)
{
    memset(list->marks, 0, weft__tile_count(list->own));
    list->grouped_count = 0;
    for (size_t i = 0; i < list->chunk_count; ++i) {
        const weft__self_groups *of = &list->chunks[i].now;
        for (size_t g = 0; g < 2 * of->count; ++g) {
            const uint32_t tile = list->between[of->at[g / 2].tiles][g % 2];
            list->grouped[list->grouped_count] = tile;
            list->grouped_count += list->marks[tile] == 0;
            list->marks[tile] = 1;
        }
    }
}

/* Where no group is needed none is watched: nearly flat cloth has no groups. */
static void end_making(weft__self_list *list)
{
    bool needed = false;
    list->group_count = 0;
    list->valid = true;
    list->least = weft__self_range(list);
    for (size_t i = 0; i < list->chunk_count; ++i) {
        weft__self_chunk *at = &list->chunks[i];
        list->valid = list->valid && !at->full;
        list->group_count += at->now.count;
        for (size_t g = 0; g < at->now.count; ++g) {
            at->now.subsets[g].moved
                = at->now.at[g].loss + WEFT__SELF_ALLOWED * list->skin;
            needed = needed || is_needed(list, &at->now, g);
            list->least
                = fmin(list->least, fmin(list->clear[at->now.at[g].tiles],
                                         at->now.at[g].nearest - at->now.at[g].loss));
        }
    }
    for (size_t i = 0; i < list->chunk_count && !needed; ++i) {
        list->group_count = list->chunks[i].now.count = 0;
    }
    find_grouped(list);
}

/* Of a list that is valid tiles[0] has the displacements since. */
static void self_list_make(weft__self_list *list, const double *y)
{
    const weft__self *own = list->own;
    bool seek = false;
    weft__self_search_place(list, y);
    list->valid
        = list->valid && list->group_count > 0; /* else the most room is found */
    (void)drift_tiles(list, NULL, y, NULL, 0, 1);
    weft__pool_run(list->pool, age_part, list, list->chunk_count);
    for (size_t i = 0; i < list->between_count; ++i) {
        if (list->clear[i] == UNKNOWN) {
            weft__self_search_mark(list, list->between[i]);
            seek = true;
        }
    }
    if (seek) {
        weft__self_search_begin(list);
    }
    weft__pool_run(list->pool, make_part, list, list->chunk_count);
    memcpy(list->place, y, 3 * own->points * sizeof *y);
    list->pin_changes = own->mesh->pin_changes;
    end_making(list);
}

/* Whether the list has all pairs that push after displacements tiles[0]. Sets what
 * its groups have moved. */
static bool suffices(weft__self_list *list, double extent)
{
    bool all = extent < weft__self_lasting(list) - list->own->law.thickness;
    for (size_t i = 0; i < list->chunk_count && all; ++i) {
        const weft__self_groups *at = &list->chunks[i].now;
        for (size_t g = 0; g < at->count && all; ++g) {
            const size_t tiles = at->at[g].tiles;
            const double moved
                = weft__self_extent_between(list, 0, list->between[tiles]);
            all = moved < list->clear[tiles] - list->own->law.thickness;
            at->subsets[g].moved = moved + at->at[g].loss;
        }
    }
    return all;
}

static bool any_full(const weft__self_list *list)
{
    bool any = false;
    for (size_t i = 0; i < list->chunk_count; ++i) {
        any = any || list->chunks[i].full;
    }
    return any;
}

/* The list, made anew if need be, has all pairs that push. */
typedef enum readiness { READY, WITHOUT_LIST, NOT_FINITE } readiness;

static readiness self_list_prepare(weft__self_list *list, const double *y)
{
    list->valid = list->valid && list->pin_changes == list->own->mesh->pin_changes;
    const double extent = list->valid ? weft__self_drift(list, list->place, y, 0)
                                      : weft__extent(list->own, NULL, y);
    if (!isfinite(extent)) {
        return NOT_FINITE;
    }
    list->extent = extent * (1.0 + WEFT__SELF_ROUNDOFF);
    if (list->valid && suffices(list, extent)) {
        return READY;
    }
    if (!any_full(list)) {
        self_list_make(list, y);
    }
    return list->valid ? READY : WITHOUT_LIST;
}

/* ---- forces ---------------------------------------------------------------------- */

typedef struct evaluation {
    weft__self_list *list;
    const weft__self_pass *pass;
    weft__pushes *room; /* for those of any bin in turn, by one thread; or NULL */
    atomic_bool bad;
} evaluation;

/* Finds the close pairs, which may push before their tiles have moved by `more` [m]
 * beyond what they have, unless the last ones suffice. */
static void find_close(weft__self_chunk *of, double more, weft__within_fn *within)
{
    const weft__self_groups *now = &of->now;
    bool found = true;
    for (size_t g = 0; g < now->count; ++g) {
        const double moved = of->before.subsets[g].moved = now->subsets[g].moved;
        found = found && moved <= now->at[g].until;
    }
    for (size_t kind = 0; kind < WEFT__KINDS && !found; ++kind) {
        weft__self_bin *in = &of->bins[kind];
        in->before.count = 0;
        for (size_t g = 0, i = 0; g < now->count; ++g) {
            const double until = now->at[g].until = now->subsets[g].moved + more;
            weft__self_pairs_add(&in->now, i, now->subsets[g].end[kind],
                                 in->now.near.slack, until, within, &in->before);
            i = now->subsets[g].end[kind];
            of->before.subsets[g].end[kind] = in->before.count;
        }
    }
}

static size_t push_bin(evaluation *all, weft__self_chunk *in, weft__pair_kind kind,
                       weft__pushes *out)
{
    const weft__self_law *law = &all->pass->law;
    const weft__self *own = law->own;
    const weft__self_bin *at = &in->bins[kind];
    weft__pushes_fn *pushes = law->along != NULL  ? weft__pushes_derivatives
                              : law->base != NULL ? weft__pushes_perturbed
                                                  : own->pushes;
    double bad = 0.0;
    const size_t count
        = pushes(law, kind, own->between ? &at->before.near : &at->now.near,
                 own->between ? in->before.subsets : in->now.subsets, in->now.count,
                 all->pass->y, out, &bad);
    if (bad != 0.0) {
        atomic_store(&all->bad, true);
    }
    return count;
}

static void evaluate_part(void *ctx, size_t part)
{
    evaluation *all = ctx;
    weft__self_chunk *in = &all->list->chunks[part];
    if (all->list->own->between) { /* piles make their lists too often for it to pay */
        find_close(in, CLOSE * all->list->skin, all->list->own->within);
    }
    for (size_t kind = 0; kind < WEFT__KINDS && all->room == NULL; ++kind) {
        weft__self_bin *at = &in->bins[kind];
        at->pushing = push_bin(all, in, (weft__pair_kind)kind, at->pushes);
    }
}

/* Of the chunk that has the most room. */
static weft__pushes *widest(const weft__self_list *list)
{
    const weft__self_chunk *out = &list->chunks[0];
    for (size_t i = 1; i < list->chunk_count; ++i) {
        out = list->chunks[i].room > out->room ? &list->chunks[i] : out;
    }
    return out->bins[0].pushes;
}

/* In the order of weft__each_pair. One thread calls `each` with a bin as soon as it is
 * filled, in a room that stays in its cache; of several one does so when all are
 * filled: two that each add half of them took longer. */
int weft__self_list_each(weft__self_list *list, const double *y, weft__self_pass *pass)
{
    const bool alone = weft__pool_threads(list->pool) == 1;
    const readiness is = self_list_prepare(list, y);
    evaluation all
        = { .list = list, .pass = pass, .room = alone ? widest(list) : NULL };
    if (pass->law.own != list->own) {
        pass->law.base = list->own, pass->law.base_y = y;
    }
    if (is != READY) {
        return is == NOT_FINITE ? 1 : weft__self_each(pass, list->knots);
    }
    if (list->group_count > 0) {
        weft__pool_run(list->pool, evaluate_part, &all, list->chunk_count);
    }
    for (size_t j = 0; j < WEFT__KINDS * list->chunk_count && list->group_count > 0;
         ++j) {
        const weft__pair_kind kind = (weft__pair_kind)(j / list->chunk_count);
        weft__self_chunk *in = &list->chunks[j % list->chunk_count];
        weft__self_bin *at = &in->bins[kind];
        if (alone) {
            at->pushing = push_bin(&all, in, kind, all.room);
        }
        pass->each(pass->ctx, kind, alone ? all.room : at->pushes, at->pushing);
    }
    return atomic_load(&all.bad) ? 1 : 0;
}

/* ---- pairs that push ------------------------------------------------------------- */

typedef struct visiting {
    const weft__self *own;
    const double *y;
    weft__pair_fn *visit;
    void *ctx;
} visiting;

/* Visits those of pairs `which` that push; false: a visit ended it. */
static bool visit_pushing(const visiting *of, weft__pair_kind kind,
                          const weft__near *near, const uint32_t *which, size_t count)
{
    uint32_t found[WEFT__STRIP];
    bool continues = true;
    count = of->own->meets(of->own, kind, near, which, count, of->y, found);
    for (size_t i = 0; i < count && continues; ++i) {
        const weft__pair pair = weft__near_pair(kind, near, found[i]);
        continues = of->visit(of->ctx, &pair);
    }
    return continues;
}

/* Those of a chunk that have waited long enough are looked at, WEFT__STRIP at a time.
 */
static bool visit_along(const visiting *of, const weft__self_chunk *in,
                        weft__pair_kind kind)
{
    const weft__near *near = &in->bins[kind].now.near;
    uint32_t which[WEFT__STRIP + WEFT__BLOCK];
    size_t count = 0, i = 0;
    bool continues = true;
    for (size_t g = 0; g < in->now.count && continues; ++g) {
        const weft__pair_subset *subset = &in->now.subsets[g];
        while (i < subset->end[kind] && continues) {
            const size_t left = subset->end[kind] - i, room = WEFT__STRIP - count;
            const size_t stop = i + (left < room ? left : room);
            count
                += of->own->within(near->slack, i, stop, subset->moved, which + count);
            i = stop;
            if (count == WEFT__STRIP) {
                continues = visit_pushing(of, kind, near, which, count);
                count = 0;
            }
        }
    }
    return continues && visit_pushing(of, kind, near, which, count);
}

bool weft__self_list_seek(weft__self_list *list, const double *y, weft__pair_fn *visit,
                          void *ctx)
{
    const readiness is = self_list_prepare(list, y);
    const visiting of = { list->own, y, visit, ctx };
    bool continues = is == READY;
    if (is == WITHOUT_LIST) {
        return weft__self_seek(list->own, list->knots, y, visit, ctx);
    }
    for (size_t j = 0; j < WEFT__KINDS * list->chunk_count && continues; ++j) {
        continues = visit_along(&of, &list->chunks[j % list->chunk_count],
                                (weft__pair_kind)(j / list->chunk_count));
    }
    return continues;
}
