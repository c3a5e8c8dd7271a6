/* SPDX-License-Identifier: BSD-3-Clause */
/* grid.c -- particles in rows and columns. */
#include <string.h>

#include "mesh/grid_def.h"

static void normalise(const double from[3], double to[3])
{
    const double length = weft__length(from);
    for (size_t k = 0; k < 3; ++k) {
        to[k] = from[k] / length;
    }
}

/* The row of the whole cloth that is row 0 here. */
static size_t top(const weft__mesh *mesh)
{
    return mesh->band.first - mesh->band.above;
}

void weft__grid_rest(const weft__mesh *mesh, size_t i, double x[3])
{
    const size_t r = top(mesh) + i / mesh->cols, c = i % mesh->cols;
    const double across = (double)c * mesh->spacing[1];
    const double along = (double)r * mesh->spacing[0];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = mesh->origin[k] + across * mesh->right[k] + along * mesh->down[k];
    }
}

void weft__grid_start(const weft__mesh *mesh, size_t i, double x[3])
{
    weft__grid_rest(mesh, i, x);
    for (size_t k = 0; k < 3; ++k) {
        const double from = mesh->origin[k];
        x[k] = from + mesh->scale * (x[k] - from);
    }
}

/* Half a cell on a rim, a whole one inside. */
static double width(size_t index, size_t count, double spacing)
{
    return weft__strip(index, count) * weft__width(count, spacing);
}

double weft__grid_area(const weft__mesh *mesh, size_t i)
{
    return width(top(mesh) + i / mesh->cols, mesh->band.rows, mesh->spacing[0])
           * width(i % mesh->cols, mesh->cols, mesh->spacing[1]);
}

double weft__shortest_edge(const weft__mesh *mesh)
{
    return mesh->band.rows == 1 ? mesh->spacing[1]
           : mesh->cols == 1    ? mesh->spacing[0]
                                : fmin(mesh->spacing[0], mesh->spacing[1]);
}

/* To the right, down, and the diagonal (r, c + 1)-(r + 1, c). */
size_t weft__edges_of(const weft__mesh *mesh, size_t i, uint32_t edges[3][2])
{
    const bool right = i % mesh->cols + 1 < mesh->cols;
    const bool down = i + mesh->cols < mesh->particles;
    const uint32_t here = (uint32_t)i, below = (uint32_t)(i + mesh->cols);
    size_t count = 0;
    if (right) {
        edges[count][0] = here, edges[count++][1] = here + 1;
    }
    if (down) {
        edges[count][0] = here, edges[count++][1] = below;
    }
    if (right && down) {
        edges[count][0] = here + 1, edges[count++][1] = below;
    }
    return count;
}

size_t weft__triangles_of(const weft__mesh *mesh, size_t i, uint32_t triangles[2][3])
{
    if (i % mesh->cols + 1 >= mesh->cols || i + mesh->cols >= mesh->particles) {
        return 0;
    }
    const uint32_t here = (uint32_t)i, below = (uint32_t)(i + mesh->cols);
    triangles[0][0] = here, triangles[0][1] = below, triangles[0][2] = here + 1;
    triangles[1][0] = below + 1, triangles[1][1] = here + 1, triangles[1][2] = below;
    return 2;
}

static size_t grid_at_most(size_t count, size_t most)
{
    return count < most ? count : most;
}

static weft_band band_of(const weft_cloth_def *def)
{
    const size_t first = def->band_rows > 0 ? def->band_first : 0;
    const size_t own = def->band_rows > 0 ? def->band_rows : def->rows;
    return (weft_band){ .rows = def->rows,
                        .first = first,
                        .own = own,
                        .above = grid_at_most(first, WEFT_GHOST_ROWS),
                        .below
                        = grid_at_most(def->rows - (first + own), WEFT_GHOST_ROWS) };
}

void weft__grid_init(weft__mesh *mesh, const weft_cloth_def *def)
{
    mesh->band = band_of(def);
    mesh->rows = mesh->band.above + mesh->band.own + mesh->band.below;
    mesh->cols = def->cols;
    mesh->particles = mesh->stride = mesh->rows * def->cols;
    mesh->block = def->cols;
    mesh->scale = def->scale;
    memcpy(mesh->spacing, def->spacing, sizeof mesh->spacing);
    memcpy(mesh->origin, def->origin, sizeof mesh->origin);
    memcpy(mesh->velocity, def->velocity, sizeof mesh->velocity);
    normalise(def->right, mesh->right);
    normalise(def->down, mesh->down);
}

bool weft__range_resolve(weft_range range, size_t count, size_t *first, size_t *last)
{
    const ptrdiff_t n = (ptrdiff_t)count;
    const ptrdiff_t a = range.first < 0 ? range.first + n : range.first;
    const ptrdiff_t b = range.last < 0 ? range.last + n : range.last;
    *first = (size_t)a;
    *last = (size_t)b;
    return a >= 0 && b < n && a <= b;
}

/* Of ranges in the whole cloth, the columns and those of the rows that are here. */
typedef struct grid_part {
    size_t r0, r1, c0, c1; /* [r0, r1) and [c0, c1] */
} grid_part;

static grid_part grid_part_of(const weft__mesh *mesh, weft_range rows, weft_range cols)
{
    const size_t low = top(mesh), high = low + mesh->rows;
    size_t a, b;
    grid_part out;
    weft__range_resolve(rows, mesh->band.rows, &a, &b);
    weft__range_resolve(cols, mesh->cols, &out.c0, &out.c1);
    out.r0 = (a < low ? low : a < high ? a : high) - low;
    out.r1 = (b < low ? low : b < high ? b + 1 : high) - low;
    return out;
}

static void add_load(weft__mesh *mesh, const weft_load *load)
{
    const grid_part of = grid_part_of(mesh, load->rows, load->cols);
    for (size_t r = of.r0; r < of.r1; ++r) {
        for (size_t c = of.c0; c <= of.c1; ++c) {
            mesh->mass[r * mesh->cols + c] += load->mass;
        }
    }
}

static void add_pin(weft__mesh *mesh, const weft_pin *pin, size_t number)
{
    const grid_part of = grid_part_of(mesh, pin->rows, pin->cols);
    for (size_t r = of.r0; r < of.r1; ++r) {
        for (size_t c = of.c0; c <= of.c1; ++c) {
            mesh->pin[r * mesh->cols + c] = (uint32_t)(number + 1);
        }
    }
}

void weft__grid_fill(weft__mesh *mesh, const weft_cloth_def *def)
{
    for (size_t i = 0; i < mesh->particles; ++i) {
        mesh->mass[i]
            = def->density > 0.0 ? def->density * weft__grid_area(mesh, i) : def->mass;
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        add_load(mesh, &def->loads[i]);
    }
    for (size_t i = 0; i < def->pin_count; ++i) {
        add_pin(mesh, &def->pins[i], i);
    }
}
