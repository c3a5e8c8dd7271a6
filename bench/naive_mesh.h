/* SPDX-License-Identifier: BSD-3-Clause */
/* naive_mesh.h -- the forces of a mesh as a first program has them: one loop over
 * triangles that know their corners and constants, one over the rows of the bending
 * matrix, particles x y z x y z ... What the fast forms of triangles are measured
 * against. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct naive_triangle {
    uint32_t corner[3];
    double stiff[6]; /* [N/m^3] K: 00, 11, 22, 01, 02, 12 */
    double square[3], least, lag, guard;
} naive_triangle;

typedef struct naive_mesh {
    size_t particles, triangles;
    const naive_triangle *triangle;
    const size_t *row; /* NULL: no bending */
    const uint32_t *column;
    const double *entry; /* [N/m] */
    bool damped;
    double bend_damping;        /* [s] */
    const double *inverse_mass; /* [1/kg] */
    double gravity[3], wind[3]; /* [m/s^2], [m/s] */
    double drag, wind_drag;     /* [kg/s], [kg/(m^2 s)] */
} naive_mesh;

typedef struct naive_vec {
    double x, y, z;
} naive_vec;

static inline naive_vec naive_minus(naive_vec a, naive_vec b)
{
    return (naive_vec){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline double naive_dot(naive_vec a, naive_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline void naive_push(naive_vec *force, double s, naive_vec a, double t,
                              naive_vec b)
{
    force->x += s * a.x + t * b.x;
    force->y += s * a.y + t * b.y;
    force->z += s * a.z + t * b.z;
}

static inline void naive_pull(const naive_triangle *t, const double square[3],
                              const double q[3], double s[3])
{
    const double *k = t->stiff;
    s[0] = k[0] * q[0] + k[3] * q[1] + k[4] * q[2];
    s[1] = k[3] * q[0] + k[1] * q[1] + k[5] * q[2];
    s[2] = k[4] * q[0] + k[5] * q[1] + k[2] * q[2];
    const double both = square[0] + square[1] - square[2];
    const double area = 4.0 * square[0] * square[1] - both * both;
    if (area < t->least) {
        const double r = area / t->least, z = 1.0 - r;
        const double all = square[0] + square[1] + square[2];
        const double push
            = -4.0 * t->guard * z * z * z * (4.0 * r + z) / (r * r * t->least);
        for (int i = 0; i < 3; ++i) {
            s[i] += push * (all - 2.0 * square[i]);
        }
    }
}

static inline void naive_membrane(const naive_mesh *of, const naive_vec *x,
                                  naive_vec *f)
{
    const naive_vec *v = x + of->particles;
    for (size_t j = 0; j < of->triangles; ++j) {
        const naive_triangle *t = &of->triangle[j];
        const uint32_t a = t->corner[0], b = t->corner[1], c = t->corner[2];
        const naive_vec d0 = naive_minus(x[c], x[b]), d1 = naive_minus(x[a], x[c]),
                        d2 = naive_minus(x[b], x[a]);
        const double square[3]
            = { naive_dot(d0, d0), naive_dot(d1, d1), naive_dot(d2, d2) };
        double q[3] = { square[0] - t->square[0], square[1] - t->square[1],
                        square[2] - t->square[2] },
               s[3];
        if (of->damped) {
            q[0] += t->lag * naive_dot(d0, naive_minus(v[c], v[b]));
            q[1] += t->lag * naive_dot(d1, naive_minus(v[a], v[c]));
            q[2] += t->lag * naive_dot(d2, naive_minus(v[b], v[a]));
        }
        naive_pull(t, square, q, s);
        naive_push(&f[a], s[2], d2, -s[1], d1);
        naive_push(&f[b], s[0], d0, -s[2], d2);
        naive_push(&f[c], s[1], d1, -s[0], d0);
    }
}

static inline void naive_bending(const naive_mesh *of, const naive_vec *x, naive_vec *f)
{
    const naive_vec *v = x + of->particles;
    const double tau = of->bend_damping;
    for (size_t i = 0; i < of->particles; ++i) {
        naive_vec sum = { 0.0, 0.0, 0.0 };
        if (of->damped) {
            for (size_t j = of->row[i]; j < of->row[i + 1]; ++j) {
                const uint32_t p = of->column[j];
                naive_push(&sum, of->entry[j], x[p], of->entry[j] * tau, v[p]);
            }
        } else {
            for (size_t j = of->row[i]; j < of->row[i + 1]; ++j) {
                const naive_vec at = x[of->column[j]];
                sum.x += of->entry[j] * at.x;
                sum.y += of->entry[j] * at.y;
                sum.z += of->entry[j] * at.z;
            }
        }
        f[i] = naive_minus(f[i], sum);
    }
}

static inline void naive_wind(const naive_mesh *of, const naive_vec *x, naive_vec *f)
{
    const naive_vec *v = x + of->particles;
    const double *w = of->wind;
    for (size_t j = 0; j < of->triangles; ++j) {
        const uint32_t *c = of->triangle[j].corner;
        const naive_vec a = naive_minus(x[c[1]], x[c[0]]),
                        b = naive_minus(x[c[2]], x[c[0]]);
        const naive_vec v0 = v[c[0]], v1 = v[c[1]], v2 = v[c[2]];
        const naive_vec flow
            = { 3.0 * w[0] - (v0.x + v1.x + v2.x), 3.0 * w[1] - (v0.y + v1.y + v2.y),
                3.0 * w[2] - (v0.z + v1.z + v2.z) };
        const naive_vec n
            = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
        const double push
            = of->wind_drag / 18.0 * naive_dot(n, flow) / sqrt(naive_dot(n, n));
        for (int k = 0; k < 3; ++k) {
            f[c[k]].x += push * n.x;
            f[c[k]].y += push * n.y;
            f[c[k]].z += push * n.z;
        }
    }
}

/* y and dydt: N positions, N velocities. */
static inline void naive_mesh_rhs(const naive_mesh *of, const naive_vec *y,
                                  naive_vec *dydt)
{
    const size_t n = of->particles;
    const naive_vec *v = y + n;
    const double *g = of->gravity;
    naive_vec *f = dydt + n;
    memset(f, 0, n * sizeof *f);
    naive_membrane(of, y, f);
    if (of->row != NULL) {
        naive_bending(of, y, f);
    }
    if (of->wind_drag != 0.0) {
        naive_wind(of, y, f);
    }
    for (size_t i = 0; i < n; ++i) {
        const double w = of->inverse_mass[i], drag = of->drag;
        dydt[i] = v[i];
        f[i] = (naive_vec){ g[0] + w * (f[i].x - drag * v[i].x),
                            g[1] + w * (f[i].y - drag * v[i].y),
                            g[2] + w * (f[i].z - drag * v[i].z) };
    }
}
