/* SPDX-License-Identifier: BSD-3-Clause */
/* transposed.c -- the plain loops of the transposed product of springs;
 * transposed_fast.c has the same bits. */
#include "forces/springs/springs.h"

/* What the end p of a spring gets from A^T and C^T, where those along dd and dw are
 * weft__spring_change; and w.dF by k and by c. */
static void turn_back(const weft__springs *own, const weft__spring *at,
                      const weft__state *of, double by[6], double sums[2])
{
    double dl[3], w[3];
    weft__spring_difference(own->mesh, at, of->along, dl);
    weft__spring_difference(own->mesh, at, of->y + 3 * own->mesh->stride, w);
    const double k = weft__spring_stiffness(at), c = weft__spring_damping(at);
    const double rate = weft__dot(w, at->d), along = weft__dot(dl, at->d);
    const double inverse = 1.0 / (at->square + DBL_MIN), length = sqrt(at->square);
    const double q = weft__spring_tension(at, rate), turn = (c * along) * inverse;
    const double part = ((k - (q + (c * rate) * inverse)) * along) * inverse;
    for (size_t j = 0; j < 3; ++j) {
        by[j] = (turn * w[j] + q * dl[j]) + part * at->d[j];
        by[3 + j] = turn * at->d[j];
    }
    sums[0] = at->share
              * ((along * inverse) * (length * (length - at->group->rest_length)));
    sums[1] = at->share * ((along * inverse) * rate);
}

/* The tile of springs of group g from particle `first` on. */
static void transposed_tile(const weft__springs *own, size_t g, size_t first,
                            size_t count, const weft__state *at, double *out,
                            weft__by_numbers *to)
{
    const size_t n = own->mesh->stride;
    const bool damped = own->groups[g].damping != 0.0;
    double by[6], sum[2], sums[2][WEFT__SUMS] = { { 0.0 } }, total[2] = { 0.0, 0.0 };
    for (size_t c = 0; c < 2 * count; ++c) {
        const weft__spring spring
            = weft__spring_from(own->mesh, &own->groups[g], first + c % count, at->y);
        turn_back(own, &spring, at, by, sum);
        for (size_t k = 0; k < (damped ? 6 : 3); ++k) {
            out[k * n + (c < count ? spring.p : spring.q)]
                += c < count ? by[k] : -by[k];
        }
        for (size_t k = 0; c < count && k < 2; ++k) {
            sums[k][c % WEFT__SUMS] += sum[k];
        }
    }
    for (size_t k = 0; k < WEFT__SUMS; ++k) {
        total[0] += sums[0][k], total[1] += sums[1][k];
    }
    to->stiffness[g] -= total[0];
    to->damping[g] -= total[1];
}

void weft__transposed_tiles(const weft__springs *own, weft__tile_fn *tile,
                            const weft__state *at, double *out, weft__by_numbers *by)
{
    const weft__mesh *mesh = own->mesh;
    for (size_t i = 0; i < mesh->rows * own->group_count; ++i) {
        const size_t r = i / own->group_count, g = i % own->group_count;
        const weft__group *group = &own->groups[g];
        for (size_t c = group->first_col; r < group->end_row && c < group->end_col;
             c += WEFT__TILE) {
            const size_t rest = group->end_col - c;
            tile(own, g, r * mesh->cols + c, rest < WEFT__TILE ? rest : WEFT__TILE, at,
                 out, by);
        }
    }
}

void weft__transposed_loops(const void *own, const weft__state *at, double *out,
                            weft__by_numbers *by)
{
    weft__transposed_tiles(own, transposed_tile, at, out, by);
}
