/* SPDX-License-Identifier: BSD-3-Clause */
/* stop.h -- whether a long computation is asked to end. */
#pragma once

#include "weft/base.h"

/* Once asked to end it stays so. NULL or { 0 }: never. */
typedef struct weft__stop {
    weft_stop_fn *ask;
    void *ctx;
    bool came;
} weft__stop;

static inline bool weft__stops(weft__stop *of)
{
    if (of != NULL && of->ask != NULL && !of->came) {
        of->came = of->ask(of->ctx);
    }
    return of != NULL && of->came;
}

/* The same as a weft_stop_fn, for those who have a definition. */
static inline bool weft__stop_ask(void *of)
{
    return weft__stops(of);
}

weft_status weft__stopped(weft_error *err); /* base.c: WEFT_STOPPED */
