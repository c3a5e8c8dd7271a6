/* SPDX-License-Identifier: BSD-3-Clause */
/* sensitivity.c -- the derivatives s = u dy/dp of the state with respect to parameters
 * p, which the stepper integrates with it (docs/guides/gradients.md):
 *
 *     s' = J s + u df/dp
 *
 * J s is that of weft_cloth_jacobian_product. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "forces/springs/springs_products.h"
#include "sim/simulation.h"

/* Of s for a stepper whose error control must not see it; a power of 2, so that s has
 * the same bits. */
#define UNSEEN 0x1p-300

/* ---- made of a definition -------------------------------------------------------- */

const char *weft__sensitivity_refusal(const weft_sim *sim)
{
    const weft_sim_def *def = &sim->def;
    const uint32_t flags = def->method->flags;
    return def->comm != NULL ? "a cloth in bands"
           : def->limit.method != WEFT_LIMIT_NONE
               ? "a strain limit, which is no differentiable map"
           : def->correct != NULL || def->force != NULL
               ? "`correct` or `force`, whose derivatives are not known"
           : def->event != NULL ? "an event, whose time depends on the numbers too"
           : def->ledger        ? "an energy balance"
           : def->interpolate   ? "`interpolate`: there are none within a step"
           : def->cloth->grid_count > 0
               ? "grids among several cloths, whose derivatives are not known"
           : def->start != NULL ? "a start of its own, whose derivative is not known"
           : def->cloth->untangle > 0.0
               ? "a start that is untangled, which has no derivative"
           : (flags & (uint32_t)WEFT_STEPPER_MULTISTEP) != 0
               ? "a method that keeps a history of steps"
           : (flags & (uint32_t)(WEFT_STEPPER_STRUCTURE | WEFT_STEPPER_LINEAR)) != 0
                   && def->sensitivity == NULL
               ? "an implicit or stabilised method"
           : (flags & (uint32_t)WEFT_STEPPER_LINEAR) != 0
                   && def->cloth->mesh.triangles != NULL
               ? "an implicit method on triangles"
           : def->sensitivity != NULL && !def->sensitivity->control
                   && def->config.fixed_step == 0.0 && def->config.norm == WEFT_NORM_RMS
               ? "the rms norm and without control: it is a mean over s too"
               : NULL;
}

/* Whether a cloth has other forces than the sweep over springs. */
static bool has_others(const weft_cloth *cloth)
{
    bool others = cloth->mesh.triangles != NULL;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        others = others || (force != NULL && !force->law.swept);
    }
    return others;
}

static bool sensitivity_make_room(weft_sim *sim, weft__sensitivity *of)
{
    const weft_sensitivity_def *def = sim->def.sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth), all = dim * (1 + of->count);
    of->direct = !has_others(sim->cloth);
    for (size_t j = 0; j < of->count; ++j) {
        of->direct = of->direct && !has_others(def->parameters[j].less)
                     && !has_others(def->parameters[j].more);
    }
    of->row = of->direct && of->runs == NULL ? sim->cloth->mesh.cols : dim / 6;
    double *room = weft__zeroed(&sim->memory, all, (of->direct ? 3 : 5) * sizeof *room);
    of->z = room;
    for (size_t k = 0; room != NULL && k < 3; ++k) {
        of->room[k] = weft__zeroed(&sim->memory, dim, sizeof *room);
        room = of->room[k] != NULL ? room : NULL;
    }
    if (room != NULL) {
        of->before = room + all, of->s = room + 2 * all;
        of->states = of->direct ? NULL : room + 3 * all;
        of->rates = of->direct ? NULL : room + 4 * all;
    }
    return room != NULL;
}

/* The derivative of the state at t = 0. */
static void sensitivity_start(const weft_sim *sim, weft__sensitivity *of, size_t j)
{
    const size_t dim = weft_cloth_dim(sim->cloth);
    const weft_parameter *parameter = &sim->def.sensitivity->parameters[j];
    weft_cloth_start(parameter->less, of->room[0]);
    weft_cloth_start(parameter->more, of->room[1]);
    for (size_t i = 0; i < dim; ++i) {
        of->s[j * dim + i] = (of->room[1][i] - of->room[0][i]) / parameter->span;
    }
}

weft_status weft__sensitivity_init(weft_sim *sim, weft_error *err)
{
    weft__sensitivity *of = &sim->sensitivity;
    const weft_sensitivity_def *def = sim->def.sensitivity;
    const char *why = weft__sensitivity_refusal(sim);
    if (why != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no sensitivities with %s", why);
    }
    if (def->count == 0 || def->count > WEFT_SENSITIVITIES) {
        return weft_error_set(err, WEFT_INVALID,
                              "sensitivities of %zu parameters: 1 to %d", def->count,
                              WEFT_SENSITIVITIES);
    }
    of->count = def->count;
    of->factor = def->control ? 1.0 : UNSEEN;
    const bool structure = (sim->def.method->flags
                            & (uint32_t)(WEFT_STEPPER_STRUCTURE | WEFT_STEPPER_LINEAR))
                           != 0;
    sim->config.structure = NULL; /* it is that of the state alone */
    if (structure && weft__augmented_init(sim, err) != WEFT_OK) {
        return WEFT_NO_MEMORY;
    }
    for (size_t j = 0; j < of->count; ++j) {
        const weft_parameter *parameter = &def->parameters[j];
        weft_error inner = { 0 };
        const weft_status status = weft__parameter_derivative_init(
            &of->of[j], sim->cloth, parameter->less, parameter->more, parameter->span,
            of->factor, &sim->memory, &inner);
        if (status != WEFT_OK) {
            return weft_error_set(
                err, status, "sensitivity, parameter %zu, %.60s: %.200s", j,
                parameter->name == NULL ? "unnamed" : parameter->name, inner.message);
        }
    }
    if (!sensitivity_make_room(sim, of)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for sensitivities");
    }
    for (size_t j = 0; j < of->count; ++j) {
        sensitivity_start(sim, of, j);
    }
    weft__sensitivity_pack(sim);
    return WEFT_OK;
}

void weft__sensitivity_free(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    for (size_t j = 0; j < of->count; ++j) {
        weft__parameter_derivative_free(&of->of[j], &sim->memory);
    }
    WEFT__FREE_ALL(&sim->memory, of->z, of->room[0], of->room[1], of->room[2], of->runs,
                   of->masses, of->own);
}

uint64_t weft__sensitivity_hash(const weft_sim *sim, uint64_t hash)
{
    const weft__sensitivity *of = &sim->sensitivity;
    for (size_t j = 0; j < of->count; ++j) {
        hash = weft__hash_word(hash, weft__cloth_hash(of->of[j].less, NULL));
        hash = weft__hash_word(hash, weft__cloth_hash(of->of[j].more, NULL));
        hash = WEFT__HASH_NUMBERS(hash, of->of[j].scale, of->factor);
    }
    return hash;
}

/* ---- the stepper's state --------------------------------------------------------- */

/* Where a row of part i of plane k begins: 0 the state, then each s. */
static size_t sensitivity_place(const weft_sim *sim, size_t k, size_t i, size_t row)
{
    const weft__sensitivity *of = &sim->sensitivity;
    return (1 + of->count) * (k * sim->cloth->mesh.particles + row * of->row)
           + i * of->row;
}

/* Copies all rows of part i, with a factor: from planes of their own to those of the
 * stepper, or back. */
static void sensitivity_copy(const weft_sim *sim, size_t i, const double *from,
                             double factor, double *to, bool back)
{
    const size_t n = sim->cloth->mesh.particles, row = sim->sensitivity.row;
    for (size_t k = 0; k < 6; ++k) {
        for (size_t r = 0; r < n / row; ++r) {
            const size_t in = sensitivity_place(sim, k, i, r), own = k * n + r * row;
            const double *source = from + (back ? in : own);
            double *target = to + (back ? own : in);
            if (factor == 1.0) {
                memcpy(target, source, row * sizeof *target);
            }
            for (size_t j = 0; factor != 1.0 && j < row; ++j) {
                target[j] = factor * source[j];
            }
        }
    }
}

void weft__sensitivity_pack(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    for (size_t i = 0; of->count > 0 && i <= of->count; ++i) {
        sensitivity_copy(sim, i, i == 0 ? sim->y : of->s + (i - 1) * dim,
                         i == 0 ? 1.0 : of->factor, of->z, false);
    }
}

void weft__sensitivity_state(const weft_sim *sim, const double *z, double *y)
{
    sensitivity_copy(sim, 0, z, 1.0, y, true);
}

const double *weft_sim_sensitivity(const weft_sim *sim, size_t number)
{
    const weft__sensitivity *of = &sim->sensitivity;
    if (number >= of->count) {
        return NULL;
    }
    double *s = of->s + number * weft_cloth_dim(sim->cloth);
    sensitivity_copy(sim, 1 + number, of->z, 1.0 / of->factor, s, true);
    return s;
}

void weft__sensitivity_unpack(const weft_sim *sim)
{
    for (size_t j = 0; j < sim->sensitivity.count; ++j) {
        (void)weft_sim_sensitivity(sim, j);
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
        weft__sensitivity_state(sim, of->z, sim->y);
    }
}

void weft__sensitivity_jump(weft_sim *sim)
{
    const weft__sensitivity *of = &sim->sensitivity;
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles;
    weft__sensitivity_unpack(sim);
    for (size_t j = 0; j < of->count; ++j) {
        for (size_t i = 0; of->of[j].pins && i < mesh->pinned; ++i) {
            double jump[6];
            weft__parameter_derivative_jump(&of->of[j], mesh->pins[i], sim->t,
                                            (double[]){ sim->piece, sim->next_piece },
                                            jump);
            for (size_t k = 0; k < 6 && weft__pin_meets(mesh, mesh->pins[i]); ++k) {
                double *s = &of->s[(6 * j + k) * n + mesh->pins[i]];
                *s = (k < 3 ? *s : 0.0) + jump[k] / of->factor;
            }
        }
    }
    weft__sensitivity_pack(sim);
}

weft_status weft__sensitivity_step(weft_sim *sim, double t_end, weft_error *why)
{
    weft__sensitivity *of = &sim->sensitivity;
    const bool checks = weft__sim_checks(sim); /* which may reject it */
    if (checks) {
        memcpy(of->before, of->z, size_of(sim));
    }
    const weft_status status
        = sim->def.method->step(sim->stepper, t_end, &sim->t, of->z, why);
    if (checks || status != WEFT_OK || !of->passes || sim->t == t_end) {
        weft__sensitivity_state(sim, of->z, sim->y);
    }
    return status;
}

/* ---- the right-hand side --------------------------------------------------------- */

typedef struct job {
    weft_sim *sim;
    double t;
    const double *y; /* of z, or `states` */
    double *out;     /* likewise */
    atomic_int failed;
} job;

/* The products of parameters [j, j + count) of springs, weight and air, and unless the
 * state's rates are there already, these. */
static int sweep(const job *of, size_t j, size_t count, size_t first, size_t end)
{
    const weft_cloth *cloth = of->sim->cloth;
    const weft__sensitivity *all = &of->sim->sensitivity;
    const size_t n = cloth->mesh.particles, cols = cloth->mesh.cols;
    const size_t part = all->direct ? all->row : 6 * n; /* from one of z to the next */
    weft__tangents tangents = { .y = of->y,
                                .base = all->direct && j == 0 ? of->out : NULL,
                                .stride = all->direct ? n * (1 + all->count) : n,
                                .down = all->row < n ? cols * (1 + all->count) : cols,
                                .count = count };
    for (size_t k = 0; k < count; ++k) {
        const size_t at = (1 + j + k) * part;
        tangents.tangent[k]
            = (weft__tangent){ of->y + at, of->out + at, &all->of[j + k].springs };
    }
    return cloth->springs.products(&cloth->springs, &cloth->body, &tangents, first,
                                   end);
}

/* What the other forces add to those of parameter j. */
static int add_others(const job *of, size_t j, size_t first, size_t end)
{
    const weft__sensitivity *all = &of->sim->sensitivity;
    const size_t dim = weft_cloth_dim(of->sim->cloth);
    const weft__state still = weft__forces_state(&of->sim->forces, of->t, of->y);
    weft__state along = still;
    along.along = of->y + (1 + j) * dim;
    double *out = of->out + (1 + j) * dim;
    return weft__rhs_others(of->sim->cloth, &along, WEFT__ACCELERATION, out + dim / 2,
                            first, end)
           | weft__parameter_derivative_blocks(&all->of[j], &still, out, all->room,
                                               first, end);
}

/* Writes the rates of pinned particles: of part i, 0 the state. */
static void move_pins(const job *of, size_t i, size_t low, size_t high)
{
    const weft__sensitivity *all = &of->sim->sensitivity;
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const weft__state at = weft__forces_state(&of->sim->forces, of->t, of->y);
    for (size_t j = 0; j < mesh->pinned; ++j) {
        const size_t p = mesh->pins[j], row = p / all->row;
        double rate[6];
        if (p < low || p >= high) {
            continue;
        }
        if (i == 0) {
            weft__pin_rate(mesh, p, at.t, weft__piece(&at), rate);
        } else {
            weft__parameter_derivative_pin(&all->of[i - 1], p, &at, rate);
        }
        for (size_t k = 0; k < 6; ++k) {
            of->out[all->direct ? sensitivity_place(of->sim, k, i, row) + p % all->row
                                : (6 * i + k) * mesh->particles + p]
                = rate[k];
        }
    }
}

static void block_rates(void *ctx, size_t first, size_t end)
{
    job *of = ctx;
    const weft__sensitivity *all = &of->sim->sensitivity;
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    int failed = 0;
    for (size_t j = 0; j < all->count; j += WEFT__TANGENTS) {
        const size_t left = all->count - j;
        failed
            |= sweep(of, j, left < WEFT__TANGENTS ? left : WEFT__TANGENTS, first, end);
    }
    for (size_t j = 0; !all->direct && j < all->count; ++j) {
        failed |= add_others(of, j, first, end);
    }
    for (size_t i = all->direct ? 0 : 1; i <= all->count; ++i) {
        move_pins(of, i, weft__block(mesh, first), weft__block(mesh, end));
    }
    if (failed != 0) {
        atomic_store(&of->failed, 1);
    }
}

/* Contact of the whole cloth, of all parameters. */
static int add_whole(const job *of)
{
    const weft_sim *sim = of->sim;
    const weft__sensitivity *all = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    const weft__state still = weft__forces_state(&sim->forces, of->t, of->y);
    weft__state along = still;
    int failed = 0;
    for (size_t j = 1; j <= all->count; ++j) {
        double *out = of->out + j * dim;
        along.along = of->y + j * dim;
        failed |= weft__rhs_all(sim->cloth, sim->forces.spaces, &along,
                                WEFT__ACCELERATION, out + dim / 2)
                  | weft__parameter_derivative_all(&all->of[j - 1], sim->forces.spaces,
                                                   &still, out, all->room);
    }
    return failed;
}

int weft__sensitivity_rhs(double t, const double *z, double *dzdt, void *ctx)
{
    weft_sim *sim = ctx;
    const weft__sensitivity *of = &sim->sensitivity;
    const size_t dim = weft_cloth_dim(sim->cloth);
    job all = { .sim = sim, .t = t, .y = z, .out = dzdt };
    if (of->direct) {
        if (weft__sim_must_stop(sim)) {
            return -1;
        }
        weft__forces_spans(&sim->forces, block_rates, &all);
        return atomic_load(&all.failed);
    }
    all.y = of->states, all.out = of->rates;
    for (size_t i = 0; i <= of->count; ++i) {
        sensitivity_copy(sim, i, z, 1.0, of->states + i * dim, true);
    }
    int failed = weft__sim_rhs(t, of->states, of->rates, sim);
    if (failed == 0) {
        weft__forces_spans(&sim->forces, block_rates, &all);
        failed = atomic_load(&all.failed) | add_whole(&all);
    }
    for (size_t i = 0; i <= of->count; ++i) {
        sensitivity_copy(sim, i, of->rates + i * dim, 1.0, dzdt, false);
    }
    return failed;
}
