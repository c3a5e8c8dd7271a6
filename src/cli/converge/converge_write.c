/* SPDX-License-Identifier: BSD-3-Clause */
/* converge_write.c -- orders of convergence, and the table of weft converge. */
#include <math.h>

#include "cli/converge/converge.h"

#define VANISHING 1e-12 /* differences below so much of the values are rounding */

/* (a^p - 1) / (1 - b^-p), which grows with p. */
static double ratio_of(double p, double a, double b)
{
    return p == 0.0 ? log(a) / log(b) : expm1(p * log(a)) / -expm1(-p * log(b));
}

/* The p for which value + c spacing^p passes through three values; NAN: there is none.
 */
static double order_of(const double h[3], const double v[3])
{
    const double near = v[1] - v[2], far = v[0] - v[1];
    const double least = VANISHING * fmax(fabs(v[0]), fabs(v[2]));
    double low = -16.0, high = 16.0;
    if (!(fabs(near) > least && fabs(far) > least && far / near > 0.0)) {
        return (double)NAN;
    }
    while (high - low > 1e-9) {
        const double p = 0.5 * (low + high);
        const bool below = ratio_of(p, h[0] / h[1], h[1] / h[2]) < far / near;
        low = below ? p : low;
        high = below ? high : p;
    }
    return 0.5 * (low + high);
}

/* Richardson's limit of a value that converges with order p; NAN: it does not. */
static double extrapolate(double p, const double h[3], const double v[3])
{
    return p > 0.0 ? v[2] + (v[2] - v[1]) / expm1(p * log(h[1] / h[2])) : (double)NAN;
}

/* ---- the table -------------------------------------------------------------- */

typedef struct converge_row {
    size_t rows, cols;
    double spacing, value, difference, order, limit; /* NAN: none */
} converge_row;

static double value_of(const converge_result *result, size_t of)
{
    return result->done ? result->values[of] : (double)NAN;
}

static converge_row row_at(const converge *self, size_t of, size_t i)
{
    const refinement *grid = &self->grids[i];
    double h[3] = { 0 }, v[3] = { 0 };
    for (size_t k = i < 2 ? 2 - i : 0; k < 3; ++k) {
        h[k] = refine_spacing(&self->grids[i + k - 2], grid->along);
        v[k] = value_of(&self->results[i + k - 2], of);
    }
    const double order = i < 2 ? (double)NAN : order_of(h, v);
    return (converge_row){ .rows = grid->axis[0].refined,
                           .cols = grid->axis[1].refined,
                           .spacing = h[2],
                           .value = v[2],
                           .difference = i < 1 ? (double)NAN : v[2] - v[1],
                           .order = order,
                           .limit = extrapolate(order, h, v) };
}

static void print_number(int width, const char *format, double value)
{
    char text[40] = "-";
    if (!isnan(value)) {
        (void)snprintf(text, sizeof text, format, value);
    }
    printf(" %*s", width, text);
}

void converge_print(const converge *self)
{
    for (size_t of = 0; of < self->quantity_count; ++of) {
        printf("%s%s\n%13s %10s %16s %11s %6s %16s\n", of == 0 ? "" : "\n",
               self->quantities[of].name, "particles", "spacing", "value", "difference",
               "order", "extrapolated");
        for (size_t i = 0; i < self->count; ++i) {
            const converge_row one = row_at(self, of, i);
            char particles[48];
            (void)snprintf(particles, sizeof particles, "%zu x %zu", one.rows,
                           one.cols);
            printf("%13s", particles);
            print_number(10, "%.5g", one.spacing);
            print_number(16, "%.10g", one.value);
            print_number(11, "%.3e", one.difference);
            print_number(6, "%.2f", one.order);
            print_number(16, "%.10g", one.limit);
            putchar('\n');
        }
    }
}

void converge_csv(const converge *self)
{
    puts("quantity,size,rows,cols,spacing,value,difference,order,extrapolated");
    for (size_t of = 0; of < self->quantity_count; ++of) {
        for (size_t i = 0; i < self->count; ++i) {
            const converge_row one = row_at(self, of, i);
            const double cells[]
                = { one.spacing, one.value, one.difference, one.order, one.limit };
            record_csv_quoted(stdout, self->quantities[of].name);
            printf(",%zu,%zu,%zu", self->size[i], one.rows, one.cols);
            for (size_t k = 0; k < sizeof cells / sizeof cells[0]; ++k) {
                printf(isnan(cells[k]) ? "," : ",%.17g", cells[k]);
            }
            putchar('\n');
        }
    }
}
