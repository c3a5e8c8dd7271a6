/* SPDX-License-Identifier: BSD-3-Clause */
/* grid_check.c -- the numbers of a grid, its pins and loads. */
#include "base/finite.h"
#include "mesh/grid_def.h"

#define MAX_PARTICLES ((size_t)1 << (sizeof(size_t) < 8 ? 24 : 31))
#define FIELD(name)   offsetof(weft_cloth_def, name)
#define POSITIVE      .strict = true
#define NOT_NEGATIVE  .least = 0.0
#define VECTOR        .count = 3, .least = -HUGE_VAL

const struct weft__grid_numbers weft__grid_numbers = {
    WEFT__FIELD(weft_cloth_def, rows, NULL, .type = WEFT__SIZE, .least = 1.0,
                .most = MAX_PARTICLES),
    WEFT__FIELD(weft_cloth_def, cols, NULL, .type = WEFT__SIZE, .least = 1.0,
                .most = MAX_PARTICLES),
    WEFT__FIELD(weft_cloth_def, spacing, "m", .count = 2, POSITIVE),
    WEFT__FIELD(weft_cloth_def, origin, "m", VECTOR),
    WEFT__FIELD(weft_cloth_def, scale, NULL, POSITIVE),
    WEFT__FIELD(weft_cloth_def, mass, "kg", POSITIVE, .optional = true),
    WEFT__FIELD(weft_cloth_def, density, "kg/m^2", POSITIVE, .optional = true),
    WEFT__FIELD(weft_cloth_def, velocity, "m/s", VECTOR),
};

const weft__number weft__load_mass
    = { offsetof(weft_load, mass), "mass", "kg", POSITIVE };

const struct weft__pin_numbers weft__pin_numbers = {
    WEFT__FIELD(weft_pin, velocity, "m/s", VECTOR),
    WEFT__FIELD(weft_pin, amplitude, "m", VECTOR),
    WEFT__FIELD(weft_pin, frequency, "Hz", NOT_NEGATIVE),
};

/* ---- places ---------------------------------------------------------------------- */

void weft__ranges_check(const weft_cloth_def *def, const weft__faults *to,
                        const char *what, size_t index, weft_range rows,
                        weft_range cols)
{
    size_t first, last;
    if (!weft__range_resolve(rows, def->rows, &first, &last)) {
        weft__fault(to, FIELD(rows), FIELD(rows),
                    "%s %zu: rows %td to %td are outside the grid of %zu rows", what,
                    index, rows.first, rows.last, def->rows);
    }
    if (!weft__range_resolve(cols, def->cols, &first, &last)) {
        weft__fault(to, FIELD(cols), FIELD(cols),
                    "%s %zu: columns %td to %td are outside the grid of %zu columns",
                    what, index, cols.first, cols.last, def->cols);
    }
}

/* ---- grid ------------------------------------------------------------------------ */

static bool check_size(const weft_cloth_def *def, const weft__faults *to)
{
    const size_t rows = def->rows, cols = def->cols;
    const bool single = rows == 1 && cols == 1;
    if (rows == 0 || cols == 0) {
        return false; /* out of range */
    }
    if (single) {
        weft__fault(to, FIELD(cols), FIELD(rows),
                    "a grid of 1 x 1 is a single particle: rows * cols must be >= 2");
    } else if (rows > MAX_PARTICLES / cols) {
        weft__fault(to, FIELD(cols), FIELD(rows),
                    "a grid of %zu x %zu has more than %zu particles", rows, cols,
                    MAX_PARTICLES);
    }
    return !single && rows <= MAX_PARTICLES / cols;
}

static bool grid_check_check_band(const weft_cloth_def *def, const weft__faults *to)
{
    const size_t first = def->band_first, rows = def->band_rows, all = def->rows;
    const bool single = rows == 1 && all > 1;
    const bool outside = rows > all || first > all - rows;
    if (rows > 0 && (single || outside)) {
        weft__fault(to, FIELD(band_rows), FIELD(band_first),
                    "a band of %zu rows from row %zu of %zu: %s", rows, first, all,
                    outside ? "it must lie inside" : "it must have 2 or more");
    }
    return rows == 0 || !(single || outside);
}

/* No direction is a vector whose length is lost in rounding, either. */
static bool check_direction(const double v[3], size_t field, const weft__faults *to)
{
    if (!weft__positive(weft__length(v))) {
        weft__fault(to, field, field, "%s is [%g, %g, %g], which is no direction",
                    field == FIELD(right) ? "right" : "down", v[0], v[1], v[2]);
    }
    return weft__positive(weft__length(v));
}

static bool check_axes(const weft_cloth_def *def, const weft__faults *to)
{
    const double *a = def->right, *b = def->down;
    const bool directed = check_direction(a, FIELD(right), to);
    if (!check_direction(b, FIELD(down), to) || !directed) {
        return false;
    }
    const double cosine = weft__dot(a, b) / (weft__length(a) * weft__length(b));
    if (!(fabs(cosine) <= 1e-9)) {
        weft__fault(
            to, FIELD(down), FIELD(right),
            "down [%g, %g, %g] is not perpendicular to right [%g, %g, %g]: the cosine "
            "is %.3g, not below 1e-9",
            b[0], b[1], b[2], a[0], a[1], a[2], cosine);
        return false;
    }
    return true;
}

/* Positions must be numbers, at rest and as they start. */
static bool grid_check_check_finite(const weft__mesh *grid, const weft__faults *to)
{
    bool finite = true;
    for (size_t corner = 0; corner < 4; ++corner) {
        const size_t r = corner / 2 * (grid->rows - 1),
                     c = corner % 2 * (grid->cols - 1);
        double rest[3], start[3];
        weft__grid_rest(grid, r * grid->cols + c, rest);
        weft__grid_start(grid, r * grid->cols + c, start);
        finite = finite && weft__all_finite(rest, 3) && weft__all_finite(start, 3);
    }
    if (!finite) {
        weft__fault(to, FIELD(spacing), FIELD(spacing),
                    "the grid is too large: positions are not finite");
    }
    return finite;
}

/* Neighbours can only be rounded onto one another if the spacing is near the last bits
 * of the coordinates. */
static bool may_coincide(const weft__mesh *grid)
{
    const double extent = (double)grid->band.rows * grid->spacing[0]
                          + (double)grid->cols * grid->spacing[1];
    const double smaller = fmin(grid->spacing[0], grid->spacing[1]);
    /* a unit vector has a component of 0.57 or more; 2^-52 is the spacing of doubles */
    const double limit = 16.0 * 0x1p-52 * (weft__length(grid->origin) + extent);
    return !(smaller > limit && smaller > 1e-150);
}

/* Also if the distance is too small for its square. */
static bool coincide(const weft__mesh *grid, size_t r, size_t c, size_t r2, size_t c2)
{
    double a[3], b[3];
    weft__grid_rest(grid, r * grid->cols + c, a);
    weft__grid_rest(grid, r2 * grid->cols + c2, b);
    const double d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    return r2 < grid->rows && c2 < grid->cols && weft__length(d) == 0.0;
}

static void check_apart(const weft__mesh *grid, const weft__faults *to)
{
    for (size_t r = 0; r < grid->rows; ++r) {
        for (size_t c = 0; c < grid->cols; ++c) {
            const bool across = coincide(grid, r, c, r, c + 1);
            if (across || coincide(grid, r, c, r + 1, c)) {
                weft__fault(
                    to, FIELD(spacing), FIELD(spacing),
                    "coincident rest positions: the spacing %g m from row %zu, column "
                    "%zu to the next %s is lost in rounding",
                    grid->spacing[across ? 1 : 0],
                    weft__whole_index(grid, r * grid->cols) / grid->cols, c,
                    across ? "column" : "row");
                return;
            }
        }
    }
}

bool weft__grid_check(const weft_cloth_def *def, size_t most, const weft__faults *to)
{
    weft__mesh grid = { .rows = 0 };
    const bool good = WEFT__NUMBERS_CHECK(weft__grid_numbers, def, to, "%s", "");
    const bool sized = check_size(def, to) && grid_check_check_band(def, to);
    if (!check_axes(def, to) || !sized || !good) {
        return sized;
    }
    weft__grid_init(&grid, def);
    if (grid_check_check_finite(&grid, to) && may_coincide(&grid)
        && grid.particles <= most) {
        check_apart(&grid, to);
    }
    return true;
}

size_t weft__grid_pin_of(const weft_cloth_def *def, size_t r, size_t c)
{
    for (size_t i = def->pin_count; i > 0; --i) {
        const weft_pin *pin = &def->pins[i - 1];
        size_t top, bottom, left, right;
        if (weft__range_resolve(pin->rows, def->rows, &top, &bottom)
            && weft__range_resolve(pin->cols, def->cols, &left, &right) && r >= top
            && r <= bottom && c >= left && c <= right) {
            return i;
        }
    }
    return 0;
}
