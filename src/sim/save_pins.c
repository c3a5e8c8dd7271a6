/* SPDX-License-Identifier: BSD-3-Clause */
/* save_pins.c -- pins that are not those of the definition, as words: of each particle
 * its index, 1 if it is held or 0 if it was let go, and its velocity [m/s]. */
#include <math.h>

#include "base/bytes.h"
#include "cloth/repin.h"
#include "sim/simulation.h"

enum { AT_INDEX, AT_HELD, AT_VELOCITY, WORDS = AT_VELOCITY + 3 };

static bool changed(const weft_sim *sim, size_t i)
{
    return weft__cloth_own_pin(sim->own, i) != NULL
           || (weft_cloth_pinned(sim->given, i) && !weft_cloth_pinned(sim->own, i));
}

size_t weft__saved_pins_words(const weft_sim *sim)
{
    size_t words = 0;
    for (size_t i = 0; sim->own != NULL && i < weft_cloth_particles(sim->own); ++i) {
        words += changed(sim, i) ? WORDS : 0;
    }
    return words;
}

void weft__saved_pins_put(const weft_sim *sim, unsigned char *to)
{
    for (size_t i = 0; sim->own != NULL && i < weft_cloth_particles(sim->own); ++i) {
        if (changed(sim, i)) {
            const double *velocity = weft__cloth_own_pin(sim->own, i);
            weft__word_put(to + AT_INDEX * WEFT__WORD, i);
            weft__word_put(to + AT_HELD * WEFT__WORD, velocity != NULL);
            for (size_t k = 0; k < 3; ++k) {
                weft__real_put(to + (AT_VELOCITY + k) * WEFT__WORD,
                               velocity != NULL ? velocity[k] : 0.0);
            }
            to += WORDS * WEFT__WORD;
        }
    }
}

static weft_status take(weft_cloth *own, const unsigned char *from, weft_error *err)
{
    const uint64_t i = weft__word_at(from + AT_INDEX * WEFT__WORD);
    const uint64_t held = weft__word_at(from + AT_HELD * WEFT__WORD);
    double velocity[3];
    bool sound = i < weft_cloth_particles(own)
                 && (held == 1 || (held == 0 && weft_cloth_pinned(own, (size_t)i)));
    for (size_t k = 0; k < 3; ++k) {
        velocity[k] = weft__real_at(from + (AT_VELOCITY + k) * WEFT__WORD);
        sound = sound && isfinite(velocity[k]);
    }
    if (!sound) {
        return weft_error_set(err, WEFT_INVALID, "a saved pin makes no sense");
    }
    if (held == 0) {
        weft__cloth_unpin(own, (size_t)i);
    } else if (!weft__cloth_pin(own, (size_t)i, velocity)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a pin");
    }
    return WEFT_OK;
}

weft_status weft__saved_pins_cloth(const weft_sim *sim, const unsigned char *from,
                                   size_t words, weft_cloth **out, weft_error *err)
{
    *out = NULL;
    if (words % WORDS != 0) {
        return weft_error_set(err, WEFT_INVALID, "the saved pins are cut off");
    }
    if (words == 0 && sim->own == NULL) {
        return WEFT_OK;
    }
    weft_cloth *own = weft__cloth_borrow(sim->given, &sim->memory);
    weft_status status
        = own != NULL ? WEFT_OK
                      : weft_error_set(err, WEFT_NO_MEMORY, "no memory for pins");
    for (size_t at = 0; status == WEFT_OK && at < words; at += WORDS) {
        status = take(own, from + at * WEFT__WORD, err);
    }
    if (status != WEFT_OK) {
        weft__cloth_return(own);
        return status;
    }
    *out = own;
    return WEFT_OK;
}
