/* SPDX-License-Identifier: BSD-3-Clause */
/* validate.c -- checks the definition of a cloth and reports every fault. Comparisons
 * are written so that NaN fails. */
#include "base/memory.h"
#include "cloth/grids.h"
#include "mesh/grid_def.h"
#include "mesh/track.h"
#include "mesh/triangles_work.h"

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

/* Of pins. */
static void check_motions(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        const weft__motion motion
            = weft__motion_of(pin->velocity, pin->amplitude, pin->frequency);
        size_t row;
        const char *fault = weft__track_fault(&pin->path, &row);
        (void)WEFT__NUMBERS_CHECK(weft__pin_numbers, pin, to, "pin %zu: ", i);
        if (!weft__motion_usable(&motion)) {
            weft__fault(to, FIELD(pins), FIELD(pins),
                        "pin %zu: its motion is too large or too small for a double",
                        i);
        }
        if (fault != NULL) {
            weft__fault(to, FIELD(pins), FIELD(pins), "pin %zu: path: row %zu %s", i,
                        row, fault);
        }
    }
}

static bool validate_check_arrays(const weft_cloth_def *def, const weft__faults *to)
{
    const char *missing = def->load_count > 0 && def->loads == NULL ? "loads"
                          : def->pin_count > 0 && def->pins == NULL ? "pins"
                                                                    : NULL;
    for (size_t k = 0; k < WEFT__FORCES && missing == NULL; ++k) {
        const weft__def_array *of = weft__table[k].force->tables.array;
        missing = of != NULL && weft__array_count(of, def) > 0
                          && weft__array_items(of, def) == NULL
                      ? of->name
                      : NULL;
    }
    if (missing != NULL) {
        weft__fault(to, FIELD(loads), FIELD(loads),
                    "%s is NULL, but their number is not 0", missing);
    }
    return missing == NULL;
}

static void check_forces(const weft_cloth_def *def, const weft__faults *to)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->tables.check != NULL) {
            weft__table[k].force->tables.check(def, to);
        }
    }
}

void weft__sheet_check(const weft_cloth_def *def, const weft__faults *to)
{
    check_mass(def, to);
    for (size_t i = 0; i < def->pin_count; ++i) {
        weft__ranges_check(def, to, "pin", i, def->pins[i].rows, def->pins[i].cols);
    }
    check_motions(def, to);
    check_forces(def, to);
}

/* ---- triangles ------------------------------------------------------------------- */

/* A fault of a part of a mesh, as one of the member `mesh`. */
static void keep_fault(void *ctx, weft__mesh_part part, size_t index,
                       const char *message)
{
    (void)part, (void)index;
    weft__fault(ctx, FIELD(mesh), FIELD(mesh), "%s", message);
}

typedef struct fabric_fault {
    const weft__mesh_faults *to;
    size_t fabric;
} fabric_fault;

static void keep_fabric_fault(void *ctx, size_t field, size_t other,
                              const char *message)
{
    const fabric_fault *at = ctx;
    (void)field, (void)other;
    at->to->found(at->to->ctx, WEFT__MESH_FABRIC, at->fabric, message);
}

/* C12^2 < C11 C22: else there is strain without energy. */
static void check_fabrics(const weft_mesh_def *mesh, const weft__mesh_faults *parts)
{
    for (size_t i = 0; mesh->fabrics != NULL && i < mesh->fabric_count; ++i) {
        const weft_fabric *of = &mesh->fabrics[i];
        fabric_fault at = { parts, i };
        const weft__faults to = { keep_fabric_fault, &at };
        const double most = of->stretch[0] * of->stretch[1];
        if (WEFT__NUMBERS_CHECK(weft__fabric_numbers, of, &to, "fabric %zu: ", i)
            && !(of->coupling * of->coupling < most)) {
            weft__fault(
                &to, 0, 0,
                "fabric %zu: coupling %g N/m: its square must be below stretch[0] "
                "stretch[1] = %g N^2/m^2",
                i, of->coupling, most);
        }
    }
}

static bool check_vertices(const weft_cloth_def *def, const char *what, size_t index,
                           const size_t *vertices, size_t count, const weft__faults *to)
{
    if (vertices == NULL && count > 0) {
        weft__fault(to, FIELD(mesh), FIELD(mesh),
                    "%s %zu: vertices is NULL, but their number is not 0", what, index);
        return false;
    }
    for (size_t k = 0; k < count; ++k) {
        if (vertices[k] >= def->mesh->vertices) {
            weft__fault(to, FIELD(mesh), FIELD(mesh), "%s %zu: vertex %zu of %zu", what,
                        index, vertices[k], def->mesh->vertices);
            return false;
        }
    }
    return true;
}

/* A vertex weighs at least a third of the lightest triangle, and less than all. */
static void check_vertex_masses(const weft_cloth_def *def, const weft__faults *to)
{
    const weft_mesh_def *mesh = def->mesh;
    double least = DBL_MAX, sum = 0.0, longest; /* grids are checked by themselves */
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const weft_fabric *of
            = &mesh->fabrics[mesh->fabric_of != NULL ? mesh->fabric_of[t] : 0];
        const double area = 0.5 * fabs(weft__twice_area(mesh, t, &longest));
        const double share = of->density * area / 3.0;
        least = fmin(least, share);
        sum += 3.0 * share;
    }
    for (size_t i = 0; i < def->load_count; ++i) {
        sum += (double)def->loads[i].vertex_count * def->loads[i].mass;
    }
    if (!(isfinite(sum) && isfinite(1.0 / least))) {
        weft__fault(to, FIELD(mesh), FIELD(mesh),
                    "the masses are too large or too small for a double");
    }
}

/* The vertices of loads and pins. */
static bool check_held(const weft_cloth_def *def, const weft__faults *to)
{
    bool good = true;
    for (size_t i = 0; i < def->load_count; ++i) {
        const weft_load *load = &def->loads[i];
        good = weft__numbers_check(&weft__load_mass, 1, load, to, "load %zu: ", i)
               && good;
        good = check_vertices(def, "load", i, load->vertices, load->vertex_count, to)
               && good;
    }
    for (size_t i = 0; i < def->pin_count; ++i) {
        good = check_vertices(def, "pin", i, def->pins[i].vertices,
                              def->pins[i].vertex_count, to)
               && good;
    }
    return good;
}

/* A fault of a grid among several cloths, as one of the member `mesh`. */
typedef struct grid_fault {
    const weft__mesh_faults *to;
    const char *name;
    bool found;
} grid_fault;

static void keep_grid_fault(void *ctx, size_t field, size_t other, const char *message)
{
    grid_fault *at = ctx;
    char text[256];
    (void)field, (void)other;
    (void)weft_text_format(text, sizeof text, "%s: %s", at->name, message);
    at->to->found(at->to->ctx, WEFT__MESH_DEF, 0, text);
    at->found = true;
}

/* Whether all grids among several cloths are good: before triangles are made. */
static bool check_grids(const weft_cloth_def *def, const weft__mesh_faults *parts)
{
    const weft_mesh_def *mesh = def->mesh;
    grid_fault at = { .to = parts };
    const weft__faults to = { keep_grid_fault, &at };
    for (size_t k = 0;
         mesh->grids != NULL && mesh->parts != NULL && k < mesh->part_count; ++k) {
        if (mesh->grids[k] == NULL) {
            continue;
        }
        const weft_cloth_def grid = weft__grid_def_of(def, k);
        at.name = mesh->parts[k].name != NULL ? mesh->parts[k].name : "";
        if (!weft__grid_check(&grid, MAX_PARTICLES, &to) || at.found) {
            continue;
        }
        if (grid.rows < 2 || grid.cols < 2) {
            weft__fault(
                &to, FIELD(rows), FIELD(cols),
                "a grid of %zu x %zu has no triangles, by which it touches "
                "other cloths: among several it has 2 rows and 2 columns or more",
                grid.rows, grid.cols);
        }
        weft__sheet_check(&grid, &to);
    }
    return !at.found;
}

void weft__mesh_check(const weft_cloth_def *def, const weft__mesh_faults *parts,
                      const weft__faults *to, weft__triangles **triangles,
                      bool *no_memory)
{
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    const weft__mesh_faults all = { keep_fault, (void *)to };
    parts = parts != NULL ? parts : &all;
    *no_memory = false;
    check_fabrics(def->mesh, parts);
    const bool valid
        = check_grids(def, parts)
          && weft__triangles_create(triangles, def->mesh, &memory, parts, no_memory);
    if (check_held(def, to) && valid) {
        check_vertex_masses(def, to);
    }
    if (valid) {
        check_motions(def, to);
        check_forces(def, to);
    }
}

void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to,
                           weft__triangles **triangles, bool *no_memory)
{
    *triangles = NULL;
    *no_memory = false;
    if (!validate_check_arrays(def, to)) {
        return;
    }
    if (def->mesh != NULL) {
        weft__mesh_check(def, NULL, to, triangles, no_memory);
    } else if (weft__grid_check(def, MAX_PARTICLES, to)) {
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

bool weft__def_slows(const weft_cloth_def *def)
{
    bool slows = false;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__table[k].force;
        slows = slows || (force->tables.slows != NULL && force->tables.slows(def));
    }
    return slows;
}
