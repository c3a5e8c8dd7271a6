/* SPDX-License-Identifier: BSD-3-Clause */
/* pins.h -- the copy of a cloth in which a simulation changes pins and shapes. */
#ifndef WEFT_CLOTH_PINS_H
#define WEFT_CLOTH_PINS_H

#include "weft/cloth.h"

/* A copy of *model that owns its pins and shapes and shares the rest; *model must
 * outlive it. Destroy it with weft_cloth_destroy. NULL: no memory. */
weft_cloth *weft__cloth_copy(const weft_cloth *model, const weft_allocator *memory);

typedef enum weft__hold {
    WEFT__FREE,
    WEFT__DEFINED, /* moves as the model defines, which has it pinned */
    WEFT__COASTING /* keeps the velocity that it had when the pins were changed */
} weft__hold;

weft__hold weft__cloth_hold(const weft_cloth *copy, size_t i);

/* Whether particle i may be held so: WEFT__DEFINED needs a pin in the model. */
bool weft__cloth_can_hold(const weft_cloth *copy, size_t i, uint64_t hold);

/* Set any number of particles, then call pins_changed once: it updates the lists of
 * pins and masses for the state y in O(N). */
void weft__cloth_set_hold(weft_cloth *copy, size_t i, weft__hold hold);
void weft__cloth_pins_changed(weft_cloth *copy, const double *y);

/* Fills pins and inverse masses of any cloth from cloth->pin. */
void weft__cloth_list_pins(weft_cloth *cloth);

#endif
