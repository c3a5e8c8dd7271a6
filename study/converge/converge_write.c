/* SPDX-License-Identifier: BSD-3-Clause */
/* converge_write.c -- orders of convergence, and the table of weft converge. */
#include <math.h>

#include "study/converge/converge.h"

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

enum { CELLS = 5 };

static const struct {
    const char *name, *format;
    int width;
} columns[CELLS] = { { "spacing", "%.5g", 10 },
                     { "value", "%.10g", 16 },
                     { "difference", "%.3e", 11 },
                     { "order", "%.2f", 6 },
                     { "extrapolated", "%.10g", 16 } };

/* NAN: no value. */
static void fill_row(const converge *self, size_t of, size_t i, double cells[CELLS])
{
    double h[3] = { 0 }, v[3] = { 0 };
    for (size_t k = i < 2 ? 2 - i : 0; k < 3; ++k) {
        h[k] = self->sizes[i + k - 2].spacing;
        v[k] = self->results[i + k - 2].values[of];
    }
    cells[0] = h[2];
    cells[1] = v[2];
    cells[2] = i < 1 ? (double)NAN : v[2] - v[1];
    cells[3] = i < 2 ? (double)NAN : order_of(h, v);
    cells[4] = extrapolate(cells[3], h, v);
}

static void print_header(const char *first, bool csv)
{
    printf("%s", first);
    for (size_t k = 0; k < CELLS; ++k) {
        printf("%s%*s", csv ? "," : " ", csv ? 0 : columns[k].width, columns[k].name);
    }
    putchar('\n');
}

static void print_row(const converge *self, size_t of, size_t i, bool csv)
{
    const weft_cloth *cloth = self->sizes[i].cloth;
    const size_t rows = weft_cloth_rows(cloth), cols = weft_cloth_cols(cloth);
    const size_t particles = weft_cloth_particles(cloth);
    double cells[CELLS];
    char text[48];
    fill_row(self, of, i, cells);
    if (self->mesh) {
        (void)snprintf(text, sizeof text, "%zu", particles);
    } else {
        (void)snprintf(text, sizeof text, csv ? "%zu,%zu" : "%zu x %zu", rows, cols);
    }
    if (csv) {
        record_csv_quoted(stdout, self->quantities[of].name);
        printf(",%zu,%s", self->sizes[i].size, text);
    } else {
        printf("%13s", text);
    }
    for (size_t k = 0; k < CELLS; ++k) {
        (void)snprintf(text, sizeof text, csv ? "%.17g" : columns[k].format, cells[k]);
        printf("%s%*s", csv ? "," : " ", csv ? 0 : columns[k].width,
               !isnan(cells[k]) ? text
               : csv            ? ""
                                : "-");
    }
    putchar('\n');
}

void converge_print(const converge *self, bool csv)
{
    if (csv) {
        print_header(self->mesh ? "quantity,size,vertices" : "quantity,size,rows,cols",
                     csv);
    }
    for (size_t of = 0; of < self->quantity_count; ++of) {
        if (!csv) {
            printf("%s%s\n", of == 0 ? "" : "\n", self->quantities[of].name);
            print_header("    particles", csv);
        }
        for (size_t i = 0; i < self->count; ++i) {
            print_row(self, of, i, csv);
        }
    }
}
