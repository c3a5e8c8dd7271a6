/* SPDX-License-Identifier: BSD-3-Clause */
/* structured.c -- config->structure: with that of a string of beads, the first of which
 * is held, a method has the solution that it has without. */
#include "study/conformance/oscillators.h"

#include "study/conformance/trial.h"

enum { BEADS = WEFT__STRING / 6, PAIRS = 7, NEAR = BEADS - 1, FAR = PAIRS - NEAR };

static const weft_spring_run runs[] = { { 0, 1, NEAR }, { 0, 2, FAR } };
static const weft_block_coupling couplings[FAR] = { { 0, 2 }, { 1, 3 }, { 2, 4 } };
static const double mass[BEADS] = { 0.0, 0.01, 0.01, 0.02, 0.01 }; /* [kg] */
static const double drag[BEADS] = { 1e-3, 1e-3, 1e-3, 1e-3, 1e-3 };

typedef struct coupled_pair {
    size_t p, q;
    double u[3], stiffness, damping, pull; /* [N/m] k, [kg/s] c, [N/m] T / L */
    double length;
} coupled_pair;

/* Neighbours are 0.1 m apart at rest, and their springs are damped. */
static coupled_pair coupled_pair_at(const double *y, size_t b)
{
    const weft_spring_run *run = &runs[b < runs[0].count ? 0 : 1];
    const size_t i = b < runs[0].count ? b : b - runs[0].count;
    coupled_pair at = { run->p + i,
                        run->q + i,
                        { 0.0 },
                        run == runs ? 40.0 : 10.0,
                        run == runs ? 0.4 : 0.0,
                        0,
                        0 };
    double square = 0.0, rate = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        at.u[k] = y[k * BEADS + at.q] - y[k * BEADS + at.p];
        square += at.u[k] * at.u[k];
        rate += at.u[k] * (y[(k + 3) * BEADS + at.q] - y[(k + 3) * BEADS + at.p]);
    }
    at.length = sqrt(square);
    at.pull = (at.stiffness * (at.length - 0.1 * (double)(at.q - at.p))
               + at.damping * rate / at.length)
              / at.length;
    for (size_t k = 0; k < 3; ++k) {
        at.u[k] /= at.length;
    }
    return at;
}

int weft__string_rhs(double t, const double *y, double *dydt, void *ctx)
{
    (void)t, (void)ctx;
    for (size_t j = 0; j < 3 * BEADS; ++j) {
        dydt[j] = j % BEADS > 0 ? y[3 * BEADS + j] : 0.0;
        dydt[3 * BEADS + j] = -drag[j % BEADS] * y[3 * BEADS + j]
                              - (j / BEADS == 2 ? 9.81 * mass[j % BEADS] : 0.0);
    }
    for (size_t b = 0; b < PAIRS; ++b) {
        const coupled_pair at = coupled_pair_at(y, b);
        for (size_t k = 0; k < 3; ++k) {
            dydt[(k + 3) * BEADS + at.p] += at.pull * at.length * at.u[k];
            dydt[(k + 3) * BEADS + at.q] -= at.pull * at.length * at.u[k];
        }
    }
    for (size_t j = 0; j < 3 * BEADS; ++j) {
        const double m = mass[j % BEADS];
        dydt[3 * BEADS + j] = m > 0.0 ? dydt[3 * BEADS + j] / m : 0.0;
    }
    return 0;
}

/* ctx: the structure. */
static int string_linearise(double t, const double *y, double *planes, double *blocks,
                            void *ctx)
{
    const size_t count = ((const weft_structure *)ctx)->pair_count;
    (void)t, (void)blocks;
    for (size_t b = 0; b < count; ++b) {
        const coupled_pair at = coupled_pair_at(y, b);
        const double numbers[WEFT_PAIR_PLANES] = { at.u[0], at.u[1],
                                                   at.u[2], at.stiffness - at.pull,
                                                   at.pull, at.damping };
        for (size_t k = 0; k < WEFT_PAIR_PLANES; ++k) {
            planes[k * count + b] = numbers[k];
        }
    }
    return 0;
}

/* The far springs as couplings: A = (k - T / L) u u^T + (T / L) I. */
static int string_links(double t, const double *y, double *numbers, void *ctx)
{
    (void)t, (void)ctx;
    memset(numbers, 0, FAR * WEFT_COUPLING_NUMBERS * sizeof *numbers);
    for (size_t e = 0; e < FAR; ++e, numbers += WEFT_COUPLING_NUMBERS) {
        const coupled_pair at = coupled_pair_at(y, NEAR + e);
        for (size_t j = 0; j < 9; ++j) {
            numbers[j] = (at.stiffness - at.pull) * at.u[j / 3] * at.u[j % 3]
                         + (j % 4 == 0 ? at.pull : 0.0);
        }
    }
    return 0;
}

/* A row of the stiffness matrix has at most twice the sum of its pairs'. */
static size_t string_modes(double t, const double *y, double (*corners)[2], size_t room,
                           void *ctx)
{
    const double omega2 = 2.0 * (2.0 * 40.0 + 2.0 * 10.0) / 0.01;
    const double damping = (2.0 * 4.0 * 0.4 + 1e-3) / 0.01;
    const double about[4][2]
        = { { 0.0, 0.0 }, { omega2, 0.0 }, { omega2, damping }, { 0.0, damping } };
    (void)t, (void)y, (void)ctx;
    if (room < 4) {
        return 0;
    }
    memcpy(corners, about, sizeof about);
    return 4;
}

/* To a method that knows couplings some springs are given as such. */
void weft__string_init(weft_structure *at, bool knows_links)
{
    *at = (weft_structure){ .struct_size = sizeof *at,
                            .particles = BEADS,
                            .run_count = knows_links ? 1 : 2,
                            .pair_count = knows_links ? NEAR : PAIRS,
                            .runs = runs,
                            .mass = mass,
                            .drag = drag,
                            .linearise = string_linearise,
                            .modes = string_modes,
                            .ctx = at,
                            .block_coupling_count = knows_links ? FAR : 0,
                            .block_couplings = couplings,
                            .linearise_blocks = string_links };
}

/* Level, stretched a little, and moving. */
void weft__string_start(double y[WEFT__STRING])
{
    memset(y, 0, WEFT__STRING * sizeof *y);
    for (size_t i = 1; i < BEADS; ++i) {
        y[i] = 0.11 * (double)i;
        y[BEADS + i] = 0.01 * (double)(i * i);
        y[3 * BEADS + i] = 0.2 * (double)(i % 3);
    }
}

/* ---- the check ------------------------------------------------------------------- */

/* y at 0.25 s, with the structure or without. */
static void swing(trial *self, const weft_structure *structure, double y[WEFT__STRING])
{
    const weft_ode ode = { .dim = WEFT__STRING, .rhs = weft__string_rhs };
    trial_run *r = &self->runs[0];
    weft_stepper_config config
        = weft__with_table(self->type, weft__usual(self->type, self->mode));
    config.structure = structure;
    weft__end(self, 0);
    r->ode = ode, r->t = 0.0;
    weft__string_start(y);
    EXPECT(self->type->create(self->type, &r->ode, &config, &r->self, &r->err)
               == WEFT_OK,
           "%s a structure create failed: %s", structure != NULL ? "with" : "without",
           r->err.message);
    while (r->t < 0.25) {
        EXPECT(self->type->step(r->self, 0.25, &r->t, y, &r->err) == WEFT_OK,
               "%s a structure a step failed: %s",
               structure != NULL ? "with" : "without", r->err.message);
    }
}

/* y at 0.25 s, for a method that needs the structure. */
static void solve(double y[WEFT__STRING])
{
    enum { STEPS = 2048 };
    const weft_ode ode = { .dim = WEFT__STRING, .rhs = weft__string_rhs };
    weft__string_start(y);
    for (int i = 0; i < STEPS; ++i) {
        weft__runge_kutta(&ode, 0.0, 0.25 / STEPS, y);
    }
}

void weft__a_structure_leaves_the_solution(trial *self)
{
    double with[WEFT__STRING], without[WEFT__STRING], apart = 0.0;
    weft_structure string;
    weft__string_init(&string,
                      (self->type->flags & (uint32_t)WEFT_STEPPER_COUPLINGS) != 0);
    swing(self, &string, with);
    if ((self->type->flags & WEFT_STEPPER_STRUCTURE) != 0) {
        solve(without);
    } else {
        swing(self, NULL, without);
    }
    for (size_t j = 0; j < WEFT__STRING / 2; ++j) {
        apart = fmax(apart, isfinite(with[j]) ? fabs(with[j] - without[j]) : INFINITY);
    }
    const double allowed = self->type->order == 1 ? 2e-2 : 2e-3;
    EXPECT(apart <= allowed,
           "beads are %.2g m from where they are without a structure, %.2g "
           "allowed",
           apart, allowed);
}
