/* SPDX-License-Identifier: BSD-3-Clause */
/* measure.c -- measures of a state: energies, momenta, powers, strain, hash.
 *
 * A sum over particles or springs is one over blocks, in their order, of sums over each
 * block: the same on every machine and on any number of threads. Kinetic and
 * gravitational energy and both momenta are those of the free particles. The powers of
 * forces, of moved pins and of shapes change the energy E (docs/theory/model.md). */
#include "base/hash.h"
#include "cloth/grids.h"
#include "mesh/triangles.h"

void weft__block_energy(const weft_cloth *cloth, const weft__state *at, size_t b,
                        weft_measures *sum)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        const double *z = at->y + i;
        const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
        if (mesh->pin[i] == 0) {
            sum->energy.kinetic += 0.5 * mesh->mass[i] * weft__dot(v, v);
        }
    }
    WEFT__EACH_FORCE(cloth, measures.energy, at, b, sum)
    weft__grids_measure(cloth, at, b, WEFT__GRID_ENERGY, sum);
}

void weft__block_power(const weft_cloth *cloth, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    WEFT__EACH_FORCE(cloth, measures.power, at, b, sum)
    weft__grids_measure(cloth, at, b, WEFT__GRID_POWER, sum);
}

static void block_momentum(const weft_cloth *cloth, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        const double *x = at->y + i, *v = x + 3 * n, mass = mesh->mass[i];
        for (size_t k = 0; mesh->pin[i] == 0 && k < 3; ++k) {
            const size_t a = (k + 1) % 3 * n, c = (k + 2) % 3 * n;
            sum->momentum[k] += mass * v[k * n];
            sum->angular_momentum[k] += mass * (x[a] * v[c] - x[c] * v[a]);
        }
    }
}

void weft__block_worst(const weft_cloth *cloth, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    WEFT__EACH_FORCE(cloth, measures.worst, at, b, sum)
    weft__grids_measure(cloth, at, b, WEFT__GRID_WORST, sum);
}

void weft__block_gaps(const weft_cloth *cloth, const weft__state *at, size_t b,
                      weft_measures *sum)
{
    WEFT__EACH_FORCE(cloth, measures.gaps, at, b, sum)
}

static uint64_t block_hash(const double *y, size_t n, size_t first, size_t end)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t k = 0; k < 6; ++k) {
        for (size_t i = first; i < end; ++i) {
            uint64_t word;
            memcpy(&word, &y[k * n + i], sizeof word);
            hash = weft__hash_word(hash, word);
        }
    }
    return hash;
}

void weft__block_state(const weft_cloth *cloth, const weft__state *at, size_t b,
                       weft_measures *sum)
{
    const weft__mesh *mesh = &cloth->mesh;
    weft__block_energy(cloth, at, b, sum);
    weft__block_worst(cloth, at, b, sum);
    weft__block_gaps(cloth, at, b, sum);
    block_momentum(cloth, at, b, sum);
    sum->hash = block_hash(at->y, mesh->particles, weft__block(mesh, b),
                           weft__block(mesh, b + 1));
}

void weft__block_all(const weft_cloth *cloth, const weft__state *at, size_t b,
                     weft_measures *sum)
{
    weft__block_state(cloth, at, b, sum);
    weft__block_power(cloth, at, b, sum);
}

const weft_measures weft__block_start
    = { .gap = (double)INFINITY, .self_gap = (double)INFINITY };
const weft_measures weft__measures_start = { .hash = WEFT__HASH_START,
                                             .gap = (double)INFINITY,
                                             .self_gap = (double)INFINITY };

void weft__measures_add(weft_measures *sum, const weft_measures *block)
{
    sum->energy.kinetic += block->energy.kinetic;
    sum->energy.gravitational += block->energy.gravitational;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        sum->energy.elastic[k] += block->energy.elastic[k];
    }
    sum->energy.contact += block->energy.contact;
    for (size_t k = 0; k < 3; ++k) {
        sum->momentum[k] += block->momentum[k];
        sum->angular_momentum[k] += block->angular_momentum[k];
    }
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        sum->power[k] += block->power[k];
    }
    if (block->worst.p != block->worst.q) {
        weft__keep_worst(&sum->worst, &block->worst);
    }
    weft__keep_gap(sum, block->gap, block->gap_particle, block->gap_shape);
    sum->touching += block->touching;
    sum->hash = weft__hash_word(sum->hash, block->hash);
}

void weft__measure_all(const weft_cloth *cloth, void *const *spaces,
                       const weft__state *at, weft_measures *sum)
{
    WEFT__EACH_FORCE(cloth, whole.measure, spaces != NULL ? spaces[k_] : NULL, at, sum)
}

static weft_measures measure_blocks(const weft_cloth *cloth, double t, const double *y,
                                    weft__measure_fn *of)
{
    const weft__state at = { .t = t, .y = y };
    const size_t first = cloth->mesh.band.above, end = first + cloth->mesh.band.own;
    weft_measures sum = weft__measures_start;
    for (size_t b = first; b < end; ++b) {
        weft_measures block = weft__block_start;
        of(cloth, &at, b, &block);
        weft__measures_add(&sum, &block);
    }
    return sum;
}

/* With the energy and powers of self-contact. */
static weft_measures measure_with_pairs(const weft_cloth *cloth, double t,
                                        const double *y, weft__measure_fn *of)
{
    const weft__state at = { .t = t, .y = y };
    weft_measures sum = measure_blocks(cloth, t, y, of);
    weft__measure_all(cloth, NULL, &at, &sum);
    return sum;
}

weft_energy weft_cloth_energy(const weft_cloth *cloth, double t, const double *y)
{
    return measure_with_pairs(cloth, t, y, weft__block_energy).energy;
}

double weft_energy_total(weft_energy energy)
{
    double total = energy.kinetic + energy.gravitational;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        total += energy.elastic[k];
    }
    return total + energy.contact;
}

void weft_cloth_power(const weft_cloth *cloth, double t, const double *y,
                      double power[WEFT_POWERS])
{
    memcpy(power, measure_with_pairs(cloth, t, y, weft__block_power).power,
           WEFT_POWERS * sizeof *power);
}

double weft_cloth_dissipation(const weft_cloth *cloth, double t, const double *y)
{
    const weft_measures sum = measure_with_pairs(cloth, t, y, weft__block_power);
    return sum.power[WEFT_POWER_SPRINGS] + sum.power[WEFT_POWER_DRAG]
           + sum.power[WEFT_POWER_CONTACT] + sum.power[WEFT_POWER_FRICTION];
}

void weft_cloth_momentum(const weft_cloth *cloth, const double *y, double p[3])
{
    memcpy(p, measure_blocks(cloth, 0.0, y, block_momentum).momentum, 3 * sizeof *p);
}

void weft_cloth_angular_momentum(const weft_cloth *cloth, const double *y, double l[3])
{
    memcpy(l, measure_blocks(cloth, 0.0, y, block_momentum).angular_momentum,
           3 * sizeof *l);
}

weft_spring weft_cloth_worst_spring(const weft_cloth *cloth, const double *y)
{
    weft_spring worst = measure_blocks(cloth, 0.0, y, weft__block_worst).worst;
    worst.p = weft__shown(&cloth->mesh, worst.p);
    worst.q = weft__shown(&cloth->mesh, worst.q);
    return worst;
}

static uint64_t state_hash(const double *y, size_t particles, size_t block)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t i = 0; i < particles; i += block) {
        const size_t end = particles - i > block ? i + block : particles;
        hash = weft__hash_word(hash, block_hash(y, particles, i, end));
    }
    return hash;
}

uint64_t weft_cloth_state_hash(const weft_cloth *cloth, const double *y)
{
    return state_hash(y, cloth->mesh.particles, cloth->mesh.block);
}

uint64_t weft_state_hash(const double *y, size_t rows, size_t cols)
{
    return state_hash(y, rows * cols, cols);
}

/* No strain is below -1. */
void weft_cloth_strains(const weft_cloth *cloth, const double *y, double *strain)
{
    const double none = -2.0;
    const weft__state at = { .y = y };
    for (size_t i = 0; i < cloth->mesh.particles; ++i) {
        strain[i] = none;
    }
    for (size_t b = 0; b < weft__blocks(&cloth->mesh); ++b) {
        weft__grid_row row = { 0 };
        WEFT__EACH_FORCE(cloth, measures.strains, &at, b, strain)
        while (weft__grids_next(cloth, &at, b, &row)) {
            WEFT__EACH_FORCE(row.cloth, measures.strains, &row.at, row.row,
                             strain + row.cloth->first)
        }
    }
    for (size_t i = 0; i < cloth->mesh.particles; ++i) {
        strain[i] = strain[i] == none ? 0.0 : strain[i];
    }
}
