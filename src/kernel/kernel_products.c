/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_products.c -- kernel.c for products of the Jacobian. */
#define PRODUCT 1
#include "kernel/kernel.c" /* NOLINT(bugprone-suspicious-include) */
