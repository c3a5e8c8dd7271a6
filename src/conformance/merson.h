/* SPDX-License-Identifier: BSD-3-Clause */
/* merson.h -- a Butcher table for methods that take one: R. H. Merson's of order 4,
 * with an embedded solution of order 3. */
#ifndef WEFT_CONFORMANCE_MERSON_H
#define WEFT_CONFORMANCE_MERSON_H

#include "weft/stepper.h"

static inline const weft_butcher *merson(void)
{
    static const double a[25]
        = { [5] = 1.0 / 3, [10] = 1.0 / 6, [11] = 1.0 / 6, [15] = 0.125,
            [17] = 0.375,  [20] = 0.5,     [22] = -1.5,    [23] = 2.0 };
    static const double b[5] = { 1.0 / 6, 0, 0, 2.0 / 3, 1.0 / 6 };
    static const double c[5] = { 0, 1.0 / 3, 1.0 / 3, 0.5, 1 };
    static const double b3[5] = { 0.1, 0, 0.3, 0.4, 0.2 };
    static const weft_butcher table = { 5, 4, 3, a, b, c, b3 };
    return &table;
}

#endif
