/* SPDX-License-Identifier: BSD-3-Clause */
/* measure.c -- measures of a state: energies, momenta, strain, hash.
 *
 * A sum over particles or springs is one over rows, in their order, of sums over each
 * row: the same on every machine and on any number of threads. Kinetic and
 * gravitational energy and both momenta are those of the free particles. */
#include "base/hash.h"
#include "cloth/added.h"
#include "cloth/self.h"
#include "cloth/springs.h"

void weft__row_energy(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles;
    for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
        const double *z = of->y + i;
        const double x[3] = { z[0], z[n], z[2 * n] };
        const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
        if (cloth->pin[i] == 0) {
            row->energy.kinetic += 0.5 * cloth->mass[i] * weft__dot(v, v);
            row->energy.gravitational -= cloth->mass[i] * weft__dot(cloth->gravity, x);
        }
    }
    for (weft__walk walk = weft__row_springs(cloth, of->y, r);
         weft__each_spring(&walk);) {
        row->energy.elastic[walk.spring.group->family]
            += weft__spring_energy(&walk.spring);
    }
    weft__row_bending_energy(of, r, row);
    weft__row_contact_energy(of, r, row);
}

static void row_momentum(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles;
    for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
        const double *x = of->y + i, *v = x + 3 * n, mass = cloth->mass[i];
        for (size_t k = 0; cloth->pin[i] == 0 && k < 3; ++k) {
            const size_t a = (k + 1) % 3 * n, b = (k + 2) % 3 * n;
            row->momentum[k] += mass * v[k * n];
            row->angular_momentum[k] += mass * (x[a] * v[b] - x[b] * v[a]);
        }
    }
}

/* NaN is larger than every number. */
static void keep_worst(weft_spring *kept, const weft_spring *other)
{
    if (kept->p == kept->q
        || (!isnan(kept->strain) && !(other->strain <= kept->strain))) {
        *kept = *other;
    }
}

void weft__row_worst(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    for (weft__walk walk = weft__row_springs(cloth, of->y, r);
         weft__each_spring(&walk);) {
        const weft__spring *at = &walk.spring;
        const weft_spring spring
            = { at->group->family, at->p, at->q, weft__spring_strain(at) };
        if (of->families == NULL || of->families[spring.family]) {
            keep_worst(&row->worst, &spring);
        }
    }
}

static uint64_t row_hash(const double *y, size_t rows, size_t cols, size_t r)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t k = 0; k < 6; ++k) {
        const double *plane = y + (k * rows + r) * cols;
        for (size_t c = 0; c < cols; ++c) {
            uint64_t word;
            memcpy(&word, &plane[c], sizeof word);
            hash = weft__hash_word(hash, word);
        }
    }
    return hash;
}

void weft__row_state(const weft__subject *of, size_t r, weft_measures *row)
{
    weft__row_energy(of, r, row);
    weft__row_worst(of, r, row);
    weft__row_gap(of, r, row);
    row_momentum(of, r, row);
    row->hash = row_hash(of->y, of->cloth->rows, of->cloth->cols, r);
}

void weft__row_all(const weft__subject *of, size_t r, weft_measures *row)
{
    weft__row_state(of, r, row);
    weft__row_power(of, r, row);
}

const weft_measures weft__row_start
    = { .gap = (double)INFINITY, .self_gap = (double)INFINITY };
const weft_measures weft__measures_start = { .hash = WEFT__HASH_START,
                                             .gap = (double)INFINITY,
                                             .self_gap = (double)INFINITY };

void weft__measures_add(weft_measures *sum, const weft_measures *row)
{
    sum->energy.kinetic += row->energy.kinetic;
    sum->energy.gravitational += row->energy.gravitational;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        sum->energy.elastic[k] += row->energy.elastic[k];
    }
    sum->energy.contact += row->energy.contact;
    for (size_t k = 0; k < 3; ++k) {
        sum->momentum[k] += row->momentum[k];
        sum->angular_momentum[k] += row->angular_momentum[k];
    }
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        sum->power[k] += row->power[k];
    }
    if (row->worst.p != row->worst.q) {
        keep_worst(&sum->worst, &row->worst);
    }
    weft__keep_gap(sum, row->gap, row->gap_particle, row->gap_shape);
    sum->touching += row->touching;
    sum->hash = weft__hash_word(sum->hash, row->hash);
}

static weft_measures measure(const weft_cloth *cloth, double t, const double *y,
                             weft__row_fn *measure_row)
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y };
    weft_measures sum = weft__measures_start;
    for (size_t r = 0; r < cloth->rows; ++r) {
        weft_measures row = weft__row_start;
        measure_row(&of, r, &row);
        weft__measures_add(&sum, &row);
    }
    return sum;
}

/* With the energy and powers of self-contact. */
static weft_measures measure_all(const weft_cloth *cloth, double t, const double *y,
                                 weft__row_fn *measure_row)
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y };
    weft_measures sum = measure(cloth, t, y, measure_row);
    weft__self_measure(&of, &sum);
    return sum;
}

weft_energy weft_cloth_energy(const weft_cloth *cloth, double t, const double *y)
{
    return measure_all(cloth, t, y, weft__row_energy).energy;
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
    memcpy(power, measure_all(cloth, t, y, weft__row_power).power,
           WEFT_POWERS * sizeof *power);
}

static void row_dissipation(const weft__subject *of, size_t r, weft_measures *row)
{
    weft__row_heat(of, r, row);
    weft__bending.power(of, r, row);
    weft__contact.power(of, r, row);
}

double weft_cloth_dissipation(const weft_cloth *cloth, double t, const double *y)
{
    const weft_measures sum = measure_all(cloth, t, y, row_dissipation);
    return sum.power[WEFT_POWER_SPRINGS] + sum.power[WEFT_POWER_DRAG]
           + sum.power[WEFT_POWER_CONTACT] + sum.power[WEFT_POWER_FRICTION];
}

void weft_cloth_momentum(const weft_cloth *cloth, const double *y, double p[3])
{
    memcpy(p, measure(cloth, 0.0, y, row_momentum).momentum, 3 * sizeof *p);
}

void weft_cloth_angular_momentum(const weft_cloth *cloth, const double *y, double l[3])
{
    memcpy(l, measure(cloth, 0.0, y, row_momentum).angular_momentum, 3 * sizeof *l);
}

weft_spring weft_cloth_worst_spring(const weft_cloth *cloth, const double *y)
{
    return measure(cloth, 0.0, y, weft__row_worst).worst;
}

double weft_cloth_gap(const weft_cloth *cloth, double t, const double *y,
                      size_t *particle, size_t *shape)
{
    const weft_measures found = measure(cloth, t, y, weft__row_gap);
    if (particle != NULL) {
        *particle = found.gap_particle;
    }
    if (shape != NULL) {
        *shape = found.gap_shape;
    }
    return found.gap;
}

size_t weft_cloth_touching(const weft_cloth *cloth, double t, const double *y)
{
    return measure(cloth, t, y, weft__row_gap).touching;
}

uint64_t weft_state_hash(const double *y, size_t rows, size_t cols)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t r = 0; r < rows; ++r) {
        hash = weft__hash_word(hash, row_hash(y, rows, cols, r));
    }
    return hash;
}

static void raise_strain(double *kept, double strain)
{
    *kept = strain > *kept ? strain : *kept;
}

/* No strain is below -1. */
void weft_cloth_strains(const weft_cloth *cloth, const double *y, double *strain)
{
    const double none = -2.0;
    for (size_t i = 0; i < cloth->particles; ++i) {
        strain[i] = none;
    }
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (weft__walk walk = weft__row_springs(cloth, y, r);
             weft__each_spring(&walk);) {
            const double here = weft__spring_strain(&walk.spring);
            raise_strain(&strain[walk.spring.p], here);
            raise_strain(&strain[walk.spring.q], here);
        }
    }
    for (size_t i = 0; i < cloth->particles; ++i) {
        strain[i] = strain[i] == none ? 0.0 : strain[i];
    }
}
