/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/round.h"

#include <stdatomic.h>

#include "cloth/model.h"

/* A block has so many rows and particles at least, a span so many rows. What the fast
 * forms read past the end of a row is in the next row, or in the next plane. */
enum {
    STENCIL_ROWS = WEFT_GHOST_ROWS,
    READ = STENCIL_ROWS + 1,
    BLOCK = 8,
    BLOCK_LEAST = 4096,
    SPAN = 32,
    SPANS_PER_THREAD = 4,
    PARTICLES_LEAST = 20000,
    PARTICLES_ALONE = 1 << 15 /* on one thread */
};

typedef struct round_job {
    const weft__forces *forces;
    const weft_cloth *cloth;
    const weft_round *of;
    weft_part *after;
    size_t spans, block;
    atomic_int failed;
    atomic_size_t sum;
} round_job;

static size_t round_least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static size_t round_start_of(const round_job *all, size_t span)
{
    return span * all->cloth->mesh.rows / all->spans;
}

/* Of rows [first, end). */
static void round_take(round_job *all, weft_part *part, size_t first, size_t end)
{
    const weft__mesh *mesh = &all->cloth->mesh;
    size_t sum = 0;
    for (size_t p = 0; p < 3 && part != NULL && first < end; ++p) {
        const size_t plane = p * mesh->particles;
        sum += part(all->of->ctx, plane + first * mesh->cols, plane + end * mesh->cols);
    }
    atomic_fetch_add(&all->sum, sum);
}

static void round_evaluate(round_job *all, size_t first, size_t end)
{
    const weft__state at = weft__forces_state(all->forces, all->of->t, all->of->y);
    if (first < end && all->of->f != NULL
        && weft__rhs_blocks(all->cloth, &at, all->of->f, first, end) != 0) {
        atomic_store(&all->failed, 1);
    }
}

static void round_do_span(void *ctx, size_t b)
{
    round_job *all = ctx;
    const size_t end = round_start_of(all, b + 1);
    const bool alone = all->spans == 1;
    const size_t above = b > 0 ? STENCIL_ROWS : 0;
    size_t made = round_start_of(all, b), done = made + above, used = done + above;
    while (made < end && atomic_load(&all->failed) == 0) {
        const size_t next = round_least(made + all->block, end);
        const size_t to = next == end ? end - (alone ? 0 : READ) : next - STENCIL_ROWS;
        const size_t till = next == end && alone ? end : to - STENCIL_ROWS;
        round_take(all, all->of->before, made, next);
        round_evaluate(all, done, to);
        round_take(all, all->after, used, till);
        made = next, done = to, used = till;
    }
}

/* Between spans s and s + 1, or at the end of the last. */
static void do_seam(void *ctx, size_t s)
{
    round_job *all = ctx;
    const size_t row = round_start_of(all, s + 1), rows = all->cloth->mesh.rows;
    round_evaluate(all, row - READ, round_least(row + STENCIL_ROWS, rows));
    round_take(all, all->after, row - READ - STENCIL_ROWS,
               round_least(row + 2 * STENCIL_ROWS, rows));
}

bool weft__round_can(const weft__forces *forces)
{
    const weft_cloth *cloth = forces->cloth;
    bool whole = cloth->mesh.triangles != NULL || forces->comm != NULL;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        whole = whole || (force != NULL && force->whole.add != NULL);
    }
    return !whole;
}

bool weft__round_pays(const weft__forces *forces)
{
    const bool alone = weft__pool_threads(forces->pool) == 1;
    return weft__round_can(forces)
           && weft_cloth_particles(forces->cloth)
                  >= (alone ? PARTICLES_ALONE : PARTICLES_LEAST);
}

int weft__round_run(const weft__forces *forces, weft_round *round)
{
    const weft__mesh *mesh = &forces->cloth->mesh;
    const size_t rows = BLOCK_LEAST / mesh->cols + 1;
    const size_t most = mesh->cols < WEFT_PAST ? 1 : mesh->rows / SPAN;
    const size_t threads = weft__pool_threads(forces->pool);
    const size_t spans
        = round_least(threads > 1 ? SPANS_PER_THREAD * threads : 1, most);
    round_job all = { .forces = forces,
                      .cloth = forces->cloth,
                      .of = round,
                      .after = round->f != NULL ? round->after : NULL,
                      .spans = spans > 0 ? spans : 1,
                      .block = rows > BLOCK ? rows : BLOCK };
    weft__pool_run(forces->pool, round_do_span, &all, all.spans);
    if (all.spans > 1 && round->f != NULL && atomic_load(&all.failed) == 0) {
        weft__pool_run(forces->pool, do_seam, &all, all.spans);
    }
    round->sum = atomic_load(&all.sum);
    return atomic_load(&all.failed);
}
