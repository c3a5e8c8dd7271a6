/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_keys.h -- the keys of contact: a part of scene/keys.c, which has the macros,
 * with its checks in src/scene/contact. */

/* In the order of weft_shape_kind and weft_friction_law. */
static const char *const shape_names[]
    = { "plane", "sphere", "capsule", "box", "mesh", NULL };
static const char *const friction_names[] = { "smooth", "coulomb", NULL };

enum {
    PLANE = 1 << WEFT_PLANE,
    SPHERE = 1 << WEFT_SPHERE,
    CAPSULE = 1 << WEFT_CAPSULE,
    BOX = 1 << WEFT_BOX,
    MESH = 1 << WEFT_MESH
};

static const weft__key shape_turn_keys[] = {
    { "axis", WEFT__VECTOR, .required = true, NUMBER(turn, axis),
      .meaning = "direction of the axis; the shape turns counterclockwise, seen from "
                 "its end" },
    { "about", WEFT__VECTOR, .unit = "m", .absent = "at, or from", AT(weft_turn, about),
      .meaning = "a point of the axis at t = 0; it moves with the shape" },
    { "rate", WEFT__NUMBER, .fallback = "0", NUMBER(turn, rate),
      .meaning = "the angle is rate * t + amplitude * sin(2 pi frequency t)" },
    { "amplitude", WEFT__NUMBER, .fallback = "0", NUMBER(turn, amplitude),
      .meaning = "of an oscillation" },
    { "frequency", WEFT__NUMBER, .fallback = "0", NUMBER(turn, frequency),
      .meaning = "of the oscillation, together with amplitude" },
};

/* The shape comes first: it decides which other keys belong to it. */
static const weft__key shape_keys[] = {
    { "shape", WEFT__CHOICE, .required = true, .names = shape_names,
      AT(weft_shape, kind), .meaning = "its kind" },
    { "at", WEFT__VECTOR, .required = true, .of = PLANE | SPHERE | BOX, .also = MESH,
      .absent = "required for a plane, sphere or box; mesh: [0, 0, 0]",
      NUMBER(shape, at),
      .meaning = "a point of the plane, the centre of the sphere or box, or where the "
                 "origin of the mesh's file lies" },
    { "normal", WEFT__VECTOR, .required = true, .of = PLANE,
      .absent = "required for a plane", AT(weft_shape, normal),
      .meaning = "plane: towards the side of the cloth; normalised on reading" },
    { "from", WEFT__VECTOR, .required = true, .of = CAPSULE,
      .absent = "required for a capsule", NUMBER(shape, at),
      .meaning = "capsule: one end of its axis" },
    { "to", WEFT__VECTOR, .required = true, .unit = "m", .of = CAPSULE,
      .absent = "required for a capsule", AT(weft_shape, to),
      .meaning = "capsule: the other end" },
    { "radius", WEFT__NUMBER, .required = true, .of = SPHERE | CAPSULE,
      .absent = "required for a sphere or capsule", .number = &weft__shape_radius,
      .meaning = "of the sphere, or of the capsule about its axis" },
    { "half", WEFT__VECTOR, .required = true, .unit = "m", .of = BOX,
      .absent = "required for a box", AT(weft_shape, half),
      .meaning = "box: half its edges along x, y, z; > rounding" },
    { "rounding", WEFT__NUMBER, .required = true, .of = BOX,
      .absent = "required for a box", .number = &weft__shape_rounding,
      .meaning = "box: radius of its edges" },
    { "file", WEFT__TEXT, .required = true, .of = MESH, .absent = "required for a mesh",
      AT(weft__shape_item, file),
      .meaning = "mesh: an OBJ file beside the scene, of which v and f are read; with "
                 "%04d for a number, one for each key frame, from 0 or 1 on" },
    { "unit", WEFT__NUMBER, .of = MESH, RANGE(.strict = true), .unit = "m",
      .fallback = "1.0", AT(weft__shape_item, unit),
      .meaning = "mesh: one unit of the file" },
    { "fps", WEFT__NUMBER, .of = MESH, RANGE(.strict = true), .unit = "1/s",
      .absent = "none: no key frames", AT(weft__shape_item, fps),
      .meaning = "mesh: key frames a second; in between it follows natural cubic "
                 "splines, after the last it rests" },
    { "triangles", WEFT__FACETS, .unit = "m", .of = SPHERE | CAPSULE | BOX,
      .fallback = "false", AT(weft__shape_item, facets),
      .meaning
      = "sphere, capsule or box: weft makes a mesh of it, with edges of at most "
        "this length, which all of the cloth feels, not only its particles; "
        "true: sqrt(2 R thickness), R its radius or rounding" },
    { "friction", WEFT__NUMBER, RANGE(.least = 0.0), .absent = "contact.friction",
      AT(weft_shape, friction), .meaning = "coefficient of friction of this shape" },
    { "velocity", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(shape, velocity),
      .meaning = "velocity of the shape" },
    { "amplitude", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(shape, amplitude),
      .meaning = "oscillation: + amplitude * sin(2 pi frequency t)" },
    { "frequency", WEFT__NUMBER, .fallback = "0", NUMBER(shape, frequency),
      .meaning = "of the oscillation, together with amplitude" },
    { "spin", WEFT__VECTOR, .fallback = "[0, 0, 0]", NUMBER(shape, spin),
      .meaning
      = "surface velocity, as of a roller: a rotation about at, along the normal "
        "of a plane or the axis of a capsule; a box or mesh has none" },
    { "turn", WEFT__MAPPING, .absent = "none", AT(weft_shape, turn),
      WITH(KEYS(shape_turn), OSCILLATES, .check = weft__check_turn),
      .meaning = "the shape rotates about an axis, and then moves by velocity and "
                 "amplitude" },
};

static const weft__section shape_section
    = { .title = "a shape", KEYS(shape), OSCILLATES, .check = weft__check_shape };

static const weft__key contact_keys[] = {
    { "thickness", WEFT__NUMBER, .fallback = "5.0e-3", NUMBER(contact, thickness),
      .meaning = "forces begin at this distance from a shape, and between layers of "
                 "cloth" },
    { "stopping_speed", WEFT__NUMBER, .fallback = "5.0",
      NUMBER(contact, stopping_speed),
      .meaning = "a particle that arrives at it is stopped at 0.2755 thickness "
                 "(exponent 4)" },
    { "exponent", WEFT__INTEGER, .fallback = "4", NUMBER(contact, exponent),
      .meaning = "the force begins like its power minus 1 of the depth: higher is "
                 "smoother" },
    { "damping", WEFT__NUMBER, .fallback = "1.0", NUMBER(contact, damping),
      .meaning = "of the approach; 0: elastic" },
    { "friction", WEFT__NUMBER, .fallback = "0.3", NUMBER(contact, friction),
      .meaning
      = "coefficient of friction of shapes without their own, and of the cloth on "
        "itself; with law smooth it does not change how fast a cloth at rest creeps" },
    { "law", WEFT__CHOICE, .names = friction_names, AT(weft_contact_def, law),
      .fallback = "smooth",
      .meaning = "smooth: no stiffer than 10 times the contact; coulomb: exact above "
                 "slip, and costly" },
    { "slip", WEFT__NUMBER, .fallback = "1.0e-3", NUMBER(contact, slip),
      .meaning = "below this slip speed friction fades" },
    { "self", WEFT__BOOLEAN, .fallback = "false", AT(weft_contact_def, self),
      .meaning = "whether the cloth touches itself; then the thickness must be at most "
                 "half the smaller spacing of a grid, or half the smallest height of a "
                 "mesh's triangles" },
    { "untangle", WEFT__NUMBER, .fallback = "0.0", .number = &weft__untangle,
      .at = -offsetof(weft_cloth_def, contact),
      .meaning
      = "longest time to relax a start that intersects itself or shapes, before t = "
        "0; 0: such a start is an error" },
    { "strict", WEFT__BOOLEAN, .fallback = "false",
      .at = offsetof(weft_cloth_def, strict) - offsetof(weft_cloth_def, contact),
      .meaning
      = "cloth that passes through a shape between its particles ends the run; "
        "false: weft warns once" },
    { "shapes", WEFT__ITEMS,
      ITEMS(weft_contact_def, shapes, shape_count, weft__read_shape),
      .section = &shape_section, .absent = "none",
      .meaning = "colliders: rigid shapes, and meshes" },
};
