/* SPDX-License-Identifier: BSD-3-Clause */
/* measure.c -- what is to be known of a state: energies, momenta, strain, hash.
 *
 * Sums run in index order, so that they are the same on every machine. Kinetic and
 * gravitational energy and both momenta are those of the free particles. */
#include "base/hash.h"
#include "cloth/limit_springs.h"
#include "cloth/model.h"

#include <math.h>
#include <string.h>

/* Calls visit(ctx, group, p, q) for every spring, in the order of the model. */
typedef void visit_fn(void *ctx, const weft__group *group, size_t p, size_t q);

static void each_spring(const weft_cloth *cloth, visit_fn *visit, void *ctx)
{
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        for (size_t r = 0; r < group->end_row; ++r) {
            for (size_t c = group->first_col; c < group->end_col; ++c) {
                const size_t p = r * cloth->cols + c;
                visit(ctx, group, p, p + (size_t)group->stride);
            }
        }
    }
}

typedef struct measure {
    const weft_cloth *cloth;
    const double *y;
    const bool *families; /* that worst is sought in; NULL: all */
    double elastic[WEFT_FAMILIES];
    double *strain; /* N of them */
    weft_spring worst;
    bool any;
} measure;

static void add_elastic(void *ctx, const weft__group *group, size_t p, size_t q)
{
    measure *sum = ctx;
    const weft__stance at = weft__spring_stance(sum->cloth->particles, p, q, sum->y);
    const double stretch = at.length - group->rest_length;
    sum->elastic[group->family] += 0.5 * group->stiffness * stretch * stretch;
}

weft_energy weft_cloth_energy(const weft_cloth *cloth, const double *y)
{
    const size_t n = cloth->particles;
    weft_energy energy = { 0 };
    for (size_t i = 0; i < n; ++i) {
        if (cloth->pin[i] != 0) {
            continue;
        }
        double speed2 = 0.0, height = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const double v = y[(k + 3) * n + i];
            speed2 += v * v;
            height += cloth->gravity[k] * y[k * n + i];
        }
        energy.kinetic += 0.5 * cloth->mass[i] * speed2;
        energy.gravitational -= cloth->mass[i] * height;
    }
    measure sum = { .cloth = cloth, .y = y };
    each_spring(cloth, add_elastic, &sum);
    memcpy(energy.elastic, sum.elastic, sizeof energy.elastic);
    return energy;
}

void weft_cloth_momentum(const weft_cloth *cloth, const double *y, double p[3])
{
    const size_t n = cloth->particles;
    for (size_t k = 0; k < 3; ++k) {
        p[k] = 0.0;
        for (size_t i = 0; i < n; ++i) {
            if (cloth->pin[i] == 0) {
                p[k] += cloth->mass[i] * y[(k + 3) * n + i];
            }
        }
    }
}

void weft_cloth_angular_momentum(const weft_cloth *cloth, const double *y, double l[3])
{
    const size_t n = cloth->particles;
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        l[k] = 0.0;
        for (size_t i = 0; i < n; ++i) {
            if (cloth->pin[i] == 0) {
                l[k] += cloth->mass[i]
                        * (y[a * n + i] * y[(b + 3) * n + i]
                           - y[b * n + i] * y[(a + 3) * n + i]);
            }
        }
    }
}

/* Written so that NaN replaces a number and is replaced by none. */
static void keep_worst(void *ctx, const weft__group *group, size_t p, size_t q)
{
    measure *sum = ctx;
    if (sum->families != NULL && !sum->families[group->family]) {
        return;
    }
    const weft__stance at = weft__spring_stance(sum->cloth->particles, p, q, sum->y);
    const double strain = (at.length - group->rest_length) / group->rest_length;
    if (!sum->any || (!isnan(sum->worst.strain) && !(strain <= sum->worst.strain))) {
        sum->worst = (weft_spring){ group->family, p, q, strain };
        sum->any = true;
    }
}

weft_spring weft_cloth_worst_spring(const weft_cloth *cloth, const double *y)
{
    measure sum = { .cloth = cloth, .y = y };
    each_spring(cloth, keep_worst, &sum);
    return sum.worst;
}

weft_spring weft__limited_worst(const weft__limited *limited, const double *y)
{
    measure sum = { .cloth = limited->cloth, .y = y, .families = limited->families };
    each_spring(limited->cloth, keep_worst, &sum);
    return sum.worst;
}

static void raise_strain(double *kept, double strain)
{
    *kept = strain > *kept ? strain : *kept;
}

static void keep_at_ends(void *ctx, const weft__group *group, size_t p, size_t q)
{
    measure *sum = ctx;
    const weft__stance at = weft__spring_stance(sum->cloth->particles, p, q, sum->y);
    const double strain = (at.length - group->rest_length) / group->rest_length;
    raise_strain(&sum->strain[p], strain);
    raise_strain(&sum->strain[q], strain);
}

/* No strain is below -1. */
void weft_cloth_strains(const weft_cloth *cloth, const double *y, double *strain)
{
    const double none = -2.0;
    measure sum = { .cloth = cloth, .y = y, .strain = strain };
    for (size_t i = 0; i < cloth->particles; ++i) {
        strain[i] = none;
    }
    each_spring(cloth, keep_at_ends, &sum);
    for (size_t i = 0; i < cloth->particles; ++i) {
        strain[i] = strain[i] == none ? 0.0 : strain[i];
    }
}

uint64_t weft_state_hash(const double *y, size_t n)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t i = 0; i < n; ++i) {
        uint64_t word;
        memcpy(&word, &y[i], sizeof word);
        hash = weft__hash_word(hash, word);
    }
    return hash;
}
