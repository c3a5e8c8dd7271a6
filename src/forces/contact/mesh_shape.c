/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/mesh_shape.h"

#include <stdlib.h>
#include <string.h>

#include "base/finite.h"
#include "base/grow.h"
#include "base/hash.h"
#include "base/sized.h"

/* The least height of a triangle, by its longest edge. */
#define LEAST_HEIGHT 1e-6

/* ---- numbers --------------------------------------------------------------------- */

const char *weft__body_flaw(const double *places, const uint32_t *corner, bool *flat)
{
    const double *x[3]
        = { places + 3 * corner[0], places + 3 * corner[1], places + 3 * corner[2] };
    double e[3][3], cross[3], longest = 0.0;
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            e[i][k] = x[(i + 1) % 3][k] - x[i][k];
        }
        longest = fmax(longest, weft__dot(e[i], e[i]));
    }
    weft__cross(e[0], e[1], cross);
    const double area = weft__length(cross);
    const bool finite = isfinite(area) && isfinite(longest);
    *flat = finite && !(area > LEAST_HEIGHT * longest);
    return *flat    ? "a triangle of its body has no area"
           : finite ? NULL
                    : "a triangle of its body is too large for a double";
}

const char *weft__body_fault(const weft_body *of, size_t *triangle)
{
    if (of == NULL || of->positions == NULL || of->corners == NULL || of->vertices < 3
        || of->triangles < 1 || of->keys < 1) {
        return "a mesh needs a body of triangles";
    }
    if (of->vertices > UINT32_MAX / 2 || of->triangles > UINT32_MAX / 2
        || of->keys > SIZE_MAX / 64 / of->vertices) {
        return "its body is too large";
    }
    if (!weft__all_finite(of->positions, 3 * of->vertices * of->keys)) {
        return "its body has a place that is not finite";
    }
    if (of->keys > 1 && !(of->fps > 0.0 && weft__positive(1.0 / of->fps / of->fps))) {
        return "its body has several keys, but fps is not finite and > 0";
    }
    for (size_t t = 0; t < of->triangles; ++t) {
        const uint32_t *c = of->corners + 3 * t;
        *triangle = t;
        if (c[0] >= of->vertices || c[1] >= of->vertices || c[2] >= of->vertices) {
            return "a triangle of its body has a vertex that is not there";
        }
        for (size_t k = 0; k < of->keys; ++k) {
            bool flat;
            const char *fault
                = weft__body_flaw(of->positions + 3 * of->vertices * k, c, &flat);
            if (fault != NULL) {
                return fault;
            }
        }
    }
    return NULL;
}

/* A vertex and the number that bits of its three coordinates make in turn. */
typedef struct coded {
    uint64_t code;
    uint32_t vertex;
} coded;

static int by_code(const void *a, const void *b)
{
    const coded *x = a, *y = b;
    return x->code != y->code ? (x->code > y->code) - (x->code < y->code)
                              : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* Vertices that are near each other get numbers that are: G. M. Morton's order. */
static void sort_vertices(const weft_body *of, coded *list)
{
    enum { BITS = 20 };
    double low[3], widest = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        double high = low[k] = of->positions[k];
        for (size_t i = 1; i < of->vertices; ++i) {
            low[k] = fmin(low[k], of->positions[3 * i + k]);
            high = fmax(high, of->positions[3 * i + k]);
        }
        widest = fmax(widest, high - low[k]);
    }
    for (size_t i = 0; i < of->vertices; ++i) {
        list[i] = (coded){ 0, (uint32_t)i };
        for (size_t k = 0; k < 3; ++k) {
            const double part = (of->positions[3 * i + k] - low[k]) / widest;
            const uint64_t at = (uint64_t)(part * ((1 << BITS) - 1));
            for (size_t b = 0; b < BITS; ++b) {
                list[i].code |= (at >> b & 1) << (3 * b + k);
            }
        }
    }
    qsort(list, of->vertices, sizeof *list, by_code);
}

static void renumber(weft_body *of, const weft_body *from, const coded *list,
                     uint32_t *number)
{
    double *places = weft__unconst(of->positions);
    uint32_t *corners = weft__unconst(of->corners);
    for (size_t i = 0; i < of->vertices; ++i) {
        number[list[i].vertex] = (uint32_t)i;
    }
    for (size_t i = 0; i < of->keys * of->vertices; ++i) {
        const size_t key = i / of->vertices * of->vertices;
        memcpy(places + 3 * i, from->positions + 3 * (key + list[i - key].vertex),
               3 * sizeof *places);
    }
    for (size_t i = 0; i < 3 * of->triangles; ++i) {
        corners[i] = number[from->corners[i]];
    }
}

/* Both arrays follow the struct. */
static weft_body *mesh_shape_copy(const weft_body *from, const weft_allocator *memory)
{
    const size_t places = 3 * from->vertices * from->keys * sizeof *from->positions;
    const size_t corners = 3 * from->triangles * sizeof *from->corners;
    weft_body *to = weft__alloc(memory, sizeof *to + places + corners, 1);
    coded *list = weft__alloc(memory, from->vertices, sizeof *list);
    uint32_t *number = weft__alloc(memory, from->vertices, sizeof *number);
    if (to != NULL && list != NULL && number != NULL) {
        *to = *from;
        to->positions = (double *)(void *)(to + 1);
        to->corners = (uint32_t *)(void *)((char *)(to + 1) + places);
        sort_vertices(from, list);
        renumber(to, from, list, number);
    } else {
        weft__free(memory, to);
        to = NULL;
    }
    WEFT__FREE_ALL(memory, list, number);
    return to;
}

bool weft__shapes_copy(weft__shape *shapes, size_t count, const weft_allocator *memory)
{
    bool has = true;
    for (size_t k = 0; k < count; ++k) {
        const bool body = shapes[k].def.kind == WEFT_MESH;
        shapes[k].def.body
            = body && has ? mesh_shape_copy(shapes[k].def.body, memory) : NULL;
        has = has && (!body || shapes[k].def.body != NULL);
    }
    return has;
}

void weft__shapes_free(weft__shape *shapes, size_t count, const weft_allocator *memory)
{
    for (size_t k = 0; shapes != NULL && k < count; ++k) {
        weft__free(memory, weft__unconst(shapes[k].def.body));
    }
}

uint64_t weft__body_hash(const weft_body *of, uint64_t hash)
{
    hash = weft__hash_reals(hash, of->positions, 3 * of->vertices * of->keys);
    for (size_t i = 0; i < 3 * of->triangles; ++i) {
        hash = weft__hash_word(hash, of->corners[i]);
    }
    return weft__hash_real(hash, of->keys > 1 ? of->fps : 0.0);
}

size_t weft__shapes_vertices(const weft__contact *of)
{
    size_t count = 0;
    for (size_t k = 0; k < of->shape_count; ++k) {
        count += of->shapes[k].def.kind == WEFT_MESH ? of->shapes[k].def.body->vertices
                                                     : 0;
    }
    return count;
}

/* ---- motion ---------------------------------------------------------------------- */

/* A natural cubic spline is linear in its keys: the shares that keys first, first + 1,
 * ... have at a time in places and in velocities [1/s]. Those further away than
 * KEYS_BESIDE, whose shares are below 1e-9, are left out. */
enum { KEYS_BESIDE = 16, KEYS_MOST = 2 * KEYS_BESIDE };

typedef struct keys {
    size_t first, count;
    double share[KEYS_MOST], rate[KEYS_MOST];
} keys;

static double key_time(const weft_body *of, size_t i)
{
    return (double)i / of->fps;
}

size_t weft__body_keys_until(const weft_body *of, double piece)
{
    const double last = (double)(of->keys - 1);
    size_t i = (size_t)fmin(fmax(piece * of->fps, 0.0), last);
    while (i > 0 && !weft__row_met(key_time(of, i), piece)) {
        --i;
    }
    while (i < of->keys && weft__row_met(key_time(of, i), piece)) {
        ++i;
    }
    return i;
}

/* Adds to shares a X_i + b X_(i+1), and what c X''_i + d X''_(i+1), times h^2 / 6, are
 * of all keys: X''_(j-1) + 4 X''_j + X''_(j+1) = 6 / h^2 times the second
 * difference at j, 0 at both ends. The matrix is symmetric, so that the solution for c
 * and d has the share of each second difference. */
static void add_shares(size_t i, size_t count, const double of[4], double *share)
{
    double pivot[KEYS_MOST] = { 0.0 }, part[KEYS_MOST] = { 0.0 };
    share[i] += of[0], share[i + 1] += of[1];
    for (size_t j = 1; j + 1 < count; ++j) {
        const double wanted = j == i ? of[2] : j == i + 1 ? of[3] : 0.0;
        pivot[j] = 1.0 / (4.0 - pivot[j - 1]);
        part[j] = pivot[j] * (wanted - part[j - 1]);
    }
    for (size_t j = count - 2; j > 0; --j) {
        part[j] -= pivot[j] * part[j + 1];
        share[j - 1] += part[j], share[j] -= 2.0 * part[j], share[j + 1] += part[j];
    }
}

static keys keys_at(const weft_body *of, double t, double piece)
{
    const size_t until = of->keys > 1 ? weft__body_keys_until(of, piece) : 0;
    if (until == 0 || until == of->keys) {
        return (
            keys){ .first = until > 0 ? until - 1 : 0, .count = 1, .share = { 1.0 } };
    }
    const size_t i = until - 1;
    keys out = { .first = until > KEYS_BESIDE ? until - KEYS_BESIDE : 0 };
    const size_t end = until + KEYS_BESIDE < of->keys ? until + KEYS_BESIDE : of->keys;
    out.count = end - out.first;
    const double s = (t - key_time(of, i)) * of->fps, r = 1.0 - s;
    const double place[4] = { r, s, r * (r * r - 1.0), s * (s * s - 1.0) };
    const double rate[4] = { -of->fps, of->fps, of->fps * (1.0 - 3.0 * r * r),
                             of->fps * (3.0 * s * s - 1.0) };
    add_shares(i - out.first, out.count, place, out.share);
    add_shares(i - out.first, out.count, rate, out.rate);
    return out;
}

bool weft__body_moves(const weft__shape *shape, double t)
{
    const weft_body *body = shape->def.body;
    return shape->motion.motion.moves || shape->motion.turns
           || (body != NULL && body->keys > 1 && t < key_time(body, body->keys - 1));
}

/* Three numbers of all keys: [m] from `at`, or [m/s]. */
static void blend(const weft_body *of, const keys *at, const double *share, size_t i,
                  double out[3])
{
    const double *key = of->positions + 3 * (of->vertices * at->first + i);
    for (size_t k = 0; k < 3; ++k) {
        out[k] = share[0] * key[k];
    }
    for (size_t j = 1; j < at->count; ++j) {
        key += 3 * of->vertices;
        for (size_t k = 0; k < 3; ++k) {
            out[k] += share[j] * key[k];
        }
    }
}

void weft__body_place(const weft__shape *shape, double t, double piece, size_t planes,
                      size_t plane, size_t next, double *to)
{
    const weft_body *body = shape->def.body;
    const weft__pose pose = weft__pose_of(shape, t);
    const keys at = keys_at(body, t, piece);
    for (size_t i = 0; i < body->vertices; ++i, to += next) {
        double local[2][3], r[3], v[3], turned[3];
        blend(body, &at, at.share, i, local[0]);
        blend(body, &at, at.rate, i, local[1]);
        weft__rotate(&pose.frame, local[0], r);
        weft__rotate(&pose.frame, local[1], v);
        weft__cross(pose.rigid.omega, r, turned);
        for (size_t k = 0; k < planes; ++k) {
            to[k * plane] = k < 3 ? pose.at[k] + r[k]
                                  : pose.velocity[k - 3] + (v[k - 3] + turned[k - 3]);
        }
    }
}

void weft_shape_vertices_sized(const weft_shape *shape, size_t size, double t,
                               double *xyz)
{
    weft_shape def = weft_shape_default(WEFT_MESH);
    (void)weft__sized_read(&def, sizeof def, shape, size);
    const weft__shape made = weft__shape_of(&def, 0.0);
    if (made.def.body != NULL) {
        weft__body_place(&made, t, t, 3, 1, 3, xyz);
    }
}

void weft__shapes_bounds(const weft__contact *of, double t, weft__piece_bounds *to)
{
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft_body *body = of->shapes[k].def.body;
        if (body != NULL && body->keys > 1) {
            const size_t i = weft__body_keys_until(body, t);
            to->first = fmax(to->first, i > 0 ? key_time(body, i - 1) : -DBL_MAX);
            to->last = fmin(to->last, i < body->keys ? key_time(body, i) : DBL_MAX);
        }
    }
}
