/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/self/crossing.h"

#include "base/finite.h"
#include "mesh/surface.h"

typedef struct counting {
    const weft__quadtree *tree;
    size_t loose; /* SIZE_MAX: none */
    weft__stop *stop;
    weft__crossing_fn *visit;
    void *ctx;
} counting;

/* An edge, or what it is compared with. */
typedef struct element {
    size_t key;
    weft_primitive of;
    double x[3][3], box[2][3]; /* [m] */
} element;

static element element_of(const counting *of, size_t key, size_t count,
                          const uint32_t *particle)
{
    const size_t n = of->tree->own->points;
    element out = { .key = key, .of.count = count };
    for (size_t i = 0; i < count; ++i) {
        out.of.particle[i] = particle[i];
        for (size_t k = 0; k < 3; ++k) {
            const double x = out.x[i][k] = of->tree->y[k * n + particle[i]];
            out.box[0][k] = i == 0 ? x : fmin(out.box[0][k], x);
            out.box[1][k] = i == 0 ? x : fmax(out.box[1][k], x);
        }
    }
    return out;
}

static bool boxes_apart(const element *a, const element *b)
{
    return weft__boxes_apart(a->box, b->box, 0.0);
}

static bool any_free(const counting *of, const element *primitive)
{
    bool any = false;
    for (size_t i = 0; i < primitive->of.count; ++i) {
        const size_t at = primitive->of.particle[i];
        any = any || !weft__self_held(of->tree->own, at) || at == of->loose;
    }
    return any;
}

static void crossing_keep(counting *of, const element *edge, const element *other,
                          weft__meeting how)
{
    if (how != WEFT__APART && (any_free(of, edge) || any_free(of, other))) {
        const weft__crossing one
            = { { edge->key, other->key }, { edge->of, other->of }, how };
        of->visit(of->ctx, &one);
    }
}

/* ---- pairs ----------------------------------------------------------------------- */

/* Their common particles; one of them is corner *i of the edge and *j of the other. */
static size_t common(const element *edge, const element *other, size_t *i, size_t *j)
{
    size_t count = 0;
    for (size_t k = 0; k < edge->of.count * other->of.count; ++k) {
        if (edge->of.particle[k % edge->of.count]
            == other->of.particle[k / edge->of.count]) {
            *i = k % edge->of.count, *j = k / edge->of.count;
            ++count;
        }
    }
    return count;
}

static weft__meeting segment_element(const double p[3], const double q[3],
                                     const element *of)
{
    return of->of.count == 3
               ? weft__segment_triangle(p, q, of->x[0], of->x[1], of->x[2])
               : weft__segment_segment(p, q, of->x[0], of->x[1]);
}

/* Beside their common corner, which is i of the edge and j of the other. */
static weft__meeting elsewhere(const element *edge, const element *other, size_t i,
                               size_t j)
{
    const double *corner = edge->x[i], *end = edge->x[1 - i];
    const double *b = other->x[(j + 1) % other->of.count];
    const double *c = other->x[(j + 2) % other->of.count];
    if (other->of.count == 3 && weft__orientation(corner, b, c, end) != 0) {
        return WEFT__APART;
    }
    const bool meet = other->of.count == 3
                          ? weft__segment_segment(corner, end, b, c) != WEFT__APART
                          : weft__segment_segment(b, b, corner, end) != WEFT__APART;
    return meet || segment_element(end, end, other) != WEFT__APART ? WEFT__TOUCH
                                                                   : WEFT__APART;
}

static void crossing_meet(counting *of, const element *edge, const element *other)
{
    size_t i, j;
    if (boxes_apart(edge, other)) {
        return;
    }
    switch (common(edge, other, &i, &j)) {
    case 0:
        crossing_keep(of, edge, other, segment_element(edge->x[0], edge->x[1], other));
        break;
    case 1:
        crossing_keep(of, edge, other, elsewhere(edge, other, i, j));
        break;
    default: /* a side of the triangle */
        break;
    }
}

void weft__incident_of(const weft__self *own, size_t i, size_t size, weft__incident *to)
{
    const weft__contact_surface *surface = own->surface;
    *to = (weft__incident){ .size = size, .key = size == 2 ? 3 * i : 2 * i };
    if (surface != NULL) {
        const uint32_t *first
            = size == 2 ? surface->edge_first : surface->triangle_first;
        to->key = first[i], to->count = first[i + 1] - first[i];
        to->at = size == 2 ? surface->edge[first[i]] : surface->triangle[first[i]];
        return;
    }
    uint32_t edges[3][2], triangles[2][3];
    to->count = size == 2 ? weft__edges_of(own->mesh, i, edges)
                          : weft__triangles_of(own->mesh, i, triangles);
    for (size_t k = 0; k < size * to->count; ++k) {
        to->room[k] = size == 2 ? edges[k / 2][k % 2] : triangles[k / 3][k % 3];
    }
    to->at = to->room;
}

/* The edges of node i with the triangles of node j, or with its edges in a chain. */
static void compare_nodes(counting *of, size_t i, size_t j)
{
    const weft__self *own = of->tree->own;
    const bool chain
        = own->surface == NULL && (own->mesh->rows == 1 || own->mesh->cols == 1);
    weft__incident edges, others;
    if (chain && i >= j) {
        return;
    }
    weft__incident_of(own, i, 2, &edges);
    weft__incident_of(own, j, chain ? 2 : 3, &others);
    for (size_t k = 0; k < edges.count * others.count; ++k) {
        const size_t e = k / others.count, o = k % others.count;
        const element edge = element_of(of, edges.key + e, 2, edges.at + 2 * e);
        const element other = element_of(of, 1 + others.key + o, others.size,
                                         others.at + others.size * o);
        if (own->surface == NULL || own->surface->slit_pair_count == 0
            || !weft__at_slit(own->surface, edges.key + e, others.key + o)) {
            crossing_meet(of, &edge, &other);
        }
    }
}

/* Edges of node i without length, as two particles. */
static void keep_points(counting *of, size_t i)
{
    weft__incident edges;
    weft__incident_of(of->tree->own, i, 2, &edges);
    for (size_t e = 0; e < edges.count; ++e) {
        const element a = element_of(of, edges.key + e, 1, edges.at + 2 * e);
        const element b = element_of(of, 0, 1, edges.at + 2 * e + 1);
        crossing_keep(of, &a, &b, boxes_apart(&a, &b) ? WEFT__APART : WEFT__TOUCH);
    }
}

static bool crossing_compare_all(void *ctx, size_t i, size_t j)
{
    counting *of = ctx;
    compare_nodes(of, i, j);
    if (i != j) {
        compare_nodes(of, j, i);
    } else {
        keep_points(of, i);
    }
    return !weft__stops(of->stop);
}

bool weft__each_crossing(const weft__quadtree *tree, const weft__search *of,
                         weft__crossing_fn *visit, void *ctx)
{
    const size_t loose = of->loose == 0 ? SIZE_MAX : of->loose - 1;
    counting all = { tree, loose, of->stop, visit, ctx };
    return weft__tree_pairs(tree, 0.0, crossing_compare_all, &all);
}

static void count(void *ctx, const weft__crossing *one)
{
    weft__crossings *found = ctx;
    if (found->count == 0 || one->key[0] < found->first.key[0]
        || (one->key[0] == found->first.key[0] && one->key[1] < found->first.key[1])) {
        found->first = *one;
    }
    ++found->count;
}

weft__crossings weft__crossings_of(const weft__quadtree *tree, const weft__search *of)
{
    weft__crossings found = { .count = 0 };
    (void)weft__each_crossing(tree, of, count, &found);
    return found;
}

void weft__self_name(const void *ctx, const weft_primitive *of, char *text, size_t size)
{
    const weft__self *own = ctx;
    const weft_primitive named = weft__primitive_of(own->mesh, *of);
    (void)weft__primitive_text(own->mesh, &named, text, size);
}

weft_status weft__crossing_error(const void *own, double t, const double *y,
                                 const weft__search *of, weft_error *err)
{
    (void)t;
    return weft__named_crossing(own, y, of, weft__self_name, own, err);
}

void weft__crossing_names(const weft__crossing *one, weft__name_fn *by, const void *ctx,
                          char text[WEFT__CROSSING_TEXT])
{
    char names[2][96];
    for (size_t k = 0; k < 2; ++k) {
        by(ctx, &one->side[k], names[k], sizeof names[k]);
    }
    (void)snprintf(text, WEFT__CROSSING_TEXT, "%s %s %s", names[0],
                   one->how == WEFT__PIERCE ? "passes through" : "touches", names[1]);
}

/* ---- pins ------------------------------------------------------------------------ */

/* The corners of a cloth that pins hold in both sides of a pair. */
static size_t held_in(const weft__self *own, const weft__crossing *one, size_t held[6])
{
    size_t count = 0;
    for (size_t j = 0; j < 2; ++j) {
        for (size_t k = 0; k < one->side[j].count; ++k) {
            const size_t i = one->side[j].particle[k];
            if (i < own->mesh->particles && own->mesh->pin[i] != 0) {
                held[count++] = i;
            }
        }
    }
    return count;
}

typedef struct held_pairs {
    const weft__self *own;
    size_t count;
} held_pairs;

static void count_held(void *ctx, const weft__crossing *one)
{
    held_pairs *of = ctx;
    size_t held[6];
    of->count += held_in(of->own, one, held) > 0;
}

/* "; pins hold (3, 4) and (3, 5), and corners of 12 pairs" of pairs whose first is
 * *one; "" without pins. */
static void held_text(const weft__quadtree *tree, const weft__search *of,
                      const weft__crossings *found, char *text, size_t size)
{
    const weft__self *own = tree->own;
    held_pairs all = { .own = own };
    size_t held[6];
    char names[2][WEFT__NAME_TEXT] = { "", "" };
    const size_t count = held_in(own, &found->first, held);
    (void)weft__each_crossing(tree, of, count_held, &all);
    for (size_t k = 0; k < count && k < 2; ++k) {
        weft__name_text(
            own->mesh,
            weft__vertex_of(own->mesh, weft__whole_index(own->mesh, held[k])),
            names[k]);
    }
    const bool more = all.count > (count > 0 ? 1 : 0);
    const int used = all.count == 0
                         ? 0
                         : snprintf(text, size, "; pins hold %s%s%s%s", names[0],
                                    count > 1 ? " and " : "", names[1],
                                    count > 0 && more ? ", and " : "");
    text[used] = '\0';
    if (more && (size_t)used < size) {
        (void)snprintf(text + used, size - (size_t)used, "corners of %zu pairs",
                       all.count);
    }
}

weft_status weft__named_crossing(const weft__self *own, const double *y,
                                 const weft__search *of, weft__name_fn *by,
                                 const void *ctx, weft_error *err)
{
    char text[WEFT__CROSSING_TEXT], more[48] = "", pins[160];
    if (!own->law.self) {
        return WEFT_OK;
    }
    if (!weft__all_finite(y, 3 * own->points)) { /* no comparison finds a NaN */
        return weft_error_set(err, WEFT_NOT_FINITE, "%sthe state is not finite",
                              of->where != NULL ? of->where : "");
    }
    const weft__quadtree tree = weft__tree_of(own, y);
    const weft__crossings found = weft__crossings_of(&tree, of);
    if (of->stop != NULL && of->stop->came) {
        return weft__stopped(err);
    }
    if (found.count == 0) {
        return WEFT_OK;
    }
    if (found.count > 1) {
        (void)snprintf(more, sizeof more, "; %zu such pairs", found.count);
    }
    weft__crossing_names(&found.first, by, ctx, text);
    held_text(&tree, of, &found, pins, sizeof pins);
    return weft_error_set(err, WEFT_INVALID, "%s%s%s%s",
                          of->where != NULL ? of->where : "", text, more, pins);
}
