/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/body/body.h"

#include <string.h>

#include "base/hash.h"
#include "forces/bounds.h"

const struct weft__body_numbers weft__body_numbers = {
    WEFT__FIELD(weft_cloth_def, gravity, "m/s^2", .count = 3, .least = -HUGE_VAL),
    WEFT__FIELD(weft_cloth_def, damping, "kg/s", .least = 0.0),
};

static void body_check(const weft_cloth_def *def, const weft__faults *to)
{
    (void)WEFT__NUMBERS_CHECK(weft__body_numbers, def, to, "%s", "");
}

static bool body_init(void *own, const weft_cloth_def *def,
                      const weft_allocator *memory)
{
    weft__body *of = own;
    (void)memory;
    of->drag = def->damping;
    memcpy(of->gravity, def->gravity, sizeof of->gravity);
    return true;
}

static uint64_t body_hash_of(const void *own, uint64_t hash)
{
    const weft__body *of = own;
    return weft__hash_real(weft__hash_reals(hash, of->gravity, 3), of->drag);
}

static void body_energy(const void *own, const weft__state *at, size_t b,
                        weft_measures *sum)
{
    const weft__body *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        const double x[3] = { at->y[i], at->y[n + i], at->y[2 * n + i] };
        if (mesh->pin[i] == 0) {
            sum->energy.gravitational -= mesh->mass[i] * weft__dot(of->gravity, x);
        }
    }
}

static void body_power(const void *own, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    const weft__body *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride, end = weft__block(mesh, b + 1);
    for (size_t i = weft__block(mesh, b); of->drag != 0.0 && i < end; ++i) {
        const double *v = at->y + 3 * n + i;
        const double speed[3] = { v[0], v[n], v[2 * n] };
        if (mesh->pin[i] == 0) {
            sum->power[WEFT_POWER_DRAG] += of->drag * weft__dot(speed, speed);
        }
    }
}

static void body_bound(const void *own, const weft__state *at, size_t i,
                       const weft__sides *sides, double (*sums)[6])
{
    const weft__body *of = own;
    (void)at;
    for (size_t s = 0; s < sides->count; ++s) {
        weft__bound_add(sums[s], sides->direction[s][1]
                                     * (of->drag * of->mesh->inverse_mass[i]));
    }
}

static void body_leave_out(void *own)
{
    weft__body *of = own;
    *of = (weft__body){ .mesh = of->mesh };
}

static bool body_slows(const weft_cloth_def *def)
{
    return def->damping != 0.0;
}

static void body_define(const weft_cloth_def *whole, weft_cloth_def *grid)
{
    memcpy(grid->gravity, whole->gravity, sizeof grid->gravity);
    grid->damping = whole->damping;
}

const weft__force weft__body_force = { .name = "body",
                                       .tables.check = body_check,
                                       .tables.init = body_init,
                                       .tables.hash = body_hash_of,
                                       .tables.leave_out = body_leave_out,
                                       .tables.slows = body_slows,
                                       .grids.have_it = true,
                                       .grids.define = body_define,
                                       .law.swept = true,
                                       .measures.energy = body_energy,
                                       .measures.power = body_power,
                                       .bounds.particle = body_bound };
