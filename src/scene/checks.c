/* SPDX-License-Identifier: BSD-3-Clause */
/* checks.c -- what must hold between the keys of cloth, limit and run. A field that is
 * 0 was wrong and has been complained of. */
#include <math.h>
#include <string.h>

#include "scene/read.h"

#define MAX_PARTICLES ((size_t)1 << 31)

void weft__check_root(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_scene *scene = base;
    const weft__node *version = weft__value_in(match, "weft");
    if (version != NULL && scene->version > 1) {
        weft__report_error(reader->report, version->at,
                           "version %zu of the scene format is not known: this is a "
                           "reader of version 1",
                           scene->version);
    }
}

/* ---- grid ------------------------------------------------------------------- */

static bool check_size(weft__reader *reader, const weft__match *match,
                       weft_cloth_def *cloth)
{
    if (cloth->rows == 0 || cloth->cols == 0) {
        return false;
    }
    if (cloth->rows * cloth->cols < 2) {
        weft__report_error(reader->report, weft__value_in(match, "cols")->at,
                           "a grid of 1 x 1 is a single particle: rows * cols must be "
                           ">= 2");
        return false;
    }
    if (cloth->rows > MAX_PARTICLES / cloth->cols) {
        weft__report_error(reader->report, weft__value_in(match, "cols")->at,
                           "a grid of %zu x %zu has more than %zu particles",
                           cloth->rows, cloth->cols, MAX_PARTICLES);
        return false;
    }
    return true;
}

static double length(const double v[3])
{
    /* hypot, as squares may overflow or vanish */
    return hypot(hypot(v[0], v[1]), v[2]);
}

static bool check_axes(weft__reader *reader, const weft__match *match,
                       const weft_cloth_def *cloth)
{
    const double *right = cloth->right, *down = cloth->down;
    const double a = length(right), b = length(down);
    const weft__node *node = weft__value_in(match, "down");
    if (a == 0.0 || b == 0.0) {
        return false;
    }
    double cosine = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        cosine += (right[k] / a) * (down[k] / b);
    }
    if (!(fabs(cosine) <= 1e-9)) {
        node = node == NULL ? weft__value_in(match, "right") : node;
        weft__report_error(reader->report, node->at,
                           "down [%g, %g, %g] is not perpendicular to right [%g, %g, "
                           "%g]: the cosine is %.3g, not below 1e-9",
                           down[0], down[1], down[2], right[0], right[1], right[2],
                           cosine);
        return false;
    }
    return true;
}

/* A grid with its directions normalised. */
typedef struct frame {
    const weft_cloth_def *cloth;
    double right[3], down[3];
} frame;

static frame make_frame(const weft_cloth_def *cloth)
{
    const double right = length(cloth->right), down = length(cloth->down);
    frame made = { .cloth = cloth };
    for (size_t k = 0; k < 3; ++k) {
        made.right[k] = cloth->right[k] / right;
        made.down[k] = cloth->down[k] / down;
    }
    return made;
}

/* As weft_cloth_create places it. */
static void rest_position(const frame *grid, size_t r, size_t c, double x[3])
{
    const double across = (double)c * grid->cloth->spacing[1];
    const double along = (double)r * grid->cloth->spacing[0];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = grid->cloth->origin[k] + across * grid->right[k] + along * grid->down[k];
    }
}

/* Also if the distance is too small for its square. */
static bool coincide(const frame *grid, size_t r, size_t c, size_t r2, size_t c2)
{
    double a[3], b[3], square = 0.0;
    rest_position(grid, r, c, a);
    rest_position(grid, r2, c2, b);
    for (size_t k = 0; k < 3; ++k) {
        square += (b[k] - a[k]) * (b[k] - a[k]);
    }
    return square == 0.0;
}

/* Neighbours can only be rounded onto one another if the spacing is near the last bits
 * of the coordinates. Then all are compared, but for grids so large that it takes time:
 * weft_cloth_create compares them again. */
static bool may_coincide(const weft_cloth_def *cloth)
{
    const double extent = (double)cloth->rows * cloth->spacing[0]
                          + (double)cloth->cols * cloth->spacing[1];
    const double smaller
        = cloth->spacing[0] < cloth->spacing[1] ? cloth->spacing[0] : cloth->spacing[1];
    /* a unit vector has a component of 0.57 or more; 2^-52 is the spacing of doubles */
    const double limit = 16.0 * 0x1p-52 * (length(cloth->origin) + extent);
    return cloth->rows * cloth->cols <= (size_t)1 << 24
           && !(smaller > limit && smaller > 1e-150);
}

static void check_apart(weft__reader *reader, const weft__match *match,
                        const frame *grid)
{
    const weft_cloth_def *cloth = grid->cloth;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            const bool across = c + 1 < cloth->cols && coincide(grid, r, c, r, c + 1);
            const bool along = r + 1 < cloth->rows && coincide(grid, r, c, r + 1, c);
            if (across || along) {
                weft__report_error(
                    reader->report, weft__value_in(match, "spacing")->at,
                    "coincident rest positions: the spacing %g m from row %zu, column "
                    "%zu to the next %s is lost in rounding",
                    cloth->spacing[across ? 1 : 0], r, c, across ? "column" : "row");
                return;
            }
        }
    }
}

/* Positions must be numbers, at rest and as they start. */
static bool check_finite(weft__reader *reader, const weft__match *match,
                         const frame *grid)
{
    const weft_cloth_def *cloth = grid->cloth;
    for (size_t corner = 0; corner < 4; ++corner) {
        double x[3];
        rest_position(grid, corner & 1 ? cloth->rows - 1 : 0,
                      corner & 2 ? cloth->cols - 1 : 0, x);
        for (size_t k = 0; k < 3; ++k) {
            const double from = cloth->origin[k];
            if (!isfinite(x[k]) || !isfinite(from + cloth->scale * (x[k] - from))) {
                weft__report_error(reader->report, weft__value_in(match, "spacing")->at,
                                   "the grid is too large: positions are not finite");
                return false;
            }
        }
    }
    return true;
}

void weft__check_grid(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    const bool sized = check_size(reader, match, cloth);
    const bool square = check_axes(reader, match, cloth);
    if (!sized) {
        cloth->rows = cloth->cols = 0; /* nothing more is checked against the grid */
        return;
    }
    if (!square || cloth->spacing[0] == 0.0 || cloth->scale == 0.0) {
        return;
    }
    const frame grid = make_frame(cloth);
    if (check_finite(reader, match, &grid) && may_coincide(cloth)) {
        check_apart(reader, match, &grid);
    }
}

/* ---- cloth ------------------------------------------------------------------ */

void weft__check_springs(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    const bool sized = cloth->rows > 0;
    const bool none[WEFT_FAMILIES] = {
        [WEFT_SHEAR] = sized && (cloth->rows < 2 || cloth->cols < 2),
        [WEFT_BEND] = sized && cloth->rows < 3 && cloth->cols < 3,
    };
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const char *name = weft_family_name((weft_family)i);
        const weft__node *key = weft__key_in(match, name);
        cloth->springs[i].present = key != NULL;
        if (key != NULL && none[i]) {
            weft__report_warning(reader->report, key->at,
                                 "a grid of %zu x %zu has no %s springs", cloth->rows,
                                 cloth->cols, name);
        }
    }
}

static void check_mass(weft__reader *reader, const weft__match *match)
{
    const weft__node *mass = weft__key_in(match, "mass");
    const weft__node *density = weft__key_in(match, "density");
    if (mass != NULL && density != NULL) {
        weft__report_exclusive(reader->report, mass, density);
    } else if (mass == NULL && density == NULL && !weft__misspelt(match, "mass")
               && !weft__misspelt(match, "density")) {
        weft__report_error(reader->report, match->map->at,
                           "cloth lacks 'mass' [kg] or 'density' [kg/m^2]: exactly one "
                           "is required");
    }
}

static size_t resolve(ptrdiff_t index, size_t count)
{
    return (size_t)(index < 0 ? index + (ptrdiff_t)count : index);
}

/* Particles that no pin holds, counted by a sum over the corners of the pins' ranges;
 * 1 if that would take too much memory. */
static size_t count_free(weft__reader *reader, const weft_cloth_def *cloth)
{
    const size_t width = cloth->cols + 1;
    if (cloth->rows * cloth->cols > (size_t)1 << 24) {
        return 1;
    }
    int *steps = weft__zeroed(reader->report->memory, (cloth->rows + 1) * width,
                              sizeof *steps);
    if (steps == NULL) {
        reader->report->no_memory = true;
        return 1;
    }
    for (size_t i = 0; i < cloth->pin_count; ++i) {
        const weft_pin *pin = &cloth->pins[i];
        const size_t top = resolve(pin->rows.first, cloth->rows);
        const size_t bottom = resolve(pin->rows.last, cloth->rows) + 1;
        const size_t left = resolve(pin->cols.first, cloth->cols);
        const size_t right = resolve(pin->cols.last, cloth->cols) + 1;
        ++steps[top * width + left];
        --steps[top * width + right];
        --steps[bottom * width + left];
        ++steps[bottom * width + right];
    }
    size_t free_ones = 0;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            int *here = &steps[r * width + c];
            *here += (r > 0 ? here[-(ptrdiff_t)width] : 0) + (c > 0 ? here[-1] : 0)
                     - (r > 0 && c > 0 ? here[-(ptrdiff_t)width - 1] : 0);
            free_ones += *here == 0;
        }
    }
    weft__free(reader->report->memory, steps);
    return free_ones;
}

/* Only where the pins might hold all: the count takes time. */
static bool may_hold_all(const weft_cloth_def *cloth)
{
    double held = 0.0;
    for (size_t i = 0; i < cloth->pin_count; ++i) {
        const weft_pin *pin = &cloth->pins[i];
        held += ((double)resolve(pin->rows.last, cloth->rows)
                 - (double)resolve(pin->rows.first, cloth->rows) + 1.0)
                * ((double)resolve(pin->cols.last, cloth->cols)
                   - (double)resolve(pin->cols.first, cloth->cols) + 1.0);
    }
    return held >= (double)cloth->rows * (double)cloth->cols;
}

void weft__check_cloth(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_cloth_def *cloth = base;
    check_mass(reader, match);
    if (cloth->pin_count > 0 && reader->report->found->errors == 0
        && may_hold_all(cloth) && count_free(reader, cloth) == 0) {
        weft__report_warning(reader->report, weft__key_in(match, "pins")->at,
                             "all %zu particles are pinned: nothing will move freely",
                             cloth->rows * cloth->cols);
    }
}

/* ---- limit, run ------------------------------------------------------------- */

void weft__check_limit(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_limit_def *limit = base;
    const weft__node *velocity = weft__value_in(match, "velocity");
    bool limits = false;
    if (limit->method == WEFT_LIMIT_BRIDSON && limit->keep_velocity) {
        weft__report_error(reader->report, velocity->at,
                           "method bridson would not use 'keep': it works on "
                           "velocities");
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        limits
            = limits || (limit->families[i] && reader->scene->cloth.springs[i].present);
    }
    if (!limits && reader->report->found->errors == 0) {
        weft__report_warning(
            reader->report, match->map->at,
            "limit has no effect: cloth has no springs of the families "
            "it limits");
    }
}

/* No step crosses a frame. Told where the cure is: the stepper has been read before. */
static void check_frame(weft__reader *reader, const weft__match *match,
                        const weft_run_def *run)
{
    const double h = reader->scene->config.fixed_step;
    const weft__node *fps = weft__key_in(match, "fps");
    if (h * run->fps > 1.0 + 1e-6) {
        weft__report_warning(reader->report, (fps == NULL ? match->map : fps)->at,
                             "fixed_step %g s is longer than a frame (%.4g s): every "
                             "step will be %.4g s; run.fps=%.7g makes frames of %g s",
                             h, 1.0 / run->fps, 1.0 / run->fps, 1.0 / h, h);
    }
}

void weft__check_run(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_run_def *run = base;
    if (run->duration * run->fps > 0x1p53) {
        const weft__node *node = weft__value_in(match, "fps");
        node = node == NULL ? weft__value_in(match, "duration") : node;
        weft__report_error(reader->report, node->at,
                           "%g s at %g frames per second are more frames than can be "
                           "counted (2^53)",
                           run->duration, run->fps);
    }
    check_frame(reader, match, run);
}
