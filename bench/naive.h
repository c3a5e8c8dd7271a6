/* SPDX-License-Identifier: BSD-3-Clause */
/* naive.h -- cloth as a lecture writes it: an array of springs that know their ends and
 * constants, particles x y z x y z ..., one loop that adds each spring's force to both
 * ends. What the fast forms of src/forces are measured against. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "weft/cloth.h"

typedef struct naive_spring {
    int p, q;
    double stiffness, rest_length, damping; /* [N/m], [m], [kg/s] */
} naive_spring;

typedef struct naive_cloth {
    size_t particles, count;
    naive_spring *springs;
    double *inverse_mass; /* [1/kg], 0: held */
    double gravity[3], drag;
} naive_cloth;

/* y and dydt: 3 N positions x y z x y z ..., 3 N velocities. */
static inline void naive_rhs(const naive_cloth *cloth, const double *y, double *dydt)
{
    const size_t n = cloth->particles;
    const double *x = y, *v = y + 3 * n;
    double *f = dydt + 3 * n;
    memset(f, 0, 3 * n * sizeof *f);
    for (size_t i = 0; i < cloth->count; ++i) {
        const naive_spring *s = &cloth->springs[i];
        const double *xp = x + 3 * s->p, *xq = x + 3 * s->q;
        const double *vp = v + 3 * s->p, *vq = v + 3 * s->q;
        const double d[3] = { xq[0] - xp[0], xq[1] - xp[1], xq[2] - xp[2] };
        const double w[3] = { vq[0] - vp[0], vq[1] - vp[1], vq[2] - vp[2] };
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        const double rate = (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / length;
        const double tension
            = s->stiffness * (length - s->rest_length) + s->damping * rate;
        for (int k = 0; k < 3; ++k) {
            const double pull = tension * d[k] / length;
            f[3 * s->p + k] += pull;
            f[3 * s->q + k] -= pull;
        }
    }
    for (size_t i = 0; i < n; ++i) {
        const double w = cloth->inverse_mass[i];
        for (size_t k = 0; k < 3; ++k) {
            const size_t j = 3 * i + k;
            dydt[j] = w > 0.0 ? v[j] : 0.0;
            f[j] = w > 0.0 ? cloth->gravity[k] + w * (f[j] - cloth->drag * v[j]) : 0.0;
        }
    }
}

static inline void naive_add(naive_cloth *cloth, const weft_cloth_def *def,
                             weft_family family, size_t down, ptrdiff_t right)
{
    const weft_spring_def *spring = &def->springs[family];
    const double s
        = hypot((double)down * def->spacing[0], (double)right * def->spacing[1]);
    const ptrdiff_t cols = (ptrdiff_t)def->cols;
    for (size_t r = 0; spring->present && r + down < def->rows; ++r) {
        for (ptrdiff_t c = 0; c < cols; ++c) {
            if (c + right >= 0 && c + right < cols) {
                const ptrdiff_t p = (ptrdiff_t)r * cols + c;
                const ptrdiff_t q = p + (ptrdiff_t)down * cols + right;
                cloth->springs[cloth->count++]
                    = (naive_spring){ (int)p, (int)q, spring->stiffness, s,
                                      spring->damping };
            }
        }
    }
}

/* The same cloth, of Hooke's law and without wind; aborts without memory. */
static inline naive_cloth naive_create(const weft_cloth_def *def,
                                       const weft_cloth *cloth)
{
    const size_t n = weft_cloth_particles(cloth);
    naive_cloth self = { .particles = n, .drag = def->damping };
    self.springs = malloc(6 * n * sizeof *self.springs);
    self.inverse_mass = malloc(n * sizeof *self.inverse_mass);
    if (self.springs == NULL || self.inverse_mass == NULL) {
        abort();
    }
    memcpy(self.gravity, def->gravity, sizeof self.gravity);
    for (size_t i = 0; i < n; ++i) {
        self.inverse_mass[i] = weft_cloth_pinned(cloth, i)
                                   ? 0.0
                                   : 1.0 / weft_cloth_particle_mass(cloth, i);
    }
    naive_add(&self, def, WEFT_STRETCH, 0, 1);
    naive_add(&self, def, WEFT_STRETCH, 1, 0);
    naive_add(&self, def, WEFT_SHEAR, 1, 1);
    naive_add(&self, def, WEFT_SHEAR, 1, -1);
    naive_add(&self, def, WEFT_BEND, 0, 2);
    naive_add(&self, def, WEFT_BEND, 2, 0);
    return self;
}

static inline void naive_destroy(naive_cloth *cloth)
{
    free(cloth->springs);
    free(cloth->inverse_mass);
}

/* Planes to x y z x y z ... */
static inline void naive_state(size_t n, const double *y, double *to)
{
    for (size_t j = 0; j < 6 * n; ++j) {
        const size_t k = j / n, i = j % n;
        to[k / 3 * 3 * n + 3 * i + k % 3] = y[j];
    }
}
