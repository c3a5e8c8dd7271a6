/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface.h"

#include <stdio.h>

#include "base/plane.h"

/* ---- triangles and edges --------------------------------------------------------- */

/* Triangles, of 3 particles, or edges, of 2; particle 0 has number `first`. */
static size_t grid_cells(const weft__mesh *mesh, size_t size, size_t first,
                         uint32_t *corners)
{
    size_t count = 0;
    for (size_t i = 0; i < mesh->particles; ++i) {
        uint32_t triangles[2][3], edges[3][2];
        const size_t more = size == 3 ? weft__triangles_of(mesh, i, triangles)
                                      : weft__edges_of(mesh, i, edges);
        for (size_t j = 0; corners != NULL && j < size * more; ++j) {
            corners[size * count + j]
                = (uint32_t)first
                  + (size == 3 ? triangles[j / 3][j % 3] : edges[j / 2][j % 2]);
        }
        count += more;
    }
    return count;
}

/* Those of all parts that are grids, behind `count`; places: their particles have
 * numbers behind so many. */
static size_t add_grid_cells(const weft__triangles *of, size_t size, size_t count,
                             const size_t *places, uint32_t *corners)
{
    size_t place = places != NULL ? *places : 0;
    for (size_t k = 0; k < of->part_count; ++k) {
        const weft__part *part = &of->parts[k];
        if (part->grid.rows > 0) {
            count += grid_cells(&part->grid, size, places != NULL ? place : part->first,
                                corners != NULL ? corners + size * count : NULL);
            place += part->count;
        }
    }
    return count;
}

size_t weft__surface_triangles(const weft__mesh *mesh, uint32_t *corners)
{
    const weft__triangles *of = mesh->triangles;
    if (of == NULL) {
        return grid_cells(mesh, 3, 0, corners);
    }
    for (size_t j = 0; corners != NULL && j < 3 * of->count; ++j) {
        corners[j] = of->vertex[of->corner[j / 3][j % 3]];
    }
    return add_grid_cells(of, 3, of->count, NULL, corners);
}

/* [m] u along a row, v up a column of a grid. */
static void surface_place_at(const weft__mesh *mesh, size_t i, double uv[2])
{
    if (mesh->triangles != NULL) {
        const double *at = mesh->triangles->rest[i];
        uv[0] = mesh->triangles->mirrored[i] ? -at[0] : at[0];
        uv[1] = at[1];
    } else {
        const size_t whole = weft__whole_index(mesh, i);
        const size_t row = whole / mesh->cols, col = whole % mesh->cols;
        uv[0] = (double)col * mesh->spacing[1];
        uv[1] = 0.0 - (double)row * mesh->spacing[0];
    }
}

/* Of two edges that are sewn together the first stands for both. */
size_t weft__surface_edges(const weft__mesh *mesh, uint32_t *ends)
{
    const weft__triangles *of = mesh->triangles;
    size_t count = 0;
    if (of == NULL) {
        return grid_cells(mesh, 2, 0, ends);
    }
    for (size_t e = 0; e < of->edges; ++e) {
        const weft__edge *edge = &of->edge_list[e];
        if (edge->sewn < e) {
            continue;
        }
        for (size_t k = 0; ends != NULL && k < 2; ++k) {
            ends[2 * count + k] = of->vertex[of->particle[edge->place[k]]];
        }
        ++count;
    }
    return add_grid_cells(of, 2, count, NULL, ends);
}

size_t weft__surface_places(const weft__mesh *mesh, uint32_t *corner_uv, double *uv)
{
    const weft__triangles *of = mesh->triangles;
    size_t places = of != NULL ? of->places : mesh->particles;
    if (corner_uv != NULL && of == NULL) {
        (void)grid_cells(mesh, 3, 0, corner_uv);
    } else if (corner_uv != NULL) {
        for (size_t j = 0; j < 3 * of->count; ++j) {
            corner_uv[j] = of->place[j / 3][j % 3];
        }
        (void)add_grid_cells(of, 3, of->count, &of->places, corner_uv);
    }
    for (size_t i = 0; uv != NULL && i < places; ++i) {
        surface_place_at(mesh, i, &uv[2 * i]);
    }
    for (size_t k = 0; of != NULL && k < of->part_count; ++k) {
        const weft__mesh *grid = &of->parts[k].grid;
        for (size_t i = 0; uv != NULL && i < grid->particles; ++i) {
            surface_place_at(grid, i, &uv[2 * (places + i)]);
        }
        places += grid->particles;
    }
    return places;
}

/* ---- normals --------------------------------------------------------------------- */

/* Adds (q - p) x (r - p). */
static void add_normal(const double *x, size_t n, size_t p, size_t q, size_t r,
                       double sum[3])
{
    double a[3], b[3];
    for (size_t k = 0; k < 3; ++k, x += n) {
        a[k] = x[q] - x[p];
        b[k] = x[r] - x[p];
    }
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
}

/* Around a particle of a grid: below, right, above right, above, left, below left. */
static void add_grid_normals(const weft__mesh *mesh, const double *x, size_t i,
                             double sum[3])
{
    const size_t cols = mesh->cols, c = i % cols;
    const bool up = i >= cols, down = i + cols < mesh->particles;
    const bool left = c > 0, right = c + 1 < cols;
    const size_t ring[7]
        = { i + cols, i + 1, i + 1 - cols, i - cols, i - 1, i - 1 + cols, i + cols };
    const bool there[6] = { down && right, right && up,  right && up,
                            up && left,    left && down, left && down };
    for (size_t k = 0; k < 6; ++k) {
        if (there[k]) {
            add_normal(x, mesh->stride, i, ring[k], ring[k + 1], sum);
        }
    }
}

void weft__surface_normal(const weft__mesh *mesh, const double *x, size_t i,
                          double normal[3])
{
    const weft__triangles *of = mesh->triangles;
    const weft__part *part = weft__grid_at(mesh, i);
    double sum[3] = { 0.0, 0.0, 0.0 };
    if (part != NULL) {
        add_grid_normals(&part->grid, x + part->first, i - part->first, sum);
    } else if (of == NULL) {
        add_grid_normals(mesh, x, i, sum);
    } else {
        for (size_t j = of->around_first[i]; j < of->around_first[i + 1]; ++j) {
            const uint32_t *corner = of->corner[of->around[j]];
            add_normal(x, mesh->particles, corner[0], corner[1], corner[2], sum);
        }
    }
    const double length = weft__length(sum);
    for (size_t k = 0; k < 3; ++k) {
        normal[k] = length > 0.0 ? sum[k] / length : 0.0;
    }
}

size_t weft__surface_pieces(const weft__mesh *mesh, size_t *sewn, double *length)
{
    const weft__triangles *of = mesh->triangles;
    *sewn = 0;
    *length = 0.0;
    for (size_t e = 0; of != NULL && e < of->edges; ++e) {
        const weft__edge *edge = &of->edge_list[e];
        if (edge->sewn != WEFT__NONE && edge->sewn > e) {
            *length += sqrt(
                weft__squared(of->rest[edge->place[0]], of->rest[edge->place[1]]));
            ++*sewn;
        }
    }
    size_t pieces = of != NULL ? of->pieces : 1;
    for (size_t k = 0; of != NULL && k < of->part_count; ++k) {
        pieces += of->parts[k].grid.rows > 0;
    }
    return pieces;
}

/* ---- names ----------------------------------------------------------------------- */

const char *weft__name_text(const weft__mesh *mesh, size_t vertex,
                            char text[WEFT__NAME_TEXT])
{
    const weft__triangles *of = mesh->triangles;
    const weft__part *part = weft__grid_at(mesh, vertex);
    if (part != NULL || of == NULL) {
        const size_t cols = part != NULL ? part->grid.cols : mesh->cols;
        const size_t i = vertex - (part != NULL ? part->first : 0);
        (void)snprintf(text, WEFT__NAME_TEXT, "(%zu, %zu)", i / cols, i % cols);
    } else {
        (void)snprintf(text, WEFT__NAME_TEXT, "%zu",
                       of->name != NULL ? of->name[vertex] : vertex);
    }
    return text;
}

const char *weft__cloth_name(const weft__mesh *mesh, size_t vertex,
                             char text[WEFT__CLOTH_TEXT])
{
    const weft__triangles *of = mesh->triangles;
    text[0] = '\0';
    if (of != NULL && of->part_count > 0) {
        (void)snprintf(text, WEFT__CLOTH_TEXT, " of %s",
                       of->parts[weft__part_of(of, vertex)].name);
    }
    return text;
}

const char *weft__particle_name(const weft__mesh *mesh, size_t vertex, char *text,
                                size_t size)
{
    char name[WEFT__NAME_TEXT], of[WEFT__CLOTH_TEXT];
    const bool grid = mesh->triangles == NULL || weft__grid_at(mesh, vertex) != NULL;
    (void)snprintf(text, size, "%s %s%s", grid ? "particle" : "vertex",
                   weft__name_text(mesh, vertex, name),
                   weft__cloth_name(mesh, vertex, of));
    return text;
}

/* A triangle of a grid is known by its cell, that of the top left particle. */
static size_t cell_of(const weft__mesh *mesh, const weft_primitive *triangle)
{
    const weft__part *part = weft__grid_at(mesh, triangle->particle[0]);
    const size_t first = part != NULL ? part->first : 0;
    const size_t cols = part != NULL ? part->grid.cols : mesh->cols;
    size_t row = SIZE_MAX, col = SIZE_MAX;
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = triangle->particle[k] - first;
        row = i / cols < row ? i / cols : row;
        col = i % cols < col ? i % cols : col;
    }
    return first + row * cols + col;
}

const char *weft__primitive_text(const weft__mesh *mesh,
                                 const weft_primitive *primitive, char *text,
                                 size_t size)
{
    char names[3][WEFT__NAME_TEXT] = { "" }, of[WEFT__CLOTH_TEXT];
    (void)weft__cloth_name(mesh, primitive->particle[0], of);
    for (size_t k = 0; k < primitive->count; ++k) {
        weft__name_text(mesh, primitive->particle[k], names[k]);
    }
    if (primitive->count == 1) {
        return weft__particle_name(mesh, primitive->particle[0], text, size);
    }
    if (primitive->count == 2) {
        (void)snprintf(text, size, "edge %s-%s%s", names[0], names[1], of);
    } else if (mesh->triangles != NULL
               && weft__grid_at(mesh, primitive->particle[0]) == NULL) {
        (void)snprintf(text, size, "triangle %s-%s-%s%s", names[0], names[1], names[2],
                       of);
    } else {
        (void)snprintf(text, size, "cell %s%s",
                       weft__name_text(mesh, cell_of(mesh, primitive), names[0]), of);
    }
    return text;
}
