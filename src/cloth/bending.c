/* SPDX-License-Identifier: BSD-3-Clause */
/* bending.c -- the plain loops of bending.h, the numbers of a definition, energy and
 * powers. src/kernel/kernel_bending.c has the same bits. */
#include "cloth/bending.h"

#include "cloth/levels.h"

/* ---- the definition -------------------------------------------------------------- */

double weft__twist_of(const weft_bending_def *of)
{
    return of->twist < 0.0 ? sqrt(of->rigidity[0] * of->rigidity[1]) : of->twist;
}

weft__rigidity weft__rigidity_of(const weft_cloth_def *def)
{
    const weft_bending_def *of = &def->bending;
    const double a = weft__width(def->rows, def->spacing[0]);
    const double b = weft__width(def->cols, def->spacing[1]);
    const bool sheet = def->rows > 1 && def->cols > 1;
    const double twist = weft__twist_of(of);
    weft__rigidity k = { .along = of->rigidity[0] * b / (a * a * a),
                         .across = of->rigidity[1] * a / (b * b * b),
                         .twist = sheet ? 2.0 * twist / (a * b) : 0.0,
                         .damping = of->damping };
    k.along = def->rows > 2 ? k.along : 0.0;
    k.across = def->cols > 2 ? k.across : 0.0;
    k.present = of->rigidity[0] > 0.0 || of->rigidity[1] > 0.0 || twist > 0.0;
    return k;
}

bool weft__rigidity_usable(const weft__rigidity *of)
{
    const double most = 16.0 * (of->along + of->across + of->twist);
    return isfinite(most) && isfinite(most * of->damping);
}

/* ---- the force ------------------------------------------------------------------- */

/* A plane of x and one of v; v NULL: x alone. */
typedef struct field {
    const weft_cloth *cloth;
    const double *x, *v;
} field;

static double value(const field *of, size_t r, size_t c)
{
    const size_t i = r * of->cloth->cols + c;
    return of->v != NULL ? of->x[i] + of->cloth->rigidity.damping * of->v[i] : of->x[i];
}

static double second(double low, double here, double high)
{
    return (high - here) - (here - low);
}

static double along_column(const field *of, size_t r, size_t c)
{
    return second(value(of, weft__before(r), c), value(of, r, c),
                  value(of, weft__after(r, of->cloth->rows), c));
}

static double along_row(const field *of, size_t r, size_t c)
{
    return second(value(of, r, weft__before(c)), value(of, r, c),
                  value(of, r, weft__after(c, of->cloth->cols)));
}

/* k_r D_r + k_t D_c */
static double column_moment(const field *of, size_t r, size_t c)
{
    const weft_cloth *cloth = of->cloth;
    const double part = weft__inner(r, cloth->rows) ? cloth->rigidity.along : 0.0;
    return part * weft__strip(c, cloth->cols) * along_column(of, r, c)
           + cloth->rigidity.twist * along_row(of, r, c);
}

/* k_c D_c */
static double row_moment(const field *of, size_t r, size_t c)
{
    const weft_cloth *cloth = of->cloth;
    const double part = cloth->rigidity.across * weft__strip(r, cloth->rows);
    return weft__inner(c, cloth->cols) ? part * along_row(of, r, c) : 0.0;
}

/* K (x + damping v) */
static double resistance(const field *of, size_t i)
{
    const size_t rows = of->cloth->rows, cols = of->cloth->cols;
    const size_t r = i / cols, c = i % cols;
    const double moment = column_moment(of, r, c);
    const double across
        = second(row_moment(of, r, weft__before(c)), row_moment(of, r, c),
                 row_moment(of, r, weft__after(c, cols)));
    return (column_moment(of, weft__after(r, rows), c) - moment)
           + (across - (moment - column_moment(of, weft__before(r), c)));
}

/* [N] of plane k of a state. */
static double resistance_of(const weft__subject *of, size_t i, size_t k)
{
    const weft_cloth *cloth = of->cloth;
    const double *x = of->y + k * cloth->particles;
    const bool damped = cloth->rigidity.damping != 0.0;
    const field plane = { cloth, x, damped ? x + 3 * cloth->particles : NULL };
    return resistance(&plane, i);
}

static void bending_add(const weft__subject *of, size_t i, weft__unit unit, double *to)
{
    const weft_cloth *cloth = of->cloth;
    const double share = unit == WEFT__FORCE ? 1.0 : cloth->inverse_mass[i];
    for (size_t k = 0; cloth->rigidity.present && k < 3; ++k) {
        to[k * cloth->particles] -= share * resistance_of(of, i, k);
    }
}

/* The force is linear: its change is the force of the direction. */
static int bending_change(const weft__subject *of, double *out, size_t first,
                          size_t end)
{
    const size_t n = of->cloth->particles, cols = of->cloth->cols;
    const weft__subject along = { .cloth = of->cloth, .y = of->along };
    const weft__level *level = of->cloth->level;
    double bad = 0.0;
    if (level->added[WEFT__ADDED_bending] != NULL) {
        return level->added[WEFT__ADDED_bending](&along, out, first, end);
    }
    for (size_t i = first * cols; of->cloth->rigidity.present && i < end * cols; ++i) {
        double *to = out + 3 * n + i;
        bending_add(&along, i, WEFT__ACCELERATION, to);
        bad += ((to[0] + to[n]) + to[2 * n]) * 0.0;
    }
    return bad == 0.0 ? 0 : 1;
}

void weft__bending_multiply(const weft_cloth *cloth, double scale, const double *x,
                            double *out)
{
    const size_t n = cloth->particles;
    for (size_t j = 0; cloth->rigidity.present && j < 3 * n; ++j) {
        const field plane = { cloth, x + j / n * n, NULL };
        out[j] += scale * resistance(&plane, j % n);
    }
}

/* ---- energy and powers ----------------------------------------------------------- */

/* [x K x] of what is centred in row r and of the cells that begin there, for planes
 * x[3 N]. */
static double row_square(const weft_cloth *cloth, const double *x, size_t r)
{
    const size_t n = cloth->particles, rows = cloth->rows, cols = cloth->cols;
    const weft__rigidity *k = &cloth->rigidity;
    const double across = k->across * weft__strip(r, rows);
    const size_t down = r + 1 < rows ? cols : 0;
    double sum = 0.0;
    for (size_t plane = 0; plane < 3; ++plane) {
        const field of = { cloth, x + plane * n, NULL };
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

void weft__row_bending_energy(const weft__subject *of, size_t r, weft_measures *row)
{
    if (of->cloth->rigidity.present) {
        row->energy.elastic[WEFT_BEND] += 0.5 * row_square(of->cloth, of->y, r);
    }
}

/* Of the pins that move in row r. */
static double pin_power(const weft__subject *of, size_t r)
{
    const weft_cloth *cloth = of->cloth;
    double power = 0.0, rate[6];
    for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
        if (cloth->pin[i] != 0 && cloth->motions[cloth->pin[i] - 1].moves) {
            weft__pin_rate(cloth, i, of->t, rate);
            for (size_t k = 0; k < 3; ++k) {
                power += resistance_of(of, i, k) * rate[k];
            }
        }
    }
    return power;
}

static void bending_power(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    const double damping = cloth->rigidity.damping, *v = of->y + 3 * cloth->particles;
    if (cloth->rigidity.present) {
        row->power[WEFT_POWER_PINS] += pin_power(of, r);
    }
    if (cloth->rigidity.present && damping != 0.0) {
        row->power[WEFT_POWER_SPRINGS] += damping * row_square(cloth, v, r);
    }
}

static double bending_damping(const weft_cloth *cloth, size_t i)
{
    (void)cloth, (void)i;
    return 0.0;
}

const weft__added weft__bending
    = { bending_add, bending_power, bending_change, bending_damping };

/* ---- the matrix ------------------------------------------------------------------ */

/* Neighbours along a line of `count`. */
static double neighbours(size_t at, size_t count)
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

double weft__bending_row_sum(const weft_cloth *cloth, size_t i)
{
    const size_t rows = cloth->rows, cols = cloth->cols, r = i / cols, c = i % cols;
    const weft__rigidity *k = &cloth->rigidity;
    return k->along * weft__strip(c, cols) * line_sum(r, rows)
           + k->across * weft__strip(r, rows) * line_sum(c, cols)
           + 4.0 * k->twist * neighbours(r, rows) * neighbours(c, cols);
}

bool weft__bending_pairs(const weft_cloth *cloth, size_t way, weft__group *pairs)
{
    return cloth->rigidity.present && weft__group_init(cloth, way, pairs);
}

/* 2 for each of `at` and the next one where three particles are centred. */
static double centred(size_t at, size_t count)
{
    return (weft__inner(at, count) ? 2.0 : 0.0)
           + (weft__inner(at + 1, count) ? 2.0 : 0.0);
}

double weft__bending_pull(const weft_cloth *cloth, size_t way, size_t r, size_t c)
{
    const size_t rows = cloth->rows, cols = cloth->cols;
    const weft__rigidity *k = &cloth->rigidity;
    const double along = k->along * weft__strip(c, cols);
    const double across = k->across * weft__strip(r, rows);
    const double pulls[WEFT_GROUPS]
        = { across * centred(c, cols) + k->twist * neighbours(r, rows),
            along * centred(r, rows) + k->twist * neighbours(c, cols),
            -k->twist,
            -k->twist,
            -across,
            -along };
    return pulls[way];
}
