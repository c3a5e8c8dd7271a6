/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_hash.c -- a hash of all that determines the motion of a cloth but its state. */
#include "base/hash.h"
#include "cloth/grids.h"

/* How a pin is held: not which entry of the definition says so. */
uint64_t weft__cloth_block_hash(const weft_cloth *cloth, size_t b)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t first = weft__block(mesh, b), end = weft__block(mesh, b + 1);
    uint64_t hash = weft__hash_reals(WEFT__HASH_START, mesh->mass + first, end - first);
    for (size_t i = first; i < end; ++i) {
        if (mesh->pin[i] != 0) {
            hash = weft__hash_word(hash, i - first);
            hash = weft__motion_hash(&mesh->motions[mesh->pin[i] - 1], hash);
        }
    }
    return hash;
}

static uint64_t hash_blocks(const weft_cloth *cloth, const uint64_t *blocks,
                            uint64_t hash)
{
    for (size_t b = 0; b < cloth->mesh.band.rows; ++b) {
        hash = weft__hash_word(hash, blocks != NULL ? blocks[b]
                                                    : weft__cloth_block_hash(cloth, b));
    }
    return hash;
}

/* What particles are hashed between the forces that are parts of a fabric and those
 * from outside. */
uint64_t weft__cloth_hash(const weft_cloth *cloth, const uint64_t *blocks)
{
    uint64_t hash = WEFT__HASH_START;
    hash = weft__hash_word(hash, cloth->mesh.band.rows);
    hash = weft__hash_word(hash, weft__width_of(&cloth->mesh));
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (k == WEFT__FORCE_body) {
            hash = hash_blocks(cloth, blocks, hash);
        }
        if (weft__table[k].force->tables.hash != NULL) {
            hash = weft__table[k].force->tables.hash(weft__own(cloth, k), hash);
        }
    }
    hash = weft__grids_hash(cloth, hash);
    return cloth->untangle > 0.0 ? weft__hash_real(hash, cloth->untangle) : hash;
}
