/* SPDX-License-Identifier: BSD-3-Clause */
#include "cloth/parameter_derivative.h"

#include <string.h>

#include "base/finite.h"
#include "base/hash.h"
#include "base/memory.h"

/* ---- by the state ---------------------------------------------------------------- */

/* J dy, J = [0 I; -M^-1 K -M^-1 C]. */
int weft_cloth_jacobian_product(const weft_cloth *cloth, double t, const double *y,
                                const double *dy, double *out)
{
    const weft__state at = { .t = t, .y = y, .along = dy };
    const weft__mesh *mesh = &cloth->mesh;
    const int failed = weft__rhs_blocks(cloth, &at, out, 0, weft__blocks(mesh))
                       | weft__rhs_all(cloth, NULL, &at, WEFT__ACCELERATION,
                                       out + 3 * mesh->particles);
    for (size_t j = 0; j < mesh->pinned; ++j) {
        for (size_t k = 0; k < 6; ++k) {
            out[k * mesh->particles + mesh->pins[j]] = 0.0;
        }
    }
    return failed;
}

/* Adds that of a linear force, by x and by v apart; l and twice as much behind it. */
static void add_linear(const weft__force *force, const void *own, size_t n, double *l,
                       double *out, size_t end)
{
    const weft__state by_x = { .y = l }, by_v = { .y = l + 3 * n };
    memset(l + 3 * n, 0, 3 * n * sizeof *l); /* l, 0, l */
    memcpy(l + 6 * n, l, 3 * n * sizeof *l);
    (void)force->law.add(own, &by_x, WEFT__FORCE, out, 0, end);
    (void)force->law.add(own, &by_v, WEFT__FORCE, out + 3 * n, 0, end);
}

int weft__rhs_transposed(const weft_cloth *cloth, void *const *spaces,
                         const weft__state *in, const double *w, double *room,
                         double *out, double *net, weft__parameter_gradient *by)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    weft__state at = *in;
    bool others = false;
    at.along = room;
    if (cloth->grid_count > 0) {
        return -1;
    }
    for (size_t k = 0; k < 3 * n; k += n) {
        for (size_t i = 0; i < n; ++i) {
            room[k + i] = mesh->inverse_mass[i] * w[3 * n + k + i];
        }
    }
    int failed = cloth->springs.transposed(&cloth->springs, &cloth->body, &at, w, out,
                                           net, by);
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        const void *own = weft__own(cloth, k);
        if (force != NULL && force->law.linear) {
            add_linear(force, own, n, room, out, weft__blocks(mesh));
        } else if (force != NULL && force->law.transposed != NULL) {
            force->law.transposed(own, &at, out);
        }
        others = others
                 || (force != NULL
                     && (force->law.linear || force->law.transposed
                         || force->whole.transposed));
    }
    WEFT__FROM_EACH_FORCE(failed |=, cloth, whole.transposed,
                          spaces != NULL ? spaces[k_] : NULL, &at, out)
    return failed | (others && !weft__all_finite(out, 6 * n));
}

int weft_cloth_jacobian_product_transposed(const weft_cloth *cloth, double t,
                                           const double *y, const double *w,
                                           double *out)
{
    weft__parameter_gradient by;
    const weft__state at = { .t = t, .y = y };
    double *room = weft__alloc(&cloth->memory, 9 * cloth->mesh.particles, sizeof *room);
    const int failed = room == NULL ? -1
                                    : weft__rhs_transposed(cloth, NULL, &at, w, room,
                                                           out, NULL, &by);
    weft__free(&cloth->memory, room);
    return failed;
}

/* ---- what differs ---------------------------------------------------------------- */

static bool parameter_same_place(const weft_cloth *one, const weft_cloth *other)
{
    const weft__mesh *a = &one->mesh, *b = &other->mesh;
    bool same = a->particles == b->particles && a->block == b->block
                && a->motion_count == b->motion_count
                && (a->triangles == NULL) == (b->triangles == NULL)
                && memcmp(a->pin, b->pin, a->particles * sizeof *a->pin) == 0
                && one->springs.group_count == other->springs.group_count;
    for (size_t g = 0; same && g < one->springs.group_count; ++g) {
        same = one->springs.groups[g].orientation
               == other->springs.groups[g].orientation;
    }
    for (size_t k = 0; same && k < WEFT__FORCES; ++k) {
        const weft__force_tables *of = &weft__table[k].force->tables;
        same = of->alike == NULL || of->alike(weft__own(one, k), weft__own(other, k));
    }
    return same;
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

/* Whether a pin starts or stops with a jump, at another time: forces jump with it. */
static bool jumps_later(const weft__mesh *a, const weft__mesh *b)
{
    bool later = false;
    for (size_t i = 0; i < a->motion_count; ++i) {
        const weft__curve *one = &a->motions[i].path, *other = &b->motions[i].path;
        const size_t last = WEFT__CURVE_WIDTH * (one->count - (one->count > 0));
        later = later
                || (one->jumps && one->count > 1 && one->count == other->count
                    && (one->rows[0] != other->rows[0]
                        || one->rows[last] != other->rows[last]));
    }
    return later;
}

/* Of springs, weight and air. */
static void find_laws(weft__parameter_derivative *of)
{
    const weft__springs *less = &of->less->springs, *more = &of->more->springs;
    const weft__body *low = &of->less->body, *high = &of->more->body;
    weft__spring_derivative *to = &of->springs;
    for (size_t g = 0; g < more->group_count; ++g) {
        const weft__group *a = &less->groups[g], *b = &more->groups[g];
        const weft__law_derivative law
            = { of->scale * (b->stiffness - a->stiffness),
                of->scale * (b->damping - a->damping),
                of->scale * (b->rest_length - a->rest_length) };
        to->laws[b->orientation] = law;
        to->damped = to->damped || law.damping != 0.0;
        if (law.stiffness != 0.0 || law.damping != 0.0 || law.rest_length != 0.0) {
            to->orientations |= 1u << b->orientation;
        }
    }
    to->drag = of->scale * (high->drag - low->drag);
    for (size_t k = 0; k < 3; ++k) {
        to->gravity[k] = of->scale * (high->gravity[k] - low->gravity[k]);
    }
}

/* Of the masses, unless they are the same. */
static bool find_masses(weft__parameter_derivative *of, const weft_allocator *memory)
{
    const weft__mesh *less = &of->less->mesh, *more = &of->more->mesh;
    const size_t n = less->particles;
    if (memcmp(less->mass, more->mass, n * sizeof *less->mass) == 0) {
        return true;
    }
    double *to = weft__zeroed(memory, n + WEFT_PAST, sizeof *to);
    for (size_t i = 0; to != NULL && i < n; ++i) {
        const double w = less->inverse_mass[i] * more->inverse_mass[i];
        to[i] = -w * (of->scale * (more->mass[i] - less->mass[i]));
    }
    of->springs.inverse_mass = of->inverse_mass = to;
    return to != NULL;
}

static uint64_t parameter_hash_of(const weft_cloth *cloth, size_t k)
{
    return weft__table[k].force->tables.hash != NULL
               ? weft__table[k].force->tables.hash(weft__own(cloth, k),
                                                   WEFT__HASH_START)
               : 0;
}

weft_status weft__parameter_derivative_init(weft__parameter_derivative *of,
                                            const weft_cloth *cloth,
                                            const weft_cloth *less,
                                            const weft_cloth *more, double span,
                                            double scale, const weft_allocator *memory,
                                            weft_error *err)
{
    *of = (weft__parameter_derivative){ .less = less,
                                        .more = more,
                                        .scale = scale / span };
    if (less == NULL || more == NULL || !weft__positive(span)
        || !parameter_same_place(cloth, less) || !parameter_same_place(cloth, more)) {
        return weft_error_set(
            err, WEFT_INVALID,
            "two cloths with less and more of a parameter must have the "
            "particles, pins, springs and shapes of the cloth "
            "itself, and a span > 0");
    }
    if (cloth->grid_count > 0) {
        return weft_error_set(
            err, WEFT_UNSUPPORTED,
            "derivatives with respect to parameters need one grid, or "
            "meshes: not a grid among several cloths");
    }
    if (jumps_later(&less->mesh, &more->mesh)) {
        return weft_error_set(
            err, WEFT_UNSUPPORTED,
            "no derivative with respect to the time at which a natural spline of a "
            "pin begins or ends: its velocity jumps there");
    }
    find_laws(of);
    if (!find_masses(of, memory)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a derivative");
    }
    of->pins = !same_motions(&less->mesh, &more->mesh);
    const bool all
        = of->inverse_mass != NULL
          || memcmp(less->mesh.spacing, more->mesh.spacing, sizeof less->mesh.spacing)
                 != 0;
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        of->differs[k]
            = k != WEFT__FORCE_body
              && (all || parameter_hash_of(less, k) != parameter_hash_of(more, k));
        const weft__force *force = of->differs[k] && weft__force_at(less, k) != NULL
                                       ? weft__force_at(less, k)
                                   : of->differs[k] ? weft__force_at(more, k)
                                                    : NULL;
        of->others = of->others || (force != NULL && force->law.add != NULL);
    }
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        of->whole = of->whole
                    || (of->differs[k] && weft__table[k].force->checks.pairs != NULL
                        && weft__cloth_pairs(more));
    }
    return WEFT_OK;
}

void weft__parameter_derivative_free(const weft__parameter_derivative *of,
                                     const weft_allocator *memory)
{
    weft__free(memory, of->inverse_mass);
}

/* ---- the derivative -------------------------------------------------------------- */

/* dv/dt of blocks [first, end) by the forces that differ. */
static int parameter_evaluate(const weft__parameter_derivative *of,
                              const weft_cloth *cloth, const weft__state *at,
                              double *out, size_t first, size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles, low = weft__block(mesh, first);
    const size_t high = weft__block(mesh, end);
    int failed = 0;
    for (size_t k = 3; k < 6; ++k) {
        memset(out + k * n + low, 0, (high - low) * sizeof *out);
    }
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        if (force != NULL && force->law.add != NULL && of->differs[k]) {
            failed |= force->law.add(weft__own(cloth, k), at, WEFT__ACCELERATION,
                                     out + 3 * n, first, end);
        }
    }
    return failed;
}

/* out += scale (more - less), of the accelerations of particles [low, high). */
static void parameter_add_difference(const weft__parameter_derivative *of,
                                     double *const room[2], double *out, size_t low,
                                     size_t high)
{
    const size_t n = of->more->mesh.particles;
    for (size_t k = 3 * n; k < 6 * n; k += n) {
        for (size_t i = k + low; i < k + high; ++i) {
            out[i] += of->scale * (room[1][i] - room[0][i]);
        }
    }
}

void weft__parameter_derivative_pin(const weft__parameter_derivative *of, size_t i,
                                    const weft__state *at, double rate[6])
{
    double less[6] = { 0.0 }, more[6] = { 0.0 };
    if (of->pins) {
        weft__pin_rate(&of->less->mesh, i, at->t, weft__piece(at), less);
        weft__pin_rate(&of->more->mesh, i, at->t, weft__piece(at), more);
    }
    for (size_t k = 0; k < 6; ++k) {
        rate[k] = of->scale * (more[k] - less[k]);
    }
}

void weft__parameter_derivative_jump(const weft__parameter_derivative *of, size_t i,
                                     double t, const double piece[2], double jump[6])
{
    const weft_cloth *copies[2] = { of->less, of->more };
    double rate[6];
    memset(jump, 0, 6 * sizeof *jump);
    if (!of->pins || !weft__pin_meets(&of->less->mesh, i)) {
        return;
    }
    for (size_t j = 0; j < 4; ++j) {
        const weft__mesh *mesh = &copies[j / 2]->mesh;
        const double sign = j == 0 || j == 3 ? of->scale : -of->scale;
        double is[3][3];
        weft__curve_at(&mesh->motions[mesh->pin[i] - 1].path, t, piece[j % 2], is);
        for (size_t k = 0; k < 3; ++k) {
            jump[k] += sign * is[0][k];
        }
    }
    weft__parameter_derivative_pin(of, i, &(weft__state){ .t = t, .piece = &piece[1] },
                                   rate);
    memcpy(jump + 3, rate, 3 * sizeof *jump);
}

int weft__parameter_derivative_blocks(const weft__parameter_derivative *of,
                                      const weft__state *at, double *out,
                                      double *const room[2], size_t first, size_t end)
{
    int failed = 0;
    if (of->others) {
        failed = parameter_evaluate(of, of->less, at, room[0], first, end)
                 | parameter_evaluate(of, of->more, at, room[1], first, end);
        parameter_add_difference(of, room, out, weft__block(&of->more->mesh, first),
                                 weft__block(&of->more->mesh, end));
    }
    return failed;
}

int weft__parameter_derivative_all(const weft__parameter_derivative *of,
                                   void *const *spaces, const weft__state *at,
                                   double *out, double *const room[2])
{
    const size_t n = of->more->mesh.particles;
    int failed = 0;
    if (!of->whole) {
        return 0;
    }
    for (size_t side = 0; side < 2; ++side) {
        memset(room[side] + 3 * n, 0, 3 * n * sizeof *room[side]);
        failed |= weft__rhs_all(side == 0 ? of->less : of->more, spaces, at,
                                WEFT__ACCELERATION, room[side] + 3 * n);
    }
    parameter_add_difference(of, room, out, 0, n);
    return failed;
}

int weft_cloth_parameter_product(const weft_cloth *less, const weft_cloth *more,
                                 double span, double t, const double *y, double *out)
{
    const weft__state at = { .t = t, .y = y };
    const size_t dim = weft_cloth_dim(more), n = dim / 6;
    const size_t blocks = weft__blocks(&more->mesh);
    weft__parameter_derivative of = { .inverse_mass = NULL };
    double *still = weft__zeroed(&more->memory, dim, 3 * sizeof *still);
    int failed = -1;
    if (still != NULL
        && weft__parameter_derivative_init(&of, more, less, more, span, 1.0,
                                           &more->memory, NULL)
               == WEFT_OK) {
        double *const rooms[2] = { still + dim, still + 2 * dim };
        weft__tangents one
            = { y, NULL, n, more->mesh.cols, 1, { { still, rooms[0], &of.springs } } };
        failed = less->springs.products(&less->springs, &less->body, &one, 0, blocks);
        one.tangent[0].out = out;
        failed |= more->springs.products(&more->springs, &more->body, &one, 0, blocks);
        for (size_t i = 0; i < dim; ++i) { /* between the two */
            out[i] = 0.5 * (out[i] + rooms[0][i]);
        }
        failed |= weft__parameter_derivative_blocks(&of, &at, out, rooms, 0, blocks);
        failed |= weft__parameter_derivative_all(&of, NULL, &at, out, rooms);
        for (size_t j = 0; j < more->mesh.pinned; ++j) {
            double rate[6];
            weft__parameter_derivative_pin(&of, more->mesh.pins[j], &at, rate);
            for (size_t k = 0; k < 6; ++k) {
                out[k * n + more->mesh.pins[j]] = rate[k];
            }
        }
    }
    weft__parameter_derivative_free(&of, &more->memory);
    weft__free(&more->memory, still);
    return failed;
}

/* The sum of a[i] b[i]. */
static double parameter_product_of(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* By springs, weight, air and masses, on which net depends. */
static double springs_product(const weft__parameter_derivative *of, const double *w,
                              const weft__parameter_gradient *by, const double *net)
{
    const weft__spring_derivative *derivative = &of->springs;
    const size_t n = of->more->mesh.particles;
    double sum = parameter_product_of(derivative->gravity, by->gravity, 3)
                 + derivative->drag * by->drag;
    for (size_t g = 0; g < WEFT_GROUPS; ++g) {
        const weft__law_derivative *law = &derivative->laws[g];
        sum += law->stiffness * by->stiffness[g] + law->damping * by->damping[g]
               + law->rest_length * by->rest_length[g];
    }
    double by_mass[3] = { 0.0 }; /* three sums do not wait for one another */
    for (size_t i = 0; of->inverse_mass != NULL && i < n; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            by_mass[k] += w[(3 + k) * n + i] * (of->inverse_mass[i] * net[k * n + i]);
        }
    }
    return sum + by_mass[0] + by_mass[1] + by_mass[2];
}

int weft__parameter_derivative_product(const weft__parameter_derivative *of,
                                       void *const *spaces, const weft__state *at,
                                       const double *w,
                                       const weft__parameter_gradient *by,
                                       const double *net, double *const room[3],
                                       double *sum)
{
    const weft__mesh *mesh = &of->more->mesh;
    const size_t n = mesh->particles;
    int failed = 0;
    *sum += springs_product(of, w, by, net);
    if (of->others || of->whole) {
        memset(room[2] + 3 * n, 0, 3 * n * sizeof *room[2]);
        failed = weft__parameter_derivative_blocks(of, at, room[2], room, 0,
                                                   weft__blocks(mesh));
        failed |= weft__parameter_derivative_all(of, spaces, at, room[2], room);
        *sum += parameter_product_of(w + 3 * n, room[2] + 3 * n, 3 * n);
    }
    for (size_t j = 0; of->pins && j < mesh->pinned; ++j) {
        double rate[6];
        weft__parameter_derivative_pin(of, mesh->pins[j], at, rate);
        for (size_t k = 0; k < 6; ++k) {
            *sum += w[k * n + mesh->pins[j]] * rate[k];
        }
    }
    return failed;
}

int weft_cloth_parameter_product_transposed(const weft_cloth *less,
                                            const weft_cloth *more, double span,
                                            double t, const double *y, const double *w,
                                            double *out)
{
    const size_t dim = weft_cloth_dim(more);
    double *by = weft__alloc(&more->memory, dim, sizeof *by);
    const int failed
        = by == NULL ? -1 : weft_cloth_parameter_product(less, more, span, t, y, by);
    *out = failed < 0 ? 0.0 : parameter_product_of(w, by, dim);
    weft__free(&more->memory, by);
    return failed;
}
