/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_rest.c -- what the rows of a triangle's bending energy are where the cloth
 * starts, for triangles that are free of it there. */
#include "base/grow.h"
#include "forces/bending/plate.h"
#include "mesh/rigid.h"

/* Room for one more row at rest, of `more` particles. */
static bool reserve_rows(weft__rest_rows *of, size_t more, const weft_allocator *memory)
{
    weft__plate_rest *to = of->to;
    const size_t count = to->count + 1;
    const size_t entries = (to->first != NULL ? to->first[to->count] : 0) + more;
    const bool fresh = to->first == NULL;
    const bool made
        = weft__reserve(memory, &to->triangle, &of->room[0], count,
                        sizeof *to->triangle)
          && weft__reserve(memory, &to->first, &of->room[1], count + 1,
                           sizeof *to->first)
          && weft__reserve(memory, &to->square, &of->room[2], count, sizeof *to->square)
          && weft__reserve(memory, &to->particle, &of->room[3], entries,
                           sizeof *to->particle)
          && weft__reserve(memory, &to->weight, &of->room[4], entries,
                           sizeof *to->weight);
    if (made && fresh) {
        to->first[0] = 0;
    }
    return made;
}

/* [1/m] Gradients of the corners' shares in the plane of a triangle at rest. */
static void corner_gradients(const weft__triangles *mesh, uint32_t triangle,
                             double grad[3][2])
{
    const double twice = 2.0 * mesh->area[triangle];
    for (size_t i = 0; i < 3; ++i) {
        const double *from = weft__rest_at(mesh, triangle, (i + 1) % 3);
        const double *to = weft__rest_at(mesh, triangle, (i + 2) % 3);
        grad[i][0] = (from[1] - to[1]) / twice;
        grad[i][1] = (to[0] - from[0]) / twice;
    }
}

/* Where the angles are those of the start, a vector there by the columns of the
 * deformation of the triangle, and along its normal. */
typedef struct start_frame {
    double column[2][3], normal[3], gram[3];
} start_frame;

static const double *start_at(const weft__triangles *mesh, uint32_t triangle,
                              uint32_t particle)
{
    return (weft__in_space(mesh, triangle) ? mesh->space : mesh->start)
           + 3 * (size_t)particle;
}

static void frame_at_start(const weft__triangles *mesh, uint32_t triangle,
                           const double grad[3][2], start_frame *out)
{
    memset(out, 0, sizeof *out);
    for (size_t j = 0; j < 18; ++j) {
        const size_t i = j / 6, a = j / 3 % 2, k = j % 3;
        const double *x = start_at(mesh, triangle, mesh->corner[triangle][i]);
        const double *from = start_at(mesh, triangle, mesh->corner[triangle][0]);
        out->column[a][k] += grad[i][a] * (x[k] - from[k]);
    }
    weft__cross(out->column[0], out->column[1], out->normal);
    const double size = weft__length(out->normal);
    for (size_t k = 0; k < 3; ++k) {
        out->normal[k] /= size;
    }
    out->gram[0] = weft__dot(out->column[0], out->column[0]);
    out->gram[1] = weft__dot(out->column[0], out->column[1]);
    out->gram[2] = weft__dot(out->column[1], out->column[1]);
}

/* The shares of the columns in v. */
static void shares_of(const start_frame *of, const double v[3], double share[2])
{
    const double p = weft__dot(of->column[0], v), q = weft__dot(of->column[1], v);
    const double det = of->gram[0] * of->gram[2] - of->gram[1] * of->gram[1];
    share[0] = (of->gram[2] * p - of->gram[1] * q) / det;
    share[1] = (of->gram[0] * q - of->gram[1] * p) / det;
}

/* What row m of a stencil has in the start shape. */
static void value_at_start(const weft__triangles *mesh, const weft__rest_stencil *of,
                           size_t m, double v[3])
{
    const double *from = start_at(mesh, of->triangle, of->particle[0]);
    v[0] = v[1] = v[2] = 0.0;
    for (size_t j = 0; j < of->count; ++j) {
        const double *x = start_at(mesh, of->triangle, of->particle[j]);
        for (size_t c = 0; c < 3; ++c) {
            v[c] += of->r[j][m] * (x[c] - from[c]);
        }
    }
}

bool weft__rest_rows_take(weft__rest_rows *rows, const weft__triangles *mesh,
                          const weft__rest_stencil *of, const weft_allocator *memory)
{
    weft__plate_rest *to = rows->to;
    double grad[3][2], k[3], square = 0.0;
    start_frame frame;
    if (!reserve_rows(rows, of->count, memory)) {
        return false;
    }
    corner_gradients(mesh, of->triangle, grad);
    frame_at_start(mesh, of->triangle, (const double(*)[2])grad, &frame);
    for (size_t m = 0; m < 3; ++m) {
        double v[3], share[2];
        value_at_start(mesh, of, m, v);
        shares_of(&frame, v, share);
        k[m] = weft__dot(v, frame.normal);
        square += k[m] * k[m];
        for (size_t i = 0; i < 3; ++i) {
            of->r[of->corner[i]][m] -= share[0] * grad[i][0] + share[1] * grad[i][1];
        }
    }
    const size_t first = to->first[to->count];
    for (size_t j = 0; j < of->count; ++j) {
        to->particle[first + j] = of->particle[j];
        to->weight[first + j] = weft__dot(k, of->r[j]);
    }
    to->square[to->count] = square;
    to->triangle[to->count++] = of->triangle;
    to->first[to->count] = first + of->count;
    return true;
}
