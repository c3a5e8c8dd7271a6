/* SPDX-License-Identifier: BSD-3-Clause */
/* refine.c -- the same cloth at another size: a grid with another number of particles,
 * a cut or a mesh of a file refined, and where a vertex of the scene lies in it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/plane.h"
#include "program/survey/survey.h"
#include "study/converge/converge.h"

/* Twice the extent, in spacings. */
static size_t halves(const refine_axis *axis, size_t count)
{
    return 2 * (count - 1) - axis->clamp;
}

bool refine_line(const refine_axis *axis, size_t place, size_t *line)
{
    size_t refined = place, rest = 0;
    if (axis->count > 1 && !(axis->clamp && place <= 2)) {
        const size_t product = (place - axis->clamp) * halves(axis, axis->refined);
        refined = product / halves(axis, axis->count) + axis->clamp;
        rest = product % halves(axis, axis->count);
    }
    *line = refined / 2;
    return rest == 0 && refined % 2 == 0;
}

static bool scale_range(const refine_axis *axis, weft_range *range)
{
    ptrdiff_t *const ends[2] = { &range->first, &range->last };
    bool found = true;
    for (size_t i = 0; i < 2; ++i) {
        const ptrdiff_t index = *ends[i] + (*ends[i] < 0 ? (ptrdiff_t)axis->count : 0);
        size_t line;
        found = refine_line(axis, 2 * (size_t)index, &line) && found;
        *ends[i] = (ptrdiff_t)line;
    }
    return found;
}

static weft_status scale_place(const refinement *self, weft_range *rows,
                               weft_range *cols, const char *list, size_t i,
                               weft_error *err)
{
    return scale_range(&self->axis[0], rows) && scale_range(&self->axis[1], cols)
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID,
                                "%zu does not keep the place of cloth.%s.%zu",
                                self->axis[self->along].refined, list, i);
}

/* A clamp must leave a free line. */
static bool scale_counts(refinement *self, size_t size)
{
    refine_axis *along = &self->axis[self->along], *across = &self->axis[!self->along];
    const size_t product = (size - 1) * (across->count - 1);
    along->refined = size;
    across->refined = product / (along->count - 1) + 1;
    return product % (along->count - 1) == 0 && (!along->clamp || size > 2)
           && (!across->clamp || across->refined > 2);
}

/* A clamp stays where it is, half a spacing behind the first line. */
static void scale_lengths(refinement *self, size_t k)
{
    const refine_axis *axis = &self->axis[k];
    const double *to = k == 0 ? self->from->down : self->from->right;
    const double length = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    const double before = self->from->spacing[k];
    double *after = &self->cloth.spacing[k];
    if (axis->count > 1) {
        *after = before
                 * ((double)halves(axis, axis->count)
                    / (double)halves(axis, axis->refined));
    }
    for (size_t i = 0; axis->clamp && i < 3; ++i) {
        self->cloth.origin[i]
            += 0.5 * self->from->scale * (before - *after) * to[i] / length;
    }
}

weft_status refine_to(refinement *self, size_t size, weft_error *err)
{
    const weft_cloth_def *from = self->from;
    if (!scale_counts(self, size)) {
        return weft_error_set(err, WEFT_INVALID,
                              "%zu does not keep the ratio of rows to columns", size);
    }
    for (size_t i = 0; i < from->pin_count; ++i) {
        weft_pin *pin = &self->pins[i];
        *pin = from->pins[i];
        TRY(scale_place(self, &pin->rows, &pin->cols, "pins", i, err));
    }
    for (size_t i = 0; i < from->load_count; ++i) {
        weft_load *load = &self->loads[i];
        *load = from->loads[i];
        TRY(scale_place(self, &load->rows, &load->cols, "loads", i, err));
    }
    self->cloth = *from;
    self->cloth.rows = self->axis[0].refined;
    self->cloth.cols = self->axis[1].refined;
    self->cloth.pins = self->pins;
    self->cloth.loads = self->loads;
    scale_lengths(self, 0);
    scale_lengths(self, 1);
    return self->fabric != NULL ? weft_fabric_apply(self->fabric, &self->cloth, err)
                                : WEFT_OK;
}

weft_status refine_begin(refinement *self, const weft_scene *scene, weft_error *err)
{
    const weft_cloth_def *from = weft_scene_cloth(scene);
    const double down = (double)(from->rows - 1) * from->spacing[0];
    const double across = (double)(from->cols - 1) * from->spacing[1];
    *self = (refinement){ .from = from,
                          .fabric = weft_scene_fabric(scene),
                          .pins = calloc(from->pin_count + 1, sizeof *self->pins),
                          .loads = calloc(from->load_count + 1, sizeof *self->loads),
                          .axis = { { .count = from->rows }, { .count = from->cols } },
                          .along = across > down };
    return self->pins == NULL || self->loads == NULL
               ? weft_error_set(err, WEFT_NO_MEMORY, "no memory for pins")
               : refine_to(self, self->axis[self->along].count, err);
}

void refine_end(refinement *self)
{
    free(self->pins);
    free(self->loads);
}

/* Whether a pin holds all of a row, or of a column, of the scene's size. */
static bool is_pinned(const refinement *self, size_t axis, ptrdiff_t line)
{
    bool pinned = false;
    for (size_t i = 0; i < self->from->pin_count; ++i) {
        const weft_range ranges[2] = { self->pins[i].rows, self->pins[i].cols };
        const weft_range along = ranges[axis], across = ranges[!axis];
        pinned = pinned
                 || (along.first <= line && line <= along.last && across.first == 0
                     && (size_t)across.last + 1 == self->axis[!axis].count);
    }
    return pinned;
}

bool refine_clamp(refinement *self)
{
    for (size_t k = 0; k < 2; ++k) {
        self->axis[k].clamp = self->axis[k].count > 2 && is_pinned(self, k, 0)
                              && is_pinned(self, k, 1) && !is_pinned(self, k, 2);
    }
    return self->axis[0].clamp || self->axis[1].clamp;
}

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

/* The triangle of a flat piece, of one of several cloths, that x lies in or is nearest
 * to, as shares of its corners. */
static void find_place(const weft_mesh_def *mesh, size_t part, const double x[2],
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
        if (least > most && part_of(mesh, mesh->corners[3 * t]) == part) {
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
    const size_t part = part_of(from, vertex);
    const size_t kept = from->part_count == 0 ? vertex
                                              : vertex - from->parts[part].first
                                                    + mesh->parts[part].first;
    *out = (converge_probe){ { kept, kept, kept }, { 1.0, 0.0, 0.0 } };
    if (mesh != from && weft_scene_part_text(self->scene, part) != NULL) {
        size_t corner = 0;
        while (from->corners[corner] != vertex) {
            ++corner;
        }
        const rest_triangle at = rest_triangle_of(from, corner / 3);
        find_place(mesh, part, at.corners[corner % 3], out);
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
