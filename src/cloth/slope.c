/* SPDX-License-Identifier: BSD-3-Clause */
#include "cloth/slope.h"

#include <string.h>

#include "base/finite.h"
#include "base/hash.h"
#include "base/memory.h"

/* ---- what differs ---------------------------------------------------------------- */

static bool same_place(const weft__mesh *a, const weft__mesh *b)
{
    return a->particles == b->particles && a->block == b->block
           && a->motion_count == b->motion_count
           && (a->triangles == NULL) == (b->triangles == NULL)
           && memcmp(a->pin, b->pin, a->particles * sizeof *a->pin) == 0;
}

static bool same_weight(const weft__mesh *a, const weft__mesh *b)
{
    return memcmp(a->mass, b->mass, a->particles * sizeof *a->mass) == 0
           && memcmp(a->spacing, b->spacing, sizeof a->spacing) == 0;
}

static bool same_motions(const weft__mesh *a, const weft__mesh *b)
{
    bool same = true;
    for (size_t i = 0; i < a->motion_count; ++i) {
        same = same
               && weft__motion_hash(&a->motions[i], WEFT__HASH_START)
                      == weft__motion_hash(&b->motions[i], WEFT__HASH_START);
    }
    return same;
}

/* The springs and the weight whose force is the derivative. */
static void find_differences(weft__slope *of)
{
    const weft__springs *less = &of->less->springs, *more = &of->more->springs;
    of->springs = *more;
    of->linear = less->group_count == more->group_count;
    for (size_t g = 0; of->linear && g < more->group_count; ++g) {
        const weft__group *a = &less->groups[g], *b = &more->groups[g];
        of->linear = a->way == b->way && a->rest_length == b->rest_length;
        of->springs.groups[g].stiffness = (b->stiffness - a->stiffness) / of->span;
        of->springs.groups[g].damping = (b->damping - a->damping) / of->span;
    }
    of->body = of->more->body;
    of->body.drag = (of->more->body.drag - of->less->body.drag) / of->span;
    for (size_t k = 0; k < 3; ++k) {
        of->body.gravity[k]
            = (of->more->body.gravity[k] - of->less->body.gravity[k]) / of->span;
    }
}

static uint64_t hash_of(const weft_cloth *cloth, size_t k)
{
    return weft__table[k].force->hash != NULL
               ? weft__table[k].force->hash(weft__own(cloth, k), WEFT__HASH_START)
               : 0;
}

weft_status weft__slope_init(weft__slope *of, const weft_cloth *cloth,
                             const weft_cloth *less, const weft_cloth *more,
                             double span, weft_error *err)
{
    *of = (weft__slope){ .less = less, .more = more, .span = span };
    if (less == NULL || more == NULL || !weft__positive(span)
        || !same_place(&cloth->mesh, &less->mesh)
        || !same_place(&cloth->mesh, &more->mesh)
        || cloth->contact.shape_count != less->contact.shape_count
        || cloth->contact.shape_count != more->contact.shape_count) {
        return weft_error_set(err, WEFT_INVALID,
                              "two cloths with less and more of a number must have the "
                              "particles, pins and shapes of the cloth itself, and a "
                              "span > 0");
    }
    of->all = !same_weight(&less->mesh, &more->mesh);
    of->pins = !same_motions(&less->mesh, &more->mesh);
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        of->differs[k] = of->all || hash_of(less, k) != hash_of(more, k);
    }
    of->differs[WEFT__FORCE_self] = of->differs[WEFT__FORCE_contact];
    of->differs[WEFT__FORCE_bodies] = of->differs[WEFT__FORCE_contact];
    find_differences(of);
    return WEFT_OK;
}

bool weft__slope_whole(const weft__slope *of)
{
    return of->differs[WEFT__FORCE_contact]
           && (of->more->self.law.self || of->more->bodies.pairs.law.self);
}

/* ---- the derivative -------------------------------------------------------------- */

/* dy/dt of blocks [first, end) by the forces that differ. */
static int evaluate(const weft__slope *of, const weft_cloth *cloth,
                    const weft__state *at, bool start, double *out, size_t first,
                    size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles, low = weft__block(mesh, first);
    const size_t high = weft__block(mesh, end);
    int failed = 0;
    if (start) {
        failed = weft__table[0].force->start(weft__own(cloth, 0), &cloth->body, at,
                                             WEFT__ACCELERATION, out, first, end);
    }
    for (size_t k = 3; !start && k < 6; ++k) {
        memset(out + k * n + low, 0, (high - low) * sizeof *out);
    }
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        if (force != NULL && force->add != NULL && of->differs[k]) {
            failed |= force->add(weft__own(cloth, k), at, WEFT__ACCELERATION,
                                 out + 3 * n, first, end);
        }
    }
    return failed;
}

/* out += factor (more - less), of the accelerations of particles [low, high). */
static void add_difference(size_t n, double factor, const double *less,
                           const double *more, double *out, size_t low, size_t high)
{
    for (size_t k = 3 * n; k < 6 * n; k += n) {
        for (size_t i = k + low; i < k + high; ++i) {
            out[i] += factor * (less == NULL ? more[i] : more[i] - less[i]);
        }
    }
}

/* The same of weight and air alone. */
static void add_body(const weft__slope *of, const weft__state *at, double scale,
                     double *out, size_t low, size_t high)
{
    const weft__mesh *mesh = &of->more->mesh;
    const size_t n = mesh->particles;
    for (size_t k = 0; k < 3; ++k) {
        const double *v = at->y + (3 + k) * n;
        for (size_t i = low; i < high; ++i) {
            out[(3 + k) * n + i] += scale
                                    * (of->body.gravity[k]
                                       - of->body.drag * mesh->inverse_mass[i] * v[i]);
        }
    }
}

static void move_pins(const weft__slope *of, double t, double scale, double *out,
                      size_t first, size_t end)
{
    const weft__mesh *mesh = &of->more->mesh;
    for (size_t j = 0; j < mesh->pinned; ++j) {
        const size_t i = mesh->pins[j];
        double less[6] = { 0.0 }, more[6] = { 0.0 };
        if (i < first || i >= end) {
            continue;
        }
        if (of->pins) {
            weft__pin_rate(&of->less->mesh, i, t, less);
            weft__pin_rate(mesh, i, t, more);
        }
        for (size_t k = 0; k < 6; ++k) {
            out[k * mesh->particles + i] = scale / of->span * (more[k] - less[k]);
        }
    }
}

int weft__slope_blocks(const weft__slope *of, const weft__state *at, double scale,
                       double *out, double *const room[2], size_t first, size_t end)
{
    const weft__mesh *mesh = &of->more->mesh;
    const size_t n = mesh->particles, low = weft__block(mesh, first);
    const size_t high = weft__block(mesh, end);
    const bool springs = of->differs[0];
    const bool starts = springs || of->differs[WEFT__FORCE_body];
    const bool linear = of->linear && !of->all;
    bool others = false;
    int failed = 0;
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        others = others || (of->differs[k] && k != WEFT__FORCE_body);
    }
    if (starts && linear && !springs) {
        add_body(of, at, scale, out, low, high);
    } else if (starts && linear) {
        failed |= weft__table[0].force->start(&of->springs, &of->body, at,
                                              WEFT__ACCELERATION, room[0], first, end);
        add_difference(n, scale, NULL, room[0], out, low, high);
    }
    if (others || (starts && !linear)) {
        failed |= evaluate(of, of->less, at, starts && !linear, room[0], first, end);
        failed |= evaluate(of, of->more, at, starts && !linear, room[1], first, end);
        add_difference(n, scale / of->span, room[0], room[1], out, low, high);
    }
    move_pins(of, at->t, scale, out, low, high);
    return failed;
}

int weft__slope_all(const weft__slope *of, const weft__state *at, double scale,
                    double *out, double *const room[2])
{
    const size_t n = of->more->mesh.particles;
    int failed = 0;
    for (size_t side = 0; side < 2; ++side) {
        memset(room[side] + 3 * n, 0, 3 * n * sizeof *room[side]);
        failed |= weft__rhs_all(side == 0 ? of->less : of->more, NULL, at,
                                WEFT__ACCELERATION, room[side] + 3 * n);
    }
    add_difference(n, scale / of->span, room[0], room[1], out, 0, n);
    return failed;
}

int weft_cloth_parameter_product(const weft_cloth *less, const weft_cloth *more,
                                 double span, double t, const double *y, double *out)
{
    const weft__state at = { .t = t, .y = y };
    const size_t dim = weft_cloth_dim(more);
    weft__slope slope;
    double *room = weft__alloc(&more->memory, dim, 2 * sizeof *room);
    int failed = -1;
    if (room != NULL
        && weft__slope_init(&slope, more, less, more, span, NULL) == WEFT_OK) {
        double *const rooms[2] = { room, room + dim };
        memset(out, 0, dim * sizeof *out);
        failed = weft__slope_blocks(&slope, &at, 1.0, out, rooms, 0,
                                    weft__blocks(&more->mesh));
        if (weft__slope_whole(&slope)) {
            failed |= weft__slope_all(&slope, &at, 1.0, out, rooms);
        }
    }
    weft__free(&more->memory, room);
    return failed;
}
