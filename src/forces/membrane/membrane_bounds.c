/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_bounds.c -- bounds on the stiffness of a membrane, and its matrix.
 *
 * With gradients g_a of the shape functions, the stress S, V_a = (g_a1 0; 0 g_a2;
 * g_a2 g_a1) and the matrix C of the fabric, a triangle adds to K the blocks
 *
 *     K_ab = A (F V_a^T C V_b F^T + g_a.S g_b I)
 *
 * and to C those of the first term, by the damping. For norms k_ab >= |K_ab| and any
 * d > 0, K <= diag((k d)_a / d_a), as 2 |x_a| |x_b| <= d_b / d_a |x_a|^2 + d_a / d_b
 * |x_b|^2. |F|^2 is the square of the largest stretch, and the part of S below 0 may be
 * left out. Steps of d <- M^-1 k d at rest make the bound sharper (L. Collatz, Math. Z.
 * 48, 1942). */
#include <string.h>

#include "base/memory.h"
#include "forces/bounds.h"
#include "forces/membrane/membrane_law.h"

/* Without a state, stretches lie between 0 and this. */
#define MOST_STRETCH 1.1

enum { STEPS = 3 };

/* What a triangle is at rest. */
typedef struct shape {
    const weft_fabric *fabric;
    double area, grad[3][2]; /* [m^2], [1/m] */
} shape;

static shape shape_of(const weft__triangles *of, size_t t)
{
    shape out = { .fabric = &of->fabrics[of->fabric[t]], .area = of->area[t] };
    for (size_t a = 0; a < 3; ++a) {
        const double *from = of->rest[of->place[t][(a + 1) % 3]];
        const double *to = of->rest[of->place[t][(a + 2) % 3]];
        out.grad[a][0] = (from[1] - to[1]) / (2.0 * out.area);
        out.grad[a][1] = (to[0] - from[0]) / (2.0 * out.area);
    }
    return out;
}

/* [1/m^2 N/m] The largest stretch of V_a^T C V_b. */
static double norm_of(const shape *of, size_t a, size_t b)
{
    const weft_fabric *c = of->fabric;
    const double *g = of->grad[a], *h = of->grad[b];
    const double p = g[0] * c->stretch[1] * h[0] + g[1] * c->shear * h[1];
    const double q = g[0] * c->coupling * h[1] + g[1] * c->shear * h[0];
    const double r = g[1] * c->coupling * h[0] + g[0] * c->shear * h[1];
    const double s = g[1] * c->stretch[0] * h[1] + g[0] * c->shear * h[0];
    return 0.5
           * (sqrt((p + s) * (p + s) + (q - r) * (q - r))
              + sqrt((p - s) * (p - s) + (q + r) * (q + r)));
}

/* What a state makes of a triangle; S by its parts above and below 0, as 11, 22, 12. */
typedef struct load {
    double square;            /* of the largest stretch */
    double taut[3], slack[3]; /* [N/m] */
    double d[3][3], q[3];     /* [m], [m^2] edges and their squares */
    weft__barrier barrier;
    double of[WEFT__CONSTANTS * WEFT__WIDTH];
} load;

/* The part above 0 of a symmetric 2 x 2 matrix 11, 22, 12, times sign. Returns the
 * largest eigenvalue. */
static double above(const double s[3], double sign, double out[3])
{
    const double mean = 0.5 * sign * (s[0] + s[1]), half = 0.5 * sign * (s[0] - s[1]);
    const double off = sign * s[2], radius = sqrt(half * half + off * off);
    const double most = fmax(mean + radius, 0.0), other = fmax(mean - radius, 0.0);
    const double middle = 0.5 * (most + other);
    const double scale = radius > 0.0 ? 0.5 * (most - other) / radius : 0.0;
    out[0] = middle + scale * half;
    out[1] = middle - scale * half;
    out[2] = scale * off;
    return mean + radius;
}

static void load_of(const weft__mesh *mesh, size_t t, const shape *of, const double *y,
                    load *out)
{
    const weft__triangles *tri = mesh->triangles;
    const size_t n = mesh->particles;
    double part[3][3], e[3] = { 0.0, 0.0, 0.0 }, stress[3], unused[3];
    weft__membrane_constants(tri, t, out->of);
    weft__membrane_shape(tri, t, part);
    for (size_t i = 0; i < 3; ++i) {
        const double *x = y + tri->corner[t][(i + 1) % 3];
        const double *z = y + tri->corner[t][(i + 2) % 3];
        for (size_t k = 0; k < 3; ++k) {
            out->d[i][k] = z[k * n] - x[k * n];
        }
        out->q[i] = weft__dot(out->d[i], out->d[i]);
        for (size_t k = 0; k < 3; ++k) {
            e[k] += (out->q[i] - CONSTANT(out->of, WEFT__SQUARE + i)) * part[i][k];
        }
    }
    weft__membrane_stress(of->fabric, e, stress);
    (void)above(stress, 1.0, out->taut);
    (void)above(stress, -1.0, out->slack);
    out->square = 1.0 + 2.0 * above(e, 1.0, unused);
    (void)weft__membrane_barrier(out->of, out->q, &out->barrier);
}

/* The same for all stretches in [0, MOST_STRETCH]. The strain is e I - P, P >= 0: in
 * most fabrics C:P >= 0, and S <= e C:I. In others S12 and what the coupling takes from
 * S11 and S22 are bounded apart. */
static void any_load(const shape *of, load *out)
{
    const weft_fabric *c = of->fabric;
    const double warp = c->stretch[0], weft = c->stretch[1], e12 = c->coupling;
    const double e = 0.5 * (MOST_STRETCH * MOST_STRETCH - 1.0), least = -0.5;
    const bool usual = e12 >= 0.0 && sqrt(warp * weft) + e12 >= 2.0 * c->shear;
    const double turn = fmax(e12 * e, e12 * least);
    const double shear = usual ? 0.0 : c->shear * (e - least);
    out->square = MOST_STRETCH * MOST_STRETCH;
    out->taut[0] = weft * e + turn + shear;
    out->taut[1] = warp * e + turn + shear;
}

/* [N/m^3] g_a.S g_b of a part S of the stress */
static double geometric(const shape *of, const double s[3], size_t a, size_t b)
{
    const double *g = of->grad[a], *h = of->grad[b];
    return g[0] * s[0] * h[0] + g[1] * s[1] * h[1] + s[2] * (g[0] * h[1] + g[1] * h[0]);
}

/* The same as a bound of |g_a.S g_b| where S is one. */
static double most_geometric(const shape *of, const double s[3], size_t a, size_t b)
{
    const double *g = of->grad[a], *h = of->grad[b];
    return fabs(g[0] * s[0] * h[0]) + fabs(g[1] * s[1] * h[1]);
}

/* [N/m] |K_ab| of the barrier: its curvature in r, and twice the largest eigenvalue of
 * the slope by that of r, by the edges. */
static double barrier_norm(const load *at, size_t a, size_t b)
{
    const weft__barrier *of = &at->barrier;
    const double most = 16.0 * of->push / CONSTANT(at->of, WEFT__LEAST);
    double lean[3][3] = { { 0.0 } }, edge[3];
    for (size_t i = 0; i < 3; ++i) {
        edge[i] = most * at->q[i] + 2.0 * fmax(0.0, -of->push * of->rate[i]);
        for (size_t k = 0; k < 3; ++k) {
            const double slope = 2.0 * of->rate[i] * at->d[i][k];
            lean[(i + 1) % 3][k] -= slope;
            lean[(i + 2) % 3][k] += slope;
        }
    }
    return of->bend * weft__length(lean[a]) * weft__length(lean[b])
           + (a == b ? edge[(a + 1) % 3] + edge[(a + 2) % 3] : edge[3 - a - b]);
}

/* Parts of a bound, by mass [1/s^2]. */
typedef struct bound_parts {
    double stiff, taut, slack;
} bound_parts;

/* Those of corner a of triangle t. */
static bound_parts parts_of(const weft__membrane *own, const weft__state *at, size_t t,
                            size_t a, const shape *rest)
{
    const weft__mesh *mesh = own->mesh;
    const uint32_t *corner = mesh->triangles->corner[t];
    const double *weight = own->weight;
    bound_parts sum = { 0.0, 0.0, 0.0 };
    load now;
    if (at->y != NULL) {
        load_of(mesh, t, rest, at->y, &now);
    } else {
        any_load(rest, &now);
    }
    for (size_t b = 0; b < 3; ++b) {
        if (mesh->pin[corner[b]] != 0) {
            continue;
        }
        const double share = weight[corner[b]] / weight[corner[a]]
                             * mesh->inverse_mass[corner[a]] * (1.0 + WEFT__ROUNDOFF);
        const double area = share * rest->area;
        sum.stiff += area * now.square * norm_of(rest, a, b);
        if (at->y == NULL) {
            sum.taut += area * most_geometric(rest, now.taut, a, b);
            continue;
        }
        sum.taut += area * fabs(geometric(rest, now.taut, a, b))
                    + share * barrier_norm(&now, a, b);
        sum.slack += area * fabs(geometric(rest, now.slack, a, b));
    }
    return sum;
}

void weft__membrane_bound(const void *own, const weft__state *at, size_t i,
                          const weft__sides *sides, double (*sums)[6])
{
    const weft__membrane *of = own;
    const weft__triangles *tri = of->mesh->triangles;
    const size_t end = tri != NULL ? tri->around_first[i + 1] : 0;
    for (size_t j = tri != NULL ? tri->around_first[i] : 0; j < end; ++j) {
        const uint32_t t = tri->around[j], *corner = tri->corner[t];
        const size_t a = corner[0] == i ? 0 : corner[1] == i ? 1 : 2;
        const shape rest = shape_of(tri, t);
        const bound_parts sum = parts_of(of, at, t, a, &rest);
        for (size_t s = 0; s < sides->count; ++s) {
            const double *way = sides->way[s];
            const double scale = way[0] + way[1] * rest.fabric->damping[0];
            weft__bound_add(sums[s], fmax(0.0, scale) * sum.stiff
                                         + fmax(0.0, way[0]) * sum.taut
                                         + fmax(0.0, -way[0]) * sum.slack);
        }
    }
}

void weft__membrane_ratios(const void *own, weft__sides *to)
{
    const weft__triangles *of = ((const weft__membrane *)own)->mesh->triangles;
    for (size_t f = 0; of != NULL && f < of->fabric_count; ++f) {
        weft__sides_add(to, of->fabrics[f].damping[0]);
    }
}

/* to = M^-1 k d at rest; returns the largest to_i / d_i. */
static double weigh(const weft__mesh *mesh, const double *d, double *to)
{
    const weft__triangles *of = mesh->triangles;
    double most = 0.0;
    memset(to, 0, mesh->particles * sizeof *to);
    for (size_t t = 0; t < of->count; ++t) {
        const shape rest = shape_of(of, t);
        for (size_t a = 0; a < 3; ++a) {
            for (size_t b = 0; b < 3; ++b) {
                to[of->corner[t][a]]
                    += rest.area * norm_of(&rest, a, b) * d[of->corner[t][b]];
            }
        }
    }
    for (size_t i = 0; i < mesh->particles; ++i) {
        to[i] /= mesh->mass[i];
        most = fmax(most, to[i] / d[i]);
    }
    return most;
}

bool weft__membrane_weigh(weft__membrane *own, const weft_allocator *memory)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = mesh->particles;
    double *d = weft__alloc(memory, n, 2 * sizeof *d), least = INFINITY;
    own->weight = weft__alloc(memory, n, sizeof *own->weight);
    for (size_t i = 0; d != NULL && i < n; ++i) {
        d[i] = 1.0;
    }
    for (size_t step = 0; d != NULL && own->weight != NULL && step <= STEPS; ++step) {
        const double most = weigh(mesh, d, d + n);
        if (step == 0 || most < least) {
            memcpy(own->weight, d, n * sizeof *d);
            least = most;
        }
        for (size_t i = 0; i < n; ++i) {
            d[i] = d[n + i] / most + 1e-3 * d[i];
        }
    }
    weft__free(memory, d);
    return d != NULL && own->weight != NULL;
}

/* ---- the matrix ------------------------------------------------------------------ */

/* Adds (a K + b C) x of triangle t to out. K is never negative: stress below 0 is left
 * out, and the barrier has its curvature in r alone. Edge i pulls with
 *
 *     sum_j (2 a (K_ij + 2 bend rate_i rate_j) + b lag K_ij) d_j.dd_j d_i + a s_i dd_i
 *
 * s_i = -area g_j.S g_k. */
static void multiply_triangle(const weft__membrane *own, const weft__state *at,
                              size_t t, double a, double b, const double *x,
                              double *out)
{
    const size_t n = own->mesh->particles;
    const uint32_t *corner = own->mesh->triangles->corner[t];
    const shape rest = shape_of(own->mesh->triangles, t);
    double dd[3][3], along[3], s[3];
    load now;
    load_of(own->mesh, t, &rest, at->y, &now);
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            dd[i][k] = x[k * n + corner[(i + 2) % 3]] - x[k * n + corner[(i + 1) % 3]];
        }
        along[i] = weft__dot(now.d[i], dd[i]);
    }
    const double scale = 2.0 * a + b * CONSTANT(now.of, WEFT__LAG);
    const double bend = 4.0 * a * now.barrier.bend * weft__dot(now.barrier.rate, along);
    law_stiff(now.of, along, s);
    for (size_t i = 0; i < 3; ++i) {
        const size_t j = (i + 1) % 3, k = (i + 2) % 3;
        const double pull = scale * s[i] + bend * now.barrier.rate[i];
        const double across = -a * rest.area * geometric(&rest, now.taut, j, k);
        for (size_t m = 0; m < 3; ++m) {
            const double force = pull * now.d[i][m] + across * dd[i][m];
            out[m * n + corner[j]] -= force;
            out[m * n + corner[k]] += force;
        }
    }
}

void weft__membrane_multiply(const void *own, const weft__state *at, double a, double b,
                             const double *x, double *out)
{
    const weft__membrane *of = own;
    const weft__triangles *tri = of->mesh->triangles;
    for (size_t t = 0; tri != NULL && t < tri->count; ++t) {
        multiply_triangle(of, at, t, a, b, x, out);
    }
}

/* Adds -K_ab of a triangle, then -C_ab, to numbers: with the edges at a and at b,
 * each towards it, K_ab = sum H_mn d_m d_n^T - s_i I, i between the two. */
static void add_link(const load *now, double taut, size_t a, size_t b, double *numbers)
{
    static const size_t plane[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };
    for (size_t x = 0; x < 4; ++x) { /* two edges at either */
        const size_t m = (a + 1 + x / 2) % 3, n = (b + 1 + x % 2) % 3;
        const double sign = x / 2 == x % 2 ? 1.0 : -1.0; /* d[i + 1] ends at i */
        const double k = CONSTANT(now->of, plane[m][n]);
        const double stiff = sign
                             * (2.0 * k
                                + 4.0 * now->barrier.bend * now->barrier.rate[m]
                                      * now->barrier.rate[n]);
        const double damp = sign * CONSTANT(now->of, WEFT__LAG) * k;
        for (size_t j = 0; j < 9; ++j) {
            const double outer = now->d[m][j / 3] * now->d[n][j % 3];
            numbers[j] -= stiff * outer;
            numbers[9 + j] -= damp * outer;
        }
    }
    for (size_t j = 0; j < 3; ++j) {
        numbers[4 * j] += taut;
    }
}

/* Seams join the edges of two pieces to one link. */
size_t weft__membrane_links(const void *own, weft_link *to)
{
    const weft__triangles *of = ((const weft__membrane *)own)->mesh->triangles;
    size_t count = 0;
    for (size_t e = 0; of != NULL && e < of->edges; ++e) {
        const weft__edge *edge = &of->edge_list[e];
        if (edge->sewn == WEFT__NONE || edge->sewn > e) {
            if (to != NULL) {
                to[count] = (weft_link){ of->particle[edge->place[0]],
                                         of->particle[edge->place[1]] };
            }
            ++count;
        }
    }
    return count;
}

int weft__membrane_link_numbers(const void *own, const weft__state *at, double *numbers)
{
    const weft__membrane *of = own;
    const weft__triangles *tri = of->mesh->triangles;
    const size_t all = WEFT_LINK_NUMBERS * weft__membrane_links(own, NULL);
    double bad = 0.0;
    memset(numbers, 0, all * sizeof *numbers);
    for (size_t t = 0; tri != NULL && t < tri->count; ++t) {
        const shape rest = shape_of(tri, t);
        load now;
        load_of(of->mesh, t, &rest, at->y, &now);
        for (size_t i = 0; i < 3; ++i) {
            const size_t j = (i + 1) % 3, k = (i + 2) % 3;
            const bool down = tri->corner[t][j] > tri->corner[t][k];
            const double taut = -rest.area * geometric(&rest, now.taut, j, k);
            add_link(&now, taut, down ? k : j, down ? j : k,
                     numbers + WEFT_LINK_NUMBERS * (size_t)of->link[tri->edge[t][i]]);
        }
    }
    for (size_t j = 0; j < all; ++j) {
        bad += numbers[j] * 0.0;
    }
    return bad == 0.0 ? 0 : 1;
}

bool weft__membrane_number_links(weft__membrane *own, const weft_allocator *memory)
{
    const weft__triangles *of = own->mesh->triangles;
    uint32_t count = 0;
    own->link = weft__alloc(memory, of->edges, sizeof *own->link);
    for (size_t e = 0; own->link != NULL && e < of->edges; ++e) {
        const uint32_t sewn = of->edge_list[e].sewn;
        own->link[e] = sewn < e ? own->link[sewn] : count++;
    }
    return own->link != NULL;
}
