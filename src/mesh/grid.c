/* SPDX-License-Identifier: BSD-3-Clause */
/* grid.c -- particles in rows and columns. */
#include <string.h>

#include "mesh/mesh.h"

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

void weft__rest_position(const weft__mesh *mesh, size_t r, size_t c, double x[3])
{
    const double across = (double)c * mesh->spacing[1];
    const double along = (double)(top(mesh) + r) * mesh->spacing[0];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = mesh->origin[k] + across * mesh->right[k] + along * mesh->down[k];
    }
}

void weft__start_position(const weft__mesh *mesh, size_t r, size_t c, double x[3])
{
    weft__rest_position(mesh, r, c, x);
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

double weft__area(const weft__mesh *mesh, size_t r, size_t c)
{
    return width(top(mesh) + r, mesh->band.rows, mesh->spacing[0])
           * width(c, mesh->cols, mesh->spacing[1]);
}

static size_t at_most(size_t count, size_t most)
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
                        .above = at_most(first, WEFT_GHOST_ROWS),
                        .below = at_most(def->rows - (first + own), WEFT_GHOST_ROWS) };
}

void weft__grid_init(weft__mesh *mesh, const weft_cloth_def *def)
{
    mesh->band = band_of(def);
    mesh->rows = mesh->band.above + mesh->band.own + mesh->band.below;
    mesh->cols = def->cols;
    mesh->particles = mesh->rows * def->cols;
    mesh->block = def->cols;
    mesh->scale = def->scale;
    memcpy(mesh->spacing, def->spacing, sizeof mesh->spacing);
    memcpy(mesh->origin, def->origin, sizeof mesh->origin);
    memcpy(mesh->velocity, def->velocity, sizeof mesh->velocity);
    normalise(def->right, mesh->right);
    normalise(def->down, mesh->down);
}
