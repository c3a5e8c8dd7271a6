/* SPDX-License-Identifier: BSD-3-Clause */
/* structured.h -- a string of beads, the first of which is held, as a model whose
 * structure a method may use. */
#ifndef WEFT_CONFORMANCE_STRUCTURED_H
#define WEFT_CONFORMANCE_STRUCTURED_H

#include "weft/stepper.h"

enum { WEFT__STRING = 30 /* numbers of its state; <= WEFT__DIM_MOST */ };

int weft__string_rhs(double t, const double *y, double *dydt, void *ctx);

/* Level, stretched a little, and moving. */
void weft__string_start(double y[WEFT__STRING]);

/* To a method that knows links some springs are given as such. */
void weft__string_init(weft_structure *at, bool knows_links);

#endif
