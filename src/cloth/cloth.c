/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth.c -- a cloth from its definition: masses, pins, the state at rest. */
#include "cloth/grids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/sized.h"
#include "cloth/cloth_slice.h"
#include "mesh/grid_def.h"
#include "mesh/pins.h"
#include "mesh/triangles.h"

void weft_cloth_def_init(weft_cloth_def *def, size_t size)
{
    weft_cloth_def start = {
        .struct_size = (uint32_t)size,
        .rows = 2,
        .cols = 2,
        .spacing = { 1.0, 1.0 },
        .right = { 1.0, 0.0, 0.0 },
        .down = { 0.0, -1.0, 0.0 },
        .scale = 1.0,
        .density = 0.2,
        .bending = { .twist = -1.0 },
        .gravity = { 0.0, -9.81, 0.0 },
    };
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->tables.defaults != NULL) {
            weft__table[k].force->tables.defaults(&start);
        }
    }
    weft__sized_write(def, size, &start, sizeof start);
}

static weft_status list_pins(weft_cloth *cloth, weft_error *err)
{
    cloth->mesh.pins
        = weft__alloc(&cloth->memory, cloth->mesh.pinned, sizeof *cloth->mesh.pins);
    if (cloth->mesh.pins == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu pins",
                              cloth->mesh.pinned);
    }
    weft__list_pins(&cloth->mesh);
    return WEFT_OK;
}

static weft_status cloth_allocate(weft_cloth *cloth, weft_error *err)
{
    const size_t n = cloth->mesh.particles;
    const weft_allocator *memory = &cloth->memory;
    cloth->mesh.mass = weft__alloc(memory, n, sizeof *cloth->mesh.mass);
    cloth->mesh.inverse_mass
        = weft__zeroed(memory, n + WEFT_PAST, sizeof *cloth->mesh.inverse_mass);
    cloth->mesh.pin = weft__zeroed(memory, n, sizeof *cloth->mesh.pin);
    cloth->mesh.motions = weft__zeroed(memory, cloth->mesh.motion_count + 1,
                                       sizeof *cloth->mesh.motions);
    if (cloth->mesh.mass == NULL || cloth->mesh.inverse_mass == NULL
        || cloth->mesh.pin == NULL || cloth->mesh.motions == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu particles", n);
    }
    return WEFT_OK;
}

static weft_status passage_error(const weft_cloth *cloth, const double *y,
                                 weft_error *err)
{
    weft_passage first;
    char text[WEFT__PASSAGE_TEXT];
    const size_t count = cloth->strict ? weft_cloth_passages(cloth, 0.0, y, &first) : 0;
    return count == 0 ? WEFT_OK
                      : weft_error_set(
                          err, WEFT_INVALID, "contact.strict: %s",
                          weft__passage_text(cloth, 0.0, &first, (double)count, text));
}

/* Of the shape at rest; *crosses: whether a force looks for crossings. */
static weft_status rest_error(const weft_cloth *cloth, bool *crosses, weft_error *err)
{
    weft_status status = WEFT_OK;
    *crosses = false;
    for (size_t k = 0; k < WEFT__FORCES && status == WEFT_OK; ++k) {
        const weft__force_checks *of = &weft__table[k].force->checks;
        status = of->start != NULL ? of->start(weft__own(cloth, k), err) : WEFT_OK;
        *crosses
            = *crosses || (of->crossing != NULL && weft__force_at(cloth, k) != NULL);
    }
    return status;
}

weft_status weft__start_crossing_error(const weft_cloth *cloth, weft__stop *stop,
                                       weft_error *err)
{
    const weft__search of = { .stop = stop };
    bool crosses;
    TRY(rest_error(cloth, &crosses, err));
    if (cloth->untangle > 0.0 || !(crosses || cloth->strict)) {
        return WEFT_OK;
    }
    double *y = weft__alloc(&cloth->memory, weft_cloth_dim(cloth), sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    weft_cloth_start(cloth, y);
    weft_status status = weft__crossings_error(cloth, 0.0, y, &of, err);
    status = status == WEFT_OK ? passage_error(cloth, y, err) : status;
    weft__free(&cloth->memory, y);
    return status;
}

static void attach(weft_cloth *cloth)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        *(const weft__mesh **)weft__own_of(cloth, k) = &cloth->mesh;
    }
    WEFT_FORCE_LINKS(cloth)
    weft__grids_attach(cloth);
}

void weft__cloth_choose(weft_cloth *cloth, weft__isa isa)
{
    cloth->isa = isa;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->tables.choose != NULL) {
            weft__table[k].force->tables.choose(weft__own_of(cloth, k), isa);
        }
    }
    weft__grids_choose(cloth);
}

const char *weft_cloth_isa(const weft_cloth *cloth)
{
    return weft__isa_name(cloth->isa);
}

/* Room for the rows of the paths. */
static weft_status make_rows(weft_cloth *cloth, const weft_cloth_def *def,
                             weft_error *err)
{
    size_t count = 0;
    for (size_t i = 0; i < def->pin_count; ++i) {
        count += def->pins[i].path.count;
    }
    cloth->rows
        = weft__alloc(&cloth->memory, WEFT__CURVE_WIDTH * count, sizeof *cloth->rows);
    if (cloth->rows == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu rows", count);
    }
    cloth->row_count = count;
    return WEFT_OK;
}

/* All of a cloth that has its plain fields; stop_ctx of the definition is a weft__stop.
 */
static weft_status cloth_fill(weft_cloth *cloth, const weft_cloth_def *def,
                              weft_error *err)
{
    weft__stop *stop = def->stop_ctx;
    TRY(cloth_allocate(cloth, err));
    TRY(make_rows(cloth, def, err));
    weft__mesh_fill(&cloth->mesh, def, cloth->rows);
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__stops(stop)
            || !weft__table[k].force->tables.init(weft__own_of(cloth, k), def,
                                                  &cloth->memory)) {
            return stop->came ? weft__stopped(err)
                              : weft_error_set(err, WEFT_NO_MEMORY, "no memory for %s",
                                               weft__table[k].force->name);
        }
    }
    if (!weft__grids_init(cloth, def)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for grids");
    }
    TRY(weft__cloth_slice(cloth, def, err));
    TRY(list_pins(cloth, err));
    return weft__start_crossing_error(cloth, stop, err);
}

/* The elements of an array of the caller's in the size that they have here. */
static weft_status take_items(const char *name, const void *items, size_t count,
                              size_t given, size_t size, const weft_allocator *memory,
                              void **copy, weft_error *err)
{
    if (given == size || items == NULL) {
        return WEFT_OK;
    }
    char *to = *copy = weft__zeroed(memory, count, size);
    if (to == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a cloth");
    }
    bool understood = given > 0;
    for (size_t i = 0; understood && i < count; ++i) {
        understood = weft__sized_read(to + i * size, size,
                                      (const char *)items + i * given, given);
    }
    return understood ? WEFT_OK : weft__sized_unknown(name, err);
}

enum { ARRAYS = 4, COPIES = ARRAYS + WEFT__FORCES + 1 };

/* The arrays of the forces. */
static weft_status take_arrays(weft_cloth_def *def, const weft_allocator *memory,
                               void *copies[WEFT__FORCES], weft_error *err)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__def_array *of = weft__table[k].force->tables.array;
        if (of != NULL) {
            const void *items = weft__array_items(of, def);
            TRY(take_items(of->type, items, weft__array_count(of, def),
                           weft__array_size(of, def), of->size, memory, &copies[k],
                           err));
            items = copies[k] != NULL ? copies[k] : items;
            memcpy((char *)def + of->items, &items, sizeof items);
        }
    }
    return WEFT_OK;
}

/* The definitions of grids among several cloths. */
static weft_status take_grids(weft_mesh_def *mesh, const weft_allocator *memory,
                              void **copy, weft_error *err)
{
    const size_t count = mesh->grids != NULL ? mesh->part_count : 0;
    weft_status status = WEFT_OK;
    if (count == 0 || count > WEFT_CLOTHS_MAX) { /* too many: refused later */
        mesh->grids = NULL;
        return WEFT_OK;
    }
    weft_cloth_def *list = *copy
        = weft__alloc(memory, count, sizeof *list + sizeof *mesh->grids);
    if (list == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a cloth");
    }
    const weft_cloth_def **to = (void *)(list + count);
    for (size_t k = 0; k < count; ++k) {
        const weft_cloth_def *given = mesh->grids[k];
        to[k] = given != NULL ? &list[k] : NULL;
        if (given != NULL && status == WEFT_OK) {
            status
                = WEFT__DEF_READ(weft_cloth_def, &list[k], given, WEFT__DEF_MOST, err);
        }
    }
    mesh->grids = to;
    return status;
}

/* The caller's definition, of any version, with copies of its arrays where they are of
 * another one. */
static weft_status take_def(weft_cloth_def *def, weft_mesh_def *mesh,
                            const weft_cloth_def *given, void *copies[COPIES],
                            weft_error *err)
{
    TRY(WEFT__DEF_READ(weft_cloth_def, def, given, WEFT__DEF_MOST, err));
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    *mesh = weft_mesh_def_default();
    if (def->mesh != NULL) {
        TRY(WEFT__DEF_READ(weft_mesh_def, mesh, def->mesh, WEFT__DEF_MOST, err));
        def->mesh = mesh;
    }
    const struct {
        const char *name;
        const void *items;
        size_t count, given, size;
    } arrays[ARRAYS] = {
        { "weft_load", def->loads, def->load_count, def->load_size,
          sizeof *def->loads },
        { "weft_pin", def->pins, def->pin_count, def->pin_size, sizeof *def->pins },
        { "weft_fabric", mesh->fabrics, mesh->fabric_count, mesh->fabric_size,
          sizeof *mesh->fabrics },
        { "weft_rest", mesh->rests, mesh->part_count > 0 ? mesh->part_count : 1,
          mesh->rest_size, sizeof *mesh->rests },
    };
    for (size_t i = 0; i < ARRAYS; ++i) {
        TRY(take_items(arrays[i].name, arrays[i].items, arrays[i].count,
                       arrays[i].given, arrays[i].size, &memory, &copies[i], err));
    }
    def->loads = copies[0] != NULL ? copies[0] : def->loads;
    def->pins = copies[1] != NULL ? copies[1] : def->pins;
    mesh->fabrics = copies[2] != NULL ? copies[2] : mesh->fabrics;
    mesh->rests = copies[3] != NULL ? copies[3] : mesh->rests;
    TRY(take_arrays(def, &memory, &copies[ARRAYS], err));
    return take_grids(mesh, &memory, &copies[COPIES - 1], err);
}

/* Gives the triangles that the check made, also where it fails. */
static weft_status cloth_check(const weft_cloth_def *def, weft__triangles **triangles,
                               weft_error *err)
{
    weft__refusal first = { WEFT_OK, err };
    bool no_memory;
    weft__cloth_def_check(def, &(weft__faults){ weft__keep_first, &first }, triangles,
                          &no_memory);
    if (first.status == WEFT_OK && no_memory) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for triangles");
    }
    return first.status != WEFT_OK ? first.status : weft__slice_check(def, err);
}

static weft_status cloth_create(const weft_cloth_def *def, weft_cloth **out,
                                weft_error *err)
{
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    weft__triangles *triangles;
    weft_status status = cloth_check(def, &triangles, err);
    weft_cloth *cloth
        = status == WEFT_OK ? weft__zeroed(&memory, 1, sizeof *cloth) : NULL;
    if (cloth == NULL) {
        weft__triangles_destroy(triangles, &memory);
        return status != WEFT_OK
                   ? status
                   : weft_error_set(err, WEFT_NO_MEMORY, "no memory for a cloth");
    }
    weft__mesh_init(&cloth->mesh, def, triangles);
    attach(cloth);
    cloth->mesh.motion_count = def->pin_count;
    cloth->memory = memory;
    cloth->untangle = def->untangle;
    cloth->strict = def->strict;
    cloth->log = def->log;
    cloth->stop = *(const weft__stop *)def->stop_ctx;
    status = weft__isa_find(getenv("WEFT_ISA"), &cloth->isa, err);
    if (status == WEFT_OK) {
        weft__cloth_choose(cloth, cloth->isa);
        status = cloth_fill(cloth, def, err);
        weft__cloth_choose(cloth, cloth->isa); /* by what they are now, too */
    }
    if (status != WEFT_OK) {
        weft_cloth_destroy(cloth);
        return status;
    }
    *out = cloth;
    return WEFT_OK;
}

weft_status weft_cloth_create(const weft_cloth_def *given, weft_cloth **out,
                              weft_error *err)
{
    weft_cloth_def def;
    weft_mesh_def mesh;
    void *copies[COPIES] = { NULL };
    TRY(weft__given(given, out, "weft_cloth_create", err));
    *out = NULL;
    weft_status status = take_def(&def, &mesh, given, copies, err);
    weft__stop stop = { .ask = def.stop, .ctx = def.stop_ctx };
    def.stop = weft__stop_ask, def.stop_ctx = &stop;
    status = status == WEFT_OK ? cloth_create(&def, out, err) : status;
    if (status == WEFT_OK && weft__is_band(&def) && weft__cloth_gathers(*out)) {
        def.band_first = def.band_rows = 0;
        status = cloth_create(&def, &(*out)->whole, err);
    }
    if (status != WEFT_OK) {
        weft_cloth_destroy(*out);
        *out = NULL;
    }
    const weft_allocator memory = weft_allocator_or_malloc(def.allocator);
    for (size_t i = 0; i < COPIES; ++i) {
        weft__free(&memory, copies[i]);
    }
    return status;
}

void weft_cloth_destroy(weft_cloth *cloth)
{
    if (cloth != NULL) {
        const weft_allocator memory = cloth->memory;
        if (!cloth->copied) {
            WEFT__FREE_ALL(&memory, cloth->mesh.mass, cloth->mesh.motions, cloth->rows,
                           cloth->mesh.whole_of);
            weft__triangles_destroy(cloth->mesh.triangles, &memory);
            weft_cloth_destroy(cloth->whole);
        }
        WEFT__FREE_ALL(&memory, cloth->mesh.inverse_mass, cloth->mesh.pin,
                       cloth->mesh.pins, cloth->mesh.coast, cloth->grids);
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            if (weft__table[k].force->tables.free != NULL) {
                weft__table[k].force->tables.free(weft__own_of(cloth, k), &memory);
            }
        }
        weft__free(&memory, cloth);
    }
}

weft_cloth *weft__cloth_copy(const weft_cloth *model, const weft_allocator *memory)
{
    const weft__mesh *from = &model->mesh;
    const size_t n = from->particles;
    weft_cloth *copy = weft__alloc(memory, 1, sizeof *copy);
    if (copy == NULL) {
        return NULL;
    }
    *copy = *model;
    copy->memory = *memory;
    copy->copied = true;
    weft__mesh *mesh = &copy->mesh;
    mesh->defined_pin = from->defined_pin != NULL ? from->defined_pin : from->pin;
    mesh->pin = weft__alloc(memory, n, sizeof *mesh->pin);
    mesh->pins = weft__alloc(memory, n, sizeof *mesh->pins);
    mesh->coast = weft__alloc(memory, 3 * n, sizeof *mesh->coast);
    mesh->inverse_mass
        = weft__zeroed(memory, n + WEFT_PAST, sizeof *mesh->inverse_mass);
    bool made = mesh->pin != NULL && mesh->pins != NULL && mesh->coast != NULL
                && mesh->inverse_mass != NULL;
    made = weft__grids_copy(copy) && made;
    attach(copy);
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->tables.copy != NULL) {
            made = weft__table[k].force->tables.copy(weft__own_of(copy, k), memory)
                   && made;
        }
    }
    if (!made) {
        weft_cloth_destroy(copy);
        return NULL;
    }
    memcpy(mesh->pin, from->pin, n * sizeof *mesh->pin);
    if (from->coast != NULL) { /* a copy itself */
        memcpy(mesh->coast, from->coast, 3 * n * sizeof *mesh->coast);
    }
    weft__list_pins(mesh);
    return copy;
}

void weft_cloth_start(const weft_cloth *cloth, double *y)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t i = 0; i < n; ++i) {
        double x[3], v[6];
        weft__start_position(mesh, i, x);
        memcpy(v, weft__start_velocity(mesh, i), sizeof mesh->velocity);
        if (mesh->pin[i] != 0) {
            weft__pin_rate(mesh, i, 0.0, 0.0, v);
        }
        for (size_t k = 0; k < 3; ++k) {
            y[k * n + i] = x[k];
            y[(k + 3) * n + i] = v[k];
        }
    }
}

void weft_cloth_rest(const weft_cloth *cloth, double *xyz)
{
    weft__rest_positions(&cloth->mesh, xyz);
}

size_t weft_cloth_rows(const weft_cloth *cloth)
{
    return cloth->mesh.rows;
}

size_t weft_cloth_cols(const weft_cloth *cloth)
{
    return cloth->mesh.cols;
}

size_t weft_cloth_particles(const weft_cloth *cloth)
{
    return cloth->mesh.particles;
}

size_t weft_cloth_dim(const weft_cloth *cloth)
{
    return 6 * cloth->mesh.particles;
}

weft_band weft_cloth_band(const weft_cloth *cloth)
{
    return cloth->mesh.band;
}

size_t weft_cloth_springs(const weft_cloth *cloth, weft_family family)
{
    size_t count = weft__springs_count(&cloth->springs, family);
    for (size_t g = 0; g < cloth->grid_count; g += 2) {
        count += weft__springs_count(&cloth->grids[g].springs, family);
    }
    return count;
}

size_t weft_cloth_pins(const weft_cloth *cloth)
{
    const weft_band band = cloth->mesh.band;
    const size_t first = weft__block(&cloth->mesh, band.above);
    const size_t end = weft__block(&cloth->mesh, band.above + band.own);
    size_t pins = 0;
    for (size_t j = 0; j < cloth->mesh.pinned; ++j) {
        pins += cloth->mesh.pins[j] >= first && cloth->mesh.pins[j] < end;
    }
    return pins;
}

size_t weft_cloth_bytes(const weft_cloth *cloth)
{
    const size_t each = sizeof *cloth->mesh.mass + sizeof *cloth->mesh.inverse_mass
                        + sizeof *cloth->mesh.pin;
    size_t more
        = cloth->mesh.triangles == NULL
              ? 0
              : weft__triangles_bytes(cloth->mesh.triangles, cloth->mesh.particles);
    if (cloth->mesh.whole_of != NULL) { /* numbers and places of others */
        const weft__mesh *by = &cloth->mesh;
        more += (by->whole - by->particles)
                * (sizeof *by->triangles->vertex + sizeof *by->triangles->of_vertex
                   + sizeof *by->triangles->rest + sizeof *by->triangles->particle
                   + sizeof *by->triangles->mirrored);
    }
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        more += force != NULL && force->tables.bytes != NULL
                    ? force->tables.bytes(weft__own(cloth, k))
                    : 0;
    }
    more += cloth->whole != NULL ? weft_cloth_bytes(cloth->whole) : 0;
    return sizeof *cloth + more + cloth->grid_count * sizeof *cloth
           + cloth->mesh.particles * each + WEFT_PAST * sizeof *cloth->mesh.inverse_mass
           + cloth->mesh.pinned * sizeof *cloth->mesh.pins
           + WEFT__CURVE_WIDTH * cloth->row_count * sizeof *cloth->rows
           + (cloth->mesh.motion_count + 1) * sizeof *cloth->mesh.motions;
}

double weft__block_mass(const weft_cloth *cloth, size_t b)
{
    double mass = 0.0;
    for (size_t i = weft__block(&cloth->mesh, b); i < weft__block(&cloth->mesh, b + 1);
         ++i) {
        mass += cloth->mesh.mass[i];
    }
    return mass;
}

double weft_cloth_mass(const weft_cloth *cloth)
{
    double mass = 0.0;
    for (size_t b = 0; b < cloth->mesh.band.own; ++b) {
        mass += weft__block_mass(cloth, cloth->mesh.band.above + b);
    }
    return mass;
}

double weft_cloth_particle_mass(const weft_cloth *cloth, size_t i)
{
    return cloth->mesh.mass[weft__meant(&cloth->mesh, i)];
}

bool weft_cloth_pinned(const weft_cloth *cloth, size_t i)
{
    return cloth->mesh.pin[weft__meant(&cloth->mesh, i)] != 0;
}
