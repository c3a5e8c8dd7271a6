/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/spaces.h"

bool weft__spaces_make(weft__forces *forces, const weft_cloth *cloth,
                       const size_t part[2])
{
    bool made = true;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        if (force != NULL && force->space.create != NULL && forces->spaces[k] == NULL) {
            forces->spaces[k] = force->space.create(weft__own(cloth, k), forces->pool,
                                                    part, &forces->memory);
            made = made && forces->spaces[k] != NULL;
        }
    }
    return made;
}

bool weft__spaces_any(const weft__forces *forces)
{
    bool any = false;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        any = any || forces->spaces[k] != NULL;
    }
    return any;
}

weft_status weft__spaces_grow(const weft__forces *forces, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (size_t k = 0; k < WEFT__FORCES && status == WEFT_OK; ++k) {
        if (forces->spaces[k] != NULL) {
            status = weft__table[k].force->space.grow(forces->spaces[k], err);
        }
    }
    return status;
}

void weft__spaces_destroy(const weft__forces *forces)
{
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        if (forces->spaces[k] != NULL) {
            weft__table[k].force->space.destroy(forces->spaces[k]);
        }
    }
}
