/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/contact.h"

#include <string.h>

#include "base/memory.h"
#include "forces/contact/contact_law.h"
#include "forces/contact/mesh_shape.h"
#include "forces/contact/passage.h"

void weft__touch_forces(const weft_contact_def *law, double friction,
                        weft__touch *touch)
{
    const law_touch of
        = law_normal_force(law, friction, touch->gap, touch->share, touch->speed,
                           weft__dot(touch->slip, touch->slip), touch->steepness);
    touch->push = of.push, touch->factor = of.factor;
    touch->stiffness = of.stiffness,
    touch->friction_rate = law_friction_rate(law, friction, of.most, of.under);
}

/* Of a particle at r from the shape with velocity v, whose gap is there. */
static void find_speeds(const weft__pose *pose, const double r[3], const double v[3],
                        weft__touch *touch)
{
    const double *g = touch->gradient;
    double moving[3];
    touch->steepness = touch->joined ? weft__length(g) : 1.0;
    law_surface(pose, r, touch->surface);
    for (size_t k = 0; k < 3; ++k) {
        touch->normal[k] = g[k] * (1.0 / touch->steepness);
        moving[k] = v[k] - touch->surface[k];
    }
    touch->speed = weft__dot(moving, touch->normal);
    for (size_t k = 0; k < 3; ++k) {
        touch->slip[k] = moving[k] - touch->speed * touch->normal[k];
    }
}

static bool find_touch(weft__touches *at, size_t i)
{
    const size_t n = at->own->mesh->particles;
    const double *z = at->y + i;
    const double *p = at->pose.at, r[3] = { z[0] - p[0], z[n] - p[1], z[2 * n] - p[2] };
    const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
    weft__touch *touch = &at->touch;
    law_spot spot;
    law_spot_of(&at->pose, at->pose.kind, r, &spot);
    if (spot.gap >= at->own->law.thickness) {
        return false;
    }
    touch->gap = spot.gap, touch->joined = spot.joined != 0;
    memcpy(touch->gradient, spot.gradient, sizeof spot.gradient);
    at->i = i;
    touch->share = 1.0;
    find_speeds(&at->pose, r, v, touch);
    weft__touch_forces(&at->own->law, at->pose.friction, touch);
    return true;
}

weft__touches weft__touches_of(const weft__contact *own, double t, const double *y,
                               size_t first, size_t end)
{
    return (weft__touches){ .own = own,
                            .t = t,
                            .y = y,
                            .first = first,
                            .end = end,
                            .next = end,
                            .end_shape = own->shape_count };
}

bool weft__each_touch(weft__touches *at)
{
    const weft__contact *own = at->own;
    for (;;) {
        while (at->next < at->end) {
            const size_t i = at->next++;
            if (own->mesh->pin[i] == 0 && find_touch(at, i)) {
                return true;
            }
        }
        if (at->shapes == at->end_shape) {
            return false;
        }
        const weft__shape *shape = &own->shapes[at->shapes++];
        at->pose = weft__pose_of(shape, at->t);
        at->next = shape->def.kind == WEFT_MESH ? at->end : at->first;
    }
}

int weft__contact_some(const weft__contact *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end, size_t shape,
                       size_t end_shape)
{
    const weft__mesh *mesh = own->mesh;
    double bad = 0.0;
    weft__touches all = weft__touches_of(own, at->t, at->y, first, end);
    for (all.shapes = shape, all.end_shape = end_shape; weft__each_touch(&all);) {
        const double scale = unit == WEFT__FORCE ? mesh->mass[all.i] : 1.0;
        double *plane = to + all.i;
        for (size_t k = 0; k < 3; ++k, plane += mesh->particles) {
            const double more = weft__touch_acceleration(&all.touch, k);
            *plane += all.touch.gap > 0.0 ? scale * more : (double)NAN;
            bad += *plane * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
}

int weft__contact_loops(const void *own, const weft__state *at, weft__unit unit,
                        double *to, size_t first, size_t end)
{
    const weft__contact *of = own;
    return weft__contact_some(of, at, unit, to, weft__block(of->mesh, first),
                              weft__block(of->mesh, end), 0, of->shape_count);
}

static int contact_add(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__contact *of = own;
    weft__add_fn *form = unit == WEFT__FORCE ? weft__contact_loops : of->fast;
    return form(own, at, unit, to, first, end);
}

static weft__touches contact_of_block(const weft__contact *of, const weft__state *at,
                                      size_t b)
{
    return weft__touches_of(of, at->t, at->y, weft__block(of->mesh, b),
                            weft__block(of->mesh, b + 1));
}

static void contact_power(const void *own, const weft__state *at, size_t b,
                          weft_measures *sum)
{
    const weft__contact *of = own;
    for (weft__touches all = contact_of_block(of, at, b); weft__each_touch(&all);) {
        const weft__touch *touch = &all.touch;
        const double m = of->mesh->mass[all.i];
        const double taken = touch->push * (1.0 - touch->factor) * touch->steepness;
        double work = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            work += weft__touch_acceleration(touch, k) * touch->surface[k];
        }
        sum->power[WEFT_POWER_CONTACT] += m * (taken * touch->speed);
        sum->power[WEFT_POWER_FRICTION]
            += m * (touch->friction_rate * weft__dot(touch->slip, touch->slip));
        sum->power[WEFT_POWER_SHAPES] += m * work;
    }
}

static void contact_energy(const void *own, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    const weft__contact *of = own;
    const weft_contact_def *law = &of->law;
    const double e = 0.5 * law->stopping_speed * law->stopping_speed;
    for (weft__touches all = contact_of_block(of, at, b); weft__each_touch(&all);) {
        const double z = all.touch.gap * (1.0 / law->thickness), s = 1.0 - z;
        const double u = e * law_power(s, law->exponent) * s * s / z;
        sum->energy.contact += of->mesh->mass[all.i] * (z > 0.0 ? u : (double)INFINITY);
    }
}

/* ---- gaps ------------------------------------------------------------------------ */

static double gap_of(const weft__contact *own, const weft__state *at,
                     const weft__pose *pose, size_t i)
{
    const size_t n = own->mesh->particles;
    const double x[3] = { at->y[i], at->y[n + i], at->y[2 * n + i] };
    return weft__gap_at(pose, x);
}

bool weft__touches_any(const weft__contact *own, const weft__state *at, size_t i,
                       size_t count)
{
    bool touches = false;
    for (size_t k = 0; k < count && !touches; ++k) {
        const weft__pose pose = weft__pose_of(&own->shapes[k], at->t);
        touches = gap_of(own, at, &pose, i) < own->law.thickness;
    }
    return touches;
}

void weft__contact_gaps(const void *own, const weft__state *at, size_t b,
                        weft_measures *sum)
{
    const weft__contact *of = own;
    const weft__mesh *mesh = of->mesh;
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&of->shapes[k], at->t);
        for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
            if (mesh->pin[i] == 0) {
                const double gap = gap_of(of, at, &pose, i);
                weft__keep_gap(sum, gap, i, k);
                sum->touching
                    += gap < of->law.thickness && !weft__touches_any(of, at, i, k);
            }
        }
    }
}

/* ---- loads ----------------------------------------------------------------------- */

void weft__block_load(const weft__contact *own, const weft__state *at, size_t b,
                      size_t k, double sum[WEFT__LOAD])
{
    const size_t n = own->mesh->particles;
    weft__touches all = contact_of_block(own, at, b);
    memset(sum, 0, WEFT__LOAD * sizeof *sum);
    for (all.shapes = k, all.end_shape = k + 1; weft__each_touch(&all);) {
        double arm[3], f[3];
        for (size_t j = 0; j < 3; ++j) {
            arm[j] = at->y[j * n + all.i] - all.pose.at[j];
            f[j] = -own->mesh->mass[all.i] * weft__touch_acceleration(&all.touch, j);
            sum[j] += f[j];
        }
        for (size_t j = 0; j < 3; ++j) {
            const size_t a = (j + 1) % 3, c = (j + 2) % 3;
            sum[3 + j] += arm[a] * f[c] - arm[c] * f[a];
        }
    }
}

/* ---- its part of a cloth --------------------------------------------------------- */

static bool contact_init(void *own, const weft_cloth_def *def,
                         const weft_allocator *memory)
{
    weft__contact *of = own;
    of->law = def->contact;
    of->law.shapes = NULL;
    of->law.shape_count = 0;
    of->shapes = weft__alloc(memory, def->contact.shape_count, sizeof *of->shapes);
    if (of->shapes == NULL) {
        return false;
    }
    of->shape_count = def->contact.shape_count;
    for (size_t k = 0; k < of->shape_count; ++k) {
        of->shapes[k] = weft__shape_of(&def->contact.shapes[k], def->contact.friction);
    }
    return weft__shapes_copy(of->shapes, of->shape_count, memory);
}

static void contact_defaults(weft_cloth_def *def)
{
    def->contact = (weft_contact_def){ .thickness = 5e-3,
                                       .stopping_speed = 5.0,
                                       .exponent = 4,
                                       .damping = 1.0,
                                       .friction = 0.3,
                                       .slip = 1e-3 };
}

static const weft__def_array shapes_array
    = { "weft_shape",
        "shapes",
        sizeof(weft_shape),
        offsetof(weft_cloth_def, contact.shapes),
        offsetof(weft_cloth_def, contact.shape_count),
        offsetof(weft_cloth_def, shape_size) };

static bool contact_alike(const void *own, const void *other)
{
    return ((const weft__contact *)own)->shape_count
           == ((const weft__contact *)other)->shape_count;
}

/* Contact is that of the whole cloth. */
static void contact_define(const weft_cloth_def *whole, weft_cloth_def *grid)
{
    (void)whole;
    grid->contact = (weft_contact_def){ .thickness = 0.0 };
}

static size_t contact_bytes(const void *own)
{
    const weft__contact *of = own;
    return of->shape_count * sizeof *of->shapes;
}

static void contact_choose(void *own, weft__isa isa)
{
    weft__contact *of = own;
    of->fast = WEFT_FORM(isa, contact);
    of->clear = WEFT_FORM(isa, clear);
}

static bool contact_copy(void *own, const weft_allocator *memory)
{
    weft__contact *of = own;
    const weft__shape *from = of->shapes;
    of->shapes = weft__alloc(memory, of->shape_count, sizeof *from);
    of->shared = true;
    if (of->shapes != NULL) {
        memcpy(of->shapes, from, of->shape_count * sizeof *from);
    }
    return of->shapes != NULL;
}

static void free_shapes(void *own, const weft_allocator *memory)
{
    weft__contact *of = own;
    if (!of->shared) {
        weft__shapes_free(of->shapes, of->shape_count, memory);
    }
    weft__free(memory, of->shapes);
}

static void contact_leave_out(void *own)
{
    ((weft__contact *)own)->shape_count = 0;
}

static bool contact_asked(const weft_cloth_def *def)
{
    return def->contact.shape_count > 0;
}

static void contact_piece(const void *own, double t, weft__piece_bounds *to)
{
    weft__shapes_bounds(own, t, to);
}

static bool contact_present(const void *own)
{
    return ((const weft__contact *)own)->shape_count > 0;
}

/* ---- its checks of steps --------------------------------------------------------- */

static double contact_reach(const void *own)
{
    return ((const weft__contact *)own)->law.thickness;
}

static bool contact_pairs(const void *own)
{
    return weft__shapes_vertices(own) > 0;
}

const weft__force weft__contact_force
    = { .name = "contact",
        .tables.defaults = contact_defaults,
        .tables.array = &shapes_array,
        .tables.check = weft__contact_def_check,
        .tables.init = contact_init,
        .tables.hash = weft__contact_own_hash,
        .tables.choose = contact_choose,
        .tables.copy = contact_copy,
        .tables.free = free_shapes,
        .tables.leave_out = contact_leave_out,
        .tables.bytes = contact_bytes,
        .tables.alike = contact_alike,
        .tables.slows = contact_asked,
        .grids.define = contact_define,
        .changes.words = weft__contact_words,
        .changes.put = weft__contact_put,
        .changes.take = weft__contact_take,
        .changes.exchange = weft__contact_exchange,
        .changes.drop = weft__contact_drop,
        .present = contact_present,
        .law.add = contact_add,
        .law.change = weft__contact_change,
        .law.transposed = weft__contact_transposed,
        .law.piece = contact_piece,
        .measures.energy = contact_energy,
        .measures.power = contact_power,
        .measures.gaps = weft__contact_gaps,
        .bounds.range_stiffness = weft__shapes_range_stiffness,
        .bounds.multiply = weft__contact_multiply,
        .couplings.blocks = weft__contact_blocks,
        .checks.asked = contact_asked,
        .checks.wanted = contact_present,
        .checks.reach = contact_reach,
        .checks.pairs = contact_pairs,
        .checks.clear = weft__contact_clear,
        .checks.first = weft__contact_first,
        .checks.hold = weft__contact_hold,
        .checks.gap = weft__contact_gap,
        .checks.other = weft__contact_other,
        .checks.closing = weft__contact_closing,
        .checks.passages = weft__contact_passages };
