/* SPDX-License-Identifier: BSD-3-Clause */
/* lecture.h -- a cloth as a lecture on numerical methods would integrate it: the loop
 * of naive.h under GSL's odeiv stepper, as in the example of its manual. Springs,
 * gravity, viscous drag, pins and their motion; no wind. The denominator of whole-run
 * figures. */
#pragma once

#include "cloth/model.h"
#include "naive.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv.h>

typedef struct lecture {
    const weft_cloth *cloth;
    naive_cloth naive;
    double *y; /* x y z of particle after particle; then velocities */
    unsigned long steps, rejected, rhs_calls;
} lecture;

static inline void lecture_springs(naive_cloth *naive, const weft_cloth *cloth)
{
    for (size_t g = 0; g < cloth->springs.group_count; ++g) {
        const weft__group *group = &cloth->springs.groups[g];
        for (size_t r = 0; r < group->end_row; ++r) {
            for (size_t c = group->first_col; c < group->end_col; ++c) {
                const size_t p = r * cloth->mesh.cols + c;
                naive->springs[naive->count++]
                    = (naive_spring){ (int)p, (int)(p + (size_t)group->stride),
                                      group->stiffness, group->rest_length,
                                      group->damping };
            }
        }
    }
}

/* At rest, as the simulation of the cloth starts; aborts without memory. */
static inline void lecture_create(lecture *self, const weft_cloth *cloth)
{
    const size_t n = cloth->mesh.particles;
    naive_cloth naive = { .particles = n, .drag = cloth->body.drag };
    double *planes = malloc(6 * n * sizeof *planes);
    naive.springs = malloc(WEFT_GROUPS * n * sizeof *naive.springs);
    naive.inverse_mass = malloc(n * sizeof *naive.inverse_mass);
    *self = (lecture){ .cloth = cloth, .y = malloc(6 * n * sizeof *self->y) };
    if (planes == NULL || naive.springs == NULL || naive.inverse_mass == NULL
        || self->y == NULL) {
        abort();
    }
    for (size_t i = 0; i < n; ++i) {
        naive.inverse_mass[i]
            = cloth->mesh.pin[i] != 0 ? 0.0 : 1.0 / cloth->mesh.mass[i];
    }
    memcpy(naive.gravity, cloth->body.gravity, sizeof naive.gravity);
    lecture_springs(&naive, cloth);
    weft_cloth_start(cloth, planes);
    naive_state(n, planes, self->y);
    self->naive = naive;
    free(planes);
}

static inline void lecture_destroy(lecture *self)
{
    naive_destroy(&self->naive);
    free(self->y);
}

static inline int lecture_rhs(double t, const double y[], double dydt[], void *ctx)
{
    lecture *self = ctx;
    const weft_cloth *cloth = self->cloth;
    const size_t n = cloth->mesh.particles;
    ++self->rhs_calls;
    naive_rhs(&self->naive, y, dydt);
    for (size_t i = 0; i < n; ++i) {
        if (cloth->mesh.pin[i] != 0
            && cloth->mesh.motions[cloth->mesh.pin[i] - 1].moves) {
            const weft__motion *motion = &cloth->mesh.motions[cloth->mesh.pin[i] - 1];
            const double w = motion->omega;
            for (size_t k = 0; k < 3; ++k) {
                dydt[3 * i + k]
                    = motion->velocity[k] + w * motion->amplitude[k] * cos(w * t);
                dydt[3 * (n + i) + k] = -w * w * motion->amplitude[k] * sin(w * t);
            }
        }
    }
    return GSL_SUCCESS;
}

/* From 0 to t1 [s], as in the manual of GSL 1. */
static inline void lecture_run(lecture *self, double tolerance, double first_step,
                               double t1)
{
    const size_t dim = 6 * self->cloth->mesh.particles;
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
