/* SPDX-License-Identifier: BSD-3-Clause */
/* measured_order.h -- measures the order of a method. */
#ifndef WEFT_CONFORMANCE_MEASURED_ORDER_H
#define WEFT_CONFORMANCE_MEASURED_ORDER_H

#include "weft/stepper.h"

enum { WEFT__ORDER_MOST = 9 };
#define WEFT__ORDER_BOUND 0.2

/* The order claimed by the method, or by the table it gets here; 0: variable, or
 * not to be measured in fixed steps. */
int weft__order_claimed(const weft_stepper_type *type);

/* log2 of the ratio of the errors with h and h/2, measured for the order `claimed`, at
 * most WEFT__ORDER_MOST; INFINITY if the errors are roundoff, as the order is higher
 * then. Errors: those of create and step. */
weft_status weft__order(const weft_stepper_type *type, int claimed, double *order,
                        weft_error *err);

#endif
