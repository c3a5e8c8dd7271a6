/* SPDX-License-Identifier: BSD-3-Clause */
/* validate.c -- checks the definition of a cloth and reports every fault. Comparisons
 * are written so that NaN fails. */
#include "base/finite.h"
#include "cloth/bending.h"
#include "cloth/model.h"
#include "cloth/shapes.h"

#define MAX_PARTICLES ((size_t)1 << 31)

#define FIELD(name)   offsetof(weft_cloth_def, name)
#define LIMIT(name)   offsetof(weft_limit_def, name)
#define CONTACT(name) offsetof(weft_contact_def, name)
#define SHAPE(name)   offsetof(weft_shape, name)

/* ---- numbers --------------------------------------------------------------------- */

#define POSITIVE     .strict = true
#define NOT_NEGATIVE .least = 0.0
#define VECTOR       .count = 3, .least = -HUGE_VAL
#define UP_TO(last)  .type = WEFT__ENUM, .most = (last)

const struct weft__cloth_numbers weft__cloth_numbers = {
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
    WEFT__FIELD(weft_cloth_def, gravity, "m/s^2", VECTOR),
    WEFT__FIELD(weft_cloth_def, drag, "kg/s", NOT_NEGATIVE),
    WEFT__FIELD(weft_cloth_def, wind_velocity, "m/s", VECTOR),
    WEFT__FIELD(weft_cloth_def, wind_drag, "kg/(m^2 s)", NOT_NEGATIVE),
    WEFT__FIELD(weft_cloth_def, law, NULL, UP_TO(WEFT_LAW_STRAIN)),
};

const weft__number weft__load_mass
    = { offsetof(weft_load, mass), "mass", "kg", POSITIVE };

const struct weft__spring_numbers weft__spring_numbers = {
    WEFT__FIELD(weft_spring_def, stiffness, "N/m or N", NOT_NEGATIVE),
    WEFT__FIELD(weft_spring_def, damping, "kg/s", NOT_NEGATIVE),
};

const struct weft__bending_numbers weft__bending_numbers = {
    WEFT__FIELD(weft_bending_def, rigidity, "N m", .count = 2, NOT_NEGATIVE),
    WEFT__FIELD(weft_bending_def, twist, "N m", .least = -HUGE_VAL),
    WEFT__FIELD(weft_bending_def, damping, "s", NOT_NEGATIVE),
};

const struct weft__pin_numbers weft__pin_numbers = {
    WEFT__FIELD(weft_pin, velocity, "m/s", VECTOR),
    WEFT__FIELD(weft_pin, amplitude, "m", VECTOR),
    WEFT__FIELD(weft_pin, frequency, "Hz", NOT_NEGATIVE),
};

const struct weft__contact_numbers weft__contact_numbers = {
    WEFT__FIELD(weft_contact_def, thickness, "m", POSITIVE),
    WEFT__FIELD(weft_contact_def, stopping_speed, "m/s", POSITIVE),
    WEFT__FIELD(weft_contact_def, exponent, NULL, .type = WEFT__INT, .least = 3.0,
                .most = 10.0),
    WEFT__FIELD(weft_contact_def, damping, "s/m", NOT_NEGATIVE),
    WEFT__FIELD(weft_contact_def, friction, NULL, NOT_NEGATIVE),
    WEFT__FIELD(weft_contact_def, slip, "m/s", POSITIVE),
    WEFT__FIELD(weft_contact_def, law, NULL, UP_TO(WEFT_FRICTION_COULOMB)),
};

const struct weft__shape_numbers weft__shape_numbers = {
    WEFT__FIELD(weft_shape, kind, NULL, UP_TO(WEFT_SHAPES - 1)),
    WEFT__FIELD(weft_shape, at, "m", VECTOR),
    WEFT__FIELD(weft_shape, velocity, "m/s", VECTOR),
    WEFT__FIELD(weft_shape, amplitude, "m", VECTOR),
    WEFT__FIELD(weft_shape, frequency, "Hz", NOT_NEGATIVE),
    WEFT__FIELD(weft_shape, spin, "rad/s", VECTOR),
};
const weft__number weft__shape_radius = { SHAPE(radius), "radius", "m", POSITIVE };
const weft__number weft__shape_rounding
    = { SHAPE(rounding), "rounding", "m", POSITIVE };

const struct weft__limit_numbers weft__limit_numbers = {
    WEFT__FIELD(weft_limit_def, method, NULL, UP_TO(WEFT_LIMIT_BRIDSON)),
    WEFT__FIELD(weft_limit_def, solver, NULL, UP_TO(WEFT_LIMIT_SWEEP)),
    WEFT__FIELD(weft_limit_def, strain, NULL, NOT_NEGATIVE),
    WEFT__FIELD(weft_limit_def, sweeps, NULL, .type = WEFT__SIZE, .least = 1.0),
    WEFT__FIELD(weft_limit_def, tolerance, NULL, POSITIVE),
};

/* ---- places ---------------------------------------------------------------------- */

bool weft__range_resolve(weft_range range, size_t count, size_t *first, size_t *last)
{
    const ptrdiff_t n = (ptrdiff_t)count;
    const ptrdiff_t a = range.first < 0 ? range.first + n : range.first;
    const ptrdiff_t b = range.last < 0 ? range.last + n : range.last;
    *first = (size_t)a;
    *last = (size_t)b;
    return a >= 0 && b < n && a <= b;
}

static void check_ranges(const weft_cloth_def *def, const weft__faults *to,
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

static bool check_band(const weft_cloth_def *def, const weft__faults *to)
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
static bool check_finite(const weft_cloth *grid, const weft__faults *to)
{
    bool finite = true;
    for (size_t corner = 0; corner < 4; ++corner) {
        const size_t r = corner / 2 * (grid->rows - 1),
                     c = corner % 2 * (grid->cols - 1);
        double rest[3], start[3];
        weft__rest_position(grid, r, c, rest);
        weft__start_position(grid, r, c, start);
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
static bool may_coincide(const weft_cloth *grid)
{
    const double extent = (double)grid->band.rows * grid->spacing[0]
                          + (double)grid->cols * grid->spacing[1];
    const double smaller = fmin(grid->spacing[0], grid->spacing[1]);
    /* a unit vector has a component of 0.57 or more; 2^-52 is the spacing of doubles */
    const double limit = 16.0 * 0x1p-52 * (weft__length(grid->origin) + extent);
    return !(smaller > limit && smaller > 1e-150);
}

/* Also if the distance is too small for its square. */
static bool coincide(const weft_cloth *grid, size_t r, size_t c, size_t r2, size_t c2)
{
    double a[3], b[3];
    weft__rest_position(grid, r, c, a);
    weft__rest_position(grid, r2, c2, b);
    const double d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    return r2 < grid->rows && c2 < grid->cols && weft__length(d) == 0.0;
}

static void check_apart(const weft_cloth *grid, const weft__faults *to)
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
    weft_cloth grid = { .rows = 0 };
    const bool good = WEFT__NUMBERS_CHECK(weft__cloth_numbers, def, to, "%s", "");
    const bool sized = check_size(def, to) && check_band(def, to);
    if (!check_axes(def, to) || !sized || !good) {
        return sized;
    }
    weft__grid_init(&grid, def);
    if (check_finite(&grid, to) && may_coincide(&grid) && grid.particles <= most) {
        check_apart(&grid, to);
    }
    return true;
}

/* ---- masses, springs, pins, forces ----------------------------------------------- */

static void check_mass(const weft_cloth_def *def, const weft__faults *to)
{
    if ((def->mass > 0.0) == (def->density > 0.0)) {
        weft__fault(to, FIELD(mass), FIELD(density),
                    "mass %g kg, density %g kg/m^2: exactly one must be > 0", def->mass,
                    def->density);
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        (void)weft__numbers_check(&weft__load_mass, 1, load, to, "load %zu: ", i);
        check_ranges(def, to, "load", i, load->rows, load->cols);
    }
}

static void check_springs(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const weft_spring_def *springs = &def->springs[i], *across = &def->across[i];
        const char *name = weft_family_name((weft_family)i);
        if (springs->present) {
            (void)WEFT__NUMBERS_CHECK(weft__spring_numbers, springs, to,
                                      "%s springs: ", name);
        }
        if (springs->present && across->present) {
            (void)WEFT__NUMBERS_CHECK(weft__spring_numbers, across, to,
                                      "%s springs along a row: ", name);
        }
        if (across->present && i == WEFT_SHEAR) {
            weft__fault(to, FIELD(across), FIELD(across),
                        "%s springs along a row: they lie along the diagonals", name);
        }
    }
}

static void check_bending(const weft_cloth_def *def, const weft__faults *to)
{
    if (WEFT__NUMBERS_CHECK(weft__bending_numbers, &def->bending, to, "bending: ")
        && weft__rigidity_of(def).present && def->springs[WEFT_BEND].present) {
        weft__fault(to, FIELD(bending), FIELD(springs[WEFT_BEND]),
                    "bending rigidity excludes bend springs: remove one of them");
    }
}

static void check_pins(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        (void)WEFT__NUMBERS_CHECK(weft__pin_numbers, pin, to, "pin %zu: ", i);
        check_ranges(def, to, "pin", i, pin->rows, pin->cols);
    }
}

/* ---- contact --------------------------------------------------------------------- */

/* Products of numbers in range may be out of range: the law needs these. */
static void check_products(const weft_contact_def *law, const weft__faults *to)
{
    const double v = law->stopping_speed, per = 1.0 / law->thickness;
    const double u = law->damping * v, mu = law->friction, slip = law->slip;
    const struct {
        bool usable;
        size_t field;
        const char *text;
    } products[] = {
        { weft__positive(0.5 * v * v), CONTACT(stopping_speed),
          "stopping_speed^2 / 2" },
        { weft__positive(0.5 * v * v * per * per), CONTACT(thickness),
          "stopping_speed^2 / (2 thickness^2)" },
        { isfinite(u * u), CONTACT(damping), "(damping * stopping_speed)^2" },
        { isfinite(mu * mu), CONTACT(friction), "friction^2" },
        { weft__positive(slip * slip), CONTACT(slip), "slip^2" },
    };
    for (size_t i = 0; i < sizeof products / sizeof products[0]; ++i) {
        if (!products[i].usable) {
            weft__fault(to, products[i].field, CONTACT(stopping_speed),
                        "contact: %s is too large or too small for a double",
                        products[i].text);
        }
    }
}

void weft__contact_check(const weft_contact_def *law, const weft__faults *to)
{
    if (WEFT__NUMBERS_CHECK(weft__contact_numbers, law, to, "contact: ")) {
        check_products(law, to);
    }
}

/* Of spin along a direction, which is not 0: all of it. */
static bool along(const double spin[3], const double way[3])
{
    const double cross[3]
        = { spin[1] * way[2] - spin[2] * way[1], spin[2] * way[0] - spin[0] * way[2],
            spin[0] * way[1] - spin[1] * way[0] };
    return weft__length(cross) <= 1e-9 * weft__length(spin) * weft__length(way);
}

/* The first rule between its numbers that a shape breaks; NULL: none. */
static const char *shape_fault(const weft_shape *shape, size_t *field)
{
    const double *a = shape->at, *b = shape->to, *h = shape->half;
    const double axis[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const bool plane = shape->kind == WEFT_PLANE, box = shape->kind == WEFT_BOX;
    const bool capsule = shape->kind == WEFT_CAPSULE;
    const struct {
        bool wrong;
        size_t field;
        const char *message;
    } rules[] = {
        { plane && !weft__positive(weft__length(shape->normal)), SHAPE(normal),
          "its normal must be finite and not zero" },
        { capsule && !weft__positive(weft__length(axis)), SHAPE(to),
          "its ends must be finite and apart" },
        { box
              && !(weft__all_finite(h, 3) && h[0] > shape->rounding
                   && h[1] > shape->rounding && h[2] > shape->rounding),
          SHAPE(half), "half of each edge must be finite and > rounding" },
        { box && weft__length(shape->spin) != 0.0, SHAPE(spin), "a box cannot spin" },
        { capsule && !along(shape->spin, axis), SHAPE(spin),
          "a capsule spins about its axis only" },
        { plane && !along(shape->spin, shape->normal), SHAPE(spin),
          "a plane spins about its normal only" },
        { !isfinite(shape->friction), SHAPE(friction), "its friction must be finite" },
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].wrong) {
            *field = rules[i].field;
            return rules[i].message;
        }
    }
    return NULL;
}

bool weft__shape_check(const weft_shape *shape, size_t index, const weft__faults *to)
{
    const bool box = shape->kind == WEFT_BOX;
    const bool round = shape->kind == WEFT_SPHERE || shape->kind == WEFT_CAPSULE;
    const weft__number *size = box ? &weft__shape_rounding : &weft__shape_radius;
    size_t field;
    if (!WEFT__NUMBERS_CHECK(weft__shape_numbers, shape, to, "shapes[%zu]: ", index)
        || !weft__numbers_check(size, box || round, shape, to,
                                "shapes[%zu]: ", index)) {
        return false;
    }
    const char *message = shape_fault(shape, &field);
    if (message != NULL) {
        weft__fault(to, field, field, "shapes[%zu]: %s", index, message);
    }
    return message == NULL;
}

size_t weft__pin_of(const weft_cloth_def *def, size_t r, size_t c)
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

/* The free particle that starts deepest inside a shape without faults, by its number in
 * the whole cloth: the gap [m], > 0 if none does. */
static double start_gap(const weft_cloth_def *def, const weft_shape *shape,
                        size_t *particle)
{
    weft_cloth grid = { .rows = 0 };
    double least = (double)INFINITY;
    const weft__shape of = weft__shape_of(shape, 0.0);
    const weft__pose pose = weft__pose_of(&of, 0.0);
    weft__grid_init(&grid, def);
    for (size_t i = 0; i < grid.particles; ++i) {
        const size_t whole = weft__whole_index(&grid, i), c = i % grid.cols;
        double x[3];
        weft__start_position(&grid, i / grid.cols, c, x);
        const double gap = weft__gap_at(&pose, x);
        if (!(gap > 0.0) && gap < least
            && weft__pin_of(def, whole / grid.cols, c) == 0) {
            least = gap;
            *particle = whole;
        }
    }
    return least;
}

bool weft__start_check(const weft_cloth_def *def, size_t shape, char *text, size_t size)
{
    size_t i = 0;
    const double gap = start_gap(def, &def->contact.shapes[shape], &i);
    (void)weft_text_format(text, size, "particle (%zu, %zu) is %.3g mm inside shapes[%zu]",
                   i / def->cols, i % def->cols, 1e3 * fabs(gap), shape);
    return gap > 0.0;
}

static void check_shapes(const weft_cloth_def *def, const weft__faults *to)
{
    char inside[120];
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        if (weft__shape_check(&def->contact.shapes[k], k, to)
            && !weft__start_check(def, k, inside, sizeof inside)) {
            weft__fault(to, FIELD(contact.shapes), FIELD(contact.shapes), "%s", inside);
        }
    }
}

void weft__self_check(const weft_cloth_def *def, const weft__faults *to)
{
    const double most = 0.5 * weft__smaller_spacing(def->rows, def->cols, def->spacing);
    if (def->contact.self && def->contact.thickness > most) {
        weft__fault(to, CONTACT(thickness), CONTACT(self),
                    "contact: thickness %g m is more than half the smaller spacing, %g "
                    "m, which contact of the cloth with itself needs",
                    def->contact.thickness, most);
    }
}

static bool check_arrays(const weft_cloth_def *def, const weft__faults *to)
{
    const char *missing = def->load_count > 0 && def->loads == NULL ? "loads"
                          : def->pin_count > 0 && def->pins == NULL ? "pins"
                          : def->contact.shape_count > 0 && def->contact.shapes == NULL
                              ? "shapes"
                              : NULL;
    if (missing != NULL) {
        weft__fault(to, FIELD(loads), FIELD(loads),
                    "%s is NULL, but their number is not 0", missing);
    }
    return missing == NULL;
}

void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (check_arrays(def, to) && weft__grid_check(def, MAX_PARTICLES, to)) {
        check_mass(def, to);
        check_springs(def, to);
        check_bending(def, to);
        check_pins(def, to);
        if (def->contact.shape_count > 0 || def->contact.self) {
            weft__contact_check(&def->contact, to);
            weft__self_check(def, to);
            check_shapes(def, to);
        }
    }
}

/* ---- its strain limit ------------------------------------------------------------ */

void weft__limit_check(const weft_limit_def *def, const weft__faults *to)
{
    (void)WEFT__NUMBERS_CHECK(weft__limit_numbers, def, to, "limit ");
    if (def->method == WEFT_LIMIT_BRIDSON && def->keep_velocity) {
        weft__fault(to, LIMIT(keep_velocity), LIMIT(method),
                    "limit method bridson cannot keep velocities: it works on them");
    }
}
