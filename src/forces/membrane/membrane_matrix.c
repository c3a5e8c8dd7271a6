/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_matrix.c -- the matrix of a membrane in a state, never negative (stress
 * below 0 is left out, and the barrier has its curvature in r alone): the 3 x 3 blocks
 * between particles that share a triangle or, along arcs, a patch. */
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "base/plane.h"
#include "forces/membrane/membrane_law.h"

/* Particles on which a triangle's edges depend: corners, and parts of three arcs. */
enum { DOFS = 3 + 3 * WEFT__CURVE_PARTS };

/* One of them: how it moves the edges. */
typedef struct dof {
    uint32_t particle;
    double of[3][3];   /* d(|d_e|^2 + |h_e|^2) / 2 of edge e by the particle [m] */
    double ends[3];    /* of d_e */
    double share[3];   /* of h_e */
    double barrier[3]; /* dr of the barrier, by 2 [1/m] */
} dof;

/* Those of triangle t, corners first; their number. */
static size_t dofs_of(const weft__membrane *own, const double *y, size_t t,
                      const weft__load *now, dof *to)
{
    const weft__triangles *tri = own->mesh->triangles;
    const weft__edge_slopes *rows = &own->arc.rows;
    size_t count = 3;
    for (size_t c = 0; c < 3; ++c) {
        to[c] = (dof){ .particle = tri->corner[t][c] };
        for (size_t x = 1; x < 3; ++x) { /* d[c + 1] ends at c, d[c + 2] begins there */
            const size_t e = (c + x) % 3;
            to[c].ends[e] = x == 1 ? 1.0 : -1.0;
            for (size_t k = 0; k < 3; ++k) {
                to[c].of[e][k] = to[c].ends[e] * now->d[e][k];
                to[c].barrier[k] += now->barrier.rate[e] * to[c].of[e][k];
            }
        }
    }
    for (size_t e = 0; rows->first != NULL && e < 3; ++e) {
        const size_t edge = tri->edge[t][e];
        double h[3];
        weft__arc_row(own, y, edge, h);
        for (size_t j = rows->first[edge]; j < rows->first[edge + 1]; ++j) {
            size_t at = 0;
            while (at < count && to[at].particle != rows->particle[j]) {
                ++at;
            }
            if (at == count) {
                to[count++] = (dof){ .particle = rows->particle[j] };
            }
            to[at].share[e] += rows->share[j];
            for (size_t k = 0; k < 3; ++k) {
                to[at].of[e][k] += rows->share[j] * h[k];
            }
        }
    }
    return count;
}

/* Subtracts K_ab of a triangle, then C_ab, from numbers. pulled: K by what b moves; s:
 * of edges, without what presses. */
static void add_coupling(const weft__load *now, const double s[3], const dof *a,
                         const dof *b, double pulled[3][3], double *numbers)
{
    double across = 0.0;
    for (size_t e = 0; e < 3; ++e) {
        across += s[e] * (a->ends[e] * b->ends[e])
                  + fmax(s[e], 0.0) * (a->share[e] * b->share[e]);
    }
    for (size_t j = 0; j < 9; ++j) {
        const size_t r = j / 3, c = j % 3;
        const double outer = a->of[0][r] * pulled[0][c] + a->of[1][r] * pulled[1][c]
                             + a->of[2][r] * pulled[2][c];
        numbers[j] -= 2.0 * outer
                      + 4.0 * now->barrier.bend * (a->barrier[r] * b->barrier[c])
                      + (r == c ? across : 0.0);
        numbers[9 + j] -= CONSTANT(now->of, WEFT__LAG) * outer;
    }
}

size_t weft__membrane_couplings(const void *own, weft_block_coupling *to)
{
    const weft__membrane *of = own;
    const size_t n = of->mesh->particles;
    for (size_t p = 0; to != NULL && p < n; ++p) {
        for (size_t j = of->coupling_first[p]; j < of->coupling_first[p + 1]; ++j) {
            to[j] = (weft_block_coupling){ (uint32_t)p, of->coupling[j] };
        }
    }
    return of->coupling_first[n];
}

/* The numbers of the coupling between two particles. */
static double *numbers_of(const weft__membrane *of, size_t p, uint32_t q,
                          double *numbers)
{
    size_t low = of->coupling_first[p], high = of->coupling_first[p + 1];
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (of->coupling[middle] <= q) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return numbers + WEFT_COUPLING_NUMBERS * low;
}

int weft__membrane_coupling_numbers(const void *own, const weft__state *at,
                                    double *numbers)
{
    const weft__membrane *of = own;
    const weft__triangles *tri = of->mesh->triangles;
    const size_t all = WEFT_COUPLING_NUMBERS * weft__membrane_couplings(own, NULL);
    double bad = 0.0;
    memset(numbers, 0, all * sizeof *numbers);
    for (size_t t = 0; t < tri->count; ++t) {
        const weft__rest rest = weft__rest_of(tri, t);
        dof dofs[DOFS];
        double s[3];
        weft__load now;
        weft__load_of(of, t, &rest, at->y, &now);
        const size_t count = dofs_of(of, at->y, t, &now, dofs);
        for (size_t i = 0; i < 3; ++i) {
            s[i] = -rest.area
                   * weft__geometric(&rest, now.taut, (i + 1) % 3, (i + 2) % 3);
        }
        for (size_t j = 0; j < count; ++j) {
            double pulled[3][3];
            for (size_t k = 0; k < 3; ++k) {
                double(*by)[3] = dofs[j].of;
                double stiff[3];
                law_stiff(now.of, (const double[3]){ by[0][k], by[1][k], by[2][k] },
                          stiff);
                pulled[0][k] = stiff[0], pulled[1][k] = stiff[1],
                pulled[2][k] = stiff[2];
            }
            for (size_t i = 0; i < count; ++i) {
                const uint32_t p = dofs[i].particle, q = dofs[j].particle;
                if (p < q) {
                    add_coupling(&now, s, &dofs[i], &dofs[j], pulled,
                                 numbers_of(of, p, q, numbers));
                }
            }
        }
    }
    for (size_t j = 0; j < all; ++j) {
        bad += numbers[j] * 0.0;
    }
    return bad == 0.0 ? 0 : 1;
}

/* Couplings of particle p to the dofs above it of triangle t. */
static bool take_couplings(weft__membrane *own, const weft_allocator *memory,
                           uint32_t p, uint32_t t, uint32_t *seen, size_t *room)
{
    const weft__triangles *of = own->mesh->triangles;
    const weft__edge_slopes *rows = &own->arc.rows;
    size_t *count = &own->coupling_first[p + 1];
    for (size_t c = 0; t != WEFT__NONE && c < 3; ++c) {
        const size_t e = of->edge[t][c];
        const size_t first = rows->first != NULL ? rows->first[e] : 0;
        const size_t parts = rows->first != NULL ? rows->first[e + 1] - first : 0;
        for (size_t j = 0; j <= parts; ++j) {
            const uint32_t q
                = j == 0 ? of->corner[t][c] : rows->particle[first + j - 1];
            if (q <= p || seen[q] == p + 1) {
                continue;
            }
            if (!weft__reserve(memory, &own->coupling, room, *count + 1,
                               sizeof *own->coupling)) {
                return false;
            }
            seen[q] = p + 1;
            own->coupling[(*count)++] = q;
        }
    }
    return true;
}

bool weft__membrane_list_couplings(weft__membrane *own, const weft_allocator *memory)
{
    const weft__triangles *of = own->mesh->triangles;
    const uint32_t n = (uint32_t)own->mesh->particles;
    const size_t *begin = own->arc.begin;
    size_t room = 0;
    uint32_t *seen = weft__zeroed(memory, n, sizeof *seen);
    own->coupling_first = weft__zeroed(memory, n + 1, sizeof *own->coupling_first);
    bool made = seen != NULL && own->coupling_first != NULL;
    for (uint32_t p = 0; made && p < n; ++p) {
        const size_t first = own->coupling_first[p];
        own->coupling_first[p + 1] = first;
        for (size_t j = of->around_first[p]; made && j < of->around_first[p + 1]; ++j) {
            made = take_couplings(own, memory, p, of->around[j], seen, &room);
        }
        for (size_t j = begin != NULL ? begin[p] : 0;
             made && begin != NULL && j < begin[p + 1]; ++j) {
            const uint32_t *both = of->edge_list[own->arc.part[j].item / 2].triangle;
            made = take_couplings(own, memory, p, both[0], seen, &room)
                   && take_couplings(own, memory, p, both[1], seen, &room);
        }
        if (made && own->coupling_first[p + 1] > first) {
            qsort(own->coupling + first, own->coupling_first[p + 1] - first,
                  sizeof *own->coupling, weft__ascending);
        }
    }
    weft__free(memory, seen);
    return made;
}
