/* SPDX-License-Identifier: BSD-3-Clause */
/* tessellate.c -- a shape as the image of the surface of a block of cells. Along each
 * axis of the block lie `round` cells of an end, those of the flat part (none of a
 * sphere, nor across a capsule), and `round` cells of the other end. A point of the
 * block has on each axis a place c in the flat part, and d in [-1, 1] beyond it, tan of
 * equal angles: it goes to c + R d / |d|, in the norm of the shape's gap. */
#include "forces/contact/tessellate.h"

#include <string.h>

#include "base/memory.h"
#include "base/sized.h"
#include "weft/elementary.h"

/* sqrt(2) for diagonals, 0.95 R for the longest arc that d = 0 to 1 has. */
#define DIAGONAL 1.4142135623730951
#define ARC      0.95

/* Of a count: neighbours of a whole number have the same. */
#define SLACK 1e-5

/* ---- the block ------------------------------------------------------------------- */

double weft__facet_edge(const weft_shape *shape, double thickness)
{
    const double radius = shape->kind == WEFT_BOX ? shape->rounding : shape->radius;
    return sqrt(2.0 * radius * thickness);
}

static size_t cells_of(double length, double edge)
{
    const double cells = ceil(DIAGONAL * length / edge * (1.0 - SLACK));
    return cells < 1.0 ? 1 : cells < 1e6 ? (size_t)cells : (size_t)1000000;
}

/* The axis of a capsule is the last one. */
static void give_axes(const weft_shape *shape, weft__lattice *to)
{
    double *u = to->axes[0], *v = to->axes[1], *w = to->axes[2];
    memset(to->axes, 0, sizeof to->axes);
    u[0] = v[1] = w[2] = 1.0;
    if (shape->kind != WEFT_CAPSULE) {
        return;
    }
    size_t least = 0;
    for (size_t k = 0; k < 3; ++k) {
        w[k] = shape->to[k] - shape->at[k];
        to->centre[k] = 0.5 * w[k];
    }
    const double length = weft__length(w);
    to->inner[2] = 0.5 * length;
    for (size_t k = 0; k < 3; ++k) {
        w[k] /= length;
        least = fabs(w[k]) < fabs(w[least]) ? k : least;
    }
    const double side = sqrt(1.0 - w[least] * w[least]);
    for (size_t k = 0; k < 3; ++k) {
        u[k] = ((k == least) - w[least] * w[k]) / side;
    }
    weft__cross(w, u, v);
}

const char *weft__lattice_of(const weft_shape *shape, double edge, weft__lattice *out)
{
    *out = (weft__lattice){ .kind = shape->kind, .radius = shape->radius };
    if (shape->kind == WEFT_PLANE || shape->kind == WEFT_MESH) {
        return "triangles are made of a sphere, a capsule or a box";
    }
    if (weft__length(shape->spin) != 0.0) {
        return "a mesh cannot spin: it turns";
    }
    if (!(edge > 0.0) || !isfinite(edge)) {
        return "the longest edge of its triangles must be finite and > 0";
    }
    give_axes(shape, out);
    if (shape->kind == WEFT_BOX) {
        out->radius = shape->rounding;
        for (size_t k = 0; k < 3; ++k) {
            out->inner[k] = shape->half[k] - shape->rounding;
        }
    }
    out->round = cells_of(ARC * out->radius, edge);
    for (size_t k = 0; k < 3; ++k) {
        const double flat = 2.0 * out->inner[k];
        out->steps[k] = 2 * out->round + (flat > 0.0 ? cells_of(flat, edge) : 0);
    }
    const size_t *n = out->steps;
    const size_t cells = 2 * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0]);
    out->vertices = cells + 2;
    out->triangles = 2 * cells;
    return NULL;
}

/* ---- its points ------------------------------------------------------------------ */

/* The number of the vertex at `at` on the surface of the block, layer by layer. */
static uint32_t number_of(const size_t n[3], const size_t at[3])
{
    const size_t full = (n[0] + 1) * (n[1] + 1), ring = 2 * (n[0] + n[1]);
    const size_t i = at[0], j = at[1], k = at[2];
    if (k == 0 || k == n[2]) {
        return (uint32_t)(i + j * (n[0] + 1) + (k == 0 ? 0 : full + (k - 1) * ring));
    }
    const size_t along = j == 0      ? i
                         : i == n[0] ? n[0] + j
                         : j == n[1] ? n[0] + n[1] + (n[0] - i)
                                     : 2 * n[0] + n[1] + (n[1] - j);
    return (uint32_t)(full + (k - 1) * ring + along);
}

/* tan(45 degrees i / n) */
static double tangent(size_t i, size_t n)
{
    double sine, cosine;
    weft_sincos_turns(0.125, (double)i / (double)n, &sine, &cosine);
    return i == n ? 1.0 : sine / cosine;
}

static double tessellate_norm_of(weft_shape_kind kind, const double d[3])
{
    const double x = d[0] * d[0], y = d[1] * d[1], z = d[2] * d[2];
    return kind == WEFT_SPHERE    ? sqrt(x + y + z)
           : kind == WEFT_CAPSULE ? sqrt(sqrt((x + y) * (x + y) + z * z))
                                  : sqrt(sqrt(x * x + y * y + z * z));
}

static void tessellate_place(const weft__lattice *of, const size_t at[3], double x[3])
{
    double d[3], flat[3];
    for (size_t k = 0; k < 3; ++k) {
        const size_t round = of->round, last = of->steps[k] - round, i = at[k];
        const double cells = (double)(last - round);
        d[k] = i < round  ? -tangent(round - i, round)
               : i > last ? tangent(i - last, round)
                          : 0.0;
        flat[k] = i <= round ? -of->inner[k]
                  : i >= last
                      ? of->inner[k]
                      : of->inner[k] * (2.0 * (double)(i - round) / cells - 1.0);
    }
    const double scale = of->radius / tessellate_norm_of(of->kind, d);
    memcpy(x, of->centre, 3 * sizeof *x);
    for (size_t k = 0; k < 3; ++k) {
        const double local = flat[k] + scale * d[k];
        for (size_t c = 0; c < 3; ++c) {
            x[c] += local * of->axes[k][c];
        }
    }
}

/* ---- its triangles --------------------------------------------------------------- */

static double tessellate_apart(const double *places, uint32_t p, uint32_t q)
{
    const double *a = places + 3 * (size_t)p, *b = places + 3 * (size_t)q;
    const double displacement[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    return weft__dot(displacement, displacement);
}

/* A cell, counterclockwise, along its shorter diagonal. */
static void divide(const double *places, const uint32_t cell[4], uint32_t *to)
{
    const size_t first = tessellate_apart(places, cell[0], cell[2])
                                 <= tessellate_apart(places, cell[1], cell[3])
                             ? 0
                             : 1;
    for (size_t k = 0; k < 3; ++k) {
        to[k] = cell[(first + k) % 4];
        to[3 + k] = cell[(first + (k == 0 ? 0 : k + 1)) % 4];
    }
}

/* The side of the block that is low or high on an axis. Returns the end of `to`. */
static uint32_t *add_side(const weft__lattice *of, size_t axis, bool high,
                          double *places, uint32_t *to)
{
    static const size_t round[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
    const size_t *n = of->steps, a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (size_t cell = 0; cell < n[a] * n[b]; ++cell, to += 6) {
        uint32_t corners[4];
        for (size_t k = 0; k < 4; ++k) {
            const size_t *step = round[high ? k : 3 - k];
            size_t at[3];
            at[axis] = high ? n[axis] : 0;
            at[a] = cell % n[a] + step[0];
            at[b] = cell / n[a] + step[1];
            corners[k] = number_of(n, at);
            tessellate_place(of, at, places + 3 * (size_t)corners[k]);
        }
        divide(places, corners, to);
    }
    return to;
}

void weft__lattice_fill(const weft__lattice *of, double *places, uint32_t *corners)
{
    for (size_t side = 0; side < 6; ++side) {
        corners = add_side(of, side / 2, side % 2 == 1, places, corners);
    }
}

/* ---- for embedders --------------------------------------------------------------- */

weft_status weft_shape_triangulate_sized(const weft_shape *given, size_t size,
                                         double thickness, double edge,
                                         const weft_allocator *allocator,
                                         weft_body **out, weft_error *err)
{
    const weft_allocator memory = weft_allocator_or_malloc(allocator);
    weft_shape shape = weft_shape_default(WEFT_MESH);
    weft__refusal first = { WEFT_OK, err };
    weft__lattice lattice;
    *out = NULL;
    (void)weft__sized_read(&shape, sizeof shape, given, size);
    if (shape.kind != WEFT_MESH
        && !weft__shape_check(&shape, 0, &(weft__faults){ weft__keep_first, &first })) {
        return first.status;
    }
    const char *fault = weft__lattice_of(
        &shape, edge > 0.0 ? edge : weft__facet_edge(&shape, thickness), &lattice);
    if (fault != NULL || lattice.triangles > WEFT__MOST_FACETS) {
        return fault != NULL
                   ? weft_error_set(err, WEFT_INVALID, "%s", fault)
                   : weft_error_set(err, WEFT_INVALID,
                                    "%zu triangles are more than %d: a longer "
                                    "edge makes fewer",
                                    lattice.triangles, WEFT__MOST_FACETS);
    }
    const size_t places = 3 * lattice.vertices, corners = 3 * lattice.triangles;
    weft_body *body = weft__alloc(
        &memory, sizeof *body + places * sizeof(double) + corners * sizeof(uint32_t),
        1);
    if (body == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for triangles");
    }
    double *to = (double *)(void *)(body + 1);
    uint32_t *list = (uint32_t *)(void *)(to + places);
    weft__lattice_fill(&lattice, to, list);
    *body = (weft_body){ .vertices = lattice.vertices,
                         .triangles = lattice.triangles,
                         .keys = 1,
                         .positions = to,
                         .corners = list };
    *out = body;
    return WEFT_OK;
}

void weft_body_destroy(weft_body *body, const weft_allocator *allocator)
{
    const weft_allocator memory = weft_allocator_or_malloc(allocator);
    weft__free(&memory, body);
}
