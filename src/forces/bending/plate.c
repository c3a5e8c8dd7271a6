/* SPDX-License-Identifier: BSD-3-Clause */
/* plate.c -- the plain loops of plate.h, energy, powers and bounds. plate_fast.c has
 * the same bits. */
#include "forces/bending/plate.h"

#include "base/hash.h"
#include "base/memory.h"
#include "forces/bounds.h"
#include "mesh/triangles_work.h"

static bool plate_present(const void *own)
{
    return ((const weft__plate *)own)->matrix.first != NULL;
}

/* ---- bounds ---------------------------------------------------------------------- */

/* y = |K| d; `diagonal` is scratch. */
static void absolute(const weft__plate_matrix *of, const double *entry, const double *d,
                     double *y, double *diagonal)
{
    memset(y, 0, of->particles * sizeof *y);
    memset(diagonal, 0, of->particles * sizeof *diagonal);
    for (size_t i = 0; i < of->particles; ++i) {
        const weft__plate_row row = weft__plate_row_of(of, i);
        for (size_t j = row.first; j < row.end; ++j) {
            const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
            const size_t p = pair.particle;
            y[i] += fabs(entry[j]) * d[p];
            diagonal[i] -= entry[j];
            y[p] += pair.own ? fabs(entry[j]) * d[i] : 0.0;
            diagonal[p] -= pair.own ? entry[j] : 0.0;
        }
    }
    for (size_t i = 0; i < of->particles; ++i) {
        y[i] += fabs(diagonal[i]) * d[i];
    }
}

enum { ITERATIONS = 3 };

/* For any d > 0 K is at most the diagonal of (|K| d)_i / d_i, by Young's inequality.
 * The power method brings d near the best, that of the largest eigenvalue of M^-1 |K|
 * (L. Collatz, Math. Z. 48, 1942). Needs work[3 N]. */
static void bound_all(weft__plate *of, double *work)
{
    const weft__plate_matrix *matrix = &of->matrix;
    const size_t n = matrix->particles;
    const double *mass = of->mesh->mass;
    double *d = work, *y = d + n, *diagonal = y + n, least = INFINITY;
    for (size_t i = 0; i < n; ++i) {
        d[i] = 1.0;
    }
    for (size_t step = 0; step <= ITERATIONS; ++step) {
        double top = 0.0, size = 0.0;
        absolute(matrix, matrix->entry, d, y, diagonal);
        for (size_t i = 0; i < n; ++i) {
            top = fmax(top, y[i] / (mass[i] * d[i]));
            size = fmax(size, y[i] / mass[i]);
        }
        if (top < least && matrix->damping != NULL) {
            absolute(matrix, matrix->damping, d, of->most + n, diagonal);
        }
        for (size_t i = 0; top < least && i < n; ++i) {
            of->most[i] = y[i] / d[i];
            of->most[n + i] = matrix->damping != NULL ? of->most[n + i] / d[i] : 0.0;
        }
        least = fmin(least, top);
        for (size_t i = 0; size > 0.0 && i < n; ++i) {
            d[i] = y[i] / (mass[i] * size) + 1e-3 * d[i];
        }
    }
}

/* [1/s^2] of a K + b C. Where both count, C is bounded apart; else it lies between the
 * multiples tau[0] K and tau[1] K. */
static void plate_bound(const void *own, const weft__state *at, size_t i,
                        const weft__sides *sides, double (*sums)[6])
{
    const weft__plate *of = own;
    const double *tau = of->matrix.tau;
    (void)at;
    for (size_t s = 0; s < sides->count; ++s) {
        const double a = sides->direction[s][0], b = sides->direction[s][1];
        const double scale = fmax(a + b * tau[0], a + b * tau[1]);
        const double most
            = of->matrix.damping != NULL && a >= 0.0 && b >= 0.0
                  ? a * of->most[i] + b * of->most[of->matrix.particles + i]
                  : fmax(0.0, scale) * of->most[i];
        weft__bound_add(sums[s], most * of->mesh->inverse_mass[i]);
    }
}

static void plate_ratios(const void *own, weft__sides *to)
{
    const weft__plate *of = own;
    for (size_t k = 0; k < 2; ++k) {
        weft__sides_add(to, of->matrix.tau[k]);
    }
}

/* ---- life ------------------------------------------------------------------------ */

/* Entries of K are at most some thousands of B A / h^4, h a triangle's height. */
static void plate_check(const weft_cloth_def *def, const weft__faults *to)
{
    const size_t field = offsetof(weft_cloth_def, mesh);
    for (size_t t = 0; def->mesh != NULL && t < def->mesh->triangles; ++t) {
        const weft_mesh_def *mesh = def->mesh;
        const weft_fabric *of
            = &mesh->fabrics[mesh->fabric_of != NULL ? mesh->fabric_of[t] : 0];
        double longest;
        const double area = fabs(weft__twice_area(mesh, t, &longest));
        const double height = area / longest, square = height * height;
        const double most
            = 1e4 * (of->bend[0] + of->bend[1] + of->twist) / square * (area / square);
        if (isfinite(of->twist)
            && !(isfinite(most) && isfinite(most * of->damping[1]))) {
            weft__fault(to, field, field,
                        "the bending of the fabric of triangle %zu is too large for "
                        "a double at its height of %.3g m",
                        t, height);
            return;
        }
    }
}

static bool plate_init(void *own, const weft_cloth_def *def,
                       const weft_allocator *memory)
{
    weft__plate *of = own;
    const weft__mesh *mesh = of->mesh;
    if (mesh->triangles == NULL || mesh->triangles->count == 0) {
        return true;
    }
    if (!weft__plate_matrix_create(&of->matrix, mesh->triangles, mesh->particles,
                                   mesh->pin, def->stop_ctx, memory)) {
        return false;
    }
    if (!plate_present(of)) {
        return true;
    }
    double *work = weft__alloc(memory, mesh->particles, 3 * sizeof *work);
    of->most = weft__alloc(memory, mesh->particles, 2 * sizeof *of->most);
    const bool made = work != NULL && of->most != NULL;
    if (made) {
        bound_all(of, work);
    }
    weft__free(memory, work);
    return made;
}

static bool plate_copy(void *own, const weft_allocator *memory)
{
    (void)memory;
    ((weft__plate *)own)->copied = true;
    return true;
}

static void plate_free_matrix(void *own, const weft_allocator *memory)
{
    weft__plate *of = own;
    if (!of->copied) {
        weft__plate_matrix_free(&of->matrix, memory);
        weft__free(memory, of->most);
    }
}

/* Nothing without. */
static uint64_t plate_hash_of(const void *own, uint64_t hash)
{
    const weft__plate_matrix *of = &((const weft__plate *)own)->matrix;
    if (of->first == NULL) {
        return hash;
    }
    const size_t groups = (of->particles + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t entries = of->first[groups];
    hash = weft__hash_reals(hash, of->entry, entries);
    hash = weft__hash_reals(hash, of->tau, 2);
    return of->damping != NULL ? weft__hash_reals(hash, of->damping, entries) : hash;
}

static void plate_choose(void *own, weft__isa isa)
{
    ((weft__plate *)own)->fast = WEFT_FORM(isa, plate);
}

/* ---- the force ------------------------------------------------------------------- */

/* Particle i of plane k of what a term multiplies. */
static double plate_value(const weft__plate_matrix *of, const weft__plate_term *term,
                          size_t i, size_t k)
{
    const double *x = term->x + k * of->particles + i;
    return term->tau != 0.0 ? x[0] + term->tau * x[3 * of->particles] : x[0];
}

/* The rows of a term, of the particles of block b: less the force on them. */
static void plate_add_rows(const weft__plate *own, const weft__plate_term *term,
                           size_t b, double (*rows)[3])
{
    const weft__plate_matrix *of = &own->matrix;
    const size_t first = weft__block(own->mesh, b), end = weft__block(own->mesh, b + 1);
    memset(rows, 0, (end - first) * sizeof *rows);
    for (size_t i = first; i < end; ++i) {
        const weft__plate_row row = weft__plate_row_of(of, i);
        double sums[2][3] = { { 0.0 } };
        for (size_t j = row.first; j < row.end; ++j) {
            const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
            for (size_t k = 0; k < 3; ++k) {
                const double apart = plate_value(of, term, i, k)
                                     - plate_value(of, term, pair.particle, k);
                const double pull = term->matrix[j] * apart;
                sums[(j - row.first) % 2][k] += pull;
                if (pair.own) {
                    rows[pair.particle - first][k] += pull;
                }
            }
        }
        for (size_t k = 0; k < 3; ++k) {
            rows[i - first][k] -= sums[0][k] + sums[1][k];
        }
    }
}

int weft__plate_loops(const void *own, const weft__state *at, weft__unit unit,
                      double *to, size_t first, size_t end)
{
    const weft__plate *of = own;
    double rows[WEFT__MESH_BLOCK][3], bad = 0.0;
    weft__plate_term terms[2];
    const size_t count = weft__plate_terms(&of->matrix, at->y, terms);
    for (size_t b = first * count; b < end * count; ++b) {
        const size_t low = weft__block(of->mesh, b / count);
        const size_t high = weft__block(of->mesh, b / count + 1);
        plate_add_rows(of, &terms[b % count], b / count, rows);
        for (size_t i = low; i < high; ++i) {
            const double *row = rows[i - low];
            bad += weft__force_add(of->mesh, unit, i,
                                   (double[3]){ -row[0], -row[1], -row[2] }, to);
        }
    }
    return bad == 0.0 ? 0 : 1;
}

static int plate_add(const void *own, const weft__state *at, weft__unit unit,
                     double *to, size_t first, size_t end)
{
    const weft__plate *of = own;
    int failed = 0;
    for (size_t b = first; b < end; ++b) {
        const size_t near = weft__block(of->mesh, b + 1) - weft__block(of->mesh, b)
                            + of->matrix.halo_first[b + 1] - of->matrix.halo_first[b];
        weft__add_fn *form = near > WEFT__PLATE_ROOM ? weft__plate_loops : of->fast;
        failed |= form(own, at, unit, to, b, b + 1);
    }
    return failed;
}

/* ---- energy and powers ----------------------------------------------------------- */

/* x K x, for planes x[3 N]: the sum of -K_ij |x_i - x_j|^2 over pairs, half of it for
 * each block of a pair of two. */
static double block_square(const weft__plate *own, const double *entry, const double *x,
                           size_t b)
{
    const weft__plate_matrix *of = &own->matrix;
    const size_t n = of->particles, end = weft__block(own->mesh, b + 1);
    double sum = 0.0;
    for (size_t i = weft__block(own->mesh, b); i < end; ++i) {
        const weft__plate_row row = weft__plate_row_of(of, i);
        for (size_t j = row.first; j < row.end; ++j) {
            const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
            const double *at = x + pair.particle;
            const double d[3]
                = { at[0] - x[i], at[n] - x[n + i], at[2 * n] - x[2 * n + i] };
            sum -= (pair.own ? 1.0 : 0.5) * entry[j] * weft__dot(d, d);
        }
    }
    return sum;
}

static void plate_energy(const void *own, const weft__state *at, size_t b,
                         weft_measures *sum)
{
    const weft__plate *of = own;
    sum->energy.elastic[WEFT_BEND]
        += 0.5 * block_square(of, of->matrix.entry, at->y, b);
}

static void plate_power(const void *own, const weft__state *at, size_t b,
                        weft_measures *sum)
{
    const weft__plate *of = own;
    const weft__mesh *mesh = of->mesh;
    const double *v = at->y + 3 * mesh->particles;
    weft__plate_term terms[2];
    double rows[WEFT__MESH_BLOCK][3], rate[6];
    const size_t first = weft__block(mesh, b), end = weft__block(mesh, b + 1);
    const size_t count = weft__plate_terms(&of->matrix, at->y, terms);
    bool moves = false;
    for (size_t i = first; i < end; ++i) {
        moves = moves || weft__pin_moves(mesh, i);
    }
    for (size_t m = 0; moves && m < count; ++m) {
        plate_add_rows(of, &terms[m], b, rows);
        for (size_t i = first; i < end; ++i) {
            if (weft__pin_moves(mesh, i)) {
                weft__pin_rate(mesh, i, at->t, weft__piece(at), rate);
                sum->power[WEFT_POWER_PINS] += weft__dot(rows[i - first], rate);
            }
        }
    }
    const double tau = weft__plate_tau(&of->matrix);
    if (tau != 0.0) {
        sum->power[WEFT_POWER_SPRINGS]
            += tau * block_square(of, of->matrix.entry, v, b);
    }
    if (of->matrix.damping != NULL) {
        sum->power[WEFT_POWER_SPRINGS] += block_square(of, of->matrix.damping, v, b);
    }
}

/* A pair of two blocks is taken from the row of its lower end. */
static size_t plate_scalar_couplings(const void *own, weft_scalar_coupling *to)
{
    const weft__plate_matrix *of = &((const weft__plate *)own)->matrix;
    size_t count = 0;
    for (size_t i = 0; i < of->particles; ++i) {
        const weft__plate_row row = weft__plate_row_of(of, i);
        for (size_t j = row.first; j < row.end; ++j) {
            const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
            const uint32_t p = (uint32_t)i, q = (uint32_t)pair.particle;
            const double k = -of->entry[j];
            const double c
                = of->damping != NULL ? -of->damping[j] : weft__plate_tau(of) * k;
            if ((pair.own || q > p) && (k != 0.0 || c != 0.0)) {
                if (to != NULL) {
                    to[count]
                        = (weft_scalar_coupling){ p < q ? p : q, p < q ? q : p, k, c };
                }
                ++count;
            }
        }
    }
    return count;
}

static size_t plate_bytes(const void *own)
{
    const weft__plate *of = own;
    const weft__plate_matrix *k = &of->matrix;
    const size_t groups = (k->particles + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t blocks = weft__blocks(of->mesh);
    const size_t tables = k->damping != NULL ? 2 : 1;
    const size_t each = sizeof *k->column + tables * sizeof *k->entry;
    return k->first[groups] * each + (groups + 1) * sizeof *k->first
           + k->halo_first[blocks] * sizeof *k->halo
           + (blocks + 1) * sizeof *k->halo_first + 2 * k->particles * sizeof *of->most;
}

static size_t plate_halo(const void *own, size_t b, const uint32_t **particles)
{
    const weft__plate_matrix *of = &((const weft__plate *)own)->matrix;
    *particles = of->halo + of->halo_first[b];
    return of->halo_first[b + 1] - of->halo_first[b];
}

/* Of `count` offsets those from `from` on become those from `to` on, up to `end`; all
 * before are 0, all up to `last` the end. */
static void move_offsets(size_t *of, size_t from, size_t to, size_t end, size_t last)
{
    const size_t start = of[from];
    memmove(of + to, of + from, (end - to + 1) * sizeof *of);
    for (size_t j = 0; j <= last; ++j) {
        of[j] = j < to ? 0 : j <= end ? of[j] - start : of[end];
    }
}

/* K of all rows, and bounds, come from the whole: only the order of the particles is
 * another one. */
static bool slice_matrix(void *own, const weft__slice *slice)
{
    enum { GROUPS = WEFT__MESH_BLOCK / WEFT__PLATE_ROWS };
    weft__plate *plate = own;
    weft__plate_matrix *of = &plate->matrix;
    const size_t n = of->particles, above = slice->above, end = above + slice->own;
    const size_t whole = (n + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t after = (slice->first + slice->own) * GROUPS;
    const size_t begin = of->first[slice->first * GROUPS];
    const size_t entries = of->first[after < whole ? after : whole] - begin;
    const size_t halo_begin = of->halo_first[slice->first];
    const size_t halos = of->halo_first[slice->first + slice->own] - halo_begin;
    double *most = weft__alloc(slice->memory, slice->particles, 2 * sizeof *most);
    if (most == NULL) {
        return false;
    }
    for (size_t i = 0; i < slice->particles; ++i) {
        most[i] = plate->most[slice->whole[i]];
        most[slice->particles + i] = plate->most[n + slice->whole[i]];
    }
    weft__free(slice->memory, plate->most);
    plate->most = most;
    of->particles = slice->particles;
    weft__slice_range(slice, &of->column, begin, entries, sizeof *of->column);
    weft__slice_range(slice, &of->entry, begin, entries, sizeof *of->entry);
    if (of->damping != NULL) {
        weft__slice_range(slice, &of->damping, begin, entries, sizeof *of->damping);
    }
    weft__slice_range(slice, &of->halo, halo_begin, halos, sizeof *of->halo);
    for (size_t j = 0; j < halos; ++j) {
        of->halo[j] = slice->here[of->halo[j]];
    }
    const size_t groups = (of->particles + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t blocks = (of->particles + WEFT__MESH_BLOCK - 1) / WEFT__MESH_BLOCK;
    move_offsets(of->first, slice->first * GROUPS, above * GROUPS,
                 end * GROUPS < groups ? end * GROUPS : groups, groups);
    move_offsets(of->halo_first, slice->first, above, end, blocks);
    weft__slice_range(slice, &of->first, 0, groups + 1, sizeof *of->first);
    return true;
}

const weft__force weft__plate_force
    = { .name = "plate",
        .tables.check = plate_check,
        .tables.init = plate_init,
        .tables.hash = plate_hash_of,
        .tables.choose = plate_choose,
        .tables.copy = plate_copy,
        .tables.free = plate_free_matrix,
        .tables.bytes = plate_bytes,
        .tables.halo = plate_halo,
        .tables.slice = slice_matrix,
        .present = plate_present,
        .law.add = plate_add,
        .law.linear = true,
        .measures.energy = plate_energy,
        .measures.power = plate_power,
        .bounds.ratios = plate_ratios,
        .bounds.particle = plate_bound,
        .couplings.scalar_couplings = plate_scalar_couplings };
