/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/attractor/attractor.h"

#include <math.h>

#include "base/bytes.h"
#include "base/finite.h"
#include "forces/bounds.h"

const struct weft__attractor_numbers weft__attractor_numbers = {
    WEFT__FIELD(weft_cloth_def, attractor_strength, "1/s^2", .least = 0.0),
    WEFT__FIELD(weft_cloth_def, attractor_drag, "1/s", .least = 0.0),
};

static void attractor_check(const weft_cloth_def *def, const weft__faults *to)
{
    (void)WEFT__NUMBERS_CHECK(weft__attractor_numbers, def, to, "%s", "");
}

static bool attractor_init(void *own, const weft_cloth_def *def,
                           const weft_allocator *memory)
{
    weft__attractor *of = own;
    (void)memory;
    of->strength = def->attractor_strength, of->drag = def->attractor_drag;
    return true;
}

static uint64_t attractor_hash(const void *own, uint64_t hash)
{
    const weft__attractor *of = own;
    return of->strength == 0.0 ? hash
                               : WEFT__HASH_NUMBERS(hash, of->strength, of->drag);
}

static bool attractor_present(const void *own)
{
    return ((const weft__attractor *)own)->strength != 0.0;
}

static void attractor_leave_out(void *own)
{
    ((weft__attractor *)own)->strength = 0.0;
}

static bool attractor_slows(const weft_cloth_def *def)
{
    return def->attractor_strength != 0.0 && def->attractor_drag != 0.0;
}

/* ---- changes --------------------------------------------------------------------- */

static size_t attractor_words(const void *own)
{
    (void)own;
    return 2;
}

static void attractor_put(const void *own, unsigned char *to)
{
    const weft__attractor *of = own;
    weft__real_put(to, of->strength);
    weft__real_put(to + WEFT__WORD, of->drag);
}

static weft_status attractor_take(void *own, const unsigned char *from, size_t words,
                                  const weft_allocator *memory, weft_error *err)
{
    weft__attractor *of = own;
    (void)memory;
    if (words == 2) {
        of->strength = weft__real_at(from);
        of->drag = weft__real_at(from + WEFT__WORD);
    }
    return (words == 0 || words == 2) && weft__not_negative(of->strength)
                   && weft__not_negative(of->drag)
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID, "a saved attractor makes no sense");
}

static void attractor_exchange(void *own, void *taken)
{
    const weft__attractor before = *(weft__attractor *)own, *with = taken;
    ((weft__attractor *)own)->strength = with->strength;
    ((weft__attractor *)own)->drag = with->drag;
    ((weft__attractor *)taken)->strength = before.strength;
    ((weft__attractor *)taken)->drag = before.drag;
}

/* ---- the law --------------------------------------------------------------------- */

/* Three numbers of particle i, and 1 / (1 + |x|^2). */
static double attractor_at(const double *planes, size_t n, size_t i, double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = planes[k * n + i];
    }
    return 1.0 / (1.0 + weft__dot(out, out));
}

static int attractor_add(const void *own, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end)
{
    const weft__attractor *of = own;
    const size_t n = of->mesh->stride;
    double bad = 0.0;
    for (size_t i = weft__block(of->mesh, first); i < weft__block(of->mesh, end); ++i) {
        const double m = of->mesh->mass[i];
        double x[3], v[3], force[3];
        const double near = attractor_at(at->y, n, i, x);
        (void)attractor_at(at->y + 3 * n, n, i, v);
        for (size_t k = 0; k < 3; ++k) {
            force[k] = -m * (of->strength * near * x[k] + of->drag * v[k]);
        }
        bad += weft__force_add(of->mesh, unit, i, force, to);
    }
    return bad == 0.0 ? 0 : 1;
}

/* d(x / (1 + x.x)) = dx / (1 + x.x) - 2 x (x.dx) / (1 + x.x)^2, a symmetric matrix. */
static void attractor_turn(const weft__attractor *of, const weft__state *at, size_t i,
                           const double dx[3], double out[3])
{
    double x[3];
    const double near = attractor_at(at->y, of->mesh->stride, i, x);
    const double along = 2.0 * weft__dot(x, dx) * near;
    for (size_t k = 0; k < 3; ++k) {
        out[k] = -of->mesh->mass[i] * of->strength * near * (dx[k] - along * x[k]);
    }
}

static int attractor_change(const void *own, const weft__state *at, weft__unit unit,
                            double *to, size_t first, size_t end)
{
    const weft__attractor *of = own;
    const size_t n = of->mesh->stride;
    double bad = 0.0;
    for (size_t i = weft__block(of->mesh, first); i < weft__block(of->mesh, end); ++i) {
        double dx[3], dv[3], force[3];
        (void)attractor_at(at->along, n, i, dx);
        (void)attractor_at(at->along + 3 * n, n, i, dv);
        attractor_turn(of, at, i, dx, force);
        for (size_t k = 0; k < 3; ++k) {
            force[k] -= of->mesh->mass[i] * of->drag * dv[k];
        }
        bad += weft__force_add(of->mesh, unit, i, force, to);
    }
    return bad == 0.0 ? 0 : 1;
}

static void attractor_transposed(const void *own, const weft__state *at, double *out)
{
    const weft__attractor *of = own;
    const size_t n = of->mesh->stride;
    for (size_t i = 0; i < of->mesh->particles; ++i) {
        double l[3], by_x[3];
        (void)attractor_at(at->along, n, i, l);
        attractor_turn(of, at, i, l, by_x);
        for (size_t k = 0; k < 3; ++k) {
            out[k * n + i] += by_x[k];
            out[(3 + k) * n + i] -= of->mesh->mass[i] * of->drag * l[k];
        }
    }
}

/* ---- measures -------------------------------------------------------------------- */

static void attractor_energy(const void *own, const weft__state *at, size_t b,
                             weft_measures *sum)
{
    const weft__attractor *of = own;
    const weft__mesh *mesh = of->mesh;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        double x[3];
        (void)attractor_at(at->y, mesh->stride, i, x);
        if (mesh->pin[i] == 0) {
            sum->energy.gravitational
                += 0.5 * mesh->mass[i] * of->strength * log1p(weft__dot(x, x));
        }
    }
}

static void attractor_power(const void *own, const weft__state *at, size_t b,
                            weft_measures *sum)
{
    const weft__attractor *of = own;
    const weft__mesh *mesh = of->mesh;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        double v[3];
        (void)attractor_at(at->y + 3 * mesh->stride, mesh->stride, i, v);
        if (mesh->pin[i] == 0) {
            sum->power[WEFT_POWER_ATTRACTOR]
                += mesh->mass[i] * of->drag * weft__dot(v, v);
        }
    }
}

/* |K| is at most its strength. */
static void attractor_bound(const void *own, const weft__state *at, size_t i,
                            const weft__sides *sides, double (*sums)[6])
{
    const weft__attractor *of = own;
    (void)at, (void)i;
    for (size_t s = 0; s < sides->count; ++s) {
        weft__bound_add(sums[s], fabs(sides->direction[s][0]) * of->strength
                                     + sides->direction[s][1] * of->drag);
    }
}

const weft__force weft__attractor_force = {
    .name = "attractor",
    .tables = { .check = attractor_check,
                .init = attractor_init,
                .hash = attractor_hash,
                .leave_out = attractor_leave_out,
                .slows = attractor_slows },
    .changes = { .words = attractor_words,
                 .put = attractor_put,
                 .take = attractor_take,
                 .exchange = attractor_exchange },
    .present = attractor_present,
    .law = { .add = attractor_add,
             .change = attractor_change,
             .transposed = attractor_transposed },
    .measures = { .energy = attractor_energy, .power = attractor_power },
    .bounds.particle = attractor_bound,
};
