/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane.c -- the membrane of membrane.h as a weft__force: its energy and powers. */
#include "base/hash.h"
#include "forces/membrane/membrane_law.h"

static bool membrane_present(const void *own)
{
    return ((const weft__membrane *)own)->blocks != NULL;
}

static int membrane_add(const void *own, const weft__state *at, weft__unit unit,
                        double *to, size_t first, size_t end)
{
    const weft__membrane *of = own;
    const bool change = at->along != NULL;
    weft__add_fn *form
        = unit == WEFT__FORCE || change ? weft__membrane_loops : of->fast;
    int failed = form(own, at, unit, to, first, end);
    if (of->arc.begin != NULL) {
        form = change ? weft__arc_loops : of->arc.fast;
        failed |= form(own, at, unit, to, first, end);
    }
    return failed;
}

static void membrane_choose(void *own, weft__isa isa)
{
    weft__membrane *of = own;
    of->fast = WEFT_FORM(isa, membrane);
    of->arc.fast = WEFT_FORM(isa, arc);
}

/* Of what determines the force: constants, and which particles have them, in the order
 * of addition. Nothing on a grid. */
static uint64_t membrane_hash_of(const void *own, uint64_t hash)
{
    const weft__membrane *of = own;
    for (size_t b = 0; of->blocks != NULL && b < weft__blocks(of->mesh); ++b) {
        weft__triangle tri;
        for (size_t next = 0; weft__membrane_each(of, b, &next, &tri);) {
            for (size_t k = 0; k < WEFT__CONSTANTS; ++k) {
                hash = weft__hash_real(hash, CONSTANT(tri.of, k));
            }
            for (size_t c = 0; c < 3; ++c) {
                hash = weft__hash_word(hash, tri.corner[c]);
            }
        }
    }
    const weft__edge_slopes *rows = &of->arc.rows;
    for (size_t j = 0; j < rows->count; ++j) {
        hash = weft__hash_word(hash, rows->particle[j]);
        hash = weft__hash_real(hash, rows->share[j]);
    }
    return hash;
}

/* ---- energy and powers ----------------------------------------------------------- */

static void triangle_energy(const weft__membrane *own, const weft__triangle *tri,
                            const double *y, weft_energy *sum)
{
    const weft__triangles *mesh = own->mesh->triangles;
    const weft_fabric *fabric = &mesh->fabrics[mesh->fabric[tri->number]];
    weft__sides3 now;
    double square[3];
    weft__membrane_sides(own->mesh, tri->corner, y, &now);
    weft__membrane_squares(&now, square);
    const double half = 0.5 * mesh->area[tri->number], area = law_area(square);
    const double least = CONSTANT(tri->of, WEFT__LEAST);
    double shape[3][3], e[3] = { 0.0, 0.0, 0.0 }, stress[3], arc[2];
    weft__membrane_shape(mesh, tri->number, shape);
    for (size_t i = 0; i < 3; ++i) {
        weft__arc_square(own, y, mesh->edge[tri->number][i], arc);
        const double q = square[i] - CONSTANT(tri->of, WEFT__SQUARE + i) + arc[0];
        for (size_t k = 0; k < 3; ++k) {
            e[k] += q * shape[i][k];
        }
    }
    weft__membrane_stress(fabric, e, stress);
    sum->elastic[WEFT_STRETCH] += half * (e[0] * stress[0] + e[1] * stress[1]);
    sum->elastic[WEFT_SHEAR] += half * 2.0 * e[2] * stress[2];
    if (area < least) {
        const double r = fmax(area, 0.0) / least, z = 1.0 - r;
        sum->elastic[WEFT_STRETCH]
            += CONSTANT(tri->of, WEFT__GUARD) * (z * z) * (z * z) / r;
    }
}

static void membrane_energy(const void *own, const weft__state *at, size_t b,
                            weft_measures *sum)
{
    const weft__membrane *of = own;
    weft__triangle tri;
    for (size_t next = 0; weft__membrane_each_own(of, b, &next, &tri);) {
        triangle_energy(of, &tri, at->y, &sum->energy);
    }
}

/* [W] damping dq/dt.K dq/dt / 2 */
static double heat_of(const weft__membrane *own, const weft__triangle *tri,
                      const double *y)
{
    weft__sides3 at;
    double rate[3], s[3], arc[2];
    weft__membrane_sides(own->mesh, tri->corner, y, &at);
    for (size_t i = 0; i < 3; ++i) {
        weft__arc_square(own, y, own->mesh->triangles->edge[tri->number][i], arc);
        rate[i] = 2.0 * weft__dot(at.d[i], at.w[i]) + arc[1];
    }
    law_stiff(tri->of, rate, s);
    return 0.25 * CONSTANT(tri->of, WEFT__LAG) * weft__dot(rate, s);
}

/* What the motion of pins does against the membrane. */
static double membrane_pin_power(const weft__membrane *own, const weft__state *at,
                                 size_t b)
{
    const weft__mesh *mesh = own->mesh;
    double force[WEFT__MESH_BLOCK][3], rate[6], power = 0.0;
    const size_t first = weft__block(mesh, b);
    bool moves = false;
    for (size_t i = first; i < weft__block(mesh, b + 1); ++i) {
        if (weft__pin_moves(mesh, i)) {
            if (!moves) {
                weft__membrane_forces(own, at, b, force);
            }
            moves = true;
            weft__pin_rate(mesh, i, at->t, weft__piece(at), rate);
            power -= weft__dot(force[i - first], rate);
            if (own->arc.begin != NULL) {
                weft__arc_force(own, at, i, force[i - first]);
                power -= weft__dot(force[i - first], rate);
            }
        }
    }
    return power;
}

static void membrane_power(const void *own, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    const weft__membrane *of = own;
    weft__triangle tri;
    sum->power[WEFT_POWER_PINS] += membrane_pin_power(of, at, b);
    for (size_t next = 0; of->damped && weft__membrane_each_own(of, b, &next, &tri);) {
        sum->power[WEFT_POWER_SPRINGS] += heat_of(of, &tri, at->y);
    }
}

/* ---- strain ---------------------------------------------------------------------- */

/* Of edge i of a triangle. */
static weft_spring membrane_strain_of(const weft__membrane *own,
                                      const weft__triangle *tri, const double *y,
                                      size_t i)
{
    weft__sides3 now;
    weft__membrane_sides(own->mesh, tri->corner, y, &now);
    const double square
        = CONSTANT(tri->of, WEFT__SQUARE + i) - weft__arc_bow(own, tri->number, i);
    const uint32_t a = tri->corner[(i + 1) % 3], b = tri->corner[(i + 2) % 3];
    return (weft_spring){ .family = WEFT_STRETCH,
                          .p = a < b ? a : b,
                          .q = a < b ? b : a,
                          .strain
                          = sqrt(weft__dot(now.d[i], now.d[i]) / square) - 1.0 };
}

static void membrane_worst(const void *own, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    const weft__membrane *of = own;
    weft__triangle tri;
    for (size_t next = 0; weft__membrane_each_own(of, b, &next, &tri);) {
        for (size_t i = 0; i < 3; ++i) {
            const weft_spring edge = membrane_strain_of(of, &tri, at->y, i);
            weft__keep_worst(&sum->worst, &edge);
        }
    }
}

static void membrane_strains(const void *own, const weft__state *at, size_t b,
                             double *strain)
{
    const weft__membrane *of = own;
    weft__triangle tri;
    for (size_t next = 0; weft__membrane_each(of, b, &next, &tri);) {
        for (size_t i = 0; i < 3; ++i) {
            const weft_spring edge = membrane_strain_of(of, &tri, at->y, i);
            const size_t p = weft__shown(of->mesh, edge.p);
            const size_t q = weft__shown(of->mesh, edge.q);
            strain[p] = fmax(strain[p], edge.strain);
            strain[q] = fmax(strain[q], edge.strain);
        }
    }
}

static size_t membrane_bytes(const void *own)
{
    const weft__membrane *of = own;
    const size_t blocks = weft__blocks(of->mesh);
    return of->blocks[blocks].batch * (sizeof *of->batches + sizeof *of->corners)
           + of->blocks[blocks].halo * sizeof *of->halo
           + of->coupling_first[of->mesh->particles] * sizeof *of->coupling
           + of->mesh->particles * sizeof *of->coupling_first + weft__arc_bytes(of)
           + of->mesh->particles * sizeof *of->weight
           + (blocks + 1) * sizeof *of->blocks;
}

static size_t membrane_halo(const void *own, size_t b, const uint32_t **particles)
{
    const weft__membrane *of = own;
    *particles = of->halo + of->blocks[b].halo;
    return of->blocks[b + 1].halo - of->blocks[b].halo;
}

const weft__force weft__membrane_force
    = { .name = "membrane",
        .tables.check = weft__membrane_check,
        .tables.init = weft__membrane_init,
        .tables.hash = membrane_hash_of,
        .tables.choose = membrane_choose,
        .tables.copy = weft__membrane_copy,
        .tables.free = weft__membrane_free,
        .tables.bytes = membrane_bytes,
        .tables.halo = membrane_halo,
        .tables.slice = weft__membrane_slice,
        .present = membrane_present,
        .law.add = membrane_add,
        .law.change = membrane_add,
        .law.transposed = weft__membrane_transposed,
        .measures.energy = membrane_energy,
        .measures.power = membrane_power,
        .measures.worst = membrane_worst,
        .measures.strains = membrane_strains,
        .couplings.block_couplings = weft__membrane_couplings,
        .couplings.block_numbers = weft__membrane_coupling_numbers,
        .bounds.ratios = weft__membrane_ratios,
        .bounds.particle = weft__membrane_bound };
