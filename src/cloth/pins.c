/* SPDX-License-Identifier: BSD-3-Clause */
#include "cloth/pins.h"

#include "base/memory.h"
#include "cloth/model.h"

weft_cloth *weft__cloth_copy(const weft_cloth *model, const weft_allocator *memory)
{
    const size_t n = model->particles;
    weft_cloth *copy = weft__alloc(memory, 1, sizeof *copy);
    if (copy == NULL) {
        return NULL;
    }
    *copy = *model;
    copy->memory = *memory;
    copy->defined_pin = model->defined_pin != NULL ? model->defined_pin : model->pin;
    copy->pin = weft__alloc(memory, n, sizeof *copy->pin);
    copy->pins = weft__alloc(memory, n, sizeof *copy->pins);
    copy->coast = weft__alloc(memory, 3 * n, sizeof *copy->coast);
    copy->inverse_mass
        = weft__zeroed(memory, n + WEFT_PAST, sizeof *copy->inverse_mass);
    copy->shapes = weft__alloc(memory, model->shape_count, sizeof *copy->shapes);
    if (copy->pin == NULL || copy->pins == NULL || copy->coast == NULL
        || copy->inverse_mass == NULL || copy->shapes == NULL) {
        weft_cloth_destroy(copy);
        return NULL;
    }
    memcpy(copy->pin, model->pin, n * sizeof *copy->pin);
    memcpy(copy->shapes, model->shapes, model->shape_count * sizeof *copy->shapes);
    if (model->coast != NULL) { /* a copy itself */
        memcpy(copy->coast, model->coast, 3 * n * sizeof *copy->coast);
    }
    weft__cloth_list_pins(copy);
    return copy;
}

/* The motion after those of the definition. */
static uint32_t coasting(const weft_cloth *cloth)
{
    return (uint32_t)cloth->motion_count + 1;
}

weft__hold weft__cloth_hold(const weft_cloth *copy, size_t i)
{
    const uint32_t pin = copy->pin[i];
    return pin == 0                ? WEFT__FREE
           : pin == coasting(copy) ? WEFT__COASTING
                                   : WEFT__DEFINED;
}

bool weft__cloth_can_hold(const weft_cloth *copy, size_t i, uint64_t hold)
{
    return hold == WEFT__FREE || hold == WEFT__COASTING
           || (hold == WEFT__DEFINED && copy->defined_pin[i] != 0);
}

void weft__cloth_set_hold(weft_cloth *copy, size_t i, weft__hold hold)
{
    copy->pin[i] = hold == WEFT__FREE       ? 0
                   : hold == WEFT__COASTING ? coasting(copy)
                                            : copy->defined_pin[i];
}

void weft__cloth_list_pins(weft_cloth *cloth)
{
    cloth->pinned = 0;
    ++cloth->pin_changes;
    for (size_t i = 0; i < cloth->particles; ++i) {
        cloth->inverse_mass[i] = cloth->pin[i] != 0 ? 0.0 : 1.0 / cloth->mass[i];
        if (cloth->pin[i] != 0) {
            cloth->pins[cloth->pinned++] = i;
        }
    }
}

void weft__cloth_pins_changed(weft_cloth *copy, const double *y)
{
    const size_t n = copy->particles;
    weft__cloth_list_pins(copy);
    for (size_t j = 0; j < copy->pinned; ++j) {
        const size_t i = copy->pins[j];
        for (size_t k = 0; copy->pin[i] == coasting(copy) && k < 3; ++k) {
            copy->coast[3 * i + k] = y[(3 + k) * n + i];
        }
    }
}
