/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies_force.c -- what bodies are to the rest of weft: their part of a cloth, their
 * workspace, their checks of steps. */
#include "forces/contact/bodies/bodies.h"
#include "forces/contact/self/self_list.h"
#include "mesh/surface.h"

/* ---- its part of a cloth --------------------------------------------------------- */

/* Adds the triangles of a body, whose points begin at `first`. */
static void draft_body(weft__surface_draft *to, const weft_body *body, size_t triangle,
                       size_t first)
{
    for (size_t j = 0; j < 3 * body->triangles; ++j) {
        const uint32_t *c = body->corners + j / 3 * 3;
        const double *a = body->positions + 3 * c[(j + 1) % 3];
        const double *b = body->positions + 3 * c[(j + 2) % 3];
        const double side[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
        to->corner[triangle + j / 3][j % 3] = (uint32_t)first + c[j % 3];
        to->side[triangle + j / 3][j % 3] = weft__dot(side, side);
    }
}

static bool cover(weft__bodies *of, const weft_cloth_def *def,
                  const weft_allocator *memory)
{
    const weft__mesh *mesh = of->pairs.mesh;
    size_t point = mesh->particles, triangle = weft__surface_triangles(mesh, NULL),
           all = triangle;
    weft__surface_draft draft;
    for (size_t k = 0; k < of->contact->shape_count; ++k) {
        const weft_body *body = of->contact->shapes[k].def.body;
        all += body != NULL ? body->triangles : 0;
    }
    if (weft__surface_draft_create(&draft, of->pairs.points, all, memory)) {
        draft.particles = point;
        draft.thickness = of->pairs.law.thickness;
        if (mesh->triangles != NULL) {
            weft__surface_draft_parts(&draft, mesh->triangles);
        } else {
            weft__surface_draft_grid(&draft, mesh, def);
        }
        for (size_t i = point; i < draft.points; ++i) {
            draft.density[i] = (double)INFINITY;
        }
        for (size_t k = 0; k < of->contact->shape_count; ++k) {
            const weft_body *body = of->contact->shapes[k].def.body;
            if (body != NULL) {
                draft_body(&draft, body, triangle, point);
                triangle += body->triangles, point += body->vertices;
            }
        }
        of->pairs.surface = weft__contact_surface_create(&draft, memory);
    }
    weft__surface_draft_destroy(&draft, memory);
    return of->pairs.surface != NULL;
}

/* Of points, if bodies have others than the contact. */
static bool find_friction(weft__bodies *of, const weft_allocator *memory)
{
    const double usual = of->pairs.law.friction;
    bool same = true;
    of->pairs.max_friction = 0.0;
    for (size_t k = 0; k < of->contact->shape_count; ++k) {
        const weft__shape *shape = &of->contact->shapes[k];
        if (shape->def.body != NULL) {
            same = same && shape->friction == usual;
            of->pairs.max_friction = fmax(of->pairs.max_friction, shape->friction);
        }
    }
    if (same) {
        return true;
    }
    of->friction = weft__zeroed(memory, of->pairs.points, sizeof *of->friction);
    size_t point = of->pairs.mesh->particles;
    for (size_t k = 0; of->friction != NULL && k < of->contact->shape_count; ++k) {
        const weft__shape *shape = &of->contact->shapes[k];
        const size_t end
            = point + (shape->def.body != NULL ? shape->def.body->vertices : 0);
        while (point < end) {
            of->friction[point++] = shape->friction;
        }
    }
    of->pairs.friction = of->friction;
    return of->friction != NULL;
}

static bool bodies_init(void *own, const weft_cloth_def *def,
                        const weft_allocator *memory)
{
    weft__bodies *of = own;
    const size_t vertices = weft__shapes_vertices(of->contact);
    of->memory = *memory;
    of->pairs.law = def->contact;
    of->pairs.law.self = vertices > 0;
    of->pairs.between = true;
    of->pairs.points = of->pairs.mesh->particles + vertices;
    return vertices == 0 || (find_friction(of, memory) && cover(of, def, memory));
}

static bool bodies_present(const void *own)
{
    return ((const weft__bodies *)own)->pairs.law.self;
}

static void bodies_free_own(void *own, const weft_allocator *memory)
{
    weft__bodies *of = own;
    if (!of->pairs.shared) {
        weft__contact_surface_destroy(of->pairs.surface, memory);
        weft__free(memory, of->friction);
    }
}

static size_t bodies_bytes(const void *own)
{
    const weft__bodies *of = own;
    return of->pairs.surface != NULL ? weft__contact_surface_bytes(of->pairs.surface)
                                     : 0;
}

static void bodies_space_destroy(void *in)
{
    weft__bodies_space *space = in;
    const weft_allocator memory = space->memory;
    weft__self_list_destroy(space->list);
    WEFT__FREE_ALL(&memory, space->now.y, space->before.y, space->marks, space);
}

static void *bodies_space_create(const void *own, weft__pool *pool,
                                 const size_t part[2], const weft_allocator *memory)
{
    const weft__bodies *of = own;
    weft__bodies_space *out = weft__zeroed(memory, 1, sizeof *out);
    if (out == NULL) {
        return NULL;
    }
    out->own = of;
    out->memory = *memory;
    out->list = weft__self_list_create(&of->pairs, pool, part, memory);
    out->now.y = weft__alloc(memory, 6 * of->pairs.points, sizeof *out->now.y);
    out->before.y = weft__alloc(memory, 6 * of->pairs.points, sizeof *out->before.y);
    out->marks = weft__alloc(memory, of->pairs.mesh->particles, 1);
    if (out->list == NULL || out->now.y == NULL || out->before.y == NULL
        || out->marks == NULL) {
        bodies_space_destroy(out);
        return NULL;
    }
    return out;
}

static weft_status bodies_space_grow(void *space, weft_error *err)
{
    return weft__self_list_grow(((weft__bodies_space *)space)->list, err);
}

static bool bodies_asked(const weft_cloth_def *def)
{
    bool asked = false;
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        asked = asked || def->contact.shapes[k].kind == WEFT_MESH;
    }
    return asked;
}

static void bodies_leave_out(void *own)
{
    ((weft__bodies *)own)->pairs.law.self = false;
}

const weft__force weft__bodies_force
    = { .name = "bodies",
        .tables.init = bodies_init,
        .tables.choose = weft__self_choose,
        .tables.copy = weft__self_copy,
        .tables.free = bodies_free_own,
        .tables.leave_out = bodies_leave_out,
        .tables.bytes = bodies_bytes,
        .present = bodies_present,
        .bounds.range_stiffness = weft__bodies_range_stiffness,
        .bounds.multiply = weft__bodies_multiply,
        .couplings.blocks = weft__bodies_blocks,
        .space = { bodies_space_create, bodies_space_grow, bodies_space_destroy },
        .checks.asked = bodies_asked,
        .checks.no_bands = "a shape of kind mesh",
        .checks.clear_pairs = weft__bodies_clear,
        .checks.hold_pairs = weft__bodies_hold,
        .checks.other = weft__bodies_other,
        .checks.closing = weft__bodies_closing,
        .checks.crossing = weft__bodies_error,
        .whole.add = weft__bodies_add,
        .whole.transposed = weft__bodies_transposed,
        .whole.measure = weft__bodies_measure };
