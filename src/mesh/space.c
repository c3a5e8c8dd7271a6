/* SPDX-License-Identifier: BSD-3-Clause */
/* space.c -- triangles whose rest shape lies in space: where their corners are in their
 * own planes, what the warp makes of the fabric in each of them, and in which order
 * their particles lie. */
#include "mesh/triangles_work.h"

#include <string.h>

#include "base/finite.h"
#include "mesh/rigid.h"

/* Sine between the warp and a normal: below the first the fabric of a triangle is taken
 * alike in all directions, above the second the warp counts in full. */
#define WARP_LOST 0.1
#define WARP_FULL 0.3

/* ---- frames ---------------------------------------------------------------------- */

/* Axes of the plane of a triangle, and what its sides are along them. */
typedef struct frame {
    double axis[2][3], area; /* [m^2] twice that of the triangle */
    double base, along;      /* [m] side 0-1; side 0-2 by the first axis */
} frame;

static void space_side(const weft_mesh_def *def, size_t t, size_t k, double side[3])
{
    const double *from = weft__space_of(def, weft__vertex_at(def, t, 0));
    const double *to = weft__space_of(def, weft__vertex_at(def, t, k));
    for (size_t m = 0; m < 3; ++m) {
        side[m] = to[m] - from[m];
    }
}

static frame frame_of(const weft_mesh_def *def, size_t t)
{
    double a[3], b[3], normal[3];
    frame out;
    space_side(def, t, 1, a);
    space_side(def, t, 2, b);
    weft__cross(a, b, normal);
    out.base = weft__length(a);
    out.area = weft__length(normal);
    for (size_t m = 0; m < 3; ++m) {
        out.axis[0][m] = a[m] / out.base;
        normal[m] /= out.area;
    }
    out.along = weft__dot(b, out.axis[0]);
    weft__cross(normal, out.axis[0], out.axis[1]);
    return out;
}

void weft__def_corners(const weft_mesh_def *def, size_t t, double corner[3][2])
{
    if (weft__rest_in_space(def, weft__vertex_at(def, t, 0)) == NULL) {
        for (size_t k = 0; k < 3; ++k) {
            const double *at = &def->rest[2 * (size_t)weft__place_at(def, t, k)];
            corner[k][0] = at[0], corner[k][1] = at[1];
        }
        return;
    }
    const frame of = frame_of(def, t);
    memset(corner, 0, 3 * sizeof *corner);
    corner[1][0] = of.base;
    corner[2][0] = of.along;
    corner[2][1] = of.area / of.base;
}

double weft__space_twice_area(const weft_mesh_def *def, size_t t, double *longest)
{
    double a[3], b[3], c[3], normal[3];
    space_side(def, t, 1, a);
    space_side(def, t, 2, b);
    for (size_t m = 0; m < 3; ++m) {
        c[m] = b[m] - a[m];
    }
    weft__cross(a, b, normal);
    *longest = fmax(fmax(weft__length(a), weft__length(b)), weft__length(c));
    return weft__length(normal);
}

/* ---- the warp -------------------------------------------------------------------- */

/* The warp along the axes of a triangle; returns its length there, the sine between it
 * and the normal. */
static double warp_in(const weft_rest *rest, const frame *of, double along[2])
{
    const double length = weft__length(rest->warp);
    for (size_t k = 0; k < 2; ++k) {
        along[k] = length > 0.0 ? weft__dot(of->axis[k], rest->warp) / length : 0.0;
    }
    return sqrt(along[0] * along[0] + along[1] * along[1]);
}

/* The part of the fabric as it is woven; the rest is alike in all directions. */
static double woven_part(double sine)
{
    const double s = fmin(1.0, fmax(0.0, (sine - WARP_LOST) / (WARP_FULL - WARP_LOST)));
    return s * s * (3.0 - 2.0 * s);
}

double weft__woven_part(const weft_mesh_def *def, size_t t)
{
    const weft_rest *rest = weft__rest_in_space(def, weft__vertex_at(def, t, 0));
    double along[2];
    if (rest == NULL) {
        return 1.0;
    }
    const frame of = frame_of(def, t);
    return woven_part(warp_in(rest, &of, along));
}

/* An orthotropic law by its parts 11, 22, 12, 66, in the plane and of bending. */
typedef struct fabric_law {
    double plane[4], bend[4];
} fabric_law;

static fabric_law law_of(const weft_fabric *of)
{
    return (fabric_law){ { of->stretch[1], of->stretch[0], of->coupling, of->shear },
                         { of->bend[1], of->bend[0], 0.0, of->twist / 2.0 } };
}

/* Its mean over all directions. */
static void mean_parts(const double c[4], double to[4])
{
    to[0] = to[1] = (3.0 * c[0] + 3.0 * c[1] + 2.0 * c[2] + 4.0 * c[3]) / 8.0;
    to[2] = (c[0] + c[1] + 6.0 * c[2] - 4.0 * c[3]) / 8.0;
    to[3] = (c[0] + c[1] - 2.0 * c[2] + 4.0 * c[3]) / 8.0;
}

/* Fabric `to` becomes fabric `from` with so much of it woven. */
static void blend_fabric(weft__triangles *out, size_t from, double woven, size_t to)
{
    const fabric_law of = law_of(&out->fabrics[from]);
    fabric_law mean = of;
    mean_parts(of.plane, mean.plane);
    mean_parts(of.bend, mean.bend);
    for (size_t k = 0; k < 4; ++k) {
        mean.plane[k] = woven * of.plane[k] + (1.0 - woven) * mean.plane[k];
        mean.bend[k] = woven * of.bend[k] + (1.0 - woven) * mean.bend[k];
    }
    weft_fabric *fabric = &out->fabrics[to];
    *fabric = out->fabrics[from];
    fabric->stretch[1] = mean.plane[0], fabric->stretch[0] = mean.plane[1];
    fabric->coupling = mean.plane[2], fabric->shear = mean.plane[3];
    fabric->bend[1] = mean.bend[0], fabric->bend[0] = mean.bend[1];
    fabric->twist = 2.0 * mean.bend[3];
    out->more[to] = (weft__fabric_more){ mean.bend[2], out->more[from].barrier };
}

/* ---- tables ---------------------------------------------------------------------- */

/* Where corner k is once the second axis turns to the warp. */
static void turned(const double corner[2], const double warp[2], double sine,
                   double to[2])
{
    const double u = corner[0], v = corner[1];
    to[0] = sine > 0.0 ? (u * warp[1] - v * warp[0]) / sine : u;
    to[1] = sine > 0.0 ? (u * warp[0] + v * warp[1]) / sine : v;
}

/* Triangle t of the tables is triangle `from` of the definition, whose corner `low`
 * comes first. */
static void set_frame(weft__work *at, size_t t, size_t from, size_t low, size_t *next)
{
    weft__triangles *out = at->out;
    const weft_mesh_def *def = at->def;
    const weft_rest *rest = weft__rest_in_space(def, weft__vertex_at(def, from, 0));
    double corner[3][2], warp[2];
    if (rest == NULL) {
        return;
    }
    const frame of = frame_of(def, from);
    const double sine = warp_in(rest, &of, warp), woven = woven_part(sine);
    const size_t fabrics = out->fabric_count, own = out->fabric[t];
    weft__def_corners(def, from, corner);
    for (size_t k = 0; k < 3; ++k) {
        turned(corner[(low + k) % 3], warp, woven > 0.0 ? sine : 0.0, out->frame[t][k]);
    }
    out->in_space[t] = true;
    if (woven == 0.0) {
        out->fabric[t] = (uint32_t)(fabrics + own);
    } else if (woven < 1.0) {
        blend_fabric(out, own, woven, *next);
        out->fabric[t] = (uint32_t)(*next)++;
    }
}

/* Which triangles are free of bending where they start. */
static void set_angles(weft__work *at)
{
    weft__triangles *out = at->out;
    for (size_t t = 0; out->angled != NULL && t < out->count; ++t) {
        const size_t part = weft__part_at(at->def, out->vertex[out->corner[t][0]]);
        out->angled[t] = weft__starts_bent(&at->def->rests[part]);
    }
}

void weft__space_fill(weft__work *at)
{
    weft__triangles *out = at->out;
    size_t next = 2 * out->fabric_count;
    set_angles(at);
    if (out->frame == NULL) {
        return;
    }
    for (size_t i = 0; i < at->def->vertices; ++i) {
        if (weft__rest_in_space(at->def, out->vertex[i]) != NULL) {
            memcpy(&out->space[3 * i], weft__space_of(at->def, out->vertex[i]),
                   3 * sizeof *out->space);
        }
    }
    for (size_t i = 0; i < out->fabric_count; ++i) {
        blend_fabric(out, i, 0.0, out->fabric_count + i);
    }
    for (size_t t = 0; t < out->count; ++t) {
        const size_t from = at->order[t];
        const uint32_t first = out->vertex[out->corner[t][0]];
        size_t low = 0;
        while (weft__vertex_at(at->def, from, low) != first) {
            ++low;
        }
        set_frame(at, t, from, low, &next);
    }
}

size_t weft__space_fabrics(const weft_mesh_def *def)
{
    size_t more = 0;
    if (weft__any_in_space(def)) {
        more = def->fabric_count;
        for (size_t t = 0; t < def->triangles; ++t) {
            const double woven = weft__woven_part(def, t);
            more += woven > 0.0 && woven < 1.0;
        }
    }
    return more;
}

/* ---- order ----------------------------------------------------------------------- */

/* Where the vertices of a cloth lie in space. */
typedef struct space_extent {
    double low[3], high[3];
    size_t axis[2]; /* the two longest */
} space_extent;

static void extent_of(const weft_mesh_def *def, size_t part, space_extent *of)
{
    size_t least = 0;
    *of = (space_extent){ { INFINITY, INFINITY, INFINITY },
                          { -INFINITY, -INFINITY, -INFINITY },
                          { 0, 0 } };
    for (size_t i = 0; i < def->vertices; ++i) {
        const double *x = weft__space_of(def, i);
        for (size_t k = 0; weft__part_at(def, i) == part && k < 3; ++k) {
            of->low[k] = fmin(of->low[k], x[k]);
            of->high[k] = fmax(of->high[k], x[k]);
        }
    }
    for (size_t k = 1; k < 3; ++k) {
        least
            = of->high[k] - of->low[k] <= of->high[least] - of->low[least] ? k : least;
    }
    of->axis[0] = least == 0 ? 1 : 0;
    of->axis[1] = least == 2 ? 1 : 2;
}

static void set_space_keys(weft__work *at, size_t part)
{
    const weft_mesh_def *def = at->def;
    space_extent of;
    extent_of(def, part, &of);
    const size_t *axis = of.axis;
    const double low[2] = { of.low[axis[0]], of.low[axis[1]] };
    const double side = fmax(of.high[axis[0]] - low[0], of.high[axis[1]] - low[1]);
    for (size_t i = 0; i < def->vertices; ++i) {
        if (weft__part_at(def, i) == part) {
            const double *x = weft__space_of(def, i);
            at->view[2 * i] = x[axis[0]];
            at->view[2 * i + 1] = x[axis[1]];
            at->key[i] = weft__curve_key(&at->view[2 * i], low, side);
        }
    }
}

void weft__space_keys(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    for (size_t k = 0; weft__any_in_space(def) && k < parts; ++k) {
        if (def->rests[k].shape == WEFT_REST_START) {
            set_space_keys(at, k);
        }
    }
}

/* ---- faults ---------------------------------------------------------------------- */

static void check_rest_of(weft__work *at, size_t part)
{
    const weft_rest *of = &at->def->rests[part];
    const bool warp = weft__length(of->warp) != 0.0;
    if ((unsigned)of->shape > WEFT_REST_START
        || (unsigned)of->angle > WEFT_ANGLE_START) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                         "mesh: rest %zu has shape %d and angle %d, no weft_rest_shape "
                         "or no weft_rest_angle",
                         part, (int)of->shape, (int)of->angle);
    } else if (!weft__all_finite(of->warp, 3)) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                         "mesh: rest %zu has the warp [%g, %g, %g], not finite", part,
                         of->warp[0], of->warp[1], of->warp[2]);
    } else if (warp && of->shape == WEFT_REST_PLANE) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                         "warp needs rest: start; in the plane the warp lies along v");
    }
}

void weft__rests_check(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    for (size_t k = 0; def->rests != NULL && k < parts; ++k) {
        check_rest_of(at, k);
    }
    for (size_t i = 0; !at->failed && weft__any_in_space(def) && i < def->vertices;
         ++i) {
        if (weft__rest_in_space(def, i) != NULL
            && !weft__all_finite(weft__space_of(def, i), 3)) {
            weft__mesh_fault(at, WEFT__MESH_VERTEX, i,
                             "vertex %zu rests at coordinates that are not finite",
                             weft__name_of(at, i));
        }
    }
}

void weft__warps_check(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    double most[WEFT_CLOTHS_MAX] = { 0.0 }, along[2];
    if (!weft__any_in_space(def)) {
        return;
    }
    for (size_t t = 0; t < def->triangles; ++t) {
        const size_t vertex = weft__vertex_at(def, t, 0);
        const weft_rest *rest = weft__rest_in_space(def, vertex);
        if (rest != NULL) {
            const frame of = frame_of(def, t);
            double *part = &most[weft__part_at(def, vertex)];
            *part = fmax(*part, warp_in(rest, &of, along));
        }
    }
    const size_t parts = def->part_count > 0 ? def->part_count : 1;
    for (size_t k = 0; k < parts; ++k) {
        const weft_rest *rest = &def->rests[k];
        if (rest->shape == WEFT_REST_START && weft__length(rest->warp) > 0.0
            && most[k] < WARP_LOST) {
            weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                             "warp [%g, %g, %g] is normal to the cloth: the largest "
                             "sine between them is %.2g, and %g is needed",
                             rest->warp[0], rest->warp[1], rest->warp[2], most[k],
                             WARP_LOST);
        }
    }
}
