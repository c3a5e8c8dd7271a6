/* SPDX-License-Identifier: BSD-3-Clause */
/* roles.h -- the roles of a force besides its law (force.h): its tables, what it is in
 * grids among several cloths, what a simulation changes, what it tells of a state, its
 * bounds, its linearisation, its workspace, and what it does after all blocks; checks
 * of steps are in force_checks.h. A member that is NULL has nothing to do. */
#pragma once

#include <string.h>

#include "base/isa.h"
#include "forces/state.h"
#include "mesh/slice.h"

/* Adds what block b has to *sum. */
typedef void weft__block_fn(const void *own, const weft__state *at, size_t b,
                            weft_measures *sum);

struct weft__pool;
struct weft__sides; /* bounds.h: what bounds the modes of a particle */
struct weft__range_stiffness;

/* An array of a weft_cloth_def, whose elements may be those of another version: offsets
 * of its pointer, of their number, and of their size, which a caller gives. */
typedef struct weft__def_array {
    const char *type, *name;
    size_t size, items, count, given;
} weft__def_array;

static inline const void *weft__array_items(const weft__def_array *of,
                                            const weft_cloth_def *def)
{
    const void *items;
    memcpy(&items, (const char *)def + of->items, sizeof items);
    return items;
}

static inline size_t weft__array_count(const weft__def_array *of,
                                       const weft_cloth_def *def)
{
    size_t count;
    memcpy(&count, (const char *)def + of->count, sizeof count);
    return count;
}

static inline size_t weft__array_size(const weft__def_array *of,
                                      const weft_cloth_def *def)
{
    uint32_t given;
    memcpy(&given, (const char *)def + of->given, sizeof given);
    return given;
}

/* What a cloth has of a force: its numbers and tables. */
typedef struct weft__force_tables {
    void (*defaults)(weft_cloth_def *def);
    const weft__def_array *array; /* NULL: none */
    void (*check)(const weft_cloth_def *def, const weft__faults *to);
    bool (*init)(void *own, const weft_cloth_def *def, const weft_allocator *memory);
    uint64_t (*hash)(const void *own, uint64_t hash);
    void (*choose)(void *own, weft__isa isa);              /* the fast forms */
    bool (*copy)(void *own, const weft_allocator *memory); /* false: no memory */
    void (*free)(void *own, const weft_allocator *memory);
    void (*leave_out)(void *own);     /* removes it from this cloth */
    size_t (*bytes)(const void *own); /* of its tables */

    /* Whether the own of another cloth is of the same springs, shapes and so on, of
     * which only numbers differ; NULL: always. */
    bool (*alike)(const void *own, const void *other);
    bool (*slows)(const weft_cloth_def *def); /* whether it brakes every motion */

    /* Of a whole cloth of triangles: the particles that block b reads beyond its own
     * and its triangles' corners; and what becomes its band, after that of the mesh.
     * False: no memory. */
    size_t (*halo)(const void *own, size_t b, const uint32_t **particles);
    bool (*slice)(void *own, const weft__slice *slice);
} weft__force_tables;

/* A scene may have grids among several cloths (cloth/grids.h). `have_it`: each grid
 * computes this force for itself, and takes no memory for it. `measured`: it also
 * computes the force's energy, power and strain. `define` copies what a grid's
 * definition takes from the whole, `share` what a grid's own takes from the whole's. */
typedef struct weft__force_grids {
    bool have_it, measured;
    void (*define)(const weft_cloth_def *whole, weft_cloth_def *grid);
    void (*share)(void *own, const void *whole);
} weft__force_grids;

/* A simulation may change some values of a force between steps, and saves and restores
 * them as words (base/bytes.h; cloth/changes.c). `put` writes them. `take` gets a
 * bitwise copy of the present own, and puts the saved values into it; without words
 * those of the definition. `exchange` swaps the values of both, `drop` frees those that
 * were taken, even if `take` failed. */
typedef struct weft__force_changes {
    size_t (*words)(const void *own); /* of what it is at present */
    void (*put)(const void *own, unsigned char *to);
    weft_status (*take)(void *own, const unsigned char *from, size_t words,
                        const weft_allocator *memory, weft_error *err);
    void (*exchange)(void *own, void *taken);
    void (*drop)(void *taken, const weft_allocator *memory);
} weft__force_changes;

/* What it tells of a state. */
typedef struct weft__force_measures {
    weft__block_fn *energy, *power; /* [J]; [W] */
    weft__block_fn *worst;          /* the largest strain, by weft__keep_worst */
    weft__block_fn *gaps;           /* gaps and touches, by weft__keep_gap */

    /* Raises strain[v], v = weft__shown(mesh, i), to the largest strain at each
     * particle i that block b has. */
    void (*strains)(const void *own, const weft__state *at, size_t b, double *strain);
} weft__force_measures;

/* Its stiffness and damping: the ratios of the two that it has; what it adds for each
 * side to the bound of free particle i, at->y NULL: in any state (of a membrane: see
 * membrane_bounds.c); instead of that, what it adds to those of particles [first, first
 * + count) at once, and to (a K + b C) x, for the power method, which has the others
 * from their linearisation. */
typedef struct weft__force_bounds {
    void (*ratios)(const void *own, struct weft__sides *to);
    void (*particle)(const void *own, const weft__state *at, size_t i,
                     const struct weft__sides *sides, double (*sums)[6]);
    void (*range_stiffness)(const void *own, void *space, const weft__state *at,
                            size_t first, size_t count,
                            struct weft__range_stiffness *range_stiffness);
    void (*multiply)(const void *own, const weft__state *at, double a, double b,
                     const double *x, double *out);
} weft__force_bounds;

/* Its linearisation, for weft_structure: its spring couplings that begin in block b,
 * and what they are in a state; or 3 x 3 blocks of particles, with a workspace or NULL.
 * On triangles: its block couplings, which must be its alone, and their numbers; its
 * scalar couplings. NULL as `to`: only how many there are. */
typedef struct weft__force_couplings {
    size_t (*runs)(const void *own, size_t b, weft_spring_run *runs);
    double *(*springs)(const void *own, const weft__state *at, size_t b, double *planes,
                       size_t spring_couplings, double *bad);
    int (*blocks)(const void *own, void *space, const weft__state *at, double *blocks);
    size_t (*block_couplings)(const void *own, weft_block_coupling *to);
    int (*block_numbers)(const void *own, const weft__state *at, double *numbers);
    size_t (*scalar_couplings)(const void *own, weft_scalar_coupling *to);
} weft__force_couplings;

/* The workspace of a simulation, for forces of a whole cloth: with `part` what acts on
 * points [part[0], part[1]) suffices. NULL: no memory. `grow`, between steps, makes
 * room for what was too much for it. */
typedef struct weft__force_space {
    void *(*create)(const void *own, struct weft__pool *pool, const size_t part[2],
                    const weft_allocator *memory);
    weft_status (*grow)(void *space, weft_error *err);
    void (*destroy)(void *space);
} weft__force_space;

/* Of a whole cloth, after all blocks, for forces between particles of any blocks: with
 * a workspace of a simulation (NULL: the same without one, slower), which may be that
 * of a perturbed copy: of a cloth with other parameters, whose pairs are near enough.
 */
typedef struct weft__force_whole {
    int (*add)(const void *own, void *space, const weft__state *at, weft__unit unit,
               double *to);

    /* The part of `add` on particles [first, end), accelerations, to planes of
     * `stride`. */
    int (*add_part)(const void *own, void *space, const double *y, size_t first,
                    size_t end, size_t stride, double *to);
    int (*transposed)(const void *own, void *space, const weft__state *at, double *out);
    void (*measure)(const void *own, void *space, const weft__state *at,
                    weft_measures *sum);
} weft__force_whole;

/* Keeps the one of larger strain, the first of equal ones; NaN is larger than every
 * number. */
static inline void weft__keep_worst(weft_spring *kept, const weft_spring *other)
{
    if (kept->p == kept->q
        || (!isnan(kept->strain) && !(other->strain <= kept->strain))) {
        *kept = *other;
    }
}

/* Keeps the smaller gap; NaN is smaller than a number. */
static inline void weft__keep_gap(weft_measures *kept, double gap, size_t particle,
                                  size_t shape)
{
    if (!isnan(kept->gap) && !(gap >= kept->gap)) {
        kept->gap = gap;
        kept->gap_particle = particle;
        kept->gap_shape = shape;
    }
}
