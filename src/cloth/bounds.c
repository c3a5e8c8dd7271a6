/* SPDX-License-Identifier: BSD-3-Clause */
/* bounds.c -- bounds on the stiffness and damping of all modes: in several directions
 * (a, b) one on the eigenvalues of M^-1 (a K + b C), a sum over the free neighbours of
 * each particle, and the polygon of all pairs (w, c) within them. Derived in
 * docs/theory/stability.md, "The bound". */
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "cloth/grids.h"

/* cos(acos(r) / 3) for |r| <= 1: the largest root of 4 c^3 - 3 c = r, from above, by
 * Newton's method, whose bits are the same everywhere. */
static double third_of_angle(double r)
{
    double c = 1.0, next = 1.0;
    do {
        c = next;
        next = c - ((4.0 * c * c - 3.0) * c - r) / (12.0 * c * c - 3.0);
    } while (next < c);
    return c;
}

/* Largest eigenvalue of a symmetric 3 x 3 matrix xx, yy, zz, xy, xz, yz or a hair more:
 * the trigonometric solution of its cubic (O. K. Smith, Comm. ACM 4, 1961). */
static double largest_eigenvalue(const double b[6])
{
    const double mean = (b[0] + b[1] + b[2]) / 3.0;
    const double dev[3] = { b[0] - mean, b[1] - mean, b[2] - mean };
    const double off = b[3] * b[3] + b[4] * b[4] + b[5] * b[5];
    const double square = dev[0] * dev[0] + dev[1] * dev[1] + dev[2] * dev[2];
    const double p = sqrt((square + 2.0 * off) / 6.0);
    if (!isfinite(p)) {
        return INFINITY;
    }
    if (p == 0.0) {
        return mean;
    }
    const double x = dev[0] / p, y = dev[1] / p, z = dev[2] / p;
    const double xy = b[3] / p, xz = b[4] / p, yz = b[5] / p;
    const double r
        = 0.5
          * (x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz));
    return mean + 2.0 * p * third_of_angle(fmax(-1.0, fmin(1.0, r)))
           + WEFT__ROUNDOFF * (fabs(mean) + 2.0 * p);
}

/* Damping alike in all springs makes the polygon a line. Without a state there are the
 * first three. */
static weft__sides sides_of(const weft_cloth *cloth, const double *y)
{
    weft__sides sides
        = { .count = 3, .direction = { { 1.0, 0.0 }, { 0.0, 1.0 }, { 0.0, -1.0 } } };
    if (y != NULL) {
        WEFT__EACH_FORCE(cloth, bounds.ratios, &sides)
    }
    for (size_t g = 0; y != NULL && g < cloth->grid_count; g += 2) {
        WEFT__EACH_FORCE(&cloth->grids[g], bounds.ratios, &sides)
    }
    return sides;
}

/* Adds an upper bound of a K + b C to matrix[6]. */
static void range_stiffness_times(const weft__range_stiffness *range_stiffness,
                                  double a, double b, double matrix[6])
{
    for (size_t k = 0; k < 6; ++k) {
        matrix[k] += a * range_stiffness->normal_stiffness[k]
                     + b * range_stiffness->normal_damping[k]
                     + fmax(0.0, b) * range_stiffness->friction_damping[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        matrix[k] += fabs(a) * range_stiffness->any_stiffness
                     + fabs(b) * range_stiffness->any_damping
                     + fmax(0.0, -a) * range_stiffness->negative_stiffness;
    }
}

/* Cuts from the polygon all beyond a w + b c <= most, (a, b) = direction. */
static void cut(weft_stiffness *from, const double direction[2], double most)
{
    weft_stiffness left = *from;
    left.count = 0;
    for (size_t i = 0; i < from->count; ++i) {
        const double *p = from->corners[i], *q = from->corners[(i + 1) % from->count];
        const double over_p = direction[0] * p[0] + direction[1] * p[1] - most;
        const double over_q = direction[0] * q[0] + direction[1] * q[1] - most;
        if (over_p <= 0.0) {
            memcpy(left.corners[left.count++], p, sizeof *from->corners);
        }
        if ((over_p < 0.0 && over_q > 0.0) || (over_p > 0.0 && over_q < 0.0)) {
            const double part = over_p / (over_p - over_q);
            double *at = left.corners[left.count++];
            at[0] = p[0] + part * (q[0] - p[0]);
            at[1] = p[1] + part * (q[1] - p[1]);
        }
    }
    if (left.count > 0) { /* always, but for roundoff */
        *from = left;
    }
}

/* Particles whose contact is gathered in one search where there is no room for all. */
enum { BLOCK = 512 };

/* Of all forces but contact, for each side; the last of the table first. */
static void bound_of(const weft_cloth *cloth, const weft__state *at, size_t i,
                     const weft__sides *sides, double (*sums)[6])
{
    const weft_cloth *grid = weft__grids_at(cloth, i),
                     *of = grid != NULL ? grid : cloth;
    const size_t first = of->first;
    weft__state own = *at;
    own.y = at->y != NULL ? at->y + first : NULL;
    memset(sums, 0, sides->count * sizeof *sums);
    for (size_t k = WEFT__FORCES; k-- > 0;) {
        const weft__force *force = weft__force_at(of, k);
        if (force != NULL && force->bounds.particle != NULL) {
            force->bounds.particle(weft__own(of, k), &own, i - first, sides, sums);
        }
    }
}

typedef struct raising {
    const weft_cloth *cloth;
    void *const *spaces; /* of forces; or NULL */
    const weft__state *at;
    weft__sides sides;
    double *most;
} raising;

/* Raises the bounds to those of free particles [first, end), whose contact is gathered
 * in `range_stiffness`. */
static void raise_sides(const raising *of, size_t first, size_t end,
                        weft__range_stiffness *range_stiffness)
{
    const weft_cloth *cloth = of->cloth;
    const weft__sides *sides = &of->sides;
    double sums[WEFT__SIDES][6];
    memset(range_stiffness, 0, (end - first) * sizeof *range_stiffness);
    WEFT__EACH_FORCE(cloth, bounds.range_stiffness,
                     of->spaces != NULL ? of->spaces[k_] : NULL, of->at, first,
                     end - first, range_stiffness)
    for (size_t i = first; i < end; ++i) {
        if (cloth->mesh.pin[i] == 0) {
            bound_of(cloth, of->at, i, sides, sums);
            for (size_t s = 0; s < sides->count; ++s) {
                range_stiffness_times(&range_stiffness[i - first],
                                      sides->direction[s][0], sides->direction[s][1],
                                      sums[s]);
                of->most[s] = fmax(of->most[s], largest_eigenvalue(sums[s]));
            }
        }
    }
}

void weft__stiffness_sides(const weft_cloth *cloth, void *const *spaces,
                           weft__range_stiffness *room, double t, const double *y,
                           double most[WEFT__SIDES])
{
    const weft__mesh *mesh = &cloth->mesh;
    const weft__state at = { .t = t, .y = y };
    const raising of = { cloth, spaces, &at, sides_of(cloth, y), most };
    const size_t first = weft__block(mesh, mesh->band.above);
    const size_t end = weft__block(mesh, mesh->band.above + mesh->band.own);
    weft__range_stiffness some[BLOCK];
    const size_t each = room != NULL ? end - first : BLOCK;
    for (size_t s = 0; s < WEFT__SIDES; ++s) {
        most[s] = -INFINITY;
    }
    for (size_t i = first; i < end; i += each) {
        raise_sides(&of, i, end - i < each ? end : i + each,
                    room != NULL ? room : some);
    }
}

bool weft__range_stiffness_create(const weft_cloth *cloth, const weft_allocator *memory,
                                  weft__range_stiffness **out)
{
    const bool pairs = weft__cloth_pairs(cloth);
    *out
        = pairs ? weft__alloc(memory, weft_cloth_particles(cloth), sizeof **out) : NULL;
    return !pairs || *out != NULL;
}

weft__stiffest weft__stiffest_of(const weft_cloth *cloth, double t, const double *y)
{
    const weft__sides sides
        = { .count = 2, .direction = { { 1.0, 0.0 }, { 0.0, 1.0 } } };
    const weft__mesh *mesh = &cloth->mesh;
    const weft__state at = { .t = t, .y = y };
    const size_t end = weft__block(mesh, mesh->band.above + mesh->band.own);
    weft__stiffest out = { 0 };
    for (size_t i = weft__block(mesh, mesh->band.above); i < end; ++i) {
        double sums[WEFT__SIDES][6];
        if (mesh->pin[i] == 0) {
            bound_of(cloth, &at, i, &sides, sums);
            const double rate = fmax(sqrt(fmax(0.0, largest_eigenvalue(sums[0]))),
                                     largest_eigenvalue(sums[1]));
            out = rate > out.rate ? (weft__stiffest){ rate, i } : out;
        }
    }
    return out;
}

weft_stiffness weft__stiffness_within(const weft_cloth *cloth, const double *y,
                                      const double most[WEFT__SIDES])
{
    const weft__sides sides = sides_of(cloth, y);
    const bool moves = most[0] != -INFINITY; /* a particle that is not pinned */
    weft_stiffness bound = { .omega2 = moves ? most[0] : 0.0,
                             .damping = moves ? most[1] : 0.0,
                             .count = 4 };
    bound.corners[1][0] = bound.corners[2][0] = bound.omega2;
    bound.corners[2][1] = bound.corners[3][1] = bound.damping;
    const bool finite = isfinite(bound.omega2) && isfinite(bound.damping);
    for (size_t s = 2; moves && finite && s < sides.count; ++s) {
        cut(&bound, sides.direction[s], most[s]);
    }
    return bound;
}

weft_stiffness weft_cloth_stiffness(const weft_cloth *cloth, double t, const double *y)
{
    double most[WEFT__SIDES];
    weft__range_stiffness
        *room; /* without it a search for every BLOCK particles does */
    (void)weft__range_stiffness_create(cloth, &cloth->memory, &room);
    weft__stiffness_sides(cloth, NULL, room, t, y, most);
    weft__free(&cloth->memory, room);
    return weft__stiffness_within(cloth, y, most);
}

/* ---- the power method ----------------------------------------------------------- */

/* The linearisation of all forces but contact, for particles at rest. */
typedef struct matrix {
    weft_structure of;
    void *lists; /* of `of` */
    double *y, *planes,
        *numbers; /* the state; of spring couplings; of block couplings */
} matrix;

static void bounds_free_matrix(const weft_cloth *cloth, matrix *of)
{
    WEFT__FREE_ALL(&cloth->memory, of->lists, of->y, of->planes, of->numbers);
}

/* False: no memory. */
static bool find_matrix(const weft_cloth *cloth, const weft__state *at, matrix *out)
{
    const weft_allocator *memory = &cloth->memory;
    const size_t n = cloth->mesh.particles;
    weft_structure *of = &out->of;
    *out = (matrix){ .lists = NULL };
    out->lists = weft__list_structure(cloth, true, memory, of);
    out->y = weft__zeroed(memory, 6 * n, sizeof *out->y);
    out->planes = weft__alloc(memory, of->pair_count, 6 * sizeof *out->planes);
    out->numbers = weft__alloc(memory, of->block_coupling_count,
                               WEFT_COUPLING_NUMBERS * sizeof *out->numbers);
    if (out->lists == NULL || out->y == NULL || out->planes == NULL
        || out->numbers == NULL) {
        return false;
    }
    memcpy(out->y, at->y, 3 * n * sizeof *out->y);
    const weft__state still = { .t = at->t, .y = out->y };
    (void)weft__linearise(cloth, NULL, &still, out->planes, of->pair_count, NULL);
    (void)weft__linearise_block_couplings(cloth, at->t, out->y, out->numbers);
    return true;
}

/* Slack springs are taken for straight ones: q is one of [0, k], as k is of bending. */
static void multiply_springs(const weft_cloth *cloth, const matrix *of, double a,
                             double b, const double *x, double *out)
{
    const size_t n = cloth->mesh.particles, all = of->of.pair_count;
    for (size_t r = 0, e = 0; r < of->of.run_count; ++r) {
        for (size_t i = 0; i < of->of.runs[r].count; ++i, ++e) {
            const size_t p = of->of.runs[r].p + i, q = of->of.runs[r].q + i;
            const double *u = of->planes + e, pull = u[4 * all], k = u[3 * all] + pull;
            const double bent
                = e < all - of->of.bend_pairs ? 0.0 : b * of->of.bend_damping;
            const double across = (a + bent) * fmin(fmax(pull, 0.0), k);
            double rate = 0.0;
            for (size_t j = 0; j < 3; ++j) {
                rate += u[j * all] * (x[j * n + q] - x[j * n + p]);
            }
            for (size_t j = 0; j < 3; ++j) {
                const double force
                    = across * (x[j * n + q] - x[j * n + p])
                      + (a * k + b * u[5 * all] - across) * rate * u[j * all];
                out[j * n + p] -= force;
                out[j * n + q] += force;
            }
        }
    }
}

static void multiply_block_couplings(const matrix *of, size_t n, double a, double b,
                                     const double *x, double *out)
{
    for (size_t j = 0; j < 9 * of->of.block_coupling_count; ++j) {
        const double *at = of->numbers + j / 9 * WEFT_COUPLING_NUMBERS + j % 9;
        const size_t p = of->of.block_couplings[j / 9].p,
                     q = of->of.block_couplings[j / 9].q;
        const size_t r = j % 9 / 3 * n, c = j % 3 * n;
        const double entry = a * at[0] + b * at[9];
        out[r + p] += entry * (x[c + p] - x[c + q]);
        out[c + q] += entry * (x[r + q] - x[r + p]);
    }
    for (size_t j = 0; j < 3 * of->of.scalar_coupling_count; ++j) {
        const weft_scalar_coupling *coupling = &of->of.scalar_couplings[j / 3];
        const size_t p = j % 3 * n + coupling->p, q = j % 3 * n + coupling->q;
        const double force = (a * coupling->k + b * coupling->c) * (x[p] - x[q]);
        out[p] += force;
        out[q] -= force;
    }
}

/* M^-1 (a K + b C) x, zero on pins. */
static void bounds_multiply(const weft_cloth *cloth, const weft__state *at,
                            const matrix *of, const double direction[2],
                            const double *x, double *out)
{
    const size_t n = cloth->mesh.particles;
    for (size_t j = 0; j < 3 * n; ++j) {
        out[j] = direction[1] * cloth->body.drag * x[j];
    }
    multiply_springs(cloth, of, direction[0], direction[1], x, out);
    multiply_block_couplings(of, n, direction[0], direction[1], x, out);
    WEFT__EACH_FORCE(cloth, bounds.multiply, at, direction[0], direction[1], x, out)
    for (size_t j = 0; j < 3 * n; ++j) {
        out[j] *= cloth->mesh.inverse_mass[j % n];
    }
}

/* Numbers in [-1, 1) that are orthogonal to nothing: the j-th of a random sequence. */
static double scatter(uint64_t j)
{
    uint64_t state = j * UINT64_C(0x9e3779b97f4a7c15);
    return (double)(weft__random(&state) >> 11) * 0x1p-52 - 1.0;
}

/* x* M z over the free particles, block by block */
static double bounds_product(const weft__mesh *mesh, const double *x, const double *z)
{
    const size_t n = mesh->particles;
    double sum = 0.0;
    for (size_t b = 0; b < weft__blocks(mesh); ++b) {
        double part = 0.0;
        for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
            part += mesh->mass[i]
                    * (x[i] * z[i] + x[n + i] * z[n + i] + x[2 * n + i] * z[2 * n + i]);
        }
        sum += part;
    }
    return sum;
}

typedef struct estimate {
    double value;  /* the Rayleigh quotient: from below */
    double spread; /* |M^-1 A x - value x| of the x it is of, |x| = 1 */
} estimate;

static estimate bounds_power(const weft_cloth *cloth, const weft__state *at,
                             const matrix *of, const double direction[2],
                             size_t iterations, double *x, double *z)
{
    estimate best = { 0.0, 0.0 };
    for (size_t j = 0; j < 3 * cloth->mesh.particles; ++j) {
        x[j] = cloth->mesh.inverse_mass[j % cloth->mesh.particles] > 0.0 ? scatter(j)
                                                                         : 0.0;
    }
    for (size_t i = 0; i < iterations; ++i) {
        const double norm = sqrt(bounds_product(&cloth->mesh, x, x));
        for (size_t j = 0; norm > 0.0 && j < 3 * cloth->mesh.particles; ++j) {
            x[j] /= norm;
        }
        bounds_multiply(cloth, at, of, direction, x, z);
        const double value = bounds_product(&cloth->mesh, x, z),
                     square = bounds_product(&cloth->mesh, z, z);
        best = (estimate){ value, sqrt(fmax(0.0, square - value * value)) };
        memcpy(x, z, 3 * cloth->mesh.particles * sizeof *x);
    }
    return best;
}

weft_status weft_cloth_stiffness_refined(const weft_cloth *cloth, double t,
                                         const double *y, size_t iterations,
                                         weft_stiffness *out, weft_error *err)
{
    if (y == NULL) {
        return weft_error_set(err, WEFT_INVALID, "the power method needs a state");
    }
    const size_t size = 3 * cloth->mesh.particles;
    const weft__state at = { .t = t, .y = y };
    matrix of;
    double *work = weft__alloc(&cloth->memory, 2 * size, sizeof *work);
    if (!find_matrix(cloth, &at, &of) || work == NULL) {
        bounds_free_matrix(cloth, &of);
        weft__free(&cloth->memory, work);
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the power method");
    }
    *out = weft_cloth_stiffness(cloth, t, y);
    static const double directions[2][2] = { { 1.0, 0.0 }, { 0.0, 1.0 } };
    double *values[2] = { &out->omega2, &out->damping };
    for (size_t i = 0; i < 2 && isfinite(*values[i]); ++i) {
        const estimate found
            = bounds_power(cloth, &at, &of, directions[i],
                           iterations > 0 ? iterations : 100, work, work + size);
        *values[i] = fmin(*values[i], found.value);
        cut(out, directions[i], found.value + 2.0 * found.spread);
    }
    bounds_free_matrix(cloth, &of);
    weft__free(&cloth->memory, work);
    return WEFT_OK;
}
