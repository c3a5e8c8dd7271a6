/* SPDX-License-Identifier: BSD-3-Clause */
/* lecture.h -- a cloth as a lecture on numerical methods would program it: a list of
 * spring structs, one loop over it that adds each pull to both its ends, and GSL's
 * odeiv stepper as in the example of its manual. Springs, gravity, viscous drag, pins
 * and their motion; no wind. The denominator of whole-run figures. */
#ifndef WEFT_BENCH_LECTURE_H
#define WEFT_BENCH_LECTURE_H

#include "cloth/internal.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv.h>
#include <math.h>
#include <string.h>

typedef struct lecture_spring {
    size_t p, q;
    double rest_length, stiffness, damping; /* [m], [N/m], [kg/s] */
} lecture_spring;

typedef struct lecture {
    const weft_cloth *cloth; /* masses, pins, gravity */
    size_t n, spring_count;
    lecture_spring *springs;
    double *y, *force; /* x y z of particle after particle; then velocities */
    unsigned long steps, rejected, rhs_calls;
} lecture;

static inline void lecture_springs(lecture *self)
{
    const weft_cloth *cloth = self->cloth;
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        for (size_t r = 0; r < group->end_row; ++r) {
            for (size_t c = group->first_col; c < group->end_col; ++c) {
                const size_t p = r * cloth->cols + c;
                self->springs[self->spring_count++]
                    = (lecture_spring){ p, p + (size_t)group->stride,
                                        group->rest_length, group->stiffness,
                                        group->damping };
            }
        }
    }
}

static inline void lecture_create(lecture *self, const weft_cloth *cloth)
{
    const size_t n = cloth->particles;
    *self = (lecture){ .cloth = cloth, .n = n };
    self->springs = malloc(WEFT_GROUPS * n * sizeof *self->springs);
    self->y = malloc(6 * n * sizeof *self->y);
    self->force = malloc(3 * n * sizeof *self->force);
    if (self->springs == NULL || self->y == NULL || self->force == NULL) {
        abort();
    }
    lecture_springs(self);
}

static inline void lecture_destroy(lecture *self)
{
    free(self->springs);
    free(self->y);
    free(self->force);
}

/* Planes of n to x y z of particle after particle. */
static inline void lecture_start(lecture *self, const double *planes)
{
    for (size_t i = 0; i < self->n; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            self->y[3 * i + k] = planes[k * self->n + i];
            self->y[3 * (self->n + i) + k] = planes[(3 + k) * self->n + i];
        }
    }
}

static inline void lecture_pull(const lecture_spring *s, const double *x,
                                const double *v, double *f)
{
    const double dx = x[3 * s->q] - x[3 * s->p];
    const double dy = x[3 * s->q + 1] - x[3 * s->p + 1];
    const double dz = x[3 * s->q + 2] - x[3 * s->p + 2];
    const double length = sqrt(dx * dx + dy * dy + dz * dz);
    const double rate
        = ((v[3 * s->q] - v[3 * s->p]) * dx + (v[3 * s->q + 1] - v[3 * s->p + 1]) * dy
           + (v[3 * s->q + 2] - v[3 * s->p + 2]) * dz)
          / length;
    const double pull
        = (s->stiffness * (length - s->rest_length) + s->damping * rate) / length;
    f[3 * s->p] += pull * dx;
    f[3 * s->p + 1] += pull * dy;
    f[3 * s->p + 2] += pull * dz;
    f[3 * s->q] -= pull * dx;
    f[3 * s->q + 1] -= pull * dy;
    f[3 * s->q + 2] -= pull * dz;
}

static inline int lecture_rhs(double t, const double y[], double dydt[], void *ctx)
{
    lecture *self = ctx;
    const weft_cloth *cloth = self->cloth;
    const size_t n = self->n;
    const double *v = y + 3 * n;
    ++self->rhs_calls;
    for (size_t j = 0; j < 3 * n; ++j) {
        self->force[j]
            = cloth->mass[j / 3] * cloth->gravity[j % 3] - cloth->drag * v[j];
    }
    for (size_t i = 0; i < self->spring_count; ++i) {
        lecture_pull(&self->springs[i], y, v, self->force);
    }
    for (size_t i = 0; i < n; ++i) {
        const weft__motion *motion
            = cloth->pin[i] == 0 ? NULL : &cloth->motions[cloth->pin[i] - 1];
        for (size_t k = 0; k < 3; ++k) {
            const size_t j = 3 * i + k;
            if (motion == NULL) {
                dydt[j] = v[j];
                dydt[3 * n + j] = self->force[j] / cloth->mass[i];
            } else {
                const double w = motion->omega;
                dydt[j] = weft__motion_velocity(motion, k, t);
                dydt[3 * n + j] = -w * w * motion->amplitude[k] * sin(w * t);
            }
        }
    }
    return GSL_SUCCESS;
}

/* From 0 to t1 [s], as in the manual of GSL 1. */
static inline void lecture_run(lecture *self, double tolerance, double first_step,
                               double t1)
{
    const size_t dim = 6 * self->n;
    gsl_odeiv_step *s = gsl_odeiv_step_alloc(gsl_odeiv_step_rkf45, dim);
    gsl_odeiv_control *c = gsl_odeiv_control_y_new(tolerance, 0.0);
    gsl_odeiv_evolve *e = gsl_odeiv_evolve_alloc(dim);
    gsl_odeiv_system system = { lecture_rhs, NULL, dim, self };
    double t = 0.0, h = first_step;
    self->rhs_calls = 0;
    while (t < t1) {
        if (gsl_odeiv_evolve_apply(e, c, s, &system, &t, t1, &h, self->y)
            != GSL_SUCCESS) {
            abort();
        }
    }
    self->steps = e->count;
    self->rejected = e->failed_steps;
    gsl_odeiv_evolve_free(e);
    gsl_odeiv_control_free(c);
    gsl_odeiv_step_free(s);
}

#endif
