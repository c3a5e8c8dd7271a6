/* SPDX-License-Identifier: BSD-3-Clause */
/* validate.c -- all that can be wrong with the definition of a cloth. Comparisons are
 * written so that NaN fails. */
#include "cloth/model.h"

#include <math.h>

#define MAX_PARTICLES ((size_t)1 << 31)

static bool finite3(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool not_negative(double x)
{
    return isfinite(x) && x >= 0.0;
}

static bool positive(double x)
{
    return isfinite(x) && x > 0.0;
}

bool weft__range_resolve(weft_range range, size_t count, size_t *first, size_t *last)
{
    const ptrdiff_t n = (ptrdiff_t)count;
    const ptrdiff_t a = range.first < 0 ? range.first + n : range.first;
    const ptrdiff_t b = range.last < 0 ? range.last + n : range.last;
    *first = (size_t)a;
    *last = (size_t)b;
    return a >= 0 && b < n && a <= b;
}

static weft_status check_range(const weft_cloth_def *def, const char *what,
                               size_t index, weft_range rows, weft_range cols,
                               weft_error *err)
{
    size_t first, last;
    if (!weft__range_resolve(rows, def->rows, &first, &last)) {
        return weft_error_set(
            err, WEFT_INVALID,
            "%s %zu: rows %td to %td are outside the grid of %zu rows", what, index,
            rows.first, rows.last, def->rows);
    }
    if (!weft__range_resolve(cols, def->cols, &first, &last)) {
        return weft_error_set(
            err, WEFT_INVALID,
            "%s %zu: columns %td to %td are outside the grid of %zu columns", what,
            index, cols.first, cols.last, def->cols);
    }
    return WEFT_OK;
}

static weft_status check_grid(const weft_cloth_def *def, weft_error *err)
{
    if (def->rows < 1 || def->cols < 1 || def->rows > MAX_PARTICLES / def->cols
        || def->rows * def->cols < 2) {
        return weft_error_set(err, WEFT_INVALID,
                              "grid of %zu x %zu: needs 2 to %zu particles", def->rows,
                              def->cols, MAX_PARTICLES);
    }
    if (!positive(def->spacing[0]) || !positive(def->spacing[1])) {
        return weft_error_set(err, WEFT_INVALID, "spacing %g, %g m: must be > 0",
                              def->spacing[0], def->spacing[1]);
    }
    if (!finite3(def->origin) || !finite3(def->velocity)) {
        return weft_error_set(err, WEFT_INVALID, "origin and velocity must be finite");
    }
    if (!positive(def->scale)) {
        return weft_error_set(err, WEFT_INVALID, "scale %g: must be > 0", def->scale);
    }
    return WEFT_OK;
}

static weft_status check_axes(const weft_cloth_def *def, weft_error *err)
{
    const double *a = def->right, *b = def->down;
    const double la = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    const double lb = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    if (!positive(la) || !positive(lb)) {
        return weft_error_set(err, WEFT_INVALID,
                              "right and down must be finite and not zero");
    }
    const double cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / (la * lb);
    if (!(fabs(cosine) <= 1e-9)) {
        return weft_error_set(err, WEFT_INVALID,
                              "down must be perpendicular to right (cosine %g)",
                              cosine);
    }
    return WEFT_OK;
}

static weft_status check_mass(const weft_cloth_def *def, weft_error *err)
{
    if (!not_negative(def->mass) || !not_negative(def->density)
        || (def->mass > 0.0) == (def->density > 0.0)) {
        return weft_error_set(err, WEFT_INVALID,
                              "mass %g kg, density %g kg/m^2: exactly one must be > 0",
                              def->mass, def->density);
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        if (!positive(load->mass)) {
            return weft_error_set(err, WEFT_INVALID,
                                  "load %zu: mass %g kg: must be > 0", i, load->mass);
        }
        const weft_status status
            = check_range(def, "load", i, load->rows, load->cols, err);
        if (status != WEFT_OK) {
            return status;
        }
    }
    return WEFT_OK;
}

static weft_status check_springs(const weft_cloth_def *def, weft_error *err)
{
    if (def->law != WEFT_LAW_HOOKE && def->law != WEFT_LAW_STRAIN) {
        return weft_error_set(err, WEFT_INVALID, "unknown spring law %d",
                              (int)def->law);
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const weft_spring_def *spring = &def->springs[i];
        if (spring->present
            && (!not_negative(spring->stiffness) || !not_negative(spring->damping))) {
            return weft_error_set(
                err, WEFT_INVALID, "%s springs: stiffness %g, damping %g: must be >= 0",
                weft_family_name((weft_family)i), spring->stiffness, spring->damping);
        }
    }
    return WEFT_OK;
}

static weft_status check_pins(const weft_cloth_def *def, weft_error *err)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        if (!finite3(pin->velocity) || !finite3(pin->amplitude)
            || !not_negative(pin->frequency)) {
            return weft_error_set(err, WEFT_INVALID,
                                  "pin %zu: its motion must be finite, frequency >= 0",
                                  i);
        }
        const weft_status status
            = check_range(def, "pin", i, pin->rows, pin->cols, err);
        if (status != WEFT_OK) {
            return status;
        }
    }
    return WEFT_OK;
}

static weft_status check_forces(const weft_cloth_def *def, weft_error *err)
{
    if (!finite3(def->gravity) || !finite3(def->wind_velocity)
        || !not_negative(def->drag) || !not_negative(def->wind_drag)) {
        return weft_error_set(err, WEFT_INVALID,
                              "forces must be finite, drag and wind drag >= 0");
    }
    return WEFT_OK;
}

weft_status weft__cloth_def_check(const weft_cloth_def *def, weft_error *err)
{
    weft_status (*const checks[])(const weft_cloth_def *, weft_error *) = {
        check_grid, check_axes, check_mass, check_springs, check_pins, check_forces,
    };
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; ++i) {
        const weft_status status = checks[i](def, err);
        if (status != WEFT_OK) {
            return status;
        }
    }
    return WEFT_OK;
}
