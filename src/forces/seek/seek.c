/* SPDX-License-Identifier: BSD-3-Clause */
/* seek.c -- the room of a search, and its forms. */
#include "forces/seek/seek.h"

#include <math.h>

/* Rows end with so many empty patches at least, and planes with so many rows: windows
 * of three patches and whole vectors may be read from any of them. */
enum { COLUMNS = 16, ROWS = 3, BOX = 6, SLOPE = 12, BENT = 3 };

size_t weft__tile_level(weft__nodes of)
{
    size_t level = WEFT__TILE_LEVEL;
    while (weft__patch_count(&of, level) > WEFT__TILES_MOST) {
        ++level;
    }
    return level;
}

/* Of the primitives that nodes have in a slice at most. */
static size_t eights_of(const weft__primitives *of)
{
    size_t most = 0;
    for (size_t i = 0; of->edge_first != NULL && i < of->points; ++i) {
        const size_t edges = of->edge_first[i + 1] - of->edge_first[i];
        const size_t triangles = of->triangle_first[i + 1] - of->triangle_first[i];
        const size_t all = (edges < WEFT__OWNED ? edges : WEFT__OWNED)
                           + (triangles < WEFT__OWNED ? triangles : WEFT__OWNED);
        most = all > most ? all : most;
    }
    return most / 8 + 1;
}

/* Half of the planes low, then high bounds of nothing. */
static void empty(float *planes, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        planes[i] = i < count / 2 ? INFINITY : -INFINITY;
    }
}

static size_t level_size(const weft__primitives *of, const weft__seek_level *at)
{
    return (of->nodes.fold == 1 ? BOX + SLOPE + BENT : BOX) * at->plane;
}

/* Takes the room of a level from *room. */
static void set_level(const weft__primitives *of, weft__seek_level *at, float **room)
{
    float *next = *room;
    at->box = next;
    empty(at->box, BOX * at->plane);
    if (of->nodes.fold == 1) {
        at->slope = next + BOX * at->plane;
        empty(at->slope, SLOPE / 2 * at->plane);
        empty(at->slope + SLOPE / 2 * at->plane, SLOPE / 2 * at->plane);
        for (size_t k = 0; k < BENT; ++k) {
            at->bent[k] = next + (BOX + SLOPE + k) * at->plane;
        }
    }
    *room = next + level_size(of, at);
}

/* A grid of two rows or columns is not looked at for what is flat. */
static void set_rest(const weft__primitives *of, size_t k, weft__seek_level *at)
{
    const double a = of->spacing[0], b = of->spacing[1];
    const bool wide = of->nodes.fold == 1 && of->nodes.rows > 2 && of->nodes.cols > 2;
    at->inverse[0] = wide ? (float)(sqrt(1.0 + a * a / (b * b)) / a) : INFINITY;
    at->inverse[1] = wide ? (float)ldexp(1.0 / (a < b ? a : b), -(int)k) : INFINITY;
}

bool weft__boxes_create(const weft__primitives *of, const weft_allocator *memory,
                        weft__boxes *out)
{
    size_t size = 0;
    *out = (weft__boxes){ .of = *of,
                          .top = weft__tile_level(of->nodes),
                          .eights = eights_of(of) };
    for (size_t k = 0; k <= out->top; ++k) {
        weft__seek_level *at = &out->level[k];
        at->rows = weft__patches(of->nodes.rows, k);
        at->cols = weft__patches_across(&of->nodes, k);
        at->stride = (at->cols / COLUMNS + 2) * COLUMNS;
        at->plane = (at->rows + ROWS) * at->stride;
        set_rest(of, k, at);
        size += level_size(of, at);
    }
    float *room = out->room = weft__alloc(memory, size, sizeof *room);
    for (size_t k = 0; k <= out->top && room != NULL; ++k) {
        set_level(of, &out->level[k], &room);
    }
    return out->room != NULL;
}

void weft__boxes_free(const weft_allocator *memory, weft__boxes *of)
{
    weft__free(memory, of->room);
}

#define FORMS(level) { weft__fill_##level, weft__bend_##level, weft__seek_##level },
static const weft__seeker seekers[] = { { NULL, NULL, NULL }, WEFT_LEVELS(FORMS) };

const weft__seeker *weft__seeker_of(weft__isa isa)
{
    const size_t count = sizeof seekers / sizeof seekers[0]; /* 1 without fast forms */
    return isa == WEFT__LOOPS || (size_t)isa >= count ? NULL : &seekers[isa];
}
