/* SPDX-License-Identifier: BSD-3-Clause */
/* suggest.c -- what libweft has for scenes, and does not export, for command lines too.
 */
#include "sim/suggest.c"
