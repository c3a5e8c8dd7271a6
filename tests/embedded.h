/* SPDX-License-Identifier: BSD-3-Clause */
/* embedded.h -- a simulation as an embedding program creates it: a small cloth with
 * all springs, hung by a corner. */
#pragma once

#include "one_sim.h"

#define ROWS 3
#define COLS 4
#define N    (ROWS * COLS)

static weft_pin corner;
static weft_cloth_def model;
static weft_sim_def run;

static void setup(void)
{
    model = weft_cloth_def_default();
    model.rows = ROWS;
    model.cols = COLS;
    model.density = 0.0;
    model.mass = 0.25;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 8.0, .damping = 0.05 };
    }
    corner = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    model.pins = &corner;
    model.pin_count = 1;
    run = weft_sim_def_default();
    run.method = test_method_named("verlet/velocity_verlet");
    run.config.fixed_step = 1e-3;
}

static void start(void)
{
    weft_error err = { 0 };
    teardown();
    cloth = test_cloth(&model);
    run.cloth = cloth;
    run.config = test_config(run.method, run.config);
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
}

static void go(double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(sim, t, &err) == WEFT_OK, "%s: %s", run.method->name,
                  err.message);
}
