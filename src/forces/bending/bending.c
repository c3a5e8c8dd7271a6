/* SPDX-License-Identifier: BSD-3-Clause */
/* bending.c -- the plain loops of bending.h, the numbers of a definition, energy and
 * powers. bending_fast.c has the same bits. */
#include "forces/bending/bending.h"

#include "base/hash.h"
#include "forces/bounds.h"
#include "forces/springs/springs.h"

#define NOT_NEGATIVE .least = 0.0

/* ---- the definition -------------------------------------------------------------- */

double weft__twist_of(const weft_bending_def *of)
{
    return of->twist < 0.0 ? sqrt(of->rigidity[0] * of->rigidity[1]) : of->twist;
}

const struct weft__bending_numbers weft__bending_numbers = {
    WEFT__FIELD(weft_bending_def, rigidity, "N m", .count = 2, NOT_NEGATIVE),
    WEFT__FIELD(weft_bending_def, twist, "N m", .least = -HUGE_VAL),
    WEFT__FIELD(weft_bending_def, damping, "s", NOT_NEGATIVE),
};

static weft__bending rigidity_of(const weft_cloth_def *def)
{
    const weft_bending_def *of = &def->bending;
    const double a = weft__width(def->rows, def->spacing[0]);
    const double b = weft__width(def->cols, def->spacing[1]);
    const bool sheet = def->rows > 1 && def->cols > 1;
    const double twist = weft__twist_of(of);
    weft__bending k = { .along = of->rigidity[0] * b / (a * a * a),
                        .across = of->rigidity[1] * a / (b * b * b),
                        .twist = sheet ? 2.0 * twist / (a * b) : 0.0,
                        .damping = of->damping };
    k.along = def->rows > 2 ? k.along : 0.0;
    k.across = def->cols > 2 ? k.across : 0.0;
    k.present = of->rigidity[0] > 0.0 || of->rigidity[1] > 0.0 || twist > 0.0;
    return k;
}

static void bending_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (def->mesh != NULL) {
        return;
    }
    const size_t bending = offsetof(weft_cloth_def, bending);
    if (!WEFT__NUMBERS_CHECK(weft__bending_numbers, &def->bending, to, "bending: ")) {
        return;
    }
    const weft__bending of = rigidity_of(def);
    const double most = 16.0 * (of.along + of.across + of.twist);
    if (of.present && def->springs[WEFT_BEND].present) {
        weft__fault(to, bending, offsetof(weft_cloth_def, springs[WEFT_BEND]),
                    "bending rigidity excludes bend springs: remove one of them");
    }
    if (!isfinite(most) || !isfinite(most * of.damping)) {
        weft__fault(to, bending, bending,
                    "the bending rigidities are too large or too small for a double");
    }
}

static bool bending_init(void *own, const weft_cloth_def *def,
                         const weft_allocator *memory)
{
    weft__bending *of = own;
    weft__bending k = def->mesh == NULL ? rigidity_of(def) : (weft__bending){ 0 };
    (void)memory;
    k.mesh = of->mesh, k.fast = of->fast;
    *of = k;
    return true;
}

/* Nothing without. */
static uint64_t bending_hash_of(const void *own, uint64_t hash)
{
    const weft__bending *of = own;
    return of->present
               ? WEFT__HASH_NUMBERS(hash, of->along, of->across, of->twist, of->damping)
               : hash;
}

static void bending_choose(void *own, weft__isa isa)
{
    ((weft__bending *)own)->fast = WEFT_FORM(isa, bending);
}

static bool bending_present(const void *own)
{
    return ((const weft__bending *)own)->present;
}

/* ---- the force ------------------------------------------------------------------- */

/* A plane of x and one of v; v NULL: x alone. */
typedef struct field {
    const weft__bending *own;
    const double *x, *v;
} field;

static double bending_value(const field *of, size_t r, size_t c)
{
    const size_t i = r * of->own->mesh->cols + c;
    return of->v != NULL ? of->x[i] + of->own->damping * of->v[i] : of->x[i];
}

static double second(double low, double here, double high)
{
    return (high - here) - (here - low);
}

static double along_column(const field *of, size_t r, size_t c)
{
    return second(bending_value(of, weft__before(r), c), bending_value(of, r, c),
                  bending_value(of, weft__after(r, of->own->mesh->rows), c));
}

static double along_row(const field *of, size_t r, size_t c)
{
    return second(bending_value(of, r, weft__before(c)), bending_value(of, r, c),
                  bending_value(of, r, weft__after(c, of->own->mesh->cols)));
}

/* k_r D_r + k_t D_c */
static double column_moment(const field *of, size_t r, size_t c)
{
    const weft__bending *own = of->own;
    const double part = weft__inner(r, own->mesh->rows) ? own->along : 0.0;
    return part * weft__strip(c, own->mesh->cols) * along_column(of, r, c)
           + own->twist * along_row(of, r, c);
}

/* k_c D_c */
static double row_moment(const field *of, size_t r, size_t c)
{
    const weft__bending *own = of->own;
    const double part = own->across * weft__strip(r, own->mesh->rows);
    return weft__inner(c, own->mesh->cols) ? part * along_row(of, r, c) : 0.0;
}

/* K (x + damping v) */
static double resistance(const field *of, size_t i)
{
    const size_t rows = of->own->mesh->rows, cols = of->own->mesh->cols;
    const size_t r = i / cols, c = i % cols;
    const double moment = column_moment(of, r, c);
    const double across
        = second(row_moment(of, r, weft__before(c)), row_moment(of, r, c),
                 row_moment(of, r, weft__after(c, cols)));
    return (column_moment(of, weft__after(r, rows), c) - moment)
           + (across - (moment - column_moment(of, weft__before(r), c)));
}

/* [N] on particle i in a state. */
static void force_on(const weft__bending *own, const double *y, size_t i,
                     double force[3])
{
    const size_t n = own->mesh->stride;
    for (size_t k = 0; k < 3; ++k) {
        const double *x = y + k * n;
        const field plane = { own, x, own->damping != 0.0 ? x + 3 * n : NULL };
        force[k] = -resistance(&plane, i);
    }
}

int weft__bending_loops(const void *own, const weft__state *at, weft__unit unit,
                        double *to, size_t first, size_t end)
{
    const weft__bending *of = own;
    const weft__mesh *mesh = of->mesh;
    double bad = 0.0;
    for (size_t i = weft__block(mesh, first); i < weft__block(mesh, end); ++i) {
        double force[3];
        force_on(of, at->y, i, force);
        bad += weft__force_add(mesh, unit, i, force, to);
    }
    return bad == 0.0 ? 0 : 1;
}

static int bending_add(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__bending *of = own;
    weft__add_fn *form = unit == WEFT__FORCE ? weft__bending_loops : of->fast;
    return form(own, at, unit, to, first, end);
}

/* ---- energy and powers ----------------------------------------------------------- */

/* [x K x] of what is centred in row r and of the cells that begin there, for planes
 * x[3 N]. */
static double row_square(const weft__bending *own, const double *x, size_t r)
{
    const size_t n = own->mesh->stride, rows = own->mesh->rows, cols = own->mesh->cols;
    const weft__bending *k = own;
    const double across = k->across * weft__strip(r, rows);
    const size_t down = r + 1 < rows ? cols : 0;
    double sum = 0.0;
    for (size_t plane = 0; plane < 3; ++plane) {
        const field of = { own, x + plane * n, NULL };
        for (size_t c = 0; c < cols; ++c) {
            const double *at = of.x + r * cols + c;
            const double d = weft__inner(r, rows) ? along_column(&of, r, c) : 0.0;
            const double e = weft__inner(c, cols) ? along_row(&of, r, c) : 0.0;
            const double f
                = c + 1 < cols ? (at[down + 1] - at[down]) - (at[1] - at[0]) : 0.0;
            sum += k->along * weft__strip(c, cols) * d * d + across * e * e
                   + k->twist * f * f;
        }
    }
    return sum;
}

static void bending_energy(const void *own, const weft__state *at, size_t b,
                           weft_measures *sum)
{
    sum->energy.elastic[WEFT_BEND] += 0.5 * row_square(own, at->y, b);
}

/* Of the pins that move in row r. */
static double bending_pin_power(const weft__bending *own, const weft__state *at,
                                size_t r)
{
    const weft__mesh *mesh = own->mesh;
    double power = 0.0, rate[6], force[3];
    for (size_t i = r * mesh->cols; i < (r + 1) * mesh->cols; ++i) {
        if (weft__pin_moves(mesh, i)) {
            weft__pin_rate(mesh, i, at->t, weft__piece(at), rate);
            force_on(own, at->y, i, force);
            for (size_t k = 0; k < 3; ++k) {
                power -= force[k] * rate[k];
            }
        }
    }
    return power;
}

static void bending_power(const void *own, const weft__state *at, size_t b,
                          weft_measures *sum)
{
    const weft__bending *of = own;
    const double *v = at->y + 3 * of->mesh->stride;
    sum->power[WEFT_POWER_PINS] += bending_pin_power(of, at, b);
    if (of->damping != 0.0) {
        sum->power[WEFT_POWER_SPRINGS] += of->damping * row_square(of, v, b);
    }
}

/* ---- the matrix ------------------------------------------------------------------ */

/* Neighbours along a line of `count`. */
static double bending_neighbours(size_t at, size_t count)
{
    return (at > 0 ? 1.0 : 0.0) + (at + 1 < count ? 1.0 : 0.0);
}

/* The sum of row `at` of |D k D|, k = 1 where three are centred. */
static double line_sum(size_t at, size_t count)
{
    const bool low = at > 0 && weft__inner(at - 1, count);
    return 4.0 * (low ? 1.0 : 0.0) + (weft__inner(at, count) ? 8.0 : 0.0)
           + (weft__inner(at + 1, count) ? 4.0 : 0.0);
}

/* [N/m] The sum of all |K_ij| of particle i: K <= diag of these. */
static double row_sum(const weft__bending *own, size_t i)
{
    const size_t rows = own->mesh->rows, cols = own->mesh->cols, r = i / cols,
                 c = i % cols;
    const weft__bending *k = own;
    return k->along * weft__strip(c, cols) * line_sum(r, rows)
           + k->across * weft__strip(r, rows) * line_sum(c, cols)
           + 4.0 * k->twist * bending_neighbours(r, rows) * bending_neighbours(c, cols);
}

static void bending_ratios(const void *own, weft__sides *to)
{
    weft__sides_add(to, ((const weft__bending *)own)->damping);
}

static void bending_bound(const void *own, const weft__state *at, size_t i,
                          const weft__sides *sides, double (*sums)[6])
{
    const weft__bending *of = own;
    const double most = row_sum(of, i) * of->mesh->inverse_mass[i];
    (void)at;
    for (size_t s = 0; s < sides->count; ++s) {
        const double scale
            = sides->direction[s][0] + sides->direction[s][1] * of->damping;
        weft__bound_add(sums[s], fmax(0.0, scale) * most);
    }
}

/* 2 for each of `at` and the next one where three particles are centred. */
static double centred(size_t at, size_t count)
{
    return (weft__inner(at, count) ? 2.0 : 0.0)
           + (weft__inner(at + 1, count) ? 2.0 : 0.0);
}

/* K as pairs: K x on p is the sum of -q (x_q - x_p), q = -K_pq of either sign. Those of
 * one of WEFT_GROUPS orientations are a group without a law. [N/m] q of the one at (r,
 * c): */
static double bending_pull_of(const weft__bending *own, size_t orientation, size_t r,
                              size_t c)
{
    const size_t rows = own->mesh->rows, cols = own->mesh->cols;
    const weft__bending *k = own;
    const double along = k->along * weft__strip(c, cols);
    const double across = k->across * weft__strip(r, rows);
    const double pulls[WEFT_GROUPS]
        = { across * centred(c, cols) + k->twist * bending_neighbours(r, rows),
            along * centred(r, rows) + k->twist * bending_neighbours(c, cols),
            -k->twist,
            -k->twist,
            -across,
            -along };
    return pulls[orientation];
}

static size_t runs(const void *own, size_t b, weft_spring_run *to)
{
    const weft__mesh *mesh = ((const weft__bending *)own)->mesh;
    size_t count = 0;
    for (size_t orientation = 0; orientation < WEFT_GROUPS; ++orientation) {
        weft__group of;
        if (weft__group_init(mesh, orientation, &of)) {
            count += weft__group_run(mesh, &of, b, to + count);
        }
    }
    return count;
}

static double *bending_spring_couplings(const void *own, const weft__state *at,
                                        size_t b, double *planes, size_t all,
                                        double *bad)
{
    (void)at, (void)bad;
    for (size_t orientation = 0; orientation < WEFT_GROUPS; ++orientation) {
        weft__group of;
        if (!weft__group_init(((const weft__bending *)own)->mesh, orientation, &of)
            || b >= of.end_row) {
            continue;
        }
        for (size_t c = of.first_col; c < of.end_col; ++c, ++planes) {
            for (size_t k = 0; k < 6; ++k) {
                planes[k * all] = 0.0;
            }
            planes[4 * all] = bending_pull_of(own, orientation, b, c);
        }
    }
    return planes;
}

size_t weft__bending_scalar_couplings(const weft__bending *own, size_t first,
                                      weft_scalar_coupling *to)
{
    size_t count = 0;
    for (size_t orientation = 0; own->present && orientation < WEFT_GROUPS;
         ++orientation) {
        weft__group of;
        const bool has = weft__group_init(own->mesh, orientation, &of);
        for (size_t r = 0; has && r < of.end_row; ++r) {
            for (size_t c = of.first_col; c < of.end_col; ++c, ++count) {
                const size_t p = first + r * own->mesh->cols + c;
                const double k = bending_pull_of(own, orientation, r, c);
                if (to != NULL) {
                    to[count]
                        = (weft_scalar_coupling){ (uint32_t)p,
                                                  (uint32_t)(p + (size_t)of.stride), k,
                                                  k * own->damping };
                }
            }
        }
    }
    return count;
}

const weft__force weft__bending_force
    = { .name = "bending",
        .tables.check = bending_check,
        .tables.init = bending_init,
        .tables.hash = bending_hash_of,
        .tables.choose = bending_choose,
        .grids = { .have_it = true, .measured = true },
        .present = bending_present,
        .law.add = bending_add,
        .law.linear = true,
        .measures.energy = bending_energy,
        .measures.power = bending_power,
        .bounds.ratios = bending_ratios,
        .bounds.particle = bending_bound,
        .couplings.runs = runs,
        .couplings.springs = bending_spring_couplings };
