/* SPDX-License-Identifier: BSD-3-Clause */
/* self_search.c -- the search between the tiles of a weft__self_list in a state: by
 * boxes in single precision (forces/seek), or, in a build or on a level of instructions
 * without them, by the tree. Both visit the pairs in the same order. */
#include "forces/contact/self/self_list.h"

static bool by_boxes(const weft__self_list *list)
{
    return list->own->seeker != NULL && list->boxes.room != NULL;
}

bool weft__self_search_create(weft__self_list *list)
{
    const weft__self *own = list->own;
    const weft__contact_surface *surface = own->surface;
    weft__primitives of = { .nodes = weft__nodes_of(own),
                            .points = own->points,
                            .spacing = { own->mesh->spacing[0], own->mesh->spacing[1] },
                            .particles = own->mesh->particles,
                            .between = own->between };
    if (surface != NULL) {
        of.edge = surface->edge, of.edge_first = surface->edge_first;
        of.triangle = surface->triangle, of.triangle_first = surface->triangle_first;
        of.order = surface->order;
    }
    return own->seeker == NULL || weft__boxes_create(&of, &list->memory, &list->boxes);
}

void weft__self_search_place(weft__self_list *list, const double *y)
{
    list->y = y;
    memset(list->marks, 0, weft__tile_count(list->own));
}

/* The search looks for flat patches in the rectangle about two tiles, by the tree, or
 * in the rows of both and the two that follow. */
void weft__self_search_mark(weft__self_list *list, const uint32_t tiles[2])
{
    const weft__nodes nodes = weft__nodes_of(list->own);
    const size_t level = weft__tile_level(nodes);
    const size_t rows = weft__patches(nodes.rows, level);
    const size_t cols = weft__patches_across(&nodes, level);
    const size_t r[2] = { tiles[0] / cols, tiles[1] / cols };
    const size_t c[2] = { tiles[0] % cols, tiles[1] % cols };
    const size_t top = r[0] < r[1] ? r[0] : r[1], left = c[0] < c[1] ? c[0] : c[1];
    const size_t high = r[0] + r[1] - 2 * top + 1, wide = c[0] + c[1] - 2 * left + 1;
    for (size_t i = 0; nodes.fold == 1 && by_boxes(list) && i < 6; ++i) {
        const size_t row = r[i / 3] + i % 3;
        list->marks[row < rows ? row : rows - 1] = 1;
    }
    if (nodes.fold == 1 && by_boxes(list)) {
        return;
    }
    list->marks[tiles[0]] = list->marks[tiles[1]] = 1;
    for (size_t i = 0; nodes.fold == 1 && high <= 3 && wide <= 3 && i < high * wide;
         ++i) {
        list->marks[(top + i / wide) * cols + left + i % wide] = 1;
    }
}

static void fill_part(void *ctx, size_t part)
{
    weft__self_list *list = ctx;
    if (list->marks[part] != 0 && by_boxes(list)) {
        list->own->seeker->fill(&list->boxes, list->y, part);
    } else if (list->marks[part] != 0) {
        weft__tree_fill_tile(&list->tree, part);
    }
}

static void bend_part(void *ctx, size_t part)
{
    weft__self_list *list = ctx;
    if (list->marks[part] != 0) {
        list->own->seeker->bend(&list->boxes, part);
    }
}

void weft__self_search_begin(weft__self_list *list)
{
    const weft__self *own = list->own;
    const bool boxes = by_boxes(list);
    const size_t parts
        = boxes ? weft__boxes_parts(&list->boxes) : weft__tile_count(own);
    if (!boxes) {
        list->tree = weft__tree_of(own, list->y);
        weft__tree_begin(&list->tree, list->knots);
    }
    weft__pool_run(list->pool, fill_part, list, parts);
    if (boxes && own->surface == NULL) {
        weft__pool_run(list->pool, bend_part, list, parts);
    }
}

/* Of a surface with slit edges or grids. */
typedef struct admission {
    const weft__self *own;
    weft__pair_fn *visit;
    void *ctx;
} admission;

static bool admit(void *ctx, const weft__pair *found)
{
    const admission *to = ctx;
    weft__pair pair = *found;
    return !weft__pair_admit(to->own, &pair) || to->visit(to->ctx, &pair);
}

bool weft__self_search(const weft__self_list *list, const uint32_t tiles[2],
                       double range, weft__pair_fn *visit, void *ctx)
{
    const weft__self *own = list->own;
    admission to = { own, visit, ctx };
    if (!by_boxes(list)) {
        return weft__each_pair_between(&list->tree, tiles, range, visit, ctx);
    }
    if (own->surface != NULL
        && (own->surface->grids || own->surface->slit_pair_count > 0)) {
        visit = admit, ctx = &to;
    }
    return own->seeker->seek(&list->boxes, list->y, tiles, range, visit, ctx);
}
