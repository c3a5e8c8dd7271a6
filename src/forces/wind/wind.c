/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/wind/wind.h"

#include <string.h>

#include "base/hash.h"
#include "forces/bounds.h"
#include "mesh/triangles.h"

const struct weft__wind_numbers weft__wind_numbers = {
    WEFT__FIELD(weft_cloth_def, wind_velocity, "m/s", .count = 3, .least = -HUGE_VAL),
    WEFT__FIELD(weft_cloth_def, wind_drag, "kg/(m^2 s)", .least = 0.0),
};

static void check(const weft_cloth_def *def, const weft__faults *to)
{
    (void)WEFT__NUMBERS_CHECK(weft__wind_numbers, def, to, "%s", "");
}

static bool init(void *own, const weft_cloth_def *def, const weft_allocator *memory)
{
    weft__wind *of = own;
    (void)memory;
    of->drag = def->wind_drag;
    memcpy(of->velocity, def->wind_velocity, sizeof of->velocity);
    return true;
}

static uint64_t hash_of(const void *own, uint64_t hash)
{
    const weft__wind *of = own;
    return weft__hash_real(weft__hash_reals(hash, of->velocity, 3), of->drag);
}

static void choose(void *own, weft__isa isa)
{
    ((weft__wind *)own)->fast = WEFT_FORM(isa, wind);
}

/* x(hi) - x(lo), of the planes x. */
static void tangent(const double *x, size_t n, size_t lo, size_t hi, double t[3])
{
    for (size_t k = 0; k < 3; ++k) {
        t[k] = x[k * n + hi] - x[k * n + lo];
    }
}

/* Of the column and the row of particle i. */
static void tangents(const weft__mesh *mesh, const double *x, size_t i, double a[3],
                     double b[3])
{
    const size_t n = mesh->particles, cols = mesh->cols, r = i / cols, c = i % cols;
    tangent(x, n, c > 0 ? i - 1 : i, c + 1 < cols ? i + 1 : i, a);
    tangent(x, n, r > 0 ? i - cols : i, r + 1 < mesh->rows ? i + cols : i, b);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- of triangles ---------------------------------------------------------------- */

typedef struct point {
    double x, y, z;
} point;

/* A triangle in a state, or in a direction of it: edges from corner 0, their cross
 * product N, and three times the wind against it. */
typedef struct sail {
    point a, b, normal, flow;
} sail;

static point at_particle(const double *x, size_t n, size_t i)
{
    return (point){ x[i], x[n + i], x[2 * n + i] };
}

static point minus(point a, point b)
{
    return (point){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static point plus(point a, point b)
{
    return (point){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static void add_point(point *to, point a)
{
    to->x += a.x, to->y += a.y, to->z += a.z;
}

static point scaled(double share, point a)
{
    return (point){ share * a.x, share * a.y, share * a.z };
}

static double dot(point a, point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static point cross_product(point a, point b)
{
    return (point){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                    a.x * b.y - a.y * b.x };
}

/* wind: 0 of a direction. */
static inline sail sail_of(size_t n, const uint32_t corner[3], const double *y,
                           const double wind[3])
{
    const double *v = y + 3 * n;
    const point x = at_particle(y, n, corner[0]);
    const point sum
        = plus(plus(at_particle(v, n, corner[0]), at_particle(v, n, corner[1])),
               at_particle(v, n, corner[2]));
    sail to = { .a = minus(at_particle(y, n, corner[1]), x),
                .b = minus(at_particle(y, n, corner[2]), x),
                .flow
                = minus((point){ 3.0 * wind[0], 3.0 * wind[1], 3.0 * wind[2] }, sum) };
    to.normal = cross_product(to.a, to.b);
    return to;
}

/* What a triangle gives to each corner, divided by drag / 18: n N.flow, n = N / |N|. */
static inline point sail_force(const weft__wind *of, const double *y,
                               const uint32_t corner[3])
{
    const sail now = sail_of(of->mesh->particles, corner, y, of->velocity);
    const double inverse = 1.0 / sqrt(dot(now.normal, now.normal) + DBL_MIN);
    return scaled(dot(now.normal, now.flow) * inverse, now.normal);
}

/* The change of that along at->along: n turns by (dN - N (N.dN) / |N|^2) / |N|. */
static point sail_slope(const weft__wind *of, const weft__state *at,
                        const uint32_t corner[3])
{
    static const double none[3];
    const size_t n = of->mesh->particles;
    const sail now = sail_of(n, corner, at->y, of->velocity);
    const sail by = sail_of(n, corner, at->along, none);
    const point turn = plus(cross_product(by.a, now.b), cross_product(now.a, by.b));
    const double inverse = 1.0 / sqrt(dot(now.normal, now.normal) + DBL_MIN);
    const double push = dot(now.normal, now.flow) * inverse;
    const double rate = (dot(turn, now.flow) + dot(now.normal, by.flow)) * inverse
                        - push * dot(now.normal, turn) * inverse * inverse;
    return plus(scaled(rate, now.normal), scaled(push, turn));
}

/* A third of drag A (n.flow) n, A n = N / 2, of each triangle of particle i, or its
 * change along at->along. */
static void sails_force(const weft__wind *of, const weft__state *at, size_t i,
                        double share, double force[3])
{
    const weft__triangles *tri = of->mesh->triangles;
    point sum = { 0.0, 0.0, 0.0 };
    for (size_t j = tri->around_first[i]; j < tri->around_first[i + 1]; ++j) {
        const uint32_t *corner = tri->corner[tri->around[j]];
        sum = plus(sum, at->along == NULL ? sail_force(of, at->y, corner)
                                          : sail_slope(of, at, corner));
    }
    sum = scaled(of->drag / 18.0 * share, sum);
    force[0] = sum.x, force[1] = sum.y, force[2] = sum.z;
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
    const size_t n = mesh->particles, first = weft__block(mesh, b);
    const size_t end = weft__block(mesh, b + 1), begin = triangle_from(tri, first);
    point sum[WEFT__MESH_BLOCK];
    double bad = 0.0;
    for (size_t i = first; i < end; ++i) {
        sum[i - first] = (point){ 0.0, 0.0, 0.0 };
        for (size_t j = tri->around_first[i];
             j < tri->around_first[i + 1] && tri->around[j] < begin; ++j) {
            add_point(&sum[i - first], sail_force(of, y, tri->corner[tri->around[j]]));
        }
    }
    for (size_t t = begin; t < tri->count && tri->corner[t][0] < end; ++t) {
        const uint32_t *corner = tri->corner[t];
        const point force = sail_force(of, y, corner);
        for (size_t k = 0; k < 3; ++k) {
            if (corner[k] < end) {
                add_point(&sum[corner[k] - first], force);
            }
        }
    }
    for (size_t i = first; i < end; ++i) {
        const double share = unit == WEFT__FORCE ? 1.0 : mesh->inverse_mass[i];
        const point all = scaled(of->drag / 18.0 * share, sum[i - first]);
        to[i] += all.x, to[n + i] += all.y, to[2 * n + i] += all.z;
        bad += (to[i] + to[n + i] + to[2 * n + i]) * 0.0;
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
        const point normal = sail_of(mesh->particles, corner, y, none).normal;
        sum += sqrt(dot(normal, normal)) / 6.0;
    }
    return sum;
}

/* ---- of a grid ------------------------------------------------------------------- */

static void grid_force(const weft__wind *of, const weft__state *at, size_t i,
                       double share, double force[3])
{
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->particles;
    double a[3], b[3], normal[3], flow[3];
    tangents(mesh, at->y, i, a, b);
    cross(a, b, normal);
    for (size_t k = 0; k < 3; ++k) {
        flow[k] = of->velocity[k] - at->y[(k + 3) * n + i];
    }
    const double push = of->drag * weft__area(mesh, i) * share * weft__dot(normal, flow)
                        / (weft__dot(normal, normal) + DBL_MIN);
    for (size_t k = 0; k < 3; ++k) {
        force[k] = push * normal[k];
    }
}

/* With the change dN = da x b + a x db of N, that of F = drag area (N.flow) N / (N.N)
 * is drag area ((dN.flow - N.dv - 2 (N.flow) (N.dN) / (N.N)) N + (N.flow) dN) / (N.N).
 */
static void grid_slope(const weft__wind *of, const weft__state *at, size_t i,
                       double slope[3])
{
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->particles;
    double a[3], b[3], da[3], db[3], normal[3], turn[3], more[3], flow[3], dv[3];
    tangents(mesh, at->y, i, a, b);
    tangents(mesh, at->along, i, da, db);
    cross(a, b, normal);
    cross(da, b, turn);
    cross(a, db, more);
    for (size_t k = 0; k < 3; ++k) {
        turn[k] += more[k];
        dv[k] = at->along[(k + 3) * n + i];
        flow[k] = of->velocity[k] - at->y[(k + 3) * n + i];
    }
    const double drag = of->drag * mesh->inverse_mass[i] * weft__area(mesh, i);
    const double inverse = 1.0 / (weft__dot(normal, normal) + DBL_MIN);
    const double push = weft__dot(normal, flow) * inverse;
    const double rate = (weft__dot(turn, flow) - weft__dot(normal, dv)) * inverse
                        - 2.0 * push * weft__dot(normal, turn) * inverse;
    for (size_t k = 0; k < 3; ++k) {
        slope[k] = drag * (rate * normal[k] + push * turn[k]);
    }
}

static void wind_force(const weft__wind *of, const weft__state *at, size_t i,
                       double share, double force[3])
{
    if (of->mesh->triangles != NULL) {
        sails_force(of, at, i, share, force);
    } else if (at->along != NULL) {
        grid_slope(of, at, i, force);
    } else {
        grid_force(of, at, i, share, force);
    }
}

int weft__wind_loops(const void *own, const weft__state *at, weft__unit unit,
                     double *to, size_t first, size_t end)
{
    const weft__wind *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->particles, last = weft__block(mesh, end);
    double bad = 0.0, force[3];
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        wind_force(of, at, i, unit == WEFT__FORCE ? 1.0 : mesh->inverse_mass[i], force);
        for (size_t k = 0; k < 3; ++k) {
            to[k * n + i] += force[k];
            bad += to[k * n + i] * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
}

static int add(const void *own, const weft__state *at, weft__unit unit, double *to,
               size_t first, size_t end)
{
    const weft__wind *of = own;
    weft__add_fn *form = unit == WEFT__FORCE ? weft__wind_loops : of->fast;
    if (of->mesh->triangles != NULL) {
        return of->drag != 0.0 ? sails(of, at, unit, to, first, end) : 0;
    }
    return of->drag != 0.0 ? form(own, at, unit, to, first, end) : 0;
}

static int change(const void *own, const weft__state *at, weft__unit unit, double *to,
                  size_t first, size_t end)
{
    const weft__wind *of = own;
    const size_t n = of->mesh->particles, last = weft__block(of->mesh, end);
    double bad = 0.0, slope[3];
    (void)unit;
    for (size_t i = weft__block(of->mesh, first); of->drag != 0.0 && i < last; ++i) {
        wind_force(of, at, i, of->mesh->inverse_mass[i], slope);
        for (size_t k = 0; k < 3; ++k) {
            to[k * n + i] += slope[k];
            bad += slope[k] * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
}

static void power(const void *own, const weft__state *at, size_t b, weft_measures *sum)
{
    const weft__wind *of = own;
    const size_t n = of->mesh->particles, end = weft__block(of->mesh, b + 1);
    for (size_t i = weft__block(of->mesh, b); of->drag != 0.0 && i < end; ++i) {
        const double *z = at->y + i;
        const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
        double force[3];
        if (of->mesh->pin[i] == 0) {
            wind_force(of, at, i, 1.0, force);
            sum->power[WEFT_POWER_WIND] += weft__dot(force, v);
        }
    }
}

/* No direction is damped more, on a grid whatever the state: of a triangle, C has the
 * blocks drag A n n^T / 9, and is at most three times those of its diagonal. */
static void bound(const void *own, const weft__state *at, size_t i,
                  const weft__sides *sides, double (*sums)[6])
{
    const weft__wind *of = own;
    const weft__mesh *mesh = of->mesh;
    const double area
        = mesh->triangles != NULL ? sails_area(mesh, at->y, i) : weft__area(mesh, i);
    const double most = of->drag * area * mesh->inverse_mass[i];
    for (size_t s = 0; s < sides->count; ++s) {
        weft__bound_add(sums[s], fmax(0.0, sides->way[s][1]) * most);
    }
}

const weft__force weft__wind_force = { .name = "wind",
                                       .check = check,
                                       .init = init,
                                       .hash = hash_of,
                                       .choose = choose,
                                       .add = add,
                                       .change = change,
                                       .power = power,
                                       .bound = bound };
