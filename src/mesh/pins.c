/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/pins.h"

/* The motion after those of the definition. */
static uint32_t coasting(const weft__mesh *mesh)
{
    return (uint32_t)mesh->motion_count + 1;
}

weft__hold weft__hold_of(const weft__mesh *copy, size_t i)
{
    const uint32_t pin = copy->pin[i];
    return pin == 0                ? WEFT__FREE
           : pin == coasting(copy) ? WEFT__COASTING
                                   : WEFT__DEFINED;
}

bool weft__can_hold(const weft__mesh *copy, size_t i, uint64_t hold)
{
    return hold == WEFT__FREE || hold == WEFT__COASTING
           || (hold == WEFT__DEFINED && copy->defined_pin[i] != 0);
}

void weft__set_hold(weft__mesh *copy, size_t i, weft__hold hold)
{
    copy->pin[i] = hold == WEFT__FREE       ? 0
                   : hold == WEFT__COASTING ? coasting(copy)
                                            : copy->defined_pin[i];
}

void weft__list_pins(weft__mesh *mesh)
{
    mesh->pinned = 0;
    ++mesh->pin_changes;
    for (size_t i = 0; i < mesh->particles; ++i) {
        mesh->inverse_mass[i] = mesh->pin[i] != 0 ? 0.0 : 1.0 / mesh->mass[i];
        if (mesh->pin[i] != 0) {
            mesh->pins[mesh->pinned++] = i;
        }
    }
}

void weft__pins_changed(weft__mesh *copy, const double *y)
{
    const size_t n = copy->particles;
    weft__list_pins(copy);
    for (size_t j = 0; j < copy->pinned; ++j) {
        const size_t i = copy->pins[j];
        for (size_t k = 0; copy->pin[i] == coasting(copy) && k < 3; ++k) {
            copy->coast[3 * i + k] = y[(3 + k) * n + i];
        }
    }
}
