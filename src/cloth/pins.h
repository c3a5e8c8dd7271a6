/* SPDX-License-Identifier: BSD-3-Clause */
/* pins.h -- the pins of a simulation: a copy of its cloth, in which they may change, as
 * the shapes may. */
#ifndef WEFT_CLOTH_PINS_H
#define WEFT_CLOTH_PINS_H

#include "weft/cloth.h"

/* A cloth with pins and shapes of its own, for weft_cloth_destroy; all else it shares
 * with *model, which outlives it. NULL: no memory. */
weft_cloth *weft__cloth_copy(const weft_cloth *model, const weft_allocator *memory);

typedef enum weft__hold {
    WEFT__FREE,
    WEFT__DEFINED, /* moves as the model defines, which has it pinned */
    WEFT__COASTING /* keeps the velocity that it had when the pins were changed */
} weft__hold;

weft__hold weft__cloth_hold(const weft_cloth *copy, size_t i);

/* Whether the model allows that of particle i. */
bool weft__cloth_can_hold(const weft_cloth *copy, size_t i, uint64_t hold);

/* Of any number of particles; then, once, what follows from that in the state y: O(N).
 */
void weft__cloth_set_hold(weft_cloth *copy, size_t i, weft__hold hold);
void weft__cloth_pins_changed(weft_cloth *copy, const double *y);

/* Fills pins and inverse masses of any cloth from cloth->pin. */
void weft__cloth_list_pins(weft_cloth *cloth);

#endif
