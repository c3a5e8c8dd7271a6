/* SPDX-License-Identifier: BSD-3-Clause */
/* fit_write.c -- fit.yaml, fit.svg and what weft fit prints. */
#include <math.h>

#include "program/record/yaml_out.h"
#include "study/fit/fit.h"

/* Standard deviations by which a change of e must move the data to be told. */
#define UNSEEN 10.0

static double error_of(const fit *self, size_t j)
{
    return fabs(fit_value(self, j)) * sqrt(self->covariance[j][j]);
}

static void write_numbers(const fit *self, yaml_out *to)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(self->scene);
    for (size_t j = 0; j < self->parameters; ++j) {
        yaml_out_write(to, "%s: { value: %g, standard_error: %g, start: %g }",
                       of->keys[j], fit_value(self, j), error_of(self, j),
                       of->values[j]);
    }
    yaml_out_write(to, "correlation: [");
    for (size_t i = 0; i < self->parameters; ++i) {
        yaml_out_write(to, "[");
        for (size_t j = 0; j < self->parameters; ++j) {
            yaml_out_write(to, "%g",
                           self->covariance[i][j]
                               / sqrt(self->covariance[i][i] * self->covariance[j][j]));
        }
        yaml_out_write(to, "]");
    }
    yaml_out_write(to, "]");
}

static void write_unresolved(const fit *self, yaml_out *to)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(self->scene);
    yaml_out_write(to, "unresolved: [");
    for (size_t k = 0; k < self->parameters; ++k) {
        if (self->singular[k] < UNSEEN) {
            yaml_out_write(to, "{ singular_value: %g, direction: {", self->singular[k]);
            for (size_t j = 0; j < self->parameters; ++j) {
                yaml_out_write(to, "%s: %g", of->keys[j], self->direction[k][j]);
            }
            yaml_out_write(to, "} }");
        }
    }
    yaml_out_write(to, "]");
}

static weft_status write_yaml(const fit *self, const char *directory, weft_error *err)
{
    record_file file;
    yaml_out to;
    TRY(record_file_open(&file, directory, "fit.yaml", err));
    yaml_out_begin(&to, file.stream);
    write_numbers(self, &to);
    yaml_out_write(&to, "chi2: %g, points: %zu, coordinates: %zu, runs: %zu, sigma: %g",
                   fit_chi2(self), self->point_count, self->coordinates, self->runs,
                   self->sigma);
    yaml_out_write(&to, "converged: %s", yaml_bool(self->converged));
    write_unresolved(self, &to);
    return record_file_end(&file, yaml_out_end(&to), err);
}

/* ---- the picture: each coordinate over time, data as dots, the fit as lines ------ */

enum { WIDE = 720, HIGH = 220, EDGE = 48 };

typedef struct fit_axis {
    double low, high;
} fit_axis;

static void widen(fit_axis *of, double value)
{
    if (isfinite(value)) {
        of->low = fmin(of->low, value);
        of->high = fmax(of->high, value);
    }
}

static double place(const fit_axis *of, double value, double from, double to)
{
    const double range = of->high - of->low;
    return range > 0.0 ? from + (value - of->low) / range * (to - from)
                       : 0.5 * (from + to);
}

/* Lines from a point to the next of its particle. */
static void draw_lines(const fit *self, FILE *to, size_t k, const fit_axis *t,
                       const fit_axis *x)
{
    for (size_t i = 0; i < self->point_count; ++i) {
        const fit_point *from = &self->points[i], *next = from + 1;
        const fit_point *const end = self->points + self->point_count;
        while (next < end && next->particle != from->particle) {
            ++next;
        }
        if (next < end) {
            fprintf(to, "M%.1f %.1fL%.1f %.1f", place(t, from->time, EDGE, WIDE - 8),
                    place(x, from->fitted[k], HIGH - 24, 8),
                    place(t, next->time, EDGE, WIDE - 8),
                    place(x, next->fitted[k], HIGH - 24, 8));
        }
    }
}

static void draw_panel(const fit *self, FILE *to, size_t k)
{
    fit_axis t = { 0.0, 0.0 }, x = { INFINITY, -INFINITY };
    for (size_t i = 0; i < self->point_count; ++i) {
        widen(&t, self->points[i].time);
        widen(&x, self->points[i].x[k]);
        widen(&x, self->points[i].fitted[k]);
    }
    fprintf(to,
            "<g transform=\"translate(0 %zu)\"><path fill=\"none\" stroke=\"#999\" "
            "d=\"M%d 8V%dH%d\"/>\n<text x=\"4\" y=\"16\">%c [m]</text><text x=\"4\" "
            "y=\"32\">%.3g</text><text x=\"4\" y=\"%d\">%.3g</text><text x=\"%d\" "
            "y=\"%d\" text-anchor=\"end\">%.4g s</text>\n<path fill=\"none\" "
            "stroke=\"#b5532a\" d=\"",
            k * HIGH, EDGE, HIGH - 24, WIDE - 8, (int)('x' + k), x.high, HIGH - 26,
            x.low, WIDE - 8, HIGH - 8, t.high);
    draw_lines(self, to, k, &t, &x);
    fputs("\"/>\n<path stroke=\"#1f4e79\" stroke-width=\"3\" stroke-linecap=\"round\" "
          "d=\"",
          to);
    for (size_t i = 0; i < self->point_count; ++i) {
        if (isfinite(self->points[i].x[k])) {
            fprintf(to, "M%.1f %.1fh0", place(&t, self->points[i].time, EDGE, WIDE - 8),
                    place(&x, self->points[i].x[k], HIGH - 24, 8));
        }
    }
    fputs("\"/></g>\n", to);
}

/* Seen from above, the origin a cross. */
static void draw_outline(const fit *self, FILE *to)
{
    double most = 0.0;
    for (size_t i = 0; i < self->point_count; ++i) {
        most = fmax(most, fmax(self->points[i].x[0], self->points[i].fitted[0]));
    }
    const double scale = (0.5 * WIDE - EDGE) / most;
    fprintf(to,
            "<g transform=\"translate(%d %d)\"><path stroke=\"#999\" "
            "d=\"M-9 0H9M0-9V9\"/>\n<text x=\"%d\" y=\"%d\">farthest: %.4g m</text>\n",
            WIDE / 2, WIDE / 2, 8 - WIDE / 2, WIDE / 2 - 8, most);
    for (size_t part = 0; part < 2; ++part) {
        fprintf(to, "<path fill=\"none\" stroke-linecap=\"round\" %s d=\"",
                part == 0 ? "stroke=\"#b5532a\""
                          : "stroke=\"#1f4e79\" stroke-width=\"3\"");
        for (size_t i = 0; i < self->point_count; ++i) {
            const fit_point *at = &self->points[i];
            const double r = scale * (part == 0 ? at->fitted[0] : at->x[0]);
            fprintf(to, "%c%.1f %.1f%s", part == 0 && i > 0 ? 'L' : 'M',
                    r * at->direction[0], -r * at->direction[1], part == 0 ? "" : "h0");
        }
        fputs(part == 0 ? "Z\"/>\n" : "\"/></g>\n", to);
    }
}

static weft_status draw(const fit *self, const char *directory, weft_error *err)
{
    const bool outline = self->shadow.ends != NULL;
    record_file file;
    TRY(record_file_open(&file, directory, "fit.svg", err));
    fprintf(file.stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n<title>%s: data (dots) "
            "and the fitted cloth (lines)</title>\n<rect width=\"100%%\" "
            "height=\"100%%\" fill=\"white\"/>\n",
            WIDE, outline ? WIDE : 3 * HIGH, outline ? "Outline" : "Tracks");
    if (outline) {
        draw_outline(self, file.stream);
    }
    for (size_t k = 0; !outline && k < 3; ++k) {
        draw_panel(self, file.stream, k);
    }
    fputs("</svg>\n", file.stream);
    return record_file_commit(&file, err);
}

/* ---------------------------------------------------------------------------------- */

weft_status fit_write(const fit *self, const char *directory, weft_error *err)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(self->scene);
    size_t unseen = 0;
    TRY(draw(self, directory, err));
    TRY(write_yaml(self, directory, err));
    printf("%-40s %12s %12s %12s\n", "number", "value", "error", "start");
    for (size_t j = 0; j < self->parameters; ++j) {
        printf("%-40s %12.6g %12.2g %12.6g\n", of->keys[j], fit_value(self, j),
               error_of(self, j), of->values[j]);
        unseen += self->singular[j] < UNSEEN;
    }
    print_item("chi2", "%.6g for %zu coordinates less %zu numbers", fit_chi2(self),
               self->coordinates, self->parameters);
    if (unseen > 0) {
        print_item("unresolved",
                   "%zu of %zu directions: the data hardly change along "
                   "them (fit.yaml)",
                   unseen, self->parameters);
    }
    print_item("results", "%s: fit.yaml, fitted.yaml, fit.svg", directory);
    return WEFT_OK;
}
