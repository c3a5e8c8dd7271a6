/* SPDX-License-Identifier: BSD-3-Clause */
/* saved_sim.h -- a saved simulation of a cloth with every feature, for the tests of
 * restoring. */
#pragma once

#include <string.h>

#include "support.h"

enum { ROWS = 3, COLS = 4, PARTICLES = ROWS * COLS, DIM = 6 * PARTICLES, MOST = 8192 };

static weft_error err;
static unsigned char saved[MOST], again[MOST];

static inline weft_cloth_def cloth_definition(size_t rows)
{
    static const double path[]
        = { 0.01, 0, 0, 0, 0.04, 0.01, 0, -0.02, 0.08, 0, 0.02, 0 };
    static const double gust[] = { 0, 0, 0, 2, 0.03, 1, 0, 5, 0.07, 0, -3, 0 };
    static const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                     { .rows = { 0, 0 },
                                       .cols = { -1, -1 },
                                       .velocity = { 0.2, 0.0, 0.1 },
                                       .path = { path, 3 } } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows;
    def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 20.0, .damping = 0.02 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.01 };
    def.wind_velocity[2] = 2.0;
    def.wind_table = (weft_table){ gust, 3 };
    def.wind_drag = 0.2;
    def.damping = 1e-3;
    def.pins = pins;
    def.pin_count = 2;
    return def;
}

static inline weft_cloth *make_cloth(size_t rows)
{
    const weft_cloth_def def = cloth_definition(rows);
    return test_cloth(&def);
}

/* A spring to where it is at x = 0. */
static inline int pull(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)t;
    for (size_t i = 0; i < ROWS * COLS; ++i) {
        f[i] -= 0.1 * y[i];
    }
    return 0;
}

typedef struct kind {
    bool ledger, limit;
} kind;

static inline weft_sim_def define(const weft_cloth *of, const weft_stepper_type *method,
                                  kind wanted)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = of;
    def.method = method;
    def.config.rtol = 1e-4;
    def.config.atol_position = def.config.atol_velocity = 1e-4;
    def.config.fixed_step
        = (method->flags & WEFT_STEPPER_FIXED_ONLY) != 0 ? 1.1e-3 : 0.0;
    def.config = test_config(method, def.config);
    def.ledger = wanted.ledger;
    def.limit.method = wanted.limit ? WEFT_LIMIT_PROVOT : WEFT_LIMIT_NONE;
    def.limit.strain = 0.02;
    def.force = weft_cloth_rows(of) == ROWS ? pull : NULL;
    return def;
}

static inline weft_sim *make(const weft_sim_def *def)
{
    weft_sim *sim = NULL;
    ck_assert_msg(weft_sim_create(def, &sim, &err) == WEFT_OK, "%s", err.message);
    return sim;
}

static inline void go(weft_sim *one, double t)
{
    ck_assert_msg(weft_sim_advance(one, t, &err) == WEFT_OK, "%s", err.message);
}

static inline void save(weft_sim *one, unsigned char *to)
{
    ck_assert_uint_le(weft_sim_save_size(one), MOST);
    ck_assert_msg(weft_sim_save(one, to, MOST, &err) == WEFT_OK, "%s", err.message);
}

static weft_cloth *cloth;
static weft_sim *sim;

static inline void begin_saved(void)
{
    cloth = make_cloth(ROWS);
    const weft_sim_def def = define(cloth, test_method_named("verlet/velocity_verlet"),
                                    (kind){ true, true });
    sim = make(&def);
    go(sim, 0.05);
    save(sim, saved);
}

static inline void end_saved(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

/* `again` is, and nothing has changed. */
static inline void refused(size_t size, const char *text)
{
    const uint64_t hash = weft_sim_measure(sim).hash;
    const double t = weft_sim_time(sim);
    const weft_stepper_stats before = weft_sim_stats(sim);
    ck_assert_int_eq(weft_sim_restore(sim, again, size, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, text) != NULL, "%s", err.message);
    const weft_stepper_stats after = weft_sim_stats(sim);
    ck_assert(weft_sim_time(sim) == t);
    ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
    ck_assert_mem_eq(&before, &after, sizeof before);
}
