/* SPDX-License-Identifier: BSD-3-Clause */
#include "network.h"

#include "vectors.h"

enum {
    PIECE = 256, /* springs at a time, whose forces stay in a cache */
    LANES = 64,  /* partial sums */
};

void weft__network_take(weft__network *self, weft__pile *pile)
{
    self->point = weft__pile_take(pile, self->n, 6 * sizeof(double));
    self->inverse = weft__pile_take(pile, self->n, 6 * sizeof(double));
    self->spring_entries = weft__pile_take(pile, self->pair_count, 6 * sizeof(double));
    self->block_entries
        = weft__pile_take(pile, self->block_coupling_count, 9 * sizeof(double));
}

/* ---- the diagonal ---------------------------------------------------------------- */

WIDE static void add_to(double *to, const double *from, size_t count)
{
    ELEMENTWISE
    for (size_t i = 0; i < count; ++i) {
        to[i] += from[i];
    }
}

/* Blocks of springs have no negative diagonal; bending's have no other entries. */
WIDE static void add_positive(double *to, const double *from, size_t count)
{
    ELEMENTWISE
    for (size_t i = 0; i < count; ++i) {
        to[i] += from[i] > 0.0 ? from[i] : 0.0;
    }
}

/* The symmetric part of each link's block: the others' sum is symmetric. */
static void add_couplings_diagonal(const weft__network *self, double *d)
{
    static const size_t place[6] = { 0, 1, 2, 4, 5, 8 };
    static const size_t mirror[6] = { 0, 3, 6, 4, 7, 8 }, square[3] = { 0, 3, 5 };
    for (size_t e = 0; e < self->block_coupling_count; ++e) {
        const double *a = self->block_entries + 9 * e;
        for (size_t k = 0; k < 6; ++k) {
            const double entry = 0.5 * (a[place[k]] + a[mirror[k]]);
            d[k * self->n + self->block_couplings[e].p] += entry;
            d[k * self->n + self->block_couplings[e].q] += entry;
        }
    }
    for (size_t e = 0; e < self->scalar_coupling_count; ++e) {
        const weft_scalar_coupling *coupling = &self->scalar_couplings[e];
        const double entry
            = self->scalar_k * coupling->k + self->scalar_c * coupling->c;
        for (size_t k = 0; k < 3; ++k) {
            d[square[k] * self->n + coupling->p] += entry;
            d[square[k] * self->n + coupling->q] += entry;
        }
    }
}

static void diagonal(const weft__network *self, double *d)
{
    memcpy(d, self->point, 6 * self->n * sizeof *d);
    for (size_t plane = 0; plane < 6; ++plane) {
        const double *entries = self->spring_entries + plane * self->pair_count;
        double *to = d + plane * self->n;
        const bool square = plane == 0 || plane == 3 || plane == 5; /* xx, yy, zz */
        for (size_t r = 0; r < self->run_count; ++r) {
            const weft_spring_run *run = &self->runs[r];
            (square ? add_positive : add_to)(to + run->p, entries, run->count);
            (square ? add_positive : add_to)(to + run->q, entries, run->count);
            entries += run->count;
        }
    }
    add_couplings_diagonal(self, d);
}

/* In place. A block of 0 stays 0. */
WIDE static void invert(double *planes, size_t n)
{
    double *xx = planes, *xy = xx + n, *xz = xy + n;
    double *yy = xz + n, *yz = yy + n, *zz = yz + n;
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        const double a = xx[i], b = xy[i], c = xz[i], d = yy[i], e = yz[i], f = zz[i];
        const double aa = d * f - e * e, bb = c * e - b * f, cc = b * e - c * d;
        const double det = a * aa + b * bb + c * cc;
        const double scale = det != 0.0 ? 1.0 / det : 0.0;
        xx[i] = aa * scale;
        xy[i] = bb * scale;
        xz[i] = cc * scale;
        yy[i] = (a * f - c * c) * scale;
        yz[i] = (b * c - a * e) * scale;
        zz[i] = (a * d - b * b) * scale;
    }
}

double weft__network_invert(weft__network *self, const double *mass)
{
    const size_t n = self->n;
    double *d = self->inverse, most = 0.0;
    diagonal(self, d);
    for (size_t k = 0; k < self->held_count; ++k) {
        for (size_t plane = 0; plane < 6; ++plane) {
            d[plane * n + self->held[k]] = 0.0;
        }
    }
    for (size_t i = 0; mass != NULL && i < n; ++i) {
        const double trace = d[i] + d[3 * n + i] + d[5 * n + i];
        most = mass[i] > 0.0 && trace > most * mass[i] ? trace / mass[i] : most;
    }
    invert(d, n);
    return most;
}

/* ---- products -------------------------------------------------------------------- */

WIDE static void block_product(size_t n, const double *a, const double *x, double *y)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        const double b = x[i], c = x[n + i], d = x[2 * n + i];
        y[i] = a[i] * b + a[n + i] * c + a[2 * n + i] * d;
        y[n + i] = a[n + i] * b + a[3 * n + i] * c + a[4 * n + i] * d;
        y[2 * n + i] = a[2 * n + i] * b + a[4 * n + i] * c + a[5 * n + i] * d;
    }
}

void weft__network_precondition(const weft__network *self, const double *r, double *z)
{
    block_product(self->n, self->inverse, r, z);
}

/* The forces of `count` springs on their particles p, in f[3][PIECE]. */
WIDE static void spring_forces(const double *a, size_t stride, const double *x,
                               const double *to, size_t n, size_t count,
                               double f[3][PIECE])
{
    ELEMENTWISE
    for (size_t i = 0; i < count; ++i) {
        const double b = x[i] - to[i], c = x[n + i] - to[n + i];
        const double d = x[2 * n + i] - to[2 * n + i];
        const double xy = a[stride + i], xz = a[2 * stride + i], yz = a[4 * stride + i];
        f[0][i] = a[i] * b + xy * c + xz * d;
        f[1][i] = xy * b + a[3 * stride + i] * c + yz * d;
        f[2][i] = xz * b + yz * c + a[5 * stride + i] * d;
    }
}

/* Blocks scale factor u u^T + scale_q q I, with the factor of a plane. */
typedef struct part {
    const double *planes;
    size_t plane;
    double scale, scale_q;
} part;

WIDE static void part_forces(const part *of, const double *a, size_t stride,
                             const double *x, const double *to, size_t n, size_t count,
                             double f[3][PIECE])
{
    const double scale = of->scale, scale_q = of->scale_q;
    const double *factor = a + of->plane * stride;
    ELEMENTWISE
    for (size_t i = 0; i < count; ++i) {
        const double b = x[i] - to[i], c = x[n + i] - to[n + i];
        const double d = x[2 * n + i] - to[2 * n + i];
        const double ux = a[i], uy = a[stride + i], uz = a[2 * stride + i];
        const double along = scale * factor[i] * (ux * b + uy * c + uz * d);
        const double across = scale_q * a[4 * stride + i];
        f[0][i] = along * ux + across * b;
        f[1][i] = along * uy + across * c;
        f[2][i] = along * uz + across * d;
    }
}

WIDE static void pull(double *p, double *q, size_t n, size_t count, double f[3][PIECE])
{
    for (size_t plane = 0; plane < 3; ++plane) {
        double *to = p + plane * n;
        const double *force = f[plane];
        ELEMENTWISE
        for (size_t i = 0; i < count; ++i) {
            to[i] += force[i];
        }
        to = q + plane * n;
        ELEMENTWISE
        for (size_t i = 0; i < count; ++i) {
            to[i] -= force[i];
        }
    }
}

static void add_springs(const weft__network *self, const part *of, const double *x,
                        double *y)
{
    const size_t n = self->n, stride = self->pair_count;
    double f[3][PIECE];
    for (size_t r = 0, at = 0; r < self->run_count; at += self->runs[r++].count) {
        const weft_spring_run *run = &self->runs[r];
        for (size_t i = 0; i < run->count; i += PIECE) {
            const size_t count = run->count - i < PIECE ? run->count - i : PIECE;
            const size_t p = run->p + i, q = run->q + i;
            if (of == NULL) {
                spring_forces(self->spring_entries + at + i, stride, x + p, x + q, n,
                              count, f);
            } else {
                part_forces(of, of->planes + at + i, stride, x + p, x + q, n, count, f);
            }
            pull(y + p, y + q, n, count, f);
        }
    }
}

void weft__network_add_stiffness(const weft__network *self, const double *planes,
                                 double scale, const double *x, double *y)
{
    add_springs(self, &(part){ planes, 3, scale, scale }, x, y);
}

void weft__network_add_damping(const weft__network *self, const double *planes,
                               double scale, const double *x, double *y)
{
    add_springs(self, &(part){ planes, 5, scale, 0.0 }, x, y);
}

void weft__network_add_block_couplings(const weft__network *self, const double *blocks,
                                       size_t stride, double scale, const double *x,
                                       double *y)
{
    const size_t n = self->n;
    for (size_t e = 0; e < self->block_coupling_count; ++e) {
        const double *a = blocks + stride * e;
        const size_t p = self->block_couplings[e].p, q = self->block_couplings[e].q;
        double d[3];
        for (size_t k = 0; k < 3; ++k) {
            d[k] = scale * (x[k * n + p] - x[k * n + q]);
        }
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + p] += a[3 * k] * d[0] + a[3 * k + 1] * d[1] + a[3 * k + 2] * d[2];
            y[k * n + q] -= a[k] * d[0] + a[k + 3] * d[1] + a[k + 6] * d[2];
        }
    }
}

void weft__network_add_scalar_couplings(const weft__network *self, double k, double c,
                                        const double *x, double *y)
{
    for (size_t plane = 0; plane < 3; ++plane, x += self->n, y += self->n) {
        for (size_t e = 0; e < self->scalar_coupling_count; ++e) {
            const weft_scalar_coupling *coupling = &self->scalar_couplings[e];
            const double force = (k * coupling->k + c * coupling->c)
                                 * (x[coupling->p] - x[coupling->q]);
            y[coupling->p] += force;
            y[coupling->q] -= force;
        }
    }
}

void weft__network_times(const weft__network *self, const double *x, double *y)
{
    const size_t n = self->n;
    block_product(n, self->point, x, y);
    add_springs(self, NULL, x, y);
    weft__network_add_block_couplings(self, self->block_entries, 9, 1.0, x, y);
    weft__network_add_scalar_couplings(self, self->scalar_k, self->scalar_c, x, y);
    for (size_t k = 0; k < self->held_count; ++k) {
        const size_t i = self->held[k];
        y[i] = y[n + i] = y[2 * n + i] = 0.0;
    }
}

/* ---- single blocks --------------------------------------------------------------- */

size_t weft__network_edges(const weft__network *self, uint32_t (*ends)[2])
{
    size_t at = 0;
    for (size_t r = 0; ends != NULL && r < self->run_count; ++r) {
        const weft_spring_run *run = &self->runs[r];
        for (size_t i = 0; i < run->count; ++i, ++at) {
            ends[at][0] = (uint32_t)(run->p + i), ends[at][1] = (uint32_t)(run->q + i);
        }
    }
    for (size_t e = 0; ends != NULL && e < self->block_coupling_count; ++e, ++at) {
        ends[at][0] = self->block_couplings[e].p,
        ends[at][1] = self->block_couplings[e].q;
    }
    for (size_t e = 0; ends != NULL && e < self->scalar_coupling_count; ++e, ++at) {
        ends[at][0] = self->scalar_couplings[e].p,
        ends[at][1] = self->scalar_couplings[e].q;
    }
    return self->pair_count + self->block_coupling_count + self->scalar_coupling_count;
}

static void symmetric(const double *planes, size_t n, size_t i, double block[9])
{
    static const size_t plane[9] = { 0, 1, 2, 1, 3, 4, 2, 4, 5 };
    for (size_t k = 0; k < 9; ++k) {
        block[k] = planes[plane[k] * n + i];
    }
}

void weft__network_point(const weft__network *self, size_t i, double block[9])
{
    symmetric(self->point, self->n, i, block);
}

void weft__network_inverse(const weft__network *self, size_t i, double block[9])
{
    symmetric(self->inverse, self->n, i, block);
}

void weft__network_block(const weft__network *self, size_t half, double block[9])
{
    const size_t e = half / 2, blocks = self->pair_count + self->block_coupling_count;
    if (e < self->pair_count) {
        symmetric(self->spring_entries, self->pair_count, e, block);
    } else if (e < blocks) {
        const double *a = self->block_entries + 9 * (e - self->pair_count);
        for (size_t k = 0; k < 9; ++k) {
            block[k] = a[half % 2 == 0 ? k : k % 3 * 3 + k / 3];
        }
    } else {
        const weft_scalar_coupling *coupling = &self->scalar_couplings[e - blocks];
        const double entry
            = self->scalar_k * coupling->k + self->scalar_c * coupling->c;
        for (size_t k = 0; k < 9; ++k) {
            block[k] = k % 4 == 0 ? entry : 0.0;
        }
    }
}

/* ---- vectors --------------------------------------------------------------------- */

WIDE static double dot(size_t n, const double *a, const double *b)
{
    double lane[LANES] = { 0.0 }, sum = 0.0;
    size_t at = 0;
    for (; at + LANES <= n; at += LANES) {
        for (size_t i = 0; i < LANES; ++i) {
            lane[i] += a[at + i] * b[at + i];
        }
    }
    for (size_t i = 0; at + i < n; ++i) {
        lane[i] += a[at + i] * b[at + i];
    }
    for (size_t i = 0; i < LANES; ++i) {
        sum += lane[i];
    }
    return sum;
}

WIDE static void scale(size_t n, double a, const double *x, double *y)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        y[i] = a * x[i];
    }
}

WIDE static void mix(size_t n, double a, const double *x, double b, double *y)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        y[i] = a * x[i] + b * y[i];
    }
}

double weft__vector_dot(size_t n, const double *a, const double *b)
{
    return dot(n, a, b);
}

void weft__vector_scale(size_t n, double a, const double *x, double *y)
{
    scale(n, a, x, y);
}

void weft__vector_mix(size_t n, double a, const double *x, double b, double *y)
{
    mix(n, a, x, b, y);
}
