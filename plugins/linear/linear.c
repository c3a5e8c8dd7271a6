/* SPDX-License-Identifier: BSD-3-Clause */
/* linear.c -- the reduced system, and conjugate gradients. */
#include "linear.h"

#include "filter.h"
#include "multigrid.h"
#include "smoothed.h"
#include "vectors.h"

enum { ITERATIONS = 2000 }; /* at most, of one system */

/* Of the largest trace of a diagonal block by the mass: about gamma^2 omega^2 + gamma c
 * of the stiffest mode. Above it multigrid costs less than the blocks alone. */
#define MULTIGRID_FROM 500.0

struct weft__linear {
    const weft_structure *of;
    weft_preconditioner preconditioner;
    weft__pile pile;
    weft__network net;
    weft__network bend;         /* the runs of bending in net */
    size_t bend_at;             /* their first spring */
    double bend_damping;        /* [s] */
    weft__multigrid *multigrid; /* of springs; NULL: not wanted */
    weft__smoothed *smoothed;   /* of triangles; NULL: likewise */
    bool cycles;                /* it is the preconditioner of the present system */
    double gamma;               /* [s] */
    double *planes, *blocks;    /* of the structure, filtered */
    double *numbers;            /* of its block couplings */
    double *place;              /* [m] where particles are; NULL: of springs */
    double *b, *x, *z, *p, *q;  /* of conjugate gradients */
    weft__linear_counts counts;
};

/* ---- creation -------------------------------------------------------------------- */

static bool take_memory(weft__linear *self)
{
    const size_t n = self->of->particles;
    double **vectors[] = { &self->b, &self->x, &self->z, &self->p, &self->q };
    weft__network_take(&self->net, &self->pile);
    self->net.held = weft__pile_take(&self->pile, n, sizeof *self->net.held);
    self->planes = weft__pile_take(&self->pile, self->of->pair_count,
                                   WEFT_PAIR_PLANES * sizeof(double));
    self->blocks = weft__pile_take(&self->pile, n, WEFT_BLOCK_PLANES * sizeof(double));
    self->numbers = weft__pile_take(&self->pile, self->net.block_coupling_count,
                                    WEFT_COUPLING_NUMBERS * sizeof(double));
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; ++i) {
        *vectors[i] = weft__pile_take(&self->pile, n, 3 * sizeof(double));
    }
    if (self->preconditioner == WEFT_PRECONDITIONER_JACOBI) {
        return !self->pile.failed;
    }
    if (self->net.block_coupling_count + self->net.scalar_coupling_count > 0) {
        self->place = weft__pile_take(&self->pile, n, 3 * sizeof(double));
        self->smoothed = weft__smoothed_create(
            &self->net, self->net.block_coupling_count, &self->pile);
    } else {
        self->multigrid = weft__multigrid_create(&self->net, &self->pile);
    }
    self->pile.failed
        = self->pile.failed || (self->smoothed == NULL && self->multigrid == NULL);
    return !self->pile.failed;
}

static void find_bend_runs(weft__linear *self)
{
    const weft_structure *of = self->of;
    if (WEFT_HAS(of, weft_structure, bend_damping)) {
        const size_t first = of->run_count - of->bend_runs;
        self->bend = self->net;
        self->bend.runs = of->runs + first;
        self->bend.run_count = of->bend_runs;
        self->bend_at = of->pair_count - of->bend_pairs;
        self->bend_damping = of->bend_damping;
    }
}

static void find_couplings(weft__linear *self)
{
    const weft_structure *of = self->of;
    if (WEFT_HAS(of, weft_structure, linearise_blocks)) {
        self->net.block_couplings = of->block_couplings,
        self->net.block_coupling_count = of->block_coupling_count;
        self->net.scalar_couplings = of->scalar_couplings,
        self->net.scalar_coupling_count = of->scalar_coupling_count;
    }
}

weft_status weft__linear_create(const weft_structure *structure,
                                weft_preconditioner preconditioner,
                                const weft_allocator *memory, weft__linear **out,
                                weft_error *err)
{
    weft__pile pile = { .memory = *memory };
    weft__linear *self = weft__pile_take(&pile, 1, sizeof *self);
    bool taken = false;
    *out = NULL;
    if (self != NULL && structure->particles < UINT32_MAX / 4
        && structure->pair_count < UINT32_MAX / 4) {
        *self = (weft__linear){ .of = structure,
                                .preconditioner = preconditioner,
                                .pile = pile,
                                .net = { .n = structure->particles,
                                         .run_count = structure->run_count,
                                         .pair_count = structure->pair_count,
                                         .runs = structure->runs } };
        find_couplings(self);
        find_bend_runs(self);
        taken = take_memory(self);
        pile = self->pile;
    }
    if (!taken) {
        weft__pile_free(&pile);
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for linear systems");
    }
    *out = self;
    return WEFT_OK;
}

void weft__linear_destroy(weft__linear *self)
{
    if (self != NULL) {
        weft__pile pile = self->pile;
        weft__pile_free(&pile);
    }
}

weft__linear_counts weft__linear_count(const weft__linear *self)
{
    return self->counts;
}

/* ---- the matrix ------------------------------------------------------------------ */

int weft__linear_at(weft__linear *self, double t, const double *y)
{
    const weft_structure *of = self->of;
    double *blocks = of->block_planes > 0 ? self->blocks : NULL;
    int failed = of->linearise(t, y, self->planes, blocks, of->ctx);
    if (failed == 0 && self->net.block_coupling_count > 0) {
        failed = of->linearise_blocks(t, y, self->numbers, of->ctx);
    }
    if (failed != 0) {
        return failed;
    }
    if (self->place != NULL) {
        memcpy(self->place, y, 3 * of->particles * sizeof *y);
    }
    weft__filter_springs(self->planes, of->pair_count);
    if (blocks != NULL) {
        weft__filter_blocks(blocks, of->particles);
    }
    ++self->counts.refreshes;
    return 0;
}

/* (gamma c + gamma^2 (k - q)) u u^T + gamma^2 q I for every spring. */
WIDE static void fill_springs(const double *planes, size_t n, double gamma,
                              double *springs)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        const double x = planes[i], y = planes[n + i], z = planes[2 * n + i];
        const double along
            = gamma * planes[5 * n + i] + gamma * gamma * planes[3 * n + i];
        const double all = gamma * gamma * planes[4 * n + i];
        springs[i] = along * x * x + all;
        springs[n + i] = along * x * y;
        springs[2 * n + i] = along * x * z;
        springs[3 * n + i] = along * y * y + all;
        springs[4 * n + i] = along * y * z;
        springs[5 * n + i] = along * z * z + all;
    }
}

/* Adds gamma times the damping of bending. */
static void add_bend_damping(weft__linear *self, double gamma)
{
    const size_t n = self->of->pair_count, first = self->bend_at;
    const double *q = self->planes + 4 * n;
    for (size_t i = first; self->bend_damping != 0.0 && i < n; ++i) {
        const double damping = gamma * self->bend_damping * q[i];
        self->net.spring_entries[i] += damping;
        self->net.spring_entries[3 * n + i] += damping;
        self->net.spring_entries[5 * n + i] += damping;
    }
}

static void fill_block_couplings(weft__linear *self, double gamma)
{
    for (size_t j = 0; j < 9 * self->net.block_coupling_count; ++j) {
        const double *a = self->numbers + j / 9 * WEFT_COUPLING_NUMBERS + j % 9;
        self->net.block_entries[j] = gamma * gamma * a[0] + gamma * a[9];
    }
    self->net.scalar_k = gamma * gamma, self->net.scalar_c = gamma;
}

/* m + gamma drag, and contact; of held particles too, whose rows nobody reads. */
static void fill_points(weft__linear *self, double gamma)
{
    const size_t n = self->of->particles;
    double *point = self->net.point;
    memset(point, 0, 6 * n * sizeof *point);
    self->net.held_count = 0;
    for (size_t i = 0; i < n; ++i) {
        const double mass = self->of->mass[i], own = mass + gamma * self->of->drag[i];
        point[i] = point[3 * n + i] = point[5 * n + i] = own;
        if (!(mass > 0.0)) {
            self->net.held[self->net.held_count++] = (uint32_t)i;
        }
    }
    if (self->of->block_planes > 0) {
        weft__vector_mix(6 * n, gamma * gamma, self->blocks, 1.0, point);
        weft__vector_mix(6 * n, gamma, self->blocks + 9 * n, 1.0, point);
    }
}

void weft__linear_prepare(weft__linear *self, double gamma)
{
    self->gamma = gamma;
    fill_springs(self->planes, self->of->pair_count, gamma, self->net.spring_entries);
    add_bend_damping(self, gamma);
    fill_block_couplings(self, gamma);
    fill_points(self, gamma);
    const double stiffest = weft__network_invert(&self->net, self->of->mass);
    self->cycles = (self->multigrid != NULL || self->smoothed != NULL)
                   && (self->preconditioner == WEFT_PRECONDITIONER_MULTIGRID
                       || stiffest > MULTIGRID_FROM);
    if (self->cycles) {
        if (self->smoothed != NULL) {
            weft__smoothed_prepare(self->smoothed, self->of->mass, self->place);
        } else {
            weft__multigrid_prepare(self->multigrid, self->of->mass);
        }
    }
}

/* ---- one system ------------------------------------------------------------------ */

static void precondition(const weft__linear *self, const double *r, double *z)
{
    if (self->cycles && self->smoothed != NULL) {
        weft__smoothed_apply(self->smoothed, r, z);
    } else if (self->cycles) {
        weft__multigrid_apply(self->multigrid, r, z);
    } else {
        weft__network_precondition(&self->net, r, z);
    }
}

/* S x = b; b becomes the residual. All but `x` and b are 0 at held particles. */
static bool conjugate_gradients(weft__linear *self, double tolerance)
{
    const size_t size = 3 * self->net.n;
    double *r = self->b, *x = self->x, *z = self->z, *p = self->p, *q = self->q;
    double first = 0.0, before = 0.0;
    memset(x, 0, size * sizeof *x);
    for (int k = 0; k < ITERATIONS; ++k) {
        precondition(self, r, z);
        const double now = weft__vector_dot(size, r, z);
        first = k == 0 ? now : first;
        if (now >= 0.0 && now <= tolerance * tolerance * first) {
            return true;
        }
        if (k == 0) {
            memcpy(p, z, size * sizeof *p);
        } else {
            weft__vector_mix(size, 1.0, z, now / before, p);
        }
        weft__network_times(&self->net, p, q);
        const double curvature = weft__vector_dot(size, p, q);
        if (!(now > 0.0) || !(curvature > 0.0)) { /* NaN, too */
            return false;
        }
        weft__vector_mix(size, now / curvature, p, 1.0, x);
        weft__vector_mix(size, -now / curvature, q, 1.0, r);
        before = now;
        ++self->counts.iterations;
    }
    return false;
}

/* b += M rv; 0 of held particles. */
WIDE static void add_momentum(size_t n, const double *mass, const double *rv, double *b)
{
    for (size_t plane = 0; plane < 3; ++plane, rv += n, b += n) {
        ELEMENTWISE
        for (size_t i = 0; i < n; ++i) {
            b[i] = mass[i] > 0.0 ? b[i] + mass[i] * rv[i] : 0.0;
        }
    }
}

/* The solution x of free particles, into r. */
WIDE static void take_solution(size_t n, const double *mass, double gamma,
                               const double *x, double *rx, double *rv)
{
    for (size_t plane = 0; plane < 3; ++plane, x += n, rx += n, rv += n) {
        ELEMENTWISE
        for (size_t i = 0; i < n; ++i) {
            rv[i] = mass[i] > 0.0 ? x[i] : rv[i];
            rx[i] += mass[i] > 0.0 ? gamma * x[i] : 0.0;
        }
    }
}

/* b = M rv - gamma K rx, less gamma C dv of prescribed particles, whose dx is rx. */
static void right_side(weft__linear *self, const double *rx, const double *rv)
{
    const size_t n = self->net.n;
    double *b = self->b, *known = self->z;
    memset(b, 0, 3 * n * sizeof *b);
    weft__network_add_stiffness(&self->net, self->planes, -self->gamma, rx, b);
    weft__network_add_block_couplings(&self->net, self->numbers, WEFT_COUPLING_NUMBERS,
                                      -self->gamma, rx, b);
    weft__network_add_scalar_couplings(&self->net, -self->gamma, 0.0, rx, b);
    for (size_t i = 0; self->of->block_planes > 0 && i < n; ++i) {
        const double *k = self->blocks + i;
        const double g = -self->gamma, x = rx[i], y = rx[n + i], z = rx[2 * n + i];
        b[i] += g * (k[0] * x + k[n] * y + k[2 * n] * z);
        b[n + i] += g * (k[n] * x + k[3 * n] * y + k[4 * n] * z);
        b[2 * n + i] += g * (k[2 * n] * x + k[4 * n] * y + k[5 * n] * z);
    }
    bool moved = false;
    memset(known, 0, 3 * n * sizeof *known);
    for (size_t k = 0; k < 3 * self->net.held_count; ++k) {
        const size_t i = self->net.held[k / 3] + k % 3 * n;
        known[i] = rv[i];
        moved = moved || rv[i] != 0.0;
    }
    if (moved) {
        weft__network_add_damping(&self->net, self->planes, -self->gamma, known, b);
        weft__network_add_stiffness(&self->bend, self->planes + self->bend_at,
                                    -self->gamma * self->bend_damping, known, b);
        weft__network_add_block_couplings(&self->net, self->numbers + 9,
                                          WEFT_COUPLING_NUMBERS, -self->gamma, known,
                                          b);
        weft__network_add_scalar_couplings(&self->net, 0.0, -self->gamma, known, b);
    }
    add_momentum(n, self->of->mass, rv, b);
}

bool weft__linear_solve(weft__linear *self, double tolerance, double *r)
{
    const size_t n = self->net.n;
    double *rx = r, *rv = r + 3 * n;
    right_side(self, rx, rv);
    if (!conjugate_gradients(self, tolerance)) {
        ++self->counts.failures;
        return false;
    }
    take_solution(n, self->of->mass, self->gamma, self->x, rx, rv);
    return true;
}
