/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies_start.c -- where a cloth passes through a body, or lies in one that is closed.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/plane.h"
#include "forces/contact/bodies/bodies.h"
#include "mesh/surface.h"

/* "edge (3, 4)-(3, 5)", or "shapes[1]". */
void weft__bodies_name(const void *ctx, const weft_primitive *of, char *text,
                       size_t size)
{
    const weft__bodies *own = ctx;
    const weft__mesh *mesh = own->pairs.mesh;
    if (of->particle[0] >= mesh->particles) {
        (void)snprintf(text, size, "shapes[%zu]",
                       weft__bodies_shape(own, of->particle[0]));
    } else {
        const weft_primitive named = weft__primitive_of(mesh, *of);
        (void)weft__primitive_text(mesh, &named, text, size);
    }
}

/* Whether each edge belongs to two triangles. */
static bool is_closed(const weft__bodies *own, const weft_body *body)
{
    const size_t sides = 3 * body->triangles;
    weft__ends *list = weft__alloc(&own->memory, sides, sizeof *list);
    for (size_t i = 0; list != NULL && i < sides; ++i) {
        list[i] = weft__ends_of(body->corners[i],
                                body->corners[i % 3 == 2 ? i - 2 : i + 1], 0);
    }
    bool closed = list != NULL && sides % 2 == 0;
    if (closed) {
        qsort(list, sides, sizeof *list, weft__compare_ends);
    }
    for (size_t i = 0; closed && i < sides; i += 2) {
        closed = weft__compare_ends(&list[i], &list[i + 1]) == 0
                 && (i + 2 == sides || weft__compare_ends(&list[i], &list[i + 2]) != 0);
    }
    weft__free(&own->memory, list);
    return closed;
}

typedef struct closed_body {
    const weft_body *body;
    const double *y; /* planes of its points */
    size_t points;
    double far[3]; /* [m] outside */
} closed_body;

static void bodies_start_place(const closed_body *of, size_t i, double x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->y[k * of->points + i];
    }
}

/* How often a segment from x to the outside pierces the body, by exact tests; < 0: it
 * meets an edge. */
static long pierces(const closed_body *of, const double x[3])
{
    long count = 0;
    for (size_t t = 0; t < of->body->triangles; ++t) {
        double c[3][3];
        for (size_t k = 0; k < 3; ++k) {
            bodies_start_place(of, of->body->corners[3 * t + k], c[k]);
        }
        const weft__meeting how = weft__segment_triangle(x, of->far, c[0], c[1], c[2]);
        if (how == WEFT__TOUCH) {
            return -1;
        }
        count += how == WEFT__PIERCE;
    }
    return count;
}

/* A point beyond the box of a body, another one with each try. */
static void find_far(closed_body *of, size_t try)
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, x[3];
    double high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < of->body->vertices; ++i) {
        bodies_start_place(of, i, x);
        for (size_t k = 0; k < 3; ++k) {
            low[k] = fmin(low[k], x[k]);
            high[k] = fmax(high[k], x[k]);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        const double wide = high[k] - low[k];
        of->far[k] = high[k] + wide * (0.37 + 0.29 * (double)k)
                     + (high[0] - low[0]) * (0.11 + 0.07 * (double)try);
    }
}

enum { TRIES = 16 };

static bool is_inside(closed_body *of, const double x[3])
{
    long count = -1;
    for (size_t try = 0; try < TRIES && count < 0; ++try) {
        find_far(of, try);
        count = pierces(of, x);
    }
    return count % 2 == 1;
}

/* Labels particles that edges with a free end join by their lowest one; pinned ones
 * that no such edge joins get WEFT__NONE. */
static void connect(const weft__mesh *mesh, const weft__contact_surface *surface,
                    uint32_t *label)
{
    for (uint32_t i = 0; i < surface->particles; ++i) {
        label[i] = mesh->pin[i] == 0 ? i : WEFT__NONE;
    }
    for (size_t e = 0; e < surface->edges && surface->edge[e][0] < surface->particles;
         ++e) {
        uint32_t a = surface->edge[e][0], b = surface->edge[e][1];
        if (mesh->pin[a] != 0 && mesh->pin[b] != 0) {
            continue;
        }
        label[a] = label[a] == WEFT__NONE ? a : label[a];
        label[b] = label[b] == WEFT__NONE ? b : label[b];
        while (label[a] != a) {
            a = label[a] = label[label[a]];
        }
        while (label[b] != b) {
            b = label[b] = label[label[b]];
        }
        label[a < b ? b : a] = a < b ? a : b;
    }
}

/* Of the particles that are their own label. */
static weft_status inside_error(const weft__bodies *own, const double *y,
                                const uint32_t *label, const weft__search *how,
                                const char *what, weft_error *err)
{
    const weft__mesh *mesh = own->pairs.mesh;
    const size_t points = own->pairs.points;
    size_t first = mesh->particles;
    for (size_t k = 0; k < own->contact->shape_count; ++k) {
        const weft_body *body = own->contact->shapes[k].def.body;
        if (body == NULL) {
            continue;
        }
        closed_body of = { .body = body, .y = y + first, .points = points };
        const bool closed = is_closed(own, body);
        first += body->vertices;
        for (size_t i = 0; closed && i < mesh->particles; ++i) {
            if (weft__stops(how->stop)) {
                return weft__stopped(err);
            }
            const double x[3] = { y[i], y[points + i], y[2 * points + i] };
            if (label[i] == i && is_inside(&of, x)) {
                char text[64];
                return weft_error_set(
                    err, WEFT_INVALID, "%s%s is inside shapes[%zu], a closed mesh%s",
                    how->where != NULL ? how->where : "",
                    weft__particle_name(mesh, weft__vertex_of(mesh, i), text,
                                        sizeof text),
                    k, what);
            }
        }
    }
    return WEFT_OK;
}

typedef void label_fn(const weft__mesh *mesh, const weft__contact_surface *surface,
                      uint32_t *label);

static weft_status named_inside(const weft__bodies *own, const double *y,
                                label_fn *find, const weft__search *how,
                                const char *what, weft_error *err)
{
    const size_t n = own->pairs.mesh->particles;
    uint32_t *label = weft__alloc(&own->memory, n, sizeof *label);
    if (label == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    find(own->pairs.mesh, own->pairs.surface, label);
    const weft_status status = inside_error(own, y, label, how, what, err);
    weft__free(&own->memory, label);
    return status;
}

weft_status weft__bodies_error(const void *own, double t, const double *y,
                               const weft__search *of, weft_error *err)
{
    const weft__bodies *bodies = own;
    double *all = weft__bodies_spread(bodies, &(weft__state){ .t = t, .y = y });
    weft_status status
        = all == NULL ? weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state")
                      : weft__named_crossing(&bodies->pairs, all, of, weft__bodies_name,
                                             own, err);
    if (status == WEFT_OK) { /* of each connected part one particle */
        status = named_inside(bodies, all, connect, of,
                              ", with all that is joined to it", err);
    }
    weft__free(&bodies->memory, all);
    return status;
}

/* Pinned particles beside a free one. */
static void label_pins(const weft__mesh *mesh, const weft__contact_surface *surface,
                       uint32_t *label)
{
    for (uint32_t i = 0; i < surface->particles; ++i) {
        label[i] = WEFT__NONE;
    }
    for (size_t e = 0; e < surface->edges && surface->edge[e][0] < surface->particles;
         ++e) {
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t i = surface->edge[e][k], other = surface->edge[e][1 - k];
            label[i] = mesh->pin[i] != 0 && mesh->pin[other] == 0 ? i : label[i];
        }
    }
}

weft_status weft__bodies_pins_error(const weft__bodies *own, double t, const double *y,
                                    const weft__search *of, weft_error *err)
{
    double *all = weft__bodies_spread(own, &(weft__state){ .t = t, .y = y });
    weft_status status
        = all == NULL ? weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state")
                      : named_inside(own, all, label_pins, of,
                                     ", and a pin holds it there", err);
    weft__free(&own->memory, all);
    if (status == WEFT_INVALID && err != NULL) {
        err->status = WEFT_SOLVER;
    }
    return status == WEFT_INVALID ? WEFT_SOLVER : status;
}
