/* SPDX-License-Identifier: BSD-3-Clause */
/* memory.c -- memory that a method takes must be given back. */
#include "study/conformance/trial.h"

/* glibc since 2.33 reports it in numbers that do not wrap. */
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
#include <malloc.h>
#define HEAP_IS_KNOWN 1
static size_t heap_in_use(void)
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}
#else
#define HEAP_IS_KNOWN 0
static size_t heap_in_use(void)
{
    return 0;
}
#endif

const char *weft__heap_not_known(const weft_stepper_type *type)
{
    (void)type;
    return HEAP_IS_KNOWN ? NULL : "this C library does not report allocations";
}

/* The first steps may still fill the lists that free() keeps for the next malloc(). */
void weft__the_heap_does_not_grow(trial *self)
{
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.0625);
    const size_t before = heap_in_use();
    const uint64_t first = weft__stats(r).steps;
    weft__go(self, r, 8.0);
    const size_t after = heap_in_use();
    EXPECT(after <= before, "%zu bytes more are allocated after %" PRIu64 " steps",
           after - before, weft__stats(r).steps - first);
}

/* free() and solvers keep a varying amount for later use, up to some 500 bytes more
 * after each of several rows: only growth of every row by more is a leak. The least
 * that malloc() allocates is 16 bytes, in a larger chunk. */
enum { ROWS = 6, ROUNDS = 64, LEAST = 16 };

static size_t grows_in_a_row(trial *self, check_fn *round)
{
    const size_t before = heap_in_use();
    for (int i = 0; i < ROUNDS; ++i) {
        round(self);
    }
    const size_t after = heap_in_use();
    return after > before ? after - before : 0;
}

static void nothing_is_left_of(trial *self, check_fn *round, const char *what)
{
    size_t least = SIZE_MAX;
    (void)grows_in_a_row(self, round);
    for (int i = 0; i < ROWS && least >= ROUNDS * LEAST; ++i) {
        const size_t grown = grows_in_a_row(self, round);
        least = grown < least ? grown : least;
    }
    EXPECT(least < ROUNDS * LEAST, "%zu bytes more are allocated each time after %s",
           least / ROUNDS, what);
}

static void live(trial *self)
{
    weft__go(self, weft__begin_usual(self, 0), 0.0078125);
    weft__end(self, 0);
}

void weft__destroy_leaves_nothing(trial *self)
{
    nothing_is_left_of(self, live, "create, some steps and destroy");
}

void weft__refusals_leave_nothing(trial *self)
{
    nothing_is_left_of(self, weft__mistakes_are_refused, "all that create must refuse");
}

/* An allocator that counts. */
typedef struct account {
    size_t calls;
    long blocks; /* not yet given back */
} account;

static void *resize(void *ctx, void *block, size_t size)
{
    account *self = ctx;
    void *out = weft_malloc_resize(NULL, block, size);
    ++self->calls;
    self->blocks += (block == NULL && out != NULL) ? 1 : 0;
    self->blocks -= (block != NULL && size == 0) ? 1 : 0;
    return out;
}

void weft__the_allocator_is_used(trial *self)
{
    /* static: a broken promise leaves this function before destroy uses them */
    static account count;
    static const weft_allocator memory = { resize, &count };
    weft_stepper_config config = weft__usual(self->type, 0);
    count = (account){ 0 };
    config.allocator = &memory;
    weft__go(self, weft__begin(self, 0, config), 0.0625);
    weft__end(self, 0);
    EXPECT(count.blocks == 0, "blocks of config->allocator not given back to it: %ld",
           count.blocks);
    if (count.calls == 0) {
        self->out->verdict = WEFT_PROMISE_NOTED;
        (void)snprintf(self->out->seen, sizeof self->out->seen,
                       "it takes no memory from config->allocator");
    }
}
