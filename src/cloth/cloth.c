/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth.c -- a cloth from its definition: masses, pins, the state at rest. */
#include "cloth/bending.h"
#include "cloth/levels.h"
#include "cloth/model.h"
#include "cloth/pins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/given.h"
#include "base/memory.h"
#include "cloth/crossing.h"
#include "cloth/shapes.h"

weft_cloth_def weft_cloth_def_default(void)
{
    return (weft_cloth_def){
        .rows = 2,
        .cols = 2,
        .spacing = { 1.0, 1.0 },
        .right = { 1.0, 0.0, 0.0 },
        .down = { 0.0, -1.0, 0.0 },
        .scale = 1.0,
        .density = 0.2,
        .bending = { .twist = -1.0 },
        .gravity = { 0.0, -9.81, 0.0 },
        .contact = { .thickness = 5e-3,
                     .stopping_speed = 5.0,
                     .exponent = 4,
                     .damping = 1.0,
                     .friction = 0.3,
                     .slip = 1e-3 },
    };
}

static void normalise(const double from[3], double to[3])
{
    const double length = weft__length(from);
    for (size_t k = 0; k < 3; ++k) {
        to[k] = from[k] / length;
    }
}

/* The row of the whole cloth that is row 0 here. */
static size_t top(const weft_cloth *cloth)
{
    return cloth->band.first - cloth->band.above;
}

void weft__rest_position(const weft_cloth *cloth, size_t r, size_t c, double x[3])
{
    const double across = (double)c * cloth->spacing[1];
    const double along = (double)(top(cloth) + r) * cloth->spacing[0];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = cloth->origin[k] + across * cloth->right[k] + along * cloth->down[k];
    }
}

void weft__start_position(const weft_cloth *cloth, size_t r, size_t c, double x[3])
{
    weft__rest_position(cloth, r, c, x);
    for (size_t k = 0; k < 3; ++k) {
        const double from = cloth->origin[k];
        x[k] = from + cloth->scale * (x[k] - from);
    }
}

/* Half a cell on a rim, a whole one inside. */
static double width(size_t index, size_t count, double spacing)
{
    return weft__strip(index, count) * weft__width(count, spacing);
}

double weft__area(const weft_cloth *cloth, size_t r, size_t c)
{
    return width(top(cloth) + r, cloth->band.rows, cloth->spacing[0])
           * width(c, cloth->cols, cloth->spacing[1]);
}

/* Of a range of rows of the whole cloth those that are here: [first, end). */
static void rows_here(const weft_cloth *cloth, weft_range range, size_t *first,
                      size_t *end)
{
    const size_t low = top(cloth), high = low + cloth->rows;
    size_t a, b;
    weft__range_resolve(range, cloth->band.rows, &a, &b);
    *first = (a < low ? low : a < high ? a : high) - low;
    *end = (b < low ? low : b < high ? b + 1 : high) - low;
}

static void masses_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            cloth->mass[r * cloth->cols + c]
                = def->density > 0.0 ? def->density * weft__area(cloth, r, c)
                                     : def->mass;
        }
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        size_t r0, r1, c0, c1;
        rows_here(cloth, load->rows, &r0, &r1);
        weft__range_resolve(load->cols, cloth->cols, &c0, &c1);
        for (size_t r = r0; r < r1; ++r) {
            for (size_t c = c0; c <= c1; ++c) {
                cloth->mass[r * cloth->cols + c] += load->mass;
            }
        }
    }
}

static void pins_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        size_t r0, r1, c0, c1;
        rows_here(cloth, pin->rows, &r0, &r1);
        weft__range_resolve(pin->cols, cloth->cols, &c0, &c1);
        cloth->motions[i]
            = weft__motion_of(pin->velocity, pin->amplitude, pin->frequency);
        for (size_t r = r0; r < r1; ++r) {
            for (size_t c = c0; c <= c1; ++c) {
                cloth->pin[r * cloth->cols + c] = (uint32_t)(i + 1);
            }
        }
    }
    cloth->motions[def->pin_count] = (weft__motion){ .moves = true, .coasts = true };
    for (size_t i = 0; i < cloth->particles; ++i) {
        cloth->pinned += cloth->pin[i] != 0;
    }
}

static void shapes_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    cloth->contact = def->contact;
    cloth->contact.shapes = NULL;
    cloth->contact.shape_count = 0;
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        cloth->shapes[k]
            = weft__shape_of(&def->contact.shapes[k], def->contact.friction);
    }
}

static weft_status list_pins(weft_cloth *cloth, weft_error *err)
{
    cloth->pins = weft__alloc(&cloth->memory, cloth->pinned, sizeof *cloth->pins);
    if (cloth->pins == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu pins",
                              cloth->pinned);
    }
    weft__cloth_list_pins(cloth);
    return WEFT_OK;
}

static bool can_move(const weft__motion *motion)
{
    bool can = true;
    for (size_t k = 0; k < 3; ++k) {
        can = can && isfinite(motion->omega * motion->omega * motion->amplitude[k]);
    }
    return can;
}

/* Products of numbers in range may be out of range: nothing infinite may enter a state,
 * and no divisor may be 0. */
static weft_status check_numbers(const weft_cloth *cloth, weft_error *err)
{
    const char *wrong = NULL;
    for (size_t i = 0; i < cloth->particles; ++i) {
        const bool usable = isfinite(cloth->mass[i]) && isfinite(1.0 / cloth->mass[i]);
        wrong = usable ? wrong : "masses";
    }
    for (size_t i = 0; i < cloth->group_count; ++i) {
        const weft__group *group = &cloth->groups[i];
        const bool usable = group->rest_length > 0.0 && isfinite(group->rest_length)
                            && isfinite(group->stiffness);
        wrong = usable ? wrong : "springs";
    }
    wrong = weft__rigidity_usable(&cloth->rigidity) ? wrong : "bending rigidities";
    for (size_t i = 0; i < cloth->motion_count; ++i) {
        wrong = can_move(&cloth->motions[i]) ? wrong : "motions of pins";
    }
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        wrong = can_move(&cloth->shapes[k].motion) ? wrong : "motions of shapes";
    }
    return wrong == NULL ? WEFT_OK
                         : weft_error_set(err, WEFT_INVALID,
                                          "the %s are too large or too small for a "
                                          "double",
                                          wrong);
}

static size_t at_most(size_t count, size_t most)
{
    return count < most ? count : most;
}

static weft_band band_of(const weft_cloth_def *def)
{
    const size_t first = def->band_rows > 0 ? def->band_first : 0;
    const size_t own = def->band_rows > 0 ? def->band_rows : def->rows;
    return (weft_band){ .rows = def->rows,
                        .first = first,
                        .own = own,
                        .above = at_most(first, WEFT_GHOST_ROWS),
                        .below = at_most(def->rows - (first + own), WEFT_GHOST_ROWS) };
}

void weft__grid_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    cloth->band = band_of(def);
    cloth->rows = cloth->band.above + cloth->band.own + cloth->band.below;
    cloth->cols = def->cols;
    cloth->particles = cloth->rows * def->cols;
    cloth->scale = def->scale;
    cloth->drag = def->drag;
    cloth->wind_drag = def->wind_drag;
    memcpy(cloth->spacing, def->spacing, sizeof cloth->spacing);
    memcpy(cloth->origin, def->origin, sizeof cloth->origin);
    memcpy(cloth->velocity, def->velocity, sizeof cloth->velocity);
    memcpy(cloth->gravity, def->gravity, sizeof cloth->gravity);
    memcpy(cloth->wind_velocity, def->wind_velocity, sizeof cloth->wind_velocity);
    normalise(def->right, cloth->right);
    normalise(def->down, cloth->down);
}

static weft_status allocate(weft_cloth *cloth, weft_error *err)
{
    const size_t n = cloth->particles;
    const weft_allocator *memory = &cloth->memory;
    cloth->mass = weft__alloc(memory, n, sizeof *cloth->mass);
    cloth->inverse_mass
        = weft__zeroed(memory, n + WEFT_PAST, sizeof *cloth->inverse_mass);
    cloth->pin = weft__zeroed(memory, n, sizeof *cloth->pin);
    cloth->motions
        = weft__zeroed(memory, cloth->motion_count + 1, sizeof *cloth->motions);
    cloth->shapes = weft__alloc(memory, cloth->shape_count, sizeof *cloth->shapes);
    if (cloth->mass == NULL || cloth->inverse_mass == NULL || cloth->pin == NULL
        || cloth->motions == NULL || cloth->shapes == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu particles", n);
    }
    return WEFT_OK;
}

weft_status weft__start_crossing_error(const weft_cloth *cloth, weft_error *err)
{
    if (!cloth->contact.self) {
        return WEFT_OK;
    }
    double *y = weft__alloc(&cloth->memory, weft_cloth_dim(cloth), sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    weft_cloth_start(cloth, y);
    const weft_status status = weft__crossing_error(cloth, y, SIZE_MAX, "", err);
    weft__free(&cloth->memory, y);
    return status;
}

/* All of a cloth that has its plain fields. */
static weft_status fill(weft_cloth *cloth, const weft_cloth_def *def, weft_error *err)
{
    weft_status status = allocate(cloth, err);
    if (status != WEFT_OK) {
        return status;
    }
    weft__groups_init(cloth, def);
    cloth->rigidity = weft__rigidity_of(def);
    masses_init(cloth, def);
    pins_init(cloth, def);
    shapes_init(cloth, def);
    status = list_pins(cloth, err);
    status = status == WEFT_OK ? check_numbers(cloth, err) : status;
    return status == WEFT_OK ? weft__start_crossing_error(cloth, err) : status;
}

weft_status weft__shape_make(const weft_cloth *cloth, const weft_shape *def,
                             double since, size_t index, weft__shape *out,
                             weft_error *err)
{
    weft__refusal first = { WEFT_OK, err };
    if (def == NULL) {
        return weft_error_set(err, WEFT_INVALID, "shapes[%zu] is NULL", index);
    }
    if (!weft__shape_check(def, index, &(weft__faults){ weft__keep_first, &first })) {
        return first.status;
    }
    *out = weft__shape_of(def, cloth->contact.friction);
    out->motion.since = since;
    return can_move(&out->motion)
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID,
                                "the motions of shapes are too large or too small for "
                                "a double");
}

weft_status weft_cloth_create(const weft_cloth_def *def, weft_cloth **out,
                              weft_error *err)
{
    if (weft__given(def, out, "weft_cloth_create", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    *out = NULL;
    weft__refusal first = { WEFT_OK, err };
    weft__cloth_def_check(def, &(weft__faults){ weft__keep_first, &first });
    if (first.status != WEFT_OK) {
        return first.status;
    }
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    weft_cloth *cloth = weft__zeroed(&memory, 1, sizeof *cloth);
    if (cloth == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a cloth");
    }
    weft__grid_init(cloth, def);
    cloth->motion_count = def->pin_count;
    cloth->shape_count = def->contact.shape_count;
    cloth->memory = memory;
    weft_status status = weft__level_find(getenv("WEFT_ISA"), &cloth->level, err);
    if (status == WEFT_OK) {
        status = fill(cloth, def, err);
    }
    if (status != WEFT_OK) {
        weft_cloth_destroy(cloth);
        return status;
    }
    *out = cloth;
    return WEFT_OK;
}

void weft_cloth_destroy(weft_cloth *cloth)
{
    if (cloth != NULL) {
        const weft_allocator memory = cloth->memory;
        if (cloth->defined_pin == NULL) { /* no copy */
            weft__free(&memory, cloth->mass);
            weft__free(&memory, cloth->motions);
        }
        weft__free(&memory, cloth->inverse_mass);
        weft__free(&memory, cloth->pin);
        weft__free(&memory, cloth->pins);
        weft__free(&memory, cloth->coast);
        weft__free(&memory, cloth->shapes);
        weft__free(&memory, cloth);
    }
}

void weft_cloth_start(const weft_cloth *cloth, double *y)
{
    const size_t n = cloth->particles;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            const size_t i = r * cloth->cols + c;
            double x[3], v[6];
            weft__start_position(cloth, r, c, x);
            memcpy(v, cloth->velocity, sizeof cloth->velocity);
            if (cloth->pin[i] != 0) {
                weft__pin_rate(cloth, i, 0.0, v);
            }
            for (size_t k = 0; k < 3; ++k) {
                y[k * n + i] = x[k];
                y[(k + 3) * n + i] = v[k];
            }
        }
    }
}

void weft_cloth_rest(const weft_cloth *cloth, double *xyz)
{
    for (size_t i = 0; i < cloth->particles; ++i) {
        weft__rest_position(cloth, i / cloth->cols, i % cloth->cols, &xyz[3 * i]);
    }
}

size_t weft_cloth_rows(const weft_cloth *cloth)
{
    return cloth->rows;
}

size_t weft_cloth_cols(const weft_cloth *cloth)
{
    return cloth->cols;
}

size_t weft_cloth_particles(const weft_cloth *cloth)
{
    return cloth->particles;
}

size_t weft_cloth_dim(const weft_cloth *cloth)
{
    return 6 * cloth->particles;
}

weft_band weft_cloth_band(const weft_cloth *cloth)
{
    return cloth->band;
}

size_t weft_cloth_springs(const weft_cloth *cloth, weft_family family)
{
    const size_t first = cloth->band.above, end = first + cloth->band.own;
    size_t springs = 0;
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        if (group->family == family) {
            springs += (at_most(end, group->end_row) - at_most(first, group->end_row))
                       * (group->end_col - group->first_col);
        }
    }
    return springs;
}

size_t weft_cloth_pins(const weft_cloth *cloth)
{
    const size_t first = cloth->band.above * cloth->cols;
    const size_t end = first + cloth->band.own * cloth->cols;
    size_t pins = 0;
    for (size_t j = 0; j < cloth->pinned; ++j) {
        pins += cloth->pins[j] >= first && cloth->pins[j] < end;
    }
    return pins;
}

size_t weft_cloth_bytes(const weft_cloth *cloth)
{
    const size_t each
        = sizeof *cloth->mass + sizeof *cloth->inverse_mass + sizeof *cloth->pin;
    return sizeof *cloth + cloth->particles * each
           + WEFT_PAST * sizeof *cloth->inverse_mass
           + cloth->pinned * sizeof *cloth->pins
           + (cloth->motion_count + 1) * sizeof *cloth->motions
           + cloth->shape_count * sizeof *cloth->shapes;
}

double weft__row_mass(const weft_cloth *cloth, size_t r)
{
    double mass = 0.0;
    for (size_t c = 0; c < cloth->cols; ++c) {
        mass += cloth->mass[r * cloth->cols + c];
    }
    return mass;
}

double weft_cloth_mass(const weft_cloth *cloth)
{
    double mass = 0.0;
    for (size_t r = 0; r < cloth->band.own; ++r) {
        mass += weft__row_mass(cloth, cloth->band.above + r);
    }
    return mass;
}

double weft_cloth_particle_mass(const weft_cloth *cloth, size_t i)
{
    return cloth->mass[i];
}

bool weft_cloth_pinned(const weft_cloth *cloth, size_t i)
{
    return cloth->pin[i] != 0;
}
