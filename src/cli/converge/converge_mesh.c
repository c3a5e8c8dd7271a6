/* SPDX-License-Identifier: BSD-3-Clause */
/* converge_mesh.c -- a cut or a mesh of a file, refined: its cloth, and where a vertex
 * of the scene lies in it. */
#include <math.h>
#include <string.h>

#include "base/plane.h"
#include "cli/converge/converge.h"
#include "cli/survey/survey.h"

/* [m] The edge of as many equal triangles of the same area. */
static double edge_of(const weft_mesh_def *mesh)
{
    double sum = 0.0;
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const rest_triangle at = rest_triangle_of(mesh, t);
        sum += 2.0 * rest_area(&at);
    }
    return sqrt(2.0 / sqrt(3.0) * sum / (double)mesh->triangles);
}

/* The triangle of a flat piece that x lies in, or is nearest to, as shares of its
 * corners. */
static void find_place(const weft_mesh_def *mesh, const double x[2],
                       converge_probe *out)
{
    double most = -INFINITY;
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const rest_triangle at = rest_triangle_of(mesh, t);
        const double *a = at.corners[0], *b = at.corners[1], *c = at.corners[2],
                     area = weft__plane_turn(a, b, c);
        const double share[]
            = { weft__plane_turn(x, b, c) / area, weft__plane_turn(a, x, c) / area,
                weft__plane_turn(a, b, x) / area };
        const double least = fmin(share[0], fmin(share[1], share[2]));
        if (least > most) {
            most = least;
            for (size_t k = 0; k < 3; ++k) {
                out->particle[k] = mesh->corners[3 * t + k];
                out->share[k] = share[k];
            }
        }
    }
}

/* A cut has other vertices at another spacing, a refined file its own and more. */
static void find_vertex(const converge *self, const weft_mesh_def *mesh, size_t vertex,
                        converge_probe *out)
{
    const weft_mesh_def *from = weft_scene_cloth(self->scene)->mesh;
    *out = (converge_probe){ { vertex, vertex, vertex }, { 1.0, 0.0, 0.0 } };
    if (mesh != from && weft_scene_mesh_text(self->scene) != NULL) {
        size_t corner = 0;
        while (from->corners[corner] != vertex) {
            ++corner;
        }
        const rest_triangle at = rest_triangle_of(from, corner / 3);
        find_place(mesh, at.corners[corner % 3], out);
    }
}

int converge_open_mesh(converge *self, converge_size *to)
{
    arguments finer = *self->given;
    weft_error err = { 0 };
    finer.finer = to->size;
    if (to->size > 1) {
        const int code = open_scene(finer.operands[0], &finer, &to->scene, NULL);
        if (code != EXIT_DONE) {
            return code;
        }
    }
    const weft_scene *scene = to->size > 1 ? to->scene : self->scene;
    const weft_cloth_def *def = weft_scene_cloth(scene);
    if (cloth_create(scene, def, &to->cloth, &err) != WEFT_OK) {
        return report_error(&err);
    }
    to->spacing = edge_of(def->mesh);
    for (size_t i = 0; i < self->quantity_count; ++i) {
        converge_probe *probe = &to->probes[i];
        if (self->quantities[i].particle) {
            find_vertex(self, def->mesh, self->quantities[i].place[0], probe);
            for (size_t k = 0; k < 3; ++k) {
                probe->particle[k] = weft_cloth_index(to->cloth, probe->particle[k]);
            }
        }
    }
    return EXIT_DONE;
}
