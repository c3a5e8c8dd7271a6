/* SPDX-License-Identifier: BSD-3-Clause */
/* self_list.c -- a list about a state has pairs of primitives with their distances
 * there. Once no two particles of two tiles are displaced by more than e against each
 * other, a pair of theirs at distance D is no nearer than D - e.
 *
 * For each pair of tiles it is known how far apart their pairs are at least but for
 * those in the list: `clear`. When a list is made about a new state, `clear` loses what
 * the tiles have moved against each other; only where it no longer suffices are pairs
 * sought again. Pairs at `clear` or further apart are dropped. */
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

/* Of the skin: how far particles may move against each other before a list is made
 * anew, and what is left of it at least where pairs are not sought again. */
#define LASTING 0.2
#define KEPT    0.1
#define LEAST   0.25

/* Of `clear`: pairs have to be sought. */
#define UNKNOWN (-1.0)

/* Two tiles that are near each other. */
typedef struct group {
    size_t tiles;   /* in `between` */
    double limit;   /* [m] pairs that are not in `near` do not push before */
    double nearest; /* [m] of its pairs that the step check looks at */
    double loss;    /* [m] moved between where its pairs were measured and `place` */
    double reach;   /* [m] as far as they matter in a step */
    size_t end[KINDS], near_end[KINDS]; /* its pairs follow those of the group before */
} group;

/* Pairs of a kind. */
typedef struct pairs {
    size_t count;
    weft__quad *at;
    double *distances; /* [m] */
    weft__near near;   /* those that may push soon */
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
    group *groups, *before;
    size_t group_count, before_count;
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
    double skin;  /* [m] beyond the thickness */
    double limit; /* [m] the least of all groups */
    size_t pin_changes;
    size_t group_count;
    bool valid; /* whole, about `place` */
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

/* ---- room ------------------------------------------------------------------------ */

static void free_pairs(const weft_allocator *memory, pairs *of)
{
    weft__free(memory, of->at);
    weft__free(memory, of->distances);
    weft__free(memory, of->near.particle[0]);
    weft__free(memory, of->near.mass);
    weft__free(memory, of->near.rest);
    *of = (pairs){ .count = 0 };
}

static bool make_pairs(const weft_allocator *memory, size_t room, pairs *of)
{
    const size_t all = room + WEFT__BLOCK;
    free_pairs(memory, of);
    of->at = weft__alloc(memory, room, sizeof *of->at);
    of->distances = weft__alloc(memory, room, sizeof *of->distances);
    of->near.particle[0] = weft__alloc(memory, 4 * all, sizeof(int32_t));
    of->near.mass = weft__alloc(memory, all, sizeof(double));
    of->near.rest = weft__alloc(memory, all, sizeof(double));
    for (size_t k = 1; k < 4 && of->near.particle[0] != NULL; ++k) {
        of->near.particle[k] = of->near.particle[k - 1] + all;
    }
    return of->at != NULL && of->distances != NULL && of->near.particle[0] != NULL
           && of->near.mass != NULL && of->near.rest != NULL;
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
    const size_t each = weft__tile_count(list->cloth) / 8 + 1;
    const size_t count = each < SHELVES ? each : SHELVES;
    list->shelves = weft__zeroed(&list->memory, count, sizeof *list->shelves);
    for (size_t i = 0; i < count && list->shelves != NULL; ++i) {
        shelf *of = &list->shelves[i];
        *of = (shelf){ .first = i * list->between_count / count,
                       .end = (i + 1) * list->between_count / count,
                       .wanted = ROOM };
        const size_t most = of->end - of->first + 1;
        of->groups = weft__alloc(&list->memory, most, sizeof *of->groups);
        of->before = weft__alloc(&list->memory, most, sizeof *of->before);
        list->shelf_count = i + 1;
        if (of->groups == NULL || of->before == NULL) {
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
        weft__free(&memory, list->shelves[i].groups);
        weft__free(&memory, list->shelves[i].before);
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

/* ---- making ---------------------------------------------------------------------- */

typedef struct making {
    weft__self_list *list;
    const double *y;
} making;

static double extent_between(const weft__self_list *list, size_t k, const uint32_t *of)
{
    return weft__drift_extent(&list->tiles[k][of[0]], &list->tiles[k][of[1]]);
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
        double left = UNKNOWN;
        if (list->valid) {
            left = list->clear[i] - extent_between(list, 0, tiles) * (1.0 + ROUNDOFF);
        }
        if (!(left >= least)) {
            left = box_distance(&list->tiles[1][tiles[0]], &list->tiles[1][tiles[1]])
                   * (1.0 - ROUNDOFF);
            left = left >= range_of(list) ? left : UNKNOWN;
        }
        list->clear[i] = left;
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
        memcpy(of->at[of->count].of, pair->particle, sizeof pair->particle);
    }
    ++of->count;
    return true;
}

/* Adds pairs [first, end) of another list, and those of them in its `near`. */
static void copy_pairs(const pairs *from, const size_t first[2], const size_t end[2],
                       pairs *to)
{
    const size_t count = end[0] - first[0], near = end[1] - first[1];
    memcpy(to->at + to->count, from->at + first[0], count * sizeof *to->at);
    memcpy(to->distances + to->count, from->distances + first[0],
           count * sizeof *to->distances);
    for (size_t k = 0; k < 4; ++k) {
        memcpy(to->near.particle[k] + to->near.count, from->near.particle[k] + first[1],
               near * sizeof(int32_t));
    }
    memcpy(to->near.mass + to->near.count, from->near.mass + first[1],
           near * sizeof *to->near.mass);
    memcpy(to->near.rest + to->near.count, from->near.rest + first[1],
           near * sizeof *to->near.rest);
    to->count += count, to->near.count += near;
}

/* old[-1], if it is not the first, is the group before. */
static void copy_group(shelf *of, const group *old, bool measured)
{
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *in = &of->bins[kind];
        const bool is_first = old == of->before;
        const size_t first[2] = { is_first ? 0 : old[-1].end[kind],
                                  is_first ? 0 : old[-1].near_end[kind] };
        const size_t end[2]
            = { old->end[kind], measured ? old->near_end[kind] : first[1] };
        if (in->now.count + end[0] - first[0] <= of->room) {
            copy_pairs(&in->before, first, end, &in->now);
        } else {
            of->full = true;
        }
    }
}

static void add_near(const weft__self_law *law, weft__pair_kind kind,
                     const weft__quad *quad, weft__near *to)
{
    weft__pair pair = { .kind = kind };
    memcpy(pair.particle, quad->of, sizeof pair.particle);
    const double mass = weft__pair_mass(law->cloth, &pair);
    if (mass > 0.0) {
        for (size_t k = 0; k < 4; ++k) {
            to->particle[k][to->count] = (int32_t)pair.particle[k];
        }
        to->mass[to->count] = mass;
        to->rest[to->count] = weft__pair_rest(law, &pair);
        ++to->count;
    }
}

/* Measures the pairs of a bin from `first` on, and drops those at `clear`. */
static void measure_pairs(const making *of, weft__pair_kind kind, pairs *in,
                          size_t first, double clear, group *to)
{
    const weft__self_list *list = of->list;
    const weft__self_law law = weft__self_law_of(list->cloth);
    const size_t all = in->count;
    double distances[STRETCH], waits[STRETCH];
    in->count = first;
    for (size_t i = first; i < all; i += STRETCH) {
        const size_t count = i + STRETCH < all ? STRETCH : all - i;
        list->cloth->level->waits(list->cloth, kind, in->at + i, count, of->y,
                                  list->skin, distances, waits);
        for (size_t j = 0; j < count; ++j) {
            if (distances[j] >= clear) {
                continue;
            }
            in->at[in->count] = in->at[i + j];
            in->distances[in->count++] = distances[j];
            if (kind >= WEFT__VERTEX_TRIANGLE && !(distances[j] > to->nearest)) {
                to->nearest = distances[j];
            }
            if (!(waits[j] > LASTING * list->skin)) {
                add_near(&law, kind, &in->at[in->count - 1], &in->near);
            } else if (waits[j] < to->limit) {
                to->limit = waits[j];
            }
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
    group *const groups = of->before;
    of->before = of->groups, of->before_count = of->group_count;
    of->groups = groups, of->group_count = 0;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *in = &of->bins[kind];
        const pairs old = in->now;
        in->now = in->before, in->before = old;
        in->now.count = in->now.near.count = 0;
    }
}

/* Of two tiles whose pairs are the last ones, after those of the group before; from:
 * another group that has measured them, or NULL. */
static void add_group(const making *of, shelf *in, size_t tiles, const group *from)
{
    const weft__self_list *list = of->list;
    const double clear = list->clear[tiles];
    group *to = &in->groups[in->group_count];
    const group *before = in->group_count > 0 ? to - 1 : NULL;
    bool any = clear < range_of(list);
    *to = (group){ .limit = clear - list->cloth->contact.thickness,
                   .nearest = INFINITY };
    if (from != NULL) {
        *to = *from;
    }
    to->tiles = tiles;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        pairs *at = &in->bins[kind].now;
        const size_t first = before != NULL ? before->end[kind] : 0;
        if (from == NULL) {
            measure_pairs(of, (weft__pair_kind)kind, at, first, clear, to);
        }
        any = any || at->count > first;
        to->end[kind] = at->count, to->near_end[kind] = at->near.count;
    }
    in->group_count += any;
}

/* The last pair fills the lanes. */
static void pad(weft__near *of)
{
    for (size_t i = of->count; of->count > 0 && i < of->count + WEFT__BLOCK; ++i) {
        for (size_t k = 0; k < 4; ++k) {
            of->particle[k][i] = of->particle[k][of->count - 1];
        }
    }
}

/* Lists the pairs of two tiles, which are in group `old` or, if it is NULL, in none. */
static void list_pairs(const making *of, shelf *in, size_t tiles, const group *old)
{
    weft__self_list *list = of->list;
    double *clear = &list->clear[tiles];
    group kept = { .limit = 0.0 };
    bool measured = false;
    if (*clear == UNKNOWN) {
        *clear = range_of(list);
        (void)weft__each_pair_between(&list->tree, list->between[tiles], *clear, keep,
                                      in);
    } else if (old != NULL) {
        kept = *old;
        kept.loss += extent_between(list, 0, list->between[tiles]) * (1.0 + ROUNDOFF);
        measured = kept.limit - kept.loss >= KEPT * list->skin;
        copy_group(in, old, measured);
    }
    if (!is_full(in)) {
        add_group(of, in, tiles, measured ? &kept : NULL);
    }
}

static void make_part(void *ctx, size_t part)
{
    const making *of = ctx;
    const weft__self_list *list = of->list;
    shelf *in = &list->shelves[part];
    begin_shelf(in);
    const group *old = in->before, *end = old + (list->valid ? in->before_count : 0);
    for (size_t i = in->first; i < in->end && !in->full; ++i) {
        const bool listed = old < end && old->tiles == i;
        if (list->clear[i] < range_of(list)) {
            list_pairs(of, in, i, listed ? old : NULL);
        }
        old += listed;
    }
    for (size_t kind = 0; kind < KINDS && !in->full; ++kind) {
        pad(&in->bins[kind].now.near);
    }
}

/* [m] From `place` on. */
static double limit_of(const group *of)
{
    return (of->limit - of->loss) * (1.0 - ROUNDOFF);
}

/* Of a list that is valid tiles[0] has the displacements since. */
static void make(weft__self_list *list, const double *y)
{
    making of = { list, y };
    const weft_cloth *cloth = list->cloth;
    bool seek = false;
    list->valid
        = list->valid && list->group_count > 0; /* else the most room is found */
    (void)cloth->level->drift(cloth, NULL, y, list->tiles[1]);
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
    list->limit = list->skin;
    list->group_count = 0;
    list->valid = true;
    for (size_t i = 0; i < list->shelf_count; ++i) {
        const shelf *at = &list->shelves[i];
        list->valid = list->valid && !at->full;
        list->group_count += at->group_count;
        for (size_t g = 0; g < at->group_count; ++g) {
            list->limit = fmin(list->limit, limit_of(&at->groups[g]));
        }
    }
}

/* [m] The extent of a displacement, infinite if a number is not finite; without groups
 * no tiles are needed. */
static double drift(weft__self_list *list, const double *from, const double *to,
                    size_t tiles)
{
    return list->group_count == 0
               ? weft__extent(list->cloth, from, to)
               : list->cloth->level->drift(list->cloth, from, to, list->tiles[tiles]);
}

/* Whether `near` has all pairs that push after displacements tiles[0] of that extent.
 */
static bool suffices(const weft__self_list *list, double extent)
{
    bool all = extent < list->skin;
    for (size_t i = 0; i < list->shelf_count && all && extent >= list->limit; ++i) {
        const shelf *at = &list->shelves[i];
        for (size_t g = 0; g < at->group_count && all; ++g) {
            all = extent_between(list, 0, list->between[at->groups[g].tiles])
                  < limit_of(&at->groups[g]);
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
    size_t parts;
    double *to;
    atomic_bool bad;
} evaluation;

static void evaluate_part(void *ctx, size_t part)
{
    evaluation *all = ctx;
    shelf *in = &all->list->shelves[part];
    double bad = 0.0;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        bin *at = &in->bins[kind];
        at->pushing = all->law.cloth->level->pushes(&all->law, (weft__pair_kind)kind,
                                                    &at->now.near, all->of->y,
                                                    at->pushes, &bad);
    }
    if (bad != 0.0) {
        atomic_store(&all->bad, true);
    }
}

/* Fills the pushes of a list that is ready. */
static void evaluate(evaluation *all)
{
    all->law = weft__self_law_of(all->list->cloth);
    run(all->list->team, evaluate_part, all, all->list->shelf_count);
}

/* Adds the pushes of a bin to the particles [first, end). */
static void add_pushes(const weft_cloth *cloth, const bin *of, size_t corners,
                       size_t first, size_t end, double *to)
{
    for (size_t i = 0; i < of->pushing; ++i) {
        const weft__pushes *from = &of->pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK, pair = from->at[lane];
        for (size_t k = 0; k < corners; ++k) {
            const size_t at = (size_t)of->now.near.particle[k][pair];
            const double scale = cloth->inverse_mass[at];
            if (at >= first && at < end && scale > 0.0) {
                for (size_t j = 0; j < 3; ++j) {
                    to[j * cloth->particles + at] += scale * from->force[k][j][lane];
                }
            }
        }
    }
}

/* Each thread adds all pushes to particles of its own, in the order of weft__each_pair.
 */
static void gather_part(void *ctx, size_t part)
{
    const evaluation *all = ctx;
    const weft__self_list *list = all->list;
    const size_t n = list->cloth->particles;
    const size_t first = part * n / all->parts, end = (part + 1) * n / all->parts;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        const size_t corners = weft__kind_particles((weft__pair_kind)kind);
        for (size_t i = 0; i < list->shelf_count; ++i) {
            add_pushes(list->cloth, &list->shelves[i].bins[kind], corners, first, end,
                       all->to);
        }
    }
}

int weft__self_list_add(weft__self_list *list, const weft__subject *of, double *to)
{
    evaluation all = { .list = list, .of = of, .to = to };
    const readiness is = prepare(list, of->y);
    if (is != READY) {
        return is == NOT_FINITE ? 1 : weft__self_add(of, WEFT__ACCELERATION, to);
    }
    evaluate(&all);
    all.parts = weft__team_threads(list->team);
    run(list->team, gather_part, &all, all.parts);
    return atomic_load(&all.bad) ? 1 : 0;
}

static void measure_bin(const weft_cloth *cloth, weft__pair_kind kind, const bin *of,
                        const double *y, weft_measures *sum)
{
    for (size_t i = 0; i < of->pushing; ++i) {
        weft__push push;
        weft__push_at(kind, &of->now.near, of->pushes, i, &push);
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
    evaluate(&all);
    for (size_t kind = 0; kind < KINDS; ++kind) {
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
    bool has = 0.5 * (ends + way) * (1.0 + ROUNDOFF) < range_of(list);
    for (size_t i = 0; i < list->shelf_count && has; ++i) {
        shelf *at = &list->shelves[i];
        for (size_t g = 0; g < at->group_count && has; ++g) {
            group *to = &at->groups[g];
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
    weft__pair pair = { .kind = kind };
    bool goes_on = true;
    for (size_t g = 0; g < in->group_count && goes_on; ++g) {
        const group *to = &in->groups[g];
        const double reach = to->reach + to->loss;
        size_t i = g > 0 ? to[-1].end[kind] : 0;
        for (; i < to->end[kind] && goes_on && !(to->nearest > reach); ++i) {
            if (!(at->distances[i] > reach)) {
                memcpy(pair.particle, at->at[i].of, sizeof pair.particle);
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
