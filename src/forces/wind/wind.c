/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/wind/wind.h"

#include <string.h>

#include "base/bytes.h"
#include "base/finite.h"
#include "forces/bounds.h"
#include "mesh/triangles.h"

const struct weft__wind_numbers weft__wind_numbers = {
    WEFT__FIELD(weft_cloth_def, wind_velocity, "m/s", .count = 3, .least = -HUGE_VAL),
    WEFT__FIELD(weft_cloth_def, wind_drag, "kg/(m^2 s)", .least = 0.0),
};

static void wind_check(const weft_cloth_def *def, const weft__faults *to)
{
    size_t row;
    const char *fault = weft__track_fault(&def->wind_table, &row);
    (void)WEFT__NUMBERS_CHECK(weft__wind_numbers, def, to, "%s", "");
    if (fault != NULL) {
        weft__fault(to, offsetof(weft_cloth_def, wind_table),
                    offsetof(weft_cloth_def, wind_table), "wind: row %zu %s", row,
                    fault);
    }
}

static bool wind_init(void *own, const weft_cloth_def *def,
                      const weft_allocator *memory)
{
    weft__wind *of = own;
    const size_t count = def->wind_table.count;
    of->air.drag = def->wind_drag;
    memcpy(of->air.velocity, def->wind_velocity, sizeof of->air.velocity);
    if (count > 0) {
        of->rows = weft__alloc(memory, WEFT__CURVE_WIDTH * count, sizeof *of->rows);
    }
    if (of->rows != NULL) {
        of->air.track
            = weft__curve_make(&def->wind_table, def->wind_table_natural, of->rows);
    }
    return count == 0 || of->rows != NULL;
}

static size_t wind_bytes(const void *own)
{
    const weft__wind *of = own;
    return of->rows != NULL ? WEFT__CURVE_WIDTH * of->air.track.count * sizeof *of->rows
                            : 0;
}

static bool wind_copy(void *own, const weft_allocator *memory)
{
    weft__wind *of = own;
    const double *from = of->air.track.rows;
    const size_t count = of->air.track.count * WEFT__CURVE_WIDTH;
    of->rows = count > 0 ? weft__alloc(memory, count, sizeof *of->rows) : NULL;
    if (of->rows != NULL) {
        of->air.track.rows = memcpy(of->rows, from, count * sizeof *of->rows);
    }
    of->defined = of->air, of->changed = false;
    return count == 0 || of->rows != NULL;
}

static void wind_free(void *own, const weft_allocator *memory)
{
    weft__free(memory, ((weft__wind *)own)->rows);
}

static void wind_leave_out(void *own)
{
    ((weft__wind *)own)->air.drag = 0.0;
}

static bool wind_slows(const weft_cloth_def *def)
{
    return def->wind_drag != 0.0;
}

/* A grid has the table of the whole. */
static void wind_define(const weft_cloth_def *whole, weft_cloth_def *grid)
{
    memcpy(grid->wind_velocity, whole->wind_velocity, sizeof grid->wind_velocity);
    grid->wind_drag = whole->wind_drag;
    grid->wind_table = (weft_table){ .count = 0 };
}

static uint64_t wind_hash_of(const void *own, uint64_t hash)
{
    const weft__wind *of = own;
    hash = weft__hash_reals(hash, of->air.track.rows,
                            WEFT__CURVE_WIDTH * of->air.track.count);
    return weft__hash_real(weft__hash_reals(hash, of->air.velocity, 3), of->air.drag);
}

/* ---- changes -------------------------------------------------------------------- */

enum { WIND_WORDS = 5 }; /* whether it has changed, velocity, drag */

bool weft__wind_set(weft__wind *own, const double velocity[3], double drag)
{
    if (velocity == NULL) {
        own->air = own->defined, own->changed = false;
        return true;
    }
    if (!weft__all_finite(velocity, 3) || !weft__not_negative(drag)) {
        return false;
    }
    own->air = (weft__air){ .drag = drag };
    memcpy(own->air.velocity, velocity, sizeof own->air.velocity);
    own->changed = true;
    return true;
}

static size_t wind_words(const void *own)
{
    (void)own;
    return WIND_WORDS;
}

static void wind_put(const void *own, unsigned char *to)
{
    const weft__wind *of = own;
    weft__word_put(to, of->changed ? 1 : 0);
    weft__words_put(to + WEFT__WORD, of->air.velocity, 3);
    weft__real_put(to + 4 * WEFT__WORD, of->air.drag);
}

static weft_status wind_take(void *own, const unsigned char *from, size_t words,
                             const weft_allocator *memory, weft_error *err)
{
    double saved[4];
    bool good = words == WIND_WORDS && weft__word_at(from) <= 1;
    (void)memory;
    if (good) {
        weft__words_get(saved, from + WEFT__WORD, 4);
        good = weft__wind_set(own, saved, saved[3]);
    }
    if (words == 0 || (good && weft__word_at(from) == 0)) {
        good = weft__wind_set(own, NULL, 0.0);
    }
    return good ? WEFT_OK
                : weft_error_set(err, WEFT_INVALID, "a saved wind makes no sense");
}

static void wind_share(void *own, const void *whole)
{
    ((weft__wind *)own)->air = ((const weft__wind *)whole)->air;
}

static void wind_exchange(void *own, void *taken)
{
    weft__wind *of = own, *with = taken;
    const weft__wind before = *of;
    of->air = with->air, of->changed = with->changed;
    with->air = before.air, with->changed = before.changed;
}

/* ---- in a state ----------------------------------------------------------------- */

static void wind_piece(const void *own, double t, weft__piece_bounds *to)
{
    weft__curve_bounds(&((const weft__wind *)own)->air.track, t, to);
}

/* With the velocity that it has at the state's time. */
static weft__wind at_time(const weft__wind *of, const weft__state *at)
{
    weft__wind now = *of;
    if (of->air.track.count > 0) {
        double value[3][3];
        weft__curve_at(&of->air.track, at->t, weft__piece(at), value);
        memcpy(now.air.velocity, value[0], sizeof now.air.velocity);
    }
    return now;
}

static void wind_choose(void *own, weft__isa isa)
{
    ((weft__wind *)own)->fast = WEFT_FORM(isa, wind);
}

typedef struct point {
    double x, y, z;
} point;

static point at_particle(const double *x, size_t n, size_t i)
{
    return (point){ x[i], x[n + i], x[2 * n + i] };
}

static point wind_minus(point a, point b)
{
    return (point){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static point wind_plus(point a, point b)
{
    return (point){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static void wind_add_point(point *to, point a)
{
    to->x += a.x, to->y += a.y, to->z += a.z;
}

static point wind_scaled(double share, point a)
{
    return (point){ share * a.x, share * a.y, share * a.z };
}

static double wind_dot(point a, point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static point cross(point a, point b)
{
    return (point){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                    a.x * b.y - a.y * b.x };
}

/* Adds to particle i of three planes; 0 or NaN. */
static double add_to(double *to, size_t n, size_t i, point force)
{
    to[i] += force.x, to[n + i] += force.y, to[2 * n + i] += force.z;
    return (to[i] + to[n + i] + to[2 * n + i]) * 0.0;
}

/* ---- of triangles ---------------------------------------------------------------- */

/* A triangle in a state, or in a direction of it: edges from corner 0, their cross
 * product N, and three times the wind against it. */
typedef struct sail {
    point a, b, normal, flow;
} sail;

/* wind: 0 of a direction. */
static inline sail sail_of(size_t n, const uint32_t corner[3], const double *y,
                           const double wind[3])
{
    const double *v = y + 3 * n;
    const point x = at_particle(y, n, corner[0]);
    const point sum = wind_plus(
        wind_plus(at_particle(v, n, corner[0]), at_particle(v, n, corner[1])),
        at_particle(v, n, corner[2]));
    sail to = { .a = wind_minus(at_particle(y, n, corner[1]), x),
                .b = wind_minus(at_particle(y, n, corner[2]), x),
                .flow = wind_minus(
                    (point){ 3.0 * wind[0], 3.0 * wind[1], 3.0 * wind[2] }, sum) };
    to.normal = cross(to.a, to.b);
    return to;
}

/* What a triangle gives to each corner, divided by drag / 18: n N.flow, n = N / |N|. */
static inline point sail_force(const weft__wind *of, const double *y,
                               const uint32_t corner[3])
{
    const sail now = sail_of(of->mesh->stride, corner, y, of->air.velocity);
    const double inverse = 1.0 / sqrt(wind_dot(now.normal, now.normal) + DBL_MIN);
    return wind_scaled(wind_dot(now.normal, now.flow) * inverse, now.normal);
}

/* The change of that along at->along: n turns by (dN - N (N.dN) / |N|^2) / |N|. */
static point sail_change(const weft__wind *of, const weft__state *at,
                         const uint32_t corner[3])
{
    static const double none[3];
    const size_t n = of->mesh->stride;
    const sail now = sail_of(n, corner, at->y, of->air.velocity);
    const sail by = sail_of(n, corner, at->along, none);
    const point turn = wind_plus(cross(by.a, now.b), cross(now.a, by.b));
    const double inverse = 1.0 / sqrt(wind_dot(now.normal, now.normal) + DBL_MIN);
    const double push = wind_dot(now.normal, now.flow) * inverse;
    const double rate
        = (wind_dot(turn, now.flow) + wind_dot(now.normal, by.flow)) * inverse
          - push * wind_dot(now.normal, turn) * inverse * inverse;
    return wind_plus(wind_scaled(rate, now.normal), wind_scaled(push, turn));
}

/* A third of drag A (n.flow) n, A n = N / 2, of each triangle of particle i, or its
 * change along at->along. */
static point sails_force(const weft__wind *of, const weft__state *at, size_t i,
                         double share)
{
    const weft__triangles *tri = of->mesh->triangles;
    point sum = { 0.0, 0.0, 0.0 };
    for (size_t j = tri->around_first[i]; j < tri->around_first[i + 1]; ++j) {
        const uint32_t *corner = tri->corner[tri->around[j]];
        sum = wind_plus(sum, at->along == NULL ? sail_force(of, at->y, corner)
                                               : sail_change(of, at, corner));
    }
    return wind_scaled(of->air.drag / 18.0 * share, sum);
}

/* The first triangle whose lowest corner is particle i, or follows. */
static size_t triangle_from(const weft__triangles *tri, size_t i)
{
    size_t low = 0, high = tri->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (tri->corner[middle][0] < i) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The same of the particles of block b, to their sums; 0 or NaN. Triangles whose lowest
 * corner is in the block follow one another: each is computed once. Those before them
 * come first, as they do around each particle. */
static double add_sails(const weft__wind *of, const double *y, size_t b,
                        weft__unit unit, double *to)
{
    const weft__mesh *mesh = of->mesh;
    const weft__triangles *tri = mesh->triangles;
    const size_t n = mesh->stride, first = weft__block(mesh, b);
    const size_t end = weft__block(mesh, b + 1), begin = triangle_from(tri, first);
    point sum[WEFT__MESH_BLOCK];
    double bad = 0.0;
    for (size_t i = first; i < end; ++i) {
        sum[i - first] = (point){ 0.0, 0.0, 0.0 };
        for (size_t j = tri->around_first[i];
             j < tri->around_first[i + 1] && tri->around[j] < begin; ++j) {
            wind_add_point(&sum[i - first],
                           sail_force(of, y, tri->corner[tri->around[j]]));
        }
    }
    for (size_t t = begin; t < tri->count && tri->corner[t][0] < end; ++t) {
        const uint32_t *corner = tri->corner[t];
        const point force = sail_force(of, y, corner);
        for (size_t k = 0; k < 3; ++k) {
            if (corner[k] < end) {
                wind_add_point(&sum[corner[k] - first], force);
            }
        }
    }
    for (size_t i = first; i < end; ++i) {
        const double share = unit == WEFT__FORCE ? 1.0 : mesh->inverse_mass[i];
        bad += add_to(to, n, i,
                      wind_scaled(of->air.drag / 18.0 * share, sum[i - first]));
    }
    return bad;
}

static int sails(const weft__wind *of, const weft__state *at, weft__unit unit,
                 double *to, size_t first, size_t end)
{
    double bad = 0.0;
    for (size_t b = first; b < end; ++b) {
        bad += add_sails(of, at->y, b, unit, to);
    }
    return bad == 0.0 ? 0 : 1;
}

/* [m^2] A third of the triangles of particle i; y NULL: with stretches up to 1.1. */
static double sails_area(const weft__mesh *mesh, const double *y, size_t i)
{
    const weft__triangles *tri = mesh->triangles;
    static const double none[3];
    double sum = 0.0;
    if (y == NULL) {
        return 1.21 * tri->lumped[i];
    }
    for (size_t j = tri->around_first[i]; j < tri->around_first[i + 1]; ++j) {
        const uint32_t *corner = tri->corner[tri->around[j]];
        const point normal = sail_of(mesh->stride, corner, y, none).normal;
        sum += sqrt(wind_dot(normal, normal)) / 6.0;
    }
    return sum;
}

/* ---- of a grid ------------------------------------------------------------------- */

/* The neighbours of particle i: right, left, down, up; itself at a rim. */
static void wind_neighbours(const weft__mesh *mesh, size_t i, size_t to[4])
{
    const size_t cols = mesh->cols, r = i / cols, c = i % cols;
    to[0] = c + 1 < cols ? i + 1 : i, to[1] = c > 0 ? i - 1 : i;
    to[2] = r + 1 < mesh->rows ? i + cols : i, to[3] = r > 0 ? i - cols : i;
}

/* Of the column and the row of particle i. */
static void tangents(const weft__mesh *mesh, const double *x, size_t i, point *a,
                     point *b)
{
    const size_t n = mesh->stride;
    size_t at[4];
    wind_neighbours(mesh, i, at);
    *a = wind_minus(at_particle(x, n, at[0]), at_particle(x, n, at[1]));
    *b = wind_minus(at_particle(x, n, at[2]), at_particle(x, n, at[3]));
}

/* The wind against particle i. */
static point flow_at(const weft__wind *of, const double *y, size_t i)
{
    const size_t n = of->mesh->stride;
    return wind_minus(at_particle(of->air.velocity, 1, 0),
                      at_particle(y + 3 * n, n, i));
}

static point grid_force(const weft__wind *of, const weft__state *at, size_t i,
                        double share)
{
    point a, b;
    tangents(of->mesh, at->y, i, &a, &b);
    const point normal = cross(a, b);
    const double push = of->air.drag * weft__area(of->mesh, i) * share
                        * wind_dot(normal, flow_at(of, at->y, i))
                        / (wind_dot(normal, normal) + DBL_MIN);
    return wind_scaled(push, normal);
}

/* With the change dN = da x b + a x db of N, that of F = drag area (N.flow) N / (N.N)
 * is drag area ((dN.flow - N.dv - 2 (N.flow) (N.dN) / (N.N)) N + (N.flow) dN) / (N.N).
 */
static point grid_change(const weft__wind *of, const weft__state *at, size_t i)
{
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride;
    point a, b, da, db;
    tangents(mesh, at->y, i, &a, &b);
    tangents(mesh, at->along, i, &da, &db);
    const point normal = cross(a, b), turn = wind_plus(cross(da, b), cross(a, db));
    const point flow = flow_at(of, at->y, i), dv = at_particle(at->along + 3 * n, n, i);
    const double drag = of->air.drag * mesh->inverse_mass[i] * weft__area(mesh, i);
    const double inverse = 1.0 / (wind_dot(normal, normal) + DBL_MIN);
    const double push = wind_dot(normal, flow) * inverse;
    const double rate = (wind_dot(turn, flow) - wind_dot(normal, dv)) * inverse
                        - 2.0 * push * wind_dot(normal, turn) * inverse;
    return wind_scaled(drag,
                       wind_plus(wind_scaled(rate, normal), wind_scaled(push, turn)));
}

static point wind_force(const weft__wind *of, const weft__state *at, size_t i,
                        double share)
{
    return of->mesh->triangles != NULL ? sails_force(of, at, i, share)
           : at->along != NULL         ? grid_change(of, at, i)
                                       : grid_force(of, at, i, share);
}

int weft__wind_loops(const void *own, const weft__state *at, weft__unit unit,
                     double *to, size_t first, size_t end)
{
    const weft__wind *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride, last = weft__block(mesh, end);
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        const double share = unit == WEFT__FORCE ? 1.0 : mesh->inverse_mass[i];
        bad += add_to(to, n, i, wind_force(of, at, i, share));
    }
    return bad == 0.0 ? 0 : 1;
}

static int wind_add(const void *own, const weft__state *at, weft__unit unit, double *to,
                    size_t first, size_t end)
{
    const weft__wind now = at_time(own, at);
    weft__add_fn *form = unit == WEFT__FORCE ? weft__wind_loops : now.fast;
    if (now.mesh->triangles != NULL) {
        return sails(&now, at, unit, to, first, end);
    }
    return form(&now, at, unit, to, first, end);
}

static int wind_change(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__wind now = at_time(own, at), *of = &now;
    const size_t n = of->mesh->stride, last = weft__block(of->mesh, end);
    double bad = 0.0;
    (void)unit;
    for (size_t i = weft__block(of->mesh, first); i < last; ++i) {
        bad += add_to(to, n, i, wind_force(of, at, i, of->mesh->inverse_mass[i]));
    }
    return bad == 0.0 ? 0 : 1;
}

/* Of one particle, or triangle, which pushes by drag (N.flow) N / |N|^p on those whose
 * l have the sum m: the derivatives of m.F by N, and by flow. */
static point by_normal(point normal, point flow, point m, double drag, int p,
                       point *by_flow)
{
    const double square = wind_dot(normal, normal) + DBL_MIN;
    const double per = drag / (p == 1 ? sqrt(square) : square);
    const double push = wind_dot(normal, flow), along = wind_dot(normal, m);
    *by_flow = wind_scaled(per * along, normal);
    return wind_scaled(
        per, wind_minus(wind_plus(wind_scaled(along, flow), wind_scaled(push, m)),
                        wind_scaled(p * push * along / square, normal)));
}

/* Adds what N = a x b has by them, a from at[1] to at[0] and b from at[3] to at[2]. */
static void wind_add_edges(double *out, size_t n, const size_t at[4], point a, point b,
                           point normal)
{
    const point by_a = cross(b, normal), by_b = cross(normal, a);
    (void)add_to(out, n, at[0], by_a);
    (void)add_to(out, n, at[1], wind_scaled(-1.0, by_a));
    (void)add_to(out, n, at[2], by_b);
    (void)add_to(out, n, at[3], wind_scaled(-1.0, by_b));
}

static void transposed_sails(const weft__wind *of, const weft__state *at, double *out)
{
    const size_t n = of->mesh->stride;
    for (size_t t = 0; t < of->mesh->triangles->count; ++t) {
        const uint32_t *corner = of->mesh->triangles->corner[t];
        const sail now = sail_of(n, corner, at->y, of->air.velocity);
        point m = { 0.0, 0.0, 0.0 }, flow;
        for (size_t k = 0; k < 3; ++k) {
            wind_add_point(&m, at_particle(at->along, n, corner[k]));
        }
        const point normal
            = by_normal(now.normal, now.flow, m, of->air.drag / 18.0, 1, &flow);
        wind_add_edges(out, n, (size_t[]){ corner[1], corner[0], corner[2], corner[0] },
                       now.a, now.b, normal);
        for (size_t k = 0; k < 3; ++k) {
            (void)add_to(out + 3 * n, n, corner[k], wind_scaled(-1.0, flow));
        }
    }
}

static void transposed(const void *own, const weft__state *at, double *out)
{
    const weft__wind now = at_time(own, at), *of = &now;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride;
    if (mesh->triangles != NULL) {
        transposed_sails(of, at, out);
        return;
    }
    for (size_t i = 0; i < n; ++i) {
        point a, b, flow;
        size_t ends[4];
        wind_neighbours(mesh, i, ends);
        tangents(mesh, at->y, i, &a, &b);
        const point normal = by_normal(cross(a, b), flow_at(of, at->y, i),
                                       at_particle(at->along, n, i),
                                       of->air.drag * weft__area(mesh, i), 2, &flow);
        wind_add_edges(out, n, ends, a, b, normal);
        (void)add_to(out + 3 * n, n, i, wind_scaled(-1.0, flow));
    }
}

static void wind_power(const void *own, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    const weft__wind now = at_time(own, at), *of = &now;
    const size_t n = of->mesh->stride, end = weft__block(of->mesh, b + 1);
    for (size_t i = weft__block(of->mesh, b); i < end; ++i) {
        if (of->mesh->pin[i] == 0) {
            sum->power[WEFT_POWER_WIND] += wind_dot(wind_force(of, at, i, 1.0),
                                                    at_particle(at->y + 3 * n, n, i));
        }
    }
}

/* No direction is damped more, on a grid whatever the state: of a triangle, C has the
 * blocks drag A n n^T / 9, and is at most three times those of its diagonal. */
static void wind_bound(const void *own, const weft__state *at, size_t i,
                       const weft__sides *sides, double (*sums)[6])
{
    const weft__wind *of = own;
    const weft__mesh *mesh = of->mesh;
    const double area
        = mesh->triangles != NULL ? sails_area(mesh, at->y, i) : weft__area(mesh, i);
    const double most = of->air.drag * area * mesh->inverse_mass[i];
    for (size_t s = 0; s < sides->count; ++s) {
        weft__bound_add(sums[s], fmax(0.0, sides->direction[s][1]) * most);
    }
}

static bool wind_present(const void *own)
{
    return ((const weft__wind *)own)->air.drag != 0.0;
}

const weft__force weft__wind_force = { .name = "wind",
                                       .tables.check = wind_check,
                                       .tables.init = wind_init,
                                       .tables.hash = wind_hash_of,
                                       .tables.choose = wind_choose,
                                       .tables.copy = wind_copy,
                                       .tables.free = wind_free,
                                       .tables.leave_out = wind_leave_out,
                                       .tables.bytes = wind_bytes,
                                       .tables.slows = wind_slows,
                                       .grids.have_it = true,
                                       .grids.measured = true,
                                       .grids.define = wind_define,
                                       .grids.share = wind_share,
                                       .changes.words = wind_words,
                                       .changes.put = wind_put,
                                       .changes.take = wind_take,
                                       .changes.exchange = wind_exchange,
                                       .present = wind_present,
                                       .law.add = wind_add,
                                       .law.change = wind_change,
                                       .law.transposed = transposed,
                                       .law.piece = wind_piece,
                                       .measures.power = wind_power,
                                       .bounds.particle = wind_bound };
