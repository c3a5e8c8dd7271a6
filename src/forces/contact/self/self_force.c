/* SPDX-License-Identifier: BSD-3-Clause */
/* self_force.c -- what self-contact is to the rest of weft: its part of a cloth, its
 * workspace, its checks of steps. */
#include <string.h>

#include "forces/contact/self/crossing.h"
#include "forces/contact/self/self_list.h"
#include "mesh/grid_def.h"

/* ---- its part of a cloth --------------------------------------------------------- */

/* Without shapes the law is no other force's. */
static void self_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (def->contact.self && def->contact.shape_count == 0) {
        weft__contact_check(&def->contact, to);
    }
    weft__self_check(def, to);
}

static bool self_asked(const weft_cloth_def *def)
{
    return def->contact.self;
}

static bool self_init(void *own, const weft_cloth_def *def,
                      const weft_allocator *memory)
{
    weft__self *of = own;
    of->law = def->contact;
    of->asked = def->contact.self;
    of->law.self = of->asked && !weft__is_band(def);
    of->max_friction = def->contact.friction;
    of->points = of->mesh->particles;
    return !of->law.self || of->mesh->triangles == NULL || weft__self_cover(of, memory);
}

bool weft__self_copy(void *own, const weft_allocator *memory)
{
    (void)memory;
    ((weft__self *)own)->shared = true;
    return true;
}

static void self_free_own(void *own, const weft_allocator *memory)
{
    weft__self *of = own;
    if (!of->shared) {
        weft__contact_surface_destroy(of->surface, memory);
    }
}

static size_t self_bytes(const void *own)
{
    const weft__self *of = own;
    return of->surface != NULL ? weft__contact_surface_bytes(of->surface) : 0;
}

void weft__self_choose(void *own, weft__isa isa)
{
    weft__self *of = own;
    of->pushes = WEFT_FORM(isa, pushes);
    of->slack = WEFT_FORM(isa, slack);
    of->gaps = WEFT_FORM(isa, gaps);
    of->within = WEFT_FORM(isa, within);
    of->meets = WEFT_FORM(isa, meets);
    of->drift = WEFT_FORM(isa, drift);
    of->range = WEFT_FORM(isa, range);
    of->seeker = weft__seeker_of(isa);
}

static int self_transposed_all(const void *own, void *space, const weft__state *at,
                               double *out)
{
    return weft__self_transposed(own, space, at->y, at->along, out);
}

static int self_add_part(const void *own, void *space, const double *y, size_t first,
                         size_t end, size_t stride, double *to)
{
    weft__self_sums sums = { own, WEFT__ACCELERATION, to, first, end, stride };
    weft__self_pass pass = {
        .law = weft__self_law_of(own), .y = y, .each = weft__self_sum, .ctx = &sums
    };
    return weft__self_list_each(space, y, &pass);
}

/* ---- its workspace, and its checks of steps -------------------------------------- */

static void *self_space_create(const void *own, weft__pool *pool, const size_t part[2],
                               const weft_allocator *memory)
{
    return weft__self_list_create(own, pool, part, memory);
}

static weft_status self_space_grow(void *space, weft_error *err)
{
    return weft__self_list_grow(space, err);
}

static void self_space_destroy(void *space)
{
    weft__self_list_destroy(space);
}

static bool self_wanted(const void *own)
{
    return ((const weft__self *)own)->asked;
}

static bool self_clear_pairs(const void *own, void *space, const weft__path *path,
                             weft__penetration *out)
{
    const weft__stride stride = { own, path->y0, path->y1, path->t1 - path->t0 };
    return weft__self_list_clear(space, &stride, out->pair, &out->gap);
}

static void self_forget(void *space)
{
    weft__self_list_forget(space);
}

static void self_hold_pairs(void *space, double t, const double *from, double *y)
{
    (void)t;
    weft__self_list_hold(space, from, y);
}

static void self_nearest(const void *own, void *space, const weft__state *at,
                         weft__penetration *out)
{
    weft_measures sum = { .self_gap = (double)INFINITY };
    weft__self_measure(own, space, at, &sum);
    memcpy(out->pair, sum.self_pair, sizeof out->pair);
    out->gap = sum.self_gap;
    out->found = out->gap <= 0.0;
}

static weft_status self_start(const void *own, weft_error *err)
{
    return weft__notch_error(own, err);
}

static bool self_present(const void *own)
{
    return ((const weft__self *)own)->law.self;
}

static void self_leave_out(void *own)
{
    ((weft__self *)own)->law.self = false;
}

const weft__force weft__self_force
    = { .name = "self",
        .tables.check = self_check,
        .tables.slows = self_asked,
        .tables.init = self_init,
        .tables.choose = weft__self_choose,
        .tables.copy = weft__self_copy,
        .tables.free = self_free_own,
        .tables.leave_out = self_leave_out,
        .tables.bytes = self_bytes,
        .present = self_present,
        .bounds.range_stiffness = weft__self_range_stiffness,
        .space = { self_space_create, self_space_grow, self_space_destroy },
        .whole.add_part = self_add_part,
        .checks.wanted = self_wanted,
        .checks.gathers = self_wanted,
        .checks.pairs = self_wanted,
        .checks.clear_pairs = self_clear_pairs,
        .checks.forget = self_forget,
        .checks.hold_pairs = self_hold_pairs,
        .checks.meet = self_nearest,
        .checks.start = self_start,
        .checks.crossing = weft__crossing_error,
        .bounds.multiply = weft__self_multiply,
        .couplings.blocks = weft__self_blocks,
        .whole.add = weft__self_add,
        .whole.transposed = self_transposed_all,
        .whole.measure = weft__self_measure };
