/* SPDX-License-Identifier: BSD-3-Clause */
/* keys.c -- THE table: every key of a scene, once. */
#include "scene/keys.h"

#include <math.h>

#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "plugin/methods.h"
#include "scene/checks.h"
#include "scene/contact/contact_checks.h"

#define COUNT(array)   (sizeof(array) / sizeof(array)[0])
#define AT(type, name) .at = offsetof(type, name)
/* A number of an owner, which has the offset too, and a range of the scene's own. */
#define NUMBER(numbers, field) .number = &weft__##numbers##_numbers.field
#define RANGE(...)                                                                     \
    .number = &(const weft__number)                                                    \
    {                                                                                  \
        __VA_ARGS__                                                                    \
    }
#define ITEMS(type, field, number, read_one)                                           \
    AT(type, field), .items = &(const struct weft__items)                              \
    {                                                                                  \
        sizeof *((type *)0)->field, offsetof(type, number) - offsetof(type, field),    \
            read_one                                                                   \
    }
#define KEYS(of) .keys = of##_keys, .count = COUNT(of##_keys)
/* A section of one key, with rules between its keys or without. */
#define WITH(...)                                                                      \
    .section = &(const weft__section)                                                  \
    {                                                                                  \
        __VA_ARGS__                                                                    \
    }
#define SECTION(of) WITH(KEYS(of))
#define CHECKED(of) WITH(KEYS(of), .check = weft__check_##of)
#define OSCILLATES  .together = { "amplitude", "frequency" }

/* ---- cloth --------------------------------------------------------------------- */

static const weft__key grid_keys[] = {
    { "rows", WEFT__INTEGER, .required = true, NUMBER(grid, rows),
      .meaning = "particles down" },
    { "cols", WEFT__INTEGER, .required = true, NUMBER(grid, cols),
      .meaning = "particles across; rows * cols >= 2, and a single row or column "
                 "makes a chain" },
    { "spacing", WEFT__PAIR, .required = true, NUMBER(grid, spacing),
      .meaning
      = "distance of neighbours: one number, or [row to row, column to column]" },
    { "origin", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(grid, origin),
      .meaning = "rest position of particle (0, 0)" },
    { "right", WEFT__VECTOR, .fallback = "[1, 0, 0]", AT(weft_cloth_def, right),
      .meaning = "direction of increasing column; normalised on reading" },
    { "down", WEFT__VECTOR, .fallback = "[0, -1, 0]", AT(weft_cloth_def, down),
      .meaning = "direction of increasing row; perpendicular to right (1e-9)" },
    { "scale", WEFT__NUMBER, .fallback = "1.0", NUMBER(grid, scale),
      .meaning = "initial positions = origin + scale * (rest - origin); rest "
                 "lengths do not change" },
};

static const weft__key place_keys[] = {
    { "rows", WEFT__INDEX, .absent = "required: rows or row", AT(weft__place, rows),
      .meaning = "row 0 is the top; negative counts from the end" },
    { "row", WEFT__INDEX, .absent = "required: rows or row", AT(weft__place, rows),
      .meaning = "the same" },
    { "cols", WEFT__INDEX, .absent = "required: cols or col", AT(weft__place, cols),
      .meaning = "column 0 is the left; negative counts from the end" },
    { "col", WEFT__INDEX, .absent = "required: cols or col", AT(weft__place, cols),
      .meaning = "the same" },
};

static const weft__section pin_section;

static const weft__section place_section
    = { .title = "a place",
        KEYS(place),
        .check = weft__check_place,
        .beside = &pin_section,
        .beside_hint = "needs 'at' beside it, as in {at: {rows: ..., cols: ...}, "
                       "velocity: [x, y, z]}" };

static const weft__section shape_section;

/* What a load or a pin is on. */
#define WHERE(type)                                                                    \
    { "at",                                                                            \
      WEFT__PLACE,                                                                     \
      .absent = "required for a grid",                                                 \
      .section = &place_section,                                                       \
      AT(type, rows),                                                                  \
      .meaning = "grids only: which particles" },                                      \
        { "vertices", WEFT__VERTEX_LIST, .absent = "none", AT(type, vertices),         \
          .meaning = "meshes only: indices of v in the file, or in the cut, from 0" }, \
        { "group", WEFT__GROUP, .absent = "none", AT(type, vertices),                  \
          .meaning                                                                     \
          = "meshes only: the vertices of the faces and points (f, p) in a group "     \
            "(g) of the file" },                                                       \
        { "near",                                                                      \
          WEFT__NEAREST,                                                               \
          .unit = "m",                                                                 \
          .absent = "none",                                                            \
          AT(type, vertices),                                                          \
          .meaning                                                                     \
          = "meshes only: the vertex that starts nearest to a point, at equal "        \
            "distances the lower index" },                                             \
    {                                                                                  \
        "inside", WEFT__INSIDE,                                                        \
            .section = &shape_section, .absent = "none", AT(type, vertices),           \
            .meaning                                                                   \
            = "meshes only: what starts in a shape, given as in contact.shapes"        \
    }

static const weft__key load_keys[] = {
    WHERE(weft_load),
    { "mass", WEFT__NUMBER, .required = true, .number = &weft__load_mass,
      .meaning = "added to each of these particles" },
};

static const weft__section load_section
    = { .title = "a load",
        KEYS(load),
        .check = weft__check_vertices,
        .beside = &place_section,
        .beside_hint = "goes inside 'at', as in {at: {rows: ..., cols: ...}, mass: "
                       "...}" };

static const char *const spline_names[] = { "monotone", "natural", NULL };
#define TABLE(of, unit_)                                                               \
    static const weft__key of##_table_keys[] = {                                       \
        { "rows", WEFT__TRACK, .required = true, .unit = unit_,                        \
          AT(weft__splined, track), .meaning = "the table" },                          \
        { "spline", WEFT__EITHER, .names = spline_names, .fallback = "monotone",       \
          AT(weft__splined, natural),                                                  \
          .meaning = "natural: a natural cubic spline, for dense samples of a motion;" \
                     " it overshoots rows that are far apart" },                       \
    };
TABLE(pin, "s, m")
/* What may be a list of rows, or a mapping with its spline: where that goes. */
#define SPLINE(type, field)                                                            \
    .first = offsetof(type, field##_natural) - offsetof(type, field)

static const weft__key pin_keys[] = {
    WHERE(weft_pin),
    { "velocity", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(pin, velocity),
      .meaning = "velocity of the pinned particles" },
    { "amplitude", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(pin, amplitude),
      .meaning = "oscillation: + amplitude * sin(2 pi frequency t)" },
    { "frequency", WEFT__NUMBER, .fallback = "0", NUMBER(pin, frequency),
      .meaning = "of the oscillation, together with amplitude" },
    { "path", WEFT__TRACK, SECTION(pin_table), .unit = "s, m", .absent = "none",
      AT(weft_pin, path), SPLINE(weft_pin, path),
      .meaning
      = "displacement path(t) - path(0): smooth, through all rows and between "
        "them within their range, at rest before the first and after the last; "
        "or {rows: ..., spline: natural}" },
};

static const weft__section pin_section
    = { .title = "a pin",
        KEYS(pin),
        OSCILLATES,
        .check = weft__check_pin,
        .beside = &place_section,
        .beside_hint = "cannot stand beside 'at': put it inside, as in {at: {rows: "
                       "..., cols: ...}, ...}" };

static const weft__key stretch_keys[] = {
    { "stiffness", WEFT__WARP_WEFT, .required = true, NUMBER(spring, stiffness),
      .meaning = "stiffness of each spring; a pair: [along a column, along a row]" },
    { "damping", WEFT__WARP_WEFT, .fallback = "0", NUMBER(spring, damping),
      .meaning = "damping along the spring; a pair as well" },
};

static const weft__key shear_keys[] = {
    { "stiffness", WEFT__NUMBER, .required = true, NUMBER(spring, stiffness),
      .meaning = "stiffness of each spring" },
    { "damping", WEFT__NUMBER, .fallback = "0", NUMBER(spring, damping),
      .meaning = "damping along the spring" },
};

#define OF_FAMILY(index)                                                               \
    .at = offsetof(weft_cloth_def, springs) + (index) * sizeof(weft_spring_def)

static const weft__key bend_keys[] = {
    { "stiffness", WEFT__WARP_WEFT, .absent = "required: stiffness or rigidity",
      NUMBER(spring, stiffness), OF_FAMILY(WEFT_BEND),
      .meaning = "stiffness of each spring" },
    { "rigidity", WEFT__PAIR, .absent = "required: stiffness or rigidity",
      NUMBER(bending, rigidity), AT(weft_cloth_def, bending),
      .meaning = "bending stiffness of a plate, which converges under refinement, "
                 "instead of springs; a pair: [along a column, along a row]" },
    { "twist", WEFT__NUMBER, RANGE(.least = 0.0), .unit = "N m",
      .absent = "sqrt of the product of the rigidities",
      AT(weft_cloth_def, bending.twist),
      .meaning = "with rigidity only: stiffness of twisting" },
    { "damping", WEFT__WARP_WEFT, .fallback = "0", NUMBER(spring, damping),
      OF_FAMILY(WEFT_BEND), .unit = "kg/s; with rigidity s",
      .meaning = "damping along the spring; with rigidity a time that multiplies the "
                 "stiffness" },
};

/* The names of an enum are in its order. */
_Static_assert(sizeof(weft_law) == sizeof(unsigned)
                   && sizeof(weft_limit_method) == sizeof(unsigned)
                   && sizeof(weft_shape_kind) == sizeof(unsigned)
                   && sizeof(weft_seam) == sizeof(unsigned)
                   && sizeof(weft_friction_law) == sizeof(unsigned)
                   && sizeof(weft_limit_solver) == sizeof(unsigned)
                   && sizeof(weft_norm) == sizeof(unsigned)
                   && sizeof(weft_controller_type) == sizeof(unsigned),
               "a choice is stored as an unsigned");

static const char *const law_names[] = { "hooke", "strain", NULL };
static const char *const rim_names[] = { "full", "half", NULL };

static const weft__key springs_keys[] = {
    { "law", WEFT__CHOICE, .names = law_names, AT(weft_cloth_def, law),
      .fallback = "hooke",
      .meaning
      = "hooke: k (L - s), stiffness [N/m]; strain: k (L / s - 1), stiffness [N]" },
    { "stretch", WEFT__MAPPING, SECTION(stretch), .absent = "none",
      OF_FAMILY(WEFT_STRETCH), .meaning = "springs to the next column and row" },
    { "shear", WEFT__MAPPING, SECTION(shear), .absent = "none", OF_FAMILY(WEFT_SHEAR),
      .meaning = "springs across both diagonals of a cell" },
    { "bend", WEFT__MAPPING, .absent = "none",
      WITH(KEYS(bend), .one = { "stiffness", "rigidity" }, .check = weft__check_bend),
      .meaning = "springs to the next but one column and row, or bending rigidity" },
    { "rim", WEFT__EITHER, .names = rim_names, .fallback = "full",
      AT(weft_cloth_def, rim_half),
      .meaning = "half: stretch springs, and bend springs of stiffness, that lie along "
                 "the rim carry half their values" },
};

/* A quantity of a sheet by its name there: of {warp, weft}, or one for both. */
#define OF_SHEET(field, unit_) AT(weft__sheet, field), .unit = unit_
#define MEASURED(name, unit_, range, field, text)                                      \
    {                                                                                  \
        name, WEFT__PAIR, .required = true, RANGE(range), OF_SHEET(field, unit_),      \
                          .meaning = text                                              \
    }
#define UNUSED(name, unit_, text)                                                      \
    {                                                                                  \
        name, WEFT__PAIR, RANGE(.least = 0.0), OF_SHEET(unused, unit_),                \
            .absent = "none", .meaning = text "; has no effect"                        \
    }
#define WEIGHT(unit_)                                                                  \
    {                                                                                  \
        "W", WEFT__NUMBER, .required = true, RANGE(.strict = true),                    \
                           OF_SHEET(weight, unit_), .meaning = "mass per area"         \
    }

static const weft__key kes_keys[] = {
    MEASURED("EMT", "%", .strict = true, extension, "extension at 500 gf/cm"),
    MEASURED("G", "gf/(cm degree)", .least = 0.0, shear, "shear rigidity"),
    MEASURED("B", "gf cm^2/cm", .least = 0.0, bend, "bending rigidity"),
    WEIGHT("mg/cm^2"),
    UNUSED("LT", NULL, "linearity of extension"),
    UNUSED("WT", "gf cm/cm^2", "work of extension"),
    UNUSED("RT", "%", "resilience of extension"),
    UNUSED("2HG", "gf/cm", "hysteresis of shear at 0.5 degrees"),
    UNUSED("2HG5", "gf/cm", "hysteresis of shear at 5 degrees"),
    UNUSED("2HB", "gf cm/cm", "hysteresis of bending"),
    UNUSED("T", "mm", "thickness"),
};

static const weft__key fast_keys[] = {
    MEASURED("E100", "%", .strict = true, extension, "extension at 100 gf/cm"),
    MEASURED("EB5", "%", .strict = true, shear, "bias extension at 5 gf/cm"),
    MEASURED("C", "mm", .least = 0.0, bend, "bending length"),
    WEIGHT("g/m^2"),
    UNUSED("E5", "%", "extension at 5 gf/cm"),
    UNUSED("E20", "%", "extension at 20 gf/cm"),
    UNUSED("T2", "mm", "thickness at 2 gf/cm^2"),
    UNUSED("T100", "mm", "thickness at 100 gf/cm^2"),
};

/* The preset and the sheets come first: the other keys replace a preset's values. */
static const weft__key fabric_keys[] = {
    { "preset", WEFT__PRESET, .absent = "none",
      .meaning = "a measured fabric; keys beside it replace its values" },
    { "kes", WEFT__SHEET, SECTION(kes), .absent = "none", .first = WEFT__KES,
      .meaning
      = "instead of density, stretch, shear and bend: a data sheet of the KES-FB "
        "system in its units; a pair: [warp, weft]" },
    { "fast", WEFT__SHEET, SECTION(fast), .absent = "none", .first = WEFT__FAST,
      .meaning = "the same: a data sheet of the FAST system" },
    { "arcsim", WEFT__ARCSIM, .absent = "none",
      .meaning
      = "instead of density, stretch, shear, coupling and bend: a JSON file of "
        "an ARCSim material, whose u is the warp" },
    { "density", WEFT__NUMBER,
      .absent = "required: density, preset, kes, fast or arcsim",
      NUMBER(fabric, density), .meaning = "mass per area" },
    { "stretch", WEFT__PAIR, .absent = "required: stretch, preset, kes, fast or arcsim",
      NUMBER(fabric, stretch),
      .meaning = "tension per strain; a pair: [along a column (warp), along a row "
                 "(weft)]" },
    { "shear", WEFT__NUMBER, .absent = "0 or the preset's", NUMBER(fabric, shear),
      .meaning = "shear stress per angle, and the modulus between warp and weft" },
    { "bend", WEFT__PAIR, .absent = "0 or the preset's", NUMBER(fabric, bend),
      .meaning = "bending rigidity; a pair: [warp, weft]" },
    { "twist", WEFT__NUMBER, RANGE(.least = 0.0), .unit = "N m",
      .absent = "sqrt of the product of both bend, or the preset's",
      AT(weft_fabric, twist), .meaning = "stiffness of twisting" },
    { "damping", WEFT__PAIR, .absent = "0", NUMBER(fabric, damping),
      .meaning
      = "damping = this time * stiffness; a pair: [in the plane, of bending]" },
    { "coupling", WEFT__NUMBER, .absent = "shear, or the preset's",
      NUMBER(fabric, coupling),
      .meaning = "modulus between warp and weft; meshes only" },
};

static const weft__section fabric_section
    = { KEYS(fabric), .check = weft__check_fabric };

static const weft__key turn_keys[] = {
    { "axis", WEFT__VECTOR, .fallback = "[0, 1, 0]", AT(weft__turn, axis),
      .meaning = "through the file's origin" },
    { "angle", WEFT__NUMBER, .fallback = "0", .unit = "degrees", AT(weft__turn, angle),
      .meaning = "counterclockwise, seen from the end of the axis" },
};

/* In the order of weft_rest_shape, and of weft_rest_angle. */
static const char *const rest_names[] = { "plane", "start", NULL };
static const char *const angle_names[] = { "flat", "start", NULL };

static const weft__key mesh_keys[] = {
    { "file", WEFT__TEXT, .required = true, AT(weft__mesh_file, file),
      .meaning = "an OBJ file beside the scene: v start positions, vt the rest shape "
                 "in the plane (u along the weft, v along the warp; without vt a flat "
                 "v), f triangles and "
                 "quadrilaterals, usemtl fabrics, g groups, p points of a group" },
    { "unit", WEFT__NUMBER, RANGE(.strict = true), .unit = "m", .fallback = "1.0",
      AT(weft__mesh_file, unit), .meaning = "one unit of the file, of v and vt" },
    { "weld", WEFT__NUMBER, RANGE(.least = 0.0), .unit = "m", .absent = "none",
      AT(weft__mesh_file, weld),
      .meaning = "vertices that start at most so far apart are one, that with the "
                 "lowest index; 0: those that coincide exactly" },
    { "at", WEFT__VECTOR, .unit = "m", .fallback = "[0, 0, 0]", AT(weft__mesh_file, at),
      .meaning = "added to the start positions after the turn" },
    { "turn", WEFT__MAPPING, CHECKED(turn), .absent = "none", AT(weft__mesh_file, turn),
      .meaning = "of the start positions" },
    { "rest", WEFT__CHOICE, .names = rest_names, .fallback = "plane",
      AT(weft__mesh_file, rest.shape), .meaning = "the rest shape: vt, or v in space" },
    { "angle", WEFT__CHOICE, .names = angle_names, .first = WEFT_ANGLE_FLAT,
      .absent = "flat; with rest: start, start", AT(weft__mesh_file, rest.angle),
      .meaning = "the shape without bending" },
    { "warp", WEFT__VECTOR, .absent = "none", AT(weft__mesh_file, rest.warp),
      .meaning = "rest: start only: its direction in the file" },
};

static const weft__key disc_keys[] = {
    { "disc", WEFT__NUMBER, .required = true, RANGE(.strict = true), .unit = "m",
      AT(weft__cut_path, radius), .meaning = "radius" },
    { "at", WEFT__PAIR, .fallback = "[0, 0]", .unit = "m", AT(weft__cut_path, centre),
      .meaning = "centre [u, v]" },
};

static const weft__section disc_section = { KEYS(disc) };

static const weft__key cut_keys[] = {
    { "outline", WEFT__PATH, .required = true, .section = &disc_section, .unit = "m",
      AT(weft__cut, outline),
      .meaning
      = "points [u, v] in order, u along the weft, v along the warp; or {disc: "
        "radius, at: [u, v]}" },
    { "holes", WEFT__PATHS, .absent = "none", .section = &disc_section, .unit = "m",
      AT(weft__cut, holes), .meaning = "each as outline" },
    { "lines", WEFT__PATHS, .absent = "none", .section = &disc_section, .unit = "m",
      AT(weft__cut, lines),
      .meaning = "edges of triangles run along these within the panel; each points in "
                 "order, or a disc's circle" },
    { "spacing", WEFT__NUMBER, .required = true, NUMBER(grid, spacing),
      .meaning = "length of edge aimed at" },
    { "seed", WEFT__INTEGER, .fallback = "1", RANGE(.type = WEFT__SIZE),
      AT(weft__cut, seed), .meaning = "of the vertices inside" },
    { "origin", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(grid, origin),
      .meaning = "where (u, v) = (0, 0) starts" },
    { "right", WEFT__VECTOR, .fallback = "[1, 0, 0]", AT(weft_cloth_def, right),
      .meaning = "direction of increasing u; normalised on reading" },
    { "down", WEFT__VECTOR, .fallback = "[0, -1, 0]", AT(weft_cloth_def, down),
      .meaning = "direction of decreasing v; perpendicular to right (1e-9)" },
    { "scale", WEFT__NUMBER, .fallback = "1.0", NUMBER(grid, scale),
      .meaning = "vertices start at origin + scale * (u * right - v * down)" },
};

/* In the order of weft_seam. */
static const char *const seam_names[] = { "bend", "hinge", NULL };
static const char *const membrane_names[] = { "chord", "arc", NULL };

#define IN_SCENE(field) .at = offsetof(weft_scene, field) - offsetof(weft_scene, cloth)

/* The grid, or the mesh, comes first: the other keys are checked against it. `name` is
 * of one of several cloths. */
static const weft__key cloth_keys[] = {
    { "name", WEFT__TEXT, .required = true, IN_SCENE(part_name),
      .meaning = "what results call it: letters, digits, _ and -" },
    { "grid", WEFT__MAPPING, .absent = "required: grid, mesh or cut", CHECKED(grid),
      .meaning = "particle (row, col) rests "
                 "at origin + col * spacing * right + row * "
                 "spacing * down" },
    { "mesh", WEFT__MAPPING, .absent = "required: grid, mesh or cut", CHECKED(mesh),
      IN_SCENE(mesh_file), .meaning = "triangles of any outline, instead of a grid" },
    { "cut", WEFT__MAPPING, .absent = "required: grid, mesh or cut", CHECKED(cut),
      IN_SCENE(cut),
      .meaning = "a flat panel that weft meshes itself, instead of a file; groups: "
                 "outline, hole0, ..., line0, ..." },
    { "mass", WEFT__NUMBER, .absent = "required: mass, density or fabric",
      NUMBER(grid, mass), .meaning = "mass of each particle" },
    { "density", WEFT__NUMBER, .absent = "required: mass, density or fabric",
      NUMBER(grid, density), .meaning = "mass per area, lumped to the particles" },
    { "velocity", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(grid, velocity),
      .meaning = "initial velocity of particles without a pin" },
    { "loads", WEFT__ITEMS,
      ITEMS(weft_cloth_def, loads, load_count, weft__read_mapping),
      .section = &load_section, .absent = "none",
      .meaning = "point masses added to particles" },
    { "springs", WEFT__MAPPING, CHECKED(springs), .absent = "none",
      .meaning = "families of springs; a missing family has no springs" },
    { "fabric", WEFT__MAPPING, .section = &fabric_section, .absent = "none",
      IN_SCENE(fabric),
      .meaning = "a measured fabric, independent of the grid: instead of mass, density "
                 "and springs; required with a mesh" },
    { "fabrics", WEFT__FABRICS, .section = &fabric_section, .absent = "none",
      IN_SCENE(fabrics),
      .meaning
      = "meshes only: further fabrics, {NAME: {keys as fabric}}, for the triangles "
        "after usemtl NAME in the file" },
    { "seams", WEFT__CHOICE, .names = seam_names, .fallback = "bend",
      IN_SCENE(obj.def.seams),
      .meaning = "meshes only: whether the cloth bends across a seam as elsewhere, or "
                 "turns freely" },
    { "membrane", WEFT__EITHER, .names = membrane_names, .fallback = "chord",
      IN_SCENE(obj.def.arc),
      .meaning
      = "meshes only: arc measures edges along the cloth's arc, which does not "
        "lock on coarse meshes and costs some 4 times as much" },
    { "pins", WEFT__ITEMS, ITEMS(weft_cloth_def, pins, pin_count, weft__read_pin),
      .section = &pin_section, .absent = "none",
      .meaning = "particles that are pinned or moved: a place, or {at: place, ...}; a "
                 "later entry wins" },
};

static const weft__section cloth_section
    = { .keys = cloth_keys + 1,
        .count = COUNT(cloth_keys) - 1,
        .one = { "grid", "mesh", "cut" },
        .check = weft__check_cloth },
    part_section
    = { KEYS(cloth), .one = { "grid", "mesh", "cut" }, .check = weft__check_part };

/* ---- forces -------------------------------------------------------------------- */

#include "forces/wind/wind_keys.h"

static const weft__key force_keys[] = {
    { "gravity", WEFT__VECTOR, .fallback = "[0, -9.81, 0]", NUMBER(body, gravity),
      .meaning = "acceleration of free fall" },
    { "damping", WEFT__NUMBER, .fallback = "0", NUMBER(body, damping),
      .meaning = "air drag on each particle: F = -damping * v" },
    { "wind", WEFT__MAPPING, WITH(KEYS(wind), .one = { "velocity", "table" }),
      .absent = "no wind", .meaning = "moving air" },
};

/* ---- contact ------------------------------------------------------------------- */

#include "forces/contact/contact_keys.h"

/* ---- limit --------------------------------------------------------------------- */

/* In the order of weft_family. */
static const char *const family_names[] = { "stretch", "shear", "bend", NULL };
static const char *const limit_names[] = { "provot", "bridson", NULL };
static const char *const velocity_names[] = { "update", "keep", NULL };
static const char *const solver_names[] = { "fast", "sweep", NULL };

static const weft__key limit_keys[] = {
    { "method", WEFT__CHOICE, .required = true, .names = limit_names,
      AT(weft_limit_def, method), .first = WEFT_LIMIT_PROVOT,
      .meaning
      = "provot corrects positions, so that the bound holds after each step; bridson "
        "velocities, so that the forces of a step exceed it by h^2 times their "
        "relative acceleration" },
    { "strain", WEFT__NUMBER, .fallback = "0.1", NUMBER(limit, strain),
      .meaning = "no limited spring longer than (1 + strain) * rest length" },
    { "springs", WEFT__NAMES, .names = family_names, .some = true,
      .fallback = "[stretch, shear]", AT(weft_limit_def, families),
      .meaning = "limited families" },
    { "sweeps", WEFT__INTEGER, .fallback = "100", NUMBER(limit, sweeps),
      .meaning = "maximum of passes per step" },
    { "tolerance", WEFT__NUMBER, .fallback = "1.0e-3", NUMBER(limit, tolerance),
      .meaning = "passes end when no spring exceeds (1 + strain)(1 + tolerance) "
                 "rest lengths" },
    { "velocity", WEFT__EITHER, .names = velocity_names,
      AT(weft_limit_def, keep_velocity), .fallback = "update",
      .meaning = "update: v += dx / h of the correction; keep: positions only, as in "
                 "the paper (provot)" },
    { "solver", WEFT__CHOICE, .names = solver_names, AT(weft_limit_def, solver),
      .fallback = "fast",
      .meaning = "fast: sweeps with momentum; sweep: plain sweeps, as in the paper" },
};

/* ---- stepper ------------------------------------------------------------------- */

static const char *const norm_names[] = { "max", "rms", NULL };

static const weft__key atol_keys[] = {
    { "position", WEFT__NUMBER, .required = true, NUMBER(config, atol_position),
      .meaning = "tolerance of positions" },
    { "velocity", WEFT__NUMBER, .required = true, NUMBER(config, atol_velocity),
      .meaning = "tolerance of velocities" },
};

static const weft__key butcher_keys[] = {
    { "A", WEFT__ROWS, .required = true, AT(weft__tableau, a),
      .meaning = "one row per stage, strictly lower triangular; zeros at the end of "
                 "a row may be omitted" },
    { "b", WEFT__ROW, .required = true, AT(weft__tableau, b),
      .meaning = "weights, one per stage" },
    { "c", WEFT__ROW, .required = true, AT(weft__tableau, c),
      .meaning = "nodes, one per stage" },
    { "order", WEFT__INTEGER, .required = true,
      RANGE(.type = WEFT__INT, .least = 1, .most = 99), AT(weft__tableau, set.order),
      .meaning = "order of the continued solution" },
    { "b_embedded", WEFT__ROW, .absent = "none: fixed steps only",
      AT(weft__tableau, b_embedded), .meaning = "weights of the embedded solution" },
    { "embedded_order", WEFT__INTEGER, RANGE(.type = WEFT__INT, .least = 1, .most = 99),
      .absent = "none: fixed steps only", AT(weft__tableau, set.embedded_order),
      .meaning = "order of the embedded solution; b_embedded and embedded_order go "
                 "together" },
};

static const char *const controller_names[] = {
#define NAME(label, name, gains) #name,
    WEFT_CONTROLLERS(NAME)
#undef NAME
        NULL
};

static const weft__key controller_keys[] = {
    { "type", WEFT__CHOICE, .names = controller_names, AT(weft__control, set.type),
      .first = WEFT_CONTROLLER_DEFAULT + 1, .absent = "arkode: pi",
      .meaning = "the law that computes h from the errors" },
    { "gains", WEFT__ROW, AT(weft__control, gains), .absent = "those of the type",
      .meaning
      = "k1, k2, k3 of the law: pid and imex_gustafsson take three, i one, the "
        "others two" },
    { "safety", WEFT__NUMBER, RANGE(.strict = true, .most = 1.0),
      .absent = "arkode: 0.96", AT(weft__control, set.safety),
      .meaning = "part of the largest acceptable h" },
    { "bias", WEFT__NUMBER, RANGE(.least = 1.0), .absent = "arkode: 1.2; rkc, rkl: 5",
      AT(weft__control, set.bias), .meaning = "factor of the error estimate" },
    { "max_growth", WEFT__NUMBER, RANGE(.strict = true, .least = 1.0),
      .absent = "arkode: 25", AT(weft__control, set.max_growth),
      .meaning = "largest factor of h from step to step" },
    { "first_growth", WEFT__NUMBER, RANGE(.strict = true, .least = 1.0),
      .absent = "arkode: 1e4", AT(weft__control, set.first_growth),
      .meaning = "max_growth after the first step" },
    { "min_reduction", WEFT__NUMBER, RANGE(.strict = true, .most = 1.0, .below = true),
      .absent = "arkode: 0.1", AT(weft__control, set.min_reduction),
      .meaning = "smallest factor of h from step to step" },
    { "failed_growth", WEFT__NUMBER, RANGE(.strict = true, .most = 1.0, .below = true),
      .absent = "arkode: 0.3", AT(weft__control, set.failed_growth),
      .meaning = "factor of h after repeated rejections" },
};

/* In the order of weft_preconditioner; of weft_jacobian from its second on. */
static const char *const preconditioner_names[]
    = { "auto", "jacobi", "multigrid", NULL };
static const char *const jacobian_names[] = { "step", "newton", NULL };

static const weft__key solver_keys[] = {
    { "krylov", WEFT__NUMBER, RANGE(.strict = true, .most = 1.0, .below = true),
      .absent = "1.0e-3; 1.0e-4 if a tolerance is below 1.0e-5; bdf: 0.1",
      AT(weft_linear, krylov),
      .meaning = "relative residual to which each linear system is solved" },
    { "preconditioner", WEFT__CHOICE, .names = preconditioner_names, .fallback = "auto",
      AT(weft_linear, preconditioner),
      .meaning = "of conjugate gradients: the blocks of the particles, multigrid, or "
                 "what the step size suggests" },
    { "jacobian", WEFT__CHOICE, .names = jacobian_names, .first = WEFT_JACOBIAN_STEP,
      .absent = "the method's", AT(weft_linear, jacobian),
      .meaning = "computed again in each step or in each Newton iteration, for methods "
                 "with Newton's iteration" },
    { "max_order", WEFT__INTEGER, RANGE(.type = WEFT__INT, .least = 1.0, .most = 5.0),
      .absent = "bdf: 2", AT(weft_linear, max_order),
      .meaning = "largest order, for methods of variable order; bdf is stable at all "
                 "step sizes up to order 2 only" },
};

static const weft__key stepper_keys[] = {
    { "plugin", WEFT__TEXT, .required = true, AT(weft_scene, plugin),
      .meaning = "gsl, arkode, verlet, stiff, cvode or any installed plugin" },
    { "method", WEFT__TEXT, .required = true, AT(weft_scene, method),
      .meaning
      = "a method of the plugin (weft steppers lists them), or plugin/method" },
    { "rtol", WEFT__NUMBER, .fallback = "1.0e-6", AT(weft_scene, config),
      NUMBER(config, rtol), .meaning = "relative tolerance" },
    { "atol", WEFT__ATOL, NUMBER(config, atol_position), .unit = "m, m/s",
      SECTION(atol), .fallback = "1.0e-6",
      .meaning = "absolute tolerance: a number for all, or {position, velocity}" },
    { "norm", WEFT__CHOICE, .names = norm_names, AT(weft_scene, config.norm),
      .fallback = "max", .meaning = "error norm over all components" },
    { "first_step", WEFT__NUMBER, .fallback = "1.0e-3", AT(weft_scene, config),
      NUMBER(config, first_step), .meaning = "first step size to try" },
    { "min_step", WEFT__NUMBER, .fallback = "1.0e-12", AT(weft_scene, config),
      NUMBER(config, min_step),
      .meaning = "smallest step size; a smaller "
                 "one is a failure" },
    { "max_step", WEFT__NUMBER, .fallback = ".inf", AT(weft_scene, config),
      NUMBER(config, max_step), .meaning = "largest step size" },
    { "fixed_step", WEFT__NUMBER, .absent = "none: adaptive steps",
      AT(weft_scene, config), NUMBER(config, fixed_step),
      .meaning
      = "no error control; excludes the keys from rtol to max_step; shortened so that "
        "it divides a frame" },
    { "large_matrices", WEFT__BOOLEAN, .fallback = "false",
      AT(weft_scene, large_matrices),
      .meaning = "permits more than 1 GB for the dense matrices of a method" },
    { "controller", WEFT__MAPPING, CHECKED(controller), .absent = "the plugin's",
      AT(weft_scene, control),
      .meaning = "step size control, for the methods of plugin arkode with an error "
                 "estimate" },
    { "solver", WEFT__MAPPING, CHECKED(solver), .absent = "the method's",
      AT(weft_scene, solver),
      .meaning
      = "linear systems of the implicit methods of plugins stiff, cvode and arkode; "
        "a key that the method does not use is an error" },
    { "butcher", WEFT__MAPPING, .absent = "none", AT(weft_scene, tableau),
      WITH(KEYS(butcher), .together = { "b_embedded", "embedded_order" },
           .check = weft__check_butcher),
      .meaning = "an explicit Runge-Kutta table, for method custom of plugin "
                 "arkode; values are numbers or fractions such as 19/32" },
};

/* ---- record -------------------------------------------------------------------- */

static const char *const precision_names[] = { "single", "double", NULL };
/* In the order of weft_record_field. */
static const char *const field_names[] = { "velocity", "strain", "pinned", NULL };

static const weft__key record_keys[] = {
    { "precision", WEFT__EITHER, .names = precision_names, AT(weft_record_def, doubles),
      .fallback = "single",
      .meaning = "precision of positions, velocities and strains in run.vtkhdf" },
    { "fields", WEFT__NAMES, .names = field_names,
      .fallback = "[velocity, strain, pinned]", AT(weft_record_def, fields),
      .meaning = "fields in run.vtkhdf beside the positions; strain: the largest (L "
                 "- s) / s of a particle's springs" },
    { "every", WEFT__INTEGER, RANGE(.least = 1), .fallback = "1",
      AT(weft_record_def, every),
      .meaning
      = "run.vtkhdf holds every n-th frame, and always the first and the last" },
    { "ledger", WEFT__BOOLEAN, .fallback = "false", AT(weft_record_def, ledger),
      .meaning = "integrate the energy balance with the state, and add it to "
                 "series.csv" },
    { "final", WEFT__BOOLEAN, .fallback = "true", AT(weft_record_def, final),
      .meaning = "write the state at the end to final.csv: some 130 bytes per "
                 "particle" },
};

/* ---- sensitivity --------------------------------------------------------------- */

static const char *const scale_names[] = { "none", "log", NULL };

static const weft__key sensitivity_keys[] = {
    { "of", WEFT__PATHS_OF_KEYS, .required = true, AT(weft_scene_sensitivity, keys),
      .meaning = "parameters of cloth, forces and contact, as --set writes their keys: "
                 "[forces.gravity.1, contact.shapes.0.radius]" },
    { "scale", WEFT__EITHER, .names = scale_names, .fallback = "log",
      AT(weft_scene_sensitivity, relative),
      .meaning = "log: s = p dy/dp [m], [m/s]; none: s = dy/dp, per unit of p" },
    { "control", WEFT__BOOLEAN, .fallback = "true", AT(weft_scene_sensitivity, control),
      .meaning = "s takes part in error control, as with log; false: the steps are "
                 "those without sensitivity" },
};

/* ---- the rest ------------------------------------------------------------------ */

static const char *const frames_names[] = { "step", "interpolate", NULL };

static const weft__key run_keys[] = {
    { "duration", WEFT__NUMBER, .required = true, RANGE(.strict = true), .unit = "s",
      AT(weft_run_def, duration), .meaning = "simulated time" },
    { "fps", WEFT__NUMBER, RANGE(.strict = true), .unit = "1/s", .fallback = "30",
      AT(weft_run_def, fps),
      .meaning = "frames per simulated second; frame i is at exactly i / fps, the last "
                 "at duration" },
    { "threads", WEFT__INTEGER, RANGE(.least = 1), .fallback = "1",
      AT(weft_run_def, threads),
      .meaning = "threads for the forces, from 64 x 64 particles on, and for the "
                 "solver's vectors (plugins arkode, cvode); results do not depend on "
                 "it" },
    { "frames", WEFT__EITHER, .names = frames_names, .fallback = "step",
      AT(weft_run_def, interpolate),
      .meaning = "step: every frame ends a step; interpolate: frames are taken from "
                 "within steps, which they do not cut" },
    { "checkpoint", WEFT__INTEGER, RANGE(.least = 0.0), .fallback = "30",
      AT(weft_run_def, checkpoint),
      .meaning = "interval in frames: the integrator restarts and a checkpoint for "
                 "weft resume is written; 0: never" },
    { "keep_checkpoint", WEFT__BOOLEAN, .fallback = "false",
      AT(weft_run_def, keep_checkpoint),
      .meaning = "keep the last checkpoint of a run that is done, for weft resume "
                 "--until" },
};

static const weft__key condition_keys[] = {
    { "when", WEFT__CONDITION, .absent = "required: when or at_rest",
      AT(weft_stop_def, quantity),
      .meaning = "ends the run at the moment when a column of series.csv comes to this "
                 "bound [m, J]" },
    { "at_rest", WEFT__REST, .absent = "required: when or at_rest",
      AT(weft_stop_def, quantity),
      .meaning
      = "instead of when: the kinetic energy is below this fraction of the work "
        "of gravity since the start; true: 1e-6" },
    { "for", WEFT__NUMBER, RANGE(.least = 0.0), .unit = "s",
      .absent = "0.5 with at_rest, 0 with when", AT(weft_stop_def, hold),
      .meaning = "the condition must have held for so long" },
};

/* The stepper comes before run and record, which are checked against it. */
static const weft__key root_keys[] = {
    { "weft", WEFT__INTEGER, RANGE(.least = 1), .fallback = "1",
      AT(weft_scene, version), .meaning = "version of the scene format, 1" },
    { "name", WEFT__TEXT, .absent = "the file's name without .yaml",
      AT(weft_scene, name), .meaning = "free text" },
    { "cloth", WEFT__MAPPING, .section = &cloth_section,
      .absent = "required: cloth or cloths", AT(weft_scene, cloth),
      .meaning = "the model: grid or mesh, masses, springs, pins" },
    { "cloths", WEFT__CLOTHS, .section = &part_section,
      .absent = "required: cloth or cloths", AT(weft_scene, parts),
      .meaning
      = "several cloths: each has a name and the keys of cloth, a grid 2 rows and "
        "columns or more; seams and membrane are the same for all meshes; "
        "they touch each other with contact.self" },
    { "forces", WEFT__MAPPING, SECTION(force), .absent = "gravity only",
      AT(weft_scene, cloth), .meaning = "other forces on the cloth" },
    { "contact", WEFT__MAPPING,
      WITH(KEYS(contact), .check = weft__check_contact,
           .late = weft__check_late_contact),
      .absent = "none", AT(weft_scene, cloth.contact),
      .meaning = "colliders, and contact of the cloth with itself" },
    { "limit", WEFT__MAPPING, CHECKED(limit), .absent = "none", AT(weft_scene, limit),
      .meaning = "strain limit, applied after every accepted step" },
    { "stepper", WEFT__MAPPING, .required = true, CHECKED(stepper),
      .meaning = "the integrator: plugin, method, tolerances" },
    { "run", WEFT__MAPPING, .required = true, CHECKED(run), AT(weft_scene, run),
      .meaning = "duration and frames" },
    { "stop", WEFT__MAPPING, WITH(KEYS(condition), .one = { "when", "at_rest" }),
      .absent = "none: ends at run.duration", AT(weft_scene, run.stop),
      .meaning = "an earlier end of the run" },
    { "record", WEFT__MAPPING, CHECKED(record), .absent = "the defaults of its keys",
      AT(weft_scene, record), .meaning = "output of a run" },
    { "sensitivity", WEFT__MAPPING, CHECKED(sensitivity), .absent = "none",
      AT(weft_scene, sensitivity),
      .meaning
      = "derivatives of the state with respect to parameters, integrated with it "
        "(docs/guides/gradients.md)" },
    { "sweep", WEFT__SWEEP, .absent = "none: one run",
      .meaning
      = "weft batch runs every combination of the values; zip and sample combine "
        "them otherwise (docs/guides/sweep-parameters.md)" },
};

const weft__section weft__root = { .title = "the scene",
                                   KEYS(root),
                                   .one = { "cloth", "cloths" },
                                   .check = weft__check_root };

#define READER(kind, reader, text) [WEFT__##kind] = weft__read_##reader,
weft__read_fn *const weft__readers[WEFT__KINDS] = { WEFT__KIND_LIST(READER) };
