/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles.c -- the tables of a mesh of triangles from its definition, in linear time.
 */
#include "mesh/triangles_work.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/sized.h"
#include "mesh/grid_def.h"

enum { FEW = 16 }; /* edges of a vertex, which are sorted one by one */

void weft_mesh_def_init(weft_mesh_def *def, size_t size)
{
    const weft_mesh_def start = { .struct_size = (uint32_t)size };
    weft__sized_write(def, size, &start, sizeof start);
}

/* ---- edges ----------------------------------------------------------------------- */

static int by_high(const void *a, const void *b)
{
    const weft__half_edge *x = a, *y = b;
    return x->high != y->high
               ? (x->high > y->high) - (x->high < y->high)
               : (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void sort_halves(weft__half_edge *of, size_t count)
{
    for (size_t i = 1; i < count && count <= FEW; ++i) {
        const weft__half_edge kept = of[i];
        size_t j = i;
        for (; j > 0 && by_high(&kept, &of[j - 1]) < 0; --j) {
            of[j] = of[j - 1];
        }
        of[j] = kept;
    }
    if (count > FEW) {
        qsort(of, count, sizeof *of, by_high);
    }
}

/* Fills halves and first from the corners of T triangles. */
static void list_halves(weft__work *at, const uint32_t *corners, size_t vertices,
                        size_t count)
{
    const size_t all = 3 * count;
    memset(at->first, 0, (vertices + 1) * sizeof *at->first);
    for (size_t pass = 0; pass < 2; ++pass) {
        for (size_t h = 0; h < all; ++h) {
            const size_t t = h / 3, k = h % 3;
            if (at->bad[t] != 0) {
                continue;
            }
            __builtin_prefetch(&at->first[corners[weft__soon(h, 64, all)]], 1);
            const uint32_t p = corners[3 * t + (k + 1) % 3];
            const uint32_t q = corners[3 * t + (k + 2) % 3], low = p < q ? p : q;
            if (pass == 0) {
                ++at->first[low];
            } else {
                at->halves[--at->first[low]]
                    = (weft__half_edge){ p < q ? q : p, (uint32_t)t, (uint8_t)k,
                                         p > q };
            }
        }
        for (size_t i = 0; pass == 0 && i < vertices; ++i) {
            at->first[i + 1] += at->first[i];
        }
    }
    for (size_t i = 0; i < vertices; ++i) {
        sort_halves(at->halves + at->first[i], at->first[i + 1] - at->first[i]);
    }
}

static uint32_t triangles_root(uint32_t *piece, uint32_t t)
{
    while (piece[t] != t) {
        t = piece[t] = piece[piece[t]];
    }
    return t;
}

/* Whether two half edges between the same vertices have the same places there. */
static bool same_places(const weft_mesh_def *def, const weft__half_edge *a,
                        const weft__half_edge *b)
{
    const size_t i = (a->corner + 1U) % 3, j = (a->corner + 2U) % 3;
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = weft__vertex_at(def, b->triangle, k);
        for (size_t end = 0; end < 2; ++end) {
            const size_t c = end == 0 ? i : j;
            if (weft__vertex_at(def, a->triangle, c) == vertex
                && weft__place_at(def, a->triangle, c)
                       != weft__place_at(def, b->triangle, k)) {
                return false;
            }
        }
    }
    return true;
}

/* Why the triangles of two half-edges run the same way. They share two vertices, so
 * that equal sums mean that they share the third. */
static const char *advice(weft__work *at, const weft__half_edge of[2])
{
    const uint32_t *a = &at->def->corners[3 * (size_t)of[0].triangle];
    const uint32_t *b = &at->def->corners[3 * (size_t)of[1].triangle];
    return a[0] + (uint64_t)a[1] + a[2] == b[0] + (uint64_t)b[1] + b[2]
               ? "one is there twice"
           : weft__is_one_sided(at, of[1].triangle)
               ? "the surface has one side alone, as a Moebius band: cut it open"
               : "one of them is flipped";
}

/* Edges of the same two vertices: at most two, in opposite directions. */
static void triangles_join(weft__work *at, uint32_t low, const weft__half_edge *from,
                           size_t count)
{
    const size_t p = weft__name_of(at, low), q = weft__name_of(at, from->high);
    if (count > 2) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, from[2].triangle,
                         "edge %zu-%zu has %zu triangles; an edge has one or two", p, q,
                         count);
    } else if (count == 2 && from[0].down == from[1].down
               && weft__rest_in_space(at->def, low) == NULL) {
        weft__mesh_fault(
            at, WEFT__MESH_TRIANGLE, from[1].triangle,
            "two triangles run along edge %zu-%zu in the same direction: %s", p, q,
            advice(at, from));
    } else if (count == 2 && same_places(at->def, &from[0], &from[1])) {
        const uint32_t a = triangles_root(at->piece, from[0].triangle),
                       b = triangles_root(at->piece, from[1].triangle);
        at->piece[a < b ? b : a] = a < b ? a : b;
    }
}

typedef void edge_fn(weft__work *at, uint32_t low, const weft__half_edge *from,
                     size_t count);

static void each_edge(weft__work *at, size_t vertices, edge_fn *visit)
{
    const uint32_t *corners = at->def->corners, *places = at->def->corner_uv;
    places = places != NULL ? places : corners;
    for (size_t i = 0; i < vertices; ++i) {
        for (size_t h = at->first[i], end = h; h < at->first[i + 1]; h = end) {
            while (end < at->first[i + 1]
                   && at->halves[end].high == at->halves[h].high) {
                ++end;
            }
            visit(at, (uint32_t)i, &at->halves[h], end - h);
            for (size_t k = h; k < end; ++k) {
                const size_t soon
                    = at->halves[weft__soon(k, 16, at->first[vertices])].triangle;
                __builtin_prefetch(&at->piece[soon]);
                __builtin_prefetch(&corners[3 * soon]);
                __builtin_prefetch(&places[3 * soon]);
            }
        }
    }
}

/* A piece that is a mirror image is clockwise in (u, v) all over. */
static void check_sides(weft__work *at)
{
    for (size_t t = 0; !at->failed && t < at->def->triangles; ++t) {
        const uint32_t first = triangles_root(at->piece, (uint32_t)t);
        if (at->bad[t] == 0 && at->clockwise[t] != at->clockwise[first]) {
            weft__mesh_fault(
                at, WEFT__MESH_TRIANGLE, t,
                "the triangle of vertices %zu, %zu, %zu is turned over in the rest "
                "shape, against that of %zu, %zu, %zu of its piece",
                weft__name_of(at, weft__vertex_at(at->def, t, 0)),
                weft__name_of(at, weft__vertex_at(at->def, t, 1)),
                weft__name_of(at, weft__vertex_at(at->def, t, 2)),
                weft__name_of(at, weft__vertex_at(at->def, first, 0)),
                weft__name_of(at, weft__vertex_at(at->def, first, 1)),
                weft__name_of(at, weft__vertex_at(at->def, first, 2)));
        }
    }
}

/* ---- order ----------------------------------------------------------------------- */

/* Of the places of a cloth; it begins as that of all. */
typedef struct place_extent {
    double low[2], high[2];
} place_extent;

/* Of places; 0 of one that no triangle has. */
static void set_place_keys(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    place_extent of[WEFT_CLOTHS_MAX];
    memset(at->place_key, 0, def->uv_count * sizeof *at->place_key);
    for (size_t h = 0; h < 3 * def->triangles; ++h) {
        const uint32_t vertex = weft__vertex_at(def, 0, h);
        if (weft__rest_in_space(def, vertex) == NULL) {
            at->place_key[weft__place_at(def, 0, h)] = 1 + weft__part_at(def, vertex);
        }
    }
    for (size_t k = 0; k < WEFT_CLOTHS_MAX; ++k) {
        of[k] = (place_extent){ { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
    }
    for (size_t j = 0; j < 2 * def->uv_count; ++j) {
        if (at->place_key[j / 2] != 0) {
            place_extent *to = &of[at->place_key[j / 2] - 1];
            to->low[j % 2] = fmin(to->low[j % 2], def->rest[j]);
            to->high[j % 2] = fmax(to->high[j % 2], def->rest[j]);
        }
    }
    for (size_t i = 0; i < def->uv_count; ++i) {
        const double *x = &def->rest[2 * i];
        if (at->place_key[i] != 0) {
            const place_extent *in = &of[at->place_key[i] - 1];
            const double side
                = fmax(in->high[0] - in->low[0], in->high[1] - in->low[1]);
            at->place_key[i] = weft__curve_key(x, in->low, side);
        }
    }
}

/* The least of the places of each vertex. */
static void set_keys(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    set_place_keys(at);
    memset(at->key, 0xff, def->vertices * sizeof *at->key);
    for (size_t h = 0; h < 3 * def->triangles; ++h) {
        const uint32_t vertex = weft__vertex_at(def, 0, h);
        if (weft__rest_in_space(def, vertex) == NULL) {
            const uint64_t key = at->place_key[weft__place_at(def, 0, h)];
            uint64_t *kept = &at->key[vertex];
            *kept = key < *kept ? key : *kept;
        }
    }
    weft__space_keys(at);
}

/* Sorts order[count] by keys, byte after byte from the last one; equal keys keep their
 * order. */
static void sort_by_keys(const uint64_t *key, uint32_t **order, uint32_t **other,
                         size_t count)
{
    for (unsigned shift = 0; shift < 64; shift += 8) {
        size_t start[257] = { 0 };
        for (size_t i = 0; i < count; ++i) {
            ++start[(key[i] >> shift & 0xff) + 1];
        }
        for (size_t b = 0; b < 256; ++b) {
            start[b + 1] += start[b];
        }
        for (size_t i = 0; i < count; ++i) {
            (*other)[start[key[(*order)[i]] >> shift & 0xff]++] = (*order)[i];
        }
        uint32_t *kept = *order;
        *order = *other;
        *other = kept;
    }
}

/* The bits of a double so that larger ones are larger. */
static uint64_t ascending(double x)
{
    uint64_t bits;
    x += 0.0; /* -0 is 0 */
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 != 0 ? ~bits : bits | UINT64_C(1) << 63;
}

static bool tied(const weft__work *at)
{
    for (size_t i = 1; i < at->def->vertices; ++i) {
        if (at->key[at->order[i - 1]] == at->key[at->order[i]]) {
            return true;
        }
    }
    return false;
}

/* Pieces that lie on top of one another: ties by where particles start. */
static void break_ties(weft__work *at)
{
    const size_t n = at->def->vertices;
    for (size_t k = 3; k-- > 0;) {
        for (size_t i = 0; i < n; ++i) {
            at->key[i] = ascending(at->def->start[3 * i + k]);
        }
        sort_by_keys(at->key, &at->order, &at->other, n);
    }
    set_keys(at);
    sort_by_keys(at->key, &at->order, &at->other, n);
}

static void order_particles(weft__work *at)
{
    const size_t n = at->def->vertices;
    for (size_t i = 0; i < n; ++i) {
        at->order[i] = (uint32_t)i;
    }
    set_keys(at);
    sort_by_keys(at->key, &at->order, &at->other, n);
    if (at->def->triangles > 0 && tied(at)) { /* grids alone may have no start */
        break_ties(at);
    }
    for (size_t i = 0; at->def->part_count > 1 && i < n; ++i) {
        at->key[i] = weft__part_at(at->def, i);
    }
    if (at->def->part_count > 1) { /* one cloth after the other */
        sort_by_keys(at->key, &at->order, &at->other, n);
    }
    for (size_t i = 0; i < n; ++i) {
        const bool grid = weft__grid_with(at->def, i) != NULL;
        const uint32_t vertex = grid ? (uint32_t)i : at->order[i];
        at->out->vertex[i] = vertex;
        at->out->of_vertex[vertex] = (uint32_t)i;
        if (!grid) {
            memcpy(&at->out->start[3 * i], &at->def->start[3 * (size_t)vertex],
                   3 * sizeof *at->out->start);
        }
    }
}

/* Where a part that is a grid lies, and its areas. */
static void set_grid(weft__triangles *out, weft__part *part, const weft_cloth_def *grid,
                     size_t stride)
{
    weft__grid_init(&part->grid, grid);
    part->grid.stride = stride;
    part->mass = grid->mass, part->density = grid->density;
    for (size_t i = 0; i < part->count; ++i) {
        weft__grid_start(&part->grid, i, &out->start[3 * (part->first + i)]);
        out->lumped[part->first + i] = weft__grid_area(&part->grid, i);
    }
}

/* The corner of a triangle whose particle is the lowest. */
static size_t lowest_corner(const weft__work *at, size_t t)
{
    const uint32_t *of = at->out->of_vertex;
    const uint32_t a = of[weft__vertex_at(at->def, t, 0)],
                   b = of[weft__vertex_at(at->def, t, 1)],
                   c = of[weft__vertex_at(at->def, t, 2)];
    return a < b && a < c ? 0 : b < c ? 1 : 2;
}

/* order[T]: triangles by their corners, the lowest first. */
static void order_triangles(weft__work *at)
{
    const size_t count = at->def->triangles;
    for (size_t pass = 0; pass < 2; ++pass) { /* by the others, then by the lowest */
        for (size_t t = 0; t < count; ++t) {
            const size_t k = lowest_corner(at, t);
            const uint32_t *of = at->out->of_vertex;
            const uint64_t next = of[weft__vertex_at(at->def, t, (k + 1) % 3)];
            at->key[t] = pass == 0 ? next : of[weft__vertex_at(at->def, t, k)];
            at->order[t] = pass == 0 ? (uint32_t)t : at->order[t];
        }
        sort_by_keys(at->key, &at->order, &at->other, count);
    }
}

/* ---- tables ---------------------------------------------------------------------- */

/* A corner's place as defined, and its piece. */
typedef struct fan {
    uint32_t place, piece, number;
} fan;

/* A mirrored piece becomes counterclockwise by u -> -u. */
static void add_place(weft__work *at, uint32_t particle, uint32_t given,
                      uint32_t triangle)
{
    weft__triangles *out = at->out;
    const bool space = weft__rest_in_space(at->def, out->vertex[particle]) != NULL;
    const double *x = (space ? at->view : at->def->rest) + 2 * (size_t)given;
    const bool mirrored = at->clockwise[triangle];
    out->particle[out->places] = particle;
    out->mirrored[out->places] = mirrored;
    out->rest[out->places][0] = mirrored ? -x[0] : x[0];
    out->rest[out->places++][1] = x[1];
}

/* Places by particles, then as they appear: a particle has one in each piece and place
 * of the definition. Fans of a particle are few. */
static void set_places(weft__work *at, uint32_t *next, fan *fans)
{
    weft__triangles *out = at->out;
    for (size_t t = 0; t < out->count; ++t) {
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t particle = out->corner[t][k], given = out->place[t][k];
            fan *of = fans + at->first[particle];
            size_t i = 0;
            while (i < next[particle]
                   && (of[i].place != given || of[i].piece != out->piece[t])) {
                ++i;
            }
            if (i == next[particle]) {
                of[next[particle]++]
                    = (fan){ given, out->piece[t], (uint32_t)out->places };
                add_place(at, particle, given, at->order[t]);
            }
            out->place[t][k] = of[i].number;
        }
    }
}

static void list_places(weft__work *at)
{
    const size_t n = at->def->vertices, corners = 3 * at->out->count;
    uint32_t *next = weft__work_take(at, n, sizeof *next);
    fan *fans = weft__work_take(at, corners, sizeof *fans);
    if (!at->failed) {
        memset(at->first, 0, (n + 1) * sizeof *at->first);
        for (size_t c = 0; c < corners; ++c) {
            ++at->first[at->out->corner[c / 3][c % 3] + 1];
        }
        for (size_t i = 0; i < n; ++i) {
            at->first[i + 1] += at->first[i];
        }
        set_places(at, next, fans);
    }
    weft__free(at->memory, next);
    weft__free(at->memory, fans);
}

/* Triangles in their order, with pieces numbered as they appear. */
static void list_triangles(weft__work *at)
{
    weft__triangles *out = at->out;
    uint32_t *number = at->other; /* of a root */
    memset(number, 0xff, out->count * sizeof *number);
    for (size_t t = 0; t < out->count; ++t) {
        const uint32_t from = at->order[t], first = triangles_root(at->piece, from);
        const size_t low = lowest_corner(at, from);
        for (size_t k = 0; k < 3; ++k) {
            const size_t c = (low + k) % 3;
            out->corner[t][k] = out->of_vertex[weft__vertex_at(at->def, from, c)];
            out->place[t][k] = weft__place_at(at->def, from, c);
        }
        if (number[first] == WEFT__NONE) {
            number[first] = (uint32_t)out->pieces++;
        }
        out->piece[t] = number[first];
        out->fabric[t] = at->def->fabric_of != NULL ? at->def->fabric_of[from] : 0;
    }
}

static void set_areas(weft__work *at)
{
    weft__triangles *out = at->out;
    for (size_t t = 0; t < out->count; ++t) {
        double longest;
        out->area[t] = 0.5 * fabs(weft__twice_area(at->def, at->order[t], &longest));
        for (size_t k = 0; k < 3; ++k) {
            out->lumped[out->corner[t][k]] += out->area[t] / 3.0;
        }
    }
}

static uint32_t triangles_place_of(const weft__triangles *of, uint32_t t,
                                   uint32_t particle)
{
    const uint32_t *corner = of->corner[t];
    return of->place[t][corner[0] == particle ? 0 : corner[1] == particle ? 1 : 2];
}

static void triangles_add_edge(weft__work *at, uint32_t low,
                               const weft__half_edge *from, size_t count)
{
    weft__triangles *out = at->out;
    const bool joined = count == 2
                        && triangles_place_of(out, from[0].triangle, low)
                               == triangles_place_of(out, from[1].triangle, low)
                        && triangles_place_of(out, from[0].triangle, from->high)
                               == triangles_place_of(out, from[1].triangle, from->high);
    const size_t sides = joined ? 1 : count;
    for (size_t i = 0; i < sides; ++i) {
        const uint32_t edge = (uint32_t)out->edges++, t = from[i].triangle;
        out->edge_list[edge]
            = (weft__edge){ .place = { triangles_place_of(out, t, low),
                                       triangles_place_of(out, t, from->high) },
                            .triangle = { t, joined ? from[1].triangle : WEFT__NONE },
                            .sewn = sides == 1 ? WEFT__NONE
                                    : i == 0   ? edge + 1
                                               : edge - 1 };
        out->edge[t][from[i].corner] = edge;
        if (joined) {
            out->edge[from[1].triangle][from[1].corner] = edge;
        }
    }
}

/* And names. */
static void copy_fabrics(weft__work *at)
{
    weft__triangles *out = at->out;
    for (size_t i = 0; i < out->fabric_count; ++i) {
        weft_fabric *to = &out->fabrics[i];
        *to = at->def->fabrics[i];
        to->twist = to->twist < 0.0 ? sqrt(to->bend[0] * to->bend[1]) : to->twist;
        to->name = NULL;
        out->more[i] = (weft__fabric_more){ 0.0, to->stretch[0] + to->stretch[1] };
    }
    for (size_t i = 0; out->name != NULL && i < at->def->vertices; ++i) {
        out->name[i] = at->def->file_index[i];
    }
    for (size_t i = 0; i < out->part_count; ++i) {
        const weft_cloth_part *from = &at->def->parts[i];
        weft__part *to = &out->parts[i];
        strcpy(to->name, from->name);
        to->first = from->first;
        to->count = from->count;
        memcpy(to->velocity, from->velocity, sizeof to->velocity);
        if (at->def->grids != NULL && at->def->grids[i] != NULL) {
            set_grid(out, to, at->def->grids[i], at->def->vertices);
        }
    }
}

/* The arrays of T triangles between n particles, with names if there are some. */
#define ARRAYS(X)                                                                      \
    X(corner, t)                                                                       \
    X(place, t)                                                                        \
    X(edge, t)                                                                         \
    X(piece, t)                                                                        \
    X(fabric, t)                                                                       \
    X(area, t)                                                                         \
    X(rest, 3 * t)                                                                     \
    X(mirrored, 3 * t)                                                                 \
    X(particle, 3 * t)                                                                 \
    X(edge_list, 3 * t)                                                                \
    X(around, 3 * t)                                                                   \
    X(around_first, n + 1)                                                             \
    X(start, 3 * n)                                                                    \
    X(lumped, n)                                                                       \
    X(vertex, n)                                                                       \
    X(of_vertex, n)                                                                    \
    X(fabrics, of->fabric_room)                                                        \
    X(more, of->fabric_room) X(parts, of->part_count + 1)

static void triangles_allocate(weft__work *at)
{
    const size_t n = at->def->vertices, t = at->def->triangles;
    const size_t most = n > t ? n : t;
    weft__triangles *of = at->out = weft__work_take(at, 1, sizeof *of);
    if (of == NULL) {
        return;
    }
    at->key = weft__work_take(at, most, sizeof *at->key);
    at->place_key = weft__work_take(at, at->def->uv_count, sizeof *at->place_key);
    at->order = weft__work_take(at, most, sizeof *at->order);
    at->other = weft__work_take(at, most, sizeof *at->other);
    of->count = of->all = t;
    of->fabric_count = at->def->fabric_count;
    of->fabric_room = of->fabric_count + weft__space_fabrics(at->def);
    of->part_count = at->def->part_count;
    of->seams = at->def->seams;
    of->arc = at->def->arc;
#define TAKE(array, number) of->array = weft__work_take(at, number, sizeof *of->array);
    ARRAYS(TAKE)
    of->name
        = at->def->file_index != NULL ? weft__work_take(at, n, sizeof *of->name) : NULL;
    if (weft__any_starts_bent(at->def)) {
        of->angled = weft__work_take(at, t, sizeof *of->angled);
    }
    if (weft__any_in_space(at->def)) {
        at->view = weft__work_take(at, 2 * n, sizeof *at->view);
        of->space = weft__work_take(at, 3 * n, sizeof *of->space);
        of->in_space = weft__work_take(at, t, sizeof *of->in_space);
        of->frame = weft__work_take(at, t, sizeof *of->frame);
    }
}

/* Faults of what good triangles are joined to, with which the rest cannot be made. */
static void find_pieces(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    const bool failed = at->failed;
    at->halves = weft__work_take(at, 3 * def->triangles, sizeof *at->halves);
    at->first = weft__work_take(at, def->vertices + 1, sizeof *at->first);
    at->piece = weft__work_take(at, def->triangles, sizeof *at->piece);
    if (at->no_memory) {
        return;
    }
    for (size_t t = 0; t < def->triangles; ++t) {
        at->piece[t] = (uint32_t)t;
    }
    list_halves(at, def->corners, def->vertices, def->triangles);
    at->failed = false;
    each_edge(at, def->vertices, triangles_join);
    check_sides(at);
    at->failed = at->failed || failed;
}

static void triangles_fill(weft__work *at)
{
    order_particles(at);
    order_triangles(at);
    list_triangles(at);
    weft__around_fill(at->out, at->def->vertices);
    list_places(at);
    if (!at->failed) {
        set_areas(at);
        copy_fabrics(at);
        weft__space_fill(at);
        list_halves(at, &at->out->corner[0][0], at->def->vertices, at->out->count);
        each_edge(at, at->def->vertices, triangles_add_edge);
    }
}

bool weft__triangles_create(weft__triangles **out, const weft_mesh_def *def,
                            const weft_allocator *memory, const weft__mesh_faults *to,
                            bool *no_memory)
{
    weft__work at = { .def = def, .memory = memory, .to = to };
    weft__triangles_check(&at);
    if (at.bad != NULL) {
        find_pieces(&at);
    }
    if (out != NULL && !at.failed) {
        triangles_allocate(&at);
    }
    if (out != NULL && !at.failed) {
        triangles_fill(&at);
    }
    WEFT__FREE_ALL(memory, at.bad, at.clockwise, at.one_sided, at.halves, at.first,
                   at.piece, at.key, at.place_key, at.order, at.other, at.view);
    *no_memory = at.no_memory;
    if (at.failed) {
        weft__triangles_destroy(at.out, memory);
        at.out = NULL;
    }
    if (out != NULL) {
        *out = at.out;
    }
    return !at.failed;
}

size_t weft__triangles_bytes(const weft__triangles *of, size_t n)
{
    const size_t t = of->count;
#define BYTES(array, number) +(number) * sizeof *of->array
    const size_t frames = of->frame != NULL ? t : 0;
    return sizeof *of + (of->name != NULL ? n * sizeof *of->name : 0)
           + (frames > 0 ? 3 * n * sizeof *of->space : 0)
           + frames * (sizeof *of->frame + sizeof *of->in_space) ARRAYS(BYTES);
}

void weft__triangles_destroy(weft__triangles *of, const weft_allocator *memory)
{
    if (of != NULL) {
#define FREE(array, number) weft__free(memory, of->array);
        ARRAYS(FREE)
        WEFT__FREE_ALL(memory, of->name, of->space, of->in_space, of->angled, of->frame,
                       of);
    }
}

void weft__triangles_masses(const weft__triangles *of, const weft_cloth_def *def,
                            double *mass)
{
    memset(mass, 0, def->mesh->vertices * sizeof *mass);
    for (size_t t = 0; t < of->count; ++t) {
        const double share = of->fabrics[of->fabric[t]].density * of->area[t] / 3.0;
        for (size_t k = 0; k < 3; ++k) {
            mass[of->corner[t][k]] += share;
        }
    }
    for (size_t i = 0; i < def->mesh->vertices; ++i) {
        const weft__part *part
            = def->mesh->grids != NULL ? &of->parts[weft__part_of(of, i)] : NULL;
        if (part != NULL && part->grid.rows > 0) {
            mass[i] = part->density > 0.0 ? part->density * of->lumped[i] : part->mass;
        }
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        for (size_t k = 0; k < load->vertex_count; ++k) {
            mass[of->of_vertex[load->vertices[k]]] += load->mass;
        }
    }
}
