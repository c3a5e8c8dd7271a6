/* SPDX-License-Identifier: BSD-3-Clause */
/* validate.c -- checks the definition of a cloth and reports every fault. Comparisons
 * are written so that NaN fails. */
#include "cloth/model.h"
#include "mesh/grid_def.h"

#define MAX_PARTICLES ((size_t)1 << 31)

#define FIELD(name) offsetof(weft_cloth_def, name)
#define LIMIT(name) offsetof(weft_limit_def, name)

/* ---- numbers --------------------------------------------------------------------- */

#define POSITIVE     .strict = true
#define NOT_NEGATIVE .least = 0.0
#define UP_TO(last)  .type = WEFT__ENUM, .most = (last)

const struct weft__limit_numbers weft__limit_numbers = {
    WEFT__FIELD(weft_limit_def, method, NULL, UP_TO(WEFT_LIMIT_BRIDSON)),
    WEFT__FIELD(weft_limit_def, solver, NULL, UP_TO(WEFT_LIMIT_SWEEP)),
    WEFT__FIELD(weft_limit_def, strain, NULL, NOT_NEGATIVE),
    WEFT__FIELD(weft_limit_def, sweeps, NULL, .type = WEFT__SIZE, .least = 1.0),
    WEFT__FIELD(weft_limit_def, tolerance, NULL, POSITIVE),
};

/* ---- masses, springs, pins, forces ----------------------------------------------- */

/* Of no particle may the mass or its inverse be infinite. A grid has its lightest
 * particle at a corner. */
static bool masses_usable(const weft_cloth_def *def)
{
    weft__mesh grid = { .rows = 0 };
    double loads = 0.0;
    bool usable = true;
    weft__grid_init(&grid, def);
    for (size_t i = 0; i < def->load_count; ++i) {
        loads += def->loads[i].mass;
    }
    for (size_t i = 0; i < 3; ++i) {
        const size_t r = i * (grid.rows - 1) / 2, c = i % 2 * (grid.cols / 2);
        const double area = weft__area(&grid, r * grid.cols + c);
        const double mass = def->density > 0.0 ? def->density * area : def->mass;
        usable = usable && isfinite(1.0 / mass) && isfinite(mass + loads);
    }
    return usable;
}

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
        weft__ranges_check(def, to, "load", i, load->rows, load->cols);
    }
    if (!masses_usable(def)) {
        weft__fault(to, FIELD(density), FIELD(mass),
                    "the masses are too large or too small for a double");
    }
}

static void check_pins(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        const weft__motion motion
            = weft__motion_of(pin->velocity, pin->amplitude, pin->frequency);
        (void)WEFT__NUMBERS_CHECK(weft__pin_numbers, pin, to, "pin %zu: ", i);
        weft__ranges_check(def, to, "pin", i, pin->rows, pin->cols);
        if (!weft__motion_usable(&motion)) {
            weft__fault(to, FIELD(pins), FIELD(pins),
                        "pin %zu: its motion is too large or too small for a double",
                        i);
        }
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

void weft__sheet_check(const weft_cloth_def *def, const weft__faults *to)
{
    check_mass(def, to);
    check_pins(def, to);
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->check != NULL) {
            weft__table[k].force->check(def, to);
        }
    }
}

void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (def->mesh != NULL) {
        weft__fault(to, FIELD(mesh), FIELD(mesh), "triangles are not built in yet");
        return;
    }
    if (check_arrays(def, to) && weft__grid_check(def, MAX_PARTICLES, to)) {
        weft__sheet_check(def, to);
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
