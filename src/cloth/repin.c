/* SPDX-License-Identifier: BSD-3-Clause */
/* repin.c -- a cloth whose pins may change: motions[first_own] and those behind it are
 * each of one particle alone. */
#include "cloth/repin.h"

#include "base/memory.h"
#include "cloth/model.h"

/* A cloth with room for all that pins are known by. */
static weft_cloth *allocate(const weft_cloth *from, const weft_allocator *memory)
{
    const size_t n = from->particles;
    weft_cloth *cloth = weft__alloc(memory, 1, sizeof *cloth);
    if (cloth == NULL) {
        return NULL;
    }
    *cloth = *from;
    cloth->memory = *memory;
    cloth->pin = weft__alloc(memory, n, sizeof *cloth->pin);
    cloth->pins = weft__alloc(memory, n, sizeof *cloth->pins);
    cloth->inverse_mass
        = weft__alloc(memory, n + WEFT_PAST, sizeof *cloth->inverse_mass);
    cloth->motions
        = weft__alloc(memory, from->motion_count + 1, sizeof *cloth->motions);
    if (cloth->pin == NULL || cloth->pins == NULL || cloth->inverse_mass == NULL
        || cloth->motions == NULL) {
        weft__cloth_return(cloth);
        return NULL;
    }
    return cloth;
}

weft_cloth *weft__cloth_borrow(const weft_cloth *from, const weft_allocator *memory)
{
    const size_t n = from->particles;
    weft_cloth *cloth = allocate(from, memory);
    if (cloth != NULL) {
        cloth->first_own = from->motion_count;
        memcpy(cloth->pin, from->pin, n * sizeof *cloth->pin);
        memcpy(cloth->pins, from->pins, from->pinned * sizeof *cloth->pins);
        memcpy(cloth->inverse_mass, from->inverse_mass,
               (n + WEFT_PAST) * sizeof *cloth->inverse_mass);
        memcpy(cloth->motions, from->motions,
               from->motion_count * sizeof *cloth->motions);
    }
    return cloth;
}

void weft__cloth_return(weft_cloth *borrowed)
{
    if (borrowed != NULL) {
        const weft_allocator memory = borrowed->memory;
        weft__free(&memory, borrowed->pin);
        weft__free(&memory, borrowed->pins);
        weft__free(&memory, borrowed->inverse_mass);
        weft__free(&memory, borrowed->motions);
        weft__free(&memory, borrowed);
    }
}

/* Where a particle stands in the list of pins, or would stand. */
static size_t place_of(const weft_cloth *cloth, size_t i)
{
    size_t low = 0, high = cloth->pinned;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (cloth->pins[middle] < i) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static void list(weft_cloth *cloth, size_t i)
{
    size_t *at = cloth->pins + place_of(cloth, i);
    const size_t behind = cloth->pinned++ - (size_t)(at - cloth->pins);
    memmove(at + 1, at, behind * sizeof *at);
    *at = i;
    cloth->inverse_mass[i] = 0.0;
}

static void unlist(weft_cloth *cloth, size_t i)
{
    size_t *at = cloth->pins + place_of(cloth, i);
    const size_t behind = --cloth->pinned - (size_t)(at - cloth->pins);
    memmove(at, at + 1, behind * sizeof *at);
    cloth->inverse_mass[i] = 1.0 / cloth->mass[i];
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
    if (cloth->pin[i] == 0) {
        list(cloth, i);
    }
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
    unlist(borrowed, i);
    if (hole > borrowed->first_own) { /* the last motion moves there */
        const size_t last = borrowed->motion_count--;
        borrowed->motions[hole - 1] = borrowed->motions[last - 1];
        for (size_t j = 0; j < borrowed->particles; ++j) {
            borrowed->pin[j] = borrowed->pin[j] == last ? hole : borrowed->pin[j];
        }
    }
}

const double *weft__cloth_own_pin(const weft_cloth *borrowed, size_t i)
{
    const uint32_t pin = borrowed->pin[i];
    return pin > borrowed->first_own ? borrowed->motions[pin - 1].velocity : NULL;
}

void weft__cloth_trade(weft_cloth *one, weft_cloth *other)
{
    const weft_cloth before = *one;
    *one = *other;
    *other = before;
}
