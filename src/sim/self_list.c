/* SPDX-License-Identifier: BSD-3-Clause */
/* self_list.c -- a list about a state, with the distances it was made for, holds all
 * pairs nearer than its range then. Once no two particles are displaced by more than e
 * against each other, a pair at distance D is no nearer than D - e. */
#include "sim/self_list.h"

#include <stdatomic.h>

#include "base/memory.h"
#include "cloth/levels.h"

/* CHUNK pairs are evaluated by one thread. */
enum { CHUNK = WEFT__PAIRS_MOST, MOST_PARTS = 4096, HALVINGS = 60 };

/* Allowed for roundoff, relative. */
#define ROUNDOFF 1e-9

/* Successive pairs of the same two tiles. */
typedef struct group {
    uint32_t tiles[2];
    size_t first;   /* pair */
    double nearest; /* [m] of its pairs */
} group;

struct weft__self_list {
    const weft_cloth *cloth;
    weft__team *team;
    weft_allocator memory;
    weft__knot *knots;     /* of any state */
    double *place;         /* 3 N: where the list was made */
    unsigned char *marks;  /* N */
    weft__drift *tiles[5]; /* of the last displacements; in checks of steps all */
    double skin, range;    /* [m] */
    bool valid;            /* whole, about `place` */
    size_t count, room, wanted;
    size_t group_count;
    group *groups;
    double
        *reach; /* [m] of each group: as far as pairs may have been apart that matter */
    weft__pair *pairs;
    double *distances;  /* [m] */
    weft__push *pushes; /* those of chunk k from k CHUNK on */
    uint32_t *pushing;  /* their number in each chunk */
};

/* A quarter of the spacing is near the best of piles; thick cloth has less, so that
 * flat cells, whose primitives are 0.7 spacings apart, are not listed. */
static double skin_of(const weft_cloth *cloth)
{
    const double a = weft__smaller_spacing(cloth->rows, cloth->cols, cloth->spacing);
    return fmin(0.25 * a, fmax(0.1 * a, 0.65 * a - cloth->contact.thickness));
}

weft__self_list *weft__self_list_create(const weft_cloth *cloth, weft__team *team,
                                        const weft_allocator *memory)
{
    const size_t n = cloth->particles;
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
        .tiles
        = { weft__alloc(memory, weft__tile_count(cloth), 5 * sizeof(weft__drift)) },
        .skin = skin_of(cloth),
        .wanted = CHUNK,
    };
    for (size_t k = 1; k < 5 && list->tiles[0] != NULL; ++k) {
        list->tiles[k] = list->tiles[k - 1] + weft__tile_count(cloth);
    }
    if (list->knots == NULL || list->place == NULL || list->marks == NULL
        || list->tiles[0] == NULL || weft__self_list_grow(list, NULL) != WEFT_OK) {
        weft__self_list_destroy(list);
        return NULL;
    }
    return list;
}

static void free_pairs(weft__self_list *list)
{
    weft__free(&list->memory, list->pairs);
    weft__free(&list->memory, list->distances);
    weft__free(&list->memory, list->pushes);
    weft__free(&list->memory, list->pushing);
    weft__free(&list->memory, list->groups);
    weft__free(&list->memory, list->reach);
    list->groups = NULL, list->reach = NULL;
    list->pairs = NULL, list->distances = NULL;
    list->pushes = NULL, list->pushing = NULL;
    list->room = list->count = 0;
    list->valid = false;
}

void weft__self_list_destroy(weft__self_list *list)
{
    if (list != NULL) {
        const weft_allocator memory = list->memory;
        free_pairs(list);
        weft__free(&memory, list->knots);
        weft__free(&memory, list->place);
        weft__free(&memory, list->marks);
        weft__free(&memory, list->tiles[0]);
        weft__free(&memory, list);
    }
}

void weft__self_list_set_skin(weft__self_list *list, double skin)
{
    list->skin = skin;
    list->valid = false;
}

weft_status weft__self_list_grow(weft__self_list *list, weft_error *err)
{
    if (list->wanted <= list->room) {
        return WEFT_OK;
    }
    const size_t chunks = list->wanted / CHUNK * 2 + 1, room = chunks * CHUNK;
    const weft_allocator *memory = &list->memory;
    free_pairs(list);
    list->pairs = weft__alloc(memory, room, sizeof *list->pairs);
    list->distances = weft__alloc(memory, room, sizeof *list->distances);
    list->pushes = weft__alloc(memory, room, sizeof *list->pushes);
    list->pushing = weft__alloc(memory, chunks, sizeof *list->pushing);
    list->groups = weft__alloc(memory, room, sizeof *list->groups);
    list->reach = weft__alloc(memory, room, sizeof *list->reach);
    if (list->pairs == NULL || list->distances == NULL || list->pushes == NULL
        || list->pushing == NULL || list->groups == NULL || list->reach == NULL) {
        free_pairs(list);
        return weft_error_set(err, WEFT_NO_MEMORY,
                              "no memory for %zu pairs of primitives that are near "
                              "each other",
                              room);
    }
    list->room = room;
    return WEFT_OK;
}

/* ---- making ---------------------------------------------------------------------- */

static uint32_t tile_of(const weft_cloth *cloth, size_t i)
{
    const size_t r = i / cloth->cols, c = i % cloth->cols;
    return (uint32_t)(r / WEFT__TILE * weft__tile_cols(cloth) + c / WEFT__TILE);
}

/* All particles of a primitive are in the tile of one of them or next to it. */
static uint32_t group_of(weft__self_list *list, const weft__pair *pair, double distance)
{
    const uint32_t a = tile_of(list->cloth, pair->particle[0]);
    const uint32_t b
        = tile_of(list->cloth, pair->particle[pair->kind == WEFT__EDGES ? 2 : 1]);
    group *last = list->groups + list->group_count;
    if (list->group_count > 0 && last[-1].tiles[0] == a && last[-1].tiles[1] == b) {
        --last;
        last->nearest = distance < last->nearest ? distance : last->nearest;
    } else {
        *last = (group){ { a, b }, list->count, distance };
        ++list->group_count;
    }
    return (uint32_t)(last - list->groups);
}

static bool keep(void *ctx, const weft__pair *pair, double distance)
{
    weft__self_list *list = ctx;
    if (list->count < list->room) {
        list->pairs[list->count] = *pair;
        list->pairs[list->count].group = group_of(list, pair, distance);
        list->distances[list->count] = distance;
    }
    ++list->count;
    return true;
}

static weft__quadtree tree_about(weft__self_list *list, const double *y)
{
    weft__quadtree tree = weft__tree_of(list->cloth, y);
    weft__tree_fill(&tree, y, list->knots);
    return tree;
}

static void make(weft__self_list *list, const double *y)
{
    const weft__quadtree tree = tree_about(list, y);
    list->range = list->cloth->contact.thickness + list->skin;
    list->count = list->group_count = 0;
    (void)weft__each_pair(&tree, list->range, keep, list);
    list->wanted = list->count;
    list->valid = list->count <= list->room;
    memcpy(list->place, y, 3 * list->cloth->particles * sizeof *y);
}

/* [m] The extent of a displacement, infinite if a number is not finite; an empty list
 * needs no tiles. */
static double drift(weft__self_list *list, const double *from, const double *to,
                    size_t tiles)
{
    return list->group_count == 0
               ? weft__extent(list->cloth, from, to)
               : list->cloth->level->drift(list->cloth, from, to, list->tiles[tiles]);
}

/* Whether the list, made anew if need be, holds all pairs that push in a finite state;
 * then the reach of its groups is set. */
static bool ready(weft__self_list *list, const double *y)
{
    double extent = drift(list, list->valid ? list->place : y, y, 0);
    if ((!list->valid || !(extent < list->skin)) && list->wanted <= list->room) {
        make(list, y);
        extent = drift(list, y, y, 0);
    }
    const weft__drift *tiles = list->tiles[0];
    for (size_t g = 0; list->valid && g < list->group_count; ++g) {
        const uint32_t *of = list->groups[g].tiles;
        const double thickness = list->cloth->contact.thickness;
        list->reach[g] = 0.0;
        if (list->groups[g].nearest <= (thickness + extent) * (1.0 + ROUNDOFF)) {
            list->reach[g]
                = (thickness + weft__drift_extent(&tiles[of[0]], &tiles[of[1]]))
                  * (1.0 + ROUNDOFF);
        }
    }
    return list->valid && extent < list->skin;
}

/* ---- forces ---------------------------------------------------------------------- */

typedef struct evaluation {
    weft__self_list *list;
    weft__self_law law;
    const weft__subject *of;
    size_t chunks, parts;
    double *to;
    atomic_bool bad;
} evaluation;

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

static void evaluate_chunk(evaluation *all, size_t chunk)
{
    weft__self_list *list = all->list;
    if (list->pushing[chunk] == 0) {
        return;
    }
    const size_t first = chunk * CHUNK;
    const size_t end = first + CHUNK < list->count ? first + CHUNK : list->count;
    const weft__push *to = list->pushes + first;
    const size_t count = list->cloth->level->pushes(
        &all->law, list->pairs + first, list->distances + first, end - first,
        list->reach, all->of->y, list->pushes + first);
    double bad = 0.0;
    for (size_t i = 0; i < count; ++i) {
        bad += weft__push_trouble(to + i);
    }
    list->pushing[chunk] = (uint32_t)count;
    if (bad != 0.0) {
        atomic_store(&all->bad, true);
    }
}

static void evaluate_part(void *ctx, size_t part)
{
    evaluation *all = ctx;
    for (size_t chunk = part; chunk < all->chunks; chunk += all->parts) {
        evaluate_chunk(all, chunk);
    }
}

static size_t end_of(const weft__self_list *list, size_t g)
{
    return g + 1 < list->group_count ? list->groups[g + 1].first : list->count;
}

/* Sets `pushing` of chunks with pairs within the reach of their group to 1, else 0. */
static void mark_chunks(weft__self_list *list, size_t chunks)
{
    memset(list->pushing, 0, chunks * sizeof *list->pushing);
    for (size_t g = 0; g < list->group_count; ++g) {
        const size_t last = (end_of(list, g) - 1) / CHUNK;
        for (size_t k = list->groups[g].first / CHUNK;
             list->groups[g].nearest <= list->reach[g] && k <= last; ++k) {
            list->pushing[k] = 1;
        }
    }
}

/* Fills the pushes of a list that is ready. */
static void evaluate(evaluation *all)
{
    weft__self_list *list = all->list;
    all->law = weft__self_law_of(list->cloth);
    all->chunks = (list->count + CHUNK - 1) / CHUNK;
    all->parts = all->chunks < MOST_PARTS ? all->chunks : MOST_PARTS;
    mark_chunks(list, all->chunks);
    run(list->team, evaluate_part, all, all->parts);
}

/* Each thread adds all pushes to particles of its own, in the order of the list. */
static void gather_part(void *ctx, size_t part)
{
    const evaluation *all = ctx;
    const weft__self_list *list = all->list;
    const size_t n = list->cloth->particles;
    const size_t first = part * n / all->parts, end = (part + 1) * n / all->parts;
    for (size_t chunk = 0; chunk < all->chunks; ++chunk) {
        const weft__push *push = list->pushes + chunk * CHUNK;
        for (size_t i = 0; i < list->pushing[chunk]; ++i) {
            weft__push_add(list->cloth, push + i, WEFT__ACCELERATION, first, end,
                           all->to);
        }
    }
}

int weft__self_list_add(weft__self_list *list, const weft__subject *of, double *to)
{
    evaluation all = { .list = list, .of = of, .to = to };
    if (!isfinite(weft__extent(list->cloth, NULL, of->y))) {
        return 1;
    }
    if (!ready(list, of->y)) {
        return weft__self_add(of, WEFT__ACCELERATION, to);
    }
    evaluate(&all);
    all.parts = weft__team_threads(list->team);
    run(list->team, gather_part, &all, all.parts);
    return atomic_load(&all.bad) ? 1 : 0;
}

void weft__self_list_measure(weft__self_list *list, const weft__subject *of,
                             weft_measures *sum)
{
    evaluation all = { .list = list, .of = of };
    if (!isfinite(weft__extent(list->cloth, NULL, of->y)) || !ready(list, of->y)) {
        weft__self_measure(of, sum);
        return;
    }
    evaluate(&all);
    for (size_t chunk = 0; chunk < all.chunks; ++chunk) {
        for (size_t i = 0; i < list->pushing[chunk]; ++i) {
            weft__push_measure(list->cloth, &list->pushes[chunk * CHUNK + i], of->y,
                               sum);
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

static bool look_at(void *ctx, const weft__pair *pair, double distance)
{
    stride_search *of = ctx;
    double gap;
    (void)distance;
    if (weft__stride_clear(of->stride, pair, &gap)) {
        return true;
    }
    of->found = true;
    of->pair = *pair;
    of->gap = gap;
    for (size_t k = 0; of->marks != NULL && k < 4; ++k) {
        of->marks[pair->particle[k]] = 1;
    }
    return of->marks != NULL;
}

/* [m] As far as a pair of two tiles may have been apart that can have met: half of what
 * its primitives move against each other in the step, and from the list to both its
 * ends. */
static double near_of(weft__self_list *list, const weft__stride *of,
                      const uint32_t tiles[2])
{
    double extents[5];
    for (size_t k = 0; k < (of->h > 0.0 ? 5 : 3); ++k) {
        const weft__drift *at = list->tiles[k];
        extents[k] = weft__drift_extent(&at[tiles[0]], &at[tiles[1]]);
    }
    const double length = of->h > 0.0
                              ? fmax(extents[2], of->h * fmax(extents[3], extents[4]))
                              : extents[2];
    return 0.5 * (length + extents[0] + extents[1]) * (1.0 + ROUNDOFF);
}

/* Whether the list holds all pairs that can have met; then the reach of its groups is
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
    for (size_t g = 0; g < list->group_count; ++g) {
        list->reach[g] = near_of(list, of, list->groups[g].tiles);
    }
    return 0.5 * (ends + way) * (1.0 + ROUNDOFF) < list->range;
}

/* No pair that is further apart at first can have met. */
static void look(weft__self_list *list, stride_search *of)
{
    const weft__stride *stride = of->stride;
    if (proves(list, stride)) {
        bool goes_on = true;
        for (size_t g = 0; g < list->group_count && goes_on; ++g) {
            const bool any = list->groups[g].nearest <= list->reach[g];
            for (size_t i = list->groups[g].first;
                 any && i < end_of(list, g) && goes_on; ++i) {
                goes_on = list->distances[i] > list->reach[g]
                          || look_at(of, &list->pairs[i], list->distances[i]);
            }
        }
        return;
    }
    const double length = weft__stride_length(stride);
    const double moved = weft__extent(list->cloth, stride->y0, stride->y1);
    const weft__quadtree tree = tree_about(list, stride->y0);
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
