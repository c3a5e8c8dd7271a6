/* SPDX-License-Identifier: BSD-3-Clause */
/* conformance.h -- checks whether a stepper keeps the promises of weft/stepper.h. `weft
 * plugin-test weft-foo.so` runs all of them on a file.
 *
 * A check is one promise. It runs the method on a small model with a known solution,
 * which fails on request: with error control and in fixed steps, without and with
 * quadratures, as far as the method supports them.
 *
 * The checks start a thread and read the state of the process (heap, locale, signal
 * handlers, rounding): call them while no other thread of the program runs. A method
 * that crashes or never returns also stops its caller; `weft plugin-test` runs every
 * check in its own process, and sees the output as well. */
#pragma once

#include "weft/stepper.h"

typedef enum weft_verdict {
    WEFT_PROMISE_KEPT,
    WEFT_PROMISE_BROKEN,
    WEFT_PROMISE_NOT_ASKED, /* means nothing for such a method */
    WEFT_PROMISE_NOTED      /* not kept, which is allowed */
} weft_verdict;

typedef struct weft_conformance {
    weft_verdict verdict;
    char seen[512]; /* "" if kept; else the expectation and the observation, or a note,
                       or why not asked */
} weft_conformance;

size_t weft_conformance_count(void);
/* The name and the promise, in a sentence, of check i < weft_conformance_count(). */
const char *weft_conformance_name(size_t i);
const char *weft_conformance_promise(size_t i);

/* Runs one check on one method, which must belong to a plugin that weft_registry_add or
 * weft_registry_load has accepted. Keeps no memory. */
weft_conformance weft_conformance_check(const weft_stepper_type *type, size_t i);
