/* SPDX-License-Identifier: BSD-3-Clause */
/* sensitivity.c -- the derivatives s = u dy/dp of the state by numbers p, which the
 * stepper integrates with it (docs/gradients.md):
 *
 *     s' = J s + u df/dp
 *
 * J s is that of weft_cloth_jacobian_product. Contact of the cloth with itself and with
 * meshes, whose second derivatives are nowhere, has a central difference along s. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "sim/simulation.h"

/* Of s for a stepper whose error control must not see it; a power of 2, so that s has
 * the same bits. */
#define UNSEEN 0x1p-300

/* Of the thickness, and of the speed where friction sets in: how far a difference along
 * s goes. Its error is the square of it by the length over which the law changes, some
 * tenth of the thickness; roundoff adds 1e-16 m by the step. */
#define ALONG 0x1p-16

/* ---- made of a definition -------------------------------------------------------- */

static const char *refusal(const weft_sim *sim)
{
    const weft_sim_def *def = &sim->def;
    const uint32_t flags = def->method->flags;
    return def->comm != NULL ? "a cloth in bands"
           : def->limit.method != WEFT_LIMIT_NONE
               ? "a strain limit, which is no differentiable map"
           : def->correct != NULL || def->force != NULL
               ? "`correct` or `force`, whose derivatives are not known"
           : def->event != NULL ? "an event, whose time depends on the numbers too"
           : def->ledger        ? "an energy ledger"
           : def->dense         ? "`dense`: there are none within a step"
           : def->cloth->untangle > 0.0
               ? "a start that is untangled, which has no derivative"
           : (flags & (uint32_t)WEFT_STEPPER_MULTISTEP) != 0
               ? "a method that keeps a history of steps"
           : (flags & (uint32_t)(WEFT_STEPPER_STRUCTURE | WEFT_STEPPER_LINEAR)) != 0
               ? "an implicit or stabilised method, which solves for the state alone"
           : !def->sensitivity->control && def->config.fixed_step == 0.0
                   && def->config.norm == WEFT_NORM_RMS
               ? "the rms norm and without control: it is a mean over s too"
               : NULL;
}

static bool make_room(weft_sim *sim, weft__sensitivity *of)
{
    const size_t dim = weft_cloth_dim(sim->cloth), all = dim * (1 + of->count);
    double *room = weft__zeroed(&sim->memory, all, 5 * sizeof *room);
    of->z = room;
    for (size_t k = 0; room != NULL && k < 3; ++k) {
        of->room[k] = weft__zeroed(&sim->memory, dim, sizeof *room);
        room = of->room[k] != NULL ? room : NULL;
    }
    if (room != NULL) {
        of->before = room + all, of->states = room + 2 * all;
        of->rates = room + 3 * all, of->s = room + 4 * all;
    }
    return room != NULL;
}

/* The derivative of the state at t = 0. */
static void start(const weft_sim *sim, weft__sensitivity *of, size_t j)
{
    const size_t dim = weft_cloth_dim(sim->cloth);
    weft_cloth_start(of->of[j].less, of->room[0]);
    weft_cloth_start(of->of[j].more, of->room[1]);
    for (size_t i = 0; i < dim; ++i) {
        of->s[j * dim + i] = (of->room[1][i] - of->room[0][i]) / of->of[j].span;
    }
}

weft_status weft__sensitivity_init(weft_sim *sim, weft_error *err)
{
    weft__sensitivity *of = &sim->sensitivity;
    const weft_sensitivity_def *def = sim->def.sensitivity;
    const char *why = refusal(sim);
    if (why != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no sensitivities with %s", why);
    }
    if (def->count == 0 || def->count > WEFT_SENSITIVITIES) {
        return weft_error_set(err, WEFT_INVALID,
                              "sensitivities by %zu numbers: 1 to %d", def->count,
                              WEFT_SENSITIVITIES);
    }
    of->count = def->count;
    of->factor = def->control ? 1.0 : UNSEEN;
    sim->config.structure = NULL; /* it is that of the state alone */
    if (!make_room(sim, of)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for sensitivities");
    }
    for (size_t j = 0; j < of->count; ++j) {
        const weft_number_of_cloth *number = &def->numbers[j];
        weft_error inner = { 0 };
        if (weft__slope_init(&of->of[j], sim->cloth, number->less, number->more,
                             number->span, &inner)
            != WEFT_OK) {
            return weft_error_set(err, WEFT_INVALID, "sensitivity by %.60s: %.200s",
                                  number->name, inner.message);
        }
        start(sim, of, j);
    }
    weft__sensitivity_pack(sim);
    return WEFT_OK;
}

void weft__sensitivity_free(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    WEFT__FREE_ALL(&sim->memory, of->z, of->room[0], of->room[1], of->room[2]);
}

uint64_t weft__sensitivity_hash(const weft_sim *sim, uint64_t hash)
{
    const weft__sensitivity *of = &sim->sensitivity;
    for (size_t j = 0; j < of->count; ++j) {
        hash = weft__hash_word(hash, weft__cloth_hash(of->of[j].less, NULL));
        hash = weft__hash_word(hash, weft__cloth_hash(of->of[j].more, NULL));
        hash = WEFT__HASH_NUMBERS(hash, of->of[j].span, of->factor);
    }
    return hash;
}

const double *weft_sim_sensitivity(const weft_sim *sim, size_t number)
{
    return number < sim->sensitivity.count
               ? sim->sensitivity.s + number * weft_cloth_dim(sim->cloth)
               : NULL;
}

/* ---- the stepper's state --------------------------------------------------------- */

/* Plane k of part i: 0 the state, then each s. */
static size_t plane(const weft_sim *sim, size_t k, size_t i)
{
    return (k * (1 + sim->sensitivity.count) + i) * sim->cloth->mesh.particles;
}

static void scatter(const weft_sim *sim, size_t i, const double *from, double factor,
                    double *z)
{
    const size_t n = sim->cloth->mesh.particles;
    for (size_t k = 0; k < 6; ++k) {
        double *to = z + plane(sim, k, i);
        for (size_t j = 0; j < n; ++j) {
            to[j] = factor * from[k * n + j];
        }
    }
}

static void gather(const weft_sim *sim, size_t i, const double *z, double factor,
                   double *to)
{
    const size_t n = sim->cloth->mesh.particles;
    for (size_t k = 0; k < 6; ++k) {
        const double *from = z + plane(sim, k, i);
        for (size_t j = 0; j < n; ++j) {
            to[k * n + j] = factor * from[j];
        }
    }
}

void weft__sensitivity_pack(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    for (size_t i = 0; of->count > 0 && i <= of->count; ++i) {
        scatter(sim, i, i == 0 ? sim->y : of->s + (i - 1) * dim,
                i == 0 ? 1.0 : of->factor, of->z);
    }
}

static void unpack(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    for (size_t i = 0; i <= of->count; ++i) {
        gather(sim, i, of->z, i == 0 ? 1.0 : 1.0 / of->factor,
               i == 0 ? sim->y : of->s + (i - 1) * dim);
    }
}

static size_t size_of(const weft_sim *sim)
{
    return weft_cloth_dim(sim->cloth) * (1 + sim->sensitivity.count)
           * sizeof *sim->sensitivity.z;
}

void weft__sensitivity_back(weft_sim *sim)
{
    weft__sensitivity *of = &sim->sensitivity;
    if (of->count > 0) {
        memcpy(of->z, of->before, size_of(sim));
        unpack(sim);
    }
}

weft_status weft__sensitivity_step(weft_sim *sim, double t_end, weft_error *why)
{
    weft__sensitivity *of = &sim->sensitivity;
    memcpy(of->before, of->z, size_of(sim));
    const weft_status status
        = sim->def.method->step(sim->stepper, t_end, &sim->t, of->z, why);
    if (status == WEFT_OK) {
        unpack(sim);
    }
    return status;
}

/* ---- the right-hand side --------------------------------------------------------- */

typedef struct product {
    weft_sim *sim;
    size_t number;
    weft__state at; /* along s */
    double *out;
    atomic_int failed;
} product;

static void block_rates(void *ctx, size_t first, size_t end)
{
    product *of = ctx;
    const weft__sensitivity *all = &of->sim->sensitivity;
    const weft__state still = { .t = of->at.t, .y = of->at.y };
    const int failed = weft__rhs_blocks(of->sim->cloth, &of->at, of->out, first, end)
                       | weft__slope_blocks(&all->of[of->number], &still, all->factor,
                                            of->out, all->room, first, end);
    if (failed != 0) {
        atomic_store(&of->failed, 1);
    }
}

static double largest(const double *x, size_t count)
{
    double most = 0.0;
    for (size_t i = 0; i < count; ++i) {
        most = fmax(most, fabs(x[i]));
    }
    return most;
}

/* Adds the part of J s that contact between triangles has. */
static int add_contact(const product *of)
{
    const weft_sim *sim = of->sim;
    double *const *room = sim->sensitivity.room;
    const weft_contact_def *law = &sim->cloth->contact.law;
    const double *y = of->at.y, *s = of->at.along;
    const size_t dim = weft_cloth_dim(sim->cloth);
    const double h = fmin(law->thickness / largest(s, dim / 2),
                          law->slip / largest(s + dim / 2, dim / 2))
                     * ALONG;
    int failed = 0;
    if (!(h < (double)INFINITY)) { /* s is 0 */
        return isnan(h);
    }
    memset(room[0] + dim / 2, 0, dim / 2 * sizeof *y);
    memset(room[1] + dim / 2, 0, dim / 2 * sizeof *y);
    for (size_t side = 0; side < 2; ++side) {
        const weft__state at = { .t = of->at.t, .y = room[2] };
        for (size_t i = 0; i < dim; ++i) {
            room[2][i] = y[i] + (side == 0 ? -h : h) * s[i];
        }
        failed |= weft__rhs_all(sim->cloth, sim->forces.spaces, &at, WEFT__ACCELERATION,
                                room[side] + dim / 2);
    }
    for (size_t i = dim / 2; i < dim; ++i) {
        of->out[i] += (room[1][i] - room[0][i]) / (2.0 * h);
    }
    return failed;
}

/* s' of a number. */
static int find_rates(weft_sim *sim, double t, size_t j)
{
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    const double *s = of->states + (1 + j) * dim;
    product one = { .sim = sim,
                    .number = j,
                    .at = { .t = t, .y = of->states, .along = s },
                    .out = of->rates + (1 + j) * dim };
    weft__forces_bands(&sim->forces, block_rates, &one);
    int failed = atomic_load(&one.failed);
    if (sim->forces.self != NULL || sim->forces.bodies != NULL) {
        failed |= add_contact(&one);
    }
    if (weft__slope_whole(&of->of[j])) {
        const weft__state still = { .t = t, .y = of->states };
        failed |= weft__slope_all(&of->of[j], &still, of->factor, one.out, of->room);
    }
    return failed;
}

int weft__sensitivity_rhs(double t, const double *z, double *dzdt, void *ctx)
{
    weft_sim *sim = ctx;
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    gather(sim, 0, z, 1.0, of->states);
    int failed = weft__sim_rhs(t, of->states, of->rates, sim);
    scatter(sim, 0, of->rates, 1.0, dzdt);
    for (size_t i = 1; failed == 0 && i <= of->count; ++i) {
        gather(sim, i, z, 1.0, of->states + i * dim);
        failed = find_rates(sim, t, i - 1);
        scatter(sim, i, of->rates + i * dim, 1.0, dzdt);
    }
    return failed;
}
