/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_run.h -- a simulation of a cloth with shapes, for tests of contact while time
 * passes. */
#pragma once

#include <math.h>

#include "one_sim.h"

static weft_cloth_def model;
static weft_shape shapes[4];
static weft_sim_def run;
static weft_error err;

/* Two loose particles of 0.1 kg, side by side along x, above the plane y >= 0, which is
 * elastic and without friction; a tight tolerance. */
static inline void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = 1, model.cols = 2;
    model.density = 0.0, model.mass = 0.1;
    model.contact.damping = 0.0, model.contact.friction = 0.0;
    model.contact.shapes = shapes, model.contact.shape_count = 1;
    for (size_t k = 0; k < 4; ++k) {
        shapes[k] = weft_shape_default(WEFT_PLANE);
    }
    run = weft_sim_def_default();
    run.method = test_method_named("gsl/rk8pd");
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = 1e-10;
}

/* A level sheet of 6 x 6 about the axis y. */
static inline void level_sheet(void)
{
    model.rows = model.cols = 6, model.down[1] = 0.0, model.down[2] = 1.0;
    model.spacing[0] = model.spacing[1] = 0.05;
    model.origin[0] = model.origin[2] = -0.125, model.mass = 0.01;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.02 };
    model.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 20.0, .damping = 0.01 };
}

static inline void start(void)
{
    teardown();
    cloth = test_cloth(&model);
    run.cloth = cloth;
    run.config = test_config(run.method, run.config);
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
}

static inline void tolerance(double tol)
{
    run.config.rtol = run.config.atol_position = run.config.atol_velocity = tol;
}

static inline void step(double t)
{
    ck_assert_msg(weft_sim_step(sim, t, &err) == WEFT_OK, "%s: %s", run.method->name,
                  err.message);
}

static inline void go(double t)
{
    while (weft_sim_time(sim) < t) {
        step(t);
    }
}

/* Component k of the position, or k - 3 of the velocity, of particle i. */
static inline double at(size_t i, size_t k)
{
    return weft_sim_state(sim)[k * weft_cloth_particles(cloth) + i];
}

static inline double gap(void)
{
    return weft_cloth_gap(weft_sim_cloth(sim), weft_sim_time(sim), weft_sim_state(sim),
                          NULL, NULL);
}

static inline double phi(double s)
{
    return s * s * s * s / (1.0 - s);
}

/* The s of phi'(s) = s^3 (4 - 3 s) / (1 - s)^2 = pull, for a small one. */
static inline double resting(double pull)
{
    double s = 0.1;
    for (int i = 0; i < 2000; ++i) {
        s -= 0.1 * (s * s * s * (4.0 - 3.0 * s) / ((1.0 - s) * (1.0 - s)) - pull);
    }
    return s;
}
