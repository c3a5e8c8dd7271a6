/* SPDX-License-Identifier: BSD-3-Clause */
/* structured.h -- the Jacobian that a weft_structure describes, by the formulas of
 * weft/stepper.h. */
#pragma once

#include <math.h>

#include "weft/stepper.h"

/* dF of spring b, from p to q, with the formula of weft/stepper.h. */
static inline void add_spring(const weft_structure *of, const double *planes, size_t b,
                              const size_t ends[2], const double *y, const double *dy,
                              double *out)
{
    const size_t n = of->particles, m = of->pair_count, p = ends[0], q = ends[1];
    const double *u = planes + b;
    double square = 0.0, wu = 0.0, along = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double d = y[k * n + q] - y[k * n + p];
        square += d * d;
        wu += (y[(k + 3) * n + q] - y[(k + 3) * n + p]) * u[k * m];
    }
    for (size_t k = 0; k < 3; ++k) {
        const double w = y[(k + 3) * n + q] - y[(k + 3) * n + p];
        const double z
            = square > 0.0 ? u[5 * m] / sqrt(square) * (w - wu * u[k * m]) : 0.0;
        along += (u[3 * m] * u[k * m] + z) * (dy[k * n + q] - dy[k * n + p])
                 + u[5 * m] * u[k * m] * (dy[(k + 3) * n + q] - dy[(k + 3) * n + p]);
    }
    for (size_t k = 0; k < 3; ++k) {
        const double change
            = u[k * m] * along + u[4 * m] * (dy[k * n + q] - dy[k * n + p]);
        out[(k + 3) * n + p] += change;
        out[(k + 3) * n + q] -= change;
    }
}

/* C of bending. */
static inline void add_bend_damping(const weft_structure *of, const double *planes,
                                    const double *dy, double *out)
{
    const size_t n = of->particles, first = of->run_count - of->bend_runs;
    size_t b = of->pair_count - of->bend_pairs;
    for (const weft_spring_run *run = of->runs + first; run < of->runs + of->run_count;
         ++run) {
        for (size_t i = 0; i < run->count; ++i, ++b) {
            const double c = of->bend_damping * planes[4 * of->pair_count + b];
            for (size_t k = 3 * n; k < 6 * n; k += n) {
                const double change = c * (dy[k + run->q + i] - dy[k + run->p + i]);
                out[k + run->p + i] += change;
                out[k + run->q + i] -= change;
            }
        }
    }
}

static inline void add_contact(size_t n, const double *blocks, const double *dy,
                               double *out)
{
    static const size_t damping[9] = { 9, 10, 11, 10, 12, 13, 11, 13, 14 };
    for (size_t j = 0; j < 9 * n; ++j) {
        const size_t i = j % n, r = j / n / 3, c = j / n % 3;
        out[(r + 3) * n + i] -= blocks[j] * dy[c * n + i]
                                + blocks[damping[j / n] * n + i] * dy[(c + 3) * n + i];
    }
}

/* -A (dy_p - dy_q) to the rows of p, -A^T (dy_q - dy_p) to those of q. */
static inline void add_link(size_t n, weft_block_coupling at, const double *block,
                            const double *dy, double *out)
{
    for (size_t j = 0; j < 9; ++j) {
        const size_t row = (j / 3 + 3) * n, r = j / 3 * n, c = j % 3 * n;
        const size_t column = (j % 3 + 3) * n;
        out[row + at.p] -= block[j] * (dy[c + at.p] - dy[c + at.q]);
        out[column + at.q] -= block[j] * (dy[r + at.q] - dy[r + at.p]);
    }
}

static inline void add_links(const weft_structure *of, const double *numbers,
                             const double *dy, double *out)
{
    const size_t n = of->particles;
    for (size_t e = 0; e < of->block_coupling_count;
         ++e, numbers += WEFT_COUPLING_NUMBERS) {
        add_link(n, of->block_couplings[e], numbers, dy, out);
        add_link(n, of->block_couplings[e], numbers + 9, dy + 3 * n, out);
    }
    for (size_t e = 0; e < of->scalar_coupling_count; ++e) {
        const weft_scalar_coupling *tie = &of->scalar_couplings[e];
        for (size_t k = 0; k < 3; ++k) {
            const double *x = dy + k * n, *v = x + 3 * n;
            double *to = out + (k + 3) * n;
            const double force
                = tie->k * (x[tie->p] - x[tie->q]) + tie->c * (v[tie->p] - v[tie->q]);
            to[tie->p] -= force;
            to[tie->q] += force;
        }
    }
}

/* out[6 N] = J dy, from the structure and y alone. `room` holds the planes and blocks
 * of linearise and the numbers of linearise_blocks, WEFT_PAIR_PLANES pair_count
 * + WEFT_BLOCK_PLANES N + WEFT_COUPLING_NUMBERS block_coupling_count. Returns as
 * linearise. */
static inline int structure_product(const weft_structure *of, double t, const double *y,
                                    const double *dy, double *room, double *out)
{
    const size_t n = of->particles;
    double *blocks = room + WEFT_PAIR_PLANES * of->pair_count;
    double *numbers = blocks + WEFT_BLOCK_PLANES * n;
    int failed = of->linearise(t, y, room, blocks, of->ctx);
    if (failed == 0 && of->block_coupling_count > 0) {
        failed = of->linearise_blocks(t, y, numbers, of->ctx);
    }
    for (size_t j = 0; j < 3 * n; ++j) {
        out[j] = of->mass[j % n] > 0.0 ? dy[3 * n + j] : 0.0;
        out[3 * n + j] = -of->drag[j % n] * dy[3 * n + j];
    }
    for (size_t r = 0, b = 0; r < of->run_count; ++r) {
        for (size_t i = 0; i < of->runs[r].count; ++i, ++b) {
            const size_t ends[2] = { of->runs[r].p + i, of->runs[r].q + i };
            add_spring(of, room, b, ends, y, dy, out);
        }
    }
    add_bend_damping(of, room, dy, out);
    add_links(of, numbers, dy, out);
    if (of->block_planes > 0) {
        add_contact(n, blocks, dy, out);
    }
    for (size_t j = 0; j < 3 * n; ++j) {
        const double mass = of->mass[j % n];
        out[3 * n + j] = mass > 0.0 ? out[3 * n + j] / mass : 0.0;
    }
    return failed;
}
