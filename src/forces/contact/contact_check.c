/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_check.c -- the numbers of contact and of its shapes. */
#include <stdio.h>

#include "base/finite.h"
#include "base/hash.h"
#include "forces/contact/mesh_shape.h"
#include "mesh/grid_def.h"
#include "mesh/triangles_work.h"

#define CONTACT(name) offsetof(weft_contact_def, name)
#define SHAPE(name)   offsetof(weft_shape, name)
#define POSITIVE      .strict = true
#define NOT_NEGATIVE  .least = 0.0
#define VECTOR        .count = 3, .least = -HUGE_VAL
#define UP_TO(last)   .type = WEFT__ENUM, .most = (last)

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
const struct weft__turn_numbers weft__turn_numbers = {
    WEFT__FIELD(weft_turn, axis, NULL, VECTOR),
    WEFT__FIELD(weft_turn, rate, "rad/s", .least = -HUGE_VAL),
    WEFT__FIELD(weft_turn, amplitude, "rad", .least = -HUGE_VAL),
    WEFT__FIELD(weft_turn, frequency, "Hz", NOT_NEGATIVE),
};
const weft__number weft__untangle
    = { offsetof(weft_cloth_def, untangle), "untangle", "s", .least = 0.0 };
const weft__number weft__shape_radius = { SHAPE(radius), "radius", "m", POSITIVE };
const weft__number weft__shape_rounding
    = { SHAPE(rounding), "rounding", "m", POSITIVE };

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
static bool contact_check_along(const double spin[3], const double displacement[3])
{
    const double cross[3] = { spin[1] * displacement[2] - spin[2] * displacement[1],
                              spin[2] * displacement[0] - spin[0] * displacement[2],
                              spin[0] * displacement[1] - spin[1] * displacement[0] };
    return weft__length(cross)
           <= 1e-9 * weft__length(spin) * weft__length(displacement);
}

/* The first rule between its numbers that a shape breaks; NULL: none. */
static const char *shape_fault(const weft_shape *shape, size_t *field)
{
    const double *a = shape->at, *b = shape->to, *h = shape->half;
    const double axis[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const bool plane = shape->kind == WEFT_PLANE, box = shape->kind == WEFT_BOX;
    const bool capsule = shape->kind == WEFT_CAPSULE, mesh = shape->kind == WEFT_MESH;
    const weft__shape made = weft__shape_of(shape, 0.0);
    const weft_turn *turn = &shape->turn;
    const bool turns = weft__length(turn->axis) != 0.0;
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
        { mesh && weft__length(shape->spin) != 0.0, SHAPE(spin),
          "a mesh cannot spin: it turns" },
        { capsule && !contact_check_along(shape->spin, axis), SHAPE(spin),
          "a capsule spins about its axis only" },
        { plane && !contact_check_along(shape->spin, shape->normal), SHAPE(spin),
          "a plane spins about its normal only" },
        { !isfinite(shape->friction), SHAPE(friction), "its friction must be finite" },
        { !weft__motion_usable(&made.motion.motion), SHAPE(amplitude),
          "its motion is too large or too small for a double" },
        { turns && !isnan(turn->about[0]) && !weft__all_finite(turn->about, 3),
          SHAPE(turn), "what it turns about must be finite" },
        { !isfinite(weft__length(turn->axis)) || !weft__rigid_usable(&made.motion),
          SHAPE(turn), "its turn is too large or too fast for a double" },
        { (box || mesh) && !isfinite(weft__length(shape->orientation)),
          SHAPE(orientation), "its orientation must be finite" },
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
        || !weft__numbers_check(size, box || round, shape, to, "shapes[%zu]: ", index)
        || !WEFT__NUMBERS_CHECK(weft__turn_numbers, &shape->turn, to,
                                "shapes[%zu]: turn: ", index)) {
        return false;
    }
    const char *message = shape_fault(shape, &field);
    if (message != NULL) {
        weft__fault(to, field, field, "shapes[%zu]: %s", index, message);
    } else if (shape->kind == WEFT_MESH) {
        size_t triangle = SIZE_MAX;
        message = weft__body_fault(shape->body, &triangle);
        if (message != NULL) {
            char of[48] = "";
            (void)snprintf(of, triangle == SIZE_MAX ? 0 : sizeof of, ": triangle %zu",
                           triangle);
            weft__fault(to, SHAPE(body), SHAPE(body), "shapes[%zu]: %s%s", index,
                        message, of);
        }
    }
    return message == NULL;
}

/* The free particle that starts deepest inside a shape without faults, by its number in
 * the whole cloth: the gap [m], > 0 if none does. */
static double start_gap(const weft_cloth_def *def, const weft_shape *shape,
                        size_t *particle)
{
    weft__mesh grid = { .rows = 0 };
    double least = (double)INFINITY;
    const weft__shape of = weft__shape_of(shape, 0.0);
    const weft__pose pose = weft__pose_of(&of, 0.0);
    if (def->mesh == NULL) {
        weft__grid_init(&grid, def);
    }
    const size_t count = def->mesh != NULL ? def->mesh->vertices : grid.particles;
    for (size_t i = 0; i < count; ++i) {
        const size_t whole = def->mesh != NULL ? i : weft__whole_index(&grid, i);
        double x[3];
        if (def->mesh != NULL) {
            weft__def_start(def->mesh, i, x);
        } else {
            weft__grid_start(&grid, i, x);
        }
        const double gap = weft__gap_at(&pose, x);
        if (!(gap > 0.0) && gap < least && weft__pin_of(def, whole) == 0) {
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
    char name[64];
    if (gap > 0.0) { /* perhaps there are no particles to name */
        return true;
    }
    (void)weft_text_format(text, size, "%s is %.3g mm inside shapes[%zu]",
                           weft__particle_text(def, i, name, sizeof name),
                           1e3 * fabs(gap), shape);
    return false;
}

static void check_shapes(const weft_cloth_def *def, const weft__faults *to)
{
    char inside[120];
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        if (weft__shape_check(&def->contact.shapes[k], k, to) && def->untangle == 0.0
            && !weft__start_check(def, k, inside, sizeof inside)) {
            weft__fault(to, offsetof(weft_cloth_def, contact.shapes),
                        offsetof(weft_cloth_def, contact.shapes), "%s", inside);
        }
    }
}

void weft__contact_def_check(const weft_cloth_def *def, const weft__faults *to)
{
    (void)weft__numbers_check(&weft__untangle, 1, def, to, "contact: ");
    if (def->contact.shape_count > 0) {
        weft__contact_check(&def->contact, to);
        check_shapes(def, to);
    }
}

weft_status weft__shape_make(const weft__contact *own, const weft_shape *def,
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
    *out = weft__shape_of(def, own->law.friction);
    out->motion.motion.since = since;
    return WEFT_OK;
}

/* ---- hashes --------------------------------------------------------------------- */

uint64_t weft__law_hash(const weft_contact_def *law, uint64_t hash)
{
    hash = weft__hash_word(hash, (uint64_t)law->exponent);
    hash = weft__hash_word(hash, (uint64_t)law->law);
    return WEFT__HASH_NUMBERS(hash, law->thickness, law->stopping_speed, law->damping,
                              law->slip);
}

uint64_t weft__contact_hash(const weft__contact *own)
{
    return weft__law_hash(&own->law,
                          weft__hash_real(WEFT__HASH_START, own->law.friction));
}

static uint64_t hash_shape(uint64_t hash, const weft__shape *shape)
{
    const weft_shape *def = &shape->def;
    hash = weft__hash_word(hash, (uint64_t)def->kind);
    hash = weft__hash_reals(hash, def->at, 3);
    hash = weft__hash_reals(hash, shape->axis, 3);
    hash = weft__hash_real(hash, shape->length);
    hash = weft__hash_reals(hash, def->half, def->kind == WEFT_BOX ? 3 : 0);
    hash = weft__hash_real(hash, shape->radius);
    hash = weft__hash_reals(hash, shape->spin, 3);
    hash = weft__hash_real(hash, shape->friction);
    if ((def->kind == WEFT_BOX || def->kind == WEFT_MESH)
        && weft__length(def->orientation) > 0.0) {
        hash = weft__hash_reals(hash, def->orientation, 4);
    }
    hash = def->body == NULL ? hash : weft__body_hash(def->body, hash);
    return weft__rigid_hash(&shape->motion, hash);
}

/* Nothing without contact. The law is hashed once, after self-contact. */
uint64_t weft__contact_own_hash(const void *own, uint64_t hash)
{
    const weft__contact *of = own;
    for (size_t k = 0; k < of->shape_count; ++k) {
        hash = hash_shape(hash, &of->shapes[k]);
    }
    if (of->law.self) {
        hash = weft__hash_real(weft__hash_word(hash, 1), of->law.friction);
    }
    return of->shape_count > 0 || of->law.self ? weft__law_hash(&of->law, hash) : hash;
}
