/* SPDX-License-Identifier: BSD-3-Clause */
/* rest_report.c -- what a surface is that rests in space: its pieces and their sides,
 * how sharply it is folded, and how far its vertices are from being flat. */
#include <string.h>

#include "base/memory.h"
#include "base/plane.h"
#include "mesh/rigid.h"
#include "mesh/triangles_work.h"

#define PI          3.141592653589793
#define SHARP       1.0471975511965976 /* 60 degrees */
#define UNTURNED    0
#define TURNED      1
#define NOT_REACHED 2

typedef struct surface_survey {
    const weft__triangles *of;
    const weft_mesh_def *def;
    size_t part;
    weft_rest_report *out;
    uint8_t *turned; /* of triangles against the first of their piece */
    uint32_t *queue;
    double *angle; /* [rad] at each place */
    bool *open;    /* of places: they are on a boundary */
} surface_survey;

static bool counts(const surface_survey *at, size_t t)
{
    return weft__in_space(at->of, t)
           && weft__part_of(at->of, at->of->corner[t][0]) == at->part;
}

static size_t vertex_name(const surface_survey *at, size_t particle)
{
    const size_t vertex = at->of->vertex[particle];
    return at->def->file_index != NULL ? at->def->file_index[vertex] : vertex;
}

/* ---- sides ----------------------------------------------------------------------- */

/* Whether the corners of both triangles of an edge run along it the same way, so that
 * one of them is turned over. */
static bool runs_alike(const weft__triangles *of, const weft__edge *edge)
{
    bool up[2];
    for (size_t k = 0; k < 2; ++k) {
        const uint32_t *place = of->place[edge->triangle[k]];
        const size_t c = place[0] == edge->place[0]   ? 0
                         : place[1] == edge->place[0] ? 1
                                                      : 2;
        up[k] = place[(c + 1) % 3] == edge->place[1];
    }
    return up[0] == up[1];
}

/* Counts the piece of a triangle, from which all others of it are reached. */
static void survey_piece(surface_survey *at, uint32_t first)
{
    const weft__triangles *of = at->of;
    size_t end = 1, turned = 0;
    bool closed = true, sides = true;
    at->queue[0] = first;
    at->turned[first] = UNTURNED;
    for (size_t j = 0; j < 3 * end; ++j) {
        const uint32_t t = at->queue[j / 3];
        const weft__edge *edge = &of->edge_list[of->edge[t][j % 3]];
        const uint32_t other = edge->triangle[edge->triangle[0] == t ? 1 : 0];
        if (other == WEFT__NONE) {
            closed = false;
            continue;
        }
        const uint8_t is = (uint8_t)(at->turned[t] ^ (runs_alike(of, edge) ? 1 : 0));
        if (at->turned[other] == NOT_REACHED) {
            at->turned[other] = is;
            turned += is;
            at->queue[end++] = other;
        }
        sides = sides && at->turned[other] == is;
    }
    ++at->out->pieces;
    at->out->closed += closed;
    at->out->one_sided += !sides;
    at->out->flipped += !sides ? 0 : turned < end - turned ? turned : end - turned;
}

/* ---- angles ---------------------------------------------------------------------- */

static void arm(const weft__triangles *of, uint32_t from, uint32_t to, double d[3])
{
    const double *a = &of->space[3 * (size_t)of->particle[from]];
    const double *b = &of->space[3 * (size_t)of->particle[to]];
    for (size_t k = 0; k < 3; ++k) {
        d[k] = b[k] - a[k];
    }
}

static double angle_of(const double a[3], const double b[3])
{
    double normal[3];
    weft__cross(a, b, normal);
    return atan2(weft__length(normal), weft__dot(a, b));
}

/* [rad] by which the cloth turns at an edge of two triangles, 0: flat. */
static double fold_at(const weft__triangles *of, const weft__edge *edge)
{
    double along[3], side[2][3];
    arm(of, edge->place[0], edge->place[1], along);
    for (size_t k = 0; k < 2; ++k) {
        const uint32_t *place = of->place[edge->triangle[k]];
        size_t c = 0;
        while (place[c] == edge->place[0] || place[c] == edge->place[1]) {
            ++c;
        }
        arm(of, edge->place[0], place[c], side[k]);
        const double part = weft__dot(side[k], along) / weft__dot(along, along);
        for (size_t m = 0; m < 3; ++m) {
            side[k][m] -= part * along[m];
        }
    }
    return PI - angle_of(side[0], side[1]);
}

static void survey_edges(surface_survey *at)
{
    const weft__triangles *of = at->of;
    for (size_t e = 0; e < of->edges; ++e) {
        const weft__edge *edge = &of->edge_list[e];
        if (!counts(at, edge->triangle[0])) {
            continue;
        }
        if (edge->triangle[1] == WEFT__NONE) {
            at->open[edge->place[0]] = at->open[edge->place[1]] = true;
            continue;
        }
        const double fold = fold_at(of, edge);
        at->out->sharp += fold > SHARP;
        if (fold > at->out->fold) {
            at->out->fold = fold;
            for (size_t k = 0; k < 2; ++k) {
                at->out->fold_at[k] = vertex_name(at, of->particle[edge->place[k]]);
            }
        }
    }
}

static void survey_triangle(surface_survey *at, uint32_t t)
{
    const weft__triangles *of = at->of;
    ++at->out->triangles;
    at->out->woven += of->fabric[t] < of->fabric_count;
    at->out->blended += of->fabric[t] >= of->fabric_count;
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t *place = of->place[t];
        double a[3], b[3];
        arm(of, place[k], place[(k + 1) % 3], a);
        arm(of, place[k], place[(k + 2) % 3], b);
        at->angle[place[k]] += angle_of(a, b);
    }
    if (at->turned[t] == NOT_REACHED) {
        survey_piece(at, t);
    }
}

static void survey_all(surface_survey *at)
{
    const weft__triangles *of = at->of;
    memset(at->turned, NOT_REACHED, of->count);
    for (uint32_t t = 0; t < of->count; ++t) {
        if (counts(at, t)) {
            survey_triangle(at, t);
        }
    }
    survey_edges(at);
    for (size_t p = 0; p < of->places; ++p) {
        const double defect = 2.0 * PI - at->angle[p];
        if (at->angle[p] > 0.0 && !at->open[p]
            && fabs(defect) > fabs(at->out->defect)) {
            at->out->defect = defect;
            at->out->defect_at = vertex_name(at, of->particle[p]);
        }
    }
}

static void find_nothing(void *ctx, weft__mesh_part part, size_t index,
                         const char *message)
{
    (void)ctx, (void)part, (void)index, (void)message;
}

weft_status weft_cloth_def_rest(const weft_cloth_def *def, size_t part,
                                weft_rest_report *out, weft_error *err)
{
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    const weft__mesh_faults to = { find_nothing, NULL };
    weft__triangles *of = NULL;
    bool no_memory = false;
    *out = (weft_rest_report){ .triangles = 0 };
    if (def->mesh == NULL || !weft__any_in_space(def->mesh)
        || (!weft__triangles_create(&of, def->mesh, &memory, &to, &no_memory)
            && !no_memory)) {
        return WEFT_OK;
    }
    surface_survey at = { .of = of, .def = def->mesh, .part = part, .out = out };
    if (!no_memory) {
        at.turned = weft__alloc(&memory, of->count, sizeof *at.turned);
        at.queue = weft__alloc(&memory, of->count, sizeof *at.queue);
        at.angle = weft__zeroed(&memory, of->places, sizeof *at.angle);
        at.open = weft__zeroed(&memory, of->places, sizeof *at.open);
    }
    const bool made
        = at.turned != NULL && at.queue != NULL && at.angle != NULL && at.open != NULL;
    if (made) {
        survey_all(&at);
    }
    WEFT__FREE_ALL(&memory, at.turned, at.queue, at.angle, at.open);
    weft__triangles_destroy(of, &memory);
    return made ? WEFT_OK
                : weft_error_set(err, WEFT_NO_MEMORY, "no memory for triangles");
}
