/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_hash.c -- a hash of all that determines the motion of a cloth but its state. */
#include "base/hash.h"
#include "cloth/model.h"
#include "cloth/rows.h"

static uint64_t hash_group(uint64_t hash, const weft__group *group)
{
    const double numbers[] = { group->rest_length, group->stiffness, group->damping };
    hash = weft__hash_word(hash, group->family);
    hash = weft__hash_word(hash, group->way);
    hash = weft__hash_reals(hash, numbers, sizeof numbers / sizeof numbers[0]);
    return group->half_rim ? weft__hash_word(hash, 1) : hash;
}

/* How a pin is held: not which entry of the definition says so. */
static uint64_t hash_motion(uint64_t hash, const weft__motion *motion)
{
    hash = weft__hash_reals(hash, motion->velocity, 3);
    hash = weft__hash_reals(hash, motion->amplitude, 3);
    return weft__hash_real(hash, motion->omega);
}

static uint64_t hash_row(const weft_cloth *cloth, size_t r)
{
    const size_t first = r * cloth->cols;
    uint64_t hash
        = weft__hash_reals(WEFT__HASH_START, cloth->mass + first, cloth->cols);
    for (size_t c = 0; c < cloth->cols; ++c) {
        if (cloth->pin[first + c] != 0) {
            hash = weft__hash_word(hash, c);
            hash = hash_motion(hash, &cloth->motions[cloth->pin[first + c] - 1]);
        }
    }
    return hash;
}

static uint64_t hash_shape(uint64_t hash, const weft__shape *shape)
{
    const weft_shape *def = &shape->def;
    hash = weft__hash_word(hash, (uint64_t)def->kind);
    hash = weft__hash_reals(hash, def->at, 3);
    hash = weft__hash_reals(hash, shape->axis, 3);
    hash = weft__hash_real(hash, shape->length);
    hash = weft__hash_reals(hash, def->half, 3);
    hash = weft__hash_real(hash, def->kind == WEFT_BOX ? def->rounding : def->radius);
    hash = weft__hash_reals(hash, shape->spin, 3);
    hash = weft__hash_real(hash, shape->friction);
    return hash_motion(hash, &shape->motion);
}

static uint64_t hash_law(uint64_t hash, const weft_contact_def *law)
{
    const double numbers[]
        = { law->thickness, law->stopping_speed, law->damping, law->slip };
    hash = weft__hash_word(hash, (uint64_t)law->exponent);
    hash = weft__hash_word(hash, (uint64_t)law->law);
    return weft__hash_reals(hash, numbers, sizeof numbers / sizeof numbers[0]);
}

uint64_t weft__contact_hash(const weft_cloth *cloth)
{
    return hash_law(weft__hash_real(WEFT__HASH_START, cloth->contact.friction),
                    &cloth->contact);
}

/* Nothing without contact. */
static uint64_t hash_contact(uint64_t hash, const weft_cloth *cloth)
{
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        hash = hash_shape(hash, &cloth->shapes[k]);
    }
    if (cloth->contact.self) {
        hash = weft__hash_real(weft__hash_word(hash, 1), cloth->contact.friction);
    }
    return cloth->shape_count > 0 || cloth->contact.self
               ? hash_law(hash, &cloth->contact)
               : hash;
}

/* Nothing without. */
static uint64_t hash_rigidity(uint64_t hash, const weft__rigidity *of)
{
    const double numbers[] = { of->along, of->across, of->twist, of->damping };
    return of->present
               ? weft__hash_reals(hash, numbers, sizeof numbers / sizeof numbers[0])
               : hash;
}

uint64_t weft__cloth_hash(const weft_cloth *cloth)
{
    uint64_t hash = WEFT__HASH_START;
    hash = weft__hash_word(hash, cloth->rows);
    hash = weft__hash_word(hash, cloth->cols);
    for (size_t g = 0; g < cloth->group_count; ++g) {
        hash = hash_group(hash, &cloth->groups[g]);
    }
    hash = hash_rigidity(hash, &cloth->rigidity);
    for (size_t r = 0; r < cloth->rows; ++r) {
        hash = weft__hash_word(hash, hash_row(cloth, r));
    }
    hash = weft__hash_reals(hash, cloth->gravity, 3);
    hash = weft__hash_real(hash, cloth->drag);
    hash = weft__hash_reals(hash, cloth->wind_velocity, 3);
    hash = weft__hash_real(hash, cloth->wind_drag);
    return hash_contact(hash, cloth);
}
