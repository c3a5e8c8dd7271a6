/* SPDX-License-Identifier: BSD-3-Clause */
/* pins.h -- how particles are held: in the copy of a simulation that changes. */
#pragma once

#include "mesh/mesh.h"

typedef enum weft__hold {
    WEFT__FREE,
    WEFT__DEFINED, /* moves as the model defines, which has it pinned */
    WEFT__COASTING /* keeps the velocity that it had when the pins were changed */
} weft__hold;

weft__hold weft__hold_of(const weft__mesh *copy, size_t i);

/* Whether particle i may be held so: WEFT__DEFINED needs a pin in the model. */
bool weft__can_hold(const weft__mesh *copy, size_t i, uint64_t hold);

/* Set any number of particles, then call pins_changed once: it updates the lists of
 * pins and masses for the state y in O(N). */
void weft__set_hold(weft__mesh *copy, size_t i, weft__hold hold);
void weft__pins_changed(weft__mesh *copy, const double *y);

/* Fills pins and inverse masses of any mesh from cloth->pin. */
void weft__list_pins(weft__mesh *mesh);
