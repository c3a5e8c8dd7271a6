/* SPDX-License-Identifier: BSD-3-Clause */
/* springs.c -- forces of stretch, shear and bend springs of a grid, by the law of
 * springs.h. */
#include "forces/springs/springs.h"

/* [N] of all springs on particle i. */
static void springs_pull_of(const weft__springs *own, size_t i, const double *y,
                            double force[3])
{
    double from[3][WEFT_GROUPS] = { 0 }, to[3][WEFT_GROUPS] = { 0 };
    weft__spring springs[WEFT__SPRINGS_MAX];
    const double *v = y + 3 * own->mesh->stride;
    const size_t count = weft__particle_springs(own, i, y, springs);
    for (const weft__spring *at = springs; at < springs + count; ++at) {
        const double tension
            = weft__spring_tension(at, weft__spring_rate(own->mesh, at, v));
        for (size_t k = 0; k < 3; ++k) {
            (at->p == i ? from : to)[k][at->group->orientation] = tension * at->d[k];
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        force[k] = weft__springs_sum(from[k], to[k]);
    }
}

/* ---- for weft__force ------------------------------------------------------------- */

static void springs_choose(void *own, weft__isa isa)
{
    weft__springs *of = own;
    of->fast = WEFT_FORM(isa, rows);
    of->products = WEFT_FORM(of->group_count == 0 ? WEFT__LOOPS : isa, products);
    of->transposed = WEFT_FORM(of->group_count == 0 ? WEFT__LOOPS : isa, transposed);
}

int weft__rows_loops(const void *own, const weft__body *body, const weft__state *at,
                     weft__carry *carry, weft__unit unit, double *to, size_t first,
                     size_t end)
{
    (void)carry;
    const weft__springs *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->stride, last = weft__block(mesh, end);
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        double springs[3];
        springs_pull_of(of, i, at->y, springs);
        for (size_t k = 0; k < 3; ++k) {
            const double v = at->y[(k + 3) * n + i];
            const double force = springs[k] - body->drag * v;
            if (unit == WEFT__FORCE) {
                to[k * n + i] = mesh->mass[i] * body->gravity[k] + force;
                continue;
            }
            to[k * n + i] = v;
            to[(k + 3) * n + i] = body->gravity[k] + mesh->inverse_mass[i] * force;
        }
        bad += unit == WEFT__FORCE ? 0.0 : weft__trouble(to + i, n);
    }
    return bad == 0.0 ? 0 : 1;
}

static int springs_start(const void *own, const weft__body *body, const weft__state *at,
                         weft__carry *carry, weft__unit unit, double *to, size_t first,
                         size_t end)
{
    const weft__springs *of = own;
    if (at->along != NULL) {
        return weft__springs_along(of, body, at, to, first, end);
    }
    return (unit == WEFT__FORCE ? weft__rows_loops : of->fast)(own, body, at, carry,
                                                               unit, to, first, end);
}

static void springs_energy(const void *own, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    for (weft__walk walk = weft__row_springs(own, at->y, b);
         weft__each_spring(&walk);) {
        const weft__spring *of = &walk.spring;
        const double stretch = sqrt(of->square) - of->group->rest_length;
        sum->energy.elastic[of->group->family]
            += 0.5 * weft__spring_stiffness(of) * stretch * stretch;
    }
}

/* Heat, and what the motion of pins does against the springs. */
static void springs_power(const void *own, const weft__state *at, size_t b,
                          weft_measures *sum)
{
    const weft__springs *of = own;
    const weft__mesh *mesh = of->mesh;
    sum->power[WEFT_POWER_SPRINGS] += weft__springs_heat(of, at->y, b);
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        if (weft__pin_moves(mesh, i)) {
            double force[3], rate[6];
            springs_pull_of(of, i, at->y, force);
            weft__pin_rate(mesh, i, at->t, weft__piece(at), rate);
            sum->power[WEFT_POWER_PINS] += -weft__dot(force, rate);
        }
    }
}

static void springs_worst(const void *own, const weft__state *at, size_t b,
                          weft_measures *sum)
{
    for (weft__walk walk = weft__row_springs(own, at->y, b);
         weft__each_spring(&walk);) {
        const weft__spring *found = &walk.spring;
        const weft_spring spring
            = { found->group->family, found->p, found->q, weft__spring_strain(found) };
        weft__keep_worst(&sum->worst, &spring);
    }
}

static void springs_strains(const void *own, const weft__state *at, size_t b,
                            double *strain)
{
    for (weft__walk walk = weft__row_springs(own, at->y, b);
         weft__each_spring(&walk);) {
        const double here = weft__spring_strain(&walk.spring);
        double *p = &strain[walk.spring.p], *q = &strain[walk.spring.q];
        *p = fmax(*p, here), *q = fmax(*q, here);
    }
}

const weft__force weft__springs_force
    = { .name = "springs",
        .tables.check = weft__springs_check,
        .tables.init = weft__springs_init,
        .tables.hash = weft__springs_hash,
        .tables.choose = springs_choose,
        .grids = { .have_it = true, .measured = true },
        .law.start = springs_start,
        .law.swept = true,
        .measures.energy = springs_energy,
        .measures.power = springs_power,
        .measures.worst = springs_worst,
        .measures.strains = springs_strains,
        .bounds.ratios = weft__springs_ratios,
        .bounds.particle = weft__springs_bound,
        .couplings.runs = weft__springs_runs,
        .couplings.springs = weft__springs_couplings };
