/* SPDX-License-Identifier: BSD-3-Clause */
/* faults.h -- the numbers of definitions, the values that they may have, and the faults
 * that checks of definitions find. Each struct of numbers stands beside the check of
 * its definition; src/scene takes the ranges and units of its keys from there. */
#pragma once

#include "weft/base.h"

/* Receives the faults of a definition: `field` is the offset of the wrong field in its
 * struct, `other` the offset of a field that excludes it, or the same. */
typedef struct weft__faults {
    void (*found)(void *ctx, size_t field, size_t other, const char *message);
    void *ctx;
} weft__faults;

WEFT_PRINTF(4, 5)
void weft__fault(const weft__faults *to, size_t field, size_t other, const char *format,
                 ...);

/* Keeps the first fault of a definition as WEFT_INVALID; it is the ctx of faults. */
typedef struct weft__refusal {
    weft_status status;
    weft_error *err;
} weft__refusal;
void weft__keep_first(void *ctx, size_t field, size_t other, const char *message);

/* A number of a definition, or an array of them. A double must be finite. */
typedef struct weft__number {
    size_t at; /* offset in the definition */
    const char *name, *unit;
    enum { WEFT__DOUBLE, WEFT__SIZE, WEFT__INT, WEFT__ENUM } type;
    size_t count;       /* of an array; 0 and 1: a single one */
    double least, most; /* most 0: no bound */
    bool strict;        /* > least, else >= */
    bool below;         /* < most, else <= */
    bool infinite;      /* INFINITY is a value */
    bool optional;      /* 0, for "not given", although strict */
} weft__number;

/* A bound above this only keeps numbers sane: messages name it only if it is exceeded.
 */
#define WEFT__MANY 1e6

bool weft__in_range(const weft__number *number, double value);

/* "> 0 and <= 1 or .inf"; "" if every finite number is in range. `bare`: without a
 * bound above WEFT__MANY. */
const char *weft__range_text(const weft__number *number, bool bare, char *out,
                             size_t size);

/* Reports every number of a definition that is out of range, as "load 1: mass -1 kg:
 * must be > 0" with prefix "load 1: ". Returns whether there is none. */
WEFT_PRINTF(5, 6)
bool weft__numbers_check(const weft__number *numbers, size_t count, const void *def,
                         const weft__faults *to, const char *prefix, ...);

/* A struct of numbers, whose name is also that of its type, and one of its numbers. */
#define WEFT__NUMBERS(name, ...)                                                       \
    extern const struct name {                                                         \
        weft__number __VA_ARGS__;                                                      \
    } name

#define WEFT__FIELD(def, name_, unit_, ...)                                            \
    .name_ = { offsetof(def, name_), #name_, unit_, __VA_ARGS__ }

/* The same check of a struct of numbers. */
#define WEFT__NUMBERS_CHECK(numbers, def, to, ...)                                     \
    weft__numbers_check((const weft__number *)&(numbers),                              \
                        sizeof(numbers) / sizeof(weft__number), (def), (to),           \
                        __VA_ARGS__)
