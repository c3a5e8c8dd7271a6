/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_bounds.c -- bounds on the stiffness of a membrane, by norms of the blocks
 * K_ab of each triangle, derived in docs/theory/stability.md, "The bound". An
 * edge's arc, share x, is bounded by |share x|^2 <= r sum of share_i / d_i |x_i|^2, r =
 * sum of share d. */
#include <string.h>

#include "base/memory.h"
#include "forces/bounds.h"
#include "forces/membrane/membrane_law.h"

/* Without a state, stretches lie between 0 and this. */
#define MOST_STRETCH 1.1

/* Without a state an arc turns by at most this [rad]; e above. */
#define MOST_TURN 0.25
#define SHARE     0.0625

enum { STEPS = 3 };

weft__rest weft__rest_of(const weft__triangles *of, size_t t)
{
    weft__rest out = { .fabric = &of->fabrics[of->fabric[t]], .area = of->area[t] };
    for (size_t a = 0; a < 3; ++a) {
        const double *from = weft__rest_at(of, t, (a + 1) % 3);
        const double *to = weft__rest_at(of, t, (a + 2) % 3);
        out.grad[a][0] = (from[1] - to[1]) / (2.0 * out.area);
        out.grad[a][1] = (to[0] - from[0]) / (2.0 * out.area);
    }
    return out;
}

/* [1/m^2 N/m] The largest stretch of V_a^T C V_b. */
static double membrane_bounds_norm_of(const weft__rest *of, size_t a, size_t b)
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

void weft__load_of(const weft__membrane *own, size_t t, const weft__rest *of,
                   const double *y, weft__load *out)
{
    const weft__mesh *mesh = own->mesh;
    const weft__triangles *tri = mesh->triangles;
    const size_t n = mesh->particles;
    double part[3][3], e[3] = { 0.0, 0.0, 0.0 }, chord[3], stress[3], unused[3];
    double h[3];
    weft__membrane_shape(tri, t, part);
    weft__membrane_shaped(tri, t, (const double(*)[3])part, out->of);
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
        out->arc[i] = 0.0;
        if (own->arc.begin != NULL) {
            weft__arc_row(own, y, tri->edge[t][i], h);
            out->arc[i] = weft__dot(h, h);
        }
    }
    memcpy(chord, e, sizeof chord);
    for (size_t j = 0; j < 9; ++j) {
        const double arc = out->arc[j / 3] - weft__arc_bow(own, t, j / 3);
        e[j % 3] += arc * part[j / 3][j % 3];
    }
    weft__membrane_stress(of->fabric, e, stress);
    (void)above(stress, 1.0, out->taut);
    (void)above(stress, -1.0, out->slack);
    out->square = 1.0 + 2.0 * above(chord, 1.0, unused);
    (void)weft__membrane_barrier(out->of, out->q, &out->barrier);
}

/* The same for all stretches in [0, MOST_STRETCH]. The strain is e I - P, P >= 0: in
 * most fabrics C:P >= 0, and S <= e C:I. In others S12 and what the coupling takes from
 * S11 and S22 are bounded apart. */
static void any_load(const weft__triangles *tri, size_t t, const weft__rest *of,
                     weft__load *out)
{
    const weft_fabric *c = of->fabric;
    const double warp = c->stretch[0], weft = c->stretch[1], e12 = c->coupling;
    const double e = 0.5 * (MOST_STRETCH * MOST_STRETCH - 1.0), least = -0.5;
    const bool usual = e12 >= 0.0 && sqrt(warp * weft) + e12 >= 2.0 * c->shear;
    const double turn = fmax(e12 * e, e12 * least);
    const double shear = usual ? 0.0 : c->shear * (e - least);
    weft__membrane_constants(tri, t, out->of);
    out->square = MOST_STRETCH * MOST_STRETCH;
    out->taut[0] = weft * e + turn + shear;
    out->taut[1] = warp * e + turn + shear;
    out->compression = -least * (fmax(warp, weft) + fabs(e12)) + c->shear * (e - least);
}

/* [N/m] The part of a triangle's S of the edge opposite corner i that pulls, and the
 * part that presses, absolutely. */
static void arc_pulls(const weft__rest *of, const weft__load *at, bool any, size_t i,
                      double part[2])
{
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double *g = of->grad[j], *h = of->grad[k];
    const double both = sqrt((g[0] * g[0] + g[1] * g[1]) * (h[0] * h[0] + h[1] * h[1]));
    const double dot = g[0] * h[0] + g[1] * h[1];
    if (any) {
        const double taut = 0.5 * of->area * fmax(at->taut[0], at->taut[1]);
        const double slack = 0.5 * of->area * at->compression;
        part[0] = taut * (both - dot) + slack * (both + dot);
        part[1] = taut * (both + dot) + slack * (both - dot);
    } else {
        const double taut = -of->area * weft__geometric(of, at->taut, j, k);
        const double slack = -of->area * weft__geometric(of, at->slack, j, k);
        part[0] = fmax(taut, 0.0) + fmax(-slack, 0.0);
        part[1] = fmax(-taut, 0.0) + fmax(slack, 0.0);
    }
}

/* [N/m] |K_ab| of the barrier: its curvature in r, and twice the largest eigenvalue of
 * the slope by that of r, by the edges. */
static double barrier_norm(const weft__load *at, size_t a, size_t b)
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

/* Parts of a bound, per unit mass [1/s^2]. */
typedef struct bound_parts {
    double stiff, taut, slack;
} bound_parts;

/* Those of corner a of triangle t. */
static bound_parts membrane_bounds_parts_of(const weft__membrane *own,
                                            const weft__state *at, size_t t, size_t a,
                                            const weft__rest *rest)
{
    const weft__mesh *mesh = own->mesh;
    const uint32_t *corner = mesh->triangles->corner[t];
    const double *weight = own->weight;
    bound_parts sum = { 0.0, 0.0, 0.0 };
    weft__load now;
    if (at->y != NULL) {
        weft__load_of(own, t, rest, at->y, &now);
    } else {
        any_load(mesh->triangles, t, rest, &now);
    }
    for (size_t b = 0; b < 3; ++b) {
        if (mesh->pin[corner[b]] != 0) {
            continue;
        }
        const double share = weight[corner[b]] / weight[corner[a]]
                             * mesh->inverse_mass[corner[a]] * (1.0 + WEFT__ROUNDOFF);
        const double area = share * rest->area;
        sum.stiff += (own->arc.begin != NULL ? 1.0 + SHARE : 1.0)
                     * (area * now.square * membrane_bounds_norm_of(rest, a, b));
        if (at->y == NULL) { /* a bound of |g_a.S g_b| where S is one */
            const double *g = rest->grad[a], *h = rest->grad[b];
            sum.taut += area
                        * (fabs(g[0] * now.taut[0] * h[0])
                           + fabs(g[1] * now.taut[1] * h[1]));
            continue;
        }
        sum.taut += area * fabs(weft__geometric(rest, now.taut, a, b))
                    + share * barrier_norm(&now, a, b);
        sum.slack += area * fabs(weft__geometric(rest, now.slack, a, b));
    }
    return sum;
}

/* Those that triangle t has of one of its arcs, of which i is a part by `share`. */
static bound_parts arc_parts(const weft__membrane *own, const weft__state *at, size_t t,
                             const weft__rest *rest, const weft__arc_part *part,
                             size_t i)
{
    const weft__triangles *tri = own->mesh->triangles;
    const uint32_t *edge = tri->edge[t];
    const size_t e = part->item / 2, k = edge[0] == e ? 0 : edge[1] == e ? 1 : 2;
    static const size_t plane[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };
    double row = 0.0, pulls[2];
    weft__load now;
    if (at->y != NULL) {
        weft__load_of(own, t, rest, at->y, &now);
    } else {
        any_load(tri, t, rest, &now);
        now.arc[k] = MOST_TURN * MOST_TURN / 12.0 * CONSTANT(now.of, WEFT__SQUARE + k);
        const double bow = weft__arc_bow(own, t, k);
        now.arc[k] += bow > 0.0 ? bow + 2.0 * sqrt(bow * now.arc[k]) : 0.0;
    }
    for (size_t j = 0; j < 3; ++j) {
        row += fabs(CONSTANT(now.of, WEFT__STIFF + plane[k][j]));
    }
    arc_pulls(rest, &now, at->y == NULL, k, pulls);
    const double scale = fabs(part->share) * own->arc.weight_sum[e] / own->weight[i]
                         * own->mesh->inverse_mass[i] * (1.0 + WEFT__ROUNDOFF);
    return (bound_parts){ scale * (2.0 * (1.0 + 1.0 / SHARE) * row * now.arc[k]),
                          scale * pulls[0], scale * pulls[1] };
}

static void add_parts(const weft__sides *sides, double damping, const bound_parts *sum,
                      double (*sums)[6])
{
    for (size_t s = 0; s < sides->count; ++s) {
        const double *direction = sides->direction[s];
        const double scale = direction[0] + direction[1] * damping;
        weft__bound_add(sums[s], fmax(0.0, scale) * sum->stiff
                                     + fmax(0.0, direction[0]) * sum->taut
                                     + fmax(0.0, -direction[0]) * sum->slack);
    }
}

void weft__membrane_bound(const void *own, const weft__state *at, size_t i,
                          const weft__sides *sides, double (*sums)[6])
{
    const weft__membrane *of = own;
    const weft__triangles *tri = of->mesh->triangles;
    for (size_t j = tri->around_first[i]; j < tri->around_first[i + 1]; ++j) {
        const uint32_t t = tri->around[j], *corner = tri->corner[t];
        const size_t a = corner[0] == i ? 0 : corner[1] == i ? 1 : 2;
        const weft__rest rest = weft__rest_of(tri, t);
        const bound_parts sum = membrane_bounds_parts_of(of, at, t, a, &rest);
        add_parts(sides, rest.fabric->damping[0], &sum, sums);
    }
    const size_t *begin = of->arc.begin;
    for (size_t j = begin != NULL ? begin[i] : 0; begin != NULL && j < begin[i + 1];
         ++j) {
        const weft__arc_part *part = &of->arc.part[j];
        for (size_t k = 0; k < 2 && part->item % 2 == 0; ++k) {
            const uint32_t t = tri->edge_list[part->item / 2].triangle[k];
            if (t != WEFT__NONE) {
                const weft__rest rest = weft__rest_of(tri, t);
                const bound_parts sum = arc_parts(of, at, t, &rest, part, i);
                add_parts(sides, rest.fabric->damping[0], &sum, sums);
            }
        }
    }
}

void weft__membrane_ratios(const void *own, weft__sides *to)
{
    const weft__triangles *of = ((const weft__membrane *)own)->mesh->triangles;
    for (size_t f = 0; f < of->fabric_count; ++f) {
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
        const weft__rest rest = weft__rest_of(of, t);
        for (size_t a = 0; a < 3; ++a) {
            for (size_t b = 0; b < 3; ++b) {
                to[of->corner[t][a]] += rest.area * membrane_bounds_norm_of(&rest, a, b)
                                        * d[of->corner[t][b]];
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
