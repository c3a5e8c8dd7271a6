/* SPDX-License-Identifier: BSD-3-Clause */
/* fit.c -- weft fit: runs with sensitivities at the times of the data, and MINPACK. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/fit/fit.h"

/* Those of this verb alone. */
typedef struct fit_options {
    const char *over;
    const char *sigma;
} fit_options;

static const fit_options *fit_own(const arguments *given)
{
    return given->own;
}

#ifdef WEFT_CMINPACK
#include <cminpack.h>
#define solve lmder
#else
/* Never called: the verb refuses before. */
static int lacking(int none, ...)
{
    return none - 1;
}
#define solve(...) lacking(0, __VA_ARGS__)
#endif

#define FARTHEST 1.5   /* of the first step, in logarithms */
#define ASTRAY   3.0   /* a part of the time changes no known parameter by more */
#define NEAR     1e-3  /* relative change of chi2 or the logarithms that ends a part */
#define NEAREST  1e-6  /* and the last */
#define WORST    1e100 /* residuals of parameters with which there is no run */

enum { MOST_RUNS = 60 /* of a part */ };

/* ---- a run ----------------------------------------------------------------------- */

/* The scene with the parameters as they are; `differentiated`: and its sensitivities.
 */
static int open_parameters(fit *self, bool differentiated, weft_scene **scene)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(self->scene);
    arguments given = *self->given;
    size_t count = 1 + given.sets.count;
    for (size_t j = 0; j < self->parameters; ++j) { /* before every value */
        if (of->before[j] != NULL) {
            self->sets[count++] = of->before[j];
        }
    }
    for (size_t j = 0; j < self->parameters; ++j) {
        (void)snprintf(self->values[j], sizeof self->values[j], "%s=%.*g", of->keys[j],
                       weft_text_digits(fit_value(self, j)), fit_value(self, j));
        self->sets[count++] = self->values[j];
    }
    given.sets.at = self->sets + !differentiated;
    given.sets.count = count - !differentiated;
    given.silent = true;
    return open_scene(given.operands[0], &given, scene, NULL);
}

/* What the cloth has where a point was seen, of positions; or, of the outline, of
 * those if j is 0, and then of their Jacobian. */
static void look(const fit *self, fit_point *point, size_t j, double x[3])
{
    shadow_point *at = &point->edge;
    if (self->shadow.ends == NULL) {
        memcpy(x, self->room + 3 * point->particle, 3 * sizeof *x);
    } else if (j == 0) {
        x[0] = shadow_at(&self->shadow, self->room, point->direction, at) ? at->radius
                                                                          : NAN;
    } else {
        x[0] = at->of != NULL ? 0.0 : NAN;
        for (size_t k = 0; at->of != NULL && k < 6; ++k) {
            x[0]
                += at->derivative[k / 3][k % 3] * self->room[3 * at->of[k / 3] + k % 3];
        }
    }
}

/* What points [from, to), whose time it is, have to the part j of the results: 0 the
 * residuals, then the Jacobian. Returns the row behind them. */
static size_t compare_points(fit *self, size_t from, size_t to, size_t j, size_t row)
{
    double *results = j == 0 ? self->residuals : self->jacobian + (j - 1) * self->rows;
    for (size_t i = from; i < to; ++i) {
        fit_point *point = &self->points[i];
        double x[3] = { 0.0 };
        look(self, point, j, x);
        for (size_t k = 0; k < 3; ++k) {
            if (j == 0) {
                point->fitted[k] = x[k];
            }
            if (isfinite(point->x[k])) {
                results[row++] = (j == 0 ? x[k] - point->x[k] : x[k]) / self->sigma;
            }
        }
    }
    return row;
}

static weft_status follow(fit *self, const weft_scene *scene, weft_sim *sim,
                          weft_error *err)
{
    size_t row = 0, end = 0, next = 0;
    for (size_t first = 0; first < self->now; first = end, row = next) {
        const double t = self->points[first].time;
        while (end < self->now && self->points[end].time == t) {
            ++end;
        }
        TRY(weft_sim_advance(sim, t, err));
        weft_sim_positions(sim, self->room);
        next = compare_points(self, first, end, 0, row);
        for (size_t j = 0; j < self->parameters; ++j) {
            record_sensitivity(scene, sim, j, false, self->room);
            (void)compare_points(self, first, end, j + 1, row);
        }
    }
    return WEFT_OK;
}

static weft_status simulate(fit *self, const weft_scene *scene, weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_scene_perturbed *perturbed = NULL;
    weft_status status = perturbed_create(self->given, scene, &perturbed, err);
    if (status == WEFT_OK) {
        status = simulation_create(scene, weft_scene_perturbed_def(perturbed), &cloth,
                                   &sim, err);
    }
    if (status == WEFT_OK) {
        status = follow(self, scene, sim, err);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_perturbed_destroy(perturbed);
    for (size_t i = 0; status == WEFT_OK && i < self->rows * self->parameters; ++i) {
        const fit_point *point = &self->points[i % self->rows];
        if (self->shadow.ends != NULL && point->edge.of == NULL) {
            status = weft_error_set(err, WEFT_SOLVER,
                                    "the shadow is not around the origin: there is "
                                    "none at %g degrees",
                                    point->angle);
        } else if (!isfinite(self->jacobian[i])) {
            status = weft_error_set(err, WEFT_SOLVER, "the sensitivities overflow");
        }
    }
    return status;
}

static void run(fit *self)
{
    weft_scene *scene = NULL;
    self->err = (weft_error){ 0 };
    if (open_parameters(self, true, &scene) != EXIT_DONE) {
        (void)weft_error_set(&self->err, WEFT_BAD_SCENE, "a number out of range");
    }
    self->known = scene != NULL && simulate(self, scene, &self->err) == WEFT_OK;
    weft_scene_destroy(scene);
    ++self->runs;
    if (self->given->mode != PROGRESS_NONE) {
        fprintf(stderr, "run %zu, data to %.4g s: ", self->runs,
                self->points[self->now - 1].time);
        if (self->known) {
            fprintf(stderr, "chi2 / coordinates %.6g\n",
                    fit_chi2(self) / (double)self->rows);
        } else {
            print_line(stderr, "none: %s", self->err.message);
        }
    }
}

/* ---- Levenberg and Marquardt ----------------------------------------------------- */

/* What lmder goes through: a part of the data, logarithms less those of its start. */
typedef struct fit_part {
    fit *of;
    double base[WEFT_SENSITIVITIES];
    size_t begun; /* at this run */
} fit_part;

/* cminpack_funcder_mn: `what` is 1 for the residuals, 2 for the Jacobian. */
static int evaluate(void *ctx, int rows, int parameters, const double *at,
                    double *residuals, double *jacobian, int stride, int what)
{
    fit_part *self = ctx;
    fit *of = self->of;
    const size_t n = (size_t)parameters, m = (size_t)rows;
    bool other = of->stale;
    for (size_t j = 0; j < n; ++j) {
        const double log = self->base[j] + at[j];
        other = other || log != of->at[j];
        of->at[j] = log;
    }
    if (other) {
        of->stale = false;
        run(of);
    }
    for (size_t i = 0; what == 1 && i < m; ++i) {
        residuals[i] = of->known ? of->residuals[i] : WORST;
    }
    for (size_t j = 0; what == 2 && j < n; ++j) {
        memcpy(jacobian + j * (size_t)stride, of->jacobian + j * m,
               m * sizeof *jacobian);
    }
    return of->known || of->runs > self->begun + 1 ? 0 : -1;
}

/* Over the first of->now points. */
static weft_status minimise(fit *of, double tolerance, weft_error *err)
{
    const size_t n = of->parameters, m = of->rows;
    fit_part self = { .of = of, .begun = of->runs };
    double at[WEFT_SENSITIVITIES] = { 0.0 }, diag[WEFT_SENSITIVITIES];
    double work[3][WEFT_SENSITIVITIES],
        *room = malloc((m * (n + 2) + n) * sizeof *room);
    int pivots[WEFT_SENSITIVITIES], calls, jacobians;
    if (room == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the jacobian");
    }
    memcpy(self.base, of->at, sizeof of->at);
    for (size_t j = 0; j < n; ++j) {
        diag[j] = 1.0;
    }
    of->stale = true;
    const int info = solve(evaluate, &self, (int)m, (int)n, at, room, room + m, (int)m,
                           tolerance, tolerance, 0.0, MOST_RUNS, diag, 2, FARTHEST, 0,
                           &calls, &jacobians, pivots, room + m * (n + 1), work[0],
                           work[1], work[2], room + m * (n + 1) + n);
    of->converged = info >= 1 && info <= 4;
    if (info >= 0) { /* the last run may be one that was worse */
        (void)evaluate(&self, (int)m, (int)n, at, room, NULL, 0, 1);
    }
    free(room);
    return of->known ? WEFT_OK
                     : weft_error_set(err, of->err.status, "%s", of->err.message);
}

static weft_status minimise_parts(fit *self, weft_error *err)
{
    const double all = self->points[self->point_count - 1].time;
    for (size_t share = 8; share > 0; share /= 2) {
        self->rows = 0;
        for (self->now = 0; self->now < self->point_count
                            && self->points[self->now].time <= all / (double)share;
             ++self->now) {
            for (size_t k = 0; k < 3; ++k) {
                self->rows += isfinite(self->points[self->now].x[k]) ? 1 : 0;
            }
        }
        double before[WEFT_SENSITIVITIES];
        memcpy(before, self->at, sizeof before);
        if (self->rows >= self->parameters) {
            TRY(minimise(self, share > 1 ? NEAR : NEAREST, err));
        }
        for (size_t j = 0; share > 1 && j < self->parameters; ++j) {
            self->at[j]
                = fabs(self->at[j] - before[j]) < ASTRAY ? self->at[j] : before[j];
        }
    }
    return WEFT_OK;
}

/* ---- what the data say of the parameters ----------------------------------------- */

/* Turns columns p and q of the Jacobian, and of the directions, to orthogonal ones;
 * returns the cosine between them before. */
static double turn(fit *self, size_t p, size_t q)
{
    double *a = self->jacobian + p * self->rows, *b = self->jacobian + q * self->rows;
    double aa = 0.0, bb = 0.0, ab = 0.0;
    for (size_t i = 0; i < self->rows; ++i) {
        aa += a[i] * a[i], bb += b[i] * b[i], ab += a[i] * b[i];
    }
    if (!(ab * ab > 0.0)) {
        return 0.0;
    }
    const double z = (bb - aa) / (2.0 * ab);
    const double t = (z < 0.0 ? -1.0 : 1.0) / (fabs(z) + sqrt(1.0 + z * z));
    const double c = 1.0 / sqrt(1.0 + t * t), s = c * t;
    for (size_t i = 0; i < self->rows + self->parameters; ++i) {
        double *x = i < self->rows ? &a[i] : &self->direction[p][i - self->rows];
        double *y = i < self->rows ? &b[i] : &self->direction[q][i - self->rows];
        const double u = c * *x - s * *y;
        *y = s * *x + c * *y;
        *x = u;
    }
    return fabs(ab) / sqrt(aa * bb);
}

/* Singular values by Hestenes' method, which loses no digits of small ones: the
 * jacobian become their left vectors times them. */
static void decompose(fit *self)
{
    const size_t n = self->parameters;
    double most = 1.0;
    for (size_t i = 0; i < n * n; ++i) {
        self->direction[i / n][i % n] = i / n == i % n ? 1.0 : 0.0;
    }
    for (size_t sweep = 0; sweep < 40 && most > 1e-14; ++sweep) {
        most = 0.0;
        for (size_t i = 0; i < n * n; ++i) {
            most = i / n < i % n ? fmax(most, turn(self, i / n, i % n)) : most;
        }
    }
    for (size_t k = 0; k < n; ++k) {
        double sum = 0.0;
        for (size_t i = 0; i < self->rows; ++i) {
            sum += self->jacobian[k * self->rows + i]
                   * self->jacobian[k * self->rows + i];
        }
        self->singular[k] = sqrt(sum);
    }
    for (size_t i = 0; i < n * n; ++i) {
        double sum = 0.0;
        for (size_t k = 0; k < n; ++k) {
            sum += self->direction[k][i / n] * self->direction[k][i % n]
                   / (self->singular[k] * self->singular[k]);
        }
        self->covariance[i / n][i % n] = sum;
    }
}

/* ---- the verb -------------------------------------------------------------------- */

/* "sensitivity={of: [KEY, ...], scale: log}" of --over, and room for the other sets. */
static int differentiate(fit *self)
{
    const arguments *given = self->given;
    if (fit_own(given)->over == NULL) {
        return usage_error(given, "--over KEY,KEY says which numbers are fitted");
    }
    sentence list = { "sensitivity={scale: log, of: [" };
    for (const char *at = fit_own(given)->over;
         *at != '\0';) { /* [] of an index need quotes */
        const size_t length = strcspn(at, ",");
        say(&list, "\"%.*s\", ", (int)length, at);
        at += length + (at[length] == ',');
    }
    say(&list, "]}");
    if (strlen(list.text) + 1 == sizeof list.text) {
        return usage_error(given, "--over is too long");
    }
    strcpy(self->differentiate, list.text);
    self->sets
        = calloc(1 + given->sets.count + 2 * WEFT_SENSITIVITIES, sizeof *self->sets);
    if (self->sets == NULL) {
        return report_status(WEFT_NO_MEMORY, "out of memory");
    }
    self->sets[0] = self->differentiate;
    for (size_t i = 0; i < given->sets.count; ++i) {
        self->sets[1 + i] = given->sets.at[i];
    }
    arguments all = *given;
    all.sets.at = self->sets;
    all.sets.count = 1 + given->sets.count;
    return open_scene(given->operands[0], &all, &self->scene, NULL);
}

static int read_sigma(fit *self)
{
    const char *text
        = fit_own(self->given)->sigma == NULL ? "1e-3" : fit_own(self->given)->sigma;
    self->sigma = option_real(text);
    return self->sigma > 0.0 && isfinite(self->sigma)
               ? EXIT_DONE
               : usage_error(self->given, "--sigma %s: not a length above 0 [m]", text);
}

static weft_status make_room(fit *self, weft_error *err)
{
    const size_t rows = self->coordinates, n = self->parameters;
    self->room = malloc((3 * self->particles + rows * (n + 1)) * sizeof *self->room);
    self->residuals = self->room + 3 * self->particles;
    self->jacobian = self->residuals + rows;
    return self->room != NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory for the jacobian");
}

static weft_status results(fit *self, const char *directory, weft_error *err)
{
    weft_scene *fitted = NULL;
    decompose(self);
    if (open_parameters(self, false, &fitted) != EXIT_DONE) {
        return weft_error_set(err, WEFT_SOLVER, "the fitted scene is refused");
    }
    const weft_status status = record_scene_text(directory, "fitted.yaml", fitted, err);
    weft_scene_destroy(fitted);
    return status == WEFT_OK ? fit_write(self, directory, err) : status;
}

static weft_status fit_numbers(fit *self, weft_error *err)
{
    char name[RECORD_PATH];
    const char *directory = out_directory(self->given, "-fit", name);
    self->parameters = weft_scene_sensitivities(self->scene)->count;
    TRY(scene_supported(self->scene, err));
    TRY(fit_read(self, self->given->operands[1], err));
    TRY(make_room(self, err));
    TRY(record_directory(directory, err));
    if (!self->given->force && record_exists(directory, "fit.yaml")) {
        return weft_error_set(err, WEFT_IO,
                              "%s has a fit.yaml; --force replaces it, --out DIR "
                              "chooses another directory",
                              directory);
    }
    TRY(minimise_parts(self, err));
    return results(self, directory, err);
}

static int fit_verb(const arguments *given)
{
#ifndef WEFT_CMINPACK
    return report_status(WEFT_UNSUPPORTED, "this weft was built without MINPACK "
                                           "(libcminpack-dev), which weft fit needs");
#endif
    fit *self = calloc(1, sizeof *self);
    weft_error err = { 0 };
    if (self == NULL) {
        return report_status(WEFT_NO_MEMORY, "out of memory");
    }
    self->given = given;
    int code = read_sigma(self);
    code = code == EXIT_DONE ? differentiate(self) : code;
    if (code == EXIT_DONE && fit_numbers(self, &err) != WEFT_OK) {
        code = report_error(&err);
    } else if (code == EXIT_DONE && !self->converged) {
        code = report_status(WEFT_SOLVER, "no minimum after %zu runs", self->runs);
    }
    weft_scene_destroy(self->scene);
    free(self->points);
    free(self->shadow.ends);
    free(self->room);
    free(self->sets);
    free(self);
    return code;
}

static const verb_option options[] = {
    OWN(fit_options, over, "over", "KEY,KEY",
        "the numbers, 1 to 16 keys as --set writes them"),
    OWN(fit_options, sigma, "sigma", "M",
        "standard deviation of a coordinate of the data [m]; default 1e-3"),
    SHARED(out, "out", "DIR", "write there"),
    SHARED(force, "force", NULL, "replace the results of an earlier fit"),
    OPTION_SET,
    OPTION_PLUGIN_PATH,
    SHARED(quiet, "quiet", NULL, "no progress"),
};

const verb verb_fit = {
    .name = "fit",
    .summary = "find the numbers with which a cloth follows measured tracks",
    .help
    = "usage: weft fit SCENE.yaml DATA.csv --over KEY,KEY [OPTIONS]\n"
      "\n"
      "Finds the values of numbers of a scene with which its particles come nearest to "
      "where they were seen, or its shadow to an outline, by Levenberg and Marquardt's "
      "method (MINPACK) with the scene's `sensitivity` by the logarithms of the "
      "numbers: first over an eighth of the data's time, then over a quarter, half and "
      "all of it. The scene's values are the start; a factor of 3 off is near enough "
      "for most.\n"
      "\n"
      "DATA.csv has a point a line, time,row,col,x,y,z or of a mesh time,vertex,x,y,z "
      "or of several cloths time,cloth,vertex,x,y,z [s, m], in any order and at any "
      "times; what is empty is missing. With the header angle,radius [degrees, m] or "
      "x,y [m] it is the outline of the cloth at the end of the run, seen from above "
      "along gravity, about the scene's origin; angles turn left from the x axis.\n"
      "\n"
      "Writes fit.yaml (values, standard errors, their correlation, chi2, and which "
      "directions the data do not tell), fitted.yaml (the scene with the values) and "
      "fit.svg to SCENE-fit.\n",
    OPTIONS(options),
    .own_size = sizeof(fit_options),
    .more = "examples:\n"
            "  weft fit cloth.yaml tracks.csv --over cloth.density,forces.damping\n"
            "\n"
            "exit codes: 0 done, 1 a run failed or there is no minimum, 2 wrong "
            "command line, 3 wrong scene, 4 a file could not be read or written\n",
    .operands
    = { 2, 2, "a scene and its data are needed", "more than a scene and data" },
    .run = fit_verb,
};
