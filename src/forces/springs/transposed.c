/* SPDX-License-Identifier: BSD-3-Clause */
/* transposed.c -- the plain loops of the transposed product of springs;
 * transposed_fast.c has the same bits. */
#include "forces/springs/springs_products.h"

enum { PULL, BY_X, BY_V, PARTS }; /* each of three components */

/* Of a spring, at its end p: its pull, and what p gets from A^T and C^T, where those
 * along dd and dw are weft__spring_change; l.dF by k, c and s to sums. */
static void transposed_turn_back(const weft__springs *own, const weft__spring *at,
                                 const weft__state *of, double by[PARTS][3],
                                 double sums[3])
{
    double dl[3], w[3];
    weft__spring_difference(own->mesh, at, of->along, dl);
    weft__spring_difference(own->mesh, at, of->y + 3 * own->mesh->stride, w);
    const double k = weft__spring_stiffness(at), c = weft__spring_damping(at);
    const double rate = weft__dot(w, at->d), along = weft__dot(dl, at->d);
    const double inverse = 1.0 / (at->square + DBL_MIN), length = sqrt(at->square);
    const double q = weft__spring_tension(at, rate), turn = rate * inverse;
    const double turned = along * inverse, damped = c * turned;
    const double part = (k - (q + c * turn)) * turned, longer = turned * length;
    for (size_t j = 0; j < 3; ++j) {
        by[PULL][j] = q * at->d[j];
        by[BY_X][j] = (part * at->d[j] + damped * w[j]) + q * dl[j];
        by[BY_V][j] = damped * at->d[j];
    }
    sums[0] = at->share * (longer * (length - at->group->rest_length));
    sums[1] = at->share * (turned * rate);
    sums[2] = k * longer;
}

static void transposed_add(weft__totals to, size_t total, size_t column, double number)
{
    to[total][column % WEFT__EVERY] += number;
}

/* All parts that springs have at particle i, and the numbers of those whose left end
 * this is. */
static void turn_particle(const weft__springs *own, const weft__state *at, size_t i,
                          size_t column, weft__totals totals, double all[PARTS][3])
{
    double from[PARTS][3][WEFT_GROUPS] = { 0 }, to[PARTS][3][WEFT_GROUPS] = { 0 };
    weft__spring springs[WEFT__SPRINGS_MAX];
    const size_t count = weft__particle_springs(own, i, at->y, springs);
    for (const weft__spring *of = springs; of < springs + count; ++of) {
        const size_t orientation = of->group->orientation;
        double by[PARTS][3], sums[3];
        transposed_turn_back(own, of, at, by, sums);
        for (size_t k = 0; k < 3 * PARTS; ++k) {
            (of->p == i ? from : to)[k / 3][k % 3][orientation] = by[k / 3][k % 3];
        }
        const bool left = (of->group->first_col > 0 ? of->q : of->p) == i;
        for (size_t k = 0; left && k < 3; ++k) {
            transposed_add(totals, k * WEFT_GROUPS + orientation, column, sums[k]);
        }
    }
    for (size_t k = 0; k < 3 * PARTS; ++k) {
        all[k / 3][k % 3] = weft__springs_sum(from[k / 3][k % 3], to[k / 3][k % 3]);
    }
}

/* By gravity and by drag. */
static void add_body(const weft__mesh *mesh, const weft__state *at, const double *w,
                     size_t i, size_t column, weft__totals to)
{
    const size_t n = mesh->particles;
    const double *l = at->along + i, *v = at->y + 3 * n + i;
    for (size_t k = 0; k < 3 && mesh->inverse_mass[i] != 0.0; ++k) {
        transposed_add(to, 3 * WEFT_GROUPS + k, column, w[(3 + k) * n + i]);
    }
    transposed_add(to, 3 * WEFT_GROUPS + 3, column,
                   v[0] * l[0] + v[n] * l[n] + v[2 * n] * l[2 * n]);
}

void weft__totals_add(const weft__totals totals[2], weft__parameter_gradient *by)
{
    double sums[WEFT__TOTALS] = { 0.0 };
    for (size_t k = 0; k < 2 * WEFT__TOTALS * WEFT__EVERY; ++k) {
        const size_t i = k / WEFT__EVERY % WEFT__TOTALS;
        sums[i] += totals[k / WEFT__EVERY / WEFT__TOTALS][i][k % WEFT__EVERY];
    }
    for (size_t g = 0; g < WEFT_GROUPS; ++g) {
        by->stiffness[g] = -sums[g];
        by->damping[g] = -sums[WEFT_GROUPS + g];
        by->rest_length[g] = sums[2 * WEFT_GROUPS + g];
    }
    for (size_t k = 0; k < 3; ++k) {
        by->gravity[k] = sums[3 * WEFT_GROUPS + k];
    }
    by->drag = -sums[3 * WEFT_GROUPS + 3];
}

/* Writes what particle i has; returns 0, or NaN. */
static double write_particle(const weft__springs *own, const weft__body *body,
                             const weft__state *at, const double *w, size_t i,
                             double all[PARTS][3], double *out, double *net)
{
    const size_t n = own->mesh->particles;
    const bool is_free = own->mesh->inverse_mass[i] != 0.0;
    double bad = 0.0;
    for (size_t k = i; k < 3 * n; k += n) {
        const double moved = is_free ? w[k] : 0.0;
        out[k] = all[BY_X][k / n];
        out[3 * n + k] = moved + (all[BY_V][k / n] - body->drag * at->along[k]);
        bad += (out[k] + out[3 * n + k]) * 0.0;
        if (net != NULL) {
            net[k] = all[PULL][k / n] - body->drag * at->y[3 * n + k];
        }
    }
    return bad;
}

int weft__transposed_loops(const weft__springs *own, const weft__body *body,
                           const weft__state *at, const double *w, double *out,
                           double *net, weft__parameter_gradient *by)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = mesh->particles, cols = weft__width_of(mesh);
    const size_t last = weft__last_columns(cols);
    weft__totals totals[2] = { { { 0.0 } } };
    double bad = 0.0;
    for (size_t first = 0, end; first < cols; first = end) {
        end = first == last               ? cols
              : last - first > WEFT__TILE ? first + WEFT__TILE
                                          : last;
        for (size_t j = 0; j < n / cols * (end - first); ++j) {
            const size_t c = first + j % (end - first);
            const size_t i = j / (end - first) * cols + c;
            double all[PARTS][3];
            turn_particle(own, at, i, c, totals[c >= last], all);
            add_body(mesh, at, w, i, c, totals[c >= last]);
            bad += write_particle(own, body, at, w, i, all, out, net);
        }
    }
    weft__totals_add((const weft__totals *)totals, by);
    return bad == 0.0 ? 0 : 1;
}
