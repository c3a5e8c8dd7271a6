/* SPDX-License-Identifier: BSD-3-Clause */
/* validate.c -- checks the definition of a cloth and reports every fault. Comparisons
 * are written so that NaN fails. */
#include "cloth/model.h"
#include "cloth/shapes.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/finite.h"

#define MAX_PARTICLES ((size_t)1 << 31)

#define FIELD(name) offsetof(weft_cloth_def, name)
#define LIMIT(name) offsetof(weft_limit_def, name)

WEFT_PRINTF(4, 5)
static void fault(const weft__faults *to, size_t field, size_t other,
                  const char *format, ...)
{
    char message[256];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(message, sizeof message, format, args);
    va_end(args);
    to->found(to->ctx, field, other, message);
}

void weft__keep_first(void *ctx, size_t field, size_t other, const char *message)
{
    weft__refusal *first = ctx;
    (void)field;
    (void)other;
    if (first->status == WEFT_OK) {
        first->status = weft_error_set(first->err, WEFT_INVALID, "%s", message);
    }
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

/* `field`: of the array that the range belongs to. */
static void check_ranges(const weft_cloth_def *def, const weft__faults *to,
                         size_t field, const char *what, size_t index, weft_range rows,
                         weft_range cols)
{
    size_t first, last;
    if (!weft__range_resolve(rows, def->rows, &first, &last)) {
        fault(to, field, field,
              "%s %zu: rows %td to %td are outside the grid of %zu rows", what, index,
              rows.first, rows.last, def->rows);
    }
    if (!weft__range_resolve(cols, def->cols, &first, &last)) {
        fault(to, field, field,
              "%s %zu: columns %td to %td are outside the grid of %zu columns", what,
              index, cols.first, cols.last, def->cols);
    }
}

/* ---- grid ------------------------------------------------------------------------ */

static bool check_size(const weft_cloth_def *def, const weft__faults *to)
{
    const size_t rows = def->rows, cols = def->cols;
    if (rows == 0 || cols == 0) {
        const size_t field = rows == 0 ? FIELD(rows) : FIELD(cols);
        fault(to, field, field, "a grid of %zu x %zu has no particles", rows, cols);
    } else if (rows == 1 && cols == 1) {
        fault(to, FIELD(cols), FIELD(rows),
              "a grid of 1 x 1 is a single particle: rows * cols must be >= 2");
    } else if (rows > MAX_PARTICLES / cols) {
        fault(to, FIELD(cols), FIELD(rows),
              "a grid of %zu x %zu has more than %zu particles", rows, cols,
              MAX_PARTICLES);
    } else {
        return true;
    }
    return false;
}

static bool check_lengths(const weft_cloth_def *def, const weft__faults *to)
{
    const bool spaced
        = weft__positive(def->spacing[0]) && weft__positive(def->spacing[1]);
    const bool scaled = weft__positive(def->scale);
    if (!spaced) {
        fault(to, FIELD(spacing), FIELD(spacing), "spacing %g, %g m: must be > 0",
              def->spacing[0], def->spacing[1]);
    }
    if (!scaled) {
        fault(to, FIELD(scale), FIELD(scale), "scale %g: must be > 0", def->scale);
    }
    if (!weft__all_finite(def->origin, 3) || !weft__all_finite(def->velocity, 3)) {
        fault(to, FIELD(origin), FIELD(velocity), "origin and velocity must be finite");
    }
    return spaced && scaled && weft__all_finite(def->origin, 3);
}

/* No direction is a vector whose length is lost in rounding, either. */
static bool check_direction(const double v[3], size_t field, const weft__faults *to)
{
    if (!weft__positive(weft__length(v))) {
        fault(to, field, field, "%s is [%g, %g, %g], which is no direction",
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
        fault(
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
        fault(to, FIELD(spacing), FIELD(spacing),
              "the grid is too large: positions are not finite");
    }
    return finite;
}

/* Neighbours can only be rounded onto one another if the spacing is near the last bits
 * of the coordinates. */
static bool may_coincide(const weft_cloth *grid)
{
    const double extent
        = (double)grid->rows * grid->spacing[0] + (double)grid->cols * grid->spacing[1];
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
                fault(
                    to, FIELD(spacing), FIELD(spacing),
                    "coincident rest positions: the spacing %g m from row %zu, column "
                    "%zu to the next %s is lost in rounding",
                    grid->spacing[across ? 1 : 0], r, c, across ? "column" : "row");
                return;
            }
        }
    }
}

bool weft__grid_check(const weft_cloth_def *def, size_t most, const weft__faults *to)
{
    weft_cloth grid = { .rows = 0 };
    const bool sized = check_size(def, to);
    const bool spaced = check_lengths(def, to);
    if (!check_axes(def, to) || !sized || !spaced) {
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
    if (!weft__not_negative(def->mass) || !weft__not_negative(def->density)
        || (def->mass > 0.0) == (def->density > 0.0)) {
        fault(to, FIELD(mass), FIELD(density),
              "mass %g kg, density %g kg/m^2: exactly one must be > 0", def->mass,
              def->density);
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        if (!weft__positive(load->mass)) {
            fault(to, FIELD(loads), FIELD(loads), "load %zu: mass %g kg: must be > 0",
                  i, load->mass);
        }
        check_ranges(def, to, FIELD(loads), "load", i, load->rows, load->cols);
    }
}

static void check_springs(const weft_cloth_def *def, const weft__faults *to)
{
    if (def->law != WEFT_LAW_HOOKE && def->law != WEFT_LAW_STRAIN) {
        fault(to, FIELD(law), FIELD(law), "unknown spring law %d", (int)def->law);
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const weft_spring_def *spring = &def->springs[i];
        if (spring->present
            && (!weft__not_negative(spring->stiffness)
                || !weft__not_negative(spring->damping))) {
            const size_t field = FIELD(springs) + i * sizeof *spring;
            fault(to, field, field,
                  "%s springs: stiffness %g, damping %g: must be >= 0",
                  weft_family_name((weft_family)i), spring->stiffness, spring->damping);
        }
    }
}

static void check_pins(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        if (!weft__all_finite(pin->velocity, 3) || !weft__all_finite(pin->amplitude, 3)
            || !weft__not_negative(pin->frequency)) {
            fault(to, FIELD(pins), FIELD(pins),
                  "pin %zu: its motion must be finite, frequency >= 0", i);
        }
        check_ranges(def, to, FIELD(pins), "pin", i, pin->rows, pin->cols);
    }
}

static void check_forces(const weft_cloth_def *def, const weft__faults *to)
{
    if (!weft__all_finite(def->gravity, 3) || !weft__all_finite(def->wind_velocity, 3)
        || !weft__not_negative(def->drag) || !weft__not_negative(def->wind_drag)) {
        fault(to, FIELD(gravity), FIELD(wind_velocity),
              "forces must be finite, drag and wind drag >= 0");
    }
}

/* ---- contact --------------------------------------------------------------------- */

#define SHAPE(name) offsetof(weft_shape, name)

static void check_contact(const weft_cloth_def *def, const weft__faults *to)
{
    const weft_contact_def *law = &def->contact;
    const struct {
        const char *name;
        size_t field;
        double value;
        bool usable;
    } numbers[] = {
#define NUMBER(name, test) { #name, FIELD(contact.name), law->name, test(law->name) }
        NUMBER(thickness, weft__positive),    NUMBER(stopping_speed, weft__positive),
        NUMBER(slip, weft__positive),         NUMBER(damping, weft__not_negative),
        NUMBER(friction, weft__not_negative),
#undef NUMBER
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        if (!numbers[i].usable) {
            fault(to, numbers[i].field, numbers[i].field,
                  "contact: %s %g: must be %s 0", numbers[i].name, numbers[i].value,
                  i < 3 ? ">" : ">=");
        }
    }
    if (law->exponent < 3 || law->exponent > 10) {
        fault(to, FIELD(contact.exponent), FIELD(contact.exponent),
              "contact: exponent %d: must be 3 to 10", law->exponent);
    }
    if (law->law != WEFT_FRICTION_SMOOTH && law->law != WEFT_FRICTION_COULOMB) {
        fault(to, FIELD(contact.law), FIELD(contact.law), "unknown friction law %d",
              (int)law->law);
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

/* The first fault of a shape; NULL: none. */
static const char *shape_fault(const weft_shape *shape, size_t *field)
{
    const double *a = shape->at, *b = shape->to, *h = shape->half;
    const double axis[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const bool plane = shape->kind == WEFT_PLANE, box = shape->kind == WEFT_BOX;
    const bool capsule = shape->kind == WEFT_CAPSULE;
    const bool round = shape->kind == WEFT_SPHERE || capsule;
    const struct {
        bool wrong;
        size_t field;
        const char *message;
    } rules[] = {
        { !plane && !box && !round, SHAPE(kind), "unknown kind" },
        { !weft__all_finite(a, 3), SHAPE(at), "its place must be finite" },
        { plane && !weft__positive(weft__length(shape->normal)), SHAPE(normal),
          "its normal must be finite and not zero" },
        { capsule && !weft__positive(weft__length(axis)), SHAPE(to),
          "its ends must be finite and apart" },
        { round && !weft__positive(shape->radius), SHAPE(radius),
          "its radius must be > 0" },
        { box && !weft__positive(shape->rounding), SHAPE(rounding),
          "its rounding must be > 0" },
        { box
              && !(weft__all_finite(h, 3) && h[0] > shape->rounding
                   && h[1] > shape->rounding && h[2] > shape->rounding),
          SHAPE(half), "half of each edge must be finite and > rounding" },
        { !weft__all_finite(shape->velocity, 3), SHAPE(velocity),
          "its velocity must be finite" },
        { !weft__all_finite(shape->amplitude, 3), SHAPE(amplitude),
          "its amplitude must be finite" },
        { !weft__not_negative(shape->frequency), SHAPE(frequency),
          "its frequency must be >= 0" },
        { !weft__all_finite(shape->spin, 3), SHAPE(spin), "its spin must be finite" },
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
    size_t field;
    const char *message = shape_fault(shape, &field);
    if (message != NULL) {
        fault(to, field, field, "shapes[%zu]: %s", index, message);
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

/* The free particle that starts deepest inside a shape without faults: the gap [m], > 0
 * if none does. */
static double start_gap(const weft_cloth_def *def, const weft_shape *shape,
                        size_t *particle)
{
    weft_cloth grid = { .rows = 0 };
    double least = (double)INFINITY;
    const weft__shape of = weft__shape_of(shape, 0.0);
    const weft__pose pose = weft__pose_of(&of, 0.0);
    weft__grid_init(&grid, def);
    for (size_t i = 0; i < grid.particles; ++i) {
        const size_t r = i / grid.cols, c = i % grid.cols;
        double x[3];
        weft__start_position(&grid, r, c, x);
        const double gap = weft__gap_at(&pose, x);
        if (!(gap > 0.0) && gap < least && weft__pin_of(def, r, c) == 0) {
            least = gap;
            *particle = i;
        }
    }
    return least;
}

bool weft__start_check(const weft_cloth_def *def, size_t shape, const weft__faults *to)
{
    size_t i = 0;
    const double gap = start_gap(def, &def->contact.shapes[shape], &i);
    if (gap <= 0.0) {
        fault(to, FIELD(contact.shapes), FIELD(contact.shapes),
              "particle (%zu, %zu) is %.3g mm inside shapes[%zu]", i / def->cols,
              i % def->cols, 1e3 * fabs(gap), shape);
    }
    return gap > 0.0;
}

/* Of a shape: the field in weft_cloth_def is the array. */
static void shape_found(void *ctx, size_t field, size_t other, const char *message)
{
    const weft__faults *to = ctx;
    (void)field, (void)other;
    to->found(to->ctx, FIELD(contact.shapes), FIELD(contact.shapes), message);
}

static void check_shapes(const weft_cloth_def *def, const weft__faults *to)
{
    weft__faults outer = *to;
    const weft__faults here = { shape_found, &outer };
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        (void)(weft__shape_check(&def->contact.shapes[k], k, &here)
               && weft__start_check(def, k, to));
    }
}

void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (weft__grid_check(def, MAX_PARTICLES, to)) {
        check_mass(def, to);
        check_springs(def, to);
        check_pins(def, to);
        check_forces(def, to);
        if (def->contact.shape_count > 0) {
            check_contact(def, to);
            check_shapes(def, to);
        }
    }
}

/* ---- its strain limit ------------------------------------------------------------ */

void weft__limit_check(const weft_limit_def *def, const weft__faults *to)
{
    const bool bridson = def->method == WEFT_LIMIT_BRIDSON;
    if (!bridson && def->method != WEFT_LIMIT_PROVOT) {
        fault(to, LIMIT(method), LIMIT(method), "limit method %d is unknown",
              (int)def->method);
    }
    if (def->solver != WEFT_LIMIT_FAST && def->solver != WEFT_LIMIT_SWEEP) {
        fault(to, LIMIT(solver), LIMIT(solver), "limit solver %d is unknown",
              (int)def->solver);
    }
    if (!weft__not_negative(def->strain)) {
        fault(to, LIMIT(strain), LIMIT(strain), "limit strain %g: must be >= 0",
              def->strain);
    }
    if (!weft__positive(def->tolerance)) {
        fault(to, LIMIT(tolerance), LIMIT(tolerance), "limit tolerance %g: must be > 0",
              def->tolerance);
    }
    if (def->sweeps == 0) {
        fault(to, LIMIT(sweeps), LIMIT(sweeps), "limit sweeps 0: must be >= 1");
    }
    if (bridson && def->keep_velocity) {
        fault(to, LIMIT(keep_velocity), LIMIT(method),
              "limit method bridson cannot keep velocities: it works on them");
    }
}
