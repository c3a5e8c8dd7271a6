/* SPDX-License-Identifier: BSD-3-Clause */
/* measured_order.h -- the order of a method, measured. */
#ifndef WEFT_CONFORMANCE_MEASURED_ORDER_H
#define WEFT_CONFORMANCE_MEASURED_ORDER_H

#include "weft/stepper.h"

enum { WEFT__ORDER_MOST = 9 };
#define WEFT__ORDER_BOUND 0.2

/* What the method, or the table that it is given here, claims; 0: variable. */
int weft__order_claimed(const weft_stepper_type *type);

/* log2 of the ratio of the errors with h and h/2, were `claimed` right; INFINITY if
 * there is no error to speak of, for then it is of higher order. `claimed` is at most
 * WEFT__ORDER_MOST. Errors: what create and step give. */
weft_status weft__order(const weft_stepper_type *type, int claimed, double *order,
                        weft_error *err);

#endif
