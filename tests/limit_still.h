/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_still.h -- strain limits on given states: a stepper that only moves time and
 * counts edits of its state, a model to edit, one step of it. */
#pragma once

#include "one_sim.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define MOST         (33 * 33)

/* ---- a stepper that moves time only, and counts who edits its state ---------------
 */

static int edits;

static inline weft_status still_create(const weft_stepper_type *type,
                                       const weft_ode *ode,
                                       const weft_stepper_config *config, void **self,
                                       weft_error *err)
{
    (void)type, (void)ode, (void)config, (void)err;
    edits = 0;
    *self = &edits;
    return WEFT_OK;
}

static inline weft_status still_step(void *self, double t_end, double *t, double *y,
                                     weft_error *err)
{
    (void)self, (void)y, (void)err;
    *t = t_end;
    return WEFT_OK;
}

static inline void still_changed(void *self)
{
    ++*(int *)self;
}

static inline void still_stats(const void *self, weft_stepper_stats *out)
{
    (void)self, (void)out;
}

static inline void still_destroy(void *self)
{
    (void)self;
}

static const weft_stepper_type still = {
    .abi = WEFT_STEPPER_ABI,
    .struct_size = sizeof(weft_stepper_type),
    .name = "still",
    .create = still_create,
    .step = still_step,
    .state_changed = still_changed,
    .stats = still_stats,
    .destroy = still_destroy,
};

/* ---- the model of all tests, to be edited ------------------------------------------
 */

static weft_cloth_def model;
static weft_sim_def wanted;
static weft_pin pins[2];
static weft_load loads[8];
static double start[3 * MOST], speed[3 * MOST], x[3 * MOST], v[3 * MOST];
static uint64_t seed;

static inline double chance(double most)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return most * ((double)(seed >> 11) * 0x1p-52 - 1.0);
}

static inline void setup(void)
{
    seed = 1;
    model = weft_cloth_def_default();
    model.rows = 1;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].present = true;
    }
    wanted = weft_sim_def_default();
    wanted.method = &still;
    wanted.limit.method = WEFT_LIMIT_PROVOT;
    memset(start, 0, sizeof start);
    memset(speed, 0, sizeof speed);
    for (size_t i = 0; i < COUNT(pins); ++i) {
        pins[i] = (weft_pin){ 0 };
        pins[i].cols.first = pins[i].cols.last = -(ptrdiff_t)i;
    }
    model.pins = pins;
}

static inline size_t particles(void)
{
    return model.rows * model.cols;
}

static inline void make(void)
{
    teardown();
    weft_error err = { 0 };
    cloth = test_cloth(&model);
    wanted.cloth = cloth;
    ck_assert_msg(weft_sim_create(&wanted, &sim, &err) == WEFT_OK, "%s", err.message);
}

/* From `start` and `speed` one step of size h. */
static inline void step(double h)
{
    ck_assert_int_eq(weft_sim_set_state(sim, start, speed, NULL), WEFT_OK);
    edits = 0;
    ck_assert_int_eq(weft_sim_step(sim, weft_sim_time(sim) + h, NULL), WEFT_OK);
    weft_sim_positions(sim, x);
    weft_sim_velocities(sim, v);
}

static inline double apart(const double *at, size_t p, size_t q)
{
    const double d[3] = { at[3 * q] - at[3 * p], at[3 * q + 1] - at[3 * p + 1],
                          at[3 * q + 2] - at[3 * p + 2] };
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* A grid of n x n over 1 m, masses of any ratio if `loaded`, hung if `pinned`. */
static inline void sheet(size_t n, bool pinned, bool loaded)
{
    model.rows = model.cols = n;
    model.spacing[0] = model.spacing[1] = 1.0 / (double)(n - 1);
    model.pin_count = pinned ? 2 : 0;
    for (size_t i = 0; i < COUNT(loads); ++i) {
        const ptrdiff_t r = (ptrdiff_t)(i * 5 % n), c = (ptrdiff_t)(i * 7 % n);
        loads[i] = (weft_load){ .rows = { r, r },
                                .cols = { c, c },
                                .mass = 0.02 * (double)(i + 1) };
    }
    model.loads = loads;
    model.load_count = loaded ? COUNT(loads) : 0;
    for (size_t i = 0; i < n * n; ++i) {
        start[3 * i] = 1.3 * (double)(i % n) * model.spacing[1];
        start[3 * i + 1] = -1.3 * (double)(i / n) * model.spacing[0];
        for (size_t k = 0; k < 3; ++k) {
            start[3 * i + k] += chance(model.spacing[0]);
            speed[3 * i + k] = chance(1.0);
        }
    }
}
