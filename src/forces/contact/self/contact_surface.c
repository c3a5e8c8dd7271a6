/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_surface.c -- the tables of contact_surface.h, in linear time. */
#include "forces/contact/self/self_tree.h"

#include <stdlib.h>

#include "base/plane.h"
#include "mesh/grid_def.h"

/* x0 of a window is at most this. */
#define WIDEST 0.3

/* ---- drafts ---------------------------------------------------------------------- */

bool weft__surface_draft_create(weft__surface_draft *out, size_t points,
                                size_t triangles, const weft_allocator *memory)
{
    *out = (weft__surface_draft){
        .points = points,
        .particles = points,
        .triangles = triangles,
        .corner = weft__alloc(memory, triangles, sizeof *out->corner),
        .side = weft__alloc(memory, triangles, sizeof *out->side),
        .density = weft__alloc(memory, points, sizeof *out->density),
    };
    return out->corner != NULL && out->side != NULL && out->density != NULL;
}

void weft__surface_draft_destroy(weft__surface_draft *of, const weft_allocator *memory)
{
    WEFT__FREE_ALL(memory, of->corner, of->side, of->density);
}

void weft__surface_draft_mesh(weft__surface_draft *to, const weft__triangles *of)
{
    for (size_t i = 0; i < to->points; ++i) {
        to->density[i] = INFINITY;
    }
    for (size_t j = 0; j < 3 * of->count; ++j) {
        const size_t t = j / 3, k = j % 3;
        const double *a = weft__rest_at(of, t, (k + 1) % 3),
                     *b = weft__rest_at(of, t, (k + 2) % 3);
        double *density = &to->density[of->corner[t][k]];
        to->corner[t][k] = of->corner[t][k];
        to->side[t][k] = weft__squared(a, b);
        *density = fmin(*density, of->fabrics[of->fabric[t]].density);
    }
}

/* A grid behind `first` points and `count` triangles; returns how many there are then.
 * mass [kg] of a particle, or density [kg/m^2] */
static size_t draft_grid(weft__surface_draft *to, const weft__mesh *mesh, double mass,
                         double density, size_t first, size_t count)
{
    const size_t begin = 3 * count;
    for (size_t i = 0; i < mesh->particles; ++i) {
        count += weft__triangles_of(mesh, i, to->corner + count);
        to->density[first + i]
            = density > 0.0 ? density : mass / weft__grid_area(mesh, i);
    }
    for (size_t j = begin; j < 3 * count; ++j) {
        const uint32_t a = to->corner[j / 3][(j + 1) % 3],
                       b = to->corner[j / 3][(j + 2) % 3];
        double x[2][3], d[3];
        weft__grid_rest(mesh, a, x[0]);
        weft__grid_rest(mesh, b, x[1]);
        for (size_t k = 0; k < 3; ++k) {
            d[k] = x[1][k] - x[0][k];
        }
        to->side[j / 3][j % 3] = weft__dot(d, d);
    }
    for (size_t j = begin; j < 3 * count; ++j) {
        to->corner[j / 3][j % 3] += (uint32_t)first;
    }
    return count;
}

void weft__surface_draft_grid(weft__surface_draft *to, const weft__mesh *mesh,
                              const weft_cloth_def *def)
{
    const size_t count = draft_grid(to, mesh, def->mass, def->density, 0, 0);
    to->chain = count == 0 ? weft__shortest_edge(mesh) : 0.0;
    to->rows = mesh->rows, to->cols = mesh->cols;
}

void weft__surface_draft_parts(weft__surface_draft *to, const weft__triangles *of)
{
    size_t count = of->count;
    weft__surface_draft_mesh(to, of);
    for (size_t k = 0; k < of->part_count; ++k) {
        const weft__part *part = &of->parts[k];
        if (part->grid.rows > 0) {
            count = draft_grid(to, &part->grid, part->mass, part->density, part->first,
                               count);
        }
    }
}

/* ---- tables ---------------------------------------------------------------------- */

/* A side of a triangle, or an edge of a chain. */
typedef struct side {
    uint32_t low, high;
    double square, area; /* [m^2] of its length; of the triangle */
} side;

static int by_ends(const void *a, const void *b)
{
    const side *x = a, *y = b;
    return x->low != y->low         ? (x->low > y->low) - (x->low < y->low)
           : x->high != y->high     ? (x->high > y->high) - (x->high < y->high)
           : x->square != y->square ? (x->square > y->square) - (x->square < y->square)
                                    : (x->area > y->area) - (x->area < y->area);
}

static side side_of(uint32_t a, uint32_t b, double square, double area)
{
    return a < b ? (side){ a, b, square, area } : (side){ b, a, square, area };
}

/* first[i + 1] has how many items are of point i: makes it where they begin. */
static void sum_up(uint32_t *first, size_t points)
{
    for (size_t i = 0; i < points; ++i) {
        first[i + 1] += first[i];
    }
}

/* [m^2] of the triangle, by the squares of its sides. */
static double surface_area_of(const double q[3])
{
    const double a = q[0] + q[1] - q[2];
    return 0.25 * sqrt(4.0 * q[0] * q[1] - a * a);
}

static double window_of(double thickness, double length)
{
    return 1.0 / fmin(thickness / length, WIDEST);
}

/* By their lowest points, which come first. */
static void add_triangles(const weft__surface_draft *of, uint32_t *at,
                          weft__contact_surface *to)
{
    memset(to->triangle_first, 0, (of->points + 1) * sizeof *to->triangle_first);
    for (size_t pass = 0; pass < 2; ++pass) {
        for (size_t t = 0; t < of->triangles; ++t) {
            const uint32_t *c = of->corner[t];
            const size_t k = c[0] < c[1] && c[0] < c[2] ? 0 : c[1] < c[2] ? 1 : 2;
            if (pass == 0) {
                ++to->triangle_first[c[k] + 1];
                continue;
            }
            const size_t i = at[c[k]]++;
            const double area = surface_area_of(of->side[t]);
            to->triangle_area[i] = 2.0 * area;
            for (size_t j = 0; j < 3; ++j) {
                const size_t from = (k + j) % 3;
                to->triangle[i][j] = c[from];
                to->area[c[from]] += area / 3.0;
                to->triangle_window[j * of->triangles + i]
                    = window_of(of->thickness, 2.0 * area / sqrt(of->side[t][from]));
            }
        }
        if (pass == 0) {
            sum_up(to->triangle_first, of->points);
            memcpy(at, to->triangle_first, of->points * sizeof *at);
        }
    }
}

static size_t list_sides(const weft__surface_draft *of, side *to)
{
    size_t count = 0;
    for (size_t j = 0; j < 3 * of->triangles; ++j) {
        const uint32_t *c = of->corner[j / 3];
        const double *square = of->side[j / 3];
        to[count++] = side_of(c[(j + 1) % 3], c[(j + 2) % 3], square[j % 3],
                              surface_area_of(square));
    }
    for (uint32_t i = 0; of->chain > 0.0 && i + 1 < of->particles; ++i) {
        to[count++] = side_of(i, i + 1, of->chain * of->chain, of->chain);
    }
    return count;
}

/* Of two sides that are sewn together the shorter one counts. */
static void surface_add_edges(const weft__surface_draft *of, side *sides, size_t count,
                              weft__contact_surface *to)
{
    memset(to->edge_first, 0, (of->points + 1) * sizeof *to->edge_first);
    qsort(sides, count, sizeof *sides, by_ends);
    for (size_t j = 0; j < count; ++j) {
        const side *at = &sides[j];
        if (j > 0 && at->low == at[-1].low && at->high == at[-1].high) {
            to->edge_area[to->edges - 1] += at->area;
            continue;
        }
        const size_t e = to->edges++;
        ++to->edge_first[at->low + 1];
        to->edge[e][0] = at->low, to->edge[e][1] = at->high;
        to->edge_area[e] = at->area;
        to->square[e] = at->square;
        to->edge_window[e] = window_of(of->thickness, sqrt(at->square));
        if (of->chain > 0.0 && at->high < of->particles) {
            to->area[at->low] += 0.5 * at->area;
            to->area[at->high] += 0.5 * at->area;
        }
    }
    sum_up(to->edge_first, of->points);
}

/* Of points in a tile. */
static size_t tile_width(size_t points)
{
    return (size_t)1 << 2 * weft__tile_level((weft__nodes){ 1, points, 2 });
}

/* The particles of a grid in square patches: G. M. Morton's order. Returns how many it
 * has added, of the patch of side 2^level from (r, c) on. */
static size_t order_grid(const weft__surface_draft *of, size_t level, size_t r,
                         size_t c, uint32_t *to)
{
    size_t count = 0;
    if (r >= of->rows || c >= of->cols) {
        return 0;
    }
    if (level == 0) {
        *to = (uint32_t)(r * of->cols + c);
        return 1;
    }
    for (size_t j = 0; j < 4; ++j) {
        const size_t half = (size_t)1 << (level - 1);
        count += order_grid(of, level - 1, r + j / 2 * half, c + j % 2 * half,
                            to + count);
    }
    return count;
}

/* Rows of a grid would make tiles that are long and narrow. */
static void add_order(const weft__surface_draft *of, uint32_t *to)
{
    size_t level = 0;
    while ((size_t)1 << level < of->rows || (size_t)1 << level < of->cols) {
        ++level;
    }
    for (size_t i = order_grid(of, level, 0, 0, to); i < of->points; ++i) {
        to[i] = (uint32_t)i;
    }
}

/* seen: zeros, of all points */
static void add_tiles(const weft__surface_draft *of, uint32_t *seen,
                      weft__contact_surface *to)
{
    const size_t wide = tile_width(of->points);
    size_t count = 0;
    for (size_t first = 0, tile = 0; first < of->points; first += wide) {
        const size_t end = first + wide < of->points ? first + wide : of->points;
        to->tile_first[tile++] = count;
        for (size_t node = first; node < end; ++node) {
            const size_t i = weft__contact_surface_point(to, node);
            seen[i] = (uint32_t)tile;
            if (to->order != NULL && first < of->particles) {
                to->tile_point[count++] = (int32_t)i;
            }
        }
        for (size_t node = first; node < end; ++node) {
            const size_t i = weft__contact_surface_point(to, node);
            for (size_t e = to->edge_first[i]; e < to->edge_first[i + 1]; ++e) {
                const uint32_t high = to->edge[e][1];
                if (seen[high] != tile) {
                    seen[high] = (uint32_t)tile;
                    to->tile_point[count++] = (int32_t)high;
                }
            }
        }
        while (count % WEFT__SURFACE_RUN != 0) {
            to->tile_point[count++] = (int32_t)weft__contact_surface_point(to, first);
        }
        to->tile_first[tile] = count;
    }
}

#define ARRAYS(X)                                                                      \
    X(edge, sides)                                                                     \
    X(edge_area, sides)                                                                \
    X(square, twice *sides)                                                            \
    X(edge_window, twice *sides)                                                       \
    X(triangle, triangles)                                                             \
    X(triangle_area, triangles)                                                        \
    X(triangle_window, 3 * twice * triangles)                                          \
    X(edge_first, points + 1)                                                          \
    X(triangle_first, points + 1)                                                      \
    X(area, points)                                                                    \
    X(density, points)                                                                 \
    X(tile_first, tiles + 1)                                                           \
    X(tile_point, sides + points + WEFT__SURFACE_RUN * tiles)

weft__contact_surface *weft__contact_surface_create(const weft__surface_draft *of,
                                                    const weft_allocator *memory)
{
    const size_t points = of->points, triangles = of->triangles;
    const size_t sides = 3 * triangles + (of->chain > 0.0 ? of->particles : 0);
    const size_t tiles = (points - 1) / tile_width(points) + 1,
                 twice = of->grids ? 2 : 1;
    weft__contact_surface *to = weft__zeroed(memory, 1, sizeof *to);
    side *list = weft__alloc(memory, sides, sizeof *list);
    uint32_t *work = weft__alloc(memory, points, sizeof *work);
    bool made = to != NULL && list != NULL && work != NULL;
    if (made && of->rows > 1) {
        to->order = weft__alloc(memory, points, sizeof *to->order);
        made = to->order != NULL;
    }
#define TAKE(array, number)                                                            \
    to->array = weft__zeroed(memory, number, sizeof *to->array);                       \
    made = made && to->array != NULL;
    if (made) {
        ARRAYS(TAKE)
    }
    if (made) {
        to->points = points, to->particles = of->particles, to->triangles = triangles;
        to->notch_width = INFINITY;
        to->grids = of->grids;
        memcpy(to->density, of->density, points * sizeof *to->density);
        add_triangles(of, work, to);
        surface_add_edges(of, list, list_sides(of, list), to);
        memset(work, 0, points * sizeof *work);
        if (to->order != NULL) {
            add_order(of, to->order);
        }
        add_tiles(of, work, to);
        double area = 0.0;
        for (size_t i = 0; i < of->particles; ++i) {
            area += to->area[i];
        }
        to->spacing = sqrt(area / (double)of->particles);
    }
    WEFT__FREE_ALL(memory, list, work);
    if (!made) {
        weft__contact_surface_destroy(to, memory);
    }
    return made ? to : NULL;
}

void weft__contact_surface_destroy(weft__contact_surface *of,
                                   const weft_allocator *memory)
{
    if (of != NULL) {
#define FREE(array, number) weft__free(memory, of->array);
        ARRAYS(FREE)
        WEFT__FREE_ALL(memory, of->slit_pairs, of->at_slit, of->order, of);
    }
}

size_t weft__contact_surface_bytes(const weft__contact_surface *of)
{
    const size_t points = of->points, triangles = of->triangles, sides = of->edges;
    const size_t tiles = (points - 1) / tile_width(points) + 1,
                 twice = of->grids ? 2 : 1;
#define BYTES(array, number) +(number) * sizeof *of->array
    return sizeof *of + of->slit_pair_count * sizeof *of->slit_pairs
           + (of->order != NULL ? points * sizeof *of->order : 0) ARRAYS(BYTES);
}

bool weft__is_slit_pair(const weft__contact_surface *surface, const uint64_t key[2])
{
    size_t low = 0, high = surface->slit_pair_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const uint64_t *at = surface->slit_pairs[middle];
        const bool before = at[0] < key[0] || (at[0] == key[0] && at[1] < key[1]);
        low = before ? middle + 1 : low;
        high = before ? high : middle;
    }
    return low < surface->slit_pair_count && surface->slit_pairs[low][0] == key[0]
           && surface->slit_pairs[low][1] == key[1];
}
