/* SPDX-License-Identifier: BSD-3-Clause */
/* structured.c -- config->structure: with that of a string of beads, the first of which
 * is held, a method has the solution that it has without. */
#include "conformance/structured.h"

#include "conformance/trial.h"

enum { BEADS = 5, BONDS = 7, STRING = 6 * BEADS /* <= WEFT__DIM_MOST */ };
enum { NEAR = BEADS - 1, FAR = BONDS - NEAR };

/* ---- products -------------------------------------------------------------------- */

/* dF of spring b, from p to q, with the formula of weft/stepper.h. */
static void add_spring(const weft_structure *of, const double *planes, size_t b,
                       const size_t ends[2], const double *y, const double *dy,
                       double *out)
{
    const size_t n = of->particles, m = of->bond_count, p = ends[0], q = ends[1];
    const double *u = planes + b;
    double square = 0.0, wu = 0.0, along = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double d = y[k * n + q] - y[k * n + p];
        square += d * d;
        wu += (y[(k + 3) * n + q] - y[(k + 3) * n + p]) * u[k * m];
    }
    for (size_t k = 0; k < 3; ++k) {
        const double w = y[(k + 3) * n + q] - y[(k + 3) * n + p];
        const double z
            = square > 0.0 ? u[5 * m] / sqrt(square) * (w - wu * u[k * m]) : 0.0;
        along += (u[3 * m] * u[k * m] + z) * (dy[k * n + q] - dy[k * n + p])
                 + u[5 * m] * u[k * m] * (dy[(k + 3) * n + q] - dy[(k + 3) * n + p]);
    }
    for (size_t k = 0; k < 3; ++k) {
        const double change
            = u[k * m] * along + u[4 * m] * (dy[k * n + q] - dy[k * n + p]);
        out[(k + 3) * n + p] += change;
        out[(k + 3) * n + q] -= change;
    }
}

/* C of bending. */
static void add_bend_damping(const weft_structure *of, const double *planes,
                             const double *dy, double *out)
{
    const size_t n = of->particles, first = of->run_count - of->bend_runs;
    size_t b = of->bond_count - of->bend_bonds;
    for (const weft_bonds *run = of->runs + first; run < of->runs + of->run_count;
         ++run) {
        for (size_t i = 0; i < run->count; ++i, ++b) {
            const double c = of->bend_damping * planes[4 * of->bond_count + b];
            for (size_t k = 3 * n; k < 6 * n; k += n) {
                const double change = c * (dy[k + run->q + i] - dy[k + run->p + i]);
                out[k + run->p + i] += change;
                out[k + run->q + i] -= change;
            }
        }
    }
}

static void add_contact(size_t n, const double *blocks, const double *dy, double *out)
{
    static const size_t damping[9] = { 9, 10, 11, 10, 12, 13, 11, 13, 14 };
    for (size_t j = 0; j < 9 * n; ++j) {
        const size_t i = j % n, r = j / n / 3, c = j / n % 3;
        out[(r + 3) * n + i] -= blocks[j] * dy[c * n + i]
                                + blocks[damping[j / n] * n + i] * dy[(c + 3) * n + i];
    }
}

/* -A (dy_p - dy_q) to the rows of p, -A^T (dy_q - dy_p) to those of q. */
static void add_link(size_t n, weft_link at, const double *block, const double *dy,
                     double *out)
{
    for (size_t j = 0; j < 9; ++j) {
        const size_t row = (j / 3 + 3) * n, r = j / 3 * n, c = j % 3 * n;
        const size_t column = (j % 3 + 3) * n;
        out[row + at.p] -= block[j] * (dy[c + at.p] - dy[c + at.q]);
        out[column + at.q] -= block[j] * (dy[r + at.q] - dy[r + at.p]);
    }
}

static void add_links(const weft_structure *of, const double *numbers, const double *dy,
                      double *out)
{
    const size_t n = of->particles;
    for (size_t e = 0; e < of->link_count; ++e, numbers += WEFT_LINK_NUMBERS) {
        add_link(n, of->links[e], numbers, dy, out);
        add_link(n, of->links[e], numbers + 9, dy + 3 * n, out);
    }
    for (size_t e = 0; e < of->tie_count; ++e) {
        const weft_tie *tie = &of->ties[e];
        for (size_t k = 0; k < 3; ++k) {
            const double *x = dy + k * n, *v = x + 3 * n;
            double *to = out + (k + 3) * n;
            const double force
                = tie->k * (x[tie->p] - x[tie->q]) + tie->c * (v[tie->p] - v[tie->q]);
            to[tie->p] -= force;
            to[tie->q] += force;
        }
    }
}

int weft__structure_product(const weft_structure *of, double t, const double *y,
                            const double *dy, double *room, double *out)
{
    const size_t n = of->particles;
    double *blocks = room + WEFT_BOND_PLANES * of->bond_count;
    double *numbers = blocks + WEFT_BLOCK_PLANES * n;
    int failed = of->linearise(t, y, room, blocks, of->ctx);
    if (failed == 0 && of->link_count > 0) {
        failed = of->linearise_links(t, y, numbers, of->ctx);
    }
    for (size_t j = 0; j < 3 * n; ++j) {
        out[j] = of->mass[j % n] > 0.0 ? dy[3 * n + j] : 0.0;
        out[3 * n + j] = -of->drag[j % n] * dy[3 * n + j];
    }
    for (size_t r = 0, b = 0; r < of->run_count; ++r) {
        for (size_t i = 0; i < of->runs[r].count; ++i, ++b) {
            const size_t ends[2] = { of->runs[r].p + i, of->runs[r].q + i };
            add_spring(of, room, b, ends, y, dy, out);
        }
    }
    add_bend_damping(of, room, dy, out);
    add_links(of, numbers, dy, out);
    if (of->block_planes > 0) {
        add_contact(n, blocks, dy, out);
    }
    for (size_t j = 0; j < 3 * n; ++j) {
        const double mass = of->mass[j % n];
        out[3 * n + j] = mass > 0.0 ? out[3 * n + j] / mass : 0.0;
    }
    return failed;
}

/* ---- the string ------------------------------------------------------------------ */

static const weft_bonds runs[] = { { 0, 1, NEAR }, { 0, 2, FAR } };
static const weft_link links[FAR] = { { 0, 2 }, { 1, 3 }, { 2, 4 } };
static const double mass[BEADS] = { 0.0, 0.01, 0.01, 0.02, 0.01 }; /* [kg] */
static const double drag[BEADS] = { 1e-3, 1e-3, 1e-3, 1e-3, 1e-3 };

typedef struct bond {
    size_t p, q;
    double u[3], stiffness, damping, pull; /* [N/m] k, [kg/s] c, [N/m] T / L */
    double length;
} bond;

/* Neighbours are 0.1 m apart at rest, and their springs are damped. */
static bond bond_at(const double *y, size_t b)
{
    const weft_bonds *run = &runs[b < runs[0].count ? 0 : 1];
    const size_t i = b < runs[0].count ? b : b - runs[0].count;
    bond at = { run->p + i,
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

static int string_rhs(double t, const double *y, double *dydt, void *ctx)
{
    (void)t, (void)ctx;
    for (size_t j = 0; j < 3 * BEADS; ++j) {
        dydt[j] = j % BEADS > 0 ? y[3 * BEADS + j] : 0.0;
        dydt[3 * BEADS + j] = -drag[j % BEADS] * y[3 * BEADS + j]
                              - (j / BEADS == 2 ? 9.81 * mass[j % BEADS] : 0.0);
    }
    for (size_t b = 0; b < BONDS; ++b) {
        const bond at = bond_at(y, b);
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
    const size_t count = ((const weft_structure *)ctx)->bond_count;
    (void)t, (void)blocks;
    for (size_t b = 0; b < count; ++b) {
        const bond at = bond_at(y, b);
        const double numbers[WEFT_BOND_PLANES] = { at.u[0], at.u[1],
                                                   at.u[2], at.stiffness - at.pull,
                                                   at.pull, at.damping };
        for (size_t k = 0; k < WEFT_BOND_PLANES; ++k) {
            planes[k * count + b] = numbers[k];
        }
    }
    return 0;
}

/* The far springs as links: A = (k - T / L) u u^T + (T / L) I. */
static int string_links(double t, const double *y, double *numbers, void *ctx)
{
    (void)t, (void)ctx;
    memset(numbers, 0, FAR * WEFT_LINK_NUMBERS * sizeof *numbers);
    for (size_t e = 0; e < FAR; ++e, numbers += WEFT_LINK_NUMBERS) {
        const bond at = bond_at(y, NEAR + e);
        for (size_t j = 0; j < 9; ++j) {
            numbers[j] = (at.stiffness - at.pull) * at.u[j / 3] * at.u[j % 3]
                         + (j % 4 == 0 ? at.pull : 0.0);
        }
    }
    return 0;
}

/* A row of the stiffness matrix has at most twice the sum of its bonds'. */
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

/* To a method that knows links some springs are given as such. */
static void string_init(weft_structure *at, bool knows_links)
{
    *at = (weft_structure){ .struct_size = sizeof *at,
                            .particles = BEADS,
                            .run_count = knows_links ? 1 : 2,
                            .bond_count = knows_links ? NEAR : BONDS,
                            .runs = runs,
                            .mass = mass,
                            .drag = drag,
                            .linearise = string_linearise,
                            .modes = string_modes,
                            .ctx = at,
                            .link_count = knows_links ? FAR : 0,
                            .links = links,
                            .linearise_links = string_links };
}

/* Level, stretched a little, and moving. */
static void string_start(double y[STRING])
{
    memset(y, 0, STRING * sizeof *y);
    for (size_t i = 1; i < BEADS; ++i) {
        y[i] = 0.11 * (double)i;
        y[BEADS + i] = 0.01 * (double)(i * i);
        y[3 * BEADS + i] = 0.2 * (double)(i % 3);
    }
}

/* The error of the structure of an ode, relative to the largest number. */
static double structure_error(const weft_structure *of, const double y[STRING])
{
    const double s = 1e-5;
    double room[WEFT_BOND_PLANES * BONDS + WEFT_BLOCK_PLANES * BEADS
                + WEFT_LINK_NUMBERS * FAR];
    double dy[STRING], product[STRING], above[STRING], below[STRING];
    double error = 0.0, largest = 0.0;
    for (size_t j = 0; j < STRING; ++j) {
        dy[j] = sin(7.0 * (double)j);
        above[j] = y[j] + s * dy[j];
        below[j] = y[j] - s * dy[j];
    }
    double f[2][STRING];
    (void)string_rhs(0.0, above, f[0], NULL);
    (void)string_rhs(0.0, below, f[1], NULL);
    (void)weft__structure_product(of, 0.0, y, dy, room, product);
    for (size_t j = 0; j < STRING; ++j) {
        error = fmax(error, fabs((f[0][j] - f[1][j]) / (2.0 * s) - product[j]));
        largest = fmax(largest, fabs(product[j]));
    }
    return error / largest;
}

/* ---- the check ------------------------------------------------------------------- */

/* y at 0.25 s, with the structure or without. */
static void swing(trial *self, const weft_structure *structure, double y[STRING])
{
    const weft_ode ode = { .dim = STRING, .rhs = string_rhs };
    trial_run *r = &self->runs[0];
    weft_stepper_config config
        = weft__with_table(self->type, weft__usual(self->type, self->mode));
    config.structure = structure;
    weft__end(self, 0);
    r->ode = ode, r->t = 0.0;
    string_start(y);
    weft__expect(self,
                 self->type->create(self->type, &r->ode, &config, &r->self, &r->err)
                     == WEFT_OK,
                 "%s a structure create failed: %s",
                 structure != NULL ? "with" : "without", r->err.message);
    while (r->t < 0.25) {
        weft__expect(self,
                     self->type->step(r->self, 0.25, &r->t, y, &r->err) == WEFT_OK,
                     "%s a structure a step failed: %s",
                     structure != NULL ? "with" : "without", r->err.message);
    }
}

/* y at 0.25 s, for a method that needs the structure. */
static void solve(double y[STRING])
{
    enum { STEPS = 2048 };
    const weft_ode ode = { .dim = STRING, .rhs = string_rhs };
    string_start(y);
    for (int i = 0; i < STEPS; ++i) {
        weft__runge_kutta(&ode, 0.0, 0.25 / STEPS, y);
    }
}

void weft__a_structure_leaves_the_solution(trial *self)
{
    double with[STRING], without[STRING], apart = 0.0;
    weft_structure string;
    string_init(&string, (self->type->flags & (uint32_t)WEFT_STEPPER_LINKS) != 0);
    string_start(with);
    weft__expect(self, structure_error(&string, with) < 1e-6,
                 "the structure of the model itself is off by %.2g",
                 structure_error(&string, with));
    swing(self, &string, with);
    if ((self->type->flags & WEFT_STEPPER_STRUCTURE) != 0) {
        solve(without);
    } else {
        swing(self, NULL, without);
    }
    for (size_t j = 0; j < STRING / 2; ++j) {
        apart = fmax(apart, isfinite(with[j]) ? fabs(with[j] - without[j]) : INFINITY);
    }
    const double allowed = self->type->order == 1 ? 2e-2 : 2e-3;
    weft__expect(self, apart <= allowed,
                 "beads are %.2g m from where they are without a structure, %.2g "
                 "allowed",
                 apart, allowed);
}
