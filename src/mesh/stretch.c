/* SPDX-License-Identifier: BSD-3-Clause */
/* stretch.c -- how far a cloth is stretched where it starts, from its definition.
 */
#include "mesh/triangles_work.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/plane.h"

/* The stretches of one triangle: F maps its rest shape to where it starts, and the
 * singular values of F are the largest and the least; their product is the ratio of the
 * areas. */
typedef struct strain {
    double least, mean, most; /* mean: sqrt of the ratio of the areas */
} strain;

static strain stretch_strain_of(const weft_mesh_def *def, size_t t)
{
    const double *x[3];
    double a[3], b[3], u[3][2], cross[3];
    weft__def_corners(def, t, u);
    for (size_t k = 0; k < 3; ++k) {
        x[k] = &def->start[3 * (size_t)weft__vertex_at(def, t, k)];
    }
    const double det = weft__plane_turn(u[0], u[1], u[2]);
    const double p = u[1][0] - u[0][0], q = u[1][1] - u[0][1];
    const double r = u[2][0] - u[0][0], s = u[2][1] - u[0][1];
    for (size_t k = 0; k < 3; ++k) { /* the columns of F */
        const double d = x[1][k] - x[0][k], e = x[2][k] - x[0][k];
        a[k] = (s * d - q * e) / det;
        b[k] = (p * e - r * d) / det;
    }
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = (k + 1) % 3, j = (k + 2) % 3;
        cross[k] = a[i] * b[j] - a[j] * b[i];
    }
    const double aa = weft__dot(a, a), bb = weft__dot(b, b), ab = weft__dot(a, b);
    const double half = 0.5 * (aa - bb), areas = weft__length(cross);
    const double most = sqrt(0.5 * (aa + bb) + sqrt(half * half + ab * ab));
    return (strain){ most > 0.0 ? areas / most : 0.0, sqrt(areas), most };
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void name_corners(const weft_mesh_def *def, size_t t, size_t names[3])
{
    for (size_t k = 0; k < 3; ++k) {
        const size_t vertex = weft__vertex_at(def, t, k);
        names[k] = def->file_index != NULL ? def->file_index[vertex] : vertex;
    }
}

/* Of the triangles of a part, or of all; means has room for them. */
static void take_triangles(const weft_mesh_def *def, size_t part, double *means,
                           weft_stretch *out)
{
    size_t count = 0, least = 0, most = 0;
    for (size_t t = 0; t < def->triangles; ++t) {
        if (def->part_count > 0
            && weft__part_at(def, weft__vertex_at(def, t, 0)) != part) {
            continue;
        }
        const strain of = stretch_strain_of(def, t);
        if (count == 0 || of.least < out->least) {
            out->least = of.least, least = t;
        }
        if (count == 0 || of.most > out->largest) {
            out->largest = of.most, most = t;
        }
        means[count++] = of.mean;
    }
    if (count > 0) {
        qsort(means, count, sizeof *means, by_value);
        out->median = 0.5 * (means[(count - 1) / 2] + means[count / 2]);
        name_corners(def, least, out->least_at);
        name_corners(def, most, out->largest_at);
    }
    out->triangles = count;
}

weft_status weft_cloth_def_stretch(const weft_cloth_def *def, size_t part,
                                   weft_stretch *out, weft_error *err)
{
    const weft_mesh_def *mesh = def->mesh;
    const weft_cloth_def *grid = mesh == NULL          ? def
                                 : mesh->grids != NULL ? mesh->grids[part]
                                                       : NULL;
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    *out = (weft_stretch){ .triangles = 0 };
    if (grid != NULL) {
        out->least = out->median = out->largest = grid->scale;
        return WEFT_OK;
    }
    double *means = weft__zeroed(&memory, mesh->triangles, sizeof *means);
    if (means == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu triangles",
                              mesh->triangles);
    }
    take_triangles(mesh, part, means, out);
    weft__free(&memory, means);
    return WEFT_OK;
}
