/* SPDX-License-Identifier: BSD-3-Clause */
/* failing_malloc.h -- the functions of malloc, for a program and its libraries, that
 * fail on request. */
#pragma once

#include <errno.h>
#include <malloc.h>
#include <stdlib.h>

#include "support.h"

/* Under AddressSanitizer, whose malloc must come first, the linker wraps the calls of
 * weft and its plugins; its own check of leaks then takes the place of ours. */
#ifdef __SANITIZE_ADDRESS__
#define MINE(name)  __wrap_##name
#define REAL_(name) __real_##name
#define ALIGNED     aligned_alloc
enum { COUNTS_ALL = 0 };
#else
#define MINE(name)  name
#define REAL_(name) __libc_##name
#define ALIGNED     memalign
enum { COUNTS_ALL = 1 };
#endif

#define REAL(name) REAL_(name)

extern void *REAL(malloc)(size_t size);
extern void *REAL(calloc)(size_t count, size_t size);
extern void *REAL(realloc)(void *block, size_t size);
extern void *REAL(ALIGNED)(size_t alignment, size_t size);
extern void REAL(free)(void *block);

static bool armed;    /* calls are counted and may fail */
static bool for_ever; /* from the fatal call on */
static bool own_only; /* libraries are spared */
static long calls, fatal, live;
static size_t used, budget; /* [bytes]; budget 0: no end */

extern char __executable_start, etext;

static bool is_own(const void *caller)
{
    return (const char *)caller >= &__executable_start && (const char *)caller < &etext;
}

static bool fails(const void *caller, size_t size)
{
    if (!armed || (own_only && !is_own(caller))) {
        return false;
    }
    ++calls;
    const bool none = budget > 0 ? used + size > budget
                      : for_ever ? calls >= fatal
                                 : calls == fatal;
    errno = none ? ENOMEM : errno;
    return none;
}

static void *given(void *block)
{
    live += block != NULL;
    used += malloc_usable_size(block);
    return block;
}

static void *taken(void *block)
{
    live -= block != NULL;
    used -= malloc_usable_size(block);
    return block;
}

WEFT_API void *MINE(malloc)(size_t size);
WEFT_API void *MINE(calloc)(size_t count, size_t size);
WEFT_API void *MINE(realloc)(void *block, size_t size);
WEFT_API void *MINE(aligned_alloc)(size_t alignment, size_t size);
WEFT_API void MINE(free)(void *block);

#define FAILS(size) fails(__builtin_return_address(0), size)

WEFT_API void *MINE(malloc)(size_t size)
{
    return FAILS(size) ? NULL : given(REAL(malloc)(size));
}

WEFT_API void *MINE(calloc)(size_t count, size_t size)
{
    return FAILS(count * size) ? NULL : given(REAL(calloc)(count, size));
}

WEFT_API void *MINE(realloc)(void *block, size_t size)
{
    return FAILS(size) ? NULL : given(REAL(realloc)(taken(block), size));
}

WEFT_API void *MINE(aligned_alloc)(size_t alignment, size_t size)
{
    return FAILS(size) ? NULL : given(REAL(ALIGNED)(alignment, size));
}

WEFT_API void MINE(free)(void *block)
{
    REAL(free)(taken(block));
}

/* Check allocates too: nothing is asserted within. */
typedef weft_status trial(const void *ctx, weft_error *err);

static void arm(long at, bool on)
{
    calls = 0;
    budget = 0;
    fatal = at;
    for_ever = on;
    armed = true;
}

/* The n-th allocation fails, for n = 1, 2, ... until there are none left: an error of
 * its name each time, and nothing is kept. Returns how many there are. */
static long every_allocation_fails(trial *attempt, const void *ctx, const char *label)
{
    for (int on = 0; on < 2; ++on) {
        for (long n = 1;; ++n) {
            weft_error err = { 0 };
            const long before = live;
            arm(n, on != 0);
            const weft_status status = attempt(ctx, &err);
            armed = false;
            ck_assert_msg(live == before || !COUNTS_ALL,
                          "%s: %ld blocks kept, allocation %ld failed", label,
                          live - before, n);
            if (calls < n) {
                ck_assert_msg(status == WEFT_OK, "%s: %s", label, err.message);
                ck_assert_int_gt(n, 1);
                break;
            }
            ck_assert_msg(status == WEFT_NO_MEMORY && err.status == status
                              && err.message[0] != '\0',
                          "%s: '%s' (%s), allocation %ld failed", label,
                          weft_status_text(status), err.message, n);
        }
    }
    return calls;
}
