/* SPDX-License-Identifier: BSD-3-Clause */
/* ledger_run.h -- a model and simulations of it, for the tests of the energy ledger. */
#pragma once

#include "one_sim.h"

#include <math.h>
#include <string.h>

static weft_cloth_def model;
static weft_pin pins[2];

static inline void setup(void)
{
    model = weft_cloth_def_default();
    memset(pins, 0, sizeof pins);
}

static inline weft_sim *make(const weft_stepper_type *method,
                             weft_stepper_config config, bool ledger)
{
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    weft_sim *made = NULL;
    def.cloth = cloth;
    def.method = method;
    def.config = test_config(method, config);
    def.ledger = ledger;
    ck_assert_msg(weft_sim_create(&def, &made, &err) == WEFT_OK, "%s", err.message);
    return made;
}

static inline void go(weft_sim *to, double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(to, t, &err) == WEFT_OK, "%s", err.message);
}

static inline weft_stepper_config fixed(double h)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = h;
    return config;
}

static inline weft_stepper_config tolerance(double tol)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.rtol = config.atol_position = config.atol_velocity = tol;
    return config;
}

static inline bool keeps(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_QUADRATURES) != 0;
}

/* Springs of each family, damped, in drag and wind, with a moved pin and one at rest.
 */
static inline void all_at_once(void)
{
    model.rows = 4;
    model.cols = 5;
    model.spacing[0] = 0.3;
    model.spacing[1] = 0.25;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 2.0, .damping = 0.010 };
    model.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 0.9, .damping = 0.007 };
    model.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 0.3, .damping = 0.005 };
    model.damping = 0.003;
    model.wind_velocity[0] = 1.0;
    model.wind_velocity[2] = 2.0;
    model.wind_drag = 0.3;
    model.velocity[2] = 0.2;
    pins[0].velocity[0] = 0.1;
    pins[0].amplitude[1] = 0.03;
    pins[0].amplitude[2] = 0.05;
    pins[0].frequency = 0.7;
    pins[1].cols = (weft_range){ -1, -1 };
    model.pins = pins;
    model.pin_count = 2;
    cloth = test_cloth(&model);
}

/* A case that runs a test `count` times, each with a new model. */
static inline void add(Suite *suite, const char *name, const TTest *test, int count)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, test, 0, count);
    suite_add_tcase(suite, tcase);
}
