/* SPDX-License-Identifier: BSD-3-Clause */
/* angles.c -- the force of angles.h: its tables, its loops over blocks, energy, powers
 * and bounds. */
#include "forces/bending/angles.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/plane.h"
#include "forces/bounds.h"
#include "mesh/triangles_work.h"

/* Without a state, triangles are taken stretched and squeezed by so much, and w and s n
 * as far apart as s. */
#define STRETCHED 1.1
#define SQUEEZED  0.81

static const weft__plate_rest *rest_of(const weft__angles *own)
{
    return &own->plate->matrix.rest;
}

static bool angles_present(const void *own)
{
    return ((const weft__angles *)own)->list != NULL;
}

/* ---- tables ---------------------------------------------------------------------- */

/* The triangles of each block, once each. */
static bool list_blocks(weft__angles *of, const weft_allocator *memory)
{
    const weft__plate_rest *rest = rest_of(of);
    const size_t blocks = weft__blocks(of->mesh);
    size_t *last = weft__zeroed(memory, blocks, sizeof *last);
    of->first = weft__zeroed(memory, blocks + 2, sizeof *of->first);
    bool made = last != NULL && of->first != NULL;
    for (size_t pass = 0; made && pass < 2; ++pass) {
        memset(last, 0, blocks * sizeof *last);
        for (size_t item = 0; item < rest->count; ++item) {
            for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
                const size_t b = rest->particle[j] / WEFT__MESH_BLOCK;
                if (last[b] != item + 1) {
                    last[b] = item + 1;
                    if (pass == 0) {
                        ++of->first[b + 2];
                    } else {
                        of->list[of->first[b + 1]++] = (uint32_t)item;
                    }
                }
            }
        }
        for (size_t b = 2; pass == 0 && b < blocks + 2; ++b) {
            of->first[b] += of->first[b - 1];
        }
        if (pass == 0) {
            of->list = weft__alloc(memory, of->first[blocks + 1], sizeof *of->list);
            made = of->list != NULL;
        }
    }
    weft__free(memory, last);
    return made;
}

/* The entries of each particle, for bounds. */
static bool list_entries(weft__angles *of, const weft_allocator *memory)
{
    const weft__plate_rest *rest = rest_of(of);
    const size_t n = of->mesh->particles, entries = rest->first[rest->count];
    of->begin = weft__zeroed(memory, n + 2, sizeof *of->begin);
    of->entry = weft__alloc(memory, entries, sizeof *of->entry);
    of->item = weft__alloc(memory, entries, sizeof *of->item);
    if (of->begin == NULL || of->entry == NULL || of->item == NULL) {
        return false;
    }
    for (size_t j = 0; j < entries; ++j) {
        ++of->begin[rest->particle[j] + 2];
    }
    for (size_t i = 2; i < n + 2; ++i) {
        of->begin[i] += of->begin[i - 1];
    }
    for (size_t item = 0; item < rest->count; ++item) {
        for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
            const size_t at = of->begin[rest->particle[j] + 1]++;
            of->entry[at] = (uint32_t)j;
            of->item[at] = (uint32_t)item;
        }
    }
    return true;
}

static bool angles_init(void *own, const weft_cloth_def *def,
                        const weft_allocator *memory)
{
    weft__angles *of = own;
    (void)def;
    return rest_of(of)->count == 0
           || (list_blocks(of, memory) && list_entries(of, memory));
}

static bool angles_copy(void *own, const weft_allocator *memory)
{
    (void)memory;
    ((weft__angles *)own)->copied = true;
    return true;
}

static void angles_free(void *own, const weft_allocator *memory)
{
    weft__angles *of = own;
    if (!of->copied) {
        WEFT__FREE_ALL(memory, of->first, of->list, of->begin, of->entry, of->item);
    }
}

static uint64_t angles_hash(const void *own, uint64_t hash)
{
    const weft__angles *of = own;
    const weft__plate_rest *rest = rest_of(of);
    for (size_t item = 0; angles_present(own) && item < rest->count; ++item) {
        hash = weft__hash_word(hash, rest->triangle[item]);
        hash = weft__hash_real(hash, rest->square[item]);
        for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
            hash = weft__hash_word(hash, rest->particle[j]);
            hash = weft__hash_real(hash, rest->weight[j]);
        }
    }
    return hash;
}

static size_t angles_bytes(const void *own)
{
    const weft__angles *of = own;
    const weft__plate_rest *rest = rest_of(of);
    const size_t blocks = weft__blocks(of->mesh), entries = rest->first[rest->count];
    return of->first[blocks] * sizeof *of->list + (blocks + 2) * sizeof *of->first
           + (of->mesh->particles + 2) * sizeof *of->begin
           + entries
                 * (sizeof *of->entry + sizeof *of->item + sizeof *rest->particle
                    + sizeof *rest->weight)
           + rest->count
                 * (sizeof *rest->triangle + sizeof *rest->square
                    + sizeof *rest->first);
}

/* ---- the force ------------------------------------------------------------------- */

/* [N] on the own particles of block b, or its change along at->along. */
static void block_force(const weft__angles *own, const weft__state *at, size_t b,
                        double (*force)[3])
{
    const weft__plate_rest *rest = rest_of(own);
    const size_t first = weft__block(own->mesh, b);
    const size_t count = weft__block(own->mesh, b + 1) - first; /* below wraps above */
    memset(force, 0, count * sizeof *force);
    for (size_t l = own->first[b]; l < own->first[b + 1]; ++l) {
        const size_t item = own->list[l];
        const uint32_t *corner = own->mesh->triangles->corner[rest->triangle[item]];
        weft__facet_force one;
        weft__facet_force_of(own, item, at, &one);
        for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
            const size_t i = rest->particle[j] - first;
            if (i < count) {
                const double weight = rest->weight[j];
                force[i][0] += weight * one.on[0];
                force[i][1] += weight * one.on[1];
                force[i][2] += weight * one.on[2];
            }
        }
        for (size_t c = 0; c < 3; ++c) {
            const size_t i = corner[c] - first;
            for (size_t k = 0; i < count && k < 3; ++k) {
                force[i][k] += one.corner[c][k];
            }
        }
    }
}

static int angles_add(const void *own, const weft__state *at, weft__unit unit,
                      double *to, size_t first, size_t end)
{
    const weft__angles *of = own;
    double force[WEFT__MESH_BLOCK][3], bad = 0.0;
    for (size_t b = first; b < end; ++b) {
        const size_t low = weft__block(of->mesh, b);
        const size_t high = weft__block(of->mesh, b + 1);
        if (of->first[b] < of->first[b + 1]) {
            block_force(of, at, b, force);
            for (size_t i = low; i < high; ++i) {
                bad += weft__force_add(of->mesh, unit, i, force[i - low], to);
            }
        }
    }
    return bad == 0.0 ? 0 : 1;
}

/* ---- energy and powers ----------------------------------------------------------- */

/* Whether block b has the first corner of a triangle. */
static bool angles_owned(const weft__angles *own, size_t b, size_t item)
{
    const weft__triangles *of = own->mesh->triangles;
    return of->corner[rest_of(own)->triangle[item]][0] / WEFT__MESH_BLOCK == b;
}

static void angles_energy(const void *own, const weft__state *at, size_t b,
                          weft_measures *sum)
{
    const weft__angles *of = own;
    for (size_t l = of->first[b]; l < of->first[b + 1]; ++l) {
        weft__facet now;
        if (angles_owned(of, b, of->list[l])) {
            weft__facet_of(of, of->list[l], at->y, &now);
            sum->energy.elastic[WEFT_BEND]
                += 0.5 * rest_of(of)->square[of->list[l]] - weft__dot(now.n, now.w);
        }
    }
}

static void angles_power(const void *own, const weft__state *at, size_t b,
                         weft_measures *sum)
{
    const weft__angles *of = own;
    const weft__triangles *mesh = of->mesh->triangles;
    double force[WEFT__MESH_BLOCK][3], rate[6];
    bool moves = false;
    for (size_t l = of->first[b]; l < of->first[b + 1]; ++l) {
        const size_t item = of->list[l];
        const uint32_t t = rest_of(of)->triangle[item];
        const double tau = mesh->fabrics[mesh->fabric[t]].damping[1];
        weft__facet now;
        if (tau > 0.0 && angles_owned(of, b, item)) {
            weft__facet_of(of, item, at->y, &now);
            sum->power[WEFT_POWER_SPRINGS]
                += tau
                   * (rest_of(of)->square[item] * weft__dot(now.rate, now.rate)
                      - 2.0 * weft__dot(now.rate, now.v));
        }
    }
    const size_t first = weft__block(of->mesh, b);
    for (size_t i = first; i < weft__block(of->mesh, b + 1); ++i) {
        if (weft__pin_moves(of->mesh, i)) {
            if (!moves) {
                block_force(of, at, b, force);
            }
            moves = true;
            weft__pin_rate(of->mesh, i, at->t, weft__piece(at), rate);
            sum->power[WEFT_POWER_PINS] -= weft__dot(force[i - first], rate);
        }
    }
}

/* ---- bounds ---------------------------------------------------------------------- */

/* What bounds a triangle: |dn/dx_i| of its corners, their sum, and the residual. */
typedef struct turn_bound {
    double lean[3], leans, weights; /* [1/m], [1/m], [N/m] */
    double size, left;              /* [m^2], [N] */
} turn_bound;

static void bound_turn(const weft__angles *own, const weft__state *at, size_t item,
                       turn_bound *out)
{
    const weft__plate_rest *rest = rest_of(own);
    const weft__triangles *mesh = own->mesh->triangles;
    const uint32_t t = rest->triangle[item];
    weft__facet now;
    double left[3];
    out->size = 2.0 * mesh->area[t] * SQUEEZED;
    out->left = rest->square[item];
    out->leans = out->weights = 0.0;
    if (at->y != NULL) {
        weft__facet_of(own, item, at->y, &now);
        for (size_t k = 0; k < 3; ++k) {
            left[k] = now.w[k] - rest->square[item] * now.n[k];
        }
        out->size = now.size;
        out->left = weft__length(left);
    }
    for (size_t i = 0; i < 3; ++i) {
        const double length
            = at->y != NULL
                  ? weft__length(now.e[i])
                  : STRETCHED
                        * sqrt(weft__squared(weft__rest_at(mesh, t, (i + 1) % 3),
                                             weft__rest_at(mesh, t, (i + 2) % 3)));
        out->lean[i] = length / out->size;
        out->leans += out->lean[i];
    }
    for (size_t j = rest->first[item]; j < rest->first[item + 1]; ++j) {
        out->weights += fabs(rest->weight[j]);
    }
}

/* With |dn/dx_i| <= v_i = |e_i| / |c|, weights w_i of the row and y = w - s n, the
 * blocks of the second derivative beyond K are at most |w_i| v_j + v_i |w_j| + s v_i
 * v_j, which damping has too, and |y| (3 v_i v_j + 1 / |c| between corners). */
static void angles_bound(const void *own, const weft__state *at, size_t i,
                         const weft__sides *sides, double (*sums)[6])
{
    const weft__angles *of = own;
    const weft__plate_rest *rest = rest_of(of);
    const weft__triangles *mesh = of->mesh->triangles;
    for (size_t j = of->begin[i]; j < of->begin[i + 1]; ++j) {
        const size_t item = of->item[j];
        const uint32_t t = rest->triangle[item], *corner = mesh->corner[t];
        const double tau = mesh->fabrics[mesh->fabric[t]].damping[1];
        const double weight = fabs(rest->weight[of->entry[j]]);
        const size_t c = corner[0] == i ? 0 : corner[1] == i ? 1 : 2;
        turn_bound is;
        bound_turn(of, at, item, &is);
        const bool own_corner = corner[c] == i;
        const double lean = own_corner ? is.lean[c] : 0.0;
        const double stiff = weight * is.leans + lean * is.weights
                             + rest->square[item] * lean * is.leans;
        const double left
            = own_corner ? is.left * (3.0 * lean * is.leans + 2.0 / is.size) : 0.0;
        for (size_t s = 0; s < sides->count; ++s) {
            const double *d = sides->direction[s];
            weft__bound_add(sums[s],
                            (fmax(0.0, d[0] + d[1] * tau) * stiff + fabs(d[0]) * left)
                                * of->mesh->inverse_mass[i]);
        }
    }
}

static bool angles_asked(const weft_cloth_def *def)
{
    return def->mesh != NULL && weft__any_starts_bent(def->mesh);
}

const weft__force weft__angles_force = { .name = "angles",
                                         .tables.init = angles_init,
                                         .tables.hash = angles_hash,
                                         .tables.copy = angles_copy,
                                         .tables.free = angles_free,
                                         .tables.bytes = angles_bytes,
                                         .present = angles_present,
                                         .law.add = angles_add,
                                         .law.change = angles_add,
                                         .law.transposed = weft__angles_transposed,
                                         .measures.energy = angles_energy,
                                         .measures.power = angles_power,
                                         .bounds.particle = angles_bound,
                                         .bounds.multiply = weft__angles_multiply,
                                         .checks.asked = angles_asked,
                                         .checks.no_bands = "angle: start" };
