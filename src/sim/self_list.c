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
#include "sim/self_list.h"

#include <stdatomic.h>

#include "base/memory.h"
#include "cloth/levels.h"

enum {
    KINDS = WEFT__EDGES + 1,
    STRETCH = 256,
    ROOM = 512,
    SHELVES = 64,
    HALVINGS = 60
};

/* Allowed for roundoff, relative. */
#define ROUNDOFF 1e-9
/* Of the skin. */
#define ALLOWED 1e-6

/* Of the skin: what is left of it at least where pairs are not sought again, and how
 * far particles may have moved against each other where waits are not found again. */
#define LEAST 0.25
#define STALE 0.4

/* Skins beyond the range: nearer tiles are watched. */
#define WATCHED 3.0

/* Of `clear`: pairs have to be sought. */
#define UNKNOWN (-1.0)

/* Two tiles that are near each other; their pairs are a weft__span. */
typedef struct group {
    size_t tiles;   /* in `between` */
    double nearest; /* [m] of its pairs that the step check looks at */
    double loss;    /* [m] moved between where its pairs were measured and `place` */
    double reach;   /* [m] as far as they matter in a step */
} group;

typedef struct groups {
    size_t count;
    group *at;
    weft__span *spans;
} groups;

/* Pairs of a kind. */
typedef struct pairs {
    size_t count;
    weft__near near;
    double *distances; /* [m] */
} pairs;

/* Those of a kind, and their pushes. */
typedef struct bin {
    pairs now, before; /* before: while a list is made anew, the old one */
    weft__pushes *pushes;
    size_t pushing;
} bin;

/* The groups of successive pairs of tiles: one thread makes and evaluates them. */
typedef struct shelf {
    size_t first, end; /* in `between` */
    groups now, before;
    bin bins[KINDS];
    size_t room, wanted; /* pairs of a kind; wanted: before the next step */
    bool full;           /* without some pairs */
} shelf;

struct weft__self_list {
    const weft_cloth *cloth;
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
    shelf *shelves;
    size_t shelf_count;
};

static void run(weft__team *team, weft__task *task, void *ctx, size_t parts)
{
    if (team != NULL && parts > 1) {
        weft__team_run(team, task, ctx, parts);
        return;
    }
    for (size_t i = 0; i < parts; ++i) {
        task(ctx, i);
    }
}

/* A quarter of the spacing is near the best of piles; thick cloth has less, so that
 * flat cells, whose primitives are 0.7 spacings apart, are not listed. */
static double skin_of(const weft_cloth *cloth)
{
    const double a = weft__smaller_spacing(cloth->rows, cloth->cols, cloth->spacing);
    return fmin(0.25 * a, fmax(0.1 * a, 0.65 * a - cloth->contact.thickness));
}

/* [m] All pairs that are nearer are in the list when it has been sought. */
static double range_of(const weft__self_list *list)
{
    return list->cloth->contact.thickness + list->skin;
}

/* [m] Tiles whose pairs are nearer are watched. */
static double watched_of(const weft__self_list *list)
{
    return range_of(list) + WATCHED * list->skin;
}

/* ---- room ------------------------------------------------------------------------ */

static void free_pairs(const weft_allocator *memory, pairs *of)
{
    weft__free(memory, of->near.particle[0]);
    weft__free(memory, of->near.waits);
    *of = (pairs){ .count = 0 };
}

static bool make_pairs(const weft_allocator *memory, size_t room, pairs *of)
{
    const size_t all = room + WEFT__BLOCK;
    weft__near *near = &of->near;
    free_pairs(memory, of);
    near->particle[0] = weft__zeroed(memory, 4 * all, sizeof(int32_t));
    near->waits = weft__zeroed(memory, 4 * all, sizeof(double));
    if (near->particle[0] == NULL || near->waits == NULL) {
        return false;
    }
    for (size_t k = 1; k < 4; ++k) {
        near->particle[k] = near->particle[k - 1] + all;
    }
    near->mass = near->waits + all, near->rest = near->mass + all;
    of->distances = near->rest + all;
    return true;
}

static void free_groups(const weft_allocator *memory, groups *of)
{
    weft__free(memory, of->at);
    weft__free(memory, of->spans);
}

static bool make_groups(const weft_allocator *memory, size_t most, groups *of)
{
    of->at = weft__alloc(memory, most, sizeof *of->at);
    of->spans = weft__alloc(memory, most, sizeof *of->spans);
    return of->at != NULL && of->spans != NULL;
}

static bool grow_shelf(const weft_allocator *memory, shelf *of)
{
    bool made = true;
    of->room = (of->wanted / STRETCH + 1) * STRETCH;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *at = &of->bins[kind];
        weft__free(memory, at->pushes);
        at->pushes
            = weft__alloc(memory, of->room / WEFT__BLOCK + 1, sizeof *at->pushes);
        made = make_pairs(memory, of->room, &at->now)
               && make_pairs(memory, of->room, &at->before) && at->pushes != NULL
               && made;
    }
    of->room = made ? of->room : 0;
    of->full = false;
    return made;
}

weft_status weft__self_list_grow(weft__self_list *list, weft_error *err)
{
    for (size_t i = 0; i < list->shelf_count; ++i) {
        shelf *of = &list->shelves[i];
        if (of->wanted <= of->room) {
            continue;
        }
        list->valid = false;
        if (!grow_shelf(&list->memory, of)) {
            return weft_error_set(err, WEFT_NO_MEMORY,
                                  "no memory for %zu pairs of primitives that are near "
                                  "each other",
                                  of->wanted);
        }
    }
    return WEFT_OK;
}

static bool keep_tiles(void *ctx, size_t a, size_t b)
{
    weft__self_list *list = ctx;
    uint32_t *to = list->between[list->between_count++];
    to[0] = (uint32_t)a, to[1] = (uint32_t)b;
    return true;
}

static bool make_shelves(weft__self_list *list)
{
    const size_t each = weft__tile_count(list->cloth) / 4 + 1;
    const size_t count = each < SHELVES ? each : SHELVES;
    list->shelves = weft__zeroed(&list->memory, count, sizeof *list->shelves);
    for (size_t i = 0; i < count && list->shelves != NULL; ++i) {
        shelf *of = &list->shelves[i];
        *of = (shelf){ .first = i * list->between_count / count,
                       .end = (i + 1) * list->between_count / count,
                       .wanted = ROOM };
        const size_t most = of->end - of->first + 1;
        list->shelf_count = i + 1;
        if (!make_groups(&list->memory, most, &of->now)
            || !make_groups(&list->memory, most, &of->before)) {
            return false;
        }
    }
    return list->shelves != NULL && weft__self_list_grow(list, NULL) == WEFT_OK;
}

weft__self_list *weft__self_list_create(const weft_cloth *cloth, weft__team *team,
                                        const weft_allocator *memory)
{
    const size_t n = cloth->particles, tiles = weft__tile_count(cloth);
    const size_t most = tiles * (tiles + 1) / 2;
    weft__self_list *list = weft__zeroed(memory, 1, sizeof *list);
    if (list == NULL) {
        return NULL;
    }
    *list = (weft__self_list){
        .cloth = cloth,
        .team = team,
        .memory = *memory,
        .knots = weft__alloc(memory, weft__tree_size(cloth), sizeof *list->knots),
        .place = weft__alloc(memory, 3 * n, sizeof *list->place),
        .marks = weft__alloc(memory, n, 1),
        .tiles = { weft__alloc(memory, tiles, 5 * sizeof(weft__drift)) },
        .between = weft__alloc(memory, most, sizeof *list->between),
        .clear = weft__alloc(memory, most, sizeof *list->clear),
        .skin = skin_of(cloth),
    };
    for (size_t k = 1; k < 5 && list->tiles[0] != NULL; ++k) {
        list->tiles[k] = list->tiles[k - 1] + tiles;
    }
    if (list->knots == NULL || list->place == NULL || list->marks == NULL
        || list->tiles[0] == NULL || list->between == NULL || list->clear == NULL
        || !weft__tile_pairs(cloth, keep_tiles, list) || !make_shelves(list)) {
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
    for (size_t i = 0; i < list->shelf_count; ++i) {
        for (size_t kind = 0; kind < KINDS; ++kind) {
            bin *at = &list->shelves[i].bins[kind];
            free_pairs(&memory, &at->now);
            free_pairs(&memory, &at->before);
            weft__free(&memory, at->pushes);
        }
        free_groups(&memory, &list->shelves[i].now);
        free_groups(&memory, &list->shelves[i].before);
    }
    weft__free(&memory, list->shelves);
    weft__free(&memory, list->knots);
    weft__free(&memory, list->place);
    weft__free(&memory, list->marks);
    weft__free(&memory, list->tiles[0]);
    weft__free(&memory, list->between);
    weft__free(&memory, list->clear);
    weft__free(&memory, list);
}

void weft__self_list_set_skin(weft__self_list *list, double skin)
{
    list->skin = skin;
    list->valid = false;
}

/* ---- displacements --------------------------------------------------------------- */

enum { DRIFT_PART = 32 }; /* tiles */

typedef struct drifting {
    const weft_cloth *cloth;
    const double *from, *to;
    weft__drift *tiles;
} drifting;

static void drift_part(void *ctx, size_t part)
{
    const drifting *of = ctx;
    const size_t tiles = weft__tile_count(of->cloth), first = part * DRIFT_PART;
    of->cloth->level->drift(of->cloth, of->from, of->to, first,
                            first + DRIFT_PART < tiles ? first + DRIFT_PART : tiles,
                            of->tiles);
}

/* [m] The extent of a displacement, and the bounds k of tiles; infinite if a number is
 * not finite. */
static double drift_tiles(weft__self_list *list, const double *from, const double *to,
                          size_t k)
{
    const size_t tiles = weft__tile_count(list->cloth);
    drifting of = { list->cloth, from, to, list->tiles[k] };
    weft__drift all;
    run(list->team, drift_part, &of, (tiles - 1) / DRIFT_PART + 1);
    all = of.tiles[0];
    for (size_t i = 1; i < tiles; ++i) {
        weft__drift_add(&all, &of.tiles[i]);
    }
    return weft__drift_extent(&all, &all);
}

/* Without groups no tiles are needed. */
static double drift(weft__self_list *list, const double *from, const double *to,
                    size_t k)
{
    return list->group_count == 0 ? weft__extent(list->cloth, from, to)
                                  : drift_tiles(list, from, to, k);
}

/* ---- making ---------------------------------------------------------------------- */

typedef struct making {
    weft__self_list *list;
    const double *y;
} making;

/* [m] Of the last displacements k, with an allowance for roundoff. */
static double extent_between(const weft__self_list *list, size_t k,
                             const uint32_t tiles[2])
{
    return weft__drift_extent(&list->tiles[k][tiles[0]], &list->tiles[k][tiles[1]])
               * (1.0 + ROUNDOFF)
           + ALLOWED * list->skin;
}

/* [m] Between the boxes about two tiles. */
static double box_distance(const weft__drift *a, const weft__drift *b)
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
    const making *of = ctx;
    weft__self_list *list = of->list;
    const shelf *at = &list->shelves[part];
    const double least = list->cloth->contact.thickness + LEAST * list->skin;
    for (size_t i = at->first; i < at->end; ++i) {
        const uint32_t *tiles = list->between[i];
        double left = list->valid ? list->clear[i] - list->extent : UNKNOWN;
        if (!(left >= watched_of(list))) {
            left = box_distance(&list->tiles[1][tiles[0]], &list->tiles[1][tiles[1]])
                   * (1.0 - ROUNDOFF);
        }
        if (!(left >= watched_of(list)) && list->valid) {
            left = fmax(left, list->clear[i] - extent_between(list, 0, tiles));
        }
        list->clear[i] = left >= least ? left : UNKNOWN;
    }
}

/* Those in the rectangle about two tiles, where the search looks for flat patches. */
static void mark_tiles(weft__self_list *list, const uint32_t tiles[2])
{
    const weft_cloth *cloth = list->cloth;
    const size_t cols = weft__patches(cloth->cols, weft__tile_level(cloth));
    const size_t r[2] = { tiles[0] / cols, tiles[1] / cols };
    const size_t c[2] = { tiles[0] % cols, tiles[1] % cols };
    const size_t top = r[0] < r[1] ? r[0] : r[1], left = c[0] < c[1] ? c[0] : c[1];
    const size_t high = r[0] + r[1] - 2 * top + 1, wide = c[0] + c[1] - 2 * left + 1;
    list->marks[tiles[0]] = list->marks[tiles[1]] = 1;
    for (size_t i = 0; high <= 3 && wide <= 3 && i < high * wide; ++i) {
        list->marks[(top + i / wide) * cols + left + i % wide] = 1;
    }
}

static void fill_part(void *ctx, size_t part)
{
    const making *of = ctx;
    weft__self_list *list = of->list;
    const size_t tiles = weft__tile_count(list->cloth);
    for (size_t i = part; i < tiles; i += list->shelf_count) {
        if (list->marks[i] != 0) {
            weft__tree_fill_tile(&list->tree, i);
        }
    }
}

/* A search that adds to a shelf; more than its room are counted. */
static bool keep(void *ctx, const weft__pair *pair)
{
    shelf *to = ctx;
    pairs *of = &to->bins[pair->kind].now;
    if (of->count < to->room) {
        for (size_t k = 0; k < 4; ++k) {
            of->near.particle[k][of->count] = (int32_t)pair->particle[k];
        }
    }
    ++of->count;
    return true;
}

/* Where the pairs of a group begin. */
static size_t first_of(const groups *of, size_t i, size_t kind)
{
    return i > 0 ? of->spans[i - 1].end[kind] : 0;
}

static void copy_numbers(double *to, const double *from, size_t count)
{
    memcpy(to, from, count * sizeof *to);
}

/* Pair `from` becomes pair `to`. */
static inline void move_pair(pairs *in, size_t from, size_t to)
{
    for (size_t k = 0; k < 4; ++k) {
        in->near.particle[k][to] = in->near.particle[k][from];
    }
    in->near.waits[to] = in->near.waits[from];
    in->near.mass[to] = in->near.mass[from];
    in->near.rest[to] = in->near.rest[from];
    in->distances[to] = in->distances[from];
}

/* Adds the pairs of group i of `before`. */
static void copy_group(shelf *of, size_t i)
{
    for (size_t kind = 0; kind < KINDS; ++kind) {
        pairs *to = &of->bins[kind].now;
        const pairs *from = &of->bins[kind].before;
        const size_t first = first_of(&of->before, i, kind);
        const size_t count = of->before.spans[i].end[kind] - first;
        if (to->count + count > of->room) {
            of->full = true;
            return;
        }
        for (size_t k = 0; k < 4; ++k) {
            memcpy(to->near.particle[k] + to->count, from->near.particle[k] + first,
                   count * sizeof(int32_t));
        }
        copy_numbers(to->near.waits + to->count, from->near.waits + first, count);
        copy_numbers(to->near.mass + to->count, from->near.mass + first, count);
        copy_numbers(to->near.rest + to->count, from->near.rest + first, count);
        copy_numbers(to->distances + to->count, from->distances + first, count);
        to->count += count;
    }
}

/* Sets what a pair has by its particles. */
static void weigh_pair(const weft__self_law *law, weft__pair_kind kind, weft__near *in,
                       size_t i)
{
    const weft__pair pair = weft__near_pair(kind, in, i);
    in->mass[i] = weft__pair_mass(law->cloth, &pair);
    in->rest[i] = weft__pair_rest(law, &pair);
}

/* Measures the pairs of a bin from `first` on, which may be new, and drops those at
 * `clear`. Pinned pairs do not push. */
static void measure_pairs(const making *of, weft__pair_kind kind, pairs *in,
                          size_t first, double clear, bool new, group *to)
{
    const weft__self_list *list = of->list;
    const weft__self_law law = weft__self_law_of(list->cloth);
    const size_t all = in->count;
    list->cloth->level->waits(list->cloth, kind, &in->near, first, all, of->y,
                              list->skin, in->distances);
    in->count = first;
    for (size_t i = first; i < all; ++i) {
        const double distance = in->distances[i];
        if (distance >= clear) {
            continue;
        }
        const size_t at = in->count++;
        if (i != at) {
            move_pair(in, i, at);
        }
        if (new) {
            weigh_pair(&law, kind, &in->near, at);
        }
        if (!(in->near.mass[at] > 0.0)) {
            in->near.waits[at] = INFINITY;
        }
        if (kind >= WEFT__VERTEX_TRIANGLE && !(distance > to->nearest)) {
            to->nearest = distance;
        }
    }
}

/* More room is wanted as soon as half of it is used. */
static bool is_full(shelf *of)
{
    for (size_t kind = 0; kind < KINDS; ++kind) {
        const size_t count = of->bins[kind].now.count;
        of->full = of->full || count > of->room;
        if (2 * count > of->room && 3 * count > of->wanted) {
            of->wanted = 3 * count;
        }
    }
    return of->full;
}

static void begin_shelf(shelf *of)
{
    const groups old = of->now;
    of->now = of->before, of->before = old;
    of->now.count = 0;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *in = &of->bins[kind];
        const pairs other = in->now;
        in->now = in->before, in->before = other;
        in->now.count = 0;
    }
}

/* Of two tiles whose pairs are the last ones, after those of the group before; from:
 * another group that has had them, or NULL. */
static void add_group(const making *of, shelf *in, size_t tiles, const group *from)
{
    const weft__self_list *list = of->list;
    groups *now = &in->now;
    group *to = &now->at[now->count];
    weft__span *span = &now->spans[now->count];
    bool any = list->clear[tiles] < watched_of(list);
    const bool stale = from == NULL || !(from->loss < STALE * list->skin);
    *to = (group){ .nearest = INFINITY };
    if (!stale) {
        *to = *from;
    }
    to->tiles = tiles;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        pairs *at = &in->bins[kind].now;
        const size_t first = first_of(now, now->count, kind);
        if (stale) {
            measure_pairs(of, (weft__pair_kind)kind, at, first, list->clear[tiles],
                          from == NULL, to);
        }
        any = any || at->count > first;
        span->end[kind] = at->count;
    }
    now->count += any;
}

/* Lists the pairs of two tiles, which are in group `old` or, if it is NULL, in none. */
static void list_pairs(const making *of, shelf *in, size_t tiles, const group *old)
{
    weft__self_list *list = of->list;
    double *clear = &list->clear[tiles];
    group kept = { .loss = 0.0 };
    const bool seek = *clear == UNKNOWN;
    if (seek) {
        *clear = range_of(list);
        (void)weft__each_pair_between(&list->tree, list->between[tiles], *clear, keep,
                                      in);
    } else if (old != NULL) {
        kept = *old;
        kept.loss += extent_between(list, 0, list->between[tiles]);
        copy_group(in, (size_t)(old - in->before.at));
    }
    if (!is_full(in)) {
        add_group(of, in, tiles, seek || old == NULL ? NULL : &kept);
    }
}

static void make_part(void *ctx, size_t part)
{
    const making *of = ctx;
    weft__self_list *list = of->list;
    shelf *in = &list->shelves[part];
    begin_shelf(in);
    const group *old = in->before.at, *end = old + (list->valid ? in->before.count : 0);
    for (size_t i = in->first; i < in->end && !in->full; ++i) {
        const bool listed = old < end && old->tiles == i;
        if (list->clear[i] < watched_of(list)) {
            list_pairs(of, in, i, listed ? old : NULL);
        }
        old += listed;
    }
}

/* Whether a group has pairs, or its clear is less than the range. */
static bool is_needed(const weft__self_list *list, const groups *of, size_t i)
{
    bool any = list->clear[of->at[i].tiles] < range_of(list);
    for (size_t kind = 0; kind < KINDS; ++kind) {
        any = any || of->spans[i].end[kind] > first_of(of, i, kind);
    }
    return any;
}

/* Where no group is needed none is watched: nearly flat cloth has no groups. */
static void end_making(weft__self_list *list)
{
    bool needed = false;
    list->group_count = 0;
    list->valid = true;
    for (size_t i = 0; i < list->shelf_count; ++i) {
        shelf *at = &list->shelves[i];
        list->valid = list->valid && !at->full;
        list->group_count += at->now.count;
        for (size_t g = 0; g < at->now.count; ++g) {
            at->now.spans[g].moved = at->now.at[g].loss + ALLOWED * list->skin;
            needed = needed || is_needed(list, &at->now, g);
        }
    }
    for (size_t i = 0; i < list->shelf_count && !needed; ++i) {
        list->group_count = list->shelves[i].now.count = 0;
    }
}

/* [m] Primitives that are not in a group have this distance in `place` at least. */
static double lasting_of(const weft__self_list *list)
{
    return list->group_count > 0 ? watched_of(list) : range_of(list);
}

/* Of a list that is valid tiles[0] has the displacements since. */
static void make(weft__self_list *list, const double *y)
{
    making of = { list, y };
    const weft_cloth *cloth = list->cloth;
    bool seek = false;
    list->valid
        = list->valid && list->group_count > 0; /* else the most room is found */
    (void)drift_tiles(list, NULL, y, 1);
    run(list->team, age_part, &of, list->shelf_count);
    memset(list->marks, 0, weft__tile_count(cloth));
    for (size_t i = 0; i < list->between_count; ++i) {
        if (list->clear[i] == UNKNOWN) {
            mark_tiles(list, list->between[i]);
            seek = true;
        }
    }
    if (seek) {
        list->tree = weft__tree_of(cloth, y);
        weft__tree_begin(&list->tree, list->knots);
        run(list->team, fill_part, &of, list->shelf_count);
    }
    run(list->team, make_part, &of, list->shelf_count);
    memcpy(list->place, y, 3 * cloth->particles * sizeof *y);
    list->pin_changes = cloth->pin_changes;
    end_making(list);
}

/* Whether the list has all pairs that push after displacements tiles[0]. Sets what
 * its groups have moved. */
static bool suffices(weft__self_list *list, double extent)
{
    bool all = extent < lasting_of(list) - list->cloth->contact.thickness;
    for (size_t i = 0; i < list->shelf_count && all; ++i) {
        const groups *at = &list->shelves[i].now;
        for (size_t g = 0; g < at->count && all; ++g) {
            const size_t tiles = at->at[g].tiles;
            const double moved = extent_between(list, 0, list->between[tiles]);
            all = moved < list->clear[tiles] - list->cloth->contact.thickness;
            at->spans[g].moved = moved + at->at[g].loss;
        }
    }
    return all;
}

static bool any_full(const weft__self_list *list)
{
    bool any = false;
    for (size_t i = 0; i < list->shelf_count; ++i) {
        any = any || list->shelves[i].full;
    }
    return any;
}

/* The list, made anew if need be, has all pairs that push. */
typedef enum readiness { READY, WITHOUT_LIST, NOT_FINITE } readiness;

static readiness prepare(weft__self_list *list, const double *y)
{
    list->valid = list->valid && list->pin_changes == list->cloth->pin_changes;
    const double extent = list->valid ? drift(list, list->place, y, 0)
                                      : weft__extent(list->cloth, NULL, y);
    if (!isfinite(extent)) {
        return NOT_FINITE;
    }
    list->extent = extent * (1.0 + ROUNDOFF);
    if (list->valid && suffices(list, extent)) {
        return READY;
    }
    if (!any_full(list)) {
        make(list, y);
    }
    return list->valid ? READY : WITHOUT_LIST;
}

/* ---- forces ---------------------------------------------------------------------- */

typedef struct evaluation {
    weft__self_list *list;
    weft__self_law law;
    const weft__subject *of;
    atomic_bool bad;
} evaluation;

static void evaluate_part(void *ctx, size_t part)
{
    evaluation *all = ctx;
    shelf *in = &all->list->shelves[part];
    double bad = 0.0;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *at = &in->bins[kind];
        at->pushing = all->law.cloth->level->pushes(
            &all->law, (weft__pair_kind)kind, &at->now.near, in->now.spans,
            in->now.count, all->of->y, at->pushes, &bad);
    }
    if (bad != 0.0) {
        atomic_store(&all->bad, true);
    }
}

/* Fills the pushes of a list that is ready; returns whether there can be any. */
static bool evaluate(evaluation *all)
{
    if (all->list->group_count == 0) {
        return false;
    }
    all->law = weft__self_law_of(all->list->cloth);
    run(all->list->team, evaluate_part, all, all->list->shelf_count);
    return true;
}

static void add_pushes(const weft_cloth *cloth, const bin *of, size_t corners,
                       double *to)
{
    const size_t n = cloth->particles;
    for (size_t i = 0; i < of->pushing; ++i) {
        const weft__pushes *from = &of->pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        for (size_t k = 0; k < corners; ++k) {
            const size_t at = (size_t)from->particle[k][lane];
            const double scale = cloth->inverse_mass[at];
            for (size_t j = 0; j < 3 && scale > 0.0; ++j) {
                to[j * n + at] += scale * from->force[k][j][lane];
            }
        }
    }
}

/* In the order of weft__each_pair. By one thread: the pushes of others come from their
 * caches, and two that each add half of them took longer. */
static void gather(const weft__self_list *list, double *to)
{
    for (size_t kind = 0; kind < KINDS; ++kind) {
        const size_t corners = weft__kind_particles((weft__pair_kind)kind);
        for (size_t i = 0; i < list->shelf_count; ++i) {
            add_pushes(list->cloth, &list->shelves[i].bins[kind], corners, to);
        }
    }
}

int weft__self_list_add(weft__self_list *list, const weft__subject *of, double *to)
{
    evaluation all = { .list = list, .of = of };
    const readiness is = prepare(list, of->y);
    if (is != READY) {
        return is == NOT_FINITE ? 1 : weft__self_add(of, WEFT__ACCELERATION, to);
    }
    if (evaluate(&all)) {
        gather(list, to);
    }
    return atomic_load(&all.bad) ? 1 : 0;
}

static void measure_bin(const weft_cloth *cloth, weft__pair_kind kind, const bin *of,
                        const double *y, weft_measures *sum)
{
    for (size_t i = 0; i < of->pushing; ++i) {
        weft__push push;
        weft__push_at(kind, of->pushes, i, &push);
        weft__push_measure(cloth, &push, y, sum);
    }
}

void weft__self_list_measure(weft__self_list *list, const weft__subject *of,
                             weft_measures *sum)
{
    evaluation all = { .list = list, .of = of };
    if (prepare(list, of->y) != READY) {
        weft__self_measure(of, sum);
        return;
    }
    const bool any = evaluate(&all);
    for (size_t kind = 0; kind < KINDS && any; ++kind) {
        for (size_t i = 0; i < list->shelf_count; ++i) {
            measure_bin(list->cloth, (weft__pair_kind)kind,
                        &list->shelves[i].bins[kind], of->y, sum);
        }
    }
}

/* ---- the step check -------------------------------------------------------------- */

typedef struct stride_search {
    const weft__stride *stride;
    weft__pair pair;
    double gap;
    unsigned char *marks; /* NULL: ends at the first pair that is not clear */
    bool found;
} stride_search;

static bool look_at(void *ctx, const weft__pair *pair)
{
    stride_search *of = ctx;
    double gap;
    if (weft__stride_clear(of->stride, pair, &gap)) {
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

/* [m] As far as a pair of two tiles may have been apart that can have met: half of what
 * its primitives move against each other in the step, and from the list to both its
 * ends. */
static double reach_of(const weft__self_list *list, const weft__stride *of,
                       const uint32_t tiles[2])
{
    const double ends = extent_between(list, 0, tiles) + extent_between(list, 1, tiles);
    double way = extent_between(list, 2, tiles);
    if (of->h > 0.0) {
        way = fmax(way, of->h
                            * fmax(extent_between(list, 3, tiles),
                                   extent_between(list, 4, tiles)));
    }
    return 0.5 * (ends + way) * (1.0 + ROUNDOFF);
}

/* Whether the list has all pairs that can have met; then the reach of its groups is
 * set. */
static bool proves(weft__self_list *list, const weft__stride *of)
{
    const size_t n = list->cloth->particles;
    if (!list->valid) {
        return false;
    }
    const double ends
        = drift(list, list->place, of->y0, 0) + drift(list, list->place, of->y1, 1);
    double way = drift(list, of->y0, of->y1, 2);
    if (of->h > 0.0) {
        way = fmax(way, of->h
                            * fmax(drift(list, NULL, of->y0 + 3 * n, 3),
                                   drift(list, NULL, of->y1 + 3 * n, 4)));
    }
    bool has = 0.5 * (ends + way) * (1.0 + ROUNDOFF) < lasting_of(list);
    for (size_t i = 0; i < list->shelf_count && has; ++i) {
        shelf *at = &list->shelves[i];
        for (size_t g = 0; g < at->now.count && has; ++g) {
            group *to = &at->now.at[g];
            to->reach = reach_of(list, of, list->between[to->tiles]);
            has = to->reach < list->clear[to->tiles];
        }
    }
    return has;
}

/* The pairs of a kind within the reach of their group; false ends the search. */
static bool look_along(const shelf *in, weft__pair_kind kind, stride_search *of)
{
    const pairs *at = &in->bins[kind].now;
    bool goes_on = true;
    for (size_t g = 0; g < in->now.count && goes_on; ++g) {
        const group *to = &in->now.at[g];
        const double reach = to->reach + to->loss;
        const size_t end = in->now.spans[g].end[kind];
        size_t i = first_of(&in->now, g, kind);
        for (; i < end && goes_on && !(to->nearest > reach); ++i) {
            if (!(at->distances[i] > reach)) {
                const weft__pair pair = weft__near_pair(kind, &at->near, i);
                goes_on = look_at(of, &pair);
            }
        }
    }
    return goes_on;
}

/* No pair that is further apart at first can have met. */
static void look(weft__self_list *list, stride_search *of)
{
    const weft__stride *stride = of->stride;
    if (proves(list, stride)) {
        bool goes_on = true;
        for (size_t i = 0; i < 2 * list->shelf_count && goes_on; ++i) {
            goes_on = look_along(
                &list->shelves[i % list->shelf_count],
                i < list->shelf_count ? WEFT__VERTEX_TRIANGLE : WEFT__EDGES, of);
        }
        return;
    }
    const double length = weft__stride_length(stride);
    const double moved = weft__extent(list->cloth, stride->y0, stride->y1);
    weft__quadtree tree = weft__tree_of(list->cloth, stride->y0);
    weft__tree_fill(&tree, list->knots);
    (void)weft__each_pair(&tree, 0.5 * (length + moved) * (1.0 + ROUNDOFF), look_at,
                          of);
}

bool weft__self_list_clear(weft__self_list *list, const weft__stride *stride,
                           weft_primitive pair[2], double *gap)
{
    stride_search of = { .stride = stride };
    look(list, &of);
    if (of.found) {
        weft__pair_primitives(&of.pair, pair);
        *gap = of.gap;
    }
    return !of.found;
}

void weft__self_list_hold(weft__self_list *list, const double *y0, double *y1)
{
    const size_t n = list->cloth->particles;
    const weft__stride stride = { list->cloth, y0, y1, 0.0 };
    for (int tries = 0; tries <= HALVINGS; ++tries) {
        stride_search of = { .stride = &stride, .marks = list->marks };
        memset(list->marks, 0, n);
        look(list, &of);
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
