/* SPDX-License-Identifier: BSD-3-Clause */
/* isa.h -- levels of instructions. Functions that are compiled for each have the level
 * at the end of their name; `loops` are the plain loops beside them, with the same
 * bits. */
#pragma once

#include "weft/base.h"

typedef enum weft__isa { WEFT__LOOPS, WEFT__PLAIN, WEFT__V3, WEFT__V4 } weft__isa;

/* WEFT_FORM(isa, NAME): the function weft__NAME_LEVEL; WEFT_FORMS declares them.
 * A build without fast forms, or with their files deleted, has weft__NAME_loops alone.
 */
#ifdef WEFT_PLAIN
#define WEFT_LEVELS(X)
#define WEFT_FORM(isa, name)   ((void)(isa), weft__##name##_loops)
#define WEFT_FORMS(type, name) type weft__##name##_loops
#elif defined __x86_64__ && defined __GNUC__
#define WEFT_LEVELS(X) X(plain) X(v3) X(v4)
#define WEFT_FORM(isa, name)                                                           \
    ((isa) == WEFT__V4      ? weft__##name##_v4                                        \
     : (isa) == WEFT__V3    ? weft__##name##_v3                                        \
     : (isa) == WEFT__PLAIN ? weft__##name##_plain                                     \
                            : weft__##name##_loops)
#define WEFT_FORMS(type, name)                                                         \
    type weft__##name##_loops, weft__##name##_plain, weft__##name##_v3,                \
        weft__##name##_v4
#else
#define WEFT_LEVELS(X) X(plain)
#define WEFT_FORM(isa, name)                                                           \
    ((isa) == WEFT__PLAIN ? weft__##name##_plain : weft__##name##_loops)
#define WEFT_FORMS(type, name) type weft__##name##_loops, weft__##name##_plain
#endif

/* The levels of this machine are WEFT__PLAIN to the last one, the fastest. */
weft__isa weft__isa_last(void);
const char *weft__isa_name(weft__isa isa);

/* The one of that name, which this machine must have; NULL or "": the fastest. */
weft_status weft__isa_find(const char *name, weft__isa *out, weft_error *err);
