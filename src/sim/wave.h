/* SPDX-License-Identifier: BSD-3-Clause */
/* wave.h -- an attempt of a step of an explicit Runge-Kutta method in one pass over the
 * rows of a grid, with the bits of evaluations one after the other.
 *
 * A row of a stage needs the two rows on either side of it in the stage before. So the
 * pass takes block after block of rows, and each stage follows the one before by two
 * rows. A stage has a window of rows, where its state goes in and its rates come out of
 * the unchanged forces. Windows of a few rows stay in the caches; only y and the first
 * rates are read from memory, and the last ones written to it. Each thread takes a span
 * of rows; at its ends it computes up to two rows a stage that others compute too. */
#pragma once

#include "sim/forces.h"

typedef struct weft__wave weft__wave;

enum { WEFT__WAVE_STAGES = 18 };

/* Whether a pass is faster for attempts of so many stages. It needs a grid whose forces
 * act within two rows, and a state beyond the caches. */
bool weft__wave_pays(const weft__forces *forces, size_t stages);

/* Of a cloth of that size and tables of up to `stages` rows. NULL: no memory. */
weft__wave *weft__wave_create(const weft__forces *forces, size_t stages,
                              const weft_allocator *given);
void weft__wave_destroy(weft__wave *wave); /* NULL is allowed */

size_t weft__wave_bytes(const weft__wave *wave); /* NULL: 0 */

/* As weft_pass.run, of a cloth under `forces` as it is now; does not ask `stop`. */
int weft__wave_run(weft__wave *wave, const weft__forces *forces, weft_attempt *attempt);
