/* SPDX-License-Identifier: BSD-3-Clause */
/* conformance.h -- whether a stepper keeps the promises of weft/stepper.h. `weft
 * plugin-test weft-foo.so` runs all of it on a file.
 *
 * A check is one promise. It runs the method on a small model that knows its solution
 * and can be told to fail: with error control and in fixed steps, without quadratures
 * and with, as far as the method takes them.
 *
 * The checks start a thread and look at the process (heap, locale, signal handlers,
 * rounding): call them while no other thread of the program is at work. A method that
 * crashes or never returns takes its caller along; `weft plugin-test` gives every check
 * a process of its own, and sees what is printed as well. */
#ifndef WEFT_CONFORMANCE_CONFORMANCE_H
#define WEFT_CONFORMANCE_CONFORMANCE_H

#include "weft/stepper.h"

typedef enum weft_verdict {
    WEFT_PROMISE_KEPT,
    WEFT_PROMISE_BROKEN,
    WEFT_PROMISE_NOT_ASKED, /* means nothing for such a method */
    WEFT_PROMISE_NOTED      /* not kept, as is allowed */
} weft_verdict;

typedef struct weft_conformance {
    weft_verdict verdict;
    char seen[512]; /* "" if kept; else what was expected and seen, or noted, or why not
                       asked */
} weft_conformance;

size_t weft_conformance_count(void);
/* Of check i < weft_conformance_count(): its name, and the promise in a sentence. */
const char *weft_conformance_name(size_t i);
const char *weft_conformance_promise(size_t i);

/* One check of one method, which must belong to a plugin that weft_registry_add or
 * weft_registry_load has accepted. Allocates, and keeps nothing. */
weft_conformance weft_conformance_check(const weft_stepper_type *type, size_t i);

#endif
