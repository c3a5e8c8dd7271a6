/* SPDX-License-Identifier: BSD-3-Clause */
/* products_fast.c -- springs_fast.c for products of the Jacobian. */
#define PRODUCT 1
#include "forces/springs/springs_fast.c" /* NOLINT(bugprone-suspicious-include) */
