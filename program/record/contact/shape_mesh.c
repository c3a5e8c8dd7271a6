/* SPDX-License-Identifier: BSD-3-Clause */
/* shape_mesh.c -- a point of a shape's surface in the direction n from its core, which
 * is a point, the axis of a capsule or the inner box: core sign(n) + radius n / |n|, in
 * the norm of the shape's gap. */
#include "program/record/export/export.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "weft/elementary.h"

weft_scene *record_scene(const char *directory)
{
    char path[RECORD_PATH];
    weft_scene *scene = NULL;
    weft_scene_def def = weft_scene_def_default();
    weft_diagnostics *found = malloc(sizeof *found);
    def.file = path;
    if (found != NULL && record_path(directory, "scene.yaml", path, NULL) == WEFT_OK) {
        (void)weft_scene_load(&def, &scene, found, NULL);
    }
    free(found);
    return scene;
}

typedef struct solid {
    weft_shape_kind kind;
    double centre[3], axes[3][3]; /* the last axis is that of the poles */
    double core[3], radius;       /* [m] half the edges of the core */
} solid;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Makes axes[2] a unit vector, and two others perpendicular to it. Returns its length.
 */
static double complete(double axes[3][3])
{
    double *u = axes[0], *v = axes[1], *w = axes[2];
    const double length = sqrt(dot(w, w));
    size_t least = 0;
    for (size_t k = 0; k < 3; ++k) {
        w[k] /= length;
        least = fabs(w[k]) < fabs(w[least]) ? k : least;
    }
    const double side = sqrt(1.0 - w[least] * w[least]);
    for (size_t k = 0; k < 3; ++k) {
        u[k] = ((k == least) - w[least] * w[k]) / side;
    }
    for (size_t k = 0; k < 3; ++k) {
        v[k] = w[(k + 1) % 3] * u[(k + 2) % 3] - w[(k + 2) % 3] * u[(k + 1) % 3];
    }
    return length;
}

/* Its centre and the ends of its axes move as the vertices of a mesh do. */
static solid solid_of(const weft_shape *shape, double t)
{
    const bool box = shape->kind == WEFT_BOX, plane = shape->kind == WEFT_PLANE;
    solid made = { .kind = shape->kind,
                   .axes = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } },
                   .radius = box ? shape->rounding : shape->radius };
    double rest[4][3] = { { 0.0 } }, now[4][3];
    for (size_t k = 0; k < 3; ++k) {
        made.core[k] = box ? shape->half[k] - shape->rounding : 0.0;
    }
    if (shape->kind == WEFT_CAPSULE || plane) {
        for (size_t k = 0; k < 3; ++k) {
            made.axes[2][k] = plane ? shape->normal[k] : shape->to[k] - shape->at[k];
            rest[0][k] = plane ? 0.0 : 0.5 * made.axes[2][k];
        }
        made.core[2] = 0.5 * complete(made.axes);
    }
    for (size_t k = 0; k < 9; ++k) {
        rest[1 + k / 3][k % 3] = rest[0][k % 3] + made.axes[k / 3][k % 3];
    }
    const weft_body frame = { .vertices = 4, .keys = 1, .positions = rest[0] };
    weft_shape moves = *shape;
    moves.kind = WEFT_MESH, moves.body = &frame;
    weft_shape_vertices(&moves, t, now[0]);
    memcpy(made.centre, now[0], sizeof made.centre);
    for (size_t k = 0; k < 9; ++k) {
        made.axes[k / 3][k % 3] = now[1 + k / 3][k % 3] - now[0][k % 3];
    }
    return made;
}

static void place(const solid *of, const double local[3], double x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->centre[k] + local[0] * of->axes[0][k] + local[1] * of->axes[1][k]
               + local[2] * of->axes[2][k];
    }
}

static record_surface solid_surface(const solid *of, double *position)
{
    const size_t rows = RECORD_SHAPE_ROWS, cols = RECORD_SHAPE_COLS;
    for (size_t i = 0; i < rows * cols; ++i) {
        const size_t r = i / cols, c = i % cols;
        double n[3], local[3], ring;
        weft_sincos_turns(0.5 / (double)(rows - 1), (double)r, &ring, &n[2]);
        weft_sincos_turns(1.0 / (double)(cols - 1), (double)c, &n[1], &n[0]);
        n[0] *= ring, n[1] *= ring;
        const double side = n[0] * n[0] + n[1] * n[1], q2 = n[2] * n[2];
        const double sides = of->kind == WEFT_BOX
                                 ? side * side - 2.0 * n[0] * n[0] * n[1] * n[1]
                                 : side * side;
        const double norm = of->kind == WEFT_SPHERE ? 1.0 : sqrt(sqrt(sides + q2 * q2));
        for (size_t k = 0; k < 3; ++k) {
            const double sign = (n[k] > 0.0) - (n[k] < 0.0);
            local[k] = sign * of->core[k] + of->radius / norm * n[k];
        }
        place(of, local, position + 3 * i);
    }
    return (record_surface){ record_grid(rows, cols), position, NULL, NULL, true };
}

/* [m] The cloth's first particle, and how long and wide the cloth is together. */
static double cloth_extent(const weft_cloth_def *cloth, double from[3])
{
    if (cloth->mesh == NULL) {
        memcpy(from, cloth->origin, 3 * sizeof *from);
        return (double)cloth->rows * cloth->spacing[0]
               + (double)cloth->cols * cloth->spacing[1];
    }
    const double *x = cloth->mesh->start;
    double extent = 0.0;
    memcpy(from, x, 3 * sizeof *from);
    for (size_t k = 0; k < 3; ++k) {
        double low = x[k], high = x[k];
        for (size_t i = 1; i < cloth->mesh->vertices; ++i) {
            low = fmin(low, x[3 * i + k]);
            high = fmax(high, x[3 * i + k]);
        }
        extent += high - low;
    }
    return extent;
}

/* A square about the foot of the cloth's first particle, twice as wide as the cloth on
 * each side of it. */
static record_surface plane_surface(solid *of, const weft_cloth_def *cloth,
                                    double *position)
{
    double from[3];
    const double wide = 2.0 * cloth_extent(cloth, from);
    for (size_t k = 0; k < 3; ++k) {
        from[k] -= of->centre[k];
    }
    const double foot[3] = { dot(from, of->axes[0]), dot(from, of->axes[1]), 0.0 };
    place(of, foot, from);
    memcpy(of->centre, from, sizeof from);
    for (size_t i = 0; i < 4; ++i) {
        const double corner[3]
            = { i % 2 == 0 ? -wide : wide, i < 2 ? wide : -wide, 0.0 };
        place(of, corner, position + 3 * i);
    }
    return (record_surface){ record_grid(2, 2), position, NULL, NULL, true };
}

size_t record_shape_count(const weft_cloth_def *cloth)
{
    return cloth->contact.shape_count;
}

size_t record_shape_points(const weft_cloth_def *cloth)
{
    size_t most = RECORD_SHAPE_ROWS * RECORD_SHAPE_COLS;
    for (size_t k = 0; k < cloth->contact.shape_count; ++k) {
        const weft_body *body = cloth->contact.shapes[k].body;
        most = body != NULL && body->vertices > most ? body->vertices : most;
    }
    return most;
}

record_surface record_shape_surface(const weft_cloth_def *cloth, size_t k, double t,
                                    double *position)
{
    const weft_body *body = cloth->contact.shapes[k].body;
    if (body != NULL) {
        weft_shape_vertices(&cloth->contact.shapes[k], t, position);
        return (record_surface){ .faces = { .particles = body->vertices,
                                            .triangles = body->triangles,
                                            .corners = weft__unconst(body->corners) },
                                 .position = position,
                                 .doubles = true };
    }
    solid made = solid_of(&cloth->contact.shapes[k], t);
    return made.kind == WEFT_PLANE ? plane_surface(&made, cloth, position)
                                   : solid_surface(&made, position);
}
