/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/hash.h"
#include "cloth/model.h"
#include "cloth/rows.h"

static uint64_t hash_reals(uint64_t hash, const double *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        hash = weft__hash_real(hash, values[i]);
    }
    return hash;
}

static uint64_t hash_group(uint64_t hash, const weft__group *group)
{
    const double numbers[] = { group->rest_length, group->stiffness, group->damping };
    hash = weft__hash_word(hash, group->family);
    hash = weft__hash_word(hash, group->way);
    return hash_reals(hash, numbers, sizeof numbers / sizeof numbers[0]);
}

/* How a pin is held: not which entry of the definition says so. */
static uint64_t hash_motion(uint64_t hash, const weft__motion *motion)
{
    hash = hash_reals(hash, motion->velocity, 3);
    hash = hash_reals(hash, motion->amplitude, 3);
    return weft__hash_real(hash, motion->omega);
}

uint64_t weft__cloth_hash(const weft_cloth *cloth)
{
    uint64_t hash = WEFT__HASH_START;
    hash = weft__hash_word(hash, cloth->rows);
    hash = weft__hash_word(hash, cloth->cols);
    for (size_t g = 0; g < cloth->group_count; ++g) {
        hash = hash_group(hash, &cloth->groups[g]);
    }
    hash = hash_reals(hash, cloth->mass, cloth->particles);
    for (size_t j = 0; j < cloth->pinned; ++j) {
        hash = weft__hash_word(hash, cloth->pins[j]);
        hash = hash_motion(hash, &cloth->motions[cloth->pin[cloth->pins[j]] - 1]);
    }
    hash = hash_reals(hash, cloth->gravity, 3);
    hash = weft__hash_real(hash, cloth->drag);
    hash = hash_reals(hash, cloth->wind_velocity, 3);
    return weft__hash_real(hash, cloth->wind_drag);
}
