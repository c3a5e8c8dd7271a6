/* SPDX-License-Identifier: BSD-3-Clause */
/* springs.c -- forces of stretch, shear and bend springs of a grid, by the law of
 * springs.h. */
#include "forces/springs/springs.h"

/* Where particle p is in a plane whose rows are `down` apart. */
static size_t springs_spread(const weft__mesh *mesh, size_t down, size_t p)
{
    return down == mesh->cols ? p : p / mesh->cols * down + p % mesh->cols;
}

/* Difference of the ends in planes n apart. */
static void springs_difference(const double *a, size_t n, size_t p, size_t q,
                               double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = a[k * n + q] - a[k * n + p];
    }
}

/* [N] of one of them on p, or its derivative along `along` and with respect to a
 * parameter. */
static void spring_force(const weft__springs *own, weft__spring *at,
                         const weft__tangents *in, const weft__tangent *tangent,
                         double pull[3])
{
    const weft__spring_derivative *by = tangent != NULL ? tangent->by : NULL;
    const unsigned group = at->group->orientation;
    const size_t n = in->stride, p = springs_spread(own->mesh, in->down, at->p);
    const size_t q = springs_spread(own->mesh, in->down, at->q);
    double w[3], dd[3], dw[3];
    springs_difference(in->y, n, p, q, at->d);
    springs_difference(in->y + 3 * n, n, p, q, w);
    at->square = weft__dot(at->d, at->d);
    if (tangent == NULL) {
        const double tension = weft__spring_tension(at, weft__dot(w, at->d));
        for (size_t k = 0; k < 3; ++k) {
            pull[k] = tension * at->d[k];
        }
        return;
    }
    springs_difference(tangent->along, n, p, q, dd);
    springs_difference(tangent->along + 3 * n, n, p, q, dw);
    weft__spring_change(
        at, w, dd, dw,
        by != NULL && (by->orientations >> group & 1) != 0 ? &by->laws[group] : NULL,
        pull);
}

/* [N] of all springs on particle i, or the derivative in a direction (NULL: none). */
static void springs_pull_of(const weft__springs *own, size_t i,
                            const weft__tangents *in, const weft__tangent *tangent,
                            double force[3])
{
    double from[3][WEFT_GROUPS] = { 0 }, to[3][WEFT_GROUPS] = { 0 }, pull[3]; /* on p */
    weft__spring springs[WEFT__SPRINGS_MAX];
    const size_t count = weft__particle_springs(own, i, NULL, springs);
    for (weft__spring *at = springs; at < springs + count; ++at) {
        spring_force(own, at, in, tangent, pull);
        for (size_t k = 0; k < 3; ++k) {
            (at->p == i ? from : to)[k][at->group->orientation] = pull[k];
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        force[k] = weft__springs_sum(from[k], to[k]);
    }
}

/* A state as it is. */
static weft__tangents springs_state_of(const weft__springs *own, const double *y)
{
    return (
        weft__tangents){ .y = y, .stride = own->mesh->stride, .down = own->mesh->cols };
}

/* ---- for weft__force ------------------------------------------------------------- */

static void springs_choose(void *own, weft__isa isa)
{
    weft__springs *of = own;
    of->fast = WEFT_FORM(isa, rows);
    of->products = WEFT_FORM(of->group_count == 0 ? WEFT__LOOPS : isa, products);
    of->transposed = WEFT_FORM(of->group_count == 0 ? WEFT__LOOPS : isa, transposed);
}

/* 0 where a particle's six numbers from z on are finite, else NaN. */
static double springs_trouble(const double *z, size_t n)
{
    return ((z[3 * n] + z[4 * n] + z[5 * n]) + (z[0] + z[n] + z[2 * n])) * 0.0;
}

int weft__rows_loops(const void *own, const weft__body *body, const weft__state *at,
                     weft__unit unit, double *to, size_t first, size_t end)
{
    const weft__springs *of = own;
    const weft__mesh *mesh = of->mesh;
    const weft__tangents in = springs_state_of(of, at->y);
    const size_t n = mesh->stride, last = weft__block(mesh, end);
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        double springs[3];
        springs_pull_of(of, i, &in, NULL, springs);
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
        bad += unit == WEFT__FORCE ? 0.0 : springs_trouble(to + i, n);
    }
    return bad == 0.0 ? 0 : 1;
}

/* The product of a particle, which is at `place`, in a direction; net[3]: [N] of the
 * state itself. */
static double springs_product_of(const weft__springs *own, const weft__body *body,
                                 const weft__tangents *in, const weft__tangent *tangent,
                                 size_t i, size_t place, const double net[3])
{
    const weft__spring_derivative *by = tangent->by;
    const size_t n = in->stride;
    double springs[3];
    springs_pull_of(own, i, in, tangent, springs);
    for (size_t k = 0; k < 3; ++k) {
        const double v = tangent->along[(k + 3) * n + place];
        double force = springs[k] - body->drag * v;
        if (by != NULL) {
            force -= by->drag * in->y[(k + 3) * n + place];
        }
        double rate
            = (by != NULL ? by->gravity[k] : 0.0) + own->mesh->inverse_mass[i] * force;
        if (by != NULL && by->inverse_mass != NULL) {
            rate += by->inverse_mass[i] * net[k];
        }
        tangent->out[k * n + place] = v;
        tangent->out[(k + 3) * n + place] = rate;
    }
    return springs_trouble(tangent->out + place, n);
}

int weft__products_loops(const weft__springs *own, const weft__body *body,
                         const weft__tangents *tangents, size_t first, size_t end)
{
    const weft__mesh *mesh = own->mesh;
    const size_t n = tangents->stride, last = weft__block(mesh, end);
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < last; ++i) {
        const size_t place = springs_spread(mesh, tangents->down, i);
        double net[3];
        springs_pull_of(own, i, tangents, NULL, net);
        for (size_t k = 0; k < 3; ++k) {
            const double v = tangents->y[(k + 3) * n + place];
            net[k] -= body->drag * v;
            if (tangents->base != NULL) {
                tangents->base[k * n + place] = v;
                tangents->base[(k + 3) * n + place]
                    = body->gravity[k] + mesh->inverse_mass[i] * net[k];
            }
        }
        bad += tangents->base != NULL ? springs_trouble(tangents->base + place, n)
                                      : 0.0;
        for (size_t j = 0; j < tangents->count; ++j) {
            bad += springs_product_of(own, body, tangents, &tangents->tangent[j], i,
                                      place, net);
        }
    }
    return bad == 0.0 ? 0 : 1;
}

static int springs_start(const void *own, const weft__body *body, const weft__state *at,
                         weft__unit unit, double *to, size_t first, size_t end)
{
    const weft__springs *of = own;
    if (at->along != NULL) {
        weft__tangents one = springs_state_of(of, at->y);
        one.count = 1;
        one.tangent[0] = (weft__tangent){ at->along, to, NULL };
        return of->products(of, body, &one, first, end);
    }
    return (unit == WEFT__FORCE ? weft__rows_loops : of->fast)(own, body, at, unit, to,
                                                               first, end);
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
            const weft__tangents in = springs_state_of(of, at->y);
            springs_pull_of(of, i, &in, NULL, force);
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
        if (at->families == NULL || at->families[spring.family]) {
            weft__keep_worst(&sum->worst, &spring);
        }
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
