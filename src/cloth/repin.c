/* SPDX-License-Identifier: BSD-3-Clause */
/* repin.c -- a cloth whose pins may change: motions[first_own] and those behind it are
 * each of one particle alone. */
#include "cloth/repin.h"

#include "cloth/internal.h"
#include "cloth/memory.h"

weft_cloth *weft__cloth_borrow(const weft_cloth *from, const weft_allocator *memory)
{
    weft_cloth *cloth = weft__alloc(memory, 1, sizeof *cloth);
    uint32_t *pin = weft__alloc(memory, from->particles, sizeof *pin);
    weft__motion *motions
        = weft__alloc(memory, from->motion_count + 1, sizeof *motions);
    if (cloth == NULL || pin == NULL || motions == NULL) {
        weft__free(memory, cloth);
        weft__free(memory, pin);
        weft__free(memory, motions);
        return NULL;
    }
    *cloth = *from;
    cloth->memory = *memory;
    cloth->first_own = from->motion_count;
    cloth->pin = memcpy(pin, from->pin, from->particles * sizeof *pin);
    cloth->motions
        = memcpy(motions, from->motions, from->motion_count * sizeof *motions);
    return cloth;
}

void weft__cloth_return(weft_cloth *borrowed)
{
    if (borrowed != NULL) {
        const weft_allocator memory = borrowed->memory;
        weft__free(&memory, borrowed->pin);
        weft__free(&memory, borrowed->motions);
        weft__free(&memory, borrowed);
    }
}

/* A motion more, particle i's own. */
static bool add_motion(weft_cloth *cloth, size_t i)
{
    const size_t count = cloth->motion_count + 1;
    weft__motion *grown
        = weft__resize(&cloth->memory, cloth->motions, count + 1, sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    cloth->motions = grown;
    cloth->motion_count = count;
    cloth->pinned += cloth->pin[i] == 0;
    cloth->pin[i] = (uint32_t)count;
    return true;
}

bool weft__cloth_pin(weft_cloth *borrowed, size_t i, const double velocity[3])
{
    if (borrowed->pin[i] <= borrowed->first_own && !add_motion(borrowed, i)) {
        return false;
    }
    weft__motion *motion = &borrowed->motions[borrowed->pin[i] - 1];
    *motion = (weft__motion){ 0 };
    for (size_t k = 0; k < 3; ++k) {
        motion->velocity[k] = velocity[k];
        motion->moves = motion->moves || velocity[k] != 0.0;
    }
    return true;
}

void weft__cloth_unpin(weft_cloth *borrowed, size_t i)
{
    const uint32_t hole = borrowed->pin[i];
    borrowed->pin[i] = 0;
    --borrowed->pinned;
    if (hole > borrowed->first_own) { /* the last motion moves there */
        const size_t last = borrowed->motion_count--;
        borrowed->motions[hole - 1] = borrowed->motions[last - 1];
        for (size_t j = 0; j < borrowed->particles; ++j) {
            borrowed->pin[j] = borrowed->pin[j] == last ? hole : borrowed->pin[j];
        }
    }
}
