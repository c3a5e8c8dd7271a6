/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_slice.c -- a band of a cloth of triangles: all is made of the whole, so that it
 * has the same bits, and then cut. */
#include "cloth/cloth_slice.h"

#include "mesh/grid_def.h"
#include "mesh/slice.h"

weft_status weft__slice_check(const weft_cloth_def *def, weft_error *err)
{
    const weft_mesh_def *mesh = def->mesh;
    if (mesh == NULL || def->band_rows == 0) {
        return WEFT_OK;
    }
    const size_t all = weft_cloth_def_blocks(def);
    const char *of_force = weft__def_no_bands(def);
    if (def->band_rows > all || def->band_first > all - def->band_rows) {
        return weft_error_set(err, WEFT_INVALID,
                              "a band of %zu blocks from block %zu of %zu: it must lie "
                              "inside",
                              def->band_rows, def->band_first, all);
    }
    const char *why = mesh->arc             ? "membrane arc"
                      : mesh->grids != NULL ? "a grid"
                      : of_force != NULL    ? of_force
                      : def->untangle > 0.0 ? "untangle"
                                            : NULL;
    return why == NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_UNSUPPORTED,
                                "a cloth of triangles with %s has no bands", why);
}

static void mark(uint32_t *here, const uint32_t *particles, size_t count)
{
    for (size_t j = 0; j < count; ++j) {
        here[particles[j]] = 0;
    }
}

/* What is here: the own particles, and what their blocks read. */
static void mark_all(const weft_cloth *cloth, const weft__slice *slice)
{
    const weft__mesh *mesh = &cloth->mesh;
    memset(slice->here, 0xff, mesh->particles * sizeof *slice->here);
    for (size_t b = slice->first; b < slice->first + slice->own; ++b) {
        for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
            slice->here[i] = 0;
        }
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            const weft__force *force = weft__force_at(cloth, k);
            const uint32_t *particles;
            if (force != NULL && force->tables.halo != NULL) {
                const size_t count
                    = force->tables.halo(weft__own(cloth, k), b, &particles);
                mark(slice->here, particles, count);
            }
        }
    }
}

/* Numbers what is marked. */
static void number_all(const weft__mesh *mesh, weft__slice *slice)
{
    const size_t first = weft__block(mesh, slice->first);
    size_t before = 0, next = 0;
    for (size_t i = 0; i < first; ++i) {
        before += slice->here[i] == 0;
    }
    slice->above = (before + mesh->block - 1) / mesh->block;
    for (size_t i = 0; i < mesh->particles; ++i) {
        if (slice->here[i] == 0) {
            const size_t missing
                = next == 0 && before > 0 ? slice->above * mesh->block - before : 0;
            for (size_t k = 0; k <= missing; ++k) {
                slice->whole[next++] = (uint32_t)i;
            }
            slice->here[i] = (uint32_t)next - 1;
        }
    }
    slice->particles = next;
}

static bool slice_all(weft_cloth *cloth, weft__slice *slice)
{
    weft__mesh *mesh = &cloth->mesh;
    mark_all(cloth, slice);
    number_all(mesh, slice);
    bool made = weft__mesh_slice(mesh, slice);
    for (size_t k = 0; made && k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        made = force == NULL || force->tables.slice == NULL
               || force->tables.slice(weft__own_of(cloth, k), slice);
    }
    return made;
}

weft_status weft__cloth_slice(weft_cloth *cloth, const weft_cloth_def *def,
                              weft_error *err)
{
    weft__mesh *mesh = &cloth->mesh;
    const weft_allocator *memory = &cloth->memory;
    if (mesh->triangles == NULL || !weft__is_band(def)) {
        return WEFT_OK;
    }
    cloth->whole_hash = weft__cloth_hash(cloth, NULL);
    weft__slice slice
        = { .first = def->band_first,
            .own = def->band_rows,
            .memory = memory,
            .whole = weft__alloc(memory, mesh->particles, sizeof *slice.whole),
            .here = weft__alloc(memory, mesh->particles, sizeof *slice.here),
            .triangle
            = weft__alloc(memory, mesh->triangles->count, sizeof *slice.triangle) };
    mesh->whole_of = slice.whole;
    const bool made = slice.whole != NULL && slice.here != NULL
                      && slice.triangle != NULL && slice_all(cloth, &slice);
    WEFT__FREE_ALL(memory, slice.here, slice.triangle);
    if (made) {
        weft__slice_range(&slice, &mesh->whole_of, 0, mesh->particles,
                          sizeof *mesh->whole_of);
    }
    return made ? WEFT_OK : weft_error_set(err, WEFT_NO_MEMORY, "no memory for a band");
}
